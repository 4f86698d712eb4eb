//! Tables of what was measured.

use pointstage_engine::metrics::Measures;
use pointstage_plot::colour;

use super::html::{self, Table};
use crate::cli::compare::report::Report;
use crate::cli::measuring::times::{Clock, Times};

/// A renderer's numbers, in the order of the columns.
struct Row {
    psnr_whole: Option<f64>,
    psnr_interior: Option<f64>,
    is_identical: [bool; 2],
    ssim: Option<f64>,
    flip_mean: Option<f64>,
    flip_p99: Option<f64>,
    median: Option<f64>,
    p95: Option<f64>,
    cpu: Option<f64>,
    gpu: Option<f64>,
}

/// Columns of numbers, and whether the greatest is the best.
const COLUMNS: [(&str, bool); 9] = [
    ("PSNR, dB", true),
    ("PSNR interior, dB", true),
    ("SSIM", true),
    ("FLIP mean", false),
    ("FLIP p99", false),
    ("ms median", false),
    ("ms p95", false),
    ("ms CPU", false),
    ("ms GPU", false),
];

impl Row {
    fn of(whole: &Measures, interior: &Measures, times: Option<&Times>) -> Self {
        Self {
            psnr_whole: whole.psnr_db,
            psnr_interior: interior.psnr_db,
            is_identical: [whole.identical, interior.identical],
            ssim: whole.ssim,
            flip_mean: whole.flip_mean,
            flip_p99: whole.flip_p99,
            median: times.map(|times| times.frame_ms.median),
            p95: times.map(|times| times.frame_ms.p95),
            cpu: times.map(|times| times.cpu_ms.median),
            gpu: times.and_then(|times| Some(times.gpu_ms?.median)),
        }
    }

    /// The numbers; equal pictures have no end of PSNR.
    fn numbers(&self) -> [Option<f64>; 9] {
        let psnr = |psnr, is_identical| {
            if is_identical {
                Some(f64::INFINITY)
            } else {
                psnr
            }
        };
        [
            psnr(self.psnr_whole, self.is_identical[0]),
            psnr(self.psnr_interior, self.is_identical[1]),
            self.ssim,
            self.flip_mean,
            self.flip_p99,
            self.median,
            self.p95,
            self.cpu,
            self.gpu,
        ]
    }

    /// The same as text.
    fn cells(&self) -> [String; 9] {
        let psnr = |number: Option<f64>| match number {
            Some(f64::INFINITY) => "equal".to_owned(),
            number => html::number(number, 2),
        };
        let [whole, interior, ssim, mean, worst, times @ ..] = self.numbers();
        let [median, p95, cpu, gpu] = times.map(html::millis);
        [
            psnr(whole),
            psnr(interior),
            html::number(ssim, 4),
            html::number(mean, 4),
            html::number(worst, 4),
            median,
            p95,
            cpu,
            gpu,
        ]
    }
}

/// Cells of several rows, the best of each column marked if there are several and they differ.
fn marked(rows: &[Row]) -> Vec<Vec<String>> {
    let numbers: Vec<_> = rows.iter().map(Row::numbers).collect();
    let mut cells: Vec<Vec<String>> = rows.iter().map(|row| row.cells().to_vec()).collect();
    for (column, (_, is_greatest_best)) in COLUMNS.iter().enumerate() {
        let there = numbers.iter().filter_map(|row| row[column]);
        let best = if *is_greatest_best {
            there.clone().reduce(f64::max)
        } else {
            there.clone().reduce(f64::min)
        };
        if there.clone().all(|number| Some(number) == best) {
            continue;
        }
        for (row, cells) in numbers.iter().zip(&mut cells) {
            if row[column] == best && best.is_some() {
                cells[column] = format!("<span class=best>{}</span>", cells[column]);
            }
        }
    }
    cells
}

fn heads(words: &[&str]) -> Vec<String> {
    let numbers = COLUMNS.iter().map(|(name, _)| *name);
    let names = words.iter().copied().chain(numbers);
    names.map(str::to_owned).collect()
}

