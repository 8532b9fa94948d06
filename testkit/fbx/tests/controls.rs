//! The check sees faults: each of these breaks a result that holds, as a converter would break it.

use dolomite_fbx::{Conversion, Report};
use dolomite_fbx_search::hold::{converted, hold_result};
use dolomite_fbx_search::scene::{
    Asked, Axis, Camera, Container, Curve, Key, Layer, Mesh, Node, Shows, Stack, TICKS, Target,
    Track, Way,
};
use dolomite_fbx_search::shrink::shrink;
use dolomite_fbx_search::{Failure, Scene, Seen};
use serde_json::Value;

fn track(target: Target, axis: usize, keys: &[(f64, f32)]) -> Track {
    let key = |&(time, value): &(f64, f32)| Key {
        time: (time * TICKS as f64) as i64,
        value,
        way: Way::Linear,
        weights: None,
        velocity: false,
    };
    let mut track = Track {
        target,
        curves: [None, None, None],
        without: [0.0; 3],
    };
    track.curves[axis] = Some(Curve::of(keys.iter().map(key).collect()));
    track
}

/// A plate of a metre that goes there and back, and below it one that turns, in two layers.
fn plates() -> Scene {
    let mut nodes = vec![
        Node::plain("n0", None),
        Node::plain("n1", Some(0)),
        Node::plain("n2", None),
    ];
    nodes[0].shows = Shows::Mesh(0);
    nodes[1].shows = Shows::Mesh(1);
    nodes[1].translation = [0.0, 50.0, 0.0];
    nodes[2].shows = Shows::Camera(Camera {
        perspective: true,
        angle: 40.0,
        aspect: [4.0, 3.0],
        near: 10.0,
        far: 10_000.0,
    });
    let plate = || Mesh {
        points: vec![
            [0.0, 0.0, 0.0],
            [100.0, 0.0, 0.0],
            [100.0, 100.0, 10.0],
            [0.0, 100.0, 0.0],
        ],
        faces: vec![vec![0, 1, 2, 3]],
        channels: Vec::new(),
        skin: Vec::new(),
        material: None,
    };
    let base = Layer::plain(vec![
        track(
            Target::Translation(0),
            0,
            &[(0.0, 0.0), (1.0, 80.0), (2.0, 10.0)],
        ),
        track(
            Target::Rotation(1),
            2,
            &[(0.0, 0.0), (1.0, 60.0), (2.0, -20.0)],
        ),
    ]);
    let upper = Layer {
        weight: 50.0,
        ..Layer::plain(vec![track(
            Target::Rotation(1),
            2,
            &[(0.0, 0.0), (2.0, 40.0)],
        )])
    };
    Scene {
        asked: Asked {
            max_error: 1e-4,
            within_frames: true,
            eight: false,
            thorough: false,
        },
        container: Container::Ascii,
        version: 7400,
        unit: 1.0,
        axes: [0, 1, 2].map(|axis| Axis { axis, sign: 1 }),
        time_mode: 6,
        nodes,
        meshes: vec![plate(), plate()],
        materials: Vec::new(),
        stacks: vec![Stack {
            name: "s0".into(),
            start: 0,
            stop: 2 * TICKS,
            layers: vec![base, upper],
        }],
    }
}

fn made(scene: &Scene) -> Conversion {
    converted(scene).expect("no panic").expect("a sound file")
}

fn held(scene: &Scene, made: &Conversion, report: &Report, glb: &[u8]) -> Result<Seen, Failure> {
    hold_result(scene, report, &made.sources(), glb, 1)
}

/// Of a result for `scene` that `change` breaks.
fn kind_of(change: impl FnOnce(&mut Scene, &mut Report, &mut Glb)) -> &'static str {
    let mut scene = plates();
    let made = made(&scene);
    let bytes = made.to_glb().expect("a .glb");
    held(&scene, &made, &made.report, &bytes).expect("what is not broken holds");
    let mut report = made.report.clone();
    let mut glb = Glb::read(&bytes);
    change(&mut scene, &mut report, &mut glb);
    held(&scene, &made, &report, &glb.write()).map_or_else(|failure| failure.kind, |_| "nothing")
}

