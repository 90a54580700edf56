//! Turns the tokens of one declaration into nodes of the tree, which are stored in arenas.
//!
//! In: the text of one declaration, as cut out by `split`, and its tokens, as found by `recognise`. Out: nodes of the [`Tree`], or an
//! error and an unchanged tree. pest yields operands and operators in the order of the text; they are put in order of precedence here by Dijkstra's
//! shunting yard, so that the recursion is only as deep as the brackets, whose nesting `split` limits.
//! See spec.md#keywords and spec.md#expressions.

use super::limits;
use super::recognise::{Declaration, Rule, Token, recognise};
use super::tree::*;
use super::words;
use crate::base::{FileId, Span};
use crate::kinds::{ElementId, JointId, Shape};

/// The result of a parse: a declaration, or the head of a `repeat`.
pub(super) enum Built {
    Decl(Decl),
    Head(Head),
}

/// The head of a block of declarations, before its `{`.
pub(super) enum Head {
    Repeat(RepeatHead),
    Component(ComponentHead),
}

/// `component axle(m: kg) {`
pub(super) struct ComponentHead {
    pub name: Span,
    pub formals: Vec<Formal>,
}

/// `repeat i in first..last {`
pub(super) struct RepeatHead {
    pub index: Span,
    pub first: ExprId,
    pub last: ExprId,
}

/// Why a declaration is not in the tree.
pub(super) enum Refused {
    /// Its text does not match the grammar.
    Grammar,
    /// An expression is nested too deep.
    TooDeep(Span),
    LongWord(Span),
    LongNumber(Span),
    /// A clause that is there already.
    Twice(Span),
}

/// Appends the declaration with that text, which starts at byte `offset` of the file, to the tree.
pub(super) fn declaration(
    tree: &mut Tree,
    yard: &mut Yard,
    Declaration { shape, tokens }: Declaration<'_>,
    text: &str,
    offset: usize,
) -> Result<Built, Refused> {
    take(tree, yard, tokens, text, offset, |build| build.declaration(shape))
}

/// Parses a stand-alone value, such as that of `--set NAME=VALUE`. The caller has limited its brackets.
pub(super) fn value(tree: &mut Tree, text: &str, offset: usize) -> Result<ExprId, Refused> {
    let mut tokens = Vec::new();
    // A file's control characters are refused before; the grammar takes them for blanks.
    let has_control = text.bytes().any(|b| b.is_ascii_control() && !matches!(b, b'\t' | b'\n' | b'\r'));
    if has_control || !recognise(Rule::expression, text, &mut tokens) {
        return Err(Refused::Grammar);
    }
    take(tree, &mut Yard::default(), &tokens, text, offset, |build| build.expression().id)
}

/// Walks through the tokens of `text`. If that fails, the tree is left unchanged.
fn take<T>(
    tree: &mut Tree,
    yard: &mut Yard,
    tokens: &[Token],
    text: &str,
    offset: usize,
    walk: impl FnOnce(&mut Build<'_>) -> T,
) -> Result<T, Refused> {
    let mark = tree.mark();
    yard.clear();
    let mut build = Build {
        file: tree.file,
        tree,
        yard,
        text,
        offset,
        tokens: tokens.iter(),
        next: None,
        next_place: 0,
        refused: None,
    };
    build.step();
    let walked = walk(&mut build);
    match build.refused {
        None => Ok(walked),
        Some(refused) => {
            tree.truncate(mark);
            Err(refused)
        }
    }
}

/// The operand and operator stacks of the shunting yard, kept between declarations to reuse their memory.
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
    /// Height of its subtree in nodes, itself included.
    depth: u16,
    /// Its byte range in the declaration's text, including any brackets around it.
    start: u32,
    end: u32,
}

/// `.m[3]`
struct ReadMember {
    member_len: u16,
    indices: ExprList,
    depth: u16,
    end: usize,
}

#[derive(Clone, Copy)]
enum Operator {
    /// Unary minus and its position.
    Negate(usize),
    Binary(Binary),
}

