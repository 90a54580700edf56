//! Modes of few coordinates in exact arithmetic: the roots of the polynomial det(K - x M), whatever the sizes of its numbers. In: the
//! forms of a part, all rational, and modes of which some are not certain enough. Out: the modes with eigenvalues to all digits of
//! double-double. See docs/method/modes.md#few-coordinates.

use crate::analysis::answer::Route;
use crate::analysis::modes::pair::{Displacements, Eigenvalue, Pair};
use crate::analysis::poles::exact::{assemble, roots};
use crate::base::{Ball, Dd, OrderBy, Rational};
use crate::kernel::big_float::Float;
use crate::kernel::polynomial::{Polynomial, determinant};
use crate::kernel::triple::Triple;
use crate::system::Form;
use num_bigint::BigInt;
use num_integer::Integer;
use num_traits::One;
use std::cmp::Ordering;

/// For more coordinates than this, exact arithmetic on the polynomial takes longer than a user would wait.
const MOST_COORDINATES: usize = 20;
/// Numbers with more bits than this would make it too long, too.
const MOST_BITS: u64 = 1000;
/// Steps of an inverse iteration: each makes other modes some 1e-30 of what they were, unless their eigenvalues are close.
const STEPS: usize = 2;

/// The modes with exact eigenvalues where one of them is not certain to the tolerance; as they are if they are too many, or a number is
/// not rational.
pub fn sharpen(pairs: Vec<Pair>, k: &Form, m: &Form, tolerance: f64) -> Vec<Pair> {
    let n = pairs.len();
    let is_certain = |pair: &Pair| is_certain(pair, tolerance);
    if n > MOST_COORDINATES || pairs.iter().all(is_certain) {
        return pairs;
    }
    let Some(pencil) = Pencil::of(k, m, n) else { return pairs };
    let Some(values) = pencil.eigenvalues() else { return pairs };
    let exact = |(pair, value): (Pair, Value)| {
        let is_known = is_certain(&pair) && value.may_be(&pair.value);
        let x = if is_known || !value.is_alone { None } else { pencil.vector(value.ball.mid) };
        let route = Route::Exact;
        match x {
            _ if is_known => pair,
            Some(x) => Pair { value: value.eigenvalue(), x: Displacements::Precise(x), route },
            None => Pair { value: value.eigenvalue(), route, ..pair },
        }
    };
    pairs.into_iter().zip(values).map(exact).collect()
}

/// Whether an eigenvalue is known to a relative tolerance.
pub(super) fn is_certain(pair: &Pair, tolerance: f64) -> bool {
    match pair.value {
        Eigenvalue::Zero => true,
        // NaN is not certain.
        Eigenvalue::Near { value, radius, .. } => radius <= tolerance * value.hi().abs(),
    }
}

/// An enclosure of the i-th eigenvalue; `is_alone` if no other one may be the same.
#[derive(Clone, Copy, Debug)]
struct Value {
    ball: Ball,
    is_alone: bool,
}

impl Value {
    fn eigenvalue(self) -> Eigenvalue {
        match self.ball.is_zero() {
            true => Eigenvalue::Zero,
            false => {
                let positive = self.ball.is_positive();
                Eigenvalue::Near { value: Triple::from(self.ball.mid), radius: self.ball.rad, positive }
            }
        }
    }

    fn may_be(&self, other: &Eigenvalue) -> bool {
        match other {
            Eigenvalue::Zero => self.ball.is_zero(),
            Eigenvalue::Near { value, radius, .. } => {
                (Triple::from(self.ball.mid) - *value).hi().abs() <= (self.ball.rad + radius) * (1.0 + 1e-9)
            }
        }
    }
}

/// K and M, multiplied by one integer that clears all denominators.
struct Pencil {
    common: BigInt,
    k: Vec<Vec<BigInt>>,
    m: Vec<Vec<BigInt>>,
}

impl Pencil {
    fn of(k: &Form, m: &Form, n: usize) -> Option<Pencil> {
        let local: Vec<u32> = (0..n as u32).collect();
        let matrix = |form: &Form| {
            let all: Vec<u32> = (0..form.terms().len() as u32).collect();
            assemble(form, &all, &local, n)
        };
        let (k, m) = (matrix(k)?, matrix(m)?);
        let entries = || [&k, &m].into_iter().flatten().flatten();
        let common = entries().fold(BigInt::one(), |lcm, x| lcm.lcm(x.to_big().denom()));
        let cleared = |matrix: &[Vec<Rational>]| -> Vec<Vec<BigInt>> {
            let entry = |x: &Rational| x.to_big().numer() * (&common / x.to_big().denom());
            matrix.iter().map(|row| row.iter().map(entry).collect()).collect()
        };
        let (k, m) = (cleared(&k), cleared(&m));
        let fits = [&k, &m].into_iter().flatten().flatten().all(|x| x.bits() <= MOST_BITS);
        fits.then_some(Pencil { common, k, m })
    }

