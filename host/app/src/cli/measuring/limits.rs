//! Limits that what was found must keep, for scripts that guard pictures and times.

use std::str::FromStr;

use crate::cli::{Failure, Outcome};

/// `QUANTITY=NUMBER`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Limit {
    /// What is limited.
    pub(crate) quantity: String,
    /// Up to which value, or down to which.
    pub(crate) bound: f64,
}

impl FromStr for Limit {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let expected = || "expected QUANTITY=NUMBER, such as flip=0.02".to_owned();
        let (quantity, bound) = text.split_once('=').ok_or_else(expected)?;
        match bound.trim().parse::<f64>() {
            Ok(bound) if bound.is_finite() && !quantity.trim().is_empty() => Ok(Self {
                quantity: quantity.trim().to_owned(),
                bound,
            }),
            _ => Err(expected()),
        }
    }
}

/// Which side of its bound a value must not be on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    /// Too great a value fails.
    Above,
    /// Too small a value fails.
    Below,
}

impl Side {
    fn option(self) -> &'static str {
        match self {
            Self::Above => "--fail-above",
            Self::Below => "--fail-below",
        }
    }
}

/// A value that was found, of somebody.
pub(crate) struct Found {
    /// Who or what, in words.
    pub(crate) of: String,
    /// Its value; none if there is none, which breaks a limit: a guard that sees nothing must not let pass.
    pub(crate) value: Option<f64>,
}

/// Refuses limits on what is not measured.
///
/// * `known`: the quantities that are.
pub(crate) fn check_names(limits: &[Limit], side: Side, known: &[&str]) -> Outcome {
    for Limit { quantity, .. } in limits {
        if !known.contains(&quantity.as_str()) {
            let option = side.option();
            return Err(Failure::usage(format!(
                "{option} {quantity}: expected one of {}",
                known.join(", ")
            )));
        }
    }
    Ok(())
}

/// What breaks the limits, in words; empty if all is well.
pub(crate) fn broken(
    limits: &[Limit],
    side: Side,
    found: impl Fn(&str) -> Vec<Found>,
) -> Vec<String> {
    let mut broken = Vec::new();
    for Limit { quantity, bound } in limits {
        for Found { of, value } in found(quantity) {
            let word = match side {
                Side::Above => "above",
                Side::Below => "below",
            };
            match value {
                // So that a value that is no number fails.
                Some(value) if side == Side::Above && value <= *bound => {}
                Some(value) if side == Side::Below && value >= *bound => {}
                Some(value) => {
                    broken.push(format!("{of}: {quantity} is {value:.5}, {word} {bound}"));
                }
                None => broken.push(format!("{of}: {quantity} was not measured")),
            }
        }
    }
    broken
}

/// Fails if anything is broken; the message names all of it.
pub(crate) fn check(broken: &[String]) -> Outcome {
    if broken.is_empty() {
        return Ok(());
    }
    Err(Failure::Failed(anyhow::anyhow!(
        "{} beyond the limits that were set: {}",
        if broken.len() == 1 {
            "1 value is".to_owned()
        } else {
            format!("{} values are", broken.len())
        },
        broken.join("; ")
    )))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_is_a_name_and_a_number() {
        let limit = Limit::from_str("flip = 0.02").expect("well formed");
        assert_eq!((limit.quantity.as_str(), limit.bound), ("flip", 0.02));
        for bad in ["flip", "=1", "flip=", "flip=NaN", "flip=x"] {
            let error = Limit::from_str(bad).expect_err(bad);
            assert!(error.contains("flip=0.02"), "{bad}: {error}");
        }
        let limits = [limit];
        check_names(&limits, Side::Above, &["flip"]).expect("known");
        match check_names(&limits, Side::Above, &["ms", "ssim"]) {
            Err(Failure::Usage(error)) => assert!(error.to_string().contains("ms, ssim")),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn what_is_beyond_or_missing_or_no_number_breaks_a_limit() {
        let limits = [Limit::from_str("a=2").expect("well formed")];
        let count = |side, value| {
            let found = |_: &str| {
                let of = "x".to_owned();
                vec![Found { of, value }]
            };
            broken(&limits, side, found).len()
        };
        for (value, above, below) in [
            (Some(2.0), 0, 0),
            (Some(2.1), 1, 0),
            (Some(1.9), 0, 1),
            (Some(f64::NAN), 1, 1),
            (None, 1, 1),
        ] {
            assert_eq!(count(Side::Above, value), above, "{value:?}");
            assert_eq!(count(Side::Below, value), below, "{value:?}");
        }
        check(&[]).expect("nothing is broken");
        assert!(matches!(check(&["x".to_owned()]), Err(Failure::Failed(_))));
    }
}
