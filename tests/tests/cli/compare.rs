//! `compare`: measures what it is asked to measure, writes all of it, and never compares what was not drawn as asked.

use std::collections::BTreeSet;

use anyhow::{Context as _, Result};
use pointstage_tests::data::{sample, skip};
use pointstage_tests::{compare, plugins};
use serde_json::{Value, json};

use super::Shell;

impl Shell {
    /// Runs a comparison that is written to `apart`; what `metrics.json` says.
    fn compare(&self, options: &str) -> Result<Value> {
        let line = format!("compare {options} --out apart");
        let finished = self.run(&line)?;
        assert_eq!(finished.code(), Some(0), "{line}\n{}", finished.stderr);
        self.metrics()
    }

    fn metrics(&self) -> Result<Value> {
        let text = std::fs::read_to_string(self.folder().join("apart/metrics.json"))?;
        Ok(serde_json::from_str(&text)?)
    }

    /// Names of the files in `apart`.
    fn written(&self) -> Result<BTreeSet<String>> {
        let entries = std::fs::read_dir(self.folder().join("apart"))?;
        entries
            .map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned()))
            .collect()
    }
}

/// A number of `metrics.json`.
fn number(of: &Value, path: &str) -> Result<f64> {
    let value = of.pointer(path);
    value
        .and_then(Value::as_f64)
        .with_context(|| format!("no number at {path} in {of:#}"))
}

#[test]
fn splats_are_nearer_to_surfels_than_points_are() -> Result<()> {
    let shell = Shell::new()?;
    let line = format!(
        "compare {} --renderers points,hqss --reference surfel --views orbit:2 --size 240x180 --out apart",
        sample("knotted_snake.ply").display()
    );
    let finished = shell.run(&line)?;
    if finished.stderr.contains("needs a graphics device") {
        skip("no graphics device to compare renderers on");
        return Ok(());
    }
    assert_eq!(finished.code(), Some(0), "{}", finished.stderr);
    let mut expected = BTreeSet::from(["metrics.json", "report.html"].map(str::to_owned));
    for view in ["000", "001"] {
        expected.insert(format!("reference_{view}.png"));
        for renderer in ["points", "hqss"] {
            for what in ["", "_difference", "_flip"] {
                expected.insert(format!("{renderer}_{view}{what}.png"));
            }
        }
    }
    assert_eq!(shell.written()?, expected);
    for name in expected.iter().filter(|name| name.contains("_00")) {
        let picture = compare::read(&shell.folder().join("apart").join(name))?;
        assert_eq!(picture.dimensions(), (240, 180), "{name}");
    }

    let metrics = shell.metrics()?;
    assert_eq!(metrics["format"], 1);
    assert_eq!(metrics["background"], "#ffffff");
    assert_eq!(metrics["reference"]["id"], "org.pointstage.surfel");
    assert!(metrics["device"].is_string());
    for view in 0..2 {
        let at = |renderer: usize, what: &str| {
            number(
                &metrics,
                &format!("/views/{view}/renderers/{renderer}/{what}"),
            )
        };
        for region in ["whole", "interior", "edge"] {
            let of = |renderer, metric: &str| at(renderer, &format!("{region}/{metric}"));
            for (metric, sign) in [("psnr_db", 1.0), ("ssim", 1.0), ("flip_mean", -1.0)] {
                let [points, hqss] = [of(0, metric)?, of(1, metric)?];
                assert!(
                    hqss * sign > points * sign,
                    "view {view}, {region} {metric}: hqss {hqss}, points {points}"
                );
            }
            let [mean, worst] = [of(1, "flip_mean")?, of(1, "flip_p99")?];
            assert!(
                0.0 < mean && mean < worst && worst <= 1.0,
                "{mean}, {worst}"
            );
        }
        let [whole, interior, edge] =
            ["whole", "interior", "edge"].map(|region| at(1, &format!("{region}/pixels")));
        assert_eq!(whole?, 240.0 * 180.0);
        // The snake fills a part of the picture.
        assert!(interior? > 2000.0 && edge? > 500.0);
        assert!(at(1, "ms")? > 0.0);
    }
    let mean = number(&metrics, "/means/1/whole/psnr_db")?;
    let of = |view| {
        number(
            &metrics,
            &format!("/views/{view}/renderers/1/whole/psnr_db"),
        )
    };
    assert!((mean - f64::midpoint(of(0)?, of(1)?)).abs() < 1e-9);

    // The table says the same, rounded.
    for part in ["interior", "PSNR dB", "mean", &format!("{mean:.2}")] {
        assert!(
            finished.stdout.contains(part),
            "{part}: {}",
            finished.stdout
        );
    }
    Ok(())
}

