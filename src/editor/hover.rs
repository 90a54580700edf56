//! Information about the word under the pointer: values, parts and their share in each mode, keywords.

use super::document::{Document, Motions, Results};
use super::lexed::Lexed;
use super::pages;
use super::project::{At, Meaning, Project};
use super::roles::{Role, Space};
use super::shown;
use super::tokens::TokenKind;
use crate::backend;
use crate::base::{Dimension, Number};
use crate::kinds::motions::{COUPLE_REACTIONS, JOINT_REACTIONS, ReactionComponent};
use crate::lower::SpringAtRest;
use crate::model::scene::{
    Body, Element, Freedom, Geometry, Holder, JointId, Law, Motion, MotionTerm, Reaction, Scene,
};
use crate::model::{Overrides, Scalar, Value};
use crate::system::Origin;
use std::ops::Range;

/// Markdown about a range of the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hover {
    pub range: Range<usize>,
    pub markdown: String,
}

pub fn hover(document: &Document, project: &Project, offset: usize) -> Option<Hover> {
    let token = document.token_at(offset)?;
    let at = At { file: 0, token };
    let markdown = match (document.tokens[token].kind, document.roles[token]) {
        (TokenKind::Number { .. }, _) => number(document, token)?,
        (TokenKind::Word, Role::Keyword) => pages::keyword(document.token_text(token))?,
        // `road` is a function only within `noise`; elsewhere it is a word.
        (TokenKind::Word, Role::Function) => {
            let word = document.token_text(token);
            pages::function(word).or_else(|| pages::word(word).map(String::from))?
        }
        (TokenKind::Word, Role::Word | Role::Constant) => pages::word(document.token_text(token))?.to_string(),
        (TokenKind::Word, role) => match (project.meaning(at), role) {
            (Some(meaning), _) => name(document, project, at, &meaning)?,
            (None, Role::Field) => field(document, token)?,
            (None, Role::Member) => pages::motion(document.token_text(token))?.to_string(),
            // A unit without a number.
            (None, Role::None) => pages::unit(document.token_text(token))?,
            _ => return None,
        },
        _ => return None,
    };
    Some(Hover { range: document.tokens[token].range.clone(), markdown })
}

fn name(document: &Document, project: &Project, at: At, meaning: &Meaning) -> Option<String> {
    match meaning.space {
        Space::Values => value(document, project, at, meaning),
        Space::Parts => part(document, project, at, meaning),
        Space::Places => place(document, project, at, meaning),
        Space::Components => component(project, meaning),
    }
}

/// A component: its head and its documentation.
fn component(project: &Project, meaning: &Meaning) -> Option<String> {
    let (file, statement) = project.body_of(meaning)?;
    let lexed = project.lexed_text(file);
    let head = lexed.text()[lexed.range_of(statement)].trim_end_matches('{').trim_end();
    let mut markdown = format!("{}\n\n{}", model(head), paragraph(&lexed.doc(statement)));
    for (keyword, heading) in [("output", "outputs"), ("point", "points")] {
        let own = |index: &usize| {
            lexed.outline.statements[*index].inside == Some(statement) && lexed.keyword(*index) == keyword
        };
        let lines: Vec<String> = (0..lexed.outline.statements.len())
            .filter(own)
            .filter_map(|index| {
                let name = lexed.outline.statements[index].tokens.start + 1;
                let word = (name < lexed.outline.statements[index].tokens.end).then(|| lexed.token_text(name))?;
                let doc = lexed.doc(index);
                Some(if doc.is_empty() { format!("- `{word}`\n") } else { format!("- `{word}`: {doc}\n") })
            })
            .collect();
        if !lines.is_empty() {
            markdown += &format!("{heading}:\n\n{}\n", lines.concat());
        }
    }
    Some(markdown)
}

/// A place: its declaration, its component, and the values of its parameters there.
fn place(document: &Document, project: &Project, at: At, meaning: &Meaning) -> Option<String> {
    let mut markdown = declaring_lines(project, meaning)?;
    let placed = project.component_at(meaning)?;
    let lexed = project.lexed_text(placed.0);
    let word = lexed.token_text(lexed.outline.statements[placed.1].tokens.start + 1);
    markdown += &component(project, &project.component(meaning.file, word)?)?;
    let written = written_name(document, at);
    for formal in project.formals(placed).iter().filter(|formal| !formal.is_port) {
        let name = lexed.token_text(formal.name);
        let own = format!("{written}.{name}");
        let same = document.values.iter().filter(|defined| without_indices(&defined.name) == own);
        for defined in same.take(MANY) {
            if let Some(value) = &defined.value {
                markdown +=
                    &format!("`{}` = {}\n\n", defined.name, describe_value(value, &lexed.text()[formal.range.clone()]));
            }
        }
    }
    Some(markdown)
}

