//! Finding, in folders that are made for it.

use super::*;

/// A folder of its own, which is taken away afterwards.
struct Place(PathBuf);

impl Place {
    fn new(name: &str, files: &[&str]) -> Self {
        let name = format!("dolomite_fbx_{name}_{}", std::process::id());
        let place = Self(std::env::temp_dir().join(name));
        for file in files {
            let path = place.0.join(file);
            std::fs::create_dir_all(path.parent().expect("a folder")).expect("it is made");
            std::fs::write(path, file).expect("it is written");
        }
        place
    }

    /// What is found for a file `own/Hero.fbx`, named from here.
    fn find(&self, given: &[&str], name: &str) -> Option<String> {
        Some(self.found(given, &[name])?.0)
    }

    /// The same by several names, and how many others may be meant.
    fn found(&self, given: &[&str], names: &[&str]) -> Option<(String, usize)> {
        let given: Vec<PathBuf> = given.iter().map(|folder| self.0.join(folder)).collect();
        let mut finder = Finder::new("own/Hero.fbx", Some(&self.0.join("own")), &given);
        let found = finder.find(names)?;
        let base = self.0.canonicalize().expect("it is there");
        let rest = found.path.strip_prefix(base).expect("it is below");
        Some((rest.display().to_string(), found.others))
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        std::fs::remove_dir_all(&self.0).expect("it is taken away");
    }
}

#[test]
fn pictures_are_found_where_exporters_put_them() {
    let place = Place::new(
        "put",
        &[
            "own/a.png",
            "own/hero.fbm/b.png",
            "own/Textures/c.png",
            "own/TEXTURE/d.png",
            "own/maps/wood/e.png",
            "out/f.png",
        ],
    );
    let of = |name: &str| place.find(&[], name);
    assert_eq!(of("a.png").as_deref(), Some("own/a.png"));
    assert_eq!(of("A.PNG").as_deref(), Some("own/a.png"));
    assert_eq!(of("C:\\art\\hero\\a.png").as_deref(), Some("own/a.png"));
    assert_eq!(of("b.png").as_deref(), Some("own/hero.fbm/b.png"));
    assert_eq!(of("/art/x/B.png").as_deref(), Some("own/hero.fbm/b.png"));
    assert_eq!(
        of("..\\..\\sourceimages\\c.png").as_deref(),
        Some("own/Textures/c.png")
    );
    assert_eq!(of("d.png").as_deref(), Some("own/TEXTURE/d.png"));
    assert_eq!(
        of("Maps/Wood/E.png").as_deref(),
        Some("own/maps/wood/e.png")
    );
    assert_eq!(
        of("D:/proj/maps/wood/e.png").as_deref(),
        Some("own/maps/wood/e.png")
    );
    assert_eq!(of("e.png"), None);
    assert_eq!(of("../out/f.png"), None);
    assert_eq!(of(""), None);
    assert_eq!(of(".."), None);
}

#[test]
fn what_is_stated_comes_before_what_is_guessed() {
    let place = Place::new(
        "stated",
        &["own/a.png", "own/skins/a.png", "own/textures/a.png"],
    );
    assert_eq!(
        place.find(&[], "skins/a.png").as_deref(),
        Some("own/skins/a.png")
    );
    assert_eq!(
        place.find(&[], "./skins/../textures/a.png").as_deref(),
        Some("own/textures/a.png")
    );
    assert_eq!(place.find(&[], "other/a.png").as_deref(), Some("own/a.png"));
}

