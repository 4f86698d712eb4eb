//! Carries out intents about the eye, and moves it on from pass to pass.

use egui::Context;
use pointstage_scene::{Bounds, NearClipping};

use crate::window::app::App;
use crate::window::intent::CameraIntent;
use crate::window::navigation::{CameraMove, NavigationOptions, Surroundings};

impl App {
    pub(super) fn apply_camera(&mut self, intent: CameraIntent) {
        let around = self.surroundings();
        let camera = &mut self.session.panes.active.camera;
        match intent {
            CameraIntent::Move(camera_move) => {
                self.navigator.carry_out(camera, camera_move, &around);
            }
            CameraIntent::PivotAt(point) => {
                let pivot_at = CameraMove::PivotAt(point);
                self.navigator.carry_out(camera, pivot_at, &around);
            }
            CameraIntent::Glide(glide) => self.navigator.glide(glide),
            CameraIntent::Stop => self.navigator.stop(camera, &around),
            CameraIntent::Project(projection) => {
                self.navigator.stop(camera, &around);
                camera.projection = projection;
                camera.fit_depth_clipped(&around.bounds, around.near);
            }
            CameraIntent::Near(near) => {
                self.session.panes.active.near = near;
                self.navigator.stop(camera, &around);
                camera.fit_depth_clipped(&around.bounds, near);
            }
            CameraIntent::Options(options) => self.set_navigation(options),
            CameraIntent::FlySpeed(factor) => {
                self.session.navigation = self.session.navigation.with_speed_times(factor);
            }
            CameraIntent::ToggleTurntable => self.set_navigation(NavigationOptions {
                turntable: !around.turntable,
                ..self.session.navigation
            }),
        }
    }

    /// A turntable that is locked again levels the horizon.
    fn set_navigation(&mut self, options: NavigationOptions) {
        let is_locked_again = options.turntable && !self.session.navigation.turntable;
        self.session.navigation = options;
        if is_locked_again {
            let level = CameraMove::Level(self.navigator.level_axis());
            let around = self.surroundings();
            self.navigator
                .carry_out(&mut self.session.panes.active.camera, level, &around);
        }
    }

    /// Shows the whole of a scene that has just come, at once.
    pub(in crate::window) fn frame_new_scene(&mut self) {
        self.session.panes.active.near = NearClipping::Automatic;
        let around = Surroundings {
            flights: false,
            ..self.surroundings()
        };
        self.navigator.carry_out(
            &mut self.session.panes.active.camera,
            CameraMove::Frame,
            &around,
        );
        self.framed = Some(self.session.panes.active.camera);
    }

    /// Whether the camera still stands where it shows the whole of the scene that came last.
    pub(in crate::window) fn is_framed(&self) -> bool {
        self.framed == Some(self.session.panes.active.camera)
    }

    /// Moves a camera on that is on its way by itself, at the beginning of a pass.
    pub(in crate::window) fn advance_camera(&mut self, ctx: &Context) {
        let now = ctx.input(|input| input.time);
        let around = self.surroundings();
        let has_moved = self
            .navigator
            .advance(&mut self.session.panes.active.camera, now, &around);
        if has_moved {
            // The next step, or after the last one the picture of a camera that rests.
            ctx.request_repaint();
        }
    }

    /// Whether letters fly, since the right button is held over the picture.
    pub(in crate::window) fn is_flying(&self) -> bool {
        self.screens
            .active
            .viewport
            .is_some_and(|viewport| viewport.is_flying)
    }

    /// What moves of the camera depend on.
    pub(in crate::window) fn surroundings(&self) -> Surroundings {
        let session = &self.session;
        let aspect = self.screens.active.viewport.map_or(1.5, |viewport| {
            f64::from(viewport.size_px[0]) / f64::from(viewport.size_px[1])
        });
        let selected = session.scene.objects().iter();
        let selected = selected.filter(|object| object.selected && object.visible);
        Surroundings {
            bounds: session.scene.bounds_world(),
            framed: session.scene.framed_world(),
            selection: selected.fold(Bounds::EMPTY, |bounds, object| {
                bounds.union(object.framed_world())
            }),
            aspect,
            turntable: session.navigation.turntable,
            flights: session.navigation.flights,
            up_axis: self.navigator.level_axis(),
            near: session.panes.active.near,
        }
    }
}
