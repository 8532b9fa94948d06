//! The passes on a known mesh: each root in one triangle, on it, and none besides.

use std::borrow::Cow;
use std::collections::HashMap;

use bytemuck::{Zeroable, bytes_of, cast_slice};
use dolomite_geometry::layout::GeometryHead;
use dolomite_geometry::vertex::pack;
use dolomite_testkit::gpu::{self, Gpu};
use dolomite_vegetation::Law;
use dolomite_vegetation::density::NO_CLUMPS;
use dolomite_vegetation::place::Lattice;
use dolomite_vegetation::render::edges::{height_at, holds, to_steps};
use dolomite_vegetation::render::layout::{
    ARGUMENT_BYTES, CULL, GrowCounts, GrowParams, LISTS, PIECE_BYTES, RECORD_BYTES,
};
use dolomite_vegetation::render::record::{GrowBound, PASSES, Second, record_passes};
use dolomite_vegetation::render::rings::set_rings;
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{BufferBindingType, BufferUsages, ShaderStages};

use super::support::Random;

/// World position of the anchor, metres: far from the origin.
const ANCHOR: [i64; 2] = [70_000, -31_000];
const PITCH_LOG2: i32 = -3;

/// A mesh over a square about the anchor, whose corners are moved at random, but those of the border.
struct Ground {
    vertices: Vec<bevy::math::Vec3>,
    indices: Vec<u32>,
    /// Depth below the surface at each vertex, as a share of the greatest; none on dry land.
    depths: Vec<f32>,
}

impl Ground {
    fn new(random: &mut Random, cells: u32, half: f32) -> Self {
        let side = cells + 1;
        let step = 2.0 * half / cells as f32;
        let vertices = (0..side * side).map(|k| {
            let at = [k % side, k / side];
            let [x, z] = at.map(|k| {
                // Less than half of a step: no triangle is turned.
                let inner = k > 0 && k < cells;
                let off = if inner {
                    0.45 * (random.unit() as f32 - 0.5)
                } else {
                    0.0
                };
                (k as f32 + off) * step - half
            });
            bevy::math::Vec3::new(x, 6.0 * random.unit() as f32 - 3.0, z)
        });
        let vertices = vertices.collect();
        let mut indices = Vec::new();
        for k in 0..cells * cells {
            let a = k / cells * side + k % cells;
            let [b, c, d] = [a + 1, a + side, a + side + 1];
            // Either diagonal, each way round: culling does not depend on it.
            match random.bits() % 3 {
                0 => indices.extend([a, c, b, b, c, d]),
                1 => indices.extend([a, c, d, a, d, b]),
                _ => indices.extend([a, d, c, a, b, d]),
            }
        }
        Self {
            vertices,
            indices,
            depths: Vec::new(),
        }
    }

    fn triangles(&self) -> impl Iterator<Item = [bevy::math::Vec3; 3]> + '_ {
        self.indices
            .chunks(3)
            .map(|t| [t[0], t[1], t[2]].map(|k| self.vertices[k as usize]))
    }

    /// Head of the work buffer: the last third of the triangles lies in the list of those that are not seen.
    fn head(&self) -> GeometryHead {
        let all = self.indices.len() as u32;
        let seen = all / 9 * 6;
        GeometryHead {
            indexed: [seen, 1, 0, 0, 0],
            others: [all - seen, 1, seen, 0, 0],
            ..GeometryHead::zeroed()
        }
    }
}

/// What came back.
struct Grown {
    counts: GrowCounts,
    arguments: Vec<u32>,
    records: Vec<[u32; 4]>,
}

