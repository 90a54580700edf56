//! Arithmetic modulo primes just below 2^61.

/// The integers modulo 2^61 - c, a prime.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    c: u64,
}

/// The largest primes below 2^61, in descending order.
pub const PRIMES: [Field; 12] = [
    Field { c: 1 },
    Field { c: 31 },
    Field { c: 45 },
    Field { c: 229 },
    Field { c: 259 },
    Field { c: 283 },
    Field { c: 339 },
    Field { c: 391 },
    Field { c: 403 },
    Field { c: 465 },
    Field { c: 531 },
    Field { c: 579 },
];

/// The gap below 2^61 must be smaller than this for [`Field::multiply`]; it is enough for thousands of primes.
const MOST: u64 = 1 << 18;

/// The largest primes below 2^61 in descending order, some six thousand of them: [`PRIMES`], then the next ones.
pub fn primes() -> impl Iterator<Item = Field> {
    let further = (PRIMES[PRIMES.len() - 1].c + 2..MOST).step_by(2).map(|c| Field { c });
    PRIMES.into_iter().chain(further.filter(|field| field.is_prime()))
}

const MASK: u64 = (1 << 61) - 1;

impl Field {
    #[inline]
    pub fn prime(self) -> u64 {
        (1 << 61) - self.c
    }

    #[inline]
    pub fn add(self, a: u64, b: u64) -> u64 {
        let sum = a + b;
        if sum >= self.prime() { sum - self.prime() } else { sum }
    }

    #[inline]
    pub fn negate(self, a: u64) -> u64 {
        if a == 0 { 0 } else { self.prime() - a }
    }

    /// The Miller-Rabin test with bases that expose every composite number below 2^64 (Sorenson and Webster, Math.
    /// Comp. 86 (2017) 985).
    fn is_prime(self) -> bool {
        let p = self.prime();
        let twos = (p - 1).trailing_zeros();
        [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37].into_iter().all(|base| {
            let mut x = self.power(base, (p - 1) >> twos);
            let mut passes = x == 1 || x == p - 1;
            for _ in 1..twos {
                x = self.multiply(x, x);
                passes |= x == p - 1;
            }
            passes
        })
    }

    /// a b, reduced by 2^61 = c twice: the high part shrinks from 61 bits to at most 18 of them, because c is below
    /// 2^18.
    #[inline]
    pub fn multiply(self, a: u64, b: u64) -> u64 {
        let product = u128::from(a) * u128::from(b);
        let once = u128::from(product as u64 & MASK) + (product >> 61) * u128::from(self.c);
        let twice = (once as u64 & MASK) + (once >> 61) as u64 * self.c;
        self.add(twice, 0)
    }

    /// a^(p-2), by Fermat; zero for zero.
    pub fn inverse(self, a: u64) -> u64 {
        self.power(a, self.prime() - 2)
    }

    fn power(self, mut base: u64, mut exponent: u64) -> u64 {
        let mut result = 1;
        while exponent > 0 {
            if exponent & 1 == 1 {
                result = self.multiply(result, base);
            }
            base = self.multiply(base, base);
            exponent >>= 1;
        }
        result
    }

    /// A square root, the smaller of the two; `None` if there is none. (Tonelli and Shanks; H. Cohen, *A Course in
    /// Computational Algebraic Number Theory* (1993), algorithm 1.5.1.)
    pub fn sqrt(self, a: u64) -> Option<u64> {
        let p = self.prime();
        let is_square = |x: u64| self.power(x, (p - 1) / 2) == 1;
        if a == 0 || !is_square(a) {
            return (a == 0).then_some(0);
        }
        // p - 1 = 2^e q, q odd.
        let e = (p - 1).trailing_zeros();
        let q = (p - 1) >> e;
        let (mut root, mut rest) = (self.power(a, q.div_ceil(2)), self.power(a, q));
        // root² = a rest, and rest has an order 2^m with m < e: roots of order 2^e reduce it step by step.
        let mut turn = (2..p).find(|&x| !is_square(x)).map(|x| self.power(x, q))?;
        let mut order = e;
        while rest != 1 {
            let m = (1..order).find(|&m| self.power(rest, 1 << m) == 1)?;
            let step = self.power(turn, 1 << (order - m - 1));
            (order, turn) = (m, self.multiply(step, step));
            (root, rest) = (self.multiply(root, step), self.multiply(rest, turn));
        }
        Some(root.min(p - root))
    }

    /// A fixed pseudo-random residue from 1 to p - 1 for each seed.
    pub fn random(self, seed: u64) -> u64 {
        scramble(seed) % (self.prime() - 1) + 1
    }
}

/// Scatters bits (the finaliser of SplitMix64, Steele, Lea and Flood 2014).
pub fn scramble(x: u64) -> u64 {
    let mut z = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_those_of_long_arithmetic() {
        for field in PRIMES {
            let p = u128::from(field.prime());
            for (i, j) in [(0, 1), (2, 3), (4, 5)] {
                let (a, b) = (field.random(i), field.random(j));
                assert_eq!(u128::from(field.multiply(a, b)), u128::from(a) * u128::from(b) % p);
            }
            let top = field.prime() - 1;
            assert_eq!(field.multiply(top, top), 1);
        }
    }

    #[test]
    fn further_primes_follow() {
        let list: Vec<Field> = primes().take(60).collect();
        assert_eq!(list[..PRIMES.len()], PRIMES);
        // Gaps as given by FLINT.
        let gaps: Vec<u64> = list[PRIMES.len()..PRIMES.len() + 4].iter().map(|field| field.c).collect();
        assert_eq!(gaps, [675, 759, 799, 819]);
        for field in primes().step_by(50).take(40) {
            let (a, p) = (field.random(3), u128::from(field.prime()));
            assert_eq!(u128::from(field.multiply(a, a)), u128::from(a) * u128::from(a) % p);
            assert_eq!(field.multiply(a, field.inverse(a)), 1);
        }
    }

    #[test]
    fn an_inverse_undoes_a_product() {
        for field in PRIMES {
            let a = field.random(7);
            assert_eq!(field.multiply(a, field.inverse(a)), 1);
        }
    }
}
