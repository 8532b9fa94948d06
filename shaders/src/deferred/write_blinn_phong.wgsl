// Writes `BlinnPhongMaterial` into the G-buffer. FACETED gives each triangle its own normal; DIFFUSE_MAP, SPECULAR_MAP
// and NORMAL_MAP say which maps there are.

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
#import dolomite::deferred::dither::dither
#import dolomite::deferred::gbuffer::{FOG, SHADOW_RECEIVER, encode_color, pack_bytes, pack_emissive, pack_normal}
#endif

struct BlinnPhong {
    diffuse: vec4<f32>,
    specular: vec4<f32>,
    // Radiance; not changed by the exposure.
    emissive: vec4<f32>,
    exponent: f32,
    // Of the G-buffer: PHONG.
    flags: u32,
}

@group(#{MATERIAL_BIND_GROUP}) @binding(0) var<uniform> material: BlinnPhong;
@group(#{MATERIAL_BIND_GROUP}) @binding(1) var diffuse_map: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(2) var diffuse_sampler: sampler;
@group(#{MATERIAL_BIND_GROUP}) @binding(3) var specular_map: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(4) var specular_sampler: sampler;
@group(#{MATERIAL_BIND_GROUP}) @binding(5) var normal_map: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(6) var normal_sampler: sampler;

// Of this shading model.
const LIGHTING_ID: u32 = 2u;

// In the world, length 1.
fn normal_of(in: VertexOutput) -> vec3<f32> {
#ifdef FACETED
    // Rows of a picture go down, so that this turns to the eye.
    return normalize(cross(dpdy(in.world_position.xyz), dpdx(in.world_position.xyz)));
#else
    let normal = in.world_normal;
#ifdef NORMAL_MAP
#ifdef VERTEX_UVS_A
#ifdef VERTEX_TANGENTS
    // As MikkTSpace bakes them: not of length 1 before they are added up.
    let tangent = in.world_tangent.xyz;
    let bitangent = cross(normal, tangent) * in.world_tangent.w;
    let local = textureSample(normal_map, normal_sampler, in.uv).xyz * 2.0 - 1.0;
    return normalize(tangent * local.x + bitangent * local.y + normal * local.z);
#endif
#endif
#endif
    return normalize(normal);
#endif
}

@fragment
fn fragment(in: VertexOutput) -> FragmentOutput {
    var out: FragmentOutput;
    let normal = normal_of(in);
#ifdef DEFERRED_PREPASS
    var flags = FOG | material.flags;
#ifdef VERTEX_OUTPUT_INSTANCE_INDEX
    if (mesh[in.instance_index].flags & MESH_FLAGS_SHADOW_RECEIVER_BIT) != 0u {
        flags |= SHADOW_RECEIVER;
    }
#else
    flags |= SHADOW_RECEIVER;
#endif
    var diffuse = material.diffuse.rgb;
    var specular = material.specular.rgb;
#ifdef VERTEX_UVS_A
#ifdef DIFFUSE_MAP
    diffuse *= textureSample(diffuse_map, diffuse_sampler, in.uv).rgb;
#endif
#ifdef SPECULAR_MAP
    specular *= textureSample(specular_map, specular_sampler, in.uv).rgb;
#endif
#endif
    let exponent = exponent_bytes(material.exponent);
    out.deferred = vec4(
        pack_bytes(vec4(encode_color(saturate(diffuse)) + dither(in.position.xy, 0u).xyz, exponent.x)),
        pack_emissive(material.emissive.rgb),
        pack_bytes(vec4(encode_color(saturate(specular)) + dither(in.position.xy, 1u).xyz, exponent.y)),
        pack_normal(normal, flags),
    );
    out.deferred_lighting_pass_id = LIGHTING_ID;
#endif
#ifdef NORMAL_PREPASS
    out.normal = vec4(normal * 0.5 + 0.5, 1.0);
#endif
#ifdef MOTION_VECTOR_PREPASS
    out.motion_vector = calculate_motion_vector(in.world_position, in.previous_world_position);
#endif
    return out;
}
