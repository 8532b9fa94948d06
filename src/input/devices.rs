//! From keyboard, mouse and gamepad to [`PlayerInput`].

use bevy::input::InputSystems;
use bevy::input::mouse::{AccumulatedMouseMotion, AccumulatedMouseScroll, MouseScrollUnit};
use bevy::prelude::*;
use bevy::window::{CursorGrabMode, CursorOptions, PrimaryWindow};

use super::{InputMode, PlayerInput};
use dolomite::inspector::{Inspector, InspectorSystems, InspectorWants};

use crate::settings::Settings;

/// The set in which devices are read (schedule `PreUpdate`).
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct DeviceSystems;

/// Reads devices into [`PlayerInput`], and gives and takes the cursor.
pub struct InputPlugin;

impl Plugin for InputPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<InputMode>()
            .add_systems(Startup, take_cursor)
            .add_systems(
                PreUpdate,
                (read_keyboard_and_mouse, read_gamepads, mean)
                    .chain()
                    .in_set(DeviceSystems)
                    .after(InputSystems)
                    .after(InspectorSystems),
            )
            .add_systems(
                Update,
                (
                    free_or_take_cursor,
                    lend_cursor.run_if(resource_exists_and_changed::<Inspector>),
                    leave,
                ),
            );
    }
}

/// Stick deflections below this are no wish; sticks seldom rest at exactly 0.
const DEAD_ZONE: f32 = 0.12;

/// Turn of a fully deflected stick, radians a second.
const STICK_TURN: f32 = 2.2;

/// Zoom of a fully deflected stick, wheel steps a second.
const STICK_ZOOM: f32 = 8.0;

/// Pixels of a touchpad that count as one wheel step.
const PIXELS_PER_STEP: f32 = 40.0;

fn read_keyboard_and_mouse(
    keys: Res<ButtonInput<KeyCode>>,
    buttons: Option<Res<ButtonInput<MouseButton>>>,
    motion: Res<AccumulatedMouseMotion>,
    scroll: Res<AccumulatedMouseScroll>,
    settings: Res<Settings>,
    cursor: Option<Single<&CursorOptions, With<PrimaryWindow>>>,
    inspector: Option<Res<Inspector>>,
    wants: Option<Res<InspectorWants>>,
    mut input: ResMut<PlayerInput>,
) {
    let wants = wants.as_deref().copied().unwrap_or_default();
    if wants.keyboard {
        // Something is being typed.
        *input = PlayerInput::default();
        return;
    }
    let axis = |minus: KeyCode, plus: KeyCode| {
        f32::from(keys.pressed(plus)) - f32::from(keys.pressed(minus))
    };
    let step = |minus: &[KeyCode], plus: &[KeyCode]| {
        let any = |keys_of: &[KeyCode]| keys.any_just_pressed(keys_of.iter().copied());
        i32::from(any(plus)) - i32::from(any(minus))
    };
    let looking = cursor.is_some_and(|cursor| cursor.grab_mode != CursorGrabMode::None);
    let shoots = buttons.is_some_and(|buttons| buttons.pressed(MouseButton::Left));
    let turn = settings.mouse_sensitivity.to_radians();
    let pitch_sign = if settings.invert_y { 1.0 } else { -1.0 };
    *input = PlayerInput {
        fly: Vec3::new(
            axis(KeyCode::KeyA, KeyCode::KeyD),
            axis(KeyCode::ShiftLeft, KeyCode::Space),
            axis(KeyCode::KeyS, KeyCode::KeyW),
        ),
        walk: Vec2::new(
            axis(KeyCode::ArrowLeft, KeyCode::ArrowRight),
            axis(KeyCode::ArrowDown, KeyCode::ArrowUp),
        ),
        fast: keys.any_pressed([KeyCode::ControlLeft, KeyCode::ControlRight]),
        look: if looking {
            Vec2::new(motion.delta.x, pitch_sign * motion.delta.y) * turn
        } else {
            Vec2::ZERO
        },
        zoom: if wants.pointer {
            0.0
        } else {
            match scroll.unit {
                MouseScrollUnit::Line => scroll.delta.y,
                MouseScrollUnit::Pixel => scroll.delta.y / PIXELS_PER_STEP,
            }
        },
        jump: keys.just_pressed(KeyCode::KeyJ),
        wave: keys.just_pressed(KeyCode::KeyH),
        act: keys.pressed(KeyCode::KeyE),
        // A click frees no cursor that looks around.
        fire: keys.pressed(KeyCode::KeyX) || looking && shoots,
        menu: keys.just_pressed(KeyCode::Escape),
        navigate: IVec2::new(
            step(
                &[KeyCode::ArrowLeft, KeyCode::KeyA],
                &[KeyCode::ArrowRight, KeyCode::KeyD],
            ),
            step(
                &[KeyCode::ArrowUp, KeyCode::KeyW],
                &[KeyCode::ArrowDown, KeyCode::KeyS],
            ),
        ),
        confirm: keys.any_just_pressed([KeyCode::Enter, KeyCode::Space]),
        switch_follow: keys.just_pressed(KeyCode::KeyC),
        switch_mode: keys.just_pressed(KeyCode::KeyM),
        switch_metric: keys.just_pressed(KeyCode::KeyN),
        switch_lines: keys.just_pressed(KeyCode::KeyL),
        switch_fill: keys.just_pressed(KeyCode::KeyF),
        switch_focus: keys.just_pressed(KeyCode::Tab),
        switch_shapes: keys.just_pressed(KeyCode::KeyB),
        switch_torch: keys.just_pressed(KeyCode::KeyT),
        switch_renderer: keys.just_pressed(KeyCode::KeyR),
        switch_vegetation: keys.just_pressed(KeyCode::KeyV),
        switch_keys: keys.just_pressed(KeyCode::F1),
        resolution_steps: i32::from(keys.just_pressed(KeyCode::Equal))
            - i32::from(keys.just_pressed(KeyCode::Minus)),
        // It closes the inspector first.
        leave: keys.just_pressed(KeyCode::Escape)
            && !inspector.is_some_and(|inspector| inspector.is_open() || inspector.is_changed()),
    };
}

