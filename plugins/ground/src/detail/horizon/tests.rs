use super::*;
use crate::detail::mesh::mesh;
use crate::detail::select::select;
use crate::detail::{DetailVertex, Lens};
use bevy::math::{DMat4, DQuat, DVec2, EulerRot, UVec2};
use dolomite_terrain::{Fractal, GroundPoint, GroundRect, Layer, Source, Terrain, TerrainData};

const SIZE: UVec2 = UVec2::new(320, 180);
const NEAR: f64 = 0.1;

/// Ridges of all sizes.
fn ground(seed: u32) -> Terrain {
    let hills = Fractal {
        seed,
        octaves: 8,
        amplitude: 120.0,
        wavelength: 300.0,
        ..Fractal::default()
    };
    Terrain::new(TerrainData {
        extent: GroundRect::square(DVec2::new(-7e4, 5e4), 2048.0),
        layers: vec![Layer {
            source: Source::Fractal(hills),
            mask: None,
        }],
        base: 0.0,
        sea_level: None,
    })
    .expect("valid")
}

/// A view, what it draws, and its horizon; all relative to an anchor at `anchor_height`.
struct Seen {
    view: DetailView,
    picture: CullView,
    places: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    horizon: Option<Horizon>,
}

fn look(cells: &mut DetailCells, eye: DVec3, turn: [f64; 3], fov: f64) -> Seen {
    let rotation = DQuat::from_euler(EulerRot::YXZ, turn[0], turn[1], turn[2]);
    let tangent = bevy::math::ops::tan(fov as f32 / 2.0);
    let lens = Lens::Perspective(tangent.into());
    let mut view = DetailView::new(eye, rotation, lens, SIZE, NEAR);
    view.set_metric(&crate::detail::TerrainLod {
        metric: crate::detail::Metric::ErrorBound { pixels: 2.0 },
        ..Default::default()
    });
    let anchor = view.anchor().as_dvec2();
    // Another height than 0, so that none is forgotten.
    let anchor_height = 16.0_f32;
    let from_anchor = eye - DVec3::new(anchor.x, anchor_height.into(), anchor.y);
    let aspect = f64::from(SIZE.x) / f64::from(SIZE.y);
    let clip = DMat4::perspective_infinite_reverse_rh(fov, aspect, NEAR)
        * DMat4::from_rotation_translation(rotation, from_anchor).inverse();
    let picture = CullView {
        clip: clip.as_mat4(),
        half_size: SIZE.as_vec2() * 0.5,
        one_sided: true,
    };
    let selection = select(cells, &view, 1 << 18);
    let drawn = mesh(cells, &selection);
    let place = |vertex: &DetailVertex| {
        let xz = vertex.point.relative_to(GroundPoint::from(anchor));
        Vec3::new(xz.x, vertex.height - anchor_height, xz.y)
    };
    let horizon = HorizonView::new(cells, &view, &picture, anchor_height)
        .map(|horizon| Horizon::of(horizon, cells, &selection, &view, anchor_height));
    Seen {
        view,
        picture,
        places: drawn.vertices.iter().map(place).collect(),
        triangles: drawn.triangles,
        horizon,
    }
}

impl Seen {
    fn corners(&self, triangle: [u32; 3]) -> [Vec3; 3] {
        triangle.map(|k| self.places[k as usize])
    }

    /// Triangles of the picture, and which of them are hidden.
    fn sorted(&self) -> (Vec<[Vec3; 3]>, Vec<[Vec3; 3]>) {
        let shown = self
            .triangles
            .iter()
            .map(|&triangle| self.corners(triangle));
        let shown = shown.filter(|corners| !self.picture.hides(*corners));
        let horizon = self.horizon.as_ref();
        shown.partition(|corners| !horizon.is_some_and(|horizon| horizon.hides(*corners)))
    }
}

