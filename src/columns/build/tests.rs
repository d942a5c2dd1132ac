use super::*;

fn mesh(points: Vec<[f64; 3]>, tets: Vec<[u32; 4]>) -> TetMesh {
    let file_from_tet = (0..tets.len() as u32).collect();
    let counts = CellCounts { in_file: tets.len() as u64, ..CellCounts::default() };
    TetMesh { points: Points::F64(points), tets: tets.into(), file_from_tet, arrays: Vec::new(), counts }
}

fn corner() -> Vec<[f64; 3]> {
    vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
}

#[test]
fn inverted_cells_are_turned_and_counted() {
    let data = Dataset::from_tets(mesh(corner(), vec![[0, 1, 2, 3], [0, 2, 1, 3]])).unwrap();
    assert_eq!(data.counts.inverted, 1);
    assert_eq!(data.tets.get(0), data.tets.get(1));
    assert_eq!(data.positive.get(0), data.positive.get(1));
}

#[test]
fn orientation_bit_agrees_with_the_triple_product() {
    let data = Dataset::from_tets(mesh(corner(), vec![[3, 1, 0, 2]])).unwrap();
    let [a, b, c, d] = data.tets.get(0).map(|v| Vec3::from_array(data.positions[v as usize]));
    assert_eq!(data.positive.get(0), (b - a).cross(c - a).dot(d - a) > 0.0);
}

#[test]
fn flat_cells_are_dropped_and_counted() {
    let mut points = corner();
    points.push([0.5, 0.5, 0.0]);
    let data = Dataset::from_tets(mesh(points, vec![[0, 1, 2, 4], [0, 1, 2, 3]])).unwrap();
    assert_eq!((data.counts.degenerate, data.tets.len()), (1, 1));
    assert_eq!(data.cell_tuple(0), 1);
    assert_eq!(data.positions.len(), 4, "a vertex of no cell is left out");
}

#[test]
fn only_flat_cells_is_an_error_that_says_so() {
    let mut points = corner();
    points[3] = [0.5, 0.5, 0.0];
    let error = Dataset::from_tets(mesh(points, vec![[0, 1, 2, 3]])).unwrap_err();
    assert!(error.to_string().contains("1 cells flat"), "{error}");
}

#[test]
fn an_offset_of_a_million_keeps_the_shape() {
    let far = corner().iter().map(|p| p.map(|x| x * 1e-3 + 1e6)).collect();
    let data = Dataset::from_tets(mesh(far, vec![[0, 1, 2, 3]])).unwrap();
    assert!((data.diagonal_world() - 1e-3 * 3.0_f64.sqrt()).abs() < 1e-9);
}

#[test]
fn bad_indices_and_positions_are_named() {
    let error = Dataset::from_tets(mesh(corner(), vec![[0, 1, 2, 9]])).unwrap_err();
    assert!(matches!(error, Error::IndexOutOfRange { cell: 0, index: 9, len: 4, .. }));
    let mut points = corner();
    points[2][1] = f64::NAN;
    let error = Dataset::from_tets(mesh(points, vec![[0, 1, 2, 3]])).unwrap_err();
    assert!(matches!(error, Error::NonFinitePosition { point: 2, .. }));
}

#[test]
fn index_maps_lead_back_to_the_file() {
    let mut points = Vec::new();
    let mut tets = Vec::new();
    for i in 0..200_u32 {
        let x = f64::from(i * 37 % 200);
        points.extend(corner().iter().map(|p| [p[0] + x, p[1], p[2]]));
        tets.push([4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3]);
    }
    let input = mesh(points.clone(), tets.clone());
    let data = Dataset::from_tets(input).unwrap();
    for (cell, tet) in data.tets.iter().enumerate() {
        let mut of_file: Vec<u32> = tet.iter().map(|&v| data.point_tuple(v as usize) as u32).collect();
        of_file.sort_unstable();
        assert_eq!(of_file, tets[data.cell_tuple(cell)]);
        for v in tet {
            let world = data.origin + Vec3::from_array(data.positions[v as usize]).as_dvec3();
            let file = DVec3::from_array(points[data.point_tuple(v as usize)]);
            assert!((world - file).length() < 1e-4);
        }
    }
    assert!(data.positions.windows(2).filter(|p| (p[0][0] - p[1][0]).abs() > 2.0).count() < 20, "spatial order");
}
