//! Tables of Markdown.

/// A table in columns for those who read it as text.
///
/// * `cells`: the rows, all as long as the first, which is the head.
/// * `words`: columns of words, on the left; those after them are of numbers, and end at the same place.
pub(crate) fn table<Cell: AsRef<str>>(words: usize, cells: &[Vec<Cell>]) -> String {
    let Some((head, body)) = cells.split_first() else {
        return String::new();
    };
    let widths: Vec<usize> = (0..head.len())
        .map(|column| {
            let cells = cells.iter().filter_map(|row| row.get(column));
            let widths = cells.map(|cell| cell.as_ref().chars().count());
            widths.max().unwrap_or(0)
        })
        .collect();
    let line = |row: &[Cell]| {
        let cells = row.iter().zip(&widths).enumerate();
        let cells = cells.map(|(column, (cell, width))| {
            let cell = cell.as_ref();
            if column < words {
                format!(" {cell:width$} |")
            } else {
                format!(" {cell:>width$} |")
            }
        });
        format!("|{}\n", cells.collect::<String>())
    };
    let rule = widths.iter().enumerate().map(|(column, width)| {
        let end = if column < words { '-' } else { ':' };
        format!("{}{end}|", "-".repeat(width + 1))
    });
    let mut text = line(head);
    text.extend(["|", &rule.collect::<String>(), "\n"]);
    text.extend(body.iter().map(|row| line(row)));
    text
}

#[cfg(test)]
mod tests {
    use super::table;

    #[test]
    fn words_start_and_numbers_end_at_the_same_place() {
        let cells = [
            vec!["model", "triangles"],
            vec!["a longer one", "7"],
            vec!["é", "–"],
        ];
        let expected = "\
| model        | triangles |
|--------------|----------:|
| a longer one |         7 |
| é            |         – |
";
        assert_eq!(table(1, &cells), expected);
    }

    #[test]
    fn nothing_is_no_table() {
        assert_eq!(table::<&str>(1, &[]), "");
    }
}
