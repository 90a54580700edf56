//! Shapes of damped motions: the complex x with (M s^2 + C s + K) x = 0, scaled so that its leading entry is 1. In: the system
//! and its poles. Out: an enclosure of each entry and each output, or the reason why there is none. See
//! docs/method/poles.md#shapes.

use crate::analysis::answer::{Pole, Poles};
use crate::analysis::modes::shape::{first_largest, translates};
use crate::analysis::transfer::Disc;
use crate::base::{Ball, Dd, Number};
use crate::kernel::complex::Complex;
use crate::kernel::dense::Matrix;
use crate::kernel::dense::enclosure::solve;
use crate::kernel::dense::lu::Lu;
use crate::system::{CoordinateId, LinearSystem, Output};

/// Number of motions whose shapes are computed, as many as a report lists.
const MOST_MOTIONS: usize = 20;
/// With more coordinates a shape would take seconds.
const MOST_COORDINATES: usize = 100;
/// Translations with less than this share of the inertia are rounding errors of a motion that only turns.
const LEAST_SHARE: f64 = 1e-12;

/// The shape of the motion with a pole.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct DampedShape {
    /// The number of the pole in the list of motions, from 1.
    pub number: usize,
    /// The entries, or why they are not known.
    pub found: Result<ShapeEntries, &'static str>,
}

/// The entries of a complex shape, of which the leading one is 1.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ShapeEntries {
    /// For each coordinate.
    pub coordinates: Vec<Disc>,
    /// For each output.
    pub outputs: Vec<Disc>,
}

/// The shapes of the damped motions, of a complex pair the one with im s > 0.
pub fn damped_shapes(system: &LinearSystem, poles: &Poles) -> Vec<DampedShape> {
    let motions = (1..).zip(poles.list.iter().filter(|pole| !pole.is_lower_half())).take(MOST_MOTIONS);
    let too_large = system.n() > MOST_COORDINATES || system.is_chained();
    let pencil = if too_large { None } else { Some(Dense::of(system)) };
    let shape = |pole: &Pole| match &pencil {
        None => Err("there are too many coordinates for enclosed shapes"),
        Some(pencil) => pencil.shape(system, pole),
    };
    motions.map(|(number, pole)| DampedShape { number, found: shape(pole) }).collect()
}

/// M, C, K and H as matrices of balls.
struct Dense {
    m: Vec<Vec<Ball>>,
    c: Vec<Vec<Ball>>,
    k: Vec<Vec<Ball>>,
    /// Of the loss factors, which act above the real axis; `None` if there are none.
    h: Option<Vec<Vec<Ball>>>,
}

impl Dense {
    fn of(system: &LinearSystem) -> Dense {
        let [m, c, k] = [&system.m, &system.c, &system.k].map(|form| form.assemble(system.n()));
        Dense { m, c, k, h: system.losses.as_ref().map(|losses| losses.h.assemble(system.n())) }
    }

    /// M s^2 + C s + K, and i H above the real axis.
    fn at(&self, s: Complex<Ball>) -> Matrix<Complex<Ball>> {
        let (n, square) = (self.m.len(), s * s);
        let lost = |i: usize, j: usize| match &self.h {
            Some(h) if s.im.is_positive() => h[i][j],
            _ => Ball::ZERO,
        };
        let stiffness = |i: usize, j: usize| Complex::new(self.k[i][j], lost(i, j));
        Matrix::from_fn(n, n, |i, j| square.scale(self.m[i][j]) + s.scale(self.c[i][j]) + stiffness(i, j))
    }

    fn shape(&self, system: &LinearSystem, pole: &Pole) -> Result<ShapeEntries, &'static str> {
        const OPEN: &str = "its shape is not determined: other motions have this pole, or one that is too close to it";
        let s = Complex::new(pole.re, pole.im);
        if !(s.re.is_finite() && s.im.is_finite()) {
            return Err("its pole has no bound");
        }
        let q = self.at(s);
        let leading = self.leading(system, &q).ok_or(OPEN)?;
        let x = with_entry_one(&q, leading).ok_or(OPEN)?;
        let lost = |output: usize| match &system.losses {
            Some(losses) if s.im.is_positive() => &losses.p[output][..],
            _ => &[],
        };
        let seen = |(number, output): (usize, &Output)| Disc::of(output_shape(output, lost(number), s, &x));
        let outputs = system.outputs.iter().enumerate().map(seen).collect();
        Ok(ShapeEntries { coordinates: x.into_iter().map(Disc::of).collect(), outputs })
    }

    /// The entry that is scaled to 1: the first of the largest translations, or of the largest rotations if nothing
    /// translates; by inverse iteration, without a bound.
    fn leading(&self, system: &LinearSystem, q: &Matrix<Complex<Ball>>) -> Option<usize> {
        let n = q.rows();
        if n == 1 {
            return Some(0);
        }
        let middle = Matrix::from_fn(n, n, |i, j| q[(i, j)].mid());
        let factored = Lu::nearly_singular(middle)?;
        // Entries in the golden ratio: no shape of a symmetric scene is orthogonal to them.
        let mut x: Vec<Complex<Dd>> =
            (0..n).map(|i| Complex::real(Dd::from(1.0 + (i as f64 * 0.618_033_988_749_895).fract()))).collect();
        for _ in 0..3 {
            factored.solve(&mut x);
            let size = x.iter().map(|x| x.to_f64().abs()).fold(0.0, f64::max);
            if !(size > 0.0 && size.is_finite()) {
                return None;
            }
            x.iter_mut().for_each(|x| *x = x.scale(Dd::from(1.0 / size)));
        }
        let sizes: Vec<f64> = x.iter().map(|x| x.to_f64().abs()).collect();
        let translates = translates(system);
        let inertia = |of: bool| -> f64 {
            let some = (0..n).filter(|&i| translates(i) == of);
            some.map(|i| self.m[i][i].to_f64().abs() * sizes[i] * sizes[i]).sum()
        };
        let by_translation =
            inertia(true) >= LEAST_SHARE * (inertia(true) + inertia(false)) && moves(&sizes, &translates);
        first_largest(&sizes, |i| translates(i) == by_translation).or_else(|| first_largest(&sizes, |_| true))
    }
}

