//! Majorants of what places nodes, and of blend weights, over a span between keys.

use super::majorant::Majorant;
use super::number::Number;
use super::over::Over;
use super::pose::{BlendWeight, NodeCurves, Turn};
use super::squares::Squares;
use crate::model::Trs;
use crate::read::convert::vec3;
use ufbx::{Node, RotationOrder};

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
    pub(crate) turn: Turning,
    pub(crate) scale: Majorant,
}

/// What is known of a matrix that turns: by what angle, all axes together, or the majorant of the matrix itself.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Turning {
    /// Radians: the matrix has the majorant of the exponential of this.
    By(Majorant),
    Whole(Majorant),
}

impl Turning {
    pub(crate) const STILL: Self = Self::By(Majorant::ZERO);

    /// The majorant of the matrix.
    pub(crate) fn whole(&self) -> Majorant {
        match self {
            Self::By(angle) => angle.rotation(),
            Self::Whole(turn) => *turn,
        }
    }
}

impl Rates {
    pub(crate) const UNKNOWN: Self = Self {
        translation: Majorant::UNKNOWN,
        turn: Turning::Whole(Majorant::UNKNOWN),
        scale: Majorant::UNKNOWN,
    };

    /// Of what stands still.
    pub(crate) fn still(pose: &Trs) -> Self {
        Self {
            translation: Majorant::still(pose.translation.length()),
            turn: Turning::STILL,
            scale: Majorant::still(pose.scale.abs().max_element()),
        }
    }
}

/// Of the length of a vector.
fn lengths(parts: &[Number; 3]) -> Majorant {
    Majorant::length(&parts.map(|number| number.moves))
}

/// In glTF's axes and unit: of the length of a translation, and of a scale.
fn adjusted(node: &Node, mut places: Majorant, sizes: Majorant) -> (Majorant, Majorant) {
    if !node.has_adjust_transform {
        return (places, sizes);
    }
    places.0[0] += vec3(node.adjust_pre_translation).length();
    (
        places.scaled(node.adjust_pre_scale * node.adjust_translation_scale),
        sizes.scaled(node.adjust_pre_scale * node.adjust_post_scale),
    )
}

/// Of the largest of three.
fn largest(parts: &[Number; 3]) -> Majorant {
    parts[0].moves.max(&parts[1].moves).max(&parts[2].moves)
}

impl NodeCurves<'_> {
    /// Over a span between keys. Mirrored axes and turned cameras change no length.
    pub(crate) fn over(&mut self, over: Over) -> Rates {
        let turn = self.spin_over(over);
        if let Some((translation, scale)) = self.turns_alone {
            return Rates {
                translation,
                turn,
                scale,
            };
        }
        let (translation, scale) = self.places_over(over, &turn);
        if self.only_turns() {
            self.turns_alone = Some((translation, scale));
        }
        Rates {
            translation,
            turn,
            scale,
        }
    }

    /// Nothing but how it is turned moves, and that moves nothing else.
    fn only_turns(&self) -> bool {
        !self.has_pivots && !self.translation.moves() && !self.scales()
    }

    /// Of the translation's length and of the scales, where it is turned so.
    fn places_over(&mut self, over: Over, turn: &Turning) -> (Majorant, Majorant) {
        let node = self.node;
        if self.helpers.is_empty() && !self.has_pivots {
            let places = match self.translation.moves() {
                true => lengths(&self.translation.over(over, false)),
                false => Majorant::still(self.translation.fixed.length()),
            };
            let sizes = match self.scale.moves() {
                true => largest(&self.scale.over(over, true)),
                false => Majorant::still(self.scale.fixed.abs().max_element()),
            };
            return adjusted(node, places, sizes);
        }
        let mut helped = [Number::still(1.0); 3];
        let above = self.helpers.len() - usize::from(self.parent_helps);
        let by = |a: &[Number; 3], b: &[Number; 3]| [0, 1, 2].map(|i| a[i].product(&b[i]));
        for helper in &mut self.helpers[..above] {
            helped = by(&helped, &helper.over(over, true));
        }
        let own = self.scale.over(over, true);
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
                let swung = turn.whole().product(&lengths(&place));
                let around = self.rotation_offset.over(over, false);
                let shift = [0, 1, 2].map(|i| turned_at[i].plus(&around[i]).plus(&translation[i]));
                swung.plus(&lengths(&shift))
            }
        };
        if let Some(helper) = self.helpers.get_mut(above) {
            let all = by(&helped, &helper.over(over, true));
            places = places.product(&largest(&all));
        }
        let (places, mut sizes) = adjusted(node, places, largest(&own));
        if node.is_scale_helper {
            sizes = sizes.product(&largest(&helped));
        }
        (places, sizes)
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

    /// Of the matrix that turns it.
    fn spin_over(&mut self, over: Over) -> Turning {
        let order = self.rotation_order(over.middle());
        // Between two whole numbers the order is the lower one's.
        let changes = self.order.moves() && {
            let [number, ..] = self.order.over(over, false);
            number.low().trunc() != number.high().trunc()
        };
        let around = self.node.use_rotation_space;
        let stands = !around || !self.before.angles.moves() && !self.after.angles.moves();
        if stands
            && !changes
            && order != RotationOrder::Spheric
            && let Some(sum) = self.rotation.sum_over(over)
        {
            return Turning::By(sum);
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
        Turning::Whole(spin.product(&spin).near(2.0))
    }
}

impl BlendWeight<'_> {
    /// As a share.
    pub(crate) fn over(&mut self, over: Over) -> Number {
        let percent = self.percent.over(over, false)[0];
        Number::of(percent.middle / 100.0, percent.moves.scaled(0.01))
    }
}
