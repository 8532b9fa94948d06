//! The format is Bevy's: our functions and Bevy's run side by side on the adapter, and so does the CPU reference.

use bevy::math::{Vec3, Vec4};
use bevy::prelude::*;
use bevy::render::RenderApp;
use bevy::render::render_resource::binding_types::{
    storage_buffer_read_only_sized, storage_buffer_sized,
};
use bevy::render::render_resource::{
    BindGroupEntries, BindGroupLayoutDescriptor, BindGroupLayoutEntries, BufferDescriptor,
    BufferInitDescriptor, BufferUsages, CachedComputePipelineId, CachedPipelineState,
    CommandEncoderDescriptor, ComputePassDescriptor, ComputePipelineDescriptor, MapMode,
    PipelineCache, PollType, ShaderStages,
};
use bevy::render::renderer::{RenderDevice, RenderQueue};
use bevy::shader::Shader;
use dolomite_deferred::gbuffer;
use dolomite_testkit::random::Random;

use dolomite_testkit::light as support;

/// Words that an input gives.
const WORDS: usize = 26;

const BOTH: &str = "
#import bevy_pbr::pbr_deferred_types as bevy_types
#import bevy_pbr::rgb9e5 as bevy_emissive
#import bevy_pbr::utils as bevy_utils
#import dolomite::deferred::gbuffer as ours

@group(0) @binding(0) var<storage, read> inputs: array<vec4<f32>>;
@group(0) @binding(1) var<storage, read_write> outputs: array<u32>;

fn put3(at: u32, v: vec3<f32>) {
    for (var k = 0u; k < 3u; k++) { outputs[at + k] = bitcast<u32>(v[k]); }
}
fn put4(at: u32, v: vec4<f32>) {
    for (var k = 0u; k < 4u; k++) { outputs[at + k] = bitcast<u32>(v[k]); }
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let at = id.x * 26u;
    let v = inputs[id.x];
    let normal = normalize(v.xyz - 0.5);
    let packed = bevy_types::pack_unorm4x8_(v);
    outputs[at] = ours::pack_bytes(v);
    outputs[at + 1u] = packed;
    outputs[at + 2u] = ours::pack_emissive(v.xyz * exp2(v.w * 40.0 - 25.0));
    outputs[at + 3u] = bevy_emissive::vec3_to_rgb9e5_(v.xyz * exp2(v.w * 40.0 - 25.0));
    outputs[at + 4u] = ours::pack_normal(normal, packed & 255u);
    outputs[at + 5u] = bevy_types::pack_24bit_normal_and_flags(bevy_utils::octahedral_encode(normal), packed & 255u);
    // Any word is a pixel.
    let word = outputs[at + 3u] ^ packed;
    put4(at + 6u, ours::unpack_bytes(word));
    put4(at + 10u, bevy_types::unpack_unorm4x8_(word));
    put3(at + 14u, ours::unpack_emissive(word));
    put3(at + 17u, bevy_emissive::rgb9e5_to_vec3_(word));
    put3(at + 20u, ours::unpack_normal(word));
    put3(at + 23u, bevy_utils::octahedral_decode(bevy_types::unpack_24bit_normal(word)));
}
";

