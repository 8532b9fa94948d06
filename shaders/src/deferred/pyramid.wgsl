#define_import_path dolomite::deferred::pyramid

// A depth pyramid: level 0 is the depth of a view, 0 at infinity, and a texel of each level after it is the least
// (the farthest) of the 2 × 2 below. Sizes are rounded up, so that every pixel lies below exactly one texel of each
// level, whatever the size. The levels from 1 on follow each other in one array. Rust: `pyramid.rs` of
// `dolomite_deferred`.

struct Level {
    size: vec2<u32>,
    // Of its first texel in the array.
    first: u32,
}

// What a box covers: pixels from `low` to `high`, these included, and the depth of what of it is nearest.
struct Footprint {
    low: vec2<u32>,
    high: vec2<u32>,
    nearest: f32,
    // It reaches before the near plane, so that it has no footprint.
    cut: bool,
}

fn halved(size: vec2<u32>) -> vec2<u32> {
    return (size + 1u) / 2u;
}

// Level `index`, from 1 on, of a view of `size` pixels.
fn level(size: vec2<u32>, index: u32) -> Level {
    var result = Level(halved(size), 0u);
    for (var k = 1u; k < index; k++) {
        result.first += result.size.x * result.size.y;
        result.size = halved(result.size);
    }
    return result;
}

// The first level at which a footprint lies on at most 2 × 2 texels: these are as wide as it, or wider.
fn level_of(footprint: Footprint) -> u32 {
    let span = footprint.high - footprint.low;
    return max(32u - countLeadingZeros(max(span.x, span.y)), 1u);
}

// Of a box between two corners. `clip_from_box` should have no large translation: the box is then best given from
// the camera.
fn footprint_of(low: vec3<f32>, high: vec3<f32>, clip_from_box: mat4x4<f32>, size: vec2<u32>) -> Footprint {
    let pixels = vec2<f32>(size);
    var least = vec2(1e30);
    var most = vec2(-1e30);
    var nearest = 0.0;
    var cut = false;
    for (var k = 0u; k < 8u; k++) {
        let corner = select(low, high, (vec3(k) & vec3(1u, 2u, 4u)) != vec3(0u));
        let clip = clip_from_box * vec4(corner, 1.0);
        // Before the near plane depth is above 1; the comparison is false for what is no number.
        if !(clip.w > 0.0 && clip.z <= clip.w) {
            cut = true;
        }
        let ndc = clip.xyz / clip.w;
        let place = (ndc.xy * vec2(0.5, -0.5) + 0.5) * pixels;
        least = min(least, place);
        most = max(most, place);
        nearest = max(nearest, ndc.z);
    }
    // More than the sums above round by.
    let slack = 0.01 + 1e-5 * pixels;
    let first = clamp(floor(least - slack), vec2(0.0), pixels - 1.0);
    let last = clamp(floor(most + slack), vec2(0.0), pixels - 1.0);
    return Footprint(vec2<u32>(first), vec2<u32>(last), nearest * 1.000002, cut);
}
