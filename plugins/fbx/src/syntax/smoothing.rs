//! Smoothing groups: faces that share one are smooth where they meet. ufbx keeps of each face's groups
//! whether there is any.

use super::{Values, walk};

/// What a file says of the smoothing of a mesh's faces.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Smoothing {
    /// Nothing, or something of its edges.
    Unsaid,
    /// For each face a bit set of groups.
    Faces(Vec<u32>),
    /// All faces are of these groups.
    All(u32),
    /// Something of a kind that is not known.
    Unknown,
}

/// What one mesh of a file says.
#[derive(Default)]
struct Object {
    is_mesh: bool,
    has_vertices: bool,
    /// What the numbers are of; `None` where there is no layer.
    mapping: Option<Vec<u8>>,
    groups: Vec<i64>,
}

impl Object {
    fn smoothing(self) -> Smoothing {
        // Bit 31 is a sign to some and a bit to others.
        let mut groups = self.groups.into_iter().map(|group| group as u32);
        match self.mapping.as_deref() {
            None | Some(b"ByEdge") => Smoothing::Unsaid,
            Some(b"ByPolygon") => Smoothing::Faces(groups.collect()),
            Some(b"AllSame") => groups.next().map_or(Smoothing::Unknown, Smoothing::All),
            Some(_) => Smoothing::Unknown,
        }
    }
}

/// For each mesh in the order of the file.
pub(crate) fn smoothing_groups(file: &[u8]) -> Vec<Smoothing> {
    let mut objects: Vec<Object> = Vec::new();
    // Names of the nodes that the walk is in, from the top on.
    let mut path: Vec<&[u8]> = Vec::new();
    walk(file, &mut |depth, name, values| {
        path.truncate(depth);
        path.push(name);
        take(&path, values, &mut objects);
    });
    let meshes = objects.into_iter().filter(|o| o.is_mesh && o.has_vertices);
    meshes.map(Object::smoothing).collect()
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
            object.mapping = Some(values.last_string().unwrap_or_default().to_vec());
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
    use super::{Smoothing, smoothing_groups};

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
            [vec![1, 2, 4], vec![1, 2, 1 << 31]].map(Smoothing::Faces)
        );
    }

    #[test]
    fn what_groups_are_of_is_told_apart() {
        let of = |layer: &str| {
            let text = format!(
                "Objects: {{\nGeometry: 6, \"Geometry::c\", \"Mesh\" {{\nVertices: *0 {{\n}}\n{layer}}}\n}}\n"
            );
            smoothing_groups(text.as_bytes())
        };
        let layer = |mapping: &str| {
            of(&format!(
                "LayerElementSmoothing: 0 {{\nMappingInformationType: \"{mapping}\"\nSmoothing: *1 {{\na: 4\n}}\n}}\n"
            ))
        };
        assert_eq!(of(""), [Smoothing::Unsaid]);
        assert_eq!(layer("ByEdge"), [Smoothing::Unsaid]);
        assert_eq!(layer("ByPolygon"), [Smoothing::Faces(vec![4])]);
        assert_eq!(layer("AllSame"), [Smoothing::All(4)]);
        assert_eq!(layer("ByVertice"), [Smoothing::Unknown]);
    }
}
