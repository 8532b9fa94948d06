//! What is left of a wish between planes: slide, crease, corner.

use bevy::math::DVec3;

/// Into a plane by less than this part of the wish is along it: rounding of a projection is some 1e-16.
const INTO: f64 = 1e-12;

/// The way nearest to `wish` that goes into none of the planes with these normals (each of length 1).
///
/// That is the wish itself, or it lies in one plane, or in the crease of two, or there is none but to stay: all of
/// these are tried, and the nearest that no plane forbids is taken. It is exact for any number of planes, since the
/// ways that are allowed are a convex cone.
#[must_use]
pub fn allowed(wish: DVec3, normals: &[DVec3]) -> DVec3 {
    let length = wish.length();
    let into = |way: DVec3| {
        normals
            .iter()
            .any(|normal| way.dot(*normal) < -INTO * length)
    };
    if !into(wish) {
        return wish;
    }
    let mut best = DVec3::ZERO;
    let mut nearest = length * length;
    let mut offer = |way: DVec3| {
        let apart = way.distance_squared(wish);
        if apart < nearest && !into(way) {
            (best, nearest) = (way, apart);
        }
    };
    for (i, &one) in normals.iter().enumerate() {
        if wish.dot(one) < 0.0 {
            // Twice, since the first leaves the rounding of a long wish.
            let slide = wish - one * wish.dot(one);
            offer(slide - one * slide.dot(one));
        }
        for &two in &normals[i + 1..] {
            if let Some(crease) = one.cross(two).try_normalize() {
                offer(crease * wish.dot(crease));
            }
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plane_crease_and_corner() {
        let wish = DVec3::new(1.0, -1.0, 0.5);
        assert_eq!(allowed(wish, &[]), wish);
        assert_eq!(allowed(wish, &[DVec3::Y]), DVec3::new(1.0, 0.0, 0.5));
        assert_eq!(
            allowed(wish, &[DVec3::Y, -DVec3::X]),
            DVec3::new(0.0, 0.0, 0.5)
        );
        let corner = [DVec3::Y, -DVec3::X, -DVec3::Z];
        assert_eq!(allowed(wish, &corner), DVec3::ZERO);
        // The second plane only seems to stop what the first turns away.
        let slope = DVec3::new(-0.6, 0.8, 0.0);
        let way = allowed(-DVec3::Y, &[slope, DVec3::Y]);
        assert_eq!(way, DVec3::ZERO);
    }

    /// Held to what makes a point of a cone the nearest to a wish (J. J. Moreau, 1962): what is lost is at right angles
    /// to it, and leads away from every way that is allowed.
    #[test]
    fn the_nearest_of_all_allowed_ways() {
        let mut state = 1_u64;
        let mut unit = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
        };
        let (mut free, mut stopped) = (0, 0);
        for _ in 0..20_000 {
            let wish = DVec3::new(unit(), unit(), unit());
            let normals: Vec<DVec3> = (0..5)
                .map(|_| DVec3::new(unit(), unit() + 0.5, unit()).normalize())
                .collect();
            let found = allowed(wish, &normals);
            let allowed_way = |way: DVec3| normals.iter().all(|n| way.dot(*n) >= -1e-11);
            assert!(allowed_way(found), "{found}");
            let lost = wish - found;
            assert!(lost.dot(found).abs() < 1e-12, "{lost} {found}");
            for _ in 0..20 {
                let other = DVec3::new(unit(), unit() + 0.5, unit());
                if allowed_way(other) {
                    assert!(lost.dot(other) < 1e-11, "{other} is nearer than {found}");
                    free += 1;
                }
            }
            stopped += u32::from(found == DVec3::ZERO);
        }
        assert!(free > 10_000 && stopped > 1000, "{free} {stopped}");
    }
}