/// Share of the way from `from` to `to` at which a triangle is crossed from its front, in f64.
fn crossed([a, b, c]: [DVec3; 3], from: DVec3, to: DVec3) -> Option<f64> {
    let way = to - from;
    let normal = (b - a).cross(c - a);
    let against = normal.dot(way);
    if against >= 0.0 {
        return None;
    }
    let share = normal.dot(a - from) / against;
    let at = from + way * share;
    let inside = [(a, b), (b, c), (c, a)]
        .into_iter()
        .all(|(p, q)| (q - p).cross(at - p).dot(normal) >= 0.0);
    inside.then_some(share)
}

fn hash(k: u32, salt: u32) -> f64 {
    let mut h = k.wrapping_mul(0x9e37_79b9) ^ salt.wrapping_mul(0x85eb_ca6b);
    h = (h ^ (h >> 16)).wrapping_mul(0x7feb_352d);
    h = (h ^ (h >> 15)).wrapping_mul(0x846c_a68b);
    f64::from(h ^ (h >> 16)) / f64::from(u32::MAX)
}

/// A place over the ground.
fn eye(ground: &Terrain, k: u32, above: f64) -> DVec3 {
    let centre = ground.extent().centre();
    let xz = centre + DVec2::new(hash(k, 1) - 0.5, hash(k, 2) - 0.5) * 1200.0;
    DVec3::new(xz.x, ground.sample_f64(xz).height + above, xz.y)
}

#[test]
fn what_is_hidden_is_behind_ground_that_faces_the_eye() {
    let (mut hidden, mut all) = (0, 0);
    for k in 0..12 {
        let ground = ground(k / 4);
        let mut cells = DetailCells::new(ground.clone(), 0.5);
        let above = [1.7, 0.3, 40.0, 6.0][k as usize % 4];
        let turn = [
            std::f64::consts::TAU * hash(k, 3),
            0.9 * (hash(k, 4) - 0.6),
            [0.0, 0.4, std::f64::consts::PI][k as usize % 3],
        ];
        let seen = look(&mut cells, eye(&ground, k, above), turn, 0.4 + hash(k, 5));
        let (shown, behind) = seen.sorted();
        all += shown.len() + behind.len();
        hidden += behind.len();
        let from = DVec3::from(Vec3::from(seen.horizon.as_ref().expect("level").view.eye));
        let solid: Vec<[DVec3; 3]> = seen
            .triangles
            .iter()
            .map(|&triangle| seen.corners(triangle).map(|at| at.as_dvec3()))
            .collect();
        let every = (behind.len() / 60).max(1);
        for corners in behind.iter().step_by(every) {
            let [a, b, c] = corners.map(|at| at.as_dvec3());
            for to in [a, b, c, (a + b + c) / 3.0] {
                // What is off the picture is not claimed.
                let clip = seen.picture.clip.as_dmat4() * to.extend(1.0);
                if clip.x.abs() > clip.w || clip.y.abs() > clip.w {
                    continue;
                }
                let nearest = solid
                    .iter()
                    .filter_map(|triangle| crossed(*triangle, from, to))
                    .filter(|&share| share * from.distance(to) > NEAR)
                    .fold(f64::MAX, f64::min);
                assert!(nearest < 1.0 - 1e-6, "camera {k}: {to} at {nearest}");
            }
        }
    }
    println!("{hidden} of {all} hidden");
    // Of rough ground seen at eye height a good part is.
    assert!(hidden * 4 > all, "{hidden} of {all}");
}

