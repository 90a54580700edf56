//! Elements: law and geometry. In: two ends and the fields. Out: an [`Element`] that acts along the line between its
//! points, along a direction, or on the rotation. See spec.md.

use super::Check;
use super::ends::are_apart;
use super::error::{LawError, NameError, PartError, ValueError};
use super::evaluate::{Evaluated, Stop};
use super::fields::Given;
use super::freedoms::{Line, are_parallel};
use super::laws;
use super::scene::{Attachment, Element, Geometry, Law, SpringRest};
use super::scope::{Environment, Instance};
use super::value::Value;
use crate::base::{Dimension, Number, Span, Takes, Vec3};
use crate::elements::curve::Undefined;
use crate::elements::kind::ALONG;
use crate::elements::spring::LOSS;
use crate::elements::{Acts, Curve, Kind, Negative, Order};
use crate::syntax::tree::{DeclKind, EndId, Fields, Ident};
use std::sync::Arc;

/// The ends of an element and its law.
type Acting = ([Attachment; 2], Arc<Law>);

/// The coefficient of an element, and the kind of element that its unit implies.
#[derive(Clone, Debug)]
pub struct Coefficient {
    value: Number,
    /// Whether it acts on the rotation, according to its unit.
    torsional: bool,
    /// The span of the field's word; `at` is that of its value.
    key: Span,
    at: Span,
}

/// The coefficient of an element, or its law.
struct Strength {
    coefficient: Coefficient,
    curve: Option<Arc<Curve>>,
}

/// The field with a law.
const LAW: &str = "law";

impl<'a> Check<'a> {
    pub fn elements(&mut self) {
        self.scene.elements.reserve_exact(self.instances.elements.len());
        // After all declared elements, so that these keep their numbers.
        let mut second_spans = Vec::new();
        for index in 0..self.instances.elements.len() {
            let Instance { decl, environment } = self.instances.elements[index];
            let DeclKind::Element { kind, name, ends, fields } = decl.kind else { continue };
            self.walk.varies = false;
            if kind.kind().acts == Acts::RoundDisks {
                match self.belt(kind.kind(), name, ends, fields, environment) {
                    Ok((ends, [law, other])) => {
                        let (name, span) = (self.instances.element_names.at(index), name.span);
                        second_spans.push(Element { name, span, ends: ends.clone(), law: other });
                        self.scene.elements.push(Element { name, span, ends, law });
                    }
                    Err(_) => self.broken_elements = true,
                }
                continue;
            }
            match self.element(kind.kind(), name, ends, fields, environment) {
                Ok((ends, law)) => {
                    let (name, span) = (self.instances.element_names.at(index), name.span);
                    self.scene.elements.push(Element { name, span, ends, law });
                }
                Err(_) => self.broken_elements = true,
            }
        }
        self.scene.elements.extend(second_spans);
    }

    /// A belt: its disks, and the law of each of its two spans.
    fn belt(
        &mut self,
        kind: &'static Kind,
        ident: Ident,
        ends: EndId,
        fields: Fields,
        environment: Environment,
    ) -> Evaluated<([Attachment; 2], [Arc<Law>; 2])> {
        let given = self.fields(fields, kind.fields, environment);
        let spans = self.spans(ends, &given, environment);
        let Coefficient { value, key, at, .. } = self.coefficient(kind, &given, ident, environment)?;
        let rest = self.spring_rest(&given, false, environment)?;
        let (pair, geometries) = spans?;
        if value.is_negative() {
            self.negative_coefficient(kind, key, at, environment)?;
        }
        let law = |geometry| {
            let (coefficient, rest) = (value.clone(), rest.clone());
            Arc::new(Law { kind, geometry, coefficient, rest, curve: None, loss: None })
        };
        Ok((pair, geometries.map(law)))
    }

    fn element(
        &mut self,
        kind: &'static Kind,
        ident: Ident,
        ends: EndId,
        fields: Fields,
        environment: Environment,
    ) -> Evaluated<Acting> {
        let given = self.fields(fields, kind.fields, environment);
        let pair = self.element_ends(ends, environment);
        let Strength { coefficient, curve } = self.strength(kind, &given, ident, environment)?;
        let Coefficient { value, torsional, key, at } = coefficient;
        let torsional = torsional.then_some(at);
        let geometry = pair.and_then(|pair| {
            Ok((
                self.geometry(kind, given.by_name(ALONG.name).map(|along| along.0), &pair, torsional, environment)?,
                pair,
            ))
        });
        // If the unit of the coefficient is the mistake, the other fields are given as lengths: report only that no part
        // turns.
        if let (Some(_), Err(stop)) = (torsional, &geometry) {
            return Err(*stop);
        }
        let rest = self.spring_rest(&given, torsional.is_some(), environment)?;
        let (geometry, mut pair) = geometry?;
        if geometry == Geometry::Torsion && self.reverses(environment)? {
            // Twisted counter-clockwise in a component that is mirrored.
            pair.swap(0, 1);
        }
        if rest != SpringRest::AsDrawn {
            self.drawn_length_is_known(&rest, &geometry, &pair, environment)?;
        }
        let loss = self.loss(&given, environment)?;
        if value.is_negative() {
            self.negative_coefficient(kind, key, at, environment)?;
        }
        let loss = loss.map(Box::new);
        Ok((pair, self.recent_laws.share(Law { kind, geometry, coefficient: value, rest, curve, loss })))
    }

