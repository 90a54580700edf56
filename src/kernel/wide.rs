//! Eight binary64 numbers in parallel lanes, and the choice of the processor's widest instructions for a loop over
//! them.
//!
//! A kernel is written once over [`Eight`]. It is compiled for AVX-512 (one register), for AVX2 with fused multiply-add
//! (two) and for any processor (a loop). Every lane is rounded separately and lanes are summed in a fixed order, so the
//! results are the same on all of them.

/// Number of lanes of [`Eight`].
pub const LANES: usize = 8;

/// A vector of eight numbers.
pub trait Eight: Copy {
    /// Height, in [`Eight`]s, of the block that a product keeps in registers: there are 16, or 32 that hold an
    /// [`Eight`] each.
    const ROWS: usize;
    fn splat(x: f64) -> Self;
    fn load(x: &[f64]) -> Self;
    fn store(self, x: &mut [f64]);
    /// self + a b, rounded once.
    fn fused(self, a: Self, b: Self) -> Self;
    fn add(self, other: Self) -> Self;
    fn minus(self, other: Self) -> Self;
    fn times(self, other: Self) -> Self;
    fn over(self, other: Self) -> Self;

    /// The sum of the lanes, in a fixed order.
    #[inline(always)]
    fn sum(self) -> f64 {
        let mut x = [0.0; LANES];
        self.store(&mut x);
        ((x[0] + x[4]) + (x[2] + x[6])) + ((x[1] + x[5]) + (x[3] + x[7]))
    }
}

/// An array processed in a loop, for any processor.
#[derive(Clone, Copy)]
pub struct Plain([f64; LANES]);

impl Plain {
    #[inline(always)]
    fn zip(self, other: Plain, f: impl Fn(f64, f64) -> f64) -> Plain {
        Plain(std::array::from_fn(|i| f(self.0[i], other.0[i])))
    }
}

impl Eight for Plain {
    const ROWS: usize = 1;

    #[inline(always)]
    fn splat(x: f64) -> Plain {
        Plain([x; LANES])
    }

    #[inline(always)]
    fn load(x: &[f64]) -> Plain {
        Plain(std::array::from_fn(|i| x[i]))
    }

    #[inline(always)]
    fn store(self, x: &mut [f64]) {
        x[..LANES].copy_from_slice(&self.0);
    }

    #[inline(always)]
    fn fused(self, a: Plain, b: Plain) -> Plain {
        Plain(std::array::from_fn(|i| a.0[i].mul_add(b.0[i], self.0[i])))
    }

    #[inline(always)]
    fn add(self, other: Plain) -> Plain {
        self.zip(other, |x, y| x + y)
    }

    #[inline(always)]
    fn minus(self, other: Plain) -> Plain {
        self.zip(other, |x, y| x - y)
    }

    #[inline(always)]
    fn times(self, other: Plain) -> Plain {
        self.zip(other, |x, y| x * y)
    }

    #[inline(always)]
    fn over(self, other: Plain) -> Plain {
        self.zip(other, |x, y| x / y)
    }
}

#[cfg(target_arch = "x86_64")]
pub use x86::{Avx2, Avx512};

