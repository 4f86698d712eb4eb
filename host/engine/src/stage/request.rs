//! What a frame is asked for, and what it gives: the whole interface between the stage and whoever shows pictures.

use super::tile::Tile;
pub use crate::frame::pick::Pick;
use crate::frame::pick::{PickPlanes, pick};
use crate::frame::targets;
pub use crate::frame::{Background, Picture, Plane, Show};
pub use crate::gpu::PassTime;
use glam::DMat4;
use pointstage_plugin_api::abi::{FrameUniform, Interaction, Purpose};
pub use pointstage_plugin_api::settings_schema::{SettingValue, SettingValues};
use pointstage_scene::{Camera, Lights, Scene};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

/// Names one of the stage's viewports. Views of renderers are kept per viewport and role.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ViewportId(pub u32);

/// What a renderer's view is for within a viewport.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Role {
    /// The picture that stays.
    Main,
    /// Stands in while the camera moves.
    Preview,
    /// Off-screen: exports, tools, reference.
    Auxiliary,
}

/// Whether a frame waits for a renderer that is not prepared yet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Patience {
    /// Prepare first, then draw; headless commands.
    Wait,
    /// Draw with the last good renderer meanwhile; the window.
    DrawMeanwhile,
}

/// One frame, asked for. Plain data: the same request gives the same picture.
#[derive(Clone, Debug)]
pub struct FrameRequest {
    /// Which viewport. Views of renderers are kept per viewport and role.
    pub viewport: ViewportId,
    /// The scene; cheap to clone.
    pub scene: Arc<Scene>,
    /// The eye.
    pub camera: Camera,
    /// The lights.
    pub lights: Lights,
    /// Size of the picture that is drawn, px.
    pub size_px: [u32; 2],
    /// Where the picture lies in a larger image, if it is a tile of one.
    pub tile: Option<Tile>,
    /// The renderer: an id, an alias, `id@version` or `id#hash`.
    pub renderer: String,
    /// The level-of-detail structure, if any.
    pub structure: Option<String>,
    /// Values of the renderer's settings.
    pub settings: SettingValues,
    /// Values of the structure's settings.
    pub structure_settings: SettingValues,
    /// Ids of the actions pressed since the last frame.
    pub actions: Vec<String>,
    /// Targets to read back, by key, beside the picture.
    pub read_back: Vec<String>,
    /// What the picture shows.
    pub show: Show,
    /// Values at the dark and the bright end of the shown target's ramp, in the legend's units; found from what is in view
    /// if none are given. Tiles of one image, and frames that are compared, need the same.
    pub shown_range: Option<[f32; 2]>,
    /// Whether surfels that are marked in the scene are tinted: over colours, and by renderers that give the `id` target.
    pub shows_marks: bool,
    /// What lies behind.
    pub background: Background,
    /// Factor on linear colours before sRGB; 1 changes nothing.
    pub exposure: f32,
    /// Factor on every radius.
    pub radius_scale: f32,
    /// What the user is doing.
    pub interaction: Interaction,
    /// What the picture is for.
    pub purpose: Purpose,
    /// Which of the viewport's views draws.
    pub role: Role,
    /// Whether to wait for preparation.
    pub patience: Patience,
    /// How long the renderer may take before it is asked to stop with what it has; as long as it needs if none is given. One
    /// that cannot stop early takes the time that it needs.
    pub time_budget: Option<Duration>,
    /// Seed of random choices.
    pub seed: u32,
}

impl FrameRequest {
    /// A still picture of the scene by a renderer, waited for, with default lights, on a transparent background, without marks.
    pub fn still(
        scene: Arc<Scene>,
        camera: Camera,
        size_px: [u32; 2],
        renderer: impl Into<String>,
    ) -> Self {
        Self {
            viewport: ViewportId(0),
            scene,
            camera,
            lights: Lights::default(),
            size_px,
            tile: None,
            renderer: renderer.into(),
            structure: None,
            settings: SettingValues::new(),
            structure_settings: SettingValues::new(),
            actions: Vec::new(),
            read_back: Vec::new(),
            show: Show::Colours,
            shown_range: None,
            shows_marks: false,
            background: Background::Transparent,
            exposure: 1.0,
            radius_scale: 1.0,
            interaction: Interaction::STILL,
            purpose: Purpose::EXPORT,
            role: Role::Auxiliary,
            patience: Patience::Wait,
            time_budget: None,
            seed: 0,
        }
    }
}

