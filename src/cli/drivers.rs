//! Keeps graphics drivers from writing to stderr, which is this program's to write to.
//!
//! Mesa's layer for choosing a device asks a Wayland compositor which one it uses; without a session to find one in, its library
//! prints an error for each attempt. The layer's own switch leaves it out.
#![expect(unsafe_code, reason = "the environment of the process is shared with its libraries")]

/// To be called first, before there are threads.
pub(super) fn be_quiet() {
    if cfg!(target_os = "linux") && std::env::var_os("XDG_RUNTIME_DIR").is_none() {
        // SAFETY: nothing has been started yet that could read the environment at the same time: this is the first call of main.
        unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
    }
}
