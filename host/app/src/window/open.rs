//! Opens the window, or says why none can be opened.

use std::path::PathBuf;
use std::sync::Arc;

use eframe::NativeOptions;
use egui::ViewportBuilder;
use egui_wgpu::{WgpuSetup, WgpuSetupCreateNew};

use super::app::{App, Start};
use super::stage_link::StageLink;
use super::theme;
use super::ui_state::UiState;
use crate::cli::{Failure, Globals, Outcome};
use crate::preferences;

/// Size of a new window, points: fits a small laptop's screen.
const FIRST_SIZE: [f32; 2] = [1280.0, 800.0];

/// Opens the window with `files`; returns when it is closed.
pub(crate) fn open(globals: &Globals, files: Vec<PathBuf>) -> Outcome {
    let state_folder = globals.state_folder();
    let preferences = preferences::open(&state_folder);
    let options = NativeOptions {
        viewport: ViewportBuilder::default()
            .with_title("Pointstage")
            .with_app_id("pointstage")
            .with_inner_size(FIRST_SIZE)
            .with_min_inner_size([640.0, 400.0])
            .with_drag_and_drop(true),
        wgpu_options: egui_wgpu::WgpuConfiguration {
            wgpu_setup: toolkit_setup(globals),
            ..egui_wgpu::WgpuConfiguration::default()
        },
        persistence_path: Some(state_folder.join("window.ron")),
        ..NativeOptions::default()
    };
    let stage_options = globals.stage_options();
    let create = move |context: &eframe::CreationContext<'_>| {
        theme::apply(&context.egui_ctx);
        if let Some(ui_state) = UiState::from_environment() {
            context.egui_ctx.add_plugin(ui_state);
        }
        let repaint = context.egui_ctx.clone();
        let wake: Arc<dyn Fn() + Send + Sync> = Arc::new(move || repaint.request_repaint());
        let mut app = App::new(Start {
            stage: StageLink::start(stage_options, &wake)?,
            wake,
            files,
            samples: samples(),
        })?;
        app.remember(preferences)?;
        tracing::info!("window opened");
        Ok(Box::new(app) as Box<dyn eframe::App>)
    };
    eframe::run_native("Pointstage", options, Box::new(create)).map_err(|error| no_window(&error))
}

/// The toolkit's own device, apart from the engine's. It gets the adapter's limits: the default asks GL for a browser's.
fn toolkit_setup(globals: &Globals) -> WgpuSetup {
    let mut setup = WgpuSetupCreateNew::without_display_handle();
    if let Some(backends) = globals.toolkit_backends() {
        setup.instance_descriptor.backends = backends;
    }
    setup.device_descriptor = Arc::new(|adapter| egui_wgpu::wgpu::DeviceDescriptor {
        label: Some("window"),
        required_limits: adapter.limits(),
        ..egui_wgpu::wgpu::DeviceDescriptor::default()
    });
    WgpuSetup::CreateNew(setup)
}

/// Models that come with the program: beside it, or in the project that it was built in.
fn samples() -> Vec<PathBuf> {
    let Ok(program) = std::env::current_exe() else {
        return Vec::new();
    };
    let folder = program
        .ancestors()
        .skip(1)
        .map(|folder| folder.join("sample-data"))
        .find(|folder| folder.is_dir());
    let Some(Ok(entries)) = folder.map(std::fs::read_dir) else {
        return Vec::new();
    };
    let mut files: Vec<PathBuf> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|extension| extension == "ply"))
        .collect();
    files.sort();
    files
}

/// Why no window opens, and what to do.
fn no_window(error: &eframe::Error) -> Failure {
    let has_display = ["DISPLAY", "WAYLAND_DISPLAY"]
        .iter()
        .any(|name| std::env::var_os(name).is_some_and(|value| !value.is_empty()));
    // The toolkit's own words for this are of no use to anybody who is not its author.
    if cfg!(target_os = "linux") && !has_display {
        return Failure::Failed(anyhow::anyhow!(
            "no window can be opened: there is no display (neither DISPLAY nor WAYLAND_DISPLAY is set); run it in a desktop session or under 'xvfb-run', or draw without a window: pointstage render FILE --out picture.png"
        ));
    }
    if matches!(error, eframe::Error::Wgpu(_)) {
        tracing::debug!("the window's toolkit says: {error}");
        return Failure::Failed(anyhow::anyhow!(
            "no window can be opened: no graphics adapter can draw one; install a driver (on Debian: apt install mesa-vulkan-drivers), or draw without a window: pointstage render FILE --no-device --out picture.png"
        ));
    }
    Failure::Failed(anyhow::anyhow!(
        "no window can be opened: {error}; check that the display server runs and that this user may use it, or draw without a window: pointstage render FILE --out picture.png"
    ))
}
