//! The table, from what comparisons say.

use crate::json::Value;
use crate::markdown;

/// One renderer on one scene from one distance.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Row {
    scene: String,
    distance: String,
    renderer: String,
    /// PSNR whole, PSNR interior, SSIM, FLIP's mean, FLIP's 99th percentile; as text.
    numbers: [String; 5],
}

/// The rows of a `metrics.json` whose views are from these distances, in their order.
pub(super) fn rows(scene: &str, distances: &[&str], metrics: &Value) -> Vec<Row> {
    let views = metrics.get("views").map_or(&[][..], Value::items);
    let mut rows = Vec::new();
    for (view, distance) in views.iter().zip(distances) {
        for renderer in view.get("renderers").map_or(&[][..], Value::items) {
            rows.push(Row {
                scene: scene.to_owned(),
                distance: (*distance).to_owned(),
                renderer: renderer.text("label").unwrap_or("?").to_owned(),
                numbers: [
                    psnr(renderer.get("whole")),
                    psnr(renderer.get("interior")),
                    number(renderer.get("whole"), "ssim"),
                    number(renderer.get("whole"), "flip_mean"),
                    number(renderer.get("whole"), "flip_p99"),
                ],
            });
        }
    }
    rows
}

fn psnr(measures: Option<&Value>) -> String {
    match measures.and_then(|measures| measures.number("psnr_db")) {
        Some(psnr_db) => format!("{psnr_db:.2}"),
        None if measures.is_some_and(|measures| measures.is_true("identical")) => {
            "equal".to_owned()
        }
        None => "–".to_owned(),
    }
}

fn number(measures: Option<&Value>, key: &str) -> String {
    let number = measures.and_then(|measures| measures.number(key));
    number.map_or_else(|| "–".to_owned(), |number| format!("{number:.4}"))
}

const HEAD: [&str; 8] = [
    "scene",
    "distance",
    "renderer",
    "PSNR whole, dB",
    "PSNR interior, dB",
    "SSIM",
    "FLIP mean",
    "FLIP p99",
];

/// Columns of words before those of numbers.
const WORDS: usize = 3;

/// The rows as a table of Markdown.
pub(super) fn markdown(rows: &[Row]) -> String {
    let rows = rows.iter().map(|row| {
        let words = [&row.scene, &row.distance, &row.renderer].map(String::as_str);
        let numbers = row.numbers.iter().map(String::as_str);
        words.into_iter().chain(numbers).collect()
    });
    let cells: Vec<Vec<&str>> = std::iter::once(HEAD.to_vec()).chain(rows).collect();
    markdown::table(WORDS, &cells)
}

#[cfg(test)]
mod tests {
    use super::*;

    const METRICS: &str = r#"{"device": "X", "views": [
        {"renderers": [
            {"label": "a", "whole": {"psnr_db": 30.126, "identical": false, "ssim": 0.98765, "flip_mean": 0.01, "flip_p99": null},
             "interior": {"psnr_db": null, "identical": true}},
            {"label": "long", "whole": {"psnr_db": 9.5}, "interior": {"psnr_db": null, "identical": false}}]},
        {"renderers": []}, {"renderers": [{"label": "a"}]}]}"#;

    #[test]
    fn a_table_has_a_row_for_each_view_and_renderer() {
        let metrics = Value::parse(METRICS).expect("JSON");
        let rows = rows("board", &["near", "middle", "far"], &metrics);
        let expected = "\
| scene | distance | renderer | PSNR whole, dB | PSNR interior, dB |   SSIM | FLIP mean | FLIP p99 |
|-------|----------|----------|---------------:|------------------:|-------:|----------:|---------:|
| board | near     | a        |          30.13 |             equal | 0.9877 |    0.0100 |        – |
| board | near     | long     |           9.50 |                 – |      – |         – |        – |
| board | far      | a        |              – |                 – |      – |         – |        – |
";
        assert_eq!(markdown(&rows), expected);
    }

    #[test]
    fn what_is_no_report_has_no_rows() {
        let nothing = Value::parse("{}").expect("JSON");
        assert_eq!(rows("a", &["near"], &nothing), []);
    }
}
