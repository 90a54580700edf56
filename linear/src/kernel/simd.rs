//! Several binary64 numbers in parallel lanes, and the choice of the processor's widest instructions for a loop over them.
//!
//! A loop is written once, over a type [`Vector`] (as many lanes as the processor's registers have) or [`Eight`] (eight lanes
//! on every processor), inside [`simd!`], which compiles it for AVX-512, for AVX2 with fused multiply-add, and for any
//! processor, and calls the widest that the processor has. Every operation is that of IEEE 754, lane by lane, and eight lanes
//! are summed in one order, so a loop gives the same bits on every processor as long as no lane depends on the width.
//!
//! This is the only file with `unsafe` code: the compiler refuses it elsewhere. It has two reasons.
//! * Calling a function that is compiled for more instructions than every processor has: only behind the test for these
//!   instructions, in one macro.
//! * Loads and stores through pointers: only after the length of the slice was checked, in one macro. The types that make them
//!   are named by `simd!` alone.
#![allow(unsafe_code)]

use std::ops::{Add, Div, Mul, Neg, Sub};

/// Binary64 numbers side by side.
pub trait Vector:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    const WIDTH: usize;
    fn splat(x: f64) -> Self;
    /// Loads the first [`Vector::WIDTH`] numbers.
    fn load(x: &[f64]) -> Self;
    /// Stores into the first [`Vector::WIDTH`] numbers.
    fn store(self, x: &mut [f64]);
    /// self b + c, rounded once.
    fn mul_add(self, b: Self, c: Self) -> Self;
    fn abs(self) -> Self;
    fn sqrt(self) -> Self;
    /// The larger one, lane by lane; b if either is NaN.
    fn max(self, b: Self) -> Self;
    /// A bit for each lane in which self is larger than b.
    fn exceeds(self, b: Self) -> u32;
    /// `yes` in the lanes in which self is larger than b, `no` in the others.
    fn if_exceeds(self, b: Self, yes: Self, no: Self) -> Self;

    /// The smaller one, lane by lane; b if either is NaN.
    #[inline(always)]
    fn min(self, b: Self) -> Self {
        -(-self).max(-b)
    }

    /// The lanes, followed by zeros.
    #[inline(always)]
    fn to_array(self) -> [f64; MOST] {
        let mut x = [0.0; MOST];
        self.store(&mut x);
        x
    }
}

/// The values at 0, 1, .. N - 1, like [`std::array::from_fn`], but always inlined: the loop of that function would be
/// compiled without the instructions that [`simd!`] chose.
#[inline(always)]
pub fn each<T: Copy, const N: usize>(value: impl Fn(usize) -> T) -> [T; N] {
    let mut all = [value(0); N];
    for (i, one) in all.iter_mut().enumerate().skip(1) {
        *one = value(i);
    }
    all
}

/// Lanes of the widest [`Vector`].
pub const MOST: usize = 16;

/// Lanes of an [`Eight`].
pub const LANES: usize = 8;

/// Eight lanes on every processor.
pub trait Eight: Vector {
    /// Height, in [`Eight`]s, of the block that a product keeps in registers: there are 16, or 32 that hold an [`Eight`] each.
    const ROWS: usize;

    /// The sum of the lanes, in a fixed order.
    #[inline(always)]
    fn sum(self) -> f64 {
        let x = self.to_array();
        ((x[0] + x[4]) + (x[2] + x[6])) + ((x[1] + x[5]) + (x[3] + x[7]))
    }
}

