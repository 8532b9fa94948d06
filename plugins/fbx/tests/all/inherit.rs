//! Nodes beside scales that children do not inherit, by values worked out by hand.

use crate::support::scene::{array, converted, link, model, scene};
use glam::DVec3;

fn vector(name: &str, [x, y, z]: [f64; 3]) -> String {
    format!("\t\t\tP: \"{name}\", \"{name}\", \"\", \"A\",{x},{y},{z}\n")
}

fn inherit(number: i32) -> String {
    format!("\t\t\tP: \"InheritType\", \"enum\", \"\", \"\",{number}\n")
}

/// Where a node is, and its axes' lengths.
fn place(made: &dolomite_fbx::Conversion, name: &str) -> (DVec3, DVec3) {
    let nodes = &made.model.nodes;
    let mut above = nodes.iter().position(|node| node.name == name);
    assert!(above.is_some(), "no node {name}");
    let mut world = glam::DMat4::IDENTITY;
    while let Some(at) = above {
        world = nodes[at].rest.matrix() * world;
        above = nodes[at].parent;
    }
    let length = |axis: glam::DVec4| axis.truncate().length();
    (
        world.w_axis.truncate(),
        DVec3::new(
            length(world.x_axis),
            length(world.y_axis),
            length(world.z_axis),
        ),
    )
}

fn is_at(made: &dolomite_fbx::Conversion, name: &str, wanted: [f64; 3], scale: [f64; 3]) {
    let (place, lengths) = place(made, name);
    let off = place
        .distance(wanted.into())
        .max(lengths.distance(scale.into()));
    assert!(off < 1e-12, "{name} is at {place}, as large as {lengths}");
}

/// A scale of (2, 1, 3) about (1, 0, 2), moved by (0, 5, 0): what was at the pivot is at (1, 5, 2), so that the node's own
/// origin is at (1 - 2 * 1, 5, 2 - 3 * 2) = (-1, 5, -4).
#[test]
fn a_node_turns_and_grows_about_its_pivots_though_a_helper_has_its_scale() {
    let parent = vector("Lcl Scaling", [2.0, 1.0, 3.0])
        + &vector("ScalingPivot", [1.0, 0.0, 2.0])
        + &vector("ScalingOffset", [0.0, 5.0, 0.0]);
    let child = inherit(2) + &vector("Lcl Translation", [10.0, 20.0, 30.0]);
    let objects = model(1, "parent", "Null", &parent) + &model(2, "child", "Null", &child);
    let made = converted(scene(100.0, &objects, &(link(1, 0) + &link(2, 1))).as_bytes());
    is_at(&made, "parent", [-1.0, 5.0, -4.0], [1.0; 3]);
    is_at(&made, "parent.scale", [-1.0, 5.0, -4.0], [2.0, 1.0, 3.0]);
    is_at(&made, "child", [19.0, 25.0, 86.0], [1.0; 3]);
}

/// All that makes up a child's place is in the parent's space, which is scaled: turned by 180 degrees about Y at the pivot
/// (1, 0, 0), the child's origin is at (2, 0, 0), with its two offsets (one turned too) at (2 + 3 - 7, 4, 0) = (-2, 4, 0).
#[test]
fn offsets_and_pivots_of_a_child_are_scaled_as_its_translation_is() {
    for number in [0, 2] {
        let parent = vector("Lcl Scaling", [2.0, 10.0, 3.0]);
        let child = inherit(number)
            + &vector("Lcl Rotation", [0.0, 180.0, 0.0])
            + &vector("RotationPivot", [1.0, 0.0, 0.0])
            + &vector("RotationOffset", [3.0, 4.0, 0.0])
            + &vector("ScalingOffset", [7.0, 0.0, 0.0]);
        let objects = model(1, "parent", "Null", &parent) + &model(2, "child", "Null", &child);
        let made = converted(scene(100.0, &objects, &(link(1, 0) + &link(2, 1))).as_bytes());
        let scale = if number == 0 {
            [2.0, 10.0, 3.0]
        } else {
            [1.0; 3]
        };
        let name = if number == 0 { "child.scale" } else { "child" };
        is_at(&made, name, [-4.0, 40.0, 0.0], scale);
    }
}

/// A joint whose matrix a bind pose alone says is bound where the mesh's node is at rest, (2 * 3, 0, 0) from the joint at the origin.
#[test]
fn a_joint_is_bound_where_the_node_is() {
    let one = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
    let child = inherit(2) + &vector("RotationOffset", [3.0, 0.0, 0.0]);
    let corners = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let triangle = array("Vertices", &corners) + &array("PolygonVertexIndex", &[0, 1, -3]);
    let objects = model(1, "parent", "Null", &vector("Lcl Scaling", [2.0, 1.0, 1.0]))
        + &model(2, "child", "Mesh", &child)
        + &model(3, "joint", "LimbNode", "")
        + &format!(
            "\tGeometry: 10, \"Geometry::triangle\", \"Mesh\" {{\n{triangle}\t\tGeometryVersion: 124\n\t}}\n"
        )
        + "\tDeformer: 20, \"Deformer::skin\", \"Skin\" {\n\t\tVersion: 101\n\t}\n"
        + "\tDeformer: 21, \"SubDeformer::joint\", \"Cluster\" {\n\t\tVersion: 100\n"
        + &array("Indexes", &[0, 1, 2])
        + &array("Weights", &[1, 1, 1])
        + "\t}\n\tPose: 30, \"Pose::bind\", \"BindPose\" {\n\t\tType: \"BindPose\"\n\t\tVersion: 100\n\t\tPoseNode:  {\n\t\t\tNode: 3\n"
        + &array("Matrix", &one)
        + "\t\t}\n\t}\n";
    let links = [(1, 0), (2, 1), (3, 0), (10, 2), (20, 10), (21, 20), (3, 21)];
    let links: String = links.iter().map(|&(from, to)| link(from, to)).collect();
    let made = converted(scene(100.0, &objects, &links).as_bytes());
    let bind = made.model.skins[0].inverse_bind[0];
    let off = bind.w_axis.truncate().distance(DVec3::new(6.0, 0.0, 0.0));
    assert!(off < 1e-12, "bound at {}", bind.w_axis);
    // The mesh's own node keeps its place too.
    is_at(&made, "child", [6.0, 0.0, 0.0], [1.0; 3]);
}

/// A camera looks along its own X in a file and along -Z in glTF; what hangs on it is where it was.
#[test]
fn what_hangs_on_a_camera_is_not_turned_with_its_axes() {
    let camera = vector("Lcl Scaling", [2.0, 3.0, 4.0]) + &vector("Lcl Translation", [1.0; 3]);
    let child = vector("Lcl Translation", [10.0, 20.0, 30.0]);
    let objects = model(1, "camera", "Camera", &camera)
        + "\tNodeAttribute: 5, \"NodeAttribute::camera\", \"Camera\" {\n\t\tTypeFlags: \"Camera\"\n\t}\n"
        + &model(2, "child", "Null", &child);
    let links = link(1, 0) + &link(2, 1) + &link(5, 1);
    let made = converted(scene(100.0, &objects, &links).as_bytes());
    assert!(made.model.nodes.iter().any(|node| node.camera.is_some()));
    is_at(&made, "child", [21.0, 61.0, 121.0], [2.0, 3.0, 4.0]);
}
