//! A frame of the ground: its triangles into a G-buffer, by the draws' own shader, and light on them.

use super::ways::Way;
use crate::scenes::camera::Camera;
use crate::scenes::selection::{ground_of, params};
use bevy::image::Image;
use bevy::math::{DVec2, DVec3, Mat4, Quat, UVec2, Vec2, Vec3};
use bevy::render::render_resource::encase::UniformBuffer;
use bytemuck::{Pod, Zeroable, bytes_of, cast_slice, pod_collect_to_vec};
use dolomite_geometry::layout::{GeometryDraw, MATERIAL_ROWS, MaterialRow, VERTEX_BYTES};
use dolomite_geometry::vertex::pack;
use dolomite_ground::detail::Metric;
use dolomite_ground::render::GroundLook;
use dolomite_shaders::ShaderFile;
use dolomite_terrain::Terrain;
use dolomite_testkit::blocks::{BlockError, BlockStage};
use dolomite_testkit::gpu::{Gpu, GpuError};
use std::borrow::Cow;
use std::time::{Duration, Instant};
use wgpu::util::{BufferInitDescriptor, DeviceExt, TextureDataOrder};
use wgpu::{
    BindGroup, BindGroupLayout, BindGroupLayoutEntry, BindingType, Buffer, BufferBindingType,
    BufferUsages, Extent3d, RenderPipeline, ShaderStages, TextureFormat, TextureSampleType,
    TextureUsages, TextureView, TextureViewDimension, VertexAttribute, VertexFormat,
};

/// What Bevy's deferred prepass writes where no other prepass is on.
const TARGETS: [TextureFormat; 2] = [TextureFormat::Rgba32Uint, TextureFormat::R8Uint];

/// The files that the draws take beside ours.
const FILES: [ShaderFile; 4] = [
    file(
        "lab/utils.wgsl",
        include_str!("../tessellation_stage/functions/gbuffer_normal.wgsl"),
    ),
    file(
        "lab/rgb9e5.wgsl",
        include_str!("../tessellation_stage/functions/gbuffer_colour.wgsl"),
    ),
    file(
        "lab/pbr_deferred_types.wgsl",
        include_str!("../tessellation_stage/functions/gbuffer_words.wgsl"),
    ),
    file("geometry/user_material.wgsl", include_str!("surface.wgsl")),
];

const fn file(path: &'static str, source: &'static str) -> ShaderFile {
    ShaderFile { path, source }
}

/// Byte for byte as `Light` in `light.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Light {
    clip_to_anchor: [[f32; 4]; 4],
    camera: [f32; 3],
    samples: u32,
    towards: [f32; 3],
    exposure: f32,
    sun: [f32; 3],
    haze: f32,
    sky: [f32; 3],
    pad: u32,
    shift: u32,
    pad_b: u32,
    size: [u32; 2],
}

/// What does not depend on ground or view.
pub struct Renderer<'a> {
    gpu: &'a Gpu,
    nothing: BindGroupLayout,
    given: BindGroupLayout,
    view: BindGroupLayout,
    light: wgpu::ComputePipeline,
    arrays: [(TextureView, wgpu::Sampler); 2],
    materials: Buffer,
}

/// A G-buffer.
pub struct Targets {
    colours: Vec<TextureView>,
    depth: TextureView,
    /// Pixels across and down.
    pub size: UVec2,
}

impl Targets {
    /// Of so many pixels.
    #[must_use]
    pub fn new(gpu: &Gpu, size: UVec2) -> Self {
        Self {
            colours: TARGETS.map(|format| target(gpu, size, format)).to_vec(),
            depth: target(gpu, size, TextureFormat::Depth32Float),
            size,
        }
    }
}

/// The triangles of a view, and how they look.
pub struct Scene {
    vertices: Buffer,
    indices: Buffer,
    triangles: u32,
    anchor: DVec3,
    look: Buffer,
    given: BindGroup,
    numbers: [[f32; 4]; 4],
}

/// Where `GroundLook` holds by how much blends are narrowed: `deep.w`.
const NARROWING: u64 = 16 + 2 * 16 + 12;

/// The light of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Daylight {
    /// The sun, half way up.
    Day,
    /// The full moon: the same, far less of it, and an exposure for it.
    Night,
}

fn texture_entry(binding: u32, view_dimension: TextureViewDimension) -> BindGroupLayoutEntry {
    BindGroupLayoutEntry {
        binding,
        visibility: ShaderStages::FRAGMENT,
        ty: BindingType::Texture {
            sample_type: TextureSampleType::Float { filterable: true },
            view_dimension,
            multisampled: false,
        },
        count: None,
    }
}

fn entry(binding: u32, visibility: ShaderStages, ty: BindingType) -> BindGroupLayoutEntry {
    BindGroupLayoutEntry {
        binding,
        visibility,
        ty,
        count: None,
    }
}

