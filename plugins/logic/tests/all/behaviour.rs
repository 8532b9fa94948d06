//! Behaviours: what trees do, what is refused and where, reloading, and ten thousand agents.

use crate::support::{app, milliseconds, said, steps};
use bevy::app::{App, Update};
use bevy::ecs::prelude::*;
use dolomite_logic::behaviour::{BehaviourMessage, Behaviours, Leaves, Reason, compile, tree_of};
use dolomite_logic::{
    Asleep, Attention, BehaviourAppExt, Key, LeafBatch, Mind, Names, Phase, Status, Values,
};

/// Which leaf was called for whom, and why.
#[derive(Resource, Default)]
struct Log(Vec<(&'static str, Phase)>);

/// Answers by the agent's own values: `fail_NAME` or `end_NAME`, or runs on.
fn leaf(name: &'static str) -> impl Fn(InMut<LeafBatch>, Query<&Values>, Res<Names>, ResMut<Log>) {
    move |mut batch, values, names, mut log| {
        let key = |what: &str| names.find(&format!("{what}_{name}"));
        let (fail, end) = (key("fail"), key("end"));
        for (call, _) in batch.iter_mut() {
            log.0.push((name, call.phase));
            let values = values.get(call.agent).expect("an agent has values");
            let yes = |key: Option<Key>| key.is_some_and(|key| values.number(key) > 0.0);
            if yes(fail) {
                call.status = Status::Failure;
            } else if yes(end) {
                call.status = Status::Success;
            }
        }
    }
}

fn with_leaves() -> App {
    let mut app = app();
    app.init_resource::<Log>();
    app.add_leaf("a", leaf("a"))
        .add_leaf("b", leaf("b"))
        .add_leaf("c", leaf("c"));
    for name in ["fail_a", "end_a", "fail_b", "end_b", "fail_c", "end_c"] {
        app.world_mut().resource_mut::<Names>().intern(name);
    }
    app
}

fn spawn(app: &mut App, trees: &str) -> Entity {
    let values =
        "\"x\": 0.0, \"y\": 0.0, \"end_a\": 0.0, \"fail_a\": 0.0, \"end_b\": 0.0, \"fail_b\": 0.0";
    let text = format!("(values: {{{values}}}, root: \"r\", trees: {{\"r\": {trees}}})");
    let id = app
        .add_behaviour("test", &text)
        .unwrap_or_else(|error| panic!("{error}"));
    app.world_mut().spawn(Mind::new(id)).id()
}

/// The agent's tree as people see it.
fn shown(app: &App, agent: Entity) -> String {
    let world = app.world();
    tree_of(
        world.get::<Mind>(agent).expect("it has a mind"),
        world.resource::<Behaviours>(),
        world.resource::<Names>(),
        world.resource::<Leaves>(),
    )
}

#[test]
fn a_tree_is_shown_as_it_runs() {
    let mut app = with_leaves();
    let trees =
        r#"Select([Sequence([If("x", Above(0.5)), Do("a")]), Sequence([Do("b"), Wait(2.0)])])"#;
    let agent = spawn(&mut app, trees);
    let before = shown(&app, agent);
    assert!(before.starts_with("test: between two rounds"), "{before}");
    steps(&mut app, 2);
    let lines = |text: &str| text.lines().skip(1).map(str::to_owned).collect::<Vec<_>>();
    let second = [
        "> Select",
        "    Sequence",
        ">   Sequence",
        ">     Do b",
        "      Wait 2 s",
    ];
    assert_eq!(lines(&shown(&app, agent)), second);
    set(&mut app, agent, "x", 1.0);
    steps(&mut app, 2);
    let first = [
        "> Select",
        ">   Sequence",
        "      If x above 0.5",
        ">     Do a",
        "    Sequence",
    ];
    assert_eq!(lines(&shown(&app, agent)), first);
    // Read again, its numbers are those of another tree.
    let text = "(values: {}, root: \"r\", trees: {\"r\": Do(\"c\")})";
    app.add_behaviour("test", text).expect("a good text");
    let anew = shown(&app, agent);
    assert_eq!(lines(&anew), ["  Do c"], "{anew}");
    assert!(anew.contains("begins anew"), "{anew}");
}

fn set(app: &mut App, agent: Entity, name: &str, to: f32) {
    let key = app.world_mut().resource_mut::<Names>().intern(name);
    let mut values = app
        .world_mut()
        .get_mut::<Values>(agent)
        .expect("the test made it so");
    values.set(key, to.into()).expect("the test made it so");
}

fn log(app: &mut App) -> Vec<(&'static str, Phase)> {
    std::mem::take(&mut app.world_mut().resource_mut::<Log>().0)
}

use Phase::{Continue, Start, Stop};

#[test]
fn a_sequence_goes_on_where_it_was_and_asks_its_tests_again() {
    let mut app = with_leaves();
    let agent = spawn(
        &mut app,
        r#"Sequence([Do("a"), If("x", Below(1.0)), Do("b"), Do("c")])"#,
    );
    steps(&mut app, 2);
    assert_eq!(log(&mut app), [("a", Start), ("a", Continue)]);
    set(&mut app, agent, "end_a", 1.0);
    steps(&mut app, 1);
    // It ends and the next begins in the same tick.
    assert_eq!(log(&mut app), [("a", Continue), ("b", Start)]);
    steps(&mut app, 1);
    assert_eq!(
        log(&mut app),
        [("b", Continue)],
        "what is done is not done again"
    );
    set(&mut app, agent, "x", 2.0);
    steps(&mut app, 1);
    assert_eq!(log(&mut app), [("b", Stop)]);
    assert_eq!(
        app.world()
            .get::<Mind>(agent)
            .expect("the test made it so")
            .status(),
        Status::Failure
    );
    steps(&mut app, 1);
    assert_eq!(log(&mut app), [("a", Start)], "from the first on");
}

#[test]
fn a_select_turns_to_what_comes_first_and_stops_what_ran() {
    let mut app = with_leaves();
    let trees = r#"Select([Sequence([If("x", Above(0.5)), Do("a")]), Do("b"), Do("c")])"#;
    let agent = spawn(&mut app, trees);
    steps(&mut app, 1);
    set(&mut app, agent, "x", 1.0);
    steps(&mut app, 2);
    set(&mut app, agent, "fail_a", 1.0);
    steps(&mut app, 1);
    set(&mut app, agent, "fail_b", 1.0);
    steps(&mut app, 1);
    let expected = [
        ("b", Start),
        ("a", Start),
        ("b", Stop),
        ("a", Continue),
        ("a", Continue),
        ("b", Start),
        ("a", Start),
        ("b", Continue),
        ("c", Start),
    ];
    assert_eq!(log(&mut app), expected);
}

#[test]
fn scores_choose_and_what_runs_stays_until_another_is_clearly_better() {
    let mut app = with_leaves();
    let trees =
        r#"Choose([([Of("x", Rise(0.0, 1.0))], Do("a")), ([Of("y", Rise(0.0, 1.0))], Do("b"))])"#;
    let agent = spawn(&mut app, trees);
    steps(&mut app, 1);
    assert_eq!(log(&mut app), [], "nobody wants anything");
    for (x, y) in [(0.5, 0.4), (0.5, 0.55), (0.5, 0.7), (0.65, 0.7), (0.0, 0.0)] {
        set(&mut app, agent, "x", x);
        set(&mut app, agent, "y", y);
        steps(&mut app, 1);
    }
    let expected = [
        ("a", Start),
        ("a", Continue),
        ("b", Start),
        ("a", Stop),
        ("b", Continue),
        ("b", Stop),
    ];
    assert_eq!(log(&mut app), expected);
}

#[test]
fn decorators_do_what_they_say() {
    let mut app = with_leaves();
    let second = |n: f32| n / 64.0;
    let trees = format!(
        r#"Select([
            Cooldown({}, Sequence([Wait({}), Say("barked")])),
            Limit({}, Do("a")),
            Anyway(Not(Set("x", 5.0))),
        ])"#,
        second(10.0),
        second(3.0),
        second(4.0)
    );
    let agent = spawn(&mut app, &trees);
    let barked = app.world_mut().resource_mut::<Names>().intern("barked");
    let mut barks = Vec::new();
    for step in 0..30 {
        steps(&mut app, 1);
        barks.extend(
            said(&mut app)
                .iter()
                .filter(|s| s.1 == barked)
                .map(|_| step),
        );
    }
    // Three steps of waiting, then ten of silence.
    assert_eq!(barks, [3, 16, 29]);
    let log = log(&mut app);
    let count = |phase| log.iter().filter(|call| call.1 == phase).count();
    assert!(count(Start) >= 2 && count(Stop) >= 2, "{log:?}");
    let x = app.world_mut().resource_mut::<Names>().intern("x");
    assert_eq!(
        app.world()
            .get::<Values>(agent)
            .expect("the test made it so")
            .number(x),
        5.0
    );
}

