#define_import_path dolomite::ground::taps

// The material by its two heaviest layers, as a list of taps: places of the textures with a weight. A layer is the
// mean of up to eight: at two scales, in two copies, from two sides. All weights are known before a texture is
// read, most of them are 0, and a loop reads those that are left, whatever they are of: neighbouring pixels go round
// it as often as the one with the most taps. At most MOST_TAPS, however many layers there are.
//
// Nothing jumps: a copy, a scale or a side goes out with a weight of 0. So does the second layer where a third one
// takes its place: both have lost the third one's weight.

#import dolomite::ground::types::NO_TEXTURE
#import dolomite::ground::bindings::{look, albedo_height, normal_roughness, textures}
#import dolomite::ground::layers::{Place, layer_share}
#import dolomite::ground::site::{Blend, Site, FAR_COPIES, FAR_RELIEF, FAR_TILES, FLAT_HEIGHT, scale_uv}
#import dolomite::ground::texturing::copy_offset

const MOST_TAPS: u32 = 16u;

// Bits of the number of a tap.
const COPY: u32 = 1u;
const FAR: u32 = 2u;
const SIDE: u32 = 4u;
const SECOND: u32 = 8u;

// The two heaviest layers; their weights without that of the third.
struct Heaviest {
    layers: vec2<u32>,
    weights: vec2<f32>,
}

fn heaviest(place: Place) -> Heaviest {
    var layers = vec2(0u);
    var weights = vec3(0.0);
    var left = 1.0;
    for (var i = 0u; i < look.count; i++) {
        let share = layer_share(i, place, left);
        let layer = look.order[i].x;
        left = share.y;
        let first = share.x > weights.x;
        let second = share.x > weights.y;
        layers = vec2(select(layers.x, layer, first), select(select(layers.y, layer, second), layers.x, first));
        weights = vec3(
            max(weights.x, share.x),
            max(min(weights.x, share.x), weights.y),
            max(min(weights.y, share.x), weights.z),
        );
    }
    return Heaviest(layers, weights.xy - weights.z);
}

// A share from 0 to 1 that reaches both ends sooner, by `look.deep.w` each.
fn narrowed(share: f32) -> f32 {
    return saturate((share - look.deep.w) / (1.0 - 2.0 * look.deep.w));
}

// Taps of which of two a share from 0 to 1 wants: `bits`, and the same so many further.
fn both(share: f32, bits: u32, shift: u32) -> u32 {
    return select(0u, bits, share < 1.0) | select(0u, bits << shift, share > 0.0);
}

struct Sum {
    albedo: vec3<f32>,
    height: f32,
    bump: vec3<f32>,
    roughness: f32,
    occlusion: f32,
}

fn added(sum: Sum, albedo: vec4<f32>, bump: vec3<f32>, surface: vec2<f32>, weight: f32) -> Sum {
    return Sum(
        sum.albedo + albedo.rgb * weight,
        sum.height + albedo.a * weight,
        sum.bump + bump * weight,
        sum.roughness + surface.x * weight,
        sum.occlusion + surface.y * weight,
    );
}

// A layer before any tap: one without a texture is complete.
fn begun(layer: u32) -> Sum {
    let shows = look.layers[layer];
    if shows.texture == NO_TEXTURE {
        return Sum(shows.colour.rgb, FLAT_HEIGHT, vec3(0.0), shows.colour.a, 1.0);
    }
    return Sum(vec3(0.0), 0.0, vec3(0.0), 0.0, 0.0);
}

