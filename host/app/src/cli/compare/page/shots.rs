//! Every picture and map, by view: a column for each renderer, a row for each kind, a legend for each row.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use pointstage_engine::frame::legend::{Legend, Scale, legend};
use pointstage_engine::metrics::difference::AMPLIFICATION;
use pointstage_engine::metrics::flip::MAGMA;

use super::embed::{Kind, Pictures};
use super::{html, reference_name};
use crate::cli::compare::report::{MeasuredBy, RendererReport, Report, ViewReport};
use crate::cli::compare::targets::Targets;

/// The files that the page shows: the name that the report has for each, where it is, and what it shows.
pub(super) fn files(report: &Report, folder: &Path) -> Vec<(String, PathBuf, Kind)> {
    let mut files = Vec::new();
    for view in &report.views {
        // A picture that was there already has its own folder in its name.
        let reference = match report.reference {
            MeasuredBy::Renderer(_) => folder.join(&view.reference.picture),
            MeasuredBy::Images { .. } => PathBuf::from(&view.reference.picture),
        };
        files.push((view.reference.picture.clone(), reference, Kind::Picture));
        let mut maps: Vec<&String> = view.reference.targets.values().collect();
        for row in &view.renderers {
            let of_row = &row.found.files;
            let picture = of_row.picture.clone();
            files.push((picture.clone(), folder.join(picture), Kind::Picture));
            maps.extend(of_row.flip.iter().chain([&of_row.difference]));
            maps.extend(of_row.targets.values());
        }
        let maps = maps.into_iter();
        files.extend(maps.map(|name| (name.clone(), folder.join(name), Kind::Map)));
    }
    files
}

/// Keys of the targets that somebody drew.
pub(super) fn target_keys(report: &Report) -> BTreeSet<&str> {
    let views = report.views.iter().flat_map(|view| {
        let of_renderers = view.renderers.iter().map(|row| &row.found.files.targets);
        of_renderers.chain([&view.reference.targets])
    });
    views
        .flat_map(|targets| targets.keys().map(String::as_str))
        .collect()
}

/// All views, the first one open.
pub(super) fn all(report: &Report, targets: &Targets, pictures: &Pictures) -> String {
    let mut html = "<h2 id=pictures>Pictures and maps</h2>\n".to_owned();
    for (index, view) in report.views.iter().enumerate() {
        let place = Place {
            report,
            pictures,
            index,
            view,
        };
        let open = if index == 0 { " open" } else { "" };
        let _ = writeln!(
            html,
            "<details{open}><summary>View {index}</summary>{}</details>",
            place.matrix(targets)
        );
    }
    html
}

/// One view.
struct Place<'a> {
    report: &'a Report,
    pictures: &'a Pictures,
    index: usize,
    view: &'a ViewReport,
}

