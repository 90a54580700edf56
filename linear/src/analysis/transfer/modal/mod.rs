//! H as a sum over modes, for tables of many frequencies: H(i W) = sum_i (p . x_i)(x_i . b) / (k_i - W^2 + i W c_i) +
//! rest. In: a system whose damping is diagonal in its undamped modes, and these modes. Out: sums in binary64 or in
//! double-double, each with a proven bound. See docs/method/transfer.md.
//!
//! The modes X (mass-normalised) diagonalise M and K to double-double ([`ModalForm`]); X^T Q(s) X = D(s) + O(s) is computed
//! with balls, |O_ij| <= epsilon v_i v_j with
//! v_i^2 = W^2 + W c_i + k_i (Cauchy). Neumann's series gives |p^T (D + O)^-1 b - p^T D^-1 b| <= epsilon V sqrt(P B) / (1 - epsilon V)
//! with V = sum v_i^2 / |D_i|, P = sum p_i^2 / |D_i|, B = sum b_i^2 / |D_i|.

mod fractions;
mod lanes;

use crate::analysis::answer::{ModeKind, Modes, PRECISE};
use crate::analysis::modes::form::{
    ENOUGH, LEAST_EPSILON, ModalForm, columns_beside, damping_clearly_couples, kinds, least_stiffness, off_diagonal,
    sizes,
};
use crate::analysis::modes::structure::{is_rigid, null_space};
use crate::analysis::transfer::{Disc, Frequency, Gain};
use crate::base::{Ball, Dd, Number, Power, larger, up};
use crate::kernel::complex::Complex;
use crate::kernel::dense::Matrix;
use crate::system::{CoordinateId, LinearSystem};
use std::ops::RangeInclusive;

/// The modes of a system, diagonalised to double-double.
#[derive(Clone, Debug)]
pub struct ModalSum {
    pub(in crate::analysis) shapes: Matrix<Dd>,
    /// k_i, c_i and omega_i = sqrt k_i (0 where k_i < 0).
    pub(in crate::analysis) k: Vec<Dd>,
    pub(in crate::analysis) c: Vec<Dd>,
    omega: Vec<Dd>,
    pub(in crate::analysis) epsilon: f64,
    /// The parts of v_i^2 that do not depend on the frequency: k_i and c_i.
    pub(in crate::analysis) k_size: Vec<f64>,
    pub(in crate::analysis) c_size: Vec<f64>,
    pub(in crate::analysis) off: OffDiagonal,
    /// Whether each mode is a rigid motion: its frequency is zero exactly.
    rigid: Vec<bool>,
    /// Whether certainly no rigid motion is damped.
    is_undragged: bool,
    /// The damping ratio of every oscillation, where one is declared for all and nothing else damps.
    ratio: Option<Ball>,
}

/// Bounds of E_M, E_C and E_K, what X^T M X, X^T C X and X^T K X are beside 1, the c_i and the k_i: the norms of their columns.
#[derive(Clone, Debug)]
pub struct OffDiagonal {
    pub m: Vec<f64>,
    pub c: Vec<f64>,
    pub k: Vec<f64>,
}

/// One pair of input and output, prepared for summation.
#[derive(Clone, Debug)]
pub struct ModalPair {
    residues: Vec<Residues>,
    feed_through: [Ball; 3],
}

/// The products (p . x_i)(x_i . b) of one power of s.
#[derive(Clone, Debug)]
struct Residues {
    power: usize,
    products: Vec<Dd>,
    rounded: Vec<f64>,
    /// p_i^2, b_i^2, and the possible rounding error of a term, times |D_i|.
    p_square: Vec<f64>,
    b_square: Vec<f64>,
    slack: Vec<f64>,
    exact_slack: Vec<f64>,
}

const UP: f64 = up::THOUSANDS;
/// The errors above are relative: they hold if no product underflows. With frequencies, 1/s or rad/s, in this range,
/// D_i (a difference of their squares, down to a resonance met to 1e-32) and its square are well inside binary64 ...
const FREQUENCIES: RangeInclusive<f64> = 1e-25..=1e25;
/// ... and the underflow error of a quotient, at most 1e-318, is below this after a product with D_i and a sum over the
/// modes.
const UNDERFLOW: f64 = 1e-260;
/// More than the relative rounding errors of the handful of operations on the way to a lower bound.
const ROUNDED: f64 = 1e-14;

