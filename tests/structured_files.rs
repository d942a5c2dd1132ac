//! Real structured grids: counts and values as VTK 9.7 gives them.

mod common;

use cellfan::columns::{Array, Association, Lattice, NumericColumn, Points};
use cellfan::io::{self, Mesh, StructuredBlock, StructuredMesh};
use cellfan::optics::presets::{self, OpacityProfile};
use cellfan::{Camera, FieldSelection, RenderOptions, Renderer, Scene};
use common::data_folder;

/// A weighted sum that any changed, missing or exchanged value changes.
fn sum(values: impl Iterator<Item = f64>) -> f64 {
    values.enumerate().map(|(i, value)| value * (i % 97 + 1) as f64).sum()
}

fn coordinates(points: &Points) -> impl Iterator<Item = f64> {
    (0..points.len()).flat_map(|i| points.get(i).to_array())
}

fn values(array: &Array) -> impl Iterator<Item = f64> {
    (0..array.values.len()).map(|i| array.values.get(i))
}

fn close(found: f64, expected: f64) -> bool {
    (found - expected).abs() <= 1e-9 * expected.abs().max(1.0)
}

fn open(file: &str, scratch: &io::Scratch) -> Option<StructuredMesh> {
    let path = data_folder("tests of structured grids")?.join(file);
    match io::open_mesh_in(&path, scratch).unwrap_or_else(|error| panic!("{error}")) {
        Mesh::Structured(mesh) => Some(mesh),
        Mesh::Unstructured(_) | Mesh::Volume(_) => panic!("{file}: no blocks"),
    }
}

fn in_memory(file: &str) -> Option<StructuredMesh> {
    open(file, &io::Scratch::memory())
}

/// File, blocks, cells, then sums of coordinates and the arrays (of cells before those of points).
struct Expected {
    file: &'static str,
    dims: &'static [[usize; 3]],
    cells: usize,
    coordinates: f64,
    arrays: &'static [(&'static str, usize, &'static str, f64)],
}

