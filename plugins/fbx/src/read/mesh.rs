//! Meshes: triangles by material, with one vertex for each different corner.

use super::convert::{finite, finite3, vec3};
use super::normals::by_groups;
use super::place::offset_of;
use super::shapes::Shapes;
use super::tangents::{Corners, tangents};
use super::uv_sets::{UvOrder, looked_up};
use crate::error::FbxError;
use crate::model::{Material, Mesh, Part};
use crate::options::Budget;
use crate::report::Report;
use crate::syntax::{Smoothing, smoothing_groups};
use glam::DVec3;
use std::collections::BTreeMap;
use ufbx::WarningType;

/// No vertex.
const NONE: u32 = u32::MAX;

/// Meshes that are made so far: the same FBX mesh under other materials is another mesh.
#[derive(Default)]
pub(crate) struct Meshes {
    known: BTreeMap<(u32, Vec<Option<usize>>, bool), usize>,
    /// For each FBX mesh, smoothing groups of its faces, where normals are to be made of them.
    groups: Vec<Vec<u32>>,
}

/// Corners of the triangles of one part, before equal ones are joined.
#[derive(Default)]
struct Soup {
    /// Number of each corner in the FBX mesh.
    corners: Vec<u32>,
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    uvs: Vec<Vec<[f32; 2]>>,
    colours: Vec<Vec<[f32; 4]>>,
    tangents: Vec<[f32; 4]>,
}

impl Meshes {
    /// For a scene read from `file`.
    pub(crate) fn new(scene: &ufbx::Scene, file: &[u8], report: &mut Report) -> Self {
        Self {
            groups: groups(scene, file, report),
            ..Self::default()
        }
    }

    /// Number of the mesh that `node` shows; `None` if it has no triangle. A mesh with a skin is told
    /// apart from the same one without.
    pub(crate) fn number(
        &mut self,
        node: &ufbx::Node,
        mesh: &ufbx::Mesh,
        skinned: bool,
        looks: (&[Material], &[UvOrder]),
        meshes: &mut Vec<Mesh>,
        max_error: f64,
        budget: &Budget,
    ) -> Result<Option<usize>, FbxError> {
        let of_node: Vec<Option<usize>> = match node.materials.is_empty() {
            true => (&mesh.materials)
                .into_iter()
                .map(|m| Some(m.element.typed_id as usize))
                .collect(),
            false => (&node.materials)
                .into_iter()
                .map(|m| Some(m.element.typed_id as usize))
                .collect(),
        };
        let key = (mesh.element.typed_id, of_node.clone(), skinned);
        if let Some(&number) = self.known.get(&key) {
            return Ok(Some(number));
        }
        let groups = self.groups.get(mesh.element.typed_id as usize);
        let groups = groups.map_or(&[][..], Vec::as_slice);
        let made = read_mesh(mesh, &of_node, looks, groups, max_error, budget)?;
        if made.parts.is_empty() {
            return Ok(None);
        }
        meshes.push(made);
        self.known.insert(key, meshes.len() - 1);
        Ok(Some(meshes.len() - 1))
    }
}

/// Smoothing groups of the meshes that have them and no normals, from the file itself: ufbx says of each
/// face only whether it has one, of binary files whether it has one of the first eight, and nothing where one
/// number is of all faces.
fn groups(scene: &ufbx::Scene, file: &[u8], report: &mut Report) -> Vec<Vec<u32>> {
    let left_out = scene.metadata.has_warning[WarningType::MissingPolygonMapping as usize];
    let wanted = |mesh: &ufbx::Mesh| {
        let by_face = !mesh.face_smoothing.is_empty();
        mesh.generated_normals && (by_face || left_out && mesh.edge_smoothing.is_empty())
    };
    if !(&scene.meshes).into_iter().any(wanted) {
        return Vec::new();
    }
    let mut found = smoothing_groups(file);
    if found.len() != scene.meshes.len() {
        found = vec![Smoothing::Unknown; scene.meshes.len()];
    }
    let mut lose = |mesh: &ufbx::Mesh, detail: &str| {
        report.lose("smoothing-groups", &mesh.element.name, detail);
        Vec::new()
    };
    let of = |(mesh, found): (&ufbx::Mesh, Smoothing)| match found {
        _ if !wanted(mesh) => Vec::new(),
        Smoothing::Faces(groups) if groups.len() == mesh.num_faces => groups,
        Smoothing::All(groups) => vec![groups; mesh.num_faces],
        Smoothing::Unsaid if mesh.face_smoothing.is_empty() => Vec::new(),
        Smoothing::Unknown if mesh.face_smoothing.is_empty() => lose(
            mesh,
            "its smoothing may be said otherwise than by face or edge, which is not read; all is flat",
        ),
        _ => lose(
            mesh,
            "smoothing groups do not fit its faces; all that have one are smooth",
        ),
    };
    (&scene.meshes).into_iter().zip(found).map(of).collect()
}

