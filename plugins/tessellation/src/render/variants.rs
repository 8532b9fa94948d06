//! Which shaders, with which definitions, the pipelines of a kind are made of. The pipelines take them from
//! here, and whoever checks shaders can list them without a GPU.

use bevy::prelude::*;
use bevy::shader::ShaderDefVal;

use super::kind::{PatchKind, PatchShader};
use super::pipeline::fetches;
use super::prepare::KindTraits;
use crate::{Domain, Mode, Spacing, Winding};

/// The passes of a tessellation: file, entry point, and whether it reads what passes before it wrote.
pub(super) const PASSES: [(&str, &str, bool); 6] = [
    ("stage/control.wgsl", "control_patches", false),
    ("stage/measure.wgsl", "measure", false),
    ("stage/plan.wgsl", "plan", false),
    ("stage/place_items.wgsl", "place_items", false),
    ("stage/emit_vertices.wgsl", "emit_vertices", true),
    ("stage/emit_grid.wgsl", "emit_grid", true),
];
/// The pass that closes the sides; not of isolines, which have none.
pub(super) const STRIPS: (&str, &str, bool) = ("stage/emit_strips.wgsl", "emit_strips", true);
/// What shadow views see, of kinds with a bounds function.
pub(super) const RANGES: (&str, &str, bool) = ("stage/shadow_ranges.wgsl", "shadow_ranges", true);
/// Draws of every sort.
pub(super) const DRAW: &str = "stage/draw.wgsl";

/// A shader that a pipeline of a kind asks for.
#[derive(Clone, Debug)]
pub struct StageVariant {
    /// Path below `shaders/src`.
    pub file: &'static str,
    /// Its text, the user's functions named in it.
    pub source: String,
    /// What is set while it is composed.
    pub defs: Vec<ShaderDefVal>,
}

