//! H at many frequencies, to the last digit, at little more than the cost of one binary64 factorisation each. In: a
//! system whose dampers resist every motion, frequencies. Out: for each frequency, input and output a disc, or nothing
//! if the proof fails and another method is needed. See docs/method/transfer.md#two-sided-approximation.
//!
//! With any approximations x of Q^-1 b and z of Q^-1 p, r = b - Q x, t = p - Q z and the symmetric Q,
//!
//! ```text
//! p^T Q^-1 b = p^T x + z^T r + t^T Q^-1 r
//! ```
//!
//! exactly. The first two terms are computed, with r in double-double; the last one is a product of two residuals and
//! is bounded: with a diagonal D and gamma > 0 such that C - gamma D is positive definite, |t^T Q^-1 r| <= |t| |r| /
//! (omega gamma) in the norms sum |.|^2 / D, because im (x^H Q x) = omega x^H C x. So two solutions in binary64, each
//! accurate to some digits only, give a value with twice as many.

mod sweep;

use crate::analysis::transfer::inverse::Entry;
use crate::analysis::transfer::sparse::{Pattern, Symbolic};
use crate::analysis::transfer::{Disc, Frequency, MatrixEntry, Transfer};
use crate::base::{Ball, Dd, Number, OrderBy, down, larger, up};
use crate::kernel::complex::Complex;
use crate::system::CoordinateId;
use std::cmp::Ordering;

/// A system prepared for this method.
#[derive(Clone, Debug)]
pub(in crate::analysis) struct TwoSided<'a> {
    pattern: &'a Pattern,
    /// Entries in the order of elimination.
    plan: Plan,
    /// 1 / (D_i gamma), by position.
    weights: Vec<f64>,
    /// Largest relative radius of the entries.
    loose: f64,
}

/// The steps at each position of the elimination; the same at every frequency.
#[derive(Clone, Debug)]
struct Plan {
    n: usize,
    /// The distinct entries: in a chain of equal links there are few.
    entries: Vec<Polynomial>,
    /// Upper entries of each column: (row, index of the entry).
    columns: Vec<Vec<(u32, u32)>>,
    /// The columns of L that each position needs, in order: (column of L, position of the new entry).
    touched: Vec<Vec<(u32, u32)>>,
    /// Index at which each column of L begins, and the row of each of its entries.
    starts: Vec<u32>,
    below: Vec<u32>,
    /// The entries of both triangles, row by row.
    rows: Vec<Vec<(u32, u32)>>,
}

/// k + s c + s^2 m, as the polynomial of an entry, a load or a reading.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Polynomial {
    k: Dd,
    c: Dd,
    m: Dd,
}

/// One frequency of a sweep.
#[derive(Clone, Copy, Debug)]
struct Lane {
    omega: Dd,
    square: Dd,
    /// Relative radius of omega.
    loose: f64,
}

/// A sparse column or row, by position.
type Sparse = Vec<(u32, Polynomial)>;

/// A completely unknown value.
const NOTHING: Disc = Disc { value: Complex { re: Dd::ZERO, im: Dd::ZERO }, radius: f64::INFINITY };
/// gamma is searched from 1 downwards; below this the bound is useless.
const LEAST_GAMMA: f64 = 1e-14;
/// If entries are less accurate than this, the last digits are lost anyway.
const LOOSEST: f64 = 1e-20;

