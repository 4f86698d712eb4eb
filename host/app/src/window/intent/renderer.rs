//! Intents about renderers, structures and their settings.

use pointstage_engine::stage::SettingValue;

/// What draws, and how.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum RendererIntent {
    /// Draw with this renderer.
    Choose(String),
    /// Draw moving pictures with this renderer, or with the main one.
    ChoosePreview(Option<String>),
    /// Let the main and the preview renderer change places on the screen by hand, until it is pressed again.
    TogglePreview,
    /// Give a setting of the chosen renderer a value.
    Set(String, SettingValue),
    /// Give these settings of the chosen renderer their defaults.
    ResetSome(Vec<String>),
    /// Give all settings of the chosen renderer their defaults.
    ResetAll,
    /// Press an action of the chosen renderer.
    Press(String),
    /// Stop the preparation of this renderer or structure.
    CancelPreparation(String),
    /// Prepare this renderer or structure again, which was cancelled or failed.
    PrepareAgain(String),
    /// Draw with this structure, or with none.
    ChooseStructure(Option<String>),
    /// Give a setting of the chosen structure a value.
    SetOfStructure(String, SettingValue),
    /// Give these settings of the chosen structure their defaults.
    ResetOfStructure(Vec<String>),

    /// Give the chosen renderer the values of this preset.
    ChoosePreset(String),
    /// Keep the chosen renderer's values under this name, over what stands there.
    SavePreset(String),
    /// Give a preset of the chosen renderer another name.
    RenamePreset {
        /// Its name.
        from: String,
        /// Its name to be.
        to: String,
    },
    /// Forget this preset of the chosen renderer.
    DeletePreset(String),
    /// Take over what fits of this renderer's values.
    CopyFrom(String),
}
