//! Compute shaders on whatever adapter there is, without a window and without Bevy.
//!
//! For tests and studies: a [`Kernel`] is compiled once; each run of it makes its own buffers, which
//! go up, are worked on, and come back. [`Gpu::run_timed`] repeats the dispatch and gives the time
//! of one.

use std::borrow::Cow;
use std::time::{Duration, Instant};

use bevy::tasks::block_on;
use naga::Module;
use thiserror::Error;
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{
    Backends, BindGroupDescriptor, BindGroupEntry, Buffer, BufferDescriptor, BufferUsages,
    CommandEncoderDescriptor, ComputePassDescriptor, ComputePipelineDescriptor, DeviceDescriptor,
    Instance, InstanceDescriptor, InstanceFlags, Limits, MapMode, PollType, PowerPreference,
    RequestAdapterOptions, ShaderModuleDescriptor, ShaderSource,
};

/// Why nothing could be run.
#[derive(Debug, Error)]
pub enum GpuError {
    /// No Vulkan adapter.
    #[error("no Vulkan device ({0}); install a driver, or software Vulkan: mesa-vulkan-drivers")]
    NoAdapter(String),
    /// The adapter refused the limits.
    #[error("the Vulkan device {adapter} does not give WebGPU's default limits: {reason}")]
    Device {
        /// Name of the adapter.
        adapter: String,
        /// What it said.
        reason: String,
    },
    /// The shader or its bindings are wrong.
    #[error("{0}")]
    Validation(String),
    /// A buffer did not come back.
    #[error("reading a buffer back failed: {0}")]
    Readback(String),
}

/// A device without a window, with WebGPU's default limits, so that what runs here runs anywhere.
pub struct Gpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
    /// Name and driver of the adapter.
    pub name: String,
    /// Whether it is a processor pretending to be a GPU.
    pub software: bool,
}

/// A compiled compute shader.
pub struct Kernel(wgpu::ComputePipeline);

