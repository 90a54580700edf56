//! Tiny and huge numbers: forms scaled by powers of two on the way into the methods, eigenpairs scaled back.
//!
//! The bounds of the methods hold if no product leaves the range of binary64; the method for trees refuses other
//! numbers ([`forest`](super::tree::forest)), the others lose digits. With M' = 2^m M and K' = 2^k K the vectors stay the same
//! and the eigenvalues are multiplied by 2^(k-m). A power of two causes no rounding on the way in, because the numbers
//! of the model are scaled before they are rounded; the bound contains the rounding on the way back. See
//! docs/method/modes.md#certificate.

use crate::analysis::modes::pair::{Displacements, Eigenvalue, Pair};
use crate::analysis::modes::request::{Band, Request, Which};
use crate::analysis::modes::terms::Terms;
use crate::base::{Number, Rational};
use crate::kernel::triple::{Precise, Triple};
use crate::system::Form;

/// Squares between 2^-PLAIN and 2^PLAIN are not scaled.
pub(in crate::analysis) const PLAIN: i32 = 100;
/// Bits of the largest power of two by which two numbers in the range of binary64 can differ.
const MOST_BITS: u64 = 20_000;

/// Exponents m and k of the module's text, both even.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    masses: i32,
    stiffness: i32,
}

impl Scale {
    /// `None` if the numbers are of ordinary size.
    pub fn of(stiffness: &Terms, masses: &Terms) -> Option<Scale> {
        let scale = Scale { masses: centring(masses), stiffness: centring(stiffness) };
        (scale.masses != 0 || scale.stiffness != 0).then_some(scale)
    }

    /// 2^k K and 2^m M; `None` if an exponent is out of range.
    pub fn forms(self, k: &Form, m: &Form) -> Option<(Form, Form)> {
        Some((times(k, self.stiffness)?, times(m, self.masses)?))
    }

    /// The request for the scaled forms.
    pub fn request(self, request: &Request) -> Request {
        let half = (self.stiffness - self.masses) / 2;
        let end = |omega: f64| match omega {
            0.0 => 0.0,
            omega => by_power(omega, half).clamp(f64::MIN_POSITIVE, f64::MAX),
        };
        let which = match request.which {
            Which::Within(band) => Which::Within(Band { from: end(band.from), to: end(band.to) }),
            which => which,
        };
        Request { which, ..*request }
    }

    /// Converts an eigenpair of the scaled forms to one of the originals; `None` if it lies outside the range of
    /// binary64.
    pub fn unscale(self, pair: Pair) -> Option<Pair> {
        let value = match pair.value {
            Eigenvalue::Zero => Eigenvalue::Zero,
            Eigenvalue::Near { value, radius, positive } => {
                let (value, radius) = scale(value, radius, self.masses - self.stiffness)?;
                Eigenvalue::Near { value, radius, positive }
            }
        };
        // x^T M x = 1 in both.
        let half = self.masses / 2;
        let x = match pair.x {
            Displacements::Plain(x) => Displacements::Plain(x.into_iter().map(|x| by_power(x, half)).collect()),
            Displacements::Precise(x) => Displacements::Precise(x.into_iter().map(|x| x.by_power(half)).collect()),
        };
        let finite = match &x {
            Displacements::Plain(x) => x.iter().all(|x| x.is_finite()),
            Displacements::Precise(x) => x.iter().all(|x| x.is_finite()),
        };
        finite.then_some(Pair { value, x, ..pair })
    }
}

/// The even exponent that brings the middle of all squares near 1; 0 if all are of ordinary size.
fn centring(terms: &Terms) -> i32 {
    let exponents = (0..terms.len()).filter_map(|t| {
        let (_, factors) = terms.row(t);
        let largest = factors.iter().map(|factor| factor.to_f64().abs()).fold(0.0, f64::max);
        Some(exponent(terms.weight(t).value.hi())? + 2 * exponent(largest)?)
    });
    let ends = exponents.fold(None, |ends: Option<(i32, i32)>, at| {
        let (low, high) = ends.unwrap_or((at, at));
        Some((low.min(at), high.max(at)))
    });
    match ends {
        Some((low, high)) if low < -PLAIN || high > PLAIN => -(low + high) / 4 * 2,
        _ => 0,
    }
}

