//! Sessions survive their files, and files that are none say so.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use pointstage_engine::stage::{Background, SettingValue, Show};
use pointstage_scene::{Camera, Marks};
use proptest::prelude::*;

use super::testing::{
    any_active_presets, any_lights, any_look, any_material, any_renderers, any_settings,
    any_stored_views, any_view, number,
};
use super::*;
use crate::camera_path::testing::any_path;
use crate::toml_form::MarkRuns;

const FOLDER: &str = "/no/sessions";

fn plain() -> SessionFile {
    SessionFile::new(ViewRecord::new(Camera::default(), 800, 600))
}

fn text_of(session: &SessionFile) -> String {
    session
        .to_toml_string(Path::new(FOLDER))
        .expect("names are Unicode")
}

/// The flaw of the plain session with one text changed.
fn flaw_with(from: &str, to: &str) -> String {
    let mut session = plain();
    session
        .scene
        .push(SceneFile::new("/no/sessions/a.ply".into()));
    let text = text_of(&session);
    assert!(text.contains(from), "{from} is not in {text}");
    let problem = SessionFile::parse(&text.replacen(from, to, 1), Path::new(FOLDER));
    problem
        .expect_err(to)
        .at(Path::new("a.pointstage.toml"))
        .to_string()
}

#[test]
fn every_flaw_is_told_with_its_line_what_was_expected_and_found() {
    for (from, to, expected) in [
        ("near = 0.003", "near = -1.0", "near is -1"),
        (
            "exposure = 1.0",
            "exposure = 0.0",
            "line 23, column 12: expected a number above 0, found 0",
        ),
        (
            "exposure = 1.0",
            "exposure = \"x\"",
            "invalid type: string \"x\", expected f32",
        ),
        ("show = \"colours\"", "show = = 1", "line 22, column 8"),
        ("width = 800", "width = 0", "1 to 65536 pixels"),
        ("visible = true", "visible = 1", "expected a boolean"),
        ("ka = 1.0", "ka = nan", "ka: expected a number from 0"),
        (
            "ambient = [0.12,",
            "ambient = [-0.12,",
            "ambient: expected three numbers from 0",
        ),
        (
            "transform = [1.0",
            "transform = [inf",
            "twelve finite numbers",
        ),
        ("[[0.3,", "[[3,", "from 0 to 1"),
        (
            "radius_scale = 1.0\n\n[scene.material]",
            "radius_scale = -1.0\n\n[scene.material]",
            "expected a number above 0, found -1",
        ),
        (
            "format = 1",
            "format = 9",
            "format 9, this program reads format 1",
        ),
        ("eye = ", "eyes = ", "missing field `eye`"),
    ] {
        let error = flaw_with(from, to);
        assert!(error.contains(expected), "{to}: {error}");
        assert!(error.starts_with("a.pointstage.toml"), "{error}");
    }
}

#[test]
fn unknown_fields_and_absent_ones_do_no_harm() {
    let text = text_of(&plain());
    let more = format!("future = 3\n{text}\n[[mystery]]\na = 1\n");
    let folder = Path::new(FOLDER);
    assert_eq!(SessionFile::parse(&more, folder), Ok(plain()));
    let (head, view) = text.split_once("[view]").expect("the view");
    let (view, _) = view.split_once("[renderers]").expect("more");
    let short = format!("{head}[view]{view}");
    assert_eq!(SessionFile::parse(&short, folder), Ok(plain()));
}

#[test]
fn an_object_of_an_older_session_takes_what_it_lacks() {
    let text = text_of(&plain()).replace("scene = []\n", "");
    let text = format!("{text}\n[[scene]]\nfile = \"a.ply\"\n");
    let session = SessionFile::parse(&text, Path::new(FOLDER)).expect("it is as it was");
    let expected = SceneFile::new("/no/sessions/a.ply".into());
    assert_eq!(session.scene, [expected]);
    assert_eq!(session.scene[0].radius_scale, 1.0);
}

#[test]
fn a_picture_without_a_record_is_no_session() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("a.png");
    let picture = image::RgbaImage::new(2, 2);
    picture.save(&path).expect("written");
    let error = SessionFile::read(&path).expect_err("no record").to_string();
    assert!(
        error.contains("a.png: the picture holds no session"),
        "{error}"
    );
    std::fs::write(&path, [0x89, b'P', b'N', b'G', 1, 2, 3]).expect("written");
    SessionFile::read(&path).expect_err("a broken picture");
    std::fs::write(&path, [0x76, 0x2f, 0x31, 0x01, 1]).expect("written");
    SessionFile::read(&path).expect_err("a broken picture");
}

