//! A trace: what each thread did when, and the GPU, for [ui.perfetto.dev](https://ui.perfetto.dev) or `chrome://tracing` (feature `trace`).
//!
//! In: `tracing` spans of this crate, through a [`Recorder`]'s layer; passes of GPUs, as events at `trace` level with the target
//! [`GPU_PASS`]. Out: a [`Trace`], whose file is in the Trace Event Format (Duffy, Google, 2016: "Trace Event Format").
//! Where no layer asks for them, a span costs the load of a constant and a branch.

mod file;
mod layer;

use std::borrow::Cow;
use std::cell::Cell;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use layer::SpanLayer;
use tracing::Subscriber;
use tracing_subscriber::Layer;
use tracing_subscriber::filter::{LevelFilter, filter_fn};
use tracing_subscriber::registry::LookupSpan;

use super::GPU_PASS;

/// Where something happened.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Lane {
    /// On a thread, in the order in which they were first seen.
    Thread(u32),
    /// On the GPU.
    Gpu,
}

/// Something that took a while.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TraceSpan {
    /// What.
    pub name: Cow<'static, str>,
    /// Where.
    pub lane: Lane,
    /// When it began, in nanoseconds on the process's clock.
    pub begin_ns: u64,
    /// When it ended.
    pub end_ns: u64,
    /// Which one: the tile, the chunk, the frame.
    pub which: Option<(&'static str, u64)>,
}

/// What a [`Recorder`] saw.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Trace {
    /// By lane and time of beginning; what encloses something comes before it.
    pub spans: Vec<TraceSpan>,
    /// Names of threads.
    pub threads: BTreeMap<u32, String>,
    /// Spans that were more than the recorder holds.
    pub lost: u64,
}

/// Records spans while it is on.
///
/// ```
/// use cellfan::profile::trace::Recorder;
/// use tracing_subscriber::layer::SubscriberExt;
/// let recorder = Recorder::new(1000);
/// let subscriber = tracing_subscriber::registry().with(recorder.layer());
/// tracing::subscriber::with_default(subscriber, || {
///     recorder.switch(true);
///     cellfan::profile::Profile::default().time("cull", || ());
/// });
/// let trace = recorder.take();
/// assert_eq!((trace.spans.len(), &*trace.spans[0].name), (1, "cull"));
/// ```
#[derive(Clone, Debug)]
pub struct Recorder(Arc<Shared>);

/// Threads write to the part that their number says, so that they seldom meet.
const PARTS: usize = 64;

#[derive(Debug)]
struct Shared {
    is_on: AtomicBool,
    parts: [Mutex<Vec<TraceSpan>>; PARTS],
    threads: Mutex<BTreeMap<u32, String>>,
    /// Spans held, and the most of them.
    held: AtomicUsize,
    most: usize,
    lost: AtomicU64,
}

impl Recorder {
    /// Spans that a recorder of the program holds: some 300 MB of memory and as much of file.
    pub const MOST: usize = 3_000_000;

    /// Holds at most `most` spans, 72 bytes each, and counts the others. It is off.
    pub fn new(most: usize) -> Self {
        Self(Arc::new(Shared {
            is_on: AtomicBool::new(false),
            parts: std::array::from_fn(|_| Mutex::default()),
            threads: Mutex::default(),
            held: AtomicUsize::new(0),
            most,
            lost: AtomicU64::new(0),
        }))
    }

    /// The layer that it sees spans through.
    pub fn layer<S: Subscriber + for<'a> LookupSpan<'a>>(&self) -> impl Layer<S> + use<S> {
        let is_ours = |metadata: &tracing::Metadata<'_>| {
            let target = metadata.target();
            if metadata.is_span() { target == "cellfan" || target.starts_with("cellfan::") } else { target == GPU_PASS }
        };
        SpanLayer(self.clone()).with_filter(filter_fn(is_ours).with_max_level_hint(LevelFilter::TRACE))
    }

    /// Records from now on, or no more. Spans that have begun before are left out.
    pub fn switch(&self, on: bool) {
        self.0.is_on.store(on, Ordering::Relaxed);
    }

    fn is_on(&self) -> bool {
        self.0.is_on.load(Ordering::Relaxed)
    }

    /// What was recorded since it was last taken.
    pub fn take(&self) -> Trace {
        let mut spans: Vec<TraceSpan> = self.0.parts.iter().flat_map(|part| std::mem::take(&mut *lock(part))).collect();
        self.0.held.store(0, Ordering::Relaxed);
        spans.sort_by_key(|span| (span.lane, span.begin_ns, std::cmp::Reverse(span.end_ns)));
        Trace { spans, threads: lock(&self.0.threads).clone(), lost: self.0.lost.swap(0, Ordering::Relaxed) }
    }

    fn push(&self, span: TraceSpan) {
        if self.0.held.fetch_add(1, Ordering::Relaxed) >= self.0.most {
            self.0.lost.fetch_add(1, Ordering::Relaxed);
            return;
        }
        lock(&self.0.parts[thread_number() as usize % PARTS]).push(span);
    }

    /// The lane of this thread, whose name is noted.
    fn lane(&self) -> Lane {
        let number = thread_number();
        thread_local!(static NAMED: Cell<*const Shared> = const { Cell::new(std::ptr::null()) });
        // Once a thread and recorder; a map that has the name already does not mind.
        if NAMED.get() != Arc::as_ptr(&self.0) {
            NAMED.set(Arc::as_ptr(&self.0));
            let name = std::thread::current().name().map_or_else(|| format!("thread {number}"), str::to_owned);
            lock(&self.0.threads).insert(number, name);
        }
        Lane::Thread(number)
    }
}

/// Threads in the order in which they first asked.
fn thread_number() -> u32 {
    static NEXT: AtomicU32 = AtomicU32::new(0);
    thread_local!(static NUMBER: u32 = NEXT.fetch_add(1, Ordering::Relaxed));
    NUMBER.with(|&number| number)
}

/// What a thread that panicked had pushed is whole.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests;