/// A renderer's name with its colour in the charts.
fn named(index: usize, label: &str) -> String {
    let colour = colour(index);
    format!(
        "<span class=swatch style=\"background:{colour}\"></span>{}",
        html::text(label)
    )
}

/// Means over the views.
pub(super) fn means(report: &Report) -> String {
    let means = &report.means;
    let rows: Vec<Row> = means
        .iter()
        .map(|mean| Row::of(&mean.whole, &mean.interior, mean.times.as_ref()))
        .collect();
    let names = means.iter().enumerate();
    let names = names.map(|(index, mean)| named(index, &mean.label));
    let rows = names.zip(marked(&rows));
    let table = Table {
        words: 1,
        head: heads(&["renderer"]),
        rows: rows
            .map(|(name, cells)| std::iter::once(name).chain(cells).collect())
            .collect(),
    };
    let over = match report.views.len() {
        1 => String::new(),
        count => format!(" Means over {count} views."),
    };
    format!(
        "<h2 id=numbers>Numbers</h2>\n{}<p class=soft>PSNR and SSIM: more is better; FLIP and times: less. Interior: what the \
         reference covers, without 2 px along its outline.{over} {} The best of a column is marked.</p>\n",
        table.html(),
        clocks(report)
    )
}

/// What the times were measured with.
fn clocks(report: &Report) -> String {
    let times = || report.means.iter().filter_map(|mean| mean.times.as_ref());
    let frames = times().map(|times| times.frames).max().unwrap_or(0);
    let has = |clock| times().any(|times| times.gpu_clock == Some(clock));
    let gpu = match [has(Clock::Timestamps), has(Clock::WallClock)] {
        [true, false] => "; ms GPU is by timestamps of the device",
        [false, true] => "; ms GPU is by the clock around submission and completion",
        [true, true] => {
            "; ms GPU is by timestamps of the device, or by the clock where it has none"
        }
        [false, false] => "",
    };
    format!(
        "ms is a whole picture by the clock, from the request until it is in memory, of up to {frames} pictures in turns{gpu}."
    )
}

/// Every view's numbers, folded away; nothing for one view alone.
pub(super) fn by_view(report: &Report) -> String {
    if report.views.len() < 2 {
        return String::new();
    }
    let mut rows = Vec::new();
    for (view, found) in report.views.iter().enumerate() {
        let numbers: Vec<Row> = found
            .renderers
            .iter()
            .map(|row| Row::of(&row.found.whole, &row.found.interior, row.times.as_ref()))
            .collect();
        let cells = found.renderers.iter().zip(marked(&numbers));
        for (index, (renderer, cells)) in cells.enumerate() {
            let words = [named(index, &renderer.who.label), view.to_string()];
            rows.push(words.into_iter().chain(cells).collect());
        }
    }
    let table = Table {
        words: 2,
        head: heads(&["renderer", "view"]),
        rows,
    };
    html::folded("Numbers of every view", &table.html())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(psnr: f64, ms: f64) -> Row {
        let measures = Measures {
            psnr_db: Some(psnr),
            identical: psnr.is_infinite(),
            ..Measures::default()
        };
        Row {
            median: Some(ms),
            ..Row::of(&measures, &measures, None)
        }
    }

    #[test]
    fn the_best_is_marked_where_more_or_less_is_better() {
        let cells = marked(&[row(30.0, 5.0), row(f64::INFINITY, 4.0)]);
        assert_eq!(cells[0][0], "30.00");
        assert_eq!(cells[1][0], "<span class=best>equal</span>");
        assert_eq!(cells[1][5], "<span class=best>4.00</span>");
        assert_eq!(cells[0][2], "–");
    }

    #[test]
    fn one_row_and_equal_rows_have_no_best() {
        for rows in [vec![row(30.0, 5.0)], vec![row(30.0, 5.0), row(30.0, 5.0)]] {
            let cells = marked(&rows).concat().concat();
            assert!(!cells.contains("best"), "{cells}");
        }
    }
}
