//! Errors in the questions of a model: facts, and the diagnostics for them.

use crate::base::{Code, Diagnostic, Span};

/// A parameter and a value of it, in words: `k`, `12 N/m`.
pub type Phrase = String;

/// Errors of `solve`, and of requirements that do not hold.
#[derive(Clone, Debug, PartialEq)]
pub enum AskedError {
    NoRoot {
        span: Span,
        measure: String,
        target: Phrase,
        name: String,
        range: (Phrase, Phrase),
        reach: ReachedRange,
    },
    /// `all`: whether it is proven that there are no others.
    SeveralRoots {
        span: Span,
        measure: String,
        target: Phrase,
        name: String,
        roots: Vec<Phrase>,
        all: bool,
    },
    Touches {
        span: Span,
        measure: String,
        target: Phrase,
        name: String,
        at: Phrase,
    },
    NothingSettled {
        span: Span,
        measure: String,
        target: Phrase,
        name: String,
        parts: Vec<(Phrase, Phrase)>,
    },
    Unsettled {
        span: Span,
        name: String,
        value: Phrase,
        parts: Vec<(Phrase, Phrase)>,
    },
    Independent {
        span: Span,
        measure: String,
        at: Span,
        name: String,
    },
    NoValue {
        span: Span,
        measure: String,
        name: String,
        range: (Phrase, Phrase),
        why: String,
    },
    Twice {
        span: Span,
        name: String,
        first: Span,
    },
    Singular {
        span: Span,
        names: Vec<String>,
        others: Vec<Span>,
    },
    Apart {
        span: Span,
        names: Vec<String>,
        others: Vec<Span>,
        nearest: Vec<(String, Phrase)>,
        left: Vec<Phrase>,
    },
    SeveralTogether {
        span: Span,
        names: Vec<String>,
        others: Vec<Span>,
        roots: Vec<String>,
    },
    /// A measure that has no optimum over the ranges, or whose optimum was not found.
    NoOptimum {
        span: Span,
        measure: String,
        at: Span,
        why: String,
    },
    /// None of the values tried met the conditions of an optimum.
    NeverMet {
        span: Span,
        tried: usize,
        /// Whether a free motion grew at some of them, which it may not.
        grows: bool,
        /// Whether they are to be met for all values within the tolerances.
        robust: bool,
    },
    /// The values that were found for these parameters let a free motion grow, or it is not proved that they do not.
    Unstable {
        span: Span,
        names: Vec<String>,
        optimum: bool,
        proved: bool,
    },
    /// Around the optimum, a parameter has no effect.
    Plateau {
        span: Span,
        name: String,
        value: Phrase,
        measure: String,
        at: Span,
    },
    /// The optimum lies at an end of a range.
    AtAnEnd {
        span: Span,
        name: String,
        value: Phrase,
        is_low: bool,
        highest: bool,
    },
    /// Lines `minimise` and `maximise` that depend on each other's parameters.
    Circle {
        span: Span,
        others: Vec<Span>,
    },
    Fails {
        span: Span,
        value: Phrase,
        /// How far that is from the limit, if it is a number: `off by 3 %`.
        by: Option<String>,
        remedy: Remedy,
    },
    Undetermined {
        span: Span,
        value: Phrase,
        limit: Phrase,
        bound: String,
    },
    NoNumber {
        span: Span,
        why: String,
    },
    /// A requirement that holds because nothing that drives the scene reaches what it measures: a warning.
    Still {
        span: Span,
    },
}

/// The values that a measure took over a range.
#[derive(Clone, Debug, PartialEq)]
pub struct ReachedRange {
    /// The least and the largest value, and the parameter at each.
    pub least: (Phrase, Phrase),
    pub largest: (Phrase, Phrase),
    /// The value at which the measure jumps over the target.
    pub jump: Option<Phrase>,
    /// Why it has no value somewhere in the range.
    pub gap: Option<String>,
    /// Whether it is proven that the measure never reaches the target; otherwise `evaluations` values were tried.
    pub proven: bool,
    pub evaluations: usize,
}

