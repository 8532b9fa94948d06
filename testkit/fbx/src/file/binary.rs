//! FBX as bytes: records with the place where they end, arrays plain or deflated.

use super::{Record, Value};
use miniz_oxide::deflate::compress_to_vec_zlib;

/// Writes records as bytes; from version 7500 on places are numbers of 64 bits. `deflate` says whether arrays are.
pub fn write(records: &[Record], version: u32, deflate: bool) -> Vec<u8> {
    let mut out = b"Kaydara FBX Binary  \0\x1a\0".to_vec();
    out.extend(version.to_le_bytes());
    let wide = version >= 7500;
    for record in records {
        one(record, wide, deflate, &mut out);
    }
    end(wide, &mut out);
    // What else programs write here (a fixed number, padding, the version again) no reader looks at.
    out.extend([0; 16]);
    out
}

/// The record of nothing that ends a list.
fn end(wide: bool, out: &mut Vec<u8>) {
    out.extend(std::iter::repeat_n(0, if wide { 25 } else { 13 }));
}

fn one(record: &Record, wide: bool, deflate: bool, out: &mut Vec<u8>) {
    let place = |out: &mut Vec<u8>, x: usize| match wide {
        true => out.extend((x as u64).to_le_bytes()),
        false => out.extend((x as u32).to_le_bytes()),
    };
    let mut values = Vec::new();
    for value in &record.values {
        put(value, deflate, &mut values);
    }
    let start = out.len();
    place(out, 0);
    place(out, record.values.len());
    place(out, values.len());
    out.push(record.name.len() as u8);
    out.extend(record.name.as_bytes());
    out.extend(values);
    if !record.below.is_empty() || record.values.is_empty() {
        for below in &record.below {
            one(below, wide, deflate, out);
        }
        end(wide, out);
    }
    let stop = out.len();
    let mut head = Vec::new();
    place(&mut head, stop);
    out[start..start + head.len()].copy_from_slice(&head);
}

fn put(value: &Value, deflate: bool, out: &mut Vec<u8>) {
    let mut array = |kind: u8, count: usize, bytes: Vec<u8>| {
        out.push(kind);
        out.extend((count as u32).to_le_bytes());
        let bytes = match deflate {
            true => compress_to_vec_zlib(&bytes, 6),
            false => bytes,
        };
        out.extend(u32::from(deflate).to_le_bytes());
        out.extend((bytes.len() as u32).to_le_bytes());
        out.extend(bytes);
    };
    match value {
        Value::Ints(all) => array(
            b'i',
            all.len(),
            all.iter().flat_map(|x| x.to_le_bytes()).collect(),
        ),
        Value::Longs(all) => array(
            b'l',
            all.len(),
            all.iter().flat_map(|x| x.to_le_bytes()).collect(),
        ),
        Value::Floats(all) => array(
            b'f',
            all.len(),
            all.iter().flat_map(|x| x.to_le_bytes()).collect(),
        ),
        Value::Bits(all) => array(
            b'f',
            all.len(),
            all.iter().flat_map(|x| x.to_le_bytes()).collect(),
        ),
        Value::Doubles(all) => array(
            b'd',
            all.len(),
            all.iter().flat_map(|x| x.to_le_bytes()).collect(),
        ),
        Value::Int(x) => {
            out.push(b'I');
            out.extend(x.to_le_bytes());
        }
        Value::Long(x) => {
            out.push(b'L');
            out.extend(x.to_le_bytes());
        }
        Value::Double(x) => {
            out.push(b'D');
            out.extend(x.to_le_bytes());
        }
        Value::Letter(x) => out.extend([b'C', *x]),
        Value::Text(text) => {
            out.push(b'S');
            out.extend((text.len() as u32).to_le_bytes());
            out.extend(text.as_bytes());
        }
    }
}
