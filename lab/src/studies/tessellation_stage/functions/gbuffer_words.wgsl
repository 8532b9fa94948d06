#define_import_path bevy_pbr::pbr_deferred_types

// Stands in for Bevy's module of this name, with what the stage's draw takes from it.

const DEFERRED_FLAGS_UNLIT_BIT: u32 = 1u;
const DEFERRED_FLAGS_FOG_ENABLED_BIT: u32 = 2u;
const DEFERRED_MESH_FLAGS_SHADOW_RECEIVER_BIT: u32 = 4u;

fn pack_unorm4x8_(values: vec4<f32>) -> u32 {
    let v = vec4<u32>(saturate(values) * 255.0 + 0.5);
    return (v.w << 24u) | (v.z << 16u) | (v.y << 8u) | v.x;
}

fn pack_24bit_normal_and_flags(octahedral_normal: vec2<f32>, flags: u32) -> u32 {
    let n = vec2<u32>(saturate(octahedral_normal) * 4095.0 + 0.5);
    return n.x | (n.y << 12u) | ((flags & 0xffu) << 24u);
}
