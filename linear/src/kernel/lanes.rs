//! Complex and double-double numbers side by side, in the lanes of a [`Vector`]: for loops over frequencies, oscillators, times
//! or vectors. Each operation rounds lane by lane, so a lane holds the same bits on every processor.

use crate::base::Dd;
use crate::kernel::simd::{LANES, Vector};
use std::ops::Neg;

/// re + i im
#[derive(Clone, Copy, Debug)]
pub struct Pair<V> {
    pub re: V,
    pub im: V,
}

/// An unevaluated sum hi + lo; lo is a correction, not always below half a unit of hi.
#[derive(Clone, Copy, Debug)]
pub struct Double<V> {
    pub hi: V,
    pub lo: V,
}

/// Double-double numbers in parallel lanes, padded to whole vectors.
#[derive(Clone, Debug)]
pub struct Lanes {
    pub hi: Vec<f64>,
    pub lo: Vec<f64>,
}

impl<V: Vector> Pair<V> {
    #[inline(always)]
    pub fn zero() -> Pair<V> {
        Pair { re: V::splat(0.0), im: V::splat(0.0) }
    }

    #[inline(always)]
    pub fn times(self, b: Pair<V>) -> Pair<V> {
        Pair { re: self.re.mul_add(b.re, -(self.im * b.im)), im: self.re.mul_add(b.im, self.im * b.re) }
    }

    /// self - a b
    #[inline(always)]
    pub fn minus_product(self, a: Pair<V>, b: Pair<V>) -> Pair<V> {
        Pair {
            re: a.im.mul_add(b.im, (-a.re).mul_add(b.re, self.re)),
            im: (-a.im).mul_add(b.re, (-a.re).mul_add(b.im, self.im)),
        }
    }

    /// self + a b
    #[inline(always)]
    pub fn plus_product(self, a: Pair<V>, b: Pair<V>) -> Pair<V> {
        Pair {
            re: (-a.im).mul_add(b.im, a.re.mul_add(b.re, self.re)),
            im: a.im.mul_add(b.re, a.re.mul_add(b.im, self.im)),
        }
    }

    #[inline(always)]
    pub fn recip(self) -> Pair<V> {
        let square = V::splat(1.0) / self.re.mul_add(self.re, self.im * self.im);
        Pair { re: self.re * square, im: -(self.im * square) }
    }

    /// |re| + |im|, not below the modulus.
    #[inline(always)]
    pub fn size(self) -> V {
        self.re.abs() + self.im.abs()
    }
}

impl<V: Vector> Double<V> {
    #[inline(always)]
    pub fn zero() -> Double<V> {
        Double { hi: V::splat(0.0), lo: V::splat(0.0) }
    }

    /// self + x y for a normalised x, the errors of both operations kept in `lo`: after l of them from zero, and
    /// [`Double::normalise`], the sum is as close as after [`Double::plus_double`].
    #[inline(always)]
    pub fn plus_product(self, x: Double<V>, y: V) -> Double<V> {
        let p = x.hi * y;
        let e = x.hi.mul_add(y, -p);
        let (hi, lost) = two_sum(self.hi, p);
        Double { hi, lo: self.lo + (x.lo.mul_add(y, e) + lost) }
    }

    #[inline(always)]
    pub fn splat(x: Dd) -> Double<V> {
        Double { hi: V::splat(x.hi), lo: V::splat(x.lo) }
    }

    /// Loads the high words of a vector, followed by its low words.
    #[inline(always)]
    pub fn load(from: &[f64]) -> Double<V> {
        Double { hi: V::load(from), lo: V::load(&from[V::WIDTH..]) }
    }

    #[inline(always)]
    pub fn store(self, to: &mut [f64]) {
        self.hi.store(to);
        self.lo.store(&mut to[V::WIDTH..]);
    }

