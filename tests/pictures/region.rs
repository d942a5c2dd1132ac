//! A region of a picture is that part of it, to the bit: whatever draws, whatever the region, the budget, the threads.

use cellfan::generate::Scheme;
use cellfan::optics::Output;
use cellfan::stages::fans::Faces;
use cellfan::{Camera, CpuMethod, Error, Image, Model, Region, RenderOptions, Rendered, Renderer, Scene, SortMethod};

use crate::bands::six_bands;
use crate::budget::{assert_same_at_any_budget, least};
use crate::check::Case;
use crate::hexahedra::{case, mixed, twisted_shell};
use crate::meshes::{Random, frame_unit_cube, grid, smooth, steep, stepped, three_views};
use crate::order::three_bars;

pub(crate) fn within(camera: &Camera, region: Region) -> Camera {
    Camera { region: Some(region), ..camera.clone() }
}

/// The part of a picture, row by row.
fn part<T: Copy>(pixels: &[T], width: u32, Region { x0, y0, x1, y1 }: Region) -> Vec<T> {
    (y0..y1).flat_map(|y| (x0..x1).map(move |x| pixels[(y * width + x) as usize])).collect()
}

pub(crate) fn crop(image: &Image, region: Region) -> Image {
    let [width, height] = region.size_px();
    Image { width, height, pixels: part(&image.pixels, image.width, region) }
}

fn bits(image: &Image) -> Vec<[u32; 4]> {
    image.pixels.iter().map(|pixel| pixel.map(f32::to_bits)).collect()
}

/// Pixels in which two pictures of one size differ.
pub(crate) fn differing(a: &Image, b: &Image) -> usize {
    assert_eq!([a.width, a.height], [b.width, b.height]);
    bits(a).iter().zip(bits(b)).filter(|(a, b)| **a != *b).count()
}

/// All of it, on the edges of tiles and beside them, single pixels, and some that are random.
pub(crate) fn regions(camera: &Camera, random: &mut Random) -> Vec<Region> {
    let [width, height] = [camera.width, camera.height];
    let fixed = [
        [0, 0, width, height],
        [32, 32, 64, height.min(96)],
        [31, 1, 33, 33],
        [width / 2, height / 2, width / 2 + 1, height / 2 + 1],
        [width - 1, height - 1, width, height],
        [width / 3, 0, width / 3 + 1, height],
        [0, height / 3, width, height / 3 + 17],
    ];
    let mut side = |length: u32| {
        let first = random.below(length);
        [first, first + 1 + random.below(length - first)]
    };
    let any = (0..3).map(|_| {
        let ([x0, x1], [y0, y1]) = (side(width), side(height));
        [x0, y0, x1, y1]
    });
    fixed.into_iter().chain(any).map(Region::from).collect()
}

/// Draws the whole and regions of it with one renderer, and compares; the whole.
fn assert_same_in_regions(scene: &Scene, camera: &Camera, options: RenderOptions, seed: u64, what: &str) -> Rendered {
    let mut renderer = Renderer::new(options);
    let whole = renderer.render(scene, camera).unwrap();
    assert!(bits(&whole.image).windows(2).any(|pixels| pixels[0] != pixels[1]), "{what}: blank");
    for region in regions(camera, &mut Random(seed)) {
        let found = renderer.render(scene, &within(camera, region)).unwrap();
        let expected = crop(&whole.image, region);
        assert_eq!(differing(&found.image, &expected), 0, "{what}, {region}: pixels differ");
        assert_eq!(found.cells.accounted(), found.cells.total, "{what}, {region}");
        assert!(found.cells.drawn <= whole.cells.drawn && found.order.exactness == whole.order.exactness);
        if region.size_px() == [camera.width, camera.height] {
            assert_eq!((found.cells, found.order), (whole.cells.clone(), whole.order), "{what}");
        }
    }
    whole
}

#[test]
fn every_model_order_and_view() {
    // Several blocks of cells, thirty tiles, an order that the keys get wrong.
    let case = Case::new(grid(10_000, Scheme::Six, 0.25), "value");
    let scene = case.scene(&steep());
    for (seed, (view, camera)) in (1..).zip(three_views(130, 170)) {
        for cpu_method in [CpuMethod::Footprints, CpuMethod::Rays, CpuMethod::Fans] {
            for model in Model::ALL {
                let options = RenderOptions { model, cpu_method, ..RenderOptions::default() };
                assert_same_in_regions(&scene, &camera, options, seed, &format!("{view}, {model}, {cpu_method:?}"));
            }
            for sort in [SortMethod::None, SortMethod::Power, SortMethod::Topological] {
                let options = RenderOptions { sort, cpu_method, ..RenderOptions::default() };
                assert_same_in_regions(&scene, &camera, options, seed, &format!("{view}, {sort}, {cpu_method:?}"));
            }
        }
        let depths =
            RenderOptions { model: Model::Absorption, output: Output::Depth, check_order: true, ..Default::default() };
        assert_same_in_regions(&scene, &camera, depths, seed, view);
    }
}

