//! What the host lends a loader while it reads: where its columns go, and the job behind the call. No panic leaves here.

use super::call::shorten;
use abi_stable::sabi_trait::TD_Opaque;
use abi_stable::sabi_types::RRef;
use abi_stable::std_types::{ROption, RResult, RSlice, RStr, RString};
use pointstage_plugin_api::abi::{
    CallObject, CallObject_TO, CallRef, ColumnRole as BorderRole, ErrorCode, ErrorRecord,
    ExtensionBox, LoadColumnRecord, LoadRowsRecord, LoadScaleRecord, LoadSinkObject,
    LoadSinkObject_TO, LoadSinkRef, LoadTextureRecord, ScalarType as BorderScalar,
};
use pointstage_scene::{
    ColumnRole, ColumnSpec, Job, ObjectBuilder, PositionScale, ScalarType, SourceFile, WarningKind,
    Warnings,
};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Mutex, PoisonError};

/// Part of the job's progress that reading is; the rest is building columns and estimating what they lack.
const READING: f32 = 0.35;
/// Bytes of a warning's or a stage's text that are kept.
const LONGEST_TEXT: usize = 400;
/// Different warnings that are kept of one load.
const MOST_WARNINGS: usize = 64;
/// Memory taken for surfels that are only announced yet, beyond twice the length of the file: a header may claim any number.
const MOST_RESERVED_BYTES: u64 = 32 << 20;
/// Surfels copied between two looks at the cancel flag take a few milliseconds: a plugin may hand over all at once.
const ROWS_AT_ONCE: u64 = 1 << 18;

/// Bytes of the file that have been read after which they no longer count as our memory.
const RELEASE_EVERY: usize = 4 << 20;

/// Collects what a loader hands over.
pub(super) struct Sink<'a> {
    job: &'a Job,
    /// Length of the file that is read.
    file_bytes: u64,
    /// The file, where it is mapped.
    file: Option<&'a SourceFile>,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    builder: Option<ObjectBuilder>,
    /// What whole numbers of positions stand for.
    scale: Option<PositionScale>,
    /// Widths of the declared columns, bytes a surfel.
    widths: Vec<usize>,
    /// Surfels that were announced; 0 stands for any number.
    expected: u64,
    /// Bytes from the start of the file that were released.
    released: usize,
    warnings: Warnings,
    /// The first thing that the loader did wrong.
    problem: Option<String>,
}

impl<'a> Sink<'a> {
    pub(super) fn new(job: &'a Job, file_bytes: u64) -> Self {
        Self {
            job,
            file_bytes,
            file: None,
            state: Mutex::default(),
        }
    }

    /// Of a loader that reads this file.
    pub(super) fn of(job: &'a Job, file: &'a SourceFile) -> Self {
        Self {
            file: Some(file),
            ..Self::new(job, file.bytes().len() as u64)
        }
    }

    /// The plugin's view of it.
    pub(super) fn border(&self) -> LoadSinkRef<'_> {
        LoadSinkObject_TO::from_ptr(RRef::new(self), TD_Opaque)
    }

    /// What was handed over; or the first thing that the loader did wrong.
    pub(super) fn into_builder(self) -> Result<ObjectBuilder, String> {
        let state = self
            .state
            .into_inner()
            .unwrap_or_else(PoisonError::into_inner);
        if let Some(problem) = state.problem {
            return Err(problem);
        }
        let mut builder = state
            .builder
            .ok_or_else(|| "it ended without declaring columns".to_owned())?;
        for warning in state.warnings.iter() {
            builder.warn(warning.kind.clone(), warning.count);
        }
        Ok(builder)
    }

    /// Runs `act` on the state; its error, or a panic of the host's own, is remembered and told.
    fn change(
        &self,
        act: impl FnOnce(&mut State) -> Result<(), String>,
    ) -> RResult<(), ErrorRecord> {
        let fail = |code, message: &str| {
            RResult::RErr(ErrorRecord {
                code,
                message: RString::from(message),
                detail: RString::new(),
            })
        };
        if self.job.is_cancelled() {
            return fail(ErrorCode::CANCELLED, "cancelled");
        }
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let outcome = catch_unwind(AssertUnwindSafe(|| act(&mut state))).unwrap_or_else(|_| {
            tracing::error!("the host panicked while a loader handed over columns; this is a fault of Pointstage");
            Err("the host panicked".to_owned())
        });
        match outcome {
            Ok(()) if self.job.is_cancelled() => fail(ErrorCode::CANCELLED, "cancelled"),
            Ok(()) => RResult::ROk(()),
            Err(problem) => {
                let answer = fail(ErrorCode::VALIDATION, &problem);
                state.problem.get_or_insert(problem);
                answer
            }
        }
    }
}

