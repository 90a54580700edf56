//! The expressions behind the numbers of a scene. In: a check that found no errors. Out: for each item of the scene, in
//! the same order, the expressions of its numbers in terms of the names of the model. See docs/equations.md.
//!
//! A `param` and a `let` of a number stay names; points are replaced by their components. A value without a form here (a
//! level in dB, a chain of definitions that is nested too deep) becomes a name of its own with the value that the check
//! found.

use super::Check;
use super::evaluate::Stop;
use super::places::{Frame, FrameId};
use super::scene::{Freedom, Geometry, InputKind, Part, Translation};
use super::scope::{self, DefinitionId, DefinitionKind, Environment, Instance, Role, State};
use super::value::{Scalar, Value};
use crate::base::{Angle, Dimension, Number, Rational, Span, Takes};
use crate::elements::Kind;
use crate::kinds::motions::{BODY_MOTIONS, Direction};
use crate::symbols::{Factor, Function, Powers, Sum, Symbol};
use crate::syntax::tree::{Binary, DeclKind, EndId, ExprId, ExprKind, ExprList, Field, FieldValue, Fields, Rare};
use std::sync::Arc;

/// A place or a direction.
pub type Pair = [Sum; 2];

/// The expressions of the numbers of a scene; each list is in the order of the scene's.
#[derive(Clone, Debug, Default)]
pub struct Written {
    pub names: Vec<Named>,
    /// The acceleration of free fall as a single number that points along -y, if it was written like that.
    pub free_fall: Option<Sum>,
    pub gravity: Option<Pair>,
    pub bodies: Vec<WrittenBody>,
    pub bases: Vec<WrittenBase>,
    pub joints: Vec<WrittenJoint>,
    /// The coefficient of each term, and the point whose motion it takes.
    pub couples: Vec<Vec<WrittenTerm>>,
    pub elements: Vec<WrittenElement>,
    pub inputs: Vec<WrittenInput>,
    pub outputs: Vec<Vec<WrittenTerm>>,
    /// alpha and beta of Rayleigh damping.
    pub rayleigh: Option<(Sum, Sum)>,
}

impl Written {
    /// The place where a part is drawn.
    pub fn own_place(&self, part: Part) -> Option<Pair> {
        match part {
            Part::Ground => None,
            Part::Body(body) => self.bodies.get(body.index())?.centre.clone(),
            Part::Base(base) => self.bases.get(base.index())?.at.clone(),
        }
    }
}

/// A name of a number.
#[derive(Clone, Debug)]
pub struct Named {
    pub symbol: Symbol,
    pub text: String,
    pub value: Number,
    pub dimension: Dimension,
    /// The expression of a `let`; `None` for a `param`.
    pub definition: Option<Sum>,
    /// The text in the model, for a name that was made up here.
    pub source: Option<String>,
}

#[derive(Clone, Debug, Default)]
pub struct WrittenBody {
    pub mass: Option<Sum>,
    /// About the centre.
    pub inertia: Option<Sum>,
    pub centre: Option<Pair>,
    /// Of a disk or a ring.
    pub radius: Option<Sum>,
    /// Directions as written.
    pub translations: Vec<Pair>,
}

#[derive(Clone, Debug, Default)]
pub struct WrittenBase {
    pub at: Option<Pair>,
    pub translations: Vec<Pair>,
}

#[derive(Clone, Debug)]
pub struct WrittenJoint {
    /// The place of a pivot.
    pub at: Option<Pair>,
    /// The places of both ends.
    pub ends: [Option<Pair>; 2],
    /// The direction of a slide.
    pub along: Option<Pair>,
}

#[derive(Clone, Debug)]
pub struct WrittenTerm {
    pub coefficient: Sum,
    pub at: Option<Pair>,
}

#[derive(Clone, Debug)]
pub struct WrittenElement {
    pub ends: [Option<Pair>; 2],
    /// Its coefficient, such as `k` or `c`.
    pub coefficient: Sum,
    /// Its law in powers of the stretch or the rate; `None` if it has no law, or one that is not such a sum.
    pub law: Option<Powers>,
    pub free_length: Option<Sum>,
    pub preload: Option<Sum>,
    pub along: Option<Pair>,
}

#[derive(Clone, Debug, Default)]
pub struct WrittenInput {
    pub ends: Vec<Option<Pair>>,
    pub along: Option<Pair>,
    /// The constant part of its signal.
    pub constant: Sum,
    pub rotation: Option<WrittenRotation>,
}

/// The rotation of an unbalance's heavy spot, in the axes of the component that declares it.
#[derive(Clone, Debug)]
pub struct WrittenRotation {
    /// The mass times its distance from the axis, kg m.
    pub unbalance: Sum,
    /// The speed in rad/s, if it is given.
    pub speed: Option<Sum>,
    pub clockwise: bool,
}

