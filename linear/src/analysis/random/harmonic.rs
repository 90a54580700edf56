//! Transfer functions from a noise to an output in modal coordinates, by elimination at a frequency or over an
//! interval, also with loss factors. In: a system in modal coordinates, the forces of the noise, the rows of the
//! output. Out: enclosures. See docs/method/random.md#loss-factors.

use super::argument::Point;
use super::gramian::Space;
use super::maxima::{power, quarters};
use super::resolvent::across;
use super::tail::Tail;
use crate::base::{Ball, Number, up};
use crate::kernel::complex::Complex;
use crate::kernel::dense::Matrix;
use crate::kernel::dense::enclosure::solve;

const UP: f64 = up::THOUSANDS;
/// Limit on the intervals over which |H| is tested for a decrease.
const MOST_STEPS: usize = 32;
const I: Point = Complex { re: Ball::ZERO, im: Ball::ONE };

/// The action of an arm on the modes: M q'' + C q' + (K + i H) q = force w, with the rate jumping by h w; and the
/// direct path, the factors of s^-2 .. s^2.
pub struct Drive {
    pub force: Vec<Point>,
    pub jump: Vec<Ball>,
    /// M h
    pub impulse: Vec<Ball>,
    /// K h
    pub held: Vec<Ball>,
    pub feed: [Point; 5],
    pub later: Ball,
}

/// Rows over the places and the rates of the modes.
pub struct Row {
    pub place: Vec<Point>,
    pub rate: Vec<Point>,
}

/// H from a noise to an output.
pub struct Response<'a> {
    pub space: &'a Space,
    /// X^T H X
    pub h: &'a Matrix<Ball>,
    pub row: Row,
    pub drives: Vec<Drive>,
    /// Of white noise, if it is known.
    pub tail: Option<Tail>,
}