impl State {
    fn builder(&mut self) -> Result<&mut ObjectBuilder, String> {
        let missing = || "it handed over data before it declared its columns".to_owned();
        self.builder.as_mut().ok_or_else(missing)
    }

    fn add_rows(&mut self, rows: &LoadRowsRecord<'_>, job: &Job) -> Result<(), String> {
        let columns: Vec<&[u8]> = rows.columns.iter().map(RSlice::as_slice).collect();
        let widths = self.widths.clone();
        let builder = self.builder()?;
        let whole = columns.len() == widths.len()
            && columns.iter().zip(&widths).all(|(bytes, width)| {
                Some(bytes.len() as u64) == rows.count.checked_mul(*width as u64)
            });
        if !whole {
            // The builder says what is wrong.
            let count = usize::try_from(rows.count).unwrap_or(usize::MAX);
            return builder
                .add_rows(count.min(1 << 40), &columns)
                .map_err(|error| error.to_string());
        }
        let mut start = 0;
        while start < rows.count && !job.is_cancelled() {
            let end = rows.count.min(start + ROWS_AT_ONCE);
            let mut parts: Vec<&[u8]> = Vec::with_capacity(columns.len());
            for (bytes, width) in columns.iter().zip(&widths) {
                parts.push(&bytes[start as usize * width..end as usize * width]);
            }
            builder
                .add_rows((end - start) as usize, &parts)
                .map_err(|error| error.to_string())?;
            start = end;
        }
        Ok(())
    }

    /// Releases what was read of a file, as far as can be told from the surfels that came: most are read from the start to the
    /// end. What is read again after all is mapped again.
    fn release(&mut self, file: &SourceFile) {
        let rows = self.builder.as_ref().map_or(0, ObjectBuilder::rows) as u128;
        let length = file.bytes().len();
        if self.expected == 0 {
            return;
        }
        let read = length as u128 * rows / rows.max(self.expected.into());
        let read = usize::try_from(read).unwrap_or(length);
        if read >= self.released.saturating_add(RELEASE_EVERY) {
            file.release_range(self.released..read);
            self.released = read;
        }
    }
}