/// The lines that declare a name, with their documentation.
fn declaring_lines(project: &Project, meaning: &Meaning) -> Option<String> {
    let lexed = project.lexed_text(meaning.file);
    let mut markdown = String::new();
    for token in project.declarations(meaning) {
        let statement = lexed.statement_of(*token)?;
        markdown += &format!("{}\n\n{}", model(line_of(lexed, statement)), paragraph(&lexed.doc(statement)));
    }
    (!markdown.is_empty()).then_some(markdown)
}

/// The declaration of a name; for a name in the brackets of a component, the whole head.
fn line_of(lexed: &Lexed, statement: usize) -> &str {
    let line = &lexed.text()[lexed.range_of(statement)];
    if lexed.keyword(statement) == "component" { line.trim_end_matches('{').trim_end() } else { line }
}

/// `front.tyre`: a name with the names before it, without indices.
fn written_name(document: &Document, at: At) -> String {
    let chain = document.chain(at.token).unwrap_or_else(|| vec![at.token]);
    chain.into_iter().map(|token| document.token_text(token)).collect::<Vec<_>>().join(".")
}

/// `mount[3].s` as `mount.s`.
fn without_indices(name: &str) -> String {
    let mut depth = 0_usize;
    let outside = |c: &char| {
        match c {
            '[' => depth += 1,
            ']' => depth = depth.saturating_sub(1),
            _ => return depth == 0,
        }
        false
    };
    name.chars().filter(outside).collect()
}

/// Whether the name of an item of the scene matches a written name: exactly, or inside a component at any place.
fn stands_for(shown: &str, written: &str, in_component: bool) -> bool {
    let plain = without_indices(shown);
    plain == written || in_component && plain.ends_with(&format!(".{written}"))
}

/// A fenced block of model text.
fn model(text: &str) -> String {
    format!("```vib\n{text}\n```")
}

/// `10 kN/m` in base units.
fn number(document: &Document, token: usize) -> Option<String> {
    let text = document.text();
    let unit = document.tokens[token].unit(text)?;
    let meaning = pages::unit(&text[unit])?;
    Some(format!("{}\n\n{meaning}", model(document.token_text(token))))
}

fn field(document: &Document, token: usize) -> Option<String> {
    let statement = document.statement_of(token)?;
    pages::field(document.keyword(statement), document.token_text(token)).map(|text| text.to_string())
}

/// A parameter, a point or an index: how it is declared, and its value in its unit and in SI.
fn value(document: &Document, project: &Project, at: At, meaning: &Meaning) -> Option<String> {
    let lexed = project.lexed_text(meaning.file);
    if let Some(repeat) = meaning.scope.filter(|scope| lexed.keyword(*scope) == "repeat") {
        return Some(format!("{}\n\nThe index of this `repeat`.", model(&lexed.text()[lexed.range_of(repeat)])));
    }
    let id = project.files[meaning.file].id;
    let written = document.roles[at.token] == Role::Member;
    let written = written.then(|| written_name(document, at));
    let mut markdown = String::new();
    for token in project.declarations(meaning) {
        let statement = lexed.statement_of(*token)?;
        let line = line_of(lexed, statement);
        markdown += &format!("{}\n\n", model(line));
        let start = lexed.tokens[*token].range.start;
        let same = document.values.iter().filter(|defined| {
            let is_asked = written.as_ref().is_none_or(|written| without_indices(&defined.name) == *written);
            Some(defined.span.file()) == id && defined.span.start() == start && is_asked
        });
        for defined in same.take(MANY) {
            if let Some(value) = &defined.value {
                markdown += &format!("`{}` = {}\n\n", defined.name, describe_value(value, line));
            }
        }
        markdown += &paragraph(&lexed.doc(statement));
    }
    (!markdown.is_empty()).then_some(markdown)
}

/// The most repetitions, modes and parts that are shown.
const MANY: usize = 6;

fn paragraph(text: &str) -> String {
    if text.is_empty() { String::new() } else { format!("{text}\n\n") }
}

/// A value in the unit that its declaration is written in, and in base units.
fn describe_value(value: &Value, line: &str) -> String {
    let Value::Scalar(Scalar { quantity, .. }) = value else { return format!("**{}**", shown::value(value)) };
    let tokens = super::tokens::tokens(line);
    let units = tokens.iter().filter_map(|token| Some(&line[token.unit(line)?]));
    let own = units.clone().find_map(|unit| shown::in_unit(quantity, unit));
    let usual = shown::quantity(quantity);
    let base = shown::in_base_units(quantity);
    let mut texts = vec![own.unwrap_or_else(|| usual.clone())];
    texts.extend([usual, format!("{base} in SI base units")]);
    texts.dedup_by(|a, b| a == b || *a == format!("{b} in SI base units"));
    texts[0] = format!("**{}**", texts[0]);
    texts.join(" = ")
}

