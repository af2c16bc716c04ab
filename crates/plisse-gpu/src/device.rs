//! The adapter, and transfers of bytes to and from it.

use std::sync::{Arc, Mutex};

use bytemuck::Pod;
use plisse::{Error, Result};
use wgpu::util::DeviceExt as _;

/// A GPU, or a software driver in its place.
pub struct Gpu {
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    /// Name that the driver gives itself.
    pub adapter: String,
    /// True if passes can be timed.
    pub(crate) has_timestamps: bool,
    /// First error that no call has returned yet.
    failure: Arc<Mutex<Option<String>>>,
}

impl Gpu {
    /// The best adapter: Vulkan, Metal or Direct3D 12, else OpenGL. `WGPU_BACKEND` and
    /// `WGPU_ADAPTER_NAME` choose among several.
    ///
    /// # Errors
    /// [`Error::Numeric`] if there is none.
    pub fn new() -> Result<Self> {
        let found =
            [wgpu::Backends::PRIMARY, wgpu::Backends::GL].into_iter().find_map(|backends| {
                // One after the other: some drivers print messages when OpenGL is looked for.
                let usual = wgpu::InstanceDescriptor {
                    backends,
                    ..wgpu::InstanceDescriptor::new_without_display_handle()
                };
                let instance = wgpu::Instance::new(usual.with_env());
                let options = wgpu::RequestAdapterOptions {
                    power_preference: wgpu::PowerPreference::HighPerformance,
                    ..Default::default()
                };
                pollster::block_on(async {
                    match wgpu::util::initialize_adapter_from_env(&instance, None).await {
                        Ok(adapter) => Some(adapter),
                        Err(_) => instance.request_adapter(&options).await.ok(),
                    }
                })
            });
        let adapter = found.ok_or_else(|| {
            let fix = "install a Vulkan driver (on Debian and Ubuntu: apt-get install \
                mesa-vulkan-drivers) or add --cpu";
            Error::numeric("GPU", format!("no adapter was found; {fix}"))
        })?;
        Self::from_adapter(&adapter)
    }

