//! Which of the two chosen renderers draws: the preview while things move, the main one when they are still.

use std::time::{Duration, Instant};

use pointstage_engine::stage::Role;
use pointstage_plugin_api::abi::Interaction;
use pointstage_scene::{Camera, Lights};

use super::session::{Pane, ViewOptions};

/// How long nothing may have moved before the main renderer takes over: longer than the pause between two notches of a
/// wheel, so that a slow main renderer does not come between them.
const SETTLE: Duration = Duration::from_millis(150);

/// The same while the button is still down: it will move again soon.
const SETTLE_HELD: Duration = Duration::from_millis(500);

/// What decides between the main and the preview renderer.
#[derive(Debug, Default)]
pub(crate) struct Roles {
    /// The preview was called by hand, and stays until it is sent away.
    is_held: bool,
    seen: Option<Movable>,
    moved_at: Option<Instant>,
    drawing: Option<Role>,
    /// Since when the main renderer is awaited, and its picture is not there yet.
    awaited_since: Option<Instant>,
    hand_over: Option<Duration>,
}

/// What moves: the camera, and what sliders change whatever the renderer. A change of the main renderer's own settings is
/// not among them: only the main renderer can show it.
#[derive(Clone, Debug, PartialEq)]
struct Movable {
    camera: Camera,
    lights: Lights,
    view: ViewOptions,
}

impl Roles {
    /// Calls the preview by hand, or sends it away.
    pub(crate) fn toggle_by_hand(&mut self) {
        self.is_held = !self.is_held;
    }

    /// Whether the preview was called by hand.
    pub(crate) fn is_held(&self) -> bool {
        self.is_held
    }

    /// Who draws now. Called once a pass. `is_pressed` says that a pointer's button is down somewhere.
    pub(crate) fn choose(
        &mut self,
        pane: &Pane,
        interaction: Interaction,
        is_pressed: bool,
        now: Instant,
    ) -> Role {
        let movable = Movable {
            camera: pane.camera,
            lights: pane.lights.clone(),
            view: pane.view.clone(),
        };
        let camera_moves = interaction == Interaction::MOVING;
        let slider_moves = is_pressed && self.seen.as_ref().is_some_and(|seen| *seen != movable);
        if camera_moves || slider_moves {
            self.moved_at = Some(now);
        }
        self.seen = Some(movable);
        let settle = if is_pressed { SETTLE_HELD } else { SETTLE };
        if self.moved_at.is_some_and(|at| now >= at + settle) {
            self.moved_at = None;
        }
        let role = match (&pane.preview, self.is_held || self.moved_at.is_some()) {
            (Some(_), true) => Role::Preview,
            _ => Role::Main,
        };
        if self.drawing == Some(Role::Preview) && role == Role::Main {
            self.awaited_since = Some(now);
        } else if role == Role::Preview {
            self.awaited_since = None;
        }
        self.drawing = Some(role);
        role
    }

    /// Notes that the main renderer's picture is there. True if it takes over from the preview's.
    pub(crate) fn main_is_there(&mut self, now: Instant) -> bool {
        let Some(since) = self.awaited_since.take() else {
            return false;
        };
        self.hand_over = Some(now - since);
        true
    }

    /// Whether something moved a moment ago.
    pub(crate) fn is_moving(&self) -> bool {
        self.moved_at.is_some()
    }

    /// How long the last hand-over took: from the decision to the main renderer's picture.
    pub(crate) fn hand_over(&self) -> Option<Duration> {
        self.hand_over
    }

    /// When to look again although nothing happens: the preview may have to go by then.
    pub(crate) fn next_change(&self, now: Instant) -> Option<Duration> {
        let at = self.moved_at?;
        let due = (at + SETTLE).saturating_duration_since(now);
        // While a button is down that time may have passed; look again a little later.
        Some(due.max(Duration::from_millis(20)))
    }

    /// Whether the preview draws, or the main renderer's picture is awaited.
    pub(crate) fn is_under_way(&self) -> bool {
        self.moved_at.is_some() && self.drawing == Some(Role::Preview)
            || self.awaited_since.is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pane(preview: Option<&str>) -> Pane {
        Pane {
            preview: preview.map(Into::into),
            ..Pane::new("main".into())
        }
    }

    #[test]
    fn the_preview_stands_in_until_the_camera_has_been_still_for_a_while() {
        let (mut roles, pane) = (Roles::default(), pane(Some("fast")));
        let start = Instant::now();
        let at = |millis| start + Duration::from_millis(millis);
        let still = Interaction::STILL;
        assert_eq!(roles.choose(&pane, still, false, at(0)), Role::Main);
        let moving = Interaction::MOVING;
        assert_eq!(roles.choose(&pane, moving, true, at(10)), Role::Preview);
        assert_eq!(roles.choose(&pane, still, false, at(20)), Role::Preview);
        assert!(roles.next_change(at(20)).is_some_and(|time| time <= SETTLE));
        assert_eq!(roles.choose(&pane, still, false, at(159)), Role::Preview);
        assert_eq!(roles.choose(&pane, still, false, at(160)), Role::Main);
        assert!(roles.is_under_way());
        assert!(roles.main_is_there(at(200)));
        assert_eq!(roles.hand_over(), Some(Duration::from_millis(40)));
        assert!(!roles.main_is_there(at(210)), "it took over once");
        assert_eq!(roles.next_change(at(210)), None);
        assert!(!roles.is_under_way());
    }

    #[test]
    fn a_slider_that_is_dragged_calls_the_preview_and_a_typed_value_does_not() {
        let (mut roles, mut pane) = (Roles::default(), pane(Some("fast")));
        let now = Instant::now();
        let still = Interaction::STILL;
        roles.choose(&pane, still, false, now);
        pane.view.exposure = 2.0;
        assert_eq!(roles.choose(&pane, still, false, now), Role::Main);
        pane.view.exposure = 3.0;
        assert_eq!(roles.choose(&pane, still, true, now), Role::Preview);
    }

    #[test]
    fn settings_of_the_main_renderer_are_shown_by_the_main_renderer() {
        let (mut roles, mut pane) = (Roles::default(), pane(Some("fast")));
        let now = Instant::now();
        roles.choose(&pane, Interaction::STILL, true, now);
        pane.settings.entry("main".into()).or_default().insert(
            "size".into(),
            pointstage_engine::stage::SettingValue::Float(3.0),
        );
        let role = roles.choose(&pane, Interaction::STILL, true, now);
        assert_eq!(role, Role::Main);
    }

    #[test]
    fn by_hand_the_preview_stays_until_it_is_sent_away() {
        let (mut roles, pane) = (Roles::default(), pane(Some("fast")));
        let now = Instant::now();
        let role = |roles: &mut Roles| roles.choose(&pane, Interaction::STILL, false, now);
        roles.toggle_by_hand();
        assert_eq!(role(&mut roles), Role::Preview);
        assert_eq!(role(&mut roles), Role::Preview);
        roles.toggle_by_hand();
        assert_eq!(role(&mut roles), Role::Main);
    }

    #[test]
    fn without_a_preview_the_main_renderer_draws_what_moves() {
        let (mut roles, pane) = (Roles::default(), pane(None));
        let role = roles.choose(&pane, Interaction::MOVING, true, Instant::now());
        assert_eq!(role, Role::Main);
        assert!(!roles.is_under_way());
    }
}
