//! Cube maps of directions, and light gathered from them over a lobe.

use bevy::math::{Vec3, ops};
use bevy::tasks::{ComputeTaskPool, TaskPool};

/// Directions that a texel of the lighting maps gathers from.
const SAMPLES: u32 = 96;

/// A cube map.
#[derive(Clone, Debug, PartialEq)]
pub struct Cube {
    /// Texels along a face.
    pub side: u32,
    /// Six faces, row by row.
    pub texels: Vec<Vec3>,
}

impl Cube {
    /// The texel in a direction.
    pub fn look(&self, direction: Vec3) -> Vec3 {
        let (face, u, v) = face_of(direction);
        let at =
            |t: f32| ((t * 0.5 + 0.5) * self.side as f32).clamp(0.0, self.side as f32 - 1.0) as u32;
        self.texels[((face * self.side + at(v)) * self.side + at(u)) as usize]
    }

    /// Mean over a lobe about `n`: the cosine lobe for roughness 1, a narrower power of it below
    /// (Blinn-Phong exponents for GGX: Karis 2013).
    pub fn gather(&self, n: Vec3, roughness: f32) -> Vec3 {
        let a = roughness * roughness;
        let exponent = (2.0 / (a * a) - 1.0).clamp(1.0, 2000.0);
        let (x, y) = n.any_orthonormal_pair();
        let sum: Vec3 = (0..SAMPLES)
            .map(|i| {
                // Fibonacci lattice, warped to the lobe cos^exponent.
                let share = (i as f32 + 0.5) / SAMPLES as f32;
                let angle = i as f32 * 2.399_963; // the golden angle
                let cos = ops::powf(share, 1.0 / (exponent + 1.0));
                let sin = (1.0 - cos * cos).max(0.0).sqrt();
                let (s, c) = ops::sin_cos(angle);
                self.look(x * (sin * c) + y * (sin * s) + n * cos)
            })
            .sum();
        sum / SAMPLES as f32
    }
}

/// Bevy's cube maps are left-handed: +z and −z swap (as in its atmosphere's environment map).
fn direction(face: u32, u: f32, v: f32) -> Vec3 {
    let d = match face {
        0 => Vec3::new(1.0, -v, -u),
        1 => Vec3::new(-1.0, -v, u),
        2 => Vec3::new(u, 1.0, v),
        3 => Vec3::new(u, -1.0, -v),
        4 => Vec3::new(u, -v, 1.0),
        _ => Vec3::new(-u, -v, -1.0),
    };
    (d * Vec3::new(1.0, 1.0, -1.0)).normalize()
}

fn face_of(direction: Vec3) -> (u32, f32, f32) {
    let d = direction * Vec3::new(1.0, 1.0, -1.0);
    let size = d.abs();
    if size.x >= size.y && size.x >= size.z {
        let (u, face) = if d.x > 0.0 { (-d.z, 0) } else { (d.z, 1) };
        (face, u / size.x, -d.y / size.x)
    } else if size.y >= size.z {
        let (v, face) = if d.y > 0.0 { (d.z, 2) } else { (-d.z, 3) };
        (face, d.x / size.y, v / size.y)
    } else {
        let (u, face) = if d.z > 0.0 { (d.x, 4) } else { (-d.x, 5) };
        (face, u / size.z, -d.y / size.z)
    }
}

/// Who makes texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cores {
    /// All of them, before the call returns.
    All,
    /// The one that calls.
    One,
}

/// Six faces of `side` × `side`, each texel by the direction of its centre; the same bits by one core
/// or by all.
pub fn face_texels(side: u32, cores: Cores, texel: impl Fn(Vec3) -> Vec3 + Sync) -> Vec<Vec3> {
    let centre = |i: u32| (2.0 * i as f32 + 1.0) / side as f32 - 1.0;
    let make = |face: u32| {
        (0..side * side)
            .map(|i| texel(direction(face, centre(i % side), centre(i / side))))
            .collect::<Vec<_>>()
    };
    let make = &make;
    let faces: Vec<Vec<Vec3>> = match cores {
        Cores::All => ComputeTaskPool::get_or_init(TaskPool::default).scope(|scope| {
            for face in 0..6 {
                scope.spawn(async move { make(face) });
            }
        }),
        Cores::One => (0..6).map(make).collect(),
    };
    faces.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_and_directions_are_inverse() {
        for face in 0..6 {
            for (u, v) in [(0.0, 0.0), (0.5, -0.25), (-0.75, 0.6)] {
                let (f, x, y) = face_of(direction(face, u, v));
                // Three roundings of numbers up to 1.
                assert!(
                    f == face && (x - u).abs() < 4e-7 && (y - v).abs() < 4e-7,
                    "{face} {u} {v}: {f} {x} {y}"
                );
            }
        }
    }

    #[test]
    fn an_even_sky_lights_evenly() {
        let sky = Cube {
            side: 4,
            texels: vec![Vec3::ONE; 96],
        };
        for roughness in [0.2, 0.5, 1.0] {
            // A mean of ones.
            assert!(
                (sky.gather(Vec3::Y, roughness) - Vec3::ONE)
                    .abs()
                    .max_element()
                    < 1e-5
            );
        }
    }

    #[test]
    fn one_core_makes_what_all_make() {
        let texel = |direction: Vec3| direction * 3.0;
        let [all, one] = [Cores::All, Cores::One].map(|cores| face_texels(7, cores, texel));
        assert_eq!(all.len(), 6 * 49);
        assert_eq!(all, one);
    }
}
