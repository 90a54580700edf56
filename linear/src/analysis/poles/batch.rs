//! Refinement of all poles and their vectors together. In: pencil, modal basis, the Schur forms of its state matrix.
//! Out: the same pairs as `refinement` finds one by one, for a number of operations that grows as n^3: where that
//! module needs a factorisation for each pole, this one needs a triangular solve with one Schur form, and products of
//! matrices.
//!
//! Newton's method for Q(s) x = 0, y^H dy = 0 by elimination of the border: with u = Q(s0)^-1 r and v = Q(s0)^-1 Q'(s)
//! y, ds = -y^H u / y^H v and dy = -u - v ds. At the pole itself u and v would be rounding errors along the vector y
//! only, so s0 is placed slightly next to it: at a relative distance d, rounding leaves 1e-16 / d of the error and the
//! distance leaves d (Govaerts and Pryce, SIAM J. Numer. Anal. 30 (1993) 470, on bordered systems by block
//! elimination). See docs/method/poles.md#general-systems.

use crate::analysis::poles::companion::{Basis, Family, Spectrum};
use crate::analysis::poles::pencil::{Pencil, Vector};
use crate::analysis::poles::refinement::{Pair, SETTLED, balance_energies, norm, refine, rigid_residual};
use crate::analysis::poles::schur::ComplexColumns;
use crate::base::Dd;
use crate::kernel::complex::Complex;
use crate::kernel::dense::Matrix;
use crate::kernel::dense::product::View;

/// The relative distance of s0 from the pole: somewhat below the square root of the unit roundoff, because other poles
/// are nearer than zero is.
const OFFSET: f64 = 2e-9;
/// The least error reduction that is assumed of a step: [`OFFSET`] allows no better, though a very good start may
/// suggest it.
const CONTRACTION: f64 = 1e-7;
/// Each step gains some seven of thirty digits.
const MOST_STEPS: usize = 6;
/// A step whose equations are set up next to the pole does not improve a start farther from its pole than this.
const FAR: f64 = 1e-4;
/// Refined, but not to the last digit.
const REFINED: f64 = 1e-20;

/// Refines all starts together; those that this does not improve are refined one by one.
pub fn refine_all(pencil: &Pencil<Dd>, basis: &Basis, spectrum: &Spectrum) -> Vec<Pair> {
    let mut pairs = Vec::new();
    for family in &spectrum.families {
        for (refined, &(start, _)) in side_by_side(pencil, basis, family).into_iter().zip(&family.list) {
            let seed = pairs.len();
            pairs.extend(refined.or_else(|| refine(pencil, basis, start, seed)));
        }
    }
    pairs
}

/// The progress of an iteration.
#[derive(Clone, Copy, PartialEq)]
enum State {
    Moving { last: f64 },
    Settled,
    Lost,
}

fn side_by_side(pencil: &Pencil<Dd>, basis: &Basis, family: &Family) -> Vec<Option<Pair>> {
    let starts: Vec<Complex<f64>> = family.list.iter().map(|&(s, _)| s).collect();
    let y = normalise(displacements(basis, &starts, &family.vectors()));
    let mut pairs = expand(basis, &starts, &y);
    let neighbours: Vec<Complex<f64>> = starts.iter().map(|&s| next_to(s)).collect();
    let v = solve(basis, family, &neighbours, slopes(basis, &starts, &y));
    // Before the first step the relative error is at most one.
    let mut states = vec![State::Moving { last: 1.0 }; pairs.len()];
    for _ in 0..MOST_STEPS {
        if !states.iter().any(|state| matches!(state, State::Moving { .. })) {
            break;
        }
        let u = solve(basis, family, &neighbours, residuals(pencil, basis, &pairs, &states));
        let (dy, ds) = corrections(&y, &u, &v);
        let dx = dy.times(View::of(&basis.shapes));
        for (j, state) in states.iter_mut().enumerate() {
            if let State::Moving { last } = *state {
                apply(&mut pairs[j], &dx, ds[j], j);
                let size = (ds[j].abs() / pairs[j].s.to_f64().abs()).max(column_norm(&dy, j));
                *state = state_after(size, last);
            }
        }
    }
    let finish = |(mut pair, state): (Pair, State)| {
        let refined = match state {
            State::Settled => true,
            State::Moving { last } => last < REFINED,
            State::Lost => false,
        };
        refined.then(|| {
            balance_energies(pencil, &mut pair);
            pair
        })
    };
    pairs.into_iter().zip(states).map(finish).collect()
}

/// The state after a step of relative size `size` that followed one of size `last`. The remaining error is taken as
/// `size` times the contraction `size / last`, but at least times [`CONTRACTION`].
fn state_after(size: f64, last: f64) -> State {
    let contraction = size / last;
    if size < SETTLED || size * contraction.max(CONTRACTION) < SETTLED || (size < REFINED && contraction > 0.25) {
        State::Settled
    } else if size < FAR && contraction < 1.0 {
        State::Moving { last: size }
    } else {
        State::Lost
    }
}

/// A point next to s; a real s stays real.
fn next_to(s: Complex<f64>) -> Complex<f64> {
    if s.im == 0.0 { s.scale(1.0 + OFFSET) } else { s * Complex::new(1.0 + OFFSET, 0.5 * OFFSET) }
}

