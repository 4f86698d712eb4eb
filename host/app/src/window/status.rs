//! The status bar: what is drawn, by whom, how long it took.

use std::time::Duration;

use egui::{Align, Label, Layout, RichText, Ui};
use pointstage_engine::stage::{FrameStats, Preparing, Severity};
use pointstage_plugin_api::statistics::TRIANGLES_DRAWN;

use super::frame_times::FrameSummary;
use super::intent::{Intents, Part, WindowIntent};
use super::log::Log;
use super::theme;

/// Width below which the adapter is left out, points.
const LEAST_ADAPTER_WIDTH: f32 = 60.0;

/// What the bar shows.
pub(crate) struct Status<'a> {
    /// Selected surfels and all surfels.
    pub(crate) marked: [usize; 2],
    /// Of the last picture.
    pub(crate) stats: Option<&'a FrameStats>,
    /// What is measured over some time.
    pub(crate) numbers: Numbers,
    /// How long the main renderer last took to take over from the preview.
    pub(crate) hand_over: Option<Duration>,
    /// Whether the preview was called by hand.
    pub(crate) preview_held: bool,
    /// The renderer that drew it, by title.
    pub(crate) drawn_by: Option<&'a str>,
    /// A renderer that is being prepared.
    pub(crate) preparing: Option<&'a Preparing>,
    /// How far a refining picture has come, below 1.
    pub(crate) refining: Option<f32>,
    /// The adapter, or why there is none.
    pub(crate) adapter: &'a str,
    /// Why there is no adapter, at length.
    pub(crate) no_device: Option<&'a str>,
    /// Messages.
    pub(crate) log: &'a Log,
}

/// What is measured over some time.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Numbers {
    /// Of the last two seconds.
    pub(crate) frames: Option<FrameSummary>,
    /// Bytes of the program in memory.
    pub(crate) resident_bytes: Option<u64>,
}

/// The bar: counts and times on the left, the adapter and the log on the right.
pub(crate) fn status_ui(ui: &mut Ui, status: &Status<'_>, out: &mut Intents) {
    ui.horizontal(|ui| {
        // From the right, so that what does not fit is cut on the left of what must.
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            log_button_ui(ui, status.log, out);
            ui.separator();
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                ui.shrink_clip_rect(ui.max_rect());
                picture_ui(ui, status);
                if ui.available_width() > LEAST_ADAPTER_WIDTH {
                    adapter_ui(ui, status);
                }
            });
        });
    });
}

/// The picture's numbers, and what is still under way.
fn picture_ui(ui: &mut Ui, status: &Status<'_>) {
    let [marked, all] = status.marked.map(|count| grouped(count as u64));
    if status.marked[0] > 0 {
        ui.strong(format!("{marked} of {all} surfels selected"));
        ui.separator();
    }
    if let Some(stats) = status.stats {
        counts_ui(ui, stats, &status.numbers);
        drawn_by_ui(ui, status);
        times_ui(ui, stats, status.numbers.frames);
        passes_ui(ui, stats);
        counters_ui(ui, stats);
    } else {
        ui.weak("No picture yet");
    }
    if let Some(preparing) = status.preparing {
        ui.separator();
        ui.spinner();
        ui.label(format!(
            "Preparing {}: {} ({:.0} %)",
            preparing.id,
            preparing.stage,
            preparing.fraction * 100.0
        ));
    }
    if let Some(progress) = status.refining {
        ui.separator();
        ui.label(format!("Refining: {:.0} %", progress * 100.0));
    }
}

/// The adapter, at the right end of what is left.
fn adapter_ui(ui: &mut Ui, status: &Status<'_>) {
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        let text = RichText::new(status.adapter).weak();
        let adapter = ui.add(Label::new(text).truncate());
        if let Some(reason) = status.no_device {
            adapter.on_hover_text(reason);
        }
    });
}

/// Surfels and triangles, and the memory that they take.
fn counts_ui(ui: &mut Ui, stats: &FrameStats, numbers: &Numbers) {
    let mut counts = format!(
        "{} surfels, {} drawn",
        grouped(stats.surfels_in_scene),
        grouped(stats.surfels_selected)
    );
    if let Some(triangles) = stats.reported.get(TRIANGLES_DRAWN) {
        counts = format!("{counts}, {} triangles", grouped(*triangles as u64));
    }
    ui.label(counts);
    ui.separator();
    let on_device = stats.scene_bytes + stats.plugin_bytes;
    let memory = match numbers.resident_bytes {
        Some(resident) => format!("{} + {}", bytes(resident), bytes(on_device)),
        None => bytes(on_device),
    };
    let resident = numbers.resident_bytes.map_or_else(
        || "The system does not say what the program holds.".to_owned(),
        |resident| format!("Program: {}", bytes(resident)),
    );
    ui.label(memory).on_hover_text(format!(
        "{resident}\nScene on the device: {}\nRenderer on the device: {}",
        bytes(stats.scene_bytes),
        bytes(stats.plugin_bytes)
    ));
}

