//! Containers of regular grids: lattice and octrees.

use glam::{DMat3, DVec3};

use super::*;
use crate::columns::{Lattice, Volume};
use crate::hierarchy::{Hierarchy, Level};
use crate::io::container::octree::LatticeEntry;
use crate::io::{Scratch, WholeCells};

/// A sheared grid with bytes, doubles that vary little around a large value and have holes, values of cells, and vectors.
fn volume() -> Volume {
    let dims = [13, 9, 6];
    let (points, cells) = (13 * 9 * 6, 12 * 8 * 5);
    let array = |name: &str, association, components, values: NumericColumn| Array {
        name: name.to_owned(),
        association,
        components,
        values,
    };
    let doubles = (0..points).map(|i| if i % 97 == 5 { f64::NAN } else { 1e9 + (i as f64 * 0.3).sin() });
    let arrays = vec![
        array("bytes", Association::Point, 1, (0..points).map(|i| (i * i % 251) as u8).collect::<Vec<_>>().into()),
        array("far", Association::Point, 1, doubles.collect::<Vec<_>>().into()),
        array("flow", Association::Point, 3, vec![0.5_f32; 3 * points].into()),
        array("cells", Association::Cell, 1, (0..cells).map(|i| i as i16 - 200).collect::<Vec<_>>().into()),
        array("none", Association::Cell, 1, vec![f32::NAN; cells].into()),
    ];
    let steps = DMat3::from_cols(DVec3::X, DVec3::new(0.2, 0.7, 0.0), DVec3::new(0.1, -0.3, 1.5));
    Volume::new(dims, Lattice::sheared(DVec3::new(1e4, -3.0, 0.1), steps), arrays).unwrap()
}

fn container(folder: &Folder) -> PathBuf {
    let path = folder.path("volume.cells");
    write_volume(volume(), &path, &|_, _, _| {}).unwrap();
    path
}

fn bits(level: &Level) -> Vec<u32> {
    level.columns().iter().flat_map(|column| column.iter().map(|x| x.to_bits())).collect()
}

#[test]
fn a_regular_grid_comes_back_with_its_octrees_in_place() {
    let folder = Folder::new();
    let path = container(&folder);
    let expected = volume();
    for use_map in [true, false] {
        let stored = open_volume(&path, use_map).unwrap().unwrap();
        assert_eq!((stored.volume.dims, stored.volume.lattice), (expected.dims, expected.lattice));
        assert_eq!(stored.volume.backing.is_some(), use_map);
        for name in ["bytes", "far", "flow", "cells"] {
            let selection = FieldSelection::parse(name, &expected.arrays);
            let [of_file, of_memory] = [&stored.volume, &expected].map(|volume| volume.field(&selection).unwrap());
            assert_eq!(
                (of_file.dims, of_file.range, of_file.invalid),
                (of_memory.dims, of_memory.range, of_memory.invalid)
            );
            let same = (0..of_memory.len() * of_memory.components)
                .all(|i| of_file.values.get(i).to_bits() == of_memory.values.get(i).to_bits());
            assert!(same, "{name}");
            let found = stored.hierarchy(&of_file).unwrap();
            if name == "flow" {
                assert!(found.is_none());
                continue;
            }
            let (found, built) = (found.unwrap(), Hierarchy::new(&of_memory).unwrap());
            assert_eq!((found.dims(), found.owned_bytes()), (built.dims(), 0));
            assert_eq!(found.offset().to_bits(), built.offset().to_bits());
            assert!(found.levels().iter().map(bits).eq(built.levels().iter().map(bits)), "{name}");
        }
    }
    check(&path, true).unwrap();
    // As cells it is the structured block that it was before.
    let mesh = crate::io::StructuredMesh::from_volume(expected).unwrap();
    let WholeCells::Structured(cells) = mesh.into_whole_in(&Scratch::memory()).unwrap() else {
        panic!("all are whole")
    };
    let cells = folder.structured(cells);
    assert_same(&open(&path, true).unwrap(), &cells);
    // Which has no lattice.
    assert!(open_volume(&folder.path("mesh.cells"), true).unwrap().is_none());
}

