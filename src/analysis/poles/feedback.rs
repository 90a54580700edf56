//! A force along a row that is proportional to the displacement, the velocity or the acceleration along it, as a square whose weight
//! changes is, in coordinates of the poles. In: a system and the row. Out: a matrix diag(D) - rho b v^T for all factors of the force,
//! whose eigenvalues are the poles, with a bound of what the true one has besides. docs/method/studies.md#one-weight-and-all-poles
//! derives it.

use crate::analysis::poles::disc_columns::UP;
use crate::analysis::poles::{all_modes, pole_coordinates};
use crate::base::{Ball, Number, Power};
use crate::kernel::complex::Complex;
use crate::kernel::rank_one::Pole;
use crate::system::{CoordinateId, Input, LinearSystem};

/// The matrix for a row and a power of s.
#[derive(Clone, Debug)]
pub struct Feedback {
    /// One of each conjugate pair.
    pub poles: Vec<Pole>,
    /// Bounds of the 2-norm of what the true matrix has besides: the first, and the second times the factor.
    pub off: [f64; 2],
    /// v . b, which an acceleration feeds back at once; zero for other powers.
    pub direct: Ball,
}

impl Feedback {
    /// `power`: 0, 1 or 2 for a spring, a damper or a mass on the row. `None` where the poles are no coordinates of the motion.
    pub fn of(system: &LinearSystem, row: &[(usize, Ball)], power: usize) -> Option<Feedback> {
        let first = system.coordinates.first()?;
        let force = row.iter().map(|(at, a)| (CoordinateId(*at as u32), Number::Ball(*a))).collect();
        let input =
            Input { name: first.name, span: first.span, unit: "N", b: [force, Vec::new(), Vec::new()], undamped: None };
        let driven = LinearSystem { inputs: vec![input], outputs: Vec::new(), initial: Vec::new(), ..system.clone() };
        let of = pole_coordinates(&driven, &all_modes(&driven).ok()?)?;
        let b = of.inputs.first()?[0].as_ref()?;
        let (tau, seen) = (of.coupling, of.sees(row));
        let v = seen.iter().zip(&of.scale).map(|(z, g)| z.scale(Ball::from(*g)));
        // v (D - T)^power instead of v, from the left.
        let (mut v, mut beside, mut direct): (Vec<Complex<Ball>>, f64, Ball) = (v.collect(), 0.0, Ball::ZERO);
        let is_real = |j: usize| of.pairs[j].is_real();
        let length = |list: &[Complex<Ball>], part: fn(Complex<Ball>) -> f64| {
            let square = |(j, z): (usize, &Complex<Ball>)| part(*z).power(2) * if is_real(j) { 1.0 } else { 2.0 };
            list.iter().enumerate().map(square).sum::<f64>().sqrt() * UP
        };
        for at in 1..=power {
            let before = length(&v, Complex::<Ball>::magnitude);
            v.iter_mut().zip(&of.pairs).for_each(|(v, pair)| *v = *v * pair.s.to_ball());
            // What T does to the exact vector of the power before, and to what that one has besides.
            let fastest = of.pairs.iter().map(|pair| pair.s.to_ball().magnitude()).fold(0.0, f64::max);
            beside = (beside * (fastest + tau) + before * tau) * UP;
            // An acceleration follows a force at once, a velocity and a displacement do not: v . b = 0 exactly.
            if (at, power) == (1, 2) {
                let both = |(j, (v, b)): (usize, (&Complex<Ball>, &Complex<Ball>))| {
                    let product = (*v * *b).re;
                    if is_real(j) { product } else { product * Ball::from(2.0) }
                };
                direct = v.iter().zip(b).enumerate().map(both).fold(Ball::ZERO, |sum, x| sum + x);
                direct = direct.widen(beside * length(b, Complex::<Ball>::magnitude) * UP);
            }
        }
        let sizes = [length(b, Complex::<Ball>::magnitude), length(&v, Complex::<Ball>::magnitude)];
        let doubts = [length(b, Complex::<Ball>::radius), length(&v, Complex::<Ball>::radius)];
        let of_factor = (doubts[0] * sizes[1] + sizes[0] * (doubts[1] + beside)) * UP;
        let both = of.pairs.iter().zip(b.iter().zip(&v));
        let poles = both.map(|(pair, (b, v))| Pole { s: pair.s, b: b.mid(), v: v.mid() }).collect();
        Some(Feedback { poles, off: [tau, of_factor], direct })
    }
}
