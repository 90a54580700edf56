//! The transfer function H(s) = P(s) Q(s)^-1 B(s) + D(s) at s = i omega, Q(s) = s^2 M + s C + K, from the terms of the
//! system, each value with a proven bound. In: a linear system and a frequency. Out: one value for each input and
//! output: a complex number in a disc, or infinity if the system is excited at its own frequency without damping.
//!
//! Each frequency is solved by sparse elimination in double-double discs; if these get too wide, with an approximate
//! inverse in binary64 and residuals of the terms in balls; if that inverse cannot be proven, with one in
//! double-double; if that fails too, with exact rational numbers. See docs/method/transfer.md.

pub(in crate::analysis) mod around;
pub(in crate::analysis) mod exact;
pub mod extrema;
mod findings;
pub(in crate::analysis) mod inverse;
pub mod modal;
pub(in crate::analysis) mod partial_fractions;
mod pieces;
mod scaled;
pub(in crate::analysis) mod sparse;
pub mod table;
pub(in crate::analysis) mod two_sided;

use crate::analysis::answer::modulus;
use crate::analysis::modes::parts::{self, independent};
use crate::analysis::transfer::extrema::{Denominator, Exactly, coordinates_between};
use crate::analysis::transfer::inverse::{Entry, Inverse, Scalar};
use crate::analysis::transfer::pieces::in_pieces;
use crate::analysis::transfer::sparse::Pattern;
use crate::analysis::transfer::two_sided::TwoSided;
use crate::base::{Ball, Dd, Number, OrderBy, larger, up};
use crate::kernel::complex::Complex;
pub use crate::kernel::disc::Disc;
use crate::kernel::squares::Squares;
use crate::system::{CoordinateId, Form, LinearSystem, Output};
pub use findings::findings as table_findings;
use std::sync::OnceLock;

/// A value of H.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Gain {
    Finite(Disc),
    /// A pole on the imaginary axis, exactly at this frequency.
    Infinite,
    /// Too close to a pole to be resolved with double-double numbers.
    Unknown,
}

/// A frequency: s = i omega.
#[derive(Clone, Debug)]
pub struct Frequency {
    /// Hz
    pub hertz: Number,
    /// rad/s
    pub omega: Ball,
    omega_squared: Ball,
    /// omega itself if it is known exactly: an undamped pole may coincide with it.
    exact: Option<Number>,
}

/// A system prepared for many frequencies.
#[derive(Clone, Debug)]
pub struct Transfer<'a> {
    system: &'a LinearSystem,
    m: Squares,
    c: Squares,
    k: Squares,
    /// The assembled matrices, both triangles.
    entries: Vec<MatrixEntry>,
    /// The elimination order and pattern; `None` if elimination would fill the matrices.
    pattern: Option<Pattern>,
    /// Zeros and poles, computed on demand, for each input and output in turn.
    parts: OnceLock<Vec<parts::Part>>,
    denominator: OnceLock<Option<Denominator>>,
    exactly: Vec<OnceLock<Option<Exactly>>>,
}

#[derive(Clone, Copy, Debug)]
struct MatrixEntry {
    i: u32,
    j: u32,
    m: Ball,
    c: Ball,
    k: Ball,
}

/// Q(s)^-1 b: a midpoint and a bound for each component.
struct Solution {
    re: Vec<Dd>,
    im: Vec<Dd>,
    error: Vec<f64>,
}

/// Refinement stops below this relative radius: the value is then correct in binary64 with two extra digits.
const SETTLED: f64 = 1e-18;
/// Small independent parts are not searched for in larger systems.
const MOST_WITH_PARTS: usize = 2000;
/// Zeros and poles are kept for at most this many pairs of inputs and outputs, and not computed for others.
const MOST_PAIRS: usize = 10_000;
/// Relative error below half a unit in the last place of binary64.
const TO_THE_LAST_DIGIT: f64 = 1e-17;
/// Sums in binary64 are hardly ever better than this.
const FAST_ABOVE: f64 = 1e-14;
/// For more coordinates, an inverse at every frequency takes too long.
const MOST_DENSE: usize = 300;
/// Underflow error of a few products.
const UNDERFLOW: f64 = 1e-317;
/// With a certified inverse each step gains at least half a digit; the limit allows for the worst case.
const MOST_STEPS: usize = 40;

