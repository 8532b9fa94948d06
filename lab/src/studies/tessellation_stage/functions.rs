//! The functions that the study runs the stage with, in the places of a user's.

use dolomite_shaders::ShaderFile;

macro_rules! user {
    ($($part:literal),*) => {
        ShaderFile {
            path: "stage/user.wgsl",
            source: concat!(
                "#define_import_path dolomite::stage::user\n",
                $(include_str!(concat!("functions/", $part, ".wgsl"))),*
            ),
        }
    };
}

/// `assets/shaders/rock.wgsl`, for the others to import: eight octaves of gradient noise.
const ROCK: ShaderFile = ShaderFile {
    path: "lab/rock.wgsl",
    source: concat!(
        "#define_import_path dolomite::lab::rock\n",
        include_str!("../../../../assets/shaders/rock.wgsl")
    ),
};

const fn file(path: &'static str, source: &'static str) -> ShaderFile {
    ShaderFile { path, source }
}

/// What the stage's G-buffer draw imports of Bevy: the same arithmetic, without Bevy's renderer.
const GBUFFER: [ShaderFile; 3] = [
    file(
        "lab/utils.wgsl",
        include_str!("functions/gbuffer_normal.wgsl"),
    ),
    file(
        "lab/rgb9e5.wgsl",
        include_str!("functions/gbuffer_colour.wgsl"),
    ),
    file(
        "lab/pbr_deferred_types.wgsl",
        include_str!("functions/gbuffer_words.wgsl"),
    ),
];

/// Levels of each patch by itself; flat patches whose vertices say where they are from.
pub const TAGGED: &[ShaderFile] = &[user!("levels", "plane", "tagged")];

/// Levels of each patch by itself; a sphere displaced by noise.
pub const ROCKY: &[ShaderFile] = &[ROCK, user!("levels", "plane", "rocky")];

/// One level for an entity, flat patches: the cheapest evaluation, with what a G-buffer needs.
pub const CHEAPEST: &[ShaderFile] = &[GBUFFER[0], GBUFFER[1], GBUFFER[2]];

/// One level for an entity, a sphere displaced by noise and its material.
pub const COSTLY: &[ShaderFile] = &[
    GBUFFER[0],
    GBUFFER[1],
    GBUFFER[2],
    ROCK,
    user!("one_level", "rock"),
    file(
        "geometry/user_material.wgsl",
        include_str!("functions/rock_material.wgsl"),
    ),
];

#[cfg(test)]
mod tests {
    use super::*;
    use dolomite_shaders::compose_with;

    #[test]
    fn every_set_composes() {
        for (set, defs) in [
            (TAGGED, vec![]),
            (TAGGED, vec!["STAGE_QUADS", "STAGE_FOUR_POINTS"]),
            (ROCKY, vec![]),
            (ROCKY, vec!["STAGE_QUADS", "STAGE_FOUR_POINTS"]),
            (CHEAPEST, vec!["GBUFFER"]),
            (COSTLY, vec!["GBUFFER"]),
            (
                COSTLY,
                vec!["GBUFFER", "STAGE_EVALUATED", "GEOMETRY_EVALUATED"],
            ),
        ] {
            for file in [
                "stage/control.wgsl",
                "stage/emit_vertices.wgsl",
                "geometry/draw.wgsl",
            ] {
                if let Err(error) = compose_with(file, &defs, set) {
                    panic!("{defs:?}: {error}");
                }
            }
        }
    }
}
