#define_import_path dolomite::ground::material

// What the ground is made of, by the layers of its material, and how it looks there.
// Slopes are rise over run; heights and lengths metres.

#import dolomite::geometry::draw_types::{Shaded, Surface}
#import dolomite::ground::types::{GroundLook, GroundView, DEPTH_RANGE, NO_TEXTURE}
#import dolomite::ground::layers::{Place, LAYERS, band_share, place_of}
#import dolomite::ground::texturing::{Texel, mix_texels, sample_once, sample_varied, value_noise}
#import dolomite::ground::water::{Sea, water_surface}

@group(1) @binding(3) var albedo_height: texture_2d_array<f32>;
@group(1) @binding(4) var normal_roughness: texture_2d_array<f32>;
@group(1) @binding(5) var textures: sampler;
@group(1) @binding(6) var relief: texture_2d<f32>;
@group(1) @binding(7) var relief_sampler: sampler;
@group(1) @binding(8) var<uniform> look: GroundLook;

// The far scale of the textures, in near tiles: not a whole number, so that the two never align.
const FAR_TILES: f32 = 11.3;

// The first layer from `start` on that is drawn on cliffs from the side; `look.count` where there is none.
fn next_cliff(start: u32) -> u32 {
    var i = start;
    while i < look.count && (look.layers[i].cliff == 0u || look.layers[i].texture == NO_TEXTURE) {
        i++;
    }
    return i;
}

// Share of each layer: an upper one hides what lies below it, the last one takes what is left.
fn weigh(weights: ptr<function, array<f32, LAYERS>>, place: Place) {
    var left = 1.0;
    for (var i = 0u; i < look.count; i++) {
        let entry = look.order[i];
        var weight = left;
        var share = 1.0;
        for (var k = entry.y; k < entry.z; k++) {
            let of_band = band_share(look.bands[k], place);
            weight *= of_band;
            share *= of_band;
        }
        (*weights)[entry.x] = weight;
        left *= 1.0 - share;
    }
}

// Share below which a layer is not sampled: height blending hides it anyway.
const LEAST_WEIGHT: f32 = 0.04;
// How high a layer without a texture stands in height blending, of 0 to 1.
const FLAT_HEIGHT: f32 = 0.5;

// What stands out at the far scale stands FAR_TILES times as high as it is: its slopes are the near ones, on
// tufts and stones as large as bushes and boulders. Flattened, they are the unevenness of the ground.
const FAR_RELIEF: f32 = 0.4;

// The far texture scale.
fn sample_far(layer: u32, far: vec2<f32>, dx: vec2<f32>, dy: vec2<f32>, index: f32) -> Texel {
    var wide = sample_varied(albedo_height, normal_roughness, textures, layer, far, dx / FAR_TILES, dy / FAR_TILES, index * 0.37);
    wide.normal *= FAR_RELIEF;
    wide.occlusion = mix(1.0, wide.occlusion, FAR_RELIEF);
    return wide;
}

// Near texture scale mixed with the far one by the size of a pixel on the ground.
fn sample_layer(layer: u32, near: vec2<f32>, far: vec2<f32>, dx: vec2<f32>, dy: vec2<f32>, index: f32, farness: f32) -> Texel {
    if farness >= 1.0 {
        return sample_far(layer, far, dx, dy, index);
    }
    let close = sample_varied(albedo_height, normal_roughness, textures, layer, near, dx, dy, index);
    if farness <= 0.0 {
        return close;
    }
    return mix_texels(close, sample_far(layer, far, dx, dy, index), farness);
}

struct Blend {
    albedo: vec3<f32>,
    roughness: f32,
    occlusion: f32,
    // Offset of the normal in world space.
    bump: vec3<f32>,
    total: f32,
}

fn add(blend: Blend, s: Texel, bump: vec3<f32>, weight: f32) -> Blend {
    return Blend(
        blend.albedo + s.albedo * weight,
        blend.roughness + s.roughness * weight,
        blend.occlusion + s.occlusion * weight,
        blend.bump + bump * weight,
        blend.total + weight,
    );
}

