//! The game's console: its commands without a renderer, its scripts by the built binary, its window by a hand.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use dolomite::DolomiteMinimalPlugins;
use dolomite::inspector::Console;
use dolomite::inspector::console::Tone;
use dolomite_game::console::ConsolePlugin;
use dolomite_game::play::camera::FreeCamera;
use dolomite_game::play::figure::Figure;
use dolomite_game::play::{SimulationPlugin, Switches};
use dolomite_game::scene::{self, CurrentScene, SceneRequest};
use dolomite_game::settings::Settings;
use dolomite_game::settings::paths::AssetsDir;

fn assets() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("assets")
}

fn game() -> App {
    let request = SceneRequest::new("mountain");
    let loaded = scene::load(&request, &assets()).expect("the scene is good");
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        TransformPlugin,
        bevy::diagnostic::DiagnosticsPlugin,
        DolomiteMinimalPlugins,
    ))
    .insert_resource(AssetsDir(assets()))
    .insert_resource(request)
    .insert_resource(CurrentScene(loaded))
    .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(
        20,
    )))
    .add_plugins((SimulationPlugin, ConsolePlugin));
    app.finish();
    app.cleanup();
    app.update();
    app
}

/// What the console says to a line: its words, or the fault.
fn say(app: &mut App, line: &str) -> Result<String, String> {
    let before = app.world().resource::<Console>().lines_said();
    app.world_mut().resource_mut::<Console>().enter(line);
    for _ in 0..2000 {
        app.update();
        if app.world().resource::<Console>().queue.is_empty() {
            break;
        }
    }
    let console = app.world().resource::<Console>();
    assert!(console.queue.is_empty(), "{line}: it still waits");
    let new = (console.lines_said() - before) as usize;
    let skipped = console.output().len() - new;
    let lines: Vec<_> = console.output().skip(skipped).collect();
    let text: Vec<_> = lines
        .iter()
        .filter(|(tone, _)| *tone != Tone::Typed)
        .map(|(_, line)| *line)
        .collect();
    let text = text.join("\n");
    if lines.iter().any(|(tone, _)| *tone == Tone::Fault) {
        Err(text)
    } else {
        Ok(text)
    }
}

fn camera(app: &mut App) -> FreeCamera {
    let world = app.world_mut();
    *world
        .query::<&FreeCamera>()
        .single(world)
        .expect("there is one camera")
}

fn figure(app: &mut App) -> Figure {
    let world = app.world_mut();
    *world
        .query::<&Figure>()
        .single(world)
        .expect("there is one figure")
}

#[test]
fn another_scene_is_shown_with_its_camera_and_its_figure() {
    let mut app = game();
    let before = camera(&mut app);
    assert!(
        say(&mut app, "scene jacksboro")
            .unwrap()
            .contains("jacksboro")
    );
    let shown = app.world().resource::<CurrentScene>().0.clone();
    assert_eq!(shown.name, "jacksboro");
    assert_ne!(camera(&mut app).pose, before.pose);
    let place = figure(&mut app).now.place;
    assert!(shown.terrain.extent().contains(place), "{place}");
    for (wrong, word) in [
        ("scene nowhere", "mountain"),
        ("scene no/such.ron", "no/such.ron"),
        ("scene", "Usage"),
    ] {
        let fault = say(&mut app, wrong).unwrap_err();
        assert!(fault.contains(word), "{wrong}: {fault}");
        assert_eq!(app.world().resource::<CurrentScene>().name, "jacksboro");
    }
}

#[test]
fn the_camera_goes_where_it_is_sent() {
    let mut app = game();
    app.world_mut().resource_mut::<Switches>().follow = true;
    say(&mut app, "go 10 3000 -20.5 90 -45").unwrap();
    let pose = camera(&mut app).pose;
    assert_eq!(
        (pose.position.x, pose.position.y, pose.position.z),
        (10.0, 3000.0, -20.5)
    );
    assert!((pose.pitch + std::f32::consts::FRAC_PI_4).abs() < 1e-6);
    for wrong in [
        "go 1 2 3 4",
        "go 1 2 3 4 5 6",
        "go 1 2 x 4 5",
        "go NaN 0 0 0 0",
        "go 0 0 0 0 91",
        "go 0 0 0 inf 0",
        "go 1e8 0 0 0 0",
    ] {
        say(&mut app, wrong).expect_err(wrong);
        assert_eq!(camera(&mut app).pose, pose, "{wrong}");
    }
}

