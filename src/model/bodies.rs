//! Bodies and bases: mass, place, inertia, freedom clause. In: the fields of a body. Out: a [`Body`] whose inertia is
//! about its centre. See spec.md and docs/method/kinematics.md.

use super::Check;
use super::error::{PartError, ValueError};
use super::evaluate::{Evaluated, Stop};
use super::expect::Expected;
use super::fields::Given;
use super::scene::{Base, BaseId, Body, BodyId, Freedom, Matter, Part, Shape, Translation};
use super::scope::{Environment, Instance};
use super::suggestion::nearest;
use crate::base::field::place;
use crate::base::{Dimension, Name, Number, Rational, Span, Vec3};
use crate::kinds::declarations::{BASE_FIELDS, BODY_FIELDS};
use crate::kinds::functions::{self, SHAPES};
use crate::syntax::tree::{DeclKind, ExprId, ExprKind, Field, FieldValue, Rare};
use std::sync::Arc;

const MASS: usize = place(&BODY_FIELDS, "mass");
const MOVES: usize = place(&BODY_FIELDS, "moves");
const AT: usize = place(&BODY_FIELDS, "at");
const SHAPE: usize = place(&BODY_FIELDS, "shape");
const TURNS: usize = place(&BODY_FIELDS, "turns");
const INERTIA: usize = place(&BODY_FIELDS, "inertia");
const FREE: usize = place(&BODY_FIELDS, "free");

const BASE_MOVES: usize = place(&BASE_FIELDS, "moves");
const BASE_AT: usize = place(&BASE_FIELDS, "at");
const BASE_TURNS: usize = place(&BASE_FIELDS, "turns");

const LENGTH: Expected = Expected::new("a length", Dimension::LENGTH, "0.3 m");

/// The properties of a body that follow from its shape.
struct Shaped {
    shape: Shape,
    /// The centre of the shape; `None` if `at` gives it.
    centre: Option<Arc<Vec3>>,
    /// Inertia about the centre per mass, m^2.
    gyration: Number,
}

/// The axes and the most common freedom clauses, made once and shared.
#[derive(Clone, Debug)]
pub struct Directions {
    x_axis: Arc<Vec3>,
    y_axis: Arc<Vec3>,
    none: Arc<Vec<Translation>>,
    x: Arc<Vec<Translation>>,
    y: Arc<Vec<Translation>>,
    x_y: Arc<Vec<Translation>>,
}

impl Default for Directions {
    fn default() -> Directions {
        let x = Translation { direction: Vec3::X, motion: "x" };
        let y = Translation { direction: Vec3::Y, motion: "y" };
        Directions {
            x_axis: Arc::new(Vec3::X),
            y_axis: Arc::new(Vec3::Y),
            none: Arc::default(),
            x: Arc::new(vec![x.clone()]),
            y: Arc::new(vec![y.clone()]),
            x_y: Arc::new(vec![x, y]),
        }
    }
}

impl Directions {
    /// A direction; an axis is shared.
    pub fn share(&self, direction: &Vec3) -> Arc<Vec3> {
        if *direction == Vec3::X {
            self.x_axis.clone()
        } else if *direction == Vec3::Y {
            self.y_axis.clone()
        } else {
            Arc::new(direction.clone())
        }
    }
}

impl<'a> Check<'a> {
    pub fn bodies(&mut self) {
        self.scene.bodies.reserve_exact(self.instances.bodies.len());
        // Each is in its body from here on.
        let names = std::mem::take(&mut self.instances.body_names);
        for index in 0..self.instances.bodies.len() {
            let name = names.at(index);
            let Instance { decl, environment } = self.instances.bodies[index];
            let DeclKind::Body { name: ident, fields } = decl.kind else { continue };
            self.walk.varies = false;
            let given = self.fields(fields, &BODY_FIELDS, environment);
            let (mut matter, mut centre) = (Matter::default(), None);
            let complete = self.matter(name, (&mut matter, &mut centre), &given, environment);
            if complete.is_err() || given.broken {
                self.broken_bodies.insert(BodyId(index as u32));
            }
            let matter = self.recent_matters.share(matter);
            self.scene.bodies.push(Body { name, span: ident.span, centre, matter });
        }
    }