/// Classes of names, in the order in which their factors are written: plain numbers first, then the usual coefficients.
const CLASSES: [Dimension; 13] = [
    Dimension::NONE,
    Dimension::MASS,
    Dimension::INERTIA,
    Dimension::STIFFNESS,
    Dimension::DAMPING,
    Dimension::TORQUE,
    Dimension::TORSIONAL_DAMPING,
    Dimension::UNBALANCE,
    Dimension::FORCE,
    Dimension::ACCELERATION,
    Dimension::VELOCITY,
    Dimension::LENGTH,
    Dimension::FREQUENCY,
];

/// The class of a name of this dimension.
pub fn class_of(dimension: Dimension) -> u8 {
    CLASSES.iter().position(|known| *known == dimension).unwrap_or(CLASSES.len()) as u8
}

/// Levels of expressions and definitions beyond which a value becomes a number.
const MAX_DEPTH: usize = 400;

/// The centre of a shape where it says so, its inertia about that per unit mass, and the radius of a round one.
struct WrittenShape {
    middle: Option<Pair>,
    squared: Sum,
    radius: Option<Sum>,
}

#[derive(Clone, Debug)]
enum Form {
    Number(Sum),
    Pair(Pair),
}

/// The walk over the declarations of a checked model.
pub(super) struct Writer<'c, 'a> {
    check: &'c mut Check<'a>,
    known: Vec<Option<Form>>,
    /// The positions and orientations of the components at their places, computed when needed.
    lying: Vec<Option<Arc<Lying>>>,
    depth: usize,
    written: Written,
}

/// The position and orientation of a component: around its place, and in the scene; see [`super::places::Placed`].
struct Lying {
    around: WrittenMotion,
    scene: WrittenMotion,
}

/// x -> o + R S x.
#[derive(Clone)]
struct WrittenMotion {
    origin: Option<Pair>,
    angle: Sum,
    mirrored: [bool; 2],
}

impl WrittenMotion {
    fn direction(&self, v: &Pair) -> Pair {
        let signed = |sum: &Sum, is_mirrored| if is_mirrored { -sum } else { sum.clone() };
        let (x, y) = (signed(&v[0], self.mirrored[0]), signed(&v[1], self.mirrored[1]));
        if self.angle.is_zero() {
            return [x, y];
        }
        let (sine, cosine) = (self.angle.sine(), self.angle.cosine());
        [&(&cosine * &x) - &(&sine * &y), &(&sine * &x) + &(&cosine * &y)]
    }

    fn place(&self, v: &Pair) -> Option<Pair> {
        Some(sum(self.origin.as_ref()?, &self.direction(v)))
    }
}

impl<'c, 'a> Writer<'c, 'a> {
    pub(super) fn new(check: &'c mut Check<'a>) -> Writer<'c, 'a> {
        let known = vec![None; check.definitions.len()];
        Writer { check, known, lying: Vec::new(), depth: 0, written: Written::default() }
    }

    /// Converts everything; `None` if something has no expression after all, which does not happen in a checked model.
    pub(super) fn run(mut self) -> Option<Written> {
        for index in 0..self.known.len() {
            self.definition(index);
        }
        for index in 0..self.check.instances.bodies.len() {
            let body = self.body(self.check.instances.bodies[index])?;
            self.written.bodies.push(body);
        }
        for index in 0..self.check.instances.bases.len() {
            let base = self.base(self.check.instances.bases[index])?;
            self.written.bases.push(base);
        }
        for index in 0..self.check.instances.joints.len() {
            let joint = self.joint(self.check.instances.joints[index], index)?;
            self.written.joints.push(joint);
        }
        for index in 0..self.check.instances.elements.len() {
            let element = self.element(self.check.instances.elements[index])?;
            self.written.elements.push(element);
        }
        for index in 0..self.check.instances.inputs.len() {
            self.input(self.check.instances.inputs[index])?;
        }
        for index in 0..self.check.instances.couples.len() {
            let Instance { decl, environment } = self.check.instances.couples[index];
            let Rare::Couple { left, right, .. } = self.rare(decl.kind)? else { return None };
            let mut terms = self.terms(left, environment)?;
            let right = self.terms(right, environment)?;
            terms.extend(right.into_iter().map(|term| WrittenTerm { coefficient: -&term.coefficient, ..term }));
            self.written.couples.push(terms);
        }
        for index in 0..self.check.instances.outputs.len() {
            let Instance { decl, environment } = self.check.instances.outputs[index];
            let Rare::Output { value, .. } = self.rare(decl.kind)? else { return None };
            let terms = self.terms(value, environment)?;
            self.written.outputs.push(terms);
        }
        self.settings()?;
        Some(self.written)
    }

    fn rare(&self, kind: DeclKind) -> Option<Rare> {
        let DeclKind::Rare { index } = kind else { return None };
        Some(self.check.tree.rare[index as usize])
    }

    /// The expression of a field, given its word.
    fn field(&self, fields: Fields, word: &str) -> Option<FieldValue> {
        let tree = self.check.tree;
        let found = tree.fields(fields).iter().find(|field| self.check.sources.slice(field.key) == word)?;
        Some(found.value)
    }

    fn field_number(&mut self, fields: Fields, word: &str, environment: Environment) -> Option<Sum> {
        match self.field(fields, word)? {
            FieldValue::Expr(expr) => Some(self.number(expr, environment)),
            _ => None,
        }
    }

