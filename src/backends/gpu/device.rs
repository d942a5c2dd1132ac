//! `Gpu`: the device that draws, chosen by kind or by name, and what went wrong on it.

use std::sync::{Arc, Mutex};

use wgpu::{DeviceType, Features};

use crate::error::{Error, Result};

/// An adapter that was found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AdapterSummary {
    /// Its name, as its driver tells it.
    pub name: String,
    /// What it is: a discrete or integrated GPU, a virtual one, a processor.
    pub kind: &'static str,
    /// The interface it is driven through: Vulkan, Metal, Dx12.
    pub interface: String,
    /// Whether it is a real GPU and not a processor that imitates one.
    pub is_gpu: bool,
}

impl std::fmt::Display for AdapterSummary {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} ({}, {})", self.name, self.kind, self.interface)
    }
}

impl AdapterSummary {
    fn new(info: &wgpu::AdapterInfo) -> Self {
        let kind = match info.device_type {
            DeviceType::DiscreteGpu => "discrete GPU",
            DeviceType::IntegratedGpu => "integrated GPU",
            DeviceType::VirtualGpu => "virtual GPU",
            DeviceType::Cpu => "processor",
            DeviceType::Other => "unknown kind",
        };
        let is_gpu = !matches!(info.device_type, DeviceType::Cpu | DeviceType::Other);
        Self { name: info.name.clone(), kind, interface: format!("{:?}", info.backend), is_gpu }
    }
}

/// A device and its queue, ready to draw with.
///
/// Clones share the device.
#[derive(Clone, Debug)]
pub struct Gpu {
    pub(super) device: wgpu::Device,
    pub(super) queue: wgpu::Queue,
    adapter: AdapterSummary,
    failure: Failure,
}

/// The first thing that went wrong on a device.
#[derive(Clone, Debug, Default)]
struct Failure(Arc<Mutex<Option<String>>>);

impl Failure {
    fn note(&self, problem: String) {
        if let Ok(mut first) = self.0.lock() {
            first.get_or_insert(problem);
        }
    }

    fn note_error(&self, error: &wgpu::Error) {
        self.note(match error {
            wgpu::Error::OutOfMemory { .. } => {
                "is out of memory; lower --gpu-memory or the size of the picture".to_owned()
            }
            other => format!("failed: {other}"),
        });
    }
}

/// Features that are used where the adapter has them.
const WANTED: Features = Features::FLOAT32_BLENDABLE
    .union(Features::MAPPABLE_PRIMARY_BUFFERS)
    .union(Features::TIMESTAMP_QUERY)
    .union(Features::DUAL_SOURCE_BLENDING)
    .union(Features::DEPTH32FLOAT_STENCIL8);

/// All adapters, the best one first.
fn find() -> Vec<wgpu::Adapter> {
    let descriptor = wgpu::InstanceDescriptor {
        flags: wgpu::InstanceFlags::empty(),
        ..wgpu::InstanceDescriptor::new_without_display_handle_from_env()
    };
    let instance = wgpu::Instance::new(descriptor);
    let mut adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()));
    adapters.sort_by_key(|adapter| match adapter.get_info().device_type {
        DeviceType::DiscreteGpu => 0,
        DeviceType::IntegratedGpu => 1,
        DeviceType::VirtualGpu => 2,
        DeviceType::Cpu => 3,
        DeviceType::Other => 4,
    });
    adapters
}

/// The adapters of this machine, the one that is chosen first.
pub fn adapters() -> Vec<AdapterSummary> {
    find().iter().map(|adapter| AdapterSummary::new(&adapter.get_info())).collect()
}

