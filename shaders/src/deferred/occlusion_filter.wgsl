// The mean of what was found about each pixel over the pattern of 4 × 4, of pixels that lie in its plane; where that was
// found for each second pixel of each second row, it is spread over all.

#import bevy_render::view::View
#import dolomite::deferred::gbuffer::unpack_normal
#import dolomite::deferred::occlusion::{Settings, eye_of, footprint, metres_of, place_of, share_of}

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> settings: Settings;
@group(0) @binding(2) var depths: texture_depth_2d;
@group(0) @binding(3) var gbuffer: texture_2d<u32>;
@group(0) @binding(4) var traced: texture_2d<f32>;
@group(0) @binding(5) var visible: texture_storage_2d<r32float, write>;

@compute @workgroup_size(8, 8)
fn filter_pixels(@builtin(global_invocation_id) id: vec3<u32>) {
    let pixel = vec2<i32>(id.xy);
    let size = vec2<i32>(view.viewport.zw);
    if any(pixel >= size) {
        return;
    }
    let corner = vec2<i32>(view.viewport.xy);
    let depth = textureLoad(depths, pixel + corner, 0);
    if depth <= 0.0 {
        textureStore(visible, pixel, vec4(1.0));
        return;
    }
    let eye = eye_of(view.clip_from_view, vec2<f32>(size));
    let metres = metres_of(depth, view.clip_from_view);
    let scale = settings.scale;
    let cells = (size + scale - 1) / scale;
    let middle = pixel / scale;
    let rest = vec2<f32>(pixel - middle * scale) / f32(scale);
    let place = place_of(eye, pixel, metres);
    let word = textureLoad(gbuffer, pixel + corner, 0).w;
    let normal = (view.view_from_world * vec4(unpack_normal(word), 0.0)).xyz;
    let unit = footprint(eye, metres) * f32(scale);
    var sum = 0.0;
    var weights = 0.0;
    var best = 1.0;
    var nearest = 3e38;
    for (var k = 0; k < 25; k++) {
        let offset = vec2(k % 5, k / 5) - 2;
        let at = middle + offset;
        if any(at < vec2(0)) || any(at >= cells) {
            continue;
        }
        let found = textureLoad(traced, at, 0).xy;
        if found.y <= 0.0 {
            continue;
        }
        let off = abs(dot(normal, place_of(eye, at * scale, found.y) - place)) / unit;
        if off < nearest {
            nearest = off;
            best = found.x;
        }
        let weight = share_of(vec2<f32>(offset) - rest) * max(1.0 - 0.5 * off, 0.0);
        sum += weight * found.x;
        weights += weight;
    }
    // None in its plane: the one that is the nearest to it.
    var mean = best;
    if weights >= 1e-3 {
        mean = sum / weights;
    }
    textureStore(visible, pixel, vec4(mean));
}
