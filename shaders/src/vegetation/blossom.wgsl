#define_import_path dolomite::vegetation::blossom

// The head of a flower: petals around a middle, as triangles. Lengths are shares of its radius. CPU reference:
// plugins/vegetation/src/blossom.rs.

// Vertices of a petal; of the middle, which is a hexagon.
const PETAL: u32 = 9u;
const MIDDLE: u32 = 12u;

// Where petals begin, are widest and end; how wide they are at the end, as a share of the widest; the middle's radius.
const PETAL_FROM: f32 = 0.15;
const PETAL_WIDE: f32 = 0.55;
const PETAL_TO: f32 = 0.97;
const PETAL_END: f32 = 0.6;
const MIDDLE_RADIUS: f32 = 0.28;
// Share of the middle that no petal is below.
const MIDDLE_ALONE: f32 = 0.65;

// A vertex of the head: in its plane, and above it.
struct HeadPoint {
    at: vec2<f32>,
    rise: f32,
    // 0 in the middle, 1 in a petal; between, a mean of both.
    petal: f32,
}

// The axes of a head: out of its plane, and two in it.
struct HeadFrame {
    axis: vec3<f32>,
    right: vec3<f32>,
    ahead: vec3<f32>,
}

// Half the greatest width of one of so many petals: they touch their neighbours.
fn petal_half(petals: f32) -> f32 {
    return min(1.05 * PETAL_WIDE * tan(3.14159265 / petals), 0.45);
}

// Area of all petals.
fn petals_area(petals: f32) -> f32 {
    return petals * petal_half(petals) * ((PETAL_WIDE - PETAL_FROM) + (1.0 + PETAL_END) * (PETAL_TO - PETAL_WIDE));
}

// Corner of a hexagon of radius 1 for a vertex of its four triangles.
fn hexagon_corner(number: u32) -> vec2<f32> {
    let corner = select(number / 3u + number % 3u, 0u, number % 3u == 0u);
    let angle = 1.04719755 * f32(corner);
    return vec2(cos(angle), sin(angle));
}

// Vertex of a head that is seen from near by: first all petals, then the middle. Beyond them one point.
fn head_near(number: u32, petals: u32) -> HeadPoint {
    if number >= PETAL * petals {
        let rest = number - PETAL * petals;
        if rest >= MIDDLE {
            return HeadPoint(vec2(0.0), 0.0, 0.0);
        }
        return HeadPoint(MIDDLE_RADIUS * hexagon_corner(rest), 0.08, 0.0);
    }
    // Corners: base, left and right where it is widest, left and right at the end; three triangles of a strip.
    let corner = number % PETAL / 3u + number % 3u;
    let half = petal_half(f32(petals));
    var out = PETAL_FROM;
    var side = 0.0;
    var rise = 0.0;
    if corner > 0u {
        let is_end = corner > 2u;
        out = select(PETAL_WIDE, PETAL_TO, is_end);
        side = select(half, half * PETAL_END, is_end) * select(1.0, -1.0, (corner & 1u) == 1u);
        rise = select(0.12, 0.16, is_end);
    }
    let angle = 6.2831853 * f32(number / PETAL) / f32(petals);
    let ahead = vec2(cos(angle), sin(angle));
    return HeadPoint(out * ahead + side * vec2(-ahead.y, ahead.x), rise, 1.0);
}

// Vertex of one that is seen from afar: a hexagon of the same area and of the mean colour.
fn head_far(number: u32, petals: u32) -> HeadPoint {
    if number >= MIDDLE {
        return HeadPoint(vec2(0.0), 0.0, 1.0);
    }
    let middle = 2.5980762 * MIDDLE_RADIUS * MIDDLE_RADIUS;
    let all = petals_area(f32(petals)) + MIDDLE_ALONE * middle;
    return HeadPoint(sqrt(all / 2.5980762) * hexagon_corner(number), 0.08, 1.0 - middle / all);
}

// Axes of a head on a stem that ends in a direction: half up, half along the stem.
fn head_frame(tangent: vec3<f32>, across: vec2<f32>) -> HeadFrame {
    let axis = normalize(tangent / max(length(tangent), 1e-9) + vec3(0.0, 0.8, 0.0));
    let side = vec3(across.x, 0.0, across.y);
    let right = normalize(side - axis * dot(side, axis));
    return HeadFrame(axis, right, cross(axis, right));
}