#[test]
fn the_bot_walks_as_far_as_it_is_told() {
    let mut app = game();
    let speed = f64::from(app.world().resource::<Settings>().walk_speed);
    let before = figure(&mut app).now.place;
    say(&mut app, "bot 1 --seconds 2").unwrap();
    let walked = (figure(&mut app).now.place - before).length();
    // In two seconds, less what it takes to set off; along the ground, which may rise.
    assert!((0.6 * speed..2.05 * speed).contains(&walked), "{walked} m");
    say(&mut app, "wait 60").unwrap();
    let rested = figure(&mut app).now.place;
    say(&mut app, "wait 20").unwrap();
    assert!(
        (figure(&mut app).now.place - rested).length() < 1e-3,
        "it let go"
    );
    for wrong in ["bot", "bot 2", "bot 1 nan", "bot 1 --seconds -1", "bot x"] {
        say(&mut app, wrong).expect_err(wrong);
    }
}

#[test]
fn settings_and_views_of_the_game_are_reached() {
    let mut app = game();
    say(&mut app, "set Settings.max_error 4").unwrap();
    say(&mut app, "set Settings.renderer Dolomite").unwrap();
    assert_eq!(app.world().resource::<Settings>().max_error, Some(4.0));
    say(&mut app, "views lines on").unwrap();
    say(&mut app, "views shapes").unwrap();
    let switches = *app.world().resource::<Switches>();
    assert!(switches.lines && switches.shapes && switches.fill);
    assert!(
        say(&mut app, "bench --frames 5")
            .unwrap()
            .contains("median")
    );
    assert!(say(&mut app, "bench --frames 1").is_err());
}

#[cfg(target_os = "linux")]
mod gpu {
    use super::*;
    use crate::support::adapter;
    use crate::support::display::Display;
    use std::process::Stdio;
    use std::time::Instant;

    /// Software Vulkan on two busy cores compiles the passes of the first picture within this.
    const PICTURE: Duration = Duration::from_secs(240);

    fn folder(name: &str) -> PathBuf {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        std::fs::create_dir_all(&folder).expect("the test's folder can be written");
        folder
    }

