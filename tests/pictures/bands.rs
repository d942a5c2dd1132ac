//! Wavelength bands: closed forms, the reference in f64 band by band, sums of thousands of segments.

use cellfan::columns::{Array, Association, NumericColumn};
use cellfan::generate::Scheme;
use cellfan::image::BandImage;
use cellfan::optics::{BandPoint, BandTable, Output};
use cellfan::{
    Camera, CpuMethod, Dataset, Field, Integral, Model, Projection, RenderOptions, Rendered, Renderer, Scene,
    TransferFunction,
};
use glam::DVec3;

use crate::band_arrays::with_arrays;
use crate::check::{Case, Rays};
use crate::meshes::{Random, frame_unit_cube, grid, mesh, moved, point, random_delaunay, smooth, three_views};
use crate::reference::{Segment, depth, shade};

pub(crate) const DEPTH: RenderOptions = RenderOptions {
    model: Model::Absorption,
    output: Output::Depth,
    integral: Integral::Exact,
    sort: cellfan::SortMethod::Auto,
    stop_transmittance: 1e-5,
    cpu_method: CpuMethod::Footprints,
    faces: cellfan::stages::fans::Faces::Exact,
    check_order: false,
    memory_bytes: None,
    instruction_set: None,
    geometry: cellfan::geometry::GeometryOptions::NONE,
    depth: false,
};

/// Six bands over 0 to 1: rising, falling to 0, constant, with steps, a peak, nearly nothing.
pub(crate) fn six_bands() -> BandTable {
    let at = |value, extinctions: [f64; 6]| BandPoint { value, extinctions: extinctions.to_vec() };
    let points = vec![
        at(0.0, [0.5, 4.0, 2.0, 0.3, 0.0, 1e-6]),
        at(0.3, [1.0, 3.0, 2.0, 0.3, 0.0, 1e-6]),
        at(0.3, [1.0, 3.0, 2.0, 5.0, 0.0, 1e-6]),
        at(0.45, [1.5, 2.0, 2.0, 5.0, 40.0, 2e-6]),
        at(0.6, [2.5, 1.0, 2.0, 0.0, 0.0, 1e-6]),
        at(1.0, [9.0, 0.0, 2.0, 7.0, 0.0, 1e-6]),
    ];
    BandTable::new(["a", "b", "c", "d", "e", "f"].map(String::from).to_vec(), points).unwrap()
}

/// One band as a transfer function of one colour.
pub(crate) fn of_band(table: &BandTable, band: usize, color: impl Fn(f64) -> f64) -> TransferFunction {
    let of_point = |p: &BandPoint| point(p.value, [color(p.value); 3], p.extinctions[band]);
    TransferFunction::new(table.points().iter().map(of_point).collect()).unwrap()
}

pub(crate) fn dark() -> TransferFunction {
    TransferFunction::constant([1.0; 3], 0.0).unwrap()
}

pub(crate) fn draw(options: RenderOptions, scene: &Scene, camera: &Camera) -> BandImage {
    Renderer::new(options).render(scene, camera).unwrap().bands.unwrap()
}

/// Along the x axis, all of a bar's cross-section and some more.
fn along_x(height_world: f64, size: u32, eye: f64) -> Camera {
    let mut camera = Camera::looking_at(DVec3::new(eye, 0.5, 0.5), DVec3::splat(0.5), size, size);
    camera.projection = Projection::Orthographic { height_world };
    camera
}

/// Along a bar, no ray through the edges that all boxes have in one line: there a cell is as thick as the rounding of a depth.
pub(crate) fn beside_the_diagonal() -> Camera {
    let mut camera = along_x(0.8, 24, 3.0);
    let aside = DVec3::new(0.0, 0.017, 0.0);
    (camera.eye, camera.target) = (camera.eye + aside, camera.target + aside);
    camera
}

