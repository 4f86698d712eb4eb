use super::*;
use crate::settings_schema::{ChoiceOption, NumberRange, Scale, SettingCost, VisibleIf};
use proptest::prelude::*;

fn setting(id: &str, kind: SettingKind) -> SettingSchema {
    SettingSchema {
        id: id.into(),
        kind,
        label: id.into(),
        help: String::new(),
        group: String::new(),
        visible_if: None,
        cost: SettingCost::Redraw,
        shortcut: None,
        value_shortcuts: Vec::new(),
    }
}

fn size() -> SettingSchema {
    let range = NumberRange {
        min: Some(0.5),
        max: Some(64.0),
        soft_min: None,
        soft_max: None,
        step: None,
        unit: "px".into(),
        scale: Scale::Linear,
    };
    setting(
        "size",
        SettingKind::Float {
            default: 2.0,
            range,
        },
    )
}

fn path() -> SettingSchema {
    let option = |id: &str| ChoiceOption {
        id: id.into(),
        label: id.into(),
    };
    let options = vec![option("auto"), option("raster"), option("compute")];
    setting(
        "path",
        SettingKind::Choice {
            default: "auto".into(),
            options,
        },
    )
}

#[test]
fn a_number_outside_the_range_names_range_and_nearest_end() {
    let error = size().parse_text("100").expect_err("above 64");
    assert_eq!(
        error.to_string(),
        "setting 'size': 100 is outside 0.5 … 64 px; the nearest is 64"
    );
    assert!(size().parse_text("nan").is_err());
    assert!(size().parse_text("inf").is_err());
    assert_eq!(size().parse_text(" 3.5 "), Ok(SettingValue::Float(3.5)));
}

#[test]
fn an_unknown_option_names_the_nearest_and_all() {
    let error = path().parse_text("rastre").expect_err("no such option");
    assert_eq!(
        error.to_string(),
        "setting 'path' has no option 'rastre'; did you mean 'raster'?; it takes auto, raster, compute"
    );
}

#[test]
fn a_text_that_is_no_number_says_what_is_expected() {
    let error = size().parse_text("big").expect_err("not a number");
    assert_eq!(
        error.to_string(),
        "setting 'size': expected a number in 0.5 … 64 px, found 'big'"
    );
}

#[test]
fn colours_are_srgb_hex_or_linear_numbers() {
    let tint = setting("tint", SettingKind::Colour { default: [1.0; 4] });
    assert_eq!(
        tint.parse_text("#ff0080").map(|value| match value {
            SettingValue::Colour([r, g, b, a]) => (r, g, (b * 1e4).round(), a),
            _ => (-1.0, 0.0, 0.0, 0.0),
        }),
        // sRGB 128 is 0.2159 linear.
        Ok((1.0, 0.0, 2159.0, 1.0))
    );
    assert_eq!(
        tint.parse_text("0.1, 0.2, 0.3"),
        Ok(SettingValue::Colour([0.1, 0.2, 0.3, 1.0]))
    );
    for wrong in ["#ff00", "#gg0000", "#é0000", "1,2", "1,2,x", "nan,0,0"] {
        assert!(tint.parse_text(wrong).is_err(), "{wrong} is no colour");
    }
}

#[test]
fn a_snapshot_has_every_default_and_refuses_unknown_ids() {
    let settings = [size(), path(), setting("reset", SettingKind::Action)];
    let given = SettingValues::from([("size".to_owned(), SettingValue::Int(4))]);
    let all = snapshot(&settings, &given).expect("in range");
    assert_eq!(
        all["size"],
        SettingValue::Float(4.0),
        "an integer stands for a float"
    );
    assert_eq!(all["path"], SettingValue::Choice("auto".into()));
    assert_eq!(all.len(), 2, "actions have no value");

    let unknown = SettingValues::from([("sise".to_owned(), SettingValue::Int(4))]);
    assert_eq!(
        snapshot(&settings, &unknown)
            .expect_err("unknown")
            .to_string(),
        "no setting 'sise'; did you mean 'size'?"
    );
    let pressed = SettingValues::from([("reset".to_owned(), SettingValue::Bool(true))]);
    assert!(snapshot(&settings, &pressed).is_err());
}

#[test]
fn a_condition_looks_at_the_value_or_the_default() {
    let mut shown = size();
    let equals = SettingValue::Choice("raster".into());
    shown.visible_if = Some(VisibleIf {
        id: "path".into(),
        equals: equals.clone(),
    });
    let settings = [path(), shown.clone()];
    assert!(!shown.is_visible(&settings, &SettingValues::new()));
    assert!(shown.is_visible(&settings, &SettingValues::from([("path".into(), equals)])));
}

proptest! {
    #[test]
    fn what_display_writes_parse_text_reads(value in 0.5_f64..=64.0, rgba: [i16; 4], on: bool) {
        let tint = setting("tint", SettingKind::Colour { default: [1.0; 4] });
        let colour = SettingValue::Colour(rgba.map(|channel| f64::from(channel) / 7.0));
        prop_assert_eq!(tint.parse_text(&colour.to_string()), Ok(colour));
        let number = SettingValue::Float(value);
        prop_assert_eq!(size().parse_text(&number.to_string()), Ok(number));
        let flag = setting("flag", SettingKind::Bool { default: false });
        let on = SettingValue::Bool(on);
        prop_assert_eq!(flag.parse_text(&on.to_string()), Ok(on));
    }

    #[test]
    fn any_text_is_a_value_in_range_or_an_error(text in ".*") {
        if let Ok(SettingValue::Float(value)) = size().parse_text(&text) {
            prop_assert!((0.5..=64.0).contains(&value));
        }
    }

    #[test]
    fn json_keeps_values(sixteenths in -1_000_000_i32..1_000_000, text in "[a-z]{1,8}") {
        // Of few digits: without `float_roundtrip`, serde_json reads the 17th one only nearly.
        let value = f64::from(sixteenths) / 16.0;
        for kept in [SettingValue::Float(value), SettingValue::Choice(text.clone()), SettingValue::Int(7)] {
            let json = serde_json::to_string(&kept).expect("plain data");
            let read: SettingValue = serde_json::from_str(&json).expect("its own output");
            prop_assert_eq!(read, kept);
        }
    }
}
