//! Looking at the window: waiting for what it should show, finding what to click on, taking pictures.

use std::time::{Duration, Instant};

use anyhow::{Result, bail};
use image::RgbaImage;

use super::state::{State, Widget};
use super::{Window, capture, wait_for};
use crate::golden;

/// How long a widget must stay where it is before it is clicked on.
const REST: Duration = Duration::from_millis(80);

impl Window {
    /// Waits until the window's state is one of which `accept` makes something, and returns that.
    ///
    /// # Errors
    /// When the program ends, or shows no such state in time; the message holds the last state and names a picture.
    pub fn wait_for_state<T>(
        &mut self,
        what: &str,
        mut accept: impl FnMut(&State) -> Option<T>,
    ) -> Result<T> {
        let found = wait_for(|| {
            self.must_run()?;
            Ok(self.state()?.as_ref().and_then(&mut accept))
        })?;
        if let Some(found) = found {
            return Ok(found);
        }
        bail!("waited in vain for {what}; {}", self.last_words()?)
    }

    /// Waits until the picture is the final one of what the session holds, and `accept` says yes to the state.
    ///
    /// # Errors
    /// As for [`Window::wait_for_state`].
    pub fn settle(&mut self, what: &str, accept: impl Fn(&State) -> bool) -> Result<State> {
        self.wait_for_state(what, |state| {
            (state.is_settled() && accept(state)).then(|| state.clone())
        })
    }

    /// Waits for the widget of this role and name that can be used, and returns it.
    ///
    /// # Errors
    /// As for [`Window::wait_for_state`].
    pub fn find(&mut self, role: &str, name: &str) -> Result<Widget> {
        self.wait_for_state(&format!("a {role} '{name}'"), |state| {
            state.widget(role, name).filter(|widget| widget.is_enabled)
        })
    }

    /// Clicks at the middle of the widget of this role and name, once it is there and rests.
    ///
    /// # Errors
    /// As for [`Window::wait_for_state`].
    pub fn click_on(&mut self, role: &str, name: &str) -> Result<()> {
        let (place, releases) = self.rest_on(role, name)?;
        self.click(place.0, place.1, 1)?;
        // The window takes all that came since its last pass to be where the pointer is by then: it must not move on before.
        self.wait_for_state("the click", |state| {
            (state.releases() > releases).then_some(())
        })
    }

    /// Clicks on a field for text or a number, waits until it has the keyboard, and puts `text` in the place of its content,
    /// as a person who then goes on with Tab or Enter.
    ///
    /// # Errors
    /// As for [`Window::wait_for_state`], and for [`Window::type_text`].
    pub fn type_into(&mut self, role: &str, name: &str, text: &str) -> Result<()> {
        self.click_on(role, name)?;
        self.wait_for_state(&format!("the keyboard in '{name}'"), |state| {
            let field = state.widget(role, name)?;
            field.is_focused.then_some(())
        })?;
        self.press_keys("ctrl+a")?;
        self.type_text(text)
    }

    /// Drags the handle of the slider of this name from the slider's middle to `part` of its length (0 left end, 1 right end)
    /// and back, and so on, until `accept` says yes to the state.
    ///
    /// # Errors
    /// As for [`Window::wait_for_state`].
    pub fn drag_slider(
        &mut self,
        name: &str,
        part: f32,
        accept: impl FnMut(&State) -> bool,
    ) -> Result<()> {
        let (from, _) = self.rest_on("Slider", name)?;
        let [left, _, right, _] = self.find("Slider", name)?.rect.map(f32::from);
        // Both ends are within it.
        let to = left + 2.0 + part * (right - left - 4.0);
        self.drag_until(from, (to as i16, from.1), 1, accept)
    }

    /// Moves the pointer to the middle of the widget of this role and name, and stays until the window has seen it there and
    /// the widget rests: a panel that grows or scrolls takes it away meanwhile. Returns the place, and how many buttons went
    /// up so far.
    fn rest_on(&mut self, role: &str, name: &str) -> Result<((i16, i16), Option<u64>)> {
        let mut sent_to = None;
        let mut seen_since: Option<Instant> = None;
        let found = wait_for(|| {
            self.must_run()?;
            let Some(state) = self.state()? else {
                return Ok(None);
            };
            let widget = state.widget(role, name);
            let Some(widget) = widget.filter(|widget| widget.is_enabled) else {
                return Ok(None);
            };
            let (x, y) = widget.middle();
            if sent_to != Some((x, y)) {
                self.point_at(x, y)?;
                sent_to = Some((x, y));
                seen_since = None;
            } else if state.has_pointer_at(x, y) {
                let since = *seen_since.get_or_insert_with(Instant::now);
                return Ok((since.elapsed() >= REST).then(|| ((x, y), state.releases())));
            }
            Ok(None)
        })?;
        match found {
            Some(found) => Ok(found),
            None => bail!(
                "waited in vain for a {role} '{name}' that rests; {}",
                self.last_words()?
            ),
        }
    }

    /// The part of the display that the picture takes.
    ///
    /// # Errors
    /// As for [`Window::wait_for_state`].
    pub fn capture_picture(&mut self) -> Result<RgbaImage> {
        let [left, top, right, bottom] = self.find("Image", "Picture")?.rect.map(i32::from);
        let sides = [left, top, right - left, bottom - top];
        let [x, y, width, height] = sides.map(|side| u32::try_from(side).unwrap_or_default());
        let all = self.capture()?;
        Ok(image::imageops::crop_imm(&all, x, y, width, height).to_image())
    }

    /// For the message of a test that failed: a file with what the display shows, the program's log, and its state.
    pub(super) fn last_words(&self) -> Result<String> {
        let name = format!("failed_{}.png", self.child.id());
        let picture = golden::output_folder().join("window").join(name);
        golden::write(&self.capture()?, &picture)?;
        let state = self
            .state()?
            .map_or_else(String::new, |state| state.describe());
        Ok(format!(
            "see {}; the program said:\n{}\nand showed:\n{state}",
            picture.display(),
            self.said()
        ))
    }

    pub(super) fn state(&self) -> Result<Option<State>> {
        State::read(&self.state_path)
    }

    /// What the display shows now.
    ///
    /// # Errors
    /// When the display is gone.
    pub fn capture(&self) -> Result<RgbaImage> {
        capture::capture(&self.connection, self.root)
    }

    /// Waits until the part of the display with the picture is one of which `accept` says yes, and returns it.
    ///
    /// # Errors
    /// When it never is; the message names a file with what the display showed last.
    pub fn wait_for_picture(
        &mut self,
        what: &str,
        mut accept: impl FnMut(&RgbaImage) -> bool,
    ) -> Result<RgbaImage> {
        let found = wait_for(|| {
            self.must_run()?;
            let picture = self.capture_picture()?;
            Ok(accept(&picture).then_some(picture))
        })?;
        match found {
            Some(picture) => Ok(picture),
            None => bail!(
                "waited in vain for the picture '{what}'; {}",
                self.last_words()?
            ),
        }
    }
}
