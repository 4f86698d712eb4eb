//! `bench` and `sweep`: what is measured is what was, limits hold, and all that was promised is written.

use anyhow::{Context as _, Result};
use pointstage_tests::data::skip;
use pointstage_tests::{plugins, scenes};
use serde_json::Value;

use super::Shell;

/// A number of a report.
fn number(of: &Value, path: &str) -> Result<f64> {
    of.pointer(path)
        .and_then(Value::as_f64)
        .with_context(|| format!("no number at {path} in {of:#}"))
}

impl Shell {
    /// Runs `bench` with the renderer that sleeps, and reads what it prints.
    fn bench(&self, options: &str) -> Result<Value> {
        let sleeper = plugins::sleeper()?;
        let line = format!(
            "bench {options} --no-device --size 48x32 --json --plugin {}",
            sleeper.display()
        );
        let finished = self.run(&line)?;
        assert_eq!(finished.code(), Some(0), "{line}\n{}", finished.stderr);
        Ok(serde_json::from_str(&finished.stdout)?)
    }
}

#[test]
fn known_sleeps_are_measured_where_they_happen() -> Result<()> {
    let shell = Shell::new()?;
    let report = shell.bench(
        "sphere.ply --renderers sleeper,sleeper:sleep_ms=40,sleeper:prepare_ms=150 --frames 9 --rounds 3 --warm-up 1",
    )?;
    let of = |renderer: usize, what: &str| {
        number(&report, &format!("/scenes/0/renderers/{renderer}/{what}"))
    };
    // A sleep is never shorter than it was asked to be; on a busy machine it may be longer.
    for part in ["frame_ms", "cpu_ms"] {
        let empty = of(0, &format!("times/{part}/median"))?;
        let asleep = of(1, &format!("times/{part}/median"))?;
        assert!(empty < 20.0, "{part} of an empty picture: {empty} ms");
        assert!(
            (40.0..80.0).contains(&asleep),
            "{part} of 40 ms: {asleep} ms"
        );
    }
    assert_eq!(of(0, "times/frames")?, 9.0);
    for renderer in 0..3 {
        let gpu = &report["scenes"][0]["renderers"][renderer]["times"]["gpu_ms"];
        assert_eq!(*gpu, Value::Null, "nothing is drawn on a device");
        let [median, p95, p99] =
            ["median", "p95", "p99"].map(|part| of(renderer, &format!("times/frame_ms/{part}")));
        assert!(median? <= p95? && of(renderer, "times/frame_ms/p95")? <= p99?);
    }
    // Preparation belongs to the first image, and to a switch to what has to be prepared anew; to no other picture.
    assert!(of(2, "first_image_ms")? >= 150.0 && of(0, "first_image_ms")? < 150.0);
    assert!(of(2, "switch_ms/median")? >= 150.0);
    assert!(of(2, "times/frame_ms/p99")? < 150.0);
    let [fps, ms] = [of(1, "frames_per_second")?, of(1, "times/frame_ms/median")?];
    assert!((fps * ms - 1000.0).abs() < 1e-6);
    assert!((of(1, "splats_per_second")? - 500.0 * fps).abs() < 1e-6);
    Ok(())
}

#[test]
fn several_scenes_are_written_as_tables_and_plots() -> Result<()> {
    let shell = Shell::new()?;
    scenes::write(shell.folder(), "larger", &scenes::sphere(900, 1.0))?;
    let report = shell.bench(
        "sphere.ply larger.ply --renderers fallback,sleeper:sleep_ms=30 --baseline fallback --frames 4 --rounds 2 --out speed",
    )?;
    for (scene, surfels) in [(0, 500), (1, 900)] {
        assert_eq!(report["scenes"][scene]["surfels"], surfels);
        let ratio = |renderer: usize| {
            number(
                &report,
                &format!("/scenes/{scene}/renderers/{renderer}/ratio"),
            )
        };
        assert_eq!(ratio(0)?, 1.0);
        assert!(ratio(1)? > 1.0);
    }
    let speed = shell.folder().join("speed");
    let written: Value = serde_json::from_str(&std::fs::read_to_string(speed.join("bench.json"))?)?;
    assert_eq!(written, report);
    let page = std::fs::read_to_string(speed.join("bench.md"))?;
    for part in [
        "| scene | surfels | fallback | sleeper-sleep_ms-30 |",
        "| larger | 900 |",
        "--frames 4",
    ] {
        assert!(page.contains(part), "no '{part}' in\n{page}");
    }
    for name in [
        "frames_per_second.svg",
        "splats_per_second.svg",
        "times_0.svg",
        "times_1.svg",
    ] {
        let svg = std::fs::read_to_string(speed.join(name))?;
        assert!(
            svg.starts_with("<svg") && svg.contains("sleeper-sleep_ms"),
            "{name}"
        );
    }
    Ok(())
}

