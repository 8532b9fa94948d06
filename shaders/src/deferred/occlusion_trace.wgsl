// How much of the light from everywhere reaches each pixel, or each second one of each second row: looked for in the
// depths around it.

#import bevy_render::view::View
#import dolomite::deferred::gbuffer::unpack_normal
#import dolomite::deferred::occlusion::{
    PI, Eye, Settings, Slice, eye_of, footprint, metres_of, parts, pattern, place_of, share_in, slice_of, towards_eye,
}

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> settings: Settings;
@group(0) @binding(2) var depths: texture_depth_2d;
@group(0) @binding(3) var gbuffer: texture_2d<u32>;
// The share of the light, and the metres along the camera's axis; 0 where there is nothing.
@group(0) @binding(4) var traced: texture_storage_2d<rg32float, write>;

// 0 where there is nothing. Of the view, not of its target.
fn metres_at(pixel: vec2<i32>) -> f32 {
    let depth = textureLoad(depths, pixel + vec2<i32>(view.viewport.xy), 0);
    if depth <= 0.0 {
        return 0.0;
    }
    return metres_of(depth, view.clip_from_view);
}

// The parts of a slice that pixels on both sides hide.
fn hidden_parts(eye: Eye, pixel: vec2<i32>, place: vec3<f32>, normal: vec3<f32>, slice: Slice, reach: f32, shift: f32) -> u32 {
    let across = select(slice.tangent.xy * -place.z + place.xy * slice.tangent.z, slice.tangent.xy, eye.orthographic);
    let along = normalize(across) * vec2(1.0, -1.0);
    let size = vec2<i32>(eye.size);
    let steps = f32(settings.steps);
    var hidden = 0u;
    for (var k = 0u; k < 2u * settings.steps; k++) {
        let step = f32(k >> 1u);
        let far = (step + shift) / steps;
        let side = select(1.0, -1.0, (k & 1u) == 0u);
        let offset = max(reach * far * far, 1.0 + step) * side;
        let at = pixel + vec2<i32>(floor(along * offset + 0.5));
        if any(at < vec2(0)) || any(at >= size) {
            continue;
        }
        let metres = metres_at(at);
        if metres <= 0.0 {
            continue;
        }
        let other = place_of(eye, at, metres);
        let away = other - place;
        // From what is seen through what is behind it, as long as things are thick: what of that is in the radius. What is
        // seen may lie outside and yet be in the way behind.
        let behind = -towards_eye(eye, other);
        let along = dot(away, behind);
        let aside = away - along * behind;
        let room = settings.radius * settings.radius - dot(aside, aside);
        if room <= 0.0 {
            continue;
        }
        let half_way = sqrt(room);
        let first = max(-along - half_way, 0.0);
        let last = min(half_way - along, settings.thickness);
        if first >= last {
            continue;
        }
        let front = share_in(slice, away + first * behind, normal, side);
        let back = share_in(slice, away + last * behind, normal, side);
        hidden |= parts(min(front, back), max(front, back));
    }
    return hidden;
}

fn visible_from(pixel: vec2<i32>, cell: vec2<i32>, metres: f32, eye: Eye) -> f32 {
    let reach = min(settings.radius / footprint(eye, metres), settings.most_pixels);
    // Within less than two pixels nothing can be told apart.
    if reach < 2.0 {
        return 1.0;
    }
    let place = place_of(eye, pixel, metres);
    let towards = towards_eye(eye, place);
    let word = textureLoad(gbuffer, pixel + vec2<i32>(view.viewport.xy), 0).w;
    let normal = (view.view_from_world * vec4(unpack_normal(word), 0.0)).xyz;
    let told = pattern(cell);
    let across = normalize(vec3(towards.z, 0.0, -towards.x));
    let up = cross(towards, across);
    var sum = 0.0;
    var weights = 0.0;
    for (var k = 0u; k < settings.slices; k++) {
        let turn = PI * (f32(k) + told.x) / f32(settings.slices);
        let slice = slice_of(cos(turn) * across + sin(turn) * up, towards, normal);
        let hidden = hidden_parts(eye, pixel, place, normal, slice, reach, told.y);
        sum += slice.length * f32(32u - countOneBits(hidden)) / 32.0;
        weights += slice.length;
    }
    return sum / max(weights, 1e-6);
}

@compute @workgroup_size(8, 8)
fn trace(@builtin(global_invocation_id) id: vec3<u32>) {
    let cell = vec2<i32>(id.xy);
    let pixel = cell * settings.scale;
    let size = vec2<i32>(view.viewport.zw);
    if any(pixel >= size) {
        return;
    }
    let metres = metres_at(pixel);
    var visible = 1.0;
    if metres > 0.0 {
        visible = visible_from(pixel, cell, metres, eye_of(view.clip_from_view, vec2<f32>(size)));
    }
    textureStore(traced, cell, vec4(visible, metres, 0.0, 0.0));
}
