//! Refines all pairs together, each along all others. In: pencil, modal basis, starting values with some digits. Out:
//! pairs in double-double, for a few products of matrices.
//!
//! With the columns z_i = (x_i, s_i x_i) and B, R of the discs, Z^T L(s_j) Z = B (s_j - D) + R. To first order B is
//! diagonal, so z_j + sum e_ij z_i solves L(s_j) z = 0 with
//!   e_ij = -x_i^T Q(s_j) x_j / (B_ii (s_j - s_i)), B_ii = x_i^T (2 s_i M + C) x_i,
//! and s_j takes the step of its Rayleigh quotient. The error after a step is the product of the previous errors of j
//! and of the others: eight digits become sixteen and then thirty. See docs/method/poles.md#general-systems.

use crate::analysis::poles::batch::displacements;
use crate::analysis::poles::companion::{Basis, Starts};
use crate::analysis::poles::pencil::{Pencil, Vector};
use crate::analysis::poles::refinement::{Pair, refine, rigid_residual};
use crate::analysis::poles::schur::ComplexColumns;
use crate::base::{Dd, larger};
use crate::kernel::complex::Complex;
use crate::kernel::cores::in_pieces;
use crate::kernel::dense::Matrix;
use crate::kernel::dense::lu::Lu;
use crate::kernel::dense::product::{View, product};

/// Two steps are usual.
const MOST_STEPS: usize = 6;
/// A step is computed in binary64 from residuals in double-double; it gains at most this much.
const CONTRACTION: f64 = 1e-12;
/// Vectors of this relative error are good enough: the radius of a disc is quadratic in it.
const ENOUGH: f64 = 1e-26;
/// A value farther from its pole than this is not a usable start.
const FAR: f64 = 0.3;
/// One pair in this many may be refined by itself.
const FEW_LOST: usize = 16;
/// Poles nearer to each other than this (relative) are not separated along each other's vectors.
const CLOSE: f64 = 1e-8;

/// The number of pairs whose residuals take half a millisecond: with a smaller share, another core is not worth its start.
pub fn least_pairs(coordinates: usize) -> usize {
    (1usize << 12).div_ceil(coordinates.max(1))
}

/// The data of one pair that a step needs.
struct Residual {
    /// Q(s) x
    force: Vec<Complex<f64>>,
    /// The rows of rigid motions, as in `refinement`.
    rigid: Vec<Complex<f64>>,
    /// The step of the Rayleigh quotient.
    step: Complex<f64>,
    /// x^T (2 s M + C) x
    slope: Complex<f64>,
}

/// Refines all starts; those few that do not converge are refined one by one. `None` if many do not.
pub fn refine_together(pencil: &Pencil<Dd>, basis: &Basis, starts: &Starts) -> Option<Vec<Pair>> {
    let mut pairs = expand(basis, starts);
    let drag = drag(basis)?;
    let mut slopes = vec![Complex::ZERO; pairs.len()];
    let mut last = vec![FAR; pairs.len()];
    let (mut moving, mut lost): (Vec<usize>, Vec<usize>) = ((0..pairs.len()).collect(), Vec::new());
    for _ in 0..MOST_STEPS {
        let residuals = in_pieces(&moving, least_pairs(pencil.n), 1, |some| {
            some.iter().map(|&j| residual(pencil, basis, &pairs[j])).collect()
        });
        moving.iter().zip(&residuals).for_each(|(&j, residual)| slopes[j] = residual.slope);
        let vectors = vectors(&pairs);
        let mut dx = along_others(&vectors, &slopes, &pairs, &moving, &residuals);
        add_rigid(basis, drag.as_ref(), &residuals, &mut dx);
        let step = |column: usize, j: usize| {
            let size = size(&dx, column) / size(&vectors, j);
            larger(size, residuals[column].step.abs() / pairs[j].s.to_f64().abs())
        };
        let steps: Vec<f64> = moving.iter().enumerate().map(|(column, &j)| step(column, j)).collect();
        // The error of the other vectors remains in the step along them.
        let others = steps.iter().copied().filter(|&step| step < FAR).fold(CONTRACTION, f64::max);
        let mut still = Vec::new();
        for (column, &j) in moving.iter().enumerate() {
            let step = steps[column];
            let converges = step < last[j] || step < ENOUGH;
            if !converges {
                lost.push(j);
                continue;
            }
            apply(&mut pairs[j], &dx, column, residuals[column].step);
            last[j] = step;
            if step * others > ENOUGH {
                still.push(j);
            }
        }
        moving = still;
        if moving.is_empty() {
            break;
        }
    }
    lost.extend(moving);
    if lost.len() * FEW_LOST > pairs.len() {
        return None;
    }
    for j in lost {
        pairs[j] = refine(pencil, basis, starts.values[j], j)?;
    }
    Some(pairs)
}

