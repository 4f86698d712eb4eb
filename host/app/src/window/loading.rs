//! Files into the session: what the worker does for each, and how its answer changes the scene.

use std::path::{Path, PathBuf};

use pointstage_engine::stage::Severity;
use pointstage_scene::{
    Estimation, Job, LoadError, LoadOptions, Loaded, Loaders, Object, ObjectId, WarningKind,
    Winding, load_with,
};

use super::apply::{Estimated, ObjectSaved};
use super::intent::{OpenMode, SceneIntent};
use super::log::{Log, Offer};
use super::selecting::{Found, Pieces};
use super::session::Session;
use super::session_link::OpenedSession;
use super::tasks::guarded;
use crate::output::export::Saved;

/// Numbers the acts of opening, so that the files of one act replace the scene once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Batch(pub(crate) u64);

/// Where a loaded object goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// Into the scene, or into its place.
    New(Batch, OpenMode),
    /// Instead of an object that is there, which keeps its place and its looks.
    InsteadOf(ObjectId),
}

/// What a task gave.
#[derive(Debug)]
pub(crate) enum Finished {
    /// An object.
    Loaded(Box<Loaded>, Place),
    /// Objects made one.
    Merged(Box<Merged>),
    /// An object with columns estimated anew.
    Estimated(Box<Estimated>),
    /// An object in a file.
    ObjectSaved(Box<ObjectSaved>),
    /// What the user does not want any more, in words.
    Stopped(String),
    /// A session with its objects.
    Session(Box<OpenedSession>),
    /// Stopped by the user.
    Cancelled(String),
    /// Surfels to be marked.
    Found(Box<Found>),
    /// Surfels that were copied or taken out.
    Pieces(Box<Pieces>),
    /// Work on the scene that the user stopped; what it was.
    Unchanged(String),
    /// An image in a file, and its size, px.
    ImageSaved(Box<Saved>, [u32; 2]),
    /// An image that the user does not want any more; the file's name.
    ImageCancelled(String),
    /// The first of the path's pictures, and how many there are.
    Filmed(PathBuf, u32),
    /// Pictures of a path that the user does not want any more; how many are there.
    FilmCancelled(u32),
    /// An error, for the user.
    Failed(String),
}

/// One object made of several.
#[derive(Debug)]
pub(crate) struct Merged {
    /// The union.
    pub(crate) object: Object,
    /// What it was made of.
    pub(crate) parts: Vec<Object>,
}

/// Loads a file; runs on the worker.
pub(crate) fn load_file(
    path: &Path,
    loaders: &Loaders,
    options: &LoadOptions,
    place: Place,
    job: &Job,
) -> Finished {
    let name = path.display();
    guarded(
        || match load_with(loaders, path, options, job) {
            Ok(loaded) => Finished::Loaded(Box::new(loaded), place),
            Err(LoadError::Cancelled(_)) => Finished::Cancelled(name.to_string()),
            Err(error) => Finished::Failed(error.to_string()),
        },
        |panic| {
            Finished::Failed(format!(
                "{name}: the loader has a defect and stopped ({panic}); please report it with the file"
            ))
        },
    )
}

/// How to load an object's file again with normals and radii for sure.
pub(crate) fn with_estimates(loaded_as: LoadOptions) -> LoadOptions {
    LoadOptions {
        estimation: Estimation::Always,
        ..loaded_as
    }
}

/// How to load an object's file again with the other side outside.
pub(crate) fn flipped(loaded_as: LoadOptions) -> LoadOptions {
    LoadOptions {
        winding: match loaded_as.winding {
            Winding::AsInFile => Winding::Flipped,
            Winding::Flipped => Winding::AsInFile,
        },
        ..loaded_as
    }
}

/// What an arrival did to the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Arrival {
    /// The scene was empty or has been replaced: frame it.
    First,
    /// It came with the file that began the scene: frame both, unless the camera was moved meanwhile.
    WithFirst,
    /// It joined what was there.
    Joined,
}

