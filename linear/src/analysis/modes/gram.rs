//! X^T (sum w a a^T) X from the terms, with a bound of every entry's error: all entries in double-double, single ones
//! in triple words on request.
//!
//! With b_t = a_t^T X the entry is sum_t w_t b_ti b_tj. Let w = w' + dw and b = b' + db, where w' and b' are the
//! computed values of the true w and b, |dw| <= v, |db| <= r. Then, by Cauchy and Schwarz with the weights |w'|,
//!
//!   |computed - true| <= gamma S_i S_j + S_i R_j + R_i S_j + R_i R_j + D_i D_j,
//!   S_i^2 = sum |w'| b'_i^2,   R_i^2 = sum |w'| r_i^2,   D_i^2 = sum v (|b'_i| + r_i)^2,
//!
//! where for T terms gamma = (3 T + 16) 2^-106 in double-double: two products of 5u^2 and T sums of 3u^2 (see [`Dd`]),
//! u = 2^-53; and gamma = (T + 4) 2^-151 in triple words. See docs/method/modes.md#certificate.

use crate::analysis::modes::terms::Terms;
use crate::base::{Dd, rounding, up};
use crate::kernel::dense::{Matrix, dot};
use crate::kernel::triple::{Precise, Triple};

/// Covers the roundings of sums of up to eight million numbers that are not negative.
pub const SLACK: f64 = up::MILLIONS;
/// u^2 = 2^-106.
const UNIT_SQUARED: f64 = rounding::UNIT_SQUARED;
/// Products below 2^-969 lose bits of their low parts, a few units of 2^-1074 each.
const UNDERFLOW: f64 = 1e-318;

/// A form in the basis of the columns of some X.
#[derive(Clone, Debug)]
pub struct Gram<'a> {
    terms: &'a Terms<'a>,
    /// b = a . x: one row for each term, one column for each column of X.
    stretches: Matrix<Precise>,
    pub mid: Matrix<Dd>,
    gamma: f64,
    norms: Vec<Norms>,
    floor: f64,
    /// A further uncertainty of the form: entry (i, j) may be off by the product of the numbers of columns i and j.
    slips: Vec<f64>,
}

/// S, R, D of a column: see the module.
#[derive(Clone, Copy, Debug)]
struct Norms {
    size: f64,
    slip: f64,
    doubt: f64,
}

impl Gram<'_> {
    /// The form in the basis of the columns of `x`, taken as exact numbers.
    pub fn of<'a>(terms: &'a Terms<'a>, x: &Matrix<Triple>) -> Gram<'a> {
        let (count, n) = (terms.len(), x.columns());
        let stretches = Matrix::from_fn(count, n, |t, j| terms.stretch(t, x.column(j)));
        let b = stretches.map(|s| s.value.dd());
        let weights: Vec<Dd> = terms.weights().map(|w| w.value.dd()).collect();
        let mut mid = Matrix::zeros(n, n);
        let mut weighted = vec![Dd::ZERO; count];
        for j in 0..n {
            for ((weighted, &w), &b) in weighted.iter_mut().zip(&weights).zip(b.column(j)) {
                *weighted = w * b;
            }
            for i in 0..=j {
                let entry = dot(&weighted, b.column(i));
                mid[(i, j)] = entry;
                mid[(j, i)] = entry;
            }
        }
        // Rounding triple words to double-double loses at most 2^-105 of them.
        let norms = (0..n).map(|j| Norms::of(terms, stretches.column(j), 2.0 * UNIT_SQUARED)).collect();
        let largest = (0..n).flat_map(|j| b.column(j)).fold(0.0, |m: f64, b| m.max(b.hi.abs()));
        let floor = count as f64 * UNDERFLOW * (1.0 + largest) * (1.0 + largest);
        Gram {
            terms,
            stretches,
            mid,
            gamma: (3.0 * count as f64 + 16.0) * UNIT_SQUARED,
            norms,
            floor,
            slips: vec![0.0; n],
        }
    }

    /// The form up to a matrix whose entry (i, j) is at most slips_i slips_j.
    pub fn with_slips(self, slips: Vec<f64>) -> Self {
        Gram { slips, ..self }
    }

    /// A bound of the error of entry (i, j) of `mid`.
    #[inline]
    pub fn radius(&self, i: usize, j: usize) -> f64 {
        Norms::radius(self.gamma, self.norms[i], self.norms[j], self.floor) + self.slips[i] * self.slips[j] * SLACK
    }

    /// An upper bound of |entry (i, j)|.
    #[inline]
    pub fn magnitude(&self, i: usize, j: usize) -> f64 {
        self.mid[(i, j)].hi.abs() * SLACK + self.radius(i, j)
    }

    /// Entry (i, j) in triple words.
    pub fn precise(&self, i: usize, j: usize) -> Precise {
        let (x, y) = (self.stretches.column(i), self.stretches.column(j));
        let mut value = Triple::ZERO;
        for ((w, x), y) in self.terms.weights().zip(x).zip(y) {
            value = value + (w.value * x.value) * y.value;
        }
        let norms = |j: usize| Norms::of(self.terms, self.stretches.column(j), 0.0);
        let gamma = (self.terms.len() as f64 + 4.0) * Triple::ERROR;
        let slip = self.slips[i] * self.slips[j] * SLACK;
        Precise { value, radius: Norms::radius(gamma, norms(i), norms(j), self.floor) + slip }
    }

    pub fn is_finite(&self) -> bool {
        let n = self.mid.columns();
        (0..n).all(|j| self.mid.column(j).iter().all(|x| x.is_finite()) && self.radius(j, j).is_finite())
    }
}

