//! What a light costs, and why: the tiled way with a part of its design taken back, beside Bevy's pass in the same
//! run. On llvmpipe both sides of a branch run for all lanes, so what is not compiled, or not in the loop over lights, is
//! what counts.

use std::time::Instant;

use bevy::prelude::*;
use dolomite_deferred::{BlinnPhongPlugin, DeferredLighting, DeferredPlugin, Way};
use dolomite_light_oracle::{Recipe, generate};
use dolomite_testkit::cores::processor_time;
use dolomite_testkit::light::{self as support, Unlit, UnlitPlugin};

use super::mistakes::put;

/// A name, and texts of files with what stands in their place.
type Change = (
    &'static str,
    &'static [(&'static str, &'static str, &'static str)],
);

const CHANGES: &[Change] = &[
    ("as it is", &[]),
    (
        "every listed light is shaded",
        &[
            (
                "local",
                "let offset = (lights[index].position",
                "if range_of(index) > 0.0 { return true; }\n    let offset = (lights[index].position",
            ),
            (
                "local",
                "// Whether a light may add anything.",
                "fn range_of(index: u32) -> f32 { return lights[index].range; }",
            ),
        ],
    ),
    (
        "lights behind the surface are shaded",
        &[(
            "reach",
            "return dot(offset, normal) >",
            "return true || dot(offset, normal) >",
        )],
    ),
    (
        "lights are shaded out of their cones",
        &[(
            "reach",
            "return -dot(direction, offset) >=",
            "return true || -dot(direction, offset) >=",
        )],
    ),
    (
        "shadows of lights that cast none are looked up",
        &[
            (
                "light",
                "#ifdef CASTERS\n#import",
                "#ifndef CASTERS\n#import",
            ),
            (
                "light",
                "sum += open_light(index, surface);",
                "sum += shadowed_light(index, surface, pixels);",
            ),
            ("local", "#ifdef CASTERS", "#ifndef CASTERS"),
        ],
    ),
    (
        "tiles without slices",
        &[(
            "tiles",
            "depth > 1e-3 * abs(result.far) && depth < 1e12",
            "false",
        )],
    ),
];

fn time(app: &mut App, camera: Entity, way: Option<Way>, unlit: bool, count: usize) -> f64 {
    app.insert_resource(Unlit(unlit));
    let mut entity = app.world_mut().entity_mut(camera);
    match way {
        Some(way) => entity.insert(DeferredLighting { way }),
        None => entity.remove::<DeferredLighting>(),
    };
    support::frames(app, 3);
    // Of the processor, which is the adapter: what else the machine does then counts little.
    let start = Instant::now();
    let before = processor_time(start);
    support::frames(app, count);
    (processor_time(start) - before).as_secs_f64() * 1e3 / count as f64
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

#[test]
#[ignore = "measures"]
fn what_a_light_costs() {
    let app = support::app_with(|app| {
        app.add_plugins((DeferredPlugin, BlinnPhongPlugin, UnlitPlugin));
    });
    let Some(mut app) = app else { return };
    let only = std::env::var("DOLOMITE_CHANGE").unwrap_or_default();
    let counts = std::env::var("DOLOMITE_LIGHTS").unwrap_or_else(|_| "1000,8".into());
    for lights in counts.split(',').map(|n| n.parse().expect("a number")) {
        let recipe = Recipe {
            seed: 2,
            lights,
            width: 160,
            height: 90,
            ..Recipe::default()
        };
        let spawned = support::spawn(&mut app, &generate(&recipe), ());
        // Few lights take little time beside the clock's steps.
        let frames = if lights < 100 { 12 } else { 2 };
        for (name, changes) in CHANGES.iter().filter(|(name, _)| name.contains(&only)) {
            for file in ["local", "reach", "light", "tiles"] {
                let path = format!("deferred/{file}.wgsl");
                let mut text = dolomite_shaders::find(&path).source.to_owned();
                for (of, from, to) in changes.iter().filter(|change| change.0 == file) {
                    assert_eq!(text.matches(from).count(), 1, "{of}: {from}");
                    text = text.replace(from, to);
                }
                put(&mut app, file, &text);
            }
            let mut taken = [(); 4].map(|()| Vec::new());
            for _ in 0..3 {
                let ways = [
                    (Some(Way::Tiled), false),
                    (None, false),
                    (Some(Way::BruteForce), false),
                    (None, true),
                ];
                for ((way, unlit), taken) in ways.into_iter().zip(&mut taken) {
                    taken.push(time(&mut app, spawned.camera, way, unlit, frames));
                }
            }
            let [tiled, bevy, brute, unlit] = taken.map(median);
            eprintln!(
                "{lights} lights, {name}: tiled {:.2}, brute force {:.2} of Bevy's {:.1} ms (frame unlit {unlit:.1} ms)",
                (tiled - unlit) / (bevy - unlit),
                (brute - unlit) / (bevy - unlit),
                bevy - unlit
            );
        }
        for entity in spawned.others.into_iter().chain([spawned.camera]) {
            app.world_mut().despawn(entity);
        }
    }
}
