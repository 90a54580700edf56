//! Mean squares by the transfer function as an exact quotient of polynomials, for cases in which the equations of
//! motion alone prove nothing: an unrestrained or undamped motion, or the drift of a base, may cancel in an output, and
//! exact arithmetic decides whether it does. In: a small system of rational numbers, a noise. Out: an enclosure, a
//! proof that the mean square is infinite, or nothing. See docs/method/random.md#cancellations.

use super::bands::{in_parts, over, pieces, starts_at_zero, to_mean_square};
use super::source::intensity;
use super::weight::Piece;
use super::{Reach, Spread, finite};
use crate::analysis::transfer::extrema::{Coefficients, Place, Quotient, near_and_far};
use crate::base::{Ball, Density, Number, Rational};
use crate::kernel::big_float::Float;
use crate::kernel::complex::Complex;
use crate::kernel::polynomial::Polynomial;
use crate::kernel::sturm::half_planes;
use crate::system::{LinearSystem, Noise, Output};

const AT_ZERO: &str = "infinite: nothing brings back a motion that noise drives on";
const DRIFTS: &str = "infinite: the base itself drifts, and the output with it";
const DIRECT: &str = "infinite: white noise reaches it without any inertia between";
const UNDAMPED: &str = "infinite: nothing damps what noise excites";

type Point = Complex<Ball>;

/// H = factor s^zeros above / below, without common roots or roots at zero in either polynomial.
struct Reduced {
    factor: Rational,
    zeros: i32,
    above: Polynomial,
    below: Polynomial,
}

/// The mean square of an output, or of its rate, under all of the noise or its part between two frequencies, Hz.
pub fn mean_square(
    system: &LinearSystem,
    reach: &Reach,
    noise: &Noise,
    output: &Output,
    is_rate: bool,
    within: Option<[&Number; 2]>,
) -> Option<Spread> {
    let reaching = || noise.inputs.iter().filter(|(input, _)| reach.from_input(system, *input, output));
    let (_, first) = reaching().next()?;
    if !reaching().all(|(_, delay)| (delay - first).is_zero()) {
        return None;
    }
    let inputs: Vec<usize> = reaching().map(|(input, _)| *input).collect();
    let quotient = Quotient::of(system, &inputs, output)?;
    // A motion that cancels may swing or drift for ever, but it must not grow.
    if half_planes(&quotient.below)?.right > 0 || quotient.above.is_zero() {
        return quotient.above.is_zero().then_some(Spread::Finite(Ball::ZERO));
    }
    let own = i32::from(is_rate) - i32::from(noise.derivative);
    let reduced = Reduced::of(&quotient, own)?;
    let why = if noise.derivative > 0 { DRIFTS } else { AT_ZERO };
    let is_damped = half_planes(&reduced.below)?.axis == 0;
    match (&noise.density, within) {
        (Density::White(value), None) => {
            let excess = reduced.above.degree() as i32 + reduced.zeros - reduced.below.degree() as i32;
            let infinite = match () {
                () if !value.is_positive() => return None,
                () if reduced.zeros < 0 => why,
                () if !is_damped => UNDAMPED,
                () if excess >= 0 => DIRECT,
                () => return Some(finite(Some(intensity(noise)? * reduced.white()?.to_ball()))),
            };
            Some(Spread::Infinite(infinite.into()))
        }
        _ if !is_damped => None,
        _ => {
            let pieces = pieces(&noise.density, within)?;
            if reduced.zeros < 0 && starts_at_zero(&noise.density, within)? {
                return Some(Spread::Infinite(why.into()));
            }
            Some(finite(reduced.band_mean_square(&pieces)))
        }
    }
}

impl Reduced {
    /// H times s^more, for a nonzero H.
    fn of(Quotient { factor, above, below }: &Quotient, more: i32) -> Option<Reduced> {
        let (zeros, above) = above.without_zero_roots();
        let (poles, below) = below.without_zero_roots();
        let common = above.gcd(&below)?;
        let zeros = zeros as i32 - poles as i32 + more;
        let (above, below) = (above.divided_by(&common)?, below.divided_by(&common)?);
        Some(Reduced { factor: factor.clone(), zeros, above, below })
    }

