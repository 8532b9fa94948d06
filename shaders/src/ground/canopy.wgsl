#define_import_path dolomite::ground::canopy

// What grows on the ground, seen from where it is too thin to be drawn. CPU reference: plugins/ground/src/material/canopy.rs.

#import dolomite::ground::bindings::look

struct Canopy {
    // Share of the ground that is hidden, and the mean colour of what hides it.
    share: f32,
    colour: vec3<f32>,
}

// Below it the ground is hidden as at it.
const LEAST_SINE: f32 = 0.00390625;

fn canopy_ramp(x: f32, band: vec4<f32>) -> f32 {
    return clamp(min((x - band.x) * band.z, (band.y - x) * band.z), 0.0, 1.0);
}

// How much the ground shows of a layer with these bands at a place so far from the camera.
fn canopy_density(height_band: vec4<f32>, slope_band: vec4<f32>, height: f32, slope: f32, distance: f32) -> f32 {
    let t = clamp((distance - height_band.w) / max(slope_band.w - height_band.w, 1e-3), 0.0, 1.0);
    return canopy_ramp(height, height_band) * canopy_ramp(slope, slope_band) * (t * t * (3.0 - 2.0 * t));
}

// Where among the entries a sine lies.
fn canopy_place(sine: f32) -> f32 {
    return clamp(2.0 * log2(clamp(sine, LEAST_SINE, 1.0)) + 16.0, 0.0, 16.0);
}

// Share that so much depth hides at an elevation of this sine.
fn canopy_share(depth: f32, sine: f32) -> f32 {
    return 1.0 - exp(-depth / max(sine, LEAST_SINE));
}

// What covers the ground of a height and a slope, so far from the camera.
fn canopy_at(height: f32, slope: f32, distance: f32, sine: f32) -> Canopy {
    let place = canopy_place(sine);
    let entry = min(u32(place), 15u);
    let part = place - f32(entry);
    var depth = 0.0;
    var colour = vec3(0.0);
    for (var k = 0u; k < 4u; k++) {
        let bands = array(look.canopy[k].height, look.canopy[k].slope);
        if bands[1].w <= 0.0 {
            break;
        }
        let density = canopy_density(bands[0], bands[1], height, slope, distance);
        let seen = mix(look.canopy[k].entries[entry], look.canopy[k].entries[entry + 1u], part);
        depth += seen.x * density;
        colour += seen.yzw * (seen.x * density);
    }
    return Canopy(canopy_share(depth, sine), colour / max(depth, 1e-9));
}