impl Place<'_> {
    fn matrix(&self, targets: &Targets) -> String {
        let renderers = &self.view.renderers;
        let columns = renderers.len() + 1;
        let mut html = format!("<div class=matrix style=\"--n:{columns}\">");
        let reference = format!("{} (reference)", reference_name(self.report));
        html += &self.shot("reference", &self.view.reference.picture, &reference, "");
        for (index, row) in renderers.iter().enumerate() {
            let picture = &row.found.files.picture;
            let numbers = numbers(row);
            html += &self.shot(
                &format!("picture-{index}"),
                picture,
                &row.who.label,
                &numbers,
            );
        }
        if renderers.iter().any(|row| row.found.files.flip.is_some()) {
            let stops = MAGMA.map(|[r, g, b]| format!("#{r:02x}{g:02x}{b:02x}"));
            let ramp = ramp(
                &stops.join(","),
                ["0, no difference to be seen", "1, the greatest"],
            );
            html += &row_head(
                "FLIP: how visible the difference from the reference is",
                &ramp,
            );
            html += "<span></span>";
            for (index, row) in renderers.iter().enumerate() {
                let flip = row.found.files.flip.as_deref().unwrap_or_default();
                let name = format!("{}: FLIP error", row.who.label);
                let mean = format!("mean {}", html::number(row.found.whole.flip_mean, 4));
                html += &self.shot(&format!("flip-{index}"), flip, &name, &mean);
            }
        }
        // From this step of 8 bits on, a channel is full.
        let full = 255_u32.div_ceil(AMPLIFICATION.into());
        let ends = ["0, equal".to_owned(), format!("{full} of 255 and more")];
        let ramp = ramp("#000,#fff", [&*ends[0], &*ends[1]]);
        let title = format!(
            "Difference of each channel from the reference, {AMPLIFICATION} times brightened"
        );
        html += &row_head(&title, &ramp);
        html += "<span></span>";
        for (index, row) in renderers.iter().enumerate() {
            let difference = &row.found.files.difference;
            let name = format!("{}: difference", row.who.label);
            html += &self.shot(&format!("difference-{index}"), difference, &name, "");
        }
        for spec in &targets.specs {
            let range = self.view.reference.ranges.get(spec.key.as_ref());
            let Legend { title, scale } = legend(spec, range.copied());
            html += &row_head(&title, &scale_html(&scale));
            html += &self.target(
                "reference",
                &reference,
                &spec.key,
                &self.view.reference.targets,
            );
            for (index, row) in renderers.iter().enumerate() {
                let of_row = &row.found.files.targets;
                html += &self.target(&index.to_string(), &row.who.label, &spec.key, of_row);
            }
        }
        html + "</div>"
    }

    /// A target of one of them, or an empty place.
    fn target(
        &self,
        who: &str,
        label: &str,
        key: &str,
        files: &std::collections::BTreeMap<String, String>,
    ) -> String {
        files.get(key).map_or_else(
            || "<span></span>".to_owned(),
            |file| {
                self.shot(
                    &format!("{key}-{who}"),
                    file,
                    &format!("{label}: {key}"),
                    "",
                )
            },
        )
    }

    /// A picture with its name and what else is to say of it, as HTML.
    fn shot(&self, key: &str, file: &str, name: &str, more: &str) -> String {
        let url = self.pictures.url(file);
        if url.is_empty() {
            return "<span></span>".to_owned();
        }
        let [width, height] = self.report.size;
        let (index, key, name) = (self.index, html::text(key), html::text(name));
        let more = if more.is_empty() {
            String::new()
        } else {
            format!("<br>{more}")
        };
        format!(
            "<figure><button class=shot type=button title=\"Show on the right\"><img data-view={index} data-key=\"{key}\" width={width} \
             height={height} decoding=async alt=\"{name}, view {index}\" src=\"{url}\"></button>\
             <figcaption>{name}{more}</figcaption></figure>"
        )
    }
}

/// What a picture's caption says.
fn numbers(row: &RendererReport) -> String {
    let whole = &row.found.whole;
    let psnr = if whole.identical {
        "equal".to_owned()
    } else {
        format!("{} dB", html::number(whole.psnr_db, 2))
    };
    let median = row.times.as_ref().map(|times| times.frame_ms.median);
    format!("{psnr} · {} ms", html::millis(median))
}

/// Above a row: what it shows, and what its colours mean.
fn row_head(title: &str, legend: &str) -> String {
    format!(
        "<div class=row><p class=soft>{}</p>{legend}</div>",
        html::text(title)
    )
}

/// A ramp of colours with words at its ends.
fn ramp(stops: &str, ends: [&str; 2]) -> String {
    let [from, to] = ends.map(html::text);
    format!(
        "<div class=legend><div class=ramp style=\"background:linear-gradient(90deg,{stops})\"></div>\
         <div class=ends><span>{from}</span><span>{to}</span></div></div>"
    )
}

/// A target's legend.
fn scale_html(scale: &Scale) -> String {
    let hex = |[r, g, b]: [u8; 3]| format!("#{r:02x}{g:02x}{b:02x}");
    match scale {
        Scale::Ramp(stops) => {
            let colours: Vec<String> = stops.iter().map(|stop| hex(stop.colour)).collect();
            let end = |stop: Option<&pointstage_engine::frame::legend::Stop>| {
                stop.map_or(String::new(), |stop| stop.label.clone())
            };
            ramp(
                &colours.join(","),
                [&*end(stops.first()), &*end(stops.last())],
            )
        }
        Scale::Categories(categories) => {
            let categories = categories.iter().map(|category| {
                format!(
                    "<span><span class=swatch style=\"background:{}\"></span>{}</span> ",
                    hex(category.colour),
                    html::text(&category.label)
                )
            });
            format!("<div class=names>{}</div>", categories.collect::<String>())
        }
        Scale::None => String::new(),
    }
}
