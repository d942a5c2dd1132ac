//! Pictures of a mesh in the caller's memory: every layout gives the picture that a file gives; changes give the picture that a new
//! session gives, to the bit, and redo no more than they must.

use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex};

use cellfan::cells::{HEXAHEDRON, PYRAMID, TETRAHEDRON, WEDGE};
use cellfan::columns::{Association, FaceLists};
use cellfan::generate::Scheme;
use cellfan::session::{Cells, Indices, MeshView, Scalars, Session, Threads};
use cellfan::{
    Camera, Error, FieldSelection, Image, Model, Points, Positions, RenderOptions, Rendered, Renderer, Scene,
    SortMethod, TransferFunction, io,
};

use crate::meshes::{Random, grid, point, random_delaunay, smooth, three_views};

/// A mesh as a simulation might hold it.
struct Held {
    points: Vec<[f32; 3]>,
    corners: Vec<u32>,
    point_values: Vec<f32>,
    cell_values: Vec<f32>,
}

fn value(p: [f32; 3], time: f32) -> f32 {
    0.5 + 0.4 * (7.0 * p[0] + time).sin() * (5.0 * p[1] - time).cos() * (3.0 * p[2]).cos()
}

impl Held {
    fn new(mesh: &cellfan::TetMesh, time: f32) -> Self {
        let points: Vec<[f32; 3]> = (0..mesh.points.len()).map(|i| mesh.points.get(i).as_vec3().to_array()).collect();
        let point_values = points.iter().map(|&p| value(p, time)).collect();
        let cell_values = mesh.tets.iter().map(|tet| value(points[tet[0] as usize], time)).collect();
        Self { points, corners: mesh.tets.as_flattened().to_vec(), point_values, cell_values }
    }

    fn mesh(&self) -> MeshView<'_, '_> {
        let cells = Cells::OfKind { kind: &TETRAHEDRON, points: Indices::U32(&self.corners) };
        MeshView::new(Positions::F32(&self.points), cells)
    }

    fn of_points(&self) -> MeshView<'_, '_> {
        self.mesh().with_scalars(Association::Point, Scalars::F32(&self.point_values))
    }

    fn of_cells(&self) -> MeshView<'_, '_> {
        self.mesh().with_scalars(Association::Cell, Scalars::F32(&self.cell_values))
    }
}

fn camera(session: &Session<'_>, azimuth: f64) -> Camera {
    Camera::framing(&session.corners_world(), azimuth, 25.0, 90, 70)
}

fn draw(session: &mut Session<'_>, azimuth: f64, options: &RenderOptions) -> Rendered {
    let camera = camera(session, azimuth);
    session.render(&camera, &smooth(), options).unwrap()
}

/// What a program draws that reads the same mesh from a file.
fn of_file(mesh: io::UnstructuredMesh, azimuth: f64) -> Image {
    let dataset = mesh.into_whole_dataset().unwrap();
    let field = match dataset.arrays.first() {
        Some(array) => dataset.field(&FieldSelection::parse(&array.name, &dataset.arrays)).unwrap(),
        None => dataset.homogeneous_field(),
    };
    let camera = Camera::framing(&dataset.corners_world(), azimuth, 25.0, 90, 70);
    let scene = Scene::new(dataset, field, &smooth());
    Renderer::new(RenderOptions::default()).render(&scene, &camera).unwrap().image
}

fn bits(image: &Image) -> Vec<[u32; 4]> {
    image.pixels.iter().map(|pixel| pixel.map(f32::to_bits)).collect()
}

#[track_caller]
fn assert_alike(found: &Image, expected: &Image, what: &str) {
    let difference = found.difference(expected, [0.0; 4]).unwrap();
    // Vertices have other numbers, and positions in f64 another origin.
    assert!(difference.covered > 500 && difference.mean < 1e-6 && difference.max < 5e-4, "{what}: {difference:?}");
}

