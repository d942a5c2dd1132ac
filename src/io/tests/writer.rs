use super::samples::mesh;
use super::*;

#[test]
fn what_is_written_reads_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mesh.vtu");
    let mut large = UnstructuredMesh::empty();
    // More than two blocks of each array, and not a whole number of them.
    large.points = Points::F64((0..70_001).map(|i| [f64::from(i), 0.5, -1e300]).collect());
    large.types = vec![10; 70_000].into();
    large.offsets = (0..=70_000).map(|cell| cell * 4).collect();
    large.connectivity = (0..280_000).map(|i| i % 70_001).collect();
    for mesh in [mesh(), large, UnstructuredMesh::empty()] {
        for compression in [Compression::None, Compression::Zlib] {
            write_vtu(&path, &mesh, compression).unwrap();
            let found = unstructured(open_mesh(&path).unwrap());
            assert_same(&found, &mesh, "round trip");
            for (a, b) in found.arrays.iter().zip(&mesh.arrays) {
                assert_eq!(a.values.type_name(), b.values.type_name());
            }
            let first = std::fs::read(&path).unwrap();
            write_vtu(&path, &mesh, compression).unwrap();
            assert_eq!(std::fs::read(&path).unwrap(), first, "the same bytes every time");
        }
    }
}

#[test]
fn tetrahedra_of_split_cells_repeat_their_cells_values() {
    let tets = mesh().into_tets().unwrap();
    let mesh = UnstructuredMesh::from_tets(&tets);
    assert_eq!(values(&mesh.array("id", Association::Cell).unwrap().values), [-3.0, 300.0, 300.0]);
    assert_eq!(mesh.clone().into_tets().unwrap().tets, tets.tets);
}
