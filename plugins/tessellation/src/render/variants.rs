//! Which shaders, with which definitions, the pipelines of a kind are made of. The pipelines take them from
//! here, and whoever checks shaders can list them without a GPU.

use bevy::prelude::*;
use bevy::shader::ShaderDefVal;
pub use dolomite_geometry::render::ShaderVariant as StageVariant;
use dolomite_geometry::render::{DrawShader, DrawTraits, draw_variants};

use super::kind::{PatchKind, PatchShader};
use crate::passes::{
    PASSES, PassRules, SHADOW_RANGES, StagePass, defs, evaluated_source, pass_count,
};
use crate::{Domain, Drawing, Tessellator};

/// The kinds of an app, for whoever checks their shaders: name, and [`stage_variants`].
#[derive(Resource, Clone, Debug, Default)]
pub struct KindVariants(pub Vec<(&'static str, fn() -> Vec<StageVariant>)>);

/// Every shader that a pipeline of the kind `K` may ask for, whatever views and lights there are.
#[must_use]
pub fn stage_variants<K: PatchKind>() -> Vec<StageVariant> {
    let traits = draw_traits::<K>();
    let own = kind_defs::<K>();
    let ranges = traits.bounded.then_some(&SHADOW_RANGES);
    let passes = PASSES[..pass_count(K::LAYOUT.domain)].iter().chain(ranges);
    let mut all: Vec<StageVariant> = passes
        .map(|pass| StageVariant {
            file: pass.file,
            source: pass_source::<K>(pass),
            defs: pass_defs(&own, pass),
        })
        .collect();
    all.extend(draw_variants(&draw_source::<K>(), &own, &traits));
    all
}

/// How the triangles and segments of a kind are drawn.
pub(super) fn draw_traits<K: PatchKind>() -> DrawTraits {
    use bevy::mesh::PrimitiveTopology::{LineList, TriangleList};
    DrawTraits {
        topology: match K::LAYOUT.domain {
            Domain::Isolines => LineList,
            _ => TriangleList,
        },
        evaluated: evaluated::<K>(),
        moves: K::MOVES && !evaluated::<K>(),
        vertex_shaded: K::VERTEX_SHADED,
        amplified: K::AMPLIFIED,
        double_sided: K::DOUBLE_SIDED,
        shadows: K::SHADOWS,
        others: false,
        bounded: K::BOUNDED && K::SHADOWS && K::AMPLIFIED == 0,
        shaded_once: false,
        uv_range: K::UV_RANGE,
    }
}

/// Whether the draws evaluate the kind's vertices.
pub(super) const fn evaluated<K: PatchKind>() -> bool {
    matches!(K::DRAWING, Drawing::Evaluated) && K::AMPLIFIED == 0
}

/// How other files import the kind's functions.
fn functions<K: PatchKind>() -> String {
    match K::shader() {
        PatchShader::File(path) => format!("\"{path}\"::"),
        PatchShader::Library(path) => format!("{path}::"),
    }
}

/// The text of a pass, the kind's functions named in it.
pub(super) fn pass_source<K: PatchKind>(pass: &StagePass) -> String {
    let functions = functions::<K>();
    let source = dolomite_shaders::find(pass.file)
        .source
        .replace("dolomite::stage::user::", &functions);
    if K::BOUNDED {
        source.replace("dolomite::stage::user_bounds::", &functions)
    } else {
        source
    }
}

/// The text of the draw, the kind's functions named in it.
pub(super) fn draw_source<K: PatchKind>() -> String {
    let functions = functions::<K>();
    let vertex = evaluated::<K>().then(|| evaluated_source(Some(&functions)));
    DrawShader::source(
        K::CUSTOM_MATERIAL.then_some(functions.as_str()),
        (K::AMPLIFIED > 0).then_some(functions.as_str()),
        vertex.as_deref(),
    )
}

/// The kind's rules.
pub(super) fn tessellator<K: PatchKind>() -> Tessellator {
    Tessellator {
        domain: K::LAYOUT.domain,
        spacing: K::SPACING,
        winding: K::WINDING,
        mode: K::MODE,
    }
}

/// Definitions of the kind's rules.
pub(super) fn kind_defs<K: PatchKind>() -> Vec<ShaderDefVal> {
    let rules = PassRules {
        evaluated: evaluated::<K>(),
        moves: K::MOVES && !evaluated::<K>(),
        split: K::LAYOUT.split,
    };
    let defs = defs(&tessellator::<K>(), rules);
    defs.into_iter().map(ShaderDefVal::from).collect()
}

/// Definitions of a pass.
pub(super) fn pass_defs(own: &[ShaderDefVal], pass: &StagePass) -> Vec<ShaderDefVal> {
    let more = pass.def().map(ShaderDefVal::from);
    own.iter().cloned().chain(more).collect()
}
