//! Every format's reader beside those of other programs: counts, seconds, and the most memory, as one table.
//!
//! ```text
//! cargo xtask bench formats                                          the largest file of each format
//! cargo xtask bench formats -- FILE …                                these files
//! POINTSTAGE_PEERS_PYTHON=venv/bin/python cargo xtask bench formats  beside other readers
//! ```
//!
//! The files are the largest ones of the shared test data folder. A format of which there is none, or only small ones, is
//! written from the brain there ([`mesh_files`]) into `target/formats/`. `tests/peers/read_file.py` says who the others are and
//! how to install them.
//!
//! A time is that of one load, nothing estimated ('bare'); the median of [`RUNS`] loads after one that does not count. We and
//! the others take turns, each load series in a process of its own, so that a busy moment meets all. Of another reader whose first load
//! takes longer than 3 s that one load counts, and of one that takes longer than a minute nothing but that is known: the table would
//! take hours otherwise. The memory is the largest
//! resident size of a process that loads once, less what it held before; mapped pages of the file are in it, and 4 times the file and
//! 64 MB are allowed.

use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context as _, Result, ensure};
use pointstage_scene::{Estimation, Job, LoadOptions, SaveFormat, load, save};
use pointstage_tests::{data, loaders, mesh_files, program};

mod measured;
mod peers;
mod table;

use measured::Measured;

/// Loads timed in one process.
const RUNS: usize = 3;
/// Processes of each reader, taking turns.
const ROUNDS: usize = 3;

fn main() -> Result<()> {
    // `cargo bench` adds --bench.
    let arguments: Vec<String> = std::env::args()
        .skip(1)
        .filter(|word| word != "--bench")
        .collect();
    if let [mode, file] = arguments.as_slice()
        && mode == "--read"
    {
        println!("{}", serde_json::to_string(&read(Path::new(file))?)?);
        return Ok(());
    }
    let files = if arguments.is_empty() {
        let folder = program::target_folder().join("formats");
        files_of_every_format(&folder)?
    } else {
        arguments.iter().map(PathBuf::from).collect()
    };
    ensure!(!files.is_empty(), "there is no file to read");
    println!("{}", table::HEAD);
    let mut others = Vec::new();
    for file in &files {
        let row = row(file)?;
        // Each as it comes: some of the others take minutes.
        println!("{}", row.line());
        others.extend(row.lines_of_others());
    }
    println!("\n{}", table::OTHERS_HEAD);
    for line in others {
        println!("{line}");
    }
    Ok(())
}

/// One file's line of the table.
fn row(file: &Path) -> Result<table::Row> {
    let (mut ours, mut others) = (Measured::default(), peers::Peers::default());
    for _ in 0..ROUNDS {
        ours.join(measured::in_child(file)?);
        let others_again = peers::measure(file, RUNS, &others)?;
        others.join(others_again);
    }
    Ok(table::Row {
        file: file.to_owned(),
        bytes: std::fs::metadata(file)?.len(),
        ours,
        others,
    })
}

/// Loads `file` once for the memory and [`RUNS`] times for the time.
fn read(file: &Path) -> Result<Measured> {
    let loaders = loaders::first_party()?;
    // The thread pool and the libraries belong to the program, not to the load.
    rayon::broadcast(|_| ());
    loaders.all();
    let before = measured::resident_bytes("VmRSS:")?;
    let first = loaders::load_as_it_is(&loaders, file)?;
    let peak_bytes = measured::resident_bytes("VmHWM:")?.saturating_sub(before);
    let geometry = &first.object.geometry;
    let mut measured = Measured {
        format: first.loader.title.clone(),
        surfels: geometry.surfel_count as u64,
        triangles: geometry.triangles.as_ref().map_or(0, |all| all.len()) as u64,
        peak_bytes,
        seconds: Vec::new(),
    };
    drop(first);
    for _ in 0..RUNS {
        let began = Instant::now();
        let loaded = loaders::load_as_it_is(&loaders, file)?;
        measured.seconds.push(began.elapsed().as_secs_f64());
        drop(loaded);
    }
    Ok(measured)
}

/// The largest file at hand of each format; what there is none of is made.
fn files_of_every_format(folder: &Path) -> Result<Vec<PathBuf>> {
    const REAL: [&str; 8] = [
        "mesh/brain_ch2better_1092k_le.ply",
        "points/lion_normals_rgb_le.ply",
        "points/lone-star.copc.laz",
        "points/indoor_808k.laz",
        "points/vol_total_rgb_499k.laz",
        "points/bunnyDouble.e57",
        "qs/bunny.qs",
        "sfl/dragon_ps3d.sfl",
    ];
    let real = REAL.iter().filter_map(|name| data::shared(name));
    let mut files: Vec<PathBuf> = real.collect();
    let Some(source) = data::shared("mesh/brain_ch2better_1092k_le.ply") else {
        return Ok(files);
    };
    std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    let options = LoadOptions {
        estimation: Estimation::Always,
        ..LoadOptions::default()
    };
    let object = load(&source, &options, &Job::new())?.object;
    let mesh = mesh_files::Mesh::of(&object);
    files.extend(mesh_files::write_all(&mesh, folder, "brain")?);
    let surfels = folder.join("brain.sfl");
    if !surfels.is_file() {
        save(&object, &surfels, SaveFormat::Sfl, &Job::new())?;
    }
    files.push(surfels);
    Ok(files)
}