impl Frequency {
    /// A frequency in cycles per second, exact or enclosed: omega = 2 pi f.
    pub fn hertz(f: &Number) -> Frequency {
        Frequency::of(&(&two_pi() * f), f.clone())
    }

    /// A frequency in radians per second: an exact number stays exact, whatever it is in Hz.
    pub fn radians(omega: &Number) -> Frequency {
        Frequency::of(omega, omega / &two_pi())
    }

    fn of(omega: &Number, hertz: Number) -> Frequency {
        let exact = omega.is_known_exactly().then(|| omega.clone());
        let omega = omega.to_ball();
        Frequency { hertz, omega, omega_squared: omega * omega, exact }
    }

    /// rad/s, as exact as it is known.
    fn omega(&self) -> Number {
        self.exact.clone().unwrap_or(Number::Ball(self.omega))
    }

    pub fn exact(&self) -> Option<&Number> {
        self.exact.as_ref()
    }

    /// b0 + i omega b1 - omega^2 b2
    pub(in crate::analysis) fn polynomial(&self, b: [Ball; 3]) -> Complex<Ball> {
        Complex::new(b[0] - self.omega_squared * b[2], self.omega * b[1])
    }
}

fn two_pi() -> Number {
    &Number::pi() * &Number::from(2)
}

impl Gain {
    /// The disc of a finite value.
    pub fn disc(&self) -> Option<Disc> {
        match self {
            Gain::Finite(disc) => Some(*disc),
            _ => None,
        }
    }
}

impl Disc {
    fn into_gain(self) -> Gain {
        if self.radius.is_finite() { Gain::Finite(self) } else { Gain::Unknown }
    }

    /// |value| as a ball: |true| lies within the disc's radius of it.
    pub fn gain(&self) -> Ball {
        modulus(Ball::exact(self.value.re), Ball::exact(self.value.im)).widen(self.radius)
    }
}