/// The pairs at the starts, x = Phi y.
fn expand(basis: &Basis, starts: &Starts) -> Vec<Pair> {
    let y = displacements(basis, &starts.values, &starts.states);
    let x = y.times(View::of(&basis.shapes));
    let scale = |j: usize| {
        let size = size(&x, j);
        // Multiplying by a power of two causes no rounding.
        1.0 / f64::from_bits(size.to_bits() & f64::INFINITY.to_bits())
    };
    let words = |m: &Matrix<f64>, j: usize| {
        let scale = scale(j);
        m.column(j).iter().map(|&x| Dd::from(x * scale)).collect::<Vec<Dd>>()
    };
    let pair = |(j, &s): (usize, &Complex<f64>)| {
        let im = if s.im == 0.0 { Vec::new() } else { words(&x.im, j) };
        Pair { s: s.into(), x: Vector { re: words(&x.re, j), im } }
    };
    starts.values.iter().enumerate().map(pair).collect()
}

/// The largest entry of a column.
fn size(x: &ComplexColumns, j: usize) -> f64 {
    let sizes = x.re.column(j).iter().zip(x.im.column(j)).map(|(re, im)| re.abs() + im.abs());
    sizes.fold(0.0, |m, x| if x <= m { m } else { x })
}

fn residual(pencil: &Pencil<Dd>, basis: &Basis, pair: &Pair) -> Residual {
    let applied = pencil.apply(pair.s, &pair.x);
    let slope = pencil.slope(pair.s.to_f64(), &applied);
    Residual {
        force: applied.force.iter().map(|f| f.to_f64()).collect(),
        rigid: (0..basis.rigid()).filter_map(|i| rigid_residual(basis, pair.s, &applied, i)).collect(),
        step: -(applied.energy.to_f64() * slope.recip()),
        slope,
    }
}

/// The vectors in binary64.
fn vectors(pairs: &[Pair]) -> ComplexColumns {
    let n = pairs.first().map_or(0, |pair| pair.x.re.len());
    let part = |x: &[Dd], i: usize| x.get(i).map_or(0.0, |x| x.hi);
    ComplexColumns {
        re: Matrix::from_fn(n, pairs.len(), |i, j| part(&pairs[j].x.re, i)),
        im: Matrix::from_fn(n, pairs.len(), |i, j| part(&pairs[j].x.im, i)),
    }
}

