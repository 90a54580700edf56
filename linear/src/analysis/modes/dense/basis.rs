//! All modes of a system as a basis to double-double, for hundreds of coordinates: Newton steps from vectors in binary64.
//! In: a system with mass at every coordinate, the shapes of all its modes. Out: the basis, and X^T A X of any form A of the
//! system as enclosures. See docs/method/modes.md#many-modes-as-a-basis.
//!
//! The basis is X + D, the high and the low words of its entries, taken as exact, so no rounding of it has to be bounded.
//! For a form A and the quotient theta_j of x_j, which is taken as exact too, with R = A (X + D) - M (X + D) Theta,
//!
//!   (X + D)^T A (X + D) = (X + D)^T R + (X + D)^T M (X + D) Theta,
//!   (X + D)^T M (X + D) = X^T M X + S + S^T,   S = D^T (M X + M D / 2).
//!
//! R and D are small, so plain products of matrices in binary64 give what they are part of to two words; the images A x and
//! M x, and X^T M X alone, are sums in two words. The products' errors are bounded in the norms |W x| of displacements and
//! |f / W| of forces, W^2 the diagonal of M (compare [`residual`](super::residual)).
//!
//! Between close frequencies the first step is not small: its square, and the rounding of S, are a second one's.

use super::residual::{Block, Doubt, Flat, apply, quotients, residuals, strain};
use crate::analysis::modes::gram::SLACK;
use crate::analysis::modes::terms::Terms;
use crate::base::{Ball, Dd, rounding};
use crate::kernel::cores;
use crate::kernel::dense::Matrix;
use crate::kernel::dense::product::{self, View, add_product, product};
use crate::kernel::lanes::Double;
use crate::kernel::simd::{LANES, simd};
use crate::kernel::symmetric::tridiagonal::dot;
use crate::system::{Form, LinearSystem};

/// The modes X + D of a system.
pub struct Basis {
    x: Matrix<f64>,
    change: Matrix<f64>,
    /// (X + D)^T M (X + D)
    pub m: Matrix<Ball>,
    weights: Vec<f64>,
    masses: Flat,
    doubt: Doubt,
    /// |W x_j| and |W d_j|.
    sizes: Vec<f64>,
    changes: Vec<f64>,
}

/// A larger change is not a small correction: such modes are only made orthogonal.
const SMALL: f64 = 1e-4;
/// Products in one chain of a sum in two words; its error grows with their square.
const CHAIN: usize = 8;
/// u^2 = 2^-106.
const UNIT_SQUARED: f64 = rounding::UNIT_SQUARED;
/// What underflow takes from an entry of a product of matrices.
const FLOOR: f64 = 1e-310;
/// Steps of a sum that one core does in about a millisecond.
const MOST_OF_ONE: usize = 1 << 19;

/// A bound of an entry of X^T Y computed by [`columns`], relative to the sum of its products' magnitudes: (l + 3)^2 u^2 for
/// chains of l products, and 4 u^2 of the sum for each of their sums (see [`Dd`]).
fn error_of_sums(n: usize) -> f64 {
    let chain = (CHAIN + 3) * (CHAIN + 3);
    1.01 * (chain + 4 * n.div_ceil(CHAIN)) as f64 * UNIT_SQUARED
}

impl Basis {
    /// From the shapes of all modes, one column each and normalised by M. `None` where some coordinate has no mass, or numbers
    /// are out of range.
    pub fn of(system: &LinearSystem, x: Matrix<f64>) -> Option<Basis> {
        let n = x.rows();
        let terms = Terms::of(&system.m);
        let mut diagonal = vec![0.0; n];
        for t in 0..terms.len() {
            let (indices, factors) = terms.row(t);
            for (&i, a) in indices.iter().zip(factors.iter()) {
                diagonal[i.index()] += terms.weight(t).value.hi() * a.to_f64() * a.to_f64();
            }
        }
        if x.columns() != n || !terms.is_finite() || !diagonal.iter().all(|m| m.is_normal() && *m > 0.0) {
            return None;
        }
        let weights: Vec<f64> = diagonal.iter().map(|m| m.sqrt()).collect();
        let (masses, doubt) = (Flat::of(&terms), Doubt::of(&terms, &weights));
        let shapes = refine(&x, &Flat::of(&Terms::of(&system.k)), &masses);
        let (x, change) = (shapes.map(|x| x.hi), shapes.map(|x| x.lo));
        Some(Basis::with(x, change, weights, (masses, doubt)))
    }

