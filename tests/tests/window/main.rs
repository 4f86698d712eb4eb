//! The window on a virtual display, used as a person uses it: found by what it says, clicked, typed to, dropped on.

mod camera;
mod compare;
mod desk;
mod guide;
mod hand_over;
mod panel;
mod plugins;
mod resize;
mod save;
mod selecting;
mod session;
mod walk;

use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};
use pointstage_tests::program::{self, Program};
use pointstage_tests::window::{Display, State};
use pointstage_tests::{data, mesh_files, scenes};

use desk::{Desk, POINTS, coloured, difference, same, sphere};

const SURFEL: &str = "org.pointstage.surfel";
const FALLBACK: &str = "pointstage.fallback";

/// What a change of the renderer must not touch.
fn kept(state: &State) -> [&serde_json::Value; 3] {
    ["objects", "view", "lights"].map(|key| state.session(key))
}

#[test]
fn a_file_named_on_the_command_line_is_shown() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    // Of 740 × 670 pixels, 3,000 points of 2 × 2 px cover 12,000 at most.
    desk.wait_for_picture("opened by argument", |picture| coloured(picture) > 2000)?;
    desk.window
        .wait_for_state("the counts in the status bar", |state| {
            state
                .shows("3\u{2009}000 surfels, 3\u{2009}000 drawn")
                .then_some(())
        })?;
    desk.close()
}

#[test]
fn a_typed_path_is_opened() -> Result<()> {
    let program = Program::find()?;
    let planes = scenes::write(program.home(), "planes", &scenes::crossing_planes(60))?;
    let Some(mut desk) = Desk::open(program, &[])? else {
        return Ok(());
    };
    desk.window.settle("the welcome", |state| {
        state.shows("Nothing on the stage yet")
    })?;
    desk.type_path(&planes)?;
    desk.window
        .settle("the planes", |state| state.objects() == ["planes"])?;
    desk.wait_for_picture("opened by path", |picture| coloured(picture) > 5000)?;
    desk.close()
}

#[test]
fn a_file_opened_before_is_opened_from_the_menu() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    let folder = desk.program.home();
    let planes = scenes::write(folder, "planes", &scenes::crossing_planes(60))?;
    desk.window.drop_files(&[&planes], 370, 360)?;
    let state = desk
        .window
        .settle("the planes", |state| state.objects() == ["planes"])?;
    assert_eq!(state.session("recent").as_array().map(Vec::len), Some(2));
    desk.window.click_on("Button", "File")?;
    desk.window.click_on("Button", "Open recent")?;
    let entry = desk.window.wait_for_state("the file's entry", |state| {
        let entries = state.usable(&["Button"]);
        let mut names = entries.into_iter().map(|(name, _)| name);
        names.find(|name| name.starts_with("sphere.ply – "))
    })?;
    desk.window.click_on("Button", &entry)?;
    desk.window
        .settle("the sphere", |state| state.objects() == ["sphere"])?;
    desk.close()
}

#[test]
fn switching_the_renderer_keeps_scene_camera_and_lights() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    desk.turn()?;
    let window = &mut desk.window;
    window.click_on("Tab", "Lighting")?;
    window.click_on("Button", "Add light")?;

    window.click_on("Tab", "Renderer")?;
    let before = window.settle("three lights", |state| {
        let lights = state.session("lights")["lights"].as_array();
        lights.is_some_and(|lights| lights.len() == 3)
            && state.widget("RadioButton", "Surfels").is_some()
    })?;
    let points = desk.wait_for_picture("points", |picture| coloured(picture) > 2000)?;
    let mut last = points.clone();
    for (name, id) in [
        ("Surfels", SURFEL),
        ("Built-in fallback (CPU)", FALLBACK),
        ("Points", POINTS),
    ] {
        desk.window.click_on("RadioButton", name)?;
        let state = desk.window.settle(name, |state| {
            state.session("drawn_by") == id
                && state
                    .widget("RadioButton", name)
                    .is_some_and(|radio| radio.is_on)
        })?;
        assert_eq!(kept(&state), kept(&before), "{name} changed the session");
        last = match id {
            // Disks close the sphere; points leave most of it open.
            SURFEL | FALLBACK => {
                desk.wait_for_picture(name, |picture| coloured(picture) > 40_000)?
            }
            _ => desk.wait_for_picture(name, |picture| same(picture, &points))?,
        };
        assert_eq!(last.dimensions(), points.dimensions());
    }
    assert!(same(&last, &points), "{}", difference(&last, &points));
    desk.close()
}

#[test]
fn a_setting_of_the_chosen_renderer_changes_the_picture() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    let small = desk.wait_for_picture("small points", |picture| coloured(picture) > 2000)?;
    desk.window.drag_slider("Point size", 1.0, |state| {
        let size = state.session("settings")["size"].as_f64();
        size.is_some_and(|size| size > 4.0)
    })?;
    desk.wait_for_picture("large points", |picture| {
        coloured(picture) > 2 * coloured(&small)
    })?;
    desk.window.click_on("Button", "Reset Point size")?;
    desk.window.settle("the default", |state| {
        *state.session("settings") == serde_json::json!({})
    })?;
    desk.wait_for_picture("small points again", |picture| same(picture, &small))?;
    desk.close()
}

