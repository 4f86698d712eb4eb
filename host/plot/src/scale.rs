//! Where values stand along an axis, and which of them are named.

/// How an axis is divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// From zero, in equal steps.
    Linear,
    /// The same in whole steps: for what is counted.
    Whole,
    /// In equal steps around the values: for quantities whose zero says nothing, such as decibels.
    Span,
    /// At powers of ten, and at 2 and 5 times them where those are few.
    Log,
}

/// The named values of an axis, ascending; it reaches from the first to the last.
#[derive(Debug)]
pub(crate) struct Ticks {
    pub(crate) at: Vec<f64>,
    scale: Scale,
}

/// Most steps of a linear axis.
const STEPS: f64 = 8.0;

impl Scale {
    /// Can it show this value?
    pub(crate) fn shows(self, value: f64) -> bool {
        value.is_finite() && (value > 0.0 || self != Self::Log)
    }

    /// The axis that holds these values as far as it can show them.
    pub(crate) fn ticks(self, values: impl Iterator<Item = f64>) -> Ticks {
        let values: Vec<f64> = values.filter(|value| self.shows(*value)).collect();
        let highest = values.iter().copied().reduce(f64::max).unwrap_or(1.0);
        let at = match self {
            Self::Linear | Self::Whole => {
                // Nothing but zeros still needs an axis with a length.
                let highest = if highest > 0.0 { highest } else { 1.0 };
                let step = nice_step(highest / STEPS);
                let step = if self == Self::Whole {
                    step.max(1.0)
                } else {
                    step
                };
                let count = (highest / step).ceil().max(1.0) as u32;
                (0..=count).map(|index| f64::from(index) * step).collect()
            }
            Self::Span => {
                let lowest = values.iter().copied().reduce(f64::min).unwrap_or(0.0);
                span_ticks(lowest, highest)
            }
            Self::Log => {
                let lowest = values.iter().copied().reduce(f64::min).unwrap_or(1.0);
                log_ticks(lowest, highest)
            }
        };
        Ticks { at, scale: self }
    }
}

/// Equal steps from the last tick at or below `lowest` to the first at or above `highest`.
fn span_ticks(lowest: f64, highest: f64) -> Vec<f64> {
    let width = highest - lowest;
    // One value alone still needs an axis with a length.
    let least = 1e-3 * highest.abs().max(1e-3);
    let step = nice_step(width.max(least) / STEPS);
    let first = (lowest / step).floor() as i64;
    let last = ((highest / step).ceil() as i64).max(first + 1);
    (first..=last).map(|index| index as f64 * step).collect()
}

/// The least of 1, 2, 5, 10, 20 … (and 0.5, 0.2 …) that is not below `step`.
fn nice_step(step: f64) -> f64 {
    let decade = 10_f64.powf(step.log10().floor());
    let nice = [1.0, 2.0, 5.0].into_iter().map(|digit| digit * decade);
    nice.into_iter()
        .find(|nice| *nice >= step)
        .unwrap_or(10.0 * decade)
}

/// From the last tick at or below `lowest` to the first at or above `highest`.
fn log_ticks(lowest: f64, highest: f64) -> Vec<f64> {
    let decades = highest.log10() - lowest.log10();
    let digits: &[f64] = if decades > 2.5 {
        &[1.0]
    } else {
        &[1.0, 2.0, 5.0]
    };
    // An exponent on each side more than rounding may need; what is too much is cut off.
    let first = lowest.log10().floor() as i32 - 1;
    let last = highest.log10().ceil() as i32 + 1;
    let all: Vec<f64> = (first..=last)
        .flat_map(|exponent| {
            digits
                .iter()
                .map(move |digit| digit * 10_f64.powi(exponent))
        })
        .collect();
    let from = all.iter().rposition(|tick| *tick <= lowest).unwrap_or(0);
    let to = all.iter().position(|tick| *tick >= highest);
    // One value alone still needs an axis with a length.
    let to = to.unwrap_or(all.len() - 1).max(from + 1);
    all[from..=to].to_vec()
}

impl Ticks {
    /// Where along the axis a value stands, from 0 to 1.
    pub(crate) fn part(&self, value: f64) -> f64 {
        let (first, last) = (self.at[0], self.at[self.at.len() - 1]);
        match self.scale {
            Scale::Linear | Scale::Whole | Scale::Span => (value - first) / (last - first),
            Scale::Log => (value / first).ln() / (last / first).ln(),
        }
    }
}

/// A tick's name: `20 k` for 20,000.
pub(crate) fn label(value: f64) -> String {
    let (number, unit) = match value {
        _ if value >= 1e6 => (value / 1e6, " M"),
        _ if value >= 1e4 => (value / 1e3, " k"),
        _ => (value, ""),
    };
    // Without the noise of the last bits.
    let number = (number * 1e6).round() / 1e6;
    format!("{number}{unit}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ticks(scale: Scale, values: &[f64]) -> Vec<f64> {
        scale.ticks(values.iter().copied()).at
    }

    #[test]
    fn linear_axes_begin_at_zero_and_hold_the_highest() {
        assert_eq!(
            ticks(Scale::Linear, &[1.0, 9.0]),
            [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]
        );
        assert_eq!(ticks(Scale::Linear, &[]).first(), Some(&0.0));
        assert_eq!(ticks(Scale::Linear, &[0.0]), ticks(Scale::Linear, &[1.0]));
        assert_eq!(ticks(Scale::Whole, &[2.0]), [0.0, 1.0, 2.0]);
    }

    #[test]
    fn spans_hold_their_values_and_little_else() {
        assert_eq!(
            ticks(Scale::Span, &[31.0, 34.5]),
            [31.0, 31.5, 32.0, 32.5, 33.0, 33.5, 34.0, 34.5]
        );
        assert!(ticks(Scale::Span, &[7.0]).len() > 1);
        assert!(ticks(Scale::Span, &[]).len() > 1);
    }

    #[test]
    fn logarithmic_axes_end_at_ticks() {
        assert_eq!(ticks(Scale::Log, &[3.0, 30_000.0]).len(), 6);
        assert_eq!(
            ticks(Scale::Log, &[3.0, 30.0]),
            [2.0, 5.0, 10.0, 20.0, 50.0]
        );
        assert_eq!(ticks(Scale::Log, &[0.0, 10.0]), [10.0, 20.0]);
        assert_eq!(ticks(Scale::Log, &[0.0]), [1.0, 2.0]);
    }

    #[test]
    fn parts_run_from_0_to_1() {
        let log = Scale::Log.ticks([1.0, 10_000.0].into_iter());
        assert_eq!(log.part(1.0), 0.0);
        assert!((log.part(100.0) - 0.5).abs() < 1e-12);
        let linear = Scale::Linear.ticks([9.0].into_iter());
        assert_eq!([linear.part(0.0), linear.part(10.0)], [0.0, 1.0]);
    }

    #[test]
    fn labels_are_short() {
        let labels = [0.1 + 0.2, 1000.0, 20_000.0, 1.5e6].map(label);
        assert_eq!(labels, ["0.3", "1000", "20 k", "1.5 M"]);
    }
}
