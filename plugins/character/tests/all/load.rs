//! glTF files: what is read, and that broken ones are refused.

use crate::support;

use bevy::math::Vec3;
use dolomite_character::{LoadError, Pose, Rig, Sampler};
use support::Random;

/// A file of two joints, a skin, a triangle and a clip of each interpolation, made here.
fn small_glb() -> Vec<u8> {
    let mut bin: Vec<u8> = Vec::new();
    let mut views = Vec::new();
    let mut put = |numbers: &[f32]| {
        let at = bin.len();
        numbers
            .iter()
            .for_each(|number| bin.extend(number.to_le_bytes()));
        views.push((at, numbers.len() * 4));
        views.len() - 1
    };
    let times = put(&[0.0, 0.5, 1.0]);
    let ways = put(&[0.0, 1.0, 0.0, 0.0, 2.0, 0.0, 0.0, 1.0, 0.0]);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let turns = put(&[0.0, 0.0, 0.0, 1.0, 0.0, half, 0.0, half, 0.0, 0.0, 0.0, 1.0]);
    let mut spline = Vec::new();
    for value in [1.0, 2.0, 1.0] {
        spline.extend([0.0, 0.0, 0.0, value, value, value, 0.0, 0.0, 0.0]);
    }
    let sizes = put(&spline);
    let identity = [
        1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
    ];
    let binds = put(&[identity, identity].concat());
    let positions = put(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    let weights = put(&[1.0, 0.0, 0.0, 0.0, 0.5, 0.5, 0.0, 0.0, 2.0, 2.0, 0.0, 0.0]);
    let joints = put(&[
        f32::from_bits(0x0000_0100),
        f32::from_bits(0x0000_0100),
        f32::from_bits(0x0000_0100),
    ]);
    let view = |(at, length): &(usize, usize)| {
        format!(r#"{{"buffer":0,"byteOffset":{at},"byteLength":{length}}}"#)
    };
    let list: Vec<String> = views.iter().map(view).collect();
    let accessor = |view: usize, kind: u32, count: usize, shape: &str, more: &str| {
        format!(
            r#"{{"bufferView":{view},"componentType":{kind},"count":{count},"type":"{shape}"{more}}}"#
        )
    };
    let accessors = [
        accessor(times, 5126, 3, "SCALAR", r#","min":[0],"max":[1]"#),
        accessor(ways, 5126, 3, "VEC3", ""),
        accessor(turns, 5126, 3, "VEC4", ""),
        accessor(sizes, 5126, 9, "VEC3", ""),
        accessor(binds, 5126, 2, "MAT4", ""),
        accessor(
            positions,
            5126,
            3,
            "VEC3",
            r#","min":[0,0,0],"max":[1,1,0]"#,
        ),
        accessor(weights, 5126, 3, "VEC4", ""),
        accessor(joints, 5121, 3, "VEC4", ""),
    ];
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0,3]}}],
"nodes":[{{"name":"rig","children":[1]}},{{"name":"hips","children":[2],"translation":[0,1,0]}},
{{"name":"head","translation":[0,0.5,0]}},{{"name":"body","mesh":0,"skin":0}}],
"skins":[{{"joints":[1,2],"inverseBindMatrices":4}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":5,"WEIGHTS_0":6,"JOINTS_0":7}}}}]}}],
"animations":[{{"name":"all","channels":[
{{"sampler":0,"target":{{"node":1,"path":"translation"}}}},
{{"sampler":1,"target":{{"node":1,"path":"rotation"}}}},
{{"sampler":2,"target":{{"node":2,"path":"scale"}}}}],
"samplers":[{{"input":0,"output":1,"interpolation":"STEP"}},{{"input":0,"output":2}},
{{"input":0,"output":3,"interpolation":"CUBICSPLINE"}}]}}],
"accessors":[{}],"bufferViews":[{}],"buffers":[{{"byteLength":{}}}]}}"#,
        accessors.join(","),
        list.join(","),
        bin.len()
    );
    let mut json = json.into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut glb = b"glTF".to_vec();
    let word = |x: usize| (x as u32).to_le_bytes();
    glb.extend(word(2));
    glb.extend(word(12 + 8 + json.len() + 8 + bin.len()));
    glb.extend(word(json.len()));
    glb.extend(b"JSON");
    glb.extend(json);
    glb.extend(word(bin.len()));
    glb.extend(b"BIN\0");
    glb.extend(bin);
    glb
}

