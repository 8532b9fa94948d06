//! `dolomite heights`: what a file of elevation is, a picture of it, and conversion.

use std::fmt::Write as _;
use std::path::PathBuf;

use clap::Args;
use dolomite::terrain::elevation::{
    About, Elevation, ElevationError, ElevationProgress, Options, convert, write,
};
use serde::Serialize;

use super::elevation::ReadArgs;

/// Say what a file of elevation is, picture it, convert it.
///
/// Reads PNG, TIFF, GeoTIFF, ESRI ASCII, HGT and raw numbers, with what stands beside them: .aux.xml, world files, .prj, .msk.
#[derive(Args)]
#[command(after_help = "Examples:\n  \
    dolomite heights alps.tif --out relief.png\n  \
    dolomite heights unity.raw --raw-size 4097x4097 --raw-type u16 --raw-order big\n  \
    dolomite heights N36W085.hgt --out jacksboro.f32 --json jacksboro.json")]
pub struct Heights {
    /// The file.
    #[arg(value_name = "FILE")]
    input: PathBuf,
    /// Write what it is, as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write a hillshade (.png), the samples as little-endian floats from north to south with NaN where there is no
    /// data (.f32, .r32), or convert (.tif, .asc, .r16, .raw).
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Metres between samples, in place of what the file says.
    #[arg(long, value_name = "METRES")]
    spacing: Option<f64>,
    #[command(flatten)]
    read: ReadArgs,
}

/// What is known of a file.
#[derive(Serialize)]
struct Report<'a> {
    #[serde(flatten)]
    about: &'a About,
    /// Distance of the samples of the file along x and z, metres.
    spacing_metres: Option<[f64; 2]>,
    /// Columns and rows that were taken.
    taken: [u32; 2],
    /// The coordinate system's name.
    projection: Option<String>,
}

impl Heights {
    /// Reads, writes and prints.
    ///
    /// # Errors
    /// [`ElevationError`], naming the file, the place and a way out.
    pub fn run(&self) -> Result<(), ElevationError> {
        let text = self.make()?;
        print!("{text}");
        Ok(())
    }

    /// As [`Self::run`]; returns what is printed.
    fn make(&self) -> Result<String, ElevationError> {
        let options = self.read.options(self.spacing.is_some());
        let own = self.spacing.map(|metres| [metres; 2]);
        let progress = ElevationProgress::on_stderr();
        // What is larger than memory is read and written row by row; but parts of it may fit.
        let size = Elevation::size(&self.input, &options);
        let is_large = |[columns, rows]: [u32; 2]| {
            u64::from(columns) * u64::from(rows) > Options::MAX_SAMPLES && options.every == 1
        };
        let (about, taken) = if size.is_ok_and(is_large) {
            let to = self.out.as_deref();
            let about = convert(&self.input, to, &options, own, &progress)?;
            let size = about.size;
            (about, size)
        } else {
            let map = Elevation::read_telling(&self.input, &options, &progress)?;
            if let Some(path) = &self.out {
                write(path, &map, own)?;
            }
            (map.about, map.size)
        };
        let spacing = own.or_else(|| about.georeference.as_ref()?.spacing(about.size));
        let report = Report {
            about: &about,
            spacing_metres: spacing,
            taken,
            projection: about.georeference.as_ref().map(|place| place.crs.name()),
        };
        if let Some(path) = &self.json {
            let json = serde_json::to_vec_pretty(&report).expect("a report is plain data");
            std::fs::write(path, json).map_err(|error| ElevationError::Write {
                file: path.display().to_string(),
                reason: error.to_string(),
            })?;
        }
        Ok(table(&report))
    }
}

