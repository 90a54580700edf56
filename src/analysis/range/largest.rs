//! The largest |H| over frequencies, for ranges of parameters. In: systems over the same ranges, each with the derivatives by another
//! parameter. Out: an enclosure of the largest |H| for all values, and of its derivatives. See docs/method/studies.md#tolerances.
//!
//! |H| at any frequency is a lower bound of the largest one. Where |H| is certainly below the best of these bounds there is no largest
//! one, so that the derivatives of |H| at the frequencies that are left enclose those of the largest |H|: if all of them are positive,
//! |H| at a frequency where it is largest grows with the parameter, and the largest one is at least that.
//!
//! A peak moves with its mode. So frequencies are multiples of the omega of one mode, which depends on the parameters: the derivatives
//! are those along with the peak, where it takes much narrower ranges to tell their sign.

use super::linear::{JetMatrix, solve};
use super::{Family, Path, Phasor, number};
use crate::base::{Ball, Dd, Jet, Number, up};
use crate::kernel::complex::Complex;
use crate::kernel::dense::Matrix;
use crate::kernel::dense::lu::Lu;
use crate::system::CoordinateId;

/// The path from an input, or from the velocity (1) or acceleration (2) of a base, to an output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Way {
    pub input: usize,
    pub output: usize,
    pub rate: u8,
}

/// The largest |H| over the ranges.
#[derive(Clone, Debug)]
pub struct Largest {
    pub value: Ball,
    /// Values of |H| over ranges that it took.
    pub evaluations: usize,
    /// By the parameter of each system.
    pub slopes: Vec<Ball>,
}

/// Evaluations in one search.
pub const MOST_CELLS: usize = 64;
/// The largest |H| need not be known better than this for its derivatives to be.
const NEAR: f64 = 1.02;
/// A range of frequencies so narrow, as a share of them, is cut only if that makes |H| less by more than a little.
const NARROW: f64 = 0.15;
const LITTLE_LESS: f64 = 0.95;
/// Beyond the fastest pole by this factor, |H| is bounded for all frequencies at once.
const BEYOND: f64 = 4.0;

/// Frequencies, rad/s, and what |H| is there.
struct Cell {
    low: f64,
    high: f64,
    upper: f64,
    /// Not worth cutting: the ranges of the parameters make |H| uncertain, not that of the frequency.
    is_last: bool,
}

