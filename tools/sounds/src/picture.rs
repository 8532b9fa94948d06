//! A picture of all sounds: each one's samples over its length, coloured by how high they are.

use std::fmt::Write;

use crate::catalogue::{SOUNDS, Sound};

/// Panels beside each other.
const PANELS: usize = 4;
/// Width and height of a panel with its margin, pixels.
const PANEL: (usize, usize) = (224, 92);
/// Width of what is drawn of a sound, pixels: two a column.
const WIDTH: usize = 200;
const COLUMNS: usize = WIDTH / 2;
/// Full scale, pixels above and below the middle.
const FULL: f64 = 26.0;
/// From deep to high, an octave each, the first below [`LOWEST`].
const COLOURS: [&str; 7] = [
    "#5b6bd6", "#3f97d0", "#35b3a0", "#6cbf5a", "#c9b53c", "#e58a3a", "#e5604f",
];
/// Where the second colour begins, Hz.
const LOWEST: f64 = 125.0;

/// A column of samples.
struct Column {
    least: f64,
    most: f64,
    colour: usize,
}

/// How often samples change their sign, in Hz: the pitch of a tone, and of noise where the middle of its power lies.
fn pitch(samples: &[f64], rate: u32) -> f64 {
    let changes = samples
        .windows(2)
        .filter(|two| (two[0] < 0.0) != (two[1] < 0.0))
        .count();
    changes as f64 * f64::from(rate) / (2.0 * samples.len().max(1) as f64)
}

fn columns(samples: &[f64], rate: u32) -> Vec<Column> {
    let at = |column: usize| column * samples.len() / COLUMNS;
    (0..COLUMNS)
        .map(|column| {
            let own = &samples[at(column)..at(column + 1)];
            // Pitch takes longer to be told than a column is: its neighbours count.
            let near = &samples[at(column.saturating_sub(1))..at((column + 2).min(COLUMNS))];
            let octave = libm::floor(libm::log2(pitch(near, rate).max(1.0) / LOWEST)) + 1.0;
            Column {
                least: own.iter().copied().fold(0.0, f64::min),
                most: own.iter().copied().fold(0.0, f64::max),
                colour: octave.clamp(0.0, (COLOURS.len() - 1) as f64) as usize,
            }
        })
        .collect()
}

fn panel(svg: &mut String, sound: &Sound, seed: u32, (x, y): (usize, usize)) {
    let samples = sound.samples(seed);
    let seconds = samples.len() as f64 / f64::from(sound.rate);
    let name = sound.name.replace('_', " ");
    let again = if sound.looped { ", loop" } else { "" };
    let middle = y as f64 + 54.0;
    let (left, right) = (x + 12, x + 12 + WIDTH);
    // Writing into a string cannot fail.
    let _ = write!(
        svg,
        r##"<text x="{left}" y="{}" fill="#e6e9ee">{name}</text><text x="{right}" y="{}" fill="#8b95a5" text-anchor="end">{seconds:.2} s{again}</text>"##,
        y + 20,
        y + 20,
    );
    let columns = columns(&samples, sound.rate);
    for (colour, hex) in COLOURS.iter().enumerate() {
        let mut path = String::new();
        for (k, column) in columns.iter().enumerate() {
            if column.colour == colour {
                // At least a hair, so that silence is a line.
                let (up, down) = (FULL * column.most, FULL * -column.least);
                let _ = write!(
                    path,
                    "M{},{:.1}V{:.1}",
                    left + 2 * k + 1,
                    middle - up.max(0.4),
                    middle + down.max(0.4)
                );
            }
        }
        if !path.is_empty() {
            let _ = write!(svg, r#"<path d="{path}" stroke="{hex}"/>"#);
        }
    }
    svg.push('\n');
}

/// All sounds as an SVG picture of a width of four panels, made from `seed`. The same text on every machine.
#[must_use]
pub fn svg(seed: u32) -> String {
    let (width, rows) = (PANELS * PANEL.0, SOUNDS.len().div_ceil(PANELS));
    let height = rows * PANEL.1 + 34;
    let mut svg = format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" font-family="sans-serif" font-size="12" stroke-width="1.4"><rect width="{width}" height="{height}" rx="6" fill="#12171f"/>
"##
    );
    for (k, sound) in SOUNDS.iter().enumerate() {
        let place = (k % PANELS * PANEL.0, k / PANELS * PANEL.1);
        panel(&mut svg, sound, seed, place);
    }
    let base = rows * PANEL.1 + 18;
    for (k, hex) in COLOURS.iter().enumerate() {
        let x = 12 + 120 * k;
        let octave = LOWEST * libm::exp2(k as f64 - 1.0);
        let text = if k == 0 {
            format!("below {LOWEST} Hz")
        } else {
            format!("from {octave} Hz")
        };
        let _ = write!(
            svg,
            r##"<rect x="{x}" y="{}" width="10" height="10" fill="{hex}"/><text x="{}" y="{base}" fill="#8b95a5">{text}</text>"##,
            base - 9,
            x + 16,
        );
    }
    svg.push_str("\n</svg>\n");
    svg
}
