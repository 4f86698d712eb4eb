//! A web page in a browser without a window: what the browser makes of it.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use anyhow::{Context as _, Result, ensure};

use crate::program::finish;

/// Names under which the browser may be on the path.
const NAMES: [&str; 4] = [
    "chromium",
    "chromium-headless-shell",
    "chromium-browser",
    "google-chrome",
];

/// How long a page may take: a browser's first start on a busy machine is slow.
const TIME_LIMIT: Duration = Duration::from_secs(90);

/// Chromium, if there is one.
pub fn find() -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    let folders: Vec<PathBuf> = std::env::split_paths(&path).collect();
    let mut places = NAMES
        .iter()
        .flat_map(|name| folders.iter().map(move |folder| folder.join(name)));
    places.find(|place| place.is_file())
}

/// The page's document as the browser has it once its scripts have had their time.
///
/// * `home`: a folder for the browser's own files.
///
/// # Errors
/// When the browser does not start or says nothing.
pub fn document(browser: &Path, page: &Path, home: &Path) -> Result<String> {
    let mut command = open(browser, home);
    command
        .args(["--virtual-time-budget=10000", "--window-size=1200,900"])
        .arg("--dump-dom")
        .arg(url(page));
    let finished = finish(command, TIME_LIMIT).context("running the browser")?;
    ensure!(
        finished.stdout.contains("<html"),
        "the browser showed no document: {}",
        finished.stderr
    );
    Ok(finished.stdout)
}

/// What the page looks like in a window of this size, px.
///
/// * `home`: a folder for the browser's own files.
///
/// # Errors
/// When the browser does not start or draws nothing.
pub fn picture(
    browser: &Path,
    page: &Path,
    home: &Path,
    [width, height]: [u32; 2],
) -> Result<image::RgbaImage> {
    let file = home.join("page.png");
    let mut command = open(browser, home);
    command
        .arg(format!("--window-size={width},{height}"))
        .args(["--hide-scrollbars", "--virtual-time-budget=5000"])
        .arg(format!("--screenshot={}", file.display()))
        .arg(url(page));
    let finished = finish(command, TIME_LIMIT).context("running the browser")?;
    crate::compare::read(&file).with_context(|| format!("no picture: {}", finished.stderr))
}

/// The browser without a window, in a world of its own.
fn open(browser: &Path, home: &Path) -> Command {
    let mut command = Command::new(browser);
    command
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--no-first-run",
        ])
        // Frames of files from the same folder may talk to each other.
        .arg("--allow-file-access-from-files")
        .arg(format!(
            "--user-data-dir={}",
            home.join("browser").display()
        ))
        .env("HOME", home);
    command
}

fn url(page: &Path) -> String {
    format!("file://{}", page.display())
}
