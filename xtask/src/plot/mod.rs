//! Plots of lines over two axes, as SVG.

use std::fmt::Write as _;

mod scale;

pub(crate) use scale::Scale;
use scale::Ticks;

/// A whole plot.
pub(crate) struct Plot {
    pub(crate) title: String,
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    pub(crate) series: Vec<Series>,
}

/// What an axis shows.
pub(crate) struct Axis {
    pub(crate) title: &'static str,
    pub(crate) scale: Scale,
}

/// One line, and its entry in the legend.
pub(crate) struct Series {
    pub(crate) name: String,
    pub(crate) colour: &'static str,
    pub(crate) stroke: Stroke,
    /// x and y. Those that the axes cannot show (zero on a logarithmic one) are left out.
    pub(crate) points: Vec<[f64; 2]>,
}

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stroke {
    /// A line through dots.
    Solid,
    /// A broken line through rings.
    Dashed,
    /// Dots alone.
    Dots,
    /// Rings alone.
    Rings,
}

const WIDTH: f64 = 860.0;
const HEIGHT: f64 = 480.0;
/// Left, right, top and bottom edges of what lies between the axes. The legend is to its right.
const LEFT: f64 = 86.0;
const RIGHT: f64 = 660.0;
const TOP: f64 = 48.0;
const BOTTOM: f64 = 420.0;

const INK: &str = "#222222";
const GRID: &str = "#dddddd";

impl Plot {
    /// The SVG document.
    pub(crate) fn svg(&self) -> String {
        let [x, y] = self.ticks();
        let mut body = String::new();
        for tick in &x.at {
            let at = across(&x, *tick);
            line(&mut body, [at, TOP], [at, BOTTOM], GRID);
            let label = scale::label(*tick);
            text(&mut body, [at, BOTTOM + 20.0], "middle", &label);
        }
        for tick in &y.at {
            let at = up(&y, *tick);
            line(&mut body, [LEFT, at], [RIGHT, at], GRID);
            let label = scale::label(*tick);
            text(&mut body, [LEFT - 8.0, at + 4.5], "end", &label);
        }
        line(&mut body, [LEFT, BOTTOM], [RIGHT, BOTTOM], INK);
        line(&mut body, [LEFT, TOP], [LEFT, BOTTOM], INK);
        let middle = f64::midpoint(LEFT, RIGHT);
        text(&mut body, [middle, BOTTOM + 46.0], "middle", self.x.title);
        let _ = writeln!(
            body,
            "<text transform=\"translate(20 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            f64::midpoint(TOP, BOTTOM),
            escaped(self.y.title)
        );
        for (index, series) in self.series.iter().enumerate() {
            let shown = series
                .points
                .iter()
                .filter(|[px, py]| self.x.scale.shows(*px) && self.y.scale.shows(*py));
            let points = shown.map(|[px, py]| [across(&x, *px), up(&y, *py)]);
            series.draw(&mut body, &points.collect::<Vec<_>>());
            let row = TOP + 12.0 + 22.0 * index as f64;
            series.draw(&mut body, &series.sample(row));
            text(&mut body, [RIGHT + 58.0, row + 4.5], "start", &series.name);
        }
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" width=\"{WIDTH}\" height=\"{HEIGHT}\" \
             font-family=\"sans-serif\" font-size=\"14\" fill=\"{INK}\">\n\
             <rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"#ffffff\"/>\n\
             <text x=\"{middle}\" y=\"26\" text-anchor=\"middle\" font-size=\"16\">{}</text>\n\
             {body}</svg>\n",
            escaped(&self.title)
        )
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
    fn sample(&self, row: f64) -> Vec<[f64; 2]> {
        let (left, right) = (RIGHT + 20.0, RIGHT + 48.0);
        match self.stroke {
            Stroke::Solid | Stroke::Dashed => vec![[left, row], [right, row]],
            Stroke::Dots | Stroke::Rings => vec![[f64::midpoint(left, right), row]],
        }
    }

