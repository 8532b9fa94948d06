//! The pictures of both scenes, as `dolomite shot` makes them, against golden ones; and one of a shape that is hard
//! to draw.
//!
//! The pictures are made by the built binary on Mesa's software Vulkan (`llvmpipe`), whatever other
//! adapter the machine has, and compared with `tests/golden/<scene>.png`. Without that driver the
//! test skips with a line that says so; with `CI` set that is a failure.
//!
//! `DOLOMITE_BLESS=1 cargo nextest run -E 'binary(images)'` writes the golden pictures anew. Look at
//! them before you commit them.

use dolomite_testkit::flip::{self, Difference, Limit};
use image::RgbImage;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What a picture may differ from its golden one.
///
/// The same Mesa gives the same bytes. Another Mesa or LLVM may fuse a multiply with an add, and so
/// move an edge within its pixel or filter a texel differently: few pixels change visibly (p99), and
/// hardly so (mean). What must be seen is larger: moved by one pixel the mean is 0.03 to 0.04, by
/// eight 0.13; with 2 % less light 0.08, with 20 % less 0.38; the other scene's 0.41.
const LIMIT: Limit = Limit {
    rmse: 4.0,
    flip_mean: 0.02,
    flip_p99: 0.2,
};

/// Small enough for software Vulkan in a debug build, large enough to show ridges and materials.
const SIZE: (u32, u32) = (320, 180);

const SCENES: [&str; 2] = ["mountain", "jacksboro"];

fn golden_path(scene: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/golden")
        .join(format!("{scene}.png"))
}

fn load(path: &Path) -> RgbImage {
    match image::open(path) {
        Ok(picture) => picture.into_rgb8(),
        Err(error) => panic!("{}: {error}", path.display()),
    }
}

/// The driver's file for Mesa's software Vulkan.
fn software_driver() -> Option<PathBuf> {
    let folders = [
        "/usr/share/vulkan/icd.d",
        "/etc/vulkan/icd.d",
        "/usr/local/share/vulkan/icd.d",
    ];
    folders
        .iter()
        .filter_map(|folder| std::fs::read_dir(folder).ok())
        .flatten()
        .flatten()
        .find_map(|entry| {
            let name = entry.file_name().into_string().ok()?;
            (name.starts_with("lvp_icd") && name.ends_with(".json")).then(|| entry.path())
        })
}

/// The picture of `size` that `dolomite shot` makes of `scene`, in a file of that name; `None`, after a line that
/// says so, without the pinned adapter.
fn shoot(scene: &str, size: (u32, u32), name: &str) -> Option<RgbImage> {
    let Some(driver) = software_driver() else {
        let line = "no lvp_icd*.json (package mesa-vulkan-drivers): the picture of a scene was not compared";
        assert!(std::env::var_os("CI").is_none(), "{line}, and CI is set");
        eprintln!("skipped: {line}");
        return None;
    };
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.png"));
    if out.exists() {
        std::fs::remove_file(&out).unwrap_or_else(|e| panic!("{}: {e}", out.display()));
    }
    let made = Command::new(env!("CARGO_BIN_EXE_dolomite"))
        .args(["shot", "--scene", scene, "--frames", "4", "--max-error", "4", "--out"])
        .arg(&out)
        .args(["--size", &format!("{}x{}", size.0, size.1)])
        .env("VK_DRIVER_FILES", &driver)
        .env("VK_ICD_FILENAMES", &driver)
        .env("WGPU_BACKEND", "vulkan")
        .env("WGPU_ADAPTER_NAME", "llvmpipe")
        // Neither the settings nor the assets of whoever runs the test.
        .env("XDG_CONFIG_HOME", env!("CARGO_TARGET_TMPDIR"))
        .env_remove("DOLOMITE_ASSETS")
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap_or_else(|error| panic!("dolomite does not start: {error}"));
    let said = String::from_utf8_lossy(&made.stderr);
    assert!(
        made.status.success(),
        "dolomite shot --scene {scene} ended with {}:\n{said}",
        made.status
    );
    assert!(
        said.contains("llvmpipe"),
        "not drawn by the pinned adapter:\n{said}"
    );
    Some(load(&out))
}

