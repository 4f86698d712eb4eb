//! What the machine must have besides a Rust toolchain, and how it gets it.
//!
//! A need is looked for by what the program would look for (a shared library, a Vulkan driver, a program on the path),
//! on any system. What is missing is installed by apt-get on Debian and its relatives when we may; elsewhere it is
//! named, and the caller decides whether to go on.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::{Outcome, paths, process};

/// What the work ahead asks of the machine beyond what building and drawing take.
#[derive(Clone, Copy)]
pub(crate) struct Needs {
    /// A window will be opened.
    pub(crate) window: bool,
    /// The tests will run, which open windows on a virtual display.
    pub(crate) tests: bool,
}

impl Needs {
    /// Nothing more: the program is run without a window.
    pub(crate) const NONE: Self = Self {
        window: false,
        tests: false,
    };
}

/// How a need is looked for.
enum Look {
    /// A shared library that the loader knows, by file name.
    Library(&'static str),
    /// A program on the path.
    Program(&'static str),
    /// Any Vulkan driver, by its description file.
    VulkanDriver,
}

struct Need {
    what: &'static str,
    look: Look,
    debian_package: &'static str,
}

const fn library(name: &'static str, debian_package: &'static str) -> Need {
    Need {
        what: name,
        look: Look::Library(name),
        debian_package,
    }
}

/// What the build itself takes beside the Rust toolchain and its C compiler: one dependency is in C++17. Windows has its
/// compiler where no path leads.
#[cfg(not(windows))]
const BUILDING: &[Need] = &[Need {
    what: "a C++ compiler",
    look: Look::Program("c++"),
    debian_package: "g++",
}];
#[cfg(windows)]
const BUILDING: &[Need] = &[];

const DRAWING: &[Need] = &[
    library("libvulkan.so.1", "libvulkan1"),
    // Mesa's drivers bring one for the CPU, so that a machine without a GPU draws too.
    Need {
        what: "a Vulkan driver",
        look: Look::VulkanDriver,
        debian_package: "mesa-vulkan-drivers",
    },
];

/// Opened by the window library while the program runs, so the linker does not miss them.
const WINDOW: &[Need] = &[
    library("libX11.so.6", "libx11-6"),
    library("libX11-xcb.so.1", "libx11-xcb1"),
    library("libxcb.so.1", "libxcb1"),
    library("libXcursor.so.1", "libxcursor1"),
    library("libXi.so.6", "libxi6"),
    library("libxkbcommon.so.0", "libxkbcommon0"),
    library("libxkbcommon-x11.so.0", "libxkbcommon-x11-0"),
];

const WAYLAND: &[Need] = &[library("libwayland-client.so.0", "libwayland-client0")];

const TESTS: &[Need] = &[
    Need {
        what: "Xvfb, a virtual display",
        look: Look::Program("Xvfb"),
        debian_package: "xvfb",
    },
    // Every renderer is tested over OpenGL too.
    library("libEGL.so.1", "libegl1"),
];

/// A test opens a report in a browser, and skips without one. Only the gate installs it: on a desk it is somebody's choice.
const BROWSER: Need = Need {
    what: "Chromium, a browser",
    look: Look::Program("chromium"),
    debian_package: "chromium",
};

/// Installs the browser where nobody minds and nothing depends on it.
fn set_up_browser() {
    let is_gate = std::env::var_os("CI").is_some();
    if !is_gate || missing(&[&BROWSER]).is_empty() || cfg!(not(target_os = "linux")) {
        return;
    }
    if let Err(message) = install(&[BROWSER.debian_package]) {
        process::say(&format!("{}: {message}; its test skips", BROWSER.what));
    }
}

/// Checks the machine and installs what is missing.
///
/// # Errors
/// When something is missing that could not be installed; the message says what, and how to get it.
pub(crate) fn set_up(needs: Needs) -> Outcome {
    process::say("checking what the machine has");
    let mut wanted: Vec<&Need> = BUILDING.iter().chain(DRAWING).collect();
    if needs.window || needs.tests {
        wanted.extend(WINDOW);
    }
    if needs.window && std::env::var_os("WAYLAND_DISPLAY").is_some() {
        wanted.extend(WAYLAND);
    }
    if needs.tests {
        wanted.extend(TESTS);
        set_up_browser();
    }
    let missing = missing(&wanted);
    if missing.is_empty() {
        return Ok(());
    }
    let names = missing
        .iter()
        .map(|need| need.what)
        .collect::<Vec<_>>()
        .join(", ");
    process::say(&format!("missing: {names}"));
    if !cfg!(target_os = "linux") {
        return Err(format!(
            "this machine lacks {names}; install your system's C++ compiler, and a graphics driver with Vulkan, Metal or Direct3D 12"
        ));
    }
    if process::output(Command::new("apt-get").arg("--version")).is_none() {
        return Err(format!(
            "this machine lacks {names}; install them with your system's package manager"
        ));
    }
    let packages: Vec<&str> = missing.iter().map(|need| need.debian_package).collect();
    install(&packages)?;
    let still = self::missing(&missing);
    if still.is_empty() {
        Ok(())
    } else {
        let names = still
            .iter()
            .map(|need| need.what)
            .collect::<Vec<_>>()
            .join(", ");
        Err(format!(
            "{names} still missing after the packages were installed"
        ))
    }
}

/// Gives `command` what the drivers and the window library expect of a session.
pub(crate) fn prepare_environment(command: &mut Command) -> Outcome {
    if std::env::var_os("XDG_RUNTIME_DIR").is_some() {
        return Ok(());
    }
    let folder = paths::target().join("xdg-runtime");
    std::fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        // The specification asks that nobody else can read it.
        std::fs::set_permissions(&folder, std::fs::Permissions::from_mode(0o700))
            .map_err(|error| format!("{}: {error}", folder.display()))?;
    }
    command.env("XDG_RUNTIME_DIR", folder);
    Ok(())
}

/// Holds `command` to Mesa's CPU driver where it is installed, so that pictures are the same on every machine.
pub(crate) fn hold_to_software_driver(command: &mut Command) {
    let drivers = vulkan_drivers();
    let software = drivers.iter().find(|path| {
        path.file_name()
            .is_some_and(|name| name.to_string_lossy().starts_with("lvp_"))
    });
    if let Some(path) = software {
        // The second is the name that loaders before 1.3.207 know.
        command
            .env("VK_DRIVER_FILES", path)
            .env("VK_ICD_FILENAMES", path);
    }
}

fn missing<'a>(needs: &[&'a Need]) -> Vec<&'a Need> {
    let libraries = known_libraries();
    let present = |need: &Need| match need.look {
        // A system that does not list its libraries gets the benefit of the doubt.
        Look::Library(name) => libraries.as_ref().is_none_or(|list| list.contains(name)),
        Look::Program(name) => on_path(name),
        Look::VulkanDriver => !cfg!(target_os = "linux") || !vulkan_drivers().is_empty(),
    };
    needs
        .iter()
        .copied()
        .filter(|need| !present(need))
        .collect()
}