fn layers_at(site: Site) -> Blend {
    let found = heaviest(site.place);
    let first = found.layers.x;
    let second = found.layers.y;
    let share = narrowed(found.weights.y / max(found.weights.x + found.weights.y, 1e-6));
    let far = narrowed(site.farness);
    let side = narrowed(1.0 - site.upright);
    let near_copy = fract(site.index);
    let far_index = site.index * FAR_COPIES;
    // As the copies of the full material mix; then narrowed.
    let near_share = narrowed(smoothstep(0.25, 0.75, near_copy));
    let far_share = narrowed(smoothstep(0.25, 0.75, fract(far_index)));
    let scales = select(0u, both(near_share, 1u, 1u), far < 1.0) | select(0u, both(far_share, 1u, 1u) << 2u, far > 0.0);
    let cliffs = vec2(look.layers[first].cliff, look.layers[second].cliff) != vec2(0u);
    let sides = select(vec2(0.0), vec2(side), cliffs);
    let textured = vec2(look.layers[first].texture, look.layers[second].texture) != vec2(NO_TEXTURE);
    var left = select(0u, both(sides.x, scales, 4u), textured.x && share < 1.0);
    left |= select(0u, both(sides.y, scales, 4u) << 8u, textured.y && share > 0.0);

    let upper = scale_uv(site, look.layers[first].tile, site.position.xz, true);
    let lower = scale_uv(site, look.layers[second].tile, site.position.xz, true);
    let side_at = vec2(select(site.position.z, site.position.x, site.side_z), -site.position.y);
    let along = select(vec3(0.0, 0.0, 1.0), vec3(1.0, 0.0, 0.0), site.side_z);
    let near_flat = select(1.0, FAR_RELIEF, site.scale > 0.0);
    let whole = vec2(floor(site.index), floor(far_index));
    var a = begun(first);
    var b = begun(second);
    for (var n = 0u; n < MOST_TAPS && left != 0u; n++) {
        let k = firstTrailingBit(left);
        left &= left - 1u;
        let of_second = (k & SECOND) != 0u;
        let of_side = (k & SIDE) != 0u;
        let of_far = (k & FAR) != 0u;
        let of_copy = (k & COPY) != 0u;
        let layer = look.layers[select(first, second, of_second)];
        let tile = select(upper.tile, lower.tile, of_second) * select(1.0, FAR_TILES, of_far);
        let flat_uv = select(select(upper.near, lower.near, of_second), select(upper.far, lower.far, of_second), of_far);
        let uv = select(flat_uv, side_at / tile, of_side);
        let offset = copy_offset(i32(select(whole.x, whole.y, of_far)) + select(0, 1, of_copy));
        let dx = select(site.dx.xz, vec2(select(site.dx.z, site.dx.x, site.side_z), -site.dx.y), of_side) / tile;
        let dy = select(site.dy.xz, vec2(select(site.dy.z, site.dy.x, site.side_z), -site.dy.y), of_side) / tile;
        let s = textureSampleGrad(albedo_height, textures, uv + offset, layer.texture, dx, dy);
        let t = textureSampleGrad(normal_roughness, textures, uv + offset, layer.texture, dx, dy);
        let copies = select(near_share, far_share, of_far);
        let side_share = select(sides.x, sides.y, of_second);
        let weight = select(1.0 - copies, copies, of_copy) * select(1.0 - far, far, of_far) * select(1.0 - side_share, side_share, of_side);
        let relief = near_flat * select(1.0, FAR_RELIEF, of_far);
        let slope = (t.xy * 2.0 - 1.0) * relief;
        let bump = select(vec3(slope.x, 0.0, slope.y), along * slope.x - vec3(0.0, slope.y, 0.0), of_side);
        let surface = vec2(t.z, mix(1.0, t.w, relief));
        // As `flattened` of the full material.
        let colour = vec4(s.rgb * mix(t.w, 1.0, relief), s.a);
        a = added(a, colour, bump, surface, select(weight, 0.0, of_second));
        b = added(b, colour, bump, surface, select(0.0, weight, of_second));
    }
    // Height blending, as of the full material: what stands highest shows.
    let stand = vec2(1.0 - share, share) + vec2(a.height, b.height) * 0.6;
    let shown = max(stand - max(select(0.0, stand.x, share < 1.0), select(0.0, stand.y, share > 0.0)) + site.mixed_height, vec2(0.0)) * vec2(1.0 - share, share);
    let t = shown.y / max(shown.x + shown.y, 1e-6);
    return Blend(mix(a.albedo, b.albedo, t), mix(a.roughness, b.roughness, t), mix(a.occlusion, b.occlusion, t), mix(a.bump, b.bump, t), select(0.0, 1.0 - t, textured.x) + select(0.0, t, textured.y));
}
