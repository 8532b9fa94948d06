//! The ground's choice and its answers: all passes that choose vertices for a view, and height queries on the triangles
//! that they make, against the CPU reference.
//!
//! An implementation may fuse and reorder, so heights, and error ratios with them, differ by roundings. A view is taken in
//! which that decides nothing: its triangles are the same with the tolerance half a thousandth finer and coarser. Then every
//! implementation has to come to the same triangles, and their heights to some units in the last place.

mod run;
mod view;

use bevy::math::{DVec2, DVec3};
use bytemuck::{bytes_of, cast_slice};
use dolomite_geometry::layout::{GeometryHead, VERTEX_BYTES};
use dolomite_ground::detail::probe::{
    ANSWER_GROUP, ANSWER_PASS, AnswerHead, Asked, drawn_at, locate,
};
use dolomite_ground::detail::{DetailCells, Metric};
use dolomite_terrain::{GroundPoint, ProbeAnswer};
use dolomite_testkit::random::Random;

use super::CapsuleError;
use super::format::{BindingKind, Capsule, Command, Field, FieldType, From};
use run::Run;
use view::{Chosen, chosen, terrain};

/// Places that are asked for, on triangles and beside the ground.
const PLACES: usize = 256;
const BESIDE: usize = 16;
/// Units in the last place that heights and slopes may be off, of the sizes below.
const ULP: f64 = 4.0;
/// Sum of the sources' greatest heights, metres: what heights are sums of.
const HEIGHT: f32 = 256.0;
/// Differences of such heights over the shortest sides of triangles.
const SLOPE: f32 = 64.0;

/// A choice and its answers, for a metric.
///
/// # Errors
/// If a shader is wrong, or no view of the seed is one that roundings do not decide in.
pub fn capsule(
    name: &str,
    about: &str,
    (metric, seed): (Metric, u32),
) -> Result<Capsule, CapsuleError> {
    let mut cells = DetailCells::new(terrain(), 4.0);
    let chosen = chosen(&mut cells, metric, seed).ok_or_else(|| CapsuleError::Undecided {
        name: name.to_owned(),
        seed,
    })?;
    let mut run = Run::new(name, about, &cells, &chosen)?;
    run.choose()?;
    run.check_choice(&chosen);
    run.answer(&cells, &chosen, seed)?;
    Ok(run.builder.finish())
}

