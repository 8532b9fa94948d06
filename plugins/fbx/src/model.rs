//! What lies between FBX and glTF: plain data in glTF's terms, with transforms in f64.
//!
//! Conventions: metres, right-handed, Y up; rotations are unit quaternions; indices point into the
//! lists of [`Model`]; a parent's index is not always less than its child's.

use glam::{DAffine3, DMat4, DQuat, DVec3};
use std::collections::{BTreeMap, BTreeSet};

/// A translation, a rotation and a scale, applied to a point from right to left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trs {
    /// Metres.
    pub translation: DVec3,
    /// Unit quaternion.
    pub rotation: DQuat,
    /// Factors along the axes before the rotation.
    pub scale: DVec3,
}

impl Trs {
    /// Changes nothing.
    pub const IDENTITY: Self = Self {
        translation: DVec3::ZERO,
        rotation: DQuat::IDENTITY,
        scale: DVec3::ONE,
    };

    /// As a matrix.
    pub fn matrix(&self) -> DMat4 {
        DMat4::from_scale_rotation_translation(self.scale, self.rotation, self.translation)
    }

    /// The same, without the row that says nothing.
    pub(crate) fn affine(&self) -> DAffine3 {
        DAffine3::from_scale_rotation_translation(self.scale, self.rotation, self.translation)
    }

    /// No infinite and no undefined number in it, and a rotation of unit length.
    pub fn is_sound(&self) -> bool {
        self.translation.is_finite()
            && self.scale.is_finite()
            && self.rotation.is_finite()
            && (self.rotation.length_squared() - 1.0).abs() < 1e-6
    }
}

/// A node of the tree.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// As in the file; may be empty.
    pub name: String,
    /// `None` for a root.
    pub parent: Option<usize>,
    /// Where it is relative to its parent when nothing plays.
    pub rest: Trs,
    /// Into [`Model::meshes`].
    pub mesh: Option<usize>,
    /// Into [`Model::skins`]; then the node's place does not matter.
    pub skin: Option<usize>,
    /// Into [`Model::lights`].
    pub light: Option<usize>,
    /// Into [`Model::cameras`].
    pub camera: Option<usize>,
}

/// A mesh: parts of one material each.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    /// As in the file; may be empty.
    pub name: String,
    /// One for each material that is used.
    pub parts: Vec<Part>,
    /// Morph targets that every part has, in order.
    pub targets: Vec<Target>,
    /// Number of the mesh in the FBX scene, for checks.
    pub source: u32,
    /// What was taken off all positions, metres, where f32 could not hold them so far out: the node that
    /// shows the mesh, or the skin's bind matrices, put it back. Each number of it is one that f32 holds.
    pub offset: DVec3,
}

/// A morph target.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    /// Name of its shape.
    pub name: String,
    /// Its weight when nothing plays.
    pub rest: f64,
    /// How far it moves a vertex at weight 1, at most, metres.
    pub reach: f64,
}

/// Triangles of one material, with vertices of their own.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Part {
    /// Into [`Model::materials`].
    pub material: Option<usize>,
    /// Three a triangle, counter-clockwise.
    pub indices: Vec<u32>,
    /// Which vertex of the FBX mesh each vertex comes from.
    pub sources: Vec<u32>,
    /// Metres.
    pub positions: Vec<[f32; 3]>,
    /// Of unit length.
    pub normals: Vec<[f32; 3]>,
    /// Of unit length, and the side of the bitangent; empty where no normal map needs them.
    pub tangents: Vec<[f32; 4]>,
    /// One list for each UV set; the origin is at the upper left.
    pub uvs: Vec<Vec<[f32; 2]>>,
    /// One list for each colour set, linear, with alpha.
    pub colours: Vec<Vec<[f32; 4]>>,
    /// Lists of four joints a vertex, into the skin's joints; one or two lists where there is a skin.
    pub joints: Vec<Vec<[u16; 4]>>,
    /// Their weights; those of a vertex sum to 1.
    pub weights: Vec<Vec<[f32; 4]>>,
    /// For each of [`Mesh::targets`], what it adds to positions, and to normals where it says so.
    pub offsets: Vec<(Vec<[f32; 3]>, Vec<[f32; 3]>)>,
}

