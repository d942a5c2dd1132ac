use std::collections::BTreeMap;

use glam::DVec3;

use super::*;
use crate::cells::{HEXAHEDRON, OPPOSITE_FACES};
use crate::columns::HexShape;
use crate::generate::{Settings, delaunay, tets};
use crate::stages::project::scene_vertices;
use crate::stages::sort::check::check_order;
use crate::stages::sort::neighbours::neighbours;
use crate::stages::sort::radix::pair;
use crate::stages::testing::whole::{Cells, blocks};
use crate::stages::testing::{Random, random_cells, views};

/// The slow twin: all faces sorted at once.
fn twin(dataset: &Dataset) -> Vec<[u32; 4]> {
    let mut rows = vec![[Adjacency::NONE; 4]; dataset.tets.len()];
    for pair in neighbours(dataset, (0..dataset.tets.len() as u32).into_par_iter()) {
        for (cell, other) in [(pair.ahead, pair.behind), (pair.behind, pair.ahead)] {
            let apex = dataset.tets.get(cell as usize).iter().position(|v| !pair.triangles[0].contains(v)).unwrap();
            rows[cell as usize][apex] = other;
        }
    }
    rows
}

fn meshes() -> Vec<Dataset> {
    let settings = Settings { cells: 20_000, ..Settings::default() };
    let grid = tets(&Settings { jitter: 0.3, ..settings }).unwrap();
    let mut meshes = vec![
        Dataset::from_tets(delaunay(&settings).unwrap()).unwrap(),
        Dataset::from_tets(grid).unwrap(),
        random_cells(500, 0.2, &mut Random::new(3)),
    ];
    // Every second cell again: three or four cells at a face, some on the same side of it.
    let mut doubled = delaunay(&settings).unwrap();
    let again: Vec<[u32; 4]> = doubled.tets.iter().chain(doubled.tets.iter().step_by(2)).copied().collect();
    doubled.file_from_tet = again.iter().map(|_| 0).collect();
    doubled.tets = again.into();
    meshes.push(Dataset::from_tets(doubled).unwrap());
    meshes
}

#[test]
fn neighbours_are_those_of_a_sort_of_all_faces_on_any_threads() {
    for (i, mesh) in meshes().iter().enumerate() {
        let expected = Neighbours::new(mesh);
        assert_eq!((expected.first_wrong(mesh), expected.from_hexahedron.len()), (None, 0), "mesh {i}");
        if i < 3 {
            assert!(expected.from_tet[..] == twin(mesh), "mesh {i}");
        }
        for threads in [1, 2, 5] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            assert!(pool.install(|| Neighbours::new(mesh)) == expected, "mesh {i}, {threads} threads");
        }
    }
}

#[test]
fn cells_that_are_there_twice_have_neighbours_each() {
    let settings = Settings { cells: 20_000, ..Settings::default() };
    let sides = |copies: usize| {
        let mut mesh = delaunay(&settings).unwrap();
        mesh.tets = mesh.tets.iter().flat_map(|&tet| std::iter::repeat_n(tet, copies)).collect();
        mesh.file_from_tet = (0..mesh.tets.len()).map(|_| 0).collect();
        let mesh = Dataset::from_tets(mesh).unwrap();
        let neighbours = Neighbours::new(&mesh);
        assert_eq!(neighbours.first_wrong(&mesh), None);
        neighbours.from_tet.iter().flatten().filter(|&&other| other != Adjacency::NONE).count()
    };
    let once = sides(1);
    assert!(once > 70_000);
    assert_eq!((sides(2), sides(3)), (2 * once, 3 * once));
}

