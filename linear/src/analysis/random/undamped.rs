//! Motions in which no damper takes part: found exactly, with the effect of noise on them. In: a system that is not
//! proved to decay. Out: its undamped motions as a system of their own, and for each noise whether it has power at the
//! frequency of a motion that it excites and an output shows: then the variance is infinite. See
//! docs/method/random.md#undamped-motions.

use super::basis::Basis;
use super::driven::Driven;
use crate::analysis::answer::{ModeKind, Modes};
use crate::analysis::excitation::Excitations;
use crate::analysis::forms::dense;
use crate::analysis::modes::modes;
use crate::base::{Ball, Density, Number, Rational};
use crate::kernel::complex::Complex;
use crate::kernel::dense::echelon::{Rationals, null_vectors, reduce};
use crate::system::{CoordinateId, Form, LinearSystem, Noise, Output};
use std::borrow::Cow;

/// Limit on the coordinates up to which undamped motions beside damped ones are searched for in fractions.
const MOST: usize = 16;

type Fractions = Vec<Vec<Rational>>;

/// The undamped motions of a system, which are not coupled with the others.
pub struct Undamped<'a> {
    basis: Basis,
    system: LinearSystem,
    modes: Modes,
    /// All other motions, if there are any and every one of them oscillates.
    pub rest: Option<(Basis, Box<Driven<'a>>)>,
}

/// The effect of a noise on the undamped motions that an output shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Excited {
    /// It has power at the frequency of one, rad/s.
    At(Ball),
    /// It has no power at the frequency of any.
    Nowhere,
    /// Not decided.
    Open,
}

impl<'a> Undamped<'a> {
    /// `None` if there are none, or none are found.
    pub fn of(system: &LinearSystem, all: &Modes, noises: &'a [Noise]) -> Option<Undamped<'a>> {
        let n = system.n();
        let does_swing =
            |modes: &Modes| modes.infinite == 0 && modes.list.iter().all(|mode| mode.kind == ModeKind::Oscillation);
        if !does_swing(all) || all.list.len() != n || system.is_chained() {
            return None;
        }
        if system.c.is_empty() {
            let everything: Vec<usize> = (0..n).collect();
            let basis = Basis::of_coordinates(n, &everything);
            return Some(Undamped { system: basis.system(system), basis, modes: all.clone(), rest: None });
        }
        let (still, others) = split(system)?;
        let basis = Basis::of_columns(n, &still);
        let own = basis.system(system);
        let own_modes = modes(&own).ok().filter(does_swing)?;
        let other_basis = Basis::of_columns(n, &others);
        let other = other_basis.system(system);
        let rest = modes(&other).ok().filter(does_swing).map(|modes| {
            let driven = Driven::of(Cow::Owned(other), Cow::Owned(modes), noises, Vec::new(), None);
            (other_basis, Box::new(driven))
        });
        Some(Undamped { basis, system: own, modes: own_modes, rest })
    }

    /// Whether no undamped motion reaches an output under a noise, exactly.
    pub fn is_apart(&self, noise: &Noise, output: &Output) -> bool {
        let is_seen = output.p.iter().any(|row| !self.basis.row(row).is_empty());
        !is_seen || noise.inputs.iter().all(|(_, delay)| self.is_idle(noise, delay))
    }

    /// Whether the inputs that a noise drives at the same time together leave the undamped motions at rest.
    fn is_idle(&self, noise: &Noise, delay: &Number) -> bool {
        let at_once = |later: &Number| (later - delay).is_zero();
        let inputs: Vec<usize> =
            noise.inputs.iter().filter(|(_, later)| at_once(later)).map(|(input, _)| *input).collect();
        (0..3).all(|power| {
            let all = inputs.iter().flat_map(|&input| &self.system.inputs[input].b[power]);
            dense(self.system.n(), all).iter().all(Number::is_zero)
        })
    }

    /// The effect of a noise, or of its part between two frequencies in Hz, on the motions that an output shows.
    pub fn under(&self, noise: &Noise, output: &Output, within: Option<[&Number; 2]>) -> Excited {
        if self.is_apart(noise, output) {
            return Excited::Nowhere;
        }
        let hertz = |omega: Ball| Number::Ball(omega / (Ball::PI * Ball::from(2.0)));
        let powers: Vec<Power> =
            self.modes.list.iter().map(|mode| power(&noise.density, &hertz(mode.omega), within)).collect();
        if powers.iter().all(|power| *power == Power::None) {
            return Excited::Nowhere;
        }
        let Ok(excitations) = Excitations::of(&self.system, &self.modes) else { return Excited::Open };
        let along = |rows: &[Vec<(CoordinateId, Number)>; 3]| rows.each_ref().map(|row| excitations.along(row));
        let seen = along(&self.basis.output(output).p);
        let driven: Vec<_> =
            noise.inputs.iter().map(|(input, delay)| (along(&self.system.inputs[*input].b), delay)).collect();
        let mut found = Excited::Nowhere;
        for (i, (mode, power)) in self.modes.list.iter().zip(&powers).enumerate() {
            if *power == Power::None {
                continue;
            }
            let own = |parts: &[Vec<Option<Ball>>; 3]| at_axis(parts.each_ref().map(|part| part[i]), mode.omega);
            let force = driven.iter().try_fold(Complex::ZERO, |sum: Complex<Ball>, (parts, delay)| {
                let (sine, cosine) = Number::Ball(mode.omega * delay.to_ball()).sin_cos()?;
                Some(sum + own(parts)? * Complex::new(cosine.to_ball(), -sine.to_ball()))
            });
            let residue = force.and_then(|force| Some(force * own(&seen)?));
            let is_excited = residue.is_some_and(|z| !(z.re.contains_zero() && z.im.contains_zero()));
            if is_excited && *power == Power::Some {
                return Excited::At(mode.omega);
            }
            found = Excited::Open;
        }
        found
    }
}

/// a + b s + c s^2 at s = i w.
fn at_axis([a, b, c]: [Option<Ball>; 3], omega: Ball) -> Option<Complex<Ball>> {
    Some(Complex::new(a? - c? * omega.square(), b? * omega))
}

/// Whether a density has a value above zero on both sides of a frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Power {
    Some,
    None,
    Open,
}