/// The loader's own list of shared libraries, as text.
fn known_libraries() -> Option<String> {
    // An ordinary user's path often lacks /sbin.
    ["ldconfig", "/sbin/ldconfig", "/usr/sbin/ldconfig"]
        .iter()
        .find_map(|program| process::output(Command::new(program).arg("-p")))
}

fn on_path(program: &str) -> bool {
    let path = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&path).any(|folder| folder.join(program).is_file())
}

/// The driver descriptions that the Vulkan loader would read.
fn vulkan_drivers() -> Vec<PathBuf> {
    for name in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"] {
        if let Some(list) = std::env::var_os(name) {
            return std::env::split_paths(&list)
                .filter(|path| path.exists())
                .collect();
        }
    }
    let mut folders: Vec<PathBuf> = ["/usr/share", "/usr/local/share", "/etc"]
        .iter()
        .map(|folder| Path::new(folder).join("vulkan/icd.d"))
        .collect();
    if let Some(home) = std::env::var_os("HOME") {
        folders.push(Path::new(&home).join(".local/share/vulkan/icd.d"));
    }
    let files = folders
        .iter()
        .filter_map(|folder| std::fs::read_dir(folder).ok())
        .flatten()
        .filter_map(Result::ok);
    let mut drivers: Vec<PathBuf> = files
        .map(|file| file.path())
        .filter(|path| {
            path.extension()
                .is_some_and(|extension| extension == "json")
        })
        .collect();
    drivers.sort();
    drivers
}

/// Installs Debian packages, as root or by a sudo that asks for no password.
fn install(packages: &[&str]) -> Outcome {
    let by_hand = format!(
        "sudo apt-get install --no-install-recommends {}",
        packages.join(" ")
    );
    let root = process::output(Command::new("id").arg("-u")).is_some_and(|id| id.trim() == "0");
    let apt_get = |arguments: &[&str]| {
        let mut command = if root {
            Command::new("apt-get")
        } else {
            Command::new("sudo")
        };
        if !root {
            command.args(["-n", "DEBIAN_FRONTEND=noninteractive", "apt-get"]);
        }
        command
            .args(arguments)
            .env("DEBIAN_FRONTEND", "noninteractive")
            .stdin(std::process::Stdio::null());
        command
    };
    if !root && process::output(Command::new("sudo").args(["-n", "true"])).is_none() {
        return Err(format!(
            "this machine lacks packages, and installing them takes a password; please run\n  {by_hand}"
        ));
    }
    process::say(&format!("installing {}", packages.join(" ")));
    process::run("apt-get update", &mut apt_get(&["-q", "update"]))?;
    let mut command = apt_get(&["-q", "install", "--yes", "--no-install-recommends"]);
    command.args(packages);
    process::run("apt-get install", &mut command)
        .map_err(|message| format!("{message}\nTo try it by hand:\n  {by_hand}"))
}