#[test]
fn neighbours_are_used_where_they_are_right_and_made_anew_where_they_are_not() {
    let mut mesh = meshes().swap_remove(0);
    let right = Neighbours::new(&mesh);
    mesh.adjacency = Some(right.clone());
    let used = Adjacency::new(&mesh);
    assert!(used.neighbours_from_tet() == &right.from_tet[..] && used.is_stored());
    let holes = right.from_tet.iter().flatten().filter(|&&other| other == Adjacency::NONE).count();
    assert!(holes > 100 && used.exterior().len() == holes);
    let is_made_anew = |mesh: &Dataset| {
        let made = Adjacency::new(mesh);
        assert!(made.neighbours_from_tet() == &right.from_tet[..]);
        !made.is_stored()
    };
    assert!(!is_made_anew(&mesh));
    for wrong in [0, 7, mesh.cells() as u32, u32::MAX - 1] {
        let mut damaged = right.clone();
        damaged.from_tet.to_mut()[100][2] = wrong;
        assert!(right.from_tet[100][2] != wrong && damaged.first_wrong(&mesh) == Some(100), "{wrong}");
        mesh.adjacency = Some(damaged);
        assert!(is_made_anew(&mesh));
    }
    let mut short = right.clone();
    short.from_tet.to_mut().pop();
    mesh.adjacency = Some(short);
    assert!(is_made_anew(&mesh));
    let mut long = right.clone();
    long.from_hexahedron.to_mut().push([Adjacency::NONE; HEX_FACES]);
    mesh.adjacency = Some(long);
    assert!(is_made_anew(&mesh));
}

#[test]
fn a_row_of_any_cell_that_is_not_its_own_is_found() {
    for (name, mut mesh) in whole_meshes() {
        let right = Neighbours::new(&mesh);
        assert_eq!(right.first_wrong(&mesh), None, "{name}");
        mesh.adjacency = Some(right.clone());
        assert!(Adjacency::new(&mesh).is_stored(), "{name}");
        for hexahedron in (0..right.from_hexahedron.len()).step_by(7) {
            // Faces 2 and 3 exchanged: their neighbours still name the cell.
            let mut damaged = right.clone();
            let row = &mut damaged.from_hexahedron.to_mut()[hexahedron];
            row.swap(2, 3);
            let cell = mesh.tets.len() + hexahedron;
            let has_changed = row[2] != row[3];
            assert_eq!(damaged.first_wrong(&mesh).is_some(), has_changed, "{name}, cell {cell}");
        }
    }
}

/// Faces of four corners, of wedges and pyramids, and of tetrahedra beside them; collapsed, turned round, in points of their own.
fn whole_meshes() -> Vec<(&'static str, Dataset)> {
    let mut random = Random::new(21);
    let cells = Cells::jittered(5, 0.2, &mut random);
    let mixed = Cells::jittered(5, 0.2, &mut random).mixed(&mut random);
    // Corners of one side in one line: some faces are triangles, some lines.
    let pole = Cells::grid([4; 3], |p| if p.x < -0.999 { DVec3::new(p.x, 0.0, p.z) } else { p });
    let mut turned = cells.clone();
    for corners in turned.hexahedra.iter_mut().step_by(2) {
        *corners = HexShape::mirrored(*corners);
    }
    // Every cell has points of its own.
    let mut apart = Cells { points: Vec::new(), ..cells.clone() };
    for corners in &mut apart.hexahedra {
        *corners = corners.map(|v| {
            apart.points.push(cells.points[v as usize]);
            apart.points.len() as u32 - 1
        });
    }
    vec![
        ("hexahedra", cells.dataset()),
        ("mixed", mixed.dataset()),
        ("pole", pole.dataset()),
        ("turned", turned.dataset()),
        ("apart", apart.dataset()),
        ("several blocks of cells", Cells::jittered(18, 0.2, &mut random).mixed(&mut random).dataset()),
        ("blocks", blocks(&[[4, 6, 5], [4, 6, 5]], |block, p| p + DVec3::X * (2 * block) as f64, |cell| cell % 7 == 2)),
        ("mirrored block", blocks(&[[5, 4, 6]], |_, p| DVec3::new(-p.x, p.y, p.z), |_| false)),
        // Cells of the middle have no volume.
        ("flat cells", blocks(&[[4, 6, 6]], |_, p| if p.z.abs() < 0.3 { p.with_z(0.0) } else { p }, |_| false)),
    ]
}