/// Boxes of six tetrahedra in a row along x, from 0 to 1, inner points moved; the scalar is x.
pub(crate) fn bar(boxes: u32) -> cellfan::TetMesh {
    let corners = |i: u32| (0..4).map(move |k| DVec3::new(f64::from(i), f64::from(k & 1), f64::from(k >> 1)));
    let points: Vec<[f64; 3]> = (0..=boxes).flat_map(corners).map(|p| p.to_array()).collect();
    // Kuhn's cut: along the axes in every order.
    let of_box = |i: u32| {
        let orders = [[4, 1, 2], [4, 2, 1], [1, 4, 2], [1, 2, 4], [2, 1, 4], [2, 4, 1]];
        orders.map(|[a, b, c]| [0, a, a + b, a + b + c].map(|corner| 4 * i + corner))
    };
    let last = f64::from(boxes);
    let bar = moved(mesh(points, (0..boxes).flat_map(of_box).collect(), vec![]), |p| {
        let is_inner = p.x > 0.0 && p.x < last;
        let seed = (p.x * 4.0 + p.y * 2.0 + p.z) as u64;
        let jitter = if is_inner { (f64::from(Random(seed).below(1000)) / 1000.0 - 0.5) * 0.4 } else { 0.0 };
        DVec3::new((p.x + jitter) / last, p.y, p.z)
    });
    let values: Vec<f64> = (0..bar.points.len()).map(|i| bar.points.get(i).x).collect();
    let arrays = vec![Array {
        name: "value".to_owned(),
        association: Association::Point,
        components: 1,
        values: NumericColumn::from(values),
    }];
    cellfan::TetMesh { arrays, ..bar }
}

/// ∫₀¹ κ of each band over s = x.
pub(crate) fn depths_of_bar(table: &BandTable) -> Vec<f64> {
    let trapezoid = |two: &[BandPoint], k: usize| {
        0.5 * (two[1].value - two[0].value) * (two[0].extinctions[k] + two[1].extinctions[k])
    };
    (0..table.names().len()).map(|k| table.points().windows(2).map(|two| trapezoid(two, k)).sum()).collect()
}

#[test]
fn a_slab_of_known_thickness() {
    let extinctions = vec![0.01, 0.3, 1.0, 2.5, 7.0, 12.0];
    let dataset = Dataset::from_tets(grid(50_000, Scheme::Six, 0.2)).unwrap();
    let field = dataset.homogeneous_field();
    let scene = Scene::new(dataset, field, &dark()).with_bands(BandTable::constant(extinctions.clone()).unwrap());
    let camera = along_x(0.9, 40, 3.0);
    for cpu_method in [CpuMethod::Footprints, CpuMethod::Rays, CpuMethod::Fans] {
        let options = RenderOptions { cpu_method, ..DEPTH };
        let depths = draw(options, &scene, &camera);
        let intensities = draw(RenderOptions { output: Output::Intensity, ..options }, &scene, &camera);
        assert_eq!(depths.names, ["band1", "band2", "band3", "band4", "band5", "band6"]);
        let mut worst = [0.0_f64; 2];
        for (x, y) in (0..40).flat_map(|y| (0..40).map(move |x| (x, y))) {
            for (k, extinction) in extinctions.iter().enumerate() {
                let depth = f64::from(depths.pixel(x, y)[k]);
                let intensity = f64::from(intensities.pixel(x, y)[k]);
                worst[0] = worst[0].max((depth / extinction - 1.0).abs());
                worst[1] = worst[1].max((intensity - (-extinction).exp()).abs());
            }
        }
        println!("{cpu_method:?}: depth {:.1e} relative, intensity {:.1e}", worst[0], worst[1]);
        // Fans interpolate between projected vertices, whose rounding does not cancel between neighbours.
        let allowed = if cpu_method == CpuMethod::Fans { 1e-5 } else { 1e-6 };
        assert!(worst.iter().all(|&worst| worst < allowed), "{worst:?}");
    }
}

