#define_import_path dolomite::detail::square

// Flat squares in the map of the horizon: the drawn ground is nowhere below them.

#import dolomite::detail::bindings::{counts, detail, HORIZON}
#import dolomite::detail::horizon::{COLUMNS, LAYERS, LAYER_ROUNDING, Mapped, column_of, layer_of, map_place, margin_at, ordered}

// s of a side of a flat square, `lift` above the eye, at u. No loop over sides: software Vulkan reads what a loop indexes lane
// by lane.
fn of_side(a: Mapped, b: Mapped, lift: f32, u: f32) -> f32 {
    let qa = 1.0 / a.depth;
    let qb = 1.0 / b.depth;
    let s = lift * (qa + (qb - qa) * ((u - a.u) / (b.u - a.u)));
    return select(-1e30, s, (a.u - u) * (b.u - u) <= 0.0 && a.u != b.u);
}

// The same of the square: of its far side where it is below the eye, else of its near side; -1e30 beside it.
fn side_of(a: Mapped, b: Mapped, c: Mapped, d: Mapped, lift: f32, u: f32) -> f32 {
    let one = max(of_side(a, b, lift, u), of_side(b, c, lift, u));
    return max(max(-1e30, one), max(of_side(c, d, lift, u), of_side(d, a, lift, u)));
}

// Relative to the stage's anchor.
fn draw_square(low: vec3<f32>, high: vec2<f32>) {
    let lift = low.y - detail.horizon.eye.y;
    let a = map_place(low);
    let b = map_place(vec3(high.x, low.yz));
    let c = map_place(vec3(high.x, low.y, high.y));
    let d = map_place(vec3(low.xy, high.y));
    let depths = vec4(a.depth, b.depth, c.depth, d.depth);
    let nearest = min(min(depths.x, depths.y), min(depths.z, depths.w));
    let farthest = max(max(depths.x, depths.y), max(depths.z, depths.w));
    let layer = ceil(layer_of(farthest) + LAYER_ROUNDING);
    if !(nearest >= detail.horizon.nearest && layer < f32(LAYERS) && abs(lift) < 1e30) {
        return;
    }
    let us = vec4(a.u, b.u, c.u, d.u);
    let left = min(min(us.x, us.y), min(us.z, us.w));
    let right = max(max(us.x, us.y), max(us.z, us.w));
    let margin = margin_at(max(abs(left), abs(right)), abs(lift) / nearest);
    let first = u32(max(ceil(column_of(left + margin)), 0.0));
    let last = u32(clamp(floor(column_of(right - margin)), 0.0, f32(COLUMNS)));
    let width = 2.0 * detail.horizon.reach / f32(COLUMNS);
    let row = HORIZON + u32(max(layer, 0.0)) * COLUMNS;
    for (var k = first; k < last; k++) {
        let u = f32(k) * width - detail.horizon.reach;
        let s = min(side_of(a, b, c, d, lift, u - margin), side_of(a, b, c, d, lift, u + width + margin));
        atomicMax(&counts[row + k], ordered(s - margin));
    }
}