/// A body, a base, an element, an input or an output, with all its repetitions.
fn part(document: &Document, project: &Project, at: At, meaning: &Meaning) -> Option<String> {
    let mut markdown = declaring_lines(project, meaning).unwrap_or_default();
    let written = written_name(document, at);
    // A name in a component exists at each of its places; a name in another file, at the places that this file knows.
    let in_component = document.roles[at.token] != Role::Member && meaning.scope.is_some();
    if let Some(known) = &document.known {
        let scene = known.scene.scene();
        let named = |name| stands_for(&scene.words.display(name), &written, in_component);
        for body in scene.bodies.iter().filter(|body| named(body.name)).take(MANY) {
            markdown += &body_page(scene, body, known.motions.as_ref());
        }
        let bodies = scene.bodies.iter().filter(|body| named(body.name)).map(|body| scene.words.display(body.name));
        markdown += &equations(document, known, &bodies.take(MANY).collect::<Vec<String>>());
        markdown += &elements(known, named);
        markdown += &reactions_at_rest(known, named);
    }
    (!markdown.is_empty()).then_some(markdown)
}

/// Mass, moment of inertia, centre, degrees of freedom, and the share in each mode.
fn body_page(scene: &Scene, body: &Body, motions: Option<&Motions>) -> String {
    let name = scene.words.display(body.name);
    let mut facts = Vec::new();
    facts.extend(body.mass.as_ref().map(|mass| format!("mass {}", shown::with_unit(mass, "kg"))));
    facts.extend(body.inertia.as_ref().map(|j| format!("inertia {} about the centre", shown::with_unit(j, "kg*m^2"))));
    facts.extend(
        body.centre
            .as_ref()
            .map(|c| format!("centre ({}, {})", shown::with_unit(&c.x, "m"), shown::with_unit(&c.y, "m"))),
    );
    let mut text = format!("`{name}`: {}\n\n", facts.join(", "));
    let own: Vec<usize> = motions.map_or(Vec::new(), |motions| {
        (0..motions.system.n()).filter(|i| motions.system.coordinates[*i].name.name == body.name).collect()
    });
    let freedoms: Vec<String> = match motions {
        Some(motions) => own.iter().map(|i| motions.system.display(motions.system.coordinates[*i].name)).collect(),
        None => declared_freedoms(body),
    };
    text += &match freedoms.as_slice() {
        [] => "degrees of freedom: none of its own\n\n".to_string(),
        list => {
            format!("degrees of freedom: {}\n\n", list.iter().map(|f| format!("`{f}`")).collect::<Vec<_>>().join(", "))
        }
    };
    if let Some(motions) = motions {
        text += &shares(motions, "kinetic energy", |mode| {
            mode.kinetic.iter().filter(|share| share.of.name == body.name).map(|share| share.part.0).sum()
        });
    }
    text
}

/// Maximum number of coordinates of a scene whose equations are derived while a user waits.
const FEW: usize = 12;

/// The equations of motion of bodies, derived on request; empty if that would take long, or if the text has errors.
fn equations(document: &Document, known: &Results, bodies: &[String]) -> String {
    let is_small = known.motions.as_ref().is_some_and(|m| m.system.n() + m.rest.dependent.len() <= FEW);
    if bodies.is_empty() || !document.is_current || !is_small {
        return String::new();
    }
    let found = crate::equations(&document.sources, document.file, &Overrides::default()).answer;
    let lines = |of: &[String]| of.iter().map(|line| format!("{line}\n")).collect::<String>();
    let both = found.map(|found| backend::equations::of_bodies(&found, bodies));
    let Some((moving, linear)) = both.filter(|(moving, _)| !moving.is_empty()) else { return String::new() };
    let mut text = format!("equations of motion:\n\n```text\n{}```\n\n", lines(&moving));
    if !linear.is_empty() && linear != moving {
        text += &format!("about rest:\n\n```text\n{}```\n\n", lines(&linear));
    }
    text
}

fn declared_freedoms(body: &Body) -> Vec<String> {
    match &body.freedom {
        Freedom::FromJoints => vec!["determined by its joints".into()],
        Freedom::OnGround { translations, turns } => {
            let motions = translations.iter().map(|translation| translation.motion.to_string());
            motions.chain(turns.then(|| "angle".to_string())).collect()
        }
    }
}

