//! Files of few and of many keys, for what compression makes of them.

use super::held::{ROTATION, SCALE, TRANSLATION, base, shares};
use super::takes::{CUBIC, Curve, LINEAR, Node, file};

/// A node that stands still from its first key to its second, and one that moves a little.
pub fn two_keys() -> String {
    let still = Curve::lines(&[(0.0, 0.0), (1.0, 0.0)]);
    let moved = Curve::lines(&[(0.0, 0.0), (1.0, 0.1)]);
    let curves = vec![(0, TRANSLATION, 0, still), (1, ROTATION, 2, moved)];
    file(
        &[Node::default(), below(0, 1.0)],
        &[base(curves)],
        (0.0, 1.0),
    )
}

/// A triangle that nothing moves.
pub fn alone() -> String {
    file(&[Node::default()], &[base(Vec::new())], (0.0, 1.0))
}

/// Ten turns in two seconds about two axes, between two keys each.
pub fn spin() -> String {
    let turned = |degrees: f64| Curve::lines(&[(0.0, 0.0), (2.0, degrees)]);
    let curves = vec![
        (0, ROTATION, 1, turned(3600.0)),
        (1, ROTATION, 0, turned(-3600.0)),
    ];
    file(
        &[Node::default(), below(0, 1.0)],
        &[base(curves)],
        (0.0, 2.0),
    )
}

/// A key in every frame, and none that others say: `count` of them.
pub fn shaken(count: usize) -> String {
    let any = |scale: f64, from: f64, skip: usize| {
        let values = shares(count + skip).skip(skip).enumerate();
        let points = values.map(|(i, share)| (i as f64 / 30.0, from + scale * share));
        Curve::of(&points.collect::<Vec<_>>(), LINEAR)
    };
    let curves = vec![
        (0, TRANSLATION, 0, any(0.5, 0.0, 0)),
        (0, ROTATION, 1, any(40.0, 0.0, 7)),
        (0, SCALE, 2, any(0.2, 1.0, 11)),
    ];
    let end = count.saturating_sub(1) as f64 / 30.0;
    file(&[Node::default()], &[base(curves)], (0.0, end))
}

/// Eight joints, 20 m from each to the next, that bend slowly: f32 rounds a tip of it by a hundredth of a millimetre.
pub fn giant() -> String {
    let nodes: Vec<Node> = (0..8)
        .map(|number: usize| match number.checked_sub(1) {
            None => Node::default(),
            Some(above) => below(above, 20.0),
        })
        .collect();
    let mut curves = Vec::new();
    for node in 0..nodes.len() {
        for axis in 0..3 {
            let values = shares(5 + 3 * node + axis)
                .skip(3 * node + axis)
                .enumerate();
            let points = values.map(|(i, share)| (i as f64 * 0.75, 60.0 * share - 30.0));
            let curve = Curve::of(&points.collect::<Vec<_>>(), CUBIC);
            curves.push((node, ROTATION, axis, curve));
        }
    }
    file(&nodes, &[base(curves)], (0.0, 3.0))
}

fn below(parent: usize, metres: f64) -> Node {
    Node {
        parent: Some(parent),
        vectors: vec![(TRANSLATION, [0.0, metres, 0.0])],
        ..Node::default()
    }
}
