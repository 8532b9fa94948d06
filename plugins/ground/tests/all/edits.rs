//! Ground that is edited while it is drawn: what is made anew, that the bound holds, and that undoing restores the picture.

use crate::app;
use crate::app::seen::{PIXELS, Seen, hills, meadow};
use crate::blocks::support::{MOST, laid_on_samples, params, terrain, view};

use bevy::math::{DVec2, UVec2};
use bevy::prelude::*;
use bevy::render::RenderApp;
use dolomite_geometry::GeometryStats;
use dolomite_ground::TerrainView;
use dolomite_ground::detail::{Metric, TerrainLod};
use dolomite_ground::render::{GroundProgress, TerrainRelief, words_of_edits};
use dolomite_terrain::{
    Edit, EditKind, Edits, Ground, GroundProbe, GroundRect, Hill, Layer, ProbeBatch, Source,
    Terrain, TerrainData, TerrainEdits,
};
use dolomite_testkit::blocks::BlockStage;
use dolomite_testkit::gpu::for_test;
use std::collections::HashMap;
use std::time::{Duration, Instant};

fn brush(kind: EditKind, place: DVec2, strength: f64) -> Edit {
    Edit {
        kind,
        place,
        radius: 20.0,
        strength,
        falloff: 0.7,
    }
}

/// Every vertex that has arrived stands on the edited ground, and triangles are within their pixels of it.
#[test]
fn gpu_the_bound_holds_on_edited_ground() {
    let Some(gpu) = for_test() else { return };
    let ground = terrain();
    let mut edits = TerrainEdits::new(&ground).expect("fits");
    let mut now = ground.with_edits(Some(Edits::none(*edits.lattice())));
    let pixels = 2.0;
    let metric = Metric::ErrorBound { pixels };
    let seen = view(&ground, 0.0, 12.0, metric);
    let laid = laid_on_samples(&now, 0.25);
    let mut stage = BlockStage::new(&gpu, &laid, 4096).expect("passes");
    let eye = DVec2::new(1e5 + 37.25, -1e5 - 110.5);
    for (k, (kind, strength)) in [
        (EditKind::Lower, 9.0),
        (EditKind::Flatten { height: None }, 1.0),
        (EditKind::Raise, 12.0),
        (EditKind::Smooth, 1.0),
    ]
    .into_iter()
    .enumerate()
    {
        let away = 40.0 + 35.0 * k as f64;
        let place = eye + DVec2::new((k as f64 - 1.5) * 9.0, -away);
        let made = edits.apply(&now, &brush(kind, place, strength));
        now = made.expect("valid").terrain;
        stage.edit(&now);
        let (run, _) = stage.settle(params(&laid, seen), 64, MOST).expect("runs");
        assert_eq!(run.coarsening, 1.0);
        let anchor = DVec2::new(f64::from(seen.anchor[0]), f64::from(seen.anchor[1]));
        let scale = f64::from(seen.scale);
        let eye_at = Vec3::from(seen.eye).as_dvec3();
        let (mut looked, mut most) = (0, 0.0_f64);
        for triangle in &run.triangles {
            let corners = triangle.map(|k| Vec3::from(run.positions[k as usize]).as_dvec3());
            let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
            let places = corners
                .iter()
                .map(|corner| middle.lerp(*corner, 0.5))
                .chain([middle]);
            for at in places {
                let xz = DVec2::new(at.x, at.z) + anchor;
                let in_view = seen.planes.iter().all(|&[x, y, z, d]| {
                    at.dot(Vec3::new(x, y, z).as_dvec3()) + f64::from(d) >= 0.0
                });
                if !in_view || (xz - place).length() > 30.0 {
                    continue;
                }
                let truth = now.height(xz).max(0.0);
                let distance = (at - eye_at).length();
                // Of a vertical length at most.
                let error = (at.y - truth).abs() * scale / distance;
                looked += 1;
                most = most.max(error);
            }
        }
        println!("{most:.3} px of {pixels} at {looked} places");
        assert!(looked > 2000, "{looked}");
        assert!(most <= f64::from(pixels), "{most}");
    }
}

