//! What a user may write where a command takes a path.

use std::path::PathBuf;
use std::str::FromStr;

use super::{MOST_SECS, Turntable};

/// The most views that `orbit:N` may ask for.
const MOST_VIEWS: u32 = 100_000;

/// Where a path comes from.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum PathSource {
    /// Once around the scene, in as many pictures as the command takes.
    Orbit,
    /// Once around the scene, in so many pictures.
    OrbitOf(u32),
    /// A turn around the scene.
    Turntable(Turntable),
    /// That of the session that the command takes.
    Session,
    /// A file: a path, a session with one, or views.
    File(PathBuf),
}

impl FromStr for PathSource {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim();
        if let Some(count) = text.strip_prefix("orbit:") {
            return match count.parse() {
                Ok(count @ 1..=MOST_VIEWS) => Ok(Self::OrbitOf(count)),
                _ => Err(format!(
                    "expected orbit:N with N from 1 to {MOST_VIEWS}, such as orbit:60"
                )),
            };
        }
        if let Some(numbers) = text.strip_prefix("turntable:") {
            return turntable(numbers).map(Self::Turntable).ok_or_else(|| {
                format!(
                    "expected turntable:SECONDS or turntable:SECONDS:DEGREES with seconds above 0, up to {MOST_SECS}, such as turntable:4"
                )
            });
        }
        match text {
            "" => Err("expected FILE, turntable:SECONDS[:DEGREES] or orbit:N".to_owned()),
            "orbit" => Ok(Self::Orbit),
            "session" => Ok(Self::Session),
            "turntable" => Err("expected turntable:SECONDS, such as turntable:4".to_owned()),
            file => Ok(Self::File(file.into())),
        }
    }
}

impl PathSource {
    /// As the command line has it.
    pub(crate) fn text(&self) -> String {
        match self {
            Self::Orbit => "orbit".to_owned(),
            Self::OrbitOf(count) => format!("orbit:{count}"),
            Self::Turntable(Turntable {
                seconds, degrees, ..
            }) => format!("turntable:{seconds}:{degrees}"),
            Self::Session => "session".to_owned(),
            Self::File(path) => path.to_string_lossy().into_owned(),
        }
    }
}

fn turntable(numbers: &str) -> Option<Turntable> {
    let mut parts = numbers.split(':');
    let seconds: f64 = parts.next()?.trim().parse().ok()?;
    let degrees: f64 = parts
        .next()
        .map_or(Some(360.0), |text| text.trim().parse().ok())?;
    let fits = seconds > 0.0 && seconds <= MOST_SECS && degrees.is_finite();
    (fits && parts.next().is_none()).then(|| Turntable::new(seconds, degrees))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sources_are_told_apart_and_written_back() {
        for (text, expected) in [
            ("orbit", PathSource::Orbit),
            ("orbit:8", PathSource::OrbitOf(8)),
            (
                "turntable:4",
                PathSource::Turntable(Turntable::new(4.0, 360.0)),
            ),
            (
                "turntable:0.5:-90",
                PathSource::Turntable(Turntable::new(0.5, -90.0)),
            ),
            ("session", PathSource::Session),
            ("ways/a.toml", PathSource::File("ways/a.toml".into())),
        ] {
            let source: PathSource = text.parse().expect(text);
            assert_eq!(source, expected);
            assert_eq!(source.text().parse(), Ok(expected), "{text}");
        }
    }

    #[test]
    fn what_is_no_source_says_what_is_expected() {
        for (text, expected) in [
            ("", "expected FILE, turntable:SECONDS[:DEGREES] or orbit:N"),
            ("orbit:0", "expected orbit:N"),
            ("orbit:x", "expected orbit:N"),
            ("turntable", "such as turntable:4"),
            ("turntable:", "expected turntable:SECONDS"),
            ("turntable:-1", "expected turntable:SECONDS"),
            ("turntable:inf", "expected turntable:SECONDS"),
            ("turntable:4:NaN", "expected turntable:SECONDS"),
            ("turntable:4:360:2", "expected turntable:SECONDS"),
        ] {
            let error = text.parse::<PathSource>().expect_err(text);
            assert!(error.contains(expected), "{text}: {error}");
        }
    }
}
