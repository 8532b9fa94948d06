//! What a file says, as plain data: the generator makes it, [`file`](crate::file) writes it and
//! [`truth`](crate::truth) says what it means.
//!
//! Lengths are in the file's unit, angles in degrees, times in ticks, axes are the file's.

/// Ticks of FBX's clock in a second.
pub const TICKS: i64 = 46_186_158_000;

/// Three numbers.
pub type Vec3 = [f64; 3];

/// How the file is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Container {
    /// As text.
    Ascii,
    /// As bytes, with arrays as they are.
    Binary,
    /// As bytes, with arrays deflated.
    Deflated,
}

/// One of the file's axes and which way along it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Axis {
    /// 0 to 2.
    pub axis: usize,
    /// 1 or -1.
    pub sign: i32,
}

/// How a file is to be converted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Asked {
    /// `Options::max_error`, metres.
    pub max_error: f64,
    /// `Options::within_frames`.
    pub within_frames: bool,
    /// `Weights::Eight`.
    pub eight: bool,
    /// `Effort::Thorough`.
    pub thorough: bool,
}

/// A whole file.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// How it is to be converted.
    pub asked: Asked,
    /// How it is written.
    pub container: Container,
    /// 7400 or 7500.
    pub version: u32,
    /// Centimetres of a unit.
    pub unit: f64,
    /// What of the file points right, up and to the viewer: glTF's X, Y and Z.
    pub axes: [Axis; 3],
    /// FBX's number of a rate of frames.
    pub time_mode: i32,
    /// The tree; parents stand before their children.
    pub nodes: Vec<Node>,
    /// Shapes that nodes show.
    pub meshes: Vec<Mesh>,
    /// Materials; meshes and nodes name them by number.
    pub materials: Vec<Material>,
    /// Clips.
    pub stacks: Vec<Stack>,
}

/// A node, with everything that its place depends on.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// Unlike all others'.
    pub name: String,
    /// `None` hangs on the scene.
    pub parent: Option<usize>,
    /// `Lcl Translation`.
    pub translation: Vec3,
    /// `Lcl Rotation`.
    pub rotation: Vec3,
    /// `Lcl Scaling`.
    pub scaling: Vec3,
    /// Which angle turns first: 0 to 5.
    pub order: i32,
    /// `RotationActive`: else neither the order nor the two turns beside it count.
    pub active: bool,
    /// `PreRotation`.
    pub pre: Vec3,
    /// `PostRotation`.
    pub post: Vec3,
    /// `RotationOffset`.
    pub rotation_offset: Vec3,
    /// `RotationPivot`.
    pub rotation_pivot: Vec3,
    /// `ScalingOffset`.
    pub scaling_offset: Vec3,
    /// `ScalingPivot`.
    pub scaling_pivot: Vec3,
    /// `InheritType`: 0 RrSs, 1 RSrs, 2 Rrs.
    pub inherit: i32,
    /// `GeometricTranslation`, `GeometricRotation`, `GeometricScaling`: of what it shows alone.
    pub geometric: Option<[Vec3; 3]>,
    /// What it shows.
    pub shows: Shows,
    /// `Visibility` is 0.
    pub hidden: bool,
    /// A property that a user added.
    pub user: Option<f64>,
}

/// What a node shows.
#[derive(Debug, Clone, PartialEq)]
pub enum Shows {
    /// Nothing: a null.
    Nothing,
    /// Nothing: a bone.
    Bone,
    /// Number of a mesh.
    Mesh(usize),
    /// A camera.
    Camera(Camera),
    /// A light.
    Light(Light),
}

/// A camera.
#[derive(Debug, Clone, PartialEq)]
pub struct Camera {
    /// Else it is orthographic.
    pub perspective: bool,
    /// Vertical angle.
    pub angle: f64,
    /// Width and height.
    pub aspect: [f64; 2],
    /// The planes.
    pub near: f64,
    /// The planes.
    pub far: f64,
}

