//! Carries out intents about the window itself.

use egui::{Context, ViewportCommand};

use crate::window::app::App;
use crate::window::intent::{Part, Tab, WindowIntent};
use crate::window::theme;

impl App {
    pub(super) fn apply_window(&mut self, ctx: &Context, intent: WindowIntent) {
        match intent {
            WindowIntent::Quit => ctx.send_viewport_cmd(ViewportCommand::Close),
            WindowIntent::Toggle(part) => self.toggle(part),
            WindowIntent::ChooseTab(tab) => {
                self.panels.settings = true;
                self.panels.tab = tab;
            }
            WindowIntent::FocusSetting(id) => {
                self.panels.settings = true;
                self.panels.tab = Tab::Renderer;
                self.focus_setting = Some(id);
            }
            WindowIntent::Theme(theme) => ctx.set_theme(theme),
            WindowIntent::TextScale(scale) => theme::set_text_scale(ctx, scale),
            WindowIntent::Copy(text) => ctx.copy_text(text),
            WindowIntent::Dismiss(id) => self.log.dismiss(id),
            WindowIntent::ClearLog => self.log.clear(),
        }
    }

    fn toggle(&mut self, part: Part) {
        let panel = match part {
            Part::Settings => &mut self.panels.settings,
            Part::Log => &mut self.panels.log,
            Part::Inspector => {
                // A surfel that nobody sees would have every target read back with each picture.
                self.inspector.unpin();
                &mut self.panels.inspector
            }
            Part::Path => &mut self.panels.path,
            Part::Palette => return self.palette.toggle(),
            Part::Keys => &mut self.panels.keys,
            Part::About => &mut self.panels.about,
        };
        *panel = !*panel;
    }
}
