//! From a solution in binary64 to a proven one: refined in double-double, then enclosed. In: equations F(z) = 0 with a
//! symmetric derivative, and a start. Out: a box that contains exactly one solution. See docs/method/rest.md.
//!
//! With Y near the inverse of F', the Krawczyk operator m - Y F(m) + (1 - Y F'(Z)) (Z - m) maps the box Z around m into
//! its interior only if Z contains exactly one solution (R. Krawczyk, *Newton-Algorithmen zur Bestimmung von Nullstellen
//! mit Fehlerschranken*, Computing 4 (1969) 187-201; R. E. Moore, *A test for existence of solutions to nonlinear
//! systems*, SIAM J. Numer. Anal. 14 (1977) 611-615). F'(Z) and F(m) are evaluated in ball arithmetic.

use super::proof::{Proven, Reached};
use crate::base::number::jet;
use crate::base::number::series::{ORDER, Series};
use crate::base::{Ball, Dd, Jet, Number, up};
use crate::kernel::dense::Matrix;
use crate::kernel::dense::enclosure::{product, solve};
use nalgebra::{DMatrix, DVector};

/// Equations F(z) = 0 with a current box of z.
pub trait Equations {
    /// Puts z at these middles with these radii.
    fn place(&mut self, middle: &[Dd], radius: &dyn Fn(usize) -> f64);

    /// F over the box.
    fn remaining_forces(&self) -> Vec<Number>;

    /// F' over the box: binary64 numbers, and bounds of their errors.
    fn slope(&self) -> (DMatrix<f64>, DMatrix<f64>);
}

/// Equations that are known along series in a parameter that is a range.
pub trait Along: Equations {
    /// Puts z along these series.
    fn place_along(&mut self, z: &[Series]);

    /// The coefficients of F', each as [`Equations::slope`] is; the first one holds what the series leave out.
    fn slope_along(&self) -> Option<Vec<Part>>;
}

/// Binary64 numbers, and bounds of their errors.
pub type Part = (DMatrix<f64>, DMatrix<f64>);

/// An approximate inverse of the derivative, and the motions that it leaves out because nothing restrains them.
pub struct Inverse {
    y: DMatrix<f64>,
    neutral: DMatrix<f64>,
}

/// What is known about solutions over ranges of parameters.
pub struct Enclosed {
    pub proven: Proven,
    /// Whether the search from z = 0 ends in them.
    pub reached: Option<Reached>,
}

/// Limit on the refinements: each gains the sixteen digits of binary64, less those lost to the conditioning.
pub const MAX_REFINEMENTS: usize = 8;
/// Steps are measured relative to the solution, or to this if the solution is smaller.
pub const NEAR: f64 = 1e-9;
/// How often the enclosure over ranges is replaced by its image.
const NARROWED: usize = 2;
/// What the stiffness in the middle is divided by before others are compared with it, for it may be the most or the least of those on the
/// way, and by how much these may differ from it.
const TRIED: [(f64, f64); 4] = [(1.0, 0.25), (1.0, 0.3), (1.25, 0.25), (0.8, 0.25)];
/// A lower bound of the eigenvalues of the inverse with its diagonal scaled to 1: a stiffness near it is factored, without a shift, by
/// the search too.
const WELL_CONDITIONED: f64 = 1e-8;

impl Inverse {
    /// `None` if numbers leave the range of binary64. `scale` makes rows of different magnitude comparable, so that a row
    /// that is small only because of its units does not count as singular.
    pub fn of(slope: &DMatrix<f64>, scale: &[f64]) -> Option<Inverse> {
        let n = scale.len();
        let scaled = DMatrix::from_fn(n, n, |i, j| slope[(i, j)] * scale[i] * scale[j]);
        let (inverse, neutral) = approximate_inverse(scaled)?;
        let y = DMatrix::from_fn(n, n, |i, j| inverse[(i, j)] * scale[i] * scale[j]);
        let neutral = DMatrix::from_fn(n, neutral.ncols(), |i, j| neutral[(i, j)] * scale[i]);
        y.iter().all(|entry| entry.is_finite()).then_some(Inverse { y, neutral })
    }