fn read_mesh(
    mesh: &ufbx::Mesh,
    of_node: &[Option<usize>],
    (materials, uv_orders): (&[Material], &[UvOrder]),
    groups: &[u32],
    max_error: f64,
    budget: &Budget,
) -> Result<Mesh, FbxError> {
    let shapes = Shapes::of(mesh);
    // What all corners need at most: 12 floats and each UV and colour set, twice over.
    let what = "the triangles of a mesh";
    let corner = 4 * (12 + 2 * mesh.uv_sets.len() + 4 * mesh.color_sets.len());
    let corners = mesh.num_triangles * 3 * corner * 2;
    // Targets are of vertices: two vectors in f64 for each of the file's, and in f32, twice over, for each
    // of those that they come to.
    let targets = shapes.targets.len();
    let for_targets = |vertices: usize| vertices.saturating_mul(48 * targets);
    let spread = corners.saturating_add(for_targets(mesh.num_vertices));
    budget.afford(spread, what)?;
    budget.must(mesh.num_triangles * 3 * (1 + targets), what)?;

    let mut soups: BTreeMap<usize, Soup> = BTreeMap::new();
    let mut triangles = vec![0; mesh.max_face_triangles * 3];
    for (face_number, face) in mesh.faces.iter().enumerate() {
        if face.num_indices < 3 {
            continue;
        }
        let slot = mesh.face_material.get(face_number).copied().unwrap_or(0) as usize;
        let count = ufbx::triangulate_face(&mut triangles, mesh, *face) as usize * 3;
        soups
            .entry(slot)
            .or_default()
            .corners
            .extend_from_slice(&triangles[..count]);
    }
    let offsets: Vec<_> = (0..shapes.targets.len())
        .map(|target| shapes.offsets(target, mesh.num_vertices))
        .collect();
    let offset = offset_of(mesh, max_error);
    let normals = match groups.is_empty() {
        true => Vec::new(),
        false => by_groups(mesh, groups),
    };
    let uv_sets: Vec<&str> = mesh.uv_sets.iter().map(|set| &*set.name).collect();
    let mut parts = Vec::new();
    let mut vertices = 0;
    for (slot, mut soup) in soups {
        let material = of_node
            .get(slot)
            .copied()
            .flatten()
            .filter(|&m| m < materials.len());
        fill(&mut soup, mesh, &normals, offset);
        if let Some(m) = material {
            let uvs = std::mem::take(&mut soup.uvs);
            let count = soup.corners.len();
            soup.uvs = match uv_orders.get(m) {
                Some(order) => order.arrange(uvs, &uv_sets, &materials[m], count),
                None => uvs,
            };
        }
        let normal_map = material.and_then(|m| materials[m].normal_texture.as_ref());
        let uvs = normal_map.and_then(|map| Some((map, soup.uvs.get(map.uv_set as usize)?)));
        if let Some((map, uvs)) = uvs {
            soup.tangents = tangents(&Corners {
                positions: &soup.positions,
                normals: &soup.normals,
                uvs: &looked_up(uvs, map),
            });
        }
        let mut part = join(&soup, mesh);
        part.material = material;
        vertices += part.positions.len();
        budget.afford(spread.saturating_add(for_targets(vertices)), what)?;
        for (positions, normals) in &offsets {
            let pick = |all: &[DVec3]| -> Vec<[f32; 3]> {
                part.sources
                    .iter()
                    .map(|&v| finite3(all[v as usize]))
                    .collect()
            };
            part.offsets
                .push((pick(positions), normals.as_deref().map_or(Vec::new(), pick)));
        }
        if !part.indices.is_empty() {
            parts.push(part);
        }
    }
    Ok(Mesh {
        name: mesh.element.name.to_string(),
        parts,
        targets: shapes.targets,
        source: mesh.element.typed_id,
        offset,
    })
}