/// Runs all passes over a ground.
fn grow(gpu: &Gpu, ground: &Ground, params: &GrowParams) -> Grown {
    let device = gpu.device();
    let layout = |types: &[BufferBindingType]| {
        let entries: Vec<_> = (0..)
            .zip(types)
            .map(|(binding, ty)| wgpu::BindGroupLayoutEntry {
                binding,
                visibility: ShaderStages::COMPUTE,
                ty: wgpu::BindingType::Buffer {
                    ty: *ty,
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            })
            .collect();
        device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: None,
            entries: &entries,
        })
    };
    let read = BufferBindingType::Storage { read_only: true };
    let write = BufferBindingType::Storage { read_only: false };
    let shared_layout = layout(&[BufferBindingType::Uniform, read, read, read, write, write]);
    let second_layout = layout(&[write]);
    let pipelines = PASSES.map(|(file, entry, second)| {
        let module = super::support::composed(file, &[]);
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(entry),
            source: wgpu::ShaderSource::Naga(Cow::Owned(module)),
        });
        let groups = [Some(&shared_layout), Some(&second_layout)];
        let count = if second == Second::Nothing { 1 } else { 2 };
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &groups[..count],
            immediate_size: 0,
        });
        device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(entry),
            layout: Some(&layout),
            module: &module,
            entry_point: Some(entry),
            compilation_options: Default::default(),
            cache: None,
        })
    });
    let init = |contents: &[u8], usage| {
        device.create_buffer_init(&BufferInitDescriptor {
            label: None,
            contents,
            usage,
        })
    };
    let empty = |size: u64, usage| {
        device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size,
            usage: usage | BufferUsages::STORAGE | BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        })
    };
    let vertices: Vec<[u32; 5]> = ground
        .vertices
        .iter()
        .zip(ground.depths.iter().chain(std::iter::repeat(&0.0)))
        .map(|(at, depth)| {
            let uv = bevy::math::Vec2::new(*depth, 0.0);
            pack(*at, bevy::math::Vec3::Y, uv, 0)
        })
        .collect();
    let rooms: u32 = params.rooms.iter().sum();
    let buffers = [
        init(bytes_of(params), BufferUsages::UNIFORM),
        init(cast_slice(&vertices), BufferUsages::STORAGE),
        init(cast_slice(&ground.indices), BufferUsages::STORAGE),
        init(bytes_of(&ground.head()), BufferUsages::STORAGE),
        empty(size_of::<GrowCounts>() as u64, BufferUsages::empty()),
        empty(
            u64::from(params.piece_room) * PIECE_BYTES,
            BufferUsages::empty(),
        ),
    ];
    let arguments = empty(ARGUMENT_BYTES, BufferUsages::INDIRECT);
    let records = empty(u64::from(rooms) * RECORD_BYTES, BufferUsages::empty());
    let group = |layout: &wgpu::BindGroupLayout, bound: &[&wgpu::Buffer]| {
        let entries: Vec<_> = (0..)
            .zip(bound)
            .map(|(binding, buffer)| wgpu::BindGroupEntry {
                binding,
                resource: buffer.as_entire_binding(),
            })
            .collect();
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout,
            entries: &entries,
        })
    };
    let bound = GrowBound {
        shared: &group(&shared_layout, &buffers.each_ref()),
        arguments: &group(&second_layout, &[&arguments]),
        records: &group(&second_layout, &[&records]),
        indirect: &arguments,
    };
    let mut encoder = device.create_command_encoder(&Default::default());
    let mut pass = encoder.begin_compute_pass(&Default::default());
    record_passes(&mut pass, pipelines.each_ref(), &bound);
    drop(pass);
    gpu.queue().submit([encoder.finish()]);
    let words = |buffer| -> Vec<u32> {
        bytemuck::pod_collect_to_vec(&gpu.read(buffer).expect("it comes back"))
    };
    let found = words(&records);
    Grown {
        counts: *bytemuck::from_bytes(cast_slice(&words(&buffers[4]))),
        arguments: words(&arguments),
        records: found.chunks(4).map(|r| [r[0], r[1], r[2], r[3]]).collect(),
    }
}

/// Of blades; the other lists are not used.
const VERTICES: [u32; LISTS] = [15, 7, 3, 0, 0, 0, 0, 0];

/// All that stand are drawn, within `reach` of the anchor.
fn params(reach: f32, rooms: [u32; 4]) -> Box<GrowParams> {
    let mut params: Box<GrowParams> = Box::new(GrowParams::zeroed());
    params.eye = [0.3, 1.7, -0.6];
    params.pixels_per_radian = 300.0;
    params.anchor = ANCHOR.map(|x| (x << 12) as i32);
    params.layer_count = 1;
    let [near, middle, far, pieces] = rooms;
    params.rooms = [near, middle, far, 0, 0, 0, 0, 0];
    params.bases = [0, near, near + middle, 0, 0, 0, 0, 0];
    params.vertices = VERTICES;
    params.piece_room = pieces;
    let layer = &mut params.layers[0];
    layer.growth.lattice = Lattice {
        seed: 77,
        pitch_log2: PITCH_LOG2,
    };
    layer.growth.full = 1.0;
    layer.growth.height = [-1e6, 1e6, 1000.0];
    layer.growth.slope = [-1.0, 1e6, 1000.0];
    layer.growth.clump_size = NO_CLUMPS;
    layer.tallest = 0.5;
    // Farther than anything: neither distance thins.
    layer.lods = [48.0, 14.0];
    layer.reach = Law {
        first: 1e4,
        second: 1e4,
        fade: reach,
        reach: 1.01 * reach,
    };
    set_rings(layer, ANCHOR, [0.3, -0.6]);
    params
}

