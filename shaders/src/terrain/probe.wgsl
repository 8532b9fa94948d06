// Heights of a list of places, a thread a place: for tests and studies of the CPU reference.

#import dolomite::terrain::fixed::GroundPoint
#import dolomite::terrain::height::terrain_height

@group(0) @binding(0) var<storage, read> places: array<GroundPoint>;
// Value, d/dx, d/dz, 1: the last shows that the place was answered.
@group(0) @binding(1) var<storage, read_write> heights: array<vec4<f32>>;

@compute @workgroup_size(64)
fn probe(
    @builtin(global_invocation_id) thread: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let i = thread.x + thread.y * groups.x * 64u;
    if i < arrayLength(&places) {
        heights[i] = vec4(terrain_height(places[i]), 1.0);
    }
}
