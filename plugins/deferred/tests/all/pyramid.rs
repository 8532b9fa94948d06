//! The depth pyramid, in Rust and on the adapter, against every pixel that a box covers, in f64.

use std::ops::Range;

use bevy::math::{Mat4, UVec2};
use dolomite_deferred::pyramid::{Footprint, Pyramid, level, levels, texels};
use dolomite_shaders::{ShaderFile, compose, compose_with};
use dolomite_testkit::gpu::{self, Binding, Gpu, Kernel};
use dolomite_testkit::random::Random;

/// Metres.
const NEAR: f64 = 0.1;

/// Depths with walls, sky, and gaps of a pixel that can be looked through: what a pyramid of the wrong size loses.
fn depths(random: &mut Random, size: UVec2) -> Vec<f32> {
    let mut depths = vec![0.0_f32; (size.x * size.y) as usize];
    if random.unit_f32() < 0.5 {
        depths.fill(random.range(0.001, 0.02));
    }
    let span = |random: &mut Random, size: u32| {
        let ends = [(); 2].map(|()| random.range(-0.3, 1.3) * size as f32);
        let [low, high] = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        (low.max(0.0) as u32)..(high.max(0.0) as u32).min(size)
    };
    for _ in 0..random.range(1.0, 6.0) as usize {
        let depth = random.range(0.0, 0.2);
        let (columns, rows) = (span(random, size.x), span(random, size.y));
        for row in rows {
            for column in columns.clone() {
                let at = &mut depths[(row * size.x + column) as usize];
                *at = at.max(depth);
            }
        }
    }
    for _ in 0..random.range(0.0, 3.0) as usize {
        let last = random.unit_f32() < 0.5;
        let mut pick = |size: u32| {
            let any = (random.unit_f32() * size as f32) as u32;
            if last { size - 1 } else { any.min(size - 1) }
        };
        let (x, y) = (pick(size.x), pick(size.y));
        depths[(y * size.x + x) as usize] = 0.0;
    }
    depths
}

/// Low and high corner, in view space.
type Cuboid = [[f32; 3]; 2];

fn boxes(random: &mut Random, size: UVec2, count: usize) -> Vec<Cuboid> {
    let aspect = size.x as f32 / size.y as f32;
    let exponential =
        |random: &mut Random, base: f32| bevy::math::ops::powf(base, random.unit_f32());
    let mut boxes = Vec::with_capacity(count);
    for _ in 0..count {
        let distance = 0.2 * exponential(random, 1000.0);
        let reach = distance * 0.5 * exponential(random, 0.002);
        let middle = [
            random.range(-1.1, 1.1) * distance * aspect,
            random.range(-1.1, 1.1) * distance,
            -distance,
        ];
        let low = middle.map(|m| m - reach * random.unit_f32());
        let high = low.map(|l| l + 2.0 * reach * random.unit_f32());
        boxes.push([low, high]);
    }
    boxes
}

