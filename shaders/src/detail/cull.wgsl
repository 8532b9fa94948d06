#define_import_path dolomite::detail::cull

// Triangles of which a cull view sees nothing. CPU reference: plugins/ground/src/detail/cull.rs, where the
// margins are derived.

#import dolomite::detail::bindings::detail

// Bits of DetailParams.flags: triangles that the camera does not see are left out; among them those that face
// away; they are kept behind the others, for shadows.
const CULL: u32 = 1u;
const FACING: u32 = 2u;
const KEEP_OTHERS: u32 = 4u;

// Rounding of f32, some times.
const ROUNDING: f32 = 1e-6;
// Pixels by which a corner may be drawn off its place.
const SNAP: f32 = 0.1;

// Where a place is drawn; and in bits which borders it lies beyond, by more than a pixel and all rounding.
struct Drawn {
    clip: vec4<f32>,
    beyond: u32,
}

fn draw_at(place: vec3<f32>) -> Drawn {
    let clip = detail.clip * vec4(place, 1.0);
    let size = ROUNDING * (abs(clip) + vec4(abs(clip.w)));
    let border = clip.w * (vec2(1.0) + 1.0 / detail.half_size);
    let least = vec4(border + clip.xy + size.xy, border - clip.xy + size.xy);
    let outside = select(vec4(0u), vec4(1u, 2u, 4u, 8u), least < vec4(0.0));
    let near = select(0u, 16u, clip.z - clip.w > size.z);
    let far = select(0u, 32u, clip.z < -size.z);
    return Drawn(clip, outside.x | outside.y | outside.z | outside.w | near | far);
}

fn is_hidden(a: Drawn, b: Drawn, c: Drawn) -> bool {
    if (a.beyond & b.beyond & c.beyond) != 0u {
        return true;
    }
    if (detail.flags & FACING) == 0u || min(min(a.clip.w, b.clip.w), c.clip.w) <= 0.0 {
        return false;
    }
    let pa = a.clip.xy / a.clip.w * detail.half_size;
    let pb = b.clip.xy / b.clip.w * detail.half_size;
    let pc = c.clip.xy / c.clip.w * detail.half_size;
    let ab = pb - pa;
    let ac = pc - pa;
    let around = length(ab) + length(ac) + length(pc - pb);
    let reach = max(max(abs(pa), abs(pb)), abs(pc));
    let off = SNAP + ROUNDING * (reach.x + reach.y);
    // Twice the area, upwards positive: counter-clockwise is the front.
    return ab.x * ac.y - ab.y * ac.x < -off * (around + 4.0 * off);
}
