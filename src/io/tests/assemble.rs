use super::samples::mesh;
use super::*;

fn ghosts(name: &str, association: Association, values: Vec<u8>) -> Array {
    Array { name: name.to_owned(), association, components: 1, values: values.into() }
}

#[test]
fn tetrahedra_pass_and_others_are_split_and_counted() {
    let tets = mesh().into_tets().unwrap();
    assert_eq!(tets.tets[..], [[0, 1, 2, 5], [1, 2, 3, 5], [1, 3, 4, 5]]);
    assert_eq!(tets.file_from_tet[..], [0, 1, 1]);
    assert_eq!((tets.counts.in_file, tets.counts.split), (2, 1));
}

#[test]
fn ghosts_lower_dimensional_and_unknown_cells_are_left_out_and_counted() {
    for (array, ghost) in [
        (ghosts("vtkGhostType", Association::Cell, vec![32, 0]), 1),
        (ghosts("vtkGhostType", Association::Cell, vec![1, 2]), 1),
        (ghosts("vtkGhostLevels", Association::Cell, vec![0, 1]), 1),
        (ghosts("vtkGhostType", Association::Point, vec![0, 0, 0, 0, 2, 0]), 1),
        (ghosts("vtkGhostType", Association::Point, vec![1; 6]), 0),
    ] {
        let mut mesh = mesh();
        mesh.arrays.push(array);
        assert_eq!(mesh.into_tets().unwrap().counts.ghost, ghost);
    }
    let mut other = mesh();
    other.types = vec![9, 41].into();
    let counts = other.into_tets().unwrap().counts;
    assert_eq!((counts.lower_dimensional, counts.unsupported), (1, 1));
}

#[test]
fn quadratic_cells_are_drawn_by_their_corners() {
    let mut mesh = mesh();
    mesh.types = vec![24].into();
    mesh.offsets = vec![0, 10].into();
    mesh.connectivity = vec![0, 1, 2, 5, 3, 3, 3, 3, 3, 3].into();
    mesh.arrays.clear();
    let tets = mesh.into_tets().unwrap();
    assert_eq!(tets.tets[..], [[0, 1, 2, 5]]);
    assert_eq!(tets.counts.quadratic, 1);
}

#[test]
fn coincident_points_count_as_one_when_faces_are_cut() {
    // Two cubes that touch at x = 1 with points of their own, numbered so that the copies would be cut otherwise.
    let corners = [(0, 0), (1, 0), (1, 1), (0, 1)];
    let cube = |x: f32| (0..8).map(move |i| [x + corners[i % 4].0 as f32, corners[i % 4].1 as f32, (i / 4) as f32]);
    let mut points: Vec<[f32; 3]> = cube(0.0).collect();
    points.extend(cube(1.0).collect::<Vec<_>>().into_iter().rev());
    let mesh = UnstructuredMesh {
        points: Points::F32(points.clone()),
        types: vec![12, 12].into(),
        offsets: vec![0, 8, 16].into(),
        connectivity: (0..8).chain((8..16).rev()).collect(),
        arrays: Vec::new(),
        ..UnstructuredMesh::empty()
    };
    let tets = mesh.into_tets().unwrap().tets;
    let on_face = |tets: &[[u32; 4]]| {
        let mut triangles: Vec<Vec<[u32; 3]>> = Vec::new();
        for tet in tets {
            let at = tet.iter().map(|&p| points[p as usize]).filter(|p| p[0] == 1.0);
            let mut triangle: Vec<[u32; 3]> = at.map(|p| p.map(f32::to_bits)).collect();
            triangle.sort_unstable();
            if triangle.len() == 3 {
                triangles.push(triangle);
            }
        }
        triangles.sort_unstable();
        triangles
    };
    assert_eq!(on_face(&tets[..6]).len(), 2);
    assert_eq!(on_face(&tets[..6]), on_face(&tets[6..]));
}

#[test]
fn what_does_not_fit_together_is_an_error() {
    type Damage = fn(&mut UnstructuredMesh);
    let cases: [(Damage, &str); 8] = [
        (|mesh| mesh.connectivity.to_mut()[8] = 6, "refers to point 6"),
        (|mesh| mesh.offsets.to_mut()[1] = 10, "connectivity"),
        (|mesh| mesh.offsets.to_mut()[1] = 3, "cell 0 (tetrahedron)"),
        (|mesh| mesh.offsets.to_mut()[2] = u64::MAX, "connectivity"),
        (|mesh| mesh.offsets.to_mut().truncate(2), "offsets"),
        (|mesh| mesh.types.to_mut().push(10), "offsets"),
        (|mesh| mesh.arrays[1].components = 2, "\"id\""),
        (|mesh| mesh.types.to_mut()[1] = 42, "faces of cell 1 (polyhedron)"),
    ];
    for (damage, expected) in cases {
        let mut mesh = mesh();
        damage(&mut mesh);
        let error = mesh.into_dataset().unwrap_err().to_string();
        assert!(error.contains(expected), "{expected}: {error}");
    }
    assert!(matches!(UnstructuredMesh::empty().into_dataset(), Err(Error::NoCells { .. })));
}
