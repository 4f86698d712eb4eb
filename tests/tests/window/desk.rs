//! The program with its window, and what its pictures are asked.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, bail, ensure};
use image::RgbaImage;
use pointstage_tests::compare::{Difference, compare};
use pointstage_tests::program::Program;
use pointstage_tests::scenes;
use pointstage_tests::window::{Display, Widget, Window};

/// The renderer that draws at first.
pub(super) const POINTS: &str = "org.pointstage.points";

/// Size of the display and the window, px: the settings fit without scrolling.
const SIZE: (u16, u16) = (1100, 720);

/// The program, its window, and files for it. The display goes last.
pub(super) struct Desk {
    pub(super) window: Window,
    pub(super) program: Program,
    _display: Display,
}

impl Desk {
    /// Opens the window with a sphere on the stage. `None` where there is no virtual display.
    pub(super) fn with_sphere() -> Result<Option<Self>> {
        let program = Program::find()?;
        let sphere = sphere(program.home())?;
        let Some(mut desk) = Self::open(program, &[sphere.as_os_str()])? else {
            return Ok(None);
        };
        desk.window.settle("the sphere", |state| {
            state.objects() == ["sphere"] && state.session("drawn_by") == POINTS
        })?;
        Ok(Some(desk))
    }

    /// Opens the window of `program`, which gets `arguments`. `None` where there is no virtual display.
    pub(super) fn open(program: Program, arguments: &[&OsStr]) -> Result<Option<Self>> {
        Self::open_at(program, arguments, SIZE)
    }

    /// Opens the window on a display of this size, px.
    pub(super) fn open_at(
        program: Program,
        arguments: &[&OsStr],
        (width, height): (u16, u16),
    ) -> Result<Option<Self>> {
        let Some(display) = Display::start(width, height)? else {
            return Ok(None);
        };
        let window = Window::open(&display, &program, arguments)?;
        window.resize(u32::from(width), u32::from(height))?;
        Ok(Some(Self {
            window,
            program,
            _display: display,
        }))
    }

    /// Waits until the display shows a picture that `accept` says yes to.
    pub(super) fn wait_for_picture(
        &mut self,
        what: &str,
        accept: impl Fn(&RgbaImage) -> bool,
    ) -> Result<RgbaImage> {
        self.window.wait_for_picture(what, accept)
    }

    /// Turns the scene with the pointer.
    pub(super) fn turn(&mut self) -> Result<()> {
        let before = self
            .window
            .wait_for_state("a view", |state| Some(state.session("view").clone()))?;
        self.window.drag_until((370, 360), (470, 420), 1, |state| {
            *state.session("view") != before
        })
    }

    /// Turns the wheel over the settings until the widget is where it can be clicked on, and returns it.
    pub(super) fn scroll_settings_to(&mut self, role: &str, name: &str) -> Result<Widget> {
        let (width, height) = (SIZE.0.cast_signed(), SIZE.1.cast_signed());
        // The menu and the tabs above, the status bar below.
        let (top, bottom) = (62, height - 30);
        for _ in 0..30 {
            let widget = self.window.find(role, name)?;
            let (_, middle) = widget.middle();
            let clicks = match middle {
                middle if middle > bottom => -1,
                middle if middle < top => 1,
                _ => return Ok(widget),
            };
            self.window.scroll(width - 60, height / 2, clicks)?;
            self.window
                .wait_for_state("the settings to scroll", |state| {
                    let moved = state.widget(role, name)?.rect != widget.rect;
                    moved.then_some(())
                })?;
            // The toolkit scrolls on for some passes.
            self.window.settle("the settings to rest", |_| true)?;
        }
        bail!("{role} '{name}' does not come into sight")
    }

    /// The file menu's way: the field for a path, typed to and entered.
    pub(super) fn type_path(&mut self, path: &Path) -> Result<()> {
        self.window.click_on("Button", "File")?;
        self.window.click_on("Button", "Open path… Ctrl+Shift+O")?;
        self.window.find("TextInput", "Path of a file:")?;
        self.window.type_text(
            path.to_str()
                .context("temporary folders have plain names")?,
        )?;
        self.window.wait_for_state("the typed path", |state| {
            let field = state.widget("TextInput", "Path of a file:")?;
            (field.value == path.to_str()?).then_some(())
        })?;
        self.window.press_keys("Return")
    }

    /// Ends the session as a person would, and asks that it ends well.
    pub(super) fn close(self) -> Result<()> {
        self.close_and_keep().map(drop)
    }

    /// The same; the program's files stay, so that it can be started again where it was.
    pub(super) fn close_and_keep(self) -> Result<Program> {
        let said = self.window.said();
        let status = self.window.close()?;
        ensure!(status.success(), "{status}; it said:\n{said}");
        Ok(self.program)
    }
}

/// A small coloured sphere, `sphere.ply` in `folder`.
pub(super) fn sphere(folder: &Path) -> Result<PathBuf> {
    scenes::write(folder, "sphere", &scenes::sphere(3000, 1.0))
}

/// Pixels of a colour: the scenes are coloured, the background is nearly grey.
pub(super) fn coloured(picture: &RgbaImage) -> usize {
    let is_coloured = |pixel: &image::Rgba<u8>| {
        let [red, green, blue, _] = pixel.0;
        red.max(green).max(blue) - red.min(green).min(blue) > 40
    };
    picture.pixels().filter(|pixel| is_coloured(pixel)).count()
}

/// How far two pictures are apart.
pub(super) fn difference(a: &RgbaImage, b: &RgbaImage) -> Difference {
    compare(a, b).expect("the picture keeps its place in the window")
}

/// Whether two pictures show the same: a frame around the one that has the keyboard is allowed for.
pub(super) fn same(a: &RgbaImage, b: &RgbaImage) -> bool {
    difference(a, b).psnr_db > 30.0
}
