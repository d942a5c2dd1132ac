//! `surface`: the boundary of a mesh as triangles.
//!
//! In: the faces without a cell across, each with its cell. Out: their triangles, counterclockwise seen from outside; faces of four
//! corners are cut along the diagonal along which their cells are. Two exterior faces that stand in one place and look at each other are a
//! seam and no boundary: blocks that touch, a grid that closes upon itself, meshes that were joined. O(exterior faces).

use arrayvec::ArrayVec;
use rayon::prelude::*;

use super::{List, Primitive};
use crate::cells::{HEXAHEDRON, OPPOSITE_FACES, OUTWARD_IF_POSITIVE};
use crate::columns::{Dataset, PolyFace, place};
use crate::stages::scene_per_world;
use crate::stages::sort::adjacency::Face;

/// The boundary surface of `dataset`, of whose tetrahedra and hexahedra `exterior` are the faces without a cell across
/// ([`Adjacency::exterior`](crate::stages::sort::adjacency::Adjacency::exterior)).
///
/// ```
/// use cellfan::{Dataset, generate, geometry, stages::sort::adjacency::Adjacency};
/// // Eight cubes of six tetrahedra: six sides of four squares, two triangles each.
/// let mesh = generate::tets(&generate::Settings { cells: 48, ..Default::default() })?;
/// let dataset = Dataset::from_tets(mesh)?;
/// let surface = geometry::surface(&dataset, Adjacency::new(&dataset).exterior());
/// assert_eq!(surface.len(), 6 * 4 * 2);
/// # Ok::<(), cellfan::Error>(())
/// ```
pub fn surface(dataset: &Dataset, exterior: &[Face]) -> List {
    let of_polyhedra: Vec<PolyFace> = dataset.polyhedra.exterior().collect();
    let seams = Seams::of(dataset, exterior, &of_polyhedra);
    let scale = scene_per_world(dataset);
    let in_scene = |vertex: u32| in_scene(dataset, vertex, scale);
    let triangles = exterior
        .par_iter()
        .enumerate()
        .filter(|&(i, _)| !seams.holds(i))
        .flat_map_iter(|(_, &face)| triangles_of(dataset, face).into_iter().flatten().map(in_scene));
    let others = of_polyhedra.par_iter().enumerate().filter(|&(i, _)| !seams.holds(exterior.len() + i));
    let others = others.flat_map_iter(|(_, face)| face.triangles().flatten().map(in_scene));
    List::new(Primitive::Triangles, triangles.chain(others).collect())
}

/// The position of a vertex in scene units.
#[inline]
pub(super) fn in_scene(dataset: &Dataset, vertex: u32, scale: f64) -> [f32; 3] {
    dataset.positions[vertex as usize].map(|x| (f64::from(x) * scale) as f32)
}

/// The vertices of the triangles of a face; those of coincident corners have no area and are left out.
fn triangles_of(dataset: &Dataset, face: Face) -> ArrayVec<[u32; 3], 2> {
    let (cell, k) = (face.cell as usize, face.index as usize);
    let Some(hexahedron) = cell.checked_sub(dataset.tets.len()) else {
        let tet = dataset.tets.get(cell);
        let [a, b, c] = OPPOSITE_FACES[k].map(|i| tet[i]);
        let is_outward = dataset.positive.get(cell) == OUTWARD_IF_POSITIVE[k];
        return std::iter::once(if is_outward { [a, b, c] } else { [a, c, b] }).collect();
    };
    let hexahedra = dataset.hexahedra.view();
    let corners = hexahedra.get(hexahedron);
    let at = |vertex: u32| place(dataset.positions[vertex as usize]);
    let triangles = hexahedra.shape(hexahedron).triangles(k).map(|triangle| triangle.map(|i| corners[usize::from(i)]));
    let has_area = |[a, b, c]: &[u32; 3]| at(*a) != at(*b) && at(*b) != at(*c) && at(*c) != at(*a);
    triangles.into_iter().filter(has_area).collect()
}

/// Exterior faces across which another lies all the same.
struct Seams(Vec<bool>);

/// Where the corners of a face stand, ascending; a triangle repeats its last.
type Places = [[u32; 3]; 4];

impl Seams {
    /// Finds them by where their corners stand.
    fn of(dataset: &Dataset, exterior: &[Face], of_polyhedra: &[PolyFace]) -> Self {
        let places = |face: &Face| -> Places {
            let (cell, k) = (face.cell as usize, face.index as usize);
            let at = |vertex: u32| place(dataset.positions[vertex as usize]);
            let mut places = match cell.checked_sub(dataset.tets.len()) {
                None => {
                    let tet = dataset.tets.get(cell);
                    let [a, b, c] = OPPOSITE_FACES[k].map(|i| at(tet[i]));
                    [a, b, c, a.max(b).max(c)]
                }
                Some(hexahedron) => {
                    let corners = dataset.hexahedra.view().get(hexahedron);
                    std::array::from_fn(|i| at(corners[usize::from(HEXAHEDRON.faces[k][i])]))
                }
            };
            places.sort_unstable();
            places
        };
        let mut by_place: Vec<(Places, u32)> =
            exterior.par_iter().zip(0..exterior.len() as u32).map(|(face, i)| (places(face), i)).collect();
        // Faces of more corners have no like among those of other kinds.
        let few = of_polyhedra.iter().zip(exterior.len() as u32..).filter(|(face, _)| face.around.len() <= 4);
        by_place.extend(few.map(|(face, i)| {
            let at = |k: usize| place(dataset.positions[face.around[k] as usize]);
            let mut places: Places = if let [_, _, _, _] = face.around {
                std::array::from_fn(at)
            } else {
                [at(0), at(1), at(2), at(0).max(at(1)).max(at(2))]
            };
            places.sort_unstable();
            (places, i)
        }));
        by_place.par_sort_unstable();
        let mut is_seam = vec![false; exterior.len() + of_polyhedra.len()];
        for faces in by_place.chunk_by(|a, b| a.0 == b.0).filter(|faces| faces.len() == 2) {
            for &(_, i) in faces {
                is_seam[i as usize] = true;
            }
        }
        Self(is_seam)
    }

    fn holds(&self, face: usize) -> bool {
        self.0[face]
    }
}
