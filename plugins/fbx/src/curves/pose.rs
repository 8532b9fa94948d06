//! Where a node is, and what a blend channel weighs.

use super::layers::Layers;
use super::value::{Meaning, Value, turn};
use crate::model::Trs;
use crate::read::convert::{trs, vec3};
use crate::read::rest_of;
use glam::{DQuat, DVec3};
use ufbx::{Anim, BlendChannel, MirrorAxis, Node, PropFlags, RotationOrder};

/// The curves that move a node, in order of how they are applied.
#[derive(Clone)]
pub(crate) struct NodeCurves<'a> {
    node: &'a Node,
    /// What ufbx is asked where a property hangs on another, which is rare.
    asked: Option<&'a Anim>,
    translation: Value<'a>,
    rotation: Value<'a>,
    scale: Value<'a>,
    before: Turn<'a>,
    after: Turn<'a>,
    rotation_offset: Value<'a>,
    rotation_pivot: Value<'a>,
    scale_offset: Value<'a>,
    scale_pivot: Value<'a>,
    order: RotationOrder,
    /// Scales of helpers above, which places are multiplied by.
    helpers: Vec<Value<'a>>,
    /// The last of them belongs to the node's parent itself.
    parent_helps: bool,
    last: Trs,
}

/// A rotation by angles that mostly stand still.
#[derive(Clone)]
struct Turn<'a> {
    angles: Value<'a>,
    fixed: DQuat,
}

impl<'a> Turn<'a> {
    fn of(layers: &Layers<'a>, node: &'a Node, name: &str) -> Self {
        let angles = Value::of(layers, &node.element, name, DVec3::ZERO);
        let fixed = turn(angles.fixed, RotationOrder::Xyz);
        Self { angles, fixed }
    }

    fn at(&mut self, time: f64) -> DQuat {
        match self.angles.moves() {
            false => self.fixed,
            true => turn(self.angles.at(time, XYZ), RotationOrder::Xyz),
        }
    }
}

const XYZ: Meaning = Meaning::Angles(RotationOrder::Xyz);

/// Names of properties that say where a node is.
const NAMES: [&str; 10] = [
    "Lcl Translation",
    "Lcl Rotation",
    "Lcl Scaling",
    "PreRotation",
    "PostRotation",
    "RotationOffset",
    "RotationPivot",
    "ScalingOffset",
    "ScalingPivot",
    "RotationOrder",
];

impl<'a> NodeCurves<'a> {
    /// `anim` is that of the stack which the layers are of.
    pub(crate) fn of(layers: &Layers<'a>, anim: &'a Anim, node: &'a Node) -> Self {
        let value = |name| Value::of(layers, &node.element, name, DVec3::ZERO);
        let hangs_on_another = NAMES.iter().any(|name| {
            ufbx::find_prop(&node.element.props, name)
                .is_some_and(|prop| prop.flags.has_any(PropFlags::CONNECTED))
        });
        let order = value("RotationOrder");
        let (helpers, parent_helps) = helpers(layers, node);
        Self {
            node,
            asked: (hangs_on_another || order.moves()).then_some(anim),
            translation: value("Lcl Translation"),
            rotation: value("Lcl Rotation"),
            scale: scale(layers, node),
            before: Turn::of(layers, node, "PreRotation"),
            after: Turn::of(layers, node, "PostRotation"),
            rotation_offset: value("RotationOffset"),
            rotation_pivot: value("RotationPivot"),
            scale_offset: value("ScalingOffset"),
            scale_pivot: value("ScalingPivot"),
            order: order_of(node),
            helpers,
            parent_helps,
            last: rest_of(node),
        }
    }

    /// Where it is at `time`, seconds on the file's clock. What is no transform leaves it where it was.
    pub(crate) fn at(&mut self, time: f64) -> Trs {
        let pose = match self.asked {
            Some(anim) => trs(&ufbx::evaluate_transform(anim, self.node, time)),
            None => self.pose(time),
        };
        if pose.is_sound() {
            self.last = pose;
        }
        self.last
    }

