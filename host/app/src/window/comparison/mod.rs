//! Views beside each other: what they share, how they are laid over each other, and how far they are apart.
//!
//! [`Comparison`] is what the user chose and [`Comparing`] what is on the screen of it. After the intents of a pass,
//! `follow_active` gives the other views what they share with the active one ([`lock`]); when all pictures rest, the
//! [`measurer`] gets them on a thread of its own and answers with metrics and a difference picture. [`mod@cells`] says where
//! views stand, [`overlay`] paints wipe, flicker and difference, [`zoom`] enlarges the same pixels in all of them,
//! [`pixels`] lists what is at one ray in each, [`times`] plots what pictures cost, and [`why`] lists what the views differ
//! in. [`sweep`] shows the curve that `pointstage sweep` wrote, and takes over the point that is clicked.

mod cells;
mod frame_log;
mod lock;
mod measurer;
mod overlay;
mod pixels;
mod sweep;
mod times;
mod why;
pub(crate) mod zoom;

use std::sync::Arc;

use egui::Context;
use pointstage_engine::stage::FrameResult;

use super::app::App;

pub(crate) use cells::{Cell, borders, cells, split_at};
pub(crate) use frame_log::{FrameLog, Spread, spread};
pub(crate) use lock::{share, unmet};
pub(crate) use measurer::{Answer, Measurer, Numbers, Order};
pub(crate) use overlay::{difference_legend, wipe_handle_ui};
pub(crate) use pixels::{Place, pixels_ui};
pub(crate) use sweep::{SweepPanel, sweep_ui};
pub(crate) use times::times_ui;
pub(crate) use why::rows as why_rows;
pub(crate) use zoom::Zoom;

/// The slowest and the fastest flicker, changes a second. Faster ones are a danger to people with photosensitive epilepsy
/// (WCAG 2.2, success criterion 2.3.1: at most three flashes a second).
pub(crate) const FLICKER_HZ: std::ops::RangeInclusive<f32> = 0.25..=3.0;

/// How views are compared.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Comparison {
    /// Whether all cameras are one.
    pub(crate) is_linked: bool,
    /// Whether all views share what is not the renderer's own: the fair-compare lock.
    pub(crate) is_locked: bool,
    /// How they are laid out.
    pub(crate) way: Way,
    /// Changes a second of the flicker.
    pub(crate) flicker_hz: f32,
    /// The view that the others are measured against, from 0.
    pub(crate) against: usize,
    /// Whether views are measured when they rest.
    pub(crate) measures: bool,
    /// Where the views' borders are, as parts of width and height; the middle under the lock.
    pub(crate) split: [f32; 2],
}

impl Default for Comparison {
    fn default() -> Self {
        Self {
            is_linked: true,
            is_locked: false,
            way: Way::Grid,
            flicker_hz: 1.0,
            against: 0,
            measures: true,
            split: [0.5; 2],
        }
    }
}

/// How two or more views share the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Way {
    /// Beside each other.
    Grid,
    /// The reference left of a handle, the other one right of it.
    Wipe,
    /// One after the other in the same place.
    Flicker,
    /// What they differ in.
    Difference(Measure),
}

/// What a difference picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Measure {
    /// |a − b| of each channel, brightened.
    Absolute,
    /// Mean of the channels' differences: blue where the view is darker than the reference, red where it is brighter.
    Signed,
    /// How visible the difference is (Andersson et al., *FLIP*, 2020).
    Flip,
}

impl Way {
    /// All, with their names.
    pub(crate) const ALL: [(Self, &'static str); 6] = [
        (Self::Grid, "Grid"),
        (Self::Wipe, "Wipe"),
        (Self::Flicker, "Flicker"),
        (Self::Difference(Measure::Absolute), "Absolute difference"),
        (Self::Difference(Measure::Signed), "Signed difference"),
        (Self::Difference(Measure::Flip), "FLIP difference"),
    ];

    /// Its name.
    pub(crate) fn name(self) -> &'static str {
        let found = Self::ALL.iter().find(|(way, _)| *way == self);
        found.map_or("", |(_, name)| name)
    }

    /// Whether two views stand in one place.
    pub(crate) fn is_of_pair(self) -> bool {
        self != Self::Grid
    }

    /// A stable word for files.
    pub(crate) fn key(self) -> &'static str {
        match self {
            Self::Grid => "grid",
            Self::Wipe => "wipe",
            Self::Flicker => "flicker",
            Self::Difference(Measure::Absolute) => "absolute",
            Self::Difference(Measure::Signed) => "signed",
            Self::Difference(Measure::Flip) => "flip",
        }
    }
}

impl Comparison {
    /// The two views that stand in one place: the one that is measured against, and the active one or, if that is the same,
    /// the next one. `None` for a single view.
    pub(crate) fn pair(&self, count: usize, active: usize) -> Option<[usize; 2]> {
        if count < 2 {
            return None;
        }
        let against = self.against.min(count - 1);
        let other = if active == against {
            (against + 1) % count
        } else {
            active
        };
        Some([against, other])
    }

