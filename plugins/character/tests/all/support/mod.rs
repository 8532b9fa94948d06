//! What several tests need: files beside the project, random numbers, a skeleton and clips made in code.

pub mod person;
pub mod walk;

use bevy::math::{Quat, Vec3};
use dolomite_character::{
    Channel, ClipData, Interpolation, Joint, JointTransform, Rig, Skeleton, Values,
};
use rand_mt::Mt;
use std::path::PathBuf;

/// A file of the data beside the project; `None`, after a line that says so, where it is absent.
pub fn shared(name: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("DOLOMITE_SHARED").map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared")),
        PathBuf::from,
    );
    let path = folder.join("data").join(name);
    if path.exists() {
        return Some(path);
    }
    assert!(
        std::env::var_os("DOLOMITE_REQUIRE_SHARED").is_none(),
        "{} is missing",
        path.display()
    );
    eprintln!("skipped: {} is not there", path.display());
    None
}

/// The soldier of the crowd tests: 41 joints of a skin, 76 clips.
pub fn knight() -> Option<Rig> {
    Some(Rig::read(&shared("glb/knight.glb")?).expect("a rig"))
}

/// Random numbers, the same every time.
pub struct Random(Mt);

impl Random {
    pub fn new(seed: u32) -> Self {
        Self(Mt::new(seed))
    }

    /// In [0, 1).
    pub fn unit(&mut self) -> f32 {
        (self.0.next_u32() >> 8) as f32 / (1 << 24) as f32
    }

    /// In [low, high).
    pub fn range(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    pub fn below(&mut self, count: usize) -> usize {
        self.0.next_u32() as usize % count
    }

    /// A rotation by up to `most` radians from rest.
    pub fn rotation(&mut self, most: f32) -> Quat {
        let axis = Vec3::new(
            self.range(-1.0, 1.0),
            self.range(-1.0, 1.0),
            self.range(-1.0, 1.0),
        );
        Quat::from_axis_angle(axis.normalize_or(Vec3::X), self.range(-most, most))
    }
}

/// A chain with branches, two metres and more from the root: 21 joints, so that blocks are not full.
pub fn skeleton(random: &mut Random) -> Skeleton {
    let joints = (0..21).map(|index| Joint {
        name: format!("joint {index}"),
        parent: (index > 0).then(|| if index % 7 == 0 { index / 2 } else { index - 1 }),
        rest: JointTransform {
            translation: Vec3::new(random.range(-0.1, 0.1), random.range(0.1, 0.3), 0.02),
            rotation: random.rotation(0.6),
            scale: Vec3::ONE,
        },
    });
    Skeleton::new(joints.collect()).expect("parents first")
}

/// A clip with channels of every interpolation, with key times of their own, missing channels, channels
/// that rest and channels of one key.
pub fn hostile_clip(random: &mut Random, skeleton: &Skeleton, seconds: f32) -> ClipData {
    let mut channels = Vec::new();
    let shared_times: Vec<f32> = (0..=30).map(|key| key as f32 * seconds / 30.0).collect();
    for joint in 0..skeleton.len() {
        for property in 0..3 {
            if random.unit() < 0.2 {
                continue;
            }
            let interpolation = match random.below(4) {
                0 => Interpolation::Step,
                1 => Interpolation::Cubic,
                _ => Interpolation::Linear,
            };
            let times = match random.below(4) {
                0 => vec![random.range(0.0, seconds)],
                1 => {
                    let mut times: Vec<f32> = (0..9).map(|_| random.range(0.0, seconds)).collect();
                    times.sort_by(f32::total_cmp);
                    times.dedup();
                    times
                }
                _ => shared_times.clone(),
            };
            channels.push(channel(
                random,
                skeleton,
                joint,
                property,
                times,
                interpolation,
            ));
        }
    }
    ClipData {
        name: "hostile".into(),
        channels,
    }
}

fn channel(
    random: &mut Random,
    skeleton: &Skeleton,
    joint: usize,
    property: usize,
    times: Vec<f32>,
    interpolation: Interpolation,
) -> Channel {
    let rest = skeleton.rest().get(joint);
    let cubic = interpolation == Interpolation::Cubic;
    let count = times.len() * if cubic { 3 } else { 1 };
    let tangent = |index: usize| cubic && index % 3 != 1;
    let values = match property {
        0 => Values::Translation(
            (0..count)
                .map(|index| {
                    let spread = Vec3::new(random.range(-0.1, 0.1), random.range(-0.1, 0.1), 0.0);
                    if tangent(index) {
                        spread
                    } else {
                        rest.translation + spread
                    }
                    .to_array()
                })
                .collect(),
        ),
        1 => Values::Rotation(
            (0..count)
                .map(|index| {
                    if tangent(index) {
                        std::array::from_fn(|_| random.range(-0.5, 0.5))
                    } else {
                        // Either sign, and not of unit length where a spline does not mind.
                        let sign = if random.unit() < 0.5 && !cubic {
                            -1.0
                        } else {
                            1.0
                        };
                        (rest.rotation * random.rotation(1.2))
                            .to_array()
                            .map(|x| x * sign)
                    }
                })
                .collect(),
        ),
        _ => Values::Scale(
            (0..count)
                .map(|index| {
                    if tangent(index) {
                        [0.0, random.range(-0.1, 0.1), 0.0]
                    } else {
                        [1.0, random.range(0.9, 1.1), 1.0]
                    }
                })
                .collect(),
        ),
    };
    Channel {
        joint,
        times,
        interpolation,
        values,
    }
}
