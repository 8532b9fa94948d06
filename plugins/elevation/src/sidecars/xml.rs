//! Elements of XML and the text within them, so far as a file beside a map has them.

use super::Wrong;
use crate::number::number;
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

/// Elements within each other at most; those of GDAL are five.
const DEEPEST: usize = 64;

/// An element, and what it says.
#[derive(Debug, Default)]
pub(super) struct Element {
    pub name: String,
    /// Its `band` or `key`.
    pub key: String,
    /// Whether it has a domain: metadata of others.
    pub domain: bool,
    /// The bytes of its number, the least first.
    hex: String,
    pub text: String,
}

impl Element {
    fn new(start: &BytesStart<'_>) -> Result<Self, String> {
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let mut element = Self {
            name: text(start.name().as_ref()),
            ..Self::default()
        };
        let mut attributes = start.attributes();
        // That no two have one name takes the square of their number to find.
        attributes.with_checks(false);
        for attribute in attributes {
            let attribute = attribute.map_err(|error| error.to_string())?;
            let value = text(&attribute.value);
            match attribute.key.as_ref() {
                b"band" | b"key" => element.key = value,
                b"domain" => element.domain = !value.is_empty(),
                b"le_hex_equiv" => element.hex = value,
                _ => {}
            }
        }
        Ok(element)
    }

    /// The number that it holds, to the bit where it says its bytes.
    pub fn number(&self, place: &str) -> Result<f64, Wrong> {
        let text = self.text.trim();
        let bits = Some(&self.hex).filter(|hex| hex.len() == 16);
        let bits = bits.and_then(|hex| u64::from_str_radix(hex, 16).ok());
        let exact = bits.map(|bits| f64::from_bits(bits.swap_bytes()));
        exact
            .or_else(|| number(text.as_bytes()))
            .ok_or_else(|| wrong(place, format!("{:?} is not a number", start_of(text))))
    }
}

pub(super) fn wrong(place: impl Into<String>, reason: impl Into<String>) -> Wrong {
    Wrong {
        place: place.into(),
        reason: reason.into(),
    }
}

/// As much of a text as an error shows.
pub(super) fn start_of(text: &str) -> String {
    text.chars().take(40).collect()
}

/// Hands on each element once it is closed, after those that it is in.
///
/// # Errors
/// What is not well-formed, and what `take` returns.
pub(super) fn elements(
    bytes: &[u8],
    take: &mut dyn FnMut(&[Element], &Element) -> Result<(), Wrong>,
) -> Result<(), Wrong> {
    let text = std::str::from_utf8(bytes)
        .map_err(|error| wrong(format!("byte {}", error.valid_up_to()), "it is not UTF-8"))?;
    let mut reader = Reader::from_str(text);
    reader.config_mut().expand_empty_elements = true;
    let mut open: Vec<Element> = Vec::new();
    let mut roots = 0;
    loop {
        let at = reader.buffer_position();
        let here = |reason: String| wrong(format!("byte {at}"), reason);
        let event = reader.read_event();
        match event.map_err(|error| here(error.to_string()))? {
            Event::Start(start) => {
                roots += usize::from(open.is_empty());
                if roots > 1 {
                    return Err(here("a second root".to_owned()));
                }
                if open.len() == DEEPEST {
                    return Err(here(format!("{DEEPEST} elements within each other")));
                }
                open.push(Element::new(&start).map_err(here)?);
            }
            Event::End(_) => {
                if let Some(element) = open.pop() {
                    take(&open, &element)?;
                }
            }
            Event::Text(part) => {
                let part = part.decode().map_err(|error| here(error.to_string()))?;
                add(&mut open, &part).map_err(here)?;
            }
            Event::CData(part) => {
                let part = part.decode().map_err(|error| here(error.to_string()))?;
                add(&mut open, &part).map_err(here)?;
            }
            Event::GeneralRef(name) => {
                let letter = name.resolve_char_ref();
                let letter = letter.map_err(|error| here(error.to_string()))?;
                let letter = letter.or(match &*name {
                    b"lt" => Some('<'),
                    b"gt" => Some('>'),
                    b"amp" => Some('&'),
                    b"apos" => Some('\''),
                    b"quot" => Some('"'),
                    _ => None,
                });
                let unknown = || here("an entity without a meaning".to_owned());
                let letter = letter.ok_or_else(unknown)?;
                add(&mut open, letter.encode_utf8(&mut [0; 4])).map_err(here)?;
            }
            Event::Eof => break,
            _ => {}
        }
    }
    let end = || format!("byte {}", bytes.len());
    if let Some(element) = open.last() {
        return Err(wrong(end(), format!("it ends within <{}>", element.name)));
    }
    if roots == 0 {
        return Err(wrong(end(), "it ends before anything stands in it"));
    }
    Ok(())
}

/// Puts text into the innermost element.
fn add(open: &mut [Element], text: &str) -> Result<(), String> {
    match open.last_mut() {
        Some(element) => element.text.push_str(text),
        None if text.trim_start_matches('\u{feff}').trim().is_empty() => {}
        None => return Err("text outside of its root".to_owned()),
    }
    Ok(())
}