    /// Whether there are motions that nothing restrains.
    pub fn is_singular(&self) -> bool {
        self.neutral.ncols() > 0
    }

    /// Newton steps until they bring no gain; returns the relative size of the last one.
    pub fn refine(&self, equations: &mut impl Equations, middle: &mut [Dd]) -> f64 {
        let mut last = f64::INFINITY;
        for _ in 0..MAX_REFINEMENTS {
            equations.place(middle, &|_| 0.0);
            let step = self.apply(&equations.remaining_forces());
            let size =
                step.iter().zip(middle.iter()).map(|(step, at)| step.abs() / at.hi.abs().max(NEAR)).fold(0.0, f64::max);
            if size >= last {
                break;
            }
            last = size;
            for (at, step) in middle.iter_mut().zip(&step) {
                *at -= Dd::from(*step);
            }
        }
        last
    }

    /// Removes the drift along motions that nothing restrains: the rest nearest to the drawing is wanted.
    pub fn without_drift(&self, middle: &mut [Dd]) {
        let Some(inverse) = (self.neutral.transpose() * &self.neutral).try_inverse() else { return };
        let at = DVector::from_iterator(middle.len(), middle.iter().map(|at| at.to_f64()));
        let drift = &self.neutral * (inverse * (self.neutral.transpose() * at));
        for (at, drift) in middle.iter_mut().zip(drift.iter()) {
            *at -= Dd::from(*drift);
        }
    }

    /// Y F, in binary64.
    fn apply(&self, left: &[Number]) -> Vec<f64> {
        let left = DVector::from_iterator(left.len(), left.iter().map(|force| force.enclosure().to_f64()));
        (&self.y * left).iter().copied().collect()
    }

    /// Finds radii that the Krawczyk operator maps into themselves; leaves the equations at that box.
    pub fn prove(&self, equations: &mut impl Equations, middle: &[Dd]) -> Option<Proven> {
        equations.place(middle, &|_| 0.0);
        let left: Vec<Ball> = equations.remaining_forces().iter().map(Number::to_ball).collect();
        self.enclose(equations, middle, &left).map(|(proven, _)| proven)
    }

    /// Encloses the solution for all values of the parameters that are ranges, and its derivative; leaves the equations at that box.
    pub fn prove_over_ranges(&self, equations: &mut impl Equations, middle: &[Dd]) -> Option<(Enclosed, Vec<Jet>)> {
        equations.place(middle, &|_| 0.0);
        let left: Vec<Ball> = equations.remaining_forces().iter().map(Number::enclosure).collect();
        let (proven, mut radius) = self.enclose(equations, middle, &left)?;
        let defect: Vec<f64> = (0..middle.len()).map(|i| self.defect(i, &left)).collect();
        // The solutions lie in the image of the box, so also in the image of that.
        for _ in 0..NARROWED {
            equations.place(middle, &|i| radius[i]);
            let mapped = self.map_bound(&[equations.slope()], &defect, &radius);
            radius.iter_mut().zip(mapped).for_each(|(radius, mapped)| *radius = radius.min(mapped));
        }
        let reached = jet::without_division(|| {
            equations.place(&vec![Dd::ZERO; middle.len()], &|_| 0.0);
            let drawn: Vec<Ball> = equations.remaining_forces().iter().map(Number::enclosure).collect();
            let away: Vec<f64> = middle.iter().map(|at| at.hi.abs() * up::FEW).collect();
            self.reach(&drawn, &away, &radius, |region| {
                equations.place(middle, &|i| region[i]);
                Some(vec![equations.slope()])
            })
        });
        equations.place(middle, &|i| radius[i]);
        // F_z z' = -F_p, with the inverse taken to the left.
        let n = middle.len();
        let (slope, spread) = equations.slope();
        let y = Matrix::from_fn(n, n, |i, j| Ball::from(self.y[(i, j)]));
        let nearly_one = product(&y, &Matrix::from_fn(n, n, |i, j| Ball::new(Dd::from(slope[(i, j)]), spread[(i, j)])));
        let forces: Vec<Ball> = equations.remaining_forces().iter().map(|force| -Jet::of(force).slope).collect();
        let moved = solve(&nearly_one, &product(&y, &Matrix::from_fn(n, 1, |i, _| forces[i])))?;
        let jets = (0..n).map(|i| Jet { value: Ball::new(middle[i], radius[i]), slope: moved[(i, 0)] }).collect();
        Some((Enclosed { proven, reached: reached.flatten() }, jets))
    }

