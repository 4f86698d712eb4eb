//! Gestures over a picture in a window of their own.

use egui::{Event, Key, Modifiers, MouseWheelUnit, PointerButton, Pos2, TouchPhase, vec2};
use egui_kittest::Harness;

use super::*;
use crate::window::intent::Intent;

/// The picture's side, px.
const SIDE_PX: f32 = 400.0;

/// What the last pass did, and all that was asked for.
#[derive(Default)]
struct Seen {
    options: NavigationOptions,
    is_moving: bool,
    tool: Tool,
    rect: Option<Rect>,
    hands: Option<Hands>,
    asked: Intents,
}

impl Seen {
    fn moves(&self) -> Vec<CameraMove> {
        let moves = self.asked.iter().filter_map(|intent| match intent {
            Intent::Camera(CameraIntent::Move(camera_move)) => Some(*camera_move),
            _ => None,
        });
        moves.collect()
    }
}

fn window(scale: f32, options: NavigationOptions) -> Harness<'static, Seen> {
    let app = |ui: &mut Ui, seen: &mut Seen| {
        let size = ui.available_size();
        let (rect, response) = ui.allocate_exact_size(size, egui::Sense::click_and_drag());
        if response.clicked() {
            response.request_focus();
        }
        let picture = Gestures {
            response: &response,
            rect,
            options: &seen.options,
            is_moving: seen.is_moving,
            tool: seen.tool,
        };
        seen.rect = Some(rect);
        seen.hands = Some(gestures(ui, &picture, &mut seen.asked));
    };
    let seen = Seen {
        options,
        ..Seen::default()
    };
    let mut harness = Harness::builder()
        .with_size([SIDE_PX / scale, SIDE_PX / scale])
        .with_pixels_per_point(scale)
        .with_step_dt(1.0 / 60.0)
        .build_ui_state(app, seen);
    harness.step();
    harness
}

fn usual() -> Harness<'static, Seen> {
    window(1.0, NavigationOptions::default())
}

/// A place by its share of the picture.
fn at(harness: &Harness<'static, Seen>, x: f32, y: f32) -> Pos2 {
    let rect = harness.state().rect.expect("a pass");
    rect.min + vec2(x, y) * rect.size()
}

fn press(harness: &mut Harness<'static, Seen>, pos: Pos2, button: PointerButton, pressed: bool) {
    let modifiers = harness.ctx.input(|input| input.modifiers);
    harness.event(Event::PointerButton {
        pos,
        button,
        pressed,
        modifiers,
    });
    harness.step();
}

fn point(harness: &mut Harness<'static, Seen>, x: f32, y: f32) {
    let pos = at(harness, x, y);
    harness.event(Event::PointerMoved(pos));
    harness.step();
}

/// Drags from a third of the picture to two thirds of it, in steps.
fn drag(harness: &mut Harness<'static, Seen>, button: PointerButton) {
    point(harness, 0.3, 0.5);
    let start = at(harness, 0.3, 0.5);
    press(harness, start, button, true);
    for step in 1..=10 {
        point(harness, 0.3 + 0.04 * step as f32, 0.5);
    }
    let end = at(harness, 0.7, 0.5);
    press(harness, end, button, false);
}

fn hold(harness: &mut Harness<'static, Seen>, key: Key, pressed: bool) {
    let modifiers = harness.ctx.input(|input| input.modifiers);
    harness.event(Event::Key {
        key,
        physical_key: None,
        pressed,
        repeat: false,
        modifiers,
    });
}

fn scroll(harness: &mut Harness<'static, Seen>, unit: MouseWheelUnit, delta: egui::Vec2) {
    harness.event(Event::MouseWheel {
        unit,
        delta,
        phase: TouchPhase::Move,
        source: egui::MouseWheelSource::Unknown,
        modifiers: Modifiers::NONE,
    });
    for _ in 0..60 {
        harness.step();
    }
}

/// By how much all drags together turned, picture heights.
fn dragged(harness: &Harness<'static, Seen>) -> f64 {
    let ways = harness.state().moves().into_iter().map(|it| match it {
        CameraMove::Drag { right, .. } => right,
        _ => 0.0,
    });
    ways.sum()
}

#[test]
fn the_same_share_of_the_picture_turns_the_same_at_any_pixel_density() {
    let turned = [1.0, 2.0].map(|scale| {
        let mut harness = window(scale, NavigationOptions::default());
        drag(&mut harness, PointerButton::Primary);
        dragged(&harness)
    });
    for way in turned {
        assert!((way - 0.4).abs() < 1e-4, "{turned:?}");
    }
}

