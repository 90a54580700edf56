//! Compares the symbols with the numbers: each entry with the lowered system, and the equations of motion with
//! derivatives of the energies at random states. A difference is a defect of this program, and is reported as one.
//!
//! d/dt dT/dq' at a state (q, q', q'') is the mixed derivative of T(q + b q', q' + a e_i + b q'') by a and b at zero: numbers with
//! two nilpotent parts carry it through the energies, which no formula of [`lagrange`](super::lagrange) takes part in. The force of an
//! unbalance is compared with the second derivative of its heavy spot's place in the same way, and with the signal that drives it.

use super::Equations;
use super::energy::Element;
use super::error::EquationsError;
use super::names::without_motion;
use crate::base::{Number, Rational, Span};
use crate::elements::Order;
use crate::lower::Lowered;
use crate::model::scene::Scene;
use crate::symbols::{Dependence, Lengths, Sum, Symbol};
use crate::system::{CoordinateId, Form, LinearSystem};

mod jets;
mod rotations;
mod solutions;

/// Compares everything; the first difference is the error.
pub fn verify(equations: &Equations, scene: &Scene, lowered: &Lowered) -> Result<(), EquationsError> {
    let whole = solutions::Matrices::new(scene, &lowered.system);
    let system = &solutions::with_base_damping(equations, scene, &lowered.system)?;
    matrices(equations, system, &whole)?;
    inputs(equations, system)?;
    rests(equations)?;
    solutions::verify(equations, &whole, scene, system)?;
    rotations::verify(equations, scene)?;
    jets::verify(equations)
}

fn matrices(equations: &Equations, system: &LinearSystem, whole: &solutions::Matrices) -> Result<(), EquationsError> {
    let own = [&equations.linear.mass, &equations.linear.damping, &equations.linear.stiffness];
    let theirs = [("M", &system.m, &whole.m), ("C", &system.c, &whole.c), ("K", &system.k, &whole.k)];
    for ((name, form, theirs), own) in theirs.into_iter().zip(own) {
        for (i, row) in own.iter().enumerate() {
            for (j, entry) in row.iter().enumerate() {
                let other = &theirs[i][j];
                let value = equations.names.value_of(&entry.sum).filter(|value| agree(value, &entry.value));
                if !value.is_some_and(|value| agree(&value, other)) {
                    let labels = [i, j].map(|place| equations.label(place).plain());
                    let what = format!("{name}[{}, {}]", labels[0], labels[1]);
                    let place = place_of(equations, system, (name, form), i, j);
                    return Err(defect(place, what, &entry.value, other));
                }
            }
        }
    }
    Ok(())
}

/// The place in the scene where an entry differs: the body or element whose own contribution differs, otherwise the
/// coordinate.
fn place_of(equations: &Equations, system: &LinearSystem, (name, form): (&str, &Form), i: usize, j: usize) -> Span {
    let theirs = |part: &str| {
        let terms = form.terms().filter(|term| system.display(form.source_of(term.source)) == part);
        terms.fold(Number::ZERO, |sum, term| {
            let entry = |place: usize| {
                let found = form.row(term).iter().find(|(id, _)| id.index() == place);
                found.map_or(Number::ZERO, |(_, value)| value.clone())
            };
            &sum + &(&(term.weight * &entry(i)) * &entry(j))
        })
    };
    let [a, b] = [i, j].map(|place| equations.motion.coordinates[equations.linear.coordinates[place]].symbols);
    let differs = |own: Option<Number>, part: &str| own.is_some_and(|own| !agree(&own, &theirs(part)));
    let energies = &equations.energies;
    if name == "M" {
        let none = Lengths::default();
        for body in &energies.of_bodies {
            let own = without_motion(&body.kinetic.derivative(a[1], &none).derivative(b[1], &none));
            if differs(equations.names.value_of(&own), &body.name) {
                return body.span;
            }
        }
    }
    let order = match name {
        "K" => Order::Displacement,
        "C" => Order::Velocity,
        _ => Order::Acceleration,
    };
    let elements = energies.elements.iter().chain(&energies.inerters);
    let share = |element: &Element| {
        let stretch = element.stretch.sum();
        let slope = |by: Symbol| stretch.derivative(by, &energies.lengths);
        let at = element.elongation();
        let own = &(&element.tangent(&at) * &slope(a[0])) * &slope(b[0]);
        match element.is_spring() {
            true => &own + &(&element.pull_at(&at) * &slope(a[0]).derivative(b[0], &energies.lengths)),
            false => own,
        }
    };
    for element in elements.filter(|element| element.order == order) {
        // A law or a belt is several elements here.
        let own = energies.elements_of(element.number).fold(Sum::ZERO, |sum, other| &sum + &share(other));
        if differs(at_rest(equations, &own), &element.name) {
            return element.span;
        }
    }
    system.coordinates[i].span
}

