//! What a scene says: plain data, of which the oracle and an app with a renderer are built.
//!
//! | here | in Bevy 0.19 |
//! |---|---|
//! | [`Mesh`] | `Mesh` of triangles with positions, normals and indices |
//! | [`Pose`] | `Transform` |
//! | [`Standard`] | `StandardMaterial`, of which the base colour and `emissive` are `LinearRgba`; opaque, back faces culled |
//! | [`Lamp`] | `DirectionalLight` (`illuminance`), `PointLight` and `SpotLight` (`intensity` in lumens, `radius` 0) whose transform looks along the direction |
//! | [`Ambient`] | `GlobalAmbientLight`, or `AmbientLight` on the camera |
//! | [`Camera`] | `Camera3d` with `PerspectiveProjection` (`fov`, `near`), `Exposure` of `EV100 = −log₂(1.2 exposure)`, no tone mapping, no multisampling |
//! | [`Scene::background`] | `ClearColor` |
//!
//! Not described: textures, transparency, clear coat, anisotropy, transmission, lights with an extent, image-based light.

mod camera;
mod lamp;
mod material;
mod mesh;

use glam::{DAffine3, DQuat, DVec3};

pub use camera::{Camera, Lens};
pub use lamp::{Ambient, Lamp, LampKind};
pub use material::{BlinnPhong, Interpolation, Lobe, Material, Standard};
pub use mesh::{Mesh, cone, cuboid, grid, icosphere, torus};

/// Everything that an image depends on.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Scene {
    /// Triangles that objects share.
    pub meshes: Vec<Mesh>,
    /// Materials that objects share.
    pub materials: Vec<Material>,
    /// What is seen and casts shadows.
    pub objects: Vec<Object>,
    /// Lights, in the order of their sum.
    pub lamps: Vec<Lamp>,
    /// Light that arrives from everywhere.
    pub ambient: Ambient,
    /// Who looks.
    pub camera: Camera,
    /// Radiance where no object is hit; exposure does not apply.
    pub background: DVec3,
}

/// A shape somewhere.
#[derive(Debug, Clone, PartialEq)]
pub struct Object {
    /// In its own space.
    pub shape: Shape,
    /// From there to the world.
    pub pose: Pose,
    /// Index into [`Scene::materials`].
    pub material: usize,
    /// Metres a second, for shutters.
    pub velocity: DVec3,
}

/// Shapes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// Index into [`Scene::meshes`].
    Mesh(usize),
    /// The exact sphere about the origin, of radius 1; its pose may make it an ellipsoid.
    Sphere,
    /// The exact plane y = 0 without end, seen from both sides, its normal +Y.
    Plane,
}

/// Where something is: scaled, then turned, then moved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Metres.
    pub translation: DVec3,
    /// A unit quaternion.
    pub rotation: DQuat,
    /// A factor an axis.
    pub scale: DVec3,
}

impl Default for Pose {
    fn default() -> Self {
        Self {
            translation: DVec3::ZERO,
            rotation: DQuat::IDENTITY,
            scale: DVec3::ONE,
        }
    }
}

impl Pose {
    /// The affine map.
    pub fn affine(&self) -> DAffine3 {
        DAffine3::from_scale_rotation_translation(self.scale, self.rotation, self.translation)
    }
}

impl Object {
    /// A shape at rest.
    pub fn new(shape: Shape, pose: Pose, material: usize) -> Self {
        Self {
            shape,
            pose,
            material,
            velocity: DVec3::ZERO,
        }
    }
}

impl Scene {
    /// The scene `seconds` later: objects and camera have moved by their velocities.
    #[must_use]
    pub fn after(&self, seconds: f64) -> Self {
        let mut later = self.clone();
        for object in &mut later.objects {
            object.pose.translation += seconds * object.velocity;
        }
        later.camera.position += seconds * later.camera.velocity;
        later
    }

    /// The scene moved as a whole. The light in it stays the same.
    #[must_use]
    pub fn shifted(&self, by: DVec3) -> Self {
        let mut there = self.clone();
        for object in &mut there.objects {
            object.pose.translation += by;
        }
        for lamp in &mut there.lamps {
            lamp.shift(by);
        }
        there.camera.position += by;
        there
    }

    /// Triangles that are drawn.
    pub fn triangles(&self) -> usize {
        let of = |object: &Object| match object.shape {
            Shape::Mesh(mesh) => self.meshes.get(mesh).map_or(0, |m| m.triangles.len()),
            Shape::Sphere | Shape::Plane => 0,
        };
        self.objects.iter().map(of).sum()
    }
}
