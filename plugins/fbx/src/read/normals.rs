//! Normals where a file has smoothing groups and no normals.

use super::convert::vec3;
use glam::DVec3;

/// Different sets of groups around one vertex that are told apart; beyond, single groups are.
const SETS: usize = 64;

/// A normal for each corner of `mesh`: what the faces around its vertex that share a group with its own
/// face have in common, by their areas. A face of no group is flat. `groups` has one set of bits a face.
pub(super) fn by_groups(mesh: &ufbx::Mesh, groups: &[u32]) -> Vec<DVec3> {
    let faces: Vec<DVec3> = mesh.faces.iter().map(|face| area(mesh, *face)).collect();
    // Corners by vertex: for each vertex where its own begin, then the corners and their faces.
    let mut begins = vec![0_u32; mesh.num_vertices + 1];
    let corners = || {
        mesh.faces.iter().enumerate().flat_map(|(number, face)| {
            let begin = face.index_begin as usize;
            (begin..begin + face.num_indices as usize).map(move |corner| (number, corner))
        })
    };
    let vertex_of = |corner: usize| mesh.vertex_indices[corner] as usize;
    for (_, corner) in corners() {
        if let Some(slot) = begins.get_mut(vertex_of(corner) + 1) {
            *slot += 1;
        }
    }
    for vertex in 0..mesh.num_vertices {
        begins[vertex + 1] += begins[vertex];
    }
    let mut sorted = vec![(0_u32, 0_u32); begins[mesh.num_vertices] as usize];
    let mut next = begins.clone();
    for (face, corner) in corners() {
        let Some(slot) = next.get_mut(vertex_of(corner)) else {
            continue;
        };
        if let Some(place) = sorted.get_mut(*slot as usize) {
            *place = (face as u32, corner as u32);
            *slot += 1;
        }
    }
    let mut out = vec![DVec3::ZERO; mesh.num_indices];
    for vertex in 0..mesh.num_vertices {
        let around = &sorted[begins[vertex] as usize..begins[vertex + 1] as usize];
        around_vertex(around, &faces, groups, &mut out);
    }
    out
}

fn around_vertex(around: &[(u32, u32)], faces: &[DVec3], groups: &[u32], out: &mut [DVec3]) {
    let of = |face: u32| groups.get(face as usize).copied().unwrap_or(0);
    let mut sums: Vec<(u32, DVec3)> = Vec::new();
    for &(face, _) in around {
        let (set, normal) = (of(face), faces[face as usize]);
        let known = sums.iter().any(|(known, _)| *known == set);
        if known || sums.len() < SETS {
            add(&mut sums, set, normal);
        } else {
            let bits = (0..32).map(|i| 1 << i).filter(|bit| set & bit != 0);
            bits.for_each(|bit| add(&mut sums, bit, normal));
        }
    }
    for &(face, corner) in around {
        let set = of(face);
        let shared = sums.iter().filter(|(other, _)| other & set != 0);
        let sum: DVec3 = shared.map(|(_, sum)| *sum).sum();
        let normal = if set == 0 { faces[face as usize] } else { sum };
        if let Some(slot) = out.get_mut(corner as usize) {
            *slot = normal.normalize_or_zero();
        }
    }
}

fn add(sums: &mut Vec<(u32, DVec3)>, set: u32, normal: DVec3) {
    match sums.iter_mut().find(|(known, _)| *known == set) {
        Some((_, sum)) => *sum += normal,
        None => sums.push((set, normal)),
    }
}

/// The normal of a face, as long as twice its area (Newell).
fn area(mesh: &ufbx::Mesh, face: ufbx::Face) -> DVec3 {
    let begin = face.index_begin as usize;
    let point = |i: u32| vec3(mesh.vertex_position[begin + i as usize]);
    let count = face.num_indices;
    if count < 3 {
        return DVec3::ZERO;
    }
    let first = point(0);
    let triangles = (1..count - 1).map(|i| (point(i) - first).cross(point(i + 1) - first));
    let sum: DVec3 = triangles.sum();
    if sum.is_finite() { sum } else { DVec3::ZERO }
}
