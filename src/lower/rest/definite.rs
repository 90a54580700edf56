//! Large sparse symmetric matrices of balls, and a lower bound of their least eigenvalue. See docs/method/rest.md#proof.
//!
//! If the factorisation L D L^T of S H S - sigma, with S scaling the diagonal to ones, completes in binary64 with
//! positive D, the least eigenvalue of S H S exceeds sigma - e, e = 2^-52 n (longest row + 4) (S. M. Rump, *Verification
//! of positive definiteness*, BIT 46 (2006) 433: every entry rounds by gamma of its row times the roots of two diagonal
//! entries, here ones). The difference between the true matrix and the factored one is bounded by its largest row of
//! radii.

use crate::base::{Ball, larger, up};
use crate::kernel::sparse::ldl::{Factors, Symmetric};

/// A symmetric matrix S H S: one entry for each place, with a bound of its error.
pub struct Scaled {
    places: Vec<(u32, u32)>,
    middles: Vec<f64>,
    spreads: Vec<f64>,
    /// The diagonal of S.
    pub scale: Vec<f64>,
}

/// Steps of inverse iteration: each reduces the share of all other modes by the ratio of their eigenvalues.
const INVERSE_STEPS: usize = 12;

impl Scaled {
    /// H as the sum of its entries (i, j, value), each off-diagonal entry given in one triangle only, scaled to ones on
    /// its diagonal; `None` if the diagonal is not positive.
    pub fn to_ones(n: usize, entries: Vec<(u32, u32, Ball)>) -> Option<Scaled> {
        let mut diagonal = vec![0.0; n];
        for (i, _, value) in entries.iter().filter(|(i, j, _)| i == j) {
            diagonal[*i as usize] += value.to_f64();
        }
        let usable = diagonal.iter().all(|entry| *entry > 0.0 && entry.is_finite());
        usable.then(|| Scaled::with_scale(diagonal.iter().map(|entry| entry.sqrt().recip()).collect(), entries))?
    }

    /// H with a given scale; `None` if an entry is not finite.
    pub fn with_scale(scale: Vec<f64>, mut entries: Vec<(u32, u32, Ball)>) -> Option<Scaled> {
        let place = |(i, j, _): &(u32, u32, Ball)| (*i.max(j), *i.min(j));
        entries.sort_by_key(place);
        let mut result = Scaled { places: Vec::new(), middles: Vec::new(), spreads: Vec::new(), scale };
        for same in entries.chunk_by(|a, b| place(a) == place(b)) {
            let ball = same.iter().fold(Ball::ZERO, |sum, (_, _, value)| sum + *value);
            if !ball.is_finite() {
                return None;
            }
            let here = place(&same[0]);
            let factor = result.scale[here.0 as usize] * result.scale[here.1 as usize];
            let middle = ball.mid.hi * factor;
            result.places.push(here);
            result.middles.push(middle);
            // The low part, the radius, and the roundings of two products.
            let spread = (ball.mid.lo.abs() + ball.rad) * factor * up::DOZENS + 2.0 * f64::EPSILON * middle.abs();
            result.spreads.push(spread);
        }
        Some(result)
    }

    /// The factors of S H S - sigma; `None` if a pivot is below `least` times the terms it was made from.
    pub fn factor(&self, sigma: f64, least: f64) -> Option<Factors> {
        let mut matrix = Symmetric::pattern(self.scale.len(), &self.places);
        matrix.fill(self.middles.iter().copied());
        matrix.factor(|_| -sigma, least).ok()
    }

    /// A positive lower bound of the least eigenvalue of S H S, a little below sigma; `None` if that cannot be shown.
    pub fn least_eigenvalue(&self, sigma: f64) -> Option<f64> {
        let shifted = self.factor(sigma, 0.0)?;
        let rounding = f64::EPSILON * self.scale.len() as f64 * (shifted.longest_row() as f64 + 4.0);
        Some(sigma - rounding - self.largest_spread()).filter(|least| *least > 0.0)
    }

    /// H^-1 g, with the factors of S H S.
    pub fn solve(&self, factors: &Factors, g: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut step: Vec<f64> = g.zip(&self.scale).map(|(g, scale)| g * scale).collect();
        factors.solve(&mut step);
        step.iter().zip(&self.scale).map(|(z, scale)| z * scale).collect()
    }

