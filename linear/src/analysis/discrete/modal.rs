//! A system whose damping is diagonal in its undamped modes, as one oscillator for each mode: eta'' + c eta' + k eta =
//! X^T B u. In: the system and its modes. Out: blocks of two states, of one for well separated real rates, or nothing
//! if damping couples the modes. See docs/method/emit.md.

use crate::analysis::answer::{Mode, ModeKind, Modes};
use crate::analysis::discrete::block::{Block, DirectSums, NOTHING, Split, without_derivatives};
use crate::analysis::modes::form::{FEW, ModalForm, damping_clearly_couples, gram};
use crate::base::{Ball, Dd, Number, Power};
use crate::kernel::dense::Matrix;
use crate::kernel::squares::Squares;
use crate::system::{CoordinateId, LinearSystem};

/// Off-diagonal entries below this, relative to the geometric mean of the diagonal ones, are rounding errors of
/// double-double; larger ones are coupling.
const COUPLED: f64 = 1e-22;
/// Two real rates a +- d are separated if d / a is above this; closer ones form one block of two states.
const APART: f64 = 0.05;

/// The oscillators.
pub fn split(system: &LinearSystem, modes: &Modes) -> Option<Split> {
    let n = system.n();
    if damping_clearly_couples(system, modes) {
        return None;
    }
    let m = Squares::of_form(&system.m);
    let (x, grams) = if n > FEW { of_many(system, modes)? } else { of_few(system, modes, &m)? };
    if !grams.iter().all(is_diagonal) {
        return None;
    }
    let momentum = momenta(&m, &x);
    let mut direct = DirectSums::none(system);
    let mut found = Split {
        blocks: Vec::with_capacity(n),
        direct: super::direct_of(system),
        method: "one oscillator for each mode: damping does not couple the modes",
    };
    for (j, mode) in modes.list.iter().enumerate() {
        let stiffness = match mode.kind {
            ModeKind::Rigid => Dd::ZERO,
            _ if mode.omega_squared.is_finite() => mode.omega_squared.mid,
            _ => grams[2][(j, j)].mid,
        };
        let damping = grams[1][(j, j)];
        let damping = if damping.contains_zero() { Dd::ZERO } else { damping.mid };
        let oscillator = Oscillator { system, shape: x.column(j), momentum: momentum.column(j), stiffness, damping };
        let name = name(j, mode);
        oscillator.blocks(name, &mut found.blocks, &mut direct);
    }
    direct.add_to(&mut found.direct);
    Some(found)
}

/// The modes X, and X^T M X, X^T C X and X^T K X.
type Decomposed = (Matrix<Dd>, [Matrix<Ball>; 3]);

fn of_few(system: &LinearSystem, modes: &Modes, m: &Squares) -> Option<Decomposed> {
    let gram = |form: &Squares, x: &Matrix<Dd>| gram_of_many(form, x).unwrap_or_else(|| gram(form, x));
    let ModalForm { shapes: mut x, m: masses, k: stiffness } = ModalForm::of(system, modes, gram)?;
    let (c, k) = (Squares::of_form(&system.c), Squares::of_form(&system.k));
    let (masses, stiffness) = if without_rounding(&mut x) { (gram(m, &x), gram(&k, &x)) } else { (masses, stiffness) };
    let grams = [masses, gram(&c, &x), stiffness];
    Some((x, grams))
}

fn of_many(system: &LinearSystem, modes: &Modes) -> Option<Decomposed> {
    let (form, damping) = ModalForm::with_damping(system, modes)?;
    Some((form.shapes, [form.m, damping, form.k]))
}