impl<'a> Transfer<'a> {
    pub fn system(&self) -> &'a LinearSystem {
        self.system
    }

    pub fn of(system: &'a LinearSystem) -> Transfer<'a> {
        let entries = assemble(system);
        Transfer {
            system,
            m: Squares::of_form(&system.m),
            c: Squares::of_form(&system.c),
            k: Squares::of_form(&system.k),
            pattern: Pattern::of(system.n(), &entries.iter().map(|e| (e.i, e.j)).collect::<Vec<_>>()),
            entries,
            parts: OnceLock::new(),
            denominator: OnceLock::new(),
            exactly: vec![OnceLock::new(); system.inputs.len().saturating_mul(system.outputs.len()).min(MOST_PAIRS)],
        }
    }

    /// Whether dampers certainly resist every motion, so that many frequencies are computed at once.
    pub fn is_held(&self) -> bool {
        TwoSided::of(self).is_some()
    }

    /// H of one input and one output by its zeros and poles, if exact arithmetic finds them.
    pub fn zero_pole_form(&self, input: usize, output: usize) -> Option<&Exactly> {
        let found = || {
            if self.system.n() > MOST_WITH_PARTS || self.system.losses.is_some() {
                return None;
            }
            let parts = self.parts.get_or_init(|| independent(self.system));
            let coordinates = coordinates_between(self.system, parts, input, output);
            let own;
            let denominator = if coordinates.len() == self.system.n() {
                self.denominator.get_or_init(|| Denominator::of(self.system, &coordinates)).as_ref()?
            } else {
                own = Denominator::of(self.system, &coordinates)?;
                &own
            };
            denominator.pair(self.system, input, output).and_then(|factored| Exactly::of(&factored))
        };
        self.exactly.get(input * self.system.outputs.len() + output)?.get_or_init(found).as_ref()
    }

    /// H at a frequency from every input to every output: `[input][output]`.
    pub fn at(&self, frequency: &Frequency) -> Vec<Vec<Gain>> {
        let inputs: Vec<usize> = (0..self.system.inputs.len()).collect();
        let outputs: Vec<usize> = (0..self.system.outputs.len()).collect();
        self.between(frequency, &inputs, &outputs)
    }

    /// H at a frequency from some inputs to some outputs: `[input][output]`, in the order given.
    pub fn between(&self, frequency: &Frequency, inputs: &[usize], outputs: &[usize]) -> Vec<Vec<Gain>> {
        if let Some(losses) = &self.system.losses {
            let omega = frequency.omega();
            if omega.may_be_zero() && !omega.is_zero() {
                return vec![vec![Gain::Unknown; outputs.len()]; inputs.len()];
            }
            let system = self.system.at_frequency(&omega);
            let mut gains = Transfer::of(&system).between(frequency, inputs, outputs);
            for (_, gains) in
                inputs.iter().zip(&mut gains).filter(|(input, _)| omega.is_zero() && losses.has_no_limit(**input))
            {
                gains.fill(Gain::Unknown);
            }
            return gains;
        }
        let mut gains = self.in_own_units(frequency, inputs, outputs);
        if gains.iter().flatten().any(|gain| *gain == Gain::Unknown)
            && let Some((system, frequency)) = scaled::scale(self.system, frequency)
        {
            let others = Transfer::of(&system).in_own_units(&frequency, inputs, outputs);
            let pairs = gains.iter_mut().flatten().zip(others.into_iter().flatten());
            pairs.filter(|(gain, _)| **gain == Gain::Unknown).for_each(|(gain, other)| *gain = other);
        }
        gains
    }

    /// The transfer functions with the system's own numbers, whatever their size.
    fn in_own_units(&self, frequency: &Frequency, inputs: &[usize], outputs: &[usize]) -> Vec<Vec<Gain>> {
        let mut gains = vec![vec![Gain::Unknown; outputs.len()]; inputs.len()];
        if self.system.n() == 0 {
            let nothing = Solution { re: Vec::new(), im: Vec::new(), error: Vec::new() };
            return (inputs.iter()).map(|&u| self.read(frequency, u, outputs, &nothing)).collect();
        }
        let entries = self.entries_at(frequency);
        self.eliminate(&entries, frequency, inputs, outputs, &mut gains);
        if all_settled(&gains) || self.system.n() > MOST_DENSE {
            return gains;
        }
        self.solve_with(Inverse::<Complex<f64>>::of(self.system.n(), &entries), frequency, inputs, outputs, &mut gains);
        if !all_settled(&gains) {
            let inverse = Inverse::<Complex<Dd>>::of(self.system.n(), &entries);
            self.solve_with(inverse, frequency, inputs, outputs, &mut gains);
        }
        if gains.iter().flatten().any(|gain| *gain == Gain::Unknown) {
            exact::solve(self.system, frequency, inputs, outputs, &mut gains);
        }
        self.improve_by_zeros_and_poles(frequency, inputs, outputs, &mut gains);
        gains
    }

    /// Next to a very lightly damped pole, zeros and poles may give better values than elimination.
    fn improve_by_zeros_and_poles(
        &self,
        frequency: &Frequency,
        inputs: &[usize],
        outputs: &[usize],
        gains: &mut [Vec<Gain>],
    ) {
        for (&input, row) in inputs.iter().zip(gains) {
            for (&output, gain) in outputs.iter().zip(row).filter(|(_, gain)| is_poor(gain)) {
                *gain = better(
                    *gain,
                    self.zero_pole_form(input, output).map_or(Gain::Unknown, |product| product.gain(frequency)),
                );
            }
        }
    }

    /// H at many frequencies, in one list: for each frequency every input, for each input every output. Several
    /// frequencies are computed at once if dampers resist every motion; otherwise each is computed as in
    /// [`Transfer::between`].
    pub fn at_frequencies(
        &self,
        frequencies: &[Frequency],
        inputs: &[usize],
        outputs: &[usize],
        tolerance: f64,
    ) -> Vec<Gain> {
        let method = TwoSided::of(self);
        let pairs = inputs.len() * outputs.len();
        in_pieces(frequencies, self.system.n(), |some| {
            let mut gains = self.sweep_table(method.as_ref(), some, inputs, outputs, tolerance);
            for (frequency, gains) in some.iter().zip(gains.chunks_mut(pairs.max(1))) {
                if worst_radius(gains) > tolerance {
                    gains.copy_from_slice(&self.between(frequency, inputs, outputs).concat());
                }
            }
            gains
        })
    }

    /// The values of the two-sided method, in the order of [`Transfer::at_frequencies`]; unknown if it proves nothing.
    fn side_by_side(
        &self,
        frequencies: &[Frequency],
        inputs: &[usize],
        outputs: &[usize],
        tolerance: f64,
    ) -> Vec<Gain> {
        let method = TwoSided::of(self);
        in_pieces(frequencies, self.system.n(), |some| {
            self.sweep_table(method.as_ref(), some, inputs, outputs, tolerance)
        })
    }

    fn sweep_table(
        &self,
        method: Option<&TwoSided>,
        frequencies: &[Frequency],
        inputs: &[usize],
        outputs: &[usize],
        tolerance: f64,
    ) -> Vec<Gain> {
        match method {
            Some(method) => {
                method.sweep(self, frequencies, inputs, outputs, tolerance).into_iter().map(Disc::into_gain).collect()
            }
            None => vec![Gain::Unknown; frequencies.len() * inputs.len() * outputs.len()],
        }
    }

    /// Fills in the values from sparse elimination in discs.
    fn eliminate(
        &self,
        entries: &[Entry],
        frequency: &Frequency,
        inputs: &[usize],
        outputs: &[usize],
        gains: &mut [Vec<Gain>],
    ) {
        let Some(factors) = self.pattern.as_ref().and_then(|pattern| pattern.factor(entries)) else { return };
        for (&input, gains) in inputs.iter().zip(gains) {
            let x = factors.solve(&self.load(frequency, input));
            let part = |of: fn(&Disc) -> Dd| x.iter().map(of).collect();
            let error = x.iter().map(|disc| disc.radius).collect();
            let solution = Solution { re: part(|disc| disc.value.re), im: part(|disc| disc.value.im), error };
            *gains = self.read(frequency, input, outputs, &solution);
        }
    }

    /// Fills in the values from a proven inverse if they are more accurate; leaves the gains unchanged if there is no
    /// such inverse.
    fn solve_with<T: Scalar>(
        &self,
        inverse: Option<Inverse<T>>,
        frequency: &Frequency,
        inputs: &[usize],
        outputs: &[usize],
        gains: &mut [Vec<Gain>],
    ) {
        let Some(inverse) = inverse else { return };
        for (&input, gains) in inputs.iter().zip(gains) {
            let refined = self.refine(&inverse, frequency, input, outputs);
            for (gain, refined) in gains.iter_mut().zip(refined) {
                *gain = better(*gain, refined);
            }
        }
    }

    /// Applies corrections until every output is settled, or the bounds shrink no further.
    fn refine<T: Scalar>(
        &self,
        inverse: &Inverse<T>,
        frequency: &Frequency,
        input: usize,
        outputs: &[usize],
    ) -> Vec<Gain> {
        let n = self.system.n();
        let b = self.load(frequency, input);
        let mut x = Solution { re: vec![Dd::ZERO; n], im: vec![Dd::ZERO; n], error: vec![f64::INFINITY; n] };
        let mut residual = b.clone();
        let mut gains = vec![Gain::Unknown; outputs.len()];
        let mut last = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            for (i, step) in inverse.apply(&residual).into_iter().enumerate() {
                x.re[i] += step.re;
                x.im[i] += step.im;
            }
            residual = self.residual(frequency, &b, &x);
            x.error = inverse.error(&residual);
            let next = self.read(frequency, input, outputs, &x);
            let worst = worst_radius(&next);
            if worst < last {
                gains = next;
            }
            if all_settled(std::slice::from_ref(&gains)) || worst.is_nan() || worst > 0.5 * last {
                break;
            }
            last = worst;
        }
        gains
    }

    /// b(s) of an input.
    fn load(&self, frequency: &Frequency, input: usize) -> Vec<Complex<Ball>> {
        let mut coefficients = vec![[Ball::ZERO; 3]; self.system.n()];
        for (power, column) in self.system.inputs[input].b.iter().enumerate() {
            for (i, value) in column {
                coefficients[i.index()][power] = value.to_ball();
            }
        }
        coefficients.into_iter().map(|b| frequency.polynomial(b)).collect()
    }

    /// b - Q(s) x, term by term.
    fn residual(&self, frequency: &Frequency, b: &[Complex<Ball>], x: &Solution) -> Vec<Complex<Ball>> {
        let mut r = b.to_vec();
        subtract(&self.k, x, &mut r, |t| t);
        subtract(&self.m, x, &mut r, |t| t.scale(-frequency.omega_squared));
        subtract(&self.c, x, &mut r, |t| Complex::new(-(frequency.omega * t.im), frequency.omega * t.re));
        r
    }

    /// y = P(s) x + D(s) u for u = 1.
    fn read(&self, frequency: &Frequency, input: usize, outputs: &[usize], x: &Solution) -> Vec<Gain> {
        let gain = |&output: &usize| {
            let output = &self.system.outputs[output];
            let mut y = frequency.polynomial(feed_through(output, input));
            let mut radius = 0.0;
            for (power, row) in output.p.iter().enumerate() {
                for (i, p) in row {
                    let (i, p) = (i.index(), p.to_ball());
                    let product = Complex::new(Ball::exact(x.re[i]) * p, Ball::exact(x.im[i]) * p);
                    y = y + times_power(frequency, power, product);
                    // In the order of the values, so that an underflow there occurs here too, and is then counted as
                    // more than zero.
                    let least = if x.error[i] > 0.0 { UNDERFLOW } else { 0.0 };
                    let times_omega = |error: f64, _| error * frequency.omega.magnitude() + least;
                    radius += (0..power).fold(p.magnitude() * x.error[i] + least, times_omega);
                }
            }
            let radius = (y.radius() + radius) * up::THOUSANDS;
            if radius.is_finite() { Gain::Finite(Disc { value: y.mid(), radius }) } else { Gain::Unknown }
        };
        outputs.iter().map(gain).collect()
    }

    fn entries_at(&self, frequency: &Frequency) -> Vec<Entry> {
        let value = |e: &MatrixEntry| Complex::new(e.k - frequency.omega_squared * e.m, frequency.omega * e.c);
        self.entries.iter().map(|e| Entry { i: e.i, j: e.j, value: value(e) }).collect()
    }
}

