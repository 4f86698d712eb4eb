//! Several views in a session file: each with all that its picture depends on, and how they are compared.

use std::collections::BTreeMap;
use std::mem::take;

use pointstage_engine::stage::SettingValues;
use pointstage_scene::{Lights, ViewRecord};
use serde::{Deserialize, Serialize};

use super::{Renderers, SessionFile};
use crate::toml_form::{self, Look};

/// One of several views. [`SessionFile`] has the same fields, for the active one; they are written out there, since what is
/// flattened into another record loses the place in the text that a complaint names.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct PaneFile {
    /// The camera and the picture's size.
    #[serde(deserialize_with = "toml_form::view")]
    pub(crate) view: ViewRecord,
    /// Who draws.
    #[serde(default)]
    pub(crate) renderers: Renderers,
    /// How the picture is shown.
    #[serde(default)]
    pub(crate) look: Look,
    /// The lights.
    #[serde(default, deserialize_with = "toml_form::lights")]
    pub(crate) lights: Lights,
    /// Values that differ from the default, by the id of the renderer or structure.
    #[serde(default)]
    pub(crate) settings: BTreeMap<String, SettingValues>,
    /// The preset that a renderer's values come from, by renderer id.
    #[serde(default)]
    pub(crate) presets: BTreeMap<String, String>,
}

impl SessionFile {
    /// The session of one view, without a scene.
    pub(crate) fn of_pane(pane: PaneFile) -> Self {
        let PaneFile {
            view,
            renderers,
            look,
            lights,
            settings,
            presets,
        } = pane;
        Self {
            renderers,
            look,
            lights,
            settings,
            presets,
            ..Self::new(view)
        }
    }

    /// The view that the session's own fields describe; they are left as in a new window.
    pub(crate) fn take_pane(&mut self) -> PaneFile {
        PaneFile {
            view: self.view,
            renderers: take(&mut self.renderers),
            look: take(&mut self.look),
            lights: take(&mut self.lights),
            settings: take(&mut self.settings),
            presets: take(&mut self.presets),
        }
    }
}

/// How the views of a session are compared.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct ComparisonFile {
    /// The view that the rest of the file describes, from 0.
    pub(crate) active: usize,
    /// Whether all cameras are one.
    pub(crate) linked: bool,
    /// Whether all views share what is not the renderer's own.
    pub(crate) fair: bool,
    /// `grid`, `wipe`, `flicker`, `absolute`, `signed` or `flip`; another word is a grid.
    pub(crate) layout: String,
    /// Changes of the flicker a second.
    pub(crate) flicker_hz: f32,
    /// The view that the others are measured against, from 0.
    pub(crate) against: usize,
    /// Whether they are measured when they rest.
    pub(crate) measure: bool,
    /// Where the borders between views are, as parts of width and height.
    pub(crate) split: [f32; 2],
}

impl Default for ComparisonFile {
    fn default() -> Self {
        Self {
            active: 0,
            linked: true,
            fair: false,
            layout: "grid".to_owned(),
            flicker_hz: 1.0,
            against: 0,
            measure: true,
            split: [0.5; 2],
        }
    }
}
