//! What grows, from afar: the functions in WGSL give what those in Rust give.

use bevy::render::render_resource::encase::UniformBuffer;
use dolomite_ground::render::GroundLook;
use dolomite_ground::{CanopyLayer, GroundCanopy};
use dolomite_shaders::{ShaderFile, compose_with};
use dolomite_testkit::gpu::{Binding, for_test};

use crate::support::Random;

const PROBE: ShaderFile = ShaderFile {
    path: "probe.wgsl",
    source: "
#import dolomite::ground::canopy::canopy_at
@group(0) @binding(1) var<storage, read> given: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> found: array<vec4<f32>>;
@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&found) { return; }
    let at = given[id.x];
    let canopy = canopy_at(at.x, at.y, at.z, at.w);
    found[id.x] = vec4(canopy.share, canopy.colour);
}
",
};

/// The look alone, where the probe binds it.
const BINDINGS: ShaderFile = ShaderFile {
    path: "ground/bindings.wgsl",
    source: "#define_import_path dolomite::ground::bindings

#import dolomite::ground::types::GroundLook

@group(0) @binding(0) var<uniform> look: GroundLook;
",
};

#[test]
fn what_grows_is_that_of_rust_gpu() {
    let Some(gpu) = for_test() else { return };
    let module = compose_with("probe.wgsl", &[], &[PROBE, BINDINGS]).expect("the probe is valid");
    let kernel = gpu.kernel(module, "probe").expect("the probe is valid");
    let mut random = Random(17);
    let mut unit = || random.unit() as f32;
    let layers = (0..3).map(|k| CanopyLayer {
        height: [10.0 * unit(), 60.0 + 40.0 * unit(), 0.1 + unit()],
        slope: [-1.0, 0.5 + unit(), 1.0 + 10.0 * unit()],
        fade: [50.0 * unit(), 60.0 + 100.0 * unit()],
        entries: std::array::from_fn(|_| [0.3 * unit(), unit(), unit(), f32::from(k as u8)]),
    });
    let canopy = GroundCanopy {
        layers: layers.collect(),
    };
    let look = GroundLook::default().below(Some(&canopy));
    let mut uniform = UniformBuffer::new(Vec::<u8>::new());
    uniform.write(&look).expect("it lies as in WGSL");
    let given: Vec<[f32; 4]> = (0..4096)
        .map(|_| {
            [
                110.0 * unit() - 5.0,
                1.5 * unit(),
                200.0 * unit(),
                unit() * unit(),
            ]
        })
        .collect();
    let mut found = vec![0_u8; given.len() * 16];
    let groups = &mut [vec![
        Binding::Uniform(uniform.as_ref()),
        Binding::Read(bytemuck::cast_slice(&given)),
        Binding::Write(&mut found),
    ]];
    gpu.run(&kernel, groups, [64, 1, 1]).expect("it runs");
    let found: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&found);
    let (mut covered, mut bare) = (0, 0);
    for ([height, slope, distance, sine], found) in given.into_iter().zip(found) {
        let ours = canopy.at(height, slope, distance, sine);
        let [r, g, b] = ours.colour.to_array();
        for (ours, found) in [ours.share, r, g, b].into_iter().zip(found) {
            // WGSL grants log2 an error of 2^-21 or 3 ulp, of places up to 16, whose entries differ by 1 and 3 at most;
            // exp 3 + 2x ulp, of what is below 1.
            assert!(
                (ours - found).abs() < 5e-5,
                "{height} {slope} {distance} {sine}: {ours} {found}"
            );
        }
        covered += u32::from(ours.share > 0.1);
        bare += u32::from(ours.share == 0.0);
    }
    assert!(covered > 500 && bare > 200, "{covered} {bare}");
}