    fn from_adapter(adapter: &wgpu::Adapter) -> Result<Self> {
        let wanted = wgpu::Features::TIMESTAMP_QUERY;
        let features = adapter.features() & wanted;
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("plisse"),
            required_features: features,
            required_limits: adapter.limits(),
            ..Default::default()
        };
        let (device, queue) =
            pollster::block_on(adapter.request_device(&descriptor)).map_err(|e| {
                Error::numeric(
                    "GPU",
                    format!("the adapter gives no device ({e}); update its driver or add --cpu"),
                )
            })?;
        let info = adapter.get_info();
        let name = format!("{} ({:?})", info.name, info.backend);
        Ok(Self { has_timestamps: features.contains(wanted), ..Self::shared(device, queue, name) })
    }

    /// A device called `name` that a window has already. Passes on it are not timed.
    pub fn shared(device: wgpu::Device, queue: wgpu::Queue, name: String) -> Self {
        let failure = Arc::new(Mutex::new(None));
        let note = |failure: &Arc<Mutex<Option<String>>>, text: String| {
            if let Ok(mut first) = failure.lock() {
                first.get_or_insert(text);
            }
        };
        let seen = Arc::clone(&failure);
        device.on_uncaptured_error(Arc::new(move |e: wgpu::Error| note(&seen, e.to_string())));
        let lost = Arc::clone(&failure);
        device.set_device_lost_callback(move |reason, text| {
            if reason != wgpu::DeviceLostReason::Destroyed {
                note(&lost, format!("the device was lost: {text}"));
            }
        });
        Self { has_timestamps: false, device, queue, adapter: name, failure }
    }

    /// True if the adapter is a software driver.
    pub fn is_software(&self) -> bool {
        ["llvmpipe", "SwiftShader", "Basic Render"].iter().any(|name| self.adapter.contains(name))
    }

    /// The first error since the last call, if any.
    ///
    /// # Errors
    /// [`Error::Numeric`] with the driver's message.
    pub(crate) fn check(&self) -> Result<()> {
        match self.failure.lock().ok().and_then(|mut first| first.take()) {
            None => Ok(()),
            Some(text) => {
                let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
                Err(Error::numeric(
                    "GPU",
                    format!("{line}; try a smaller model or picture, or add --cpu"),
                ))
            }
        }
    }

    /// Largest size (bytes) of a buffer with this use.
    pub(crate) fn most_bytes(&self, usage: wgpu::BufferUsages) -> u64 {
        let limits = self.device.limits();
        if usage.contains(wgpu::BufferUsages::STORAGE) {
            return limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        }
        limits.max_buffer_size
    }

    /// A buffer that holds `data`, one element of zeros if that is empty (no buffer may be).
    pub(crate) fn buffer<T: Pod>(
        &self,
        label: &str,
        data: &[T],
        usage: wgpu::BufferUsages,
    ) -> Result<wgpu::Buffer> {
        let bytes: &[u8] = bytemuck::cast_slice(data);
        let most = self.most_bytes(usage);
        if bytes.len() as u64 > most {
            let asks = format!(
                "{label} need {} MB, the adapter takes {} MB at once",
                bytes.len() >> 20,
                most >> 20
            );
            return Err(Error::numeric("GPU", format!("{asks}; use a smaller model or add --cpu")));
        }
        let empty = vec![0u8; size_of::<T>().max(4)];
        let contents = if bytes.is_empty() { &empty } else { bytes };
        Ok(self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some(label),
            contents,
            usage,
        }))
    }

    /// Replaces the contents of `buffer`.
    pub(crate) fn write<T: Pod>(&self, buffer: &wgpu::Buffer, data: &[T]) {
        self.queue.write_buffer(buffer, 0, bytemuck::cast_slice(data));
    }

    /// The contents of `buffer`, once everything submitted is done.
    pub(crate) fn read<T: Pod>(&self, buffer: &wgpu::Buffer) -> Result<Vec<T>> {
        let size = buffer.size();
        let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
        let copy = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("read"),
            size,
            usage,
            mapped_at_creation: false,
        });
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(buffer, 0, &copy, 0, size);
        self.queue.submit([encoder.finish()]);
        self.map(&copy)
    }

    /// The contents of a buffer that can be mapped.
    pub(crate) fn map<T: Pod>(&self, buffer: &wgpu::Buffer) -> Result<Vec<T>> {
        let broken = |what: String| {
            Error::numeric(
                "GPU",
                format!("results could not be read back ({what}); try again or add --cpu"),
            )
        };
        let (send, receive) = std::sync::mpsc::channel();
        buffer.map_async(wgpu::MapMode::Read, .., move |done| {
            let _ = send.send(done);
        });
        self.wait()?;
        match receive.recv() {
            Ok(Ok(())) => {}
            Ok(Err(e)) => return Err(self.check().err().unwrap_or_else(|| broken(e.to_string()))),
            Err(e) => return Err(broken(e.to_string())),
        }
        let bytes = buffer.get_mapped_range(..).map_err(|e| broken(e.to_string()))?;
        Ok(bytemuck::pod_collect_to_vec(&bytes))
    }

    /// Destroys the device at once: all later calls fail, as if it had been lost.
    pub fn destroy(&self) {
        self.device.destroy();
    }

    /// Waits until everything submitted is done.
    ///
    /// # Errors
    /// [`Error::Numeric`] if something went wrong on the way.
    pub fn wait(&self) -> Result<()> {
        let done = self.device.poll(wgpu::PollType::wait_indefinitely());
        self.check()?;
        done.map(|_| ()).map_err(|e| {
            Error::numeric(
                "GPU",
                format!("the device does not answer ({e}); try again or add --cpu"),
            )
        })
    }
}
