//! What pointer and keys do over the picture, as intents.
//!
//! Ways are measured in heights of the picture, in the toolkit's points: the same share of the view does the same on every
//! screen, however fine its pixels are.

use egui::{Event, EventFilter, Key, Modifiers, MouseWheelUnit, PointerButton, Rect, Response, Ui};
use pointstage_plugin_api::abi::Interaction;

use super::fly::FlyKeys;
use super::trail::Trail;
use super::{CameraMove, Glide, GlideKind, NavigationOptions, ScrollAction};
use crate::window::intent::{CameraIntent, Intents, LightIntent};
use crate::window::selecting::Tool;

/// One arrow key turns by 5°.
const KEY_TURN_RAD: f64 = 0.087_266;

/// One arrow key with Shift shifts by this part of the picture's height.
const KEY_SHIFT: f64 = 0.05;

/// One notch of the wheel (50 points) brings the scene 1.25 times nearer: exp(50 · 0.00446).
const ZOOM_PER_POINT: f64 = 0.004_46;

/// One press of + or − sees this many times as much.
const ZOOM_PER_KEY: f64 = 1.25;

/// The picture, and what the gestures over it depend on.
pub(crate) struct Gestures<'a> {
    /// The picture's answer to the pointer.
    pub(crate) response: &'a Response,
    /// Its place, points.
    pub(crate) rect: Rect,
    /// The user's habits.
    pub(crate) options: &'a NavigationOptions,
    /// Whether the camera moves by itself.
    pub(crate) is_moving: bool,
    /// What a left drag does.
    pub(crate) tool: Tool,
}

/// What the hands do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hands {
    /// What a renderer is told of it.
    pub(crate) interaction: Interaction,
    /// Whether the right button is held: letters fly.
    pub(crate) is_flying: bool,
}

/// Reads this pass' gestures.
pub(crate) fn gestures(ui: &Ui, gestures: &Gestures<'_>, out: &mut Intents) -> Hands {
    let response = gestures.response;
    let is_held = response.is_pointer_button_down_on();
    let is_flying = is_held && ui.input(|input| input.pointer.secondary_down());
    if is_held && gestures.is_moving && ui.input(|input| input.pointer.any_pressed()) {
        out.push(CameraIntent::Stop);
    }
    let asked_before = out.len();
    if is_flying {
        gestures.fly(ui, out);
    } else {
        gestures.drag(ui, out);
        gestures.wheel(ui, out);
    }
    if response.has_focus() {
        key_moves(ui, response.id, out);
    }
    gestures.let_go(ui, out);
    let interaction = if out.len() > asked_before || gestures.is_moving {
        Interaction::MOVING
    } else if is_flying || (response.dragged() && !gestures.is_selecting()) {
        Interaction::HELD
    } else {
        Interaction::STILL
    };
    Hands {
        interaction,
        is_flying,
    }
}

fn moved(camera_move: CameraMove) -> CameraIntent {
    CameraIntent::Move(camera_move)
}