/// A light.
#[derive(Debug, Clone, PartialEq)]
pub struct Light {
    /// 0 point, 1 directional, 2 spot.
    pub kind: i32,
    /// Linear.
    pub colour: Vec3,
    /// Per cent.
    pub intensity: f64,
}

/// A mesh of triangles and quadrangles.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// Vertices.
    pub points: Vec<Vec3>,
    /// Corners of each face.
    pub faces: Vec<Vec<usize>>,
    /// Channels of its blend shapes.
    pub channels: Vec<Channel>,
    /// Joints that it follows.
    pub skin: Vec<Cluster>,
    /// Number of a material.
    pub material: Option<usize>,
}

/// A channel of blend shapes.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Per cent.
    pub percent: f64,
    /// At how many per cent each is whole, growing, and what it moves by how much.
    pub shapes: Vec<(f64, Vec<(usize, Vec3)>)>,
}

/// A joint of a skin, bound as it is at rest.
#[derive(Debug, Clone, PartialEq)]
pub struct Cluster {
    /// Which node.
    pub node: usize,
    /// Vertices and how much they follow.
    pub weights: Vec<(usize, f64)>,
}

/// A material.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// `DiffuseColor`.
    pub diffuse: Vec3,
    /// `TransparentColor`.
    pub transparent: Option<Vec3>,
    /// `TransparencyFactor`.
    pub transparency: Option<f64>,
    /// `EmissiveColor`.
    pub emissive: Vec3,
    /// `EmissiveFactor`.
    pub emissive_factor: f64,
    /// Pictures on it.
    pub pictures: Vec<Picture>,
}

/// A picture on a material.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// `DiffuseColor`, `NormalMap` or `EmissiveColor`.
    pub slot: &'static str,
    /// `Scaling`.
    pub scaling: [f64; 2],
    /// `Rotation` about Z, degrees.
    pub rotation: f64,
    /// `Translation`.
    pub translation: [f64; 2],
}

/// A clip.
#[derive(Debug, Clone, PartialEq)]
pub struct Stack {
    /// Its name.
    pub name: String,
    /// Where it begins.
    pub start: i64,
    /// Where it ends, above `start`.
    pub stop: i64,
    /// From the lowest to the uppermost.
    pub layers: Vec<Layer>,
}

/// A layer of a clip.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// `BlendMode`: 0 additive, 1 override, 2 override and pass through; others mean nothing; `None` is not said.
    pub blend: Option<i32>,
    /// `Weight`, per cent.
    pub weight: f64,
    /// Keys of the weight.
    pub weight_curve: Option<Curve>,
    /// It is left out.
    pub mute: bool,
    /// All that are not are left out.
    pub solo: bool,
    /// `RotationAccumulationMode` is 1: angles are mixed, not rotations.
    pub by_channel: bool,
    /// `ScaleAccumulationMode` is 1: scales are added, not multiplied.
    pub add_scale: bool,
    /// What it moves.
    pub tracks: Vec<Track>,
}

/// Curves of a property in a layer.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    /// Whose.
    pub target: Target,
    /// Curves of its numbers; one alone where the property is a number.
    pub curves: [Option<Curve>; 3],
    /// Numbers of what has no curve.
    pub without: Vec3,
}

/// What a track moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// `Lcl Translation` of a node.
    Translation(usize),
    /// `Lcl Rotation` of a node.
    Rotation(usize),
    /// `Lcl Scaling` of a node.
    Scaling(usize),
    /// `DeformPercent` of a mesh's channel.
    Percent(usize, usize),
    /// `Visibility` of a node.
    Visibility(usize),
    /// `Intensity` of a node's light.
    Intensity(usize),
    /// `FieldOfView` of a node's camera.
    FieldOfView(usize),
    /// `DiffuseColor` of a material.
    Diffuse(usize),
}

/// Keys of a number, times growing.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// At least one.
    pub keys: Vec<Key>,
    /// Before the first and after the last.
    pub beyond: [Beyond; 2],
}