impl ModalSum {
    /// `None` if the modes do not diagonalise the damping, or some of them are missing.
    pub fn of(system: &LinearSystem, modes: &Modes) -> Option<ModalSum> {
        if damping_clearly_couples(system, modes) {
            return None;
        }
        let (form, damping) = ModalForm::with_damping(system, modes)?;
        let sum = ModalSum::of_form(form, &damping, &kinds(&modes.list))?;
        let ratio = system.c.damping_ratio().map(Number::to_ball);
        let is_undragged = sum.is_undragged || is_undragged(system, &sum.rigid);
        Some(ModalSum { is_undragged, ratio, ..sum })
    }

    /// `damping` is X^T C X.
    fn of_form(form: ModalForm, damping: &Matrix<Ball>, kinds: &[ModeKind]) -> Option<ModalSum> {
        let n = kinds.len();
        let c: Vec<Dd> = (0..n).map(|i| damping[(i, i)].mid).collect();
        let k = form.stiffnesses();
        let least = least_stiffness(kinds, &k);
        let most = c.iter().map(|c| c.hi.abs()).fold(0.0, f64::max);
        // If a mode is undamped, a small damping is counted instead.
        let (c_size, k_size) = (sizes(&c, 1e-10 * most), sizes(&k, least));
        let ones = vec![1.0; n];
        let epsilon = [(&form.m, &ones, true), (damping, &c_size, false), (&form.k, &k_size, false)]
            .into_iter()
            .map(|(gram, sizes, unit)| off_diagonal(gram, sizes, unit))
            .fold(LEAST_EPSILON, larger);
        // If the modes do not diagonalise the damping, epsilon is near one. Of many coordinates one step has been taken, and
        // where that is not enough (close frequencies, stiffnesses of many decades), other methods have better bounds.
        if epsilon.is_nan() || epsilon > if n > PRECISE { ENOUGH } else { 1e-8 } {
            return None;
        }
        let most_stiff = k.iter().map(|k| k.hi.abs()).fold(0.0, f64::max);
        let squares = |x: f64| FREQUENCIES.contains(&x.sqrt());
        let in_range =
            (least.is_infinite() || squares(least)) && (most_stiff == 0.0 || most_stiff.sqrt() <= *FREQUENCIES.end());
        if !in_range || most > *FREQUENCIES.end() {
            return None;
        }
        let omega = k.iter().map(|k| if k.hi > 0.0 { k.sqrt() } else { Dd::ZERO }).collect();
        let off = OffDiagonal {
            m: columns_beside(&form.m, true),
            c: columns_beside(damping, false),
            k: columns_beside(&form.k, false),
        };
        let rigid: Vec<bool> = kinds.iter().map(|kind| *kind == ModeKind::Rigid).collect();
        let is_undragged = !rigid.contains(&true);
        Some(ModalSum {
            shapes: form.shapes,
            k,
            c,
            omega,
            epsilon,
            k_size,
            c_size,
            off,
            rigid,
            is_undragged,
            ratio: None,
        })
    }

    /// Prepares an input and an output.
    pub fn pair(&self, system: &LinearSystem, input: usize, output: usize) -> ModalPair {
        let (b, p) = (&system.inputs[input].b, &system.outputs[output].p);
        let mut residues = Vec::new();
        for (i, p) in p.iter().enumerate().filter(|(_, p)| !p.is_empty()) {
            for (j, b) in b.iter().enumerate().filter(|(_, b)| !b.is_empty()) {
                residues.push(self.residues(i + j, &self.participation(p), &self.participation(b)));
            }
        }
        let feed_through = crate::analysis::transfer::feed_through(&system.outputs[output], input);
        ModalPair { residues, feed_through }
    }

