//! Every WGSL file of Dolomite, and how they become one module.
//!
//! Files are plain WGSL but for `#define_import_path` and `#import` lines. A file with an import
//! path is a module that others import; one without holds entry points. [`ALL`] lists both, in
//! folders named after the plugins.

#[cfg(feature = "compose")]
mod compose;
#[cfg(feature = "compose")]
pub use compose::{ComposeError, compose, compose_with};

/// One WGSL file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShaderFile {
    /// Path below `shaders/src`, with `/`: `terrain/height.wgsl`.
    pub path: &'static str,
    /// Its text.
    pub source: &'static str,
}

impl ShaderFile {
    /// The path that other files import it by, if it is a module: `dolomite::terrain::height`.
    #[must_use]
    pub fn import_path(&self) -> Option<&'static str> {
        let line = self.source.lines().next()?;
        line.strip_prefix("#define_import_path ").map(str::trim)
    }

    /// Whether other files can import it.
    #[must_use]
    pub fn is_module(&self) -> bool {
        self.import_path().is_some()
    }
}

macro_rules! files {
    ($($path:literal),* $(,)?) => {
        &[$(ShaderFile { path: $path, source: include_str!($path) }),*]
    };
}

/// Every file.
pub const ALL: &[ShaderFile] = files![
    "blocks/answer.wgsl",
    "blocks/beside.wgsl",
    "blocks/bindings.wgsl",
    "blocks/border.wgsl",
    "blocks/cells.wgsl",
    "blocks/counting.wgsl",
    "blocks/cull.wgsl",
    "blocks/draw_horizon.wgsl",
    "blocks/drop.wgsl",
    "blocks/edited.wgsl",
    "blocks/emit.wgsl",
    "blocks/errors.wgsl",
    "blocks/finish.wgsl",
    "blocks/fit.wgsl",
    "blocks/gate.wgsl",
    "blocks/leaves.wgsl",
    "blocks/locate.wgsl",
    "blocks/look.wgsl",
    "blocks/looked.wgsl",
    "blocks/lowest.wgsl",
    "blocks/make.wgsl",
    "blocks/nest.wgsl",
    "blocks/others.wgsl",
    "blocks/raised.wgsl",
    "blocks/ratio.wgsl",
    "blocks/record.wgsl",
    "blocks/refresh.wgsl",
    "blocks/sample.wgsl",
    "blocks/samples.wgsl",
    "blocks/scan.wgsl",
    "blocks/slope.wgsl",
    "blocks/spread.wgsl",
    "blocks/stand.wgsl",
    "blocks/stock.wgsl",
    "blocks/sweep.wgsl",
    "blocks/uneven.wgsl",
    "blocks/way.wgsl",
    "character/bindings.wgsl",
    "character/draw.wgsl",
    "character/figure.wgsl",
    "character/probe.wgsl",
    "character/skin.wgsl",
    "character/types.wgsl",
    "city/facade.wgsl",
    "city/far.wgsl",
    "city/globe.wgsl",
    "city/levels.wgsl",
    "city/look.wgsl",
    "city/map.wgsl",
    "city/patches.wgsl",
    "city/post.wgsl",
    "city/relief.wgsl",
    "city/shade.wgsl",
    "city/street.wgsl",
    "city/types.wgsl",
    "city/windows.wgsl",
    "classic/bounded.wgsl",
    "classic/functions.wgsl",
    "classic/look.wgsl",
    "deferred/bindings.wgsl",
    "deferred/blinn_phong.wgsl",
    "deferred/difference.wgsl",
    "deferred/dither.wgsl",
    "deferred/gbuffer.wgsl",
    "deferred/light.wgsl",
    "deferred/local.wgsl",
    "deferred/occlusion.wgsl",
    "deferred/occlusion_filter.wgsl",
    "deferred/occlusion_trace.wgsl",
    "deferred/place.wgsl",
    "deferred/pyramid.wgsl",
    "deferred/pyramid_build.wgsl",
    "deferred/pyramid_lights.wgsl",
    "deferred/reach.wgsl",
    "deferred/standard.wgsl",
    "deferred/surface.wgsl",
    "deferred/tiles.wgsl",
    "deferred/types.wgsl",
    "deferred/volume.wgsl",
    "deferred/write_blinn_phong.wgsl",
    "detail/bindings.wgsl",
    "detail/close_horizon.wgsl",
    "detail/cull.wgsl",
    "detail/horizon.wgsl",
    "detail/lattice.wgsl",
    "detail/square.wgsl",
    "detail/types.wgsl",
    "detail/unseen.wgsl",
    "geometry/amplify_types.wgsl",
    "geometry/draw.wgsl",
    "geometry/draw_types.wgsl",
    "geometry/head.wgsl",
    "geometry/once.wgsl",
    "geometry/user_amplify.wgsl",
    "geometry/user_material.wgsl",
    "geometry/user_vertex.wgsl",
    "geometry/vertex.wgsl",
    "ground/bindings.wgsl",
    "ground/canopy.wgsl",
    "ground/full.wgsl",
    "ground/functions.wgsl",
    "ground/inspect.wgsl",
    "ground/layers.wgsl",
    "ground/material.wgsl",
    "ground/site.wgsl",
    "ground/surface.wgsl",
    "ground/taps.wgsl",
    "ground/texturing.wgsl",
    "ground/types.wgsl",
    "ground/water.wgsl",
    "inspector/colours.wgsl",
    "inspector/legend.wgsl",
    "inspector/picture.wgsl",
    "sky/moon.wgsl",
    "sky/star.wgsl",
    "stage/api.wgsl",
    "stage/control.wgsl",
    "stage/coordinate.wgsl",
    "stage/counts.wgsl",
    "stage/divide.wgsl",
    "stage/emit_grid.wgsl",
    "stage/emit_strips.wgsl",
    "stage/emit_vertices.wgsl",
    "stage/evaluated.wgsl",
    "stage/level.wgsl",
    "stage/measure.wgsl",
    "stage/place.wgsl",
    "stage/place_items.wgsl",
    "stage/plan.wgsl",
    "stage/probe.wgsl",
    "stage/ruler.wgsl",
    "stage/rules.wgsl",
    "stage/shadow_ranges.wgsl",
    "stage/shape.wgsl",
    "stage/source.wgsl",
    "stage/strip.wgsl",
    "stage/triangle.wgsl",
    "stage/types.wgsl",
    "stage/user.wgsl",
    "stage/user_bounds.wgsl",
    "stage/work.wgsl",
    "terrain/bindings.wgsl",
    "terrain/edits.wgsl",
    "terrain/permutation.wgsl",
    "terrain/clip.wgsl",
    "terrain/cubic.wgsl",
    "terrain/fixed.wgsl",
    "terrain/four.wgsl",
    "terrain/fractal.wgsl",
    "terrain/hash.wgsl",
    "terrain/height.wgsl",
    "terrain/height_map.wgsl",
    "terrain/layer.wgsl",
    "terrain/noise.wgsl",
    "terrain/probe.wgsl",
    "vegetation/bindings.wgsl",
    "vegetation/blade.wgsl",
    "vegetation/blossom.wgsl",
    "vegetation/chain.wgsl",
    "vegetation/colour.wgsl",
    "vegetation/density.wgsl",
    "vegetation/divide.wgsl",
    "vegetation/draw.wgsl",
    "vegetation/draw_chain.wgsl",
    "vegetation/draw_flower.wgsl",
    "vegetation/draw_types.wgsl",
    "vegetation/draw_view.wgsl",
    "vegetation/edges.wgsl",
    "vegetation/grow.wgsl",
    "vegetation/law.wgsl",
    "vegetation/noise.wgsl",
    "vegetation/place.wgsl",
    "vegetation/press.wgsl",
    "vegetation/rank.wgsl",
    "vegetation/seen.wgsl",
    "vegetation/shape.wgsl",
    "vegetation/stem.wgsl",
    "vegetation/steps.wgsl",
    "vegetation/straight.wgsl",
    "vegetation/surface.wgsl",
    "vegetation/triangle.wgsl",
    "vegetation/types.wgsl",
    "vegetation/wind.wgsl",
];

