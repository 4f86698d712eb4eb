//! `cargo xtask sample`: a model of our own, a snake tied into a trefoil knot.
//!
//! [`knot`] is the curve, [`skin`] the relief and the colours on the tube around it, [`surfels`] cuts the tube into
//! elliptical surfels, [`ply`] writes them. Nothing is random: the same command makes the same model.

use std::path::PathBuf;

use crate::{Outcome, paths, process};

mod knot;
mod ply;
mod skin;
mod surfels;
mod vector;

/// Surfels in the committed file: what fits beside the scan in 10 MB.
const COMMITTED_SURFELS: usize = 96_000;

/// Writes the sample with about the number of surfels asked for.
pub(crate) fn sample(arguments: &[String]) -> Outcome {
    let (count, file) = parse(arguments)?;
    let surfels = surfels::cut(count);
    process::say(&format!(
        "writing {} surfels to {}",
        surfels.len(),
        paths::shown(&file)
    ));
    std::fs::write(&file, ply::encode(&surfels))
        .map_err(|error| format!("{}: {error}", file.display()))
}

fn parse(arguments: &[String]) -> Outcome<(usize, PathBuf)> {
    let mut count = COMMITTED_SURFELS;
    let mut file = paths::root().join("sample-data").join("knotted_snake.ply");
    let mut words = arguments.iter();
    while let Some(word) = words.next() {
        let value = words
            .next()
            .ok_or_else(|| format!("'{word}' needs a value; see `cargo xtask help`"))?;
        match word.as_str() {
            "--surfels" => {
                let number = value
                    .parse()
                    .ok()
                    .filter(|number| (1_000..=100_000_000).contains(number));
                count = number.ok_or_else(|| {
                    format!("--surfels {value}: expected a number from 1000 to 100000000")
                })?;
            }
            "--out" => file = PathBuf::from(value),
            _ => {
                return Err(format!(
                    "'{word}' was not expected here; see `cargo xtask help`"
                ));
            }
        }
    }
    Ok((count, file))
}

#[cfg(test)]
mod tests {
    use super::{COMMITTED_SURFELS, paths, ply, surfels, vector};

    #[test]
    fn axes_are_orthogonal_to_each_other_and_to_the_normal() {
        for surfel in surfels::cut(2_000) {
            let (u, v) = (surfel.u, surfel.v);
            assert!(
                u.dot(v).abs() < 1e-9 * u.length() * v.length(),
                "{surfel:?}"
            );
            assert!(u.dot(surfel.normal).abs() < 1e-9 * u.length(), "{surfel:?}");
            assert!(
                u.cross(v).dot(surfel.normal) > 0.0,
                "u, v, normal must be right-handed: {surfel:?}"
            );
        }
    }

    #[test]
    fn neighbouring_surfels_overlap() {
        let surfels = surfels::cut(2_000);
        for pair in surfels.windows(2) {
            let distance = (pair[1].centre - pair[0].centre).length();
            let reach = pair[0].u.length().max(pair[0].v.length())
                + pair[1].u.length().max(pair[1].v.length());
            // The last of a ring and the first of the next may lie apart.
            assert!(
                distance < reach || distance > 0.2,
                "{distance} apart, reach {reach}"
            );
        }
    }

    #[test]
    fn the_committed_file_is_what_the_command_makes() {
        let file = paths::root().join("sample-data").join("knotted_snake.ply");
        let committed = std::fs::read(&file).expect("the sample is part of the repository");
        let made = ply::encode(&surfels::cut(COMMITTED_SURFELS));
        assert_eq!(committed.len(), made.len(), "run `cargo xtask sample`");
        let body = made.len() - surfels::cut(COMMITTED_SURFELS).len() * ply::BYTES_PER_SURFEL;
        assert_eq!(committed[..body], made[..body], "run `cargo xtask sample`");
        let centres = |bytes: &[u8]| -> Vec<vector::Vector> {
            bytes[body..]
                .chunks_exact(ply::BYTES_PER_SURFEL)
                .map(ply::decode_centre)
                .collect()
        };
        // Sine and cosine may differ in the last place between C libraries.
        let apart = centres(&committed)
            .iter()
            .zip(centres(&made))
            .map(|(a, b)| (*a - b).length())
            .fold(0.0, f64::max);
        assert!(
            apart < 1e-5,
            "centres differ by up to {apart}; run `cargo xtask sample`"
        );
    }
}
