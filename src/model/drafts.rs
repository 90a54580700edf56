//! Components by themselves: mistakes in their bodies that do not depend on the place, even if they are never placed;
//! and the place that causes a mistake that occurs only at some places. In: the tree, a check in progress. Out:
//! findings. See spec.md#places-of-components.
//!
//! A draft places a component alone: each parameter is 1 in its unit, or its default; a port is a part of which nothing
//! is known, and everything that depends on it is skipped. A finding that also occurs with these values is a mistake of
//! the component.

use super::places::Frame;
use super::scope::{self, Definition, DefinitionId, DefinitionKind, Environment, Group, Role, State};
use super::value::Value;
use super::{Check, places};
use crate::base::{Code, Diagnostic, Label, Name, Span};
use crate::syntax::tree::{ExprId, Formal, FormalKind};
use std::collections::HashSet;

/// Limit on the findings whose cause is searched for; further ones stay where they are.
const MOST_LOOKED_INTO: u32 = 200;

/// The results of checking components by themselves.
#[derive(Debug, Default)]
pub struct Drafts {
    /// Whether this check is a draft.
    pub is_draft: bool,
    /// Findings in components with the values of a draft.
    nominal: Option<HashSet<(Code, Span)>>,
    /// Findings inside components that are reported at the place that causes them.
    moved: HashSet<(Code, Span)>,
    looked_into: u32,
}

/// Families of codes that concern the text, independent of the values of parameters and the connections of ports.
const OF_TEXT: [&str; 9] = ["name", "part", "unit", "field", "function", "place", "component", "parameter", "value"];

/// Codes of these families that do depend on values.
const OF_VALUES: [&str; 1] = ["vib::value::negative"];

fn is_of_text(code: Code) -> bool {
    let family = code.0.split("::").nth(1).unwrap_or_default();
    OF_TEXT.contains(&family) && !OF_VALUES.contains(&code.0)
}

impl<'a> Check<'a> {
    /// Looks at the bodies of the components that the scene does not place, directly or not.
    pub fn unplaced_components(&mut self) {
        let tree = self.tree;
        if tree.components.is_empty() || self.drafts.is_draft {
            return;
        }
        let mut is_placed = vec![false; tree.components.len()];
        for index in self.frames.iter().filter_map(|frame| frame.component) {
            is_placed[index as usize] = true;
        }
        let unplaced: Vec<u32> =
            (0..).zip(&is_placed).filter(|(_, placed)| !**placed).map(|(index, _)| index).collect();
        if unplaced.is_empty() {
            return;
        }
        for finding in self.draft_findings(&unplaced) {
            if finding.is_error() && is_of_text(finding.code) {
                self.say(finding);
            }
        }
    }

    /// The findings in components, each by itself.
    fn draft_findings(&self, components: &[u32]) -> Vec<Diagnostic> {
        let mut draft = Check::new(self.sources, self.tree, self.literals);
        draft.drafts.is_draft = true;
        draft.lacks_components = self.lacks_components;
        draft.broken_words = self.broken_words.clone();
        draft.known_components();
        draft.known.broken.clone_from(&self.known.broken);
        for &component in components {
            draft.place_alone(component);
        }
        draft.tie_ports();
        draft.evaluate_definitions();
        draft.bodies();
        draft.bases();
        draft.joints();
        draft.freedoms();
        draft.elements();
        draft.inputs();
        draft.settle_delays();
        draft.outputs();
        draft.couples();
        draft.initials();
        draft.requires();
        draft.diagnostics.into_sorted()
    }

    /// Places a component in its own axes.
    fn place_alone(&mut self, index: u32) {
        if self.known.broken[index as usize] {
            return;
        }
        let component = self.tree.component(index);
        // A number is never a word of the text.
        let symbol = self.words.intern(&index.to_string());
        let place = self.words.declare_place(Name::plain(symbol));
        let id = places::FrameId(self.frames.len() as u32);
        let inside = self.environments.enter(id);
        let span = component.name;
        self.frames.push(Frame::in_own_axes(place, index, inside, span));
        for (number, formal) in (0..).zip(&component.formals) {
            self.declare_nominal(id, index, number, formal);
        }
        self.declare_body(index, span, inside);
    }