    /// x - y of binary64 numbers, without error.
    #[inline(always)]
    pub fn difference(x: V, y: V) -> Double<V> {
        let (hi, lo) = two_sum(x, -y);
        Double { hi, lo }
    }

    /// self + x y for normalised x and y, the errors kept in `lo`. After l of them from zero, and [`Double::normalise`], the
    /// sum is within (l + 3)^2 u^2 of the sum of |x y|, u = 2^-53: a product loses 6 u^2, `lo` stays below (l + 3) u of it
    /// and is rounded l times.
    #[inline(always)]
    pub fn plus_double(self, x: Double<V>, y: Double<V>) -> Double<V> {
        let p = x.hi * y.hi;
        let e = x.hi.mul_add(y.hi, -p);
        let e = x.lo.mul_add(y.hi, x.hi.mul_add(y.lo, e));
        let (hi, lost) = two_sum(self.hi, p);
        Double { hi, lo: self.lo + (e + lost) }
    }

    /// Normalises the number: |lo| below half a unit in the last place of hi.
    #[inline(always)]
    pub fn normalise(self) -> Double<V> {
        let (hi, lo) = two_sum(self.hi, self.lo);
        Double { hi, lo }
    }

    /// The sum as [`Dd`] has it.
    #[inline(always)]
    pub fn plus(self, b: Double<V>) -> Double<V> {
        let (sh, sl) = two_sum(self.hi, b.hi);
        let (th, tl) = two_sum(self.lo, b.lo);
        let (vh, vl) = fast_two_sum(sh, sl + th);
        let (hi, lo) = fast_two_sum(vh, tl + vl);
        Double { hi, lo }
    }

    /// The sum with an error of at most 10 u^2 (|self| + |b|), u = 2^-53: small relative to the sum only if nothing
    /// cancels.
    #[inline(always)]
    pub fn sloppy_plus(self, b: Double<V>) -> Double<V> {
        let (s, rest) = two_sum(self.hi, b.hi);
        let (hi, lo) = fast_two_sum(s, rest + (self.lo + b.lo));
        Double { hi, lo }
    }

    /// The product with an error of at most 6 u^2 |self b|, one operation cheaper than [`Double::times`].
    #[inline(always)]
    pub fn sloppy_times(self, b: Double<V>) -> Double<V> {
        let p = self.hi * b.hi;
        let rest = self.lo.mul_add(b.hi, self.hi.mul_add(b.hi, -p));
        let (hi, lo) = fast_two_sum(p, self.hi.mul_add(b.lo, rest));
        Double { hi, lo }
    }

    /// The product as [`Dd`] has it.
    #[inline(always)]
    pub fn times(self, b: Double<V>) -> Double<V> {
        let ch = self.hi * b.hi;
        let cl = self.hi.mul_add(b.hi, -ch);
        let cl = cl + self.lo.mul_add(b.hi, self.hi * b.lo);
        let (hi, lo) = fast_two_sum(ch, cl);
        Double { hi, lo }
    }
}

impl<V: Vector> Neg for Double<V> {
    type Output = Double<V>;
    #[inline(always)]
    fn neg(self) -> Double<V> {
        Double { hi: -self.hi, lo: -self.lo }
    }
}

impl Lanes {
    pub fn zeros(count: usize) -> Lanes {
        let room = count.next_multiple_of(LANES);
        Lanes { hi: vec![0.0; room], lo: vec![0.0; room] }
    }

    pub fn of(values: impl Iterator<Item = Dd>) -> Lanes {
        let (mut hi, mut lo): (Vec<f64>, Vec<f64>) = values.map(|x| (x.hi, x.lo)).unzip();
        let room = hi.len().next_multiple_of(LANES);
        hi.resize(room, 0.0);
        lo.resize(room, 0.0);
        Lanes { hi, lo }
    }

    pub fn get(&self, i: usize) -> Dd {
        Dd { hi: self.hi[i], lo: self.lo[i] }
    }

