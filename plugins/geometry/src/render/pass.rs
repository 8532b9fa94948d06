//! Bind groups of the draws, and the draws of each view.

use bevy::camera::{MainPassResolutionOverride, Viewport};
use bevy::core_pipeline::prepass::ViewPrepassTextures;
use bevy::pbr::ShadowView;
use bevy::prelude::*;
use bevy::render::camera::ExtractedCamera;
use bevy::render::diagnostic::RecordDiagnostics;
use bevy::render::render_phase::TrackedRenderPass;
use bevy::render::render_resource::{
    BindGroupEntry, BindingResource, Buffer, BufferBinding, PipelineCache, RenderPassDescriptor,
    RenderPipeline, StoreOp,
};
use bevy::render::renderer::{RenderContext, RenderDevice, ViewQuery};
use bevy::render::view::{ViewDepthTexture, ViewTarget};

use super::extract::ExtractedGeometryCamera;
use super::once::Surfaces;
use super::pipeline::{DrawKey, DrawPipelines, DrawStep, Drawn};
use super::producer::{Producer, Producers};
use super::record::{DrawCall, DrawSource, record_covering, record_draw};
use super::shared::GeometryShared;
use super::traits::DrawTraits;
use super::view::{DrawGroups, GeometryView};
use crate::layout::{GeometryDraw, OTHERS_ARGUMENTS};

/// Pipelines and bind groups that are missing.
pub fn bind(
    mut producers: ResMut<Producers>,
    views: Query<(Option<&ViewPrepassTextures>, &ViewTarget)>,
    cache: Res<PipelineCache>,
    device: Res<RenderDevice>,
    shared: Res<GeometryShared>,
) {
    for producer in producers.iter_mut() {
        let Producer {
            name,
            traits,
            shader,
            inputs_layout,
            data_layout: Some(data_layout),
            data: Some(_),
            views: states,
            material_rows: Some(materials),
            draws,
            fault,
            told,
            ..
        } = producer
        else {
            continue;
        };
        let of = Drawn {
            name,
            shader,
            traits,
        };
        let draws = draws
            .get_or_insert_with(|| DrawPipelines::new(&of, inputs_layout, data_layout, &cache));
        let fault = fault.clone().or_else(|| draws.fault(&cache));
        if let Some(fault) = fault {
            if !*told {
                *told = true;
                error!("{name}: its shader is not used until it is corrected: {fault}");
                shared.report(name, fault);
            }
        } else if *told {
            *told = false;
            shared.clear(name);
        }
        for (entity, state) in states.iter_mut() {
            if let Ok((prepass, target)) = views.get(*entity) {
                let key = DrawKey::new(prepass, target, state.shown[1]);
                for step in key.steps(traits) {
                    draws.draw(&of, &cache, key.in_step(*step));
                }
            }
            if state.inputs.is_none() && inputs_layout.entries.is_empty() {
                let layout = cache.get_bind_group_layout(inputs_layout);
                let nothing = device.create_bind_group("geometry_nothing", &layout, &[]);
                state.inputs = Some(nothing);
            }
            let fetched = traits.fetches(state.shown[1]);
            let known = state.groups.as_ref();
            if known.is_none_or(|groups| groups.fetch.is_none() && fetched) {
                state.groups = Some(groups(state, draws, materials, fetched, &cache, &device));
            }
        }
    }
}

fn groups(
    state: &GeometryView,
    draws: &DrawPipelines,
    materials: &Buffer,
    fetched: bool,
    cache: &PipelineCache,
    device: &RenderDevice,
) -> DrawGroups {
    let slot = BindingResource::Buffer(BufferBinding {
        buffer: &state.draw,
        offset: 0,
        size: (size_of::<GeometryDraw>() as u64).try_into().ok(),
    });
    let mut bound = vec![slot, materials.as_entire_binding()];
    let group = |layout, bound: &[BindingResource]| {
        let entries: Vec<_> = (0..)
            .zip(bound)
            .map(|(binding, resource)| BindGroupEntry {
                binding,
                resource: resource.clone(),
            })
            .collect();
        let layout = cache.get_bind_group_layout(layout);
        device.create_bind_group("geometry_draw", &layout, &entries)
    };
    let draw = group(&draws.draw_layout, &bound);
    let pools = [
        Some(&state.vertices),
        Some(&state.indices),
        state.previous.as_ref(),
    ];
    let pools = pools.into_iter().flatten();
    bound.extend(pools.map(|buffer| buffer.as_entire_binding()));
    DrawGroups {
        draw,
        fetch: fetched.then(|| group(&draws.fetch_layout, &bound)),
    }
}

