//! The quasi-static response to a moving base: q = v + r u + r' u', where K r = b0 and K r' = b1 - C r, so that
//! only the velocity or the acceleration of the base drives v. In: a system, the action of u, and how many of its derivatives
//! are given. Out: r, r', and the forces that are left. See docs/method/transfer.md#velocities-and-accelerations-of-bases.

use super::forms::{apply, dense, solution_on};
use crate::base::{Number, Rational};
use crate::kernel::dense::enclosure::solve;
use crate::kernel::dense::lu::Lu;
use crate::kernel::dense::{Matrix, echelon};
use crate::system::{Form, LinearSystem, Origin, Term};

/// Maximum number of coordinates for which the static response is solved in fractions.
const MOST_STATIC: usize = 24;
/// Maximum number of coordinates for which it is computed at all: one elimination of a full matrix.
const MOST_COORDINATES: usize = 2000;

/// The quasi-static response to u, and the forces on the rest of the motion.
pub struct Following {
    /// r and r'; zero where they are not needed.
    pub followed: [Vec<Number>; 2],
    /// The forces on v by u, u', u'' and u'''; those by u, and by u' if the acceleration is given, are zero.
    pub forces: [Vec<Number>; 4],
}

/// The static responses that are accepted.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Known {
    /// Only exact ones, for verdicts that rest on a zero.
    Exactly,
    /// Enclosures as well.
    Enclosed,
}

impl Following {
    /// `inputs` are those that move together as u. `None` if a static response is not found.
    pub fn of(system: &LinearSystem, inputs: &[usize], derivative: usize, known: Known) -> Option<Following> {
        let zero = || vec![Number::ZERO; system.n()];
        let own = || inputs.iter().map(|&input| &system.inputs[input]);
        let [b0, mut b1, b2] = [0, 1, 2].map(|power| dense(system.n(), own().flat_map(|input| &input.b[power])));
        // Damping relative to what follows u has no force on it: exactly zero, whatever digits b1 has. Where nothing follows u, as where its
        // displacement is given, the damping's share of b1 is a force like the others.
        let undamped: Option<Vec<&[_]>> = own().map(|input| input.undamped.as_deref()).collect();
        let undamped = undamped.filter(|_| derivative > 0);
        let is_relative = undamped.is_some();
        if let Some(undamped) = undamped {
            b1 = dense(system.n(), undamped.into_iter().flatten());
        }
        let mut forces = [b0, b1, b2, zero()];
        let mut followed = [zero(), zero()];
        for (order, followed) in followed.iter_mut().enumerate().take(derivative) {
            let (response, is_exact) = static_response(system, &forces[order], known)?;
            *followed = response;
            for (power, form) in [&system.k, &system.c, &system.m].into_iter().enumerate() {
                let Some(force) = forces.get_mut(order + power) else { continue };
                *force = match (order, power) {
                    (_, 0) if !is_exact => zero(),
                    (0, 1) if is_relative => less(force, &apply(&dampers(form), followed)),
                    _ => less(force, &apply(form, followed)),
                };
            }
            if forces[order].iter().any(|force| !force.is_zero()) {
                return None;
            }
        }
        Some(Following { followed, forces })
    }
}

/// C without the damping that is declared for the whole system.
fn dampers(c: &Form) -> Form {
    let is_damping = |term: &Term| c.source_of(term.source).origin == Origin::Damping;
    let mut own = Form::new();
    for term in c.terms().filter(|term| !is_damping(term)) {
        let source = own.source(c.source_of(term.source));
        own.push(source, term.nature, term.weight.clone(), c.row(term).copies());
    }
    own
}

pub fn less(a: &[Number], b: &[Number]) -> Vec<Number> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// r with K r = b, and whether every number of it is exact. In most scenes it is a motion carried along by a base, of zeros and ones.
fn static_response(system: &LinearSystem, b: &[Number], known: Known) -> Option<(Vec<Number>, bool)> {
    let n = b.len();
    if b.iter().all(Number::is_zero) {
        return Some((vec![Number::ZERO; n], true));
    }
    if n > MOST_COORDINATES {
        return None;
    }
    let is_solution = |r: &[Number]| less(&apply(&system.k, r), b).iter().all(Number::is_zero);
    let k = system.k.assemble(n);
    if let Some(r) = near_solution(|i, j| k[i][j].to_f64(), b).filter(|r| is_solution(r)) {
        return Some((r, true));
    }
    let in_fractions = || {
        let b: Option<Vec<Rational>> = b.iter().map(|b| b.exact().cloned()).collect();
        let (r, _) = echelon::solution(&system.k.rational_entries(n)?, &b?)?;
        Some(r.into_iter().map(Number::from).collect())
    };
    if n <= MOST_STATIC
        && let Some(r) = in_fractions()
    {
        return Some((r, true));
    }
    match known {
        Known::Exactly => None,
        Known::Enclosed => Some((solution_on(&system.k, &(0..n).collect::<Vec<_>>(), b)?, false)),
    }
}

/// x with A x = b for a full matrix, of exact numbers if they are simple or few; `None` if A is or may be singular.
pub fn static_solution(a: &[Vec<Number>], b: &[Number]) -> Option<Vec<Number>> {
    let n = b.len();
    let is_solution = |x: &Vec<Number>| {
        a.iter()
            .zip(b)
            .all(|(row, b)| (&row.iter().zip(x).fold(Number::ZERO, |sum, (a, x)| &sum + &(a * x)) - b).is_zero())
    };
    let near = near_solution(|i, j| a[i][j].to_f64(), b).filter(is_solution);
    // A simple solution is the only one if A is regular, which the enclosure proves.
    let enclosed =
        solve(&Matrix::from_fn(n, n, |i, j| a[i][j].to_ball()), &Matrix::from_fn(n, 1, |i, _| b[i].to_ball()))?;
    if let Some(x) = near {
        return Some(x);
    }
    let rational = |row: &[Number]| row.iter().map(|x| x.exact().cloned()).collect::<Option<Vec<Rational>>>();
    if n <= MOST_STATIC
        && let Some(matrix) = a.iter().map(|row| rational(row)).collect::<Option<Vec<_>>>()
        && let Some(right) = rational(b)
        && let Some((x, true)) = echelon::solution(&matrix, &right)
    {
        return Some(x.into_iter().map(Number::from).collect());
    }
    Some((0..n).map(|i| Number::Ball(enclosed[(i, 0)])).collect())
}

/// The solution in binary64, each number rounded to a simple fraction.
fn near_solution(a: impl Fn(usize, usize) -> f64, b: &[Number]) -> Option<Vec<Number>> {
    const LARGEST_DENOMINATOR: i64 = 64;
    const NEAR: f64 = 1e-6;
    let n = b.len();
    let lu = Lu::of(Matrix::from_fn(n, n, a))?;
    let mut x: Vec<f64> = b.iter().map(Number::to_f64).collect();
    lu.solve(&mut x);
    let simple = |x: &f64| {
        (1..=LARGEST_DENOMINATOR).find_map(|denominator| {
            let numerator = x * denominator as f64;
            let whole = numerator.round();
            let is_near = (numerator - whole).abs() < NEAR && whole.abs() < 1e9;
            is_near.then(|| Number::from(Rational::new(whole as i64, denominator)))
        })
    };
    x.iter().map(simple).collect()
}
