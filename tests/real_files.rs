//! Real files in every encoding: counts and values as VTK 9.7 gives them.

#![expect(clippy::float_cmp, reason = "values are read bit for bit")]

mod common;

use std::path::Path;

use cellfan::Error;
use cellfan::columns::{Array, Association};
use cellfan::io::{self, Compression, Mesh, UnstructuredMesh};
use common::data_folder;

/// A weighted sum that any changed, missing or exchanged value changes.
fn sum(values: impl Iterator<Item = f64>) -> f64 {
    values.enumerate().map(|(i, value)| value * (i % 97 + 1) as f64).sum()
}

fn open(path: &Path, scratch: &io::Scratch) -> UnstructuredMesh {
    match io::open_mesh_in(path, scratch).unwrap_or_else(|error| panic!("{error}")) {
        Mesh::Unstructured(mesh) => mesh,
        Mesh::Structured(_) | Mesh::Volume(_) => panic!("{}: blocks", path.display()),
    }
}

fn coordinates(mesh: &UnstructuredMesh) -> impl Iterator<Item = f64> {
    (0..mesh.points.len()).flat_map(|i| mesh.points.get(i).to_array())
}

fn array_sum(array: &Array) -> f64 {
    sum((0..array.values.len()).map(|i| array.values.get(i)))
}

fn close(found: f64, expected: f64) -> bool {
    (found - expected).abs() <= 1e-9 * expected.abs().max(1.0)
}

/// File, points, cells, then sums of coordinates, connectivity and the array (of points before that of cells).
struct Expected {
    file: &'static str,
    points: usize,
    cells: usize,
    coordinates: f64,
    connectivity: f64,
    arrays: &'static [(&'static str, usize, &'static str, f64)],
}

