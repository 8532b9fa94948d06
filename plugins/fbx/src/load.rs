//! Reading a file through ufbx, within limits and in glTF's axes and unit.

use crate::error::FbxError;
use crate::options::{Budget, Options};
use ufbx::{
    AllocatorOpts, ErrorType, GeometryTransformHandling, InheritModeHandling, LoadOpts, MirrorAxis,
    PivotHandling, ProgressCb, ProgressResult, SceneRoot, SpaceConversion,
};

/// Name of the nodes that carry a geometric transform, which children do not inherit.
pub(crate) const GEOMETRY_HELPER: &str = "geometry";
/// Name of the nodes that carry a scale which children do not inherit, or inherit by component.
pub(crate) const SCALE_HELPER: &str = "scale";

/// Nodes below nodes; deeper files are refused, so that nothing that recurses can overflow.
const DEPTH: u32 = 512;

/// What a conversion asks ufbx for: Y up, metres, lengths changed in the geometry and not by a scale
/// on the root, helper nodes for what glTF's transforms cannot say.
fn conversion_options<'a>() -> LoadOpts<'a> {
    LoadOpts {
        target_axes: ufbx::axes_right_handed_y_up(),
        target_unit_meters: 1.0,
        // glTF's cameras and lights look along their -Z.
        target_camera_axes: ufbx::axes_right_handed_y_up(),
        target_light_axes: ufbx::axes_right_handed_y_up(),
        handedness_conversion_axis: MirrorAxis::X,
        space_conversion: SpaceConversion::ModifyGeometry,
        geometry_transform_handling: GeometryTransformHandling::HelperNodes,
        geometry_transform_helper_name: GEOMETRY_HELPER.into(),
        inherit_mode_handling: InheritModeHandling::HelperNodes,
        scale_helper_name: SCALE_HELPER.into(),
        pivot_handling: PivotHandling::Retain,
        use_blender_pbr_material: true,
        clean_skin_weights: true,
        generate_missing_normals: true,
        normalize_normals: true,
        ..LoadOpts::default()
    }
}

/// Reads `bytes` in glTF's axes and unit.
pub(crate) fn load(
    bytes: &[u8],
    budget: &Budget,
    options: &Options,
) -> Result<SceneRoot, FbxError> {
    load_with(bytes, budget, options, Space::Gltf)
}

/// Reads `bytes` as they are: the file's own axes and unit. For checks.
pub(crate) fn load_unchanged(
    bytes: &[u8],
    budget: &Budget,
    options: &Options,
) -> Result<SceneRoot, FbxError> {
    load_with(bytes, budget, options, Space::File)
}

/// Reads `bytes` by ufbx's own defaults. For timing.
pub(crate) fn load_plainly(
    bytes: &[u8],
    budget: &Budget,
    options: &Options,
) -> Result<SceneRoot, FbxError> {
    load_with(bytes, budget, options, Space::Plain)
}

/// Reads the objects of `bytes` with the values that name them in the file, without their contents.
pub(crate) fn load_names(
    bytes: &[u8],
    budget: &Budget,
    options: &Options,
) -> Result<SceneRoot, FbxError> {
    load_with(bytes, budget, options, Space::Names)
}

/// In whose axes and unit.
#[derive(Clone, Copy)]
enum Space {
    Gltf,
    File,
    Plain,
    /// As [`Space::Gltf`], without geometry and curves.
    Names,
}

fn load_with(
    bytes: &[u8],
    budget: &Budget,
    options: &Options,
    space: Space,
) -> Result<SceneRoot, FbxError> {
    // The scene is kept; what ufbx needs meanwhile is about as much again.
    let half = || AllocatorOpts {
        memory_limit: budget.limits.memory / 2,
        ..AllocatorOpts::default()
    };
    let mut watch = |progress: &ufbx::Progress| {
        options.report(
            "reading",
            progress.bytes_read as f64 / progress.bytes_total.max(1) as f64,
        );
        // How long reading takes, memory bounds.
        ProgressResult::Continue
    };
    let opts = LoadOpts {
        file_format: ufbx::FileFormat::Fbx,
        temp_allocator: half(),
        result_allocator: half(),
        progress_cb: ProgressCb::Mut(&mut watch),
        node_depth_limit: DEPTH,
        load_external_files: false,
        ..match space {
            Space::Gltf => conversion_options(),
            Space::Plain => LoadOpts::default(),
            Space::Names => LoadOpts {
                retain_dom: true,
                ignore_geometry: true,
                ignore_animation: true,
                ignore_embedded: true,
                ..conversion_options()
            },
            Space::File => LoadOpts {
                evaluate_skinning: true,
                ..LoadOpts::default()
            },
        }
    };
    ufbx::load_memory(bytes, opts).map_err(|error| refusal(&error, budget))
}

fn refusal(error: &ufbx::Error, budget: &Budget) -> FbxError {
    let file = budget.file.clone();
    let detail = match error.info() {
        "" => error.description.to_string(),
        info => format!("{} ({info})", error.description),
    };
    match error.type_ {
        ErrorType::EmptyFile | ErrorType::UnrecognizedFileFormat => FbxError::NotFbx { file },
        ErrorType::UnsupportedVersion => FbxError::Version { file, detail },
        ErrorType::MemoryLimit | ErrorType::AllocationLimit | ErrorType::OutOfMemory => {
            budget.too_much("the contents")
        }
        _ => FbxError::Broken { file, detail },
    }
}
