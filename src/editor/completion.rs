//! Completion at a place: keywords, fields that are not given yet, names, motions, units of the right dimension.

use super::document::Document;
use super::lexed::Lexed;
use super::names;
use super::pages;
use super::project::{At, Project};
use super::roles::{self, Role, Space, has_ends};
use super::signature;
use super::tokens::{Token, TokenKind, tokens};
use crate::base::{Dimension, Takes};
use crate::kinds::functions::{self, Function, FunctionKind};
use crate::kinds::motions::{BODY_MOTIONS, COUPLE_REACTIONS, ELEMENT_MOTIONS, JOINT_REACTIONS, SUPPORT_REACTIONS};
use crate::kinds::{self, Argument, Content, DECLARATIONS, Declaration, Naming, Piece};
use crate::syntax::words;

/// Selects the keywords whose declared names are offered.
type Wanted = fn(&str) -> bool;

/// A proposal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Item {
    pub label: String,
    pub kind: ItemKind,
    /// The text beside it.
    pub detail: String,
    /// The text that is inserted; the label if `None`.
    pub insert: Option<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ItemKind {
    Keyword,
    Field,
    Value,
    Part,
    Motion,
    Function,
    Unit,
}

fn item(label: &str, kind: ItemKind, detail: impl Into<String>) -> Item {
    Item { label: label.into(), kind, detail: detail.into(), insert: None }
}

/// The part of a proposal that is already typed at a place.
pub fn typed_prefix(document: &Document, offset: usize) -> std::ops::Range<usize> {
    let text = document.text();
    let alone = Project::of(document);
    let number = Place::new(document, &alone, offset).and_then(|place| Some((place.number?, place.statement)));
    if let Some((number, statement)) = number {
        let start = document.range_of(statement).start;
        let unit = number.unit(&text[start..]).map(|unit| start + unit.start);
        return unit.unwrap_or(offset)..offset;
    }
    text[..offset].trim_end_matches(|c: char| words::is_letter(c) || c.is_ascii_digit()).len()..offset
}

/// The proposals at a place.
pub fn items(document: &Document, project: &Project, offset: usize) -> Vec<Item> {
    let text = document.text();
    let line_start = text[..offset].rfind('\n').map_or(0, |at| at + 1);
    let line = tokens(&text[line_start..offset]);
    if line.last().is_some_and(|last| matches!(last.kind, TokenKind::Comment | TokenKind::Text)) {
        return Vec::new();
    }
    let Some(place) = Place::new(document, project, offset) else { return keywords() };
    place.items()
}

fn keywords() -> Vec<Item> {
    let keyword = |declaration: &Declaration| {
        let Declaration { keyword, form, .. } = *declaration;
        Item { insert: Some(form.into()), ..item(keyword, ItemKind::Keyword, form) }
    };
    DECLARATIONS.iter().map(keyword).collect()
}

/// A place in a statement: the tokens before it, without the current word.
struct Place<'a> {
    document: &'a Document,
    project: &'a Project<'a>,
    statement: usize,
    /// Tokens of the statement before the place.
    before: Vec<Token>,
    /// The number that ends at the place, with the typed part of its unit.
    number: Option<Token>,
    /// Open brackets, each with the token before it.
    open: Vec<(&'a str, Option<usize>)>,
}

