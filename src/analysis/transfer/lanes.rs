//! Several frequencies in parallel: real, complex and double-double numbers in the lanes of a vector, for the loops of
//! the two-sided method. The same source serves every vector width, and the results are the same for all of them,
//! because each operation follows IEEE 754, lane by lane.

use crate::base::Dd;
use std::ops::{Add, Mul, Neg, Sub};

/// Compiles a function, generic in the lanes' type, for each vector width of the processor, and calls the widest that
/// is available.
macro_rules! side_by_side {
    ($(#[$meta:meta])* $visibility:vis fn $name:ident<$lanes:ident>($($argument:ident: $type:ty),* $(,)?) $(-> $result:ty)? $body:block) => {
        $(#[$meta])*
        $visibility fn $name($($argument: $type),*) $(-> $result)? {
            #[inline(always)]
            fn plain<$lanes: $crate::analysis::transfer::lanes::Vector>($($argument: $type),*) $(-> $result)? $body

            #[cfg(target_arch = "x86_64")]
            {
                use $crate::analysis::transfer::lanes::x86;
                use std::arch::is_x86_feature_detected as has;
                #[target_feature(enable = "avx512f")]
                fn by_eight($($argument: $type),*) $(-> $result)? {
                    plain::<x86::Eight>($($argument),*)
                }
                #[target_feature(enable = "avx2,fma")]
                fn by_four($($argument: $type),*) $(-> $result)? {
                    plain::<x86::Four>($($argument),*)
                }
                if has!("avx512f") {
                    // SAFETY: the processor has these instructions.
                    return unsafe { by_eight($($argument),*) };
                }
                if has!("avx2") && has!("fma") {
                    // SAFETY: the processor has these instructions.
                    return unsafe { by_four($($argument),*) };
                }
            }
            plain::<f64>($($argument),*)
        }
    };
}

pub(in crate::analysis) use side_by_side;

/// A vector of binary64 numbers.
pub trait Vector: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self> {
    const WIDTH: usize;
    fn splat(x: f64) -> Self;
    /// Loads the first [`Vector::WIDTH`] numbers.
    fn load(x: &[f64; MOST]) -> Self;
    /// Stores into the first [`Vector::WIDTH`] numbers.
    fn store(self) -> [f64; MOST];
    /// self b + c with one rounding.
    fn fused(self, b: Self, c: Self) -> Self;
    fn over(self, b: Self) -> Self;
    fn abs(self) -> Self;
    fn sqrt(self) -> Self;
}

/// Lanes of the widest vector.
pub const MOST: usize = 16;

/// Two vectors as one: their latencies overlap.
#[derive(Clone, Copy, Debug)]
pub struct Twice<V>([V; 2]);

macro_rules! twice {
    ($trait:ident, $name:ident) => {
        impl<V: Vector> $trait for Twice<V> {
            type Output = Twice<V>;
            #[inline(always)]
            fn $name(self, b: Twice<V>) -> Twice<V> {
                Twice([self.0[0].$name(b.0[0]), self.0[1].$name(b.0[1])])
            }
        }
    };
}

twice!(Add, add);
twice!(Sub, sub);
twice!(Mul, mul);

impl<V: Vector> Neg for Twice<V> {
    type Output = Twice<V>;
    #[inline(always)]
    fn neg(self) -> Twice<V> {
        Twice([-self.0[0], -self.0[1]])
    }
}

impl<V: Vector> Vector for Twice<V> {
    const WIDTH: usize = 2 * V::WIDTH;

    #[inline(always)]
    fn splat(x: f64) -> Twice<V> {
        Twice([V::splat(x), V::splat(x)])
    }

    #[inline(always)]
    fn load(x: &[f64; MOST]) -> Twice<V> {
        let mut second = [0.0; MOST];
        second[..V::WIDTH].copy_from_slice(&x[V::WIDTH..2 * V::WIDTH]);
        Twice([V::load(x), V::load(&second)])
    }

    #[inline(always)]
    fn store(self) -> [f64; MOST] {
        let (mut x, second) = (self.0[0].store(), self.0[1].store());
        x[V::WIDTH..2 * V::WIDTH].copy_from_slice(&second[..V::WIDTH]);
        x
    }

    #[inline(always)]
    fn fused(self, b: Twice<V>, c: Twice<V>) -> Twice<V> {
        Twice([self.0[0].fused(b.0[0], c.0[0]), self.0[1].fused(b.0[1], c.0[1])])
    }

    #[inline(always)]
    fn over(self, b: Twice<V>) -> Twice<V> {
        Twice([self.0[0].over(b.0[0]), self.0[1].over(b.0[1])])
    }

    #[inline(always)]
    fn abs(self) -> Twice<V> {
        Twice([self.0[0].abs(), self.0[1].abs()])
    }

    #[inline(always)]
    fn sqrt(self) -> Twice<V> {
        Twice([self.0[0].sqrt(), self.0[1].sqrt()])
    }
}

impl Vector for f64 {
    const WIDTH: usize = 1;

    #[inline(always)]
    fn splat(x: f64) -> f64 {
        x
    }

    #[inline(always)]
    fn load(x: &[f64; MOST]) -> f64 {
        x[0]
    }

    #[inline(always)]
    fn store(self) -> [f64; MOST] {
        [self; MOST]
    }

    #[inline(always)]
    fn fused(self, b: f64, c: f64) -> f64 {
        self.mul_add(b, c)
    }

    #[inline(always)]
    fn over(self, b: f64) -> f64 {
        self / b
    }

    #[inline(always)]
    fn abs(self) -> f64 {
        f64::abs(self)
    }

    #[inline(always)]
    fn sqrt(self) -> f64 {
        f64::sqrt(self)
    }
}

/// The vectors of x86-64. They are used only inside functions that are compiled for their instructions, and these
/// functions are called only if the processor has them.
#[cfg(target_arch = "x86_64")]
pub mod x86 {
    use super::{MOST, Vector};
    use std::arch::x86_64::*;
    use std::ops::{Add, Mul, Neg, Sub};

    macro_rules! vector {
        ($name:ident, $inner:ty, $width:literal, $splat:ident, $load:ident, $store:ident, $add:ident, $sub:ident,
         $mul:ident, $div:ident, $fused:ident, $sqrt:ident, $abs:expr) => {
            #[derive(Clone, Copy, Debug)]
            pub struct $name($inner);

            // SAFETY, of every block below: see the module; the arrays are at least as long as the vector.
            impl Add for $name {
                type Output = $name;
                #[inline(always)]
                fn add(self, b: $name) -> $name {
                    $name(unsafe { $add(self.0, b.0) })
                }
            }

            impl Sub for $name {
                type Output = $name;
                #[inline(always)]
                fn sub(self, b: $name) -> $name {
                    $name(unsafe { $sub(self.0, b.0) })
                }
            }

            impl Mul for $name {
                type Output = $name;
                #[inline(always)]
                fn mul(self, b: $name) -> $name {
                    $name(unsafe { $mul(self.0, b.0) })
                }
            }

            impl Neg for $name {
                type Output = $name;
                #[inline(always)]
                fn neg(self) -> $name {
                    // -0 - x is -x, also for zeros.
                    $name(unsafe { $sub($splat(-0.0), self.0) })
                }
            }

            impl Vector for $name {
                const WIDTH: usize = $width;

                #[inline(always)]
                fn splat(x: f64) -> $name {
                    $name(unsafe { $splat(x) })
                }

                #[inline(always)]
                fn load(x: &[f64; MOST]) -> $name {
                    $name(unsafe { $load(x.as_ptr()) })
                }

                #[inline(always)]
                fn store(self) -> [f64; MOST] {
                    let mut x = [0.0; MOST];
                    unsafe { $store(x.as_mut_ptr(), self.0) };
                    x
                }

                #[inline(always)]
                fn fused(self, b: $name, c: $name) -> $name {
                    $name(unsafe { $fused(self.0, b.0, c.0) })
                }

                #[inline(always)]
                fn over(self, b: $name) -> $name {
                    $name(unsafe { $div(self.0, b.0) })
                }

                #[inline(always)]
                fn abs(self) -> $name {
                    $name(unsafe { $abs(self.0) })
                }

                #[inline(always)]
                fn sqrt(self) -> $name {
                    $name(unsafe { $sqrt(self.0) })
                }
            }
        };
    }

    vector!(
        Eight,
        __m512d,
        8,
        _mm512_set1_pd,
        _mm512_loadu_pd,
        _mm512_storeu_pd,
        _mm512_add_pd,
        _mm512_sub_pd,
        _mm512_mul_pd,
        _mm512_div_pd,
        _mm512_fmadd_pd,
        _mm512_sqrt_pd,
        |x| _mm512_abs_pd(x)
    );
    vector!(
        Four,
        __m256d,
        4,
        _mm256_set1_pd,
        _mm256_loadu_pd,
        _mm256_storeu_pd,
        _mm256_add_pd,
        _mm256_sub_pd,
        _mm256_mul_pd,
        _mm256_div_pd,
        _mm256_fmadd_pd,
        _mm256_sqrt_pd,
        |x| _mm256_andnot_pd(_mm256_set1_pd(-0.0), x)
    );
}

/// re + i im
#[derive(Clone, Copy, Debug)]
pub struct Pair<V> {
    pub re: V,
    pub im: V,
}

/// An unevaluated sum hi + lo; lo is a correction, and not always below half a unit in the last place of hi.
#[derive(Clone, Copy, Debug)]
pub struct Double<V> {
    pub hi: V,
    pub lo: V,
}

impl<V: Vector> Pair<V> {
    #[inline(always)]
    pub fn zero() -> Pair<V> {
        Pair { re: V::splat(0.0), im: V::splat(0.0) }
    }

    #[inline(always)]
    pub fn times(self, b: Pair<V>) -> Pair<V> {
        Pair { re: self.re.fused(b.re, -(self.im * b.im)), im: self.re.fused(b.im, self.im * b.re) }
    }

    /// self - a b
    #[inline(always)]
    pub fn minus_product(self, a: Pair<V>, b: Pair<V>) -> Pair<V> {
        Pair {
            re: a.im.fused(b.im, (-a.re).fused(b.re, self.re)),
            im: (-a.im).fused(b.re, (-a.re).fused(b.im, self.im)),
        }
    }

    /// self + a b
    #[inline(always)]
    pub fn plus_product(self, a: Pair<V>, b: Pair<V>) -> Pair<V> {
        Pair { re: (-a.im).fused(b.im, a.re.fused(b.re, self.re)), im: a.im.fused(b.re, a.re.fused(b.im, self.im)) }
    }

    #[inline(always)]
    pub fn recip(self) -> Pair<V> {
        let square = V::splat(1.0).over(self.re.fused(self.re, self.im * self.im));
        Pair { re: self.re * square, im: -(self.im * square) }
    }

    /// |re| + |im|, an upper bound of the modulus.
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

    /// self + x y, with the errors of both operations added to `lo`.
    #[inline(always)]
    pub fn plus_product(self, x: Double<V>, y: V) -> Double<V> {
        let p = x.hi * y;
        let e = x.hi.fused(y, -p);
        let (hi, lost) = two_sum(self.hi, p);
        Double { hi, lo: self.lo + (x.lo.fused(y, e) + lost) }
    }

    #[inline(always)]
    pub fn splat(x: Dd) -> Double<V> {
        Double { hi: V::splat(x.hi), lo: V::splat(x.lo) }
    }

    /// self + x y for normalised x and y, with the errors added to `lo`. After l of these from zero, followed by
    /// [`Double::normalised`], the sum is within (l + 3)^2 u^2 of the sum of |x y|, u = 2^-53: a product loses 6 u^2,
    /// `lo` stays below (l + 3) u of it and is rounded l times.
    #[inline(always)]
    pub fn plus_double(self, x: Double<V>, y: Double<V>) -> Double<V> {
        let p = x.hi * y.hi;
        let e = x.hi.fused(y.hi, -p);
        let e = x.lo.fused(y.hi, x.hi.fused(y.lo, e));
        let (hi, lost) = two_sum(self.hi, p);
        Double { hi, lo: self.lo + (e + lost) }
    }

    /// Normalises the number: |lo| below half a unit in the last place of hi.
    #[inline(always)]
    pub fn normalised(self) -> Double<V> {
        let (hi, lo) = two_sum(self.hi, self.lo);
        Double { hi, lo }
    }

    /// The sum, computed as in [`Dd`].
    #[inline(always)]
    pub fn plus(self, b: Double<V>) -> Double<V> {
        let (sh, sl) = two_sum(self.hi, b.hi);
        let (th, tl) = two_sum(self.lo, b.lo);
        let (vh, vl) = fast_two_sum(sh, sl + th);
        let (hi, lo) = fast_two_sum(vh, tl + vl);
        Double { hi, lo }
    }

    /// The product, computed as in [`Dd`].
    #[inline(always)]
    pub fn times(self, b: Double<V>) -> Double<V> {
        let ch = self.hi * b.hi;
        let cl = self.hi.fused(b.hi, -ch);
        let cl = cl + self.lo.fused(b.hi, self.hi * b.lo);
        let (hi, lo) = fast_two_sum(ch, cl);
        Double { hi, lo }
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