    /// a . x_i for each mode.
    pub(in crate::analysis) fn participation(&self, a: &[(CoordinateId, Number)]) -> Vec<Ball> {
        let of = |mode: usize| {
            let column = self.shapes.column(mode);
            a.iter().fold(Ball::ZERO, |sum, (i, value)| sum + value.to_ball() * Ball::exact(column[i.index()]))
        };
        (0..self.k.len()).map(of).collect()
    }

    fn residues(&self, power: usize, p: &[Ball], b: &[Ball]) -> Residues {
        let n = p.len() as f64;
        let products: Vec<Ball> = p.iter().zip(b).map(|(&p, &b)| p * b).collect();
        // The square of a nonzero number must not underflow to zero.
        let square = |x: &Ball| if x.is_zero() { 0.0 } else { x.magnitude().power(2).max(f64::MIN_POSITIVE) };
        let slack = |unit: f64| -> Vec<f64> {
            // D_i and its reciprocal: a dozen rounding errors; the sum: one for each mode.
            products.iter().map(|c| ((n + 16.0) * unit * c.mid.hi.abs() + c.rad) * UP).collect()
        };
        Residues {
            power,
            rounded: products.iter().map(|c| c.mid.to_f64()).collect(),
            p_square: p.iter().map(square).collect(),
            b_square: b.iter().map(square).collect(),
            slack: slack(f64::EPSILON),
            exact_slack: slack(4.0 * Dd::EPSILON),
            products: products.iter().map(|c| c.mid).collect(),
        }
    }

    /// H in binary64 arithmetic, several frequencies at once: a few nanoseconds for each mode.
    pub fn fast(&self, pair: &ModalPair, frequencies: &[Frequency]) -> Vec<Gain> {
        let mut sums: Vec<Vec<lanes::Sum>> = Vec::with_capacity(pair.residues.len());
        for residues in &pair.residues {
            sums.push(lanes::sums(self, residues, frequencies));
        }
        let gain = |(i, frequency): (usize, &Frequency)| {
            let (mut total, mut radius) = (Complex::<Ball>::ZERO, 0.0);
            for (residues, sums) in pair.residues.iter().zip(&sums) {
                let (sum, error) = (sums[i].value, self.error_of(&sums[i]));
                let sum = Complex::new(Ball::from(sum.re), Ball::from(sum.im));
                total =
                    if residues.power == 0 { total + sum } else { total + times_power(frequency, residues.power, sum) };
                radius += error * size_of_power(frequency, residues.power);
            }
            self.finish(pair, frequency, total, radius)
        };
        frequencies.iter().enumerate().map(gain).collect()
    }

    /// The sum over modes in double-double.
    pub fn accurate(&self, pair: &ModalPair, frequency: &Frequency) -> Gain {
        let mut total = Complex::<Ball>::ZERO;
        let mut radius = 0.0;
        for residues in &pair.residues {
            let sum = self.sum(residues, frequency.omega.mid);
            total = total + times_power(frequency, residues.power, sum.0);
            radius += sum.1 * size_of_power(frequency, residues.power);
        }
        self.finish(pair, frequency, total, radius)
    }

