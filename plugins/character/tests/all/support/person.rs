//! A person made in code: 1.75 m, 17 joints, clips of standing, walking, running, turning, jumping and
//! waving. What a foot does in a stride is a function of the phase: it lands on the heel, rolls flat,
//! lifts its heel over the ball, and swings.

use bevy::math::ops::{cos, sin};
use bevy::math::{Affine3A, Quat, Vec3};
use dolomite_character::feet::{Limb, bend};
use dolomite_character::gait::{ClipMotion, GaitData, LegData, OneShotData};
use dolomite_character::{
    Channel, Clip, ClipData, Figure, Interpolation, Joint, JointTransform, Pose, Rig, Skeleton,
    Skin, SkinnedMesh, Values,
};
use std::f32::consts::TAU;

const HIP: f32 = 0.95;
const ANKLE: Vec3 = Vec3::new(0.09, 0.09, 0.0);
const BALL: Vec3 = Vec3::new(0.09, 0.02, 0.13);
pub const HEEL: f32 = 0.06;

/// A stride: seconds, m/s, part of the turn that a foot stands, radians of turning a second.
struct Stride {
    period: f32,
    speed: f32,
    duty: f32,
    turning: f32,
    crouch: f32,
}

const WALK: Stride = Stride {
    period: 0.95,
    speed: 1.1,
    duty: 0.62,
    turning: 0.0,
    crouch: 0.075,
};
const RUN: Stride = Stride {
    period: 0.64,
    speed: 3.0,
    duty: 0.36,
    turning: 0.0,
    crouch: 0.11,
};
const TURN: Stride = Stride {
    period: 0.9,
    speed: 0.0,
    duty: 0.6,
    turning: 1.6,
    crouch: 0.03,
};

pub fn skeleton() -> Skeleton {
    let at = |x: f32, y: f32, z: f32| JointTransform::at(Vec3::new(x, y, z));
    let mut joints = vec![
        ("root", None, at(0.0, 0.0, 0.0)),
        ("hips", Some(0), at(0.0, 1.0, 0.0)),
        ("spine", Some(1), at(0.0, 0.12, 0.0)),
        ("chest", Some(2), at(0.0, 0.2, 0.0)),
        ("head", Some(3), at(0.0, 0.35, 0.0)),
    ];
    for side in [1.0_f32, -1.0] {
        let name = |left: &'static str, right: &'static str| if side > 0.0 { left } else { right };
        let hip = joints.len();
        joints.push((
            name("thigh_l", "thigh_r"),
            Some(1),
            at(0.09 * side, HIP - 1.0, 0.0),
        ));
        joints.push((name("shank_l", "shank_r"), Some(hip), at(0.0, -0.43, 0.01)));
        joints.push((
            name("foot_l", "foot_r"),
            Some(hip + 1),
            at(0.0, -0.43, -0.01),
        ));
        joints.push((
            name("toes_l", "toes_r"),
            Some(hip + 2),
            at(0.0, BALL.y - ANKLE.y, BALL.z),
        ));
    }
    for side in [1.0_f32, -1.0] {
        let name = |left: &'static str, right: &'static str| if side > 0.0 { left } else { right };
        let arm = joints.len();
        joints.push((name("arm_l", "arm_r"), Some(3), at(0.18 * side, 0.2, 0.0)));
        joints.push((name("hand_l", "hand_r"), Some(arm), at(0.0, -0.5, 0.02)));
    }
    let joint = |(name, parent, rest): (&str, _, _)| Joint {
        name: name.into(),
        parent,
        rest,
    };
    Skeleton::new(joints.into_iter().map(joint).collect()).expect("made as it has to be")
}

fn square(x: f32) -> f32 {
    x * x
}

fn about(axis: Vec3, angle: f32) -> Quat {
    Quat::from_axis_angle(axis, angle)
}

/// Ankle of the left foot standing flat at `base`, pitched (toes up is positive) about heel or ball.
fn pitched(base: Vec3, pitch: f32) -> (Vec3, Quat) {
    let pivot = if pitch > 0.0 {
        Vec3::new(0.0, -ANKLE.y, -HEEL)
    } else {
        Vec3::new(0.0, -ANKLE.y, BALL.z)
    };
    let turn = about(Vec3::X, -pitch);
    (base + pivot - turn * pivot, turn)
}

