//! Any memory budget gives the same bytes and the same counts, from the least that does.

use cellfan::generate::Scheme;
use cellfan::{Camera, Error, Model, RenderOptions, Rendered, Renderer, Scene, SortMethod, TransferFunction};

use crate::check::Case;
use crate::meshes::{Random, grid, mesh, smooth, steep, three_views};

fn draw(scene: &Scene, camera: &Camera, options: RenderOptions, memory_bytes: u64) -> Result<Rendered, Error> {
    Renderer::new(RenderOptions { memory_bytes: Some(memory_bytes), ..options }).render(scene, camera)
}

/// The least budget that does: what each error asks for, until there is none.
pub(crate) fn least(scene: &Scene, camera: &Camera, options: RenderOptions) -> u64 {
    let mut budget = 0;
    for _ in 0..5 {
        match draw(scene, camera, options, budget) {
            Ok(_) => return budget,
            Err(Error::Memory { budget_bytes, needed_bytes, .. }) => {
                assert!(budget_bytes == budget && needed_bytes > budget, "{needed_bytes} for {budget}");
                budget = needed_bytes;
            }
            Err(other) => panic!("{other}"),
        }
    }
    panic!("{budget} bytes are not enough still");
}

#[track_caller]
fn assert_same(found: &Rendered, expected: &Rendered, what: &str) {
    let bits = |rendered: &Rendered| rendered.image.pixels.iter().map(|p| p.map(f32::to_bits)).collect::<Vec<_>>();
    let differ = bits(found).iter().zip(bits(expected)).filter(|(a, b)| **a != *b).count();
    assert_eq!(differ, 0, "{what}: pixels differ");
    assert_eq!((&found.cells, found.order), (&expected.cells, expected.order), "{what}");
}

pub(crate) fn assert_same_at_any_budget(
    case: &Case,
    transfer: &TransferFunction,
    camera: &Camera,
    options: RenderOptions,
    what: &str,
) {
    let scene = case.scene(transfer);
    let expected = Renderer::new(options).render(&scene, camera).unwrap();
    let least = least(&scene, camera, options);
    let refused = draw(&scene, camera, options, least - 1).unwrap_err();
    assert!(matches!(refused, Error::Memory { needed_bytes, .. } if needed_bytes == least), "{what}: {refused}");
    for budget in [least, least + 20_000, 1 << 40] {
        let found = draw(&scene, camera, options, budget).unwrap();
        assert_same(&found, &expected, &format!("{what}, {budget} bytes"));
    }
    // A renderer that drew another view before holds on to nothing of it.
    let mut renderer = Renderer::new(RenderOptions { memory_bytes: Some(least), ..options });
    let away = Camera { eye: camera.eye * 1.5, ..camera.clone() };
    let _ = renderer.render(&scene, &away);
    assert_same(&renderer.render(&scene, camera).unwrap(), &expected, what);
}

#[test]
fn every_model_and_view() {
    // Several blocks of cells, thirty tiles, an order that the keys get wrong.
    let case = Case::new(grid(10_000, Scheme::Six, 0.25), "value");
    for (view, camera) in three_views(130, 170) {
        for model in Model::ALL {
            let options = RenderOptions { model, ..RenderOptions::default() };
            assert_same_at_any_budget(&case, &steep(), &camera, options, &format!("{view}, {model}"));
        }
        for sort in [SortMethod::None, SortMethod::Power] {
            let options = RenderOptions { sort, ..RenderOptions::default() };
            assert_same_at_any_budget(&case, &steep(), &camera, options, &format!("{view}, {sort}"));
        }
    }
}

#[test]
fn invalid_values_and_large_cells() {
    // Few cells on many tiles: most are listed aside.
    let case = Case::new(grid(40, Scheme::Five, 0.2), "value");
    let mut with_holes = grid(10_000, Scheme::Five, 0.2);
    let values = (0..with_holes.points.len()).map(|i| if i % 97 == 0 { f64::NAN } else { (i % 10) as f64 / 10.0 });
    with_holes.arrays[0].values = values.collect::<Vec<f64>>().into();
    let with_holes = Case::new(with_holes, "value");
    assert!(with_holes.field.invalid > 0);
    for (view, camera) in three_views(400, 330) {
        assert_same_at_any_budget(&case, &smooth(), &camera, RenderOptions::default(), view);
        for model in [Model::Emission, Model::EmissionAbsorption] {
            let options = RenderOptions { model, ..RenderOptions::default() };
            assert_same_at_any_budget(&with_holes, &smooth(), &camera, options, view);
        }
    }
}

/// Cells of any size anywhere in the unit cube: in no order do all come after those in front of them.
pub(crate) fn overlapping_cells(count: u32) -> Case {
    let mut random = Random(3);
    let mut coordinate = || f64::from(random.below(1 << 20)) / f64::from(1 << 20);
    let points: Vec<[f64; 3]> = (0..4 * count).map(|_| [(); 3].map(|()| coordinate())).collect();
    let tets = (0..count).map(|i| [0, 1, 2, 3].map(|k| 4 * i + k)).collect();
    let values = (0..points.len()).map(|i| (i % 7) as f64 / 7.0).collect();
    Case::new(mesh(points, tets, values), "value")
}

#[test]
fn more_cells_over_a_pixel_than_a_worker_has_room_for() {
    // Each block is drawn again with more fragments than the 65,536 that are planned for.
    let case = overlapping_cells(60_000);
    let [(_, camera), ..] = three_views(16, 12);
    let scene = case.scene(&smooth());
    let options = RenderOptions { stop_transmittance: 0.0, ..RenderOptions::default() };
    let expected = Renderer::new(options).render(&scene, &camera).unwrap();
    assert!(expected.order.tiles_redone > 0);
    let least = least(&scene, &camera, options);
    for budget in [least, least + 1_000_000, 1 << 40] {
        assert_same(&draw(&scene, &camera, options, budget).unwrap(), &expected, &format!("{budget} bytes"));
    }
}
