//! The panel, drawn into an image without a window.
use crate::support::{Fog, add_fog};

use crate::drawn::{self, HEIGHT, Target, differing, frames, picture, pipelines};

use bevy::camera::RenderTarget;
use bevy::core_pipeline::{Core2d, Core3d};
use bevy::ecs::schedule::{InternedScheduleLabel, ScheduleLabel, Schedules};
use bevy::prelude::*;
use bevy::render::{Render, RenderApp};
use bevy_egui::render::EguiPipeline;
use bevy_egui::render::systems::{EguiRenderData, EguiTransforms};
use bevy_egui::{
    EguiContext, EguiInput, EguiManagedTextures, EguiPlugin, EguiPrimaryContextPass, egui,
};
use dolomite_inspector::panel::state::{Shell, Tab};
use dolomite_inspector::panel::{
    InspectorCamera, InspectorInput, InspectorOutput, InspectorPass, InspectorTarget,
};
use dolomite_inspector::settings::edit::undo;
use dolomite_inspector::{Console, Inspector, InspectorPlugin, InspectorWants};

/// What ran while nobody looked.
#[derive(Resource, Default)]
struct Ran(u32);

/// A stranger's app with a camera that draws a colour into an image.
fn app() -> Option<App> {
    let mut app = drawn::app()?;
    app.init_resource::<Ran>()
        // Twice, as two plugins of a stranger may do it.
        .add_plugins(InspectorPlugin)
        .add_plugins(InspectorPlugin);
    add_fog(&mut app);
    let count = |mut ran: ResMut<Ran>| ran.0 += 1;
    app.add_systems(InspectorInput, count)
        .add_systems(InspectorOutput, count)
        .add_systems(InspectorPass, count);
    let target = RenderTarget::Image(app.world().resource::<Target>().0.clone().into());
    app.insert_resource(InspectorTarget(target.clone()))
        .insert_resource(ClearColor(Color::srgb(0.1, 0.5, 0.2)));
    app.finish();
    app.cleanup();
    app.world_mut().spawn((Camera3d::default(), target));
    app.world_mut().spawn((Fog::default(), Name::new("valley")));
    Some(app)
}

fn contexts(app: &mut App) -> usize {
    let world = app.world_mut();
    world.query::<&EguiContext>().iter(world).count()
}

fn open(app: &mut App, panel: bool, console: bool) {
    *app.world_mut().resource_mut::<Inspector>() = Inspector { panel, console };
}

/// Hands egui events as a window would.
fn hand(app: &mut App, events: Vec<egui::Event>) {
    let world = app.world_mut();
    let mut inputs = world.query_filtered::<&mut EguiInput, With<InspectorCamera>>();
    inputs
        .single_mut(world)
        .expect("it is open")
        .events
        .extend(events);
    frames(app, 1);
}

/// How many systems of `bevy_egui` a schedule has.
fn systems_of_egui(world: &World, schedule: impl ScheduleLabel) -> usize {
    let label: InternedScheduleLabel = schedule.intern();
    let schedules = world.resource::<Schedules>();
    let schedule = schedules.get(label).expect("it is there");
    let systems = schedule.systems().expect("it ran");
    systems
        .filter(|(_, system)| system.name().to_string().contains("bevy_egui::"))
        .count()
}

/// Pixels that the panel changes, in a stranger's app with `bevy_egui` of its own.
fn drawn_beside_egui(first: bool) -> Option<usize> {
    let mut app = drawn::app()?;
    if first {
        app.add_plugins((EguiPlugin::default(), InspectorPlugin));
    } else {
        app.add_plugins((InspectorPlugin, EguiPlugin::default()));
    }
    let count = |mut ran: ResMut<Ran>| ran.0 += 1;
    app.init_resource::<Ran>()
        .add_systems(InspectorPass, count)
        // Who has it draws with it: bevy_egui 0.42 fails at the first camera of an app without a system there.
        .add_systems(EguiPrimaryContextPass, || {});
    let target = RenderTarget::Image(app.world().resource::<Target>().0.clone().into());
    app.insert_resource(InspectorTarget(target.clone()));
    app.finish();
    app.cleanup();
    app.world_mut().spawn((Camera3d::default(), target));
    frames(&mut app, 5);
    let before = picture(&mut app);
    open(&mut app, true, false);
    frames(&mut app, 5);
    let ran = app.world().resource::<Ran>().0;
    frames(&mut app, 4);
    assert_eq!(app.world().resource::<Ran>().0 - ran, 4, "once a frame");
    Some(differing(&before, &picture(&mut app)))
}

