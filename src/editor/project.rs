//! The files in which a name may be declared and used: the text of the request, the files of components that it uses,
//! and all other open files with the files that they use. See spec.md#components-of-other-files.

use super::lexed::Lexed;
use super::roles::{Role, Space};
use super::tokens::TokenKind;
use crate::base::FileId;
use crate::library;
use std::collections::HashMap;

/// A file among others.
#[derive(Debug)]
pub struct ProjectFile<'a> {
    /// Identifies the file, whatever path leads to it.
    pub key: String,
    pub lexed: &'a Lexed,
    /// Its number among the texts of the requested document; `None` if that document does not use it.
    pub id: Option<FileId>,
    /// The files that it uses, in order, by their place among the files.
    pub uses: Vec<usize>,
}

impl ProjectFile<'_> {
    /// Whether the file comes with the program.
    pub fn is_of_program(&self) -> bool {
        self.key.starts_with(library::PREFIX)
    }
}

/// Files that refer to each other; the one of the request is the first.
#[derive(Debug)]
pub struct Project<'a> {
    pub files: Vec<ProjectFile<'a>>,
    declared: Vec<Declared<'a>>,
}

/// The declarations of a file, by word, for each name space and each `repeat` or component in which a name is known.
type Declared<'a> = HashMap<(Space, Option<usize>), HashMap<&'a str, Vec<usize>>>;

/// A token of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct At {
    pub file: usize,
    pub token: usize,
}

/// The declaration that a word refers to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Meaning<'a> {
    /// The file that declares it.
    pub file: usize,
    /// The `repeat` whose index it is, or the component that declares it.
    pub scope: Option<usize>,
    pub space: Space,
    pub word: &'a str,
}

impl<'a> Project<'a> {
    pub fn new(files: Vec<ProjectFile<'a>>) -> Project<'a> {
        let declared = files.iter().map(|file| declared_names(file.lexed)).collect();
        Project { files, declared }
    }

    /// A project of a single file.
    pub fn of(lexed: &'a Lexed) -> Project<'a> {
        Project::new(vec![ProjectFile { key: String::new(), lexed, id: None, uses: Vec::new() }])
    }

    pub fn lexed_text(&self, file: usize) -> &'a Lexed {
        self.files[file].lexed
    }

    /// The tokens that declare a name.
    pub fn declarations(&self, meaning: &Meaning) -> &[usize] {
        let Meaning { file, scope, space, word } = *meaning;
        let words = self.declared[file].get(&(space, scope));
        words.and_then(|words| words.get(word)).map_or(&[], Vec::as_slice)
    }

    pub fn is_declared(&self, meaning: &Meaning) -> bool {
        !self.declarations(meaning).is_empty()
    }

    /// The meaning of the name at a token; `None` if it is not a name, or a member of something unknown.
    pub fn meaning(&self, at: At) -> Option<Meaning<'a>> {
        let lexed = self.lexed_text(at.file);
        let word = lexed.token_text(at.token);
        match lexed.roles[at.token] {
            Role::Declaration { space, scope } => Some(Meaning { file: at.file, scope, space, word }),
            Role::Reference { space: Space::Components, .. } => self.component(at.file, word),
            Role::Reference { space: Space::Values, scope } if self.is_port_argument(at) => {
                Some(Meaning { file: at.file, scope, space: Space::Parts, word })
            }
            Role::Reference { space, scope } => {
                // The name of a place belongs to both spaces.
                let place = Meaning { file: at.file, scope, space: Space::Places, word };
                Some(if self.is_declared(&place) { place } else { Meaning { space, ..place } })
            }
            Role::Member => self.member(at),
            Role::Field => self.argument(at),
            _ => None,
        }
    }