/// Joints, and where the mesh was when they were bound.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Skin {
    /// As in the file; may be empty.
    pub name: String,
    /// Nodes.
    pub joints: Vec<usize>,
    /// For each joint, from the mesh to the joint.
    pub inverse_bind: Vec<DMat4>,
}

/// A picture: a PNG or JPEG as it lies in the file, or the PNG that a TGA or BMP was turned into.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    /// File name or name of the texture.
    pub name: String,
    /// `image/png` or `image/jpeg`.
    pub mime: &'static str,
    /// The file's bytes.
    pub bytes: Vec<u8>,
}

/// A picture as a material uses it.
#[derive(Debug, Clone, PartialEq)]
pub struct TextureUse {
    /// Into [`Model::images`].
    pub image: usize,
    /// Number of the UV set.
    pub uv_set: u32,
    /// Repeats along U and V, else its border goes on.
    pub repeat: [bool; 2],
    /// Offset, rotation in radians and scale of texture coordinates as KHR_texture_transform has them,
    /// where they are not 0, 0 and 1.
    pub transform: Option<([f32; 2], f32, [f32; 2])>,
}

/// A material of the metallic-roughness model.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// As in the file; may be empty.
    pub name: String,
    /// Linear colour and opacity.
    pub base_colour: [f32; 4],
    /// Colours it.
    pub base_texture: Option<TextureUse>,
    /// 0 to 1.
    pub metallic: f32,
    /// 0 to 1.
    pub roughness: f32,
    /// Roughness in green, metalness in blue.
    pub metallic_roughness_texture: Option<TextureUse>,
    /// Linear, 0 to 1.
    pub emissive: [f32; 3],
    /// What [`Material::emissive`] is multiplied by, 1 or more.
    pub emissive_strength: f32,
    /// Colours it.
    pub emissive_texture: Option<TextureUse>,
    /// Tangent-space normals.
    pub normal_texture: Option<TextureUse>,
    /// Occlusion in red.
    pub occlusion_texture: Option<TextureUse>,
    /// Alpha is blended.
    pub blend: bool,
    /// Both sides are drawn.
    pub double_sided: bool,
}

impl Material {
    /// Its textures, those that it has.
    pub fn textures(&self) -> impl Iterator<Item = &TextureUse> {
        let all = [
            &self.base_texture,
            &self.metallic_roughness_texture,
            &self.emissive_texture,
            &self.normal_texture,
            &self.occlusion_texture,
        ];
        all.into_iter().flatten()
    }

    pub(crate) fn textures_mut(&mut self) -> impl Iterator<Item = &mut TextureUse> {
        let all = [
            &mut self.base_texture,
            &mut self.metallic_roughness_texture,
            &mut self.emissive_texture,
            &mut self.normal_texture,
            &mut self.occlusion_texture,
        ];
        all.into_iter().flatten()
    }
}

/// What kind of light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightKind {
    /// From infinitely far away.
    Directional,
    /// From a point, in all directions.
    Point,
    /// From a point into a cone: half angles, radians.
    Spot {
        /// Where it begins to fade.
        inner: f32,
        /// Where it ends.
        outer: f32,
    },
}

/// A light that shines along its node's -Z.
#[derive(Debug, Clone, PartialEq)]
pub struct Light {
    /// As in the file; may be empty.
    pub name: String,
    /// Linear.
    pub colour: [f32; 3],
    /// As a multiple of what the file calls 1 (100 %); FBX knows no photometric unit.
    pub intensity: f32,
    /// Its kind.
    pub kind: LightKind,
}

