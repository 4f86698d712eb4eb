//! Names of the files of several views, and of the pictures of a film.

use std::path::{Path, PathBuf};

/// The file for view `index` of `count`: `path` itself for one view, else with a number before the extension, wide enough
/// that names sort (`x_000.png`, at least three digits).
pub(crate) fn for_view(path: &Path, index: usize, count: usize) -> PathBuf {
    if count == 1 {
        return path.to_path_buf();
    }
    let mut name = path.file_stem().unwrap_or_default().to_os_string();
    name.push(format!("_{}", number(index, count)));
    if let Some(extension) = path.extension() {
        name.push(".");
        name.push(extension);
    }
    path.with_file_name(name)
}

/// The file for picture `index` of a film of `count`: its number stands where the name has `%04d` (with as many digits, and as
/// many zeros before them, as that says; `%d` has no zeros), else before the extension as for views, also if there is only one.
pub(crate) fn for_frame(path: &Path, index: usize, count: usize) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    match pattern_in(&name) {
        Some((start, end, digits)) => path.with_file_name(format!(
            "{}{index:0digits$}{}",
            &name[..start],
            &name[end..]
        )),
        None => for_view(path, index, count.max(2)),
    }
}

/// Where the first `%d` or `%0Nd` of a name begins and ends, and N.
fn pattern_in(name: &str) -> Option<(usize, usize, usize)> {
    name.match_indices('%').find_map(|(start, _)| {
        let rest = &name[start + 1..];
        let length = rest.find(|letter: char| !letter.is_ascii_digit())?;
        let digits = &rest[..length];
        // Nobody has more pictures than ten digits count, and `%4d` would pad with blanks.
        let is_padded = digits.starts_with('0') && digits.len() <= 3;
        let is_pattern = rest[length..].starts_with('d') && (digits.is_empty() || is_padded);
        let digits = digits.parse().unwrap_or(0).min(10);
        is_pattern.then_some((start, start + 1 + length + 1, digits))
    })
}

/// The number of view `index` of `count`, at least three digits and as many as the last one has.
pub(crate) fn number(index: usize, count: usize) -> String {
    let digits = count.saturating_sub(1).to_string().len().max(3);
    format!("{index:0digits$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_view_keeps_the_name() {
        assert_eq!(for_view(Path::new("a/b.png"), 0, 1), Path::new("a/b.png"));
    }

    #[test]
    fn pictures_of_a_film_have_their_number_where_the_name_says() {
        for (name, expected) in [
            ("a/turn_%04d.png", "a/turn_0007.png"),
            ("%d.png", "7.png"),
            ("50%_%03d.exr", "50%_007.exr"),
            ("turn.png", "turn_007.png"),
            ("%4d.png", "%4d_007.png"),
            ("100%.png", "100%_007.png"),
        ] {
            assert_eq!(
                for_frame(Path::new(name), 7, 8),
                Path::new(expected),
                "{name}"
            );
        }
        assert_eq!(for_frame(Path::new("a.png"), 0, 1), Path::new("a_000.png"));
    }

    #[test]
    fn several_views_are_numbered_before_the_extension() {
        assert_eq!(
            for_view(Path::new("a/b.c.png"), 7, 8),
            Path::new("a/b.c_007.png")
        );
        assert_eq!(for_view(Path::new("b"), 7, 20_000), Path::new("b_00007"));
    }
}