const EXPECTED: &[Expected] = &[
    Expected {
        file: "classic/bluntfin.vts",
        dims: &[[40, 32, 32]],
        cells: 37_479,
        coordinates: 7_230_778.121_331_513,
        arrays: &[
            ("Density", 1, "f32", 2_323_526.019_211_545_6),
            ("Momentum", 3, "f32", 3_387_663.180_371_019),
            ("StagnationEnergy", 1, "f32", 12_485_879.174_754_977),
        ],
    },
    Expected {
        file: "curvilinear/StructuredGrid.vts",
        dims: &[[6, 12, 9]],
        cells: 440,
        coordinates: 990_864.806_678_772,
        arrays: &[
            ("Density", 1, "f32", 11_098.024_583_801_627),
            ("Momentum", 3, "f32", 2_612_905.667_755_946_5),
            ("StagnationEnergy", 1, "f32", 0.0),
        ],
    },
    Expected {
        file: "regular/cth.vtr",
        dims: &[[129, 65, 65]],
        cells: 524_288,
        coordinates: -46_748_817.042_945_86,
        arrays: &[
            ("Pressure", 1, "f32", 278_897_992_022_516.8),
            ("Void Volume Fraction", 1, "f32", 24_525_684.911_451_78),
            ("X Velocity", 1, "f32", 75_596_015_610.958_2),
            ("Y Velocity", 1, "f32", 26_905_133.399_242_41),
            ("Z Velocity", 1, "f32", 110_992_739_352.895_2),
            ("Volume Fraction for Armor Plate", 1, "f32", 1_019_833.523_370_913_5),
            ("Mass for Armor Plate", 1, "f32", 6_810.762_269_946_029),
            ("Volume Fraction for Body, Nose", 1, "f32", 144_058.256_155_140_7),
            ("Mass for Body, Nose", 1, "f32", 6_810.762_269_946_029),
        ],
    },
    Expected {
        file: "formats/RectilinearGridAppendedBase64.vtr",
        dims: &[[4, 2, 2]],
        cells: 3,
        coordinates: 556.0,
        arrays: &[
            ("Pressure", 1, "f32", 0.0),
            ("Void Volume Fraction", 1, "f32", 5.0),
            ("X Velocity", 1, "f32", 4.199_999_928_474_426),
            ("Y Velocity", 1, "f32", 3.0),
            ("Z Velocity", 1, "f32", 1.0),
        ],
    },
    Expected {
        file: "formats/RectilinearGridCompressed.vtr",
        dims: &[[4, 2, 2]],
        cells: 3,
        coordinates: 556.0,
        arrays: &[
            ("Pressure", 1, "f32", 0.0),
            ("Void Volume Fraction", 1, "f32", 5.0),
            ("X Velocity", 1, "f32", 4.199_999_928_474_426),
            ("Y Velocity", 1, "f32", 3.0),
            ("Z Velocity", 1, "f32", 1.0),
        ],
    },
    Expected {
        file: "formats/RectilinearGridInlineBinary.vtr",
        dims: &[[4, 2, 2]],
        cells: 3,
        coordinates: 556.0,
        arrays: &[
            ("Pressure", 1, "f32", 0.0),
            ("Void Volume Fraction", 1, "f32", 5.0),
            ("X Velocity", 1, "f32", 4.199_999_928_474_426),
            ("Y Velocity", 1, "f32", 3.0),
            ("Z Velocity", 1, "f32", 1.0),
        ],
    },
    Expected {
        file: "formats/RectilinearGridRawBinary.vtr",
        dims: &[[4, 2, 2]],
        cells: 3,
        coordinates: 556.0,
        arrays: &[
            ("Pressure", 1, "f32", 0.0),
            ("Void Volume Fraction", 1, "f32", 5.0),
            ("X Velocity", 1, "f32", 4.199_999_928_474_426),
            ("Y Velocity", 1, "f32", 3.0),
            ("Z Velocity", 1, "f32", 1.0),
        ],
    },
    Expected {
        file: "formats/RectilinearGrid_ascii.vtr",
        dims: &[[4, 2, 2]],
        cells: 3,
        coordinates: 556.0,
        arrays: &[
            ("Pressure", 1, "f32", 0.0),
            ("Void Volume Fraction", 1, "f32", 5.0),
            ("X Velocity", 1, "f32", 4.199_999_928_474_426),
            ("Y Velocity", 1, "f32", 3.0),
            ("Z Velocity", 1, "f32", 1.0),
        ],
    },
    Expected {
        file: "curvilinear/SampleStructGrid.vtk",
        dims: &[[20, 30, 40]],
        cells: 21_489,
        coordinates: 1_296_297.127_879_789,
        arrays: &[("scalars", 1, "f64", 318_382.896_033_310_9), ("scalars", 1, "f64", 846_685.304_813_499_8)],
    },
    Expected {
        file: "curvilinear/office.binary.vtk",
        dims: &[[21, 20, 20]],
        cells: 7220,
        coordinates: 2_474_717.219_885_068,
        arrays: &[("scalars", 1, "f32", -561_369.082_162_284), ("vectors", 3, "f32", -553.007_307_016_290_7)],
    },
    Expected {
        file: "formats/structured_grid.vtk",
        dims: &[[2, 2, 2]],
        cells: 1,
        coordinates: 53.451_181_113_719_94,
        arrays: &[
            ("cellval", 1, "f32", 1_489.0),
            ("cellvec", 3, "f32", 3.5),
            ("ptval", 1, "f32", 168.0),
            ("ptvec", 3, "f32", 2.713_934_831_321_239_5),
        ],
    },
    Expected {
        file: "regular/RectGrid2.vtk",
        dims: &[[47, 33, 11]],
        cells: 14_720,
        coordinates: 378_866.949_658_259_75,
        arrays: &[("scalars", 1, "f32", 530_651.026_439_859_1), ("vectors", 3, "f32", 440_130.059_789_783_6)],
    },
    Expected {
        file: "formats/rectilinear_grid.vtk",
        dims: &[[3, 4, 1]],
        cells: 6,
        coordinates: 1_158.0,
        arrays: &[("cellscalar", 1, "f32", 87.300_001_978_874_2)],
    },
    Expected {
        file: "formats/rectilinear_grid_binary.vtk",
        dims: &[[3, 4, 1]],
        cells: 6,
        coordinates: 1_158.0,
        arrays: &[("cellscalar", 1, "f32", 87.300_001_978_874_2)],
    },
    Expected {
        file: "classic/bluntfinxyz.bin",
        dims: &[[40, 32, 32]],
        cells: 37_479,
        coordinates: 7_230_778.121_331_513,
        arrays: &[
            ("Density", 1, "f32", 2_323_526.019_211_545_6),
            ("Momentum", 3, "f32", 3_387_663.180_371_019),
            ("StagnationEnergy", 1, "f32", 12_485_879.174_754_977),
        ],
    },
    Expected {
        file: "classic/combxyz.bin",
        dims: &[[57, 33, 25]],
        cells: 43_008,
        coordinates: 91_198_384.394_878_97,
        arrays: &[
            ("Density", 1, "f32", 692_797.590_499_237_2),
            ("Momentum", 3, "f32", 490_884_824.362_026_4),
            ("StagnationEnergy", 1, "f32", 0.0),
        ],
    },
    Expected {
        file: "classic/postxyz.bin",
        dims: &[[38, 76, 38]],
        cells: 102_675,
        coordinates: 9_321_244.799_766_2,
        arrays: &[
            ("vtkGhostType", 1, "u8", 0.0),
            ("IBlank", 1, "i32", 4_953_960.0),
            ("Density", 1, "f32", 5_376_346.0),
            ("Momentum", 3, "f32", 1_854_593.425_772_647_8),
            ("StagnationEnergy", 1, "f32", 11_725_582.788_163_634),
        ],
    },
    Expected {
        file: "curvilinear/multi-bin.xyz",
        dims: &[[8, 12, 12], [8, 12, 12]],
        cells: 1694,
        coordinates: 540_204.055_247_694_3,
        arrays: &[
            ("Density", 1, "f64", 110_194.524_857_282_64),
            ("Momentum", 3, "f64", 179_096.596_706_353_22),
            ("StagnationEnergy", 1, "f64", 594_299.141_841_948),
        ],
    },
    Expected {
        file: "curvilinear/multi-bin-C.xyz",
        dims: &[[8, 12, 12], [8, 12, 12]],
        cells: 1694,
        coordinates: 540_204.055_247_694_3,
        arrays: &[
            ("Density", 1, "f64", 110_194.524_857_282_64),
            ("Momentum", 3, "f64", 179_096.596_706_353_22),
            ("StagnationEnergy", 1, "f64", 594_299.141_841_948),
        ],
    },
    Expected {
        file: "curvilinear/multi-ascii.xyz",
        dims: &[[8, 12, 12], [8, 12, 12]],
        cells: 1694,
        coordinates: 540_204.051_651_052_8,
        arrays: &[
            ("Density", 1, "f32", 110_194.524_857_282_64),
            ("Momentum", 3, "f32", 179_096.595_846_465_76),
            ("StagnationEnergy", 1, "f32", 594_299.142_441_570_8),
        ],
    },
];

