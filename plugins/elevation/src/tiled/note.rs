//! What a file said of itself, as bytes: numbers as they are, so that a place comes back to the bit.

use crate::about::{About, FileKind, NumberType, Text64};
use crate::georeference::{Crs, Georeference, Registration};

/// Longest text that is taken.
const MOST_TEXT: usize = 1 << 11;
/// Most notes and numbers for no data that are kept.
const MOST: usize = 8;

#[derive(Default)]
struct Writer(Vec<u8>);

impl Writer {
    fn word(&mut self, word: u64) {
        self.0.extend(word.to_le_bytes());
    }

    fn real(&mut self, real: f64) {
        self.word(real.to_bits());
    }

    fn text(&mut self, text: &str) {
        let mut end = text.len().min(MOST_TEXT);
        while !text.is_char_boundary(end) {
            end -= 1;
        }
        self.word(end as u64);
        self.0.extend(&text.as_bytes()[..end]);
    }

    /// Whether it is there, and if so what it is.
    fn some<T>(&mut self, value: Option<T>, write: impl FnOnce(&mut Self, T)) {
        self.word(u64::from(value.is_some()));
        if let Some(value) = value {
            write(self, value);
        }
    }
}

struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn word(&mut self) -> Option<u64> {
        let (word, rest) = self.0.split_first_chunk::<8>()?;
        self.0 = rest;
        Some(u64::from_le_bytes(*word))
    }

    fn small(&mut self) -> Option<u32> {
        u32::try_from(self.word()?).ok()
    }

    fn real(&mut self) -> Option<f64> {
        self.word().map(f64::from_bits)
    }

    fn text(&mut self) -> Option<String> {
        let length = usize::try_from(self.word()?).ok()?;
        if length > MOST_TEXT {
            return None;
        }
        let (text, rest) = self.0.split_at_checked(length)?;
        self.0 = rest;
        String::from_utf8(text.to_vec()).ok()
    }

    /// `Some(None)`: it was not there when it was written.
    fn some<T>(&mut self, read: impl FnOnce(&mut Self) -> Option<T>) -> Option<Option<T>> {
        match self.word()? {
            0 => Some(None),
            1 => read(self).map(Some),
            _ => None,
        }
    }
}

const KINDS: [FileKind; 6] = [
    FileKind::Raw,
    FileKind::Hgt,
    FileKind::Ascii,
    FileKind::Png,
    FileKind::Tiff,
    FileKind::BigTiff,
];

const NUMBERS: [NumberType; 12] = [
    NumberType::U8,
    NumberType::I8,
    NumberType::U16,
    NumberType::I16,
    NumberType::U32,
    NumberType::I32,
    NumberType::U64,
    NumberType::I64,
    NumberType::F16,
    NumberType::F32,
    NumberType::F64,
    NumberType::Text,
];

fn place(to: &mut Writer, place: &Georeference) {
    match &place.crs {
        Crs::Degrees { epsg, name } => {
            to.word(0);
            to.some(*epsg, |to, code| to.word(code.into()));
            to.text(name);
        }
        Crs::Projected {
            epsg,
            name,
            unit,
            mercator,
        } => {
            to.word(1);
            to.some(*epsg, |to, code| to.word(code.into()));
            to.text(name);
            to.real(*unit);
            to.word((*mercator).into());
        }
        Crs::Unknown => to.word(2),
    }
    for number in place.first.iter().chain(&place.step) {
        to.real(*number);
    }
    to.word((place.registration == Registration::Area).into());
}

fn placed(from: &mut Reader<'_>) -> Option<Georeference> {
    let crs = match from.word()? {
        0 => Crs::Degrees {
            epsg: from.some(Reader::small)?,
            name: from.text()?,
        },
        1 => Crs::Projected {
            epsg: from.some(Reader::small)?,
            name: from.text()?,
            unit: from.real()?,
            mercator: from.word()? == 1,
        },
        2 => Crs::Unknown,
        _ => return None,
    };
    Some(Georeference {
        crs,
        first: [from.real()?, from.real()?],
        step: [from.real()?, from.real()?],
        registration: match from.word()? {
            0 => Registration::Point,
            1 => Registration::Area,
            _ => return None,
        },
    })
}

