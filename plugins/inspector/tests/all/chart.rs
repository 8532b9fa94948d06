//! Charts of a running app.
use crate::support::{Fog, app, say};

use std::time::{Duration, Instant};

use bevy::diagnostic::{Diagnostic, DiagnosticPath, Diagnostics, RegisterDiagnostic};
use bevy::prelude::*;
use dolomite_inspector::chart::{Chart, Charts};

const THICK: DiagnosticPath = DiagnosticPath::const_new("fog/thick");

/// An app whose frames take as many milliseconds as the fog's dust says, and whose fog is twice as thick.
fn foggy() -> (App, Entity) {
    let (mut app, entity) = app();
    app.register_diagnostic(Diagnostic::new(THICK)).add_systems(
        Update,
        |fogs: Query<&Fog>, mut diagnostics: Diagnostics| {
            let dust: f32 = fogs.iter().map(|fog| fog.dust).sum();
            let began = Instant::now();
            while began.elapsed() < Duration::from_secs_f32(1e-3 * dust) {
                std::hint::spin_loop();
            }
            diagnostics.add_measurement(&THICK, || f64::from(2.0 * dust));
        },
    );
    app.update();
    (app, entity)
}

fn newest(app: &App) -> Chart {
    let charts = app.world().resource::<Charts>();
    charts.list().last().expect("there is one").clone()
}

fn dust(app: &App, entity: Entity) -> f32 {
    app.world().get::<Fog>(entity).expect("it is there").dust
}

#[test]
fn time_and_error_are_measured_at_each_value_and_the_setting_is_what_it_was() {
    let (mut app, entity) = foggy();
    let said = say(
        &mut app,
        "chart Fog.dust 1 16 --steps 5 --settle 2 --frames 7 --error fog/thick",
    )
    .unwrap();
    // A head, and a row a value.
    assert_eq!(said.lines().count(), 6, "{said}");
    let chart = newest(&app);
    assert!(chart.done && chart.wanted == 5);
    for (point, value) in chart.points.iter().zip([1.0, 2.0, 4.0, 8.0, 16.0]) {
        assert!((point.value - value).abs() < 1e-9, "{point:?}");
        // As f32 keeps it.
        assert!(
            (point.error.unwrap() - 2.0 * value).abs() < 1e-5,
            "{point:?}"
        );
        // The frame spins as long; how much longer it takes is the machine's.
        assert!(
            point.time >= value && point.spread[0] <= point.time,
            "{point:?}"
        );
        assert!(point.spread[1] >= point.time, "{point:?}");
    }
    assert_eq!(chart.points.len(), 5);
    assert_eq!(dust(&app, entity), 1.0);
    // The chart is not among the changes that are taken back.
    assert!(say(&mut app, "undo").is_err());
}

#[test]
fn a_chart_is_written_and_a_diagnostic_stands_for_the_time() {
    let (mut app, _) = foggy();
    let file = std::env::temp_dir().join(format!("dolomite-chart-{}.json", std::process::id()));
    let line = format!(
        "chart Fog.dust 0 1 --linear --steps 3 --frames 2 --time fog/thick --out '{}'",
        file.display()
    );
    say(&mut app, &line).unwrap();
    let text = std::fs::read_to_string(&file).unwrap();
    std::fs::remove_file(&file).unwrap();
    assert_eq!(text.matches("\"value\"").count(), 3, "{text}");
    let times: Vec<f64> = newest(&app).points.iter().map(|point| point.time).collect();
    assert_eq!(times, [0.0, 1.0, 2.0]);
}

#[test]
fn whole_numbers_and_optional_ones_are_moved_too() {
    let (mut app, entity) = foggy();
    say(&mut app, "set Fog.near 3").unwrap();
    say(&mut app, "chart Fog.near 1 2 --steps 2 --frames 1").unwrap();
    say(&mut app, "chart Fog.layers[1] 1 9 --steps 3 --frames 1").unwrap();
    let fog = app.world().get::<Fog>(entity).unwrap();
    assert_eq!(
        (fog.near, fog.layers.as_slice()),
        (Some(3.0), [1, 2, 3].as_slice())
    );
}

#[test]
fn what_makes_no_chart_is_said_and_changes_nothing() {
    let (mut app, entity) = foggy();
    for (line, word) in [
        ("chart Fog.dust 1 101", "0 to 100"),
        ("chart Fog.dust -1 5", "0 to 100"),
        ("chart Fog.dust 1 1", "differ"),
        ("chart Fog.dust 1 inf", "finite"),
        ("chart Fog.dust 1 NaN", "finite"),
        ("chart Fog.dust 1 2 --steps 1", "values"),
        ("chart Fog.dust 1 2 --frames 0", "frames"),
        ("chart Fog.dust 1 2 --error no/such", "no/such"),
        ("chart Fog.dust 1 2 --time no/such", "no/such"),
        ("chart Fog.dust 1 2 --error fog/drawn --steps 2", "no value"),
        ("chart Fog.dust 1 2 --time fog/drawn --steps 2", "no value"),
        ("chart Fog.dust 1 2 --picture", "no renderer"),
        ("chart Fog.dust 1 2 --out a.txt", ".csv"),
        ("chart Fog.dust 1", "TO"),
        ("chart Fog.kind 1 2", "FogKind"),
        ("chart Fog.name 1 2 --steps 0", "values"),
        ("chart Frog.dust 1 2", "no component"),
    ] {
        let fault = say(&mut app, line).expect_err(line);
        assert!(fault.contains(word), "{line}: {fault}");
        assert_eq!(
            app.world().get::<Fog>(entity),
            Some(&Fog::default()),
            "{line}"
        );
    }
}

#[test]
fn one_whose_entity_goes_ends_with_a_fault_and_one_that_is_stopped_ends() {
    let (mut app, entity) = foggy();
    app.add_systems(
        Last,
        move |mut commands: Commands, charts: Option<Res<Charts>>| {
            if charts
                .is_some_and(|charts| charts.list().last().is_some_and(|c| c.points.len() == 2))
            {
                commands.entity(entity).try_despawn();
            }
        },
    );
    let fault = say(&mut app, "chart Fog.dust 1 2 --frames 1 --settle 0").unwrap_err();
    assert!(fault.contains("gone"), "{fault}");
    assert!(newest(&app).done);

    let (mut app, entity) = foggy();
    app.add_systems(Last, |mut charts: ResMut<Charts>| {
        if charts
            .list()
            .last()
            .is_some_and(|chart| chart.points.len() == 2)
        {
            charts.stop();
        }
    })
    .init_resource::<Charts>();
    say(&mut app, "chart Fog.dust 1 2 --frames 1 --settle 0").unwrap();
    let chart = newest(&app);
    assert!(
        chart.done && (2..4).contains(&chart.points.len()),
        "{chart:?}"
    );
    assert_eq!(dust(&app, entity), 1.0);
}