#[test]
fn parameters_come_with_their_node_and_repeat_takes_a_tick_a_round() {
    #[derive(Resource, Default)]
    struct Sum(f32, u32);
    let mut app = app();
    app.init_resource::<Sum>();
    let speed = app.world_mut().resource_mut::<Names>().intern("speed");
    app.add_leaf(
        "go",
        move |mut batch: InMut<LeafBatch>, mut sum: ResMut<Sum>| {
            for (call, parameters) in batch.iter_mut() {
                assert_eq!(parameters.get::<i32>(speed), None);
                sum.0 += parameters.get::<f32>(speed).unwrap_or(100.0);
                sum.1 += 1;
                call.status = Status::Success;
            }
        },
    );
    let text =
        r#"(root: "r", trees: {"r": Repeat(Sequence([DoWith("go", {"speed": 2.5}), Do("go")]))})"#;
    let id = app
        .add_behaviour("test", text)
        .expect("the test made it so");
    app.world_mut().spawn(Mind::new(id));
    steps(&mut app, 4);
    let sum = app.world().resource::<Sum>();
    assert_eq!((sum.0, sum.1), (4.0 * 102.5, 8));
}

/// File, line and column of a refusal, and why.
fn refused(text: &str) -> (usize, usize, Reason) {
    let mut names = Names::default();
    let known = |leaf: &str| (leaf == "go").then_some(0);
    let error = compile("guard.ron", text, &mut names, known).expect_err("it is refused");
    assert_eq!(error.file, "guard.ron");
    assert!(error.to_string().starts_with("guard.ron:"), "{error}");
    (error.line, error.column, error.reason)
}

