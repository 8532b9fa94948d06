//! What GDAL keeps beside a file that cannot hold it (`NAME.EXT.aux.xml`, its persistent auxiliary metadata): place, no data,
//! scale and unit. Statistics, histograms, colours and what other programs put there change nothing.

use super::Wrong;
use super::xml::{Element, elements, start_of, wrong};
use crate::georeference::{Registration, unit_by_name};
use crate::number::number;
use std::collections::BTreeMap;

/// Bytes of one at most: tables of classes are the longest that it holds.
pub(super) const MOST: u64 = 1 << 22;

/// What it says.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Pam {
    /// x and y of a column and row, counted from the north-western corner of the first sample: each from (0, 0), a column's step, a row's.
    pub transform: Option<[[f64; 3]; 2]>,
    /// Coordinate system as well-known text.
    pub srs: Option<String>,
    /// Points that tie it to the ground.
    pub points: usize,
    pub registration: Option<Registration>,
    bands: BTreeMap<u32, Band>,
    /// Its root, where it is not GDAL's.
    pub stranger: Option<String>,
}

/// What it says of a band.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Band {
    pub nodata: Option<f64>,
    pub scale: Option<f64>,
    pub offset: Option<f64>,
    /// Metres a unit of height.
    pub unit: Option<f64>,
}

impl Pam {
    /// What the bytes of one say.
    pub fn read(bytes: &[u8]) -> Result<Self, Wrong> {
        let mut pam = Self::default();
        elements(bytes, &mut |around, element| pam.take(around, element))?;
        Ok(pam)
    }

    /// Takes what an element says, once it is closed.
    fn take(&mut self, around: &[Element], element: &Element) -> Result<(), Wrong> {
        let names: Vec<&str> = around.iter().map(|element| &*element.name).collect();
        let text = element.text.trim();
        match (&names[..], &*element.name) {
            ([], "PAMDataset") => {}
            ([], other) => self.stranger = Some(start_of(other)),
            (["PAMDataset"], "SRS") if !text.is_empty() => self.srs = Some(text.to_owned()),
            (["PAMDataset"], "GeoTransform") if !text.is_empty() => {
                self.transform =
                    transform(text).map_err(|reason| wrong("<GeoTransform>", reason))?;
            }
            (["PAMDataset", "GCPList"], "GCP") => self.points += 1,
            (["PAMDataset", "Metadata"], "MDI") => {
                let domain = around.last().is_some_and(|metadata| metadata.domain);
                if element.key == "AREA_OR_POINT" && !domain {
                    self.registration = match text.to_ascii_lowercase().as_str() {
                        "point" => Some(Registration::Point),
                        "area" => Some(Registration::Area),
                        _ => None,
                    };
                }
            }
            (["PAMDataset", "PAMRasterBand"], "NoDataValue" | "Scale" | "Offset" | "UnitType")
                if !text.is_empty() =>
            {
                let band = around.last().map_or("", |band| &*band.key);
                self.take_of_band(band, element)?;
            }
            _ => {}
        }
        Ok(())
    }

    fn take_of_band(&mut self, band: &str, element: &Element) -> Result<(), Wrong> {
        let number = band.trim().parse::<u32>();
        let number = number.map_err(|_| {
            wrong(
                "<PAMRasterBand>",
                format!("{:?} is no band", start_of(band)),
            )
        })?;
        let place = format!("<{}> of band {number}", element.name);
        let finite = || match element.number(&place) {
            Ok(number) if !number.is_finite() => Err(wrong(&*place, "it is not finite")),
            number => number,
        };
        let known = self.bands.get(&number).copied().unwrap_or_default();
        let band = match &*element.name {
            "NoDataValue" => Band {
                nodata: Some(element.number(&place)?),
                ..known
            },
            "Scale" => {
                let scale = finite()?;
                if scale == 0.0 {
                    return Err(wrong(&*place, "with 0 all heights would be one"));
                }
                Band {
                    scale: Some(scale),
                    ..known
                }
            }
            "Offset" => Band {
                offset: Some(finite()?),
                ..known
            },
            _ => Band {
                unit: unit_by_name(element.text.trim()),
                ..known
            },
        };
        if band != Band::default() {
            self.bands.insert(number, band);
        }
        Ok(())
    }