    /// Encloses the solution z(p) for all values p of a parameter by series with tubes around them: for each p, in the box of the radii around
    /// the polynomial, the operator has the one fixed point of a box that it maps into its interior. As all is about one p, what moves with
    /// it cancels: the derivative, with Y to the left, has to change by less than itself, however far the solution moves.
    pub fn prove_along(&self, equations: &mut impl Along, middle: &[Dd]) -> Option<(Enclosed, Vec<Series>)> {
        let mut found: Vec<Series> = middle.iter().map(|at| Series::constant(Ball::exact(*at))).collect();
        // Each Newton step with the one Y makes one more coefficient right.
        for _ in 0..=ORDER {
            equations.place_along(&found);
            let steps = self.apply_along(&equations.remaining_forces())?;
            let mut is_last = true;
            for (z, step) in found.iter_mut().zip(steps) {
                is_last &= step.magnitude() <= Dd::EPSILON * z.magnitude();
                z.terms = z.plus(&step.times_number(-1.0)).terms.map(|term| Ball::exact(term.mid));
            }
            if is_last {
                break;
            }
        }
        equations.place_along(&found);
        let defect: Vec<f64> = self.apply_along(&equations.remaining_forces())?.iter().map(Series::magnitude).collect();
        let least = |at: usize| middle[at].hi.abs() * Dd::EPSILON + f64::MIN_POSITIVE;
        let mut radius: Vec<f64> = defect.iter().enumerate().map(|(at, defect)| 2.0 * defect + least(at)).collect();
        for _ in 0..6 {
            found.iter_mut().zip(&radius).for_each(|(z, radius)| z.rest = *radius);
            equations.place_along(&found);
            let mapped = self.map_bound(&equations.slope_along()?, &defect, &radius);
            if let Some(proven) = Proven::inclusion(&mapped, &radius) {
                let reached = jet::without_division(|| self.reach_along(equations, &found, &radius)).flatten();
                return Some((Enclosed { proven, reached }, found));
            }
            for (radius, mapped) in radius.iter_mut().zip(&mapped) {
                *radius = 4.0 * mapped.max(*radius);
            }
        }
        None
    }

    /// Whether the search from z = 0 ends in the solutions in these tubes.
    fn reach_along(&self, equations: &mut impl Along, found: &[Series], tube: &[f64]) -> Option<Reached> {
        equations.place(&vec![Dd::ZERO; found.len()], &|_| 0.0);
        let drawn: Vec<Ball> = equations.remaining_forces().iter().map(Number::enclosure).collect();
        let away: Vec<f64> = found.iter().map(Series::magnitude).collect();
        self.reach(&drawn, &away, tube, |region| {
            let mut region_along = found.to_vec();
            region_along.iter_mut().zip(region).for_each(|(z, radius)| z.rest = *radius);
            equations.place_along(&region_along);
            equations.slope_along()
        })
    }

    /// Proves that the search from z = 0 ends in the solutions that are enclosed. In: F at z = 0, how far from there the middle of
    /// the enclosure may be, its radii, and what gives F' within other radii. See docs/method/rest.md#where-the-search-ends.
    fn reach(
        &self,
        drawn: &[Ball],
        away: &[f64],
        tube: &[f64],
        mut slope_within: impl FnMut(&[f64]) -> Option<Vec<Part>>,
    ) -> Option<Reached> {
        let y = (&self.y + self.y.transpose()) * 0.5;
        if self.is_singular() || !is_positive_definite(&y, WELL_CONDITIONED) {
            return None;
        }
        // F Y F at the drawing bounds the energy that the search can lose.
        let n = drawn.len();
        let along = |i: usize| (0..n).map(|j| drawn[j] * Ball::from(y[(i, j)])).fold(Ball::ZERO, |sum, x| sum + x);
        let square = (0..n).map(|i| drawn[i] * along(i)).fold(Ball::ZERO, |sum, x| sum + x).magnitude();
        TRIED.iter().find_map(|&(weight, change)| {
            let distance = (weight * square).sqrt() / (1.0 - change);
            let unit: Vec<f64> = (0..n).map(|i| (weight * y[(i, i)]).sqrt()).collect();
            let far = Reached::reach_of_steps(change) * distance;
            let region: Vec<f64> = tube.iter().zip(&unit).map(|(tube, unit)| (tube + far * unit) * up::FEW).collect();
            // The way from the drawing has to lie in it.
            if away.iter().zip(&region).any(|(away, region)| away > region) {
                return None;
            }
            let symmetric = Inverse { y: &y * weight, neutral: self.neutral.clone() };
            let changes = symmetric.map_bound(&slope_within(&region)?, &vec![0.0; n], &unit);
            Reached::by_convexity(change, &changes, &unit)
        })
    }

