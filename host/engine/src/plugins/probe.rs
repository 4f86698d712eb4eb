//! First contact: examines plugins in a child process with a time limit, so that a crash or a hang costs nothing.

use super::child::{ANSWER_MARK, Answer, HIDDEN_COMMAND, TrialRequest};
use super::verdict::{Verdict, VerdictClass};
use std::ffi::OsStr;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};
use wait_timeout::ChildExt as _;

pub use super::child::child_main;

/// Bytes of each of the child's outputs that are kept.
const LONGEST_OUTPUT: usize = 1 << 20;
/// Bytes of the child's standard error that a verdict quotes.
const QUOTED_OUTPUT: usize = 2_000;
/// How long the ends of a finished child's outputs are waited for: a grandchild may hold them open.
const OUTPUT_GRACE: Duration = Duration::from_secs(1);

/// How files are examined before they are loaded.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Examination {
    /// Only the file is looked at: whole, and with a good manifest. For tests, and for a child that tries one plugin.
    #[default]
    ManifestOnly,
    /// New and changed files are loaded in a child process first.
    Child(ChildProgram),
}

/// The program that examines: one whose `main` calls [`child_main`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChildProgram {
    /// The program's file.
    pub program: PathBuf,
    /// How long loading one library may take.
    pub check_limit: Duration,
    /// How long one frame may take, compiling shaders on a software adapter included.
    pub trial_limit: Duration,
}

impl ChildProgram {
    /// `program` with limits that a loaded machine can keep.
    pub fn new(program: PathBuf) -> Self {
        Self {
            program,
            check_limit: Duration::from_secs(10),
            trial_limit: Duration::from_mins(2),
        }
    }
}

/// What an examination found.
#[derive(Clone, Debug)]
pub(super) struct Examined {
    pub(super) verdict: Verdict,
    /// The border version of the library, if it got that far.
    pub(super) api: Option<String>,
    pub(super) time: Duration,
}

/// Loads `file` in a child and checks it.
pub(super) fn check_file(program: &ChildProgram, file: &Path) -> Examined {
    let name = super::library::name_of(file);
    examine(
        program,
        "check",
        file.as_os_str(),
        program.check_limit,
        &name,
    )
}

/// Draws a frame in a child: first without the plugin, so that a driver's fault is not blamed on it.
///
/// `control` is the outcome of the control run, if one was made before for the same device.
pub(super) fn try_plugin(
    program: &ChildProgram,
    request: &TrialRequest,
    control: &mut Option<Verdict>,
) -> Verdict {
    let run = |request: &TrialRequest, name: &str| {
        let json = serde_json::to_string(request).unwrap_or_default();
        examine(program, "try", OsStr::new(&json), program.trial_limit, name).verdict
    };
    let control = control.get_or_insert_with(|| {
        run(
            &TrialRequest {
                plugin: None,
                ..request.clone()
            },
            "the control run",
        )
    });
    if control.class != VerdictClass::Ok {
        let message = format!(
            "not tried out: a frame without any plugin fails on this device too ({}); see to the graphics driver",
            control.message
        );
        return Verdict::new(VerdictClass::NotExamined, message)
            .with_detail(control.detail.clone());
    }
    let name = request
        .plugin
        .as_ref()
        .map_or("the control run", |(_, id)| id.as_str());
    run(request, name)
}

