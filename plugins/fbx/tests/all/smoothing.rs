//! Normals of meshes that have none, by smoothing groups and smooth edges.

use crate::support::binary;
use crate::support::binary::{Node, Value};
use crate::support::scene::{
    FACES, array, converted, corners, field, geometry, link, lost, model, scene,
};
use dolomite_fbx::model::Part;
use glam::{DVec3, Vec3};

/// Normals of the six faces of the support's box, in its order.
const OUTWARDS: [Vec3; 6] = [
    Vec3::NEG_Z,
    Vec3::Z,
    Vec3::NEG_Y,
    Vec3::Y,
    Vec3::NEG_X,
    Vec3::X,
];

fn layer(mapping: &str, values: &[i64]) -> String {
    format!(
        "\t\tLayerElementSmoothing: 0 {{\n\t\t\tVersion: 102\n\t\t\tName: \"\"\n\t\t\tMappingInformationType: \"{mapping}\"\n\t\t\tReferenceInformationType: \"Direct\"\n{}\t\t}}\n\
         \t\tLayer: 0 {{\n\t\t\tVersion: 100\n\t\t\tLayerElement:  {{\n\t\t\t\tType: \"LayerElementSmoothing\"\n\t\t\t\tTypedIndex: 0\n\t\t\t}}\n\t\t}}\n",
        array("Smoothing", values)
    )
}

fn cube(more: &str) -> Part {
    let objects =
        geometry(1, &corners(DVec3::NEG_ONE, DVec3::ONE), more) + &model(2, "box", "Mesh", "");
    let file = scene(1.0, &objects, &(link(2, 0) + &link(1, 2)));
    let made = converted(file.as_bytes());
    assert!(lost(&made, "smoothing-groups").is_empty());
    made.model.meshes[0].parts[0].clone()
}

/// Which of the six faces a triangle is of, and its three normals.
fn faces(part: &Part) -> Vec<(usize, [Vec3; 3], [Vec3; 3])> {
    let triangles = part.indices.chunks_exact(3);
    let of = |triangle: &[u32]| {
        let at = |list: &[[f32; 3]]| [0, 1, 2].map(|i| Vec3::from(list[triangle[i] as usize]));
        let (p, n) = (at(&part.positions), at(&part.normals));
        let flat = (p[1] - p[0]).cross(p[2] - p[0]).normalize();
        let face = OUTWARDS
            .iter()
            .position(|o| o.dot(flat) > 0.99)
            .expect("a face of a box");
        (face, p, n)
    };
    triangles.map(of).collect()
}

/// What a corner of a cube is to have when its face and those of `with` are smooth together.
fn meets(position: Vec3, face: usize, with: &[usize]) -> Vec3 {
    let all = with.iter().chain([&face]).map(|&f| OUTWARDS[f]);
    let there = all.filter(|normal| normal.dot(position) > 0.0);
    let mut distinct: Vec<Vec3> = there.collect();
    distinct.dedup();
    distinct.sort_by(|a, b| {
        a.to_array()
            .map(|x| x as i32)
            .cmp(&b.to_array().map(|x| x as i32))
    });
    distinct.dedup();
    distinct.into_iter().sum::<Vec3>().normalize()
}

fn check(part: &Part, together: impl Fn(usize, usize) -> bool, vertices: usize) {
    for (face, positions, normals) in faces(part) {
        let with: Vec<usize> = (0..6).filter(|&f| f != face && together(face, f)).collect();
        for (position, normal) in positions.into_iter().zip(normals) {
            let wanted = meets(position, face, &with);
            assert!(
                normal.distance(wanted) < 1e-6,
                "face {face} at {position}: {normal}"
            );
        }
    }
    assert_eq!(part.positions.len(), vertices);
}

#[test]
fn a_top_of_its_own_group_is_hard_around() {
    let made = converted(&field("a21_top_apart.fbx"));
    // The top is face 3; the sides and the bottom are smooth together: 4 and 8 vertices.
    check(
        &made.model.meshes[0].parts[0],
        |a, b| (a == 3) == (b == 3),
        12,
    );
}

#[test]
fn six_groups_are_24_corners_along_the_axes() {
    for groups in [
        [1, 2, 4, 8, 16, 32],
        [0; 6],
        [0, 1, 2, 4, 8, -2_147_483_648],
    ] {
        check(&cube(&layer("ByPolygon", &groups)), |_, _| false, 24);
    }
}

#[test]
fn faces_that_share_a_bit_are_smooth() {
    check(&cube(&layer("ByPolygon", &[1; 6])), |_, _| true, 8);
    let groups = [1, 2, 3, 4, 8, 12];
    let share = |a: usize, b: usize| groups[a] & groups[b] != 0;
    let part = cube(&layer("ByPolygon", &groups));
    check(&part, share, part.positions.len());
    assert!(part.positions.len() > 12);
}

