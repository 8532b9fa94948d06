
// The very function of assets/shaders/rock.wgsl.

#import dolomite::lab::rock

fn evaluate(input: Patch, at: vec3<f32>) -> Vertex {
    return rock::evaluate(input, at);
}
