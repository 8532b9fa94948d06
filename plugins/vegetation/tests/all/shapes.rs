//! Functions of WGSL against those of the same name in Rust: blades, heads of flowers, kelp, colours.

use bevy::math::{Vec2, Vec3};
use dolomite_terrain::GroundPoint;
use dolomite_vegetation::blade::{self, BladeShape, Own, pushed};
use dolomite_vegetation::blossom::{head_far, head_frame, head_near};
use dolomite_vegetation::colour::{blade_colour, blade_tint, calm_at, shade_at};
use dolomite_vegetation::kind::{Blade, Chain, Look};
use dolomite_vegetation::{ChainShape, Wind, WindField};

use super::functions::{compare, words};
use super::support::Random;

/// Of WGSL's sine and cosine within ±π.
const SINE: f32 = 1.0 / 2048.0;

fn look(unit: &mut impl FnMut() -> f32) -> Look {
    let mut colour = || [unit(), unit(), unit()];
    Look {
        root: colour(),
        tip: colour(),
        dry: colour(),
        dry_share: unit(),
        translucency: unit(),
        sway: 0.1 * unit(),
    }
}

fn blade(unit: &mut impl FnMut() -> f32) -> Blade {
    let short = 0.1 + unit();
    Blade {
        length: (short, short + unit()),
        width: 0.02 * unit() + 0.001,
        lean: 1.5 * unit(),
        droop: unit(),
        look: look(unit),
    }
}

/// Words of a `Look` in WGSL, as `render/layers.rs` makes them.
fn look_words(
    look: &Look,
    lean: f32,
    droop: f32,
    size: [f32; 3],
    uneven: f32,
    head: [f32; 3],
) -> Vec<u32> {
    let with = |[r, g, b]: [f32; 3], w: f32| [r, g, b, w];
    let rows = [
        with(look.root, bevy::math::ops::sin(lean)),
        with(look.tip, droop),
        with(look.dry, look.dry_share),
        with(size, look.translucency),
        [look.sway, uneven, 0.0, 0.0],
        [0.0; 4],
        with(head, 0.0),
        [0.0; 4],
    ];
    words(rows.as_flattened())
}

fn blade_words(blade: &Blade, uneven: f32) -> Vec<u32> {
    let size = [blade.length.0, blade.length.1, blade.width];
    look_words(&blade.look, blade.lean, blade.droop, size, uneven, [0.0; 3])
}

const CURVE: &str = "
#import dolomite::vegetation::blade::{curve_of, place_at, pushed, row_at, tangent_at, widened_edge, width_at}
struct Case { lean: vec2<f32>, by: vec2<f32>, offset: vec3<f32>, long: f32, to_eye: vec3<f32>, droop: f32,
    along: f32, segments: f32, least: f32, pad: f32 }
@group(0) @binding(0) var<storage, read> given: array<Case>;
@group(0) @binding(1) var<storage, read_write> found: array<f32>;
@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
    if 18u * id.x >= arrayLength(&found) { return; }
    let g = given[id.x];
    let lean = pushed(g.lean, g.by);
    let curve = curve_of(g.long, g.droop, lean);
    let place = place_at(curve, g.along);
    let tangent = tangent_at(curve, g.along);
    let wider = widened_edge(g.offset, tangent, g.to_eye, g.least);
    let out = array(lean.x, lean.y, place.x, place.y, place.z, tangent.x, tangent.y, tangent.z,
        wider.x, wider.y, wider.z, width_at(g.along, u32(g.segments)));
    for (var k = 0u; k < 12u; k++) { found[18u * id.x + k] = out[k]; }
    let segments = u32(g.segments);
    for (var k = 0u; k < 2u; k++) {
        let row = row_at(curve, select(segments >> 1u, segments, k == 1u), segments);
        for (var n = 0u; n < 3u; n++) { found[18u * id.x + 12u + 3u * k + n] = row[n]; }
    }
}
";

#[test]
fn curves_are_those_of_rust_gpu() {
    let mut random = Random(41);
    let mut unit = || random.unit() as f32;
    let (mut wider, mut not) = (0, 0);
    let cases: Vec<_> = (0..4096)
        .map(|k| {
            let mut flat = |most: f32| Vec2::new(unit() - 0.5, unit() - 0.5) * most;
            let (before, by) = (flat(1.4), flat(4.0));
            let mut place = || Vec3::new(unit() - 0.5, unit() - 0.5, unit() - 0.5);
            let offset = if k % 8 == 0 {
                Vec3::ZERO
            } else {
                0.02 * place()
            };
            let to_eye = place().normalize();
            let (long, droop, along) = (0.1 + unit(), unit(), unit());
            let segments = blade::SEGMENTS[k % 3];
            let least = 0.008 * unit();
            let lean = pushed(before, by);
            let shape = BladeShape {
                length: long,
                width: 1.0,
                lean,
                droop,
                across: Vec2::X,
                give: 0.0,
            };
            let (place, tangent) = shape.curve(lean).at(along);
            let edge = blade::widened(offset, tangent, to_eye, least);
            *(if edge == Vec3::ZERO {
                &mut not
            } else {
                &mut wider
            }) += 1;
            let given = [
                [before.x, before.y, by.x, by.y],
                [offset.x, offset.y, offset.z, long],
                [to_eye.x, to_eye.y, to_eye.z, droop],
                [along, segments as f32, least, 0.0],
            ];
            let mut expected = lean.to_array().to_vec();
            for part in [place, tangent, edge] {
                expected.extend(part.to_array());
            }
            expected.push(shape.width_at(along, segments));
            for row in [segments / 2, segments] {
                expected.extend(shape.curve(lean).row(row, segments).0.to_array());
            }
            (words(given.as_flattened()), expected)
        })
        .collect();
    assert!(wider > 500 && not > 500, "{wider} {not}");
    // Products, roots and quotients, a few ulp each, of lengths up to 2 m.
    compare(CURVE, &cases, 2e-5);
}

