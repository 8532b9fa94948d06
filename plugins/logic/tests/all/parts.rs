//! Ready-made parts: each does what it says, and bad numbers do no harm.

use crate::support::{SECONDS, Said, act, app, said, steps};
use bevy::app::App;
use bevy::ecs::prelude::*;
use bevy::math::Vec3;
use bevy::transform::components::Transform;
use dolomite_logic::parts::{DoorState, LiftError, LiftState, Outcome};
use dolomite_logic::senses::Memory;
use dolomite_logic::{
    Button, Collector, DayClock, Door, Health, Key, Lamp, Lift, LogicTimer, Mission, Objective,
    PickUp, Slide, Value, Values, Wire, Wires,
};

fn get<C: Component + Clone>(app: &App, entity: Entity) -> C {
    app.world().get::<C>(entity).expect("it has one").clone()
}

#[test]
fn timers_elapse_in_time_and_bad_ones_never() {
    let mut app = app();
    let every = app.world_mut().spawn(LogicTimer::every(4.0 * SECONDS)).id();
    let once = app.world_mut().spawn(LogicTimer::once(2.0 * SECONDS)).id();
    for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        app.world_mut().spawn(LogicTimer::every(bad));
    }
    steps(&mut app, 9);
    let expected = [once, every, every].map(|entity| (entity, Key::ELAPSED));
    assert_eq!(said(&mut app), expected);
    act(&mut app, every, Key::STOP, ());
    act(&mut app, once, Key::START, ());
    steps(&mut app, 8);
    assert_eq!(said(&mut app), [(once, Key::ELAPSED)]);
}

#[test]
fn buttons_pause_and_lock() {
    let mut app = app();
    let pause = 3.0 * SECONDS;
    let button = Button {
        pause,
        ..Button::new(7)
    };
    let button = app.world_mut().spawn(button).id();
    for _ in 0..4 {
        act(&mut app, button, Key::PRESS, ());
        steps(&mut app, 1);
    }
    assert_eq!(get::<Button>(&app, button).presses, 2);
    let said = std::mem::take(&mut app.world_mut().resource_mut::<Said>().0);
    assert!(said.iter().all(|output| output.parameter == Value::Int(7)));
    act(&mut app, button, Key::LOCK, ());
    steps(&mut app, 4);
    act(&mut app, button, Key::PRESS, ());
    steps(&mut app, 1);
    assert_eq!(get::<Button>(&app, button).presses, 2);
}

#[test]
fn a_door_opens_slides_waits_and_closes_but_not_on_somebody() {
    let mut app = app();
    let door = Door {
        time: 8.0 * SECONDS,
        hold: Some(4.0 * SECONDS),
        ..Door::default()
    };
    let slide = Slide {
        closed: Vec3::ZERO,
        open: Vec3::Y * 2.0,
    };
    let door = app.world_mut().spawn((door, slide)).id();
    act(&mut app, door, Key::OPEN, ());
    steps(&mut app, 4);
    assert_eq!(get::<Transform>(&app, door).translation, Vec3::Y);
    steps(&mut app, 4);
    assert_eq!(said(&mut app), [(door, Key::OPENED)]);
    steps(&mut app, 6);
    assert_eq!(get::<Door>(&app, door).state, DoorState::Closing);
    act(&mut app, door, Key::BLOCK, ());
    steps(&mut app, 1);
    assert_eq!(get::<Door>(&app, door).state, DoorState::Opening);
    steps(&mut app, 30);
    assert_eq!(get::<Door>(&app, door).state, DoorState::Closed);
    said(&mut app);
    act(&mut app, door, Key::LOCK, ());
    act(&mut app, door, Key::OPEN, ());
    steps(&mut app, 3);
    assert_eq!(get::<Door>(&app, door).state, DoorState::Closed);
    assert_eq!(said(&mut app), []);
}

