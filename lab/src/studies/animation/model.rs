//! What is animated: the soldier beside the project, or, where it is absent, a figure made here.

use bevy::math::{Quat, Vec3};
use dolomite_character::{
    Channel, Clip, ClipData, Interpolation, Joint, JointTransform, Rig, Skeleton, Skin,
    SkinnedMesh, Values,
};
use dolomite_testkit::random::Random;
use std::path::{Path, PathBuf};

/// A rig and what it is called.
pub struct Model {
    /// Joints, clips, meshes.
    pub rig: Rig,
    /// For the report.
    pub name: String,
    /// Three clips that are blended.
    pub blended: [usize; 3],
}

impl Model {
    /// The soldier, or the made figure with a note.
    pub fn load(seed: u32) -> (Self, Vec<String>) {
        let folder = std::env::var_os("DOLOMITE_SHARED")
            .map_or_else(|| PathBuf::from("../shared"), PathBuf::from);
        let path = folder.join("data/glb/knight.glb");
        match Self::read(&path) {
            Ok(model) => (model, Vec::new()),
            Err(reason) => {
                let note = format!(
                    "{}: {reason}; a figure made in code stands in its place",
                    path.display()
                );
                (Self::made(seed), vec![note])
            }
        }
    }

    fn read(path: &Path) -> Result<Self, String> {
        let rig = Rig::read(path).map_err(|error| error.to_string())?;
        let find = |name| rig.clips.iter().position(|clip| clip.name() == name);
        let clips = [find("Idle"), find("Walking_A"), find("Running_A")];
        let [Some(a), Some(b), Some(c)] = clips else {
            return Err("it has no Idle, Walking_A and Running_A".into());
        };
        if rig.skins.is_empty() || rig.meshes.is_empty() {
            return Err("it has no skinned mesh".into());
        }
        Ok(Self {
            name: format!(
                "knight.glb: {} joints, {} clips",
                rig.skeleton.len(),
                rig.clips.len()
            ),
            rig,
            blended: [a, b, c],
        })
    }

    /// A figure of 41 joints with 12 clips of one to two seconds, 30 keys a second, and a mesh.
    pub fn made(seed: u32) -> Self {
        let mut random = Random::new(seed);
        let joints = (0..41).map(|index| Joint {
            name: format!("joint {index}"),
            parent: (index > 0).then(|| if index % 8 == 0 { index / 3 } else { index - 1 }),
            rest: JointTransform::at(Vec3::new(
                random.range(-0.1, 0.1),
                random.range(0.1, 0.25),
                0.0,
            )),
        });
        let skeleton =
            Skeleton::new(joints.collect()).expect("parents stand before their children");
        let sources: Vec<ClipData> = (0..12)
            .map(|clip| made_clip(&mut random, &skeleton, clip))
            .collect();
        let clips = sources
            .iter()
            .map(|data| Clip::new(&skeleton, data).expect("made as clips have to be"))
            .collect();
        let rest = skeleton.rest_model();
        let mut mesh = SkinnedMesh {
            name: "made".into(),
            ..Default::default()
        };
        for (joint, at) in rest.iter().enumerate() {
            for _ in 0..24 {
                let way = Vec3::new(
                    random.range(-0.1, 0.1),
                    random.range(-0.1, 0.1),
                    random.range(-0.1, 0.1),
                );
                mesh.positions
                    .push((Vec3::from(at.translation) + way).to_array());
                mesh.normals.push(way.normalize_or(Vec3::Y).to_array());
                let above = skeleton.parent(joint).unwrap_or(joint) as u16;
                let part = random.unit_f32();
                mesh.joints.push([joint as u16, above, 0, 0]);
                mesh.weights.push([part, 1.0 - part, 0.0, 0.0]);
            }
        }
        let skin = Skin {
            name: "made".into(),
            joints: (0..rest.len()).collect(),
            inverse_binds: rest.iter().map(|joint| joint.inverse()).collect(),
        };
        Self {
            rig: Rig {
                skeleton,
                joint_of_node: Vec::new(),
                skins: vec![skin],
                clips,
                sources,
                meshes: vec![mesh],
            },
            name: "a figure made in code: 41 joints, 12 clips".into(),
            blended: [0, 1, 2],
        }
    }
}

fn made_clip(random: &mut Random, skeleton: &Skeleton, index: usize) -> ClipData {
    let keys = 30 + random.below(30);
    let times: Vec<f32> = (0..=keys).map(|key| key as f32 / 30.0).collect();
    let channels = (0..skeleton.len()).map(|joint| {
        let axis = Vec3::new(
            random.range(-1.0, 1.0),
            random.range(-1.0, 1.0),
            random.range(-1.0, 1.0),
        );
        let (reach, rate, phase) = (
            random.range(0.1, 0.8),
            random.range(2.0, 9.0),
            random.range(0.0, 6.0),
        );
        let turn = |time: &f32| {
            let angle = reach * bevy::math::ops::sin(rate * time + phase);
            Quat::from_axis_angle(axis.normalize_or(Vec3::X), angle).to_array()
        };
        Channel {
            joint,
            times: times.clone(),
            interpolation: Interpolation::Linear,
            values: Values::Rotation(times.iter().map(turn).collect()),
        }
    });
    ClipData {
        name: format!("clip {index}"),
        channels: channels.collect(),
    }
}
