//! The sums over poles of [`PartialFractions`](super::PartialFractions) at a frequency, and those of its Taylor polynomials,
//! eight poles side by side. In: the terms. Out: sums and what their bounds consist of.

use super::{DEGREE, MOST_BLUR, Term};
use crate::base::{Dd, up};
use crate::kernel::complex::Complex;
use crate::kernel::lanes::{Double, Lanes, Pair, two_sum};
use crate::kernel::simd::{Eight, LANES, Vector, each, simd};

/// The terms in lanes. The last ones are padded with [poles of no residue](Term::FAR).
#[derive(Clone, Debug)]
pub struct Lined {
    re: Lanes,
    im: Lanes,
    r_re: Lanes,
    r_im: Lanes,
    size: Vec<f64>,
    doubt: Vec<f64>,
    loose: Vec<f64>,
    /// By power of s; empty if there is no rest.
    rest: Vec<Vec<f64>>,
}

/// rad/s; its square is a number.
const FAR: f64 = 1e140;

/// Sums over all terms at a frequency.
pub struct Sums {
    /// sum r / d and sum r / d^2, d = i omega - s_j
    pub first: Complex<Dd>,
    pub second: Complex<Dd>,
    /// The two sums with |r|, and with the errors of r, in place of r.
    pub sizes: [f64; 2],
    pub doubts: [f64; 2],
    /// sum q_m / |d|
    pub rests: [f64; 5],
}

/// Sums over all terms of a Taylor polynomial.
pub struct TaylorSums {
    pub coefficients: [Complex<Dd>; DEGREE + 1],
    /// Bounds of H and of its derivatives, term by term, to which rounding errors are relative.
    pub sizes: [f64; 3],
    pub doubts: [f64; 3],
    /// Bounds of the terms after the polynomial.
    pub cut: [f64; 3],
    pub rests: [f64; 5],
}

impl Term {
    /// A pole of no residue, so far away that it changes nothing.
    pub const FAR: Term = Term {
        s: Complex { re: Dd { hi: -FAR, lo: 0.0 }, im: Dd::ZERO },
        r: Complex::ZERO,
        size: 0.0,
        doubt: 0.0,
        loose: 0.0,
        rest: [0.0; 5],
    };
}

impl Lined {
    pub fn of(terms: &[Term]) -> Lined {
        let room = terms.len().next_multiple_of(LANES);
        let (lanes, plain) = (|| Lanes::zeros(room), || vec![0.0; room]);
        let has_rest = terms.iter().any(|term| term.rest != [0.0; 5]);
        let mut lined = Lined {
            re: lanes(),
            im: lanes(),
            r_re: lanes(),
            r_im: lanes(),
            size: plain(),
            doubt: plain(),
            loose: plain(),
            rest: if has_rest { (0..5).map(|_| plain()).collect() } else { Vec::new() },
        };
        (0..room).for_each(|i| lined.set(i, terms.get(i).unwrap_or(&Term::FAR)));
        lined
    }

    pub fn set(&mut self, i: usize, term: &Term) {
        self.re.set(i, term.s.re);
        self.im.set(i, term.s.im);
        self.r_re.set(i, term.r.re);
        self.r_im.set(i, term.r.im);
        (self.size[i], self.doubt[i], self.loose[i]) = (term.size, term.doubt, term.loose);
        self.rest.iter_mut().zip(term.rest).for_each(|(rest, q)| rest[i] = q);
    }

    pub fn has_rest(&self) -> bool {
        !self.rest.is_empty()
    }

    /// i omega - s in binary64, to a few roundings: both are subtracted in double-double.
    #[inline(always)]
    fn offset<V: Vector>(&self, i: usize, omega: Dd) -> Pair<V> {
        Pair { re: -V::load(&self.re.hi[i..]), im: Double::splat(omega).plus(-self.im.at::<V>(i)).hi }
    }

    /// A bound of the error of r where 1 / |d| is `near`, that of the pole's place included: with a true distance d (1 + e),
    /// |e| <= b, each coefficient of the Taylor series of r / d is off by at most (k + 1) b / (1 - b)^(k + 2) of it, which is
    /// less than 8 b times the series where these sums are taken.
    #[inline(always)]
    fn doubt<V: Vector>(&self, i: usize, near: V) -> V {
        let blur = V::load(&self.loose[i..]) * near;
        let doubt = V::load(&self.doubt[i..]) + V::splat(8.0) * V::load(&self.size[i..]) * blur;
        V::splat(MOST_BLUR).if_exceeds(blur, doubt, V::splat(f64::INFINITY))
    }

