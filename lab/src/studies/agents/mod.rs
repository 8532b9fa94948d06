//! Study `agents`: a crowd on flow fields that avoids each other: milliseconds a tick by stage, bytes an agent, awake
//! and asleep, and whether anybody leaves the ground that can be walked on.

mod crowd;
pub mod stepping;

use dolomite_logic::Asleep;
use dolomite_logic::movement::{FlowFields, WalkCounters, WalkGround, WalkTimes, Walker};
use dolomite_testkit::metrics::median;
use serde_json::json;

use crate::study::{Asked, Options, Report, Study};
use crowd::{crowd, side};
use stepping::cores_ms;

/// As the command line knows it.
pub const STUDY: Study = Study {
    name: "agents",
    about: "walkers on flow fields with avoidance: ms a tick by stage, bytes, asleep and awake, who leaves the ground",
    run,
    asked: &ASKED,
};

const ASKED: [Asked; 9] = [
    asked(
        "Walkers on a flow field with avoidance",
        "100 000",
        "/agents",
        "",
    ),
    asked(
        "A tick of them, on all cores together, median",
        "≤ 33.2",
        "/tick_core_ms",
        "ms",
    ),
    asked("A tick of them, wall, least", "≤ 16.6", "/tick_ms", "ms"),
    asked("Bytes of a walker", "≤ 200", "/bytes", "B"),
    asked("Minutes of walkers", "1e6", "/agent_minutes", "min"),
    asked(
        "Walkers off walkable ground in them",
        "0",
        "/off_ground",
        "",
    ),
    asked(
        "Pairs nearer than half of their radii, of those that move, mean of a tick",
        "",
        "/overlaps",
        "",
    ),
    asked(
        "Metres nearer to the goal, mean",
        "above 0",
        "/nearer_m",
        "m",
    ),
    asked("Asleep, each", "≤ 5", "/asleep_ns", "ns"),
];

pub(super) const fn asked(
    what: &'static str,
    asked: &'static str,
    at: &'static str,
    unit: &'static str,
) -> Asked {
    Asked {
        what,
        asked,
        at,
        unit,
    }
}

fn run(options: &Options) -> Report {
    let agents = options.agents.max(1);
    let steps = options.count.unwrap_or(640).max(16);
    let mut app = crowd(agents, u64::from(options.seed));
    let grid = app.world().resource::<WalkGround>().0.clone();
    let fields = app.world().resource::<FlowFields>().0.clone();
    let mut query = app.world_mut().query::<&Walker>();
    let mut way = |app: &bevy::app::App| {
        let walkers = query.iter(app.world());
        let ways = walkers.map(|w| f64::from(fields[usize::from(w.field)].distance(w.place)));
        let (mut sum, mut count) = (0.0, 0_usize);
        for way in ways.filter(|way| way.is_finite()) {
            sum += way;
            count += 1;
        }
        sum / count.max(1) as f64
    };
    let before = way(&app);
    let (mut wall, mut core, mut stages) = (Vec::new(), Vec::new(), Vec::new());
    let (mut off_ground, mut looks, mut overlaps) = (0_usize, 0_usize, 0_usize);
    let mut walkers = app.world_mut().query::<&Walker>();
    for step in 0..steps {
        let (ms, on_cores) = cores_ms(&mut app);
        // Before that lists are made.
        if step >= 8 {
            wall.push(ms);
            core.push(on_cores);
            stages.push(*app.world().resource::<WalkTimes>());
        }
        let all = walkers.iter(app.world());
        off_ground += all.filter(|w| !grid.is_open(w.place)).count();
        if step % 64 == 63 {
            looks += 1;
            let all: Vec<Walker> = walkers.iter(app.world()).copied().collect();
            overlaps += crowd::overlaps(&all);
            eprintln!("agents: {} of {steps} ticks", step + 1);
        }
    }
    let counters = *app.world().resource::<WalkCounters>();
    let bytes = size_of::<Walker>() as u64 + counters.bytes / u64::from(counters.walkers.max(1));
    let nearer = before - way(&app);
    let stage =
        |of: fn(&WalkTimes) -> f32| median(stages.iter().map(|t| f64::from(of(t))).collect());
    let by_stage = json!({
        "gather": stage(|t| t.gather), "flow": stage(|t| t.flow), "sort": stage(|t| t.sort),
        "avoid": stage(|t| t.avoid), "go": stage(|t| t.go),
    });
    let entities: Vec<_> = {
        let world = app.world_mut();
        let mut query =
            world.query_filtered::<bevy::ecs::entity::Entity, bevy::ecs::query::With<Walker>>();
        query.iter(world).collect()
    };
    for entity in entities {
        app.world_mut().entity_mut(entity).insert(Asleep);
    }
    app.update();
    app.update();
    let asleep: Vec<f64> = (0..200).map(|_| cores_ms(&mut app).1).collect();
    let asleep_ns = median(asleep).map(|ms| ms * 1e6 / agents as f64);
    let least = wall.iter().copied().reduce(f64::min);
    Report {
        study: STUDY.name,
        rows: Vec::new(),
        figures: Vec::new(),
        notes: vec![
            "Time on all cores together is that of threads on a core, as Linux counts it: what others do on the machine \
             is in it by its caches alone. Two cores for 16.6 ms are 33.2 ms of them. A tick has all that an app does \
             beside it."
                .to_owned(),
            format!("A square of {} m with pillars, a goal in each corner.", side(agents)),
        ],
        summary: json!({
            "agents": agents,
            "ticks": steps,
            "tick_ms": least,
            "tick_core_ms": median(core),
            "stages_wall_ms": by_stage,
            "steered": counters.steered,
            "bytes": bytes,
            "agent_minutes": agents as f64 * steps as f64 / 64.0 / 60.0,
            "off_ground": off_ground,
            "overlaps": overlaps as f64 / looks.max(1) as f64,
            "nearer_m": nearer,
            "asleep_ns": asleep_ns,
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nobody_leaves_the_ground_and_all_come_nearer() {
        let options = Options {
            agents: 2000,
            count: Some(192),
            ..Options::default()
        };
        let summary = run(&options).summary;
        assert_eq!(summary["off_ground"], 0, "{summary}");
        // 3 s at 1.4 m/s are 4.2 m, less what avoidance takes.
        assert!(summary["nearer_m"].as_f64() > Some(2.0), "{summary}");
        assert!(summary["bytes"].as_u64() <= Some(200), "{summary}");
        assert_eq!(summary["agent_minutes"], 100.0);
    }
}