    /// X + D in a system with these masses.
    fn with(x: Matrix<f64>, change: Matrix<f64>, weights: Vec<f64>, (masses, doubt): (Flat, Doubt)) -> Basis {
        let n = x.rows();
        let momenta = momenta(&masses, &x);
        let sums = sums(&x, &momenta);
        let lengths = |x: &Matrix<f64>| (0..n).map(|j| displacement(&weights, x.column(j))).collect();
        let (sizes, changes) = (lengths(&x), lengths(&change));
        let m = Matrix::fill_with(n, n, Ball::ZERO);
        let mut basis = Basis { m, x, change, weights, masses, doubt, sizes, changes };
        basis.m = basis.inertia(&sums, &momenta);
        basis
    }

    /// (X + D)^T M (X + D) from X^T M X and M X.
    fn inertia(&self, sums: &Matrix<Dd>, momenta: &[Vec<f64>]) -> Matrix<Ball> {
        let n = self.x.rows();
        let mut block = Block::new(n);
        // M X + M D / 2, and bounds of the errors of a product with d_i and of one with x_i.
        let mut y = Matrix::fill_with(n, n, 0.0);
        let (mut by_change, mut by_vector) = (Vec::with_capacity(n), Vec::with_capacity(n));
        for (first, momenta) in (0..n).step_by(LANES).zip(momenta) {
            let width = block.load(&self.change, first);
            apply(&self.masses, &block.x, &mut block.m);
            for lane in 0..width {
                let j = first + lane;
                let [whole, more] = [momenta, &block.m].map(|image| high_words(image, lane));
                let column = y.column_mut(j);
                (0..n).for_each(|i| column[i] = whole[i] + 0.5 * more[i]);
                let [whole, more, both] = [&whole[..], &more[..], &*column].map(|f| force(&self.weights, f));
                let image = self.doubt.kappa * (self.sizes[j] + self.changes[j]) + 2.0 * self.doubt.floor;
                by_change.push(SLACK * (image + product::error(n) * both + 2.0 * f64::EPSILON * (whole + more)));
                by_vector.push(SLACK * (image + error_of_sums(n) * whole * (1.0 + f64::EPSILON)));
            }
        }
        let s = product(View::of(&self.change).transpose(), View::of(&y));
        let mut m = Matrix::fill_with(n, n, Ball::ZERO);
        for j in 0..n {
            for i in 0..=j {
                let mid = sums[(i, j)] + Dd::from(s[(i, j)]) + Dd::from(s[(j, i)]);
                let off =
                    self.sizes[i] * by_vector[j] + self.changes[i] * by_change[j] + self.changes[j] * by_change[i];
                let added = 2.0 * Dd::EPSILON * (sums[(i, j)].hi.abs() + s[(i, j)].abs() + s[(j, i)].abs());
                let entry = Ball::new(mid, SLACK * (off + added) + FLOOR);
                (m[(i, j)], m[(j, i)]) = (entry, entry);
            }
        }
        m
    }

    /// X + D
    pub fn shapes(&self) -> Matrix<Dd> {
        let words = |i, j| Dd { hi: self.x[(i, j)], lo: self.change[(i, j)] };
        Matrix::from_fn(self.x.rows(), self.x.columns(), words)
    }

    /// (X + D)^T A (X + D)
    pub fn form(&self, form: &Form) -> Matrix<Ball> {
        let n = self.x.rows();
        if form.is_empty() {
            return Matrix::fill_with(n, n, Ball::ZERO);
        }
        let terms = Terms::of(form);
        let doubt = Doubt::of(&terms, &self.weights);
        let Images { theta, r } = Images::of(&Flat::of(&terms), &self.masses, &self.x, Some(&self.change));
        let p = product(View::of(&self.x).transpose(), View::of(&r));
        // Leaving out D, rounding R, and the product. A sum in two words that joins the images of X and D is one of the four
        // that the bound of an image counts beyond those that it has: for N terms and rows of l there are N + l - 2, and one for
        // the residual, of N + l + 3 (see [`residual`](super::residual)).
        let rounding = product::error(n) + 2.0 * f64::EPSILON;
        let slip = |j: usize| {
            let size = theta[j].hi.abs() * SLACK;
            let strain = strain(&terms, self.x.column(j)) + strain(&terms, self.change.column(j));
            let image = doubt.by_strain * strain + size * self.doubt.kappa * (self.sizes[j] + self.changes[j]);
            let floor = doubt.floor + size * self.doubt.floor;
            SLACK * (image + 4.0 * floor + rounding * force(&self.weights, r.column(j)))
        };
        let slips: Vec<f64> = (0..n).map(slip).collect();
        let mut entries = Matrix::fill_with(n, n, Ball::ZERO);
        for j in 0..n {
            for i in 0..=j {
                // Of the two formulas for the entry, that of the smaller quotient.
                let (row, column) = if theta[i].hi.abs() < theta[j].hi.abs() { (j, i) } else { (i, j) };
                let off = SLACK * (self.sizes[row] + self.changes[row]) * slips[column] + FLOOR;
                let residual = Ball::new(Dd::from(p[(row, column)]), off);
                let entry = residual + Ball::exact(theta[column]) * self.m[(i, j)];
                (entries[(i, j)], entries[(j, i)]) = (entry, entry);
            }
        }
        entries
    }
}

