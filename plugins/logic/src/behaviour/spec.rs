//! A behaviour as it is written in RON.
//!
//! ```ron
//! (
//!     values: {"alert": 0.0, "rounds": 30, "seen": false},
//!     root: "guard",
//!     trees: {
//!         "guard": Choose([
//!             ([Of("alert", Rise(0.2, 0.8))], Use("attack")),
//!             ([Always(0.3)], Do("patrol")),
//!         ]),
//!         "attack": Sequence([If("rounds", Above(0.0)), DoWith("approach", {"speed": 3.0}), Do("shoot")]),
//!     },
//! )
//! ```

use serde::Deserialize;
use serde::de::{Deserializer, MapAccess, Visitor};
use std::fmt;
use std::marker::PhantomData;

/// A map as the pairs that stand in it, so that a name that is there twice is seen.
#[derive(Debug)]
pub(super) struct Pairs<'a, T>(pub Vec<(&'a str, T)>);

impl<T> Default for Pairs<'_, T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<'de: 'a, 'a, T: Deserialize<'de>> Deserialize<'de> for Pairs<'a, T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Reads<'a, T>(PhantomData<(&'a (), T)>);
        impl<'de: 'a, 'a, T: Deserialize<'de>> Visitor<'de> for Reads<'a, T> {
            type Value = Pairs<'a, T>;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a map with names")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut pairs = Vec::new();
                while let Some(pair) = map.next_entry::<&'de str, T>()? {
                    pairs.push((pair.0, pair.1));
                }
                Ok(Pairs(pairs))
            }
        }
        deserializer.deserialize_map(Reads(PhantomData))
    }
}

/// A file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[serde(bound(deserialize = "'de: 'a"))]
pub(super) struct File<'a> {
    /// Values that an agent starts with, unless it has them already.
    #[serde(default)]
    pub values: Pairs<'a, Literal<'a>>,
    /// Where an agent begins.
    pub root: &'a str,
    /// Trees by name.
    pub trees: Pairs<'a, Node<'a>>,
    /// Added to the score of the child of a `Choose` that runs.
    #[serde(default = "stay")]
    pub stay: f32,
}

/// A tenth of the greatest score: two that are nearly as good do not take turns.
const fn stay() -> f32 {
    0.1
}

/// A value.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
#[serde(bound(deserialize = "'de: 'a"))]
pub(super) enum Literal<'a> {
    Bool(bool),
    Int(i32),
    Float(f32),
    Vec3((f32, f32, f32)),
    Name(&'a str),
}

/// A node of a tree.
#[derive(Debug, Deserialize)]
#[serde(bound(deserialize = "'de: 'a"))]
pub(super) enum Node<'a> {
    /// One after the other, until one fails. Tests before the child that runs are asked again in each tick.
    Sequence(Vec<Node<'a>>),
    /// The first that does not fail, asked in each tick from the first on.
    Select(Vec<Node<'a>>),
    /// The one with the highest score, asked in each tick; fails where no score is above 0.
    Choose(Vec<(Vec<Consider<'a>>, Node<'a>)>),
    /// Fails where its child succeeds, and the other way.
    Not(Box<Node<'a>>),
    /// Succeeds whatever its child does.
    Anyway(Box<Node<'a>>),
    /// Again in the next tick, until its child fails; then it succeeds.
    Repeat(Box<Node<'a>>),
    /// Fails for so many seconds after its child ended.
    Cooldown(f32, Box<Node<'a>>),
    /// Fails when its child runs for longer than so many seconds.
    Limit(f32, Box<Node<'a>>),
    /// Asks a value.
    If(&'a str, Test<'a>),
    /// Sets a value.
    Set(&'a str, Literal<'a>),
    /// Runs for so many seconds.
    Wait(f32),
    /// Asks the entity that a value names to do something; succeeds, and fails where there is none.
    Send(&'a str, &'a str),
    /// Says an output of the agent, for wires to follow.
    Say(&'a str),
    /// A leaf.
    Do(&'a str),
    /// A leaf with parameters.
    DoWith(&'a str, Pairs<'a, Literal<'a>>),
    /// Another tree.
    Use(&'a str),
}

/// What a value is held against.
#[derive(Debug, Deserialize)]
#[serde(bound(deserialize = "'de: 'a"))]
pub(super) enum Test<'a> {
    Above(f32),
    Below(f32),
    Is(Literal<'a>),
    /// Whether it was ever set.
    Known,
    /// Whether it was never set.
    Unknown,
}

/// A factor of a score.
#[derive(Debug, Deserialize)]
#[serde(bound(deserialize = "'de: 'a"))]
pub(super) enum Consider<'a> {
    Always(f32),
    Of(&'a str, Curve),
}

/// From a number to 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub enum Curve {
    /// From 0 at the first number to 1 at the second, in a line.
    Rise(f32, f32),
    /// From 1 at the first number to 0 at the second, in a line.
    Fall(f32, f32),
    /// As `Rise`, without a corner: 3t² - 2t³.
    Smooth(f32, f32),
    /// 1 at the first number, and 0 where it is as far from it as the second says.
    Near(f32, f32),
    /// 1 from this number on.
    Step(f32),
}

impl Curve {
    /// The factor of a number.
    #[inline]
    #[must_use]
    pub fn at(self, x: f32) -> f32 {
        let ramp = |low: f32, high: f32| ((x - low) / (high - low)).clamp(0.0, 1.0);
        match self {
            Self::Rise(low, high) => ramp(low, high),
            Self::Fall(high, low) => 1.0 - ramp(high, low),
            Self::Smooth(low, high) => {
                let t = ramp(low, high);
                t * t * (3.0 - 2.0 * t)
            }
            Self::Near(middle, width) => 1.0 - ((x - middle).abs() / width).min(1.0),
            Self::Step(from) => f32::from(u8::from(x >= from)),
        }
    }

    /// Its numbers, and whether they mean something: the second of a ramp lies above the first.
    pub(super) fn check(self) -> (bool, bool) {
        match self {
            Self::Rise(a, b) | Self::Fall(a, b) | Self::Smooth(a, b) => {
                (a.is_finite() && b.is_finite(), a < b)
            }
            Self::Near(a, width) => (a.is_finite() && width.is_finite(), width > 0.0),
            Self::Step(a) => (a.is_finite(), true),
        }
    }
}
