//! Tolerances, budgets and cameras that nobody would choose: the app goes on, no pool is overrun, no frame takes
//! long; and once all is well again the picture is the one of before, byte for byte.

use crate::support::app;
use crate::support::camera;
use crate::support::hills;
use crate::support::picture;
use crate::support::rest;

use std::time::{Duration, Instant};

use bevy::camera::{OrthographicProjection, ScalingMode};
use bevy::core_pipeline::prepass::{DeferredPrepass, DepthPrepass};
use bevy::math::DVec2;
use bevy::prelude::*;
use dolomite::DolomitePlugins;
use dolomite::ground::detail::budget::{Budget, BudgetError, BudgetReport};
use dolomite::ground::detail::{Metric, TerrainLod};
use dolomite::ground::{GroundPlugin, TerrainView};
use dolomite::terrain::{Fractal, Ground, Terrain};
use dolomite::tessellation::render::GeometryStats;

/// Few vertices, so that the finest tolerances are met by the pool's end and not by the machine's.
const POOL: u32 = 1 << 13;

/// The work of a frame is bounded by the pool, so the dearest is one with a full pool. A frame of anything else may
/// take so many times as long: what else the machine does has its share of that. Work that followed a hostile
/// number instead, a tolerance of 1e-38 or an angle of nothing, would be beyond all bounds.
const TIMES_A_FULL_POOL: u32 = 20;

fn ground(app: &mut App) -> Terrain {
    let hills = hills::Hills {
        centre: DVec2::new(3e5, -2e5),
        side: 2048.0,
        noise: Fractal {
            octaves: 8,
            amplitude: 60.0,
            wavelength: 200.0,
            ..Fractal::default()
        },
        base: 40.0,
        sea: Some(0.0),
    };
    hills.spawn(app)
}

fn detail(metric: Metric) -> TerrainLod {
    TerrainLod {
        metric,
        finest: 0.5,
        max_vertices: POOL,
        ..TerrainLod::default()
    }
}

/// A world with one camera over the ground.
struct Scene {
    app: App,
    camera: Entity,
    target: Handle<Image>,
    sane: (Transform, Projection, TerrainLod),
    /// Longest frame of a view that fills the pool; none until it is measured.
    full: Option<Duration>,
}

impl Scene {
    fn new() -> Option<Self> {
        let mut app = app::app(Duration::ZERO, |app| {
            // A relief map would arrive in the middle of the pictures. The group adds the plugin again, which does nothing.
            app.add_plugins((GroundPlugin { relief_side: 0 }, DolomitePlugins));
        })?;
        let ground = ground(&mut app);
        app.world_mut().spawn((
            DirectionalLight::default(),
            Transform::default().looking_to(Vec3::new(-2.0, -1.0, -1.0), Vec3::Y),
        ));
        let xz = DVec2::new(3e5 + 20.0, -2e5 + 30.0);
        let eye = Vec3::new(xz.x as f32, ground.height(xz) as f32 + 6.0, xz.y as f32);
        let sane = (
            Transform::from_translation(eye).looking_to(Vec3::new(0.3, -0.1, -1.0), Vec3::Y),
            Projection::Perspective(PerspectiveProjection::default()),
            detail(Metric::ErrorBound { pixels: 4.0 }),
        );
        let prepasses = (DepthPrepass, DeferredPrepass);
        let view = (prepasses, TerrainView, sane.clone());
        let (camera, target) = camera::camera(&mut app, UVec2::new(96, 54), view);
        let mut scene = Self {
            app,
            camera,
            target,
            sane,
            full: None,
        };
        // Once to compile all passes, once to measure.
        let mut drawn = Vec::new();
        for pixels in [2e-3, 1e-3] {
            scene.sane();
            drawn.push(scene.vertices());
            let full = detail(Metric::ErrorBound { pixels });
            scene.full = Some(scene.longest("a full pool", full));
            drawn.push(scene.vertices());
        }
        // The pool's end bounds this view, not its tolerance: half of it adds nothing. How full the pool is follows
        // from the levels of cells, which come and go in fours.
        let [sane, full, _, fuller] = drawn[..] else {
            unreachable!("four views");
        };
        assert!(
            full > sane && fuller.abs_diff(full) * 10 < full && full < POOL,
            "{drawn:?}"
        );
        Some(scene)
    }

    fn vertices(&self) -> u32 {
        self.app.world().resource::<GeometryStats>().vertices
    }

