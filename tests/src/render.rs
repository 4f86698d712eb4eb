//! Pictures made by `pointstage render`, with everything fixed that a default may change.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};
use exr::prelude::{FlatSamples, read_first_flat_layer_from_file};
use glam::DVec3;
use image::{Rgba, RgbaImage};
use pointstage_scene::{Camera, Projection, ViewRecord};
use tempfile::TempDir;

use crate::compare;
use crate::program::Program;

/// What lies behind the scene in the pictures made here, sRGB.
pub const BACKGROUND: Rgba<u8> = Rgba([32, 36, 44, 255]);

/// Width and height of the pictures made here, px: small, since they are kept, and not square, so that swapped axes show.
pub const SIZE_PX: (u32, u32) = (256, 192);

/// A picture and the depth behind it.
#[derive(Debug)]
pub struct Rendering {
    /// The composed picture.
    pub picture: RgbaImage,
    /// Distance along the line of sight, scene units, row by row from the top; infinite where nothing is.
    pub depth: Vec<f32>,
}

/// A way to make pictures: the program, and a view that all of them share.
#[derive(Debug)]
pub struct Studio {
    program: Program,
    folder: TempDir,
    view: PathBuf,
}

impl Studio {
    /// A studio whose camera stands at `eye`, looks at the origin with y up, and sees 40° from top to bottom.
    ///
    /// # Errors
    /// When the program was not built.
    pub fn new(eye: [f64; 3]) -> Result<Self> {
        let program = Program::find()?;
        let folder = tempfile::tempdir().context("making a folder for pictures")?;
        let view = folder.path().join("view.json");
        let (width, height) = SIZE_PX;
        let camera = Camera {
            eye: eye.into(),
            pivot: DVec3::ZERO,
            up: DVec3::Y,
            projection: Projection::Perspective {
                fov_y_rad: 40.0_f64.to_radians(),
            },
            ..Camera::default()
        };
        let record = ViewRecord::new(camera, width, height).to_json();
        std::fs::write(&view, record).with_context(|| format!("writing {}", view.display()))?;
        Ok(Self {
            program,
            folder,
            view,
        })
    }

    /// The folder for scenes and pictures of this studio; it goes with it.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// Draws `file` with `renderer` and further arguments, such as `--set`.
    ///
    /// # Errors
    /// When the program fails; the message holds what it said.
    pub fn render(&self, file: &Path, renderer: &str, arguments: &[&str]) -> Result<Rendering> {
        let picture = self.folder().join("picture.png");
        let depth = self.folder().join("depth.exr");
        let mut aov = std::ffi::OsString::from("depth=");
        aov.push(&depth);
        let (width, height) = SIZE_PX;
        let mut command = self.program.command();
        command
            .arg("render")
            .arg(file)
            .args(["--renderer", renderer]);
        command.args([
            "--background",
            "#20242c",
            "--size",
            &format!("{width}x{height}"),
        ]);
        command
            .arg("--view")
            .arg(&self.view)
            .arg("--out")
            .arg(&picture)
            .arg("--aov")
            .arg(aov)
            .args(arguments);
        let finished = crate::program::finish(command, crate::program::TIME_LIMIT)?;
        anyhow::ensure!(
            finished.status.success(),
            "{} with {renderer}:\n{}",
            finished.status,
            finished.stderr
        );
        Ok(Rendering {
            picture: compare::read(&picture)?,
            depth: read_depth(&depth)?,
        })
    }
}

fn read_depth(path: &Path) -> Result<Vec<f32>> {
    let image = read_first_flat_layer_from_file(path)
        .with_context(|| format!("reading {}", path.display()))?;
    let channel = image
        .layer_data
        .channel_data
        .list
        .first()
        .context("the depth file has no channel")?;
    match &channel.sample_data {
        FlatSamples::F32(values) => Ok(values.clone()),
        _ => anyhow::bail!("the depth file does not hold 32-bit floats"),
    }
}