#[test]
fn limits_that_are_broken_end_with_1_after_all_is_written() -> Result<()> {
    let shell = Shell::new()?;
    let sleeper = plugins::sleeper()?;
    let bench = |limit: &str| {
        shell.run(&format!(
            "bench sphere.ply --no-device --renderers sleeper:sleep_ms=30 --frames 2 --size 48x32 --plugin {} {limit}",
            sleeper.display()
        ))
    };
    let kept = bench("--fail-above ms=5000 --fail-below fps=0.1")?;
    assert_eq!(kept.code(), Some(0), "{}", kept.stderr);
    let broken = bench("--fail-above ms=10 --fail-below fps=1000")?;
    assert_eq!(broken.code(), Some(1), "{}", broken.stderr);
    assert!(
        broken.stdout.contains("sleeper-sleep_ms-30"),
        "{}",
        broken.stdout
    );
    for part in [
        "2 values are beyond the limits",
        "on sphere: ms is 3",
        "above 10",
        "fps is",
        "below 1000",
    ] {
        assert!(
            broken.stderr.contains(part),
            "no '{part}' in {}",
            broken.stderr
        );
    }

    let compare = "compare sphere.ply --no-device --renderers fallback --reference ewa-reference --size 64x48 --out apart";
    let guarded = format!("{compare} --fail-above flip=0.9 --fail-below ssim=0.1");
    assert_eq!(shell.run(&guarded)?.code(), Some(0));
    let guarded = format!("{compare} --fail-above flip=0.0001 --fail-below psnr=90");
    let broken = shell.run(&guarded)?;
    assert_eq!(broken.code(), Some(1), "{}", broken.stderr);
    assert!(
        broken.stderr.contains("fallback: flip is 0."),
        "{}",
        broken.stderr
    );
    assert!(shell.folder().join("apart/report.html").is_file());
    Ok(())
}

#[test]
fn what_bench_and_sweep_cannot_understand_is_a_usage_error_that_names_it() -> Result<()> {
    let shell = Shell::new()?;
    let cases: [(&str, &[&str]); 9] = [
        (
            "bench none.ply --renderers surfle",
            &["did you mean 'surfel'?"],
        ),
        (
            "bench none.ply --renderers fallback --frames 0",
            &["--frames"],
        ),
        (
            "bench none.ply --renderers fallback --fail-above fpz=3",
            &["--fail-above fpz", "first_ms"],
        ),
        (
            "bench none.ply --renderers fallback --fail-above ms",
            &["QUANTITY=NUMBER"],
        ),
        (
            "bench none.ply --renderers fallback --baseline surfel",
            &["--baseline surfel", "not among"],
        ),
        (
            "sweep none.ply --renderer hqss --set-range scale=0.5:2:9 --reference hqss --out s",
            &["no setting 'scale'; did you mean 'splat_scale'?"],
        ),
        (
            "sweep none.ply --renderer hqss --set-range splat_scale=0.5:2 --reference hqss --out s",
            &["FROM:TO:COUNT"],
        ),
        (
            "sweep none.ply --renderer hqss --set-range filter=0:1:3 --reference hqss --out s",
            &["name its values"],
        ),
        (
            "compare none.ply --renderers hqss --reference hqss --fail-above psnr=3 --out s",
            &["--fail-above psnr", "flip_p99"],
        ),
    ];
    for (line, parts) in cases {
        shell.assert_fails(2, &format!("{line} --no-device"), parts)?;
    }
    let no_path = "bench sphere.ply --renderers fallback --no-device --path none.json";
    shell.assert_fails(1, no_path, &["none.json: the path cannot be read"])
}

#[test]
fn a_sweep_draws_each_value_and_plots_what_it_does() -> Result<()> {
    let shell = Shell::new()?;
    let line = "sweep sphere.ply --no-device --renderer ewa-reference --set-range splat_scale=0.5:2:3 \
                --reference ewa-reference --size 64x48 --frames 1 --json --out sweep";
    let finished = shell.run(line)?;
    if finished.stderr.contains("no renderer") {
        skip("the renderer ewa-reference was not built");
        return Ok(());
    }
    assert_eq!(finished.code(), Some(0), "{}", finished.stderr);
    let sweep: Value = serde_json::from_str(&finished.stdout)?;
    let values = sweep["values"].as_array().context("an array")?;
    let texts: Vec<&str> = values
        .iter()
        .filter_map(|value| value["value"].as_str())
        .collect();
    assert_eq!(texts, ["0.5", "1", "2"]);
    // The setting's own default is the reference itself.
    assert_eq!(values[1]["whole"]["identical"], true);
    for other in [0, 2] {
        assert!(number(&values[other], "/whole/flip_mean")? > 0.001);
    }
    let folder = shell.folder().join("sweep");
    for name in ["quality_by_time.svg", "quality.svg", "time.svg"] {
        let svg = std::fs::read_to_string(folder.join(name))?;
        assert!(svg.contains("splat_scale"), "{name}");
    }
    for name in [
        "metrics.json",
        "report.html",
        "sweep.json",
        "ewa-reference-splat_scale-2_000.png",
    ] {
        assert!(folder.join(name).is_file(), "{name}");
    }
    Ok(())
}
