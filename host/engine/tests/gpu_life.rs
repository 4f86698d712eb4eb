//! How resources of the GPU service come and go: destroying, freeing an owner, losing the device.

mod gpu_support;

use gpu_support::{PATIENCE, Rig, err, list, ok, storage_binding};
use pointstage_engine::gpu::Timings;
use pointstage_plugin_api::abi::commands::*;
use pointstage_plugin_api::abi::*;

#[test]
fn a_hundred_rounds_of_creating_and_destroying_leave_nothing() {
    let Some(rig) = Rig::new(&[]) else { return };
    for _ in 0..100 {
        let layout = rig.layout(&[storage_binding(0)]);
        let buffer = rig.storage(&[1, 2, 3]);
        let group = rig.group(layout, &[buffer]);
        let texture = rig.texture(
            Format::RGBA16_FLOAT,
            [32, 32],
            TextureUsage::TEXTURE_BINDING,
        );
        let view = ok(rig.gpu.create_texture_view(&TextureViewDescriptor {
            label: "view".into(),
            texture,
            dimension: Dimension(0),
            base_mip_level: 0,
            mip_level_count: 0,
            base_layer: 0,
            layer_count: 0,
        }));
        let sampler = ok(rig.gpu.create_sampler(&SamplerDescriptor {
            label: "sampler".into(),
            address: [AddressMode(0); 3],
            magnify: Filter::LINEAR,
            minify: Filter(0),
            mip: Filter(0),
            lod_min: 0.0,
            lod_max: 8.0,
            compare: Compare(0),
            anisotropy: 0,
        }));
        let ticket = ok(rig.gpu.create_ticket());
        assert_eq!(rig.service.handle_count(rig.owner), 7);
        assert_eq!(rig.service.bytes(rig.owner), 12 + 32 * 32 * 8);
        for handle in [layout, buffer, group, texture, view, sampler, ticket] {
            rig.gpu.destroy(handle);
        }
        assert_eq!(rig.service.handle_count(rig.owner), 0);
        assert_eq!(rig.service.bytes(rig.owner), 0);
    }
}

#[test]
fn a_read_back_counts_until_its_bytes_are_taken() {
    let Some(rig) = Rig::new(&[]) else { return };
    let buffer = rig.storage(&[0; 256]);
    let ticket = ok(rig.gpu.create_ticket());
    rig.run(vec![
        ReadBack {
            buffer,
            offset: 0,
            size: 1024,
            ticket,
        }
        .into(),
    ]);
    assert_eq!(rig.service.bytes(rig.owner), 2048);
    rig.poll(ticket);
    assert_eq!(rig.service.bytes(rig.owner), 1024);
}

#[test]
fn a_freed_owner_has_nothing_and_gets_nothing() {
    let Some(rig) = Rig::new(&[]) else { return };
    let other = Rig::new(&[]).expect("there is a device");
    let kept = other.storage(&[3]);
    let buffer = rig.storage(&[1, 2]);
    let group = rig.layout(&[storage_binding(0)]);
    rig.group(group, &[buffer]);
    rig.service.free_owner(rig.owner);
    assert_eq!(rig.service.handle_count(rig.owner), 0);
    assert_eq!(rig.service.bytes(rig.owner), 0);
    let error = err(rig.gpu.create_buffer(&BufferDescriptor {
        label: "late".into(),
        size: 4,
        usage: BufferUsage::STORAGE,
    }));
    assert_eq!(error.code, ErrorCode::BAD_HANDLE);
    assert_eq!(rig.service.bytes(rig.owner), 0);
    let error = rig
        .service
        .replay(rig.owner, &list(vec![]), Timings::Off)
        .expect_err("the owner is gone");
    assert_eq!(error.code(), ErrorCode::BAD_HANDLE);
    assert_eq!(other.read_u32(kept, 1), [3]);
}

#[test]
fn the_host_can_take_a_plugins_buffer() {
    let Some(rig) = Rig::new(&[]) else { return };
    let handle = rig.storage(&[1, 2]);
    let buffer = rig
        .service
        .buffer(rig.owner, handle)
        .expect("it is a buffer of that owner");
    assert_eq!(buffer.size(), 8);
    let layout = rig.layout(&[storage_binding(0)]);
    assert!(rig.service.buffer(rig.owner, layout).is_err());
}

