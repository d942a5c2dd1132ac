//! Several meshes as one: numbering, arrays, and which mesh an error is in.

use std::path::PathBuf;

use super::*;

const CORNERS: [[f32; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// A tetrahedron and a triangle, `x` to the right.
fn tetrahedron(x: f32, arrays: Vec<Array>) -> UnstructuredMesh {
    UnstructuredMesh {
        points: Points::F32(CORNERS.iter().map(|p| [p[0] + x, p[1], p[2]]).collect()),
        types: vec![5, 10].into(),
        offsets: vec![0, 3, 7].into(),
        connectivity: vec![0, 1, 2, 0, 1, 2, 3].into(),
        arrays,
        ..UnstructuredMesh::empty()
    }
}

/// Blocks of a grid of unit cells, `x` to the right.
fn blocks(dims: &[[usize; 3]], x: f64, arrays: Vec<Array>) -> StructuredMesh {
    let point = |[ni, nj, _]: [usize; 3], i: usize| [x + (i % ni) as f64, (i / ni % nj) as f64, (i / ni / nj) as f64];
    let points = dims.iter().flat_map(|&dims| (0..dims.iter().product()).map(move |i| point(dims, i)));
    StructuredMesh::new(dims, Points::F64(points.collect()), arrays).unwrap()
}

fn array(name: &str, association: Association, values: impl Into<NumericColumn>) -> Array {
    Array { name: name.to_owned(), association, components: 1, values: values.into() }
}

fn join(meshes: Vec<Mesh>) -> Result<Mesh> {
    Mesh::join(meshes.into_iter().enumerate().map(|(i, mesh)| (PathBuf::from(format!("mesh {i}")), mesh)).collect())
}

/// Name, type and values of each array.
fn described(mesh: &Mesh) -> Vec<(String, &'static str, Vec<f64>)> {
    let describe = |array: &Array| (array.name.clone(), array.values.type_name(), values(&array.values));
    mesh.arrays().iter().map(describe).collect()
}

#[test]
fn cells_of_all_kinds_are_numbered_through() {
    let id = |values: Vec<i32>| vec![array("id", Association::Cell, values)];
    // A block of hexahedra, and one each of quadrilaterals, lines and a vertex.
    let dims = [[2, 3, 2], [1, 3, 2], [3, 1, 1], [1, 1, 1]];
    let meshes = || {
        [
            Mesh::from(tetrahedron(0.0, id(vec![0, 1]))),
            blocks(&dims, 5.0, id((2..9).collect())).into(),
            tetrahedron(9.0, id(vec![9, 10])).into(),
        ]
    };
    let mesh = unstructured(join(meshes().to_vec()).unwrap());
    assert_eq!((mesh.points.len(), mesh.cells()), (4 + 12 + 6 + 3 + 1 + 4, 11));
    assert_eq!(mesh.types[..], [5, 10, 12, 12, 9, 9, 3, 3, 1, 5, 10]);
    assert_eq!(mesh.cell(3).unwrap(), [6, 7, 9, 8, 12, 13, 15, 14], "VTK's order around the faces");
    assert_eq!(mesh.cell(4).unwrap(), [16, 17, 20, 19], "a face in the plane of j and k");
    assert_eq!(mesh.cell(8).unwrap(), [25]);
    assert_eq!(values(&mesh.arrays[0].values), (0..11).map(f64::from).collect::<Vec<_>>());
    for dataset in [join(meshes().to_vec()).unwrap().into_whole_dataset(), Mesh::from(mesh).into_dataset()] {
        let dataset = dataset.unwrap();
        assert_eq!((dataset.counts.in_file, dataset.counts.lower_dimensional), (11, 7));
        for cell in 0..dataset.cells() {
            let x = dataset.origin.x + f64::from(dataset.positions[dataset.corners(cell)[0] as usize][0]);
            let expected = match dataset.cell_tuple(cell) {
                1 => 0.0..=1.0,
                2 | 3 => 5.0..=6.0,
                10 => 9.0..=10.0,
                other => panic!("cell {other} has no volume"),
            };
            assert!(expected.contains(&x), "{x}");
        }
    }
    // Blocks alone stay blocks.
    let mesh = structured(join(vec![meshes()[1].clone(), blocks(&[[2, 2, 2]], 7.0, vec![]).into()]).unwrap());
    assert_eq!((mesh.blocks().len(), mesh.cells()), (5, 8));
}

#[test]
fn arrays_are_matched_by_name_and_association() {
    let (point, cell) = (Association::Point, Association::Cell);
    let first = tetrahedron(
        0.0,
        vec![
            array("only here", point, vec![1.0_f32; 4]),
            array("single", point, vec![1.0_f32, 2.0, 3.0, 4.0]),
            array("mixed", cell, vec![1_i32, 2]),
            array("whole, only here", cell, vec![7_u8, 8]),
            Array { components: 2, ..array("two or one", cell, vec![1_u8; 4]) },
            array("vtkGhostType", cell, vec![0_u8, 1]),
        ],
    );
    let second = tetrahedron(
        2.0,
        vec![
            array("mixed", cell, vec![0.5_f32, 0.25]),
            array("single", point, vec![5.0_f32; 4]),
            array("only here", cell, vec![3_i64, 4]),
            array("two or one", cell, vec![1_u8; 2]),
        ],
    );
    let mesh = join(vec![first.into(), second.into()]).unwrap();
    let found = described(&mesh);
    let names: Vec<_> = found.iter().map(|(name, number, _)| (name.as_str(), *number)).collect();
    assert_eq!(
        names,
        [
            ("single", "f32"),
            ("mixed", "f64"),
            ("vtkGhostType", "u8"),
            ("only here", "f32"),
            ("whole, only here", "f64"),
            ("only here", "f64"),
        ],
        "those of all meshes first"
    );
    assert_eq!(found[1].2, [1.0, 2.0, 0.5, 0.25]);
    assert_eq!(found[2].2, [0.0, 1.0, 0.0, 0.0], "what has no ghosts hides nothing");
    assert!(found[3].2[..4] == [1.0; 4] && found[3].2[4..].iter().all(|value| value.is_nan()));
    assert!(found[5].2[..2].iter().all(|value| value.is_nan()) && found[5].2[2..] == [3.0, 4.0]);
    let dataset = mesh.into_dataset().unwrap();
    assert_eq!((dataset.counts.ghost, dataset.tets.len()), (1, 1));
}

#[test]
fn arrays_of_their_own_do_not_grow_as_the_square_of_the_meshes() {
    let mesh =
        |i: usize| Mesh::from(tetrahedron(i as f32, vec![array(&i.to_string(), Association::Point, vec![1_u8; 4])]));
    for count in [250, 600] {
        let joined = join((0..count).map(mesh).collect()).unwrap();
        let values: usize = joined.arrays().iter().map(|array| array.values.len()).sum();
        // Of each mesh: twelve coordinates, two cells, four values.
        assert!(values <= (64 * (12 + 2 + 4) + 4) * count, "{values}");
        assert_eq!(joined.arrays().len() == count, count == 250);
    }
}

#[test]
fn an_error_names_the_mesh_it_is_in() {
    let good = || Mesh::from(tetrahedron(0.0, vec![]));
    let mut broken: Vec<(Mesh, &str)> = Vec::new();
    let mut add = |change: &dyn Fn(&mut UnstructuredMesh), expected| {
        let mut mesh = tetrahedron(3.0, vec![]);
        change(&mut mesh);
        broken.push((mesh.into(), expected));
    };
    add(&|mesh| mesh.connectivity.to_mut()[3] = 4, "refers to point 4, but there are only 4");
    add(&|mesh| mesh.offsets.to_mut()[2] = 8, "entries 3 to 8");
    add(&|mesh| mesh.offsets.to_mut().truncate(2), "offsets");
    add(&|mesh| mesh.types.to_mut()[1] = 12, "hexahedron");
    add(&|mesh| mesh.arrays.push(array("long", Association::Cell, vec![0_u8; 3])), "\"long\"");
    add(&|mesh| mesh.points = Points::F32(vec![[f32::NAN; 3]; 4]), "point 0 is used");
    let mut grid = blocks(&[[2, 2, 2]], 0.0, vec![]);
    let (mut points, _) = grid.clone().into_columns();
    let Points::F64(coordinates) = &mut points else { panic!("double precision") };
    coordinates[7][1] = f64::INFINITY;
    grid = StructuredMesh::new(&[[2, 2, 2]], points, vec![]).unwrap();
    broken.push((grid.into(), "point 7 is used"));
    for (mesh, expected) in broken {
        let error = join(vec![good(), mesh.clone(), good()]).unwrap_err().to_string();
        assert!(error.starts_with("mesh 1: ") && error.contains(expected), "{error}");
        // Alone it is no joining's matter.
        assert!(join(vec![mesh]).is_ok());
    }
    assert!(matches!(join(vec![]).unwrap().into_dataset(), Err(Error::NoCells { .. })));
}

#[test]
fn a_container_among_files_is_its_mesh() {
    use crate::generate::{Settings, delaunay};
    let folder = tempfile::tempdir().unwrap();
    for offset in [0.0, 1e6] {
        let mesh = |seed: u64| {
            let mesh = delaunay(&Settings { cells: 500, seed, ..Settings::default() }).unwrap();
            let shift = offset + 2.0 * seed as f64;
            let points = (0..mesh.points.len()).map(|i| (mesh.points.get(i) + shift).to_array()).collect();
            crate::columns::TetMesh { points: Points::F64(points), ..mesh }
        };
        let [vtu, cells, other] = ["a.vtu", "a.cells", "b.vtu"].map(|name| folder.path().join(name));
        for (path, seed) in [(&vtu, 1), (&other, 2)] {
            write_vtu(path, &UnstructuredMesh::from_tets(&mesh(seed)), Compression::None).unwrap();
        }
        container::write(&mesh(1), &cells, &container::WriteOptions::default(), &|_, _, _| {}).unwrap();
        let [a, b] = [vtu, cells].map(|path| open_all(&[path, other.clone()]).unwrap());
        assert_eq!(a.counts.in_file, b.counts.in_file);
        assert_eq!(b.counts.inverted, open(&other).unwrap().counts.inverted, "a container's cells are turned already");
        assert!((a.diagonal_world() - b.diagonal_world()).abs() < 1e-5 && a.diagonal_world() > 4.0);
        // The same cells, by their values.
        let described = |data: &Dataset| {
            let value = |tuple: usize| data.arrays[0].values.get(tuple).to_bits();
            let cell = |cell: usize| {
                let mut corners: Vec<_> =
                    data.corners(cell).iter().map(|&v| value(data.point_tuple(v as usize))).collect();
                corners.sort_unstable();
                corners
            };
            let mut all: Vec<_> = (0..data.cells()).map(cell).collect();
            all.sort_unstable();
            all
        };
        assert_eq!(described(&a), described(&b), "{offset}");
    }
}
