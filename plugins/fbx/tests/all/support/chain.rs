//! A chain of nodes that inherit scale in several ways.

use super::ascii::{curve, header};

/// Three nodes, each below the last and 10 units above it, with a triangle each. From 0 s to 1 s each is
/// turned by 50 degrees about its X and scaled by (2, 0.5, 1.5), straight; `inherit` is FBX's number of
/// how each inherits its parent's scale: 0 by component, 1 as matrices do, 2 not at all.
pub fn chain(inherit: [i32; 3]) -> String {
    chain_with(inherit, &(0..3).collect::<Vec<_>>(), "")
}

/// The same with more properties of each node, and with the nodes listed in that order.
pub fn chain_with(inherit: [i32; 3], order: &[usize], properties: &str) -> String {
    let mut text = header() + "Objects:  {\n";
    text += "\tGeometry: 100, \"Geometry::triangle\", \"Mesh\" {\n\t\tVertices: *9 {\n\t\t\ta: 1,0,2, 0,3,0, -1,1,1\n\t\t}\n";
    text += "\t\tPolygonVertexIndex: *3 {\n\t\t\ta: 0,1,-3\n\t\t}\n\t\tGeometryVersion: 124\n\t}\n";
    let mut connections = String::new();
    text += "\tAnimationStack: 400, \"AnimStack::grow\", \"\" {\n\t}\n\tAnimationLayer: 401, \"AnimLayer::layer\", \"\" {\n\t}\n";
    connections += "\tC: \"OO\",401,400\n";
    for &number in order {
        let (i, inherit) = (number as i64, inherit[number]);
        let (node, base) = (200 + i, 500 + 20 * i);
        text += &format!(
            "\tModel: {node}, \"Model::n{i}\", \"Mesh\" {{\n\t\tVersion: 232\n\t\tProperties70:  {{\n\t\t\t\
             P: \"InheritType\", \"enum\", \"\", \"\",{inherit}\n{properties}\t\t\t\
             P: \"Lcl Translation\", \"Lcl Translation\", \"\", \"A\",0,10,0\n\t\t}}\n\t}}\n"
        );
        let parent = if i == 0 { 0 } else { node - 1 };
        connections += &format!("\tC: \"OO\",{node},{parent}\n\tC: \"OO\",100,{node}\n");
        let kinds = [
            ("Lcl Rotation", [(0.0, 50.0), (0.0, 0.0), (0.0, 0.0)]),
            ("Lcl Scaling", [(1.0, 2.0), (1.0, 0.5), (1.0, 1.5)]),
        ];
        for (kind, (property, values)) in (0..).zip(kinds) {
            let curves = base + 5 * kind;
            text +=
                &format!("\tAnimationCurveNode: {curves}, \"AnimCurveNode::x\", \"\" {{\n\t}}\n");
            connections +=
                &format!("\tC: \"OO\",{curves},401\n\tC: \"OP\",{curves},{node}, \"{property}\"\n");
            for (axis, (from, to)) in (1..).zip(values) {
                text += &curve(curves + axis, from, to, 0);
                let letter = ["X", "Y", "Z"][axis as usize - 1];
                connections += &format!("\tC: \"OP\",{},{curves}, \"d|{letter}\"\n", curves + axis);
            }
        }
    }
    text + "}\nConnections:  {\n" + &connections + "}\n"
}
