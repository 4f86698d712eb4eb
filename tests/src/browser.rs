//! A web page in a browser without a window: what the browser makes of it.

use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::mpsc::channel;
use std::time::{Duration, Instant};

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
const TIME_LIMIT: Duration = Duration::from_mins(3);

/// Chromium, if there is one.
pub fn find() -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    let folders: Vec<PathBuf> = std::env::split_paths(&path).collect();
    let mut places = NAMES
        .iter()
        .flat_map(|name| folders.iter().map(move |folder| folder.join(name)));
    places.find(|place| place.is_file())
}

/// What the page tells the console in lines that begin with `mark`: the first `count` of them, without the mark.
///
/// The browser runs by the wall's clock and is ended once they have come.
///
/// * `home`: a folder for the browser's own files.
///
/// # Errors
/// When the browser does not start, or tells fewer in time; with all that it said.
pub fn told(
    browser: &Path,
    page: &Path,
    home: &Path,
    mark: &str,
    count: usize,
) -> Result<Vec<String>> {
    let mut command = open(browser, home);
    command
        .args(["--enable-logging=stderr", "--window-size=1600,900"])
        .arg(url(page))
        .stdout(Stdio::null())
        .stderr(Stdio::piped());
    let mut child = command.spawn().context("starting the browser")?;
    let (send, lines) = channel();
    let stderr = child.stderr.take().context("the browser has no log")?;
    std::thread::spawn(move || {
        let lines = BufReader::new(stderr).lines().map_while(Result::ok);
        // The other end is gone once all was told.
        for line in lines {
            let _ = send.send(line);
        }
    });
    let start = format!("\"{mark}");
    let deadline = Instant::now() + TIME_LIMIT;
    let (mut told, mut log) = (Vec::new(), String::new());
    while told.len() < count {
        let left = deadline.saturating_duration_since(Instant::now());
        let Ok(line) = lines.recv_timeout(left) else {
            break;
        };
        // `[…:CONSOLE:2] "mark and text", source: file:///… (2)`
        let text = line.split_once(&start).map(|(_, text)| text);
        if let Some((text, _)) = text.and_then(|text| text.rsplit_once("\", source: ")) {
            told.push(text.to_owned());
        }
        log.push_str(&line);
        log.push('\n');
    }
    child.kill().context("ending the browser")?;
    child.wait().context("ending the browser")?;
    ensure!(
        told.len() == count,
        "the page told {} of {count} in {} s: {log}",
        told.len(),
        TIME_LIMIT.as_secs()
    );
    Ok(told)
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