#[test]
fn buttons_and_keys_say_what_a_drag_does() {
    type Kind = fn(&Intent) -> bool;
    let pan: Kind = |it| {
        matches!(
            it,
            Intent::Camera(CameraIntent::Move(CameraMove::Pan { .. }))
        )
    };
    let turn: Kind = |it| {
        matches!(
            it,
            Intent::Camera(CameraIntent::Move(CameraMove::Drag { .. }))
        )
    };
    let roll: Kind = |it| {
        matches!(
            it,
            Intent::Camera(CameraIntent::Move(CameraMove::Roll { .. }))
        )
    };
    let light: Kind = |it| matches!(it, Intent::Light(LightIntent::Drag { .. }));
    let free = NavigationOptions {
        turntable: false,
        ..NavigationOptions::default()
    };
    let level = NavigationOptions::default();
    let (left, middle) = (PointerButton::Primary, PointerButton::Middle);
    let cases = [
        (level, left, Modifiers::NONE, None, turn),
        (level, middle, Modifiers::NONE, None, pan),
        (level, left, Modifiers::SHIFT, None, pan),
        (level, left, Modifiers::CTRL, None, turn),
        (free, left, Modifiers::CTRL, None, roll),
        (level, left, Modifiers::NONE, Some(Key::L), light),
    ];
    for (options, button, modifiers, key, is_right) in cases {
        let mut harness = window(1.0, options);
        harness.event(Event::ModifiersChanged(modifiers));
        if let Some(key) = key {
            hold(&mut harness, key, true);
        }
        drag(&mut harness, button);
        let asked = &harness.state().asked;
        assert!(
            !asked.is_empty() && asked.iter().all(is_right),
            "{button:?} {modifiers:?} {key:?}: {asked:?}"
        );
    }
}

#[test]
fn a_roll_goes_with_the_pointer_around_the_middle() {
    let free = NavigationOptions {
        turntable: false,
        ..NavigationOptions::default()
    };
    let mut harness = window(1.0, free);
    harness.event(Event::ModifiersChanged(Modifiers::CTRL));
    point(&mut harness, 0.9, 0.5);
    let start = at(&harness, 0.9, 0.5);
    press(&mut harness, start, PointerButton::Primary, true);
    for step in 1..=20 {
        // A quarter turn, clockwise: from the right to the bottom.
        let angle = std::f32::consts::FRAC_PI_2 * step as f32 / 20.0;
        point(
            &mut harness,
            0.5 + 0.4 * angle.cos(),
            0.5 + 0.4 * angle.sin(),
        );
    }
    let rolls = harness.state().moves().into_iter().map(|it| match it {
        CameraMove::Roll { roll_rad } => roll_rad,
        _ => 0.0,
    });
    let rolled: f64 = rolls.sum();
    assert!((1.4..1.6).contains(&rolled), "{rolled}");
}

#[test]
fn the_wheel_zooms_and_two_fingers_do_what_was_chosen() {
    let (line, points) = (MouseWheelUnit::Line, MouseWheelUnit::Point);
    let is_zoom = |it: &CameraMove| matches!(it, CameraMove::Zoom { .. });
    let is_drag = |it: &CameraMove| matches!(it, CameraMove::Drag { .. });
    let is_pan = |it: &CameraMove| matches!(it, CameraMove::Pan { .. });
    type Kind = fn(&CameraMove) -> bool;
    let cases: [(ScrollAction, MouseWheelUnit, Kind); 6] = [
        (ScrollAction::Zoom, line, is_zoom),
        (ScrollAction::Zoom, points, is_zoom),
        (ScrollAction::Turn, line, is_zoom),
        (ScrollAction::Turn, points, is_drag),
        (ScrollAction::Shift, line, is_zoom),
        (ScrollAction::Shift, points, is_pan),
    ];
    for (action, unit, is_right) in cases {
        let options = NavigationOptions {
            scroll: action,
            ..NavigationOptions::default()
        };
        let mut harness = window(1.0, options);
        point(&mut harness, 0.5, 0.5);
        let delta = if unit == line { 1.0 } else { 20.0 };
        scroll(&mut harness, unit, vec2(0.0, delta));
        let moves = harness.state().moves();
        assert!(
            !moves.is_empty() && moves.iter().all(is_right),
            "{action:?} {unit:?}: {moves:?}"
        );
    }
}

#[test]
fn a_tilted_wheel_shifts_sideways() {
    let mut harness = usual();
    point(&mut harness, 0.5, 0.5);
    scroll(&mut harness, MouseWheelUnit::Line, vec2(1.0, 0.0));
    let moves = harness.state().moves();
    let is_sideways =
        |it: &CameraMove| matches!(it, CameraMove::Pan { right, up } if *right > 0.0 && *up == 0.0);
    assert!(
        !moves.is_empty() && moves.iter().all(is_sideways),
        "{moves:?}"
    );
}

