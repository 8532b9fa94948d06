//! A lift, a button and a guard; no window, no GPU.
//!
//! `cargo run -p dolomite_logic --example logic`

use bevy::MinimalPlugins;
use bevy::app::App;
use bevy::ecs::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy::transform::components::Transform;
use dolomite_logic::senses::{Memory, Sight, Visible};
use dolomite_logic::{
    Action, BehaviourAppExt, Button, Key, LeafBatch, Lift, LogicPlugin, Mind, Output, Phase, Team,
    Wire, Wires,
};
use std::error::Error;

/// A guard that stands until it sees somebody, and then goes after them.
const GUARD: &str = r#"(
    root: "guard",
    trees: {
        "guard": Choose([
            ([Of("alert", Rise(0.0, 0.5))], Do("chase")),
            ([Always(0.2)], Wait(1.0)),
        ]),
    },
)"#;

/// A leaf: everybody who is at it, in one call.
fn chase(InMut(batch): InMut<LeafBatch>, mut places: Query<(&mut Transform, &Memory)>) {
    let way = 2.0 * batch.seconds;
    for (call, _) in batch.iter_mut() {
        if call.phase == Phase::Start {
            println!("The guard has seen somebody.");
        }
        if let Ok((mut transform, memory)) = places.get_mut(call.agent)
            && let Some(trace) = memory.traces().first()
        {
            transform.translation = transform.translation.move_towards(trace.place, way);
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, LogicPlugin));
    // One step an update, for the sake of this example.
    app.insert_resource(TimeUpdateStrategy::FixedTimesteps(1));

    let lift = app.world_mut().spawn(Lift::new(vec![0.0, 4.0])?).id();
    let wires = Wires(vec![Wire::new(Key::PRESSED, lift, Key::CALL)]);
    let button = app.world_mut().spawn((Button::new(1), wires)).id();

    app.add_leaf("chase", chase);
    let guard = app.add_behaviour("guard", GUARD)?;
    let place = Transform::from_xyz(0.0, 4.0, 8.0);
    let parts = (
        Mind::new(guard),
        Sight::default(),
        Memory::default(),
        Team(1),
        place,
    );
    let guard = app.world_mut().spawn(parts).id();
    // Who stands on the lift is seen once it is up.
    let thief = app.world_mut().spawn((Team(2), Transform::default())).id();

    app.world_mut()
        .write_message(Action::new(button, Key::PRESS, ()));
    for step in 0..64 * 8 {
        app.update();
        let messages = app.world().resource::<Messages<Output>>();
        let arrived = messages
            .iter_current_update_messages()
            .any(|o| o.name == Key::ARRIVED);
        let height = app.world().get::<Lift>(lift).map_or(0.0, Lift::height);
        if arrived {
            println!("The lift has arrived.");
            let up = Transform::from_xyz(0.0, height, 0.0);
            app.world_mut()
                .entity_mut(thief)
                .insert((up, Visible::default()));
        }
        if step % 64 == 0 {
            let at = app.world().get::<Transform>(guard).map(|at| at.translation);
            println!("{:2} s: lift at {height:.2} m, guard at {at:?}", step / 64);
        }
    }
    Ok(())
}
