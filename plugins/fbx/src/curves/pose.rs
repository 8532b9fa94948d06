//! Where a node is, and what a blend channel weighs.

use super::layers::Layers;
use super::majorant::Majorant;
use super::value::{Meaning, Value, fixed, turn};
use crate::model::Trs;
use crate::read::convert::vec3;
use crate::read::rest_of;
use glam::{DMat3, DQuat, DVec3};
use ufbx::{BlendChannel, MirrorAxis, Node, RotationOrder};

/// The curves that move a node, in order of how they are applied.
///
/// Where children do not inherit a node's scale as matrices do, ufbx moves the scale to a helper node below it, and such
/// children hang on the node itself. Their places are scaled all the same, and the node's own pivots are those of the
/// scale that its helper has: ufbx leaves out both, so that they are worked out here.
#[derive(Clone)]
pub(crate) struct NodeCurves<'a> {
    pub(super) node: &'a Node,
    pub(super) translation: Value<'a>,
    pub(super) rotation: Value<'a>,
    pub(super) scale: Value<'a>,
    pub(super) before: Turn<'a>,
    pub(super) after: Turn<'a>,
    pub(super) rotation_offset: Value<'a>,
    pub(super) rotation_pivot: Value<'a>,
    pub(super) scale_offset: Value<'a>,
    pub(super) scale_pivot: Value<'a>,
    /// How it is turned, where that is the same at all times.
    stands: Option<DQuat>,
    /// Any of these four is not 0, or moves.
    pub(super) has_pivots: bool,
    pub(super) order: Value<'a>,
    /// The order where nothing moves it.
    fixed_order: RotationOrder,
    /// What a camera or light takes its scale by, and what its children are turned back by.
    pub(super) own_aside: Option<DMat3>,
    parent_aside: Option<DQuat>,
    /// The scale that the node's helper has, if it has one.
    pub(super) taken: Option<Value<'a>>,
    /// Scales of helpers above, which places are multiplied by.
    pub(super) helpers: Vec<Value<'a>>,
    /// The last of them belongs to the node's parent itself.
    pub(super) parent_helps: bool,
    /// It has none of all this but a translation, a rotation and a scale, in other units at most.
    is_plain: bool,
    /// Majorants of its translation and of its scale, where nothing moves but how it is turned and they are known.
    pub(super) turns_alone: Option<(Majorant, Majorant)>,
    last: Trs,
}

/// A rotation by angles that mostly stand still.
#[derive(Clone)]
pub(super) struct Turn<'a> {
    pub(super) angles: Value<'a>,
    fixed: DQuat,
    /// It never turns anything.
    is_nothing: bool,
}

impl<'a> Turn<'a> {
    fn of(angles: Value<'a>) -> Self {
        let fixed = turn(angles.fixed, RotationOrder::Xyz);
        Self {
            is_nothing: angles.is_nothing(),
            angles,
            fixed,
        }
    }

    fn at(&mut self, time: f64) -> DQuat {
        match self.angles.moves() {
            false => self.fixed,
            true => turn(self.angles.at(time, XYZ), RotationOrder::Xyz),
        }
    }
}

const XYZ: Meaning = Meaning::Angles(RotationOrder::Xyz);

impl<'a> NodeCurves<'a> {
    /// By the layers of a stack.
    pub(crate) fn of(layers: &Layers<'a>, node: &'a Node) -> Self {
        Self {
            last: rest_of(node),
            ..Self::with(layers, node)
        }
    }

    /// Where it is when nothing plays.
    pub(crate) fn rest(node: &'a Node) -> Trs {
        Self::with(&Layers::none(), node).pose(0.0)
    }