#[test]
fn every_layout_of_tetrahedra_gives_the_picture_of_the_file() {
    let mut random = Random(3);
    let mut mesh = grid(3000, Scheme::Six, 0.2);
    // Corners in any order: half of the cells run the other way.
    let tets = mesh.tets.to_mut();
    for tet in tets.iter_mut() {
        tet.rotate_left(random.below(4) as usize);
        let (i, j) = (random.below(4) as usize, random.below(4) as usize);
        tet.swap(i, j);
    }
    let held = Held::new(&mesh, 0.0);
    mesh.points = Points::F32(held.points.clone());
    for (association, values) in [(Association::Point, &held.point_values), (Association::Cell, &held.cell_values)] {
        let array = cellfan::columns::Array {
            name: "value".to_owned(),
            association,
            components: 1,
            values: values.clone().into(),
        };
        let file = io::UnstructuredMesh::from_tets(&cellfan::TetMesh { arrays: vec![array], ..mesh.clone() });
        let (types, offsets) = (file.types.to_vec(), file.offsets.to_vec());
        let expected = of_file(file, 40.0);
        let as_f64: Vec<[f64; 3]> = held.points.iter().map(|p| p.map(f64::from)).collect();
        let axes: [Vec<f32>; 3] = std::array::from_fn(|axis| held.points.iter().map(|p| p[axis]).collect());
        let axes_f64: [Vec<f64>; 3] = std::array::from_fn(|axis| as_f64.iter().map(|p| p[axis]).collect());
        let positions = [
            Positions::F32(&held.points),
            Positions::F64(&as_f64),
            Positions::AxesF32([&axes[0], &axes[1], &axes[2]]),
            Positions::AxesF64([&axes_f64[0], &axes_f64[1], &axes_f64[2]]),
        ];
        let wide: Vec<u64> = held.corners.iter().map(|&v| v.into()).collect();
        let signed: Vec<i64> = wide.iter().map(|&v| v as i64).collect();
        let narrow: Vec<i32> = signed.iter().map(|&v| v as i32).collect();
        let indices = [Indices::U32(&held.corners), Indices::I32(&narrow), Indices::U64(&wide), Indices::I64(&signed)];
        for (i, positions) in positions.into_iter().enumerate() {
            for (k, points) in indices.into_iter().enumerate() {
                let of_kind = Cells::OfKind { kind: &TETRAHEDRON, points };
                let mixed = Cells::Mixed { types: &types, offsets: Indices::U64(&offsets), points };
                for cells in [of_kind, mixed] {
                    let mesh = MeshView::new(positions, cells).with_scalars(association, Scalars::F32(values));
                    let mut session = Session::new(&mesh).unwrap();
                    let rendered = draw(&mut session, 40.0, &RenderOptions::default());
                    assert_alike(&rendered.image, &expected, &format!("{association:?}, positions {i}, indices {k}"));
                    assert!(session.counts().inverted > 1000, "{:?}", session.counts());
                }
            }
        }
    }
}

/// 3×2×2 boxes, some as other kinds: points, codes, offsets, connectivity.
fn boxes() -> (Vec<[f32; 3]>, Vec<u8>, Vec<u64>, Vec<u32>) {
    let points: Vec<[f32; 3]> = (0..36)
        .map(|i| [i % 4, i / 4 % 3, i / 12])
        .map(|[i, j, k]: [u32; 3]| {
            let bend = 0.1 * (j * k) as f32;
            [i as f32 + bend, j as f32 - 0.07 * (i * k) as f32, k as f32 + 0.05 * (i * j) as f32]
        })
        .collect();
    let (mut types, mut offsets, mut corners) = (Vec::new(), vec![0], Vec::new());
    for cell in 0..12_u32 {
        let (i, j, k) = (cell % 3, cell / 3 % 2, cell / 6);
        let a = i + 4 * j + 12 * k;
        let of = [a, a + 1, a + 5, a + 4, a + 12, a + 13, a + 17, a + 16];
        let kinds: &[(u8, &[usize])] = match cell % 4 {
            0 => &[(12, &[0, 1, 2, 3, 4, 5, 6, 7])],
            1 => &[(13, &[0, 1, 2, 4, 5, 6]), (13, &[0, 2, 3, 4, 6, 7])],
            2 => &[(14, &[0, 3, 2, 1, 6]), (14, &[0, 1, 5, 4, 6]), (14, &[0, 4, 7, 3, 6])],
            _ => &[(11, &[0, 1, 3, 2, 4, 5, 7, 6])],
        };
        for &(code, numbers) in kinds {
            types.push(code);
            corners.extend(numbers.iter().map(|&corner| of[corner]));
            offsets.push(corners.len() as u64);
        }
    }
    (points, types, offsets, corners)
}