    fn field_pair(&mut self, fields: Fields, word: &str, environment: Environment) -> Option<Pair> {
        match self.field(fields, word)? {
            FieldValue::Expr(expr) => Some(self.place(expr, environment)),
            _ => None,
        }
    }

    fn body(&mut self, instance: Instance<'a>) -> Option<WrittenBody> {
        let Instance { decl, environment } = instance;
        let DeclKind::Body { fields, .. } = decl.kind else { return None };
        let mass = self.field_number(fields, "mass", environment);
        let (mut centre, mut gyration, mut radius) = (self.field_pair(fields, "at", environment), None, None);
        if let Some(FieldValue::Expr(shape)) = self.field(fields, "shape") {
            let WrittenShape { middle, squared, radius: own } = self.shape(shape, environment)?;
            centre = centre.or(middle);
            gyration = Some(squared);
            radius = own;
        }
        let inertia = match self.field(fields, "inertia") {
            Some(FieldValue::About(list)) => {
                let (expr, about) = self.check.tree.about_parts(list);
                let (given, about) = (self.number(expr, environment), self.place(about, environment));
                Some(about_centre(given, &about, mass.as_ref(), centre.as_ref()))
            }
            Some(FieldValue::Expr(expr)) => Some(self.number(expr, environment)),
            _ => gyration.and_then(|squared| Some(mass.as_ref()? * &squared)),
        };
        let known = match self.check.scene.bodies[self.written.bodies.len()].freedom.clone() {
            Freedom::OnGround { translations, .. } => translations,
            Freedom::FromJoints => Arc::default(),
        };
        let translations = self.translations(fields, &known, environment);
        Some(WrittenBody { mass, inertia, centre, radius, translations })
    }

    /// Axes of the scene as such, an oblique direction as written.
    fn translations(&mut self, fields: Fields, known: &[Translation], environment: Environment) -> Vec<Pair> {
        let tree = self.check.tree;
        let moves = tree.fields(fields).iter().find(|field| self.check.sources.slice(field.key) == "moves");
        let mut written = |translation: &Translation| match (translation.motion, moves.map(|field| field.value)) {
            ("x", _) => [Sum::one(), Sum::ZERO],
            ("y", _) => [Sum::ZERO, Sum::one()],
            (_, Some(FieldValue::MovesAlong(expr))) => self.direction(expr, environment),
            (_, Some(FieldValue::Moves { .. })) => {
                // The axis of a component that is turned.
                let directions = moves.and_then(Field::directions).map_or("", |words| self.check.sources.slice(words));
                let word = directions.split_ascii_whitespace().next();
                let axis = if word == Some("x") { [Sum::one(), Sum::ZERO] } else { [Sum::ZERO, Sum::one()] };
                self.rotate_to_scene(axis, environment)
            }
            _ => [Sum::ZERO, Sum::ZERO],
        };
        known.iter().map(&mut written).collect()
    }

    fn shape(&mut self, expr: ExprId, environment: Environment) -> Option<WrittenShape> {
        let tree = self.check.tree;
        let node = *tree.expr(expr);
        let ExprKind::Call { name_len, arguments } = node.kind else { return None };
        let word = Span::new(node.span.file(), node.span.start(), node.span.start() + usize::from(name_len));
        Some(match (self.check.sources.slice(word), tree.list(arguments)) {
            ("rod", &[a, b]) => {
                let (a, b) = (self.place(a, environment), self.place(b, environment));
                let along = difference(&b, &a);
                let squared = dot(&along, &along).scale(&Rational::new(1, 12));
                WrittenShape { middle: Some(sum(&a, &b).map(|part| part.halve())), squared, radius: None }
            }
            ("disk", &[radius]) => {
                let radius = self.number(radius, environment);
                WrittenShape { middle: None, squared: radius.square().halve(), radius: Some(radius) }
            }
            ("ring", &[radius]) => {
                let radius = self.number(radius, environment);
                WrittenShape { middle: None, squared: radius.square(), radius: Some(radius) }
            }
            ("box", &[width, height]) => {
                let (width, height) = (self.number(width, environment), self.number(height, environment));
                let squared = (&width.square() + &height.square()).scale(&Rational::new(1, 12));
                WrittenShape { middle: None, squared, radius: None }
            }
            _ => return None,
        })
    }

    fn base(&mut self, instance: Instance<'a>) -> Option<WrittenBase> {
        let Rare::Base { fields, .. } = self.rare(instance.decl.kind)? else { return None };
        let at = self.field_pair(fields, "at", instance.environment);
        let known = self.check.scene.bases[self.written.bases.len()].translations.clone();
        Some(WrittenBase { at, translations: self.translations(fields, &known, instance.environment) })
    }

    fn end(&mut self, id: EndId, part: Part, environment: Environment) -> Option<Pair> {
        match self.check.tree.end(id).at {
            Some(at) => Some(self.place(at, environment)),
            None => self.written.own_place(part),
        }
    }

