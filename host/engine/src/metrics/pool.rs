//! Numbers for a region from a map of numbers a pixel.

/// The map's values in the region.
pub(super) fn values_in(map: &[f32], mask: &[bool]) -> Vec<f32> {
    let pairs = map.iter().zip(mask);
    pairs
        .filter_map(|(value, is_in)| is_in.then_some(*value))
        .collect()
}

/// The mean; none of nothing.
pub(super) fn mean(values: &[f32]) -> Option<f64> {
    let sum: f64 = values.iter().map(|value| f64::from(*value)).sum();
    (!values.is_empty()).then(|| sum / values.len() as f64)
}

/// The least value that at least `fraction` (0..1) of the values do not exceed (the nearest rank, nothing is
/// interpolated); none of nothing. Reorders the values.
pub(super) fn percentile(values: &mut [f32], fraction: f64) -> Option<f64> {
    let rank = (fraction * values.len() as f64).ceil() as usize;
    let index = rank.max(1).min(values.len()).checked_sub(1)?;
    let (_, value, _) = values.select_nth_unstable_by(index, f32::total_cmp);
    Some(f64::from(*value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_percentile_is_one_of_the_values() {
        let mut values: Vec<f32> = (1..=200).rev().map(|value| value as f32).collect();
        assert_eq!(percentile(&mut values, 0.99), Some(198.0));
        assert_eq!(percentile(&mut values, 1.0), Some(200.0));
        assert_eq!(percentile(&mut values, 0.0), Some(1.0));
        assert_eq!(percentile(&mut [3.0], 0.99), Some(3.0));
        assert_eq!(percentile(&mut [], 0.99), None);
    }

    #[test]
    fn the_mean_is_over_the_mask_alone() {
        let values = values_in(&[1.0, 5.0, 3.0], &[true, false, true]);
        assert_eq!(mean(&values), Some(2.0));
        assert_eq!(mean(&[]), None);
    }
}