/// Ankle and turn of the left foot at `phase` after it landed.
fn foot(stride: &Stride, phase: f32) -> (Vec3, Quat) {
    let stance = |part: f32| {
        let time = (part - 0.5) * stride.duty * stride.period;
        let yaw = -stride.turning * time;
        let base = about(Vec3::Y, yaw) * ANKLE - Vec3::Z * (stride.speed * time);
        let pitch = if part < 0.2 {
            0.35 * square(1.0 - part / 0.2)
        } else if part > 0.6 {
            -0.6 * square((part - 0.6) / 0.4)
        } else {
            0.0
        };
        let (ankle, turn) = pitched(base, pitch);
        // The pivots above are those of an unturned foot; turning clips keep the foot flat.
        if stride.turning == 0.0 {
            (ankle, turn)
        } else {
            (base, about(Vec3::Y, yaw))
        }
    };
    let phase = phase.rem_euclid(1.0);
    if phase < stride.duty {
        return stance(phase / stride.duty);
    }
    let part = (phase - stride.duty) / (1.0 - stride.duty);
    let ((from, a), (to, b)) = (stance(1.0), stance(0.0));
    let smooth = part * part * (3.0 - 2.0 * part);
    let lift = Vec3::Y * 0.1 * sin(part * std::f32::consts::PI);
    (from.lerp(to, smooth) + lift, a.slerp(b, smooth))
}

/// Bends the leg of a pose so that the ankle is there.
fn set_leg(skeleton: &Skeleton, pose: &mut Pose, side: usize, ankle: Vec3, turn: Quat) {
    let mut model: Vec<Affine3A> = Vec::new();
    skeleton.local_to_model(pose, &mut model);
    let hip = 5 + side * 4;
    let [root, middle, end] = [hip, hip + 1, hip + 2].map(|j| Vec3::from(model[j].translation));
    let bend = bend(&Limb { root, middle, end }, ankle, Vec3::Z);
    let above = Quat::from_mat3a(&model[1].matrix3);
    pose.set_rotation(hip, above.inverse() * bend.upper);
    pose.set_rotation(hip + 1, bend.upper.inverse() * bend.lower);
    pose.set_rotation(hip + 2, bend.lower.inverse() * turn);
}

fn mirrored(ankle: Vec3, turn: Quat) -> (Vec3, Quat) {
    let ankle = Vec3::new(-ankle.x, ankle.y, ankle.z);
    (ankle, Quat::from_xyzw(turn.x, -turn.y, -turn.z, turn.w))
}

fn step_pose(skeleton: &Skeleton, stride: &Stride, phase: f32) -> Pose {
    let mut pose = skeleton.rest().clone();
    let bob = 0.015 * cos(2.0 * TAU * phase);
    pose.set(
        1,
        JointTransform::at(Vec3::new(0.0, 1.0 - stride.crouch - bob, 0.0)),
    );
    for side in 0..2 {
        let swing = 0.4 * cos(TAU * (phase + 0.5 * side as f32));
        pose.set_rotation(13 + 2 * side, about(Vec3::X, swing));
        let (ankle, turn) = foot(stride, phase - 0.5 * side as f32);
        let (ankle, turn) = match (side, stride.turning == 0.0) {
            (0, _) => (ankle, turn),
            (_, true) => mirrored(ankle, turn),
            // Turning is not symmetric: the same circle, the other side of it.
            (_, false) => (Vec3::new(-ankle.x, ankle.y, -ankle.z), turn),
        };
        set_leg(skeleton, &mut pose, side, ankle, turn);
    }
    pose
}

fn clip(skeleton: &Skeleton, name: &str, seconds: f32, pose: impl Fn(f32) -> Pose) -> ClipData {
    let keys = (seconds * 60.0).round() as usize;
    let times: Vec<f32> = (0..=keys)
        .map(|key| key as f32 * seconds / keys as f32)
        .collect();
    let poses: Vec<Pose> = times.iter().map(|time| pose(*time)).collect();
    let mut channels = Vec::new();
    for joint in 0..skeleton.len() {
        let each = |of: fn(JointTransform) -> [f32; 4]| {
            poses.iter().map(|pose| of(pose.get(joint))).collect()
        };
        channels.push(Channel {
            joint,
            times: times.clone(),
            interpolation: Interpolation::Linear,
            values: Values::Rotation(each(|local| local.rotation.to_array())),
        });
        let way = poses
            .iter()
            .map(|pose| pose.get(joint).translation.to_array())
            .collect();
        channels.push(Channel {
            joint,
            times: times.clone(),
            interpolation: Interpolation::Linear,
            values: Values::Translation(way),
        });
    }
    ClipData {
        name: name.into(),
        channels,
    }
}