#[test]
fn a_dropped_file_takes_the_scene_s_place() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    let folder = desk.program.home();
    let planes = scenes::write(folder, "crossing planes", &scenes::crossing_planes(60))?;
    let before = desk.wait_for_picture("the sphere", |picture| coloured(picture) > 2000)?;
    desk.window.drop_files(&[&planes], 370, 360)?;
    desk.window
        .settle("the planes", |state| state.objects() == ["crossing planes"])?;
    desk.wait_for_picture("the planes", |picture| {
        coloured(picture) > 5000 && !same(picture, &before)
    })?;
    desk.close()
}

#[test]
fn a_dropped_file_of_every_kind_is_opened_and_drawn() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    let home = desk.program.home().to_owned();
    // Each second ball is a coarser one, so that no picture is that of the file before.
    let coarse_home = home.join("coarse");
    std::fs::create_dir_all(&coarse_home)?;
    let fine = mesh_files::write_all(&mesh_files::Mesh::ball(40), &home, "ball")?;
    let coarse = mesh_files::write_all(&mesh_files::Mesh::ball(25), &coarse_home, "ball")?;
    let pairs = fine.into_iter().zip(coarse).enumerate();
    let mut files: Vec<PathBuf> = pairs
        .map(|(index, (fine, coarse))| if index % 2 == 0 { fine } else { coarse })
        .collect();
    let real = [
        "mesh/bunny_zipper_ascii.ply",
        "sfl/bunny_ps3d.sfl",
        "qs/bunny.qs",
        "points/bunnyDouble.e57",
        "points/lone-star.copc.laz",
    ];
    files.extend(real.iter().filter_map(|name| data::shared(name)));
    let pictures = program::target_folder().join("test-output/dropped");
    std::fs::create_dir_all(&pictures)?;
    // What stands there, above the notes, is the model.
    let middle = |picture: &image::RgbaImage| {
        image::imageops::crop_imm(picture, 150, 100, 440, 320).to_image()
    };
    // The ground is darker everywhere.
    let bright = |picture: &image::RgbaImage| {
        let is_bright = |pixel: &&image::Rgba<u8>| pixel.0[..3].iter().any(|value| *value > 110);
        middle(picture).pixels().filter(is_bright).count()
    };
    let mut of_last_file = None;
    for file in files {
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        let stem = file.file_stem().unwrap_or_default().to_string_lossy();
        desk.window.drop_files(&[&file], 370, 360)?;
        desk.window
            .settle(&name, |state| state.objects() == [&*stem])?;
        // The picture before fades for a moment.
        let before = std::cell::RefCell::new(None);
        let picture = desk.wait_for_picture(&name, |picture| {
            let last = before.replace(Some(picture.clone()));
            let is_new = !matches!(&of_last_file, Some(of) if same(&middle(picture), of));
            last.is_some_and(|last| same(picture, &last)) && is_new && bright(picture) > 200
        })?;
        picture.save(pictures.join(format!("{name}.png")))?;
        of_last_file = Some(middle(&picture));
    }
    desk.close()
}

#[test]
fn a_cancelled_load_leaves_the_session_as_it_was() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    let before = desk.wait_for_picture("the sphere", |picture| coloured(picture) > 2000)?;
    let long = long_to_load(desk.program.home())?;
    desk.window.drop_files(&[&long], 370, 360)?;
    desk.window.click_on("Button", "Cancel Load long.ply")?;
    let state = desk
        .window
        .settle("the end of the load", |state| !state.messages().is_empty())?;
    let messages = state.messages();
    assert!(
        messages.len() == 1 && messages[0].ends_with("long.ply: loading cancelled"),
        "{messages:?}"
    );
    assert_eq!(state.objects(), ["sphere"]);
    // The session goes on: it can do what it could before.
    desk.window.click_on("RadioButton", "Surfels")?;
    desk.window
        .settle("surfels", |state| state.session("drawn_by") == SURFEL)?;
    desk.window.click_on("RadioButton", "Points")?;
    desk.window.click_on("Button", "Dismiss")?;
    desk.wait_for_picture("the sphere again", |picture| same(picture, &before))?;
    desk.close()
}

/// A file of almost two million points without normals: few megabytes, and long to estimate normals for.
fn long_to_load(folder: &Path) -> Result<PathBuf> {
    const COUNT: u32 = 1_900_000;
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {COUNT}\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
    )
    .into_bytes();
    // A linear congruential generator (Knuth's constants): points in no order, everywhere in a cube.
    let mut random = 1_u64;
    for _ in 0..3 * COUNT {
        random = random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let unit = (random >> 40) as f32 / (1_u32 << 24) as f32;
        bytes.extend(unit.to_le_bytes());
    }
    let path = folder.join("long.ply");
    std::fs::write(&path, bytes).with_context(|| format!("writing {}", path.display()))?;
    Ok(path)
}