const EXPECTED: &[Expected] = &[
    Expected {
        file: "classic/post.vtk",
        points: 2288,
        cells: 8750,
        coordinates: 34_593.542_074_744_59,
        connectivity: 1_961_317_211.0,
        arrays: &[("Pressure", 1, "f32", 86_894.546_945_214_27)],
    },
    Expected {
        file: "classic/spx.vtk",
        points: 2896,
        cells: 12_936,
        coordinates: -69_906.386_133_453_49,
        connectivity: 3_763_986_529.0,
        arrays: &[("scalars", 1, "f32", 41_070.925_367_076_18)],
    },
    Expected {
        file: "derived/hand.vtu",
        points: 7234,
        cells: 29_998,
        coordinates: -6_019.444_622_270_563,
        connectivity: 26_565_592_730.0,
        arrays: &[("dist_centroid", 1, "f32", 164_239.092_236_045_75)],
    },
    Expected {
        file: "derived/sf10.vtu",
        points: 7294,
        cells: 35_025,
        coordinates: 14_218_722.870_914_876,
        connectivity: 23_921_624_467.0,
        arrays: &[("log10_volume", 1, "f32", -1_703_127.130_287_073_6), ("depth", 1, "f32", 553_329.687_685_072_4)],
    },
    Expected {
        file: "derived/spx_off.vtu",
        points: 2896,
        cells: 12_936,
        coordinates: 848_329.175_210_16,
        connectivity: 3_531_861_716.0,
        arrays: &[("scalar", 1, "f32", 48_042.934_240_236_88)],
    },
    Expected {
        file: "derived/utahtorso_lowres.vtu",
        points: 8278,
        cells: 51_419,
        coordinates: 135_526_944.563_894_4,
        connectivity: 41_739_247_824.0,
        arrays: &[("region", 1, "i32", 8_233_827.0), ("voltage", 1, "f32", -542_747.373_939_133_2)],
    },
    Expected {
        file: "formats/box.vtu",
        points: 8,
        cells: 6,
        coordinates: -12.0,
        connectivity: 1_066.0,
        arrays: &[
            ("mtl_id", 1, "i32", 0.0),
            ("Cd", 3, "f32", 117.400_000_199_675_56),
            ("mtl_id", 1, "i32", 36.0),
            ("pressure", 1, "f32", 4.0),
        ],
    },
    Expected {
        file: "formats/mfem_beam-hex.vtk",
        points: 36,
        cells: 8,
        coordinates: 8_320.0,
        connectivity: 40_528.0,
        arrays: &[("material", 1, "i32", 62.0)],
    },
    Expected {
        file: "formats/mfem_beam-tet.vtk",
        points: 36,
        cells: 48,
        coordinates: 8_320.0,
        connectivity: 169_244.0,
        arrays: &[("material", 1, "i32", 2_052.0)],
    },
    Expected {
        file: "formats/mfem_beam-wedge.vtk",
        points: 27,
        cells: 8,
        coordinates: 6_156.0,
        connectivity: 16_980.0,
        arrays: &[("material", 1, "i32", 62.0)],
    },
    Expected {
        file: "formats/mfem_escher-p2.vtk",
        points: 117,
        cells: 42,
        coordinates: 1_231.953_895_799_999_8,
        connectivity: 831_926.0,
        arrays: &[("material", 1, "i32", 903.0)],
    },
    Expected {
        file: "formats/mfem_fichera-mixed-p2.vtk",
        points: 116,
        cells: 14,
        coordinates: 996.569_057_220_095_1,
        connectivity: 484_465.0,
        arrays: &[("material", 1, "i32", 105.0)],
    },
    Expected {
        file: "formats/tet.vtu",
        points: 4,
        cells: 1,
        coordinates: -4.206_759_512_424_469,
        connectivity: 13.0,
        arrays: &[("mtl_id", 1, "i32", 1.0), ("pressure", 1, "f32", 1.414_215_445_518_493_7)],
    },
    Expected { file: "formats/tet_test.vtk", points: 4, cells: 1, coordinates: 12.0, connectivity: 20.0, arrays: &[] },
    Expected {
        file: "formats/tet_test_binary.vtk",
        points: 4,
        cells: 1,
        coordinates: 12.0,
        connectivity: 20.0,
        arrays: &[],
    },
    Expected {
        file: "formats/unstructured_grid_complex.vtk",
        points: 27,
        cells: 12,
        coordinates: 6_198.0,
        connectivity: 27_110.0,
        arrays: &[("scalars", 1, "f32", 6_552.0), ("vectors", 3, "f32", 1_274.0)],
    },
    Expected {
        file: "unstructured/Armadillo_Tetra_4406.vtu",
        points: 1446,
        cells: 4406,
        coordinates: 215_692.527_806_165_92,
        connectivity: 724_114_626.0,
        arrays: &[],
    },
    Expected {
        file: "unstructured/CylinderLinear.vtk",
        points: 465,
        cells: 1522,
        coordinates: 1_115.897_790_564_036_8,
        connectivity: 85_522_158.0,
        arrays: &[("vel_norm", 1, "f64", 3_825.202_129_512_955_3), ("velocity", 3, "f64", -3_995.608_255_737_672)],
    },
    Expected {
        file: "unstructured/CylinderQuadratic.vtk",
        points: 2814,
        cells: 1522,
        coordinates: 7_021.040_552_374_253,
        connectivity: 871_293_086.0,
        arrays: &[
            ("Re", 1, "f64", 0.0),
            ("pressure", 1, "f64", 151_350_955.698_506_2),
            ("velocity", 3, "f64", -27_923.176_136_652_47),
            ("velocity_norm", 1, "f64", 28_433.596_008_592_755),
            ("pressure", 1, "f64", 282_993_097.051_590_2),
            ("velocity", 3, "f64", -38_809.663_925_409_81),
            ("velocity_norm", 1, "f64", 38_621.903_475_922_2),
        ],
    },
    Expected {
        file: "unstructured/PentaHexa.vtk",
        points: 401,
        cells: 210,
        coordinates: 439.531_590_5,
        connectivity: 19_303_935.0,
        arrays: &[("scalar1", 1, "u64", 1_106_811.0), ("scalar2", 1, "f32", 12_000.400_170_207_024)],
    },
    Expected {
        file: "unstructured/UNISIM-II-D.vtu",
        points: 58_433,
        cells: 47_610,
        coordinates: 22_313_495_889_274.426,
        connectivity: 535_365_131_382.0,
        arrays: &[
            ("BLOCK_I", 1, "i32", 52_492_123.0),
            ("BLOCK_J", 1, "i32", 79_303_818.0),
            ("BLOCK_K", 1, "i32", 16_332_001.0),
            ("vtkGhostType", 1, "u8", 23_174_976.0),
            ("vtkOriginalCellIds", 1, "i64", 55_538_238_925.0),
        ],
    },
    Expected {
        file: "unstructured/a_grid.vtk",
        points: 1317,
        cells: 4802,
        coordinates: 256_961.450_933_991_93,
        connectivity: 764_325_969.0,
        arrays: &[],
    },
    Expected {
        file: "unstructured/box_hybrid_mesh.vtu",
        points: 3655,
        cells: 9407,
        coordinates: 4_697_405.538_859_367,
        connectivity: 3_437_146_964.0,
        arrays: &[("attribute", 1, "i32", 1_639_952.0)],
    },
    Expected {
        file: "unstructured/can.vtu",
        points: 6724,
        cells: 4800,
        coordinates: -6_115_177.459_776_416,
        connectivity: 6_063_356_079.0,
        arrays: &[
            ("EQPS", 1, "f64", 181_530.792_125_802_5),
            ("ACCL", 3, "f64", 318_842_147_696.898_1),
            ("DISPL", 3, "f64", -4_679_190.400_594_768),
            ("GlobalNodeId", 1, "i64", 1_105_894_969.0),
            ("PedigreeNodeId", 1, "i64", 1_105_894_969.0),
            ("VEL", 3, "f64", -1_694_285_493.196_514_4),
        ],
    },
    Expected {
        file: "unstructured/disk_out_ref.vtu",
        points: 8499,
        cells: 7472,
        coordinates: 1_089_676.506_351_069,
        connectivity: 12_293_548_662.0,
        arrays: &[
            ("AsH3", 1, "f64", 57_597.182_686_880_23),
            ("CH4", 1, "f64", 214.619_232_365_466_81),
            ("GaMe3", 1, "f64", 2_005.672_621_291_48),
            ("H2", 1, "f64", 355_523.525_263_309_5),
            ("Pres", 1, "f64", 8_678.736_085_126_642),
            ("Temp", 1, "f64", 175_655_424.957_000_73),
            ("V", 3, "f64", -2_517_102.430_893_256_3),
        ],
    },
    Expected {
        file: "unstructured/driven_cavity_58.vtu",
        points: 36_695,
        cells: 122_371,
        coordinates: 2_019_734.419_139_122_8,
        connectivity: 432_635_834_263.0,
        arrays: &[
            ("Pressure", 1, "f32", -273_384.476_175_262_9),
            ("Temperature", 1, "f32", 0.0),
            ("Velocity", 3, "f32", 14_076.934_906_887_735),
        ],
    },
    Expected {
        file: "unstructured/fire_ug.vtu",
        points: 12_323,
        cells: 10_462,
        coordinates: 3_169_792.882_203_981_3,
        connectivity: 25_279_487_006.0,
        arrays: &[
            ("mfrac", 1, "f32", 1_104.447_355_142_223_4),
            ("t", 1, "f32", 218_093_761.788_146_97),
            ("u", 1, "f32", 29_057.927_885_034_325),
            ("uvw", 3, "f32", 81_029.312_418_535_15),
            ("v", 1, "f32", 41_583.064_114_160_66),
            ("w", 1, "f32", 12_098.591_318_800_216),
        ],
    },
    Expected {
        file: "unstructured/hexa.vtk",
        points: 12_167,
        cells: 10_648,
        coordinates: 854_873.002_980_921_4,
        connectivity: 25_391_151_493.0,
        arrays: &[("scalars", 1, "f32", 5_717_923.546_702_146_5)],
    },
    Expected {
        file: "unstructured/lv_passive_hex.vtu",
        points: 7565,
        cells: 5936,
        coordinates: -2_055_899.746_226_148_4,
        connectivity: 9_678_826_041.0,
        arrays: &[
            ("E_Jacobian", 1, "f64", 299_546.755_586_982_76),
            ("E_VonMises", 1, "f64", 30_283_740_854.562_71),
            ("Displacement", 3, "f64", -1_597_240.811_600_958_5),
            ("Jacobian", 1, "f64", 383_435.852_208_837_3),
            ("Velocity", 3, "f64", -579_054.182_063_368_1),
            ("VonMises_stress", 1, "f64", 39_266_575_714.095_59),
        ],
    },
    Expected {
        file: "unstructured/multi_material_cylinder_plate.vtk",
        points: 2101,
        cells: 10_440,
        coordinates: 9.405_163_297_537_655,
        connectivity: 2_372_645_556.0,
        arrays: &[("mat_id", 1, "i64", 1_133_311.0), ("node_groups", 1, "i64", 526_351.0)],
    },
    Expected {
        file: "unstructured/notch_disp.vtu",
        points: 12_717,
        cells: 2192,
        coordinates: 156_095.896_551_505_87,
        connectivity: 15_470_922_177.0,
        arrays: &[("Nodal Displacement", 3, "f64", 0.840_462_298_538_366_6)],
    },
    Expected {
        file: "unstructured/notch_stress_fixed.vtk",
        points: 3537,
        cells: 2192,
        coordinates: 43_274.547_200_837_114,
        connectivity: 1_750_754_819.0,
        arrays: &[
            ("Nodal Stress", 6, "f64", 474_564_737_387.297_8),
            ("Nodal Stress-0", 1, "f64", 377_263_417_750.619_9),
            ("Nodal Stress-normed", 1, "f64", 411_624_595_287.745_2),
        ],
    },
    Expected {
        file: "unstructured/patch_antenna.vtu",
        points: 1464,
        cells: 3997,
        coordinates: 134.237_030_468_432_64,
        connectivity: 554_423_403.0,
        arrays: &[
            ("ElectricField", 1, "f32", 134_221_190.203_353_88),
            ("MagneticField", 3, "f32", -123_351.587_690_245_88),
        ],
    },
    Expected {
        file: "unstructured/pebi3d_with_properties.vtu",
        points: 3388,
        cells: 1630,
        coordinates: 249_852.527_894_463_4,
        connectivity: 1_482_988_250.0,
        arrays: &[
            ("BULKMOD", 1, "f64", 396_405_500_000_000.0),
            ("DENSITY", 1, "f64", 209_767_900.0),
            ("GLOBAL_IDS_CELLS", 1, "i64", 65_131_862.0),
            ("NTG", 1, "f64", 71_216.1),
            ("PERM", 3, "f64", 4.765_400_000_000_001e-11),
            ("PORO", 1, "f64", 6_904.775),
            ("vtkOriginalCellIds", 1, "i64", 65_131_862.0),
            ("GLOBAL_IDS_POINTS", 1, "i64", 282_734_809.0),
            ("vtkOriginalPointIds", 1, "i64", 282_734_809.0),
        ],
    },
    Expected {
        file: "unstructured/pipe_flow.vtu",
        points: 30_211,
        cells: 170_694,
        coordinates: 22_308_106.374_037_646,
        connectivity: 537_930_874_687.0,
        arrays: &[
            ("Pressure", 1, "f64", 1_934_430_724.482_957_6),
            ("Traction", 3, "f64", -3_590_469.297_395_257_3),
            ("Velocity", 3, "f64", -1_454_832.876_662_581_2),
            ("WSS", 3, "f64", -275_744.185_975_685),
        ],
    },
    Expected {
        file: "unstructured/pipe_wall.vtu",
        points: 8365,
        cells: 24_898,
        coordinates: 6_162_837.107_420_338,
        connectivity: 20_366_558_180.0,
        arrays: &[("Displacement", 3, "f64", 1.494_175_323_193_150_3), ("Stress", 6, "f64", 481_957_527_255.038_7)],
    },
    Expected {
        file: "unstructured/synthetic.vtu",
        points: 24_578,
        cells: 135_957,
        coordinates: 16_544_859_029.800_297,
        connectivity: 371_892_077_630.0,
        arrays: &[("attribute", 1, "i32", 13_333_524.0)],
    },
    Expected {
        file: "unstructured/wheelset.vtk",
        points: 5457,
        cells: 21_934,
        coordinates: -1_810.166_086_183_828_2,
        connectivity: 13_843_715_359.0,
        arrays: &[("mat_id", 1, "i64", 0.0), ("node_groups", 1, "i64", 0.0)],
    },
];

