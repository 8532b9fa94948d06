//! The stage's passes: their files in order, and what they are compiled for. Bevy's systems and tests
//! both go by this list.

use super::{Domain, Mode, Spacing, Tessellator, Winding};

/// One pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StagePass {
    /// Its file, below `shaders/src`.
    pub file: &'static str,
    /// Its entry point.
    pub entry: &'static str,
    /// Whether it binds the pools, and reads the work buffer alone.
    pub emits: bool,
}

const fn pass(file: &'static str, entry: &'static str, emits: bool) -> StagePass {
    StagePass { file, entry, emits }
}

/// All passes in their order; [`STRIPS`] is left out of isolines, which have no sides.
pub const PASSES: [StagePass; 7] = [
    pass("stage/control.wgsl", "control_patches", false),
    pass("stage/measure.wgsl", "measure", false),
    pass("stage/plan.wgsl", "plan", false),
    pass("stage/place_items.wgsl", "place_items", false),
    pass("stage/emit_vertices.wgsl", "emit_vertices", true),
    pass("stage/emit_grid.wgsl", "emit_grid", true),
    pass("stage/emit_strips.wgsl", "emit_strips", true),
];

/// Place of the pass that joins sides in [`PASSES`].
pub const STRIPS: usize = 6;

/// The pass that finds what shadow views see of a kind with a bounds function.
pub const SHADOW_RANGES: StagePass = pass("stage/shadow_ranges.wgsl", "shadow_ranges", true);

impl StagePass {
    /// The definition that it needs beside the kind's.
    #[must_use]
    pub const fn def(&self) -> Option<&'static str> {
        if self.emits { Some("STAGE_READ") } else { None }
    }
}

/// Passes that patches of a domain go through.
#[must_use]
pub const fn pass_count(domain: Domain) -> usize {
    match domain {
        Domain::Isolines => STRIPS,
        _ => PASSES.len(),
    }
}

/// What the passes of a kind are compiled for, beside its rules.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PassRules {
    /// Whether the draws evaluate vertices.
    pub evaluated: bool,
    /// Whether where vertices were is stored.
    pub moves: bool,
    /// Whether sides may be split.
    pub split: bool,
}

/// Shader definitions of a kind's rules, as `rules.wgsl` reads them.
#[must_use]
pub fn defs(tessellator: &Tessellator, rules: PassRules) -> Vec<&'static str> {
    let mut defs = match tessellator.domain {
        Domain::Triangles => vec![],
        Domain::Quads => vec!["STAGE_QUADS", "STAGE_FOUR_POINTS"],
        Domain::Isolines => vec!["STAGE_ISOLINES", "STAGE_FOUR_POINTS"],
    };
    match tessellator.spacing {
        Spacing::Equal => {}
        Spacing::FractionalEven => defs.push("STAGE_FRACTIONAL_EVEN"),
        Spacing::FractionalOdd => defs.push("STAGE_FRACTIONAL_ODD"),
    }
    for (on, name) in [
        (tessellator.mode == Mode::D3d, "STAGE_D3D"),
        (tessellator.winding == Winding::Cw, "STAGE_CLOCKWISE"),
        (rules.evaluated, "STAGE_EVALUATED"),
        (rules.moves, "STAGE_MOVES"),
        (rules.split, "STAGE_SPLIT"),
    ] {
        if on {
            defs.push(name);
        }
    }
    defs
}

/// The text that gives draws the function `evaluated_vertex`, of kinds whose draws evaluate: that of
/// `stage/evaluated.wgsl`, with `functions` (an import path and `::`) in place of the stage's own stand-in.
#[must_use]
pub fn evaluated_source(functions: Option<&str>) -> String {
    let source = dolomite_shaders::find("stage/evaluated.wgsl").source;
    let (_, body) = source.split_once('\n').unwrap_or(("", source));
    match functions {
        Some(functions) => body.replace("dolomite::stage::user::", functions),
        None => body.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_draws_function_takes_the_kinds() {
        let own = evaluated_source(Some("\"a\"::"));
        assert!(own.contains("#import \"a\"::evaluate\n") && !own.contains("stage::user"));
        assert!(evaluated_source(None).contains("#import dolomite::stage::user::evaluate"));
        assert!(
            !own.contains("define_import_path"),
            "not a module of its own"
        );
    }

    #[test]
    fn isolines_have_no_strips() {
        assert_eq!(PASSES[STRIPS].entry, "emit_strips");
        assert_eq!(pass_count(Domain::Isolines), STRIPS);
        assert_eq!(pass_count(Domain::Quads), PASSES.len());
    }
}
