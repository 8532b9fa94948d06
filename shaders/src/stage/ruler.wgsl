#define_import_path dolomite::stage::ruler

// How the strip between two rows of vertices is stitched. CPU reference:
// plugins/tessellation/src/ruler.rs, where the order is explained.

struct Step {
    // Vertices of the outer and the inner row before the step.
    outer: u32,
    inner: u32,
    // Whether the outer row advances: triangle (outer, outer + 1, inner), else
    // (outer, inner + 1, inner).
    advances_outer: bool,
}

// Bits 0, step, 2 step and so on; step a power of two up to 32.
fn multiples(step: u32) -> u32 {
    switch step {
        case 1u: { return 0xffffffffu; }
        case 2u: { return 0x55555555u; }
        case 4u: { return 0x11111111u; }
        case 8u: { return 0x01010101u; }
        case 16u: { return 0x00010001u; }
        default: { return 1u; }
    }
}

fn below(x: u32) -> u32 {
    return (1u << x) - 1u;
}

// The places of the half-edge that a row of `half` segments a half has beside its first.
fn places(half: u32) -> u32 {
    if half < 2u {
        return 0u;
    }
    let order = firstLeadingBit(half);
    let step = 32u >> order;
    let regular_places = multiples(step);
    let finer = select(multiples(step / 2u) & ~regular_places, 0u, order == 5u);
    let open = (half - (1u << order)) * step;
    return (regular_places & ~1u) | (finer & below(open));
}

// Step t of the first half: rows before it, and 1 where the outer one advances.
fn first_half(halves: vec2<u32>, t: u32) -> vec3<u32> {
    let lead = min(halves.x, 1u);
    if t < lead {
        return vec3(0u, 0u, 1u);
    }
    let rest = t - lead;
    let outer = places(halves.x);
    let inner = places(halves.y);
    // The last place that at most `rest` steps come before.
    var x = 0u;
    for (var bit = 16u; bit > 0u; bit >>= 1u) {
        let open = below(x + bit);
        if countOneBits(outer & open) + countOneBits(inner & open) <= rest {
            x += bit;
        }
    }
    let a = countOneBits(outer & below(x));
    let b = countOneBits(inner & below(x));
    let has_inner = (inner >> x) & 1u;
    if has_inner == 1u && rest == a + b {
        return vec3(a + lead, b, 0u);
    }
    return vec3(a + lead, b + has_inner, 1u);
}

// Step t of the strip between `outer` segments and the middle inner - 2 of an inner row.
fn transition(outer: u32, inner: u32, t: u32) -> Step {
    let rows = vec2(outer, inner - 2u);
    let halves = vec2(outer / 2u, inner / 2u);
    let half = halves.x + halves.y - 1u;
    let total = rows.x + rows.y;
    if t < half {
        let step = first_half(halves, t);
        return Step(step.x, step.y, step.z == 1u);
    }
    if t >= total - half {
        let step = first_half(halves, total - 1u - t);
        return Step(rows.x - step.x - step.z, rows.y - step.y - (1u - step.z), step.z == 1u);
    }
    // The middle segments of odd rows: the inner one first.
    let second = select(0u, 1u, t > half);
    return Step(halves.x, halves.y - 1u + second, (inner & 1u) == 0u || second == 1u);
}

// Step t of the strip between two rows of one kind, of m >= 2 and m - 2 segments.
fn regular(m: u32, t: u32) -> Step {
    if t == 0u {
        return Step(0u, 0u, true);
    }
    if t == 2u * m - 3u {
        return Step(m - 1u, m - 2u, true);
    }
    let cell = (t - 1u) / 2u;
    let second = (t - 1u) % 2u;
    if cell < (m - 1u) / 2u {
        return Step(1u + cell, cell + second, second == 1u);
    }
    return Step(1u + cell + second, cell, second == 0u);
}
