//! The one layout of a model file. See spec.md#layout.
//!
//! In: a text that is in the grammar, and its tree. Out: the same declarations and comments in the same order, laid out by
//! rules that do not ask how they were laid out before, so that laying out twice changes nothing. `items` cuts the text
//! into declarations, comments and blank lines, `layout` makes lines of them, `spacing` says where blanks stand in a line,
//! and `align` sets the columns of neighbouring lines.

mod align;
mod items;
mod layout;
mod spacing;

use super::tokens;
use crate::syntax::tree::Tree;

/// Columns that a declaration on one line may take, before columns are aligned.
const WIDTH: usize = 100;

/// Blanks of a level.
const INDENT: usize = 2;

/// The text in its one layout; `tree` is what was parsed from it without an error.
pub fn format(text: &str, tree: &Tree) -> String {
    let tokens = tokens::tokens(text);
    let items = items::items(text, &tokens);
    let lines = layout::lines(text, tree, &tokens, &items);
    let formatted = align::text(&lines);
    // A file keeps the kind of line end that its first line has.
    let first = text.lines().next().map_or(0, str::len);
    if text[first..].starts_with("\r\n") { formatted.replace('\n', "\r\n") } else { formatted }
}
