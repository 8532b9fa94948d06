// Writes `BlinnPhongMaterial` into the G-buffer.

#import bevy_pbr::prepass_io::{FragmentOutput, VertexOutput}
#ifdef MOTION_VECTOR_PREPASS
#import bevy_pbr::pbr_prepass_functions::calculate_motion_vector
#endif
#ifdef VERTEX_OUTPUT_INSTANCE_INDEX
#import bevy_pbr::mesh_bindings::mesh
#import bevy_pbr::mesh_types::MESH_FLAGS_SHADOW_RECEIVER_BIT
#endif
#ifdef DEFERRED_PREPASS
#import dolomite::deferred::blinn_phong::exponent_bytes
#import dolomite::deferred::gbuffer::{FOG, SHADOW_RECEIVER, encode_color, pack_bytes, pack_emissive, pack_normal}
#endif

struct BlinnPhong {
    diffuse: vec4<f32>,
    specular: vec4<f32>,
    // Radiance; not changed by the exposure.
    emissive: vec4<f32>,
    exponent: f32,
}

@group(#{MATERIAL_BIND_GROUP}) @binding(0) var<uniform> material: BlinnPhong;

// Of this shading model.
const LIGHTING_ID: u32 = 2u;

@fragment
fn fragment(in: VertexOutput) -> FragmentOutput {
    var out: FragmentOutput;
#ifdef DEFERRED_PREPASS
    var flags = FOG;
#ifdef VERTEX_OUTPUT_INSTANCE_INDEX
    if (mesh[in.instance_index].flags & MESH_FLAGS_SHADOW_RECEIVER_BIT) != 0u {
        flags |= SHADOW_RECEIVER;
    }
#else
    flags |= SHADOW_RECEIVER;
#endif
    let exponent = exponent_bytes(material.exponent);
    out.deferred = vec4(
        pack_bytes(vec4(encode_color(saturate(material.diffuse.rgb)), exponent.x)),
        pack_emissive(material.emissive.rgb),
        pack_bytes(vec4(encode_color(saturate(material.specular.rgb)), exponent.y)),
        pack_normal(normalize(in.world_normal), flags),
    );
    out.deferred_lighting_pass_id = LIGHTING_ID;
#endif
#ifdef NORMAL_PREPASS
    out.normal = vec4(in.world_normal * 0.5 + 0.5, 1.0);
#endif
#ifdef MOTION_VECTOR_PREPASS
    out.motion_vector = calculate_motion_vector(in.world_position, in.previous_world_position);
#endif
    return out;
}
