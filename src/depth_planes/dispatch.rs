//! Run-time dispatch: the same kernel compiled for several instruction sets, chosen by what the processor offers.
//!
//! A [`Kernel`] is inlined into one function for each. No kernel uses fused or reordered operations, so that all give the same bits.
#![expect(
    unsafe_code,
    reason = "a function compiled for more than the baseline may run only where the processor has it"
)]

use crate::backends::cpu::InstructionSet;

/// Work that is compiled for each instruction set; `run` must be `inline(always)`.
pub(super) trait Kernel {
    fn run(self);
}

/// An instruction set that this processor has.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dispatch {
    set: InstructionSet,
}

impl Dispatch {
    /// `set`, or the best there is where the processor lacks it.
    pub(super) fn new(set: Option<InstructionSet>) -> Self {
        let available = InstructionSet::available();
        Self { set: set.filter(|set| available.contains(set)).unwrap_or(available[0]) }
    }

    /// Whether kernels run with AVX-512.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub(super) fn has_avx512(self) -> bool {
        self.set == InstructionSet::Avx512
    }

    /// Runs a kernel.
    #[inline]
    pub(super) fn run(self, kernel: impl Kernel) {
        match self.set {
            InstructionSet::Baseline => kernel.run(),
            #[cfg(target_arch = "x86_64")]
            // SAFETY: `new`, the only constructor, keeps a set only if `available` detected its features.
            InstructionSet::Avx2 => unsafe { run_avx2(kernel) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as above.
            InstructionSet::Avx512 => unsafe { run_avx512(kernel) },
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,popcnt,bmi1,bmi2")]
fn run_avx2(kernel: impl Kernel) {
    kernel.run();
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,popcnt,bmi1,bmi2")]
fn run_avx512(kernel: impl Kernel) {
    kernel.run();
}
