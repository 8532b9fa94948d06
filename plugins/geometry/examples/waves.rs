//! Waves that a compute shader makes, lit and shadowed as Bevy's meshes are, in an app with nothing of
//! Dolomite but the geometry: `cargo run --release -p dolomite_geometry --example waves`.

use bevy::core_pipeline::Core3d;
use bevy::prelude::*;
use bevy::render::render_resource::binding_types::{storage_buffer_sized, uniform_buffer_sized};
use bevy::render::render_resource::*;
use bevy::render::renderer::{RenderContext, RenderDevice, RenderQueue, ViewQuery};
use bevy::render::{Render, RenderApp};
use dolomite_geometry::render::*;
use dolomite_geometry::{GeometryCamera, GeometryPlugin};

/// Squares along a side, as in the shader.
const SIDE: u32 = 256;

/// The pass that makes them.
pub const WAVES: &str = "
#import dolomite::geometry::head::{INDEXED, PRIMITIVES, VERTICES}
#import dolomite::geometry::vertex::{VERTEX_WORDS, pack_normal}
@group(0) @binding(0) var<storage, read_write> vertices: array<u32>;
@group(0) @binding(1) var<storage, read_write> indices: array<u32>;
@group(0) @binding(2) var<storage, read_write> head: array<u32>;
// World position that vertices are counted from; seconds.
@group(0) @binding(3) var<uniform> anchor: vec4<f32>;
const SIDE: u32 = 256u;
@compute @workgroup_size(8, 8)
fn waves(@builtin(global_invocation_id) id: vec3<u32>) {
    if max(id.x, id.y) > SIDE { return; }
    let at = (vec2<f32>(id.xy) / f32(SIDE) - 0.5) * 12.0;
    let far = max(length(at), 1e-3);
    let phase = 4.0 * far - 3.0 * anchor.w;
    let fall = 0.35 / (1.0 + far);
    let slope = at / far * 4.0 * fall * cos(phase);
    let place = bitcast<vec3<u32>>(vec3(at.x, fall * sin(phase), at.y) - anchor.xyz);
    let number = id.y * (SIDE + 1u) + id.x;
    let word = number * VERTEX_WORDS;
    vertices[word] = place.x;
    vertices[word + 1u] = place.y;
    vertices[word + 2u] = place.z;
    vertices[word + 3u] = pack_normal(normalize(vec3(-slope.x, 1.0, -slope.y)), 0u);
    vertices[word + 4u] = 0u;
    if max(id.x, id.y) < SIDE {
        let first = 6u * (id.y * SIDE + id.x);
        let corners = array(0u, SIDE + 1u, 1u, 1u, SIDE + 1u, SIDE + 2u);
        for (var k = 0u; k < 6u; k++) { indices[first + k] = number + corners[k]; }
    }
    if number == 0u {
        head[INDEXED] = 6u * SIDE * SIDE;
        head[INDEXED + 1u] = 1u;
        head[PRIMITIVES] = 2u * SIDE * SIDE;
        head[VERTICES] = (SIDE + 1u) * (SIDE + 1u);
    }
}
";

/// Makes the triangles.
pub struct WavesPlugin;

struct Waves;

#[derive(Resource)]
struct Pass {
    shader: Handle<Shader>,
    layout: BindGroupLayoutDescriptor,
    id: Option<CachedComputePipelineId>,
}

impl Plugin for WavesPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins(GeometryPlugin);
    }

    fn finish(&self, app: &mut App) {
        build_render(app);
        ModuleShaders::load(app);
        let mut assets = app.world_mut().resource_mut::<Assets<Shader>>();
        let shader = assets.add(shader_asset(WAVES, "waves.wgsl"));
        let draw = shader_asset(DrawShader::source(None, None, None), "waves_draw.wgsl");
        let draw = DrawShader {
            handle: assets.add(draw),
            defs: vec![],
        };
        let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
            return;
        };
        let nothing = BindGroupLayoutDescriptor::new("waves", &[]);
        let mut producer = Producer::new("waves", DrawTraits::default(), draw, nothing);
        producer.materials = vec![GeometryMaterial {
            base_color: LinearRgba::rgb(0.02, 0.12, 0.18),
            roughness: 0.25,
            ..default()
        }];
        let write = || storage_buffer_sized(false, None);
        let anchor = uniform_buffer_sized(false, None);
        let entries = (write(), write(), write(), anchor);
        let entries = BindGroupLayoutEntries::sequential(ShaderStages::COMPUTE, entries);
        let layout = BindGroupLayoutDescriptor::new("waves", &entries);
        let world = render_app.world_mut();
        world
            .resource_mut::<Producers>()
            .insert(ProducerKey::of::<Waves>(), producer);
        render_app
            .insert_resource(Pass {
                shader,
                layout,
                id: None,
            })
            .add_systems(Render, want.in_set(GeometrySystems::Want))
            .add_systems(Core3d, make.in_set(GeometrySystems::Make));
    }
}

