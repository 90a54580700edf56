//! Noise that drives several inputs at different times: the common contribution of each pair of them. In: the transfer
//! functions as residues at poles, a delay, a density. Out: enclosures. See docs/method/random.md#delays.

use super::argument::{Argument, Point, Two};
use super::bands::{Bands, add_values, in_parts, laurent as direct_part, of_lines, pieces, to_mean_square};
use super::resolvent::{Line, Parts, Resolvent, Value, across};
use super::weight::Piece;
use crate::base::density::Density;
use crate::base::{Ball, Number, up};
use crate::kernel::complex::Complex;
use std::cell::OnceCell;

const UP: f64 = up::THOUSANDS;

/// A density times e^(-i w delay) and a power of the angular frequency, integrated over every pole of a system.
struct Turned {
    of_poles: Vec<[Value; 2]>,
    pieces: Vec<Piece>,
    more: i32,
    delay: Ball,
    /// Integrals over (i w)^m, m from -4 to 4, computed on demand; `None` if an integral does not exist.
    powers: [OnceCell<Option<Point>>; 9],
}

impl Turned {
    fn of(pieces: &[Piece], more: i32, delay: Ball, resolvent: &Resolvent) -> Option<Turned> {
        let mut of_poles = Vec::new();
        in_parts(pieces, more, delay, |panels| add_values(&mut of_poles, panels, resolvent))?;
        Some(Turned { of_poles, pieces: pieces.to_vec(), more, delay, powers: Default::default() })
    }

    /// The integral over (i w)^power.
    fn power(&self, power: i32) -> Option<Point> {
        let integral = || {
            let starts_at_zero = self.pieces.iter().any(|piece| !piece.from.is_positive());
            if power < 0 && starts_at_zero {
                return None;
            }
            let panels = |piece: &Piece| piece.panels(self.more + power, self.delay);
            let sum: Option<Point> =
                self.pieces.iter().try_fold(Complex::ZERO, |sum, piece| Some(sum + panels(piece)?.integral()));
            let quarters = (0..power.rem_euclid(4)).fold(sum?, |z, _| Complex::new(-z.im, z.re));
            Some(quarters)
        };
        *self.powers[(power + 4) as usize].get_or_init(integral)
    }

    /// The integral of sum p_b (i w - D_b)^-1 g_b over all blocks, of which the real part counts.
    fn over_poles(&self, resolvent: &Resolvent, rows: &[Vec<Point>], columns: &[Vec<Point>]) -> Ball {
        let of = |(b, [direct, mirrored]): (usize, &[Value; 2])| {
            let (p, g) = (&rows[b], &columns[b]);
            let own = direct.between(p, g).re;
            if resolvent.is_real(b) {
                return own;
            }
            let conj = |x: &[Point]| x.iter().map(|z| z.conj()).collect::<Vec<Point>>();
            own + mirrored.between(&conj(p), &conj(g)).re
        };
        self.of_poles.iter().enumerate().map(of).fold(Ball::ZERO, |sum, x| sum + x)
    }
}

/// Two of the inputs that a noise in bands drives.
pub struct Pair {
    first: usize,
    second: usize,
    /// With the delay of the first less that of the second, and with the opposite.
    turned: [Turned; 2],
}

/// All pairs of inputs with these delays, s; `None` if numbers leave their range or a delay turns the phase too often.
pub fn pairs(
    density: &Density,
    within: Option<[&Number; 2]>,
    more: i32,
    delays: &[&Number],
    resolvent: &Resolvent,
) -> Option<Vec<Pair>> {
    let pieces = pieces(density, within)?;
    let mut list = Vec::new();
    for first in 0..delays.len() {
        for second in first + 1..delays.len() {
            let delay = (delays[first] - delays[second]).to_ball();
            let of = |delay| Turned::of(&pieces, more, delay, resolvent);
            list.push(Pair { first, second, turned: [of(delay)?, of(-delay)?] });
        }
    }
    Some(list)
}

/// The mean square of an output reached by all inputs of a noise in bands: |sum H_j e^(-i w t_j)|^2 S.
pub fn mean_square(bands: &Bands, pairs: &[Pair], resolvent: &Resolvent, parts: &[Parts]) -> Option<Ball> {
    let own: Vec<(Ball, f64)> = parts.iter().map(|parts| bands.integral(resolvent, parts)).collect::<Option<_>>()?;
    let mut sum = own.iter().fold(Ball::ZERO, |sum, (own, _)| sum + *own);
    let mut off = own.iter().map(|(_, off)| off).sum::<f64>();
    let root = |place: usize| (own[place].0.magnitude() * bands.whole()).sqrt();
    for Pair { first, second, turned: [ahead, behind] } in pairs {
        let (a, b) = (&parts[*first], &parts[*second]);
        let mut both = ahead.over_poles(resolvent, &a.p, &resolvent.mirrored_all(a, b))
            + behind.over_poles(resolvent, &b.p, &resolvent.mirrored_all(b, a));
        for (place, factor) in laurent(resolvent, a, b).into_iter().enumerate() {
            if !factor.is_zero() {
                both = both + ahead.power(place as i32 - 4)?.re * factor;
            }
        }
        sum = sum + both * Ball::from(2.0);
        // |H_j conj H_k| is off by |H_j| e_k + |H_k| e_j + e_j e_k at most (Schwarz).
        off += 2.0 * (a.slack * root(*second) + b.slack * root(*first) + a.slack * b.slack * bands.whole()) * UP;
    }
    to_mean_square(sum, off * UP)
}

