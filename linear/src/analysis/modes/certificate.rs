//! Certified bounds of the eigenvalues of K x = lambda M x, from any approximate eigenvectors.
//!
//! In: the stiffness and the inertia in the basis of the approximate modes, K^ = X^T K X and M^ = X^T M X, with error bounds
//! ([`Gram`]). Out: for each k an interval that contains the k-th eigenvalue.
//!
//! For a real s let T = K^ - s M^. If X is regular, T has as many negative eigenvalues as there are lambda < s
//! (Sylvester). Take the modes near s as group C and the rest as R, and let g_j > 0 bound |T_jj| from below for j in R.
//! Scaled by g^-1/2 the rest is a diagonal of magnitude at least 1 plus an off-diagonal part of Frobenius norm q; for q < 1
//! it has the signs of its diagonal and an inverse of norm at most 1/(1-q). So the Schur complement of the group differs from
//! the diagonal of (lambda^_i - s) M^_ii, with numbers lambda^_i near K^_ii / M^_ii, by at most
//!
//!   e = max_i |K^_ii - lambda^_i M^_ii| + ||T_CC off the diagonal||_F + sum_(i in C, j in R) T_ij^2 / (g_j (1 - q)),
//!
//! and by Weyl's inequality the k-th eigenvalue lies within delta = e / min M^_ii of the k-th lambda^. The bound is
//! quadratic in the errors of the modes, and it counts: no eigenvalue is missed and none is found twice. The quotients
//! of a group are evaluated in triple words. X is regular because ||M^ off the diagonal||_F < min M^_ii.
//! See docs/method/modes.md#certificate; compare Parlett, The Symmetric Eigenvalue Problem (1998), chapters 10 and 11.

use crate::analysis::modes::gram::{Gram, SLACK};
use crate::analysis::modes::scale::{by_power, exponent};
use crate::base::{Ball, Dd, OrderBy, Power};
use crate::kernel::dense::Matrix;
use crate::kernel::triple::Triple;
use std::cmp::Ordering;

/// The k-th eigenvalue of a pencil.
#[derive(Clone, Copy, Debug)]
pub struct Enclosure {
    /// Column of X that approximates its mode.
    pub column: usize,
    pub lambda: Triple,
    /// |lambda - true|; infinite if nothing could be certified.
    pub radius: f64,
}

/// The pencil in the basis of its approximate modes.
struct Pencil<'a> {
    k: &'a Gram<'a>,
    m: &'a Gram<'a>,
    /// Columns ascending by lambda^.
    order: Vec<usize>,
    /// lambda^, ascending.
    lambda: Vec<Triple>,
    /// Bound of |K^_ii - lambda^_i M^_ii|.
    residual: Vec<f64>,
    /// Lower bound of M^_ii.
    mass: Vec<f64>,
    /// Upper bounds of |K^| and |M^|, in the order of `order`.
    k_size: Matrix<f64>,
    m_size: Matrix<f64>,
}

/// The second trial usually succeeds; more are needed only if the modes are poor.
const MAX_TRIALS: usize = 12;

/// Encloses every eigenvalue, ascending; see the module.
pub fn enclose(k: &Gram, m: &Gram) -> Vec<Enclosure> {
    let pencil = Pencil::new(k, m);
    let n = pencil.lambda.len();
    let regular = k.is_finite() && m.is_finite() && pencil.basis_is_regular();
    let mut list = Vec::with_capacity(n);
    for (start, end) in pencil.groups() {
        let radius = if regular { pencil.radius(start, end) } else { f64::INFINITY };
        list.extend((start..end).map(|i| Enclosure { column: pencil.order[i], lambda: pencil.lambda[i], radius }));
    }
    list
}

