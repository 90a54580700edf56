//! The sum over modes in binary64, at several frequencies at once: sum c_i / D_i, and the sums that its bound consists
//! of.

use super::{ModalSum, Residues};
use crate::analysis::transfer::Frequency;
use crate::base::Dd;
use crate::kernel::complex::Complex;
use crate::kernel::simd::{MOST, Vector, each, simd};

/// A sum over modes, and the sums of its bound (see the module above).
#[derive(Clone, Copy, Debug)]
pub struct Sum {
    pub value: Complex<f64>,
    pub rounding: f64,
    pub v: f64,
    pub p: f64,
    pub b: f64,
}

simd! {
    /// At many frequencies.
    pub fn sums<V: Vector>(modes: &ModalSum, residues: &Residues, frequencies: &[Frequency]) -> Vec<Sum> {
        let mut sums = Vec::with_capacity(frequencies.len());
        for chunk in frequencies.chunks(V::WIDTH) {
            let w: [Dd; MOST] = each(|i| chunk[i.min(chunk.len() - 1)].omega.mid);
            let lanes = sum::<V>(modes, residues, &w);
            sums.extend((0..chunk.len()).map(|i| lanes.at(i)));
        }
        sums
    }
}

/// The sums at several frequencies, one in each lane.
struct LaneSums {
    re: [f64; MOST],
    im: [f64; MOST],
    rounding: [f64; MOST],
    v: [f64; MOST],
    p: [f64; MOST],
    b: [f64; MOST],
}

impl LaneSums {
    #[inline(always)]
    fn at(&self, i: usize) -> Sum {
        let value = Complex::new(self.re[i], self.im[i]);
        Sum { value, rounding: self.rounding[i], v: self.v[i], p: self.p[i], b: self.b[i] }
    }
}

#[inline(always)]
fn sum<V: Vector>(modes: &ModalSum, residues: &Residues, w: &[Dd; MOST]) -> LaneSums {
    let n = modes.k.len();
    // Slices of equal length, so that the loop below needs no bounds checks.
    let (k, omega, c) = (&modes.k[..n], &modes.omega[..n], &modes.c[..n]);
    let (k_size, c_size) = (&modes.k_size[..n], &modes.c_size[..n]);
    let (products, slack) = (&residues.rounded[..n], &residues.slack[..n]);
    let (p_square, b_square) = (&residues.p_square[..n], &residues.b_square[..n]);
    let (w_hi, w_lo) = (V::load(&each::<f64, MOST>(|l| w[l].hi)), V::load(&each::<f64, MOST>(|l| w[l].lo)));
    let zero = V::splat(0.0);
    let (mut re_sum, mut im_sum, mut rounding) = (zero, zero, zero);
    let (mut v, mut p, mut b) = (zero, zero, zero);
    let w_square = w_hi * w_hi;
    for i in 0..n {
        // (omega - W)(omega + W): the difference of the leading parts is exact where it matters.
        let re = if omega[i].hi > 0.0 {
            let own = V::splat(omega[i].hi);
            (own - w_hi + (V::splat(omega[i].lo) - w_lo)) * (own + w_hi)
        } else {
            V::splat(k[i].hi) - w_square
        };
        let im = w_hi * V::splat(c[i].hi);
        let reciprocal = V::splat(1.0) / (re * re + im * im);
        let scaled = V::splat(products[i]) * reciprocal;
        re_sum = re_sum + scaled * re;
        im_sum = im_sum - scaled * im;
        // An upper bound of 1 / |D_i|.
        let inverse = reciprocal * (re.abs() + im.abs());
        rounding = rounding + V::splat(slack[i]) * inverse;
        v = v + (w_square + w_hi * V::splat(c_size[i]) + V::splat(k_size[i])) * inverse;
        p = p + V::splat(p_square[i]) * inverse;
        b = b + V::splat(b_square[i]) * inverse;
    }
    LaneSums {
        re: re_sum.to_array(),
        im: im_sum.to_array(),
        rounding: rounding.to_array(),
        v: v.to_array(),
        p: p.to_array(),
        b: b.to_array(),
    }
}
