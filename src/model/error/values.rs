//! Errors of values and units.

use super::{error, name_phrase, short, unit_or_none};
use crate::base::{Angle, Change, Code, Diagnostic, Dimension, Span};
use crate::model::expect::Expected;
use crate::model::value::Fault;
use crate::syntax::tree::Binary;

/// Errors of values.
#[derive(Clone, Debug, PartialEq)]
pub enum ValueError {
    UnitUnknown { span: Span, symbol: String, suggestion: Option<String>, is_value: bool },
    UnitAmbiguous { span: Span, head: String, tail: String },
    UnitMalformed { span: Span },
    DecibelInProduct { span: Span },
    UnitMissing { span: Span, number: String, expected: Expected },
    UnitMismatch { span: Span, found: Dimension, expected: Box<Expected>, declared: Option<(String, Span)> },
    GramForGravity { span: Span },
    FrequencyReading { span: Span, value: f64 },
    DensityReading { span: Span, value: f64, unit: String },
    CyclesForRadians { span: Span, value: f64, expected: Box<Expected>, declared: Option<(String, Span)> },
    Overflow { span: Span },
    Operation { fault: Fault, operator: Binary, left: Span, right: Span },
    Function { fault: Fault, function: &'static str, argument: Span, span: Span },
    Pair { fault: Fault, left: Span, right: Span },
    Kind { span: Span, needed: &'static str, found: &'static str },
    MotionAsValue { span: Span },
    ArrowAsValue { span: Span },
    ComparisonAsValue { span: Span },
    ArgumentCount { span: Span, function: &'static str, expected: usize, found: usize },
    ArgumentName { span: Span },
    Components { span: Span, found: usize },
    NoDirection { span: Span },
    UnlikeDeclared { span: Span, found: Dimension, wanted: Dimension, declared: Option<(String, Span)> },
    ReadingLike { span: Span, declared: Angle },
    Negative { span: Span, what: &'static str },
}

impl ValueError {
    /// Adds the place where the parameter is declared.
    pub fn declared_at(mut self, declaration: (String, Span)) -> ValueError {
        if let ValueError::UnlikeDeclared { declared, .. } = &mut self {
            *declared = Some(declaration);
        }
        self
    }

    /// The diagnostic for it.
    pub fn diagnostic(self) -> Diagnostic {
        use ValueError::*;
        match self {
            UnitUnknown { span, symbol, suggestion, is_value } => unit_unknown(span, &symbol, suggestion, is_value),
            UnitAmbiguous { span, head, tail } => {
                let divided = format!("{head}/{}", tail.replace('*', "/"));
                error("vib::unit::ambiguous", span, "this unit can be read in two ways")
                    .label(format!("({head})*{tail} or {}?", divided_by_product(&head, &tail)))
                    .help(format!("write `{}` or `{divided}`", product_divided(&head, &tail)))
                    .fix(span, Change::Replace(product_divided(&head, &tail)))
                    .fix(span, Change::Replace(divided))
            }
            UnitMalformed { span } => error("vib::unit::malformed", span, "this is not a unit")
                .help("write a unit without blanks, as in `N*s/m^2`"),
            DecibelInProduct { span } => {
                error("vib::unit::malformed", span, "`dB` cannot be combined with other units")
                    .help("write a level, such as `-12 dB`")
            }
            UnitMissing { span, number, expected } => unit_missing(span, &number, expected),
            UnitMismatch { span, found, expected, declared } => unit_mismatch(span, found, *expected, declared),
            GramForGravity { span } => {
                error("vib::unit::mismatch", span, "an acceleration is expected here, this is a mass")
                    .label("`g` is the gram")
                    .help("write `9.81 m/s^2`, or `1 g0` for the standard acceleration of free fall")
            }
            DensityReading { span, value, unit } => {
                let number = short(value);
                let per_cycle = format!("{number} {unit}/Hz");
                let per_radian = format!("{number} {unit}/(rad/s)");
                error("vib::noise::reading", span, "is this density per Hz or per rad/s?")
                    .label(format!(
                        "{per_cycle}, or {per_radian}, which is {} {unit}/Hz",
                        short(value * std::f64::consts::TAU)
                    ))
                    .help(format!("write `{per_cycle}` or `{per_radian}`"))
                    .fix(span, Change::Replace(per_cycle))
                    .fix(span, Change::Replace(per_radian))
            }
            FrequencyReading { span, value } => frequency_reading(span, value),
            CyclesForRadians { span, value, expected, declared } => {
                cycles_for_radians(span, value, *expected, declared)
            }
            Overflow { span } => error("vib::number::overflow", span, "this number is out of range")
                .help("numbers from 2.2e-308 to 1.8e308 in SI units can be used, and 0"),
            Operation { fault, operator, left, right } => operation(fault, operator, left, right),
            Function { fault, function, argument, span } => function_fault(fault, function, argument, span),
            Pair { fault, left, right } => pair(fault, left, right),
            Kind { span, needed, found } => {
                error("vib::value::kind", span, format!("{needed} is expected here, this is {found}"))
            }
            MotionAsValue { span } => {
                error("vib::value::motion", span, "a motion has no value before the model is analysed")
                    .help("use motions in `output`, `couple`, `solve` and `require`")
            }
            ArrowAsValue { span } => error("vib::value::motion", span, "`->` leads from an input to an output")
                .help("use it in `gain(input -> output, f)` and `phase(input -> output, f)`"),
            ComparisonAsValue { span } => error("vib::value::comparison", span, "a comparison has no value")
                .help("use comparisons in `require`, as in `require frequency(1) > 2 Hz`"),
            ArgumentCount { span, function, expected, found } => argument_count(span, function, expected, found),
            ArgumentName { span } => {
                error("vib::function::arguments", span, "no argument here has a name").help("write the value alone")
            }
            Components { span, found } => components(span, found),
            NoDirection { span } => error("vib::direction::zero", span, "this vector has no direction")
                .label("zero")
                .help("write `x`, `y` or a vector that is not zero, such as `(1, 1)`"),
            UnlikeDeclared { span, found, wanted, declared } => kind_mismatch(span, found, wanted, declared),
            ReadingLike { span, declared } => {
                let unit = if declared == Angle::Cycles { "Hz" } else { "rad/s" };
                error("vib::unit::frequency", span, "this is in 1/s: are these radians or cycles?")
                    .label(format!("the parameter is declared in {unit}"))
                    .help(format!("write the unit, such as `10 {unit}`"))
                    .fix(span, Change::Times(if declared == Angle::Cycles { "1 rev" } else { "1 rad" }))
            }
            Negative { span, what } => error("vib::value::negative", span, format!("{what} cannot be negative")),
        }
    }
}

fn unit_unknown(span: Span, symbol: &str, suggestion: Option<String>, is_value: bool) -> Diagnostic {
    let diagnostic = error("vib::unit::unknown", span, format!("unknown unit `{symbol}`"));
    match (is_value, suggestion) {
        (true, _) => {
            diagnostic.help(format!("`{symbol}` is a parameter: write spaces around `*` or `/` to calculate with it"))
        }
        (false, Some(meant)) => diagnostic.help(format!("did you mean `{meant}`?")).fix(span, Change::Replace(meant)),
        (false, None) => diagnostic.help(
            "a unit is a symbol such as `mm` or `N*s/m`; to multiply a number by a value, write ` * ` with spaces",
        ),
    }
}

/// `N/(m*s)`, the second reading of `N/m*s`.
fn divided_by_product(head: &str, tail: &str) -> String {
    let (above, below) = head.rsplit_once('/').unwrap_or((head, ""));
    format!("{above}/({below}*{tail})")
}

/// `N*s/m`, the first reading of `N/m*s`, written unambiguously.
fn product_divided(head: &str, tail: &str) -> String {
    match head.split_once('/') {
        Some(("", below)) => format!("{tail}/{below}"),
        Some((above, below)) => format!("{above}*{tail}/{below}"),
        None => format!("{head}*{tail}"),
    }
}

fn unit_missing(span: Span, number: &str, expected: Expected) -> Diagnostic {
    let unit = expected.unit();
    let remark = expected.remark().map_or_else(String::new, |remark| format!("; {remark}"));
    error("vib::unit::missing", span, format!("{} is expected here, this number has no unit", expected.phrase()))
        .label("a plain number")
        .help(format!("write the unit after it, such as `{number} {unit}`{remark}"))
        .fix(span, Change::After(format!(" {unit}")))
}

fn unit_mismatch(span: Span, found: Dimension, expected: Expected, declared: Option<(String, Span)>) -> Diagnostic {
    let what = found.noun().map_or_else(|| format!("a quantity in {found}"), str::to_string);
    let (wanted, example) = (expected.phrase(), expected.example_text());
    let remark = expected.remark().map_or_else(String::new, |remark| format!("; {remark}"));
    let message = format!("{wanted} is expected here, this is {what}");
    let unit = found.usual_unit();
    let mut diagnostic = error("vib::unit::mismatch", span, message)
        .label(if unit.is_empty() { "no unit".to_string() } else { unit })
        .help(format!("write {wanted}, such as `{example}`{remark}"));
    if let Some((name, place)) = declared {
        diagnostic = diagnostic.with_related(place, format!("`{name}` is declared here"));
        if found.is_none() {
            diagnostic = diagnostic.fix(place, Change::Unit(expected.unit()));
        }
    }
    diagnostic
}

fn cycles_for_radians(span: Span, value: f64, expected: Expected, declared: Option<(String, Span)>) -> Diagnostic {
    let noun = expected.noun.split_once(' ').map_or(expected.noun, |(_, noun)| noun);
    let unit = if expected.dimension == Dimension::FREQUENCY { "/s".into() } else { unit_or_none(expected.dimension) };
    let read = format!("{} {unit}", short(value));
    let message = format!("this {noun} has a factor in cycles, not radians: it is read as {read}");
    let diagnostic = Diagnostic::warning(Code::model("vib::unit::cycles"), span, message);
    let diagnostic = declared.into_iter().fold(diagnostic, |diagnostic, (name, place)| {
        diagnostic.with_related(place, format!("`{name}` is declared here"))
    });
    diagnostic.help("1 Hz is 2*pi rad/s: write `2*pi*f` for a frequency `f` in Hz, or declare it in rad/s")
}

fn frequency_reading(span: Span, value: f64) -> Diagnostic {
    let hertz = short(value / std::f64::consts::TAU);
    let value = short(value);
    error("vib::unit::frequency", span, "this is in 1/s: are these radians or cycles?")
        .label(format!("{value} rad/s = {hertz} Hz, or {value} Hz?"))
        .help("multiply by `1 rad` if it is an angular frequency, such as sqrt(k/m), or by `1 rev` if it counts cycles")
        .fix(span, Change::Times("1 rad"))
        .fix(span, Change::Times("1 rev"))
}

/// An operator as a verb.
fn verb_of(operator: Binary) -> &'static str {
    match operator {
        Binary::Add => "added to",
        Binary::Subtract => "subtracted from",
        _ => "compared with",
    }
}

fn operation(fault: Fault, operator: Binary, left: Span, right: Span) -> Diagnostic {
    match fault {
        Fault::Dimensions(a, b) => {
            let message = format!("{} cannot be {} {}", name_phrase(b), verb_of(operator), name_phrase(a));
            error("vib::unit::mismatch", right, message)
                .label(unit_or_none(b))
                .with_related(left, unit_or_none(a))
                .help("both sides need the same unit")
        }
        Fault::Kind { needed, found } => {
            error("vib::value::kind", right, format!("{needed} is expected here, this is {found}"))
                .with_related(left, "the other side")
        }
        Fault::NotPlain(found) => {
            error("vib::unit::mismatch", right, "an exponent is a plain number").label(unit_or_none(found))
        }
        Fault::Exponent => {
            error("vib::unit::exponent", right, "a quantity with a unit needs a small fraction as its exponent")
                .help("write a power such as `^2` or `^(1/2)`")
        }
        Fault::DivisionByZero => error("vib::number::division_by_zero", right, "division by zero").label("zero"),
        Fault::RootOfNegative => error("vib::number::root_of_negative", left, "a root of a negative number"),
        Fault::Domain(_) | Fault::Overflow => {
            error("vib::number::overflow", left.to(right), "this number is out of range")
                .help("numbers from 2.2e-308 to 1.8e308 in SI units can be used, and 0")
        }
    }
}

fn function_fault(fault: Fault, function: &str, argument: Span, span: Span) -> Diagnostic {
    match fault {
        Fault::NotPlain(found) => {
            let message = format!("`{function}` takes a plain number or an angle, this is {}", name_phrase(found));
            error("vib::unit::mismatch", argument, message).label(unit_or_none(found))
        }
        Fault::Dimensions(a, b) => {
            let message = format!("`{function}` compares {} with {}", name_phrase(a), name_phrase(b));
            error("vib::unit::mismatch", span, message).help("all arguments need the same unit")
        }
        Fault::Kind { needed, found } => {
            error("vib::value::kind", argument, format!("{needed} is expected here, this is {found}"))
        }
        Fault::RootOfNegative => error("vib::number::root_of_negative", argument, "the root of a negative number"),
        Fault::DivisionByZero => error("vib::number::division_by_zero", span, format!("`{function}` is infinite here")),
        Fault::Domain(domain) => error("vib::number::domain", argument, format!("`{function}` has no value here"))
            .help(format!("its argument is {domain}")),
        Fault::Exponent | Fault::Overflow => error("vib::number::overflow", span, "this number is out of range")
            .help("numbers from 2.2e-308 to 1.8e308 in SI units can be used, and 0"),
    }
}

fn pair(fault: Fault, left: Span, right: Span) -> Diagnostic {
    let Fault::Dimensions(a, b) = fault else {
        return operation(fault, Binary::Add, left, right);
    };
    error(
        "vib::unit::mismatch",
        right,
        format!("this is {}, the first component is {}", name_phrase(b), name_phrase(a)),
    )
    .label(unit_or_none(b))
    .with_related(left, unit_or_none(a))
    .help("both components need the same unit; a bare 0 fits any")
}

fn argument_count(span: Span, function: &str, expected: usize, found: usize) -> Diagnostic {
    let plural = if expected == 1 { "argument" } else { "arguments" };
    error("vib::function::arguments", span, format!("`{function}` takes {expected} {plural}, {found} are given"))
}

fn components(span: Span, found: usize) -> Diagnostic {
    if found == 3 {
        return error("vib::value::components", span, "a third coordinate is reserved for spatial scenes")
            .help("write (x, y)");
    }
    error("vib::value::components", span, "a point has two coordinates").help("write (x, y)")
}

fn kind_mismatch(span: Span, found: Dimension, wanted: Dimension, declared: Option<(String, Span)>) -> Diagnostic {
    let unit = wanted.usual_unit();
    let (message, help) = match unit.as_str() {
        "" => (
            format!("a plain number is expected here, this is {}", name_phrase(found)),
            "write it without a unit".to_string(),
        ),
        _ => (
            format!("{} is expected here, this is {}", name_phrase(wanted), name_phrase(found)),
            format!("write it in {unit} or another unit of that kind"),
        ),
    };
    let mut diagnostic = error("vib::unit::mismatch", span, message).label(unit_or_none(found)).help(help);
    if let Some((name, place)) = declared {
        diagnostic = diagnostic.with_related(place, format!("`{name}` is declared here"));
    }
    diagnostic
}
