//! The ground's choice in blocks and its answers: all passes that choose and make blocks for a view from nothing on, until all
//! is there that it asks for, and height queries on the triangles that they draw, against the CPU reference.
//!
//! An implementation may fuse and reorder, so heights, and error ratios with them, differ by roundings. A view is taken in
//! which that decides nothing: its blocks and its triangles are the same with the tolerance half a thousandth finer and
//! coarser, and what is in view of them is the same with corners moved by a fifth of a millimetre. Then every
//! implementation has to come to the same blocks and triangles, and their heights to some units in the last place.

mod run;
mod view;

use std::collections::HashMap;

use bevy::math::{DVec2, DVec3, UVec2};
use bytemuck::{bytes_of, cast, cast_slice};
use dolomite_geometry::layout::{GeometryHead, HEAD_WORDS, VERTEX_BYTES};
use dolomite_ground::blocks::kept::KeptBlocks;
use dolomite_ground::blocks::layout::{
    ANSWER_PASS, GpuHead, HEAD_BYTES, HEAD_COARSENING, HEAD_DRAWN, HEAD_MADE, HEAD_STAMP,
    HEAD_USED, HEAD_WISHES,
};
use dolomite_ground::blocks::locate::locate;
use dolomite_ground::blocks::place::{VERTICES, vertex_at};
use dolomite_ground::detail::probe::{ANSWER_GROUP, AnswerHead, Asked};
use dolomite_ground::detail::{DetailGround, Metric};
use dolomite_terrain::{GroundPoint, ProbeAnswer};
use dolomite_testkit::random::Random;

use super::CapsuleError;
use super::format::{BindingKind, Capsule, Command, Field, FieldType, From};
use run::{Run, SLOTS};
use view::{Chosen, FINEST, POOLS, chosen, terrain};

/// Places that are asked for, on triangles and beside the ground.
const PLACES: usize = 256;
const BESIDE: usize = 16;
/// Units in the last place that heights, slopes, and what is kept of blocks may be off, of the sizes below.
const ULP: f64 = 4.0;
/// Sum of the sources' greatest heights, metres: what heights are sums of.
const HEIGHT: f32 = 256.0;
/// Differences of such heights over the shortest sides of triangles.
const SLOPE: f32 = 64.0;

/// A choice and its answers, for a metric; `culled`: what the picture does not show is left out.
///
/// # Errors
/// If a shader is wrong, or no view of the seed is one that roundings do not decide in.
pub fn capsule(
    name: &str,
    about: &str,
    (metric, culled, seed): (Metric, bool, u32),
) -> Result<Capsule, CapsuleError> {
    let undecided = || CapsuleError::Undecided {
        name: name.to_owned(),
        seed,
    };
    let mut blocks = KeptBlocks::new(terrain(), FINEST);
    let ground = DetailGround::on(terrain(), blocks.lattice);
    let chosen = chosen(&mut blocks, metric, culled, seed).ok_or_else(undecided)?;
    if chosen.made.len() >= SLOTS as usize {
        return Err(undecided());
    }
    let mut run = Run::new(name, about, &ground, &chosen);
    run.choose(chosen.rounds)?;
    run.check_choice(&blocks, &chosen);
    run.check_blocks(&blocks, &chosen);
    run.answer(&blocks, &chosen, seed)?;
    Ok(run.builder.finish())
}

