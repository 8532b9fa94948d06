#define_import_path dolomite::vegetation::wind

// Wind as a field at one time about an anchor. CPU reference: plugins/vegetation/src/wind.rs.

struct WindField {
    // Waves of the gusts: wave vector (x, z) in radians a metre, phase at the anchor, weight.
    gusts: array<vec4<f32>, 4>,
    // Waves of the swell: wave vector, phase at the anchor, radius at the surface in metres.
    swell: array<vec4<f32>, 3>,
    // Mean wind (x, z), m/s; share of it by which gusts differ; phase of the flutter.
    mean: vec2<f32>,
    share: f32,
    flutter: f32,
    // x: phase of the faster flutter.
    fast: vec4<f32>,
}

const FLUTTER: f32 = 0.18;

// The wind's strength as a multiple of the mean.
fn wind_strength(field: WindField, at: vec2<f32>) -> f32 {
    var sum = 0.0;
    for (var k = 0u; k < 4u; k++) {
        let wave = field.gusts[k];
        sum += wave.w * sin(dot(wave.xy, at) + wave.z);
    }
    let part = 0.5 + 0.5 * sum;
    let steep = part * part * (3.0 - 2.0 * part);
    return 1.0 + field.share * (2.0 * steep - 1.0);
}

// What a blade feels, m/s: the wind, and a flutter of its own by a number between 0 and 1.
fn wind_on_blade(field: WindField, at: vec2<f32>, own: f32, is_fast: bool) -> vec2<f32> {
    let strength = wind_strength(field, at);
    let phase = select(field.flutter, field.fast.x, is_fast) + 6.2831853 * own;
    let flutter = FLUTTER * strength;
    let across = vec2(-field.mean.y, field.mean.x);
    return field.mean * (strength + flutter * sin(phase)) + across * (flutter * cos(phase));
}

// How far water is from its place at rest, metres, at a depth below the surface.
fn water_moved(field: WindField, at: vec2<f32>, depth: f32) -> vec3<f32> {
    var moved = vec3(0.0);
    for (var k = 0u; k < 3u; k++) {
        let wave = field.swell[k];
        let long = length(wave.xy);
        let angle = dot(wave.xy, at) + wave.z;
        let radius = wave.w * exp(-long * max(depth, 0.0));
        let along = wave.xy * (-radius * sin(angle) / max(long, 1e-9));
        moved += vec3(along.x, radius * cos(angle), along.y);
    }
    return moved;
}
