//! `render --path`: the pictures of a film, from the command line to the files.

use std::path::Path;

use anyhow::Result;
use image::RgbaImage;
use pointstage_tests::compare;
use pointstage_tests::data::skip;

use super::Shell;
use super::session::{SPHERE, VIEW, session};

/// Draws small pictures of the sphere.
const DRAW: &str = "render sphere.ply --no-device --size 96x64";

/// What grows from its first picture to its last.
const GROWS: &str = "format = 1\nfps = 2\n[[tracks]]\nsetting = \"size\"\nkeys = [\n  { time = 0, value = 1.0 },\n  { time = 2, value = 9.0 },\n]\n";

impl Shell {
    fn succeed(&self, line: &str) -> Result<()> {
        let finished = self.run(line)?;
        assert_eq!(finished.code(), Some(0), "{line}\n{}", finished.stderr);
        Ok(())
    }

    fn picture(&self, name: &str) -> Result<RgbaImage> {
        compare::read(&self.folder().join(name))
    }

    fn write(&self, name: &str, text: &str) -> Result<()> {
        Ok(std::fs::write(self.folder().join(name), text)?)
    }
}

fn names(folder: &Path) -> Result<Vec<String>> {
    let entries = std::fs::read_dir(folder)?;
    let mut names: Vec<String> = entries
        .map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned()))
        .collect::<Result<_>>()?;
    names.sort();
    Ok(names)
}

#[test]
fn a_turntable_has_a_picture_every_fps_th_of_a_second_and_begins_as_the_plain_picture() -> Result<()>
{
    let shell = Shell::new()?;
    let draw = format!("{DRAW} --renderer fallback");
    shell.succeed(&format!("{draw} --out plain.png"))?;
    shell.succeed(&format!(
        "{draw} --path turntable:1 --fps 5 --out frames/turn_%04d.png"
    ))?;
    let found = names(&shell.folder().join("frames"))?;
    let expected: Vec<String> = (0..5).map(|index| format!("turn_{index:04}.png")).collect();
    assert_eq!(
        found, expected,
        "a whole turn does not show its start twice"
    );
    let pictures = expected
        .iter()
        .map(|name| shell.picture(&format!("frames/{name}")))
        .collect::<Result<Vec<_>>>()?;
    assert!(
        pictures[0] == shell.picture("plain.png")?,
        "the first one differs"
    );
    for (index, picture) in pictures.iter().enumerate().skip(1) {
        assert!(*picture != pictures[0], "picture {index} is the first one");
    }
    // The same line gives the same files.
    shell.succeed(&format!(
        "{draw} --path turntable:1:360 --fps 5 --out again.png"
    ))?;
    assert!(shell.picture("again_003.png")? == pictures[3]);
    // Each picture is a session that draws itself.
    shell.succeed("render --session frames/turn_0003.png --no-device --out self.png")?;
    assert!(shell.picture("self.png")? == pictures[3]);
    // Half a turn shows where it ends.
    shell.succeed(&format!(
        "{draw} --path turntable:1:180 --fps 2 --out half.png"
    ))?;
    assert!(shell.folder().join("half_002.png").exists());
    assert!(!shell.folder().join("half_003.png").exists());
    shell.succeed(&format!("{draw} --path orbit:3 --out orbit.png"))?;
    assert!(shell.picture("orbit_000.png")? == pictures[0]);
    assert!(shell.folder().join("orbit_002.png").exists());
    Ok(())
}

#[test]
fn views_of_a_path_are_met_at_their_times() -> Result<()> {
    let shell = Shell::new()?;
    let draw = format!("{DRAW} --renderer fallback");
    let near = VIEW.replace("2.5]", "1.5]");
    let path = format!(
        "format = 1\n[[keys]]\ntime = 0\nname = \"far\"\n[keys.view]\n{VIEW}[[keys]]\ntime = 1\n[keys.view]\n{near}"
    );
    shell.write("path.toml", &path)?;
    shell.succeed(&format!("{draw} --path path.toml --fps 2 --out film.png"))?;
    assert!(!shell.folder().join("film_003.png").exists());
    for (view, picture) in [(VIEW, "film_000.png"), (near.as_str(), "film_002.png")] {
        // A session is the shortest way to write a view down.
        let text = format!("format = 1\n[view]\n{view}");
        shell.write("a.pointstage.toml", &text)?;
        shell.succeed(&format!(
            "{draw} --session a.pointstage.toml --out view.png"
        ))?;
        assert!(
            shell.picture("view.png")? == shell.picture(picture)?,
            "{picture}"
        );
    }
    Ok(())
}

