//! One renderer per fault. Their numbers are their places in the list of `export!` and in `plugin.json`.
#![forbid(unsafe_code)]

mod gpu;
mod structure;

use pointstage_plugin_api::prelude::*;
use std::time::Duration;

/// Draws as it should.
pub const GOOD: usize = 0;
/// Panics, entry point by entry point.
pub const PANIC_PREPARE: usize = 1;
pub const PANIC_PREPARE_NEXT: usize = 2;
pub const PANIC_VIEW: usize = 3;
pub const PANIC_RENDER: usize = 4;
pub const PANIC_DROP_PREPARED: usize = 5;
pub const PANIC_DROP_VIEW: usize = 6;
/// Returns errors.
pub const ERROR_PREPARE: usize = 7;
pub const ERROR_VIEW: usize = 8;
pub const ERROR_RENDER: usize = 9;
/// Never returns from `prepare`, and never asks whether it should.
pub const ENDLESS_PREPARE: usize = 10;
/// Takes a minute to prepare, and asks.
pub const SLOW_PREPARE: usize = 11;
/// Writes NaN and infinity wherever it can.
pub const NAN_TARGETS: usize = 12;
/// Ends the process while it draws.
pub const ABORT_RENDER: usize = 13;
/// Draws for a minute, and stops with what it has when it should.
pub const SLOW_RENDER: usize = 14;
/// Draws for half a second, and stops with an error when it should.
pub const GIVING_UP_RENDER: usize = 15;

/// The renderer with fault `FAULT`.
pub struct Faulty<const FAULT: usize>;

/// Its view.
pub struct FaultyView<const FAULT: usize>;

impl<const FAULT: usize> Renderer for Faulty<FAULT> {
    type View = FaultyView<FAULT>;

    fn prepare(
        _host: &Host,
        _scene: Scene<'_>,
        previous: Option<(&Self, Changes<'_>)>,
        _settings: Settings<'_>,
        progress: &Progress<'_>,
    ) -> Result<Self> {
        match FAULT {
            PANIC_PREPARE => panic!("asked to panic in prepare"),
            PANIC_PREPARE_NEXT if previous.is_some() => panic!("asked to panic in prepare_next"),
            ERROR_PREPARE => return Err("asked to fail in prepare".into()),
            ENDLESS_PREPARE => loop {
                std::thread::sleep(Duration::from_secs(1));
            },
            SLOW_PREPARE => {
                for step in 0..6_000_u16 {
                    progress.set(f32::from(step) / 6_000.0, "waiting");
                    progress.check()?;
                    std::thread::sleep(Duration::from_millis(10));
                }
            }
            _ => {}
        }
        Ok(Self)
    }

    fn view(&self, _host: &Host) -> Result<FaultyView<FAULT>> {
        match FAULT {
            PANIC_VIEW => panic!("asked to panic in view"),
            ERROR_VIEW => Err("asked to fail in view".into()),
            _ => Ok(FaultyView),
        }
    }
}

impl<const FAULT: usize> View<Faulty<FAULT>> for FaultyView<FAULT> {
    fn render(&mut self, _prepared: &Faulty<FAULT>, frame: &mut Frame<'_>) -> Result<Outcome> {
        match FAULT {
            PANIC_RENDER => panic!("asked to panic in render"),
            ERROR_RENDER => return Err("asked to fail in render".into()),
            ABORT_RENDER => std::process::abort(),
            SLOW_RENDER | GIVING_UP_RENDER => {
                let steps = if FAULT == SLOW_RENDER { 6_000 } else { 50 };
                for _ in 0..steps {
                    std::thread::sleep(Duration::from_millis(10));
                    if !frame.should_stop() {
                        continue;
                    }
                    if FAULT == GIVING_UP_RENDER {
                        return Err(Error::cancelled());
                    }
                    return Ok(Outcome::Refining(0.5));
                }
            }
            _ => {}
        }
        let bad = FAULT == NAN_TARGETS;
        let colour = if bad { [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::NAN] } else { [0.0, 1.0, 0.0, 1.0] };
        let depth = if bad { f32::NAN } else { 0.5 };
        if let Some(mut plane) = frame.take_plane("colour") {
            plane.rows::<[f32; 4]>().for_each(|row| row.fill(colour));
        }
        if let Some(mut plane) = frame.take_plane("depth") {
            plane.rows::<f32>().for_each(|row| row.fill(depth));
        }
        Ok(Outcome::Done)
    }
}

impl<const FAULT: usize> Drop for Faulty<FAULT> {
    fn drop(&mut self) {
        assert!(FAULT != PANIC_DROP_PREPARED, "asked to panic in the renderer's drop");
    }
}

impl<const FAULT: usize> Drop for FaultyView<FAULT> {
    fn drop(&mut self) {
        assert!(FAULT != PANIC_DROP_VIEW, "asked to panic in the view's drop");
    }
}

pointstage_plugin_api::export! { "plugin.json", renderers: [
    Faulty<GOOD>, Faulty<PANIC_PREPARE>, Faulty<PANIC_PREPARE_NEXT>, Faulty<PANIC_VIEW>, Faulty<PANIC_RENDER>,
    Faulty<PANIC_DROP_PREPARED>, Faulty<PANIC_DROP_VIEW>, Faulty<ERROR_PREPARE>, Faulty<ERROR_VIEW>,
    Faulty<ERROR_RENDER>, Faulty<ENDLESS_PREPARE>, Faulty<SLOW_PREPARE>, Faulty<NAN_TARGETS>,
    Faulty<ABORT_RENDER>, Faulty<SLOW_RENDER>, Faulty<GIVING_UP_RENDER>,
    gpu::BadWgsl, gpu::Recorded<{ gpu::DRAW_OUTSIDE_PASS }>, gpu::Recorded<{ gpu::NO_PIPELINE }>,
    gpu::Recorded<{ gpu::STALE_HANDLE }>, gpu::Recorded<{ gpu::UNENDED_PASS }>, gpu::Greedy, gpu::Huge,
], structures: [
    structure::Faulty<{ structure::ABORT_PREPARE }>, structure::Faulty<{ structure::PANIC_SELECT }>,
] }
