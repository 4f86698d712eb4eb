//! Lists of commands that no careful plugin submits: each is refused with the index of what is wrong, and nothing of it is done.

mod gpu_support;

use abi_stable::std_types::{RErr, ROk};
use gpu_support::{NOTHING, Rig, begin, dispatch, list, ok, storage_binding};
use pointstage_engine::gpu::Timings;
use pointstage_plugin_api::abi::commands::*;
use pointstage_plugin_api::abi::*;

#[test]
fn a_command_in_the_wrong_place_is_refused_with_its_index() {
    let Some(rig) = Rig::new(&[]) else { return };
    let draw: Command = Draw {
        vertex_count: 3,
        instance_count: 1,
        first_vertex: 0,
        first_instance: 0,
    }
    .into();
    let end: Command = EndComputePass {}.into();
    let pipeline = rig.compute(rig.shader(NOTHING), &[]);
    let set: Command = SetPipeline { pipeline }.into();
    let pop: Command = PopDebugGroup {}.into();
    let push: Command = PushDebugGroup {
        label: "group".into(),
    }
    .into();
    for (commands, expected) in [
        (
            vec![draw.clone()],
            "command 0 (Draw): no render pass is open",
        ),
        (
            vec![begin(), draw],
            "command 1 (Draw): no render pass is open",
        ),
        (
            vec![dispatch()],
            "command 0 (Dispatch): no compute pass is open",
        ),
        (
            vec![begin(), dispatch()],
            "command 1 (Dispatch): no pipeline is set",
        ),
        (
            vec![set.clone()],
            "command 0 (SetPipeline): no pass is open",
        ),
        (
            vec![end.clone()],
            "command 0 (EndComputePass): no compute pass is open",
        ),
        (
            vec![begin(), begin()],
            "command 1 (BeginComputePass): the pass 'test pass' is open",
        ),
        (
            vec![begin(), set],
            "the list ends inside the pass 'test pass'",
        ),
        (
            vec![begin(), pop, end.clone()],
            "command 1 (PopDebugGroup): no debug group is open",
        ),
        (
            vec![begin(), push.clone(), end],
            "command 2 (EndComputePass): 1 debug groups",
        ),
        (vec![push], "the end of the commands: 1 debug groups"),
    ] {
        let message = rig.refused(commands);
        assert!(
            message.contains(expected),
            "expected '{expected}', found '{message}'"
        );
    }
}

#[test]
fn what_only_wgpu_finds_names_its_command_too() {
    let Some(rig) = Rig::new(&[]) else { return };
    let layout = rig.layout(&[storage_binding(0)]);
    let shader = rig.shader(
        "@group(0) @binding(0) var<storage, read_write> values: array<u32>;
        @compute @workgroup_size(1) fn main() { values[0] = 1u; }",
    );
    let pipeline = rig.compute(shader, &[layout]);
    let values = rig.storage(&[5]);
    let group = rig.group(layout, &[values]);
    let set: Command = SetPipeline { pipeline }.into();
    let clear = ClearBuffer {
        buffer: values,
        offset: 0,
        size: 4,
    };
    let bind = SetBindGroup {
        index: 0,
        group,
        offsets: vec![],
    };
    let end: Command = EndComputePass {}.into();
    let message = rig.refused(vec![
        clear.into(),
        begin(),
        set.clone(),
        bind.into(),
        dispatch(),
        end.clone(),
        begin(),
        set,
        // No bind group in this pass.
        dispatch(),
        end,
    ]);
    assert!(message.starts_with("command 8 (Dispatch): "), "{message}");
    assert_eq!(rig.read_u32(values, 1), [5], "nothing of it was submitted");
    assert!(rig.service.device().take_errors().is_empty());
}

#[test]
fn an_operation_of_a_newer_border_is_refused_with_its_index() {
    let Some(rig) = Rig::new(&[]) else { return };
    let mut commands = list(vec![begin(), EndComputePass {}.into()]);
    commands.commands.push(CommandRecord {
        operation: 9999,
        start: 0,
        length: 0,
    });
    let error = rig
        .service
        .replay(rig.owner, &commands, Timings::Off)
        .expect_err("no such operation");
    assert_eq!(error.code(), ErrorCode::UNSUPPORTED);
    assert!(
        error.to_string().contains("command 2: operation 9999"),
        "{error}"
    );
    commands.commands[2].operation = 17;
    let error = rig
        .service
        .replay(rig.owner, &commands, Timings::Off)
        .expect_err("no payload");
    assert_eq!(error.code(), ErrorCode::VALIDATION);
    assert!(error.to_string().contains("command 2"), "{error}");
}

#[test]
fn damaged_lists_never_panic() {
    let Some(rig) = Rig::new(&[]) else { return };
    let pipeline = rig.compute(rig.shader(NOTHING), &[]);
    let good = list(vec![
        begin(),
        SetPipeline { pipeline }.into(),
        dispatch(),
        EndComputePass {}.into(),
        ReadBack {
            buffer: rig.storage(&[1]),
            offset: 0,
            size: 4,
            ticket: ok(rig.gpu.create_ticket()),
        }
        .into(),
    ]);
    // Every byte of the payload and every operation number, changed one at a time.
    let mut damaged: Vec<CommandListRecord> = Vec::new();
    for index in 0..good.payload.len() {
        for change in [1, 0x80, 0xff] {
            let mut list = good.clone();
            list.payload[index] ^= change;
            damaged.push(list);
        }
    }
    for index in 0..good.commands.len() {
        for operation in 0..30 {
            let mut list = good.clone();
            list.commands[index].operation = operation;
            damaged.push(list);
        }
    }
    for list in damaged {
        match rig.gpu.submit(&list) {
            ROk(()) => {}
            RErr(error) => assert_ne!(error.code, ErrorCode::PANICKED, "{}", error.message),
        }
    }
    assert!(rig.service.device().take_errors().is_empty());
}