/// How a requirement can be met.
#[derive(Clone, Debug, PartialEq)]
pub enum Remedy {
    /// The model has no parameter that could be changed.
    NoParameter,
    NotFound,
    Change(ParameterChange),
}

/// The parameter that changes a measure most.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterChange {
    pub name: String,
    pub declared: Span,
    /// Change of the measure in percent for a change of the parameter by one percent.
    pub percent: Option<String>,
    /// Whether it changes the measure more than any other parameter that was tried.
    pub most: bool,
    /// A value at which the requirement was found to hold; `None` if none was found.
    pub wanted: Option<Phrase>,
    pub value: Phrase,
}

impl AskedError {
    pub fn code(&self) -> Code {
        match self {
            AskedError::NoRoot { .. } | AskedError::Apart { .. } => Code::model("vib::solve::no_root"),
            AskedError::SeveralRoots { .. } | AskedError::SeveralTogether { .. } => {
                Code::model("vib::solve::several_roots")
            }
            AskedError::Touches { .. } | AskedError::NothingSettled { .. } | AskedError::Unsettled { .. } => {
                Code::limit("vib::solve::unsettled")
            }
            AskedError::Independent { .. } => Code::model("vib::solve::independent"),
            AskedError::NoValue { .. } => Code::model("vib::solve::no_value"),
            AskedError::Twice { .. } => Code::model("vib::solve::twice"),
            AskedError::Singular { .. } => Code::model("vib::solve::singular"),
            AskedError::NoOptimum { .. } => Code::model("vib::minimise::no_value"),
            AskedError::NeverMet { .. } => Code::model("vib::minimise::never_met"),
            AskedError::Plateau { .. } => Code::model("vib::minimise::plateau"),
            AskedError::AtAnEnd { .. } => Code::model("vib::minimise::end_of_range"),
            AskedError::Unstable { optimum: true, .. } => Code::model("vib::minimise::unstable"),
            AskedError::Unstable { optimum: false, .. } => Code::model("vib::solve::unstable"),
            AskedError::Circle { .. } => Code::model("vib::minimise::circle"),
            AskedError::Fails { .. } => Code::model("vib::require::fails"),
            AskedError::Undetermined { .. } => Code::limit("vib::require::undetermined"),
            AskedError::NoNumber { .. } => Code::model("vib::require::no_value"),
            AskedError::Still { .. } => Code::model("vib::require::still"),
        }
    }

