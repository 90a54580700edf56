//! What pest recognises in the text of declarations: which rules of the grammar start and end where.
//!
//! In: declarations as `split` cuts them out. Out: their [`Token`]s, of which `build` makes nodes of the tree. Nothing here depends on
//! the declarations before, so long files are read on all cores. See spec.md#keywords.

use super::split::{Piece, Pieces};
use crate::kernel::cores;
use crate::kinds::{self, Shape};
use pest::Parser;
use pest_derive::Parser;
use std::ops::Range;

#[derive(Parser)]
#[grammar = "../grammar/vib.pest"]
struct Grammar;

/// The start of a rule, or the end of the one that started last, and its byte in the text.
pub(super) type Token = (Option<Rule>, u32);

/// The shape of the declaration whose keyword `text` starts with, and its grammar rule.
pub(super) fn rule_of(text: &str) -> Option<(Shape, Rule)> {
    let end = text.bytes().position(|b| !b.is_ascii_lowercase()).unwrap_or(text.len());
    let shape = kinds::declaration(&text[..end])?.shape;
    let rule = match shape {
        Shape::Body => Rule::body,
        Shape::Element(_) => Rule::element,
        Shape::Param => Rule::parameter,
        Shape::Let => Rule::definition,
        Shape::Point => Rule::point,
        Shape::Joint(kind) if kind.kind().slides => Rule::slide,
        Shape::Joint(_) => Rule::joint,
        Shape::Couple => Rule::couple,
        Shape::Base => Rule::base,
        Shape::Force => Rule::force,
        Shape::Torque => Rule::torque,
        Shape::Unbalance => Rule::unbalance,
        Shape::Output => Rule::output,
        Shape::Initial => Rule::initial,
        Shape::Gravity => Rule::gravity,
        Shape::Model => Rule::model,
        Shape::Damping if text[end..].trim_start().starts_with("rayleigh") => Rule::damping_rayleigh,
        Shape::Damping => Rule::damping_modal,
        Shape::Rest => Rule::rest,
        Shape::Solve => Rule::solve,
        Shape::Minimise => Rule::minimise,
        Shape::Maximise => Rule::maximise,
        Shape::Require => Rule::require,
        Shape::Correlate => Rule::correlate,
        Shape::Repeat => Rule::repeat,
        Shape::Component => Rule::component,
        Shape::Place => Rule::place,
        Shape::Use => Rule::import,
    };
    Some((shape, rule))
}

/// Recognises all of `text` as `rule` and appends its tokens; `false` if it does not match.
pub(super) fn recognise(rule: Rule, text: &str, tokens: &mut Vec<Token>) -> bool {
    let Ok(pairs) = Grammar::parse(rule, text) else { return false };
    if pairs.as_str().len() != text.len() {
        return false;
    }
    let found = pairs.tokens();
    tokens.reserve(found.len());
    for token in found {
        tokens.push(match token {
            pest::Token::Start { rule, pos } => (Some(rule), pos.pos() as u32),
            pest::Token::End { pos, .. } => (None, pos.pos() as u32),
        });
    }
    true
}

/// A piece of the text, with what `split` says beside it.
pub(super) struct Cut {
    pub piece: Piece,
    /// The `///` lines before it.
    pub doc: Option<Range<usize>>,
    /// The comments inside it, and possibly one after it.
    pub comments: Vec<Range<usize>>,
}

impl Cut {
    /// Where the piece stands.
    pub fn range(&self) -> Range<usize> {
        match &self.piece {
            Piece::Declaration { range, .. } | Piece::Open { range, .. } | Piece::Character { range } => range.clone(),
            Piece::Close { at } | Piece::Stray { at } => *at..*at + 1,
        }
    }

    /// Its text: a part of the file's, or of `blanked`, to which it is copied with its comments replaced by blanks.
    pub fn text<'t>(&self, file: &'t str, blanked: &'t mut String) -> &'t str {
        let range = self.range();
        let text = &file[range.clone()];
        if !self.comments.iter().any(|comment| comment.start < range.end) {
            return text;
        }
        blank_comments(text, range.start, &self.comments, blanked);
        blanked
    }
}