/// (i omega)^power z
fn times_power(frequency: &Frequency, power: usize, z: Complex<Ball>) -> Complex<Ball> {
    match power {
        0 => z,
        1 => Complex::new(-(frequency.omega * z.im), frequency.omega * z.re),
        _ => -z.scale(frequency.omega_squared),
    }
}

pub(in crate::analysis) fn feed_through(output: &Output, input: usize) -> [Ball; 3] {
    let of = |power: usize| {
        let entries = output.d[power].iter().filter(|(u, _)| *u as usize == input);
        entries.fold(Ball::ZERO, |sum, (_, value)| sum + value.to_ball())
    };
    [of(0), of(1), of(2)]
}

/// r <- r - a z(w a . x) for each term w a a^T.
fn subtract(squares: &Squares, x: &Solution, r: &mut [Complex<Ball>], z: impl Fn(Complex<Ball>) -> Complex<Ball>) {
    for t in 0..squares.len() {
        let stretch = Complex::new(squares.stretch(t, &x.re), squares.stretch(t, &x.im));
        let tension = z(stretch.scale(squares.weights[t]));
        let (indices, values) = squares.row(t);
        for (&i, &a) in indices.iter().zip(values) {
            let entry = &mut r[i as usize];
            *entry = *entry - by_factor(tension, a);
        }
    }
}

