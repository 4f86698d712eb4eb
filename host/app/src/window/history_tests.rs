use std::sync::Arc;

use glam::DVec3;
use pointstage_engine::stage::{SettingValue, Show};
use pointstage_scene::{Block, Geometry, Object, Origins};
use proptest::prelude::*;

use super::*;
use crate::window::presets;

const OWNER: &str = "org.example.points";

fn object(name: &str) -> Object {
    let block = Block {
        position_radius: Arc::from([[0.0, 0.0, 0.0, 1.0]]),
        ..Block::default()
    };
    Object::new(
        name,
        DVec3::ZERO,
        Geometry::new(vec![block], None, Origins::default()),
    )
}

fn session() -> Session {
    let mut session = Session::new(OWNER.to_owned());
    session.edit_scene(|scene| {
        scene.add(object("a"));
        scene.add(object("b"));
    });
    session
}

fn set(session: &mut Session, id: &str, value: f64) {
    let values = session
        .panes
        .active
        .settings
        .entry(OWNER.into())
        .or_default();
    values.insert(id.into(), SettingValue::Float(value));
}

/// A history that has seen the session, its clock, and the session.
struct Desk {
    history: History,
    session: Session,
    now: Instant,
    is_held: bool,
}

impl Desk {
    fn new(session: Session) -> Self {
        let mut desk = Self {
            history: History::default(),
            session,
            now: Instant::now(),
            is_held: false,
        };
        desk.pass(Duration::ZERO);
        desk
    }

    /// One pass of the window, `wait` after the last.
    fn pass(&mut self, wait: Duration) {
        self.now += wait;
        let rows = Rows::default();
        self.history
            .note(&self.session, &rows, self.is_held, self.now);
    }

    fn set(&mut self, id: &str, value: f64, wait: Duration) {
        set(&mut self.session, id, value);
        self.pass(wait);
    }

    fn steps(&self) -> usize {
        self.history.done.len()
    }

    fn undo(&mut self) -> Option<String> {
        self.history.undo(&mut self.session)
    }

    fn redo(&mut self) -> Option<String> {
        self.history.redo(&mut self.session)
    }
}

const SOON: Duration = Duration::from_millis(100);
const LATER: Duration = Duration::from_secs(2);

#[test]
fn a_drag_is_one_step_however_long_it_takes() {
    let mut desk = Desk::new(session());
    desk.is_held = true;
    for value in 1..20 {
        desk.set("size", f64::from(value), LATER);
    }
    desk.is_held = false;
    desk.pass(SOON);
    assert_eq!(desk.steps(), 1);
    desk.is_held = true;
    desk.set("size", 40.0, LATER);
    assert_eq!(desk.steps(), 2, "the next drag is the next step");
    assert_eq!(desk.undo().as_deref(), Some("size"));
    let values = desk.session.chosen_settings();
    assert_eq!(values.get("size"), Some(&SettingValue::Float(19.0)));
}

#[test]
fn the_same_thing_soon_again_is_the_same_step_and_another_thing_is_not() {
    let mut desk = Desk::new(session());
    desk.set("size", 2.0, LATER);
    desk.set("size", 3.0, SOON);
    desk.set("scale", 3.0, SOON);
    desk.set("size", 4.0, SOON);
    desk.set("size", 5.0, LATER);
    assert_eq!(desk.steps(), 4);
}

#[test]
fn there_and_back_again_in_one_gesture_is_no_step() {
    let mut desk = Desk::new(session());
    desk.is_held = true;
    desk.session.panes.active.view.exposure = 2.0;
    desk.pass(SOON);
    desk.session.panes.active.view.exposure = 1.0;
    desk.pass(SOON);
    assert_eq!(desk.history.next_undo(), None);
}

#[test]
fn a_new_change_forgets_what_was_taken_back() {
    let mut desk = Desk::new(session());
    desk.set("size", 2.0, LATER);
    desk.session.panes.active.view.exposure = 2.0;
    desk.pass(LATER);
    assert_eq!(desk.undo().as_deref(), Some("Exposure"));
    assert_eq!(desk.history.next_redo(), Some("Exposure"));
    desk.session.panes.active.view.show = Show::Target("depth".into());
    desk.pass(LATER);
    assert_eq!(desk.redo(), None);
    assert_eq!(desk.history.next_undo(), Some("What is shown"));
}