/// The share of a part in each of the first modes, as a table.
fn shares(motions: &Motions, of: &str, part: impl Fn(&crate::analysis::Mode) -> f64) -> String {
    let modes: Vec<_> = motions.modes.with_numbers().take(MANY).collect();
    if modes.is_empty() {
        return String::new();
    }
    let mut text = format!("| mode | f | share of {of} |\n| --- | --- | --- |\n");
    for (number, mode) in modes {
        text += &format!("| {number} | {} | {:.0} % |\n", shown::hertz(&mode.omega), 100.0 * part(mode));
    }
    text + "\n"
}

/// Stretch and tension at rest, and the share of the strain energy in each mode.
fn elements(known: &Results, named: impl Fn(crate::base::Name) -> bool) -> String {
    let scene = known.scene.scene();
    let mut text = String::new();
    let chosen: Vec<(usize, &Element)> =
        scene.elements.iter().enumerate().filter(|(_, element)| named(element.name)).take(MANY).collect();
    if chosen.is_empty() {
        return text;
    }
    let at_rest = known.motions.as_ref().map(|motions| motions.mechanism.springs_at_rest(scene, &motions.rest));
    for (index, element) in chosen {
        let turns = element.law.geometry == Geometry::Torsion;
        let name = scene.words.display(element.name);
        let Law { kind, coefficient, curve, .. } = &*element.law;
        let (word, unit) = (kind.coefficient().name, kind.unit(turns));
        let spring = at_rest.iter().flatten().find(|spring| spring.element.index() == index);
        text += &match (curve, spring) {
            (None, _) => format!("`{name}`: {word} = {}\n\n", shown::with_unit(coefficient, unit)),
            (Some(_), None) if kind.is_elastic() => format!("`{name}`: a law\n\n"),
            (Some(_), spring) => {
                let tangent = spring.map_or(coefficient, |spring| &spring.stiffness);
                format!("`{name}`: a law, with the tangent {word} = {} at rest\n\n", shown::with_unit(tangent, unit))
            }
        };
        text += &spring.map_or(String::new(), |spring| rest(spring, turns));
        if let Some(motions) = known.motions.as_ref().filter(|_| kind.is_elastic()) {
            let own = Origin::Element(index as u32);
            text += &shares(motions, "strain energy", |mode| {
                mode.strain.iter().filter(|share| share.of.origin == own).map(|share| share.part.0).sum()
            });
        }
    }
    text
}

/// `at rest: fx = 1.2 kN, fy = 0 N`: what joints and couplings carry, and the words for it in outputs. What redundant joints leave open is
/// left out.
fn reactions_at_rest(known: &Results, named: impl Fn(crate::base::Name) -> bool) -> String {
    let scene = known.scene.scene();
    let Some(motions) = &known.motions else { return String::new() };
    let joints = (0..).map(JointId).zip(&scene.joints).map(|(id, joint)| {
        let own = JOINT_REACTIONS
            .iter()
            .filter(|(component, ..)| *component != ReactionComponent::Moment || !joint.kind.turns);
        (joint.name, Holder::Joint(id), own.map(|(component, name, _)| (*component, *name)).collect::<Vec<_>>(), None)
    });
    let couples = (0..).zip(&scene.couples).map(|(id, couple)| {
        let own = COUPLE_REACTIONS.iter().map(|(component, name, _)| (*component, *name)).collect();
        (couple.name, Holder::Couple(id), own, Dimension::TORQUE.per(couple.dimension))
    });
    let mut text = String::new();
    for (name, holder, components, dimension) in joints.chain(couples).filter(|(name, ..)| named(*name)).take(MANY) {
        let value = |(component, word): (ReactionComponent, &str)| {
            let reaction = Reaction { holder, component };
            let term = MotionTerm { coefficient: Number::ONE, motion: Motion::Reaction(reaction) };
            let value = motions.mechanism.at_rest(scene, &motions.rest, &[term], holder.span(scene)).ok()?;
            let dimension = dimension.unwrap_or(match component {
                ReactionComponent::Moment => Dimension::TORQUE,
                _ => Dimension::FORCE,
            });
            Some(format!("`{word}` = {}", shown::with_unit(&value, &dimension.usual_unit())))
        };
        let values: Vec<String> = components.into_iter().filter_map(value).collect();
        if !values.is_empty() {
            let name = scene.words.display(name);
            text += &format!("`{name}` carries at rest: {}\n\n", values.join(", "));
        }
    }
    text
}

/// `at rest: stretch 0.1 m (0 m from the drawing), tension 1 N`
fn rest(spring: &SpringAtRest, turns: bool) -> String {
    let (length, force) = if turns { ("rad", "N*m") } else { ("m", "N") };
    let stretch = spring.stretch.as_ref().map_or(String::new(), |stretch| {
        format!("stretch {} from its free length, ", shown::with_unit(stretch, length))
    });
    let change = shown::with_unit(&spring.change, length);
    format!("at rest: {stretch}{change} from the drawing, tension {}\n\n", shown::with_unit(&spring.tension, force))
}