/// |W x|
fn displacement(weights: &[f64], x: &[f64]) -> f64 {
    let scaled: Vec<f64> = x.iter().zip(weights).map(|(x, w)| x * w).collect();
    dot(&scaled, &scaled).sqrt() * SLACK
}

/// |f / W|
fn force(weights: &[f64], f: &[f64]) -> f64 {
    let scaled: Vec<f64> = f.iter().zip(weights).map(|(f, w)| f / w).collect();
    dot(&scaled, &scaled).sqrt() * SLACK
}

/// The high words of one of eight images.
fn high_words(image: &[f64], lane: usize) -> Vec<f64> {
    image.iter().skip(lane).step_by(2 * LANES).copied().collect()
}

/// Images of vectors under a form and M.
struct Images {
    theta: Vec<Dd>,
    /// A (X + D) - M (X + D) Theta, rounded to one word; Theta are the quotients of X.
    r: Matrix<f64>,
}

impl Images {
    fn of(form: &Flat, masses: &Flat, x: &Matrix<f64>, change: Option<&Matrix<f64>>) -> Images {
        let n = x.rows();
        let (mut r, mut theta) = (Matrix::fill_with(n, n, 0.0), Vec::with_capacity(n));
        let (mut block, mut second) = (Block::new(n), Block::new(n));
        for first in (0..n).step_by(LANES) {
            let width = block.load(x, first);
            apply(form, &block.x, &mut block.k);
            apply(masses, &block.x, &mut block.m);
            let [high, low] = quotients(&block.x, &block.k, &block.m);
            if let Some(change) = change {
                second.load(change, first);
                apply(form, &second.x, &mut second.k);
                apply(masses, &second.x, &mut second.m);
                add(1.0, &mut block.k, &second.k);
                add(1.0, &mut block.m, &second.m);
            }
            residuals(&[high, low], &mut block.k, &block.m);
            for lane in 0..width {
                theta.push(Dd { hi: high[lane], lo: low[lane] });
                r.column_mut(first + lane).copy_from_slice(&high_words(&block.k, lane));
            }
        }
        Images { theta, r }
    }
}

/// M X, eight columns at a time: a row of high and a row of low words for each coordinate.
fn momenta(masses: &Flat, x: &Matrix<f64>) -> Vec<Vec<f64>> {
    let mut block = Block::new(x.rows());
    let image = |first: usize| {
        block.load(x, first);
        apply(masses, &block.x, &mut block.m);
        block.m.clone()
    };
    (0..x.columns()).step_by(LANES).map(image).collect()
}

/// X after two Newton steps, rounded to two words.
fn refine(x: &Matrix<f64>, stiffness: &Flat, masses: &Flat) -> Matrix<Dd> {
    let n = x.rows();
    let unit = |i: usize, j: usize| if i == j { Dd::ONE } else { Dd::ZERO };
    let images = Images::of(stiffness, masses, x, None);
    let p = product(View::of(x).transpose(), View::of(&images.r));
    let of_x = momenta(masses, x);
    let beside_one = |i: usize, j: usize| entry(x, &of_x, i, j) - unit(i, j);
    let first = step(x, &p, &images.theta, &|i, j| beside_one(i, j).to_f64());
    // S of the module, in two words.
    let mut between = of_x.clone();
    for (whole, more) in between.iter_mut().zip(&momenta(masses, &first)) {
        add(0.5, whole, more);
    }
    let s = |i: usize, j: usize| entry(&first, &between, i, j);
    let r = Images::of(stiffness, masses, x, Some(&first)).r;
    let moved = Matrix::from_fn(n, n, |i, j| x[(i, j)] + first[(i, j)]);
    let p = product(View::of(&moved).transpose(), View::of(&r));
    let second = step(&moved, &p, &images.theta, &|i, j| (beside_one(i, j) + s(i, j) + s(j, i)).to_f64());
    Matrix::from_fn(n, n, |i, j| Dd::from(x[(i, j)]) + Dd::from(first[(i, j)]) + Dd::from(second[(i, j)]))
}