#[test]
fn the_first_files_and_the_first_renderer_are_no_steps() {
    let mut desk = Desk::new(Session::new(String::new()));
    desk.session.panes.active.renderer = OWNER.into();
    desk.pass(LATER);
    desk.session.panes.active.view.exposure = 2.0;
    desk.pass(LATER);
    desk.session.edit_scene(|scene| scene.add(object("c")));
    desk.pass(LATER);
    desk.history.join_next();
    desk.session.edit_scene(|scene| scene.add(object("d")));
    desk.pass(LATER);
    desk.session.panes.active.camera.eye.x += 1.0;
    desk.pass(LATER);
    assert_eq!(desk.undo().as_deref(), Some("Exposure"));
    assert_eq!(
        names(&desk),
        ["c", "d"],
        "what was undone was older than the files"
    );
    assert_eq!(desk.steps(), 0);
}

fn names(desk: &Desk) -> Vec<&str> {
    let objects = desk.session.scene.objects().iter();
    objects.map(|object| object.name.as_str()).collect()
}

#[test]
fn objects_that_come_and_go_are_steps_of_their_names() {
    let mut desk = Desk::new(session());
    desk.session.panes.active.view.exposure = 2.0;
    desk.pass(LATER);
    let new = desk.session.edit_scene(|scene| scene.add(object("new")));
    desk.pass(SOON);
    let first = desk.session.scene.objects()[0].id;
    desk.session.edit_scene(|scene| scene.remove(first));
    desk.pass(SOON);
    assert_eq!(desk.undo().as_deref(), Some("Remove 'a'"));
    assert_eq!(names(&desk), ["a", "b", "new"]);
    assert_eq!(desk.undo().as_deref(), Some("Add 'new'"));
    assert_eq!(names(&desk), ["a", "b"]);
    assert_eq!(desk.session.panes.active.view.exposure, 2.0);
    desk.redo();
    assert!(desk.session.scene.object(new).is_some());
    desk.redo();
    assert_eq!(names(&desk), ["b", "new"]);
}

#[test]
fn merged_and_opened_objects_are_told_apart() {
    let mut desk = Desk::new(session());
    let turn = |desk: &mut Desk, object: Object| {
        desk.session.clear_scene();
        desk.session.edit_scene(|scene| scene.add(object));
        desk.pass(LATER);
        desk.history.next_undo().map(str::to_owned)
    };
    let merged = turn(&mut desk, object("both"));
    assert_eq!(merged.as_deref(), Some("Merge 2 objects"));
    let mut opened = object("new");
    opened.source = Some("new.ply".into());
    assert_eq!(turn(&mut desk, opened).as_deref(), Some("Open 'new'"));
    desk.undo();
    desk.undo();
    assert_eq!(names(&desk), ["a", "b"]);
}

#[test]
fn files_that_are_opened_together_are_one_step() {
    let mut desk = Desk::new(session());
    desk.session.edit_scene(|scene| scene.add(object("c")));
    desk.pass(LATER);
    desk.history.join_next();
    desk.session.edit_scene(|scene| scene.add(object("d")));
    desk.pass(LATER);
    assert_eq!(desk.steps(), 1);
    desk.undo();
    assert_eq!(names(&desk), ["a", "b"]);
}

#[test]
fn what_loading_had_to_say_comes_back_with_the_object() {
    let mut desk = Desk::new(session());
    let id = desk.session.scene.objects()[0].id;
    let mut warnings = pointstage_scene::Warnings::new();
    warnings.add(pointstage_scene::WarningKind::Flipped, 1);
    desk.session.warnings.insert(id, warnings.clone());
    desk.session.panes.active.view.exposure = 2.0;
    desk.pass(LATER);
    desk.session.clear_scene();
    desk.pass(LATER);
    desk.undo();
    assert_eq!(desk.session.warnings.get(&id), Some(&warnings));
}

#[test]
fn edits_of_surfels_are_steps_however_soon_they_come() {
    let mut desk = Desk::new(session());
    let id = desk.session.scene.objects()[0].id;
    let first = desk.session.scene.objects()[0].geometry.clone();
    for _ in 0..2 {
        let geometry = object("other").geometry;
        desk.session
            .edit_scene(|scene| scene.edit(id, |object| object.geometry = geometry));
        desk.pass(SOON);
    }
    assert_eq!(desk.undo().as_deref(), Some("Surfels"));
    desk.undo();
    assert!(Arc::ptr_eq(
        &desk.session.scene.objects()[0].geometry,
        &first
    ));
}

