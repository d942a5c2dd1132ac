//! `--backend gpu`, `--adapter`, `--gpu-memory`.

use serde_json::json;

use super::gpus::gpus;
use super::{Place, Ran};

/// Runs `render mesh.vtu` with the drivers of this machine.
fn render(place: &Place, more: &str) -> Ran {
    let mut command = place.command();
    command.env_remove("VK_DRIVER_FILES").args(["render", "mesh.vtu", "--size", "48x40"]);
    Ran::of(command.args(more.split_whitespace()).output().unwrap())
}

#[test]
fn a_gpu_draws_and_says_so() {
    if gpus("a_gpu_draws_and_says_so").is_empty() {
        return;
    }
    let place = Place::with_mesh();
    let ran = render(&place, "-o gpu.npy --backend gpu --frames 2 --stats stats.json").succeeds();
    assert!(ran.err.contains("drawn on "), "{}", ran.err);
    let stats: serde_json::Value = serde_json::from_slice(&place.read("stats.json")).unwrap();
    assert_eq!(stats["backend"], json!("gpu"));
    assert!(ran.err.contains(stats["adapter"].as_str().unwrap()));
    assert_eq!(stats["order"]["exactness"], json!("exact"));
    let by_class = &stats["cells"]["by_class"];
    assert!(by_class["class1"].as_u64().unwrap() > 0 && by_class["class2"].as_u64().unwrap() > 0);
    for stage in ["project", "cull", "sort", "fans", "submit", "wait_for_gpu", "read_back"] {
        assert!(stats["stages"][stage]["ms"].is_f64(), "{stage}: {}", stats["stages"]);
    }
    let ran = render(&place, "-o gpu.png --backend gpu -q").succeeds();
    assert_eq!(ran.err, "");
}

#[test]
fn what_a_gpu_cannot_do_is_refused_or_left_to_the_cpu() {
    if gpus("what_a_gpu_cannot_do_is_refused_or_left_to_the_cpu").is_empty() {
        return;
    }
    let place = Place::with_mesh();
    render(&place, "-o a.png --backend gpu --adapter nobody-makes-this")
        .fails(2, &["nobody-makes-this", "there are: "]);
    render(&place, "-o a.png --backend gpu --gpu-memory 1k")
        .fails(1, &["--gpu-memory: 1000 bytes; this picture takes"]);
    let ran = render(&place, "-o a.png --backend auto --adapter llvmpipe --gpu-memory 1k").succeeds();
    assert!(ran.err.contains("CPU"), "{}", ran.err);
    for option in ["--memory 1Gi", "--cpu-method fans"] {
        let ran = render(&place, &format!("-o a.png --backend gpu {option}"));
        ran.fails(1, &["--backend gpu", option.split(' ').next().unwrap()]);
        render(&place, &format!("-o a.png --backend auto --adapter nobody {option}")).succeeds();
    }
    let ran = render(&place, "-o b.png --backend auto --adapter nobody-makes-this").succeeds();
    assert!(ran.err.contains("drawn on the CPU") && ran.err.contains("nobody-makes-this"), "{}", ran.err);
    assert_eq!(place.names(), ["a.png", "b.png", "mesh.vtu"]);
}
