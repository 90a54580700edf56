//! The reasons why there are no equations, and the diagnostics for them.

use crate::base::{Code, Diagnostic, Span};

pub const TOO_LARGE: Code = Code::limit("vib::equations::too_large");
pub const DEFECT: Code = Code::model("vib::equations::defect");
pub const NO_FORM: Code = Code::model("vib::equations::no_form");

#[derive(Clone, Debug, PartialEq)]
pub enum EquationsError {
    TooManyCoordinates {
        span: Span,
        coordinates: usize,
        most: usize,
    },
    /// Number of products in the kinetic energy.
    TooManyProducts {
        span: Span,
        products: usize,
        most: usize,
    },
    /// Number of constraint equations of loops that are not solved in symbols.
    LargeLoop {
        span: Span,
        equations: usize,
        most: usize,
    },
    /// The constraint equations, solved in symbols, would have too many terms; their number.
    LongLoop {
        span: Span,
        terms: usize,
        most: usize,
    },
    /// An element with a law that is no sum of powers, up to the highest that is written.
    Law {
        span: Span,
        most: u32,
    },
    /// What follows a base statically has no form in symbols, or is not determined.
    Carried {
        span: Span,
    },
    /// Something in the scene has no form in symbols.
    NoForm {
        span: Span,
    },
    /// The symbols contradict the lowering: one of them is wrong.
    Defect {
        span: Span,
        what: String,
        symbols: String,
        lowered: String,
    },
}

impl EquationsError {
    pub fn to_diagnostic(&self) -> Diagnostic {
        match self {
            EquationsError::TooManyCoordinates { span, coordinates, most } => {
                let message =
                    format!("equations of {coordinates} coordinates are not written in symbols; the most are {most}");
                Diagnostic::error(TOO_LARGE, *span, message).help("use `vibc analyze --matrices` for the numbers")
            }
            EquationsError::TooManyProducts { span, products, most } => {
                let message =
                    format!("this kinetic energy would be summed from {products} products; the most are {most}");
                Diagnostic::error(TOO_LARGE, *span, message)
                    .help("use fewer links, or `vibc analyze --matrices` for the numbers")
            }
            EquationsError::LargeLoop { span, equations, most } => {
                let message = format!(
                    "{equations} constraint equations that depend on each other are not solved in symbols; the most are {most}"
                );
                Diagnostic::error(TOO_LARGE, *span, message).help("use `vibc analyze --matrices` for the numbers")
            }
            EquationsError::LongLoop { span, terms, most } => {
                let message = format!(
                    "the constraint equations of these loops would have {terms} terms when solved in symbols; the most are {most}"
                );
                Diagnostic::error(TOO_LARGE, *span, message).help("use `vibc analyze --matrices` for the numbers")
            }
            EquationsError::Law { span, most } => {
                let message = format!(
                    "the law of this element is not written in symbols: it is no sum of powers up to the {most}th"
                );
                Diagnostic::error(NO_FORM, *span, message)
                    .help("give it the tangent at rest as its coefficient, which `vibc analyze` shows, for the linear equations")
            }
            EquationsError::Carried { span } => {
                let message =
                    "damping by masses acts relative to what follows the bases, which has no form in symbols here";
                Diagnostic::error(NO_FORM, *span, message)
                    .help("write dampers, or `damping rayleigh(0 /s, ...)`; `vibc analyze --matrices` has the numbers")
            }
            EquationsError::NoForm { span } => {
                Diagnostic::error(NO_FORM, *span, "a direction or place of this scene has no form in symbols")
                    .help("write directions with rational components, or as a pair of expressions")
            }
            EquationsError::Defect { span, what, symbols, lowered } => {
                let message = format!("defect in vibc: {what} is {symbols} by the energies and {lowered} by `analyze`");
                Diagnostic::error(DEFECT, *span, message)
                    .label("one of the two is wrong here")
                    .help("report this model as a defect of vibc; until it is fixed, trust neither result")
            }
        }
    }
}
