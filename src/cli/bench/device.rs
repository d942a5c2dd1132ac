//! What draws the frames of a benchmark: the processor, or a GPU that is asked for.

use cellfan::{RenderOptions, Renderer};
use clap::Args;
use serde_json::{Value, json};

#[cfg(feature = "gpu")]
use cellfan::backends::gpu::{Gpu, GpuCompositor};

use crate::cli::arguments::one_of;

#[derive(Args)]
pub(super) struct DeviceArguments {
    /// What draws.
    #[arg(long, default_value = "cpu", value_parser = one_of([("cpu", Backend::Cpu), ("gpu", Backend::Gpu)]))]
    backend: Backend,
    /// The first GPU whose name contains this, in any case; a name that none has lists all.
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Backend {
    Cpu,
    Gpu,
}

/// A device that is there.
pub(super) struct Device {
    #[cfg(feature = "gpu")]
    gpu: Option<Gpu>,
}

impl Device {
    /// Finds it, before anything is generated or read.
    ///
    /// # Errors
    /// [`Error::NoDevice`](cellfan::Error::NoDevice).
    #[cfg(feature = "gpu")]
    pub(super) fn find(arguments: &DeviceArguments) -> cellfan::Result<Self> {
        let wants_gpu = arguments.backend == Backend::Gpu;
        Ok(Self { gpu: wants_gpu.then(|| Gpu::open(arguments.adapter.as_deref())).transpose()? })
    }

    /// The processor: this program was built without GPUs.
    #[cfg(not(feature = "gpu"))]
    pub(super) fn find(arguments: &DeviceArguments) -> cellfan::Result<Self> {
        if arguments.backend == Backend::Gpu || arguments.adapter.is_some() {
            let problem = "this program was built without GPUs; build it with --features gpu, or say --backend cpu";
            return Err(cellfan::Error::NoDevice { problem: problem.to_owned() });
        }
        Ok(Self {})
    }

    #[cfg(feature = "gpu")]
    pub(super) fn renderer(&self, options: RenderOptions) -> Renderer {
        match &self.gpu {
            Some(gpu) => Renderer::on_gpu(options, gpu.clone(), GpuCompositor::MEMORY_BYTES),
            None => Renderer::new(options),
        }
    }

    #[cfg(not(feature = "gpu"))]
    #[expect(clippy::unused_self, reason = "the same method as with GPUs")]
    pub(super) fn renderer(&self, options: RenderOptions) -> Renderer {
        Renderer::new(options)
    }

    /// Its name in a sentence and in a record.
    #[cfg(feature = "gpu")]
    pub(super) fn name(&self) -> String {
        self.gpu.as_ref().map_or_else(|| "cpu".to_owned(), |gpu| gpu.adapter().to_string())
    }

    #[cfg(not(feature = "gpu"))]
    #[expect(clippy::unused_self, reason = "the same method as with GPUs")]
    pub(super) fn name(&self) -> String {
        "cpu".to_owned()
    }

    /// What a record says of it.
    pub(super) fn to_json(&self) -> Value {
        json!(self.name())
    }
}
