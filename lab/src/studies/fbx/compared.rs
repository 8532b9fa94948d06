//! Ours beside the others over all files.

use super::line::Line;
use serde_json::{Value, json};

/// An error that is right: a model wrong by more than this share of its size looks wrong.
const WRONG: f64 = 0.01;

/// What counts as equal: f32 in a file of some size has so many digits.
const EQUAL: f64 = 2e-6;

/// How often we are at least as near, and how often one of them is right and we are wrong.
pub(super) fn compared(lines: &[&Line]) -> Value {
    let of = |name: &str| {
        let pairs: Vec<(f64, f64)> = lines
            .iter()
            .flat_map(|line| &line.baselines)
            .filter(|baseline| baseline.name == name)
            .map(|baseline| {
                (
                    baseline.ours_over_size,
                    baseline.error_over_size.unwrap_or(f64::INFINITY),
                )
            })
            .collect();
        let near = pairs
            .iter()
            .filter(|(ours, theirs)| *ours <= theirs.max(EQUAL))
            .count();
        let worse = pairs
            .iter()
            .filter(|(ours, theirs)| *ours > WRONG && *theirs <= WRONG)
            .count();
        let bytes = |pick: fn(&Line) -> usize| -> usize {
            let both = lines.iter().filter(|line| {
                line.baselines
                    .iter()
                    .any(|r| r.name == name && r.bytes.is_some())
            });
            both.map(|line| pick(line)).sum()
        };
        let theirs: usize = lines
            .iter()
            .flat_map(|line| &line.baselines)
            .filter(|r| r.name == name)
            .filter_map(|r| r.bytes)
            .sum();
        json!({
            "files": pairs.len(),
            "ours_at_least_as_near": near,
            "we_wrong_they_right": worse,
            "they_wrong": pairs.iter().filter(|(_, theirs)| *theirs > WRONG).count(),
            "our_animation_bytes": bytes(|line| line.animation_bytes),
            "their_animation_bytes": theirs,
        })
    };
    json!({ "FBX2glTF": of("FBX2glTF"), "Assimp": of("Assimp") })
}