/// Functions whose loops are compiled for each kind of processor: `fn name<V: Vector>(..)`, `fn name<V: Eight>(..)`, or
/// `fn name(..)` for loops over [`crate::base::Dd`] that only want fused multiply-add as one instruction. The first and the last may
/// have a `const R: usize`. What the body calls
/// has to be `#[inline(always)]`, or it is compiled without these instructions.
#[macro_export]
macro_rules! simd {
    ($(#[$meta:meta])* $visibility:vis fn $name:ident<$v:ident: Vector $(, const $r:ident: usize)?>
     ($($argument:ident: $type:ty),* $(,)?) $(-> $result:ty)? $body:block) => {
        $(#[$meta])*
        #[allow(unsafe_code, clippy::too_many_arguments)]
        $visibility fn $name$(<const $r: usize>)?($($argument: $type),*) $(-> $result)? {
            #[inline(always)]
            fn with<$v: $crate::kernel::simd::Vector $(, const $r: usize)?>($($argument: $type),*) $(-> $result)? $body
            $crate::kernel::simd::dispatch! {
                [$(const $r)? ($($argument: $type),*) $(-> $result)?]
                f64, $crate::kernel::simd::x86::Four, $crate::kernel::simd::x86::Eight
            }
        }
    };
    ($(#[$meta:meta])* $visibility:vis fn $name:ident<$v:ident: Eight>($($argument:ident: $type:ty),* $(,)?)
     $(-> $result:ty)? $body:block) => {
        $(#[$meta])*
        #[allow(unsafe_code, clippy::too_many_arguments)]
        $visibility fn $name($($argument: $type),*) $(-> $result)? {
            #[inline(always)]
            fn with<$v: $crate::kernel::simd::Eight>($($argument: $type),*) $(-> $result)? $body
            $crate::kernel::simd::dispatch! {
                [($($argument: $type),*) $(-> $result)?]
                $crate::kernel::simd::Plain,
                $crate::kernel::simd::Twice<$crate::kernel::simd::x86::Four>,
                $crate::kernel::simd::x86::Eight
            }
        }
    };
    ($(#[$meta:meta])* $visibility:vis fn $name:ident$(<const $r:ident: usize>)?($($argument:ident: $type:ty),* $(,)?)
     $(-> $result:ty)? $body:block) => {
        $(#[$meta])*
        #[allow(unsafe_code)]
        $visibility fn $name$(<const $r: usize>)?($($argument: $type),*) $(-> $result)? {
            #[inline(always)]
            fn plain$(<const $r: usize>)?($($argument: $type),*) $(-> $result)? $body

            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx2,fma")]
                fn with_avx2$(<const $r: usize>)?($($argument: $type),*) $(-> $result)? {
                    plain($($argument),*)
                }
                if $crate::kernel::simd::has_avx2() {
                    // SAFETY: the processor has these instructions.
                    return unsafe { with_avx2($($argument),*) };
                }
            }
            plain($($argument),*)
        }
    };
}

/// The body of a function of [`simd!`]: calls `with` for the widest of these types for which the processor has
/// instructions.
#[macro_export]
macro_rules! dispatch {
    ([$(const $r:ident)? ($($argument:ident: $type:ty),*) $(-> $result:ty)?] $plain:ty, $avx2:ty, $avx512:ty) => {
        #[cfg(target_arch = "x86_64")]
        {
            #[target_feature(enable = "avx512f")]
            #[allow(clippy::too_many_arguments)]
            fn with_avx512$(<const $r: usize>)?($($argument: $type),*) $(-> $result)? {
                with::<$avx512 $(, $r)?>($($argument),*)
            }
            #[target_feature(enable = "avx2,fma")]
            #[allow(clippy::too_many_arguments)]
            fn with_avx2$(<const $r: usize>)?($($argument: $type),*) $(-> $result)? {
                with::<$avx2 $(, $r)?>($($argument),*)
            }
            if std::arch::is_x86_feature_detected!("avx512f") {
                // SAFETY: the processor has these instructions.
                return unsafe { with_avx512($($argument),*) };
            }
            if $crate::kernel::simd::has_avx2() {
                // SAFETY: the processor has these instructions.
                return unsafe { with_avx2($($argument),*) };
            }
        }
        with::<$plain $(, $r)?>($($argument),*)
    };
}

pub use {dispatch, simd};

/// Whether the processor has AVX2 and fused multiply-add.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
pub fn has_avx2() -> bool {
    std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma")
}

impl Vector for f64 {
    const WIDTH: usize = 1;

    #[inline(always)]
    fn splat(x: f64) -> f64 {
        x
    }

    #[inline(always)]
    fn load(x: &[f64]) -> f64 {
        x[0]
    }

    #[inline(always)]
    fn store(self, x: &mut [f64]) {
        x[0] = self;
    }

    #[inline(always)]
    fn mul_add(self, b: f64, c: f64) -> f64 {
        f64::mul_add(self, b, c)
    }

    #[inline(always)]
    fn abs(self) -> f64 {
        f64::abs(self)
    }

    #[inline(always)]
    fn sqrt(self) -> f64 {
        f64::sqrt(self)
    }

    #[inline(always)]
    fn max(self, b: f64) -> f64 {
        if self > b { self } else { b }
    }

    #[inline(always)]
    fn exceeds(self, b: f64) -> u32 {
        u32::from(self > b)
    }

    #[inline(always)]
    fn if_exceeds(self, b: f64, yes: f64, no: f64) -> f64 {
        if self > b { yes } else { no }
    }
}

/// N vectors as one: two registers of four lanes are eight lanes, and the latencies of two registers overlap.
#[derive(Clone, Copy, Debug)]
pub struct Several<V, const N: usize>([V; N]);

pub type Twice<V> = Several<V, 2>;

/// Eight lanes in a loop, for any processor.
pub type Plain = Several<f64, LANES>;

/// N results as [`Several`], from an expression in their index. A closure here, as [`each`] takes one, would be compiled
/// without the processor's instructions wherever its caller is too large to take it in: eight calls of `fma` for one of AVX-512.
macro_rules! several {
    ($start:expr, $i:ident => $value:expr) => {{
        let mut all = $start;
        let mut $i = 0;
        while $i < N {
            all[$i] = $value;
            $i += 1;
        }
        Several(all)
    }};
}

macro_rules! lane_by_lane {
    ($trait:ident, $name:ident) => {
        impl<V: Vector, const N: usize> $trait for Several<V, N> {
            type Output = Several<V, N>;
            #[inline(always)]
            fn $name(self, b: Several<V, N>) -> Several<V, N> {
                several!(self.0, i => self.0[i].$name(b.0[i]))
            }
        }
    };
}

lane_by_lane!(Add, add);
lane_by_lane!(Sub, sub);
lane_by_lane!(Mul, mul);
lane_by_lane!(Div, div);

impl<V: Vector, const N: usize> Neg for Several<V, N> {
    type Output = Several<V, N>;
    #[inline(always)]
    fn neg(self) -> Several<V, N> {
        several!(self.0, i => -self.0[i])
    }
}

impl<V: Vector, const N: usize> Vector for Several<V, N> {
    const WIDTH: usize = N * V::WIDTH;

    #[inline(always)]
    fn splat(x: f64) -> Several<V, N> {
        Several([V::splat(x); N])
    }

    #[inline(always)]
    fn load(x: &[f64]) -> Several<V, N> {
        let x = &x[..N * V::WIDTH];
        several!([V::load(x); N], i => V::load(&x[i * V::WIDTH..]))
    }

    #[inline(always)]
    fn store(self, x: &mut [f64]) {
        let x = &mut x[..N * V::WIDTH];
        for (i, v) in self.0.into_iter().enumerate() {
            v.store(&mut x[i * V::WIDTH..]);
        }
    }

    #[inline(always)]
    fn mul_add(self, b: Several<V, N>, c: Several<V, N>) -> Several<V, N> {
        several!(self.0, i => self.0[i].mul_add(b.0[i], c.0[i]))
    }

    #[inline(always)]
    fn abs(self) -> Several<V, N> {
        several!(self.0, i => self.0[i].abs())
    }

    #[inline(always)]
    fn sqrt(self) -> Several<V, N> {
        several!(self.0, i => self.0[i].sqrt())
    }

    #[inline(always)]
    fn max(self, b: Several<V, N>) -> Several<V, N> {
        several!(self.0, i => self.0[i].max(b.0[i]))
    }

    #[inline(always)]
    fn exceeds(self, b: Several<V, N>) -> u32 {
        let mut bits = 0;
        let mut i = 0;
        while i < N {
            bits |= self.0[i].exceeds(b.0[i]) << (i * V::WIDTH);
            i += 1;
        }
        bits
    }

    #[inline(always)]
    fn if_exceeds(self, b: Several<V, N>, yes: Several<V, N>, no: Several<V, N>) -> Several<V, N> {
        several!(yes.0, i => self.0[i].if_exceeds(b.0[i], yes.0[i], no.0[i]))
    }
}

impl Eight for Plain {
    const ROWS: usize = 1;
}

#[cfg(target_arch = "x86_64")]
impl Eight for Twice<x86::Four> {
    const ROWS: usize = 1;
}

#[cfg(target_arch = "x86_64")]
impl Eight for x86::Eight {
    const ROWS: usize = 3;
}

/// The registers of x86-64. Their values are made only inside functions that are compiled for their instructions, and
/// these functions are called only if the processor has the instructions: only [`simd!`] names the types.
#[cfg(target_arch = "x86_64")]
pub mod x86 {
    use super::Vector;
    use std::arch::x86_64::*;
    use std::ops::{Add, Div, Mul, Neg, Sub};

    macro_rules! operator {
        ($name:ident, $trait:ident, $method:ident, $instruction:ident) => {
            impl $trait for $name {
                type Output = $name;
                #[inline(always)]
                fn $method(self, b: $name) -> $name {
                    // SAFETY: the processor has the instruction, see the module.
                    $name(unsafe { $instruction(self.0, b.0) })
                }
            }
        };
    }

    macro_rules! vector {
        ($name:ident, $inner:ty, $width:literal, $splat:ident, $load:ident, $store:ident, $add:ident, $sub:ident,
         $mul:ident, $div:ident, $fused:ident, $sqrt:ident, $max:ident, $abs:expr, $exceeds:expr, $choose:expr) => {
            #[derive(Clone, Copy, Debug)]
            pub struct $name($inner);

            operator!($name, Add, add, $add);
            operator!($name, Sub, sub, $sub);
            operator!($name, Mul, mul, $mul);
            operator!($name, Div, div, $div);

            impl Neg for $name {
                type Output = $name;
                #[inline(always)]
                fn neg(self) -> $name {
                    // -0 - x is -x, zeros too.
                    // SAFETY: the processor has the instructions, see the module.
                    $name(unsafe { $sub($splat(-0.0), self.0) })
                }
            }

            impl Vector for $name {
                const WIDTH: usize = $width;

                #[inline(always)]
                fn splat(x: f64) -> $name {
                    // SAFETY: the processor has the instruction, see the module.
                    $name(unsafe { $splat(x) })
                }

                #[inline(always)]
                fn load(x: &[f64]) -> $name {
                    assert!(x.len() >= $width);
                    // SAFETY: the slice is long enough, the instruction wants no alignment, and the processor has it.
                    $name(unsafe { $load(x.as_ptr()) })
                }

                #[inline(always)]
                fn store(self, x: &mut [f64]) {
                    assert!(x.len() >= $width);
                    // SAFETY: the slice is long enough, the instruction wants no alignment, and the processor has it.
                    unsafe { $store(x.as_mut_ptr(), self.0) };
                }

                #[inline(always)]
                fn mul_add(self, b: $name, c: $name) -> $name {
                    // SAFETY: the processor has the instruction, see the module.
                    $name(unsafe { $fused(self.0, b.0, c.0) })
                }

                #[inline(always)]
                fn abs(self) -> $name {
                    // SAFETY: the processor has the instructions, see the module.
                    $name(unsafe { $abs(self.0) })
                }

                #[inline(always)]
                fn sqrt(self) -> $name {
                    // SAFETY: the processor has the instruction, see the module.
                    $name(unsafe { $sqrt(self.0) })
                }

                #[inline(always)]
                fn max(self, b: $name) -> $name {
                    // SAFETY: the processor has the instruction, see the module.
                    $name(unsafe { $max(self.0, b.0) })
                }

                #[inline(always)]
                fn exceeds(self, b: $name) -> u32 {
                    // SAFETY: the processor has the instructions, see the module.
                    unsafe { $exceeds(self.0, b.0) }
                }

                #[inline(always)]
                fn if_exceeds(self, b: $name, yes: $name, no: $name) -> $name {
                    // SAFETY: the processor has the instructions, see the module.
                    $name(unsafe { $choose(self.0, b.0, yes.0, no.0) })
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
        _mm512_max_pd,
        |x| _mm512_abs_pd(x),
        |a, b| u32::from(_mm512_cmp_pd_mask::<_CMP_GT_OQ>(a, b)),
        |a, b, yes, no| _mm512_mask_blend_pd(_mm512_cmp_pd_mask::<_CMP_GT_OQ>(a, b), no, yes)
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
        _mm256_max_pd,
        |x| _mm256_andnot_pd(_mm256_set1_pd(-0.0), x),
        |a, b| _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_GT_OQ>(a, b)) as u32,
        |a, b, yes, no| _mm256_blendv_pd(no, yes, _mm256_cmp_pd::<_CMP_GT_OQ>(a, b))
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    const NUMBERS: [f64; 8] = [1.5, -0.0, 3e-308, f64::INFINITY, -7.25, 1e300, 0.1, -1e-3];

    /// Every operation of V on the numbers, WIDTH at a time, the results one behind the other.
    #[inline(always)]
    fn all<V: Vector>(x: &[f64], y: &[f64]) -> Vec<u64> {
        let mut results = vec![0.0; 13 * x.len()];
        let (width, n) = (V::WIDTH, x.len());
        for at in (0..n).step_by(width) {
            let (a, b) = (V::load(&x[at..]), V::load(&y[at..]));
            let bits = a.exceeds(b);
            let larger: Vec<f64> = (0..width).map(|lane| f64::from(bits >> lane & 1)).collect();
            let list = [
                a + b,
                a - b,
                a * b,
                a / b,
                -a,
                a.mul_add(b, V::splat(0.3)),
                a.abs(),
                a.abs().sqrt(),
                V::splat(x[0]),
                a.max(b),
                (a / b).min(a),
                V::load(&larger),
                a.if_exceeds(b, a * b, b),
            ];
            for (k, result) in list.into_iter().enumerate() {
                result.store(&mut results[k * n + at..k * n + at + width]);
            }
        }
        // All NaNs count as equal.
        results.into_iter().map(|x| if x.is_nan() { u64::MAX } else { x.to_bits() }).collect()
    }

    /// Sixteen pairs of numbers, so that every width divides them.
    fn pairs() -> (Vec<f64>, Vec<f64>) {
        let x: Vec<f64> = NUMBERS.iter().chain(&NUMBERS).copied().collect();
        let y = (0..16).map(|i| x[(5 * i + 3) % 16] + f64::from(i < 8)).collect();
        (x, y)
    }

    simd! {
        fn by_vectors<V: Vector>(x: &[f64], y: &[f64]) -> Vec<u64> {
            all::<V>(x, y)
        }
    }

    simd! {
        fn by_pairs_of_vectors<V: Vector>(x: &[f64], y: &[f64]) -> Vec<u64> {
            all::<Twice<V>>(x, y)
        }
    }

    simd! {
        fn by_eight<V: Eight>(x: &[f64], y: &[f64]) -> (Vec<u64>, f64) {
            (all::<V>(x, y), V::load(y).sum())
        }
    }

    simd! {
        fn fused_sum(x: f64, y: f64) -> f64 {
            x.mul_add(x, y)
        }
    }

    #[test]
    fn every_processor_finds_the_same_bits() {
        let (x, y) = pairs();
        let expected = all::<f64>(&x, &y);
        assert_eq!(by_vectors(&x, &y), expected);
        assert_eq!(by_pairs_of_vectors(&x, &y), expected);
        assert_eq!(all::<Plain>(&x, &y), expected);
        assert_eq!(by_eight(&x, &y).0, expected);
        let small: Vec<f64> = (1..=8).map(|i| 1.0 / f64::from(i)).collect();
        assert_eq!(by_eight(&small, &small).1.to_bits(), Plain::load(&small).sum().to_bits());
        // (1 + 2^-30)^2 - 1 = 2^-29 + 2^-60, which two roundings lose.
        assert_eq!(fused_sum(1.0 + 2f64.powi(-30), -1.0), 2f64.powi(-29) + 2f64.powi(-60));
    }

    /// The narrower registers of this processor too.
    #[cfg(target_arch = "x86_64")]
    #[test]
    fn registers_of_four_numbers_find_the_same_bits() {
        #[target_feature(enable = "avx2,fma")]
        fn by_four(x: &[f64], y: &[f64]) -> [Vec<u64>; 2] {
            [all::<x86::Four>(x, y), all::<Twice<x86::Four>>(x, y)]
        }
        let (x, y) = pairs();
        if has_avx2() {
            // SAFETY: the processor has these instructions.
            assert_eq!(unsafe { by_four(&x, &y) }, [all::<f64>(&x, &y), all::<f64>(&x, &y)]);
        }
    }

    simd! {
        fn load_sum<V: Eight>(x: &[f64]) -> f64 {
            V::load(x).sum()
        }
    }

    simd! {
        fn store_all<V: Eight>(x: &mut [f64]) {
            V::splat(1.0).store(x);
        }
    }

    // Separate allocations, so that a sanitizer detects accesses beyond them.

    #[test]
    #[should_panic]
    fn nothing_is_read_beyond_a_slice() {
        let x: Box<[f64]> = Box::new([0.0; 7]);
        load_sum(&x);
    }

    #[test]
    #[should_panic]
    fn nothing_is_written_beyond_a_slice() {
        let mut x: Box<[f64]> = Box::new([0.0; 7]);
        store_all(&mut x);
    }

    #[test]
    fn the_last_lane_is_read_and_written() {
        let mut x = [0.0; 9];
        store_all(&mut x[..8]);
        assert_eq!((x[7], x[8], load_sum(&x[..8])), (1.0, 0.0, 8.0));
    }
}
