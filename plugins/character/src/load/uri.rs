//! Where buffers lie: in the file, in a `data:` URI, or below the file's own folder.

use super::LoadError;
use gltf::buffer::Source;

/// All buffers of a file.
pub(super) fn buffers(
    document: &gltf::Document,
    mut blob: Option<Vec<u8>>,
    mut read: impl FnMut(&str) -> std::io::Result<Vec<u8>>,
) -> Result<Vec<Vec<u8>>, LoadError> {
    document
        .buffers()
        .map(|buffer| {
            let refuse = |uri: &str, reason: String| LoadError::Buffer {
                buffer: buffer.index(),
                uri: uri.chars().take(60).collect(),
                reason,
            };
            let bytes = match buffer.source() {
                Source::Bin => blob
                    .take()
                    .ok_or_else(|| refuse("in the file", "the file has no binary part".into()))?,
                Source::Uri(uri) => {
                    if let Some(data) = uri.strip_prefix("data:") {
                        from_data(data).map_err(|reason| refuse(uri, reason))?
                    } else {
                        let path = unescaped(uri);
                        if leads_out(&path) {
                            return Err(refuse(uri, "it leads out of the file's folder".into()));
                        }
                        read(&path).map_err(|error| refuse(uri, error.to_string()))?
                    }
                }
            };
            if bytes.len() < buffer.length() {
                let reason = format!(
                    "{} bytes are there, {} are needed",
                    bytes.len(),
                    buffer.length()
                );
                return Err(refuse("its end", reason));
            }
            Ok(bytes)
        })
        .collect()
}

/// Whether a path is absolute, has a scheme, or climbs up.
fn leads_out(path: &str) -> bool {
    path.starts_with(['/', '\\'])
        || path.contains(':')
        || path.split(['/', '\\']).any(|part| part == "..")
}

/// `%20` and its like, as RFC 3986 has them; what is no such sequence stays.
fn unescaped(uri: &str) -> String {
    let bytes = uri.as_bytes();
    let mut out = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while at < bytes.len() {
        let code = bytes
            .get(at + 1..at + 3)
            .filter(|_| bytes[at] == b'%')
            .and_then(|digits| std::str::from_utf8(digits).ok())
            .and_then(|digits| u8::from_str_radix(digits, 16).ok());
        out.push(code.unwrap_or(bytes[at]));
        at += if code.is_some() { 3 } else { 1 };
    }
    String::from_utf8_lossy(&out).into_owned()
}

/// What follows `data:`, base64 alone.
fn from_data(data: &str) -> Result<Vec<u8>, String> {
    let (_, text) = data
        .split_once(";base64,")
        .ok_or("a data URI without base64 is not supported")?;
    let mut out = Vec::with_capacity(text.len() / 4 * 3);
    let (mut bits, mut held) = (0_u32, 0_u32);
    for letter in text.trim_end_matches('=').bytes() {
        let value = match letter {
            b'A'..=b'Z' => letter - b'A',
            b'a'..=b'z' => letter - b'a' + 26,
            b'0'..=b'9' => letter - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return Err(format!("byte {letter} is not base64")),
        };
        bits = (bits << 6) | u32::from(value);
        held += 6;
        if held >= 8 {
            held -= 8;
            out.push((bits >> held) as u8);
            bits &= (1 << held) - 1;
        }
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_of_known_words() {
        for (text, bytes) in [("TWFu", "Man"), ("TWE=", "Ma"), ("TQ==", "M"), ("", "")] {
            let data = format!("application/octet-stream;base64,{text}");
            assert_eq!(from_data(&data).unwrap(), bytes.as_bytes());
        }
        assert!(from_data(";base64,T!").is_err());
        assert!(from_data("text/plain,abc").is_err());
    }

    #[test]
    fn paths_stay_below_the_folder() {
        for bad in [
            "/etc/passwd",
            "../a.bin",
            "a/../../b",
            "http://x/y",
            "c:\\x",
            "\\x",
        ] {
            assert!(leads_out(bad), "{bad}");
        }
        assert!(!leads_out("textures/a..b.bin"));
        assert_eq!(unescaped("a%20b%2"), "a b%2");
    }
}
