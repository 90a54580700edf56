//! Errors of the laws of springs and dampers.

use super::{error, name_phrase, short};
use crate::base::{Change, Code, Diagnostic, Dimension, Span};

#[derive(Clone, Debug, PartialEq)]
pub enum LawError {
    /// A law beside a coefficient or a preload.
    AndAnother {
        span: Span,
        other: Span,
        word: String,
    },
    /// The law of a damper at zero rate.
    Undefined {
        span: Span,
        why: &'static str,
    },
    Kink {
        span: Span,
    },
    ForceAtRest {
        span: Span,
        force: f64,
        torsional: bool,
    },
    NoTangent {
        span: Span,
    },
    TableArguments {
        span: Span,
    },
    TableFirst {
        span: Span,
        named: Span,
        found: Dimension,
        over: Dimension,
    },
    TableNotGiven {
        span: Span,
    },
    TableUndecided {
        span: Span,
    },
}

impl LawError {
    pub fn diagnostic(self) -> Diagnostic {
        use LawError::*;
        match self {
            AndAnother { span, other, word } => {
                error("vib::law::and_coefficient", span, format!("an element has a law or `{word}`, not both"))
                    .with_related(other, format!("`{word}` is given here"))
                    .help(match &word[..] {
                        "loss" => "keep one: a loss factor belongs to a stiffness `k`".to_string(),
                        _ => format!("keep one: the law says all that `{word}` would"),
                    })
                    .fix(span, Change::DropField)
                    .fix(other, Change::DropField)
            }
            Undefined { span, why } => {
                error("vib::law::undefined", span, "the law of this damper is not defined at zero rate, where it rests")
                    .label(why)
                    .help("write a law that has a value and a slope at `rate = 0`")
            }
            Kink { span } => {
                error("vib::law::kink", span, "the law of this damper has a kink at zero rate, so it has no tangent there")
                    .label("its slope jumps here")
                    .help("write a law that is smooth at `rate = 0`, such as `rate * abs(rate)`")
            }
            ForceAtRest { span, force, torsional } => {
                let unit = if torsional { "N*m" } else { "N" };
                error("vib::law::force_at_rest", span, format!("this damper exerts {} {unit} at rest", short(force)))
                    .label("not zero at zero rate")
                    .help("write a law that is zero at `rate = 0`; a constant force is a `force` with the signal `constant(...)`")
            }
            NoTangent { span } => Diagnostic::warning(
                Code::model("vib::law::no_tangent"),
                span,
                "the tangent of this law is zero at rest: linear motions about the rest are not damped by it",
            )
            .help("results are for small motions; give it a part in proportion to `rate` that stands for the motions meant"),
            TableArguments { span } => {
                error("vib::law::table", span, "the table of a law needs a file and the units of both columns")
                    .help("write `table(\"law.csv\", 1 mm, 1 N)`, or the units in the heading: `stretch [mm], force [N]`")
            }
            TableFirst { span, named, found, over } => {
                let (found, over) = (name_phrase(found), name_phrase(over));
                error("vib::law::table", span, format!("the first column of this table is {found}, where the law needs {over}"))
                    .with_related(named, "the table is named here")
                    .help("write the unit of the first column in its heading, as in `stretch [mm]`")
            }
            TableNotGiven { span } => Diagnostic::error(super::TABLE_UNREADABLE, span, "this table was not read")
                .help("name fewer different tables in one model"),
            TableUndecided { span } => {
                error("vib::law::table", span, "the known digits of this table do not decide where it rises")
                    .help("give it units without rounded factors")
            }
        }
    }
}