/// How a curve goes on beyond its keys. A number is how often, without end below 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Beyond {
    /// It stays.
    Stays,
    /// Along its tangent.
    Line,
    /// It is repeated.
    Again(i32),
    /// It is repeated, every other time backwards.
    Back(i32),
    /// It is repeated from where it ended.
    Climbs(i32),
}

impl Curve {
    /// That stays beyond its keys.
    pub fn of(keys: Vec<Key>) -> Self {
        Self {
            keys,
            beyond: [Beyond::Stays; 2],
        }
    }

    /// From the first key to the last, ticks.
    pub fn span(&self) -> [i64; 2] {
        let time = |key: Option<&Key>| key.map_or(0, |key| key.time);
        [time(self.keys.first()), time(self.keys.last())]
    }
}

/// A key.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Key {
    /// Ticks.
    pub time: i64,
    /// Its value.
    pub value: f32,
    /// What is between it and the next.
    pub way: Way,
    /// Weights of its right tangent and the next key's left one, in ten thousandths of the time between.
    pub weights: Option<[u16; 2]>,
    /// A velocity is said, which means nothing.
    pub velocity: bool,
}

/// What is between a key and the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Way {
    /// The value of this key.
    Constant,
    /// The value of the next key.
    ConstantNext,
    /// A straight line.
    Linear,
    /// A cubic; slopes at its two ends in units a second are given.
    User {
        /// At this key.
        right: f32,
        /// At the next.
        next_left: f32,
        /// The two sides of this key are apart.
        broken: bool,
    },
    /// A cubic whose slope at this key follows from its neighbours.
    Auto {
        /// How it is held flat.
        clamp: Clamp,
        /// The slope is that of the line between the neighbours.
        time_independent: bool,
    },
    /// A cubic by tension, continuity and bias (Kochanek and Bartels).
    Tcb([f32; 3]),
}

/// How an automatic tangent is held.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Clamp {
    /// Not at all.
    Free,
    /// Flat where a neighbour has the same value.
    Flat,
    /// So that no cubic goes beyond its two keys.
    Progressive,
}

impl Target {
    /// How many numbers it has.
    pub fn width(self) -> usize {
        match self {
            Self::Translation(_) | Self::Rotation(_) | Self::Scaling(_) | Self::Diffuse(_) => 3,
            _ => 1,
        }
    }
}

impl Layer {
    /// A layer as programs write it where there is but one.
    pub fn plain(tracks: Vec<Track>) -> Self {
        Self {
            blend: None,
            weight: 100.0,
            weight_curve: None,
            mute: false,
            solo: false,
            by_channel: false,
            add_scale: false,
            tracks,
        }
    }

    /// All its curves.
    pub fn curves(&self) -> impl Iterator<Item = &Curve> {
        let of_tracks = self
            .tracks
            .iter()
            .flat_map(|track| track.curves.iter().flatten());
        of_tracks.chain(&self.weight_curve)
    }
}

impl Stack {
    /// The layers that are heard: none that is mute, and where any is solo, none that is not.
    pub fn heard(&self) -> Vec<&Layer> {
        let solo = self.layers.iter().any(|layer| layer.solo && !layer.mute);
        self.layers
            .iter()
            .filter(|layer| !layer.mute && (layer.solo || !solo))
            .collect()
    }
}

impl Node {
    /// A node at the origin that shows nothing.
    pub fn plain(name: &str, parent: Option<usize>) -> Self {
        Self {
            name: name.to_owned(),
            parent,
            translation: [0.0; 3],
            rotation: [0.0; 3],
            scaling: [1.0; 3],
            order: 0,
            active: true,
            pre: [0.0; 3],
            post: [0.0; 3],
            rotation_offset: [0.0; 3],
            rotation_pivot: [0.0; 3],
            scaling_offset: [0.0; 3],
            scaling_pivot: [0.0; 3],
            inherit: 1,
            geometric: None,
            shows: Shows::Nothing,
            hidden: false,
            user: None,
        }
    }
}