impl Gestures<'_> {
    /// Whether a left drag is under way or ending that selects.
    fn is_selecting(&self) -> bool {
        let response = self.response;
        let is_left = response.dragged_by(PointerButton::Primary)
            || response.drag_stopped_by(PointerButton::Primary);
        self.tool != Tool::Navigate && is_left
    }

    /// Points as picture heights, x right and y up.
    fn heights(&self, points: egui::Vec2) -> [f64; 2] {
        let height = f64::from(self.rect.height().max(1.0));
        [f64::from(points.x) / height, -f64::from(points.y) / height]
    }

    /// Left drag turns, middle drag and Shift+left drag shift, Ctrl+left drag rolls a free scene, L+left drag moves a light.
    fn drag(&self, ui: &Ui, out: &mut Intents) {
        let delta = self.response.drag_delta();
        if delta == egui::Vec2::ZERO || self.is_selecting() {
            return;
        }
        let [right, up] = self.heights(delta);
        let modifiers = ui.input(|input| input.modifiers);
        let is_left = self.response.dragged_by(PointerButton::Primary);
        if is_left && is_light_key_down(ui) {
            out.push(LightIntent::Drag { right, up });
        } else if self.response.dragged_by(PointerButton::Middle) || (is_left && modifiers.shift) {
            out.push(moved(CameraMove::Pan { right, up }));
        } else if is_left && modifiers.ctrl && !self.options.turntable {
            let roll_rad = self.angle_gone(ui, delta);
            out.push(moved(CameraMove::Roll { roll_rad }));
        } else if is_left {
            out.push(moved(CameraMove::Drag { right, up }));
        }
    }

    /// The angle by which the pointer went around the picture's middle, clockwise.
    fn angle_gone(&self, ui: &Ui, delta: egui::Vec2) -> f64 {
        let Some(now) = ui.input(|input| input.pointer.latest_pos()) else {
            return 0.0;
        };
        let arm = now - self.rect.center();
        // Points have y downwards, so angles grow clockwise.
        let gone = f64::from(arm.angle()) - f64::from((arm - delta).angle());
        let half_turn = std::f64::consts::PI;
        (gone + half_turn).rem_euclid(2.0 * half_turn) - half_turn
    }

    /// The wheel and the pinch zoom to the pointer; two fingers do what the user chose. With L they push a light away.
    fn wheel(&self, ui: &Ui, out: &mut Intents) {
        let Some(pointer) = self.response.hover_pos() else {
            return;
        };
        let has_fingers = scrolls_smoothly(ui, self.response.id);
        let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta(), input.zoom_delta()));
        if is_light_key_down(ui) && scroll.y != 0.0 {
            let part = f64::from(scroll.y) * ZOOM_PER_POINT;
            out.push(LightIntent::Push(part));
            return;
        }
        let [right, up] = self.heights(scroll);
        match self.options.scroll {
            ScrollAction::Turn if has_fingers && scroll != egui::Vec2::ZERO => {
                out.push(moved(CameraMove::Drag { right, up }));
            }
            ScrollAction::Shift if has_fingers && scroll != egui::Vec2::ZERO => {
                out.push(moved(CameraMove::Pan { right, up }));
            }
            // A wheel that is tilted, or Shift; fingers that zoom are never quite straight.
            _ if scroll.x.abs() > scroll.y.abs() => {
                out.push(moved(CameraMove::Pan { right, up: 0.0 }));
            }
            _ => self.zoom(pointer, (-f64::from(scroll.y) * ZOOM_PER_POINT).exp(), out),
        }
        if pinch != 1.0 {
            self.zoom(pointer, 1.0 / f64::from(pinch), out);
        }
    }

    fn zoom(&self, pointer: egui::Pos2, factor: f64, out: &mut Intents) {
        if factor == 1.0 {
            return;
        }
        let [right, up] = self.heights(pointer - self.rect.center());
        out.push(moved(CameraMove::Zoom { factor, right, up }));
    }

    /// With the right button held the pointer looks around, letters move the eye, and the wheel sets the speed.
    fn fly(&self, ui: &Ui, out: &mut Intents) {
        let (delta, scroll, keys, secs) = ui.input(|input| {
            let scroll = input.smooth_scroll_delta().y;
            let secs = f64::from(input.stable_dt);
            // The way to where the button went down is no way to look.
            let delta = if input.pointer.any_pressed() {
                egui::Vec2::ZERO
            } else {
                input.pointer.delta()
            };
            (delta, scroll, FlyKeys::held(input), secs)
        });
        if delta != egui::Vec2::ZERO {
            let [right, up] = self.heights(delta);
            out.push(moved(CameraMove::Look { right, up }));
        }
        if scroll != 0.0 {
            let factor = (f64::from(scroll) * ZOOM_PER_POINT).exp();
            out.push(CameraIntent::FlySpeed(factor));
        }
        if let Some(step) = keys.step(self.options.fly_speed, secs) {
            out.push(moved(step));
            // On and on, while a key is held.
            ui.ctx().request_repaint();
        }
    }

    /// A drag that ends in motion glides on, where the user likes that.
    fn let_go(&self, ui: &Ui, out: &mut Intents) {
        let is_left = self.response.drag_stopped_by(PointerButton::Primary);
        let is_middle = self.response.drag_stopped_by(PointerButton::Middle);
        let velocity = self.velocity(ui);
        let glides = self.options.inertia && !self.is_selecting() && !is_light_key_down(ui);
        if !(glides && (is_left || is_middle)) {
            return;
        }
        let modifiers = ui.input(|input| input.modifiers);
        let kind = if is_middle || modifiers.shift {
            GlideKind::Pan
        } else if modifiers.ctrl && !self.options.turntable {
            // A roll stops where it is.
            return;
        } else {
            GlideKind::Turn
        };
        if let Some(glide) = Glide::from_release(kind, self.heights(velocity)) {
            out.push(CameraIntent::Glide(glide));
        }
    }

    /// How fast the pointer goes in a drag, points a second.
    fn velocity(&self, ui: &Ui) -> egui::Vec2 {
        let id = self.response.id.with("trail");
        if !self.response.dragged() && !self.response.drag_stopped() {
            ui.data_mut(|data| data.remove::<Trail>(id));
            return egui::Vec2::ZERO;
        }
        let (now, at) = ui.input(|input| (input.time, input.pointer.latest_pos()));
        ui.data_mut(|data| {
            let trail = data.get_temp_mut_or_default::<Trail>(id);
            if let Some(at) = at {
                trail.add(now, at);
            }
            trail.velocity()
        })
    }
}

