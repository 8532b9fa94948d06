//! What the classic scene looks like: patches that light themselves, straight into the picture. No
//! G-buffer, no shadows, no sky, nothing after: it is there to time the triangles.

use bevy::camera::{CompositingSpace, RenderTarget};
use bevy::core_pipeline::prepass::{DeferredPrepass, DepthPrepass};
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::prelude::*;
use dolomite::ground::detail::TerrainLod;
use dolomite::terrain::GroundProbe;
use dolomite::tessellation::GeometryCamera;
use dolomite_classic::ClassicHeights;
use dolomite_classic::render::{ClassicPlugin, ClassicSettings};

use super::methods::Methods;
use crate::input::PlayerInput;
use crate::play::Switches;
use crate::play::camera::{CameraSystems, FreeCamera};
use crate::settings::Settings;
use crate::view::UiCamera;
use crate::view::panel::PanelRows;
use crate::view::{Dress, DressSystems, OffscreenTarget};

/// Vertical field of view of the scene's definition, degrees.
pub const FIELD_OF_VIEW: f32 = 60.0;

/// Distances that the camera sees, metres; `far` bounds culling only.
const NEAR: f32 = 0.1;
const FAR: f32 = 10_000.0;

/// Draws the classic scene. Expects the resource [`Methods`], and [`OffscreenTarget`] where there is
/// no window.
pub struct ClassicViewPlugin {
    /// The surface.
    pub heights: ClassicHeights,
}

impl Plugin for ClassicViewPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Methods>();
        let settings = app.world().resource::<Methods>().settings();
        app.insert_resource(ClearColor(Color::srgb(0.62, 0.74, 0.86)))
            .add_plugins(ClassicPlugin {
                heights: self.heights.clone(),
                settings,
            })
            .init_resource::<PanelRows>()
            .add_systems(Dress, dress_camera.in_set(DressSystems::Scene))
            .add_systems(
                Update,
                (
                    switch
                        .run_if(|input: Res<PlayerInput>| input.switch_mode || input.switch_metric),
                    (
                        follow.after(CameraSystems),
                        tell.run_if(resource_changed::<Methods>),
                    ),
                )
                    .chain(),
            );
    }
}

fn dress_camera(
    mut commands: Commands,
    target: Option<Res<OffscreenTarget>>,
    cameras: Query<(Entity, &FreeCamera)>,
) {
    for (entity, camera) in &cameras {
        let mut entity = commands.entity(entity);
        entity
            .insert((
                Camera3d::default(),
                Projection::Perspective(PerspectiveProjection {
                    fov: camera.fov.to_radians(),
                    near: NEAR,
                    far: FAR,
                    ..default()
                }),
                Msaa::Off,
                Tonemapping::None,
                // Encoded at the vertices, not at each store of a pixel.
                CompositingSpace::Srgb,
                GeometryCamera::default(),
                // The ground under the eye, in each frame.
                GroundProbe::default(),
                UiCamera,
            ))
            // Without a G-buffer patches are drawn into the picture.
            .remove::<(DepthPrepass, DeferredPrepass)>();
        if let Some(target) = &target {
            entity.insert(RenderTarget::Image(target.0.clone().into()));
        }
    }
}

/// Takes the next way to make the triangles, or the next rule.
fn switch(input: Res<PlayerInput>, mut methods: ResMut<Methods>) {
    if input.switch_mode {
        methods.mode = methods.mode.next();
    }
    if input.switch_metric {
        methods.metric = methods.metric.next();
        // What one rule aims at is nothing to the next.
        methods.tau = None;
    }
}

/// Says in the panel how the triangles are made.
fn tell(methods: Res<Methods>, mut rows: ResMut<PanelRows>) {
    rows.0 = vec![
        ("made by", methods.mode.name().to_owned()),
        ("rule", methods.metric.name().to_owned()),
    ];
}

/// Hands switches, settings and methods to the tessellation, written only where they differ.
fn follow(
    switches: Res<Switches>,
    settings: Res<Settings>,
    methods: Res<Methods>,
    mut classic: ResMut<ClassicSettings>,
    mut cameras: Query<(Entity, &mut GeometryCamera, Option<&mut TerrainLod>)>,
    mut commands: Commands,
) {
    classic.set_if_neq(methods.settings());
    for (entity, mut camera, detail) in &mut cameras {
        match (methods.detail(), detail) {
            (Some(wanted), Some(mut detail)) => {
                detail.set_if_neq(wanted);
            }
            (Some(wanted), None) => {
                commands.entity(entity).insert(wanted);
            }
            (None, Some(_)) => {
                commands.entity(entity).remove::<TerrainLod>();
            }
            (None, None) => {}
        }
        let next = GeometryCamera {
            pixels_per_edge: methods.tau.unwrap_or(settings.pixels_per_edge),
            fill: switches.fill,
            lines: switches.lines,
            ..camera.clone()
        };
        camera.set_if_neq(next);
    }
}