/// Who drew the picture, and how long the main renderer took to take over.
fn drawn_by_ui(ui: &mut Ui, status: &Status<'_>) {
    let Some(drawn_by) = status.drawn_by else {
        return;
    };
    ui.separator();
    if status.preview_held {
        ui.label(format!("{drawn_by} (preview, Space)"));
    } else {
        ui.label(drawn_by);
    }
    if let Some(hand_over) = status.hand_over {
        ui.weak(format!("took over in {}", millis(hand_over)))
            .on_hover_text("From the last move to the first picture of the main renderer.");
    }
}

/// Time of the last picture; rate, median and 95th percentile of the last two seconds.
fn times_ui(ui: &mut Ui, stats: &FrameStats, frames: Option<FrameSummary>) {
    ui.separator();
    let mut text = format!("Frame {}", millis(stats.total));
    let mut hover = format!(
        "The last frame by wall clock.\nRenderer on the CPU: {}\nDevice, submission to completion: {}",
        millis(stats.plugin_cpu),
        millis(stats.device_wall)
    );
    if let Some(FrameSummary { median, p95, rate }) = frames {
        let both = format!("median {}, p95 {}", millis(median), millis(p95));
        text = match rate {
            Some(rate) => format!("{rate:.0}/s, {both}"),
            None => text,
        };
        hover = format!("Last two seconds: {both}.\n{hover}");
    }
    ui.label(text).on_hover_text(hover);
}

/// Time on the device, by pass on hover.
fn passes_ui(ui: &mut Ui, stats: &FrameStats) {
    ui.separator();
    if stats.passes.is_empty() {
        ui.label("GPU –")
            .on_hover_text("The device has no timestamps, or no device drew.");
        return;
    }
    let sum = stats.passes.iter().map(|pass| pass.time).sum();
    ui.label(format!("GPU {}", millis(sum))).on_hover_ui(|ui| {
        egui::Grid::new("passes").num_columns(2).show(ui, |ui| {
            for pass in &stats.passes {
                ui.label(&pass.label);
                ui.label(millis(pass.time));
                ui.end_row();
            }
        });
    });
}

/// What the renderer counted, on hover.
fn counters_ui(ui: &mut Ui, stats: &FrameStats) {
    if stats.reported.is_empty() {
        return;
    }
    ui.separator();
    ui.weak("Counters").on_hover_ui(|ui| {
        egui::Grid::new("counters").num_columns(2).show(ui, |ui| {
            for (key, value) in &stats.reported {
                ui.label(key);
                ui.label(value.to_string());
                ui.end_row();
            }
        });
    });
}

fn log_button_ui(ui: &mut Ui, log: &Log, out: &mut Intents) {
    let (errors, warnings) = (log.count(Severity::Error), log.count(Severity::Warning));
    let text = match (errors, warnings) {
        (0, 0) => "Log".to_owned(),
        (0, warnings) => format!("Log: {}", counted(warnings, "warning")),
        (errors, 0) => format!("Log: {}", counted(errors, "error")),
        (errors, warnings) => format!(
            "Log: {}, {}",
            counted(errors, "error"),
            counted(warnings, "warning")
        ),
    };
    let rich = if errors > 0 {
        RichText::new(text).color(theme::severity_color(ui, Severity::Error))
    } else {
        RichText::new(text)
    };
    if ui.button(rich).clicked() {
        out.push(WindowIntent::Toggle(Part::Log));
    }
}

fn counted(count: usize, noun: &str) -> String {
    let s = if count == 1 { "" } else { "s" };
    format!("{count} {noun}{s}")
}

/// A count with thin spaces between thousands.
pub(crate) fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (position, digit) in digits.chars().enumerate() {
        if position > 0 && (digits.len() - position).is_multiple_of(3) {
            text.push('\u{2009}');
        }
        text.push(digit);
    }
    text
}

/// A time in milliseconds, with as many digits as say something.
fn millis(time: Duration) -> String {
    let millis = time.as_secs_f64() * 1e3;
    if millis < 10.0 {
        format!("{millis:.2} ms")
    } else {
        format!("{millis:.0} ms")
    }
}

/// A size in MiB.
fn bytes(count: u64) -> String {
    format!("{:.1} MiB", count as f64 / (1024.0 * 1024.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thousands_stand_apart() {
        assert_eq!(grouped(0), "0");
        assert_eq!(grouped(999), "999");
        assert_eq!(grouped(1_092_000), "1\u{2009}092\u{2009}000");
    }

    #[test]
    fn short_times_keep_their_digits() {
        assert_eq!(millis(Duration::from_micros(1234)), "1.23 ms");
        assert_eq!(millis(Duration::from_micros(123_456)), "123 ms");
    }
}
