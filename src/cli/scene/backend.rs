//! What draws: chosen once, said in one line, and left for the processor where `auto` chose a GPU that fails.

#[cfg(feature = "gpu")]
use cellfan::{
    CpuMethod, Error,
    backends::gpu::{Gpu, GpuCompositor, adapters},
};
use cellfan::{RenderOptions, Rendered, Renderer};

use super::arguments::{Arguments, Backend as Wanted};

/// What draws.
pub(in crate::cli) struct Backend {
    #[cfg(feature = "gpu")]
    gpu: Option<Gpu>,
    #[cfg(feature = "gpu")]
    gpu_memory_bytes: u64,
    #[cfg(feature = "gpu")]
    may_fall_back: bool,
    /// What was chosen and why; empty where the user chose the processor.
    note: String,
}

impl Backend {
    /// The processor, for what no GPU draws.
    ///
    /// # Errors
    /// [`cellfan::Error::Option`] where a GPU was asked for.
    pub(super) fn processor(arguments: &Arguments) -> cellfan::Result<Self> {
        if arguments.backend == Wanted::Gpu {
            let problem = "depth planes are drawn on the CPU; use --method cells".to_owned();
            return Err(cellfan::Error::Option { option: "--backend gpu", problem });
        }
        Ok(Self {
            #[cfg(feature = "gpu")]
            gpu: None,
            #[cfg(feature = "gpu")]
            gpu_memory_bytes: 0,
            #[cfg(feature = "gpu")]
            may_fall_back: false,
            note: String::new(),
        })
    }

    /// Says what drew, and why.
    pub(in crate::cli) fn say(&self) {
        if !self.note.is_empty() {
            tracing::info!("{}", self.note);
        }
    }
}

#[cfg(feature = "gpu")]
impl Backend {
    /// Finds a device, before anything is read.
    pub(super) fn choose(arguments: &Arguments) -> cellfan::Result<Self> {
        let gpu_memory_bytes = arguments.gpu_memory.unwrap_or(GpuCompositor::MEMORY_BYTES);
        let may_fall_back = arguments.backend == Wanted::Auto;
        let mut note = String::new();
        let gpu = match arguments.backend {
            Wanted::Cpu => None,
            Wanted::Gpu => {
                if let Some(problem) = needs_processor(arguments) {
                    let problem = format!("{problem}; leave one of both out");
                    return Err(Error::Option { option: "--backend gpu", problem });
                }
                Some(Gpu::open(arguments.adapter.as_deref())?)
            }
            Wanted::Auto => match find_gpu(arguments) {
                Ok(gpu) => Some(gpu),
                Err(reason) => {
                    note = format!("drawn on the CPU: {reason}");
                    None
                }
            },
        };
        if let Some(gpu) = &gpu {
            let depth =
                if gpu.blends_in_32_bits() { "" } else { ", which blends in 16 bits only: pictures are less exact" };
            note = format!("drawn on {}{depth}", gpu.adapter());
        }
        Ok(Self { gpu, gpu_memory_bytes, may_fall_back, note })
    }

    pub(super) fn renderer(&self, options: RenderOptions) -> Renderer {
        match &self.gpu {
            Some(gpu) => Renderer::on_gpu(options, gpu.clone(), self.gpu_memory_bytes),
            None => Renderer::new(options),
        }
    }

    /// Draws a frame; on the processor from then on where the GPU fails and may.
    pub(super) fn render(
        &mut self,
        renderer: &mut Renderer,
        options: RenderOptions,
        mut draw: impl FnMut(&mut Renderer) -> cellfan::Result<Rendered>,
    ) -> cellfan::Result<Rendered> {
        match draw(renderer) {
            Err(error) if self.may_fall_back && self.gpu.is_some() && is_of_the_gpu(&error) => {
                tracing::warn!("{error}; drawing on the CPU instead");
                self.note.clear();
                self.gpu = None;
                *renderer = Renderer::new(options);
                draw(renderer)
            }
            result => result,
        }
    }

    pub(in crate::cli) fn name(&self) -> &'static str {
        if self.gpu.is_some() { "gpu" } else { "cpu" }
    }

    pub(in crate::cli) fn adapter(&self) -> Option<String> {
        self.gpu.as_ref().map(|gpu| gpu.adapter().to_string())
    }
}

