//! What the author of a renderer writes.

use crate::error::Result;
use crate::frame::{Frame, Outcome};
use crate::host::{Host, Progress};
use crate::scene::{Changes, Scene};
use crate::settings::Settings;

/// A renderer prepared for one state of the scene. What is costly and common to all views belongs here: pipelines,
/// buffers, trees.
pub trait Renderer: Sized + Send + Sync + 'static {
    /// What belongs to one viewport.
    type View: View<Self>;

    /// Makes the renderer ready for a scene.
    ///
    /// Thread: worker; seconds are fine, drawing goes on with `previous` meanwhile. Ask [`Progress::check`] in long
    /// loops. `previous` is what the last call made, with what changed since; ignoring it rebuilds all.
    fn prepare(
        host: &Host,
        scene: Scene<'_>,
        previous: Option<(&Self, Changes<'_>)>,
        settings: Settings<'_>,
        progress: &Progress<'_>,
    ) -> Result<Self>;

    /// Makes what one viewport needs. Thread: render or worker.
    fn view(&self, host: &Host) -> Result<Self::View>;
}

/// A renderer in one viewport.
pub trait View<R>: Send + 'static {
    /// Draws one frame: a function of the frame to its targets.
    ///
    /// Thread: render. Never waits for the device.
    fn render(&mut self, prepared: &R, frame: &mut Frame<'_>) -> Result<Outcome>;
}