/// The slow twin: faces as sets of places, compared all with all.
fn places_twin(dataset: &Dataset) -> Vec<[u32; HEX_FACES]> {
    let place = |v: u32| dataset.positions[v as usize].map(|x| (x + 0.0).to_bits());
    let is_structured = !dataset.hexahedra.structured_blocks().is_empty();
    let mut sides: BTreeMap<Vec<[u32; 4]>, Vec<(u32, usize)>> = BTreeMap::new();
    for cell in 0..dataset.cells() {
        let vertex = dataset.corners(cell);
        let faces: Vec<Vec<usize>> = match cell.checked_sub(dataset.tets.len()) {
            None => OPPOSITE_FACES.map(|face| face.to_vec()).to_vec(),
            Some(hexahedron) if dataset.hexahedra.view().shape(hexahedron).is_absent() => continue,
            Some(_) => HEXAHEDRON.faces.iter().map(|face| face.iter().map(|&i| usize::from(i)).collect()).collect(),
        };
        for (k, face) in faces.iter().enumerate() {
            // Blocks adjoin by their vertices, and vertices of their own stand for themselves.
            let at = |&i: &usize| {
                let [x, y, z] = place(vertex[i]);
                [x, y, z, if is_structured { vertex[i] } else { 0 }]
            };
            let mut corners: Vec<[u32; 4]> = face.iter().map(at).collect();
            corners.sort_unstable();
            corners.dedup();
            if corners.len() > 2 {
                sides.entry(corners).or_default().push((cell as u32, k));
            }
        }
    }
    let mut rows = vec![[Adjacency::NONE; HEX_FACES]; dataset.cells()];
    for two in sides.values().filter(|sides| sides.len() == 2) {
        for (from, to) in [(two[0], two[1]), (two[1], two[0])] {
            rows[from.0 as usize][from.1] = to.0;
        }
    }
    rows
}

#[test]
fn whole_cells_adjoin_where_their_faces_have_the_same_corners() {
    for (name, mesh) in whole_meshes() {
        let (adjacency, expected) = (Adjacency::new(&mesh), places_twin(&mesh));
        let rows: Vec<_> = (0..mesh.cells() as u32).map(|cell| adjacency.neighbours(&mesh, cell)).collect();
        let shared = rows.iter().flatten().filter(|&&other| other != Adjacency::NONE).count();
        println!("{name}: {} cells, {shared} sides of shared faces", mesh.cells());
        assert!(shared > 2 * mesh.cells() && rows == expected, "{name}");
        // What is left is outside.
        let hexahedra = mesh.hexahedra.view();
        let faces = (0..hexahedra.len()).filter(|&cell| !hexahedra.shape(cell).is_absent()).count() * HEX_FACES;
        assert_eq!(adjacency.exterior().len() + shared, faces + mesh.tets.len() * TET_FACES, "{name}");
        // Nothing is stored of blocks.
        let of_exterior = size_of_val(adjacency.exterior()) as u64;
        let stored = adjacency.owned_bytes() - of_exterior;
        let expected = if mesh.hexahedra.structured_blocks().is_empty() {
            mesh.tets.len() * 16 + mesh.hexahedra.len() * 24
        } else {
            0
        };
        assert_eq!(stored, expected as u64, "{name}");
        for threads in [1, 2, 5] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            assert!(pool.install(|| Neighbours::new(&mesh)) == Neighbours::new(&mesh), "{name}, {threads} threads");
        }
    }
}

#[test]
fn a_cell_that_lies_on_the_same_side_of_a_face_is_no_neighbour() {
    // The second cell is folded back over the first.
    for is_structured in [false, true] {
        let fold = |p: DVec3| DVec3::new(if p.x > 0.0 { -0.5 } else { p.x }, p.y, p.z);
        let mesh = if is_structured {
            blocks(&[[3, 2, 2]], |_, p| fold(p), |_| false)
        } else {
            Cells::grid([2, 1, 1], fold).dataset()
        };
        let adjacency = Adjacency::new(&mesh);
        assert_eq!((mesh.cells(), mesh.counts.inverted, adjacency.exterior().len()), (2, 1, 12));
        let vertices = scene_vertices(&mesh, &mesh.homogeneous_field());
        let check = check_order(&mesh, &vertices, &views(&mesh, 40, 40)[0], &[pair(0, 0), pair(1, 1)]);
        assert_eq!(check.pairs, 0);
    }
}
