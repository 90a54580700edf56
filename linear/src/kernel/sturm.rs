//! Exact counts of the roots of a polynomial with integer coefficients that are real, and that lie on either side of
//! the imaginary axis, by Sturm's chain and by Routh's. In: a polynomial. Out: exact counts, or nothing if the numbers
//! are too long. See docs/method/poles.md#exact-arithmetic.
//!
//! The chain of remainders is the subresultant chain (Brown, JACM 18 (1971) 478), whose coefficients grow by a constant
//! number of digits in each step and divide exactly; their signs are tracked separately.

use crate::kernel::polynomial::Polynomial;
use num_bigint::{BigInt, Sign};
use num_traits::{One, Zero};

/// If the degree times the number of bits exceeds this, a chain takes longer than a user would wait.
const MOST_BITS: u64 = 1 << 17;

/// The number of roots in each half plane, counted with multiplicity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HalfPlanes {
    pub left: usize,
    /// On the imaginary axis, zero included.
    pub axis: usize,
    pub right: usize,
}

/// The number of distinct real roots; `None` for the zero polynomial, or if the count would take too long.
pub fn real_roots(f: &Polynomial) -> Option<usize> {
    let chain = Chain::of(f.coefficients(), f.derivative().coefficients())?;
    usize::try_from(chain.changes(Place::Below) - chain.changes(Place::Above)).ok()
}

/// The number of distinct negative roots.
fn negative_roots(f: &Polynomial) -> Option<usize> {
    let chain = Chain::of(f.coefficients(), f.derivative().coefficients())?;
    usize::try_from(chain.changes(Place::Below) - chain.changes(Place::Zero)).ok()
}

/// The roots by half planes. With f(s) = e(s²) + s o(s²) and g the greatest common divisor of e and o, the roots of
/// g(s²) are those whose mirror image -s is a root too; the others, those of h = f / g(s²), are off the axis, and the
/// argument of h along the axis counts them (Gantmacher, Theory of Matrices II, XV).
pub fn half_planes(f: &Polynomial) -> Option<HalfPlanes> {
    if f.is_zero() {
        return None;
    }
    let (zeros, f) = f.without_zero_roots();
    let (even, odd) = halves(&f);
    let mirrored = even.gcd(&odd)?;
    let rest = f.primitive().divided_by(&spread(&mirrored))?;
    let (mut axis, mut right) = (0, roots_on_the_right(&rest)?);
    for (index, factor) in mirrored.by_multiplicity()?.iter().enumerate() {
        let negative = negative_roots(factor)?;
        // Each root x of g gives s = ±√x: both on the axis if x < 0, otherwise one on either side.
        axis += 2 * (index + 1) * negative;
        right += (index + 1) * (factor.degree() - negative);
    }
    let left = f.degree().checked_sub(axis + right)?;
    Some(HalfPlanes { left, axis: axis + zeros, right })
}

/// The number of roots in the right half plane, for a polynomial without roots on the axis. With h(i w) = U(w) + i V(w)
/// the argument turns by pi (left - right) as w goes along the axis, which is pi times the index of U/V if the degree
/// is odd, and -pi times that of V/U if it is even.
fn roots_on_the_right(h: &Polynomial) -> Option<usize> {
    let d = h.degree();
    let part = |parity: usize| {
        let coefficient = |(k, a): (usize, &BigInt)| match k % 2 == parity {
            true if k / 2 % 2 == 1 => -a,
            true => a.clone(),
            false => BigInt::zero(),
        };
        Polynomial::new(h.coefficients().iter().enumerate().map(coefficient).collect())
    };
    let chain = Chain::of(part(d % 2).coefficients(), part(1 - d % 2).coefficients())?;
    let index = chain.changes(Place::Below) - chain.changes(Place::Above);
    let twice = if d % 2 == 1 { d as i64 - index } else { d as i64 + index };
    usize::try_from(twice).ok().filter(|twice| twice % 2 == 0).map(|twice| twice / 2)
}

/// The polynomials of the even and of the odd coefficients.
fn halves(f: &Polynomial) -> (Polynomial, Polynomial) {
    let every_second = |from: usize| f.coefficients().iter().skip(from).step_by(2).cloned().collect();
    (Polynomial::new(every_second(0)), Polynomial::new(every_second(1)))
}