    /// The longest of five frames with this on the camera.
    fn longest(&mut self, name: &str, components: impl Bundle) -> Duration {
        self.app
            .world_mut()
            .entity_mut(self.camera)
            .insert(components);
        let frames = (0..5).map(|_| {
            let began = Instant::now();
            self.app.update();
            assert_eq!(self.app.should_exit(), None, "{name}: rendering stopped");
            began.elapsed()
        });
        frames.max().expect("five frames")
    }

    /// Some frames with this on the camera; what the stage says of the last.
    fn frames(&mut self, name: &str, components: impl Bundle + Clone) -> GeometryStats {
        let most = self.full.map(|full| full * TIMES_A_FULL_POOL);
        let took = self.longest(name, components.clone());
        if most.is_some_and(|most| took > most) {
            // A pipeline that was not needed before is compiled once: the second time it is there.
            let sane = self.sane.clone();
            self.longest("sane", sane);
            let again = self.longest(name, components);
            assert!(Some(again) <= most, "{name}: {took:?}, then {again:?}");
        }
        let stats = self.app.world().resource::<GeometryStats>().clone();
        // A vertex brings two triangles.
        assert!(stats.primitives <= 2 * POOL, "{name}: {}", stats.primitives);
        stats
    }

    /// The picture with everything as it was at first.
    fn sane(&mut self) -> Vec<u8> {
        // Nothing moves, so the picture is one of the ground alone.
        let sane = self.sane.clone();
        self.picture("sane", sane)
    }

    /// The picture with this on the camera, once all that it asks for has been made.
    fn picture(&mut self, name: &str, components: impl Bundle + Clone) -> Vec<u8> {
        self.frames(name, components);
        let rests = rest::comes_to_rest(5, || {
            self.app.update();
            rest::is_settled(&self.app)
        });
        assert!(rests, "{name}: it does not come to rest");
        let image = picture::picture(&mut self.app, &self.target, 0);
        image.data.expect("pixels")
    }

    /// [`Self::sane`], after it was seen that little things that stay would show: other triangles of the same
    /// ground, and the camera a hand's breadth aside.
    fn sane_and_told_apart(&mut self) -> Vec<u8> {
        let sane = self.sane();
        let coarser = detail(Metric::ErrorBound { pixels: 8.0 });
        assert!(
            self.picture("8 px", coarser) != sane,
            "twice the tolerance does not show"
        );
        let (mut aside, _, original) = self.sane.clone();
        aside.translation.x += 0.1;
        assert!(
            self.picture("aside", (aside, original)) != sane,
            "a tenth of a metre does not show"
        );
        assert!(self.sane() == sane, "nothing hostile was on the camera yet");
        sane
    }
}

#[test]
fn gpu_hostile_tolerances_are_clamped_and_leave_nothing_behind() {
    let Some(mut scene) = Scene::new() else {
        return;
    };
    let before = scene.sane_and_told_apart();
    let mut metrics = Vec::new();
    for pixels in [
        0.0,
        -1.0,
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        1e-38,
        1e38,
    ] {
        metrics.push(Metric::ErrorBound { pixels });
        metrics.push(Metric::EdgeLength { pixels });
        metrics.push(Metric::Classic {
            patch: pixels,
            least: pixels,
            greatest: pixels,
            reach: pixels,
            height: pixels,
        });
    }
    for metric in metrics {
        let name = format!("{metric:?}");
        scene.frames(&name, detail(metric));
    }
    for (finest, most, share) in [
        (f32::NAN, 0, f32::NAN),
        (0.0, 1, -1.0),
        (-3.0, POOL, f32::INFINITY),
        (f32::INFINITY, POOL, 0.0),
    ] {
        let hostile = TerrainLod {
            finest,
            max_vertices: most,
            shadow_share: share,
            ..detail(Metric::default())
        };
        scene.frames(&format!("{hostile:?}"), hostile);
    }
    assert!(scene.sane() == before, "something stayed");
}

#[test]
fn gpu_budgets_that_make_no_sense_are_refused_and_hopeless_ones_said_to_be() {
    let Some(mut scene) = Scene::new() else {
        return;
    };
    let before = scene.sane_and_told_apart();
    let tolerance = |scene: &Scene| {
        let detail = scene.app.world().entity(scene.camera).get::<TerrainLod>();
        detail.expect("it has one").metric
    };
    for milliseconds in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        let hostile = Budget {
            milliseconds,
            ..Budget::default()
        };
        scene.frames(&format!("{hostile:?}"), hostile);
        let report = scene.app.world().entity(scene.camera).get::<BudgetReport>();
        let fault = report.expect("required").fault;
        assert!(
            matches!(fault, Some(BudgetError::Milliseconds(_))),
            "{fault:?}"
        );
        assert_eq!(tolerance(&scene), Metric::ErrorBound { pixels: 4.0 });
    }
    // A nanosecond: nobody meets it. The coarsest tolerance is drawn with.
    let hopeless = Budget {
        milliseconds: 1e-6,
        ..Budget::default()
    };
    for _ in 0..6 {
        scene.frames("a nanosecond", hopeless);
    }
    let report = *scene
        .app
        .world()
        .entity(scene.camera)
        .get::<BudgetReport>()
        .expect("required");
    assert!(report.fault.is_none() && !report.held, "{report:?}");
    scene
        .app
        .world_mut()
        .entity_mut(scene.camera)
        .remove::<Budget>();
    assert!(scene.sane() == before, "something stayed");
}