    /// All eigenvalues, ascending; `None` if they are fewer than coordinates, or one is not real, or roots are not separated.
    fn eigenvalues(&self) -> Option<Vec<Value>> {
        let n = self.k.len();
        let at = |x: i64| (0..n).map(|i| (0..n).map(|j| &self.k[i][j] - &self.m[i][j] * x).collect()).collect();
        let polynomial = Polynomial::through(&(0..=n as i64).map(|x| determinant(at(x))).collect::<Vec<BigInt>>());
        if polynomial.is_zero() {
            return None;
        }
        let (zeros, rest) = polynomial.without_zero_roots();
        let mut values = vec![Ball::ZERO; zeros];
        for (index, factor) in rest.by_multiplicity()?.iter().enumerate() {
            for (root, real) in roots(factor)? {
                if !real {
                    return None;
                }
                values.extend(std::iter::repeat_n(root.re, index + 1));
            }
        }
        if values.len() != n {
            return None;
        }
        values.order_by(|a, b| a.mid.partial_cmp(&b.mid).unwrap_or(Ordering::Equal));
        Some(in_order(values))
    }

    /// A vector of the eigenvalue near x, of a norm x^T M x of one; `None` if it cannot be told from others.
    fn vector(&self, x: Dd) -> Option<Vec<Triple>> {
        let n = self.k.len();
        let bits = 4 * MOST_BITS;
        let number = |x: &BigInt| Float::from(x.clone());
        let x = &Float::from(x.hi) + &Float::from(x.lo);
        let mut rows: Vec<Vec<Float>> =
            (0..n).map(|i| (0..n).map(|j| &number(&self.k[i][j]) - &(&number(&self.m[i][j]) * &x)).collect()).collect();
        // P (K - x M) = L U
        let mut order: Vec<usize> = (0..n).collect();
        for p in 0..n {
            let size = |i: &usize| rows[*i][p].ceiling_log2();
            let largest = (p..n).max_by_key(size).filter(|i| !rows[*i][p].is_zero())?;
            rows.swap(p, largest);
            order.swap(p, largest);
            let (head, below) = rows.split_at_mut(p + 1);
            for row in below {
                row[p] = row[p].divided_by(&head[p][p], bits).cut(bits);
                let factor = row[p].clone();
                for j in p + 1..n {
                    row[j] = (&row[j] - &(&factor * &head[p][j])).cut(bits);
                }
            }
        }
        // Any vector has a part along the one that is looked for.
        let mut vector: Vec<Float> = (0..n).map(|i| Float::from(1.0 + i as f64 / n as f64)).collect();
        for _ in 0..STEPS {
            let force: Vec<Float> = (0..n).map(|i| self.momentum(&vector, i).cut(bits)).collect();
            let mut found: Vec<Float> = order.iter().map(|&i| force[i].clone()).collect();
            for i in 0..n {
                let known = (0..i).fold(Float::zero(), |sum, j| &sum + &(&rows[i][j] * &found[j]));
                found[i] = (&found[i] - &known).cut(bits);
            }
            for i in (0..n).rev() {
                let known = (i + 1..n).fold(Float::zero(), |sum, j| &sum + &(&rows[i][j] * &found[j]));
                found[i] = (&found[i] - &known).divided_by(&rows[i][i], bits).cut(bits);
            }
            let largest = found.iter().filter_map(Float::ceiling_log2).max()?;
            vector = found.into_iter().map(|x| x.times_power_of_two(-largest)).collect();
        }
        let norm = (0..n).fold(Float::zero(), |sum, i| &sum + &(&vector[i] * &self.momentum(&vector, i)));
        Some(scale(&vector, &norm.divided_by(&Float::from(self.common.clone()), bits)))
    }

    /// An entry of M x.
    fn momentum(&self, x: &[Float], i: usize) -> Float {
        let products = self.m[i].iter().zip(x).filter(|(m, _)| m.bits() > 0);
        products.fold(Float::zero(), |sum, (m, x)| &sum + &(&Float::from(m.clone()) * x))
    }
}

/// Enclosures ascending by their middles: where some meet, what is the i-th of all is in the union of them.
fn in_order(values: Vec<Ball>) -> Vec<Value> {
    let meet = |a: &Ball, b: &Ball| (b.mid - a.mid).hi.abs() <= (a.rad + b.rad) * (1.0 + 1e-9);
    let (mut found, mut first) = (Vec::with_capacity(values.len()), 0);
    for end in 1..=values.len() {
        let group = &values[first..end];
        if values.get(end).is_some_and(|next| group.iter().any(|value| meet(value, next))) {
            continue;
        }
        found.extend(group.iter().map(|value| {
            let reach = |other: &Ball| (other.mid - value.mid).hi.abs() * (1.0 + 1e-9) + other.rad;
            let rad = group.iter().map(reach).fold(0.0, f64::max);
            let rad = if rad > 0.0 { rad * (1.0 + 1e-9) } else { 0.0 };
            Value { ball: Ball::new(value.mid, rad), is_alone: group.len() == 1 }
        }));
        first = end;
    }
    found
}

