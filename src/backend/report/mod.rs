//! Reports as text, within the width of a terminal: plain characters without colour, so that a file contains what a
//! screen shows. The content of a report is decided in `answers::report`. See docs/method/report.md.

mod matrices;
mod table;
pub(super) mod wrap;

use super::plain;
use crate::answers::ModalAnswer;
use crate::answers::report::{self, Block, Matrices, Options, Report};
use crate::lower::Account;
use crate::questions::answer::Requirement;
use crate::system::LinearSystem;

/// Width of a report that is not shown on a terminal.
pub const WIDTH: usize = 100;
/// Indent of each line below the title, of a line that belongs to another, and of the rest of a broken line.
const INDENT: usize = 2;
const ITEM: usize = 4;
const HANGING: usize = 5;

/// The modal report in 100 columns, as for any output but a terminal.
pub fn text(answer: &ModalAnswer, options: &Options) -> String {
    laid_out(&report::modal(answer, options), WIDTH)
}

/// A report in `width` columns; a name that is longer than a line is not broken. Ends in a line feed.
pub fn laid_out(report: &Report, width: usize) -> String {
    let mut text = wrap::fill_lines(&plain::line(&report.title), 0, INDENT, width);
    for (number, section) in report.sections.iter().enumerate() {
        // A report of one table follows its title without an empty line.
        let apart = number > 0 || !matches!(section.blocks.first(), Some(Block::Table(_)));
        if apart {
            text.push('\n');
        }
        section.blocks.iter().for_each(|each| text += &block(each, width));
    }
    text.replace(plain::NO_BREAK, " ")
}

/// Reports one below the other.
pub fn all_laid_out(reports: &[Report], width: usize) -> String {
    reports.iter().map(|report| laid_out(report, width)).collect::<Vec<_>>().join("\n")
}

fn block(block: &Block, width: usize) -> String {
    match block {
        Block::Line(line) => wrap::fill_lines(&plain::line(line), INDENT, INDENT + HANGING, width),
        Block::Item(line) => wrap::fill_lines(&plain::line(line), ITEM, ITEM + HANGING, width),
        Block::Table(table) => table::text(table, INDENT, width),
        Block::Matrices(list) => matrices::text(list, INDENT, width),
    }
}

/// Matrices of any width, for pages that scroll.
pub(super) fn block_of_matrices(list: &Matrices) -> String {
    matrices::text(list, 0, usize::MAX)
}

/// The results of the requirements of a file, below its name; empty if it has none.
pub fn requirements(file: &str, list: &[Requirement], width: usize) -> String {
    report::requirements(file, list).map_or(String::new(), |report| laid_out(&report, width))
}

/// The parts of a model that were kept and left out, if there is no further report.
pub fn explanation(model: &str, account: &Account, system: &LinearSystem, width: usize) -> String {
    laid_out(&report::explanation(model, account, system), width)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::Normalise;
    use crate::answers::samples;

    #[test]
    fn a_stable_scene() {
        insta::assert_snapshot!(text(&samples::cart(), &Options::default()));
    }

    #[test]
    fn a_rigid_motion_is_named() {
        let options = Options { normalise: Normalise::Mass, ..Options::default() };
        insta::assert_snapshot!(text(&samples::free_pair(), &options));
    }

    #[test]
    fn an_unstable_rest_is_reported_prominently() {
        insta::assert_snapshot!(text(&samples::upright_rod(), &Options::default()));
    }

    /// At any width, content that does not fit is broken or listed separately, and nothing is lost.
    #[test]
    fn no_line_is_wider_than_asked_for() {
        for answer in [samples::cart(), samples::free_pair(), samples::upright_rod()] {
            let report = report::modal(&answer, &Options::default());
            for width in [40, 60, 80, 100, 200] {
                let text = laid_out(&report, width);
                let widest = text.lines().map(|line| line.chars().count()).max().unwrap_or(0);
                assert!(widest <= width, "{widest} columns of {width}:\n{text}");
                for number in answer.modes.list.iter().map(|mode| super::super::decimal::certain(&mode.omega, 7)) {
                    assert!(text.contains(&number), "{number} is missing in {width} columns:\n{text}");
                }
            }
        }
    }
}
