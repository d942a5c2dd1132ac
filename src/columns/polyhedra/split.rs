//! A polyhedron as tetrahedra: a fan from a vertex that every face it touches is a fan around, so that neighbours agree.

use glam::Vec3;

use super::skin::Skin;
use super::{FaceLists, PolyFace};

/// A tetrahedron may be inverted by this share of the cell's volume: it is flat, on a face in the fan's vertex' plane.
const FLAT: f64 = 1e-6;

impl FaceLists {
    /// The tetrahedra of cell `cell`, whose points are compared by `canonical` and stand at `position`; nothing of a cell that
    /// is open, has no volume, or is not filled by a fan from its lowest point, as some are that are not convex.
    pub(crate) fn split(
        &self,
        cell: usize,
        canonical: impl Fn(u32) -> u32,
        position: impl Fn(u32) -> Vec3,
    ) -> Option<Vec<[u32; 4]>> {
        let skin = Skin::new(self.faces(cell), canonical, &position).ok()?;
        let faces = skin.faces.iter().map(|face| PolyFace { number: 0, around: face, is_reversed: false });
        fan(faces, position)
    }
}

/// The same of a cell with these faces.
pub(in crate::columns) fn fan<'a>(
    faces: impl Iterator<Item = PolyFace<'a>> + Clone,
    position: impl Fn(u32) -> Vec3,
) -> Option<Vec<[u32; 4]>> {
    let mut behind: Vec<u32> = faces.clone().flat_map(|face| &face.around[1..]).copied().collect();
    behind.sort_unstable();
    let apex = faces.clone().map(|face| face.around[0]).find(|first| behind.binary_search(first).is_err())?;
    let others = faces.filter(|face| face.around[0] != apex);
    let tets: Vec<[u32; 4]> = others.flat_map(PolyFace::triangles).map(|[a, b, c]| [a, b, c, apex]).collect();
    let volume = |tet: &[u32; 4]| {
        let [a, b, c, d] = tet.map(|vertex| position(vertex).as_dvec3());
        // The apex lies behind the triangle, seen from outside.
        -(b - a).cross(c - a).dot(d - a)
    };
    let (mut whole, mut lowest) = (0.0, 0.0_f64);
    for tet in &tets {
        let volume = volume(tet);
        whole += volume;
        lowest = lowest.min(volume);
    }
    (lowest >= -FLAT * whole).then_some(tets)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dented_cell_is_not_cut_and_a_bulging_one_is() {
        for (height, tets) in [(1.5, Some(4)), (0.9, Some(4)), (-0.1, None)] {
            // A tent over the unit square with a floor of four triangles that bulges down; its tip above the square, or below it.
            let points: [Vec3; 6] = [
                Vec3::ZERO,
                Vec3::X,
                Vec3::new(1.0, 1.0, 0.0),
                Vec3::Y,
                Vec3::new(0.5, 0.5, height),
                Vec3::new(0.5, 0.5, -0.2),
            ];
            let mut lists = FaceLists::default();
            for i in 0..4 {
                lists.push_face(&[i, (i + 1) % 4, 4]);
                lists.push_face(&[(i + 1) % 4, i, 5]);
            }
            lists.end_cell();
            let found = lists.split(0, |point| point, |point| points[point as usize]);
            assert_eq!(found.map(|tets| tets.len()), tets, "tip at {height}");
        }
    }
}