#[test]
fn a_renderer_is_identical_to_itself_and_its_difference_is_black() -> Result<()> {
    let shell = Shell::new()?;
    let options = "sphere.ply --no-device --renderers fallback --reference fallback --size 96x64";
    let metrics = shell.compare(options)?;
    let found = &metrics["views"][0]["renderers"][0];
    for region in ["whole", "interior", "edge"] {
        let measures = &found[region];
        assert_eq!(measures["identical"], true, "{region}");
        assert_eq!(measures["psnr_db"], Value::Null, "{region}");
        assert_eq!(measures["ssim"], 1.0, "{region}");
        assert_eq!(measures["flip_p99"], 0.0, "{region}");
        assert!(measures["pixels"].as_u64() > Some(0), "{region}");
    }
    assert_eq!(metrics["device"], Value::Null);
    assert_eq!(metrics["means"][0]["whole"]["identical"], true);
    let apart = shell.folder().join("apart");
    let difference = compare::read(&apart.join("fallback_000_difference.png"))?;
    assert!(difference.pixels().all(|pixel| pixel.0 == [0, 0, 0, 255]));
    let pictures =
        ["reference_000.png", "fallback_000.png"].map(|name| compare::read(&apart.join(name)));
    let [reference, picture] = pictures;
    assert!(reference? == picture?, "the two pictures differ");
    // `--json` prints the file; only the times of the two runs differ.
    let finished = shell.run(&format!("compare {options} --json --out apart"))?;
    let printed: Value = serde_json::from_str(&finished.stdout)?;
    assert_eq!(printed, shell.metrics()?);
    Ok(())
}

#[test]
fn a_picture_of_a_comparison_can_be_drawn_again() -> Result<()> {
    let shell = Shell::new()?;
    shell.compare("sphere.ply --no-device --renderers fallback --reference fallback --size 64x48 --background #203040 --exposure 1.5")?;
    let again = shell.run("render --no-device --session apart/fallback_000.png --out again.png")?;
    assert_eq!(again.code(), Some(0), "{}", again.stderr);
    let [drawn, expected] = ["again.png", "apart/fallback_000.png"]
        .map(|name| compare::read(&shell.folder().join(name)));
    let (drawn, expected) = (drawn?, expected?);
    assert_eq!(expected.get_pixel(0, 0).0, [0x20, 0x30, 0x40, 255]);
    assert!(drawn == expected, "the picture's own session differs");
    Ok(())
}

#[test]
fn pictures_that_are_there_already_can_be_the_reference() -> Result<()> {
    let shell = Shell::new()?;
    let options = "sphere.ply --no-device --renderers fallback --views orbit:2 --size 96x64";
    let by_renderer = shell.compare(&format!("{options} --reference fallback"))?;
    std::fs::rename(shell.folder().join("apart"), shell.folder().join("truth"))?;
    let by_images = format!("{options} --reference-images truth");
    let metrics = shell.compare(&by_images)?;
    assert_eq!(metrics["reference"], json!({ "images": "truth" }));
    for view in 0..2 {
        let of =
            |metrics: &Value, region: &str| metrics["views"][view]["renderers"][0][region].clone();
        // The sphere is nowhere as white as what is behind it, so both ways find the same silhouette.
        for region in ["whole", "interior", "edge"] {
            assert_eq!(of(&metrics, region), of(&by_renderer, region), "{region}");
        }
    }
    assert!(
        !shell.written()?.contains("reference_000.png"),
        "nobody drew it"
    );

    let compare = |options: &str| format!("compare {options} --out other");
    let gradient = format!("{by_images} --background #ffffff,#000000");
    shell.assert_fails(2, &compare(&gradient), &["--background of one colour"])?;
    let both = format!("{by_images} --reference fallback");
    shell.assert_fails(2, &compare(&both), &["cannot be used with"])?;
    let larger = by_images.replace("96x64", "97x64");
    let expected = ["reference_000.png: the picture is 96×64", "expected 97×64"];
    shell.assert_fails(1, &compare(&larger), &expected)?;
    let more = by_images.replace("orbit:2", "orbit:3");
    shell.assert_fails(1, &compare(&more), &["reference_002.png", "cannot be read"])?;
    assert!(
        !shell.folder().join("other").exists(),
        "nothing is drawn before"
    );
    Ok(())
}

