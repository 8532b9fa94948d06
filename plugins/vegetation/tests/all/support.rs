//! What several tests need.

use dolomite_shaders::{ShaderFile, compose_with};
use dolomite_testkit::gpu::{Binding, Gpu, Kernel};

/// A kernel of a probe: `source` is an entry file.
pub fn probe(gpu: &Gpu, source: &'static str, entry: &str) -> Kernel {
    let path = "probe.wgsl";
    let file = ShaderFile { path, source };
    let module = composed(path, &[file]);
    gpu.kernel(module, entry).expect("the probe is valid")
}

/// A file of ours, or one of `others`, with all that it imports.
pub fn composed(path: &str, others: &[ShaderFile]) -> naga::Module {
    compose_with(path, &[], others).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// Runs a probe of a thread an item, 64 a workgroup: words in, words out.
pub fn run(gpu: &Gpu, kernel: &Kernel, given: &[u32], threads: usize, words: usize) -> Vec<u32> {
    let mut found = vec![0_u8; threads * words * 4];
    let groups = &mut [vec![
        Binding::Read(bytemuck::cast_slice(given)),
        Binding::Write(&mut found),
    ]];
    let count = threads.div_ceil(64) as u32;
    gpu.run(kernel, groups, [count, 1, 1]).expect("it runs");
    bytemuck::pod_collect_to_vec(&found)
}

/// PCG (O'Neill 2014).
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u32 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 32) as u32
    }

    /// 0 up to 1.
    pub fn unit(&mut self) -> f64 {
        f64::from(self.bits()) / 4_294_967_296.0
    }
}
