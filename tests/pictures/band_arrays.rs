//! Bands from arrays: the reference in f64, and cell arrays of one pass against a pass each.

use cellfan::columns::{Array, Association, NumericColumn};
use cellfan::optics::{BandPoint, BandTable, Output};
use cellfan::{
    CpuMethod, Dataset, Field, FieldSelection, Model, RenderOptions, Rendered, Renderer, Scene, TransferFunction,
};

use crate::bands::{DEPTH, bar, beside_the_diagonal, dark, draw, too_small, worst_depth};
use crate::check::Case;
use crate::hexahedra::mixed;
use crate::meshes::{Random, frame_unit_cube, point, random_delaunay, three_views};
use crate::reference::depth;

/// A dataset with arrays of extinctions: two of points, two of cells.
pub(crate) fn with_arrays() -> (Dataset, Vec<Field>) {
    let mut mesh = random_delaunay(10_000);
    let (points, cells) = (mesh.points.len(), mesh.tets.len());
    let array = |name: &str, association, of: &dyn Fn(usize) -> f64| {
        let len = if association == Association::Point { points } else { cells };
        let values: Vec<f64> = (0..len).map(of).collect();
        Array { name: name.to_owned(), association, components: 1, values: NumericColumn::from(values) }
    };
    let x = |i: usize| mesh.points.get(i).x;
    mesh.arrays = vec![
        array("ramp", Association::Point, &|i| 3.0 * x(i)),
        array("holes", Association::Cell, &|i| if i % 3 == 0 { 0.0 } else { 1.0 + (i % 7) as f64 }),
        array("heavy", Association::Point, &|i| 1000.0 + x(i)),
        array("one", Association::Cell, &|_| 1.0),
        array("nothing", Association::Cell, &|_| 0.0),
    ];
    let dataset = Dataset::from_tets(mesh).unwrap();
    let fields = ["ramp", "holes", "heavy", "one", "nothing"];
    let fields = fields.map(|name| dataset.field(&FieldSelection::parse(name, &dataset.arrays)).unwrap());
    (dataset, fields.to_vec())
}

#[test]
fn arrays_are_extinctions() {
    let (dataset, fields) = with_arrays();
    let identity = TransferFunction::new(vec![point(0.0, [1.0; 3], 0.0), point(2000.0, [1.0; 3], 2000.0)]).unwrap();
    for (first, other) in [(0, 1), (1, 0)] {
        // Whatever field the scene itself has.
        let scene = Scene::new(dataset.clone(), fields[first].clone(), &dark());
        let scene = scene.with_band_arrays(fields.clone()).unwrap();
        assert_eq!(scene.band_names(), ["ramp", "holes", "heavy", "one", "nothing"]);
        for (view, camera) in three_views(100, 80) {
            let rendered = Renderer::new(DEPTH).render(&scene, &camera).unwrap();
            assert_eq!(rendered.cells.total, rendered.cells.drawn + rendered.cells.culled_outside);
            let picture = rendered.bands.unwrap();
            for (band, field) in fields.iter().enumerate() {
                let case = Case::of(dataset.clone(), field.clone());
                let rays = case.random_rays(&camera, 3, 100);
                let worst = worst_depth(&rays, &picture, band, |segments| depth(&identity, segments));
                println!("{view:9} {:8} {worst:.1e}", field.name);
                assert!(worst < 2e-3, "{view} {}: {worst}", field.name);
            }
            let rays = Case::of(dataset.clone(), fields[first].clone()).random_rays(&camera, 3, 100);
            let worst = worst_depth(&rays, &picture, other, |segments| depth(&identity, segments));
            assert!(worst > 0.1, "{other} passes as {first}");
        }
    }
}

/// Red, green and blue that cells and points emit: as much light as there is optical depth of it, and nothing dimmed.
#[test]
fn three_arrays_are_what_red_green_and_blue_are_emitted() {
    for ((_, dataset), names) in meshes().into_iter().zip([["value", "gaps", "alike"], ["some", "gaps", "value"]]) {
        let fields = fields_of(&dataset, &names);
        let scene = Scene::new(dataset, fields[0].clone(), &dark()).with_band_arrays(fields).unwrap();
        let (_, camera) = three_views(90, 70)[0].clone();
        let depths = Renderer::new(DEPTH).render(&scene, &camera).unwrap().bands.unwrap();
        let options = RenderOptions { model: Model::Emission, ..RenderOptions::default() };
        let rendered = Renderer::new(options).render(&scene, &camera).unwrap();
        assert!(rendered.bands.is_none());
        let mut lit = [0.0; 3];
        for (pixel, depths) in rendered.image.pixels.iter().zip(depths.values.chunks_exact(3)) {
            assert_eq!(pixel[..3], *depths);
            assert_eq!(pixel[3].to_bits(), 0);
            (0..3).for_each(|k| lit[k] += pixel[k]);
        }
        assert!(lit.iter().all(|&light| light > 0.0) && lit[0] != lit[1] && lit[1] != lit[2]);
    }
}

