//! A number of what logic has come to: two runs that went apart have another one.

use crate::action::DelayedActions;
use crate::behaviour::Mind;
use crate::clock::LogicClock;
use crate::movement::Walker;
use crate::parts::{
    Button, DayClock, Door, Health, Inside, Lamp, Lift, LogicTimer, Mission, Objective, PickUp,
    Shots, Weapon,
};
use crate::senses::Memory;
use crate::values::{Logic, Values};
use bevy::ecs::prelude::*;
use bevy::ecs::query::QueryFilter;
use bevy::transform::components::Transform;
use std::fmt::{Debug, Write};

/// Takes words and texts in order: FNV-1a (G. Fowler, L. C. Noll, P. Vo, 1991) over 32-bit words, with a mix at the
/// end.
#[derive(Clone, Copy, Debug)]
struct Mixer(u64);

impl Mixer {
    const fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    fn word(&mut self, word: u32) {
        self.0 = (self.0 ^ u64::from(word)).wrapping_mul(0x0100_0000_01b3);
        // A product moves nothing to the right: high bits come down.
        self.0 ^= self.0 >> 29;
    }
}

impl Write for Mixer {
    fn write_str(&mut self, text: &str) -> std::fmt::Result {
        for byte in text.bytes() {
            self.word(u32::from(byte));
        }
        Ok(())
    }
}

/// A component of every entity, in the order of entities.
fn each<C: Component, F: QueryFilter>(
    world: &mut World,
    mixer: &mut Mixer,
    mix: impl Fn(&C, &mut Mixer),
) {
    let mut query = world.query_filtered::<(Entity, &C), F>();
    let mut all: Vec<(Entity, &C)> = query.iter(world).collect();
    all.sort_unstable_by_key(|(entity, _)| *entity);
    for (entity, component) in all {
        let bits = entity.to_bits();
        mixer.word(bits as u32);
        mixer.word((bits >> 32) as u32);
        mix(component, mixer);
    }
}

/// By its `Debug` text, in which floats are written so that each has its own.
fn by_text<C: Component + Debug>(world: &mut World, mixer: &mut Mixer) {
    each::<C, ()>(world, mixer, |component, mixer| {
        write!(mixer, "{component:?}").expect("a mixer takes every text");
    });
}

/// The hash of a world's logic: the clock, values, places, agents, memories and ready-made parts, by entity; shots that
/// fly, actions that wait, and who is in which zone.
///
/// Left out are whom a [`Sight`](crate::senses::Sight) sees, where who moves was a step ago, sizes of zones,
/// [`Attention`](crate::Attention), and messages of the step. Where two runs differ in these alone, their hashes differ
/// as soon as something follows from it.
#[must_use]
pub fn state_hash(world: &mut World) -> u64 {
    let mut mixer = Mixer::new();
    if let Some(clock) = world.get_resource::<LogicClock>() {
        mixer.word(clock.step as u32);
    }
    each::<Values, ()>(world, &mut mixer, |values, mixer| {
        for (key, value) in values.sorted() {
            mixer.word(key);
            value.bits().into_iter().for_each(|word| mixer.word(word));
        }
    });
    each::<Transform, With<Logic>>(world, &mut mixer, |transform, mixer| {
        for x in transform.translation.to_array() {
            mixer.word(x.to_bits());
        }
        for x in transform.rotation.to_array() {
            mixer.word(x.to_bits());
        }
    });
    each::<Mind, ()>(world, &mut mixer, |mind, mixer| {
        mind.bits().into_iter().for_each(|word| mixer.word(word));
    });
    each::<Walker, ()>(world, &mut mixer, |walker, mixer| {
        walker.bits().into_iter().for_each(|word| mixer.word(word));
    });
    by_text::<Memory>(world, &mut mixer);
    by_text::<LogicTimer>(world, &mut mixer);
    by_text::<Button>(world, &mut mixer);
    by_text::<Door>(world, &mut mixer);
    by_text::<Lift>(world, &mut mixer);
    by_text::<Health>(world, &mut mixer);
    by_text::<PickUp>(world, &mut mixer);
    by_text::<Objective>(world, &mut mixer);
    by_text::<Mission>(world, &mut mixer);
    by_text::<Lamp>(world, &mut mixer);
    by_text::<DayClock>(world, &mut mixer);
    by_text::<Weapon>(world, &mut mixer);
    if let Some(shots) = world.get_resource::<Shots>() {
        write!(mixer, "{:?}", shots.0).expect("a mixer takes every text");
    }
    if let Some(delayed) = world.get_resource::<DelayedActions>() {
        write!(mixer, "{:?}", delayed.sorted()).expect("a mixer takes every text");
    }
    if let Some(inside) = world.get_resource::<Inside>() {
        write!(mixer, "{inside:?}").expect("a mixer takes every text");
    }
    // The finalizer of MurmurHash3 (A. Appleby, 2011).
    let mut x = mixer.0;
    x = (x ^ x >> 33).wrapping_mul(0xff51_afd7_ed55_8ccd);
    x = (x ^ x >> 33).wrapping_mul(0xc4ce_b9fe_1a85_ec53);
    x ^ x >> 33
}