#[test]
fn what_is_wrong_is_refused_with_its_place() {
    let text = "(\n  root: \"r\",\n  trees: {\"r\": Sequence([Do(\"go\"),\n    Do(\"fly\")])})";
    assert_eq!(refused(text), (4, 9, Reason::UnknownLeaf("fly".into())));
    let text = "(root: \"r\", trees: {\n \"r\": If(\"mood\", Above(1.0))})";
    assert_eq!(refused(text), (2, 11, Reason::UnknownValue("mood".into())));
    let text = "(root: \"r\", trees: {\n \"r\": Select([Use(\"s\")]),\n \"s\": Not(Use(\"r\"))})";
    let way = ["r", "s", "r"].map(String::from).to_vec();
    assert_eq!(refused(text), (3, 16, Reason::Loop(way)));
    let text = "(root: \"r\", trees: {\"r\": Do(\"go\"), \"x\": Use(\"x\")})";
    assert!(
        matches!(refused(text).2, Reason::Loop(_)),
        "also where nobody uses it"
    );
    assert_eq!(
        refused("(root: \"q\", trees: {})").2,
        Reason::UnknownTree("q".into())
    );
    let text = "(root: \"r\", trees: {\"r\": Do(\"go\"),\n \"r\": Do(\"go\")})";
    assert_eq!(refused(text), (2, 3, Reason::Twice("r".into())));
    let text = "(values: {\"x\": 0.0}, root: \"r\", trees: {\"r\": If(\"x\", Above(NaN))})";
    assert_eq!(refused(text).2, Reason::NotFinite("x".into()));
    let text = "(values: {\"x\": inf}, root: \"r\", trees: {\"r\": Do(\"go\")})";
    assert_eq!(refused(text).2, Reason::NotFinite("x".into()));
    let text = "(values: {\"x\": 0.0}, root: \"r\", trees: {\"r\": Set(\"x\", true)})";
    assert!(matches!(refused(text).2, Reason::Kind { .. }));
    let text = "(root: \"r\", trees: {\"r\": Sequence([])})";
    assert_eq!(refused(text).2, Reason::Empty("Sequence"));
    for time in ["0.0", "-1.0", "NaN"] {
        let text = format!("(root: \"r\", trees: {{\"r\": Wait({time})}})");
        assert!(matches!(
            refused(&text).2,
            Reason::Range { .. } | Reason::NotFinite(_)
        ));
    }
    let text = "(values: {\"x\": 0.0}, root: \"r\", trees: {\"r\": Choose([([Of(\"x\", Rise(1.0, 1.0))], Do(\"go\"))])})";
    assert!(matches!(refused(text).2, Reason::Range { .. }));
    let (line, _, reason) = refused("(root: \"r\",\n trees: {\"r\": Dance})");
    assert!(
        matches!(reason, Reason::Syntax(_)) && line == 2,
        "{line} {reason}"
    );
}