#[test]
fn a_picture_gives_back_the_session_that_it_carries() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = std::fs::canonicalize(folder.path()).expect("it is there");
    let path = folder.join("a.png");
    let mut session = plain();
    session.scene.push(SceneFile::new(folder.join("é.ply")));
    let toml = session.to_toml_string(&folder).expect("Unicode");
    let as_object: toml::Table = toml.parse().expect("TOML");
    for carried in [serde_json::json!(toml), serde_json::json!(as_object)] {
        let record = serde_json::json!({ "session": carried, "version": "x" });
        let bytes = crate::output::png_file::encode([1, 1], &[1, 2, 3, 255], &record);
        std::fs::write(&path, bytes.expect("encodes")).expect("written");
        assert_eq!(SessionFile::read(&path).expect("a session"), session);
    }
}

#[test]
fn the_record_of_an_older_picture_is_a_session_too() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = std::fs::canonicalize(folder.path()).expect("it is there");
    std::fs::write(folder.join("a.ply"), "ply").expect("written");
    let record = serde_json::json!({
        "files": ["a.ply"], "renderer": "points", "settings": {"size": 3}, "structure": null,
        "view": ViewRecord::new(Camera::default(), 8, 6), "lights": Lights::default(),
        "show": "normal", "background": "#ff0000", "exposure": 2.0, "radius_scale": 1.0,
    });
    let path = folder.join("a.png");
    let bytes = crate::output::png_file::encode([1, 1], &[1, 2, 3, 255], &record);
    std::fs::write(&path, bytes.expect("encodes")).expect("written");
    let session = SessionFile::read(&path).expect("a session");
    assert_eq!(session.scene[0].file, folder.join("a.ply"));
    assert_eq!(session.look.show, Show::Target("normal".into()));
    assert_eq!(session.look.background, Background::Solid([1.0, 0.0, 0.0]));
    assert_eq!(session.settings["points"]["size"], SettingValue::Int(3));
}

#[test]
fn missing_scene_files_are_named_all_at_once() {
    let mut session = plain();
    for name in ["/no/b.ply", "/no/c.ply"] {
        session.scene.push(SceneFile::new(name.into()));
    }
    let error = SessionFileError::Missing {
        session: "a.pointstage.toml".into(),
        files: session.missing_files(),
    };
    assert!(
        error
            .to_string()
            .contains("2 scene files are not there: /no/b.ply, /no/c.ply"),
        "{error}"
    );
}

fn any_scene_file() -> impl Strategy<Value = SceneFile> {
    let path = "/(no|else)/(sessions/)?[a-zé ]{1,9}/[a-z'\"]{1,9}\\.ply";
    let transform = proptest::collection::vec(number(), 12);
    let flags = (any::<bool>(), any::<bool>(), any::<bool>());
    let own = (any::<[bool; 3]>(), 1e-3..1e3f32);
    (path, "\\PC{0,12}", flags, transform, any_material(), own).prop_map(
        |(file, name, (visible, flipped, estimated), transform, material, own)| SceneFile {
            file: PathBuf::from(file),
            name,
            visible,
            flipped,
            estimated,
            loader: if flipped {
                "xyz".to_owned()
            } else {
                String::new()
            },
            loader_settings: if flipped && visible {
                SettingValues::from([("columns".to_owned(), SettingValue::Choice("x y z".into()))])
            } else {
                SettingValues::new()
            },
            transform: glam::DAffine3::from_cols_slice(&transform),
            material,
            radius_scale: own.1,
            active: own.0[0],
            own: own.0[1],
            two_sided: own.0[2],
            selected_surfels: if visible {
                let marks = Marks::from_fn(90, |surfel| surfel % 31 > 20);
                MarkRuns::of(Some(&Arc::new(marks)), "object")
            } else {
                MarkRuns::default()
            },
        },
    )
}

