//! Which layers of a stack play, and how they come together.

use super::curve::Curve;
use super::hanging::source_of;
use ufbx::{AnimLayer, AnimStack, AnimValue, Element, Props, Scene};

/// How a layer comes upon those before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Mode {
    /// It is the stack's first: its values stand for those of the file's rest.
    Base,
    /// Its values are added, as far as it weighs.
    Additive,
    /// Its values stand for those before, whatever it weighs.
    Override,
    /// Its values stand for those before as far as it weighs.
    Through,
}

/// What files leave open, read in another way than usual, to know what the difference comes to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Reading {
    /// Overriding layers override whole, and modes without a name override.
    #[default]
    Usual,
    /// Overriding layers of less than 100 % are lessened by their weight.
    OverrideFades,
    /// Modes without a name add.
    UnnamedAdds,
}

/// How much of a layer plays, 0 to 1.
#[derive(Clone)]
pub(crate) enum Weight<'a> {
    Fixed(f64),
    /// Per cent.
    Keyed(Curve<'a>),
}

impl Weight<'_> {
    pub(crate) fn at(&mut self, time: f64) -> f64 {
        match self {
            Self::Fixed(weight) => *weight,
            Self::Keyed(curve) => portion(curve.at(time)),
        }
    }
}

/// Per cent as a share from 0 to 1.
fn portion(percent: f64) -> f64 {
    match percent.is_finite() {
        true => (percent / 100.0).clamp(0.0, 1.0),
        false => 1.0,
    }
}

/// A layer that plays.
#[derive(Clone)]
pub(crate) struct Layer<'a> {
    pub(crate) source: &'a AnimLayer,
    pub(crate) mode: Mode,
    pub(crate) weight: Weight<'a>,
    /// The curves of its weight.
    pub(crate) weight_value: Option<&'a AnimValue>,
    /// Rotations come together as rotations, not angle by angle.
    pub(crate) whole_rotations: bool,
    /// Scales are multiplied, not added.
    pub(crate) multiplies: bool,
    /// What of it can be read in another way.
    pub(crate) doubt: Option<Reading>,
}

/// The layers of a stack that play, lowest first.
pub(crate) struct Layers<'a> {
    pub(crate) playing: Vec<Layer<'a>>,
    /// All of the stack's play, and no weight has keys: ufbx evaluates them as they are.
    pub(crate) is_plain: bool,
    /// They are no stack's: everything stands as the file has it at rest.
    pub(super) is_rest: bool,
}

impl<'a> Layers<'a> {
    /// No layer at all: what is left is the file's rest.
    pub(crate) fn none() -> Self {
        Self {
            playing: Vec::new(),
            is_plain: true,
            is_rest: true,
        }
    }

    /// Those of a stack.
    pub(crate) fn of(scene: &'a Scene, stack: &'a AnimStack, reading: Reading) -> Self {
        let playing: Vec<Layer> = playing(stack)
            .map(|(index, layer)| of(scene, layer, index == 0, reading))
            .collect();
        Self {
            is_plain: playing.len() == stack.layers.len()
                && playing.iter().all(|layer| layer.weight_value.is_none()),
            playing,
            is_rest: false,
        }
    }

    /// What moves property `name` of `element` where it hangs on another property.
    pub(crate) fn hanging(
        &self,
        element: &'a Element,
        name: &str,
    ) -> impl Iterator<Item = &'a AnimValue> {
        let source = source_of(element, name);
        let layers = source.into_iter().flat_map(|source| {
            let playing = self.playing.iter().map(|layer| layer.source);
            playing.map(move |layer| (layer, source))
        });
        layers.filter_map(|(layer, (element, name))| {
            let prop = ufbx::find_anim_prop(layer, element, name)?;
            Some(prop.anim_value.as_ref())
        })
    }

    /// Ways to read them otherwise that may come to something else.
    pub(crate) fn doubts(&self) -> impl Iterator<Item = (Reading, &'a AnimLayer)> {
        self.playing
            .iter()
            .filter_map(|layer| Some((layer.doubt?, layer.source)))
    }
}

/// Layers of a stack that play, lowest first, each with its number among all. Muted ones do not; where some
/// play solo, the others do not.
pub(crate) fn playing(stack: &AnimStack) -> impl Iterator<Item = (usize, &AnimLayer)> {
    let is = |layer: &AnimLayer, name| number(&layer.element.props, name) != 0;
    let solo = (&stack.layers).into_iter().any(|layer| is(layer, "Solo"));
    let plays = move |layer: &AnimLayer| !is(layer, "Mute") && (!solo || is(layer, "Solo"));
    let all = (&stack.layers).into_iter().enumerate();
    all.filter(move |(_, layer)| plays(layer))
}

fn of<'a>(scene: &'a Scene, layer: &'a AnimLayer, is_base: bool, reading: Reading) -> Layer<'a> {
    let props = &layer.element.props;
    let fixed = ufbx::find_prop(props, "Weight").map_or(1.0, |prop| portion(prop.value_vec4.x));
    let weight_value = weight_value(scene, layer).filter(|_| !is_base);
    let curve = weight_value.and_then(|value| Curve::of(value.curves[0].as_ref()?));
    let weight = curve.map_or(Weight::Fixed(fixed), Weight::Keyed);
    let lessened = !matches!(weight, Weight::Fixed(w) if w >= 1.0);
    let (mode, doubt) = match number(props, "BlendMode") {
        _ if is_base => (Mode::Base, None),
        0 => (Mode::Additive, None),
        1 => match reading {
            Reading::OverrideFades => (Mode::Through, None),
            _ => (Mode::Override, lessened.then_some(Reading::OverrideFades)),
        },
        2 => (Mode::Through, None),
        _ => match reading {
            Reading::UnnamedAdds => (Mode::Additive, None),
            _ => (Mode::Override, Some(Reading::UnnamedAdds)),
        },
    };
    Layer {
        source: layer,
        mode,
        weight,
        weight_value,
        whole_rotations: number(props, "RotationAccumulationMode") == 0,
        multiplies: number(props, "ScaleAccumulationMode") == 0,
        doubt,
    }
}

fn number(props: &Props, name: &str) -> i64 {
    ufbx::find_prop(props, name).map_or(0, |prop| prop.value_int)
}

/// The curves of a layer's weight, in whichever layer they lie.
fn weight_value<'a>(scene: &'a Scene, layer: &AnimLayer) -> Option<&'a AnimValue> {
    let is_its = |value: &&AnimValue| {
        value.element.connections_src.iter().any(|c| {
            c.dst.element_id == layer.element.element_id && c.dst_prop.as_ref() == "Weight"
        })
    };
    (&scene.anim_values).into_iter().find(is_its)
}
