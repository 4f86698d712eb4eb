//! Settings survive their file, and a file that cannot be used survives too.

use std::path::Path;
use std::time::{Duration, Instant};

use proptest::prelude::*;

use super::file::parse;
use super::*;
use crate::session_file::testing;

fn settings_in(folder: &Path) -> Keeper {
    Keeper::new(Some(open(folder))).expect("a thread")
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("listable");
    let mut names: Vec<String> = entries
        .map(|entry| {
            let name = entry.expect("an entry").file_name();
            name.to_string_lossy().into_owned()
        })
        .collect();
    names.sort();
    names
}

#[test]
fn what_was_changed_is_there_after_a_restart() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path().join("new").join("state");
    let mut keeper = settings_in(&folder);
    let mut changed = keeper.preferences().clone();
    changed.theme = Theme::Dark;
    changed.recent.note(Path::new("/a.ply"));
    keeper.keep(changed.clone(), Instant::now());
    drop(keeper);
    assert_eq!(*settings_in(&folder).preferences(), changed);
}

#[test]
fn changes_are_written_two_seconds_after_the_first_and_not_again() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut keeper = settings_in(folder.path());
    let start = Instant::now();
    let with_scale = |text_scale| Preferences {
        text_scale,
        ..Preferences::default()
    };
    let later = |secs| start + Duration::from_secs(secs);
    assert_eq!(keeper.keep(Preferences::default(), start), None);
    let two = Some(Duration::from_secs(2));
    assert_eq!(keeper.keep(with_scale(1.5), start), two);
    let one = Some(Duration::from_secs(1));
    assert_eq!(keeper.keep(with_scale(1.25), later(1)), one);
    assert_eq!(keeper.keep(with_scale(1.25), later(2)), None, "written now");
    assert_eq!(keeper.keep(with_scale(1.25), later(9)), None, "nothing new");
    drop(keeper);
    assert_eq!(*settings_in(folder.path()).preferences(), with_scale(1.25));
}

#[test]
fn a_damaged_file_is_set_aside_with_its_place_and_the_next_one_too() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("settings.toml");
    for number in 1..=2 {
        std::fs::write(&path, "format = 1\ntext_scale = \"big\"\n").expect("written");
        let opened = open(folder.path());
        assert_eq!(opened.preferences, Preferences::default());
        let complaint = opened.complaint.expect("a complaint");
        let aside = format!("settings.damaged-{number}.toml");
        for part in [
            "settings.toml is damaged, line 2, column 14",
            "string \"big\"",
            &aside,
        ] {
            assert!(complaint.contains(part), "no '{part}' in: {complaint}");
        }
    }
    assert_eq!(
        names(folder.path()),
        ["settings.damaged-1.toml", "settings.damaged-2.toml"]
    );
}

#[test]
fn another_format_is_set_aside_with_a_sentence_of_its_own() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("settings.toml"), "format = 7\n").expect("written");
    let complaint = open(folder.path()).complaint.expect("a complaint");
    assert!(
        complaint.contains("format 7, written by another version"),
        "{complaint}"
    );
    assert_eq!(names(folder.path()), ["settings.damaged-1.toml"]);
}

#[test]
fn a_file_that_can_neither_be_read_nor_renamed_is_left_alone() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    // The state folder is a file: nothing below it can be read, made or renamed.
    let file = folder.path().join("state");
    std::fs::write(&file, "not a folder").expect("written");
    let opened = open(&file);
    let complaint = opened.complaint.clone().expect("a complaint");
    assert!(complaint.contains("saves none"), "{complaint}");
    let mut keeper = Keeper::new(Some(opened)).expect("no thread is needed");
    let changed = Preferences {
        theme: Theme::Light,
        ..Preferences::default()
    };
    keeper.keep(changed, Instant::now());
    drop(keeper);
    assert_eq!(std::fs::read(&file).expect("readable"), b"not a folder");
}