/// Puts a loaded object where it belongs. `shown` is the batch whose objects the scene holds.
pub(crate) fn arrive(
    session: &mut Session,
    shown: &mut Option<Batch>,
    loaded: Loaded,
    place: Place,
    log: &mut Log,
) -> Arrival {
    let now = std::time::Instant::now();
    let Loaded {
        object, warnings, ..
    } = loaded;
    // The identity that the object will have in the scene.
    let id = match place {
        Place::New(..) => object.id,
        Place::InsteadOf(id) => id,
    };
    for warning in warnings.iter() {
        let text = format!("{}: {warning}", object.name);
        match warning.kind {
            WarningKind::WoundInward => {
                let intent = SceneIntent::Flip(id).into();
                log.warn_with(
                    text,
                    Offer {
                        label: "Flip",
                        intent,
                    },
                    now,
                );
            }
            WarningKind::NormalsEstimated | WarningKind::RadiiEstimated | WarningKind::Flipped => {
                log.say(Severity::Info, text, now);
            }
            _ => log.say(Severity::Warning, text, now),
        }
    }
    let mut arrival = Arrival::Joined;
    let object = match place {
        Place::New(batch, mode) => {
            let replaces = mode == OpenMode::Replace && *shown != Some(batch);
            if replaces || session.scene.objects().is_empty() {
                session.clear_scene();
                arrival = Arrival::First;
            } else if mode == OpenMode::Replace {
                arrival = Arrival::WithFirst;
            }
            *shown = Some(batch);
            object
        }
        Place::InsteadOf(id) => match session.scene.object(id) {
            Some(old) => in_place_of(old, object),
            // The object was removed while its file was read again: it stays removed.
            None => return Arrival::Joined,
        },
    };
    tracing::info!(
        "scene loaded: {}, {} surfels",
        object.name,
        object.geometry.surfel_count
    );
    session.warnings.insert(object.id, warnings);
    session.edit_scene(|scene| scene.add(object));
    arrival
}

/// The new object with the identity and the looks of the old one.
fn in_place_of(old: &Object, new: Object) -> Object {
    Object {
        id: old.id,
        name: old.name.clone(),
        world_from_object: old.world_from_object,
        material: old.material,
        radius_scale: old.radius_scale,
        visible: old.visible,
        selected: old.selected,
        ..new
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pointstage_scene::{Block, Geometry, LoaderInfo, Origins, Warnings};
    use std::sync::Arc;

    fn loaded(name: &str) -> Loaded {
        let block = Block {
            position_radius: Arc::from([[0.0, 0.0, 0.0, 1.0]]),
            ..Block::default()
        };
        Loaded {
            object: Object::new(
                name,
                glam::DVec3::ZERO,
                Geometry::new(vec![block], None, Origins::default()),
            ),
            loader: LoaderInfo::default(),
            warnings: Warnings::new(),
        }
    }

    fn names(session: &Session) -> Vec<&str> {
        let objects = session.scene.objects().iter();
        objects.map(|object| object.name.as_str()).collect()
    }

    #[test]
    fn files_of_one_act_replace_the_scene_once() {
        let (mut session, mut shown, mut log) = (Session::new("x".into()), None, Log::default());
        let mut arrive = |name, batch, mode| {
            let place = Place::New(Batch(batch), mode);
            let arrival = arrive(&mut session, &mut shown, loaded(name), place, &mut log);
            (arrival, names(&session).join(" "))
        };
        let expected = |arrival, names: &str| (arrival, names.to_owned());
        assert_eq!(
            arrive("a", 0, OpenMode::Replace),
            expected(Arrival::First, "a")
        );
        assert_eq!(
            arrive("b", 0, OpenMode::Replace),
            expected(Arrival::WithFirst, "a b")
        );
        assert_eq!(
            arrive("c", 1, OpenMode::Add),
            expected(Arrival::Joined, "a b c")
        );
        assert_eq!(
            arrive("d", 2, OpenMode::Replace),
            expected(Arrival::First, "d")
        );
        assert_eq!(
            arrive("e", 2, OpenMode::Replace),
            expected(Arrival::WithFirst, "d e")
        );
    }

    #[test]
    fn a_reloaded_object_keeps_its_identity_and_looks() {
        let (mut session, mut shown, mut log) = (Session::new("x".into()), None, Log::default());
        let first = loaded("a");
        let id = first.object.id;
        let place = Place::New(Batch(0), OpenMode::Replace);
        arrive(&mut session, &mut shown, first, place, &mut log);
        session.edit_scene(|scene| scene.edit(id, |object| object.material.ks = 0.7));
        arrive(
            &mut session,
            &mut shown,
            loaded("a2"),
            Place::InsteadOf(id),
            &mut log,
        );
        assert_eq!(names(&session), ["a"]);
        assert_eq!(session.scene.objects()[0].material.ks, 0.7);
    }

    #[test]
    fn a_missing_file_is_an_error_with_its_name() {
        let place = Place::New(Batch(0), OpenMode::Replace);
        let options = LoadOptions::default();
        let finished = load_file(
            Path::new("/no/such.ply"),
            &Loaders::built_in(),
            &options,
            place,
            &Job::new(),
        );
        let Finished::Failed(text) = finished else {
            panic!("{finished:?}")
        };
        assert!(text.contains("/no/such.ply"), "{text}");
    }
}