#[test]
fn blocks_and_values_are_those_of_vtk() {
    for expected in EXPECTED {
        let name = expected.file;
        let Some(mesh) = in_memory(name) else { return };
        let dims: Vec<_> = mesh.blocks().iter().map(StructuredBlock::dims).collect();
        assert_eq!((&dims[..], mesh.cells()), (expected.dims, expected.cells), "{name}");
        assert!(close(sum(coordinates(mesh.points())), expected.coordinates), "{name}: coordinates");
        let is_cell = |array: &&Array| array.association == Association::Cell;
        let (cell, point): (Vec<_>, Vec<_>) = mesh.arrays().iter().partition(is_cell);
        let mut found: Vec<_> = cell.into_iter().chain(point).collect();
        assert_eq!(found.len(), expected.arrays.len(), "{name}");
        for &(array_name, components, kind, expected_sum) in expected.arrays {
            let same = |array: &&Array| {
                (array.name.as_str(), array.components, array.values.type_name()) == (array_name, components, kind)
            };
            let at = found.iter().position(same).unwrap_or_else(|| panic!("{name}: no {array_name}"));
            let found_sum = sum(values(found.remove(at)));
            assert!(close(found_sum, expected_sum), "{name}: {array_name}: {found_sum}, not {expected_sum}");
        }
    }
}

#[test]
fn columns_that_memory_may_not_hold_are_the_same() {
    let folder = tempfile::tempdir().unwrap();
    for Expected { file, .. } in EXPECTED {
        let scratch = io::Scratch::in_folder(folder.path(), 0);
        let (Some(a), Some(b)) = (in_memory(file), open(file, &scratch)) else { return };
        let all = |mesh: &StructuredMesh| mesh.arrays().iter().flat_map(values).map(f64::to_bits).collect::<Vec<_>>();
        assert!(all(&a) == all(&b) && coordinates(a.points()).eq(coordinates(b.points())), "{file}");
        let from_files = b.arrays().iter().filter(|array| array.name != "vtkGhostType");
        assert_eq!(from_files.map(|array| array.values.owned_bytes()).sum::<u64>(), 0, "{file}: arrays in memory");
        let (a, b) = (a.into_tets().unwrap(), b.into_tets_in(&scratch).unwrap());
        assert!(a.tets == b.tets && a.file_from_tet == b.file_from_tet, "{file}");
        assert_eq!((b.tets.owned_bytes(), b.file_from_tet.owned_bytes()), (0, 0), "{file}: tetrahedra in memory");
    }
}

