//! The settings of `plugin.json`, and as the sprite's shader reads them.

use bytemuck::{Pod, Zeroable};
use pointstage_plugin_api::{Result, Settings};
use pointstage_visibility::{Extent, Path};

/// Greatest size of a sprite, px: the compute path's loop over 255² pixels stays below the 65,535 iterations after which
/// Mesa's software drivers end a shader's loops.
const GREATEST_PX: f32 = 255.0;

/// The settings of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PointSettings {
    pub(crate) path: Path,
    is_round: bool,
    is_attenuated: bool,
    /// Fixed size; px.
    size_px: f32,
    /// Attenuated size: factor on the surfel's diameter.
    scale: f32,
    least_px: f32,
    greatest_px: f32,
    culls_backs: bool,
}

impl PointSettings {
    pub(crate) fn read(settings: Settings<'_>) -> Result<Self> {
        Ok(Self {
            path: Path::from_id(settings.choice("path")?),
            is_round: settings.choice("shape")? == "round",
            is_attenuated: settings.choice("size_mode")? == "attenuated",
            size_px: settings.float("size")?,
            scale: settings.float("scale")?,
            least_px: settings.float("least_size")?,
            greatest_px: settings.float("greatest_size")?,
            culls_backs: settings.bool("cull_backs")?,
        })
    }

    /// Features of the sprite's shader.
    pub(crate) fn features(&self) -> Vec<&'static str> {
        let features = [
            (self.is_round, "round"),
            (self.is_attenuated, "attenuated"),
            (self.culls_backs, "cull_backs"),
        ];
        let on = features.into_iter().filter(|(is_on, _)| *is_on);
        on.map(|(_, name)| name).collect()
    }

    /// How large the sprites are, where the same for all.
    pub(crate) fn extent(&self) -> Extent {
        if self.is_attenuated {
            Extent::Any
        } else {
            Extent::of_reach(0.5 * self.size_px.max(1.0))
        }
    }
}

/// `SpriteUniform` of `shaders/points/sprite.wesl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct SpriteUniform {
    pub(crate) size: f32,
    pub(crate) least_px: f32,
    pub(crate) greatest_px: f32,
}

impl From<&PointSettings> for SpriteUniform {
    fn from(settings: &PointSettings) -> Self {
        let (size, least_px, greatest_px) = if settings.is_attenuated {
            (settings.scale, settings.least_px, settings.greatest_px)
        } else {
            (settings.size_px, 1.0, GREATEST_PX)
        };
        let greatest_px = greatest_px.clamp(1.0, GREATEST_PX);
        Self {
            size,
            // Below one pixel a sprite may fall between the pixel centres.
            least_px: least_px.clamp(1.0, greatest_px),
            greatest_px,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_stay_within_what_both_paths_can_draw() {
        let settings = PointSettings {
            path: Path::Auto,
            is_round: false,
            is_attenuated: true,
            size_px: 3.0,
            scale: 1.0,
            least_px: 0.1,
            greatest_px: 9_000.0,
            culls_backs: false,
        };
        let uniform = SpriteUniform::from(&settings);
        assert_eq!((uniform.least_px, uniform.greatest_px), (1.0, 255.0));
        let crossed = PointSettings {
            least_px: 50.0,
            greatest_px: 20.0,
            ..settings
        };
        let uniform = SpriteUniform::from(&crossed);
        assert_eq!(
            (uniform.least_px, uniform.greatest_px),
            (20.0, 20.0),
            "the greatest size wins"
        );
    }
}