/// Edges: the four around the top are hard, all others smooth.
#[test]
fn edges_are_hard_or_smooth_one_by_one() {
    // Each edge is named by a corner that it begins at, in the list of faces.
    let corners: [(i64, i64); 24] = {
        let faces = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        std::array::from_fn(|i| (faces[i / 4][i % 4], faces[i / 4][(i + 1) % 4]))
    };
    let mut known: Vec<(i64, i64)> = Vec::new();
    let (mut edges, mut smooth) = (Vec::new(), Vec::new());
    for (i, &(a, b)) in corners.iter().enumerate() {
        let edge = (a.min(b), a.max(b));
        if !known.contains(&edge) {
            known.push(edge);
            edges.push(i as i64);
            // Y is up in both of the top's corners.
            smooth.push(i64::from(!(a & 2 != 0 && b & 2 != 0)));
        }
    }
    assert_eq!(edges.len(), 12);
    let more = array("Edges", &edges) + &layer("ByEdge", &smooth);
    check(&cube(&more), |a, b| (a == 3) == (b == 3), 12);
}

/// Nothing said: flat, as other importers have it.
#[test]
fn without_smoothing_all_is_flat() {
    check(&cube(""), |_, _| false, 24);
}

#[test]
fn normals_of_the_file_stand_above_groups() {
    let up: Vec<f64> = (0..24).flat_map(|_| [0.0, 1.0, 0.0]).collect();
    let normals = format!(
        "\t\tLayerElementNormal: 0 {{\n\t\t\tMappingInformationType: \"ByPolygonVertex\"\n\t\t\tReferenceInformationType: \"Direct\"\n{}\t\t}}\n",
        array("Normals", &up)
    );
    let part = cube(&(normals + &layer("ByPolygon", &[1, 2, 4, 8, 16, 32])));
    assert!(part.normals.iter().all(|n| *n == [0.0, 1.0, 0.0]));
}

const TOP_APART: [i64; 6] = [1, 1, 1, 2, 1, 1];

#[test]
fn groups_of_binary_files() {
    let text = |text| vec![Value::Text(text)];
    // The first groups, and those beyond the eighth, up to the last.
    for first in [1, 256, 1 << 20, 1 << 30] {
        let groups = TOP_APART.map(|group| (group * first) as i32).to_vec();
        let layer = Node(
            "LayerElementSmoothing",
            vec![Value::Int(0)],
            vec![
                Node("MappingInformationType", text(b"ByPolygon"), vec![]),
                Node("ReferenceInformationType", text(b"Direct"), vec![]),
                Node("Smoothing", vec![Value::Ints(groups)], vec![]),
            ],
        );
        let file = binary::mesh(
            Value::Doubles(corners(DVec3::NEG_ONE, DVec3::ONE)),
            Value::Ints(FACES.map(|corner| corner as i32).to_vec()),
            vec![layer],
        );
        let made = converted(&file);
        check(
            &made.model.meshes[0].parts[0],
            |a, b| (a == 3) == (b == 3),
            12,
        );
    }
}

#[test]
fn one_group_of_all_faces_is_smooth() {
    check(&cube(&layer("AllSame", &[1])), |_, _| true, 8);
    check(&cube(&layer("AllSame", &[0])), |_, _| false, 24);
}

#[test]
fn smoothing_of_an_unknown_kind_is_said() {
    let objects = geometry(
        1,
        &corners(DVec3::NEG_ONE, DVec3::ONE),
        &layer("ByVertice", &[1; 8]),
    ) + &model(2, "box", "Mesh", "");
    let file = scene(1.0, &objects, &(link(2, 0) + &link(1, 2)));
    let made = converted(file.as_bytes());
    assert_eq!(lost(&made, "smoothing-groups"), ["box"]);
    check(&made.model.meshes[0].parts[0], |_, _| false, 24);
}

/// Before version 7 a node holds its mesh itself, and lists stand without their length.
#[test]
fn groups_of_old_files() {
    let list = |numbers: Vec<String>| numbers.join(",");
    let vertices = corners(DVec3::NEG_ONE, DVec3::ONE);
    let file = format!(
        "; FBX 6.1.0 project file\nFBXHeaderExtension:  {{\n\tFBXHeaderVersion: 1003\n\tFBXVersion: 6100\n}}\nObjects:  {{\n\
         \tModel: \"Model::none\", \"Null\" {{\n\t\tVersion: 232\n\t}}\n\
         \tModel: \"Model::box\", \"Mesh\" {{\n\t\tVersion: 232\n\t\tVertices: {}\n\t\tPolygonVertexIndex: {}\n\t\tGeometryVersion: 124\n\
         \t\tLayerElementSmoothing: 0 {{\n\t\t\tMappingInformationType: \"ByPolygon\"\n\t\t\tReferenceInformationType: \"Direct\"\n\t\t\tSmoothing: {}\n\t\t}}\n\
         \t\tLayer: 0 {{\n\t\t\tLayerElement:  {{\n\t\t\t\tType: \"LayerElementSmoothing\"\n\t\t\t\tTypedIndex: 0\n\t\t\t}}\n\t\t}}\n\t}}\n}}\n\
         Connections:  {{\n\tConnect: \"OO\", \"Model::box\", \"Model::Scene\"\n\tConnect: \"OO\", \"Model::none\", \"Model::Scene\"\n}}\n",
        list(vertices.iter().map(f64::to_string).collect()),
        list(FACES.iter().map(i64::to_string).collect()),
        list(TOP_APART.iter().map(i64::to_string).collect()),
    );
    let made = converted(file.as_bytes());
    assert!(lost(&made, "smoothing-groups").is_empty());
    check(
        &made.model.meshes[0].parts[0],
        |a, b| (a == 3) == (b == 3),
        12,
    );
}