/// Most factors are 1 or -1, which cause no rounding.
#[inline]
fn by_factor(z: Complex<Ball>, a: Ball) -> Complex<Ball> {
    if a == Ball::ONE {
        z
    } else if a == -Ball::ONE {
        -z
    } else {
        z.scale(a)
    }
}

/// Whether the value is less accurate than a binary64 number can show.
fn is_poor(gain: &Gain) -> bool {
    match gain {
        Gain::Finite(disc) => disc.relative_error() > TO_THE_LAST_DIGIT,
        Gain::Infinite => false,
        Gain::Unknown => true,
    }
}

/// The more accurate of two values; the first if neither is known.
fn better(gain: Gain, other: Gain) -> Gain {
    let error = |gain: &Gain| match gain {
        // If both may be zero, the smaller disc is more informative.
        Gain::Finite(disc) => (disc.relative_error(), disc.radius),
        Gain::Infinite => (0.0, 0.0),
        Gain::Unknown => (f64::INFINITY, f64::INFINITY),
    };
    if error(&other) < error(&gain) { other } else { gain }
}

/// Whether every value is correct in binary64.
fn all_settled(gains: &[Vec<Gain>]) -> bool {
    gains.iter().all(|row| worst_radius(row) <= SETTLED)
}

/// The largest radius relative to the computed value (absolute if that is zero).
fn worst_radius(gains: &[Gain]) -> f64 {
    let radius = |gain: &Gain| match gain {
        Gain::Finite(disc) => {
            let size = disc.value.to_f64().abs();
            if disc.radius == 0.0 || size == 0.0 { disc.radius } else { disc.radius / size }
        }
        _ => f64::INFINITY,
    };
    gains.iter().map(radius).fold(0.0, larger)
}