/// A row for each thing that is known.
fn table(report: &Report<'_>) -> String {
    let about = report.about;
    let mut text = String::new();
    let mut row = |name: &str, value: String| {
        writeln!(text, "{name:<12} {value}").expect("a String takes everything that is written");
    };
    let [columns, rows] = about.size;
    row("file", about.file.clone());
    row("kind", format!("{}, {}", about.kind.name(), about.packing));
    row("size", format!("{columns} x {rows} of {}", about.number));
    if report.taken != about.size {
        row(
            "taken",
            format!("{} x {}", report.taken[0], report.taken[1]),
        );
    }
    if about.bands > 1 {
        row("bands", about.bands.to_string());
    }
    if (about.scale, about.offset) != (1.0, 0.0) {
        row(
            "scale",
            format!("number x {} + {}", about.scale, about.offset),
        );
    }
    let unit = match about.unit_metres {
        Some(1.0) => " m".to_owned(),
        Some(metres) => format!(" units of {metres} m"),
        None => String::new(),
    };
    match about.range {
        Some([low, high]) => row("range", format!("{low} to {high}{unit}")),
        None => row("range", "no sample has data".to_owned()),
    }
    if !about.nodata.is_empty() || about.holes > 0 {
        let numbers: Vec<_> = about.nodata.iter().map(ToString::to_string).collect();
        let numbers = if numbers.is_empty() {
            "what is absent".to_owned()
        } else {
            numbers.join(", ")
        };
        row("no data", format!("{numbers}: {} samples", about.holes));
    }
    if let Some([x, z]) = report.spacing_metres {
        row("spacing", format!("{x:.6} x {z:.6} m"));
    }
    if let Some(place) = &about.georeference {
        row("projection", report.projection.clone().unwrap_or_default());
        row(
            "first sample",
            format!(
                "{}, {}, steps of {} and {}, {:?} registration",
                place.first[0], place.first[1], place.step[0], place.step[1], place.registration
            ),
        );
    }
    for note in &about.notes {
        row("note", note.clone());
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;
    use std::path::Path;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        heights: Heights,
    }

    /// Runs a command as it is typed.
    fn run(line: &str) -> Result<String, String> {
        let words = line
            .strip_prefix("dolomite heights ")
            .expect("it is that command");
        let words = words.split_whitespace().map(|word| word.trim_matches('\''));
        let line =
            Line::try_parse_from(["x"].into_iter().chain(words)).map_err(|e| e.to_string())?;
        line.heights.make().map_err(|error| error.to_string())
    }

    fn file(name: &str) -> String {
        let plugins = Path::new(env!("CARGO_MANIFEST_DIR")).join("plugins");
        let folder = if name.contains('-') {
            "elevation"
        } else {
            "terrain"
        };
        let path = plugins.join(folder).join("tests/files").join(name);
        path.display().to_string()
    }

    /// The commands between backquotes.
    fn advice(error: &str) -> Vec<String> {
        let quoted = error.split('`').skip(1).step_by(2);
        quoted
            .filter(|text| text.starts_with("dolomite heights"))
            .map(str::to_owned)
            .collect()
    }

    #[test]
    fn every_advice_is_a_command_that_works() {
        for (words, commands) in [
            ("nodata_9999.raw --raw-size 96x64", 2),
            ("h16-gdal-untold.tif", 2),
            ("hf-gdal-nan-untold.tif", 1),
            ("u16-gdal-bands-band.tif", 1),
            ("u16-pypng-colour.png", 1),
        ] {
            let (name, rest) = words.split_once(' ').unwrap_or((words, ""));
            let error =
                run(&format!("dolomite heights {} {rest}", file(name))).expect_err("refused");
            let advice = advice(&error);
            assert_eq!(advice.len(), commands, "{error}");
            for command in advice {
                run(&command).unwrap_or_else(|error| panic!("{command}: {error}"));
            }
        }
        // Files of no kind, of a size that fits.
        let path =
            std::env::temp_dir().join(format!("dolomite heights {}.bin", std::process::id()));
        let name = path.display().to_string().replace(' ', "_");
        std::fs::write(&name, vec![7; 2 * 33 * 33]).unwrap();
        let error = run(&format!("dolomite heights {name}")).expect_err("of no kind");
        assert_eq!(advice(&error).len(), 1, "{error}");
        run(&advice(&error)[0]).unwrap();
        let raw = name.replace(".bin", ".raw");
        std::fs::rename(&name, &raw).unwrap();
        let error = run(&format!("dolomite heights {raw}")).expect_err("no size");
        run(&advice(&error)[0]).unwrap();
        std::fs::remove_file(&raw).unwrap();
    }

    #[test]
    fn what_a_file_is_is_printed_and_written() {
        let folder = std::env::temp_dir().join(format!("dolomite-heights-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let [json, out] = ["a.json", "a.f32"].map(|name| folder.join(name).display().to_string());
        let line = format!(
            "dolomite heights {} --json {json} --out {out}",
            file("h16-gdal-nodata.tif")
        );
        let text = run(&line).unwrap();
        for words in [
            "TIFF, not compressed",
            "41 x 37 of i16",
            "-32768: 107 samples",
            "EPSG:32633",
            "30.000000 x 25.000000 m",
        ] {
            assert!(text.contains(words), "{text} does not say {words}");
        }
        let json: serde_json::Value =
            serde_json::from_slice(&std::fs::read(&json).unwrap()).unwrap();
        assert_eq!(json["holes"], 107);
        assert_eq!(json["georeference"]["first"][0], 412_355.0);
        assert_eq!(json["spacing_metres"][1], 25.0);
        let written = std::fs::read(&out).unwrap();
        assert_eq!(written.len(), 4 * 41 * 37);
        let wanted =
            std::fs::read(file("h16-gdal-nodata.tif").replace("-gdal-nodata.tif", ".f32")).unwrap();
        let (a, b) = (written.as_chunks::<4>().0, wanted.as_chunks::<4>().0);
        for (a, b) in a
            .iter()
            .zip(b)
            .map(|(a, b)| (f32::from_le_bytes(*a), f32::from_le_bytes(*b)))
        {
            assert!(a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan());
        }
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