impl<'a> Place<'a> {
    /// `None` at the start of a statement.
    fn new(document: &'a Document, project: &'a Project<'a>, offset: usize) -> Option<Place<'a>> {
        let text = document.text();
        let typed = text[..offset].trim_end_matches(|c: char| words::is_letter(c) || c.is_ascii_digit()).len();
        let statement = document.outline.at(text, &document.tokens, offset)?;
        let start = document.range_of(statement).start;
        let mut before: Vec<Token> = tokens(&text[start..offset]);
        before.retain(|token| token.kind != TokenKind::Comment);
        let mut number = None;
        if let Some(last) = before.last() {
            let touches = |token: &Token| {
                let rest = &text[start + token.range.end..offset];
                rest.is_empty() || rest == " "
            };
            match last.kind {
                TokenKind::Number { .. } if touches(last) => number = Some(last.clone()),
                TokenKind::Word if start + last.range.end == offset => drop(before.pop()),
                _ => {}
            }
        }
        if before.is_empty() || typed <= start {
            return None;
        }
        let mut open = Vec::new();
        for (index, token) in before.iter().enumerate() {
            match token.kind {
                TokenKind::Open => open.push((token.text(&text[start..]), index.checked_sub(1))),
                TokenKind::Close => drop(open.pop()),
                _ => {}
            }
        }
        Some(Place { document, project, statement, before, number, open })
    }

    fn text(&self, token: usize) -> &'a str {
        let start = self.document.range_of(self.statement).start;
        self.before[token].text(&self.document.text()[start..])
    }

