//! Asking for memory that is read soon: the cells of a tile lie in the order of their depths, which is any order in memory.
#![expect(unsafe_code, reason = "the instruction takes an address")]

/// Asks for the cache line where `of` begins; nothing happens on processors without such an instruction.
#[inline]
pub(super) fn prefetch<T>(of: &T) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: SSE is part of x86-64; the instruction reads nothing that the program could see.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(std::ptr::from_ref(of).cast()) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = of;
}
