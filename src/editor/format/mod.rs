//! The one layout of a model file. See spec.md#layout.
//!
//! In: a text that conforms to the grammar, and its tree. Out: the same declarations and comments in the same order,
//! laid out by rules that ignore the previous layout, so that formatting twice changes nothing. `items` splits the text
//! into declarations, comments and blank lines, `layout` turns them into lines, `spacing` places the spaces in a line,
//! and `align` aligns the columns of neighbouring lines.

mod align;
mod items;
mod layout;
mod spacing;

use super::tokens;
use crate::syntax::tree::Tree;

/// The most columns of a declaration on one line, before alignment.
const WIDTH: usize = 100;

/// Spaces for each level of indentation.
const INDENT: usize = 2;

/// Formats a text; `tree` is the result of parsing it without errors.
pub fn format(text: &str, tree: &Tree) -> String {
    let tokens = tokens::tokens(text);
    let items = items::items(text, &tokens);
    let lines = layout::lines(text, tree, &tokens, &items);
    let formatted = align::text(&lines);
    // A file keeps the line endings of its first line.
    let first = text.lines().next().map_or(0, str::len);
    if text[first..].starts_with("\r\n") { formatted.replace('\n', "\r\n") } else { formatted }
}