#[test]
fn counts_and_values_are_those_of_vtk() {
    let Some(folder) = data_folder("counts_and_values_are_those_of_vtk") else { return };
    for expected in EXPECTED {
        let name = expected.file;
        let mesh = open(&folder.join(name), &io::Scratch::memory());
        assert_eq!((mesh.points.len(), mesh.cells()), (expected.points, expected.cells), "{name}");
        assert!(close(sum(coordinates(&mesh)), expected.coordinates), "{name}: coordinates");
        let connectivity = sum(mesh.connectivity.iter().map(|&point| f64::from(point)));
        assert!(close(connectivity, expected.connectivity), "{name}: connectivity");
        let found: Vec<_> = mesh.arrays.iter().map(|a| (a.name.as_str(), a.components, a.values.type_name())).collect();
        assert_eq!(found.len(), expected.arrays.len(), "{name}: {found:?}");
        for &(array_name, components, kind, expected_sum) in expected.arrays {
            let array = mesh.arrays.iter().find(|array| {
                (array.name.as_str(), array.components, array.values.type_name()) == (array_name, components, kind)
                    && close(array_sum(array), expected_sum)
            });
            assert!(array.is_some(), "{name}: {array_name} of {components} {kind} with sum {expected_sum}: {found:?}");
        }
    }
}

