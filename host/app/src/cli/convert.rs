//! `pointstage convert`: files into PLY or SFL files, with normals, radii and axes estimated on the way.

mod estimates;
mod progress;

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use clap::{Args, ValueEnum};
use pointstage_engine::plugins::Registry;
use pointstage_scene::estimate::{DEFAULT_NEIGHBOURS, NEIGHBOURS_RANGE, Steps, estimate};
use pointstage_scene::{
    Estimation, Job, LoadOptions, Loaders, Object, PlyEncoding, SaveFormat, WarningKind, Warnings,
    load_with, merge, save,
};

use super::load::ReadArguments;
use super::{Failure, Globals, Outcome};
use crate::file_loaders::loaders;
use estimates::Estimate;
use progress::with_progress;

/// Arguments of `convert`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  pointstage convert scan.laz --out scan.ply
  pointstage convert scan.xyz --out scan.sfl --estimate normals,radii --orient
  pointstage convert head.obj --out head.ply --ascii
  pointstage convert a.e57 b.e57 --out converted --format ply
  pointstage convert a.e57 b.e57 --out both.ply --merge

Columns of the file stay as they are, and none are added that --estimate does not name: what a mesh or a scan lacks is
still missing in the new file, and found again when that is opened.")]
pub(crate) struct ConvertArguments {
    /// Files of points or meshes
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
    /// File to write, .ply or .sfl; a folder if there are several FILEs that are not merged
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Format to write [default: by the ending of --out]
    #[arg(long, value_enum, value_name = "NAME", help_heading = "Writing")]
    format: Option<FormatName>,
    /// Write PLY as bytes, the default
    #[arg(long, conflicts_with_all = ["ascii", "big_endian"], help_heading = "Writing")]
    binary: bool,
    /// Write PLY as text, with all digits
    #[arg(long, conflicts_with = "big_endian", help_heading = "Writing")]
    ascii: bool,
    /// Write PLY as bytes, the largest of each number first
    #[arg(long, help_heading = "Writing")]
    big_endian: bool,
    /// Write one file of all FILEs: what stands in one place stays in place
    #[arg(long, help_heading = "Writing")]
    merge: bool,
    /// Replace files that are there
    #[arg(long, help_heading = "Writing")]
    force: bool,
    /// Estimate these anew, from the faces of a mesh or from neighbours; what the file has of them is replaced
    #[arg(
        long,
        value_enum,
        value_delimiter = ',',
        value_name = "WHAT,…",
        help_heading = "Estimating"
    )]
    estimate: Vec<Estimate>,
    /// Bring the normals of points to one side all over the object, outward; those of the file too
    #[arg(long, help_heading = "Estimating")]
    orient: bool,
    /// Neighbours that a point is compared with, 3 to 64
    #[arg(long = "k", value_name = "N", default_value_t = DEFAULT_NEIGHBOURS, value_parser = neighbours, help_heading = "Estimating")]
    neighbours: usize,
    #[command(flatten)]
    reading: ReadArguments,
}

/// A format on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum FormatName {
    /// Holds all columns and triangles
    Ply,
    /// Surfels, for PointShop3D
    Sfl,
}

fn neighbours(text: &str) -> Result<usize, String> {
    let count = text.parse::<usize>().ok();
    count
        .filter(|count| NEIGHBOURS_RANGE.contains(count))
        .ok_or_else(|| {
            let (least, most) = (NEIGHBOURS_RANGE.start(), NEIGHBOURS_RANGE.end());
            format!("expected a count from {least} to {most}, such as {DEFAULT_NEIGHBOURS}")
        })
}

/// Converts each file.
pub(crate) fn run(globals: &Globals, arguments: &ConvertArguments) -> Outcome {
    let registry = OnceLock::new();
    let options = globals.discover_options();
    let discover = move || Arc::new(Registry::discover(&options));
    let loaders = loaders(move || Some(Arc::clone(registry.get_or_init(&discover))));
    let plan = Plan::new(arguments, &loaders)?;
    for (from, to) in &plan.files {
        plan.convert(from, to, &loaders)?;
    }
    Ok(())
}