/// M, C and K as sums of their terms, exact until the sum is complete: the nonzero entries of all of them.
fn assemble(system: &LinearSystem) -> Vec<MatrixEntry> {
    let mut parts: Vec<Part> = Vec::new();
    for (which, form) in [&system.m, &system.c, &system.k].into_iter().enumerate() {
        collect(form, system.n(), which, &mut parts);
    }
    sum_parts(&mut parts);
    // A coordinate may have no term: a row of zeros, singular at every frequency.
    let mut entries: Vec<MatrixEntry> = Vec::new();
    for (i, j, which, sum) in parts {
        let sum = sum.to_ball();
        if entries.last().is_none_or(|e| (e.i, e.j) != (i, j)) {
            entries.push(MatrixEntry { i, j, m: Ball::ZERO, c: Ball::ZERO, k: Ball::ZERO });
        }
        if let Some(entry) = entries.last_mut() {
            *[&mut entry.m, &mut entry.c, &mut entry.k][which] = sum;
        }
    }
    entries
}

/// The contribution of a term to an entry: row, column, which of M, C and K, and the value.
type Part = (u32, u32, usize, Number);

/// Sorts the contributions and adds up those of each entry, in their order.
fn sum_parts(parts: &mut Vec<Part>) {
    parts.order_by_key(|(i, j, which, _)| (*i, *j, *which));
    parts.dedup_by(|part, sum| {
        let is_same = (part.0, part.1, part.2) == (sum.0, sum.1, sum.2);
        if is_same {
            sum.3 = &sum.3 + &part.3;
        }
        is_same
    });
}

