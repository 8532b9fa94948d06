//! The text form: `Name: value, "value", ... { nodes }`, with comments from `;` on.

use super::Values;

/// See [`super::walk`].
pub(super) fn walk<'a>(text: &'a [u8], take: &mut impl FnMut(usize, &'a [u8], Values<'a>)) {
    let mut depth = 0_usize;
    // The node whose values are being read: its depth, its name, and where its values begin.
    let mut open: Option<(usize, &[u8], usize)> = None;
    let mut at = 0;
    let mut close = |open: &mut Option<(usize, &'a [u8], usize)>, end: usize| {
        if let Some((depth, name, begin)) = open.take() {
            take(depth, name, Values::Text(&text[begin..end]));
        }
    };
    while let Some(&byte) = text.get(at) {
        let rest = &text[at..];
        match byte {
            b';' => at += length(rest, |b| b != b'\n'),
            b'"' => at += 2 + length(&rest[1..], |b| b != b'"'),
            b'{' | b'}' => {
                close(&mut open, at);
                depth = match byte {
                    b'{' => depth + 1,
                    _ => depth.saturating_sub(1),
                };
                at += 1;
            }
            _ if is_word(byte) => {
                let word = length(rest, is_word);
                if rest.get(word) == Some(&b':') && !byte.is_ascii_digit() {
                    close(&mut open, at);
                    open = Some((depth, &rest[..word], at + word + 1));
                    at += 1;
                }
                at += word;
            }
            _ => at += 1,
        }
    }
    close(&mut open, text.len());
}

fn is_word(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || b"_|.+-".contains(&byte)
}

fn length(text: &[u8], is: impl Fn(u8) -> bool) -> usize {
    text.iter().position(|&b| !is(b)).unwrap_or(text.len())
}

pub(super) fn last_string(text: &[u8]) -> Option<&[u8]> {
    let end = text.iter().rposition(|&b| b == b'"')?;
    let begin = text[..end].iter().rposition(|&b| b == b'"')? + 1;
    Some(&text[begin..end])
}

pub(super) fn numbers(text: &[u8]) -> Vec<i64> {
    let words = text.split(|b| b.is_ascii_whitespace() || *b == b',');
    words
        .filter_map(|word| std::str::from_utf8(word).ok()?.parse().ok())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_come_in_order_with_their_depth() {
        let text = b"; a: comment {\nOne: 1, \"a } b: {\" ; two: 3\nTwo: *2 {\n\ta: 4,\n5\n}\nThree: T {\n}\n";
        let mut seen = Vec::new();
        walk(text, &mut |depth, name, values| {
            seen.push((
                depth,
                String::from_utf8_lossy(name).into_owned(),
                values.numbers(),
            ));
        });
        let of = |depth, name: &str, numbers: &[i64]| (depth, name.to_owned(), numbers.to_vec());
        assert_eq!(
            seen,
            [
                of(0, "One", &[1, 3]),
                of(0, "Two", &[]),
                of(1, "a", &[4, 5]),
                of(0, "Three", &[]),
            ]
        );
        assert_eq!(
            last_string(b" 12, \"Geometry::x\", \"Mesh\" "),
            Some(b"Mesh".as_slice())
        );
        // A string that does not end.
        walk(b"One: \"abc", &mut |_, _, values| {
            assert_eq!(values.last_string(), None)
        });
    }
}
