use tracing_subscriber::layer::SubscriberExt;

use super::*;
use crate::profile::clock::clock_ns;

/// Records what `work` does on this thread.
fn record(most: usize, work: impl FnOnce(&Recorder)) -> Trace {
    let recorder = Recorder::new(most);
    recorder.switch(true);
    tracing::subscriber::with_default(tracing_subscriber::registry().with(recorder.layer()), || work(&recorder));
    recorder.take()
}

#[test]
fn spans_nest_and_name_what_they_are_of() {
    let before = clock_ns();
    let trace = record(10, |_| {
        let _outer = tracing::trace_span!("tile", tile = 7_u64).entered();
        std::thread::sleep(std::time::Duration::from_millis(2));
        let _inner = tracing::debug_span!("stage", name = "sort").entered();
    });
    let [outer, inner] = &trace.spans[..] else { panic!("{trace:?}") };
    assert_eq!((&*outer.name, outer.which, &*inner.name, inner.which), ("tile", Some(("tile", 7)), "sort", None));
    assert!(before <= outer.begin_ns && outer.begin_ns + 2_000_000 <= inner.begin_ns);
    assert!(inner.begin_ns <= inner.end_ns && inner.end_ns <= outer.end_ns && outer.end_ns <= clock_ns());
    assert_eq!(outer.lane, inner.lane);
    let Lane::Thread(thread) = outer.lane else { panic!("{outer:?}") };
    assert!(trace.threads[&thread].contains("spans_nest"), "{:?}", trace.threads);
}

#[test]
fn others_spans_and_what_happens_while_it_is_off_are_left_out() {
    let trace = record(10, |recorder| {
        drop(tracing::trace_span!(target: "cellfanatic", "other").entered());
        drop(tracing::trace_span!(target: "wgpu", "other").entered());
        tracing::trace!(name = "x", begin_ns = 1_u64, end_ns = 2_u64, "no pass");
        recorder.switch(false);
        drop(tracing::trace_span!("off").entered());
        let early = tracing::trace_span!("early");
        recorder.switch(true);
        drop(early.entered());
        drop(tracing::trace_span!("on").entered());
    });
    assert_eq!(trace.spans.iter().map(|span| &*span.name).collect::<Vec<_>>(), ["on"]);
}

#[test]
fn what_is_too_much_is_counted() {
    let recorder = Recorder::new(3);
    recorder.switch(true);
    tracing::subscriber::with_default(tracing_subscriber::registry().with(recorder.layer()), || {
        (0..5).for_each(|_| drop(tracing::trace_span!("span").entered()));
        let trace = recorder.take();
        assert_eq!((trace.spans.len(), trace.lost), (3, 2));
        drop(tracing::trace_span!("span").entered());
    });
    let trace = recorder.take();
    assert_eq!((trace.spans.len(), trace.lost), (1, 0));
}

#[test]
fn threads_and_gpu_have_tracks_of_their_own_in_the_file() {
    let trace = record(100, |_| {
        let dispatch = tracing::dispatcher::get_default(Clone::clone);
        std::thread::scope(|scope| {
            for i in 0..3_u64 {
                let dispatch = &dispatch;
                let thread = std::thread::Builder::new().name(format!("worker {i}"));
                let work = move || {
                    tracing::dispatcher::with_default(dispatch, || {
                        drop(tracing::trace_span!("chunk", chunk = i).entered());
                    });
                };
                thread.spawn_scoped(scope, work).unwrap();
            }
        });
        tracing::trace!(target: GPU_PASS, name = "gpu_draw", begin_ns = 5_000_u64, end_ns = 7_500_u64);
    });
    let mut bytes = Vec::new();
    trace.write(&mut bytes).unwrap();
    let file: serde_json::Value = serde_json::from_slice(&bytes).unwrap();
    let events = file["traceEvents"].as_array().unwrap();
    let of = |ph: &str, name: &str| events.iter().filter(|e| e["ph"] == ph && e["name"] == name).collect::<Vec<_>>();
    let chunks = of("X", "chunk");
    let threads: std::collections::BTreeSet<u64> = chunks.iter().map(|e| e["tid"].as_u64().unwrap()).collect();
    assert_eq!((chunks.len(), threads.len()), (3, 3));
    for chunk in chunks {
        let name = of("M", "thread_name").into_iter().find(|e| e["tid"] == chunk["tid"] && e["pid"] == 1).unwrap();
        assert_eq!(name["args"]["name"], format!("worker {}", chunk["args"]["chunk"]));
    }
    let gpu = of("X", "gpu_draw")[0];
    assert_eq!((gpu["pid"].as_u64(), gpu["ts"].as_f64(), gpu["dur"].as_f64()), (Some(2), Some(5.0), Some(2.5)));
    assert_eq!(of("M", "process_name").len(), 2);
}
