//! A report as HTML: headings, sentences, tables, matrices as MathML. A name that is declared somewhere leads to its line.

use crate::answers::report::{Align, Block, Cell, Column, Line, Matrices, Named, Part, Table};
use crate::backend::decimal::certain_number;
use crate::backend::draw::escape;
use crate::backend::plain;
use crate::base::{FileId, LineIndex, Sources, Span};

/// Converts places to lines of the model.
pub struct Lines {
    model: Option<FileId>,
    index: LineIndex,
}

impl Lines {
    pub fn of(sources: &Sources, model: FileId) -> Lines {
        Lines { model: Some(model), index: LineIndex::new(sources.text(model)) }
    }

    /// For a page that does not show the model: nothing links to a line.
    pub fn none() -> Lines {
        Lines { model: None, index: LineIndex::new("") }
    }

    /// The line, counted from 1; `None` for places in other files.
    pub fn line(&self, span: Option<Span>) -> Option<usize> {
        span.filter(|span| Some(span.file()) == self.model).map(|span| self.index.line(span.start()) + 1)
    }

    /// ` data-line="17"`
    pub fn attribute(&self, span: Option<Span>) -> String {
        self.line(span).map_or(String::new(), |line| format!(" data-line=\"{line}\""))
    }
}

/// The blocks of a section. `entries`: the declarations behind each entry of its matrices.
pub fn blocks<'a>(
    blocks: impl IntoIterator<Item = &'a Block>,
    lines: &Lines,
    entries: &[Vec<Vec<Option<Span>>>],
) -> String {
    blocks.into_iter().map(|each| block(each, lines, entries)).collect()
}

fn block(block: &Block, lines: &Lines, entries: &[Vec<Vec<Option<Span>>>]) -> String {
    match block {
        Block::Line(of) => format!("<p>{}</p>\n", line(of, lines)),
        Block::Item(of) => format!("<p class=\"item\">{}</p>\n", line(of, lines)),
        Block::Table(of) => table(of, lines),
        Block::Matrices(of) => matrices(of, lines, entries),
    }
}

fn table(table: &Table, lines: &Lines) -> String {
    let class = |column: &Column| match column.align {
        Align::Left => "",
        Align::Right | Align::Point => " class=\"r\"",
    };
    let head = |column: &Column| {
        let unit =
            if column.unit.is_empty() { String::new() } else { format!("<small>{}</small>", escape(column.unit)) };
        // A column of units or signs has no title.
        match line(&column.title, lines) + &unit {
            title if title.is_empty() => "<td></td>".to_string(),
            title => format!("<th scope=\"col\"{}>{title}</th>", class(column)),
        }
    };
    let row = |cells: &Vec<Cell>| {
        let place = cells.iter().find_map(|cell| place(&cell.longest()));
        let cell = |(number, (cell, column)): (usize, (&Cell, &Column))| {
            let text = line(&cell.longest(), lines);
            let fails = if text == "NO" { " class=\"fails\"" } else { class(column) };
            match number {
                0 => format!("<th scope=\"row\"{fails}>{text}</th>"),
                _ => format!("<td{fails}>{text}</td>"),
            }
        };
        let cells: String = cells.iter().zip(&table.columns).enumerate().map(cell).collect();
        format!("<tr{}>{cells}</tr>\n", lines.attribute(place))
    };
    let head: String = table.columns.iter().map(head).collect();
    let rows: String = table.rows.iter().map(row).collect();
    // A wide table scrolls by itself; who uses a keyboard has to reach it.
    format!(
        "<div class=\"wide\" tabindex=\"0\" role=\"group\" aria-label=\"table\"><table><thead><tr>{head}</tr></thead>\n\
         <tbody>\n{rows}</tbody></table></div>\n"
    )
}

fn place(line: &Line) -> Option<Span> {
    line.parts.iter().find_map(|part| match part {
        Part::Named(named) => named.place,
        Part::Words(_) | Part::Figure(_) => None,
    })
}

pub fn line(line: &Line, lines: &Lines) -> String {
    let part = |part: &Part| match part {
        Part::Words(words) => escape(words),
        Part::Named(named) => name(named, lines),
        Part::Figure(number) => escape(&plain::figure(number)),
    };
    line.parts.iter().map(part).collect()
}

fn name(named: &Named, lines: &Lines) -> String {
    let text = escape(&named.text);
    match lines.line(named.place) {
        Some(line) => format!("<a href=\"#L{line}\" data-line=\"{line}\">{text}</a>"),
        None => text,
    }
}

fn matrices(of: &Matrices, lines: &Lines, entries: &[Vec<Vec<Option<Span>>>]) -> String {
    let one = |(which, (name, rows)): (usize, &(&'static str, Vec<Vec<crate::base::Number>>))| {
        let entry = |i: usize, j: usize, number: &crate::base::Number| {
            let made = entries.get(which).and_then(|rows| rows.get(i)?.get(j).copied().flatten());
            let shown = escape(&certain_number(number, of.digits));
            let shown = match shown.strip_prefix('-') {
                Some(size) => format!("<mo form=\"prefix\">−</mo><mn>{size}</mn>"),
                None => format!("<mn>{shown}</mn>"),
            };
            format!("<mtd{}><mrow>{shown}</mrow></mtd>", lines.attribute(made))
        };
        let rows: String = rows
            .iter()
            .enumerate()
            .map(|(i, row)| {
                let cells: String = row.iter().enumerate().map(|(j, number)| entry(i, j, number)).collect();
                format!("<mtr>{cells}</mtr>")
            })
            .collect();
        format!(
            "<math display=\"block\"><mi mathvariant=\"normal\">{name}</mi><mo>=</mo><mrow><mo>[</mo><mtable>{rows}</mtable>\
             <mo>]</mo></mrow></math>\n"
        )
    };
    let all: String = of.list.iter().enumerate().map(one).collect();
    format!("<div class=\"wide\" tabindex=\"0\" role=\"group\" aria-label=\"matrices\">\n{all}</div>\n")
}
