//! Prisms of fog: on each triangle of the ground one, as high at each corner as the fog there.

use crate::columns::{Array, Association, CellCounts, CellMesh, NumericColumn, Points};

/// How dense fog is between the ground and its top.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Profile {
    /// For light that is added up: densest at the ground, the more so the thicker the layer, nothing at the top.
    #[default]
    Emission,
    /// For maximum intensity, as in the paper: nothing at the ground, the height of the layer at its top.
    Maximum,
}

/// Fog thinner than this share of the thickest is none.
const LEAST: f32 = 1e-4;

/// The prisms on `triangles`, whose corners have `points` and `thickness`.
///
/// Where the fog ends at a corner, its prism has no height there: bottom and top are one point. There is at least one cell,
/// without density if need be, since a mesh is never empty.
pub(super) fn prisms(
    points: &[[f32; 3]],
    thickness: &[f32],
    triangles: &[[u32; 3]],
    thickest: f32,
    profile: Profile,
) -> CellMesh {
    let has_fog = |v: u32| thickness[v as usize] > LEAST * thickest;
    let mut fogged: Vec<[u32; 3]> = triangles.iter().copied().filter(|t| t.iter().any(|&v| has_fog(v))).collect();
    let is_clear = fogged.is_empty();
    fogged.extend(triangles.first().filter(|_| is_clear));

    let (mut all, mut density) = (Vec::new(), Vec::new());
    let mut numbers = vec![[u32::MAX; 2]; points.len()];
    let mut number = |v: u32| -> [u32; 2] {
        let [known, _] = numbers[v as usize];
        if known != u32::MAX {
            return numbers[v as usize];
        }
        let bottom = all.len() as u32;
        let thick = if is_clear { LEAST * thickest } else { thickness[v as usize] };
        let share = if is_clear { 0.0 } else { (thick / thickest).clamp(0.0, 1.0) };
        let [x, y, z] = points[v as usize];
        all.push([x, y, z]);
        let pair = if is_clear || has_fog(v) {
            let [low, high] = match profile {
                Profile::Emission => [share, 0.0],
                Profile::Maximum => [0.0, share],
            };
            density.extend([low, high]);
            all.push([x, y, z + thick]);
            [bottom, bottom + 1]
        } else {
            density.push(0.0);
            [bottom, bottom]
        };
        numbers[v as usize] = pair;
        pair
    };
    let hexahedra: Vec<[u32; 8]> = fogged
        .iter()
        .map(|&triangle| {
            // The hexahedron that a wedge is: its lower side, counterclockwise seen from above, then its upper one.
            let [a, b, c] = triangle.map(&mut number);
            [a[0], b[0], c[0], c[0], a[1], b[1], c[1], c[1]]
        })
        .collect();
    let (name, association) = ("density".to_owned(), Association::Point);
    CellMesh {
        points: Points::F32(all),
        file_from_hexahedron: (0..hexahedra.len() as u32).collect(),
        counts: CellCounts { in_file: hexahedra.len() as u64, ..CellCounts::default() },
        hexahedra: hexahedra.into(),
        arrays: vec![Array { name, association, components: 1, values: NumericColumn::from(density) }],
        ..CellMesh::empty()
    }
}
