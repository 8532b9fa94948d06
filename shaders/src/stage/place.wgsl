#define_import_path dolomite::stage::place

// Where the vertices of an edge lie. CPU reference: plugins/tessellation/src/place.rs, where the
// formulas are explained.

#import dolomite::stage::types::{ONE, UNIT, EQUAL, D3D}
#import dolomite::stage::divide::divide
#import dolomite::stage::level::segments

struct StageEdge {
    // Number of segments n.
    count: u32,
    // Weight of n segments against n - 2, in units of 2^-24; UNIT at a whole level.
    weight: u32,
}

fn stage_edge(level: u32, spacing: u32) -> StageEdge {
    let n = segments(level, spacing);
    return StageEdge(n, select(level + 2u * ONE - n * ONE, UNIT, spacing == EQUAL));
}

// a / b rounded to nearest, halves up.
fn rounded(a: u32, b: u32) -> u32 {
    let quotient = divide(a, b);
    return quotient + select(0u, 1u, 2u * (a - quotient * b) >= b);
}

// 65536 / n, rounded to nearest.
fn reciprocal(n: u32) -> u32 {
    return divide(65536u + n / 2u, n);
}

// Last vertex of the half that keeps its number when the edge grows from n - 2 to n segments.
fn split_place(n: u32) -> u32 {
    let half = n / 2u - 1u;
    return select(2u * (half - (1u << firstLeadingBit(half))) + 1u, 0u, half == 0u);
}

// times / parts of the place of vertex j <= n / 2, rounded to nearest in units of 2^-24.
fn scaled(edge: StageEdge, j: u32, times: u32, parts: u32) -> u32 {
    let n = edge.count;
    if n <= 2u || edge.weight == UNIT {
        return rounded(times * j * UNIT, parts * n);
    }
    let moved = j > split_place(n);
    let i = j - select(0u, 1u, moved);
    let whole = times * i * UNIT;
    let divisor = parts * (n - 2u);
    let quotient = divide(whole, divisor);
    let rest = (whole - quotient * divisor) * n;
    let shift = times * edge.weight;
    let full = divisor * n;
    if moved {
        return quotient + rounded(rest + (n - 2u * j) * shift, full);
    }
    let less = 2u * j * shift;
    let steps = divide(less, full);
    let twice = 2 * (i32(rest) - i32(less - steps * full)) + i32(full);
    return quotient - steps + select(0u, 1u, twice >= 2 * i32(full)) - select(0u, 1u, twice < 0);
}

// As the 16.16 fixed-point reference places vertex j < n / 2, in units of 2^-16.
fn reference_place(edge: StageEdge, j: u32) -> u32 {
    let n = edge.count;
    if edge.weight == UNIT {
        return j * reciprocal(n);
    }
    let i = j - select(0u, 1u, j > split_place(n));
    let weight = edge.weight >> 8u;
    let fewer = i * reciprocal(n - 2u) * (65536u - weight);
    return (fewer + j * reciprocal(n) * weight + 32768u) >> 16u;
}

// Where vertex p of 0 to n lies, in units of 2^-24: place(n - p) == UNIT - place(p).
fn place(edge: StageEdge, p: u32, mode: u32) -> u32 {
    let mirrored = edge.count - p;
    if p == mirrored {
        return UNIT / 2u;
    }
    let j = min(p, mirrored);
    var at = 0u;
    if mode == D3D {
        at = reference_place(edge, j) << 8u;
    } else {
        at = scaled(edge, j, 1u, 1u);
    }
    return select(UNIT - at, at, p < mirrored);
}
