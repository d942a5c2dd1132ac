//! Blocks against the obvious twin: the same cells with their corners written out.

use super::*;
use crate::cells::HEXAHEDRON;

/// Points of a bent grid of `dims` points, its first corner at `x`.
fn bent([ni, nj, nk]: [usize; 3], x: f32) -> Vec<[f32; 3]> {
    let point = |i: usize, j: usize, k: usize| {
        let (i, j, k) = (i as f32, j as f32, k as f32);
        [x + i + 0.2 * (j * k).sin(), j + 0.1 * (i + 3.0 * k).cos(), k + 0.15 * (i * j).sin()]
    };
    let row = move |(j, k)| (0..ni).map(move |i| point(i, j, k));
    (0..nk).flat_map(|k| (0..nj).map(move |j| (j, k))).flat_map(row).collect()
}

fn array(name: &str, association: Association, values: Vec<u8>) -> Array {
    Array { name: name.to_owned(), association, components: 1, values: values.into() }
}

/// The mesh with its cells' corners written out from i, j, k.
fn twin(dims: &[[usize; 3]], points: Vec<[f32; 3]>, arrays: Vec<Array>) -> UnstructuredMesh {
    let mut mesh = UnstructuredMesh::empty();
    let (mut types, mut offsets, mut connectivity) = (vec![], vec![0], vec![]);
    let mut first = 0;
    for &[ni, nj, nk] in dims {
        for (k, j, i) in (1..nk).flat_map(|k| (1..nj).flat_map(move |j| (1..ni).map(move |i| (k, j, i)))) {
            let at = |i: usize, j: usize, k: usize| (first + i + ni * j + ni * nj * k) as u32;
            connectivity.extend([at(i - 1, j - 1, k - 1), at(i, j - 1, k - 1), at(i, j, k - 1), at(i - 1, j, k - 1)]);
            connectivity.extend([at(i - 1, j - 1, k), at(i, j - 1, k), at(i, j, k), at(i - 1, j, k)]);
            types.push(HEXAHEDRON.code);
            offsets.push(connectivity.len() as u64);
        }
        first += ni * nj * nk;
    }
    (mesh.types, mesh.offsets, mesh.connectivity) = (types.into(), offsets.into(), connectivity.into());
    UnstructuredMesh { points: Points::F32(points), arrays, ..mesh }
}

#[test]
fn tetrahedra_are_those_of_cells_written_out() {
    for dims in [vec![[2, 2, 2]], vec![[3, 4, 5]], vec![[5, 2, 3], [2, 6, 2], [3, 3, 3]]] {
        let points: Vec<[f32; 3]> =
            dims.iter().zip(0_u8..).flat_map(|(&dims, i)| bent(dims, 10.0 * f32::from(i))).collect();
        let cells: usize = dims.iter().map(|dims| dims.map(|n| n - 1).iter().product::<usize>()).sum();
        let ghosts = (0..cells).map(|cell| [0, 0, 32, 1, 4][cell % 5]).collect();
        let hidden = (0..points.len()).map(|point| if point % 17 == 9 { 2 } else { 1 }).collect();
        for arrays in [
            vec![],
            vec![array("vtkGhostType", Association::Cell, ghosts)],
            vec![array("vtkGhostType", Association::Point, hidden)],
        ] {
            let mesh = StructuredMesh::new(&dims, Points::F32(points.clone()), arrays.clone()).unwrap();
            assert_eq!(mesh.cells(), cells);
            let expected = twin(&dims, points.clone(), arrays).into_tets().unwrap();
            let found = mesh.into_tets().unwrap();
            assert_eq!((&found.tets, &found.file_from_tet), (&expected.tets, &expected.file_from_tet), "{dims:?}");
            assert_eq!(found.counts, expected.counts, "{dims:?}");
        }
    }
}

/// The volume of all cells as they are drawn.
fn volume(data: &Dataset) -> f64 {
    let position = |v: u32| glam::Vec3::from_array(data.positions[v as usize]).as_dvec3();
    let tet = |tet: [u32; 4]| {
        let [a, b, c, d] = tet.map(position);
        (b - a).cross(c - a).dot(d - a).abs() / 6.0
    };
    data.tets.iter().map(tet).sum()
}