/// Copies the counters of what was made.
pub fn read_counters(
    view: ViewQuery<Entity, With<ExtractedGeometryCamera>>,
    mut producers: ResMut<Producers>,
    device: Res<RenderDevice>,
    mut ctx: RenderContext,
) {
    let entity = view.into_inner();
    for producer in producers.iter_mut() {
        if let Some(state) = producer.views.get_mut(&entity) {
            let (counters, work) = (&mut state.counters, &state.work);
            if counters.is_wanted() {
                counters.copy(&device, ctx.command_encoder(), work);
            }
        }
    }
}

/// The draw of a producer in a view.
fn call<'a>(
    producer: &'a Producer,
    state: &'a GeometryView,
    pipeline: &'a RenderPipeline,
    lines: bool,
    slot: u32,
) -> Option<DrawCall<'a>> {
    let groups = state.groups.as_ref()?;
    let source = source(&producer.traits, lines);
    let view = match source {
        DrawSource::Indexed => &groups.draw,
        _ => groups.fetch.as_ref()?,
    };
    Some(DrawCall {
        pipeline,
        groups: [state.inputs.as_ref()?, producer.data.as_ref()?, view],
        slot: Some(slot),
        pools: state.pools(),
        source,
    })
}

fn source(traits: &DrawTraits, lines: bool) -> DrawSource {
    if traits.amplified > 0 {
        DrawSource::Amplified
    } else if traits.fetches(lines) {
        DrawSource::Plain
    } else {
        DrawSource::Indexed
    }
}

/// The draws of all producers that have something to show in a view in one of the steps, and whose pipelines are there:
/// those of all its steps.
pub fn ready<'a>(
    producers: &'a Producers,
    view: Entity,
    cache: &'a PipelineCache,
    key: impl Fn(bool) -> DrawKey,
    step: DrawStep,
) -> Vec<DrawCall<'a>> {
    let calls = producers.iter().filter_map(|producer| {
        let state = producer.views.get(&view).filter(|state| state.is_shown())?;
        let lines = state.shown[1];
        let key = key(lines);
        let steps = key.steps(&producer.traits);
        let draws = producer.draws.as_ref()?;
        let pipeline = |step| cache.get_render_pipeline(draws.known(key.in_step(step))?);
        if !steps.contains(&step) || steps.iter().any(|step| pipeline(*step).is_none()) {
            return None;
        }
        call(producer, state, pipeline(step)?, lines, 0)
    });
    calls.collect()
}

/// The part of its target that a camera draws into.
pub fn viewport(
    camera: &ExtractedCamera,
    resolution: Option<&MainPassResolutionOverride>,
) -> Option<Viewport> {
    Viewport::from_viewport_and_override(camera.viewport.as_ref(), resolution)
}

/// Records draws into a part of the target.
pub fn draw_calls(
    pass: &mut TrackedRenderPass<'_>,
    viewport: Option<&Viewport>,
    calls: &[DrawCall<'_>],
) {
    if let Some(viewport) = viewport {
        pass.set_camera_viewport(viewport);
    }
    for call in calls {
        record_draw(pass.wgpu_pass(), call, None);
    }
}

type DeferredView<'a> = (
    Entity,
    &'a ExtractedCamera,
    Option<&'a MainPassResolutionOverride>,
    &'a ViewPrepassTextures,
    &'a ViewTarget,
    &'a ViewDepthTexture,
);

