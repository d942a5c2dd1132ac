//! Opaque geometry in the volume: against its slow twin and the reference cut at its depth, closed forms, and the fans of the processor.

use cellfan::generate::Scheme;
use cellfan::geometry::{GeometryOptions, SurfaceFaces, headlight};
use cellfan::optics::{BandPoint, BandTable, Output};
use cellfan::{
    Camera, CpuMethod, Dataset, Error, Image, Model, Projection, Region, RenderOptions, Renderer, Scene, SortMethod,
    TransferFunction,
};
use glam::DVec3;

use crate::budget::assert_same_at_any_budget;
use crate::check::Case;
use crate::hexahedra::{case, jittered, mixed, twisted_shell};
use crate::meshes::{frame_unit_cube, grid, mesh, smooth, stepped, three_views};
use crate::opaque::{Eye, Met, Primitives, edges_and_points, sides_of_unit_cube};
use crate::parity::{Parity, miss};
use crate::reference::{depth, shade};

/// Colours that nothing else has.
pub(crate) const COLOR: [f32; 3] = [0.25, 0.5, 0.75];

pub(crate) fn with(geometry: GeometryOptions) -> RenderOptions {
    RenderOptions { geometry, ..RenderOptions::default() }
}

fn strokes() -> GeometryOptions {
    GeometryOptions { edges: Some(COLOR), points: Some(COLOR), line_px: 1.5, point_px: 4.0, ..Default::default() }
}

fn walls(surface_faces: SurfaceFaces) -> GeometryOptions {
    GeometryOptions { surface: Some(COLOR), surface_faces, ..GeometryOptions::default() }
}

/// The pixel of a ray that ends on geometry of this colour, or goes on.
fn behind(model: Model, [r, g, b, a]: [f64; 4], color: Option<[f64; 3]>) -> [f64; 4] {
    let Some(color) = color else { return [r, g, b, a] };
    let left = match model {
        Model::Absorption => return [0.0; 4],
        Model::EmissionAbsorption | Model::Mip => 1.0 - a,
        Model::Emission => 1.0,
    };
    [r + left * color[0], g + left * color[1], b + left * color[2], 1.0]
}

/// Compares every third pixel with the reference, cut where the geometry is; how many rays ended on it.
fn compare(what: &str, case: &Case, primitives: &Primitives, options: RenderOptions, camera: &Camera) -> usize {
    let (model, geometry, transfer) = (options.model, options.geometry, smooth());
    let image = case.render(options, &transfer, camera).image;
    let eye = Eye::new(camera, case.dataset.diagonal_world());
    let (mut ended, mut compared, mut unclear, mut sum, mut largest) = (0, 0, 0, 0.0, 0.0_f64);
    for (x, y) in (0..camera.height).flat_map(|y| (0..camera.width).map(move |x| (x, y))).step_by(3) {
        let px = [geometry.line_px, geometry.point_px].map(f64::from);
        let has_back_only = geometry.surface_faces == SurfaceFaces::Back;
        let met = primitives.meet(&eye, [x, y], px, has_back_only);
        let (far, color) = match met {
            Met::Unclear => {
                unclear += 1;
                continue;
            }
            Met::Nothing => (camera.far, None),
            Met::At(depth, cos) => {
                // Lines and points are not lit.
                let light = if geometry.surface.is_some() { headlight(cos as f32) } else { 1.0 };
                (Some(depth), Some(COLOR.map(|channel| f64::from(channel * light))))
            }
        };
        let segments = case.reference.segments(&Camera { far, ..camera.clone() }, x, y);
        // A cell so thin that one may miss it shows in full.
        let is_thin = segments.iter().map(|segment| segment.length_world).sum::<f64>() < 1e-4;
        if model == Model::Mip && color.is_some() && is_thin {
            unclear += 1;
            continue;
        }
        let expected = behind(model, shade(model, &transfer, &segments), color);
        let found = image.pixel(x, y).map(f64::from);
        let error = (0..4).map(|k| (found[k] - expected[k]).abs()).fold(0.0, f64::max);
        assert!(error < 5e-3, "{what}, {model}, ({x}, {y}): {found:?} for {expected:?}, {met:?}");
        compared += 1;
        ended += usize::from(color.is_some());
        (sum, largest) = (sum + error, largest.max(error));
    }
    let mean = sum / f64::from(compared);
    println!(
        "{what:24} {model:20} {compared} compared, {ended} ended, {unclear} unclear, mean {mean:.1e}, largest {largest:.1e}"
    );
    assert!((unclear * 5 < compared || model == Model::Mip) && mean < 1e-4, "{what}, {model}");
    ended
}

