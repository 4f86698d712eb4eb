//! The host's own targets and bind groups in the hands of a plugin.

mod gpu_support;

use abi_stable::std_types::RSlice;
use gpu_support::{Rig, SIZE, first_row, halves, ok, stage};
use pointstage_plugin_api::abi::commands::*;
use pointstage_plugin_api::abi::*;

#[test]
fn the_hosts_targets_and_groups_serve_a_plugin() {
    let Some(rig) = Rig::new(&[]) else { return };
    let device = &rig.service.device().device;
    let target = |format| {
        rig.service
            .import_texture(device.create_texture(&wgpu::TextureDescriptor {
                label: Some("host's target"),
                size: wgpu::Extent3d {
                    width: SIZE[0],
                    height: SIZE[1],
                    depth_or_array_layers: 1,
                },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            }))
    };
    let colour = target(wgpu::TextureFormat::Rgba16Float);

    // Group 0: frame, and two draws of which the second is chosen by its offset.
    let alignment = u64::from(device.limits().min_uniform_buffer_offset_alignment);
    let draw_bytes = size_of::<DrawUniform>() as u64;
    let stride = draw_bytes.next_multiple_of(alignment);
    let buffer = |size, usage| {
        device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("host's buffer"),
            size,
            usage: usage | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    };
    let frame = buffer(
        size_of::<FrameUniform>() as u64,
        wgpu::BufferUsages::UNIFORM,
    );
    let draws = buffer(stride * 2, wgpu::BufferUsages::UNIFORM);
    let queue = &rig.service.device().queue;
    queue.write_buffer(
        &frame,
        0,
        bytemuck::bytes_of(&FrameUniform {
            radius_scale: 0.5,
            ..Default::default()
        }),
    );
    for (number, radius_factor) in [(0, 8.0), (1, 4.0)] {
        let uniform = DrawUniform {
            radius_factor,
            ..Default::default()
        };
        queue.write_buffer(&draws, number * stride, bytemuck::bytes_of(&uniform));
    }
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("frame and draw"),
        layout: rig.service.frame_layout(),
        entries: &[
            wgpu::BindGroupEntry {
                binding: standard_bindings::FRAME,
                resource: frame.as_entire_binding(),
            },
            wgpu::BindGroupEntry {
                binding: standard_bindings::DRAW,
                resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                    buffer: &draws,
                    offset: 0,
                    size: wgpu::BufferSize::new(draw_bytes),
                }),
            },
        ],
    });
    let frame_group = rig.service.import_bind_group(group, 0);

    // Group 1: one column in all bindings.
    let column = buffer(64, wgpu::BufferUsages::STORAGE);
    queue.write_buffer(&column, 0, bytemuck::cast_slice(&[3.0_f32; 16]));
    let entries: Vec<_> = (0..=standard_bindings::INDIRECT)
        .map(|binding| wgpu::BindGroupEntry {
            binding,
            resource: column.as_entire_binding(),
        })
        .collect();
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("columns"),
        layout: rig.service.columns_layout(),
        entries: &entries,
    });
    let columns_group = rig.service.import_bind_group(group, 1);

    let scale_at = std::mem::offset_of!(FrameUniform, radius_scale) / 4;
    let factor_at = std::mem::offset_of!(DrawUniform, radius_factor) / 4;
    let shader = rig.shader(&format!(
        "
        @group(0) @binding(0) var<uniform> frame: array<vec4f, {}>;
        @group(0) @binding(1) var<uniform> draw: array<vec4f, {}>;
        @group(1) @binding(0) var<storage, read> position_radius: array<vec4f>;
        @vertex fn cover(@builtin(vertex_index) corner: u32) -> @builtin(position) vec4f {{
            return vec4f(f32(i32(corner & 1u) * 4 - 1), f32(i32(corner >> 1u) * 4 - 1), 0.0, 1.0);
        }}
        @fragment fn show() -> @location(0) vec4f {{
            return vec4f(frame[{}][{}], draw[{}][{}], position_radius[0].w, 1.0);
        }}",
        size_of::<FrameUniform>() / 16,
        size_of::<DrawUniform>() / 16,
        scale_at / 4,
        scale_at % 4,
        factor_at / 4,
        factor_at % 4,
    ));
    let layouts = [0, 1].map(|index| ok(rig.gpu.standard_layout(index)));
    let targets = [ColourTargetRecord {
        format: Format::RGBA16_FLOAT,
        write_mask: 15,
        ..Default::default()
    }];
    let pipeline = ok(rig.gpu.create_render_pipeline(&RenderPipelineDescriptor {
        label: "standard groups".into(),
        layouts: layouts.as_slice().into(),
        immediate_size: 0,
        vertex: stage(shader, "cover"),
        fragment: stage(shader, "show"),
        vertex_buffers: RSlice::EMPTY,
        topology: Topology(0),
        front_face: FrontFace(0),
        cull: CullMode(0),
        depth: DepthRecord::default(),
        targets: targets.as_slice().into(),
        sample_count: 0,
    }));
    let bind = |index, group, offsets| SetBindGroup {
        index,
        group,
        offsets,
    };
    let begin = BeginRenderPass {
        label: "standard groups".into(),
        colours: vec![Some(ColourAttachment {
            target: colour,
            resolve: Handle::NONE,
            clear: Some([0.0; 4]),
            store: true,
        })],
        depth: None,
    };
    let draw = Draw {
        vertex_count: 3,
        instance_count: 1,
        first_vertex: 0,
        first_instance: 0,
    };
    rig.run(vec![
        begin.clone().into(),
        SetPipeline { pipeline }.into(),
        bind(0, frame_group, vec![stride as u32]).into(),
        bind(1, columns_group, vec![]).into(),
        draw.into(),
        EndRenderPass {}.into(),
    ]);
    let row = first_row(&rig, colour, 8);
    assert_eq!(halves(&row, 5), [0.5, 4.0, 3.0, 1.0]);

    let message = rig.refused(vec![
        begin.into(),
        SetPipeline { pipeline }.into(),
        bind(0, frame_group, vec![]).into(),
    ]);
    assert!(
        message.contains("command 2 (SetBindGroup): 0 dynamic offsets"),
        "{message}"
    );
    rig.service.free_owner(rig.owner);
    rig.service.release(colour);
    rig.service.release(frame_group);
    rig.service.release(columns_group);
}
