//! The modes of a system as a basis that diagonalises M and K to double-double. In: M, K and computed modes. Out: their
//! shapes, refined if they have fewer digits, and X^T M X and X^T K X as enclosures. Every computation that decomposes
//! the damping of a system by its modes starts here: transfer functions, motions, emitted code. See
//! docs/method/transfer.md.
//!
//! A step X <- X (I + Z) with the Z that makes X^T M X = I and X^T K X diagonal to second order squares the error (Ogita and
//! Aishima 2018): two steps turn 1e-16 into 1e-31. Shapes that come in double-double need none. Of many coordinates one step is
//! taken by products of matrices in binary64 ([`Basis`]).

use crate::analysis::answer::{Mode, ModeKind, Modes, PRECISE};
use crate::analysis::modes::dense::basis::Basis;
use crate::base::{Ball, Dd, Number, larger, up};
use crate::kernel::dense::{Matrix, add_scaled};
use crate::kernel::simd::simd;
use crate::kernel::squares::Squares;
use crate::system::LinearSystem;

/// The system in modal coordinates.
#[derive(Clone, Debug)]
pub(in crate::analysis) struct ModalForm {
    /// X, mass-normalised, one column a mode.
    pub shapes: Matrix<Dd>,
    /// X^T M X
    pub m: Matrix<Ball>,
    /// X^T K X
    pub k: Matrix<Ball>,
}

/// The most Newton steps: they turn 1e-16 into 1e-31.
const STEPS: usize = 2;
/// The accuracy limit of this computation: a basis with a smaller error is not refined.
pub(in crate::analysis) const LEAST_EPSILON: f64 = 1.0 / (1u128 << 96) as f64;
const UP: f64 = up::THOUSANDS;

/// An epsilon that leaves all printed digits to transfer functions and motions.
pub(in crate::analysis) const ENOUGH: f64 = 1e-23;

/// Up to this many coordinates, forms from their terms take less time than products of matrices.
pub(in crate::analysis) const FEW: usize = 24;
/// The most coordinates whose damping is decomposed by modes.
const MOST: usize = 1_000;

impl ModalForm {
    /// With X^T C X. `None` if modes are missing; beyond [`PRECISE`] coordinates also where some coordinate has no mass.
    pub fn with_damping(system: &LinearSystem, modes: &Modes) -> Option<(ModalForm, Matrix<Ball>)> {
        let n = system.n();
        let kinds = kinds(&modes.list);
        // Of modes that are damped by one ratio all is known, whatever the digits of the rows of C.
        let by_ratio = |form: &ModalForm| form.damping_by_ratio(&kinds, system.c.damping_ratio()?);
        let from_terms = || {
            let form = ModalForm::of(system, modes, gram)?;
            let damping = by_ratio(&form).unwrap_or_else(|| gram(&Squares::of_form(&system.c), &form.shapes));
            Some((form, damping))
        };
        let is_complete = modes.list.len() == n && modes.list.iter().all(|mode| mode.shape.len() == n);
        if n <= FEW || n > MOST || !is_complete {
            return if n <= FEW { from_terms() } else { None };
        }
        let found = ModalForm::from_basis(system, modes, by_ratio);
        if n > PRECISE {
            return found;
        }
        found.filter(|(form, _)| form.epsilon(&kinds) <= ENOUGH).or_else(from_terms)
    }

    /// By products of matrices in binary64.
    fn from_basis(
        system: &LinearSystem,
        modes: &Modes,
        by_ratio: impl Fn(&ModalForm) -> Option<Matrix<Ball>>,
    ) -> Option<(ModalForm, Matrix<Ball>)> {
        let shapes = Matrix::from_fn(system.n(), system.n(), |i, j| modes.list[j].shape[i]);
        let basis = Basis::of(system, shapes)?;
        let form = ModalForm { shapes: basis.shapes(), m: basis.m.clone(), k: basis.form(&system.k) };
        let c = by_ratio(&form).unwrap_or_else(|| basis.form(&system.c));
        Some((form, c))
    }

    /// How far M and K are from diagonal, relative to the diagonal.
    fn epsilon(&self, kinds: &[ModeKind]) -> f64 {
        let k = self.stiffnesses();
        let of_m = off_diagonal(&self.m, &vec![1.0; k.len()], true);
        larger(of_m, off_diagonal(&self.k, &sizes(&k, least_stiffness(kinds, &k)), false))
    }