    /// An upper bound of |H| on the circle about i omega with this radius, rad/s; infinite if there is no bound. The bound of
    /// the module above holds for every s, with |s| instead of W and lower bounds of |D_i| on the circle.
    pub fn most_on_circle(&self, pair: &ModalPair, omega: Dd, radius: f64) -> f64 {
        let (least_s, most_s) = (omega.hi * (1.0 - ROUNDED) - radius, (omega.hi + radius) * UP);
        if least_s.is_nan() || least_s < *FREQUENCIES.start() || most_s > *FREQUENCIES.end() {
            return f64::INFINITY;
        }
        // |s^2 + k_i|: the distances of the circle from i omega_i and -i omega_i; of a mode that no spring holds, |s|^2 - |k_i|.
        let undamped = |i: usize| {
            let own = self.omega[i];
            if own.hi > 0.0 {
                let between = (own - omega).abs().hi;
                let near = (between - radius).abs() - ROUNDED * (between + radius) - ROUNDED * ROUNDED * omega.hi;
                near.max(0.0) * (own.hi + least_s) * (1.0 - ROUNDED)
            } else {
                least_s * least_s * (1.0 - ROUNDED) - self.k[i].hi.abs() * UP
            }
        };
        let least = |i: usize| (undamped(i) - most_s * self.c[i].hi.abs() * UP) * (1.0 - ROUNDED);
        let inverse: Vec<f64> = (0..self.k.len()).map(|i| 1.0 / least(i).max(0.0)).collect();
        let sum =
            |of: &dyn Fn(usize) -> f64| inverse.iter().enumerate().map(|(i, inverse)| of(i) * inverse).sum::<f64>();
        let v = sum(&|i| most_s * most_s + most_s * self.c_size[i] + self.k_size[i]);
        let mut total = 0.0;
        for residues in &pair.residues {
            let terms = sum(&|i| (residues.rounded[i].abs() + residues.exact_slack[i]) * UP);
            let error = self.error(terms, v, sum(&|i| residues.p_square[i]), sum(&|i| residues.b_square[i]));
            total += error * most_s.power(residues.power as i32) * UP;
        }
        let feed_through = (pair.feed_through.iter().enumerate()).map(|(i, d)| d.magnitude() * most_s.power(i as i32));
        let most = (total + feed_through.sum::<f64>()) * UP;
        // A term that is zero over a bound that is zero.
        if most.is_nan() { f64::INFINITY } else { most }
    }

    fn finish(&self, pair: &ModalPair, frequency: &Frequency, total: Complex<Ball>, radius: f64) -> Gain {
        if !FREQUENCIES.contains(&frequency.omega.mid.hi) {
            return Gain::Unknown;
        }
        let d = &pair.feed_through;
        let value = if d.iter().all(Ball::is_zero) { total } else { total + frequency.polynomial(*d) };
        let radius = (value.radius() + radius) * UP;
        if radius.is_finite() { Gain::Finite(Disc { value: value.mid(), radius }) } else { Gain::Unknown }
    }

    fn error_of(&self, sum: &lanes::Sum) -> f64 {
        self.error(sum.rounding, sum.v, sum.p, sum.b)
    }

    /// sum c_i / D_i in double-double, with its error.
    fn sum(&self, residues: &Residues, w: Dd) -> (Complex<Ball>, f64) {
        let (mut re_sum, mut im_sum) = (Dd::ZERO, Dd::ZERO);
        let (mut rounding, mut v, mut p, mut b) = (0.0, 0.0, 0.0, 0.0);
        let w_square = w.hi * w.hi;
        for i in 0..self.k.len() {
            let re = if self.omega[i].hi > 0.0 { (self.omega[i] - w) * (self.omega[i] + w) } else { self.k[i] - w * w };
            let im = w * self.c[i];
            let scaled = residues.products[i] / (re * re + im * im);
            re_sum += scaled * re;
            im_sum -= scaled * im;
            let inverse = (re.hi.abs() + im.hi.abs()) / (re.hi * re.hi + im.hi * im.hi);
            rounding += residues.exact_slack[i] * inverse;
            v += (w_square + w.hi * self.c_size[i] + self.k_size[i]) * inverse;
            p += residues.p_square[i] * inverse;
            b += residues.b_square[i] * inverse;
        }
        let error = self.error(rounding, v, p, b);
        (Complex::new(Ball::exact(re_sum), Ball::exact(im_sum)), error)
    }

    fn error(&self, rounding: f64, v: f64, p: f64, b: f64) -> f64 {
        let contraction = self.epsilon * v * UP;
        // NaN (a pole hit exactly) fails the comparison too.
        if contraction < 0.5 {
            (rounding + contraction * p.sqrt() * b.sqrt() / (1.0 - contraction) + UNDERFLOW) * UP
        } else {
            f64::INFINITY
        }
    }
}