    /// Fills in the values of the fields, and reports all mistakes in them.
    fn matter(
        &mut self,
        name: Name,
        (body, centre): (&mut Matter, &mut Option<Arc<Vec3>>),
        given: &Given<'a>,
        environment: Environment,
    ) -> Evaluated<()> {
        let mass = self.field_number(given.get(MASS), environment, &BODY_FIELDS[MASS].expected_number(false));
        let at = self.field_position(given.get(AT), environment);
        let freedom = self.freedom(given, environment);
        let shape = self.shape(given, environment);
        let inertia = self.inertia(given.get(INERTIA), environment);
        body.freedom = freedom?;
        let (at, shape) = (at?, shape?);
        body.shape = shape.as_ref().map(|shaped| Arc::new(shaped.shape.clone()));
        *centre = at.clone().or_else(|| shape.as_ref().and_then(|shape| shape.centre.clone()));
        if let Some((mass, span)) = mass? {
            self.not_negative(&mass, span, "mass", environment)?;
            body.mass = Some(mass);
        }
        let inertia = inertia?;
        if let (None, Some(about)) = (&body.mass, inertia.as_ref().and_then(|inertia| inertia.about.clone())) {
            self.inertia_points.insert(BodyId(self.scene.bodies.len() as u32), about);
        }
        let inertia = match (inertia, &shape) {
            (Some(inertia), _) => {
                let mass = body.mass.as_ref();
                Some(self.inertia_about_centre(name, (mass, centre.as_deref()), inertia, environment)?)
            }
            (None, Some(shape)) => body.mass.as_ref().map(|mass| mass * &shape.gyration),
            (None, None) => None,
        };
        body.inertia = inertia.map(Box::new);
        Ok(())
    }

    fn not_negative(
        &mut self,
        number: &Number,
        span: Span,
        what: &'static str,
        environment: Environment,
    ) -> Evaluated<()> {
        if number.is_negative() {
            return self.fail(environment, ValueError::Negative { span, what });
        }
        Ok(())
    }

    fn field_position(&mut self, field: Option<&Field>, environment: Environment) -> Evaluated<Option<Arc<Vec3>>> {
        let Some(field) = field else { return Ok(None) };
        let expr = self.field_expr(field, environment)?;
        self.position(expr, environment).map(Some)
    }

    /// `inertia = I about P`: the number, if it is given, and P.
    fn inertia(&mut self, field: Option<&Field>, environment: Environment) -> Evaluated<Option<GivenInertia>> {
        let Some(field) = field else { return Ok(None) };
        let (expr, about) = match field.value {
            FieldValue::About(list) => {
                let (expr, about) = self.tree.about_parts(list);
                (expr, Some(about))
            }
            _ => (self.field_expr(field, environment)?, None),
        };
        let number = self.number(expr, environment, &BODY_FIELDS[INERTIA].expected_number(false))?;
        let span = self.tree.expr(expr).span;
        self.not_negative(&number, span, "inertia", environment)?;
        let about = about.map(|about| self.position(about, environment)).transpose()?;
        Ok(Some(GivenInertia { number, about, span }))
    }

    /// I - m d^2, where d is the distance from the centre to the point that the inertia is given about (Steiner's
    /// theorem).
    fn inertia_about_centre(
        &mut self,
        name: Name,
        (mass, centre): (Option<&Number>, Option<&Vec3>),
        given: GivenInertia,
        environment: Environment,
    ) -> Evaluated<Number> {
        let Some(about) = given.about else { return Ok(given.number) };
        let Some(mass) = mass else { return Ok(given.number) };
        let Some(centre) = centre else {
            let name = self.words.display(name);
            return self.fail(environment, PartError::InertiaWithoutPlace { span: given.span, name });
        };
        let d = centre.sub(&about);
        let of_the_mass = mass * &d.dot(&d);
        let own = &given.number - &of_the_mass;
        if own.is_negative() {
            let (least, given_value) = (of_the_mass.to_f64(), given.number.to_f64());
            return self.fail(environment, PartError::InertiaTooSmall { span: given.span, least, given: given_value });
        }
        Ok(own)
    }

