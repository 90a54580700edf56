//! The modes of a system as a basis that diagonalises M and K to double-double. In: M, K and modes as they were computed. Out:
//! their shapes, refined where they have fewer digits, and X^T M X and X^T K X as enclosures. Whatever takes the damping of a
//! system apart by its modes begins here: transfer functions, motions, emitted code. See docs/method/transfer.md.
//!
//! A step X <- X (I + Z) with the Z that makes X^T M X = I and X^T K X diagonal to second order squares the error (Ogita and
//! Aishima 2018): 1e-16 becomes 1e-31 in two. Shapes that come in double-double need none.

use crate::analysis::answer::{Mode, ModeKind, Modes, PRECISE};
use crate::analysis::modes::squares::Squares;
use crate::analysis::numeric::dense::{Matrix, add_scaled};
use crate::analysis::numeric::fused::fused;
use crate::base::{Ball, Dd, larger};
use crate::system::LinearSystem;

/// The modes in coordinates of their own.
#[derive(Clone, Debug)]
pub(in crate::analysis) struct ModalForm {
    /// X, a column a mode, mass-normalised.
    pub shapes: Matrix<Dd>,
    /// X^T M X
    pub m: Matrix<Ball>,
    /// X^T K X
    pub k: Matrix<Ball>,
}

/// Newton steps at most: 1e-16 becomes 1e-31.
const STEPS: usize = 2;
/// Nothing here is known better: a basis that is off by no more is not refined.
pub(in crate::analysis) const LEAST_EPSILON: f64 = 1.0 / (1u128 << 96) as f64;
const UP: f64 = 1.0 + 1e-12;

impl ModalForm {
    /// `gram` computes X^T A X. `None` where modes are missing.
    pub fn of(
        system: &LinearSystem,
        modes: &Modes,
        gram: impl Fn(&Squares, &Matrix<Dd>) -> Matrix<Ball>,
    ) -> Option<ModalForm> {
        let n = system.n();
        if n == 0 || modes.list.len() != n || modes.list.iter().any(|mode| mode.shape.len() != n) {
            return None;
        }
        Some(ModalForm::refined(system, modes, gram))
    }

    fn refined(
        system: &LinearSystem,
        modes: &Modes,
        gram: impl Fn(&Squares, &Matrix<Dd>) -> Matrix<Ball>,
    ) -> ModalForm {
        let (m, k) = (Squares::of(&system.m), Squares::of(&system.k));
        let mut form = ModalForm::with(initial(modes, system.n()), &m, &k, &gram);
        for _ in 0..STEPS {
            if form.is_diagonal(modes) {
                break;
            }
            form = ModalForm::with(newton(&form.shapes, &form.m.mid(), &form.k.mid()), &m, &k, &gram);
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

    /// Whether a step would change nothing but rounding errors.
    fn is_diagonal(&self, modes: &Modes) -> bool {
        let k = self.stiffnesses();
        let (ones, sizes) = (vec![1.0; k.len()], sizes(&k, least_stiffness(&modes.list, &k)));
        let negligible = |entry: Ball, size: f64| entry.mid.hi.abs() <= entry.rad + LEAST_EPSILON * size;
        let off = |gram: &Matrix<Ball>, sizes: &[f64], i: usize, j: usize| {
            negligible(gram[(i, j)], (sizes[i] * sizes[j]).sqrt())
        };
        (0..k.len()).all(|j| {
            negligible(self.m[(j, j)] - Ball::ONE, 1.0)
                && (0..j).all(|i| off(&self.m, &ones, i, j) && off(&self.k, &sizes, i, j))
        })
    }

    /// The diagonal of X^T K X.
    pub fn stiffnesses(&self) -> Vec<Dd> {
        (0..self.k.columns()).map(|i| self.k[(i, i)].mid).collect()
    }
}

/// The shapes as they come.
fn initial(modes: &Modes, n: usize) -> Matrix<Dd> {
    Matrix::from_fn(n, modes.list.len(), |i, j| {
        let mode = &modes.list[j];
        mode.precise.as_ref().map_or_else(|| Dd::from(mode.shape[i]), |x| x[i])
    })
}

/// The shapes of the modes in double-double; as they are where there are too many to refine.
pub(in crate::analysis) fn shapes(system: &LinearSystem, modes: &Modes) -> Matrix<Dd> {
    match modes.list.len() > PRECISE {
        true => initial(modes, system.n()),
        false => ModalForm::refined(system, modes, gram).shapes,
    }
}

/// Stands for the stiffness k_i of a rigid motion, which is zero up to rounding: the least of the others; infinite without any.
pub(in crate::analysis) fn least_stiffness(modes: &[Mode], k: &[Dd]) -> f64 {
    let others = modes.iter().zip(k).filter(|(mode, _)| mode.kind != ModeKind::Rigid);
    others.map(|(_, k)| k.hi.abs()).fold(f64::INFINITY, f64::min)
}

/// Magnitudes, not below a floor; all zero where that is infinite.
pub(in crate::analysis) fn sizes(values: &[Dd], floor: f64) -> Vec<f64> {
    values.iter().map(|x| if floor.is_finite() { x.hi.abs().max(floor) } else { 0.0 }).collect()
}

/// X <- X (I + Z) with the Z that makes X^T M X = I and X^T K X diagonal to second order; close frequencies are made
/// orthogonal only.
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
                // A step above 1e-4 would not be a correction.
                if gap.hi.abs() * 1e-4 > numerator.hi.abs() { numerator / gap } else { -e * 0.5 }
            };
            add_scaled(next.column_mut(j), z, x.column(i));
        }
    }
    next
}

fused! {
    /// X^T (sum w a a^T) X, term by term.
    pub(in crate::analysis) fn gram(squares: &Squares, x: &Matrix<Dd>) -> Matrix<Ball> {
        let n = x.columns();
        let mut gram = Matrix::filled(n, n, Ball::ZERO);
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

/// The largest |G_ij| / sqrt(s_i s_j) off the diagonal, and of what the diagonal is uncertain by (or off one by).
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

    /// Shapes that come in double-double are a basis as they are; the same from binary64 takes steps to it.
    #[test]
    fn precise_shapes_need_no_step() {
        let system = chain(20);
        let precise = modes(&system).expect("modes");
        let mut plain = precise.clone();
        plain.list.iter_mut().for_each(|mode| mode.precise = None);
        let (m, k) = (Squares::of(&system.m), Squares::of(&system.k));
        let as_it_comes = |modes: &Modes| ModalForm::with(initial(modes, 20), &m, &k, gram);
        assert!(as_it_comes(&precise).is_diagonal(&precise));
        assert!(!as_it_comes(&plain).is_diagonal(&plain));
        let (a, b) = (ModalForm::of(&system, &precise, gram), ModalForm::of(&system, &plain, gram));
        let (a, b) = (a.expect("all modes").stiffnesses(), b.expect("all modes").stiffnesses());
        for ((a, b), mode) in a.iter().zip(&b).zip(&precise.list) {
            assert!((*a - *b).abs().hi <= 1e-29 * a.hi, "{a:?} {b:?}");
            assert!((*a - mode.omega_squared.mid).abs().hi <= 1e-29 * a.hi, "{a:?} {:?}", mode.omega_squared);
        }
    }

    /// A mode keeps its sign in both forms of its shape.
    #[test]
    fn both_forms_of_a_shape_agree() {
        for mode in modes(&chain(7)).expect("modes").list {
            let precise = mode.precise.expect("a small system");
            assert!(precise.iter().zip(&mode.shape).all(|(x, y)| x.hi == *y), "{precise:?} {:?}", mode.shape);
        }
    }
}