#[test]
fn arrays_that_are_no_extinctions_are_refused() {
    let (dataset, fields) = with_arrays();
    let scene = || Scene::new(dataset.clone(), fields[0].clone(), &dark());
    let mut negative = fields[3].clone();
    negative.range = (-1.0, 1.0);
    let error = scene().with_band_arrays(vec![negative]).unwrap_err().to_string();
    assert!(error.contains("\"one\"") && error.contains("0 or more"), "{error}");
    let error = scene().with_band_arrays(vec![fields[0].clone(), fields[0].clone()]).unwrap_err().to_string();
    assert!(error.contains("two bands are called \"ramp\""), "{error}");
    assert!(scene().with_band_arrays(vec![]).is_err());
}

/// Arrays of extinctions over so many cells: something everywhere, gaps, much around an offset, next to nothing, all alike.
fn of_cells(cells: usize) -> Vec<Array> {
    let array = |name: &str, seed: u64, of: fn(f64) -> f64| {
        let mut random = Random(seed);
        let values: Vec<f64> = (0..cells).map(|_| of(f64::from(random.below(1 << 20)) / f64::from(1 << 20))).collect();
        let values = NumericColumn::from(values);
        Array { name: name.to_owned(), association: Association::Cell, components: 1, values }
    };
    vec![
        array("some", 1, |x| 0.1 + x),
        array("gaps", 2, |x| (9.0 * x - 6.0).max(0.0)),
        array("heavy", 3, |x| 300.0 + x),
        array("air", 4, |x| 1e-5 * x),
        array("wide", 5, |x| 50.0 * x * x),
        array("alike", 6, |_| 2.0),
        array("seventh", 7, |x| 1.0 - x),
    ]
}

/// The dataset's fields of these names, or of the point array `value`.
fn fields_of(dataset: &Dataset, names: &[&str]) -> Vec<Field> {
    names.iter().map(|name| dataset.field(&FieldSelection::parse(name, &dataset.arrays)).unwrap()).collect()
}