    /// `shape = rod(A, B)`, `disk(r)`, `ring(r)`, `box(w, h)`; rejects fields that must not accompany it.
    fn shape(&mut self, given: &Given<'a>, environment: Environment) -> Evaluated<Option<Shaped>> {
        let Some(field) = given.get(SHAPE) else { return Ok(None) };
        if let Some(inertia) = given.get(INERTIA) {
            let error = PartError::GivenTwice { span: inertia.key, other: field.key, what: "the inertia" };
            return self.fail(environment, error);
        }
        let expr = self.field_expr(field, environment)?;
        let shape = self.shape_of(expr, environment)?;
        if let (Some(at), Some(_)) = (given.get(AT), &shape.centre) {
            return self
                .fail(environment, PartError::GivenTwice { span: at.key, other: field.key, what: "the position" });
        }
        Ok(Some(shape))
    }

    fn shape_of(&mut self, expr: ExprId, environment: Environment) -> Evaluated<Shaped> {
        let tree = self.tree;
        let node = *tree.expr(expr);
        let ExprKind::Call { name_len, arguments } = node.kind else {
            return self.fail(environment, PartError::UnknownShape { span: node.span, suggestion: None });
        };
        let word = Span::new(node.span.file(), node.span.start(), node.span.start() + usize::from(name_len));
        let name = self.sources.slice(word);
        let Some(shape) = functions::by_name(SHAPES, name) else {
            let suggestion = nearest(name, SHAPES.iter().map(|shape| shape.function.name));
            return self.fail(environment, PartError::UnknownShape { span: word, suggestion });
        };
        match (shape.kind, tree.list(arguments)) {
            (functions::Shape::Rod, &[a, b]) => self.rod(a, b, environment),
            (functions::Shape::Disk, &[radius]) => {
                self.round(radius, Rational::new(1, 2), |radius| Shape::Disk { radius }, environment)
            }
            (functions::Shape::Ring, &[radius]) => {
                self.round(radius, Rational::ONE, |radius| Shape::Ring { radius }, environment)
            }
            (functions::Shape::Box, &[width, height]) => self.rectangle(width, height, environment),
            (_, given) => {
                let (function, expected) = (shape.function.name, shape.function.arguments.len());
                let found = given.len();
                self.fail(environment, ValueError::ArgumentCount { span: node.span, function, expected, found })
            }
        }
    }

    /// A slender rod between two points: inertia m L^2 / 12 about its middle.
    fn rod(&mut self, a: ExprId, b: ExprId, environment: Environment) -> Evaluated<Shaped> {
        let first = self.position(a, environment);
        let second = self.position(b, environment)?;
        let first = first?;
        let along = second.sub(&first);
        if along.may_be_zero() {
            let span = self.tree.expr(a).span.to(self.tree.expr(b).span);
            return self.fail(environment, PartError::ShapeSize { span, what: "a rod needs two different ends" });
        }
        let half = Number::from(Rational::new(1, 2));
        let gyration = &along.dot(&along) * &Number::from(Rational::new(1, 12));
        let centre = Some(Arc::new(first.add(&second).scale(&half)));
        Ok(Shaped { shape: Shape::Rod { ends: [(*first).clone(), (*second).clone()] }, centre, gyration })
    }

    /// A disk (inertia m r^2 / 2) or ring (m r^2) about its axis.
    fn round(
        &mut self,
        radius: ExprId,
        factor: Rational,
        shape: fn(Number) -> Shape,
        environment: Environment,
    ) -> Evaluated<Shaped> {
        let radius = self.size(radius, environment)?;
        let gyration = &radius.square() * &Number::from(factor);
        Ok(Shaped { shape: shape(radius), centre: None, gyration })
    }