/// Copies the text of a declaration into `blanked`, with its comments replaced by spaces byte for byte.
fn blank_comments(text: &str, offset: usize, comments: &[Range<usize>], blanked: &mut String) {
    blanked.clear();
    let mut done = 0;
    for comment in comments {
        let start = (comment.start - offset).min(text.len());
        let end = (comment.end - offset).min(text.len());
        blanked.push_str(&text[done..start]);
        blanked.extend(std::iter::repeat_n(' ', end - start));
        done = end;
    }
    blanked.push_str(&text[done..]);
}

/// Bytes of the text that are recognised at a time: tokens take several times the room of their text until the tree is built.
const AT_A_TIME: usize = 1 << 18;

/// Pieces that are worth a thread: they take some milliseconds.
const FOR_A_CORE: usize = 1024;

/// The next pieces of a text, with the tokens of each; no pieces at its end.
pub(super) fn next_pieces(pieces: &mut Pieces<'_>, text: &str) -> (Vec<Cut>, Vec<Recognised>) {
    let until = pieces.at() + AT_A_TIME;
    let mut cuts = Vec::new();
    while pieces.at() < until
        && let Some(piece) = pieces.next()
    {
        // What stands between declarations leaves the lines before the next one as they are.
        let stands_between = matches!(piece, Piece::Character { .. } | Piece::Stray { .. });
        let doc = if stands_between { None } else { pieces.take_doc() };
        cuts.push(Cut { piece, doc, comments: pieces.take_comments() });
    }
    let recognised = cores::in_pieces(&cuts, FOR_A_CORE, 1, |cuts| vec![Recognised::of(cuts, text)]);
    (cuts, recognised)
}

/// What is recognised in neighbouring pieces.
pub(super) struct Recognised {
    tokens: Vec<Token>,
    /// Of each piece, the shape of the declaration that it is, if it is one, and where its tokens are.
    pieces: Vec<(Option<Shape>, Range<usize>)>,
}

/// A declaration, or the head of a `repeat` or `component`, that is in the grammar.
pub(super) struct Declaration<'a> {
    pub shape: Shape,
    pub tokens: &'a [Token],
}

/// Bodies and elements that are recognised together: what pest sets up for each text weighs little then.
const TOGETHER: usize = 16;

impl Recognised {
    fn of(cuts: &[Cut], file: &str) -> Recognised {
        // Dense text has a token for every two or three bytes.
        let bytes =
            cuts.last().map_or(0, |last| last.range().end) - cuts.first().map_or(0, |first| first.range().start);
        let mut found = Recognised { tokens: Vec::with_capacity(bytes / 2), pieces: Vec::with_capacity(cuts.len()) };
        let mut blanked = String::new();
        while let Some(next) = cuts.get(found.pieces.len()) {
            if !found.add_network(&cuts[found.pieces.len()..], file) {
                found.add(next, file, &mut blanked);
            }
        }
        found
    }

    fn add(&mut self, cut: &Cut, file: &str, blanked: &mut String) {
        let start = self.tokens.len();
        let is_whole = matches!(cut.piece, Piece::Declaration { error: None, .. } | Piece::Open { error: None, .. });
        let text = if is_whole { cut.text(file, blanked) } else { "" };
        let shape = rule_of(text).filter(|(_, rule)| recognise(*rule, text, &mut self.tokens)).map(|(shape, _)| shape);
        self.pieces.push((shape, start..self.tokens.len()));
    }

    /// Adds the bodies and elements that the pieces begin with, as far as only blanks stand between them; `false` if that are fewer than
    /// two, or pest finds that they end elsewhere than `split` does.
    fn add_network(&mut self, cuts: &[Cut], file: &str) -> bool {
        let mut members = Vec::new();
        let mut end = None;
        for cut in cuts.iter().take(TOGETHER) {
            let Piece::Declaration { range, error: None } = &cut.piece else { break };
            let follows = |end: usize| file[end..range.start].bytes().all(|b| b.is_ascii_whitespace());
            if !cut.comments.is_empty() || end.is_some_and(|end| !follows(end)) {
                break;
            }
            let Some((shape, rule @ (Rule::body | Rule::element))) = rule_of(&file[range.clone()]) else { break };
            members.push((shape, rule, range));
            end = Some(range.end);
        }
        let ([(.., first), _, ..], Some(end)) = (&members[..], end) else { return false };
        let (start, pieces) = (self.tokens.len(), self.pieces.len());
        if recognise(Rule::network, &file[first.start..end], &mut self.tokens)
            && self.add_members(start, first.start, &members).is_some()
        {
            return true;
        }
        self.tokens.truncate(start);
        self.pieces.truncate(pieces);
        false
    }

