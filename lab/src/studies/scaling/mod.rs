//! Study `scaling`: N objects and L lights. Does a frame's time grow with their sum, or with their product?
//!
//! Objects share the picture: the more there are, the smaller each is, so that pixels stay as many. So do lights: their
//! reach shrinks so that each place has as many. The model `t = a + bN + cL + dNL` is fitted by least squares to the
//! medians; what is asked for is that its last term is small at every point.

mod fit;

use bevy::prelude::*;
use dolomite_deferred::{DeferredPlugin, Way};
use dolomite_testkit::light::{self, UnlitPlugin};
use dolomite_testkit::random::Random;
use serde_json::{Value, json};

use crate::csv::Row;
use crate::plot::{Axes, Chart, Curve};
use crate::studies::light::way::{Lit, turns};
use crate::study::{Asked, Figure, Options, Report, Study};
use fit::{Fit, Point};

/// As the command line knows it.
pub const STUDY: Study = Study {
    name: "scaling",
    about: "N objects and L lights: a fit of the frame's time, by Dolomite's lighting and by Bevy's",
    run,
    asked: &ASKED,
};

/// What its measured table says.
const ASKED: [Asked; 3] = [
    Asked {
        what: "Term of N objects times L lights in the fit of Dolomite's frames: largest share of the time",
        asked: "≤ 0.02",
        at: "/auto/product_share",
        unit: "",
    },
    Asked {
        what: "The same of Bevy's frames",
        asked: "",
        at: "/bevy/product_share",
        unit: "",
    },
    Asked {
        what: "R² of the fit of Dolomite's frames",
        asked: "",
        at: "/auto/r_squared",
        unit: "",
    },
];

/// Objects.
const OBJECTS: [u32; 3] = [64, 512, 4096];
/// Lights.
const LIGHTS: [u32; 4] = [0, 64, 512, 2048];
/// Whose frames are timed.
const LITS: [Lit; 2] = [Lit::Ours(Way::Auto), Lit::Bevy];

/// Half of the side of the square that all stand on, metres.
const HALF: f32 = 20.0;

fn run(options: &Options) -> Report {
    let mut report = Report {
        study: STUDY.name,
        rows: Vec::new(),
        figures: Vec::new(),
        notes: Vec::new(),
        summary: Value::Null,
    };
    let app = light::app_with(|app| {
        app.add_plugins((DeferredPlugin, UnlitPlugin));
    });
    match app {
        Some(mut app) => measure(&mut app, options, &mut report),
        None => report
            .notes
            .push("no Vulkan device: nothing was measured".into()),
    }
    report
}

/// What stands in the scene.
#[derive(Default)]
struct Standing {
    objects: Vec<Entity>,
    lights: Vec<Entity>,
}

fn despawn(app: &mut App, all: &mut Vec<Entity>) {
    for entity in all.drain(..) {
        app.world_mut().despawn(entity);
    }
}

/// So many cubes on a floor that is drawn anyway.
fn put_objects(app: &mut App, standing: &mut Standing, count: u32, assets: &Assets3) {
    despawn(app, &mut standing.objects);
    let mut random = Random::new(count);
    // A quarter of the floor is built on.
    let side = HALF / (count as f32).sqrt();
    for _ in 0..count {
        let place = Vec3::new(
            random.range(-HALF, HALF),
            0.5 * side,
            random.range(-HALF, HALF),
        );
        let object = (
            Mesh3d(assets.cube.clone()),
            MeshMaterial3d(assets.material.clone()),
            Transform::from_translation(place).with_scale(Vec3::splat(side)),
        );
        standing.objects.push(app.world_mut().spawn(object).id());
    }
}

/// So many lamps; some six reach each place.
fn put_lights(app: &mut App, standing: &mut Standing, count: u32) {
    despawn(app, &mut standing.lights);
    let mut random = Random::new(count + 1);
    let range = (6.0 * 4.0 * HALF * HALF / (std::f32::consts::PI * count.max(1) as f32)).sqrt();
    for _ in 0..count {
        let place = Vec3::new(
            random.range(-HALF, HALF),
            0.2 * range,
            random.range(-HALF, HALF),
        );
        let lamp = PointLight {
            intensity: 40.0 * range * range,
            range,
            ..default()
        };
        let lamp = (lamp, Transform::from_translation(place));
        standing.lights.push(app.world_mut().spawn(lamp).id());
    }
}

