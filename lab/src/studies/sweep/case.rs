//! One ellipsoid through one list of triangles, from a file.

use bevy::math::DVec3;
use dolomite_collision::{
    Body, Ellipsoid, Feature, MeshError, MoveError, MoveOutcome, MoveSettings, Mover, Scratch,
    SweepError, TreeSettings, TriangleMesh, TriangleTree, World, advance, sweep,
};
use serde::Deserialize;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use thiserror::Error;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Case {
    center: [f64; 3],
    radii: [f64; 3],
    way: [f64; 3],
    triangles: Vec<[[f64; 3]; 3]>,
    #[serde(default)]
    slide: bool,
}

/// A case that cannot be run.
#[derive(Debug, Error)]
pub enum CaseError {
    /// The file.
    #[error("{}: {source}", path.display())]
    File {
        /// Which.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// What it says.
    #[error("{}: {source}; the format is in --help", path.display())]
    Format {
        /// Which.
        path: PathBuf,
        /// Why.
        source: serde_json::Error,
    },
    /// No ellipsoid, or no way.
    #[error(transparent)]
    Sweep(#[from] SweepError),
    /// No triangles.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// No mover.
    #[error(transparent)]
    Move(#[from] MoveError),
}

/// Runs the case of a file.
///
/// # Errors
/// [`CaseError`].
pub fn run_case(path: &Path) -> Result<Value, CaseError> {
    let text = std::fs::read_to_string(path).map_err(|source| CaseError::File {
        path: path.to_owned(),
        source,
    })?;
    let case: Case = serde_json::from_str(&text).map_err(|source| CaseError::Format {
        path: path.to_owned(),
        source,
    })?;
    let triangles: Vec<[DVec3; 3]> = case.triangles.iter().map(|t| t.map(DVec3::from)).collect();
    let (center, way) = (DVec3::from(case.center), DVec3::from(case.way));
    if case.slide {
        return slide(center, case.radii.into(), way, &triangles);
    }
    let found = sweep(
        &Ellipsoid::upright(center, case.radii.into()),
        way,
        &triangles,
    )?;
    let end = center + way * found.map_or(1.0, |contact| contact.time);
    let contacts: Vec<Value> = found
        .iter()
        .map(|c| contact(c.time, c.triangle, c.feature, c.point, c.normal, c.depth))
        .collect();
    Ok(json!({ "contacts": contacts, "end": end.to_array() }))
}

fn contact(
    time: f64,
    triangle: u32,
    feature: Feature,
    point: DVec3,
    normal: DVec3,
    depth: f64,
) -> Value {
    json!({
        "time": time,
        "triangle": triangle,
        "feature": match feature {
            Feature::Face => "face".to_owned(),
            Feature::Edge(i) => format!("edge {i}"),
            Feature::Vertex(i) => format!("vertex {i}"),
        },
        "point": point.to_array(),
        "normal": normal.to_array(),
        "depth": depth,
    })
}

fn slide(
    center: DVec3,
    radii: DVec3,
    way: DVec3,
    triangles: &[[DVec3; 3]],
) -> Result<Value, CaseError> {
    let tree = TriangleTree::new(
        TriangleMesh::from_triangles(triangles)?,
        TreeSettings::default(),
    );
    let bodies = [Body::fixed(&tree)];
    let mut mover = Mover::new(center, radii);
    let mut outcome = MoveOutcome::default();
    advance(
        &World::new(&bodies),
        &mut mover,
        way,
        &MoveSettings::default(),
        &mut Scratch::default(),
        &mut outcome,
    );
    if let Some(error) = outcome.error {
        return Err(error.into());
    }
    let contacts: Vec<Value> = outcome
        .contacts
        .iter()
        .map(|c| contact(c.time, c.triangle, c.feature, c.point, c.normal, c.depth))
        .collect();
    Ok(json!({
        "contacts": contacts,
        "end": mover.center.to_array(),
        "grounded": outcome.grounded,
        "crushed": outcome.crushed,
        "iterations": outcome.iterations,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(name: &str, text: &str) -> Result<Value, CaseError> {
        let path =
            std::env::temp_dir().join(format!("dolomite_sweep_{name}_{}", std::process::id()));
        std::fs::write(&path, text).unwrap();
        let result = run_case(&path);
        std::fs::remove_file(path).unwrap();
        result
    }

    #[test]
    fn a_case_is_run_as_it_says() {
        let floor = r#""triangles": [[[-9,0,9],[9,0,9],[0,0,-9]]]"#;
        let text =
            format!(r#"{{"center": [0,2,0], "radii": [0.3,0.9,0.3], "way": [0,-2.2,0], {floor}}}"#);
        let found = run("one", &text).unwrap();
        assert_eq!(found["contacts"][0]["feature"], "face");
        assert!((found["contacts"][0]["time"].as_f64().unwrap() - 0.5).abs() < 1e-12);
        assert!((found["end"][1].as_f64().unwrap() - 0.9).abs() < 1e-12);
        let text = format!(
            r#"{{"center": [0,2,0], "radii": [0.3,0.9,0.3], "way": [1,-2.2,0], "slide": true, {floor}}}"#
        );
        let found = run("slide", &text).unwrap();
        assert!(
            (found["end"][0].as_f64().unwrap() - 1.0).abs() < 1e-6,
            "{found}"
        );
        assert_eq!(found["grounded"], true);
        let text =
            format!(r#"{{"center": [0,2,0], "radii": [0,0.9,0.3], "way": [1,0,0], {floor}}}"#);
        assert!(matches!(run("zero", &text), Err(CaseError::Sweep(_))));
        assert!(matches!(run("broken", "{}"), Err(CaseError::Format { .. })));
        for (slide, name) in [(false, "far"), (true, "far slide")] {
            let text = format!(
                r#"{{"center": [0,2,0], "radii": [0.3,0.9,0.3], "way": [0,-1e300,0], "slide": {slide}, {floor}}}"#
            );
            let refused = run(name, &text).unwrap_err().to_string();
            assert!(refused.contains("longer than 1e60 radii"), "{refused}");
        }
    }
}