/// `band`: in rad/s, without an end if the second one is `None`; `sizes`: the least and the largest size of the poles, and the omega of
/// modes, with the derivative by the parameter of each system. These count where the band is that of all frequencies.
pub fn largest(
    families: &[Family],
    way: Way,
    band: (Ball, Option<Ball>),
    (sizes, references): ([f64; 2], &[Vec<Number>]),
) -> Option<Largest> {
    let family = families.first()?;
    // The mode at whose frequency the gain is largest in the middle of the ranges.
    let roughly = |omegas: &&Vec<Number>| {
        let size = rough(family, way, omegas[0].enclosure().to_f64());
        if size.is_nan() { 0.0 } else { size }
    };
    let reference = references.iter().max_by(|a, b| roughly(a).total_cmp(&roughly(b)));
    let unit = reference.map_or(1.0, |omegas| omegas[0].enclosure().to_f64());
    let along = |own: usize, ratio: Ball| match reference {
        Some(omegas) => &Number::Ball(ratio) * &omegas[own],
        None => Number::Ball(ratio),
    };
    let first = (band.0.mid.hi - band.0.rad).next_down().max(0.0);
    let [slowest, fastest] = sizes.map(|size| size / unit);
    let last = match band.1 {
        Some(high) => (high.mid.hi + high.rad).next_up(),
        None => (BEYOND * fastest).max(2.0 * first),
    };
    if !(slowest > 0.0 && last.is_finite() && first < last) {
        return None;
    }
    let mut known = 0.0f64;
    let look = |low: f64, high: f64, known: &mut f64| {
        let middle = 0.5 * (low + high);
        if let Some(found) = magnitude(family, way, along(0, Ball::from(middle))) {
            *known = known.max((found.value.mid.hi - found.value.rad * up::FEW) * (1.0 - f64::EPSILON));
        }
        let upper =
            magnitude(family, way, along(0, between(low, high))).map_or(f64::INFINITY, |found| found.value.magnitude());
        Cell { low, high, upper: if upper.is_nan() { f64::INFINITY } else { upper }, is_last: false }
    };
    let mut cells = Vec::new();
    let (mut low, mut high) = (first, if first > 0.0 { 2.0 * first } else { (0.5 * slowest).min(last) });
    while low < last && cells.len() < MOST_CELLS {
        cells.push(look(low, high.min(last), &mut known));
        (low, high) = (high, 2.0 * high);
    }
    if low < last {
        return None;
    }
    while cells.len() < MOST_CELLS {
        let worst = (0..cells.len()).max_by(|&a, &b| cells[a].upper.total_cmp(&cells[b].upper).then(b.cmp(&a)))?;
        let Cell { low, high, upper, is_last } = cells[worst];
        let middle = 0.5 * (low + high);
        if upper <= NEAR * known || is_last || !(low < middle && middle < high) {
            break;
        }
        let halves = [look(low, middle, &mut known), look(middle, high, &mut known)];
        let is_last = high - low < NARROW * high && halves.iter().any(|half| half.upper > LITTLE_LESS * upper);
        let [first, second] = halves.map(|half| Cell { is_last: is_last && upper.is_finite(), ..half });
        cells[worst] = first;
        cells.push(second);
    }
    let mut evaluations = 2 * cells.len();
    let mut upper = 0.0f64;
    let mut slopes: Vec<Option<Ball>> = vec![None; families.len()];
    for cell in cells.iter().filter(|cell| cell.upper >= known) {
        upper = upper.max(cell.upper);
        for (own, (family, all)) in families.iter().zip(&mut slopes).enumerate() {
            let slope = magnitude(family, way, along(own, between(cell.low, cell.high)))?.slope;
            *all = Some(all.map_or(slope, |all| hull(all, slope)));
            evaluations += 1;
        }
    }
    if band.1.is_none() {
        let end = along(0, Ball::from(last)).enclosure();
        if tail(family, way, (end.mid.hi - end.rad).next_down())? > known {
            return None;
        }
    }
    let middle = 0.5 * (known + upper);
    let value = Ball::from(middle).widen((upper - middle).max(middle - known) * up::FEW);
    let slopes: Option<Vec<Ball>> = slopes.into_iter().collect();
    Some(Largest { value, evaluations, slopes: slopes.filter(|_| value.is_finite())? })
}

/// |H| in the middle of the ranges, in binary64 and without a bound.
fn rough(family: &Family, Way { input, output, rate }: Way, omega: f64) -> f64 {
    let n = family.coordinates();
    let middle = |number: &Number| number.enclosure().to_f64();
    let Some(Path { b, p, d }) = family.path(input, output, &Number::Ball(Ball::from(omega))) else { return 0.0 };
    let complex = |z: &Phasor| Complex::new(middle(&z.re), middle(&z.im));
    let entry = |i: usize, j: usize| {
        let [k, c, m] = [&family.k, &family.c, &family.m].map(|form| middle(&form[i][j]));
        Complex::new(k - omega * omega * m, omega * c)
    };
    let Some(lu) = Lu::of(Matrix::from_fn(n, n, entry)) else { return f64::INFINITY };
    let mut x: Vec<Complex<f64>> = b.iter().map(complex).collect();
    lu.solve(&mut x);
    let h = x.iter().zip(&p).fold(complex(&d), |sum, (x, p)| sum + complex(p) * *x);
    let power = (0..rate).fold(1.0, |power, _| power * omega);
    (h.re * h.re + h.im * h.im).sqrt() / power
}

/// |H| at frequencies, rad/s; `None` if it may be infinite.
fn magnitude(family: &Family, Way { input, output, rate }: Way, omega: Number) -> Option<Jet> {
    let power = i32::from(rate);
    let direct = || family.response(input, output, &omega)?.times_power(&omega, -power);
    // Near a resonance the force that makes the motion 1 is better known than the motion.
    let inverse = || {
        let size = family.inverse_response(input, output, &omega)?.times_power(&omega, power)?.size()?;
        Number::ONE.checked_div(&number(size))
    };
    let direct = direct().and_then(|z| z.size()).map(|size| family.jet_of(&number(size)));
    let inverse = inverse().map(|size| family.jet_of(&size));
    match (direct, inverse) {
        (Some(a), Some(b)) => Some(Jet {
            value: if a.value.magnitude() <= b.value.magnitude() { a.value } else { b.value },
            slope: if a.slope.rad <= b.slope.rad { a.slope } else { b.slope },
        }),
        (one, other) => one.or(other),
    }
}

