//! Lights: what glTF cannot say of colour and intensity in the file's terms is in others, or said.

use crate::support::scene::{converted, link, lost, model, scene};
use dolomite_fbx::Conversion;
use dolomite_fbx::model::Light;

/// A light of a colour and an intensity in per cent, and what else is said of it.
fn made(colour: [f64; 3], intensity: f64, more: &str) -> Conversion {
    let [r, g, b] = colour;
    let objects = model(1, "lamp", "Light", "")
        + &format!(
            "\tNodeAttribute: 2, \"NodeAttribute::lamp\", \"Light\" {{\n\t\tProperties70:  {{\n\
             \t\t\tP: \"Color\", \"Color\", \"\", \"A\",{r},{g},{b}\n\
             \t\t\tP: \"DecayType\", \"enum\", \"\", \"\",2\n\
             \t\t\tP: \"Intensity\", \"Number\", \"\", \"A\",{intensity}\n{more}\t\t}}\n\t}}\n"
        );
    converted(scene(1.0, &objects, &(link(1, 0) + &link(2, 1))).as_bytes())
}

fn light(made: &Conversion) -> ([f32; 3], f32) {
    let Light {
        colour, intensity, ..
    } = &made.model.lights[0];
    (*colour, *intensity)
}

#[test]
fn what_is_above_one_is_intensity() {
    let bright = made([2.0, 1.0, 0.5], 300.0, "");
    assert_eq!(light(&bright), ([1.0, 0.5, 0.25], 6.0));
    let dim = made([0.5, 0.25, 0.0], 300.0, "");
    assert_eq!(light(&dim), ([0.5, 0.25, 0.0], 3.0));
    for made in [bright, dim] {
        assert!(made.report.lost.is_empty(), "{:?}", made.report.lost);
    }
}

#[test]
fn light_that_is_taken_away_is_said() {
    let made_of = |colour, intensity| {
        let made = made(colour, intensity, "");
        (light(&made), lost(&made, "light-negative"))
    };
    let dark = (([0.0; 3], 1.0), vec!["lamp".to_owned()]);
    assert_eq!(made_of([1.0; 3], -100.0), dark);
    assert_eq!(made_of([-1.0; 3], 100.0), dark);
    let partly = (([1.0, 0.0, 0.0], 2.0), vec!["lamp".to_owned()]);
    assert_eq!(made_of([2.0, -1.0, 0.0], 100.0), partly);
    // Twice less is more.
    assert_eq!(made_of([-1.0; 3], -100.0), (([1.0; 3], 1.0), vec![]));
}

#[test]
fn a_light_that_is_off_gives_none() {
    let off = made(
        [1.0; 3],
        100.0,
        "\t\t\tP: \"CastLight\", \"bool\", \"\", \"\",0\n",
    );
    assert_eq!(light(&off), ([1.0; 3], 0.0));
    assert!(off.report.lost.is_empty(), "{:?}", off.report.lost);
}