#[test]
fn settings_of_an_entry_are_taken_and_name_its_files() -> Result<()> {
    let shell = Shell::new()?;
    let line = "compare sphere.ply --renderers points:shape=square:size_mode=fixed:size=9,points:size_mode=fixed:size=1 \
                --reference points:size_mode=fixed:size=9:shape=square --size 96x64 --out apart";
    let finished = shell.run(line)?;
    if finished.stderr.contains("needs a graphics device") {
        skip("no graphics device to compare renderers on");
        return Ok(());
    }
    assert_eq!(finished.code(), Some(0), "{}", finished.stderr);
    let metrics = shell.metrics()?;
    let renderers = &metrics["views"][0]["renderers"];
    assert_eq!(
        renderers[0]["label"],
        "points-shape-square-size-9-size_mode-fixed"
    );
    assert_eq!(renderers[0]["settings"]["size"], 9.0);
    assert_eq!(renderers[0]["whole"]["identical"], true);
    assert_eq!(renderers[1]["whole"]["identical"], false);
    let files = json!({
        "picture": "points-size-1-size_mode-fixed_000.png",
        "flip": "points-size-1-size_mode-fixed_000_flip.png",
        "difference": "points-size-1-size_mode-fixed_000_difference.png",
    });
    assert_eq!(renderers[1]["files"], files);
    for name in files.as_object().context("an object")?.values() {
        let name = name.as_str().context("a name")?;
        assert!(shell.written()?.contains(name), "{name}");
    }
    Ok(())
}

#[test]
fn views_of_files_and_orbits_go_together_in_one_size() -> Result<()> {
    let shell = Shell::new()?;
    let view = shell
        .compare("sphere.ply --no-device --renderers fallback --reference fallback --size 40x30")?;
    let mut view = view["views"][0]["view"].clone();
    view["width"] = json!(999);
    std::fs::write(shell.folder().join("view.json"), view.to_string())?;
    let metrics = shell.compare(
        "sphere.ply --no-device --renderers fallback --reference fallback --size 48x36 --views view.json,orbit:2",
    )?;
    let views = metrics["views"].as_array().context("an array")?;
    assert_eq!(views.len(), 3);
    for view in views {
        assert_eq!(
            (&view["view"]["width"], &view["view"]["height"]),
            (&json!(48), &json!(36))
        );
    }
    Ok(())
}

#[test]
fn what_compare_cannot_understand_is_a_usage_error_that_names_it() -> Result<()> {
    let shell = Shell::new()?;
    let cases: [(&str, &[&str]); 15] = [
        (
            "--renderers surfle --reference fallback",
            &["no renderer 'surfle'; did you mean 'surfel'?"],
        ),
        (
            "--renderers fallback --reference surfle",
            &["no renderer 'surfle'; did you mean 'surfel'?"],
        ),
        (
            "--renderers fallback,points:siez=3 --reference fallback",
            &[
                "renderer 'points:siez=3'",
                "no setting 'siez'; did you mean 'size'?",
            ],
        ),
        (
            "--renderers points:size=1e9 --reference fallback",
            &["outside 1 … 255 px", "nearest is 255"],
        ),
        (
            "--renderers points:size --reference fallback",
            &["expected id=value"],
        ),
        (
            "--renderers fallback:a=1 --reference fallback",
            &["no setting 'a'"],
        ),
        (
            "--renderers fallback, --reference fallback",
            &["expected a renderer's name"],
        ),
        (
            "--renderers fallback,pointstage.fallback --reference surfel",
            &["'fallback' and 'pointstage.fallback' are one renderer with the same settings"],
        ),
        // A setting at its default is no other renderer.
        (
            "--renderers hqss,hqss:filter=true --reference surfel",
            &["'hqss' and 'hqss:filter=true' are one renderer"],
        ),
        ("--renderers fallback", &["--reference"]),
        ("--reference fallback", &["--renderers"]),
        (
            "--renderers fallback --reference fallback --background transparent",
            &["one opaque background"],
        ),
        (
            "--renderers fallback --reference fallback --views orbit:0",
            &["expected orbit:N"],
        ),
        (
            "--renderers fallback --reference fallback --views front",
            &["no view is stored under 'front'"],
        ),
        (
            "--renderers fallback --reference fallback --size 20000x100",
            &["--size 20000x100", "up to 16384 pixels"],
        ),
    ];
    for (options, parts) in cases {
        // The scene's file is not there: nothing is read before all is checked.
        let line = format!("compare none.ply --no-device --out apart {options}");
        shell.assert_fails(2, &line, parts)?;
    }
    assert!(!shell.folder().join("apart").exists());
    Ok(())
}