/// The coefficients of s^-4 .. s^4 in H_a(s) H_b(-s), apart from its poles.
fn laurent(resolvent: &Resolvent, a: &Parts, b: &Parts) -> [Ball; 9] {
    let mut powers = [Ball::ZERO; 9];
    for (k, x) in a.direct.iter().enumerate() {
        for (l, y) in b.direct.iter().enumerate() {
            let product = *x * *y;
            powers[k + l] = powers[k + l] + if l % 2 == 0 { product } else { -product };
        }
    }
    let (mixed, mirrored) = (beside_poles(resolvent, a, b), beside_poles(resolvent, b, a));
    for place in 0..9 {
        let other = if place % 2 == 0 { mirrored[place] } else { -mirrored[place] };
        powers[place] = powers[place] + mixed[place] + other;
    }
    powers
}

/// What sum p (s - D)^-1 q of `a` times the direct part of `b` at -s has of powers of s: s^2 / (s - D) = s + D + D^2 / (s - D), for
/// one.
fn beside_poles(resolvent: &Resolvent, a: &Parts, b: &Parts) -> [Ball; 9] {
    let mut powers = [Ball::ZERO; 9];
    let mut add = |power: i32, factor: Ball, of_poles: i32| {
        if !factor.is_zero() {
            let place = (power + 4) as usize;
            powers[place] = powers[place] + factor * resolvent.sum(a, of_poles);
        }
    };
    let [e, f, _, g, h] = b.direct;
    add(0, -g, 0);
    add(1, h, 0);
    add(0, h, 1);
    add(-1, f, -1);
    add(-1, -e, -2);
    add(-2, -e, -1);
    powers
}

/// The covariance of the contributions of two inputs under white noise of unit intensity that reaches the second one
/// later by a positive time: sum p_b e^(D_b t) g_b over the poles of the first. Nothing reaches the output directly.
pub fn covariance(resolvent: &Resolvent, first: &Parts, second: &Parts, later: Ball) -> Ball {
    let of = |a: &Parts, b: &Parts, later: Ball| {
        let columns = resolvent.mirrored_all(a, b);
        resolvent.over_blocks(|block, d| across(&a.p[block], &propagate(d, &columns[block], later)))
    };
    // H is off by at most `slack` times a bound of the resolvent, whose mean square over the axis is half the distance
    // of the poles from it.
    let root = |parts: &Parts| of(parts, parts, Ball::ZERO).magnitude().sqrt();
    let slack = |parts: &Parts| parts.slack * (0.5 * resolvent.farthest()).sqrt() * UP;
    let (a, b) = (slack(first), slack(second));
    let off = (a * root(second) + b * root(first) + a * b) * UP;
    of(first, second, later).widen(off)
}

/// The covariance of each mode's contribution by one input with the whole contribution of another that is reached later
/// by a time, under white noise of unit intensity, in binary64.
pub fn shared_covariance(one: &[Line], other: &[Line], later: f64) -> Vec<f64> {
    let modes = one.first().map_or(0, |line| line.of_modes.len());
    let mut sum = vec![0.0; modes];
    for a in one {
        for b in other {
            // The integral of e^(s_a u) e^(s_b u), the first or the second from the delay on.
            let delayed = if later > 0.0 { a.s } else { b.s };
            let [size, angle] = [delayed.re, delayed.im].map(|x| x * later.abs());
            let turn = Complex::new(libm::cos(angle), libm::sin(angle)).scale(libm::exp(size));
            let both = -(a.q * b.p * b.q * turn * (a.s + b.s).recip());
            sum.iter_mut().zip(&a.of_modes).for_each(|(sum, p)| *sum += (*p * both).re);
        }
    }
    sum
}

/// The same covariances for noise in bands, in both orders of each pair: the integral of re H_i conj H over the
/// contribution of one input to the mode and of another to the output. `direct`: the direct paths of each.
pub fn shared_in_bands(pairs: &[Pair], resolvent: &Resolvent, arms: &[(Vec<Line>, [f64; 5])]) -> Option<Vec<f64>> {
    let modes = arms.first()?.0.first()?.of_modes.len();
    let mut sum = vec![0.0; modes];
    for Pair { first, second, turned: [ahead, behind] } in pairs {
        for (turned, opposite, one, other) in [(ahead, behind, first, second), (behind, ahead, second, first)] {
            let ((one, _), (other, direct)) = (&arms[*one], &arms[*other]);
            let part = turned.shared_covariance(opposite, resolvent, one, (other, direct))?;
            sum.iter_mut().zip(part).for_each(|(sum, part)| *sum += part / (2.0 * std::f64::consts::PI));
        }
    }
    Some(sum)
}

