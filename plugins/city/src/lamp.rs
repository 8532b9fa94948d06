//! Lamps along the kerbs, by place: lamp `k` of a kerb stands at `(k + shift) · spacing` along it, with one shift
//! for each kerb of each street; where that is a crossing, at the crossing's corner.

use bytemuck::{Pod, Zeroable};

use crate::hash::{cell_hash, pcg, salted, unit};
use crate::rules::CityRules;
use crate::streets::{Cell, EAST, NORTH, WEST, street_at};

/// A lamp, 48 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Lamp {
    /// The cell whose block it stands on.
    pub cell: Cell,
    /// Foot, metres east and south of the cell's north-western corner.
    pub place: [f32; 2],
    /// The way its light hangs, a unit vector, east and south: across the street.
    pub direction: [f32; 2],
    /// Height of the post, metres.
    pub height: f32,
    /// Radius of the globe, metres.
    pub globe: f32,
    /// Linear sRGB, the brightest of the three is 1.
    pub colour: [f32; 3],
    /// Luminous flux, lumens.
    pub lumens: f32,
}

/// From the kerb to the foot, metres.
const BEHIND: f32 = 0.4;
/// From a crossing to the first lamp, metres.
const CORNER: f64 = 1.0;
/// Sodium, and the light of a warm diode (2200 K and 3000 K on the black body's curve, linear sRGB).
pub(crate) const COLOURS: [[f32; 3]; 2] = [[1.0, 0.52, 0.13], [1.0, 0.70, 0.41]];

/// The lamps of a side of a cell along the world's axis, metres.
struct Kerb {
    /// Numbers of its lamps, from the first to beyond the last.
    numbers: core::ops::Range<i64>,
    shift: f64,
    /// Between which they stand, clear of the crossings.
    ends: [f64; 2],
}

impl Kerb {
    fn new(rules: &CityRules, cell: Cell, side: usize) -> Self {
        let (along, line) = match side {
            WEST => (cell[1], cell[0]),
            EAST => (cell[1], cell[0].wrapping_add(1)),
            NORTH => (cell[0], cell[1]),
            _ => (cell[0], cell[1].wrapping_add(1)),
        };
        let spacing = f64::from(rules.lamp.spacing);
        let pitch = f64::from(rules.pitch);
        let start = f64::from(along) * pitch;
        let end = start + pitch;
        let kerb = cell_hash(rules.seed ^ 0x6c61_6d70, [side as i32, line]);
        let shift = f64::from(unit(kerb));
        let number = |place: f64| (place / spacing - shift).ceil() as i64;
        let numbers = if street_at(rules, cell, side) {
            number(start)..number(end)
        } else {
            0..0
        };
        let corner = 0.5 * f64::from(rules.street) + CORNER;
        Self {
            numbers,
            shift,
            ends: [start + corner, end - corner],
        }
    }

    fn places(self, spacing: f32) -> impl Iterator<Item = (i64, f64)> {
        let (shift, [low, high]) = (self.shift, self.ends);
        self.numbers.map(move |k| {
            let place = (k as f64 + shift) * f64::from(spacing);
            (k, place.clamp(low, high))
        })
    }
}

/// Lamps along a side of a cell's block.
#[must_use]
pub fn count(rules: &CityRules, cell: Cell, side: usize) -> usize {
    let numbers = Kerb::new(rules, cell, side).numbers;
    (numbers.end - numbers.start).max(0) as usize
}

/// The lamps of a cell's block, side after side.
pub fn lamps(rules: &CityRules, cell: Cell) -> impl Iterator<Item = Lamp> {
    (0..4).flat_map(move |side| side_lamps(rules, cell, side))
}

fn side_lamps(rules: &CityRules, cell: Cell, side: usize) -> impl Iterator<Item = Lamp> {
    let pitch = rules.pitch;
    let kerb = 0.5 * rules.street + BEHIND;
    let (direction, along) = match side {
        WEST => ([-1.0, 0.0], cell[1]),
        EAST => ([1.0, 0.0], cell[1]),
        NORTH => ([0.0, -1.0], cell[0]),
        _ => ([0.0, 1.0], cell[0]),
    };
    let start = f64::from(along) * f64::from(pitch);
    let own = salted(cell_hash(rules.seed, cell), 64 + side as u32);
    let (low, high) = rules.lamp.globe;
    let kerb_places = Kerb::new(rules, cell, side).places(rules.lamp.spacing);
    kerb_places.map(move |(number, place)| {
        let hash = pcg(own ^ (number as u32));
        let at = (place - start) as f32;
        Lamp {
            cell,
            place: match side {
                WEST => [kerb, at],
                EAST => [pitch - kerb, at],
                NORTH => [at, kerb],
                _ => [at, pitch - kerb],
            },
            direction,
            height: rules.lamp.height,
            globe: low + (high - low) * unit(salted(hash, 1)),
            // A whole kerb has lamps of one make.
            colour: COLOURS[(own & 1) as usize],
            lumens: rules.lamp.lumens * (0.9 + 0.2 * unit(salted(hash, 2))),
        }
    })
}

impl Lamp {
    /// Where its light hangs: east, up and south of the cell's corner, metres.
    #[must_use]
    pub fn light(&self, rules: &CityRules) -> [f32; 3] {
        let up = self.height * (1.0 - rules.lamp.drop) - self.globe;
        let out = rules.lamp.reach;
        [
            self.place[0] + self.direction[0] * out,
            up,
            self.place[1] + self.direction[1] * out,
        ]
    }
}

const _: () = assert!(size_of::<Lamp>() == 48);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rules::Streets;

    #[test]
    fn lamps_stand_on_kerbs_clear_of_crossings_and_as_far_apart_as_asked() {
        let rules = CityRules::default();
        let mut along_kerb = Vec::new();
        for z in -200..200 {
            for lamp in side_lamps(&rules, [3, z], WEST) {
                let [x, at] = lamp.place;
                assert_eq!(x, 4.4);
                assert!((5.0..=27.0).contains(&at), "{at}");
                along_kerb.push(f64::from(z) * 32.0 + f64::from(at));
            }
        }
        // 12 800 m by 30 m.
        assert!(
            (425..=428).contains(&along_kerb.len()),
            "{}",
            along_kerb.len()
        );
        for pair in along_kerb.windows(2) {
            // A lamp moves by the crossing's half and the metre beside it, at most.
            assert!((20.0..=40.0).contains(&(pair[1] - pair[0])), "{pair:?}");
        }
    }

    #[test]
    fn there_are_lamps_along_streets_alone() {
        let rules = CityRules {
            streets: Streets::Cross,
            ..CityRules::default()
        };
        assert_eq!(lamps(&rules, [5, 5]).count(), 0);
        let total: usize = (0..100).map(|z| count(&rules, [0, z], WEST)).sum();
        assert!((106..=107).contains(&total), "3200 m by 30 m: {total}");
    }

    #[test]
    fn the_narrowest_spacing_puts_no_two_lamps_in_one_place() {
        let mut rules = CityRules::default();
        rules.lamp.spacing = 8.0;
        for z in 0..200 {
            let places: Vec<f32> = side_lamps(&rules, [0, z], EAST)
                .map(|l| l.place[1])
                .collect();
            assert!(places.windows(2).all(|p| p[1] - p[0] > 0.5), "{places:?}");
        }
    }
}
