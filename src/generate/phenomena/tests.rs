use super::*;
use crate::columns::{Association, Dataset, FieldSelection};

fn settings(shape: CellShape) -> PhenomenonSettings {
    PhenomenonSettings { cells: 6_000, shape, ..PhenomenonSettings::default() }
}

fn values(mesh: &CellMesh, association: Association) -> Vec<f64> {
    let array = mesh.arrays.iter().find(|array| array.association == association).unwrap();
    (0..array.values.len()).map(|i| array.values.get(i)).collect()
}

#[test]
fn every_phenomenon_is_a_sound_mesh_in_every_shape() {
    for kind in Phenomenon::ALL {
        let mut volumes = Vec::new();
        for shape in [CellShape::Tetrahedra, CellShape::Prisms, CellShape::Hexahedra] {
            let mesh = phenomenon(kind, &settings(shape)).unwrap();
            let cells = mesh.tets.len() + mesh.hexahedra.len();
            assert!(cells > 300 && mesh.tets.is_empty() == (shape != CellShape::Tetrahedra), "{kind} {cells}");
            for association in [Association::Point, Association::Cell] {
                let values = values(&mesh, association);
                let most = values.iter().fold(0.0_f64, |most, &v| most.max(v));
                assert!(values.iter().all(|v| (0.0..=1.0).contains(v)) && most > 0.3, "{kind} {most}");
            }
            assert!(values(&mesh, Association::Cell).iter().all(|&v| v > 0.0), "{kind}: a cell emits nothing");
            let dataset = Dataset::from_cells(mesh).unwrap();
            assert_eq!((dataset.counts.degenerate, dataset.counts.inverted), (0, 0), "{kind} {shape:?}");
            volumes.push((0..dataset.cells()).map(|cell| dataset.volume_world(cell)).sum::<f64>());
            assert!(dataset.field(&FieldSelection::parse("value", &dataset.arrays)).is_ok());
        }
        let [tets, prisms, hexahedra] = volumes[..] else { unreachable!() };
        // Grids of other sizes, cells without light left out: about the same form.
        assert!((tets / hexahedra - 1.0).abs() < 0.35 && (prisms / hexahedra - 1.0).abs() < 0.35, "{kind} {volumes:?}");
    }
}

#[test]
fn time_moves_each_phenomenon_and_nothing_else_does() {
    for kind in Phenomenon::ALL {
        let at = |time_s| phenomenon(kind, &PhenomenonSettings { time_s, ..settings(CellShape::Prisms) }).unwrap();
        let (first, again, later) = (at(0.0), at(0.0), at(1.5));
        assert_eq!(values(&first, Association::Point), values(&again, Association::Point), "{kind}");
        let points = |mesh: &CellMesh| (0..mesh.points.len()).map(|i| mesh.points.get(i)).collect::<Vec<_>>();
        let has_moved = points(&first) != points(&later)
            || values(&first, Association::Point) != values(&later, Association::Point);
        assert!(has_moved, "{kind}");
    }
}

#[test]
fn settings_out_of_range_are_refused() {
    let refused = |settings: PhenomenonSettings| phenomenon(Phenomenon::Aurora, &settings).unwrap_err().to_string();
    let default = PhenomenonSettings::default();
    assert!(refused(PhenomenonSettings { cells: 0, ..default }).contains("--cells"));
    assert!(refused(PhenomenonSettings { time_s: f64::NAN, ..default }).contains("--time"));
    assert!(refused(PhenomenonSettings { cells: u64::MAX, ..default }).contains("cells"));
}