/// A ray through more than 10^4 segments: what plain f32 makes of them is shown beside.
#[test]
fn thousands_of_segments_add_up_to_a_millionth() {
    let mut table = six_bands();
    let case = Case::new(bar(4000), "value");
    let camera = beside_the_diagonal();
    for name in ["varying", "constant"] {
        let expected = match name {
            "varying" => depths_of_bar(&table),
            _ => vec![0.01, 0.3, 1.0, 2.5, 7.0, 12.0],
        };
        if name == "constant" {
            table = BandTable::constant(expected.clone()).unwrap();
        }
        let scene = case.scene(&dark()).with_bands(table.clone());
        for cpu_method in [CpuMethod::Footprints, CpuMethod::Rays, CpuMethod::Fans] {
            let picture = draw(RenderOptions { cpu_method, ..DEPTH }, &scene, &camera);
            let mut worst = vec![0.0_f64; 6];
            for bands in picture.values.chunks_exact(6) {
                for k in 0..6 {
                    worst[k] = worst[k].max((f64::from(bands[k]) / expected[k] - 1.0).abs());
                }
            }
            println!("{name} {cpu_method:?}: {worst:?}");
            let allowed = if cpu_method == CpuMethod::Footprints { 1e-6 } else { 1e-5 };
            assert!(worst.iter().all(|&worst| worst < allowed), "{name} {cpu_method:?}: {worst:?}");
        }
    }
    // The control: the same segments, one after the other in f32.
    let segments = case.reference.segments(&camera, 7, 11);
    assert!(segments.len() > 10_000, "{}", segments.len());
    let plain = |k: usize| {
        let constant = table.points()[0].extinctions[k];
        segments.iter().fold(0.0_f32, |sum, segment| sum + (segment.length_world * constant) as f32)
    };
    let off: Vec<f64> = (0..6).map(|k| (f64::from(plain(k)) / table.points()[0].extinctions[k] - 1.0).abs()).collect();
    println!("plain f32 over {} segments: {off:?}", segments.len());
    assert!(off.iter().any(|&off| off > 1e-6), "{off:?}");
}

/// The largest difference of optical depths from the reference's, relative and beyond 1e-6, over all rays.
pub(crate) fn worst_depth(rays: &Rays, picture: &BandImage, band: usize, expected: impl Fn(&[Segment]) -> f64) -> f64 {
    let pairs = rays.pixels.iter().zip(&rays.segments);
    let off = pairs.map(|(&(x, y), segments)| {
        let (found, expected) = (f64::from(picture.pixel(x, y)[band]), expected(segments));
        (found - expected).abs() / expected.max(0.01)
    });
    off.map(|off| if off.is_nan() { f64::INFINITY } else { off }).fold(0.0, f64::max)
}

#[test]
fn bands_of_a_table_are_those_of_the_reference() {
    let table = six_bands();
    for array in ["value", "cell_value"] {
        let case = Case::new(random_delaunay(10_000), array);
        let scene = case.scene(&dark()).with_bands(table.clone());
        for (view, camera) in three_views(100, 80) {
            let rays = case.random_rays(&camera, 3, 300);
            let picture = draw(DEPTH, &scene, &camera);
            for band in 0..6 {
                let transfer = of_band(&table, band, |_| 1.0);
                let worst = worst_depth(&rays, &picture, band, |segments| depth(&transfer, segments));
                println!("{array:10} {view:9} band {band}: {worst:.1e}");
                assert!(worst < 2e-3, "{array} {view} band {band}: {worst}");
                // The comparison fails on another band.
                let other = worst_depth(&rays, &picture, (band + 1) % 6, |segments| depth(&transfer, segments));
                assert!(other > 0.1, "band {band} passes as the next");
            }
        }
    }
}

/// Three bands of their own for red, green and blue.
pub(crate) fn three_bands() -> BandTable {
    let at = |value, extinctions: [f64; 3]| BandPoint { value, extinctions: extinctions.to_vec() };
    let points =
        vec![at(0.0, [0.5, 4.0, 0.0]), at(0.3, [1.0, 3.0, 0.0]), at(0.3, [6.0, 3.0, 0.0]), at(1.0, [9.0, 0.2, 8.0])];
    BandTable::new(["r", "g", "b"].map(String::from).to_vec(), points).unwrap()
}