/// That the meshes agree to `digits` in every coordinate and value.
fn assert_same(files: [&str; 2], digits: f64) {
    let [Some(a), Some(b)] = files.map(in_memory) else { return };
    assert_eq!(a.blocks(), b.blocks());
    let near = |(a, b): (f64, f64)| (a - b).abs() <= digits * a.abs().max(1.0);
    assert!(coordinates(a.points()).zip(coordinates(b.points())).all(near), "{files:?}: points");
    for (a, b) in a.arrays().iter().zip(b.arrays()) {
        assert_eq!(a.name, b.name);
        assert!(values(a).zip(values(b)).all(near), "{files:?}: {}", a.name);
    }
    let tets = [a, b].map(|mesh| mesh.into_tets().unwrap().tets);
    assert_eq!(tets[0].len(), tets[1].len());
    assert!(digits > 0.0 || tets[0] == tets[1], "{files:?}: tetrahedra");
}

#[test]
fn formats_of_one_grid_give_the_same_mesh() {
    assert_same(["classic/bluntfin.vts", "classic/bluntfinxyz.bin"], 0.0);
    assert_same(["curvilinear/multi-bin.xyz", "curvilinear/multi-bin-C.xyz"], 0.0);
    assert_same(["curvilinear/multi-bin.xyz", "curvilinear/multi-ascii.xyz"], 1e-6);
    for other in ["AppendedBase64", "Compressed", "InlineBinary", "RawBinary"] {
        let file = format!("formats/RectilinearGrid{other}.vtr");
        assert_same(["formats/RectilinearGrid_ascii.vtr", &file], 0.0);
    }
    assert_same(["formats/rectilinear_grid.vtk", "formats/rectilinear_grid_binary.vtk"], 0.0);
}

#[test]
fn cells_are_split_turned_and_counted() {
    let Some(folder) = data_folder("cells_are_split_turned_and_counted") else { return };
    let open = |name: &str| io::open(&folder.join(name)).unwrap_or_else(|error| panic!("{error}"));
    // 39 cells have collapsed at the leading edge: 115 of their tetrahedra repeat a point.
    let fin = open("classic/bluntfin.vts");
    assert_eq!((fin.counts.in_file, fin.counts.split), (37_479, 37_479));
    assert_eq!((fin.tets.len(), fin.counts.degenerate), (6 * 37_479 - 115, 0));
    let left_handed = open("curvilinear/SampleStructGrid.vtk");
    assert_eq!((left_handed.tets.len(), left_handed.counts.inverted), (6 * 21_489, 6 * 21_489));
    let post = open("classic/postxyz.bin");
    assert_eq!((post.tets.len(), post.counts.ghost), (6 * 102_675, 0));
    let flat = io::open(&folder.join("formats/rectilinear_grid.vtk")).unwrap_err().to_string();
    assert!(flat.contains("6 cells without volume"), "{flat}");
}

/// File, points along i, j and k, spacing, origin, then the arrays with their sums (of VTK, those of NRRD of pynrrd).
type ExpectedVolume =
    (&'static str, [usize; 3], [f64; 3], [f64; 3], &'static [(&'static str, usize, &'static str, f64)]);

const VOLUMES: &[ExpectedVolume] = &[
    ("regular/hydrogen.vti", [64; 3], [1.0; 3], [0.0; 3], &[("probability_density", 1, "f32", 237_942.676_731_938_47)]),
    ("regular/heart.vti", [32, 32, 12], [1.0, 1.0, 4.0], [0.0; 3], &[("scalars", 1, "f32", 40_841_433.0)]),
    ("formats/volume_complex.vti", [3, 4, 6], [1.0; 3], [0.0; 3], &[("volume_scalars", 1, "i8", 32_850.0)]),
    ("formats/volume_complex.vtk", [3, 4, 6], [1.0; 3], [0.0; 3], &[("volume_scalars", 1, "i8", 32_850.0)]),
    (
        "regular/head.120.vtk",
        [120, 120, 130],
        [2.26448, 2.26448, 2.27132],
        [0.0; 3],
        &[("nrrd94920", 1, "u8", 2_581_476_238.0)],
    ),
    ("regular/ironProt.vtk", [68; 3], [1.0; 3], [0.0; 3], &[("scalars", 1, "u8", 201_985_734.0)]),
    (
        "regular/carotid.vtk",
        [76, 49, 45],
        [1.0; 3],
        [100.0, 80.0, 1.0],
        &[("scalars", 1, "f32", 813_261_780.0), ("vectors", 3, "f32", 185_544.586_948_665_67)],
    ),
    ("classic/engine.nhdr", [149, 208, 110], [1.0; 3], [0.0; 3], &[("value", 1, "u8", 8_979_887_688.0)]),
    ("classic/Bucky.nhdr", [32; 3], [1.0; 3], [0.0; 3], &[("value", 1, "u8", 57_324_468.0)]),
    ("regular/Teddybear.nhdr", [128, 128, 62], [2.8, 2.8, 5.0], [0.0; 3], &[("value", 1, "u8", 2_682_110_137.0)]),
    ("regular/LIDC2.nhdr", [256, 256, 133], [1.40625, 1.40625, 2.5], [0.0; 3], &[("value", 1, "u8", 3_014_151_166.0)]),
];

