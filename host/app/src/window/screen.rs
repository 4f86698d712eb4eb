//! What one view has on the screen: its picture, what was asked for last, and how fast it comes.
//!
//! A pass takes over the pictures that have come, and asks for the next one of every view that shows something else than it
//! should. The stage draws for one view after the other.

use std::sync::Arc;
use std::time::{Duration, Instant};

use egui::Context;
use pointstage_engine::stage::{FrameResult, Role, ViewportId};
use pointstage_plugin_api::abi::Interaction;

use super::app::App;
use super::asking::{Asking, Look, Wish};
use super::comparison::FrameLog;
use super::frame_times::FrameTimes;
use super::pacing::Pacer;
use super::picture::{PictureTexture, Transition};
use super::roles::Roles;
use super::viewport::ViewportAnswer;

/// How often progress is shown while a task runs or a renderer is prepared.
pub(super) const PROGRESS_PERIOD: Duration = Duration::from_millis(100);

/// One view on the screen.
pub(crate) struct Screen {
    /// The stage's name for it.
    pub(crate) id: ViewportId,
    pub(crate) asking: Asking,
    pub(crate) roles: Roles,
    pub(crate) pacer: Pacer,
    pub(crate) frame_times: FrameTimes,
    /// What its last pictures took, part by part.
    pub(crate) frame_log: FrameLog,
    /// What its widget found out; none before it was shown, and while it is hidden.
    pub(crate) viewport: Option<ViewportAnswer>,
    pub(crate) picture: PictureTexture,
    /// The picture on the screen.
    pub(crate) shown: Option<Arc<FrameResult>>,
    /// The picture on the screen is not the last one of its look.
    refines: bool,
    /// When a picture last came or was asked for.
    last_turn: Instant,
}

impl Screen {
    /// A view without a picture.
    pub(crate) fn new(id: ViewportId) -> Self {
        Self {
            id,
            asking: Asking::default(),
            roles: Roles::default(),
            pacer: Pacer::default(),
            frame_times: FrameTimes::default(),
            frame_log: FrameLog::default(),
            viewport: None,
            picture: PictureTexture::default(),
            shown: None,
            refines: false,
            last_turn: Instant::now(),
        }
    }

    /// Whether its renderer or structure is being prepared.
    pub(crate) fn is_preparing(&self) -> bool {
        let shown = self.shown.as_ref();
        shown.is_some_and(|shown| shown.preparing.is_some())
    }

    /// Whether the picture on the screen is the final one of its look, and nothing moves or waits.
    pub(crate) fn is_at_rest(&self) -> bool {
        let is_still = |viewport: ViewportAnswer| viewport.interaction == Interaction::STILL;
        self.is_final()
            && self.viewport.is_some_and(is_still)
            && !self.roles.is_under_way()
            && !self.pacer.is_waiting()
            && !self.picture.is_fading()
    }

    /// Whether the picture is the final one of what was asked for.
    pub(crate) fn is_final(&self) -> bool {
        let is_final = |shown: &FrameResult| shown.preparing.is_none() && shown.progress >= 1.0;
        self.shown.as_deref().is_some_and(is_final)
    }

    /// When something changes by itself.
    pub(crate) fn next_change(&self, now: Instant) -> Option<Duration> {
        let changes = [
            self.roles.next_change(now),
            self.frame_times.next_change(now),
        ];
        changes.into_iter().flatten().min()
    }

    /// Learns from a picture of something that moved how large the next one may be.
    fn learn_pace(&mut self, result: &FrameResult, pacing: &super::pacing::Pacing) {
        let wish = self.asking.last_wish();
        let is_of_moving = wish.is_some_and(|wish| wish.interaction != Interaction::STILL);
        let Some(viewport) = self.viewport.filter(|_| is_of_moving) else {
            return;
        };
        if result.preparing.is_none() {
            let scale = result.picture.size_px[1] as f32 / viewport.size_px[1] as f32;
            let time = result.stats.total;
            self.pacer.took(pacing, &result.drawn_by, time, scale);
        }
    }
}

impl App {
    /// Takes over the newest picture of every view.
    pub(super) fn take_new_pictures(&mut self, ctx: &Context) {
        let now = Instant::now();
        for notice in self.stage.take_notices() {
            self.log.add(notice, now);
        }
        let active = self.screens.active_index();
        let is_zoomed = self.comparing.zoom.is_some();
        let views = self.session.panes.iter().zip(self.screens.iter_mut());
        for (index, (pane, screen)) in views.enumerate() {
            let known = screen.shown.as_ref();
            let Some(result) = self.stage.new_picture(screen.id, known) else {
                // A renderer that is being prepared is looked for now and then.
                screen.refines |=
                    screen.is_preparing() && screen.last_turn.elapsed() >= PROGRESS_PERIOD;
                continue;
            };
            screen.last_turn = now;
            let is_by_main = is_by(&pane.renderer, &result);
            let takes_over = is_by_main && screen.roles.main_is_there(now);
            if known.is_none_or(|shown| shown.drawn_by != result.drawn_by) {
                tracing::info!("view {}: drawn by {}", index + 1, result.drawn_by);
            }
            let transition = if takes_over && self.session.pacing.cross_fade {
                Transition::CrossFade
            } else {
                Transition::Cut
            };
            let picture = &result.picture;
            screen.picture.set(ctx, picture, transition, is_zoomed, now);
            screen.frame_times.note(result.stats.total, now);
            screen.frame_log.note(&result.stats, now);
            screen.learn_pace(&result, &self.session.pacing);
            if index == active {
                self.inspector.learn(&result);
                self.host_times.shown(&result.stats, now);
            }
            screen.refines = result.progress < 1.0 && result.preparing.is_none();
            screen.shown = Some(result);
        }
    }

