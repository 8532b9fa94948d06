//! `load("strip.fbx")` in a Bevy app without a window.

use crate::support::ascii;
use bevy::asset::io::memory::{Dir, MemoryAssetReader};
use bevy::asset::io::{AssetSourceBuilder, AssetSourceId};
use bevy::asset::{AssetPlugin, LoadState};
use bevy::gltf::{Gltf, GltfAssetLabel, GltfMesh, GltfPlugin};
use bevy::mesh::MeshPlugin;
use bevy::prelude::*;
use bevy::world_serialization::WorldSerializationPlugin;
use dolomite_fbx::{FbxConversion, FbxPlugin, Options, Origin, convert};
use std::path::Path;

/// When our plugin is added, as seen from Bevy's.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Added {
    Before,
    After,
    Twice,
}

fn app(files: &[(&str, Vec<u8>)]) -> App {
    app_with(files, Added::After)
}

fn app_with(files: &[(&str, Vec<u8>)], added: Added) -> App {
    let folder = Dir::default();
    for (name, bytes) in files {
        folder.insert_asset(Path::new(name), bytes.clone());
    }
    let reader = MemoryAssetReader { root: folder };
    let mut app = App::new();
    app.register_asset_source(
        AssetSourceId::Default,
        AssetSourceBuilder::new(move || Box::new(reader.clone())),
    );
    if added != Added::After {
        app.add_plugins(FbxPlugin);
    }
    app.add_plugins((
        MinimalPlugins,
        AssetPlugin::default(),
        WorldSerializationPlugin,
        MeshPlugin,
    ));
    app.init_asset::<Image>().init_asset::<AnimationClip>();
    app.add_plugins(GltfPlugin::default());
    if added != Added::Before {
        app.add_plugins(FbxPlugin);
    }
    app.finish();
    app.cleanup();
    app
}

fn load(app: &mut App, name: &'static str) -> Result<Handle<Gltf>, String> {
    let handle: Handle<Gltf> = app.world().resource::<AssetServer>().load(name);
    for _ in 0..10_000 {
        app.update();
        let server = app.world().resource::<AssetServer>();
        match server.load_state(&handle) {
            LoadState::Failed(error) => return Err(error.to_string()),
            LoadState::Loaded if server.is_loaded_with_dependencies(&handle) => return Ok(handle),
            _ => std::thread::sleep(std::time::Duration::from_millis(1)),
        }
    }
    panic!("{name} was never loaded");
}

/// The same sub-assets as of the .glb that the file converts to, under the same labels.
#[test]
fn an_fbx_file_has_the_sub_assets_of_its_glb() {
    let text = ascii::strip(90.0);
    let glb = convert(text.as_bytes(), &Origin::default(), &Options::default())
        .unwrap()
        .to_glb()
        .unwrap();
    let mut app = app(&[("strip.fbx", text.into_bytes()), ("strip.glb", glb)]);
    let fbx = load(&mut app, "strip.fbx").unwrap();
    let glb = load(&mut app, "strip.glb").unwrap();
    let gltfs = app.world().resource::<Assets<Gltf>>();
    let (fbx, glb) = (gltfs.get(&fbx).unwrap(), gltfs.get(&glb).unwrap());
    assert_eq!(fbx.scenes.len(), 1);
    assert_eq!(fbx.nodes.len(), glb.nodes.len());
    assert_eq!(fbx.skins.len(), 1);
    assert_eq!(fbx.animations.len(), 1);
    assert!(fbx.named_animations.contains_key("bend"));
    assert!(fbx.named_nodes.contains_key("tip"));
    let server = app.world().resource::<AssetServer>();
    let mesh: Handle<GltfMesh> = server.load(GltfAssetLabel::Mesh(0).from_asset("strip.fbx"));
    assert_eq!(mesh.id(), fbx.meshes[0].id());
}

/// The report and the bytes are there for who asks, and for nobody else.
#[test]
fn the_conversion_is_a_sub_asset() {
    let text = ascii::strip(90.0);
    let wanted = convert(text.as_bytes(), &Origin::default(), &Options::default()).unwrap();
    let mut app = app(&[("strip.fbx", text.into_bytes())]);
    let unasked = load(&mut app, "strip.fbx").unwrap();
    app.update();
    assert_eq!(app.world().resource::<Assets<FbxConversion>>().len(), 0);
    drop(unasked);
    app.update();

    let server = app.world().resource::<AssetServer>();
    let asked: Handle<FbxConversion> = server.load("strip.fbx#Conversion");
    load(&mut app, "strip.fbx").unwrap();
    let conversions = app.world().resource::<Assets<FbxConversion>>();
    let found = conversions.get(&asked).unwrap();
    assert_eq!(found.report.vertices, wanted.report.vertices);
    assert_eq!(&found.glb[..4], b"glTF");
}

#[test]
fn the_order_of_plugins_does_not_matter() {
    let text = ascii::strip(90.0).into_bytes();
    for added in [Added::Before, Added::After, Added::Twice] {
        let mut app = app_with(&[("strip.fbx", text.clone())], added);
        let server = app.world().resource::<AssetServer>();
        let made: Handle<FbxConversion> = server.load("strip.fbx#Conversion");
        let fbx = load(&mut app, "strip.fbx").unwrap_or_else(|error| panic!("{added:?}: {error}"));
        let gltfs = app.world().resource::<Assets<Gltf>>();
        assert_eq!(gltfs.get(&fbx).unwrap().skins.len(), 1, "{added:?}");
        let conversions = app.world().resource::<Assets<FbxConversion>>();
        assert!(conversions.get(&made).is_some(), "{added:?}");
    }
}

/// Nothing to load with: the app runs all the same.
#[test]
fn without_bevys_loader_nothing_is_loaded_and_nothing_ends() {
    for plugins in [false, true] {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, FbxPlugin));
        if plugins {
            app.add_plugins(AssetPlugin::default());
        }
        app.finish();
        app.cleanup();
        app.update();
        assert_eq!(app.should_exit(), None);
    }
}

#[test]
fn a_broken_file_is_an_error_that_names_it() {
    let mut app = app(&[("broken.fbx", b"no FBX".to_vec())]);
    let refusal = load(&mut app, "broken.fbx").unwrap_err();
    assert!(refusal.contains("broken.fbx"), "{refusal}");
}