#[test]
fn a_lift_follows_its_buttons_up_before_down_and_opens_doors() {
    let mut app = app();
    let door = Door {
        time: 16.0 * SECONDS,
        ..Door::default()
    };
    let doors: Vec<Entity> = (0..4).map(|_| app.world_mut().spawn(door).id()).collect();
    let mut lift = Lift::new(vec![0.0, 3.0, 6.0, 9.5]).expect("the test made it so");
    lift.doors = doors.iter().copied().map(Some).collect();
    lift.waiting = 0.5;
    let lift = app.world_mut().spawn(lift).id();
    let buttons: Vec<Entity> = (0..4)
        .map(|floor| {
            let wires = Wires(vec![Wire::new(Key::PRESSED, lift, Key::CALL)]);
            app.world_mut().spawn((Button::new(floor), wires)).id()
        })
        .collect();
    act(&mut app, buttons[2], Key::PRESS, ());
    steps(&mut app, 40);
    // On its way: whoever is in between is taken along, whoever is below has to wait.
    assert_eq!(get::<Lift>(&app, lift).state(), LiftState::Moving);
    act(&mut app, buttons[0], Key::PRESS, ());
    act(&mut app, buttons[3], Key::PRESS, ());
    act(&mut app, lift, Key::CALL, 99);
    let mut floors = Vec::new();
    let mut fastest = 0.0_f32;
    let mut last = get::<Lift>(&app, lift).height();
    for _ in 0..64 * 40 {
        app.update();
        let now = get::<Lift>(&app, lift);
        fastest = fastest.max((now.height() - last).abs() / SECONDS);
        // It moves with closed doors alone.
        if now.height() != last {
            let closed = |door: &Entity| get::<Door>(&app, *door).state == DoorState::Closed;
            let at = now.floor();
            assert!(
                doors
                    .iter()
                    .enumerate()
                    .all(|(i, door)| i == at || closed(door)),
                "at {} m",
                now.height()
            );
        }
        last = now.height();
        let said = std::mem::take(&mut app.world_mut().resource_mut::<Said>().0);
        floors.extend(said.iter().filter_map(|o| match o.parameter {
            Value::Int(floor) if o.name == Key::ARRIVED => Some(floor),
            _ => None,
        }));
    }
    assert_eq!(floors, [2, 3, 0]);
    assert!((1.9..2.001).contains(&fastest), "{fastest}");
    assert_eq!(get::<Transform>(&app, lift).translation.y, 0.0);
    assert_eq!(get::<Lift>(&app, lift).state(), LiftState::Idle);
    assert!(
        doors
            .iter()
            .all(|door| get::<Door>(&app, *door).state == DoorState::Closed)
    );
}

#[test]
fn what_is_new_and_rests_is_where_it_says() {
    let mut app = app();
    let lift = Lift::new(vec![2.0, 6.0]).expect("the test made it so");
    let lift = app.world_mut().spawn(lift).id();
    let slide = Slide {
        closed: Vec3::X * 5.0,
        open: Vec3::X * 9.0,
    };
    let open = Door {
        state: DoorState::Open,
        open: 1.0,
        ..Door::default()
    };
    let closed = app.world_mut().spawn(slide).id();
    let open = app.world_mut().spawn((slide, open)).id();
    steps(&mut app, 1);
    let place = |entity| get::<Transform>(&app, entity).translation;
    assert_eq!(place(lift), Vec3::Y * 2.0);
    assert_eq!((place(closed), place(open)), (Vec3::X * 5.0, Vec3::X * 9.0));
    let written = |app: &App| {
        let changed = |entity: Entity| {
            let who = app.world().entity(entity);
            let place = who.get_ref::<Transform>().expect("it is somewhere");
            place.last_changed()
        };
        [lift, closed, open].map(changed)
    };
    let once = written(&app);
    steps(&mut app, 3);
    assert_eq!(
        written(&app),
        once,
        "nothing is written where nothing moves"
    );
}