impl<'a> TwoSided<'a> {
    /// `None` if some motion is not damped, or its damping is too small to prove anything.
    pub fn of(transfer: &'a Transfer) -> Option<TwoSided<'a>> {
        let (pattern, entries) = (transfer.pattern.as_ref()?, &transfer.entries);
        let n = transfer.system.n();
        let mut diagonal = vec![0.0; n];
        for entry in entries.iter().filter(|e| e.i == e.j) {
            diagonal[entry.i as usize] = entry.c.mid.hi;
        }
        if n == 0 || diagonal.iter().any(|c| !(*c > 1e-150 && *c < 1e150)) {
            return None;
        }
        let loose = entries.iter().flat_map(|e| [e.m, e.c, e.k]).map(looseness).fold(0.0, larger);
        let gamma = coercivity(pattern, entries, &diagonal).filter(|_| loose < LOOSEST)?;
        let plan = Plan::of(pattern, n, entries);
        let mut weights = vec![0.0; n];
        for (i, d) in diagonal.iter().enumerate() {
            weights[pattern.place(i)] = 1.0 / (d * gamma) * up::FEW;
        }
        Some(TwoSided { pattern, plan, weights, loose })
    }

    /// One disc for each frequency, input and output, in this order; the radius is infinite if nothing is proven.
    pub fn sweep(
        &self,
        transfer: &Transfer,
        frequencies: &[Frequency],
        inputs: &[usize],
        outputs: &[usize],
        tolerance: f64,
    ) -> Vec<Disc> {
        let system = transfer.system;
        let mut loose = self.loose;
        let loads: Vec<Sparse> = inputs.iter().map(|&u| self.sparse(&system.inputs[u].b, &mut loose)).collect();
        let readings: Vec<Sparse> = outputs.iter().map(|&y| self.sparse(&system.outputs[y].p, &mut loose)).collect();
        let through: Vec<Vec<[Ball; 3]>> = (inputs.iter())
            .map(|&u| outputs.iter().map(|&y| super::feed_through(&system.outputs[y], u)).collect())
            .collect();
        let pairs = inputs.len() * outputs.len();
        if loose > LOOSEST {
            return vec![NOTHING; frequencies.len() * pairs];
        }
        let task = sweep::Task { of: self, loads: &loads, readings: &readings, loose, frequencies, tolerance };
        let mut discs = sweep::discs(&task);
        for (frequency, discs) in frequencies.iter().zip(discs.chunks_mut(pairs.max(1))) {
            for (disc, d) in discs.iter_mut().zip(through.iter().flatten()) {
                if !d.iter().all(Ball::is_zero) {
                    *disc = with_through(*disc, frequency, d);
                }
            }
        }
        discs
    }

    /// A row or column by position; `loose` grows to the largest relative radius.
    fn sparse(&self, powers: &[Vec<(CoordinateId, Number)>; 3], loose: &mut f64) -> Sparse {
        let mut list: Sparse = Vec::new();
        for (power, column) in powers.iter().enumerate() {
            for (i, value) in column {
                let place = self.pattern.place(i.index()) as u32;
                let ball = value.to_ball();
                *loose = loose.max(looseness(ball));
                let at = list.iter().position(|(known, _)| *known == place).unwrap_or_else(|| {
                    list.push((place, Polynomial { k: Dd::ZERO, c: Dd::ZERO, m: Dd::ZERO }));
                    list.len() - 1
                });
                let Polynomial { k, c, m } = &mut list[at].1;
                *[k, c, m][power] = ball.mid;
            }
        }
        list
    }
}

fn with_through(disc: Disc, frequency: &Frequency, d: &[Ball; 3]) -> Disc {
    let sum = disc.value.to_ball() + frequency.polynomial(*d);
    Disc { value: sum.mid(), radius: (disc.radius + sum.radius()) * up::THOUSANDS }
}

/// The radius relative to the magnitude.
fn looseness(ball: Ball) -> f64 {
    if ball.rad == 0.0 { 0.0 } else { ball.rad / (ball.mid.hi.abs() * down::FEW) }
}

/// gamma such that C - gamma diag(C) is positive definite: all pivots of its elimination in discs are certainly
/// positive.
fn coercivity(pattern: &Pattern, entries: &[MatrixEntry], diagonal: &[f64]) -> Option<f64> {
    let mut gamma = 0.5;
    while gamma > LEAST_GAMMA {
        let shifted: Vec<Entry> = (entries.iter())
            .map(|e| {
                let shift =
                    if e.i == e.j { Ball::from(gamma) * Ball::from(diagonal[e.i as usize]) } else { Ball::ZERO };
                Entry { i: e.i, j: e.j, value: Complex::real(e.c - shift) }
            })
            .collect();
        if pattern.factor(&shifted).is_some_and(|factors| factors.is_positive()) {
            return Some(gamma);
        }
        gamma *= 0.25;
    }
    None
}

impl Plan {
    fn of(pattern: &Pattern, n: usize, entries: &[MatrixEntry]) -> Plan {
        let mut columns = vec![Vec::new(); n];
        let mut rows = vec![Vec::new(); n];
        let polynomial = |entry: &MatrixEntry| Polynomial { k: entry.k.mid, c: entry.c.mid, m: entry.m.mid };
        let all: Vec<Polynomial> = entries.iter().map(polynomial).collect();
        let mut different = all.clone();
        different.order_by(Polynomial::order);
        different.dedup_by(|a, b| a.order(b).is_eq());
        for (entry, polynomial) in entries.iter().zip(&all) {
            let which = different.partition_point(|known| known.order(polynomial).is_lt()) as u32;
            let (i, j) = (pattern.place(entry.i as usize), pattern.place(entry.j as usize));
            rows[i].push((j as u32, which));
            if i <= j {
                columns[j].push((i as u32, which));
            }
        }
        let Symbolic { touched, starts, below } = pattern.symbolic();
        Plan { n, entries: different, columns, touched, starts, below, rows }
    }