fn none(_: &str) -> std::io::Result<Vec<u8>> {
    Err(std::io::Error::other("nothing lies beside it"))
}

#[test]
fn a_small_file_is_read() {
    let rig = Rig::from_bytes(&small_glb(), none).unwrap();
    let names: Vec<&str> = (0..rig.skeleton.len())
        .map(|joint| rig.skeleton.name(joint))
        .collect();
    assert_eq!(names, ["rig", "hips", "head"]);
    assert_eq!(rig.skins[0].joints, [1, 2]);
    assert_eq!(rig.meshes[0].joints[2], [0, 1, 0, 0]);
    assert_eq!(rig.meshes[0].weights[2], [0.5, 0.5, 0.0, 0.0]);
    assert_eq!(rig.meshes[0].indices, [0, 1, 2]);
    let clip = rig.clip("all").unwrap();
    let mut pose = Pose::default();
    Sampler::new().sample(clip, 0.75, &mut pose);
    // A step stays, a slerp is half-way back, a spline without slopes is half-way too.
    assert_eq!(pose.get(1).translation, Vec3::new(0.0, 2.0, 0.0));
    let turned = pose.get(1).rotation * Vec3::Z;
    assert!(
        turned.distance(Vec3::new(0.5_f32.sqrt(), 0.0, 0.5_f32.sqrt())) < 1e-6,
        "{turned}"
    );
    assert!((pose.get(2).scale.x - 1.5).abs() < 1e-6);
}

#[test]
fn every_truncation_and_many_flips_do_no_harm() {
    let whole = small_glb();
    for length in 0..whole.len() {
        assert!(
            Rig::from_bytes(&whole[..length], none).is_err(),
            "{length} bytes"
        );
    }
    let mut random = Random::new(41);
    let mut refused = 0;
    for _ in 0..4000 {
        let mut broken = whole.clone();
        for _ in 0..1 + random.below(3) {
            let at = random.below(broken.len());
            broken[at] ^= 1 << random.below(8);
        }
        match Rig::from_bytes(&broken, none) {
            Err(_) => refused += 1,
            // What is read after all can be played.
            Ok(rig) => {
                let mut pose = Pose::default();
                for clip in &rig.clips {
                    Sampler::new().sample(clip, 0.3, &mut pose);
                }
            }
        }
    }
    assert!(refused > 1000, "{refused}");
}

#[test]
fn refusals_say_what_and_where() {
    let change = |from: &str, to: &str| {
        assert_eq!(from.len(), to.len());
        let mut bytes = small_glb();
        let at = bytes
            .windows(from.len())
            .position(|part| part == from.as_bytes())
            .unwrap();
        bytes[at..at + to.len()].copy_from_slice(to.as_bytes());
        Rig::from_bytes(&bytes, none).unwrap_err()
    };
    assert!(matches!(
        change(r#""children":[2]"#, r#""children":[1]"#),
        LoadError::NotATree(_)
    ));
    let short = change(r#""count":9"#, r#""count":8"#);
    assert!(short.to_string().contains("8 values for 3 keys"), "{short}");
    let kind = change(r#""count":9,"type":"VEC3""#, r#""count":9,"type":"VEC2""#);
    assert!(
        matches!(kind, LoadError::Accessor { accessor: 3, .. }),
        "{kind}"
    );
    let away = Rig::from_bytes(
        br#"{"asset":{"version":"2.0"},"buffers":[{"byteLength":4,"uri":"../a.bin"}]}"#,
        none,
    );
    assert!(away.unwrap_err().to_string().contains("leads out"));
    let empty = Rig::from_bytes(br#"{"asset":{"version":"2.0"}}"#, none).unwrap_err();
    assert!(matches!(empty, LoadError::NothingToMove), "{empty}");
}

#[test]
fn the_soldier_is_read_whole() {
    let Some(rig) = support::knight() else { return };
    assert_eq!(rig.meshes.len(), 6);
    assert!(
        rig.meshes
            .iter()
            .all(|mesh| !mesh.indices.is_empty() && !mesh.normals.is_empty())
    );
    assert!(rig.skeleton.find("hand.l").is_some());
    // Cut short anywhere it is refused.
    let bytes = std::fs::read(support::shared("glb/knight.glb").unwrap()).unwrap();
    for part in 1..40 {
        assert!(Rig::from_bytes(&bytes[..bytes.len() * part / 40], none).is_err());
    }
}