/// In every camera that sees what producers make, with room for all.
fn want(
    mut producers: ResMut<Producers>,
    mut pass: ResMut<Pass>,
    cameras: Query<Entity, With<ExtractedGeometryCamera>>,
    cache: Res<PipelineCache>,
    device: Res<RenderDevice>,
) {
    let Some(waves) = producers.get_mut(ProducerKey::of::<Waves>()) else {
        return;
    };
    let pool = GeometryPool {
        vertices: (SIDE + 1) * (SIDE + 1),
        primitives: 2 * SIDE * SIDE,
    };
    waves.wanted = cameras.iter().map(|camera| (camera, pool)).collect();
    waves.bind_no_data(&device, &cache);
    if pass.id.is_none() && !waves.wanted.is_empty() {
        pass.id = Some(cache.queue_compute_pipeline(ComputePipelineDescriptor {
            layout: vec![pass.layout.clone()],
            shader: pass.shader.clone(),
            entry_point: Some("waves".into()),
            ..default()
        }));
    }
}

/// The triangles of a view in this frame.
fn make(
    view: ViewQuery<Entity, With<ExtractedGeometryCamera>>,
    mut producers: ResMut<Producers>,
    pass: Res<Pass>,
    cache: Res<PipelineCache>,
    queue: Res<RenderQueue>,
    mut ctx: RenderContext,
) {
    let view = view.into_inner();
    let waves = producers.get_mut(ProducerKey::of::<Waves>());
    let state = waves.and_then(|waves| waves.views.get_mut(&view));
    let pipeline = pass.id.and_then(|id| cache.get_compute_pipeline(id));
    let (Some(state), Some(pipeline)) = (state, pipeline) else {
        return;
    };
    let device = ctx.render_device().clone();
    let anchor = state.frame.anchor.as_vec3().extend(state.frame.time[0]);
    let uniform = device.create_buffer(&BufferDescriptor {
        label: None,
        size: 16,
        usage: BufferUsages::UNIFORM | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    queue.write_buffer(&uniform, 0, bytemuck::bytes_of(&anchor.to_array()));
    let group = device.create_bind_group(
        "waves",
        &cache.get_bind_group_layout(&pass.layout),
        &BindGroupEntries::sequential((
            state.vertices.as_entire_binding(),
            state.indices.as_entire_binding(),
            state.work.as_entire_binding(),
            uniform.as_entire_binding(),
        )),
    );
    let encoder = ctx.command_encoder();
    let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor::default());
    pass.set_pipeline(pipeline);
    pass.set_bind_group(0, &*group, &[]);
    pass.dispatch_workgroups(SIDE.div_ceil(8) + 1, SIDE.div_ceil(8) + 1, 1);
    drop(pass);
    state.filled = true;
    state.counters.want();
}

fn main() -> AppExit {
    App::new()
        .add_plugins((DefaultPlugins, WavesPlugin))
        .add_systems(Startup, setup)
        .run()
}

/// A camera, a sun, and the waves with a ball in them.
pub fn setup(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    // A mesh of Bevy's: it stands in the waves, and casts its shadow on them.
    let ball = meshes.add(Sphere::new(0.7));
    let red = materials.add(Color::srgb(0.8, 0.2, 0.1));
    commands.spawn((
        Mesh3d(ball),
        MeshMaterial3d(red),
        Transform::from_xyz(1.0, 0.4, 0.5),
    ));
    let sun = DirectionalLight {
        shadow_maps_enabled: true,
        ..default()
    };
    commands.spawn((
        sun,
        Transform::default().looking_to(Vec3::new(-1.0, -1.2, -1.0), Vec3::Y),
    ));
    let eye = Transform::from_xyz(0.0, 3.2, 6.0).looking_at(Vec3::ZERO, Vec3::Y);
    commands.spawn((
        Camera3d::default(),
        Msaa::Off,
        GeometryCamera::default(),
        eye,
    ));
}