/// The file at `path`, which must be one of [`ALL`].
///
/// # Panics
/// If there is no such file: the path is part of the program, not input.
#[must_use]
pub fn find(path: &str) -> ShaderFile {
    match ALL.iter().find(|file| file.path == path) {
        Some(file) => *file,
        None => panic!("no shader file {path}; the files are listed in dolomite_shaders::ALL"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn import_paths_follow_the_folders() {
        for file in ALL {
            if let Some(path) = file.import_path() {
                let expected = file.path.trim_end_matches(".wgsl").replace('/', "::");
                assert_eq!(path, format!("dolomite::{expected}"), "{}", file.path);
            } else {
                assert!(
                    !file.source.contains("#define_import_path"),
                    "{}",
                    file.path
                );
            }
        }
    }

    #[test]
    fn the_list_is_complete() {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
        let mut found = Vec::new();
        for folder in std::fs::read_dir(&root).expect("src").flatten() {
            if folder.path().is_dir() {
                for file in std::fs::read_dir(folder.path()).expect("folder").flatten() {
                    let name = file.file_name().into_string().expect("UTF-8");
                    found.push(format!("{}/{name}", folder.file_name().to_string_lossy()));
                }
            }
        }
        found.sort();
        let mut listed: Vec<_> = ALL.iter().map(|file| file.path.to_owned()).collect();
        listed.sort();
        assert_eq!(listed, found);
    }

    #[test]
    #[should_panic(expected = "no shader file terrain/none.wgsl")]
    fn an_unknown_file_is_named() {
        let _ = find("terrain/none.wgsl");
    }
}
