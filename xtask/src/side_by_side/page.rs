//! The tables: the thesis's numbers and ours, model by model.

use super::thesis::Model;
use crate::json::Value;
use crate::{markdown, out};

/// Places of the renderers in what was measured.
const SURFEL: usize = 0;
const POINTS: usize = 1;
const EWA: usize = 2;
const HQSS: usize = 3;
const RASTER: usize = 4;
const COMPUTE: usize = 5;

/// The page. What was measured has a scene for each model, in their order.
pub(super) fn markdown(models: &[&Model], measured: &Value) -> String {
    let made_by = measured.get("made_by");
    let adapter = made_by.and_then(|made_by| made_by.get("adapter")?.text("name"));
    let scenes = measured.get("scenes").map_or(&[][..], Value::items);
    let pairs: Vec<(&&Model, &Value)> = models.iter().zip(scenes).collect();
    format!(
        "# A thesis's tables, measured again\n\nMade by `cargo xtask side-by-side` at {} on {}; 800×580 pixels, once around each \
         model. The thesis's numbers are of 2006; its models are not public, so others of about their sizes stand for them.\n\n\
         ## Figure 9.4: HQSS\n\n{}\n## Figure 9.6: frames a second by renderer\n\nIts Surfel and OpenGL are PointShop3D's own, on \
         the CPU; ours run on the device, on a software device in part on the CPU. Its EWA was a fast one on the device; ours is the exact reference, on the CPU.\n\n{}\n\
         ## Figure 10.2: HQSS with several targets at once\n\nThe thesis drew all surfels once more for each target, and once for \
         all with frame buffer objects. Ours always does the latter; its two ways are the raster pipeline and compute.\n\n{}",
        out::commit(),
        adapter.unwrap_or("no graphics device"),
        hqss(&pairs),
        by_renderer(&pairs),
        paths(&pairs)
    )
}

/// A number of a renderer on a scene.
fn number(scene: &Value, renderer: usize, key: &str) -> Option<f64> {
    let renderers = scene.get("renderers")?.items();
    renderers.get(renderer)?.number(key)
}

fn fps(scene: &Value, renderer: usize) -> String {
    match number(scene, renderer, "frames_per_second") {
        None => "–".to_owned(),
        Some(fps) if fps < 10.0 => format!("{fps:.1}"),
        Some(fps) => format!("{fps:.0}"),
    }
}

/// The first cells of a row: the thesis's model, and ours.
fn names(model: &Model, scene: &Value) -> Vec<String> {
    let surfels = scene.number("surfels").unwrap_or(0.0);
    vec![
        format!("{} ({})", model.name, model.surfels),
        format!("{} ({surfels:.0})", scene.text("name").unwrap_or("?")),
    ]
}

fn table(head: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let head = head.iter().map(|cell| (*cell).to_owned()).collect();
    let cells: Vec<Vec<String>> = std::iter::once(head).chain(rows).collect();
    markdown::table(2, &cells)
}

fn hqss(pairs: &[(&&Model, &Value)]) -> String {
    let head = [
        "thesis's model",
        "ours",
        "thesis: fps",
        "thesis: splats/s",
        "ours: fps",
        "ours: splats/s",
    ];
    let rows = pairs.iter().map(|(model, scene)| {
        let mut row = names(model, scene);
        let theirs: f64 = model.frames[3].parse().unwrap_or(0.0);
        let splats = number(scene, HQSS, "splats_per_second");
        row.extend([
            model.frames[3].to_owned(),
            format!("{:.0}", theirs * f64::from(model.surfels)),
            fps(scene, HQSS),
            splats.map_or_else(|| "–".to_owned(), |splats| format!("{splats:.0}")),
        ]);
        row
    });
    table(&head, rows)
}

fn by_renderer(pairs: &[(&&Model, &Value)]) -> String {
    let head = [
        "thesis's model",
        "ours",
        "Surfel",
        "OpenGL",
        "EWA",
        "HQSS",
        "`surfel`",
        "`points`",
        "`ewa-reference`",
        "`hqss`",
    ];
    let rows = pairs.iter().map(|(model, scene)| {
        let mut row = names(model, scene);
        row.extend(model.frames.map(str::to_owned));
        row.extend([SURFEL, POINTS, EWA, HQSS].map(|renderer| fps(scene, renderer)));
        row
    });
    table(&head, rows)
}

fn paths(pairs: &[(&&Model, &Value)]) -> String {
    let head = [
        "thesis's model",
        "ours",
        "HQSS",
        "HQSS + FBOs",
        "`hqss:path=raster`",
        "`hqss:path=compute`",
    ];
    let rows = pairs.iter().map(|(model, scene)| {
        let mut row = names(model, scene);
        row.extend([model.frames[3].to_owned(), model.with_fbo.to_string()]);
        row.extend([RASTER, COMPUTE].map(|renderer| fps(scene, renderer)));
        row
    });
    table(&head, rows)
}

#[cfg(test)]
mod tests {
    use super::super::thesis::MODELS;
    use super::*;

    #[test]
    fn the_thesis_stands_beside_what_was_measured() {
        let renderer =
            |fps: f64| format!(r#"{{"frames_per_second": {fps}, "splats_per_second": 1000}}"#);
        let renderers: Vec<String> = [50.0, 60.0, 0.25, 40.0, 30.0, 41.0].map(renderer).to_vec();
        let json = format!(
            r#"{{"made_by": {{"adapter": {{"name": "X"}}}}, "scenes": [{{"name": "bunny", "surfels": 35947, "renderers": [{}]}}]}}"#,
            renderers.join(",")
        );
        let measured = Value::parse(&json).expect("JSON");
        let page = markdown(&[&MODELS[0]], &measured);
        let rows: Vec<&str> = page
            .lines()
            .filter(|line| line.starts_with("| face.sfl"))
            .collect();
        let cells = |row: &str| -> Vec<String> {
            row.trim_matches('|')
                .split('|')
                .map(|cell| cell.trim().to_owned())
                .collect()
        };
        let ours = ["face.sfl (40880)", "bunny (35947)"];
        assert_eq!(
            cells(rows[0]),
            [&ours[..], &["80", "3270400", "40", "1000"]].concat()
        );
        assert_eq!(
            cells(rows[1]),
            [&ours[..], &["3", "5", "90", "80", "50", "60", "0.2", "40"]].concat()
        );
        assert_eq!(
            cells(rows[2]),
            [&ours[..], &["80", "100", "30", "41"]].concat()
        );
        assert!(page.contains(" on X;"), "{page}");
    }

    #[test]
    fn what_was_not_measured_is_a_dash() {
        let measured =
            Value::parse(r#"{"scenes": [{"name": "a", "surfels": 1, "renderers": []}]}"#);
        let page = markdown(&[&MODELS[0]], &measured.expect("JSON"));
        assert!(
            page.contains("–") && page.contains("no graphics device"),
            "{page}"
        );
    }
}
