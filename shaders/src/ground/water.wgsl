#define_import_path dolomite::ground::water

// The sea: an opaque surface whose colour follows the depth below it. Lengths metres.

#import dolomite::ground::types::GroundView

// What the water is; see the component Sea.
struct Sea {
    // Extinction of red, green and blue, 1/m; then the greatest slope of a wave.
    water: vec4<f32>,
    // Colour of deep water.
    deep: vec3<f32>,
}

// Depth to which there is foam, metres.
const FOAM_DEPTH: f32 = 0.9;

struct Water {
    albedo: vec3<f32>,
    roughness: f32,
    normal: vec3<f32>,
}

// What noise does to the water at a place, each part from 0 to 1.
struct Restless {
    // Where crests bend.
    bent: vec2<f32>,
    // How much wind there is.
    gust: f32,
    // Where foam holds together.
    foam: f32,
}

// Slope of a sum of travelling waves (deep water: omega^2 = g k). `pixel` is the size of a pixel
// on the water: shorter waves than two of them turn into roughness.
fn wave_slope(greatest: f32, at: vec2<f32>, time: f32, pixel: f32, restless: Restless) -> vec3<f32> {
    // Crests bend, and gusts roughen the sea in patches: no regular grating shows.
    let gust = 0.35 + 1.1 * restless.gust;
    let p = at + (restless.bent - 0.5) * 22.0;
    var slope = vec2(0.0);
    var lost = 0.0;
    var k = 0.35;
    var direction = vec2(0.8, 0.6);
    for (var i = 0u; i < 7u; i++) {
        let steepness = greatest * gust;
        let omega = sqrt(9.81 * k);
        let keep = 1.0 - smoothstep(0.35, 1.2, pixel * k / 3.1415927);
        // Wrapped, since WGSL's cos is only accurate within -pi..pi.
        let phase = fract((k * dot(direction, p) - omega * time + f32(i) * 1.7) / 6.2831853 + 0.5) - 0.5;
        slope += direction * (steepness * cos(phase * 6.2831853)) * keep;
        lost += steepness * steepness * 0.5 * (1.0 - keep * keep);
        k *= 1.73;
        // Turn by a golden angle so that crests never line up: cos and sin of 137.5 degrees.
        direction = vec2(-0.7373 * direction.x - 0.6755 * direction.y, 0.6755 * direction.x - 0.7373 * direction.y);
    }
    return vec3(slope, lost);
}

fn water_surface(sea: Sea, view: GroundView, place: vec2<f32>, depth: f32, pixel: f32, bed: vec3<f32>, restless: Restless) -> Water {
    let waves = wave_slope(sea.water.w, view.anchor + place, view.time, pixel, restless);
    // Absorption by depth (Beer-Lambert); 1.4: light goes down and comes up aslant.
    let through = exp(-sea.water.xyz * depth * 1.4);
    var out: Water;
    out.albedo = mix(sea.deep, bed * vec3(0.75, 0.95, 0.95), through);
    // Roughness from the variance of the slopes that the pixel averages (alpha^2 = 2 sigma^2).
    out.roughness = clamp(sqrt(sqrt(0.0016 + 2.0 * waves.z)), 0.05, 0.6);
    out.normal = normalize(vec3(-waves.x, 1.0, -waves.y));
    // Foam where waves break: closed at the edge, in flakes further out, of a height of waves.
    let shallow = 1.0 - smoothstep(0.0, FOAM_DEPTH * (0.4 + 1.2 * restless.gust), depth);
    let foam = 0.85 * smoothstep(0.55, 0.95, shallow + 0.75 * (restless.foam - 0.5));
    out.albedo = mix(out.albedo, vec3(0.68, 0.72, 0.73), foam);
    out.roughness = mix(out.roughness, 0.85, foam);
    return out;
}