/// The kinds of an app, for whoever checks their shaders: name, and [`stage_variants`].
#[derive(Resource, Clone, Debug, Default)]
pub struct KindVariants(pub Vec<(&'static str, fn() -> Vec<StageVariant>)>);

/// Every shader that a pipeline of the kind `K` may ask for, whatever views and lights there are.
#[must_use]
pub fn stage_variants<K: PatchKind>() -> Vec<StageVariant> {
    let traits = &KindTraits::of::<K>();
    let of_kind = kind_defs::<K>();
    let variant = |file, defs| StageVariant {
        file,
        source: source::<K>(file),
        defs,
    };
    let strips = (K::LAYOUT.domain != Domain::Isolines).then_some(&STRIPS);
    let ranges = traits.bounded.then_some(&RANGES);
    let passes = PASSES.iter().chain(strips).chain(ranges);
    let mut all: Vec<StageVariant> = passes
        .map(|(file, _, reads)| variant(*file, pass_defs(&of_kind, *reads)))
        .collect();
    all.push(variant(DRAW, shadow_defs(&of_kind, traits)));
    for look in Look::all() {
        let defs = look.defs(&of_kind, traits);
        // A kind may not tell two looks apart.
        if all.iter().all(|known| known.file != DRAW || known.defs != defs) {
            all.push(variant(DRAW, defs));
        }
    }
    all
}

/// The text of one of the stage's files, the user's functions named in it.
pub(super) fn source<K: PatchKind>(file: &str) -> String {
    let given = match K::shader() {
        PatchShader::File(path) => format!("\"{path}\"::"),
        PatchShader::Library(path) => format!("{path}::"),
    };
    let mut source = dolomite_shaders::find(file)
        .source
        .replace("dolomite::stage::user::", &given);
    for (own, module) in [
        (K::AMPLIFIED > 0, "dolomite::stage::user_amplify::"),
        (K::BOUNDED, "dolomite::stage::user_bounds::"),
        (K::CUSTOM_MATERIAL, "dolomite::stage::user_material::"),
    ] {
        if own {
            source = source.replace(module, &given);
        }
    }
    source
}

/// The kind's rules, as `rules.wgsl` reads them.
pub(super) fn kind_defs<K: PatchKind>() -> Vec<ShaderDefVal> {
    let mut defs = Vec::new();
    match K::LAYOUT.domain {
        Domain::Triangles => {}
        Domain::Quads => defs.extend(["STAGE_QUADS", "STAGE_FOUR_POINTS"]),
        Domain::Isolines => defs.extend(["STAGE_ISOLINES", "STAGE_FOUR_POINTS"]),
    }
    match K::SPACING {
        Spacing::Equal => {}
        Spacing::FractionalEven => defs.push("STAGE_FRACTIONAL_EVEN"),
        Spacing::FractionalOdd => defs.push("STAGE_FRACTIONAL_ODD"),
    }
    for (on, name) in [
        (K::MODE == Mode::D3d, "STAGE_D3D"),
        (K::WINDING == Winding::Cw, "STAGE_CLOCKWISE"),
        (super::evaluated::<K>(), "STAGE_EVALUATED"),
        (K::MOVES && !super::evaluated::<K>(), "STAGE_MOVES"),
        (K::AMPLIFIED > 0, "STAGE_AMPLIFY"),
        (K::LAYOUT.split, "STAGE_SPLIT"),
    ] {
        if on {
            defs.push(name);
        }
    }
    defs.into_iter().map(ShaderDefVal::from).collect()
}

/// Of a pass of the tessellation.
pub(super) fn pass_defs(of_kind: &[ShaderDefVal], reads: bool) -> Vec<ShaderDefVal> {
    with(of_kind, [(reads, "STAGE_READ")])
}

/// Of draws into shadow maps.
pub(super) fn shadow_defs(of_kind: &[ShaderDefVal], traits: &KindTraits) -> Vec<ShaderDefVal> {
    let fetched = traits.amplified > 0;
    with(of_kind, [(true, "STAGE_SHADOW"), (fetched, "STAGE_FETCH")])
}

/// What the shader of a view's draw depends on.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Look {
    /// Whether edges are drawn.
    pub lines: bool,
    /// What it draws into.
    pub target: Target,
}

/// What a view draws into.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Target {
    /// Bevy's G-buffer.
    GBuffer {
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
        let gbuffers = BOTH.into_iter().flat_map(|normals| {
            BOTH.map(|motion| Target::GBuffer { normals, motion })
        });
        let targets = gbuffers.chain(BOTH.map(|encoded| Target::Picture { encoded }));
        targets.flat_map(|target| BOTH.map(|lines| Self { lines, target }))
    }

    /// Of the draw of a kind in a view that looks so.
    pub fn defs(self, of_kind: &[ShaderDefVal], traits: &KindTraits) -> Vec<ShaderDefVal> {
        let fetched = fetches(traits, self.lines);
        let (direct, encoded, normals, motion) = match self.target {
            Target::GBuffer { normals, motion } => (false, false, normals, motion),
            Target::Picture { encoded } => (true, encoded, false, false),
        };
        with(
            of_kind,
            [
                (direct, "DIRECT"),
                (!direct, "GBUFFER"),
                // Segments are lines already.
                (self.lines && fetched, "STAGE_LINES"),
                (fetched, "STAGE_FETCH"),
                (direct && traits.vertex_shaded, "STAGE_VERTEX_SHADED"),
                (encoded, "STAGE_ENCODED"),
                (normals, "NORMAL_PREPASS"),
                (motion, "MOTION_VECTORS"),
            ],
        )
    }
}

fn with<const N: usize>(of_kind: &[ShaderDefVal], more: [(bool, &str); N]) -> Vec<ShaderDefVal> {
    let set = more.into_iter().filter(|(on, _)| *on);
    let set = set.map(|(_, name)| ShaderDefVal::from(name));
    of_kind.iter().cloned().chain(set).collect()
}