/// x_i . y_j in two words, Y eight columns at a time.
fn entry(x: &Matrix<f64>, y: &[Vec<f64>], i: usize, j: usize) -> Dd {
    let lane = j % LANES;
    let words = y[j / LANES].chunks_exact(2 * LANES);
    let products = x.column(i).iter().zip(words).map(|(&x, y)| Dd { hi: y[lane], lo: y[LANES + lane] } * x);
    products.fold(Dd::ZERO, |sum, product| sum + product)
}

/// X^T Y, which is symmetric, in two words, Y eight columns at a time.
fn sums(x: &Matrix<f64>, y: &[Vec<f64>]) -> Matrix<Dd> {
    let n = x.rows();
    let blocks: Vec<usize> = (0..y.len()).collect();
    let least = MOST_OF_ONE.div_ceil(n * n / 2 + 1);
    let found = cores::in_pieces(&blocks, least, 1, |some| {
        some.iter().map(|&block| columns(x, n.min((block + 1) * LANES), &y[block])).collect()
    });
    let mut sums = Matrix::zeros(n, n);
    for (block, found) in found.iter().enumerate() {
        for lane in 0..LANES.min(n - block * LANES) {
            let j = block * LANES + lane;
            for (i, words) in found.chunks_exact(2 * LANES).enumerate().take(j + 1) {
                let sum = Dd { hi: words[lane], lo: words[LANES + lane] };
                (sums[(i, j)], sums[(j, i)]) = (sum, sum);
            }
        }
    }
    sums
}

simd! {
    /// x_i . y of the first `count` columns of X and of eight y in two words: a row of high and a row of low words each.
    fn columns<V: Eight>(x: &Matrix<f64>, count: usize, y: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; 2 * LANES * count];
        for (i, words) in sums.chunks_exact_mut(2 * LANES).enumerate() {
            let mut sum = Double::<V>::zero();
            let x = x.column(i);
            for first in (0..x.len()).step_by(CHAIN) {
                let mut chain = Double::<V>::zero();
                for k in first..x.len().min(first + CHAIN) {
                    chain = chain.plus_product(Double::load(&y[2 * LANES * k..]), V::splat(x[k]));
                }
                sum = sum.plus(chain.normalise());
            }
            sum.store(words);
        }
        sums
    }
}

simd! {
    /// a <- a + f b in two words, for an f that is a power of two.
    fn add<V: Eight>(f: f64, a: &mut [f64], b: &[f64]) {
        let f = V::splat(f);
        for (a, b) in a.chunks_exact_mut(2 * LANES).zip(b.chunks_exact(2 * LANES)) {
            let b = Double::<V>::load(b);
            Double::load(a).sloppy_plus(Double { hi: f * b.hi, lo: f * b.lo }).store(a);
        }
    }
}

