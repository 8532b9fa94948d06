//! The sky in the picture: lights, cameras, stars and moon, kept up to date with [`SeenSky`].
//!
//! Nothing exists until the world has a [`Sky`] on a camera and a [`Sun`]: no image, no pipeline, no
//! patch. By day there are three cube maps (0.9 MB by default) that all cameras share; stars and
//! moon are patches of `dolomite_tessellation`, which are spawned as they come out, on a dome about
//! each camera.

mod cube;
mod dome;
mod dress;
mod light;
mod maps;
mod moon;
mod night;
mod star_mesh;
mod stars;
mod store;
mod tell;

use bevy::prelude::*;
use dolomite_tessellation::render::PatchPlugin;

#[doc(hidden)]
pub use dome::Dome;
pub use dress::DrawnSky;
#[doc(hidden)]
pub use moon::Moon;
#[doc(hidden)]
pub use stars::Star;

use crate::components::{Sky, Sun};
use crate::seen::SeenSky;
use crate::sets::SkySystems;
use store::MapStore;

/// Something of a camera's sky that stars and moon depend on has changed.
type NightChanged = (
    With<DrawnSky>,
    Or<(Changed<SeenSky>, Changed<DrawnSky>, Changed<Msaa>)>,
);

/// Adds the render half.
pub(crate) fn build(app: &mut App) {
    app.init_resource::<MapStore>()
        .add_plugins((PatchPlugin(Star::default()), PatchPlugin(Moon::default())))
        .add_systems(
            PostUpdate,
            (
                (
                    tell::tell.run_if(any_with_component::<Sky>.or_else(any_with_component::<Sun>)),
                    light::light.run_if(any_with_component::<Sun>),
                    dress::dress
                        .run_if(resource_exists::<Assets<Image>>)
                        .run_if(any_with_component::<SeenSky>.or_else(maps_are_kept)),
                )
                    .in_set(SkySystems::Light),
                (
                    (night::show::<stars::Star>, night::show::<moon::Moon>)
                        .chain()
                        .run_if(
                            any_match_filter::<NightChanged>
                                .or_else(any_component_removed::<SeenSky>),
                        ),
                    dome::follow.run_if(any_with_component::<Dome>),
                )
                    .chain()
                    .in_set(SkySystems::Night),
            ),
        )
        .add_observer(dress::undress)
        .add_observer(night::unstage);
}

fn maps_are_kept(store: Res<MapStore>) -> bool {
    !store.is_empty()
}
