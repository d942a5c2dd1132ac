//! The C interface: sessions, cameras, pictures, for any language that calls C (feature `capi`).
//!
//! In: pointers with lengths, structures, handles. Out: a status from every function that can fail, and what it says of it in
//! [`cellfan_last_error`]. No panic leaves: it becomes a status too. `include/cellfan.h` is made from these files by cbindgen
//! (`CELLFAN_WRITE_HEADER=1 cargo test --test layering header`). To add a function: put it beside its like, give it a line on threads, make the header anew.
#![expect(clippy::doc_markdown, reason = "the header shows the words as they stand")]

mod guard;
mod handles;
mod picture;
mod session;
mod slices;
mod types;

pub use self::guard::{CellfanStatus, cellfan_last_error};
pub use self::handles::CellfanSession;
pub use self::picture::{cellfan_camera_framing, cellfan_preset, cellfan_save, cellfan_version};
pub use self::session::{
    cellfan_session_bounds, cellfan_session_cancel, cellfan_session_free, cellfan_session_new,
    cellfan_session_on_progress, cellfan_session_render, cellfan_session_update_positions,
    cellfan_session_update_scalars, cellfan_session_update_topology, cellfan_session_value_range,
};
pub use self::types::{
    CellfanAssociation, CellfanCamera, CellfanControlPoint, CellfanMesh, CellfanModel, CellfanOptions, CellfanProgress,
    CellfanSlice, CellfanSort, CellfanStats, CellfanType,
};