/// Whether some translation moves.
fn moves(sizes: &[f64], translates: &impl Fn(usize) -> bool) -> bool {
    (0..sizes.len()).any(|i| translates(i) && sizes[i] > LEAST_SHARE)
}

/// The x with Q x = 0 and x_p = 1, for every Q that is singular among those enclosed: the bordered matrix [Q e_p; e_p^T 0] takes
/// (x, 0) to (0, 1), and where it is regular nothing else. `None` if that is not certain.
fn with_entry_one(q: &Matrix<Complex<Ball>>, p: usize) -> Option<Vec<Complex<Ball>>> {
    let n = q.rows();
    let size = n + 1;
    let bordered = |i: usize, j: usize| match (i < n, j < n) {
        (true, true) => q[(i, j)],
        (true, false) if i == p => Complex::real(Ball::ONE),
        (false, true) if j == p => Complex::real(Ball::ONE),
        _ => Complex::ZERO,
    };
    let real = Matrix::from_fn(2 * size, 2 * size, |i, j| {
        let entry = bordered(i % size, j % size);
        match (i < size, j < size) {
            (true, true) | (false, false) => entry.re,
            (true, false) => -entry.im,
            (false, true) => entry.im,
        }
    });
    let right = Matrix::from_fn(2 * size, 1, |i, _| if i == n { Ball::ONE } else { Ball::ZERO });
    let found = solve(&real, &right)?;
    let entry = |i: usize| match i == p {
        true => Complex::real(Ball::ONE),
        false => Complex::new(found[(i, 0)], found[(size + i, 0)]),
    };
    let x: Vec<Complex<Ball>> = (0..n).map(entry).collect();
    x.iter().all(|x| x.re.is_finite() && x.im.is_finite()).then_some(x)
}

/// sum_k s^k p_k x, and i times what loss factors add.
fn output_shape(
    output: &Output,
    lost: &[(CoordinateId, Number)],
    s: Complex<Ball>,
    x: &[Complex<Ball>],
) -> Complex<Ball> {
    let along = |row: &[(CoordinateId, Number)]| {
        row.iter().fold(Complex::ZERO, |own, (i, factor)| own + x[i.index()].scale(factor.to_ball()))
    };
    let lost = along(lost);
    let kept = output.p.iter().rev().fold(Complex::ZERO, |sum, row| sum * s + along(row));
    kept + Complex::new(-lost.im, lost.re)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::test_systems::{blank, push};
    use crate::analysis::{modes, poles};

    /// A chain of two in which the dampers are not in proportion: every shape is in the kernel of M s^2 + C s + K at its
    /// pole, and the masses are out of phase.
    #[test]
    fn shapes_satisfy_the_equations() {
        let mut system = blank(2);
        for (i, damper) in ["0.7", "0.1"].into_iter().enumerate() {
            push(&mut system.m, "1", i, None);
            push(&mut system.k, "3", i, i.checked_sub(1));
            push(&mut system.c, damper, i, None);
        }
        let poles = poles(&system, &modes(&system).expect("modes")).expect("poles");
        let upper: Vec<&Pole> = poles.list.iter().filter(|pole| !pole.is_lower_half()).collect();
        let found = damped_shapes(&system, &poles);
        assert_eq!((found.len(), upper.len()), (2, 2));
        for (shape, pole) in found.into_iter().zip(upper) {
            let x = shape.found.expect("a shape").coordinates;
            let is_one = |disc: &Disc| disc.radius == 0.0 && disc.value == Complex::real(Dd::ONE);
            assert!(x.iter().any(is_one) && x.iter().all(|disc| disc.radius < 1e-26));
            assert!(x.iter().all(|disc| disc.value.to_f64().abs() < 1.0 + 1e-9));
            assert!(x.iter().any(|disc| disc.value.im.abs().to_f64() > 1e-3));
            let q = Dense::of(&system).at(Complex::new(pole.re, pole.im));
            for i in 0..2 {
                let force = (0..2).fold(Complex::ZERO, |sum, j| sum + q[(i, j)] * x[j].value.to_ball());
                assert!(force.mid().to_f64().abs() < 1e-24, "{force:?}");
            }
        }
    }
}
