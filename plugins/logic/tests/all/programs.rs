//! What behaviours may be: how large, how long they wait, and which text counts.

use crate::support::{app, said, steps};
use bevy::app::App;
use dolomite_logic::behaviour::{BehaviourError, Behaviours, Program, compile};
use dolomite_logic::{BehaviourAppExt, Key, Mind, Names};
use std::path::PathBuf;

fn program(text: &str) -> Result<Program, BehaviourError> {
    let known = |leaf: &str| (leaf == "go").then_some(0);
    compile("guard.ron", text, &mut Names::default(), known)
}

#[test]
fn each_tree_has_room_of_its_own() {
    // Forty trees of two thousand cooldowns: what they keep is counted by each alone.
    let many = r#"Cooldown(1.0, Do("go")),"#.repeat(2000);
    let mut trees = format!(r#""a": Sequence([{many}]),"#);
    for i in 0..40 {
        trees += &format!(r#""t{i}": Use("a"),"#);
    }
    let text = format!(r#"(root: "a", trees: {{{trees}}})"#);
    assert_eq!(program(&text).expect("it is small").len(), 4001);
    // A root is looked at as every tree is, and not counted twice for that.
    let many: String = (0..40_000).map(|i| format!(r#""p{i}": {i},"#)).collect();
    let text = format!(r#"(root: "r", trees: {{"r": DoWith("go", {{{many}}})}})"#);
    assert_eq!(program(&text).expect("there is room").len(), 1);
    let factors = "Always(1.0),".repeat(40_000);
    let choose = format!(r#"Choose([([{factors}], Do("go"))])"#);
    let text = format!(r#"(root: "r", trees: {{"r": {choose}}})"#);
    assert_eq!(program(&text).expect("there is room").len(), 2);
    let text = format!(r#"(root: "r", trees: {{"r": Sequence([{choose}, {choose}])}})"#);
    assert!(program(&text).is_err(), "one tree has too many");
}

/// What agents said since the last time, by name.
fn heard(app: &mut App) -> Vec<Key> {
    said(app).into_iter().map(|(_, name)| name).collect()
}

fn key(app: &mut App, name: &str) -> Key {
    app.world_mut().resource_mut::<Names>().intern(name)
}

#[test]
fn a_cooldown_of_a_lifetime_is_one() {
    for seconds in ["1e9", "3e38", "4e7"] {
        let mut app = app();
        let text = format!(r#"(root: "r", trees: {{"r": Cooldown({seconds}, Say("once"))}})"#);
        let id = app.add_behaviour("test", &text).expect("it is good");
        app.world_mut().spawn(Mind::new(id));
        steps(&mut app, 100);
        let once = key(&mut app, "once");
        assert_eq!(heard(&mut app), [once], "{seconds}");
    }
}

fn say(word: &str) -> String {
    format!(r#"(root: "r", trees: {{"r": Say("{word}")}})"#)
}

fn file(name: &str) -> PathBuf {
    let name = format!("dolomite_logic_{name}_{}.ron", std::process::id());
    std::env::temp_dir().join(name)
}

#[test]
fn a_text_that_took_a_files_place_is_not_undone_by_the_file() {
    let mut app = app();
    let path = file("replaced");
    std::fs::write(&path, say("a")).expect("the folder is there");
    app.world_mut().resource_mut::<Behaviours>().watch = true;
    let id = app.load_behaviour(&path).expect("it is good");
    app.world_mut().spawn(Mind::new(id));
    let name = path.display().to_string();
    let again = app.add_behaviour(&name, &say("b")).expect("it is good");
    assert_eq!(again, id);
    steps(&mut app, 65);
    let b = key(&mut app, "b");
    assert!(heard(&mut app).iter().all(|word| *word == b));
    // The file takes the place of the text, and from then on counts.
    assert_eq!(app.load_behaviour(&path).expect("it is good"), id);
    // A text that is refused leaves all as it is.
    app.add_behaviour(&name, "nothing").expect_err("it is none");
    std::fs::write(&path, say("changed")).expect("the folder is there");
    steps(&mut app, 65);
    let changed = key(&mut app, "changed");
    assert_eq!(heard(&mut app).last(), Some(&changed));
    std::fs::remove_file(&path).expect("it was written");
}
