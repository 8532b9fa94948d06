//! Zones of logic: points that go through boxes at 0.1 to 1000 m/s. Comings and goings take turns, and come when f64
//! says so.

use bevy::math::{DVec3, ops};
use dolomite_logic::parts::{ZoneKind, crossing};
use dolomite_logic::random::Random;
use serde_json::{Value, json};

/// Steps of a point through a box.
const STEPS: usize = 50;

/// A place on a face is so near to it, metres: 16 roundings of metres in f64.
const ON_FACE: f64 = 1e-9;

#[derive(Default)]
struct Tally {
    steps: u64,
    crossings: u64,
    through: u64,
    missed: u64,
    doubled: u64,
    disordered: u64,
}

/// Counts at least so many crossings.
pub fn zones(seed: u32, count: usize) -> Value {
    let mut random = Random::new(u64::from(seed) + 10);
    let mut tally = Tally::default();
    while tally.crossings < count as u64 {
        walk(&mut random, &mut tally);
    }
    json!({
        "steps": tally.steps, "crossings": tally.crossings, "through_in_a_step": tally.through,
        "missed": tally.missed, "doubled": tally.doubled, "disordered": tally.disordered,
    })
}

fn walk(random: &mut Random, tally: &mut Tally) {
    let mut place = || DVec3::from_array([0; 3].map(|_| f64::from(random.signed(4.0))));
    let half = place().abs();
    let mut at = place();
    let aims: Vec<DVec3> = (0..STEPS).map(|_| place()).collect();
    let mut inside = at.abs().cmple(half).all();
    for aim in aims {
        let speed = 0.1 * f64::from(ops::powf(10_000.0, random.unit())) / 64.0;
        let next = at + (aim - at).normalize_or(DVec3::X) * speed;
        let found = crossing(at, next, half, false);
        let mut time = 0.0;
        tally.steps += 1;
        for (kind, when) in found.into_iter().flatten() {
            tally.crossings += 1;
            // There the way is on the box's side.
            let over = (at.lerp(next, when).abs() - half).max_element();
            let ordered = (time..=1.0).contains(&when) && over.abs() < ON_FACE;
            tally.disordered += u64::from(!ordered);
            tally.doubled += u64::from((kind == ZoneKind::Enter) == inside);
            inside = kind == ZoneKind::Enter;
            time = when;
        }
        tally.through += u64::from(found[1].is_some());
        let truly = next.abs().cmple(half).all();
        // Nothing was said, but places on the way are inside.
        let unseen = found[0].is_none()
            && !inside
            && (1..64).any(|part| {
                let middle = at.lerp(next, f64::from(part) / 64.0);
                middle.abs().cmplt(half - ON_FACE).all()
            });
        tally.missed += u64::from(inside != truly) + u64::from(unseen);
        inside = truly;
        at = next;
    }
}