#[test]
fn what_cannot_be_drawn_or_written_is_a_failure_that_names_it() -> Result<()> {
    let shell = Shell::new()?;
    std::fs::write(shell.folder().join("view.json"), "{}")?;
    std::fs::write(shell.folder().join("taken"), "a file")?;
    let both = "--renderers fallback --reference fallback";
    let cases: [(&str, &[&str]); 5] = [
        (
            "sphere.ply --renderers fallback,points --reference fallback --out apart",
            &[
                "renderer 'points' cannot draw this",
                "needs a graphics device",
            ],
        ),
        (
            "sphere.ply --renderers fallback --reference hqss --out apart",
            &["renderer 'hqss' cannot draw this"],
        ),
        (
            &format!("none.ply {both} --out apart"),
            &["none.ply: cannot be read"],
        ),
        (
            &format!("sphere.ply {both} --views veiw.json --out apart"),
            &["veiw.json", "did you mean 'view.json'?"],
        ),
        (
            &format!("sphere.ply {both} --out taken/apart"),
            &["taken/apart: the folder cannot be made"],
        ),
    ];
    for (options, parts) in cases {
        shell.assert_fails(1, &format!("compare --no-device {options}"), parts)?;
    }
    assert!(!shell.folder().join("apart").exists());
    Ok(())
}

#[test]
fn a_renderer_that_fails_while_it_draws_fails_the_comparison() -> Result<()> {
    let shell = Shell::new()?;
    let file = plugins::misbehaving()?;
    let line = format!(
        "compare sphere.ply --no-device --plugin {} --reference fallback --size 64x48 --out apart \
         --renderers org.pointstage.test.error-render",
        file.display()
    );
    shell.assert_fails(
        1,
        &line,
        &[
            "org.pointstage.test.error-render",
            "asked to fail in render",
        ],
    )?;
    assert!(
        !shell.written()?.iter().any(|name| name.contains("render")),
        "a picture was written under the name of a renderer that did not draw it"
    );
    Ok(())
}

#[test]
fn two_runs_of_a_renderer_with_the_same_settings_differ_by_nothing() -> Result<()> {
    const RENDERERS: [&str; 3] = ["points", "surfel", "hqss"];
    let shell = Shell::new()?;
    let scene = sample("knotted_snake.ply");
    let options = format!("{} --size 240x180 --frames 0", scene.display());
    let renderers = RENDERERS.join(",");
    let line =
        format!("compare {options} --renderers {renderers} --reference fallback --out apart");
    let finished = shell.run(&line)?;
    if finished.stderr.contains("needs a graphics device") {
        skip("no graphics device to draw twice on");
        return Ok(());
    }
    assert_eq!(finished.code(), Some(0), "{}", finished.stderr);
    let first = shell.folder().join("first");
    std::fs::rename(shell.folder().join("apart"), &first)?;
    for renderer in RENDERERS {
        std::fs::copy(
            first.join(format!("{renderer}_000.png")),
            first.join("reference_000.png"),
        )?;
        let metrics = shell.compare(&format!(
            "{options} --renderers {renderer} --reference-images first"
        ))?;
        let whole = &metrics["views"][0]["renderers"][0]["whole"];
        assert_eq!(whole["identical"], true, "{renderer}: {whole:#}");
    }
    Ok(())
}

#[test]
fn targets_are_drawn_with_one_range_for_all() -> Result<()> {
    let shell = Shell::new()?;
    let metrics = shell.compare(
        "sphere.ply --no-device --renderers ewa-reference --reference fallback --targets depth,normal --size 64x48 --frames 1",
    )?;
    let view = &metrics["views"][0];
    let of_renderer = &view["renderers"][0]["files"]["targets"];
    assert_eq!(of_renderer["depth"], "ewa-reference_000_depth.png");
    assert_eq!(
        view["reference"]["targets"]["normal"],
        "reference_000_normal.png"
    );
    let [near, far] = [0, 1].map(|end| number(view, &format!("/reference/ranges/depth/{end}")));
    assert_ne!(near?, far?);
    for name in ["ewa-reference_000_depth.png", "reference_000_normal.png"] {
        assert!(shell.written()?.contains(name), "{name}");
    }
    let times = &view["renderers"][0]["times"];
    assert_eq!(times["frames"], 1);
    assert!(number(times, "/frame_ms/median")? > 0.0);
    for (key, expected) in [("hash", true), ("all_settings", true)] {
        let is_there = !view["renderers"][0][key].is_null();
        assert_eq!(is_there, expected, "{key}");
    }
    let made_by = &metrics["made_by"];
    let command = made_by["command"].as_str().context("a command")?;
    assert!(
        command.starts_with("pointstage compare sphere.ply"),
        "{command}"
    );
    let line = "compare sphere.ply --no-device --renderers fallback --reference fallback --targets dpeth --out a";
    shell.assert_fails(2, line, &["'dpeth'", "did you mean 'depth'?"])
}