/// x and z of a record, steps, and its height.
fn place_of(record: [u32; 4]) -> ([i32; 2], f32) {
    let x = (record[0] << 8).cast_signed() >> 8;
    let z = (((record[0] >> 24) << 8) | (record[1] << 16)).cast_signed() >> 8;
    ([x, z], f32::from_bits(record[2]))
}

/// Every root within a square about the anchor, in steps relative to it.
fn roots(lattice: Lattice, half: i64) -> Vec<[i32; 2]> {
    let [from, to] = [-half, half]
        .map(|off| dolomite_terrain::GroundPoint::from_fixed(ANCHOR.map(|x| (x + off) << 32)));
    let all = lattice.cells(from, to).map(|cell| {
        let place = lattice.place(lattice.root(cell)).to_fixed();
        [0, 1].map(|axis| ((place[axis] >> 20) - (ANCHOR[axis] << 12)) as i32)
    });
    all.collect()
}

/// Where the ground draws the surface of water, roots stand on the bed, whose depth its vertices carry; where it draws the bed
/// itself (at another height than the sea's) they stand on what is drawn.
#[test]
fn roots_under_water_stand_on_the_bed() {
    let Some(gpu) = gpu::for_test() else { return };
    let mut random = Random(23);
    let mut ground = Ground::new(&mut random, 20, 8.0);
    ground.depths = ground
        .vertices
        .iter()
        .map(|_| 0.1 + 0.2 * random.unit() as f32)
        .collect();
    let mut params = params(60.0, [1 << 15, 1 << 15, 1 << 15, 1 << 14]);
    params.depth_range = 32.0;
    for sea in [0.0, 0.5] {
        // The surface lies at 0.5 m; in the first round the sea does not.
        for vertex in &mut ground.vertices {
            vertex.y = 0.5;
        }
        params.layers[0].above = -sea;
        let grown = grow(&gpu, &ground, &params);
        let bed = |k: u32| {
            let at = ground.vertices[k as usize];
            let stored = (ground.depths[k as usize] * 32767.0 + 0.5).floor() / 32767.0;
            let depth = if sea == 0.5 { 32.0 * stored } else { 0.0 };
            at - depth * bevy::math::Vec3::Y
        };
        let mut count = 0;
        for (lod, records) in grown.counts.records.iter().enumerate() {
            let first = params.bases[lod] as usize;
            for record in &grown.records[first..first + *records as usize] {
                let (place, height) = place_of(*record);
                let [x, z] = place.map(|k| f64::from(k) / 4096.0);
                let below = ground
                    .indices
                    .chunks(3)
                    .map(|t| [t[0], t[1], t[2]].map(bed));
                let holding = below
                    .into_iter()
                    .find(|t| holds(t.map(|p| to_steps(bevy::math::Vec2::new(p.x, p.z))), place));
                let expected = height_at(holding.expect("one").map(|p| p.as_dvec3()), x, z);
                // A slope of up to 10 over a step of the place, and f32.
                assert!(
                    (expected - f64::from(height)).abs() < 5e-3,
                    "{expected} {height}"
                );
                count += 1;
            }
        }
        assert!(count > 10_000, "{count}");
    }
}

