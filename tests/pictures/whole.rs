//! Whole cells in three ways to one picture: footprints, fans on the processor, and every GPU.

use cellfan::stages::fans::Faces;
use cellfan::{Camera, CpuMethod, Model, RenderOptions, Renderer, Scene, SortMethod, TransferFunction};

use crate::check::Case;
use crate::gpu::{draw, four_views, models};
use crate::gpus::gpus;
use crate::hexahedra::{case, jittered, mixed, twisted_shell};
use crate::meshes::{point, smooth, stepped};
use crate::parity::{Parity, miss};

#[test]
fn whole_cells_have_parity() {
    let gpus = gpus("whole_cells_have_parity");
    let mut failures = Vec::new();
    let shell = || twisted_shell([15, 4, 5], 1.2);
    let meshes = [
        ("jittered", jittered(6, 0.2), "value", smooth()),
        ("shell", shell(), "value", stepped()),
        ("mixed", mixed(), "value", smooth()),
        ("mixed", mixed(), "cell_value", stepped()),
    ];
    for (mesh, cells, array, transfer) in meshes {
        let case = case(cells, array);
        for (view, camera) in four_views(100, 75) {
            let scene = Scene::new(case.dataset.clone(), case.field.clone(), &transfer);
            for (model, integral) in models() {
                // The same order in all ways.
                let options = RenderOptions { model, integral, sort: SortMethod::Centroid, ..RenderOptions::default() };
                let footprints = Renderer::new(options).render(&scene, &camera).unwrap().image;
                let on_cpu = RenderOptions { cpu_method: CpuMethod::Fans, ..options };
                let fans = Renderer::new(on_cpu).render(&scene, &camera).unwrap().image;
                let on_gpus = gpus.iter().map(|gpu| (gpu.adapter().to_string(), draw(gpu, options, &scene, &camera)));
                for (way, mut image) in std::iter::once(("fans".to_owned(), fans)).chain(on_gpus) {
                    let parity = Parity::of(&footprints, &image, miss(model));
                    let line = format!("{mesh:8} {array:10} {view:9} {model:20} {integral:8} {parity:?} {way}");
                    println!("{line}");
                    if !parity.holds() {
                        failures.push(line);
                    }
                    image.pixels.iter_mut().for_each(|pixel| pixel[2] += 1.0 / 255.0);
                    assert!(!Parity::of(&footprints, &image, miss(model)).holds(), "one level passes");
                }
            }
        }
    }
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

/// As the papers draw them: the same triangles on the processor and on GPUs; exact where faces are plane.
#[test]
fn faces_as_fans_are_the_same_everywhere_and_exact_where_they_are_plane() {
    let gpus = gpus("faces_as_fans_are_the_same_everywhere_and_exact_where_they_are_plane");
    let mut failures = Vec::new();
    // On a plane face of four corners values are two linear parts, where fans take what they like: there cells have one value.
    let meshes = [
        ("plane", jittered(6, 0.0), "cell_value"),
        ("jittered", jittered(6, 0.2), "value"),
        ("mixed", mixed(), "value"),
    ];
    for (mesh, cells, array) in meshes {
        let case = case(cells, array);
        let scene = Scene::new(case.dataset.clone(), case.field.clone(), &smooth());
        for (view, camera) in four_views(100, 75) {
            for model in [Model::EmissionAbsorption, Model::Emission] {
                let cpu_method = CpuMethod::Fans;
                let exact = RenderOptions { model, cpu_method, sort: SortMethod::Centroid, ..RenderOptions::default() };
                let options = RenderOptions { faces: Faces::Fan, ..exact };
                let drawn = Renderer::new(options).render(&scene, &camera).unwrap();
                let of = |wanted: fn(&str) -> bool| {
                    let classes = drawn.cells.by_class.iter().filter(|(name, _)| wanted(name));
                    classes.map(|(_, cells)| cells).sum::<u64>()
                };
                let whole = of(|name| name.starts_with("count") || name.starts_with("pyramid"));
                assert_eq!(
                    whole + of(|name| name == "split" || name == "edge_on"),
                    drawn.cells.drawn,
                    "{mesh}, {view}"
                );
                assert!(view != "outside" || 10 * whole > 8 * drawn.cells.drawn, "{:?}", drawn.cells.by_class);
                let exact = Renderer::new(exact).render(&scene, &camera).unwrap().image;
                // The field within the cells that are split, those around an eye among them, is another.
                let is_split = of(|name| name == "split") > 0;
                let pictures = gpus.iter().map(|gpu| (gpu.adapter().to_string(), draw(gpu, options, &scene, &camera)));
                let pictures = pictures.chain((mesh == "plane" && !is_split).then(|| ("exact".to_owned(), exact)));
                for (way, image) in pictures {
                    let parity = Parity::of(&drawn.image, &image, miss(model));
                    let line = format!("{mesh:8} {view:9} {model:20} {parity:?} {way}");
                    println!("{line}");
                    // Where triangles meet on folded faces, the pixel that a rasteriser's rounding gives them shows.
                    if parity.covered <= 1000 || parity.mean > 5e-5 || parity.within < 0.99 {
                        failures.push(line);
                    }
                }
            }
        }
    }
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

/// What the papers' triangles leave open on warped faces (Max 2006, figure 15), and exact faces close.
#[test]
fn warped_faces_show_as_fans_and_not_exactly() {
    let dataset = twisted_shell([15, 4, 5], 1.2).into_whole_dataset().unwrap();
    let corners = dataset.corners_world();
    let case = Case::of(dataset.clone(), dataset.homogeneous_field());
    let transfer = TransferFunction::new(vec![point(0.0, [0.9, 0.7, 0.5], 1.5)]).unwrap();
    let camera = Camera::framing(&corners, 20.0, 25.0, 120, 96);
    let rays = case.all_rays(&camera);
    let model = Model::Absorption;
    let worst = [Faces::Exact, Faces::Fan].map(|faces| {
        let options = RenderOptions { model, faces, cpu_method: CpuMethod::Fans, ..RenderOptions::default() };
        let rendered = case.render(options, &transfer, &camera);
        rays.errors(&rendered.image, model, &transfer, usize::MAX).max
    });
    println!("largest error: exact {:.1e}, as fans {:.1e}", worst[0], worst[1]);
    assert!(worst[0] < 1e-4 && worst[1] > 1e-2, "{worst:?}");
}
