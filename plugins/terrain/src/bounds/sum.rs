//! Sums that are not linear in the noise, in intervals: the CPU reference of `noise::sum`.

use crate::interval::{CellBounds, Interval, SecondOrder};
use crate::noise::Octave;
use crate::noise::sum::SMOOTH_SQUARED;
use bevy::math::DVec2;

/// Bounds of the second derivatives, 1/cell²: 20/√3 = 11.547…, and 6.87.
pub(super) const SECOND: SecondOrder = SecondOrder {
    xx: 11.548,
    xz: 6.88,
    zz: 11.548,
};

/// Share of its amplitude by which an octave's f32 value may leave the bounds (twice what the
/// accuracy test sees).
pub(super) const ROUNDING: f64 = 2e-6;

/// One octave in one cell, amplitude 1.
#[derive(Clone, Copy)]
pub(super) struct Unit {
    pub value: Interval,
    /// ∂/∂x and ∂/∂z a metre.
    pub gradient: [Interval; 2],
}

impl Unit {
    /// Longest gradient.
    fn slope(&self) -> f64 {
        DVec2::new(self.gradient[0].size(), self.gradient[1].size()).length()
    }
}

/// A sum that is not linear in the noise, in one cell: the CPU reference of `noise::sum` in intervals.
#[derive(Clone, Copy)]
pub(super) struct State {
    pub sum: CellBounds,
    /// Ridged: weight of the next octave and its steepest slope.
    weight: (Interval, f64),
    /// Eroded: gathered slope G, and a bound of its Jacobian's norm.
    gathered: ([Interval; 2], f64),
}

/// |n| made smooth over an interval, and the most of its derivative's size.
fn smooth_abs(n: Interval) -> (Interval, f64) {
    let length = |n: f64| (n * n + f64::from(SMOOTH_SQUARED)).sqrt();
    let far = n.size();
    (
        Interval::new(length(n.nearest_zero()), length(far)),
        far / length(far),
    )
}

impl State {
    pub(super) const START: Self = Self {
        sum: CellBounds {
            height: Interval::point(0.0),
            slope: 0.0,
        },
        weight: (Interval::point(1.0), 0.0),
        gathered: ([Interval::point(0.0); 2], 0.0),
    };

    fn add(&mut self, octave: &Octave, value: Interval, slope: f64) {
        self.sum.height = self.sum.height.plus(value.scaled(octave.amplitude));
        self.sum.slope += octave.amplitude.abs() * slope;
    }

    pub(super) fn billow(&mut self, octave: &Octave, unit: &Unit) {
        let (length, turn) = smooth_abs(unit.value);
        let value = length.scaled(2.0).plus(Interval::point(-1.0));
        self.add(octave, value, 2.0 * turn * unit.slope());
    }

    pub(super) fn ridged(&mut self, octave: &Octave, unit: &Unit) {
        let (length, turn) = smooth_abs(unit.value);
        let ridge = Interval::point(1.0).plus(length.scaled(-1.0));
        let (near, far) = (ridge.nearest_zero(), ridge.size());
        let square = Interval::new(near * near, far * far);
        // The f32 error of n is multiplied by |n|″ ≤ 32 in the slope.
        let slope = 2.0 * far * (turn + 32.0 * ROUNDING) * unit.slope();
        let (weight, weight_slope) = self.weight;
        self.add(
            octave,
            square.times(weight),
            slope * weight.size() + square.high * weight_slope,
        );
        self.weight = (square, slope);
    }

    pub(super) fn eroded(&mut self, octave: &Octave, unit: &Unit, relative: f64, erosion: f64) {
        // The gathered slope is in units of the first octave's: lattice units times `relative`.
        let frequency = octave.frequency.value();
        let ([gx, gz], jacobian) = &mut self.gathered;
        *gx = gx.plus(unit.gradient[0].scaled(relative / frequency));
        *gz = gz.plus(unit.gradient[1].scaled(relative / frequency));
        *jacobian += relative.abs() * frequency * (SECOND.xx + SECOND.xz);
        let square = |side: fn(Interval) -> f64| side(*gx) * side(*gx) + side(*gz) * side(*gz);
        let (near, far) = (square(Interval::nearest_zero), square(Interval::size));
        let weight = Interval::new(1.0 / (1.0 + erosion * far), 1.0 / (1.0 + erosion * near));
        // |∇w| ≤ 2e w²|G|·‖J‖, and 2e|G|/(1 + e|G|²)² ≤ (3√3/8)√e, its maximum at e|G|² = 1/3.
        let fall =
            (2.0 * erosion * weight.high * weight.high * far.sqrt()).min(0.649_52 * erosion.sqrt());
        let slope = unit.slope() * weight.high + unit.value.size() * fall * *jacobian;
        self.add(octave, unit.value.times(weight), slope);
    }
}
