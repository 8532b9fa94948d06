//! The commands of every app, typed.
use crate::support::{Fog, FogCounters, FogKind, FogLines, app, say};

use bevy::prelude::*;
use dolomite_inspector::Console;
use dolomite_inspector::commands::known;
use dolomite_inspector::console::complete::complete;

fn fog(app: &App, entity: Entity) -> Fog {
    app.world().get::<Fog>(entity).expect("it is there").clone()
}

#[test]
fn a_strangers_setting_is_found_read_set_and_taken_back() {
    let (mut app, entity) = app();
    assert!(
        say(&mut app, "settings fog")
            .unwrap()
            .contains("Fog near the ground")
    );
    assert_eq!(
        say(&mut app, "get fog.dust").unwrap(),
        format!("Fog@{entity}.dust 1.0 g, 0 to 100: Dust in the air")
    );
    say(&mut app, "set Fog.dust 20").unwrap();
    say(&mut app, "set Fog@valley.drift.y -3.5").unwrap();
    say(&mut app, "set Fog.near 7").unwrap();
    say(&mut app, "set Fog.layers [4]").unwrap();
    say(&mut app, "set Fog.layers[0] 9").unwrap();
    say(&mut app, "set Fog.kind 'Thick(share: 0.5)'").unwrap();
    say(&mut app, "set Fog.kind.share 0.25").unwrap();
    say(&mut app, "set Fog.name white as  milk").unwrap();
    let expected = Fog {
        dust: 20.0,
        near: Some(7.0),
        layers: vec![9],
        kind: FogKind::Thick { share: 0.25 },
        name: "white as milk".to_owned(),
        drift: Vec3::new(0.0, -3.5, 0.0),
        ..Fog::default()
    };
    assert_eq!(fog(&app, entity), expected);
    // All of them back, in one go each, and all again.
    for _ in 0..8 {
        say(&mut app, "undo").unwrap();
    }
    assert_eq!(fog(&app, entity), Fog::default());
    assert!(say(&mut app, "undo").is_err());
    for _ in 0..8 {
        say(&mut app, "redo").unwrap();
    }
    assert_eq!(fog(&app, entity), expected);
    assert!(say(&mut app, "redo").is_err());
}

#[test]
fn what_is_copied_can_be_set_again() {
    let (mut app, entity) = app();
    say(&mut app, "set Fog.kind 'Banks(3, true)'").unwrap();
    say(&mut app, "set Fog.near 0.1").unwrap();
    let before = fog(&app, entity);
    let copied = say(&mut app, "copy Fog").unwrap();
    assert!(copied.lines().count() > 5, "a field a line: {copied}");
    app.world_mut().entity_mut(entity).insert(Fog::default());
    let line = format!("set Fog '{}'", copied.replace('\n', " "));
    say(&mut app, &line).unwrap();
    assert_eq!(fog(&app, entity), before);
}

#[test]
fn what_is_wrong_is_said_and_changes_nothing() {
    let (mut app, entity) = app();
    for (line, word) in [
        ("set Fog.dust 101", "0 to 100 g"),
        ("set Fog.dust -1", "0 to 100 g"),
        ("set Fog.dust NaN", "NaN"),
        ("set Fog.near inf", "no finite number"),
        ("set Fog.dust many", "f32"),
        ("set Fog.dust 1 2", "f32"),
        ("set Fog.dirt 1", "dirt"),
        ("set Fog.layers[7] 1", "layers[7]"),
        ("set Fog '(dust: 1.0, dirt: 2.0)'", "dirt"),
        ("set Fog.kind Thickest", "Thickest"),
        ("set Fog.layers [1,-2]", "[1,-2]"),
        ("set FogCounters.drawn 3", "read, not set"),
        ("get Frog", "no component or resource"),
        ("get Fo", "Fog"),
        ("get Fog@nobody", "nobody"),
        ("get Fog@99v0", "gone"),
        ("get Visibility", "no entity has"),
        ("entity 77v1", "gone"),
        ("despawn 77v1", "gone"),
        ("spawn Fog=(dust:500)", "0 to 100"),
        ("spawn FogCounters", "resource"),
        ("views nothing", "no view"),
        ("watch nothing", "no diagnostic"),
        ("stat nothing", "no such"),
        ("exec /no/such/file", "/no/such/file"),
        ("wait 0", "0"),
        ("nothing", "unrecognized"),
    ] {
        let before = app.world().entities().count_spawned();
        let fault = say(&mut app, line).expect_err(line);
        assert!(fault.contains(word), "{line}: {fault}");
        assert_eq!(fog(&app, entity), Fog::default(), "{line}");
        assert_eq!(
            *app.world().resource::<FogCounters>(),
            FogCounters::default()
        );
        assert_eq!(app.world().entities().count_spawned(), before, "{line}");
    }
}

