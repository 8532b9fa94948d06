//! The WGSL of the tessellation stage on whatever adapter there is.

use super::check::Patch;
use bytemuck::{Pod, Zeroable, cast_slice, pod_collect_to_vec};
use dolomite_tessellation::shape::Shape;
use dolomite_tessellation::{Domain, Levels, Mode, Primitives, Spacing, Tessellator, Winding};
use dolomite_testkit::gpu::{Binding, Gpu, GpuError, Kernel};
use thiserror::Error;

/// Why there is no WGSL.
#[derive(Debug, Error)]
pub enum AdapterError {
    /// No adapter, or it refuses the shader.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The shader could not be put together.
    #[error("the tessellation shader could not be composed: {0}")]
    Shader(#[from] dolomite_shaders::ComposeError),
}

/// An adapter with the shader compiled for it.
pub struct Adapter {
    gpu: Gpu,
    kernel: Kernel,
}

/// What one workgroup is told, as in `shaders/src/stage/probe.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
pub(crate) struct CaseRecord {
    outer: [u32; 4],
    inner: [u32; 2],
    domain: u32,
    spacing: u32,
    mode: u32,
    clockwise: u32,
    vertex: u32,
    primitive: u32,
}

/// Records of 16 bytes in a buffer of a run: 32 MiB, a quarter of what WebGPU promises.
const ELEMENTS: u32 = 1 << 21;

/// Columns of the dispatch, as in the shader.
pub(crate) const COLUMNS: u32 = 32_768;

impl Adapter {
    /// Opens the adapter and compiles the shader.
    ///
    /// # Errors
    /// [`AdapterError`].
    pub fn open() -> Result<Self, AdapterError> {
        let gpu = Gpu::new()?;
        let module = dolomite_shaders::compose("stage/probe.wgsl", &[])?;
        let kernel = gpu.kernel(module, "probe")?;
        Ok(Self { gpu, kernel })
    }

    /// Name and driver.
    pub fn name(&self) -> &str {
        &self.gpu.name
    }

    /// Tessellates every patch, in runs of bounded size; `see` gets each with its place in the list.
    ///
    /// # Errors
    /// If a run fails.
    pub fn tessellate(
        &self,
        patches: &[(Tessellator, Levels)],
        mut see: impl FnMut(usize, Patch),
    ) -> Result<(), GpuError> {
        let mut first = 0;
        while first < patches.len() {
            let (mut records, mut vertices, mut primitives) = (Vec::new(), 0, 0);
            for (tessellator, levels) in &patches[first..] {
                let Tessellator {
                    domain,
                    spacing,
                    mode,
                    ..
                } = *tessellator;
                let (v, p) = Shape::new(levels, domain, spacing, mode)
                    .map_or((0, 0), |shape| (shape.vertices(), shape.primitives()));
                let full = vertices + v > ELEMENTS || primitives + p > ELEMENTS;
                if full && !records.is_empty() {
                    break;
                }
                records.push(record(tessellator, levels, vertices, primitives));
                vertices += v;
                primitives += p;
            }
            self.run(&records, [vertices, primitives], |k, patch| {
                see(first + k, patch);
            })?;
            first += records.len();
        }
        Ok(())
    }

    fn run(
        &self,
        records: &[CaseRecord],
        [vertices, primitives]: [u32; 2],
        mut see: impl FnMut(usize, Patch),
    ) -> Result<(), GpuError> {
        // A sentinel: what the shader does not write is seen.
        let sentinel = |count: u32| vec![0xAB_u8; count as usize * 16];
        let mut counts = vec![0xAB_u8; records.len() * 8];
        let (mut coordinates, mut indices) = (sentinel(vertices), sentinel(primitives));
        let groups = records.len() as u32;
        self.gpu.run(
            &self.kernel,
            &mut [vec![
                Binding::Read(cast_slice(records)),
                Binding::Write(&mut counts),
                Binding::Write(&mut coordinates),
                Binding::Write(&mut indices),
            ]],
            [groups.min(COLUMNS), groups.div_ceil(COLUMNS), 1],
        )?;
        let counts: Vec<[u32; 2]> = pod_collect_to_vec(&counts);
        let coordinates: Vec<[u32; 4]> = pod_collect_to_vec(&coordinates);
        let indices: Vec<[u32; 4]> = pod_collect_to_vec(&indices);
        for (k, (record, [v, p])) in records.iter().zip(counts).enumerate() {
            let range = |start: u32, count: u32, length: usize| {
                // A wrong count must not reach beyond the buffer.
                let start = (start as usize).min(length);
                start..start.saturating_add(count as usize).min(length)
            };
            let own = &coordinates[range(record.vertex, v, coordinates.len())];
            let joined = &indices[range(record.primitive, p, indices.len())];
            let primitives = if record.domain == 2 {
                Primitives::Segments(joined.iter().map(|[a, b, ..]| [*a, *b]).collect())
            } else {
                Primitives::Triangles(joined.iter().map(|[a, b, c, _]| [*a, *b, *c]).collect())
            };
            see(
                k,
                (
                    own.iter().map(|[u, v, w, _]| [*u, *v, *w]).collect(),
                    primitives,
                ),
            );
        }
        Ok(())
    }
}

pub(crate) fn record(
    tessellator: &Tessellator,
    levels: &Levels,
    vertex: u32,
    primitive: u32,
) -> CaseRecord {
    CaseRecord {
        outer: levels.outer.map(f32::to_bits),
        inner: levels.inner.map(f32::to_bits),
        domain: match tessellator.domain {
            Domain::Triangles => 0,
            Domain::Quads => 1,
            Domain::Isolines => 2,
        },
        spacing: match tessellator.spacing {
            Spacing::Equal => 0,
            Spacing::FractionalEven => 1,
            Spacing::FractionalOdd => 2,
        },
        mode: u32::from(tessellator.mode == Mode::D3d),
        clockwise: u32::from(tessellator.winding == Winding::Cw),
        vertex,
        primitive,
    }
}