    /// The loss factor of a spring, if it is not zero; other elements have no such field.
    fn loss(&mut self, given: &Given<'a>, environment: Environment) -> Evaluated<Option<Number>> {
        let Some((field, described)) = given.by_name(LOSS.name) else { return Ok(None) };
        let found = self.field_number(Some(field), environment, &described.expected_number(false))?;
        match found {
            Some((loss, span)) if loss.is_negative() => {
                self.fail(environment, ValueError::Negative { span, what: LOSS.name })
            }
            found => Ok(found.map(|(loss, _)| loss).filter(|loss| !loss.is_zero())),
        }
    }

    /// The coefficient of an element, or its law.
    fn strength(
        &mut self,
        kind: &'static Kind,
        given: &Given<'a>,
        ident: Ident,
        environment: Environment,
    ) -> Evaluated<Strength> {
        let Some((field, described)) = given.by_name(LAW) else {
            let coefficient = self.coefficient(kind, given, ident, environment)?;
            return Ok(Strength { coefficient, curve: None });
        };
        let others = [kind.coefficient().name, "preload", LOSS.name];
        if let Some((other, known)) = others.iter().find_map(|name| given.by_name(name)) {
            let word = known.name.to_string();
            return self.fail(environment, LawError::AndAnother { span: field.key, other: other.key, word });
        }
        let Takes::Law(word) = described.takes else { return Err(Stop::Reported) };
        let over = match kind.order {
            Order::Displacement => [Dimension::LENGTH, Dimension::NONE],
            Order::Velocity => [Dimension::VELOCITY, Dimension::ANGULAR_VELOCITY],
            Order::Acceleration => [Dimension::ACCELERATION, Dimension::ANGULAR_ACCELERATION],
        };
        let expr = self.field_expr(field, environment)?;
        let laws::Read { curve, torsional } = self.cache(
            expr,
            environment,
            |memory| &mut memory.laws,
            |check| check.law(expr, &laws::Reading { word, over }, environment),
        )?;
        let at = self.tree.expr(expr).span;
        let value = match kind.order {
            // The tangent is known once the rest is known.
            Order::Displacement => Number::ZERO,
            _ => self.tangent_at_zero(&curve, at, torsional, environment)?,
        };
        let coefficient = Coefficient { value, torsional, key: field.key, at };
        Ok(Strength { coefficient, curve: Some(curve) })
    }

    /// The tangent of a law at zero rate, where a damper has no force.
    fn tangent_at_zero(
        &mut self,
        curve: &Curve,
        span: Span,
        torsional: bool,
        environment: Environment,
    ) -> Evaluated<Number> {
        let at_rest = match curve.at(&Number::ZERO) {
            Ok(at_rest) => at_rest,
            Err(Undefined { span, why }) => return self.fail(environment, LawError::Undefined { span, why }),
        };
        if let Some(span) = curve.kink(&Number::ZERO) {
            return self.fail(environment, LawError::Kink { span });
        }
        if !at_rest.value.may_be_zero() {
            let force = at_rest.value.to_f64();
            return self.fail(environment, LawError::ForceAtRest { span, force, torsional });
        }
        if at_rest.slope.is_zero() {
            self.report(environment, LawError::NoTangent { span });
        }
        Ok(at_rest.slope)
    }

    /// Reports a negative coefficient: as a note, or as an error if the kind refuses it.
    fn negative_coefficient(
        &mut self,
        kind: &'static Kind,
        key: Span,
        at: Span,
        environment: Environment,
    ) -> Evaluated<()> {
        match kind.negative {
            Negative::Noted(code, message) => {
                self.report(environment, PartError::NegativeCoefficient { span: key, code, message });
                Ok(())
            }
            Negative::Refused => {
                self.fail(environment, ValueError::Negative { span: at, what: kind.coefficient().name })
            }
        }
    }

    /// The ends, which must be two different parts.
    fn element_ends(&mut self, ends: EndId, environment: Environment) -> Evaluated<[Attachment; 2]> {
        let pair = self.attachments(ends, environment)?;
        if pair[0].part == pair[1].part {
            let (span, part) = (pair[0].span.to(pair[1].span), self.part_name(pair[0].part));
            return self.fail(environment, PartError::EqualEnds { span, part });
        }
        self.require_unbroken(&pair)?;
        Ok(pair)
    }

