//! The function whose arguments are being typed: its form, what it means, and which argument it is.

use super::document::Document;
use super::tokens::TokenKind;
use crate::kinds::functions::{self, Function};

/// A function at a place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Signature {
    pub function: &'static Function,
    /// From 0.
    pub argument: usize,
}

impl Signature {
    /// The bytes of each argument in the function's form, `step(a, at)`.
    pub fn arguments(&self) -> Vec<std::ops::Range<usize>> {
        let form = self.function.form;
        let (Some(open), Some(close)) = (form.find('('), form.rfind(')')) else { return Vec::new() };
        let mut at = open + 1;
        let mut list = Vec::new();
        for argument in form[open + 1..close].split(',') {
            let start = at + (argument.len() - argument.trim_start().len());
            list.push(start..start + argument.trim().len());
            at += argument.len() + 1;
        }
        list
    }
}

/// The innermost call of a known function that is open at a place.
pub fn signature(document: &Document, offset: usize) -> Option<Signature> {
    let before = document.tokens.partition_point(|token| token.range.end <= offset);
    let (mut depth, mut argument) = (0usize, 0);
    for token in (0..before).rev() {
        match (document.tokens[token].kind, document.token_text(token)) {
            (TokenKind::LineEnd, _) if depth == 0 => return None,
            (TokenKind::Close, _) => depth += 1,
            (TokenKind::Open, "(") if depth == 0 => {
                let name = token.checked_sub(1)?;
                match functions::function(document.token_text(name)) {
                    Some((_, function)) => return Some(Signature { function, argument }),
                    // Brackets of a position or of a sum: what they stand in is called.
                    None => argument = 0,
                }
            }
            (TokenKind::Open, _) if depth == 0 => return None,
            (TokenKind::Open, _) => depth -= 1,
            (TokenKind::Sign, ",") if depth == 0 => argument += 1,
            _ => {}
        }
    }
    None
}
