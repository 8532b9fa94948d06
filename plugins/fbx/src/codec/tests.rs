//! The codec, against itself and against meshoptimizer.

use super::*;

struct Random(u64);

impl Random {
    fn next(&mut self) -> u32 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (self.0 >> 33) as u32
    }
}

fn attributes(filter: Filter, stride: usize, count: usize) -> Layout {
    Layout {
        mode: Mode::Attributes,
        filter,
        stride,
        count,
    }
}

#[test]
fn elements_come_back_bit_for_bit() {
    let mut random = Random(1);
    for stride in [4, 8, 12, 16, 48, 64, 256] {
        for count in [1, 2, 15, 16, 17, 255, 256, 257, 1000] {
            let bits = random.next() % 8;
            let bytes: Vec<u8> = (0..stride * count)
                .map(|_| (random.next() & ((1 << bits) - 1)) as u8)
                .collect();
            let coded = encode(&bytes, stride).unwrap();
            assert_eq!(coded[0], 0xa0, "the extension has version 0 alone");
            let back = decode(&coded, attributes(Filter::None, stride, count));
            assert_eq!(back.unwrap(), bytes, "{stride} {count}");
        }
    }
    assert_eq!(encode(&[0; 12], 6), None);
    assert_eq!(encode(&[0; 13], 4), None);
}

/// Whatever does not change costs least: no count that is sound may be refused.
#[test]
fn a_million_equal_elements_are_believed() {
    for count in [1, 256, 1_000_000] {
        let bytes = vec![7; 4 * count];
        let coded = encode(&bytes, 4).unwrap();
        let back = decode(&coded, attributes(Filter::None, 4, count)).unwrap();
        assert_eq!(back, bytes);
    }
    let coded = encode(&[7; 400], 4).unwrap();
    let lying = attributes(Filter::None, 4, usize::MAX / 8);
    assert!(decode(&coded, lying).is_err());
}

#[test]
fn quaternions_are_what_the_decoder_makes() {
    let mut random = Random(2);
    for bits in 4..=15 {
        let mut stored = Vec::new();
        let mut wanted = Vec::new();
        for _ in 0..200 {
            let q = [0; 4].map(|_| f64::from(random.next()) / f64::from(1_u32 << 31) * 2.0 - 1.0);
            let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
            let q = q.map(|x| x / length);
            let (kept, back) = quaternion_of_bits(q, bits);
            stored.extend(kept.iter().flat_map(|x| x.to_le_bytes()));
            wanted.extend(back.iter().flat_map(|x| x.to_le_bytes()));
            // Half a step in each of three numbers, and what that does to the fourth.
            let step = 0.5_f64.sqrt() / f64::from((1 << (bits - 1)) - 1);
            let dot: f64 = (0..4).map(|i| f64::from(back[i]) / 32767.0 * q[i]).sum();
            let size = back
                .iter()
                .map(|&x| f64::from(x) / 32767.0 * (f64::from(x) / 32767.0))
                .sum::<f64>()
                .sqrt();
            let cosine = (dot.abs() / size).min(1.0);
            // Small angles are their sines.
            let angle = 2.0 * (1.0 - cosine * cosine).sqrt();
            assert!(angle < 7.0 * step + 1e-4, "{bits}: {angle} {step}");
        }
        let coded = encode(&stored, 8).unwrap();
        let back = decode(&coded, attributes(Filter::Quaternion, 8, 200)).unwrap();
        assert!(back == wanted, "{bits} bits");
    }
}

#[test]
fn multiples_of_powers_of_two_come_back_exactly() {
    let mut random = Random(3);
    for step in [-60, -24, -12, 0, 5] {
        let size = power(step);
        let values: Vec<f32> = (0..300)
            .map(|_| ((f64::from(random.next() % 2_000_001) - 1e6) * size) as f32)
            .collect();
        let stored = exponential(&values, 3).expect("21 bits fit 24");
        let bytes: Vec<u8> = stored.iter().flat_map(|x| x.to_le_bytes()).collect();
        let coded = encode(&bytes, 12).unwrap();
        let back = decode(&coded, attributes(Filter::Exponential, 12, 100)).unwrap();
        let wanted: Vec<u8> = values.iter().flat_map(|x| x.to_le_bytes()).collect();
        assert_eq!(back, wanted, "{step}");
    }
    assert_eq!(exponential(&[1.0, 1e-30], 1), None);
    assert_eq!(exponential(&[f32::NAN], 1), None);
    assert_eq!(exponential(&[f32::MIN_POSITIVE / 2.0], 1), None);
    assert!(exponential(&[0.0; 3], 3).is_some());
}

#[test]
fn triangles_are_the_same_but_turned() {
    let mut random = Random(4);
    let indices: Vec<u32> = (0..3000).map(|_| random.next() % 700).collect();
    let (fast, old) = fast_order(&indices, 700).unwrap();
    let turned = |t: &[u32]| {
        let least = (0..3).min_by_key(|&i| t[i]).unwrap();
        [t[least], t[(least + 1) % 3], t[(least + 2) % 3]]
    };
    let set = |all: &[u32]| {
        let mut all: Vec<[u32; 3]> = all.chunks(3).map(turned).collect();
        all.sort_unstable();
        all
    };
    let named: Vec<u32> = fast.iter().map(|&i| old[i as usize]).collect();
    assert_eq!(set(&named), set(&indices));
    let coded = encode_triangles(&fast).unwrap();
    for stride in [2, 4] {
        let layout = Layout {
            mode: Mode::Triangles,
            filter: Filter::None,
            stride,
            count: fast.len(),
        };
        let back = decode(&coded, layout).unwrap();
        let back: Vec<u32> = match stride {
            2 => back
                .as_chunks()
                .0
                .iter()
                .map(|b| u16::from_le_bytes(*b).into())
                .collect(),
            _ => back
                .as_chunks()
                .0
                .iter()
                .map(|b| u32::from_le_bytes(*b))
                .collect(),
        };
        assert_eq!(set(&back), set(&fast));
    }
}

/// Whatever is there and whatever it is said to be: an answer or a refusal.
#[test]
fn broken_bytes_are_refused_or_answered() {
    let mut random = Random(5);
    let sound = encode(&vec![3; 1200], 12).unwrap();
    let modes = [Mode::Attributes, Mode::Triangles, Mode::Indices];
    let filters = [
        Filter::None,
        Filter::Octahedral,
        Filter::Quaternion,
        Filter::Exponential,
    ];
    let mut refused = 0;
    for _ in 0..3000 {
        let mut bytes = sound.clone();
        bytes.truncate(random.next() as usize % (bytes.len() + 1));
        for _ in 0..random.next() % 4 {
            if let Some(at) = (random.next() as usize).checked_rem(bytes.len()) {
                bytes[at] = random.next() as u8;
            }
        }
        if let Some(first) = bytes.first_mut() {
            *first = [0xa0, 0xe1, 0xd1, *first][random.next() as usize % 4];
        }
        let layout = Layout {
            mode: modes[random.next() as usize % 3],
            filter: filters[random.next() as usize % 4],
            stride: [0, 2, 3, 4, 8, 12, 300][random.next() as usize % 7],
            count: [0, 1, 3, 100, 300, usize::MAX][random.next() as usize % 6],
        };
        match decode(&bytes, layout) {
            Ok(back) => assert_eq!(back.len(), layout.stride * layout.count),
            Err(_) => refused += 1,
        }
    }
    assert!(refused > 1000, "{refused}");
}