/// g(s²)
fn spread(g: &Polynomial) -> Polynomial {
    Polynomial::new(g.coefficients().iter().flat_map(|a| [a.clone(), BigInt::zero()]).collect())
}

/// A place at which the signs of a chain are evaluated.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Place {
    /// Below all roots.
    Below,
    Zero,
    /// Above all roots.
    Above,
}

/// The data of a member of Sturm's chain that its signs need. The members are f, g, and then each the negated remainder
/// of the two before it.
struct Member {
    degree: usize,
    lead: Sign,
    constant: Sign,
}

struct Chain {
    members: Vec<Member>,
}

impl Chain {
    /// The chain of f and g; g is of lower degree than f.
    fn of(f: &[BigInt], g: &[BigInt]) -> Option<Chain> {
        let bits = f.iter().chain(g).map(BigInt::bits).max()?;
        if f.len() as u64 * bits > MOST_BITS {
            return None;
        }
        let (mut a, mut b) = (f.to_vec(), g.to_vec());
        // The member of the chain is a, up to a positive factor and this sign; likewise b for the next one.
        let (mut sign_a, mut sign_b) = (Sign::Plus, Sign::Plus);
        let mut members = vec![member(&a, sign_a)];
        let (mut divisor, mut power) = (BigInt::one(), BigInt::one());
        while let Some(lead) = b.last().cloned() {
            members.push(member(&b, sign_b));
            let step = a.len() - b.len();
            let mut rest = pseudo_remainder(&a, &b);
            let by = &divisor * power.pow(step as u32);
            rest.iter_mut().for_each(|x| *x = &*x / &by);
            let factor = if step % 2 == 0 { lead.sign() } else { Sign::Plus };
            let next = -(sign_a * factor * by.sign());
            (a, b) = (b, rest);
            (sign_a, sign_b) = (sign_b, next);
            // power <- lead^step / power^(step - 1)
            power = if step == 0 { power } else { lead.pow(step as u32) / power.pow(step as u32 - 1) };
            divisor = lead;
        }
        Some(Chain { members })
    }

    /// Number of sign changes, ignoring zeros.
    fn changes(&self, place: Place) -> i64 {
        let sign = |member: &Member| match place {
            Place::Below if member.degree % 2 == 1 => -member.lead,
            Place::Below | Place::Above => member.lead,
            Place::Zero => member.constant,
        };
        let signs: Vec<Sign> = self.members.iter().map(sign).filter(|&sign| sign != Sign::NoSign).collect();
        signs.windows(2).filter(|pair| pair[0] != pair[1]).count() as i64
    }
}

fn member(a: &[BigInt], sign: Sign) -> Member {
    let of = |x: Option<&BigInt>| sign * x.map_or(Sign::NoSign, BigInt::sign);
    Member { degree: a.len().saturating_sub(1), lead: of(a.last()), constant: of(a.first()) }
}