impl Gpu {
    /// The best adapter, or the best one whose name contains `name` in any case.
    ///
    /// # Errors
    /// [`Error::NoDevice`] where there is none, or it cannot be used; it says what to do.
    pub fn open(name: Option<&str>) -> Result<Self> {
        let adapters = find();
        let summaries: Vec<_> = adapters.iter().map(|adapter| AdapterSummary::new(&adapter.get_info())).collect();
        let wanted = name.unwrap_or_default().to_lowercase();
        let chosen = summaries.iter().position(|adapter| adapter.name.to_lowercase().contains(&wanted));
        let Some(chosen) = chosen else {
            let problem = if let (Some(name), false) = (name, summaries.is_empty()) {
                let names: Vec<String> = summaries.iter().map(ToString::to_string).collect();
                format!("no adapter is called {name:?}; there are: {}", names.join(", "))
            } else {
                "no driver for Vulkan, Metal or Direct3D 12 was found; install one (for Vulkan in software: \
                 mesa-vulkan-drivers), check VK_DRIVER_FILES, or use --backend cpu"
                    .to_owned()
            };
            return Err(Error::NoDevice { problem });
        };
        let (adapter, summary) = (&adapters[chosen], summaries[chosen].clone());
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("cellfan"),
            required_features: adapter.features() & WANTED,
            required_limits: adapter.limits(),
            ..wgpu::DeviceDescriptor::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).map_err(|error| {
            let problem = format!("{summary} cannot be used: {error}; choose another with --adapter, or --backend cpu");
            Error::NoDevice { problem }
        })?;
        let gpu = Self { device, queue, adapter: summary, failure: Failure::default() };
        gpu.listen();
        Ok(gpu)
    }

    /// A caller's own device, as for drawing into its textures. Its callbacks for errors stay as they are.
    ///
    /// With the features `FLOAT32_BLENDABLE` and, on integrated adapters, `MAPPABLE_PRIMARY_BUFFERS` pictures are more exact and
    /// faster; `TIMESTAMP_QUERY` times them, `DUAL_SOURCE_BLENDING` is for emission-absorption in bands.
    pub fn from_device(device: wgpu::Device, queue: wgpu::Queue) -> Self {
        let adapter = AdapterSummary::new(&device.adapter_info());
        Self { device, queue, adapter, failure: Failure::default() }
    }

    /// The device and queue that it shares.
    pub fn device_and_queue(&self) -> (&wgpu::Device, &wgpu::Queue) {
        (&self.device, &self.queue)
    }

    /// What it draws on.
    pub fn adapter(&self) -> &AdapterSummary {
        &self.adapter
    }

    /// Whether pictures are blended in 32 bits; otherwise in 16.
    pub fn blends_in_32_bits(&self) -> bool {
        self.device.features().contains(Features::FLOAT32_BLENDABLE)
    }

    /// Whether each channel can be dimmed on its own, as emission-absorption in bands asks for.
    pub fn blends_by_channel(&self) -> bool {
        self.device.features().contains(Features::DUAL_SOURCE_BLENDING)
    }

    /// Notes errors that no call returns, instead of a panic.
    fn listen(&self) {
        let failure = self.failure.clone();
        self.device.on_uncaptured_error(Arc::new(move |error| {
            failure.note_error(&error);
        }));
        let failure = self.failure.clone();
        self.device.set_device_lost_callback(move |reason, message| {
            if reason != wgpu::DeviceLostReason::Destroyed {
                failure.note(format!("was lost: {message}"));
            }
        });
    }

    /// An error if anything went wrong on the device so far.
    pub(super) fn check(&self) -> Result<()> {
        match self.failure.0.lock().ok().and_then(|first| first.clone()) {
            Some(problem) => Err(self.error(&problem)),
            None => Ok(()),
        }
    }

    /// Makes things on the device; what fails there is an error, on a caller's device too.
    pub(super) fn make<T>(&self, what: impl FnOnce() -> Result<T>) -> Result<T> {
        let filters = [wgpu::ErrorFilter::Validation, wgpu::ErrorFilter::Internal, wgpu::ErrorFilter::OutOfMemory];
        let mut scopes = filters.map(|filter| Some(self.device.push_error_scope(filter)));
        let made = what();
        // Scopes close from the innermost out.
        for scope in scopes.iter_mut().rev().filter_map(Option::take) {
            if let Some(error) = pollster::block_on(scope.pop()) {
                self.failure.note_error(&error);
            }
        }
        self.check()?;
        made
    }

    /// What went wrong, or `otherwise`.
    pub(super) fn failed(&self, otherwise: &str) -> Error {
        self.check().err().unwrap_or_else(|| self.error(otherwise))
    }

    fn error(&self, problem: &str) -> Error {
        Error::NoDevice { problem: format!("{} {problem}", self.adapter) }
    }
}