impl<'a> Pencil<'a> {
    fn new(k: &'a Gram<'a>, m: &'a Gram<'a>) -> Pencil<'a> {
        let n = k.mid.columns();
        let mut found: Vec<(usize, Triple, f64)> = (0..n).map(|i| quotient(k, m, i)).collect();
        found.order_by(|a, b| compare(a.1, b.1));
        let order: Vec<usize> = found.iter().map(|f| f.0).collect();
        Pencil {
            mass: order.iter().map(|&i| m.mid[(i, i)].hi * (2.0 - SLACK) - m.radius(i, i)).collect(),
            k_size: Matrix::from_fn(n, n, |i, j| k.magnitude(order[i], order[j])),
            m_size: Matrix::from_fn(n, n, |i, j| m.magnitude(order[i], order[j])),
            lambda: found.iter().map(|f| f.1).collect(),
            residual: found.iter().map(|f| f.2).collect(),
            k,
            m,
            order,
        }
    }

    /// M^ is positive definite, so X is regular: its off-diagonal norm is below its least diagonal entry.
    fn basis_is_regular(&self) -> bool {
        let n = self.lambda.len();
        let least = self.mass.iter().fold(f64::INFINITY, |a, &b| a.min(b));
        let sum: f64 = (0..n).flat_map(|j| self.m_size.column(j)[..j].iter()).map(|x| 2.0 * x * x).sum();
        least > 0.0 && sum.sqrt() * SLACK < least
    }

    /// Bound of |T_ij| at s = lambda^_i + h for all |h| <= span, from double-double.
    fn coupling(&self, i: usize, j: usize, span: f64) -> f64 {
        let (a, b) = (self.order[i], self.order[j]);
        let (k, m, s) = (self.k.mid[(a, b)].hi, self.m.mid[(a, b)].hi, self.lambda[i].hi());
        let rounding = 1e-15 * (k.abs() + (s * m).abs());
        let t = (k - s * m).abs() + rounding + span * m.abs();
        SLACK * (t + self.k.radius(a, b) + (s.abs() + span) * SLACK * self.m.radius(a, b))
    }

    /// Like `coupling`, evaluated in triple words: for modes of one group, whose coupling is not squared in the bound.
    fn close_coupling(&self, i: usize, j: usize, span: f64) -> f64 {
        let (a, b) = (self.order[i], self.order[j]);
        let (k, m, s) = (self.k.precise(a, b), self.m.precise(a, b), self.lambda[i]);
        let t = (k.value - s * m.value).hi().abs() + span * m.value.hi().abs();
        let size = (s.hi().abs() + span) * SLACK;
        let rounding = 4.0 * Triple::ERROR * (k.value.hi().abs() + size * m.value.hi().abs());
        SLACK * (t + rounding + k.radius + size * m.radius)
    }

    fn distance(&self, i: usize, j: usize) -> f64 {
        (self.lambda[j] - self.lambda[i]).hi()
    }

    /// Neighbours whose distance is comparable to their coupling and residuals form a group.
    fn groups(&self) -> Vec<(usize, usize)> {
        let n = self.lambda.len();
        let near = |i: usize, j: usize| {
            self.distance(i, j) <= 8.0 * (self.coupling(i, j, 0.0) + self.residual[i] + self.residual[j])
        };
        let last: Vec<usize> = (0..n).map(|i| (i + 1..n).rev().find(|&j| near(i, j)).unwrap_or(i)).collect();
        let (mut groups, mut start) = (Vec::with_capacity(n), 0);
        while start < n {
            let (mut end, mut i) = (last[start], start);
            while i < end {
                i += 1;
                end = end.max(last[i]);
            }
            groups.push((start, end + 1));
            start = end + 1;
        }
        groups
    }

    /// A radius that holds for all modes of the group start..end, infinite if none is found.
    fn radius(&self, start: usize, end: usize) -> f64 {
        let inner = self.inner(start, end);
        let mut assumed = 0.0;
        for _ in 0..MAX_TRIALS {
            let found = self.radius_assuming(start, end, inner, assumed);
            if !found.is_finite() {
                return f64::INFINITY;
            }
            if found <= assumed {
                return found;
            }
            // The result depends weakly on the assumption: one part in a thousand leaves room unless the modes are
            // poor.
            assumed = if assumed == 0.0 { 1.001 * found } else { 2.0 * found };
        }
        f64::INFINITY
    }

    /// ||T_CC off the diagonal||_F at s within the group, as its value and its growth with the distance beyond it.
    fn inner(&self, start: usize, end: usize) -> (f64, f64) {
        let (mut sum, mut slope) = (0.0, 0.0);
        let span = self.distance(start, end - 1).abs() * SLACK;
        for i in start..end {
            for j in (start..end).filter(|&j| j != i) {
                let t = self.close_coupling(i, j, span);
                let m = self.m_size[(i, j)];
                (sum, slope) = (sum + t * t, slope + m * m);
            }
        }
        (sum.sqrt() * SLACK, slope.sqrt() * SLACK)
    }

    /// The delta of the module's text, with s running over the group's lambda^ widened by `assumed`. Valid if the
    /// result is at most `assumed`.
    fn radius_assuming(&self, start: usize, end: usize, inner: (f64, f64), assumed: f64) -> f64 {
        let n = self.lambda.len();
        let span = (self.distance(start, end - 1).abs() + assumed) * SLACK;
        let largest = (self.lambda[start].hi().abs().max(self.lambda[end - 1].hi().abs()) + assumed) * SLACK;
        let mut scale = vec![0.0; n];
        for j in (0..start).chain(end..n) {
            let distance = if j < start { self.distance(j, start) } else { self.distance(end - 1, j) };
            let gap = (distance * (2.0 - SLACK) - assumed) * self.mass[j] * (2.0 - SLACK) - self.residual[j];
            if gap.is_nan() || gap <= 0.0 {
                return f64::INFINITY;
            }
            scale[j] = (1.0 / gap).sqrt() * SLACK;
        }
        let q = self.rest_norm(largest, &scale);
        if q.is_nan() || q >= 0.5 {
            return f64::INFINITY;
        }
        let (mut outer, mut residual, mut mass) = (0.0, 0.0f64, f64::INFINITY);
        for i in start..end {
            residual = residual.max(self.residual[i]);
            mass = mass.min(self.mass[i]);
            for j in (0..start).chain(end..n) {
                outer += (self.coupling(i, j, span) * scale[j]).power(2);
            }
        }
        (residual + inner.0 + assumed * inner.1 + outer / (1.0 - q)) / mass * SLACK
    }

    /// q of the module's text; the scale is zero for the members of the group.
    fn rest_norm(&self, largest: f64, scale: &[f64]) -> f64 {
        let mut sum = 0.0;
        for (j, &outer) in scale.iter().enumerate().filter(|(_, scale)| **scale > 0.0) {
            let (k, m) = (self.k_size.column(j), self.m_size.column(j));
            let row: f64 =
                k.iter().zip(m).zip(scale).take(j).map(|((k, m), inner)| ((k + largest * m) * inner).power(2)).sum();
            sum += 2.0 * row * outer * outer;
        }
        sum.sqrt() * SLACK
    }
}

