//! With which definitions the pipelines of a producer's draws are made. The pipelines take them from here,
//! and whoever checks shaders can list them without a GPU.

use bevy::mesh::PrimitiveTopology::LineList;
use bevy::shader::ShaderDefVal;

use super::traits::DrawTraits;

/// A shader that a pipeline asks for.
#[derive(Clone, Debug)]
pub struct ShaderVariant {
    /// Path below `shaders/src`.
    pub file: &'static str,
    /// Its text, a producer's functions named in it.
    pub source: String,
    /// What is set while it is composed.
    pub defs: Vec<ShaderDefVal>,
}

/// The entry file of draws.
pub const DRAW_FILE: &str = "geometry/draw.wgsl";

/// What the shader of a view's draw depends on.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Look {
    /// Whether edges are drawn.
    pub lines: bool,
    /// What it draws into.
    pub target: Target,
}

/// What a view draws into.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Target {
    /// Bevy's G-buffer.
    GBuffer {
        /// Whether it holds normals.
        normals: bool,
        /// Whether it holds motion vectors.
        motion: bool,
    },
    /// What is kept of surfaces until they are shaded ([`DrawTraits::shaded_once`]).
    Surfaces,
    /// Bevy's G-buffer, from these.
    Once {
        /// Whether it holds normals.
        normals: bool,
        /// Whether it holds motion vectors.
        motion: bool,
    },
    /// The picture itself.
    Picture {
        /// Whether it holds sRGB numbers that the device takes as they are.
        encoded: bool,
    },
}

impl Look {
    fn all() -> impl Iterator<Item = Self> {
        const BOTH: [bool; 2] = [false, true];
        let gbuffers = BOTH
            .into_iter()
            .flat_map(|normals| BOTH.map(|motion| Target::GBuffer { normals, motion }));
        let targets = gbuffers.chain(BOTH.map(|encoded| Target::Picture { encoded }));
        targets.flat_map(|target| BOTH.map(|lines| Self { lines, target }))
    }

    /// Those of producers whose surfaces are shaded once a pixel.
    fn once() -> impl Iterator<Item = Self> {
        const BOTH: [bool; 2] = [false, true];
        let shaded = BOTH
            .into_iter()
            .flat_map(|normals| BOTH.map(|motion| Target::Once { normals, motion }));
        let targets = [Target::Surfaces].into_iter().chain(shaded);
        targets.map(|target| Self {
            lines: false,
            target,
        })
    }

    /// Definitions of a producer's draw in a view that looks so.
    pub fn defs(self, own: &[ShaderDefVal], traits: &DrawTraits) -> Vec<ShaderDefVal> {
        let fetched = traits.fetches(self.lines);
        let (normals, motion) = match self.target {
            Target::GBuffer { normals, motion } | Target::Once { normals, motion } => {
                (normals, motion)
            }
            Target::Surfaces | Target::Picture { .. } => (false, false),
        };
        let direct = matches!(self.target, Target::Picture { .. });
        let encoded = self.target == Target::Picture { encoded: true };
        let surfaces = self.target == Target::Surfaces;
        let once = matches!(self.target, Target::Once { .. });
        with(
            of_producer(own, traits),
            [
                (direct, "DIRECT"),
                (!direct && !surfaces, "GBUFFER"),
                (surfaces, "GEOMETRY_SURFACE"),
                (once, "GEOMETRY_ONCE"),
                // Segments are lines already.
                (self.lines && fetched, "GEOMETRY_LINES"),
                (fetched, "GEOMETRY_FETCH"),
                (direct && traits.vertex_shaded, "GEOMETRY_VERTEX_SHADED"),
                (encoded, "GEOMETRY_ENCODED"),
                (normals, "NORMAL_PREPASS"),
                (motion, "MOTION_VECTORS"),
            ],
        )
    }
}

/// Definitions of a producer's draws into shadow maps.
pub fn shadow_defs(own: &[ShaderDefVal], traits: &DrawTraits) -> Vec<ShaderDefVal> {
    let fetched = traits.fetches(false);
    with(
        of_producer(own, traits),
        [(true, "GEOMETRY_SHADOW"), (fetched, "GEOMETRY_FETCH")],
    )
}

/// Every shader that a pipeline of a producer's draws may ask for, whatever views and lights there are: `source` is
/// that of its [`DrawShader`](super::DrawShader), `own` are the definitions of its functions.
#[must_use]
pub fn draw_variants(
    source: &str,
    own: &[ShaderDefVal],
    traits: &DrawTraits,
) -> Vec<ShaderVariant> {
    let sets = definitions(own, traits).into_iter();
    let variants = sets.map(|defs| ShaderVariant {
        file: DRAW_FILE,
        source: source.to_owned(),
        defs,
    });
    variants.collect()
}

fn definitions(own: &[ShaderDefVal], traits: &DrawTraits) -> Vec<Vec<ShaderDefVal>> {
    let mut all = Vec::new();
    if traits.shadows {
        all.push(shadow_defs(own, traits));
    }
    let once = Look::once().filter(|_| traits.shaded_once);
    for look in Look::all().chain(once) {
        let defs = look.defs(own, traits);
        // A producer may not tell two looks apart.
        if !all.contains(&defs) {
            all.push(defs);
        }
    }
    all
}

/// Definitions that all draws of a producer have.
fn of_producer(own: &[ShaderDefVal], traits: &DrawTraits) -> Vec<ShaderDefVal> {
    with(
        own.to_vec(),
        [
            (traits.evaluated, "GEOMETRY_EVALUATED"),
            (traits.moves, "GEOMETRY_MOVES"),
            (traits.amplified > 0, "GEOMETRY_AMPLIFY"),
            (traits.topology == LineList, "GEOMETRY_SEGMENTS"),
        ],
    )
}

fn with<const N: usize>(mut defs: Vec<ShaderDefVal>, more: [(bool, &str); N]) -> Vec<ShaderDefVal> {
    let set = more.into_iter().filter(|(on, _)| *on);
    defs.extend(set.map(|(_, name)| ShaderDefVal::from(name)));
    defs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_variant_differs() {
        let traits = DrawTraits::default();
        let all = definitions(&["OWN".into()], &traits);
        // One for shadow maps; four G-buffers and two pictures, with lines and without.
        assert_eq!(all.len(), 1 + 2 * (4 + 2));
        assert!(all.iter().all(|defs| defs.contains(&"OWN".into())));
        let quiet = DrawTraits {
            shadows: false,
            topology: LineList,
            ..traits
        };
        assert_eq!(definitions(&[], &quiet).len(), 4 + 2, "segments are lines");
        let once = DrawTraits {
            shaded_once: true,
            ..traits
        };
        // What is kept of surfaces, and the four G-buffers that they are shaded into.
        assert_eq!(definitions(&[], &once).len(), all.len() + 1 + 4);
    }
}
