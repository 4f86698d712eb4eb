//! How fast the machine is today: benches of other crates take this file by its path.

use std::time::Instant;

/// Times a fixed amount of arithmetic and of memory traffic on one thread, and says so.
pub(crate) fn calibrate(thread_count: usize) {
    let start = Instant::now();
    let mut state = 1_u64;
    for _ in 0..100_000_000 {
        state = std::hint::black_box(
            state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1),
        );
    }
    let arithmetic = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let source = vec![1_u8; 64 << 20];
    let copy = std::hint::black_box(source.clone());
    let traffic = start.elapsed().as_secs_f64();
    println!(
        "calibration: 100 M multiplications {:.0} ms, fill and copy 64 MiB {:.0} ms, {thread_count} threads ({})",
        arithmetic * 1e3,
        traffic * 1e3,
        (state & 1) + u64::from(copy[0]),
    );
}