/// lambda^ of column i, near K^_ii / M^_ii, and a bound of |K^_ii - lambda^ M^_ii|.
fn quotient(k: &Gram, m: &Gram, i: usize) -> (usize, Triple, f64) {
    let (energy, inertia) = (k.precise(i, i), m.precise(i, i));
    let first = energy.value.dd() / inertia.value.dd();
    let rest = energy.value - Triple::from(first) * inertia.value;
    let correction = rest.hi() / inertia.value.hi();
    let lambda = Triple::from(first) + Triple::from(correction);
    // The correction is at most 2^-100 of the quotient, with a relative rounding error of 2^-52.
    let size = energy.value.hi().abs() + (first.hi * inertia.value.hi()).abs();
    let rounding = 8.0 * Triple::ERROR * size + rest.hi().abs() * (4.0 * f64::EPSILON);
    (i, lambda, SLACK * (energy.radius + first.hi.abs() * SLACK * inertia.radius + rounding))
}

fn compare(a: Triple, b: Triple) -> Ordering {
    (a - b).hi().partial_cmp(&0.0).unwrap_or(Ordering::Equal)
}

/// The square root of a certified number in double-double, with its radius.
pub fn root(x: Triple, radius: f64) -> Ball {
    // Squares of numbers far from one lose their low words, so the root is taken near one and scaled back without
    // rounding.
    match exponent(x.hi()).map(|e| e / 2) {
        Some(half) if half.abs() > 200 => {
            let near_one = root_of_ordinary(x.by_power(-2 * half), by_power(radius, -2 * half).next_up());
            let back = |word: f64| by_power(word, half);
            Ball::new(Dd { hi: back(near_one.mid.hi), lo: back(near_one.mid.lo) }, back(near_one.rad))
        }
        _ => root_of_ordinary(x, radius),
    }
}

