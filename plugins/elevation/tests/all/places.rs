//! Where files say that their samples lie, against what GDAL was told.

use crate::read;
use dolomite_elevation::{Crs, Georeference, Options, Registration, metres_per_degree};

fn place(name: &str) -> (Georeference, [f64; 2]) {
    let map = read(name, &Options::default()).unwrap_or_else(|error| panic!("{error}"));
    let spacing = map.spacing().expect("it has a unit");
    (map.georeference.expect("it has a place"), spacing)
}

#[test]
fn projected_places_are_exact() {
    for name in [
        "i16-gdal-strips.tif",
        "f32-gdal-bigtiff-big-tiles.tif",
        "f32-gdal-cog.tif",
    ] {
        let (place, spacing) = place(name);
        // Half a sample from the corner.
        assert_eq!(
            place.first,
            [412_340.0 + 15.0, 5_123_460.0 - 12.5],
            "{name}"
        );
        assert_eq!((place.step, spacing), ([30.0, 25.0], [30.0, 25.0]));
        assert_eq!(place.registration, Registration::Area);
        let Crs::Projected {
            epsg,
            unit,
            mercator,
            ..
        } = place.crs
        else {
            panic!("{:?}", place.crs);
        };
        assert_eq!((epsg, unit, mercator), (Some(32_633), 1.0, false));
        assert_eq!(
            place.middle([41, 37]),
            [412_340.0 + 615.0, 5_123_460.0 - 462.5]
        );
    }
}

#[test]
fn degrees_become_metres_at_the_maps_latitude() {
    for (name, registration, half) in [
        (
            "i16-gdal-degrees-area.tif",
            Registration::Area,
            0.5 / 1200.0,
        ),
        (
            "i16-gdal-degrees-point.tif",
            Registration::Point,
            0.5 / 1200.0,
        ),
        ("i16-gdal.asc", Registration::Area, 0.5 / 1200.0),
    ] {
        let (place, spacing) = place(name);
        assert_eq!(place.registration, registration, "{name}");
        let wanted = [15.25 + half, 46.5 - half];
        // A GeoTIFF rounds to f64; GDAL writes twelve decimals in ASCII.
        for (found, wanted) in place.first.into_iter().zip(wanted) {
            assert!((found - wanted).abs() < 1e-10, "{name}: {found} {wanted}");
        }
        let middle = 46.5 - 18.5 / 1200.0;
        let metres = metres_per_degree(middle).map(|m| m / 1200.0);
        for (found, wanted) in spacing.into_iter().zip(metres) {
            assert!(
                (found / wanted - 1.0).abs() < 1e-8,
                "{name}: {found} {wanted}"
            );
        }
    }
}

#[test]
fn feet_and_mercator_are_metres_of_the_ground() {
    let (_, spacing) = place("i16-gdal-feet.tif");
    let foot = 1200.0 / 3937.0;
    assert!((spacing[0] - 100.0 * foot).abs() < 1e-12, "{spacing:?}");
    // 46.48° N: y = R asinh(tan φ).
    let (place, spacing) = place("i16-gdal-mercator.tif");
    let y = place.middle([41, 37])[1] / 6_378_137.0;
    #[expect(clippy::disallowed_methods, reason = "an oracle in f64")]
    let shrink = 1.0 / y.cosh();
    assert!(
        (spacing[0] / (38.2 * shrink) - 1.0).abs() < 1e-12,
        "{spacing:?}"
    );
    assert!(shrink < 0.7);
}

#[test]
fn a_prj_beside_an_ascii_grid_counts() {
    let (place, _) = place("f32-gdal.asc");
    assert!(
        matches!(place.crs, Crs::Projected { unit: 1.0, .. }),
        "{:?}",
        place.crs
    );
    assert_eq!(place.first, [412_355.0, 5_123_447.5]);
    assert_eq!(place.step, [30.0, 25.0]);
}
