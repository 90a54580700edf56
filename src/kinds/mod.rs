//! The single table of the language: every declaration with its words, fields and documentation, every function, every
//! motion. See spec.md#text and spec.md.
//!
//! The parser, the check, the editor, the formatter and the word lists of editors read it. A new kind of element is a
//! file in `elements` and its line there; a new joint is a file in `joints`; a signal, measure or shape is a row of
//! [`functions`]. ARCHITECTURE.md lists the other edits that each of them needs.

pub mod declarations;
pub mod functions;
pub mod motions;
pub mod piece;

pub use declarations::{DECLARATIONS, Declaration, Shape};
pub use functions::{Argument, Function, FunctionKind, SignalKind};
pub use piece::{Content, Naming, Piece, Space};

use crate::{elements, joints};
use std::sync::LazyLock;

/// The declaration that starts with this word. Called for every line of a file, so it compares only keywords with the
/// same first letter.
pub fn declaration(word: &str) -> Option<&'static Declaration> {
    let first = word.as_bytes().first()?.wrapping_sub(b'a');
    let mut place = *BY_LETTER.first.get(usize::from(first))?;
    while let Some(declaration) = DECLARATIONS.get(usize::from(place)) {
        if declaration.keyword == word {
            return Some(declaration);
        }
        place = BY_LETTER.next[usize::from(place)];
    }
    None
}

/// Chains of declarations with the same first letter; a chain ends with an index beyond the table.
struct ByLetter {
    /// For each letter, the index of the first declaration.
    first: [u8; 26],
    /// For each declaration, the index of the next one.
    next: [u8; DECLARATIONS.len()],
}

static BY_LETTER: ByLetter = by_letter();

const fn by_letter() -> ByLetter {
    let mut chains = ByLetter { first: [u8::MAX; 26], next: [u8::MAX; DECLARATIONS.len()] };
    let mut place = DECLARATIONS.len();
    while place > 0 {
        place -= 1;
        let letter = (DECLARATIONS[place].keyword.as_bytes()[0] - b'a') as usize;
        chains.next[place] = chains.first[letter];
        chains.first[letter] = place as u8;
    }
    chains
}

/// The field of this name, in any declaration: for texts in which a declaration may have lost its keyword.
pub fn field(name: &str) -> Option<&'static crate::base::Field> {
    DECLARATIONS.iter().find_map(|declaration| declaration.field(name))
}

/// The words that have a meaning of their own: keywords, functions, fields.
pub fn names() -> impl Iterator<Item = &'static str> {
    let keywords = DECLARATIONS.iter().map(|declaration| declaration.keyword);
    let fields = DECLARATIONS.iter().flat_map(|declaration| declaration.fields).map(|field| field.name);
    keywords.chain(functions::functions().map(|(_, function)| function.name)).chain(fields)
}

/// A kind of element: its index in [`elements::KINDS`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ElementId(pub u8);

impl ElementId {
    pub fn kind(self) -> &'static elements::Kind {
        elements::KINDS[usize::from(self.0)]
    }
}

/// A kind of joint: its index in [`joints::KINDS`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JointId(pub u8);

impl JointId {
    pub fn kind(self) -> &'static joints::Kind {
        joints::KINDS[usize::from(self.0)]
    }
}

/// `body, spring or damper`: the things whose motions and quantities a model may use.
pub fn body_or_element() -> &'static str {
    static TEXT: LazyLock<String> = LazyLock::new(|| {
        let elements = elements::KINDS.iter().map(|kind| kind.keyword);
        enumeration(&["body"].into_iter().chain(elements).collect::<Vec<_>>(), "or")
    });
    &TEXT
}

