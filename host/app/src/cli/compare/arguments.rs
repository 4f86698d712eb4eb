//! Options that every comparison has, whether of renderers or of one setting's values.

use std::path::PathBuf;

use clap::Args;

use crate::cli::load::LoadArguments;
use crate::cli::measuring::entries::{EntryText, entry_text};
use crate::cli::measuring::limits::Limit;
use crate::cli::measuring::look::LookArguments;

/// What is drawn, from where, what it is measured by, and where it goes.
#[derive(Debug, Args)]
pub(crate) struct ComparisonArguments {
    /// Files of points or meshes; each becomes an object
    #[arg(value_name = "FILE", required = true)]
    pub(crate) files: Vec<PathBuf>,
    /// The renderer that the others are measured by
    #[arg(long, value_name = "RENDERER", value_parser = entry_text, required_unless_present = "reference_images")]
    pub(crate) reference: Option<EntryText>,
    /// Folder of pictures to measure by instead: reference_000.png for the first view, and so on
    #[arg(long, value_name = "DIR", conflicts_with = "reference")]
    pub(crate) reference_images: Option<PathBuf>,
    /// Where to look from: view FILEs, or orbit:N for N views around the scene, separated by commas
    #[arg(
        long,
        value_name = "FILE|orbit:N",
        value_delimiter = ',',
        default_value = "orbit:1"
    )]
    pub(crate) views: Vec<String>,
    /// Targets to draw beside the pictures, separated by commas: depth, normal, … or 'all'
    #[arg(long, value_name = "KEYS", value_delimiter = ',')]
    pub(crate) targets: Vec<String>,
    /// Pictures of each view and renderer that are timed, in turns with the others'; 0 times the first one alone
    #[arg(long, value_name = "N", default_value = "5", value_parser = clap::value_parser!(u32).range(0..=10_000))]
    pub(crate) frames: u32,
    /// Folder for pictures, maps, metrics.json and report.html; is made, and files of the same names are replaced
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    #[command(flatten)]
    pub(crate) look: LookArguments,
    /// Fail (exit code 1) if a mean over the views is above this: flip, flip_p99, ms, cpu_ms or gpu_ms; may be given several
    /// times
    #[arg(long, value_name = "QUANTITY=NUMBER", help_heading = "Limits")]
    pub(crate) fail_above: Vec<Limit>,
    /// Fail (exit code 1) if a mean over the views is below this: psnr or ssim; may be given several times
    #[arg(long, value_name = "QUANTITY=NUMBER", help_heading = "Limits")]
    pub(crate) fail_below: Vec<Limit>,
    #[command(flatten)]
    pub(crate) load: LoadArguments,
}
