//! The plugin that takes a kind, and what it adds to an app that renders.

use std::any::TypeId;

use bevy::asset::LoadState;
use bevy::prelude::*;
use bevy::render::{Extract, ExtractSchedule, Render, RenderApp};
use dolomite_geometry::GeometryPlugin;
use dolomite_geometry::render::{
    GeometryShared, GeometrySystems, Producer, ProducerKey, Producers, build_render,
};

use super::kind::{PatchKind, PatchPool};
use super::variants::{self, KindVariants, stage_variants};
use super::{extract, host, pass, pipeline, prepare};

/// Adds a kind of patches to an app: `app.add_plugins(PatchPlugin(kind))`.
///
/// Brings the stage itself along, once. May be added before or after Bevy's plugins, and more than once: the
/// resource of the last time counts. Does nothing but keep the resource in an app that does not render.
pub struct PatchPlugin<K>(pub K);

impl<K: PatchKind> Plugin for PatchPlugin<K> {
    fn build(&self, app: &mut App) {
        app.add_plugins(GeometryPlugin);
        app.insert_resource(self.0.clone());
        let list = (
            core::any::type_name::<K>(),
            stage_variants::<K> as fn() -> _,
        );
        let mut known = app.world_mut().get_resource_or_init::<KindVariants>();
        if !known.0.iter().any(|(name, _)| *name == list.0) {
            known.0.push(list);
        }
    }

    fn finish(&self, app: &mut App) {
        add_kind::<K>(app);
    }

    fn is_unique(&self) -> bool {
        false
    }
}

/// Adds a kind to an app that renders, when all plugins have been built; does nothing to one that does not,
/// or that has the kind already.
fn add_kind<K: PatchKind>(app: &mut App) {
    build_render(app);
    let key = ProducerKey::of::<K>();
    let known = |app: &App| {
        let producers = app
            .get_sub_app(RenderApp)?
            .world()
            .get_resource::<Producers>()?;
        Some(producers.get(key).is_some())
    };
    if known(app) != Some(false) {
        return;
    }
    let name = core::any::type_name::<K>();
    let Some(shaders) = pipeline::KindShaders::new::<K>(app, name) else {
        return;
    };
    if let Some(file) = shaders.user.clone() {
        let watch =
            move |server: Res<AssetServer>, shared: Res<GeometryShared>, mut told: Local<bool>| {
                let Some(LoadState::Failed(fault)) = server.get_load_state(&file) else {
                    *told = false;
                    return;
                };
                if !*told {
                    *told = true;
                    error!("{name}: its shader cannot be loaded: {fault}");
                    shared.report(name, fault.to_string());
                }
            };
        app.add_systems(PreUpdate, watch);
    }
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    build_stage(render_app);
    let traits = variants::draw_traits::<K>();
    let producer = Producer::new(name, traits, shaders.draw.clone(), pipeline::given_layout());
    let kind = prepare::Kind {
        name,
        key,
        layout: K::LAYOUT,
        tessellator: variants::tessellator::<K>(),
        animated: K::ANIMATED,
        traits,
        shaders,
        pool: PatchPool::default(),
        host: None,
        instances: Vec::new(),
        instances_changed: false,
        seen_by: Default::default(),
        other_layout: 0,
        version: 0,
        data_due: true,
        pipelines: None,
        buffers: None,
        views: Default::default(),
    };
    let world = render_app.world_mut();
    world.resource_mut::<Producers>().insert(key, producer);
    world
        .resource_mut::<prepare::StageKinds>()
        .0
        .insert(TypeId::of::<K>(), kind);
    render_app
        .add_systems(
            ExtractSchedule,
            (extract::kind::<K>, extract_settings::<K>).run_if(extract::is_in_use::<K>),
        )
        .add_systems(
            Render,
            prepare::data::<K>
                .run_if(prepare::has_entities::<K>)
                .in_set(GeometrySystems::Want)
                .before(prepare::buffers),
        );
}

/// The user's resource, when it changed.
fn extract_settings<K: PatchKind>(mut commands: Commands, settings: Extract<Option<Res<K>>>) {
    if let Some(settings) = settings.as_ref().filter(|settings| settings.is_changed()) {
        commands.insert_resource(prepare::ExtractedKind((**settings).clone()));
    }
}

/// What all kinds share, once.
fn build_stage(render_app: &mut SubApp) {
    if render_app
        .world()
        .contains_resource::<prepare::StageKinds>()
    {
        return;
    }
    use bevy::core_pipeline::Core3d;
    render_app
        .init_resource::<prepare::StageKinds>()
        .add_systems(
            Render,
            (
                prepare::buffers.in_set(GeometrySystems::Want),
                (prepare::views, host::tessellate)
                    .chain()
                    .in_set(GeometrySystems::Prepare),
                pass::bind_groups.in_set(GeometrySystems::Bind),
            ),
        )
        .add_systems(Core3d, pass::tessellate.in_set(GeometrySystems::Make));
}