#[test]
fn cells_of_all_kinds_give_the_picture_of_the_file() {
    let (points, types, offsets, corners) = boxes();
    let scalars: Vec<f64> = (0..types.len()).map(|cell| (cell as f64 * 0.37).sin() * 0.4 + 0.5).collect();
    let array = cellfan::columns::Array {
        name: "value".to_owned(),
        association: Association::Cell,
        components: 1,
        values: scalars.clone().into(),
    };
    let file = io::UnstructuredMesh {
        points: Points::F32(points.clone()),
        types: types.clone().into(),
        offsets: offsets.clone().into(),
        connectivity: corners.clone().into(),
        faces: FaceLists::default(),
        arrays: vec![array],
    };
    let cells = Cells::Mixed { types: &types, offsets: Indices::U64(&offsets), points: Indices::U32(&corners) };
    let mesh = MeshView::new(Positions::F32(&points), cells).with_scalars(Association::Cell, Scalars::F64(&scalars));
    let mut session = Session::new(&mesh).unwrap();
    assert_alike(&draw(&mut session, 200.0, &RenderOptions::default()).image, &of_file(file, 200.0), "mixed");

    // One kind by itself, with and without its codes; no kind but hexahedra is drawn in place.
    for (kind, code) in [(&HEXAHEDRON, 12), (&WEDGE, 13), (&PYRAMID, 14)] {
        let of_kind: Vec<usize> = (0..types.len()).filter(|&cell| types[cell] == code).collect();
        let range = |cell: usize| offsets[cell] as usize..offsets[cell + 1] as usize;
        let corners: Vec<u32> = of_kind.iter().flat_map(|&cell| &corners[range(cell)]).copied().collect();
        let types = vec![code; of_kind.len()];
        let offsets: Vec<u64> = (0..=of_kind.len()).map(|cell| (cell * kind.corners) as u64).collect();
        let all = [
            Cells::OfKind { kind, points: Indices::U32(&corners) },
            Cells::Mixed { types: &types, offsets: Indices::U64(&offsets), points: Indices::U32(&corners) },
        ];
        let file = io::UnstructuredMesh {
            points: Points::F32(points.clone()),
            types: types.clone().into(),
            offsets: offsets.clone().into(),
            connectivity: corners.clone().into(),
            faces: FaceLists::default(),
            arrays: Vec::new(),
        };
        let expected = of_file(file, 30.0);
        for cells in all {
            let mut session = Session::new(&MeshView::new(Positions::F32(&points), cells)).unwrap();
            assert_alike(&draw(&mut session, 30.0, &RenderOptions::default()).image, &expected, kind.name);
        }
    }
}

#[test]
fn structured_grids_give_the_picture_of_the_file_wherever_they_are() {
    let dims = [9, 7, 6];
    let all = (0..6).flat_map(|k| (0..7).flat_map(move |j| (0..9).map(move |i| [i, j, k].map(|c: i32| f64::from(c)))));
    let near: Vec<[f64; 3]> = all.map(|[i, j, k]| [i + 0.1 * (j * k).sin(), j - 0.1 * (i + k).cos(), k]).collect();
    for offset in [0.0, 1e6] {
        let points: Vec<[f64; 3]> = near.iter().map(|p| p.map(|x| x + offset)).collect();
        let values: Vec<u16> = (0..points.len()).map(|i| (i * 37 % 1000) as u16).collect();
        let array = cellfan::columns::Array {
            name: "value".to_owned(),
            association: Association::Point,
            components: 1,
            values: values.clone().into(),
        };
        let file = io::StructuredMesh::new(&[dims], Points::F64(points.clone()), vec![array]).unwrap();
        let dataset = file.into_whole_dataset().unwrap();
        let field = dataset.field(&FieldSelection::parse("value", &dataset.arrays)).unwrap();
        let camera = Camera::framing(&dataset.corners_world(), 40.0, 25.0, 90, 70);
        let transfer =
            TransferFunction::new(vec![point(0.0, [1.0, 0.0, 0.0], 0.0), point(1000.0, [0.0, 0.0, 1.0], 0.5)]);
        let transfer = transfer.unwrap();
        let expected = Renderer::default().render(&Scene::new(dataset, field, &transfer), &camera).unwrap().image;
        let cells = Cells::Structured { dims };
        let mesh =
            MeshView::new(Positions::F64(&points), cells).with_scalars(Association::Point, Scalars::U16(&values));
        let mut session = Session::new(&mesh).unwrap();
        let found = session.render(&camera, &transfer, &RenderOptions::default()).unwrap().image;
        assert_alike(&found, &expected, &format!("at {offset}"));
    }
}

