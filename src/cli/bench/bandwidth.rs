//! What the memory of this machine gives: STREAM's copy and triad (1995) over arrays that no cache holds.
//!
//! Bytes are counted as STREAM does: what the loop reads and writes, not what a cache fetches before it is overwritten.

use rayon::prelude::*;
use serde::Serialize;

use super::session::Session;
use super::spread::{Spread, measure};
use super::{Outcome, ensure, pool};

/// Bytes of each of the three arrays: many times the largest caches.
const ARRAY_BYTES: usize = 256 << 20;
/// With `--quick`: these fit into a cache.
const QUICK_BYTES: usize = 8 << 20;
/// Numbers that a thread takes at a time.
const CHUNK: usize = 1 << 16;
/// The factor of the triad.
const FACTOR: f64 = 3.0;

/// The bandwidth that so many threads have.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct Bandwidth {
    pub(super) threads: usize,
    pub(super) array_bytes: usize,
    copy: Spread,
    triad: Spread,
    pub(super) copy_gb_per_s: f64,
    pub(super) triad_gb_per_s: f64,
}

impl Bandwidth {
    /// Measures it.
    pub(super) fn measure(session: &Session, threads: usize) -> Outcome<Self> {
        let array_bytes = if session.is_quick { QUICK_BYTES } else { ARRAY_BYTES };
        let n = array_bytes / size_of::<f64>();
        let runs = session.runs(11);
        let wrong = |name: &str| format!("{name} of {n} numbers on {threads} threads");
        pool(threads)?.install(|| {
            // Written first by the threads that will use them.
            let filled = |value: f64| (0..n).into_par_iter().with_min_len(CHUNK).map(|_| value).collect::<Vec<_>>();
            let (b, c) = (filled(1.0), filled(2.0));
            let mut a = filled(0.0);
            let is_all = |a: &Vec<f64>, value: f64| a.par_iter().all(|found| found.to_bits() == value.to_bits());
            let clear = |a: &mut Vec<f64>| a.par_iter_mut().for_each(|value| *value = 0.0);
            let copy = |a: &mut Vec<f64>| {
                a.par_chunks_mut(CHUNK).zip(b.par_chunks(CHUNK)).for_each(|(a, b)| {
                    a.iter_mut().zip(b).for_each(|(a, b)| *a = *b);
                });
            };
            let copy = measure(session, runs, &mut a, clear, copy, |a| ensure(is_all(a, 1.0), || wrong("copy")))?;
            let triad = |a: &mut Vec<f64>| {
                let operands = b.par_chunks(CHUNK).zip(c.par_chunks(CHUNK));
                a.par_chunks_mut(CHUNK).zip(operands).for_each(|(a, (b, c))| {
                    a.iter_mut().zip(b.iter().zip(c)).for_each(|(a, (b, c))| *a = b + FACTOR * c);
                });
            };
            let triad = measure(session, runs, &mut a, clear, triad, |a| ensure(is_all(a, 7.0), || wrong("triad")))?;
            let gb_per_s = |arrays: usize, time: Spread| (arrays * array_bytes) as f64 / time.median_ms * 1e-6;
            let (copy_gb_per_s, triad_gb_per_s) = (gb_per_s(2, copy), gb_per_s(3, triad));
            Ok(Self { threads, array_bytes, copy, triad, copy_gb_per_s, triad_gb_per_s })
        })
    }

    /// The better of the two.
    pub(super) fn gb_per_s(&self) -> f64 {
        self.copy_gb_per_s.max(self.triad_gb_per_s)
    }
}
