//! When to ask the stage for a picture, and for which.

use pointstage_engine::stage::{FrameRequest, Patience, Role, SettingValues};
use pointstage_plugin_api::abi::{Interaction, Purpose};
use pointstage_scene::{Camera, Lights, Revision};

use super::session::{Session, ViewOptions};

/// All that a picture depends on, comparable: the same look needs no new picture.
#[derive(Clone, Debug, PartialEq)]
struct Look {
    scene: Revision,
    camera: Camera,
    lights: Lights,
    size_px: [u32; 2],
    renderer: String,
    structure: Option<String>,
    settings: SettingValues,
    structure_settings: SettingValues,
    view: ViewOptions,
    interaction: Interaction,
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

    /// The request for the next picture by `renderer`, if one is needed: something changed, an action was pressed, or a picture has just
    /// arrived that was not the final one of its look (`refine`).
    pub(crate) fn next(
        &mut self,
        session: &Session,
        renderer: &str,
        size_px: [u32; 2],
        interaction: Interaction,
        refine: bool,
    ) -> Option<FrameRequest> {
        let look = Look {
            scene: session.scene.revision(),
            camera: session.camera,
            lights: session.lights.clone(),
            size_px,
            renderer: renderer.to_owned(),
            structure: session.structure.clone(),
            settings: session.settings_of(renderer),
            structure_settings: session
                .structure
                .as_ref()
                .map_or_else(SettingValues::new, |structure| {
                    session.settings_of(structure)
                }),
            view: session.view.clone(),
            interaction,
        };
        let is_new = self.last.as_ref() != Some(&look);
        if !is_new && !self.is_stale && !refine && self.pressed.is_empty() {
            return None;
        }
        self.is_stale = false;
        let request = look.request(session, std::mem::take(&mut self.pressed));
        self.last = Some(look);
        Some(request)
    }
}

impl Look {
    fn request(&self, session: &Session, actions: Vec<String>) -> FrameRequest {
        FrameRequest {
            lights: self.lights.clone(),
            structure: self.structure.clone(),
            settings: self.settings.clone(),
            structure_settings: self.structure_settings.clone(),
            actions,
            show: self.view.show.clone(),
            background: self.view.background,
            exposure: self.view.exposure,
            radius_scale: self.view.radius_scale,
            interaction: self.interaction,
            purpose: Purpose::INTERACTIVE,
            role: Role::Main,
            patience: Patience::DrawMeanwhile,
            ..FrameRequest::still(
                session.scene.clone(),
                self.camera,
                self.size_px,
                &*self.renderer,
            )
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [u32; 2] = [4, 3];

    #[test]
    fn nothing_is_asked_for_twice() {
        let (mut asking, mut session) = (Asking::default(), Session::new("points".into()));
        let mut ask = |session: &Session| {
            asking
                .next(session, "points", SIZE, Interaction::STILL, false)
                .is_some()
        };
        assert!(ask(&session), "the first look is new");
        assert!(!ask(&session), "nothing changed");
        session.view.exposure = 2.0;
        assert!(ask(&session), "the exposure changed");
        session.edit_scene(|_| ());
        assert!(!ask(&session), "an edit that adds nothing changes nothing");
    }

    #[test]
    fn an_action_is_told_once() {
        let (mut asking, session) = (Asking::default(), Session::new("points".into()));
        asking.press("rebuild".into());
        let request = asking.next(&session, "points", SIZE, Interaction::STILL, false);
        assert_eq!(
            request.map(|request| request.actions),
            Some(vec!["rebuild".to_owned()])
        );
        assert!(
            asking
                .next(&session, "points", SIZE, Interaction::STILL, false)
                .is_none()
        );
    }

    #[test]
    fn a_picture_that_refines_is_asked_for_again() {
        let (mut asking, session) = (Asking::default(), Session::new("points".into()));
        assert!(
            asking
                .next(&session, "points", SIZE, Interaction::STILL, false)
                .is_some()
        );
        assert!(
            asking
                .next(&session, "points", SIZE, Interaction::STILL, true)
                .is_some()
        );
    }

    #[test]
    fn letting_go_of_the_camera_asks_for_the_still_picture() {
        let (mut asking, session) = (Asking::default(), Session::new("points".into()));
        assert!(
            asking
                .next(&session, "points", SIZE, Interaction::MOVING, false)
                .is_some()
        );
        let request = asking.next(&session, "points", SIZE, Interaction::STILL, false);
        assert_eq!(
            request.map(|request| request.interaction),
            Some(Interaction::STILL)
        );
    }
}
