//! Misbehaves while it is loaded, before the host has called anything: as the name of the file says that the examining
//! process was given.

/// What `export!` would embed.
#[used]
#[unsafe(link_section = ".ptstage")]
static MANIFEST: [u8; include_bytes!("../plugin.json").len()] = *include_bytes!("../plugin.json");

#[used]
#[unsafe(link_section = ".init_array")]
static ON_LOAD: extern "C" fn() = on_load;

extern "C" fn on_load() {
    // The loader opens a copy; the original's name is on the command line.
    let command_line = std::fs::read("/proc/self/cmdline").unwrap_or_default();
    let command_line = String::from_utf8_lossy(&command_line).into_owned();
    let asked = |fault: &str| command_line.contains(&format!("on-load-{fault}"));
    if asked("segfault") {
        let nowhere = std::ptr::without_provenance_mut::<u32>(8);
        // SAFETY: none; that is the point.
        unsafe { nowhere.write_volatile(1) };
    }
    if asked("abort") {
        std::process::abort();
    }
    if asked("exit") {
        std::process::exit(0);
    }
    if asked("hang") {
        loop {
            std::thread::sleep(std::time::Duration::from_secs(1));
        }
    }
}