/// Appends what the terms of a form contribute. Of terms with more contributions than the matrix has entries, as those of damping by
/// modes, the sums themselves: sorting would take longer than all else.
fn collect(form: &Form, n: usize, which: usize, parts: &mut Vec<Part>) {
    /// Maximum number of contributions that wait to be summed: long rows of a large system have many times more of them than it
    /// has entries.
    const WAITING: usize = 1 << 20;
    let mut room = parts.len() + WAITING;
    let index = |i: &CoordinateId| i.0;
    let contributions = form.terms().fold(0usize, |sum, term| sum.saturating_add(form.row(term).len().pow(2)));
    let is_full = contributions > n.saturating_mul(n);
    let mut sums: Vec<Option<Number>> = if is_full { vec![None; n * n] } else { Vec::new() };
    for term in form.terms() {
        let row = form.row(term);
        for (i, a) in row {
            let weighted = term.weight * a;
            let of_row = row.iter().map(|(j, b)| (index(j), &weighted * b));
            if !is_full {
                parts.extend(of_row.map(|(j, part)| (index(i), j, which, part)));
                continue;
            }
            for (j, part) in of_row {
                let sum = &mut sums[index(i) as usize * n + j as usize];
                *sum = Some(match sum {
                    Some(sum) => &*sum + &part,
                    None => part,
                });
            }
        }
        if parts.len() > room {
            sum_parts(parts);
            room = 2 * parts.len() + WAITING;
        }
    }
    let place = |at: usize| ((at / n) as u32, (at % n) as u32);
    let with_place = |(at, sum): (usize, Option<Number>)| sum.map(|sum| (place(at).0, place(at).1, which, sum));
    parts.extend(sums.into_iter().enumerate().filter_map(with_place));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::test_systems::{blank, oscillator, push};
    use crate::system::Nature;

    /// k = 4, m = 1, c = 2 at omega = 1: 1 / (3 + 2i) = (3 - 2i) / 13.
    #[test]
    fn an_oscillator_has_the_textbook_receptance() {
        let system = oscillator("1", "2", "4");
        let gain = Transfer::of(&system).at(&Frequency::radians(&Number::ONE))[0][0];
        let disc = gain.disc().expect("finite");
        assert!(disc.relative_error() < 1e-18);
        let (re, im) = (Dd::from(3.0) / Dd::from(13.0), Dd::from(-2.0) / Dd::from(13.0));
        assert!((disc.value - Complex::new(re, im)).to_f64().abs() <= disc.radius);
    }

    #[test]
    fn without_damping_its_own_frequency_is_infinite() {
        let system = oscillator("1", "0", "4");
        let transfer = Transfer::of(&system);
        assert_eq!(transfer.at(&Frequency::radians(&Number::from(2)))[0][0], Gain::Infinite);
        assert!(matches!(transfer.at(&Frequency::radians(&Number::from("2.000000000001")))[0][0], Gain::Finite(_)));
    }

    /// Long rows, as of damping by modes, have more contributions than the matrix has entries and are summed in another way: here
    /// integers, which the matrices hold exactly.
    #[test]
    fn entries_are_the_sums_of_all_contributions() {
        for count in [1, 5] {
            let mut system = blank(3);
            let mut truth = [[0i64; 3]; 3];
            for t in 0..count {
                let row = [2 + t, -1 - 3 * t, 5 - t * t];
                let source = system.c.source(system.inputs[0].name);
                let numbers = (0..3).map(|i| (CoordinateId(i as u32), Number::from(row[i])));
                system.c.push(source, Nature::Property, Number::from(t + 1), numbers);
                (0..9).for_each(|at| truth[at / 3][at % 3] += (t + 1) * row[at / 3] * row[at % 3]);
            }
            push(&mut system.k, "7", 1, None);
            let entries = assemble(&system);
            for entry in &entries {
                let (i, j) = (entry.i as usize, entry.j as usize);
                let stiffness = if (i, j) == (1, 1) { 7.0 } else { 0.0 };
                let found = [entry.m, entry.c, entry.k];
                for (found, truth) in found.into_iter().zip([0.0, truth[i][j] as f64, stiffness]) {
                    assert_eq!((found.mid, found.rad), (Dd::from(truth), 0.0));
                }
            }
            assert_eq!(entries.len(), 9);
        }
    }

    /// 4.7e297 kg on 5e-9 N/m: the product of displacement and mass exceeds binary64, so that a residual is meaningless
    /// and the enclosure from elimination stands. H = 1 / (k - m omega^2) in exact arithmetic.
    #[test]
    fn an_overflow_in_a_residual_gives_no_bound() {
        let (m, k, omega) = ("4.66694e297", "5e-9", "1.0367255756846e-153");
        let system = oscillator(m, "0", k);
        let [m, k, omega] = [m, k, omega].map(Number::from);
        let truth = &Number::ONE / &(&k - &(&m * &omega.square()));
        let disc = Transfer::of(&system).at(&Frequency::radians(&omega))[0][0].disc().expect("finite");
        let part = |x: f64| Number::from(crate::base::Rational::from_f64(x).expect("finite"));
        let error = &(&part(disc.value.re.hi) + &part(disc.value.re.lo)) - &truth;
        assert!(error.to_f64().abs() <= disc.radius && disc.relative_error() < 1e-8, "{disc:?} {}", error.to_f64());
    }
}
