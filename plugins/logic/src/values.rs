//! The values of one entity, by name.
//!
//! They lie in one block of memory that is at most half full and searched from the place that the name's number says
//! (open addressing with linear probing and D. Knuth's multiplicative hash, The Art of Computer Programming 3, 6.4),
//! so that a query or a change costs a few nanoseconds however many values there are. A value keeps the kind that it
//! was first set to.

use crate::names::Key;
use crate::value::{Typed, Value, ValueError};
use bevy::ecs::prelude::*;
use bevy::reflect::prelude::*;

/// Marks entities that logic works on; every component of this crate brings it along.
#[derive(Component, Reflect, Clone, Copy, Debug, Default)]
#[reflect(Component, Default, Clone)]
pub struct Logic;

/// The number of no name.
const FREE: u32 = u32::MAX;

#[derive(Clone, Copy, Debug)]
struct Slot {
    key: u32,
    value: Value,
}

/// Typed values that are queried and set by name.
#[derive(Component, Clone, Debug, Default)]
#[require(Logic)]
pub struct Values {
    /// A power of two of them, or none.
    slots: Box<[Slot]>,
    used: u32,
    /// Of every set that changed something.
    changes: u32,
}

impl Values {
    /// With values to begin with. Those that cannot be set are left out.
    #[must_use]
    pub fn with<V: Into<Value>>(values: impl IntoIterator<Item = (Key, V)>) -> Self {
        let mut all = Self::default();
        for (key, value) in values {
            // A value that cannot be set is not there, which a query says.
            let _ = all.set(key, value.into());
        }
        all
    }

    /// The slot of a key, or the free one that it would take. There has to be a free slot.
    #[inline]
    fn slot(&self, key: u32) -> usize {
        let mask = self.slots.len() - 1;
        // The fraction of the golden ratio in 32 bits; the middle bits of the product are well mixed.
        let mut at = (key.wrapping_mul(0x9e37_79b9) >> 16) as usize & mask;
        while self.slots[at].key != key && self.slots[at].key != FREE {
            at = (at + 1) & mask;
        }
        at
    }

    /// A value, if it was ever set.
    #[inline]
    #[must_use]
    pub fn get(&self, key: Key) -> Option<Value> {
        if self.slots.is_empty() {
            return None;
        }
        let slot = &self.slots[self.slot(key.number())];
        (slot.key != FREE).then_some(slot.value)
    }

    /// A value of this type.
    #[inline]
    #[must_use]
    pub fn read<T: Typed>(&self, key: Key) -> Option<T> {
        self.get(key).and_then(T::read)
    }

    /// A value as [`Value::number`] has it; 0 of one that was never set.
    #[inline]
    #[must_use]
    pub fn number(&self, key: Key) -> f32 {
        self.get(key).map_or(0.0, |value| value.number())
    }

    /// Sets a value and gives the one before.
    ///
    /// # Errors
    /// [`ValueError`]: numbers that are not finite, and another kind than before. Nothing is changed then.
    #[inline]
    pub fn set(&mut self, key: Key, value: Value) -> Result<Option<Value>, ValueError> {
        if !value.is_finite() {
            return Err(ValueError::NotFinite);
        }
        if self.slots.is_empty() {
            self.grow();
        }
        let mut at = self.slot(key.number());
        if self.slots[at].key == FREE {
            if value == Value::None {
                return Err(ValueError::Kind {
                    has: value.kind(),
                    given: value.kind(),
                });
            }
            if (self.used as usize + 1) * 2 > self.slots.len() {
                self.grow();
                at = self.slot(key.number());
            }
            self.slots[at] = Slot {
                key: key.number(),
                value,
            };
            self.used += 1;
            self.changes = self.changes.wrapping_add(1);
            return Ok(None);
        }
        let slot = &mut self.slots[at];
        if slot.value.kind() != value.kind() {
            return Err(ValueError::Kind {
                has: slot.value.kind(),
                given: value.kind(),
            });
        }
        let before = slot.value;
        if before != value {
            slot.value = value;
            self.changes = self.changes.wrapping_add(1);
        }
        Ok(Some(before))
    }

    #[cold]
    fn grow(&mut self) {
        let free = Slot {
            key: FREE,
            value: Value::None,
        };
        let more = vec![free; (self.slots.len() * 2).max(4)].into_boxed_slice();
        let old = std::mem::replace(&mut self.slots, more);
        for slot in old.iter().filter(|slot| slot.key != FREE) {
            let at = self.slot(slot.key);
            self.slots[at] = *slot;
        }
    }

    /// How many values there are.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.used as usize
    }

    /// Whether none was ever set.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.used == 0
    }

    /// How often a value became another one: whoever keeps the last number knows whether to look again.
    #[must_use]
    pub const fn changes(&self) -> u32 {
        self.changes
    }

    /// All of them, in the order of their names' numbers.
    #[must_use]
    pub fn sorted(&self) -> Vec<(u32, Value)> {
        let used = self.slots.iter().filter(|slot| slot.key != FREE);
        let mut all: Vec<_> = used.map(|slot| (slot.key, slot.value)).collect();
        all.sort_unstable_by_key(|&(key, _)| key);
        all
    }

    /// Bytes beside the component itself.
    #[must_use]
    pub fn bytes(&self) -> usize {
        std::mem::size_of_val(&*self.slots)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::names::Names;
    use crate::value::Kind;
    use bevy::math::Vec3;

    #[test]
    fn every_value_is_found_again_however_many_there_are() {
        let mut names = Names::default();
        let keys: Vec<Key> = (0..500).map(|i| names.intern(&format!("v{i}"))).collect();
        let mut values = Values::default();
        assert_eq!(values.get(keys[0]), None);
        for (i, &key) in keys.iter().enumerate() {
            assert_eq!(values.set(key, Value::Int(i as i32)), Ok(None));
            assert_eq!(values.len(), i + 1);
        }
        for (i, &key) in keys.iter().enumerate() {
            assert_eq!(values.read::<i32>(key), Some(i as i32));
        }
        assert_eq!(values.get(Key::ALERT), None);
        assert_eq!(values.sorted().len(), 500);
        assert!(values.sorted().is_sorted_by_key(|&(key, _)| key));
    }

    #[test]
    fn a_value_keeps_its_kind_and_stays_finite() {
        let mut values = Values::with([(Key::ALERT, 0.5_f32)]);
        let before = values.changes();
        assert_eq!(
            values.set(Key::ALERT, Value::Float(f32::NAN)),
            Err(ValueError::NotFinite)
        );
        assert_eq!(
            values.set(Key::PLACE, Value::Vec3(Vec3::new(0.0, f32::INFINITY, 0.0))),
            Err(ValueError::NotFinite)
        );
        let wrong = values.set(Key::ALERT, Value::Int(1));
        let (has, given) = (Kind::Float, Kind::Int);
        assert_eq!(wrong, Err(ValueError::Kind { has, given }));
        assert!(values.set(Key::PLACE, Value::None).is_err());
        assert_eq!(values.get(Key::PLACE), None);
        assert_eq!(values.number(Key::ALERT), 0.5);
        assert_eq!(values.changes(), before, "what was refused changes nothing");
        let same = values.set(Key::ALERT, Value::Float(0.5));
        assert_eq!(same, Ok(Some(Value::Float(0.5))));
        assert_eq!(values.changes(), before);
        assert!(values.set(Key::ALERT, Value::Float(0.25)).is_ok());
        assert_ne!(values.changes(), before);
    }
}
