//! What every drawing is made of: the frame of the document, lines and texts.

use std::fmt::Write as _;

/// Where a drawing is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    /// A file of its own: dark ink on white.
    Document,
    /// A part of a page: the page's own ink (`currentColor`) on its own paper, as wide as there is room.
    Page,
}

impl Look {
    /// Colour of texts and axes.
    pub(crate) fn ink(self) -> &'static str {
        match self {
            Self::Document => "#222222",
            Self::Page => "currentColor",
        }
    }

    /// How a line of the grid is drawn.
    fn grid(self) -> &'static str {
        match self {
            Self::Document => "stroke=\"#dddddd\"",
            Self::Page => "stroke=\"currentColor\" stroke-opacity=\"0.18\"",
        }
    }

    /// What lies in a ring.
    pub(crate) fn paper(self) -> &'static str {
        match self {
            Self::Document => "#ffffff",
            Self::Page => "var(--paper, #ffffff)",
        }
    }

    /// The SVG element around `body`.
    ///
    /// * `size`: width and height, px.
    pub(crate) fn svg(self, title: &str, [width, height]: [f64; 2], body: &str) -> String {
        let ink = self.ink();
        let title = escaped(title);
        let (size, paper) = match self {
            Self::Document => (
                format!(" width=\"{width}\" height=\"{height}\""),
                format!("<rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n"),
            ),
            Self::Page => (
                format!(" role=\"img\" aria-label=\"{title}\""),
                String::new(),
            ),
        };
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\"{size} \
             font-family=\"sans-serif\" font-size=\"14\" fill=\"{ink}\">\n{paper}{body}</svg>\n"
        )
    }
}

/// A drawing's elements, as they come.
pub(crate) struct Body {
    pub(crate) look: Look,
    pub(crate) svg: String,
}

impl Body {
    pub(crate) fn new(look: Look) -> Self {
        let svg = String::new();
        Self { look, svg }
    }

    /// A line of an axis.
    pub(crate) fn axis(&mut self, from: [f64; 2], to: [f64; 2]) {
        let stroke = format!("stroke=\"{}\"", self.look.ink());
        self.line(from, to, &stroke);
    }

    /// A line of the grid.
    pub(crate) fn grid(&mut self, from: [f64; 2], to: [f64; 2]) {
        let stroke = self.look.grid();
        self.line(from, to, stroke);
    }

    fn line(&mut self, [x1, y1]: [f64; 2], [x2, y2]: [f64; 2], stroke: &str) {
        let _ = writeln!(
            self.svg,
            "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" {stroke}/>"
        );
    }

    /// A text whose `anchor` (`start`, `middle`, `end`) is at a place.
    pub(crate) fn text(&mut self, [x, y]: [f64; 2], anchor: &str, text: &str) {
        let text = escaped(text);
        let _ = writeln!(
            self.svg,
            "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{text}</text>"
        );
    }
}

/// A text as XML carries it, in elements and in attributes.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

/// A text of at most so many letters.
pub(crate) fn shortened(text: &str, letters: usize) -> String {
    if text.chars().count() <= letters {
        return text.to_owned();
    }
    let start: String = text.chars().take(letters.saturating_sub(1)).collect();
    format!("{start}…")
}

/// Asserts that each element is closed by its own end, and that quotes are closed.
#[cfg(test)]
pub(crate) fn assert_well_formed(svg: &str) {
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
        let known = ["amp;", "lt;", "gt;", "quot;"];
        assert!(known.iter().any(|name| after.starts_with(name)), "&{after}");
    }
    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
}
