//! What was found, as a table for people.

use pointstage_engine::metrics::Measures;

use super::report::Report;

/// Rows for each renderer and view, and for its mean if there are several views.
pub(super) fn of(report: &Report) -> String {
    let labels = report.means.iter().map(|mean| mean.label.chars().count());
    let width = labels.max().unwrap_or(0).max("renderer".len());
    let mut lines = vec![
        format!(
            "{:4}  {:width$}  {:^24}  {:^24}",
            "", "", "whole", "interior"
        ),
        format!("{:4}  {:width$}  {HEAD}  {HEAD}", "view", "renderer"),
    ];
    let mut row = |view: &str, label: &str, whole: &Measures, interior: &Measures| {
        let (whole, interior) = (cells(whole), cells(interior));
        lines.push(format!("{view:>4}  {label:width$}  {whole}  {interior}"));
    };
    for (index, view) in report.views.iter().enumerate() {
        for renderer in &view.renderers {
            let found = &renderer.found;
            row(
                &index.to_string(),
                &renderer.who.label,
                &found.whole,
                &found.interior,
            );
        }
    }
    if report.views.len() > 1 {
        for mean in &report.means {
            row("mean", &mean.label, &mean.whole, &mean.interior);
        }
    }
    lines.join("\n")
}

/// Above a region's three cells.
const HEAD: &str = " PSNR dB    SSIM    FLIP";

/// A region's three cells, as wide as [`HEAD`].
fn cells(measures: &Measures) -> String {
    let number = |number: Option<f64>, decimals: usize| match number {
        Some(number) if number.is_finite() => format!("{number:.decimals$}"),
        _ => "–".to_owned(),
    };
    let psnr = if measures.identical {
        "equal".to_owned()
    } else {
        number(measures.psnr_db, 2)
    };
    let (ssim, flip) = (number(measures.ssim, 4), number(measures.flip_mean, 4));
    format!("{psnr:>8}  {ssim:>6}  {flip:>6}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_stand_under_their_heads() {
        let measures = Measures {
            pixels: 5,
            psnr_db: Some(31.256),
            ssim: Some(0.98),
            ..Measures::default()
        };
        let cells = cells(&measures);
        assert_eq!(cells, "   31.26  0.9800       –");
        assert_eq!(cells.chars().count(), HEAD.chars().count());
    }
}
