//! The figure off the ground: it bends its knees, leaps, falls and lands.

/// How long the knees bend before a leap from standing, seconds: when the feet leave the ground in the
/// clip `jump` of the person. Who runs leaps at once.
pub const BEND: f32 = 0.4;

/// Speed of a leap, metres a second: 46 cm high, as a grown person jumps.
pub const LEAP: f32 = 3.0;

/// Above this, metres a second, the leap is not prepared.
const RUNS: f32 = 0.5;

/// m/s².
const GRAVITY: f32 = 9.81;

/// Where a jump has got to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Jump {
    /// On the ground.
    #[default]
    None,
    /// Bending the knees.
    Bending {
        /// Seconds until the leap.
        left: f32,
    },
    /// On something that stands on the ground.
    On {
        /// Height of the feet above the ground under them, metres.
        lift: f64,
    },
    /// In the air.
    Air {
        /// Height of the feet above the ground under them, metres.
        lift: f64,
        /// Upwards, metres a second.
        rise: f32,
    },
}

impl Jump {
    /// Height of the feet above the ground, metres.
    pub fn lift(self) -> f64 {
        match self {
            Self::Air { lift, .. } | Self::On { lift } => lift,
            Self::None | Self::Bending { .. } => 0.0,
        }
    }

    /// Metres a second upwards; the coming leap's while the knees bend. `None` on the ground.
    pub fn climb(self) -> Option<f32> {
        match self {
            Self::None | Self::On { .. } => None,
            Self::Bending { .. } => Some(LEAP),
            Self::Air { rise, .. } => Some(rise),
        }
    }

    /// `seconds` later, on ground that is `ground` metres higher than before; `asked`: the player
    /// wants a leap; `speed` over the ground, metres a second.
    pub fn stepped(self, asked: bool, speed: f32, ground: f64, seconds: f32) -> Self {
        match self {
            // What is stood on may go down under bent knees: the leap is not prepared.
            Self::On { lift } if asked => Self::Air { lift, rise: LEAP },
            Self::On { lift } => Self::On {
                lift: lift - ground,
            },
            Self::None if asked && speed > RUNS => Self::Air {
                lift: 0.0,
                rise: LEAP,
            },
            Self::None if asked => Self::Bending { left: BEND },
            Self::None => Self::None,
            Self::Bending { left } if left > seconds => Self::Bending {
                left: left - seconds,
            },
            Self::Bending { .. } => Self::Air {
                lift: 0.0,
                rise: LEAP,
            },
            Self::Air { lift, rise } => {
                // The mean of both ends' speeds is exact under constant gravity.
                let after = rise - GRAVITY * seconds;
                let lift = lift + f64::from(0.5 * (rise + after) * seconds) - ground;
                // Rising out of the ground is no landing: it goes uphill.
                match lift > 0.0 || after > 0.0 {
                    true => Self::Air {
                        lift: lift.max(0.0),
                        rise: after,
                    },
                    false => Self::None,
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps until it is over: highest lift, seconds in the air.
    fn leap(ground: f64, seconds: f32) -> (f64, f32) {
        let mut jump = Jump::None.stepped(true, 2.0, 0.0, seconds);
        let (mut highest, mut air) = (0.0_f64, 0.0);
        while jump != Jump::None {
            jump = jump.stepped(false, 2.0, ground * f64::from(seconds), seconds);
            highest = highest.max(jump.lift());
            air += seconds;
            assert!(air < 10.0);
        }
        (highest, air)
    }

    #[test]
    fn a_leap_is_as_high_and_long_as_gravity_says_at_any_rate() {
        for rate in [16.0, 64.0, 1000.0] {
            let (highest, air) = leap(0.0, 1.0 / rate);
            let step = f64::from(LEAP / rate);
            assert!((highest - 0.4587).abs() < step, "{highest}");
            assert!((air - 0.6116).abs() <= 1.01 / rate, "{air}");
        }
    }

    #[test]
    fn uphill_it_lands_sooner_and_downhill_later() {
        let (_, level) = leap(0.0, 1.0 / 64.0);
        assert!(leap(1.0, 1.0 / 64.0).1 < level);
        assert!(leap(-1.0, 1.0 / 64.0).1 > level);
    }

    #[test]
    fn from_standing_the_knees_bend_first() {
        let mut jump = Jump::None.stepped(true, 0.0, 0.0, 0.125);
        assert_eq!(jump, Jump::Bending { left: BEND });
        assert_eq!((jump.lift(), jump.climb()), (0.0, Some(LEAP)));
        for _ in 0..4 {
            jump = jump.stepped(true, 0.0, 0.0, 0.125);
        }
        assert!(matches!(jump, Jump::Air { .. }), "{jump:?}");
    }
}
