//! `render --method depth-planes` and its options.

use super::{Place, npy};

impl Place {
    /// A folder with `v.nrrd`, a small volume.
    fn with_volume() -> Self {
        let place = Self::new();
        place.run(["generate", "volume", "--cells", "4000", "-o", "v.nrrd"]).succeeds();
        place
    }

    fn planes(&self, more: &str) -> super::Ran {
        let first = ["render", "v.nrrd", "--method", "depth-planes", "--size", "48x40"];
        self.run(first.into_iter().chain(more.split_whitespace()))
    }
}

#[test]
fn every_option_draws_another_picture() {
    let place = Place::with_volume();
    let image = |more: &str| {
        place.planes(&format!("-o out.npy {more}")).succeeds();
        let (shape, pixels) = npy(&place.path("out.npy"));
        assert_eq!(shape, [40, 48, 4], "{more}");
        assert!(pixels.chunks(4).filter(|pixel| pixel[3] > 0.01).count() > 300, "{more}");
        pixels
    };
    let plain = image("");
    for more in [
        "--classify pre",
        "--filter b-spline",
        "--filter catmull-rom",
        "--samples 24,auto,7",
        "--sample-rate 0.5",
        "--render-scale 0.5",
        "--vol-compat",
        "--opacity-threshold 0.05",
        "--shade",
        "--ambient 0.9",
        "--light 1,0,0:1,0,0 --light 0,0,1",
        "--strength",
        "--shadows",
        "--surface --edges",
        "--view 10,50",
    ] {
        let differs = |(a, b): (&f32, &f32)| (a - b).abs() > 1e-3;
        assert!(plain.iter().zip(&image(more)).any(differs), "{more}");
    }
    // The cells' own renderer shows about the same.
    place.run("render v.nrrd --size 48x40 --backend cpu -o cells.npy".split(' ')).succeeds();
    let (_, cells) = npy(&place.path("cells.npy"));
    let off: f32 = cells.iter().zip(&plain).map(|(a, b)| (a - b).abs()).sum::<f32>() / cells.len() as f32;
    assert!(off < 0.02, "{off}");
}

#[test]
fn planes_are_written_one_by_one() {
    let place = Place::with_volume();
    place.planes("--samples pixels,pixels,9 --cross-sections -o planes.npy").succeeds();
    assert_eq!(npy(&place.path("planes.npy")).0, [9, 40, 48, 4]);
    place.planes("--samples pixels,pixels,2 --cross-sections -o p.png").succeeds();
    assert!(place.names().contains(&"p.0001.png".to_owned()));
}

#[test]
fn what_does_not_fit_is_refused() {
    let place = Place::with_mesh();
    place.run(["generate", "volume", "--cells", "100", "-o", "v.nrrd"]).succeeds();
    let names = place.names();
    for (more, part) in [
        ("--bands b.csv", "--method cells"),
        ("--memory 1G", "--method cells"),
        ("--backend gpu", "on the CPU"),
        ("--filter b-spline --classify pre", "--classify post"),
        ("--samples 1,2", "X,Y,PLANES"),
        ("--samples 1,2,pixels", "X,Y,PLANES"),
        ("--light 0,0,0", "null"),
        ("--shade --model mip", "reflected"),
        ("--sample-rate 0", "above 0"),
        ("--opacity-threshold 1", "--opacity-threshold"),
        ("--cross-sections --frames 2", "--frames"),
    ] {
        place.planes(&format!("-o out.png {more}")).fails(1, &[part]);
    }
    place.render("--method depth-planes -o out.png").fails(1, &["regular grid"]);
    place.render("--shade --model mip -o out.png").fails(1, &["--shade", "reflected"]);
    place.render("--cross-sections -o out.npy").fails(1, &["--cross-sections", "depth-planes"]);
    assert_eq!(place.names(), names);
}
