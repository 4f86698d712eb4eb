//! Ways to name files: the system's dialog on a thread of its own, and a field to type a path.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use egui::{Align2, Context, Key, TextEdit, Window};

use pointstage_scene::{Loaders, ObjectId, SaveFormat};

use super::intent::{ExportIntent, FileIntent, Intents, OpenMode, Overwrite};
use crate::session_file::SUFFIX;

/// What a file is named for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Asked {
    /// Files to open.
    Open(OpenMode),
    /// The file that a session is saved to; the dialog starts with this one.
    Save(PathBuf),
    /// The file that an object is saved to; the dialog starts with this one.
    SaveObject(ObjectId, PathBuf),
    /// Where an image goes; the dialog starts with this place.
    SaveImage(PathBuf),
}

/// A system dialog that is open.
pub(crate) struct FileDialog {
    answer: Receiver<Vec<PathBuf>>,
    asked: Asked,
}

impl FileDialog {
    /// Opens the system's dialog; `wake` is called from its thread once it closes.
    pub(crate) fn open(
        asked: Asked,
        loaders: &Loaders,
        wake: Arc<dyn Fn() + Send + Sync>,
    ) -> std::io::Result<Self> {
        let (sender, answer) = channel();
        let (question, loaders) = (asked.clone(), loaders.clone());
        std::thread::Builder::new()
            .name("pointstage-dialog".to_owned())
            .spawn(move || {
                // Nobody listens when the window has closed meanwhile.
                let _ = sender.send(ask_system(&question, &loaders));
                wake();
            })?;
        Ok(Self { answer, asked })
    }

    /// Pushes what was chosen, once. True while the dialog is open.
    pub(crate) fn poll(&self, out: &mut Intents) -> bool {
        match self.answer.try_recv() {
            Ok(mut files) => {
                match &self.asked {
                    Asked::Open(mode) if !files.is_empty() => {
                        out.push(FileIntent::Open(files, *mode));
                    }
                    Asked::Open(_) => {}
                    Asked::Save(_) => {
                        // The system's dialog has asked about a file that is there.
                        if let Some(path) = files.pop() {
                            let path = session_path(path);
                            out.push(FileIntent::SaveSession(path, Overwrite::Agreed));
                        }
                    }
                    Asked::SaveObject(id, _) => {
                        if let Some(path) = files.pop() {
                            // A name that got its ending is another file, which nobody was asked about.
                            let overwrite = if object_path(path.clone()) == path {
                                Overwrite::Agreed
                            } else {
                                Overwrite::Ask
                            };
                            out.push(FileIntent::SaveObject(*id, path, overwrite));
                        }
                    }
                    Asked::SaveImage(_) => {
                        if let Some(path) = files.pop() {
                            out.push(ExportIntent::SetPath(path));
                        }
                    }
                }
                false
            }
            Err(TryRecvError::Empty) => true,
            Err(TryRecvError::Disconnected) => false,
        }
    }
}

/// Shows the system's dialog and waits for its answer; nothing chosen gives no path.
fn ask_system(asked: &Asked, loaders: &Loaders) -> Vec<PathBuf> {
    let dialog = rfd::FileDialog::new();
    match asked {
        Asked::Open(_) => {
            let known = known_extensions(loaders);
            let sessions = SESSION_EXTENSIONS.map(str::to_owned);
            let sweeps = ["json".to_owned()];
            let all: Vec<&String> = known.iter().chain(&sessions).chain(&sweeps).collect();
            dialog
                .set_title("Open points, a mesh or a session")
                .add_filter("What Pointstage opens", &all)
                .add_filter("Points and meshes", &known)
                .add_filter("Sessions", &sessions)
                .add_filter("Sweeps", &sweeps)
                .add_filter("All files", &["*"])
                .pick_files()
                .unwrap_or_default()
        }
        Asked::Save(path) => {
            let dialog = dialog
                .set_title("Save session")
                .add_filter("Sessions", &["toml"]);
            ask_where(dialog, path)
        }
        Asked::SaveObject(_, path) => {
            let dialog = dialog
                .set_title("Save object")
                .add_filter("PLY: everything", &["ply"])
                .add_filter("SFL: surfels", &["sfl"]);
            ask_where(dialog, path)
        }
        Asked::SaveImage(path) => {
            let dialog = dialog
                .set_title("Save image")
                .add_filter("Pictures", &["png"])
                .add_filter("All targets", &["exr"]);
            ask_where(dialog, path)
        }
    }
}

/// Extensions of files that hold a session.
const SESSION_EXTENSIONS: [&str; 3] = ["toml", "png", "exr"];