/// X^T A X for an A with far more terms than entries, as for springs between all pairs of bodies: computed from the
/// entries, unless that loses digits that the terms would keep.
fn gram_of_many(form: &Squares, x: &Matrix<Dd>) -> Option<Matrix<Ball>> {
    let n = x.rows();
    if form.len() < 4 * n {
        return None;
    }
    let mut a = Matrix::fill_with(n, n, Ball::ZERO);
    for t in 0..form.len() {
        let (indices, values) = form.row(t);
        for (&i, &p) in indices.iter().zip(values) {
            let weighted = form.weights[t] * p;
            indices.iter().zip(values).for_each(|(&j, &q)| {
                let entry = &mut a[(i as usize, j as usize)];
                *entry = *entry + weighted * q;
            });
        }
    }
    let sum = |of: &dyn Fn(usize) -> Ball, y: &[Dd]| {
        y.iter()
            .enumerate()
            .fold(Ball::ZERO, |sum, (i, &y)| if y.is_zero() { sum } else { sum + of(i) * Ball::exact(y) })
    };
    let ax = Matrix::from_fn(n, n, |i, j| sum(&|k| a[(i, k)], x.column(j)));
    let mut gram = Matrix::fill_with(n, n, Ball::ZERO);
    for j in 0..n {
        for i in 0..=j {
            let entry = sum(&|k| ax[(k, j)], x.column(i));
            (gram[(i, j)], gram[(j, i)]) = (entry, entry);
        }
    }
    let size = |i: usize| gram[(i, i)].magnitude();
    let kept = |i: usize, j: usize| gram[(i, j)].rad <= 1e-3 * COUPLED * (size(i) * size(j)).sqrt();
    (0..n).all(|j| (0..=j).all(|i| kept(i, j))).then_some(gram)
}

fn name(index: usize, mode: &Mode) -> String {
    let frequency = mode.omega.to_f64() / (2.0 * std::f64::consts::PI);
    match mode.kind {
        ModeKind::Oscillation => format!("mode {} ({frequency:.6} Hz)", index + 1),
        ModeKind::Rigid => format!("mode {} (rigid motion)", index + 1),
        ModeKind::Divergence | ModeKind::Undetermined => format!("mode {} (slow)", index + 1),
    }
}

/// Whether the off-diagonal entries are only rounding errors.
fn is_diagonal(gram: &Matrix<Ball>) -> bool {
    let n = gram.columns();
    let most = (0..n).map(|i| gram[(i, i)].magnitude()).fold(0.0, f64::max);
    let size = |i: usize| gram[(i, i)].magnitude().max(1e-10 * most);
    (0..n).all(|j| {
        (0..j).all(|i| gram[(i, j)].is_finite() && gram[(i, j)].magnitude() <= COUPLED * (size(i) * size(j)).sqrt())
    })
}

/// Sets the displacement of coordinates that a mode moves only by rounding, below 1e-31 of the largest, to zero;
/// returns whether there were any.
fn without_rounding(x: &mut Matrix<Dd>) -> bool {
    let mut found = false;
    for j in 0..x.columns() {
        let most = x.column(j).iter().map(|x| x.hi.abs()).fold(0.0, f64::max);
        for x in x.column_mut(j).iter_mut().filter(|x| !x.is_zero() && x.hi.abs() < 1e-28 * most) {
            *x = Dd::ZERO;
            found = true;
        }
    }
    found
}

/// M X
fn momenta(m: &Squares, x: &Matrix<Dd>) -> Matrix<Dd> {
    let mut momenta = Matrix::zeros(x.rows(), x.columns());
    for j in 0..x.columns() {
        for t in 0..m.len() {
            let weighted = (m.weights[t] * m.stretch(t, x.column(j))).mid;
            let (indices, values) = m.row(t);
            for (&i, a) in indices.iter().zip(values) {
                momenta[(i as usize, j)] += weighted * a.mid;
            }
        }
    }
    momenta
}

struct Oscillator<'a> {
    system: &'a LinearSystem,
    shape: &'a [Dd],
    momentum: &'a [Dd],
    stiffness: Dd,
    damping: Dd,
}

