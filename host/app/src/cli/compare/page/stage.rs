//! The stage: two pictures on each other, and a slider between them.

use std::fmt::Write as _;

use super::{html, reference_name};
use crate::cli::compare::report::Report;

/// The stage and what is chosen for it; hidden until the script shows it.
pub(super) fn stage(report: &Report) -> String {
    let mut views = String::new();
    for index in 0..report.views.len() {
        let _ = write!(views, "<option value={index}>{index}</option>");
    }
    let shown = shown(report);
    let options = |selected: &str| -> String {
        let group = |(group, options): &(String, Vec<(String, String)>)| {
            let options = options.iter().map(|(key, name)| {
                let is_selected = if key == selected { " selected" } else { "" };
                format!(
                    "<option value=\"{}\"{is_selected}>{}</option>",
                    html::text(key),
                    html::text(name)
                )
            });
            format!(
                "<optgroup label=\"{}\">{}</optgroup>",
                html::text(group),
                options.collect::<String>()
            )
        };
        shown.iter().map(group).collect()
    };
    let [width, height] = report.size;
    format!(
        "<section id=look hidden>\n<h2>Side by side</h2>\n<div class=choices>\
         <label>View<select id=view>{views}</select></label>\
         <label>Left<select id=left>{}</select></label>\
         <label>Right<select id=right>{}</select></label>\
         <label>Zoom<select id=zoom><option value=1>fit</option><option value=2>2×</option><option value=4>4×</option>\
         <option value=8>8×</option></select></label>\
         <button id=swap type=button>Swap sides</button></div>\n\
         <div id=stage><div id=scroll><div id=pair>\
         <img id=shown-left width={width} height={height} alt=\"\"><img id=shown-right width={width} height={height} alt=\"\">\
         <div id=edge></div><span class=tag id=tag-left></span><span class=tag id=tag-right></span></div></div>\
         <input type=range id=cut min=0 max=100 step=0.5 value=50 aria-label=\"Where the left picture ends and the right one begins\">\
         </div>\n<p class=soft>Drag on the picture, or use the arrow keys on the slider. A click on any picture below puts it on \
         the right.</p>\n</section>\n<noscript><p class=soft>The slider needs JavaScript; all pictures are below.</p></noscript>\n",
        options("reference"),
        options("picture-0"),
    )
}

/// What can be put on the stage: groups of keys with names.
fn shown(report: &Report) -> Vec<(String, Vec<(String, String)>)> {
    let labels = || report.means.iter().map(|mean| &mean.label).enumerate();
    let of = |prefix: &str, what: &str| -> Vec<(String, String)> {
        let options = labels();
        options
            .map(|(index, label)| (format!("{prefix}-{index}"), format!("{label}{what}")))
            .collect()
    };
    let reference = (
        "reference".to_owned(),
        format!("{} (reference)", reference_name(report)),
    );
    let pictures = std::iter::once(reference).chain(of("picture", ""));
    let mut groups = vec![("Pictures".to_owned(), pictures.collect())];
    let first = report.views.first();
    if first.is_some_and(|view| {
        view.renderers
            .iter()
            .any(|row| row.found.files.flip.is_some())
    }) {
        groups.push(("FLIP errors".to_owned(), of("flip", ": FLIP error")));
    }
    groups.push(("Differences".to_owned(), of("difference", ": difference")));
    for key in super::shots::target_keys(report) {
        let mut options = Vec::new();
        if first.is_some_and(|view| view.reference.targets.contains_key(key)) {
            let name = format!("{} (reference): {key}", reference_name(report));
            options.push((format!("{key}-reference"), name));
        }
        for (index, row) in first
            .into_iter()
            .flat_map(|view| view.renderers.iter().enumerate())
        {
            if row.found.files.targets.contains_key(key) {
                options.push((
                    format!("{key}-{index}"),
                    format!("{}: {key}", row.who.label),
                ));
            }
        }
        groups.push((key.to_owned(), options));
    }
    groups
}