#[test]
fn each_root_of_a_mesh_is_in_one_triangle_and_on_it() {
    let Some(gpu) = gpu::for_test() else { return };
    let mut random = Random(21);
    let ground = Ground::new(&mut random, 60, 20.0);
    let params = params(60.0, [1 << 17, 1 << 17, 1 << 17, 1 << 16]);
    assert_eq!(params.layers[0].ring_count, 1);
    let grown = grow(&gpu, &ground, &params);
    assert!(grown.counts.wanted_pieces <= params.piece_room);
    let rooms = params.rooms;
    let mut found: HashMap<[i32; 2], Vec<f32>> = HashMap::new();
    for (lod, count) in grown.counts.records.iter().enumerate() {
        assert!(*count <= rooms[lod]);
        assert_eq!(
            grown.arguments[12 + 4 * lod..16 + 4 * lod],
            [VERTICES[lod], *count, 0, 0]
        );
        let first = params.bases[lod] as usize;
        for record in &grown.records[first..first + *count as usize] {
            let (place, height) = place_of(*record);
            found.entry(place).or_default().push(height);
        }
    }
    // Triangles by the tiles of their boxes.
    let mut near: HashMap<[i32; 2], Vec<[bevy::math::Vec3; 3]>> = HashMap::new();
    for t in ground.triangles() {
        let low = t[0].min(t[1]).min(t[2]);
        let high = t[0].max(t[1]).max(t[2]);
        for x in (low.x.floor() as i32)..=(high.x.floor() as i32) {
            for z in (low.z.floor() as i32)..=(high.z.floor() as i32) {
                near.entry([x, z]).or_default().push(t);
            }
        }
    }
    let lattice = params.layers[0].growth.lattice;
    let (mut count, mut worst) = (0, 0.0_f64);
    for place in roots(lattice, 21) {
        let [x, z] = place.map(|k| f64::from(k) / 4096.0);
        let tile = place.map(|k| k >> 12);
        let none = Vec::new();
        let holding: Vec<_> = near
            .get(&tile)
            .unwrap_or(&none)
            .iter()
            .filter(|t| holds(t.map(|p| to_steps(bevy::math::Vec2::new(p.x, p.z))), place))
            .collect();
        let heights = found.remove(&place).unwrap_or_default();
        assert_eq!(heights.len(), holding.len(), "{place:?}");
        assert!(holding.len() <= 1, "{place:?} is in two triangles");
        if let [t] = holding[..] {
            let height = height_at(t.map(|p| p.as_dvec3()), x, z);
            worst = worst.max((height - f64::from(heights[0])).abs());
            count += 1;
        } else {
            assert!(
                x.abs().max(z.abs()) >= 20.0 - 1e-3,
                "{place:?} is on no triangle"
            );
        }
    }
    assert!(found.is_empty(), "{} records of no root", found.len());
    assert!(count > 100_000, "{count}");
    println!(
        "{count} roots, each in one triangle; farthest from it {:.4} mm",
        1e3 * worst
    );
    // Corners are rounded to 2^-13 m: a slope of 20 makes 2.4 mm of it, one of 4, the most of nearly all, 0.5 mm.
    assert!(worst < 1e-3, "{worst}");
}

#[test]
fn rings_look_at_each_root_that_may_be_drawn_and_at_few_others() {
    let Some(gpu) = gpu::for_test() else { return };
    let mut random = Random(5);
    // Two triangles as large as all, and small ones beside them.
    let ground = Ground::new(&mut random, 1, 256.0);
    let mut params = params(250.0, [1 << 16, 1 << 16, 1 << 19, 1 << 16]);
    let layer = &mut params.layers[0];
    layer.growth.slope = [-1.0, 1e6, 1000.0];
    layer.reach = Law {
        first: 6.0,
        second: 40.0,
        fade: 200.0,
        reach: 250.0,
    };
    set_rings(layer, ANCHOR, [0.3, -0.6]);
    assert!(params.layers[0].ring_count > 2);
    let grown = grow(&gpu, &ground, &params);
    assert!(
        grown.counts.wanted_pieces <= params.piece_room,
        "{}",
        grown.counts.wanted_pieces
    );
    assert_eq!(grown.counts.cut, 1.0, "all have room");
    // By the law, on every root.
    let layer = &params.layers[0];
    let lattice = layer.growth.lattice;
    let [ex, _, ez] = params.eye.map(f64::from);
    let mut sum = [0_u64; 3];
    let triangles: Vec<_> = ground.triangles().collect();
    for x in -256_i64..256 {
        for z in -256_i64..256 {
            let corner = |x: i64, z: i64| {
                dolomite_terrain::GroundPoint::from_fixed([
                    (ANCHOR[0] + x) << 32,
                    (ANCHOR[1] + z) << 32,
                ])
            };
            let last = dolomite_terrain::GroundPoint::from_fixed(
                corner(x + 1, z + 1).to_fixed().map(|k| k - 1),
            );
            for cell in lattice.cells(corner(x, z), last) {
                let root = lattice.root(cell);
                let place = lattice.place(root).to_fixed();
                let at = [0, 1].map(|axis| ((place[axis] >> 20) - (ANCHOR[axis] << 12)) as i32);
                let [px, pz] = at.map(|k| f64::from(k) / 4096.0);
                let holding = triangles
                    .iter()
                    .find(|t| holds(t.map(|p| to_steps(bevy::math::Vec2::new(p.x, p.z))), at));
                let Some(t) = holding else { continue };
                let height = height_at(t.map(|p| p.as_dvec3()), px, pz);
                let [dx, dy, dz] = [px - ex, height - f64::from(params.eye[1]), pz - ez];
                let d = (dx * dx + dy * dy + dz * dz).sqrt();
                let fade = ((d - 200.0) / 50.0).clamp(0.0, 1.0);
                let left = 1.0 - fade * fade * (3.0 - 2.0 * fade);
                // The whole of the band is drawn: a quarter of the ranks.
                let kept = (6.0 / d).min(1.0) * (40.0 / d).min(1.0) / 0.75;
                let kept = (kept * (0.25 + 0.75 * left)).min(1.0) * f64::from(u8::from(d < 250.0));
                let rank = f64::from(root.rank) / f64::from(1 << 24);
                // A root within a rounding of its threshold may be decided either way.
                sum[0] += u64::from(rank < kept * (1.0 - 1e-5));
                sum[1] += u64::from(rank < kept * (1.0 + 1e-5));
                sum[2] += 1;
            }
        }
    }
    let drawn: u64 = grown
        .counts
        .records
        .iter()
        .map(|count| u64::from(*count))
        .sum();
    println!(
        "{drawn} drawn of {} within 250 m; {} looked at",
        sum[2], grown.counts.looked
    );
    assert!(
        drawn >= sum[0] && drawn <= sum[1],
        "{drawn} not within {sum:?}"
    );
    // Squares of the diagonal's tiles are looked at twice, those of a ring in proportion to its own area: some three for
    // each that is drawn.
    assert!(
        u64::from(grown.counts.looked) < sum[2] / 16,
        "{}",
        grown.counts.looked
    );
}

