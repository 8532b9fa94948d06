//! A number that follows another one without a jump of its speed.

use bevy::math::ops;

/// A critically damped spring.
///
/// The step is the exact solution for a target that rests during it, so it is stable for any step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spring {
    /// The number.
    pub value: f32,
    /// Its change, a second.
    pub speed: f32,
}

impl Spring {
    /// At rest at `value`.
    #[must_use]
    pub const fn at(value: f32) -> Self {
        Self { value, speed: 0.0 }
    }

    /// Goes on by `dt` seconds towards `target`; `time` seconds is how far it lags behind a target that
    /// moves steadily. A time that is not positive means at once.
    pub fn follow(&mut self, target: f32, time: f32, dt: f32) {
        if !(target.is_finite() && dt > 0.0) {
            return;
        }
        let follows = time > 0.0 && self.value.is_finite() && self.speed.is_finite();
        if !follows {
            *self = Self::at(target);
            return;
        }
        // x'' = −2 ω x' − ω² (x − target) lags by 2/ω.
        let omega = 2.0 / time;
        let away = self.value - target;
        let slope = self.speed + omega * away;
        let decay = ops::exp(-omega * dt);
        self.value = target + (away + slope * dt) * decay;
        self.speed = (self.speed - omega * slope * dt) * decay;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_long_step_is_many_short_ones() {
        let (mut long, mut short) = (Spring::at(1.0), Spring::at(1.0));
        long.follow(3.0, 0.2, 0.25);
        for _ in 0..1000 {
            short.follow(3.0, 0.2, 0.00025);
        }
        // A thousand roundings of numbers near 3.
        assert!(
            (long.value - short.value).abs() < 1e-3,
            "{long:?} {short:?}"
        );
        long.follow(3.0, 0.2, 1e6);
        assert_eq!(long.value, 3.0);
        long.follow(f32::NAN, 0.2, 0.1);
        assert_eq!(long.value, 3.0);
    }

    #[test]
    fn it_lags_by_its_time() {
        let mut spring = Spring::default();
        let dt = 0.001;
        for step in 0..5000 {
            spring.follow(step as f32 * dt, 0.3, dt);
        }
        assert!((4.999 - spring.value - 0.3).abs() < 0.003, "{spring:?}");
    }
}