    /// The `count`-th visible token from the end, counted from 1.
    fn last(&self, count: usize) -> &'a str {
        let visible = |token: &usize| self.before[*token].kind != TokenKind::LineEnd;
        (0..self.before.len()).rev().filter(visible).nth(count - 1).map_or("", |token| self.text(token))
    }

    fn keyword(&self) -> &'a str {
        self.document.keyword(self.statement)
    }

    fn written_declaration(&self) -> Option<&'static Declaration> {
        kinds::declaration(self.keyword())
    }

    fn items(&self) -> Vec<Item> {
        if self.number.is_some() {
            return self.units();
        }
        let last = self.last(1);
        match last {
            "." => return self.members().unwrap_or_else(|| self.motions()),
            "@" => return self.spots(),
            _ => {}
        }
        if matches!(self.keyword(), "minimise" | "maximise") && self.open.is_empty() && self.has("over") {
            let in_range = last == "over" || last == "," && !self.has("while");
            if in_range {
                return self.values(|kind| kind == "param");
            }
        }
        if self.keyword() == "correlate" && last == "," {
            return self.values(|kind| kind == "param");
        }
        if self.keyword() == "param" && self.open.is_empty() && self.has("=") {
            return self.tolerance();
        }
        if self.keyword() == "place" && self.before.len() > 1 {
            return self.placing();
        }
        if self.before.len() == 1 {
            return self.after_keyword();
        }
        if self.keyword() == "output" && self.open.is_empty() && !self.has("=") {
            return match self.has("in") {
                true => self.units(),
                false => vec![item("in", ItemKind::Keyword, "the unit that the output is shown in")],
            };
        }
        if self.open.last().is_some_and(|(bracket, _)| *bracket == "{") {
            return self.in_braces();
        }
        let in_ends = has_ends(self.keyword()) && self.open.is_empty();
        if in_ends && matches!(last, ":" | "--") {
            return self.ends();
        }
        if matches!(last, "along" | "moves") {
            return directions();
        }
        if in_ends && !["=", "+", "-", "*", "/", "("].contains(&last) && !self.has("=") {
            return self.clauses();
        }
        self.expression()
    }

    /// The items that may follow the name of a `place`: a component, its arguments, its position and orientation.
    fn placing(&self) -> Vec<Item> {
        let last = self.last(1);
        match self.open.as_slice() {
            [] if last == "=" => self.components(),
            [] if last == "at" => {
                vec![Item { insert: Some("(0, 0)".into()), ..item("(x, y)", ItemKind::Value, "a position") }]
            }
            [] if last == "mirrored" => {
                ["x", "y"].map(|axis| item(axis, ItemKind::Keyword, "it changes its sign")).into()
            }
            [] if matches!(self.before.last().map(|token| token.kind), Some(TokenKind::Close)) => {
                let clauses = [("at", "at (0, 0)"), ("turned", "turned 10 deg"), ("mirrored", "mirrored x")];
                let missing = clauses.into_iter().filter(|(word, _)| !self.has(word));
                missing
                    .map(|(word, form)| Item { insert: Some(form.into()), ..item(word, ItemKind::Keyword, form) })
                    .collect()
            }
            [_] if matches!(last, "(" | ",") => self.arguments(),
            [_] if last == "=" && self.is_port_argument() => self.ends(),
            _ => self.expression(),
        }
    }

    /// The value of a `param`, and the clauses that may follow it.
    fn tolerance(&self) -> Vec<Item> {
        let clauses: &[(&str, &str)] = match (self.has("within"), self.has("spread")) {
            _ if self.last(1) == "spread" => {
                &[("uniform", "over the range"), ("lognormal", "deviation of the logarithm")]
            }
            _ if !self.is_after_operand() => &[],
            (true, _) => &[],
            (false, true) => &[("within", "a tolerance")],
            (false, false) => &[("within", "a tolerance"), ("spread", "a random distribution")],
        };
        let clauses = clauses.iter().map(|(word, meaning)| item(word, ItemKind::Keyword, *meaning));
        clauses.chain(self.expression()).collect()
    }

    /// The components that the file knows.
    fn components(&self) -> Vec<Item> {
        let known = self.project.components(0).into_iter().filter_map(|at| {
            let lexed = self.project.lexed_text(at.file);
            let statement = lexed.statement_of(at.token)?;
            let detail = lexed.doc(statement).lines().next().unwrap_or_default().to_string();
            let word = lexed.token_text(at.token);
            Some(Item { insert: Some(format!("{word}(")), ..item(word, ItemKind::Function, detail) })
        });
        known.collect()
    }

    /// The parameters and ports that are not given yet.
    fn arguments(&self) -> Vec<Item> {
        let missing = signature::missing_arguments(self.document, self.project, self.statement).into_iter();
        let item = |(at, form): (At, String)| {
            let word = self.project.lexed_text(at.file).token_text(at.token);
            Item { insert: Some(format!("{word} = ")), ..item(word, ItemKind::Field, form) }
        };
        missing.map(item).collect()
    }

    fn is_port_argument(&self) -> bool {
        let Some(component) = self.project.placed_component(0, self.statement) else { return false };
        let word = self.last(2);
        let lexed = self.project.lexed_text(component.0);
        self.project.formals(component).iter().any(|formal| formal.is_port && lexed.token_text(formal.name) == word)
    }

    /// After `@`: points, and places that have some.
    fn spots(&self) -> Vec<Item> {
        let mut items = self.values(|kind| kind == "point");
        items.extend(self.names(Space::Places, ItemKind::Part, |_| true));
        items
    }

    /// The items after `front.`: in an expression its parameters, points and `let`s; in an end and in a measure parts
    /// and outputs; after `@` points; and in each of them the nested places. `None` if the word before the dot is not a
    /// place.
    fn members(&self) -> Option<Vec<Item>> {
        let document = self.document;
        let start = document.range_of(self.statement).start;
        let dot = start + self.before.last()?.range.start;
        let token = document.tokens.partition_point(|token| token.range.start < dot);
        let mut name = token.checked_sub(1)?;
        if document.token_text(name) == "]" {
            let open = (0..name).rev().find(|at| document.token_text(*at) == "[")?;
            name = open.checked_sub(1)?;
        }
        let component = self.project.component_before(At { file: 0, token: name })?;
        let first = *document.chain(name)?.first()?;
        let before = first.checked_sub(1).map_or("", |token| document.token_text(token));
        let keyword = self.keyword();
        let in_end = has_ends(keyword) && !self.has("=") && !self.has("{");
        let in_measure = before == "("
            && first.checked_sub(2).is_some_and(|function| roles::takes_part(document.token_text(function)));
        let (values, parts): (Wanted, Wanted) = match before {
            "@" => (|kind| kind == "point", |_| false),
            _ if in_end => (|_| false, |kind| matches!(kind, "body" | "base")),
            _ if keyword == "initial" => (|_| false, |kind| kind == "body"),
            _ if in_measure || before == "->" => (|_| false, |kind| kind != "component"),
            _ if keyword == "solve" && first == document.outline.statements[self.statement].tokens.start + 1 => {
                (|kind| kind == "component", |_| false)
            }
            // In an expression, a part may be followed by a motion.
            _ => (|_| true, |kind| !matches!(kind, "output" | "component")),
        };
        let of = |space, kind, wanted: Wanted| self.names_of(component.0, Some(component.1), space, kind, wanted);
        let mut items = of(Space::Values, ItemKind::Value, values);
        items.extend(of(Space::Parts, ItemKind::Part, parts));
        items.extend(of(Space::Places, ItemKind::Part, |_| true));
        Some(items)
    }

    fn has(&self, sign: &str) -> bool {
        (0..self.before.len()).any(|token| self.text(token) == sign)
    }

    /// Proposals after the first word.
    fn after_keyword(&self) -> Vec<Item> {
        let word = |word: &&str| item(word, ItemKind::Keyword, "");
        let pieces = self.written_declaration().map_or(&[][..], |declaration| declaration.pieces);
        match pieces {
            [Piece::Apart, ..] => self.expression(),
            [_, Piece::OneOf(words, ..), ..] => words.iter().map(word).collect(),
            [_, Piece::Marker(..), ..] => {
                let words = pieces.iter().filter_map(|piece| match piece {
                    Piece::Marker(word, _) => Some(*word),
                    _ => None,
                });
                vec![word(&&*words.collect::<Vec<_>>().join(" "))]
            }
            [_, Piece::Path(Naming::Of(Space::Parts), _), ..] => self.parts(|keyword| keyword == "body"),
            [_, Piece::Path(Naming::Of(Space::Values), _), ..] => self.values(|kind| kind == "param"),
            // A new name.
            _ => Vec::new(),
        }
    }

    /// `along` and `=` after the ends of a force.
    fn clauses(&self) -> Vec<Item> {
        match self.written_declaration().is_some_and(Declaration::has_along) {
            true => vec![item("along", ItemKind::Keyword, "a fixed direction")],
            false => Vec::new(),
        }
    }

    /// Fields that are not given yet, or the value of the current field.
    fn in_braces(&self) -> Vec<Item> {
        let last = self.last(1);
        let line_ended = self.before.last().is_some_and(|token| token.kind == TokenKind::LineEnd);
        if matches!(last, "{" | ",") || line_ended && !matches!(last, "=" | "+" | "-" | "*" | "/") {
            return self.fields();
        }
        match self
            .written_declaration()
            .and_then(|declaration| declaration.field(self.field()))
            .map(|field| field.takes)
        {
            Some(Takes::Motions | Takes::Direction) => directions(),
            Some(Takes::Shape) if last == "=" => functions(FunctionKind::Shape),
            Some(Takes::Position) => self.values(|kind| kind == "point"),
            Some(Takes::Law(word)) => {
                let variable = item(word, ItemKind::Keyword, "what the law is over");
                std::iter::once(variable).chain(self.expression()).collect()
            }
            _ => self.expression(),
        }
    }

    fn fields(&self) -> Vec<Item> {
        let tokens = self.document.outline.statements[self.statement].tokens.clone();
        let given: Vec<&str> = tokens
            .filter(|token| matches!(self.document.roles[*token], Role::Field | Role::Word))
            .map(|token| self.document.token_text(token))
            .collect();
        let all = self.written_declaration().map_or(&[][..], |declaration| declaration.fields).iter();
        let missing = all.filter(|field| !given.contains(&field.name));
        missing
            .map(|field| Item {
                insert: Some(field.example.into()),
                ..item(field.name, ItemKind::Field, field.meaning)
            })
            .collect()
    }

    /// The field whose value is being typed.
    fn field(&self) -> &'a str {
        let word = |token: &usize| self.before[*token].kind == TokenKind::Word;
        let starts = |token: &usize| {
            let before = token.checked_sub(1).map_or("", |token| self.text(token));
            matches!(before, "{" | "," | "\n")
        };
        (0..self.before.len()).rev().filter(word).find(starts).map_or("", |token| self.text(token))
    }

    /// The dimensions that the current number may have, as far as its position determines them; empty if any is
    /// possible.
    fn dimensions(&self) -> Vec<Dimension> {
        let Some(declaration) = self.written_declaration() else { return Vec::new() };
        match self.corner() {
            Some((_, 0)) => return vec![Dimension::FREQUENCY],
            Some((_, _)) => return vec![Dimension::ACCELERATION, Dimension::VELOCITY, Dimension::LENGTH],
            None => {}
        }
        if let Some((function, argument)) = self.argument() {
            return of_argument(declaration, function, argument).into_iter().collect();
        }
        if self.open.first().is_some_and(|(bracket, _)| *bracket == "{") {
            return declaration.field(self.field()).map_or(Vec::new(), |field| of_field(field.takes));
        }
        if self.open.iter().any(|(_, before)| before.is_some_and(|token| self.text(token) == "@")) {
            return vec![Dimension::LENGTH];
        }
        declaration
            .contents()
            .filter_map(|content| match content {
                Content::Number(dimension) => Some(dimension),
                _ => None,
            })
            .collect()
    }

    /// The function whose argument is being typed, and the index of the argument.
    fn argument(&self) -> Option<(&'a str, usize)> {
        let (index, function) = self.open.iter().enumerate().rev().find_map(|(index, (bracket, before))| {
            let before = before.filter(|token| self.before[*token].kind == TokenKind::Word && *token > 0);
            (*bracket == "(").then_some(())?;
            Some((index, before?))
        })?;
        (index + 1 == self.open.len()).then_some(())?;
        let commas = (function..self.before.len()).filter(|token| self.text(*token) == ",").count();
        Some((self.text(function), commas))
    }

    /// The function whose corner point is being typed, and whether it is its frequency (0) or its value.
    fn corner(&self) -> Option<(&'a str, usize)> {
        let [.., ("(", Some(function)), ("(", Some(before))] = self.open[..] else { return None };
        let function = (self.before[function].kind == TokenKind::Word).then(|| self.text(function))?;
        let has_corners = matches!(function, "noise" | "spectrum") && self.before[before].kind != TokenKind::Word;
        let commas = (before + 1..self.before.len()).filter(|token| self.text(*token) == ",").count();
        has_corners.then_some((function, commas))
    }

    fn units(&self) -> Vec<Item> {
        let item = |text: &&str| item(text, ItemKind::Unit, pages::unit(text).unwrap_or_default());
        if let Some(units) = self.units_of_density() {
            return units;
        }
        let wanted = self.dimensions();
        let Some((first, others)) = wanted.split_first() else { return pages::units(None).iter().map(item).collect() };
        let mut units = pages::units(Some(*first));
        for other in others {
            // Quantities of rotations are written per angle, even if another quantity has the same dimension.
            let all = pages::units(Some(*other));
            let per_angle = |unit: &&&str| unit.contains("/rad") || unit.contains("/deg");
            let any = all.iter().any(|unit| per_angle(&unit));
            units.extend(all.iter().filter(|unit| !any || per_angle(unit)));
        }
        units.iter().map(item).collect()
    }

    /// The units of a density in `noise(`: those of the examples, of which a base has one for each derivative.
    fn units_of_density(&self) -> Option<Vec<Item>> {
        let is_density = |function: &str, place: usize| {
            let arguments = functions::function(function).map(|(_, function)| function.arguments);
            arguments.and_then(|arguments| arguments.get(place)) == Some(&Argument::Densities)
        };
        let is_meant = match (self.corner(), self.argument()) {
            (Some((function, place)), _) => place > 0 && is_density(function, 0),
            (None, Some((function, place))) => is_density(function, place),
            (None, None) => false,
        };
        if !is_meant {
            return None;
        }
        let own = self.written_declaration()?.signal()?;
        let signals = match *own == functions::DISPLACEMENT_SIGNAL {
            true if self.has("turns") => &functions::ROTATION_SIGNALS[..],
            true => &functions::TRANSLATION_SIGNALS,
            false => std::slice::from_ref(own),
        };
        let unit = |signal: &functions::SignalKind| {
            let (_, unit) = signal.density.example.split_once(' ')?;
            Some(item(unit, ItemKind::Unit, signal.density.noun))
        };
        Some(signals.iter().filter_map(unit).collect())
    }

    fn motions(&self) -> Vec<Item> {
        // `body.`, `body[1].`, `body@A.`
        let before = self.document.tokens.iter().position(|token| {
            let start = self.document.range_of(self.statement).start;
            self.before.last().is_some_and(|dot| token.range.start == start + dot.range.start)
        });
        let part = before.and_then(|dot| {
            let mut token = dot;
            while let Some(previous) = token.checked_sub(1) {
                token = previous;
                let meaning = self.project.meaning(At { file: 0, token });
                if meaning.is_some_and(|meaning| meaning.space == Space::Parts) {
                    return Some(token);
                }
                if matches!(self.document.tokens[token].kind, TokenKind::LineEnd) {
                    return None;
                }
            }
            None
        });
        let declared = part.and_then(|part| self.declaration(part));
        let of_body = BODY_MOTIONS.iter().map(|motion| (motion.name, motion.meaning));
        let of_element = ELEMENT_MOTIONS.iter().map(|(_, name, meaning)| (*name, *meaning));
        let of_joint = JOINT_REACTIONS.iter().map(|(_, name, meaning)| (*name, *meaning));
        let of_couple = COUPLE_REACTIONS.iter().map(|(_, name, meaning)| (*name, *meaning));
        let of_support = SUPPORT_REACTIONS.iter().map(|(_, name, meaning)| (*name, *meaning));
        let list: Vec<(&str, &str)> = match declared {
            Some((lexed, statement)) => match lexed.keyword(statement) {
                keyword if is_element(keyword) => of_element.collect(),
                keyword if joint(keyword).is_some() => {
                    let turns = joint(keyword).is_some_and(|joint| joint.kind().turns);
                    of_joint.filter(|(name, _)| *name != "moment" || !turns).collect()
                }
                "couple" => of_couple.collect(),
                // Its components, as inputs.
                "unbalance" => of_body.filter(|(name, _)| matches!(*name, "x" | "y")).collect(),
                _ => {
                    let moves = of_body.filter(|(name, _)| can_move(lexed, statement, name));
                    moves.chain(of_support.filter(|(name, _)| is_guided(lexed, statement, name))).collect()
                }
            },
            None => of_body.chain(of_element).chain(of_joint).chain(of_support).collect(),
        };
        list.iter().map(|(name, meaning)| item(name, ItemKind::Motion, *meaning)).collect()
    }

    /// The file and the statement of the declaration of a part.
    fn declaration(&self, part: usize) -> Option<(&'a Lexed, usize)> {
        let at = names::declarations(self.project, At { file: 0, token: part }).into_iter().next()?;
        let lexed = self.project.lexed_text(at.file);
        Some((lexed, lexed.statement_of(at.token)?))
    }

    fn ends(&self) -> Vec<Item> {
        // Ports are declared in the head of their component.
        let mut items = self.parts(|keyword| matches!(keyword, "body" | "base" | "component"));
        items.extend(self.names(Space::Places, ItemKind::Part, |_| true));
        items.push(item("ground", ItemKind::Part, "the support that never moves"));
        items
    }

    fn parts(&self, wanted: impl Fn(&str) -> bool) -> Vec<Item> {
        self.names(Space::Parts, ItemKind::Part, wanted)
    }

    /// Parameters, points and derived values, by their keyword; and the indices of the enclosing `repeat`s.
    fn values(&self, wanted: impl Fn(&str) -> bool) -> Vec<Item> {
        self.names(Space::Values, ItemKind::Value, wanted)
    }

    /// The names that are known in the statement: those of its component, or those of the scene.
    fn names(&self, space: Space, kind: ItemKind, wanted: impl Fn(&str) -> bool) -> Vec<Item> {
        self.names_of(0, self.document.component_around(self.statement), space, kind, wanted)
    }

    fn names_of(
        &self,
        file: usize,
        scope: Option<usize>,
        space: Space,
        kind: ItemKind,
        wanted: impl Fn(&str) -> bool,
    ) -> Vec<Item> {
        let lexed = self.project.lexed_text(file);
        let mut items = Vec::new();
        for token in names::declared_names(lexed, space, scope) {
            let Some(statement) = lexed.statement_of(token) else { continue };
            let is_own = file == 0 && statement == self.statement;
            if is_own || !wanted(lexed.keyword(statement)) {
                continue;
            }
            let line = match lexed.keyword(statement) {
                // A port or a parameter.
                "component" => lexed.line_of(token).trim_start(),
                _ => lexed.text()[lexed.range_of(statement)].lines().next().unwrap_or_default(),
            };
            items.push(item(lexed.token_text(token), kind, line));
        }
        items
    }

    fn indices(&self) -> Vec<Item> {
        let repeats = |statement: &usize| self.document.keyword(*statement) == "repeat";
        let index = |repeat: usize| {
            let token = self.document.outline.statements[repeat].tokens.start + 1;
            item(self.document.token_text(token), ItemKind::Value, "index")
        };
        self.document.outline.enclosing(self.statement).filter(repeats).map(index).collect()
    }

    /// Whether a whole operand precedes the place: an operator or the end of the line may follow, but no name.
    fn is_after_operand(&self) -> bool {
        let Some(last) = (0..self.before.len()).rev().find(|at| self.before[*at].kind != TokenKind::LineEnd) else {
            return false;
        };
        match self.before[last].kind {
            TokenKind::Word => last > 0 && !LEADS_ON.contains(&self.text(last)),
            TokenKind::Number { .. } | TokenKind::Close => true,
            _ => false,
        }
    }

    /// Names, functions and other elements of an expression in this declaration.
    fn expression(&self) -> Vec<Item> {
        if self.is_after_operand() {
            return Vec::new();
        }
        let mut items = self.indices();
        let asked = self.argument().filter(|(_, argument)| *argument == 0);
        let asked = asked.and_then(|(function, _)| functions::function(function)?.1.arguments.first());
        if let Some(Argument::Path | Argument::Output | Argument::Input) = asked {
            let asks_input = asked != Some(&Argument::Output) && self.last(1) != "->";
            return self.parts(|keyword| {
                let is_input = kinds::declaration(keyword).is_some_and(|declaration| declaration.signal().is_some());
                is_input == asks_input
            });
        }
        if asked == Some(&Argument::Table) && self.last(1) == "(" {
            return functions(FunctionKind::Signal).into_iter().filter(|item| item.label == "table").collect();
        }
        if asked == Some(&Argument::Densities) && self.last(1) == "(" {
            items.extend(densities());
        }
        let outside = self.open.is_empty();
        let contents = |content| {
            self.written_declaration().is_some_and(|declaration| declaration.contents().any(|c| c == content))
        };
        if outside && contents(Content::Motions) {
            items.extend(self.parts(|keyword| matches!(keyword, "body" | "base") || is_element(keyword)));
        }
        items.extend(self.values(|_| true));
        items.extend(self.names(Space::Places, ItemKind::Part, |_| true));
        if outside && self.written_declaration().is_some_and(|declaration| declaration.signal().is_some()) {
            items.splice(0..0, functions(FunctionKind::Signal));
        }
        if outside && contents(Content::Measures) {
            items.splice(0..0, functions(FunctionKind::Measure));
        }
        items.extend(functions(FunctionKind::Number));
        items.push(item("pi", ItemKind::Value, "the circle constant"));
        items
    }
}

