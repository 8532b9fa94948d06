//! Bytes of files as text, whatever they are: names and properties alike.

/// Text with what is none as `\xHH`; a backslash is two then, so that nothing looks like another.
pub(super) fn escaped(bytes: &[u8]) -> String {
    if let Ok(text) = std::str::from_utf8(bytes) {
        return text.to_owned();
    }
    let mut out = String::new();
    for chunk in bytes.utf8_chunks() {
        out += &chunk.valid().replace('\\', "\\\\");
        for byte in chunk.invalid() {
            out += &format!("\\x{byte:02X}");
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn bytes_that_are_no_text_stay_apart() {
        let names: [&[u8]; 4] = [b"\x95\xe0", b"\x91\x96", b"\\x95\xe0", b"\x83\\"];
        let all: BTreeSet<String> = names.iter().map(|name| escaped(name)).collect();
        assert_eq!(all.len(), 4);
        assert_eq!(escaped(b"a\x83\\b"), "a\\x83\\\\b");
        assert_eq!(escaped("a\\\u{6b69}".as_bytes()), "a\\\u{6b69}");
    }
}