fn uniform(binding: u32, visibility: ShaderStages) -> BindGroupLayoutEntry {
    let ty = BindingType::Buffer {
        ty: BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    entry(binding, visibility, ty)
}

fn sampler(binding: u32) -> BindGroupLayoutEntry {
    let ty = BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
    entry(binding, ShaderStages::FRAGMENT, ty)
}

impl<'a> Renderer<'a> {
    /// With both texture arrays of the ground.
    #[must_use]
    pub fn new(gpu: &'a Gpu, arrays: [&Image; 2]) -> Self {
        let device = gpu.device();
        let layout = |entries: &[BindGroupLayoutEntry]| {
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: None,
                entries,
            })
        };
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("light"),
            source: wgpu::ShaderSource::Wgsl(include_str!("light.wgsl").into()),
        });
        let light = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("light"),
            layout: None,
            module: &module,
            entry_point: Some("main"),
            compilation_options: Default::default(),
            cache: None,
        });
        let rows = [MaterialRow::default(); MATERIAL_ROWS];
        Self {
            gpu,
            nothing: layout(&[]),
            given: layout(&[
                texture_entry(3, TextureViewDimension::D2Array),
                texture_entry(4, TextureViewDimension::D2Array),
                sampler(5),
                texture_entry(6, TextureViewDimension::D2),
                sampler(7),
                uniform(8, ShaderStages::FRAGMENT),
            ]),
            view: layout(&[0, 1].map(|k| uniform(k, ShaderStages::VERTEX_FRAGMENT))),
            light,
            arrays: arrays.map(|image| upload(gpu, image)),
            materials: filled(gpu, cast_slice(&rows), BufferUsages::UNIFORM),
        }
    }

    /// The pipeline of a way of shading.
    ///
    /// # Errors
    /// If its shader is wrong, or the adapter refuses it.
    pub fn pipeline(&self, way: &Way, sea: bool) -> Result<RenderPipeline, BlockError> {
        let device = self.gpu.device();
        let mut defs = vec!["GBUFFER"];
        defs.extend(way.defs);
        if !sea {
            defs.push("GROUND_WITHOUT_SEA");
        }
        let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
        let module = dolomite_shaders::compose_with("geometry/draw.wgsl", &defs, &FILES)?;
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(way.name),
            source: wgpu::ShaderSource::Naga(Cow::Owned(module)),
        });
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("ground"),
            bind_group_layouts: &[Some(&self.nothing), Some(&self.given), Some(&self.view)],
            immediate_size: 0,
        });
        let attribute = |format, offset, shader_location| VertexAttribute {
            format,
            offset,
            shader_location,
        };
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(way.name),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vertex"),
                compilation_options: Default::default(),
                buffers: &[wgpu::VertexBufferLayout {
                    array_stride: VERTEX_BYTES,
                    step_mode: wgpu::VertexStepMode::Vertex,
                    attributes: &[
                        attribute(VertexFormat::Float32x3, 0, 0),
                        attribute(VertexFormat::Uint32, 12, 1),
                        attribute(VertexFormat::Snorm16x2, 16, 2),
                    ],
                }],
            },
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("fragment"),
                compilation_options: Default::default(),
                targets: &[None, None, Some(TARGETS[0].into()), Some(TARGETS[1].into())],
            }),
            primitive: wgpu::PrimitiveState {
                cull_mode: Some(wgpu::Face::Back),
                ..Default::default()
            },
            depth_stencil: Some(wgpu::DepthStencilState {
                format: TextureFormat::Depth32Float,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::GreaterEqual),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: Default::default(),
            multiview_mask: None,
            cache: None,
        });
        match bevy::tasks::block_on(scope.pop()) {
            Some(error) => Err(GpuError::Validation(error.to_string()).into()),
            None => Ok(pipeline),
        }
    }

    /// The ground's triangles for a camera within `pixels` of error, with its look and its relief map.
    ///
    /// # Errors
    /// [`BlockError`].
    ///
    /// # Panics
    /// If what the camera asks for is not made after a thousand choices of 64 blocks each.
    pub fn scene(
        &self,
        terrain: &Terrain,
        camera: &Camera,
        pixels: f32,
        look: &GroundLook,
        relief: &Image,
    ) -> Result<Scene, BlockError> {
        let ground = ground_of(terrain, 0.25);
        let metric = Metric::ErrorBound { pixels };
        let mut stage = BlockStage::new(self.gpu, &ground, 1 << 12)?;
        let told = params(&ground, camera, metric, [1 << 18, 1 << 19]);
        let (run, _) = stage.settle_in_room(told, 64, 1000)?;
        let xz = DVec2::new(told.view.anchor[0].into(), told.view.anchor[1].into());
        let anchor = DVec3::new(xz.x, told.anchor_height.into(), xz.y);
        let range = told.depth_range;
        let sea = terrain.sea_level();
        let vertices = run.positions.iter().flat_map(|&[x, y, z]| {
            let ground = terrain.sample_f64(xz + DVec2::new(x.into(), z.into()));
            let gradient = ground.gradient.as_vec2();
            let normal = Vec3::new(-gradient.x, 1.0, -gradient.y).normalize();
            let depth = sea.map_or(-range, |sea| sea - ground.height as f32);
            let uv = Vec2::new(depth.clamp(-range, range) / range, 0.0);
            pack(Vec3::new(x, y, z), normal, uv, 0)
        });
        let vertices: Vec<u32> = vertices.collect();
        let numbers = look.numbers(xz, terrain.extent().min);
        let mut bytes = UniformBuffer::new(Vec::<u8>::new());
        bytes
            .write(look)
            .expect("a vector takes everything that is written");
        let look = filled(
            self.gpu,
            &bytes.into_inner(),
            BufferUsages::UNIFORM | BufferUsages::COPY_DST,
        );
        let (relief, relief_sampler) = upload(self.gpu, relief);
        let [(albedo, textures), (normal, _)] = &self.arrays;
        let bound = [
            wgpu::BindingResource::TextureView(albedo),
            wgpu::BindingResource::TextureView(normal),
            wgpu::BindingResource::Sampler(textures),
            wgpu::BindingResource::TextureView(&relief),
            wgpu::BindingResource::Sampler(&relief_sampler),
            look.as_entire_binding(),
        ];
        Ok(Scene {
            vertices: filled(self.gpu, cast_slice(&vertices), BufferUsages::VERTEX),
            indices: filled(self.gpu, cast_slice(&run.triangles), BufferUsages::INDEX),
            triangles: run.triangles.len() as u32,
            anchor,
            given: group(self.gpu, &self.given, (3..).zip(bound)),
            look,
            numbers: numbers.map(|four| four.to_array()),
        })
    }

    /// Draws a way's view into a G-buffer, moved to the left by so many of its pixels; gives the time of that.
    ///
    /// # Errors
    /// [`BlockError`].
    pub fn draw(
        &self,
        targets: &Targets,
        scene: &Scene,
        (way, pipeline): (&Way, &RenderPipeline),
        (camera, shift): (&Camera, f32),
    ) -> Result<Duration, BlockError> {
        let clip_from_anchor = clip_from_anchor(scene, camera, shift / targets.size.x as f32);
        self.gpu
            .queue()
            .write_buffer(&scene.look, NARROWING, bytes_of(&way.narrowing));
        let mut draw = GeometryDraw::zeroed();
        draw.clip_from_anchor = clip_from_anchor.to_cols_array_2d();
        draw.previous_clip_from_anchor = draw.clip_from_anchor;
        draw.camera = (camera.eye - scene.anchor).as_vec3().to_array();
        draw.anchor = scene.anchor.as_vec3().to_array();
        draw.uv_range = 32.0;
        draw.viewport = targets.size.as_vec2().to_array();
        draw.numbers = scene.numbers;
        let draw = filled(self.gpu, bytes_of(&draw), BufferUsages::UNIFORM);
        let bound = [draw.as_entire_binding(), self.materials.as_entire_binding()];
        let view = group(self.gpu, &self.view, (0..).zip(bound));
        let nothing = group(self.gpu, &self.nothing, []);
        let device = self.gpu.device();
        let mut encoder = device.create_command_encoder(&Default::default());
        let clear = |view| wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                store: wgpu::StoreOp::Store,
            },
        };
        // As Bevy lays them out: normals and motion first, which are off.
        let mut colours = vec![None, None];
        colours.extend(targets.colours.iter().map(|view| Some(clear(view))));
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: None,
            color_attachments: &colours,
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &targets.depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0.0),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        });
        pass.set_pipeline(pipeline);
        for (index, group) in [&nothing, &scene.given, &view].into_iter().enumerate() {
            pass.set_bind_group(index as u32, group, &[]);
        }
        pass.set_vertex_buffer(0, scene.vertices.slice(..));
        pass.set_index_buffer(scene.indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..3 * scene.triangles, 0, 0..1);
        drop(pass);
        let start = Instant::now();
        self.gpu.queue().submit([encoder.finish()]);
        self.gpu.finish()?;
        Ok(start.elapsed())
    }

    /// The picture that a G-buffer holds, of a block of samples a pixel, moved to the right by some: linear, as a
    /// display shows it.
    ///
    /// # Errors
    /// [`BlockError`].
    pub fn lit(
        &self,
        targets: &Targets,
        scene: &Scene,
        (camera, moved): (&Camera, f32),
        (samples, shift): (u32, u32),
        daylight: Daylight,
    ) -> Result<Vec<[f32; 4]>, BlockError> {
        let device = self.gpu.device();
        let size = targets.size / samples;
        let out = device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: u64::from(size.element_product()) * 16,
            usage: BufferUsages::STORAGE | BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let clip = clip_from_anchor(scene, camera, moved / targets.size.x as f32);
        let bright = match daylight {
            Daylight::Day => 1.0,
            Daylight::Night => 0.15,
        };
        let light = Light {
            clip_to_anchor: clip.inverse().to_cols_array_2d(),
            camera: (camera.eye - scene.anchor).as_vec3().to_array(),
            samples,
            towards: Vec3::new(0.62, 0.5, 0.45).normalize().to_array(),
            exposure: 1.0,
            sun: [5.2 * bright, 4.7 * bright, 4.0 * bright],
            haze: 3.0e-5,
            sky: [0.9 * bright, 1.2 * bright, 1.7 * bright],
            pad: 0,
            shift,
            pad_b: 0,
            size: size.to_array(),
        };
        let light = filled(self.gpu, bytes_of(&light), BufferUsages::UNIFORM);
        let bound = [
            light.as_entire_binding(),
            wgpu::BindingResource::TextureView(&targets.colours[0]),
            wgpu::BindingResource::TextureView(&targets.depth),
            out.as_entire_binding(),
        ];
        let layout = self.light.get_bind_group_layout(0);
        let bound = group(self.gpu, &layout, (0..).zip(bound));
        let mut encoder = device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&self.light);
        pass.set_bind_group(0, &bound, &[]);
        pass.dispatch_workgroups(size.x.div_ceil(8), size.y.div_ceil(8), 1);
        drop(pass);
        self.gpu.queue().submit([encoder.finish()]);
        self.gpu.finish()?;
        Ok(pod_collect_to_vec(&self.gpu.read(&out)?))
    }
}

