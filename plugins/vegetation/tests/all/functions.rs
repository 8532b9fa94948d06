//! Functions of WGSL against those of the same name in Rust: the law of distance, wind and swell, presses, edges of bands.

use bevy::math::{DVec2, Vec2, Vec3};
use dolomite_terrain::GroundPoint;
use dolomite_testkit::gpu;
use dolomite_vegetation::band::ramp;
use dolomite_vegetation::colour::lit_through;
use dolomite_vegetation::law::{self, Law};
use dolomite_vegetation::{Press, Wind, WindField, shade, straight};

use super::support::{Random, probe, run};

/// Runs a probe on cases of as many words each, and compares the numbers that it finds with `expected`, as many a case.
pub fn compare(source: &'static str, cases: &[(Vec<u32>, Vec<f32>)], tolerance: f32) {
    let Some(gpu) = gpu::for_test() else { return };
    let kernel = probe(&gpu, source, "probe");
    let words: Vec<u32> = cases.iter().flat_map(|case| case.0.clone()).collect();
    let each = cases[0].1.len();
    let found = run(&gpu, &kernel, &words, cases.len(), each);
    for ((given, expected), found) in cases.iter().zip(found.chunks(each)) {
        let found: Vec<f32> = found.iter().map(|word| f32::from_bits(*word)).collect();
        if let Some(k) = differs(&found, expected, tolerance) {
            panic!("number {k} of {given:?}: {found:?} in place of {expected:?}");
        }
    }
}

/// The first number that is off by more than the tolerance, which is relative from 1 on.
fn differs(found: &[f32], expected: &[f32], tolerance: f32) -> Option<usize> {
    let off = |(found, expected): (&f32, &f32)| {
        let most = tolerance * expected.abs().max(1.0);
        // NaN is off.
        (found - expected).abs() <= most
    };
    found.iter().zip(expected).position(|pair| !off(pair))
}

pub fn words(numbers: &[f32]) -> Vec<u32> {
    numbers.iter().map(|number| number.to_bits()).collect()
}

#[test]
fn what_differs_is_found() {
    assert_eq!(differs(&[1.0, 2.0], &[1.0, 2.0], 1e-6), None);
    assert_eq!(differs(&[1.0, 2.1], &[1.0, 2.0], 0.01), Some(1));
    assert_eq!(differs(&[f32::NAN, 2.0], &[1.0, 2.0], 0.01), Some(0));
    assert_eq!(differs(&[0.02], &[0.0], 0.01), Some(0));
}

const LAW: &str = "
#import dolomite::vegetation::density::ramp
#import dolomite::vegetation::law::{cover_share, drawn_share, entered, evened, kept_share, left_share, mean_entered}
#import dolomite::vegetation::law::{settled_share, widened}
struct Case { reach: vec4<f32>, distance: f32, part: f32, pad: vec2<f32> }
@group(0) @binding(0) var<storage, read> given: array<Case>;
@group(0) @binding(1) var<storage, read_write> found: array<f32>;
@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
    if 10u * id.x >= arrayLength(&found) { return; }
    let case_ = given[id.x];
    let d = case_.distance;
    let out = array(kept_share(case_.reach, d), left_share(case_.reach, d), drawn_share(case_.reach, d),
        entered(case_.part), mean_entered(case_.part), widened(case_.reach, d, entered(case_.part)),
        cover_share(case_.reach, d), ramp(d, case_.reach.x, case_.reach.w, case_.part),
        evened(case_.part, kept_share(case_.reach, d)), settled_share(case_.reach, d));
    for (var k = 0u; k < 10u; k++) { found[10u * id.x + k] = out[k]; }
}
";

