//! Names of the files of several views.

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
    fn several_views_are_numbered_before_the_extension() {
        assert_eq!(
            for_view(Path::new("a/b.c.png"), 7, 8),
            Path::new("a/b.c_007.png")
        );
        assert_eq!(for_view(Path::new("b"), 7, 20_000), Path::new("b_00007"));
    }
}