#[test]
fn columns_that_memory_may_not_hold_are_the_same() {
    let Some(folder) = data_folder("columns_that_memory_may_not_hold_are_the_same") else { return };
    let scratch_folder = tempfile::tempdir().unwrap();
    for Expected { file, .. } in EXPECTED {
        let scratch = io::Scratch::in_folder(scratch_folder.path(), 0);
        let [a, b] = [io::Scratch::memory(), scratch].map(|scratch| {
            let mesh = open(&folder.join(file), &scratch);
            let owned: u64 = mesh.arrays.iter().map(|array| array.values.owned_bytes()).sum();
            let (points, arrays) = (sum(coordinates(&mesh)), mesh.arrays.iter().map(array_sum).collect::<Vec<_>>());
            let columns = (mesh.types.clone(), mesh.offsets.clone(), mesh.connectivity.clone());
            let tets = mesh.into_tets_in(&scratch).unwrap();
            (points, arrays, columns, tets.tets, tets.file_from_tet, owned)
        });
        // As bits: arrays of real files hold NaN.
        let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        assert_eq!((a.0.to_bits(), bits(&a.1)), (b.0.to_bits(), bits(&b.1)), "{file}");
        assert!(a.2 == b.2 && a.3 == b.3 && a.4 == b.4, "{file}");
        assert_eq!(b.5, 0, "{file}: arrays in memory");
        assert_eq!(b.3.owned_bytes(), 0, "{file}: tetrahedra in memory");
    }
}