    /// The component that a word names in a file: one of its own, or of a file that it uses.
    pub fn component(&self, file: usize, word: &'a str) -> Option<Meaning<'a>> {
        let of = |file| Meaning { file, scope: None, space: Space::Components, word };
        let files = std::iter::once(file).chain(self.files[file].uses.iter().copied());
        files.map(of).find(|meaning| self.is_declared(meaning))
    }

    /// The components that a file knows, its own ones first.
    pub fn components(&self, file: usize) -> Vec<At> {
        let files = std::iter::once(file).chain(self.files[file].uses.iter().copied());
        let mut known: Vec<At> = Vec::new();
        for file in files {
            let lexed = self.lexed_text(file);
            let own = Role::Declaration { space: Space::Components, scope: None };
            known.extend((0..lexed.tokens.len()).filter(|t| lexed.roles[*t] == own).map(|token| At { file, token }));
        }
        known
    }

    /// File and statement of a component.
    pub fn body_of(&self, component: &Meaning) -> Option<(usize, usize)> {
        let token = *self.declarations(component).first()?;
        Some((component.file, self.lexed_text(component.file).statement_of(token)?))
    }

    /// File and statement of the component that a `place` names.
    pub fn placed_component(&self, file: usize, statement: usize) -> Option<(usize, usize)> {
        let lexed = self.lexed_text(file);
        let names = |token: &usize| matches!(lexed.roles[*token], Role::Reference { space: Space::Components, .. });
        let token = lexed.outline.statements[statement].tokens.clone().find(names)?;
        self.body_of(&self.component(file, lexed.token_text(token))?)
    }

    /// File and statement of the component at the place of a name.
    pub fn component_at(&self, place: &Meaning) -> Option<(usize, usize)> {
        let token = *self.declarations(place).first().filter(|_| place.space == Space::Places)?;
        self.placed_component(place.file, self.lexed_text(place.file).statement_of(token)?)
    }

    /// The component at the place that the names before a `.` refer to, given the last of these names.
    pub fn component_before(&self, at: At) -> Option<(usize, usize)> {
        let chain = self.lexed_text(at.file).chain(at.token)?;
        let (first, others) = chain.split_first()?;
        // The first one has no chain of its own.
        let mut component = self.component_at(&self.meaning(At { token: *first, ..at })?)?;
        for token in others {
            let word = self.lexed_text(at.file).token_text(*token);
            component = self.component_at(&self.resolve_inside(component, Space::Places, word))?;
        }
        Some(component)
    }

    fn resolve_inside<'b>(&self, component: (usize, usize), space: Space, word: &'b str) -> Meaning<'b> {
        Meaning { file: component.0, scope: Some(component.1), space, word }
    }

    /// `wheel` in `front.wheel`: a name of the component at that place.
    fn member(&self, at: At) -> Option<Meaning<'a>> {
        let lexed = self.lexed_text(at.file);
        let chain = lexed.chain(at.token)?;
        let before = chain[..chain.len() - 1].last().copied()?;
        let component = self.component_before(At { token: before, ..at })?;
        let (first, second) = match self.wants_part(at.file, at.token, chain[0]) {
            true => (Space::Parts, Space::Values),
            false => (Space::Values, Space::Parts),
        };
        let spaces = [Space::Places, first, second].into_iter();
        let word = lexed.token_text(at.token);
        spaces.map(|space| self.resolve_inside(component, space, word)).find(|meaning| self.is_declared(meaning))
    }

    /// Whether a member refers to a part or an output if there is also a value with its name: before a further `.`, `@`
    /// or `->`, in an end, and in a measure, but not after `@`.
    fn wants_part(&self, file: usize, member: usize, first: usize) -> bool {
        let lexed = self.lexed_text(file);
        let is = |token: Option<usize>, signs: &[&str]| token.is_some_and(|t| signs.contains(&lexed.token_text(t)));
        let before = first.checked_sub(1);
        if is(before, &["@"]) {
            return false;
        }
        if is(lexed.after_indices(member), &[".", "@", "->"]) || is(before, &["->", ":", "--"]) {
            return true;
        }
        if self.is_port_argument(At { file, token: first }) {
            return true;
        }
        let keyword = lexed.statement_of(first).map_or("", |statement| lexed.keyword(statement));
        let in_measure = is(before, &["("])
            && before.and_then(|open| open.checked_sub(1)).is_some_and(|function| {
                lexed.roles[function] == Role::Function && super::roles::takes_part(lexed.token_text(function))
            });
        keyword == "initial" || in_measure
    }

    /// `m` in `place front = axle(m = 40 kg)`: a parameter or port of the component.
    fn argument(&self, at: At) -> Option<Meaning<'a>> {
        let lexed = self.lexed_text(at.file);
        let statement = lexed.statement_of(at.token).filter(|statement| lexed.keyword(*statement) == "place")?;
        let component = self.placed_component(at.file, statement)?;
        let head = &self.lexed_text(component.0).outline.statements[component.1].tokens;
        let word = lexed.token_text(at.token);
        let spaces = [Space::Values, Space::Parts].into_iter();
        let formal = |meaning: &Meaning| self.declarations(meaning).iter().any(|token| head.contains(token));
        spaces.map(|space| self.resolve_inside(component, space, word)).find(formal)
    }

    /// Whether a word is the value that a `place` gives a port: `upper = chassis`.
    fn is_port_argument(&self, at: At) -> bool {
        let lexed = self.lexed_text(at.file);
        let field = at.token.checked_sub(2).filter(|_| lexed.token_text(at.token - 1) == "=");
        let field = field.filter(|token| lexed.roles[*token] == Role::Field);
        let meaning = field.and_then(|token| self.argument(At { token, ..at }));
        meaning.is_some_and(|meaning| meaning.space == Space::Parts)
    }

    /// The ports and parameters in the brackets of a component, in order.
    pub fn formals(&self, component: (usize, usize)) -> Vec<Formal> {
        let lexed = self.lexed_text(component.0);
        let head = lexed.outline.statements[component.1].tokens.clone();
        let is_gap = |token: usize| matches!(lexed.tokens[token].kind, TokenKind::LineEnd | TokenKind::Comment);
        let mut formals: Vec<Formal> = Vec::new();
        let (mut depth, mut first) = (0_usize, None);
        for token in head.filter(|token| !is_gap(*token)) {
            let text = lexed.token_text(token);
            let ends = depth == 1 && matches!(text, "," | ")");
            if let Some(first) = first.filter(|_| ends) {
                formals.extend(formal(lexed, first..token));
            }
            match lexed.tokens[token].kind {
                TokenKind::Open => depth += 1,
                TokenKind::Close => depth = depth.saturating_sub(1),
                _ => {}
            }
            if ends || depth == 1 && text == "(" {
                first = None;
            } else if first.is_none() && depth > 0 {
                first = Some(token);
            }
        }
        formals
    }

    /// Whether a word is used as a name.
    pub fn is_name(&self, at: At) -> bool {
        self.lexed_text(at.file).tokens[at.token].kind == TokenKind::Word && self.meaning(at).is_some()
    }
}

fn declared_names(lexed: &Lexed) -> Declared<'_> {
    let mut declared = Declared::new();
    for (token, role) in lexed.roles.iter().enumerate() {
        if let Role::Declaration { space, scope } = *role {
            let words = declared.entry((space, scope)).or_default();
            words.entry(lexed.token_text(token)).or_default().push(token);
        }
    }
    declared
}

/// A port or a parameter of a component.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Formal {
    /// The token of its name.
    pub name: usize,
    pub is_port: bool,
    /// `k = 150 kN/m`, as it is written.
    pub range: std::ops::Range<usize>,
}

fn formal(lexed: &Lexed, tokens: std::ops::Range<usize>) -> Option<Formal> {
    let name = tokens.clone().find(|token| matches!(lexed.roles[*token], Role::Declaration { .. }))?;
    let is_port = matches!(lexed.roles[name], Role::Declaration { space: Space::Parts, .. });
    let last =
        tokens.rev().find(|token| !matches!(lexed.tokens[*token].kind, TokenKind::LineEnd | TokenKind::Comment))?;
    Some(Formal {
        name,
        is_port,
        range: lexed.tokens[if is_port { name - 1 } else { name }].range.start..lexed.tokens[last].range.end,
    })
}
