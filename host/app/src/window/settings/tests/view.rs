use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use pointstage_engine::stage::{Background, Show};
use pointstage_scene::{Bounds, Camera, NearClipping};

use super::super::camera::CameraTab;
use super::super::view::{ViewTab, view_ui};
use super::{asking, assert_asked, choose};
use crate::window::intent::{Intent, Intents, ViewIntent};
use crate::window::navigation::NavigationOptions;
use crate::window::pacing::Pacing;
use crate::window::session::ViewOptions;
use crate::window::stage_link::legend_of;
use crate::window::views::StoredViews;

fn tab(view: ViewOptions) -> Harness<'static, Intents> {
    let targets = ["colour", "depth", "normal"].map(ToOwned::to_owned);
    asking(move |ui, asked| {
        let legend = legend_of(&view.show, Some([2.0, 1.0]));
        let tab = ViewTab {
            view: &view,
            pacing: Pacing::default(),
            camera: CameraTab {
                camera: &Camera::default(),
                near: NearClipping::default(),
                bounds: Bounds::EMPTY,
                options: &NavigationOptions::default(),
            },
            views: &StoredViews::default(),
            targets: &targets,
            legend: legend.as_ref(),
        };
        view_ui(ui, &tab, asked);
    })
}

#[test]
fn a_target_is_shown_with_its_legend() {
    let mut harness = tab(ViewOptions::default());
    choose(&mut harness, "Shows", "Depth");
    assert_asked(&harness, ViewIntent::Show(Show::Target("depth".into())));
    let harness = tab(ViewOptions {
        show: Show::Target("normal".into()),
        ..ViewOptions::default()
    });
    harness.get_by_label("towards the eye");
}

#[test]
fn the_exposure_is_a_factor_and_stops() {
    let mut harness = tab(ViewOptions::default());
    let slider = harness.get_by_role_and_label(Role::Slider, "Exposure");
    slider.set_value_accesskit(4.0);
    harness.run();
    let first = harness.state().first();
    assert_eq!(first, Some(&ViewIntent::Exposure(4.0).into()));

    let mut harness = tab(ViewOptions::default());
    let stops = harness.get_by_role_and_label(Role::SpinButton, "in stops");
    stops.set_value_accesskit(-1.0);
    harness.run();
    let Some(Intent::View(ViewIntent::Exposure(factor))) = harness.state().first() else {
        panic!("{:?}", harness.state())
    };
    assert!((factor - 0.5).abs() < 1e-6, "{factor}");
}

#[test]
fn factors_are_reset() {
    let mut harness = tab(ViewOptions {
        radius_scale: 3.0,
        ..ViewOptions::default()
    });
    harness.get_by_label("Reset Radius scale").click();
    harness.run();
    assert_asked(&harness, ViewIntent::RadiusScale(1.0));
}

#[test]
fn backgrounds_are_a_click_away() {
    let mut harness = tab(ViewOptions::default());
    harness.get_by_label("Black background").click();
    harness.run();
    assert_asked(
        &harness,
        ViewIntent::Background(Background::Solid([0.0; 3])),
    );
    let mut harness = tab(ViewOptions::default());
    choose(&mut harness, "Background", "transparent");
    assert_asked(&harness, ViewIntent::Background(Background::Transparent));
}