impl Response<'_> {
    /// Multiplications of an elimination.
    pub fn work(&self) -> usize {
        (2 * self.space.n).pow(3)
    }

    /// H at an angular frequency: Q q = f + (C + s M) h, and q' = s q - h. First the contribution of each mode, and
    /// last that of the direct path.
    pub fn by_frequency(&self, omega: Point) -> Option<Vec<Point>> {
        let (space, s) = (self.space, omega * I);
        let loads: Vec<Vec<Point>> = self.drives.iter().map(|drive| self.load(drive, s)).collect();
        let places = solve_complex(&self.stiffness(omega), &loads)?;
        let mut parts = vec![Complex::ZERO; space.n + 1];
        for (drive, place) in self.drives.iter().zip(&places) {
            let turn = delay_factor(omega, drive.later)?;
            for i in 0..space.n {
                let rate = s * place[i] - Complex::real(drive.jump[i]);
                parts[i] = parts[i] + (self.row.place[i] * place[i] + self.row.rate[i] * rate) * turn;
            }
            parts[space.n] = parts[space.n] + feed_at(&drive.feed, s)? * turn;
        }
        Some(parts)
    }

    /// w H at a period 1 / w, without the direct path: (M - i C t - (K + i H) t^2) q / t = - t (f + C h) - i M h, and
    /// correspondingly q' / t with - i f + t (K + i H) h on the right.
    pub fn by_period(&self, period: Point) -> Option<Vec<Point>> {
        let [drive] = &self.drives[..] else { return None };
        let n = self.space.n;
        let damped = self.damping_forces(drive);
        let lost = |i: usize| (0..n).fold(Ball::ZERO, |sum, j| sum + self.h[(i, j)] * drive.jump[j]);
        let places =
            (0..n).map(|i| -(period * (drive.force[i] + Complex::real(damped[i]))) - I.scale(drive.impulse[i]));
        let rates = (0..n).map(|i| period * Complex::new(drive.held[i], lost(i)) - drive.force[i] * I);
        let found = solve_complex(&self.inertia(period), &[places.collect(), rates.collect()])?;
        let [place, rate] = &found[..] else { return None };
        Some((0..n).map(|i| self.row.place[i] * place[i] + self.row.rate[i] * rate[i]).collect())
    }

    /// An angular frequency above which |H| times w^-left decreases; `None` if none is found.
    pub fn falls_above(&self, left: i32) -> Option<f64> {
        let tail = self.tail.as_ref()?;
        let order = tail.order as f64 + f64::from(left);
        // Starts at 0, with intervals as wide as possible.
        let (mut period, mut step) = (0.0, 0.25 / self.space.s.iter().copied().fold(0.0, f64::max));
        for _ in 0..MOST_STEPS {
            let next = period + step;
            if self.falls_over(tail, order, [period, next]) == Some(true) {
                (period, step) = (next, 2.0 * step);
            } else {
                step *= 0.25;
            }
        }
        (period > 0.0).then(|| (1.0 / period).next_up())
    }

    /// Whether t |g'| < order |g| between two periods, H = t^order g.
    fn falls_over(&self, tail: &Tail, order: f64, [from, to]: [f64; 2]) -> Option<bool> {
        let (space, n) = (self.space, self.space.n);
        let t = Complex::real(Ball::from(0.5 * from + 0.5 * to).widen(0.5 * (to - from) * UP));
        let matrix = self.inertia(t);
        let one = |load: Vec<Point>| solve_complex(&matrix, &[load])?.pop();
        let z = one((0..n).map(|i| tail.loads[i] + t * tail.slopes[i]).collect())?;
        // The slope of the load, and (i C + 2 t (K + i H)) z.
        let two = Ball::from(2.0);
        let off = space.of_k * (0..n).map(|j| space.s[j] * z[j].magnitude()).sum::<f64>() * UP;
        let load = |i: usize| {
            let held = (0..n).fold(z[i].scale(space.k[i]), |sum, j| sum + (z[j] * I).scale(self.h[(i, j)]));
            let damped = (0..n).fold(Complex::ZERO, |sum: Point, j| sum + z[j].scale(space.c[(i, j)]));
            tail.slopes[i] + damped * I + (t * widen(held, space.s[i] * off)).scale(two)
        };
        let slope = one((0..n).map(load).collect())?;
        let (place, rate) = (across(&self.row.place, &z), across(&self.row.rate, &z));
        let g = tail.constant + rate * I + t * place;
        let g1 = across(&self.row.rate, &slope) * I + place + t * across(&self.row.place, &slope);
        let least = (g.re.square() + g.im.square()).sqrt().mignitude();
        Some(g1.magnitude() * to * UP < order * least)
    }

    /// C h
    fn damping_forces(&self, drive: &Drive) -> Vec<Ball> {
        let of = |i: usize| (0..self.space.n).fold(Ball::ZERO, |sum, j| sum + self.space.c[(i, j)] * drive.jump[j]);
        (0..self.space.n).map(of).collect()
    }

    /// f + (C + s M) h
    fn load(&self, drive: &Drive, s: Point) -> Vec<Point> {
        let damped = self.damping_forces(drive);
        (0..self.space.n).map(|i| drive.force[i] + Complex::real(damped[i]) + s.scale(drive.impulse[i])).collect()
    }

    /// K + i H + i w C - w^2 M
    fn stiffness(&self, omega: Point) -> Matrix<Point> {
        let (space, square) = (self.space, omega * omega);
        let slack = square.magnitude() * space.of_m * UP;
        Matrix::from_fn(space.n, space.n, |i, j| {
            let own = if i == j { Complex::real(space.k[i]) - square } else { Complex::ZERO };
            let value = own + (omega * I).scale(space.c[(i, j)]) + I.scale(self.h[(i, j)]);
            let of_k = space.of_k * space.s[i] * space.s[j] * UP;
            Complex::new(value.re.widen(slack + of_k), value.im.widen(slack))
        })
    }

    /// M - i C t - (K + i H) t^2
    fn inertia(&self, period: Point) -> Matrix<Point> {
        let (space, square) = (self.space, period * period);
        let small = square.magnitude() * UP;
        Matrix::from_fn(space.n, space.n, |i, j| {
            let (held, own) = if i == j { (space.k[i], Ball::ONE) } else { (Ball::ZERO, Ball::ZERO) };
            let value =
                Complex::real(own) - (period * I).scale(space.c[(i, j)]) - square * Complex::new(held, self.h[(i, j)]);
            let of_k = small * space.of_k * space.s[i] * space.s[j] * UP;
            Complex::new(value.re.widen(space.of_m + of_k), value.im.widen(of_k))
        })
    }

    /// H and its first two derivatives with respect to the angular frequency, over an interval of it: Q q1 = f1 - Q1 q,
    /// Q q2 = - 2 Q1 q1 - Q2 q.
    pub fn over(&self, omega: Ball) -> Option<[Point; 3]> {
        let (space, n) = (self.space, self.space.n);
        let at = Complex::real(omega);
        let s = at * I;
        let stiffness = self.stiffness(at);
        let two = Ball::from(2.0);
        // M, and Q1 = i C - 2 w M, times a vector.
        let inertia = |q: &[Point]| -> Vec<Point> {
            let slack = space.of_m * q.iter().map(|z| z.magnitude()).sum::<f64>() * UP;
            q.iter().map(|q| widen(*q, slack)).collect()
        };
        let slope = |q: &[Point]| -> Vec<Point> {
            let of = |(i, moved): (usize, Point)| {
                let damped = (0..n).fold(Complex::ZERO, |sum: Point, j| sum + q[j].scale(space.c[(i, j)]));
                damped * I - moved.scale(two * omega)
            };
            inertia(q).into_iter().enumerate().map(of).collect()
        };
        let mut total = [Complex::ZERO; 3];
        for drive in &self.drives {
            let one = |load: Vec<Point>| solve_complex(&stiffness, &[load])?.pop();
            let q = one(self.load(drive, s))?;
            let first: Vec<Point> = slope(&q)
                .into_iter()
                .zip(&drive.impulse)
                .map(|(slope, f)| Complex::new(Ball::ZERO, *f) - slope)
                .collect();
            let q1 = one(first)?;
            let second = slope(&q1).into_iter().zip(inertia(&q)).map(|(slope, m)| (m - slope).scale(two)).collect();
            let q2 = one(second)?;
            let mut sum = fed_with_slopes(&drive.feed, omega)?;
            for i in 0..n {
                let (place, rate) = (self.row.place[i], self.row.rate[i]);
                let rates =
                    [s * q[i] - Complex::real(drive.jump[i]), q[i] * I + s * q1[i], (q1[i] * I).scale(two) + s * q2[i]];
                for (sum, (q, own)) in sum.iter_mut().zip([q[i], q1[i], q2[i]].into_iter().zip(rates)) {
                    *sum = *sum + place * q + rate * own;
                }
            }
            let [g, g1, g2] = sum;
            let (turn, lag) = (delay_factor(at, drive.later)?, -(I.scale(drive.later)));
            let parts = [g, g1 + g * lag, g2 + (g1 * lag).scale(two) + g * lag * lag];
            total = std::array::from_fn(|i| total[i] + parts[i] * turn);
        }
        total.iter().all(|z| z.magnitude().is_finite()).then_some(total)
    }

    /// Whether |H|^2 is an even function of the frequency, so that its slope at zero is zero. It is not with both
    /// dampers and loss factors.
    pub fn is_even(&self) -> bool {
        let (n, row, drives) = (self.space.n, &self.row, &self.drives);
        let none = |matrix: &Matrix<Ball>| (0..n).all(|j| matrix.column(j).iter().all(Ball::is_zero));
        let of_drives = drives.iter().flat_map(|drive| drive.force.iter().chain(&drive.feed));
        let is_lossless = || none(self.h) && row.place.iter().chain(&row.rate).chain(of_drives).all(|z| z.im.is_zero());
        let is_placed = |drive: &Drive| {
            let at_rates = drive.jump.iter().all(Ball::is_zero) && is_zero(&drive.feed[1]) && is_zero(&drive.feed[3]);
            drive.later.is_zero() && at_rates
        };
        let is_undamped = none(&self.space.c) && row.rate.iter().all(is_zero);
        (is_undamped && drives.iter().all(is_placed)) || is_lossless()
    }
}