    /// Y F as series, if all of F is known as one.
    fn apply_along(&self, left: &[Number]) -> Option<Vec<Series>> {
        let left: Vec<Series> = left.iter().map(Series::of).collect::<Option<_>>()?;
        let row = |i: usize| {
            let parts = left.iter().enumerate().map(|(j, force)| force.times_number(self.y[(i, j)]));
            parts.fold(Series::constant(Ball::ZERO), |sum, part| sum.plus(&part))
        };
        Some((0..left.len()).map(row).collect())
    }

    /// The proof, and the radii of the image of the box that it is about.
    fn enclose(&self, equations: &mut impl Equations, middle: &[Dd], left: &[Ball]) -> Option<(Proven, Vec<f64>)> {
        let n = middle.len();
        let defect: Vec<f64> = (0..n).map(|i| self.defect(i, left)).collect();
        let mut radius: Vec<f64> =
            (0..n).map(|i| 2.0 * defect[i] + middle[i].hi.abs() * Dd::EPSILON + f64::MIN_POSITIVE).collect();
        for _ in 0..6 {
            equations.place(middle, &|i| radius[i]);
            let mapped = self.map_bound(&[equations.slope()], &defect, &radius);
            if let Some(proven) = Proven::inclusion(&mapped, &radius) {
                return Some((proven, mapped));
            }
            for (radius, mapped) in radius.iter_mut().zip(&mapped) {
                *radius = 4.0 * mapped.max(*radius);
            }
        }
        None
    }

    /// An upper bound of |Y F|_i.
    fn defect(&self, i: usize, left: &[Ball]) -> f64 {
        let products = left.iter().enumerate().map(|(j, force)| *force * Ball::from(self.y[(i, j)]));
        products.fold(Ball::ZERO, |sum, product| sum + product).magnitude()
    }

    /// An upper bound of |Y F| + |1 - Y F'(Z)| r, including rounding errors. F' is a sum of coefficients, all but the first of which are
    /// multiplied by numbers of at most 1 in size.
    fn map_bound(&self, parts: &[Part], defect: &[f64], radius: &[f64]) -> Vec<f64> {
        let n = radius.len();
        let radii = DVector::from_column_slice(radius);
        let mut wrong = DMatrix::zeros(n, n);
        for (at, (middle, spread)) in parts.iter().enumerate() {
            let product = &self.y * middle;
            let sizes = self.y.abs() * (middle.abs() * ((n + 2) as f64 * f64::EPSILON) + spread);
            wrong += DMatrix::from_fn(n, n, |i, j| {
                let identity = if i == j && at == 0 { 1.0 } else { 0.0 };
                (identity - product[(i, j)]).abs() * (1.0 + f64::EPSILON) + sizes[(i, j)]
            });
        }
        // Sums of n positive numbers: each is right to n roundings, which the factor covers for all n that are dense.
        (wrong * radii).iter().zip(defect).map(|(moved, defect)| (moved + defect) * up::THOUSANDS).collect()
    }
}

