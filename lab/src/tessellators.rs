//! What tessellators may be set to, and levels drawn where one may go wrong.

use dolomite_tessellation::{Domain, Mode, Spacing, Winding};
use dolomite_testkit::random::Random;

/// Domains, as they are drawn.
pub const DOMAINS: [Domain; 3] = [Domain::Triangles, Domain::Quads, Domain::Isolines];
/// Spacings, as they are drawn.
pub const SPACINGS: [Spacing; 3] = [
    Spacing::Equal,
    Spacing::FractionalEven,
    Spacing::FractionalOdd,
];
/// Modes, as they are drawn.
pub const MODES: [Mode; 2] = [Mode::Exact, Mode::D3d];
/// Windings, as they are drawn.
pub const WINDINGS: [Winding; 2] = [Winding::Ccw, Winding::Cw];

/// A level that does not discard.
pub fn positive(random: &mut Random) -> f32 {
    match below(random, 32) {
        // An integer, 16 in all or up to 64, or its neighbour among f32.
        0..=4 => neighbour(random, 16),
        5..=8 => neighbour(random, 65),
        // Next to an integer.
        9..=13 => {
            let step = (8 + below(random, 17)) << 23;
            let apart = f32::from_bits(f32::to_bits(1.0) - step);
            let whole = whole(random, 64);
            if below(random, 2) == 0 {
                whole + apart
            } else {
                whole - apart
            }
        }
        // From the least denormal to 1.
        14 => f32::from_bits(1 + below(random, f32::to_bits(1.0))),
        // Denormals alone.
        15 => f32::from_bits(1 + below(random, (1 << 23) - 1)),
        // 64 and beyond.
        16 => {
            let least = f32::to_bits(64.0);
            let span = f32::to_bits(f32::INFINITY) - least;
            f32::from_bits(least + below(random, span + 1))
        }
        17 => [65.0, 1e9, f32::MAX, f32::INFINITY][below(random, 4) as usize],
        _ => (0.5 + 65.5 * random.unit()) as f32,
    }
}

/// Uniform, 0 to `end` − 1.
fn below(random: &mut Random, end: u32) -> u32 {
    random.below(end as usize) as u32
}

fn whole(random: &mut Random, most: u32) -> f32 {
    (1 + below(random, most)) as f32
}

fn neighbour(random: &mut Random, most: u32) -> f32 {
    let whole = whole(random, most);
    match below(random, 4) {
        0 => whole.next_up(),
        1 => whole.next_down(),
        _ => whole,
    }
}
