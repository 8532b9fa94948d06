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
            "selection-set",
            scene.selection_sets.len(),
            "sets of objects are not in glTF",
        ),
        (
            "display-layer",
            (&scene.display_layers)
                .into_iter()
                .filter(|layer| !layer.nodes.is_empty())
                .count(),
            "layers that nodes are shown by are not in glTF; what a layer hides is hidden",
        ),
        (
            "marker",
            scene.markers.len(),
            "marks of hands, feet and other places are nodes without anything now",
        ),
        (
            "character",
            scene.characters.len(),
            "which node is which part of a body is not in glTF",
        ),
        (
            "metadata",
            scene.metadata_objects.len(),
            "objects of metadata are not in glTF",
        ),
        (
            "unknown-object",
            scene.unknowns.len(),
            "objects of kinds that are not known",
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
    for node in &scene.nodes {
        let mut aims = node.element.connections_dst.iter();
        if aims.any(|aim| ["LookAtProperty", "UpVectorProperty"].contains(&&*aim.dst_prop)) {
            let detail = "turns towards another node in the file; its rotation there is taken";
            report.lose("look-at", &node.element.name, detail);
        }
        let others = node.all_attribs.len().saturating_sub(1);
        if others > 0 {
            let detail = format!(
                "{others} more than one object hang at it; the first of each kind is taken"
            );
            report.lose("attributes", &node.element.name, detail);
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
        let holes = mesh.face_hole.iter().filter(|&&hole| hole).count();
        if holes > 0 {
            let detail = format!("{holes} faces are holes in the file; they are closed here");
            report.lose("face-hole", &name, detail);
        }
        let creased = mesh.vertex_crease.exists || mesh.edge_crease.iter().any(|c| *c != 0.0);
        if creased {
            report.lose(
                "crease",
                &name,
                "creases for smoothing when shown are not in glTF",
            );
        }
        if mesh.color_sets.len() > 1 {
            let detail = format!(
                "has {} colour sets; loaders show the first of them at most",
                mesh.color_sets.len()
            );
            report.lose("colour-sets", &name, detail);
        }
        let mut colours = (&mesh.color_sets)
            .into_iter()
            .flat_map(|set| set.vertex_color.values.iter());
        let ends = 0.0..=1.0 + 1e-6;
        if colours.any(|c| [c.x, c.y, c.z, c.w].iter().any(|x| !ends.contains(x))) {
            let detail = "has colours outside of 0 to 1, where glTF's end; they are cut there";
            report.lose("colour-range", &name, detail);
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
}