    fn joint(&mut self, instance: Instance<'a>, index: usize) -> Option<WrittenJoint> {
        let Instance { decl, environment } = instance;
        let Rare::Joint { ends, along, .. } = self.rare(decl.kind)? else { return None };
        let parts = [0, 1].map(|end| self.check.scene.joints[index].ends[end].part);
        let ids = [ends, EndId(ends.0 + 1)];
        let written = ids.map(|id| self.check.tree.end(id).at.is_some());
        let mut places = [self.end(ids[0], parts[0], environment), self.end(ids[1], parts[1], environment)];
        let is_pivot = self.check.scene.joints[index].kind.turns;
        let at =
            is_pivot.then(|| if written[1] && !written[0] { places[1].clone() } else { places[0].clone() }).flatten();
        if is_pivot {
            places = [at.clone(), at.clone()];
        }
        let along = along.map(|along| self.direction(along, environment));
        Some(WrittenJoint { at, ends: places, along })
    }

    fn element(&mut self, instance: Instance<'a>) -> Option<WrittenElement> {
        let Instance { decl, environment } = instance;
        let DeclKind::Element { kind, ends, fields, .. } = decl.kind else { return None };
        let element = &self.check.scene.elements[self.written.elements.len()];
        let parts = [0, 1].map(|end| element.ends[end].part);
        let is_twisted = element.law.geometry == Geometry::Torsion;
        let is_law = element.law.curve.is_some();
        let mut ids = [ends, EndId(ends.0 + 1)];
        if is_twisted && self.check.reverses(environment).ok()? {
            ids.reverse();
        }
        let places = [self.end(ids[0], parts[0], environment), self.end(ids[1], parts[1], environment)];
        let coefficient = match self.field_number(fields, kind.kind().coefficient().name, environment) {
            None if is_law => Sum::ZERO,
            given => given?,
        };
        let law = match self.field(fields, "law") {
            Some(FieldValue::Expr(expr)) => self.law(expr, law_variable(kind.kind())?, environment),
            _ => None,
        };
        let along = match self.field(fields, "along") {
            Some(FieldValue::Expr(expr)) => Some(self.direction(expr, environment)),
            _ => None,
        };
        Some(WrittenElement {
            ends: places,
            coefficient,
            law,
            free_length: self.field_number(fields, "free_length", environment),
            preload: self.field_number(fields, "preload", environment),
            along,
        })
    }

    /// A law in powers of its variable; `None` if it is a table or has another function of it.
    fn law(&mut self, expr: ExprId, variable: &str, environment: Environment) -> Option<Powers> {
        let tree = self.check.tree;
        let node = *tree.expr(expr);
        if !self.varies(expr, variable) {
            return match node.kind {
                ExprKind::Call { .. } if self.function(expr) == Some("table") => None,
                _ => Some(Powers::constant(self.number(expr, environment))),
            };
        }
        match node.kind {
            ExprKind::Name { .. } => Some(Powers::variable()),
            ExprKind::Negate { operand } => {
                Some(self.law(operand, variable, environment)?.scale(&Sum::fraction(-1, 1)))
            }
            ExprKind::Binary { operator, left, right } => {
                let (a, b) = (self.law(left, variable, environment)?, self.law(right, variable, environment)?);
                match operator {
                    Binary::Add => Some(a.plus(&b)),
                    Binary::Subtract => Some(a.plus(&b.scale(&Sum::fraction(-1, 1)))),
                    Binary::Multiply => a.times(&b),
                    Binary::Divide => Some(a.scale(&b.as_constant()?.inverse()?)),
                    Binary::Power => a.power(u32::try_from(b.as_constant()?.as_number()?.to_i64()?).ok()?),
                    _ => None,
                }
            }
            ExprKind::Call { arguments, .. } if self.function(expr) == Some("abs") => {
                self.law(*tree.list(arguments).first()?, variable, environment)?.magnitude()
            }
            _ => None,
        }
    }

    /// Whether a word occurs in an expression of a law.
    fn varies(&self, expr: ExprId, variable: &str) -> bool {
        let tree = self.check.tree;
        let node = *tree.expr(expr);
        match node.kind {
            ExprKind::Name { indices } => indices.is_empty() && self.check.sources.slice(node.span) == variable,
            ExprKind::Negate { operand } => self.varies(operand, variable),
            ExprKind::Binary { left, right, .. } => self.varies(left, variable) || self.varies(right, variable),
            ExprKind::Call { arguments, .. } => tree.list(arguments).iter().any(|own| self.varies(*own, variable)),
            _ => false,
        }
    }

