//! Smoothing groups: faces that share one are smooth where they meet. ufbx keeps of each face's groups
//! whether there is any.

use super::{Values, walk};

/// What one mesh of a file says.
#[derive(Default)]
struct Object {
    is_mesh: bool,
    has_vertices: bool,
    by_polygon: bool,
    groups: Vec<i64>,
}

/// For each mesh in the order of the file, a bit set of groups for each of its faces; empty where it
/// has none.
pub(crate) fn smoothing_groups(file: &[u8]) -> Vec<Vec<u32>> {
    let mut objects: Vec<Object> = Vec::new();
    // Names of the nodes that the walk is in, from the top on.
    let mut path: Vec<&[u8]> = Vec::new();
    walk(file, &mut |depth, name, values| {
        path.truncate(depth);
        path.push(name);
        take(&path, values, &mut objects);
    });
    let meshes = objects.into_iter().filter(|o| o.is_mesh && o.has_vertices);
    meshes
        .map(|object| match object.by_polygon {
            // Bit 31 is a sign to some and a bit to others.
            true => object.groups.iter().map(|&group| group as u32).collect(),
            false => Vec::new(),
        })
        .collect()
}

fn take(path: &[&[u8]], values: Values, objects: &mut Vec<Object>) {
    let [b"Objects", kind @ (b"Geometry" | b"Model"), inner @ ..] = path else {
        return;
    };
    if inner.is_empty() {
        objects.push(Object {
            // Geometry may be a shape too; before version 7 the node itself holds the mesh.
            is_mesh: *kind == b"Model" || values.last_string() == Some(b"Mesh"),
            ..Object::default()
        });
        return;
    }
    let Some(object) = objects.last_mut() else {
        return;
    };
    match inner {
        [b"Vertices"] => object.has_vertices = true,
        // The first layer counts.
        [b"LayerElementSmoothing", b"MappingInformationType"] if object.groups.is_empty() => {
            object.by_polygon = values.last_string() == Some(b"ByPolygon");
        }
        [b"LayerElementSmoothing", b"Smoothing"]
        | [b"LayerElementSmoothing", b"Smoothing", b"a"]
            if object.groups.is_empty() =>
        {
            object.groups = values.numbers();
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::smoothing_groups;

    #[test]
    fn groups_of_both_ages_of_text() {
        let layer = |array: &str| {
            format!(
                "LayerElementSmoothing: 0 {{\nMappingInformationType: \"ByPolygon\"\nSmoothing: {array}\n}}\n"
            )
        };
        let old = layer("1,2,\n4");
        let new = layer("*3 {\na: 1,2,-2147483648\n}");
        let text = format!(
            "Objects: {{\nModel: \"Model::a\", \"Mesh\" {{\nVertices: 0,0,0\n{old}}}\nModel: \"Model::b\", \"Null\" {{\n}}\n\
             Geometry: 5, \"Geometry::s\", \"Shape\" {{\nVertices: *0 {{\n}}\n}}\n\
             Geometry: 6, \"Geometry::c\", \"Mesh\" {{\nVertices: *0 {{\n}}\n{new}}}\n}}\n"
        );
        assert_eq!(
            smoothing_groups(text.as_bytes()),
            [vec![1, 2, 4], vec![1, 2, 1 << 31]]
        );
    }
}