/// The solutions of a complex system, computed as a real one of twice the size.
fn solve_complex(entries: &Matrix<Point>, loads: &[Vec<Point>]) -> Option<Vec<Vec<Point>>> {
    let n = entries.rows();
    let of = |i: usize, j: usize| {
        let z = entries[(i % n, j % n)];
        match (i < n, j < n) {
            (true, true) | (false, false) => z.re,
            (true, false) => -z.im,
            (false, true) => z.im,
        }
    };
    let right = |i: usize, j: usize| if i < n { loads[j][i].re } else { loads[j][i - n].im };
    let x = solve(&Matrix::from_fn(2 * n, 2 * n, of), &Matrix::from_fn(2 * n, loads.len(), right))?;
    let column = |j: usize| (0..n).map(|i| Complex::new(x[(i, j)], x[(n + i, j)])).collect();
    let list: Vec<Vec<Point>> = (0..loads.len()).map(column).collect();
    list.iter().flatten().all(|z| z.magnitude().is_finite()).then_some(list)
}

/// The sum of factors of s^-2 .. s^2, with its derivatives with respect to w, s = i w.
fn fed_with_slopes(feed: &[Point; 5], omega: Ball) -> Option<[Point; 3]> {
    let mut sum = [Complex::ZERO; 3];
    for (place, factor) in feed.iter().enumerate().filter(|(_, factor)| !is_zero(factor)) {
        let exponent = place as i32 - 2;
        let turned = quarters(*factor, exponent);
        let powers = power(omega, exponent);
        sum = std::array::from_fn(|i| sum[i] + turned.scale(powers[i]));
    }
    sum.iter().all(|z| z.magnitude().is_finite()).then_some(sum)
}

fn widen(z: Point, by: f64) -> Point {
    Complex::new(z.re.widen(by), z.im.widen(by))
}

fn is_zero(z: &Point) -> bool {
    z.re.is_zero() && z.im.is_zero()
}

/// The sum of factors of s^-2 .. s^2.
fn feed_at(feed: &[Point; 5], s: Point) -> Option<Point> {
    let mut sum = Complex::ZERO;
    for (place, factor) in feed.iter().enumerate().filter(|(_, factor)| !is_zero(factor)) {
        let power = (0..place.abs_diff(2)).fold(Complex::real(Ball::ONE), |product: Point, _| product * s);
        sum = sum + if place < 2 { *factor / power } else { *factor * power };
    }
    sum.magnitude().is_finite().then_some(sum)
}

/// e^(-i w t)
fn delay_factor(omega: Point, later: Ball) -> Option<Point> {
    if later.is_zero() {
        return Some(Complex::real(Ball::ONE));
    }
    let (sine, cosine) = Number::Ball(omega.re * later).sin_cos()?;
    let size = Number::Ball(omega.im * later).exp()?.to_ball();
    Some(Complex::new(cosine.to_ball(), -sine.to_ball()).scale(size))
}
