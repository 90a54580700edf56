//! What is known of a basis, at its worst: systems whose X^T M X, X^T C X and X^T K X lie at the ends of what is known of them, whose H
//! exact arithmetic knows by elimination. A term that a bound lacks shows where nothing else is large: one entry is off at a time,
//! and input and output see one mode each.

use super::*;
use crate::analysis::answer::ModeKind;
use crate::analysis::modes::form::ModalForm;
use crate::analysis::test_systems::blank;
use crate::analysis::transfer::Frequency;
use crate::base::{Number, Rational};
use crate::kernel::dense::Matrix;
use crate::system::CoordinateId;
use num_rational::BigRational;
use num_traits::Zero;

/// What an entry is off by: less than a basis may be.
const OFF: f64 = 1.0 / (1u64 << 31) as f64;

type Square = Vec<Vec<f64>>;

/// A system in modal coordinates, and what is known of it.
struct Case {
    /// M, C and K
    truth: [Square; 3],
    known: [Matrix<Ball>; 3],
    rigid: usize,
}

fn diagonal(entries: &[f64]) -> Square {
    let n = entries.len();
    (0..n).map(|i| (0..n).map(|j| if i == j { entries[i] } else { 0.0 }).collect()).collect()
}

/// sum_kl weights[k][l] w_k w_l^T
fn sum_of_products(w: &[Vec<f64>], weights: &Square) -> Square {
    let n = w[0].len();
    let entry = |i: usize, j: usize| {
        (0..w.len())
            .flat_map(|k| (0..w.len()).map(move |l| (k, l)))
            .map(|(k, l)| weights[k][l] * w[k][i] * w[l][j])
            .sum()
    };
    (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect()
}

impl Case {
    /// Entries that differ from those of the diagonal matrices are known to be within that difference of them.
    fn about(about: [&[f64]; 3], truth: [Square; 3], rigid: usize) -> Case {
        let n = about[0].len();
        let known = std::array::from_fn(|which| {
            Matrix::from_fn(n, n, |i, j| {
                let mid = if i == j { about[which][i] } else { 0.0 };
                Ball::from(mid).widen((truth[which][i][j] - mid).abs())
            })
        });
        Case { truth, known, rigid }
    }

    fn sum(&self) -> ModalSum {
        let n = self.truth[0].len();
        let [m, c, k] = self.known.clone();
        let shapes = Matrix::from_fn(n, n, |i, j| if i == j { Dd::ONE } else { Dd::ZERO });
        let kinds: Vec<ModeKind> = (0..n)
            .map(|i| match k[(i, i)] {
                _ if i < self.rigid => ModeKind::Rigid,
                k if k.is_negative() => ModeKind::Divergence,
                _ => ModeKind::Oscillation,
            })
            .collect();
        let mut sum = ModalSum::of_form(ModalForm { shapes, m, k }, &c, &kinds).expect("nearly modes");
        sum.is_undragged = true;
        sum
    }

    /// [K - omega^2 M, -omega C; omega C, K - omega^2 M] (re x, im x) = (b, 0), by elimination.
    fn solve(&self, omega: f64, b: &[BigRational]) -> Vec<[BigRational; 2]> {
        let n = b.len();
        let exact = |x: f64| BigRational::from_float(x).expect("finite");
        let w = exact(omega);
        let mut rows: Vec<Vec<BigRational>> = (0..2 * n)
            .map(|r| {
                let (i, lower) = (r % n, r >= n);
                let entry = |col: usize| {
                    let (j, right) = (col % n, col >= n);
                    let [m, c, k] = [0, 1, 2].map(|which| exact(self.truth[which][i][j]));
                    match (lower, right) {
                        (false, true) => -(&w * c),
                        (true, false) => &w * c,
                        _ => k - &w * &w * m,
                    }
                };
                (0..2 * n).map(entry).chain([if lower { BigRational::zero() } else { b[i].clone() }]).collect()
            })
            .collect();
        for i in 0..2 * n {
            let pivot = (i..2 * n).find(|&r| !rows[r][i].is_zero()).expect("no pole");
            rows.swap(i, pivot);
            let own = rows[i].clone();
            for r in (0..2 * n).filter(|&r| r != i) {
                let factor = &rows[r][i] / &own[i];
                if !factor.is_zero() {
                    rows[r].iter_mut().zip(&own).for_each(|(x, y)| *x = &*x - &factor * y);
                }
            }
        }
        (0..n).map(|i| [i, n + i].map(|r| &rows[r][2 * n] / &rows[r][r])).collect()
    }

    /// H between all pairs of modes. Returns the largest part of a bound that was needed.
    fn check(&self, which: &str) -> f64 {
        let n = self.truth[0].len();
        let sum = self.sum();
        let mut most = 0.0f64;
        // A sum without any product is none: what sees one mode sees a little of all.
        let sees = |own: usize, i: usize| if i == own { 1.0 } else { 1.0 / 2.0f64.powi(200) };
        let number = |x: f64| Number::from(Rational::from_f64(x).expect("finite"));
        let all = |own: usize| (0..n).map(|i| (CoordinateId(i as u32), number(sees(own, i)))).collect::<Vec<_>>();
        let exact = |own: usize| -> Vec<BigRational> {
            (0..n).map(|i| BigRational::from_float(sees(own, i)).expect("finite")).collect()
        };
        let mut system = blank(n);
        for b in 0..n {
            system.inputs[b].b[0] = all(b);
            system.outputs[b].p[0] = all(b);
        }
        for b in 0..n {
            let sums: Vec<PartialFractions> = (0..n)
                .map(|p| sum.fractions(&sum.pair(&system, b, p)).unwrap_or_else(|| panic!("{which} {p} {b}")))
                .collect();
            for omega in [0.25, 1.0 + 1.0 / 1024.0, 2.9375] {
                let x = self.solve(omega, &exact(b));
                for (p, fractions) in sums.iter().enumerate() {
                    let truth = [0, 1].map(|part| {
                        let parts = exact(p).into_iter().zip(&x).map(|(p, x)| p * &x[part]);
                        Rational::from(parts.fold(BigRational::zero(), |a, b| a + b)).to_ball()
                    });
                    let found = fractions.gain(&Frequency::radians(&number(omega))).disc().expect("no pole is near");
                    let off = [found.value.re, found.value.im].map(Ball::exact);
                    let off = (off[0] - truth[0]).to_f64().hypot((off[1] - truth[1]).to_f64());
                    // What the truth itself is rounded by.
                    let slack = 1e-31 * truth[0].magnitude().hypot(truth[1].magnitude());
                    assert!(off <= found.radius + slack, "{which} {p} {b} {omega}: {off:e} {:e}", found.radius);
                    if off > 2.0 * slack {
                        most = most.max(off / found.radius);
                    }
                }
            }
        }
        most
    }
}

/// Without damping, held and unstable: one entry of M or K off, on the diagonal and beside it, or all of them.
#[test]
fn true_modes_are_within_what_is_known_of_a_basis() {
    for k in [[1.0, 4.0], [-1.0, 4.0], [4.0, 1.0]] {
        for sign in [1.0, -1.0] {
            for (which, entries) in [(0, 0), (0, 1), (0, 2), (2, 0), (2, 1), (2, 2), (3, 3)] {
                let mut truth = [diagonal(&[1.0; 2]), diagonal(&[0.0; 2]), diagonal(&k)];
                for form in [0, 2].into_iter().filter(|&form| which == 3 || form == which) {
                    let at = [(0, 0), (1, 1), (0, 1), (1, 0)];
                    for (i, j) in at.into_iter().filter(|&(i, j)| entries == 3 || entries == if i == j { i } else { 2 })
                    {
                        truth[form][i][j] += sign * OFF;
                    }
                }
                let case = Case::about([&[1.0; 2], &[0.0; 2], &k], truth, 0);
                let most = case.check(&format!("{k:?} {sign} {which} {entries}"));
                assert!(most > 0.05, "{k:?} {sign} {which} {entries}: {most}");
            }
        }
    }
}

/// Rigid motions that are not quite those of the basis, by K or by M, without damping and with it.
#[test]
fn rigid_motions_are_within_what_is_known_of_a_basis() {
    for damped in [false, true] {
        // Beside what damps a rigid motion, which is nothing, little is small.
        let (e, zero) = (if damped { OFF / (1u64 << 15) as f64 } else { OFF }, 0.0);
        let c = if damped { [0.25, 0.5] } else { [0.0; 2] };
        for sign in [1.0, -1.0] {
            // Two modes, then three of which the first one is rigid, then three of which two are.
            for (rigid, w) in [
                (1, vec![vec![sign * e, 1.0]]),
                (1, vec![vec![sign * e, 1.0, zero], vec![zero, zero, 1.0]]),
                (1, vec![vec![e, 1.0, zero], vec![sign * e, zero, 1.0]]),
                (2, vec![vec![e, sign * e, 1.0]]),
            ] {
                let (n, elastic) = (w[0].len(), w.len());
                let k = [1.0, 9.0];
                let about = |own: &[f64]| [vec![0.0; n - elastic], own[..elastic].to_vec()].concat();
                for (mass, coupled) in [(0.0, 0.0), (0.5 * e, 0.0), (0.0, 0.5 * e)] {
                    let mut m = diagonal(&vec![1.0; n]);
                    (1..n).for_each(|i| (m[0][i], m[i][0]) = (sign * mass, sign * mass));
                    let mut weights = [diagonal(&c[..elastic]), diagonal(&k[..elastic])];
                    if elastic > 1 {
                        let form = if damped { 0 } else { 1 };
                        (weights[form][0][1], weights[form][1][0]) = (coupled, coupled);
                    }
                    let truth = [m, sum_of_products(&w, &weights[0]), sum_of_products(&w, &weights[1])];
                    let (c, k) = (about(&c), about(&k));
                    let case = Case::about([&vec![1.0; n], &c, &k], truth, rigid);
                    let which = format!("{damped} {sign} {w:?} {mass} {coupled}");
                    let most = case.check(&which);
                    assert!(most > 0.01, "{which}: {most}");
                }
            }
        }
    }
}

/// With damping: one entry of M, C or K off.
#[test]
fn damped_modes_are_within_what_is_known_of_a_basis() {
    // Below critical damping, and above it.
    for c in [[0.125, 0.5], [4.0, 16.0]] {
        for sign in [1.0, -1.0] {
            for form in 0..3 {
                for (i, j) in [(0, 0), (1, 1), (0, 1)] {
                    let k = [1.0, 4.0];
                    let mut truth = [diagonal(&[1.0; 2]), diagonal(&c), diagonal(&k)];
                    let off = sign * OFF * if c[0] > 1.0 { 0.0625 } else { 1.0 };
                    truth[form][i][j] += off;
                    if i != j {
                        truth[form][j][i] += off;
                    }
                    let case = Case::about([&[1.0; 2], &c, &k], truth, 0);
                    let most = case.check(&format!("{c:?} {sign} {form} {i} {j}"));
                    assert!(most > 1e-5, "{c:?} {sign} {form} {i} {j}: {most}");
                }
            }
        }
    }
}

/// Two modes in closed form, close to each other, with all entries of M or K off by all that they may be: the frequency and the residue of
/// each are within their bounds, between inputs and outputs that see either mode or both. What sees the other one alone needs most of its
/// bound.
#[test]
fn residues_of_two_modes_in_closed_form_are_within_their_doubt() {
    const GAP: f64 = 1.0 / (1u64 << 26) as f64;
    let of = |x: f64| Dd::from(x);
    let mut needed = [0.0f64; 2];
    for k in [1.0, 3.5].into_iter().flat_map(|k| [[k, k * (1.0 + GAP)], [k * (1.0 + 16.0 * GAP), k]]) {
        for (off, form) in [(0.125 * GAP, 2), (0.0625 * GAP, 0), (2.0 * GAP / 65536.0, 0)] {
            for ends in 1..27i32 {
                // Each of the three entries as it is, or at one of its ends.
                let [a, b, c] = [1, 3, 9].map(|digit| off * f64::from((ends / digit + 1) % 3 - 1));
                let mut truth = [diagonal(&[1.0; 2]), diagonal(&[0.0; 2]), diagonal(&k)];
                for (i, j, e) in [(0, 0, a), (1, 1, b), (0, 1, c), (1, 0, c)] {
                    truth[form][i][j] += e;
                }
                let [m, _, stiffness] = truth.clone();
                let case = Case::about([&[1.0; 2], &[0.0; 2], &k], truth, 0);
                let sum = case.sum();
                // (k_00 - x m_00) (k_11 - x m_11) = (k_01 - x m_01)^2
                let [two, four] = [2.0, 4.0].map(of);
                let [m0, m1, mc] = [m[0][0], m[1][1], m[0][1]].map(of);
                let [k0, k1, kc] = [stiffness[0][0], stiffness[1][1], stiffness[0][1]].map(of);
                let (p, q, r) = (m0 * m1 - mc * mc, k0 * m1 + k1 * m0 - two * kc * mc, k0 * k1 - kc * kc);
                let root = (q * q - four * p * r).sqrt();
                let ends_of = [(q - root) / (two * p), (q + root) / (two * p)];
                let mut system = blank(2);
                for (sees_b, sees_p) in [
                    ([1.0, 0.0], [1.0, 0.0]),
                    ([0.0, 1.0], [0.0, 1.0]),
                    ([1.0, 0.0], [0.0, 1.0]),
                    ([1.0, 2.0], [1.0, -1.0]),
                ] {
                    let row = |sees: [f64; 2]| {
                        let number = |x: f64| Number::from(Rational::from_f64(x).expect("finite"));
                        (0..2).map(|i| (CoordinateId(i as u32), number(sees[i]))).collect::<Vec<_>>()
                    };
                    (system.inputs[0].b[0], system.outputs[0].p[0]) = (row(sees_b), row(sees_p));
                    let (list, _) = sum.of_true_modes(&sum.pair(&system, 0, 0), None).expect("apart");
                    assert_eq!(list.len(), 2);
                    for (i, given) in list.iter().enumerate() {
                        let x = ends_of[usize::from(k[i] > k[1 - i])];
                        // What K - x M takes to nothing, by the row that is not small.
                        let y = match i {
                            0 => [k1 - x * m1, x * mc - kc],
                            _ => [x * mc - kc, k0 - x * m0],
                        };
                        let size = m0 * y[0] * y[0] + two * mc * y[0] * y[1] + m1 * y[1] * y[1];
                        let seen = |sees: [f64; 2]| of(sees[0]) * y[0] + of(sees[1]) * y[1];
                        let omega = x.sqrt();
                        let which = format!("{k:?} {form} {a} {b} {c} {sees_b:?} {sees_p:?} {i}");
                        assert!((given.s.im - omega).abs().to_f64() <= given.loose + 1e-21, "{which}");
                        let residue = -(seen(sees_b) * seen(sees_p) / size / (two * omega));
                        let found = given.products[0].im;
                        let off = (found.mid - residue).abs().to_f64();
                        assert!(off <= found.rad + 1e-13 * found.rad, "{which}: {off:e} {:e}", found.rad);
                        if sees_b == sees_p && sees_b[i] == 0.0 && c != 0.0 && (a, b) == (0.0, 0.0) {
                            needed[form / 2] = needed[form / 2].max(off / found.rad);
                        }
                    }
                }
            }
        }
    }
    assert!(needed.iter().all(|needed| *needed > 0.5), "{needed:?}");
}
