//! An allocator that counts: how much a reader held at most, and a refusal of what no reader may ask for.
#![expect(unsafe_code, reason = "a global allocator is unsafe to implement; this one hands everything to the system's")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// A single request beyond this is refused, as a system under a memory limit would: code that copes gives an error, all
/// other code aborts.
pub(crate) const LARGEST_REQUEST: usize = 4 << 30;

static HELD: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);

struct Counting;

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// What one thread allocated.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Allocated {
    /// Bytes that it allocated and did not free; other threads may have freed them.
    pub(crate) held: isize,
    /// The most of these at once.
    pub(crate) peak: isize,
    /// The largest of its requests.
    pub(crate) largest: usize,
}

thread_local! {
    static HERE: Cell<Allocated> = const { Cell::new(Allocated { held: 0, peak: 0, largest: 0 }) };
}

fn note_here(change: isize) {
    // A thread that ends frees its last bytes when its counts are gone.
    let _ = HERE.try_with(|here| {
        let Allocated { held, peak, largest } = here.get();
        let held = held + change;
        here.set(Allocated { held, peak: peak.max(held), largest: largest.max(change.max(0) as usize) });
    });
}

/// The result of `run`, and what it allocated on this thread.
pub(crate) fn here<T>(run: impl FnOnce() -> T) -> (T, Allocated) {
    let before = HERE.replace(Allocated::default());
    let result = run();
    let counted = HERE.get();
    HERE.set(Allocated { held: before.held + counted.held, ..before });
    (result, counted)
}

fn add(bytes: usize) {
    note_here(bytes as isize);
    let held = HELD.fetch_add(bytes, Relaxed) + bytes;
    PEAK.fetch_max(held, Relaxed);
}

/// Runs `request` of `bytes` if it is not too large; what comes back is counted.
fn ask(bytes: usize, request: impl FnOnce() -> *mut u8) -> *mut u8 {
    if bytes > LARGEST_REQUEST {
        // If this is fatal, the harness has to say with which input.
        crate::harness::save_before_abort();
        return std::ptr::null_mut();
    }
    let start = request();
    if !start.is_null() {
        add(bytes);
    }
    start
}

// SAFETY: every call goes to the system's allocator with the arguments that came, or returns null, which the trait
// allows; counting allocates nothing.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's obligations are those of `System`.
        ask(layout.size(), || unsafe { System.alloc(layout) })
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as above.
        ask(layout.size(), || unsafe { System.alloc_zeroed(layout) })
    }

    unsafe fn realloc(&self, start: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: as above. While it moves, old and new are both held, which the peak is to show.
        let moved = ask(size, || unsafe { System.realloc(start, layout, size) });
        if !moved.is_null() {
            note_here(-(layout.size() as isize));
            HELD.fetch_sub(layout.size(), Relaxed);
        }
        moved
    }

    unsafe fn dealloc(&self, start: *mut u8, layout: Layout) {
        note_here(-(layout.size() as isize));
        HELD.fetch_sub(layout.size(), Relaxed);
        // SAFETY: as above.
        unsafe { System.dealloc(start, layout) }
    }
}

/// The result of `run`, and the most bytes held while it ran beyond those held before.
pub(crate) fn peak_of<T>(run: impl FnOnce() -> T) -> (T, usize) {
    let before = HELD.load(Relaxed);
    PEAK.store(before, Relaxed);
    let result = run();
    (result, PEAK.load(Relaxed).saturating_sub(before))
}
