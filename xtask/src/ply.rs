//! The header of a binary PLY file of surfels.

/// Header of `count` vertices.
///
/// * `columns`: types, each with the names of its properties, in the file's order.
pub(crate) fn header(comments: &[&str], count: usize, columns: &[(&str, &str)]) -> String {
    let mut text = String::from("ply\nformat binary_little_endian 1.0\n");
    for comment in comments {
        text.extend(["comment ", comment, "\n"]);
    }
    text.extend(["element vertex ", &count.to_string(), "\n"]);
    for (kind, names) in columns {
        for name in names.split(' ') {
            text.extend(["property ", kind, " ", name, "\n"]);
        }
    }
    text.push_str("end_header\n");
    text
}
