//! How fast PLY files load, beside what other readers take for the same files, and in how much memory.
//!
//! ```text
//! cargo bench -p pointstage-scene --bench load_ply                      the brain of the shared test data folder
//! cargo bench -p pointstage-scene --bench load_ply -- FILE …            other files, of any format that is built in
//! POINTSTAGE_PEERS_PYTHON=venv/bin/python cargo bench …                 beside other readers
//! ```
//!
//! The others are trimesh, Open3D, VTK and MeshLab from PyPI, in an environment outside the repository (`python3 -m venv
//! venv` and `venv/bin/pip install numpy trimesh open3d vtk pymeshlab`), and CloudCompare where its program is installed.
//! `tests/peers/read_file.py` runs them.
//!
//! The surfels of each PLY file are written as an SFL file too, and loaded from there, with normals and radii as the file has
//! them; of SFL, QSplat and TRI files the rate stands alone, since none of the others reads them.
//!
//! For each PLY file and for the same file as text (written to a temporary folder, six decimals): the median of [`RUNS`] loads
//! of positions and triangles alone ('bare') and with normals and radii ('full'), after one load that warms the file
//! cache; the same for each peer, bare; and the ratio of the fastest peer to us. Rounds alternate between us and the
//! peers, so that a busy moment meets both. The peak of memory is that of a process of its own, less what it held before the load; mapped
//! pages of the file are in it. The calibration line is a fixed run of arithmetic and of memory traffic, so that figures
//! from different days can be told apart from different machines.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use pointstage_scene::{Estimation, Job, LoadOptions, SaveFormat, load, save};

#[path = "shared/calibration.rs"]
mod calibration;

use calibration::calibrate;

/// Loads timed for each median.
const RUNS: usize = 7;

/// Rounds over which the loads are spread, with the peers between.
const ROUNDS: usize = 3;

fn main() {
    // `cargo bench` adds --bench, `cargo test --benches` adds nothing: then one small run shows that it works.
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [mode, estimation, path] = arguments.as_slice()
        && mode == "--peak"
    {
        println!("{}", peak_bytes(Path::new(path), estimation_of(estimation)));
        return;
    }
    let mut files: Vec<PathBuf> = arguments
        .iter()
        .filter(|argument| !argument.starts_with('-'))
        .map(PathBuf::from)
        .collect();
    if files.is_empty() {
        let brain = data_folder().join("mesh/brain_ch2better_1092k_le.ply");
        if !brain.is_file() {
            println!(
                "skipped: no file given, and no shared test data folder at {}",
                data_folder().display()
            );
            return;
        }
        files.push(brain);
    }
    calibrate(rayon::current_num_threads());
    let scratch = tempfile::tempdir().expect("a temporary folder");
    for file in files {
        if file.extension().is_none_or(|extension| extension != "ply") {
            rate(&file);
            continue;
        }
        compare(&file, scratch.path());
        let text = scratch.path().join(format!(
            "{}_ascii.ply",
            file.file_stem().unwrap_or_default().to_string_lossy()
        ));
        write_as_text(&file, &text);
        compare(&text, scratch.path());
        let surfels = text.with_extension("sfl");
        write_as_surfels(&file, &surfels);
        rate(&surfels);
    }
}

/// Times one file alone, and prints its rate.
fn rate(file: &Path) {
    time_load(file, "bare");
    let seconds = median((0..RUNS).map(|_| time_load(file, "bare")).collect());
    let bytes = std::fs::metadata(file).map_or(0, |metadata| metadata.len()) as f64;
    println!(
        "\n{}\n  ours, bare {:>8.1} ms   {:.1} MB in the file, {:.0} MB/s",
        file.display(),
        seconds * 1e3,
        bytes / 1e6,
        bytes / 1e6 / seconds
    );
}

/// The surfels of a file with normals and radii, as SFL.
fn write_as_surfels(file: &Path, surfels: &Path) {
    let options = LoadOptions::default();
    let mut loaded = load(file, &options, &Job::new()).unwrap_or_else(|error| panic!("{error}"));
    let geometry = std::sync::Arc::make_mut(&mut loaded.object.geometry);
    geometry.triangles = None;
    save(&loaded.object, surfels, SaveFormat::Sfl, &Job::new())
        .unwrap_or_else(|error| panic!("{error}"));
}

fn data_folder() -> PathBuf {
    std::env::var_os("POINTSTAGE_TEST_DATA").map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data")),
        PathBuf::from,
    )
}

fn estimation_of(name: &str) -> Estimation {
    if name == "bare" {
        Estimation::FileOnly
    } else {
        Estimation::Automatic
    }
}

