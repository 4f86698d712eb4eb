//! WGSL: parsed and validated before wgpu sees it, so that a message has line, column and the source line.

use super::features;
use crate::device::{GpuDevice, GpuError};
use wgpu::Features;
use wgpu::naga::ShaderStage;
use wgpu::naga::front::wgsl;
use wgpu::naga::valid::{Capabilities, ValidationError, ValidationFlags, Validator};
use wgpu::naga::{Module, SourceLocation, Span};

/// What a shader offers to pipelines.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Interface {
    pub(super) entry_points: Vec<(String, ShaderStage)>,
    /// Names of its pipeline constants.
    pub(super) overrides: Vec<String>,
}

impl Interface {
    fn of(module: &Module) -> Self {
        Self {
            entry_points: module
                .entry_points
                .iter()
                .map(|entry| (entry.name.clone(), entry.stage))
                .collect(),
            overrides: module
                .overrides
                .iter()
                .filter_map(|(_, constant)| {
                    // A constant with an id is set by the id, written as text.
                    constant
                        .id
                        .map(|id| id.to_string())
                        .or_else(|| constant.name.clone())
                })
                .collect(),
        }
    }

    /// Refuses an entry point that is not there, or is of another stage.
    pub(super) fn check_entry_point(&self, name: &str, stage: ShaderStage) -> Result<(), GpuError> {
        let fits = |(n, s): &&(String, ShaderStage)| n == name && *s == stage;
        if self.entry_points.iter().any(|entry| fits(&entry)) {
            return Ok(());
        }
        let existing: Vec<_> = self
            .entry_points
            .iter()
            .map(|(name, stage)| format!("'{name}' ({stage:?})"))
            .collect();
        let existing = if existing.is_empty() {
            "no entry point".to_owned()
        } else {
            existing.join(", ")
        };
        Err(GpuError::validation(format!(
            "no {stage:?} entry point '{name}'; the shader has {existing}"
        )))
    }

    /// Refuses a constant that the shader does not declare.
    pub(super) fn check_constant(&self, name: &str) -> Result<(), GpuError> {
        if self.overrides.iter().any(|known| known == name) {
            return Ok(());
        }
        Err(GpuError::validation(format!(
            "the shader has no 'override {name}'; it has: {}",
            if self.overrides.is_empty() {
                "none".to_owned()
            } else {
                self.overrides.join(", ")
            }
        )))
    }
}

/// Parses and validates WGSL for someone with these features.
pub(super) fn check(
    gpu: &GpuDevice,
    granted: Features,
    label: &str,
    source: &str,
) -> Result<Interface, GpuError> {
    let module = wgsl::parse_str(source).map_err(|error| {
        refusal(
            label,
            source,
            error.message(),
            error.location(source),
            error.emit_to_string_with_path(source, label),
        )
    })?;
    // First what is wrong on any device, then what needs a feature.
    #[expect(clippy::result_large_err, reason = "naga's own error type")]
    let validate = |capabilities: Capabilities| {
        Validator::new(ValidationFlags::all(), capabilities).validate(&module)
    };
    validate(Capabilities::all()).map_err(|error| {
        let mut text = error.as_inner().to_string();
        let mut source_error = std::error::Error::source(error.as_inner());
        while let Some(cause) = source_error {
            text = format!("{text}: {cause}");
            source_error = cause.source();
        }
        let location = error
            .location(source)
            .or_else(|| entry_point_location(error.as_inner(), source));
        refusal(
            label,
            source,
            &text,
            location,
            error.emit_to_string_with_path(source, label),
        )
    })?;
    if let Err(error) = validate(features::capabilities(gpu, granted)) {
        let place = match error.location(source) {
            Some(location) => place(label, source, location),
            None => format!("shader '{label}'"),
        };
        // The feature without which the shader would not be valid even if all others were granted.
        let missing = features::of_capabilities()
            .filter(|(_, feature)| !granted.contains(*feature))
            .find(|(capability, _)| validate(Capabilities::all() - *capability).is_err());
        return Err(GpuError::Unsupported(match missing {
            Some((_, feature)) => features::refusal(gpu, feature, &place),
            None => format!(
                "{place}: the shader uses what the device '{}' or this host cannot do: {error}",
                gpu.info.name
            ),
        }));
    }
    Ok(Interface::of(&module))
}

/// Where the entry point begins that an error is about: naga knows no place for what is wrong with its signature.
fn entry_point_location(error: &ValidationError, source: &str) -> Option<SourceLocation> {
    let ValidationError::EntryPoint { name, .. } = error else {
        return None;
    };
    let start = source.match_indices(name.as_str()).find_map(|(at, _)| {
        let before = source[..at].trim_end();
        let after = source[at + name.len()..].trim_start();
        let is_declaration = before.ends_with("fn") && before.len() < at && after.starts_with('(');
        is_declaration.then_some(at)
    })?;
    let end = u32::try_from(start + name.len()).ok()?;
    Some(Span::new(start as u32, end).location(source))
}

/// 'shader 'splats', line 3, column 7: `the source line`'.
fn place(label: &str, source: &str, location: SourceLocation) -> String {
    let line = source
        .lines()
        .nth((location.line_number as usize).saturating_sub(1))
        .unwrap_or_default()
        .trim();
    format!(
        "shader '{label}', line {}, column {}: `{line}`",
        location.line_number, location.line_position
    )
}

fn refusal(
    label: &str,
    source: &str,
    message: &str,
    location: Option<SourceLocation>,
    detail: String,
) -> GpuError {
    let place = match location {
        Some(location) => place(label, source, location),
        None => format!("shader '{label}'"),
    };
    GpuError::Validation {
        message: format!("{place}: {}", message.trim_end()),
        detail,
    }
}
