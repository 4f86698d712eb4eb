//! Recorded commands: checked, encoded and submitted, all or nothing.

use super::Owner;
use super::object::catching;
use super::service::{Caller, GpuService};
use super::timing::{PassTimes, Queries, Timing, Timings};
use super::walk::{Encoded, PendingReadBack, Walk};
use crate::device::{GpuDevice, GpuError};
use pointstage_plugin_api::abi::commands::{CommandListRecord, DecodeError};
use std::sync::Arc;
use std::time::Duration;

/// Operation numbers of `BeginRenderPass` and `BeginComputePass`, which the border freezes.
const BEGINNINGS: [u32; 2] = [1, 3];

/// A submitted list of commands.
#[derive(Debug)]
pub struct Replay {
    passes: Vec<String>,
    submission: wgpu::SubmissionIndex,
    timing: Option<Timing>,
    gpu: Arc<GpuDevice>,
}

impl Replay {
    /// Labels of the passes, in order.
    pub fn passes(&self) -> &[String] {
        &self.passes
    }

    /// The passes' times on the device, once it has finished. Never waits.
    pub fn times(&mut self) -> PassTimes {
        // A lost device calls the mapping's callback with an error, which is 'unavailable' below.
        self.gpu.check_alive().ok();
        match &mut self.timing {
            Some(timing) => timing.times(&self.passes),
            None => PassTimes::Unavailable,
        }
    }

    /// Waits until the device has done these commands.
    ///
    /// # Errors
    ///
    /// The device is lost, or `timeout` has passed.
    pub fn wait(&self, timeout: Duration) -> Result<(), GpuError> {
        self.gpu.wait(Some(self.submission.clone()), timeout)
    }
}

impl GpuService {
    /// Checks the commands of an owner and runs them. Thread: any; the commands of one thread run in order.
    ///
    /// # Errors
    ///
    /// The first thing that is wrong, with the command's index and name; then nothing was submitted.
    pub fn replay(
        &self,
        owner: Owner,
        list: &CommandListRecord,
        timings: Timings,
    ) -> Result<Replay, GpuError> {
        catching(|| {
            self.gpu.check_not_lost()?;
            self.run(&self.caller(owner)?, list, timings)
        })
    }

    /// Checks the commands of an owner without running them.
    ///
    /// # Errors
    ///
    /// As [`replay`](Self::replay), but for what only the submission would find.
    pub fn check(&self, owner: Owner, list: &CommandListRecord) -> Result<(), GpuError> {
        catching(|| {
            self.gpu.check_not_lost()?;
            let caller = self.caller(owner)?;
            let mut outcome = Ok(());
            let scope = self.gpu.scoped(|| {
                outcome = self.encode(&caller, list, None).map(drop);
            });
            outcome?;
            scope.map_err(|error| self.locate(&caller, list, error))
        })
    }

    pub(super) fn run(
        &self,
        caller: &Caller,
        list: &CommandListRecord,
        timings: Timings,
    ) -> Result<Replay, GpuError> {
        let passes = list
            .commands
            .iter()
            .filter(|command| BEGINNINGS.contains(&command.operation))
            .count();
        let queries = self.timings.take(&self.gpu.device, timings, passes);
        // Our own message names the command, so it goes before what wgpu may say of the same.
        let mut outcome = None;
        let scope = self.gpu.scoped(|| {
            outcome = Some(self.submit(caller, list, queries.as_ref()));
        });
        let error = match (outcome, scope) {
            (Some(Ok((encoded, submission))), Ok(())) => {
                for pending in encoded.read_backs {
                    pending.ticket.fill(pending.staging, pending.charge);
                }
                return Ok(Replay {
                    passes: encoded.passes,
                    submission,
                    timing: queries.map(|queries| Timing::start(queries, &self.timings)),
                    gpu: Arc::clone(&self.gpu),
                });
            }
            (_, Err(lost @ GpuError::DeviceLost(_))) => lost,
            (Some(Err(error)), _) => error,
            (_, Err(error)) => self.locate(caller, list, error),
            (None, Ok(())) => unreachable!("the scope runs the closure"),
        };
        if let Some(queries) = queries {
            self.timings.give_back(queries);
        }
        Err(error)
    }

    /// Encodes all commands and submits them. wgpu refuses to submit what it refused to encode.
    fn submit(
        &self,
        caller: &Caller,
        list: &CommandListRecord,
        queries: Option<&Queries>,
    ) -> Result<(Submitted, wgpu::SubmissionIndex), GpuError> {
        let Encoded {
            commands,
            passes,
            read_backs,
        } = self.encode(caller, list, queries)?;
        let submission = self.gpu.queue.submit([commands]);
        Ok((Submitted { passes, read_backs }, submission))
    }

    /// Walks over all commands. The table is read for as long, and no longer.
    fn encode(
        &self,
        caller: &Caller,
        list: &CommandListRecord,
        queries: Option<&Queries>,
    ) -> Result<Encoded, GpuError> {
        let table = self.read();
        let mut walk = Walk::new(&self.gpu, &table, caller, queries);
        steps(&mut walk, list, list.commands.len())?;
        walk.finish()
            .map_err(|error| error.at("the end of the commands"))
    }

    /// Finds the first command that wgpu refuses, by encoding shorter and shorter beginnings, and puts its index into
    /// the message. Only after an error: each attempt encodes again, and submits nothing.
    fn locate(&self, caller: &Caller, list: &CommandListRecord, error: GpuError) -> GpuError {
        let refused = |count: usize| {
            let scope = self.gpu.scoped(|| {
                let table = self.read();
                let mut walk = Walk::new(&self.gpu, &table, caller, None);
                // What the walk itself checks was right the first time.
                steps(&mut walk, list, count).ok();
                walk.abandon();
            });
            scope.err()
        };
        let (mut right, mut wrong) = (0, list.commands.len());
        let Some(mut found) = refused(wrong) else {
            // Encoding is right; the submission was refused (a resource was destroyed meanwhile).
            return error.at("submitting the commands");
        };
        while wrong - right > 1 {
            let middle = right.midpoint(wrong);
            match refused(middle) {
                Some(error) => (wrong, found) = (middle, error),
                None => right = middle,
            }
        }
        match list.decode().nth(wrong - 1) {
            Some(Ok(command)) => {
                found.at(format_args!("command {} ({})", wrong - 1, command.name()))
            }
            _ => found,
        }
    }
}

/// What is left of an encoding when it was submitted.
struct Submitted {
    passes: Vec<String>,
    read_backs: Vec<PendingReadBack>,
}

/// Walks over the first `count` commands.
fn steps(walk: &mut Walk<'_>, list: &CommandListRecord, count: usize) -> Result<(), GpuError> {
    for (index, command) in list.decode().take(count).enumerate() {
        let command = command.map_err(|error| undecodable(&error))?;
        let name = command.name();
        walk.step(command)
            .map_err(|error| error.at(format_args!("command {index} ({name})")))?;
    }
    Ok(())
}

/// The message of a decoding error names the index already.
fn undecodable(error: &DecodeError) -> GpuError {
    match error {
        DecodeError::UnknownOperation { .. } => GpuError::Unsupported(error.to_string()),
        DecodeError::DamagedPayload { .. } => GpuError::validation(error.to_string()),
    }
}
