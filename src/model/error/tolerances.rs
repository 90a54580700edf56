//! Errors of tolerances, of spread and of correlations.

use super::error;
use crate::base::{Diagnostic, Span};

/// Errors of the clauses `within` and `spread`, and of `correlate`.
#[derive(Clone, Debug, PartialEq)]
pub enum ToleranceError {
    ValueOutside { span: Span, word: String, value: Span },
    NotPositive { span: Span, what: &'static str },
    OfPlainNumber { span: Span, spread: bool },
    ShareOfZero { span: Span },
    UniformWithoutRange { span: Span },
    LognormalOfNegative { span: Span },
    WithoutTolerance { span: Span, word: String, declared: Span },
    CorrelatedWithItself { span: Span },
    BeyondOne { span: Span },
    CorrelatedTwice { span: Span, first: Span },
    NotDefinite { span: Span, most: Option<usize> },
}

impl ToleranceError {
    /// The diagnostic for it.
    pub fn diagnostic(self) -> Diagnostic {
        use ToleranceError::*;
        const WIDTH: &str = "vib::tolerance::width";
        const CORRELATION: &str = "vib::tolerance::correlation";
        match self {
            ValueOutside { span, word, value } => {
                error("vib::tolerance::outside", span, format!("the range does not contain the value of `{word}`"))
                    .with_related(value, "the value")
                    .help("write a range that contains the value, or change the value")
            }
            NotPositive { span, what } => error(WIDTH, span, format!("a {what} is positive"))
                .help("write a positive share or width, or remove the clause"),
            OfPlainNumber { span, spread: false } => {
                error(WIDTH, span, "the parameter has no unit, so this could be a share of its value or a width")
                    .help("write the range, as in `within 0.9 .. 1.1`")
            }
            OfPlainNumber { span, spread: true } => {
                error(WIDTH, span, "the parameter has no unit, so this could be a share of its value or a deviation")
                    .help("write `spread lognormal` before it, or a range, as in `spread uniform within 0.9 .. 1.1`")
            }
            ShareOfZero { span } => error(WIDTH, span, "a share of 0 is 0")
                .help("write a width with its unit, or a range, as in `within -1 mm .. 1 mm`"),
            UniformWithoutRange { span } => error(WIDTH, span, "uniform between which limits?")
                .help("write them, as in `spread uniform within 3 %`"),
            LognormalOfNegative { span } => error(WIDTH, span, "only positive values have a logarithm")
                .help("write `spread` with a deviation, or `spread uniform within` a range"),
            WithoutTolerance { span, word, declared } => {
                error(CORRELATION, span, format!("`{word}` does not vary at random"))
                    .with_related(declared, "declared here")
                    .help("write `spread` or `within` after its value")
            }
            CorrelatedWithItself { span } => {
                error(CORRELATION, span, "a parameter is not correlated with itself").help("name two parameters")
            }
            BeyondOne { span } => {
                error(CORRELATION, span, "a coefficient of correlation lies between -1 and 1, both excluded")
                    .help("where one parameter determines the other, declare the other by `let`")
            }
            CorrelatedTwice { span, first } => error(CORRELATION, span, "these two parameters are correlated already")
                .with_related(first, "here first")
                .help("remove one of the lines"),
            NotDefinite { span, most: None } => error(
                CORRELATION,
                span,
                "these correlations cannot hold together: their matrix is not positive definite",
            )
            .help("make the coefficients smaller, or add the missing ones of the other pairs"),
            NotDefinite { span, most: Some(most) } => {
                error(CORRELATION, span, format!("more than {most} parameters are correlated"))
                    .help(format!("correlate at most {most} parameters"))
            }
        }
    }
}
