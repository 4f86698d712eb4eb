//! Rendering through the GPU service: several targets, blending, depth, vertex buffers and immediates.

mod gpu_support;

use abi_stable::std_types::RSlice;
use gpu_support::{Rig, SIZE, first_row, halves, ok, stage};
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