    pub fn set(&mut self, i: usize, x: Dd) {
        (self.hi[i], self.lo[i]) = (x.hi, x.lo);
    }

    /// The vector that begins at `i`.
    #[inline(always)]
    pub fn at<V: Vector>(&self, i: usize) -> Double<V> {
        Double { hi: V::load(&self.hi[i..]), lo: V::load(&self.lo[i..]) }
    }

    #[inline(always)]
    pub fn put<V: Vector>(&mut self, i: usize, x: Double<V>) {
        x.hi.store(&mut self.hi[i..]);
        x.lo.store(&mut self.lo[i..]);
    }
}

/// s + e = a + b exactly, for |a| >= |b| or a = 0 (Dekker).
#[inline(always)]
fn fast_two_sum<V: Vector>(a: V, b: V) -> (V, V) {
    let s = a + b;
    (s, b - (s - a))
}

/// s + e = a + b exactly (Knuth).
#[inline(always)]
pub fn two_sum<V: Vector>(a: V, b: V) -> (V, V) {
    let s = a + b;
    let bb = s - a;
    (s, (a - (s - bb)) + (b - bb))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::complex::Complex;

    const NUMBERS: [(f64, f64); 5] = [(1.0, 1e-17), (-3.7, 2e-16), (1e-200, 0.0), (0.1, -5e-18), (12345.678, 3e-13)];

    fn double((hi, lo): (f64, f64)) -> Double<f64> {
        Double { hi, lo }
    }

    fn dd(x: Double<f64>) -> Dd {
        Dd { hi: x.hi, lo: x.lo }
    }

    /// Lanes give the same value as single numbers; the cheaper operations stay within their bounds.
    #[test]
    fn double_words_are_those_of_one_number() {
        let unit_squared = 2f64.powi(-106);
        for x in NUMBERS.map(double) {
            for y in NUMBERS.map(double) {
                let (sum, product) = (dd(x) + dd(y), dd(x) * dd(y));
                assert_eq!((dd(x.plus(y)), dd(x.times(y))), (sum, product));
                let sum_error = (dd(x.sloppy_plus(y)) - sum).abs().hi;
                assert!(sum_error <= 13.0 * unit_squared * (x.hi.abs() + y.hi.abs()), "{x:?} {y:?}");
                let product_error = (dd(x.sloppy_times(y)) - product).abs().hi;
                assert!(product_error <= 11.0 * unit_squared * product.hi.abs(), "{x:?} {y:?}");
                let accumulated = dd(x.plus_double(y, y).normalise()) - (sum - dd(y) + dd(y) * dd(y));
                let size = x.hi.abs() + 2.0 * y.hi.abs() + y.hi * y.hi;
                assert!(accumulated.abs().hi <= 32.0 * unit_squared * size, "{x:?} {y:?}");
            }
        }
        assert_eq!(dd(Double::difference(1.0, 1e-17)), Dd { hi: 1.0, lo: -1e-17 });
        assert_eq!(dd(-double(NUMBERS[1])), Dd { hi: 3.7, lo: -2e-16 });
    }

    #[test]
    fn complex_numbers_are_those_of_one_number() {
        let (a, b, c) = (Complex::new(3.0, -4.0), Complex::new(0.5, 2.0), Complex::new(-1.0, 8.0));
        let pair = |z: Complex<f64>| Pair { re: z.re, im: z.im };
        let whole = |z: Pair<f64>| Complex::new(z.re, z.im);
        assert_eq!(whole(pair(a).times(pair(b))), a * b);
        assert_eq!(whole(pair(c).plus_product(pair(a), pair(b))), c + a * b);
        assert_eq!(whole(pair(c).minus_product(pair(a), pair(b))), c - a * b);
        assert!((whole(pair(a).recip()) - a.recip()).abs() <= 1e-16);
        assert_eq!(pair(a).size(), 7.0);
    }
}