    pub fn to_diagnostic(&self) -> Diagnostic {
        use AskedError::*;
        let error = |span: &Span, message: String| Diagnostic::error(self.code(), *span, message);
        match self {
            NoRoot { span, measure, target, name, range, reach } => {
                let (low, high) = range;
                let message = if reach.proven {
                    format!("no value of `{name}` in {low} .. {high} makes `{measure}` {target}")
                } else {
                    let evaluations = reach.evaluations;
                    format!(
                        "none of {evaluations} values tried for `{name}` in {low} .. {high} makes `{measure}` {target}"
                    )
                };
                let (least, largest) = (&reach.least, &reach.largest);
                let seen = format!(
                    "it goes from {} at {name} = {} to {} at {name} = {}",
                    least.0, least.1, largest.0, largest.1
                );
                let jump = reach.jump.as_ref().map_or(String::new(), |at| format!(", and jumps over it near {at}"));
                let gap = reach.gap.as_ref().map_or(String::new(), |why| format!("; for some values {why}"));
                error(span, message)
                    .label(seen + &jump + &gap)
                    .help("ask for a value that is reached, or search another range")
            }
            SeveralRoots { span, measure, target, name, roots, all } => {
                let (least, others) = if *all { ("", "") } else { ("at least ", "; others are not excluded") };
                let message = format!("{least}{} values of `{name}` make `{measure}` {target}", roots.len());
                error(span, message)
                    .label(format!("{name} = {}{others}", enumeration(roots)))
                    .help("narrow the range around the one you want")
            }
            Touches { span, measure, target, name, at } => {
                error(span, format!("it is undetermined whether `{measure}` reaches {target}"))
                    .label(format!("near {name} = {at} it comes as close as can be resolved, without crossing it"))
                    .help("ask for a value that the measure crosses, or search another range")
            }
            NothingSettled { span, measure, target, name, parts } => {
                error(span, format!("no `{name}` was found that makes `{measure}` {target}"))
                    .label(format!("undetermined: {name} in {}; elsewhere in the range there is none", ranges(parts)))
                    .help("ask for a value that the measure crosses, or search another range")
            }
            Unsettled { span, name, value, parts } => {
                error(span, format!("{name} = {value} was found, but other values of `{name}` are not excluded"))
                    .label(format!(
                        "undetermined: {name} in {}; elsewhere in the range there is no other",
                        ranges(parts)
                    ))
                    .help("narrow the range around the value you want")
            }
            Independent { span, measure, at, name } => error(span, format!("`{measure}` does not depend on `{name}`"))
                .label("the same for every value tried")
                .with_related(*at, "this measure")
                .help("solve for a parameter that the measure depends on"),
            NoValue { span, measure, name, range, why } => {
                let message = format!("`{measure}` has no value for any `{name}` in {} .. {}", range.0, range.1);
                error(span, message).label(why.clone()).help("ask for another measure, or search another range")
            }
            Twice { span, name, first } => error(span, format!("`{name}` is solved for twice"))
                .with_related(*first, "here first")
                .help("let each `solve` line find a different parameter"),
            Singular { span, names, others } => {
                let message = format!("these conditions do not determine {}", quote(names));
                with_related(error(span, message), others)
                    .label("to first order, the parameters can change together without changing any measure")
                    .help("solve for parameters that change the measures in different ways, or ask for other values")
            }
            Apart { span, names, others, nearest, left } => {
                let message = format!(
                    "no values of {} in their ranges were found that meet these conditions together",
                    quote(names)
                );
                let at: Vec<String> = nearest.iter().map(|(name, value)| format!("{name} = {value}")).collect();
                with_related(error(span, message), others)
                    .label(format!("nearest: {}, where the measures are {}", at.join(", "), enumeration(left)))
                    .help("ask for values that are reached together, or search other ranges")
            }
            SeveralTogether { span, names, others, roots } => {
                let message =
                    format!("at least {} sets of values of {} meet these conditions", roots.len(), quote(names));
                with_related(error(span, message), others)
                    .label(roots.join("; or "))
                    .help("narrow the ranges around the set you want")
            }
            NoOptimum { span, measure, at, why } => {
                error(span, format!("`{measure}` has no optimum over these ranges"))
                    .label(why.clone())
                    .with_related(*at, "this measure")
                    .help("ask for another measure, or search other ranges")
            }
            NeverMet { span, tried, grows, robust } => {
                let meets =
                    if *grows { "meets the conditions without a motion that grows" } else { "meets the conditions" };
                let all = if *robust { " for all values within the tolerances" } else { "" };
                error(span, format!("none of the {tried} sets of values that were tried {meets}{all}"))
                    .label("the first of them")
                    .help("widen the ranges, or ask for less")
            }
            Plateau { span, name, value, measure, at } => {
                error(span, format!("`{measure}` does not determine `{name}`"))
                    .label(format!("near {name} = {value}, other values give exactly the same"))
                    .with_related(*at, "this measure")
                    .help("vary a parameter that changes the measure, or narrow the range to where it does")
            }
            AtAnEnd { span, name, value, is_low, highest } => {
                let (end, beyond) = if *is_low { ("lower", "below") } else { ("upper", "above") };
                let best = if *highest { "largest" } else { "least" };
                let message = format!("the {best} value lies at the {end} end of the range of `{name}`");
                Diagnostic::warning(self.code(), *span, message)
                    .label(format!("{name} = {value}; values {beyond} it may be better"))
                    .help("widen the range, unless this end is a limit of the design")
            }
            Unstable { span, names, optimum, proved } => {
                let (with, found) = (quote(names), if *optimum { "optimum" } else { "value" });
                let message = match proved {
                    true => format!("with the {found} that was found for {with}, a free motion grows"),
                    false => {
                        format!(
                            "with the {found} that was found for {with}, it is not proved that no free motion grows"
                        )
                    }
                };
                Diagnostic::warning(self.code(), *span, message)
                    .label("this line does not ask for a stable scene")
                    .help("search ranges in which the scene is stable, and write `require stable`")
            }
            Circle { span, others } => {
                let finding = error(span, "these lines depend on each other's parameters".to_string());
                others
                    .iter()
                    .fold(finding, |finding, other| {
                        finding.with_related(*other, "this one depends on it, and it on this one")
                    })
                    .label("its measure changes with the parameters of the others, and theirs with its own")
                    .help("write one measure over all of these parameters")
            }
            Fails { span, value, by, remedy } => {
                let by = by.as_ref().map_or(String::new(), |by| format!(", {by}"));
                let finding =
                    error(span, "this requirement does not hold".to_string()).label(format!("it is {value}{by}"));
                match remedy {
                    Remedy::NoParameter => finding,
                    Remedy::NotFound => finding.help("no parameter was found that makes it hold"),
                    Remedy::Change(change) => with_change(finding, change),
                }
            }
            Undetermined { span, value, limit, bound } => error(span, "this requirement cannot be decided".to_string())
                .label(format!("it is {value} within {bound}, which includes the limit {limit}"))
                .help("move the limit by more than the bound"),
            NoNumber { span, why } => error(span, "the measure in this requirement has no value".to_string())
                .label(why.clone())
                .help("ask for what the scene has"),
            Still { span } => {
                let message = "nothing moves what this requirement measures: it is zero";
                Diagnostic::warning(self.code(), *span, message)
                    .help("measure what moves, or connect this part of the model to what drives it")
            }
        }
    }
}