// What the rasteriser gives, shaded; stage space's origin stands `anchor_height` metres up.
fn ground_surface(view: GroundView, surface: Surface, anchor_height: f32) -> Shaded {
    // Derivatives before any branch: WGSL wants them in uniform control flow.
    let dx = dpdx(surface.position);
    let dy = dpdy(surface.position);
    let position = vec3(surface.position.x, surface.position.y + anchor_height, surface.position.z);
    let camera_distance = length(surface.position - view.camera);
    let pixel = max(length(dx.xz), length(dy.xz));
    let depth = surface.uv.x;
    // The sea bed, where it lies below the surface that is drawn.
    let ground = select(position.y, look.sea_level - depth, depth > -0.99 * DEPTH_RANGE);
    var gradient = -surface.normal.xz / max(surface.normal.y, 1e-3);
    var relief_occlusion = 1.0;
    if look.relief_texel > 0.0 {
        // The relief map takes over where its texels are finer than the triangles.
        let uv = view.relief_offset + position.xz * look.relief_scale;
        let map = textureSampleGrad(relief, relief_sampler, uv, dx.xz * look.relief_scale, dy.xz * look.relief_scale);
        let share = smoothstep(60.0, 160.0, camera_distance / look.relief_texel);
        gradient = mix(gradient, map.xy, share);
        relief_occlusion = map.z;
    }
    let slope = length(gradient);
    let base_normal = normalize(vec3(-gradient.x, 1.0, -gradient.y));

    let world = view.anchor + position.xz;
    let wide_noise = 0.65 * value_noise(world / 173.0, 1u) + 0.35 * value_noise(world / 47.0, 2u);
    let fine_noise = 0.6 * value_noise(world / 11.0, 3u) + 0.4 * value_noise(world / 2.9, 4u);
    var weights: array<f32, LAYERS>;
    weigh(&weights, place_of(ground, look.sea_level, slope, vec2(wide_noise, fine_noise)));

    let index = 9.0 * value_noise(world / (look.tiles.x * 2.3), 5u);
    // From 3 cm a pixel on the near texture is only an average: the far one takes over.
    let farness = smoothstep(0.012, 0.09, pixel);

    // How much of a cliff is seen from above.
    let upright = smoothstep(0.55, 0.75, base_normal.y);
    var layers: array<Texel, LAYERS>;
    var bumps: array<vec3<f32>, LAYERS>;
    var highest = 0.0;
    for (var i = 0u; i < look.count; i++) {
        if weights[i] < LEAST_WEIGHT {
            continue;
        }
        let layer = look.layers[i];
        let tile = look.tiles[layer.tile];
        let offset = select(select(view.offset_c, view.offset_b, layer.tile == 1u), view.offset_a, layer.tile == 0u);
        let near = offset.xy + position.xz / tile;
        let far = offset.zw + position.xz / (tile * FAR_TILES);
        let ddx = dx.xz / tile;
        let ddy = dy.xz / tile;
        if layer.texture == NO_TEXTURE {
            layers[i] = Texel(layer.colour.rgb, FLAT_HEIGHT, vec2(0.0), layer.colour.a, 1.0);
        } else if layer.cliff == 0u || upright > 0.0 {
            layers[i] = sample_layer(layer.texture, near, far, ddx, ddy, index, farness);
            bumps[i] = vec3(layers[i].normal.x, 0.0, layers[i].normal.y);
        }
    }
    // Steep ground also from the side that it faces most. A loop of its own that goes round once for each cliff: a
    // processor without branches for single lanes runs all that stands in a loop's body, for every layer.
    let facing = base_normal * base_normal;
    let side_z = facing.z > facing.x;
    let along = select(vec3(0.0, 0.0, 1.0), vec3(1.0, 0.0, 0.0), side_z);
    var cliff = next_cliff(0u);
    loop {
        if cliff < look.count && upright < 1.0 && weights[cliff] >= LEAST_WEIGHT {
            let layer = look.layers[cliff];
            let tile = look.tiles[layer.tile];
            let side = vec2(select(position.z, position.x, side_z), -position.y);
            let side_dx = vec2(select(dx.z, dx.x, side_z), -dx.y);
            let side_dy = vec2(select(dy.z, dy.x, side_z), -dy.y);
            let s = sample_layer(layer.texture, side / tile, side / (tile * FAR_TILES), side_dx / tile, side_dy / tile, index, farness);
            let bump = along * s.normal.x - vec3(0.0, 1.0, 0.0) * s.normal.y;
            layers[cliff] = mix_texels(s, layers[cliff], upright);
            bumps[cliff] = mix(bump, bumps[cliff], upright);
        }
        continuing {
            cliff = next_cliff(cliff + 1u);
            break if cliff >= look.count;
        }
    }
    for (var i = 0u; i < look.count; i++) {
        if weights[i] >= LEAST_WEIGHT {
            highest = max(highest, weights[i] + layers[i].height * 0.6);
        }
    }
    // Height blending: what stands highest shows; 0.25 is the depth of the mixed zone.
    var blend = Blend(vec3(0.0), 0.0, 0.0, vec3(0.0), 0.0);
    for (var i = 0u; i < look.count; i++) {
        if weights[i] < LEAST_WEIGHT {
            continue;
        }
        let weight = max(weights[i] + layers[i].height * 0.6 - highest + 0.25, 0.0) * weights[i];
        blend = add(blend, layers[i], bumps[i], weight);
    }
    let scale = 1.0 / max(blend.total, 1e-6);
    var out: Shaded;
    out.emissive = vec3(0.0);
    out.metallic = 0.0;
    out.unlit = false;
    out.fog = true;
    // Large-scale light and dark, and warm and cool, that no tile can have.
    let tint = mix(vec3(0.82, 0.86, 0.84), vec3(1.14, 1.1, 1.04), wide_noise) * (0.9 + 0.2 * fine_noise);
    out.base_color = clamp(blend.albedo * scale * tint, vec3(0.0), vec3(1.0));
    out.roughness = clamp(blend.roughness * scale, 0.05, 1.0);
    out.occlusion = blend.occlusion * scale * relief_occlusion;
    out.reflectance = 0.4;
    out.normal = normalize(base_normal + blend.bump * scale * 0.9);

#ifndef GROUND_WITHOUT_SEA
    // Wet sand just above the water line, and the water itself.
    let wet = smoothstep(-0.7, 0.0, depth);
    out.base_color *= 1.0 - 0.45 * wet;
    out.roughness = mix(out.roughness, 0.35, wet * 0.7);
    if depth > 0.0 {
        let water = water_surface(Sea(look.water, look.deep.rgb), view, position.xz, depth, pixel, out.base_color);
        let shore = smoothstep(0.0, 0.12, depth);
        out.base_color = mix(out.base_color, water.albedo, shore);
        out.roughness = mix(out.roughness, water.roughness, shore);
        out.normal = normalize(mix(out.normal, water.normal, shore));
        out.reflectance = mix(out.reflectance, 0.35, shore); // F0 = 0.16 r^2 = 0.02: water.
        out.occlusion = mix(out.occlusion, 1.0, shore);
    }
#endif
    return out;
}