/// Whether the processor may succeed: the device fails, or the picture is too large for it.
#[cfg(feature = "gpu")]
fn is_of_the_gpu(error: &Error) -> bool {
    error.is_device() || matches!(error, Error::Option { option: "--size" | "--gpu-memory" | "--backend gpu", .. })
}

/// What only the processor can do.
#[cfg(feature = "gpu")]
fn needs_processor(arguments: &Arguments) -> Option<&'static str> {
    if arguments.memory.is_some() {
        return Some("--memory is kept on the CPU only (a GPU has --gpu-memory)");
    }
    if let Some(problem) = arguments.planes.needs_processor() {
        return Some(problem);
    }
    (arguments.cpu_method == CpuMethod::Fans).then_some("--cpu-method fans is the CPU's")
}

/// A real GPU, or why there is none.
#[cfg(feature = "gpu")]
fn find_gpu(arguments: &Arguments) -> Result<Gpu, String> {
    if let Some(reason) = needs_processor(arguments) {
        return Err(reason.to_owned());
    }
    let found = adapters();
    let gpu = found.iter().find(|adapter| adapter.is_gpu || arguments.adapter.is_some());
    match (gpu, found.first()) {
        (Some(_), _) => Gpu::open(arguments.adapter.as_deref()).map_err(|error| error.to_string()),
        (None, Some(first)) => Err(format!("{first} is no real GPU (--backend gpu draws on it)")),
        (None, None) => Err("no driver for a GPU was found".to_owned()),
    }
}

#[cfg(not(feature = "gpu"))]
#[expect(clippy::unused_self, reason = "the same methods as with GPUs")]
impl Backend {
    /// The processor: this program was built without GPUs.
    pub(super) fn choose(arguments: &Arguments) -> cellfan::Result<Self> {
        if arguments.backend == Wanted::Gpu {
            let problem = "this program was built without GPUs; build it with --features gpu, or say --backend cpu";
            return Err(cellfan::Error::NoDevice { problem: problem.to_owned() });
        }
        Ok(Self { note: String::new() })
    }

    pub(super) fn renderer(&self, options: RenderOptions) -> Renderer {
        Renderer::new(options)
    }

    pub(super) fn render(
        &mut self,
        renderer: &mut Renderer,
        _: RenderOptions,
        mut draw: impl FnMut(&mut Renderer) -> cellfan::Result<Rendered>,
    ) -> cellfan::Result<Rendered> {
        draw(renderer)
    }

    pub(in crate::cli) fn name(&self) -> &'static str {
        "cpu"
    }

    pub(in crate::cli) fn adapter(&self) -> Option<String> {
        None
    }
}

#[cfg(all(test, feature = "gpu"))]
mod tests {
    use cellfan::generate::{self, Settings};
    use cellfan::optics::presets;
    use cellfan::{Camera, Dataset, FieldSelection, Scene};

    use super::*;

    #[test]
    fn a_gpu_that_fails_leaves_the_frame_to_the_cpu_where_it_may() {
        let mesh = generate::tets(&Settings { cells: 2000, ..Settings::default() }).unwrap();
        let dataset = Dataset::from_tets(mesh).unwrap();
        let field = dataset.field(&FieldSelection::parse("value", &dataset.arrays)).unwrap();
        let transfer = presets::preset("viridis", field.range, presets::OpacityProfile::default(), 0.02).unwrap();
        let camera = Camera::framing(&dataset.corners_world(), 35.0, 20.0, 40, 30);
        let scene = Scene::new(dataset, field, &transfer);
        let options = RenderOptions::default();
        let expected = Renderer::new(options).render(&scene, &camera).unwrap().image;
        for adapter in adapters() {
            for may_fall_back in [true, false] {
                let gpu = Gpu::open(Some(&adapter.name)).unwrap();
                let mut backend =
                    Backend { gpu: Some(gpu.clone()), gpu_memory_bytes: 1 << 26, may_fall_back, note: String::new() };
                let mut renderer = backend.renderer(options);
                backend.render(&mut renderer, options, |renderer| renderer.render(&scene, &camera)).unwrap();
                assert_eq!(backend.name(), "gpu");
                gpu.device_and_queue().0.destroy();
                let rendered = backend.render(&mut renderer, options, |renderer| renderer.render(&scene, &camera));
                if may_fall_back {
                    assert_eq!(rendered.unwrap().image.pixels, expected.pixels);
                    assert_eq!((backend.name(), backend.adapter()), ("cpu", None));
                } else {
                    assert!(rendered.unwrap_err().is_device());
                }
            }
        }
    }
}