/// Whether the ground may exert this reaction on a body: it needs a freedom clause that excludes the motion.
fn is_guided(lexed: &Lexed, statement: usize, reaction: &str) -> bool {
    let motion = match reaction {
        "support_x" => "x",
        "support_y" => "y",
        _ => "angle",
    };
    let words = freedom_words(lexed, statement);
    let has = |word: &str| words.contains(&word);
    match () {
        () if has("free") || !has("moves") && !has("turns") => false,
        () if has("along") => motion != "angle" || !has("turns"),
        () => !can_move(lexed, statement, motion),
    }
}

/// Whether a body can move in this way: a freedom clause allows only its own motions; without one, any is allowed.
fn can_move(lexed: &Lexed, statement: usize, motion: &str) -> bool {
    let words = freedom_words(lexed, statement);
    let has = |word: &str| words.contains(&word);
    if !has("moves") && !has("turns") || has("free") || has("along") {
        return true;
    }
    match motion {
        "x" | "vx" | "ax" => has("x"),
        "y" | "vy" | "ay" => has("y"),
        _ => has("turns"),
    }
}

/// Words after which an expression starts.
const LEADS_ON: [&str; 8] = ["in", "along", "about", "modal", "over", "while", "within", "spread"];

fn directions() -> Vec<Item> {
    let direction = |word: &str| item(word, ItemKind::Keyword, "a direction");
    vec![direction("x"), direction("y"), Item { insert: Some("along (1, 1)".into()), ..direction("along") }]
}