/// What all objects share.
struct Assets3 {
    cube: Handle<Mesh>,
    material: Handle<StandardMaterial>,
}

fn measure(app: &mut App, options: &Options, report: &mut Report) {
    let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
    let cube = meshes.add(Cuboid::from_length(1.0));
    let floor = meshes.add(Plane3d::default().mesh().size(2.0 * HALF, 2.0 * HALF));
    let mut materials = app.world_mut().resource_mut::<Assets<StandardMaterial>>();
    let material = materials.add(StandardMaterial::default());
    let assets = Assets3 { cube, material };
    app.world_mut()
        .spawn((Mesh3d(floor), MeshMaterial3d(assets.material.clone())));
    let eye = Transform::from_xyz(0.0, 14.0, 24.0).looking_at(Vec3::ZERO, Vec3::Y);
    let camera = light::camera(app, options.size, eye, ());
    let mut standing = Standing::default();
    let mut points: [Vec<Point>; LITS.len()] = Default::default();
    let most = options.count.and_then(|most| most.try_into().ok());
    let most: u32 = most.unwrap_or(u32::MAX);
    for objects in OBJECTS.into_iter().filter(|count| *count <= most) {
        put_objects(app, &mut standing, objects, &assets);
        for lights in LIGHTS.into_iter().filter(|count| *count <= most) {
            put_lights(app, &mut standing, lights);
            let times = turns(app, camera, &LITS, options.repeats);
            eprintln!("{objects} objects, {lights} lights: {times:.1?} ms");
            for (points, ms) in points.iter_mut().zip(times) {
                points.push(Point {
                    objects,
                    lights,
                    ms,
                });
            }
        }
    }
    let mut summary = serde_json::Map::new();
    summary.insert("size".into(), json!(options.size));
    let mut curves = Vec::new();
    for ((colour, lit), points) in LITS.iter().enumerate().zip(&points) {
        report
            .rows
            .extend(points.iter().map(|point| row(*lit, *point)));
        let of_most = points.iter().filter(|point| point.objects == OBJECTS[1]);
        curves.push(Curve {
            name: lit.name().into(),
            colour,
            points: of_most
                .map(|p| (f64::from(p.lights.max(1)), p.ms))
                .collect(),
        });
        match Fit::of(points) {
            Some(fit) => {
                summary.insert(lit.name().into(), fit.json(points));
            }
            None => report.notes.push(format!("{}: no fit", lit.name())),
        }
    }
    report.figures.push(Figure {
        name: "scaling_lights".into(),
        caption: format!(
            "Time of a frame of {} objects over lights in view; without lights at 1",
            OBJECTS[1]
        ),
        chart: Chart {
            title: "Lights of small reach".into(),
            x_label: "lights".into(),
            y_label: "ms".into(),
            axes: Axes::Logarithmic,
            curves,
        },
    });
    report.notes.push(
        "times are of whole frames, the adapter waited for; Bevy's clustering runs in both".into(),
    );
    report.summary = Value::Object(summary);
}

fn row(lit: Lit, point: Point) -> Row {
    Row {
        sweep: format!("{} lights", point.lights),
        method: lit.name().into(),
        parameter: format!("{} objects", point.objects),
        parameter_value: f64::from(point.objects),
        quantity: "time of a frame, median".into(),
        error: None,
        error_unit: String::new(),
        time_ns: Some(point.ms * 1e6),
        bytes: None,
        vertices: None,
        hash: None,
        device: String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_run_has_a_fit_of_both() {
        let options = Options {
            size: [32, 18],
            count: Some(512),
            repeats: 1,
            ..Options::default()
        };
        let report = run(&options);
        if report.summary.is_null() {
            assert!(std::env::var_os("CI").is_none(), "{:?}", report.notes);
            return;
        }
        for asked in &ASKED {
            let number = report.summary.pointer(asked.at);
            assert!(number.is_some_and(Value::is_number), "{}", asked.at);
        }
        // Two numbers of objects, three of lights, two renderers.
        assert_eq!(report.rows.len(), 12);
        assert!(
            report
                .rows
                .iter()
                .all(|row| row.time_ns.is_some_and(|ns| ns > 0.0))
        );
    }
}