#[test]
fn blocks_share_their_coincident_points() {
    // One block, and the same grid cut in two at i = 2.
    let dims = [5, 4, 3];
    let whole = bent(dims, 0.0);
    let part = |columns: std::ops::Range<usize>| {
        let is_in = move |&(at, _): &(usize, &[f32; 3])| columns.contains(&(at % dims[0]));
        whole.iter().enumerate().filter(is_in).map(|(_, &point)| point).collect::<Vec<_>>()
    };
    let parts = [part(0..3), part(2..5)].concat();
    let two = StructuredMesh::new(&[[3, 4, 3], [3, 4, 3]], Points::F32(parts), Vec::new()).unwrap();
    let (one, two) = (twin(&[dims], whole.clone(), Vec::new()).into_dataset().unwrap(), two.into_dataset().unwrap());
    assert_eq!((one.tets.len(), two.tets.len()), (4 * 3 * 2 * 6, 4 * 3 * 2 * 6));
    assert!((volume(&one) - volume(&two)).abs() < 0.05, "faces are cut by other numbers, which moves little volume");
    // Every triangle at the seam is there from both sides.
    let mut at_seam: Vec<Vec<[u32; 3]>> = Vec::new();
    let seam: Vec<[u32; 3]> = part(2..3).iter().map(|point| point.map(f32::to_bits)).collect();
    for tet in two.tets.iter() {
        let corners = tet.map(|v| two.positions[v as usize].map(f32::to_bits));
        let mut triangle: Vec<[u32; 3]> = corners.into_iter().filter(|corner| seam.contains(corner)).collect();
        if triangle.len() == 3 {
            triangle.sort_unstable();
            at_seam.push(triangle);
        }
    }
    at_seam.sort_unstable();
    assert_eq!(at_seam.len(), 2 * 2 * 3 * 2);
    assert!(at_seam.chunks(2).all(|pair| pair[0] == pair[1]));
}

#[test]
fn blocks_without_volume_are_counted_and_empty_ones_are_nothing() {
    for (dims, code, cells) in [
        ([3, 4, 1], 9, 6),
        ([1, 4, 5], 9, 12),
        ([3, 1, 1], 3, 2),
        ([1, 1, 1], 1, 1),
        ([0, 5, 2], 9, 0),
        ([0, 0, 0], 1, 0),
    ] {
        let points = vec![[0.0; 3]; dims.iter().product()];
        let mesh =
            StructuredMesh::new(&[dims, [2, 2, 2]], Points::F32([points, bent([2, 2, 2], 0.0)].concat()), vec![])
                .unwrap();
        let block = mesh.blocks()[0];
        assert_eq!((block.cells(), mesh.cells()), (cells, cells + 1), "{dims:?}");
        assert!(!block.has_volume(), "{dims:?}");
        if cells > 0 {
            assert_eq!(block.code(), code, "{dims:?}");
        }
        let mesh = Mesh::from(mesh);
        let by_code = mesh.cells_by_code();
        assert_eq!((by_code[12], by_code.iter().sum::<u64>()), (1, cells as u64 + 1), "{dims:?}");
        let counts = mesh.into_dataset().unwrap().counts;
        assert_eq!((counts.lower_dimensional, counts.split), (cells as u64, 1), "{dims:?}");
    }
}

#[test]
fn a_block_that_is_collapsed_has_fewer_tetrahedra() {
    // The layer i = 0 becomes a line: hexahedra become wedges.
    let dims = [2, 2, 3];
    let mut points = bent(dims, 0.0);
    for k in 0..3 {
        points[4 * k + 2] = points[4 * k];
    }
    let mesh = StructuredMesh::new(&[dims], Points::F32(points), vec![]).unwrap();
    let data = mesh.into_dataset().unwrap();
    assert_eq!((data.tets.len(), data.counts.split, data.counts.degenerate), (6, 2, 0));
}

#[test]
fn what_does_not_fit_the_blocks_is_an_error() {
    let new = |dims: &[[usize; 3]], points: usize, arrays: Vec<Array>| {
        StructuredMesh::new(dims, Points::F32(vec![[0.0; 3]; points]), arrays).unwrap_err().to_string()
    };
    assert!(new(&[[2, 2, 2]], 7, vec![]).contains("points: has 7 entries where 8"));
    assert!(new(&[[2, 2, 2], [2, 1, 1]], 8, vec![]).contains("where 10"));
    for dims in [[usize::MAX, 2, 2], [1 << 32, 1, 1], [1 << 22, 1 << 22, 1 << 22]] {
        assert!(new(&[dims], 0, vec![]).contains("are more than"), "{dims:?}");
    }
    let half = [1 << 31, 1, 1];
    assert!(new(&[half, half], 0, vec![]).contains("are more than"));
    assert!(new(&[[2, 2, 2]], 8, vec![array("a", Association::Cell, vec![1, 2])]).contains("\"a\""));
    assert!(new(&[[2, 2, 2]], 8, vec![array("b", Association::Point, vec![1])]).contains("\"b\""));
    let none = StructuredMesh::new(&[], Points::F32(vec![]), vec![]).unwrap();
    assert!(matches!(none.into_dataset(), Err(Error::NoCells { .. })));
}
