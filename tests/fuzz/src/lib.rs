//! What every fuzz target does with its input: reads it as a file, and looks at what came of it.
//!
//! ```text
//! cargo xtask fuzz ply las --seconds 600
//! ```
//!
//! An error is fine. A panic, caught or not, is not, nor is an object that contradicts itself, nor memory above
//! [`most_bytes`]. What a fuzzer finds goes into `found/READER/`, which a test of every gate reads.

use std::path::PathBuf;
use std::sync::Arc;

use peak_alloc::PeakAlloc;
use pointstage_engine::plugins::linked_loader;
use pointstage_plugin_api::__export::loader_factory;
use pointstage_plugin_api::loading::Loader;
use pointstage_scene::{Estimation, Job, LoadOptions, LoaderChoice, Loaders, Object, load_with};
use tempfile::TempDir;

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// The manifest of the loaders of meshes.
pub const MESH_FORMATS: &[u8] = include_bytes!("../../../plugins/mesh-formats/plugin.json");
/// The manifest of the loaders of scans.
pub const POINT_FORMATS: &[u8] = include_bytes!("../../../plugins/point-formats/plugin.json");

/// The most memory that reading a file of `length` bytes may take: four times the file and 64 MB.
pub const fn most_bytes(length: usize) -> usize {
    4 * length + 64_000_000
}

/// One reader, and a place for the file that it reads.
pub struct Reader {
    loaders: Loaders,
    options: LoadOptions,
    file: PathBuf,
    _folder: TempDir,
}

impl Reader {
    /// A reader of the scene's own.
    ///
    /// # Panics
    /// There is no folder for temporary files.
    pub fn built_in(alias: &str) -> Self {
        Self::of(Loaders::built_in(), alias)
    }

    /// The reader `L` of a plugin whose manifest calls it `alias`.
    ///
    /// # Panics
    /// The manifest does not know it, or there is no folder for temporary files.
    pub fn linked<L: Loader>(manifest: &[u8], alias: &str) -> Self {
        let loader = linked_loader(manifest, alias, loader_factory::<L>)
            .unwrap_or_else(|error| panic!("{error}"));
        let loaders = Loaders::built_in().with_others(move || vec![Arc::clone(&loader)]);
        Self::of(loaders, alias)
    }

    fn of(loaders: Loaders, alias: &str) -> Self {
        let folder = tempfile::tempdir().expect("a folder for temporary files");
        Self {
            loaders,
            options: LoadOptions {
                loader: Some(LoaderChoice {
                    loader: alias.to_owned(),
                    ..LoaderChoice::default()
                }),
                estimation: Estimation::FileOnly,
                ..LoadOptions::default()
            },
            file: folder.path().join(format!("input.{alias}")),
            _folder: folder,
        }
    }

    /// Reads `content` as a file.
    ///
    /// # Panics
    /// Something came of it that must not.
    pub fn read(&self, content: &[u8]) {
        std::fs::write(&self.file, content).expect("the temporary file can be written");
        MEMORY.reset_peak_usage();
        let before = MEMORY.current_usage();
        let outcome = load_with(&self.loaders, &self.file, &self.options, &Job::new());
        let taken = MEMORY.peak_usage().saturating_sub(before);
        let most = most_bytes(content.len());
        assert!(taken <= most, "{taken} bytes taken, {most} allowed");
        match outcome {
            Ok(loaded) => check(&loaded.object),
            Err(error) => {
                let text = error.to_string();
                assert!(!text.contains("panicked"), "{text}");
            }
        }
    }
}

/// An object that contradicts itself would fail far from here, in a renderer.
fn check(object: &Object) {
    let geometry = &object.geometry;
    let mut count = 0;
    for block in &geometry.blocks {
        let length = block.position_radius.len();
        count += length;
        for [x, y, z, radius] in block.position_radius.iter() {
            assert!(
                x.is_finite() && y.is_finite() && z.is_finite(),
                "{x} {y} {z}"
            );
            assert!(radius.is_finite() && *radius >= 0.0, "radius {radius}");
        }
        for column in [&block.normal, &block.colour].into_iter().flatten() {
            assert_eq!(column.len(), length);
        }
        if let Some(axes) = &block.axes {
            assert_eq!(axes.len(), length);
            assert!(axes.iter().flatten().all(|value| value.is_finite()));
        }
        for column in &block.named {
            let width = column.components as usize * column.scalar.size();
            assert_eq!(column.bytes.len(), length * width, "{}", column.name);
        }
    }
    assert_eq!(count, geometry.surfel_count);
    for corner in geometry
        .triangles
        .iter()
        .flat_map(|all| all.iter().flatten())
    {
        assert!(
            (*corner as usize) < count,
            "corner {corner} of {count} surfels"
        );
    }
}