/// From the anchor's space to clip space, moved to the left by a part of the picture.
fn clip_from_anchor(scene: &Scene, camera: &Camera, moved: f32) -> Mat4 {
    let turn =
        Quat::from_rotation_y(camera.yaw as f32) * Quat::from_rotation_x(camera.pitch as f32);
    let eye = (camera.eye - scene.anchor).as_vec3();
    let size = camera.size.as_vec2();
    let lens = Mat4::perspective_infinite_reverse_rh(
        camera.fov_y as f32,
        size.x / size.y,
        camera.near as f32,
    );
    // Clip space is two units wide, and x is divided by w: a translation of what has been divided.
    let moved = Mat4::from_translation(Vec3::new(-2.0 * moved, 0.0, 0.0));
    moved * lens * Mat4::from_rotation_translation(turn, eye).inverse()
}

fn filled(gpu: &Gpu, contents: &[u8], usage: BufferUsages) -> Buffer {
    gpu.device().create_buffer_init(&BufferInitDescriptor {
        label: None,
        contents,
        usage,
    })
}

fn group<'a>(
    gpu: &Gpu,
    layout: &BindGroupLayout,
    bound: impl IntoIterator<Item = (u32, wgpu::BindingResource<'a>)>,
) -> BindGroup {
    let entries = bound
        .into_iter()
        .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource });
    let entries: Vec<_> = entries.collect();
    gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout,
        entries: &entries,
    })
}

