//! Composition on the device: targets become a picture in memory. The passes are in `shaders/compose`; their CPU twin is
//! [`compose_cpu`](super::compose_cpu).

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use bytemuck::{Pod, Zeroable};

use super::composition::{Composed, Composition};
use super::copied::{self, Codes};
use super::palette::{KINDS, RAMP};
use super::passes::{Pass, Passes};
use super::picture::{Picture, Plane};
use super::readback::{Job, Readback};
use super::target_set::{GpuTarget, TargetSet};
use super::targets::{Appearance, PlaneFormat};
use crate::device::{GpuDevice, GpuError};

/// Composes the pictures of one device. Thread: one at a time.
#[derive(Debug)]
pub struct Composer {
    gpu: Arc<GpuDevice>,
    passes: Passes,
    readback: Readback,
    /// Whether targets are copied to memory and colours composed there, where that can be done.
    copies: bool,
    codes: Option<Codes>,
}

/// A composed picture, and the targets that were read back with it.
#[derive(Clone, Debug, PartialEq)]
pub struct ComposedFrame {
    /// The picture.
    pub composed: Composed,
    /// Targets by key, unshifted and in the units of the catalogue.
    pub planes: BTreeMap<String, Plane>,
}

/// Why there is no picture.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ComposeError {
    /// The frame has no such target.
    #[error(
        "target '{key}' is not in this frame, which has {existing}; request it before the frame is drawn"
    )]
    NoTarget {
        /// What was asked for.
        key: String,
        /// What there is.
        existing: String,
    },
    /// The device failed.
    #[error("composing the picture: {0}")]
    Gpu(#[from] GpuError),
}

/// The passes' uniform; the fields of `Composition` in shaders/compose/common.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(super) struct Uniform {
    pub(super) ramp: [[f32; 4]; RAMP.len()],
    pub(super) kinds: [[f32; 4]; KINDS.len()],
    pub(super) background_top: [f32; 4],
    pub(super) background_bottom: [f32; 4],
    pub(super) distance_terms: [f32; 4],
    pub(super) size_px: [u32; 2],
    pub(super) first_row: u32,
    pub(super) row_count: u32,
    pub(super) appearance: u32,
    pub(super) clear_number: u32,
    pub(super) clear_value: f32,
    pub(super) clear_tolerance: f32,
    pub(super) exposure: f32,
    pub(super) tile_origin_y_px: f32,
    pub(super) image_height_px: f32,
    pub(super) channels: u32,
    pub(super) given_ends: [f32; 2],
    pub(super) has_given_ends: u32,
    pub(super) padding: u32,
}

impl Composer {
    /// Builds the passes.
    ///
    /// # Errors
    /// The device is lost or its memory is used up.
    pub fn new(gpu: Arc<GpuDevice>) -> Result<Self, GpuError> {
        let passes = gpu.scoped(|| Passes::new(&gpu.device))?;
        let readback = Readback::new(&gpu.limits);
        Ok(Self {
            copies: gpu.is_software(),
            gpu,
            passes,
            readback,
            codes: None,
        })
    }

    /// Composes a picture, and copies the targets of `read_back` to memory on the way. Waits for the device, for all that
    /// was submitted before too.
    ///
    /// # Errors
    /// A target is not in the set; the device is lost, out of memory, or busy for longer than `timeout`.
    pub fn compose(
        &mut self,
        targets: &TargetSet,
        composition: &Composition,
        read_back: &[&str],
        timeout: Duration,
    ) -> Result<ComposedFrame, ComposeError> {
        let shown = find(targets, &composition.shown.key)?;
        let uniform = uniform(composition, targets.size_px());
        let mut jobs = vec![Job {
            pass: match composition.shown.appearance {
                Appearance::Colours => Pass::Colours,
                _ => Pass::Compose(shown.plane_format()),
            },
            view: &shown.view,
            copied: (composition.shown.appearance == Appearance::Colours)
                .then(|| self.copied(shown, |format| format == wgpu::TextureFormat::Rgba16Float))
                .flatten(),
            uniform,
            needs_range: composition.needs_range(),
        }];
        for key in read_back {
            let target = find(targets, key)?;
            jobs.push(Job {
                pass: Pass::Read(target.plane_format()),
                view: &target.view,
                copied: self.copied(target, copied::is_word),
                uniform: Uniform {
                    channels: target.plane_format().channels(),
                    ..uniform
                },
                needs_range: false,
            });
        }
        let Self {
            gpu,
            passes,
            readback,
            codes,
            ..
        } = self;
        let mut picture = None;
        let mut words = vec![Vec::new(); jobs.len()];
        let range_keys = readback.run(gpu, passes, &jobs, timeout, |job, mapped| {
            match jobs[job].copied {
                None => words[job].extend_from_slice(mapped),
                Some(texture) if job == 0 => {
                    let codes = Codes::at(codes, composition.exposure);
                    picture = Some(copied::compose(texture, mapped, composition, codes));
                }
                Some(texture) => words[job] = copied::words(texture, mapped),
            }
        })?;
        let mut words = words.into_iter();
        let composed = words.next().unwrap_or_default();
        let picture = picture.unwrap_or_else(|| Picture {
            size_px: targets.size_px(),
            rgba: bytemuck::cast_slice(&composed).into(),
        });
        let range = range_keys.and_then(|keys| range(keys, shown.plane_format()));
        let range = range.map(|[least, greatest]| composition.ramp_ends(least, greatest));
        let range = composition.given_ends().or(range);
        let planes = core::iter::zip(read_back, words).map(|(key, words)| {
            let format = targets.get(key).map(GpuTarget::plane_format);
            (
                (*key).to_owned(),
                plane(&words, format.unwrap_or(PlaneFormat::Uint)),
            )
        });
        Ok(ComposedFrame {
            composed: Composed { picture, range },
            planes: planes.collect(),
        })
    }