    /// `gram` computes X^T A X. `None` if modes are missing.
    pub fn of(
        system: &LinearSystem,
        modes: &Modes,
        gram: impl Fn(&Squares, &Matrix<Dd>) -> Matrix<Ball>,
    ) -> Option<ModalForm> {
        let n = system.n();
        if n == 0 || modes.list.len() != n || modes.list.iter().any(|mode| mode.shape.len() != n) {
            return None;
        }
        let (m, k) = (Squares::of_form(&system.m), Squares::of_form(&system.k));
        Some(ModalForm::from_shapes(shapes(&modes.list), &kinds(&modes.list), &m, &k, gram))
    }

    /// The form from shapes as computed, one column for each mode, and the kinds of these modes.
    pub fn from_shapes(
        shapes: Matrix<Dd>,
        kinds: &[ModeKind],
        m: &Squares,
        k: &Squares,
        gram: impl Fn(&Squares, &Matrix<Dd>) -> Matrix<Ball>,
    ) -> ModalForm {
        let mut form = ModalForm::with(shapes, m, k, &gram);
        for _ in 0..STEPS {
            if form.is_diagonal(kinds) {
                break;
            }
            form = ModalForm::with(newton(&form.shapes, &form.m.mid(), &form.k.mid()), m, k, &gram);
        }
        form
    }

    fn with(
        shapes: Matrix<Dd>,
        m: &Squares,
        k: &Squares,
        gram: impl Fn(&Squares, &Matrix<Dd>) -> Matrix<Ball>,
    ) -> ModalForm {
        ModalForm { m: gram(m, &shapes), k: gram(k, &shapes), shapes }
    }

    /// Whether another step would change nothing but rounding errors.
    fn is_diagonal(&self, kinds: &[ModeKind]) -> bool {
        let k = self.stiffnesses();
        let (ones, sizes) = (vec![1.0; k.len()], sizes(&k, least_stiffness(kinds, &k)));
        let negligible = |entry: Ball, size: f64| entry.mid.hi.abs() <= entry.rad + LEAST_EPSILON * size;
        let off = |gram: &Matrix<Ball>, sizes: &[f64], i: usize, j: usize| {
            negligible(gram[(i, j)], (sizes[i] * sizes[j]).sqrt())
        };
        (0..k.len()).all(|j| {
            negligible(self.m[(j, j)] - Ball::ONE, 1.0)
                && (0..j).all(|i| off(&self.m, &ones, i, j) && off(&self.k, &sizes, i, j))
        })
    }

    /// A bound of the entries of a G with sum 2 zeta omega_i (M x_i)(M x_i)^T = (M X + M X G) W (M X + M X G)^T
    /// exactly, where the sum is over the true oscillations, and W is diagonal: 2 zeta sqrt k_i for the oscillations,
    /// otherwise 0. `None` if the basis is too far from one of modes. Close and repeated frequencies need no special
    /// treatment, because the sum does not depend on the choice of shapes within them. The proof is in
    /// docs/method/response.md#damping-by-modes.
    pub fn uncertainty(&self, kinds: &[ModeKind]) -> Option<f64> {
        let k = self.stiffnesses();
        let least = least_stiffness(kinds, &k);
        let sign_is_known = |(kind, k): (&ModeKind, &Dd)| match kind {
            ModeKind::Oscillation => k.hi > 0.0,
            ModeKind::Divergence => k.hi < 0.0,
            ModeKind::Rigid => true,
            ModeKind::Undetermined => false,
        };
        let is_known = kinds.iter().zip(&k).all(sign_is_known) && least > 0.0 && least.is_finite();
        if !is_known {
            return None;
        }
        let of_m = off_diagonal(&self.m, &vec![1.0; k.len()], true);
        let rigid = kinds.iter().zip(&k).filter(|(kind, _)| **kind == ModeKind::Rigid);
        let of_k = rigid
            .fold(off_diagonal(&self.k, &sizes(&k, least), false), |sum, (_, k)| larger(sum, k.hi.abs() * UP / least));
        let is_small = k.len() as f64 * (of_m + of_k) < 1e-3;
        is_small.then_some((8.0 * of_m + 3.0 * of_k) * UP)
    }

