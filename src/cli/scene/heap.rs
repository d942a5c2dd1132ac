//! What is freed goes back to the system at once, so that a memory budget is not spent on what a reader let go.
//!
//! The GNU C library maps large blocks on their own and unmaps them when they are freed, but raises the size from which it
//! does so each time, up to 32 MiB: after reading a mesh of a million cells it kept 50 MB of free blocks. A size that is set
//! stays. Other systems' allocators are left as they are.
#![expect(unsafe_code, reason = "mallopt is a C function")]

/// Blocks from this size on are mapped on their own; the library's own first value.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const MAPPED_BYTES: libc::c_int = 128 << 10;

/// To be called before anything large is allocated.
pub(super) fn give_back_early() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    {
        // SAFETY: mallopt takes two integers and locks the heap itself (mallopt(3): MT-Unsafe only while the heap is first set
        // up, which the runtime did before main).
        let is_set = unsafe { libc::mallopt(libc::M_MMAP_THRESHOLD, MAPPED_BYTES) };
        debug_assert_eq!(is_set, 1);
    }
}