/// What a frame cost and counted.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameStats {
    /// Surfels in the visible objects of the scene.
    pub surfels_in_scene: u64,
    /// Surfels selected for drawing (upper bound where the device counts).
    pub surfels_selected: u64,
    /// Wall clock of the whole frame.
    pub total: Duration,
    /// Time inside the plugin's `render`.
    pub plugin_cpu: Duration,
    /// From submission to completion, by wall clock.
    pub device_wall: Duration,
    /// By timestamps, where the device has them.
    pub passes: Vec<PassTime>,
    /// Bytes that the renderer holds on the device.
    pub plugin_bytes: u64,
    /// Bytes of the scene on the device.
    pub scene_bytes: u64,
    /// Bytes of the viewport's targets on the device; 0 where the CPU drew.
    pub target_bytes: u64,
    /// What the plugin reported, by key.
    pub reported: BTreeMap<String, f64>,
}

/// How serious a notice is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Something failed; the session goes on otherwise.
    Error,
    /// Done, but not as asked.
    Warning,
    /// For the user to know.
    Info,
}

/// A message for the user.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    /// How serious.
    pub severity: Severity,
    /// The plugin that it is about, or empty.
    pub plugin: String,
    /// One or two sentences.
    pub text: String,
    /// The long form, folded away; may be empty.
    pub detail: String,
}

/// A preparation under way.
#[derive(Clone, Debug, PartialEq)]
pub struct Preparing {
    /// The renderer's or structure's id.
    pub id: String,
    /// 0..1.
    pub fraction: f32,
    /// What it does.
    pub stage: String,
}

/// One frame, drawn.
#[derive(Clone, Debug)]
pub struct FrameResult {
    /// The composed picture.
    pub picture: Picture,
    /// The targets that were asked for and that the renderer gives.
    pub planes: BTreeMap<String, Plane>,
    /// Targets that the renderer that drew gives, in the host's order, then its own.
    pub available_targets: Vec<String>,
    /// The renderer that drew: the one asked for, the last good one, or the fallback.
    pub drawn_by: String,
    /// Values at the dark and the bright end of the shown target's ramp, for its legend.
    pub shown_range: Option<[f32; 2]>,
    /// What it cost.
    pub stats: FrameStats,
    /// 1: done; less: the picture refines if asked again.
    pub progress: f32,
    /// The preparation that this frame did not wait for.
    pub preparing: Option<Preparing>,
    /// Messages that came up since the last frame.
    pub notices: Vec<Notice>,
    /// What an id in the `id` target means; resolve with [`IdTable::resolve`](super::IdTable).
    pub ids: Arc<super::IdTable>,
    /// The scene that was drawn: the one asked for, or the one before while a renderer prepares for a new one.
    pub scene: Arc<Scene>,
    /// Projection, sizes and lights of the frame.
    pub uniform: FrameUniform,
    /// Moves points from view space into the world.
    pub world_from_view: DMat4,
}

impl FrameResult {
    /// The surface at a pixel of the picture, or the nearest within `reach_px` of it.
    ///
    /// `None` if nothing is drawn there, or the planes `id` and `depth` were not read back. The id's surfel is
    /// `self.ids.resolve(pick.id)`, in [`FrameResult::scene`].
    ///
    /// * `pixel`: column and row from the picture's upper left corner (of the tile, if it is one); it may lie outside.
    pub fn pick(&self, pixel: [i64; 2], reach_px: u32) -> Option<Pick> {
        let planes = PickPlanes {
            size_px: self.picture.size_px,
            id: self.planes.get(targets::ID)?,
            depth: self.planes.get(targets::DEPTH)?,
        };
        pick(
            planes,
            pixel,
            reach_px,
            &self.uniform,
            &self.world_from_view,
        )
    }
}
