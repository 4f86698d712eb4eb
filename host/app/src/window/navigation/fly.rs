//! Flying: the keys that are held while the right button is, and the way that they make.

use egui::{Context, Event, InputState, Key};
use glam::DVec3;

use super::moves::CameraMove;

/// Speed of flying, radii of the scene a second: through the whole scene in 4 s.
const RADII_PER_SECOND: f64 = 0.5;

/// With Shift it goes this much faster.
const FAST: f64 = 4.0;

/// The longest pass that counts in full, seconds: after a stall the eye must not be somewhere else.
const LONGEST_PASS_SECS: f64 = 0.25;

/// The keys that fly.
const KEYS: [Key; 6] = [Key::W, Key::A, Key::S, Key::D, Key::Q, Key::E];

/// Takes this pass' presses of the keys that fly, so that they ask for nothing else. What is held stays held.
pub(crate) fn take_flying_keys(ctx: &Context) {
    ctx.input_mut(|input| {
        let is_command = input.modifiers.command || input.modifiers.ctrl || input.modifiers.alt;
        input.events.retain(|event| {
            let flies = matches!(event, Event::Key { key, .. } if KEYS.contains(key));
            !flies || is_command
        });
    });
}

/// Which way the keys say; each of the three −1, 0 or 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct FlyKeys {
    /// D against A.
    pub(super) right: f64,
    /// E against Q.
    pub(super) up: f64,
    /// W against S.
    pub(super) forward: f64,
    /// Shift.
    pub(super) is_fast: bool,
}

impl FlyKeys {
    /// What is held now. Keys with Ctrl or Alt are commands and move nothing.
    pub(super) fn held(input: &InputState) -> Self {
        if input.modifiers.command || input.modifiers.ctrl || input.modifiers.alt {
            return Self::default();
        }
        let between = |plus: Key, minus: Key| {
            f64::from(u8::from(input.key_down(plus))) - f64::from(u8::from(input.key_down(minus)))
        };
        Self {
            right: between(Key::D, Key::A),
            up: between(Key::E, Key::Q),
            forward: between(Key::W, Key::S),
            is_fast: input.modifiers.shift,
        }
    }

    /// The way of `secs` at `speed` times the usual; `None` if no key is held.
    pub(super) fn step(self, speed: f64, secs: f64) -> Option<CameraMove> {
        let way = DVec3::new(self.right, self.up, self.forward).try_normalize()?;
        let pace = if self.is_fast { FAST } else { 1.0 };
        let secs = secs.clamp(0.0, LONGEST_PASS_SECS);
        let way = way * (RADII_PER_SECOND * speed * pace * secs);
        Some(CameraMove::Fly {
            right: way.x,
            up: way.y,
            forward: way.z,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::navigation::Surroundings;
    use pointstage_scene::{Bounds, Camera};

    const FORWARD: FlyKeys = FlyKeys {
        right: 0.0,
        up: 0.0,
        forward: 1.0,
        is_fast: false,
    };

    /// Where the eye is after two seconds of flying in a scene of some size.
    fn flown(keys: FlyKeys, passes_per_second: u32, size: f64) -> DVec3 {
        let around = Surroundings {
            bounds: Bounds::new(DVec3::splat(-size), DVec3::splat(size)),
            framed: Bounds::new(DVec3::splat(-size), DVec3::splat(size)),
            ..Surroundings::default()
        };
        let mut camera = Camera::default();
        for _ in 0..2 * passes_per_second {
            let step = keys.step(1.0, 1.0 / f64::from(passes_per_second));
            step.expect("a key is held").apply(&mut camera, &around);
        }
        camera.eye
    }

    #[test]
    fn the_way_does_not_depend_on_the_number_of_passes() {
        let expected = flown(FORWARD, 60, 1.0);
        for passes in [5, 7, 24, 144] {
            let eye = flown(FORWARD, passes, 1.0);
            assert!(eye.distance(expected) < 1e-9, "{eye} at {passes} a second");
        }
    }

    #[test]
    fn the_speed_goes_with_the_scene_s_size_and_with_shift() {
        let start = Camera::default().eye;
        let way = flown(FORWARD, 60, 1.0).distance(start);
        let in_a_large_scene = flown(FORWARD, 60, 1000.0).distance(start);
        assert!((in_a_large_scene / way - 1000.0).abs() < 1e-6);
        let fast = FlyKeys {
            is_fast: true,
            ..FORWARD
        };
        assert!((flown(fast, 60, 1.0).distance(start) / way - FAST).abs() < 1e-9);
    }

    #[test]
    fn opposite_keys_and_no_keys_move_nothing() {
        assert_eq!(FlyKeys::default().step(1.0, 0.1), None);
    }
}
