//! Skeletons: joints with parents before children, names, and the pose at rest.

use crate::pose::{JointTransform, Pose};
use bevy::math::{Affine3A, Quat};
use std::collections::HashMap;
use thiserror::Error;

/// A joint as it is handed to [`Skeleton::new`].
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// What clips, masks and gaits call it. Need not be unique; the first of a name is found.
    pub name: String,
    /// A joint earlier in the list; `None` for a root.
    pub parent: Option<usize>,
    /// Local transform at rest.
    pub rest: JointTransform,
}

/// Why joints are not a skeleton.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SkeletonError {
    /// None at all.
    #[error("a skeleton needs at least one joint")]
    Empty,
    /// More than an index of 16 bits reaches.
    #[error("{0} joints are more than {max}", max = Skeleton::MOST_JOINTS)]
    TooMany(usize),
    /// The parent stands behind its child, or is the child itself, or is not there.
    #[error(
        "joint {joint} ({name}) has parent {parent}: parents have to stand before their children"
    )]
    Order {
        /// Place in the list.
        joint: usize,
        /// Its name.
        name: String,
        /// What it named.
        parent: usize,
    },
    /// A transform with a number that is none, or a rotation of length zero.
    #[error("joint {joint} ({name}) has a rest transform that is not finite or has no rotation")]
    Rest {
        /// Place in the list.
        joint: usize,
        /// Its name.
        name: String,
    },
}

/// Joints with parents before children.
#[derive(Clone, Debug, PartialEq)]
pub struct Skeleton {
    names: Vec<String>,
    parents: Vec<u16>,
    rest: Pose,
    by_name: HashMap<String, u16>,
}

impl Skeleton {
    /// Most joints of a skeleton.
    pub const MOST_JOINTS: usize = 1 << 15;

    /// Parent of a root.
    const ROOT: u16 = u16::MAX;

    /// A skeleton of these joints, in this order.
    ///
    /// # Errors
    /// [`SkeletonError`].
    pub fn new(joints: Vec<Joint>) -> Result<Self, SkeletonError> {
        if joints.is_empty() {
            return Err(SkeletonError::Empty);
        }
        if joints.len() > Self::MOST_JOINTS {
            return Err(SkeletonError::TooMany(joints.len()));
        }
        let mut rest = Pose::new(joints.len());
        let mut names = Vec::with_capacity(joints.len());
        let mut parents = Vec::with_capacity(joints.len());
        let mut by_name = HashMap::with_capacity(joints.len());
        for (index, joint) in joints.into_iter().enumerate() {
            if let Some(parent) = joint.parent.filter(|parent| *parent >= index) {
                return Err(SkeletonError::Order {
                    joint: index,
                    name: joint.name,
                    parent,
                });
            }
            let rotation = unit(joint.rest.rotation);
            let (Some(rotation), true) = (rotation, joint.rest.is_finite()) else {
                return Err(SkeletonError::Rest {
                    joint: index,
                    name: joint.name,
                });
            };
            rest.set(
                index,
                JointTransform {
                    rotation,
                    ..joint.rest
                },
            );
            parents.push(joint.parent.map_or(Self::ROOT, |parent| parent as u16));
            by_name.entry(joint.name.clone()).or_insert(index as u16);
            names.push(joint.name);
        }
        Ok(Self {
            names,
            parents,
            rest,
            by_name,
        })
    }

    /// Number of joints.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.parents.len()
    }

    /// Never: a skeleton has a joint.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.parents.is_empty()
    }

    /// The name of a joint.
    ///
    /// # Panics
    /// If there is no such joint.
    #[must_use]
    pub fn name(&self, joint: usize) -> &str {
        &self.names[joint]
    }

    /// The first joint of that name.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<usize> {
        self.by_name.get(name).map(|joint| usize::from(*joint))
    }

    /// The parent of a joint; `None` for a root.
    ///
    /// # Panics
    /// If there is no such joint.
    #[must_use]
    pub fn parent(&self, joint: usize) -> Option<usize> {
        let parent = self.parents[joint];
        (parent != Self::ROOT).then_some(usize::from(parent))
    }

    /// The pose at rest.
    #[must_use]
    pub const fn rest(&self) -> &Pose {
        &self.rest
    }

    /// Whether `joint` is `above` or hangs from it.
    ///
    /// # Panics
    /// If there is no such joint.
    #[must_use]
    pub fn is_below(&self, joint: usize, above: usize) -> bool {
        let mut at = Some(joint);
        while let Some(here) = at.filter(|here| *here >= above) {
            if here == above {
                return true;
            }
            at = self.parent(here);
        }
        false
    }

    /// Matrices of all joints at rest, in the model's frame.
    #[must_use]
    pub fn rest_model(&self) -> Vec<Affine3A> {
        let mut model = Vec::new();
        self.local_to_model(&self.rest, &mut model);
        model
    }
}

/// The unit quaternion of that direction; `None` where it has none. In f64, so that a quaternion that is
/// a unit one already keeps its bits as nearly as f32 can say it.
pub(crate) fn unit(rotation: Quat) -> Option<Quat> {
    let wide = rotation.to_array().map(f64::from);
    let length = wide.iter().map(|x| x * x).sum::<f64>().sqrt();
    (length.is_finite() && length > 1e-12)
        .then(|| Quat::from_array(wide.map(|x| (x / length) as f32)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::math::Vec3;

    fn joint(name: &str, parent: Option<usize>) -> Joint {
        Joint {
            name: name.into(),
            parent,
            rest: JointTransform::at(Vec3::Y),
        }
    }

    #[test]
    fn chains_are_known() {
        let skeleton = Skeleton::new(vec![
            joint("root", None),
            joint("spine", Some(0)),
            joint("leg", Some(0)),
            joint("head", Some(1)),
        ])
        .unwrap();
        assert_eq!(skeleton.find("head"), Some(3));
        assert_eq!(skeleton.find("tail"), None);
        assert_eq!(skeleton.parent(0), None);
        assert!(skeleton.is_below(3, 1) && skeleton.is_below(1, 1));
        assert!(!skeleton.is_below(3, 2) && !skeleton.is_below(0, 1));
        assert_eq!(skeleton.rest_model()[3].translation.y, 3.0);
    }

    #[test]
    fn what_is_no_skeleton_is_refused() {
        assert_eq!(Skeleton::new(vec![]), Err(SkeletonError::Empty));
        let refusal = Skeleton::new(vec![joint("a", None), joint("b", Some(1))]);
        assert!(matches!(
            refusal,
            Err(SkeletonError::Order {
                joint: 1,
                parent: 1,
                ..
            })
        ));
        for bad in [
            Quat::from_xyzw(0.0, 0.0, 0.0, 0.0),
            Quat::from_xyzw(f32::NAN, 0.0, 0.0, 1.0),
        ] {
            let mut flat = joint("flat", None);
            flat.rest.rotation = bad;
            assert!(matches!(
                Skeleton::new(vec![flat]),
                Err(SkeletonError::Rest { .. })
            ));
        }
        let many = vec![joint("x", None); Skeleton::MOST_JOINTS + 1];
        assert!(matches!(
            Skeleton::new(many),
            Err(SkeletonError::TooMany(_))
        ));
    }

    #[test]
    fn rotations_become_unit_ones() {
        let mut scaled = joint("a", None);
        scaled.rest.rotation = Quat::from_xyzw(0.0, 0.0, 0.0, 7.0);
        let skeleton = Skeleton::new(vec![scaled]).unwrap();
        assert_eq!(skeleton.rest().get(0).rotation, Quat::IDENTITY);
    }
}