    /// What it says of a band, from 1.
    pub fn band(&self, band: u32) -> Band {
        self.bands.get(&band).copied().unwrap_or_default()
    }

    /// Whether nothing that it says counts.
    pub fn is_silent(&self) -> bool {
        let Self {
            transform,
            srs,
            points,
            registration,
            bands,
            stranger: _,
        } = self;
        transform.is_none()
            && srs.is_none()
            && *points == 0
            && registration.is_none()
            && bands.is_empty()
    }
}

/// Six numbers in GDAL's order; `None` where they say that there is no place: columns and rows as they are.
fn transform(text: &str) -> Result<Option<[[f64; 3]; 2]>, String> {
    let words = text.split(|c: char| c == ',' || c.is_whitespace());
    let words = words.filter(|word| !word.is_empty());
    let mut numbers = Vec::new();
    for word in words {
        let read = number(word.as_bytes()).filter(|number| number.is_finite());
        let wrong = || format!("{:?} is not a number", start_of(word));
        numbers.push(read.ok_or_else(wrong)?);
    }
    let [x0, xc, xr, y0, yc, yr] = numbers[..] else {
        return Err(format!("it has {} numbers, not 6", numbers.len()));
    };
    let numbers = [[x0, xc, xr], [y0, yc, yr]];
    Ok((numbers != [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]).then_some(numbers))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Pam {
        Pam::read(text.as_bytes())
            .unwrap_or_else(|Wrong { place, reason }| panic!("{place}: {reason}"))
    }

    /// As GDAL writes it.
    const WHOLE: &str = r#"<PAMDataset>
  <SRS dataAxisToSRSAxisMapping="1,2">PROJCS["a &amp; b",UNIT["metre",1]]</SRS>
  <GeoTransform>  4.1234000000000000e+05,  3.0000000000000000e+01,  0.0000000000000000e+00,  5.1234600000000000e+06,  0.0000000000000000e+00, -2.5000000000000000e+01</GeoTransform>
  <Metadata>
    <MDI key="AREA_OR_POINT">Point</MDI>
  </Metadata>
  <PAMRasterBand band="1">
    <Description>elevation</Description>
    <NoDataValue>-9.99900000000000E+03</NoDataValue>
    <UnitType>ft</UnitType>
    <Offset>100</Offset>
    <Scale>0.5</Scale>
  </PAMRasterBand>
  <PAMRasterBand band="2">
    <NoDataValue le_hex_equiv="000000E0FFFFEFC7">-3.40282346638529E+38</NoDataValue>
  </PAMRasterBand>
</PAMDataset>
"#;

    const STATISTICS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<!-- by a viewer -->
<PAMDataset>
  <PAMRasterBand band="1">
    <Histograms><HistItem><HistMin>1</HistMin><HistCounts>1|2</HistCounts></HistItem></Histograms>
    <Metadata><MDI key="STATISTICS_MAXIMUM">255</MDI><MDI key="AREA_OR_POINT">Point</MDI></Metadata>
  </PAMRasterBand>
  <Metadata domain="xml:ESRI" format="xml">
    <GeodataXform><NoDataValue>7</NoDataValue><Scale>2</Scale><MDI key="AREA_OR_POINT">Point</MDI></GeodataXform>
  </Metadata>
  <Metadata domain="IMAGE_STRUCTURE"><MDI key="AREA_OR_POINT">Point</MDI></Metadata>
</PAMDataset>"#;

    #[test]
    fn what_gdal_writes() {
        let pam = read(WHOLE);
        assert_eq!(
            pam.srs.as_deref(),
            Some("PROJCS[\"a & b\",UNIT[\"metre\",1]]")
        );
        let wanted = [[412_340.0, 30.0, 0.0], [5_123_460.0, 0.0, -25.0]];
        assert_eq!(pam.transform, Some(wanted));
        assert_eq!(pam.registration, Some(Registration::Point));
        let wanted = Band {
            nodata: Some(-9999.0),
            scale: Some(0.5),
            offset: Some(100.0),
            unit: Some(0.3048),
        };
        assert_eq!(pam.band(1), wanted);
        assert_eq!(pam.band(2).nodata, Some(f64::from(f32::MIN)));
        assert_eq!(pam.band(3), Band::default());
        assert!(!pam.is_silent());
    }

    #[test]
    fn statistics_and_what_others_put_there_say_nothing() {
        assert_eq!(read(STATISTICS), Pam::default());
        assert!(read(STATISTICS).is_silent());
        let empty = "<PAMDataset><SRS/><GeoTransform> </GeoTransform><PAMRasterBand><Scale/></PAMRasterBand></PAMDataset>";
        assert!(read(empty).is_silent());
        // No place at all, as columns and rows themselves.
        let none = "<PAMDataset><GeoTransform>0, 1, 0, 0, 0, 1</GeoTransform></PAMDataset>";
        assert!(read(none).is_silent());
        let other = read("<metadata><PAMDataset><SRS>x</SRS></PAMDataset></metadata>");
        assert!(other.is_silent());
        assert_eq!(other.stranger.as_deref(), Some("metadata"));
    }

    #[test]
    fn text_in_all_its_forms() {
        let srs = |text: &str| read(&format!("<PAMDataset><SRS>{text}</SRS></PAMDataset>")).srs;
        let wanted = Some("a<b>\"c'&é".to_owned());
        assert_eq!(srs("a&lt;b&gt;&quot;c&apos;&amp;é"), wanted);
        assert_eq!(srs("a&#60;b&#x3e;&#34;c&#39;&#38;&#xE9;"), wanted);
        assert_eq!(srs("<![CDATA[a<b>\"c'&é]]>"), wanted);
        assert_eq!(
            srs(" a<!-- in between -->&lt;b<?x y?>>\"c'&amp;é\n"),
            wanted
        );
    }

    #[test]
    fn what_is_damaged_is_refused_with_its_place() {
        let within = |inner: &str| format!("<PAMDataset>{inner}</PAMDataset>");
        let band = |inner: &str| {
            within(&format!(
                "<PAMRasterBand band=\"1\">{inner}</PAMRasterBand>"
            ))
        };
        for (text, words) in [
            (String::new(), "before anything"),
            ("no markup".to_owned(), "outside of its root"),
            ("<PAMDataset>".to_owned(), "within <PAMDataset>"),
            ("<PAMDataset><SRS></PAMDataset>".to_owned(), "byte 17"),
            (within("&nothing;"), "an entity"),
            (within("&#0;"), "byte"),
            (within("& b"), "byte"),
            ("<a/><b/>".to_owned(), "a second root"),
            ("<a>".repeat(70), "64 elements"),
            (within("<GeoTransform>1,2,3</GeoTransform>"), "3 numbers"),
            (
                within("<GeoTransform>1,2,3,4,five,6</GeoTransform>"),
                "\"five\"",
            ),
            (
                within("<GeoTransform>1,2,3,4,nan,6</GeoTransform>"),
                "\"nan\"",
            ),
            (
                band("<NoDataValue>none</NoDataValue>"),
                "<NoDataValue> of band 1: \"none\"",
            ),
            (band("<Scale>0</Scale>"), "<Scale> of band 1"),
            (band("<Scale>inf</Scale>"), "not finite"),
            (band("<Offset>nan</Offset>"), "not finite"),
            (
                within("<PAMRasterBand><Scale>2</Scale></PAMRasterBand>"),
                "no band",
            ),
        ] {
            let Wrong { place, reason } = Pam::read(text.as_bytes()).expect_err(&text);
            let said = format!("{place}: {reason}");
            assert!(said.contains(words), "{text}: {said}");
        }
        let latin = Pam::read(b"<PAMDataset><SRS>\xe9</SRS></PAMDataset>").expect_err("Latin 1");
        assert_eq!(latin.place, "byte 17");
    }

    /// Cut off anywhere within its root it is refused, and no byte that is another makes it panic.
    #[test]
    fn any_cut_and_any_byte() {
        for text in [WHOLE, STATISTICS] {
            let root = text.trim_end().len();
            for cut in 0..root {
                assert!(Pam::read(&text.as_bytes()[..cut]).is_err(), "{cut}");
            }
            for at in 0..text.len() {
                for byte in *b"\0<>&\"/!?-\xff" {
                    let mut bytes = text.as_bytes().to_vec();
                    bytes[at] = byte;
                    let _ = Pam::read(&bytes);
                }
            }
        }
    }
}