/// sum e_ij x_i over all pairs i and their conjugates, a column for each pair j that moves.
fn along_others(
    x: &ComplexColumns,
    slopes: &[Complex<f64>],
    pairs: &[Pair],
    moving: &[usize],
    residuals: &[Residual],
) -> ComplexColumns {
    let force = |part: fn(&Complex<f64>) -> f64| {
        Matrix::from_fn(x.re.rows(), moving.len(), |i, column| part(&residuals[column].force[i]))
    };
    let (f_re, f_im) = (force(|f| f.re), force(|f| f.im));
    let times = |a: &Matrix<f64>, b: &Matrix<f64>| product(View::of(a).transpose(), View::of(b));
    let (rr, ii, ri, ir) = (times(&x.re, &f_re), times(&x.im, &f_im), times(&x.re, &f_im), times(&x.im, &f_re));
    let s: Vec<Complex<f64>> = pairs.iter().map(|pair| pair.s.to_f64()).collect();
    let inverse_slopes: Vec<Complex<f64>> = slopes.iter().map(|slope| slope.recip()).collect();
    // The sum over i and its conjugate, e x + e' conj(x), has the parts below.
    let zeros = || Matrix::fill_with(pairs.len(), moving.len(), 0.0);
    let (mut plus_re, mut minus_im, mut plus_im, mut minus_re) = (zeros(), zeros(), zeros(), zeros());
    for (column, &j) in moving.iter().enumerate() {
        for (i, (&other, inverse_slope)) in s.iter().zip(&inverse_slopes).enumerate() {
            let at = (i, column);
            let direct = if i == j {
                Complex::ZERO
            } else {
                let product = Complex::new(rr[at] - ii[at], ri[at] + ir[at]);
                factor(product * *inverse_slope, s[j], other)
            };
            let mirrored = if other.im == 0.0 {
                Complex::ZERO
            } else {
                let product = Complex::new(rr[at] + ii[at], ri[at] - ir[at]);
                factor(product * inverse_slope.conj(), s[j], other.conj())
            };
            (plus_re[at], minus_im[at]) = (direct.re + mirrored.re, direct.im - mirrored.im);
            (plus_im[at], minus_re[at]) = (direct.im + mirrored.im, direct.re - mirrored.re);
        }
    }
    let through = |a: &Matrix<f64>, b: &Matrix<f64>| product(View::of(a), View::of(b));
    let (mut re, mut im) = (through(&x.re, &plus_re), through(&x.re, &plus_im));
    let (im_im, im_re) = (through(&x.im, &minus_im), through(&x.im, &minus_re));
    re.data_mut().iter_mut().zip(im_im.data()).for_each(|(x, y)| *x -= y);
    im.data_mut().iter_mut().zip(im_re.data()).for_each(|(x, y)| *x += y);
    ComplexColumns { re, im }
}

/// -product / (s - other); zero along a pole that cannot be distinguished from s.
fn factor(product: Complex<f64>, s: Complex<f64>, other: Complex<f64>) -> Complex<f64> {
    let gap = s - other;
    if gap.one_norm() <= CLOSE * s.one_norm() {
        return Complex::ZERO;
    }
    let scale = -1.0 / gap.re.mul_add(gap.re, gap.im * gap.im);
    (product * gap.conj()).scale(scale)
}

/// C among the dragged motions, factored; `None` in place of the outer option if it is singular.
fn drag(basis: &Basis) -> Option<Option<Lu<f64>>> {
    if basis.dragged == 0 {
        return Some(None);
    }
    let c = Matrix::from_fn(basis.dragged, basis.dragged, |i, j| basis.damping[(basis.free + i, basis.free + j)]);
    Lu::of(c).map(Some)
}

/// Adds the parts along rigid motions N: N^T M x = 0 for free ones, N^T (s M + C) x = 0 for dragged ones.
fn add_rigid(basis: &Basis, drag: Option<&Lu<f64>>, residuals: &[Residual], dx: &mut ComplexColumns) {
    for (column, residual) in residuals.iter().enumerate() {
        let mut parts: Vec<Complex<f64>> = residual.rigid.iter().map(|r| -*r).collect();
        if let Some(drag) = drag {
            let mut re: Vec<f64> = parts[basis.free..].iter().map(|z| z.re).collect();
            let mut im: Vec<f64> = parts[basis.free..].iter().map(|z| z.im).collect();
            drag.solve(&mut re);
            drag.solve(&mut im);
            for (i, (re, im)) in re.into_iter().zip(im).enumerate() {
                parts[basis.free + i] = Complex::new(re, im);
            }
        }
        for (row, part) in parts.into_iter().enumerate() {
            let shape = basis.shapes.column(row);
            dx.re.column_mut(column).iter_mut().zip(shape).for_each(|(x, n)| *x += part.re * n);
            dx.im.column_mut(column).iter_mut().zip(shape).for_each(|(x, n)| *x += part.im * n);
        }
    }
}

