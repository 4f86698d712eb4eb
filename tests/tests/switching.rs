//! Does switching leave anything behind? A hundred switches between renderers, with what else changes on the way, and
//! then a count of all that can leak.

use std::path::Path;
use std::sync::Arc;

use anyhow::{Context as _, Result};
use pointstage_engine::stage::{FrameRequest, Show, Stage};
use pointstage_scene::Scene;
use pointstage_tests::{scenes, stages};

const RENDERERS: [&str; 2] = ["points", "surfel"];
const SIZE_PX: [u32; 2] = [160, 120];

/// What a session holds. Two of these are equal when nothing was left behind.
#[derive(Debug, PartialEq, Eq)]
struct Holdings {
    /// Handles and bytes on the device, by renderer.
    by_renderer: Vec<(usize, u64)>,
    /// Labels of what was allocated on the device, sorted. Not their sizes, which vary by some bytes with alignment.
    allocations: Vec<String>,
    /// Open files of this process; none where the system does not tell.
    open_file_count: Option<usize>,
    thread_count: Option<usize>,
}

/// What the session holds, and how much of the device's memory in all, bytes.
fn holdings(stage: &Stage) -> Result<(Holdings, u64)> {
    let device = &stage.device().context("no device")?.device;
    let report = device
        .generate_allocator_report()
        .context("this backend does not tell what is allocated")?;
    let allocations = report.allocations.into_iter();
    let mut allocations: Vec<_> = allocations.map(|part| part.name).collect();
    allocations.sort();
    let count = |folder: &str| Some(std::fs::read_dir(Path::new(folder)).ok()?.count());
    let registry = stage.registry();
    let by_renderer = RENDERERS.map(|alias| {
        let info = registry.find_renderer(alias)?;
        anyhow::Ok(stage.holdings(&info.id))
    });
    let holdings = Holdings {
        by_renderer: by_renderer.into_iter().collect::<Result<_>>()?,
        allocations,
        open_file_count: count("/proc/self/fd"),
        thread_count: count("/proc/self/task"),
    };
    Ok((holdings, report.total_allocated_bytes))
}

fn draw(stage: &mut Stage, request: &FrameRequest) -> Result<Arc<[u8]>> {
    let result = stage.frame(request)?;
    assert!(
        result.drawn_by.ends_with(&request.renderer),
        "{} drew instead of {}",
        result.drawn_by,
        request.renderer
    );
    assert_eq!(result.notices, [], "nothing is to be told");
    Ok(Arc::from(&*result.picture.rgba))
}

/// One test, since open files and threads are counted for the whole process.
#[test]
fn a_hundred_switches_leave_nothing_behind() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let sphere = stages::scene(folder.path(), "sphere", &scenes::sphere(2000, 1.0))?;
    let ellipse = stages::scene(folder.path(), "ellipse", &scenes::ellipse())?;
    let mut stage = stages::stage(&RENDERERS)?;
    let request = |scene: &Arc<Scene>, renderer| stages::window_frame(scene, SIZE_PX, renderer);

    let mut pictures = Vec::new();
    for renderer in RENDERERS {
        pictures.push(draw(&mut stage, &request(&sphere, renderer))?);
    }
    assert_ne!(
        pictures[0], pictures[1],
        "each renderer has a picture of its own"
    );
    // Once as large as it ever gets: what is read back into keeps its size. And each twice, so that what is made at the
    // first return is there.
    let largest = FrameRequest {
        size_px: [300, 120],
        ..request(&sphere, RENDERERS[0])
    };
    draw(&mut stage, &largest)?;
    for renderer in RENDERERS {
        draw(&mut stage, &request(&sphere, renderer))?;
    }
    let (before, bytes_before) = holdings(&stage)?;
    assert!(before.by_renderer.iter().all(|&(handles, _)| handles > 0));

    for switch in 0..100 {
        let number = switch % 2;
        let mut frame = request(&sphere, RENDERERS[number]);
        match switch {
            // Back and forth, and nothing else.
            0..40 => {}
            // With another target and another size each time.
            40..70 => {
                let keys = ["depth", "normal", "id", "kind"];
                frame.show = Show::Target(keys[switch % keys.len()].into());
                frame.size_px = [160 + switch as u32, 120];
                draw(&mut stage, &frame)?;
                continue;
            }
            // With another scene between: everything is prepared anew.
            _ => drop(draw(&mut stage, &request(&ellipse, RENDERERS[number]))?),
        }
        assert_eq!(
            draw(&mut stage, &frame)?,
            pictures[number],
            "switch {switch}: {} comes back with another picture",
            RENDERERS[number]
        );
    }

    for renderer in RENDERERS {
        draw(&mut stage, &request(&sphere, renderer))?;
    }
    let (after, bytes_after) = holdings(&stage)?;
    assert_eq!(after, before);
    let growth = bytes_after as f64 / bytes_before as f64;
    assert!(
        growth < 1.01,
        "{bytes_before} bytes on the device became {bytes_after}"
    );
    Ok(())
}