#[test]
fn large_cells_whole_cells_and_values_that_are_none() {
    // Cells on many tiles of the whole, and on few of the region.
    let large = Case::new(grid(40, Scheme::Five, 0.2), "value");
    let mut holes = grid(10_000, Scheme::Five, 0.2);
    let values = (0..holes.points.len()).map(|i| if i % 97 == 0 { f64::NAN } else { (i % 10) as f64 / 10.0 });
    holes.arrays[0].values = values.collect::<Vec<f64>>().into();
    let holes = Case::new(holes, "value");
    let cases = [
        (&large, smooth()),
        (&holes, stepped()),
        (&case(twisted_shell([15, 4, 5], 1.2), "value"), stepped()),
        (&case(mixed(), "cell_value"), smooth()),
    ];
    for (seed, (case, transfer)) in (10..).zip(&cases) {
        let scene = case.scene(transfer);
        for (view, camera) in three_views(400, 330) {
            for model in [Model::EmissionAbsorption, Model::Emission, Model::Absorption] {
                for (cpu_method, faces) in [
                    (CpuMethod::Footprints, Faces::Exact),
                    (CpuMethod::Fans, Faces::Exact),
                    (CpuMethod::Fans, Faces::Fan),
                ] {
                    let options = RenderOptions { model, cpu_method, faces, ..RenderOptions::default() };
                    let what = format!("{seed}, {view}, {model}, {cpu_method:?}, {faces:?}");
                    assert_same_in_regions(&scene, &camera, options, seed, &what);
                }
            }
        }
    }
}

#[test]
fn fragments_that_come_too_late() {
    let case = three_bars();
    let scene = case.scene(&smooth().stretched((0.0, 2.0)).unwrap());
    let camera = Camera::looking_at([0.3, 0.2, 12.0].into(), [0.0; 3].into(), 150, 140);
    let whole = assert_same_in_regions(&scene, &camera, RenderOptions::default(), 3, "bars");
    assert!(whole.order.violations > Some(0), "{:?}", whole.order);

    // So many in any order that blocks are drawn again.
    let case = crate::budget::overlapping_cells(20_000);
    let scene = case.scene(&smooth());
    let [(_, camera), ..] = three_views(70, 50);
    let whole = assert_same_in_regions(&scene, &camera, RenderOptions::default(), 4, "overlapping");
    assert!(whole.order.tiles_redone > 2, "{:?}", whole.order);
}

#[test]
fn any_budget_and_any_number_of_threads() {
    let case = Case::new(grid(10_000, Scheme::Six, 0.25), "value");
    let region = Region { x0: 45, y0: 20, x1: 121, y1: 150 };
    for (view, camera) in three_views(130, 170) {
        for model in [Model::EmissionAbsorption, Model::Emission] {
            let options = RenderOptions { model, ..RenderOptions::default() };
            let whole = case.render(options, &steep(), &camera).image;
            let camera = within(&camera, region);
            assert_same_at_any_budget(&case, &steep(), &camera, options, &format!("{view}, {model}"));
            for threads in [1, 2, 7] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                for cpu_method in [CpuMethod::Footprints, CpuMethod::Rays, CpuMethod::Fans] {
                    let options = RenderOptions { cpu_method, ..options };
                    let found = pool.install(|| case.render(options, &steep(), &camera).image);
                    if cpu_method == CpuMethod::Footprints {
                        assert_eq!(differing(&found, &crop(&whole, region)), 0, "{view}, {model}, {threads} threads");
                    } else {
                        let one = case.render(options, &steep(), &camera).image;
                        assert_eq!(differing(&found, &one), 0, "{view}, {model}, {threads} threads");
                    }
                }
            }
        }
    }
}

#[test]
fn four_regions_make_the_whole_and_others_do_not() {
    let case = Case::new(grid(10_000, Scheme::Six, 0.25), "value");
    let scene = case.scene(&smooth());
    let [(_, camera), ..] = three_views(200, 120);
    let mut renderer = Renderer::new(RenderOptions::default());
    let whole = renderer.render(&scene, &camera).unwrap().image;
    let mut stitch = |[across, down]: [u32; 2], shift: u32| {
        let mut image = Image::filled(200, 120, [f32::NAN; 4]);
        for [x0, x1] in [[0, across], [across, 200]] {
            for [y0, y1] in [[0, down], [down, 120]] {
                let region = Region { x0: x0 + shift, y0, x1: (x1 + shift).min(200), y1 };
                let found = renderer.render(&scene, &within(&camera, region)).unwrap().image;
                for y in 0..found.height {
                    for x in 0..found.width {
                        image.pixels[((y0 + y) * 200 + x0 + x) as usize] = found.pixel(x, y);
                    }
                }
            }
        }
        differing(&image, &whole)
    };
    assert_eq!((stitch([100, 60], 0), stitch([96, 64], 0), stitch([1, 119], 0)), (0, 0, 0));
    // A column aside, the comparison fails.
    assert!(stitch([100, 60], 1) > 5000);
}

