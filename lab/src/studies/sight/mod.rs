//! Study `sight`: soldiers of two sides among blocks, who walk and turn: who sees whom, beside a ray for each pair.

use std::sync::Arc;

use bevy::ecs::entity::Entity;
use bevy::math::{Quat, Vec3, ops};
use bevy::transform::components::Transform;
use dolomite_logic::random::Random;
use dolomite_logic::rays::{BoxRays, Rays};
use dolomite_logic::senses::{Sight, SightCounters, SightSettings, Visible, in_field};
use dolomite_logic::{RayWorld, Team};
use dolomite_testkit::cores::on_all_cores;
use dolomite_testkit::metrics::median;
use serde_json::json;

use super::agents::asked;
use super::agents::stepping::{RATE, app, cores_ms};
use crate::study::{Asked, Options, Report, Study};

/// As the command line knows it.
pub const STUDY: Study = Study {
    name: "sight",
    about: "soldiers of two sides see each other: agreement with all rays, rays cast, delay, ms a tick",
    run,
    asked: &ASKED,
};

const ASKED: [Asked; 8] = [
    asked("Soldiers of two sides", "10 000", "/soldiers", ""),
    asked(
        "A tick, on all cores together, median",
        "≤ 8",
        "/tick_core_ms",
        "ms",
    ),
    asked("A tick, wall, least", "≤ 4", "/tick_ms", "ms"),
    asked(
        "Pairs of enemies that agree with all rays",
        "≥ 99.9",
        "/agree_percent",
        "%",
    ),
    asked(
        "The same of the pairs in range and field",
        "",
        "/agree_in_reach_percent",
        "%",
    ),
    asked(
        "Rays of a tick, at most, over all pairs",
        "≤ 1",
        "/rays_percent",
        "%",
    ),
    asked(
        "From in view to seen, longest",
        "≤ 100",
        "/delay_max_ms",
        "ms",
    ),
    asked("From in view to seen, mean", "", "/delay_mean_ms", "ms"),
];

/// Half of the side of the field, metres, of 10 000; as dense for other numbers.
fn half(count: usize) -> f32 {
    500.0 * (count as f32 / 1e4).sqrt()
}

struct Soldier {
    entity: Entity,
    speed: Vec3,
    turn: f32,
}

/// Where a soldier is, looks, and of which side.
struct Stand {
    entity: Entity,
    place: Vec3,
    forward: Vec3,
    team: u8,
}

fn run(options: &Options) -> Report {
    let count = options.agents.clamp(2, 100_000);
    let count = if options.agents == Options::default().agents {
        10_000
    } else {
        count
    };
    let half = half(count);
    let mut random = Random::new(u64::from(options.seed) + 4);
    let blocks: Vec<[Vec3; 2]> = (0..count * 8 / 100)
        .map(|_| {
            let low = Vec3::new(random.signed(half), 0.0, random.signed(half));
            let size = Vec3::new(
                5.0 + random.unit() * 20.0,
                3.0 + random.unit() * 9.0,
                5.0 + random.unit() * 20.0,
            );
            [low, low + size]
        })
        .collect();
    let rays = Arc::new(BoxRays::new(blocks, 10.0));
    let mut app = app();
    app.insert_resource(RayWorld(Arc::clone(&rays) as Arc<dyn Rays>));
    let soldiers: Vec<Soldier> = (0..count)
        .map(|number| {
            let at = Vec3::new(random.signed(half), 0.9, random.signed(half));
            let yaw = random.signed(std::f32::consts::PI);
            let place = Transform::from_translation(at).with_rotation(Quat::from_rotation_y(yaw));
            let parts = (
                Sight::default(),
                Visible::default(),
                Team((number % 2) as u8),
                place,
            );
            Soldier {
                entity: app.world_mut().spawn(parts).id(),
                speed: Vec3::new(random.signed(1.5), 0.0, random.signed(1.5)),
                turn: random.signed(0.2),
            }
        })
        .collect();
    let (mut wall, mut core, mut most_rays) = (Vec::new(), Vec::new(), 0);
    let ticks = options.count.unwrap_or(96).max(24);
    for tick in 0..ticks {
        for soldier in &soldiers {
            if let Some(mut place) = app.world_mut().get_mut::<Transform>(soldier.entity) {
                place.translation += soldier.speed / RATE as f32;
                place.rotation *= Quat::from_rotation_y(soldier.turn / RATE as f32);
            }
        }
        let (ms, on_cores) = cores_ms(&mut app);
        // Until everybody has looked twice nothing is known of what hides whom.
        if tick >= 12 {
            wall.push(ms);
            core.push(on_cores);
        }
        most_rays = most_rays.max(app.world().resource::<SightCounters>().rays);
    }
    let all: Vec<Stand> = soldiers
        .iter()
        .filter_map(|soldier| {
            let at = app.world().get::<Transform>(soldier.entity)?;
            Some(Stand {
                entity: soldier.entity,
                place: at.translation,
                forward: at.rotation * Vec3::NEG_Z,
                team: app.world().get::<Team>(soldier.entity)?.0,
            })
        })
        .collect();
    let seen: Vec<Vec<Entity>> = all
        .iter()
        .map(|stand| {
            let sight = app.world().get::<Sight>(stand.entity);
            sight
                .map(|sight| sight.seen().collect())
                .unwrap_or_default()
        })
        .collect();
    let cos = ops::cos(std::f32::consts::FRAC_PI_3);
    let numbers: Vec<usize> = (0..all.len()).collect();
    // Pairs in reach, pairs that see each other, pairs that are told wrong.
    let judged = on_all_cores(&numbers, |&number| {
        let stand = &all[number];
        let eye = stand.place + Vec3::Y * 0.7;
        let mut judged = [0_u64; 3];
        for other in all.iter().filter(|other| other.team != stand.team) {
            let reach = in_field(eye, stand.forward, 60.0, cos, other.place);
            let truth = reach && rays.cast(eye, other.place).is_none();
            let ours = seen[number].binary_search(&other.entity).is_ok();
            judged[0] += u64::from(reach);
            judged[1] += u64::from(truth);
            judged[2] += u64::from(truth != ours);
        }
        judged
    });
    let [reach, truly, wrong] = judged
        .iter()
        .fold([0; 3], |sum, one| std::array::from_fn(|k| sum[k] + one[k]));
    let pairs = count as f64 * count as f64 / 2.0;
    let delays = delays(u64::from(options.seed));
    let least = wall.iter().copied().reduce(f64::min);
    Report {
        study: STUDY.name,
        rows: Vec::new(),
        figures: Vec::new(),
        notes: vec![
            "A tick has all that an app does beside it. Two cores for 4 ms are 8 ms of them. What is told wrong is so \
             by age: each looks in every sixth tick."
                .to_owned(),
        ],
        summary: json!({
            "soldiers": count, "ticks": ticks,
            "tick_ms": least, "tick_core_ms": median(core),
            "pairs": pairs, "pairs_in_reach": reach, "pairs_seen": truly, "pairs_wrong": wrong,
            "agree_percent": 100.0 * (1.0 - wrong as f64 / pairs),
            "agree_in_reach_percent": 100.0 * (1.0 - wrong as f64 / reach.max(1) as f64),
            "rays_of_a_tick_max": most_rays,
            "rays_percent": 100.0 * f64::from(most_rays) / pairs,
            "delay_max_ms": delays.iter().copied().fold(0.0, f64::max),
            "delay_mean_ms": delays.iter().sum::<f64>() / delays.len().max(1) as f64,
        }),
    }
}