/// Runs [`BOTH`] over inputs.
fn run(app: &mut App, inputs: &[Vec4]) -> Vec<[u32; WORDS]> {
    let shader = Shader::from_wgsl(BOTH, "both.wgsl");
    let shader = app.world_mut().resource_mut::<Assets<Shader>>().add(shader);
    let layout = BindGroupLayoutDescriptor::new(
        "both",
        &BindGroupLayoutEntries::sequential(
            ShaderStages::COMPUTE,
            (
                storage_buffer_read_only_sized(false, None),
                storage_buffer_sized(false, None),
            ),
        ),
    );
    let cache = app.sub_app(RenderApp).world().resource::<PipelineCache>();
    let id: CachedComputePipelineId = cache.queue_compute_pipeline(ComputePipelineDescriptor {
        label: Some("both".into()),
        layout: vec![layout.clone()],
        shader,
        entry_point: Some("main".into()),
        ..default()
    });
    for _ in 0..200 {
        support::frames(app, 1);
        let cache = app.sub_app(RenderApp).world().resource::<PipelineCache>();
        if let CachedPipelineState::Ok(_) = cache.get_compute_pipeline_state(id) {
            break;
        }
        // Bevy's files come from a thread of their own.
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    let device = app.world().resource::<RenderDevice>().clone();
    let queue = app.world().resource::<RenderQueue>().clone();
    let cache = app.sub_app(RenderApp).world().resource::<PipelineCache>();
    let pipeline = cache.get_compute_pipeline(id).expect("compiled");
    let size = (inputs.len() * WORDS * 4) as u64;
    let given = device.create_buffer_with_data(&BufferInitDescriptor {
        label: None,
        contents: bytemuck::cast_slice(&inputs.iter().map(|v| v.to_array()).collect::<Vec<_>>()),
        usage: BufferUsages::STORAGE,
    });
    // A sentinel, so that what is not written is seen.
    let words = device.create_buffer_with_data(&BufferInitDescriptor {
        label: None,
        contents: &vec![0xa5; size as usize],
        usage: BufferUsages::STORAGE | BufferUsages::COPY_SRC,
    });
    let back = device.create_buffer(&BufferDescriptor {
        label: None,
        size,
        usage: BufferUsages::COPY_DST | BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let group = device.create_bind_group(
        "both",
        &cache.get_bind_group_layout(&layout),
        &BindGroupEntries::sequential((
            given.as_entire_buffer_binding(),
            words.as_entire_buffer_binding(),
        )),
    );
    let mut encoder = device.create_command_encoder(&CommandEncoderDescriptor::default());
    {
        let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor::default());
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups((inputs.len() / 64) as u32, 1, 1);
    }
    encoder.copy_buffer_to_buffer(&words, 0, &back, 0, size);
    queue.submit([encoder.finish()]);
    back.slice(..)
        .map_async(MapMode::Read, |result| result.expect("mapped"));
    device.poll(PollType::wait_indefinitely()).expect("done");
    let bytes = back.slice(..).get_mapped_range().to_vec();
    bytemuck::pod_collect_to_vec(&bytes)
}

fn floats<const N: usize>(words: &[u32]) -> [f32; N] {
    std::array::from_fn(|k| f32::from_bits(words[k]))
}

#[test]
fn ours_bevys_and_rusts_give_the_same_words() {
    let Some(mut app) = support::app(true) else {
        return;
    };
    let mut random = Random::new(7);
    let mut inputs: Vec<Vec4> = (0..65_536)
        .map(|_| Vec4::from_array(std::array::from_fn(|_| random.range(-0.1, 1.1))))
        .collect();
    // Axes and the middle of edges, where signs decide.
    for (k, input) in inputs.iter_mut().take(27).enumerate() {
        let at = |digit: usize| [0.0, 0.5, 1.0][digit % 3];
        *input = Vec4::new(at(k), at(k / 3), at(k / 9), 0.6);
    }
    let outputs = run(&mut app, &inputs);
    let mut other = 0;
    for (input, words) in inputs.iter().zip(&outputs) {
        assert_eq!(words[0], words[1], "bytes of {input}");
        assert_eq!(
            words[0],
            gbuffer::pack_bytes(input.to_array()),
            "bytes of {input}"
        );
        assert_eq!(words[2], words[3], "emissive of {input}");
        if (input.truncate() - 0.5).length() > 0.0 {
            assert_eq!(words[4], words[5], "normal of {input}");
            let normal = (input.truncate() - 0.5).normalize();
            let rust = gbuffer::pack_normal(normal, words[1] & 255);
            // The adapter's division may round the other way.
            other += usize::from(rust != words[4]);
            let apart = gbuffer::unpack_normal(rust).distance(gbuffer::unpack_normal(words[4]));
            assert!(apart < 1.5e-3, "{normal}: {apart}");
        }
        let word = words[3] ^ words[1];
        assert_eq!(words[6..10], words[10..14], "bytes of {word:#x}");
        assert_eq!(floats::<4>(&words[6..]), gbuffer::unpack_bytes(word));
        assert_eq!(
            floats::<3>(&words[14..]),
            gbuffer::unpack_emissive(word).to_array()
        );
        let bevys = Vec3::from_array(floats(&words[17..]));
        let off = (Vec3::from_array(floats(&words[14..])) - bevys)
            .abs()
            .max_element();
        // Bevy's `exp2` of a whole number need not be exact.
        assert!(
            off <= 1e-6 * bevys.max_element(),
            "emissive of {word:#x}: {off}"
        );
        let normals = [20, 23].map(|at| Vec3::from_array(floats(&words[at..])));
        let rust = gbuffer::unpack_normal(word);
        for normal in normals {
            assert!(
                normal.distance(rust) < 4e-7,
                "normal of {word:#x}: {normal} {rust}"
            );
        }
    }
    assert!(
        other < outputs.len() / 500,
        "{other} normals of the CPU reference are another code"
    );
}
