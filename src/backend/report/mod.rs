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
    use crate::{Overrides, SourceFile, Sources};

    /// A cart that carries a hanging rod.
    const CART: &str = include_str!("../../../examples/cart.vib");

    /// Two free carts connected by a spring: a rigid-body mode and an oscillation.
    const FREE_PAIR: &str = "\
        model free_pair\n\
        body α { mass = 2 kg, moves x }\n\
        body β { mass = 2 kg, moves x }\n\
        spring s: α -- β { k = 4 N/m }";

    /// An upright rod on a block that sinks into its spring: it falls.
    const UPRIGHT_ROD: &str = "\
        model upright\n\
        gravity 9.81 m/s^2\n\
        body block { mass = 2 kg, moves y }\n\
        body rod { mass = 1 kg, shape = rod((0 m, 0 m), (0 m, 1 m)) }\n\
        pivot hinge: block@(0 m, 0 m) -- rod\n\
        spring mount: ground@(0 m, -1 m) -- block@(0 m, 0 m) { k = 2 kN/m, free_length = 1 m }";

    fn analyze(model: &str) -> ModalAnswer {
        let mut sources = Sources::new();
        let model = sources.add(SourceFile::model("shown.vib", model));
        let outcome = crate::analyze(&sources, model, &Overrides::default());
        outcome.answer.unwrap_or_else(|| panic!("{:?}", outcome.diagnostics))
    }

    #[test]
    fn a_stable_scene() {
        insta::assert_snapshot!(text(&analyze(CART), &Options::default()));
    }

    #[test]
    fn a_rigid_motion_is_named() {
        let options = Options { normalise: Normalise::Mass, ..Options::default() };
        insta::assert_snapshot!(text(&analyze(FREE_PAIR), &options));
    }

    #[test]
    fn an_unstable_rest_is_reported_prominently() {
        insta::assert_snapshot!(text(&analyze(UPRIGHT_ROD), &Options::default()));
    }

    /// At any width, content that does not fit is broken or listed separately, and nothing is lost.
    #[test]
    fn no_line_is_wider_than_asked_for() {
        for answer in [CART, FREE_PAIR, UPRIGHT_ROD].map(analyze) {
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
