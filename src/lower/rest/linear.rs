//! The rest of large parts with a quadratic energy: K q = f by sparse factors, refined with exact residuals.
//! See docs/method/rest.md.
//!
//! For chains and networks of springs, whose K has no positive entry off its diagonal: given a vector w > 0 for which v =
//! K w > 0, every |q - q~| is at most w max_i |f - K q~|_i / v_i (A. Neumaier, *Interval Methods for Systems of
//! Equations*, 1990, section 3.6: K is an M-matrix, so its inverse has no negative entry). For other matrices, scaled to
//! ones on the diagonal by S: |S^-1 (q - q~)| is at most |S (f - K q~)| divided by a lower bound of the least eigenvalue
//! of S K S.

use super::definite::{Scaled, estimate};
use super::proof::Proven;
use super::survey::{Part, Survey};
use crate::base::{Ball, Dd, Number, Power, larger, up};
use crate::elements::Scalar;
use crate::kernel::sparse::ldl::{Factors, Symmetric};
use crate::kernel::squares::{Squares, by_factor};
use crate::lower::constraints::Reduction;
use crate::lower::kinematics::{Index, Kinematics};
use crate::system::LinearSystem;

/// The rest of one part.
pub struct Solved {
    pub displacement: Vec<(Index, Number)>,
    pub residual: f64,
    pub proven: Option<Proven>,
}

/// Coordinates with a force that nothing balances, N or N m.
pub type UnbalancedForces = Vec<(Index, f64)>;

/// The stiffness of a part, in local numbers.
pub struct Stiffness {
    n: usize,
    squares: Squares<Ball>,
}

/// Limit on the refinements: each gains the sixteen digits of binary64, less those lost to the conditioning.
const MAX_REFINEMENTS: usize = 10;

pub fn solve(
    kinematics: &Kinematics,
    reduction: &Reduction,
    system: &LinearSystem,
    survey: &Survey,
    parts: &[&Part],
) -> Vec<Result<Solved, UnbalancedForces>> {
    let members: Vec<Vec<Index>> = parts.iter().map(|part| independent(part, reduction)).collect();
    let mut stiffness: Vec<Stiffness> = members.iter().map(|members| Stiffness::new(members.len())).collect();
    // Part and place in it of each coordinate of the system.
    let mut places = vec![(usize::MAX, 0); system.n()];
    for (number, members) in members.iter().enumerate() {
        for (local, coordinate) in members.iter().enumerate() {
            if let Some(place) = reduction.place(*coordinate) {
                places[place.index()] = (number, local as u32);
            }
        }
    }
    for term in system.k.terms() {
        let row = system.k.row(term);
        if let Some(stiffness) = row.first().and_then(|(first, _)| stiffness.get_mut(places[first.index()].0)) {
            let row = row.iter().map(|(i, value)| (places[i.index()].1, value.to_ball()));
            stiffness.push(term.weight.to_ball(), row);
        }
    }
    let forces = |members: &[Index]| members.iter().map(|i| force(kinematics, survey, *i)).collect();
    members.iter().zip(&stiffness).map(|(members, stiffness)| solve_part(members, stiffness, forces(members))).collect()
}

/// The coordinates of a part that are coordinates of the system as well.
fn independent(part: &Part, reduction: &Reduction) -> Vec<Index> {
    part.coordinates.iter().copied().filter(|i| reduction.place(*i).is_some()).collect()
}

/// -dV/dq as drawn, for a coordinate in metres or radians.
fn force(kinematics: &Kinematics, survey: &Survey, coordinate: Index) -> Ball {
    let slope = &survey.forces[coordinate as usize];
    match kinematics.length_squared(coordinate) {
        Some(length_squared) => -slope.over(&length_squared.root()).to_ball(),
        None => -slope.to_ball(),
    }
}

fn solve_part(members: &[Index], stiffness: &Stiffness, forces: Vec<Ball>) -> Result<Solved, UnbalancedForces> {
    let solution = solve_proven(stiffness, &forces).map_err(|row| vec![(members[row], forces[row].to_f64())])?;
    let displacement = members.iter().zip(&solution.values).map(|(i, value)| (*i, Number::Ball(*value)));
    Ok(Solved { displacement: displacement.collect(), residual: solution.residual, proven: solution.proven })
}

/// The solution of K q = f.
pub struct Solution {
    pub values: Vec<Ball>,
    /// Largest unbalanced force, relative to the largest that acts.
    pub residual: f64,
    pub proven: Option<Proven>,
}

