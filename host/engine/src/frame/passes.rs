//! The compute passes of `shaders/compose`: their pipelines and bindings.

use super::targets::PlaneFormat;

/// Binding of the uniform.
pub(super) const UNIFORM: u32 = 0;
/// Binding of the target.
pub(super) const TARGET: u32 = 1;
/// Binding of the words that the pass writes.
pub(super) const WORDS: u32 = 2;
/// Binding of the least and the greatest value in view.
pub(super) const RANGE_KEYS: u32 = 3;

/// Pixels of a workgroup, as in the shaders.
pub(super) const WORKGROUP_PX: [u32; 2] = [64, 4];

/// What a pass does, and with which kind of target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pass {
    /// Finds the least and the greatest value in view.
    Range(PlaneFormat),
    /// Lays colours over the background.
    Colours,
    /// Makes a picture of anything else.
    Compose(PlaneFormat),
    /// Copies the values.
    Read(PlaneFormat),
}

impl Pass {
    /// What the target's values are.
    pub(super) const fn format(self) -> PlaneFormat {
        match self {
            Self::Colours => PlaneFormat::Float4,
            Self::Range(format) | Self::Compose(format) | Self::Read(format) => format,
        }
    }
}

/// The pipelines for targets of one kind.
#[derive(Debug)]
struct Kind {
    layout: wgpu::BindGroupLayout,
    range: wgpu::ComputePipeline,
    compose: wgpu::ComputePipeline,
    read: wgpu::ComputePipeline,
}

/// All pipelines.
#[derive(Debug)]
pub(super) struct Passes {
    colours: wgpu::ComputePipeline,
    floats: Kind,
    numbers: Kind,
}

/// Plain WGSL of a pass: what all share, and its own file.
macro_rules! pass_source {
    ($name:literal) => {
        concat!(
            include_str!(concat!(
                env!("CARGO_MANIFEST_DIR"),
                "/../../shaders/compose/common.wgsl"
            )),
            include_str!(concat!(
                env!("CARGO_MANIFEST_DIR"),
                "/../../shaders/compose/",
                $name,
                ".wgsl"
            ))
        )
    };
}

/// Names, which are those of files and entry points, and sources.
pub(super) const SOURCES: [(&str, &str); 7] = [
    ("compose_colours", pass_source!("compose_colours")),
    ("range_floats", pass_source!("range_floats")),
    ("compose_floats", pass_source!("compose_floats")),
    ("read_floats", pass_source!("read_floats")),
    ("range_numbers", pass_source!("range_numbers")),
    ("compose_numbers", pass_source!("compose_numbers")),
    ("read_numbers", pass_source!("read_numbers")),
];

impl Passes {
    pub(super) fn new(device: &wgpu::Device) -> Self {
        let [
            colours,
            range_floats,
            compose_floats,
            read_floats,
            range_numbers,
            compose_numbers,
            read_numbers,
        ] = SOURCES;
        let kind = |sample_type, [range, compose, read]: [(&'static str, &'static str); 3]| {
            let layout = bind_group_layout(device, sample_type);
            Kind {
                range: pipeline(device, &layout, range),
                compose: pipeline(device, &layout, compose),
                read: pipeline(device, &layout, read),
                layout,
            }
        };
        // Depth is read as an unfilterable float: GL knows no other way.
        let floats = kind(
            wgpu::TextureSampleType::Float { filterable: false },
            [range_floats, compose_floats, read_floats],
        );
        Self {
            colours: pipeline(device, &floats.layout, colours),
            floats,
            numbers: kind(
                wgpu::TextureSampleType::Uint,
                [range_numbers, compose_numbers, read_numbers],
            ),
        }
    }

    /// The pipeline of a pass and its layout of group 0.
    pub(super) fn find(&self, pass: Pass) -> (&wgpu::ComputePipeline, &wgpu::BindGroupLayout) {
        let kind = match pass.format() {
            PlaneFormat::Uint => &self.numbers,
            PlaneFormat::Float | PlaneFormat::Float4 => &self.floats,
        };
        let pipeline = match pass {
            Pass::Colours => &self.colours,
            Pass::Range(_) => &kind.range,
            Pass::Compose(_) => &kind.compose,
            Pass::Read(_) => &kind.read,
        };
        (pipeline, &kind.layout)
    }
}

fn bind_group_layout(
    device: &wgpu::Device,
    sample_type: wgpu::TextureSampleType,
) -> wgpu::BindGroupLayout {
    let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty,
        count: None,
    };
    let buffer = |ty| wgpu::BindingType::Buffer {
        ty,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    let storage = wgpu::BufferBindingType::Storage { read_only: false };
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("compose"),
        entries: &[
            entry(UNIFORM, buffer(wgpu::BufferBindingType::Uniform)),
            entry(
                TARGET,
                wgpu::BindingType::Texture {
                    sample_type,
                    view_dimension: wgpu::TextureViewDimension::D2,
                    multisampled: false,
                },
            ),
            entry(WORDS, buffer(storage)),
            entry(RANGE_KEYS, buffer(storage)),
        ],
    })
}

fn pipeline(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    (name, source): (&str, &'static str),
) -> wgpu::ComputePipeline {
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(name),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(name),
        bind_group_layouts: &[Some(layout)],
        immediate_size: 0,
    });
    device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(name),
        layout: Some(&layout),
        module: &module,
        entry_point: Some(name),
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    })
}

#[cfg(test)]
mod tests {
    use super::super::compose::Uniform;
    use super::*;
    use core::mem::{offset_of, size_of};

    #[test]
    fn every_pass_is_valid_plain_wgsl_with_an_entry_point_of_its_name() {
        for (name, source) in SOURCES {
            let module = match naga::front::wgsl::parse_str(source) {
                Ok(module) => module,
                Err(error) => panic!("{name}: {}", error.emit_to_string(source)),
            };
            let mut validator = naga::valid::Validator::new(
                naga::valid::ValidationFlags::all(),
                naga::valid::Capabilities::empty(),
            );
            assert!(validator.validate(&module).is_ok(), "{name} is not valid");
            let entry = &module.entry_points[0];
            assert_eq!((module.entry_points.len(), &*entry.name), (1, name));
            assert_eq!(entry.workgroup_size[..2], WORKGROUP_PX, "{name}");
        }
    }

    #[test]
    fn the_uniform_has_the_layout_of_the_shaders() {
        let module = naga::front::wgsl::parse_str(SOURCES[0].1).unwrap();
        let members = module.types.iter().find_map(|(_, ty)| match &ty.inner {
            naga::TypeInner::Struct { members, span }
                if ty.name.as_deref() == Some("Composition") =>
            {
                Some((members, *span))
            }
            _ => None,
        });
        let (members, span) = members.unwrap();
        macro_rules! offsets {
            ($($field:ident),* $(,)?) => { [$((stringify!($field), offset_of!(Uniform, $field) as u32)),*] };
        }
        let expected = offsets![
            ramp,
            kinds,
            background_top,
            background_bottom,
            distance_terms,
            size_px,
            first_row,
            row_count,
            appearance,
            clear_number,
            clear_value,
            clear_tolerance,
            exposure,
            tile_origin_y_px,
            image_height_px,
            channels,
            given_ends,
            has_given_ends,
            padding,
        ];
        let found: Vec<(&str, u32)> = members
            .iter()
            .map(|member| (member.name.as_deref().unwrap_or(""), member.offset))
            .collect();
        assert_eq!(found, expected);
        assert_eq!(span as usize, size_of::<Uniform>());
    }
}
