use super::*;
use crate::cells::{VOXEL, diagonals, hexahedron_of};
use crate::columns::{CellCounts, CellMesh, Dataset, Points};
use crate::stages::fans::{Faces, FanStyle, PlanesFor};
use crate::stages::project::{project, scene_vertices};
use crate::stages::testing::polyhedra::{KINDS, unit};
use crate::stages::testing::{Random, views};

#[test]
fn records_hold_every_case() {
    for kind in KINDS {
        for case in Projections::of(kind).unwrap().cases() {
            let vertices: ArrayVec<FanVertex, { Case::VERTICES_MAX }> = (0..case.inner.len() + case.crossings.len())
                .map(|i| FanVertex { position_px: [i as f32, 0.0], ..FanVertex::default() })
                .collect();
            assert!(case.triangles.len() <= CaseFan::TRIANGLES_MAX, "{}", case.name);
            let fan = CaseFan::new(&CellFans { vertices, triangles: &case.triangles }, [0.0, 1.0]);
            let number = |vertex: FanVertex| vertex.position_px[0] as u8;
            let triangles: Vec<_> = fan.triangles().map(|triangle| triangle.map(number)).collect();
            assert_eq!(triangles, case.triangles);
            let fans: [Fan; CaseFan::FANS] = bytemuck::cast(fan);
            assert_eq!(CaseFan::of_record(&fans), Some(fan));
            assert_eq!(CaseFan::of_record(&[Fan::default(); CaseFan::FANS]), None);
        }
    }
}

/// A mesh of one cell of `kind`, its points in a random order, mirrored or not; moved a little.
fn one_cell(kind: &CellKind, is_mirrored: bool, random: &mut Random) -> Dataset {
    let mut p = unit(kind);
    for p in &mut p {
        *p += random.point() * 0.08;
        p.x *= if is_mirrored { -1.0 } else { 1.0 };
    }
    let mut order: Vec<u32> = (0..p.len() as u32).collect();
    for i in (1..order.len()).rev() {
        order.swap(i, (random.unit() * (i + 1) as f64) as usize);
    }
    let mut points = vec![[0.0; 3]; p.len()];
    for (&place, p) in order.iter().zip(&p) {
        points[place as usize] = p.to_array();
    }
    let corners = hexahedron_of(kind).unwrap().map(|corner| order[corner]);
    Dataset::from_cells(CellMesh {
        points: Points::F64(points),
        tets: Vec::new().into(),
        file_from_tet: Vec::new().into(),
        hexahedra: vec![corners].into(),
        file_from_hexahedron: vec![0].into(),
        arrays: Vec::new(),
        counts: CellCounts { in_file: 1, ..CellCounts::default() },
        ..CellMesh::empty()
    })
    .unwrap()
}

#[test]
fn cells_are_the_kind_that_they_are_and_cut_as_their_faces_are() {
    let mut random = Random::new(9);
    for (kind, is_mirrored) in KINDS.iter().flat_map(|kind| [(kind, false), (kind, true)]) {
        for _ in 0..50 {
            let dataset = one_cell(kind, is_mirrored, &mut random);
            let hexahedra = dataset.hexahedra.view();
            let (vertex, shape) = (hexahedra.get(0), hexahedra.shape(0));
            let (found, corners) = kind_of(vertex);
            assert!(found == *kind || *kind == &VOXEL, "{}", kind.name);

            // Positive in space, and its diagonals those of the table.
            let at = |corner: u8| Vec3::from_array(dataset.positions[vertex[usize::from(corner)] as usize]);
            let numbers: Vec<u32> = corners
                .iter()
                .map(|&c| dataset.file_from_vertex.as_ref().unwrap()[vertex[usize::from(c)] as usize])
                .collect();
            assert_eq!(diagonals_of(found, &corners, vertex, shape), diagonals(found, &numbers, |number| number));
            let inner = corners.iter().map(|&corner| at(corner)).sum::<Vec3>() / corners.len() as f32;
            for face in found.faces {
                let [a, b, c] = [0, 1, 2].map(|i| at(corners[usize::from(face[i])]));
                assert!((b - a).cross(c - a).dot(a - inner) > 0.0, "{} {is_mirrored}", found.name);
            }

            // The parts fill the cell.
            let vertices = scene_vertices(&dataset, &dataset.homogeneous_field());
            for view in views(&dataset, 64, 64) {
                let mut screen = Vec::new();
                project(&view, &vertices, &mut screen);
                let style = FanStyle { planes_for: PlanesFor::NoCells, faces: Faces::Fan };
                let input = FanInput::new(&view, &dataset, &vertices, &screen, None, style);
                let parts = input.parts(vertex, shape, None);
                let volume = |tet: &Tet| {
                    let [a, b, c, d] =
                        tet.vertices().map(|v| Vec3::from_array(dataset.positions[v as usize]).as_dvec3());
                    (b - a).cross(c - a).dot(d - a).abs() / 6.0
                };
                let whole = shape.volume(vertex.map(|v| Vec3::from_array(dataset.positions[v as usize])));
                let sum: f64 = parts.iter().map(volume).sum();
                assert!(parts.len() <= 6 && (sum - whole).abs() < 1e-5 * whole, "{}: {sum}, not {whole}", found.name);
            }
        }
    }
}
