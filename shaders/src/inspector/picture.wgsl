// A picture of what a frame is made of, in its place: one triangle over the view, which reads one texture or buffer.
// A definition says which picture, another what it reads.

#import dolomite::deferred::gbuffer::{decode_color, unpack_bytes, unpack_emissive, unpack_flags, unpack_normal}
#import dolomite::deferred::pyramid::level
#import dolomite::inspector::colours::{DRAWN, KEPT, NOTHING, bounded, distance_grey, encoded_of, heat, level_colour, linear_of, motion_colour, ramp}
#import dolomite::inspector::legend::{with_levels, with_ramp}

// `Look` of `picture/render.rs`.
struct Look {
    // Of a pixel (ndc x, ndc y, depth, 1): z and w of its place in view space.
    to_z: vec4<f32>,
    to_w: vec4<f32>,
    // First pixel and size of the view.
    viewport: vec4<f32>,
    // Metres that are white, and black.
    near: f32,
    far: f32,
    // Pixels a frame of full colour.
    fastest: f32,
    // The count that is red.
    most: f32,
    pyramid_level: u32,
    // Of the reference, the difference at the end of the ramp.
    difference: f32,
}

@group(0) @binding(0) var<uniform> look: Look;

#ifdef WORDS
// Bevy's deferred target.
@group(0) @binding(1) var words: texture_2d<u32>;
#endif
#ifdef DEPTHS
#ifdef MANY_SAMPLES
@group(0) @binding(1) var depths: texture_depth_multisampled_2d;
#else
@group(0) @binding(1) var depths: texture_depth_2d;
#endif
#endif
#ifdef NUMBERS
#ifdef MANY_SAMPLES
@group(0) @binding(1) var numbers: texture_multisampled_2d<f32>;
#else
@group(0) @binding(1) var numbers: texture_2d<f32>;
#endif
#endif
#ifdef COUNTS
// Lights: of each tile of 16 × 16 pixels, from the second word on: where its list begins, a part of its length, its length.
// The depth pyramid: bits of its texels, a level after the other.
@group(0) @binding(1) var<storage, read> words_read: array<u32>;
#endif
#ifdef LAYERS
@group(0) @binding(1) var layers: texture_depth_2d_array;

// A bit each of the first 256 layers: drawn in this frame, kept from an earlier one.
struct Marks {
    drawn: array<vec4<u32>, 2>,
    kept: array<vec4<u32>, 2>,
}

@group(0) @binding(2) var<uniform> marks: Marks;

fn is_marked(bits: array<vec4<u32>, 2>, layer: u32) -> bool {
    var all = bits;
    return layer < 256u && ((all[layer >> 7u][(layer >> 5u) & 3u] >> (layer & 31u)) & 1u) == 1u;
}

// Pixels of the frame around each map that says what became of it.
const FRAME: f32 = 3.0;

// All layers side by side, as many in a row as in a column. `power`: what the depth is raised to.
fn maps_at(place: vec2<f32>, power: f32) -> vec3<f32> {
    let count = u32(textureNumLayers(layers));
    let side = u32(ceil(sqrt(f32(count))));
    let cell = (place - look.viewport.xy) / look.viewport.zw * f32(side);
    let layer = u32(cell.y) * side + u32(cell.x);
    if layer >= count {
        return vec3(0.0, 0.0, 0.125);
    }
    let within = min(fract(cell), 1.0 - fract(cell)) * look.viewport.zw / f32(side);
    if min(within.x, within.y) < FRAME {
        return select(select(NOTHING, KEPT, is_marked(marks.kept, layer)), DRAWN, is_marked(marks.drawn, layer));
    }
    let texel = vec2<i32>(fract(cell) * vec2<f32>(textureDimensions(layers)));
    return vec3(pow(textureLoad(layers, texel, layer, 0), power));
}
#endif

// The grey of a depth at a place.
fn depth_grey(place: vec2<f32>, depth: f32) -> vec3<f32> {
    let ndc = (place - look.viewport.xy) / look.viewport.zw * vec2(2.0, -2.0) + vec2(-1.0, 1.0);
    let at = vec4(ndc, depth, 1.0);
    let w = dot(look.to_w, at);
    // Reversed depth: 0 lies infinitely far away, and there w is 0 as well.
    if depth <= 0.0 || w == 0.0 {
        return vec3(0.0, 0.0, 0.125);
    }
    return vec3(distance_grey(-dot(look.to_z, at) / w, look.near, look.far));
}

// The count at the end of the ramp of overdraw.
const MOST_OVERDRAW: f32 = 8.0;

