//! Plots of measurements, as SVG: lines over two axes ([`Plot`]) and bars beside names ([`Bars`]).
//!
//! A drawing says what it shows ([`Plot::svg`] takes how it looks, [`Look`]): a document of its own on white, or a part of a
//! page that takes the page's colours, light or dark. Texts are escaped; nothing is loaded from elsewhere.
//!
//! ```
//! use pointstage_plot::{Axis, Look, Plot, Scale, Series, Stroke, colour};
//!
//! let plot = Plot {
//!     title: "Time by size".to_owned(),
//!     x: Axis { title: "surfels".to_owned(), scale: Scale::Log },
//!     y: Axis { title: "ms".to_owned(), scale: Scale::Log },
//!     series: vec![Series {
//!         name: "points".to_owned(),
//!         colour: colour(0),
//!         stroke: Stroke::Solid,
//!         points: vec![[1e4, 2.0], [1e6, 31.0]],
//!     }],
//!     notes: Vec::new(),
//! };
//! assert!(plot.svg(Look::Document).starts_with("<svg"));
//! ```

mod bars;
mod draw;
mod plot;
mod scale;

pub use bars::{Bar, Bars};
pub use draw::Look;
pub use plot::{Axis, Plot, Series, Stroke};
pub use scale::Scale;

/// Colours that the colour-blind can tell apart (Okabe and Ito's), in an order that puts the most distinct ones first.
const COLOURS: [&str; 7] = [
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8a6bbf",
];

/// The colour of series `index`; after the last one they begin again.
pub fn colour(index: usize) -> &'static str {
    COLOURS[index % COLOURS.len()]
}
