use std::time::Duration;

use super::super::{FrameRecord, Profile, Track};
use super::*;

fn report(frames: u32) -> Report {
    let mut report = Report::default();
    report.mesh.name = "a<b> & \"c\".vtu".to_owned();
    report.views.orbit_degrees = 360.0;
    for view in 0..frames {
        let mut profile = Profile::default();
        profile.add("cull", Duration::from_millis(2), 0);
        profile.add("composite", Duration::from_micros(6000 + 1000 * u64::from(view % 4)), 0);
        profile.add_beside(Track::Gpu, "gpu_draw", Duration::from_millis(5), 0);
        report.frames.push(FrameRecord::new(view, 11.0 + f64::from(view % 4), &profile));
    }
    report
}

/// The texts of a picture, and how many elements of each name it has, by a parser of XML.
fn parsed(svg: &str) -> (Vec<String>, std::collections::HashMap<String, usize>) {
    use quick_xml::events::Event;
    let (mut texts, mut counts, mut text) = (Vec::new(), std::collections::HashMap::new(), String::new());
    let mut reader = quick_xml::Reader::from_str(svg);
    loop {
        match reader.read_event().unwrap() {
            Event::Start(start) | Event::Empty(start) => {
                *counts.entry(start.name().as_ref().to_owned()).or_insert(0) += 1;
                text.clear();
            }
            Event::Text(part) => text.push_str(&part),
            Event::GeneralRef(name) => text.push_str(match &*name {
                "lt" => "<",
                "gt" => ">",
                "amp" => "&",
                "quot" => "\"",
                other => panic!("{other:?}"),
            }),
            Event::End(_) => texts.push(std::mem::take(&mut text)),
            Event::Eof => return (texts, counts),
            _ => {}
        }
    }
}

#[test]
fn svg_holds_what_was_measured() {
    let (texts, counts) = parsed(&report(100).to_svg());
    for expected in [
        "a<b> & \"c\".vtu: 0 cells, 100 frames over 360 degrees",
        "frames a second",
        "milliseconds a frame",
        "composite",
        "cull",
        "other",
        "gpu_draw",
        "90",
        "324°",
    ] {
        assert!(texts.iter().any(|text| text == expected), "{expected}: {texts:?}");
    }
    assert!(texts.iter().any(|text| text == "median 80.0"), "{texts:?}");
    // Two stages and the rest; rates, the frame and the GPU.
    assert_eq!((counts["polygon"], counts["polyline"]), (3, 3));
}

#[test]
fn a_frame_far_above_the_others_is_cut_and_named() {
    let mut report = report(100);
    report.frames[30].ms = 1000.0;
    let (texts, counts) = parsed(&report.to_svg());
    assert!(texts.iter().any(|text| text == "1000.0 ms"));
    assert_eq!(counts["polygon"], 4);
}

#[test]
fn few_frames_and_none() {
    for frames in [0, 1, 2] {
        let svg = report(frames).to_svg();
        parsed(&svg);
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }
    let mut still = report(1);
    still.frames[0] = FrameRecord::new(0, 0.0, &Profile::default());
    assert!(!still.to_svg().contains("NaN"));
}

#[cfg(feature = "plot")]
#[test]
fn png_shows_areas_and_letters_without_any_font_of_the_system() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plot.png");
    report(100).save_plot(&path).unwrap();
    let picture = ::image::open(&path).unwrap().into_rgba8();
    assert_eq!(picture.dimensions(), (2400, 1440));
    let ink = |[left, top, width, height]: [u32; 4]| {
        let pixels = (left..left + width).flat_map(|x| (top..top + height).map(move |y| (x, y)));
        pixels.filter(|&(x, y)| picture.get_pixel(x, y).0[..3].iter().all(|&c| c < 0x60)).count()
    };
    // The title, and nothing above it.
    assert!(ink([144, 36, 900, 40]) > 1000, "{}", ink([144, 36, 900, 40]));
    assert_eq!(ink([0, 0, 2400, 20]), 0);
    // Composite's area at its colour.
    assert_eq!(picture.get_pixel(1000, 2 * 500).0, [0xf2, 0x8e, 0x2b, 0xff]);
}

#[test]
fn other_formats_are_refused() {
    let error = report(1).save_plot("plot.pdf").unwrap_err().to_string();
    assert!(error.contains("plots are written as .svg or .png"), "{error}");
}
