//! What the measured table of the study says.

use crate::study::Asked;

/// What its measured table says.
pub const ASKED: [Asked; 28] = [
    asked(
        "A ball over borders of tiles of 8 m, farthest from one unbroken tile in 100 m, flat",
        "≤ 1e-3",
        "/roll/flat/unbroken_m",
        "m",
    ),
    asked(
        "The same on a slope",
        "≤ 1e-3",
        "/roll/slope/unbroken_m",
        "m",
    ),
    asked(
        "The same over waves",
        "≤ 1e-3",
        "/roll/waves/unbroken_m",
        "m",
    ),
    asked(
        "The same against parry's own height field, flat",
        "≤ 1e-3",
        "/roll/flat/parry_m",
        "m",
    ),
    asked(
        "The same against parry's own height field, on a slope",
        "≤ 1e-3",
        "/roll/slope/parry_m",
        "m",
    ),
    asked(
        "The same against parry's own height field, over waves",
        "≤ 1e-3",
        "/roll/waves/parry_m",
        "m",
    ),
    asked(
        "Parry's own height field against itself, its origin 8 m away, flat",
        "",
        "/roll/flat/parry_itself_m",
        "m",
    ),
    asked(
        "Parry's own height field against itself, its origin 8 m away, on a slope",
        "",
        "/roll/slope/parry_itself_m",
        "m",
    ),
    asked(
        "Parry's own height field against itself, its origin 8 m away, over waves",
        "",
        "/roll/waves/parry_itself_m",
        "m",
    ),
    asked(
        "A ball on flat ground, farthest from the straight line in 100 m",
        "",
        "/roll/flat/beside_m/ours",
        "m",
    ),
    asked(
        "A ball on flat ground, farthest from the straight line in 100 m, parry's own height field",
        "",
        "/roll/flat/beside_m/parry",
        "m",
    ),
    asked(
        "Balls at 100 m/s over ground that is replaced under them, times below it",
        "0",
        "/fast/below",
        "",
    ),
    asked(
        "Moves a second over Rapier's controller, hills",
        "≥ 5",
        "/over/hills/rapier",
        "ratio",
    ),
    asked(
        "Moves a second over Rapier's controller that climbs steps, hills",
        "≥ 5",
        "/over/hills/rapier_steps",
        "ratio",
    ),
    asked(
        "Moves a second over Rapier's controller that climbs steps, gravel",
        "",
        "/over/gravel/rapier_steps",
        "ratio",
    ),
    asked(
        "Moves a second over avian's MoveAndSlide, hills",
        "",
        "/over/hills/avian",
        "ratio",
    ),
    asked(
        "Moves a second over avian's MoveAndSlide that holds to the ground, hills",
        "",
        "/over/hills/avian_snaps",
        "ratio",
    ),
    asked(
        "Moves a second over avian's MoveAndSlide that holds to the ground, gravel",
        "",
        "/over/gravel/avian_snaps",
        "ratio",
    ),
    asked(
        "Deepest penetration, hills and gravel",
        "≤ 1e-4",
        "/depth_max_m/ours",
        "m",
    ),
    asked(
        "Deepest penetration, Rapier's controller",
        "",
        "/depth_max_m/rapier",
        "m",
    ),
    asked(
        "Deepest penetration, avian's MoveAndSlide",
        "",
        "/depth_max_m/avian",
        "m",
    ),
    asked(
        "Deepest penetration, avian's MoveAndSlide that holds to the ground",
        "",
        "/depth_max_m/avian_snaps",
        "m",
    ),
    asked(
        "Steps that stand still, hills",
        "",
        "/still/hills/ours",
        "part",
    ),
    asked(
        "Steps that stand still, hills, Rapier's controller",
        "",
        "/still/hills/rapier",
        "part",
    ),
    asked(
        "Steps that stand still, hills, avian's MoveAndSlide that holds to the ground",
        "",
        "/still/hills/avian_snaps",
        "part",
    ),
    asked(
        "Steps after which nothing is stood on, hills, avian's MoveAndSlide that holds to the ground",
        "",
        "/airborne/hills/avian_snaps",
        "part",
    ),
    asked(
        "Largest error of three advances of a slide, gravel",
        "",
        "/iterations/gravel/error_max_m/2",
        "m",
    ),
    asked(
        "Steps that three advances do not finish, gravel",
        "",
        "/iterations/gravel/wrong/2",
        "part",
    ),
];

const fn asked(
    what: &'static str,
    asked: &'static str,
    at: &'static str,
    unit: &'static str,
) -> Asked {
    Asked {
        what,
        asked,
        at,
        unit,
    }
}