/// Whether all rigid motions are known exactly, and stretch no damper. Damping by one ratio for all modes leaves them out.
fn is_undragged(system: &LinearSystem, rigid: &[bool]) -> bool {
    let motions = null_space(&system.k, system.n()).vectors;
    let count = rigid.iter().filter(|rigid| **rigid).count();
    let by_ratio = system.c.damping_ratio().is_some();
    motions.len() == count && motions.iter().all(|motion| by_ratio || is_rigid(&system.c, motion))
}

/// (i W)^power z
fn times_power(frequency: &Frequency, power: usize, z: Complex<Ball>) -> Complex<Ball> {
    (0..power).fold(z, |z, _| Complex::new(-(frequency.omega * z.im), frequency.omega * z.re))
}

fn size_of_power(frequency: &Frequency, power: usize) -> f64 {
    frequency.omega.magnitude().power(power as i32) * UP
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::test_systems::{blank, push};
    use crate::analysis::{Transfer, modes};
    use crate::kernel::dense::dot;

    /// Compares a chain with proportional damping with the direct solution, at resonances and between them.
    #[test]
    fn the_sum_agrees_with_the_solution() {
        let n = 8;
        let mut system = blank(n);
        for i in 0..n {
            push(&mut system.m, "1", i, None);
            push(&mut system.k, "1000", i, i.checked_sub(1));
            push(&mut system.c, "0.3", i, i.checked_sub(1));
        }
        let modes = modes(&system).expect("modes");
        let sum = ModalSum::of(&system, &modes).expect("proportional");
        let transfer = Transfer::of(&system);
        let pair = sum.pair(&system, 0, 5);
        for f in ["0.93", "2", "5.5", "9"] {
            let frequency = Frequency::hertz(&Number::from(f));
            let truth = transfer.between(&frequency, &[0], &[5])[0][0].disc().expect("finite");
            let fast = sum.fast(&pair, std::slice::from_ref(&frequency))[0];
            for (gain, most) in [(fast, 1e-12), (sum.accurate(&pair, &frequency), 1e-24)] {
                let disc = gain.disc().expect("finite");
                let error = (disc.value - truth.value).to_f64().abs();
                assert!(error <= disc.radius + truth.radius, "{f}: {error:e} {:e}", disc.radius);
                assert!(disc.relative_error() < most, "{f}: {:e}", disc.relative_error());
            }
        }
    }

    /// A value does not depend on the frequencies beside it.
    #[test]
    fn many_sums_are_the_same_sums() {
        let mut system = blank(5);
        for i in 0..5 {
            push(&mut system.m, "1", i, None);
            push(&mut system.k, "1000", i, i.checked_sub(1));
            push(&mut system.c, "0.3", i, i.checked_sub(1));
        }
        let sum = ModalSum::of(&system, &modes(&system).expect("modes")).expect("proportional");
        let pair = sum.pair(&system, 0, 4);
        let frequencies: Vec<Frequency> = (0..13).map(|i| Frequency::hertz(&Number::from(i))).collect();
        let one_by_one = frequencies.chunks(1).flat_map(|one| sum.fast(&pair, one));
        assert_eq!(sum.fast(&pair, &frequencies), one_by_one.collect::<Vec<_>>());
    }

    #[test]
    fn damping_that_couples_modes_is_refused() {
        let mut system = blank(2);
        for i in 0..2 {
            push(&mut system.m, "1", i, None);
            push(&mut system.k, "1000", i, i.checked_sub(1));
        }
        push(&mut system.c, "1", 0, None);
        let modes = modes(&system).expect("modes");
        assert!(ModalSum::of(&system, &modes).is_none());
    }

    /// Columns become orthonormal with respect to M, whatever K is.
    #[test]
    fn newton_steps_normalise() {
        let mut system = blank(2);
        push(&mut system.m, "1", 0, None);
        push(&mut system.m, "4", 1, None);
        push(&mut system.k, "3", 0, None);
        push(&mut system.k, "5", 1, Some(0));
        let modes = modes(&system).expect("modes");
        let sum = ModalSum::of(&system, &modes).expect("undamped");
        let first = sum.shapes.column(0);
        let weighted = [first[0], first[1] * 4.0];
        assert!((dot(&weighted, first) - Dd::ONE).abs().to_f64() < 1e-29);
    }
}