#[test]
fn a_shuffled_mesh_is_put_in_order_and_flat_cells_are_left_out() {
    let mut mesh = random_delaunay(90_000);
    let mut random = Random(9);
    let tets = mesh.tets.to_mut();
    for i in (1..tets.len()).rev() {
        tets.swap(i, random.below(i as u32 + 1) as usize);
    }
    let flat = 5000;
    for tet in &mut tets[..flat] {
        // A corner twice: without volume.
        tet[3] = tet[0];
    }
    let held = Held::new(&mesh, 0.0);
    mesh.points = Points::F32(held.points.clone());
    for mesh in [held.of_points(), held.of_cells()] {
        let mut session = Session::new(&mesh).unwrap();
        assert_eq!(session.counts().degenerate, flat as u64);
        let rendered = draw(&mut session, 15.0, &RenderOptions::default());
        assert_eq!(rendered.cells.drawn + rendered.cells.culled_outside, (held.cell_values.len() - flat) as u64);
        let kept: Vec<u32> = held.corners[4 * flat..].to_vec();
        let (association, _) = mesh.scalars.unwrap();
        let scalars = match association {
            Association::Point => &held.point_values[..],
            Association::Cell => &held.cell_values[flat..],
        };
        let cells = Cells::OfKind { kind: &TETRAHEDRON, points: Indices::U32(&kept) };
        let without = MeshView::new(Positions::F32(&held.points), cells).with_scalars(association, scalars.into());
        let expected = draw(&mut Session::new(&without).unwrap(), 15.0, &RenderOptions::default());
        assert_eq!(bits(&rendered.image), bits(&expected.image));
    }
}

/// A function of which half the values do not show.
fn half_clear() -> TransferFunction {
    let points = [(0.0, 0.0), (0.5, 0.0), (0.55, 8.0), (1.0, 20.0)];
    TransferFunction::new(
        points.map(|(value, extinction)| point(value, [value, 0.4, 1.0 - value], extinction)).to_vec(),
    )
    .unwrap()
}