/// An image with its sampler: repeated where it says so, filtered as a software device filters.
fn upload(gpu: &Gpu, image: &Image) -> (TextureView, wgpu::Sampler) {
    let descriptor = wgpu::TextureDescriptor {
        usage: TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST,
        label: None,
        view_formats: &[],
        ..image.texture_descriptor
    };
    let texels = image.data.as_deref().unwrap_or_default();
    let device = gpu.device();
    let order = TextureDataOrder::LayerMajor;
    let texture = device.create_texture_with_data(gpu.queue(), &descriptor, order, texels);
    let array = image.texture_descriptor.size.depth_or_array_layers > 1;
    let view = texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: array.then_some(TextureViewDimension::D2Array),
        ..Default::default()
    });
    let address = if array {
        wgpu::AddressMode::Repeat
    } else {
        wgpu::AddressMode::ClampToEdge
    };
    let linear = wgpu::FilterMode::Linear;
    let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
        address_mode_u: address,
        address_mode_v: address,
        mag_filter: linear,
        min_filter: linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        // As the plugin chooses it.
        anisotropy_clamp: if array && !gpu.software { 8 } else { 1 },
        ..Default::default()
    });
    (view, sampler)
}

fn target(gpu: &Gpu, size: UVec2, format: TextureFormat) -> TextureView {
    let texture = gpu.device().create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: Extent3d {
            width: size.x,
            height: size.y,
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: TextureUsages::RENDER_ATTACHMENT
            | TextureUsages::TEXTURE_BINDING
            | TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    texture.create_view(&Default::default())
}
