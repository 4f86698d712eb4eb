//! The snake's skin: scales in staggered rows, each a dome with a keel, and a pattern of diamonds on its back.

use std::f64::consts::{PI, TAU};

/// Rows of scales along the snake; even, so that the staggering closes.
const ROWS: f64 = 132.0;
/// Scales around the snake.
const COLUMNS: f64 = 16.0;
/// Diamonds along the back.
const DIAMONDS: f64 = 22.0;

/// One place on the skin.
struct Scale {
    /// Row and column, whole numbers.
    row: f64,
    column: f64,
    /// Offset from the scale's middle along and around the snake, −1..1.
    along: f64,
    around: f64,
}

impl Scale {
    /// The scale at `along` and `around`, both in turns.
    ///
    /// Odd rows are shifted by half a scale, and a scale reaches over two rows as a rhombus, so each place has two
    /// candidates; the nearer middle wins.
    fn at(along: f64, around: f64) -> Self {
        let y = along * ROWS;
        let x = around * COLUMNS;
        let candidate = |row: f64| {
            let shift = if row.rem_euclid(2.0) < 1.0 { 0.0 } else { 0.5 };
            let column = (x - shift).round();
            Self {
                row,
                column,
                along: y - row,
                around: (x - shift - column) * 2.0,
            }
        };
        let (a, b) = (candidate(y.floor()), candidate(y.floor() + 1.0));
        if a.distance() <= b.distance() { a } else { b }
    }

    /// 0 in the middle, 1 on the rhombus's edge.
    fn distance(&self) -> f64 {
        self.along.abs() + self.around.abs()
    }
}

/// Distance of the skin from the spine, scene units. `along` and `around` in turns; `around` 0.25 is the back.
pub(super) fn radius(along: f64, around: f64) -> f64 {
    let scale = Scale::at(along, around);
    let dome = 1.0 - scale.distance().powi(3);
    let keel = (1.0 - 5.0 * scale.around.abs()).max(0.0) * (1.0 - scale.distance());
    // The body swells nine times on its way round, and is a little flat below.
    let swell = 1.0 + 0.06 * (9.0 * TAU * along).sin();
    let belly = 1.0 - 0.08 * (-(around * TAU).sin()).max(0.0).powi(2);
    0.62 * swell * belly + 0.055 * dome + 0.02 * keel
}

/// Colour of the skin, sRGB.
pub(super) fn colour(along: f64, around: f64) -> [u8; 3] {
    let scale = Scale::at(along, around);
    // The pattern is one colour a scale, as on a snake: it is looked up at the scale's middle.
    let shift = if scale.row.rem_euclid(2.0) < 1.0 {
        0.0
    } else {
        0.5
    };
    let (row, column) = (
        scale.row.rem_euclid(ROWS),
        (scale.column + shift).rem_euclid(COLUMNS),
    );
    let angle = (column / COLUMNS - 0.25) * TAU;
    let from_back = angle.sin().atan2(angle.cos()).abs() / PI;
    let phase = (row / ROWS * DIAMONDS).rem_euclid(1.0);
    let from_diamond = (phase - 0.5).abs() * 2.0 + from_back * 2.6;
    let base = match from_diamond {
        _ if from_back > 0.74 => [232.0, 219.0, 178.0],
        d if d < 0.55 => [186.0, 62.0, 36.0],
        d if d < 0.85 => [236.0, 176.0, 62.0],
        d if d < 1.05 => [28.0, 34.0, 42.0],
        _ => [38.0, 120.0, 112.0],
    };
    // Neighbours differ by up to a tenth; the seam between scales is darker.
    let hash = ((row * 12.9898 + column * 78.233).sin() * 43_758.545).rem_euclid(1.0);
    let own = 0.9 + 0.2 * hash;
    let seam = 1.0 - 0.55 * scale.distance().powi(4);
    base.map(|channel: f64| (channel * own * seam).clamp(0.0, 255.0) as u8)
}
