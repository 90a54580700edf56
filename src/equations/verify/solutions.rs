//! Outputs, natural frequencies and transfer functions against the linear system: rows entry by entry; frequencies by the determinant that they
//! have to bring to zero; transfer functions, as they are printed, by their values at more places than their polynomials have coefficients.

use super::{agree, defect};
use crate::base::{Number, Rational, Span};
use crate::equations::closed::Part;
use crate::equations::polynomial::{self, Polynomial};
use crate::equations::transfer::{Output, Transfer};
use crate::equations::{Equations, EquationsError};
use crate::model::scene::{self, Damping, Scene};
use crate::symbols::Sum;
use crate::system::{CoordinateId, Form, LinearSystem};
use std::borrow::Cow;

pub fn verify(
    equations: &Equations,
    whole: &Matrices,
    scene: &Scene,
    system: &LinearSystem,
) -> Result<(), EquationsError> {
    for output in &equations.outputs {
        rows(equations, output, scene, system)?;
    }
    for part in &equations.parts {
        frequencies(equations, part, whole)?;
    }
    for transfer in &equations.transfers {
        transfer_function(equations, transfer, whole, (scene, system))?;
    }
    Ok(())
}

/// Entries of the linear system, with the damping that is declared for all of it.
pub struct Matrices {
    pub m: Vec<Vec<Number>>,
    pub c: Vec<Vec<Number>>,
    pub k: Vec<Vec<Number>>,
}

impl Matrices {
    pub fn new(scene: &Scene, system: &LinearSystem) -> Matrices {
        let dense = |form: &Form| form.entries(system.n() + system.chain.len());
        let (m, mut c, k) = (dense(&system.m), dense(&system.c), dense(&system.k));
        if let Some(Damping::Rayleigh { alpha, beta, .. }) = &scene.damping {
            for (i, row) in c.iter_mut().enumerate() {
                for (j, entry) in row.iter_mut().enumerate() {
                    *entry = &(&*entry + &(alpha * &m[i][j])) + &(beta * &k[i][j]);
                }
            }
        }
        Matrices { m, c, k }
    }

    /// det(M s^2 + C s + K) of a part, by powers of s.
    fn characteristic(&self, places: &[usize], replaced: Option<(usize, &[Polynomial])>) -> Option<Polynomial> {
        let cell = |i: usize, j: usize| vec![self.k[i][j].clone(), self.c[i][j].clone(), self.m[i][j].clone()];
        let mut matrix: Vec<Vec<Polynomial>> =
            places.iter().map(|i| places.iter().map(|j| cell(*i, *j)).collect()).collect();
        if let Some((column, driven)) = replaced {
            for (row, driven) in matrix.iter_mut().zip(driven) {
                row[column] = driven.clone();
            }
        }
        polynomial::determinant(&matrix)
    }
}

/// The linear system with the part that bases have in Rayleigh damping, by its definition: beta b0 + alpha M r for r with K r = b0.
pub fn with_base_damping<'a>(
    equations: &Equations,
    scene: &Scene,
    system: &'a LinearSystem,
) -> Result<Cow<'a, LinearSystem>, EquationsError> {
    let Some(Damping::Rayleigh { alpha, beta, .. }) = &scene.damping else { return Ok(Cow::Borrowed(system)) };
    let mut damped = Cow::Borrowed(system);
    let [m, k] = [&system.m, &system.k].map(|form| form.entries(system.n() + system.chain.len()));
    let product = |row: &[Number], r: &[Number]| row.iter().zip(r).fold(Number::ZERO, |sum, (a, r)| &sum + &(a * r));
    for (number, input) in system.inputs.iter().enumerate() {
        if scene.inputs.get(number).is_none_or(|input| input.kind.base().is_none()) {
            continue;
        }
        let column = &mut damped.to_mut().inputs[number].b[1];
        column.extend(input.b[0].iter().map(|(i, value)| (*i, beta * value)));
        let Some((_, follows)) = equations.linear.carried.iter().find(|(of, _)| *of == number) else { continue };
        let r: Vec<Number> = follows.iter().map(|sum| equations.names.value_of(sum).unwrap_or(Number::ZERO)).collect();
        for place in 0..system.n() {
            let (pushed, force) = (entry(&input.b[0], place), product(&k[place], &r));
            if !agree(&force, &pushed) {
                let what = format!("K r[{}, {}]", equations.label(place).plain(), equations.inputs[number]);
                return Err(defect(system.coordinates[place].span, what, &force, &pushed));
            }
            column.push((CoordinateId(place as u32), alpha * &product(&m[place], &r)));
        }
    }
    Ok(damped)
}

/// Every entry of an output.
fn rows(equations: &Equations, output: &Output, scene: &Scene, system: &LinearSystem) -> Result<(), EquationsError> {
    let Some(theirs) = system.outputs.get(output.number) else { return Ok(()) };
    // Equations are in SI units, whatever the unit that the output is shown in.
    let unit = scene.outputs.get(output.number).and_then(scene::Output::unit_factor);
    let compare = |own: &Sum, other: &Number, of: String| {
        let other = &unit.map_or_else(|| other.clone(), |unit| other * unit);
        let value = equations.names.value_of(own).unwrap_or(Number::ZERO);
        let what = || format!("{}[{of}]", output.name);
        if agree(&value, other) { Ok(()) } else { Err(defect(output.span, what(), &value, other)) }
    };
    for (order, row) in output.rows.iter().enumerate() {
        for (place, own) in row.iter().enumerate() {
            let primes = "'".repeat(order);
            compare(own, &entry(&theirs.p[order], place), format!("{}{primes}", equations.label(place).plain()))?;
        }
        for (input, name) in equations.inputs.iter().enumerate() {
            let own = output.direct[order].iter().filter(|(of, _)| *of == input);
            let own = own.fold(Sum::ZERO, |sum, (_, entry)| &sum + entry);
            let other = theirs.d[order].iter().filter(|(of, _)| *of as usize == input);
            compare(
                &own,
                &other.fold(Number::ZERO, |sum, (_, value)| &sum + value),
                format!("{name}{}", "'".repeat(order)),
            )?;
        }
    }
    Ok(())
}

