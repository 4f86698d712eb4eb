//! Pieces of HTML. Everything that comes from a file, a plugin or a command line goes through [`text`].

use std::fmt::Write as _;

/// A text as HTML carries it, in elements and in quoted attributes.
pub(super) fn text(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\'' => safe.push_str("&#39;"),
            letter => safe.push(letter),
        }
    }
    safe
}

/// A table; cells are HTML.
#[derive(Default)]
pub(super) struct Table {
    /// Columns of words before those of numbers.
    pub(super) words: usize,
    /// Above the columns.
    pub(super) head: Vec<String>,
    /// Each as long as the head.
    pub(super) rows: Vec<Vec<String>>,
}

impl Table {
    /// The table, scrolling sideways where it is wider than the page.
    pub(super) fn html(&self) -> String {
        let class = |column: usize| if column < self.words { "" } else { " class=n" };
        let mut html = "<div class=wide><table><thead><tr>".to_owned();
        for (column, cell) in self.head.iter().enumerate() {
            let _ = write!(html, "<th scope=col{}>{cell}</th>", class(column));
        }
        html.push_str("</tr></thead><tbody>");
        for row in &self.rows {
            html.push_str("<tr>");
            for (column, cell) in row.iter().enumerate() {
                // What a row is about stands in its first column.
                if column == 0 {
                    let _ = write!(html, "<th scope=row>{cell}</th>");
                } else {
                    let _ = write!(html, "<td{}>{cell}</td>", class(column));
                }
            }
            html.push_str("</tr>");
        }
        html.push_str("</tbody></table></div>\n");
        html
    }
}

/// A list of names and values; both are HTML.
pub(super) fn facts(facts: &[(&str, String)]) -> String {
    let mut html = "<dl>".to_owned();
    for (name, value) in facts {
        let _ = write!(html, "<dt>{name}</dt><dd>{value}</dd>");
    }
    html.push_str("</dl>\n");
    html
}

/// What is shown only when it is asked for; both are HTML.
pub(super) fn folded(summary: &str, body: &str) -> String {
    format!("<details><summary>{summary}</summary>{body}</details>\n")
}

/// A number of so many decimals, or a dash.
pub(super) fn number(number: Option<f64>, decimals: usize) -> String {
    match number {
        Some(number) if number.is_finite() => format!("{number:.decimals$}"),
        _ => "–".to_owned(),
    }
}

/// A time in ms, of three digits that mean something.
pub(super) fn millis(ms: Option<f64>) -> String {
    let decimals = match ms {
        Some(ms) if ms >= 100.0 => 0,
        Some(ms) if ms >= 10.0 => 1,
        _ => 2,
    };
    number(ms, decimals)
}

/// A count with its thousands apart.
pub(super) fn count(count: usize) -> String {
    let digits = count.to_string();
    let mut grouped = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            grouped.push(',');
        }
        grouped.push(digit);
    }
    grouped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_text_leaves_its_element_or_attribute() {
        let safe = text("</script><img src=x onerror='a(\"b\")'>&amp;");
        assert!(!safe.contains(['<', '>', '"', '\'']), "{safe}");
        assert!(safe.ends_with("&amp;amp;"), "{safe}");
    }

    #[test]
    fn numbers_are_short_and_counts_are_grouped() {
        assert_eq!(
            [0, 999, 35_947, 1_091_780].map(count),
            ["0", "999", "35,947", "1,091,780"]
        );
        let times = [Some(0.123), Some(12.34), Some(1234.5), None, Some(f64::NAN)].map(millis);
        assert_eq!(times, ["0.12", "12.3", "1234", "–", "–"]);
    }

    #[test]
    fn numbers_stand_to_the_right_of_words() {
        let table = Table {
            words: 1,
            head: vec!["who".to_owned(), "ms".to_owned()],
            rows: vec![vec!["a".to_owned(), "1".to_owned()]],
        };
        let html = table.html();
        assert!(
            html.contains("<th scope=row>a</th><td class=n>1</td>"),
            "{html}"
        );
    }
}