#[test]
fn a_track_changes_a_setting_from_picture_to_picture() -> Result<()> {
    let shell = Shell::new()?;
    shell.write("grow.toml", GROWS)?;
    let draw = "render sphere.ply --size 96x64 --renderer points --set size_mode=fixed";
    let finished = shell.run(&format!("{draw} --path grow.toml --out grow.png"))?;
    for reason in ["no renderer", "needs a graphics device"] {
        if finished.stderr.contains(reason) {
            skip("the renderer points was not built, or there is no device for it");
            return Ok(());
        }
    }
    assert_eq!(finished.code(), Some(0), "{}", finished.stderr);
    assert!(
        !shell.folder().join("grow_005.png").exists(),
        "two seconds, two a second, and the end"
    );
    for (size, picture) in [
        (1, "grow_000.png"),
        (3, "grow_001.png"),
        (9, "grow_004.png"),
    ] {
        shell.succeed(&format!("{draw} --set size={size} --out plain.png"))?;
        assert!(
            shell.picture("plain.png")? == shell.picture(picture)?,
            "{picture}"
        );
    }
    assert!(shell.picture("grow_000.png")? != shell.picture("grow_004.png")?);

    let line = format!("{draw} --path grow.toml --out no.png");
    for (from, to, parts) in [
        (
            "9.0",
            "900.0",
            [
                "grow.toml, line 7: track 1 ('size'), value 2",
                "900 is outside 1 … 255 px",
            ],
        ),
        (
            "\"size\"",
            "\"siez\"",
            [
                "grow.toml, line 4: track 1 ('siez')",
                "did you mean 'size'?",
            ],
        ),
        (
            "fps = 2",
            "fps = -2",
            ["grow.toml, line 2", "expected pictures a second"],
        ),
        (
            "time = 2",
            "time = 0",
            ["grow.toml, line", "expected times that rise"],
        ),
    ] {
        shell.write("grow.toml", &GROWS.replacen(from, to, 1))?;
        shell.assert_fails(1, &line, &parts)?;
    }
    // What does not draw changes nothing, and that is said.
    let of_another = GROWS.replacen("setting", "owner = \"surfel\"\nsetting", 1);
    shell.write("grow.toml", &of_another)?;
    let finished = shell.run(&format!(
        "{draw} --set size=1 --path grow.toml --out other.png"
    ))?;
    assert!(
        finished
            .stderr
            .contains("grow.toml: 'surfel' does not draw"),
        "{}",
        finished.stderr
    );
    assert!(shell.picture("other_003.png")? == shell.picture("grow_000.png")?);
    Ok(())
}

#[test]
fn a_session_s_path_is_drawn_by_its_name_or_as_a_file() -> Result<()> {
    let shell = Shell::new()?;
    let plain = session(&SPHERE.replace("../", ""));
    shell.write("plain.pointstage.toml", &plain)?;
    let text = format!("{plain}[path]\nformat = 1\nfps = 4\n[path.turntable]\nseconds = 1\n");
    shell.write("a.pointstage.toml", &text)?;
    let line = "render --session a.pointstage.toml --no-device";
    shell.succeed(&format!("{line} --out still.png"))?;
    shell.succeed(&format!("{line} --path session --out film_%d.png"))?;
    assert!(shell.picture("film_0.png")? == shell.picture("still.png")?);
    assert!(shell.picture("film_1.png")? != shell.picture("still.png")?);
    assert!(!shell.folder().join("film_4.png").exists());
    shell.succeed("render --session plain.pointstage.toml --path a.pointstage.toml --no-device --out file_%d.png")?;
    assert!(shell.picture("file_1.png")? == shell.picture("film_1.png")?);
    shell.assert_fails(
        1,
        "render --session plain.pointstage.toml --path session --no-device --out b.png",
        &["plain.pointstage.toml: the session has no path"],
    )
}

#[test]
fn what_is_no_path_says_what_is_expected() -> Result<()> {
    let shell = Shell::new()?;
    for (code, options, part) in [
        (2, "--path turntable", "such as turntable:4"),
        (2, "--path turntable:0", "seconds above 0"),
        (2, "--path orbit:0", "expected orbit:N"),
        (2, "--path orbit", "the number of pictures too"),
        (2, "--path session", "--path session needs --session"),
        (2, "--fps 30", "--path"),
        (
            2,
            "--path turntable:1 --fps 0",
            "expected a number from 0.01 to 1000",
        ),
        (
            2,
            "--path turntable:86400 --fps 1000",
            "at most 1000000 pictures",
        ),
        (
            2,
            "--path turntable:1 --view orbit:3",
            "a path begins with one",
        ),
        (1, "--path none.toml", "none.toml: the path cannot be read"),
        (1, "--path sphere.ply", "sphere.ply"),
    ] {
        let line = format!("{DRAW} --renderer fallback {options} --out frames/a.png");
        shell.assert_fails(code, &line, &[part])?;
    }
    assert!(!shell.folder().join("frames").exists(), "nothing was made");
    Ok(())
}