const UNKNOWN: Ball = Ball { mid: Dd::ZERO, rad: f64::INFINITY };

/// A bound of |H| for all frequencies from one on, rad/s: with u = 1/omega, K - omega^2 M + i omega C = -omega^2 (M - u^2 K - i u C).
/// `None` if it grows with the frequency, or the matrix may be singular.
fn tail(family: &Family, Way { input, output, rate }: Way, from: f64) -> Option<f64> {
    let n = family.coordinates();
    let u = Number::Ball(between(0.0, (1.0 / from).next_up()));
    let re = |i: usize, j: usize| &family.m[i][j] - &(&u.square() * &family.k[i][j]);
    let im = |i: usize, j: usize| -&(&u * &family.c[i][j]);
    let matrix = JetMatrix::from_fn(2 * n, 2 * n, |i, j| match (i < n, j < n) {
        (true, true) | (false, false) => re(i % n, j % n),
        (true, false) => -&im(i, j - n),
        (false, true) => im(i - n, j),
    });
    let (from_input, to_output) = (family.system.inputs.get(input)?, family.system.outputs.get(output)?);
    let entry = |entries: &[(CoordinateId, Number)], i: usize| {
        let own = entries.iter().filter(|(at, _)| at.index() == i);
        own.fold(Number::ZERO, |sum, (_, value)| &sum + value)
    };
    // u^(2 + rate - j - k) for the terms of power j and k.
    let power = |used: usize| u32::try_from(2 + usize::from(rate)).ok()?.checked_sub(u32::try_from(used).ok()?);
    let largest_u = (1.0 / from).next_up();
    let mut sum = 0.0f64;
    for (k, column) in from_input.b.iter().enumerate().filter(|(_, column)| !column.is_empty()) {
        let found =
            solve(&matrix, &JetMatrix::from_fn(2 * n, 1, |i, _| if i < n { entry(column, i) } else { Number::ZERO }))?;
        for (j, row) in to_output.p.iter().enumerate().filter(|(_, row)| !row.is_empty()) {
            let along = |half: usize| {
                let part = |i: usize| &entry(row, i) * &number(found.entry(half * n + i, 0));
                (0..n).fold(Number::ZERO, |sum, i| &sum + &part(i))
            };
            let z = Phasor { re: along(0), im: along(1) };
            let bound = z.squared().enclosure().magnitude().sqrt() * up::FEW;
            let factor = (0..power(j + k)?).fold(1.0, |product, _| product * largest_u);
            sum += bound * factor * up::FEW;
        }
    }
    for (l, through) in to_output.d.iter().enumerate() {
        let own = through.iter().filter(|(known, value)| *known as usize == input && !value.is_zero());
        for (_, value) in own {
            let left = usize::from(rate).checked_sub(l)?;
            let factor = (0..left).fold(1.0, |product, _| product * largest_u);
            sum += value.enclosure().magnitude() * factor * up::FEW;
        }
    }
    let bound = sum * up::THOUSANDS;
    bound.is_finite().then_some(bound)
}

fn between(low: f64, high: f64) -> Ball {
    let middle = 0.5 * (low + high);
    Ball::from(middle).widen((high - middle).max(middle - low) * up::FEW)
}

/// A ball that contains both.
fn hull(a: Ball, b: Ball) -> Ball {
    if !(a.is_finite() && b.is_finite()) {
        return UNKNOWN;
    }
    let (low, high) = ((a.mid.hi - a.rad).min(b.mid.hi - b.rad), (a.mid.hi + a.rad).max(b.mid.hi + b.rad));
    // The low parts of the middles are within a rounding of their high parts.
    between(low, high).widen((low.abs() + high.abs()) * 4.0 * f64::EPSILON)
}
