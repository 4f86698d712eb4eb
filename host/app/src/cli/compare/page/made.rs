//! How it was made: the command, the machine, the plugins, the settings and the views, so that it can be made again.

use super::html::{self, Table};
use crate::cli::compare::report::{MeasuredBy, Report};
use crate::cli::measuring::who::Who;

/// The section.
pub(super) fn section(report: &Report, pictures: &str) -> String {
    let made_by = &report.made_by;
    format!(
        "<h2 id=made>How it was made</h2>\n<p>This command makes it again:</p>\n<pre>{}</pre>\n{}<p class=soft>{}</p>\n\
         <h3>Scene</h3>\n{}<h3>Plugins</h3>\n{}{}{}",
        html::text(&made_by.command),
        machine(report),
        html::text(pictures),
        scene(report),
        plugins(report),
        settings(report),
        views(report)
    )
}

fn machine(report: &Report) -> String {
    let made_by = &report.made_by;
    let [width, height] = report.size;
    let look = format!(
        "{width} × {height} px, background {}, exposure {}, radius scale {}; the program's default lights",
        report.background, report.exposure, report.radius_scale
    );
    html::facts(&[
        ("Device and driver", html::text(&made_by.device_in_words())),
        (
            "System",
            format!(
                "{}, {} threads",
                html::text(&made_by.system),
                made_by.threads
            ),
        ),
        ("Program", html::text(&made_by.program)),
        ("Time", html::text(&made_by.time)),
        ("Look", html::text(&look)),
    ])
}

fn scene(report: &Report) -> String {
    let objects = report.objects.iter().map(|object| {
        vec![
            html::text(&object.name),
            html::text(&object.normals),
            html::text(&object.radii),
            html::count(object.surfels),
            html::count(object.triangles),
        ]
    });
    let head = ["object", "normals", "radii", "surfels", "triangles"];
    let table = Table {
        words: 3,
        head: head.map(str::to_owned).to_vec(),
        rows: objects.collect(),
    };
    table.html()
}

/// Everybody who drew, the reference last.
fn everybody(report: &Report) -> impl Iterator<Item = &Who> {
    let renderers = report.views.first().into_iter();
    let renderers = renderers.flat_map(|view| view.renderers.iter().map(|row| &row.who));
    let reference = match &report.reference {
        MeasuredBy::Renderer(who) => Some(who),
        MeasuredBy::Images { .. } => None,
    };
    renderers.chain(reference)
}

fn plugins(report: &Report) -> String {
    let rows = everybody(report).map(|who| {
        let given: Vec<String> = who
            .settings
            .iter()
            .map(|(id, value)| format!("{id}={value}"))
            .collect();
        vec![
            html::text(&who.label),
            format!("<code>{}</code>", html::text(&who.id)),
            html::text(&who.version),
            html::text(&given.join(", ")),
            match &who.hash {
                Some(hash) => format!("<code>{}</code>", html::text(hash)),
                None => "built in".to_owned(),
            },
        ]
    });
    let head = [
        "renderer",
        "plugin",
        "version",
        "given settings",
        "hash of the library",
    ];
    let table = Table {
        words: 5,
        head: head.map(str::to_owned).to_vec(),
        rows: rows.collect(),
    };
    table.html()
}

/// The values of all settings, given or not.
fn settings(report: &Report) -> String {
    let lists = everybody(report).map(|who| {
        let values: Vec<String> = who
            .all_settings
            .iter()
            .map(|(id, value)| format!("{id}={value}"))
            .collect();
        let values = if values.is_empty() {
            "none".to_owned()
        } else {
            values.join("\n")
        };
        format!(
            "<p>{}</p><pre>{}</pre>",
            html::text(&who.label),
            html::text(&values)
        )
    });
    html::folded("All settings", &lists.collect::<String>())
}

/// The views, as `--views FILE` takes them.
fn views(report: &Report) -> String {
    let records = report.views.iter().enumerate().map(|(index, view)| {
        let record = html::text(&view.view.to_json());
        format!("<p>View {index}</p><pre>{record}</pre>")
    });
    html::folded("Cameras", &records.collect::<String>())
}