#[test]
fn other_scalars_need_no_sort_and_give_the_picture_of_a_new_session() {
    let mesh = grid(9000, Scheme::Six, 0.2);
    let steps: Vec<Held> = (0..4).map(|step| Held::new(&mesh, step as f32)).collect();
    for transfer in [smooth(), half_clear()] {
        for (model, sort) in [
            (Model::EmissionAbsorption, SortMethod::Auto),
            (Model::EmissionAbsorption, SortMethod::Centroid),
            (Model::EmissionAbsorption, SortMethod::Topological),
            (Model::Absorption, SortMethod::Auto),
        ] {
            let options = RenderOptions { model, sort, ..RenderOptions::default() };
            for is_of_points in [true, false] {
                let mut session =
                    Session::new(&if is_of_points { steps[0].of_points() } else { steps[0].of_cells() }).unwrap();
                for azimuth in [20.0, 130.0] {
                    for (step, held) in steps.iter().enumerate() {
                        let what = format!("{model} {sort} points {is_of_points} {azimuth} step {step}");
                        let mut scalars =
                            if is_of_points { held.point_values.clone() } else { held.cell_values.clone() };
                        if step == 2 {
                            // Cells without a value are left out while they have none.
                            scalars.iter_mut().step_by(50).for_each(|value| *value = f32::NAN);
                        }
                        let association = if is_of_points { Association::Point } else { Association::Cell };
                        session.update_scalars(association, Scalars::F32(&scalars)).unwrap();
                        let camera = camera(&session, azimuth);
                        let found = session.render(&camera, &transfer, &options).unwrap();
                        let expected = Session::new(&held.mesh().with_scalars(association, Scalars::F32(&scalars)))
                            .unwrap()
                            .render(&camera, &transfer, &options)
                            .unwrap();
                        assert_eq!(bits(&found.image), bits(&expected.image), "{what}");
                        assert_eq!(
                            (&found.cells, found.order.exactness),
                            (&expected.cells, expected.order.exactness),
                            "{what}"
                        );
                        assert_eq!(found.cells.invalid > 0, step == 2, "{what}");
                        // The first picture from a place sorts, and no other.
                        for stage in ["sort", "footprints", "topological"] {
                            assert_eq!(
                                found.profile.get(stage).is_some(),
                                step == 0 && expected.profile.get(stage).is_some(),
                                "{what}: {stage}"
                            );
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn the_first_change_of_scalars_sorts_again_only_where_cells_were_left_out() {
    let mesh = grid(6000, Scheme::Six, 0.2);
    let steps: Vec<Held> = (0..3).map(|step| Held::new(&mesh, step as f32)).collect();
    for (transfer, expected) in [(smooth(), [true, false, false]), (half_clear(), [true, true, false])] {
        let mut session = Session::new(&steps[0].of_points()).unwrap();
        let camera = camera(&session, 20.0);
        for (step, held) in steps.iter().enumerate() {
            if step > 0 {
                session.update_scalars(Association::Point, Scalars::F32(&held.point_values)).unwrap();
            }
            let rendered = session.render(&camera, &transfer, &RenderOptions::default()).unwrap();
            assert_eq!(rendered.profile.get("sort").is_some(), expected[step], "step {step}");
        }
    }
}

#[test]
fn moved_points_and_another_mesh_give_the_picture_of_a_new_session() {
    let held = Held::new(&grid(5000, Scheme::Six, 0.2), 0.0);
    let (grid_points, dims) = (held.points.len(), [4, 5, 6]);
    let options = RenderOptions::default();
    let mut session = Session::new(&held.of_cells()).unwrap();
    draw(&mut session, 70.0, &options);
    for (step, squeeze) in [0.1_f32, 0.5, 0.0, 0.3].into_iter().enumerate() {
        let move_to =
            |p: &[f32; 3]| [p[0] + squeeze * p[1], p[1], if squeeze == 0.0 && p[2] < 0.3 { 0.0 } else { p[2] }];
        let points: Vec<[f32; 3]> = held.points.iter().map(move_to).collect();
        session.update_positions(Positions::F32(&points)).unwrap();
        if step == 3 {
            // Cells that had lost their volume have it again.
            session.update_scalars(Association::Cell, Scalars::F32(&held.cell_values)).unwrap();
        }
        let mesh = MeshView { positions: Positions::F32(&points), ..held.of_cells() };
        let expected = draw(&mut Session::new(&mesh).unwrap(), 70.0, &options);
        assert_eq!(session.counts().degenerate > 0, squeeze == 0.0);
        assert_eq!(bits(&draw(&mut session, 70.0, &options).image), bits(&expected.image), "step {step}");
    }
    let bad = vec![[0.0; 3]; grid_points - 1];
    assert!(matches!(session.update_positions(Positions::F32(&bad)), Err(Error::LengthMismatch { .. })));

    let points: Vec<[f32; 3]> = (0..120).map(|i| [i % 4, i / 4 % 5, i / 20].map(|c| c as f32)).collect();
    let other = MeshView::new(Positions::F32(&points), Cells::Structured { dims });
    session.update_topology(&other).unwrap();
    let expected = draw(&mut Session::new(&other).unwrap(), 70.0, &options);
    assert_eq!(bits(&draw(&mut session, 70.0, &options).image), bits(&expected.image));
}

#[test]
fn a_cancelled_picture_is_an_error_and_the_next_is_whole() {
    let held = Held::new(&grid(60_000, Scheme::Six, 0.2), 0.0);
    let mut session = Session::on(Threads::Count(2), &held.of_points()).unwrap();
    let expected = bits(&draw(&mut session, 20.0, &RenderOptions::default()).image);
    let token = session.cancel_token();
    let stop_at = Arc::new(Mutex::new(0.0));
    let told = Arc::new(AtomicU32::new(0));
    let (at, times) = (Arc::clone(&stop_at), Arc::clone(&told));
    session.on_progress(Box::new(move |share| {
        times.fetch_add(1, Ordering::Relaxed);
        if share >= *at.lock().unwrap() {
            token.cancel();
        }
    }));
    for sort in [SortMethod::Auto, SortMethod::Topological] {
        for memory_bytes in [None, Some(1 << 30)] {
            if sort == SortMethod::Topological && memory_bytes.is_some() {
                continue;
            }
            let options = RenderOptions { sort, memory_bytes, ..RenderOptions::default() };
            for (step, share) in [0.0, 0.1, 0.5, 0.9].into_iter().enumerate() {
                *stop_at.lock().unwrap() = share;
                let camera = camera(&session, 20.0 + step as f64);
                let cancelled = session.render(&camera, &smooth(), &options);
                assert!(matches!(cancelled, Err(Error::Cancelled)), "{sort} {share}");
            }
            *stop_at.lock().unwrap() = 2.0;
            told.store(0, Ordering::Relaxed);
            let again = draw(&mut session, 20.0, &options);
            assert_eq!(again.image.pixels.len(), expected.len());
            if sort == SortMethod::Auto {
                assert_eq!(bits(&again.image), expected);
            }
            assert!(told.load(Ordering::Relaxed) > 3);
        }
    }
    // Set between pictures, it ends the next.
    session.cancel_token().cancel();
    let camera = camera(&session, 20.0);
    assert!(matches!(session.render(&camera, &smooth(), &RenderOptions::default()), Err(Error::Cancelled)));
    assert_eq!(bits(&draw(&mut session, 20.0, &RenderOptions::default()).image), expected);
}

#[test]
fn two_sessions_draw_side_by_side_each_on_its_threads() {
    fn is_send<T: Send>(_: &T) {}
    let held = [Held::new(&grid(6000, Scheme::Six, 0.2), 0.0), Held::new(&random_delaunay(5000), 1.0)];
    let expected: Vec<_> = held
        .iter()
        .map(|held| bits(&draw(&mut Session::new(&held.of_points()).unwrap(), 20.0, &RenderOptions::default()).image))
        .collect();
    let pool = Arc::new(rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap());
    std::thread::scope(|scope| {
        for ((held, expected), threads) in held.iter().zip(&expected).zip([Threads::Count(2), Threads::Pool(pool)]) {
            scope.spawn(move || {
                let mut session = Session::on(threads, &held.of_points()).unwrap();
                is_send(&session);
                for step in 0..6 {
                    let scalars = if step % 2 == 0 {
                        &held.point_values
                    } else {
                        &held.points.as_flattened()[..held.points.len()].to_vec()
                    };
                    session.update_scalars(Association::Point, Scalars::F32(scalars)).unwrap();
                    let image = draw(&mut session, 20.0, &RenderOptions::default()).image;
                    assert_eq!(bits(&image) == *expected, step % 2 == 0, "step {step}");
                }
            });
        }
    });
}

#[test]
fn a_memory_budget_is_kept_and_gives_the_same_picture() {
    let held = Held::new(&grid(30_000, Scheme::Six, 0.2), 0.0);
    let mut session = Session::new(&held.of_points()).unwrap();
    let expected = bits(&draw(&mut session, 20.0, &RenderOptions::default()).image);
    let with = |memory_bytes| RenderOptions { memory_bytes: Some(memory_bytes), ..RenderOptions::default() };
    let camera = camera(&session, 20.0);
    let Err(Error::Memory { needed_bytes, .. }) = session.render(&camera, &smooth(), &with(1000)) else {
        panic!("a thousand bytes are too few")
    };
    let Err(Error::Memory { needed_bytes, .. }) = session.render(&camera, &smooth(), &with(needed_bytes)) else {
        panic!("what a frame takes before its cells are counted does not do")
    };
    assert_eq!(bits(&session.render(&camera, &smooth(), &with(needed_bytes)).unwrap().image), expected);
    // The caller's arrays are not the session's.
    assert!(session.owned_bytes() < (held.corners.len() * 4) as u64, "{}", session.owned_bytes());
}

#[test]
fn bad_meshes_are_errors_that_name_the_place() {
    let held = Held::new(&grid(100, Scheme::Six, 0.0), 0.0);
    let error = |mesh: &MeshView| Session::new(mesh).err().expect("an error").to_string();
    let positions = Positions::F32(&held.points);
    let mut corners: Vec<i64> = held.corners.iter().map(|&v| v.into()).collect();
    let of_kind = |points| Cells::OfKind { kind: &TETRAHEDRON, points };
    corners[9] = -3;
    let narrow: Vec<u32> = corners.iter().map(|&v| v as u32).collect();
    assert!(error(&MeshView::new(positions, of_kind(Indices::I64(&corners)))).contains("cell 2 refers to point -3"));
    assert!(
        error(&MeshView::new(positions, of_kind(Indices::U32(&narrow)))).contains("cell 2 refers to point 4294967293")
    );
    assert!(error(&MeshView::new(positions, of_kind(Indices::U32(&held.corners[1..])))).contains("connectivity of 4"));
    assert!(error(&MeshView::new(positions, of_kind(Indices::U32(&[])))).contains("no cell with a volume"));
    let few = Positions::F32(&held.points[..3]);
    assert!(error(&MeshView::new(few, of_kind(Indices::U32(&held.corners)))).contains("only 3 points"));
    let mut points = held.points.clone();
    points[held.corners[5] as usize][1] = f32::NAN;
    assert!(error(&MeshView { positions: Positions::F32(&points), ..held.mesh() }).contains("not finite"));
    let axis = vec![0.0_f32; held.points.len()];
    let axes = Positions::AxesF32([&axis, &axis[1..], &axis]);
    assert!(error(&MeshView { positions: axes, ..held.mesh() }).contains("y coordinates"));
    for dims in [[0, 5, 5], [1, 5, 5], [2, 2, 2], [usize::MAX, usize::MAX, 2]] {
        let mesh = MeshView::new(positions, Cells::Structured { dims });
        assert!(!error(&mesh).is_empty());
    }
    let scalars = |association, values| error(&held.mesh().with_scalars(association, Scalars::F32(values)));
    assert!(scalars(Association::Point, &held.point_values[1..]).contains("scalars"));
    assert!(scalars(Association::Cell, &held.point_values).contains("scalars"));
    assert!(scalars(Association::Point, &vec![f32::NAN; held.points.len()]).contains("no finite value"));
    let (types, offsets) = ([10_u8, 10], [0_i64, 4, -1]);
    let mixed = Cells::Mixed { types: &types, offsets: Indices::I64(&offsets), points: Indices::U32(&held.corners) };
    assert!(error(&MeshView::new(positions, mixed)).contains("cell 1"));
    let mixed =
        Cells::Mixed { types: &types, offsets: Indices::I64(&offsets[..2]), points: Indices::U32(&held.corners) };
    assert!(error(&MeshView::new(positions, mixed)).contains("offsets"));
}

#[test]
fn all_views_and_models_agree_with_the_file() {
    let mesh = random_delaunay(4000);
    let held = Held::new(&mesh, 0.0);
    let mut session = Session::new(&held.of_points()).unwrap();
    let array = cellfan::columns::Array {
        name: "value".to_owned(),
        association: Association::Point,
        components: 1,
        values: held.point_values.clone().into(),
    };
    let mesh = cellfan::TetMesh { arrays: vec![array], points: Points::F32(held.points.clone()), ..mesh };
    let case = crate::check::Case::new(mesh, "value");
    for (view, camera) in three_views(64, 48) {
        for model in Model::ALL {
            for cpu_method in [cellfan::CpuMethod::Footprints, cellfan::CpuMethod::Fans] {
                let options = RenderOptions { model, cpu_method, ..RenderOptions::default() };
                let found = session.render(&camera, &smooth(), &options).unwrap().image;
                let expected = case.render(options, &smooth(), &camera).image;
                let miss = if model == Model::Absorption { [1.0; 4] } else { [0.0; 4] };
                let difference = found.difference(&expected, miss).unwrap();
                assert!(difference.covered > 500 && difference.max < 1e-4, "{view} {model}: {difference:?}");
            }
        }
    }
}