#[test]
fn trees_that_would_fill_the_memory_or_the_stack_are_refused() {
    // Each tree twice the one before: 2^40 nodes.
    let mut trees = String::from("\"t0\": Do(\"go\"),");
    for i in 1..40 {
        trees += &format!("\"t{i}\": Sequence([Use(\"t{0}\"), Use(\"t{0}\")]),", i - 1);
    }
    let text = format!("(root: \"t39\", trees: {{{trees}}})");
    assert!(matches!(refused(&text).2, Reason::TooLarge(_)));
    let mut trees = String::from("\"t0\": Do(\"go\"),");
    for i in 1..10_000 {
        trees += &format!("\"t{i}\": Use(\"t{}\"),", i - 1);
    }
    let text = format!("(root: \"t9999\", trees: {{{trees}}})");
    assert!(matches!(refused(&text).2, Reason::TooDeep(_)));
    let deep = format!(
        "(root: \"r\", trees: {{\"r\": {}Do(\"go\"){}}})",
        "Not(".repeat(5000),
        ")".repeat(5000)
    );
    assert!(matches!(
        refused(&deep).2,
        Reason::Syntax(_) | Reason::TooDeep(_)
    ));
    // Cut anywhere, and with any byte changed: never a panic.
    let good = r#"(values: {"x": 0.0, "p": (1.0, 2.0, 3.0)}, root: "r", trees: {"r": Choose([([Of("x", Near(1.0, 2.0))], DoWith("go", {"n": "abc"}))])})"#;
    let check = |text: &str| {
        compile("t", text, &mut Names::default(), |leaf| {
            (leaf == "go").then_some(0)
        })
        .is_ok()
    };
    assert!(check(good));
    let (mut refusals, mut cuts) = (0, 0);
    for at in 0..good.len() {
        cuts += 1;
        refusals += u32::from(!check(&good[..at]));
        for byte in [b'(', b'"', b'9', b',', 0] {
            let mut bytes = good.as_bytes().to_vec();
            bytes[at] = byte;
            check(std::str::from_utf8(&bytes).expect("the test made it so"));
        }
    }
    assert_eq!(refusals, cuts);
}

#[derive(Resource, Default)]
struct Told(Vec<BehaviourMessage>);

#[test]
fn a_file_is_read_again_and_the_last_good_one_stays() {
    let mut app = with_leaves();
    app.init_resource::<Told>();
    let listen = |mut messages: MessageReader<BehaviourMessage>, mut told: ResMut<Told>| {
        told.0.extend(messages.read().cloned());
    };
    app.add_systems(Update, listen);
    let path = std::env::temp_dir().join(format!("dolomite_logic_{}.ron", std::process::id()));
    let write = |trees: &str| {
        std::fs::write(&path, format!("(root: \"r\", trees: {{\"r\": {trees}}})"))
            .expect("the test made it so")
    };
    write("Do(\"a\")");
    let id = app.load_behaviour(&path).expect("the test made it so");
    app.world_mut().spawn(Mind::new(id));
    app.world_mut().resource_mut::<Behaviours>().watch = true;
    steps(&mut app, 1);
    write("Sequence([Do(\"b\"), Do(\"c\")])");
    steps(&mut app, 65);
    let calls = log(&mut app);
    let turn = calls
        .iter()
        .position(|call| call.0 == "b")
        .expect("the new one runs");
    assert_eq!(calls[turn - 1..=turn], [("a", Stop), ("b", Start)]);
    write("Do(\"nothing of this name\")");
    steps(&mut app, 65);
    assert!(log(&mut app).iter().all(|call| call.0 == "b"));
    let behaviours = app.world().resource::<Behaviours>();
    let error = behaviours.error(id).expect("it was refused");
    assert!(
        matches!(error.reason, Reason::UnknownLeaf(_)) && error.line == 1,
        "{error}"
    );
    let told = &app.world().resource::<Told>().0;
    let errors: Vec<bool> = told.iter().map(|message| message.error.is_some()).collect();
    assert_eq!(errors, [false, true]);
    std::fs::remove_file(&path).expect("the test made it so");
    steps(&mut app, 65);
    let error = app
        .world()
        .resource::<Behaviours>()
        .error(id)
        .expect("it is gone");
    assert!(matches!(error.reason, Reason::Read(_)), "{error}");
    assert!(log(&mut app).iter().all(|call| call.0 == "b"));
    assert!(app.load_behaviour("no/such/file.ron").is_err());
}