#[test]
fn the_law_is_that_of_rust_gpu() {
    let mut random = Random(31);
    let mut unit = || random.unit() as f32;
    let cases: Vec<_> = (0..4096)
        .map(|_| {
            let law = Law::new(
                0.002 + 0.1 * unit(),
                200.0 + 1500.0 * unit(),
                400.0 * unit(),
            );
            let (distance, part) = (600.0 * unit() * unit(), 1.6 * unit());
            let come = law::entered(part);
            let given = [
                law.first, law.second, law.fade, law.reach, distance, part, 0.0, 0.0,
            ];
            let expected = vec![
                law.kept(distance),
                law.left(distance),
                law.drawn(distance),
                come,
                law::mean_entered(part),
                law.widened(distance, come),
                law.cover(distance),
                ramp(distance, law.first, law.reach, part),
                law::evened(part, law.kept(distance)),
                law.settled(distance),
            ];
            (words(&given), expected)
        })
        .collect();
    // Up to five divisions in a row, of which WGSL grants 2.5 ulp each, and as many products: 2e-6 of a number; where one
    // less the other is small, of the greater. A fade of which a metre is all multiplies it by some ten.
    compare(LAW, &cases, 2e-5);
}

const STRAIGHT: &str = "
#import dolomite::vegetation::colour::far_place
#import dolomite::vegetation::straight::{straight_along, straight_bow, straight_wider}
@group(0) @binding(0) var<storage, read> given: array<vec4<f32>>;
@group(0) @binding(1) var<storage, read_write> found: array<f32>;
@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
    if 4u * id.x >= arrayLength(&found) { return; }
    let g = given[id.x];
    let bow = straight_bow(g.x, g.y, g.z);
    let out = array(straight_wider(g.x, g.y), bow, straight_along(g.w, bow), far_place(g.y));
    for (var k = 0u; k < 4u; k++) { found[4u * id.x + k] = out[k]; }
}
";

#[test]
fn straight_strips_are_those_of_rust_gpu() {
    let mut random = Random(34);
    let mut unit = || random.unit() as f32;
    let cases: Vec<_> = (0..4096)
        .map(|_| {
            let [droop, sine, depth, place] =
                [unit(), 0.003 + 0.997 * unit(), 2.0 * unit(), unit()];
            let bow = straight::bow(droop, sine, depth);
            let (entry, part) = shade::entry_of(sine);
            let expected = vec![
                straight::wider(droop, sine),
                bow,
                straight::along(place, bow),
                entry as f32 + part,
            ];
            (words(&[droop, sine, depth, place]), expected)
        })
        .collect();
    // The logarithm's error, 3 ulp of up to 8, and a quotient's; a fourth of that in the bow.
    compare(STRAIGHT, &cases, 1e-5);
}

const THROUGH: &str = "
#import dolomite::vegetation::colour::lit_through
struct Case { normal: vec3<f32>, share: f32, sun: vec3<f32> }
@group(0) @binding(0) var<storage, read> given: array<Case>;
@group(0) @binding(1) var<storage, read_write> found: array<f32>;
@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
    if 3u * id.x >= arrayLength(&found) { return; }
    let case_ = given[id.x];
    let lit = lit_through(case_.normal, case_.sun, case_.share);
    for (var k = 0u; k < 3u; k++) { found[3u * id.x + k] = lit[k]; }
}
";

#[test]
fn light_from_behind_is_that_of_rust_gpu() {
    let mut random = Random(35);
    let mut unit = || random.unit() as f32;
    let cases: Vec<_> = (0..2048)
        .map(|k| {
            let mut direction =
                || Vec3::new(unit() - 0.5, unit() - 0.5, unit() - 0.5).normalize_or(Vec3::Y);
            let sun = direction();
            // Every eighth sun stands straight behind.
            let normal = if k % 8 == 0 { -sun } else { direction() };
            let share = unit();
            let given = [
                normal.x, normal.y, normal.z, share, sun.x, sun.y, sun.z, 0.0,
            ];
            let lit = lit_through(normal, sun, share);
            (words(&given), lit.to_array().to_vec())
        })
        .collect();
    // What is aside is normalised, from a length of a thousandth on: 2^-24 of the normal is 6e-5 of that.
    compare(THROUGH, &cases, 1e-4);
}