    /// The coefficient, whose dimension decides whether the element is torsional.
    fn coefficient(
        &mut self,
        kind: &'static Kind,
        given: &Given<'a>,
        ident: Ident,
        environment: Environment,
    ) -> Evaluated<Coefficient> {
        let described = kind.coefficient();
        let (line, turn) = (described.expected_number(false), described.expected_number(true));
        let Some(field) = given.get(0) else {
            if given.broken {
                return Err(Stop::Reported);
            }
            return self.fail(environment, NameError::FieldMissing { span: ident.span, expected: line });
        };
        let expr = self.field_expr(field, environment)?;
        let (key, at) = (field.key, self.tree.expr(expr).span);
        self.cache(
            expr,
            environment,
            |memory| &mut memory.coefficients,
            |check| {
                let value = check.evaluate(expr, environment)?;
                let torsional = matches!(&value, Value::Scalar(scalar) if scalar.dimension() == Some(turn.dimension));
                let expected = if torsional { &turn } else { &line };
                let value = check.as_number(&value, expr, environment, expected)?;
                Ok(Coefficient { value, torsional, key, at })
            },
        )
    }

    /// The tension of a spring as drawn, according to its fields; other elements have no such fields.
    fn spring_rest(&mut self, given: &Given<'a>, torsional: bool, environment: Environment) -> Evaluated<SpringRest> {
        let (free, preload) = (given.by_name("free_length"), given.by_name("preload"));
        if let (Some((free, _)), Some((preload, _))) = (free, preload) {
            return self.fail(environment, PartError::FreeLengthAndPreload { span: preload.key, free: free.key });
        }
        if let Some((field, described)) = free
            && let Some((length, span)) =
                self.field_number(Some(field), environment, &described.expected_number(torsional))?
        {
            if !torsional && length.is_negative() {
                return self.fail(environment, ValueError::Negative { span, what: "free_length" });
            }
            return Ok(SpringRest::FreeLength(length));
        }
        let Some((field, described)) = preload else { return Ok(SpringRest::AsDrawn) };
        let tension = self.field_number(Some(field), environment, &described.expected_number(torsional))?;
        Ok(tension.map_or(SpringRest::AsDrawn, |(tension, _)| SpringRest::Preload(tension)))
    }

    fn geometry(
        &mut self,
        kind: &'static Kind,
        along: Option<&crate::syntax::tree::Field>,
        pair: &[Attachment; 2],
        torsional: Option<Span>,
        environment: Environment,
    ) -> Evaluated<Geometry> {
        let direction = match along {
            None => None,
            Some(field) => {
                let expr = self.field_expr(field, environment)?;
                Some(self.direction(expr, environment)?)
            }
        };
        match (torsional, direction) {
            (Some(_), Some(_)) => {
                let span = along.map_or(pair[0].span, |field| field.key);
                self.fail(environment, PartError::DirectionOfTorsion { span, kind })
            }
            (Some(_), None) if pair.iter().any(|end| self.can_turn(end.part)) => Ok(Geometry::Torsion),
            (Some(_), None) if self.broken_joints => Err(Stop::Reported),
            (Some(unit), None) => {
                let span = pair[0].span.to(pair[1].span);
                self.fail(environment, PartError::NoEndTurns { span, torsional: Some((unit, kind)) })
            }
            (None, Some(direction)) => Ok(Geometry::Along(direction)),
            (None, None) => self.line_or_direction(pair, environment),
        }
    }

    /// The line between two points, or the line along which both parts move.
    pub fn line_or_direction(&mut self, pair: &[Attachment; 2], environment: Environment) -> Evaluated<Geometry> {
        let places = (&pair[0].at, &pair[1].at);
        if let (Some(a), Some(b)) = places
            && are_apart(a, b)
        {
            return Ok(Geometry::Line);
        }
        if let Some(line) = self.common_line(pair) {
            let part = if self.line(pair[0].part) == Line::Fixed { pair[1].part } else { pair[0].part };
            return Ok(Geometry::Along(self.own_line(line, part, environment)));
        }
        if self.broken_joints {
            return Err(Stop::Reported);
        }
        let span = pair[0].span.to(pair[1].span);
        let error = match places {
            (Some(_), Some(_)) => PartError::ZeroLength { span },
            _ => {
                let without = if pair[0].at.is_none() { 0 } else { 1 };
                PartError::DirectionUnknown { span, part: self.part_name(pair[without].part) }
            }
        };
        self.fail(environment, error)
    }

    /// The line along which both parts move, if it is the same; a fixed part fits any line.
    fn common_line(&self, pair: &[Attachment; 2]) -> Option<Arc<Vec3>> {
        match (self.line(pair[0].part), self.line(pair[1].part)) {
            (Line::Along(a), Line::Along(b)) => are_parallel(&a, &b).then_some(a),
            (Line::Along(line), Line::Fixed) | (Line::Fixed, Line::Along(line)) => Some(line),
            _ => None,
        }
    }

    /// Checks that a spring with a free length has a drawn length to compare it with.
    fn drawn_length_is_known(
        &mut self,
        rest: &SpringRest,
        geometry: &Geometry,
        pair: &[Attachment; 2],
        environment: Environment,
    ) -> Evaluated<()> {
        let placed = pair.iter().all(|end| end.at.is_some());
        if matches!((rest, geometry), (SpringRest::FreeLength(_), Geometry::Along(_))) && !placed {
            let span = pair[0].span.to(pair[1].span);
            return self.fail(environment, PartError::NoDrawnLength { span });
        }
        Ok(())
    }
}
