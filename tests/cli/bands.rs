//! `--bands` and `--output`.

use std::path::Path;

use super::{Place, npy};

const TABLE: &str = "s soft hard x y z\n0 0 0 0 0 1\n1 50 20 10 5 1\n";

/// Names of an EXR's channels and the values of each.
fn exr(path: &Path) -> Vec<(String, Vec<f32>)> {
    let image = exr::prelude::read_all_flat_layers_from_file(path).unwrap();
    let channels = &image.layer_data[0].channel_data.list;
    channels.iter().map(|c| (c.name.to_string(), c.sample_data.values_as_f32().collect())).collect()
}

#[test]
fn any_number_of_bands_by_name() {
    let place = Place::with_mesh();
    place.write("bands.csv", TABLE);
    let ran = place.render("-o out.npy --model absorption --bands bands.csv").succeeds();
    assert!(ran.err.contains("5 bands of bands.csv") && ran.err.contains("order not needed"), "{}", ran.err);
    let (shape, intensities) = npy(&place.path("out.npy"));
    assert_eq!(shape, [40, 48, 5]);
    place.render("-o out.exr --model absorption --bands bands.csv --output depth").succeeds();
    let channels = exr(&place.path("out.exr"));
    let names: Vec<&str> = channels.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["hard", "soft", "x", "y", "z"]);
    let mut covered = 0;
    for (name, depths) in &channels {
        let band = ["soft", "hard", "x", "y", "z"].iter().position(|band| band == name).unwrap();
        for (depth, intensity) in depths.iter().zip(intensities.iter().skip(band).step_by(5)) {
            assert!(((-depth).exp() - intensity).abs() < 1e-6, "{name}: {depth}, {intensity}");
            covered += usize::from(*depth > 0.01);
        }
    }
    assert!(covered > 1000, "{covered}");

    place.render("-o out.png --model absorption --bands bands.csv").succeeds();
    let shown = image::open(place.path("out.png")).unwrap().into_rgb8();
    let dark = |channel: usize| shown.pixels().map(|pixel| u64::from(pixel.0[channel])).sum::<u64>();
    assert!(dark(0) < dark(1) && dark(1) < dark(2), "the softest band is the darkest");
    place.render("-o turn.npy --model absorption --bands bands.csv --frames 3").succeeds();
    assert_eq!(npy(&place.path("turn.npy")).0, [3, 40, 48, 5]);
}

#[test]
fn arrays_three_channels_and_plain_depths() {
    let place = Place::with_mesh();
    let ran =
        place.render("-o out.npy --model absorption --bands array:cell_value,point:value --output depth").succeeds();
    assert!(ran.err.contains("bands cell_value, point:value"), "{}", ran.err);
    let (shape, depths) = npy(&place.path("out.npy"));
    assert_eq!(shape, [40, 48, 2]);
    // Both are the same field, once constant in cells.
    let sum = |band: usize| depths.iter().skip(band).step_by(2).sum::<f32>();
    assert!(sum(0) > 10.0 && (sum(0) / sum(1) - 1.0).abs() < 0.2, "{} {}", sum(0), sum(1));

    place.write(
        "rgb.json",
        r#"{"points": [{"value": 0, "extinctions": [0, 0, 0]}, {"value": 1, "extinctions": [90, 9, 0]}]}"#,
    );
    place.render("-o out.npy --bands rgb.json").succeeds();
    let (shape, pixels) = npy(&place.path("out.npy"));
    let sum = |channel: usize| pixels.iter().skip(channel).step_by(4).sum::<f32>();
    assert_eq!(shape, [40, 48, 4]);
    assert!(sum(0) > 10.0 && sum(3) > 10.0 && sum(2).to_bits() == 0, "{} {} {}", sum(0), sum(2), sum(3));

    place.render("-o intensity.npy --model absorption").succeeds();
    place.render("-o depth.npy --model absorption --output depth").succeeds();
    let [intensity, depth] = ["intensity.npy", "depth.npy"].map(|name| npy(&place.path(name)).1);
    assert!(intensity.iter().zip(&depth).all(|(i, d)| ((-d).exp() - i).abs() < 1e-6));
    assert_eq!((depth[0].to_bits(), intensity[0].to_bits()), (0, 1.0_f32.to_bits()), "a miss");
}

#[test]
fn what_makes_no_sense_is_refused_before_anything_is_written() {
    let place = Place::with_mesh();
    place.write("bands.csv", TABLE);
    place.write("bad.csv", "0 1\n1 -1\n");
    let before = place.names();
    for (arguments, parts) in [
        ("-o a.png --model absorption --output depth", &["--output: a PNG cannot show optical depths"][..]),
        ("-o a.npy --output depth", &["--output", "emission-absorption"]),
        ("-o a.npy --model absorption --output tau", &["intensity", "depth"]),
        ("-o a.npy --model mip --bands bands.csv", &["--bands: mip has no bands"]),
        ("-o a.npy --bands bands.csv", &["takes 3 bands", "there are 5"]),
        ("-o a.npy --bands array:value", &["from a table"]),
        ("-o a.npy --model absorption --bands bad.csv", &["bad.csv: bands: line 2: extinction of \"band1\" is -1"]),
        ("-o a.npy --model absorption --bands none.csv", &["none.csv"]),
        ("-o a.npy --model absorption --bands value", &["there is no file \"value\"", "array:NAME"]),
        ("-o a.npy --model absorption --bands array:value --array value", &["leave out --array"]),
        ("-o a.npy --model absorption --bands array:value,nothing", &["there is no array \"nothing\""]),
        ("-o a.npy --model absorption --bands array:", &["there is no array \"\""]),
        ("-o a.npy --model absorption --bands array:value,value", &["two bands are called \"value\""]),
    ] {
        place.render(arguments).fails(1, parts);
        assert_eq!(place.names(), before, "{arguments}");
    }
}