/// L without Ctrl or Alt, with which it is a command.
fn is_light_key_down(ui: &Ui) -> bool {
    ui.input(|input| {
        let modifiers = input.modifiers;
        input.key_down(Key::L) && !(modifiers.ctrl || modifiers.command || modifiers.alt)
    })
}

/// Whether what scrolls are fingers: a wheel goes by whole lines, a trackpad by pixels or parts of a line. The toolkit goes on
/// scrolling for some passes after an event, so the last one is remembered.
fn scrolls_smoothly(ui: &Ui, id: egui::Id) -> bool {
    let newest = ui.input(|input| {
        let is_smooth = |event: &Event| match event {
            Event::MouseWheel { unit, delta, .. } => Some(match unit {
                MouseWheelUnit::Point => true,
                MouseWheelUnit::Line => delta.x.fract() != 0.0 || delta.y.fract() != 0.0,
                MouseWheelUnit::Page => false,
            }),
            _ => None,
        };
        input.events.iter().rev().find_map(is_smooth)
    });
    let id = id.with("scrolls smoothly");
    ui.data_mut(|data| match newest {
        Some(is_smooth) => {
            data.insert_temp(id, is_smooth);
            is_smooth
        }
        None => data.get_temp(id).unwrap_or(false),
    })
}

/// Arrow keys turn, with Shift they shift; + and − zoom.
fn key_moves(ui: &Ui, id: egui::Id, out: &mut Intents) {
    let filter = EventFilter {
        horizontal_arrows: true,
        vertical_arrows: true,
        ..EventFilter::default()
    };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(id, filter));
    let arrows = [
        (Key::ArrowLeft, -1.0, 0.0),
        (Key::ArrowRight, 1.0, 0.0),
        (Key::ArrowUp, 0.0, 1.0),
        (Key::ArrowDown, 0.0, -1.0),
    ];
    for (key, right, up) in arrows {
        if ui.input_mut(|input| input.consume_key(Modifiers::SHIFT, key)) {
            out.push(moved(CameraMove::Pan {
                right: right * KEY_SHIFT,
                up: up * KEY_SHIFT,
            }));
        } else if ui.input_mut(|input| input.consume_key(Modifiers::NONE, key)) {
            out.push(moved(CameraMove::Turn {
                yaw_rad: right * KEY_TURN_RAD,
                pitch_rad: up * KEY_TURN_RAD,
            }));
        }
    }
    let zooms = [
        (Key::Plus, 1.0 / ZOOM_PER_KEY),
        (Key::Equals, 1.0 / ZOOM_PER_KEY),
        (Key::Minus, ZOOM_PER_KEY),
    ];
    for (key, factor) in zooms {
        if ui.input(|input| input.key_pressed(key) && input.modifiers.is_none()) {
            out.push(moved(CameraMove::Zoom {
                factor,
                right: 0.0,
                up: 0.0,
            }));
        }
    }
}

#[cfg(test)]
#[path = "gestures_tests.rs"]
mod tests;
