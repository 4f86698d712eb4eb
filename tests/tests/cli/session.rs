//! `render --session`: a session file draws what it says, from any folder, and says what is wrong with it.

use anyhow::Result;
use image::RgbaImage;
use pointstage_tests::compare;
use pointstage_tests::program::Finished;

use super::Shell;

/// A view of the small sphere, as session files and view files hold it.
pub(super) const VIEW: &str = "format = 1\neye = [1.5, 1.0, 2.5]\npivot = [0.0, 0.0, 0.0]\nup = [0.0, 1.0, 0.0]\nnear = 0.01\nfar = 100.0\nwidth = 96\nheight = 64\nprojection = { kind = \"perspective\", fov_y_rad = 0.7 }\n";

/// The same as JSON.
const VIEW_JSON: &str = r#"{"format": 1, "eye": [1.5, 1.0, 2.5], "pivot": [0, 0, 0], "up": [0, 1, 0], "near": 0.01,
    "far": 100, "width": 96, "height": 64, "projection": {"kind": "perspective", "fov_y_rad": 0.7}}"#;

/// A session beside the shell's scene.
pub(super) fn session(scene: &str) -> String {
    format!(
        "format = 1\n[look]\nbackground = {{ solid = [1.0, 0.0, 0.0] }}\nexposure = 1.5\n[renderers]\nmain = \"pointstage.fallback\"\n[view]\n{VIEW}{scene}\n[[views]]\nnumber = 3\nname = \"close\"\n[views.view]\n{}",
        VIEW.replace("2.5]", "1.5]")
    )
}

pub(super) const SPHERE: &str = "[[scene]]\nfile = \"../sphere.ply\"\n";

impl Shell {
    /// A session in a folder beside the scene.
    fn with_session(scene: &str) -> Result<Self> {
        let shell = Self::new()?;
        std::fs::create_dir(shell.folder().join("sessions"))?;
        std::fs::write(
            shell.folder().join("sessions/a.pointstage.toml"),
            session(scene),
        )?;
        std::fs::write(shell.folder().join("view.json"), VIEW_JSON)?;
        Ok(shell)
    }

    fn draw(&self, options: &str) -> Result<(RgbaImage, Finished)> {
        let line = format!("render {options} --no-device --out picture.png");
        let finished = self.run(&line)?;
        assert_eq!(finished.code(), Some(0), "{line}\n{}", finished.stderr);
        let picture = compare::read(&self.folder().join("picture.png"))?;
        Ok((picture, finished))
    }
}

#[test]
fn a_session_draws_what_the_same_options_draw() -> Result<()> {
    let shell = Shell::with_session(SPHERE)?;
    let options = "sphere.ply --renderer fallback --background #ff0000 --exposure 1.5";
    let (expected, _) = shell.draw(&format!("{options} --view view.json"))?;
    let from_session = "--session sessions/a.pointstage.toml";
    let (drawn, _) = shell.draw(from_session)?;
    assert!(drawn == expected, "the session's picture differs");
    // The picture carries all of that, and is a session itself.
    std::fs::copy(
        shell.folder().join("picture.png"),
        shell.folder().join("first.png"),
    )?;
    let (again, _) = shell.draw("--session first.png")?;
    assert!(again == expected, "the picture's own session differs");

    // Options come first, whatever the session says.
    let (wide, _) = shell.draw(&format!("{from_session} --size 80x20 --exposure 1"))?;
    assert_eq!(wide.dimensions(), (80, 20));
    let (blue, _) = shell.draw(&format!("{from_session} --background #0000ff"))?;
    assert_eq!(blue.get_pixel(0, 0).0, [0, 0, 255, 255]);
    let (close, _) = shell.draw(&format!("{from_session} --view close"))?;
    let (third, _) = shell.draw(&format!("{from_session} --view 3"))?;
    assert!(close == third && close != expected, "a stored view");
    shell.assert_fails(
        2,
        &format!("render {from_session} --view clsoe --no-device --out b.png"),
        &["no view is stored under 'clsoe'", "(3, close)"],
    )
}

#[test]
fn selected_surfels_are_tinted_where_that_is_asked_for() -> Result<()> {
    let shell = Shell::with_session(&format!("{SPHERE}selected_surfels = \"0 100\"\n"))?;
    let session = "--session sessions/a.pointstage.toml";
    let (clean, _) = shell.draw(session)?;
    let plain = Shell::with_session(SPHERE)?;
    let (expected, _) = plain.draw(session)?;
    assert!(clean == expected, "pictures are without the tint");
    let (tinted, _) = shell.draw(&format!("{session} --show-selection"))?;
    let pixels = tinted.pixels().zip(clean.pixels());
    let changed = pixels.filter(|(tinted, clean)| tinted != clean).count();
    assert!(changed > 20, "{changed} pixels are tinted");
    // The picture is made of what it shows.
    std::fs::copy(
        shell.folder().join("picture.png"),
        shell.folder().join("tinted.png"),
    )?;
    let (again, _) = shell.draw("--session tinted.png --show-selection")?;
    assert!(again == tinted, "the picture's own session differs");

    let wrong = Shell::with_session(&format!("{SPHERE}selected_surfels = \"0 x\"\n"))?;
    wrong.assert_fails(
        1,
        &format!("render {session} --no-device --out b.png"),
        &["lengths of runs", "found 'x'"],
    )
}

