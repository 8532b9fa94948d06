#define_import_path dolomite::inspector::legend

// What the colours of a picture mean, with numbers, in its lower left corner: a ramp with its ends, or a swatch a level.
// Digits of three dots by five. Rust: `picture/legend.rs` of `dolomite_inspector` says where it lies.

#import dolomite::inspector::colours::{LEVELS, MORE, level_colour, ramp}

// Dots between the corner of the view and the box.
const MARGIN: i32 = 4;
// The box of a ramp and of levels, dots.
const RAMP_BOX: vec2<i32> = vec2(112, 21);
const LEVEL_BOX: vec2<i32> = vec2(106, 32);
// The ramp in its box, and the swatch of what is beyond it; a swatch of a level.
const RAMP_FIRST: vec2<i32> = vec2(6, 3);
const RAMP_SIZE: vec2<i32> = vec2(64, 8);
const MORE_FIRST: vec2<i32> = vec2(82, 3);
const MORE_SIZE: vec2<i32> = vec2(8, 8);
const SWATCH: vec2<i32> = vec2(13, 10);
// Levels of a row.
const ACROSS: i32 = 8;

const PAPER: vec3<f32> = vec3(0.06, 0.06, 0.06);
const INK: vec3<f32> = vec3(1.0, 1.0, 1.0);

// Symbols behind the digits.
const POINT: u32 = 10u;
const GREATER: u32 = 11u;
const LETTER_P: u32 = 12u;
const LETTER_X: u32 = 13u;

// Five rows from the top, three bits each.
fn rows_of(symbol: u32) -> u32 {
    var rows = array<u32, 14>(
        0x7b6fu, 0x2c97u, 0x73e7u, 0x73cfu, 0x5bc9u, 0x79cfu, 0x79efu, 0x7292u, 0x7befu, 0x7bcfu,
        0x0002u, 0x4454u, 0x0d74u, 0x0aa8u,
    );
    return rows[symbol];
}

fn is_symbol(symbol: u32, at: vec2<i32>) -> bool {
    if any(at < vec2(0)) || any(at >= vec2(3, 5)) {
        return false;
    }
    return ((rows_of(symbol) >> u32(14 - 3 * at.y - at.x)) & 1u) == 1u;
}

fn digits_of(whole: u32) -> i32 {
    return 1 + select(0, 1, whole > 9u) + select(0, 1, whole > 99u) + select(0, 1, whole > 999u) + select(0, 1, whole > 9999u);
}

// A number from 0 to 99999 about a column, with two decimals at most: below 100 one, and below 10 both.
fn is_number(value: f32, middle: i32, at: vec2<i32>) -> bool {
    let step = select(select(100u, 10u, value < 100.0), 1u, value < 10.0);
    let hundredths = u32(round(value * 100.0 / f32(step))) * step;
    let digits = digits_of(hundredths / 100u);
    let rest = hundredths % 100u;
    let decimals = select(select(2, 1, rest % 10u == 0u), -1, rest == 0u);
    let symbols = digits + 1 + decimals;
    let x = at.x - (middle - 2 * symbols);
    if x < 0 || x >= 4 * symbols {
        return false;
    }
    let place = x / 4;
    // The last digit of what is left without those behind it.
    var left = hundredths;
    let behind = select(digits + 2 - place, digits + 1 - place, place < digits);
    for (var k = 0; k < behind; k++) {
        left /= 10u;
    }
    return is_symbol(select(left % 10u, POINT, place == digits), vec2(x % 4, at.y));
}

// A place of a view of `size` pixels in dots from the corner of a box.
fn dot_of(place: vec2<f32>, size: vec2<f32>, box: vec2<i32>) -> vec2<i32> {
    let scale = max(floor(size.y / 240.0), 1.0);
    let from_below = vec2(place.x, size.y - place.y) / scale;
    let dots = vec2<i32>(floor(from_below)) - vec2(MARGIN);
    return vec2(dots.x, box.y - 1 - dots.y);
}

fn is_within(at: vec2<i32>, first: vec2<i32>, size: vec2<i32>) -> bool {
    return all(at >= first) && all(at < first + size);
}

// The picture's colour, or that of the legend of a ramp over it, whose end is `most`, in pixels or without unit.
fn with_ramp(colour: vec3<f32>, place: vec2<f32>, size: vec2<f32>, most: f32, in_pixels: bool) -> vec3<f32> {
    let at = dot_of(place, size, RAMP_BOX);
    if !is_within(at, vec2(0), RAMP_BOX) {
        return colour;
    }
    if is_within(at, RAMP_FIRST, RAMP_SIZE) {
        return ramp((f32(at.x - RAMP_FIRST.x) + 0.5) / f32(RAMP_SIZE.x));
    }
    if is_within(at, MORE_FIRST, MORE_SIZE) {
        return MORE;
    }
    let below = at - vec2(0, RAMP_FIRST.y + RAMP_SIZE.y + 3);
    let first = RAMP_FIRST.x;
    let last = first + RAMP_SIZE.x;
    var ink = is_number(0.0, first, below) || is_number(0.5 * most, (first + last) / 2, below) || is_number(most, last, below);
    ink = ink || is_symbol(GREATER, below - vec2(MORE_FIRST.x + 2, 0));
    if in_pixels {
        let unit = below - vec2(MORE_FIRST.x + 14, 0);
        ink = ink || is_symbol(LETTER_P, unit) || is_symbol(LETTER_X, unit - vec2(4, 0));
    }
    return select(PAPER, INK, ink);
}

// The same of levels.
fn with_levels(colour: vec3<f32>, place: vec2<f32>, size: vec2<f32>) -> vec3<f32> {
    let at = dot_of(place, size, LEVEL_BOX);
    if !is_within(at, vec2(0), LEVEL_BOX) {
        return colour;
    }
    let inner = at - vec2(1);
    let swatch = inner / SWATCH;
    let level = u32(swatch.y * ACROSS + swatch.x);
    if any(inner < vec2(0)) || swatch.x >= ACROSS || level >= LEVELS {
        return PAPER;
    }
    let own = level_colour(level);
    let bright = dot(own, vec3(0.3, 0.6, 0.1)) > 0.45;
    let ink = is_number(f32(level), SWATCH.x / 2, inner - swatch * SWATCH - vec2(0, 2));
    return select(own, select(INK, PAPER, bright), ink);
}
