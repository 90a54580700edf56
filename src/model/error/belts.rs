//! Errors of belts.

use super::error;
use crate::base::{Diagnostic, Span};

#[derive(Clone, Debug, PartialEq)]
pub enum BeltError {
    NoDisk { span: Span, name: String },
    NoCentre { span: Span, name: String },
    Point { span: Span },
    Overlap { span: Span, crossed: bool },
    NoneTurns { span: Span },
}

impl BeltError {
    pub fn diagnostic(self) -> Diagnostic {
        use BeltError::*;
        match self {
            NoDisk { span, name } => {
                error("vib::belt::no_disk", span, format!("`{name}` is no disk for a belt to run round"))
                    .help("a belt joins two bodies with `shape = disk(r)` or `ring(r)`")
            }
            NoCentre { span, name } => {
                error("vib::belt::no_disk", span, format!("the centre of the disk `{name}` is not known"))
                    .help("give it a place: `at = (0, 0)`")
            }
            Point { span } => error("vib::belt::no_disk", span, "a belt runs round a disk, not to a point of it")
                .help("leave out the point"),
            Overlap { span, crossed } => {
                let message = if crossed {
                    "these disks overlap, so a crossed belt does not fit"
                } else {
                    "one of these disks covers the other, so no belt fits"
                };
                error("vib::belt::overlap", span, message).help("draw the disks farther apart, or smaller")
            }
            NoneTurns { span } => error("vib::belt::no_disk", span, "neither of these disks turns")
                .help("let a disk turn: `turns`, or a pivot at its centre"),
        }
    }
}
