//! What a picture needs of the app's cameras, for as long as it is shown; and what is refused.

use bevy::core_pipeline::prepass::{
    DeferredPrepass, DepthPrepass, MotionVectorPrepass, NormalPrepass,
};
use bevy::prelude::*;
use bevy::render::RenderApp;
use bevy::shader::{Shader, ValidateShader};
use thiserror::Error;

use super::source::{Picture, Source};
use super::{FramePicture, Pictures};

/// Why a picture is not shown.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum PictureRefusal {
    /// The app draws nothing.
    #[error("{0} is not shown: this app has no renderer")]
    NoRenderer(&'static str),
    /// There is no camera.
    #[error("{0} is not shown: there is no 3D camera now")]
    NoCamera(&'static str),
    /// It reads the G-buffer, and there is none.
    #[error(
        "{0} is not shown: no camera writes a G-buffer; give one DepthPrepass, DeferredPrepass and Msaa::Off"
    )]
    NoGBuffer(&'static str),
}

/// The picture that is shown, with its shader: there while one is. The render world has its own.
#[derive(Resource, Clone)]
pub(super) struct Shown {
    pub picture: Picture,
    pub settings: FramePicture,
    pub shader: Handle<Shader>,
}

/// The shader and what it imports, from the first picture on.
#[derive(Resource)]
pub(super) struct Loaded {
    shader: Handle<Shader>,
    #[expect(dead_code, reason = "held, never read")]
    modules: Vec<Handle<Shader>>,
}

/// Says that the app has a renderer.
#[derive(Resource)]
pub struct PictureRenders;

/// Prepasses that a camera has for a picture alone.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Lent {
    depth: bool,
    normals: bool,
    motion: bool,
}

/// Shows a picture, or the frame again.
pub(super) fn switch(world: &mut World, name: &'static str, on: bool) -> Result<(), String> {
    if on {
        possible(world, name).map_err(|refusal| refusal.to_string())?;
    }
    let mut shown = world.get_resource_or_init::<FramePicture>();
    if on {
        name.clone_into(&mut shown.shown);
    } else if shown.shown == name {
        shown.shown.clear();
    }
    Ok(())
}

fn possible(world: &mut World, name: &'static str) -> Result<(), PictureRefusal> {
    if !world.contains_resource::<PictureRenders>() {
        return Err(PictureRefusal::NoRenderer(name));
    }
    let mut cameras = world.query_filtered::<Has<DeferredPrepass>, With<Camera3d>>();
    let deferred: Vec<bool> = cameras.iter(world).collect();
    if deferred.is_empty() {
        return Err(PictureRefusal::NoCamera(name));
    }
    let picture = world
        .get_resource::<Pictures>()
        .and_then(|pictures| pictures.get(name));
    let words_alone = picture.is_some_and(|picture| {
        let mut ways = picture.ways.iter();
        ways.all(|way| matches!(way.source, Source::Words))
    });
    if words_alone && !deferred.contains(&true) {
        return Err(PictureRefusal::NoGBuffer(name));
    }
    Ok(())
}

/// Lends cameras the prepass that the picture reads and they lack, and takes back what was lent for the last one.
pub(super) fn equip(
    mut commands: Commands,
    settings: Res<FramePicture>,
    pictures: Res<Pictures>,
    renders: Option<Res<PictureRenders>>,
    loaded: Option<Res<Loaded>>,
    shaders: Option<ResMut<Assets<Shader>>>,
    cameras: Query<
        (
            Entity,
            Has<DeferredPrepass>,
            Has<DepthPrepass>,
            Has<NormalPrepass>,
            Has<MotionVectorPrepass>,
            Option<&Lent>,
        ),
        With<Camera3d>,
    >,
    was_shown: Option<Res<Shown>>,
) {
    let picture = pictures.get(&settings.shown);
    let (Some(picture), Some(_), Some(mut shaders)) = (picture, renders, shaders) else {
        if was_shown.is_some() {
            commands.remove_resource::<Shown>();
            for (camera, _, _, _, _, lent) in &cameras {
                take_back(
                    &mut commands,
                    camera,
                    lent.copied().unwrap_or_default(),
                    Lent::default(),
                );
            }
        }
        return;
    };
    for (camera, words, depth, normals, motion, lent) in &cameras {
        let lent = lent.copied().unwrap_or_default();
        let needs = needs(picture, words);
        let wanted = Lent {
            depth: needs.depth && (!depth || lent.depth),
            normals: needs.normals && (!normals || lent.normals),
            motion: needs.motion && (!motion || lent.motion),
        };
        take_back(&mut commands, camera, lent, wanted);
        let mut camera = commands.entity(camera);
        if wanted.depth && !lent.depth {
            camera.insert(DepthPrepass);
        }
        if wanted.normals && !lent.normals {
            camera.insert(NormalPrepass);
        }
        if wanted.motion && !lent.motion {
            camera.insert(MotionVectorPrepass);
        }
        if wanted != Lent::default() {
            camera.insert(wanted);
        }
    }
    let shader = match loaded {
        Some(loaded) => loaded.shader.clone(),
        None => {
            let loaded = load(&mut shaders);
            let shader = loaded.shader.clone();
            commands.insert_resource(loaded);
            shader
        }
    };
    if was_shown.is_some_and(|shown| shown.settings == *settings) {
        return;
    }
    commands.insert_resource(Shown {
        picture: picture.clone(),
        settings: settings.clone(),
        shader,
    });
}

/// The prepass that a camera needs for a picture, apart from those of the G-buffer, which are not lent.
fn needs(picture: &Picture, words: bool) -> Lent {
    let mut ways = picture.ways.iter();
    let way = ways.find(|way| words || !matches!(way.source, Source::Words));
    let source = way.map(|way| way.source);
    Lent {
        depth: matches!(source, Some(Source::Depth)),
        normals: matches!(source, Some(Source::Normals)),
        motion: matches!(source, Some(Source::Motion)),
    }
}

fn take_back(commands: &mut Commands, camera: Entity, lent: Lent, wanted: Lent) {
    let mut camera = commands.entity(camera);
    if lent.depth && !wanted.depth {
        camera.remove::<DepthPrepass>();
    }
    if lent.normals && !wanted.normals {
        camera.remove::<NormalPrepass>();
    }
    if lent.motion && !wanted.motion {
        camera.remove::<MotionVectorPrepass>();
    }
    if lent != Lent::default() && wanted == Lent::default() {
        camera.remove::<Lent>();
    }
}

/// The modules that the shader imports.
const MODULES: [&str; 4] = [
    "deferred/gbuffer.wgsl",
    "deferred/pyramid.wgsl",
    "inspector/colours.wgsl",
    "inspector/legend.wgsl",
];

fn load(shaders: &mut Assets<Shader>) -> Loaded {
    let mut add = |path: &str| {
        let mut shader = Shader::from_wgsl(dolomite_shaders::find(path).source, path);
        if cfg!(debug_assertions) {
            shader.validate_shader = ValidateShader::Enabled;
        }
        shaders.add(shader)
    };
    Loaded {
        modules: MODULES.map(&mut add).into(),
        shader: add("inspector/picture.wgsl"),
    }
}

/// Says whether the app draws.
pub(super) fn look(app: &mut App) {
    if app.get_sub_app(RenderApp).is_some() {
        app.insert_resource(PictureRenders);
    }
}
