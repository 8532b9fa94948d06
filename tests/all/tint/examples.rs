//! What the examples draw with.

use dolomite::tessellation::render::{StageVariant, stage_variants};

/// An example as a module: its `main` is not run.
macro_rules! examples {
    ($($name:ident: $path:literal),* $(,)?) => {
        $(
            #[expect(dead_code, reason = "only its shaders are looked at")]
            #[path = $path]
            mod $name;
        )*
    };
}

examples! {
    lamps: "../../../examples/lamps.rs",
    sphere: "../../../examples/sphere.rs",
    stars: "../../../examples/stars.rs",
    teapot: "../../../examples/teapot.rs",
    terrain: "../../../examples/terrain.rs",
    torus: "../../../plugins/tessellation/examples/torus.rs",
    waves: "../../../plugins/geometry/examples/waves.rs",
}

/// The pass of an example that makes its own triangles.
pub const WAVES: &str = waves::WAVES;

/// What their pipelines may ask for.
pub fn variants() -> Vec<StageVariant> {
    [
        stage_variants::<lamps::Globe>(),
        stage_variants::<lamps::Post>(),
        stage_variants::<sphere::Rock>(),
        stage_variants::<stars::Star>(),
        stage_variants::<teapot::Bezier>(),
        stage_variants::<terrain::Boulder>(),
        stage_variants::<torus::Torus>(),
    ]
    .concat()
}