impl Run {
    fn check_choice(&mut self, chosen: &Chosen) {
        let mesh = &chosen.mesh;
        let triangles = mesh.triangles.len() as u32;
        let head = GeometryHead {
            indexed: [3 * triangles, 1, 0, 0, 0],
            amplified: [3, triangles, 0, 0],
            plain: [3 * triangles, 1, 0, 0],
            primitives: triangles,
            ..GeometryHead::default()
        };
        // The other words of the arguments are never written.
        let word = |name, at| Field::words(name, at, 2);
        let fields = vec![
            word("indexed", core::mem::offset_of!(GeometryHead, indexed)),
            word("amplified", core::mem::offset_of!(GeometryHead, amplified)),
            word("plain", core::mem::offset_of!(GeometryHead, plain)),
            Field::words(
                "triangles",
                core::mem::offset_of!(GeometryHead, primitives),
                1,
            ),
        ];
        let size = size_of::<GeometryHead>() as u64;
        let from = From::CpuReference;
        self.builder
            .check("head", (self.head, 0, size), fields, bytes_of(&head), from);
        let anchor = GroundPoint::from(chosen.view.anchor().as_dvec2());
        let corner = |k: &u32| {
            let vertex = &mesh.vertices[*k as usize];
            let place = vertex.point.relative_to(anchor);
            [place.x, vertex.height - chosen.anchor_height, place.y]
        };
        let corners: Vec<[f32; 3]> = mesh.triangles.iter().flatten().map(corner).collect();
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

    /// Asks for places on the triangles, and beside the ground.
    fn answer(
        &mut self,
        cells: &DetailCells,
        chosen: &Chosen,
        seed: u32,
    ) -> Result<(), CapsuleError> {
        let places = places(cells, chosen, seed);
        let expected: Vec<ProbeAnswer> = places
            .iter()
            .map(|place| answer(cells, chosen, *place))
            .collect();
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
        let (read, write) = (BindingKind::ReadOnlyStorage, BindingKind::Storage);
        let own_layout = builder.layout(&[read, read, BindingKind::Uniform, read, write]);
        let [shared_layout, shared] = self.answering;
        let pipeline = builder.pipeline(module, entry, &[shared_layout, own_layout]);
        let asked = builder.buffer("asked", bytes_of(&asked));
        let given = builder.buffer("places", cast_slice(&places));
        let head_bytes = size_of::<AnswerHead>() as u64;
        let each = size_of::<ProbeAnswer>() as u64;
        let answers = builder.filled("answers", head_bytes + each * places.len() as u64, 0xAB);
        let bound = [self.corners, self.vertices, asked, given, answers];
        let own = builder.group(own_layout, &bound);
        let groups = places.len().div_ceil(ANSWER_GROUP as usize) as u32;
        builder.dispatch(pipeline, &[shared, own], [groups, 1, 1]);
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

/// Places well within triangles, where every implementation finds the same one; and some beside the ground.
fn places(cells: &DetailCells, chosen: &Chosen, seed: u32) -> Vec<GroundPoint> {
    let mut random = Random::new(seed ^ 0x5eed);
    let mesh = &chosen.mesh;
    let mut places: Vec<GroundPoint> = (0..PLACES)
        .map(|_| {
            let triangle = mesh.triangles[random.below(mesh.triangles.len())];
            let corners = triangle.map(|k| mesh.vertices[k as usize].point.to_fixed());
            // Shares of 1/8 and more.
            let (mut u, mut v) = (random.unit(), random.unit());
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            let shares = [u, v].map(|share| 0.125 + 0.625 * share);
            let [a, b, c] = corners;
            GroundPoint::from_fixed([0, 1].map(|axis| {
                let along = (b[axis] - a[axis]) as f64 * shares[0];
                let across = (c[axis] - a[axis]) as f64 * shares[1];
                a[axis] + along as i64 + across as i64
            }))
        })
        .collect();
    let extent = cells.terrain().extent();
    places.extend((0..BESIDE).map(|k| {
        let away = DVec2::new(1.0 + k as f64, [1.0, 10.0, 100.0, 1000.0][k % 4]);
        GroundPoint::new(extent.max + away)
    }));
    places
}

/// What the pass answers at a place: heights of a triangle's first corner and the rise from there, in f64.
fn answer(cells: &DetailCells, chosen: &Chosen, place: GroundPoint) -> ProbeAnswer {
    let Chosen {
        selection, mesh, ..
    } = chosen;
    let found = locate(cells, selection, place);
    let (Some(located), Some(drawn)) = (found, drawn_at(cells, selection, place)) else {
        return ProbeAnswer::NOTHING;
    };
    let anchor = GroundPoint::from(chosen.view.anchor().as_dvec2());
    let base = f64::from(chosen.anchor_height);
    let corners = located.corners.map(|at| {
        let point = cells.lattice.point(at);
        let of = mesh.vertices.iter().find(|vertex| vertex.point == point);
        let height = of.map_or(f64::NAN, |vertex| f64::from(vertex.height));
        let at = point.relative_to(anchor).as_dvec2();
        DVec3::new(at.x, height - base, at.y)
    });
    let rise = drawn.height - base - corners[0].y;
    // What the pass adds for corners that are stored in f32; see answer.wgsl.
    let [a, b] = [1, 2].map(|k| corners[k] - corners[0]);
    let along = [
        corners[0].x.abs(),
        corners[0].z.abs(),
        a.x.abs() + a.z.abs(),
        b.x.abs() + b.z.abs(),
    ];
    let along = along.into_iter().fold(0.0, f64::max);
    let slope = drawn.gradient.x.abs() + drawn.gradient.y.abs();
    let rounding = 1.2e-7 * (along * slope + corners[0].y.abs() + rise.abs() + base.abs());
    ProbeAnswer {
        height: corners[0].y as f32,
        rise: rise as f32,
        gradient: drawn.gradient.as_vec2().to_array(),
        bound: (drawn.bound + rounding) as f32,
    }
}
