//! Files: what is written is read back, by the decoders of others.

use std::fs;
use std::path::Path;

use super::*;

/// Values of every kind, a different one in every place.
fn picture() -> Image {
    let mut image = Image::filled(5, 3, [0.0; 4]);
    for (i, pixel) in image.pixels.iter_mut().enumerate() {
        let a = i as f32 / 14.0;
        *pixel = [a * 0.75, a * 0.1, -1e-30 * a, a];
    }
    image.pixels[3] = [1e30, f32::INFINITY, f32::MIN_POSITIVE / 4.0, -0.0];
    image.pixels[4] = [f32::from_bits(0x7fc1_2345), f32::NEG_INFINITY, f32::MAX, 1.0];
    image
}

fn bits(values: impl IntoIterator<Item = f32>) -> Vec<u32> {
    values.into_iter().map(f32::to_bits).collect()
}

fn save(image: &Image, path: &Path) {
    image.save(path, &Encoding::default()).unwrap();
}

fn read_npy(path: &Path) -> (Vec<u64>, Vec<f32>) {
    let file = npyz::NpyFile::new(fs::File::open(path).unwrap()).unwrap();
    (file.shape().to_vec(), file.into_vec().unwrap())
}

fn names_in(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn exr_keeps_every_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    save(&picture(), &path);
    let back = ::image::open(&path).unwrap();
    assert_eq!(back.color(), ::image::ColorType::Rgba32F);
    let back = back.into_rgba32f();
    assert_eq!(back.dimensions(), (5, 3));
    assert_eq!(bits(back.into_raw()), bits(picture().pixels.into_flattened()));
}

#[test]
fn npy_keeps_every_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.NPY");
    save(&picture(), &path);
    let (shape, values) = read_npy(&path);
    assert_eq!(shape, [3, 5, 4]);
    assert_eq!(bits(values), bits(picture().pixels.into_flattened()));
}

/// Five bands, whose names do not stand in the order of the alphabet.
fn bands() -> BandImage {
    let names = ["8keV", "1keV", "hard X-ray", "b", "a"].map(String::from).to_vec();
    let values = picture().pixels.into_flattened().into_iter().chain((0..15_u8).map(f32::from)).collect();
    BandImage { width: 5, height: 3, names, values }
}

#[test]
fn bands_keep_every_bit_and_their_names() {
    let folder = tempfile::tempdir().unwrap();
    let bands = bands();
    let path = folder.path().join("a.npy");
    bands.save(&path).unwrap();
    let (shape, values) = read_npy(&path);
    assert_eq!(shape, [3, 5, 5]);
    assert_eq!(bits(values), bits(bands.values.iter().copied()));

    let path = folder.path().join("a.exr");
    bands.save(&path).unwrap();
    let back = ::exr::prelude::read_all_flat_layers_from_file(&path).unwrap();
    let [layer] = &back.layer_data[..] else { panic!("one layer") };
    assert_eq!((layer.size.width(), layer.size.height()), (5, 3));
    let channels = &layer.channel_data.list;
    assert_eq!(channels.len(), 5);
    for (k, name) in bands.names.iter().enumerate() {
        let channel = channels.iter().find(|channel| channel.name.eq(name.as_str())).unwrap();
        let of_band = bands.values.iter().skip(k).step_by(5).copied();
        assert_eq!(bits(channel.sample_data.values_as_f32()), bits(of_band), "{name}");
    }
}

#[test]
fn bands_that_a_file_cannot_hold_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let message = |image: &BandImage, name: &str| image.save(folder.path().join(name)).unwrap_err().to_string();
    assert!(message(&bands(), "a.png").ends_with("a PNG holds no bands; end the name in .exr or .npy"));
    let mut other = bands();
    other.names[2] = "ключ".to_owned();
    assert!(message(&other, "a.exr").contains("cannot have a channel \"ключ\""));
    other.names[2] = "x".repeat(300);
    assert!(message(&other, "a.exr").contains("short name"));
    other.names.pop();
    assert!(message(&other, "a.npy").ends_with("it has 75 values where 5x3 pixels of 4 bands are needed"));
    let none = BandImage { names: vec![], values: vec![], ..bands() };
    assert!(message(&none, "a.exr").ends_with("5x3 pixels of 0 bands is no size of a picture"));
    assert_eq!(names_in(folder.path()), [""; 0]);

    let mut frames = FrameWriter::create(folder.path().join("out.npy"), Encoding::default(), 2).unwrap();
    frames.push(&bands()).unwrap();
    let error = frames.push(&picture()).unwrap_err().to_string();
    assert!(error.ends_with("frame 1 is 5x3 with 4 channels, not 5, the others 5x3"), "{error}");
}