#[test]
fn all_encodings_of_the_hexahedron_give_the_same_mesh() {
    let Some(folder) = data_folder("all_encodings_of_the_hexahedron_give_the_same_mesh") else { return };
    let mut files = 0;
    for entry in std::fs::read_dir(folder.join("formats")).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if !name.starts_with("hexahedron") {
            continue;
        }
        files += 1;
        let mesh = open(&path, &io::Scratch::memory());
        let expected = [
            [0.0, 0.0, 0.0],
            [0.0, 0.0, -1.0],
            [0.0, 1.0, 0.0],
            [0.0, 1.0, -1.0],
            [1.0, 0.0, 0.0],
            [1.0, 0.0, -1.0],
            [1.0, 1.0, 0.0],
            [1.0, 1.0, -1.0],
        ];
        assert!(coordinates(&mesh).eq(expected.into_iter().flatten()), "{name}");
        assert_eq!((&mesh.types[..], &mesh.offsets[..]), (&[12][..], &[0, 8][..]), "{name}");
        assert_eq!(mesh.connectivity[..], [0, 4, 5, 1, 2, 6, 7, 3], "{name}");
        if !mesh.arrays.is_empty() {
            let array = mesh.array("float32x1", Association::Point).unwrap();
            assert!((0..8).all(|i| array.values.get(i) == f64::from(1 << i)), "{name}");
            assert_eq!(mesh.array("float64x1", Association::Cell).unwrap().values.get(0), 1_024.0, "{name}");
        }
        let volume = volume(&mesh);
        assert!((volume - 1.0).abs() < 1e-6, "{name}: volume {volume}");
    }
    assert_eq!(files, 12);
}