/// Solves K q = f, or names the row of a pivot that is rounding only.
pub fn solve_proven(stiffness: &Stiffness, forces: &[Ball]) -> Result<Solution, usize> {
    let factors = stiffness.factors()?;
    let mut middle = vec![Dd::ZERO; forces.len()];
    let mut last = f64::INFINITY;
    let mut left = stiffness.remaining_forces(forces, &middle);
    for _ in 0..MAX_REFINEMENTS {
        let mut step: Vec<f64> = left.iter().map(Ball::to_f64).collect();
        factors.solve(&mut step);
        let size = step.iter().map(|step| step.abs()).fold(0.0, f64::max);
        if size.is_nan() || size >= last {
            break;
        }
        last = size;
        for (at, step) in middle.iter_mut().zip(&step) {
            *at += Dd::from(*step);
        }
        left = stiffness.remaining_forces(forces, &middle);
    }
    let bounds = stiffness.bounds_of_springs(&factors, &left).or_else(|| stiffness.bounds_by_the_least(&left));
    // Without a proof: another refinement would change far less than the last one.
    let radius = |i: usize| bounds.as_ref().map_or(last, |(bounds, _)| bounds[i]);
    let values = middle.iter().enumerate().map(|(i, middle)| Ball::new(*middle, radius(i))).collect();
    let largest = forces.iter().map(Ball::magnitude).fold(0.0, f64::max);
    let residual = left.iter().map(|left| left.mid.hi.abs()).fold(0.0, f64::max) / largest;
    Ok(Solution { values, residual, proven: bounds.map(|(_, proven)| proven) })
}

impl Stiffness {
    pub fn new(n: usize) -> Stiffness {
        Stiffness { n, squares: Squares::with_capacity(0) }
    }

    pub fn push(&mut self, weight: Ball, row: impl Iterator<Item = (u32, Ball)>) {
        self.squares.push(weight, row);
    }

    /// Each weight with its row.
    fn squares(&self) -> impl Iterator<Item = (Ball, &[u32], &[Ball])> {
        self.squares.weights.iter().enumerate().map(|(t, &weight)| {
            let (indices, factors) = self.squares.row(t);
            (weight, indices, factors)
        })
    }

    /// The factors in binary64, or the row of a pivot that is only a rounding error.
    fn factors(&self) -> Result<Factors, usize> {
        let (mut places, mut values) = (Vec::new(), Vec::new());
        for (weight, indices, factors) in self.squares() {
            for (a, (&i, left)) in indices.iter().zip(factors).enumerate() {
                for (&j, right) in indices[..=a].iter().zip(factors) {
                    places.push((i, j));
                    values.push(weight.to_f64() * left.to_f64() * right.to_f64());
                }
            }
        }
        let mut matrix = Symmetric::pattern(self.n, &places);
        matrix.fill(values);
        matrix.factor(|_| 0.0, 1e-15).map_err(|stopped| stopped.row)
    }

    /// f - K q, with K q as the sum of w (a . q) a, which keeps digits that the assembled matrix would lose.
    fn remaining_forces(&self, forces: &[Ball], at: &[Dd]) -> Vec<Ball> {
        let mut left = forces.to_vec();
        for (t, (weight, indices, factors)) in self.squares().enumerate() {
            let tension = weight * self.squares.stretch(t, at);
            for (&i, &factor) in indices.iter().zip(factors) {
                left[i as usize] = left[i as usize] - by_factor(tension, factor);
            }
        }
        left
    }

    /// Bounds of |q - q~|, if K is an M-matrix.
    fn bounds_of_springs(&self, factors: &Factors, left: &[Ball]) -> Option<(Vec<f64>, Proven)> {
        let springs = |(weight, _, factors): (Ball, &[u32], &[Ball])| match factors {
            [_] => true,
            [a, b] => weight.is_positive() && (*a * *b).is_negative(),
            _ => false,
        };
        if !self.squares().all(springs) {
            return None;
        }
        let mut w = vec![1.0; self.n];
        factors.solve(&mut w);
        if !w.iter().all(|w| *w > 0.0) {
            return None;
        }
        // K w = -(0 - K w), in balls.
        let at: Vec<Dd> = w.iter().map(|w| Dd::from(*w)).collect();
        let v: Vec<f64> = self.remaining_forces(&vec![Ball::ZERO; self.n], &at).iter().map(|v| least(-*v)).collect();
        let regular = Proven::positivity(&w, &v)?;
        let worst = left.iter().zip(&v).map(|(left, v)| left.magnitude() / v).fold(0.0, larger);
        Some((w.iter().map(|w| w * worst * up::FEW).collect(), regular))
    }
}

