//! A sound in memory.

use std::sync::Arc;
use std::time::Duration;

use kira::Frame;

use crate::error::SoundError;

/// Least and greatest samples a second.
pub const RATES: (u32, u32) = (1000, 192_000);

/// Longest sound, samples: some six minutes at 48 kHz, 128 MiB in memory.
pub const MOST_SAMPLES: usize = 1 << 24;

/// A sound of one channel. Cheap to clone.
#[derive(Clone, Debug)]
pub struct Samples {
    rate: u32,
    frames: Arc<[Frame]>,
}

impl Samples {
    /// Of values from −1 to 1, `rate` a second.
    ///
    /// # Errors
    /// [`SoundError::Samples`]: none or more than [`MOST_SAMPLES`], one that is not finite, a rate outside [`RATES`].
    /// Values beyond −1 and 1 are allowed: the limiter keeps what comes out in range.
    pub fn new(rate: u32, values: &[f32]) -> Result<Self, SoundError> {
        let refuse = |reason: String| Err(SoundError::Samples(reason));
        if !(RATES.0..=RATES.1).contains(&rate) {
            return refuse(format!(
                "{rate} a second are not {} to {}",
                RATES.0, RATES.1
            ));
        }
        if values.is_empty() || values.len() > MOST_SAMPLES {
            return refuse(format!("{} are not 1 to {MOST_SAMPLES}", values.len()));
        }
        if let Some(at) = values.iter().position(|value| !value.is_finite()) {
            return refuse(format!("number {at} is {}", values[at]));
        }
        let frames = values
            .iter()
            .map(|value| Frame::from_mono(*value))
            .collect();
        Ok(Self { rate, frames })
    }

    /// Samples a second.
    #[must_use]
    pub fn rate(&self) -> u32 {
        self.rate
    }

    /// How many there are; at least one.
    #[must_use]
    #[expect(clippy::len_without_is_empty, reason = "there is always one")]
    pub fn len(&self) -> usize {
        self.frames.len()
    }

    /// The values.
    pub fn values(&self) -> impl ExactSizeIterator<Item = f32> + '_ {
        self.frames.iter().map(|frame| frame.left)
    }

    /// How long it is, played as it is.
    #[must_use]
    pub fn duration(&self) -> Duration {
        Duration::from_secs_f64(self.frames.len() as f64 / f64::from(self.rate))
    }

    pub(crate) fn frames(&self) -> Arc<[Frame]> {
        self.frames.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_that_cannot_be_played_are_refused_with_their_place() {
        assert!(
            (Samples::new(1000, &[0.0; 500])
                .unwrap()
                .duration()
                .as_secs_f64()
                - 0.5)
                .abs()
                < 1e-9
        );
        for (rate, values, word) in [
            (0, vec![0.0], "0 a second"),
            (400_000, vec![0.0], "400000"),
            (8000, vec![], "0 are not"),
            (8000, vec![0.0, f32::NAN], "number 1 is NaN"),
            (8000, vec![f32::INFINITY], "number 0"),
        ] {
            let error = Samples::new(rate, &values).unwrap_err().to_string();
            assert!(error.contains(word), "{error}");
        }
    }
}
