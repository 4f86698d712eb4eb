//! What the user asked for in one pass over the interface: one file an area.
//!
//! UI functions only push intents; `apply` carries them out, one file an area there too.

mod camera;
mod compare;
mod edit;
mod export;
mod file;
mod inspect;
mod light;
mod path;
mod plugins;
mod renderer;
mod scene;
mod select;
mod view;
mod views;
mod window;

pub(crate) use camera::CameraIntent;
pub(crate) use compare::{CompareIntent, ComparePart};
pub(crate) use edit::EditIntent;
pub(crate) use export::{Backdrop, ExportIntent, ImageFile, Replace};
pub(crate) use file::{FileIntent, OpenMode, Overwrite};
pub(crate) use inspect::InspectIntent;
pub(crate) use light::LightIntent;
pub(crate) use path::{FilmFiles, PathIntent};
pub(crate) use plugins::PluginsIntent;
pub(crate) use renderer::RendererIntent;
pub(crate) use scene::SceneIntent;
pub(crate) use select::SelectIntent;
pub(crate) use view::ViewIntent;
pub(crate) use views::ViewsIntent;
pub(crate) use window::{Part, Tab, WindowIntent};

/// One thing that the user asked for.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Intent {
    /// Files and sessions.
    File(FileIntent),
    /// Undo and redo.
    Edit(EditIntent),
    /// Renderers, structures and their settings.
    Renderer(RendererIntent),
    /// The eye.
    Camera(CameraIntent),
    /// The camera path.
    Path(PathIntent),
    /// Views beside each other.
    Compare(CompareIntent),
    /// Stored views.
    Views(ViewsIntent),
    /// Lights and material.
    Light(LightIntent),
    /// How the picture is shown.
    View(ViewIntent),
    /// The objects.
    Scene(SceneIntent),
    /// Surfels: which are selected, and what becomes of them.
    Select(SelectIntent),
    /// Plugin files.
    Plugins(PluginsIntent),
    /// Pictures to files.
    Export(ExportIntent),
    /// What is under the pointer.
    Inspect(InspectIntent),
    /// Panels, dialogs, messages, clipboard.
    Window(WindowIntent),
}

/// What one pass asked for, in order.
#[derive(Debug, Default)]
pub(crate) struct Intents(Vec<Intent>);

impl Intents {
    /// Nothing asked for yet.
    pub(crate) fn new() -> Self {
        Self::default()
    }

    /// Asks for something before what was asked for since `index`.
    pub(crate) fn insert(&mut self, index: usize, intent: impl Into<Intent>) {
        let index = index.min(self.0.len());
        self.0.insert(index, intent.into());
    }

    /// Asks for one more thing.
    pub(crate) fn push(&mut self, intent: impl Into<Intent>) {
        self.0.push(intent.into());
    }
}

impl std::ops::Deref for Intents {
    type Target = [Intent];

    fn deref(&self) -> &[Intent] {
        &self.0
    }
}

impl IntoIterator for Intents {
    type Item = Intent;
    type IntoIter = std::vec::IntoIter<Intent>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.into_iter()
    }
}

/// Lets an area's intent be pushed as it is: `out.push(CameraIntent::Move(…))`.
macro_rules! areas {
    ($($variant:ident($area:ident)),* $(,)?) => {
        $(impl From<$area> for Intent {
            fn from(intent: $area) -> Self {
                Self::$variant(intent)
            }
        })*
    };
}

areas! {
    File(FileIntent),
    Edit(EditIntent),
    Renderer(RendererIntent),
    Camera(CameraIntent),
    Path(PathIntent),
    Compare(CompareIntent),
    Views(ViewsIntent),
    Light(LightIntent),
    View(ViewIntent),
    Scene(SceneIntent),
    Select(SelectIntent),
    Plugins(PluginsIntent),
    Export(ExportIntent),
    Inspect(InspectIntent),
    Window(WindowIntent),
}