#[test]
fn scene_files_are_found_beside_the_session_wherever_the_shell_stands() -> Result<()> {
    let shell = Shell::with_session(SPHERE)?;
    let (expected, _) = shell.draw("--session sessions/a.pointstage.toml")?;
    let elsewhere = tempfile::tempdir()?;
    let moved = elsewhere.path().join("moved");
    std::fs::create_dir_all(moved.join("sessions"))?;
    for file in ["sphere.ply", "sessions/a.pointstage.toml"] {
        std::fs::copy(shell.folder().join(file), moved.join(file))?;
    }
    let path = moved.join("sessions/a.pointstage.toml");
    let (drawn, _) = shell.draw(&format!("--session {}", path.display()))?;
    assert!(drawn == expected, "the moved session's picture differs");
    Ok(())
}

#[test]
fn a_session_without_its_files_or_with_a_flaw_says_where() -> Result<()> {
    let missing = "[[scene]]\nfile = \"none.ply\"\n[[scene]]\nfile = \"/no/other.ply\"\n";
    let shell = Shell::with_session(missing)?;
    let line = "render --no-device --out b.png --session";
    let at = |name: &str| format!("{line} {name}");
    shell.assert_fails(
        1,
        &at("sessions/a.pointstage.toml"),
        &[
            "2 scene files are not there",
            "sessions/none.ply, /no/other.ply",
        ],
    )?;
    // Files of the command line take the place of the session's.
    shell.draw("sphere.ply --session sessions/a.pointstage.toml")?;

    for (from, to, expected) in [
        (
            "exposure = 1.5",
            "exposure = 0",
            "a.pointstage.toml, line 4, column 12: expected a number above 0, found 0",
        ),
        (
            "format = 1",
            "format = 3",
            "format 3, this program reads format 1",
        ),
        ("[look]", "[look", "line 2"),
    ] {
        let flawed = session(SPHERE).replacen(from, to, 1);
        std::fs::write(shell.folder().join("a.pointstage.toml"), flawed)?;
        shell.assert_fails(1, &at("a.pointstage.toml"), &[expected])?;
    }
    shell.assert_fails(
        1,
        &at("none.toml"),
        &["none.toml: the session cannot be read"],
    )?;
    shell.assert_fails(2, "render --no-device --out b.png", &["<FILE>"])?;
    assert!(!shell.folder().join("b.png").exists());
    Ok(())
}

#[test]
fn a_renderer_of_the_session_that_is_not_there_is_a_warning() -> Result<()> {
    let shell = Shell::with_session(SPHERE)?;
    let gone = session(SPHERE).replace("pointstage.fallback", "org.example.gone");
    std::fs::write(
        shell.folder().join("a.pointstage.toml"),
        gone.replace("../", ""),
    )?;
    let (_, finished) = shell.draw("--session a.pointstage.toml")?;
    assert!(
        finished
            .stderr
            .contains("a.pointstage.toml: no renderer 'org.example.gone'")
            && finished.stderr.contains("--renderer chooses one"),
        "{}",
        finished.stderr
    );
    Ok(())
}

/// The parts of the picture that are not background.
fn drawn(picture: &RgbaImage) -> usize {
    let pixels = picture.pixels();
    pixels.filter(|pixel| pixel.0 != [255, 0, 0, 255]).count()
}

#[test]
fn objects_of_a_session_have_places_materials_and_radius_scales_of_their_own() -> Result<()> {
    // Two spheres beside each other.
    let beside = |x: &str, more: &str| {
        format!(
            "[[scene]]\nfile = \"../sphere.ply\"\ntransform = [0.3, 0.0, 0.0, 0.0, 0.3, 0.0, 0.0, 0.0, 0.3, {x}, 0.0, 0.0]\n{more}\n"
        )
    };
    let two = |more: &str| beside("-0.6", "") + &beside("0.6", more);
    let shell = Shell::with_session(&two(""))?;
    let path = shell.folder().join("sessions/a.pointstage.toml");
    let draw = |scene: &str| -> Result<RgbaImage> {
        std::fs::write(&path, session(scene))?;
        Ok(shell.draw("--session sessions/a.pointstage.toml")?.0)
    };
    let plain = draw(&two(""))?;
    let left = draw(&beside("-0.6", ""))?;
    let right = draw(&beside("0.6", ""))?;
    assert!(drawn(&left) > 20 && drawn(&right) > 20);
    assert_eq!(drawn(&plain), drawn(&left) + drawn(&right));
    let hidden = draw(&two("visible = false"))?;
    assert!(hidden == left, "a hidden object is drawn");

    // What is said of the second object changes it alone.
    let differing = |other: &RgbaImage| {
        let pairs = plain.enumerate_pixels().zip(other.pixels());
        let differing = pairs.filter(|((_, _, a), b)| a != b);
        let places: Vec<(u32, u32)> = differing.map(|((x, y, _), _)| (x, y)).collect();
        let on_left = |(x, y): &(u32, u32)| left.get_pixel(*x, *y).0 != [255, 0, 0, 255];
        let of_left = places.iter().filter(|at| on_left(at)).count();
        (of_left, places.len())
    };
    let dark = draw(&two(
        "material = { ka = 0.0, kd = 0.0, ks = 0.0, shininess = 1.0 }",
    ))?;
    let (of_left, all) = differing(&dark);
    assert!(of_left == 0 && all > 20, "{of_left} of {all}");
    assert_eq!(drawn(&dark), drawn(&plain));
    let large = draw(&two("radius_scale = 3.0"))?;
    assert!(
        drawn(&large) > drawn(&plain) + 10,
        "larger surfels cover more"
    );
    let small = draw(&two("radius_scale = 0.05"))?;
    assert!(drawn(&small) < drawn(&plain), "smaller ones cover less");
    assert_eq!(differing(&small).0, 0, "the other object has changed");
    Ok(())
}
