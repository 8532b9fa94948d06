//! Coordinate systems: as text names them, and guessed where no text does.

use crate::georeference::{Crs, FOOT, US_FOOT};
use crate::lattice::Lattice;

/// What the numbers of places are that nothing names, and what a note says of it: degrees where all of them lie on the globe, else metres.
pub(crate) fn guessed(lattice: &Lattice, rows: u32) -> (Crs, &'static str) {
    let ([x, north], [dx, dy]) = (lattice.first, lattice.step);
    let [west, north] = [x - 0.5 * dx, north + 0.5 * dy];
    let south = north - f64::from(rows) * dy;
    let on_earth = west.abs() <= 360.0 && south >= -91.0 && north <= 91.0 && dx.max(dy) <= 1.0;
    let name = String::new();
    if on_earth {
        let note =
            "no .prj stands beside it; its places are taken for degrees: they all lie on the globe";
        return (Crs::Degrees { epsg: None, name }, note);
    }
    let plane = Crs::Projected {
        epsg: None,
        name,
        unit: 1.0,
        mercator: false,
    };
    let note = "no .prj stands beside it; its places are taken for metres: they do not lie on a globe in degrees";
    (plane, note)
}

/// The coordinate system of well-known text, or of ESRI's old keys and values (`.prj`).
pub(crate) fn by_text(text: &str) -> Option<Crs> {
    // Spaces may stand about brackets and commas.
    let text = text
        .trim_start_matches('\u{feff}')
        .trim()
        .replace(" [", "[");
    let text = text.as_str();
    let upper = text.to_ascii_uppercase();
    let quoted = |text: &str| text.split('"').nth(1).unwrap_or_default().to_owned();
    // A compound system holds the plane, or the globe, before the heights.
    let part = |words: &[&str]| words.iter().filter_map(|word| upper.find(word)).min();
    if let Some(at) = part(&["PROJCS[", "PROJCRS["]) {
        // One that is cut off is none, also where the globe that it stands on is whole.
        let plane = at..at + bracketed(&upper[at..])?;
        let (upper, text) = (&upper[plane.clone()], &text[plane]);
        // The last unit is that of the plane: those before it are of the angles.
        let last = upper.rfind("UNIT[")?;
        let number = upper[last..].split(',').nth(1)?;
        let number = number.split(']').next()?.trim();
        let unit: f64 = number.parse().ok()?;
        let name = quoted(text);
        let mercator = is_mercator(upper)?;
        return (unit > 0.0 && unit.is_finite()).then_some(Crs::Projected {
            epsg: None,
            name,
            unit,
            mercator,
        });
    }
    if let Some(at) = part(&["GEOGCS[", "GEOGCRS[", "GEODCRS["]) {
        let globe = at..at + bracketed(&upper[at..])?;
        return Some(Crs::Degrees {
            epsg: None,
            name: quoted(&text[globe]),
        });
    }
    // PROJECTION GEOGRAPHIC, UNITS DD
    let value = |key: &str| {
        let line = upper
            .lines()
            .find(|line| line.split_whitespace().next() == Some(key))?;
        line.split_whitespace().nth(1).map(str::to_owned)
    };
    let name = value("PROJECTION")?;
    if name == "GEOGRAPHIC" {
        // Seconds and minutes (DS, DM) are other lengths.
        if value("UNITS").is_some_and(|units| units != "DD") {
            return None;
        }
        return Some(Crs::Degrees {
            epsg: None,
            name: String::new(),
        });
    }
    let unit = match value("UNITS")?.as_str() {
        "METERS" | "METRES" | "METER" | "METRE" => 1.0,
        "FEET" => US_FOOT,
        "INTERNATIONAL_FEET" | "FT" => FOOT,
        _ => return None,
    };
    Some(Crs::Projected {
        epsg: None,
        name,
        unit,
        mercator: false,
    })
}

