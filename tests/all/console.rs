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
    use image::RgbImage;
    use std::process::{Child, Stdio};
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
    fn has_scene(picture: &RgbImage) -> bool {
        let dark = picture.pixels().filter(|p| p.0.iter().all(|c| *c < 60));
        dark.count() < picture.pixels().len() / 2
    }

    /// The grey of what the inspector's windows are filled with, by egui's dark style.
    fn is_filled(picture: &RgbImage, x: u32, y: u32) -> bool {
        picture
            .get_pixel(x, y)
            .0
            .iter()
            .all(|c| (20..=34).contains(c))
    }

    /// The inspector's panel is open: it lies over the left of the window, from top to bottom.
    fn has_panel(picture: &RgbImage) -> bool {
        let share = |x: u32| {
            let rows = 60..picture.height() - 80;
            let count = rows.len();
            rows.filter(|y| is_filled(picture, x, *y)).count() as f32 / count as f32
        };
        // Left of its text.
        share(16) > 0.8
    }

    /// The console is open: it lies over the foot of the window, from side to side.
    fn has_console(picture: &RgbImage) -> bool {
        let y = picture.height() - 60;
        let columns = picture.width() * 2 / 3..picture.width() - 40;
        let count = columns.len();
        columns.filter(|x| is_filled(picture, *x, y)).count() * 10 > count * 8
    }

    /// Middles of the rails of sliders, as egui's dark style draws them: bars of one grey that are thinner than a button.
    fn rails(picture: &RgbImage) -> Vec<(u32, u32)> {
        let is_rail = |x: u32, y: u32| picture.get_pixel(x, y).0 == [60, 60, 60];
        // The first and the last row of the grey above and below a pixel.
        let rows = |x: u32, y: u32| {
            let up = (0..y).rev().take_while(|y| is_rail(x, *y)).count() as u32;
            let down = (y..picture.height()).take_while(|y| is_rail(x, *y)).count() as u32;
            (y - up, y + down)
        };
        let mut found: Vec<(u32, u32)> = Vec::new();
        for y in 0..picture.height() {
            let mut x = 0;
            while x < picture.width() {
                let run = (x..picture.width()).take_while(|x| is_rail(*x, y)).count() as u32;
                if run >= 30 {
                    let [one, middle, three] =
                        [1, 2, 3].map(|quarter| rows(x + quarter * run / 4, y));
                    let height = one.1 - one.0;
                    if one == middle && middle == three && one.0 == y && (5..=10).contains(&height)
                    {
                        found.push((x + run / 2, y + height / 2));
                    }
                }
                x += run.max(1);
            }
        }
        found
    }

    /// A game in a window, its hand, and what it says.
    struct Played {
        game: Child,
        display: Display,
        said: PathBuf,
        began: Instant,
    }

    impl Drop for Played {
        fn drop(&mut self) {
            // It may have left by itself.
            let _ = self.game.kill();
            let _ = self.game.wait();
        }
    }

    impl Played {
        fn said(&self) -> String {
            std::fs::read_to_string(&self.said).unwrap_or_default()
        }

        /// Waits for something; nothing here is timed, since the machine may do other work.
        fn until(&mut self, what: &str, mut is: impl FnMut(&Self) -> bool) {
            let asked = Instant::now();
            while !is(self) {
                let ended = self.game.try_wait().expect("it is our child");
                assert!(
                    asked.elapsed() < PICTURE && ended.is_none(),
                    "{what}: not after {:?}, of {:?} in all; ended: {ended:?}\n{}",
                    asked.elapsed(),
                    self.began.elapsed(),
                    self.said()
                );
                std::thread::sleep(Duration::from_millis(50));
            }
            eprintln!("{what} after {:?}", self.began.elapsed());
        }

        /// Waits until the picture is so.
        fn shows(&mut self, what: &str, is: impl Fn(&RgbImage) -> bool) {
            self.until(what, |played| is(&played.display.picture()));
        }

        fn hand(&self, arguments: &[&str]) {
            let done = self.display.hand(arguments);
            assert!(done.is_some(), "xdotool {arguments:?}");
        }

        /// With `DOLOMITE_PICTURES` pictures are kept in that folder.
        fn keep(&self, name: &str) {
            if let Some(folder) = std::env::var_os("DOLOMITE_PICTURES") {
                let file = Path::new(&folder).join(name);
                let kept = self.display.picture().save(file);
                kept.expect("the folder can be written");
            }
        }

        /// The newest answer about the sun: azimuth and elevation, degrees.
        fn sun(&self) -> (usize, [f32; 2]) {
            let said = self.said();
            let answers = |name: &str| -> Vec<f32> {
                let lines = said.lines().filter(|line| line.starts_with("Sun@"));
                let lines = lines.filter(|line| line.contains(name));
                let numbers = lines.filter_map(|line| line.split(' ').nth(1)?.parse().ok());
                numbers.collect()
            };
            let (azimuth, elevation) = (answers(".azimuth"), answers(".elevation"));
            let newest = |list: &[f32]| list.last().copied().unwrap_or(f32::NAN);
            (
                azimuth.len() + elevation.len(),
                [newest(&azimuth), newest(&elevation)],
            )
        }

        /// Types a line into the open console, again where keys were lost.
        fn types(&mut self, line: &str) {
            let (before, _) = self.sun();
            for _ in 0..5 {
                self.hand(&["type", "--delay", "60", line]);
                self.hand(&["key", "Return"]);
                let asked = Instant::now();
                while asked.elapsed() < Duration::from_secs(20) {
                    if self.sun().0 > before {
                        return;
                    }
                    std::thread::sleep(Duration::from_millis(50));
                }
                self.hand(&["key", "ctrl+a", "BackSpace"]);
            }
            panic!("{line}: no answer\n{}", self.said());
        }
    }

    fn play() -> Option<Played> {
        if !adapter::is_there() {
            return None;
        }
        let display = Display::open("inspector", 800, 500)?;
        let folder = folder("window");
        let script = folder.join("start.txt");
        // The panel opens on what is registered; a filter shows the sun alone.
        std::fs::write(
            &script,
            "views panel off\ninspect settings --filter components::Sun\ninspect off\nget Sun.azimuth\nget Sun.elevation\n",
        )
        .expect("the folder is ours");
        let said = folder.join("said.txt");
        let out = std::fs::File::create(&said).expect("the folder is ours");
        let words = [
            "--scene",
            "mountain",
            "--size",
            "800x500",
            "--max-error",
            "16",
            "--preset",
            "software",
            "--resolution",
            "0.25",
        ];
        let game = dolomite(&words, &script)
            .env("DISPLAY", display.name())
            .env_remove("WAYLAND_DISPLAY")
            .stdout(Stdio::from(out))
            .spawn()
            .expect("it is built");
        Some(Played {
            game,
            display,
            said,
            began: Instant::now(),
        })
    }

    /// The window as a person has it: F10, a slider pulled, the console opened, a line typed. With `DOLOMITE_PICTURES`
    /// its pictures are kept in that folder.
    #[test]
    fn in_the_window_a_slider_is_pulled_and_a_command_typed() {
        let Some(mut played) = play() else { return };
        let mut id = None;
        played.until("a window", |played| {
            id = played
                .display
                .hand(&["search", "--onlyvisible", "--name", "Dolomite"]);
            id.is_some()
        });
        // Nobody manages windows here who would do it.
        played.hand(&["windowfocus", &id.expect("found")]);
        played.until("the script", |played| played.sun().0 == 2);
        played.shows("the scene", has_scene);
        let (_, before) = played.sun();

        played.hand(&["key", "F10"]);
        played.shows("the panel", |picture| {
            has_panel(picture) && rails(picture).len() >= 2
        });
        played.keep("panel.png");
        let (x, y) = rails(&played.display.picture())[0];
        let to =
            |played: &Played, x: u32| played.hand(&["mousemove", &x.to_string(), &y.to_string()]);
        // Each step is seen by some frame: egui knows a place only once a frame was there.
        let frames = Duration::from_millis(700);
        to(&played, x - 20);
        std::thread::sleep(frames);
        played.hand(&["mousedown", "1"]);
        for step in 0..4 {
            to(&played, x - 10 + 5 * step);
            std::thread::sleep(frames);
        }
        played.hand(&["mouseup", "1"]);
        std::thread::sleep(frames);

        played.hand(&["key", "F10"]);
        played.shows("no panel", |picture| !has_panel(picture));
        played.hand(&["key", "grave"]);
        played.shows("the console", has_console);
        played.types("get Sun.azimuth");
        played.types("get Sun.elevation");
        played.keep("console.png");
        let (answers, after) = played.sun();
        assert!(answers >= 4);
        assert_ne!(before, after, "the slider was pulled\n{}", played.said());
        // It is a range.
        assert!((-360.0..=360.0).contains(&after[0]) && (-90.0..=90.0).contains(&after[1]));

        played.hand(&["key", "Escape"]);
        played.shows("no console", |picture| !has_console(picture));
        assert_eq!(
            played.game.try_wait().expect("it is our child"),
            None,
            "Escape closes the console first"
        );
        played.hand(&["key", "Escape"]);
        let asked = Instant::now();
        while played.game.try_wait().expect("it is our child").is_none() {
            assert!(
                asked.elapsed() < Duration::from_secs(60),
                "it does not leave"
            );
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}