    /// The largest row sum of the spreads: a bound of the norm of the matrix's error.
    fn largest_spread(&self) -> f64 {
        let mut rows = vec![0.0; self.scale.len()];
        for ((i, j), spread) in self.places.iter().zip(&self.spreads) {
            rows[*i as usize] += spread;
            if i != j {
                rows[*j as usize] += spread;
            }
        }
        rows.into_iter().fold(0.0, larger) * up::MILLIONS
    }
}

/// An estimate of the least eigenvalue of the matrix of these factors, by inverse iteration.
pub fn estimate(factors: &Factors, n: usize) -> f64 {
    let mut x = vec![1.0 / (n as f64).sqrt(); n];
    let mut size = 1.0;
    for _ in 0..INVERSE_STEPS {
        factors.solve(&mut x);
        size = x.iter().map(|x| x * x).sum::<f64>().sqrt();
        x.iter_mut().for_each(|x| *x /= size);
    }
    1.0 / size
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chain of n equal springs between two walls: the eigenvalues of K are 4 k sin^2(j pi / (2 n + 2)), its diagonal
    /// entries 2 k.
    #[test]
    fn the_least_eigenvalue_of_a_chain_is_bounded_from_below() {
        let n = 500;
        let k = Ball::from(3e7);
        let springs = (0..n).map(|i| (i, i, k + k)).chain((1..n).map(|i| (i, i - 1, -k)));
        let matrix = Scaled::to_ones(n as usize, springs.collect()).expect("a positive diagonal");
        let truth = 2.0 * (std::f64::consts::PI / f64::from(2 * n + 2)).sin().powi(2);
        let factors = matrix.factor(0.0, 0.0).expect("positive definite");
        let guess = estimate(&factors, n as usize);
        assert!((guess / truth - 1.0).abs() < 1e-2, "{guess:e} {truth:e}");
        let least = matrix.least_eigenvalue(0.9 * truth).expect("below the least");
        assert!(least < truth && least > 0.8 * truth, "{least:e} {truth:e}");
        assert_eq!(matrix.least_eigenvalue(1.1 * truth), None);
    }

    /// [1 c; c 1] in other units, each entry uncertain by r, has a least eigenvalue of 1 - c - 2r, or so where the scale is not
    /// known exactly either: a bound beyond it proves nothing, and one that is nearly as large is found.
    #[test]
    fn radii_of_all_entries_are_in_the_bound() {
        let (c, r) = (0.9, 0.02);
        for units in [[1.0, 1.0], [1e-3, 5e2], [3e4, 3e4]] {
            let entry = |i: usize, j: usize, value: f64, r: f64| {
                (i as u32, j as u32, Ball::new((value * units[i] * units[j]).into(), r * units[i] * units[j]))
            };
            let least = |r: f64| {
                let entries = vec![entry(0, 0, 1.0, r), entry(0, 1, c, r), entry(1, 1, 1.0, r)];
                Scaled::to_ones(2, entries).expect("a positive diagonal").least_eigenvalue((1.0 - c) * (1.0 - 1e-9))
            };
            let found = least(r).expect("positive");
            assert!(found <= (1.0 - c) - 2.0 * r && found > (1.0 - c) - 2.01 * r, "{units:?}: {found}");
            assert_eq!(least(0.0501), None, "{units:?}");
            // The middle one of three rows has two entries beside its diagonal, one in each triangle: at their worst they take off
            // (1 + sqrt 2) r of 1 - c sqrt 2.
            let (c, root) = (0.5, 2f64.sqrt());
            let wide = |i: usize, j: usize, value: f64| (i as u32, j as u32, Ball::new(value.into(), r));
            let three = (0..3).map(|i| wide(i, i, 1.0)).chain((1..3).map(|i| wide(i, i - 1, -c))).collect();
            let least = (1.0 - c * root) * (1.0 - 1e-9);
            let found = Scaled::to_ones(3, three).expect("a positive diagonal").least_eigenvalue(least);
            assert!(found.is_some_and(|found| found <= (1.0 - c * root) - (1.0 + root) * r), "{found:?}");
            // The low word of an entry counts, as it is not in the factors.
            let (low, high) = (crate::base::Dd { hi: 1.0, lo: 1e-17 }, Ball::from(1.0));
            let spread = Scaled::to_ones(2, vec![(0, 0, Ball::exact(low)), (1, 1, high)]).expect("positive").spreads;
            assert!(spread[0] >= spread[1] + 1e-17, "{spread:?}");
        }
    }
}