#[test]
fn lifts_that_cannot_be_are_refused() {
    assert_eq!(Lift::new(vec![]), Err(LiftError::Floors(0)));
    assert_eq!(Lift::new(vec![0.0; 65]), Err(LiftError::Floors(65)));
    assert_eq!(Lift::new(vec![0.0, 0.0]), Err(LiftError::Order(1)));
    assert_eq!(Lift::new(vec![f32::NAN]), Err(LiftError::Order(0)));
    let lift = Lift::new(vec![0.0, 3.0]).expect("the test made it so");
    assert!(lift.clone().with_speed(f32::NAN, 1.0).is_err());
    assert!(lift.clone().with_speed(1.0, 0.0).is_err());
    let mut lift = lift;
    assert_eq!(lift.call(-1), Err(LiftError::NoFloor(-1)));
    assert_eq!(lift.call(2), Err(LiftError::NoFloor(2)));
    assert_eq!(lift.call(1), Ok(()));
}

#[test]
fn health_is_taken_and_given_and_ends_once() {
    let mut app = app();
    let one = app
        .world_mut()
        .spawn((Health::new(50.0), Values::default()))
        .id();
    for amount in [f32::NAN, -5.0, f32::INFINITY] {
        act(&mut app, one, Key::DAMAGE, amount);
    }
    steps(&mut app, 1);
    assert_eq!(get::<Health>(&app, one).now, 50.0);
    act(&mut app, one, Key::DAMAGE, 20.0);
    act(&mut app, one, Key::HEAL, 5.0);
    steps(&mut app, 1);
    assert_eq!(get::<Health>(&app, one).now, 35.0);
    assert_eq!(get::<Values>(&app, one).number(Key::HEALTH), 0.7);
    act(&mut app, one, Key::DAMAGE, 40.0);
    act(&mut app, one, Key::DAMAGE, 40.0);
    act(&mut app, one, Key::HEAL, 40.0);
    steps(&mut app, 2);
    assert_eq!(get::<Health>(&app, one).now, 0.0);
    let names: Vec<Key> = said(&mut app).iter().map(|said| said.1).collect();
    assert_eq!(names, [Key::HURT, Key::HURT, Key::DIED]);
}

#[test]
fn who_was_never_hurt_is_in_full_health_and_who_heard_nothing_is_calm() {
    let mut app = app();
    let parts = (Health::new(50.0), Values::default(), Memory::default());
    let one = app.world_mut().spawn(parts).id();
    steps(&mut app, 1);
    let read = |app: &App, key| get::<Values>(app, one).read::<f32>(key);
    assert_eq!(read(&app, Key::HEALTH), Some(1.0));
    assert_eq!(read(&app, Key::ALERT), Some(0.0));
    // Whoever changes it.
    let mut health = app.world_mut().get_mut::<Health>(one);
    health.as_mut().expect("the test made it so").now = 20.0;
    steps(&mut app, 1);
    assert_eq!(read(&app, Key::HEALTH), Some(0.4));
    let changes = get::<Values>(&app, one).changes();
    steps(&mut app, 9);
    assert_eq!(get::<Values>(&app, one).changes(), changes);
}

#[test]
fn who_has_more_than_the_most_is_not_hurt_by_healing() {
    let mut rich = Health {
        now: 150.0,
        most: 100.0,
    };
    rich.heal(5.0);
    assert_eq!(rich.now, 150.0);
    let mut poor = Health {
        now: 98.0,
        most: 100.0,
    };
    poor.heal(5.0);
    assert_eq!(poor.now, 100.0);
}

