//! The classic scene by the built binary: every mode does what it says, and all draw one picture.
//!
//! Without the shared data or a Vulkan device the tests skip with a line that says so; where the data
//! are said to be there, or with `CI` set, that is a failure.

use std::path::{Path, PathBuf};
use std::process::Command;

use image::RgbImage;
use serde_json::Value;

/// The folder of shared data; `None`, after a line that says so, without it or without Vulkan.
fn shared() -> Option<PathBuf> {
    let folder = dolomite_game::settings::paths::shared_dir(None);
    let file = folder.join(dolomite_classic::heights::FILE);
    if !file.is_file() {
        let line = format!("{} is missing; set DOLOMITE_SHARED", file.display());
        assert!(
            std::env::var_os("DOLOMITE_REQUIRE_SHARED").is_none(),
            "{line}"
        );
        eprintln!("skipped: {line}");
        return None;
    }
    if let Err(error) = dolomite_game::run::device::probe() {
        assert!(
            std::env::var_os("CI").is_none(),
            "CI must not skip: {error}"
        );
        eprintln!("skipped: {error}");
        return None;
    }
    Some(folder)
}

fn temporary(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

fn run(data: &Path, arguments: &[&str]) -> String {
    let made = Command::new(env!("CARGO_BIN_EXE_dolomite"))
        .args(arguments)
        .args(["--scene", "classic", "--data"])
        .arg(data)
        .env("XDG_CONFIG_HOME", env!("CARGO_TARGET_TMPDIR"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap_or_else(|error| panic!("dolomite does not start: {error}"));
    let said = String::from_utf8_lossy(&made.stderr);
    assert!(
        made.status.success(),
        "{arguments:?} ended with {}:\n{said}",
        made.status
    );
    String::from_utf8_lossy(&made.stdout).into_owned()
}

/// What a run of the bench says of a mode; triangles of those that follow the view go into `followed`.
fn check(mode: &str, what: &str, summary: &Value, followed: &mut Vec<u64>) {
    let number = |name: &str| summary[name].as_u64().expect(name);
    let (triangles, vertices) = (number("triangles"), number("vertices"));
    // The camera moves after the first of three frames: at least one later frame tells of it.
    assert_eq!(number("dispatches") > 0, mode == "gpu", "{what}: {summary}");
    assert_eq!(number("uploaded") > 0, mode == "cpu", "{what}: {summary}");
    assert_eq!(number("bytes"), 20 * vertices + 12 * triangles, "{what}");
    if mode.starts_with("static") {
        // Level 32 on 64 x 64 patches, vertices of edges once.
        assert_eq!(
            (triangles, vertices),
            (2 * 2048 * 2048, 2049 * 2049),
            "{what}"
        );
    } else {
        followed.push(triangles);
    }
}

/// Of 1.29 million, a third lies in the frustum. The GPU's levels and the CPU reference's differ by rounding alone,
/// and frames by a 200th.
fn alike(followed: &[u64]) {
    let (least, most) = (followed.iter().min(), followed.iter().max());
    let (least, most) = (least.copied().unwrap_or(0), most.copied().unwrap_or(0));
    assert!(
        (300_000..500_000).contains(&least) && most - least < least / 50,
        "{followed:?}"
    );
}

/// The bench of the scene, with these arguments more: its report, and what it prints.
fn bench(data: &Path, arguments: &[&str]) -> (Value, String) {
    let file = temporary("classic-bench.json");
    let name = file.to_string_lossy().into_owned();
    let mut all = vec!["bench", "--frames", "3", "--size", "64x36", "--json", &name];
    all.extend(arguments);
    let table = run(data, &all);
    let text = std::fs::read_to_string(&file).expect("the report");
    (serde_json::from_str(&text).expect("JSON"), table)
}

#[test]
fn gpu_every_mode_does_what_it_says() {
    let Some(data) = shared() else { return };
    let mut followed = Vec::new();
    for mode in ["gpu", "cpu", "static-gpu", "static-cpu"] {
        let (report, _) = bench(&data, &["--mode", mode, "--path", "orbit"]);
        check(mode, mode, &report["summary"], &mut followed);
    }
    alike(&followed);
}

#[test]
#[ignore = "a minute and a half: twelve apps; each mode by itself is looked at always"]
fn gpu_the_matrix_has_every_mode_in_every_form() {
    let Some(data) = shared() else { return };
    let (report, table) = bench(&data, &["--matrix"]);
    let rows = report.as_array().expect("rows");
    assert_eq!((rows.len(), table.lines().count()), (12, 2 + 12), "{table}");
    let mut followed = Vec::new();
    for row in rows {
        let (mode, shown) = (row["mode"].as_str().unwrap_or(""), &row["shown"]);
        let what = format!("{mode} {shown}");
        check(mode, &what, &row["summary"], &mut followed);
    }
    alike(&followed);
}

fn shoot(data: &Path, name: &str, arguments: &[&str]) -> RgbImage {
    let out = temporary(&format!("classic-{name}.png"));
    let path = out.to_string_lossy().into_owned();
    let mut all = vec!["shot", "--size", "320x180", "--out", &path];
    all.extend(arguments);
    run(data, &all);
    match image::open(&out) {
        Ok(picture) => picture.into_rgb8(),
        Err(error) => panic!("{}: {error}", out.display()),
    }
}

/// Share of samples that differ by more than an eighth of the range.
fn differing(a: &RgbImage, b: &RgbImage) -> f64 {
    let far = a.iter().zip(b.iter()).filter(|(a, b)| a.abs_diff(**b) > 32);
    far.count() as f64 / a.len() as f64
}

#[test]
fn gpu_all_modes_draw_one_picture() {
    let Some(data) = shared() else { return };
    let gpu = shoot(&data, "gpu", &[]);
    let sky = *gpu.get_pixel(160, 2);
    let is_sky = |x: u32, y: u32| *gpu.get_pixel(x, y) == sky;
    let count = |rows: std::ops::Range<u32>| {
        rows.flat_map(|y| (0..320).map(move |x| (x, y)))
            .filter(|(x, y)| is_sky(*x, *y))
            .count()
    };
    // Sky above the hills; no background below, where only ground is seen.
    assert!(count(0..60) > 320 * 30, "{}", count(0..60));
    assert_eq!(count(100..180), 0);
    // The same mesh but for a level here and there that rounds the other way.
    let cpu = shoot(&data, "cpu", &["--mode", "cpu"]);
    assert!(differing(&gpu, &cpu) < 0.001, "{}", differing(&gpu, &cpu));
    // Nothing that is seen is left out.
    let whole = shoot(&data, "whole", &["--no-cull"]);
    assert_eq!(differing(&gpu, &whole), 0.0);
    // Finer ground: shapes stay, outlines of far hills move.
    let finest = shoot(&data, "static", &["--mode", "static-gpu"]);
    let moved = differing(&gpu, &finest);
    assert!((0.000_1..0.1).contains(&moved), "{moved}");
    // The comparison sees a picture that is none of the scene's first frame.
    let other = shoot(&data, "other", &["--camera", "0,120,0,90,-10"]);
    assert!(differing(&gpu, &other) > 0.2, "{}", differing(&gpu, &other));
}
