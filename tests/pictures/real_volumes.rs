//! Every regular grid of the real data, by both renderers on the CPU, and as cubes on GPUs: none is blank.

use std::path::{Path, PathBuf};

use cellfan::columns::{Array, Volume};
use cellfan::depth_planes::Options;
use cellfan::geometry::GeometryOptions;
use cellfan::io::{self, Mesh, RawLayout};
use cellfan::optics::presets;
use cellfan::render::{CubeScene, Detail, VolumeScene, depth_planes};
use cellfan::{Camera, FieldSelection, Image, RenderOptions, Renderer};

use crate::common::data_folder;
#[cfg(feature = "gpu")]
use crate::gpus::gpus;

/// Raw samples, which say nothing of themselves.
const RAW: &[(&str, &str)] = &[
    ("classic/Bucky.raw", "32x32x32:u8"),
    ("classic/engine.raw", "149x208x110:u8"),
    ("regular/Teddybear.raw", "128x128x62:u8"),
    ("regular/LIDC2.raw.gz", "256x256x133:u8"),
];

/// Names by which files may be regular grids.
const ENDINGS: &[&str] = &["vti", "pvti", "nrrd", "nhdr", "vtk"];

fn files_below(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files_below(&path, files);
        } else if path.extension().is_some_and(|extension| ENDINGS.iter().any(|ending| extension == *ending)) {
            files.push(path);
        }
    }
}

/// All of them that have a thickness.
fn volumes(folder: &Path) -> Vec<(String, Volume)> {
    let mut files = Vec::new();
    files_below(folder, &mut files);
    files.sort();
    let name = |path: &Path| path.strip_prefix(folder).unwrap().display().to_string();
    let opened = files.iter().filter_map(|path| match io::open_mesh(path) {
        Ok(Mesh::Volume(volume)) => Some((name(path), volume)),
        _ => None,
    });
    let raw = RAW.iter().map(|(file, layout)| {
        let layout: RawLayout = layout.parse().unwrap();
        ((*file).to_owned(), io::open_raw(&folder.join(file), &layout).unwrap())
    });
    opened.chain(raw).filter(|(_, volume)| volume.has_volume()).collect()
}

#[test]
fn every_real_volume_shows_something_by_every_renderer() {
    let Some(folder) = data_folder("every_real_volume") else { return };
    let volumes = volumes(&folder);
    let mut blank = Vec::new();
    for (file, volume) in &volumes {
        let arrays = || volume.arrays.iter();
        let array = arrays().max_by_key(|array: &&Array| (array.components == 1, array.tuples())).unwrap();
        let field = || volume.field(&FieldSelection::parse(&array.name, &volume.arrays)).unwrap();
        let corners = volume.corners_world();
        let unit = corners[0].distance(corners[7]) / 100.0;
        let transfer = presets::preset("viridis", field().range, presets::OpacityProfile::default(), unit).unwrap();
        let camera = Camera::framing(&corners, 35.0, 20.0, 48, 36);
        let mut check = |way: &str, image: &Image| {
            let covered = image.covered([0.0; 4]);
            println!("{file:32} {:16} {way:24} {covered} pixels", array.name);
            if covered < 100 {
                blank.push(format!("{file} {way}: {covered} pixels"));
            }
        };
        let scene = VolumeScene::new(volume.clone(), field(), &transfer);
        let planes = depth_planes(&scene, &camera, &Options::default(), &GeometryOptions::default(), false).unwrap();
        check("depth planes", &planes.image);
        let cubes = CubeScene::new(volume, field(), &transfer).unwrap();
        let detail = Detail::Cubes(5000);
        let mut renderer = Renderer::new(RenderOptions::default());
        check("cubes", &renderer.render_cubes(&cubes, detail, &camera).unwrap().0.image);
        #[cfg(feature = "gpu")]
        for gpu in gpus("every_real_volume") {
            let adapter = gpu.adapter().to_string();
            let memory = cellfan::backends::gpu::GpuCompositor::MEMORY_BYTES;
            let mut renderer = Renderer::on_gpu(RenderOptions::default(), gpu, memory);
            check(&adapter, &renderer.render_cubes(&cubes, detail, &camera).unwrap().0.image);
        }
    }
    assert!(volumes.len() >= 12, "only {} volumes were found", volumes.len());
    assert!(blank.is_empty(), "\n{}", blank.join("\n"));
}