fn power(density: &Density, hertz: &Number, within: Option<[&Number; 2]>) -> Power {
    let between = |from: &Number, to: &Number| {
        let (above, below) = (hertz - from, to - hertz);
        match (above.is_positive() && below.is_positive(), above.is_negative() || below.is_negative()) {
            (true, _) => Power::Some,
            (_, true) => Power::None,
            _ => Power::Open,
        }
    };
    let of_range = within.map_or(Power::Some, |[low, high]| between(low, high));
    let of_density = match density {
        Density::White(value) => {
            if value.is_positive() {
                Power::Some
            } else {
                Power::Open
            }
        }
        Density::Bands(bands) => bands.iter().fold(Power::None, |found, band| match between(&band.from, &band.to) {
            Power::Some if band.at(hertz).is_some_and(|value| value.is_positive()) => Power::Some,
            Power::None => found,
            _ if found == Power::Some => found,
            _ => Power::Open,
        }),
    };
    match (of_range, of_density) {
        (Power::None, _) | (_, Power::None) => Power::None,
        (Power::Some, Power::Some) => Power::Some,
        _ => Power::Open,
    }
}

/// Bases of the motions x with C x = 0, C M^-1 K x = 0, and so on, and of the motions that are orthogonal to them with
/// respect to M: both subspaces are invariant. `None` if there are no such motions, or numbers are not fractions.
fn split(system: &LinearSystem) -> Option<(Fractions, Fractions)> {
    let n = system.n();
    if n > MOST {
        return None;
    }
    let (m, k) = (system.m.rational_entries(n)?, system.k.rational_entries(n)?);
    let felt = damped_rows(&system.c, &inverse_times(&m, &k)?, n)?;
    let still = null_vectors(&square(felt, n));
    if still.is_empty() {
        return None;
    }
    let momenta: Fractions = still.iter().map(|x| m.iter().map(|row| dot(row, x)).collect()).collect();
    Some((still, null_vectors(&square(momenta, n))))
}

/// The independent rows among C, C A, C A^2, ...
fn damped_rows(c: &Form, a: &[Vec<Rational>], n: usize) -> Option<Fractions> {
    let mut rows: Fractions = Vec::new();
    for term in c.terms() {
        let mut row = vec![Rational::ZERO; n];
        for (i, value) in c.row(term) {
            row[i.index()] = value.exact()?.clone();
        }
        rows.push(row);
    }
    let mut rank = 0;
    loop {
        let found = reduce(&Rationals, &mut rows, n).len();
        rows.truncate(found);
        if found == rank || found == n {
            return Some(rows);
        }
        rank = found;
        let images: Fractions = rows.iter().map(|row| (0..n).map(|j| column_dot(row, a, j)).collect()).collect();
        rows.extend(images);
    }
}

/// M^-1 K; `None` if M is singular.
fn inverse_times(m: &[Vec<Rational>], k: &[Vec<Rational>]) -> Option<Fractions> {
    let n = m.len();
    let mut rows: Fractions = m.iter().zip(k).map(|(m, k)| m.iter().chain(k).cloned().collect()).collect();
    let rank = reduce(&Rationals, &mut rows, n).len();
    (rank == n).then(|| rows.into_iter().map(|row| row[n..].to_vec()).collect())
}

fn dot(x: &[Rational], y: &[Rational]) -> Rational {
    x.iter().zip(y).fold(Rational::ZERO, |sum, (x, y)| &sum + &(x * y))
}

fn column_dot(x: &[Rational], a: &[Vec<Rational>], j: usize) -> Rational {
    x.iter().zip(a).fold(Rational::ZERO, |sum, (x, row)| &sum + &(x * &row[j]))
}

/// Appends rows of zeros up to n rows.
fn square(mut rows: Fractions, n: usize) -> Fractions {
    rows.resize(n, vec![Rational::ZERO; n]);
    rows
}
