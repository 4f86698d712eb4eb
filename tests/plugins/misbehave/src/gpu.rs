//! Faults in what is asked of the GPU service.

use pointstage_plugin_api::abi::{BufferUsage, commands};
use pointstage_plugin_api::gpu::{Buffer, ColourAttachment};
use pointstage_plugin_api::prelude::*;

/// Draws before any pass is open.
pub const DRAW_OUTSIDE_PASS: usize = 0;
/// Draws without a pipeline.
pub const NO_PIPELINE: usize = 1;
/// Uses a buffer that was freed.
pub const STALE_HANDLE: usize = 2;
/// Leaves a pass open.
pub const UNENDED_PASS: usize = 3;

/// Records commands that no host may run.
pub struct Recorded<const FAULT: usize> {
    gpu: Gpu,
}

/// Its view.
pub struct RecordedView;

impl<const FAULT: usize> Renderer for Recorded<FAULT> {
    type View = RecordedView;

    fn prepare(
        host: &Host,
        _: Scene<'_>,
        _: Option<(&Self, Changes<'_>)>,
        _: Settings<'_>,
        _: &Progress<'_>,
    ) -> Result<Self> {
        Ok(Self { gpu: host.gpu()?.clone() })
    }

    fn view(&self, _: &Host) -> Result<RecordedView> {
        Ok(RecordedView)
    }
}

impl<const FAULT: usize> View<Recorded<FAULT>> for RecordedView {
    fn render(&mut self, prepared: &Recorded<FAULT>, frame: &mut Frame<'_>) -> Result<Outcome> {
        let mut recorder = Recorder::new();
        let draw = commands::Draw { vertex_count: 3, instance_count: 1, first_vertex: 0, first_instance: 0 };
        let colour = frame.target("colour").ok_or("no colour target")?;
        let attachments = [Some(ColourAttachment::load(&colour.texture))];
        match FAULT {
            DRAW_OUTSIDE_PASS => recorder.push(draw),
            NO_PIPELINE => recorder.render_pass("faulty", &attachments, None).draw(0..3, 0..1),
            STALE_HANDLE => {
                let usage = BufferUsage::STORAGE | BufferUsage::COPY_DST;
                let buffer: Buffer = prepared.gpu.buffer("short-lived", 64, usage)?;
                recorder.clear_buffer(&buffer);
            }
            _ => recorder.push(commands::BeginRenderPass {
                label: "never ended".into(),
                colours: attachments.into(),
                depth: None,
            }),
        }
        frame.submit(recorder);
        Ok(Outcome::Done)
    }
}

/// Declares a renderer whose `prepare` is `$act` and never succeeds.
macro_rules! fails_in_prepare {
    ($(#[$meta:meta])* $name:ident, |$host:ident| $act:expr) => {
        $(#[$meta])*
        pub struct $name;

        impl Renderer for $name {
            type View = Self;

            fn prepare(
                $host: &Host, _: Scene<'_>, _: Option<(&Self, Changes<'_>)>, _: Settings<'_>, _: &Progress<'_>,
            ) -> Result<Self> {
                $act;
                Ok(Self)
            }

            fn view(&self, _: &Host) -> Result<Self> {
                Ok(Self)
            }
        }

        impl View<$name> for $name {
            fn render(&mut self, _: &$name, _: &mut Frame<'_>) -> Result<Outcome> {
                Ok(Outcome::Done)
            }
        }
    };
}

fails_in_prepare! {
    /// Makes a shader that is no WGSL.
    BadWgsl, |host| host.gpu()?.shader("faulty", "fn main() {\n  let x: f32 = nonsense(1);\n}\n")?
}

fails_in_prepare! {
    /// Takes buffers until the host refuses.
    Greedy, |host| {
        let gpu = host.gpu()?;
        let mut kept = Vec::new();
        // 4 TiB in all: any quota is below.
        for _ in 0..65_536 {
            kept.push(gpu.buffer("greedy", 64 << 20, BufferUsage::STORAGE)?);
        }
    }
}

fails_in_prepare! {
    /// Asks for one buffer larger than any memory.
    Huge, |host| host.gpu()?.buffer("huge", 1 << 62, BufferUsage::STORAGE)?
}