fn any_pane() -> impl Strategy<Value = PaneFile> {
    (
        any_view(),
        any_renderers(),
        any_look(),
        any_lights(),
        any_settings(),
        any_active_presets(),
    )
        .prop_map(
            |(view, renderers, look, lights, settings, presets)| PaneFile {
                view,
                renderers,
                look,
                lights,
                settings,
                presets,
            },
        )
}

/// A session with a view stored under `number`, as older files have it.
fn with_numbered_view(program: &str, number: u8) -> SessionFile {
    let mut session = plain();
    program.clone_into(&mut session.program);
    session.views.push(StoredView {
        key: Some(5),
        number: None,
        name: "front".to_owned(),
        view: session.view,
        thumbnail: Vec::new(),
    });
    let text = text_of(&session).replacen("key = 5", &format!("number = {number}"), 1);
    SessionFile::parse(&text, Path::new(FOLDER)).expect(&text)
}

#[test]
fn views_of_older_sessions_are_called_by_their_keys() {
    for (program, number, key) in [
        // A window wrote places: the first is that of the key 1.
        ("Pointstage 0.1.0", 0, "1"),
        ("Pointstage 0.1.0", 2, "3"),
        ("Pointstage 0.1.0", 9, "0"),
        // A person wrote what the user guide said.
        ("", 3, "3"),
    ] {
        let session = with_numbered_view(program, number);
        let names: Vec<String> = session
            .command_views()
            .into_iter()
            .map(|(name, _)| name)
            .collect();
        assert_eq!(names, [key, "front"], "{program} {number}");
    }
    let text = text_of(&with_numbered_view("Pointstage 0.1.0", 2));
    assert!(
        text.contains("key = 3") && !text.contains("number ="),
        "{text}"
    );
}

#[test]
fn a_session_of_an_older_program_has_no_path() {
    let text = text_of(&plain());
    assert!(!text.contains("path"), "{text}");
    let read = SessionFile::parse(&text, Path::new(FOLDER)).expect("right");
    assert_eq!(read.path, None);
}

fn any_comparison() -> impl Strategy<Value = ComparisonFile> {
    let flags = any::<[bool; 3]>();
    (flags, 0..4_usize, 0..4_usize, 0.1_f32..3.0, 0.0_f32..1.0).prop_map(
        |([linked, fair, measure], active, against, flicker_hz, part)| ComparisonFile {
            active,
            linked,
            fair,
            layout: if linked { "wipe" } else { "flip" }.to_owned(),
            flicker_hz,
            against,
            measure,
            split: [part, 0.5],
        },
    )
}

fn any_session() -> impl Strategy<Value = SessionFile> {
    (
        any_view(),
        any_renderers(),
        any_look(),
        any_lights(),
        proptest::collection::vec(any_scene_file(), 0..4),
        any_settings(),
        any_active_presets(),
        any_stored_views(),
        (
            proptest::collection::vec(any_pane(), 0..4),
            proptest::option::of(any_path()),
        ),
        proptest::option::of(any_comparison()),
    )
        .prop_map(
            |(
                view,
                renderers,
                look,
                lights,
                scene,
                settings,
                presets,
                views,
                (panes, path),
                comparison,
            )| SessionFile {
                renderers,
                look,
                lights,
                scene,
                settings,
                presets,
                views,
                path,
                panes,
                comparison,
                ..SessionFile::new(view)
            },
        )
}

proptest! {
    #[test]
    fn a_session_comes_back_from_its_text_to_the_last_bit(session in any_session()) {
        let text = text_of(&session);
        let read = SessionFile::parse(&text, Path::new(FOLDER));
        prop_assert_eq!(read.as_ref(), Ok(&session), "{}", text);
        // Equality does not see the sign of a zero.
        prop_assert_eq!(text_of(&read.expect("equal")), text);
    }

    #[test]
    fn a_damaged_text_is_an_error_and_never_a_panic(
        session in any_session(), cut in 0usize..4000, insert in "\\PC{0,3}",
    ) {
        let mut text = text_of(&session);
        let mut at = cut.min(text.len());
        while !text.is_char_boundary(at) {
            at -= 1;
        }
        let _ = SessionFile::parse(&text[..at], Path::new(FOLDER)).map_err(|problem| problem.at(Path::new("a")).to_string());
        text.insert_str(at, &insert);
        let _ = SessionFile::parse(&text, Path::new(FOLDER)).map_err(|problem| problem.at(Path::new("a")).to_string());
    }
}
