//! H and its first two derivatives with respect to s, at a frequency or over an interval of frequencies, by sparse
//! elimination in discs: Q x0 = b, Q x1 = b' - Q' x0, Q x2 = b'' - 2 Q' x1 - Q'' x0. In: a prepared system, a frequency
//! as a ball. Out: enclosures for every frequency of the ball. See docs/method/transfer.md#extrema-of-larger-systems.

use crate::analysis::transfer::inverse::Entry;
use crate::analysis::transfer::sparse::Scalar;
use crate::analysis::transfer::{Disc, MatrixEntry, Transfer, feed_through};
use crate::base::{Ball, Number};
use crate::kernel::complex::Complex;
use crate::system::CoordinateId;

/// H, dH/ds, d2H/ds2
#[derive(Clone, Copy, Debug)]
pub struct Jet([Complex<Ball>; 3]);

type Powers = [Vec<(CoordinateId, Number)>; 3];

impl Jet {
    /// H and its derivatives for all frequencies of a ball, rad/s; `None` if Q may be singular.
    pub fn of(transfer: &Transfer, omega: Ball, input: usize, output: usize) -> Option<Jet> {
        Jet::at(transfer, Complex::new(Ball::ZERO, omega), input, output)
    }

    /// H and its derivatives anywhere in the complex plane; `None` if Q may be singular.
    pub fn at(transfer: &Transfer, s: Complex<Ball>, input: usize, output: usize) -> Option<Jet> {
        Jet::from_entries(transfer, s, (input, output), rectangle)
    }

    /// H and its derivatives in binary64, without bounds: to approach a place where an enclosure is worth its cost.
    pub fn in_binary64(transfer: &Transfer, omega: f64, input: usize, output: usize) -> Option<Jet> {
        let exactly = |z: Complex<f64>| Complex::new(Ball::from(z.re), Ball::from(z.im));
        Jet::from_entries(transfer, Complex::new(Ball::ZERO, Ball::from(omega)), (input, output), exactly)
    }

    fn from_entries<T: Scalar>(
        transfer: &Transfer,
        s: Complex<Ball>,
        (input, output): (usize, usize),
        enclosed: impl Fn(T) -> Complex<Ball>,
    ) -> Option<Jet> {
        let square = s * s;
        let entry = |e: &MatrixEntry| {
            let value = Complex::real(e.k) + s.scale(e.c) + square.scale(e.m);
            Entry { i: e.i, j: e.j, value }
        };
        let entries: Vec<Entry> = transfer.entries.iter().map(entry).collect();
        let factors = transfer.pattern.as_ref()?.factor::<T>(&entries)?;
        let (input_row, output_row) = (&transfer.system.inputs[input], &transfer.system.outputs[output]);
        let mut x: [Vec<Complex<Ball>>; 3] = [Vec::new(), Vec::new(), Vec::new()];
        for order in 0..3 {
            let mut load = dense(&input_row.b, s, order, transfer.system.n());
            for e in &transfer.entries {
                let (i, j) = (e.i as usize, e.j as usize);
                let slope = || Complex::real(e.c) + s.scale(Ball::from(2.0) * e.m);
                match order {
                    0 => {}
                    1 => load[i] = load[i] - slope() * x[0][j],
                    _ => load[i] = load[i] - (slope() * x[1][j] + x[0][j].scale(e.m)).scale(Ball::from(2.0)),
                }
            }
            x[order] = factors.solve(&load).into_iter().map(&enclosed).collect();
        }
        let d = feed_through(output_row, input);
        let read = |order: usize| {
            // Leibniz: sum over k of (order over k) P^(k) x^(order - k)
            let binomial = [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 2.0, 1.0]][order];
            let mut sum = derivative(d, s, order);
            for k in 0..=order {
                for (i, p) in sparse(&output_row.p, s, k) {
                    sum = sum + (p * x[order - k][i]).scale(Ball::from(binomial[k]));
                }
            }
            sum
        };
        Some(Jet([read(0), read(1), read(2)]))
    }

    pub fn value(&self) -> Complex<Ball> {
        self.0[0]
    }

    /// Half of d|H|^2 / d omega = Re (conj H i H'), where H' is the derivative with respect to s.
    pub fn slope(&self) -> Ball {
        let [h, first, _] = self.0;
        h.im * first.re - h.re * first.im
    }

    /// The derivative of [`Self::slope`] with respect to omega: |H'|^2 - Re (conj H H'').
    pub fn curvature(&self) -> Ball {
        let [h, first, second] = self.0;
        first.re.square() + first.im.square() - (h.re * second.re + h.im * second.im)
    }
}

fn rectangle(disc: Disc) -> Complex<Ball> {
    Complex::new(Ball::new(disc.value.re, disc.radius), Ball::new(disc.value.im, disc.radius))
}

/// The derivative of this order of a0 + a1 s + a2 s^2.
fn derivative(a: [Ball; 3], s: Complex<Ball>, order: usize) -> Complex<Ball> {
    let two = Ball::from(2.0);
    match order {
        0 => Complex::real(a[0]) + s.scale(a[1]) + (s * s).scale(a[2]),
        1 => Complex::real(a[1]) + s.scale(two * a[2]),
        _ => Complex::real(two * a[2]),
    }
}

fn sparse<'a>(powers: &'a Powers, s: Complex<Ball>, order: usize) -> impl Iterator<Item = (usize, Complex<Ball>)> + 'a {
    let unit = |power: usize, value: Ball| {
        let mut a = [Ball::ZERO; 3];
        a[power] = value;
        a
    };
    let entries = powers.iter().enumerate().flat_map(|(power, list)| list.iter().map(move |entry| (power, entry)));
    entries.map(move |(power, (i, value))| (i.index(), derivative(unit(power, value.to_ball()), s, order)))
}

fn dense(powers: &Powers, s: Complex<Ball>, order: usize, n: usize) -> Vec<Complex<Ball>> {
    let mut list = vec![Complex::ZERO; n];
    for (i, value) in sparse(powers, s, order) {
        list[i] = list[i] + value;
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::test_systems::oscillator;

    /// m = 1, c = 0.2, k = 1: |H|^2 = 1/D with D = (1 - w^2)^2 + 0.04 w^2, differentiated by hand.
    #[test]
    fn slope_and_curvature_are_those_of_the_textbook() {
        let system = oscillator("1", "0.2", "1");
        let transfer = Transfer::of(&system);
        for w in [0.25, 0.5, 1.0, 1.5, 3.0f64] {
            let d = (1.0 - w * w).powi(2) + 0.04 * w * w;
            let (first, second) = (-4.0 * w * (1.0 - w * w) + 0.08 * w, -4.0 + 12.0 * w * w + 0.08);
            let jet = Jet::of(&transfer, Ball::from(w), 0, 0).expect("regular");
            let slope = -first / (2.0 * d * d);
            let curvature = first * first / d.powi(3) - second / (2.0 * d * d);
            for (found, truth) in [(jet.slope(), slope), (jet.curvature(), curvature)] {
                assert!(
                    (found.to_f64() - truth).abs() <= found.rad + 1e-12 * curvature.abs(),
                    "{w}: {found:?} {truth}"
                );
            }
        }
    }
}
