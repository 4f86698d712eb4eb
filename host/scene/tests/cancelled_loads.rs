//! A cancelled load ends, wherever it is.

use std::fmt::Write as _;

use pointstage_scene::{Job, LoadError, LoadOptions, load};

const XYZ: &str = "property float x\nproperty float y\nproperty float z";

#[test]
fn a_cancelled_job_stops_the_load() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("cancelled.ply");
    std::fs::write(
        &path,
        format!("ply\nformat ascii 1.0\nelement vertex 1\n{XYZ}\nend_header\n1 2 3\n"),
    )
    .expect("written");
    let job = Job::new();
    job.cancel();
    assert!(matches!(
        load(&path, &LoadOptions::default(), &job),
        Err(LoadError::Cancelled(_))
    ));
}

#[test]
fn a_cancel_while_neighbours_are_sought_ends_the_load() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("cloud.ply");
    let mut file = format!("ply\nformat ascii 1.0\nelement vertex 300000\n{XYZ}\nend_header\n");
    for index in 0..300_000_u32 {
        let turn = f64::from(index) * 0.01;
        let _ = writeln!(
            file,
            "{:.4} {:.4} {:.4}",
            turn.sin(),
            turn.cos(),
            turn * 1e-3
        );
    }
    std::fs::write(&path, file).expect("written");
    let job = Job::new();
    let watched = job.clone();
    let worker = std::thread::spawn(move || load(&path, &LoadOptions::default(), &job));
    while !watched.stage().contains("neighbours") && !worker.is_finished() {
        std::thread::yield_now();
    }
    watched.cancel();
    let result = worker.join().expect("no panic");
    assert!(
        matches!(result, Err(LoadError::Cancelled(_))),
        "{result:?} in stage '{}'",
        watched.stage()
    );
    assert!(watched.progress() < 1.0);
}
