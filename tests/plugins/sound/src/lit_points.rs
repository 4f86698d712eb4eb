//! The guide's GPU renderer: one pixel a surfel, lit at its centre.

use pointstage_plugin_api::gpu::{
    ColourAttachment, ColourTarget, DepthAttachment, DepthTest, RenderPipeline, RenderPipelineOptions,
};
use pointstage_plugin_api::prelude::*;
use pointstage_plugin_api::wgsl::{Module, link};
use pointstage_plugin_api::{abi, targets};

/// The renderer: one pipeline.
pub struct LitPoints {
    pipeline: RenderPipeline,
}

/// Its view: nothing.
pub struct LitPointsView;

impl Renderer for LitPoints {
    type View = LitPointsView;

    fn prepare(
        host: &Host,
        _: Scene<'_>,
        _: Option<(&Self, Changes<'_>)>,
        _: Settings<'_>,
        _: &Progress<'_>,
    ) -> Result<Self> {
        let gpu = host.gpu()?;
        let main = Module { path: "lit_points::lit_points", source: include_str!("lit_points.wesl") };
        let wgsl = link(main, &[], &[]).map_err(Error::failed)?;
        let shader = gpu.shader("lit points", &wgsl)?;
        let pipeline = gpu.render_pipeline(&RenderPipelineOptions {
            layouts: &[&gpu.frame_layout()?, &gpu.columns_layout()?],
            topology: abi::Topology::POINT_LIST,
            depth: Some(DepthTest::NEARER),
            targets: &[Some(ColourTarget { format: abi::Format::RGBA16_FLOAT, blend: None })],
            ..RenderPipelineOptions::new("lit points", &shader)
        })?;
        Ok(Self { pipeline })
    }

    fn view(&self, _: &Host) -> Result<LitPointsView> {
        Ok(LitPointsView)
    }
}

impl View<LitPoints> for LitPointsView {
    fn render(&mut self, prepared: &LitPoints, frame: &mut Frame<'_>) -> Result<Outcome> {
        let (Some(colour), Some(depth)) = (frame.target(targets::COLOUR), frame.target(targets::DEPTH)) else {
            return Err("the host asks for neither colour nor depth".into());
        };
        let mut commands = Recorder::new();
        let mut pass = commands.render_pass(
            "lit points",
            &[Some(ColourAttachment::load(&colour.texture))],
            Some(DepthAttachment::load(&depth.texture)),
        );
        pass.set_pipeline(&prepared.pipeline);
        for draw in frame.selection() {
            pass.set_bind_group(0, &frame.group(), &[draw.uniform_offset()]);
            pass.set_bind_group(1, &draw.columns(), &[]);
            pass.draw(0..draw.count(), 0..1);
        }
        drop(pass);
        frame.submit(commands);
        Ok(Outcome::Done)
    }
}
