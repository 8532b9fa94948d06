//! Two-bone inverse kinematics in closed form: the law of cosines in the plane that the limb bends in.

use bevy::math::{Mat3, Quat, Vec3, ops};

/// A limb: hip, knee, ankle, or shoulder, elbow, wrist. Metres, all in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limb {
    /// Where it hangs.
    pub root: Vec3,
    /// Where it bends.
    pub middle: Vec3,
    /// What reaches for the target.
    pub end: Vec3,
}

/// How to turn both bones, in the same frame: `new rotation = turn · old rotation`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bend {
    /// Of the upper bone.
    pub upper: Quat,
    /// Of the lower bone.
    pub lower: Quat,
    /// Where the end comes to lie: the target, or what is nearest to it within reach.
    pub end: Vec3,
}

/// Up to this part of its length a limb reaches exactly. Beyond, and as near to its root, it slows down, so
/// that a target which runs away does not snap it straight.
pub const EXACT_REACH: f32 = 0.98;

/// Turns a limb so that its end reaches `target`. It bends in the plane that it bends in now, turned with
/// it; a straight limb bends towards `hint`, which need not be of unit length.
#[must_use]
pub fn bend(limb: &Limb, target: Vec3, hint: Vec3) -> Bend {
    let (upper, lower) = (limb.middle - limb.root, limb.end - limb.middle);
    let (a, b) = (upper.length(), lower.length());
    let whole = a + b;
    let chord = limb.end - limb.root;
    let still = Bend {
        upper: Quat::IDENTITY,
        lower: Quat::IDENTITY,
        end: limb.end,
    };
    if !(a > 1e-6 && b > 1e-6 && whole.is_finite() && target.is_finite()) {
        return still;
    }
    let old = chord.normalize_or(upper / a);
    let new = (target - limb.root).normalize_or(old);
    let reach = within((target - limb.root).length(), (a - b).abs(), whole);
    // Towards the knee, at right angles to the chord.
    let towards = |way: Vec3, axis: Vec3| {
        let side = way - axis * way.dot(axis);
        (side.length() > 1e-4 * way.length()).then(|| side.normalize())
    };
    let side = towards(upper, old)
        .or_else(|| towards(hint, old))
        .unwrap_or_else(|| old.any_orthonormal_vector());
    let turned = Quat::from_rotation_arc(old, new) * side;
    let turned = towards(turned, new).unwrap_or_else(|| new.any_orthonormal_vector());
    let along = (a * a - b * b + reach * reach) / (2.0 * reach);
    let across = (a * a - along * along).max(0.0).sqrt();
    let middle = limb.root + new * along + turned * across;
    let end = limb.root + new * reach;
    // The normal of the plane; bones turn about it, and with it.
    let (from, to) = (old.cross(side), new.cross(turned));
    Bend {
        upper: between(upper / a, from, (middle - limb.root) / a, to),
        lower: between(lower / b, from, (end - middle) / b, to),
        end,
    }
}

/// The distance that is reached for: itself in the middle, and smooth towards both limits.
fn within(distance: f32, least: f32, most: f32) -> f32 {
    let soft = (1.0 - EXACT_REACH) * most;
    if distance > most - soft {
        most - soft * ops::exp(-(distance - most + soft) / soft)
    } else if distance < least + soft {
        least + soft * ops::exp((distance - least - soft) / soft)
    } else {
        distance
    }
}

