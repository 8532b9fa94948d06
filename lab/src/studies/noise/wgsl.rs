//! Dolomite's own noise in WGSL, on whatever adapter there is.

use super::method::{Exact, Method, Output};
use super::ours;
use super::points::Points;
use bevy::math::DVec2;
use bytemuck::{cast_slice, pod_collect_to_vec};
use dolomite_terrain::noise::PreparedFractal;
use dolomite_terrain::{GpuTerrain, GroundRect, Layer, Source, Terrain, TerrainData};
use dolomite_testkit::gpu::{Binding, Gpu, GpuError, Kernel};
use std::rc::Rc;
use thiserror::Error;

/// Name of [`Wgsl`].
pub const WGSL: &str = "ours, WGSL";

/// Invocations of a workgroup of [`SHADER`].
const WORKGROUP: usize = 64;

/// The shader: asks the terrain's height at each place of a list.
const SHADER: &str = "terrain/probe.wgsl";

/// Most workgroups along one axis of a dispatch, WebGPU's default limit.
const WORKGROUPS_MAX: usize = 65_535;

/// Why there is no WGSL in the study.
#[derive(Debug, Error)]
pub enum AdapterError {
    /// No adapter, or it refuses the shader.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The shader could not be put together.
    #[error("the height shader could not be composed: {0}")]
    Shader(#[from] dolomite_shaders::ComposeError),
}

/// An adapter with the shader compiled for it.
#[derive(Clone)]
pub struct Adapter(Rc<(Gpu, Kernel)>);

impl Adapter {
    /// Opens the adapter and compiles the shader.
    ///
    /// # Errors
    /// [`AdapterError`].
    pub fn open() -> Result<Self, AdapterError> {
        let gpu = Gpu::new()?;
        let module = dolomite_shaders::compose(SHADER, &[])?;
        let kernel = gpu.kernel(module, "probe")?;
        Ok(Self(Rc::new((gpu, kernel))))
    }
}

/// The terrain's WGSL with one layer, the study's sum.
pub struct Wgsl {
    adapter: Adapter,
    terrain: GpuTerrain,
    fractal: PreparedFractal,
}

impl Wgsl {
    /// With the study's settings.
    pub fn new(octaves: u32, seed: u32, adapter: Adapter) -> Self {
        let settings = ours::fractal(octaves, seed);
        let terrain = Terrain::new(TerrainData {
            extent: GroundRect::square(DVec2::ZERO, 1e8),
            layers: vec![Layer {
                source: Source::Fractal(settings),
                mask: None,
            }],
            base: 0.0,
            sea_level: None,
        })
        .expect("the study's sum is in range");
        let fractal = settings.prepare().expect("the study's sum is in range");
        Self {
            adapter,
            terrain: terrain.gpu(),
            fractal,
        }
    }

    /// Upload, dispatch, read-back; seconds of the dispatch alone.
    fn dispatch(&self, points: &Points, out: &mut Output) -> Result<f64, GpuError> {
        let Adapter(shared) = &self.adapter;
        let (gpu, kernel) = (&shared.0, &shared.1);
        // NaN where nothing is written: seen as an infinite error.
        let mut heights: Vec<u8> = pod_collect_to_vec(&vec![f32::NAN; points.len() * 4]);
        let mut groups = [
            vec![
                Binding::Read(cast_slice(&points.fixed)),
                Binding::Write(&mut heights),
            ],
            vec![
                Binding::Read(cast_slice(&self.terrain.layers)),
                Binding::Read(cast_slice(&self.terrain.data)),
                Binding::Uniform(bytemuck::bytes_of(&self.terrain.uniform)),
            ],
        ];
        let workgroups = points.len().div_ceil(WORKGROUP);
        let rows = workgroups.div_ceil(WORKGROUPS_MAX);
        let grid = [workgroups.div_ceil(rows) as u32, rows as u32, 1];
        let time = gpu.run_timed(kernel, &mut groups, grid, 1)?;
        let floats: Vec<f32> = pod_collect_to_vec(&heights);
        for (i, height) in floats.chunks_exact(4).take(points.len()).enumerate() {
            out.values[i] = height[0];
            out.dx[i] = height[1];
            out.dz[i] = height[2];
        }
        Ok(time.as_secs_f64())
    }
}

impl Method for Wgsl {
    fn name(&self) -> &'static str {
        WGSL
    }

    fn device(&self) -> String {
        self.adapter.0.0.name.clone()
    }

    fn bytes(&self) -> usize {
        size_of_val(self.terrain.layers.as_slice()) + size_of_val(self.terrain.data.as_slice())
    }

    fn amplitude(&self) -> f64 {
        1.0
    }

    fn has_gradient(&self) -> bool {
        true
    }

    fn evaluate(&mut self, points: &Points, _with_gradient: bool, out: &mut Output) {
        if let Err(error) = self.dispatch(points, out) {
            // The results stay NaN, and so infinitely wrong: it cannot pass for a measurement.
            eprintln!("noise: {WGSL}: {error}");
        }
    }

    fn seconds(&mut self, points: &Points, _with_gradient: bool, out: &mut Output) -> f64 {
        self.dispatch(points, out).unwrap_or_else(|error| {
            eprintln!("noise: {WGSL}: {error}");
            f64::INFINITY
        })
    }

    fn definition(&self, at: DVec2) -> Option<Exact> {
        Some(ours::definition(&self.fractal, at))
    }
}
