//! Shadow maps that are not drawn again while nothing moves: the picture is that of maps that are, and faces are counted.

use std::time::Instant;

use bevy::light::PointLightShadowMap;
use bevy::prelude::*;
use dolomite_deferred::{DeferredLighting, DeferredPlugin, StillShadows, StillStats};
use dolomite_testkit::cores::processor_time;
use dolomite_testkit::light::{self as support, Picture};
use dolomite_testkit::random::Random;

struct Stage {
    app: App,
    camera: Entity,
    lamps: Vec<Entity>,
    bodies: Vec<Entity>,
    cube: Handle<Mesh>,
    material: Handle<StandardMaterial>,
}

/// A floor, bodies, and lamps that cast shadows between them.
fn stage(lamps: usize, bodies: usize, texels: usize) -> Option<Stage> {
    let mut app = support::app_with(|app| {
        app.add_plugins(DeferredPlugin);
    })?;
    app.insert_resource(PointLightShadowMap { size: texels });
    let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
    let floor = meshes.add(Plane3d::default().mesh().size(30.0, 30.0));
    let cube = meshes.add(Cuboid::from_length(0.6));
    let mut materials = app.world_mut().resource_mut::<Assets<StandardMaterial>>();
    let material = materials.add(StandardMaterial::default());
    app.world_mut()
        .spawn((Mesh3d(floor), MeshMaterial3d(material.clone())));
    let mut random = Random::new(5);
    let mut place =
        |height: f32| Vec3::new(random.range(-6.0, 6.0), height, random.range(-6.0, 6.0));
    let bodies = (0..bodies)
        .map(|_| {
            let at = Transform::from_translation(place(0.5));
            let body = (Mesh3d(cube.clone()), MeshMaterial3d(material.clone()), at);
            app.world_mut().spawn(body).id()
        })
        .collect();
    let lamps = (0..lamps)
        .map(|_| {
            let lamp = PointLight {
                intensity: 800.0,
                range: 5.0,
                shadow_maps_enabled: true,
                ..default()
            };
            let at = Transform::from_translation(place(1.6));
            app.world_mut().spawn((lamp, at)).id()
        })
        .collect();
    let eye = Transform::from_xyz(0.0, 9.0, 10.0).looking_at(Vec3::ZERO, Vec3::Y);
    let camera = support::camera(&mut app, [96, 54], eye, DeferredLighting::default());
    Some(Stage {
        app,
        camera,
        lamps,
        bodies,
        cube,
        material,
    })
}

impl Stage {
    fn still(&mut self, on: bool) {
        for lamp in &self.lamps {
            let mut lamp = self.app.world_mut().entity_mut(*lamp);
            if on {
                lamp.insert(StillShadows::default());
            } else {
                lamp.remove::<StillShadows>();
            }
        }
    }

    /// Faces that were drawn and kept in the last frame.
    fn faces(&self) -> (u32, u32) {
        let stats = self.app.world().resource::<StillStats>();
        (stats.drawn(), stats.kept())
    }

    fn picture(&mut self) -> Picture {
        support::picture(&mut self.app, self.camera, 6)
    }

    /// The picture with maps that are kept, which is that of maps that are all drawn.
    fn same(&mut self, what: &str) -> Picture {
        let kept = self.picture();
        let (drawn, still) = self.faces();
        assert_eq!((drawn, still), (0, 6 * self.lamps.len() as u32), "{what}");
        self.still(false);
        let all = self.picture();
        support::keep(&kept, 4.0, &format!("still-{what}"));
        let apart = kept.relative_difference(&all, 1e-4);
        assert!(apart <= 1e-5, "{what}: {apart}");
        self.still(true);
        support::frames(&mut self.app, 6);
        kept
    }
}

