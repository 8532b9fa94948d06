#define_import_path dolomite::vegetation::noise

// Smooth noise for colours, from integers of the place.

#import dolomite::terrain::hash::pcg

fn corner(cell: vec2<i32>) -> f32 {
    return f32(pcg(bitcast<u32>(cell.x) + pcg(bitcast<u32>(cell.y))) >> 8u) * 5.9604644775390625e-8;
}

// Between 0 and 1, with one value each 2^size metres; `anchor` is the world's whole metres that `place` counts from.
fn smooth_noise(anchor: vec2<i32>, place: vec2<f32>, size: u32) -> f32 {
    let rest = vec2<f32>(anchor & vec2((1 << size) - 1));
    let at = (place + rest) / f32(1 << size);
    let whole = floor(at);
    let part = at - whole;
    let base = (anchor >> vec2(size)) + vec2<i32>(whole);
    let w = part * part * (3.0 - 2.0 * part);
    let low = mix(corner(base), corner(base + vec2(1, 0)), w.x);
    let high = mix(corner(base + vec2(0, 1)), corner(base + vec2(1, 1)), w.x);
    return mix(low, high, w.y);
}
