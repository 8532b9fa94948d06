// Every vertex of every figure, skinned and placed: for tests and studies of the CPU reference.

#import dolomite::character::bindings::figures
#import dolomite::character::figure::{placed, turned}
#import dolomite::character::skin::{skinned_normal, skinned_position, vertex_rows}

struct Vertex {
    position: vec3<f32>,
    // Joint numbers, 16 bits each.
    joints_01: u32,
    normal: vec3<f32>,
    joints_23: u32,
    weights: vec4<f32>,
}

struct Answer {
    // Metres from the anchor. The fourth number of each shows that the place was answered.
    position: vec4<f32>,
    normal: vec4<f32>,
}

@group(1) @binding(0) var<storage, read> vertices: array<Vertex>;
@group(1) @binding(1) var<storage, read_write> answers: array<Answer>;

@compute @workgroup_size(64)
fn probe(
    @builtin(global_invocation_id) thread: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let i = thread.x + thread.y * groups.x * 64u;
    let count = arrayLength(&vertices);
    if i >= count * arrayLength(&figures) {
        return;
    }
    let vertex = vertices[i % count];
    let figure = figures[i / count];
    let joints = vec4(
        vertex.joints_01 & 0xffffu,
        vertex.joints_01 >> 16u,
        vertex.joints_23 & 0xffffu,
        vertex.joints_23 >> 16u,
    );
    let rows = vertex_rows(figure, joints, vertex.weights);
    answers[i].position = vec4(placed(figure, skinned_position(rows, vertex.position)), 1.0);
    answers[i].normal = vec4(turned(figure, skinned_normal(rows, vertex.normal)), 1.0);
}
