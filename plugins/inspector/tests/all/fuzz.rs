//! Lines that nobody would type: each is answered, none panics.
use crate::support::{app, say};

use dolomite_inspector::Console;

/// Lines of one run. A line takes some 0.2 ms as the tests are compiled, most of it clap's; 10^5 are a soak's:
/// `DOLOMITE_FUZZ=100000 cargo nextest run -p dolomite_inspector fuzz`.
const LINES: u64 = 10_000;

/// A permuted congruential generator (M. O'Neill, PCG, 2014; the variant XSH RR 64/32).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u32 {
        let old = self.0;
        self.0 = old
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let shifted = (((old >> 18) ^ old) >> 27) as u32;
        shifted.rotate_right((old >> 59) as u32)
    }

    fn below(&mut self, end: usize) -> usize {
        self.next() as usize % end
    }

    fn of<'a>(&mut self, texts: &[&'a str]) -> &'a str {
        texts[self.below(texts.len())]
    }
}

const WORDS: [&str; 66] = [
    "get",
    "set",
    "copy",
    "undo",
    "redo",
    "settings",
    "entities",
    "entity",
    "spawn",
    "despawn",
    "stat",
    "watch",
    "views",
    "chart",
    "--steps",
    "FramePicture.far",
    "depth",
    "exec",
    "wait",
    "history",
    "clear",
    "help",
    "Fog",
    "Fog.dust",
    "Fog@valley",
    "Fog@0v0",
    "Fog.layers[0]",
    "Fog.layers[-1]",
    "Fog.kind",
    "Fog.kind.share",
    "Fog.colour",
    "Fog..",
    "Fog.[",
    "Fog#0",
    "Name",
    "Time",
    "0v0",
    "4294967295v4294967295",
    "-1",
    "1e999",
    "NaN",
    "inf",
    "9999999999999999999999",
    "(dust:1)",
    "[1,2,3]",
    "Some(3)",
    "None",
    "((((((((((",
    "\"",
    "'",
    "\\",
    "--off",
    "--help",
    "--",
    "-",
    "=",
    "Fog=(dust:2)",
    "Thick(share:1)",
    "é",
    "\u{0}",
    "\u{202e}",
    "fog/drawn",
    "on",
    "off",
    "#",
    "\t",
];

fn line(random: &mut Random) -> String {
    let mut line = String::new();
    for _ in 0..=random.below(6) {
        match random.below(12) {
            0 => {
                let c = char::from_u32(random.next() % 0x11_0000).unwrap_or(' ');
                line.push(c);
            }
            1 => line.push_str(&random.next().to_string()),
            2 => {
                // A word cut or doubled.
                let word = random.of(&WORDS);
                let cut = word
                    .char_indices()
                    .nth(random.below(4))
                    .map_or(0, |(at, _)| at);
                line.push_str(&word[cut..]);
                line.push_str(&word[..cut]);
            }
            _ => line.push_str(random.of(&WORDS)),
        }
        if random.below(8) > 0 {
            line.push(' ');
        }
    }
    line
}

#[test]
fn lines_that_nobody_would_type_are_answered() {
    let lines = std::env::var("DOLOMITE_FUZZ")
        .ok()
        .and_then(|count| count.parse().ok())
        .unwrap_or(LINES);
    let mut random = Random(7);
    let (mut faults, mut done) = (0_u64, 0_u64);
    let (mut app, mut fog) = app();
    for k in 0..lines {
        let line = line(&mut random);
        // Files of the machine are not this test's, and waiting is only long.
        if line.contains("exec") || line.contains("wait") || line.contains("--out") {
            continue;
        }
        match say(&mut app, &line) {
            Ok(_) => done += 1,
            Err(_) => faults += 1,
        }
        // A chart of many values may go on.
        let goes_on = !app.world().resource::<Console>().queue.is_empty();
        if k % 512 == 0 || goes_on || app.world().get_entity(fog).is_err() {
            (app, fog) = crate::support::app();
        }
    }
    assert!(app.world().resource::<Console>().queue.is_empty());
    println!("{lines} lines: {done} done, {faults} faults");
    // One of twenty-three is done with this seed: few words in a row make a command.
    assert!(done > lines / 40 && faults > lines / 4, "{done} {faults}");
}