/// Flat ground of 400 m with a hill.
fn hill() -> Terrain {
    let hill = Hill {
        centre: DVec2::ZERO,
        radius: 60.0,
        height: 12.0,
    };
    let terrain = Terrain::new(TerrainData {
        extent: GroundRect::square(DVec2::ZERO, 400.0),
        layers: vec![Layer {
            source: Source::Hill(hill),
            mask: None,
        }],
        base: 0.0,
        sea_level: None,
    });
    terrain.expect("valid")
}

/// Until nothing is made any more: how many frames that takes is a matter of the machine's speed.
fn settle(app: &mut App) {
    app::frames(app, 8);
    for _ in 0..300 {
        if app.world().resource::<GeometryStats>().dispatches == 0 {
            break;
        }
        app::frames(app, 1);
    }
    // Answers arrive some frames after what they are about.
    app::frames(app, 4);
}

/// The picture, once it is `wanted`: the relief map is of the edited ground where somebody edited for as long as it takes to
/// rest, and is made anew in the background some seconds after the last edit. Or, after a minute, as it is.
fn picture_like(app: &mut App, target: &Handle<Image>, wanted: &[u8]) -> Vec<u8> {
    let since = Instant::now();
    loop {
        let picture = app::picture(app, target).data.expect("pixels");
        if picture == wanted || since.elapsed() > Duration::from_secs(60) {
            return picture;
        }
        app::frames(app, 4);
    }
}

/// In an app: nothing is written where nothing is edited; then a few tiles a stroke; answers are of the edited ground;
/// and the picture after undoing is the one before.
#[test]
fn gpu_an_app_edits_its_ground() {
    let Some(mut app) = app::app() else { return };
    app.insert_resource(GlobalAmbientLight {
        brightness: 2000.0,
        ..default()
    });
    let ground = hill();
    let mut edits = TerrainEdits::new(&ground).expect("fits");
    let entity = app.world_mut().spawn((ground.clone(), meadow())).id();
    let sun = Transform::from_xyz(30.0, 20.0, 10.0).looking_at(Vec3::ZERO, Vec3::Y);
    app.world_mut().spawn((DirectionalLight::default(), sun));
    let target = app::target(&mut app, 160, 120);
    let lod = TerrainLod {
        metric: Metric::ErrorBound { pixels: 1.0 },
        ..TerrainLod::default()
    };
    let place = Transform::from_xyz(0.0, 60.0, 90.0).looking_at(Vec3::ZERO, Vec3::Y);
    app::camera(&mut app, &target, (TerrainView, lod, place));
    let places = [
        DVec2::new(3.0, 4.0),
        DVec2::new(-9.0, 2.5),
        DVec2::new(55.0, -20.0),
    ];
    let probes = places.map(|xz| {
        let at = Transform::from_xyz(xz.x as f32, 0.0, xz.y as f32);
        app.world_mut().spawn((GroundProbe::default(), at)).id()
    });
    let words = |app: &App| words_of_edits(app.sub_app(RenderApp).world());
    let answers = |app: &App, ground: &Terrain| {
        for (probe, xz) in probes.iter().zip(places) {
            let probe = app.world().get::<GroundProbe>(*probe).expect("a probe");
            let drawn = probe.drawn.expect("an answer");
            let truth = ground.height(xz);
            let off = (drawn.sample.height - truth).abs();
            assert!(off <= drawn.bound + 1e-4, "{xz}: {off} > {}", drawn.bound);
            assert_eq!(probe.sample.expect("the true one").height, truth);
        }
    };
    settle(&mut app);
    while app.world().get::<TerrainRelief>(entity).is_none() {
        app::frames(&mut app, 1);
    }
    settle(&mut app);
    answers(&app, &ground);
    let before = app::picture(&mut app, &target).data.expect("pixels");
    assert_eq!(words(&app), 0, "nothing is edited");
    let rested = app.world().resource::<GeometryStats>().dispatches;
    assert_eq!(rested, 0, "the view rests");

    let mut now = ground.clone();
    for k in 0..3 {
        let place = DVec2::new(4.0 * f64::from(k), 0.0);
        let made = edits.apply(&now, &brush(EditKind::Lower, place, 5.0));
        now = made.expect("valid").terrain;
        app.world_mut().entity_mut(entity).insert(now.clone());
        settle(&mut app);
        answers(&app, &now);
    }
    // The first edit lays the buffer out with what it holds; the next ones write what differs.
    let written = words(&app);
    assert!(
        written > 0 && written < 2 * 9 * (1225 + 12) + 2 * 12 * 40,
        "{written}"
    );
    let edited = app::picture(&mut app, &target).data.expect("pixels");
    assert_ne!(before, edited, "a crater is seen");
    while let Some(undone) = edits.undo(&now) {
        now = undone;
    }
    app.world_mut().entity_mut(entity).insert(now.clone());
    settle(&mut app);
    answers(&app, &ground);
    let after = picture_like(&mut app, &target, &before);
    let others = before.chunks_exact(4).zip(after.chunks_exact(4));
    let others = others.filter(|(one, other)| one != other);
    let most = others
        .clone()
        .flat_map(|(one, other)| one.iter().zip(other).map(|(a, b)| a.abs_diff(*b)))
        .max();
    assert!(
        before == after,
        "{} pixels are others, by up to {most:?} of 255",
        others.count()
    );
    let written = words(&app) - written;
    assert!(written < 2 * 9 * (1225 + 12) + 2 * 12 * 40, "{written}");
    assert_eq!(
        UVec2::new(160, 120).element_product() * 4,
        before.len() as u32
    );
}

