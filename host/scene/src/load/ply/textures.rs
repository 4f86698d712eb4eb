//! What is made of the pictures that a PLY file names.

use pointstage_plugin_api::settings_schema::SettingSchema;
use pointstage_texels::MOST_VERTICES;

use crate::load::choice::ChoiceSetting;

/// What is made of textures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Textures {
    /// A vertex takes the mean of the texels round it, after triangles that are coarser than their picture were divided.
    #[default]
    Divide,
    /// The same, without dividing.
    Vertices,
    /// They are not read.
    None,
}

/// The loader's option.
pub(super) const TEXTURES: ChoiceSetting<Textures> = ChoiceSetting {
    id: "textures",
    label: "Textures",
    options: &[
        (Textures::Divide, "divide", "Divide coarse triangles"),
        (Textures::Vertices, "vertices", "At the vertices"),
        (Textures::None, "none", "Not read"),
    ],
};

/// The option as the loader's info has it.
pub(super) fn schema() -> SettingSchema {
    TEXTURES.schema(format!(
        "What gives vertices the colours of textures: the mean of the texels round each vertex; 'divide' first divides triangles that are coarser than their texture, up to {MOST_VERTICES} vertices."
    ))
}
