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
fn light_of_arrays_is_white_and_of_more_bands_in_layers() {
    let place = Place::with_mesh();
    place.render("-o out.exr --bands bands.csv").fails(1, &["bands.csv"]);
    place.write("bands.csv", TABLE);
    place.render("-o out.exr --bands bands.csv").succeeds();
    let channels = exr(&place.path("out.exr"));
    assert_eq!(channels.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), ["hard", "soft", "x", "y", "z"]);
    let sum = |of: &str| channels.iter().find(|(name, _)| name == of).unwrap().1.iter().sum::<f32>();
    // White both: the one of more extinction where the mesh is has more light.
    assert!(sum("z") > sum("y") && sum("y") > 10.0, "{} {}", sum("y"), sum("z"));
    place.render("-o out.png --bands bands.csv").succeeds();

    // One cell, a bit more than one unit thick in the middle, of three extinctions.
    place.write(
        "cell.vtk",
        "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n0 0 0 2 0 0 0 2 0 0 0 2\n\
         CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\nCELL_DATA 1\nSCALARS a float\nLOOKUP_TABLE default\n0.5\n\
         SCALARS b float\nLOOKUP_TABLE default\n2\nSCALARS c float\nLOOKUP_TABLE default\n0\n",
    );
    let ran = place.run("render cell.vtk --size 20x20 -o out.npy --bands array:a,b,c".split_whitespace()).succeeds();
    assert!(ran.err.contains("white, bands a, b, c"), "{}", ran.err);
    let (shape, pixels) = npy(&place.path("out.npy"));
    assert_eq!(shape, [20, 20, 4]);
    let mut covered = 0;
    for pixel in pixels.chunks_exact(4).filter(|pixel| pixel[0] > 0.0) {
        // White light is opacity: 1 - T, and T of b is that of a to the fourth.
        let [a, b, c, alpha] = [pixel[0], pixel[1], pixel[2], pixel[3]];
        assert!(((1.0 - a).powi(4) - (1.0 - b)).abs() < 1e-5 && c.to_bits() == 0, "{pixel:?}");
        assert!((alpha - (a + b) / 3.0).abs() < 1e-6, "{pixel:?}");
        covered += 1;
    }
    assert!(covered > 50, "{covered}");
    place
        .run("render cell.vtk --size 20x20 -o red.npy --bands array:a,b,c --transfer red.csv".split_whitespace())
        .fails(1, &["red.csv"]);
    place.write("red.csv", "0 1 0 0 1\n");
    place
        .run("render cell.vtk --size 20x20 -o red.npy --bands array:a,b,c --transfer red.csv".split_whitespace())
        .succeeds();
    let red = npy(&place.path("red.npy")).1;
    let pairs = red.chunks_exact(4).zip(pixels.chunks_exact(4));
    assert!(
        pairs
            .into_iter()
            .all(|(red, white)| [red[0], 0.0, red[3]].map(f32::to_bits)
                == [white[0], red[1], white[3]].map(f32::to_bits))
    );
}

#[test]
fn what_makes_no_sense_is_refused_before_anything_is_written() {
    let place = Place::with_mesh();
    place.write("bands.csv", TABLE);
    place.write("bad.csv", "0 1\n1 -1\n");
    place.write("two.csv", "0 1 2\n");
    let before = place.names();
    for (arguments, parts) in [
        ("-o a.png --model absorption --output depth", &["--output: a PNG cannot show optical depths"][..]),
        ("-o a.npy --output depth", &["--output", "emission-absorption"]),
        ("-o a.npy --model absorption --output tau", &["intensity", "depth"]),
        ("-o a.npy --model mip --bands bands.csv", &["--bands: mip has no bands"]),
        ("-o a.npy --bands two.csv", &["takes 3 bands or more", "there are 2"]),
        ("-o a.npy --bands array:value", &["takes 3 bands or more", "there are 1"]),
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
