//! Hints at the ends of a model's lines: natural frequencies and damping, values of derived parameters.

use super::document::{Document, Motions, Results};
use super::shown;
use crate::analysis::{Mode, ModeKind, Pole, PoleKind, Stability};
use crate::base::{Number, OrderBy};
use crate::model::Defined;
use crate::questions::answer::{self, Best, OptimisedParameter};
use crate::syntax::tree::{Decl, DeclKind, ExprId, ExprKind};

/// A text that is shown at a place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hint {
    pub at: usize,
    pub text: String,
    /// Further details.
    pub tooltip: Option<String>,
}

/// The hints of a text, in order.
pub fn hints(document: &Document) -> Vec<Hint> {
    let mut hints = values(document);
    if let Some(known) = document.known.as_ref().filter(|_| document.is_current) {
        hints.extend(frequencies(document, known));
        hints.extend(solve_hints(document));
        hints.extend(optimum_hints(document));
        hints.extend(margins(document));
    }
    hints.order_by_key(|hint| hint.at);
    hints
}

/// After the `model` line, or the first declaration.
fn frequencies(document: &Document, known: &Results) -> Option<Hint> {
    let motions = known.motions.as_ref()?;
    if !document.is_whole && known.scene.scene().determines_parameters() {
        return None;
    }
    let statements = 0..document.outline.statements.len();
    let line = statements.clone().find(|s| document.keyword(*s) == "model").or_else(|| statements.clone().next())?;
    let at = document.range_of(line).end;
    Some(Hint { at, text: line_of(motions), tooltip: Some(table(motions)) })
}

/// The most motions that are shown in a line.
const SHOWN: usize = 4;

/// `2 degrees of freedom: 0.4225 Hz ζ 11.68 %, 0.4849 Hz ζ 62.76 %`
fn line_of(motions: &Motions) -> String {
    let n = motions.system.n();
    let freedoms = if n == 1 { "1 degree of freedom".to_string() } else { format!("{n} degrees of freedom") };
    let mut list: Vec<String> = motion_texts(motions).into_iter().take(SHOWN + 1).collect();
    let more = list.len() > SHOWN;
    list.truncate(SHOWN);
    if more {
        list.push("...".into());
    }
    let verdict = match motions.modal.as_ref().map(|modal| modal.stability.kind()) {
        _ if !motions.rest.is_proven() => ", rest not proven",
        Some(Stability::Unstable) => ", UNSTABLE",
        Some(Stability::Undetermined) => ", stability undetermined",
        _ if motions.modal.as_ref().is_some_and(|modal| modal.poles.is_uncounted()) => {
            ", not proved that these are all"
        }
        _ if poles(motions).is_none() && !motions.system.c.is_empty() => ", undamped",
        _ => "",
    };
    if list.is_empty() { format!("{freedoms}{verdict}") } else { format!("{freedoms}{verdict}: {}", list.join(", ")) }
}

/// The poles of a damped scene, if they are known.
fn poles(motions: &Motions) -> Option<&[Pole]> {
    let modal = motions.modal.as_ref().filter(|_| !motions.system.c.is_empty())?;
    Some(modal.poles.list.as_slice()).filter(|list| !list.is_empty())
}

/// A few words for each motion: its poles if there is damping, otherwise its modes.
fn motion_texts(motions: &Motions) -> Vec<String> {
    let Some(poles) = poles(motions) else {
        let mode = |mode: &Mode| match mode.kind {
            ModeKind::Oscillation => shown::hertz(&mode.omega),
            ModeKind::Rigid => "rigid".into(),
            ModeKind::Divergence => "divergence".into(),
            ModeKind::Undetermined => "undetermined".into(),
        };
        return motions.modes.list.iter().map(mode).collect();
    };
    let pole = |pole: &Pole| match (pole.kind, &pole.damping_ratio) {
        (PoleKind::Oscillation | PoleKind::Flutter, Some(ratio)) => {
            format!("{} ζ {}", shown::hertz(&pole.modulus()), shown::per_cent(ratio))
        }
        (kind, _) => kind.name().into(),
    };
    // One pole of each complex pair.
    poles.iter().filter(|pole| pole.im.mid.hi >= 0.0).map(pole).collect()
}

/// All known motions, one on each line.
fn table(motions: &Motions) -> String {
    let lines = (1..).zip(motion_texts(motions)).map(|(number, motion)| format!("{number}. {motion}"));
    lines.collect::<Vec<_>>().join("\n")
}