mod gpu {
    use super::*;

    #[test]
    fn closed_none_of_eguis_systems_is_in_a_frame_and_it_lets_go_of_all_that_it_made() {
        let Some(mut app) = app() else { return };
        frames(&mut app, 3);
        let world = app.world();
        assert_eq!(systems_of_egui(world, PreUpdate), 0);
        assert_eq!(systems_of_egui(world, Update), 0);
        assert_eq!(systems_of_egui(world, PostUpdate), 0);
        assert_eq!(systems_of_egui(world, Last), 0);
        assert!(!world.contains_resource::<EguiManagedTextures>());
        let has = |app: &App| {
            let world = app.sub_app(RenderApp).world();
            [
                world.contains_resource::<EguiPipeline>(),
                world.contains_resource::<EguiRenderData>(),
                world.contains_resource::<EguiTransforms>(),
            ]
        };
        assert_eq!(has(&app), [false; 3]);
        let render = app.sub_app(RenderApp).world();
        // A schedule that runs for every view and every face of a shadow map.
        assert_eq!(systems_of_egui(render, Core3d), 0);
        // Behind a condition: they are found, so that names can be.
        assert_eq!(systems_of_egui(render, Render), 4);
        open(&mut app, true, false);
        frames(&mut app, 3);
        assert_eq!(has(&app), [true; 3]);
        let render = app.sub_app(RenderApp).world();
        assert_eq!(systems_of_egui(render, Core2d), 2);
        open(&mut app, false, false);
        frames(&mut app, 8);
        // A description of layouts stays, which is no object of the device.
        assert_eq!(has(&app), [true, false, false]);
    }

    #[test]
    fn an_app_may_have_egui_of_its_own_before_and_after() {
        for first in [true, false] {
            let Some(count) = drawn_beside_egui(first) else {
                return;
            };
            assert!(count > 10_000, "{first}: {count} pixels");
        }
    }

    #[test]
    fn closed_it_does_nothing_and_opened_it_is_drawn_over_the_picture() {
        let Some(mut app) = app() else { return };
        frames(&mut app, 5);
        assert_eq!(app.world().resource::<Ran>().0, 0, "closed, nothing runs");
        assert_eq!(contexts(&mut app), 0);
        assert_eq!(pipelines(&app, "egui_pipeline"), 0);
        let before = picture(&mut app);
        assert_eq!(app.world().resource::<Ran>().0, 0);

        open(&mut app, true, false);
        frames(&mut app, 5);
        // Three a frame; there is no context before the camera is.
        assert!(app.world().resource::<Ran>().0 >= 12, "the count can count");
        assert_eq!(contexts(&mut app), 1);
        assert_eq!(pipelines(&app, "egui_pipeline"), 1);
        let opened = picture(&mut app);
        let part = differing(&before, &opened) as f32 / opened.len() as f32;
        assert!((0.3..0.9).contains(&part), "{part} of the picture");
        // Beside the panel the picture is as it was.
        let corner = opened.len() - 1;
        assert_eq!(opened[corner], before[corner]);

        open(&mut app, false, false);
        frames(&mut app, 8);
        assert_eq!(contexts(&mut app), 0);
        assert!(app.world().resource::<EguiManagedTextures>().is_empty());
        assert_eq!(
            *app.world().resource::<InspectorWants>(),
            InspectorWants::default()
        );
        let ran = app.world().resource::<Ran>().0;
        assert_eq!(picture(&mut app), before);
        assert_eq!(
            app.world().resource::<Ran>().0,
            ran,
            "closed again, nothing runs"
        );
    }