    /// The views on the screen.
    pub(crate) fn visible(&self, count: usize, active: usize) -> Vec<usize> {
        match self.pair(count, active) {
            Some(pair) if self.way.is_of_pair() => pair.to_vec(),
            _ => (0..count).collect(),
        }
    }
}

/// What comparing has on the screen.
pub(crate) struct Comparing {
    /// Where the wipe's handle is, as a part of the width.
    pub(crate) wipe: f32,
    /// The part of the pictures that is enlarged; none for all of them in their own size.
    pub(crate) zoom: Option<Zoom>,
    /// Where the pointer is in whichever view, as parts of its width and height.
    pub(crate) pointer: Option<[f32; 2]>,
    /// Which panels are open.
    pub(crate) panels: ComparePanels,
    /// The curve of a sweep, if one was opened.
    pub(crate) sweep: Option<SweepPanel>,
    /// The next name for a view.
    next_screen: u32,
    measurer: Measurer,
    /// What was measured last, with what it was measured of.
    pub(crate) answer: Option<Answer>,
    /// The difference as a texture.
    pub(crate) difference: Option<egui::TextureHandle>,
}

/// Panels about views beside each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct ComparePanels {
    /// Frame times and memory of each view.
    pub(crate) times: bool,
    /// What the views differ in.
    pub(crate) why: bool,
    /// What is at one pixel of each.
    pub(crate) pixels: bool,
}

impl Comparing {
    /// Nothing on the screen yet.
    ///
    /// # Errors
    /// The system gives no thread to measure on.
    pub(crate) fn new(wake: &Arc<dyn Fn() + Send + Sync>) -> std::io::Result<Self> {
        Ok(Self {
            wipe: 0.5,
            zoom: None,
            pointer: None,
            panels: ComparePanels::default(),
            sweep: None,
            next_screen: 1,
            measurer: Measurer::start(Arc::clone(wake))?,
            answer: None,
            difference: None,
        })
    }

    /// A name for one more view.
    pub(super) fn name_screen(&mut self) -> pointstage_engine::stage::ViewportId {
        self.next_screen += 1;
        pointstage_engine::stage::ViewportId(self.next_screen - 1)
    }

    /// The numbers of a view, if they are of the picture on its screen.
    pub(crate) fn numbers(&self, shown: Option<&Arc<FrameResult>>) -> Option<&Numbers> {
        let (answer, shown) = (self.answer.as_ref()?, shown?);
        answer.numbers_of(shown)
    }

    /// Whether something is being measured.
    pub(crate) fn is_measuring(&self) -> bool {
        self.measurer.is_busy()
    }
}

impl App {
    /// The views on the screen.
    pub(super) fn visible_views(&self) -> Vec<usize> {
        let panes = &self.session.panes;
        let comparison = &self.session.comparison;
        comparison.visible(panes.count(), panes.active_index())
    }

    /// Gives the other views what they share with the active one.
    pub(super) fn follow_active(&mut self) {
        share(&mut self.session, &self.rows);
    }

    /// Measures when every picture rests, and takes over what was measured.
    pub(super) fn compare(&mut self, ctx: &Context) {
        if let Some(answer) = self.comparing.measurer.take() {
            self.comparing.difference = answer.difference.as_ref().map(|image| {
                let options = egui::TextureOptions::NEAREST;
                ctx.load_texture("difference", image.clone(), options)
            });
            self.comparing.answer = Some(answer);
            // It came too late to be shown in this pass.
            ctx.request_repaint();
        }
        let Some(order) = self.order() else { return };
        let is_known = self
            .comparing
            .answer
            .as_ref()
            .is_some_and(|answer| answer.order.is_same(&order));
        if !is_known {
            self.comparing.measurer.order(order);
        }
    }

    /// What is to be measured now; nothing while something moves or waits.
    fn order(&self) -> Option<Order> {
        let comparison = &self.session.comparison;
        let (count, active) = (
            self.session.panes.count(),
            self.session.panes.active_index(),
        );
        let [against, other] = comparison.pair(count, active)?;
        let wants_difference = matches!(comparison.way, Way::Difference(_));
        if !comparison.measures && !wants_difference {
            return None;
        }
        let visible = self.visible_views();
        let views: Vec<Arc<FrameResult>> = visible
            .iter()
            .map(|index| {
                let screen = self.screens.get(*index)?;
                let is_still =
                    screen.is_at_rest() && !self.navigator.is_moving() && !self.player.is_playing();
                screen.shown.clone().filter(|_| is_still)
            })
            .collect::<Option<_>>()?;
        let at = |index: usize| visible.iter().position(|seen| *seen == index);
        Some(Order {
            reference: at(against)?,
            difference: match comparison.way {
                Way::Difference(measure) => Some((at(other)?, measure)),
                _ => None,
            },
            measures: comparison.measures,
            views,
        })
    }
}