impl Run {
    fn check_choice(&mut self, blocks: &KeptBlocks, chosen: &Chosen) {
        let triangles = chosen.seen.len() as u32;
        let others = (chosen.mesh.triangles.len() - chosen.seen.len()) as u32;
        let head = GeometryHead {
            indexed: [3 * triangles, 1, 0, 0, 0],
            amplified: [3, triangles, 0, 0],
            plain: [3 * triangles, 1, 0, 0],
            others: [3 * others, 1, 3 * (POOLS[1] - others), 0, 0],
            primitives: triangles,
            wanted_primitives: triangles + others,
            ..GeometryHead::default()
        };
        let mut words: [u32; HEAD_WORDS as usize] = cast(head);
        let exist = chosen.choice.blocks.iter();
        let exist = exist.filter(|block| chosen.choice.exists(block, blocks));
        let own = [
            ("coarsening", HEAD_COARSENING, 1.0_f32.to_bits()),
            ("blocks", HEAD_USED, chosen.made.len() as u32),
            ("wishes", HEAD_WISHES, 0),
            ("blocks made", HEAD_MADE, 0),
            ("blocks drawn", HEAD_DRAWN, exist.count() as u32),
            ("choice", HEAD_STAMP, self.params.stamp),
        ];
        // The other words of the arguments are never written.
        let mut fields = vec![
            Field::words("indexed", core::mem::offset_of!(GeometryHead, indexed), 2),
            Field::words(
                "amplified",
                core::mem::offset_of!(GeometryHead, amplified),
                2,
            ),
            Field::words("plain", core::mem::offset_of!(GeometryHead, plain), 2),
            Field::words("others", core::mem::offset_of!(GeometryHead, others), 3),
            Field::words(
                "triangles",
                core::mem::offset_of!(GeometryHead, primitives),
                1,
            ),
            Field::words(
                "triangles in all",
                core::mem::offset_of!(GeometryHead, wanted_primitives),
                1,
            ),
        ];
        for (name, word, value) in own {
            words[word] = value;
            fields.push(Field::words(name, 4 * word, 1));
        }
        let size = size_of::<GeometryHead>() as u64;
        let from = From::CpuReference;
        self.builder.check(
            "head",
            (self.head, 0, size),
            fields,
            cast_slice(&words),
            from,
        );
        let corner = |k: &u32| chosen.place(blocks, *k).to_array();
        let corners: Vec<[f32; 3]> = chosen.seen.iter().flatten().map(corner).collect();
        let expected = self.builder.data(cast_slice(&corners));
        self.builder.command(Command::Triangles {
            name: "triangles".to_owned(),
            vertices: self.vertices,
            stride: VERTEX_BYTES,
            indices: self.indices,
            count: triangles.into(),
            ulp: ULP,
            scale: HEIGHT,
            expected,
            from,
        });
    }

    /// The blocks that were made, in whichever slots.
    fn check_blocks(&mut self, blocks: &KeptBlocks, chosen: &Chosen) {
        let slots = blocks.by_place();
        let expected: Vec<GpuHead> = chosen
            .made
            .iter()
            .map(|centre| {
                let head = &blocks.block(slots[centre]).head;
                GpuHead {
                    centre: head.centre.to_array(),
                    half: head.half,
                    mixed_error: head.mixed_error,
                    low: head.low,
                    high: head.high,
                    ..GpuHead::default()
                }
            })
            .collect();
        let number = FieldType::F32 {
            ulp: ULP,
            scale: HEIGHT,
        };
        let fields = vec![
            Field::words("centre and half side", 0, 3),
            Field::new(
                "error and interval",
                core::mem::offset_of!(GpuHead, mixed_error),
                3,
                number,
            ),
        ];
        // The first slot is no block.
        let at = (self.heads, HEAD_BYTES, HEAD_BYTES);
        let from = From::CpuReference;
        self.builder
            .check_unordered("blocks", at, fields, cast_slice(&expected), from);
    }

    /// Asks for places on the triangles, and beside the ground.
    fn answer(
        &mut self,
        blocks: &KeptBlocks,
        chosen: &Chosen,
        seed: u32,
    ) -> Result<(), CapsuleError> {
        let (places, expected) = asked(blocks, chosen, seed);
        let asked = Asked {
            frame: 7,
            count: places.len() as u32,
            ..Asked::default()
        };
        let head = AnswerHead {
            frame: 7,
            count: asked.count,
            stamp: self.params.stamp,
            anchor_height: chosen.anchor_height,
        };
        let (file, entry) = ANSWER_PASS;
        let builder = &mut self.builder;
        let module = dolomite_shaders::compose(file, &[])?;
        let module = builder.module(file, &[], &module)?;
        let uniform = BindingKind::Uniform;
        let own_layout = builder.layout(&[
            uniform,
            uniform,
            uniform,
            BindingKind::ReadOnlyStorage,
            BindingKind::Storage,
        ]);
        let pipeline = builder.pipeline(module, entry, &[self.shared.layout, own_layout]);
        let asked = builder.buffer("asked", bytes_of(&asked));
        let given = builder.buffer("places", cast_slice(&places));
        let head_bytes = size_of::<AnswerHead>() as u64;
        let each = size_of::<ProbeAnswer>() as u64;
        let answers = builder.filled("answers", head_bytes + each * places.len() as u64, 0xAB);
        let bound = [self.nothing, self.nothing, asked, given, answers];
        let own = builder.group(own_layout, &bound);
        let groups = places.len().div_ceil(ANSWER_GROUP as usize) as u32;
        builder.dispatch(pipeline, &[self.shared.group, own], [groups, 1, 1]);
        let from = From::CpuReference;
        let fields = vec![Field::words("head", 0, 4)];
        let at = (answers, 0, head_bytes);
        builder.check("answers' head", at, fields, bytes_of(&head), from);
        let number = |scale| FieldType::F32 { ulp: ULP, scale };
        let fields = vec![
            Field::new("height and rise", 0, 2, number(HEIGHT)),
            Field::new("gradient", 8, 2, number(SLOPE)),
            Field::new("bound", 16, 1, number(HEIGHT)),
        ];
        let at = (answers, head_bytes, each);
        builder.check("answers", at, fields, cast_slice(&expected), from);
        Ok(())
    }
}

