//! World files: six numbers, a line each, that tell where the samples of a map lie.

use super::Wrong;
use crate::number::number;

/// Bytes of one at most: six numbers of 64 digits are 400.
pub(super) const MOST: u64 = 1 << 12;

/// What its lines are called, in their order.
const NAMES: [&str; 6] = [
    "steps along x (A)",
    "rotation (D)",
    "rotation (B)",
    "steps along y (E)",
    "x of the first sample (C)",
    "y of the first sample (F)",
];

/// x and y of a column and row, counted from the centre of the upper left sample: `[C, A, B]` and `[F, D, E]`.
pub(super) fn read(bytes: &[u8]) -> Result<[[f64; 3]; 2], Wrong> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    // Zeros and the mark of DOS for the end of a text stand behind some.
    let blank = |byte: &u8| byte.is_ascii_whitespace() || matches!(byte, 0 | 0x1a);
    let mut words = bytes.split(blank).filter(|word| !word.is_empty());
    let mut numbers = [0.0; 6];
    for ((k, to), name) in numbers.iter_mut().enumerate().zip(NAMES) {
        let wrong = |reason: String| Wrong {
            place: format!("number {}, {name}", k + 1),
            reason,
        };
        let word = words.next();
        let word = word.ok_or_else(|| wrong("it is missing".to_owned()))?;
        let read = number(word).filter(|number| number.is_finite());
        *to = read.ok_or_else(|| {
            let shown: String = word.escape_ascii().to_string().chars().take(40).collect();
            wrong(format!("{shown:?} is not a number"))
        })?;
    }
    let [a, d, b, e, c, f] = numbers;
    Ok([[c, a, b], [f, d, e]])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn six_numbers_in_their_order() {
        let wanted = [[500.5, 30.0, 0.0], [4000.25, 0.0, -25.0]];
        for text in [
            "30\n0\n0\n-25\n500.5\n4000.25",
            "  30.0000\r\n0.0\r\n-0.0\r\n-25.0\r\n500.5\r\n4000.25\r\n\x1a",
            "\u{feff}3E1\n0\n0\n-2,5e1\n500,5\n4000.25\nwhat follows does not count\n",
        ] {
            assert_eq!(
                read(text.as_bytes()).expect("six numbers"),
                wanted,
                "{text}"
            );
        }
        let [x, y] = read(b"1 2 3 4 5 6").expect("six numbers");
        assert_eq!((x, y), ([5.0, 1.0, 3.0], [6.0, 2.0, 4.0]));
    }

    #[test]
    fn what_is_no_world_file_is_refused_with_its_place() {
        for (text, words) in [
            ("", "number 1"),
            ("30\n0\n0\n-25\n500.5\n", "number 6, y of the first sample"),
            ("30\n0\n0\n-25\nfive\n6", "\"five\" is not a number"),
            ("nan\n0\n0\n-25\n5\n6", "number 1, steps along x"),
            ("30\n0\n0\n-inf\n5\n6", "number 4"),
            ("\u{0}\u{1}\u{2}", "is not a number"),
        ] {
            let Wrong { place, reason } = read(text.as_bytes()).expect_err("not six numbers");
            let said = format!("{place}: {reason}");
            assert!(said.contains(words), "{said}");
        }
    }
}
