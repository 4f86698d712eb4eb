//! What is the same for all who are measured: size, background, exposure, radii.

use clap::Args;
use pointstage_engine::stage::{Background, Stage};

use crate::cli::{Failure, Outcome, values};

/// Options that hold for every picture.
#[derive(Clone, Debug, Args)]
pub(crate) struct LookArguments {
    /// Size of every picture in pixels, whatever a view's file says
    #[arg(long, value_name = "WxH", value_parser = values::size, default_value = "800x580")]
    pub(crate) size: [u32; 2],
    /// What lies behind: '#rrggbb', or '#rrggbb,#rrggbb' from top to bottom
    #[arg(long, value_name = "COLOUR", value_parser = values::opaque_background, default_value = "#ffffff")]
    pub(crate) background: Background,
    /// Factor on the colours
    #[arg(long, value_name = "FACTOR", value_parser = values::factor, default_value = "1")]
    pub(crate) exposure: f32,
    /// Factor on every surfel's radius
    #[arg(long, value_name = "FACTOR", value_parser = values::factor, default_value = "1")]
    pub(crate) radius_scale: f32,
}

impl LookArguments {
    /// Pictures are measured undivided, so they are drawn at once.
    pub(crate) fn check_size(&self, stage: &Stage) -> Outcome {
        let most = stage.largest_frame_px();
        if self.size.iter().any(|side| *side > most) {
            let [width, height] = self.size;
            return Err(Failure::usage(format!(
                "--size {width}x{height}: what is compared is drawn at once, up to {most} pixels a side here; choose a smaller size"
            )));
        }
        Ok(())
    }
}