/// Places well within triangles, where every implementation finds the same one, with the answers to them; and some beside
/// the ground.
fn asked(blocks: &KeptBlocks, chosen: &Chosen, seed: u32) -> (Vec<GroundPoint>, Vec<ProbeAnswer>) {
    let mut random = Random::new(seed ^ 0x5eed);
    let mesh = &chosen.mesh;
    let grounds = grounds(blocks);
    let (mut places, mut answers) = (Vec::new(), Vec::new());
    while places.len() < PLACES {
        let triangle = mesh.triangles[random.below(mesh.triangles.len())];
        let [a, b, c] = triangle.map(|k| {
            blocks
                .lattice
                .point(mesh.vertices[k as usize].at)
                .to_fixed()
        });
        // Shares of 1/8 and more.
        let (mut u, mut v) = (random.unit(), random.unit());
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        let shares = [u, v].map(|share| 0.125 + 0.625 * share);
        let place = GroundPoint::from_fixed([0, 1].map(|axis| {
            let along = (b[axis] - a[axis]) as f64 * shares[0];
            let across = (c[axis] - a[axis]) as f64 * shares[1];
            a[axis] + along as i64 + across as i64
        }));
        // Below the corners of roots nothing is known.
        let answer = answer(blocks, chosen, &grounds, place);
        if answer.bound.is_finite() {
            places.push(place);
            answers.push(answer);
        }
    }
    let extent = blocks.terrain().extent();
    for k in 0..BESIDE {
        let away = DVec2::new(1.0 + k as f64, [1.0, 10.0, 100.0, 1000.0][k % 4]);
        places.push(GroundPoint::new(extent.max + away));
        answers.push(ProbeAnswer::NOTHING);
    }
    (places, answers)
}

/// Height of the ground, or of the sea above it, under every vertex of all blocks, metres.
fn grounds(blocks: &KeptBlocks) -> HashMap<UVec2, f32> {
    let sea = blocks.sea();
    let all = blocks.used().flat_map(|slot| {
        let (block, place) = (blocks.block(slot), blocks.place(slot));
        (0..VERTICES).map(move |number| {
            let at = place.lattice_point(vertex_at(number));
            (at, block.heights[number].max(sea))
        })
    });
    all.collect()
}

/// What the pass answers at a place: heights of a triangle's first corner and the rise from there, in f64.
fn answer(
    blocks: &KeptBlocks,
    chosen: &Chosen,
    grounds: &HashMap<UVec2, f32>,
    place: GroundPoint,
) -> ProbeAnswer {
    let Some(found) = locate(blocks, &chosen.choice, place) else {
        return ProbeAnswer::NOTHING;
    };
    let anchor = GroundPoint::from(chosen.view.anchor().as_dvec2());
    let base = f64::from(chosen.anchor_height);
    let corners = found.corners.map(|vertex| {
        let at = blocks.lattice.point(vertex.at).relative_to(anchor);
        let at = at.as_dvec2();
        DVec3::new(at.x, f64::from(vertex.height) - base, at.y)
    });
    let rise = found.height - base - corners[0].y;
    let [a, b] = [1, 2].map(|k| corners[k] - corners[0]);
    let normal = a.cross(b);
    let gradient = DVec2::new(-normal.x, -normal.z) / normal.y;
    // By how much corners that are on their way are off the ground, each by its share of the place.
    let off = |k: usize| f64::from(found.corners[k].height - grounds[&found.corners[k].at]);
    let moved = (0..3).map(|k| found.weights[k] * off(k)).sum::<f64>().abs();
    // What the pass adds for corners that are stored in f32; see answer.wgsl.
    let along = [
        corners[0].x.abs(),
        corners[0].z.abs(),
        a.x.abs() + b.x.abs(),
        a.z.abs() + b.z.abs(),
    ];
    let along = along.into_iter().fold(0.0, f64::max);
    let slope = gradient.x.abs() + gradient.y.abs();
    let rounding = 1.2e-7 * (along * slope + corners[0].y.abs() + rise.abs() + base.abs());
    ProbeAnswer {
        height: corners[0].y as f32,
        rise: rise as f32,
        gradient: gradient.as_vec2().to_array(),
        bound: (f64::from(found.error) + moved + rounding) as f32,
    }
}