    /// The rows below the diagonal in a column of L, with its entries.
    #[inline(always)]
    fn column<'l, T>(&'l self, l: &'l [T], j: usize) -> impl Iterator<Item = (&'l u32, &'l T)> {
        let range = self.starts[j] as usize..self.starts[j + 1] as usize;
        self.below[range.clone()].iter().zip(&l[range])
    }
}

impl Polynomial {
    /// An arbitrary order that is the same on every machine.
    fn order(&self, other: &Polynomial) -> Ordering {
        let parts = |p: &Polynomial| [p.k, p.c, p.m].map(|x| [x.hi, x.lo]);
        let pairs = parts(self).into_iter().flatten().zip(parts(other).into_iter().flatten());
        pairs.fold(Ordering::Equal, |order, (a, b)| order.then(a.total_cmp(&b)))
    }
}

impl Lane {
    fn of(frequency: &Frequency) -> Lane {
        let omega = frequency.omega;
        Lane { omega: omega.mid, square: omega.mid * omega.mid, loose: looseness(omega) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::test_systems::{blank, push};
    use crate::system::LinearSystem;

    /// A chain whose dampers are not proportional to its springs.
    fn chain(n: usize) -> LinearSystem {
        let mut system = blank(n);
        for i in 0..n {
            push(&mut system.m, "1.3", i, None);
            push(&mut system.k, "1000.1", i, i.checked_sub(1));
            push(&mut system.c, if i.is_multiple_of(3) { "0.3" } else { "0.7" }, i, i.checked_sub(1));
        }
        system
    }

    /// Compares with the solution in discs: at the force and far from it, at resonances and between, at both
    /// accuracies.
    #[test]
    fn the_value_is_enclosed_and_correct_to_the_last_digit() {
        for n in [1, 2, 9, 300] {
            let system = chain(n);
            let transfer = Transfer::of(&system);
            let method = TwoSided::of(&transfer).expect("dampers on all");
            let hertz = |i: i64| Frequency::hertz(&(&Number::from(i) / &Number::from(7)));
            let frequencies: Vec<Frequency> = (1..30).map(hertz).collect();
            for (outputs, tolerance) in [([0, n - 1], 1e-17), ([n / 2, 0], 1e-10)] {
                let discs = method.sweep(&transfer, &frequencies, &[0], &outputs, tolerance);
                for (discs, f) in discs.chunks(2).zip(&frequencies) {
                    let truth = transfer.between(f, &[0], &outputs);
                    for (disc, truth) in discs.iter().zip(&truth[0]) {
                        let truth = truth.disc().expect("finite");
                        let error = (disc.value - truth.value).to_f64().abs();
                        assert!(error <= disc.radius + truth.radius, "{n} {error:e} {:e}", disc.radius);
                        assert!(disc.relative_error() <= tolerance, "{n} {:e}", disc.relative_error());
                    }
                }
            }
        }
    }

    /// Dampers of 1 N*s/m to the ground and one of -3/4 between them: both diagonals are positive, C is not.
    #[test]
    fn dampers_that_push_somewhere_are_refused() {
        let mut system = chain(2);
        system.c = crate::system::Form::new();
        for i in 0..2 {
            push(&mut system.c, "1", i, None);
        }
        assert!(TwoSided::of(&Transfer::of(&system)).is_some());
        let source = system.c.source(system.coordinates[0].name);
        let between = [(CoordinateId(0), Number::ONE), (CoordinateId(1), -&Number::ONE)];
        system.c.push(source, crate::system::Nature::Property, -&Number::from("0.75"), between);
        assert!(TwoSided::of(&Transfer::of(&system)).is_none());
    }

    /// The chain's receptance at its free end, as a continued fraction in rational numbers: the pivots from the ground
    /// outwards are q_i - (k_i + i omega c_i)^2 / (previous pivot).
    #[test]
    fn the_value_is_enclosed_against_exact_arithmetic() {
        type Pair = (Number, Number);
        let times = |a: &Pair, b: &Pair| (&(&a.0 * &b.0) - &(&a.1 * &b.1), &(&a.0 * &b.1) + &(&a.1 * &b.0));
        let recip = |a: &Pair| {
            let norm = &a.0.square() + &a.1.square();
            (&a.0 / &norm, &-&a.1 / &norm)
        };
        let mut errors = 0;
        for n in [1, 2, 5, 12] {
            let system = chain(n);
            let transfer = Transfer::of(&system);
            let method = TwoSided::of(&transfer).expect("dampers on all");
            for step in 1..20 {
                let omega = &Number::from(step) / &Number::from(7);
                let spring = |i: usize| -> Pair {
                    (Number::from("1000.1"), &omega * &Number::from(if i.is_multiple_of(3) { "0.3" } else { "0.7" }))
                };
                let inertia = -&(&omega.square() * &Number::from("1.3"));
                // From the ground: pivot_i = spring_i + spring_(i+1) + inertia - spring_i^2 / pivot_(i-1).
                let mut pivot: Option<Pair> = None;
                for i in 0..n {
                    let mut q = spring(i);
                    q.0 = &q.0 + &inertia;
                    if i + 1 < n {
                        let next = spring(i + 1);
                        q = (&q.0 + &next.0, &q.1 + &next.1);
                    }
                    if let Some(before) = pivot {
                        let taken = times(&times(&spring(i), &spring(i)), &recip(&before));
                        q = (&q.0 - &taken.0, &q.1 - &taken.1);
                    }
                    pivot = Some(q);
                }
                let truth = recip(&pivot.expect("at least one"));
                let truth = Complex::new(truth.0.to_ball(), truth.1.to_ball());
                for tolerance in [1e-17, 1e-10] {
                    let disc = method.sweep(&transfer, &[Frequency::radians(&omega)], &[n - 1], &[n - 1], tolerance)[0];
                    let error = (disc.value - truth.mid()).to_f64().abs();
                    assert!(error <= disc.radius + truth.radius(), "{n} {step}: {error:e} {:e}", disc.radius);
                    // Without its radius the value would be refuted.
                    errors += usize::from(error > 2.0 * truth.radius());
                }
            }
        }
        assert!(errors > 50, "{errors}");
    }

    /// For any vector width, one frequency alone and among others gives the same numbers.
    #[test]
    fn a_lane_does_not_depend_on_its_neighbours() {
        let system = chain(40);
        let transfer = Transfer::of(&system);
        let method = TwoSided::of(&transfer).expect("dampers on all");
        let frequencies: Vec<Frequency> = (1..20).map(|i| Frequency::hertz(&Number::from(i))).collect();
        let together = method.sweep(&transfer, &frequencies, &[0], &[39], 1e-17);
        for (f, disc) in frequencies.iter().zip(together) {
            assert_eq!(method.sweep(&transfer, std::slice::from_ref(f), &[0], &[39], 1e-17), [disc]);
        }
    }

    #[test]
    fn undamped_motions_are_refused() {
        let mut system = chain(3);
        system.c = crate::system::Form::new();
        push(&mut system.c, "1", 0, None);
        assert!(TwoSided::of(&Transfer::of(&system)).is_none());
    }
}