/// An object of so many bytes.
fn object_of(name: &str, bytes: usize) -> Object {
    let block = Block {
        position_radius: vec![[0.0; 4]; bytes / 16].into(),
        ..Block::default()
    };
    Object::new(
        name,
        DVec3::ZERO,
        Geometry::new(vec![block], None, Origins::default()),
    )
}

#[test]
fn steps_that_hold_too_much_are_forgotten_the_farthest_first() {
    let mut desk = Desk::new(session());
    for number in 0..4 {
        let name = format!("large {number}");
        let id = desk
            .session
            .edit_scene(|scene| scene.add(object_of(&name, 16_000)));
        desk.pass(LATER);
        desk.session.edit_scene(|scene| scene.remove(id));
        desk.pass(LATER);
    }
    assert_eq!(desk.history.held_bytes(), 4 * 16_000);
    desk.history.forget_beyond(2 * 16_000);
    assert_eq!(desk.history.held_bytes(), 2 * 16_000);
    desk.undo();
    assert_eq!(names(&desk), ["a", "b", "large 3"]);
    desk.undo();
    // Both are held for a redo now, and one for an undo: what is farthest ahead goes first.
    desk.history.forget_beyond(16_000);
    assert_eq!(desk.redo(), None);
    assert_eq!(desk.undo().as_deref(), Some("Remove 'large 2'"));
}

#[test]
fn columns_that_the_scene_shows_cost_the_history_nothing() {
    let mut desk = Desk::new(session());
    let id = desk
        .session
        .edit_scene(|scene| scene.add(object_of("large", 16_000)));
    desk.pass(LATER);
    desk.session
        .edit_scene(|scene| scene.edit(id, |object| object.visible = false));
    desk.pass(LATER);
    assert_eq!(desk.history.held_bytes(), 0);
}

#[test]
fn the_oldest_steps_are_forgotten() {
    let mut desk = Desk::new(session());
    for value in 0..MOST_STEPS + 50 {
        desk.set("size", value as f64, LATER);
    }
    assert_eq!(desk.steps(), MOST_STEPS);
}

#[test]
fn a_preset_that_brings_values_is_one_step_of_its_name() {
    let mut desk = Desk::new(session());
    desk.set("size", 2.0, LATER);
    presets::save(&mut desk.session, OWNER, "Soft").expect("a name");
    desk.pass(LATER);
    presets::choose(&mut desk.session, OWNER, presets::DEFAULTS, &[]);
    desk.pass(LATER);
    assert_eq!(desk.undo().as_deref(), Some("Preset"));
    let list = presets::list(&desk.session, OWNER);
    assert_eq!((&*list.active, list.differs), ("Soft", false));
}

/// An edit as the panel could make it.
#[derive(Clone, Debug)]
enum Edit {
    Renderer(u8),
    Preview(Option<u8>),
    Structure(bool),
    Set(u8, u8),
    ResetAll,
    Save(u8),
    Delete(u8),
    Choose(u8),
    Ambient(u8),
    Headlight(bool),
    AddLight,
    RemoveLight,
    SwitchLight(bool),
    Shininess(u8),
    Exposure(u8),
    Show(bool),
    Fov(u8),
    Project,
    Visible(usize, bool),
    Selected(usize, bool),
}

fn edit() -> impl Strategy<Value = Edit> {
    prop_oneof![
        (0..3_u8).prop_map(Edit::Renderer),
        proptest::option::of(0..3_u8).prop_map(Edit::Preview),
        any::<bool>().prop_map(Edit::Structure),
        (0..3_u8, 0..4_u8).prop_map(|(id, value)| Edit::Set(id, value)),
        Just(Edit::ResetAll),
        (0..3_u8).prop_map(Edit::Save),
        (0..3_u8).prop_map(Edit::Delete),
        (0..3_u8).prop_map(Edit::Choose),
        (0..3_u8).prop_map(Edit::Ambient),
        any::<bool>().prop_map(Edit::Headlight),
        Just(Edit::AddLight),
        Just(Edit::RemoveLight),
        any::<bool>().prop_map(Edit::SwitchLight),
        (1..4_u8).prop_map(Edit::Shininess),
        (1..4_u8).prop_map(Edit::Exposure),
        any::<bool>().prop_map(Edit::Show),
        (10..13_u8).prop_map(Edit::Fov),
        Just(Edit::Project),
        (0..2_usize, any::<bool>()).prop_map(|(index, on)| Edit::Visible(index, on)),
        (0..2_usize, any::<bool>()).prop_map(|(index, on)| Edit::Selected(index, on)),
    ]
}

