//! Lines over two axes.

use std::fmt::Write as _;

use crate::draw::{Body, Look, escaped, shortened};
use crate::scale::{self, Scale, Ticks};

/// A whole plot.
#[derive(Clone, Debug)]
pub struct Plot {
    /// Above it.
    pub title: String,
    /// To the right.
    pub x: Axis,
    /// Upwards.
    pub y: Axis,
    /// What is shown, in the legend's order.
    pub series: Vec<Series>,
    /// Words beside places: x and y, and what is written there.
    pub notes: Vec<([f64; 2], String)>,
}

/// What an axis shows.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Quantity and unit.
    pub title: String,
    /// How it is divided.
    pub scale: Scale,
}

/// One line, and its entry in the legend.
#[derive(Clone, Debug)]
pub struct Series {
    /// In the legend.
    pub name: String,
    /// `#rrggbb`.
    pub colour: &'static str,
    /// How it is drawn.
    pub stroke: Stroke,
    /// x and y. Those that the axes cannot show (zero on a logarithmic one) are left out.
    pub points: Vec<[f64; 2]>,
}

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stroke {
    /// A line through dots.
    Solid,
    /// A broken line through rings.
    Dashed,
    /// Dots alone.
    Dots,
    /// Rings alone.
    Rings,
}

/// Where a plot's parts are, px.
#[derive(Clone, Copy)]
struct Frame {
    width: f64,
    /// Left, right, top and bottom edges of what lies between the axes.
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
    legend: Legend,
}

/// Where the names of the series stand.
#[derive(Clone, Copy, PartialEq)]
enum Legend {
    /// To the right of the plot.
    Beside,
    /// Below it, in two columns: a part of a page may be as narrow as a phone.
    Below,
}

const ROW: f64 = 22.0;
/// Letters of a name that fit below a plot.
const LETTERS: usize = 24;

impl Frame {
    fn of(look: Look) -> Self {
        match look {
            Look::Document => Self {
                width: 860.0,
                left: 86.0,
                right: 660.0,
                top: 48.0,
                bottom: 420.0,
                legend: Legend::Beside,
            },
            Look::Page => Self {
                width: 480.0,
                left: 70.0,
                right: 452.0,
                top: 40.0,
                bottom: 290.0,
                legend: Legend::Below,
            },
        }
    }

    /// Height of the whole.
    fn height(&self, series_count: usize) -> f64 {
        match self.legend {
            Legend::Beside => self.bottom + 60.0,
            Legend::Below => self.bottom + 64.0 + ROW * series_count.div_ceil(2) as f64,
        }
    }

    /// Where an entry of the legend begins.
    fn entry(&self, index: usize) -> [f64; 2] {
        match self.legend {
            Legend::Beside => [self.right + 20.0, self.top + 12.0 + ROW * index as f64],
            Legend::Below => {
                let column = if index.is_multiple_of(2) { 8.0 } else { 248.0 };
                [column, self.bottom + 72.0 + ROW * (index / 2) as f64]
            }
        }
    }

    fn across(&self, ticks: &Ticks, value: f64) -> f64 {
        self.left + (self.right - self.left) * ticks.part(value)
    }

    fn up(&self, ticks: &Ticks, value: f64) -> f64 {
        self.bottom - (self.bottom - self.top) * ticks.part(value)
    }
}

impl Plot {
    /// The SVG element.
    pub fn svg(&self, look: Look) -> String {
        let [x, y] = self.ticks();
        let frame = Frame::of(look);
        let Frame {
            left,
            right,
            top,
            bottom,
            ..
        } = frame;
        let mut body = Body::new(look);
        for tick in &x.at {
            let at = frame.across(&x, *tick);
            body.grid([at, top], [at, bottom]);
            let label = scale::label(*tick);
            body.text([at, bottom + 20.0], "middle", &label);
        }
        for tick in &y.at {
            let at = frame.up(&y, *tick);
            body.grid([left, at], [right, at]);
            let label = scale::label(*tick);
            body.text([left - 8.0, at + 4.5], "end", &label);
        }
        body.axis([left, bottom], [right, bottom]);
        body.axis([left, top], [left, bottom]);
        let middle = f64::midpoint(left, right);
        body.text([middle, bottom + 44.0], "middle", &self.x.title);
        let _ = writeln!(
            body.svg,
            "<text transform=\"translate(20 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            f64::midpoint(top, bottom),
            escaped(&self.y.title)
        );
        let _ = writeln!(
            body.svg,
            "<text x=\"{middle}\" y=\"26\" text-anchor=\"middle\" font-size=\"16\">{}</text>",
            escaped(&self.title)
        );
        for (index, series) in self.series.iter().enumerate() {
            let shown = series
                .points
                .iter()
                .filter(|[px, py]| self.x.scale.shows(*px) && self.y.scale.shows(*py));
            let points = shown.map(|[px, py]| [frame.across(&x, *px), frame.up(&y, *py)]);
            series.draw(&mut body, &points.collect::<Vec<_>>());
            let [from, row] = frame.entry(index);
            series.draw(&mut body, &series.sample(from, row));
            let name = match frame.legend {
                Legend::Beside => series.name.clone(),
                Legend::Below => shortened(&series.name, LETTERS),
            };
            body.text([from + 38.0, row + 4.5], "start", &name);
        }
        for ([px, py], note) in &self.notes {
            if self.x.scale.shows(*px) && self.y.scale.shows(*py) {
                let at = [frame.across(&x, *px) + 7.0, frame.up(&y, *py) - 7.0];
                body.text(at, "start", note);
            }
        }
        let height = frame.height(self.series.len());
        look.svg(&self.title, [frame.width, height], &body.svg)
    }