/// After `solve`: the value that was found.
fn solve_hints(document: &Document) -> impl Iterator<Item = Hint> + '_ {
    let own = document.solved.iter().filter(|solved| solved.span.file() == document.file);
    own.filter_map(|solved| {
        let at = end_of_statement(document, solved.span.start())?;
        let text = format!("{} = {}", solved.parameter, answer::shown_text(&solved.in_unit()));
        Some(Hint { at, text, tooltip: None })
    })
}

/// After `minimise` and `maximise`: the values that were found, and the measure there.
fn optimum_hints(document: &Document) -> impl Iterator<Item = Hint> + '_ {
    let own = document.optimised.iter().filter(|optimised| optimised.span.file() == document.file);
    own.filter_map(|optimised| {
        let at = end_of_statement(document, optimised.span.start())?;
        let value =
            |found: &OptimisedParameter| format!("{} = {}", found.parameter, answer::shown_text(&found.in_unit()));
        let values: Vec<String> = optimised.parameters.iter().map(value).collect();
        let mark = if matches!(optimised.best, Best::Everywhere { .. }) { "" } else { ", not proved best" };
        let text = format!("{}: {}{mark}", values.join(", "), answer::shown_text(&optimised.in_unit()));
        Some(Hint { at, text, tooltip: None })
    })
}

/// After `require`: the value of the measure, and its margin.
fn margins(document: &Document) -> impl Iterator<Item = Hint> + '_ {
    // Requirements of a component may be in another file.
    let own = document.requirements.iter().filter(|requirement| requirement.span.file() == document.file);
    own.filter_map(|requirement| {
        let at = end_of_statement(document, requirement.span.start())?;
        let mark = match requirement.holds {
            Some(true) => "✓",
            Some(false) => "✗",
            None => "?",
        };
        let margin = requirement.margin.filter(|margin| margin.is_finite());
        let of = if requirement.limit.as_ref().is_some_and(Number::is_zero) { "" } else { " %" };
        let margin = margin.map_or(String::new(), |margin| {
            let shown = margin.to_f64() * if of.is_empty() { 1.0 } else { 100.0 };
            format!(", margin {}{of}", answer::few_digits(shown))
        });
        Some(Hint { at, text: format!("{mark} {}{margin}", requirement.value_text()), tooltip: None })
    })
}

fn end_of_statement(document: &Document, offset: usize) -> Option<usize> {
    let statement = document.outline.at(document.text(), &document.tokens, offset)?;
    Some(document.range_of(statement).end)
}

/// After `let`, and after a `param` that is calculated.
fn values(document: &Document) -> Vec<Hint> {
    let mut hints: Vec<Hint> = Vec::new();
    let mut spans: Vec<usize> = Vec::new();
    for decl in all_decls(document) {
        let expr = match decl.kind {
            DeclKind::Let { name, value } => (name, value),
            DeclKind::Param { name, value, .. } if is_calculated(document, value) => (name, value),
            _ => continue,
        };
        let start = expr.0.span.start();
        if spans.contains(&start) {
            continue;
        }
        spans.push(start);
        let same = document.values.iter().filter(|defined| defined.span == expr.0.span);
        let list: Vec<&Defined> = same.take(SHOWN + 1).collect();
        if let Some(text) = value_list(&list) {
            hints.push(Hint { at: decl.span.end(), text: format!("= {text}"), tooltip: None });
        }
    }
    hints
}

/// All declarations of the text, including those in every `repeat` and component; the tree has those of used files as well.
fn all_decls(document: &Document) -> impl Iterator<Item = &Decl> {
    let tree = &document.tree;
    let inside = tree.repeats.iter().map(|repeat| &repeat.body).chain(tree.components.iter().map(|it| &it.body));
    tree.decls.iter().chain(inside.flatten()).filter(|decl| decl.span.file() == document.file)
}

fn is_calculated(document: &Document, value: ExprId) -> bool {
    match document.tree.expr(value).kind {
        ExprKind::Literal { .. } => false,
        ExprKind::Negate { operand } => is_calculated(document, operand),
        _ => true,
    }
}

/// The values of a name in all repetitions; `None` if one of them has an error.
fn value_list(list: &[&Defined]) -> Option<String> {
    let mut texts = Vec::new();
    for defined in list.iter().take(SHOWN) {
        texts.push(shown::value(defined.value.as_ref()?));
    }
    if list.len() > SHOWN {
        texts.push("...".into());
    }
    (!texts.is_empty()).then(|| texts.join(", "))
}