fn is_element(keyword: &str) -> bool {
    kinds::declaration(keyword).is_some_and(Declaration::is_element)
}

/// The kind of joint that a keyword declares.
fn joint(keyword: &str) -> Option<kinds::JointId> {
    match kinds::declaration(keyword)?.shape {
        kinds::Shape::Joint(joint) => Some(joint),
        _ => None,
    }
}

/// What `noise(` may begin with, apart from a density.
fn densities() -> Vec<Item> {
    let form = |label: &str, insert: &str| {
        let meaning = pages::word(label).unwrap_or_default();
        Item { insert: Some(insert.into()), ..item(label, ItemKind::Keyword, meaning) }
    };
    vec![form("white", "white "), form("table", "table("), form("road", "road(")]
}

fn functions(kind: FunctionKind) -> Vec<Item> {
    let own = functions::functions().filter(|(of, _)| *of == kind);
    own.map(|(_, Function { name, form, meaning, .. })| {
        let insert = if form.contains('(') { format!("{name}(") } else { (*name).into() };
        Item { insert: Some(insert), ..item(name, ItemKind::Function, format!("{form}: {meaning}")) }
    })
    .collect()
}

fn of_field(takes: Takes) -> Vec<Dimension> {
    match takes {
        Takes::Number(expected) => vec![expected.dimension],
        Takes::Either { line, turn } => vec![line.dimension, turn.dimension],
        Takes::Position | Takes::Shape => vec![Dimension::LENGTH],
        Takes::Direction | Takes::Motions | Takes::Nothing | Takes::Law(_) => Vec::new(),
    }
}