/// What to do, checked as a whole before anything is read.
struct Plan {
    /// Files that become one, and where it goes.
    files: Vec<(Vec<PathBuf>, PathBuf)>,
    format: SaveFormat,
    options: LoadOptions,
    steps: Steps,
}

impl Plan {
    fn new(arguments: &ConvertArguments, loaders: &Loaders) -> Outcome<Self> {
        let out = &arguments.out;
        let is_folder = (arguments.files.len() > 1 && !arguments.merge) || out.is_dir();
        if arguments.merge && is_folder {
            return Err(Failure::usage(format!(
                "'{}' is a folder; --merge writes one file, name it",
                out.display()
            )));
        }
        if is_folder && !out.is_dir() {
            return Err(Failure::usage(format!(
                "'{}' is no folder, and several files are converted; make the folder first, convert one file, or say --merge for one file of all",
                out.display()
            )));
        }
        let format = format_of(arguments, is_folder)?;
        let files = if arguments.merge {
            vec![(arguments.files.clone(), out.clone())]
        } else {
            let pairs = targets(&arguments.files, out, is_folder, format)?;
            pairs
                .into_iter()
                .map(|(from, to)| (vec![from], to))
                .collect()
        };
        for (from, to) in &files {
            check_target(from, to, arguments.force)?;
        }
        let mut options = LoadOptions {
            estimation: Estimation::FileOnly,
            ..LoadOptions::default()
        };
        arguments.reading.apply(&mut options, loaders)?;
        let names = |what| arguments.estimate.contains(&what);
        Ok(Self {
            files,
            format,
            options,
            steps: Steps {
                normals: names(Estimate::Normals),
                orientation: arguments.orient,
                radii: names(Estimate::Radii),
                axes: names(Estimate::Axes),
                neighbours: arguments.neighbours,
            },
        })
    }

    /// What a file holds.
    fn read(&self, from: &Path, loaders: &Loaders) -> Outcome<Object> {
        let name = from.file_name().unwrap_or(from.as_os_str());
        let loaded = with_progress(&name.to_string_lossy(), |job| {
            load_with(loaders, from, &self.options, job)
        })?;
        tell(from, &loaded.warnings);
        Ok(loaded.object)
    }

    fn convert(&self, files: &[PathBuf], to: &Path, loaders: &Loaders) -> Outcome {
        let objects = files.iter().map(|from| self.read(from, loaders));
        let mut objects = objects.collect::<Outcome<Vec<Object>>>()?;
        // What is said of the object is said of its file; of several, of the file that they become.
        let (mut object, from) = if let [from] = files {
            (objects.remove(0), from.as_path())
        } else {
            let all: Vec<&Object> = objects.iter().collect();
            let stem = to.file_stem().unwrap_or(to.as_os_str());
            let merged = merge(&all, stem.to_string_lossy()).map_err(anyhow::Error::from)?;
            drop(objects);
            (merged, to)
        };
        let name = from.file_name().unwrap_or(from.as_os_str());
        let name = name.to_string_lossy();
        if !self.steps.is_empty() {
            let (geometry, warnings) = with_progress(&name, |job: &Job| {
                estimate(&object.geometry, &self.steps, job)
            })?;
            tell(from, &warnings);
            object.geometry = Arc::new(geometry);
        }
        if self.format == SaveFormat::Sfl {
            advise(from, &object);
        }
        let saved = with_progress(&name, |job| save(&object, to, self.format, job))?;
        tell(to, &saved.warnings);
        let geometry = &object.geometry;
        for picture in &saved.pictures {
            eprintln!("{}: picture of its texture", picture.display());
        }
        eprintln!(
            "{}: {} surfels, {} triangles",
            to.display(),
            geometry.surfel_count,
            match self.format {
                SaveFormat::Ply(_) => geometry.triangle_count(),
                SaveFormat::Sfl => 0,
            }
        );
        Ok(())
    }
}

