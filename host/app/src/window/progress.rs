//! Long work over the picture, so that the picture keeps its size when some comes or goes: what runs, what waits, how far it
//! is, how long it will still take, and a button to cancel.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use egui::{Align2, Area, Button, Context, Frame, Id, Order, ProgressBar, Rect, Ui, vec2};
use pointstage_engine::stage::Preparing;

use super::intent::{FileIntent, Intent, Intents, RendererIntent};
use super::tasks::TaskState;

/// Less of the work than this says nothing about the rest.
const LEAST_PROGRESS: f32 = 0.03;

/// Work that has not run as long as this needs no forecast.
const LEAST_TIME: Duration = Duration::from_secs(1);

/// One piece of long work.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Row {
    /// What it is, for people; unique among what runs.
    title: String,
    /// 0..1.
    progress: f32,
    /// What it does just now.
    stage: String,
    /// How long it will still take, if that can be told.
    time_left: Option<Duration>,
    /// What stops it; none if it stops already.
    cancel: Option<Intent>,
}

/// Remembers when each piece of work began to get on.
#[derive(Debug, Default)]
pub(crate) struct Progress {
    begun: BTreeMap<String, (Instant, f32)>,
}

impl Progress {
    /// All that runs or waits: tasks in order, then what is prepared.
    pub(crate) fn rows(
        &mut self,
        tasks: &[TaskState],
        preparing: Option<(&Preparing, &str)>,
        now: Instant,
    ) -> Vec<Row> {
        let mut rows: Vec<Row> = tasks.iter().map(row_of_task).collect();
        rows.extend(preparing.map(|(preparing, title)| Row {
            title: format!("Prepare {title}"),
            progress: preparing.fraction,
            stage: preparing.stage.clone(),
            time_left: None,
            cancel: Some(RendererIntent::CancelPreparation(preparing.id.clone()).into()),
        }));
        self.begun
            .retain(|title, _| rows.iter().any(|row| row.title == *title));
        for row in &mut rows {
            row.time_left = self.time_left(row, now);
        }
        rows
    }

    /// As long as the part done took for each part that is left.
    fn time_left(&mut self, row: &Row, now: Instant) -> Option<Duration> {
        if row.progress <= 0.0 || row.cancel.is_none() {
            return None;
        }
        let begun = self.begun.entry(row.title.clone());
        let (since, from) = *begun.or_insert((now, row.progress));
        let (spent, done) = (now - since, row.progress - from);
        (spent >= LEAST_TIME && done >= LEAST_PROGRESS)
            .then(|| spent.mul_f32(((1.0 - row.progress) / done).max(0.0)))
    }
}

fn row_of_task(task: &TaskState) -> Row {
    let TaskState { id, title, job } = task;
    let is_cancelled = job.is_cancelled();
    let stage = match (is_cancelled, job.stage()) {
        (true, _) => "stopping".to_owned(),
        (false, stage) if stage.is_empty() && job.progress() <= 0.0 => {
            "waits for its turn".to_owned()
        }
        (false, stage) => stage,
    };
    Row {
        title: title.clone(),
        progress: job.progress(),
        stage,
        time_left: None,
        cancel: (!is_cancelled).then(|| FileIntent::Cancel(*id).into()),
    }
}

/// Shows the rows in the upper left corner of `over`.
pub(crate) fn progress_ui(ctx: &Context, over: Rect, rows: &[Row], out: &mut Intents) {
    if rows.is_empty() {
        return;
    }
    Area::new(Id::unique("progress"))
        .order(Order::Middle)
        .pivot(Align2::LEFT_TOP)
        .fixed_pos(over.left_top() + vec2(10.0, 10.0))
        .show(ctx, |ui| {
            Frame::popup(ui.style()).show(ui, |ui| {
                for row in rows {
                    ui.push_id(&row.title, |ui| row_ui(ui, row, out));
                }
            });
        });
}

fn row_ui(ui: &mut Ui, row: &Row, out: &mut Intents) {
    ui.horizontal(|ui| {
        let name = format!("Cancel {}", row.title);
        let cancel = ui.add_enabled(row.cancel.is_some(), Button::new("Cancel"));
        let is_clicked = cancel.accessible_name(name).clicked();
        if let Some(intent) = row.cancel.as_ref().filter(|_| is_clicked) {
            out.push(intent.clone());
        }
        ui.label(&row.title);
        let bar = ProgressBar::new(row.progress)
            .show_percentage()
            .desired_width(160.0);
        ui.add(bar);
        ui.weak(&row.stage);
        if let Some(time) = row.time_left {
            ui.weak(in_words(time));
        }
    });
}

/// A time that is left, as exact as a forecast can be.
fn in_words(time: Duration) -> String {
    let seconds = time.as_secs();
    match seconds {
        0..=1 => "almost done".to_owned(),
        2..=90 => format!("{seconds} s left"),
        91..=5400 => format!("{} min left", (seconds + 30) / 60),
        _ => format!("{} h left", (seconds + 1800) / 3600),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn preparing(fraction: f32) -> Preparing {
        Preparing {
            id: "tree".into(),
            fraction,
            stage: "sorting".into(),
        }
    }

    #[test]
    fn the_time_left_goes_by_what_the_part_done_took() {
        let (mut progress, start) = (Progress::default(), Instant::now());
        let mut left_at = |fraction: f32, seconds: u64| {
            let now = start + Duration::from_secs(seconds);
            let preparing = preparing(fraction);
            let rows = progress.rows(&[], Some((&preparing, "Tree")), now);
            rows[0].time_left
        };
        assert_eq!(left_at(0.1, 0), None, "too early to say");
        let left = left_at(0.3, 2).expect("a fifth is done");
        assert!((left.as_secs_f32() - 7.0).abs() < 0.01, "{left:?}");
        assert_eq!(left_at(1.0, 9).map(|left| left.as_secs()), Some(0));
    }

    #[test]
    fn work_that_comes_again_is_timed_anew() {
        let (mut progress, start) = (Progress::default(), Instant::now());
        let at = |seconds| start + Duration::from_secs(seconds);
        progress.rows(&[], Some((&preparing(0.1), "Tree")), at(0));
        progress.rows(&[], None, at(50));
        let rows = progress.rows(&[], Some((&preparing(0.2), "Tree")), at(60));
        assert_eq!(rows[0].time_left, None);
    }

    #[test]
    fn times_are_as_exact_as_they_can_be() {
        for (seconds, text) in [
            (0, "almost done"),
            (42, "42 s left"),
            (200, "3 min left"),
            (7300, "2 h left"),
        ] {
            assert_eq!(in_words(Duration::from_secs(seconds)), text);
        }
    }
}
