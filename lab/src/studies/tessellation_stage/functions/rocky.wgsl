
// A sphere displaced by noise, as assets/shaders/rock.wgsl, of triangles and of quads.

#import dolomite::lab::rock

fn evaluate(input: Patch, at: vec3<f32>) -> Vertex {
    let n = normalize(plane(input, at));
    let given = entity_params(input, 0u);
    let height = rock::relief(n, given.z);
    let place = n * (1.0 + given.y * height.w);
    return Vertex(place, n, at.xy, place, 0u);
}
