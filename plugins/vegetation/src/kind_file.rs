//! Files of kinds, and which numbers of a kind can be drawn.

use std::path::Path;

use crate::band::Band;
use crate::kind::{Blade, Kind, Kinds, Look, MOST_DENSITY, MOST_KINDS, Shape};
use crate::kind_error::{KindError, line_of};

/// The text of [`Kinds::small_set`].
const SMALL_SET: &str = include_str!("../assets/kinds.ron");

impl Kinds {
    /// A small set to begin with: grass, two flowers, kelp, a tree and a rock, whose file explains every field.
    #[must_use]
    pub fn small_set() -> Self {
        Self::parse(SMALL_SET, Path::new("kinds.ron")).expect("a test reads it")
    }

    /// Reads a file of kinds.
    ///
    /// # Errors
    /// [`KindError`], which names the file, the line and what to write instead.
    pub fn read(path: &Path) -> Result<Self, KindError> {
        let text = std::fs::read_to_string(path).map_err(|reason| KindError::Read {
            file: path.to_owned(),
            reason,
        })?;
        Self::parse(&text, path)
    }

    /// Reads the text of a file of kinds; `file` is named in errors.
    ///
    /// # Errors
    /// [`KindError`].
    pub fn parse(text: &str, file: &Path) -> Result<Self, KindError> {
        let options = ron::Options::default()
            .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
        let kinds: Self = options.from_str(text).map_err(|error| KindError::Parse {
            file: file.to_owned(),
            line: error.span.start.line,
            column: error.span.start.col,
            reason: error.code.to_string(),
        })?;
        kinds.checked().map_err(|error| match error {
            KindError::Field {
                kind,
                field,
                value,
                allowed,
                ..
            } => KindError::Field {
                file: Some(file.into()),
                line: line_of(text, &kind, field),
                kind,
                field,
                value,
                allowed,
            },
            other => other,
        })
    }

    /// The same kinds, if every number is one that can be drawn.
    ///
    /// # Errors
    /// [`KindError::Field`] for the first that is not.
    pub fn checked(self) -> Result<Self, KindError> {
        check(&self)?;
        Ok(self)
    }
}

struct Checked<'a>(&'a Kind);

impl Checked<'_> {
    fn wrong(&self, field: &'static str, value: String, allowed: String) -> KindError {
        KindError::Field {
            file: None,
            line: None,
            kind: self.0.name.as_str().into(),
            field,
            value: value.into(),
            allowed: allowed.into(),
        }
    }

    fn within(
        &self,
        field: &'static str,
        value: f32,
        least: f32,
        most: f32,
    ) -> Result<(), KindError> {
        // NaN is not within anything.
        if value >= least && value <= most {
            Ok(())
        } else {
            Err(self.wrong(field, value.to_string(), format!("{least} to {most}")))
        }
    }

    fn pair(
        &self,
        field: &'static str,
        (low, high): (f32, f32),
        least: f32,
        most: f32,
    ) -> Result<(), KindError> {
        self.within(field, low, least, most)?;
        self.within(field, high, low, most)
    }

    fn band(&self, [from, to, soft]: [&'static str; 3], band: Band) -> Result<(), KindError> {
        self.within(from, band.from, -1e6, 1e6)?;
        self.within(to, band.to, -1e6, 1e6)?;
        if band.to <= band.from {
            let allowed = format!("more than `from`, which is {}", band.from);
            return Err(self.wrong(to, band.to.to_string(), allowed));
        }
        self.within(soft, band.soft, 0.0, 0.5 * (band.to - band.from))
    }

    fn colour(&self, field: &'static str, colour: [f32; 3]) -> Result<(), KindError> {
        colour
            .into_iter()
            .try_for_each(|part| self.within(field, part, 0.0, 1.0))
    }

    fn look(&self, look: &Look) -> Result<(), KindError> {
        self.colour("look.root", look.root)?;
        self.colour("look.tip", look.tip)?;
        self.colour("look.dry", look.dry)?;
        self.within("look.dry_share", look.dry_share, 0.0, 1.0)?;
        self.within("look.translucency", look.translucency, 0.0, 1.0)?;
        self.within("look.sway", look.sway, 0.0, 1.0)
    }

    fn blade(&self, blade: &Blade) -> Result<(), KindError> {
        self.pair("length", blade.length, 0.01, 10.0)?;
        self.within("width", blade.width, 0.0005, 1.0)?;
        self.within("lean", blade.lean, 0.0, 1.5)?;
        self.within("droop", blade.droop, 0.0, 1.0)?;
        self.look(&blade.look)
    }

    fn shape(&self) -> Result<(), KindError> {
        match &self.0.shape {
            Shape::Blade(blade) => self.blade(blade),
            Shape::Flower(flower) => {
                self.blade(&flower.stem)?;
                self.within("petals", flower.petals as f32, 3.0, 12.0)?;
                self.within("radius", flower.radius, 0.002, 1.0)?;
                self.colour("colour", flower.colour)?;
                self.colour("middle", flower.middle)
            }
            Shape::Chain(chain) => {
                self.within("segment", chain.segment, 0.05, 2.0)?;
                self.within("segments", chain.segments as f32, 2.0, 64.0)?;
                self.pair("rise", chain.rise, 0.05, 3.0)?;
                self.within("width", chain.width, 0.001, 2.0)?;
                self.within("twist", chain.twist, 0.0, 0.8)?;
                self.look(&chain.look)
            }
            Shape::Mesh(mesh) => {
                if mesh.files.is_empty() {
                    let allowed = "at least one glTF file".into();
                    return Err(self.wrong("files", "empty".into(), allowed));
                }
                self.pair("scale", mesh.scale, 0.01, 100.0)?;
                self.within("sink", mesh.sink, -10.0, 10.0)?;
                self.within("follow", mesh.follow, 0.0, 1.0)?;
                self.within("shape.height", mesh.height, 0.01, 1000.0)
            }
        }
    }
}