/// The change of a Newton step: X Z with the Z that makes X^T M X = 1 + E and X^T K X, of which P is what is left beside
/// X^T M X Theta, diagonal to second order; modes of close frequencies are only made orthogonal. So E is read on the diagonal
/// and at close frequencies alone. Whatever Z is, the enclosures hold.
fn step(x: &Matrix<f64>, p: &Matrix<f64>, theta: &[Dd], e: &dyn Fn(usize, usize) -> f64) -> Matrix<f64> {
    let n = x.rows();
    let z = Matrix::from_fn(n, n, |i, j| {
        let gap = (theta[i] - theta[j]).hi;
        if i != j && gap.abs() * SMALL > p[(i, j)].abs() { -p[(i, j)] / gap } else { -0.5 * e(i, j) }
    });
    let mut change = Matrix::fill_with(n, n, 0.0);
    add_product(change.data_mut(), n, 1.0, View::of(x), View::of(&z));
    change
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::modes::form::{gram, shapes};
    use crate::analysis::modes::modes_as;
    use crate::analysis::modes::request::{Request, Which};
    use crate::analysis::test_systems::{blank, push};
    use crate::base::Number;
    use crate::kernel::squares::Squares;
    use crate::system::{CoordinateId, Nature};

    /// Masses on springs to others, some of them joined to others by masses that move with two.
    fn net(n: usize) -> LinearSystem {
        let mut system = blank(n);
        let text = |i: usize| format!("{}.{}", 1 + i % 7, i % 10);
        for i in 0..n {
            push(&mut system.m, &text(3 * i + 1), i, None);
            push(&mut system.k, &text(i), i, i.checked_sub(1));
            push(&mut system.c, &text(2 * i), i, (5 * i + 3).checked_rem(n).filter(|&j| j != i));
            if i % 5 == 4 {
                push(&mut system.m, "0.3", i, Some(i - 3));
                push(&mut system.k, &text(11 * i), i, Some(i / 2));
            }
        }
        system
    }

    /// Masses of 2 and 3 kg within a part in 10^6, and a D that is a quarter of X: (X + D)^T M (X + D) is 25/16 of X^T M X, and both
    /// ends of the range are in the enclosures, of which those on the diagonal are at most (1 + 2/4)(1 + 1/4) / (25/16) = 1.2 times as
    /// wide: what images of X and of D are off by adds up, and neither may be left out.
    #[test]
    fn a_large_change_and_all_values_of_the_masses_are_enclosed() {
        let mut system = blank(2);
        let source = system.m.source(system.coordinates[0].name);
        for (i, mass) in [2.0, 3.0].into_iter().enumerate() {
            let mass = Number::Ball(Ball::from(mass).widen(mass * 1e-6));
            system.m.push(source, Nature::Property, mass, [(CoordinateId(i as u32), Number::ONE)]);
        }
        let terms = Terms::of(&system.m);
        let weights = vec![2f64.sqrt(), 3f64.sqrt()];
        let x = Matrix::from_fn(2, 2, |i, j| [[1.0, 0.5], [0.75, -2.0]][i][j]);
        let doubt = Doubt::of(&terms, &weights);
        let basis = Basis::with(x.clone(), x.map(|x| 0.25 * x), weights, (Flat::of(&terms), doubt));
        for i in 0..2 {
            for j in 0..2 {
                let exact = 25.0 / 16.0 * (2.0 * x[(0, i)] * x[(0, j)] + 3.0 * x[(1, i)] * x[(1, j)]);
                let Ball { mid, rad } = basis.m[(i, j)];
                assert!(mid.hi == exact && mid.lo == 0.0, "{i} {j}: {mid:?} {exact}");
                if i == j {
                    assert!((exact * 1e-6..exact * 1.21e-6).contains(&rad), "{i}: {rad} {exact}");
                }
            }
        }
    }

    /// The enclosures meet those of the terms, entry by entry in balls, and are as narrow; the basis is one to two words.
    #[test]
    fn forms_in_the_basis_meet_those_from_the_terms() {
        let system = net(150);
        let modes = modes_as(&system, &Request { which: Which::All, ..Request::default() }).expect("modes");
        assert!(modes.list.iter().all(|mode| mode.precise.is_none()));
        let plain = shapes(&modes.list).map(|x| x.hi);
        let basis = Basis::of(&system, plain).expect("masses everywhere");
        let x = basis.shapes();
        let most = modes.list.last().expect("modes").omega_squared.mid.hi;
        for (form, computed, unit, is_diagonal) in [
            (&system.m, basis.m.clone(), 1.0, true),
            (&system.k, basis.form(&system.k), most, true),
            (&system.c, basis.form(&system.c), 10.0, false),
        ] {
            let expected = gram(&Squares::of_form(form), &x);
            for j in 0..150 {
                for i in 0..150 {
                    let (a, b) = (computed[(i, j)], expected[(i, j)]);
                    assert!((a - b).contains_zero(), "{i} {j}: {a:?} {b:?}");
                    // Some hundred roundings of two words, 1e-32 each; where dampers couple the modes, their residuals are
                    // as large as the entries.
                    let reached = if is_diagonal { 1e-28 } else { 1e-13 };
                    assert!(a.rad < reached * unit, "{i} {j}: {a:?}");
                    assert!(!is_diagonal || i == j || a.magnitude() < 1e-28 * unit, "{i} {j}: {a:?}");
                }
            }
        }
    }
}
