//! Materials: opacity, emission, pictures that share one, and what is said to be lost.

use crate::support::looks::{Looks, colour, number, vector, whole};
use crate::support::made::{data, field, json, lost, made, material, nothing_lost};

#[test]
fn opacity_is_that_of_the_materials_own_model() {
    let made = field("a02_opacity_ways");
    nothing_lost(&made);
    let all = made
        .model
        .materials
        .iter()
        .map(|m| (m.base_colour[3], m.blend));
    let wanted = [
        (0.4, true),
        (1.0, false),
        (1.0, false),
        (0.5, true),
        (0.3, true),
    ];
    for ((alpha, blend), wanted) in all.zip(wanted) {
        assert!(
            (alpha - wanted.0).abs() < 1e-6 && blend == wanted.1,
            "{alpha} {blend} {wanted:?}"
        );
    }
    let json = json(&made);
    let modes = |n: usize| json["materials"][n]["alphaMode"].as_str();
    assert_eq!((modes(0), modes(1)), (Some("BLEND"), Some("OPAQUE")));
}

#[test]
fn opacity_of_other_ways_to_say_it() {
    let mut file = Looks::default();
    file.template(&(colour("TransparentColor", [0.0; 3]) + &number("TransparencyFactor", 0.0)));
    let physical = whole("3dsMax|ClassIDa", 0xd00f_1e00) + &whole("3dsMax|ClassIDb", 0xbe77_e500);
    let cases = [
        // Maya leaves out what the template says: black.
        ("maya", "phong", number("TransparencyFactor", 1.0), 1.0),
        ("nothing", "lambert", String::new(), 1.0),
        (
            "coloured",
            "lambert",
            colour("TransparentColor", [0.9, 0.6, 0.0]) + &number("TransparencyFactor", 0.5),
            0.75,
        ),
        // 3ds Max: only the outcome is right.
        (
            "max",
            "phong",
            colour("TransparentColor", [1.0; 3]) + &number("Opacity", 0.25),
            0.25,
        ),
        ("over", "phong", number("Opacity", 7.0), 1.0),
        (
            "physical",
            "unknown",
            physical.clone() + &number("3dsMax|main|opacity", 0.125) + &number("Opacity", 0.5),
            0.125,
        ),
        ("solid", "unknown", physical, 1.0),
    ];
    for (name, shading, properties, _) in &cases {
        let id = file.material(name, shading, properties);
        file.quad(name, &[], id);
    }
    let made = made(&file);
    nothing_lost(&made);
    for (name, _, _, alpha) in cases {
        let made = material(&made, name);
        assert!(
            (f64::from(made.base_colour[3]) - alpha).abs() < 1e-6,
            "{made:?}"
        );
        assert_eq!(made.blend, alpha < 1.0, "{name}");
    }
}

/// Without a template the factor or the colour stands alone.
#[test]
fn a_factor_or_a_colour_alone_counts() {
    let mut file = Looks::default();
    let cases = [
        ("factor", number("TransparencyFactor", 0.25), 0.75),
        ("colour", colour("TransparentColor", [0.25; 3]), 0.75),
        ("filter", colour("TransparentColor", [1.0; 3]), 1.0),
        ("wild", number("TransparencyFactor", -3.0), 1.0),
    ];
    for (name, properties, _) in &cases {
        let id = file.material(name, "Phong", properties);
        file.quad(name, &[], id);
    }
    let made = made(&file);
    for (name, _, alpha) in cases {
        assert_eq!(material(&made, name).base_colour[3], alpha, "{name}");
    }
}

#[test]
fn opacity_in_the_colours_picture_is_blended() {
    let mut file = Looks::default();
    let of = |file: &mut Looks, name: &str, base: &str, opacity: &str, property: &str| {
        let factor = number("TransparencyFactor", 1.0);
        let id = file.material(name, "phong", &factor);
        file.quad(name, &[("map", 1.0)], id);
        file.texture(base, "", id, "DiffuseColor");
        file.texture(opacity, "", id, property);
    };
    of(
        &mut file,
        "own",
        "glass.png",
        "glass.png",
        "TransparentColor",
    );
    of(
        &mut file,
        "factor",
        "glass.png",
        "glass.png",
        "TransparencyFactor",
    );
    of(
        &mut file,
        "apart",
        "red.png",
        "glass.png",
        "TransparentColor",
    );
    of(&mut file, "none", "red.png", "red.png", "TransparentColor");
    let made = made(&file);
    for name in ["own", "factor"] {
        let made = material(&made, name);
        assert_eq!((made.base_colour[3], made.blend), (1.0, true), "{name}");
    }
    assert_eq!(lost(&made, "opacity-map"), ["apart, none"]);
}