const SHAPE: &str = "
#import dolomite::vegetation::colour::{blade_colour, blade_tint, calm_at, shade_at}
#import dolomite::vegetation::draw_types::Look
#import dolomite::vegetation::shape::{own, shape_of}
struct Case { look: Look, normal: vec3<f32>, t: f32, noise: vec2<f32>, calm: f32, distance: f32,
    hash: u32, clump: u32, pad: vec2<u32> }
@group(0) @binding(0) var<storage, read> given: array<Case>;
@group(0) @binding(1) var<storage, read_write> found: array<f32>;
@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
    if 14u * id.x >= arrayLength(&found) { return; }
    let g = given[id.x];
    let shape = shape_of(g.look, g.hash, g.clump, g.normal);
    let colour = blade_colour(g.look, blade_tint(g.look, g.hash, g.clump, g.noise, g.calm), g.t);
    let out = array(shape.long, shape.width, shape.lean.x, shape.lean.y, shape.droop, shape.across.x, shape.across.y,
        shape.give, colour.x, colour.y, colour.z, shade_at(g.t), calm_at(12.0, g.distance), own(g.hash, 9u));
    for (var k = 0u; k < 14u; k++) { found[14u * id.x + k] = out[k]; }
}
";

#[test]
fn shapes_and_colours_are_those_of_rust_gpu() {
    let mut random = Random(42);
    let cases: Vec<_> = (0..4096)
        .map(|_| {
            let bits = random.bits();
            let own = Own {
                hash: bits >> 16,
                clump: bits & 31,
            };
            let mut unit = || random.unit() as f32;
            let blade = blade(&mut unit);
            let uneven = unit();
            let normal = Vec3::new(unit() - 0.5, 0.8, unit() - 0.5).normalize();
            let noise = Vec2::new(unit(), unit());
            let (t, calm, distance) = (unit(), unit(), 90.0 * unit());
            let mut given = blade_words(&blade, uneven);
            given.extend(words(&[
                normal.x, normal.y, normal.z, t, noise.x, noise.y, calm, distance,
            ]));
            given.extend([own.hash, own.clump, 0, 0]);
            let shape = BladeShape::new(&blade, own, uneven, normal);
            let tint = blade_tint(&blade.look, own, noise, calm);
            let colour = blade_colour(&blade.look, tint, t);
            let expected = vec![
                shape.length,
                shape.width,
                shape.lean.x,
                shape.lean.y,
                shape.droop,
                shape.across.x,
                shape.across.y,
                shape.give,
                colour.x,
                colour.y,
                colour.z,
                shade_at(t),
                calm_at(12.0, distance),
                own.number(9),
            ];
            (given, expected)
        })
        .collect();
    // The turn of a blade goes up to 3π/2; all else is exact to some ulp.
    compare(SHAPE, &cases, 2.0 * SINE);
}

const CHAIN: &str = "
#import dolomite::vegetation::chain::{chain_of, node_at_rest, node_moved, ribbon_across, ribbon_width}
#import dolomite::vegetation::draw_types::Look
#import dolomite::vegetation::wind::{WindField, water_moved}
struct Case { look: Look, field: WindField, at: vec2<f32>, depth: f32, hash: u32, number: u32, step: u32, wind: vec2<f32> }
@group(0) @binding(0) var<storage, read> given: array<Case>;
@group(0) @binding(1) var<storage, read_write> found: array<f32>;
@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
    if 12u * id.x >= arrayLength(&found) { return; }
    let g = given[id.x];
    let chain = chain_of(g.look, g.hash, g.depth, g.wind);
    let rest = node_at_rest(chain, g.number);
    let node = node_moved(chain, g.number, rest, water_moved(g.field, g.at + rest.place.xz, chain.depth - rest.place.y));
    let across = ribbon_across(chain, g.number, rest);
    let out = array(f32(chain.segments), chain.segment, rest.along.x, rest.along.y, rest.along.z,
        node.x, node.y, node.z, across.x, across.z, ribbon_width(chain, g.number, rest.floats, g.step), f32(rest.floats));
    for (var k = 0u; k < 12u; k++) { found[12u * id.x + k] = out[k]; }
}
";

