//! Keys and seams that glTF's times in f32 stand beside: two files that stated errors were below the true ones of.

use dolomite_fbx_search::hold;
use dolomite_fbx_search::scene::{
    Asked, Axis, Beyond, Container, Curve, Key, Layer, Node, Scene, Stack, Target, Track, Way,
};

fn track(target: Target, axis: usize, keys: &[(i64, f32, Way)], before: Beyond) -> Track {
    let key = |(time, value, way): &(i64, f32, Way)| Key {
        time: *time,
        value: *value,
        way: *way,
        weights: None,
        velocity: false,
    };
    let mut curve = Curve::of(keys.iter().map(key).collect());
    curve.beyond[0] = before;
    let mut track = Track {
        target,
        curves: [None, None, None],
        without: [0.0; 3],
    };
    track.curves[axis] = Some(curve);
    track
}

/// Metres, and a node a way below another.
fn scene(span: [i64; 2], tracks: Vec<Track>) -> Scene {
    let mut nodes = vec![Node::plain("n0", None), Node::plain("n1", Some(0))];
    nodes[1].translation = [-1.0, -3.0, -1.0];
    Scene {
        asked: Asked {
            max_error: 1e-4,
            within_frames: false,
            eight: false,
            thorough: false,
        },
        container: Container::Ascii,
        version: 7400,
        unit: 100.0,
        axes: [0, 1, 2].map(|axis| Axis { axis, sign: 1 }),
        time_mode: 6,
        nodes,
        meshes: Vec::new(),
        materials: Vec::new(),
        stacks: vec![Stack {
            name: "s0".into(),
            start: span[0],
            stop: span[1],
            layers: vec![Layer::plain(tracks)],
        }],
    }
}

/// Twelve metres in the last five milliseconds of a clip: between neighbouring times of f32 these are a millimetre, so that the
/// clip is made again with keys on both sides of the file's.
#[test]
fn a_line_that_begins_between_two_keys_of_the_result() {
    let (begin, key, end) = (281_227_516_062, 471_338_417_601, 471_578_466_167);
    let lines = [(key, -9.0, Way::Linear), (end, 3.0, Way::Linear)];
    let step = [
        (259_820_986_141, -73.0, Way::Constant),
        (end, -61.0, Way::Linear),
    ];
    let tracks = vec![
        track(Target::Translation(0), 0, &lines, Beyond::Stays),
        track(Target::Rotation(0), 2, &step, Beyond::Stays),
    ];
    let seen = hold(&scene([begin, end], tracks), 1);
    assert!(seen.is_ok_and(|seen| seen.worst > 0.5));
    let alone = vec![track(Target::Translation(0), 0, &lines, Beyond::Stays)];
    let seen = hold(&scene([begin, end], alone), 1);
    assert!(seen.is_ok_and(|seen| seen.worst > 0.5));
}

/// The seam before the first key is that key, and what jumps there is no motion between keys.
#[test]
fn a_seam_of_a_curve_that_repeats() {
    let keys = [
        (4_799_100_058, 14.0, Way::Linear),
        (11_405_731_516, 3.0, Way::Linear),
    ];
    let tracks = vec![track(Target::Rotation(0), 2, &keys, Beyond::Again(-1))];
    let scene = scene([0, 32_582_053_172], tracks);
    let seen = hold(&scene, 1);
    assert!(seen.is_ok(), "{seen:?}");
    let made = dolomite_fbx_search::hold::converted(&scene);
    let report = made.expect("no panic").expect("a sound file").report;
    assert!(report.error() < 1e-4, "{} m", report.error());
}