fn root_of_ordinary(x: Triple, radius: f64) -> Ball {
    if x.hi() <= 0.0 {
        // The number may be negative, but only within its radius.
        return Ball::new(Dd::ZERO, ((x.hi().abs() + radius) * SLACK).sqrt() * SLACK);
    }
    let first = x.dd().sqrt();
    let rest = x - Triple::from(first).square();
    // One Newton step from 2^-103: its own error is far below 2^-150 of the root.
    let (mid, dropped) = (Triple::from(first) + Triple::from(rest.hi() / (2.0 * first.hi))).split();
    // |sqrt a - sqrt b| = |a - b| / (sqrt a + sqrt b).
    let least = (x.hi() * (2.0 - SLACK) - radius).max(0.0).sqrt();
    let spread = (radius / (mid.hi + least)).min(radius.sqrt());
    Ball::new(mid, SLACK * (spread + dropped.abs() + 32.0 * Triple::ERROR * mid.hi))
}

/// Zero and a bound of sqrt |x|, for an enclosed x whose sign is not certain.
pub fn unknown_root(x: Ball) -> Ball {
    Ball::new(Dd::ZERO, x.magnitude().sqrt() * SLACK)
}

/// A certified number as a [`Ball`].
pub fn ball(x: Triple, radius: f64) -> Ball {
    let (mid, dropped) = x.split();
    Ball::new(mid, (radius + dropped.abs()) * SLACK)
}