/// The primitives of every producer into the G-buffer and the depth buffer.
pub fn draw_gbuffer(
    view: ViewQuery<DeferredView, With<ExtractedGeometryCamera>>,
    (producers, surfaces): (Res<Producers>, Res<Surfaces>),
    cache: Res<PipelineCache>,
    mut ctx: RenderContext,
) {
    let (entity, camera, resolution, prepass, target, depth) = view.into_inner();
    let (Some(deferred), Some(pass_id)) = (&prepass.deferred, &prepass.deferred_lighting_pass_id)
    else {
        return;
    };
    let key = |lines| DrawKey::new(Some(prepass), target, lines);
    let [kept, shaded, whole] = [DrawStep::Surfaces, DrawStep::Once, DrawStep::Whole]
        .map(|step| ready(&producers, entity, &cache, key, step));
    let surfaces = surfaces.of(entity).filter(|_| !kept.is_empty());
    if surfaces.is_none() && whole.is_empty() {
        return;
    }
    let viewport = viewport(camera, resolution);
    let recorder = ctx.diagnostic_recorder();
    let recorder = recorder.as_deref();
    // Of both passes: what budgets and panels know as the time of the draws.
    let whole_span = recorder.time_span(ctx.command_encoder(), "geometry_gbuffer");
    if let Some((target, _)) = &surfaces {
        let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
            label: Some("geometry_surfaces"),
            color_attachments: &[Some(target.clone())],
            depth_stencil_attachment: Some(depth.get_attachment(StoreOp::Store)),
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        });
        let span = recorder.pass_span(&mut pass, "surfaces");
        draw_calls(&mut pass, viewport.as_ref(), &kept);
        span.end(&mut pass);
    }
    let attachments = [
        prepass
            .normal
            .as_ref()
            .map(|texture| texture.get_attachment()),
        prepass
            .motion_vectors
            .as_ref()
            .map(|texture| texture.get_attachment()),
        Some(deferred.get_attachment()),
        Some(pass_id.get_attachment()),
    ];
    let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
        label: Some("geometry_gbuffer"),
        color_attachments: &attachments,
        depth_stencil_attachment: Some(depth.get_attachment(StoreOp::Store)),
        timestamp_writes: None,
        occlusion_query_set: None,
        multiview_mask: None,
    });
    let span = recorder.pass_span(&mut pass, "shaded");
    if let Some((_, group)) = surfaces {
        if let Some(viewport) = &viewport {
            pass.set_camera_viewport(viewport);
        }
        for call in &shaded {
            record_covering(pass.wgpu_pass(), call, group);
        }
    }
    draw_calls(&mut pass, viewport.as_ref(), &whole);
    span.end(&mut pass);
    drop(pass);
    whole_span.end(ctx.command_encoder());
}

/// The same primitives into the shadow maps of the view's lights.
pub fn draw_shadows(
    view: ViewQuery<Entity, With<ExtractedGeometryCamera>>,
    producers: Res<Producers>,
    shadow_views: Query<&ShadowView>,
    cache: Res<PipelineCache>,
    mut ctx: RenderContext,
) {
    let entity = view.into_inner();
    // All producers of a light in one pass: the lights have the same slots in each.
    let states = || {
        producers.iter().filter_map(|producer| {
            let state = producer
                .views
                .get(&entity)
                .filter(|state| state.is_shown())?;
            let id = producer.draws.as_ref()?.shadow?;
            Some((producer, state, cache.get_render_pipeline(id)?))
        })
    };
    let lights = states().map(|(_, state, _)| &state.shadows);
    let Some(lights) = lights.max_by_key(|shadows| shadows.len()) else {
        return;
    };
    for slot in lights {
        let Ok(shadow) = shadow_views.get(slot.light) else {
            continue;
        };
        let recorder = ctx.diagnostic_recorder();
        let recorder = recorder.as_deref();
        let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
            label: Some("geometry_shadow"),
            color_attachments: &[],
            depth_stencil_attachment: Some(shadow.depth_attachment.get_attachment(StoreOp::Store)),
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        });
        let span = recorder.pass_span(&mut pass, "geometry_shadow");
        for (producer, state, pipeline) in states() {
            let Some(call) = call(producer, state, pipeline, false, slot.offset) else {
                continue;
            };
            match &state.ranges {
                Some(ranges) => {
                    let mut draws = ranges.draws(slot.number(), state.looked_at);
                    let places: &mut dyn Iterator<Item = u64> = &mut draws;
                    record_draw(pass.wgpu_pass(), &call, Some((&ranges.arguments, places)));
                }
                None => {
                    record_draw(pass.wgpu_pass(), &call, None);
                    if producer.traits.others {
                        // What faces away from the camera, or lies beside its picture.
                        pass.wgpu_pass()
                            .draw_indexed_indirect(&state.work, OTHERS_ARGUMENTS);
                    }
                }
            }
        }
        span.end(&mut pass);
    }
}
