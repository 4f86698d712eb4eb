//! Plays a path: which time is shown, and when it goes on. Plain data.

use pointstage_scene::Camera;

/// What plays the path.
#[derive(Clone, Debug, Default)]
pub(crate) struct Player {
    /// The time that is shown, seconds.
    time: f64,
    is_playing: bool,
    /// When the last pass was, while it plays, seconds.
    passed_at: Option<f64>,
    /// The camera as the player left it.
    left: Option<Camera>,
    /// The camera before that: where a path without views begins.
    base: Option<Camera>,
}

impl Player {
    /// The time that is shown, seconds.
    pub(crate) fn time(&self) -> f64 {
        self.time
    }

    /// Whether it goes on by itself.
    pub(crate) fn is_playing(&self) -> bool {
        self.is_playing
    }

    /// Goes on from where it is; from the beginning if it is at the end.
    pub(crate) fn play(&mut self, duration: f64) {
        if self.time >= duration {
            self.time = 0.0;
        }
        self.is_playing = duration > 0.0;
        self.passed_at = None;
    }

    /// Stops where it is.
    pub(crate) fn pause(&mut self) {
        self.is_playing = false;
    }

    /// Shows another time.
    pub(crate) fn scrub(&mut self, time: f64) {
        self.time = time.max(0.0);
        self.passed_at = None;
    }

    /// Whether somebody else has moved the camera since the player did.
    pub(crate) fn is_overtaken(&self, camera: &Camera) -> bool {
        self.left.is_some_and(|left| left != *camera)
    }

    /// The view that a path without views begins with, where the camera is now.
    pub(crate) fn base(&mut self, camera: &Camera) -> Camera {
        if self.left.is_none_or(|left| left != *camera) {
            self.base = Some(*camera);
        }
        self.base.unwrap_or(*camera)
    }

    /// Notes where the player left the camera.
    pub(crate) fn leave(&mut self, camera: Camera) {
        self.left = Some(camera);
    }

    /// Goes on to the time of a pass at `now`, seconds.
    pub(crate) fn advance(&mut self, now: f64, duration: f64, loops: bool) {
        // The first pass only begins: what the window waited for before is not part of it.
        let passed_at = self.passed_at.replace(now).unwrap_or(now);
        self.time += (now - passed_at).max(0.0);
        if self.time < duration {
            return;
        }
        if loops && duration > 0.0 {
            self.time = self.time.rem_euclid(duration);
        } else {
            self.time = duration;
            self.is_playing = false;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_plays_to_the_end_and_again_from_the_beginning() {
        let mut player = Player::default();
        player.play(2.0);
        for (now, time) in [(10.0, 0.0), (10.5, 0.5), (11.5, 1.5), (13.0, 2.0)] {
            assert!(player.is_playing());
            player.advance(now, 2.0, false);
            assert_eq!(player.time(), time);
        }
        assert!(!player.is_playing(), "it has ended");
        player.play(2.0);
        assert_eq!((player.time(), player.is_playing()), (0.0, true));
        player.advance(50.0, 2.0, true);
        player.advance(52.5, 2.0, true);
        assert_eq!((player.time(), player.is_playing()), (0.5, true));
    }

    #[test]
    fn a_camera_moved_by_hand_is_noticed_and_becomes_the_beginning() {
        let (mut player, camera) = (Player::default(), Camera::default());
        assert!(!player.is_overtaken(&camera), "it has not begun");
        assert_eq!(player.base(&camera), camera);
        let turned = camera.turned_around(glam::DVec3::ZERO, glam::DVec3::Y, 30.0);
        player.leave(turned);
        assert_eq!(player.base(&turned), camera, "the player's own move");
        let mut by_hand = turned;
        by_hand.dolly(0.5);
        assert!(player.is_overtaken(&by_hand));
        assert_eq!(player.base(&by_hand), by_hand);
    }

    #[test]
    fn an_empty_path_does_not_play() {
        let mut player = Player::default();
        player.play(0.0);
        assert!(!player.is_playing());
    }
}