// What is shown of a pixel, as a picture file keeps it.
fn shown(place: vec2<f32>) -> vec3<f32> {
    let pixel = vec2<i32>(place);
    var colour = vec3(0.0);
#ifdef WORDS
    let word = textureLoad(words, pixel, 0);
    // Nothing of the G-buffer is there: the sky, or what was drawn later.
    if all(word == vec4(0u)) {
        return vec3(0.0);
    }
#endif
#ifdef BASE_COLOUR
    colour = encoded_of(decode_color(unpack_bytes(word.x).rgb));
#endif
#ifdef ROUGHNESS
    colour = vec3(unpack_bytes(word.x).a);
#endif
#ifdef REFLECTANCE
    colour = vec3(unpack_bytes(word.z).x);
#endif
#ifdef METALLIC
    colour = vec3(unpack_bytes(word.z).y);
#endif
#ifdef BAKED_OCCLUSION
    colour = vec3(unpack_bytes(word.z).z);
#endif
#ifdef EMITTED
    colour = encoded_of(bounded(unpack_emissive(word.y)));
#endif
#ifdef NORMALS_OF_WORDS
    colour = unpack_normal(word.w) * 0.5 + 0.5;
#endif
#ifdef FLAGS
    let flags = unpack_flags(word.w);
    colour = vec3<f32>((vec3(flags) >> vec3(0u, 1u, 2u)) & vec3(1u));
#endif
#ifdef DISTANCE
    colour = depth_grey(place, textureLoad(depths, pixel, 0));
#endif
#ifdef DEPTH_PYRAMID
    let size = vec2<u32>(look.viewport.zw);
    // The last level has one texel.
    let most = max(32u - countLeadingZeros(max(max(size.x, size.y), 1u) - 1u), 1u);
    let index = clamp(look.pyramid_level, 1u, most);
    let own = level(size, index);
    let of_pyramid = vec2<u32>(place - look.viewport.xy) >> vec2(index);
    colour = depth_grey(place, bitcast<f32>(words_read[own.first + of_pyramid.y * own.size.x + of_pyramid.x]));
#endif
#ifdef GROUND_LEVEL
    let bisections = textureLoad(numbers, pixel, 0).r;
    colour = NOTHING;
    if bisections >= 0.0 {
        colour = level_colour(u32(bisections) / 2u);
    }
    colour = with_levels(colour, place - look.viewport.xy, look.viewport.zw);
#endif
#ifdef GROUND_ERROR
    let error = textureLoad(numbers, pixel, 0).rg;
    colour = NOTHING;
    if error.r >= 0.0 {
        colour = ramp(error.r / error.g);
    }
    colour = with_ramp(colour, place - look.viewport.xy, look.viewport.zw, error.g, true);
#endif
#ifdef GROUND_OVERDRAW
    let count = textureLoad(numbers, pixel, 0).r;
    colour = select(NOTHING, ramp(count / MOST_OVERDRAW), count > 0.0);
    colour = with_ramp(colour, place - look.viewport.xy, look.viewport.zw, MOST_OVERDRAW, false);
#endif
#ifdef LIGHT_DIFFERENCE
    let off = textureLoad(numbers, pixel, 0).r;
    colour = select(NOTHING, ramp(off / look.difference), off >= 0.0);
    // In percent.
    colour = with_ramp(colour, place - look.viewport.xy, look.viewport.zw, 100.0 * look.difference, false);
#endif
#ifdef GRASS_RANK
    // Of the ranks that stand where the kind grows best the share that comes before it.
    let rank = textureLoad(numbers, pixel, 0).rg;
    colour = select(NOTHING, ramp(rank.r / rank.g), rank.r >= 0.0);
    colour = with_ramp(colour, place - look.viewport.xy, look.viewport.zw, 1.0, false);
#endif
#ifdef NORMALS
    colour = textureLoad(numbers, pixel, 0).rgb;
#endif
#ifdef MOTION
    colour = motion_colour(textureLoad(numbers, pixel, 0).rg * look.viewport.zw, look.fastest);
#endif
#ifdef SHARE
    colour = vec3(textureLoad(numbers, pixel, 0).r);
#endif
#ifdef LIGHT_COUNTS
    let tile = vec2<u32>(place - look.viewport.xy) / 16u;
    let across = (u32(look.viewport.z) + 15u) / 16u;
    colour = heat(f32(words_read[3u + 3u * (tile.y * across + tile.x)]) / look.most);
#endif
#ifdef SHADOW_MAPS
    colour = maps_at(place, 1.0);
#endif
#ifdef POINT_SHADOW_MAPS
    // Depth is the near plane over the distance: its fourth root tells apart what is far.
    colour = maps_at(place, 0.25);
#endif
    return colour;
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    let corner = vec2(f32(index & 1u), f32(index >> 1u)) * 4.0 - 1.0;
    return vec4(corner, 0.0, 1.0);
}

@fragment
fn fragment(@builtin(position) place: vec4<f32>) -> @location(0) vec4<f32> {
#ifdef ENCODED
    return vec4(shown(place.xy), 1.0);
#else
    return vec4(linear_of(shown(place.xy)), 1.0);
#endif
}