#[test]
fn gpu_hostile_cameras_see_what_there_is() {
    let Some(mut scene) = Scene::new() else {
        return;
    };
    let before = scene.sane_and_told_apart();
    let (level, lens, _) = scene.sane.clone();
    let at = |offset: Vec3| Transform {
        translation: level.translation + offset,
        ..level
    };
    let perspective = |fov: f32, near: f32| {
        Projection::Perspective(PerspectiveProjection {
            fov,
            near,
            ..default()
        })
    };
    let parallel = |height: f32| {
        Projection::Orthographic(OrthographicProjection {
            scaling_mode: ScalingMode::FixedVertical {
                viewport_height: height,
            },
            ..OrthographicProjection::default_3d()
        })
    };
    let down = level.looking_to(Vec3::NEG_Y, Vec3::X);
    let cameras = [
        ("inside the ground", at(Vec3::Y * -40.0), lens.clone()),
        ("far below it", at(Vec3::Y * -1e6), lens.clone()),
        ("at its very height", at(Vec3::Y * -6.0), lens.clone()),
        ("above the world", at(Vec3::Y * 1e6), lens.clone()),
        (
            "looking down from there",
            Transform {
                rotation: down.rotation,
                ..at(Vec3::Y * 1e6)
            },
            lens.clone(),
        ),
        ("beside the world", at(Vec3::X * 5e6), lens.clone()),
        ("beyond all integers", at(Vec3::X * 1e12), lens.clone()),
        (
            "upside down",
            level.looking_to(Vec3::new(0.3, -0.1, -1.0), Vec3::NEG_Y),
            lens.clone(),
        ),
        (
            "straight up",
            level.looking_to(Vec3::Y, Vec3::X),
            lens.clone(),
        ),
        ("straight down", down, lens.clone()),
        (
            "mirrored",
            level.with_scale(Vec3::new(-1.0, 1.0, 1.0)),
            lens.clone(),
        ),
        (
            "179 degrees",
            level,
            perspective(179.0_f32.to_radians(), 0.1),
        ),
        (
            "a hundredth of a degree",
            level,
            perspective(0.01_f32.to_radians(), 0.1),
        ),
        ("near plane at a micrometre", level, perspective(1.0, 1e-6)),
        ("near plane at a kilometre", level, perspective(1.0, 1000.0)),
        ("parallel", level, parallel(100.0)),
        ("parallel, a millimetre", level, parallel(1e-3)),
        ("parallel, a thousand kilometres", down, parallel(1e6)),
        ("nowhere", at(Vec3::splat(f32::NAN)), lens.clone()),
        ("at no height", at(Vec3::Y * f32::NAN), lens.clone()),
        ("infinitely far", at(Vec3::X * f32::INFINITY), lens.clone()),
        (
            "infinitely deep",
            at(Vec3::Y * f32::NEG_INFINITY),
            lens.clone(),
        ),
        // Turns and sizes that leave no direction end Bevy's own frusta in a debug build, so none is here.
        ("an angle of NaN", level, perspective(f32::NAN, 0.1)),
        ("an angle of 0", level, perspective(0.0, 0.1)),
        ("an infinite angle", level, perspective(f32::INFINITY, 0.1)),
        ("near plane at NaN", level, perspective(1.0, f32::NAN)),
        (
            "near plane at infinity",
            level,
            perspective(1.0, f32::INFINITY),
        ),
        ("near plane at 0", level, perspective(1.0, 0.0)),
        ("parallel, NaN", level, parallel(f32::NAN)),
    ];
    for (name, place, projection) in cameras {
        let stats = scene.frames(name, (place, projection));
        eprintln!("{name}: {} triangles", stats.primitives);
        // These look at ground.
        let sees = [
            "upside down",
            "straight down",
            "mirrored",
            "179 degrees",
            "parallel",
        ];
        assert!(!sees.contains(&name) || stats.primitives > 1, "{name}");
    }
    assert!(scene.sane() == before, "something stayed");
}
