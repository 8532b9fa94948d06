//! FBX files as assets of Bevy.

use crate::conversion::Conversion;
use crate::convert::convert;
use crate::error::FbxError;
use crate::options::{Options, Origin, Weights};
use crate::read::pictures::saved_again;
use crate::report::Report;
use bevy::asset::io::Reader;
use bevy::asset::{AssetApp, AssetLoader, AssetPath, LoadContext};
use bevy::gltf::extensions::GltfExtensionHandlers;
use bevy::gltf::{
    DefaultGltfImageSampler, Gltf, GltfError, GltfLoader, GltfLoaderSettings, GltfPlugin,
};
use bevy::image::{CompressedImageFormatSupport, CompressedImageFormats};
use bevy::log::{info, warn};
use bevy::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Lets `load("hero.fbx")` give what `load("hero.glb")` gives: a [`Gltf`] with the same sub-assets
/// under the same labels (`GltfAssetLabel::Scene(0).from_asset("hero.fbx")`, ...), and one more:
/// `hero.fbx#Conversion` is an [`FbxConversion`].
///
/// A file is converted in memory, on the tasks that load assets, and handed to Bevy's glTF loader as it
/// was set up by [`GltfPlugin`]. Without an .fbx nothing is done.
///
/// May be added before or after Bevy's plugins, and more than once. An app without [`GltfPlugin`] is told
/// so in a warning, and loads no .fbx.
#[derive(Clone, Copy, Debug, Default)]
pub struct FbxPlugin;

/// The loader has been announced: whoever asks for a file from now on waits for it.
#[derive(Resource)]
struct Announced;

/// The loader is there, or it has been said why it is not.
#[derive(Resource)]
struct Settled;

impl Plugin for FbxPlugin {
    fn build(&self, app: &mut App) {
        announce(app);
    }

    // Bevy's plugins may have been added after this one.
    fn finish(&self, app: &mut App) {
        announce(app);
    }

    // What Bevy's loader was set up with is known when all plugins have finished.
    fn cleanup(&self, app: &mut App) {
        if app.world().contains_resource::<Settled>() {
            return;
        }
        app.insert_resource(Settled);
        let set_up = app.get_added_plugins::<GltfPlugin>();
        let world = app.world();
        let sampler = world.get_resource::<DefaultGltfImageSampler>();
        let extensions = world.get_resource::<GltfExtensionHandlers>();
        let (Some(set_up), Some(sampler), Some(extensions), true) = (
            set_up.first(),
            sampler,
            extensions,
            world.contains_resource::<Announced>(),
        ) else {
            warn!(
                "FbxPlugin loads nothing: the app has no GltfPlugin (part of Bevy's DefaultPlugins)"
            );
            return;
        };
        let formats = world.get_resource::<CompressedImageFormatSupport>();
        let gltf = GltfLoader {
            supported_compressed_formats: formats
                .map_or(CompressedImageFormats::NONE, |known| known.0),
            custom_vertex_attributes: set_up.custom_vertex_attributes.clone(),
            default_sampler: sampler.get_internal(),
            default_convert_coordinates: set_up.convert_coordinates,
            extensions: extensions.0.clone(),
            default_skinned_mesh_bounds_policy: set_up.skinned_mesh_bounds_policy,
        };
        app.register_asset_loader(FbxLoader { gltf });
    }

    fn is_unique(&self) -> bool {
        false
    }
}

/// Tells the asset server, once it is there, that .fbx files will be loaded.
fn announce(app: &mut App) {
    let world = app.world();
    if world.contains_resource::<AssetServer>() && !world.contains_resource::<Announced>() {
        app.init_asset::<FbxConversion>()
            .preregister_asset_loader::<FbxLoader>(&["fbx"])
            .insert_resource(Announced);
    }
}

/// What an .fbx file became, under the label [`FbxConversion::LABEL`]. Nobody holds it but who asks for it.
#[derive(Asset, TypePath, Clone, Debug)]
pub struct FbxConversion {
    /// How exact it is, and what is lost.
    pub report: Report,
    /// The .glb that Bevy's loader was given.
    pub glb: Arc<[u8]>,
}

impl FbxConversion {
    /// Its label: `load("hero.fbx#Conversion")`.
    pub const LABEL: &str = "Conversion";
}

/// Loads .fbx files as [`Gltf`].
#[derive(TypePath)]
pub struct FbxLoader {
    gltf: GltfLoader,
}