#[cfg(test)]
mod counts;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::modes::terms::Terms;
    use crate::analysis::test_systems::{blank, push};
    use crate::base::{Number, Rational};
    use crate::system::{CoordinateId, LinearSystem, Nature};

    /// Three masses in a row between walls: eigenvalues 2 - sqrt 2, 2, 2 + sqrt 2.
    fn row() -> LinearSystem {
        let mut system = blank(3);
        for i in 0..3 {
            push(&mut system.m, "1", i, None);
            push(&mut system.k, "1", i, i.checked_sub(1));
        }
        push(&mut system.k, "1", 2, None);
        system
    }

    fn enclose_all(x: &Matrix<Triple>) -> Vec<Enclosure> {
        let system = row();
        let (k, m) = (Terms::of(&system.k), Terms::of(&system.m));
        enclose(&Gram::of(&k, x), &Gram::of(&m, x))
    }

    /// The modes, with each entry off by `slip` in one direction or the other.
    fn modes(slip: f64) -> Matrix<Triple> {
        let middle = 2f64.sqrt();
        let columns = [[1.0, middle, 1.0], [1.0, 0.0, -1.0], [1.0, -middle, 1.0]];
        Matrix::from_fn(3, 3, |i, j| {
            let sign = if (i + 2 * j) % 3 == 0 { 1.0 } else { -1.0 };
            Triple::from(columns[j][i] + sign * slip)
        })
    }

    #[test]
    fn truth_is_enclosed_from_poor_vectors_too() {
        let root = Dd::from(2.0).sqrt();
        let truth = [Dd::from(2.0) - root, Dd::from(2.0), Dd::from(2.0) + root];
        for slip in [0.0, 1e-12, 1e-6, 1e-3] {
            for (found, truth) in enclose_all(&modes(slip)).iter().zip(truth) {
                let error = (found.lambda - Triple::from(truth)).hi().abs();
                assert!(
                    error <= found.radius + 1e-31 && found.radius <= 100.0 * slip * slip + 1e-28,
                    "{slip:e}: {error:e}"
                );
                // The error of a quotient is the square of that of the vectors: a smaller bound would not hold.
                assert!(slip < 1e-6 || error > 1e-3 * slip * slip, "{slip:e}: {error:e}");
            }
        }
    }

    /// Two equal vectors give no information about the third eigenvalue, however well they fit.
    #[test]
    fn vectors_that_depend_on_each_other_certify_nothing() {
        let modes = modes(0.0);
        let twice = Matrix::from_fn(3, 3, |i, j| modes[(i, j.min(1))]);
        assert!(enclose_all(&twice).iter().all(|found| found.radius == f64::INFINITY));
    }

    #[test]
    fn roots_are_enclosed_over_the_whole_range() {
        for e in [-300, -250, -100, 0, 100, 250, 300] {
            // (10^(e/2) (1 + 2^-60))^2, less what does not fit into three words.
            let root = Triple::from(10f64.powi(e / 2)) + Triple::from(10f64.powi(e / 2) * 2f64.powi(-60));
            let near_one = root.by_power(-exponent(root.hi()).expect("not zero"));
            let square = near_one.square().by_power(2 * exponent(root.hi()).expect("not zero"));
            let radius = 1e-46 * square.hi();
            let found = super::root(square, radius.max(1e-322));
            let error = (Triple::from(found.mid) - root).hi().abs();
            assert!(error <= found.rad, "1e{e}: {error:e} {:e}", found.rad);
            assert!(e < -250 || found.rad <= 1e-28 * root.hi(), "1e{e}: {:e}", found.rad);
        }
    }

    /// The root of 4 +- 1 contains the roots of 3 and of 5.
    #[test]
    fn the_root_of_an_uncertain_number_holds_its_ends() {
        let found = root(Triple::from(4.0), 1.0);
        for end in [3.0f64, 5.0] {
            assert!((found.to_f64() - end.sqrt()).abs() <= found.rad, "{found:?} {end}");
        }
    }

    /// Far from one the low words of squares underflow, so the root is taken near one: its square holds the number, in exact
    /// arithmetic.
    #[test]
    fn roots_hold_at_both_ends_of_the_range() {
        let exact = |x: f64| Number::from(Rational::from_f64(x).expect("finite"));
        for x in [3e-305, 2e-290, 3e-200, 0.7, 7e200, 5e290, 1.1e308] {
            let found = root(Triple::from(x), 0.0);
            let end = |side: f64| &(&exact(found.mid.hi) + &exact(found.mid.lo)) + &exact(side * found.rad);
            let beyond = |side: f64| &end(side).square() - &exact(x);
            assert!(!beyond(1.0).is_negative() && !beyond(-1.0).is_positive(), "{x:e}: {found:?}");
            assert!(found.rad <= 1e-30 * found.mid.hi, "{x:e}: {found:?}");
        }
    }

    /// -0.001 +- 0.01 may be 0.009, and -3 +- 1 the negative of 4.
    #[test]
    fn a_root_of_what_may_be_negative_is_about_zero() {
        for (x, radius) in [(-1e-3, 1e-2), (0.0, 1e-2), (-1e-300, 1e-290), (-4.0, 25.0)] {
            let found = root(Triple::from(x), radius);
            let most = (radius - x).sqrt();
            assert!(found.mid.hi == 0.0 && (most..1.001 * most).contains(&found.rad), "{x:e}: {found:?}");
        }
        let found = unknown_root(Ball::new(Dd::from(-3.0), 1.0));
        assert!(found.mid.hi == 0.0 && (2.0..2.001).contains(&found.rad), "{found:?}");
    }

    /// Of three words a ball keeps two; the third one is in its radius.
    #[test]
    fn a_ball_holds_the_word_that_it_drops() {
        let dropped = 2f64.powi(-120);
        for side in [1.0, -1.0] {
            let x = Triple::from(1.0) + Triple::from(2f64.powi(-60)) + Triple::from(side * dropped);
            for radius in [0.0, 2f64.powi(-122), 1e-30] {
                let found = super::ball(x, radius);
                assert_eq!((found.mid.hi, found.mid.lo), (1.0, 2f64.powi(-60)));
                assert!((radius + dropped..1.001 * (radius + dropped)).contains(&found.rad), "{radius:e}: {found:?}");
            }
        }
    }

    /// A row (1, e) with |e| <= 1e-3 in K and another in M join modes of 1 and 3: with +e in one and -e in the other the first
    /// eigenvalue is (4 + 8e^2 - 2 sqrt(...))/..., less than 1 by 2e^2, from (K - M)_12 = 2e across a gap of 2.
    #[test]
    fn uncertainties_of_both_forms_add_up_between_modes() {
        let (mut system, e) = (blank(2), Number::Ball(Ball::new(Dd::ZERO, 1e-3)));
        push(&mut system.k, "3", 1, None);
        push(&mut system.m, "1", 1, None);
        for form in [&mut system.k, &mut system.m] {
            let source = form.term(0).source;
            let row = [(CoordinateId(0), Number::ONE), (CoordinateId(1), e.clone())];
            form.push(source, Nature::Property, Number::ONE, row);
        }
        let x = Matrix::from_fn(2, 2, |i, j| if i == j { Triple::from(1.0) } else { Triple::from(0.0) });
        let (k, m) = (Terms::of(&system.k), Terms::of(&system.m));
        let found = enclose(&Gram::of(&k, &x), &Gram::of(&m, &x));
        assert!(found[0].radius >= 2e-6 * 0.999 && found[0].radius < 1e-3, "{:e}", found[0].radius);
    }

    /// A spring of 0 within 1e-3 between two equal oscillators moves one of their squares by up to 2e-3.
    #[test]
    fn uncertainty_between_equal_modes_is_in_their_radius() {
        let mut system = blank(2);
        for i in 0..2 {
            push(&mut system.m, "1", i, None);
            push(&mut system.k, "1", i, None);
        }
        let source = system.k.term(0).source;
        let row = [(CoordinateId(0), Number::ONE), (CoordinateId(1), -&Number::ONE)];
        system.k.push(source, Nature::Property, Number::Ball(Ball::new(Dd::ZERO, 1e-3)), row);
        let x = Matrix::from_fn(2, 2, |i, j| if i == j { Triple::from(1.0) } else { Triple::from(0.0) });
        let (k, m) = (Terms::of(&system.k), Terms::of(&system.m));
        let found = enclose(&Gram::of(&k, &x), &Gram::of(&m, &x));
        assert!(found.iter().all(|found| found.radius >= 2e-3 && found.radius < 1e-2), "{found:?}");
    }

    /// The squares whose weighted sum is a form: (w, coordinate, other end).
    type Squares<'a> = &'a [(&'a str, usize, Option<usize>)];

    /// Checks that every radius encloses the eigenvalue at its position, or that nothing is reported.
    fn check(k: Squares, m: Squares, x: &Matrix<Triple>, truth: &[f64]) -> Vec<Enclosure> {
        let mut system = blank(truth.len());
        m.iter().for_each(|&(w, i, j)| push(&mut system.m, w, i, j));
        k.iter().for_each(|&(w, i, j)| push(&mut system.k, w, i, j));
        let (k, m) = (Terms::of(&system.k), Terms::of(&system.m));
        let found = enclose(&Gram::of(&k, x), &Gram::of(&m, x));
        for (found, truth) in found.iter().zip(truth) {
            let error = (found.lambda.hi() - truth).abs();
            let nothing = found.radius == f64::INFINITY;
            assert!(nothing || error <= found.radius + 1e-14 * truth, "{truth}: {found:?}");
        }
        found
    }

    fn vectors(columns: &[&[f64]]) -> Matrix<Triple> {
        Matrix::from_fn(columns.len(), columns.len(), |i, j| Triple::from(columns[j][i]))
    }

    const UNIT_MASSES: [(&str, usize, Option<usize>); 3] = [("1", 0, None), ("1", 1, None), ("1", 2, None)];

    #[test]
    fn a_vector_of_zeros_certifies_nothing() {
        let k = [("1", 0, None), ("2", 1, None), ("3", 2, None)];
        let x = vectors(&[&[1.0, 0.0, 0.0], &[0.0, 1.0, 0.0], &[0.0; 3]]);
        let found = check(&k, &UNIT_MASSES, &x, &[1.0, 2.0, 3.0]);
        assert!(found.iter().all(|found| found.radius == f64::INFINITY), "{found:?}");
    }

    /// A mass of 1 +- 2 may be negative: dividing by its lower bound does not give a radius.
    #[test]
    fn a_mass_that_may_be_negative_certifies_nothing() {
        let mut system = blank(1);
        let source = system.m.source(system.coordinates[0].name);
        let mass = Number::Ball(Ball::new(Dd::ONE, 2.0));
        system.m.push(source, Nature::Property, mass, [(CoordinateId(0), Number::ONE)]);
        push(&mut system.k, "4", 0, None);
        let (k, m, x) = (Terms::of(&system.k), Terms::of(&system.m), vectors(&[&[1.0]]));
        let found = enclose(&Gram::of(&k, &x), &Gram::of(&m, &x));
        assert_eq!(found[0].radius, f64::INFINITY, "{found:?}");
    }

    /// Eigenvalues 1 and 1.000001, from vectors that are half of one mode and half of the other: both quotients are
    /// 1.0000005.
    #[test]
    fn the_coupling_of_close_modes_is_in_their_radius() {
        let k = [("1", 0, None), ("1.000001", 1, None), ("9", 2, None)];
        let x = vectors(&[&[1.0, 1.0, 0.0], &[1.0, -1.0, 0.0], &[0.0, 0.0, 1.0]]);
        let found = check(&k, &UNIT_MASSES, &x, &[1.0, 1.000001, 9.0]);
        assert!(found[0].radius >= 5e-7 && found[0].radius < 1e-5, "{found:?}");
    }

    /// Eigenvalues 1, 10 and 12; the first and last vectors are half of each mode. Both quotients are 6.5, so the exact
    /// quotient of 10 would be counted as the third.
    #[test]
    fn modes_next_to_poor_ones_are_not_counted() {
        let k = [("1", 0, None), ("10", 1, None), ("12", 2, None)];
        let x = vectors(&[&[1.0, 0.0, 1.0], &[0.0, 1.0, 0.0], &[1.0, 0.0, -1.0]]);
        check(&k, &UNIT_MASSES, &x, &[1.0, 10.0, 12.0]);
    }

    /// K = [1 -0.51; -0.51 1] and M = [1 -0.5; -0.5 1], and both a hundred times as large: the coupling is 0.01 at both quotients, but
    /// 0.02 at the eigenvalue 0.98.
    #[test]
    fn modes_of_a_group_are_coupled_by_more_outside_of_it() {
        for [k, k_rest, m] in [["0.51", "0.49", "0.5"], ["51", "49", "50"]] {
            let (k, m) = (
                [(k, 0, Some(1)), (k_rest, 0, None), (k_rest, 1, None)],
                [(m, 0, Some(1)), (m, 0, None), (m, 1, None)],
            );
            let found = check(&k, &m, &vectors(&[&[1.0, 0.0], &[0.0, 1.0]]), &[0.98, 1.0 + 0.01 / 1.5]);
            assert!(found[0].radius < 0.06, "{found:?}");
        }
    }

    /// K = [2 -0.3; -0.3 1] and M = [1 -0.2; -0.2 1], with the axes as vectors: at the upper quotient, 2, the coupling
    /// is 0.1 and would give a radius of 0.01; the eigenvalue is 1.5 + sqrt(0.96)/1.92, farther away, where the
    /// coupling is larger. Repeated with a hundredth and with a hundred times the stiffness.
    #[test]
    fn a_radius_holds_for_all_assumed_matrices() {
        let m = [("0.2", 0, Some(1)), ("0.8", 0, None), ("0.8", 1, None)];
        let half = 0.96f64.sqrt() / 1.92;
        for (unit, [joined, first, second]) in
            [(1.0, ["0.3", "1.7", "0.7"]), (0.01, ["0.003", "0.017", "0.007"]), (100.0, ["30", "170", "70"])]
        {
            let k = [(joined, 0, Some(1)), (first, 0, None), (second, 1, None)];
            let truth = [(1.5 - half) * unit, (1.5 + half) * unit];
            let found = check(&k, &m, &vectors(&[&[1.0, 0.0], &[0.0, 1.0]]), &truth);
            assert!(found[1].radius < 0.02 * unit, "{found:?}");
        }
    }
}
