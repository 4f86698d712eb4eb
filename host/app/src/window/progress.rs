//! Tasks that run or wait, over the picture: so the picture keeps its size when one comes or goes.

use egui::{Align2, Area, Button, Context, Frame, Id, Order, ProgressBar, Rect, Ui, vec2};

use super::intent::{FileIntent, Intents};
use super::tasks::TaskState;

/// Shows each task with its progress and a button to cancel, in the upper left corner of `over`.
pub(crate) fn progress_ui(ctx: &Context, over: Rect, tasks: &[TaskState], out: &mut Intents) {
    if tasks.is_empty() {
        return;
    }
    Area::new(Id::unique("progress"))
        .order(Order::Middle)
        .pivot(Align2::LEFT_TOP)
        .fixed_pos(over.left_top() + vec2(10.0, 10.0))
        .show(ctx, |ui| {
            Frame::popup(ui.style()).show(ui, |ui| {
                for task in tasks {
                    task_ui(ui, task, out);
                }
            });
        });
}

fn task_ui(ui: &mut Ui, task: &TaskState, out: &mut Intents) {
    ui.push_id(task.id, |ui| {
        ui.horizontal(|ui| {
            let name = format!("Cancel {}", task.title);
            let can_cancel = !task.job.is_cancelled();
            let cancel = ui.add_enabled(can_cancel, Button::new("Cancel"));
            let cancel = cancel.accessible_name(name);
            if cancel.clicked() {
                out.push(FileIntent::Cancel(task.id));
            }
            ui.label(&task.title);
            let stage = if task.job.is_cancelled() {
                "stopping".to_owned()
            } else {
                task.job.stage()
            };
            let bar = ProgressBar::new(task.job.progress())
                .show_percentage()
                .desired_width(160.0);
            ui.add(bar);
            ui.weak(stage);
        });
    });
}
