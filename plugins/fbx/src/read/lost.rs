//! What is in the file and not in the result, that no other part reports.

use crate::report::Report;
use ufbx::Scene;

/// Kinds of things that glTF has no place for, by count.
pub(crate) fn report_lost(scene: &Scene, report: &mut Report) {
    let kinds = [
        (
            "constraint",
            scene.constraints.len(),
            "constraints act in the program that wrote the file; what they did is in the curves if it was baked",
        ),
        (
            "cache",
            scene.cache_deformers.len(),
            "vertex caches are not in glTF",
        ),
        (
            "nurbs",
            scene.nurbs_curves.len() + scene.nurbs_surfaces.len() + scene.nurbs_trim_surfaces.len(),
            "smooth curves and surfaces are not in glTF",
        ),
        ("line", scene.line_curves.len(), "lines are not converted"),
        (
            "procedural-geometry",
            scene.procedural_geometries.len(),
            "geometry that another program makes is not in the file",
        ),
        (
            "stereo-camera",
            scene.stereo_cameras.len(),
            "pairs of cameras are not in glTF",
        ),
        (
            "camera-switcher",
            scene.camera_switchers.len(),
            "cuts between cameras are not in glTF",
        ),
        (
            "lod-group",
            scene.lod_groups.len(),
            "which level of detail shows at what distance is not in glTF; all are there",
        ),
        ("audio", scene.audio_clips.len(), "sound is not in glTF"),
    ];
    for (what, count, detail) in kinds {
        if count > 0 {
            report.lose(what, &count.to_string(), detail);
        }
    }
    for mesh in &scene.meshes {
        let name = mesh.element.name.to_string();
        if mesh.skin_deformers.len() > 1 {
            report.lose(
                "second-skin",
                &name,
                "has several skins; the first is taken",
            );
        }
        if mesh.num_point_faces + mesh.num_line_faces + mesh.num_empty_faces > 0 {
            report.lose("thin-faces", &name, "has faces of fewer than three corners");
        }
        if mesh.subdivision_preview_levels > 0 && mesh.subdivision_display_mode as u32 > 1 {
            report.lose(
                "subdivision",
                &name,
                "is to be smoothed when shown; its cage is taken",
            );
        }
    }
    for node in &scene.nodes {
        if !node.visible && node.mesh.is_some() {
            let detail = "is hidden in the file and shows in the result: glTF has no visibility";
            report.lose("hidden", &node.element.name, detail);
        }
    }
}
