//! One declaration's text to nodes of the tree: pest recognises it, this module puts what it found into the arenas.
//!
//! In: the text of one declaration, as `split` cut it out. Out: nodes of the [`Tree`], or nothing and the tree as it was.
//! pest gives operands and operators as they stand; they are put in order of precedence here (Dijkstra's shunting yard,
//! so that the depth of recursion is that of the brackets, which `split` limits). Clause: spec.md 1.3 to 1.6.

use super::limits;
use super::tree::*;
use crate::base::{FileId, Span};
use pest::{Parser, Token, iterators::Tokens};
use pest_derive::Parser;

#[derive(Parser)]
#[grammar = "../grammar/vib.pest"]
struct Grammar;

/// What a text was recognised as.
pub(super) enum Built {
    Decl(Decl),
    Repeat(RepeatHead),
}

/// `repeat i in first..last {`: its declarations follow one by one.
pub(super) struct RepeatHead {
    pub index: Span,
    pub first: ExprId,
    pub last: ExprId,
}

/// Why a declaration is not in the tree.
pub(super) enum Refused {
    /// It is not in the grammar.
    Grammar,
    /// An expression is nested too deep.
    TooDeep(Span),
    /// A word or number is too long.
    TooLong(Span),
}

/// The grammar's rule for the declaration that starts with this word.
fn rule_of(text: &str) -> Option<Rule> {
    let end = text.bytes().position(|b| !b.is_ascii_lowercase()).unwrap_or(text.len());
    Some(match &text[..end] {
        "body" => Rule::body,
        "spring" => Rule::spring,
        "damper" => Rule::damper,
        "param" => Rule::parameter,
        "let" => Rule::definition,
        "point" => Rule::point,
        "pivot" => Rule::pivot,
        "slide" => Rule::slide,
        "weld" => Rule::weld,
        "couple" => Rule::couple,
        "base" => Rule::base,
        "force" => Rule::force,
        "torque" => Rule::torque,
        "output" => Rule::output,
        "initial" => Rule::initial,
        "gravity" => Rule::gravity,
        "model" => Rule::model,
        "damping" if text[end..].trim_start().starts_with("rayleigh") => Rule::damping_rayleigh,
        "damping" => Rule::damping_modal,
        "rest" => Rule::rest,
        "solve" => Rule::solve,
        "require" => Rule::require,
        "repeat" => Rule::repeat,
        _ => return None,
    })
}

/// Parses `text`, which starts at byte `offset` of the file, and appends it to the tree.
pub(super) fn declaration(tree: &mut Tree, yard: &mut Yard, text: &str, offset: usize) -> Result<Built, Refused> {
    let rule = rule_of(text).ok_or(Refused::Grammar)?;
    let pairs = Grammar::parse(rule, text).map_err(|_| Refused::Grammar)?;
    if pairs.as_str().len() != text.len() {
        return Err(Refused::Grammar);
    }
    let mark = tree.mark();
    yard.clear();
    let mut build = Build { file: tree.file, tree, yard, text, offset, tokens: pairs.tokens(), refused: None };
    let built = build.declaration();
    match build.refused {
        None => Ok(built),
        Some(refused) => {
            tree.truncate(mark);
            Err(refused)
        }
    }
}

/// Parses a value that stands alone, as that of `--set NAME=VALUE`. Its brackets have been counted.
pub(super) fn value(tree: &mut Tree, text: &str, offset: usize) -> Result<ExprId, Refused> {
    let pairs = Grammar::parse(Rule::expression, text).map_err(|_| Refused::Grammar)?;
    if pairs.as_str().len() != text.len() {
        return Err(Refused::Grammar);
    }
    let yard = &mut Yard::default();
    let mut build = Build { file: tree.file, tree, yard, text, offset, tokens: pairs.tokens(), refused: None };
    let value = build.expression();
    match build.refused {
        None => Ok(value.id),
        Some(refused) => Err(refused),
    }
}