    /// X^T C X of the C that gives every oscillation one damping ratio, and other motions none. With X^T M X = 1 + F it is
    /// (1 + E) W (1 + E)^T, 1 + E = (1 + F) (1 + G), G and W as [above](Self::uncertainty): with |E_ij| <= e an entry is within
    /// e (w_i + w_j) + e^2 sum w of that of W. `None` if the basis is too far from one of modes.
    pub fn damping_by_ratio(&self, kinds: &[ModeKind], ratio: &Number) -> Option<Matrix<Ball>> {
        let g = self.uncertainty(kinds)?;
        let n = kinds.len();
        let f = off_diagonal(&self.m, &vec![1.0; n], true);
        let e = (f + g + n as f64 * f * g) * UP;
        let twice = ratio.to_ball() * Ball::from(2.0);
        let rate = |(kind, k): (&ModeKind, &Dd)| match kind {
            ModeKind::Oscillation => twice * Ball::exact(*k).sqrt(),
            _ => Ball::ZERO,
        };
        let w: Vec<Ball> = kinds.iter().zip(&self.stiffnesses()).map(rate).collect();
        let sizes: Vec<f64> = w.iter().map(|w| w.magnitude()).collect();
        let all = e * e * sizes.iter().sum::<f64>();
        let entry = |i: usize, j: usize| {
            let own = if i == j { w[i] } else { Ball::ZERO };
            own.widen((e * (sizes[i] + sizes[j]) + all) * UP)
        };
        Some(Matrix::from_fn(n, n, entry))
    }

    /// The diagonal of X^T K X.
    pub fn stiffnesses(&self) -> Vec<Dd> {
        (0..self.k.columns()).map(|i| self.k[(i, i)].mid).collect()
    }
}

/// The shapes of modes as computed, one column for each mode.
pub(in crate::analysis) fn shapes(modes: &[Mode]) -> Matrix<Dd> {
    let n = modes.first().map_or(0, |mode| mode.shape.len());
    Matrix::from_fn(n, modes.len(), |i, j| {
        modes[j].precise.as_ref().map_or_else(|| Dd::from(modes[j].shape[i]), |x| x[i])
    })
}

pub(in crate::analysis) fn kinds(modes: &[Mode]) -> Vec<ModeKind> {
    modes.iter().map(|mode| mode.kind).collect()
}

/// A substitute for the stiffness k_i of a rigid motion, which is zero up to rounding: the least of the others;
/// infinite if there are none.
pub(in crate::analysis) fn least_stiffness(kinds: &[ModeKind], k: &[Dd]) -> f64 {
    let others = kinds.iter().zip(k).filter(|(kind, _)| **kind != ModeKind::Rigid);
    others.map(|(_, k)| k.hi.abs()).fold(f64::INFINITY, f64::min)
}

/// Magnitudes, raised to a floor; all zero if the floor is infinite.
pub(in crate::analysis) fn sizes(values: &[Dd], floor: f64) -> Vec<f64> {
    values.iter().map(|x| if floor.is_finite() { x.hi.abs().max(floor) } else { 0.0 }).collect()
}

/// X <- X (I + Z) with the Z that makes X^T M X = I and X^T K X diagonal to second order; modes of close frequencies
/// are only made orthogonal.
fn newton(x: &Matrix<Dd>, m: &Matrix<Dd>, k: &Matrix<Dd>) -> Matrix<Dd> {
    let n = x.columns();
    let mut next = x.clone();
    for j in 0..n {
        for i in 0..n {
            let e = m[(i, j)];
            let z = if i == j {
                (Dd::ONE - e) * 0.5
            } else {
                let gap = k[(i, i)] - k[(j, j)];
                let numerator = k[(j, j)] * e - k[(i, j)];
                // A step above 1e-4 would not be a small correction.
                if gap.hi.abs() * 1e-4 > numerator.hi.abs() { numerator / gap } else { -e * 0.5 }
            };
            add_scaled(next.column_mut(j), z, x.column(i));
        }
    }
    next
}

simd! {
    /// X^T (sum w a a^T) X, term by term.
    pub(in crate::analysis) fn gram(squares: &Squares, x: &Matrix<Dd>) -> Matrix<Ball> {
        let n = x.columns();
        let mut gram = Matrix::fill_with(n, n, Ball::ZERO);
        for t in 0..squares.len() {
            let stretch: Vec<Ball> = (0..n).map(|j| squares.stretch(t, x.column(j))).collect();
            for j in 0..n {
                let tension = squares.weights[t] * stretch[j];
                for i in 0..=j {
                    gram[(i, j)] = gram[(i, j)] + tension * stretch[i];
                }
            }
        }
        for j in 0..n {
            for i in 0..j {
                gram[(j, i)] = gram[(i, j)];
            }
        }
        gram
    }
}