#[test]
fn rays_end_on_edges_and_points() {
    let case = Case::new(grid(48, Scheme::Six, 0.2), "value");
    let primitives = edges_and_points(&case.dataset);
    for (view, camera) in three_views(120, 90) {
        for model in Model::ALL {
            let ended = compare(view, &case, &primitives, RenderOptions { model, ..with(strokes()) }, &camera);
            assert!(ended > 200, "{view}: {ended}");
        }
        // The near plane cuts lines and points as it cuts cells.
        let center = (DVec3::splat(0.5) - camera.eye).dot((camera.target - camera.eye).normalize());
        let near = if view == "inside" { 0.2 } else { center };
        let sliced = Camera { near: Some(near), far: Some(near + 0.4), ..camera };
        assert!(compare("sliced", &case, &primitives, with(strokes()), &sliced) > 50);
    }
}

#[test]
fn rays_end_on_walls() {
    let case = Case::new(grid(48, Scheme::Six, 0.0), "value");
    let walls_of_cube = sides_of_unit_cube();
    for (view, camera) in three_views(120, 90) {
        for faces in SurfaceFaces::ALL {
            for model in Model::ALL {
                let options = RenderOptions { model, ..with(walls(faces)) };
                let ended = compare(&format!("{view}, {}", faces.name()), &case, &walls_of_cube, options, &camera);
                assert!(ended > 500 || model == Model::Mip, "{view}: {ended}");
            }
        }
    }
}

/// A cube of twelve tetrahedra around its centre.
fn around_the_centre() -> Dataset {
    let corner = |i: u32| [f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)];
    let points = (0..8).map(corner).chain([[0.5; 3]]).collect();
    let mut tets = Vec::new();
    for axis in 0..3 {
        for side in 0..2_u32 {
            let [u, v] = [1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3)];
            let first = side << axis;
            tets.extend([[first, first + u, first + v, 8], [first + u, first + u + v, first + v, 8]]);
        }
    }
    Dataset::from_tets(mesh(points, tets, vec![0.0; 9])).unwrap()
}

#[test]
fn a_point_of_one_pixel_is_one_pixel_and_ends_its_ray() {
    let (extinction, dataset) = (2.0, around_the_centre());
    let transfer = TransferFunction::constant([1.0; 3], extinction).unwrap();
    let field = dataset.homogeneous_field();
    let scene = Scene::new(dataset, field, &transfer);
    let options = with(GeometryOptions { points: Some(COLOR), point_px: 1.0, ..GeometryOptions::default() });
    for aside in [0.0, 0.3, -0.49] {
        // One pixel is a fortieth wide; the centre's point lies aside of a pixel's by a part of it.
        let off = DVec3::new(0.0, aside / 40.0, aside / 40.0);
        let mut camera = Camera::looking_at(DVec3::new(3.0, 0.5, 0.5) + off, DVec3::splat(0.5) + off, 61, 61);
        camera.projection = Projection::Orthographic { height_world: 61.0 / 40.0 };
        let volume = Renderer::new(RenderOptions::default()).render(&scene, &camera).unwrap().image;
        let image = Renderer::new(options).render(&scene, &camera).unwrap().image;
        let changed = |&(x, y): &(u32, u32)| image.pixel(x, y) != volume.pixel(x, y);
        let changed: Vec<_> = (0..61).flat_map(|y| (0..61).map(move |x| (x, y))).filter(changed).collect();
        // The centre, and the four corners that others hide or that hide others.
        assert_eq!(changed.len(), 5, "{changed:?}");
        assert!(changed.contains(&(30, 30)));
        // Half the cube in front of the point.
        let left = (-extinction * 0.5).exp() as f32;
        let [r, g, b, a] = image.pixel(30, 30);
        for (found, color) in [r, g, b].into_iter().zip(COLOR) {
            assert!((found - (1.0 - left + left * color)).abs() < 1e-5, "{found}");
        }
        assert_eq!(a, 1.0);
    }
}