/// Adds the wishes of every gamepad to those of the keyboard.
fn read_gamepads(
    gamepads: Query<&Gamepad>,
    time: Res<Time<Real>>,
    settings: Res<Settings>,
    mut input: ResMut<PlayerInput>,
) {
    for pad in &gamepads {
        let seconds = time.delta_secs();
        let move_stick = live(pad.left_stick());
        let look_stick = live(pad.right_stick());
        let step = |minus: GamepadButton, plus: GamepadButton| {
            f32::from(pad.pressed(plus)) - f32::from(pad.pressed(minus))
        };
        let rise = step(GamepadButton::LeftTrigger, GamepadButton::RightTrigger);
        input.fly = (input.fly + Vec3::new(move_stick.x, rise, move_stick.y))
            .clamp(Vec3::NEG_ONE, Vec3::ONE);
        input.walk = (input.walk
            + Vec2::new(
                step(GamepadButton::DPadLeft, GamepadButton::DPadRight),
                step(GamepadButton::DPadDown, GamepadButton::DPadUp),
            ))
        .clamp(Vec2::NEG_ONE, Vec2::ONE);
        if pad.pressed(GamepadButton::LeftTrigger2) {
            input.zoom += look_stick.y * STICK_ZOOM * seconds;
        } else {
            let pitch_sign = if settings.invert_y { -1.0 } else { 1.0 };
            input.look += Vec2::new(look_stick.x, pitch_sign * look_stick.y) * STICK_TURN * seconds;
        }
        input.fast |= pad.pressed(GamepadButton::RightTrigger2);
        let pressed = |minus: GamepadButton, plus: GamepadButton| {
            i32::from(pad.just_pressed(plus)) - i32::from(pad.just_pressed(minus))
        };
        input.navigate += IVec2::new(
            pressed(GamepadButton::DPadLeft, GamepadButton::DPadRight),
            pressed(GamepadButton::DPadUp, GamepadButton::DPadDown),
        );
        input.act |= pad.pressed(GamepadButton::South);
        input.fire |= pad.pressed(GamepadButton::West);
        input.confirm |= pad.just_pressed(GamepadButton::South);
        input.menu |= pad.just_pressed(GamepadButton::Start);
        input.jump |= pad.just_pressed(GamepadButton::East);
        input.wave |= pad.just_pressed(GamepadButton::RightThumb);
        input.switch_follow |= pad.just_pressed(GamepadButton::LeftThumb);
        input.switch_lines |= pad.just_pressed(GamepadButton::West);
        input.switch_fill |= pad.just_pressed(GamepadButton::North);
        input.switch_focus |= pad.just_pressed(GamepadButton::South);
        input.switch_keys |= pad.just_pressed(GamepadButton::Start);
        input.leave |= pad.just_pressed(GamepadButton::Select);
    }
}

/// Leaves of the wishes what they mean now.
fn mean(mode: Res<InputMode>, mut input: ResMut<PlayerInput>) {
    *input = meant(*mode, *input);
}

fn meant(mode: InputMode, input: PlayerInput) -> PlayerInput {
    match mode {
        InputMode::Explore => PlayerInput {
            act: false,
            fire: false,
            menu: false,
            navigate: IVec2::ZERO,
            confirm: false,
            ..input
        },
        // Buttons of a gamepad that act are no switches meanwhile.
        InputMode::Play => PlayerInput {
            switch_lines: false,
            switch_fill: false,
            switch_focus: false,
            switch_follow: false,
            switch_keys: input.switch_keys && !input.menu,
            leave: false,
            ..input
        },
        InputMode::Menu => PlayerInput {
            menu: input.menu,
            navigate: input.navigate,
            confirm: input.confirm,
            ..default()
        },
    }
}

