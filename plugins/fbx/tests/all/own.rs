//! Files of our own, whose every vertex is known.

use crate::support::ascii::strip;
use crate::support::chain::{chain, chain_with};
use dolomite_fbx::check::{Played, Truth, vertex_error};
use dolomite_fbx::model::{Interpolation, Property};
use dolomite_fbx::{Conversion, FbxError, Limits, Options, Origin, Weights, convert};
use glam::{DQuat, DVec3};

fn converted(text: &str) -> Conversion {
    convert(text.as_bytes(), &Origin::default(), &Options::default())
        .expect("a file of our own is sound")
}

/// Centimetres, Z up, to metres, Y up.
fn from_file(p: DVec3) -> DVec3 {
    DVec3::new(p.x, p.z, -p.y) * 0.01
}

/// Where vertex `index` of the strip is when `tip` is turned by `angle` and `bulge` lifts the middle.
fn place(index: usize, angle: f64, lift: f64) -> DVec3 {
    let x = if index.is_multiple_of(2) { 0.0 } else { 20.0 };
    let row = index / 2;
    let rest = DVec3::new(x, 10.0 * row as f64, if row == 1 { lift } else { 0.0 });
    let pivot = DVec3::new(0.0, 20.0, 0.0);
    let turned = DQuat::from_rotation_x(angle) * (rest - pivot) + pivot;
    from_file(match row {
        0 => rest,
        1 => rest.midpoint(turned),
        _ => turned,
    })
}

#[test]
fn every_vertex_is_where_it_belongs() {
    let made = converted(&strip(90.0));
    let glb = made.to_glb().unwrap();
    let played = Played::read(&glb).unwrap();
    let (_, sources) = &made.sources()[&0];
    // The channel's weight grows straight: shapes at 50 % and 100 % lift by 1 and by 4.
    for (share, lift) in [(0.0, 0.0), (0.25, 0.5), (0.5, 1.0), (0.75, 2.5), (1.0, 4.0)] {
        let (shapes, _) = played.at(Some(0), share);
        let angle = 90_f64.to_radians() * share;
        for (&source, point) in sources.iter().zip(&shapes[0].points) {
            let wanted = place(source as usize, angle, lift);
            let off = (*point - wanted).length();
            // The default bound: 5e-6 of a strip of 0.28 m and something for the middles.
            assert!(off < 3e-6, "vertex {source} at {share}: {off:e} m");
        }
    }
}

#[test]
fn the_report_says_what_was_made() {
    let report = converted(&strip(90.0)).report;
    assert_eq!((report.version, report.unit), (7400, 0.01));
    assert_eq!((report.joints, report.triangles), (2, 4));
    assert_eq!(report.clips.len(), 1);
    let clip = &report.clips[0];
    assert_eq!((clip.name.as_str(), clip.seconds), ("bend", 1.0));
    assert!(
        clip.error <= report.bound && report.lost.is_empty(),
        "{report:?}"
    );
    assert!(clip.keys < clip.baked);
}

#[test]
fn in_betweens_are_kinks_in_weights_that_stay() {
    let made = converted(&strip(0.0));
    let weights = made.model.clips[0]
        .channels
        .iter()
        .find(|c| c.property == Property::Weights)
        .unwrap();
    assert_ne!(weights.interpolation, Interpolation::Step);
    assert_eq!(weights.values.len() % 2, 0);
    assert!(weights.times.contains(&0.5), "{:?}", weights.times);
}

#[test]
fn a_larger_error_takes_no_more_keys() {
    let keys = |max_error: f64| {
        let options = Options {
            max_error,
            max_relative_error: f64::INFINITY,
            ..Options::default()
        };
        convert(strip(170.0).as_bytes(), &Origin::default(), &options)
            .unwrap()
            .report
            .animation_bytes
    };
    assert!(keys(1e-2) <= keys(1e-4) && keys(1e-4) <= keys(1e-6));
}

#[test]
fn eight_weights_need_no_second_set_where_four_will_do() {
    let options = Options {
        weights: Weights::Eight,
        ..Options::default()
    };
    let made = convert(strip(10.0).as_bytes(), &Origin::default(), &options).unwrap();
    assert_eq!(made.model.meshes[0].parts[0].joints.len(), 1);
}

#[test]
fn gltf_with_files_holds_the_same() {
    let made = converted(&strip(45.0));
    let files = made.to_gltf("strip one");
    assert_eq!(files.files[0].0, "strip_one.bin");
    let json = String::from_utf8(files.json).unwrap();
    assert!(json.contains("\"uri\":\"strip_one.bin\""), "{json}");
    let glb = made.to_glb().unwrap();
    assert!(glb.windows(64).any(|w| w == &files.files[0].1[..64]));
}

#[test]
fn limits_and_options_are_kept() {
    let text = strip(90.0);
    let with =
        |options: Options| convert(text.as_bytes(), &Origin::default(), &options).unwrap_err();
    let limits = |memory, work| Options {
        limits: Some(Limits { memory, work }),
        ..Options::default()
    };
    assert!(matches!(
        with(limits(4096, 1 << 24)),
        FbxError::Memory { .. }
    ));
    assert!(matches!(with(limits(1 << 24, 0)), FbxError::Work { .. }));
    let wrong = Options {
        max_error: -1.0,
        ..Options::default()
    };
    assert!(matches!(with(wrong), FbxError::Option { .. }));
}

/// Offsets, pivots and a scale at rest.
const PIVOTS: &str = "\t\t\tP: \"Lcl Scaling\", \"Lcl Scaling\", \"\", \"A\",1.4,0.7,1.2
\t\t\tP: \"RotationOffset\", \"Vector3D\", \"\", \"\",3,-2,1
\t\t\tP: \"RotationPivot\", \"Vector3D\", \"\", \"\",-4,5,2
\t\t\tP: \"ScalingOffset\", \"Vector3D\", \"\", \"\",1,6,-3
\t\t\tP: \"ScalingPivot\", \"Vector3D\", \"\", \"\",7,-1,4
";

/// How scale is inherited, in all 27 ways that three nodes can: against ufbx, which knows no helper
/// nodes there. Pivots and offsets are scaled as places are, whether parents are listed first or last.
#[test]
fn scale_is_inherited_in_every_way() {
    for code in 0..27 {
        let inherit = [code % 3, code / 3 % 3, code / 9];
        inherits(inherit, &chain(inherit));
        inherits(inherit, &chain_with(inherit, &[0, 1, 2], PIVOTS));
        inherits(inherit, &chain_with(inherit, &[2, 1, 0], PIVOTS));
    }
}

fn inherits(inherit: [i32; 3], text: &str) {
    let made = converted(text);
    let played = Played::read(&made.to_glb().expect("it can be written")).expect("it is a .glb");
    let truth = Truth::load(text.as_bytes(), &Origin::default()).expect("it is sound");
    let report = &made.report;
    let steps = (0..=40).map(|step| Some(f64::from(step) / 40.0));
    for time in steps.chain([None]) {
        let clip = time.map(|_| 0);
        let (shapes, _) = played.at(clip, time.unwrap_or(0.0));
        let (bodies, _) = truth
            .at(clip, time.unwrap_or(0.0))
            .expect("it can be posed");
        assert_eq!((shapes.len(), bodies.len()), (3, 3));
        let error = vertex_error(&shapes, &bodies, &truth.space(), &made.sources());
        let stated = time.map_or(0.0, |_| report.bound);
        let allowed = stated + 1e-6 * report.size;
        assert!(
            error <= allowed,
            "{inherit:?} at {time:?}: {error:e} m, {allowed:e} allowed"
        );
    }
}
