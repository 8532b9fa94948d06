//! `dolomite fbx2gltf`: an FBX file to a .glb or .gltf, with what it cost and lost.

use std::fmt::Write as _;
use std::io::{IsTerminal, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use clap::{Args, ValueEnum};
use dolomite::fbx::{
    Compression, Conversion, Effort, FbxError, Options, Origin, Output, Progress, Report, Weights,
    convert,
};

/// Convert an FBX file to glTF and say how exact the result is.
///
/// Reads binary and ASCII FBX of version 3000 to 7700. The error is that of the played keys against the
/// file's own curves, at the skin: at 3 cm around each joint, or at the farthest vertex that follows it.
#[derive(Args)]
#[command(after_help = "Examples:\n  \
    dolomite fbx2gltf hero.fbx hero.glb\n  \
    dolomite fbx2gltf hero.fbx hero.gltf --max-error 0.001 --report hero.json\n\n\
    Pictures that are not embedded are looked for where the file says, beside it, in NAME.fbm, Textures and\n  \
    Texture there, and below each folder of --textures; in any case of their names, and nowhere else.")]
pub struct Fbx2gltf {
    /// The FBX file.
    #[arg(value_name = "IN.fbx")]
    input: PathBuf,
    /// What to write: .glb, or .gltf with its buffer and pictures beside it.
    #[arg(value_name = "OUT.glb")]
    output: PathBuf,
    /// How far the skin may be from where the file has it [default: 0.0001, and 5e-6 of the model's
    /// size where that is less].
    #[arg(long, value_name = "METRES")]
    max_error: Option<f64>,
    /// Joints that a vertex may follow; most renderers, Bevy's too, draw four.
    #[arg(long, value_enum, default_value_t = Joints::Four)]
    weights: Joints,
    /// Hold what happens within a frame to the bound too, where the file has a key in every frame.
    #[arg(long)]
    within_frames: bool,
    /// How long keys are searched for: quick takes about twice as long as reading the file, thorough some
    /// thirty times that, for up to two fifths less bytes of keys within the same error.
    #[arg(long, value_enum, default_value_t = Search::Thorough)]
    effort: Search,
    /// Memory that the file may take [default: 48 and 16 times what it unpacks to]; what needs more is
    /// refused.
    #[arg(long, value_name = "MIB")]
    max_memory: Option<usize>,
    /// A folder to look for pictures in, and in the folders below it; may be given more than once.
    #[arg(long, value_name = "DIR")]
    textures: Vec<PathBuf>,
    /// How bytes are written: plain, or under EXT_meshopt_compression, for a third to three fifths of the bytes of
    /// clips within the same error, and plain where that is no larger. three.js and Babylon.js read that; Bevy's
    /// loader does not.
    #[arg(long, value_enum, default_value_t = Compress::None)]
    compress: Compress,
    /// Write everything that is known about the result, as JSON.
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
}

/// How many joints a vertex may follow.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Joints {
    /// `JOINTS_0`
    #[value(name = "4")]
    Four,
    /// `JOINTS_0` and `JOINTS_1`
    #[value(name = "8")]
    Eight,
}

/// How bytes are written.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Compress {
    /// As plain numbers.
    None,
    /// By `EXT_meshopt_compression`.
    Meshopt,
}

/// How long keys are searched for.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Search {
    /// Channel by channel.
    Quick,
    /// All channels of a clip together.
    Thorough,
}

/// Progress is shown from so long on.
const PATIENCE: Duration = Duration::from_millis(500);