/// Whether X^T C X is far from diagonal, by binary64 alone: then no enclosure of it has to be computed to refuse the modes. `false`
/// decides nothing. Its product with a vector of scattered signs is, without the diagonal, more than the sum of what would be small
/// entries of a row only if one of them is larger.
pub(in crate::analysis) fn damping_clearly_couples(system: &LinearSystem, modes: &Modes) -> bool {
    let n = modes.list.len();
    if system.c.is_empty() || modes.list.iter().any(|mode| mode.shape.len() != system.n()) {
        return false;
    }
    let c = Squares::of_form(&system.c);
    let signs: Vec<f64> = (1..=n as u64).map(scattered_sign).collect();
    let (mut products, mut diagonal, mut sizes) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    let mut stretches = vec![0.0; n];
    for t in 0..c.len() {
        let weight = c.weights[t].to_f64();
        let (indices, factors) = c.row(t);
        let factors: Vec<f64> = factors.iter().map(|a| a.to_f64()).collect();
        for (stretch, mode) in stretches.iter_mut().zip(&modes.list) {
            *stretch = indices.iter().zip(&factors).map(|(&i, a)| a * mode.shape[i as usize]).sum::<f64>();
        }
        let tension = weight * stretches.iter().zip(&signs).map(|(stretch, sign)| stretch * sign).sum::<f64>();
        for (j, stretch) in stretches.iter().enumerate() {
            products[j] += tension * stretch;
            diagonal[j] += weight * stretch * stretch;
            sizes[j] += weight.abs() * stretch * stretch;
        }
    }
    // Rounding, of the shapes as well, is a millionth of the first summand, or of the second where a mode is hardly damped.
    let least = 1e-9 * n as f64 * sizes.iter().copied().fold(0.0, f64::max);
    let all = 1e-6 * sizes.iter().map(|size| size.sqrt()).sum::<f64>();
    (0..n).any(|j| (products[j] - diagonal[j] * signs[j]).abs() > all * sizes[j].sqrt() + least)
}

/// 1 or -1, without a pattern that modes have.
fn scattered_sign(number: u64) -> f64 {
    let mixed = number.wrapping_mul(0x9E37_79B9_7F4A_7C15);
    if (mixed ^ mixed >> 32).wrapping_mul(0xD6E8_FEB8_6659_FD93) >> 63 == 0 { 1.0 } else { -1.0 }
}

/// The largest |G_ij| / sqrt(s_i s_j), where on the diagonal the radius (or, with `unit`, the distance from one) is
/// taken instead of |G_ii|.
pub(in crate::analysis) fn off_diagonal(gram: &Matrix<Ball>, sizes: &[f64], unit: bool) -> f64 {
    let mut largest = 0.0f64;
    for j in 0..gram.columns() {
        for i in 0..=j {
            let entry = gram[(i, j)];
            let size = match (i == j, unit) {
                (false, _) => entry.magnitude(),
                (true, true) => (entry - Ball::ONE).magnitude(),
                (true, false) => entry.rad,
            };
            if size != 0.0 {
                largest = larger(largest, size / (sizes[i] * sizes[j]).sqrt());
            }
        }
    }
    largest * UP
}

