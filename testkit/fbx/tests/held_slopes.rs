//! Automatic slopes that keep a curve between its keys: a file that a stated error was below the true one of.

use dolomite_fbx_search::hold;
use dolomite_fbx_search::scene::{
    Asked, Axis, Clamp, Container, Curve, Key, Layer, Node, Scene, Stack, Target, Track, Way,
};

/// Spins of thousands of degrees, five metres out, where a millionth of a slope is 20 micrometres.
#[test]
fn a_slope_that_is_held_back_is_what_the_file_means() {
    let held = Way::Auto {
        clamp: Clamp::Progressive,
        time_independent: false,
    };
    let keys = [
        (733_667_119_830, 251.0, Way::Linear),
        (740_809_981_347, 3375.0, held),
        (757_471_569_363, 3991.0, Way::Linear),
    ];
    let key = |(time, value, way)| Key {
        time,
        value,
        way,
        weights: None,
        velocity: false,
    };
    let track = Track {
        target: Target::Rotation(0),
        curves: [None, None, Some(Curve::of(keys.map(key).to_vec()))],
        without: [0.0; 3],
    };
    let mut node = Node::plain("n0", None);
    node.scaling_offset = [0.0, -5.0, -1.0];
    let scene = Scene {
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
        nodes: vec![node],
        meshes: Vec::new(),
        materials: Vec::new(),
        stacks: vec![Stack {
            name: "s0".into(),
            start: 733_667_119_830,
            stop: 826_302_672_217,
            layers: vec![Layer::plain(vec![track])],
        }],
    };
    for seed in 3_001_493..3_001_497 {
        let seen = hold(&scene, seed);
        assert!(seen.is_ok(), "{seen:?}");
    }
}
