//! Memory follows what a mesh needs, not how well its file is packed; and what a file claims is not
//! believed.

use crate::binary::{Node, Value, mesh};
use crate::counting::{ALONE, base, peak};
use dolomite_fbx::{FbxError, Limits, Options, Origin, convert};
use miniz_oxide::deflate::compress_to_vec_zlib;

/// The triangles that came out, and the most memory that it took.
fn take(file: &[u8], options: &Options) -> (Result<usize, FbxError>, usize) {
    let base = base();
    let origin = Origin {
        name: "m.fbx".into(),
        ..Origin::default()
    };
    let made = convert(file, &origin, options);
    let made = made.and_then(|made| made.to_glb().map(|_| made.report.triangles));
    (made, peak(base))
}

/// Boxes on a grid, with normals and texture coordinates of every corner: bytes of the file, and of the
/// same unpacked.
fn voxels(side: i32) -> (Vec<u8>, usize) {
    let (mut vertices, mut polygons) = (Vec::new(), Vec::new());
    let (mut normals, mut uvs) = (Vec::new(), Vec::new());
    const FACES: [[i32; 4]; 6] = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    for i in 0..side * side {
        let (x, z) = (f64::from(i % side), f64::from(i / side));
        for corner in 0..8_i32 {
            let bit = |b: i32| f64::from(corner >> b & 1);
            vertices.extend([x + bit(0), bit(1), z + bit(2)]);
        }
        for (number, face) in FACES.iter().enumerate() {
            polygons.extend([0, 1, 2].map(|k| 8 * i + face[k]));
            polygons.push(-(8 * i + face[3]) - 1);
            for k in 0..4 {
                let mut normal = [0.0; 3];
                normal[2 - number / 2] = if number % 2 == 0 { -1.0 } else { 1.0 };
                normals.extend(normal);
                uvs.extend([f64::from(k & 1), f64::from(k / 2)]);
            }
        }
    }
    let unpacked = 8 * (vertices.len() + normals.len() + uvs.len()) + 4 * polygons.len();
    let text = |text| vec![Value::Text(text)];
    let layer = |name, kind, values| {
        Node(
            name,
            vec![Value::Int(0)],
            vec![
                Node("MappingInformationType", text(b"ByPolygonVertex"), vec![]),
                Node("ReferenceInformationType", text(b"Direct"), vec![]),
                Node(kind, vec![Value::Doubles(values)], vec![]),
            ],
        )
    };
    let more = vec![
        layer("LayerElementNormal", "Normals", normals),
        layer("LayerElementUV", "UV", uvs),
    ];
    let file = mesh(Value::Doubles(vertices), Value::Ints(polygons), more);
    (file, unpacked)
}

/// 22 500 boxes, packed far better than fifteen-fold.
#[test]
fn a_mesh_of_voxels_is_converted() {
    let _alone = ALONE.lock();
    let (file, unpacked) = voxels(150);
    assert!(file.len() * 15 < unpacked, "{} of {unpacked}", file.len());
    let (made, peak) = take(&file, &Options::default());
    assert_eq!(made.unwrap(), 22_500 * 12);
    let allowed = 64e6 + 20.0 * unpacked as f64;
    eprintln!(
        "{} B packed, {unpacked} B unpacked, {peak} B at most, {allowed:e} allowed",
        file.len()
    );
    assert!((peak as f64) < allowed);
    // What the size of the packed file alone would allow does not do.
    let packed = Options {
        limits: Some(Limits::of_file(file.len())),
        ..Options::default()
    };
    let (refused, peak) = take(&file, &packed);
    assert!(
        matches!(refused, Err(FbxError::Memory { .. })),
        "{refused:?}"
    );
    assert!((peak as f64) < 64e6 + 20.0 * file.len() as f64);
    // And is raised by its own setting.
    let raised = Options {
        max_memory: Some(1 << 30),
        ..packed
    };
    assert_eq!(take(&file, &raised).0.unwrap(), 22_500 * 12);
}

