//! First contact, which does not count, and the first image, which does.

use std::time::Instant;

use pointstage_engine::stage::{FrameRequest, Stage};
use pointstage_scene::Camera;

use super::lane::{Lane, request};
use super::{BenchArguments, Stand, memory};
use crate::cli::measuring::entries::{self, Entry};
use crate::cli::measuring::times::{draw, millis};
use crate::cli::{Globals, Outcome};

/// Side of the picture of first contact, px.
const CONTACT_PX: u32 = 16;

/// Lets every renderer draw once: a new one is tried in a child process first, whose time is nobody's. Gives those that can
/// draw at least one of the scenes; one that was named and cannot draw any is an error.
pub(super) fn make_contact(
    stage: &mut Stage,
    arguments: &BenchArguments,
    entries: Vec<Entry>,
    stands: &[Stand],
) -> Outcome<Vec<Entry>> {
    let mut drawing = Vec::new();
    for entry in entries {
        let suitable = |stand: &&Stand| entry.reason_against(stage, &stand.scene).is_none();
        match stands.iter().find(suitable).or(stands.first()) {
            Some(stand) => {
                let found = entries::those_that_draw(stage, vec![entry], &stand.scene, None);
                drawing.extend(match found {
                    Ok(found) => found,
                    // Of 'all', those that cannot draw are not asked for.
                    Err(_) if entries::is_all(&arguments.renderers) => Vec::new(),
                    Err(failure) => return Err(failure),
                });
            }
            None => drawing.push(entry),
        }
    }
    if drawing.is_empty() {
        return Err(entries::nobody_draws());
    }
    for entry in &drawing {
        let suitable = |stand: &&Stand| entry.reason_against(stage, &stand.scene).is_none();
        if let Some(stand) = stands.iter().find(suitable) {
            let contact = FrameRequest {
                size_px: [CONTACT_PX; 2],
                ..request(arguments, entry, &stand.scene, Camera::default())
            };
            draw(stage, &contact)?;
        }
    }
    Ok(drawing)
}

/// The time to the first image of every renderer on every scene, in a stage that is new, with its device open, and the memory
/// that it took.
pub(super) fn measure(
    globals: &Globals,
    arguments: &BenchArguments,
    (stands, paths): (&[Stand], &[Vec<Camera>]),
    lanes: &mut [Lane<'_>],
) -> Outcome {
    for lane in lanes.iter_mut().filter(|lane| lane.unsuitable.is_none()) {
        let stand = &stands[lane.stand];
        tracing::info!("first image: {} of {}", lane.entry.label, stand.name);
        let mut stage = Stage::new(globals.stage_options())?;
        let Some(camera) = paths[lane.stand].first() else {
            continue;
        };
        let request = request(arguments, lane.entry, &stand.scene, *camera);
        let watch = memory::Watch::begin();
        let start = Instant::now();
        // One that refines has shown an image when its first frame is there.
        let result = stage.frame(&request)?;
        lane.first_ms = Some(millis(start.elapsed()));
        lane.memory.process_bytes = watch.and_then(|watch| watch.grown_bytes());
        lane.note(&result.stats);
    }
    Ok(())
}
