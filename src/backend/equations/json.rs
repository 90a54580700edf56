//! Equations as JSON: every section and formula of the layout, each formula as text and as LaTeX.

use super::document::{Document, Item};
use super::formula::Formula;
use super::{latex, text};
use crate::base::readable::escaped;
use serde::Serialize;

#[derive(Serialize)]
struct Page<'a> {
    schema: &'static str,
    title: &'a str,
    sections: Vec<Part<'a>>,
}

#[derive(Serialize)]
struct Part<'a> {
    heading: &'a str,
    items: Vec<Entry>,
}

#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
enum Entry {
    Sentence { text: String },
    Formula { text: String, latex: String, note: String },
    Matrix { name: String, text: Vec<Vec<String>>, latex: Vec<Vec<String>> },
}

pub fn json(document: &Document) -> String {
    let sections = document
        .sections
        .iter()
        .map(|section| Part { heading: section.heading, items: section.items.iter().flat_map(entries).collect() });
    let page = Page { schema: "vibc-equations-1", title: &document.title, sections: sections.collect() };
    escaped(serde_json::to_string_pretty(&page).expect("strings always have a JSON form")) + "\n"
}

fn entries(item: &Item) -> Vec<Entry> {
    match item {
        Item::Paragraph(inlines) => vec![Entry::Sentence { text: text::sentence(inlines) }],
        Item::Formula { formula, note } => {
            vec![Entry::Formula {
                text: text::formula(formula),
                latex: latex::formula(formula),
                note: text::sentence(note),
            }]
        }
        Item::Matrices(matrices) => matrices.iter().map(matrix).collect(),
    }
}

fn matrix((name, rows): &(Formula, Vec<Vec<Formula>>)) -> Entry {
    let each = |write: fn(&Formula) -> String| rows.iter().map(|row| row.iter().map(write).collect()).collect();
    Entry::Matrix { name: text::formula(name), text: each(text::formula), latex: each(latex::formula) }
}