#[test]
fn bands_of_their_own() {
    let case = Case::new(grid(6000, Scheme::Five, 0.2), "value");
    let scene = case.scene(&smooth()).with_bands(six_bands());
    let [(_, camera), ..] = three_views(150, 90);
    for model in [Model::Absorption, Model::EmissionAbsorption] {
        for cpu_method in [CpuMethod::Footprints, CpuMethod::Rays, CpuMethod::Fans] {
            let mut renderer = Renderer::new(RenderOptions { model, cpu_method, ..RenderOptions::default() });
            let whole = renderer.render(&scene, &camera).unwrap().bands.unwrap();
            let values: Vec<&[f32]> = whole.values.chunks_exact(6).collect();
            for region in regions(&camera, &mut Random(5)) {
                let found = renderer.render(&scene, &within(&camera, region)).unwrap();
                let bands = found.bands.unwrap();
                let [width, height] = region.size_px();
                assert_eq!(
                    [bands.width, bands.height, found.image.width, found.image.height],
                    [width, height, width, height]
                );
                assert!(bands.values == part(&values, whole.width, region).concat(), "{model}, {region}");
            }
        }
    }
}

/// Far more pixels than memory holds: what is drawn costs what it shows.
#[test]
fn small_parts_of_the_largest_picture() {
    let case = Case::new(grid(10_000, Scheme::Six, 0.25), "value");
    let transfer = smooth();
    let side = Camera::MAX_SIDE;
    let mut camera = frame_unit_cube(37.0, 22.0, side, side);
    let mut parallel = three_views(side, side)[2].1.clone();
    let mut renderer = Renderer::new(RenderOptions { memory_bytes: Some(64 << 20), ..RenderOptions::default() });
    let scene = case.scene(&transfer);
    for camera in [&mut camera, &mut parallel] {
        for [x, y] in [[side / 2 - 100, side / 2 - 90], [side / 3, side / 2 + 1001], [side - 130, side - 91], [0, 0]] {
            let large = Region { x0: x, y0: y, x1: x + 130, y1: y + 91 };
            let small = Region { x0: x + 7, y0: y + 33, x1: x + 101, y1: y + 67 };
            let whole = renderer.render(&scene, &within(camera, large)).unwrap();
            let part = renderer.render(&scene, &within(camera, small)).unwrap();
            let small_in_large = Region { x0: 7, y0: 33, x1: 101, y1: 67 };
            assert_eq!(differing(&part.image, &crop(&whole.image, small_in_large)), 0);
            println!("{large}: {} of {} cells, {:.1} ms", whole.cells.drawn, whole.cells.total, whole.frame_ms);
            assert!(whole.cells.drawn < 1000 && whole.cells.accounted() == whole.cells.total);
            // And it is that part: the reference in f64 says so.
            let at = [x + 50, y + 50];
            let segments = case.reference.segments(camera, at[0], at[1]);
            let expected = crate::reference::shade(Model::EmissionAbsorption, &transfer, &segments);
            let found = whole.image.pixel(50, 50).map(f64::from);
            let off = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 2e-3, "{at:?}: {found:?}, not {expected:?}");
        }
        // The whole does not fit, and says so.
        let error = renderer.render(&scene, camera).unwrap_err();
        assert!(matches!(error, Error::Memory { .. } | Error::OutOfMemory { .. }), "{error}");
    }
    let region = Region { x0: 16_300, y0: 16_300, x1: 16_364, y1: 16_364 };
    let alone = Camera { region: None, width: 64, height: 64, ..camera.clone() };
    let [of_region, of_as_large] =
        [&within(&camera, region), &alone].map(|camera| least(&scene, camera, RenderOptions::default()));
    println!("at least {of_region} bytes for a region of 64x64, {of_as_large} for a picture of it");
    assert!(of_region < of_as_large + (1 << 20));
}

#[test]
fn what_is_no_part_of_the_picture() {
    let case = Case::new(grid(40, Scheme::Five, 0.0), "value");
    let scene = case.scene(&smooth());
    let [(_, camera), ..] = three_views(64, 48);
    for cpu_method in [CpuMethod::Footprints, CpuMethod::Rays, CpuMethod::Fans] {
        let mut renderer = Renderer::new(RenderOptions { cpu_method, ..RenderOptions::default() });
        for bad in [[0, 0, 65, 48], [0, 0, 0, 0], [9, 9, 9, 12], [9, 9, 12, 8], [0, 48, 1, 49], [0, 0, 1, u32::MAX]] {
            let error = renderer.render(&scene, &within(&camera, bad.into())).unwrap_err();
            assert!(matches!(error, Error::Option { option: "--region", .. }), "{bad:?}: {error}");
        }
        assert!(renderer.render(&scene, &within(&camera, [63, 47, 64, 48].into())).is_ok());
    }
}