    /// The name of the function that is called.
    fn function(&self, expr: ExprId) -> Option<&'a str> {
        let node = self.check.tree.expr(expr);
        let ExprKind::Call { name_len, .. } = node.kind else { return None };
        let start = node.span.start();
        Some(self.check.sources.slice(Span::new(node.span.file(), start, start + usize::from(name_len))))
    }

    fn input(&mut self, instance: Instance<'a>) -> Option<()> {
        let Instance { decl, environment } = instance;
        match self.rare(decl.kind)? {
            Rare::Force { from, to, along, signal, .. } => {
                let constant = self.constant(signal, environment);
                let along = along.map(|along| self.direction(along, environment));
                self.push_input((from, to), along, constant, environment)
            }
            Rare::Torque { from, to, signal, .. } => {
                let constant = self.constant(signal, environment);
                self.push_input((from, to), None, constant, environment)
            }
            Rare::Unbalance { end, fields, .. } => self.unbalance(end, fields, environment),
            Rare::Base { signal, .. } => {
                let constant = self.constant(signal, environment);
                // One input per motion of the base.
                let name = self.check.scene.inputs.get(self.written.inputs.len())?.name;
                while self.check.scene.inputs.get(self.written.inputs.len()).is_some_and(|input| input.name == name) {
                    self.written.inputs.push(WrittenInput { constant: constant.clone(), ..WrittenInput::default() });
                }
                Some(())
            }
            _ => None,
        }
    }

    fn push_input(
        &mut self,
        (from, to): (EndId, Option<EndId>),
        along: Option<Pair>,
        constant: Sum,
        environment: Environment,
    ) -> Option<()> {
        let mut ends = Vec::new();
        for id in [Some(from), to].into_iter().flatten() {
            let path = self.check.tree.end(id).part();
            let part = self.check.part(path, environment).ok()?;
            ends.push(self.end(id, part, environment));
        }
        self.written.inputs.push(WrittenInput { ends, along, constant, rotation: None });
        Some(())
    }

    /// An input for each component.
    fn unbalance(&mut self, end: EndId, fields: Fields, environment: Environment) -> Option<()> {
        let InputKind::Unbalance { clockwise, .. } = self.check.scene.inputs.get(self.written.inputs.len())?.kind
        else {
            return None;
        };
        let rotation = WrittenRotation {
            unbalance: self.field_number(fields, "me", environment)?,
            speed: self.speed(fields, environment),
            clockwise: clockwise != self.check.reverses(environment).ok()?,
        };
        for axis in [[Sum::one(), Sum::ZERO], [Sum::ZERO, Sum::one()]] {
            let along = Some(self.rotate_to_scene(axis, environment));
            self.push_input((end, None), along, Sum::ZERO, environment)?;
            self.written.inputs.last_mut()?.rotation = Some(rotation.clone());
        }
        Some(())
    }

    /// An angular frequency in rad/s, converted if the model gives one in Hz.
    fn speed(&mut self, fields: Fields, environment: Environment) -> Option<Sum> {
        let Some(FieldValue::Expr(expr)) = self.field(fields, "speed") else { return None };
        let written = self.number(expr, environment);
        let Ok(Value::Scalar(Scalar { quantity, .. })) = self.check.evaluate(expr, environment) else { return None };
        Some(match quantity.angle {
            Angle::Cycles => (&Sum::pi() * &written).scale(&Rational::from(2)),
            _ => written,
        })
    }

    /// The constant part of a signal.
    fn constant(&mut self, signal: Option<ExprId>, environment: Environment) -> Sum {
        let Some(expr) = signal else { return Sum::ZERO };
        let tree = self.check.tree;
        let node = *tree.expr(expr);
        match node.kind {
            ExprKind::Binary { operator: Binary::Add, left, right } => {
                &self.constant(Some(left), environment) + &self.constant(Some(right), environment)
            }
            ExprKind::Call { name_len, arguments } => {
                let word = Span::new(node.span.file(), node.span.start(), node.span.start() + usize::from(name_len));
                match (self.check.sources.slice(word), tree.list(arguments)) {
                    ("constant", &[value]) => self.number(value, environment),
                    _ => Sum::ZERO,
                }
            }
            _ => Sum::ZERO,
        }
    }

    fn settings(&mut self) -> Option<()> {
        for index in 0..self.check.instances.settings.len() {
            let Instance { decl, environment } = self.check.instances.settings[index];
            match decl.kind {
                DeclKind::Gravity { value } => match self.form(value, environment) {
                    Form::Pair(pair) => self.written.gravity = Some(pair),
                    Form::Number(number) => {
                        self.written.gravity = Some([Sum::ZERO, -&number]);
                        self.written.free_fall = Some(number);
                    }
                },
                DeclKind::Rare { .. } => {
                    if let Some(Rare::DampingRayleigh { arguments }) = self.rare(decl.kind) {
                        let &[alpha, beta] = self.check.tree.list(arguments) else { return None };
                        self.written.rayleigh = Some((self.number(alpha, environment), self.number(beta, environment)));
                    }
                }
                _ => {}
            }
        }
        Some(())
    }

    /// The coefficients of a linear combination of motions, from left to right.
    fn terms(&mut self, expr: ExprId, environment: Environment) -> Option<Vec<WrittenTerm>> {
        let tree = self.check.tree;
        if !self.check.has_motion(expr, environment) {
            return Some(Vec::new());
        }
        let scaled = |terms: Vec<WrittenTerm>, by: &Sum| -> Vec<WrittenTerm> {
            terms.into_iter().map(|term| WrittenTerm { coefficient: &term.coefficient * by, ..term }).collect()
        };
        match tree.expr(expr).kind {
            ExprKind::Member { base, member_len, indices } => {
                let (owner, at) = match tree.expr(base).kind {
                    ExprKind::At { base, point } => (base, Some(self.place(point, environment))),
                    _ => (base, None),
                };
                if self.check.expression_part(owner, environment, "body").ok()? == scope::Part::Ground {
                    return Some(Vec::new());
                }
                let word = self.check.sources.slice(tree.member(base, member_len, indices).span);
                let turns = BODY_MOTIONS.iter().any(|known| known.name == word && known.direction == Direction::Turn);
                let is_reversed = turns && self.check.reverses(environment).ok()?;
                let coefficient = if is_reversed { Sum::fraction(-1, 1) } else { Sum::one() };
                Some(vec![WrittenTerm { coefficient, at }])
            }
            ExprKind::Negate { operand } => Some(scaled(self.terms(operand, environment)?, &Sum::fraction(-1, 1))),
            ExprKind::Binary { operator, left, right } => {
                let (a, b) = (self.terms(left, environment)?, self.terms(right, environment)?);
                let is_number = !self.check.has_motion(right, environment);
                Some(match operator {
                    Binary::Add => a.into_iter().chain(b).collect(),
                    Binary::Subtract => a.into_iter().chain(scaled(b, &Sum::fraction(-1, 1))).collect(),
                    Binary::Multiply if is_number => scaled(a, &self.number(right, environment)),
                    Binary::Multiply => scaled(b, &self.number(left, environment)),
                    Binary::Divide => scaled(a, &self.number(right, environment).inverse()?),
                    _ => return None,
                })
            }
            _ => None,
        }
    }

    // ---- Expressions ----

    fn number(&mut self, expr: ExprId, environment: Environment) -> Sum {
        match self.form(expr, environment) {
            Form::Number(number) => number,
            Form::Pair(_) => Sum::ZERO,
        }
    }

    fn pair(&mut self, expr: ExprId, environment: Environment) -> Pair {
        match self.form(expr, environment) {
            Form::Pair(pair) => pair,
            Form::Number(_) => [Sum::ZERO, Sum::ZERO],
        }
    }

    /// A position in the scene.
    fn place(&mut self, expr: ExprId, environment: Environment) -> Pair {
        let local = self.pair(expr, environment);
        let Some(frame) = self.check.environments.frame(environment) else { return local };
        let placed = self.placement(frame).and_then(|lying| lying.scene.place(&local));
        placed.unwrap_or(local)
    }

    /// A direction in the scene.
    fn direction(&mut self, expr: ExprId, environment: Environment) -> Pair {
        let local = self.own_direction(expr, environment);
        self.rotate_to_scene(local, environment)
    }

    fn rotate_to_scene(&mut self, local: Pair, environment: Environment) -> Pair {
        let frame = self.check.environments.frame(environment);
        match frame.and_then(|frame| self.placement(frame)) {
            Some(lying) => lying.scene.direction(&local),
            None => local,
        }
    }

    /// The position and orientation of a component at its place.
    fn placement(&mut self, frame: FrameId) -> Option<Arc<Lying>> {
        let index = frame.0 as usize;
        self.lying.resize(self.check.frames.len(), None);
        if let Some(known) = &self.lying[index] {
            return Some(known.clone());
        }
        let placed = self.check.placed_frame(frame).ok()?;
        let Frame { outer, at, turned, .. } = *self.check.frame(frame);
        let expr = |id: DefinitionId| self.check.definitions[id.0 as usize].expr;
        let (at, turned) = (at.map(expr), turned.map(expr));
        let origin = at.map(|at| self.pair(at, outer));
        let angle = turned.map_or(Sum::ZERO, |turned| self.number(turned, outer));
        let around = WrittenMotion { origin, angle, mirrored: placed.around.mirrored };
        let scene = match self.check.environments.frame(outer) {
            None => around.clone(),
            Some(outer) => {
                let outer = self.placement(outer)?;
                let reverses = outer.scene.mirrored[0] != outer.scene.mirrored[1];
                let angle = if reverses { -&around.angle } else { around.angle.clone() };
                let origin = around.origin.as_ref().and_then(|origin| outer.scene.place(origin));
                WrittenMotion { origin, angle: &outer.scene.angle + &angle, mirrored: placed.scene.mirrored }
            }
        };
        let lying = Arc::new(Lying { around, scene });
        self.lying[index] = Some(lying.clone());
        Some(lying)
    }

    /// `x`, `-y` or a pair, in the axes of the component that it is written in.
    fn own_direction(&mut self, expr: ExprId, environment: Environment) -> Pair {
        let node = *self.check.tree.expr(expr);
        match node.kind {
            ExprKind::Name { .. } if self.check.sources.slice(node.span) == "x" => [Sum::one(), Sum::ZERO],
            ExprKind::Name { .. } if self.check.sources.slice(node.span) == "y" => [Sum::ZERO, Sum::one()],
            ExprKind::Negate { operand } => self.own_direction(operand, environment).map(|part| -&part),
            _ => self.pair(expr, environment),
        }
    }

    fn form(&mut self, expr: ExprId, environment: Environment) -> Form {
        self.depth += 1;
        let walked = if self.depth > MAX_DEPTH { None } else { self.form_of(expr, environment) };
        self.depth -= 1;
        walked.unwrap_or_else(|| self.named_value(expr, environment))
    }

    /// The value that the check finds, as a form if it has one, otherwise as a new name.
    fn named_value(&mut self, expr: ExprId, environment: Environment) -> Form {
        let span = self.check.tree.expr(expr).span;
        match self.check.evaluate(expr, environment) {
            Ok(Value::Scalar(Scalar { quantity, .. })) => {
                Form::Number(self.of_value(&quantity.si, quantity.dimension, span))
            }
            Ok(Value::Vector(vector)) => {
                let dimension = vector.dimension.unwrap_or(Dimension::NONE);
                let parts = [&vector.si.x, &vector.si.y];
                Form::Pair(parts.map(|part| self.of_value(part, dimension, span)))
            }
            Err(Stop::Reported | Stop::Deep) => Form::Number(Sum::ZERO),
        }
    }

    fn of_value(&mut self, value: &Number, dimension: Dimension, span: Span) -> Sum {
        match value {
            Number::Exact(exact) => Sum::number(exact.clone()),
            Number::Pi(pi) => match (pi.factor().exact(), Sum::pi().power(pi.power())) {
                (Some(factor), Some(power)) => power.scale(factor),
                _ => self.named_number(value, dimension, span),
            },
            Number::Surd(_) | Number::Ball(_) | Number::Jet(_) => self.named_number(value, dimension, span),
        }
    }

    /// A new name for a number that has no form.
    fn named_number(&mut self, value: &Number, dimension: Dimension, span: Span) -> Sum {
        let place = self.known.len() + self.written.names.len();
        let symbol = Symbol::new(class_of(dimension), place);
        let count = self.written.names.iter().filter(|name| name.source.is_some()).count();
        let (text, source) = (format!("c_{}", count + 1), Some(self.check.sources.slice(span).to_string()));
        let value = value.clone();
        self.written.names.push(Named { symbol, text, value, dimension, definition: None, source });
        Sum::name(symbol)
    }

    fn form_of(&mut self, expr: ExprId, environment: Environment) -> Option<Form> {
        let node = *self.check.tree.expr(expr);
        match node.kind {
            ExprKind::Literal { .. } => None,
            ExprKind::Name { indices } => self.by_name(node.span, indices, environment),
            ExprKind::Negate { operand } => {
                if matches!(self.check.tree.expr(operand).kind, ExprKind::Literal { .. }) {
                    return None;
                }
                Some(match self.form(operand, environment) {
                    Form::Number(number) => Form::Number(-&number),
                    Form::Pair(pair) => Form::Pair(pair.map(|part| -&part)),
                })
            }
            ExprKind::Binary { operator, left, right } => self.binary(operator, left, right, environment),
            ExprKind::Call { name_len, arguments } => self.call(node.span, name_len, arguments, environment),
            ExprKind::Tuple { items } => {
                let &[x, y] = self.check.tree.list(items) else { return None };
                Some(Form::Pair([self.number(x, environment), self.number(y, environment)]))
            }
            ExprKind::Member { base, member_len, indices } => {
                let frame = self.check.place_at(base, environment).ok()??;
                let member = self.check.tree.member(base, member_len, indices);
                let DefinitionId(id) = self.check.member_definition(frame, member, environment).ok()?;
                match self.definition(id as usize)? {
                    Form::Pair(place) => self.seen_from(frame, place, environment).map(Form::Pair),
                    number => Some(number),
                }
            }
            ExprKind::At { .. } | ExprKind::Text | ExprKind::Named { .. } | ExprKind::Range { .. } => None,
        }
    }

    /// A place of a component as it is seen from an environment around it.
    fn seen_from(&mut self, mut frame: FrameId, mut place: Pair, environment: Environment) -> Option<Pair> {
        let viewer = self.check.environments.frame(environment);
        if viewer.is_none() {
            return self.placement(frame)?.scene.place(&place);
        }
        loop {
            place = self.placement(frame)?.around.place(&place)?;
            match self.check.environments.frame(self.check.frame(frame).outer) {
                Some(outer) if Some(outer) != viewer => frame = outer,
                _ => return Some(place),
            }
        }
    }

    fn by_name(&mut self, span: Span, indices: ExprList, environment: Environment) -> Option<Form> {
        let word = if indices.is_empty() { span } else { self.check.word_of(span) };
        if indices.is_empty() && self.check.sources.slice(word) == "pi" {
            return Some(Form::Number(Sum::pi()));
        }
        let symbol = self.check.words.get(self.check.sources.slice(word))?;
        if indices.is_empty()
            && let Some(index) = self.check.environments.value(environment, symbol)
        {
            return Some(Form::Number(Sum::number(Rational::from(i64::from(index)))));
        }
        let name = self.check.evaluate_indexed(symbol, indices, environment).ok()?;
        let DefinitionId(id) = self.check.values.get(name)?;
        self.definition(id as usize)
    }

    /// The name of a number, or the components of a point.
    fn definition(&mut self, index: usize) -> Option<Form> {
        if let Some(known) = &self.known[index] {
            return Some(known.clone());
        }
        let definition = &self.check.definitions[index];
        let State::Settled(Ok(value)) = &definition.state else { return None };
        let (kind, name, expr, environment) =
            (definition.kind, definition.name, definition.expr, definition.environment);
        if definition.role == Role::Placing {
            return None;
        }
        let form = match value.clone() {
            Value::Scalar(Scalar { quantity, .. }) => {
                let symbol = Symbol::new(class_of(quantity.dimension), index);
                let text = self.check.words.display(name);
                let definition = match kind {
                    DefinitionKind::Let => Some(self.number(expr, environment)),
                    DefinitionKind::Param | DefinitionKind::Point => None,
                };
                let (value, dimension) = (quantity.si, quantity.dimension);
                self.written.names.push(Named { symbol, text, value, dimension, definition, source: None });
                Form::Number(Sum::name(symbol))
            }
            Value::Vector(_) => Form::Pair(self.pair(expr, environment)),
        };
        self.known[index] = Some(form.clone());
        Some(form)
    }

    fn binary(&mut self, operator: Binary, left: ExprId, right: ExprId, environment: Environment) -> Option<Form> {
        if operator == Binary::Power {
            return self.power(left, right, environment);
        }
        let (a, b) = (self.form(left, environment), self.form(right, environment));
        Some(match (operator, a, b) {
            (Binary::Add, Form::Number(a), Form::Number(b)) => Form::Number(&a + &b),
            (Binary::Add, Form::Pair(a), Form::Pair(b)) => Form::Pair(sum(&a, &b)),
            (Binary::Subtract, Form::Number(a), Form::Number(b)) => Form::Number(&a - &b),
            (Binary::Subtract, Form::Pair(a), Form::Pair(b)) => Form::Pair(difference(&a, &b)),
            (Binary::Multiply, Form::Number(a), Form::Number(b)) => Form::Number(&a * &b),
            (Binary::Multiply, Form::Pair(pair), Form::Number(by))
            | (Binary::Multiply, Form::Number(by), Form::Pair(pair)) => Form::Pair(pair.map(|part| &part * &by)),
            (Binary::Divide, Form::Number(a), Form::Number(b)) => Form::Number(a.over(&b)?),
            (Binary::Divide, Form::Pair(pair), Form::Number(by)) => {
                let inverse = by.inverse()?;
                Form::Pair(pair.map(|part| &part * &inverse))
            }
            _ => return None,
        })
    }

    fn power(&mut self, left: ExprId, right: ExprId, environment: Environment) -> Option<Form> {
        /// Highest power that is multiplied out.
        const MOST: i64 = 8;
        let (base, exponent) = (self.number(left, environment), self.number(right, environment));
        let Some(twice) = exponent.as_number().and_then(|n| (&n + &n).to_i64()).filter(|twice| twice.abs() <= 2 * MOST)
        else {
            return Some(Form::Number(call(Function::Power, [base, exponent].into())));
        };
        let of = if twice % 2 == 0 { base } else { base.root() };
        let exponent = if twice % 2 == 0 { twice / 2 } else { twice };
        Some(Form::Number(of.power(exponent as i32)?))
    }

    fn call(&mut self, span: Span, name_len: u16, arguments: ExprList, environment: Environment) -> Option<Form> {
        let word = Span::new(span.file(), span.start(), span.start() + usize::from(name_len));
        let name = self.check.sources.slice(word);
        let given: Vec<ExprId> = self.check.tree.list(arguments).to_vec();
        let values: Vec<Sum> = given.iter().map(|argument| self.number(*argument, environment)).collect();
        let first = values.first()?;
        Some(Form::Number(match name {
            "sqrt" => first.root(),
            "sin" => first.sine(),
            "cos" => first.cosine(),
            _ => call(Function::function_by_name(name)?, values.into()),
        }))
    }
}

/// The word that a law of this kind is over.
fn law_variable(kind: &Kind) -> Option<&'static str> {
    kind.fields.iter().find_map(|field| match field.takes {
        Takes::Law(word) => Some(word),
        _ => None,
    })
}

fn call(function: Function, arguments: Arc<[Sum]>) -> Sum {
    Sum::term(crate::symbols::Product::of(Factor::Call(function, arguments), 1), Rational::ONE)
}

/// I - m d^2.
fn about_centre(given: Sum, about: &Pair, mass: Option<&Sum>, centre: Option<&Pair>) -> Sum {
    let (Some(mass), Some(centre)) = (mass, centre) else { return given };
    let d = difference(centre, about);
    &given - &(mass * &dot(&d, &d))
}

pub fn sum(a: &Pair, b: &Pair) -> Pair {
    [&a[0] + &b[0], &a[1] + &b[1]]
}

pub fn difference(a: &Pair, b: &Pair) -> Pair {
    [&a[0] - &b[0], &a[1] - &b[1]]
}

pub fn dot(a: &Pair, b: &Pair) -> Sum {
    &(&a[0] * &b[0]) + &(&a[1] * &b[1])
}