#[test]
fn nearly_all_that_a_wall_hides_is_found() {
    // A plain behind a dune that is higher than the eye.
    let data = TerrainData {
        extent: GroundRect::square(DVec2::ZERO, 1024.0),
        layers: vec![
            Layer {
                source: Source::Fractal(Fractal {
                    octaves: 4,
                    amplitude: 2.0,
                    wavelength: 20.0,
                    ..Fractal::default()
                }),
                mask: None,
            },
            Layer {
                source: Source::Hill(dolomite_terrain::Hill {
                    centre: DVec2::new(0.0, -60.0),
                    radius: 50.0,
                    height: 40.0,
                }),
                mask: None,
            },
        ],
        base: 0.0,
        sea_level: None,
    };
    let mut cells = DetailCells::new(Terrain::new(data).expect("valid"), 0.5);
    let seen = look(&mut cells, DVec3::new(0.0, 8.0, 0.0), [0.0; 3], 0.6);
    let (shown, behind) = seen.sorted();
    let beyond = |triangles: &[[Vec3; 3]]| {
        let anchor = f64::from(seen.view.anchor[1]) as f32;
        // Far behind the hill, near its axis.
        let there = |c: &&[Vec3; 3]| {
            c.iter()
                .all(|p| p.z + anchor < -140.0 && p.x.abs() < -0.1 * p.z)
        };
        triangles.iter().filter(there).count()
    };
    let (left, found) = (beyond(&shown), beyond(&behind));
    println!("{found} of {} beyond the hill; {left} left", found + left);
    assert!(found > 100 && left * 20 < found, "{found} {left}");
}

#[test]
fn who_may_look_below_the_ground_hides_nothing() {
    let ground = ground(1);
    let mut cells = DetailCells::new(ground.clone(), 0.5);
    let level = [0.3, -0.1, 0.0];
    // Below, at the very height, and with ground nearer than the near plane.
    for above in [-30.0, 0.0, 0.05] {
        let seen = look(&mut cells, eye(&ground, 5, above), level, 1.0);
        assert!(seen.horizon.as_ref().expect("level").blind, "{above}");
        assert_eq!(seen.sorted().1.len(), 0, "{above}");
    }
    let above = look(&mut cells, eye(&ground, 5, 1.7), level, 1.0);
    assert!(!above.horizon.as_ref().expect("level").blind);
    // Straight down; beyond the border; parallel rays.
    let down = look(&mut cells, eye(&ground, 5, 9.0), [0.0, -1.5, 0.0], 1.0);
    assert!(down.horizon.is_none());
    let outside = DVec3::new(-7e4 + 1500.0, 300.0, 5e4);
    assert!(look(&mut cells, outside, level, 1.0).horizon.is_none());
    let mut parallel = above.view;
    parallel.orthographic = 1.0;
    assert!(HorizonView::new(&cells, &parallel, &above.picture, 16.0).is_none());
}

#[test]
fn numbers_that_are_none_hide_nothing_and_are_not_hidden() {
    let view = HorizonView {
        nearest: 0.1,
        ahead: [0.0, -1.0],
        reach: 1.0,
        pixel: 0.01,
        near_reach: 0.2,
        ..HorizonView::default()
    };
    let mut horizon = Horizon::new(view);
    let (low, high) = (Vec3::new(-5.0, 9.0, -20.0), Vec3::new(5.0, 9.0, -10.0));
    let behind = [-1.0, 0.0, 1.0].map(|x| Vec3::new(x, x, -100.0));
    horizon.draw(low.with_y(f32::NAN), high);
    horizon.draw(low.with_y(f32::INFINITY), high);
    horizon.close();
    assert!(!horizon.hides(behind));
    horizon.draw(low, high);
    horizon.close();
    assert!(horizon.hides(behind));
    for wrong in [f32::NAN, f32::INFINITY] {
        for k in 0..3 {
            let mut corners = behind;
            corners[1][k] = wrong;
            assert!(!horizon.hides(corners), "{corners:?}");
        }
    }
    // Nearer than the square, and beside it.
    let near = behind.map(|at| at.with_z(-5.0));
    let beside = behind.map(|at| at + Vec3::X * 60.0);
    let above = behind.map(|at| at.with_y(500.0));
    assert!(![near, beside, above].iter().any(|at| horizon.hides(*at)));
}
