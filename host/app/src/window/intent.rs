//! What the user asked for in one pass over the interface.

use std::path::PathBuf;

use pointstage_engine::stage::{Background, SettingValue, Show};
use pointstage_scene::{Lights, ObjectId, Projection};

use super::navigation::CameraMove;
use super::tasks::TaskId;

/// One thing that the user asked for. UI functions only push these; `apply` carries them out.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Intent {
    /// Show the system's file dialog.
    ChooseFiles(OpenMode),
    /// Show the field for a typed path.
    TypePath(OpenMode),
    /// Load files.
    Open(Vec<PathBuf>, OpenMode),
    /// Stop a task.
    Cancel(TaskId),
    /// End the program.
    Quit,

    /// Draw with this renderer.
    ChooseRenderer(String),
    /// Give a setting of the chosen renderer a value.
    Set(String, SettingValue),
    /// Give a setting of the chosen renderer its default.
    Reset(String),
    /// Give all settings of the chosen renderer their defaults.
    ResetAll,
    /// Press an action of the chosen renderer.
    Press(String),
    /// Draw with this structure, or with none.
    ChooseStructure(Option<String>),

    /// Move the camera.
    Move(CameraMove),
    /// Change how the camera projects.
    Project(Projection),
    /// Light the scene like this.
    Light(Lights),
    /// Show this.
    Show(Show),
    /// Put this behind the scene.
    Background(Background),
    /// Factor on linear colours.
    Exposure(f32),
    /// Factor on every radius.
    RadiusScale(f32),

    /// Estimate normals and radii of every object that lacks them.
    Estimate,
    /// Turn an inward-wound mesh inside out.
    Flip(ObjectId),
    /// Show or hide an object.
    SetVisible(ObjectId, bool),
    /// Take an object out of the scene.
    Remove(ObjectId),

    /// Try a quarantined plugin again.
    RetryPlugin(PathBuf),
    /// Destroy the graphics device, to see what comes back.
    LoseDevice,
    /// Show or hide a panel or a dialog.
    Toggle(Part),
    /// Put a text on the clipboard.
    Copy(String),
    /// Take a toast away.
    Dismiss(u64),
    /// Empty the log.
    ClearLog,
    /// Show this tab of the settings panel.
    ChooseTab(Tab),
}

/// What opening files does with the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OpenMode {
    /// The files take the scene's place once the first is loaded.
    Replace,
    /// The files join the scene.
    Add,
}

/// A part of the window that can be hidden.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    /// The settings panel.
    Settings,
    /// The log panel.
    Log,
    /// The list of keys and mouse actions.
    Keys,
    /// Versions and adapter.
    About,
}

/// A tab of the settings panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Tab {
    /// Which renderer, and its settings.
    Renderer,
    /// The lights.
    Lighting,
    /// Camera, background, what is shown.
    View,
    /// The objects.
    Scene,
    /// The plugins found.
    Plugins,
}

/// What one pass asked for, in order.
pub(crate) type Intents = Vec<Intent>;
