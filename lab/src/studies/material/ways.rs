//! The ways of shading that are compared.

use dolomite_ground::GroundShading;

/// A way of shading.
#[derive(Debug, Clone, Copy)]
pub struct Way {
    /// As it is named in tables.
    pub name: &'static str,
    /// Definitions of its shader.
    pub defs: &'static [&'static str],
    /// By how much blends are narrowed at either end, 0 to 0.45.
    pub narrowing: f32,
}

const FULL: GroundShading = GroundShading::Full;
const FINE: GroundShading = GroundShading::Fine;
const BALANCED: GroundShading = GroundShading::Balanced;

const fn preset(name: &'static str, of: GroundShading) -> Way {
    Way {
        name,
        defs: match of {
            GroundShading::Full => &["GROUND_FULL", "GROUND_FEW_LAYERS"],
            _ => &[],
        },
        narrowing: of.narrowing(),
    }
}

const fn narrowed(name: &'static str, narrowing: f32) -> Way {
    Way {
        name,
        defs: &[],
        narrowing,
    }
}

/// All of them: the full material, then along the curve, the presets among others.
pub const WAYS: [Way; 6] = [
    preset("Full", FULL),
    preset("Fine", FINE),
    preset("Balanced", BALANCED),
    narrowed("narrowed by 0.2", 0.2),
    narrowed("narrowed by 0.3", 0.3),
    narrowed("narrowed by 0.45", 0.45),
];

/// Those of [`WAYS`] that are presets.
pub const PRESETS: [usize; 3] = [0, 1, 2];