impl Stiffness {
    /// Bounds of |q - q~| where the least eigenvalue of S K S is certainly positive.
    fn bounds_by_the_least(&self, left: &[Ball]) -> Option<(Vec<f64>, Proven)> {
        let entries = self.squares().flat_map(|(weight, indices, factors)| {
            let entry = move |a: usize, b: usize| (indices[a], indices[b], weight * factors[a] * factors[b]);
            (0..indices.len()).flat_map(move |a| (0..=a).map(move |b| entry(a, b)))
        });
        let scaled = Scaled::to_ones(self.n, entries.collect())?;
        let sigma = 0.5 * estimate(&scaled.factor(0.0, 0.0)?, self.n);
        let least = scaled.least_eigenvalue(sigma)?;
        let regular = Proven::definiteness(least)?;
        let squares = left.iter().zip(&scaled.scale).map(|(left, scale)| (left.magnitude() * scale).power(2));
        // Sums and products of n positive numbers: the factor covers their roundings for n below 1e8.
        let norm = squares.sum::<f64>().sqrt() * up::HUNDREDS_OF_MILLIONS;
        Some((scaled.scale.iter().map(|scale| norm / least * scale * up::FEW).collect(), regular))
    }
}

/// The least number of a positive ball; 0 for any other.
fn least(ball: Ball) -> f64 {
    if ball.is_positive() { ball.mignitude() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::Rational;

    /// The solution for sum w a a^T of rational numbers with q_i = (i + 1) / 3, which is not a binary number; and the
    /// true values.
    fn solve_case(n: usize, squares: &[(i64, Vec<(u32, i64)>)]) -> (Solution, Vec<Number>) {
        let truth: Vec<Number> = (0..n as i64).map(|i| Number::from(Rational::new(i + 1, 3))).collect();
        let mut forces = vec![Number::ZERO; n];
        let mut all = Stiffness::new(n);
        for (weight, row) in squares {
            all.push(Number::from(*weight).to_ball(), row.iter().map(|(i, a)| (*i, Number::from(*a).to_ball())));
            let parts = row.iter().map(|(i, a)| &Number::from(*a) * &truth[*i as usize]);
            let stretch = parts.fold(Number::ZERO, |sum, part| &sum + &part);
            for (i, a) in row {
                forces[*i as usize] = &forces[*i as usize] + &(&stretch * &Number::from(weight * a));
            }
        }
        let forces: Vec<Ball> = forces.iter().map(Number::to_ball).collect();
        (solve_proven(&all, &forces).unwrap_or_else(|row| panic!("row {row}")), truth)
    }

    fn check(n: usize, squares: &[(i64, Vec<(u32, i64)>)]) {
        let (solution, truth) = solve_case(n, squares);
        assert!(solution.proven.is_some());
        for (value, truth) in solution.values.iter().zip(&truth) {
            let part = |x: f64| Number::from(Rational::from_f64(x).expect("finite"));
            let error = (&(&part(value.mid.hi) + &part(value.mid.lo)) - truth).abs().to_f64();
            assert!(error > 0.0 && error <= value.rad, "{error:e} {:e}", value.rad);
            assert!(value.rad <= 1e-22 * truth.to_f64(), "{:e}", value.rad);
        }
    }

    fn chain(n: u32) -> Vec<(i64, Vec<(u32, i64)>)> {
        let spring = |i: u32| (i64::from(1 + i % 7), if i == 0 { vec![(0, 1)] } else { vec![(i - 1, -1), (i, 1)] });
        (0..n).map(spring).collect()
    }

    #[test]
    fn truth_is_in_the_balls_of_a_chain_of_springs() {
        check(40, &chain(40));
    }

    /// Squares over three coordinates: not a network of springs.
    #[test]
    fn truth_is_in_the_balls_of_a_bending_beam() {
        let mut squares = chain(40);
        squares.extend((2..40).map(|i| (5, vec![(i - 2, 1), (i - 1, -2), (i, 1)])));
        check(40, &squares);
    }

    /// So nearly singular that no lower bound of the eigenvalues remains: solved, but not proven.
    #[test]
    fn nearly_singular_matrices_are_not_proven_regular() {
        let both = (1_000_000_000_000_000, vec![(0, 1), (1, 1)]);
        let (solution, _) = solve_case(2, &[both, (7, vec![(0, 1)])]);
        assert!(solution.proven.is_none());
    }

    /// A force of 1 +- 0.1 on a spring of 1: the displacement may be 1.1.
    #[test]
    fn uncertainty_of_a_force_is_in_the_rest() {
        for row in [vec![(0, Ball::ONE)], vec![(0, Ball::ONE), (1, -Ball::ONE), (2, Ball::ONE)]] {
            let mut squares = Stiffness::new(3);
            (0..3).for_each(|i| squares.push(Ball::ONE, [(i, Ball::ONE)].into_iter()));
            squares.push(Ball::ZERO, row.into_iter());
            let forces = [Ball::ONE.widen(0.1), Ball::ZERO, Ball::ZERO];
            let value = solve_proven(&squares, &forces).unwrap_or_else(|row| panic!("row {row}")).values[0];
            assert!((value.mid.hi - 1.1).abs() <= value.rad + 1e-15, "{value:?}");
        }
    }
}
