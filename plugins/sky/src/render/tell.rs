//! What is said, once, where an app asks for what there is not.

use bevy::prelude::*;

use crate::components::{Sky, Sun, the_sun};

/// Frames that a sky may wait for its sun before it is missed.
const PATIENCE: u32 = 30;

/// What has been said.
#[derive(Default)]
pub(super) struct Told {
    many: bool,
    nowhere: bool,
    none: bool,
    waited: u32,
}

/// Warns of several suns, of one that is nowhere, and of a sky without any.
pub(super) fn tell(
    suns: Query<(Entity, &Sun)>,
    skies: Query<(), With<Sky>>,
    mut told: Local<Told>,
) {
    let first = the_sun(suns.iter());
    if let Some((first, _)) = first
        && suns.iter().len() > 1
        && !std::mem::replace(&mut told.many, true)
    {
        let others: Vec<Entity> = suns
            .iter()
            .map(|(entity, _)| entity)
            .filter(|entity| *entity != first)
            .collect();
        warn!("the sky is lit by one sun, {first}; {others:?} light the ground alone");
    }
    if let Some((entity, sun)) = suns.iter().find(|(_, sun)| sun.towards().is_none())
        && !std::mem::replace(&mut told.nowhere, true)
    {
        warn!("{sun:?} of {entity} is no place: it is passed over, and all stays as it was");
    }
    if first.is_some() || skies.is_empty() {
        told.waited = 0;
    } else {
        told.waited = told.waited.saturating_add(1);
        if told.waited == PATIENCE && !std::mem::replace(&mut told.none, true) {
            warn!("a camera has a Sky, but no entity has a Sun: nothing is seen in it");
        }
    }
}
