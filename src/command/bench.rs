//! `dolomite bench` on the command line.

use std::path::PathBuf;

use bevy::math::UVec2;
use clap::Args;
use dolomite_game::bench::classic::methods::MethodError;
use dolomite_game::bench::{BenchError, path};
use dolomite_game::run::Setup;

use super::scene::SceneArgs;
use super::values::Size;

/// Fly a fixed path without a window and write what each frame cost.
#[derive(Args)]
pub struct Bench {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// The path to fly.
    #[arg(long, value_enum, required_unless_present = "matrix")]
    path: Option<path::Path>,
    /// Size of the picture [default: 1920x1080; 1280x720 for the classic scene].
    #[arg(long, value_name = "WIDTHxHEIGHT")]
    size: Option<Size>,
    /// Number of frames, a sixtieth of a second of the path each [default: 300; 120 for the classic
    /// scene].
    #[arg(long)]
    frames: Option<u32>,
    /// The report to write [default: standard output; with --matrix a table alone].
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Turns in which each part of a frame is switched off and on, to say what it costs alone; 0: not at all.
    #[arg(
        long,
        value_name = "TURNS",
        default_value_t = 3,
        conflicts_with = "matrix"
    )]
    parts: u32,
    /// With `--path start`: start the game in a window of this size, as a player does.
    #[arg(long, conflicts_with = "matrix")]
    pub window: bool,
    /// Compare every way to make the triangles of the classic scene, or of a scene with a city, filled and as
    /// lines, and print a table.
    #[arg(long, conflicts_with_all = ["mode", "lines", "no_fill"])]
    pub matrix: bool,
}

impl Bench {
    /// The path to fly.
    pub fn path(&self) -> path::Path {
        self.path.unwrap_or(if self.scene.is_classic() {
            path::Path::Orbit
        } else {
            path::Path::Walk
        })
    }

    /// Size of the picture, pixels.
    pub fn size(&self) -> UVec2 {
        let default = match self.scene.is_classic() {
            true => UVec2::new(1280, 720),
            false => UVec2::new(1920, 1080),
        };
        self.size.map_or(default, |Size(size)| size)
    }

    /// Number of frames.
    pub fn frames(&self) -> u32 {
        self.frames
            .unwrap_or(if self.scene.is_classic() { 120 } else { 300 })
    }

    /// Turns in which parts are switched.
    pub const fn turns(&self) -> u32 {
        self.parts
    }

    /// Settings and scene.
    ///
    /// # Errors
    /// [`BenchError`], naming the file and the reason.
    pub fn setup(&self) -> Result<Setup, BenchError> {
        let mut setup = self.scene.setup(None, |settings| settings.panel = false)?;
        if self.matrix && !self.scene.is_classic() && setup.scene.city.is_none() {
            return Err(MethodError::OtherScene(setup.scene.name.clone()).into());
        }
        match self.path {
            Some(path::Path::Start) if self.matrix => {
                return Err(BenchError::Start(
                    "measures one way to start; leave --matrix out",
                ));
            }
            Some(path::Path::Start) => {}
            _ if self.window => {
                return Err(BenchError::Start(
                    "alone is measured in a window; leave --window out",
                ));
            }
            _ => {}
        }
        // Its part is measured by showing it.
        let parts =
            self.path != Some(path::Path::Start) && self.parts > 0 && setup.scene.own.is_none();
        setup.panels = self.window || parts;
        if self.window {
            let size = self.size();
            setup.settings.window = (size.x, size.y);
        }
        Ok(setup)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Command, Line};
    use super::*;
    use clap::Parser;
    use dolomite_game::bench::classic::methods::{Metric, Mode};

    fn bench_of(arguments: &str) -> Result<Bench, clap::Error> {
        let words = ["dolomite", "bench"]
            .into_iter()
            .chain(arguments.split(' '));
        match Line::try_parse_from(words)?.command {
            Some(Command::Bench(bench)) => Ok(bench),
            _ => panic!("`bench` is the bench"),
        }
    }

    #[test]
    fn the_bench_knows_the_classic_scene() {
        let bench = bench_of(
            "--scene classic --path orbit --metric edge --tau 3 --mode static-cpu --json f.json",
        )
        .unwrap();
        assert_eq!(
            (bench.scene.classic.mode, bench.scene.classic.metric),
            (Mode::StaticCpu, Metric::Edge)
        );
        assert_eq!((bench.size(), bench.frames()), (UVec2::new(1280, 720), 120));
        let other = bench_of("--path fly --json f.json").unwrap();
        assert_eq!(
            (other.size(), other.frames()),
            (UVec2::new(1920, 1080), 300)
        );
        let matrix = bench_of("--scene classic --matrix --frames 12 --size 64x48").unwrap();
        assert_eq!(
            (matrix.path(), matrix.json.as_ref()),
            (path::Path::Orbit, None)
        );
        assert_eq!((matrix.size(), matrix.frames()), (UVec2::new(64, 48), 12));
        for wrong in [
            "--scene classic --json f.json",
            "--scene classic --matrix --window",
            "--scene classic --matrix --mode cpu",
            "--scene classic --path orbit --json f.json --metric best",
        ] {
            assert!(bench_of(wrong).is_err(), "{wrong} was accepted");
        }
    }

    #[test]
    fn methods_are_refused_with_reasons() {
        let refused = |arguments: &str| {
            let bench = bench_of(arguments).unwrap();
            bench.setup().err().expect("refused").to_string()
        };
        for (arguments, words) in [
            ("--path fly --json f --mode cpu", "--scene classic"),
            ("--matrix", "--scene classic"),
            ("--path fly --window", "--path start"),
            (
                "--scene classic --data no/such --path orbit --json f",
                "no/such/data/classic/heights",
            ),
        ] {
            let error = refused(arguments);
            assert!(error.contains(words), "{error} does not say {words}");
        }
    }
}