/// What records a dispatch, from a pipeline and its bind groups.
pub type Recorder<'a> =
    dyn Fn(&mut wgpu::ComputePass<'_>, &wgpu::ComputePipeline, &[wgpu::BindGroup]) + 'a;

/// A buffer of a run; its place in the list of its group is its binding number.
pub enum Binding<'a> {
    /// `var<uniform>`.
    Uniform(&'a [u8]),
    /// `var<storage, read>`.
    Read(&'a [u8]),
    /// `var<storage, read_write>`: holds these bytes before the run, is overwritten after it.
    Write(&'a mut Vec<u8>),
}

impl Gpu {
    /// Opens the adapter that `WGPU_ADAPTER_NAME` names (part of its name is enough), else the
    /// fastest.
    ///
    /// # Errors
    /// Without a Vulkan adapter, or if it lacks WebGPU's default limits.
    pub fn new() -> Result<Self, GpuError> {
        let mut descriptor = InstanceDescriptor {
            backends: Backends::VULKAN,
            ..InstanceDescriptor::new_without_display_handle_from_env()
        };
        // As in the game: our own passes write the arguments of indirect dispatches.
        descriptor
            .flags
            .remove(InstanceFlags::VALIDATION_INDIRECT_CALL);
        let instance = Instance::new(descriptor);
        let wanted = std::env::var("WGPU_ADAPTER_NAME")
            .unwrap_or_default()
            .to_lowercase();
        let named = (!wanted.is_empty())
            .then(|| block_on(instance.enumerate_adapters(Backends::VULKAN)))
            .into_iter()
            .flatten()
            .find(|adapter| adapter.get_info().name.to_lowercase().contains(&wanted));
        let adapter = match named {
            Some(adapter) => adapter,
            None => block_on(instance.request_adapter(&RequestAdapterOptions {
                power_preference: PowerPreference::HighPerformance,
                ..Default::default()
            }))
            .map_err(|error| GpuError::NoAdapter(error.to_string()))?,
        };
        let info = adapter.get_info();
        let (device, queue) = block_on(adapter.request_device(&DeviceDescriptor {
            label: Some("testkit"),
            // For studies that tell the passes of a queue apart.
            required_features: adapter.features() & wgpu::Features::TIMESTAMP_QUERY,
            required_limits: Limits::default(),
            ..Default::default()
        }))
        .map_err(|error| GpuError::Device {
            adapter: info.name.clone(),
            reason: error.to_string(),
        })?;
        Ok(Self {
            device,
            queue,
            name: format!("{} ({} {})", info.name, info.driver, info.driver_info),
            software: info.device_type == wgpu::DeviceType::Cpu,
        })
    }

    /// The device, for what [`Self::run`] does not do.
    pub const fn device(&self) -> &wgpu::Device {
        &self.device
    }

    /// The queue, for what [`Self::run`] does not do.
    pub const fn queue(&self) -> &wgpu::Queue {
        &self.queue
    }

    /// Waits until all that was submitted is done.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn finish(&self) -> Result<(), GpuError> {
        self.wait()
    }

    /// Waits until what was submitted up to `index` is done.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn finish_until(&self, index: wgpu::SubmissionIndex) -> Result<(), GpuError> {
        let until = PollType::Wait {
            submission_index: Some(index),
            timeout: None,
        };
        self.device
            .poll(until)
            .map(|_| ())
            .map_err(|error| GpuError::Readback(error.to_string()))
    }

    /// Reads a whole buffer back; it needs `COPY_SRC`.
    ///
    /// # Errors
    /// If it does not come back.
    pub fn read(&self, buffer: &Buffer) -> Result<Vec<u8>, GpuError> {
        self.download(buffer)
    }

    /// Compiles `entry` of a composed module.
    ///
    /// # Errors
    /// If the shader is invalid.
    pub fn kernel(&self, module: Module, entry: &str) -> Result<Kernel, GpuError> {
        let scope = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let shader = self.device.create_shader_module(ShaderModuleDescriptor {
            label: Some(entry),
            source: ShaderSource::Naga(Cow::Owned(module)),
        });
        let pipeline = self
            .device
            .create_compute_pipeline(&ComputePipelineDescriptor {
                label: Some(entry),
                layout: None,
                module: &shader,
                entry_point: Some(entry),
                compilation_options: Default::default(),
                cache: None,
            });
        match block_on(scope.pop()) {
            Some(error) => Err(GpuError::Validation(error.to_string())),
            None => Ok(Kernel(pipeline)),
        }
    }

    /// Runs a kernel once, with `groups[g][b]` bound to `@group(g) @binding(b)`, over
    /// `workgroups`.
    ///
    /// # Errors
    /// If the bindings or the dispatch are invalid, or a buffer does not come back.
    pub fn run(
        &self,
        kernel: &Kernel,
        groups: &mut [Vec<Binding<'_>>],
        workgroups: [u32; 3],
    ) -> Result<(), GpuError> {
        self.run_timed(kernel, groups, workgroups, 1).map(|_| ())
    }

    /// As [`Self::run`], with the dispatch recorded by `record`, from the pipeline and its bind groups: by what records
    /// it in an app.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn run_recorded(
        &self,
        kernel: &Kernel,
        groups: &mut [Vec<Binding<'_>>],
        record: &Recorder<'_>,
    ) -> Result<(), GpuError> {
        self.run_repeated(kernel, groups, record, 1).map(|_| ())
    }

    /// As [`Self::run`], `repeats` times; the median of the wall times of one dispatch, from
    /// submit to done.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn run_timed(
        &self,
        kernel: &Kernel,
        groups: &mut [Vec<Binding<'_>>],
        [x, y, z]: [u32; 3],
        repeats: usize,
    ) -> Result<Duration, GpuError> {
        let record: &Recorder<'_> = &|pass, pipeline, groups| {
            pass.set_pipeline(pipeline);
            for (index, group) in (0_u32..).zip(groups) {
                pass.set_bind_group(index, group, &[]);
            }
            pass.dispatch_workgroups(x, y, z);
        };
        self.run_repeated(kernel, groups, record, repeats)
    }

    fn run_repeated(
        &self,
        Kernel(pipeline): &Kernel,
        groups: &mut [Vec<Binding<'_>>],
        record: &Recorder<'_>,
        repeats: usize,
    ) -> Result<Duration, GpuError> {
        let scope = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let buffers: Vec<Vec<Buffer>> = groups
            .iter()
            .map(|group| group.iter().map(|binding| self.upload(binding)).collect())
            .collect();
        let bind_groups: Vec<_> = (0_u32..)
            .zip(&buffers)
            .map(|(index, group)| {
                let entries: Vec<_> = (0_u32..)
                    .zip(group)
                    .map(|(binding, buffer)| BindGroupEntry {
                        binding,
                        resource: buffer.as_entire_binding(),
                    })
                    .collect();
                self.device.create_bind_group(&BindGroupDescriptor {
                    label: None,
                    layout: &pipeline.get_bind_group_layout(index),
                    entries: &entries,
                })
            })
            .collect();
        if let Some(error) = block_on(scope.pop()) {
            return Err(GpuError::Validation(error.to_string()));
        }
        let mut times = Vec::with_capacity(repeats.max(1));
        for _ in 0..repeats.max(1) {
            let mut encoder = self
                .device
                .create_command_encoder(&CommandEncoderDescriptor::default());
            let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor::default());
            record(&mut pass, pipeline, &bind_groups);
            drop(pass);
            let start = Instant::now();
            self.queue.submit([encoder.finish()]);
            self.wait()?;
            times.push(start.elapsed());
        }
        times.sort_unstable();
        for (group, buffers) in groups.iter_mut().zip(&buffers) {
            for (binding, buffer) in group.iter_mut().zip(buffers) {
                if let Binding::Write(bytes) = binding {
                    let length = bytes.len();
                    **bytes = self.download(buffer)?;
                    bytes.truncate(length);
                }
            }
        }
        Ok(times[times.len() / 2])
    }

    fn wait(&self) -> Result<(), GpuError> {
        self.device
            .poll(PollType::wait_indefinitely())
            .map(|_| ())
            .map_err(|error| GpuError::Readback(error.to_string()))
    }

    fn upload(&self, binding: &Binding<'_>) -> Buffer {
        let (bytes, usage) = match binding {
            Binding::Uniform(bytes) => (*bytes, BufferUsages::UNIFORM),
            Binding::Read(bytes) => (*bytes, BufferUsages::STORAGE),
            Binding::Write(bytes) => (
                bytes.as_slice(),
                BufferUsages::STORAGE | BufferUsages::COPY_SRC,
            ),
        };
        // A binding may not be empty, and copies come in words.
        let mut contents = bytes.to_vec();
        contents.resize(bytes.len().next_multiple_of(16).max(16), 0);
        self.device.create_buffer_init(&BufferInitDescriptor {
            label: None,
            contents: &contents,
            usage,
        })
    }

    fn download(&self, buffer: &Buffer) -> Result<Vec<u8>, GpuError> {
        let staging = self.device.create_buffer(&BufferDescriptor {
            label: None,
            size: buffer.size(),
            usage: BufferUsages::MAP_READ | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder = self
            .device
            .create_command_encoder(&CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, Some(buffer.size()));
        self.queue.submit([encoder.finish()]);
        let (sender, receiver) = std::sync::mpsc::channel();
        staging.slice(..).map_async(MapMode::Read, move |result| {
            // The receiver outlives the wait below; if not, nobody is left to tell.
            let _ = sender.send(result);
        });
        self.wait()?;
        receiver
            .recv()
            .map_err(|error| GpuError::Readback(error.to_string()))?
            .map_err(|error| GpuError::Readback(error.to_string()))?;
        Ok(staging.slice(..).get_mapped_range().to_vec())
    }
}

/// The adapter for a test: `None`, after a line that says so, where there is none. With `CI` set
/// a missing adapter is a failure instead.
///
/// # Panics
/// With `CI` set, without a Vulkan adapter.
pub fn for_test() -> Option<Gpu> {
    match Gpu::new() {
        Ok(gpu) => Some(gpu),
        Err(error) => {
            assert!(
                std::env::var_os("CI").is_none(),
                "CI must not skip GPU tests: {error}"
            );
            eprintln!("skipped: {error}");
            None
        }
    }
}