/// The format to write.
fn format_of(arguments: &ConvertArguments, is_folder: bool) -> Outcome<SaveFormat> {
    let encoding = if arguments.ascii {
        PlyEncoding::Ascii
    } else if arguments.big_endian {
        PlyEncoding::BigEndian
    } else {
        PlyEncoding::LittleEndian
    };
    let out = &arguments.out;
    let named = if is_folder {
        None
    } else {
        SaveFormat::of_name(out)
    };
    let format = match (arguments.format, named) {
        (Some(FormatName::Ply), _) | (None, Some(SaveFormat::Ply(_))) => SaveFormat::Ply(encoding),
        (Some(FormatName::Sfl), _) | (None, Some(SaveFormat::Sfl)) => SaveFormat::Sfl,
        (None, None) => {
            return Err(Failure::usage(format!(
                "'{}' does not say the format; expected a name that ends in .ply or .sfl, or --format",
                out.display()
            )));
        }
    };
    let is_encoded = arguments.binary || arguments.ascii || arguments.big_endian;
    if format == SaveFormat::Sfl && is_encoded {
        return Err(Failure::usage(
            "--binary, --ascii and --big-endian are for PLY; SFL files have one form",
        ));
    }
    Ok(format)
}

/// Where each file goes.
fn targets(
    files: &[PathBuf],
    out: &Path,
    is_folder: bool,
    format: SaveFormat,
) -> Outcome<Vec<(PathBuf, PathBuf)>> {
    if !is_folder {
        return Ok(files
            .iter()
            .map(|file| (file.clone(), out.to_path_buf()))
            .collect());
    }
    let extension = match format {
        SaveFormat::Ply(_) => "ply",
        SaveFormat::Sfl => "sfl",
    };
    let mut targets: Vec<(PathBuf, PathBuf)> = Vec::new();
    for file in files {
        let stem = file.file_stem().unwrap_or(OsStr::new("converted"));
        let mut name = stem.to_owned();
        name.push(".");
        name.push(extension);
        let target = out.join(name);
        if let Some((other, _)) = targets.iter().find(|(_, taken)| *taken == target) {
            return Err(Failure::usage(format!(
                "'{}' and '{}' would both become {}; convert one of them by itself",
                other.display(),
                file.display(),
                target.display()
            )));
        }
        targets.push((file.clone(), target));
    }
    Ok(targets)
}

/// Refuses to replace what the user has not said to.
fn check_target(from: &[PathBuf], to: &Path, force: bool) -> Outcome {
    if to.exists() && !force {
        let mut files = from.iter();
        let is_same = files.any(|file| file.canonicalize().ok() == to.canonicalize().ok());
        let which = if is_same {
            "the file that is read"
        } else {
            "there already"
        };
        return Err(Failure::Failed(anyhow::anyhow!(
            "{} is {which}; name another file, or say --force to replace it",
            to.display()
        )));
    }
    Ok(())
}

/// Says what was done: a note where it was asked for, else a warning.
fn tell(path: &Path, warnings: &Warnings) {
    for warning in warnings.iter() {
        let word = match warning.kind {
            WarningKind::NormalsEstimated
            | WarningKind::NormalsOriented
            | WarningKind::RadiiEstimated
            | WarningKind::AxesEstimated
            | WarningKind::Flipped => "note",
            _ => "warning",
        };
        eprintln!("{word}: {}: {warning}", path.display());
    }
}

/// Says so when surfels will have nothing to be drawn by.
fn advise(path: &Path, object: &Object) {
    let origins = &object.geometry.origins;
    let lacking = estimates::missing(*origins);
    if !lacking.is_empty() {
        eprintln!(
            "note: {}: the surfels have no {}; --estimate {} makes them",
            path.display(),
            lacking.join(" and no "),
            lacking.join(",")
        );
    }
}