/// Times one file, ours and the peers', and prints a table.
fn compare(file: &Path, scratch: &Path) {
    let mut times: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    let mut peer_peaks = BTreeMap::new();
    time_load(file, "bare");
    for _ in 0..ROUNDS {
        for mode in ["bare", "full"] {
            for _ in 0..RUNS.div_ceil(ROUNDS) {
                times
                    .entry(format!("ours, {mode}"))
                    .or_default()
                    .push(time_load(file, mode));
            }
        }
        for (peer, seconds, peak) in peers(file, scratch) {
            times.entry(peer.clone()).or_default().extend(seconds);
            peer_peaks.insert(peer, peak);
        }
    }
    println!("\n{}", file.display());
    let options = LoadOptions {
        estimation: Estimation::Automatic,
        ..LoadOptions::default()
    };
    let loaded = load(file, &options, &Job::new()).unwrap_or_else(|error| panic!("{error}"));
    let columns = loaded.object.geometry.byte_count();
    println!(
        "  {} surfels, {} triangles, {:.1} MB in the file, {:.1} MB of columns and triangles",
        loaded.object.geometry.surfel_count,
        loaded.object.geometry.triangle_count(),
        std::fs::metadata(file).map_or(0, |metadata| metadata.len()) as f64 / 1e6,
        columns as f64 / 1e6,
    );
    drop(loaded);
    let medians: BTreeMap<&str, f64> = times
        .iter()
        .map(|(name, seconds)| (name.as_str(), median(seconds.clone())))
        .collect();
    let fastest = medians
        .iter()
        .filter(|(name, _)| !name.starts_with("ours"))
        .min_by(|a, b| a.1.total_cmp(b.1));
    for (name, seconds) in &medians {
        let mut line = format!("  {name:<12} {:>8.1} ms", seconds * 1e3);
        if name.starts_with("ours") {
            let peak = peak_in_child(file, name.trim_start_matches("ours, "));
            let _ = write!(
                line,
                "   peak {:>6.1} MB ({:.2} of the columns)",
                peak / 1e6,
                peak / columns as f64
            );
            if let Some((peer, peer_seconds)) = fastest {
                let _ = write!(
                    line,
                    "   {:.2} times as fast as {peer}",
                    *peer_seconds / seconds
                );
            }
        } else if let Some(peak) = peer_peaks.get(*name) {
            let _ = write!(line, "   peak {:>6.1} MB", peak / 1e6);
        }
        println!("{line}");
    }
}

fn time_load(file: &Path, mode: &str) -> f64 {
    let options = LoadOptions {
        estimation: estimation_of(mode),
        ..LoadOptions::default()
    };
    let start = Instant::now();
    let loaded = load(file, &options, &Job::new()).unwrap_or_else(|error| panic!("{error}"));
    let seconds = start.elapsed().as_secs_f64();
    assert!(loaded.object.geometry.surfel_count > 0);
    seconds
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Name, seconds of each run and peak bytes of each peer that there is; none without `POINTSTAGE_PEERS_PYTHON`.
fn peers(file: &Path, scratch: &Path) -> Vec<(String, Vec<f64>, f64)> {
    let Some(python) = std::env::var_os("POINTSTAGE_PEERS_PYTHON") else {
        return Vec::new();
    };
    let script = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../tests/peers/read_file.py"
    );
    let runs = RUNS.div_ceil(ROUNDS).to_string();
    let output = Command::new(python)
        .arg(script)
        .arg(file)
        .arg(runs)
        .current_dir(scratch)
        .output()
        .expect("python runs");
    assert!(
        output.status.success(),
        "read_file.py failed: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    let answer: serde_json::Value =
        serde_json::from_slice(&output.stdout).expect("read_file.py prints JSON");
    let of_peer = |(name, result): (&String, &serde_json::Value)| {
        let seconds = result["seconds"]
            .as_array()?
            .iter()
            .filter_map(serde_json::Value::as_f64)
            .collect();
        Some((name.clone(), seconds, result["peak_bytes"].as_f64()?))
    };
    answer
        .as_object()
        .into_iter()
        .flatten()
        .filter_map(of_peer)
        .collect()
}

/// Peak of a process that loads the file once.
fn peak_in_child(file: &Path, mode: &str) -> f64 {
    let program = std::env::current_exe().expect("this program has a path");
    let output = Command::new(program)
        .args(["--peak", mode])
        .arg(file)
        .output()
        .expect("this program runs again");
    String::from_utf8_lossy(&output.stdout)
        .trim()
        .parse()
        .unwrap_or(f64::NAN)
}

/// Largest resident size during a load less that before it, bytes. Linux only; NaN elsewhere.
fn peak_bytes(file: &Path, estimation: Estimation) -> f64 {
    // The thread pool belongs to the program, not to the load.
    rayon::broadcast(|_| ());
    let status = |key: &str| {
        let text = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let line = text
            .lines()
            .find(|line| line.starts_with(key))
            .unwrap_or_default();
        line.split_whitespace()
            .nth(1)
            .and_then(|number| number.parse::<f64>().ok())
            .map_or(f64::NAN, |kib| kib * 1024.0)
    };
    let before = status("VmRSS:");
    let loaded = load(
        file,
        &LoadOptions {
            estimation,
            ..LoadOptions::default()
        },
        &Job::new(),
    );
    let peak = status("VmHWM:") - before;
    assert!(loaded.is_ok());
    peak
}

/// The positions and triangles of a file, as text.
fn write_as_text(file: &Path, text: &Path) {
    let options = LoadOptions {
        estimation: Estimation::FileOnly,
        ..LoadOptions::default()
    };
    let loaded = load(file, &options, &Job::new()).unwrap_or_else(|error| panic!("{error}"));
    let geometry = &loaded.object.geometry;
    let mut out = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        geometry.surfel_count,
        geometry.triangle_count()
    );
    for [x, y, z, _] in geometry
        .blocks
        .iter()
        .flat_map(|block| block.position_radius.iter())
    {
        let _ = writeln!(out, "{x:.6} {y:.6} {z:.6}");
    }
    for [a, b, c] in geometry
        .triangles
        .iter()
        .flat_map(|triangles| triangles.iter())
    {
        let _ = writeln!(out, "3 {a} {b} {c}");
    }
    std::fs::write(text, out).expect("the temporary folder takes the file");
}