    /// Whether a renderer or structure of any view is being prepared.
    pub(super) fn is_preparing(&self) -> bool {
        self.screens.iter().any(Screen::is_preparing)
    }

    /// Asks for the next picture of every view that needs one, and says whether any was asked for.
    pub(super) fn ask_for_pictures(&mut self, ctx: &Context) -> bool {
        let now = Instant::now();
        let mut any = false;
        for index in self.visible_views() {
            any |= self.ask_for_picture(ctx, index, now);
        }
        any
    }

    fn ask_for_picture(&mut self, ctx: &Context, index: usize, now: Instant) -> bool {
        let Some(wish) = self.wish(ctx, index, now) else {
            return false;
        };
        let Some(pane) = self.session.panes.get(index) else {
            return false;
        };
        let Some(screen) = self.screens.get_mut(index) else {
            return false;
        };
        let look = Look::new(&self.session.scene, pane, wish);
        if !screen.asking.is_due(&look, screen.refines) {
            return false;
        }
        if !screen.asking.is_urgent()
            && let Some(wait) = screen.pacer.wait(&self.session.pacing, now)
        {
            if wait != Duration::MAX {
                ctx.request_repaint_after(wait);
            }
            return false;
        }
        screen.refines = false;
        screen.last_turn = now;
        screen.pacer.asked(now);
        let request = screen.asking.request(look, &self.session.scene, screen.id);
        self.stage.submit(request);
        if index == self.screens.active_index() {
            self.host_times.asked();
        }
        true
    }

    /// What the user does with the camera of a view: with linked cameras, with that of any of them.
    fn interaction_of(&self, index: usize) -> Option<Interaction> {
        let own = self.screens.get(index)?.viewport?.interaction;
        if own != Interaction::STILL || !self.session.comparison.is_linked {
            return Some(own);
        }
        let all = self.screens.iter().filter_map(|screen| screen.viewport);
        let mut moving = all.map(|viewport| viewport.interaction);
        Some(moving.find(|other| *other != own).unwrap_or(own))
    }

    /// Who is to draw a view now, how large, and what for; `None` before it has a size and renderers are known.
    fn wish(&mut self, ctx: &Context, index: usize, now: Instant) -> Option<Wish> {
        let interaction = self.interaction_of(index)?;
        if interaction == Interaction::MOVING {
            // The pass after the last move asks for the still picture.
            ctx.request_repaint();
        }
        let is_pressed = ctx.input(|input| input.pointer.any_down());
        let pane = self.session.panes.get(index)?;
        let screen = self.screens.get_mut(index)?;
        let size_px = screen.viewport?.size_px;
        let role = screen.roles.choose(pane, interaction, is_pressed, now);
        let suitable = |id: &str| {
            let row = self.rows.renderer(id);
            row.filter(|row| row.obstacle.is_none())
        };
        let preview = pane.preview.as_deref().and_then(suitable);
        let preview = preview.filter(|_| role == Role::Preview);
        // A renderer that cannot draw this scene stays chosen, and another one stands in; its row says why.
        let row = preview
            .or_else(|| suitable(&pane.renderer))
            .or_else(|| self.rows.first_suitable())?;
        let role = preview.map_or(Role::Main, |_| role);
        // Between two moves a picture that is cheap to draw stays cheap.
        let pauses = screen.roles.is_moving()
            && (role == Role::Preview || self.session.pacing.target_rate.is_some());
        let is_moving = interaction != Interaction::STILL || pauses;
        let available = screen.shown.as_ref();
        let available = available.map_or(&[][..], |shown| shown.available_targets.as_slice());
        Some(Wish {
            renderer: row.id.clone(),
            role,
            size_px: if is_moving {
                screen.pacer.moving_size(&self.session.pacing, size_px)
            } else {
                size_px
            },
            interaction: match interaction {
                Interaction::STILL if pauses => Interaction::HELD,
                other => other,
            },
            time_budget: self
                .session
                .pacing
                .target_rate
                .filter(|_| is_moving)
                .map(|rate| Duration::from_secs(1) / rate.max(1)),
            read_back: if is_moving {
                Vec::new()
            } else {
                {
                    let needs_all = self.panels.inspector || self.comparing.panels.pixels;
                    self.inspector.read_back(needs_all, available)
                }
            },
        })
    }
}

/// Whether a picture is by the renderer of this key: an id, or an id with the build's hash.
fn is_by(key: &str, result: &FrameResult) -> bool {
    key.split(['#', '@']).next() == Some(&*result.drawn_by)
}
