//! Which windows are lit, by hash of the window and the hour. The same integers as `city/windows.wgsl`.

use crate::hash::{cell_hash, pcg, salted};
use crate::rules::CityRules;
use crate::streets::Cell;

/// A window of a building.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WindowPlace {
    /// Cell of the block.
    pub cell: Cell,
    /// Lot of the building, 0 to 3.
    pub lot: u32,
    /// Side of the building that the wall looks to.
    pub side: u32,
    /// From the wall's left end, seen from outside.
    pub column: u32,
    /// From the ground.
    pub storey: u32,
}

/// Hash of a window.
#[must_use]
pub const fn window_hash(seed: u32, window: &WindowPlace) -> u32 {
    let place = window.lot | (window.side << 2) | (window.column << 4) | (window.storey << 16);
    pcg(cell_hash(seed, window.cell).wrapping_add(place))
}

/// Share of the windows lit at the busiest time that is lit at an hour, from 0 to 24 and on from there: most
/// between 19 and 22, few at night, none by day. Linear between the hours given.
#[must_use]
pub fn busy(hour: f32) -> f32 {
    const HOURS: [(f32, f32); 9] = [
        (0.0, 0.35),
        (2.0, 0.08),
        (5.0, 0.08),
        (6.5, 0.45),
        (8.5, 0.0),
        (16.0, 0.0),
        (19.0, 1.0),
        (22.0, 1.0),
        (24.0, 0.35),
    ];
    let hour = hour.rem_euclid(24.0);
    let k = HOURS
        .iter()
        .rposition(|(from, _)| *from <= hour)
        .unwrap_or(0)
        .min(7);
    let [(from, a), (to, b)] = [HOURS[k], HOURS[k + 1]];
    a + (b - a) * (hour - from) / (to - from)
}

/// Below which 24-bit number a window is lit at an hour; not finite: none.
#[must_use]
pub fn lit_limit(rules: &CityRules, hour: f32) -> u32 {
    // 2²⁴ times a share; NaN becomes 0.
    (rules.window.lit * busy(hour) * 16_777_216.0) as u32
}

/// The number that [`lit_limit`] is compared with: three quarters belong to the window for good, a quarter changes
/// from hour to hour. From 0 to 2²⁴ − 1.
#[must_use]
pub const fn lit_number(window: u32, hour: u32) -> u32 {
    ((window >> 8) * 3 + (salted(window, hour) >> 8)) >> 2
}

/// Whether a window is lit.
#[must_use]
pub fn is_lit(rules: &CityRules, window: &WindowPlace, hour: f32) -> bool {
    let whole = hour.rem_euclid(24.0) as u32;
    lit_number(window_hash(rules.seed, window), whole) < lit_limit(rules, hour)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn share(hour: f32) -> f32 {
        let rules = CityRules::default();
        let lit = (0..40_000).filter(|k| {
            let window = WindowPlace {
                cell: [k % 50, -(k / 50 % 50)],
                lot: (k / 2500) as u32 % 4,
                side: (k / 10_000) as u32 % 4,
                column: (k % 3) as u32,
                storey: (k % 5) as u32,
            };
            is_lit(&rules, &window, hour)
        });
        lit.count() as f32 / 40_000.0
    }

    #[test]
    fn windows_are_lit_in_the_evening_and_dark_by_day() {
        assert_eq!(share(12.0), 0.0);
        assert_eq!(share(f32::NAN), 0.0);
        let (evening, night) = (share(20.5), share(3.0));
        // Not the share itself: the sum of two even numbers has its mass in the middle.
        assert!((0.55..0.75).contains(&evening), "{evening}");
        assert!((0.0..0.06).contains(&night), "{night}");
    }

    #[test]
    fn hours_go_round() {
        for hour in [0.0, 5.5, 12.0, 23.9] {
            // One rounding of the hour.
            assert!((busy(hour) - busy(hour + 24.0)).abs() < 1e-5);
        }
        assert!((busy(0.0) - busy(23.9999)).abs() < 1e-3);
        assert_eq!(busy(7.5), 0.225);
    }

    #[test]
    fn an_hour_later_some_have_changed() {
        let numbers = |hour| (0..1000).map(move |k| lit_number(pcg(k), hour));
        let changed = numbers(20).zip(numbers(21)).filter(|(a, b)| a != b).count();
        assert!(changed > 990);
        let far = numbers(20)
            .zip(numbers(21))
            .map(|(a, b)| a.abs_diff(b))
            .max();
        assert!(
            far.is_some_and(|far| far <= 1 << 22),
            "a quarter at most: {far:?}"
        );
    }
}
