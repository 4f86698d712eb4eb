//! Finding the built program and its plugins, and running the command line.

use std::ffi::OsStr;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::thread::JoinHandle;
use std::time::Duration;

use anyhow::{Context as _, Result, bail, ensure};
use tempfile::TempDir;
use wait_timeout::ChildExt as _;

/// How long a command may take. Far above what any takes alone: the tests run side by side, on small machines too.
pub const TIME_LIMIT: Duration = Duration::from_mins(3);

/// The program, with user folders of its own, so that no test sees what another (or the user) left there.
#[derive(Debug)]
pub struct Program {
    path: PathBuf,
    home: TempDir,
}

/// How a command ended.
#[derive(Debug)]
pub struct Finished {
    /// The exit status, of which tests mostly want [`Finished::code`].
    pub status: ExitStatus,
    /// All of standard output.
    pub stdout: String,
    /// All of standard error.
    pub stderr: String,
}

impl Program {
    /// Finds the program that was built with these tests.
    ///
    /// # Errors
    /// When it was not built; cargo builds no other package's program for a test.
    pub fn find() -> Result<Self> {
        let path = profile_folder().join(format!("pointstage{}", std::env::consts::EXE_SUFFIX));
        ensure!(
            path.is_file(),
            "{} is not there; run `cargo xtask test`, or `cargo build --workspace` first",
            path.display()
        );
        let home = tempfile::tempdir().context("making a folder for the program's files")?;
        Ok(Self { path, home })
    }

    /// Where the program keeps its files in this test: caches, settings, quarantine.
    pub fn home(&self) -> &Path {
        self.home.path()
    }

    /// The program in its own surroundings, without arguments yet. Standard input is closed.
    pub fn command(&self) -> Command {
        let mut command = Command::new(&self.path);
        let home = self.home();
        command
            .stdin(Stdio::null())
            .env("HOME", home)
            .env("XDG_RUNTIME_DIR", home);
        let folders = [
            "XDG_CONFIG_HOME",
            "XDG_CACHE_HOME",
            "XDG_DATA_HOME",
            "XDG_STATE_HOME",
        ];
        for (name, folder) in folders.iter().zip(["config", "cache", "data", "state"]) {
            command.env(name, home.join(folder));
        }
        // No test may open a window on the developer's screen; the window tests name their own display.
        command
            .env_remove("DISPLAY")
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("POINTSTAGE_PLUGIN_PATH");
        if let Some(driver) = software_driver() {
            // The second is the name that loaders before 1.3.207 know.
            command
                .env("VK_DRIVER_FILES", &driver)
                .env("VK_ICD_FILENAMES", &driver);
        }
        command
    }

    /// Runs the program with `arguments` to its end, at most [`TIME_LIMIT`].
    ///
    /// # Errors
    /// When it cannot be started or takes too long. Failing is no error here: see [`Finished::code`].
    pub fn run<A: AsRef<OsStr>>(&self, arguments: impl IntoIterator<Item = A>) -> Result<Finished> {
        let mut command = self.command();
        command.args(arguments);
        finish(command, TIME_LIMIT)
    }

    /// Runs the program with `arguments` and asks that it succeeds; returns its standard output.
    ///
    /// # Errors
    /// When it fails; the message holds its standard error.
    pub fn succeed<A: AsRef<OsStr>>(
        &self,
        arguments: impl IntoIterator<Item = A>,
    ) -> Result<String> {
        let finished = self.run(arguments)?;
        ensure!(
            finished.status.success(),
            "{}:\n{}",
            finished.status,
            finished.stderr
        );
        Ok(finished.stdout)
    }
}

impl Finished {
    /// The exit code; `None` when a signal ended the program.
    pub fn code(&self) -> Option<i32> {
        self.status.code()
    }
}

/// Runs `command` to its end and collects what it writes.
///
/// # Errors
/// When it cannot be started, or still runs after `limit`; it is killed then.
pub fn finish(mut command: Command, limit: Duration) -> Result<Finished> {
    let line = format!("{command:?}");
    let mut child = command
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .with_context(|| format!("starting {line}"))?;
    let stdout = child.stdout.take().map(collect);
    let stderr = child.stderr.take().map(collect);
    let status = child
        .wait_timeout(limit)
        .with_context(|| format!("waiting for {line}"))?;
    if status.is_none() {
        child.kill().with_context(|| format!("ending {line}"))?;
        child.wait().with_context(|| format!("ending {line}"))?;
    }
    let stdout = text(stdout);
    let stderr = text(stderr);
    let Some(status) = status else {
        bail!(
            "{line} still ran after {} s; so far it had said:\n{stderr}",
            limit.as_secs()
        );
    };
    Ok(Finished {
        status,
        stdout,
        stderr,
    })
}

/// The library of the first-party plugin in `plugins/<name>`.
///
/// # Errors
/// When it was not built.
pub fn plugin_library(name: &str) -> Result<PathBuf> {
    let (prefix, suffix) = (std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    let path = profile_folder().join(format!("{prefix}pointstage_{name}{suffix}"));
    ensure!(
        path.is_file(),
        "{} is not there; run `cargo xtask test`, or `cargo build --workspace` first",
        path.display()
    );
    Ok(path)
}

/// The folder that holds the program and the plugins of the profile of this test, such as `target/debug`.
pub fn profile_folder() -> PathBuf {
    // Tests run from target/<profile>/deps/.
    let test = std::env::current_exe().unwrap_or_default();
    test.ancestors()
        .nth(2)
        .map_or_else(PathBuf::new, Path::to_path_buf)
}

/// Cargo's output folder.
pub fn target_folder() -> PathBuf {
    profile_folder()
        .parent()
        .map_or_else(PathBuf::new, Path::to_path_buf)
}

/// The description of Mesa's Vulkan driver for the CPU, whose pictures the golden images are.
pub fn software_driver() -> Option<PathBuf> {
    let files = std::fs::read_dir("/usr/share/vulkan/icd.d").ok()?;
    let mut paths = files.filter_map(|file| Some(file.ok()?.path()));
    paths.find(|path| {
        path.file_name()
            .is_some_and(|name| name.to_string_lossy().starts_with("lvp_"))
    })
}

/// Reads a pipe to its end beside the test, so that neither side waits for the other.
fn collect(mut pipe: impl Read + Send + 'static) -> JoinHandle<Vec<u8>> {
    std::thread::spawn(move || {
        let mut bytes = Vec::new();
        // What came before an error is all there is to show.
        let _ = pipe.read_to_end(&mut bytes);
        bytes
    })
}

fn text(reader: Option<JoinHandle<Vec<u8>>>) -> String {
    let bytes = reader
        .and_then(|reader| reader.join().ok())
        .unwrap_or_default();
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_that_takes_too_long_is_ended() {
        let mut command = Command::new("sleep");
        command.arg("600");
        let error = finish(command, Duration::from_millis(50))
            .unwrap_err()
            .to_string();
        assert!(error.contains("still ran"), "{error}");
    }

    #[test]
    fn both_streams_and_the_code_are_collected() {
        let mut command = Command::new("sh");
        command.args(["-c", "echo out; echo err >&2; exit 2"]);
        let finished = finish(command, TIME_LIMIT).unwrap();
        assert_eq!(
            (
                finished.code(),
                finished.stdout.as_str(),
                finished.stderr.as_str()
            ),
            (Some(2), "out\n", "err\n")
        );
    }
}