fn with_change(finding: Diagnostic, change: &ParameterChange) -> Diagnostic {
    let ParameterChange { name, declared, percent, most, wanted, value } = change;
    let moves = percent.as_ref().map(|percent| {
        let most = if *most { " most" } else { "" };
        format!("`{name}` changes it{most}: by {percent} % for each percent of `{name}`")
    });
    let help = match (moves, wanted) {
        (Some(moves), Some(wanted)) => format!("{moves}; with {name} = {wanted} it holds"),
        (None, Some(wanted)) => format!("with {name} = {wanted} it holds"),
        (Some(moves), None) => format!("{moves}; no value was found that makes it hold"),
        (None, None) => format!("`{name}` affects it, but no value was found that makes it hold"),
    };
    finding.with_related(*declared, format!("{value} now")).help(help)
}

fn with_related(finding: Diagnostic, others: &[Span]) -> Diagnostic {
    others.iter().fold(finding, |finding, span| finding.with_related(*span, "together with this"))
}

fn quote(names: &[String]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    enumeration(&quoted)
}

/// `1 N/m .. 2 N/m and 5 N/m .. 6 N/m`
fn ranges(parts: &[(Phrase, Phrase)]) -> String {
    enumeration(&parts.iter().map(|(low, high)| format!("{low} .. {high}")).collect::<Vec<_>>())
}

/// `a`, `a and b`, `a, b and c`.
fn enumeration(items: &[String]) -> String {
    match items {
        [] => String::new(),
        [one] => one.clone(),
        [most @ .., last] => format!("{} and {last}", most.join(", ")),
    }
}