#[test]
fn png_over_a_background_is_opaque() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    let mut image = Image::filled(2, 1, [0.0; 4]);
    image.pixels[1] = [0.25, 0.0, 0.0, 0.5];
    // 0.6 in sRGB, level 153, is 0.31855 linear; half of it, 0.15927, is level 111; 0.25 + 0.15927 is 171.
    image.save(&path, &Encoding { background: Some([0.6; 3]), ..Encoding::default() }).unwrap();
    let shown = ::image::open(&path).unwrap();
    assert_eq!(shown.color(), ::image::ColorType::Rgb8);
    let shown = shown.into_rgb8();
    assert_eq!(shown.get_pixel(0, 0).0, [153; 3]);
    assert_eq!(shown.get_pixel(1, 0).0, [171, 111, 111]);
}

#[test]
fn png_without_background_has_straight_alpha() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    save(&Image::filled(2, 2, [0.4, 0.2, 0.0, 0.4]), &path);
    let shown = ::image::open(&path).unwrap();
    assert_eq!(shown.color(), ::image::ColorType::Rgba8);
    assert_eq!(shown.into_rgba8().get_pixel(1, 1).0, [255, 188, 0, 102]);
}

#[test]
fn png_of_transmitted_intensities_is_opaque_and_has_no_background() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    let image = Image::filled(1, 1, [1.0, 0.5, 0.0, 0.25]);
    let encoding = Encoding { background: Some([1.0, 0.0, 1.0]), ..Encoding::TRANSMITTED };
    image.save(&path, &encoding).unwrap();
    let shown = ::image::open(&path).unwrap();
    assert_eq!(shown.color(), ::image::ColorType::Rgb8);
    assert_eq!(shown.into_rgb8().get_pixel(0, 0).0, [255, 188, 0]);
}

#[test]
fn errors_say_what_to_do_and_leave_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let message = |image: &Image, name: &str, encoding: &Encoding| {
        image.save(folder.path().join(name), encoding).unwrap_err().to_string()
    };
    let (image, plain) = (picture(), Encoding::default());
    let error = message(&image, "a.jpeg", &plain);
    assert!(error.ends_with("a.jpeg: could not encode the picture: \".jpeg\" is no picture format here; end the name in .png, .exr or .npy"), "{error}");
    let error = message(&image, "a", &plain);
    assert!(error.ends_with("a name without an extension says no format; end it in .png, .exr or .npy"), "{error}");
    let error = message(&image, "a.png", &Encoding { background: Some([0.0, f32::NAN, 0.0]), ..plain });
    assert_eq!(error, "--background: [0.0, NaN, 0.0] is not a colour; give R,G,B as sRGB values from 0 to 1");
    for name in ["a.png", "a.exr", "a.npy"] {
        let error = message(&Image { width: 0, height: 7, pixels: vec![] }, name, &plain);
        assert!(error.ends_with("0x7 is no size of a picture"), "{error}");
        let error = message(&Image { width: 2, height: 7, pixels: vec![] }, name, &plain);
        assert!(error.ends_with("it has 0 pixels where 2x7 are needed"), "{error}");
        let error = message(&image, &format!("missing/{name}"), &plain);
        assert!(error.contains("there is no folder"), "{error}");
    }
    assert_eq!(names_in(folder.path()), [""; 0]);
}

#[test]
fn frames_are_numbered() {
    let folder = tempfile::tempdir().unwrap();
    let mut frames = FrameWriter::create(folder.path().join("out.v1.png"), Encoding::default(), 2).unwrap();
    frames.push(&picture()).unwrap();
    frames.push(&picture()).unwrap();
    let error = frames.push(&picture()).unwrap_err().to_string();
    assert!(error.ends_with("there are more than the 2 frames announced"), "{error}");
    frames.finish().unwrap();
    assert_eq!(names_in(folder.path()), ["out.v1.0000.png", "out.v1.0001.png"]);
    assert_eq!(frame_path("out.exr", 12_345), Path::new("out.12345.exr"));
}

#[test]
fn npy_stacks_frames() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.npy");
    let other = Image::filled(5, 3, [0.5; 4]);
    let mut frames = FrameWriter::create(&path, Encoding::default(), 2).unwrap();
    frames.push(&picture()).unwrap();
    let error = frames.push(&Image::filled(3, 5, [0.0; 4])).unwrap_err().to_string();
    assert!(error.ends_with("frame 1 is 3x5, the others 5x3"), "{error}");
    frames.push(&other).unwrap();
    frames.finish().unwrap();
    let (shape, values) = read_npy(&path);
    assert_eq!(shape, [2, 3, 5, 4]);
    let expected = [picture().pixels, other.pixels].concat().into_flattened();
    assert_eq!(bits(values), bits(expected));
}

#[test]
fn unfinished_stack_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let mut frames = FrameWriter::create(folder.path().join("out.npy"), Encoding::default(), 3).unwrap();
    frames.push(&picture()).unwrap();
    let error = frames.finish().unwrap_err().to_string();
    assert!(error.ends_with("only 1 of 3 frames were drawn"), "{error}");
    assert_eq!(names_in(folder.path()), [""; 0]);
}