impl Turned {
    /// The covariance of each mode's contribution by the first of two inputs with the whole contribution of the second.
    /// `opposite`: the same integrals with the opposite delay.
    fn shared_covariance(
        &self,
        opposite: &Turned,
        resolvent: &Resolvent,
        one: &[Line],
        (other, direct): (&[Line], &[f64; 5]),
    ) -> Option<Vec<f64>> {
        let own = of_lines(&self.of_poles, resolvent)?;
        let mirrored = of_lines(&opposite.of_poles, resolvent)?;
        let power = |power: i32| Some(self.power(power)?.to_f64());
        let [a, b, _, d, e] = direct.map(Complex::real);
        // 1 / ((i w - s) (-i w - z)) by partial fractions, and the remaining powers of i w over i w - s.
        let weight = |line: &Line, integral: Complex<f64>| -> Option<Complex<f64>> {
            let pairs = other.iter().zip(&mirrored).fold(Complex::ZERO, |sum: Complex<f64>, (other, back)| {
                sum - other.p * other.q * (integral + *back) * (line.s + other.s).recip()
            });
            let mut weight = pairs + direct_part(direct, line.s) * integral;
            let inverse = line.s.recip();
            if direct[3] != 0.0 || direct[4] != 0.0 {
                weight = weight - d * power(0)? + e * (power(1)? + line.s * power(0)?);
            }
            if direct[0] != 0.0 || direct[1] != 0.0 {
                weight = weight + b * inverse * power(-1)? - a * inverse * (power(-2)? + inverse * power(-1)?);
            }
            Some(weight * line.q)
        };
        let weights: Vec<Complex<f64>> =
            one.iter().zip(&own).map(|(line, i)| weight(line, *i)).collect::<Option<_>>()?;
        let of_mode = |i: usize| one.iter().zip(&weights).map(|(line, weight)| (line.of_modes[i] * *weight).re).sum();
        Some((0..one.first()?.of_modes.len()).map(of_mode).collect())
    }
}

/// e^(D t) q
fn propagate(d: &[Vec<Point>], q: &[Point], t: Ball) -> Vec<Point> {
    if t.is_zero() {
        return q.to_vec();
    }
    match d {
        [row] => vec![exponential(Complex::scale(row[0], t)) * q[0]],
        _ => {
            let d = Two(std::array::from_fn(|i| std::array::from_fn(|j| d[i][j]))).scale(t);
            let rows = exponential_of_two(d).0;
            rows.map(|row| row[0] * q[0] + row[1] * q[1]).into()
        }
    }
}

/// e^z of a number with a negative real part; a bound if it is too small for a number.
fn exponential(z: Point) -> Point {
    const LEAST: f64 = -690.0;
    if z.re.mid.hi + z.re.rad < LEAST {
        return Argument::widen(Point::ZERO, 1e-299);
    }
    let turn = Number::Ball(z.im).sin_cos();
    match (Number::Ball(z.re).exp(), turn) {
        (Some(size), Some((sine, cosine))) => {
            Complex::scale(Complex::new(cosine.to_ball(), sine.to_ball()), size.to_ball())
        }
        (Some(size), None) => Argument::widen(Point::ZERO, size.to_ball().magnitude()),
        (None, _) => Argument::widen(Point::ZERO, f64::INFINITY),
    }
}

/// e^D as e^m e^N, where m is the mean of D and N the rest, by its power series.
fn exponential_of_two(d: Two) -> Two {
    const MOST_TERMS: usize = 200;
    let mean = d.mean();
    let rest = d.plus(Two::of(-mean));
    let size = rest.size();
    let is_small = size < 20.0;
    if !is_small {
        // |e^N| is at most e^|N|.
        let bound = exponential(Complex::real((mean.re + Ball::from(size)) * Ball::ONE)).magnitude();
        return Argument::widen(Two::of(Point::ZERO), bound);
    }
    let (mut sum, mut term, mut left) =
        (Two::of(Complex::real(Ball::ONE)), Two::of(Complex::real(Ball::ONE)), f64::INFINITY);
    for k in 1..MOST_TERMS {
        let count = k as f64;
        term = Argument::scale(term.times(rest), Ball::ONE / Ball::from(count));
        sum = sum.plus(term);
        if size < 0.5 * count {
            left = term.size() * 2.0 * UP;
            if left < 1e-40 {
                break;
            }
        }
    }
    Argument::widen(sum, left).times(Two::of(exponential(mean)))
}
