use super::super::intent::Intent;
use super::*;
use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use std::path::PathBuf;

/// The dialog, whether it is open, and what it asked for.
type State = (SaveImage, bool, Vec<Intent>);

fn dialog(mut save: SaveImage) -> Harness<'static, State> {
    save.path = "/pictures/bust.png".into();
    let targets = ["colour".to_owned(), "depth".to_owned()];
    let mut harness = Harness::builder().with_size([700.0, 500.0]).build_ui_state(
        move |ui, (save, is_open, asked): &mut State| {
            let facts = SaveFacts {
                view_px: [800, 600],
                targets: &targets,
            };
            let mut out = Intents::new();
            if *is_open {
                *is_open = save.ui(ui.ctx(), &facts, &mut out);
            }
            asked.extend(out);
        },
        (save, true, Vec::new()),
    );
    harness.run_steps(3);
    harness
}

/// What the dialog asked for so far.
fn saved(harness: &Harness<'_, State>) -> Vec<ImageFile> {
    let (_, _, asked) = harness.state();
    asked
        .iter()
        .map(|intent| match intent {
            Intent::Export(ExportIntent::Save(image)) => image.clone(),
            other => panic!("asked for {other:?}"),
        })
        .collect()
}

#[test]
fn the_view_is_saved_in_its_own_size_unless_told_otherwise() {
    let mut harness = dialog(SaveImage::new("bust"));
    harness.get_by_label("Save").click();
    harness.run_steps(2);
    let expected = ImageFile {
        path: PathBuf::from("/pictures/bust.png"),
        size_px: [800, 600],
        backdrop: Backdrop::AsShown,
        replace: Replace::Ask,
    };
    assert_eq!(saved(&harness), [expected]);
}

#[test]
fn a_preset_and_a_transparent_background_are_taken() {
    let mut harness = dialog(SaveImage::new("bust"));
    harness
        .get_by_role_and_label(Role::ComboBox, "Size:")
        .click();
    harness.run_steps(3);
    harness.get_by_label("4K, 3840 × 2160").click();
    harness.run_steps(3);
    harness.get_by_label_contains("Another shape than the view");
    harness.get_by_label("Transparent background").click();
    harness.run_steps(2);
    harness.get_by_label("Save").click();
    harness.run_steps(2);
    let image = &saved(&harness)[0];
    assert_eq!(image.size_px, [3840, 2160]);
    assert_eq!(image.backdrop, Backdrop::Transparent);
    harness.get_by_label("Keep the view's shape").click();
    harness.run_steps(3);
    harness.get_by_label("Save").click();
    harness.run_steps(2);
    assert_eq!(saved(&harness)[1].size_px, [3840, 2880]);
}

#[test]
fn a_file_that_is_there_is_replaced_only_by_name() {
    let mut save = SaveImage::new("bust");
    save.ask_to_replace();
    let mut harness = dialog(save);
    harness.get_by_label("There is such a file already.");
    harness.key_press(egui::Key::Enter);
    harness.run_steps(3);
    assert_eq!(saved(&harness), [], "Enter is not enough");
    harness.get_by_label("Replace").click();
    harness.run_steps(2);
    assert_eq!(saved(&harness)[0].replace, Replace::Yes);
}

#[test]
fn the_extension_chooses_the_form_and_another_one_is_refused() {
    let mut harness = dialog(SaveImage::new("bust"));
    harness.get_by_label_contains("PNG: the picture");
    harness.state_mut().0.path = "/pictures/bust.EXR".into();
    harness.run_steps(2);
    harness.get_by_label_contains("a layer each (colour, depth)");
    harness.state_mut().0.path = "/pictures/bust.jpg".into();
    harness.run_steps(2);
    harness.get_by_label_contains("must end in .png");
    harness.get_by_label("Save").click();
    harness.run_steps(2);
    assert_eq!(saved(&harness), [], "there is nothing to save it as");
}

#[test]
fn escape_and_cancel_close_it() {
    let mut harness = dialog(SaveImage::new("bust"));
    harness.get_by_label("Cancel").click();
    harness.run_steps(2);
    assert!(!harness.state().1);
    let mut harness = dialog(SaveImage::new("bust"));
    harness.key_press(Key::Escape);
    harness.run_steps(2);
    assert!(!harness.state().1);
}

#[test]
fn sizes_stay_within_what_can_be_drawn() {
    let huge = [60_000, 40_000];
    assert_eq!(
        SizeChoice::TwiceView.size_px(huge, [0, 0]),
        [LARGEST_IMAGE_PX, LARGEST_IMAGE_PX]
    );
    assert_eq!(SizeChoice::Typed.size_px(huge, [0, 7]), [1, 7]);
    assert_eq!(height_of_shape(400, [800, 600]), 300);
    assert_eq!(height_of_shape(1, [u32::MAX, 1]), 1);
}
