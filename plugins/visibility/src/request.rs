//! How a renderer wants a frame drawn: by which path, and what it knows of its splats.

use crate::cpu::Splats;

/// Which way the user wants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Path {
    /// The faster one for the device: on software devices the CPU where it can and there are enough splats for the picture, else
    /// compute; compute, too, where one 64-bit maximum holds depth and id; else raster.
    ///
    /// Measured: on Mesa's lavapipe compute is several times faster for splats of any size. On an NVIDIA H100 it is as fast
    /// as raster for 3,000 disks that fill the view, and 16 times as fast for 10 million (`hqss`: 59 times).
    Auto,
    /// The raster pipeline.
    Raster,
    /// Compute kernels with atomics.
    Compute,
    /// The CPU finds what is visible, and the device goes on with shading.
    Cpu,
}

impl Path {
    /// From the id of a `path` setting's option; anything unknown is [`Path::Auto`].
    pub fn from_id(id: &str) -> Self {
        match id {
            "raster" => Self::Raster,
            "compute" => Self::Compute,
            "cpu" => Self::Cpu,
            _ => Self::Auto,
        }
    }

    /// What a frame reports as its path.
    pub fn number(self) -> f64 {
        match self {
            Self::Auto | Self::Raster => 0.0,
            Self::Compute => 1.0,
            Self::Cpu => 2.0,
        }
    }
}

/// How large the splats of a frame are; what is known spares work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Extent {
    /// Each covers exactly the pixel that its centre lies in.
    OnePixel,
    /// None reaches farther than this from its projected centre, in x or y; px, at most 15.
    Within(f32),
    /// Anything.
    Any,
}

impl Extent {
    /// Up to here no splat counts as large: (2 · 15 + 1)² < `LARGE_PIXELS` of the shader.
    const GREATEST_PX: f32 = 15.0;

    /// For splats that reach `reach_px` from their centres in x and y; px.
    pub fn of_reach(reach_px: f32) -> Self {
        if reach_px <= 0.5 {
            Self::OnePixel
        } else if reach_px <= Self::GREATEST_PX {
            Self::Within(reach_px)
        } else {
            Self::Any
        }
    }

    /// Feature of the compute kernel.
    pub(crate) fn feature(self) -> Option<&'static str> {
        match self {
            Self::OnePixel => Some("one_pixel"),
            Self::Within(_) => Some("small"),
            Self::Any => None,
        }
    }

    /// Reach of the splats, if it is known; px.
    pub(crate) fn reach_px(self) -> Option<f32> {
        match self {
            Self::OnePixel => Some(0.5),
            Self::Within(reach) => Some(reach),
            Self::Any => None,
        }
    }
}

/// How a renderer wants a frame drawn.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a> {
    /// Raster, compute or CPU.
    pub path: Path,
    /// Features of the footprint's module.
    pub features: &'a [&'static str],
    /// How large the splats are.
    pub extent: Extent,
    /// Bytes that the largest buffer of a renderer's own holds a pixel on the compute path; 0 if it has none.
    pub bytes_per_pixel: u64,
    /// The footprint's uniform, of the size that [`crate::Footprint`] says.
    pub uniform: &'a [u8],
    /// The same splats, drawn by the CPU; none if the CPU does not draw them, or the renderer sees to that itself.
    pub cpu: Option<&'a dyn Splats>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_extent_follows_from_the_reach() {
        assert_eq!(Extent::of_reach(0.5), Extent::OnePixel);
        assert_eq!(Extent::of_reach(1.5), Extent::Within(1.5));
        assert_eq!(Extent::of_reach(15.5), Extent::Any);
        assert_eq!(Extent::of_reach(f32::NAN), Extent::Any);
    }
}