    /// A rectangle: inertia m (w^2 + h^2) / 12 about its middle.
    fn rectangle(&mut self, width: ExprId, height: ExprId, environment: Environment) -> Evaluated<Shaped> {
        let width = self.size(width, environment);
        let height = self.size(height, environment)?;
        let width = width?;
        let gyration = &(&width.square() + &height.square()) * &Number::from(Rational::new(1, 12));
        let along = self.rotate_to_scene(self.directions.x_axis.clone(), environment)?;
        Ok(Shaped { shape: Shape::Box { width, height, along }, centre: None, gyration })
    }

    fn size(&mut self, expr: ExprId, environment: Environment) -> Evaluated<Number> {
        let length = self.number(expr, environment, &LENGTH)?;
        if length.is_positive() {
            return Ok(length);
        }
        let span = self.tree.expr(expr).span;
        self.fail(environment, PartError::ShapeSize { span, what: "the size of a shape is greater than zero" })
    }

    /// The freedom clause: `moves ...`, `turns`, both, or `free`.
    fn freedom(&mut self, given: &Given<'a>, environment: Environment) -> Evaluated<Freedom> {
        let free = self.flag(given.get(FREE), environment);
        let turns = self.flag(given.get(TURNS), environment);
        let translations = self.translations(given.get(MOVES), environment, Lines::OfBody)?;
        let (free, turns) = (free?, turns?);
        if free {
            let other = given.get(MOVES).or(given.get(TURNS));
            if let (Some(other), Some(free)) = (other, given.get(FREE)) {
                return self.fail(environment, PartError::FreeAndMore { span: other.key, free: free.key });
            }
            return Ok(Freedom::OnGround { translations: self.directions.x_y.clone(), turns: true });
        }
        Ok(match (translations, turns) {
            (None, false) => Freedom::FromJoints,
            (translations, turns) => {
                let translations = translations.unwrap_or_else(|| self.directions.none.clone());
                Freedom::OnGround { translations, turns }
            }
        })
    }

    /// The directions along which a body moves in the scene. A body that moves along both axes of a turned component moves along
    /// both axes of the scene; a line parallel to the scene's x or y is that axis.
    fn translations(
        &mut self,
        field: Option<&'a Field>,
        environment: Environment,
        lines: Lines,
    ) -> Evaluated<Option<Arc<Vec<Translation>>>> {
        let own = self.own_translations(field, environment)?;
        let (Some(own), Some(placed)) = (&own, self.placement(environment)?) else { return Ok(own) };
        let [one] = &own[..] else { return Ok(Some(own.clone())) };
        if placed.scene.keeps_directions() {
            return Ok(Some(own.clone()));
        }
        let turned = placed.scene.direction(&one.direction);
        let is = |axis: &Vec3| turned == *axis;
        // A body moves in both directions; in the component, words about it refer to the direction written there.
        let is_reversed =
            |axis: &Vec3| lines == Lines::OfBody && one.motion != "along" && turned == axis.scale(&Number::from(-1));
        if is_reversed(&Vec3::X) || is_reversed(&Vec3::Y) {
            self.reversed.insert(BodyId(self.scene.bodies.len() as u32));
        }
        Ok(Some(if is(&Vec3::X) || is_reversed(&Vec3::X) {
            self.directions.x.clone()
        } else if is(&Vec3::Y) || is_reversed(&Vec3::Y) {
            self.directions.y.clone()
        } else {
            Arc::new(vec![Translation { direction: turned, motion: "along" }])
        }))
    }

    /// The line of a part as its own component sees it: a force on it is positive in the component's own axes.
    pub fn own_line(&self, line: Arc<Vec3>, part: Part, environment: Environment) -> Arc<Vec3> {
        let Part::Body(id) = part else { return line };
        let frame = |environment| self.environments.frame(environment);
        let is_own = || frame(self.instances.bodies[id.index()].environment) == frame(environment);
        if self.reversed.contains(&id) && is_own() { Arc::new(line.scale(&Number::from(-1))) } else { line }
    }