/// The rotation that takes direction `a` and normal `m` to `b` and `n`.
fn between(a: Vec3, m: Vec3, b: Vec3, n: Vec3) -> Quat {
    let frame = |x: Vec3, z: Vec3| {
        let x = x.normalize();
        let z = (z - x * z.dot(x)).normalize();
        Mat3::from_cols(x, z.cross(x), z)
    };
    Quat::from_mat3(&(frame(b, n) * frame(a, m).transpose())).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_mt::Mt;

    fn applied(limb: &Limb, bend: &Bend) -> (Vec3, Vec3) {
        let middle = limb.root + bend.upper * (limb.middle - limb.root);
        (middle, middle + bend.lower * (limb.end - limb.middle))
    }

    #[test]
    fn what_is_within_reach_is_reached() {
        let mut random = Mt::new(5);
        let mut unit = move || random.next_u32() as f32 / u32::MAX as f32 * 2.0 - 1.0;
        let mut vector = move || Vec3::new(unit(), unit(), unit());
        let mut worst = 0.0_f32;
        let mut exact = 0;
        for _ in 0..20_000 {
            let root = vector();
            let middle = root + vector().normalize_or(Vec3::Y) * 0.43;
            let end = middle + vector().normalize_or(Vec3::Y) * 0.41;
            let limb = Limb { root, middle, end };
            let target = root + vector();
            let bend = bend(&limb, target, Vec3::Z);
            let (knee, ankle) = applied(&limb, &bend);
            let distance = target.distance(root);
            assert!(
                ankle.distance(bend.end) < 2e-6,
                "{}",
                ankle.distance(bend.end)
            );
            assert!((knee.distance(root) - 0.43).abs() < 1e-6);
            if (0.04..0.98 * 0.84).contains(&distance) {
                worst = worst.max(ankle.distance(target));
                exact += 1;
            } else {
                // As near as it goes, in the right direction.
                let way = (ankle - root).normalize().dot((target - root).normalize());
                assert!(way > 0.99999, "{way}");
                assert!(ankle.distance(root) <= 0.84 + 1e-6);
            }
        }
        assert!(exact > 5000);
        // Positions are near 2 m, where an f32 has 2.4e-7 m; some rotations of half a metre are added.
        assert!(worst < 2e-6, "{worst}");
    }

    #[test]
    fn the_knee_keeps_its_direction() {
        let limb = Limb {
            root: Vec3::Y,
            middle: Vec3::new(0.0, 0.55, 0.05),
            end: Vec3::new(0.0, 0.1, 0.0),
        };
        for target in [
            Vec3::new(0.0, 0.3, 0.0),
            Vec3::new(0.1, 0.2, 0.2),
            Vec3::new(0.0, 0.15, -0.3),
        ] {
            let (knee, _) = applied(&limb, &bend(&limb, target, Vec3::Z));
            let chord = (target - limb.root).normalize();
            let side = (knee - limb.root) - chord * (knee - limb.root).dot(chord);
            assert!(side.z > 0.0, "{target}: {side}");
        }
        // A straight one bends where it is told to.
        let straight = Limb {
            root: Vec3::Y,
            middle: Vec3::new(0.0, 0.5, 0.0),
            end: Vec3::ZERO,
        };
        let (knee, _) = applied(
            &straight,
            &bend(&straight, Vec3::new(0.0, 0.3, 0.0), Vec3::Z),
        );
        assert!(knee.z > 0.1);
    }

    #[test]
    fn reach_ends_without_a_kink() {
        let reach = |distance| within(distance, 0.1, 1.0);
        let mut before = reach(0.0);
        let mut slope: Option<f32> = None;
        for step in 1..=2000 {
            let now = reach(step as f32 * 0.001);
            let rise = (now - before) / 0.001;
            assert!((-1e-3..1.001).contains(&rise), "{step}: {rise}");
            if let Some(slope) = slope {
                // e-folding over 2 cm: the slope changes by at most 1/20 in a millimetre.
                assert!((rise - slope).abs() < 0.06, "{step}");
            }
            slope = Some(rise);
            before = now;
        }
    }

    #[test]
    fn hostile_limbs_do_no_harm() {
        let point = Limb {
            root: Vec3::ONE,
            middle: Vec3::ONE,
            end: Vec3::ONE,
        };
        assert_eq!(bend(&point, Vec3::ZERO, Vec3::Z).upper, Quat::IDENTITY);
        let limb = Limb {
            root: Vec3::Y,
            middle: Vec3::new(0.0, 0.5, 0.1),
            end: Vec3::ZERO,
        };
        for target in [Vec3::NAN, Vec3::INFINITY, limb.root, Vec3::Y * 2.0] {
            let bend = bend(&limb, target, Vec3::Z);
            assert!(bend.upper.is_finite() && bend.lower.is_finite() && bend.end.is_finite());
        }
    }
}
