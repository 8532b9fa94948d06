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