    fn with(layers: &Layers<'a>, node: &'a Node) -> Self {
        let value = |name| Value::of(layers, &node.element, name, DVec3::ZERO).settled();
        let scale = |node| scale(layers, node).settled();
        let (helpers, parent_helps) = helpers(node, scale);
        let mut out = Self {
            stands: None,
            has_pivots: false,
            node,
            translation: value("Lcl Translation"),
            rotation: value("Lcl Rotation"),
            scale: scale(node),
            before: Turn::of(value("PreRotation")),
            after: Turn::of(value("PostRotation")),
            rotation_offset: value("RotationOffset"),
            rotation_pivot: value("RotationPivot"),
            scale_offset: value("ScalingOffset"),
            scale_pivot: value("ScalingPivot"),
            order: value("RotationOrder"),
            fixed_order: RotationOrder::Xyz,
            own_aside: aside(node).map(|turned| DMat3::from_quat(turned).transpose()),
            parent_aside: node
                .parent
                .as_ref()
                .and_then(|parent| aside(parent))
                .map(DQuat::conjugate),
            taken: node
                .scale_helper
                .as_ref()
                .map(|helper| scale(helper.as_ref())),
            helpers,
            parent_helps,
            is_plain: false,
            turns_alone: None,
            last: Trs::IDENTITY,
        };
        out.fixed_order = rotation_order(out.order.fixed.x as i64);
        let turns = [
            &out.rotation,
            &out.before.angles,
            &out.after.angles,
            &out.order,
        ];
        if !turns.into_iter().any(Value::moves) {
            out.stands = Some(out.turned(0.0));
        }
        let pivots = [
            &out.rotation_offset,
            &out.rotation_pivot,
            &out.scale_offset,
            &out.scale_pivot,
        ];
        out.has_pivots = !pivots.into_iter().all(Value::is_nothing);
        out.is_plain = !out.has_pivots
            && out.helpers.is_empty()
            && (!node.has_adjust_transform || only_scales(node))
            && out.own_aside.is_none()
            && out.parent_aside.is_none()
            && node.adjust_mirror_axis == MirrorAxis::None;
        out
    }

    /// Where it is at `time`, seconds on the file's clock. What is no transform leaves it where it was.
    pub(crate) fn at(&mut self, time: f64) -> Trs {
        let pose = self.pose(time);
        if pose.is_sound() {
            self.last = pose;
        }
        self.last
    }

    /// What is no transform leaves it at rest from here on.
    pub(crate) fn forget(&mut self) {
        self.last = rest_of(self.node);
    }

    /// Whether its scale, or one that it takes on, is not the same at all times.
    pub(crate) fn scales(&self) -> bool {
        let mut others = self.helpers.iter().chain(&self.taken);
        self.scale.moves() || others.any(Value::moves)
    }

    pub(super) fn rotation_order(&mut self, time: f64) -> RotationOrder {
        match self.order.moves() {
            true => rotation_order(self.order.at(time, Meaning::Plain).x as i64),
            false => self.fixed_order,
        }
    }

    /// How its pre-rotation, its rotation and its post-rotation turn it.
    fn turned(&mut self, time: f64) -> DQuat {
        let order = self.rotation_order(time);
        let angles = self.rotation.at(time, Meaning::Angles(order));
        if !self.node.use_rotation_space {
            return turn(angles, RotationOrder::Xyz);
        }
        let mut turned = turn(angles, order);
        if !self.before.is_nothing {
            turned = self.before.at(time) * turned;
        }
        if !self.after.is_nothing {
            turned *= self.after.at(time).conjugate();
        }
        turned
    }

    fn pose(&mut self, time: f64) -> Trs {
        let node = self.node;
        let plain = Meaning::Plain;
        if self.is_plain {
            let turned = match self.stands {
                Some(turned) => turned,
                None => self.turned(time),
            };
            let mut out = Trs {
                translation: self.translation.at(time, plain),
                rotation: turned.normalize(),
                scale: self.scale.at(time, Meaning::Scale),
            };
            if node.has_adjust_transform {
                out.translation *= node.adjust_pre_scale * node.adjust_translation_scale;
                out.scale *= node.adjust_post_scale * node.adjust_pre_scale;
            }
            return out;
        }
        let (mut rotation, mut scale) = (DQuat::IDENTITY, DVec3::ONE);
        let mut helped = DVec3::ONE;
        let above = self.helpers.len() - usize::from(self.parent_helps);
        for helper in &mut self.helpers[..above] {
            helped *= helper.at(time, Meaning::Scale);
        }
        if node.has_adjust_transform {
            rotation = quat(node.adjust_post_rotation);
            scale *= node.adjust_post_scale;
        }
        let own = self.scale.at(time, Meaning::Scale);
        scale *= own;
        let turned = match self.stands {
            Some(turned) => turned,
            None => self.turned(time),
        };
        rotation = turned * rotation;
        let mut place = self.translation.at(time, plain);
        if self.has_pivots {
            let about_pivot = match &mut self.taken {
                Some(taken) => taken.at(time, Meaning::Scale),
                None => own,
            };
            let pivot = self.scale_pivot.at(time, plain);
            let turned_at = self.rotation_pivot.at(time, plain);
            let offset = self.scale_offset.at(time, plain);
            let swung = turned * (pivot - pivot * about_pivot + offset - turned_at);
            place = swung + (turned_at + self.rotation_offset.at(time, plain) + place);
        }
        if let Some(helper) = self.helpers.get_mut(above) {
            place *= helped * helper.at(time, Meaning::Scale);
        }
        if node.has_adjust_transform {
            let before = quat(node.adjust_pre_rotation);
            place = before * (place + vec3(node.adjust_pre_translation));
            rotation = before * rotation;
            scale *= node.adjust_pre_scale;
            place *= node.adjust_pre_scale * node.adjust_translation_scale;
        }
        if node.is_scale_helper {
            scale *= helped;
        }
        // A camera or light is turned to look along glTF's axis; its scale and its children are not.
        if let Some(axes) = self.own_aside {
            scale = DVec3::from_array([0, 1, 2].map(|axis| {
                let column = axes.row(axis);
                (column * column).dot(scale)
            }));
        }
        if let Some(back) = self.parent_aside {
            place = back * place;
            rotation = back * rotation;
        }
        mirror(&mut place, &mut rotation, node.adjust_mirror_axis);
        Trs {
            translation: place,
            rotation: rotation.normalize(),
            scale,
        }
    }
}

