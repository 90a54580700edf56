//! Springs and dampers: law and geometry. In: two ends and the fields; out: an [`Element`] that says whether it acts along
//! the line of its points, along a direction, or on the rotation. See spec.md.

use super::Check;
use super::ends::are_apart;
use super::error::{NameError, PartError, ValueError};
use super::evaluate::{Evaluated, Stop};
use super::expect::Expected;
use super::fields::Given;
use super::freedoms::{Line, are_parallel};
use super::scene::{Attachment, Element, Geometry, Law, SpringRest};
use super::scope::{Environment, Instance};
use super::value::Value;
use crate::base::{Dimension, Number, Span, Vec3};
use crate::syntax::tree::{DeclKind, ElementKeyword, EndId, Fields, Ident};
use std::sync::Arc;

const SPRING_FIELDS: [&str; 4] = ["k", "along", "free_length", "preload"];
const DAMPER_FIELDS: [&str; 2] = ["c", "along"];
const COEFFICIENT: usize = 0;
const ALONG: usize = 1;
const FREE_LENGTH: usize = 2;
const PRELOAD: usize = 3;

const STIFFNESS: Expected = Expected::new("a stiffness", Dimension::STIFFNESS, "k = 10 N/m");
const DAMPING: Expected = Expected::new("a damping coefficient", Dimension::DAMPING, "c = 5 N*s/m");
const FREE: Expected = Expected::new("a length", Dimension::LENGTH, "free_length = 0.5 m");
const FREE_ANGLE: Expected = Expected::new("an angle", Dimension::NONE, "free_length = 30 deg");
const TENSION: Expected = Expected::new("a force", Dimension::FORCE, "preload = 20 N");
const TWIST: Expected = Expected::new("a torque", Dimension::TORQUE, "preload = 2 N*m");

/// Between what, by what law, and on which motion.
type Acting = ([Attachment; 2], Law, Geometry);

/// Stiffness or damping coefficient with what its unit says.
#[derive(Clone, Debug)]
pub struct Coefficient {
    value: Number,
    /// The value whose unit says that the element acts on the rotation.
    torsional: Option<Span>,
}

impl<'a> Check<'a> {
    pub fn elements(&mut self) {
        self.scene.elements.reserve_exact(self.instances.elements.len());
        for index in 0..self.instances.elements.len() {
            let Instance { decl, environment } = self.instances.elements[index];
            let DeclKind::Element { kind, name, ends, fields } = decl.kind else { continue };
            self.walk.varies = false;
            let element = match kind {
                ElementKeyword::Spring => self.spring(name, ends, fields, environment),
                ElementKeyword::Damper => self.damper(name, ends, fields, environment),
            };
            let element = element.map(|(ends, law, geometry)| {
                let (name, span) = (self.instances.element_names[index], name.span);
                Element { name, span, ends, law, geometry }
            });
            match element {
                Ok(element) => self.scene.elements.push(element),
                Err(_) => self.broken_elements = true,
            }
        }
    }

    fn spring(&mut self, ident: Ident, ends: EndId, fields: Fields, environment: Environment) -> Evaluated<Acting> {
        let given = self.fields(fields, &SPRING_FIELDS, environment);
        let pair = self.element_ends(ends, environment);
        let coefficient = self.coefficient(&given, ident, Dimension::TORSIONAL_STIFFNESS, &STIFFNESS, environment)?;
        let geometry = pair
            .and_then(|pair| Ok((self.geometry(given.get(ALONG), &pair, coefficient.torsional, environment)?, pair)));
        // Where the unit of `k` is the slip, lengths are right: that no part turns is said alone.
        if let (Some(_), Err(stop)) = (coefficient.torsional, &geometry) {
            return Err(*stop);
        }
        let rest = self.spring_rest(&given, coefficient.torsional.is_some(), environment)?;
        let (geometry, pair) = geometry?;
        if rest != SpringRest::AsDrawn {
            self.drawn_length_is_known(&rest, &geometry, &pair, environment)?;
        }
        if coefficient.value.is_negative() {
            let expr = given.get(COEFFICIENT).map_or(ident.span, |field| field.key);
            self.report(environment, PartError::NegativeStiffness { span: expr });
        }
        let law = Law::Spring { stiffness: coefficient.value, rest };
        Ok((pair, law, geometry))
    }

