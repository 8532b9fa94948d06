//! What breaks renderers: lights about the camera, lights that are hardly there, numbers that are none, triangles
//! without area.

use glam::DVec3;

use crate::random::Random;
use crate::scene::{Camera, Lamp, LampKind, Mesh, Object, Pose, Scene, Shape};

/// A light with good numbers in a bad place.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Place {
    /// The camera is within the range.
    HoldsCamera,
    /// The sphere of its range is cut by the near plane; the camera may be in it or not.
    CutsNear,
    /// Its whole sphere is smaller than a pixel.
    SubPixel,
    /// Behind the camera, reaching to what is before it.
    Behind,
    /// Exactly where the camera is.
    AtCamera,
    /// A cone that is nearly a line.
    Needle,
    /// A cone that is nearly a half space.
    Wide,
}

impl Place {
    /// Every place.
    pub const ALL: [Self; 7] = [
        Self::HoldsCamera,
        Self::CutsNear,
        Self::SubPixel,
        Self::Behind,
        Self::AtCamera,
        Self::Needle,
        Self::Wide,
    ];

    /// A random light in this place, of some lux at half of its range.
    pub fn lamp(self, camera: &Camera, random: &mut Random) -> Lamp {
        let forward = camera.rotation * DVec3::NEG_Z;
        let pixel = 2.0 * (0.5 * camera.fov_y).tan() / f64::from(camera.height);
        let ahead = |random: &mut Random, depth: f64| {
            let [x, y] = [camera.width, camera.height].map(|n| random.unit() * f64::from(n));
            camera.ray(x, y).at(depth)
        };
        let (position, range) = match self {
            Self::HoldsCamera => {
                let range = random.magnitude(0.5, 20.0);
                let away = random.between(0.05, 0.95) * range * random.direction();
                (camera.position + away, range)
            }
            Self::CutsNear => {
                let range = random.magnitude(0.02, 5.0);
                let depth = camera.near + random.between(-0.9, 0.9) * range;
                (
                    ahead(random, camera.near) + (depth - camera.near) * forward,
                    range,
                )
            }
            Self::SubPixel => {
                let depth = random.between(1.0, 10.0);
                (ahead(random, depth), 0.4 * pixel * depth)
            }
            Self::Behind => {
                let away = random.between(0.1, 5.0);
                let range = away + random.between(1.0, 10.0);
                (camera.position - away * forward, range)
            }
            Self::AtCamera => (camera.position, random.between(1.0, 10.0)),
            Self::Needle | Self::Wide => {
                let depth = random.between(1.0, 8.0);
                (ahead(random, depth), random.between(1.0, 8.0))
            }
        };
        let position = position.as_vec3().as_dvec3();
        let range = f64::from(range as f32);
        let kind = match self {
            Self::Needle | Self::Wide => {
                let needle = self == Self::Needle;
                let outer = f64::from(if needle { 0.004_f32 } else { 1.57 });
                LampKind::Spot {
                    position,
                    range,
                    direction: random.direction().as_vec3().as_dvec3(),
                    inner: 0.5 * outer,
                    outer,
                }
            }
            _ => LampKind::Point { position, range },
        };
        let lumens = std::f64::consts::PI * range * range * random.between(0.5, 2.0);
        Lamp::new(f64::from(lumens as f32), kind)
    }
}

/// Lights with bad numbers, and what is bad about each. By the rules of [`crate::light`] each of them is no light or,
/// where `kept`, a good one after clamping.
pub fn bad_lamps(position: DVec3) -> Vec<BadLamp> {
    let point = |range: f64| LampKind::Point { position, range };
    let spot = |inner: f64, outer: f64| LampKind::Spot {
        position,
        range: 4.0,
        direction: DVec3::NEG_Y,
        inner,
        outer,
    };
    let lamp = |power: f64, kind: LampKind| Lamp::new(power, kind);
    let mut all = Vec::new();
    let mut add = |name: &'static str, kept: bool, lamp: Lamp| {
        all.push(BadLamp { name, kept, lamp });
    };
    for (name, x) in [
        ("zero", 0.0),
        ("negative", -100.0),
        ("NaN", f64::NAN),
        ("infinite", f64::INFINITY),
    ] {
        let kept = name == "infinite";
        add(name, false, lamp(x, point(4.0)));
        add(name, kept, lamp(100.0, point(x)));
        add(name, kept, lamp(100.0, spot(0.1, x)));
        // An inner angle of 0 is a good one, a negative one is clamped to it.
        add(name, x.is_finite(), lamp(100.0, spot(x, 0.6)));
    }
    add("inner beyond outer", true, lamp(100.0, spot(0.9, 0.6)));
    add(
        "outer beyond a right angle",
        true,
        lamp(100.0, spot(0.9, 2.5)),
    );
    for (name, direction) in [("no direction", DVec3::ZERO), ("NaN direction", DVec3::NAN)] {
        add(name, false, lamp(1.0, LampKind::Directional { direction }));
    }
    let colour = DVec3::new(1.0, f64::NAN, 1.0);
    let coloured = Lamp {
        colour,
        ..lamp(100.0, point(4.0))
    };
    add("NaN colour", false, coloured);
    let position = DVec3::new(0.0, f64::NAN, 0.0);
    add(
        "NaN position",
        false,
        lamp(
            100.0,
            LampKind::Point {
                position,
                range: 4.0,
            },
        ),
    );
    all
}

/// A light with a bad number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BadLamp {
    /// What is bad.
    pub name: &'static str,
    /// Whether it shines after clamping.
    pub kept: bool,
    /// The light.
    pub lamp: Lamp,
}

/// Adds triangles without area or with numbers that are none, and objects that are flat or nowhere, none of which may
/// change an image.
pub fn add_degenerate(scene: &mut Scene) {
    let p = DVec3::new(0.5, 1.0, 0.5);
    let positions = vec![p, p, p + DVec3::X, p + 2.0 * DVec3::X, DVec3::NAN];
    scene.meshes.push(Mesh {
        normals: vec![DVec3::Y; positions.len()],
        positions,
        triangles: vec![[0, 1, 2], [0, 2, 3], [0, 0, 0], [0, 2, 4]],
    });
    let mesh = scene.meshes.len() - 1;
    let poses = [
        Pose::default(),
        Pose {
            scale: DVec3::ZERO,
            ..Pose::default()
        },
        Pose {
            translation: DVec3::NAN,
            ..Pose::default()
        },
    ];
    for pose in poses {
        scene.objects.push(Object::new(Shape::Mesh(mesh), pose, 0));
    }
    scene.objects.push(Object::new(Shape::Sphere, poses[1], 0));
    scene.objects.push(Object::new(Shape::Sphere, poses[2], 0));
}