/// e for a number between 2^e and 2^(e+1) in magnitude; `None` for zero and for numbers that are not finite.
pub(in crate::analysis) fn exponent(x: f64) -> Option<i32> {
    if x == 0.0 || !x.is_finite() {
        return None;
    }
    // Below the normal range: counted from the top of the last word.
    let (x, less) = if x.abs() < f64::MIN_POSITIVE { (x * (1u64 << 54) as f64, 54) } else { (x, 0) };
    Some((x.to_bits() >> 52 & 0x7ff) as i32 - 1023 - less)
}

/// x 2^e, rounded if the result is below the normal range, infinite if it is above it.
pub fn by_power(x: f64, e: i32) -> f64 {
    let power = |e: i32| f64::from_bits(((1023 + e) as u64) << 52);
    // Large steps first, so that nothing is rounded twice on the way down.
    let (mut x, mut left) = (x, e);
    while left != 0 && x != 0.0 && x.is_finite() {
        let step = left.clamp(-900, 900);
        x *= power(step);
        left -= step;
    }
    x
}

/// Error from rounding three words and a radius below the normal range: a few units of 2^-1074 each.
const UNDERFLOW: f64 = 1e-322;

/// A certified number times 2^e; `None` if it is too large for binary64. Near the lower end of the range the relative
/// bound grows until the number is all error.
fn scale(value: Triple, radius: f64, e: i32) -> Option<(Triple, f64)> {
    let (result, bound) = (value.by_power(e), by_power(radius, e));
    if !radius.is_finite() {
        return Some((result, f64::INFINITY));
    }
    // A bound of zero means that the number has no error.
    let lost =
        if e != 0 && result.hi().abs() < f64::MIN_POSITIVE / f64::EPSILON / f64::EPSILON { UNDERFLOW } else { 0.0 };
    let bound = bound.next_up() + lost;
    (result.is_finite() && bound.is_finite()).then_some((result, bound))
}

/// 2^e; `None` if the exponent is beyond what two numbers in the range of binary64 can differ by.
pub(in crate::analysis) fn power(e: i32) -> Option<Number> {
    Rational::from(2).pow(e, MOST_BITS).map(Number::from)
}

/// 2^e times a form, exact where its weights are.
pub(in crate::analysis) fn times(form: &Form, e: i32) -> Option<Form> {
    let power = power(e)?;
    let mut result = Form::new();
    for term in form.terms() {
        let source = result.source(form.source_of(term.source));
        result.push(source, term.nature, term.weight * &power, form.row(term).copies());
    }
    Some(result)
}

impl Triple {
    /// The words times 2^e; see [`by_power`].
    pub fn by_power(self, e: i32) -> Triple {
        self.map(|word| by_power(word, e))
    }
}