/// A vector over the root of a number, to three words.
pub(super) fn scale(vector: &[Float], norm: &Float) -> Vec<Triple> {
    let factor = Triple::from(norm.to_ball(0.0).mid.sqrt().recip());
    let words = |x: &Float| {
        let hi = x.to_f64();
        let rest = x - &Float::from(hi);
        let middle = rest.to_f64();
        let low = (&rest - &Float::from(middle)).to_f64();
        Triple::from(hi) + (Triple::from(middle) + Triple::from(low))
    };
    vector.iter().map(|x| words(x) * factor).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::test_systems::{blank, push};
    use crate::system::LinearSystem;

    /// Blocks of 1 kg on springs of 1 N/m to the ground and 10^60 N/m between them, and a loose one.
    fn blocks() -> LinearSystem {
        let mut system = blank(3);
        (0..3).for_each(|i| push(&mut system.m, "1", i, None));
        push(&mut system.k, "1", 0, None);
        push(&mut system.k, "1", 1, None);
        push(&mut system.k, "1e60", 0, Some(1));
        system
    }

    /// 0, 1 and 1 + 2 10^60.
    #[test]
    fn eigenvalues_of_any_ratio_are_exact() {
        let system = blocks();
        let pencil = Pencil::of(&system.k, &system.m, 3).expect("rational");
        let values = pencil.eigenvalues().expect("three");
        assert!(values[0].ball.is_zero() && values.iter().all(|value| value.is_alone));
        for (value, truth) in values[1..].iter().zip([1.0, 2e60]) {
            let off = (value.ball.mid - Dd::from(truth)).hi.abs();
            // 2e60 is a binary64 number to 1e-16 of itself alone.
            assert!(value.ball.rad <= 1e-31 * truth && off <= value.ball.rad + 2e-16 * (truth - 1.0), "{value:?}");
        }
        let x = pencil.vector(values[1].ball.mid).expect("a vector");
        let root = 0.5f64.sqrt();
        assert!((x[0].hi() - root).abs() < 1e-15 && (x[1].hi() - root).abs() < 1e-15 && x[2].hi().abs() < 1e-30);
    }

    /// What is not known for a pair of eigenvalues is replaced, and what is known well stays.
    #[test]
    fn uncertain_modes_are_made_certain() {
        let system = blocks();
        let pair = |value: f64, radius: f64| Pair {
            value: Eigenvalue::Near { value: Triple::from(value), radius, positive: true },
            x: Displacements::Plain(vec![f64::NAN; 3]),
            route: Route::Factored,
        };
        let zero = Pair { value: Eigenvalue::Zero, ..pair(0.0, 0.0) };
        let pairs = vec![zero, pair(3.0, f64::INFINITY), pair(2e60, 1e45)];
        let found = sharpen(pairs, &system.k, &system.m, 1e-12);
        assert!(matches!(found[0].value, Eigenvalue::Zero) && found[0].route == Route::Factored);
        assert!(matches!(found[2].value, Eigenvalue::Near { radius: 1e45, .. }) && found[2].route == Route::Factored);
        assert!(found[1].route == Route::Exact && found[1].x.to_f64().iter().all(|x| x.is_finite()));
        let Eigenvalue::Near { value, radius, positive } = found[1].value else { panic!("{:?}", found[1].value) };
        assert!(positive && (value - Triple::ONE).hi().abs() <= radius && radius < 1e-30, "{value:?} {radius}");
    }

    /// The last eigenvalue, known well, in the place of the second, and the other way round: both are replaced by what stands there.
    #[test]
    fn a_mode_that_is_certain_of_another_eigenvalue_is_replaced() {
        let system = blocks();
        let pair = |value: f64, radius: f64| Pair {
            value: Eigenvalue::Near { value: Triple::from(value), radius, positive: true },
            x: Displacements::Plain(vec![0.0; 3]),
            route: Route::Factored,
        };
        let pairs = vec![pair(0.5, f64::INFINITY), pair(2e60, 1e45), pair(1.0, 1e-20)];
        let found = sharpen(pairs, &system.k, &system.m, 1e-12);
        assert!(matches!(found[0].value, Eigenvalue::Zero));
        for (pair, truth) in found[1..].iter().zip([1.0, 2e60]) {
            let Eigenvalue::Near { value, .. } = pair.value else { panic!("{:?}", pair.value) };
            assert!(pair.route == Route::Exact && (value.hi() / truth - 1.0).abs() < 1e-15, "{value:?}");
        }
    }

    /// Of 1 within 0.2, 1.1 within 0.2, and 2 within 0.1: the first two in order are anywhere from 0.8 to 1.3.
    #[test]
    fn enclosures_that_meet_are_widened_to_hold_either() {
        let value = |mid: f64, rad: f64| Ball::from(mid).widen(rad);
        let found = in_order(vec![value(1.0, 0.2), value(1.1, 0.2), value(2.0, 0.1)]);
        for value in &found[..2] {
            let [low, high] = [value.ball.to_f64() - value.ball.rad, value.ball.to_f64() + value.ball.rad];
            assert!(low <= 0.8 && high >= 1.3 && !value.is_alone, "{value:?}");
        }
        assert!(found[2].is_alone && found[2].ball.rad < 0.1001);
    }
}
