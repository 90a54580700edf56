//! Wrapping of text into lines.

/// The width of a text. Names contain only letters that are one column wide: Latin, Greek, digits.
pub fn characters(text: &str) -> usize {
    text.chars().count()
}

/// Lines of at most `width` columns, the first one indented by `first`, the others by `others`; each ends in a line feed.
pub fn fill_lines(text: &str, first: usize, others: usize, width: usize) -> String {
    let mut lines = String::new();
    let mut indent = first;
    let mut rest = text;
    loop {
        let (line, after) = split_at_width(rest, width.saturating_sub(indent));
        lines += &format!("{:indent$}{line}\n", "");
        (rest, indent) = (after, others);
        if rest.is_empty() {
            return lines;
        }
    }
}

/// The lines of a text of this width.
pub fn wrap_lines(text: &str, width: usize) -> Vec<&str> {
    let (mut line, mut rest) = split_at_width(text, width);
    let mut lines = vec![line];
    while !rest.is_empty() {
        (line, rest) = split_at_width(rest, width);
        lines.push(line);
    }
    lines
}

/// The width of the longest part of a text that cannot be broken.
pub fn longest_word(text: &str) -> usize {
    let ends = breaks(text).chain([text.len()]);
    let mut start = 0;
    ends.map(|end| characters(&text[std::mem::replace(&mut start, end + 1)..end])).max().unwrap_or(0)
}

/// The part that fits into the first line, and the rest. A word that is longer than the line is not broken.
fn split_at_width(text: &str, width: usize) -> (&str, &str) {
    if characters(text) <= width {
        return (text, "");
    }
    let mut end = None;
    for at in breaks(text) {
        if end.is_some() && characters(&text[..at]) > width {
            break;
        }
        end = Some(at);
    }
    end.map_or((text, ""), |at| (text[..at].trim_end_matches(' '), text[at..].trim_start_matches(' ')))
}

/// Positions at which a line may end: spaces, except one before a bracket, which belongs to the name before it.
fn breaks(text: &str) -> impl Iterator<Item = usize> {
    text.match_indices(' ').map(|(at, _)| at).filter(|at| *at > 0 && !text[at + 1..].starts_with(['[', ' ']))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_filled_and_related_words_are_not_split() {
        assert_eq!(fill_lines("one two three four", 0, 2, 9), "one two\n  three\n  four\n");
        assert_eq!(fill_lines("q = (a [m], b [m])", 2, 4, 12), "  q =\n    (a [m],\n    b [m])\n");
        assert_eq!(fill_lines("12.5\u{a0}Hz to 13.5\u{a0}Hz", 0, 0, 8), "12.5\u{a0}Hz\nto\n13.5\u{a0}Hz\n");
    }

    #[test]
    fn a_long_word_stays_whole() {
        assert_eq!(wrap_lines("a abcdefghij b", 4), ["a", "abcdefghij", "b"]);
        assert_eq!(wrap_lines("", 4), [""]);
        assert_eq!(longest_word("a abcdefghij [m] b"), "abcdefghij [m]".len());
        assert_eq!(longest_word(""), 0);
    }
}