/// The half angle's tangent is 1.
fn projection(size: UVec2) -> Mat4 {
    let aspect = size.x as f32 / size.y as f32;
    Mat4::perspective_infinite_reverse_rh(std::f32::consts::FRAC_PI_2, aspect, NEAR as f32)
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Truth {
    Seen,
    Hidden,
    /// No pixel of the view.
    Outside,
}

/// Looks at every pixel that the box may cover, in f64.
fn truth(cuboid: &Cuboid, depths: &[f32], size: UVec2) -> Truth {
    let mut rectangle = [f64::MAX, f64::MAX, f64::MIN, f64::MIN];
    let mut nearest = 0.0_f64;
    let aspect = f64::from(size.x) / f64::from(size.y);
    for k in 0..8 {
        let at = |axis: usize| f64::from(cuboid[(k >> axis) & 1][axis]);
        let distance = -at(2);
        if distance < NEAR {
            return Truth::Seen;
        }
        let place = [
            (0.5 + 0.5 * at(0) / (distance * aspect)) * f64::from(size.x),
            (0.5 - 0.5 * at(1) / distance) * f64::from(size.y),
        ];
        for axis in 0..2 {
            rectangle[axis] = rectangle[axis].min(place[axis]);
            rectangle[axis + 2] = rectangle[axis + 2].max(place[axis]);
        }
        nearest = nearest.max(NEAR / distance);
    }
    let span = |axis: usize, size: u32| -> Range<u32> {
        let first = (rectangle[axis].floor().max(0.0) as u32).min(size);
        first..((rectangle[axis + 2].floor() + 1.0).max(0.0) as u32).min(size)
    };
    let (columns, rows) = (span(0, size.x), span(1, size.y));
    if columns.is_empty() || rows.is_empty() {
        return Truth::Outside;
    }
    for y in rows {
        for x in columns.clone() {
            if f64::from(depths[(y * size.x + x) as usize]) <= nearest {
                return Truth::Seen;
            }
        }
    }
    Truth::Hidden
}

/// Boxes of each sort.
#[derive(Clone, Copy, Debug, Default)]
struct Counts {
    boxes: usize,
    hidden: usize,
    /// Of these, those that were told.
    told: usize,
    /// Seen, and told to be hidden.
    wrong: usize,
}

impl Counts {
    fn add(&mut self, truth: Truth, told: bool) {
        self.boxes += 1;
        match truth {
            Truth::Hidden => {
                self.hidden += 1;
                self.told += usize::from(told);
            }
            Truth::Seen => self.wrong += usize::from(told),
            Truth::Outside => {}
        }
    }
}

/// Every size from 1 to 257 as a width and as a height, and some larger ones; `DOLOMITE_SIZES` asks for more of these.
fn sizes(random: &mut Random) -> Vec<UVec2> {
    let mut sizes = Vec::new();
    for k in 1..=257_u32 {
        let other = 1 + (random.unit_f32() * 256.0) as u32;
        sizes.extend([UVec2::new(k, other), UVec2::new(other, k)]);
    }
    let larger = std::env::var("DOLOMITE_SIZES").map_or(6, |n| n.parse().expect("a number"));
    for _ in 0..larger {
        let mut side = || 1 + bevy::math::ops::exp2(random.range(6.0, 10.5)) as u32;
        sizes.push(UVec2::new(side(), side()));
    }
    sizes
}

/// Boxes a size; `DOLOMITE_BOXES` asks for more.
fn count() -> usize {
    std::env::var("DOLOMITE_BOXES").map_or(60, |n| n.parse().expect("a number"))
}

#[test]
fn nothing_that_can_be_seen_is_hidden_at_any_size() {
    let mut random = Random::new(11);
    let mut counts = Counts::default();
    for size in sizes(&mut random) {
        let depths = depths(&mut random, size);
        let pyramid = Pyramid::new(&depths, size).expect("a view");
        let clip = projection(size);
        for cuboid in boxes(&mut random, size, count()) {
            let footprint = Footprint::of_box(cuboid[0].into(), cuboid[1].into(), clip, size);
            counts.add(truth(&cuboid, &depths, size), pyramid.hides(&footprint));
        }
    }
    eprintln!("{counts:?}");
    assert_eq!(counts.wrong, 0);
    assert!(
        counts.hidden > 2000 && counts.told * 10 >= counts.hidden * 8,
        "{counts:?}"
    );
}

/// Asks the functions of the pyramid about boxes.
const ASK: &str = "
#import dolomite::deferred::pyramid::{footprint_of, level, level_of}

struct Question { clip: mat4x4<f32>, size: vec2<u32>, boxes: u32, first: u32 }
@group(0) @binding(0) var<uniform> question: Question;
@group(0) @binding(1) var<storage, read> texels: array<f32>;
@group(0) @binding(2) var<storage, read> boxes: array<f32>;
@group(0) @binding(3) var<storage, read_write> hidden: array<u32>;

@compute @workgroup_size(64)
fn ask(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= question.boxes { return; }
    let at = id.x * 6u;
    let low = vec3(boxes[at], boxes[at + 1u], boxes[at + 2u]);
    let high = vec3(boxes[at + 3u], boxes[at + 4u], boxes[at + 5u]);
    let footprint = footprint_of(low, high, question.clip, question.size);
    if footprint.cut { hidden[id.x] = 0u; return; }
    let index = level_of(footprint);
    let found = level(question.size, index);
    var farthest = 1e30;
    for (var k = 0u; k < 4u; k++) {
        let x = select(footprint.low.x, footprint.high.x, (k & 1u) != 0u) >> index;
        let y = select(footprint.low.y, footprint.high.y, (k & 2u) != 0u) >> index;
        farthest = min(farthest, texels[question.first + found.first + y * found.size.x + x]);
    }
    hidden[id.x] = u32(footprint.nearest < farthest);
}
";

/// The levels above `depths`, made on the adapter; depths and levels one after the other.
fn build(gpu: &Gpu, kernel: &Kernel, depths: &[f32], size: UVec2) -> Vec<f32> {
    let all = depths.len() + texels(size) as usize;
    // A sentinel, so that what is not written is seen.
    let mut words = vec![-1.0_f32; all];
    words[..depths.len()].copy_from_slice(depths);
    let mut bytes = bytemuck::cast_slice(&words).to_vec();
    let base = depths.len() as u32;
    let (mut made, mut below, mut source) = (0, size, 0);
    while made < levels(size) {
        let next = level(size, made + 1);
        let count = 4.min(levels(size) - made);
        let task: [u32; 8] = [below.x, below.y, source, 0, base + next.first, count, 0, 0];
        let groups = [next.size.x.div_ceil(8), next.size.y.div_ceil(8), 1];
        let bindings = vec![
            Binding::Uniform(bytemuck::cast_slice(&task)),
            Binding::Write(&mut bytes),
        ];
        gpu.run(kernel, &mut [bindings], groups).expect("a run");
        made += count;
        let last = level(size, made);
        (below, source) = (last.size, base + last.first);
    }
    bytemuck::pod_collect_to_vec(&bytes)
}

#[test]
fn the_adapter_makes_the_same_levels_and_hides_nothing_that_can_be_seen() {
    let Some(gpu) = gpu::for_test() else { return };
    let kernel = |module, entry| gpu.kernel(module, entry).expect("valid");
    let builder = kernel(
        compose("deferred/pyramid_build.wgsl", &[]).expect("valid"),
        "halve",
    );
    let asker = ShaderFile {
        path: "deferred/ask.wgsl",
        source: ASK,
    };
    let asker = kernel(
        compose_with(asker.path, &[], &[asker]).expect("valid"),
        "ask",
    );
    let mut random = Random::new(12);
    let mut counts = Counts::default();
    for size in sizes(&mut random) {
        let depths = depths(&mut random, size);
        let pyramid = Pyramid::new(&depths, size).expect("a view");
        let made = build(&gpu, &builder, &depths, size);
        assert_eq!(&made[depths.len()..], pyramid.texels(), "{size}");
        let boxes = boxes(&mut random, size, count().max(64));
        let mut question = bytemuck::cast_slice(&projection(size).to_cols_array()).to_vec();
        let rest = [size.x, size.y, boxes.len() as u32, depths.len() as u32];
        question.extend_from_slice(bytemuck::cast_slice(&rest));
        let mut hidden = vec![0xa5_u8; 4 * boxes.len()];
        let bindings = vec![
            Binding::Uniform(&question),
            Binding::Read(bytemuck::cast_slice(&made)),
            Binding::Read(bytemuck::cast_slice(&boxes)),
            Binding::Write(&mut hidden),
        ];
        let groups = [boxes.len().div_ceil(64) as u32, 1, 1];
        gpu.run(&asker, &mut [bindings], groups).expect("a run");
        for (cuboid, told) in boxes
            .iter()
            .zip(bytemuck::pod_collect_to_vec::<u8, u32>(&hidden))
        {
            assert!(told <= 1, "every box has an answer");
            counts.add(truth(cuboid, &depths, size), told == 1);
        }
    }
    eprintln!("{counts:?}");
    assert_eq!(counts.wrong, 0);
    assert!(
        counts.hidden > 2000 && counts.told * 10 >= counts.hidden * 8,
        "{counts:?}"
    );
}