    fn pose(&mut self, time: f64) -> Trs {
        let node = self.node;
        let plain = Meaning::Plain;
        let mut translation = self.translation.at(time, plain);
        let (mut rotation, mut scale) = (DQuat::IDENTITY, DVec3::ONE);
        let mut helped = DVec3::ONE;
        let above = self.helpers.len() - usize::from(self.parent_helps);
        for helper in &mut self.helpers[..above] {
            helped *= helper.at(time, Meaning::Scale);
        }
        if let Some(helper) = self.helpers.get_mut(above) {
            translation *= helped * helper.at(time, Meaning::Scale);
        }
        if node.has_adjust_transform {
            rotation = quat(node.adjust_post_rotation);
            scale *= node.adjust_post_scale;
        }
        let own = self.scale.at(time, Meaning::Scale);
        let pivot = self.scale_pivot.at(time, plain);
        let turned_at = self.rotation_pivot.at(time, plain);
        scale *= own;
        let mut place = pivot - pivot * own + self.scale_offset.at(time, plain) - turned_at;
        let turned = match node.use_rotation_space {
            true => {
                let own = turn(
                    self.rotation.at(time, Meaning::Angles(self.order)),
                    self.order,
                );
                self.before.at(time) * own * self.after.at(time).conjugate()
            }
            false => turn(
                self.rotation.at(time, Meaning::Angles(self.order)),
                RotationOrder::Xyz,
            ),
        };
        rotation = turned * rotation;
        if place != DVec3::ZERO {
            place = turned * place;
        }
        place += turned_at + self.rotation_offset.at(time, plain) + translation;
        if node.has_adjust_transform {
            let before = quat(node.adjust_pre_rotation);
            place = before * (place + vec3(node.adjust_pre_translation));
            rotation = before * rotation;
            scale *= node.adjust_pre_scale;
            place *= node.adjust_pre_scale * node.adjust_translation_scale;
        }
        mirror(&mut place, &mut rotation, node.adjust_mirror_axis);
        if node.is_scale_helper {
            scale *= helped;
        }
        Trs {
            translation: place,
            rotation: rotation.normalize(),
            scale,
        }
    }
}

fn scale<'a>(layers: &Layers<'a>, node: &'a Node) -> Value<'a> {
    Value::of(layers, &node.element, "Lcl Scaling", DVec3::ONE)
}

/// Scales that ufbx's helper nodes take on from nodes above, and whether the last is that of the
/// parent's own helper.
fn helpers<'a>(layers: &Layers<'a>, node: &'a Node) -> (Vec<Value<'a>>, bool) {
    let mut out = Vec::new();
    let Some(parent) = node.parent.as_ref() else {
        return (out, false);
    };
    let mut above = parent.inherit_scale_node.as_ref();
    while let Some((next, helper)) = above.and_then(|node| {
        Some((
            node.inherit_scale_node.as_ref(),
            node.scale_helper.as_ref()?,
        ))
    }) {
        out.push(scale(layers, helper.as_ref()));
        above = next;
    }
    let helper = parent.scale_helper.as_ref();
    out.extend(helper.map(|helper| scale(layers, helper.as_ref())));
    (out, helper.is_some())
}

/// In which order a node turns about its axes.
pub(crate) fn order_of(node: &Node) -> RotationOrder {
    use RotationOrder::{Spheric, Xyz, Xzy, Yxz, Yzx, Zxy, Zyx};
    let number = ufbx::find_prop(&node.element.props, "RotationOrder").map(|prop| prop.value_int);
    match number {
        Some(1) => Xzy,
        Some(2) => Yzx,
        Some(3) => Yxz,
        Some(4) => Zxy,
        Some(5) => Zyx,
        Some(6) => Spheric,
        _ => Xyz,
    }
}

fn quat(q: ufbx::Quat) -> DQuat {
    DQuat::from_xyzw(q.x, q.y, q.z, q.w)
}

fn mirror(place: &mut DVec3, rotation: &mut DQuat, axis: MirrorAxis) {
    match axis {
        MirrorAxis::None => {}
        MirrorAxis::X => {
            place.x = -place.x;
            (rotation.y, rotation.z) = (-rotation.y, -rotation.z);
        }
        MirrorAxis::Y => {
            place.y = -place.y;
            (rotation.z, rotation.x) = (-rotation.z, -rotation.x);
        }
        MirrorAxis::Z => {
            place.z = -place.z;
            (rotation.x, rotation.y) = (-rotation.x, -rotation.y);
        }
    }
}

/// What a blend channel weighs.
pub(crate) struct BlendWeight<'a> {
    channel: &'a BlendChannel,
    asked: Option<&'a Anim>,
    percent: Value<'a>,
}

impl<'a> BlendWeight<'a> {
    pub(crate) fn of(layers: &Layers<'a>, anim: &'a Anim, channel: &'a BlendChannel) -> Self {
        let name = "DeformPercent";
        let or = DVec3::splat(channel.weight * 100.0);
        let hangs_on_another = ufbx::find_prop(&channel.element.props, name)
            .is_some_and(|prop| prop.flags.has_any(PropFlags::CONNECTED));
        Self {
            channel,
            asked: hangs_on_another.then_some(anim),
            percent: Value::of(layers, &channel.element, name, or),
        }
    }

    /// As a share: 1 is the whole.
    pub(crate) fn at(&mut self, time: f64) -> f64 {
        match self.asked {
            Some(anim) => ufbx::evaluate_blend_weight(anim, self.channel, time),
            None => self.percent.at(time, Meaning::Plain).x / 100.0,
        }
    }
}