impl Fbx2gltf {
    /// Converts, writes and prints.
    ///
    /// # Errors
    /// [`FbxError`], naming the file and the way out.
    pub fn run(&self) -> Result<(), FbxError> {
        let bytes = std::fs::read(&self.input).map_err(|source| FbxError::Read {
            path: self.input.clone(),
            source,
        })?;
        for folder in &self.textures {
            // A folder that is not there is a slip of the one who named it.
            std::fs::read_dir(folder).map_err(|source| FbxError::Read {
                path: folder.clone(),
                source,
            })?;
        }
        let origin = Origin {
            name: self.input.display().to_string(),
            folder: Some(folder_of(&self.input)),
            textures: self.textures.clone(),
            ..Origin::default()
        };
        let shown = Mutex::new(Shown::new());
        let tell = |progress: Progress| {
            if let Ok(mut shown) = shown.lock() {
                shown.show(progress);
            }
        };
        let made = convert(&bytes, &origin, &self.options(&tell));
        if let Ok(shown) = shown.lock() {
            shown.clear();
        }
        let made = made?;
        let output = made.write(&self.output)?;
        if let Some(path) = &self.report {
            let json = serde_json::to_vec_pretty(&made.report).expect("a report is plain data");
            std::fs::write(path, json).map_err(|source| FbxError::Write {
                path: path.clone(),
                source,
            })?;
        }
        print!("{}", table(&made, &output));
        Ok(())
    }

    fn options<'a>(&self, tell: &'a (dyn Fn(Progress) + Sync)) -> Options<'a> {
        let defaults = Options::default();
        Options {
            max_error: self.max_error.unwrap_or(defaults.max_error),
            // What is asked for in metres is meant in metres.
            max_relative_error: match self.max_error {
                Some(_) => f64::INFINITY,
                None => defaults.max_relative_error,
            },
            weights: match self.weights {
                Joints::Four => Weights::Four,
                Joints::Eight => Weights::Eight,
            },
            within_frames: self.within_frames,
            effort: match self.effort {
                Search::Quick => Effort::Quick,
                Search::Thorough => Effort::Thorough,
            },
            max_memory: self.max_memory.map(|mib| mib.saturating_mul(1 << 20)),
            compress: match self.compress {
                Compress::None => Compression::None,
                Compress::Meshopt => Compression::Meshopt,
            },
            progress: Some(tell),
            ..defaults
        }
    }
}

fn folder_of(file: &Path) -> PathBuf {
    match file.parent() {
        Some(folder) if folder != Path::new("") => folder.to_owned(),
        _ => PathBuf::from("."),
    }
}

/// The progress line, once a conversion takes long.
struct Shown {
    began: Instant,
    last: Instant,
    terminal: bool,
    any: bool,
}

impl Shown {
    fn new() -> Self {
        let now = Instant::now();
        Self {
            began: now,
            last: now,
            terminal: std::io::stderr().is_terminal(),
            any: false,
        }
    }

    fn show(&mut self, progress: Progress) {
        let due = if self.terminal {
            PATIENCE / 5
        } else {
            PATIENCE * 10
        };
        if self.began.elapsed() < PATIENCE || self.last.elapsed() < due {
            return;
        }
        self.last = Instant::now();
        self.any = true;
        let (begin, end) = if self.terminal {
            ("\r", "\x1b[K")
        } else {
            ("", "\n")
        };
        let share = 100.0 * progress.done.clamp(0.0, 1.0);
        eprint!("{begin}{:<10} {share:3.0} %{end}", progress.stage);
        // A line that cannot be shown is no reason to stop.
        let _ = std::io::stderr().flush();
    }

    fn clear(&self) {
        if self.any && self.terminal {
            eprint!("\r\x1b[K");
        }
    }
}

/// The table at the end: what was made, then each clip, then what is lost.
fn table(made: &Conversion, output: &Output) -> String {
    let report = &made.report;
    let mut text = String::new();
    let mut row = |name: &str, value: String| {
        writeln!(text, "{name:<14} {value}").expect("a String takes everything that is written");
    };
    row("nodes", report.nodes.to_string());
    row("joints", report.joints.to_string());
    row(
        "vertices",
        format!("{} in {} triangles", report.vertices, report.triangles),
    );
    row("clips", report.clips.len().to_string());
    row(
        "keys",
        format!("{} of {} baked", report.keys(), report.baked()),
    );
    row("error", error_row(report));
    row("bytes", bytes_row(report, output));
    if report.clips.len() > 1 {
        for clip in &report.clips {
            let keys = format!("{} of {} keys", clip.keys, clip.baked);
            row(
                "  clip",
                format!(
                    "{}: {:.2} s, {keys}, {:.1e} m",
                    clip.name, clip.seconds, clip.error
                ),
            );
        }
    }
    if report.refitted > 0 {
        let (fitted, largest) = (report.weight_error, report.largest_weights_error);
        row(
            "weights",
            format!(
                "{} vertices fitted to fewer joints: {fitted:.1e} m (largest weights: {largest:.1e} m)",
                report.refitted
            ),
        );
    }
    for lost in &report.lost {
        let size = lost
            .metres
            .map_or_else(String::new, |metres| format!(", {metres:.1e} m"));
        row(
            "lost",
            format!("{} {:?}{size}: {}", lost.what, lost.name, lost.detail),
        );
    }
    text
}

