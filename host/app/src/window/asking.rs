//! When to ask the stage for a picture, and for which.

use std::sync::Arc;
use std::time::Duration;

use pointstage_engine::stage::{FrameRequest, Patience, Role, SettingValues, ViewportId};
use pointstage_plugin_api::abi::{Interaction, Purpose};
use pointstage_scene::{Camera, Lights, Revision, Scene};

use super::session::{Pane, ViewOptions};

/// Who is to draw, how large, and what for.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Wish {
    /// The renderer's id.
    pub(crate) renderer: String,
    /// Whether it stands in or stays.
    pub(crate) role: Role,
    /// Size of the picture, px.
    pub(crate) size_px: [u32; 2],
    /// What the user does.
    pub(crate) interaction: Interaction,
    /// How long the renderer may take, if it can stop in time.
    pub(crate) time_budget: Option<Duration>,
    /// Targets whose values are wanted beside the picture.
    pub(crate) read_back: Vec<String>,
}

/// All that a picture depends on, comparable: the same look needs no new picture.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Look {
    scene: Revision,
    marks: Revision,
    camera: Camera,
    lights: Lights,
    structure: Option<String>,
    settings: SettingValues,
    structure_settings: SettingValues,
    view: ViewOptions,
    wish: Wish,
}

/// Remembers what was asked for last.
#[derive(Debug, Default)]
pub(crate) struct Asking {
    last: Option<Look>,
    pressed: Vec<String>,
    is_stale: bool,
}

impl Asking {
    /// Notes that an action was pressed; the next request tells the renderer.
    pub(crate) fn press(&mut self, action: String) {
        self.pressed.push(action);
    }

    /// Makes the next look count as new: the stage can do now what it could not.
    pub(crate) fn invalidate(&mut self) {
        self.is_stale = true;
    }

    /// Whether the next picture is wanted whatever the limit on the rate says.
    pub(crate) fn is_urgent(&self) -> bool {
        self.is_stale || self.last.is_none()
    }

    /// What was asked for last.
    pub(crate) fn last_wish(&self) -> Option<&Wish> {
        self.last.as_ref().map(|look| &look.wish)
    }

    /// Whether a picture is needed: something changed, an action was pressed, or a picture has just arrived that was not the
    /// final one of its look (`refine`).
    pub(crate) fn is_due(&self, look: &Look, refine: bool) -> bool {
        let is_new = self.last.as_ref() != Some(look);
        is_new || self.is_stale || refine || !self.pressed.is_empty()
    }

    /// The request for a picture of this look, which counts as asked for from now on.
    pub(crate) fn request(
        &mut self,
        look: Look,
        scene: &Arc<Scene>,
        viewport: ViewportId,
    ) -> FrameRequest {
        self.is_stale = false;
        let actions = std::mem::take(&mut self.pressed);
        let request = FrameRequest {
            viewport,
            ..look.request(scene, actions)
        };
        self.last = Some(look);
        request
    }
}

impl Look {
    /// A view as `wish` would have it drawn.
    pub(crate) fn new(scene: &Scene, pane: &Pane, wish: Wish) -> Self {
        let structure = pane.structure.as_ref();
        Self {
            scene: scene.revision(),
            marks: scene.marks_revision(),
            camera: pane.camera,
            lights: pane.lights.clone(),
            structure: pane.structure.clone(),
            settings: pane.settings_of(&wish.renderer),
            structure_settings: structure
                .map_or_else(SettingValues::new, |structure| pane.settings_of(structure)),
            view: pane.view.clone(),
            wish,
        }
    }

    fn request(&self, scene: &Arc<Scene>, actions: Vec<String>) -> FrameRequest {
        let Self {
            lights,
            structure,
            settings,
            structure_settings,
            view,
            wish,
            ..
        } = self;
        FrameRequest {
            lights: lights.clone(),
            structure: structure.clone(),
            settings: settings.clone(),
            structure_settings: structure_settings.clone(),
            actions,
            read_back: wish.read_back.clone(),
            time_budget: wish.time_budget,
            show: view.show.clone(),
            shows_marks: true,
            background: view.background,
            exposure: view.exposure,
            radius_scale: view.radius_scale,
            interaction: wish.interaction,
            purpose: Purpose::INTERACTIVE,
            role: wish.role,
            patience: Patience::DrawMeanwhile,
            ..FrameRequest::still(
                Arc::clone(scene),
                self.camera,
                wish.size_px,
                &*wish.renderer,
            )
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::session::Session;

    fn session() -> Session {
        Session::new("points".into())
    }

    fn wish(interaction: Interaction) -> Wish {
        Wish {
            renderer: "points".into(),
            role: Role::Main,
            size_px: [4, 3],
            interaction,
            time_budget: None,
            read_back: Vec::new(),
        }
    }

    /// The request for the session's picture, if one is due.
    fn ask(
        asking: &mut Asking,
        session: &Session,
        interaction: Interaction,
        refine: bool,
    ) -> Option<FrameRequest> {
        let look = Look::new(&session.scene, &session.panes.active, wish(interaction));
        let is_due = asking.is_due(&look, refine);
        is_due.then(|| asking.request(look, &session.scene, ViewportId(0)))
    }

    #[test]
    fn nothing_is_asked_for_twice() {
        let (mut asking, mut session) = (Asking::default(), session());
        let mut is_asked =
            |session: &Session| ask(&mut asking, session, Interaction::STILL, false).is_some();
        assert!(is_asked(&session), "the first look is new");
        assert!(!is_asked(&session), "nothing changed");
        session.panes.active.view.exposure = 2.0;
        assert!(is_asked(&session), "the exposure changed");
        session.edit_scene(|_| ());
        assert!(
            !is_asked(&session),
            "an edit that adds nothing changes nothing"
        );
    }

    #[test]
    fn an_action_is_told_once() {
        let (mut asking, session) = (Asking::default(), session());
        asking.press("rebuild".into());
        let request = ask(&mut asking, &session, Interaction::STILL, false);
        assert_eq!(
            request.map(|request| request.actions),
            Some(vec!["rebuild".to_owned()])
        );
        assert!(ask(&mut asking, &session, Interaction::STILL, false).is_none());
    }

    #[test]
    fn a_picture_that_refines_is_asked_for_again() {
        let (mut asking, session) = (Asking::default(), session());
        assert!(ask(&mut asking, &session, Interaction::STILL, false).is_some());
        assert!(ask(&mut asking, &session, Interaction::STILL, true).is_some());
    }

    #[test]
    fn letting_go_of_the_camera_asks_for_the_still_picture() {
        let (mut asking, session) = (Asking::default(), session());
        assert!(ask(&mut asking, &session, Interaction::MOVING, false).is_some());
        let request = ask(&mut asking, &session, Interaction::STILL, false);
        assert_eq!(
            request.map(|request| request.interaction),
            Some(Interaction::STILL)
        );
    }

    #[test]
    fn the_first_picture_and_one_asked_for_by_hand_are_urgent() {
        let (mut asking, session) = (Asking::default(), session());
        assert!(asking.is_urgent());
        ask(&mut asking, &session, Interaction::STILL, false);
        assert!(!asking.is_urgent());
        asking.invalidate();
        assert!(asking.is_urgent());
    }
}