#[test]
fn a_bad_file_says_what_is_wrong_over_the_picture() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    let sphere = std::fs::read(desk.program.home().join("sphere.ply"))?;
    let short = desk.program.home().join("short.ply");
    std::fs::write(&short, &sphere[..sphere.len() / 2])?;
    desk.type_path(&short)?;
    let state = desk.window.settle("the message", |state| {
        state.shows("short.ply, byte") && state.shows("Log: 1 error")
    })?;
    assert_eq!(state.objects(), ["sphere"], "the scene stays");
    desk.window.click_on("Button", "Dismiss")?;
    desk.window.settle("the message to go", |state| {
        !state.shows("short.ply, byte") && state.shows("Log: 1 error")
    })?;
    desk.window.click_on("Button", "Log: 1 error")?;
    desk.window
        .settle("the log", |state| state.shows("short.ply, byte"))?;
    desk.close()
}

#[test]
fn a_lost_device_comes_back_with_everything_as_it_was() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    desk.turn()?;
    desk.window.click_on("CheckBox", "Hide backs")?;
    let before = desk
        .window
        .settle("a setting that is no default", |state| {
            state.session("settings")["cull_backs"] == true
        })?;
    let picture = desk.wait_for_picture("before", |picture| coloured(picture) > 1000)?;
    desk.window.click_on("Button", "Help")?;
    desk.window.click_on("Button", "For plugin authors")?;
    desk.window.click_on("Button", "Lose the graphics device")?;
    let after = desk.window.settle("the loss", |state| {
        let messages = state.messages();
        messages.iter().any(|text| text.contains("was lost"))
    })?;
    for key in [
        "objects", "view", "lights", "renderer", "settings", "drawn_by",
    ] {
        assert_eq!(after.session(key), before.session(key), "{key}");
    }
    desk.window.click_on("Button", "Dismiss")?;
    desk.wait_for_picture("after", |shown| same(shown, &picture))?;
    desk.close()
}

#[test]
fn without_a_device_the_built_in_renderer_draws_and_the_panel_says_why() -> Result<()> {
    let program = Program::find()?;
    let sphere = sphere(program.home())?;
    let arguments = ["--adapter", "no such adapter"].map(AsRef::as_ref);
    let arguments = [arguments.as_slice(), &[sphere.as_os_str()]].concat();
    let Some(mut desk) = Desk::open(program, &arguments)? else {
        return Ok(());
    };
    let state = desk.window.settle("the sphere", |state| {
        state.objects() == ["sphere"] && state.session("drawn_by") == FALLBACK
    })?;
    let messages = state.messages();
    assert!(
        messages
            .iter()
            .any(|text| text.contains("no graphics adapter 'no such adapter'")),
        "{messages:?}"
    );
    let points = state.widget("RadioButton", "Points").context("a row")?;
    assert!(!points.is_enabled && state.shows("it needs a graphics device"));
    desk.wait_for_picture("drawn on the CPU", |picture| coloured(picture) > 40_000)?;
    desk.close()
}

#[test]
#[cfg(target_os = "linux")]
fn a_plugin_that_crashes_when_it_is_loaded_is_named_and_the_rest_works() -> Result<()> {
    let program = Program::find()?;
    let sphere = sphere(program.home())?;
    let plugin = pointstage_tests::plugins::on_load("segfault", program.home())?;
    let arguments = ["--plugin".as_ref(), plugin.as_os_str(), sphere.as_os_str()];
    let Some(mut desk) = Desk::open(program, &arguments)? else {
        return Ok(());
    };
    desk.window.settle("the sphere and the message", |state| {
        state.session("drawn_by") == POINTS && state.shows("quarantined (crash)")
    })?;
    desk.window.click_on("Tab", "Plugins")?;
    desk.window.find("Button", "Try again")?;
    desk.close()
}

#[test]
fn where_no_window_can_open_the_program_says_what_to_install() -> Result<()> {
    let Some(display) = Display::start(320, 240)? else {
        return Ok(());
    };
    let program = Program::find()?;
    let mut command = program.command();
    command.env("DISPLAY", display.name());
    for name in [
        "VK_DRIVER_FILES",
        "VK_ICD_FILENAMES",
        "__EGL_VENDOR_LIBRARY_FILENAMES",
    ] {
        command.env(name, "/nowhere");
    }
    let finished = program::finish(command, program::TIME_LIMIT)?;
    assert_eq!(finished.code(), Some(1), "{}", finished.stderr);
    let said = finished.stderr.trim();
    assert!(
        said.starts_with("error: no window can be opened")
            && said.contains("apt install mesa-vulkan-drivers")
            && said.lines().count() == 1,
        "{said}"
    );
    Ok(())
}