/// Looks up the attributes of each corner.
fn fill(soup: &mut Soup, mesh: &ufbx::Mesh, normals: &[DVec3], offset: DVec3) {
    let corners = &soup.corners;
    soup.positions = corners
        .iter()
        .map(|&c| finite3(vec3(mesh.vertex_position[c as usize]) - offset))
        .collect();
    soup.normals = match mesh.vertex_normal.exists {
        _ if !normals.is_empty() => corners
            .iter()
            .map(|&c| finite3(normals[c as usize]))
            .collect(),
        true => corners
            .iter()
            .map(|&c| finite3(unit(vec3(mesh.vertex_normal[c as usize]))))
            .collect(),
        false => vec![[0.0; 3]; corners.len()],
    };
    for start in (0..corners.len()).step_by(3) {
        // A normal of no length would be refused by every reader: the triangle's own stands in.
        if soup.normals[start..start + 3].contains(&[0.0; 3]) {
            let [a, b, c] =
                [0, 1, 2].map(|i| glam::Vec3::from(soup.positions[start + i]).as_dvec3());
            let flat = unit((b - a).cross(c - a));
            let flat = if flat == DVec3::ZERO { DVec3::Y } else { flat };
            for normal in &mut soup.normals[start..start + 3] {
                if *normal == [0.0; 3] {
                    *normal = finite3(flat);
                }
            }
        }
    }
    soup.uvs = mesh
        .uv_sets
        .iter()
        .map(|set| {
            let uv = |&c: &u32| {
                let uv = set.vertex_uv[c as usize];
                [finite(uv.x), finite(1.0 - uv.y)]
            };
            corners.iter().map(uv).collect()
        })
        .collect();
    soup.colours = mesh
        .color_sets
        .iter()
        .map(|set| {
            let colour = |&c: &u32| {
                let c = set.vertex_color[c as usize];
                [c.x, c.y, c.z, c.w].map(|x| finite(x).clamp(0.0, 1.0))
            };
            corners.iter().map(colour).collect()
        })
        .collect();
}

fn unit(v: DVec3) -> DVec3 {
    v.normalize_or_zero()
}

/// Joins corners that are equal in everything. Corners of the same FBX vertex are kept in a list, so
/// that only these are compared.
fn join(soup: &Soup, mesh: &ufbx::Mesh) -> Part {
    let mut part = Part {
        uvs: vec![Vec::new(); soup.uvs.len()],
        colours: vec![Vec::new(); soup.colours.len()],
        ..Part::default()
    };
    let mut first = vec![NONE; mesh.num_vertices];
    // For each vertex of the part: the corner it was made of, and the next of the same FBX vertex.
    let mut made: Vec<(u32, u32)> = Vec::new();
    for (corner, &number) in soup.corners.iter().enumerate() {
        let source = mesh.vertex_indices[number as usize];
        let Some(head) = first.get_mut(source as usize) else {
            continue;
        };
        let mut at = *head;
        while at != NONE && !equal(soup, made[at as usize].0 as usize, corner) {
            at = made[at as usize].1;
        }
        if at == NONE {
            at = made.len() as u32;
            made.push((corner as u32, *head));
            *head = at;
            part.sources.push(source);
        }
        part.indices.push(at);
    }
    let of = |(corner, _): &(u32, u32)| *corner as usize;
    part.positions = made.iter().map(|v| soup.positions[of(v)]).collect();
    part.normals = made.iter().map(|v| soup.normals[of(v)]).collect();
    if !soup.tangents.is_empty() {
        part.tangents = made.iter().map(|v| soup.tangents[of(v)]).collect();
    }
    for (to, from) in part.uvs.iter_mut().zip(&soup.uvs) {
        *to = made.iter().map(|v| from[of(v)]).collect();
    }
    for (to, from) in part.colours.iter_mut().zip(&soup.colours) {
        *to = made.iter().map(|v| from[of(v)]).collect();
    }
    part
}

fn equal(soup: &Soup, a: usize, b: usize) -> bool {
    soup.normals[a] == soup.normals[b]
        && soup.uvs.iter().all(|set| set[a] == set[b])
        && soup.colours.iter().all(|set| set[a] == set[b])
        && (soup.tangents.is_empty() || soup.tangents[a] == soup.tangents[b])
}
