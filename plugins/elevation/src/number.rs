//! Numbers as people and programs write them.

/// The longest word that is a number: far more than the digits of any f64.
pub(crate) const LONGEST: usize = 64;

/// A number as C reads it; some write a comma for the point, and what is no number as Microsoft's C did.
pub(crate) fn number(word: &[u8]) -> Option<f64> {
    if word.len() > LONGEST {
        return None;
    }
    let text = std::str::from_utf8(word).ok()?;
    if let Ok(number) = text.parse() {
        return Some(number);
    }
    let size = text.strip_prefix(['+', '-']).unwrap_or(text);
    let is = |begin: &str| {
        let head = size.get(..begin.len());
        head.is_some_and(|head| head.eq_ignore_ascii_case(begin))
    };
    if is("1.#INF") {
        let sign = if text.starts_with('-') { -1.0 } else { 1.0 };
        return Some(sign * f64::INFINITY);
    }
    if ["1.#QNAN", "1.#SNAN", "1.#IND", "nan("].into_iter().any(is) {
        return Some(f64::NAN);
    }
    // Fortran's double precision.
    let plain = text.replace(',', ".").replace(['d', 'D'], "e");
    let begins = size.starts_with(|c: char| c.is_ascii_digit() || c == '.' || c == ',');
    begins.then(|| plain.parse().ok())?
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn numbers_as_people_write_them() {
        for (text, wanted) in [
            ("5", 5.0),
            ("+5", 5.0),
            ("-.5", -0.5),
            ("5.", 5.0),
            ("1e3", 1000.0),
            ("1.5E+03", 1500.0),
            ("-1,5", -1.5),
            ("1.5D+03", 1500.0),
            ("-3.4028234663852886e+38", -3.402_823_466_385_288_6e38),
            ("inf", f64::INFINITY),
            ("-1.#INF00", f64::NEG_INFINITY),
        ] {
            assert_eq!(number(text.as_bytes()), Some(wanted), "{text}");
        }
        for text in ["nan", "NaN", "-nan", "1.#QNAN", "-1.#IND", "nan(0x8)"] {
            let number = number(text.as_bytes());
            assert!(number.is_some_and(f64::is_nan), "{text}");
        }
        for text in [
            "", "+", "++5", "+-5", "5m", "1.2.3", "1.234,5", "four", "0x10", "-", "d5", "e5",
        ] {
            assert_eq!(number(text.as_bytes()), None, "{text}");
        }
    }
}