/// Hills that have a layer of edits from the beginning, and their history; seen from above them.
struct Edited {
    seen: Seen,
    edits: TerrainEdits,
    terrain: Terrain,
}

impl Edited {
    /// `blocks` are made in a frame.
    fn new(blocks: u32) -> Option<Self> {
        let ground = hills();
        let edits = TerrainEdits::new(&ground).expect("fits");
        let terrain = ground.with_edits(Some(Edits::none(*edits.lattice())));
        let eye = Vec3::new(0.0, terrain.height(DVec2::ZERO) as f32 + 15.0, 0.0);
        let place =
            Transform::from_translation(eye).looking_to(Vec3::new(0.0, -0.4, -1.0), Vec3::Y);
        Some(Self {
            seen: Seen::new(&terrain, place, Some(blocks))?,
            edits,
            terrain,
        })
    }

    fn held(&self) -> f32 {
        let progress = self.seen.app.world().resource::<GroundProgress>();
        let ground = progress.of(self.seen.camera).expect("ground");
        ground.held.expect("counted")
    }

    fn stroke(&mut self, stroke: &Edit) {
        let made = self.edits.apply(&self.terrain, stroke).expect("valid");
        self.set(made.terrain);
    }

    fn set(&mut self, terrain: Terrain) {
        self.terrain = terrain.clone();
        let entity = self.seen.terrain;
        let world = self.seen.app.world_mut();
        world.entity_mut(entity).insert(terrain);
    }
}