/// A stick outside its dead zone, squared in length for fine control near the middle.
fn live(stick: Vec2) -> Vec2 {
    let length = stick.length();
    if length < DEAD_ZONE {
        Vec2::ZERO
    } else {
        stick * length.min(1.0)
    }
}

fn take_cursor(mut cursor: Single<&mut CursorOptions, With<PrimaryWindow>>) {
    grab(&mut cursor, true);
}

/// The right mouse button frees the cursor and takes it again; a window that loses the focus
/// frees it.
fn free_or_take_cursor(
    buttons: Res<ButtonInput<MouseButton>>,
    window: Single<(&Window, &mut CursorOptions), With<PrimaryWindow>>,
) {
    let (window, mut cursor) = window.into_inner();
    let grabbed = cursor.grab_mode != CursorGrabMode::None;
    if buttons.just_pressed(MouseButton::Right) {
        grab(&mut cursor, !grabbed);
    } else if grabbed && !window.focused {
        grab(&mut cursor, false);
    }
}

/// While the inspector is open the cursor is its.
fn lend_cursor(
    inspector: Res<Inspector>,
    mut cursor: Single<&mut CursorOptions, With<PrimaryWindow>>,
) {
    grab(&mut cursor, !inspector.is_open());
}

fn grab(cursor: &mut CursorOptions, take: bool) {
    cursor.visible = !take;
    // X11 knows no lock; winit falls back to confining the cursor there.
    cursor.grab_mode = if take {
        CursorGrabMode::Locked
    } else {
        CursorGrabMode::None
    };
}

fn leave(input: Res<PlayerInput>, mut exit: MessageWriter<AppExit>) {
    if input.leave {
        exit.write(AppExit::Success);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn app() -> App {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, bevy::input::InputPlugin))
            .init_resource::<PlayerInput>()
            .init_resource::<Settings>()
            .add_systems(
                PreUpdate,
                (read_keyboard_and_mouse, read_gamepads)
                    .chain()
                    .after(InputSystems),
            );
        app
    }

    fn press(app: &mut App, keys: &[KeyCode]) {
        let mut buttons = app.world_mut().resource_mut::<ButtonInput<KeyCode>>();
        for key in keys {
            buttons.press(*key);
        }
    }

    #[test]
    fn keys_become_wishes_and_opposites_cancel() {
        let mut app = app();
        press(
            &mut app,
            &[
                KeyCode::KeyW,
                KeyCode::KeyA,
                KeyCode::KeyD,
                KeyCode::ShiftLeft,
                KeyCode::ArrowUp,
                KeyCode::ArrowRight,
                KeyCode::ControlLeft,
            ],
        );
        app.update();
        let input = *app.world().resource::<PlayerInput>();
        assert_eq!(input.fly, Vec3::new(0.0, -1.0, 1.0));
        assert_eq!(input.walk, Vec2::new(1.0, 1.0));
        assert!(input.fast);
        assert!(!input.leave && !input.switch_lines && !input.switch_fill);
    }

    #[test]
    fn without_a_grabbed_cursor_the_mouse_does_not_turn_the_view() {
        let mut app = app();
        app.world_mut()
            .write_message(bevy::input::mouse::MouseMotion {
                delta: Vec2::new(40.0, 10.0),
            });
        app.update();
        assert_eq!(
            app.world().resource::<AccumulatedMouseMotion>().delta,
            Vec2::new(40.0, 10.0)
        );
        assert_eq!(app.world().resource::<PlayerInput>().look, Vec2::ZERO);
    }

    #[test]
    fn in_a_menu_nobody_walks_and_in_a_level_escape_does_not_leave() {
        let input = PlayerInput {
            walk: Vec2::Y,
            fast: true,
            act: true,
            menu: true,
            confirm: true,
            navigate: IVec2::Y,
            leave: true,
            switch_lines: true,
            switch_torch: true,
            ..default()
        };
        let explore = meant(InputMode::Explore, input);
        assert!(explore.leave && explore.switch_lines && !explore.act && !explore.menu);
        let play = meant(InputMode::Play, input);
        assert!(play.act && play.menu && play.switch_torch && play.walk == Vec2::Y);
        assert!(!play.leave && !play.switch_lines);
        let menu = meant(InputMode::Menu, input);
        assert_eq!(
            menu,
            PlayerInput {
                menu: true,
                confirm: true,
                navigate: IVec2::Y,
                ..default()
            }
        );
    }

    #[test]
    fn a_resting_stick_is_no_wish() {
        assert_eq!(live(Vec2::new(0.08, -0.05)), Vec2::ZERO);
        assert_eq!(live(Vec2::new(1.0, 0.0)), Vec2::new(1.0, 0.0));
    }
}
