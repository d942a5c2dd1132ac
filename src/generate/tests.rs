use super::{Kind, Scheme, Settings, generate};
use crate::columns::{Association, Dataset, Points};
use crate::error::Error;

#[test]
fn every_kind_is_a_valid_dataset_of_positive_cells_with_both_arrays() {
    for kind in Kind::ALL {
        for scheme in [Scheme::Five, Scheme::Six] {
            let mesh = generate(kind, &Settings { cells: 3000, scheme, ..Settings::default() }).unwrap();
            let cells = mesh.tets.len() as u64;
            assert!((2900..6000).contains(&cells), "{kind}: {cells}");
            let described: Vec<_> = mesh.arrays.iter().map(|a| (a.name.as_str(), a.association, a.tuples())).collect();
            assert_eq!(
                described,
                [("value", Association::Point, mesh.points.len()), ("cell_value", Association::Cell, mesh.tets.len())]
            );
            for array in &mesh.arrays {
                let values = (0..array.values.len()).map(|i| array.values.get(i));
                let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
                assert!(0.0 <= low && low < high && high < 1.5, "{kind} {}: {low} {high}", array.name);
            }
            let data = Dataset::from_tets(mesh).unwrap();
            assert_eq!((data.counts.in_file, data.counts.inverted, data.counts.degenerate), (cells, 0, 0), "{kind}");
            assert_eq!((data.bounds.min.to_array(), data.bounds.max.to_array()), ([0.0; 3], [1.0; 3]), "{kind}");
        }
    }
}

/// FNV-1a over the bits of everything in a mesh.
fn fingerprint(kind: Kind, settings: &Settings) -> u64 {
    let mesh = generate(kind, settings).unwrap();
    let Points::F32(points) = &mesh.points else { panic!("generated points are f32") };
    let positions = points.iter().flatten().map(|x| x.to_bits());
    let values = mesh.arrays.iter().flat_map(|a| (0..a.values.len()).map(|i| (a.values.get(i) as f32).to_bits()));
    let words = positions.chain(mesh.tets.iter().flatten().copied()).chain(values);
    words.fold(0xcbf2_9ce4_8422_2325, |hash, word| (hash ^ u64::from(word)).wrapping_mul(0x0100_0000_01b3))
}

#[test]
fn same_seed_same_bytes_for_any_number_of_threads() {
    for kind in Kind::ALL {
        let settings = Settings { cells: 2000, seed: 5, ..Settings::default() };
        let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let one = pool(1).install(|| fingerprint(kind, &settings));
        assert_eq!(one, pool(7).install(|| fingerprint(kind, &settings)), "{kind}");
        assert_ne!(one, fingerprint(kind, &Settings { seed: 6, ..settings }), "{kind}");
    }
}

#[test]
fn kinds_are_read_by_name() {
    for kind in Kind::ALL {
        assert_eq!(kind.to_string().parse::<Kind>().unwrap(), kind);
        assert!(!kind.description().is_empty());
    }
    let error = "cube".parse::<Kind>().unwrap_err();
    assert!(matches!(error, Error::Option { option: "KIND", .. }));
    assert!(error.to_string().contains("tets, buckyball, orbital, delaunay"));
}