#[test]
fn who_sleeps_thinks_nothing_and_who_is_far_rarely() {
    let mut app = with_leaves();
    let agent = spawn(&mut app, "Do(\"a\")");
    app.world_mut()
        .entity_mut(agent)
        .insert(Attention::every(8));
    steps(&mut app, 64);
    assert_eq!(log(&mut app).len(), 8);
    app.world_mut().entity_mut(agent).insert(Asleep);
    steps(&mut app, 64);
    assert_eq!(log(&mut app), []);
}

#[test]
fn a_leaf_may_remove_its_agent() {
    let mut app = app();
    app.add_leaf(
        "vanish",
        |mut batch: InMut<LeafBatch>, mut commands: Commands| {
            for (call, _) in batch.iter_mut() {
                commands.entity(call.agent).despawn();
                call.status = Status::Success;
            }
        },
    );
    let text = r#"(root: "r", trees: {"r": Sequence([Do("vanish"), Do("vanish")])})"#;
    let id = app
        .add_behaviour("test", text)
        .expect("the test made it so");
    let agent = app.world_mut().spawn(Mind::new(id)).id();
    steps(&mut app, 2);
    assert!(app.world().get_entity(agent).is_err());
}

/// A guard of twenty nodes.
const GUARD: &str = r#"(
    values: {"alert": 0.0, "rounds": 30.0, "tired": 0.0},
    root: "guard",
    trees: {
        "guard": Choose([
            ([Of("alert", Rise(0.2, 0.8))], Use("attack")),
            ([Of("alert", Rise(0.0, 0.3)), Of("tired", Fall(0.5, 1.0))], Use("search")),
            ([Always(0.3)], Use("patrol")),
        ]),
        "attack": Sequence([If("rounds", Above(0.0)), Do("aim"), Select([Do("shoot"), Set("rounds", 0.0)])]),
        "search": Sequence([If("tired", Below(0.9)), Not(If("alert", Above(0.9))), Do("look"), Wait(0.1)]),
        "patrol": Sequence([If("rounds", Above(-1.0)), If("rounds", Below(99.0)), If("tired", Below(0.95)), Anyway(Do("walk")), Set("tired", 0.1)]),
    },
)"#;

#[test]
fn ten_thousand_guards_of_twenty_nodes_think() {
    let mut app = app();
    for name in ["aim", "shoot", "look", "walk"] {
        app.add_leaf(name, |mut batch: InMut<LeafBatch>| {
            for (number, (call, _)) in batch.iter_mut().enumerate() {
                call.status = if number % 3 == 0 {
                    Status::Success
                } else {
                    Status::Running
                };
            }
        });
    }
    let id = app
        .add_behaviour("guard", GUARD)
        .expect("the test made it so");
    assert_eq!(
        app.world()
            .resource::<Behaviours>()
            .program(id)
            .expect("the test made it so")
            .len(),
        20
    );
    let count = 10_000_u32;
    for i in 0..count {
        let values = Values::with([(Key::ALERT, i as f32 / count as f32)]);
        app.world_mut().spawn((Mind::new(id), values));
    }
    steps(&mut app, 4);
    let (wall, cpu) = milliseconds(40, || app.update());
    println!("10 000 agents of 20 nodes, a tick: {wall:.2} ms at least, {cpu:.2} ms of all cores");
    let thoughts = *app
        .world()
        .resource::<dolomite_logic::behaviour::ThoughtCounters>();
    assert_eq!(thoughts.agents, count);
    assert!(
        thoughts.calls > count / 4 && thoughts.batches < 40,
        "{thoughts:?}"
    );
    // A frame of 60 a second has 16 ms.
    assert!(cpu < 16.0, "{cpu}");
}
