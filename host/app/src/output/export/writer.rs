//! The thread that writes an image's file, as its owner sees it.

use std::thread::JoinHandle;

use super::ExportError;

/// Whether the file is in its place; an error if it cannot be. Never waits.
pub(super) fn poll(
    writer: &mut Option<JoinHandle<Result<(), ExportError>>>,
) -> Result<bool, ExportError> {
    if !writer.as_ref().is_none_or(JoinHandle::is_finished) {
        return Ok(false);
    }
    let Some(writer) = writer.take() else {
        return Err(ExportError::Writer("it has ended before".into()));
    };
    match writer.join() {
        Ok(outcome) => outcome.map(|()| true),
        Err(_) => Err(ExportError::Writer("the writer has a defect".into())),
    }
}