    /// The integral of |H|^2 over the axis divided by 2 pi, if there are more poles than zeros, all poles lie on the
    /// left, and none of H is zero: Routh's scheme with a second row for the numerator (Astrom, Introduction to
    /// Stochastic Control Theory, 1970, chapter 5).
    fn white(&self) -> Option<Rational> {
        let mut a = descending(&self.below);
        let shift = usize::try_from(self.zeros).ok()?;
        let mut b = descending(&self.above);
        b.extend(std::iter::repeat_n(Rational::ZERO, shift));
        let n = a.len() - 1;
        let mut padded = vec![Rational::ZERO; n.checked_sub(b.len())?];
        padded.append(&mut b);
        let mut b = padded;
        let mut sum = Rational::ZERO;
        while a.len() > 1 {
            if a[1].signum() <= 0 {
                return None;
            }
            let (alpha, beta) = (&a[0] / &a[1], &b[0] / &a[1]);
            sum = &sum + &(&(&beta * &beta) / &(&alpha + &alpha));
            let zero = Rational::ZERO;
            let at = |list: &[Rational], k: usize| list.get(k).unwrap_or(&zero).clone();
            let is_odd = |k: usize| k % 2 == 1;
            let next = |k: usize| if is_odd(k) { at(&a, k) } else { &at(&a, k) - &(&alpha * &at(&a, k + 1)) };
            // The coefficient of s^(n - k) in B is b[k - 1].
            let rest = |k: usize| if is_odd(k) { &at(&b, k - 1) - &(&beta * &at(&a, k)) } else { at(&b, k - 1) };
            let after: Vec<Rational> = (1..a.len()).map(next).collect();
            b = (2..a.len()).map(rest).collect();
            a = after;
        }
        Some(&sum * &(&self.factor * &self.factor))
    }

    /// The mean square under noise in bands: |H|^2 by partial fractions at simple poles, all of them on the left.
    fn band_mean_square(&self, pieces: &[Piece]) -> Option<Ball> {
        let [above, below] = [&self.above, &self.below].map(balls);
        let slope = balls(&self.below.derivative());
        // Poles with their residues, and the conjugates.
        let mut poles: Vec<(Point, Point)> = Vec::new();
        for root in near_and_far(&Coefficients::exact(self.below.clone()))?.list {
            if root.multiplicity > 1 || !matches!(root.place, Place::Real | Place::Pair) {
                return None;
            }
            let radius = root.radius.to_f64().next_up();
            let [re, im] =
                [&root.centre.re, &root.centre.im].map(|x| if x.is_zero() { Ball::ZERO } else { x.to_ball(radius) });
            let s: Point = Complex::new(re, im);
            let mirrored = Complex::new(-re, -im);
            let residue = at(&above, s) * at(&above, mirrored) / (at(&slope, s) * at(&below, mirrored));
            poles.push((s, residue));
            poles.extend((root.place == Place::Pair).then(|| (s.conj(), residue.conj())));
        }
        let mut sum = Ball::ZERO;
        in_parts(pieces, 2 * self.zeros, Ball::ZERO, |panels| {
            for (s, residue) in &poles {
                sum = sum + (*residue * over(panels, *s)).re * Ball::from(2.0);
            }
        })?;
        for (power, factor) in self.left_over()?.into_iter().enumerate().filter(|(_, factor)| !factor.is_zero()) {
            in_parts(pieces, 2 * (self.zeros + power as i32), Ball::ZERO, |panels| {
                let integral = panels.iter().fold(Ball::ZERO, |sum, one| sum + one.integral().re);
                sum = sum + factor.to_ball() * integral;
            })?;
        }
        to_mean_square(sum * self.factor.to_ball().square(), 0.0)
    }

    /// The factors of w^0, w^2, .. in |H|^2 / w^(2 zeros) less its partial fractions.
    fn left_over(&self) -> Option<Vec<Rational>> {
        let mut rest = square_on_axis(&self.above);
        let divisor = square_on_axis(&self.below);
        let lead = divisor.last()?;
        let mut found = vec![Rational::ZERO; (rest.len() + 1).saturating_sub(divisor.len())];
        for place in (0..found.len()).rev() {
            let factor = &rest[place + divisor.len() - 1] / lead;
            for (k, d) in divisor.iter().enumerate() {
                rest[place + k] = &rest[place + k] - &(&factor * d);
            }
            found[place] = factor;
        }
        Some(found)
    }
}

fn descending(f: &Polynomial) -> Vec<Rational> {
    f.coefficients().iter().rev().map(|a| Rational::from(num_rational::BigRational::from(a.clone()))).collect()
}

/// |f(i w)|^2 as a polynomial in w^2.
pub(super) fn square_on_axis(f: &Polynomial) -> Vec<Rational> {
    let mut ascending = descending(f);
    ascending.reverse();
    let n = ascending.len();
    let coefficient = |m: usize| {
        let from = (2 * m + 1).saturating_sub(n);
        (from..=(2 * m).min(n - 1)).fold(Rational::ZERO, |sum, k| {
            let product = &ascending[k] * &ascending[2 * m - k];
            // i^k (-i)^(2 m - k) = (-1)^(m - k)
            if (m + k).is_multiple_of(2) { &sum + &product } else { &sum - &product }
        })
    };
    (0..n).map(coefficient).collect()
}

fn balls(f: &Polynomial) -> Vec<Ball> {
    f.coefficients().iter().map(|a| Float::from(a.clone()).to_ball(0.0)).collect()
}

fn at(f: &[Ball], s: Point) -> Point {
    f.iter().rev().fold(Complex::ZERO, |sum: Point, a| sum * s + Complex::real(*a))
}