    /// Adds the declarations of a network, whose tokens begin at `start` and count from byte `from` of the file; `None` if they are
    /// others than these.
    fn add_members(&mut self, start: usize, from: usize, members: &[(Shape, Rule, &Range<usize>)]) -> Option<()> {
        // The network's own tokens are the first and the last.
        let mut at = start + 1;
        for &(shape, rule, range) in members {
            let (begins, len) = ((range.start - from) as u32, range.len() as u32);
            let own = at;
            if *self.tokens.get(at)? != (Some(rule), begins) {
                return None;
            }
            let mut open = 0_usize;
            loop {
                let (rule, place) = self.tokens.get_mut(at)?;
                *place -= begins;
                open = if rule.is_some() { open + 1 } else { open - 1 };
                at += 1;
                if open == 0 {
                    break;
                }
            }
            if self.tokens[at - 1].1 != len {
                return None;
            }
            self.pieces.push((Some(shape), own..at));
        }
        (at + 1 == self.tokens.len()).then_some(())
    }

    /// What each piece is, in order.
    pub fn declarations(&self) -> impl Iterator<Item = Option<Declaration<'_>>> {
        self.pieces
            .iter()
            .map(|(shape, tokens)| shape.map(|shape| Declaration { shape, tokens: &self.tokens[tokens.clone()] }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each piece of a text alone, as the truth that pieces together must agree with.
    fn one_by_one(cuts: &[Cut], file: &str) -> Recognised {
        let mut found = Recognised { tokens: Vec::new(), pieces: Vec::new() };
        for cut in cuts {
            found.add(cut, file, &mut String::new());
        }
        found
    }

    #[test]
    fn bodies_and_elements_are_the_same_together() {
        let file = "model m\nbody a { mass = 1 kg, moves x }\n\nspring s: ground -- a { k = 2 N/m }\r\nbody b { }\n\
            /// doc\nbody c { mass = 1e3 kg }  // comment\nspring t: a -- b { // inside\n k = 1 N/m }\n\
            body d: a -- b { mass = 1 kg }\nbody e { mass = 1 kg }\nspring u: a --\nspring v: a -- b { k = 1 N/m }\n\
            damper w: a -- e@(0, 1 m) { c = 1 N*s/m }\nbody f { mass = 2 kg }\nbody g\n{ mass = 1 kg }\nbody h { mass = 1 kg }\n\
            repeat i in 1..3 {\n body m[i] { mass = i * 1 kg }\n spring q[i]: m[i] -- m[i-1] { k = 1 N/m }\n}\n";
        let (cuts, together) = next_pieces(&mut Pieces::new(file), file);
        assert_eq!(together.iter().flat_map(told).collect::<Vec<_>>(), told(&one_by_one(&cuts, file)));
        assert!(Recognised::of(&cuts, file).add_network(&cuts[1..], file), "the first three go together");
    }

    fn told(found: &Recognised) -> Vec<Option<Vec<Token>>> {
        found.declarations().map(|found| found.map(|found| found.tokens.to_vec())).collect()
    }

    /// Read in several parts, each on all cores, with a broken declaration now and then.
    #[test]
    fn a_long_text_is_the_same_as_its_declarations() {
        let line = |i: usize| match i % 1000 {
            999 => format!("body b{i} {{ mass = , moves x }}\n"),
            _ => format!(
                "body b{i} {{ mass = {i} kg, moves x }}\nspring s{i}: ground -- b{i} {{ k = 1e{} N/m }}\n",
                i % 7
            ),
        };
        let file: String = (0..8000).map(line).collect();
        assert!(file.len() > 2 * AT_A_TIME);
        let mut pieces = Pieces::new(&file);
        let mut count = 0;
        loop {
            let (cuts, found) = next_pieces(&mut pieces, &file);
            if cuts.is_empty() {
                break;
            }
            count += cuts.len();
            assert_eq!(found.iter().flat_map(told).collect::<Vec<_>>(), told(&one_by_one(&cuts, &file)));
        }
        assert_eq!(count, 2 * 8000 - 8);
    }
}