fn examine(
    program: &ChildProgram,
    what: &str,
    subject: &OsStr,
    limit: Duration,
    name: &str,
) -> Examined {
    let start = Instant::now();
    let finished = |verdict, api| Examined {
        verdict,
        api,
        time: start.elapsed(),
    };
    let not_examined = |error: std::io::Error| {
        let message = format!(
            "{name}: cannot be examined: {} does not run: {error}",
            program.program.display()
        );
        finished(Verdict::new(VerdictClass::NotExamined, message), None)
    };
    let child = Command::new(&program.program)
        .arg(HIDDEN_COMMAND)
        .arg(what)
        .arg(subject)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn();
    let mut child = match child {
        Ok(child) => child,
        Err(error) => return not_examined(error),
    };
    let output = collect(child.stdout.take());
    let complaints = collect(child.stderr.take());
    let status = match child.wait_timeout(limit) {
        Ok(status) => status,
        Err(error) => {
            end(&mut child);
            return not_examined(error);
        }
    };
    if status.is_none() {
        end(&mut child);
    }
    let output = output.recv_timeout(OUTPUT_GRACE).unwrap_or_default();
    let complaints = complaints.recv_timeout(OUTPUT_GRACE).unwrap_or_default();
    let answer = answer_in(&output);
    let verdict = classify(status, answer.as_ref(), limit, name);
    let api = answer.and_then(|answer| answer.api);
    let verdict = if verdict.detail.is_empty() && verdict.class != VerdictClass::Ok {
        verdict.with_detail(last_of(&complaints))
    } else {
        verdict
    };
    finished(verdict, api)
}

/// What a child's end means.
fn classify(
    status: Option<ExitStatus>,
    answer: Option<&Answer>,
    limit: Duration,
    name: &str,
) -> Verdict {
    let Some(status) = status else {
        return Verdict::new(
            VerdictClass::Hung,
            format!(
                "{name}: gave no answer within {:.0} s when it was tried in a process of its own; it is not loaded",
                limit.as_secs_f64()
            ),
        );
    };
    if let Some(signal) = signal_of(status) {
        return Verdict::new(
            VerdictClass::Crashed,
            format!(
                "{name}: crashed ({signal}) when it was tried in a process of its own; it is not loaded"
            ),
        );
    }
    match answer {
        Some(answer) if status.success() => answer.verdict.clone(),
        _ => Verdict::new(
            VerdictClass::OddExit,
            format!(
                "{name}: ended the process that tried it ({status}), without an answer; it is not loaded"
            ),
        ),
    }
}

/// The signal or exception that ended a process.
#[cfg(unix)]
fn signal_of(status: ExitStatus) -> Option<String> {
    use std::os::unix::process::ExitStatusExt as _;
    let signal = status.signal()?;
    let name = match signal {
        4 => "SIGILL",
        6 => "SIGABRT",
        7 => "SIGBUS",
        8 => "SIGFPE",
        9 => "SIGKILL",
        11 => "SIGSEGV",
        _ => return Some(format!("signal {signal}")),
    };
    Some(name.to_owned())
}

/// The signal or exception that ended a process.
#[cfg(not(unix))]
fn signal_of(status: ExitStatus) -> Option<String> {
    // NTSTATUS errors have the two highest bits set, so they are negative.
    status
        .code()
        .filter(|code| *code < 0)
        .map(|code| format!("exception {code:#010x}"))
}

fn end(child: &mut Child) {
    // Both fail only if it has ended by itself.
    let _ = child.kill();
    let _ = child.wait();
}

/// Reads an output to its end on a thread of its own, so that a child never blocks on a full pipe.
fn collect(output: Option<impl Read + Send + 'static>) -> Receiver<Vec<u8>> {
    let (sender, receiver) = channel();
    std::thread::spawn(move || {
        let mut kept = Vec::new();
        let mut buffer = [0; 8_192];
        if let Some(mut output) = output {
            while let Ok(count @ 1..) = output.read(&mut buffer) {
                kept.extend_from_slice(&buffer[..count]);
                if kept.len() > LONGEST_OUTPUT {
                    kept.drain(..kept.len() - LONGEST_OUTPUT);
                }
            }
        }
        // Nobody listens any more if the wait is over.
        let _ = sender.send(kept);
    });
    receiver
}

/// The last answer in a child's output.
fn answer_in(output: &[u8]) -> Option<Answer> {
    String::from_utf8_lossy(output)
        .lines()
        .rev()
        .find_map(|line| serde_json::from_str(line.strip_prefix(ANSWER_MARK)?).ok())
}

fn last_of(complaints: &[u8]) -> String {
    let text = String::from_utf8_lossy(complaints);
    let start = text.ceil_char_boundary(text.len().saturating_sub(QUOTED_OUTPUT));
    text[start..].trim().to_owned()
}

#[cfg(all(test, unix))]
#[path = "probe_tests.rs"]
mod tests;