#[test]
fn of_several_entities_one_has_to_be_named() {
    let (mut app, first) = app();
    let second = app.world_mut().spawn(Fog::default()).id();
    let fault = say(&mut app, "set Fog.dust 3").unwrap_err();
    assert!(fault.contains("2 entities") && fault.contains(&second.to_string()));
    say(&mut app, &format!("set Fog@{second}.dust 3")).unwrap();
    assert_eq!(fog(&app, first).dust, 1.0);
    assert_eq!(fog(&app, second).dust, 3.0);
    // A change of an entity that is gone is not taken back, and those before it can be.
    say(&mut app, &format!("set Fog@{first}.dust 4")).unwrap();
    say(&mut app, &format!("set Fog@{second}.dust 5")).unwrap();
    say(&mut app, &format!("despawn {second}")).unwrap();
    assert!(say(&mut app, "undo").unwrap_err().contains("gone"));
    say(&mut app, "undo").unwrap();
    assert_eq!(fog(&app, first).dust, 1.0);
}

#[test]
fn entities_are_spawned_listed_and_described() {
    let (mut app, _) = app();
    let said = say(&mut app, "spawn 'Fog=(dust:9)'").unwrap();
    let entity = said.split(' ').next().unwrap().to_owned();
    assert!(
        say(&mut app, "entities valley")
            .unwrap()
            .contains("1 entities")
    );
    assert!(say(&mut app, "entities").unwrap().contains(&entity));
    let described = say(&mut app, &format!("entity {entity}")).unwrap();
    assert!(described.contains("dust:9.0"), "{described}");
    assert!(described.contains("other:"), "{described}");
}

#[test]
fn views_are_switched_and_diagnostics_watched() {
    let (mut app, _) = app();
    assert!(
        say(&mut app, "views")
            .unwrap()
            .contains("off  the fog as lines")
    );
    say(&mut app, "views fog_lines on").unwrap();
    assert!(app.world().resource::<FogLines>().0);
    say(&mut app, "views fog_lines").unwrap();
    assert!(!app.world().resource::<FogLines>().0);
    say(&mut app, "watch fog/drawn").unwrap();
    assert!(
        say(&mut app, "watch fog/drawn")
            .unwrap_err()
            .contains("already")
    );
    say(&mut app, "watch fog/drawn --off").unwrap();
    // It was registered twice.
    assert_eq!(say(&mut app, "stat fog").unwrap().lines().count(), 1);
}

#[test]
fn a_script_stops_at_its_mistake() {
    let (mut app, entity) = app();
    let file = std::env::temp_dir().join(format!("dolomite-script-{}", std::process::id()));
    std::fs::write(
        &file,
        "# dust\nset Fog.dust 2\nwait 3\nset Fog.dust x\nset Fog.dust 3\n",
    )
    .unwrap();
    let fault = say(&mut app, &format!("exec '{}'", file.display())).unwrap_err();
    std::fs::remove_file(&file).unwrap();
    assert!(fault.contains(&format!("{}:4:", file.display())), "{fault}");
    assert!(fault.contains("1 more line is left out"), "{fault}");
    assert_eq!(fog(&app, entity).dust, 2.0);
}

#[test]
fn every_command_has_a_purpose_and_help_and_names_are_completed() {
    let (mut app, _) = app();
    let console = app.world().resource::<Console>();
    console.table.command().clone().debug_assert();
    let list: Vec<_> = console
        .table
        .list()
        .map(|(name, about)| (name.to_owned(), about))
        .collect();
    assert!(list.len() >= 17, "{list:?}");
    for (name, about) in &list {
        assert!(!about.is_empty(), "{name}");
        let help = say(&mut app, &format!("help {name}")).unwrap();
        assert!(help.contains(about) && help.contains("Usage"), "{help}");
    }
    let world = app.world();
    let candidates = |line| {
        let table = &world.resource::<Console>().table;
        complete(table, line, |name| known(world, name)).candidates
    };
    assert_eq!(candidates("set Fog.du"), ["Fog.dust"]);
    assert_eq!(candidates("views fog"), ["fog_lines"]);
    assert_eq!(candidates("watch fog"), ["fog/drawn"]);
    assert!(candidates("des").contains(&"despawn".to_owned()));
}