    /// Declares a port that is tied to nothing, or a parameter with its default or the value 1 in its unit.
    fn declare_nominal(&mut self, frame: places::FrameId, component: u32, number: u32, formal: &Formal) {
        let Frame { inside, place, .. } = *self.frame(frame);
        let (span, group) = (formal.name, Group::of_component(component));
        let symbol = self.words.intern(self.sources.slice(span));
        let name = Name::plain(symbol).in_place(place);
        let FormalKind::Number { unit, default } = formal.kind else {
            let port = scope::Part::Port(self.ports_count());
            if self.parts.declare(group, name, port).is_ok() {
                self.tie_to_nothing(span);
            }
            return;
        };
        let state = match (default, unit) {
            (Some(_), _) => State::Unsettled,
            (None, Some(_)) => match self.formal_like(component, number, inside) {
                Ok(Some(like)) => State::Settled(Ok(Value::Scalar(like))),
                _ => State::Settled(Err(super::evaluate::Stop::Reported)),
            },
            (None, None) => State::Settled(Err(super::evaluate::Stop::Reported)),
        };
        // The expression of a settled definition is never evaluated; in a tree without expressions no name is used
        // either.
        let Some(expr) = default.or_else(|| self.tree.any_expr()) else { return };
        let id = DefinitionId(self.definitions.len() as u32);
        if self.values.declare(group, name, id).is_ok() {
            let role = Role::Parameter { frame, formal: number, given: false };
            let kind = DefinitionKind::Param;
            self.definitions.push(Definition { kind, name, span, expr, environment: inside, state, used: true, role });
        }
    }

    /// Moves a finding to the argument of a place that causes it, if the component by itself does not have it; `None`
    /// if the cause has already been reported.
    pub fn blame_argument(&mut self, mut finding: Diagnostic, environment: Environment) -> Option<Diagnostic> {
        let inside = finding.primary.span;
        if self.drafts.is_draft || is_of_text(finding.code) || self.environments.frame(environment).is_none() {
            return Some(finding);
        }
        if self.drafts.looked_into >= MOST_LOOKED_INTO {
            return (!self.drafts.moved.contains(&(finding.code, inside))).then_some(finding);
        }
        self.drafts.looked_into += 1;
        let Some(argument) = self.argument_behind(inside, environment) else { return Some(finding) };
        if self.is_nominal(finding.code, inside) {
            return Some(finding);
        }
        self.drafts.moved.insert((finding.code, inside));
        let text = std::mem::take(&mut finding.primary.text);
        let text = if text.is_empty() { "the value ends up here".into() } else { text };
        finding.related.insert(0, Label { span: inside, text });
        finding.primary = Label { span: argument, text: "this place gives it".into() };
        // The line inside stays as it is.
        finding.fixes.clear();
        Some(finding)
    }

    /// Whether the component by itself has this finding.
    fn is_nominal(&mut self, code: Code, span: Span) -> bool {
        if self.drafts.nominal.is_none() {
            let all: Vec<u32> = (0..).take(self.tree.components.len()).collect();
            let found = self.draft_findings(&all).iter().map(|finding| (finding.code, finding.primary.span)).collect();
            self.drafts.nominal = Some(found);
        }
        self.drafts.nominal.as_ref().is_some_and(|nominal| nominal.contains(&(code, span)))
    }

    /// The argument of a place that a number or a part comes from; the outermost one if components are nested.
    fn argument_behind(&mut self, span: Span, environment: Environment) -> Option<Span> {
        let mut waiting = vec![(span, environment)];
        let mut seen: HashSet<u32> = HashSet::new();
        let mut found = None;
        while let Some((span, environment)) = waiting.pop() {
            for id in self.names_within(span, environment) {
                if !seen.insert(id.0) {
                    continue;
                }
                let Definition { expr, environment, role, .. } = self.definitions[id.0 as usize];
                let span = self.tree.expr(expr).span;
                if matches!(role, Role::Parameter { given: true, .. }) {
                    // Arguments of an outer place come later, and replace the inner ones.
                    let is_outermost = self.environments.frame(environment).is_none();
                    if is_outermost {
                        return Some(span);
                    }
                    found = Some(span);
                }
                waiting.push((span, environment));
            }
            for (environment, argument) in self.ports_within(span, environment) {
                let span = self.tree.expr(argument).span;
                if self.environments.frame(environment).is_none() {
                    return Some(span);
                }
                found = Some(span);
                waiting.push((span, environment));
            }
        }
        found
    }

    /// The arguments of the ports that are named in a piece of text. They lead outwards, so the search ends.
    fn ports_within(&self, span: Span, environment: Environment) -> Vec<(Environment, ExprId)> {
        let place = self.place_of(environment);
        let named = self.tree.names_within(span).chain(self.tree.ends_within(span));
        let named = named.filter_map(|word| self.words.get(self.sources.slice(word)));
        let parts = named.filter_map(|symbol| self.parts.get(Name::plain(symbol).in_place(place)));
        parts.filter_map(|part| self.tied_to(part)).collect()
    }

    /// The parameters, `let`s and points that are named in a piece of text.
    fn names_within(&mut self, span: Span, environment: Environment) -> Vec<DefinitionId> {
        let place = self.place_of(environment);
        let named = self.tree.names_within(span);
        named
            .filter_map(|word| {
                let symbol = self.words.get(self.sources.slice(word))?;
                self.values.get(Name::plain(symbol).in_place(place))
            })
            .collect()
    }
}
