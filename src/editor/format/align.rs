//! Turns lines into text, with the names, values and comments of neighbouring declarations aligned in columns. See
//! spec.md#layout.

use super::layout::{Content, Line, Sort};

/// The text of the lines, each with its line end.
pub(super) fn text(lines: &[Line]) -> String {
    let mut text = String::new();
    for group in lines.chunk_by(|a, b| a.group == b.group && a.indent == b.indent) {
        let columns = Columns::of(group);
        let codes: Vec<String> = group.iter().map(|line| columns.code(&line.content)).collect();
        let beside = group.iter().zip(&codes).filter(|(line, code)| line.comment.is_some() && !code.is_empty());
        let column = beside.map(|(_, code)| width(code)).max().unwrap_or(0) + BEFORE_COMMENT;
        for (line, code) in group.iter().zip(&codes) {
            push_line(&mut text, line, code, column);
        }
    }
    text
}

/// Spaces between a declaration and the comment after it.
const BEFORE_COMMENT: usize = 2;

fn push_line(text: &mut String, line: &Line, code: &str, column: usize) {
    if line.content != Content::Blank {
        push_blanks(text, line.indent);
        *text += code;
        if let Some(comment) = &line.comment {
            push_blanks(text, if code.is_empty() { 0 } else { column - width(code) });
            *text += comment;
        }
    }
    text.push('\n');
}

fn push_blanks(text: &mut String, count: usize) {
    text.extend(std::iter::repeat_n(' ', count));
}

fn width(text: &str) -> usize {
    text.chars().count()
}

/// The widest keyword of a group, and its widest name of each kind.
struct Columns {
    keyword: usize,
    values: usize,
    ends: usize,
    fields: usize,
}

impl Columns {
    fn of(group: &[Line]) -> Columns {
        let mut columns = Columns { keyword: 0, values: 0, ends: 0, fields: 0 };
        for line in group {
            let Content::Named { keyword, name, sort, .. } = &line.content else { continue };
            columns.keyword = columns.keyword.max(width(keyword));
            let widest = match sort {
                Sort::Value => &mut columns.values,
                Sort::Ends => &mut columns.ends,
                Sort::Fields => &mut columns.fields,
            };
            *widest = (*widest).max(width(name));
        }
        columns
    }

    fn code(&self, content: &Content) -> String {
        let Content::Named { keyword, name, sort, rest } = content else {
            let Content::Plain(line) = content else { return String::new() };
            return line.clone();
        };
        let mut code = String::new();
        if !keyword.is_empty() {
            code += keyword;
            push_blanks(&mut code, self.keyword - width(keyword) + 1);
        }
        code += name;
        let column = match sort {
            Sort::Value => self.values,
            Sort::Fields => self.fields,
            Sort::Ends => {
                code.push(':');
                self.ends
            }
        };
        push_blanks(&mut code, column - width(name) + 1);
        code + rest
    }
}
