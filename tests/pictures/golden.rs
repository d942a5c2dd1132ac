//! Pictures that a person looked at, in `tests/golden/`: each pixel within one of 255 levels.
//!
//! `CELLFAN_BLESS=1 cargo test --test pictures golden` writes them anew; look at each before it is kept.

use std::path::PathBuf;

use cellfan::generate::{Kind, Settings, generate};
use cellfan::image::{Encoding, Image};
use cellfan::optics::ControlPoint;
use cellfan::{Camera, Model, Projection, RenderOptions, TetMesh, TransferFunction};
use glam::DVec3;

use crate::check::Case;
use crate::meshes::{frame_unit_cube, point, random_delaunay, smooth};

const BACKGROUND: Encoding = Encoding { background: Some([0.2, 0.2, 0.25]), premultiplied: true };

fn path(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(name)
}

/// The largest difference of any channel, in levels.
fn levels_apart(a: &image::RgbaImage, b: &image::RgbaImage) -> u8 {
    assert_eq!(a.dimensions(), b.dimensions());
    a.as_raw().iter().zip(b.as_raw()).map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0)
}

/// The picture as its file shows it.
fn shown(picture: &Image, encoding: &Encoding) -> image::RgbaImage {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("picture.png");
    picture.save(&file, encoding).unwrap();
    image::open(&file).unwrap().into_rgba8()
}

fn compare(name: &str, picture: &Image, encoding: &Encoding) {
    let path = path(name);
    if std::env::var_os("CELLFAN_BLESS").is_some() {
        picture.save(&path, encoding).unwrap();
    }
    let golden = image::open(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display())).into_rgba8();
    let found = shown(picture, encoding);
    let apart = levels_apart(&golden, &found);
    println!("{name}: {apart} levels apart");
    assert!(apart <= 1, "{name} is {apart} levels from what a person looked at");
    // Not blank, and the comparison can fail.
    assert!(golden.pixels().any(|pixel| pixel != golden.get_pixel(0, 0)), "{name} is blank");
    let mut changed = found;
    changed.get_pixel_mut(48, 48).0[0] ^= 0x02;
    assert!(levels_apart(&golden, &changed) >= 1);
    changed.get_pixel_mut(48, 48).0[0] ^= 0x82;
    assert!(levels_apart(&golden, &changed) > 1, "{name}: a changed pixel passes");
}

fn draw(mesh: TetMesh, array: &str, model: Model, transfer: &TransferFunction, camera: &Camera) -> Image {
    let case = Case::new(mesh, array);
    let range = case.field.range;
    let options = RenderOptions { model, ..RenderOptions::default() };
    case.render(options, &transfer.stretched(range).unwrap(), camera).image
}

fn made(kind: Kind) -> TetMesh {
    generate(kind, &Settings { cells: 60_000, ..Settings::default() }).unwrap()
}

/// The cage of C60: twelve pentagons and twenty hexagons of glowing bonds.
#[test]
fn golden_buckyball() {
    let transfer = TransferFunction::new(vec![
        point(0.0, [0.1, 0.2, 0.8], 0.0),
        point(0.25, [0.1, 0.3, 0.9], 0.0),
        point(0.4, [0.1, 0.6, 0.9], 6.0),
        point(0.6, [1.0, 0.6, 0.1], 40.0),
        point(1.0, [1.0, 0.95, 0.8], 90.0),
    ])
    .unwrap();
    let mut camera = frame_unit_cube(20.0, 15.0, 96, 96);
    camera.projection = Projection::Perspective { fov_degrees: 16.0 };
    let picture = draw(made(Kind::Buckyball), "value", Model::EmissionAbsorption, &transfer, &camera);
    compare("buckyball.png", &picture, &BACKGROUND);
}

/// A shadow of the orbital's lobes in coloured light, along parallel rays.
#[test]
fn golden_orbital_absorption() {
    let transfer = TransferFunction::new(vec![
        ControlPoint { value: 0.0, color: [1.0, 0.6, 0.2], extinction: 0.0 },
        ControlPoint { value: 1.0, color: [1.0, 0.6, 0.2], extinction: 25.0 },
    ])
    .unwrap();
    let mut camera = frame_unit_cube(35.0, 10.0, 96, 96);
    camera.projection = Projection::Orthographic { height_world: 0.7 };
    let picture = draw(made(Kind::Orbital), "value", Model::Absorption, &transfer, &camera);
    compare("orbital_absorption.png", &picture, &Encoding::TRANSMITTED);
}

/// Rings of the test signal from inside the mesh: the rays start at the eye.
#[test]
fn golden_inside() {
    let mut camera = Camera::looking_at(DVec3::new(0.5, 0.15, 0.75), DVec3::new(0.5, 0.6, 0.3), 96, 96);
    camera.projection = Projection::Perspective { fov_degrees: 75.0 };
    let transfer = TransferFunction::new(vec![
        point(0.0, [0.1, 0.2, 0.9], 0.0),
        point(0.55, [0.2, 0.5, 1.0], 0.3),
        point(0.6, [1.0, 0.8, 0.2], 30.0),
        point(0.65, [0.9, 0.3, 0.1], 2.0),
        point(1.0, [1.0, 0.2, 0.1], 4.0),
    ])
    .unwrap();
    let picture = draw(made(Kind::Tets), "value", Model::EmissionAbsorption, &transfer, &camera);
    compare("inside.png", &picture, &BACKGROUND);
}

/// Cell data on a Delaunay mesh: every cell of one colour, the brightest on each ray.
#[test]
fn golden_delaunay_mip() {
    let camera = frame_unit_cube(-50.0, 35.0, 96, 96);
    let picture = draw(random_delaunay(4000), "cell_value", Model::Mip, &smooth(), &camera);
    compare("delaunay_mip.png", &picture, &BACKGROUND);
}