#[test]
fn a_write_that_fails_is_told() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut keeper = settings_in(folder.path());
    // A folder takes the file's place.
    std::fs::create_dir(folder.path().join("settings.toml")).expect("made");
    let start = Instant::now();
    let changed = Preferences {
        theme: Theme::Light,
        ..Preferences::default()
    };
    keeper.keep(changed.clone(), start);
    keeper.keep(changed, start + Duration::from_secs(3));
    let limit = Instant::now() + Duration::from_mins(1);
    let failures = loop {
        let failures = keeper.take_failures();
        if !failures.is_empty() || Instant::now() > limit {
            break failures;
        }
        std::thread::yield_now();
    };
    assert!(
        failures.len() == 1 && failures[0].contains("settings.toml: cannot be written"),
        "{failures:?}"
    );
}

#[test]
fn unknown_and_absent_fields_do_no_harm() {
    let text = "format = 1\nflying_carpet = true\n[window]\ncarpet = 3\nlog = true\n";
    let preferences = parse(text).expect("settings");
    assert!(preferences.window.log && preferences.window.settings);
    assert_eq!(preferences.text_scale, 1.0);
}

fn any_preferences() -> impl Strategy<Value = Preferences> {
    let theme = prop_oneof![Just(Theme::System), Just(Theme::Light), Just(Theme::Dark)];
    let paths = proptest::collection::vec("/\\PC{1,20}", 0..15);
    let window = (any::<bool>(), any::<bool>(), any::<bool>(), "[a-z]{1,9}");
    let window = window.prop_map(|(settings, log, inspector, tab)| Layout {
        settings,
        log,
        tab,
        inspector,
    });
    let rate = |least: u32| proptest::option::of(least..=60);
    let pacing = (rate(0), rate(1), any::<bool>());
    let pacing = pacing.prop_map(|(rate_limit, target_rate, cross_fade)| Pacing {
        rate_limit,
        target_rate,
        cross_fade,
    });
    let first = (theme, 0.75..=2.0f32, paths.clone(), paths, window);
    let look = (
        testing::any_renderers(),
        testing::any_look(),
        testing::any_lights(),
        testing::any_material(),
    );
    let presets = proptest::collection::btree_map("\\PC{1,9}", testing::any_settings(), 0..3);
    let kept = (
        testing::any_settings(),
        presets,
        testing::any_stored_views(),
        pacing,
        testing::any_active_presets(),
        (any::<bool>(), 0.01..=100.0f64),
    );
    (first, look, kept).prop_map(
        |(
            (theme, text_scale, opened, folders, window),
            (renderers, look, lights, material),
            (settings, presets, views, pacing, active_presets, (turntable, fly_speed)),
        )| {
            let mut recent = Recent::default();
            for path in &opened {
                recent.note(Path::new(path));
            }
            Preferences {
                theme,
                text_scale,
                recent,
                plugin_folders: folders.into_iter().map(PathBuf::from).collect(),
                window,
                renderers,
                look,
                lights,
                material,
                settings,
                presets,
                views,
                pacing,
                active_presets,
                navigation: NavigationOptions {
                    turntable,
                    fly_speed,
                    ..NavigationOptions::default()
                },
                ..Preferences::default()
            }
        },
    )
}

proptest! {
    #[test]
    fn settings_come_back_from_their_text(preferences in any_preferences()) {
        let text = toml::to_string(&preferences).expect("they have a form");
        prop_assert_eq!(parse(&text), Ok(preferences), "{}", text);
    }

    #[test]
    fn a_garbled_file_is_kept_and_never_a_panic(
        preferences in any_preferences(), cut in 0usize..3000, insert in proptest::collection::vec(any::<u8>(), 0..4),
    ) {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("settings.toml");
        let mut bytes = toml::to_string(&preferences).expect("they have a form").into_bytes();
        bytes.truncate(cut.max(20));
        bytes.extend(&insert);
        std::fs::write(&path, &bytes).expect("written");
        let opened = open(folder.path());
        let kept = if opened.complaint.is_some() {
            folder.path().join("settings.damaged-1.toml")
        } else {
            path
        };
        prop_assert_eq!(std::fs::read(kept).expect("it is there"), bytes);
    }
}
