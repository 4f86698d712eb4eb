//! The names nearest to one that nobody knows, so that a message can say 'did you mean …?'.

/// At most so many names are offered.
const MOST: usize = 3;

/// Up to three of `candidates` that `unknown` may have meant, nearest first; empty if none is near.
///
/// Near means: a third of the letters changed at most (two for short names), or one name contains the other. Letters
/// are compared without case.
///
/// ```
/// use pointstage_plugin_api::nearest::nearest_names;
/// assert_eq!(nearest_names("surfle", ["points", "surfel"]), ["surfel"]);
/// ```
pub fn nearest_names<S: AsRef<str>>(
    unknown: &str,
    candidates: impl IntoIterator<Item = S>,
) -> Vec<String> {
    let unknown: Vec<char> = unknown.to_lowercase().chars().collect();
    let text: String = unknown.iter().collect();
    let mut near: Vec<(usize, String)> = candidates
        .into_iter()
        .filter_map(|candidate| {
            let name = candidate.as_ref();
            let lower = name.to_lowercase();
            let letters: Vec<char> = lower.chars().collect();
            let distance = edit_distance(&unknown, &letters);
            let allowed = (unknown.len().max(letters.len()) / 3).max(2);
            let contained = text.len() >= 2 && (lower.contains(&text) || text.contains(&lower));
            (distance <= allowed || contained).then(|| (distance, name.to_owned()))
        })
        .collect();
    near.sort();
    near.dedup();
    near.truncate(MOST);
    near.into_iter().map(|(_, name)| name).collect()
}

/// `names` as the end of a message: `; did you mean 'a' or 'b'?`, or nothing.
pub fn did_you_mean(names: &[String]) -> String {
    if names.is_empty() {
        return String::new();
    }
    let quoted: Vec<String> = names.iter().map(|name| format!("'{name}'")).collect();
    format!("; did you mean {}?", quoted.join(" or "))
}

/// Levenshtein's distance: insertions, removals and replacements of one letter.
fn edit_distance(a: &[char], b: &[char]) -> usize {
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.iter().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, to) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(from != to);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_counts_single_letter_edits() {
        let letters = |text: &str| text.chars().collect::<Vec<_>>();
        assert_eq!(edit_distance(&letters("kitten"), &letters("sitting")), 3);
        assert_eq!(edit_distance(&letters(""), &letters("abc")), 3);
        assert_eq!(edit_distance(&letters("abc"), &letters("abc")), 0);
    }

    #[test]
    fn a_far_name_is_not_offered() {
        assert!(nearest_names("qsplat", ["points", "surfel"]).is_empty());
    }

    #[test]
    fn the_nearest_comes_first_and_containment_counts() {
        let names = ["point", "points", "org.pointstage.points"];
        assert_eq!(
            nearest_names("pointz", names),
            ["point", "points"],
            "both are one edit away"
        );
        assert_eq!(
            nearest_names("pointstage.points", names)[0],
            "org.pointstage.points"
        );
        assert_eq!(
            did_you_mean(&nearest_names("pointz", names)),
            "; did you mean 'point' or 'points'?"
        );
    }
}
