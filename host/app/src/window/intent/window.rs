//! Intents about the window itself.

use egui::ThemePreference;

/// What to do with panels, dialogs, messages and the clipboard.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum WindowIntent {
    /// End the program.
    Quit,
    /// Show or hide a panel or a dialog.
    Toggle(Part),
    /// Show this tab of the settings panel.
    ChooseTab(Tab),
    /// Show the chosen renderer's settings and put the keyboard on this one.
    FocusSetting(String),
    /// Light or dark.
    Theme(ThemePreference),
    /// Size of texts and widgets, as a factor.
    TextScale(f32),
    /// Put a text on the clipboard.
    Copy(String),
    /// Take a toast away.
    Dismiss(u64),
    /// Empty the log.
    ClearLog,
}

/// A part of the window that can be hidden.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    /// The settings panel.
    Settings,
    /// The log panel.
    Log,
    /// The inspector panel.
    Inspector,
    /// The strip of the camera path.
    Path,
    /// The search over all actions and settings.
    Palette,
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
    /// Views beside each other.
    Compare,
    /// The objects.
    Scene,
    /// The plugins found.
    Plugins,
}
