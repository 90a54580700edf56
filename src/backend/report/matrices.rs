//! The layout of matrices: all entries of one matrix in the same notation.

use super::super::decimal::{certain_scientific, certain_whole};
use super::wrap::characters;
use crate::answers::report::Matrices;
use crate::base::Number;

/// Space between two matrices.
const GAP: usize = 3;

/// Matrices next to each other as far as they fit. One that is too wide is omitted, unless it was requested: then it is
/// drawn in pieces of some columns.
pub fn text(matrices: &Matrices, indent: usize, width: usize) -> String {
    let room = width.saturating_sub(indent);
    let mut text = String::new();
    let mut beside: Vec<Vec<String>> = Vec::new();
    let mut too_wide = Vec::new();
    let mut flush = |beside: &mut Vec<Vec<String>>| {
        let joined = join(&std::mem::take(beside));
        joined.iter().for_each(|row| text += &format!("{:indent$}{}\n", "", row.trim_end()));
    };
    for (name, entries) in &matrices.list {
        let cells = notation(entries, matrices.digits);
        let whole = block(name, &cells);
        if breadth(&whole) > room {
            if matrices.wanted {
                flush(&mut beside);
                for piece in pieces(name, &cells, room) {
                    flush(&mut vec![piece]);
                }
            } else {
                too_wide.push(*name);
            }
            continue;
        }
        let used: usize = beside.iter().map(|block| breadth(block) + GAP).sum();
        if !beside.is_empty() && used + breadth(&whole) > room {
            flush(&mut beside);
        }
        beside.push(whole);
    }
    flush(&mut beside);
    if !too_wide.is_empty() {
        text += &format!("{:indent$}{}: too wide to show (use --matrices)\n", "", too_wide.join(", "));
    }
    text
}

/// All entries as plain numbers, or all with a power of ten if one of them needs it.
fn notation(entries: &[Vec<Number>], digits: usize) -> Vec<Vec<String>> {
    let written = |form: fn(&Number, usize) -> String| -> Vec<Vec<String>> {
        entries.iter().map(|row| row.iter().map(|entry| form(entry, digits)).collect()).collect()
    };
    let plain = written(certain_whole);
    let has_power = |cell: &String| cell.contains('e') && !cell.starts_with('≤');
    if plain.iter().flatten().any(has_power) { written(certain_scientific) } else { plain }
}

/// A wide matrix in pieces of some columns, each with the column numbers above.
fn pieces(name: &str, cells: &[Vec<String>], room: usize) -> Vec<Vec<String>> {
    let columns = cells.first().map_or(0, Vec::len);
    let piece = |from: usize, to: usize| -> Vec<String> {
        let chosen: Vec<Vec<String>> = cells.iter().map(|row| row[from..to].to_vec()).collect();
        let title = format!("columns {} to {} of {columns}:", from + 1, to);
        [title].into_iter().chain(block(name, &chosen)).collect()
    };
    let mut list = Vec::new();
    let mut from = 0;
    while from < columns {
        let fits = |to: &usize| breadth(&piece(from, *to)[1..]) <= room;
        let to = (from + 2..=columns).take_while(fits).last().unwrap_or(from + 1);
        list.push(piece(from, to));
        from = to;
    }
    list
}

fn breadth(block: &[String]) -> usize {
    block.iter().map(|line| characters(line)).max().unwrap_or(0)
}

fn join(blocks: &[Vec<String>]) -> Vec<String> {
    let rows = blocks.iter().map(Vec::len).max().unwrap_or(0);
    let row = |i: usize| blocks.iter().filter_map(|block| block.get(i)).map(String::as_str).collect::<Vec<_>>();
    (0..rows).map(|i| row(i).join(&" ".repeat(GAP))).collect()
}

/// `M = ⎡ 1.5 0.5 ⎤` with one line for each row, all of the same width.
fn block(name: &str, cells: &[Vec<String>]) -> Vec<String> {
    let (rows, columns) = (cells.len(), cells.first().map_or(0, Vec::len));
    let width = |j: usize| cells.iter().map(|row| characters(&row[j])).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let line = |i: usize| {
        let lead = if i == (rows - 1) / 2 { format!("{name} = ") } else { " ".repeat(characters(name) + 3) };
        let entries = cells[i].iter().zip(&widths).map(|(cell, width)| format!("{cell:<width$}"));
        let (left, right) = brackets(i, rows);
        format!("{lead}{left} {} {right}", entries.collect::<Vec<_>>().join("  "))
    };
    (0..rows).map(line).collect()
}

fn brackets(row: usize, rows: usize) -> (char, char) {
    match row {
        _ if rows == 1 => ('[', ']'),
        0 => ('⎡', '⎤'),
        _ if row + 1 == rows => ('⎣', '⎦'),
        _ => ('⎢', '⎥'),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matrix(entries: &[&[i64]]) -> Vec<Vec<Number>> {
        entries.iter().map(|row| row.iter().map(|entry| Number::from(*entry)).collect()).collect()
    }

    #[test]
    fn one_power_of_ten_makes_all_entries_have_one() {
        let cells = notation(&matrix(&[&[1_000_000_000, -500_000_000], &[0, 250_000_123]]), 5);
        assert_eq!(cells, [["1e9", "-5e8"], ["0", "2.5000e8"]]);
        let cells = notation(&matrix(&[&[15, -29_608_813]]), 5);
        assert_eq!(cells, [["15", "-29608813"]]);
    }

    #[test]
    fn a_wide_matrix_is_drawn_in_pieces_where_it_is_asked_for() {
        let list = vec![("K", matrix(&[&[1, 2, 3, 4, 5, 6], &[1, 2, 3, 4, 5, 6]]))];
        let narrow = Matrices { list: list.clone(), wanted: false, digits: 5 };
        assert_eq!(text(&narrow, 2, 20), "  K: too wide to show (use --matrices)\n");
        let wanted = Matrices { list, wanted: true, digits: 5 };
        let expected = "  columns 1 to 4 of 6:
  K = ⎡ 1  2  3  4 ⎤
      ⎣ 1  2  3  4 ⎦
  columns 5 to 6 of 6:
  K = ⎡ 5  6 ⎤
      ⎣ 5  6 ⎦
";
        assert_eq!(text(&wanted, 2, 22), expected);
    }
}