    #[test]
    fn every_tab_is_drawn_also_of_an_entity_that_is_gone() {
        let Some(mut app) = app() else { return };
        open(&mut app, true, true);
        let fog = {
            let world = app.world_mut();
            world
                .query_filtered::<Entity, With<Fog>>()
                .single(world)
                .unwrap()
        };
        let mut pictures = Vec::new();
        for (tab, filter) in [
            (Tab::Settings, "fog"),
            (Tab::Entities, ""),
            (Tab::Diagnostics, ""),
            (Tab::Views, ""),
        ] {
            let mut shell = app.world_mut().resource_mut::<Shell>();
            shell.tab = tab;
            shell.all = true;
            shell.filter = filter.to_owned();
            shell.chosen = Some(fog);
            if tab == Tab::Diagnostics {
                app.world_mut().despawn(fog);
                app.world_mut().resource_mut::<Shell>().tab = Tab::Entities;
                frames(&mut app, 3);
                app.world_mut().resource_mut::<Shell>().tab = tab;
            }
            frames(&mut app, 3);
            pictures.push(picture(&mut app));
        }
        for (k, one) in pictures.iter().enumerate() {
            for other in &pictures[k + 1..] {
                assert!(differing(one, other) > 500, "tabs look alike");
            }
        }
    }

    #[test]
    fn a_slider_is_pulled_and_taken_back_and_a_line_typed() {
        let Some(mut app) = app() else { return };
        open(&mut app, true, false);
        app.world_mut().resource_mut::<Shell>().filter = "Fog".to_owned();
        frames(&mut app, 5);
        let dust = |app: &mut App| {
            let world = app.world_mut();
            world.query::<&Fog>().single(world).unwrap().dust
        };
        // The slider of `dust` is found by pulling at each row until one moves it.
        let button = |pos, pressed| egui::Event::PointerButton {
            pos,
            button: egui::PointerButton::Primary,
            pressed,
            modifiers: egui::Modifiers::NONE,
        };
        let mut found = None;
        for y in (60..HEIGHT - 20).step_by(6) {
            let [from, to] = [110.0, 150.0].map(|x| egui::pos2(x, y as f32));
            hand(&mut app, vec![egui::Event::PointerMoved(from)]);
            hand(&mut app, vec![button(from, true)]);
            for k in 1..=4 {
                let at = from + (to - from) * (k as f32 / 4.0);
                hand(&mut app, vec![egui::Event::PointerMoved(at)]);
            }
            hand(&mut app, vec![button(to, false)]);
            frames(&mut app, 1);
            if dust(&mut app) != 1.0 {
                found = Some(dust(&mut app));
                break;
            }
        }
        let found = found.expect("a slider was moved");
        assert!((1.0..=100.0).contains(&found), "{found}");
        // One pull is one change.
        let place = undo(app.world_mut()).unwrap().expect("a change");
        assert_eq!(place.path, ".dust");
        assert_eq!(dust(&mut app), 1.0);

        open(&mut app, false, true);
        frames(&mut app, 5);
        assert!(app.world().resource::<InspectorWants>().keyboard);
        hand(
            &mut app,
            vec![egui::Event::Text("set Fog.dust 42".to_owned())],
        );
        let key = |pressed| egui::Event::Key {
            key: egui::Key::Enter,
            physical_key: None,
            pressed,
            repeat: false,
            modifiers: egui::Modifiers::NONE,
        };
        hand(&mut app, vec![key(true)]);
        hand(&mut app, vec![key(false)]);
        frames(&mut app, 3);
        let console = app.world().resource::<Console>();
        let said: Vec<_> = console.output().map(|(_, line)| line.to_owned()).collect();
        assert_eq!(dust(&mut app), 42.0, "{said:?}");
    }
}