/// Modal displacements y of states (e, v) = (|omega| y, s y), from whichever of the two loses less by the division.
pub fn displacements(basis: &Basis, shifts: &[Complex<f64>], z: &ComplexColumns) -> ComplexColumns {
    let (free, rigid) = (basis.free, basis.rigid());
    let moving = basis.n() - rigid;
    let mut y = ComplexColumns::zeros(basis.n(), shifts.len());
    for (j, &s) in shifts.iter().enumerate() {
        let inverse = s.recip();
        for i in free..rigid {
            y.set(i, j, z.at(moving + i - free, j) * inverse);
        }
        for i in 0..moving {
            let rate = basis.rate(i);
            let energy = z.at(i, j).scale(1.0 / rate);
            let velocity = z.at(moving + basis.dragged + i, j) * inverse;
            y.set(rigid + i, j, if s.one_norm() > rate { velocity } else { energy });
        }
    }
    y
}

/// Solves Phi^T Q(s_j) Phi y_j = r_j, with rows divided as in `refinement`.
fn solve(basis: &Basis, family: &Family, shifts: &[Complex<f64>], r: ComplexColumns) -> ComplexColumns {
    let (free, rigid) = (basis.free, basis.rigid());
    let moving = basis.n() - rigid;
    let mut b = ComplexColumns::zeros(family.form.n(), shifts.len());
    for (j, &s) in shifts.iter().enumerate() {
        for i in free..basis.n() {
            let row = r.at(i, j);
            b.set(moving + i - free, j, if i < rigid { row * s } else { row });
        }
    }
    let mut y = displacements(basis, shifts, &family.solve(shifts, b));
    for j in 0..shifts.len() {
        (0..free).for_each(|i| y.set(i, j, r.at(i, j)));
    }
    y
}

/// The derivative of Phi^T Q(s) Phi with respect to s, times y.
fn slopes(basis: &Basis, shifts: &[Complex<f64>], y: &ComplexColumns) -> ComplexColumns {
    let mut slope = y.times(View::of(&basis.damping));
    for (j, s) in shifts.iter().enumerate() {
        for i in 0..basis.n() {
            let value = match i {
                _ if i < basis.free => Complex::ZERO,
                _ if i < basis.rigid() => y.at(i, j),
                _ => slope.at(i, j) + s.scale(2.0) * y.at(i, j),
            };
            slope.set(i, j, value);
        }
    }
    slope
}

/// Phi^T Q(s_j) x_j for the pairs that still move.
fn residuals(pencil: &Pencil<Dd>, basis: &Basis, pairs: &[Pair], states: &[State]) -> ComplexColumns {
    let mut force = ComplexColumns::zeros(pencil.n, pairs.len());
    let mut rigid = ComplexColumns::zeros(basis.rigid(), pairs.len());
    for (j, pair) in pairs.iter().enumerate() {
        if !matches!(states[j], State::Moving { .. }) {
            continue;
        }
        let applied = pencil.apply(pair.s, &pair.x);
        applied.force.iter().enumerate().for_each(|(i, f)| force.set(i, j, f.to_f64()));
        for i in 0..basis.rigid() {
            rigid.set(i, j, rigid_residual(basis, pair.s, &applied, i).unwrap_or(Complex::ZERO));
        }
    }
    let mut residual = force.times(View::of(&basis.shapes).transpose());
    for j in 0..pairs.len() {
        (0..basis.rigid()).for_each(|i| residual.set(i, j, rigid.at(i, j)));
    }
    residual
}

/// dy and ds of each column.
fn corrections(y: &ComplexColumns, u: &ComplexColumns, v: &ComplexColumns) -> (ComplexColumns, Vec<Complex<f64>>) {
    let n = y.re.rows();
    let product =
        |a: &ComplexColumns, j: usize| (0..n).fold(Complex::ZERO, |sum, i| sum + y.at(i, j).conj() * a.at(i, j));
    let mut dy = ComplexColumns::zeros(n, y.columns());
    let mut list = Vec::with_capacity(y.columns());
    for j in 0..y.columns() {
        let ds = -(product(u, j) * product(v, j).recip());
        (0..n).for_each(|i| dy.set(i, j, -u.at(i, j) - v.at(i, j) * ds));
        list.push(ds);
    }
    (dy, list)
}

/// Scales each column so that its largest entry is one.
fn normalise(mut y: ComplexColumns) -> ComplexColumns {
    let sizes: Vec<f64> = (0..y.columns()).map(|j| column_norm(&y, j)).collect();
    y.scale(|j| Complex::real(1.0 / sizes[j]));
    y
}

fn column_norm(y: &ComplexColumns, j: usize) -> f64 {
    let column: Vec<Complex<f64>> = (0..y.re.rows()).map(|i| y.at(i, j)).collect();
    norm(&column)
}

/// The pairs at the starts, x = Phi y.
fn expand(basis: &Basis, starts: &[Complex<f64>], y: &ComplexColumns) -> Vec<Pair> {
    let x = y.times(View::of(&basis.shapes));
    let words = |m: &Matrix<f64>, j: usize| m.column(j).iter().map(|&x| Dd::from(x)).collect::<Vec<Dd>>();
    let pair = |(j, &s): (usize, &Complex<f64>)| {
        let im = if s.im == 0.0 { Vec::new() } else { words(&x.im, j) };
        Pair { s: s.into(), x: Vector { re: words(&x.re, j), im } }
    };
    starts.iter().enumerate().map(pair).collect()
}

fn apply(pair: &mut Pair, dx: &ComplexColumns, ds: Complex<f64>, j: usize) {
    for i in 0..pair.x.re.len() {
        pair.x.add(i, dx.at(i, j));
    }
    pair.s = pair.s + ds.into();
    if pair.is_real() {
        pair.s.im = Dd::ZERO;
    }
}