/// Extensions that loaders know, in lower and in upper case: filters tell them apart.
fn known_extensions(loaders: &Loaders) -> Vec<String> {
    let loaders = loaders.all();
    let extensions = loaders.iter().flat_map(|loader| &loader.info().extensions);
    let mut all: Vec<String> = extensions
        .flat_map(|extension| [extension.clone(), extension.to_ascii_uppercase()])
        .collect();
    all.sort();
    all.dedup();
    all
}

/// Asks for a file to write, starting with `path`.
fn ask_where(mut dialog: rfd::FileDialog, path: &Path) -> Vec<PathBuf> {
    if let Some(folder) = path.parent() {
        dialog = dialog.set_directory(folder);
    }
    if let Some(name) = path.file_name() {
        dialog = dialog.set_file_name(name.to_string_lossy());
    }
    dialog.save_file().into_iter().collect()
}

/// The field for a typed path.
#[derive(Debug)]
pub(crate) struct PathField {
    text: String,
    purpose: Purpose,
    has_been_focused: bool,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Purpose {
    Open(OpenMode),
    /// Save a session. The file named here is there, and may be replaced once the user says it again.
    Save {
        replaces: Option<PathBuf>,
    },
    /// Save an object, likewise.
    SaveObject {
        id: ObjectId,
        replaces: Option<PathBuf>,
    },
}

impl PathField {
    /// An empty field for a file to open.
    pub(crate) fn open(mode: OpenMode) -> Self {
        Self {
            text: String::new(),
            purpose: Purpose::Open(mode),
            has_been_focused: false,
        }
    }

    /// A field for the file that a session is saved to.
    pub(crate) fn save(suggested: &Path) -> Self {
        Self {
            text: suggested.display().to_string(),
            purpose: Purpose::Save { replaces: None },
            has_been_focused: false,
        }
    }

    /// A field for the file that an object is saved to.
    pub(crate) fn save_object(id: ObjectId, suggested: &Path) -> Self {
        Self {
            purpose: Purpose::SaveObject { id, replaces: None },
            ..Self::save(suggested)
        }
    }

    /// The same, after it was found that `path` is there.
    pub(crate) fn replace_object(id: ObjectId, path: &Path) -> Self {
        Self {
            purpose: Purpose::SaveObject {
                id,
                replaces: Some(path.to_path_buf()),
            },
            ..Self::save(path)
        }
    }

    /// The same for a session, after it was found that `path` is there.
    pub(crate) fn replace(path: &Path) -> Self {
        Self {
            purpose: Purpose::Save {
                replaces: Some(path.to_path_buf()),
            },
            ..Self::save(path)
        }
    }

    /// The dialog. True while it is open.
    pub(crate) fn ui(&mut self, ctx: &Context, out: &mut Intents) -> bool {
        let mut is_open = true;
        let mut is_done = ctx.input(|input| input.key_pressed(Key::Escape));
        let (title, label, act) = match self.purpose {
            Purpose::Open(OpenMode::Replace) => ("Open path", "Path of a file:", "Open"),
            Purpose::Open(OpenMode::Add) => ("Add path to scene", "Path of a file:", "Open"),
            Purpose::Save { .. } => ("Save session", "Path of the session file:", "Save"),
            Purpose::SaveObject { .. } => {
                ("Save object", "Path of the file, .ply or .sfl:", "Save")
            }
        };
        Window::new(title)
            .open(&mut is_open)
            .anchor(Align2::CENTER_CENTER, egui::Vec2::ZERO)
            .resizable(false)
            .collapsible(false)
            .show(ctx, |ui| {
                let label = ui.label(label);
                let field = TextEdit::singleline(&mut self.text)
                    .desired_width(420.0_f32.min(ctx.content_rect().width() - 60.0))
                    .hint_text("/home/me/scan.ply");
                let response = ui.add(field).labelled_by(label.id);
                if !self.has_been_focused {
                    response.request_focus();
                    self.has_been_focused = true;
                }
                self.note_ui(ui);
                let is_entered =
                    response.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
                ui.horizontal(|ui| {
                    let has_text = !self.text.trim().is_empty();
                    let is_pressed = ui.add_enabled(has_text, egui::Button::new(act)).clicked();
                    if has_text && (is_entered || is_pressed) {
                        out.push(self.answer());
                        is_done = true;
                    }
                    let path = typed_path(&self.text);
                    let browse = match self.purpose {
                        Purpose::Open(_) => None,
                        Purpose::Save { .. } => Some(FileIntent::ChooseSessionFile(path)),
                        Purpose::SaveObject { id, .. } => {
                            Some(FileIntent::ChooseObjectFile(id, path))
                        }
                    };
                    if let Some(browse) = browse
                        && ui.button("Browse…").clicked()
                    {
                        out.push(browse);
                        is_done = true;
                    }
                    is_done |= ui.button("Close").clicked();
                });
            });
        is_open && !is_done
    }

