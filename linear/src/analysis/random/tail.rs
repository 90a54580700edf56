//! The decay of a transfer function above all natural frequencies. In: a system with or without loss factors, the
//! forces on it and an output. Out: the first terms of its power series in t = 1 / w exactly, and the loads of the
//! rest. See docs/method/random.md#peaks.

use super::argument::Point;
use super::channel::{Channel, mass_solution};
use super::gramian::Space;
use super::lossy::Seen;
use crate::analysis::forms::{apply, dense, is_certain};
use crate::base::Number;
use crate::kernel::complex::Complex;
use crate::system::{CoordinateId, Form, LinearSystem};

/// H = t^order (constant + (i rate + t place) . z), where (M - i C t - (K + i H) t^2) z = loads + t slopes, and neither it nor H / t^order
/// is zero at t = 0.
pub struct Tail {
    pub order: usize,
    pub constant: Point,
    pub loads: Vec<Point>,
    pub slopes: Vec<Point>,
}

/// A vector of complex numbers.
struct Pair {
    re: Vec<Number>,
    im: Vec<Number>,
}

impl Tail {
    /// q / t^2 is the sum of t^j y_j from j = -1: y_-1 = -i h, M y_0 = -f, M y_j = i C y_(j - 1) + (K + i H) y_(j - 2).
    /// `None` if it is not decided which term is the first that the output shows.
    pub fn of(system: &LinearSystem, space: &Space, channel: &Channel, seen: &Seen) -> Option<Tail> {
        let n = system.n();
        let [plain, lossy] = seen.rows();
        let none = Form::default();
        let (h, lost) = match system.losses.as_deref() {
            Some(losses) => (&losses.h, channel.loss_force(losses)?),
            None => (&none, vec![Number::ZERO; n]),
        };
        // Accelerations follow from the forces.
        let moved = mass_solution(system, &dense(n, &plain.p[2]))?;
        let less = |row: &[(CoordinateId, Number)], form: &Form| with(&dense(n, row), &apply(form, &moved), -1);
        let (place, rate, turned) = (less(&plain.p[0], &system.k), less(&plain.p[1], &system.c), less(&lossy.p[0], h));
        let held = |y: &Pair| {
            let [k_re, k_im, h_re, h_im] =
                [(&system.k, &y.re), (&system.k, &y.im), (h, &y.re), (h, &y.im)].map(|(form, x)| apply(form, x));
            Pair { re: with(&k_re, &h_im, -1), im: with(&k_im, &h_re, 1) }
        };
        let damped =
            |y: &Pair| Pair { re: apply(&system.c, &y.im).iter().map(|x| -x).collect(), im: apply(&system.c, &y.re) };
        let mut load = Pair { re: channel.force.iter().map(|f| -f).collect(), im: lost.iter().map(|f| -f).collect() };
        let jump = mass_solution(system, &channel.jump)?;
        let mut before = Pair { re: vec![Number::ZERO; n], im: jump.iter().map(|h| -h).collect() };
        for order in 1..=2 * n + 2 {
            let y = Pair { re: mass_solution(system, &load.re)?, im: mass_solution(system, &load.im)? };
            let constant = [
                &across(&place, &before.re) - &across(&turned, &before.im),
                &across(&place, &before.im) + &across(&turned, &before.re),
            ];
            let term = [&constant[0] - &across(&rate, &y.im), &constant[1] + &across(&rate, &y.re)];
            let in_modes = |pair: &Pair| -> Vec<Point> {
                let (re, im) = (space.in_modes(&pair.re), space.in_modes(&pair.im));
                re.into_iter().zip(im).map(|(re, im)| Complex::new(re, im)).collect()
            };
            if term.iter().any(is_certain) {
                let [re, im] = constant.map(|part| part.to_ball());
                let (loads, slopes) = (in_modes(&load), in_modes(&held(&before)));
                return Some(Tail { order, constant: Complex::new(re, im), loads, slopes });
            }
            if !term.iter().all(Number::is_zero) {
                return None;
            }
            let (damped, held) = (damped(&y), held(&before));
            load = Pair { re: with(&damped.re, &held.re, 1), im: with(&damped.im, &held.im, 1) };
            before = y;
        }
        None
    }
}

/// a + sign b
fn with(a: &[Number], b: &[Number], sign: i32) -> Vec<Number> {
    a.iter().zip(b).map(|(a, b)| if sign < 0 { a - b } else { a + b }).collect()
}

fn across(a: &[Number], b: &[Number]) -> Number {
    a.iter().zip(b).filter(|(a, _)| !a.is_zero()).fold(Number::ZERO, |sum, (a, b)| &sum + &(a * b))
}