/// Operands and operators that wait for their turn; kept between declarations for their memory.
#[derive(Default)]
pub(super) struct Yard {
    operands: Vec<Operand>,
    operators: Vec<Operator>,
    items: Vec<ExprId>,
}

impl Yard {
    fn clear(&mut self) {
        self.operands.clear();
        self.operators.clear();
        self.items.clear();
    }
}

#[derive(Clone, Copy)]
struct Operand {
    id: ExprId,
    /// Levels of nodes, this one included.
    depth: u16,
    /// Its place in the declaration's text, with the brackets around it.
    start: u32,
    end: u32,
}

#[derive(Clone, Copy)]
enum Operator {
    /// Unary minus, and where it stands.
    Negate(usize),
    Binary(Binary),
}

impl Operator {
    /// How tightly it binds; an operator waits while those before it bind at least as tightly.
    fn binds(self) -> u8 {
        match self {
            Operator::Negate(_) => 5,
            Operator::Binary(Binary::Power) => 6,
            Operator::Binary(Binary::Multiply | Binary::Divide) => 4,
            Operator::Binary(Binary::Add | Binary::Subtract) => 3,
            Operator::Binary(Binary::Arrow) => 2,
            Operator::Binary(_) => 1,
        }
    }
}

fn binary(text: &str) -> Binary {
    match text {
        "+" => Binary::Add,
        "-" => Binary::Subtract,
        "*" => Binary::Multiply,
        "/" => Binary::Divide,
        "^" => Binary::Power,
        "->" => Binary::Arrow,
        "<" => Binary::Less,
        "<=" => Binary::LessEqual,
        ">" => Binary::Greater,
        ">=" => Binary::GreaterEqual,
        _ => Binary::Equal,
    }
}

/// The walk through pest's tokens. Every method takes the tokens of the rule that it is named after.
struct Build<'a> {
    tree: &'a mut Tree,
    yard: &'a mut Yard,
    file: FileId,
    text: &'a str,
    offset: usize,
    tokens: Tokens<'a, Rule>,
    refused: Option<Refused>,
}

