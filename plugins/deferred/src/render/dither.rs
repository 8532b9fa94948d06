//! Bytes of the G-buffer that are dithered: base colour, roughness, reflectance, metallic, occlusion.
//!
//! Bevy rounds each to the nearest of 256 steps. Where a surface has one colour, all its pixels are off by the same then,
//! which is what an eye, and FLIP, sees of packing. With an ordered pattern of half a step added before it, the mean over 8 × 8 pixels
//! is right, at the same 16 bytes a pixel, and whoever reads them need not know.

use bevy::prelude::*;
use bevy::shader::{Shader, ShaderImport, Source};

/// Dithers what `StandardMaterial` and `BlinnPhongMaterial` write into the G-buffer, for all cameras. Add beside
/// [`DeferredPlugin`](super::DeferredPlugin), which brings the pattern.
///
/// Bevy's shader has no place for it: its text is changed once it is loaded. Where that text is another one than that of
/// Bevy 0.19.1, nothing is changed, and a warning says so.
#[derive(Clone, Copy, Debug, Default)]
pub struct DitheredGBufferPlugin;

/// Says that the pattern is wanted.
#[derive(Resource)]
pub struct Dithered;

/// Bevy's module that packs a pixel.
const MODULE: &str = "bevy_pbr::pbr_deferred_functions";

/// What stands there once, and what is put in its place.
const CHANGES: [(&str, &str); 3] = [
    (
        "#import bevy_pbr::{\n    pbr_types::{",
        "#import dolomite::deferred::dither::dither\n#import bevy_pbr::{\n    pbr_types::{",
    ),
    (
        "vec4(base_color_srgb, in.material.perceptual_roughness)",
        "vec4(base_color_srgb, in.material.perceptual_roughness) + dither(in.frag_coord.xy, 0u)",
    ),
    (
        "        clearcoat_props));",
        "        clearcoat_props) + vec4(dither(in.frag_coord.xy, 1u).xyz, 0.0));",
    ),
];

impl Plugin for DitheredGBufferPlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(Dithered)
            .add_systems(PreUpdate, change.run_if(not_done));
    }
}

/// Says that Bevy's module was looked at.
#[derive(Resource)]
struct Done;

fn not_done(done: Option<Res<Done>>) -> bool {
    done.is_none()
}

fn change(mut commands: Commands, shaders: Option<ResMut<Assets<Shader>>>) {
    let Some(mut shaders) = shaders else { return };
    let wanted = ShaderImport::Custom(MODULE.into());
    let found = shaders
        .iter()
        .find(|(_, shader)| shader.import_path == wanted)
        .map(|(id, shader)| (id, shader.clone()));
    let Some((id, shader)) = found else { return };
    commands.insert_resource(Done);
    let Source::Wgsl(text) = &shader.source else {
        return;
    };
    let Some(text) = changed(text) else {
        warn!("DitheredGBufferPlugin does nothing: {MODULE} is not that of Bevy 0.19.1");
        return;
    };
    let mut dithered = Shader::from_wgsl(text, shader.path.clone());
    dithered.shader_defs = shader.shader_defs;
    dithered.file_dependencies = shader.file_dependencies;
    dithered.validate_shader = shader.validate_shader;
    // The handles that Bevy holds stay good.
    let _ = shaders.insert(id, dithered);
}

/// The text with the pattern; `None` unless each place is there once.
fn changed(text: &str) -> Option<String> {
    let mut text = text.to_owned();
    for (from, to) in CHANGES {
        if text.matches(from).count() != 1 {
            return None;
        }
        text = text.replace(from, to);
    }
    Some(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_text_is_left_alone() {
        let all: String = CHANGES
            .iter()
            .map(|(from, _)| format!("{from}\n"))
            .collect();
        let text = changed(&all).expect("each is there once");
        assert_eq!(text.matches("dither(in.frag_coord.xy").count(), 2);
        assert_eq!(changed(&text.replace("clearcoat_props", "other")), None);
        assert_eq!(changed(&(all.clone() + &all)), None);
    }
}