pub fn rig() -> Rig {
    let skeleton = skeleton();
    let stand = |crouch: f32| {
        let mut pose = skeleton.rest().clone();
        pose.set(1, JointTransform::at(Vec3::new(0.0, 1.0 - crouch, 0.0)));
        for side in 0..2 {
            let (ankle, turn) = mirrored(ANKLE, Quat::IDENTITY);
            let ankle = if side == 0 { ANKLE } else { ankle };
            set_leg(&skeleton, &mut pose, side, ankle, turn);
        }
        pose
    };
    let mut backwards = TURN;
    backwards.turning = -TURN.turning;
    let wave = |time: f32| {
        let mut pose = stand(0.02);
        pose.set_rotation(
            15,
            about(Vec3::Z, -2.4) * about(Vec3::X, 0.4 * sin(time * 9.0)),
        );
        pose
    };
    let sources = vec![
        clip(&skeleton, "idle", 3.0, |time| {
            stand(0.02 + 0.004 * sin(time * TAU / 3.0))
        }),
        clip(&skeleton, "walk", WALK.period, |time| {
            step_pose(&skeleton, &WALK, time / WALK.period)
        }),
        // The right foot lands first: phases of clips differ.
        clip(&skeleton, "run", RUN.period, |time| {
            step_pose(&skeleton, &RUN, time / RUN.period + 0.5)
        }),
        clip(&skeleton, "turn_left", TURN.period, |time| {
            step_pose(&skeleton, &TURN, time / TURN.period)
        }),
        clip(&skeleton, "turn_right", TURN.period, |time| {
            step_pose(&skeleton, &backwards, time / TURN.period)
        }),
        clip(&skeleton, "jump", 0.5, |time| {
            stand(0.1 * (1.0 - 2.0 * time).max(0.0))
        }),
        clip(&skeleton, "fall", 0.8, |_| stand(0.05)),
        clip(&skeleton, "land", 0.5, |time| {
            stand(0.2 * (1.0 - 2.0 * time).max(0.0))
        }),
        clip(&skeleton, "wave", 1.5, wave),
    ];
    Rig {
        clips: sources
            .iter()
            .map(|data| Clip::new(&skeleton, data).expect("made as it has to be"))
            .collect(),
        joint_of_node: Vec::new(),
        skins: Vec::new(),
        meshes: Vec::new(),
        sources,
        skeleton,
    }
}

/// The person with a body: a box about every joint, half of its corners shared with the joint above.
pub fn rig_with_mesh() -> Rig {
    let mut rig = rig();
    let binds = rig.skeleton.rest_model();
    let mut mesh = SkinnedMesh {
        name: "body".into(),
        ..Default::default()
    };
    for (joint, at) in binds.iter().enumerate() {
        let above = rig.skeleton.parent(joint).unwrap_or(joint) as u16;
        let first = mesh.positions.len() as u32;
        for corner in 0..8 {
            let side = |bit: usize| {
                if corner >> bit & 1 == 0 {
                    -0.06_f32
                } else {
                    0.06
                }
            };
            let way = Vec3::new(side(0), side(1), side(2));
            mesh.positions
                .push((Vec3::from(at.translation) + way).to_array());
            mesh.normals.push(way.normalize().to_array());
            mesh.uvs.push([side(0) * 8.0 + 0.5, side(1) * 8.0 + 0.5]);
            mesh.joints.push([joint as u16, above, 0, 1]);
            mesh.weights.push(if corner < 4 {
                [0.55, 0.3, 0.1, 0.05]
            } else {
                [1.0, 0.0, 0.0, 0.0]
            });
        }
        // Two triangles of every side, outside in front.
        let quads = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        for [a, b, c, d] in quads {
            mesh.indices
                .extend([a, b, c, a, c, d].map(|corner| first + corner));
        }
    }
    rig.skins = vec![Skin {
        name: "body".into(),
        joints: (0..binds.len()).collect(),
        inverse_binds: binds.iter().map(|bind| bind.inverse()).collect(),
    }];
    rig.meshes = vec![mesh];
    rig
}

pub fn gaits() -> GaitData {
    let motion = |name: &str, stride: &Stride, left: f32, right: f32| ClipMotion {
        clip: name.into(),
        speed: stride.speed,
        turn_rate: stride.turning,
        left: (left, left + stride.duty),
        right: (right, right + stride.duty),
    };
    let leg = |side: &str| LegData {
        hip: format!("thigh_{side}"),
        knee: format!("shank_{side}"),
        ankle: format!("foot_{side}"),
        ball: format!("toes_{side}"),
        heel: HEEL,
    };
    GaitData {
        idle: "idle".into(),
        strides: vec![
            motion("walk", &WALK, 0.0, 0.5),
            motion("run", &RUN, 0.5, 0.0),
        ],
        turn_left: Some(motion("turn_left", &TURN, 0.0, 0.5)),
        turn_right: Some(motion("turn_right", &TURN, 0.0, 0.5)),
        jump: Some("jump".into()),
        fall: Some("fall".into()),
        land: Some("land".into()),
        one_shots: vec![OneShotData {
            clip: "wave".into(),
            from: Some("spine".into()),
        }],
        spine: vec!["spine".into(), "chest".into()],
        pelvis: "hips".into(),
        legs: Some([leg("l"), leg("r")]),
    }
}

pub fn figure() -> Figure {
    Figure::new(rig(), &gaits()).expect("made as it has to be")
}
