//! A ground that a camera sees, frame by frame.

use bevy::math::DVec2;
use bevy::prelude::*;
use dolomite_geometry::GeometryStats;
use dolomite_ground::detail::{MakingBudget, Metric, TerrainLod};
use dolomite_ground::render::{DrawnGround, GroundProgress};
use dolomite_ground::{GroundLayer, GroundMaterial, Surface, TerrainView};
use dolomite_terrain::{Fractal, GroundRect, Layer, Source, Terrain, TerrainData};

/// The tolerance of [`detail`].
pub const PIXELS: f32 = 2.0;

/// Most frames that a view may take until it rests.
const MOST: usize = 120;

/// Rough hills, 1 km square.
pub fn hills() -> Terrain {
    let fractal = Fractal {
        octaves: 9,
        amplitude: 60.0,
        wavelength: 400.0,
        ..Fractal::default()
    };
    let terrain = Terrain::new(TerrainData {
        extent: GroundRect::square(DVec2::ZERO, 1024.0),
        layers: vec![Layer {
            source: Source::Fractal(fractal),
            mask: None,
        }],
        base: 0.0,
        sea_level: None,
    });
    terrain.expect("valid")
}

/// Of one colour.
pub fn meadow() -> GroundMaterial {
    let surface = Surface::Flat {
        colour: [0.3, 0.5, 0.2],
        roughness: 0.9,
    };
    GroundMaterial {
        layers: vec![GroundLayer::new("", surface)],
    }
}

/// An error of [`PIXELS`].
pub fn detail() -> TerrainLod {
    TerrainLod {
        metric: Metric::ErrorBound { pixels: PIXELS },
        ..default()
    }
}

/// An app with a ground and a camera of 320 × 180 pixels.
pub struct Seen {
    pub app: App,
    pub target: Handle<Image>,
    pub camera: Entity,
    pub terrain: Entity,
}

impl Seen {
    /// `blocks` are made in a frame. `None` where nothing can be drawn, see [`app`](super::app).
    pub fn new(terrain: &Terrain, place: Transform, blocks: Option<u32>) -> Option<Self> {
        let mut app = super::app()?;
        app.insert_resource(MakingBudget { blocks });
        app.insert_resource(GlobalAmbientLight {
            brightness: 600.0,
            ..default()
        });
        let sun = Transform::default().looking_to(Vec3::new(1.0, -0.6, 0.4), Vec3::Y);
        app.world_mut().spawn((DirectionalLight::default(), sun));
        let terrain = app.world_mut().spawn((terrain.clone(), meadow())).id();
        let target = super::target(&mut app, 320, 180);
        let camera = super::camera(&mut app, &target, (TerrainView, detail(), place));
        Some(Self {
            app,
            target,
            camera,
            terrain,
        })
    }

    /// Puts components on the camera.
    pub fn set(&mut self, components: impl Bundle) {
        self.app
            .world_mut()
            .entity_mut(self.camera)
            .insert(components);
    }

    /// One frame; what is drawn in it.
    pub fn frame(&mut self) -> Option<DrawnGround> {
        super::frames(&mut self.app, 1);
        let progress = self.app.world().resource::<GroundProgress>();
        progress.of(self.camera)
    }

    /// Dispatches of the last frame but one: what is counted arrives with the next frame.
    pub fn dispatches(&self) -> u32 {
        self.app.world().resource::<GeometryStats>().dispatches
    }

    /// Frames until the view rests, and the bound that each of them held.
    pub fn rest(&mut self) -> Vec<Option<f32>> {
        let mut held = Vec::new();
        for _ in 0..MOST {
            let ground = self.frame().unwrap_or_default();
            held.push(ground.held);
            if ground.settled {
                return held;
            }
        }
        panic!("no rest after {MOST} frames: {held:?}");
    }

    pub fn picture(&mut self) -> Image {
        super::picture(&mut self.app, &self.target)
    }
}