impl Norms {
    /// The norms of a column of stretches, each known to `relative` in addition to its own radius.
    fn of(terms: &Terms, column: &[Precise], relative: f64) -> Norms {
        let (mut size, mut slip, mut doubt) = (0.0, 0.0, 0.0);
        for (w, b) in terms.weights().zip(column) {
            let (weight, stretch) = (w.value.hi().abs(), b.value.hi().abs());
            let radius = b.radius + relative * stretch;
            size += weight * stretch * stretch;
            slip += weight * radius * radius;
            doubt += (w.radius + relative * weight) * (stretch + radius) * (stretch + radius);
        }
        let root = |x: f64| (x * SLACK).sqrt() * SLACK;
        Norms { size: root(size), slip: root(slip), doubt: root(doubt) }
    }

    #[inline]
    fn radius(gamma: f64, x: Norms, y: Norms, floor: f64) -> f64 {
        let slips = x.size * y.slip + x.slip * (y.size + y.slip);
        SLACK * (gamma * x.size * y.size + slips + x.doubt * y.doubt + floor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::test_systems::{blank, push};
    use crate::base::{Ball, Number, Rational};
    use crate::system::{CoordinateId, Nature};

    /// Entries of X^T K X against exact fractions, for weights that are not binary numbers and vectors that are taken
    /// as exact.
    #[test]
    fn entries_are_within_their_radii() {
        let mut system = blank(3);
        let weights = ["0.1", "0.7", "1e9", "3.3e-7"];
        for (t, weight) in weights.iter().enumerate() {
            push(&mut system.k, weight, t % 3, (t > 0).then_some((t + 1) % 3));
        }
        let terms = Terms::of(&system.k);
        let x = [[1.0, 1.0 + 1e-10, 1.0 - 1e-9], [0.3, -0.2, 0.7]];
        let gram = Gram::of(&terms, &Matrix::from_fn(3, 2, |i, j| Triple::from(x[j][i])));
        let exact = |x: f64| Number::from(Rational::from_f64(x).expect("finite"));
        for (i, j) in [(0, 0), (0, 1), (1, 1)] {
            let mut truth = Number::ZERO;
            for term in system.k.terms() {
                let stretch = |x: &[f64; 3]| {
                    let parts = system.k.row(term).iter().map(|(c, a)| a * &exact(x[c.index()]));
                    parts.fold(Number::ZERO, |sum, part| &sum + &part)
                };
                truth = &truth + &(&(term.weight * &stretch(&x[i])) * &stretch(&x[j]));
            }
            let mid = gram.mid[(i, j)];
            let error = (&(&exact(mid.hi) + &exact(mid.lo)) - &truth).abs().to_f64();
            assert!(error > 0.0 && error <= gram.radius(i, j), "{error:e} {:e}", gram.radius(i, j));
            let Precise { value, radius } = gram.precise(i, j);
            let (dd, rest) = value.split();
            let error = (&(&(&exact(dd.hi) + &exact(dd.lo)) + &exact(rest)) - &truth).abs().to_f64();
            assert!(
                error <= radius + 1e-47 * truth.to_f64().abs() && radius < gram.radius(i, j),
                "{error:e} {radius:e}"
            );
        }
    }

    /// Weights and rows at the ends of what is known of them, one at a time: a column that sees what is known beside one that sees
    /// what is not, and one beside itself.
    #[test]
    fn entries_hold_those_of_the_worst_terms() {
        // (row entry, what it is uncertain by) of two coordinates, and the weight likewise; every number is a power of two.
        let r = 1.0 / (1u64 << 40) as f64;
        let cases = [
            ([(2.0, 0.0), (0.0, r)], (4.0, 0.0)),
            ([(0.0, r), (8.0, 0.0)], (0.25, 0.0)),
            ([(2.0, 0.0), (0.5, 0.0)], (4.0, r)),
            ([(2.0, 0.0), (0.5, 0.0)], (-4.0, r)),
            ([(2.0, 0.0), (0.5, 0.0)], (0.0, r)),
            ([(0.0, 0.125), (0.5, 0.0)], (0.0, r)),
            ([(0.0, 0.125), (0.0, 0.25)], (0.0, 64.0)),
            ([(0.0, 8.0), (0.0, 2.0)], (16.0, 0.0)),
            ([(1.0, 8.0), (2.0, 0.25)], (16.0, 4.0)),
        ];
        let number = |(value, radius): (f64, f64)| Number::Ball(Ball::new(Dd::from(value), radius));
        for (row, weight) in cases {
            // The same twice, one of them with the other columns: sums over terms.
            let mut system = blank(2);
            let source = system.k.source(system.coordinates[0].name);
            for turned in [false, true] {
                let at = |i: usize| (CoordinateId(i as u32), number(row[if turned { 1 - i } else { i }]));
                system.k.push(source, Nature::Property, number(weight), [at(0), at(1)]);
            }
            let terms = Terms::of(&system.k);
            let x = Matrix::from_fn(2, 2, |i, j| Triple::from(if i == j { 1.0 } else { 0.0 }));
            let slips = [r, 3.0 * r];
            for with_slips in [false, true] {
                let gram = Gram::of(&terms, &x);
                let gram = if with_slips { gram.with_slips(slips.to_vec()) } else { gram };
                for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    let slip = if with_slips { slips[i] * slips[j] } else { 0.0 };
                    for [a, b, w] in [[1.0, 1.0, 1.0], [-1.0, 1.0, 1.0], [1.0, 1.0, -1.0], [-1.0, -1.0, -1.0]] {
                        let weight = Dd::from(weight.0) + Dd::from(w * weight.1);
                        let ends = [0, 1].map(|c| Dd::from(row[c].0) + Dd::from([a, b][c] * row[c].1));
                        let truth = weight * ends[i] * ends[j] + weight * ends[1 - i] * ends[1 - j];
                        let off = (truth - gram.mid[(i, j)]).abs().to_f64() + slip;
                        assert!(
                            off <= gram.radius(i, j),
                            "{row:?} {weight:?} {i} {j}: {off:e} {:e}",
                            gram.radius(i, j)
                        );
                        let size = truth.abs().to_f64() + slip;
                        assert!(size <= gram.magnitude(i, j), "{row:?} {weight:?} {i} {j}: {size:e}");
                        let Precise { value, radius } = gram.precise(i, j);
                        let off = (truth - value.dd()).abs().to_f64() + slip;
                        assert!(off <= radius, "{row:?} {weight:?} {i} {j}: {off:e} {radius:e}");
                    }
                }
            }
        }
    }
}