/// The bytes of what a file says. Its name is left out: it may be moved with its tiles.
pub(super) fn encode(about: &About) -> Vec<u8> {
    let mut to = Writer::default();
    let kind = KINDS.iter().position(|kind| *kind == about.kind);
    to.word(kind.unwrap_or(0) as u64);
    let number = NUMBERS.iter().position(|number| *number == about.number);
    to.word(number.unwrap_or(0) as u64);
    to.word(about.size[0].into());
    to.word(about.size[1].into());
    to.text(&about.packing);
    to.word(about.bands.into());
    to.word(about.nodata.len().min(MOST) as u64);
    for Text64(number) in about.nodata.iter().take(MOST) {
        to.real(*number);
    }
    to.real(about.scale);
    to.real(about.offset);
    to.some(about.unit_metres, Writer::real);
    to.some(about.georeference.as_ref(), place);
    to.word(about.holes);
    to.some(about.range, |to, range| {
        for end in range {
            to.word(end.to_bits().into());
        }
    });
    to.word(about.notes.len().min(MOST) as u64);
    for note in about.notes.iter().take(MOST) {
        to.text(note);
    }
    to.0
}

/// What [`encode`] wrote, of a file of this name. `None`: they are other bytes.
pub(super) fn decode(bytes: &[u8], file: &str) -> Option<About> {
    let mut from = Reader(bytes);
    let kind = *KINDS.get(from.word()? as usize)?;
    let number = *NUMBERS.get(from.word()? as usize)?;
    let size = [from.small()?, from.small()?];
    let packing = from.text()?;
    let bands = from.small()?;
    let count = (from.word()? as usize).min(MOST);
    let nodata: Option<Vec<_>> = (0..count).map(|_| from.real().map(Text64)).collect();
    let about = About {
        file: file.to_owned(),
        kind,
        size,
        number,
        packing,
        bands,
        nodata: nodata?,
        scale: from.real()?,
        offset: from.real()?,
        unit_metres: from.some(Reader::real)?,
        georeference: from.some(placed)?,
        holes: from.word()?,
        range: from.some(|from| {
            let ends = [from.small()?, from.small()?];
            Some(ends.map(f32::from_bits))
        })?,
        notes: {
            let count = (from.word()? as usize).min(MOST);
            let notes: Option<Vec<_>> = (0..count).map(|_| from.text()).collect();
            notes?
        },
    };
    from.0.is_empty().then_some(about)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_file_says_comes_back_to_the_bit_and_nothing_else_is_taken() {
        let mut about = About {
            file: "alps.tif".to_owned(),
            kind: FileKind::BigTiff,
            size: [65_536, 9],
            number: NumberType::F64,
            packing: "deflate, tiles".to_owned(),
            bands: 2,
            nodata: vec![Text64(-9999.0), Text64(0.1)],
            scale: 0.1,
            offset: -0.3,
            unit_metres: Some(1200.0 / 3937.0),
            georeference: Some(Georeference {
                crs: Crs::Projected {
                    epsg: Some(2056),
                    name: "Schweiz é".to_owned(),
                    unit: 1.0,
                    mercator: true,
                },
                first: [2_600_000.1, 1_200_000.7],
                step: [0.1, 1.0 / 3.0],
                registration: Registration::Area,
            }),
            holes: 7,
            range: Some([-0.1, 4810.3]),
            notes: vec!["one".to_owned(), String::new()],
        };
        for crs in [
            Crs::Unknown,
            Crs::Degrees {
                epsg: None,
                name: String::new(),
            },
        ] {
            let bytes = encode(&about);
            assert_eq!(decode(&bytes, "alps.tif").as_ref(), Some(&about));
            for length in 0..bytes.len() {
                assert_eq!(decode(&bytes[..length], "alps.tif"), None, "{length}");
            }
            let longer: Vec<u8> = bytes.iter().copied().chain([0]).collect();
            assert_eq!(decode(&longer, "alps.tif"), None);
            if let Some(place) = &mut about.georeference {
                place.crs = crs;
            }
        }
        (about.georeference, about.range, about.unit_metres) = (None, None, None);
        assert_eq!(decode(&encode(&about), "alps.tif"), Some(about));
    }
}