/// A camera that looks along its node's -Z.
#[derive(Debug, Clone, PartialEq)]
pub struct Camera {
    /// As in the file; may be empty.
    pub name: String,
    /// How it projects.
    pub projection: Projection,
    /// Metres, above 0.
    pub near: f32,
    /// Metres, above `near`; infinite where a perspective has no end.
    pub far: f32,
}

/// How a camera projects.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    /// Vertical field of view in radians, width over height.
    Perspective(f32, f32),
    /// Half the width and half the height, metres.
    Orthographic(f32, f32),
}

/// How values between two keys are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interpolation {
    /// The earlier key's value.
    Step,
    /// Straight; rotations along the great circle.
    Linear,
    /// Cubic Hermite; each key has three values: tangent in, value, tangent out.
    Cubic,
}

/// What a channel moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Property {
    /// [`Trs::translation`].
    Translation,
    /// [`Trs::rotation`].
    Rotation,
    /// [`Trs::scale`].
    Scale,
    /// Weights of the morph targets of the node's mesh.
    Weights,
}

/// Keys of one property of one node.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Which node.
    pub node: usize,
    /// Which property.
    pub property: Property,
    /// Between keys.
    pub interpolation: Interpolation,
    /// Seconds from the clip's start, growing.
    pub times: Vec<f32>,
    /// The keys' values one after another: 3, 4 or as many numbers as targets; three times that for
    /// cubic keys.
    pub values: Vec<f32>,
    /// Values are kept as normalised 16-bit integers; they are exact multiples of 1/32767 then.
    pub short: bool,
}

impl Channel {
    /// Bytes of its keys, and of its times unless they are in `known`, which they are put into: equal
    /// times are kept once.
    pub(crate) fn bytes(&self, known: &mut BTreeSet<Vec<u32>>) -> usize {
        let times: Vec<u32> = self.times.iter().map(|time| time.to_bits()).collect();
        let of_times = if known.insert(times) {
            self.times.len() * 4
        } else {
            0
        };
        of_times + self.values.len() * if self.short { 2 } else { 4 }
    }
}

/// An animation stack.
#[derive(Debug, Clone, PartialEq)]
pub struct Clip {
    /// As in the file; may be empty.
    pub name: String,
    /// Where it starts on the file's clock, seconds. Keys count from here.
    pub begin: f64,
    /// Seconds.
    pub duration: f64,
    /// Sorted by node and property.
    pub channels: Vec<Channel>,
}

/// Properties that a user gave to an object, by name.
pub type Properties = serde_json::Map<String, serde_json::Value>;

/// What becomes glTF's `extras`, by the number of the object.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Extras {
    /// Of [`Model::nodes`].
    pub nodes: BTreeMap<usize, Properties>,
    /// Of [`Model::meshes`].
    pub meshes: BTreeMap<usize, Properties>,
    /// Of [`Model::materials`].
    pub materials: BTreeMap<usize, Properties>,
    /// Of [`Model::lights`].
    pub lights: BTreeMap<usize, Properties>,
    /// Of [`Model::cameras`].
    pub cameras: BTreeMap<usize, Properties>,
}

/// Everything that becomes a glTF file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Model {
    /// The tree.
    pub nodes: Vec<Node>,
    /// Meshes.
    pub meshes: Vec<Mesh>,
    /// Skins.
    pub skins: Vec<Skin>,
    /// Materials.
    pub materials: Vec<Material>,
    /// Pictures.
    pub images: Vec<Image>,
    /// Lights.
    pub lights: Vec<Light>,
    /// Cameras.
    pub cameras: Vec<Camera>,
    /// One for each animation stack.
    pub clips: Vec<Clip>,
    /// Nodes that are hidden with all below them (KHR_node_visibility).
    pub hidden: BTreeSet<usize>,
    /// What users gave to objects.
    pub extras: Extras,
}
