//! When rays are left to others, and what they notice; their pictures are compared in `tests/pictures`.

use std::sync::Arc;

use super::*;
use crate::backends::Frame;
use crate::columns::{CellCounts, Dataset, Field, Points, TetMesh};
use crate::control::Control;
use crate::generate;
use crate::optics::{CullTable, EmissionAbsorption, Model, Pieces, TransferFunction};
use crate::stages::View;
use crate::stages::fans::Faces;
use crate::stages::project::scene_vertices;
use crate::stages::sort::adjacency::Adjacency;
use crate::stages::sort::{KeyMaker, SortKey};

struct Case {
    dataset: Dataset,
    field: Field,
    vertices: Vec<SceneVertex>,
    mates: Mates,
    pieces: Pieces,
    cull_table: CullTable,
}

impl Case {
    fn new(dataset: Dataset) -> Self {
        let field = dataset.homogeneous_field();
        let vertices = scene_vertices(&dataset, &field);
        let mates = Mates::new(&dataset, &Adjacency::new(&dataset));
        let pieces = TransferFunction::constant([1.0; 3], 0.7).unwrap().pieces(field.offset);
        let cull_table = CullTable::new(&pieces, Model::EmissionAbsorption);
        Self { dataset, field, vertices, mates, pieces, cull_table }
    }

    fn draw(&self, view: &View) -> Option<FollowedRays> {
        let control = Arc::new(Control::default());
        let frame = Frame {
            dataset: &self.dataset,
            cubes: None,
            field: &self.field,
            vertices: &self.vertices,
            pieces: &self.pieces,
            bands: None,
            mates: Some(&self.mates),
            cull_table: &self.cull_table,
            view,
            keys: KeyMaker::new(SortKey::None, view, &[]),
            is_exact: true,
            tiles: None,
            faces: Faces::Exact,
            stop_transmittance: 0.0,
            memory_bytes: None,
            control: &control,
            still: None,
            opaque: None,
        };
        let optics = EmissionAbsorption { pieces: &self.pieces };
        RayCompositor::default().draw(&frame, &self.mates, &optics, &mut Profile::default())
    }
}

#[test]
fn an_eye_in_the_mesh_is_left_to_others() {
    let settings = generate::Settings { cells: 600, ..Default::default() };
    let case = Case::new(Dataset::from_tets(generate::tets(&settings).unwrap()).unwrap());
    let camera = crate::Camera::looking_at([0.4, 0.5, 0.6].into(), [0.0; 3].into(), 40, 40);
    assert!(case.draw(&View::new(&camera, &case.dataset).unwrap()).is_none());
    let outside = crate::Camera::looking_at([3.0, 2.5, 1.6].into(), [0.5; 3].into(), 40, 40);
    let drawn = case.draw(&View::new(&outside, &case.dataset).unwrap()).unwrap();
    assert!(drawn.counts.violations == 0 && !drawn.is_out_of_order.contains(&true));
    assert!(drawn.image.covered([0.0; 4]) > 100);
}

/// Cells of about `size` about the origin, of which none shares a vertex.
fn cells_anywhere(count: u32, size: f64) -> Dataset {
    // Fractions of multiples of irrational numbers: spread evenly, the same each time.
    let at = |n: u32| [2.0_f64, 3.0, 5.0].map(|of| 2.0 * (of.sqrt() * f64::from(n)).fract() - 1.0);
    let corner = |n: u32| std::array::from_fn(|axis| at(n / 4)[axis] + size * at(7 * n + 1)[axis]);
    Dataset::from_tets(TetMesh {
        points: Points::F64((0..4 * count).map(corner).collect()),
        tets: (0..count).map(|i| [0, 1, 2, 3].map(|k| 4 * i + k)).collect(),
        file_from_tet: (0..count).collect(),
        arrays: Vec::new(),
        counts: CellCounts::default(),
    })
    .unwrap()
}

#[test]
fn cells_that_overlap_are_noticed_where_they_do() {
    let camera = crate::Camera::looking_at([4.0, 2.5, 1.6].into(), [0.0; 3].into(), 64, 64);
    let parallel =
        crate::Camera { projection: crate::Projection::Orthographic { height_world: 3.0 }, ..camera.clone() };
    for (count, size, overlap) in [(300, 0.6, true), (3, 0.05, false)] {
        let case = Case::new(cells_anywhere(count, size));
        for camera in [&camera, &parallel] {
            let drawn = case.draw(&View::new(camera, &case.dataset).unwrap()).unwrap();
            let covered = drawn.image.covered([0.0; 4]);
            println!("{count} cells: {} rays of {covered} found cells out of order", drawn.counts.violations);
            assert!(covered > 0 && (drawn.counts.violations > 0) == overlap);
            assert_eq!(drawn.is_out_of_order.contains(&true), overlap);
        }
    }
}