/// Settings of one file: `asset_server.load_builder().with_settings(...)`.
#[derive(Serialize, Deserialize, Default)]
pub struct FbxLoaderSettings {
    /// How far the skin may be from where the file has it, metres; `None` is the default of
    /// [`Options`].
    pub max_error: Option<f64>,
    /// Memory that converting may take, bytes; `None` is the default of [`Options`].
    pub max_memory: Option<usize>,
    /// Folders of the asset source to look for pictures in, from its root: `art/skins`. Pictures are
    /// looked for beside the file too, and in `NAME.fbm`, `Textures` and `Texture` there; names have to be
    /// in the case that the file says, since asset sources are not listed.
    #[serde(default)]
    pub textures: Vec<String>,
    /// Settings of Bevy's glTF loader.
    pub gltf: GltfLoaderSettings,
}

/// Why an .fbx file was not loaded.
#[derive(Debug, thiserror::Error)]
pub enum FbxLoaderError {
    /// It could not be read.
    #[error(transparent)]
    Read(#[from] std::io::Error),
    /// It could not be converted.
    #[error(transparent)]
    Fbx(#[from] FbxError),
    /// Bevy refused the result.
    #[error(transparent)]
    Gltf(#[from] GltfError),
}

impl AssetLoader for FbxLoader {
    type Asset = Gltf;
    type Settings = FbxLoaderSettings;
    type Error = FbxLoaderError;

    async fn load(
        &self,
        reader: &mut dyn Reader,
        settings: &FbxLoaderSettings,
        load_context: &mut LoadContext<'_>,
    ) -> Result<Gltf, FbxLoaderError> {
        let mut bytes = Vec::new();
        reader.read_to_end(&mut bytes).await?;
        let path = load_context.path().clone();
        let mut origin = Origin {
            name: path.to_string(),
            ..Origin::default()
        };
        let made = converted(&bytes, &origin, settings)?;
        origin.files = beside(&made, &path, &settings.textures, load_context).await;
        let mut made = match origin.files.is_empty() {
            true => made,
            false => converted(&bytes, &origin, settings)?,
        };
        // The conversion was given no folder and knows nothing of those of the asset source.
        let missed = made.report.lost.iter_mut();
        for lost in missed.filter(|lost| lost.what == "texture-file") {
            let given: String = settings.textures.iter().map(|f| format!(", {f}")).collect();
            lost.detail = format!(
                "is not embedded and not among the assets beside the file, in NAME.fbm, textures, Textures, texture or Texture there{given}"
            );
        }
        for lost in &made.report.lost {
            info!("{path}: {} {:?}: {}", lost.what, lost.name, lost.detail);
        }
        let glb: Arc<[u8]> = made.to_glb()?.into();
        let conversion = FbxConversion {
            report: made.report,
            glb: glb.clone(),
        };
        load_context.add_labeled_asset(FbxConversion::LABEL, conversion);
        Ok(GltfLoader::load_gltf(&self.gltf, &glb, load_context, &settings.gltf).await?)
    }

    fn extensions(&self) -> &[&str] {
        &["fbx"]
    }
}

fn converted(
    bytes: &[u8],
    origin: &Origin,
    settings: &FbxLoaderSettings,
) -> Result<Conversion, FbxError> {
    let defaults = Options::default();
    let options = Options {
        max_error: settings.max_error.unwrap_or(defaults.max_error),
        max_memory: settings.max_memory,
        // Bevy's skinned meshes follow four joints.
        weights: Weights::Four,
        ..defaults
    };
    convert(bytes, origin, &options)
}

/// Pictures that were missed, as far as they lie beside the file, in the folders there that pictures are
/// put into, or in `folders`: assets come through asset sources, which have no folders that a file could
/// be opened in.
async fn beside(
    made: &Conversion,
    path: &AssetPath<'static>,
    folders: &[String],
    load_context: &mut LoadContext<'_>,
) -> BTreeMap<String, Vec<u8>> {
    let missed = made
        .report
        .lost
        .iter()
        .filter(|lost| lost.what == "texture-file");
    let stem = path.path().file_stem();
    let media = stem.map(|stem| format!("{}.fbm/", stem.to_string_lossy()));
    let near = [
        "",
        media.as_deref().unwrap_or_default(),
        "textures/",
        "Textures/",
        "texture/",
        "Texture/",
    ];
    // From the root of the file's own asset source.
    let far = folders
        .iter()
        .map(|folder| format!("/{}/", folder.trim_matches('/')));
    let places: Vec<String> = near.into_iter().map(str::to_owned).chain(far).collect();
    let mut found = BTreeMap::new();
    for name in missed.map(|lost| &lost.name) {
        let names = std::iter::once(name.clone()).chain(saved_again(name));
        'names: for name in names {
            for place in &places {
                let Ok(place) = path.resolve_embed_str(&format!("{place}{name}")) else {
                    continue;
                };
                if let Ok(bytes) = load_context.read_asset_bytes(place).await {
                    found.insert(name, bytes);
                    break 'names;
                }
            }
        }
    }
    found
}