#[test]
fn a_line_of_one_pixel_has_no_gap_wherever_it_runs() {
    let dataset = around_the_centre();
    let transfer = TransferFunction::constant([1.0; 3], 0.0).unwrap();
    let field = dataset.homogeneous_field();
    let scene = Scene::new(dataset, field, &transfer);
    let mut renderer = Renderer::new(with(GeometryOptions { edges: Some(COLOR), ..GeometryOptions::default() }));
    // The lower edge of the front side runs across the picture, level or not, between rows or on them.
    for (turn, aside) in [(0.0, 0.0), (0.0, 0.5), (0.0, 0.25), (0.3, 0.1), (0.7, 0.0), (0.78, 0.5)] {
        let mut camera = Camera::looking_at(DVec3::new(3.0, 0.5, 0.0), DVec3::new(0.0, 0.5, 0.0), 80, 80);
        camera.up = DVec3::new(0.0, f64::sin(turn), f64::cos(turn));
        camera.projection = Projection::Orthographic { height_world: 2.0 };
        let down = DVec3::new(0.0, 0.0, aside / 40.0);
        (camera.eye, camera.target) = (camera.eye + down, camera.target + down);
        let image = renderer.render(&scene, &camera).unwrap().image;
        // Nothing lies below it: in each column it is the lowest that shows.
        let eye = Eye::new(&camera, 1.0);
        let [a, b] = [0.0, 1.0].map(|y| eye.place_of(DVec3::new(1.0, y, 0.0)));
        for x in 30..50 {
            let row = a.y + (b.y - a.y) * (f64::from(x) + 0.5 - a.x) / (b.x - a.x) - 0.5;
            let lowest = (0..80).rev().find(|&y| image.pixel(x, y)[3] > 0.0).unwrap();
            let off = f64::from(lowest) - row;
            assert!(off.abs() <= 0.75, "turned by {turn}, aside by {aside}, column {x}: {lowest} for {row}");
        }
    }
}

