#define_import_path dolomite::ground::material

// What the ground is made of, by the layers of its material, and how it looks there.
// Slopes are rise over run; heights and lengths metres.

#import dolomite::geometry::draw_types::{Shaded, Surface}
#import dolomite::ground::types::{GroundView, DEPTH_RANGE}
#import dolomite::ground::bindings::{look, relief, relief_sampler}
#import dolomite::ground::canopy::canopy_at
#import dolomite::ground::layers::place_of
#import dolomite::ground::site::{Site, FAR_COPIES, FAR_TILES}
#import dolomite::ground::texturing::{noise_pair, value_noise}
#import dolomite::ground::water::{Restless, Sea, water_surface}
#ifdef GROUND_FULL
#import dolomite::ground::full::layers_at
#else
#import dolomite::ground::taps::layers_at
#endif

// Slope of the swells of the ground that no texture has, for a noise of slope 1 in its own size.
const SWELL: f32 = 0.11;

// How much a noise of a size shows in a pixel.
fn kept(pixel: f32, size: f32) -> f32 {
    return 1.0 - smoothstep(0.25, 0.8, pixel / size);
}

// What the rasteriser gives, shaded; stage space's origin stands `anchor_height` metres up.
fn ground_surface(view: GroundView, surface: Surface, anchor_height: f32) -> Shaded {
    let dx = surface.dx;
    let dy = surface.dy;
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
    // Noises of four sizes, each a pair; what is finer than a pixel is only its mean.
    let n173 = noise_pair(world / 173.0, 1u).value;
    let n47 = noise_pair(world / 47.0, 2u).value;
    let at_11 = noise_pair(world / 11.0, 3u);
    let at_3 = noise_pair(world / 2.9, 4u);
    let keep_11 = kept(pixel, 11.0);
    let keep_3 = kept(pixel, 2.9);
    let n11 = mix(vec2(0.5), at_11.value, keep_11);
    let n3 = mix(vec2(0.5), at_3.value, keep_3);
    let wide_noise = 0.65 * n173.x + 0.35 * n47.x;
    let fine_noise = 0.6 * n11.x + 0.4 * n3.x;
    // Ground is nowhere even: low swells of both sizes, as slopes.
    let swell = (at_11.slope * keep_11 + at_3.slope * keep_3) * SWELL;

    // From 3 cm a pixel on the near texture is only an average: the next scale takes over, and so on. Of a pixel of
    // 1080 rows, so that the picture's size does not change what is seen.
    let away = normalize(view.camera - surface.position);
    let seen = (view.pixel.x * camera_distance + view.pixel.y) / max(abs(dot(surface.normal, away)), 0.15);
    let wide = seen > 0.11;
    let scale = select(1.0, FAR_TILES, wide);
    let facing = base_normal * base_normal;
    let site = Site(
        place_of(ground, look.sea_level, slope, vec2(wide_noise, fine_noise)),
        position,
        dx,
        dy,
        9.0 * value_noise(world / (look.tiles.x * 2.3), 5u) * select(1.0, FAR_COPIES, wide),
        select(0.0, 1.0, wide),
        smoothstep(0.012 * scale, 0.09 * scale, seen),
        0.25 + 0.5 * smoothstep(0.03, 0.5, seen),
        smoothstep(0.55, 0.75, base_normal.y),
        facing.z > facing.x,
        view,
    );
    let blend = layers_at(site);
    var out: Shaded;
    out.emissive = vec3(0.0);
    out.metallic = 0.0;
    out.unlit = false;
    out.fog = true;
    // Large-scale light and dark, and warm and cool, that no tile can have.
    let tint = mix(vec3(0.82, 0.86, 0.84), vec3(1.14, 1.1, 1.04), wide_noise) * (0.9 + 0.2 * fine_noise);
    // Patches of dry ground, as far as it is a picture of ground.
    let dry = dot(blend.albedo, vec3(0.2126, 0.7152, 0.0722)) * vec3(1.12, 1.0, 0.72);
    out.base_color = clamp(mix(blend.albedo, dry, 0.5 * n173.y * n47.y * blend.textured) * tint, vec3(0.0), vec3(1.0));
    out.roughness = clamp(blend.roughness, 0.05, 1.0);
    out.occlusion = blend.occlusion * relief_occlusion;
    out.reflectance = 0.4;
    out.normal = normalize(base_normal + blend.bump * 0.9 - vec3(swell.x, 0.0, swell.y) * base_normal.y);

    if look.canopy[0].slope.w > 0.0 {
        // As calm as plants are drawn where they end.
        let canopy = canopy_at(ground, slope, camera_distance, dot(away, base_normal));
        out.base_color = mix(out.base_color, canopy.colour, canopy.share);
        out.roughness = mix(out.roughness, 0.95, canopy.share);
        out.occlusion = mix(out.occlusion, 0.8, canopy.share);
        out.reflectance = mix(out.reflectance, 0.08, canopy.share);
        out.normal = normalize(mix(out.normal, base_normal, 0.9 * canopy.share));
    }

#ifndef GROUND_WITHOUT_SEA
    // Wet sand just above the water line, and the water itself.
    let wet = smoothstep(-0.7, 0.0, depth);
    out.base_color *= 1.0 - 0.45 * wet;
    out.roughness = mix(out.roughness, 0.35, wet * 0.7);
    if depth > 0.0 {
        let water = water_surface(Sea(look.water, look.deep.rgb), view, position.xz, depth, pixel, out.base_color, Restless(vec2(n47.y, n11.y), n173.y * n47.x, n3.y * 0.6 + n11.y * 0.4));
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