/// The value at rest, of what depends on coordinates by what it stands for.
fn at_rest(equations: &Equations, sum: &Sum) -> Option<Number> {
    equations.names.value_of(&sum_at_rest(equations, sum))
}

fn sum_at_rest(equations: &Equations, sum: &Sum) -> Sum {
    let length = |symbol: Symbol| {
        let found = equations.energies.lengths.0.iter().find(|(name, _)| *name == symbol);
        found.map(|(_, dependence)| match dependence {
            Dependence::Root(square) => equations.names.length(&sum_at_rest(equations, square)),
            Dependence::Form { form, .. } => sum_at_rest(equations, form),
        })
    };
    without_motion(&sum.replace(&length))
}

fn inputs(equations: &Equations, system: &LinearSystem) -> Result<(), EquationsError> {
    for column in &equations.linear.inputs {
        let Some(input) = system.inputs.get(column.input) else { continue };
        for (order, theirs) in input.b.iter().enumerate() {
            for place in 0..system.n() {
                let zero = Sum::ZERO;
                let own = column.parts.get(order).and_then(|part| part.get(place)).unwrap_or(&zero);
                let value = equations.names.value_of(own).unwrap_or(Number::ZERO);
                let id = CoordinateId(place as u32);
                let entries = theirs.iter().filter(|(coordinate, _)| *coordinate == id);
                let other = entries.fold(Number::ZERO, |sum, (_, entry)| &sum + entry);
                if !agree(&value, &other) {
                    let what =
                        format!("B{order}[{}, {}]", equations.label(place).plain(), equations.inputs[column.input]);
                    return Err(defect(system.coordinates[place].span, what, &value, &other));
                }
            }
        }
    }
    Ok(())
}

/// The conditions of rest hold at the rest that was found.
fn rests(equations: &Equations) -> Result<(), EquationsError> {
    if !equations.rest.proven {
        return Ok(());
    }
    for (coordinate, condition) in &equations.rest.conditions {
        let Some(value) = equations.names.value_of(condition) else { continue };
        if !value.may_be_zero() {
            let coordinate = &equations.motion.coordinates[*coordinate];
            let label = equations.names.label(coordinate.symbols[0]).plain();
            let what = format!("the force on {label} at rest");
            return Err(defect(coordinate.span, what, &value, &Number::ZERO));
        }
    }
    Ok(())
}

/// Whether two enclosures may hold the same number.
fn agree(a: &Number, b: &Number) -> bool {
    (a - b).may_be_zero()
}

fn defect(span: Span, what: String, own: &Number, other: &Number) -> EquationsError {
    let shown = |number: &Number| format!("{:?}", number.to_f64());
    EquationsError::Defect { span, what, symbols: shown(own), lowered: shown(other) }
}

/// A fraction from -1 to 1 that looks like any other: from a linear congruence, the same in every run.
pub(super) struct Fractions(u64);

impl Fractions {
    pub(super) fn new(seed: u64) -> Fractions {
        Fractions(seed)
    }

    pub(super) fn next(&mut self) -> Rational {
        // Knuth, MMIX.
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        Rational::new(((self.0 >> 33) % 129) as i64 - 64, 64)
    }
}