/// lead(b)^(deg a - deg b + 1) a modulo b; without leading zeros.
fn pseudo_remainder(a: &[BigInt], b: &[BigInt]) -> Vec<BigInt> {
    let mut rest = a.to_vec();
    let Some((lead, lower)) = b.split_last() else { return rest };
    while rest.len() > lower.len() {
        let Some(head) = rest.pop() else { break };
        let shift = rest.len() - lower.len();
        rest.iter_mut().for_each(|x| *x *= lead);
        for (x, y) in rest[shift..].iter_mut().zip(lower) {
            *x -= y * &head;
        }
    }
    while rest.last().is_some_and(Zero::is_zero) {
        rest.pop();
    }
    rest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polynomial(coefficients: &[i64]) -> Polynomial {
        Polynomial::new(coefficients.iter().map(|&a| a.into()).collect())
    }

    fn product(factors: &[&[i64]]) -> Polynomial {
        let mut product = vec![BigInt::one()];
        for factor in factors {
            let mut sum = vec![BigInt::zero(); product.len() + factor.len() - 1];
            for (i, a) in product.iter().enumerate() {
                for (j, &b) in factor.iter().enumerate() {
                    sum[i + j] += a * b;
                }
            }
            product = sum;
        }
        Polynomial::new(product)
    }

    #[test]
    fn real_roots_are_counted() {
        let check =
            |factors: &[&[i64]], count: usize| assert_eq!(real_roots(&product(factors)), Some(count), "{factors:?}");
        check(&[&[1, 0, 1], &[-2, 1], &[3, 1]], 2);
        check(&[&[1, 1], &[2, 1], &[3, 1], &[-4, 1], &[-5, 7]], 5);
        check(&[&[5, 2, 1], &[1, 0, 0, 0, 1]], 0);
        // s^6 - 2: the degrees skip from 6 to 5 to 0.
        check(&[&[-2, 0, 0, 0, 0, 0, 1]], 2);
        // s^4 - 4 s + 1: the degrees skip from 3 to 1, where the sign of a leading coefficient matters.
        check(&[&[1, -4, 0, 0, 1]], 2);
        check(&[&[5, -4, 0, 0, 1]], 0);
        check(&[&[1, 4, 0, 0, 1]], 2);
        check(&[&[5, 4, 0, 0, 1]], 0);
        check(&[&[1, 4, 0, 0, 1], &[-7, 1]], 3);
        // Double roots count once.
        check(&[&[1, 1], &[1, 1], &[-3, 1]], 2);
        check(&[&[7]], 0);
    }

    #[test]
    fn roots_are_counted_by_half_planes() {
        let (left, right): (&[i64], &[i64]) = (&[3, 1], &[-2, 1]);
        let (axis, pair, back): (&[i64], &[i64], &[i64]) = (&[4, 0, 1], &[5, 2, 1], &[5, -2, 1]);
        let check = |factors: &[&[i64]], [left, axis, right]: [usize; 3]| {
            let expected = Some(HalfPlanes { left, axis, right });
            assert_eq!(half_planes(&product(factors)), expected, "{factors:?}");
            // The sign of the polynomial does not matter.
            let negative = Polynomial::new(product(factors).coefficients().iter().map(|a| -a).collect());
            assert_eq!(half_planes(&negative), expected, "{factors:?}");
        };
        check(&[left], [1, 0, 0]);
        check(&[right], [0, 0, 1]);
        check(&[axis], [0, 2, 0]);
        check(&[pair, back], [2, 0, 2]);
        check(&[left, pair, right, right], [3, 0, 2]);
        check(&[axis, axis, left, back], [1, 4, 2]);
        check(&[&[0, 1], &[0, 1], left, right], [1, 2, 1]);
        // 2 and -2, 3 and -3: mirror images of each other.
        check(&[&[-4, 0, 1], &[-9, 0, 1], pair], [4, 0, 2]);
        check(&[&[1, 0, 0, 0, 1], pair, left], [5, 0, 2]);
        // Mirror images twice, and with a pair on the axis twice.
        check(&[&[-4, 0, 1], &[-4, 0, 1], left], [3, 0, 2]);
        check(&[&[-4, 0, 1], &[-4, 0, 1], axis, axis, pair], [4, 4, 2]);
    }

    /// (10^40 s - 1)(s + 1)(s² - 2 s/10^40 + 1): two roots barely to the right of the axis, and one to its left.
    #[test]
    fn roots_close_to_the_axis_are_on_their_side() {
        let big = BigInt::from(10).pow(40u32);
        let factors = [
            Polynomial::new(vec![-BigInt::one(), big.clone()]),
            polynomial(&[1, 1]),
            Polynomial::new(vec![big.clone(), BigInt::from(-2), big]),
        ];
        let mut product = vec![BigInt::one()];
        for factor in &factors {
            let mut sum = vec![BigInt::zero(); product.len() + factor.degree()];
            for (i, a) in product.iter().enumerate() {
                for (j, b) in factor.coefficients().iter().enumerate() {
                    sum[i + j] += a * b;
                }
            }
            product = sum;
        }
        let counted = half_planes(&Polynomial::new(product));
        assert_eq!(counted, Some(HalfPlanes { left: 1, axis: 0, right: 3 }));
    }

    #[test]
    fn counts_that_take_too_long_are_refused() {
        let long = Polynomial::new(vec![BigInt::one() << 200_000u32, BigInt::one(), BigInt::one()]);
        assert_eq!((real_roots(&long), half_planes(&long)), (None, None));
    }
}