/// Standard deviation of all samples, levels.
fn deviation(picture: &RgbImage) -> f64 {
    let mean = picture.iter().map(|s| f64::from(*s)).sum::<f64>() / picture.len() as f64;
    let squares = picture
        .iter()
        .map(|s| (f64::from(*s) - mean) * (f64::from(*s) - mean));
    (squares.sum::<f64>() / picture.len() as f64).sqrt()
}

/// The one comparison that all tests of this file go through.
fn compare_with_golden(picture: &RgbImage, golden: &RgbImage) -> Result<Difference, String> {
    let difference = flip::compare(picture, golden)?;
    match difference.within(&LIMIT) {
        Ok(()) => Ok(difference),
        Err(beyond) => Err(format!("{beyond} ({difference:?})")),
    }
}

fn check_scene(scene: &str) {
    let Some(picture) = shoot(scene, SIZE, scene) else {
        return;
    };
    assert_eq!(picture.dimensions(), SIZE);
    let golden_path = golden_path(scene);
    if blessing() {
        picture
            .save(&golden_path)
            .unwrap_or_else(|e| panic!("{}: {e}", golden_path.display()));
        eprintln!("written: {}", golden_path.display());
        return;
    }
    let golden = load(&golden_path);
    match compare_with_golden(&picture, &golden) {
        Ok(difference) => eprintln!("{scene}: {difference:?}"),
        Err(words) => {
            let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
            let error_path = folder.join(format!("{scene}-error.png"));
            let saved = flip::error_picture(&picture, &golden).save(&error_path);
            panic!(
                "{scene} is not what it was: {words}\npicture: {}\ngolden: {}\nerror: {} ({saved:?})",
                folder.join(format!("{scene}.png")).display(),
                golden_path.display(),
                error_path.display(),
            );
        }
    }
}

/// Tests that open an adapter; their names hold `gpu`, so that they run in their group.
mod gpu {
    #[test]
    fn mountain_is_as_it_was() {
        super::check_scene("mountain");
    }

    #[test]
    fn jacksboro_is_as_it_was() {
        super::check_scene("jacksboro");
    }

    /// 33:1 is wider than Bevy's bloom can be on this device.
    #[test]
    fn a_very_wide_picture_is_drawn() {
        let size = (330, 10);
        let Some(picture) = super::shoot("mountain", size, "wide") else {
            return;
        };
        assert_eq!(picture.dimensions(), size);
        let deviation = super::deviation(&picture);
        assert!(
            deviation > 10.0,
            "the samples deviate by {deviation:.1} levels"
        );
    }
}

/// Whether the golden pictures are being written, so that there may be none to look at yet.
fn blessing() -> bool {
    std::env::var_os("DOLOMITE_BLESS").is_some()
}

#[test]
fn golden_pictures_are_of_the_right_size_and_not_empty() {
    if blessing() {
        return eprintln!("skipped: the golden pictures are being written");
    }
    for scene in SCENES {
        let golden = load(&golden_path(scene));
        assert_eq!(golden.dimensions(), SIZE, "{scene}");
        let deviation = deviation(&golden);
        // A black, white or one-coloured picture has a deviation of 0; sky above ground has dozens
        // of levels between them.
        assert!(
            deviation > 10.0,
            "{scene}: the samples deviate by {deviation:.1} levels"
        );
    }
}

#[test]
fn a_wrong_picture_fails() {
    if blessing() {
        return eprintln!("skipped: the golden pictures are being written");
    }
    let [mountain, jacksboro] = SCENES.map(|scene| load(&golden_path(scene)));
    for (name, golden, other) in [
        ("mountain", &mountain, &jacksboro),
        ("jacksboro", &jacksboro, &mountain),
    ] {
        for (wrong, picture) in [
            ("the other scene", other.clone()),
            ("shifted by 8 pixels", flip::shifted(golden, 8)),
            ("a fifth darker", flip::darker(golden, 0.8)),
            ("black", RgbImage::new(SIZE.0, SIZE.1)),
        ] {
            let outcome = compare_with_golden(&picture, golden);
            assert!(outcome.is_err(), "{name}, {wrong}, passes: {outcome:?}");
        }
        assert!(
            compare_with_golden(golden, golden).is_ok(),
            "{name} differs from itself"
        );
    }
}