fn entry(row: &[(CoordinateId, Number)], place: usize) -> Number {
    let found = row.iter().filter(|(id, _)| id.index() == place);
    found.fold(Number::ZERO, |sum, (_, value)| &sum + value)
}

fn place_of(equations: &Equations, part: &Part) -> Span {
    equations.motion.coordinates[equations.linear.coordinates[part.places[0]]].span
}

/// The square of each frequency brings det(K - omega^2 M) to zero; a damping ratio is c/(2 sqrt(k m)).
fn frequencies(equations: &Equations, part: &Part, whole: &Matrices) -> Result<(), EquationsError> {
    let span = place_of(equations, part);
    let label = equations.label(part.places[0]).plain();
    for square in part.squares.iter().filter_map(|square| square.value.as_ref()) {
        let cell = |i: usize, j: usize| vec![&whole.k[i][j] - &(square * &whole.m[i][j])];
        let matrix: Vec<Vec<Polynomial>> =
            part.places.iter().map(|i| part.places.iter().map(|j| cell(*i, *j)).collect()).collect();
        let left = polynomial::determinant(&matrix).and_then(|value| value.into_iter().next());
        if let Some(left) = left.filter(|left| !left.may_be_zero()) {
            return Err(defect(span, format!("det(K - omega^2 M) of {label}"), &left, &Number::ZERO));
        }
    }
    if let (Some((_, value)), &[one]) = (&part.damping_ratio, &part.places[..]) {
        let critical = (&whole.k[one][one] * &whole.m[one][one]).sqrt();
        let other = critical.and_then(|root| whole.c[one][one].checked_div(&(&root + &root)));
        if let Some(other) = other.filter(|other| !agree(value, other)) {
            return Err(defect(span, format!("the damping ratio of {label}"), value, &other));
        }
    }
    Ok(())
}

/// Places at which polynomials are compared: more than any of them has coefficients.
const PLACES: std::ops::RangeInclusive<i64> = 1..=20;

/// Checks that the printed N(s) and D(s) satisfy N(s) D'(s) = N'(s) D(s) with N' and D' of the linear system.
fn transfer_function(
    equations: &Equations,
    transfer: &Transfer,
    whole: &Matrices,
    system: (&Scene, &LinearSystem),
) -> Result<(), EquationsError> {
    let (part, output) = (&equations.parts[transfer.part], &equations.outputs[transfer.output]);
    let worth = |sums: &[Sum]| sums.iter().map(|sum| equations.names.value_of(sum)).collect::<Option<Polynomial>>();
    let (over, under) = match transfer.numerator.is_empty() {
        true => (Some(transfer.numbers.clone()), Some(part.numbers.clone())),
        false => (worth(&transfer.reduced.0), worth(&transfer.reduced.1)),
    };
    let (Some(over), Some(under)) = (over, under) else { return Ok(()) };
    let Some((numerator, denominator)) = lowered_fraction(equations, transfer, whole, system) else { return Ok(()) };
    for place in PLACES {
        let s = Number::from(Rational::new(place, 4));
        let at = |of: &Polynomial| polynomial::value(of, &s);
        let (own, other) = (&at(&over) * &at(&denominator), &at(&numerator) * &at(&under));
        if !agree(&own, &other) {
            let name = format!("{}/{} at s = {}", output.name, equations.inputs[transfer.input], place as f64 / 4.0);
            return Err(defect(output.span, name, &own, &other));
        }
    }
    Ok(())
}

/// Numerator and denominator from the linear system, in SI units.
fn lowered_fraction(
    equations: &Equations,
    transfer: &Transfer,
    whole: &Matrices,
    (scene, system): (&Scene, &LinearSystem),
) -> Option<(Polynomial, Polynomial)> {
    let places = &equations.parts[transfer.part].places;
    let output = system.outputs.get(equations.outputs[transfer.output].number)?;
    let input = system.inputs.get(transfer.input)?;
    let column = |place: &usize| input.b.iter().map(|row| entry(row, *place)).collect::<Polynomial>();
    let driven: Vec<Polynomial> = places.iter().map(column).collect();
    let denominator = whole.characteristic(places, None)?;
    let mut numerator = Vec::new();
    for (index, place) in places.iter().enumerate() {
        let row: Polynomial = output.p.iter().map(|row| entry(row, *place)).collect();
        let cofactors = whole.characteristic(places, Some((index, &driven)))?;
        numerator = polynomial::sum(&numerator, &polynomial::product(&row, &cofactors));
    }
    let direct = output.d.iter().map(|row| {
        let own = row.iter().filter(|(of, _)| *of as usize == transfer.input);
        own.fold(Number::ZERO, |sum, (_, value)| &sum + value)
    });
    let direct: Polynomial = direct.collect();
    numerator = polynomial::sum(&numerator, &polynomial::product(&direct, &denominator));
    let of = equations.outputs[transfer.output].number;
    if let Some(unit) = scene.outputs.get(of).and_then(scene::Output::unit_factor) {
        numerator.iter_mut().for_each(|entry| *entry = &*entry * unit);
    }
    Some((numerator, denominator))
}