impl Oscillator<'_> {
    /// Adds the oscillator's blocks, and the direct effects of its inputs.
    fn blocks(&self, name: String, found: &mut Vec<Block>, direct: &mut DirectSums) {
        let system = self.system;
        let (n, inputs, outputs) = (system.n(), system.inputs.len(), system.outputs.len());
        let (k, c) = (self.stiffness, self.damping);
        let a = Matrix::from_fn(2, 2, |i, j| match (i, j) {
            (0, 0) => Dd::ZERO,
            (0, 1) => Dd::ONE,
            (1, 0) => -k,
            _ => -c,
        });
        // Forces beta0 u + beta1 u' + beta2 u'' on eta.
        let beta: Vec<[Dd; 3]> =
            system.inputs.iter().map(|input| [0, 1, 2].map(|p| self.participation(&input.b[p]))).collect();
        let force = |p: usize| Matrix::from_fn(2, inputs, |i, j| if i == 1 { beta[j][p] } else { Dd::ZERO });
        let (b, offsets) = without_derivatives(&a, [force(0), force(1), force(2)]);
        // y = p0 eta + p1 eta' + p2 (beta u - k eta - c eta')
        let seen: Vec<[Dd; 3]> =
            system.outputs.iter().map(|output| [0, 1, 2].map(|p| self.participation(&output.p[p]))).collect();
        let rows = Matrix::from_fn(outputs, 2, |i, j| match j {
            0 => seen[i][0] - seen[i][2] * k,
            _ => seen[i][1] - seen[i][2] * c,
        });
        let at_once = |p: usize| Matrix::from_fn(outputs, inputs, |i, j| seen[i][2] * beta[j][p]);
        let at_once = [0, 1, 2].map(at_once);
        let to = Matrix::from_fn(2, 2 * n, |i, j| if j / n == i { self.momentum[j % n] } else { Dd::ZERO });
        let back = Matrix::from_fn(2 * n, 2, |i, j| if i / n == j { self.shape[i % n] } else { Dd::ZERO });
        direct.add(&at_once, &offsets, &rows, &back);
        let rate = k.hi.abs().sqrt().max(c.hi.abs());
        let block = Block { name, rate, a, b, c: rows, to, back };
        found.extend(split_real_rates(block, k, c));
    }

    /// x . column, exactly zero if only rounding error is left.
    fn participation(&self, column: &[(CoordinateId, Number)]) -> Dd {
        let (mut sum, mut size) = (Ball::ZERO, 0.0);
        for (i, value) in column {
            let term = value.to_ball() * Ball::exact(self.shape[i.index()]);
            size += term.magnitude();
            sum = sum + term;
        }
        if sum.magnitude() <= NOTHING * size + NOTHING * self.length() * length(column) { Dd::ZERO } else { sum.mid }
    }

    fn length(&self) -> f64 {
        self.shape.iter().map(|x| x.hi.abs()).fold(0.0, f64::max)
    }
}

fn length(column: &[(CoordinateId, Number)]) -> f64 {
    column.iter().map(|(_, value)| value.to_ball().magnitude()).fold(0.0, f64::max)
}

/// Separates two well separated real rates: the slower one is k over the faster one, so it keeps its digits.
fn split_real_rates(block: Block, k: Dd, c: Dd) -> Vec<Block> {
    let half = c * 0.5;
    let square = half * half - k;
    if square.hi <= (APART * half.hi).power(2) || square.hi <= 0.0 {
        return vec![block];
    }
    let root = square.sqrt();
    let fast = if half.hi < 0.0 { -half + root } else { -half - root };
    let slow = k / fast;
    let rates = [slow, fast];
    // w = (1, s)^T w~: the columns are the motions exp(s t), scaled to length one.
    let scale = rates.map(|s| Dd::ONE / (Dd::ONE + s * s).sqrt());
    let inverse = Matrix::from_fn(2, 2, |i, j| if i == 0 { scale[j] } else { rates[j] * scale[j] });
    let det = fast - slow;
    let s = Matrix::from_fn(2, 2, |i, j| {
        let other = rates[1 - i];
        let sign = if i == 0 { Dd::ONE } else { -Dd::ONE };
        sign * (if j == 0 { other } else { -Dd::ONE }) / (det * scale[i])
    });
    let mut diagonal = block.transform(&s, &inverse);
    diagonal.a = Matrix::from_fn(2, 2, |i, j| if i == j { rates[i] } else { Dd::ZERO });
    vec![diagonal.state(0), diagonal.state(1)]
}