/// Whether a metre of the map is shorter on the ground the farther it is from the equator, where it is one. `None`: it is one elsewhere.
fn is_mercator(upper: &str) -> Option<bool> {
    if upper.contains("MERCATOR_AUXILIARY_SPHERE") || upper.contains("PSEUDO") {
        return Some(true);
    }
    let after = |words: &[&str]| {
        let mut rest = words.iter().filter_map(|word| upper.split_once(word));
        rest.next().map(|(_, rest)| rest)
    };
    let method = after(&["PROJECTION[\"", "METHOD[\""]).and_then(|rest| rest.split('"').next());
    match method {
        Some("MERCATOR_1SP" | "MERCATOR (VARIANT A)") => Some(true),
        Some("MERCATOR" | "MERCATOR_2SP" | "MERCATOR (VARIANT B)") => {
            let names = [
                "\"STANDARD_PARALLEL_1\",",
                "\"LATITUDE OF 1ST STANDARD PARALLEL\",",
            ];
            let Some(rest) = after(&names) else {
                return Some(true);
            };
            let parallel: f64 = rest.split([',', ']']).next()?.trim().parse().ok()?;
            (parallel == 0.0).then_some(true)
        }
        _ => Some(false),
    }
}

/// Bytes to the bracket that closes the first one, itself too; brackets in quotes do not count.
fn bracketed(text: &str) -> Option<usize> {
    let (mut depth, mut quoted) = (0_usize, false);
    for (at, byte) in text.bytes().enumerate() {
        match byte {
            b'"' => quoted = !quoted,
            b'[' if !quoted => depth += 1,
            b']' if !quoted => {
                depth = depth.checked_sub(1)?;
                if depth == 0 {
                    return Some(at + 1);
                }
            }
            _ => {}
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::georeference::Registration;

    #[test]
    fn places_without_a_name_are_degrees_where_they_can_be() {
        let at = |first, step| Lattice {
            first,
            step: [step; 2],
            registration: Registration::Area,
        };
        for (lattice, degrees) in [
            (at([15.0, 46.0], 0.01), true),
            (at([-179.5, 89.5], 1.0), true),
            (at([15.0, 46.0], 2.0), false),
            (at([15.0, 92.0], 0.01), false),
            (at([412_355.0, 5_123_447.5], 30.0), false),
        ] {
            let (crs, note) = guessed(&lattice, 100);
            assert_eq!(matches!(crs, Crs::Degrees { .. }), degrees, "{lattice:?}");
            assert_eq!(note.contains("degrees: they all"), degrees, "{note}");
        }
    }

    #[test]
    fn lengths_of_a_cylinder_that_grow_with_the_latitude() {
        let of = |projection: &str| {
            format!("PROJCS[\"x\",GEOGCS[\"y\"],PROJECTION[\"{projection}],UNIT[\"metre\",1]]")
        };
        let parallel = |degrees: &str| {
            format!("Mercator\"],PARAMETER[\"Standard_Parallel_1\",{degrees}]")
                .trim_end_matches(']')
                .to_owned()
        };
        for (projection, wanted) in [
            ("Mercator_1SP\"".to_owned(), Some(true)),
            ("Mercator_Auxiliary_Sphere\"".to_owned(), Some(true)),
            ("Mercator_2SP\"".to_owned(), Some(true)),
            (parallel("0.0"), Some(true)),
            // Its unit is one at another latitude.
            (parallel("42.0"), None),
            ("Transverse_Mercator\"".to_owned(), Some(false)),
            ("Hotine_Oblique_Mercator\"".to_owned(), Some(false)),
        ] {
            let mercator = by_text(&of(&projection)).map(|crs| match crs {
                Crs::Projected { mercator, .. } => mercator,
                other => panic!("{other:?}"),
            });
            assert_eq!(mercator, wanted, "{projection}");
        }
        // What is cut off within its brackets is none.
        let whole = of("Mercator_1SP\"");
        for length in 0..whole.len() {
            assert_eq!(by_text(&whole[..length]), None, "{length}");
        }
    }
}