impl Operator {
    /// Precedence: operators already on the stack that bind at least as tightly are applied first.
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

/// Walks through the tokens. Each method consumes the tokens of the rule it is named after.
struct Build<'a> {
    tree: &'a mut Tree,
    yard: &'a mut Yard,
    file: FileId,
    text: &'a str,
    offset: usize,
    tokens: std::slice::Iter<'a, Token>,
    /// The rule that starts next, or `None` at the end of the enclosing rule.
    next: Option<Rule>,
    next_place: usize,
    refused: Option<Refused>,
}

impl Build<'_> {
    /// Steps over a start or end token; returns its position in the declaration's text.
    fn step(&mut self) -> usize {
        let place = self.next_place;
        (self.next, self.next_place) = match self.tokens.next() {
            Some(&(rule, place)) => (rule, place as usize),
            None => (None, self.text.len()),
        };
        place
    }

    /// Consumes a rule without inner rules; returns where it starts and ends.
    fn leaf(&mut self) -> (usize, usize) {
        (self.step(), self.step())
    }

    fn span(&self, (start, end): (usize, usize)) -> Span {
        Span::new(self.file, self.offset + start, self.offset + end)
    }

    fn refuse(&mut self, refused: Refused) {
        self.refused.get_or_insert(refused);
    }

    fn declaration(&mut self, shape: Shape) -> Built {
        let rule = self.next;
        self.step();
        let kind = match shape {
            Shape::Model => DeclKind::Model { name: self.word() },
            Shape::Param => {
                DeclKind::Param { name: self.name(), value: self.expression().id, tolerance: self.tolerance() }
            }
            Shape::Let => DeclKind::Let { name: self.name(), value: self.expression().id },
            Shape::Gravity => DeclKind::Gravity { value: self.expression().id },
            Shape::Point => DeclKind::Point { name: self.name(), value: self.expression().id },
            Shape::Body => DeclKind::Body { name: self.name(), fields: self.fields() },
            Shape::Element(kind) => self.element(kind),
            Shape::Repeat => return Built::Head(Head::Repeat(self.repeat_head())),
            Shape::Component => return Built::Head(Head::Component(self.component_head())),
            shape => self.rare(shape, rule),
        };
        Built::Decl(Decl { span: self.span((0, self.text.len())), kind })
    }

    fn element(&mut self, kind: ElementId) -> DeclKind {
        DeclKind::Element { kind, name: self.name(), ends: self.ends(), fields: self.fields() }
    }

    fn repeat_head(&mut self) -> RepeatHead {
        RepeatHead { index: self.word(), first: self.expression().id, last: self.expression().id }
    }

    fn component_head(&mut self) -> ComponentHead {
        let name = self.word();
        self.step();
        let mut formals = Vec::new();
        while let Some(rule) = self.next {
            formals.push(if rule == Rule::port { self.port() } else { self.formal_number() });
        }
        self.step();
        ComponentHead { name, formals }
    }

    fn port(&mut self) -> Formal {
        self.step();
        let name = self.word();
        self.step();
        Formal { name, kind: FormalKind::Port }
    }

    /// A unit without a number, if one follows: `kg`, `/s`, `1`.
    fn dimension(&mut self) -> Option<Span> {
        (self.next == Some(Rule::dimension)).then(|| {
            let start = self.step();
            if self.next.is_some() {
                self.leaf();
            }
            let end = self.step();
            self.span((start, end))
        })
    }

    /// The unit of an output, if one follows.
    fn unit(&mut self) -> Option<Span> {
        (self.next == Some(Rule::unit)).then(|| {
            let range = self.leaf();
            self.span(range)
        })
    }

    fn formal_number(&mut self) -> Formal {
        self.step();
        let name = self.word();
        let unit = self.dimension();
        let default = self.next.is_some().then(|| self.expression().id);
        self.step();
        Formal { name, kind: FormalKind::Number { unit, default } }
    }

    fn place_declaration(&mut self) -> Rare {
        let name = self.name();
        let component = self.word();
        let arguments = self.actuals();
        let mut placing = Placing::default();
        while let Some(rule) = self.next {
            let start = self.step();
            let twice = match rule {
                Rule::mirrored => placing.mirrored.replace(self.word()).is_some(),
                Rule::turned => placing.turned.replace(self.expression().id).is_some(),
                _ => placing.at.replace(self.expression().id).is_some(),
            };
            let end = self.step();
            if twice {
                let clause = &self.text[start..end];
                let word = start + (clause.len() - clause.trim_start().len());
                let len = self.text[word..].bytes().position(|b| !words::is_word_byte(b)).unwrap_or(0);
                self.refuse(Refused::Twice(self.span((word, word + len))));
            }
        }
        Rare::Place { name, component, arguments, placing }
    }

    fn actuals(&mut self) -> Fields {
        self.step();
        let start = self.tree.fields.len();
        while self.next.is_some() {
            self.step();
            let field = Field { key: self.word(), value: FieldValue::Expr(self.expression().id) };
            self.step();
            self.tree.fields.push(field);
        }
        self.step();
        Fields { start: start as u32, len: (self.tree.fields.len() - start) as u32 }
    }

    fn import(&mut self) -> Rare {
        let text = self.leaf();
        self.tree.uses.push(Use { text: self.span(text) });
        Rare::Use { index: (self.tree.uses.len() - 1) as u32 }
    }

    fn rare(&mut self, shape: Shape, rule: Option<Rule>) -> DeclKind {
        let rare = match shape {
            Shape::Joint(kind) => self.joint(kind),
            Shape::Couple => {
                Rare::Couple { name: self.name(), left: self.expression().id, right: self.expression().id }
            }
            Shape::Base => Rare::Base { name: self.name(), fields: self.fields(), signal: self.clause(Rule::signal) },
            Shape::Force => self.force(),
            Shape::Torque => self.torque(),
            Shape::Unbalance => Rare::Unbalance { name: self.name(), end: self.end(), fields: self.fields() },
            Shape::Initial => Rare::Initial { body: self.path(), fields: self.fields() },
            Shape::Output => Rare::Output { name: self.name(), unit: self.unit(), value: self.expression().id },
            Shape::Damping if rule == Some(Rule::damping_modal) => Rare::DampingModal { ratio: self.expression().id },
            Shape::Damping => Rare::DampingRayleigh { arguments: self.arguments().0 },
            Shape::Rest => Rare::RestAsDrawn,
            Shape::Solve => self.solve(),
            Shape::Minimise => self.optimum(false),
            Shape::Maximise => self.optimum(true),
            Shape::Place => self.place_declaration(),
            Shape::Use => self.import(),
            Shape::Correlate => {
                Rare::Correlate { first: self.path(), second: self.path(), coefficient: self.expression().id }
            }
            _ => Rare::Require { condition: self.expression().id },
        };
        self.tree.rare.push(rare);
        DeclKind::Rare { index: (self.tree.rare.len() - 1) as u32 }
    }

    /// `spread 10 % within 30 %`, if something follows the value of a `param`.
    fn tolerance(&mut self) -> Option<u32> {
        self.next?;
        let start = self.next_place;
        let spread = (self.next == Some(Rule::spread)).then(|| self.spread());
        let (mut within, mut upper) = (None, None);
        if self.next == Some(Rule::within) {
            self.step();
            within = Some(self.expression().id);
            if self.next.is_some() {
                self.step();
                upper = Some(self.expression().id);
                self.step();
            }
            self.step();
        }
        let start = self.text.len() - self.text[start..].trim_start().len();
        let span = self.span((start, self.text.len()));
        self.tree.tolerances.push(Tolerance { span, spread, within, upper });
        Some((self.tree.tolerances.len() - 1) as u32)
    }

    fn spread(&mut self) -> Spread {
        self.step();
        let word = self.next;
        if word != Some(Rule::expression) {
            self.leaf();
        }
        let spread = match word {
            Some(Rule::uniform) => Spread::Uniform,
            Some(Rule::lognormal) => Spread::Lognormal(self.expression().id),
            _ => Spread::Normal(self.expression().id),
        };
        self.step();
        spread
    }

    fn joint(&mut self, kind: JointId) -> Rare {
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
            parameter: self.path(),
            low: self.expression().id,
            high: self.expression().id,
            measure: self.expression().id,
            value: self.expression().id,
        }
    }

    fn optimum(&mut self, highest: bool) -> Rare {
        let measure = self.expression().id;
        let start = self.tree.varied.len() as u32;
        while self.next == Some(Rule::varied) {
            self.step();
            let varied = Varied { parameter: self.path(), low: self.expression().id, high: self.expression().id };
            self.tree.varied.push(varied);
            self.step();
        }
        let mut limits = Vec::new();
        while self.next == Some(Rule::bounded) {
            limits.push(self.wrapped_expression().0);
        }
        let limits = self.tree.push_list(&limits);
        Rare::Optimum { highest, measure, varied: (start, self.tree.varied.len() as u32), limits }
    }

    /// `along ...` or `= ...`, if present.
    fn clause(&mut self, rule: Rule) -> Option<ExprId> {
        (self.next == Some(rule)).then(|| self.wrapped_expression().0)
    }

    /// Consumes a rule that holds a single expression; returns the expression and where the rule starts and ends.
    fn wrapped_expression(&mut self) -> (ExprId, usize, usize) {
        let start = self.step();
        let id = self.expression().id;
        (id, start, self.step())
    }

    /// The word at `start`, where a rule has just matched one.
    fn word_at(&mut self, start: usize) -> Span {
        let len = self.text[start..].bytes().position(|b| !words::is_word_byte(b)).unwrap_or(self.text.len() - start);
        let span = self.span((start, start + len));
        if len > limits::WORD {
            self.refuse(Refused::LongWord(span));
        }
        // The grammar takes letters of all scripts behind the first one: a single test for each character.
        let word = &self.text[start..start + len];
        if !word.is_ascii() && !word.chars().all(|c| words::is_letter(c) || c.is_ascii_digit()) {
            self.refuse(Refused::Grammar);
        }
        span
    }

    fn word(&mut self) -> Span {
        let start = self.step();
        self.step();
        self.word_at(start)
    }

    fn name(&mut self) -> Ident {
        let start = self.step();
        let span = self.word_at(start);
        let (indices, _) = self.expressions();
        self.step();
        Ident { span, indices }
    }

    /// The expressions that come next, and the depth of the deepest.
    fn expressions(&mut self) -> (ExprList, u16) {
        if self.next != Some(Rule::expression) {
            return (ExprList::EMPTY, 0);
        }
        let first = self.expression();
        self.expressions_after(first)
    }

    fn expressions_after(&mut self, first: Operand) -> (ExprList, u16) {
        let base = self.yard.items.len();
        self.yard.items.push(first.id);
        let mut depth = first.depth;
        while self.next == Some(Rule::expression) {
            let item = self.expression();
            depth = depth.max(item.depth);
            self.yard.items.push(item.id);
        }
        let list = self.tree.push_list(&self.yard.items[base..]);
        self.yard.items.truncate(base);
        (list, depth)
    }

    /// Arguments with their brackets.
    fn arguments(&mut self) -> (ExprList, u16) {
        self.step();
        let base = self.yard.items.len();
        let mut depth = 0;
        while let Some(rule @ (Rule::expression | Rule::named | Rule::white)) = self.next {
            let mut item = if rule == Rule::expression { self.expression() } else { self.named_operand() };
            if self.next == Some(Rule::upper) {
                item = self.range(item);
            }
            depth = depth.max(item.depth);
            self.yard.items.push(item.id);
        }
        let list = self.tree.push_list(&self.yard.items[base..]);
        self.yard.items.truncate(base);
        self.step();
        (list, depth)
    }

    /// `.. 50 Hz` behind the lower end
    fn range(&mut self, low: Operand) -> Operand {
        self.step();
        let high = self.expression();
        self.step();
        let kind = ExprKind::Range { low: low.id, high: high.id };
        self.node((low.start as usize, high.end as usize), kind, low.depth.max(high.depth))
    }

    /// `speed = 20 m/s`, `white 3 N^2/Hz`
    fn named_operand(&mut self) -> Operand {
        let start = self.step();
        let name_len = self.word_at(start).len() as u16;
        let value = self.expression();
        let end = self.step();
        self.node((start, end), ExprKind::Named { name_len, value: value.id }, value.depth)
    }

    fn path(&mut self) -> Path {
        let start = self.step();
        let (first, whole) = self.path_from(start);
        self.step();
        Path { first, whole }
    }

    /// A name and its members, where a rule that starts with them has just found the place of the first.
    fn path_from(&mut self, start: usize) -> (Ident, Option<ExprId>) {
        let span = self.word_at(start);
        let (indices, depth) = self.expressions();
        if self.next != Some(Rule::member) {
            return (Ident { span, indices }, None);
        }
        let mut operand = self.node((start, self.next_place), ExprKind::Name { indices }, depth);
        while self.next == Some(Rule::member) {
            operand = self.member(operand);
        }
        (Ident { span, indices }, Some(operand.id))
    }

    fn end(&mut self) -> EndId {
        let start = self.step();
        let (part, whole) = self.path_from(start);
        let at = (self.next == Some(Rule::spot)).then(|| self.spot());
        let end = self.step();
        let word_len = part.span.len() as u16;
        self.tree.ends.push(End { span: self.span((start, end)), word_len, indices: part.indices, whole, at });
        EndId((self.tree.ends.len() - 1) as u32)
    }

    /// `@A`, `@front.hub`, `@(0, 1 m)`
    fn spot(&mut self) -> ExprId {
        self.step();
        let point = match self.next {
            Some(Rule::path) => self.path_expression(),
            _ => self.group().id,
        };
        self.step();
        point
    }

    fn path_expression(&mut self) -> ExprId {
        let start = self.step();
        let (Ident { indices, .. }, whole) = self.path_from(start);
        let end = self.step();
        whole.unwrap_or_else(|| self.node((start, end), ExprKind::Name { indices }, 0).id)
    }

    fn ends(&mut self) -> EndId {
        let first = self.end();
        self.end();
        first
    }

    fn one_or_two_ends(&mut self) -> (EndId, Option<EndId>) {
        let from = self.end();
        let to = (self.next == Some(Rule::end)).then(|| self.end());
        (from, to)
    }

    /// `@A`, `@(0, 1 m)`: the point, and the position just after it.
    fn place(&mut self) -> (Operand, usize) {
        self.step();
        let point = match self.next {
            Some(Rule::name) => self.name_expression(),
            _ => self.group(),
        };
        (point, self.step())
    }

    fn name_expression(&mut self) -> Operand {
        let start = self.step();
        self.word_at(start);
        let (indices, depth) = self.expressions();
        let end = self.step();
        self.node((start, end), ExprKind::Name { indices }, depth)
    }

    fn fields(&mut self) -> Fields {
        self.step();
        // Fields hold no fields, so those of one declaration are next to each other.
        let start = self.tree.fields.len();
        while let Some(rule) = self.next {
            let field = self.field(rule);
            self.tree.fields.push(field);
        }
        self.step();
        Fields { start: start as u32, len: (self.tree.fields.len() - start) as u32 }
    }

    fn field(&mut self, rule: Rule) -> Field {
        let start = self.step();
        let key = self.word_at(start);
        let value = match rule {
            Rule::assignment => {
                let value = self.expression().id;
                match self.next {
                    Some(_) => {
                        let about = self.expression().id;
                        FieldValue::About(self.tree.push_list(&[value, about]))
                    }
                    None => FieldValue::Expr(value),
                }
            }
            Rule::moves if self.next == Some(Rule::expression) => FieldValue::MovesAlong(self.expression().id),
            Rule::moves => self.directions(),
            _ => FieldValue::Flag,
        };
        self.step();
        Field { key, value }
    }

    fn directions(&mut self) -> FieldValue {
        let mut words = self.word();
        while self.next.is_some() {
            words = words.to(self.word());
        }
        FieldValue::Moves { start: words.start() as u32, len: u16::try_from(words.len()).unwrap_or(u16::MAX) }
    }

    fn expression(&mut self) -> Operand {
        self.step();
        let base = self.yard.operators.len();
        while let Some(rule) = self.next {
            match rule {
                Rule::minus => {
                    let (at, _) = self.leaf();
                    self.yard.operators.push(Operator::Negate(at));
                }
                Rule::operator => {
                    let (start, end) = self.leaf();
                    let operator = Operator::Binary(binary(&self.text[start..end]));
                    self.apply_waiting(base, operator);
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

    /// Applies the waiting operators that bind before `next`: tighter ones and, unless `next` is `^`, equally tight ones.
    fn apply_waiting(&mut self, base: usize, next: Operator) {
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
            _ => {
                let place = self.leaf();
                self.node(place, ExprKind::Text, 0)
            }
        }
    }

    /// A number and its unit, with at most a blank and the slash of `0.1 /s` between them.
    fn literal(&mut self) -> Operand {
        let start = self.step();
        let unit = self.next.is_some().then(|| self.leaf().0);
        let end = self.step();
        let number = &self.text[start..unit.unwrap_or(end)];
        let number_len = number.strip_suffix('/').unwrap_or(number).trim_end_matches(' ').len();
        if number_len > limits::NUMBER {
            self.refuse(Refused::LongNumber(self.span((start, start + number_len))));
        }
        self.node((start, end), ExprKind::Literal { number_len: number_len as u16 }, 0)
    }

    /// `k`, `m[i]`, `sqrt(x)`, with any suffixes: `.angle`, `@A.x`.
    fn reference(&mut self) -> Operand {
        let start = self.step();
        let name_len = self.word_at(start).len() as u16;
        let (kind, depth) = if self.next == Some(Rule::arguments) {
            let (arguments, depth) = self.arguments();
            (ExprKind::Call { name_len, arguments }, depth)
        } else {
            let (indices, depth) = self.expressions();
            (ExprKind::Name { indices }, depth)
        };
        // Nothing stands between a name and its first suffix.
        let mut operand = self.node((start, self.next_place), kind, depth);
        while let Some(rule) = self.next {
            operand = if rule == Rule::member { self.member(operand) } else { self.point_of(operand) };
        }
        self.step();
        operand
    }

    fn member(&mut self, base: Operand) -> Operand {
        let member = self.read_member();
        self.member_of(base, member)
    }

    fn read_member(&mut self) -> ReadMember {
        let start = self.step();
        let member_len = self.word_at(start + 1).len() as u16;
        let (indices, depth) = self.expressions();
        ReadMember { member_len, indices, depth, end: self.step() }
    }

    fn member_of(&mut self, base: Operand, member: ReadMember) -> Operand {
        let ReadMember { member_len, indices, depth, end } = member;
        let kind = ExprKind::Member { base: base.id, member_len, indices };
        self.node((base.start as usize, end), kind, base.depth.max(depth))
    }

    /// `@A`; of `@front.hub.y` all members but the last lead to the point.
    fn point_of(&mut self, base: Operand) -> Operand {
        let (mut point, mut end) = self.place();
        let mut last = None;
        while self.next == Some(Rule::member) {
            let member = self.read_member();
            if let Some(before) = last.replace(member) {
                point = self.member_of(point, before);
                end = point.end as usize;
            }
        }
        let kind = ExprKind::At { base: base.id, point: point.id };
        let at = self.node((base.start as usize, end), kind, base.depth.max(point.depth));
        match last {
            Some(member) => self.member_of(at, member),
            None => at,
        }
    }

    /// `(x)` is x itself; `(x, y)` a tuple.
    fn group(&mut self) -> Operand {
        let start = self.step();
        let first = self.expression();
        if self.next.is_none() {
            let end = self.step();
            return Operand { start: start as u32, end: end as u32, ..first };
        }
        let (items, depth) = self.expressions_after(first);
        let end = self.step();
        self.node((start, end), ExprKind::Tuple { items }, depth)
    }
}
