//! Columns estimated anew, on the worker.

use std::sync::Arc;
use std::time::Instant;

use pointstage_engine::stage::Severity;
use pointstage_scene::estimate::{Steps, estimate};
use pointstage_scene::{Geometry, Object, ObjectId, Revision, WarningKind, Warnings};

use crate::window::app::App;
use crate::window::loading::Finished;
use crate::window::tasks::guarded;

/// An object's new columns.
#[derive(Debug)]
pub(crate) struct Estimated {
    id: ObjectId,
    /// Of the geometry that they were estimated from.
    from: Revision,
    geometry: Geometry,
    warnings: Warnings,
}

impl App {
    /// Has the selected objects' columns estimated anew, or those of all if none is selected.
    pub(super) fn estimate_anew(&mut self, steps: Steps) {
        let objects = self.session.scene.objects();
        let is_any_selected = objects.iter().any(|object| object.selected);
        let chosen: Vec<Object> = objects
            .iter()
            .filter(|object| object.selected || !is_any_selected)
            .cloned()
            .collect();
        for object in chosen {
            let title = format!("Estimate {} of {}", in_words(&steps), object.name);
            self.tasks.push(title, move |job| {
                let Object { id, geometry, name, .. } = object;
                guarded(
                    || match estimate(&geometry, &steps, job) {
                        Ok((estimated, warnings)) => Finished::Estimated(Box::new(Estimated {
                            id,
                            from: geometry.revision,
                            geometry: estimated,
                            warnings,
                        })),
                        Err(_) => Finished::Stopped(format!("{name}: estimating cancelled")),
                    },
                    |panic| {
                        Finished::Failed(format!(
                            "{name}: estimating has a defect and stopped ({panic}); please report it"
                        ))
                    },
                )
            });
        }
    }

    /// Gives an object its new columns; the step can be undone as any other.
    pub(in crate::window) fn take_estimated(&mut self, estimated: Estimated) {
        let now = Instant::now();
        let Estimated {
            id,
            from,
            geometry,
            warnings,
        } = estimated;
        // It may have been removed meanwhile; then nobody misses the columns.
        let Some(object) = self.session.scene.object(id) else {
            return;
        };
        if object.geometry.revision != from {
            let text = format!(
                "{} has changed while its columns were estimated: it stays as it is. Estimate them again.",
                object.name
            );
            self.log.say(Severity::Warning, text, now);
            return;
        }
        for warning in warnings.iter() {
            let severity = match warning.kind {
                WarningKind::NormalsEstimated
                | WarningKind::NormalsOriented
                | WarningKind::RadiiEstimated
                | WarningKind::AxesEstimated => Severity::Info,
                _ => Severity::Warning,
            };
            let text = format!("{}: {warning}", object.name);
            self.log.say(severity, text, now);
        }
        self.session
            .edit_scene(|scene| scene.edit(id, |object| object.geometry = Arc::new(geometry)));
    }
}

fn in_words(steps: &Steps) -> String {
    let names = [
        (steps.normals, "normals"),
        (steps.orientation, "the side of normals"),
        (steps.radii, "radii"),
        (steps.axes, "axes"),
    ];
    let chosen: Vec<&str> = names
        .into_iter()
        .filter_map(|(is_chosen, name)| is_chosen.then_some(name))
        .collect();
    chosen.join(" and ")
}

#[cfg(test)]
#[path = "estimate_tests.rs"]
mod tests;
