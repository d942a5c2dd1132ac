//! Every kind of cell in every model of a picture, from outside and from inside: mean at most 1e-4, largest at most 2e-3.

use cellfan::cells::{PYRAMID, WEDGE};
use cellfan::generate::{Scheme, honeycomb, voronoi};
use cellfan::profile::Exactness;
use cellfan::{Dataset, Model, RenderOptions};
use glam::DVec3;

use crate::hexahedra::{hex_grid, jittered, mesh};
use crate::meshes::{grid, smooth, three_views};
use crate::polyhedra::{case, generated, prisms, settings};

/// A bent box whose hexahedra are cut by `cut`.
fn cut(cut: impl Fn(&[u32], &mut Vec<DVec3>) -> Vec<(u8, Vec<u32>)>) -> Dataset {
    let bend = |p: DVec3| p + 0.04 * DVec3::new((5.0 * p.y).sin(), (4.0 * p.z).cos(), (6.0 * p.x).sin());
    let (mut points, hexahedra) = hex_grid([6; 3], bend);
    let cells: Vec<_> = hexahedra.iter().flat_map(|(_, corners)| cut(corners, &mut points)).collect();
    mesh(&points, &cells).into_whole_dataset().unwrap()
}

#[test]
fn every_kind_of_cell_is_the_reference() {
    let wedges = cut(|c, _| {
        let of = |corners: [usize; 6]| (WEDGE.code, corners.map(|i| c[i]).to_vec());
        vec![of([0, 2, 1, 4, 6, 5]), of([0, 3, 2, 4, 7, 6])]
    });
    let pyramids = cut(|c, points| {
        let middle = points.len() as u32;
        points.push(c.iter().map(|&v| points[v as usize]).sum::<DVec3>() / 8.0);
        let base = |face: &[u8]| face.iter().rev().map(|&i| c[usize::from(i)]).collect::<Vec<u32>>();
        let pyramid = |face: &&[u8]| (PYRAMID.code, [base(face), vec![middle]].concat());
        cellfan::cells::HEXAHEDRON.faces.iter().map(pyramid).collect()
    });
    let kinds = [
        ("tetrahedra", Dataset::from_tets(grid(3000, Scheme::Six, 0.25)).unwrap()),
        ("hexahedra", jittered(7, 0.2).into_whole_dataset().unwrap()),
        ("wedges", wedges),
        ("pyramids", pyramids),
        ("prisms", prisms().into_whole_dataset().unwrap()),
        ("octahedra", generated(honeycomb(&settings(189, 0.2)))),
        ("voronoi", generated(voronoi(&settings(300, 0.0)))),
    ];
    let mut failures = Vec::new();
    for (name, dataset) in kinds {
        assert!(dataset.counts.degenerate == 0, "{name}");
        for array in ["value", "cell_value"] {
            let case = case(dataset.clone(), array);
            let [outside, inside, _] = three_views(160, 128);
            for (view, camera) in [outside, inside] {
                let rays = case.random_rays(&camera, 9, 400);
                for model in [Model::Emission, Model::Mip, Model::EmissionAbsorption] {
                    let drawn = case.render(RenderOptions { model, ..RenderOptions::default() }, &smooth(), &camera);
                    assert_eq!(drawn.order.exactness, Exactness::Exact);
                    let errors = rays.errors(&drawn.image, model, &smooth(), 400);
                    let line = format!("{name:10} {array:10} {view:7} {model:20} {errors}");
                    println!("{line}");
                    if !errors.are_small() || errors.pixels < 300 {
                        failures.push(line);
                    }
                }
            }
        }
    }
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}
