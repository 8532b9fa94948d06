#define_import_path dolomite::ground::full

// The material in full: every layer that lies at a place, at both scales, in both copies and from both sides. It is
// what the cheaper way is measured by; its cost grows with the number of layers.

#import dolomite::ground::types::NO_TEXTURE
#import dolomite::ground::bindings::{look, albedo_height, normal_roughness, textures}
#import dolomite::ground::layers::{LAYERS, Place, layer_share}
#import dolomite::ground::site::{Blend, Site, FAR_COPIES, FAR_RELIEF, FAR_TILES, FLAT_HEIGHT, scale_uv}
#import dolomite::ground::texturing::{Texel, mix_texels, sample_varied}

// Share below which a layer is not sampled: height blending hides it anyway.
const LEAST_WEIGHT: f32 = 0.04;

// The first layer from `start` on that is drawn on cliffs from the side; `look.count` where there is none.
fn next_cliff(start: u32) -> u32 {
    var i = start;
    while i < look.count && (look.layers[i].cliff == 0u || look.layers[i].texture == NO_TEXTURE) {
        i++;
    }
    return i;
}

// Share of each layer.
fn weigh(weights: ptr<function, array<f32, LAYERS>>, place: Place) {
    var left = 1.0;
    for (var i = 0u; i < look.count; i++) {
        let share = layer_share(i, place, left);
        (*weights)[look.order[i].x] = share.x;
        left = share.y;
    }
}

// What stands out less throws less shade: what it would have thrown darkens it.
fn flattened(texel: Texel, by: f32) -> Texel {
    return Texel(texel.albedo * mix(texel.occlusion, 1.0, by), texel.height, texel.normal * by, texel.roughness, mix(1.0, texel.occlusion, by));
}

// Both scales, `uv` and derivatives in tiles of the nearer one.
fn sample_layer(site: Site, layer: u32, near: vec2<f32>, far: vec2<f32>, dx: vec2<f32>, dy: vec2<f32>) -> Texel {
    let relief = select(1.0, FAR_RELIEF, site.scale > 0.0);
    let close = sample_varied(albedo_height, normal_roughness, textures, layer, near, dx, dy, site.index);
    let wide = sample_varied(albedo_height, normal_roughness, textures, layer, far, dx / FAR_TILES, dy / FAR_TILES, site.index * FAR_COPIES);
    return mix_texels(flattened(close, relief), flattened(wide, relief * FAR_RELIEF), site.farness);
}

struct Sum {
    blend: Blend,
    total: f32,
}

fn add(sum: Sum, s: Texel, bump: vec3<f32>, textured: bool, weight: f32) -> Sum {
    let b = sum.blend;
    return Sum(
        Blend(b.albedo + s.albedo * weight, b.roughness + s.roughness * weight, b.occlusion + s.occlusion * weight, b.bump + bump * weight, b.textured + select(0.0, weight, textured)),
        sum.total + weight,
    );
}

fn layers_at(site: Site) -> Blend {
    var weights: array<f32, LAYERS>;
    weigh(&weights, site.place);
    var layers: array<Texel, LAYERS>;
    var bumps: array<vec3<f32>, LAYERS>;
    var highest = 0.0;
    for (var i = 0u; i < look.count; i++) {
        if weights[i] < LEAST_WEIGHT {
            continue;
        }
        let layer = look.layers[i];
        let uvs = scale_uv(site, layer.tile, site.position.xz, true);
        let tile = uvs.tile;
        if layer.texture == NO_TEXTURE {
            layers[i] = Texel(layer.colour.rgb, FLAT_HEIGHT, vec2(0.0), layer.colour.a, 1.0);
        } else if layer.cliff == 0u || site.upright > 0.0 {
            layers[i] = sample_layer(site, layer.texture, uvs.near, uvs.far, site.dx.xz / tile, site.dy.xz / tile);
            bumps[i] = vec3(layers[i].normal.x, 0.0, layers[i].normal.y);
        }
    }
    // Steep ground also from the side that it faces most. A loop of its own that goes round once for each cliff: a
    // processor without branches for single lanes runs all that stands in a loop's body, for every layer.
    let side_z = site.side_z;
    let along = select(vec3(0.0, 0.0, 1.0), vec3(1.0, 0.0, 0.0), side_z);
    var cliff = next_cliff(0u);
    loop {
        if cliff < look.count && site.upright < 1.0 && weights[cliff] >= LEAST_WEIGHT {
            let layer = look.layers[cliff];
            let side = vec2(select(site.position.z, site.position.x, side_z), -site.position.y);
            let uvs = scale_uv(site, layer.tile, side, false);
            let tile = uvs.tile;
            let side_dx = vec2(select(site.dx.z, site.dx.x, side_z), -site.dx.y);
            let side_dy = vec2(select(site.dy.z, site.dy.x, side_z), -site.dy.y);
            let s = sample_layer(site, layer.texture, uvs.near, uvs.far, side_dx / tile, side_dy / tile);
            let bump = along * s.normal.x - vec3(0.0, 1.0, 0.0) * s.normal.y;
            layers[cliff] = mix_texels(s, layers[cliff], site.upright);
            bumps[cliff] = mix(bump, bumps[cliff], site.upright);
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
    // Height blending: what stands highest shows.
    var sum = Sum(Blend(vec3(0.0), 0.0, 0.0, vec3(0.0), 0.0), 0.0);
    for (var i = 0u; i < look.count; i++) {
        if weights[i] < LEAST_WEIGHT {
            continue;
        }
        let weight = max(weights[i] + layers[i].height * 0.6 - highest + site.mixed_height, 0.0) * weights[i];
        sum = add(sum, layers[i], bumps[i], look.layers[i].texture != NO_TEXTURE, weight);
    }
    let scale = 1.0 / max(sum.total, 1e-6);
    let b = sum.blend;
    return Blend(b.albedo * scale, b.roughness * scale, b.occlusion * scale, b.bump * scale, b.textured * scale);
}
