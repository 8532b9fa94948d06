//! Meshes that hang on a skin.

use super::{LoadError, Skin, accessor};
use gltf::Semantic;
use gltf::mesh::Mode;

/// Triangles of one primitive, with the joints of every vertex.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SkinnedMesh {
    /// Name of the node that it hangs from; may be empty.
    pub name: String,
    /// Number of its skin in the file.
    pub skin: usize,
    /// Number of its material in the file.
    pub material: Option<usize>,
    /// Metres, in the mesh's frame.
    pub positions: Vec<[f32; 3]>,
    /// Unit vectors; empty where the file has none.
    pub normals: Vec<[f32; 3]>,
    /// First set of texture coordinates; empty where the file has none.
    pub uvs: Vec<[f32; 2]>,
    /// Numbers of joints in the skin.
    pub joints: Vec<[u16; 4]>,
    /// Their weights, of sum 1.
    pub weights: Vec<[f32; 4]>,
    /// Corners of triangles.
    pub indices: Vec<u32>,
}

/// All of them, in the order of nodes.
pub(super) fn read_all(
    document: &gltf::Document,
    skins: &[Skin],
    buffers: &[Vec<u8>],
) -> Result<Vec<SkinnedMesh>, LoadError> {
    let mut meshes = Vec::new();
    for node in document.nodes() {
        let (Some(mesh), Some(skin)) = (node.mesh(), node.skin()) else {
            continue;
        };
        for primitive in mesh
            .primitives()
            .filter(|primitive| primitive.mode() == Mode::Triangles)
        {
            let mut read = read(&primitive, buffers)?;
            read.name = node.name().unwrap_or_default().to_owned();
            read.skin = skin.index();
            check(&read, skins[skin.index()].joints.len()).map_err(|reason| LoadError::Mesh {
                mesh: mesh.index(),
                primitive: primitive.index(),
                reason,
            })?;
            for weights in &mut read.weights {
                normalise(weights);
            }
            meshes.push(read);
        }
    }
    Ok(meshes)
}

fn read(primitive: &gltf::Primitive, buffers: &[Vec<u8>]) -> Result<SkinnedMesh, LoadError> {
    let mut mesh = SkinnedMesh {
        material: primitive.material().index(),
        ..Default::default()
    };
    if let Some(positions) = primitive.get(&Semantic::Positions) {
        mesh.positions = accessor::floats(&positions, buffers, "positions")?;
    }
    if let Some(normals) = primitive.get(&Semantic::Normals) {
        mesh.normals = accessor::floats(&normals, buffers, "normals")?;
    }
    if let Some(uvs) = primitive.get(&Semantic::TexCoords(0)) {
        mesh.uvs = accessor::floats(&uvs, buffers, "texture coordinates")?;
    }
    if let Some(joints) = primitive.get(&Semantic::Joints(0)) {
        mesh.joints = accessor::whole::<4>(&joints, buffers, "joint numbers")?
            .into_iter()
            // Numbers beyond 16 bits are refused below, as no skin has so many joints.
            .map(|four| four.map(|joint| u16::try_from(joint).unwrap_or(u16::MAX)))
            .collect();
    }
    if let Some(weights) = primitive.get(&Semantic::Weights(0)) {
        mesh.weights = accessor::floats(&weights, buffers, "joint weights")?;
    }
    mesh.indices = match primitive.indices() {
        Some(indices) => accessor::whole::<1>(&indices, buffers, "indices")?
            .into_iter()
            .flatten()
            .collect(),
        None => (0..mesh.positions.len() as u32).collect(),
    };
    Ok(mesh)
}

fn check(mesh: &SkinnedMesh, joints: usize) -> Result<(), String> {
    let vertices = mesh.positions.len();
    let fits = |length: usize, optional: bool| length == vertices || (optional && length == 0);
    if vertices == 0 {
        return Err("it has no positions".into());
    }
    if !(fits(mesh.normals.len(), true)
        && fits(mesh.uvs.len(), true)
        && fits(mesh.joints.len(), false)
        && fits(mesh.weights.len(), false))
    {
        return Err("its attributes have different lengths, or it has no joints".into());
    }
    if mesh
        .joints
        .iter()
        .flatten()
        .any(|joint| usize::from(*joint) >= joints)
    {
        return Err(format!(
            "a vertex names a joint beyond the {joints} of its skin"
        ));
    }
    if !mesh.indices.len().is_multiple_of(3)
        || mesh.indices.iter().any(|index| *index as usize >= vertices)
    {
        return Err("its indices are not triangles of its vertices".into());
    }
    let numbers = mesh.positions.iter().chain(&mesh.normals).flatten();
    if !numbers
        .chain(mesh.weights.iter().flatten())
        .all(|number| number.is_finite())
    {
        return Err("a number is not finite".into());
    }
    Ok(())
}

/// Weights of sum 1; a vertex without any hangs on its first joint.
fn normalise(weights: &mut [f32; 4]) {
    let sum: f32 = weights.iter().sum();
    *weights = if sum > 1e-6 {
        weights.map(|weight| weight / sum)
    } else {
        [1.0, 0.0, 0.0, 0.0]
    };
}