/// A still view dispatches nothing; a stroke is taken over in one frame, and some frames later nothing is dispatched again.
#[test]
fn gpu_a_stroke_on_blocks_is_taken_over_once() {
    let Some(mut edited) = Edited::new(24) else {
        return;
    };
    settle(&mut edited.seen.app);
    for ahead in [20.0, 60.0] {
        assert_eq!(edited.held(), PIXELS);
        for _ in 0..6 {
            app::frames(&mut edited.seen.app, 1);
            assert_eq!(edited.seen.dispatches(), 0, "the view rests");
        }
        edited.stroke(&brush(EditKind::Raise, DVec2::new(3.0, -ahead), 3.0));
        let mut dispatches = Vec::new();
        for _ in 0..60 {
            app::frames(&mut edited.seen.app, 1);
            dispatches.push(edited.seen.dispatches());
            if dispatches.ends_with(&[0; 6]) && dispatches.len() > 6 {
                break;
            }
        }
        println!("{dispatches:?}");
        // Twenty levels at most, and 32 rounds more, of five; a choice has no more than 13, and nothing is asked here.
        let most = 5 * 52 + 2 + 13;
        assert!(
            dispatches.iter().all(|&count| count <= most),
            "{dispatches:?}"
        );
        let edits = dispatches.iter().filter(|&&count| count > 13).count();
        assert_eq!(edits, 1, "{dispatches:?}");
        assert!(dispatches.ends_with(&[0; 6]), "{dispatches:?}");
    }
}

/// A stroke in every frame: the bound is never raised for what is made anew, and every answer is of the ground of its frame,
/// within its own bound. Undone in as many frames, it is the ground before.
#[test]
fn gpu_triangles_of_blocks_are_those_of_the_ground_of_their_frame() {
    let Some(mut edited) = Edited::new(u32::MAX) else {
        return;
    };
    let places: Vec<DVec2> = (0..48_u8)
        .map(|k| {
            DVec2::new(
                f64::from(k % 6) * 5.3 - 13.0,
                -12.0 - 9.7 * f64::from(k / 6),
            )
        })
        .collect();
    let probes: Vec<Entity> = places
        .iter()
        .map(|xz| {
            let at = Transform::from_xyz(xz.x as f32, 0.0, xz.y as f32);
            edited
                .seen
                .app
                .world_mut()
                .spawn((GroundProbe::default(), at))
                .id()
        })
        .collect();
    settle(&mut edited.seen.app);
    let mut grounds: HashMap<u32, Terrain> = HashMap::new();
    let (mut looked, mut changed, mut most) = (0, 0, 0.0_f64);
    for k in 0..40_u32 {
        if k < 16 {
            let place = DVec2::new(f64::from(k % 4) * 6.0 - 9.0, -15.0 - 4.0 * f64::from(k));
            let kind = [EditKind::Raise, EditKind::Lower][k as usize / 2 % 2].clone();
            edited.stroke(&brush(kind, place, 2.5));
        } else if let Some(undone) = edited.edits.undo(&edited.terrain) {
            edited.set(undone);
        }
        app::frames(&mut edited.seen.app, 1);
        assert!(
            edited.held() <= PIXELS * 1.001,
            "frame {k}: {}",
            edited.held()
        );
        let now = edited.seen.app.world().resource::<ProbeBatch>().frame();
        grounds.insert(now, edited.terrain.clone());
        for (probe, &xz) in probes.iter().zip(&places) {
            let probe = edited
                .seen
                .app
                .world()
                .get::<GroundProbe>(*probe)
                .expect("there");
            let Some(drawn) = probe.drawn else { continue };
            // Those from before the first stroke are of ground that nobody had edited.
            let Some(ground) = grounds.get(&drawn.frame) else {
                continue;
            };
            let truth = ground.height(xz);
            let off = (drawn.sample.height - truth).abs();
            assert!(
                off <= drawn.bound + 1e-4,
                "frame {k} {xz}: {off} > {}",
                drawn.bound
            );
            looked += 1;
            changed += u32::from((truth - edited.terrain.height(xz)).abs() > 0.5);
            most = most.max(off);
        }
    }
    println!("{looked} answers, {changed} of ground that is another by now, up to {most:.3} m off");
    assert!(looked > 500 && changed > 20, "{looked} {changed}");
}