#[test]
fn the_plugin_is_told_what_it_draws_on() {
    let Some(rig) = Rig::new(&[]) else { return };
    let device = rig.service.device();
    let record = rig.gpu.device();
    assert_eq!(record.name.as_str(), device.info.name);
    assert_eq!(record.generation, device.generation);
    assert_eq!(record.is_software != 0, device.is_software());
    assert_eq!(
        rig.gpu.limit("max_buffer_size".into()).into_option(),
        Some(device.limits.max_buffer_size)
    );
    for index in [0, 1] {
        let layout = ok(rig.gpu.standard_layout(index));
        let shader = rig.shader("@compute @workgroup_size(1) fn main() {}");
        rig.compute(shader, &[layout]);
    }
    let error = err(rig.gpu.standard_layout(2));
    assert_eq!(error.code, ErrorCode::UNSUPPORTED);
}

#[test]
fn every_call_after_the_loss_of_the_device_says_so() {
    let Some(rig) = Rig::on_its_own_device() else {
        return;
    };
    let buffer = rig.storage(&[1]);
    let ticket = ok(rig.gpu.create_ticket());
    let layout = rig.layout(&[storage_binding(0)]);
    // Not by our own method, as a driver does not ask us either.
    rig.service.device().device.destroy();
    let lost = |error: ErrorRecord| {
        assert_eq!(error.code, ErrorCode::DEVICE_LOST, "{}", error.message);
    };
    // wgpu tells of it when it is polled: by whoever creates, polls a ticket, or waits for a frame.
    lost(err(rig.gpu.create_buffer(&BufferDescriptor {
        label: "late".into(),
        size: 4,
        usage: BufferUsage::STORAGE,
    })));
    lost(err(rig.gpu.write_buffer(buffer, 0, [0; 4][..].into())));
    lost(err(rig.try_shader("fn f() {}")));
    lost(err(rig.try_group(layout, &[buffer])));
    lost(err(rig.gpu.poll_ticket(ticket)));
    lost(err(rig.gpu.create_ticket()));
    lost(err(rig.gpu.submit(&list(vec![]))));
    let error = rig.try_run(vec![]).expect_err("the device is lost");
    assert_eq!(error.code(), ErrorCode::DEVICE_LOST);
    let error = rig.service.wait_idle(PATIENCE).expect_err("lost");
    assert_eq!(error.code(), ErrorCode::DEVICE_LOST);
    assert!(rig.service.device().is_lost());
    rig.gpu.destroy(buffer);
    rig.service.free_owner(rig.owner);
    assert!(rig.service.device().take_errors().is_empty());

    // On the next device the old handles are stale, whatever took their places.
    let next = Rig::on_its_own_device().expect("it opened before");
    for _ in 0..10 {
        next.storage(&[1]);
    }
    let error = err(next.gpu.write_buffer(buffer, 0, [0; 4][..].into()));
    assert_eq!(error.code, ErrorCode::BAD_HANDLE);
}

#[test]
fn a_frame_after_the_loss_draws_nothing_and_waiting_for_it_says_so() {
    let Some(rig) = Rig::on_its_own_device() else {
        return;
    };
    let buffer = rig.storage(&[1]);
    let clear = ClearBuffer {
        buffer,
        offset: 0,
        size: 4,
    };
    rig.service.device().device.destroy();
    let error = match rig.try_run(vec![clear.into()]) {
        Ok(replay) => replay.wait(PATIENCE).expect_err("the device is lost"),
        Err(error) => error,
    };
    assert_eq!(error.code(), ErrorCode::DEVICE_LOST, "{error}");
    assert!(rig.service.device().take_errors().is_empty());
}

#[test]
fn a_device_lost_in_the_middle_of_a_frame_loses_its_read_back() {
    let Some(rig) = Rig::on_its_own_device() else {
        return;
    };
    let buffer = rig.storage(&[0; 1024]);
    let ticket = ok(rig.gpu.create_ticket());
    let read = ReadBack {
        buffer,
        offset: 0,
        size: 4096,
        ticket,
    };
    let mut replay = rig
        .service
        .replay(rig.owner, &list(vec![read.into()]), Timings::On)
        .expect("the commands are right");
    rig.service.device().destroy();
    replay.times();
    assert!(replay.wait(PATIENCE).is_err());
    let error = err(rig.gpu.poll_ticket(ticket));
    assert_eq!(error.code, ErrorCode::DEVICE_LOST);
}