impl LoadSinkObject for Sink<'_> {
    fn columns(
        &self,
        columns: RSlice<'_, LoadColumnRecord<'_>>,
        expected: u64,
    ) -> RResult<(), ErrorRecord> {
        self.change(|state| {
            if state.builder.is_some() {
                return Err("it declared its columns twice".to_owned());
            }
            let specs: Result<Vec<ColumnSpec>, String> = columns.iter().map(spec_of).collect();
            let specs = specs?;
            state.widths = specs
                .iter()
                .map(|spec| spec.scalar.size() * spec.components as usize)
                .collect();
            let mut builder = ObjectBuilder::new(specs).map_err(|error| error.to_string())?;
            if let Some(scale) = state.scale {
                builder
                    .scale_positions(scale)
                    .map_err(|error| error.to_string())?;
            }
            let most_bytes = self.file_bytes.saturating_mul(2);
            state.expected = expected;
            builder.reserve(expected, most_bytes.saturating_add(MOST_RESERVED_BYTES));
            state.builder = Some(builder);
            Ok(())
        })
    }

    fn rows(&self, rows: &LoadRowsRecord<'_>) -> RResult<(), ErrorRecord> {
        self.change(|state| {
            state.add_rows(rows, self.job)?;
            if let Some(file) = self.file {
                state.release(file);
            }
            Ok(())
        })
    }

    fn polygons(
        &self,
        lengths: RSlice<'_, u32>,
        corners: RSlice<'_, u32>,
    ) -> RResult<(), ErrorRecord> {
        self.change(|state| {
            let builder = state.builder()?;
            if !lengths.is_empty() {
                return builder
                    .add_polygons(lengths.as_slice(), corners.as_slice())
                    .map_err(|error| error.to_string());
            }
            let (triangles, rest) = corners.as_slice().as_chunks::<3>();
            if !rest.is_empty() {
                return Err(format!("{} corners make no triangles", corners.len()));
            }
            builder.add_triangles(triangles);
            Ok(())
        })
    }

    fn warn(&self, text: RStr<'_>, count: u64) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let text = shorten(text.as_str(), LONGEST_TEXT);
        let kind = WarningKind::Other(text.to_owned());
        let is_known = state.warnings.count(&kind) > 0;
        if is_known || state.warnings.iter().count() < MOST_WARNINGS {
            state.warnings.add(kind, count);
        }
    }

    fn extension(&self, _name: RStr<'_>) -> ROption<ExtensionBox> {
        ROption::RNone
    }

    fn texture(&self, texture: &LoadTextureRecord<'_>) -> RResult<u32, ErrorRecord> {
        let mut number = 0;
        let kept = self.change(|state| {
            let name = shorten(texture.name.as_str(), LONGEST_TEXT);
            number = state.builder()?.add_picture(name, texture.file.as_slice());
            Ok(())
        });
        kept.map(|()| number)
    }

    fn polygon_textures(
        &self,
        textures: RSlice<'_, u32>,
        uvs: RSlice<'_, [f32; 2]>,
    ) -> RResult<(), ErrorRecord> {
        self.change(|state| {
            state
                .builder()?
                .add_polygon_pictures(textures.as_slice(), uvs.as_slice())
                .map_err(|error| error.to_string())
        })
    }

    fn scaled_positions(&self, scale: &LoadScaleRecord) -> RResult<(), ErrorRecord> {
        self.change(|state| {
            if state.builder.is_some() {
                return Err("it declared the scale of positions after its columns".to_owned());
            }
            state.scale = Some(PositionScale {
                scale: scale.scale.into(),
                offset: scale.offset.into(),
            });
            Ok(())
        })
    }

    fn begin_again(&self) -> RResult<(), ErrorRecord> {
        self.change(|state| {
            *state = State::default();
            Ok(())
        })
    }
}

/// A border's column as the scene has it.
fn spec_of(record: &LoadColumnRecord<'_>) -> Result<ColumnSpec, String> {
    let name = record.name.as_str();
    let role = match record.role {
        BorderRole::NAMED => ColumnRole::Named,
        BorderRole::POSITION => ColumnRole::Position,
        BorderRole::NORMAL => ColumnRole::Normal,
        BorderRole::COLOUR => ColumnRole::Colour,
        BorderRole::RADIUS => ColumnRole::Radius,
        BorderRole::AXES => ColumnRole::Axes,
        other => {
            return Err(format!(
                "column '{name}' has the role {other:?}, which this program does not know"
            ));
        }
    };
    let scalar = match record.scalar {
        BorderScalar::I8 => ScalarType::I8,
        BorderScalar::U8 => ScalarType::U8,
        BorderScalar::I16 => ScalarType::I16,
        BorderScalar::U16 => ScalarType::U16,
        BorderScalar::I32 => ScalarType::I32,
        BorderScalar::U32 => ScalarType::U32,
        BorderScalar::F32 => ScalarType::F32,
        BorderScalar::F64 => ScalarType::F64,
        other => {
            return Err(format!(
                "column '{name}' has the type {other:?}, which no column can have"
            ));
        }
    };
    Ok(ColumnSpec {
        role,
        name: name.to_owned(),
        scalar,
        components: record.components,
    })
}

/// A scene's job as the call that a plugin sees.
pub(super) struct JobCall<'a> {
    job: &'a Job,
}

impl<'a> JobCall<'a> {
    pub(super) fn new(job: &'a Job) -> Self {
        Self { job }
    }

    /// The plugin's view of it.
    pub(super) fn border(&self) -> CallRef<'_> {
        CallObject_TO::from_ptr(RRef::new(self), TD_Opaque)
    }
}

impl CallObject for JobCall<'_> {
    fn should_stop(&self) -> u32 {
        u32::from(self.job.is_cancelled())
    }

    fn progress(&self, fraction: f32, stage: RStr<'_>) {
        self.job.set_progress(fraction.clamp(0.0, 1.0) * READING);
        self.job
            .set_stage(shorten(stage.as_str(), LONGEST_TEXT).to_owned());
    }

    fn extension(&self, _name: RStr<'_>) -> ROption<ExtensionBox> {
        ROption::RNone
    }
}

#[cfg(test)]
#[path = "loader_sink_tests.rs"]
mod tests;