#[test]
fn the_right_button_flies_looks_and_changes_the_speed() {
    let mut harness = usual();
    point(&mut harness, 0.5, 0.5);
    let middle = at(&harness, 0.5, 0.5);
    press(&mut harness, middle, PointerButton::Secondary, true);
    let hands = harness.state().hands.expect("a pass");
    assert_eq!(
        (hands.interaction, hands.is_flying),
        (Interaction::HELD, true)
    );

    hold(&mut harness, Key::W, true);
    for _ in 0..3 {
        harness.step();
        let hands = harness.state().hands.expect("a pass");
        assert_eq!(hands.interaction, Interaction::MOVING);
    }
    hold(&mut harness, Key::W, false);
    harness.step();
    harness.step();
    let moves = harness.state().moves();
    let is_forward = |it: &CameraMove| matches!(it, CameraMove::Fly { right, up, forward } if *forward > 0.0 && *right == 0.0 && *up == 0.0);
    assert!(
        moves.len() >= 3 && moves.iter().all(is_forward),
        "{moves:?}"
    );
    let hands = harness.state().hands.expect("a pass");
    assert_eq!(
        hands.interaction,
        Interaction::HELD,
        "nothing is held but the button"
    );

    harness.state_mut().asked = Intents::new();
    point(&mut harness, 0.6, 0.5);
    let moves = harness.state().moves();
    assert!(
        matches!(moves[..], [CameraMove::Look { right, .. }] if (right - 0.1).abs() < 0.02),
        "{moves:?}"
    );
    harness.state_mut().asked = Intents::new();
    scroll(&mut harness, MouseWheelUnit::Line, vec2(0.0, 1.0));
    let is_speed =
        |it: &Intent| matches!(it, Intent::Camera(CameraIntent::FlySpeed(factor)) if *factor > 1.0);
    let asked = &harness.state().asked;
    assert!(!asked.is_empty() && asked.iter().all(is_speed), "{asked:?}");

    let there = at(&harness, 0.6, 0.5);
    press(&mut harness, there, PointerButton::Secondary, false);
    harness.step();
    let hands = harness.state().hands.expect("a pass");
    assert_eq!(
        (hands.interaction, hands.is_flying),
        (Interaction::STILL, false)
    );
}

#[test]
fn the_way_to_where_the_right_button_goes_down_does_not_look() {
    let mut harness = usual();
    point(&mut harness, 0.1, 0.1);
    let middle = at(&harness, 0.5, 0.5);
    // In one pass with the press, as on a slow machine.
    harness.input_mut().events.push(Event::PointerMoved(middle));
    press(&mut harness, middle, PointerButton::Secondary, true);
    let moves = harness.state().moves();
    assert!(moves.is_empty(), "{moves:?}");
}

#[test]
fn letters_alone_do_not_fly() {
    let mut harness = usual();
    point(&mut harness, 0.5, 0.5);
    hold(&mut harness, Key::W, true);
    harness.step();
    harness.step();
    assert!(
        harness.state().asked.is_empty(),
        "{:?}",
        harness.state().asked
    );
}

fn glides(harness: &Harness<'static, Seen>) -> usize {
    let asked = harness.state().asked.iter();
    asked
        .filter(|it| matches!(it, Intent::Camera(CameraIntent::Glide(_))))
        .count()
}

#[test]
fn a_drag_glides_on_only_with_inertia_and_in_motion() {
    let inertia = NavigationOptions {
        inertia: true,
        ..NavigationOptions::default()
    };
    let mut harness = usual();
    drag(&mut harness, PointerButton::Primary);
    assert_eq!(glides(&harness), 0, "inertia is off at first");

    let mut harness = window(1.0, inertia);
    drag(&mut harness, PointerButton::Primary);
    assert_eq!(glides(&harness), 1, "{:?}", harness.state().asked);

    let mut harness = window(1.0, inertia);
    point(&mut harness, 0.3, 0.5);
    let start = at(&harness, 0.3, 0.5);
    press(&mut harness, start, PointerButton::Primary, true);
    point(&mut harness, 0.7, 0.5);
    for _ in 0..20 {
        harness.step();
    }
    let end = at(&harness, 0.7, 0.5);
    press(&mut harness, end, PointerButton::Primary, false);
    assert_eq!(glides(&harness), 0, "the pointer had rested");
}

#[test]
fn a_press_stops_what_moves_by_itself() {
    let mut harness = usual();
    harness.state_mut().is_moving = true;
    point(&mut harness, 0.5, 0.5);
    let hands = harness.state().hands.expect("a pass");
    assert_eq!(hands.interaction, Interaction::MOVING, "it moves by itself");
    let middle = at(&harness, 0.5, 0.5);
    press(&mut harness, middle, PointerButton::Primary, true);
    let stop = Intent::Camera(CameraIntent::Stop);
    assert_eq!(*harness.state().asked, [stop]);
}
