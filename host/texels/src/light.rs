//! sRGB and linear light, and means of colours.

use std::sync::LazyLock;

static LINEAR: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|byte| linear(byte as f32 / 255.0)));

/// Linear light of an sRGB value, IEC 61966-2-1; both 0 to 1.
pub fn linear(value: f32) -> f32 {
    if value <= 0.04045 {
        value / 12.92
    } else {
        ((value + 0.055) / 1.055).powf(2.4)
    }
}

/// Linear light of an sRGB byte.
pub fn linear_of(byte: u8) -> f32 {
    LINEAR[usize::from(byte)]
}

/// sRGB value of linear light, IEC 61966-2-1; clamped to 0 to 1.
pub fn srgb(light: f32) -> f32 {
    let light = light.clamp(0.0, 1.0);
    if light <= 0.003_130_8 {
        light * 12.92
    } else {
        1.055 * light.powf(1.0 / 2.4) - 0.055
    }
}

/// The sRGB byte nearest to linear light.
pub fn srgb_byte(light: f32) -> u8 {
    (srgb(light) * 255.0 + 0.5) as u8
}

/// Sum of colours times weights, to take their mean from: linear light, which counts as much as it covers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LightSum {
    /// Of red, green and blue times alpha.
    light: [f64; 3],
    alpha: f64,
    weight: f64,
}

impl LightSum {
    /// Adds linear light that is multiplied by its alpha, the fourth component.
    pub fn add(&mut self, [red, green, blue, alpha]: [f32; 4], weight: f64) {
        for (sum, value) in self.light.iter_mut().zip([red, green, blue]) {
            *sum += f64::from(value) * weight;
        }
        self.alpha += f64::from(alpha) * weight;
        self.weight += weight;
    }

    /// The mean, linear with straight alpha; black where nothing covers anything, `None` if nothing was added.
    pub fn mean(&self) -> Option<[f32; 4]> {
        if self.weight.is_nan() || self.weight <= 0.0 {
            return None;
        }
        let covered = if self.alpha > 0.0 { self.alpha } else { 1.0 };
        let [red, green, blue] = self.light.map(|sum| (sum / covered) as f32);
        Some([red, green, blue, (self.alpha / self.weight) as f32])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_and_linear_undo_each_other() {
        for byte in 0..=255_u8 {
            assert_eq!(srgb_byte(linear_of(byte)), byte);
            let value = f32::from(byte) / 255.0;
            assert!((srgb(linear(value)) - value).abs() < 1e-5, "{value}");
        }
    }

    #[test]
    fn what_cannot_be_seen_gives_no_colour() {
        let mut sum = LightSum::default();
        assert_eq!(sum.mean(), None);
        sum.add([0.5, 0.0, 0.0, 0.5], 1.0);
        sum.add([0.0, 0.0, 0.0, 0.0], 3.0);
        assert_eq!(sum.mean(), Some([1.0, 0.0, 0.0, 0.125]));
    }
}