/// Exporters leave the numbers that a picture stands for at what would be invisible without it.
#[test]
fn without_its_picture_an_opacity_is_full() {
    let mut file = Looks::default();
    let numbers = number("TransparencyFactor", 1.0) + &colour("TransparentColor", [1.0; 3]);
    for (name, base, opacity) in [
        ("gone", "no.png", "no.png"),
        ("alone", "red.png", "no.png"),
        ("apart", "red.png", "glass.png"),
        ("none", "red.png", "red.png"),
    ] {
        let id = file.material(name, "phong", &numbers);
        file.quad(name, &[("map", 1.0)], id);
        file.texture(base, "", id, "DiffuseColor");
        file.texture(opacity, "", id, "TransparentColor");
    }
    let physical = whole("3dsMax|ClassIDa", 0xd00f_1e00) + &whole("3dsMax|ClassIDb", 0xbe77_e500);
    let physical = physical + &number("3dsMax|main|opacity", 0.0);
    let id = file.material("physical", "unknown", &physical);
    file.quad("physical", &[("map", 1.0)], id);
    file.texture("no.png", "", id, "3dsMax|main|opacity_map");
    let made = made(&file);
    for name in ["gone", "alone", "apart", "none", "physical"] {
        let made = material(&made, name);
        assert_eq!((made.base_colour[3], made.blend), (1.0, false), "{name}");
    }
    assert_eq!(lost(&made, "texture-file"), ["no.png"]);
}

#[test]
fn opacity_that_is_laid_on_in_another_way_is_said() {
    let mut file = Looks::default();
    let scaled = vector("Scaling", [4.0, 4.0, 1.0]);
    for (name, properties) in [("alike", ""), ("other", &*scaled)] {
        let id = file.material(name, "phong", &number("TransparencyFactor", 1.0));
        file.quad(name, &[("map", 1.0)], id);
        file.texture("glass.png", "", id, "DiffuseColor");
        file.texture("glass.png", properties, id, "TransparentColor");
    }
    let made = made(&file);
    let of = |name| {
        let made = material(&made, name);
        (made.base_colour[3], made.blend)
    };
    assert_eq!((of("alike"), of("other")), ((1.0, true), (1.0, false)));
    assert_eq!(lost(&made, "opacity-map"), ["other"]);
}

#[test]
fn colours_above_one_are_said() {
    let mut file = Looks::default();
    for (name, value, factor) in [
        ("bright", [1.0, 0.5, 0.0], 2.0),
        ("plain", [1.0, 0.5, 0.0], 1.0),
    ] {
        let properties = colour("DiffuseColor", value) + &number("DiffuseFactor", factor);
        let id = file.material(name, "phong", &properties);
        file.quad(name, &[], id);
    }
    let made = made(&file);
    assert_eq!(material(&made, "bright").base_colour, [1.0, 1.0, 0.0, 1.0]);
    assert_eq!(lost(&made, "colour-range"), ["bright"]);
}

/// 3ds Max's material: its opacity is white where it is opaque.
#[test]
fn an_opacity_of_its_own_goes_into_the_colours_picture() {
    let mut file = Looks::default();
    let ids = whole("3dsMax|ClassIDa", 0xd00f_1e00) + &whole("3dsMax|ClassIDb", 0xbe77_e500);
    let both = file.material("both", "unknown", &ids);
    file.quad("wall", &[("map", 1.0)], both);
    file.texture("red.png", "", both, "3dsMax|main|base_color_map");
    file.texture("glass.png", "", both, "3dsMax|main|opacity_map");
    let tiled = file.material("tiled", "unknown", &ids);
    file.quad("floor", &[("map", 1.0)], tiled);
    file.texture("red.png", "", tiled, "3dsMax|main|base_color_map");
    let scaling = vector("Scaling", [2.0, 2.0, 1.0]);
    file.texture("glass.png", &scaling, tiled, "3dsMax|main|opacity_map");
    let made = made(&file);
    assert_eq!(lost(&made, "opacity-map"), ["tiled"]);
    let both = material(&made, "both");
    assert!(both.blend && both.base_colour[3] == 1.0);
    let picture = &made.model.images[both.base_texture.as_ref().unwrap().image];
    let pixels = image::load_from_memory(&picture.bytes).unwrap().to_rgba8();
    // Red, and as opaque as glass.
    assert_eq!(pixels.get_pixel(0, 0).0, [200, 30, 30, 90]);
    // What went into another and is used nowhere else is not kept.
    assert_eq!(made.model.images.len(), 2);
    assert!(
        made.model
            .images
            .iter()
            .all(|image| image.name != "glass.png")
    );
}