    /// What saving would replace.
    fn note_ui(&self, ui: &mut egui::Ui) {
        let typed = typed_path(&self.text);
        let (replaces, meant) = match &self.purpose {
            Purpose::Open(_) => return,
            Purpose::Save { replaces } => (replaces, session_path(typed)),
            Purpose::SaveObject { replaces, .. } => (replaces, object_path(typed)),
        };
        if let Some(path) = replaces
            && meant == *path
        {
            let name = path.file_name().unwrap_or(path.as_os_str());
            ui.label(format!(
                "{} is there already. Save replaces it.",
                name.to_string_lossy()
            ));
        }
    }

    /// What the typed path asks for.
    fn answer(&self) -> FileIntent {
        let path = typed_path(&self.text);
        match &self.purpose {
            Purpose::Open(mode) => FileIntent::Open(vec![path], *mode),
            Purpose::Save { replaces } => {
                let path = session_path(path);
                let overwrite = if replaces.as_ref() == Some(&path) {
                    Overwrite::Agreed
                } else {
                    Overwrite::Ask
                };
                FileIntent::SaveSession(path, overwrite)
            }
            Purpose::SaveObject { id, replaces } => {
                let path = object_path(path);
                let overwrite = if replaces.as_ref() == Some(&path) {
                    Overwrite::Agreed
                } else {
                    Overwrite::Ask
                };
                FileIntent::SaveObject(*id, path, overwrite)
            }
        }
    }
}

/// The path that a typed text means: without surrounding space or quotes, `~` for the home folder, `file://` of a pasted
/// address taken off.
pub(crate) fn typed_path(text: &str) -> PathBuf {
    let text = text.trim().trim_matches(['"', '\'']);
    let text = text.strip_prefix("file://").unwrap_or(text);
    if let Some(rest) = text.strip_prefix("~/")
        && let Ok(home) = etcetera::home_dir()
    {
        return home.join(rest);
    }
    PathBuf::from(text)
}

/// The path of an object's file, absolute; a name without the ending of a format gets that of PLY.
pub(crate) fn object_path(path: PathBuf) -> PathBuf {
    let path = std::path::absolute(&path).unwrap_or(path);
    if SaveFormat::of_name(&path).is_some() {
        return path;
    }
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".ply");
    path.with_file_name(name)
}

/// The path of a session file, absolute; a name that does not end in `.toml` gets the ending of sessions.
fn session_path(path: PathBuf) -> PathBuf {
    let path = std::path::absolute(&path).unwrap_or(path);
    if path
        .extension()
        .is_some_and(|extension| extension == "toml")
    {
        return path;
    }
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(SUFFIX);
    path.with_file_name(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pasted_paths_lose_their_wrapping() {
        for text in ["/a b.ply", " /a b.ply\n", "\"/a b.ply\"", "file:///a b.ply"] {
            assert_eq!(typed_path(text), PathBuf::from("/a b.ply"), "{text:?}");
        }
    }

    #[test]
    fn an_object_s_name_gets_its_ending_and_its_file_is_replaced_when_said_twice() {
        for (typed, expected) in [
            ("/a/b", "/a/b.ply"),
            ("/a/b.sfl", "/a/b.sfl"),
            ("/a/b.v2", "/a/b.v2.ply"),
        ] {
            assert_eq!(object_path(typed.into()), PathBuf::from(expected));
        }
        let (id, path) = (ObjectId::next(), Path::new("/a/b.ply"));
        let saved = |overwrite| FileIntent::SaveObject(id, path.to_path_buf(), overwrite);
        assert_eq!(
            PathField::save_object(id, path).answer(),
            saved(Overwrite::Ask)
        );
        assert_eq!(
            PathField::replace_object(id, path).answer(),
            saved(Overwrite::Agreed)
        );
    }

    #[test]
    fn a_session_s_name_gets_its_ending() {
        for (typed, expected) in [
            ("/a/work", "/a/work.pointstage.toml"),
            ("/a/work.v2", "/a/work.v2.pointstage.toml"),
            ("/a/work.toml", "/a/work.toml"),
            ("/a/work.pointstage.toml", "/a/work.pointstage.toml"),
        ] {
            assert_eq!(session_path(typed.into()), PathBuf::from(expected));
        }
    }

    #[test]
    fn a_file_is_replaced_when_the_user_says_so_twice() {
        let path = Path::new("/a/work.toml");
        let saved = |overwrite| FileIntent::SaveSession(path.to_path_buf(), overwrite);
        assert_eq!(PathField::save(path).answer(), saved(Overwrite::Ask));
        let mut field = PathField::replace(path);
        assert_eq!(field.answer(), saved(Overwrite::Agreed));
        field.text = "/a/other.toml".to_owned();
        let other = FileIntent::SaveSession("/a/other.toml".into(), Overwrite::Ask);
        assert_eq!(field.answer(), other);
    }
}
