//! Values, actions, wires, rates.

use crate::support::{act, app, said, steps};
use bevy::app::App;
use bevy::ecs::prelude::*;
use bevy::ecs::system::RunSystemOnce;
use dolomite_logic::{
    Action, Button, Key, LogicAccess, LogicAppExt, LogicClock, LogicTimer, Names, Value,
    ValueError, Values, Wire, Wires,
};
use std::time::Instant;

#[test]
fn values_of_entities_are_queried_and_set_by_name() {
    let mut app = app();
    let courage = app.world_mut().resource_mut::<Names>().intern("courage");
    let agent = app
        .world_mut()
        .spawn(Values::with([(courage, 0.5_f32)]))
        .id();
    let stone = app.world_mut().spawn_empty().id();
    let gone = app.world_mut().spawn(Values::default()).id();
    app.world_mut().despawn(gone);
    let work = move |mut logic: LogicAccess| {
        assert_eq!(logic.query::<f32>(agent, courage), Some(0.5));
        assert_eq!(logic.query::<i32>(agent, courage), None, "another type");
        assert_eq!(logic.query::<f32>(stone, courage), None);
        assert_eq!(logic.set(stone, courage, 1.0), Err(ValueError::NoValues));
        assert_eq!(logic.set(gone, courage, 1.0), Err(ValueError::NoValues));
        assert_eq!(
            logic.set(agent, courage, f32::NAN),
            Err(ValueError::NotFinite)
        );
        assert_eq!(logic.set(agent, courage, 0.75), Ok(Some(Value::Float(0.5))));
        assert_eq!(logic.query::<f32>(agent, courage), Some(0.75));
        logic.act(agent, gone, Key::DAMAGE, 5.0);
        logic.act(agent, stone, Key::OPEN, ());
    };
    app.world_mut()
        .run_system_once(work)
        .expect("the test made it so");
    // Actions on who is gone, and on who does not know the verb, do nothing.
    steps(&mut app, 3);
}

#[test]
fn wires_hand_on_at_once_and_later_in_order() {
    let mut app = app();
    let last = app.world_mut().spawn(Button::default()).id();
    let middle = app.world_mut().spawn(Button::default()).id();
    let mut wires = vec![Wire::new(Key::PRESSED, middle, Key::PRESS)];
    wires.push(Wire::new(Key::PRESSED, last, Key::PRESS).after(10.0 / 64.0));
    let first = app
        .world_mut()
        .spawn((Button::default(), Wires(wires)))
        .id();
    act(&mut app, first, Key::PRESS, ());
    steps(&mut app, 2);
    assert_eq!(
        said(&mut app),
        [(first, Key::PRESSED), (middle, Key::PRESSED)]
    );
    steps(&mut app, 8);
    assert_eq!(said(&mut app), []);
    steps(&mut app, 1);
    assert_eq!(said(&mut app), [(last, Key::PRESSED)]);
}

#[test]
fn wires_that_lead_back_do_not_fill_the_memory() {
    let mut app = app();
    let button = app.world_mut().spawn(Button::default()).id();
    // Twice as many presses in each step.
    let wire = Wire::new(Key::PRESSED, button, Key::PRESS);
    let wires = Wires(vec![wire; 2]);
    app.world_mut().entity_mut(button).insert(wires);
    act(&mut app, button, Key::PRESS, ());
    let mut sent = Vec::new();
    for _ in 0..24 {
        app.update();
        said(&mut app);
        // Those of this step and of the one before.
        sent.push(app.world().resource::<Messages<Action>>().len());
    }
    assert!(sent[18] > 500_000, "{sent:?}");
    assert!(sent.iter().all(|sent| *sent <= 2 << 20), "{sent:?}");
    assert!(sent[23] >= 1_000_000, "{sent:?}");
}

#[derive(Resource, Default)]
struct Ran([u32; 5]);

#[test]
fn updates_run_at_their_rates_and_never_at_none() {
    let mut app = app();
    app.init_resource::<Ran>();
    fn count<const N: usize>(mut ran: ResMut<Ran>) {
        ran.0[N] += 1;
    }
    app.add_update(1000.0, count::<0>)
        .add_update(16.0, count::<1>)
        .add_update(0.0, count::<2>)
        .add_update(f32::NAN, count::<3>)
        .add_update(f32::INFINITY, count::<4>);
    steps(&mut app, 64);
    assert_eq!(app.world().resource::<Ran>().0, [0; 5], "nobody has logic");
    app.world_mut().spawn(LogicTimer::every(1.0));
    steps(&mut app, 128);
    assert_eq!(app.world().resource::<Ran>().0, [128, 32, 0, 0, 128]);
    assert_eq!(app.world().resource::<LogicClock>().step, 128);
}

/// Nanoseconds of each, the least of some runs.
fn nanoseconds(app: &mut App, count: u32, mut work: impl FnMut(&mut App)) -> f64 {
    let mut least = f64::INFINITY;
    for _ in 0..60 {
        let begun = Instant::now();
        work(app);
        least = least.min(begun.elapsed().as_secs_f64() * 1e9 / f64::from(count));
    }
    least
}

#[test]
fn a_query_a_set_and_an_action_take_less_than_a_tenth_of_a_microsecond() {
    let mut app = app();
    let names: Vec<Key> = (0..16)
        .map(|i| {
            let mut names = app.world_mut().resource_mut::<Names>();
            names.intern(&format!("value {i}"))
        })
        .collect();
    let agents: Vec<Entity> = (0..1000)
        .map(|_| {
            let values = Values::with(names.iter().map(|&name| (name, 1.0_f32)));
            app.world_mut().spawn(values).id()
        })
        .collect();
    // Short runs, the least of many: longer ones are interrupted on a machine with more to do.
    const ROUNDS: u32 = 10;
    let (agents, names) = (&agents, &names);
    let count = ROUNDS * 1000;
    // Systems that are made once, as those of an app are.
    let each = |work: &dyn Fn(&mut LogicAccess, Entity, u32), app: &mut App| {
        let mut state = bevy::ecs::system::SystemState::<LogicAccess>::new(app.world_mut());
        let ns = nanoseconds(app, count, |app| {
            let mut logic = state.get_mut(app.world_mut()).expect("the test made it so");
            for round in 0..ROUNDS {
                for &agent in agents {
                    work(&mut logic, agent, round);
                }
            }
        });
        app.world_mut().resource_mut::<Messages<Action>>().clear();
        ns
    };
    let name = |round: u32| names[round as usize % names.len()];
    let query = each(
        &|logic, agent, round| {
            std::hint::black_box(logic.query::<f32>(agent, name(round)));
        },
        &mut app,
    );
    let set = each(
        &|logic, agent, round| {
            std::hint::black_box(logic.set(agent, name(round), round as f32)).ok();
        },
        &mut app,
    );
    let action = each(
        &|logic, agent, round| logic.act(agent, agent, name(round), round as f32),
        &mut app,
    );
    println!("ns: query {query:.1}, set {set:.1}, action {action:.1}");
    // Ten million a second are 100 ns each; Bevy itself is hardly optimised in tests.
    assert!(query.max(set).max(action) < 400.0, "{query} {set} {action}");
}
