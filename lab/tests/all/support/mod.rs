//! What the tests of the stage's passes share.

use dolomite_tessellation::tables::Instance;
use dolomite_tessellation::{PatchMesh, Spacing, Tessellator};
use dolomite_testkit::gpu::Gpu;
use dolomite_testkit::stage::{Emitted, StagePasses, StageRun};
use std::sync::Arc;

pub const SPACINGS: [Spacing; 3] = [
    Spacing::Equal,
    Spacing::FractionalEven,
    Spacing::FractionalOdd,
];

/// Numbers from 0 to 1 (splitmix64: Steele, Lea and Flood 2014).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 40) as f32 / (1 << 24) as f32
    }
}

/// An entity whose edges take their levels from the fourth numbers of their ends.
pub fn by_points() -> Instance {
    let mut entity = Instance::IDENTITY;
    entity.params[0][0] = -1.0;
    entity
}

pub fn run(
    gpu: &Gpu,
    tessellator: Tessellator,
    mesh: PatchMesh,
    entity: Instance,
    pools: [u32; 2],
) -> Emitted {
    let passes = StagePasses::new(gpu, tessellator).expect("passes");
    run_with(gpu, &passes, mesh, entity, pools)
}

pub fn run_with(
    gpu: &Gpu,
    passes: &StagePasses,
    mesh: PatchMesh,
    entity: Instance,
    pools: [u32; 2],
) -> Emitted {
    let layout = mesh.layout();
    let stage = StageRun::new(gpu, passes, layout, &[(Arc::new(mesh), entity)], pools);
    let stage = stage.expect("a mesh of a few patches");
    stage.tessellate(1).expect("a run");
    stage.read().expect("what was emitted")
}

pub fn triangles(emitted: &Emitted) -> Vec<[u32; 3]> {
    let chunks = emitted.indices.chunks_exact(3);
    chunks.map(|chunk| [chunk[0], chunk[1], chunk[2]]).collect()
}