/// `a, b and c`
pub fn enumeration(words: &[impl AsRef<str>], last: &str) -> String {
    let mut text = String::new();
    for (place, word) in words.iter().enumerate() {
        match place {
            0 => {}
            _ if place + 1 == words.len() => text += &format!(" {last} "),
            _ => text += ", ",
        }
        text += word.as_ref();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_word_of_the_table_is_there_once() {
        for (index, declaration) in DECLARATIONS.iter().enumerate() {
            let same = DECLARATIONS.iter().filter(|other| other.keyword == declaration.keyword);
            assert_eq!(same.count(), 1, "{}", declaration.keyword);
            assert!(declaration.form.contains(declaration.keyword), "{}", declaration.form);
            let taken = |word: &&str| {
                DECLARATIONS
                    .iter()
                    .enumerate()
                    .any(|(other, d)| d.keyword == *word || other != index && d.synonyms.contains(word))
            };
            assert_eq!(declaration.synonyms.iter().find(|word| taken(word)), None, "{}", declaration.keyword);
        }
        for (_, function) in functions::functions() {
            let same = functions::functions().filter(|(_, other)| other.name == function.name);
            assert_eq!(same.count(), 1, "{}", function.name);
        }
    }

    #[test]
    fn a_word_is_found_by_its_first_letter() {
        for known in &DECLARATIONS {
            assert_eq!(declaration(known.keyword), Some(known));
        }
        for unknown in ["", "b", "bod", "bodys", "Body", "zebra", "\u{3b1}"] {
            assert_eq!(declaration(unknown), None);
        }
    }

    /// Only the table knows the kind of `elements::dummy`.
    mod a_dummy {
        use crate::base::{FileId, SourceFile, Sources};
        use crate::editor::completion::{self, Item};
        use crate::editor::document::Document;
        use crate::editor::project::Project;
        use crate::editor::roles::{Role, Space};
        use crate::editor::{format, hover};
        use crate::kinds;
        use crate::model::{self, Overrides};
        use crate::{lower, syntax};

        const MODEL: &str = "body a { mass = 2 kg, moves x }\nspring s: ground -- a { k = 8 N/m }\n\
                             gadget g: ground -- a { grip = 4 N*s/m }\noutput f = g.force\n";

        fn sources(text: &str) -> (Sources, FileId) {
            let mut sources = Sources::new();
            let file = sources.add(SourceFile::model("model.vib", text));
            (sources, file)
        }

        /// The messages of the parser and the check, as users read them.
        fn reported_messages(text: &str) -> Vec<String> {
            let (sources, file) = sources(text);
            let parsed = syntax::parse(&sources, file);
            let checked = model::check(&sources, &parsed.tree, &Overrides::default());
            let all = parsed.errors.iter().chain(checked.diagnostics.iter());
            all.map(|d| format!("{} ({})", d.message, d.help.clone().unwrap_or_default())).collect()
        }

        fn with(gadget: &str) -> Vec<String> {
            reported_messages(&MODEL.replace("gadget g: ground -- a { grip = 4 N*s/m }", gadget))
        }

        #[test]
        fn is_parsed_checked_and_lowered_by_its_law() {
            assert_eq!(reported_messages(MODEL), Vec::<String>::new());
            let (sources, file) = sources(MODEL);
            let tree = syntax::parse(&sources, file).tree;
            let scene = model::check(&sources, &tree, &Overrides::default()).scene.expect("a scene");
            let lowered = lower::lower(&scene).lowered.expect("a system");
            let system = &lowered.system;
            assert_eq!(system.c.entries(1)[0][0].to_f64(), 4.0);
            assert_eq!((system.k.terms().len(), system.m.terms().len()), (1, 1));
            let rows = system.outputs[0].p.each_ref().map(Vec::len);
            assert_eq!(rows, [0, 1, 0], "its force is proportional to the rate");
        }

        #[test]
        fn has_the_messages_of_its_kind() {
            for (gadget, expected) in [
                ("gadget g ground -- a", "write it as `gadget g: ground -- block { grip = 4 N*s/m }`"),
                ("gadgte g: ground -- a { }", "did you mean `gadget`?"),
                ("gizmo g ground -- a { }", "did you mean `gadget`?"),
                ("gadget g: ground -- a { }", "a grip is missing here (add `grip = 4 N*s/m`)"),
                ("gadget g: ground -- a { grap = 4 N*s/m }", "did you mean `grip`?"),
                ("gadget g: ground -- a { grip = 4 N/m }", "a grip"),
                ("gadget g: ground -- a { grip = -4 N*s/m }", "grip cannot be negative"),
                ("gadget g: ground -- a { grip = 4 N*m*s/rad }", "a grip along a line is in N*s/m"),
            ] {
                let all = with(gadget);
                assert!(all.iter().any(|message| message.contains(expected)), "{gadget}: {all:#?}");
            }
            let asked = reported_messages(&MODEL.replace("g.force", "g.farce"));
            assert!(asked[0].contains("a gadget"), "{asked:#?}");
            let wrong = reported_messages(&MODEL.replace("-- a { k", "-- g { k"));
            assert!(wrong[0].contains("`g` is a gadget, not a body"), "{wrong:#?}");
            let other = reported_messages("xyzzy g\nbody a { mass = 1 kg, moves x }");
            assert!(other[0].contains("gadget"), "{other:#?}");
        }

        fn labels(text: &str) -> Vec<String> {
            let (before, after) = text.split_once('|').expect("a place");
            let (sources, file) = sources(&format!("{before}{after}"));
            let document = Document::new(sources, file, None);
            completion::items(&document, &Project::of(&document), before.len())
                .into_iter()
                .map(|Item { label, .. }| label)
                .collect()
        }

        #[test]
        fn is_known_to_the_editor() {
            let (sources, file) = sources(MODEL);
            let document = Document::new(sources, file, None);
            let role = |word: &str, role: Role| {
                let at = MODEL.find(word).expect("the word");
                let token = document.token_at(at).expect("a token");
                assert_eq!(document.roles[token], role, "{word}");
            };
            role("gadget", Role::Keyword);
            role("g: ground -- a { grip", Role::Declaration { space: Space::Parts, scope: None });
            role("grip", Role::Field);
            assert!(labels("|").contains(&"gadget".to_string()));
            assert_eq!(labels("gadget g: ground -- a { |"), ["grip", "along"]);
            assert!(labels("body a { moves x }\ngadget g: |").contains(&"a".to_string()));
            assert!(labels("gadget g: ground -- a { grip = 4 N|").contains(&"N*s/m".to_string()));
            assert_eq!(labels(&MODEL.replace("g.force", "g.|")), ["force", "stretch"]);
            let page = hover::hover(&document, &Project::of(&document), MODEL.find("gadget").expect("the word"))
                .expect("a page");
            assert!(page.markdown.contains("stands for the next kind"), "{}", page.markdown);
            let page = hover::hover(&document, &Project::of(&document), MODEL.find("grip").expect("the word"))
                .expect("a page");
            assert!(page.markdown.contains("How much it grips."), "{}", page.markdown);
        }

        #[test]
        fn is_laid_out_like_its_like() {
            let (sources, file) = sources("gadget  g:ground--a{grip=4 N*s/m}");
            let tree = syntax::parse(&sources, file).tree;
            assert_eq!(format::format(sources.text(file), &tree), "gadget g: ground -- a { grip = 4 N*s/m }\n");
        }

        #[test]
        fn has_its_page_in_the_manual() {
            assert!(kinds::declaration("gadget").expect("the kind").page().contains("stands for the next kind"));
            assert!(kinds::body_or_element().ends_with("or gadget"));
        }
    }

    #[test]
    fn lists_read_as_sentences_do() {
        assert_eq!(enumeration(&["a"], "or"), "a");
        assert_eq!(enumeration(&["a", "b"], "or"), "a or b");
        assert_eq!(enumeration(&["a", "b", "c"], "and"), "a, b and c");
    }
}
