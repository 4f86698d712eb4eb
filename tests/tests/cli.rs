//! The command line as a script meets it: exit codes, messages on standard error, results on standard output.

#[path = "cli/bench.rs"]
mod bench;
#[path = "cli/compare.rs"]
mod compare_command;
#[path = "cli/page.rs"]
mod page;
#[path = "cli/paths.rs"]
mod paths;
#[path = "cli/session.rs"]
mod session;

use std::path::Path;

use anyhow::{Context as _, Result, ensure};
use pointstage_tests::compare;
use pointstage_tests::data::{sample, skip};
use pointstage_tests::program::{Finished, Program};
use pointstage_tests::{plugins, scenes};

/// The program in a folder with a small scene, run there without a graphics device.
struct Shell {
    program: Program,
}

impl Shell {
    fn new() -> Result<Self> {
        let program = Program::find()?;
        scenes::write(program.home(), "sphere", &scenes::sphere(500, 1.0))?;
        Ok(Self { program })
    }

    fn folder(&self) -> &Path {
        self.program.home()
    }

    /// Runs a line whose words stand apart by blanks.
    fn run(&self, line: &str) -> Result<Finished> {
        let mut command = self.program.command();
        command.current_dir(self.folder()).args(line.split(' '));
        pointstage_tests::program::finish(command, pointstage_tests::program::TIME_LIMIT)
    }

    /// Asserts that `line` ends with `code`, nothing on standard output, and all of `parts` on standard error.
    fn assert_fails(&self, code: i32, line: &str, parts: &[&str]) -> Result<()> {
        let Finished {
            status,
            stdout,
            stderr,
        } = self.run(line)?;
        assert_eq!(status.code(), Some(code), "{line}\n{stderr}");
        assert_eq!(stdout, "", "{line}: errors go to standard error");
        assert!(stderr.contains("error: "), "{line}\n{stderr}");
        assert!(!stderr.contains("panicked"), "{line}\n{stderr}");
        for part in parts {
            assert!(stderr.contains(part), "{line}: no '{part}' in\n{stderr}");
        }
        Ok(())
    }
}

#[test]
fn what_render_cannot_understand_is_a_usage_error_that_names_the_nearest() -> Result<()> {
    let shell = Shell::new()?;
    let cases: [(&str, &[&str]); 22] = [
        (
            "--renderer surfle",
            &["no renderer 'surfle'; did you mean 'surfel'?"],
        ),
        (
            "--renderer points --set siez=3",
            &["no setting 'siez'; did you mean 'size'?"],
        ),
        (
            "--renderer points --set size=big",
            &["setting 'size': expected a number", "found 'big'"],
        ),
        (
            "--renderer points --set size=1e9",
            &["outside 1 … 255 px", "nearest is 255"],
        ),
        (
            "--renderer points --set shape=rund",
            &["'shape' has no option 'rund'; did you mean 'round'?"],
        ),
        ("--renderer points --set size", &["expected id=value"]),
        ("--set size=3", &["--set needs --renderer"]),
        (
            "--renderer points --aov dpeth=d.exr",
            &["no target 'dpeth'; did you mean 'depth'?"],
        ),
        (
            "--aov dpeth=d.exr",
            &["no target 'dpeth'; did you mean 'depth'?"],
        ),
        (
            "--renderer fallback --aov dpeth=d.exr",
            &["no target 'dpeth'; did you mean 'depth'?"],
        ),
        ("--aov depth=d.tif", &["must end in .exr"]),
        (
            "--show nromal",
            &["no target 'nromal'; did you mean 'normal'?"],
        ),
        ("--aov depth=picture.png", &["'picture.png' is named twice"]),
        ("--structure octree", &["no structure 'octree'"]),
        ("--set-structure a=1", &["--structure"]),
        ("--size 0x5", &["each side must be from 1 to 65536"]),
        ("--size 800", &["expected WIDTHxHEIGHT"]),
        ("--view orbit:0", &["expected orbit:N"]),
        (
            "--view obrit",
            &["no view is stored under 'obrit'", "orbit:N"],
        ),
        ("--background red", &["#rrggbb"]),
        ("--exposure 0", &["expected a number above 0"]),
        ("--backend vulkn", &["similar value exists: 'vulkan'"]),
    ];
    for (options, parts) in cases {
        let device = if options.contains("--backend") {
            ""
        } else {
            " --no-device"
        };
        let line = format!("render sphere.ply --out picture.png{device} {options}");
        shell.assert_fails(2, &line, parts)?;
    }
    assert!(!shell.folder().join("picture.png").exists());
    Ok(())
}

