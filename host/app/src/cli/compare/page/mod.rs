//! `report.html`: what was found, in one file that needs nothing else: no server, no network, no folder beside it.
//!
//! The page is readable without its script; with it, two pictures lie on each other under a slider ([`stage`]). The numbers
//! come first ([`numbers`]), then the stage, [`charts`], every picture and map by view ([`shots`]), then all that is
//! needed to make it again ([`made`]). Pictures are in it as data URLs ([`embed`]); a content security policy forbids every
//! request.

mod charts;
mod embed;
mod html;
mod made;
mod numbers;
mod shots;
mod stage;

use std::path::Path;

use super::report::{MeasuredBy, Report};
use super::targets::Targets;
use crate::cli::Outcome;
use embed::Pictures;

/// What is the same in every page.
const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// Nothing is loaded but what is in the page itself.
const POLICY: &str = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'; \
                      base-uri 'none'; form-action 'none'";

/// The page of a comparison whose files are in `folder`.
pub(super) fn of(report: &Report, targets: &Targets, folder: &Path) -> Outcome<String> {
    let pictures = Pictures::of(&shots::files(report, folder))?;
    let title = title(report);
    let safe_title = html::text(&title);
    let sections = [
        head(report, &title),
        numbers::means(report),
        stage::stage(report),
        charts::all(report),
        shots::all(report, targets, &pictures),
        numbers::by_view(report),
        made::section(report, &pictures.note),
    ];
    Ok(format!(
        "<!DOCTYPE html>\n<html lang=en>\n<head>\n<meta charset=utf-8>\n\
         <meta http-equiv=Content-Security-Policy content=\"{POLICY}\">\n\
         <meta name=viewport content=\"width=device-width, initial-scale=1\">\n\
         <meta name=generator content=\"{}\">\n<title>{safe_title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n{}\
         <script>\n{SCRIPT}</script>\n</body>\n</html>\n",
        html::text(&report.made_by.program),
        sections.concat()
    ))
}

/// Whom the page is about, in one line.
fn title(report: &Report) -> String {
    let names: Vec<&str> = report.objects.iter().map(|object| &*object.name).collect();
    let labels: Vec<&str> = report.means.iter().map(|mean| &*mean.label).collect();
    let scene = names.join(" and ");
    // A long list says less than its length.
    if labels.len() > 4 {
        return format!("{scene}: {} renderings side by side", labels.len());
    }
    format!("{scene}: {} side by side", labels.join(", "))
}

/// Title and the facts that one asks for first.
fn head(report: &Report, title: &str) -> String {
    let surfels: usize = report.objects.iter().map(|object| object.surfels).sum();
    let views = match report.views.len() {
        1 => "1 view".to_owned(),
        count => format!("{count} views"),
    };
    let [width, height] = report.size;
    format!(
        "<h1>{}</h1>\n<p class=soft>{} surfels · {views} of {width} × {height} px · measured by {} · {}</p>\n",
        html::text(title),
        html::count(surfels),
        html::text(&reference_name(report)),
        html::text(&report.made_by.device_in_words()),
    )
}

/// What the renderers are measured by, in words.
fn reference_name(report: &Report) -> String {
    match &report.reference {
        MeasuredBy::Renderer(who) => who.label.clone(),
        MeasuredBy::Images { images } => format!("the pictures in {images}"),
    }
}