/// Tetrahedra, and whole cells of four kinds; with the arrays [`of_cells`].
fn meshes() -> [(&'static str, Dataset); 2] {
    let (mut tets, mut whole) = (random_delaunay(10_000), mixed());
    tets.arrays.extend(of_cells(tets.tets.len()));
    whole.arrays.extend(of_cells(whole.types.len()));
    [("tets", Dataset::from_tets(tets).unwrap()), ("mixed", whole.into_whole_dataset().unwrap())]
}

/// The slow twin: the array as the scalar of a scene of its own, whose extinction is the scalar.
fn alone(options: RenderOptions, dataset: &Dataset, field: &Field, camera: &cellfan::Camera) -> Rendered {
    let of_value = |value: f64| BandPoint { value, extinctions: vec![value] };
    let identity = BandTable::new(vec![field.name.clone()], vec![of_value(0.0), of_value(field.range.1)]).unwrap();
    let scene = Scene::new(dataset.clone(), field.clone(), &dark()).with_bands(identity);
    Renderer::new(options).render(&scene, camera).unwrap()
}

/// Values that are stored as they are: the same bits. Around an offset a pass of its own rounds value less offset, not the value.
#[test]
fn cell_arrays_of_one_pass_are_those_of_a_pass_each() {
    let names = ["some", "gaps", "value", "heavy", "air", "wide", "alike", "seventh"];
    for (mesh, dataset) in meshes() {
        let fields = fields_of(&dataset, &names);
        assert!(fields[3].offset != 0.0 && fields[0].offset == 0.0);
        // Whatever field the scene itself has.
        let scene = Scene::new(dataset.clone(), fields[2].clone(), &dark()).with_band_arrays(fields.clone()).unwrap();
        let corners = dataset.corners_world();
        let mut views = three_views(100, 80).to_vec();
        views.push(("framed", cellfan::Camera::framing(&corners, 20.0, 25.0, 120, 96)));
        for (view, camera) in views {
            for output in Output::ALL {
                let options = RenderOptions { output, ..DEPTH };
                let together = draw(options, &scene, &camera);
                assert_eq!(together.names, names);
                let of_band = |band: usize| together.values.iter().skip(band).step_by(names.len());
                for (band, field) in fields.iter().enumerate() {
                    let alone = alone(options, &dataset, field, &camera).bands.unwrap();
                    let covered = alone.covered(output.miss());
                    assert!(covered > 1000, "{mesh} {view} {covered}");
                    if field.offset == 0.0 {
                        let differ = of_band(band).zip(&alone.values).filter(|(a, b)| a.to_bits() != b.to_bits());
                        assert_eq!(differ.count(), 0, "{mesh} {view} {} {output:?}", field.name);
                    } else {
                        let off = of_band(band).zip(&alone.values).map(|(a, b)| (a - b).abs() / b.max(0.01));
                        let off = off.fold(0.0, f32::max);
                        println!("{mesh} {view} {} {output:?}: {off:.1e}", field.name);
                        assert!(off < 1e-6, "{mesh} {view} {} {output:?}: {off}", field.name);
                    }
                    // The comparison fails on another band.
                    let other = (band + 1) % names.len();
                    assert!(of_band(other).zip(&alone.values).any(|(a, b)| (a - b).abs() > 1e-3 * b.abs()));
                }
            }
        }
    }
}

/// What the tiles of a frame put together, in bytes: as much again for each pass.
fn composited(rendered: &Rendered) -> u64 {
    rendered.profile.get("composite").unwrap().bytes
}

#[test]
fn four_cell_arrays_take_one_pass() {
    let camera = frame_unit_cube(37.0, 22.0, 100, 80);
    for (mesh, dataset) in meshes() {
        let passes = |options: RenderOptions, names: &[&str]| {
            let fields = fields_of(&dataset, names);
            let one = composited(&alone(options, &dataset, &fields[0], &camera));
            let scene = Scene::new(dataset.clone(), fields[0].clone(), &dark()).with_band_arrays(fields).unwrap();
            let all = composited(&Renderer::new(options).render(&scene, &camera).unwrap());
            all as f64 / one as f64
        };
        let all = ["some", "wide", "value", "heavy", "air", "alike", "seventh"];
        for (names, expected) in
            [(&all[..1], 1.0), (&all[..2], 1.0), (&all[2..3], 1.0), (&all[..5], 2.0), (&all[..6], 3.0)]
        {
            assert_eq!(passes(DEPTH, names), expected, "{mesh} {names:?}");
        }
        // Fans know no cell: a pass each.
        let fans = RenderOptions { cpu_method: CpuMethod::Fans, ..DEPTH };
        assert_eq!(passes(fans, &["some", "alike", "wide"]), 3.0, "{mesh}");
    }
}

/// An array by the place of a cell in a row from 0 to 1.
type Along = (&'static str, fn(f64) -> f64);

/// A ray through more than 10^4 cells, against the f64 sum of its segments. Extinctions change little from cell to cell: where
/// they jump, what f32 rounds off a face's depth shows.
#[test]
fn thousands_of_cells_add_up_to_a_millionth() {
    let mut mesh = bar(4000);
    let bands: [Along; 4] = [
        ("ramp", |x| 3.0 * x),
        ("wave", |x| (20.0 * x).sin().powi(2)),
        ("heavy", |x| 300.0 + x),
        ("air", |x| 1e-5 / (1.0 + x)),
    ];
    for (name, of) in bands {
        // Six cells a box of the row.
        let values: Vec<f64> = (0..mesh.tets.len()).map(|cell| of((cell / 6) as f64 / 4000.0)).collect();
        let values = NumericColumn::from(values);
        mesh.arrays.push(Array { name: name.to_owned(), association: Association::Cell, components: 1, values });
    }
    let dataset = Dataset::from_tets(mesh).unwrap();
    let fields = fields_of(&dataset, &bands.map(|(name, _)| name));
    let camera = beside_the_diagonal();
    let case = Case::of(dataset.clone(), fields[0].clone());
    let picture = draw(DEPTH, &case.scene(&dark()).with_band_arrays(fields.clone()).unwrap(), &camera);
    let mut worst = [0.0_f64; 4];
    for (x, y) in [(7, 11), (3, 20), (12, 12), (20, 2)] {
        let segments = case.reference.segments(&camera, x, y);
        assert!(segments.len() > 10_000, "{}", segments.len());
        for (band, field) in fields.iter().enumerate() {
            let extinction = |cell: usize| field.offset + f64::from(field.values[cell]);
            let expected: f64 = segments.iter().map(|segment| segment.length_world * extinction(segment.cell)).sum();
            worst[band] = worst[band].max((f64::from(picture.pixel(x, y)[band]) / expected - 1.0).abs());
        }
    }
    println!("{worst:?}");
    assert!(worst.iter().all(|&worst| worst < 1e-6), "{worst:?}");
}

#[test]
fn threads_and_budgets_give_the_same_arrays() {
    let camera = frame_unit_cube(37.0, 22.0, 200, 150);
    for (mesh, dataset) in meshes() {
        let fields = fields_of(&dataset, &["some", "gaps", "heavy", "air", "wide", "value", "alike"]);
        let scene = Scene::new(dataset, fields[0].clone(), &dark()).with_band_arrays(fields).unwrap();
        let on = |threads: usize, options: RenderOptions| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| draw(options, &scene, &camera))
        };
        let one = on(1, DEPTH);
        assert!(one.covered(0.0) > 1000 && one == on(4, DEPTH), "{mesh}");
        let budget = |memory_bytes| RenderOptions { memory_bytes: Some(memory_bytes), ..DEPTH };
        let (needed, _) = too_small(&scene, &camera, budget(1));
        assert!(one == on(2, budget(needed + (8 << 20))), "{mesh}");
    }
}