#[test]
fn what_cannot_be_read_or_written_is_a_failure_that_names_the_file() -> Result<()> {
    let shell = Shell::new()?;
    std::fs::write(shell.folder().join("view.json"), "{\"format\": 1}")?;
    std::fs::write(shell.folder().join("notes.ply"), "no scene")?;
    let cases: [(&str, &[&str]); 9] = [
        (
            "render none.ply --out a.png",
            &["none.ply: cannot be read", "check the path"],
        ),
        (
            "render notes.ply --out a.png",
            &["notes.ply: ", "which no loader knows", "convert the file"],
        ),
        (
            "render sphere.ply --out none/a.png",
            &["none/a.png: cannot be written"],
        ),
        (
            "render sphere.ply --out a.png --stats none/a.json",
            &["none/a.json: cannot be written"],
        ),
        (
            "render sphere.ply --out a.png --view veiw.json",
            &["veiw.json", "did you mean 'view.json'?"],
        ),
        (
            "render sphere.ply --out a.png --view view.json",
            &["view.json: line 1, column", "`eye`"],
        ),
        (
            "render sphere.ply --out a.png --renderer points",
            &["needs a graphics device"],
        ),
        ("info none.ply", &["none.ply: cannot be read"]),
        ("info .", &["it is a folder"]),
    ];
    for (line, parts) in cases {
        shell.assert_fails(1, &format!("{line} --no-device"), parts)?;
    }
    Ok(())
}

#[test]
fn images_beyond_the_limit_of_one_picture_are_drawn_in_tiles() -> Result<()> {
    let shell = Shell::new()?;
    let line = "render sphere.ply --no-device --renderer fallback --size 17000x90 --out wide.png --json \
                --aov depth=depth.png";
    let Finished {
        status,
        stdout,
        stderr,
    } = shell.run(line)?;
    assert!(status.success(), "{stderr}");
    let written: serde_json::Value = serde_json::from_str(&stdout)?;
    assert_eq!(written[0]["size"], serde_json::json!([17_000, 90]));
    assert_eq!(written[0]["tiles"], 5);
    for name in ["wide.png", "depth.png"] {
        let image = image::open(shell.folder().join(name))?;
        assert_eq!((image.width(), image.height()), (17_000, 90), "{name}");
    }
    Ok(())
}

#[test]
fn an_exr_picture_has_every_target_as_a_layer_unless_memory_forbids() -> Result<()> {
    let shell = Shell::new()?;
    let line = "render sphere.ply --no-device --renderer fallback --size 64x48 --out all.exr";
    let Finished { status, stderr, .. } = shell.run(line)?;
    assert!(status.success(), "{stderr}");
    let file = exr::meta::MetaData::read_from_file(shell.folder().join("all.exr"), true)?;
    let names = file.headers.iter().filter_map(|header| {
        let name = header.own_attributes.layer_name.as_ref()?;
        Some(name.to_string())
    });
    let mut names: Vec<String> = names.collect();
    names.sort();
    assert_eq!(names, ["colour", "depth", "id", "kind", "lod", "normal"]);
    let huge =
        "render sphere.ply --no-device --renderer fallback --size 60000x60000 --out huge.exr";
    shell.assert_fails(1, huge, &["6 layers needs", "at most 4.0 GB", "save PNG"])?;
    assert!(!shell.folder().join("huge.exr").exists());
    Ok(())
}

#[test]
fn what_no_command_understands_is_a_usage_error() -> Result<()> {
    let shell = Shell::new()?;
    let cases: [(&str, &[&str]); 7] = [
        ("rendre sphere.ply", &["did you mean 'render'?"]),
        ("sphere.ply render", &["'render' stands behind a file"]),
        ("info", &["<FILE>"]),
        ("info --josn sphere.ply", &["'--json'"]),
        ("render sphere.ply", &["--out"]),
        ("plugins lits", &["'list'"]),
        (
            "info --no-device --backend vulkan sphere.ply",
            &["cannot be used with"],
        ),
    ];
    for (line, parts) in cases {
        shell.assert_fails(2, line, parts)?;
    }
    Ok(())
}

