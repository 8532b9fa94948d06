//! Small binary FBX files of our own, with packed arrays.

use miniz_oxide::deflate::compress_to_vec_zlib;

/// A value of a node.
pub enum Value {
    /// `I`
    Int(i32),
    /// `L`
    Long(i64),
    /// `S`
    Text(&'static [u8]),
    /// `d`, packed.
    Doubles(Vec<f64>),
    /// `i`, packed.
    Ints(Vec<i32>),
    /// `d`: a count that is claimed, and packed bytes.
    Claim(u32, Vec<u8>),
}

/// A node: a name, values, nodes.
pub struct Node(pub &'static str, pub Vec<Value>, pub Vec<Node>);

fn packed(kind: u8, count: u32, bytes: &[u8]) -> Vec<u8> {
    let mut out = vec![kind];
    for word in [count, 1, bytes.len() as u32] {
        out.extend(word.to_le_bytes());
    }
    out.extend(bytes);
    out
}

impl Value {
    fn bytes(&self) -> Vec<u8> {
        match self {
            Self::Int(x) => [vec![b'I'], x.to_le_bytes().to_vec()].concat(),
            Self::Long(x) => [vec![b'L'], x.to_le_bytes().to_vec()].concat(),
            Self::Text(text) => {
                let length = (text.len() as u32).to_le_bytes().to_vec();
                [vec![b'S'], length, text.to_vec()].concat()
            }
            Self::Doubles(list) => {
                let raw: Vec<u8> = list.iter().flat_map(|x| x.to_le_bytes()).collect();
                packed(b'd', list.len() as u32, &compress_to_vec_zlib(&raw, 6))
            }
            Self::Ints(list) => {
                let raw: Vec<u8> = list.iter().flat_map(|x| x.to_le_bytes()).collect();
                packed(b'i', list.len() as u32, &compress_to_vec_zlib(&raw, 6))
            }
            Self::Claim(count, bytes) => packed(b'd', *count, bytes),
        }
    }
}

impl Node {
    fn write(&self, out: &mut Vec<u8>) {
        let begin = out.len();
        let values: Vec<u8> = self.1.iter().flat_map(Value::bytes).collect();
        for word in [0, self.1.len() as u32, values.len() as u32] {
            out.extend(word.to_le_bytes());
        }
        out.push(self.0.len() as u8);
        out.extend(self.0.as_bytes());
        out.extend(values);
        if !self.2.is_empty() {
            self.2.iter().for_each(|node| node.write(out));
            out.extend([0; 13]);
        }
        let end = out.len() as u32;
        out[begin..begin + 4].copy_from_slice(&end.to_le_bytes());
    }
}

/// A file of version 7400 with these nodes at the top.
pub fn file(nodes: &[Node]) -> Vec<u8> {
    let mut out = b"Kaydara FBX Binary  \0\x1a\0".to_vec();
    out.extend(7400_u32.to_le_bytes());
    nodes.iter().for_each(|node| node.write(&mut out));
    out.extend([0; 13]);
    out
}

/// A file of one mesh: vertices and polygons, and what else its geometry holds.
pub fn mesh(vertices: Value, polygons: Value, more: Vec<Node>) -> Vec<u8> {
    let mut geometry = vec![
        Node("Vertices", vec![vertices], vec![]),
        Node("PolygonVertexIndex", vec![polygons], vec![]),
        Node("GeometryVersion", vec![Value::Int(124)], vec![]),
    ];
    geometry.extend(more);
    let name = |text| Value::Text(text);
    file(&[
        Node(
            "FBXHeaderExtension",
            vec![],
            vec![Node("FBXVersion", vec![Value::Int(7400)], vec![])],
        ),
        Node(
            "Objects",
            vec![],
            vec![
                Node(
                    "Geometry",
                    vec![Value::Long(1), name(b"m\0\x01Geometry"), name(b"Mesh")],
                    geometry,
                ),
                Node(
                    "Model",
                    vec![Value::Long(2), name(b"m\0\x01Model"), name(b"Mesh")],
                    vec![Node("Version", vec![Value::Int(232)], vec![])],
                ),
            ],
        ),
        Node(
            "Connections",
            vec![],
            vec![
                Node(
                    "C",
                    vec![name(b"OO"), Value::Long(1), Value::Long(2)],
                    vec![],
                ),
                Node(
                    "C",
                    vec![name(b"OO"), Value::Long(2), Value::Long(0)],
                    vec![],
                ),
            ],
        ),
    ])
}
