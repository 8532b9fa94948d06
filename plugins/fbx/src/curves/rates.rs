//! Majorants of what places nodes, and of blend weights, over a span between keys.

use super::majorant::Majorant;
use super::number::Number;
use super::over::Over;
use super::pose::{BlendWeight, NodeCurves, Turn};
use super::squares::Squares;
use crate::model::Trs;
use crate::read::convert::vec3;
use ufbx::RotationOrder;

impl Turn<'_> {
    fn over(&mut self, over: Over) -> Majorant {
        match self.angles.moves() {
            false => Majorant::still(1.0),
            true => self.angles.turned_over(over, RotationOrder::Xyz),
        }
    }
}

/// Majorants of what places a node below its parent: of the translation's length, and of the sizes of the matrices that
/// turn it and that scale it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rates {
    pub(crate) translation: Majorant,
    pub(crate) turn: Majorant,
    pub(crate) scale: Majorant,
}

impl Rates {
    pub(crate) const UNKNOWN: Self = Self {
        translation: Majorant::UNKNOWN,
        turn: Majorant::UNKNOWN,
        scale: Majorant::UNKNOWN,
    };

    /// Of what stands still.
    pub(crate) fn still(pose: &Trs) -> Self {
        Self {
            translation: Majorant::still(pose.translation.length()),
            turn: Majorant::still(1.0),
            scale: Majorant::still(pose.scale.abs().max_element()),
        }
    }
}

/// Of the largest of three.
fn largest(parts: &[Number; 3]) -> Majorant {
    parts[0].moves.max(&parts[1].moves).max(&parts[2].moves)
}

impl NodeCurves<'_> {
    /// Over a span between keys. Mirrored axes and turned cameras change no length.
    pub(crate) fn over(&mut self, over: Over) -> Rates {
        let node = self.node;
        let order = self.rotation_order(over.middle());
        // Between two whole numbers the order is the lower one's.
        let changes = self.order.moves() && {
            let [number, ..] = self.order.over(over, false);
            number.low().trunc() != number.high().trunc()
        };
        let mut helped = [Number::still(1.0); 3];
        let above = self.helpers.len() - usize::from(self.parent_helps);
        let by = |a: &[Number; 3], b: &[Number; 3]| [0, 1, 2].map(|i| a[i].product(&b[i]));
        for helper in &mut self.helpers[..above] {
            helped = by(&helped, &helper.over(over, true));
        }
        let own = self.scale.over(over, true);
        let spin = self.spin_over(over, order, changes);
        let lengths = |parts: &[Number; 3]| Majorant::length(&parts.map(|number| number.moves));
        let translation = self.translation.over(over, false);
        let mut places = match self.has_pivots {
            false => lengths(&translation),
            true => {
                let about = match &mut self.taken {
                    Some(taken) => taken.over(over, true),
                    None => own,
                };
                let pivot = self.scale_pivot.over(over, false);
                let turned_at = self.rotation_pivot.over(over, false);
                let offset = self.scale_offset.over(over, false);
                let place = [0, 1, 2].map(|i| {
                    pivot[i]
                        .minus(&pivot[i].product(&about[i]))
                        .plus(&offset[i])
                        .minus(&turned_at[i])
                });
                let swung = spin.product(&lengths(&place));
                let around = self.rotation_offset.over(over, false);
                let shift = [0, 1, 2].map(|i| turned_at[i].plus(&around[i]).plus(&translation[i]));
                swung.plus(&lengths(&shift))
            }
        };
        if let Some(helper) = self.helpers.get_mut(above) {
            let all = by(&helped, &helper.over(over, true));
            places = places.product(&largest(&all));
        }
        let mut sizes = largest(&own);
        if node.has_adjust_transform {
            places.0[0] += vec3(node.adjust_pre_translation).length();
            places = places.scaled(node.adjust_pre_scale * node.adjust_translation_scale);
            sizes = sizes.scaled(node.adjust_pre_scale * node.adjust_post_scale);
        }
        if node.is_scale_helper {
            sizes = sizes.product(&largest(&helped));
        }
        Rates {
            translation: places,
            turn: spin,
            scale: sizes,
        }
    }
}

impl NodeCurves<'_> {
    /// Of the squares of its scales over a span between keys.
    pub(crate) fn squares_over(&mut self, over: Over) -> Squares {
        let node = self.node;
        let mut scale = self.scale.over(over, true);
        if node.is_scale_helper {
            let above = self.helpers.len() - usize::from(self.parent_helps);
            for helper in &mut self.helpers[..above] {
                let helped = helper.over(over, true);
                scale = [0, 1, 2].map(|i| scale[i].product(&helped[i]));
            }
        }
        let mut squares = Squares::of(&scale);
        if self.own_aside.is_some() {
            squares = squares.in_any_order();
        }
        match node.has_adjust_transform {
            true => squares.scaled(node.adjust_pre_scale * node.adjust_post_scale),
            false => squares,
        }
    }

    /// The majorant of the matrix that turns it; `changes` says that its order does.
    fn spin_over(&mut self, over: Over, order: RotationOrder, changes: bool) -> Majorant {
        let around = self.node.use_rotation_space;
        let stands = !around || !self.before.angles.moves() && !self.after.angles.moves();
        if stands
            && !changes
            && order != RotationOrder::Spheric
            && let Some(sum) = self.rotation.sum_over(over)
        {
            return sum.rotation();
        }
        let turned = match around {
            true if changes => Majorant::within(1.0, 2.0),
            true => self.rotation.turned_over(over, order),
            false => self.rotation.turned_over(over, RotationOrder::Xyz),
        };
        let spin = match around {
            true => {
                let before = self.before.over(over).product(&turned);
                before.product(&self.after.over(over)).near(2.0)
            }
            false => turned,
        };
        // A quaternion turns a vector from both sides.
        spin.product(&spin).near(2.0)
    }
}

impl BlendWeight<'_> {
    /// As a share.
    pub(crate) fn over(&mut self, over: Over) -> Number {
        let percent = self.percent.over(over, false)[0];
        Number::of(percent.middle / 100.0, percent.moves.scaled(0.01))
    }
}
