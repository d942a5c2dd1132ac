//! Scatter: several writers into one lent slice. Each place is written once, by whoever the prefix sum gave it to; places of
//! different writers interleave, so the slice cannot be split. Relaxed atomic stores are plain stores that may race.
#![expect(
    unsafe_code,
    reason = "a &mut [u64] is lent as &[AtomicU64]; the standard library's own cast is not stable yet"
)]

use std::sync::atomic::AtomicU64;

/// Lends `words` to several writers at once.
pub fn as_atomic(words: &mut [u64]) -> &[AtomicU64] {
    const { assert!(size_of::<AtomicU64>() == size_of::<u64>() && align_of::<AtomicU64>() == align_of::<u64>()) };
    // SAFETY: AtomicU64 has the same in-memory representation as u64 (documented by the standard library; size and
    // alignment asserted above), and the exclusive borrow keeps every non-atomic access away while the result lives.
    unsafe { &*(std::ptr::from_mut(words) as *const [AtomicU64]) }
}