/// The transfer function with the extinction of a band, at the control points of both.
fn with_band(transfer: &TransferFunction, table: &BandTable, band: usize) -> TransferFunction {
    let mut values: Vec<f64> = transfer.points().iter().map(|p| p.value).collect();
    values.extend(table.points().iter().map(|p| p.value));
    values.sort_by(f64::total_cmp);
    values.dedup();
    let at = |value: f64, seen_at: f64| point(value, transfer.eval(seen_at).color, table.eval(seen_at)[band]);
    // A step is between the last number below it and it.
    let both = values.iter().flat_map(|&value| [at(value, value.next_down()), at(value, value)]);
    TransferFunction::new(both.collect()).unwrap()
}

#[test]
fn each_channel_glows_and_is_dimmed_by_its_own_band() {
    let (transfer, table) = (smooth(), three_bands());
    let channels = [0, 1, 2].map(|band| with_band(&transfer, &table, band));
    for array in ["value", "cell_value"] {
        let case = Case::new(random_delaunay(10_000), array);
        let scene = case.scene(&transfer).with_bands(table.clone());
        for (view, camera) in three_views(100, 80) {
            let rays = case.random_rays(&camera, 3, 300);
            let options = RenderOptions::default();
            let rendered = Renderer::new(options).render(&scene, &camera).unwrap();
            assert!(rendered.bands.is_none());
            assert_eq!(rendered.order.kind, "exact");
            let mut worst = [0.0_f64; 4];
            let mut swapped = 0.0_f64;
            for (&(x, y), segments) in rays.pixels.iter().zip(&rays.segments) {
                let found = rendered.image.pixel(x, y).map(f64::from);
                let of = [0, 1, 2].map(|k| shade(Model::EmissionAbsorption, &channels[k], segments));
                let expected = [of[0][0], of[1][1], of[2][2], (of[0][3] + of[1][3] + of[2][3]) / 3.0];
                for k in 0..4 {
                    worst[k] = worst[k].max((found[k] - expected[k]).abs());
                }
                swapped = swapped.max((found[0] - of[1][0]).abs());
            }
            println!("{array:10} {view:9} {worst:?}, with another channel's band {swapped:.1e}");
            assert!(worst.iter().all(|&worst| worst < 2e-3) && swapped > 0.05, "{array} {view}: {worst:?}");
        }
    }
}

/// The largest difference of the light of each band from the reference's: of the channel that the band has, or, beyond blue, of
/// a white one, whose light is its opacity.
fn worst_lights(rays: &[Rays], channels: &[TransferFunction], rendered: &Rendered) -> Vec<f64> {
    let layers = rendered.bands.as_ref().unwrap();
    let mut worst = vec![0.0_f64; channels.len() + 1];
    let pixels = rays[0].pixels.iter().enumerate();
    for (ray, &(x, y)) in pixels {
        let mut opacity = 0.0;
        for (band, channel) in channels.iter().enumerate() {
            let light = shade(Model::EmissionAbsorption, channel, &rays[band].segments[ray]);
            let found = f64::from(layers.pixel(x, y)[band]);
            worst[band] = worst[band].max((found - light[band.min(3)]).abs());
            if band < 3 {
                assert_eq!(layers.pixel(x, y)[band].to_bits(), rendered.image.pixel(x, y)[band].to_bits());
                opacity += light[3] / 3.0;
            }
        }
        worst[channels.len()] = worst[channels.len()].max((f64::from(rendered.image.pixel(x, y)[3]) - opacity).abs());
    }
    worst
}

#[test]
fn more_than_three_bands_glow_in_layers() {
    let (transfer, table) = (smooth(), six_bands());
    let channels: Vec<_> = (0..6).map(|band| with_band(&transfer, &table, band)).collect();
    let case = Case::new(random_delaunay(10_000), "value");
    let scene = case.scene(&transfer).with_bands(table);
    for (view, camera) in three_views(100, 80) {
        let rendered = Renderer::new(RenderOptions::default()).render(&scene, &camera).unwrap();
        assert_eq!(rendered.bands.as_ref().unwrap().names, ["a", "b", "c", "d", "e", "f"]);
        let rays: Vec<_> = (0..6).map(|_| case.random_rays(&camera, 3, 300)).collect();
        let worst = worst_lights(&rays, &channels, &rendered);
        let mut turned = channels.clone();
        turned.rotate_left(1);
        let swapped = worst_lights(&rays, &turned, &rendered);
        println!("{view:9} {worst:?}, with the next band's extinction {swapped:?}");
        assert!(worst.iter().all(|&worst| worst < 2e-3), "{view}: {worst:?}");
        assert!(swapped[..6].iter().all(|&swapped| swapped > 0.05), "{view}: {swapped:?}");
    }
}