impl Build<'_> {
    /// The rule that starts next; `None` where the rule around it ends.
    fn peek(&self) -> Option<Rule> {
        match self.tokens.clone().next() {
            Some(Token::Start { rule, .. }) => Some(rule),
            _ => None,
        }
    }

    /// Steps over a start or an end; its place in the declaration's text.
    fn step(&mut self) -> usize {
        match self.tokens.next() {
            Some(Token::Start { pos, .. } | Token::End { pos, .. }) => pos.pos(),
            None => self.text.len(),
        }
    }

    /// A rule without rules inside.
    fn leaf(&mut self) -> (usize, usize) {
        (self.step(), self.step())
    }

    fn span(&self, (start, end): (usize, usize)) -> Span {
        Span::new(self.file, self.offset + start, self.offset + end)
    }

    fn refuse(&mut self, refused: Refused) {
        self.refused.get_or_insert(refused);
    }

    fn declaration(&mut self) -> Built {
        let rule = self.peek();
        self.step();
        let kind = match rule {
            Some(Rule::model) => DeclKind::Model { name: self.word() },
            Some(Rule::parameter) => DeclKind::Param { name: self.name(), value: self.expression().id },
            Some(Rule::definition) => DeclKind::Let { name: self.name(), value: self.expression().id },
            Some(Rule::gravity) => DeclKind::Gravity { value: self.expression().id },
            Some(Rule::point) => DeclKind::Point { name: self.name(), value: self.expression().id },
            Some(Rule::body) => DeclKind::Body { name: self.name(), fields: self.fields() },
            Some(Rule::spring) => self.element(ElementKeyword::Spring),
            Some(Rule::damper) => self.element(ElementKeyword::Damper),
            Some(Rule::repeat) => return Built::Repeat(self.repeat_head()),
            rule => self.rare(rule),
        };
        Built::Decl(Decl { span: self.span((0, self.text.len())), kind })
    }

    fn element(&mut self, kind: ElementKeyword) -> DeclKind {
        DeclKind::Element { kind, name: self.name(), ends: self.ends(), fields: self.fields() }
    }

    fn repeat_head(&mut self) -> RepeatHead {
        RepeatHead { index: self.word(), first: self.expression().id, last: self.expression().id }
    }

    fn rare(&mut self, rule: Option<Rule>) -> DeclKind {
        let rare = match rule {
            Some(Rule::pivot) => self.joint(JointKeyword::Pivot),
            Some(Rule::slide) => self.joint(JointKeyword::Slide),
            Some(Rule::weld) => self.joint(JointKeyword::Weld),
            Some(Rule::couple) => {
                Rare::Couple { name: self.name(), left: self.expression().id, right: self.expression().id }
            }
            Some(Rule::base) => {
                Rare::Base { name: self.name(), fields: self.fields(), signal: self.clause(Rule::signal) }
            }
            Some(Rule::force) => self.force(),
            Some(Rule::torque) => self.torque(),
            Some(Rule::initial) => Rare::Initial { body: self.name(), fields: self.fields() },
            Some(Rule::output) => Rare::Output { name: self.name(), value: self.expression().id },
            Some(Rule::damping_modal) => Rare::DampingModal { ratio: self.expression().id },
            Some(Rule::damping_rayleigh) => Rare::DampingRayleigh { arguments: self.items().0 },
            Some(Rule::rest) => Rare::RestAsDrawn,
            Some(Rule::solve) => self.solve(),
            _ => Rare::Require { condition: self.expression().id },
        };
        self.tree.rare.push(rare);
        DeclKind::Rare { index: (self.tree.rare.len() - 1) as u32 }
    }

    fn joint(&mut self, kind: JointKeyword) -> Rare {
        Rare::Joint { kind, name: self.name(), ends: self.ends(), along: self.clause(Rule::along) }
    }

    fn force(&mut self) -> Rare {
        let name = self.name();
        let (from, to) = self.one_or_two_ends();
        Rare::Force { name, from, to, along: self.clause(Rule::along), signal: self.clause(Rule::signal) }
    }

    fn torque(&mut self) -> Rare {
        let name = self.name();
        let (from, to) = self.one_or_two_ends();
        Rare::Torque { name, from, to, signal: self.clause(Rule::signal) }
    }

    fn solve(&mut self) -> Rare {
        Rare::Solve {
            parameter: self.name(),
            low: self.expression().id,
            high: self.expression().id,
            measure: self.expression().id,
            value: self.expression().id,
        }
    }

    /// `along ...` or `= ...`, where it is there.
    fn clause(&mut self, rule: Rule) -> Option<ExprId> {
        (self.peek() == Some(rule)).then(|| self.wrapped().0)
    }

    /// A rule that holds one expression and nothing else; the places where it starts and ends.
    fn wrapped(&mut self) -> (ExprId, usize, usize) {
        let start = self.step();
        let id = self.expression().id;
        (id, start, self.step())
    }

    fn word(&mut self) -> Span {
        let (start, end) = self.leaf();
        let span = self.span((start, end));
        if end - start > limits::WORD {
            self.refuse(Refused::TooLong(span));
        }
        span
    }

    fn name(&mut self) -> Ident {
        self.step();
        let span = self.word();
        let (indices, _) = self.items_until_end();
        self.step();
        Ident { span, indices }
    }

    /// The expressions up to the end of the rule around them, and the depth of the deepest.
    fn items_until_end(&mut self) -> (ExprList, u16) {
        let base = self.yard.items.len();
        let mut depth = 0;
        while self.peek().is_some() {
            let item = self.expression();
            depth = depth.max(item.depth);
            self.yard.items.push(item.id);
        }
        let list = self.tree.push_list(&self.yard.items[base..]);
        self.yard.items.truncate(base);
        (list, depth)
    }

    /// Arguments with their brackets.
    fn items(&mut self) -> (ExprList, u16) {
        self.step();
        let items = self.items_until_end();
        self.step();
        items
    }

    fn end(&mut self) -> EndId {
        let start = self.step();
        let part = self.name();
        let at = (self.peek() == Some(Rule::at)).then(|| self.place().0.id);
        let end = self.step();
        self.tree.ends.push(End { span: self.span((start, end)), part, at });
        EndId((self.tree.ends.len() - 1) as u32)
    }

    fn ends(&mut self) -> EndId {
        let first = self.end();
        self.end();
        first
    }

    fn one_or_two_ends(&mut self) -> (EndId, Option<EndId>) {
        let from = self.end();
        let to = (self.peek() == Some(Rule::end)).then(|| self.end());
        (from, to)
    }

    /// `@A`, `@(0, 1 m)`: the point and the place behind it.
    fn place(&mut self) -> (Operand, usize) {
        self.step();
        let point = match self.peek() {
            Some(Rule::name) => self.name_expression(),
            _ => self.group(),
        };
        (point, self.step())
    }

    fn name_expression(&mut self) -> Operand {
        let start = self.step();
        self.word();
        let (indices, depth) = self.items_until_end();
        let end = self.step();
        self.node((start, end), ExprKind::Name { indices }, depth)
    }

    fn fields(&mut self) -> Fields {
        self.step();
        // Fields hold no fields, so those of one declaration are next to each other.
        let start = self.tree.fields.len();
        while let Some(rule) = self.peek() {
            let field = self.field(rule);
            self.tree.fields.push(field);
        }
        self.step();
        Fields { start: start as u32, len: (self.tree.fields.len() - start) as u32 }
    }

    fn field(&mut self, rule: Rule) -> Field {
        self.step();
        let key = self.word();
        let value = match rule {
            Rule::assignment => {
                let value = self.expression().id;
                match self.clause(Rule::about) {
                    Some(point) => FieldValue::About(value, point),
                    None => FieldValue::Expr(value),
                }
            }
            Rule::moves_along => FieldValue::MovesAlong(self.expression().id),
            Rule::moves => FieldValue::Moves(self.motion_words()),
            _ => FieldValue::Flag,
        };
        self.step();
        Field { key, value }
    }

    fn motion_words(&mut self) -> ExprList {
        let base = self.yard.items.len();
        while self.peek().is_some() {
            let span = self.word();
            let id = self.tree.push_expr(Expr { span, kind: ExprKind::Name { indices: ExprList::EMPTY } });
            self.yard.items.push(id);
        }
        let list = self.tree.push_list(&self.yard.items[base..]);
        self.yard.items.truncate(base);
        list
    }

    fn expression(&mut self) -> Operand {
        self.step();
        let base = self.yard.operators.len();
        while let Some(rule) = self.peek() {
            match rule {
                Rule::minus => {
                    let (at, _) = self.leaf();
                    self.yard.operators.push(Operator::Negate(at));
                }
                Rule::operator => {
                    let (start, end) = self.leaf();
                    let operator = Operator::Binary(binary(&self.text[start..end]));
                    self.settle(base, operator);
                    self.yard.operators.push(operator);
                }
                _ => {
                    let operand = self.operand(rule);
                    self.yard.operands.push(operand);
                }
            }
        }
        self.step();
        self.reduce(base, 0);
        self.pop_operand()
    }

    /// Applies the operators that bind before `next`: those that bind tighter and, except for `^`, as tightly.
    fn settle(&mut self, base: usize, next: Operator) {
        let from_the_right = matches!(next, Operator::Binary(Binary::Power));
        self.reduce(base, next.binds() + u8::from(from_the_right));
    }

    fn reduce(&mut self, base: usize, at_least: u8) {
        while self.yard.operators.len() > base {
            let operator = self.yard.operators[self.yard.operators.len() - 1];
            if operator.binds() < at_least {
                break;
            }
            self.yard.operators.pop();
            let right = self.pop_operand();
            let made = match operator {
                Operator::Negate(at) => self.negate(at, right),
                Operator::Binary(operator) => {
                    let left = self.pop_operand();
                    self.combine(operator, left, right)
                }
            };
            self.yard.operands.push(made);
        }
    }

    fn pop_operand(&mut self) -> Operand {
        self.yard.operands.pop().expect("the grammar has an operand beside every operator")
    }

    fn negate(&mut self, at: usize, operand: Operand) -> Operand {
        let end = operand.end as usize;
        self.node((at, end), ExprKind::Negate { operand: operand.id }, operand.depth)
    }

    fn combine(&mut self, operator: Binary, left: Operand, right: Operand) -> Operand {
        let kind = ExprKind::Binary { operator, left: left.id, right: right.id };
        self.node((left.start as usize, right.end as usize), kind, left.depth.max(right.depth))
    }

    /// Appends a node above nodes of depth `below`.
    fn node(&mut self, (start, end): (usize, usize), kind: ExprKind, below: u16) -> Operand {
        let span = self.span((start, end));
        if below >= limits::EXPRESSION_DEPTH {
            self.refuse(Refused::TooDeep(span));
        }
        let id = self.tree.push_expr(Expr { span, kind });
        Operand { id, depth: below.saturating_add(1), start: start as u32, end: end as u32 }
    }

    fn operand(&mut self, rule: Rule) -> Operand {
        match rule {
            Rule::literal => self.literal(),
            Rule::reference => self.reference(),
            Rule::group => self.group(),
            Rule::text => {
                let place = self.leaf();
                self.node(place, ExprKind::Text, 0)
            }
            Rule::member => {
                let base = self.pop_operand();
                self.step();
                let member = self.word();
                let end = self.step();
                let kind = ExprKind::Member { base: base.id, member_len: member.len() as u16 };
                self.suffixed(base, end, kind, base.depth)
            }
            _ => {
                let base = self.pop_operand();
                let (point, end) = self.place();
                self.suffixed(base, end, ExprKind::At { base: base.id, point: point.id }, base.depth.max(point.depth))
            }
        }
    }

    fn suffixed(&mut self, base: Operand, end: usize, kind: ExprKind, below: u16) -> Operand {
        self.node((base.start as usize, end), kind, below)
    }

    fn literal(&mut self) -> Operand {
        let start = self.step();
        let (_, number_end) = self.leaf();
        let end = self.step();
        let number_len = number_end - start;
        if number_len > limits::NUMBER {
            self.refuse(Refused::TooLong(self.span((start, number_end))));
        }
        self.node((start, end), ExprKind::Literal { number_len: number_len as u16 }, 0)
    }

    fn reference(&mut self) -> Operand {
        let start = self.step();
        let word = self.word();
        if self.peek() == Some(Rule::arguments) {
            let (arguments, depth) = self.items();
            let end = self.step();
            return self.node((start, end), ExprKind::Call { name_len: word.len() as u16, arguments }, depth);
        }
        let (indices, depth) = self.items_until_end();
        let end = self.step();
        self.node((start, end), ExprKind::Name { indices }, depth)
    }

    /// `(x)` is x itself; `(x, y)` a tuple.
    fn group(&mut self) -> Operand {
        let start = self.step();
        let first = self.expression();
        if self.peek().is_none() {
            let end = self.step();
            return Operand { start: start as u32, end: end as u32, ..first };
        }
        let base = self.yard.items.len();
        self.yard.items.push(first.id);
        let mut depth = first.depth;
        while self.peek().is_some() {
            let item = self.expression();
            depth = depth.max(item.depth);
            self.yard.items.push(item.id);
        }
        let items = self.tree.push_list(&self.yard.items[base..]);
        self.yard.items.truncate(base);
        let end = self.step();
        self.node((start, end), ExprKind::Tuple { items }, depth)
    }
}
