//! The render thread: what is done first, and that background work never holds up a picture.

use pointstage_engine::stage::{
    FALLBACK_ID, FrameRequest, Stage, StageOptions, StageThread, ViewportId,
};
use pointstage_scene::{Camera, Scene};
use std::ops::ControlFlow;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// Far longer than anything here takes.
const PATIENCE: Duration = Duration::from_mins(1);

/// A thread without a device and without plugins, and what it says whenever there is something new.
fn spawn() -> (StageThread, Receiver<()>) {
    let options = StageOptions {
        use_device: false,
        ..StageOptions::default()
    };
    let (wake, woken) = channel();
    let thread = StageThread::spawn(options, move || {
        // Nobody listens any more when the test has ended.
        let _ = wake.send(());
    });
    (thread.expect("a thread"), woken)
}

fn frame() -> FrameRequest {
    FrameRequest::still(
        Arc::new(Scene::new()),
        Camera::default(),
        [8, 8],
        FALLBACK_ID,
    )
}

/// Holds the thread until the sender is dropped.
fn hold(thread: &StageThread) -> Sender<()> {
    let (release, held) = channel::<()>();
    thread.errand(move |_: &mut Stage| {
        // An error is the release.
        let _ = held.recv();
    });
    release
}

#[test]
fn background_work_goes_on_step_by_step_behind_frames_and_errands() {
    let (thread, _woken) = spawn();
    let order: Arc<Mutex<Vec<&str>>> = Arc::default();
    let note = |what: &'static str| {
        let order = Arc::clone(&order);
        move || order.lock().expect("no panic").push(what)
    };
    let (first, between, last) = (note("step 1"), note("errand"), note("step 2"));
    let release = hold(&thread);
    let (told, reached) = channel();
    let (go_on, going) = channel::<()>();
    let mut step = 0;
    thread.background(move |_| {
        step += 1;
        if step == 1 {
            first();
            told.send(()).expect("the test waits");
            // Until the test has put an errand and a frame into the queue.
            let _ = going.recv();
            return ControlFlow::Continue(());
        }
        last();
        told.send(()).expect("the test waits");
        ControlFlow::Break(())
    });
    assert!(thread.status().background);
    drop(release);
    reached.recv_timeout(PATIENCE).expect("the first step");
    assert!(
        !thread.status().busy,
        "background work does not count as busy"
    );
    thread.submit(frame());
    thread.errand(move |_| between());
    drop(go_on);
    reached.recv_timeout(PATIENCE).expect("the second step");
    assert!(
        thread.latest(ViewportId(0)).is_some(),
        "the frame came before the second step"
    );
    let order = order.lock().expect("no panic").clone();
    assert_eq!(order, ["step 1", "errand", "step 2"]);
}

#[test]
fn endless_background_work_ends_with_the_thread_and_is_told_apart_from_busy() {
    let (thread, woken) = spawn();
    thread.background(|_| ControlFlow::Continue(()));
    for _ in 0..20 {
        woken.recv_timeout(PATIENCE).expect("steps go on");
    }
    thread.submit(frame());
    while thread.latest(ViewportId(0)).is_none() {
        woken.recv_timeout(PATIENCE).expect("the frame comes");
    }
    let status = thread.status();
    assert!(status.background && !status.busy);
    drop(thread);
}

#[test]
fn works_take_turns_only_when_one_has_ended() {
    let (thread, _woken) = spawn();
    let release = hold(&thread);
    let (told, order) = channel();
    for name in ["first", "second"] {
        let told = told.clone();
        let mut steps = 0;
        thread.background(move |_| {
            steps += 1;
            told.send((name, steps)).expect("the test listens");
            if steps < 2 {
                ControlFlow::Continue(())
            } else {
                ControlFlow::Break(())
            }
        });
    }
    drop(release);
    let order: Vec<_> = (0..4)
        .map(|_| order.recv_timeout(PATIENCE).expect("four steps"))
        .collect();
    assert_eq!(
        order,
        [("first", 1), ("first", 2), ("second", 1), ("second", 2)]
    );
}

#[test]
fn every_viewport_gets_its_frame_and_a_closed_one_is_forgotten() {
    let (thread, woken) = spawn();
    let of = |viewport: u32, side: u32| FrameRequest {
        viewport: ViewportId(viewport),
        size_px: [side, 4],
        ..frame()
    };
    let release = hold(&thread);
    for viewport in 0..4 {
        thread.submit(of(viewport, 8));
    }
    // Whoever asks again while all wait takes nobody's place.
    thread.submit(of(1, 9));
    thread.close_viewport(ViewportId(3));
    drop(release);
    while thread.status().busy {
        woken.recv_timeout(PATIENCE).expect("the frames come");
    }
    let widths = [0, 1, 2, 3].map(|viewport| {
        let latest = thread.latest(ViewportId(viewport));
        latest.map(|frame| frame.picture.size_px[0])
    });
    assert_eq!(widths, [Some(8), Some(9), Some(8), None]);
    thread.close_viewport(ViewportId(0));
    assert!(thread.latest(ViewportId(0)).is_none());
    thread.submit(of(0, 7));
    while thread.latest(ViewportId(0)).is_none() {
        woken
            .recv_timeout(PATIENCE)
            .expect("it is asked for again, and comes");
    }
}