/// Each array is drawn as a field of its own, in the colours that the transfer function gives its values.
#[test]
fn arrays_glow_and_dim() {
    let (dataset, fields) = with_arrays();
    let of_value = |value: f64| BandPoint { value, extinctions: vec![value] };
    let identity = BandTable::new(vec!["value".to_owned()], vec![of_value(0.0), of_value(2000.0)]).unwrap();
    let white = TransferFunction::constant([1.0; 3], 0.0).unwrap();
    for transfer in [smooth(), white] {
        let scene = Scene::new(dataset.clone(), fields[1].clone(), &transfer);
        let scene = scene.with_band_arrays(fields.clone()).unwrap();
        let channels = vec![with_band(&transfer, &identity, 0); 5];
        for (view, camera) in three_views(100, 80) {
            let rendered = Renderer::new(RenderOptions::default()).render(&scene, &camera).unwrap();
            let of_field = |field: &Field| Case::of(dataset.clone(), field.clone()).random_rays(&camera, 3, 100);
            let mut rays: Vec<_> = fields.iter().map(of_field).collect();
            let worst = worst_lights(&rays, &channels, &rendered);
            rays.rotate_left(1);
            let swapped = worst_lights(&rays, &channels, &rendered);
            println!("{view:9} {worst:?}, with the next array {swapped:?}");
            assert!(worst.iter().all(|&worst| worst < 2e-3), "{view}: {worst:?}");
            assert!(swapped[..5].iter().all(|&swapped| swapped > 0.05), "{view}: {swapped:?}");

            // Three arrays are the picture's channels and nothing else; no budget changes them.
            let three = Scene::new(dataset.clone(), fields[0].clone(), &transfer);
            let three = three.with_band_arrays(fields[..3].to_vec()).unwrap();
            let alone = Renderer::new(RenderOptions::default()).render(&three, &camera).unwrap();
            assert!(alone.bands.is_none() && alone.image.pixels == rendered.image.pixels, "{view}");
            let (needed, _) =
                too_small(&three, &camera, RenderOptions { memory_bytes: Some(1), ..RenderOptions::default() });
            let budget = RenderOptions { memory_bytes: Some(needed + (8 << 20)), ..RenderOptions::default() };
            assert!(Renderer::new(budget).render(&three, &camera).unwrap().image.pixels == alone.image.pixels);
        }
    }
}

#[test]
fn equal_bands_are_the_picture_without_bands() {
    let transfer = smooth();
    let points = transfer.points().iter();
    let points = points.map(|p| BandPoint { value: p.value, extinctions: vec![p.extinction; 3] }).collect();
    let table = BandTable::new(["r", "g", "b"].map(String::from).to_vec(), points).unwrap();
    let case = Case::new(random_delaunay(10_000), "value");
    for (view, camera) in three_views(100, 80) {
        for stop_transmittance in [1e-5, 0.0, 0.1] {
            let options = RenderOptions { stop_transmittance, ..RenderOptions::default() };
            let plain = Renderer::new(options).render(&case.scene(&transfer), &camera).unwrap().image;
            let scene = case.scene(&transfer).with_bands(table.clone());
            let banded = Renderer::new(options).render(&scene, &camera).unwrap().image;
            let difference = plain.difference(&banded, [0.0; 4]).unwrap();
            assert!(difference.covered > 1000 && difference.max < 2e-6, "{view} {stop_transmittance}: {difference:?}");
        }
    }
}