impl Precise {
    /// Whether the number is certainly far enough from the ends of the range that none of its words was lost.
    #[cfg(test)]
    fn is_ordinary(&self) -> bool {
        exponent(self.value.hi()).is_some_and(|e| e.abs() <= PLAIN)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::modes::tree::{forest::Forest, lowest};
    use crate::analysis::test_systems::{blank, push};

    #[test]
    fn powers_are_exact_within_the_range() {
        for x in [1.0, -0.1, 1e300, 3e-308, 5e-324] {
            for e in [0, 3, -7, 1000, -1000, 2000] {
                let there = by_power(x, e);
                if there.is_finite() && there.abs() >= f64::MIN_POSITIVE {
                    assert_eq!(by_power(there, -e), x, "{x:e} {e}");
                }
            }
        }
        assert_eq!([1.0, 1.9, 0.5, -4.0, 5e-324].map(exponent), [0, 0, -1, 2, -1074].map(Some));
        assert_eq!([0.0, f64::NAN, f64::INFINITY].map(exponent), [None; 3]);
    }

    /// The bound of the result covers the rounding on the way back.
    #[test]
    fn underflow_is_in_the_bound() {
        let value = Triple::from(1.0 + f64::EPSILON) + Triple::from(1e-30);
        let (back, bound) = scale(value, 1e-31, -1000).expect("a normal number");
        assert_eq!(back.hi(), (1.0 + f64::EPSILON) * by_power(1.0, -1000));
        // 1e-30 2^-1000 is below all numbers: it is lost, and the bound contains it.
        let lost = by_power(1e-30, -1000);
        assert!(bound >= lost && bound >= by_power(1e-31, -1000), "{bound:e} {lost:e}");
        assert!(scale(value, 1e-31, 2000).is_none());
        let (few, bound) = scale(value, 1e-31, -1070).expect("four bits are left");
        assert!(few.hi() == by_power(1.0, -1070) && bound >= UNDERFLOW);
        let (none, bound) = scale(value, 1e-31, -1100).expect("a bound is left");
        assert!(none.is_zero() && bound > 0.0);
        assert_eq!(scale(value, f64::INFINITY, -10).map(|(_, bound)| bound), Some(f64::INFINITY));
        // A number that may be zero may still be zero after scaling.
        let (zero, bound) = scale(Triple::from(1e-20), 1e-19, -1060).expect("may be zero");
        assert!(zero.hi() <= bound);
    }

    /// A chain of n masses, all numbers times `unit`: its eigenvalues are 4 sin^2((2j - 1) pi / (4n + 2)) for any unit.
    fn chain(n: usize, unit: &str) -> crate::system::LinearSystem {
        let mut system = blank(n);
        for i in 0..n {
            push(&mut system.m, unit, i, None);
            push(&mut system.k, unit, i, i.checked_sub(1));
        }
        system
    }

    /// Without scaling, products of such numbers lose their low words, which the bounds of trees do not account for:
    /// the tree is then refused.
    #[test]
    fn trees_of_numbers_near_the_ends_of_the_range_are_scaled_or_refused() {
        let forest =
            |system: &crate::system::LinearSystem| Forest::of(&Terms::of(&system.m), &Terms::of(&system.k), system.n());
        let plain = chain(20, "1");
        let known = lowest(&forest(&plain).expect("a tree"), 4, 1e-28).expect("modes apart");
        for unit in ["1e-306", "1e-290", "1e-200", "1e300"] {
            let system = chain(20, unit);
            assert!(forest(&system).is_none(), "{unit}");
            let (stiffness, masses) = (Terms::of(&system.k), Terms::of(&system.m));
            let scale = Scale::of(&stiffness, &masses).expect("far from one");
            let (k, m) = scale.forms(&system.k, &system.m).expect("in range");
            let (k, m) = (Terms::of(&k), Terms::of(&m));
            assert!(k.weights().chain(m.weights()).all(|weight| weight.is_ordinary()));
            let found = lowest(&Forest::of(&m, &k, 20).expect("a tree"), 4, 1e-28).expect("modes apart");
            for (a, b) in found.iter().zip(&known) {
                assert!((a.lambda - b.lambda).hi().abs() <= a.radius + b.radius, "{unit}");
                assert!(a.radius < 1e-28 * a.lambda.hi(), "{unit}: {:e}", a.radius);
            }
        }
        assert_eq!(Scale::of(&Terms::of(&plain.k), &Terms::of(&plain.m)), None);
    }

    /// Stiffnesses times 2^200: frequencies are 2^100 times as high; masses times 2^200: shapes of unit mass 2^-100 times as large.
    #[test]
    fn bands_and_shapes_are_scaled_with_the_numbers() {
        use crate::analysis::answer::Route;
        let power = 2f64.powi(100);
        let band = Request { which: Which::Within(Band { from: 0.0, to: 3.0 }), ..Request::default() };
        let Which::Within(found) = (Scale { masses: 0, stiffness: 200 }).request(&band).which else { panic!("a band") };
        assert_eq!((found.from, found.to), (0.0, 3.0 * power));
        let pair = Pair { value: Eigenvalue::Zero, x: Displacements::Plain(vec![1.0]), route: Route::Exact };
        let found = Scale { masses: 200, stiffness: 200 }.unscale(pair).expect("in range");
        assert_eq!(found.x.to_f64(), [power]);
    }
}
