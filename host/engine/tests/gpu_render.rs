//! Rendering through the GPU service: several targets, blending, depth, the host's own targets and groups.

mod gpu_support;

use abi_stable::std_types::RSlice;
use gpu_support::{Rig, ok, stage};
use pointstage_plugin_api::abi::commands::*;
use pointstage_plugin_api::abi::*;

/// One triangle over the whole picture per instance, at the depth and with the colour of its instance.
const LAYERS: &str = "
struct Layer { @builtin(position) position: vec4f, @location(0) @interpolate(flat) number: u32 }

@vertex
fn layer_vertex(@builtin(vertex_index) corner: u32, @builtin(instance_index) number: u32) -> Layer {
    let x = f32(i32(corner & 1u) * 4 - 1);
    let y = f32(i32(corner >> 1u) * 4 - 1);
    // Reversed z: the greater is the nearer.
    return Layer(vec4f(x, y, 0.25 * f32(number + 1u), 1.0), number);
}

struct Targets { @location(0) sum: vec4f, @location(1) id: u32 }

@fragment
fn layer_fragment(layer: Layer) -> Targets {
    return Targets(vec4f(0.25, 0.5, 1.0, 1.0), layer.number + 10u);
}
";

const SIZE: [u32; 2] = [64, 4];

fn layers_pipeline(rig: &Rig, compare: Compare) -> Handle {
    let shader = rig.shader(LAYERS);
    let add = BlendComponentRecord {
        source: BlendFactor::ONE,
        destination: BlendFactor::ONE,
        operation: BlendOperation::ADD,
    };
    let targets = [
        ColourTargetRecord {
            format: Format::RGBA16_FLOAT,
            blends: 1,
            colour: add,
            alpha: add,
            write_mask: 15,
        },
        ColourTargetRecord {
            format: Format::R32_UINT,
            write_mask: 15,
            ..Default::default()
        },
    ];
    ok(rig.gpu.create_render_pipeline(&RenderPipelineDescriptor {
        label: "layers".into(),
        layouts: RSlice::EMPTY,
        immediate_size: 0,
        vertex: stage(shader, "layer_vertex"),
        fragment: stage(shader, "layer_fragment"),
        vertex_buffers: RSlice::EMPTY,
        topology: Topology(0),
        front_face: FrontFace(0),
        cull: CullMode(0),
        depth: DepthRecord {
            format: Format::DEPTH32_FLOAT,
            writes: 1,
            compare,
            ..Default::default()
        },
        targets: targets.as_slice().into(),
        sample_count: 0,
    }))
}

/// Pass that clears and draws `count` layers, first to last from far to near.
fn layers_pass(pipeline: Handle, [sum, id, depth]: [Handle; 3], count: u32) -> Vec<Command> {
    let colour = |target, clear| {
        Some(ColourAttachment {
            target,
            resolve: Handle::NONE,
            clear: Some(clear),
            store: true,
        })
    };
    vec![
        BeginRenderPass {
            label: "layers".into(),
            colours: vec![colour(sum, [0.0; 4]), colour(id, [0.0; 4])],
            depth: Some(DepthAttachment {
                target: depth,
                clear: Some(0.0),
                store: true,
                read_only: false,
            }),
        }
        .into(),
        SetPipeline { pipeline }.into(),
        SetViewport {
            origin: [0.0; 2],
            size: [SIZE[0] as f32, SIZE[1] as f32],
            depth: [0.0, 1.0],
        }
        .into(),
        // The right half stays clear.
        SetScissor {
            origin: [0, 0],
            size: [SIZE[0] / 2, SIZE[1]],
        }
        .into(),
        Draw {
            vertex_count: 3,
            instance_count: count,
            first_vertex: 0,
            first_instance: 0,
        }
        .into(),
        EndRenderPass {}.into(),
    ]
}

/// Reads the first row of a texture of [`SIZE`] with so many bytes a texel.
fn first_row(rig: &Rig, texture: Handle, bytes: u32) -> Vec<u8> {
    let row = (SIZE[0] * bytes).next_multiple_of(256);
    let size = u64::from(row * SIZE[1]);
    let rows = rig.buffer(size, BufferUsage::COPY_SRC | BufferUsage::COPY_DST);
    rig.run(vec![
        CopyTextureToBuffer {
            source: texture,
            mip_level: 0,
            origin: [0; 3],
            // All rows: WebGPU copies depth only as a whole.
            size: [SIZE[0], SIZE[1], 1],
            target: rows,
            offset: 0,
            bytes_per_row: row,
        }
        .into(),
    ]);
    rig.read(rows, u64::from(row))
}

fn halves(bytes: &[u8], texel: usize) -> [f32; 4] {
    let channel = |i: usize| {
        let at = texel * 8 + i * 2;
        half::f16::from_le_bytes([bytes[at], bytes[at + 1]]).to_f32()
    };
    [channel(0), channel(1), channel(2), channel(3)]
}

