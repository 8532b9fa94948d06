//! The plugin, and the system that needs no renderer.

use std::sync::Arc;

use bevy::prelude::*;

use crate::bend::{Presses, PressesGrass, gather};
use crate::components::{Vegetation, VegetationRanks, VegetationState, VegetationView};
use crate::sets::VegetationSystems;
use crate::wind::Wind;

/// Life on the ground. May be added before Bevy's plugins or after them, with a renderer or without; added again it
/// does nothing.
pub struct VegetationPlugin;

#[derive(Resource)]
struct Added;

impl Plugin for VegetationPlugin {
    fn build(&self, app: &mut App) {
        if app.world().contains_resource::<Added>() {
            return;
        }
        app.insert_resource(Added)
            .init_resource::<Presses>()
            .register_type::<PressesGrass>()
            .register_type::<Vegetation>()
            .register_type::<VegetationView>()
            .register_type::<VegetationRanks>()
            .register_type::<Wind>()
            .configure_sets(
                PostUpdate,
                (VegetationSystems::Check, VegetationSystems::Place)
                    .chain()
                    .before(bevy::transform::TransformSystems::Propagate),
            )
            .add_systems(
                PostUpdate,
                (check, gather)
                    .in_set(VegetationSystems::Check)
                    .run_if(any_with_component::<Vegetation>),
            );
        #[cfg(feature = "render")]
        crate::render::build(app);
    }

    #[cfg(feature = "render")]
    fn finish(&self, app: &mut App) {
        crate::render::finish(app);
    }

    fn is_unique(&self) -> bool {
        false
    }
}

/// Takes over lists of kinds that are new and good.
fn check(mut changed: Query<(&Vegetation, &mut VegetationState), Changed<Vegetation>>) {
    for (vegetation, mut state) in &mut changed {
        if state
            .kinds
            .as_ref()
            .is_some_and(|known| Arc::ptr_eq(known, &vegetation.kinds))
        {
            if state.fault.is_some() {
                state.fault = None;
            }
            continue;
        }
        match (*vegetation.kinds).clone().checked() {
            Ok(_) => {
                state.kinds = Some(Arc::clone(&vegetation.kinds));
                state.fault = None;
            }
            Err(fault) => state.fault = Some(fault),
        }
    }
}