const WIND: &str = "
#import dolomite::vegetation::wind::{WindField, water_moved, wind_on_blade, wind_strength}
struct Case { field: WindField, at: vec2<f32>, own: f32, depth: f32 }
@group(0) @binding(0) var<storage, read> given: array<Case>;
@group(0) @binding(1) var<storage, read_write> found: array<f32>;
@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
    if 8u * id.x >= arrayLength(&found) { return; }
    let field = given[id.x].field;
    let at = given[id.x].at;
    let slow = wind_on_blade(field, at, given[id.x].own, false);
    let fast = wind_on_blade(field, at, given[id.x].own, true);
    let moved = water_moved(field, at, given[id.x].depth);
    let out = array(wind_strength(field, at), slow.x, slow.y, fast.x, fast.y, moved.x, moved.y, moved.z);
    for (var k = 0u; k < 8u; k++) { found[8u * id.x + k] = out[k]; }
}
";

#[test]
fn wind_and_swell_are_those_of_rust_gpu() {
    let mut random = Random(32);
    let mut unit = || random.unit() as f32;
    let cases: Vec<_> = (0..2048)
        .map(|_| {
            let wind = Wind {
                towards: f64::from(6.3 * unit()),
                speed: 12.0 * unit(),
                gusts: unit(),
                swell: 3.0 * unit(),
            };
            let anchor = GroundPoint::new(DVec2::new(1e4, -3e5));
            let field = WindField::new(&wind, anchor, f64::from(1e4 * unit()));
            let at = Vec2::new(60.0 * unit() - 30.0, 60.0 * unit() - 30.0);
            let (own, depth) = (unit(), 30.0 * unit() - 1.0);
            let mut given: Vec<u32> = bytemuck::cast_slice(&[field]).to_vec();
            given.extend(words(&[at.x, at.y, own, depth]));
            let [slow, fast] = [false, true].map(|fast| field.on_blade(at, own, fast));
            let moved = field.in_water(at, depth);
            let expected = vec![
                field.strength(at),
                slow.x,
                slow.y,
                fast.x,
                fast.y,
                moved.x,
                moved.y,
                moved.z,
            ];
            (given, expected)
        })
        .collect();
    // WGSL grants sin and cos an error of 2^-11, of numbers up to some 10 m/s; the strength is up to 1.5 times as steep
    // as the sum of the waves, whose weights sum to 1.
    compare(WIND, &cases, 1.5 / 2048.0 * 2.0);
}

const PRESS: &str = "
#import dolomite::vegetation::press::{Press, pressed_by}
struct Case { press: Press, root: vec3<f32>, long: f32, lean: vec2<f32>, pad: vec2<f32> }
@group(0) @binding(0) var<storage, read> given: array<Case>;
@group(0) @binding(1) var<storage, read_write> found: array<f32>;
@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
    if 2u * id.x >= arrayLength(&found) { return; }
    let lean = pressed_by(given[id.x].press, given[id.x].lean, given[id.x].root, given[id.x].long);
    found[2u * id.x] = lean.x;
    found[2u * id.x + 1u] = lean.y;
}
";

#[test]
fn presses_are_those_of_rust_gpu() {
    let mut random = Random(33);
    let mut unit = || random.unit() as f32;
    let mut pressed = 0;
    let cases: Vec<_> = (0..4096)
        .map(|_| {
            let mut place = |most: f32| Vec3::new(unit() - 0.5, unit() - 0.5, unit() - 0.5) * most;
            let (foot, root) = (place(2.0), place(2.0));
            let press = Press {
                foot: foot.to_array(),
                radius: 0.2 + 0.3 * unit(),
                strength: unit(),
                rest: [0.0; 3],
            };
            let long = 0.1 + unit();
            let lean = Vec2::new(unit() - 0.5, unit() - 0.5);
            let mut given: Vec<u32> = bytemuck::cast_slice(&[press]).to_vec();
            given.extend(words(&root.to_array()));
            given.extend(words(&[long, lean.x, lean.y, 0.0, 0.0]));
            let after = dolomite_vegetation::bend::pressed(lean, root, long, &[press]);
            pressed += u32::from(after != lean);
            (given, vec![after.x, after.y])
        })
        .collect();
    assert!(pressed > 500, "{pressed} are pressed");
    // Lengths and quotients, a few ulp each; the square root of what is near 0 multiplies them by some ten.
    compare(PRESS, &cases, 5e-5);
}
