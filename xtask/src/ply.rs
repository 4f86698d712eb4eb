//! The header of a binary PLY file of surfels, or of a mesh.

/// Header of `count` vertices.
///
/// * `columns`: types, each with the names of its properties, in the file's order.
pub(crate) fn header(comments: &[&str], count: usize, columns: &[(&str, &str)]) -> String {
    format!("{}end_header\n", vertices(comments, count, columns))
}

/// Header of `counts[0]` vertices, followed by `counts[1]` faces: each a byte, its number of corners, and their indices as i32.
pub(crate) fn mesh_header(
    comments: &[&str],
    counts: [usize; 2],
    columns: &[(&str, &str)],
) -> String {
    let [vertex_count, face_count] = counts;
    format!(
        "{}element face {face_count}\nproperty list uchar int vertex_indices\nend_header\n",
        vertices(comments, vertex_count, columns)
    )
}

fn vertices(comments: &[&str], count: usize, columns: &[(&str, &str)]) -> String {
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
    text
}
