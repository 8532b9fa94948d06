//! A property as its layers have it.

use super::circle::sin_cos;
use super::curve::Curve;
use super::hanging::source_of;
use super::layers::{Layer, Layers, Mode, Weight};
use crate::read::convert::vec3;
use glam::{DQuat, DVec3};
use ufbx::{AnimValue, Element, RotationOrder};

/// A property of up to three numbers.
#[derive(Clone)]
pub(crate) struct Value<'a> {
    /// What it is where nothing moves it.
    pub(crate) fixed: DVec3,
    pub(super) parts: Vec<Part<'a>>,
    /// Its layers come together number by number: it hangs on a property that is no rotation or scale.
    pub(super) plain: bool,
}

/// What a layer says of it.
#[derive(Clone)]
pub(super) struct Part<'a> {
    pub(super) mode: Mode,
    pub(super) weight: Weight<'a>,
    pub(super) whole_rotations: bool,
    pub(super) multiplies: bool,
    pub(super) default: DVec3,
    pub(super) curves: [Option<Curve<'a>>; 3],
}

/// What a property's numbers mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Meaning {
    Plain,
    /// Degrees about three axes in this order.
    Angles(RotationOrder),
    Scale,
}

impl<'a> Value<'a> {
    /// Property `name` of `element`, or the one that it hangs on; `or` is what it is where the file says nothing.
    pub(crate) fn of(layers: &Layers<'a>, element: &'a Element, name: &'a str, or: DVec3) -> Self {
        match source_of(element, name).filter(|_| !layers.is_rest) {
            None => Self::own(layers, element, name, or),
            Some((source, property)) => Self {
                plain: !["Lcl Rotation", "Lcl Scaling"].contains(&property),
                ..Self::own(layers, source, property, DVec3::ZERO)
            },
        }
    }

    fn own(layers: &Layers<'a>, element: &'a Element, name: &str, or: DVec3) -> Self {
        let part = |layer: &Layer<'a>| {
            let prop = ufbx::find_anim_prop(layer.source, element, name)?;
            let value: &'a AnimValue = prop.anim_value.as_ref();
            Some(Part {
                mode: layer.mode,
                weight: layer.weight.clone(),
                whole_rotations: layer.whole_rotations,
                multiplies: layer.multiplies,
                default: without_curve(value, name),
                curves: value
                    .curves
                    .each_ref()
                    .map(|curve| Curve::of(curve.as_ref()?.as_ref())),
            })
        };
        Self {
            fixed: fixed(element, name, or),
            parts: layers.playing.iter().filter_map(part).collect(),
            plain: false,
        }
    }

    /// Whether anything moves it.
    pub(crate) fn moves(&self) -> bool {
        !self.parts.is_empty()
    }

    /// It is 0 at all times.
    pub(super) fn is_nothing(&self) -> bool {
        !self.moves() && self.fixed == DVec3::ZERO
    }

    /// The same, where the lowest layers that stand for all before them and never leave a value are that value: many programs
    /// give every property a curve.
    pub(super) fn settled(mut self) -> Self {
        let stands = |part: &&Part| {
            let mut curves = part.curves.iter().flatten();
            matches!(part.mode, Mode::Base | Mode::Override) && curves.all(Curve::stands)
        };
        let low = self.parts.iter().take_while(stands).count();
        for mut part in self.parts.drain(..low) {
            self.fixed = part.own(0.0);
        }
        self
    }

    /// What it is at `time`, seconds on the file's clock.
    pub(crate) fn at(&mut self, time: f64, meaning: Meaning) -> DVec3 {
        match &mut self.parts[..] {
            [] => return self.fixed,
            [part] if matches!(part.mode, Mode::Base | Mode::Override) => return part.own(time),
            _ => {}
        }
        let meaning = if self.plain { Meaning::Plain } else { meaning };
        let mut sum = self.fixed;
        for part in &mut self.parts {
            sum = part.upon(sum, time, meaning);
        }
        sum
    }
}

/// What property `name` of `element` is where nothing moves it; `or` is what it is where the file says nothing.
pub(crate) fn fixed(element: &Element, name: &str, or: DVec3) -> DVec3 {
    ufbx::find_prop(&element.props, name).map_or(or, |prop| {
        let v = prop.value_vec4;
        DVec3::new(v.x, v.y, v.z)
    })
}