#[test]
fn help_names_every_command_and_option_and_is_no_error() -> Result<()> {
    let shell = Shell::new()?;
    let cases: [(&str, &[&str]); 8] = [
        (
            "--help",
            &[
                "render",
                "compare",
                "bench",
                "sweep",
                "info",
                "plugins",
                "--backend",
                "--no-device",
                "Exit codes",
                "Examples",
            ],
        ),
        (
            "render --help",
            &[
                "--renderer",
                "--view",
                "--set",
                "--aov",
                "--stats",
                "--session",
                "--out",
                "Examples",
            ],
        ),
        (
            "compare --help",
            &["--renderers", "--reference", "--views", "Examples"],
        ),
        (
            "bench --help",
            &["--renderers", "--path", "--fail-above", "Examples"],
        ),
        ("sweep --help", &["--set-range", "--reference", "Examples"]),
        ("info --help", &["--json", "Examples"]),
        (
            "plugins --help",
            &["list", "probe", "POINTSTAGE_PLUGIN_PATH"],
        ),
        ("--version", &["pointstage "]),
    ];
    for (line, parts) in cases {
        let finished = shell.run(line)?;
        assert_eq!(finished.code(), Some(0), "{line}\n{}", finished.stderr);
        for part in parts {
            assert!(finished.stdout.contains(part), "{line}: no '{part}'");
        }
    }
    Ok(())
}

#[test]
#[cfg(target_os = "linux")]
fn a_plugin_that_crashes_when_it_is_loaded_crashes_a_child_alone() -> Result<()> {
    let shell = Shell::new()?;
    let file = plugins::on_load("segfault", shell.folder())?;
    let file = file.display();

    let probe = shell.run(&format!("plugins probe {file}"))?;
    assert_eq!(probe.code(), Some(1), "{}", probe.stderr);
    assert!(
        probe.stdout.contains("quarantined (crash)") && probe.stdout.contains("SIGSEGV"),
        "{}",
        probe.stdout
    );
    assert!(
        probe.stderr.contains("0 of 1 plugin files can be used"),
        "{}",
        probe.stderr
    );

    // The picture is drawn without it, and its absence is said.
    let render = shell.run(&format!(
        "render sphere.ply --no-device --size 64x48 --out picture.png --plugin {file}"
    ))?;
    assert_eq!(render.code(), Some(0), "{}", render.stderr);
    assert!(
        render.stderr.contains("quarantined (crash)") && render.stderr.contains("SIGSEGV"),
        "{}",
        render.stderr
    );
    let picture = compare::read(&shell.folder().join("picture.png"))?;
    assert_eq!(picture.dimensions(), (64, 48));

    // Asked for by name, it is an error that says why.
    let line =
        format!("render sphere.ply --no-device --renderer onload --out b.png --plugin {file}");
    shell.assert_fails(2, &line, &["SIGSEGV"])
}

#[test]
fn every_renderer_draws_the_same_over_opengl_as_over_vulkan() -> Result<()> {
    let shell = Shell::new()?;
    let scene = sample("knotted_snake.ply");
    for renderer in ["points", "surfel"] {
        let draw = |backend: &str| -> Result<Option<_>> {
            let out = format!("{renderer}_{backend}.png");
            let line = format!(
                "render {} --renderer {renderer} --backend {backend} --size 400x300 --out {out}",
                scene.display()
            );
            let finished = shell.run(&line)?;
            if finished.stderr.contains("no graphics adapter found") {
                return Ok(None);
            }
            ensure!(finished.code() == Some(0), "{line}\n{}", finished.stderr);
            compare::read(&shell.folder().join(out)).map(Some)
        };
        let (Some(vulkan), Some(gl)) = (draw("vulkan")?, draw("gl")?) else {
            skip("no driver for both Vulkan and OpenGL");
            return Ok(());
        };
        // Rounding differs: 69 dB were seen with Mesa's software drivers.
        let difference = compare::compare(&gl, &vulkan).context("equal sizes")?;
        assert!(difference.psnr_db > 45.0, "{renderer}: {difference}");
    }
    Ok(())
}
