//! The targets that a frame asks for, as attachments of the shading pass.

use pointstage_plugin_api::abi::{Compare, Format, TextureUsage};
use pointstage_plugin_api::gpu::{
    ColourAttachment, ColourTarget, DepthAttachment, DepthTest, Gpu, Recorder, RenderPass, Texture,
    TextureOptions,
};
use pointstage_plugin_api::{Frame, Result, Target, targets};

/// A colour attachment that shading can fill: the target's key, its format, its feature in the shader, its slot's name.
struct Kind {
    key: &'static str,
    format: Format,
    feature: &'static str,
    slot: &'static str,
}

/// In the order of the slots.
const KINDS: [Kind; 6] = [
    Kind {
        key: targets::COLOUR,
        format: Format::RGBA16_FLOAT,
        feature: "colour",
        slot: "COLOUR_SLOT",
    },
    Kind {
        key: targets::NORMAL,
        format: Format::RGBA16_FLOAT,
        feature: "normal",
        slot: "NORMAL_SLOT",
    },
    Kind {
        key: targets::KIND,
        format: Format::R8_UINT,
        feature: "kind",
        slot: "KIND_SLOT",
    },
    Kind {
        key: targets::LOD,
        format: Format::R8_UINT,
        feature: "level",
        slot: "LEVEL_SLOT",
    },
    Kind {
        key: targets::ID,
        format: Format::R32_UINT,
        feature: "id",
        slot: "ID_SLOT",
    },
    Kind {
        key: targets::WEIGHT,
        format: Format::R16_FLOAT,
        feature: "weight",
        slot: "WEIGHT_SLOT",
    },
];

/// The targets of a frame that this crate writes.
#[derive(Clone, Copy, Debug, Default)]
pub struct Targets {
    colours: [Option<Target>; KINDS.len()],
    /// The depth target.
    pub depth: Option<Target>,
}

/// Which targets a shading pipeline fills: a bit for each of `KINDS`, and one for depth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct TargetSet(u32);

const LEVEL_INDEX: usize = 3;
const ID_INDEX: usize = 4;
const DEPTH_BIT: u32 = 1 << KINDS.len();
/// What the raster path's visibility pass writes itself.
const VISIBILITY_BITS: u32 = 1 << LEVEL_INDEX | 1 << ID_INDEX | DEPTH_BIT;

/// A texture of a picture's size that one pass draws into and another reads.
///
/// # Errors
/// If the device refuses it.
pub fn picture_texture(
    gpu: &Gpu,
    label: &str,
    size_px: [u32; 2],
    format: Format,
) -> Result<Texture> {
    gpu.texture(&TextureOptions {
        label,
        size: size_px,
        layers: 1,
        mip_level_count: 1,
        format,
        usage: TextureUsage::RENDER_ATTACHMENT | TextureUsage::TEXTURE_BINDING,
    })
}

impl Targets {
    /// Those that the frame asks for.
    pub fn of(frame: &Frame<'_>) -> Self {
        Self {
            colours: KINDS.map(|kind| frame.target(kind.key)),
            depth: frame.target(targets::DEPTH),
        }
    }

    /// The target of ids.
    pub fn id(&self) -> Option<Target> {
        self.colours[ID_INDEX]
    }

    /// The target of levels.
    pub fn level(&self) -> Option<Target> {
        self.colours[LEVEL_INDEX]
    }

    /// All that is asked for: what shading fills after the compute path.
    pub fn all(&self) -> TargetSet {
        let colours = self
            .colours
            .iter()
            .enumerate()
            .filter(|(_, target)| target.is_some());
        let bits = colours.fold(0, |bits, (index, _)| bits | 1 << index);
        TargetSet(if self.depth.is_some() {
            bits | DEPTH_BIT
        } else {
            bits
        })
    }

    /// All but the id, which the raster path's visibility pass writes itself.
    pub fn without_id(&self) -> TargetSet {
        TargetSet(self.all().0 & !(1 << ID_INDEX))
    }

    /// What shading fills after the raster path.
    pub fn without_visibility(&self) -> TargetSet {
        TargetSet(self.all().0 & !VISIBILITY_BITS)
    }

    /// Opens the pass that shades into those of a set: what no shading reaches stays.
    pub fn shading_pass<'r>(&self, set: TargetSet, recorder: &'r mut Recorder) -> RenderPass<'r> {
        let attached = set.indices().filter_map(|index| self.colours[index]);
        let colours: Vec<_> = attached
            .map(|target| Some(ColourAttachment::load(&target.texture)))
            .collect();
        let depth = self.depth.filter(|_| set.has_depth());
        let depth = depth.map(|target| DepthAttachment::load(&target.texture));
        recorder.render_pass("shading", &colours, depth)
    }
}

impl TargetSet {
    fn indices(self) -> impl Iterator<Item = usize> {
        (0..KINDS.len()).filter(move |index| self.0 & 1 << index != 0)
    }

    /// Whether nothing is to be filled.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Whether the depth target is to be filled.
    pub fn has_depth(self) -> bool {
        self.0 & DEPTH_BIT != 0
    }

    /// Formats of the attachments, in slot order.
    pub fn formats(self) -> impl Iterator<Item = Format> {
        self.indices().map(|index| KINDS[index].format)
    }

    /// The colour targets of a shading pipeline: what is there is replaced.
    pub fn colour_targets(self) -> Vec<Option<ColourTarget>> {
        let target = |format| {
            Some(ColourTarget {
                format,
                blend: None,
            })
        };
        self.formats().map(target).collect()
    }

    /// The depth test of a shading pipeline, if it fills that target: what is visible is known already, so its depth
    /// replaces what is there.
    pub fn depth_test(self) -> Option<DepthTest> {
        let always = DepthTest {
            compare: Compare::ALWAYS,
            ..DepthTest::NEARER
        };
        self.has_depth().then_some(always)
    }

    /// Features of the shading shader.
    pub fn features(self) -> Vec<&'static str> {
        let depth = self.has_depth().then_some("depth");
        self.indices()
            .map(|index| KINDS[index].feature)
            .chain(depth)
            .collect()
    }

    /// The WESL module `visibility::slots`: the attachment of each target. Targets outside the set get slot 0, which the
    /// shader then does not use.
    pub fn slots_module(self) -> String {
        let slot = |index| {
            self.indices()
                .position(|other| other == index)
                .unwrap_or_default()
        };
        let line = |(index, kind): (usize, &Kind)| {
            format!("const {}: u32 = {}u;\n", kind.slot, slot(index))
        };
        KINDS.iter().enumerate().map(line).collect()
    }

    /// Every set that can occur, for tests of shaders.
    pub fn each() -> impl Iterator<Item = Self> {
        (1..DEPTH_BIT << 1).map(Self)
    }
}