/// Whether all eigenvalues of a symmetric matrix with its diagonal scaled to 1 are certainly above a number: lessened by that and by
/// more than what rounding does to Cholesky's factors, these exist (S. M. Rump, *Verification of positive definiteness*, BIT 46 (2006)
/// 433-452).
fn is_positive_definite(matrix: &DMatrix<f64>, least: f64) -> bool {
    let n = matrix.nrows();
    let lessened = (1.0 - least - 4.0 * f64::EPSILON * ((n + 2) * (n + 2)) as f64).max(0.0);
    let scale = matrix.diagonal().map(|entry| entry.sqrt().recip());
    let scaled = DMatrix::from_fn(n, n, |i, j| match i == j {
        true => lessened,
        false => matrix[(i, j)] * scale[i] * scale[j],
    });
    scale.iter().all(|scale| scale.is_finite()) && scaled.cholesky().is_some()
}

/// The inverse; if the matrix is singular to working precision, the inverse of its regular part, and the motions that
/// nothing restrains.
fn approximate_inverse(matrix: DMatrix<f64>) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
    let n = matrix.nrows();
    if let Some(inverse) = matrix.clone().try_inverse() {
        let wrong = (&inverse * &matrix - DMatrix::identity(n, n)).amax();
        if wrong < 0.1 {
            return Some((inverse, DMatrix::zeros(n, 0)));
        }
    }
    let eigen = matrix.try_symmetric_eigen(f64::EPSILON, 0)?;
    // Below this, an eigenvalue is the rounding error of a few hundred sums.
    let least = 1e-12 * eigen.eigenvalues.amax();
    let inverse = eigen.eigenvalues.map(|value| if value.abs() > least { value.recip() } else { 0.0 });
    let neutral: Vec<usize> = (0..n).filter(|&i| eigen.eigenvalues[i].abs() <= least).collect();
    let inverse = &eigen.eigenvectors * DMatrix::from_diagonal(&inverse) * eigen.eigenvectors.transpose();
    Some((inverse, eigen.eigenvectors.select_columns(&neutral)))
}

/// A symmetric matrix given by entries of one triangle, each pair once, places may repeat: binary64 numbers and bounds of
/// their errors. Derivatives are lost, where there are some.
pub fn dense<'a>(entries: impl IntoIterator<Item = (u32, u32, &'a Number)>, n: usize) -> (DMatrix<f64>, DMatrix<f64>) {
    dense_as(Number::to_ball, entries, n)
}

/// The same over ranges of parameters, whose derivatives are known from elsewhere.
pub fn dense_over_ranges<'a>(
    entries: impl IntoIterator<Item = (u32, u32, &'a Number)>,
    n: usize,
) -> (DMatrix<f64>, DMatrix<f64>) {
    dense_as(Number::enclosure, entries, n)
}

/// The coefficients of the same along series, if all entries have one.
pub fn dense_along<'a>(entries: impl IntoIterator<Item = (u32, u32, &'a Number)>, n: usize) -> Option<Vec<Part>> {
    let sums = sum_of_entries(entries, n).iter().map(Series::of).collect::<Option<Vec<Series>>>()?;
    let at = |i: usize, j: usize| &sums[i.max(j) * n + i.min(j)];
    let part = |k: usize| {
        let middle = DMatrix::from_fn(n, n, |i, j| at(i, j).terms[k].mid.hi);
        let spread = DMatrix::from_fn(n, n, |i, j| {
            let (series, term) = (at(i, j), at(i, j).terms[k]);
            (term.mid.lo.abs() + term.rad + if k == 0 { series.rest } else { 0.0 }) * up::FEW
        });
        (middle, spread)
    };
    let count = sums.iter().map(Series::count).max()?.max(1);
    Some((0..count).map(part).collect())
}

/// The lower triangle, row by row.
fn sum_of_entries<'a>(entries: impl IntoIterator<Item = (u32, u32, &'a Number)>, n: usize) -> Vec<Number> {
    let mut sums = vec![Number::ZERO; n * n];
    for (i, j, value) in entries {
        let sum = &mut sums[i.max(j) as usize * n + i.min(j) as usize];
        *sum = &*sum + value;
    }
    sums
}