#[test]
fn chains_are_those_of_rust_gpu() {
    let mut random = Random(43);
    let field = WindField::new(&Wind::default(), GroundPoint::default(), 77.0);
    let mut floats = 0;
    let cases: Vec<_> = (0..4096)
        .map(|_| {
            let hash = random.bits() >> 16;
            let number = random.bits() % 20;
            let mut unit = || random.unit() as f32;
            let chain = Chain {
                segment: 0.2 + 0.4 * unit(),
                segments: 4 + (24.0 * unit()) as u32,
                rise: (0.3 * unit() + 0.1, 0.5 + 1.5 * unit()),
                width: unit(),
                twist: 0.3 * unit(),
                look: look(&mut unit),
            };
            let at = Vec2::new(40.0 * unit() - 20.0, 40.0 * unit() - 20.0);
            let depth = 2.0 + 20.0 * unit();
            let size = [chain.rise.0, chain.rise.1, chain.width];
            let head = [chain.segment, chain.segments as f32, chain.twist];
            let mut given = look_words(&chain.look, 0.0, 0.0, size, 0.0, head);
            given.extend(bytemuck::cast_slice::<_, u32>(&[field]));
            let wind = Vec2::new(4.0 * unit() - 2.0, 4.0 * unit() - 2.0);
            let step = 1 << (number % 3);
            given.extend(words(&[at.x, at.y, depth]));
            given.extend([hash, number, step]);
            given.extend(words(&[wind.x, wind.y]));
            let shape = ChainShape::new(&chain, hash, depth, wind);
            let rest = shape.at_rest(number);
            let along = rest.along;
            let node = shape.node(number, at, &field);
            let across = shape.across(number, &rest);
            let expected = vec![
                shape.segments as f32,
                shape.segment,
                along.x,
                along.y,
                along.z,
                node.x,
                node.y,
                node.z,
                across.x,
                across.z,
                shape.width_at(number.min(shape.segments), rest.floats, step),
                if rest.floats { 1.0 } else { 0.0 },
            ];
            // Where a node is just at the surface an ulp decides whether it floats.
            let floating = |off: f32| {
                let shape = ChainShape {
                    depth: depth + off,
                    ..shape
                };
                (0..=number).find(|k| shape.at_rest(*k).floats)
            };
            floats += u32::from(rest.floats);
            let clear = floating(1e-3) == floating(-1e-3);
            (given, expected, clear && number <= shape.segments)
        })
        .filter_map(|(given, expected, within)| within.then_some((given, expected)))
        .collect();
    assert!(
        cases.len() > 2000 && floats > 50,
        "{} {floats}",
        cases.len()
    );
    // Each segment, of 0.6 m at most, may be off by two errors of a sine; up to 20 of them lean the same way.
    compare(CHAIN, &cases, 2.0 * SINE * 0.6 * 20.0);
}

const HEAD: &str = "
#import dolomite::vegetation::blossom::{head_far, head_frame, head_near}
struct Case { tangent: vec3<f32>, number: u32, across: vec2<f32>, petals: u32, pad: u32 }
@group(0) @binding(0) var<storage, read> given: array<Case>;
@group(0) @binding(1) var<storage, read_write> found: array<f32>;
@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
    if 17u * id.x >= arrayLength(&found) { return; }
    let g = given[id.x];
    let near = head_near(g.number, g.petals);
    let far = head_far(g.number, g.petals);
    let frame = head_frame(g.tangent, g.across);
    let out = array(near.at.x, near.at.y, near.rise, near.petal, far.at.x, far.at.y, far.rise, far.petal,
        frame.axis.x, frame.axis.y, frame.axis.z, frame.right.x, frame.right.y, frame.right.z,
        frame.ahead.x, frame.ahead.y, frame.ahead.z);
    for (var k = 0u; k < 17u; k++) { found[17u * id.x + k] = out[k]; }
}
";

#[test]
fn heads_are_those_of_rust_gpu() {
    let mut random = Random(44);
    let mut cases = Vec::new();
    for petals in 3..=12 {
        for number in 0..130 {
            let mut unit = || random.unit() as f32;
            let tangent = Vec3::new(unit() - 0.5, unit() + 0.1, unit() - 0.5);
            let (sin, cos) = bevy::math::ops::sin_cos(6.3 * unit());
            let across = Vec2::new(cos, sin);
            let mut given = words(&tangent.to_array());
            given.push(number);
            given.extend(words(&across.to_array()));
            given.extend([petals, 0]);
            let (near, far) = (head_near(number, petals), head_far(number, petals));
            let frame = head_frame(tangent, across);
            let mut expected = Vec::new();
            for point in [near, far] {
                expected.extend([point.at.x, point.at.y, point.rise, point.petal]);
            }
            for axis in [frame.axis, frame.right, frame.ahead] {
                expected.extend(axis.to_array());
            }
            cases.push((given, expected));
        }
    }
    // Angles go once around; a tangent's error is that of a sine over a cosine, of 60 degrees at most.
    compare(HEAD, &cases, 4.0 * SINE);
}