    /// Draws the line and its marks through points, px.
    fn draw(&self, body: &mut String, points: &[[f64; 2]]) {
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
                body,
                "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"{dashes}/>",
                path.join(" ")
            );
        }
        let fill = match stroke {
            Stroke::Solid | Stroke::Dots => colour,
            Stroke::Dashed | Stroke::Rings => "#ffffff",
        };
        for [x, y] in points {
            let _ = writeln!(
                body,
                "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.5\" fill=\"{fill}\" stroke=\"{colour}\" stroke-width=\"1.5\"/>"
            );
        }
    }
}

fn across(ticks: &Ticks, value: f64) -> f64 {
    LEFT + (RIGHT - LEFT) * ticks.part(value)
}

fn up(ticks: &Ticks, value: f64) -> f64 {
    BOTTOM - (BOTTOM - TOP) * ticks.part(value)
}

fn line(body: &mut String, from: [f64; 2], to: [f64; 2], colour: &str) {
    let ([x1, y1], [x2, y2]) = (from, to);
    let _ = writeln!(
        body,
        "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" stroke=\"{colour}\"/>"
    );
}

fn text(body: &mut String, at: [f64; 2], anchor: &str, text: &str) {
    let [x, y] = at;
    let _ = writeln!(
        body,
        "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{}</text>",
        escaped(text)
    );
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

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
                title: "z",
                scale: Scale::Linear,
            },
            y: Axis {
                title: "points",
                scale,
            },
            series: vec![
                series("one", Stroke::Solid, vec![[1.0, 10.0], [2.0, 1000.0]]),
                series("two", Stroke::Dashed, vec![[1.0, 0.0], [3.0, 50.0]]),
                series("three", Stroke::Rings, Vec::new()),
            ],
        }
    }

    /// Asserts that each element is closed by its own end, and that quotes are closed.
    fn assert_well_formed(svg: &str) {
        let mut open: Vec<&str> = Vec::new();
        let mut rest = svg;
        while let Some(start) = rest.find('<') {
            assert!(!rest[..start].contains('>'), "stray > in {rest}");
            let end = start + rest[start..].find('>').expect("each < has its >");
            let tag = &rest[start + 1..end];
            assert_eq!(tag.matches('"').count() % 2, 0, "{tag}");
            if let Some(name) = tag.strip_prefix('/') {
                assert_eq!(open.pop(), Some(name));
            } else if !tag.ends_with('/') {
                open.extend(tag.split(' ').next());
            }
            rest = &rest[end + 1..];
        }
        assert!(open.is_empty(), "left open: {open:?}");
        for after in svg.split('&').skip(1) {
            let known = ["amp;", "lt;", "gt;"];
            assert!(known.iter().any(|name| after.starts_with(name)), "&{after}");
        }
    }

    #[test]
    fn plots_are_well_formed() {
        for scale in [Scale::Linear, Scale::Log] {
            let svg = plot(scale).svg();
            assert_well_formed(&svg);
            assert!(svg.contains("a &lt; b &amp; c"), "{svg}");
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        }
    }

    #[test]
    fn an_empty_plot_is_one_too() {
        let empty = Plot {
            series: Vec::new(),
            ..plot(Scale::Log)
        };
        let svg = empty.svg();
        assert_well_formed(&svg);
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }

    #[test]
    fn a_logarithmic_axis_leaves_zero_out() {
        let circles = |scale| plot(scale).svg().matches("<circle").count();
        // The marks of the legend, and the points.
        assert_eq!(circles(Scale::Linear), 5 + 4);
        assert_eq!(circles(Scale::Log), 5 + 3);
    }

    #[test]
    fn points_lie_between_the_axes() {
        let plot = plot(Scale::Linear);
        let [x, y] = plot.ticks();
        for [px, py] in plot.series.iter().flat_map(|series| &series.points) {
            assert!((LEFT..=RIGHT).contains(&across(&x, *px)));
            assert!((TOP..=BOTTOM).contains(&up(&y, *py)));
        }
    }
}
