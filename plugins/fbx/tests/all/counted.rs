//! What becomes of a file depends on the file and the options, not on how fast or how busy a machine is.

use dolomite_fbx::{Effort, Limits, Options, Origin, Progress, convert};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Words of whoever looks at a clock.
const CLOCKS: [&str; 5] = ["Instant", "SystemTime", "Duration", "elapsed", "UNIX_EPOCH"];

/// Sources that may: they time a conversion from outside.
const TIMED: [&str; 1] = ["src/check/frames.rs"];

fn sources(folder: &Path, out: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("sources are there") {
        let path = entry.expect("and can be listed").path();
        match path.is_dir() {
            true => sources(&path, out),
            false => out.push(path),
        }
    }
}

#[test]
fn no_conversion_reads_a_clock() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut all = Vec::new();
    sources(&root.join("src"), &mut all);
    assert!(all.len() > 50, "{} sources", all.len());
    let mut timed = Vec::new();
    for path in all {
        let text = std::fs::read_to_string(&path).expect("sources are text");
        if CLOCKS.iter().any(|word| text.contains(word)) {
            let name = path.strip_prefix(root).expect("it lies below");
            timed.push(name.to_string_lossy().into_owned());
        }
    }
    // The list can only shrink, and a search that finds nothing would not find this one.
    assert_eq!(timed, TIMED);
}

/// All that a conversion says.
fn outcome(bytes: &[u8], options: &Options) -> Result<(Vec<u8>, String), String> {
    let made = convert(bytes, &Origin::default(), options).map_err(|error| error.to_string())?;
    let glb = made.to_glb().map_err(|error| error.to_string())?;
    Ok((glb, format!("{:?}", made.report)))
}

/// With too little work allowed, with just enough and with plenty; on one thread, on several, and where every step that is told
/// takes long.
#[test]
fn the_same_bytes_on_fast_and_slow_machines() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/hero/hero.fbx");
    let bytes = std::fs::read(path).expect("the person is there");
    let slow = |_: Progress| std::thread::sleep(Duration::from_millis(2));
    let memory = Limits::of_contents(&bytes).memory;
    let (mut refused, mut made) = (0, Vec::new());
    for work in [1_000, 50_000, 100_000, 200_000, 400_000, 10_000_000] {
        let with = |threads, is_slow: bool| Options {
            threads,
            limits: Some(Limits { memory, work }),
            progress: is_slow.then_some(&slow),
            ..Options::default()
        };
        let one = outcome(&bytes, &with(1, false));
        for (threads, is_slow) in [(2, false), (5, true)] {
            let other = outcome(&bytes, &with(threads, is_slow));
            assert!(one == other, "{work}, {threads} threads, slow: {is_slow}");
        }
        match one {
            Ok((glb, report)) => made.push((glb.len(), report)),
            Err(error) => {
                assert!(error.contains("raise the limit on work"), "{error}");
                refused += 1;
            }
        }
    }
    // Some are refused, some come out otherwise than with plenty of work: the limit is felt.
    made.dedup();
    assert!(refused > 0 && made.len() > 1, "{refused}, {}", made.len());
}

#[test]
fn a_long_search_is_counted_too() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/hero/hero.fbx");
    let bytes = std::fs::read(path).expect("the person is there");
    let memory = Limits::of_contents(&bytes).memory;
    let slow = |_: Progress| std::thread::sleep(Duration::from_millis(2));
    let with = |threads, is_slow: bool| Options {
        threads,
        effort: Effort::Thorough,
        // The searches of some clips end before they are done.
        limits: Some(Limits {
            memory,
            work: 400_000,
        }),
        progress: is_slow.then_some(&slow),
        ..Options::default()
    };
    let one = outcome(&bytes, &with(1, false));
    assert!(one.is_ok(), "{:?}", one.err());
    assert!(one == outcome(&bytes, &with(2, true)));
}