    /// The target's texture if it is better copied than passed over: the device is software, `suits` says yes to its format,
    /// and it fits into one buffer.
    fn copied<'t>(
        &self,
        target: &'t GpuTarget,
        suits: impl FnOnce(wgpu::TextureFormat) -> bool,
    ) -> Option<&'t wgpu::Texture> {
        let texture = &target.texture;
        let bytes = u64::from(copied::row_bytes(texture)) * u64::from(texture.height());
        let depth_copies = wgpu::DownlevelFlags::DEPTH_TEXTURE_AND_BUFFER_COPIES;
        let copies_format = !texture.format().has_depth_aspect()
            || self.gpu.downlevel_flags().contains(depth_copies);
        let can = suits(texture.format())
            && copies_format
            && texture.usage().contains(wgpu::TextureUsages::COPY_SRC)
            && bytes <= self.gpu.limits.max_buffer_size;
        (self.copies && can).then_some(texture)
    }

    /// Bytes that the composer holds on the device, and in memory that the device writes.
    pub fn bytes(&self) -> u64 {
        self.readback.bytes()
    }
}

#[cfg(test)]
impl Composer {
    /// Chooses the way, whatever the device is.
    pub(super) fn copy(&mut self, copies: bool) {
        self.copies = copies;
    }

    /// Makes bands as small as if the device could bind no more bytes.
    pub(super) fn limit_bands(&mut self, bytes: u64) {
        self.readback.max_band_bytes = bytes;
    }
}

fn find<'t>(targets: &'t TargetSet, key: &str) -> Result<&'t GpuTarget, ComposeError> {
    targets.get(key).ok_or_else(|| {
        let existing: Vec<_> = targets
            .targets()
            .iter()
            .map(|target| &*target.spec.key)
            .collect();
        ComposeError::NoTarget {
            key: key.to_owned(),
            existing: existing.join(", "),
        }
    })
}

fn uniform(composition: &Composition, size_px: [u32; 2]) -> Uniform {
    let srgb = |colour: [u8; 3]| {
        let [r, g, b] = colour.map(|byte| f32::from(byte) / 255.0);
        [r, g, b, 1.0]
    };
    let (top, bottom, opaque) = composition.background_edges();
    let opaque = f32::from(u8::from(opaque));
    let edge = |[r, g, b]: [f32; 3]| [r, g, b, opaque];
    Uniform {
        ramp: RAMP.map(srgb),
        kinds: KINDS.map(srgb),
        background_top: edge(top),
        background_bottom: edge(bottom),
        distance_terms: composition.distance_terms().to_array(),
        size_px,
        first_row: 0,
        row_count: size_px[1],
        appearance: appearance_number(composition.shown.appearance),
        clear_number: composition.shown.clear_number(),
        clear_value: composition.shown.clear[0] as f32,
        clear_tolerance: composition.clear_tolerance(),
        exposure: composition.exposure,
        tile_origin_y_px: composition.tile_origin_y_px,
        image_height_px: composition.image_height_px,
        channels: 1,
        given_ends: composition.given_ends().unwrap_or_default(),
        has_given_ends: composition.given_ends().is_some().into(),
        padding: 0,
    }
}

/// The constants of common.wgsl.
fn appearance_number(appearance: Appearance) -> u32 {
    match appearance {
        Appearance::Colours => 0,
        Appearance::Normals => 1,
        Appearance::Depth => 2,
        Appearance::Identities => 3,
        Appearance::Kinds => 4,
        Appearance::RampFromZero => 5,
        Appearance::Ramp => 6,
    }
}

/// Least and greatest value from the range pass; `None` if nothing was in view.
fn range([least, greatest]: [u32; 2], format: PlaneFormat) -> Option<[f32; 2]> {
    (least <= greatest).then(|| {
        [least, greatest].map(|key| match format {
            PlaneFormat::Uint => key as f32,
            PlaneFormat::Float | PlaneFormat::Float4 => float_of_key(key),
        })
    })
}

/// The float whose sorting key this is; the twin of the shader's function of the same name.
fn float_of_key(key: u32) -> f32 {
    f32::from_bits(if key & 0x8000_0000 == 0 {
        !key
    } else {
        key & 0x7fff_ffff
    })
}

fn plane(words: &[u32], format: PlaneFormat) -> Plane {
    match format {
        PlaneFormat::Uint => Plane::Uint(words.into()),
        PlaneFormat::Float | PlaneFormat::Float4 => Plane::Float {
            channels: format.channels(),
            values: bytemuck::cast_slice(words).into(),
        },
    }
}