/// The dimension of an argument of a function.
fn of_argument(declaration: &Declaration, function: &str, argument: usize) -> Option<Dimension> {
    let (_, function) = functions::function(function)?;
    match function.arguments.get(argument)? {
        Argument::Number(dimension) => Some(*dimension),
        Argument::Frequency | Argument::Frequencies => Some(Dimension::FREQUENCY),
        Argument::Position => Some(Dimension::LENGTH),
        Argument::Amplitude => declaration.signal().map(|signal| signal.amplitude.dimension),
        Argument::Impulse => declaration.signal().map(|signal| signal.impulse.dimension),
        Argument::Time | Argument::LaterTime => Some(Dimension::TIME),
        Argument::Densities => declaration.signal().map(|signal| signal.density.dimension),
        Argument::Any
        | Argument::Cause
        | Argument::File
        | Argument::Table
        | Argument::Mode
        | Argument::Output
        | Argument::Path
        | Argument::Input => None,
    }
}

/// The words and directions of a declaration, among them those of its freedom clauses.
fn freedom_words(lexed: &Lexed, statement: usize) -> Vec<&str> {
    let tokens = lexed.outline.statements[statement].tokens.clone();
    let words = tokens.filter(|token| matches!(lexed.roles[*token], Role::Word | Role::Direction));
    words.map(|token| lexed.token_text(token)).collect()
}
