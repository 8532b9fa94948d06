#define_import_path dolomite::vegetation::straight

// What a strip of one segment makes up for: it is straight, and the blade that it stands for is bent. CPU reference, and
// where the numbers come from: plugins/vegetation/src/straight.rs.

// How much wider it is, for a droop and the sine of the elevation under which it is seen.
fn straight_wider(droop: f32, sine: f32) -> f32 {
    let square = sine * sine;
    return 1.0 + 0.4 * droop * square * (1.0 - square);
}

// By how much its middle is farther along the blade, times 4. `depth`: optical depth of all blades from the side.
fn straight_bow(droop: f32, sine: f32, depth: f32) -> f32 {
    let square = sine * sine;
    let side = 0.25 - 0.63 * droop;
    let above = 0.25 + 0.8 * droop;
    let deep = -0.5 * droop;
    let hidden = clamp(0.25 * (log2(max(depth / sine, 1e-6)) - 2.0), 0.0, 1.0);
    return side + (above - side) * 0.5 * (square + square * square) + (deep - side) * hidden;
}

// Where along the blade a place of the strip is.
fn straight_along(place: f32, bow: f32) -> f32 {
    return place + bow * place * (1.0 - place);
}