fn bytes_row(report: &Report, output: &Output) -> String {
    let how = match report.compression {
        Compression::None if report.plain_is_smaller => {
            ", plain, which is no larger than compressed"
        }
        Compression::None => "",
        Compression::Meshopt => ", under EXT_meshopt_compression",
    };
    let (all, clips) = (output.bytes, report.animation_bytes);
    format!("{all} ({clips} of animation){how}")
}

fn error_row(report: &Report) -> String {
    format!(
        "{:.1e} m (keys held to {:.1e} m)",
        report.error(),
        report.bound
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        convert: Fbx2gltf,
    }

    fn parse(words: &str) -> Result<Fbx2gltf, clap::Error> {
        Line::try_parse_from(["x"].into_iter().chain(words.split_whitespace()))
            .map(|line| line.convert)
    }

    #[test]
    fn an_error_in_metres_is_meant_in_metres() {
        let tell = |_: Progress| {};
        let parsed = parse("a.fbx b.glb --max-error 0.01 --weights 8").unwrap();
        let options = parsed.options(&tell);
        assert_eq!((options.max_error, options.weights), (0.01, Weights::Eight));
        assert_eq!(options.max_relative_error, f64::INFINITY);
        assert_eq!(options.effort, Effort::Thorough);
        assert_eq!(options.compress, Compression::None);
        let packed = parse("a.fbx b.glb --compress meshopt").unwrap();
        assert_eq!(packed.options(&tell).compress, Compression::Meshopt);
        let quick = parse("a.fbx b.glb --effort quick").unwrap();
        assert_eq!(quick.options(&tell).effort, Effort::Quick);
        let parsed = parse("a.fbx b.glb").unwrap();
        assert!(parsed.options(&tell).max_relative_error < 1e-3);
        assert_eq!(parsed.options(&tell).max_memory, None);
        let raised = parse("a.fbx b.glb --max-memory 512").unwrap();
        assert_eq!(raised.options(&tell).max_memory, Some(512 << 20));
        assert!(parse("a.fbx b.glb --weights 5").is_err());
        assert!(parse("a.fbx").is_err());
    }

    #[test]
    fn a_file_that_is_not_there_is_named() {
        let refusal = parse("no/such.fbx b.glb")
            .unwrap()
            .run()
            .unwrap_err()
            .to_string();
        assert!(refusal.contains("no/such.fbx"), "{refusal}");
    }

    #[test]
    fn folders_of_pictures_may_be_several_and_have_to_be_there() {
        let parsed = parse("a.fbx b.glb --textures art --textures ../lib").unwrap();
        let wanted = [PathBuf::from("art"), PathBuf::from("../lib")];
        assert_eq!(parsed.textures, wanted);
        let folder = std::env::temp_dir().join(format!("dolomite_textures_{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let input = folder.join("a.fbx");
        std::fs::write(&input, "x").unwrap();
        let words = format!("{} b.glb --textures no/such/folder", input.display());
        let refusal = parse(&words).unwrap().run().unwrap_err().to_string();
        assert!(refusal.contains("no/such/folder"), "{refusal}");
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn a_negative_error_is_refused() {
        let folder = std::env::temp_dir().join(format!("dolomite_fbx2gltf_{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let input = folder.join("a.fbx");
        std::fs::write(&input, "x").unwrap();
        let words = format!("{} b.glb --max-error=-1", input.display());
        let refusal = parse(&words).unwrap().run().unwrap_err();
        assert!(matches!(refusal, FbxError::Option { .. }), "{refusal}");
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn files_without_a_folder_lie_in_this_one() {
        assert_eq!(folder_of(Path::new("a.fbx")), Path::new("."));
        assert_eq!(folder_of(Path::new("b/a.fbx")), Path::new("b"));
    }
}