/// What is added to a node's transform for other axes and another unit is a scale alone.
fn only_scales(node: &Node) -> bool {
    quat(node.adjust_pre_rotation) == DQuat::IDENTITY
        && quat(node.adjust_post_rotation) == DQuat::IDENTITY
        && vec3(node.adjust_pre_translation) == DVec3::ZERO
}

/// By how much ufbx turns a camera's or light's own axes, a number of quarter turns.
pub(crate) fn aside(node: &Node) -> Option<DQuat> {
    let turned = quat(node.adjust_post_rotation);
    (node.has_adjust_transform && turned.w.abs() < 1.0).then_some(turned)
}

fn scale<'a>(layers: &Layers<'a>, node: &'a Node) -> Value<'a> {
    let mut value = Value::of(layers, &node.element, "Lcl Scaling", DVec3::ONE);
    if let Some(first) = first_helper(node) {
        value.fixed = fixed(&first.element, "Lcl Scaling", DVec3::ONE);
    }
    value
}

/// Where a file lists a child before its parent, ufbx may give the child two helpers: the first has the scale at rest, the
/// second all else.
fn first_helper(helper: &Node) -> Option<&Node> {
    let parent = helper
        .parent
        .as_ref()
        .filter(|_| helper.is_scale_helper)?
        .as_ref();
    parent
        .children
        .iter()
        .filter(|node| node.is_scale_helper && node.element.element_id < helper.element.element_id)
        .min_by_key(|node| node.element.element_id)
        .map(AsRef::as_ref)
}

/// Scales that ufbx's helper nodes take on from nodes above, and whether the last is that of the
/// parent's own helper.
fn helpers<'a>(node: &'a Node, scale: impl Fn(&'a Node) -> Value<'a>) -> (Vec<Value<'a>>, bool) {
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
        out.push(scale(helper.as_ref()));
        above = next;
    }
    let helper = parent.scale_helper.as_ref();
    out.extend(helper.map(|helper| scale(helper.as_ref())));
    (out, helper.is_some())
}

/// In which order a node turns about its axes.
pub(crate) fn order_of(node: &Node) -> RotationOrder {
    let prop = ufbx::find_prop(&node.element.props, "RotationOrder");
    rotation_order(prop.map_or(0, |prop| prop.value_int))
}

fn rotation_order(number: i64) -> RotationOrder {
    use RotationOrder::{Spheric, Xyz, Xzy, Yxz, Yzx, Zxy, Zyx};
    match number {
        1 => Xzy,
        2 => Yzx,
        3 => Yxz,
        4 => Zxy,
        5 => Zyx,
        6 => Spheric,
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
    pub(super) percent: Value<'a>,
}

impl<'a> BlendWeight<'a> {
    pub(crate) fn of(layers: &Layers<'a>, channel: &'a BlendChannel) -> Self {
        let name = "DeformPercent";
        let or = DVec3::splat(channel.weight * 100.0);
        Self {
            percent: Value::of(layers, &channel.element, name, or).settled(),
        }
    }

    /// As a share: 1 is the whole.
    pub(crate) fn at(&mut self, time: f64) -> f64 {
        self.percent.at(time, Meaning::Plain).x / 100.0
    }
}