    fn damper(&mut self, ident: Ident, ends: EndId, fields: Fields, environment: Environment) -> Evaluated<Acting> {
        let given = self.fields(fields, &DAMPER_FIELDS, environment);
        let pair = self.element_ends(ends, environment);
        let coefficient = self.coefficient(&given, ident, Dimension::TORSIONAL_DAMPING, &DAMPING, environment)?;
        let pair = pair?;
        let geometry = self.geometry(given.get(ALONG), &pair, coefficient.torsional, environment)?;
        if coefficient.value.is_negative() {
            let span = given.get(COEFFICIENT).map_or(ident.span, |field| field.key);
            self.report(environment, PartError::NegativeDamping { span });
        }
        let law = Law::Damper { damping: coefficient.value };
        Ok((pair, law, geometry))
    }

    /// The ends, which are two different parts.
    fn element_ends(&mut self, ends: EndId, environment: Environment) -> Evaluated<[Attachment; 2]> {
        let pair = self.attachments(ends, environment)?;
        if pair[0].part == pair[1].part {
            let (span, part) = (pair[0].span.to(pair[1].span), self.part_name(pair[0].part));
            return self.fail(environment, PartError::EqualEnds { span, part });
        }
        self.sound(&pair)?;
        Ok(pair)
    }

    /// `k` or `c`: its dimension says whether the element is torsional.
    fn coefficient<const N: usize>(
        &mut self,
        given: &Given<'a, N>,
        ident: Ident,
        torsional: Dimension,
        expected: &Expected,
        environment: Environment,
    ) -> Evaluated<Coefficient> {
        let Some(field) = given.get(COEFFICIENT) else {
            if given.broken {
                return Err(Stop::Reported);
            }
            return self.fail(environment, NameError::FieldMissing { span: ident.span, expected: *expected });
        };
        let expr = self.field_expr(field, environment)?;
        let turns = Expected { dimension: torsional, ..*expected };
        self.remembered(
            expr,
            environment,
            |memory| &mut memory.coefficients,
            |check| {
                let value = check.evaluate(expr, environment)?;
                let is_torsional = matches!(&value, Value::Scalar(scalar) if scalar.dimension() == Some(torsional));
                let expected = if is_torsional { &turns } else { expected };
                let value = check.as_number(&value, expr, environment, expected)?;
                Ok(Coefficient { value, torsional: is_torsional.then(|| check.tree.expr(expr).span) })
            },
        )
    }

    fn spring_rest<const N: usize>(
        &mut self,
        given: &Given<'a, N>,
        torsional: bool,
        environment: Environment,
    ) -> Evaluated<SpringRest> {
        let (free, preload) = (given.get(FREE_LENGTH), given.get(PRELOAD));
        if let (Some(free), Some(preload)) = (free, preload) {
            return self.fail(environment, PartError::FreeLengthAndPreload { span: preload.key, free: free.key });
        }
        let length = if torsional { &FREE_ANGLE } else { &FREE };
        if let Some((length, span)) = self.field_number(free, environment, length)? {
            if !torsional && length.is_negative() {
                return self.fail(environment, ValueError::Negative { span, what: "free_length" });
            }
            return Ok(SpringRest::FreeLength(length));
        }
        let tension = if torsional { &TWIST } else { &TENSION };
        let preload = self.field_number(preload, environment, tension)?;
        Ok(preload.map_or(SpringRest::AsDrawn, |(tension, _)| SpringRest::Preload(tension)))
    }

    fn geometry(
        &mut self,
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
                self.fail(environment, PartError::DirectionOfTorsion { span })
            }
            (Some(_), None) if pair.iter().any(|end| self.can_turn(end.part)) => Ok(Geometry::Torsion),
            (Some(_), None) if self.broken_joints => Err(Stop::Reported),
            (Some(unit), None) => {
                let span = pair[0].span.to(pair[1].span);
                self.fail(environment, PartError::NoEndTurns { span, torsional: Some(unit) })
            }
            (None, Some(direction)) => Ok(Geometry::Along(direction)),
            (None, None) => self.line_or_direction(pair, environment),
        }
    }

    /// The line between two points, or the one along which both parts move.
    pub fn line_or_direction(&mut self, pair: &[Attachment; 2], environment: Environment) -> Evaluated<Geometry> {
        let places = (&pair[0].at, &pair[1].at);
        if let (Some(a), Some(b)) = places
            && are_apart(a, b)
        {
            return Ok(Geometry::Line);
        }
        if let Some(line) = self.common_line(pair) {
            return Ok(Geometry::Along(line));
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

    /// One and the same line along which both parts move; a part that stays fits any.
    fn common_line(&self, pair: &[Attachment; 2]) -> Option<Arc<Vec3>> {
        match (self.line(pair[0].part), self.line(pair[1].part)) {
            (Line::Along(a), Line::Along(b)) => are_parallel(&a, &b).then_some(a),
            (Line::Along(line), Line::Fixed) | (Line::Fixed, Line::Along(line)) => Some(line),
            _ => None,
        }
    }

    /// A free length needs a drawn length to be compared with.
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