fn dense_as<'a>(
    ball: fn(&Number) -> Ball,
    entries: impl IntoIterator<Item = (u32, u32, &'a Number)>,
    n: usize,
) -> (DMatrix<f64>, DMatrix<f64>) {
    let sums = sum_of_entries(entries, n);
    let at = |i: usize, j: usize| ball(&sums[i.max(j) * n + i.min(j)]);
    let middle = DMatrix::from_fn(n, n, |i, j| at(i, j).mid.hi);
    // The low part of the middle, and the radius.
    let spread = DMatrix::from_fn(n, n, |i, j| {
        let ball = at(i, j);
        (ball.mid.lo.abs() + ball.rad) * up::FEW
    });
    (middle, spread)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// z^2 = c.
    struct Square {
        c: Number,
        z: Number,
    }

    impl Equations for Square {
        fn place(&mut self, middle: &[Dd], radius: &dyn Fn(usize) -> f64) {
            self.z = Number::Ball(Ball::new(middle[0], radius(0)));
        }

        fn remaining_forces(&self) -> Vec<Number> {
            vec![&(&self.z * &self.z) - &self.c]
        }

        fn slope(&self) -> (DMatrix<f64>, DMatrix<f64>) {
            let twice = &self.z + &self.z;
            dense([(0, 0, &twice)], 1)
        }
    }

    impl Along for Square {
        fn place_along(&mut self, z: &[Series]) {
            self.z = z[0].clone().into_number();
        }

        fn slope_along(&self) -> Option<Vec<Part>> {
            dense_along([(0, 0, &(&self.z + &self.z))], 1)
        }
    }

    /// The root of z^2 = p for all p within `reach` of `middle`, from a start that may be far from it.
    fn root_along(middle: f64, reach: f64, start: f64) -> Option<Series> {
        let c = Jet::of_parameter_in_series(Ball::from(middle), reach);
        let mut square = Square { c, z: Number::Ball(Ball::from(start)) };
        let inverse = Inverse::of(&square.slope().0, &[1.0]).expect("finite");
        Some(inverse.prove_along(&mut square, &[Dd::from(start)])?.1.remove(0))
    }

    #[test]
    fn a_root_that_moves_with_a_parameter_is_in_its_tube() {
        for (middle, reach, most) in [(3.0, 1e-6, 1e-28), (3.0, 0.125, 1e-14), (3.0, 1.0, 1e-4)] {
            let found = root_along(middle, reach, 1.73205080756887).expect("a tube");
            assert!(found.rest < most, "{reach}: {:e}", found.rest);
            for x in [-1.0, -0.5, 0.0, 0.75, 1.0] {
                let truth = (Ball::from(middle) + Ball::from(x) * Ball::from(reach)).sqrt();
                assert!((found.at(Ball::from(x)) - truth).contains_zero(), "{reach} {x}");
                let polynomial = Series { rest: 0.0, ..found.clone() }.at(Ball::from(x)) - truth;
                assert!(polynomial.mignitude() <= found.rest);
            }
        }
        // Where roots meet within the range, or there is none, nothing is proved.
        for (middle, reach) in [(0.125, 0.25), (0.25, 0.25), (-3.0, 0.125)] {
            assert_eq!(root_along(middle, reach, 0.5), None, "{middle} {reach}");
        }
    }

    /// Whether the root of z^2 = c near a start is proven, and the final box.
    fn solve_case(c: &str, start: f64) -> (bool, Ball) {
        let c = match c.strip_prefix('-') {
            Some(c) => -&Number::from(c),
            None => Number::from(c),
        };
        let mut square = Square { c, z: Number::ZERO };
        let mut middle = [Dd::from(start)];
        square.place(&middle, &|_| 0.0);
        let inverse = Inverse::of(&square.slope().0, &[1.0]).expect("finite");
        inverse.refine(&mut square, &mut middle);
        let proven = inverse.prove(&mut square, &middle).is_some();
        (proven, square.z.to_ball())
    }

    #[test]
    fn a_simple_root_is_in_its_box() {
        for (c, start) in [("3", 1.7320508), ("0.3", 0.547722557), ("1e-10", 1.0000001e-5)] {
            let (proven, z) = solve_case(c, start);
            assert!(proven && z.rad < 1e-25 * z.mid.hi && z.rad > 0.0, "{c}: {z:?}");
            // The squares of the two ends are on different sides of c.
            let end = |side: f64| Number::Ball(Ball::exact(z.mid + Dd::from(side * z.rad)));
            let beyond = |side: f64| &(&end(side) * &end(side)) - &Number::from(c);
            assert!(beyond(1.0).is_positive() && beyond(-1.0).is_negative(), "{c}");
        }
    }

    /// A double root, and no root at all: a derivative that changes its sign in the box proves nothing.
    #[test]
    fn a_double_root_and_none_are_not_proven() {
        assert!(!solve_case("0", 1e-12).0);
        for c in ["-1e-6", "-1e-14", "-1e-24"] {
            for start in [1e-3, 1e-7, 1e-12] {
                assert!(!solve_case(c, start).0, "{c} {start:e}");
            }
        }
    }

    /// A spring that softens, drawn at z = 0, free at `at` and loaded by p: F = x - x^3 - p with x = z - at. It has a rest between
    /// the hilltops at x = -1/sqrt(3) and 1/sqrt(3).
    struct Softening {
        at: Number,
        p: Number,
        z: Number,
    }

    impl Equations for Softening {
        fn place(&mut self, middle: &[Dd], radius: &dyn Fn(usize) -> f64) {
            self.z = Number::from(Jet { value: Ball::new(middle[0], radius(0)), slope: Ball::ZERO });
        }

        fn remaining_forces(&self) -> Vec<Number> {
            let x = &self.z - &self.at;
            vec![&(&x - &(&(&x * &x) * &x)) - &self.p]
        }

        fn slope(&self) -> (DMatrix<f64>, DMatrix<f64>) {
            let x = &self.z - &self.at;
            let slope = &Number::ONE - &(&Number::from("3") * &(&x * &x));
            dense_over_ranges([(0, 0, &slope)], 1)
        }
    }

    /// Downhill from the drawing the search comes to the rest if no hilltop lies between, and if none is near enough for a step to
    /// lead across. Where one is, the rest is proved, but not that the search ends there.
    #[test]
    fn the_search_ends_in_the_rest_that_no_hill_hides() {
        let ends = |at: &str, p: f64, rest: f64| {
            let range = Jet::of_parameter(Ball::new(Dd::from(p), 1e-3));
            let mut softening = Softening { at: Number::from(at), p: range, z: Number::ZERO };
            let mut middle = [Dd::from(rest)];
            softening.place(&middle, &|_| 0.0);
            let inverse = Inverse::of(&softening.slope().0, &[1.0]).expect("finite");
            inverse.refine(&mut softening, &mut middle);
            inverse.prove_over_ranges(&mut softening, &middle).expect("a rest").0.reached.is_some()
        };
        assert!(ends("0", 0.05, 0.05) && ends("0", -0.05, -0.05));
        // Beyond p = 2/(3 sqrt(3)) = 0.385 there is no rest, and the drawing leads past the hilltop.
        assert!(!ends("0", 0.37, 0.5));
        // The free place itself, with a hilltop between it and the drawing, or nearly.
        assert!(!ends("3", 0.0, 3.0) && !ends("0.6", 0.0, 0.6) && ends("0.2", 0.0, 0.2));
    }

    #[test]
    fn definite_matrices_are_told_from_others() {
        let matrix = |off: f64| DMatrix::from_row_slice(2, 2, &[4e-9, off * 6e-3, off * 6e-3, 9e3]);
        assert!([0.0, 0.5, -0.999].map(matrix).iter().all(|matrix| is_positive_definite(matrix, 0.0)));
        assert!(![1.0, -1.0, 1.5, f64::NAN].map(matrix).iter().any(|matrix| is_positive_definite(matrix, 0.0)));
        assert!(!is_positive_definite(&-matrix(0.5), 0.0));
    }

    #[test]
    fn unrestrained_motions_are_found() {
        let matrix = DMatrix::from_row_slice(2, 2, &[1.0, -1.0, -1.0, 1.0]);
        let inverse = Inverse::of(&matrix, &[1.0, 1.0]).expect("finite");
        assert!(inverse.is_singular());
        let mut middle = [Dd::from(3.0), Dd::from(1.0)];
        inverse.without_drift(&mut middle);
        assert!((middle[0] + middle[1]).abs().to_f64() < 1e-15 && (middle[0].to_f64() - 1.0).abs() < 1e-15);
    }
}