fn carry_out(edit: &Edit, session: &mut Session) {
    let owner = session.panes.active.renderer.clone();
    match *edit {
        Edit::Renderer(number) => session.panes.active.renderer = format!("r{number}"),
        Edit::Preview(number) => {
            session.panes.active.preview = number.map(|number| format!("r{number}"));
        }
        Edit::Structure(is_some) => {
            session.panes.active.structure = is_some.then(|| "s".to_owned());
        }
        Edit::Set(id, value) => {
            let values = session.panes.active.settings.entry(owner).or_default();
            values.insert(format!("s{id}"), SettingValue::Int(value.into()));
        }
        Edit::ResetAll => drop(session.panes.active.settings.remove(&owner)),
        Edit::Save(name) => presets::save(session, &owner, &format!("p{name}")).expect("a name"),
        Edit::Delete(name) => presets::delete(session, &owner, &format!("p{name}")),
        Edit::Choose(name) => drop(presets::choose(session, &owner, &format!("p{name}"), &[])),
        Edit::Ambient(value) => session.panes.active.lights.ambient.x = f32::from(value),
        Edit::Headlight(enabled) => session.panes.active.lights.headlight.enabled = enabled,
        Edit::AddLight => {
            let light = session.panes.active.lights.headlight.as_light();
            session.panes.active.lights.lights.push(light);
        }
        Edit::RemoveLight => drop(session.panes.active.lights.lights.pop()),
        Edit::SwitchLight(enabled) => {
            if let Some(light) = session.panes.active.lights.lights.first_mut() {
                light.enabled = enabled;
            }
        }
        Edit::Shininess(value) => session.material.shininess = f32::from(value),
        Edit::Exposure(value) => session.panes.active.view.exposure = f32::from(value),
        Edit::Show(is_depth) => {
            session.panes.active.view.show = if is_depth {
                Show::Target("depth".into())
            } else {
                Show::Colours
            };
        }
        Edit::Fov(degrees) => {
            use pointstage_scene::Projection::Perspective;
            if let Perspective { fov_y_rad } = &mut session.panes.active.camera.projection {
                *fov_y_rad = f64::from(degrees).to_radians();
            }
        }
        Edit::Project => {
            session.panes.active.camera = session.panes.active.camera.with_projection_switched(0.5);
        }
        Edit::Visible(index, on) => {
            let id = session.scene.objects()[index].id;
            session.edit_scene(|scene| scene.edit(id, |object| object.visible = on));
        }
        Edit::Selected(index, on) => {
            let id = session.scene.objects()[index].id;
            session.edit_scene(|scene| scene.edit(id, |object| object.selected = on));
        }
    }
}

proptest! {
    #[test]
    fn all_undos_give_the_first_state_and_all_redos_the_last(
        edits in proptest::collection::vec((edit(), any::<bool>(), any::<bool>()), 0..60)
    ) {
        let mut desk = Desk::new(session());
        let first = Choices::of(&desk.session);
        for (edit, is_held, is_soon) in &edits {
            desk.is_held = *is_held;
            carry_out(edit, &mut desk.session);
            desk.pass(if *is_soon { SOON } else { LATER });
        }
        let last = Choices::of(&desk.session);
        let mut undone = 0;
        while desk.undo().is_some() {
            // A pass after each, as in the window: it must not be taken for a change.
            desk.pass(SOON);
            undone += 1;
        }
        prop_assert!(first.are_of(&desk.session), "{:?}", Choices::of(&desk.session).differences(&first));
        let mut redone = 0;
        while desk.redo().is_some() {
            desk.pass(SOON);
            redone += 1;
        }
        prop_assert_eq!(redone, undone);
        prop_assert!(last.are_of(&desk.session), "{:?}", Choices::of(&desk.session).differences(&last));
    }
}