#[test]
fn a_pool_that_is_too_small_thins_by_rank() {
    let Some(gpu) = gpu::for_test() else { return };
    let mut random = Random(8);
    let ground = Ground::new(&mut random, 12, 10.0);
    // A kilobyte for each level.
    let params = params(60.0, [64, 64, 64, 1 << 14]);
    let grown = grow(&gpu, &ground, &params);
    let GrowCounts {
        cut,
        wanted,
        records,
        ..
    } = grown.counts;
    assert!(
        wanted > 20_000 && cut < 0.01,
        "{wanted} wanted, cut at {cut}"
    );
    assert!(records.iter().all(|count| *count <= 64), "{records:?}");
    assert!(records.iter().any(|count| *count > 8), "{records:?}");
    // What is left are those of the least ranks.
    let lattice = params.layers[0].growth.lattice;
    let mut ranks: HashMap<[i32; 2], u32> = HashMap::new();
    let [from, to] = [-11, 11]
        .map(|off| dolomite_terrain::GroundPoint::from_fixed(ANCHOR.map(|x| (x + off) << 32)));
    for cell in lattice.cells(from, to) {
        let root = lattice.root(cell);
        let place = lattice.place(root).to_fixed();
        let at = [0, 1].map(|axis| ((place[axis] >> 20) - (ANCHOR[axis] << 12)) as i32);
        ranks.insert(at, root.rank);
    }
    for (lod, count) in records.iter().enumerate() {
        let first = params.bases[lod] as usize;
        for record in &grown.records[first..first + *count as usize] {
            let rank = ranks[&place_of(*record).0];
            assert!(rank as f32 <= cut * (1 << 24) as f32, "{rank}");
        }
    }
}

#[test]
fn nothing_is_recorded_of_what_is_outside() {
    let Some(gpu) = gpu::for_test() else { return };
    let mut random = Random(8);
    let ground = Ground::new(&mut random, 12, 10.0);
    let mut params = params(60.0, [1 << 16, 1 << 16, 1 << 16, 1 << 14]);
    // All lies on the outer side of the first plane.
    params.planes[0] = [1.0, 0.0, 0.0, -30.0];
    let all = grow(&gpu, &ground, &params);
    params.flags = CULL;
    let none = grow(&gpu, &ground, &params);
    assert!(all.counts.wanted > 20_000);
    assert_eq!(
        (none.counts.wanted, none.counts.pieces, none.counts.records),
        (0, 0, [0; LISTS])
    );
}