#[test]
fn a_visitor_takes_what_lies_in_its_way_however_fast() {
    let mut app = app();
    let coins = app
        .world_mut()
        .resource_mut::<dolomite_logic::Names>()
        .intern("coins");
    let at = |x: f32| Transform::from_xyz(x, 0.0, 0.0);
    let once = app
        .world_mut()
        .spawn((PickUp::new(coins, 3), at(40.0)))
        .id();
    let again = PickUp {
        again: Some(4.0 * SECONDS),
        ..PickUp::new(coins, 1)
    };
    let again = app.world_mut().spawn((again, at(70.0))).id();
    let who = app.world_mut().spawn((Collector, at(0.0))).id();
    let move_to = |app: &mut App, x: f32| {
        app.world_mut()
            .get_mut::<Transform>(who)
            .expect("the test made it so")
            .translation
            .x = x;
        app.update();
    };
    move_to(&mut app, 0.0);
    // 100 m in a step: 6400 m/s.
    move_to(&mut app, 100.0);
    assert_eq!(get::<Values>(&app, who).read::<i32>(coins), Some(4));
    move_to(&mut app, 0.0);
    assert_eq!(get::<Values>(&app, who).read::<i32>(coins), Some(4));
    steps(&mut app, 4);
    move_to(&mut app, 100.0);
    assert_eq!(get::<Values>(&app, who).read::<i32>(coins), Some(5));
    let takes = said(&mut app)
        .iter()
        .filter(|said| said.1 == Key::TAKEN)
        .count();
    assert_eq!(takes, 3);
    assert!(!get::<PickUp>(&app, once).there && !get::<PickUp>(&app, again).there);
}

#[test]
fn a_mission_is_won_by_its_objectives_and_lost_with_one() {
    let mut app = app();
    let beacons = app.world_mut().spawn(Objective::new(2)).id();
    let bonus = Objective {
        optional: true,
        ..Objective::new(1)
    };
    let bonus = app.world_mut().spawn(bonus).id();
    let mission = app
        .world_mut()
        .spawn(Mission::new(vec![beacons, bonus]))
        .id();
    let empty = app.world_mut().spawn(Mission::default()).id();
    act(&mut app, beacons, Key::PROGRESS, ());
    act(&mut app, bonus, Key::FAIL, ());
    steps(&mut app, 2);
    assert_eq!(get::<Mission>(&app, mission).outcome, Outcome::Open);
    act(&mut app, beacons, Key::PROGRESS, 1);
    steps(&mut app, 2);
    assert_eq!(get::<Mission>(&app, mission).outcome, Outcome::Won);
    assert_eq!(get::<Mission>(&app, empty).outcome, Outcome::Open);
    let names: Vec<Key> = said(&mut app).iter().map(|said| said.1).collect();
    assert_eq!(names, [Key::FAILED, Key::DONE, Key::WON]);
    act(&mut app, beacons, Key::RESET, ());
    act(&mut app, mission, Key::RESET, ());
    steps(&mut app, 1);
    app.world_mut().despawn(beacons);
    steps(&mut app, 1);
    assert_eq!(get::<Mission>(&app, mission).outcome, Outcome::Lost);
}

#[test]
fn lamps_follow_the_hour_and_their_switches() {
    let mut app = app();
    let day = app
        .world_mut()
        .spawn(DayClock::new(12.0, 1.0 / SECONDS))
        .id();
    let lamp = Lamp {
        by_night: true,
        ..Lamp::default()
    };
    let lamp = app.world_mut().spawn(lamp).id();
    let mut lit = Vec::new();
    for _ in 0..24 {
        app.update();
        lit.push(get::<Lamp>(&app, lamp).lit);
    }
    // Noon, then dusk at 20 and dawn at 6.
    let expected: Vec<bool> = (0..24)
        .map(|i| (13 + i) % 24 >= 20 || (13 + i) % 24 < 6)
        .collect();
    assert_eq!(lit, expected);
    act(&mut app, lamp, Key::TOGGLE, ());
    app.world_mut()
        .get_mut::<DayClock>(day)
        .expect("the test made it so")
        .pace = f32::NAN;
    steps(&mut app, 2);
    assert!(get::<Lamp>(&app, lamp).lit && get::<DayClock>(&app, day).hour.is_finite());
}