    /// The ticks of x and y, which hold all points.
    fn ticks(&self) -> [Ticks; 2] {
        [(0, self.x.scale), (1, self.y.scale)].map(|(axis, scale)| {
            let points = self.series.iter().flat_map(|series| &series.points);
            scale.ticks(points.map(|point| point[axis]))
        })
    }
}

impl Series {
    /// The points of its entry in the legend, px.
    fn sample(&self, left: f64, row: f64) -> Vec<[f64; 2]> {
        let right = left + 28.0;
        match self.stroke {
            Stroke::Solid | Stroke::Dashed => vec![[left, row], [right, row]],
            Stroke::Dots | Stroke::Rings => vec![[f64::midpoint(left, right), row]],
        }
    }

    /// Draws the line and its marks through points, px.
    fn draw(&self, body: &mut Body, points: &[[f64; 2]]) {
        let Self { colour, stroke, .. } = self;
        if matches!(stroke, Stroke::Solid | Stroke::Dashed) {
            let dashes = match stroke {
                Stroke::Dashed => " stroke-dasharray=\"6 4\"",
                _ => "",
            };
            let path: Vec<String> = points
                .iter()
                .map(|[x, y]| format!("{x:.1},{y:.1}"))
                .collect();
            let _ = writeln!(
                body.svg,
                "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"{dashes}/>",
                path.join(" ")
            );
        }
        let fill = match stroke {
            Stroke::Solid | Stroke::Dots => colour,
            Stroke::Dashed | Stroke::Rings => body.look.paper(),
        };
        for [x, y] in points {
            let _ = writeln!(
                body.svg,
                "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.5\" fill=\"{fill}\" stroke=\"{colour}\" stroke-width=\"1.5\"/>"
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::assert_well_formed;

    fn plot(scale: Scale) -> Plot {
        let series = |name: &str, stroke, points| Series {
            name: name.to_owned(),
            colour: "#0072b2",
            stroke,
            points,
        };
        Plot {
            title: "a < b & c".to_owned(),
            x: Axis {
                title: "z".to_owned(),
                scale: Scale::Linear,
            },
            y: Axis {
                title: "points".to_owned(),
                scale,
            },
            series: vec![
                series("one", Stroke::Solid, vec![[1.0, 10.0], [2.0, 1000.0]]),
                series("two", Stroke::Dashed, vec![[1.0, 0.0], [3.0, 50.0]]),
                series("three", Stroke::Rings, Vec::new()),
            ],
            notes: vec![([1.0, 10.0], "<here>".to_owned())],
        }
    }

    #[test]
    fn plots_are_well_formed() {
        for scale in [Scale::Linear, Scale::Span, Scale::Log] {
            for look in [Look::Document, Look::Page] {
                let svg = plot(scale).svg(look);
                assert_well_formed(&svg);
                assert!(svg.contains("a &lt; b &amp; c"), "{svg}");
            }
        }
    }

    #[test]
    fn an_empty_plot_is_one_too() {
        let empty = Plot {
            series: Vec::new(),
            ..plot(Scale::Log)
        };
        assert_well_formed(&empty.svg(Look::Document));
    }

    #[test]
    fn a_logarithmic_axis_leaves_zero_out() {
        let circles = |scale| plot(scale).svg(Look::Document).matches("<circle").count();
        // The marks of the legend, and the points.
        assert_eq!(circles(Scale::Linear), 5 + 4);
        assert_eq!(circles(Scale::Log), 5 + 3);
    }

    #[test]
    fn points_lie_between_the_axes() {
        let plot = plot(Scale::Linear);
        let [x, y] = plot.ticks();
        for [px, py] in plot.series.iter().flat_map(|series| &series.points) {
            for frame in [Look::Document, Look::Page].map(Frame::of) {
                assert!((frame.left..=frame.right).contains(&frame.across(&x, *px)));
                assert!((frame.top..=frame.bottom).contains(&frame.up(&y, *py)));
            }
        }
    }
}