/// From the tick in which somebody comes out from behind a wall to that in which they are seen, milliseconds, of 200
/// guards who look in turn.
fn delays(seed: u64) -> Vec<f64> {
    let mut app = app();
    let mut random = Random::new(seed);
    let wall = [
        Vec3::new(-2000.0, 0.0, -11.0),
        Vec3::new(2000.0, 5.0, -10.0),
    ];
    app.insert_resource(RayWorld(Arc::new(BoxRays::new([wall], 8.0))));
    let pairs: Vec<(Entity, Entity)> = (0..200)
        .map(|number| {
            let x = (number as f32 - 100.0) * 150.0 / 10.0;
            let guard = (
                Sight::new(60.0, 1.0),
                Team(1),
                Transform::from_xyz(x, 0.9, 0.0),
            );
            let enemy = (
                Visible::default(),
                Team(2),
                Transform::from_xyz(x, 0.9, -20.0),
            );
            (
                app.world_mut().spawn(guard).id(),
                app.world_mut().spawn(enemy).id(),
            )
        })
        .collect();
    for _ in 0..2 * SightSettings::default().every {
        app.update();
    }
    let mut delays = Vec::new();
    for (guard, enemy) in pairs {
        for _ in 0..(random.unit() * 7.0) as u32 {
            app.update();
        }
        if let Some(mut place) = app.world_mut().get_mut::<Transform>(enemy) {
            place.translation.z = -8.0;
        }
        for tick in 1..=64_u32 {
            app.update();
            let sees = app
                .world()
                .get::<Sight>(guard)
                .is_some_and(|sight| sight.sees(enemy));
            if sees || tick == 64 {
                delays.push(f64::from(tick) * 1e3 / f64::from(RATE));
                break;
            }
        }
        app.world_mut().despawn(enemy);
    }
    delays
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sight_agrees_with_all_rays() {
        let options = Options {
            agents: 800,
            count: Some(24),
            ..Options::default()
        };
        let summary = run(&options).summary;
        assert_eq!(summary["soldiers"], 800);
        assert!(summary["agree_percent"].as_f64() > Some(99.9), "{summary}");
        assert!(
            summary["agree_in_reach_percent"].as_f64() > Some(95.0),
            "{summary}"
        );
        assert!(summary["pairs_seen"].as_u64() > Some(1000), "{summary}");
        assert!(summary["delay_max_ms"].as_f64() <= Some(100.0), "{summary}");
        assert!(summary["delay_mean_ms"].as_f64() > Some(20.0), "{summary}");
    }
}
