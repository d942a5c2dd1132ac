//! `--memory`: the same picture within a budget, or an error that says how much would do.

use serde_json::Value;

use super::{Place, Ran};

/// Cells of the mesh that is large enough for its frame to be seen beside the program itself.
const CELLS: &str = "1200000";

/// Draws two frames of `mesh.vtu` at 512x512 with more arguments.
fn draw(place: &Place, out: &str, more: &str) -> Ran {
    let fixed = "render mesh.vtu --size 512x512 --frames 2 --orbit 40 --threads 2 --stats stats.json -q -o";
    place.run(fixed.split_whitespace().chain([out]).chain(more.split_whitespace()))
}

fn stats(place: &Place) -> Value {
    serde_json::from_slice(&place.read("stats.json")).unwrap()
}

/// The bytes that an error says would do.
fn needed(error: &str) -> u64 {
    let (_, rest) = error.split_once("takes ").unwrap_or_else(|| panic!("{error}"));
    rest.split(';').next().unwrap().parse().unwrap_or_else(|_| panic!("{error}"))
}

#[test]
fn any_budget_gives_the_same_picture_and_counts_and_is_kept() {
    let place = Place::new();
    place.run(["generate", "tets", "--cells", CELLS, "-o", "mesh.vtu"]).succeeds();
    draw(&place, "free.npy", "").succeeds();
    let free = stats(&place);
    assert!(free["memory_bytes"].is_null());

    // What would do, found by asking for nothing and then for what each error names.
    let (mut least, mut asked) = (1000, 0);
    loop {
        let ran = draw(&place, "out.npy", &format!("--memory {least}"));
        if ran.code == Some(0) {
            break;
        }
        ran.fails(1, &["--memory", "bytes are not enough"]);
        assert!(!place.path("out.npy").exists());
        // The rest of the process is measured, and differs by some pages from run to run.
        least = needed(&ran.err) + (1 << 20);
        asked += 1;
        assert!(asked <= 4, "{}", ran.err);
    }
    // All pairs of a frame at once, and what is left of that: 8 bytes a pair, about 1.2 pairs a cell.
    let pairs = 12_000_000;
    let mut bands_ms = Vec::new();
    for budget in [least, least + pairs / 4, least + pairs / 2, least + pairs, 4 * least] {
        draw(&place, "out.npy", &format!("--memory {budget}")).succeeds();
        assert!(place.read("out.npy") == place.read("free.npy"), "{budget}: another picture");
        let stats = stats(&place);
        for count in ["cells", "order", "triangles"] {
            assert_eq!(stats[count], free[count], "{budget}");
        }
        assert_eq!(stats["memory_bytes"].as_u64(), Some(budget));
        if let Some(peak) = stats["peak_anonymous_bytes"].as_u64() {
            assert!(peak <= budget, "{peak} bytes are held of {budget}");
        }
        bands_ms.push((budget, stats["frame_ms"].as_f64()));
    }
    println!("free {:?} ms, {:?} bytes; budgets {bands_ms:?}", free["frame_ms"], free["peak_anonymous_bytes"]);
}

#[test]
fn what_keeps_no_budget_says_so() {
    let place = Place::with_mesh();
    for more in ["--cpu-method fans", "--check-order"] {
        place.render(&format!("-o out.png --memory 1G {more}")).fails(1, &["--memory", "keep no budget"]);
    }
    for bad in ["1X", "-5", "lots"] {
        place.render(&format!("-o out.png --memory {bad}")).fails(1, &["--memory", "Ki, Mi, Gi"]);
    }
    assert_eq!(place.names(), ["mesh.vtu"]);
    place.render("-o out.png --memory 1Gi").succeeds();
}
