//! The memory budget of the process, and what it leaves to scene and frames.
//!
//! The library counts what scene and frames take. The rest of the process (code, stacks, what the allocator did not give
//! back after reading the file) is measured once, when the scene is there.

use cellfan::profile::anonymous_bytes;
use cellfan::{Error, Result, Scene};

/// Taken for the rest of the process where the system does not tell.
const UNKNOWN_REST: u64 = 8 << 20;

/// A budget, if there is one, and what of it is taken already; in bytes.
#[derive(Clone, Copy)]
pub(super) struct Memory {
    budget: Option<u64>,
    scene: u64,
    rest: u64,
}

impl Memory {
    /// Measures; the budget is for the whole process, mapped files aside.
    pub(super) fn new(budget: Option<u64>, scene: &Scene) -> Self {
        let scene = scene.owned_bytes();
        let rest = anonymous_bytes().map_or(UNKNOWN_REST, |held| held.saturating_sub(scene));
        Self { budget, scene, rest }
    }

    /// The budget of scene and frame.
    ///
    /// # Errors
    /// [`Error::Memory`] where the scene alone exceeds it.
    pub(super) fn of_frame(self) -> Result<Option<u64>> {
        let Some(budget_bytes) = self.budget else { return Ok(None) };
        let needed_bytes = self.scene + self.rest;
        if budget_bytes < needed_bytes {
            let (what, advice) = ("the mesh in memory, before a frame is drawn,", "a smaller mesh");
            return Err(Error::Memory { budget_bytes, needed_bytes, what, advice });
        }
        Ok(Some(budget_bytes - self.rest))
    }

    /// An error of the library in terms of the whole process.
    pub(super) fn in_process(self, error: Error) -> Error {
        match error {
            Error::Memory { budget_bytes, needed_bytes, what, advice } => Error::Memory {
                budget_bytes: budget_bytes + self.rest,
                needed_bytes: needed_bytes + self.rest,
                what,
                advice,
            },
            other => other,
        }
    }
}
