//! Does a plugin that was built long ago still draw? `tests/plugins/shipped/` keeps the library of well-behaved plugins
//! as it was built against border 1.0.0; today's host has to load it and draw what the same sources draw when they are
//! built today.

use anyhow::{Context as _, Result};
use flate2::read::GzDecoder;
use pointstage_engine::stage::FrameRequest;
use pointstage_tests::data::{repository, skip};
use pointstage_tests::{plugins, scenes, stages};
use std::fs::File;
use std::path::{Path, PathBuf};

const SIZE_PX: [u32; 2] = [160, 120];

/// The stored library, unpacked into `folder`; none on systems for which none was stored.
fn shipped(folder: &Path) -> Result<Option<PathBuf>> {
    let target = match (std::env::consts::OS, std::env::consts::ARCH) {
        ("linux", "x86_64") if cfg!(target_env = "gnu") => "x86_64-unknown-linux-gnu",
        _ => return Ok(None),
    };
    let name = format!("sound-1.0.0-{target}.so");
    let packed = repository().join(format!("tests/plugins/shipped/{name}.gz"));
    let file = File::open(&packed).with_context(|| format!("opening {}", packed.display()))?;
    let library = folder.join(name);
    std::io::copy(&mut GzDecoder::new(file), &mut File::create(&library)?)
        .with_context(|| format!("unpacking {}", packed.display()))?;
    Ok(Some(library))
}

/// Both libraries draw the same request: the stored one and the one built today.
fn draw_alike(renderer: &str, structure: Option<&str>, use_device: bool) -> Result<()> {
    let folder = tempfile::tempdir()?;
    let Some(shipped) = shipped(folder.path())? else {
        skip("no library of border 1.0.0 is stored for this system");
        return Ok(());
    };
    let scene = stages::scene(folder.path(), "sphere", &scenes::sphere(3000, 1.0))?;
    let request = FrameRequest {
        structure: structure.map(str::to_owned),
        read_back: vec!["depth".into()],
        ..stages::window_frame(&scene, SIZE_PX, renderer)
    };
    let draw = |library: &Path| {
        let mut stage = stages::of_libraries(vec![library.to_owned()], use_device)?;
        stage
            .frame(&request)
            .with_context(|| format!("{}", library.display()))
    };
    let old = draw(&shipped)?;
    let new = draw(&plugins::sound()?)?;
    assert!(old.drawn_by.ends_with(renderer), "{} drew", old.drawn_by);
    assert!(old.stats.surfels_selected > 0);
    assert_eq!(old.stats.surfels_selected, new.stats.surfels_selected);
    assert_eq!(old.planes, new.planes);
    assert!(
        old.picture == new.picture,
        "the stored library draws another picture"
    );
    Ok(())
}

#[test]
fn an_old_cpu_renderer_draws() -> Result<()> {
    draw_alike("dots", None, false)
}

/// Its shaders read groups 0 and 1 as they were laid out then.
#[test]
fn an_old_gpu_renderer_draws() -> Result<()> {
    draw_alike("lit-points", None, true)
}

#[test]
fn an_old_structure_selects() -> Result<()> {
    draw_alike("dots", Some("halves"), false)
}