impl Part<'_> {
    /// What it says itself.
    fn own(&mut self, time: f64) -> DVec3 {
        let mut own = self.default;
        for (axis, curve) in self.curves.iter_mut().enumerate() {
            if let Some(curve) = curve {
                own[axis] = curve.at(time);
            }
        }
        own
    }

    fn upon(&mut self, sum: DVec3, time: f64, meaning: Meaning) -> DVec3 {
        let own = self.own(time);
        if matches!(self.mode, Mode::Base | Mode::Override) {
            return own;
        }
        let weight = self.weight.at(time);
        let adds = self.mode == Mode::Additive;
        match meaning {
            Meaning::Scale if self.multiplies => {
                let rest = if adds { 1.0 } else { 1.0 - weight };
                power(sum, rest) * power(own, weight)
            }
            Meaning::Angles(order) if self.whole_rotations => {
                let (below, own) = (turn(sum, order), turn(own, order));
                angles(
                    match adds {
                        true => below * slerp(DQuat::IDENTITY, own, weight),
                        false => slerp(below, own, weight),
                    },
                    order,
                )
            }
            _ if adds => sum + own * weight,
            _ => sum * (1.0 - weight) + own * weight,
        }
    }
}

/// What numbers without a curve are: those of the curves' own node. ufbx reads these as `d|X` and so on; one
/// number alone goes by its property's name.
fn without_curve(value: &AnimValue, name: &str) -> DVec3 {
    let own = format!("d|{name}");
    match ufbx::find_prop(&value.element.props, &own) {
        Some(prop) => DVec3::splat(prop.value_vec4.x),
        None => vec3(value.default_value),
    }
}

/// Each number to a power from 0 to 1, with its sign.
fn power(v: DVec3, exponent: f64) -> DVec3 {
    match exponent {
        e if e <= 0.0 => DVec3::ONE,
        e if e >= 1.0 => v,
        e => v.abs().powf(e) * v.signum(),
    }
}

/// The shorter way from one rotation to another; whole ends are exact.
fn slerp(from: DQuat, to: DQuat, share: f64) -> DQuat {
    match share {
        s if s <= 0.0 => from,
        s if s >= 1.0 => to,
        s => from.slerp(to, s),
    }
}

/// The rotation by three angles, degrees.
pub(crate) fn turn(degrees: DVec3, order: RotationOrder) -> DQuat {
    // The first letter turns first. Turning about the second axis and then the first one turns about the third, one way or the other.
    let ([first, second, third], way) = match order {
        RotationOrder::Xyz => ([0, 1, 2], -1.0),
        RotationOrder::Xzy => ([0, 2, 1], 1.0),
        RotationOrder::Yzx => ([1, 2, 0], -1.0),
        RotationOrder::Yxz => ([1, 0, 2], 1.0),
        RotationOrder::Zxy => ([2, 0, 1], -1.0),
        RotationOrder::Zyx => ([2, 1, 0], 1.0),
        // ufbx gives none for it, nor does any reader of it say what it means.
        RotationOrder::Spheric => return DQuat::IDENTITY,
    };
    let [(s1, c1), (s2, c2), (s3, c3)] =
        [first, second, third].map(|axis| sin_cos(0.5 * degrees[axis]));
    // The product of the three quaternions, of which each has one axis.
    let [a, b, c, w] = [c2 * s1, s2 * c1, way * s2 * s1, c2 * c1];
    let mut out = [0.0, 0.0, 0.0, c3 * w - s3 * c];
    out[first] = c3 * a + way * s3 * b;
    out[second] = c3 * b - way * s3 * a;
    out[third] = c3 * c + s3 * w;
    DQuat::from_array(out)
}

/// Three angles of a rotation, degrees.
pub(super) fn angles(q: DQuat, order: RotationOrder) -> DVec3 {
    let q = ufbx::Quat {
        x: q.x,
        y: q.y,
        z: q.z,
        w: q.w,
    };
    vec3(ufbx::quat_to_euler(q, order))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_turn_as_ufbx_says() {
        use RotationOrder::{Xyz, Xzy, Yxz, Yzx, Zxy, Zyx};
        for order in [Xyz, Xzy, Yxz, Yzx, Zxy, Zyx] {
            let v = DVec3::new(31.0, -77.0, 412.0);
            let wanted = ufbx::euler_to_quat(
                ufbx::Vec3 {
                    x: v.x,
                    y: v.y,
                    z: v.z,
                },
                order,
            );
            let wanted = DQuat::from_xyzw(wanted.x, wanted.y, wanted.z, wanted.w);
            let off = turn(v, order).dot(wanted).abs();
            assert!((off - 1.0).abs() < 1e-12, "{order:?}: {off}");
        }
    }
}