    fn dolomite(words: &[&str], script: &Path) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_dolomite"));
        command
            .args(words)
            .arg("--exec")
            .arg(script)
            .env("XDG_CONFIG_HOME", env!("CARGO_TARGET_TMPDIR"))
            .current_dir(env!("CARGO_MANIFEST_DIR"));
        command
    }

    #[test]
    fn a_script_is_done_without_a_window_and_stops_at_its_mistake() {
        if !adapter::is_there() {
            return;
        }
        let folder = folder("script");
        let (script, one, two) = (
            folder.join("good.txt"),
            folder.join("one.png"),
            folder.join("two.png"),
        );
        let text = format!(
            "shot '{}'\nset Sun.azimuth 300\nset Settings.max_error 8\nstat --plugins\nbot 0.5 --seconds 0.2\n",
            one.display()
        );
        std::fs::write(&script, &text).expect("the folder is ours");
        let out = two.display().to_string();
        let words = [
            "shot",
            "--size",
            "160x90",
            "--max-error",
            "8",
            "--out",
            &out,
        ];
        let run = dolomite(&words, &script).output().expect("it is built");
        let said = String::from_utf8_lossy(&run.stdout) + String::from_utf8_lossy(&run.stderr);
        assert!(run.status.success(), "{said}");
        assert!(
            said.contains("> stat --plugins") && said.contains("geometry"),
            "{said}"
        );
        let picture = |path: &Path| image::open(path).expect("it was written").into_rgb8();
        assert_ne!(picture(&one), picture(&two), "the sun went on");

        std::fs::write(&script, format!("{text}sett x\nquit\n")).expect("the folder is ours");
        let run = dolomite(&words, &script).output().expect("it is built");
        let said = String::from_utf8_lossy(&run.stderr);
        assert_eq!(run.status.code(), Some(1), "{said}");
        assert!(said.contains("good.txt:6:"), "{said}");
        assert!(said.contains("1 more line is left out"), "{said}");

        let run = dolomite(&words, &folder.join("none.txt"))
            .output()
            .expect("it is built");
        let said = String::from_utf8_lossy(&run.stderr);
        assert!(
            run.status.code() == Some(1) && said.contains("none.txt"),
            "{said}"
        );
    }

    /// Ground and sky: few pixels are as dark as the start screen.
    fn has_scene(display: &Display) -> bool {
        let picture = display.picture();
        let dark = picture.pixels().filter(|p| p.0.iter().all(|c| *c < 60));
        dark.count() < picture.pixels().len() / 2
    }

    /// The window as a person has it: F10, a slider pulled, the console opened, a line typed. With `DOLOMITE_PICTURES`
    /// its pictures are kept in that folder.
    #[test]
    #[ignore = "minutes of software Vulkan; `--run-ignored only` runs it"]
    fn in_the_window_a_command_is_typed_and_the_panel_opens_and_closes() {
        if !adapter::is_there() {
            return;
        }
        let Some(display) = Display::open("inspector", 800, 500) else {
            return;
        };
        let folder = folder("window");
        let script = folder.join("start.txt");
        // The panel opens on what is registered; a filter shows the sun alone.
        std::fs::write(&script, "views panel off\n").expect("the folder is ours");
        let said = folder.join("said.txt");
        let out = std::fs::File::create(&said).expect("the folder is ours");
        let words = [
            "--scene",
            "mountain",
            "--size",
            "800x500",
            "--max-error",
            "8",
        ];
        let mut game = dolomite(&words, &script)
            .env("DISPLAY", display.name())
            .env_remove("WAYLAND_DISPLAY")
            .stdout(Stdio::from(out))
            .spawn()
            .expect("it is built");
        let began = Instant::now();
        let mut until = |what: &str, is: &mut dyn FnMut() -> bool| {
            while !is() {
                let late = began.elapsed() > 2 * PICTURE;
                let ended = game.try_wait().expect("it is our child");
                if late || ended.is_some() {
                    let _ = game.kill();
                    let said = std::fs::read_to_string(&said).unwrap_or_default();
                    panic!("{what}: {ended:?} after {:?}\n{said}", began.elapsed());
                }
                std::thread::sleep(Duration::from_millis(100));
            }
        };
        let keep = |name: &str| {
            if let Some(folder) = std::env::var_os("DOLOMITE_PICTURES") {
                let file = Path::new(&folder).join(name);
                display
                    .picture()
                    .save(file)
                    .expect("the folder can be written");
            }
        };
        let mut id = None;
        until("a window", &mut || {
            id = display.hand(&["search", "--onlyvisible", "--name", "Dolomite"]);
            id.is_some()
        });
        display.hand(&["windowfocus", &id.expect("found")]);
        until("the scene", &mut || has_scene(&display));
        let text = || std::fs::read_to_string(&said).unwrap_or_default();
        until("the script", &mut || text().contains("panel off"));
        let key = |key: &str| assert!(display.hand(&["key", key]).is_some(), "{key}");
        let typed = |text: &str| {
            let typed = display.hand(&["type", "--delay", "120", text]);
            assert!(typed.is_some(), "{text}");
        };
        // The console: what it says goes to standard output, since there was a script.
        key("grave");
        std::thread::sleep(Duration::from_secs(3));
        typed("get Sun.azimuth");
        keep("console.png");
        key("Return");
        let azimuth = |text: &str| {
            let line = text.lines().rfind(|line| line.starts_with("Sun@"));
            line.and_then(|line| line.split(' ').nth(1)?.parse::<f32>().ok())
        };
        until("an answer", &mut || azimuth(&text()).is_some());
        assert!((-360.0..=360.0).contains(&azimuth(&text()).expect("just now")));
        key("grave");
        let at = |x: i32, y: i32| {
            display.hand(&["mousemove", &x.to_string(), &y.to_string()]);
            std::thread::sleep(Duration::from_millis(250));
        };
        // Where the panel lies grass is brighter than any part of it between its rows. Sliders are pulled without a
        // window, in the tests of `dolomite_inspector`: on software Vulkan each pull takes seconds.
        let dark = || {
            let picture = display.picture();
            let [r, g, b] = picture.get_pixel(40, 420).0;
            r.max(g).max(b) < 40
        };
        until("grass where the panel will be", &mut || !dark());
        key("F10");
        until("the panel", &mut dark.clone());
        at(130, 80);
        display.hand(&["click", "1"]);
        std::thread::sleep(Duration::from_millis(500));
        typed("components::Sun");
        std::thread::sleep(Duration::from_secs(2));
        keep("panel.png");
        key("Escape");
        until("the panel is gone", &mut || !dark());
        assert_eq!(
            game.try_wait().expect("it is our child"),
            None,
            "Escape closes the panel first"
        );
        key("Escape");
        let asked = Instant::now();
        while game.try_wait().expect("it is our child").is_none() {
            if asked.elapsed() > Duration::from_secs(20) {
                let _ = game.kill();
                panic!("it did not leave");
            }
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}
