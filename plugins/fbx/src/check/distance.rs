//! How far two sets of points are from each other.

use super::played::Shape;
use super::truth::{Body, Space};
use glam::DVec3;
use std::collections::BTreeMap;

/// How far two sets of points are from each other, in any order: the largest distance from a point of
/// either to the nearest one of the other (Hausdorff). Infinite if one is empty and the other is not.
pub fn hausdorff(a: &[DVec3], b: &[DVec3]) -> f64 {
    farthest_nearest(a, b).max(farthest_nearest(b, a))
}

/// The largest distance of points of `from` to their nearest ones of `to`. `to` is cut into slices
/// along X, which are looked at outwards until none can be nearer.
fn farthest_nearest(from: &[DVec3], to: &[DVec3]) -> f64 {
    if from.is_empty() {
        return 0.0;
    }
    let mut sorted = to.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x));
    let nearest = |p: &DVec3| {
        let start = sorted.partition_point(|q| q.x < p.x);
        let mut best = f64::INFINITY;
        for q in &sorted[start..] {
            if q.x - p.x >= best {
                break;
            }
            best = best.min(p.distance(*q));
        }
        for q in sorted[..start].iter().rev() {
            if p.x - q.x >= best {
                break;
            }
            best = best.min(p.distance(*q));
        }
        best
    };
    from.iter().map(nearest).fold(0.0, f64::max)
}

/// The largest distance of vertices of `shapes` from the vertices of `bodies` that they were made of,
/// metres. A mesh that is shown several times is held against the body that it is nearest to.
pub fn vertex_error(
    shapes: &[Shape],
    bodies: &[Body],
    space: &Space,
    sources: &BTreeMap<usize, (u32, Vec<u32>)>,
) -> f64 {
    let mut farthest = 0.0_f64;
    for shape in shapes {
        let Some((mesh, vertices)) = sources.get(&shape.mesh) else {
            return f64::INFINITY;
        };
        let against = |body: &Body| {
            let pairs = shape.points.iter().zip(vertices);
            let far = |(point, &vertex): (&DVec3, &u32)| {
                let truth = body.points.get(vertex as usize).map(|p| space.to_gltf(*p));
                truth.map_or(f64::INFINITY, |truth| point.distance(truth))
            };
            pairs.map(far).fold(0.0, f64::max)
        };
        let same = bodies.iter().filter(|body| body.mesh == *mesh);
        farthest = farthest.max(same.map(against).fold(f64::INFINITY, f64::min));
    }
    farthest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_farthest_of_the_nearest_counts_both_ways() {
        let a = [DVec3::ZERO, DVec3::X];
        assert_eq!(hausdorff(&a, &a), 0.0);
        assert_eq!(
            hausdorff(&a, &[DVec3::X, DVec3::ZERO, DVec3::new(1.0, 2.0, 0.0)]),
            2.0
        );
        assert_eq!(hausdorff(&a, &[]), f64::INFINITY);
        assert_eq!(hausdorff(&[], &[]), 0.0);
    }
}
