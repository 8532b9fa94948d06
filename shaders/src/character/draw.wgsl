// A crowd into Bevy's passes: shadow maps, prepass, G-buffer, forward. Which figure an instance is says its
// mesh tag. Without Bevy (`CROWD_MATERIAL` is not set): an instance a figure, by `clip_from_anchor`.

#import dolomite::character::bindings::{crowd, figures}
#import dolomite::character::figure::{placed, turned}
#import dolomite::character::skin::{skinned_normal, skinned_position, vertex_rows}

#ifdef CROWD_MATERIAL
#import bevy_pbr::mesh_functions::get_tag
#import bevy_pbr::view_transformations::position_world_to_clip
#ifdef PREPASS_PIPELINE
#import bevy_pbr::prepass_io::VertexOutput
#else
#import bevy_pbr::forward_io::VertexOutput
#endif

struct Vertex {
    @builtin(instance_index) instance: u32,
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) uv: vec2<f32>,
    @location(3) joints: vec4<u32>,
    @location(4) weights: vec4<f32>,
}

@vertex
fn vertex(vertex: Vertex) -> VertexOutput {
    var out: VertexOutput;
    let figure = figures[get_tag(vertex.instance)];
    let rows = vertex_rows(figure, vertex.joints, vertex.weights);
    let position = placed(figure, skinned_position(rows, vertex.position)) + crowd.anchor;
    out.position = position_world_to_clip(position);
#ifdef UNCLIPPED_DEPTH_ORTHO_EMULATION
    out.unclipped_depth = out.position.z;
    out.position.z = min(out.position.z, 1.0);
#endif
    out.world_position = vec4(position, 1.0);
#ifdef PREPASS_PIPELINE
#ifdef NORMAL_PREPASS_OR_DEFERRED_PREPASS
    out.world_normal = turned(figure, skinned_normal(rows, vertex.normal));
#endif
#ifdef MOTION_VECTOR_PREPASS
    // The palette holds no frame before this one: a figure counts as at rest in the world.
    out.previous_world_position = out.world_position;
#endif
#else
    out.world_normal = turned(figure, skinned_normal(rows, vertex.normal));
#endif
#ifdef VERTEX_UVS_A
    out.uv = vertex.uv;
#endif
#ifdef VERTEX_OUTPUT_INSTANCE_INDEX
    out.instance_index = vertex.instance;
#endif
    return out;
}
#else

@group(1) @binding(0) var<uniform> clip_from_anchor: mat4x4<f32>;

struct Vertex {
    @builtin(instance_index) instance: u32,
    @location(0) position: vec3<f32>,
    @location(1) joints: vec4<u32>,
    @location(2) weights: vec4<f32>,
}

@vertex
fn vertex(vertex: Vertex) -> @builtin(position) vec4<f32> {
    let figure = figures[vertex.instance];
    let rows = vertex_rows(figure, vertex.joints, vertex.weights);
    return clip_from_anchor * vec4(placed(figure, skinned_position(rows, vertex.position)), 1.0);
}
#endif
