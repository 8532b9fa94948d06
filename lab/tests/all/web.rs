//! The capsules and the page in a browser: `web/test` plays capsules in Chromium, whose WebGPU (Dawn, Tint) is an
//! implementation of its own, and tries the page as a person would. Ten capsules of all kinds and the page's first scene
//! with every change, everything by `./scripts/soak`. A browser that hangs is killed, and the test says so.
//!
//! Without Node, the npm packages or Chromium these tests skip with a line, and fail where `CI` is set.

use std::path::{Path, PathBuf};
use std::process::Command;

use dolomite_lab::capsule::command::{Arguments, run};

fn web() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../web")
}

/// False, after a line that says so, where something is not installed; in CI that fails.
fn is_there() -> bool {
    let chromium = std::env::var_os("CHROMIUM").map_or_else(
        || Path::new("/usr/bin/chromium").exists(),
        |path| Path::new(&path).exists(),
    );
    if chromium && web().join("node_modules/.package-lock.json").exists() {
        return true;
    }
    let line = "Chromium or the npm packages of web are not installed: ./scripts/web test";
    assert!(
        std::env::var_os("CI").is_none(),
        "CI must not skip the browser: {line}"
    );
    eprintln!("skipped: {line}");
    false
}

/// Runs a program in `web`; what it printed, and whether it succeeded.
fn said(program: &str, arguments: &[&str]) -> (String, bool) {
    let run = Command::new(program)
        .args(arguments)
        .current_dir(web())
        .output()
        .unwrap_or_else(|error| panic!("{program}: {error}"));
    let text = String::from_utf8_lossy(&run.stdout).into_owned()
        + String::from_utf8_lossy(&run.stderr).as_ref();
    (text, run.status.success())
}

fn succeed(program: &str, arguments: &[&str]) -> String {
    let (text, success) = said(program, arguments);
    assert!(success, "{program} {arguments:?}\n{text}");
    text
}

/// Writes the capsules `which` into a folder of their own.
fn capsules(which: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("dolomite_{which}_{}", std::process::id()));
    let arguments = Arguments {
        name: Some(which.into()),
        out: Some(folder.clone()),
        list: false,
        seed: 1,
        count: 10_000,
        time: None,
    };
    run(&arguments).unwrap_or_else(|error| panic!("{error}"));
    folder
}

/// The page of figures as it is committed, and one that lacks its style: nothing is said in the console and every figure is
/// seen, in light and in dark.
#[test]
fn the_page_of_figures_is_whole_in_chromium_gpu() {
    if !is_there() {
        return;
    }
    succeed("npm", &["run", "--silent", "tools"]);
    let page = web().join("../docs/figures/index.html");
    let path = page.display().to_string();
    let (text, success) = said("node", &["dist-tools/figures.js", &path]);
    println!("{text}");
    assert!(success, "{text}");

    let whole = std::fs::read_to_string(&page).expect("it is committed");
    let at = whole.find("<style>").expect("it has a style");
    let end = whole.find("</style>").expect("it has a style");
    let broken = std::env::temp_dir().join(format!("dolomite_figures_{}.html", std::process::id()));
    let bare = format!(
        "{}<script>nothing()</script>{}",
        &whole[..at],
        &whole[end..]
    );
    std::fs::write(&broken, bare).expect("a page");
    let (text, success) = said(
        "node",
        &["dist-tools/figures.js", &broken.display().to_string()],
    );
    std::fs::remove_file(&broken).expect("it is ours");
    assert!(!success && text.contains("WRONG"), "{text}");
}

/// Plays capsules and tries the page, and plays one capsule with one expected word changed, which has to be found. Ends
/// the browser after so many seconds.
fn hold(which: &str, options: &[&str], limit: &str) {
    if !is_there() {
        return;
    }
    succeed("npm", &["run", "--silent", "build"]);
    succeed("npm", &["run", "--silent", "tools"]);
    let folder = capsules(which);
    let path = folder.display().to_string();
    let run = ["dist-tools/run.js", &path, "--limit", limit];
    let (text, success) = said("node", &[&run, options].concat());
    println!("{text}");
    assert!(success, "{text}");

    let one = folder.join("crowd.capsule");
    let mut bytes = std::fs::read(&one).expect("it was written");
    // A number of the last vertex's normal: what is expected lies at the end.
    let changed = bytes.len() - 6;
    bytes[changed] ^= 1;
    for entry in std::fs::read_dir(&folder)
        .expect("the folder is ours")
        .flatten()
    {
        std::fs::remove_file(entry.path()).expect("the files are ours");
    }
    std::fs::write(&one, bytes).expect("a capsule");
    let (text, success) = said("node", &[&run[..], &["--only", "capsules"]].concat());
    assert!(!success && text.contains("1 of them wrong"), "{text}");
    std::fs::remove_dir_all(&folder).expect("the folder is ours");
}

/// What every change has to pass: a capsule of each domain, spacing, mode and part, to the bit or within the stated
/// units; the page opened, its slider, its picture, its messages, bad input, keys.
#[test]
fn the_page_and_chosen_capsules_hold_in_chromium_gpu() {
    hold("short", &["--short"], "420");
}

/// Every capsule, 10⁴ random patches among them; every scene; a telephone.
#[test]
#[ignore = "minutes in a browser: ./scripts/soak, or ./scripts/web test FOLDER"]
fn the_page_and_all_capsules_hold_in_chromium_gpu() {
    hold("all", &[], "3600");
}

/// A browser whose page waits for ever is killed, with a line that says so.
#[test]
fn a_browser_that_hangs_is_killed_gpu() {
    if !is_there() {
        return;
    }
    succeed("npm", &["run", "--silent", "tools"]);
    let began = std::time::Instant::now();
    let (text, success) = said("node", &["dist-tools/hangs.js"]);
    assert!(!success && text.contains("the browser is killed"), "{text}");
    assert!(began.elapsed().as_secs() < 120, "{:?}", began.elapsed());
    let child = text.lines().find_map(|line| line.strip_prefix("browser "));
    let child = child.expect("it says which process it is");
    // It was sent the signal as the program ended; a loaded machine takes a while over it. Nobody may be left to bury it.
    let lives = || {
        let status = std::fs::read_to_string(format!("/proc/{child}/status")).unwrap_or_default();
        status
            .lines()
            .any(|line| line.starts_with("State:") && !line.contains("zombie"))
    };
    while lives() {
        assert!(began.elapsed().as_secs() < 120, "{child} lives on");
        std::thread::sleep(std::time::Duration::from_millis(100));
    }
}