    /// Adds sum q_m / |d| of the terms from i on.
    #[inline(always)]
    fn add_rests<V: Vector>(&self, i: usize, near: V, sums: &mut [V; 5]) {
        for (sum, q) in sums.iter_mut().zip(&self.rest) {
            *sum = *sum + V::load(&q[i..]) * near;
        }
    }
}

simd! {
    /// The term with the least distance from i omega, and the squares of that and of the second least.
    pub fn nearest<V: Eight>(terms: &Lined, omega: Dd) -> (usize, [f64; 2]) {
        let (mut index, mut squares, mut second) = (0, [f64::INFINITY; 2], V::splat(f64::INFINITY));
        for i in (0..terms.size.len()).step_by(LANES) {
            let d = terms.offset::<V>(i, omega);
            let square = d.re * d.re + d.im * d.im;
            if second.exceeds(square) == 0 {
                continue;
            }
            for (lane, &square) in square.to_array()[..LANES].iter().enumerate() {
                if square < squares[0] {
                    (index, squares) = (i + lane, [square, squares[0]]);
                } else if square < squares[1] {
                    squares[1] = square;
                }
            }
            second = V::splat(squares[1]);
        }
        (index, squares)
    }
}

simd! {
    pub fn sums<V: Eight>(terms: &Lined, omega: Dd) -> Sums {
        let (zero, none) = (V::splat(0.0), Double::<V>::zero());
        let (mut first, mut second) = ([none; 2], [none; 2]);
        let (mut sizes, mut doubts, mut rests) = ([zero; 2], [zero; 2], [zero; 5]);
        for i in (0..terms.size.len()).step_by(LANES) {
            let d = [-terms.re.at::<V>(i), Double::splat(omega).plus(-terms.im.at::<V>(i))];
            let inverse = inverse(d);
            let quotient = times([terms.r_re.at(i), terms.r_im.at(i)], inverse);
            let square = times(quotient, inverse);
            for part in 0..2 {
                first[part] = first[part].plus(quotient[part]);
                second[part] = second[part].plus(square[part]);
            }
            let [re, im] = d.map(|x| x.hi);
            let near = V::splat(1.0) / (re * re + im * im).sqrt();
            let (size, doubt) = (V::load(&terms.size[i..]) * near, terms.doubt(i, near) * near);
            sizes = [sizes[0] + size, sizes[1] + size * near];
            doubts = [doubts[0] + doubt, doubts[1] + doubt * near];
            terms.add_rests(i, near, &mut rests);
        }
        let all = |z: [Double<V>; 2]| Complex::new(total(z[0]), total(z[1]));
        Sums {
            first: all(first),
            second: all(second),
            sizes: sizes.map(V::sum),
            doubts: doubts.map(V::sum),
            rests: rests.map(V::sum),
        }
    }
}

simd! {
    /// H and dH/domega in binary64.
    pub fn near_sums<V: Eight>(terms: &Lined, omega: Dd) -> [Complex<f64>; 2] {
        let (mut first, mut second) = (Pair::<V>::zero(), Pair::<V>::zero());
        for i in (0..terms.size.len()).step_by(LANES) {
            let inverse = terms.offset::<V>(i, omega).recip();
            let quotient = Pair { re: V::load(&terms.r_re.hi[i..]), im: V::load(&terms.r_im.hi[i..]) }.times(inverse);
            first = Pair { re: first.re + quotient.re, im: first.im + quotient.im };
            second = second.plus_product(quotient, inverse);
        }
        [Complex::new(first.re.sum(), first.im.sum()), Complex::new(second.im.sum(), -second.re.sum())]
    }
}

pub fn taylor(terms: &Lined, middle: Dd, half: f64, precise: bool) -> TaylorSums {
    let mut sums = bounds(terms, middle, half);
    sums.coefficients =
        if precise { precise_coefficients(terms, middle, half) } else { coefficients(terms, middle, half) };
    sums
}