fn apply(pair: &mut Pair, dx: &ComplexColumns, column: usize, step: Complex<f64>) {
    for i in 0..pair.x.re.len() {
        pair.x.add(i, dx.at(i, column));
    }
    pair.s = pair.s + step.into();
    if pair.is_real() {
        pair.s.im = Dd::ZERO;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::modes;
    use crate::analysis::modes::parts::Part;
    use crate::analysis::poles::discs::discs;
    use crate::analysis::poles::rigid::RigidMotions;
    use crate::analysis::test_systems::{blank, push};
    use crate::base::{Name, Number, Words};
    use crate::system::{CoordinateId, Label, LinearSystem, Nature};

    /// A chain of n unit masses and springs, held at both ends, with C = gamma K^2: the poles are those of s^2 + gamma
    /// w^4 s + w^2 with w = 2 sin(k pi / (2 (n + 1))).
    fn chain(n: usize, gamma: &str) -> LinearSystem {
        let mut system = blank(n);
        let source = system.c.source(Label { name: Name::plain(Words::new().intern("")), motion: "" });
        for i in 0..n {
            push(&mut system.m, "1", i, None);
            push(&mut system.k, "1", i, i.checked_sub(1));
            let row = [(i.checked_sub(1), -1), (Some(i), 2), (Some(i + 1).filter(|&j| j < n), -1)];
            let row = row.into_iter().filter_map(|(j, a)| Some((CoordinateId(j? as u32), Number::from(a))));
            system.c.push(source, Nature::Property, Number::from(gamma), row.collect::<Vec<_>>());
        }
        push(&mut system.k, "1", n - 1, None);
        system
    }

    /// Lightly damped, and so that fast motions are overdamped.
    #[test]
    fn poles_are_those_of_the_closed_form() {
        let n = 40;
        for (gamma, size) in [("0.01", 0.01), ("0.7", 0.7)] {
            let system = chain(n, gamma);
            let local: Vec<u32> = (0..n as u32).collect();
            let pencil = Pencil::of(&system, &Part::whole(&system), &local);
            let (working, rigid) = (pencil.to_dd(), RigidMotions::default());
            let basis = Basis::of(&working, &modes(&system).expect("modes"), &rigid);
            let starts = basis.starts().expect("no breakdown");
            let pairs = refine_together(&working, &basis, &starts).expect("converges");
            let (discs, _) = discs(&pencil, &rigid, &pairs, 2 * n, |_| ());
            assert!(discs.iter().all(|disc| disc.clusters == [None; 2] && disc.s.re.rad < 1e-28), "{gamma}");
            for k in 1..=n {
                let w = 2.0 * libm::sin(k as f64 * std::f64::consts::PI / (2 * (n + 1)) as f64);
                let half = 0.5 * size * w.powi(4);
                let root = Complex::real(half * half - w * w).sqrt();
                // The slow one of two real poles without cancellation.
                let fast = Complex::real(-half) - root;
                for expected in [fast.conj(), (fast.recip()).scale(w * w)] {
                    let near = |disc: &&crate::analysis::poles::discs::PoleEnclosure| {
                        let z = Complex::new(disc.s.re.to_f64(), disc.s.im.to_f64());
                        (z - expected).abs() < 1e-12 * expected.abs()
                    };
                    assert!(expected.im < 0.0 || discs.iter().any(|disc| near(&disc)), "{gamma} {expected:?}");
                }
            }
        }
    }
}