#[test]
fn metalness_and_roughness_are_put_into_one_picture() {
    let mut file = Looks::default();
    let ids = whole("3dsMax|ClassIDa", 0xd00f_1e00) + &whole("3dsMax|ClassIDb", 0xbe77_e500);
    let of = |file: &mut Looks, name: &str, properties: &str, maps: &[(&str, &str)]| {
        let id = file.material(name, "unknown", &(ids.clone() + properties));
        file.quad(name, &[("map", 1.0)], id);
        for (picture, slot) in maps {
            file.texture(picture, "", id, &format!("3dsMax|main|{slot}"));
        }
    };
    let metal = ("red.png", "metalness_map");
    of(
        &mut file,
        "both",
        "",
        &[metal, ("blue.png", "roughness_map")],
    );
    of(
        &mut file,
        "metal",
        &number("3dsMax|main|roughness", 0.25),
        &[metal],
    );
    let gloss = whole("3dsMax|main|useGlossiness", 1) + &number("3dsMax|main|metalness", 0.5);
    of(&mut file, "gloss", &gloss, &[("blue.png", "roughness_map")]);
    of(
        &mut file,
        "same",
        "",
        &[metal, ("red.png", "roughness_map")],
    );
    let made = made(&file);
    nothing_lost(&made);
    let of = |name| {
        let made_of = material(&made, name);
        let texture = made_of.metallic_roughness_texture.as_ref().unwrap();
        let bytes = &made.model.images[texture.image].bytes;
        let pixel = image::load_from_memory(bytes)
            .unwrap()
            .to_rgb8()
            .get_pixel(0, 0)
            .0;
        (pixel[1], pixel[2], made_of.roughness, made_of.metallic)
    };
    let grey = |name: &str| {
        let bytes = std::fs::read(data().join(name)).unwrap();
        image::load_from_memory(&bytes)
            .unwrap()
            .to_luma8()
            .get_pixel(0, 0)
            .0[0]
    };
    let (red, blue) = (grey("red.png"), grey("blue.png"));
    assert_ne!(red, blue);
    assert_eq!(of("both"), (blue, red, 1.0, 1.0));
    assert_eq!(of("metal"), (255, red, 0.25, 1.0));
    assert_eq!(of("gloss"), (255 - blue, 255, 1.0, 0.5));
    assert_eq!(of("same"), (red, red, 1.0, 1.0));
    // Of two textures of one picture each channel is what its texture says.
    assert_eq!(made.model.images.len(), 4);
}

#[test]
fn emission_above_one_keeps_its_hue() {
    let made = field("a11_emissive_above_one");
    nothing_lost(&made);
    let lava = material(&made, "lava");
    assert_eq!(
        (lava.emissive, lava.emissive_strength),
        ([1.0, 0.4, 0.0], 5.0)
    );
    let lamp = material(&made, "lamp");
    assert_eq!(
        (lamp.emissive, lamp.emissive_strength),
        ([1.0, 0.5, 0.25], 2.0)
    );
    let json = json(&made);
    let said = &json["materials"][0]["extensions"]["KHR_materials_emissive_strength"];
    assert_eq!(said["emissiveStrength"].as_f64(), Some(5.0));
    assert_eq!(json["extensionsUsed"][0], "KHR_materials_emissive_strength");
}

#[test]
fn emission_of_a_picture_is_as_strong_as_its_factor() {
    let mut file = Looks::default();
    for (name, picture, factor) in [
        ("bright", "red.png", 3.0),
        ("dim", "red.png", 0.5),
        ("gone", "no.png", 1.0),
    ] {
        let properties = colour("EmissiveColor", [0.2; 3]) + &number("EmissiveFactor", factor);
        let id = file.material(name, "phong", &properties);
        file.quad(name, &[("map", 1.0)], id);
        file.texture(picture, "", id, "EmissiveColor");
    }
    let made = made(&file);
    let of = |name| {
        let made = material(&made, name);
        (made.emissive, made.emissive_strength)
    };
    assert_eq!(of("bright"), ([1.0; 3], 3.0));
    assert_eq!(of("dim"), ([0.5; 3], 1.0));
    assert_eq!(of("gone"), ([0.0; 3], 1.0));
    assert_eq!(lost(&made, "texture-file"), ["no.png"]);
    // What is not above one needs no extension.
    let json = json(&made);
    assert_eq!(json["materials"][1]["extensions"], serde_json::Value::Null);
}

#[test]
fn what_gltf_cannot_say_is_one_line_a_kind() {
    let mut file = Looks::default();
    for name in ["a", "b"] {
        let shiny = colour("ReflectionColor", [0.5; 3]) + &number("ReflectionFactor", 0.5);
        let shiny = shiny + &colour("SpecularColor", [1.0, 0.5, 0.0]);
        let id = file.material(name, "phong", &shiny);
        file.quad(name, &[("map", 1.0)], id);
        for property in [
            "Bump",
            "DisplacementColor",
            "Displacement",
            "VectorDisplacement",
            "AmbientColor",
            "ShininessExponent",
            "SpecularColor",
            "DiffuseFactor",
        ] {
            file.texture("red.png", "", id, property);
        }
    }
    let plain = file.material("plain", "phong", &colour("SpecularColor", [0.5; 3]));
    file.quad("plain", &[], plain);
    let made = made(&file);
    let mut kinds: Vec<&str> = made.report.lost.iter().map(|lost| lost.what).collect();
    kinds.sort_unstable();
    assert_eq!(
        kinds,
        [
            "ambient-map",
            "bump-map",
            "displacement",
            "factor-map",
            "reflection",
            "shininess-map",
            "specular-colour",
            "specular-map",
            "vector-displacement",
        ]
    );
    assert!(made.report.lost.iter().all(|lost| lost.name == "a, b"));
    let a = material(&made, "a");
    assert!(a.normal_texture.is_none() && a.metallic_roughness_texture.is_none());
    assert!(made.model.images.is_empty());
}