    /// `moves x`, `moves x y`, `moves along (1, 1)`, in a component's own axes.
    fn own_translations(
        &mut self,
        field: Option<&'a Field>,
        environment: Environment,
    ) -> Evaluated<Option<Arc<Vec<Translation>>>> {
        let Some(field) = field else { return Ok(None) };
        if let FieldValue::MovesAlong(expr) = field.value {
            return self.oblique(expr, environment).map(Some);
        }
        let Some(span) = field.directions() else {
            return self.fail(environment, PartError::MovesWhere { span: field.key });
        };
        let text = self.sources.slice(span);
        match text {
            "x" => return Ok(Some(self.directions.x.clone())),
            "y" => return Ok(Some(self.directions.y.clone())),
            _ => {}
        }
        let texts: Vec<&str> = text.split_ascii_whitespace().collect();
        match texts[..] {
            ["x", "y"] | ["y", "x"] => Ok(Some(self.directions.x_y.clone())),
            _ => {
                let is_rotation = |text: &&str| matches!(*text, "angle" | "turns" | "theta" | "rotation");
                let (rotations, others): (Vec<&str>, Vec<&str>) = texts.iter().partition(|text| is_rotation(text));
                match (&rotations[..], &others[..]) {
                    ([_], ["x"] | ["y"] | ["x", "y"] | ["y", "x"]) => {
                        self.fail(environment, PartError::MovesAndTurns { span, translations: others.join(" ") })
                    }
                    _ => self.fail(environment, PartError::MovesWhere { span }),
                }
            }
        }
    }

    fn oblique(&mut self, expr: ExprId, environment: Environment) -> Evaluated<Arc<Vec<Translation>>> {
        let direction = self.own_direction(expr, environment)?;
        Ok(if *direction == Vec3::X {
            self.directions.x.clone()
        } else if *direction == Vec3::Y {
            self.directions.y.clone()
        } else {
            Arc::new(vec![Translation { direction: (*direction).clone(), motion: "along" }])
        })
    }

    pub fn bases(&mut self) {
        for index in 0..self.instances.bases.len() {
            let Instance { decl, environment } = self.instances.bases[index];
            let base = self.base(decl.kind, environment);
            let DeclKind::Rare { index: rare } = decl.kind else { continue };
            let Rare::Base { name: ident, .. } = self.tree.rare[rare as usize] else { continue };
            let base = base.unwrap_or_else(|_| {
                self.broken_bases.insert(BaseId(index as u32));
                let symbol = self.words.intern(self.sources.slice(ident.span));
                let name = Name::plain(symbol).in_place(self.place_of(environment));
                Base { name, span: ident.span, at: None, translations: self.directions.none.clone(), turns: false }
            });
            self.scene.bases.push(base);
        }
    }

    fn base(&mut self, decl: DeclKind, environment: Environment) -> Evaluated<Base> {
        let DeclKind::Rare { index } = decl else { return Err(Stop::Reported) };
        let Rare::Base { name: ident, fields, .. } = self.tree.rare[index as usize] else { return Err(Stop::Reported) };
        self.walk.varies = false;
        let name = self.name(ident, environment)?;
        let given = self.fields(fields, &BASE_FIELDS, environment);
        let at = self.field_position(given.get(BASE_AT), environment);
        let turns = self.flag(given.get(BASE_TURNS), environment);
        let translations = self.translations(given.get(BASE_MOVES), environment, Lines::OfBase)?;
        let (at, turns) = (at?, turns?);
        if given.broken {
            return Err(Stop::Reported);
        }
        if translations.is_none() && !turns {
            let name = self.words.display(name);
            return self.fail(environment, PartError::BaseWithoutMotion { span: ident.span, name });
        }
        let translations = translations.unwrap_or_else(|| self.directions.none.clone());
        Ok(Base { name, span: ident.span, at, translations, turns })
    }
}

/// Whether a line has a positive sense: a base moves as prescribed, a body in either direction.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Lines {
    OfBody,
    OfBase,
}

/// An inertia as written.
struct GivenInertia {
    number: Number,
    about: Option<Arc<Vec3>>,
    span: Span,
}
