//! Horizontal bars, each with its name and its number.

use std::fmt::Write as _;

use crate::draw::{Body, Look, shortened};

/// Bars from zero, in one unit.
#[derive(Clone, Debug)]
pub struct Bars {
    /// What is shown, with its unit.
    pub title: String,
    /// From top to bottom.
    pub bars: Vec<Bar>,
}

/// One bar.
#[derive(Clone, Debug)]
pub struct Bar {
    /// To its left.
    pub name: String,
    /// `#rrggbb`.
    pub colour: &'static str,
    /// Its length; below zero and what is no number count as zero.
    pub value: f64,
    /// How far a thin line goes on beyond it (a percentile, say); none if nowhere.
    pub reach: Option<f64>,
    /// What is written behind it.
    pub text: String,
}

const WIDTH: f64 = 480.0;
/// Ends of the longest name, and of the longest bar.
const LEFT: f64 = 165.0;
const RIGHT: f64 = 385.0;
const TOP: f64 = 44.0;
const ROW: f64 = 30.0;
const THICK: f64 = 16.0;
/// Letters of a name that fit.
const LETTERS: usize = 20;

impl Bars {
    /// The SVG element.
    pub fn svg(&self, look: Look) -> String {
        let longest = self
            .bars
            .iter()
            .flat_map(|bar| [length(bar.value), bar.reach.map_or(0.0, length)])
            .fold(0.0, f64::max);
        // Nothing but zeros still needs a scale.
        let scale = (RIGHT - LEFT) / if longest > 0.0 { longest } else { 1.0 };
        let mut body = Body::new(look);
        body.text([16.0, 24.0], "start", &self.title);
        for (index, bar) in self.bars.iter().enumerate() {
            let middle = TOP + ROW * (index as f64 + 0.5);
            let end = LEFT + scale * length(bar.value);
            let _ = writeln!(
                body.svg,
                "<rect x=\"{LEFT:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{THICK}\" fill=\"{}\"/>",
                middle - THICK / 2.0,
                end - LEFT,
                bar.colour
            );
            let reach = bar.reach.map_or(end, |reach| LEFT + scale * length(reach));
            if reach > end {
                body.axis([end, middle], [reach, middle]);
                body.axis([reach, middle - 4.0], [reach, middle + 4.0]);
            }
            let base = middle + 4.5;
            body.text([LEFT - 10.0, base], "end", &shortened(&bar.name, LETTERS));
            body.text([reach.max(end) + 8.0, base], "start", &bar.text);
        }
        let height = TOP + ROW * self.bars.len() as f64 + 10.0;
        let left = LEFT;
        body.axis([left, TOP - 4.0], [left, height - 6.0]);
        look.svg(&self.title, [WIDTH, height], &body.svg)
    }
}

/// A length that can be drawn.
fn length(value: f64) -> f64 {
    if value.is_finite() {
        value.max(0.0)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::assert_well_formed;

    #[test]
    fn bars_are_well_formed_whatever_they_show() {
        let bar = |value| Bar {
            name: "a \"<b>\" & a name that is far too long to stand here".to_owned(),
            colour: "#0072b2",
            value,
            reach: Some(2.0 * value),
            text: "1 < 2".to_owned(),
        };
        for values in [
            vec![],
            vec![0.0],
            vec![1.0, f64::NAN, -3.0],
            vec![f64::INFINITY],
        ] {
            let bars = Bars {
                title: "<t>".to_owned(),
                bars: values.into_iter().map(bar).collect(),
            };
            for look in [Look::Document, Look::Page] {
                assert_well_formed(&bars.svg(look));
            }
        }
    }

    #[test]
    fn the_longest_bar_ends_where_there_is_room_for_its_number() {
        let bar = |value| Bar {
            name: String::new(),
            colour: "#000000",
            value,
            reach: None,
            text: String::new(),
        };
        let bars = Bars {
            title: String::new(),
            bars: vec![bar(1.0), bar(4.0)],
        };
        let svg = bars.svg(Look::Document);
        assert!(svg.contains("width=\"220.0\"") && svg.contains("width=\"55.0\""));
    }
}