#[test]
fn lattices_and_octrees_that_lie_are_refused() {
    let folder = Folder::new();
    let path = container(&folder);
    let (bytes, directory) = bytes_and_directory(&path);
    let text = serde_json::to_value(&directory).unwrap();
    let refused = |change: &dyn Fn(&mut serde_json::Value), part: &str| {
        let mut changed = text.clone();
        change(&mut changed["lattice"]);
        with_directory(&path, &bytes, &serde_json::to_vec(&changed).unwrap());
        let error = open_volume(&path, true).unwrap_err();
        assert!(matches!(error, Error::Malformed { .. }), "{error:?}");
        assert!(error.to_string().contains(part), "{error} says nothing of {part:?}");
        assert!(open(&path, true).is_err());
    };
    refused(&|lattice| lattice["dims"][0] = 12.into(), "as many points");
    refused(&|lattice| lattice["dims"] = serde_json::json!([u64::MAX, 2, 2]), "as many points");
    refused(&|lattice| lattice["dims"] = serde_json::json!([26, 27, 1]), "levels are missing");
    refused(&|lattice| lattice["octrees"][0]["array"] = 99.into(), "no such array");
    refused(&|lattice| lattice["octrees"][0]["array"] = 2.into(), "several components");
    refused(&|lattice| lattice["octrees"][0]["array"] = 3.into(), "bytes where");
    refused(&|lattice| drop(lattice["octrees"][0]["levels"].as_array_mut().unwrap().pop()), "levels are missing");
    refused(
        &|lattice| {
            let levels = lattice["octrees"][0]["levels"].as_array_mut().unwrap();
            levels.push(levels[0].clone());
        },
        "above its root",
    );
    refused(&|lattice| lattice["octrees"][1]["levels"][0][2]["offset"] = (1_u64 << 60).into(), "outside the file");
    refused(&|lattice| lattice["octrees"][0]["levels"][1] = lattice["octrees"][0]["levels"][0].clone(), "bytes where");
    refused(&|lattice| lattice["steps"] = serde_json::json!([[1e308, 0, 0], [0, 1, 0], [0, 0]]), "directory");
}

#[test]
fn check_finds_octrees_and_lattices_that_are_wrong() {
    let folder = Folder::new();
    let path = container(&folder);
    let (bytes, directory) = bytes_and_directory(&path);
    let mut text = serde_json::to_value(&directory).unwrap();
    let span = |value: &serde_json::Value| {
        (value["offset"].as_u64().unwrap() as usize, value["bytes"].as_u64().unwrap() as usize)
    };
    for (octree, level, column) in [(0, 0, 0), (0, 2, 1), (1, 0, 2), (2, 1, 0)] {
        let entry = &text["lattice"]["octrees"][octree]["levels"][level][column];
        let (offset, len) = span(entry);
        let mut changed = bytes.clone();
        changed[offset + 1] ^= 4;
        fs::write(&path, &changed).unwrap();
        let error = check(&path, true).unwrap_err().to_string();
        assert!(error.contains(&format!("of level {} of octree {octree}: its checksum", level + 1)), "{error}");
        // What a bad writer would do.
        let mut vouched = text.clone();
        let sum = twox_hash::XxHash3_64::oneshot(&changed[offset..][..len]);
        vouched["lattice"]["octrees"][octree]["levels"][level][column]["xxh3"] = format!("{sum:016x}").into();
        with_directory(&path, &changed, &serde_json::to_vec(&vouched).unwrap());
        let error = check(&path, true).unwrap_err().to_string();
        assert!(error.contains(&format!("octree {octree}: node 0 of level {}", level + 1)), "{error}");
    }
    text["lattice"]["origin"][1] = (-3.5).into();
    with_directory(&path, &bytes, &serde_json::to_vec(&text).unwrap());
    let error = check(&path, true).unwrap_err().to_string();
    assert!(error.contains("lattice: vertex 0 is not where it says"), "{error}");
}

#[test]
fn damaged_octrees_are_drawn_wrong_or_refused_but_never_a_panic() {
    use crate::render::{CubeScene, Detail};
    use crate::{Camera, RenderOptions, Renderer};
    let folder = Folder::new();
    let path = container(&folder);
    let bytes = fs::read(&path).unwrap();
    let lattice: LatticeEntry = bytes_and_directory(&path).1.lattice.unwrap();
    let text = serde_json::to_value(&lattice).unwrap();
    let first = text["octrees"][0]["levels"][0][0]["offset"].as_u64().unwrap() as usize;
    let point = |value, extinction| crate::ControlPoint { value, color: [1.0; 3], extinction };
    let transfer = crate::TransferFunction::new(vec![point(0.0, 0.0), point(250.0, 1.0)]).unwrap();
    let mut drawn = 0;
    for i in 0..120 {
        let mut damaged = bytes.clone();
        let at = first + i * 977 % (bytes.len() - first);
        damaged[at..(at + 4).min(bytes.len())].fill([0xff, 0x7f, 0x80][i % 3]);
        fs::write(&path, &damaged).unwrap();
        let Ok(Some(stored)) = open_volume(&path, i % 2 == 0) else { continue };
        for name in ["bytes", "far", "cells"] {
            let field = stored.volume.field(&FieldSelection::parse(name, &[])).unwrap();
            let Some(octree) = stored.hierarchy(&field).unwrap() else { continue };
            let scene = CubeScene::with_hierarchy(&stored.volume, field, octree, &transfer).unwrap();
            let camera = Camera::framing(&stored.volume.corners_world(), 30.0, 20.0, 16, 12);
            for detail in [Detail::Error(0.2), Detail::PictureError(0.1), Detail::Cubes(20)] {
                Renderer::new(RenderOptions::default()).render_cubes(&scene, detail, &camera).unwrap();
                drawn += 1;
            }
        }
    }
    assert!(drawn > 300, "{drawn}");
}
