//! A walk of two hundred random steps over the window: it ends with no error and no leak.

use std::path::PathBuf;

use anyhow::{Result, ensure};
use pointstage_tests::scenes;
use pointstage_tests::window::{State, Widget};

use super::desk::Desk;

/// Steps of the walk.
const STEPS: u32 = 200;

/// What the walk must not click on: it would end the program, or open the system's own dialogs, which are not ours.
const LEFT_ALONE: &[&str] = &["Quit", "Open…", "Add to scene…", "Choose…", "Browse…"];

/// Where the picture is, whatever panels are open.
const PICTURE: (i16, i16) = (330, 330);

/// A linear congruential generator with Knuth's constants; its upper bits are random enough for a walk.
struct Random(u64);

impl Random {
    /// A number below `end`.
    fn below(&mut self, end: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % end.max(1)
    }
}

#[test]
fn a_random_walk_ends_with_no_error_and_no_leak() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    let home = desk.program.home().to_path_buf();
    let files = [
        scenes::write(&home, "crossing planes", &scenes::crossing_planes(30))?,
        scenes::write(&home, "ellipse", &scenes::ellipse())?,
        home.join("sphere.ply"),
    ];
    let mut random = Random(20_011_991);
    let mut said: Vec<String> = Vec::new();
    let mut after_half = None;
    for step in 0..STEPS {
        let what = take_step(&mut desk, &files, &mut random)?;
        said.push(format!("{step}: {what}"));
        let state = desk
            .window
            .wait_for_state("the window's answer", |state| Some(state.clone()));
        let state = state.map_err(|error| error.context(said.join("\n")))?;
        ensure!(
            state.errors().is_empty(),
            "an error came: {:?}\nafter\n{}",
            state.errors(),
            said.join("\n")
        );
        if step == STEPS / 2 {
            after_half = Some(held(&mut desk)?);
        }
    }
    let before = after_half.expect("the walk has a middle");
    let after = held(&mut desk)?;
    // What was opened is drawn by every renderer before the middle; from there on nothing may pile up. Threads of the
    // toolkit come and go by a few.
    ensure!(
        after.threads <= before.threads + 4 && after.files <= before.files + 8,
        "{before:?} became {after:?}"
    );
    ensure!(
        after.resident_mb <= before.resident_mb + 96,
        "{before:?} became {after:?}"
    );
    desk.close()
}

/// What the program holds, as the system tells.
#[derive(Clone, Copy, Debug)]
struct Held {
    threads: usize,
    files: usize,
    resident_mb: u64,
}

/// Goes back to a plain scene, waits until all is quiet, and counts.
fn held(desk: &mut Desk) -> Result<Held> {
    for _ in 0..3 {
        desk.window.press_keys("Escape")?;
    }
    desk.window.resize(1100, 720)?;
    let sphere = desk.program.home().join("sphere.ply");
    desk.window.drop_files(&[&sphere], PICTURE.0, PICTURE.1)?;
    desk.window
        .settle("the sphere", |state| state.objects() == ["sphere"])?;
    let folder = PathBuf::from(format!("/proc/{}", desk.window.process_id()));
    let status = std::fs::read_to_string(folder.join("status"))?;
    let resident = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    let kilobytes = resident.and_then(|text| text.trim().split(' ').next()?.parse::<u64>().ok());
    Ok(Held {
        threads: std::fs::read_dir(folder.join("task"))?.count(),
        files: std::fs::read_dir(folder.join("fd"))?.count(),
        resident_mb: kilobytes.unwrap_or_default() / 1024,
    })
}

/// Does something at random, and says what.
fn take_step(desk: &mut Desk, files: &[PathBuf], random: &mut Random) -> Result<String> {
    let (x, y) = PICTURE;
    match random.below(20) {
        0 => {
            let (width, height) = (700 + random.below(400), 450 + random.below(270));
            desk.window.resize(width as u32, height as u32)?;
            Ok(format!("resize to {width}×{height}"))
        }
        1 => {
            let file = &files[random.below(files.len())];
            desk.window.drop_files(&[file], x, y)?;
            Ok(format!("drop {}", file.display()))
        }
        2..=4 => {
            let keys = KEYS[random.below(KEYS.len())];
            desk.window.press_keys(keys)?;
            Ok(format!("keys {keys}"))
        }
        5 => {
            let button = 1 + random.below(3) as u8;
            let (right, down) = (random.below(120) as i16 - 60, random.below(120) as i16 - 60);
            desk.window.drag((x, y), (x + right, y + down), button)?;
            Ok(format!("drag by {right}, {down} with button {button}"))
        }
        6 => {
            let clicks = random.below(7) as i8 - 3;
            desk.window.scroll(x, y, clicks)?;
            Ok(format!("wheel {clicks}"))
        }
        _ => click_somewhere(desk, random),
    }
}

/// Keys that do something anywhere in the window.
const KEYS: &[&str] = &[
    "Escape",
    "f",
    "Home",
    "x",
    "y",
    "z",
    "o",
    "i",
    "p",
    "Tab",
    "Tab",
    "space",
    "Left",
    "Up",
    "ctrl+l",
    "ctrl+p",
    "F1",
    "F5",
    "ctrl+z",
    "ctrl+z",
    "ctrl+shift+z",
    "ctrl+1",
    "1",
    "ctrl+2",
    "2",
    "ctrl+shift+c",
    "ctrl+r",
];

/// Clicks on a widget that can be used.
fn click_somewhere(desk: &mut Desk, random: &mut Random) -> Result<String> {
    let widgets = desk.window.wait_for_state("widgets", |state: &State| {
        Some(state.usable(&[
            "Button",
            "RadioButton",
            "CheckBox",
            "Tab",
            "ComboBox",
            "Slider",
        ]))
    })?;
    let good: Vec<&(String, Widget)> = widgets
        .iter()
        .filter(|(name, _)| !LEFT_ALONE.iter().any(|left| name.starts_with(left)))
        .collect();
    let Some((name, widget)) = good.get(random.below(good.len())) else {
        return Ok("nothing to click on".to_owned());
    };
    let (x, y) = widget.middle();
    desk.window.click(x, y, 1)?;
    Ok(format!("click on '{name}'"))
}
