//! The pictures of a film: a camera path, and the times at which it is drawn.

use std::io::{IsTerminal as _, Write as _};
use std::path::Path;

use anyhow::Context as _;
use pointstage_scene::{Scene, ViewRecord, orbit_cameras};

use super::RenderArguments;
use crate::camera_path::{
    Drawer, FPS, LoadedPath, MotionPath, PathSource, ValuesAt, frame_times, resolve, values_at,
};
use crate::cli::{Failure, Outcome};
use crate::session_file::SessionFile;

/// What moves.
pub(super) enum Film {
    /// Once around the scene, in so many pictures.
    Orbit(u32),
    /// A path.
    Path(Box<LoadedPath>),
}

/// `--fps`.
pub(super) fn rate(text: &str) -> Result<f64, String> {
    let rate = text.trim().parse().ok().filter(|rate| FPS.contains(rate));
    rate.ok_or_else(|| format!("expected a number from {} to {}", FPS.start(), FPS.end()))
}

impl Film {
    /// What `source` stands for; `session` is the one of the command line.
    pub(super) fn new(
        source: &PathSource,
        arguments: &RenderArguments,
        session: Option<&SessionFile>,
    ) -> Outcome<Self> {
        let path = match source {
            PathSource::OrbitOf(count) => return Ok(Self::Orbit(*count)),
            PathSource::Orbit => {
                return Err(Failure::usage(
                    "--path orbit: expected the number of pictures too, such as orbit:60; or turntable:SECONDS",
                ));
            }
            PathSource::Turntable(turntable) => {
                LoadedPath::described(MotionPath::of_turntable(*turntable))
            }
            PathSource::Session => {
                let file = arguments.session.as_deref();
                let Some((file, session)) = file.zip(session) else {
                    return Err(Failure::usage(
                        "--path session needs --session FILE; or name a FILE with a path",
                    ));
                };
                LoadedPath::of_session(session, file)?
            }
            PathSource::File(file) => LoadedPath::read(file)?,
        };
        Ok(Self::Path(Box::new(path)))
    }

    /// The view and the changed values of each picture. `views` is where a path without views of its own begins.
    pub(super) fn shots(
        &self,
        scene: &Scene,
        views: &[ViewRecord],
        arguments: &RenderArguments,
        drawers: &[Drawer<'_>],
    ) -> Outcome<Vec<(ViewRecord, ValuesAt)>> {
        let [base] = views else {
            return Err(Failure::usage(format!(
                "--view gives {} views; a path begins with one",
                views.len()
            )));
        };
        let loaded = match self {
            Self::Path(loaded) => loaded,
            Self::Orbit(count) => {
                let cameras = orbit_cameras(&scene.framed_world(), *count as usize, base.aspect());
                let shots = cameras.into_iter().map(|camera| {
                    let view = ViewRecord::new(camera, base.width, base.height);
                    (view, ValuesAt::default())
                });
                return Ok(shots.collect());
            }
        };
        let path = &loaded.path;
        let [width, height] = size_of(path, base, arguments);
        let (tracks, strangers) = resolve(&path.tracks, drawers)
            .map_err(|error| Failure::Failed(anyhow::anyhow!("{}", loaded.tell(&error))))?;
        for owner in strangers {
            eprintln!(
                "warning: {}: '{owner}' does not draw, so its tracks change nothing; --renderer chooses one",
                loaded.name()
            );
        }
        let way = path.way(base.camera(), scene)?;
        let (start, end) = (0.0, path.duration_s());
        let is_closed =
            way.at(start) == way.at(end) && values_at(&tracks, start) == values_at(&tracks, end);
        let fps = arguments.fps.unwrap_or(path.fps);
        let times = frame_times(end, fps, is_closed)
            .map_err(|error| Failure::usage(format!("{}: {error}", loaded.name())))?;
        let shot = |index| {
            let time = times.at(index);
            let view = ViewRecord::new(way.at(time), width, height);
            (view, values_at(&tracks, time))
        };
        Ok((0..times.count).map(shot).collect())
    }
}

/// The size of the pictures: what is asked for, else the view's that the command line or a session names, else that of the
/// path's first view, px.
fn size_of(path: &MotionPath, base: &ViewRecord, arguments: &RenderArguments) -> [u32; 2] {
    let is_named =
        arguments.size.is_some() || arguments.view.is_some() || arguments.session.is_some();
    let own = path.keys.first().filter(|_| !is_named).map(|key| &key.view);
    let view = own.unwrap_or(base);
    [view.width, view.height]
}

/// Makes the folder that pictures go to, if it is not there.
pub(super) fn make_folder(out: &Path) -> Outcome {
    let Some(folder) = out.parent().filter(|folder| !folder.as_os_str().is_empty()) else {
        return Ok(());
    };
    std::fs::create_dir_all(folder).with_context(|| {
        format!(
            "{}: the folder cannot be made; name one in a place that may be written to",
            folder.display()
        )
    })?;
    Ok(())
}

/// Says on a terminal which picture is drawn now.
pub(super) fn tell_progress(index: usize, count: usize) {
    let mut terminal = std::io::stderr();
    if !terminal.is_terminal() {
        return;
    }
    let end = if index + 1 == count { "\n" } else { "" };
    // A terminal that takes nothing any more misses nothing either.
    let _ = write!(terminal, "\rpicture {} of {count}{end}", index + 1);
    let _ = terminal.flush();
}
