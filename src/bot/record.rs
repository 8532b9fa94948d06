//! Recorded games: the level, its seed, the input of every step, and what came of it.

use std::path::Path;

use bevy::prelude::*;

use crate::input::PlayerInput;
use crate::level::sealed::{self, Kind, SealedError};

/// Recordings.
pub const RECORD: Kind = Kind {
    letters: b"PLAY",
    name: "recorded game",
    version: 2,
};

/// Bytes of a step: walk and look, four floats, and a byte of switches.
const STEP: usize = 17;

/// A recorded game.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record {
    /// Which level.
    pub level: String,
    /// Its seed.
    pub seed: u64,
    /// The hash at its end.
    pub hash: u64,
    /// Of every step.
    pub inputs: Vec<PlayerInput>,
}

impl Record {
    /// Writes it.
    ///
    /// # Errors
    /// [`SealedError::Write`].
    pub fn write(&self, path: &Path) -> Result<(), SealedError> {
        sealed::write(RECORD, path, &self.bytes())
    }

    /// Reads it.
    ///
    /// # Errors
    /// [`SealedError`] for whatever is not whole, and for numbers that are not finite.
    pub fn read(path: &Path) -> Result<Self, SealedError> {
        let bytes = sealed::read(RECORD, path)?;
        Self::from_bytes(&bytes).ok_or_else(|| SealedError::Content {
            path: path.to_owned(),
            reason: "it is no list of steps with finite numbers".to_owned(),
        })
    }

    fn bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(32 + self.inputs.len() * STEP);
        bytes.extend((self.level.len() as u32).to_le_bytes());
        bytes.extend(self.level.as_bytes());
        bytes.extend(self.seed.to_le_bytes());
        bytes.extend(self.hash.to_le_bytes());
        for input in &self.inputs {
            for number in [input.walk.x, input.walk.y, input.look.x, input.look.y] {
                bytes.extend(number.to_le_bytes());
            }
            let bits = [
                input.fast,
                input.jump,
                input.act,
                input.switch_torch,
                input.fire,
            ];
            bytes.push((0..).zip(bits).map(|(at, bit)| u8::from(bit) << at).sum());
        }
        bytes
    }

    fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let (length, rest) = bytes.split_first_chunk()?;
        let length = u32::from_le_bytes(*length) as usize;
        let (level, rest) = rest.split_at_checked(length)?;
        let (seed, rest) = rest.split_first_chunk()?;
        let (hash, rest) = rest.split_first_chunk()?;
        let (steps, over) = rest.as_chunks::<STEP>();
        let mut inputs = Vec::with_capacity(steps.len());
        for step in steps {
            let number = |at: usize| {
                let bytes = [step[at], step[at + 1], step[at + 2], step[at + 3]];
                f32::from_le_bytes(bytes)
            };
            let (walk, look) = (
                Vec2::new(number(0), number(4)),
                Vec2::new(number(8), number(12)),
            );
            if !(walk.is_finite() && look.is_finite()) {
                return None;
            }
            let bit = |at: u32| step[16] >> at & 1 == 1;
            inputs.push(PlayerInput {
                walk,
                look,
                fast: bit(0),
                jump: bit(1),
                act: bit(2),
                switch_torch: bit(3),
                fire: bit(4),
                ..default()
            });
        }
        over.is_empty().then(|| {
            Some(Self {
                level: std::str::from_utf8(level).ok()?.to_owned(),
                seed: u64::from_le_bytes(*seed),
                hash: u64::from_le_bytes(*hash),
                inputs,
            })
        })?
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_and_nothing_else() {
        let record = Record {
            level: "mountain".into(),
            seed: 7,
            hash: 0x1234_5678_9abc_def0,
            inputs: (0..40)
                .map(|i| PlayerInput {
                    walk: Vec2::new(0.1, -0.9) * i as f32 / 40.0,
                    look: Vec2::new(-0.01, 0.0),
                    fast: i % 2 == 0,
                    act: i % 3 == 0,
                    jump: i % 5 == 0,
                    switch_torch: i % 7 == 0,
                    fire: i % 4 == 0,
                    ..default()
                })
                .collect(),
        };
        let bytes = record.bytes();
        assert_eq!(Record::from_bytes(&bytes), Some(record.clone()));
        assert!(Record::from_bytes(&bytes[..bytes.len() - 1]).is_none());
        let mut wild = record;
        wild.inputs[3].walk.x = f32::NAN;
        assert!(Record::from_bytes(&wild.bytes()).is_none());
    }
}