#[test]
fn volumes_are_those_of_vtk() {
    let Some(folder) = data_folder("volumes_are_those_of_vtk") else { return };
    for &(file, dims, spacing, origin, arrays) in VOLUMES {
        let Mesh::Volume(volume) = io::open_mesh(&folder.join(file)).unwrap_or_else(|error| panic!("{error}")) else {
            panic!("{file}: no volume")
        };
        assert_eq!((volume.dims, volume.lattice), (dims, Lattice::new(origin.into(), spacing.into())), "{file}");
        assert_eq!(volume.arrays.len(), arrays.len(), "{file}");
        for (array, &(name, components, kind, expected)) in volume.arrays.iter().zip(arrays) {
            assert_eq!(
                (&array.name[..], array.components, array.values.type_name()),
                (name, components, kind),
                "{file}"
            );
            let found = sum(values(array));
            assert!(close(found, expected), "{file}: {name}: {found}, not {expected}");
        }
    }
}

/// Raw samples are those of their header, in place or not, compressed or not.
#[test]
fn raw_volumes_are_those_of_their_headers() {
    let Some(folder) = data_folder("raw_volumes_are_those_of_their_headers") else { return };
    let files = [
        ("classic/engine", "raw", "149x208x110:u8", [1.0; 3]),
        ("classic/Bucky", "raw", "32x32x32:u8", [1.0; 3]),
        ("regular/Teddybear", "raw", "128x128x62:u8", [2.8, 2.8, 5.0]),
        ("regular/LIDC2", "raw.gz", "256x256x133:u8", [1.40625, 1.40625, 2.5]),
    ];
    for (name, extension, layout, spacing) in files {
        let mut layout: io::RawLayout = layout.parse().unwrap();
        layout.spacing = spacing;
        let raw = io::open_raw(&folder.join(format!("{name}.{extension}")), &layout).unwrap();
        let unmapped = io::Scratch::unmapped();
        let Mesh::Volume(volume) = io::open_mesh_in(&folder.join(format!("{name}.nhdr")), &unmapped).unwrap() else {
            panic!("{name}: no volume")
        };
        assert_eq!((raw.dims, raw.lattice), (volume.dims, volume.lattice), "{name}");
        let [(NumericColumn::U8(a), NumericColumn::U8(b))] = [(&raw.arrays[0].values, &volume.arrays[0].values)] else {
            panic!("{name}: other types")
        };
        assert!(a == b, "{name}");
        let in_place = if extension == "raw" { 0 } else { a.len() as u64 };
        assert_eq!((raw.owned_bytes(), raw.backing.is_some()), (in_place, in_place == 0), "{name}");
        assert_eq!(volume.owned_bytes(), b.len() as u64, "{name}");
    }
}

/// As whole cells, from a direction that shows something.
#[test]
fn volumes_are_drawn() {
    let Some(folder) = data_folder("volumes_are_drawn") else { return };
    for &(file, dims, ..) in VOLUMES {
        // The largest take seconds each.
        if dims.iter().product::<usize>() > 400_000 {
            continue;
        }
        let dataset = io::open_mesh(&folder.join(file)).unwrap().into_whole_dataset().unwrap();
        assert_eq!(dataset.hexahedra.len(), dims.map(|points| points - 1).iter().product::<usize>(), "{file}");
        let field = dataset.field(&FieldSelection::parse(&dataset.arrays[0].name, &dataset.arrays)).unwrap();
        let distance = dataset.diagonal_world() / 100.0;
        let transfer = presets::preset("viridis", field.range, OpacityProfile::default(), distance).unwrap();
        let camera = Camera::framing(&dataset.corners_world(), 35.0, 20.0, 64, 48);
        let options = RenderOptions::default();
        let rendered = Renderer::new(options).render(&Scene::new(dataset, field, &transfer), &camera).unwrap();
        assert!(rendered.covered_px(&options) > 300, "{file}: {} pixels", rendered.covered_px(&options));
    }
}