/// A ray goes on where one band is opaque and another is not.
#[test]
fn an_opaque_band_does_not_end_the_others() {
    let case = Case::new(grid(20_000, Scheme::Six, 0.0), "value");
    let white = TransferFunction::constant([1.0; 3], 0.0).unwrap();
    let table = BandTable::constant(vec![1000.0, 0.5, 0.0]).unwrap();
    let scene = case.scene(&white).with_bands(table);
    let image = Renderer::new(RenderOptions::default()).render(&scene, &along_x(0.9, 20, 3.0)).unwrap().image;
    for pixel in &image.pixels {
        let half = 1.0 - (-0.5_f32).exp();
        let expected = [1.0, half, 0.0, (1.0 + half) / 3.0];
        assert!(pixel.iter().zip(expected).all(|(a, b)| (a - b).abs() < 2e-6), "{pixel:?} for {expected:?}");
    }
}

#[test]
fn what_a_model_cannot_do_with_bands_is_refused() {
    let case = Case::new(grid(1000, Scheme::Six, 0.0), "value");
    let camera = frame_unit_cube(30.0, 20.0, 16, 16);
    let error =
        |options: RenderOptions, scene: &Scene| Renderer::new(options).render(scene, &camera).unwrap_err().to_string();
    let two = case.scene(&smooth()).with_bands(BandTable::constant(vec![1.0, 2.0]).unwrap());
    let three = case.scene(&smooth()).with_bands(three_bands());
    let plain = RenderOptions::default();
    assert!(error(plain, &two).contains("takes 3 bands or more"));
    assert!(error(RenderOptions { integral: Integral::Average, ..plain }, &three).contains("--integral average"));
    assert!(error(RenderOptions { model: Model::Mip, ..plain }, &three).contains("has no bands"));
    assert!(error(RenderOptions { model: Model::Emission, ..plain }, &two).contains("takes 3 bands"));
    for model in [Model::Mip, Model::Emission] {
        assert!(error(RenderOptions { model, ..DEPTH }, &case.scene(&smooth())).contains("--output"));
    }
    let arrays = case.scene(&smooth()).with_band_arrays(vec![case.dataset.homogeneous_field()]).unwrap();
    assert!(error(plain, &arrays).contains("there are 1"));
}

#[test]
fn threads_budgets_and_methods_give_the_same_bands() {
    let case = Case::new(random_delaunay(20_000), "value");
    let scene = case.scene(&smooth()).with_bands(six_bands());
    let camera = frame_unit_cube(37.0, 22.0, 200, 150);
    let on = |threads: usize, options: RenderOptions| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| Renderer::new(options).render(&scene, &camera).unwrap())
    };
    let one = on(1, DEPTH);
    let bytes = one.bands.as_ref().unwrap();
    assert!(bytes.covered(0.0) > 1000);
    assert!(bytes == on(4, DEPTH).bands.as_ref().unwrap());
    let budget = |memory_bytes| RenderOptions { memory_bytes: Some(memory_bytes), ..DEPTH };
    let error = too_small(&scene, &camera, budget(1 << 20));
    let (given, needed) = (1 << 20, error.0);
    assert_eq!(error.1, given, "the budget in the message is the one that was given");
    assert!(needed > given + 200 * 150 * 24);
    assert!(bytes == on(2, budget(needed + (8 << 20))).bands.as_ref().unwrap());

    let fans = on(2, RenderOptions { cpu_method: CpuMethod::Fans, ..DEPTH });
    let far = bytes.values.iter().zip(&fans.bands.unwrap().values).map(|(a, b)| (a - b).abs() / (0.1 + a)).sum::<f32>();
    assert!(far / (bytes.values.len() as f32) < 1e-5, "{far}");
    // The first four bands are the picture's channels.
    let pixel = one.image.pixel(100, 75);
    assert_eq!(pixel[..], bytes.pixel(100, 75)[..4]);
}

/// Bytes needed and given in the message of a budget that is too small.
pub(crate) fn too_small(scene: &Scene, camera: &Camera, options: RenderOptions) -> (u64, u64) {
    match Renderer::new(options).render(scene, camera).unwrap_err() {
        cellfan::Error::Memory { budget_bytes, needed_bytes, .. } => (needed_bytes, budget_bytes),
        other => panic!("{other}"),
    }
}