fn check(of: &Kinds) -> Result<(), KindError> {
    if of.kinds.len() > MOST_KINDS {
        return Err(KindError::TooMany {
            count: of.kinds.len(),
            most: MOST_KINDS,
        });
    }
    for (place, kind) in of.kinds.iter().enumerate() {
        let checked = Checked(kind);
        if kind.name.is_empty() || of.find(&kind.name).is_some_and(|(first, _)| first != place) {
            let allowed = "a name that no other kind of the list has".into();
            return Err(checked.wrong("name", format!("`{}`", kind.name), allowed));
        }
        checked.within("density", kind.density, 0.0, MOST_DENSITY)?;
        checked.band(["height.from", "height.to", "height.soft"], kind.height)?;
        checked.band(["slope.from", "slope.to", "slope.soft"], kind.slope)?;
        checked.within("reach", kind.reach, 1.0, 20_000.0)?;
        if let Some(clumps) = &kind.clumps {
            checked.within("clumps.size", clumps.size, 0.25, 1000.0)?;
            checked.within("clumps.from", clumps.from, 0.0, 1.0)?;
            checked.within("clumps.to", clumps.to, clumps.from, 1.0)?;
            checked.within("clumps.uneven", clumps.uneven, 0.0, 1.0)?;
        }
        for other in &kind.keeps_off {
            let known = of.find(&other.kind).map(|(_, kind)| &kind.shape);
            if !matches!(known, Some(Shape::Mesh(_))) {
                let allowed = "the name of a kind in this list whose shape is a Mesh".into();
                return Err(checked.wrong("keeps_off.kind", format!("`{}`", other.kind), allowed));
            }
            checked.within("keeps_off.distance", other.distance, 0.0, 32.0)?;
        }
        checked.shape()?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Result<Kinds, KindError> {
        Kinds::parse(text, Path::new("my.ron"))
    }

    #[test]
    fn small_set_names_every_shape() {
        let kinds = parsed(SMALL_SET).expect("it is read");
        for shape in ["Blade", "Flower", "Chain", "Mesh"] {
            let is_one = |kind: &Kind| format!("{:?}", kind.shape).starts_with(shape);
            assert!(kinds.kinds.iter().any(is_one), "{shape}");
        }
    }

    /// Each mistake is named with its line and with what to write instead.
    #[test]
    fn mistakes_are_named() {
        let density = SMALL_SET
            .lines()
            .position(|line| line.contains("density: 250.0"));
        let density = density.expect("of grass") + 1;
        for (from, to, expected) in [
            (
                "density: 250.0",
                "density: NaN",
                format!("my.ron, line {density}: kind `grass`: density is NaN; it has to be 0 to 4096"),
            ),
            (
                "density: 250.0",
                "density: 1e6",
                format!("my.ron, line {density}: kind `grass`: density is 1000000; it has to be 0 to 4096"),
            ),
            (
                "from: 1.0, to: 620.0",
                "from: 1.0, to: -620.0",
                format!(
                    "my.ron, line {}: kind `grass`: height.to is -620; it has to be more than `from`, which is 1",
                    density + 2
                ),
            ),
            (
                "kind: \"boulder\", distance: 0.8",
                "kind: \"daisy\", distance: 0.8",
                "keeps_off.kind is `daisy`; it has to be the name of a kind in this list whose shape is a Mesh".into(),
            ),
            ("\"daisy\"", "\"grass\"", "name is `grass`; it has to be a name".into()),
            ("[\"plants/boulder.glb\"]", "[]", "files is empty; it has to be at least one glTF file".into()),
            ("petals: 9", "petals: 99", "petals is 99; it has to be 3 to 12".into()),
            ("length: (0.20, 0.48)", "length: (0.48, 0.20)", "length is 0.2; it has to be 0.48 to 10".into()),
            ("root: (0.055", "root: (3.0", "look.root is 3; it has to be 0 to 1".into()),
            ("reach: 130.0", "reach: inf", "reach is inf; it has to be 1 to 20000".into()),
            ("reach: 130.0", "raech: 260.0", "my.ron, line".into()),
        ] {
            let text = SMALL_SET.replacen(from, to, 1);
            assert_ne!(text, SMALL_SET, "{from}");
            let said = parsed(&text).expect_err(to).to_string();
            assert!(said.contains(&expected), "{said}\nin place of\n{expected}");
        }
    }

    #[test]
    fn lists_have_an_end() {
        let kind = parsed(SMALL_SET).expect("read").kinds[0].clone();
        let kinds = (0..=MOST_KINDS).map(|k| Kind {
            name: k.to_string(),
            keeps_off: Vec::new(),
            ..kind.clone()
        });
        let all = Kinds {
            kinds: kinds.collect(),
        };
        assert!(matches!(all.checked(), Err(KindError::TooMany { .. })));
    }
}