/// A grid of `side` by `side` squares with `targets` blend shapes that move one vertex each, as text.
fn sparse_shapes(side: usize, targets: usize) -> String {
    let row = side + 1;
    let vertices: Vec<String> = (0..row * row)
        .map(|i| format!("{},0,{}", i % row, i / row))
        .collect();
    let squares = (0..side * side).map(|i| {
        let corner = i / side * row + i % side;
        let last = -(corner as i64 + 1) - 1;
        format!("{corner},{},{},{last}", corner + row, corner + row + 1)
    });
    let squares: Vec<String> = squares.collect();
    let mut text = format!(
        "; FBX 7.4.0 project file\nFBXHeaderExtension:  {{\nFBXHeaderVersion: 1003\nFBXVersion: 7400\n}}\nObjects:  {{\n\
         Geometry: 1, \"Geometry::m\", \"Mesh\" {{\nVertices: *{} {{\na: {}\n}}\nPolygonVertexIndex: *{} {{\na: {}\n}}\nGeometryVersion: 124\n}}\n\
         Model: 2, \"Model::m\", \"Mesh\" {{\nVersion: 232\n}}\n\
         Deformer: 3, \"Deformer::s\", \"BlendShape\" {{\nVersion: 100\n}}\n",
        3 * vertices.len(),
        vertices.join(","),
        4 * squares.len(),
        squares.join(",")
    );
    let mut links = String::from("C: \"OO\",2,0\nC: \"OO\",1,2\nC: \"OO\",3,1\n");
    for target in 0..targets {
        let (channel, shape) = (100 + target, 1000 + target);
        text += &format!(
            "Geometry: {shape}, \"Geometry::s{target}\", \"Shape\" {{\nVersion: 100\nIndexes: *1 {{\na: {target}\n}}\nVertices: *3 {{\na: 0,1,0\n}}\n}}\n\
             Deformer: {channel}, \"SubDeformer::c{target}\", \"BlendShapeChannel\" {{\nVersion: 100\nDeformPercent: 0\nFullWeights: *1 {{\na: 100\n}}\n}}\n"
        );
        links += &format!("C: \"OO\",{channel},3\nC: \"OO\",{shape},{channel}\n");
    }
    text + "}\nConnections:  {\n" + &links + "}\n"
}

/// Targets take memory by vertices, not by corners.
#[test]
fn many_sparse_shapes_are_converted() {
    let _alone = ALONE.lock();
    let file = sparse_shapes(60, 52);
    let (made, peak) = take(file.as_bytes(), &Options::default());
    assert_eq!(made.unwrap(), 7_200);
    let allowed = 64e6 + 20.0 * file.len() as f64;
    eprintln!("{} B, {peak} B at most, {allowed:e} allowed", file.len());
    assert!((peak as f64) < allowed);
    // More of them than the limit holds are refused before they are spread out.
    let many = sparse_shapes(60, 400);
    let (refused, peak) = take(many.as_bytes(), &Options::default());
    assert!(matches!(refused, Err(FbxError::Memory { .. })));
    assert!((peak as f64) < 64e6 + 20.0 * many.len() as f64);
}

/// Arrays that claim gigabytes, with little or nothing behind.
#[test]
fn a_count_that_lies_takes_no_memory() {
    let _alone = ALONE.lock();
    let little = compress_to_vec_zlib(&[0; 3 << 16], 9);
    for bytes in [vec![], vec![0x78; 4096], little] {
        for count in [1 << 20, 1 << 26, u32::MAX] {
            let file = mesh(
                Value::Claim(count, bytes.clone()),
                Value::Ints(vec![0, 1, -3]),
                vec![],
            );
            let (made, peak) = take(&file, &Options::default());
            let error = made.unwrap_err();
            assert!(error.to_string().contains("m.fbx"), "{error}");
            let allowed = 64e6 + 20.0 * file.len().max(3 << 16) as f64;
            assert!((peak as f64) < allowed, "{count}: {peak}");
        }
    }
}

/// A megabyte of deflate that is a gigabyte of zeros is refused long before.
#[test]
fn a_bomb_is_refused() {
    let _alone = ALONE.lock();
    let zeros = vec![0_u8; 64 << 20];
    let packed = compress_to_vec_zlib(&zeros, 9);
    drop(zeros);
    assert!(packed.len() < 70_000);
    let count = (64 << 20) / 8;
    let file = mesh(
        Value::Claim(count, packed),
        Value::Ints(vec![0, 1, -3]),
        vec![],
    );
    let (_, peak) = take(&file, &Options::default());
    // 128 times the file and what is always there, not a thousand times.
    let allowed = 64e6 + 20.0 * 128.0 * file.len() as f64;
    assert!((peak as f64) < allowed, "{peak} of {allowed}");
}