#[test]
fn maps_are_kept_while_nothing_moves_and_the_picture_is_the_same_gpu() {
    let Some(mut stage) = stage(3, 6, 128) else {
        return;
    };
    let lamps = stage.lamps.clone();
    support::frames(&mut stage.app, 4);
    stage.still(true);
    support::frames(&mut stage.app, 1);
    assert_eq!(stage.faces(), (18, 0), "first all are drawn");
    let before = stage.same("at-rest");
    // A body that moves is seen by some faces.
    let body = stage.bodies[0];
    let moved = Transform::from_xyz(1.0, 0.9, 1.5);
    stage.app.world_mut().entity_mut(body).insert(moved);
    support::frames(&mut stage.app, 1);
    let (drawn, kept) = stage.faces();
    assert!(
        drawn > 0 && kept > 0 && drawn + kept == 18,
        "{drawn} {kept}"
    );
    let after = stage.same("moved");
    assert!(after.relative_difference(&before, 1e-4) > 0.1);
    // One that is taken away, one that is hidden, one that is new.
    stage.app.world_mut().despawn(stage.bodies[1]);
    stage
        .app
        .world_mut()
        .entity_mut(stage.bodies[2])
        .insert(Visibility::Hidden);
    stage.same("gone");
    let (cube, material) = (stage.cube.clone(), stage.material.clone());
    let new = (
        Mesh3d(cube),
        MeshMaterial3d(material),
        Transform::from_xyz(-1.0, 0.7, 0.5),
    );
    stage.app.world_mut().spawn(new);
    stage.same("new");
    // A lamp that moves is drawn, the others are not.
    stage
        .app
        .world_mut()
        .entity_mut(lamps[0])
        .insert(Transform::from_xyz(0.3, 2.0, 0.1));
    support::frames(&mut stage.app, 1);
    assert_eq!(stage.faces(), (6, 12));
    stage.same("lamp");
    // Its brightness is none of its map.
    stage
        .app
        .world_mut()
        .get_mut::<PointLight>(lamps[1])
        .expect("a lamp")
        .intensity *= 2.0;
    support::frames(&mut stage.app, 2);
    assert_eq!(stage.faces(), (0, 18));
    // What asks for it is drawn.
    stage
        .app
        .world_mut()
        .entity_mut(lamps[2])
        .insert(StillShadows { redraw: 1 });
    support::frames(&mut stage.app, 1);
    assert_eq!(stage.faces(), (6, 12));
    // Another lamp makes another texture, and other places in it.
    let lamp = PointLight {
        range: 5.0,
        shadow_maps_enabled: true,
        ..default()
    };
    let lamp = (
        lamp,
        Transform::from_xyz(2.0, 1.5, -1.0),
        StillShadows::default(),
    );
    let lamp = stage.app.world_mut().spawn(lamp).id();
    stage.lamps.push(lamp);
    stage.same("one-more");
    // A lamp that was out of sight finds its place taken.
    stage
        .app
        .world_mut()
        .entity_mut(lamps[0])
        .insert(Visibility::Hidden);
    support::frames(&mut stage.app, 4);
    stage
        .app
        .world_mut()
        .entity_mut(lamps[0])
        .insert(Visibility::Inherited);
    stage.same("back");
}

/// Whatever of it changes: it may be its alpha mask.
#[test]
fn a_material_that_changes_is_drawn_anew_gpu() {
    let Some(mut stage) = stage(1, 3, 32) else {
        return;
    };
    stage.still(true);
    support::frames(&mut stage.app, 10);
    assert_eq!(stage.faces(), (0, 6));
    for k in 0..8 {
        let mut materials = stage
            .app
            .world_mut()
            .resource_mut::<Assets<StandardMaterial>>();
        let mut material = materials.get_mut(&stage.material).expect("it is there");
        material.emissive = LinearRgba::gray(0.1 * k as f32);
        drop(material);
        support::frames(&mut stage.app, 1);
        // It is told of the material, marks meshes of it, and we look for those: in one frame or in three.
        assert!(stage.faces().0 > 0 || k < 3, "{k}");
    }
    support::frames(&mut stage.app, 10);
    assert_eq!(stage.faces(), (0, 6));
}

/// Milliseconds of the processor a frame.
fn time(stage: &mut Stage) -> f64 {
    support::frames(&mut stage.app, 8);
    let start = Instant::now();
    let before = processor_time(start);
    support::frames(&mut stage.app, 4);
    (processor_time(start) - before).as_secs_f64() * 1e3 / 4.0
}

#[test]
#[ignore = "measures"]
fn what_64_still_lamps_cost() {
    let Some(mut stage) = stage(64, 500, 64) else {
        return;
    };
    let mut taken = [(); 3].map(|()| Vec::new());
    for _ in 0..3 {
        for (k, taken) in taken.iter_mut().enumerate() {
            stage.still(k == 2);
            for lamp in stage.lamps.clone() {
                let mut lamp = stage
                    .app
                    .world_mut()
                    .get_mut::<PointLight>(lamp)
                    .expect("a lamp");
                lamp.shadow_maps_enabled = k > 0;
            }
            taken.push(time(&mut stage));
        }
    }
    let [none, bevys, still] = taken.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times[1]
    });
    eprintln!(
        "a frame without shadows {none:.1} ms, with Bevy's {bevys:.1} ms, still {still:.1} ms: {:.3} of what Bevy's add; {:?}",
        (still - none) / (bevys - none),
        stage.faces()
    );
}