#[test]
fn folders_that_are_given_are_looked_through() {
    let place = Place::new(
        "given",
        &[
            "own/x",
            "lib/a.png",
            "lib/deep/er/b.png",
            "lib/Textures/c.png",
            "near/d.png",
        ],
    );
    assert_eq!(place.find(&["lib"], "a.png").as_deref(), Some("lib/a.png"));
    assert_eq!(
        place.find(&["lib"], "x/B.png").as_deref(),
        Some("lib/deep/er/b.png")
    );
    assert_eq!(
        place.find(&["lib"], "C.png").as_deref(),
        Some("lib/Textures/c.png")
    );
    // A stated sibling is found where its folder was given, and only there.
    assert_eq!(place.find(&["lib"], "../near/d.png"), None);
    assert_eq!(
        place.find(&["near"], "../near/d.png").as_deref(),
        Some("near/d.png")
    );
    assert_eq!(
        place.find(&["."], "../near/d.png").as_deref(),
        Some("near/d.png")
    );
    assert_eq!(
        place.find(&["none such", "lib"], "a.png").as_deref(),
        Some("lib/a.png")
    );
    let absolute = place.0.canonicalize().unwrap().join("near/d.png");
    let absolute = absolute.display().to_string();
    assert_eq!(place.find(&["lib"], &absolute), None);
    assert_eq!(
        place.find(&["near"], &absolute).as_deref(),
        Some("near/d.png")
    );
}

/// Parts of a body often have pictures of the same names, in folders of their own.
#[test]
fn files_of_one_name_are_told_apart_by_their_folders() {
    let place = Place::new(
        "same",
        &[
            "own/x",
            "lib/p/body/a.png",
            "lib/p/head/a.png",
            "lib/q/b.png",
        ],
    );
    let of = |names: &[&str]| place.found(&["lib"], names);
    let head = Some(("lib/p/head/a.png".to_owned(), 0));
    assert_eq!(of(&["C:\\art\\head\\a.png"]), head);
    assert_eq!(of(&["..\\Head\\A.png"]), head);
    // The one name says nothing, the other does.
    assert_eq!(of(&["a.png", "/art/head/a.png"]), head);
    let body = |others| Some(("lib/p/body/a.png".to_owned(), others));
    assert_eq!(of(&["C:\\art\\body\\a.png"]), body(0));
    assert_eq!(of(&["C:\\art\\a.png"]), body(1));
    // One that lies as the file says comes before one that has its name alone.
    let above = Place::new("above", &["own/x", "lib/a.png", "lib/p/head/a.png"]);
    let of_above = |name: &str| above.found(&["lib"], &[name]);
    assert_eq!(of_above("C:\\art\\head\\a.png"), head);
    let top = Some(("lib/a.png".to_owned(), 0));
    assert_eq!(of_above("C:\\art\\a.png"), top);
    assert_eq!(of_above("a.png"), top);
    // The first name that is there counts.
    assert_eq!(of(&["a.png", "x/y/b.png"]), body(1));
    // A folder that is given twice has its files once.
    let twice = place.found(&["lib", "lib"], &["x/b.png"]);
    assert_eq!(twice, Some(("lib/q/b.png".to_owned(), 0)));
}

#[test]
fn without_a_folder_nothing_is_found() {
    let mut finder = Finder::new("a.fbx", None, &[]);
    assert_eq!(finder.find(&["Cargo.toml", "/etc/passwd"]), None);
    assert!(finder.places().contains("no folder"));
}

#[cfg(unix)]
#[test]
fn links_that_lead_out_are_not_followed() {
    use std::os::unix::fs::symlink;
    let place = Place::new("links", &["own/a.png", "secret/s.png", "lib/l.png"]);
    symlink(place.0.join("secret/s.png"), place.0.join("own/link.png")).unwrap();
    symlink(place.0.join("secret"), place.0.join("own/textures")).unwrap();
    symlink(place.0.join("lib"), place.0.join("own/lib")).unwrap();
    symlink(place.0.join("own/a.png"), place.0.join("own/b.png")).unwrap();
    symlink(place.0.join("own"), place.0.join("lib/round")).unwrap();
    assert_eq!(place.find(&[], "link.png"), None);
    assert_eq!(place.find(&[], "s.png"), None);
    assert_eq!(place.find(&[], "S.PNG"), None);
    assert_eq!(place.find(&[], "textures/s.png"), None);
    assert_eq!(place.find(&["lib"], "s.png"), None);
    assert_eq!(place.find(&[], "b.png").as_deref(), Some("own/a.png"));
    // From one folder that was given into another is inside.
    assert_eq!(place.find(&[], "lib/l.png"), None);
    assert_eq!(
        place.find(&["lib"], "own/../lib/l.png").as_deref(),
        Some("lib/l.png")
    );
}