/// The volume of all cells as they are drawn.
fn volume(mesh: &UnstructuredMesh) -> f64 {
    let data = mesh.clone().into_dataset().unwrap();
    let position = |v: u32| glam::Vec3::from_array(data.positions[v as usize]).as_dvec3();
    let volume = |tet: [u32; 4]| {
        let [a, b, c, d] = tet.map(position);
        (b - a).cross(c - a).dot(d - a).abs() / 6.0
    };
    data.tets.iter().map(volume).sum()
}

#[test]
fn cells_are_split_hidden_and_counted() {
    let Some(folder) = data_folder("cells_are_split_hidden_and_counted") else { return };
    let counts = |name: &str| io::open(&folder.join(name)).unwrap_or_else(|error| panic!("{error}")).counts;
    let reservoir = counts("unstructured/UNISIM-II-D.vtu");
    assert_eq!((reservoir.in_file, reservoir.ghost, reservoir.split), (47_610, 14_775, 32_835));
    let notch = counts("unstructured/notch_disp.vtu");
    assert_eq!((notch.quadratic, notch.split), (2192, 2192));
    let elements = counts("unstructured/supportedElements.vtk");
    assert_eq!((elements.in_file, elements.unsupported, elements.split), (12, 0, 11));
    let hybrid = counts("unstructured/box_hybrid_mesh.vtu");
    assert_eq!((hybrid.split, hybrid.inverted), (943 + 515, 0));
    let error = io::open(&folder.join("formats/box.vtu")).unwrap_err();
    assert!(error.to_string().contains("6 cells without volume"), "{error}");
}

#[test]
fn other_formats_are_refused_by_name() {
    let Some(folder) = data_folder("other_formats_are_refused_by_name") else { return };
    for (file, name) in [
        ("unstructured/disk_out_ref.ex2", "Exodus"),
        ("unstructured/cgns_hdf5_hex.cgns", "CGNS"),
        ("regular/CT_pitch.nii.gz", "NIfTI"),
        ("regular/neghip.slc", "SLC"),
        ("classic/Bucky.raw", "--raw"),
        ("regular/LIDC2.raw.gz", "--raw"),
        ("curvilinear/multi-bin.q", "PLOT3D solution"),
        ("classic/combq.bin", "PLOT3D solution"),
        ("unstructured/hand.mesh", "Medit"),
        ("unstructured/cylinder.msh", "Gmsh"),
        ("formats/cube_complex.vtk", "POLYDATA"),
    ] {
        let error = io::open(&folder.join(file)).unwrap_err();
        assert!(matches!(error, Error::Unsupported { .. }) && error.to_string().contains(name), "{file}: {error}");
    }
}

#[test]
fn real_meshes_survive_being_written() {
    let Some(folder) = data_folder("real_meshes_survive_being_written") else { return };
    let out = tempfile::tempdir().unwrap();
    for file in ["unstructured/can.vtu", "unstructured/UNISIM-II-D.vtu", "unstructured/notch_stress_fixed.vtk"] {
        let mesh = open(&folder.join(file), &io::Scratch::memory());
        let path = out.path().join(Path::new(file).file_stem().unwrap()).with_extension("vtu");
        io::write_vtu(&path, &mesh, Compression::Zlib).unwrap();
        let back = open(&path, &io::Scratch::memory());
        assert!(coordinates(&back).eq(coordinates(&mesh)), "{file}");
        assert_eq!((&back.types, &back.offsets, &back.connectivity), (&mesh.types, &mesh.offsets, &mesh.connectivity));
        assert!(back.arrays.iter().map(array_sum).eq(mesh.arrays.iter().map(array_sum)), "{file}");
    }
}
