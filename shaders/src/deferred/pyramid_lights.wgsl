// Of the lights that a view lists, which lie wholly behind what is drawn: a bit each, 0 for hidden.

#import bevy_render::view::View
#import dolomite::deferred::pyramid::{Footprint, footprint_of, level, level_of}
#import dolomite::deferred::types::Light

struct Lighting {
    lights: u32,
    in_tiles: u32,
    tiles: vec2<u32>,
    room: u32,
    brightest: f32,
    open: u32,
    pad: u32,
}

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> lighting: Lighting;
@group(0) @binding(2) var<storage, read> lights: array<Light>;
@group(0) @binding(3) var<storage, read> listed: array<u32>;
@group(0) @binding(4) var<storage, read> texels: array<f32>;
@group(0) @binding(5) var<storage, read_write> shown: array<u32>;

fn is_hidden(footprint: Footprint, size: vec2<u32>) -> bool {
    if footprint.cut {
        return false;
    }
    let index = level_of(footprint);
    let at = level(size, index);
    let low = footprint.low >> vec2(index);
    let high = footprint.high >> vec2(index);
    let farthest = min(
        min(texels[at.first + low.y * at.size.x + low.x], texels[at.first + low.y * at.size.x + high.x]),
        min(texels[at.first + high.y * at.size.x + low.x], texels[at.first + high.y * at.size.x + high.x]),
    );
    return footprint.nearest < farthest;
}

// A thread has the lights of a word.
@compute @workgroup_size(64)
fn look(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = vec2<u32>(view.viewport.zw);
    var bits = 0u;
    for (var k = 0u; k < 32u; k++) {
        let i = id.x * 32u + k;
        if i >= lighting.in_tiles {
            break;
        }
        let light = listed[i];
        let m = view.world_from_view;
        let offset = lights[light].position - view.world_position;
        let middle = vec3(dot(m[0].xyz, offset), dot(m[1].xyz, offset), dot(m[2].xyz, offset));
        // More than the rounding of the sums above.
        let reach = lights[light].range * 1.001 + 1e-6 * length(offset);
        let footprint = footprint_of(middle - reach, middle + reach, view.clip_from_view, size);
        if !is_hidden(footprint, size) {
            bits |= 1u << k;
        }
    }
    if id.x * 32u < lighting.in_tiles {
        shown[id.x] = bits;
    }
}
