//! Breaks a formula into lines that fit a width: before a sign between its terms, inside brackets if a term is longer than
//! a line, and between factors if nothing else fits.

/// Indent of the first line, of its continuation, and of each level of brackets inside that.
const FIRST: usize = 4;
const NEXT: usize = 8;
const LEVEL: usize = 4;
/// Deeper brackets are not indented further.
const DEEPEST: usize = 20;

/// The formula in lines of at most `width` columns, each of which ends in a line feed. A name or a number that is longer
/// than a line is not broken.
pub fn break_lines(formula: &str, width: usize) -> String {
    let mut lines = Lines { text: " ".repeat(FIRST), column: FIRST, is_empty: true, width };
    lines.append(&words(formula), 0, NEXT);
    lines.text + "\n"
}

/// A part of a formula that contains no space, and how many brackets are open before it.
#[derive(Clone, Copy)]
struct Word<'a> {
    text: &'a str,
    depth: usize,
}

impl Word<'_> {
    fn is_sign(&self) -> bool {
        ["+", "-", "="].contains(&self.text)
    }
}

fn words(formula: &str) -> Vec<Word<'_>> {
    let mut depth = 0usize;
    let split = formula.split(' ').map(|text| {
        let word = Word { text, depth };
        for c in text.chars() {
            match c {
                '(' | '[' => depth += 1,
                ')' | ']' => depth = depth.saturating_sub(1),
                _ => {}
            }
        }
        word
    });
    split.collect()
}

/// The terms of a sum, each but the first with the sign before it, where `depth` brackets are open. The left side of an
/// equation of one word stays with what it is equal to.
fn terms<'a>(words: &'a [Word<'a>], depth: usize) -> Vec<&'a [Word<'a>]> {
    let starts = (2..words.len()).filter(|&at| words[at].depth == depth && words[at].is_sign());
    let starts: Vec<usize> = [0].into_iter().chain(starts).chain([words.len()]).collect();
    starts.windows(2).map(|ends| &words[ends[0]..ends[1]]).collect()
}

/// Columns that words take in one line.
fn columns(words: &[Word]) -> usize {
    words.iter().map(|word| word.text.chars().count() + 1).sum::<usize>().saturating_sub(1)
}

struct Lines {
    text: String,
    column: usize,
    /// Whether the line has nothing but its indent.
    is_empty: bool,
    width: usize,
}

impl Lines {
    /// Appends words that stand inside of `depth` brackets; lines after the present one have this indent.
    fn append(&mut self, words: &[Word], depth: usize, indent: usize) {
        if self.has_room(columns(words)) {
            return self.push(words);
        }
        // The outermost brackets between whose terms the words can be broken.
        let inside = |word: &&Word| word.depth >= depth && word.is_sign();
        let Some(depth) = words.iter().skip(2).filter(inside).map(|word| word.depth).min() else {
            return words.iter().for_each(|word| self.push_broken(std::slice::from_ref(word), indent));
        };
        for term in terms(words, depth) {
            if self.has_room(columns(term)) || indent + columns(term) <= self.width {
                self.push_broken(term, indent);
            } else {
                if !self.is_empty {
                    self.start_line(indent);
                }
                self.append(term, depth + 1, (indent + LEVEL).min(DEEPEST));
            }
        }
    }

    fn has_room(&self, columns: usize) -> bool {
        self.column + usize::from(!self.is_empty) + columns <= self.width
    }

    /// Appends words to the line, or to the next one if this one has no room.
    fn push_broken(&mut self, words: &[Word], indent: usize) {
        if !self.is_empty && !self.has_room(columns(words)) {
            self.start_line(indent);
        }
        self.push(words);
    }

    fn push(&mut self, words: &[Word]) {
        for word in words {
            if !self.is_empty {
                self.text.push(' ');
                self.column += 1;
            }
            self.text += word.text;
            self.column += word.text.chars().count();
            self.is_empty = false;
        }
    }

    fn start_line(&mut self, indent: usize) {
        self.text += &format!("\n{:indent$}", "");
        (self.column, self.is_empty) = (indent, true);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_formula_that_fits_is_one_line() {
        assert_eq!(break_lines("m x'' + k x = F", 20), "    m x'' + k x = F\n");
    }

    #[test]
    fn lines_end_before_signs() {
        let expected = "    m x'' + c x'\n        + k x = F\n";
        assert_eq!(break_lines("m x'' + c x' + k x = F", 18), expected);
    }

    /// A quotient whose numerator is longer than a line.
    #[test]
    fn a_long_term_is_broken_inside_its_brackets() {
        let expected = "    y/F = (a b s^2\n        + c d s\n        + e)/Delta\n";
        assert_eq!(break_lines("y/F = (a b s^2 + c d s + e)/Delta", 22), expected);
    }

    #[test]
    fn factors_are_broken_if_there_is_no_sign() {
        assert_eq!(break_lines("aaaa bbbb cccc", 14), "    aaaa bbbb\n        cccc\n");
        assert_eq!(break_lines("aaaaaaaaaaaaaaaaaaaa b", 14), "    aaaaaaaaaaaaaaaaaaaa\n        b\n");
    }

    /// Whatever the width, the words stay, in their order.
    #[test]
    fn nothing_is_lost() {
        let formula = "h = -(4 cos(a - b) + 3 sin(a - b))/(2 (2 cos(c - b) - sin(c - b))) + [1, 2; 3, 4] - x";
        for width in 0..120 {
            let text = break_lines(formula, width);
            assert_eq!(text.split_whitespace().collect::<Vec<_>>(), formula.split(' ').collect::<Vec<_>>());
            let widest = text.lines().map(|line| line.chars().count()).max();
            assert!(width < 40 || widest <= Some(width), "{width}:\n{text}");
        }
    }
}