/// What has no extinction in any array of a pass is not drawn.
#[test]
fn cells_of_no_extinction_are_left_out() {
    let mut mesh = random_delaunay(10_000);
    let cells = mesh.tets.len();
    let array = |name: &str, association, values: Vec<f64>| Array {
        name: name.to_owned(),
        association,
        components: 1,
        values: NumericColumn::from(values),
    };
    let of = |nth: usize| (0..cells).map(|cell| if cell % 4 == nth { 2.0 } else { 0.0 }).collect();
    let points: Vec<f64> = (0..mesh.points.len()).map(|i| (mesh.points.get(i).x - 0.5).max(0.0)).collect();
    mesh.arrays = vec![
        array("first", Association::Cell, of(0)),
        array("second", Association::Cell, of(1)),
        array("half", Association::Point, points),
        array("nothing", Association::Cell, vec![0.0; cells]),
    ];
    let dataset = Dataset::from_tets(mesh).unwrap();
    // All of the mesh is in view, and more pixels than cells.
    let camera = frame_unit_cube(37.0, 22.0, 300, 300);
    let of = |names: &[&str]| {
        let fields = fields_of(&dataset, names);
        let scene = Scene::new(dataset.clone(), fields[0].clone(), &dark()).with_band_arrays(fields).unwrap();
        Renderer::new(DEPTH).render(&scene, &camera).unwrap()
    };
    let together = of(&["first", "second"]);
    assert_eq!(together.cells.culled_transparent, (2..4).map(|nth| (cells - nth).div_ceil(4) as u64).sum::<u64>());
    let transparent = ["first", "second", "half", "nothing"].map(|name| of(&[name]).cells.culled_transparent);
    println!("{transparent:?} of {cells}");
    assert_eq!(transparent[0], (1..4).map(|nth| (cells - nth).div_ceil(4) as u64).sum::<u64>());
    assert!(transparent[2] > cells as u64 / 3 && transparent[2] < cells as u64 / 2);
    assert_eq!(transparent[3], cells as u64);
    let layers = together.bands.unwrap();
    for (band, field) in fields_of(&dataset, &["first", "second"]).iter().enumerate() {
        // The twin draws all cells.
        let alone = alone(DEPTH, &dataset, field, &camera);
        assert_eq!(alone.cells.culled_transparent, 0);
        let found = layers.values.iter().skip(band).step_by(2);
        let off = found.zip(&alone.bands.unwrap().values).map(|(a, b)| (a - b).abs() / b.max(0.01)).fold(0.0, f32::max);
        assert!(off < 1e-6, "{off}");
    }
}

/// A value that is not finite leaves its cell out of its own band alone, and is counted.
#[test]
fn what_an_array_does_not_say_costs_the_others_nothing() {
    let mut mesh = random_delaunay(10_000);
    mesh.arrays = of_cells(mesh.tets.len());
    let whole = Dataset::from_tets(mesh.clone()).unwrap();
    let values = (0..mesh.tets.len()).map(|i| if i % 5 == 0 { f64::NAN } else { mesh.arrays[4].values.get(i) });
    mesh.arrays[4].values = NumericColumn::from(values.collect::<Vec<_>>());
    let holed = Dataset::from_tets(mesh).unwrap();
    let names = ["some", "gaps", "wide", "air", "alike"];
    let camera = frame_unit_cube(37.0, 22.0, 100, 80);
    let [(fields, found), (_, expected)] = [holed.clone(), whole].map(|dataset| {
        let fields = fields_of(&dataset, &names);
        let scene = Scene::new(dataset, fields[0].clone(), &dark()).with_band_arrays(fields.clone()).unwrap();
        (fields, Renderer::new(DEPTH).render(&scene, &camera).unwrap().bands.unwrap())
    });
    let alone = alone(DEPTH, &holed, &fields[2], &camera);
    assert_eq!(alone.cells.invalid, 10_000_usize.min(holed.cells()).div_ceil(5) as u64);
    for (pixel, (expected, alone)) in
        found.values.chunks(5).zip(expected.values.chunks(5).zip(&alone.bands.unwrap().values))
    {
        assert_eq!([pixel[0], pixel[1], pixel[3], pixel[4]], [expected[0], expected[1], expected[3], expected[4]]);
        assert_eq!(pixel[2], *alone);
        assert!(pixel[2] <= expected[2] * 1.000_001);
    }
}