#[test]
fn layers_add_up_into_half_floats_beside_other_targets_and_depth() {
    let Some(rig) = Rig::new(&[]) else { return };
    let usage = TextureUsage::RENDER_ATTACHMENT | TextureUsage::COPY_SRC;
    let targets = [
        Format::RGBA16_FLOAT,
        Format::R32_UINT,
        Format::DEPTH32_FLOAT,
    ]
    .map(|format| rig.texture(format, SIZE, usage));
    let pipeline = layers_pipeline(&rig, Compare::GREATER);
    rig.run(layers_pass(pipeline, targets, 3));
    let [sum, id, depth] = targets;
    let sums = first_row(&rig, sum, 8);
    assert_eq!(
        halves(&sums, 0),
        [0.75, 1.5, 3.0, 3.0],
        "three layers, each nearer"
    );
    assert_eq!(halves(&sums, 63), [0.0; 4], "outside the scissor");
    let ids: Vec<u32> = bytemuck::pod_collect_to_vec(&first_row(&rig, id, 4));
    assert_eq!((ids[0], ids[63]), (12, 0), "the last layer replaces");
    let depths: Vec<f32> = bytemuck::pod_collect_to_vec(&first_row(&rig, depth, 4));
    assert_eq!((depths[0], depths[63]), (0.75, 0.0));

    // The other way round only the first layer passes the depth test.
    let pipeline = layers_pipeline(&rig, Compare::EQUAL);
    rig.run(layers_pass(pipeline, targets, 3));
    assert_eq!(
        halves(&first_row(&rig, sum, 8), 0),
        [0.0; 4],
        "no layer is at depth 0"
    );
}

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

#[test]
fn indexed_vertices_and_immediates_reach_the_shader() {
    let Some(rig) = Rig::new(&["immediates"]) else {
        return;
    };
    if !rig.device_has(wgpu::Features::IMMEDIATES) {
        return;
    }
    let shader = rig.shader(
        "
        struct Tint { colour: vec4f }
        var<immediate> tint: Tint;
        @vertex fn corner(@location(0) position: vec2f) -> @builtin(position) vec4f {
            return vec4f(position, 0.0, 1.0);
        }
        @fragment fn fill() -> @location(0) vec4f { return tint.colour; }",
    );
    let attributes = [VertexAttributeRecord {
        format: VertexFormat::FLOAT32X2,
        offset: 0,
        location: 0,
    }];
    let vertex_buffers = [VertexBufferRecord {
        stride: 8,
        step: StepMode(0),
        attributes: attributes.as_slice().into(),
    }];
    let targets = [ColourTargetRecord {
        format: Format::RGBA16_FLOAT,
        write_mask: 15,
        ..Default::default()
    }];
    let pipeline = ok(rig.gpu.create_render_pipeline(&RenderPipelineDescriptor {
        label: "tinted".into(),
        layouts: RSlice::EMPTY,
        immediate_size: 16,
        vertex: stage(shader, "corner"),
        fragment: stage(shader, "fill"),
        vertex_buffers: vertex_buffers.as_slice().into(),
        topology: Topology::TRIANGLE_LIST,
        front_face: FrontFace(0),
        cull: CullMode(0),
        depth: DepthRecord::default(),
        targets: targets.as_slice().into(),
        sample_count: 1,
    }));
    let corners: [[f32; 2]; 4] = [[9.0, 9.0], [-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]];
    let vertices = rig.buffer(32, BufferUsage::VERTEX | BufferUsage::COPY_DST);
    ok(rig
        .gpu
        .write_buffer(vertices, 0, bytemuck::cast_slice(&corners).into()));
    let indices = rig.buffer(8, BufferUsage::INDEX | BufferUsage::COPY_DST);
    ok(rig
        .gpu
        .write_buffer(indices, 0, bytemuck::cast_slice(&[1_u16, 2, 3, 0]).into()));
    let usage = TextureUsage::RENDER_ATTACHMENT | TextureUsage::COPY_SRC;
    let colour = rig.texture(Format::RGBA16_FLOAT, SIZE, usage);
    let tint = [0.5_f32, 0.25, 2.0, 1.0];
    let pass = |draw: Command| {
        vec![
            BeginRenderPass {
                label: "tinted".into(),
                colours: vec![Some(ColourAttachment {
                    target: colour,
                    resolve: Handle::NONE,
                    clear: Some([0.0; 4]),
                    store: true,
                })],
                depth: None,
            }
            .into(),
            SetPipeline { pipeline }.into(),
            SetImmediates {
                offset: 0,
                data: bytemuck::cast_slice(&tint).to_vec(),
            }
            .into(),
            SetVertexBuffer {
                slot: 0,
                buffer: vertices,
                offset: 0,
            }
            .into(),
            SetIndexBuffer {
                buffer: indices,
                offset: 0,
                wide: false,
            }
            .into(),
            draw,
            EndRenderPass {}.into(),
        ]
    };
    let arguments = rig.storage(&[3, 1, 0, 0, 0]);
    for draw in [
        DrawIndexed {
            index_count: 3,
            instance_count: 1,
            first_index: 0,
            base_vertex: 0,
            first_instance: 0,
        }
        .into(),
        DrawIndexedIndirect {
            buffer: arguments,
            offset: 0,
        }
        .into(),
    ] {
        rig.run(pass(draw));
        assert_eq!(halves(&first_row(&rig, colour, 8), 9), tint);
    }
    let message = rig.refused(pass(
        DrawIndexed {
            index_count: 5,
            instance_count: 1,
            first_index: 0,
            base_vertex: 0,
            first_instance: 0,
        }
        .into(),
    ));
    assert!(
        message.starts_with("command 5 (DrawIndexed): "),
        "{message}"
    );
}