/// All geometry at once.
pub(crate) fn everything() -> [(&'static str, GeometryOptions); 3] {
    let walls = walls(SurfaceFaces::Back);
    [("strokes", strokes()), ("walls", walls), ("both", GeometryOptions { surface: walls.surface, ..strokes() })]
}

/// Meshes of all kinds of cells.
pub(crate) fn cases() -> Vec<(&'static str, Case, TransferFunction)> {
    vec![
        ("tetrahedra", Case::new(grid(3000, Scheme::Six, 0.2), "value"), stepped()),
        ("cell values", Case::new(grid(384, Scheme::Six, 0.2), "cell_value"), smooth()),
        ("jittered", case(jittered(4, 0.2), "value"), smooth()),
        ("mixed", case(mixed(), "value"), smooth()),
        ("shell", case(twisted_shell([15, 4, 5], 1.2), "value"), smooth()),
    ]
}

#[test]
fn footprints_and_fans_end_alike() {
    let mut failures = Vec::new();
    for (mesh, case, transfer) in cases() {
        for (view, camera) in three_views(160, 120) {
            for (name, geometry) in everything() {
                for model in [Model::EmissionAbsorption, Model::Emission] {
                    // The same order in both ways.
                    let options = RenderOptions { model, sort: SortMethod::Centroid, ..with(geometry) };
                    let draw =
                        |cpu_method| case.render(RenderOptions { cpu_method, ..options }, &transfer, &camera).image;
                    let (footprints, fans) = (draw(CpuMethod::Footprints), draw(CpuMethod::Fans));
                    let parity = Parity::of(&footprints, &fans, miss(model));
                    let line = format!("{mesh:12} {view:9} {name:8} {model:20} {parity:?}");
                    println!("{line}");
                    if !parity.holds() {
                        failures.push(line);
                    }
                }
            }
        }
    }
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

#[test]
fn whole_cells_end_on_walls() {
    // Straight sides, cells that are warped inside.
    let case = case(jittered(3, 0.3), "value");
    let near_wall = sides_of_unit_cube();
    for (view, camera) in three_views(100, 75) {
        let half = Camera { far: Some(camera.eye.distance(DVec3::splat(0.5))), ..camera.clone() };
        for camera in [camera, half] {
            compare(view, &case, &near_wall, with(walls(SurfaceFaces::Back)), &camera);
        }
    }
}

#[test]
fn wavelength_bands_end_on_geometry() {
    let case = Case::new(grid(48, Scheme::Six, 0.2), "value");
    let names = ["a", "b", "c", "d", "e"].map(str::to_owned).to_vec();
    let extinctions = |scale: f64| (1..6).map(|k| scale * f64::from(k)).collect();
    let table = vec![
        BandPoint { value: 0.0, extinctions: extinctions(0.3) },
        BandPoint { value: 1.0, extinctions: extinctions(2.0) },
    ];
    let scene = case.scene(&smooth()).with_bands(BandTable::new(names, table).unwrap());
    let camera = frame_unit_cube(37.0, 22.0, 100, 75);
    let primitives = edges_and_points(&case.dataset);
    let eye = Eye::new(&camera, case.dataset.diagonal_world());
    let draw = |output| {
        let options = RenderOptions { model: Model::Absorption, output, ..with(strokes()) };
        Renderer::new(options).render(&scene, &camera).unwrap().bands.unwrap()
    };
    let (intensity, depths) = (draw(Output::Intensity), draw(Output::Depth));
    let first_band =
        TransferFunction::new(vec![crate::meshes::point(0.0, [1.0; 3], 0.3), crate::meshes::point(1.0, [1.0; 3], 2.0)]);
    let first_band = first_band.unwrap();
    let mut ended = 0;
    for (x, y) in (0..75).flat_map(|y| (0..100).map(move |x| (x, y))) {
        let Met::At(w, _) = primitives.meet(&eye, [x, y], [1.5, 4.0], true) else { continue };
        ended += 1;
        assert_eq!(intensity.pixel(x, y), [0.0; 5]);
        let segments = case.reference.segments(&Camera { far: Some(w), ..camera.clone() }, x, y);
        for (k, &found) in depths.pixel(x, y).iter().enumerate() {
            let expected = depth(&first_band, &segments) * (k + 1) as f64;
            assert!((f64::from(found) - expected).abs() < 5e-3, "({x}, {y}): {found} for {expected}");
        }
    }
    assert!(ended > 500, "{ended}");
}

#[test]
fn bands_of_light_end_on_geometry() {
    let case = Case::new(grid(48, Scheme::Six, 0.2), "value");
    let (camera, transfer) = (frame_unit_cube(37.0, 22.0, 100, 75), smooth());
    let extinctions = |of: fn(&cellfan::ControlPoint) -> f64| -> Vec<BandPoint> {
        let points = transfer.points().iter();
        points.map(|point| BandPoint { value: point.value, extinctions: vec![of(point); 4] }).collect()
    };
    let names = ["red", "green", "blue", "beyond"].map(str::to_owned).to_vec();
    // Four bands of the one extinction: the picture without bands, and a fourth that is white.
    let table = BandTable::new(names, extinctions(|point| point.extinction)).unwrap();
    let plain = case.scene(&transfer);
    let in_bands = plain.clone().with_bands(table);
    let draw = |scene: &Scene| Renderer::new(with(strokes())).render(scene, &camera).unwrap();
    let (plain, in_bands) = (draw(&plain), draw(&in_bands));
    let parity = Parity::of(&plain.image, &in_bands.image, 0.0);
    assert!(parity.covered > 1000 && parity.mean < 1e-5 && parity.within == 1.0, "{parity:?}");
    let volume = Renderer::new(RenderOptions::default()).render(&case.scene(&transfer), &camera).unwrap().image;
    assert!(!Parity::of(&volume, &in_bands.image, 0.0).holds());
    let bands = in_bands.bands.unwrap();
    let opaque = (0..7500).filter(|&i| plain.image.pixels[i][3] == 1.0 && volume.pixels[i] == [0.0; 4]);
    let mean = COLOR.iter().sum::<f32>() / 3.0;
    let (mut count, at) = (0, |i: usize| bands.pixel(i as u32 % 100, i as u32 / 100));
    for i in opaque {
        count += 1;
        assert!((at(i)[0] - COLOR[0]).abs() < 1e-6 && (at(i)[3] - mean).abs() < 1e-6, "{:?}", at(i));
    }
    println!("{count} pixels of geometry alone");
}

#[test]
fn any_budget_and_any_number_of_threads_give_the_same_bytes() {
    let case = Case::new(grid(3000, Scheme::Six, 0.2), "value");
    let [_, both] = [0, 2].map(|i| everything()[i].1);
    for (view, camera) in three_views(150, 110) {
        assert_same_at_any_budget(&case, &smooth(), &camera, with(both), view);
        let draw = |threads: usize| -> Image {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| case.render(with(both), &smooth(), &camera).image)
        };
        let (one, five) = (draw(1), draw(5));
        assert!(one.pixels == five.pixels, "{view}: threads");
    }
    // Too little to make the lists.
    let scene = case.scene(&smooth());
    let options = RenderOptions { memory_bytes: Some(scene.owned_bytes() + 1000), ..with(both) };
    let refused = Renderer::new(options).render(&scene, &three_views(20, 20)[0].1).unwrap_err();
    assert!(matches!(refused, Error::Memory { .. }), "{refused}");
}

#[test]
fn a_region_has_the_bits_of_the_whole_picture() {
    let case = Case::new(grid(3000, Scheme::Six, 0.2), "value");
    let [_, _, (_, both)] = everything();
    for (view, camera) in three_views(150, 110) {
        for cpu_method in [CpuMethod::Footprints, CpuMethod::Fans] {
            let options = RenderOptions { cpu_method, ..with(both) };
            let whole = case.render(options, &smooth(), &camera).image;
            let region = Region { x0: 37, y0: 21, x1: 118, y1: 67 };
            let part = case.render(options, &smooth(), &Camera { region: Some(region), ..camera.clone() }).image;
            let differ = |&(x, y): &(u32, u32)| part.pixel(x, y) != whole.pixel(37 + x, 21 + y);
            assert_eq!((0..46).flat_map(|y| (0..81).map(move |x| (x, y))).find(differ), None, "{view}, {cpu_method:?}");
        }
    }
}

#[test]
fn what_is_out_of_range_is_refused() {
    let case = Case::new(grid(6, Scheme::Six, 0.0), "value");
    let (scene, camera) = (case.scene(&smooth()), frame_unit_cube(30.0, 20.0, 16, 16));
    let wrong = [
        ("--line-px", GeometryOptions { line_px: 0.5, ..strokes() }),
        ("--point-px", GeometryOptions { point_px: f32::NAN, ..strokes() }),
        ("--edges", GeometryOptions { edges: Some([0.0, 1.5, 0.0]), ..strokes() }),
    ];
    for (expected, geometry) in wrong {
        let error = Renderer::new(with(geometry)).render(&scene, &camera).unwrap_err();
        assert!(matches!(error, Error::Option { option, .. } if option == expected), "{error}");
    }
}