/// A .glb that can be written to.
struct Glb {
    json: Value,
    numbers: Vec<u8>,
}

impl Glb {
    fn read(bytes: &[u8]) -> Self {
        let word = |at: usize| {
            u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes")) as usize
        };
        let length = word(12);
        Self {
            json: serde_json::from_slice(&bytes[20..20 + length]).expect("JSON"),
            numbers: bytes[28 + length..28 + length + word(20 + length)].to_vec(),
        }
    }

    fn write(&self) -> Vec<u8> {
        let mut json = self.json.to_string().into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut out = b"glTF".to_vec();
        let total = 28 + json.len() + self.numbers.len();
        out.extend(
            [2, total as u32, json.len() as u32]
                .into_iter()
                .flat_map(u32::to_le_bytes),
        );
        out.extend(b"JSON");
        out.extend(json);
        out.extend((self.numbers.len() as u32).to_le_bytes());
        out.extend(b"BIN\0");
        out.extend(&self.numbers);
        out
    }

    /// Where an accessor's bytes are, how many keys it has, and bytes of each.
    fn place(&self, accessor: u64) -> (usize, usize, usize) {
        let accessor = &self.json["accessors"][accessor as usize];
        let view =
            &self.json["bufferViews"][accessor["bufferView"].as_u64().expect("a view") as usize];
        let offset = |of: &Value| of["byteOffset"].as_u64().unwrap_or(0) as usize;
        let parts = match accessor["type"].as_str() {
            Some("SCALAR") => 1,
            Some("VEC3") => 3,
            _ => 4,
        };
        let bytes = if accessor["componentType"] == 5126 {
            4
        } else {
            2
        };
        let count = accessor["count"].as_u64().expect("a count") as usize;
        (offset(view) + offset(accessor), count, parts * bytes)
    }

    /// The first channel that moves so: its times and its values.
    fn channel(&self, path: &str) -> [u64; 2] {
        let clip = &self.json["animations"][0];
        let channels = clip["channels"].as_array().expect("channels");
        let channel = channels
            .iter()
            .find(|channel| channel["target"]["path"] == path)
            .expect("one of this kind");
        let sampler = &clip["samplers"][channel["sampler"].as_u64().expect("a sampler") as usize];
        ["input", "output"].map(|end| sampler[end].as_u64().expect("an accessor"))
    }
}

#[test]
fn a_key_that_is_lost_is_seen() {
    let kind = kind_of(|_, _, glb| {
        let channel = glb.channel("translation");
        for accessor in channel {
            let (start, count, bytes) = glb.place(accessor);
            assert_eq!(count, 3, "straight ways of three keys");
            let last = start + 2 * bytes;
            glb.numbers.copy_within(last..last + bytes, start + bytes);
            glb.json["accessors"][accessor as usize]["count"] = 2.into();
        }
    });
    assert!(kind == "node" || kind == "vertex", "{kind}");
}

#[test]
fn a_key_that_is_a_millimetre_off_is_seen() {
    let kind = kind_of(|_, _, glb| {
        let [_, values] = glb.channel("translation");
        let (start, _, bytes) = glb.place(values);
        let at = start + bytes;
        let x = f32::from_le_bytes(glb.numbers[at..at + 4].try_into().expect("four bytes"));
        glb.numbers[at..at + 4].copy_from_slice(&(x + 1e-3).to_le_bytes());
    });
    assert!(kind == "node" || kind == "vertex", "{kind}");
}

#[test]
fn a_model_that_is_a_hundredth_too_large_is_seen() {
    let kind = kind_of(|_, _, glb| {
        let nodes = glb.json["nodes"].as_array_mut().expect("nodes");
        nodes
            .iter_mut()
            .filter(|node| node["name"] == "n0")
            .for_each(|node| {
                node["scale"] = serde_json::json!([1.01, 1.01, 1.01]);
            });
    });
    assert_eq!(kind, "rest");
}