// SAFETY of the calls below: only `widest!` chooses these types, inside functions compiled for processors that have the
// instructions; loads and stores check the length of their slice first.
#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::{Eight, LANES};
    use std::arch::x86_64::*;

    /// One register.
    #[derive(Clone, Copy)]
    pub struct Avx512(__m512d);

    impl Eight for Avx512 {
        const ROWS: usize = 3;

        #[inline(always)]
        fn splat(x: f64) -> Avx512 {
            Avx512(unsafe { _mm512_set1_pd(x) })
        }

        #[inline(always)]
        fn load(x: &[f64]) -> Avx512 {
            assert!(x.len() >= LANES);
            Avx512(unsafe { _mm512_loadu_pd(x.as_ptr()) })
        }

        #[inline(always)]
        fn store(self, x: &mut [f64]) {
            assert!(x.len() >= LANES);
            unsafe { _mm512_storeu_pd(x.as_mut_ptr(), self.0) }
        }

        #[inline(always)]
        fn fused(self, a: Avx512, b: Avx512) -> Avx512 {
            Avx512(unsafe { _mm512_fmadd_pd(a.0, b.0, self.0) })
        }

        #[inline(always)]
        fn add(self, other: Avx512) -> Avx512 {
            Avx512(unsafe { _mm512_add_pd(self.0, other.0) })
        }

        #[inline(always)]
        fn minus(self, other: Avx512) -> Avx512 {
            Avx512(unsafe { _mm512_sub_pd(self.0, other.0) })
        }

        #[inline(always)]
        fn times(self, other: Avx512) -> Avx512 {
            Avx512(unsafe { _mm512_mul_pd(self.0, other.0) })
        }

        #[inline(always)]
        fn over(self, other: Avx512) -> Avx512 {
            Avx512(unsafe { _mm512_div_pd(self.0, other.0) })
        }
    }

    /// Two registers.
    #[derive(Clone, Copy)]
    pub struct Avx2(__m256d, __m256d);

    impl Eight for Avx2 {
        const ROWS: usize = 1;

        #[inline(always)]
        fn splat(x: f64) -> Avx2 {
            let x = unsafe { _mm256_set1_pd(x) };
            Avx2(x, x)
        }

        #[inline(always)]
        fn load(x: &[f64]) -> Avx2 {
            assert!(x.len() >= LANES);
            unsafe { Avx2(_mm256_loadu_pd(x.as_ptr()), _mm256_loadu_pd(x.as_ptr().add(4))) }
        }

        #[inline(always)]
        fn store(self, x: &mut [f64]) {
            assert!(x.len() >= LANES);
            unsafe {
                _mm256_storeu_pd(x.as_mut_ptr(), self.0);
                _mm256_storeu_pd(x.as_mut_ptr().add(4), self.1);
            }
        }

        #[inline(always)]
        fn fused(self, a: Avx2, b: Avx2) -> Avx2 {
            unsafe { Avx2(_mm256_fmadd_pd(a.0, b.0, self.0), _mm256_fmadd_pd(a.1, b.1, self.1)) }
        }

        #[inline(always)]
        fn add(self, other: Avx2) -> Avx2 {
            unsafe { Avx2(_mm256_add_pd(self.0, other.0), _mm256_add_pd(self.1, other.1)) }
        }

        #[inline(always)]
        fn minus(self, other: Avx2) -> Avx2 {
            unsafe { Avx2(_mm256_sub_pd(self.0, other.0), _mm256_sub_pd(self.1, other.1)) }
        }

        #[inline(always)]
        fn times(self, other: Avx2) -> Avx2 {
            unsafe { Avx2(_mm256_mul_pd(self.0, other.0), _mm256_mul_pd(self.1, other.1)) }
        }

        #[inline(always)]
        fn over(self, other: Avx2) -> Avx2 {
            unsafe { Avx2(_mm256_div_pd(self.0, other.0), _mm256_div_pd(self.1, other.1)) }
        }
    }
}

/// Defines a function `name(arguments)` that calls `kernel::<V>(arguments)` for the widest [`Eight`] V of the
/// processor.
macro_rules! widest {
    ($(#[$meta:meta])* $visibility:vis fn $name:ident($($argument:ident: $type:ty),* $(,)?) $(-> $result:ty)? = $kernel:ident) => {
        $(#[$meta])*
        #[allow(clippy::too_many_arguments)]
        $visibility fn $name($($argument: $type),*) $(-> $result)? {
            #[cfg(target_arch = "x86_64")]
            {
                use $crate::kernel::wide::{Avx2, Avx512};
                #[target_feature(enable = "avx512f")]
                #[allow(clippy::too_many_arguments)]
                fn with_avx512($($argument: $type),*) $(-> $result)? {
                    $kernel::<Avx512>($($argument),*)
                }
                #[target_feature(enable = "avx2,fma")]
                #[allow(clippy::too_many_arguments)]
                fn with_avx2($($argument: $type),*) $(-> $result)? {
                    $kernel::<Avx2>($($argument),*)
                }
                if std::arch::is_x86_feature_detected!("avx512f") {
                    // SAFETY: the processor has these instructions.
                    return unsafe { with_avx512($($argument),*) };
                }
                if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma") {
                    // SAFETY: the processor has these instructions.
                    return unsafe { with_avx2($($argument),*) };
                }
            }
            $kernel::<$crate::kernel::wide::Plain>($($argument),*)
        }
    };
}

pub(crate) use widest;
