//! What stands and lies on the ground: boulders, blocks, lifts, stones.

use serde::Deserialize;

/// A thing, as it stands in the scene file. Places are `(x, z)`, lengths metres.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Thing {
    /// A flat boulder that is half in the ground: `height` above it, `radius` wide.
    Boulder {
        /// Its middle.
        at: (f64, f64),
        /// Half of its width.
        radius: f32,
        /// Of its top above the ground.
        height: f32,
        /// Same seed, same bumps.
        #[serde(default)]
        seed: u32,
    },
    /// A box that stands along the axes and stops who walks into it.
    Block {
        /// Its middle.
        at: (f64, f64),
        /// Width, height, depth.
        size: (f32, f32, f32),
    },
    /// A plate that goes up and down for ever.
    Lift {
        /// Its middle.
        at: (f64, f64),
        /// Width, height, depth.
        size: (f32, f32, f32),
        /// From its lowest place, on the ground, to its highest.
        rise: f32,
        /// Metres a second.
        speed: f32,
    },
    /// A ball that rolls when it is kicked.
    Stone {
        /// Its middle.
        at: (f64, f64),
        /// Its radius.
        radius: f32,
    },
}

impl Thing {
    /// Its middle, (x, z).
    pub fn at(&self) -> (f64, f64) {
        match *self {
            Self::Boulder { at, .. }
            | Self::Block { at, .. }
            | Self::Lift { at, .. }
            | Self::Stone { at, .. } => at,
        }
    }

    /// What is wrong with its numbers, for who wrote the file.
    ///
    /// # Errors
    /// A sentence.
    pub fn check(&self) -> Result<(), String> {
        let lengths: &[f32] = match self {
            Self::Boulder { radius, height, .. } => &[*radius, *height],
            Self::Block { size, .. } => &[size.0, size.1, size.2],
            Self::Lift {
                size, rise, speed, ..
            } => &[size.0, size.1, size.2, *rise, *speed],
            Self::Stone { radius, .. } => &[*radius],
        };
        let (x, z) = self.at();
        let large = |length: &&f32| !(**length > 0.0 && **length <= 1000.0);
        match lengths.iter().find(large) {
            Some(length) => Err(format!(
                "a thing at ({x}, {z}) has a length or speed of {length}, but all must be above 0 and at most 1000"
            )),
            None if !(x.is_finite() && z.is_finite()) => {
                Err(format!("a thing stands at ({x}, {z}), which is no place"))
            }
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_numbers_are_named() {
        let stone = |radius| Thing::Stone {
            at: (1.0, 2.0),
            radius,
        };
        assert!(stone(0.3).check().is_ok());
        for radius in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert!(stone(radius).check().unwrap_err().contains("(1, 2)"));
        }
        let nowhere = Thing::Block {
            at: (f64::NAN, 0.0),
            size: (1.0, 1.0, 1.0),
        };
        assert!(nowhere.check().is_err());
    }
}
