//! What grows, as data: a RON file of kinds. A field that is left out has its default, one that is unknown is
//! refused. `assets/kinds.ron` of this crate names them all; [`Kinds::small_set`] is what it says.
//!
//! Lengths are metres, angles radians, slopes rise over run, colours linear and between 0 and 1.

use serde::{Deserialize, Serialize};

use crate::band::Band;

/// Most kinds of a file.
pub const MOST_KINDS: usize = 32;

/// Most roots a square metre: those of the finest lattice.
pub const MOST_DENSITY: f32 = 4096.0;

/// The kinds of a file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Kinds {
    /// In the order in which they are listed.
    pub kinds: Vec<Kind>,
}

/// One kind of plant or rock.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Kind {
    /// Its name, of which its seed is made: roots stay where they are when kinds are added or put in another order.
    pub name: String,
    /// What it looks like.
    pub shape: Shape,
    /// Roots a square metre where it grows best, 0 to [`MOST_DENSITY`].
    pub density: f32,
    /// Heights above the sea (above 0 where there is none) between which it grows.
    #[serde(default)]
    pub height: Band,
    /// Slopes between which it grows.
    #[serde(default = "Band::of_slopes")]
    pub slope: Band,
    /// Whether it grows in clumps.
    #[serde(default)]
    pub clumps: Option<Clumps>,
    /// Other kinds of meshes in this list, and how far from their roots it keeps.
    #[serde(default)]
    pub keeps_off: Vec<KeepOff>,
    /// How far away it is drawn, 1 to 20 000.
    #[serde(default = "default_reach")]
    pub reach: f32,
}

/// Clumps: cells about scattered middles. Kinds that name the same pattern have the same clumps; ranges that do not
/// overlap exclude each other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Clumps {
    /// Name of the pattern.
    pub of: String,
    /// How wide a clump is, 0.25 to 1000, rounded to a power of two.
    pub size: f32,
    /// Each clump has a random number in [0, 1); this kind grows from here,
    #[serde(default)]
    pub from: f32,
    /// up to here.
    #[serde(default = "one")]
    pub to: f32,
    /// How much clumps differ in density and height, 0 to 1.
    #[serde(default)]
    pub uneven: f32,
}

/// A kind that another keeps off.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KeepOff {
    /// Its name.
    pub kind: String,
    /// Distance of the roots, 0 to 32.
    pub distance: f32,
}

/// What a kind looks like.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Shape {
    /// A blade of grass.
    Blade(Blade),
    /// A stem with petals.
    Flower(Flower),
    /// Kelp: a chain of segments that floats up from its root.
    Chain(Chain),
    /// An instance of a mesh: trees, rocks.
    Mesh(Mesh),
}

/// A blade of grass: a curve that narrows to its tip.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Blade {
    /// Least and greatest length, 0.01 to 10.
    pub length: (f32, f32),
    /// Width at the root, 0.0005 to 1.
    pub width: f32,
    /// Angle of the root from the vertical, at most; 0 to 1.5.
    #[serde(default = "default_lean")]
    pub lean: f32,
    /// How far the tip hangs over, as a share of the length; 0 to 1.
    #[serde(default = "default_droop")]
    pub droop: f32,
    /// Colours.
    pub look: Look,
}

/// Colours and movement of what is thin.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Look {
    /// At the root.
    pub root: [f32; 3],
    /// At the tip.
    pub tip: [f32; 3],
    /// Of dry tips.
    pub dry: [f32; 3],
    /// Share of dry ones, 0 to 1.
    #[serde(default)]
    pub dry_share: f32,
    /// Share of the light from behind that comes through, 0 to 1.
    #[serde(default = "default_translucency")]
    pub translucency: f32,
    /// How far the tip moves in a wind of 1 m/s, as a share of the length; 0 to 1.
    #[serde(default = "default_sway")]
    pub sway: f32,
}

/// A flower: a stem, which is a blade, and petals around its tip.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Flower {
    /// Its stem.
    pub stem: Blade,
    /// How many petals, 3 to 12.
    pub petals: u32,
    /// Radius of the blossom, 0.002 to 1.
    pub radius: f32,
    /// Colour of the petals.
    pub colour: [f32; 3],
    /// Colour of the middle.
    pub middle: [f32; 3],
}

/// Kelp. Segments are as many as its length asks for. What is longer than the water is deep lies on the surface, and goes
/// where the wind blows: the canopy.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Chain {
    /// Length of a segment, 0.05 to 2.
    pub segment: f32,
    /// Most segments, 2 to 64.
    pub segments: u32,
    /// Length of the shortest and the longest as a share of the depth of the water, 0.05 to 3.
    pub rise: (f32, f32),
    /// Width of the ribbon under water, 0.001 to 2; on the surface it has leaves that are [`crate::chain::LEAF`] times as wide.
    pub width: f32,
    /// Greatest angle between segments that follow each other, 0 to 0.8.
    pub twist: f32,
    /// Colours.
    pub look: Look,
}

/// Instances of a mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mesh {
    /// glTF files by asset path, each with its levels of detail as the meshes of the file, finest first; one of them by
    /// hash of the root.
    pub files: Vec<String>,
    /// Least and greatest scale, 0.01 to 100.
    pub scale: (f32, f32),
    /// How deep the root stands in the ground, at a scale of 1; -10 to 10.
    #[serde(default)]
    pub sink: f32,
    /// How much it leans with the slope: 0 upright, 1 square to the ground.
    #[serde(default)]
    pub follow: f32,
    /// Height, at a scale of 1: from which distance a level is fine enough.
    pub height: f32,
}

const fn default_reach() -> f32 {
    200.0
}
const fn one() -> f32 {
    1.0
}
const fn default_lean() -> f32 {
    0.5
}
const fn default_droop() -> f32 {
    0.3
}
const fn default_translucency() -> f32 {
    0.4
}
const fn default_sway() -> f32 {
    0.05
}

impl Kinds {
    /// The kind of a name, and its place in the list.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<(usize, &Kind)> {
        self.kinds
            .iter()
            .enumerate()
            .find(|(_, kind)| kind.name == name)
    }
}

/// What several tests need.
#[cfg(test)]
pub(crate) mod defaults {
    use super::{Blade, Kinds, Shape};
    use crate::density::Growth;

    /// The grass of the small set.
    pub fn grass() -> (Blade, Growth) {
        let kinds = Kinds::small_set();
        let (_, kind) = kinds.find("grass").expect("there");
        let Shape::Blade(blade) = kind.shape else {
            panic!("grass has blades");
        };
        (blade, Growth::new(kind, 1))
    }
}