#[test]
fn layers_that_are_heard_though_they_are_not_are_seen() {
    let changes: [fn(&mut Layer); 6] = [
        |upper| upper.mute = true,
        |upper| upper.solo = true,
        |upper| upper.weight = 100.0,
        |upper| upper.blend = Some(1),
        |upper| upper.blend = Some(2),
        |upper| {
            upper.weight_curve =
                track(Target::Percent(0, 0), 0, &[(0.0, 0.0), (2.0, 100.0)]).curves[0].clone()
        },
    ];
    for (number, change) in changes.into_iter().enumerate() {
        let kind = kind_of(|scene, _, _| change(&mut scene.stacks[0].layers[1]));
        assert!(
            kind == "node" || kind == "vertex",
            "change {number}: {kind}"
        );
    }
}

#[test]
fn a_file_read_otherwise_is_seen() {
    assert_eq!(kind_of(|scene, _, _| scene.unit = 2.54), "rest");
    assert_eq!(kind_of(|scene, _, _| scene.axes[2].sign = -1), "rest");
    assert_eq!(
        kind_of(|scene, _, _| scene.nodes[1].scaling[1] = 1.01),
        "rest"
    );
    assert_eq!(kind_of(|scene, _, _| scene.nodes[1].parent = None), "node");
    assert_eq!(
        kind_of(|scene, _, _| scene.stacks[0].stop += TICKS / 100),
        "length"
    );
    assert_eq!(
        kind_of(|scene, _, _| scene.stacks[0].name.push('x')),
        "clips"
    );
    let far = |scene: &mut Scene, _: &mut Report, _: &mut Glb| {
        if let Shows::Camera(camera) = &mut scene.nodes[2].shows {
            camera.far = 100.0;
        }
    };
    assert_eq!(kind_of(far), "camera");
    assert_eq!(
        kind_of(|scene, _, _| scene.nodes[0].user = Some(1.0)),
        "user"
    );
    assert_eq!(
        kind_of(|scene, _, _| scene.nodes[0].hidden = true),
        "hidden"
    );
}

#[test]
fn an_error_a_little_above_what_is_stated_is_seen() {
    let kind = kind_of(|_, report, glb| {
        let [_, values] = glb.channel("translation");
        let (start, _, bytes) = glb.place(values);
        let at = start + bytes;
        let x = f32::from_le_bytes(glb.numbers[at..at + 4].try_into().expect("four bytes"));
        // Things reach some two metres.
        let little = (report.clips[0].error + 1e-5) as f32;
        glb.numbers[at..at + 4].copy_from_slice(&(x + little).to_le_bytes());
    });
    assert!(kind == "node" || kind == "vertex", "{kind}");
}

#[test]
fn what_fails_becomes_small() {
    // As if steps whose value is the next key's did not hold.
    fn property(scene: &Scene, _: u64) -> Result<Seen, Failure> {
        let curves = scene
            .stacks
            .iter()
            .flat_map(|stack| &stack.layers)
            .flat_map(Layer::curves);
        match curves
            .flat_map(|curve| &curve.keys)
            .any(|key| key.way == Way::ConstantNext)
        {
            true => Err(Failure {
                kind: "step",
                detail: String::new(),
            }),
            false => Ok(Seen::default()),
        }
    }
    let seed = (0..)
        .find(|&seed| property(&dolomite_fbx_search::generate(seed), seed).is_err())
        .expect("some file");
    let scene = dolomite_fbx_search::generate(seed);
    let failure = property(&scene, seed).expect_err("it was found so");
    let (small, _) = shrink(&scene, seed, &failure, property, 2000);
    assert_eq!(
        (small.stacks.len(), small.nodes.len()),
        (1, 1),
        "{small:#?}"
    );
    let keys = |scene: &Scene| {
        scene
            .stacks
            .iter()
            .flat_map(|s| &s.layers)
            .flat_map(Layer::curves)
            .map(|c| c.keys.len())
            .sum::<usize>()
    };
    assert_eq!(keys(&small), 1, "{small:#?}");
    assert_eq!(small.container, Container::Ascii);
}