simd! {
    /// With x = r / d and q = -i half / d the coefficients are sums of x q^k. For |q| <= 1/2,
    /// sum over k > K of |q|^k, k |q|^k, k (k - 1) |q|^k is at most |q|^(K + 1) times 1 / (1 - |q|), (K + 1) / (1 - |q|)^2 and
    /// 2 K (K + 1) / (1 - |q|)^3.
    fn bounds<V: Eight>(terms: &Lined, middle: Dd, half: f64) -> TaylorSums {
        let (zero, one, k) = (V::splat(0.0), V::splat(1.0), DEGREE as f64);
        let (mut sizes, mut doubts, mut cut, mut rests) = ([zero; 3], [zero; 3], [zero; 3], [zero; 5]);
        for i in (0..terms.size.len()).step_by(LANES) {
            let d = terms.offset::<V>(i, middle);
            let near = one / (d.re * d.re + d.im * d.im).sqrt();
            let q = V::splat(half * up::DOZENS) * near;
            let sum = one / (one - q);
            let (square, cube) = (sum * sum, sum * sum * sum);
            let (x, doubt) = (V::load(&terms.size[i..]) * near, terms.doubt(i, near) * near);
            let omitted = x * (0..=DEGREE).fold(one, |power, _| power * q);
            let weights = [sum, q * square, V::splat(2.0) * q * q * cube];
            let tails = [sum, V::splat(k + 1.0) * square, V::splat(2.0 * k * (k + 1.0)) * cube];
            for l in 0..3 {
                sizes[l] = sizes[l] + x * weights[l];
                doubts[l] = doubts[l] + doubt * weights[l];
                cut[l] = cut[l] + omitted * tails[l];
            }
            terms.add_rests(i, near, &mut rests);
        }
        TaylorSums {
            coefficients: [Complex::ZERO; DEGREE + 1],
            sizes: sizes.map(V::sum),
            doubts: doubts.map(V::sum),
            cut: cut.map(V::sum),
            rests: rests.map(V::sum),
        }
    }
}

simd! {
    fn coefficients<V: Eight>(terms: &Lined, middle: Dd, half: f64) -> [Complex<Dd>; DEGREE + 1] {
        let mut all = [Pair::<V>::zero(); DEGREE + 1];
        for i in (0..terms.size.len()).step_by(LANES) {
            let inverse = terms.offset::<V>(i, middle).recip();
            let mut x = Pair { re: V::load(&terms.r_re.hi[i..]), im: V::load(&terms.r_im.hi[i..]) }.times(inverse);
            // -i half / d
            let q = Pair { re: V::splat(half) * inverse.im, im: -(V::splat(half) * inverse.re) };
            for sum in &mut all {
                *sum = Pair { re: sum.re + x.re, im: sum.im + x.im };
                x = x.times(q);
            }
        }
        each(|k| Complex::new(all[k].re.sum(), all[k].im.sum()).into())
    }
}

simd! {
    fn precise_coefficients<V: Eight>(terms: &Lined, middle: Dd, half: f64) -> [Complex<Dd>; DEGREE + 1] {
        let mut all = [[Double::<V>::zero(); 2]; DEGREE + 1];
        let half = Double::<V>::splat(Dd::from(half));
        for i in (0..terms.size.len()).step_by(LANES) {
            let inverse = inverse([-terms.re.at::<V>(i), Double::splat(middle).plus(-terms.im.at::<V>(i))]);
            let mut x = times([terms.r_re.at(i), terms.r_im.at(i)], inverse);
            let q = [half.times(inverse[1]), -half.times(inverse[0])];
            for sum in &mut all {
                *sum = [sum[0].plus(x[0]), sum[1].plus(x[1])];
                x = times(x, q);
            }
        }
        each(|k| Complex::new(total(all[k][0]), total(all[k][1])))
    }
}

/// a b
#[inline(always)]
fn times<V: Vector>(a: [Double<V>; 2], b: [Double<V>; 2]) -> [Double<V>; 2] {
    [a[0].times(b[0]).plus(-a[1].times(b[1])), a[0].times(b[1]).plus(a[1].times(b[0]))]
}

/// 1 / d: with y the quotient in binary64, y + y (1 - |d|^2 y) is within 16 u^2 of 1 / |d|^2, u = 2^-53.
#[inline(always)]
fn inverse<V: Vector>(d: [Double<V>; 2]) -> [Double<V>; 2] {
    let square = d[0].times(d[0]).plus(d[1].times(d[1]));
    let y = V::splat(1.0) / square.hi;
    let rest = (-square.lo).mul_add(y, (-square.hi).mul_add(y, V::splat(1.0)));
    let (hi, lo) = two_sum(y, y * rest);
    let scale = Double { hi, lo };
    [d[0].times(scale), -d[1].times(scale)]
}

/// The sum of the lanes.
#[inline(always)]
fn total<V: Eight>(x: Double<V>) -> Dd {
    let (hi, lo) = (x.hi.to_array(), x.lo.to_array());
    (0..LANES).fold(Dd::ZERO, |sum, i| sum + Dd { hi: hi[i], lo: lo[i] })
}