/// The norms of the columns of what a form is beside its diagonal, on which the radius (or, with `unit`, the distance from one)
/// is taken instead.
pub(in crate::analysis) fn columns_beside(gram: &Matrix<Ball>, unit: bool) -> Vec<f64> {
    let size = |i: usize, j: usize| match (i == j, unit) {
        (false, _) => gram[(i, j)].magnitude(),
        (true, true) => (gram[(i, j)] - Ball::ONE).magnitude(),
        (true, false) => gram[(i, j)].rad,
    };
    let column = |j: usize| (0..gram.rows()).map(|i| size(i, j) * size(i, j)).sum::<f64>().sqrt() * UP;
    (0..gram.columns()).map(column).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::modes::modes;
    use crate::analysis::test_systems::{blank, push};

    fn chain(n: usize) -> LinearSystem {
        let mut system = blank(n);
        for i in 0..n {
            push(&mut system.m, "3", i, None);
            push(&mut system.k, "1000", i, i.checked_sub(1));
        }
        system
    }

    /// Shapes that come in double-double are a basis as they are; shapes from binary64 need steps.
    #[test]
    fn precise_shapes_need_no_step() {
        let system = chain(20);
        let precise = modes(&system).expect("modes");
        let mut plain = precise.clone();
        plain.list.iter_mut().for_each(|mode| mode.precise = None);
        let (m, k) = (Squares::of_form(&system.m), Squares::of_form(&system.k));
        let is_diagonal =
            |modes: &Modes| ModalForm::with(shapes(&modes.list), &m, &k, gram).is_diagonal(&kinds(&modes.list));
        assert!(is_diagonal(&precise));
        assert!(!is_diagonal(&plain));
        let (a, b) = (ModalForm::of(&system, &precise, gram), ModalForm::of(&system, &plain, gram));
        let (a, b) = (a.expect("all modes").stiffnesses(), b.expect("all modes").stiffnesses());
        for ((a, b), mode) in a.iter().zip(&b).zip(&precise.list) {
            assert!((*a - *b).abs().hi <= 1e-29 * a.hi, "{a:?} {b:?}");
            assert!((*a - mode.omega_squared.mid).abs().hi <= 1e-29 * a.hi, "{a:?} {:?}", mode.omega_squared);
        }
    }

    /// Dampers in proportion to the springs do not couple the modes; one damper alone does, and so do dampers that are off by a
    /// thousandth.
    #[test]
    fn coupling_is_seen_and_not_invented() {
        let of = |dampers: &dyn Fn(usize) -> Option<&'static str>| {
            let mut system = chain(40);
            for i in 0..40 {
                if let Some(c) = dampers(i) {
                    push(&mut system.c, c, i, i.checked_sub(1));
                }
            }
            damping_clearly_couples(&system, &modes(&system).expect("modes"))
        };
        assert!(!of(&|_| None));
        assert!(!of(&|_| Some("0.7")));
        assert!(of(&|i| (i == 17).then_some("0.7")));
        assert!(of(&|i| Some(if i % 2 == 0 { "0.7" } else { "0.7007" })));
    }

    /// Frequencies of 1 and 2 rad/s, and a free system with one of 1 rad/s: C is rational. Seen from modes that are turned against each
    /// other, mixed or of the wrong size by 1e-10, it lies in the enclosure, which is not much wider.
    #[test]
    fn damping_by_a_ratio_is_enclosed_from_poor_modes() {
        for (held, between, sum_of_rates) in [("1", "1.5", "1.5"), ("0", "0.5", "0")] {
            let ratio = Number::from("0.75");
            let mut system = blank(2);
            for i in 0..2 {
                push(&mut system.m, "1", i, None);
                push(&mut system.k, held, i, None);
                push(&mut system.c, sum_of_rates, i, None);
            }
            push(&mut system.k, between, 1, Some(0));
            push(&mut system.c, "0.75", 1, Some(0));
            let [m, c, k] = [&system.m, &system.c, &system.k].map(Squares::of_form);
            let list = modes(&system).expect("modes").list;
            let good = shapes(&list);
            for by in [[[0.0, 1e-10], [-1e-10, 0.0]], [[0.0, 1e-10], [1e-10, 0.0]], [[3e-10, 0.0], [0.0, -1e-10]]] {
                let poor = Matrix::from_fn(2, 2, |i, j| {
                    (0..2).fold(good[(i, j)], |sum, l| sum + good[(i, l)] * Dd::from(by[l][j]))
                });
                let form = ModalForm::with(poor, &m, &k, gram);
                let found = form.damping_by_ratio(&kinds(&list), &ratio).expect("near modes");
                let truth = gram(&c, &form.shapes);
                for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    assert!(
                        (found[(i, j)] - truth[(i, j)]).contains_zero(),
                        "{held} {by:?} {i} {j}: {found:?} {truth:?}"
                    );
                    // Eleven times the flaw, times the sum of two rates of at most 3 1/s.
                    assert!(found[(i, j)].rad < 1e-7, "{found:?}");
                }
            }
        }
    }

    /// A mode has the same sign in both representations of its shape.
    #[test]
    fn both_forms_of_a_shape_agree() {
        for mode in modes(&chain(7)).expect("modes").list {
            let precise = mode.precise.expect("a small system");
            assert!(precise.iter().zip(&mode.shape).all(|(x, y)| x.hi == *y), "{precise:?} {:?}", mode.shape);
        }
    }
}
