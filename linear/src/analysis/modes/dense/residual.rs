//! Residuals r_j = K x_j - theta_j M x_j of many vectors at once, from the terms in double-double, with bounds.
//!
//! The x_j are binary64 vectors, taken as exact; theta_j is their Rayleigh quotient to double-double, then also taken
//! as exact. Eight vectors are processed in parallel. A spring between two coordinates stretches by a difference that
//! two words hold exactly; its force w (x_i - x_k) has a relative error of at most 6 u^2, a sum of two words an error
//! of at most 10 u^2 of its parts' magnitudes (u = 2^-53). So for rows of at most l entries and at most N terms at a
//! coordinate
//!
//!   |computed - true| <= B |x| + floor,  B = sum_t beta_t |a_t| |a_t|^T,
//!   beta_t = (|w_t| (10 (N + l + 3) + 60) u^2 + |w_t| 2 p + radius of w_t) (1 + p)^2,  p = max_k radius of a_tk / |a_tk|,
//!
//! entry by entry, which also covers the rounding of weights and factors to two words. With D^2 the diagonal of M,
//! |x_i^T (error of K x_j)| <= kappa |D x_i| |D x_j|, where kappa is the largest row sum of D^-1 B D^-1 (an upper bound
//! of a symmetric matrix' norm). See docs/method/modes.md#dense-matrices.

use crate::analysis::modes::gram::SLACK;
use crate::analysis::modes::terms::{Factor, Factors, Terms};
use crate::base::{Dd, larger, rounding};
use crate::kernel::dense::Matrix;
use crate::kernel::dense::product;
use crate::kernel::lanes::Double;
use crate::kernel::simd::{Eight, LANES, each, simd};
use crate::kernel::symmetric::tridiagonal::dot;

/// u^2 = 2^-106.
const UNIT_SQUARED: f64 = rounding::UNIT_SQUARED;
/// Products lose bits of their low words below 2^-969: some units of 2^-1074.
const UNDERFLOW: f64 = 1e-320;

/// A form in the layout that the kernels read.
pub(super) struct Flat {
    weights: Vec<[f64; 2]>,
    starts: Vec<u32>,
    indices: Vec<u32>,
    factors: Vec<[f64; 2]>,
    kinds: Vec<Kind>,
}

/// Rows by whether they need products; most do not.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    /// One coordinate with a factor of one.
    Single,
    /// The difference of two coordinates.
    Difference,
    Other,
}

/// Error bounds of applying a form to vectors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Doubt {
    pub kappa: f64,
    /// Norm in D^-1 of the error from underflow.
    pub floor: f64,
    /// For the [`strain`] of a vector: |x_i^T (error of K x_j)| <= by_strain |D x_i| strain_j, up to the underflow.
    pub by_strain: f64,
}

/// Residuals of the columns of X, and the quantities that their bounds need.
pub struct Residuals {
    pub theta: Vec<Dd>,
    pub r: Matrix<f64>,
    /// M X
    pub y: Matrix<f64>,
    /// |D x_j|
    pub size: Vec<f64>,
    /// |x_i^T r_j computed in binary64 - true| <= size_i r_slip_j, and |x_i^T y_j - true| <= size_i y_slip_j.
    pub r_slip: Vec<f64>,
    pub y_slip: Vec<f64>,
}

/// Residuals for the pencil of two forms.
pub struct Pencil {
    scale: Vec<f64>,
    stiffness: Flat,
    masses: Flat,
    doubts: [Doubt; 2],
}

impl Pencil {
    /// `diagonal`: positive, and close to that of M.
    pub fn new(stiffness: &Terms, masses: &Terms, diagonal: &[f64]) -> Pencil {
        let scale: Vec<f64> = diagonal.iter().map(|m| m.sqrt()).collect();
        Pencil {
            doubts: [Doubt::of(stiffness, &scale), Doubt::of(masses, &scale)],
            stiffness: Flat::of(stiffness),
            masses: Flat::of(masses),
            scale,
        }
    }

    pub fn residuals(&self, x: &Matrix<f64>) -> Residuals {
        let (n, columns) = (x.rows(), x.columns());
        let (mut r, mut y) = (Matrix::fill_with(n, columns, 0.0), Matrix::fill_with(n, columns, 0.0));
        let mut theta = Vec::with_capacity(columns);
        let mut block = Block::new(n);
        for first in (0..columns).step_by(LANES) {
            let width = block.load(x, first);
            apply(&self.stiffness, &block.x, &mut block.k);
            apply(&self.masses, &block.x, &mut block.m);
            let [high, low] = quotients(&block.x, &block.k, &block.m);
            residuals(&[high, low], &mut block.k, &block.m);
            theta.extend(high.iter().zip(low).take(width).map(|(&hi, lo)| Dd { hi, lo }));
            for lane in 0..width {
                let (r, y) = (r.column_mut(first + lane), y.column_mut(first + lane));
                for i in 0..n {
                    (r[i], y[i]) = (block.k[2 * i * LANES + lane], block.m[2 * i * LANES + lane]);
                }
            }
        }
        self.with_bounds(x, theta, r, y)
    }

    fn with_bounds(&self, x: &Matrix<f64>, theta: Vec<Dd>, r: Matrix<f64>, y: Matrix<f64>) -> Residuals {
        let (n, columns) = (x.rows(), x.columns());
        let norm = |v: &[f64], weight: &dyn Fn(usize) -> f64| {
            let scaled: Vec<f64> = v.iter().enumerate().map(|(i, x)| x * weight(i)).collect();
            dot(&scaled, &scaled).sqrt() * SLACK
        };
        let times = |i: usize| self.scale[i];
        let over = |i: usize| 1.0 / self.scale[i];
        // The errors of a product of matrices and of rounding its factor to one word.
        let rounding = product::error(n) + f64::EPSILON;
        let [of_k, of_m] = self.doubts;
        let size: Vec<f64> = (0..columns).map(|j| norm(x.column(j), &times)).collect();
        let slip =
            |j: usize, v: &[f64], kappa: f64, floor: f64| SLACK * (kappa * size[j] + rounding * norm(v, &over) + floor);
        let r_slip = (0..columns).map(|j| {
            let theta = theta[j].hi.abs() * SLACK;
            slip(j, r.column(j), of_k.kappa + theta * of_m.kappa, of_k.floor + theta * of_m.floor)
        });
        let r_slip = r_slip.collect();
        let y_slip = (0..columns).map(|j| slip(j, y.column(j), of_m.kappa, of_m.floor)).collect();
        Residuals { theta, r_slip, y_slip, size, r, y }
    }
}

impl Residuals {
    /// The residuals with their columns in this order.
    pub fn reorder(self, order: &[usize]) -> Residuals {
        let chosen = |values: &[f64]| order.iter().map(|&j| values[j]).collect();
        Residuals {
            theta: order.iter().map(|&j| self.theta[j]).collect(),
            size: chosen(&self.size),
            r_slip: chosen(&self.r_slip),
            y_slip: chosen(&self.y_slip),
            r: self.r.select_columns(order),
            y: self.y.select_columns(order),
        }
    }
}

impl Flat {
    pub fn of(terms: &Terms) -> Flat {
        let mut flat = Flat {
            weights: Vec::with_capacity(terms.len()),
            starts: vec![0],
            indices: Vec::new(),
            factors: Vec::new(),
            kinds: Vec::with_capacity(terms.len()),
        };
        let words = |x: Dd| [x.hi, x.lo];
        for t in 0..terms.len() {
            let (indices, factors) = terms.row(t);
            flat.weights.push(words(terms.weight(t).value.dd()));
            flat.indices.extend(indices.iter().map(|i| i.0));
            flat.factors.extend(factors.iter().map(|factor| words(factor.to_dd())));
            flat.starts.push(flat.indices.len() as u32);
            flat.kinds.push(kind(factors));
        }
        flat
    }
}

fn kind(factors: Factors) -> Kind {
    let mut signs = factors.iter().map(|factor| match factor {
        Factor::Plus => Some(true),
        Factor::Minus => Some(false),
        Factor::Other(_) => None,
    });
    match (signs.next().flatten(), signs.next(), signs.next()) {
        (Some(_), None, None) => Kind::Single,
        (Some(a), Some(Some(b)), None) if a != b => Kind::Difference,
        _ => Kind::Other,
    }
}

impl Doubt {
    /// See the module.
    pub fn of(terms: &Terms, scale: &[f64]) -> Doubt {
        let (mut at, mut length) = (vec![0u32; scale.len()], 0);
        for t in 0..terms.len() {
            let (indices, _) = terms.row(t);
            indices.iter().for_each(|&i| at[i.index()] += 1);
            length = length.max(indices.len());
        }
        let most = at.iter().copied().max().unwrap_or(0) as usize;
        let roundings = (10 * (most + length + 3) + 60) as f64 * UNIT_SQUARED;
        let (mut rows, mut floors) = (vec![0.0; scale.len()], vec![0.0; scale.len()]);
        let (mut sizes, mut worst) = (vec![0.0; scale.len()], 0.0);
        for t in 0..terms.len() {
            let (indices, factors) = terms.row(t);
            let weight = terms.weight(t);
            let size = weight.value.hi().abs() * SLACK;
            let doubt = factors.iter().map(factor_doubt).fold(0.0, larger);
            let beta = (size * (roundings + 2.0 * doubt) + weight.radius) * (1.0 + doubt) * (1.0 + doubt);
            let entry = |factor: Factor| factor.to_f64().abs() * SLACK;
            let sum: f64 = indices.iter().zip(factors.iter()).map(|(&i, a)| entry(a) / scale[i.index()]).sum();
            worst = larger(worst, if beta == 0.0 { 0.0 } else { beta / weight.value.hi().abs() });
            for (&i, a) in indices.iter().zip(factors.iter()) {
                rows[i.index()] += beta * entry(a) * sum;
                sizes[i.index()] += size * entry(a) * sum;
                floors[i.index()] += (1.0 + entry(a)) * (1.0 + size) * (most + length) as f64 * UNDERFLOW;
            }
        }
        let norm = |rows: &[f64]| rows.iter().zip(scale).map(|(row, scale)| row / scale).fold(0.0, larger) * SLACK;
        let floor: f64 = floors.iter().zip(scale).map(|(floor, scale)| (floor / scale) * (floor / scale)).sum();
        let by_strain = worst * norm(&sizes).sqrt() * SLACK;
        Doubt { kappa: norm(&rows), floor: floor.sqrt() * SLACK + UNDERFLOW, by_strain }
    }
}

/// sqrt(sum |w_t| g_t^2), where g_t is the stretch of a term with signs for factors, which two words hold exactly, and the
/// sum of its parts' magnitudes for others: the error of w_t a_t (a_t . x) is at most beta_t |a_t| g_t (see the module), and by
/// Cauchy's inequality the sum over the terms at most max (beta_t / |w_t|) sqrt(sum |w_t| (|a_t| . |x_i|)^2) strain_j. For soft
/// modes of stiff systems that is far less than the bound by the magnitude of x.
pub(super) fn strain(terms: &Terms, x: &[f64]) -> f64 {
    let mut sum = 0.0;
    for t in 0..terms.len() {
        let (indices, factors) = terms.row(t);
        let (mut stretch, mut size) = (0.0, 0.0);
        for k in 0..indices.len() {
            let part = factors.at(k).to_f64() * x[indices[k].index()];
            stretch += part;
            size += part.abs();
        }
        let stretch = match kind(factors) {
            Kind::Other => size * SLACK,
            // The difference is rounded once.
            Kind::Single | Kind::Difference => stretch.abs() + f64::EPSILON * size,
        };
        sum += terms.weight(t).value.hi().abs() * stretch * stretch;
    }
    sum.sqrt() * SLACK
}

/// Relative radius of a factor.
fn factor_doubt(factor: Factor) -> f64 {
    match factor {
        Factor::Plus | Factor::Minus => 0.0,
        Factor::Other(a) if a.radius == 0.0 => 0.0,
        Factor::Other(a) => a.radius / a.value.hi().abs() * SLACK,
    }
}

/// Eight vectors and their images; each coordinate has a row of eight numbers (two rows for numbers of two words).
pub(super) struct Block {
    pub x: Vec<f64>,
    pub k: Vec<f64>,
    pub m: Vec<f64>,
}

impl Block {
    pub fn new(n: usize) -> Block {
        Block { x: vec![0.0; n * LANES], k: vec![0.0; 2 * n * LANES], m: vec![0.0; 2 * n * LANES] }
    }

    /// Takes eight columns of X from this one on, or as many as there are, and returns their number.
    pub fn load(&mut self, x: &Matrix<f64>, first: usize) -> usize {
        let width = LANES.min(x.columns() - first);
        for lane in 0..LANES {
            // The last block repeats a column to avoid dividing by zero.
            let column = x.column(first + lane.min(width - 1));
            column.iter().enumerate().for_each(|(i, &x)| self.x[i * LANES + lane] = x);
        }
        width
    }
}

simd! {
    /// image = sum w a a^T x
    pub(super) fn apply<V: Eight>(form: &Flat, x: &[f64], image: &mut [f64]) {
        apply_as::<V>(form, x, image);
    }
}

#[inline(always)]
fn apply_as<V: Eight>(form: &Flat, x: &[f64], image: &mut [f64]) {
    image.fill(0.0);
    for (t, (&weight, &kind)) in form.weights.iter().zip(&form.kinds).enumerate() {
        let range = form.starts[t] as usize..form.starts[t + 1] as usize;
        let (indices, factors) = (&form.indices[range.clone()], &form.factors[range]);
        let weight = splat::<V>(weight);
        match (kind, indices) {
            (Kind::Single, [i]) => add(image, *i, weight.sloppy_times(at(x, *i))),
            (Kind::Difference, [i, j]) => {
                let force = weight.sloppy_times(Double::difference(at::<V>(x, *i).hi, at::<V>(x, *j).hi));
                add(image, *i, force);
                add(image, *j, -force);
            }
            _ => {
                let mut stretch = Double::zero();
                for (&i, &a) in indices.iter().zip(factors.iter()) {
                    stretch = stretch.sloppy_plus(splat::<V>(a).sloppy_times(at(x, i)));
                }
                let force = weight.sloppy_times(stretch);
                for (&i, &a) in indices.iter().zip(factors.iter()) {
                    add(image, i, splat::<V>(a).sloppy_times(force));
                }
            }
        }
    }
}

// Functions, not closures: code that is not inlined into the kernel is compiled without its instruction set.

#[inline(always)]
fn splat<V: Eight>([hi, lo]: [f64; 2]) -> Double<V> {
    Double::splat(Dd { hi, lo })
}

#[inline(always)]
fn at<V: Eight>(x: &[f64], i: u32) -> Double<V> {
    Double { hi: V::load(&x[i as usize * LANES..]), lo: V::splat(0.0) }
}

#[inline(always)]
fn add<V: Eight>(image: &mut [f64], i: u32, force: Double<V>) {
    let place = &mut image[2 * i as usize * LANES..][..2 * LANES];
    Double::load(place).sloppy_plus(force).store(place);
}

simd! {
    /// x . k / x . m in two words, a row each.
    pub(super) fn quotients<V: Eight>(x: &[f64], k: &[f64], m: &[f64]) -> [[f64; LANES]; 2] {
        let (mut energy, mut inertia) = (Double::<V>::zero(), Double::<V>::zero());
        for (i, x) in x.chunks_exact(LANES).enumerate() {
            let x = Double { hi: V::load(x), lo: V::splat(0.0) };
            energy = energy.sloppy_plus(x.sloppy_times(Double::load(&k[2 * i * LANES..])));
            inertia = inertia.sloppy_plus(x.sloppy_times(Double::load(&m[2 * i * LANES..])));
        }
        let (mut above, mut below) = ([0.0; 2 * LANES], [0.0; 2 * LANES]);
        energy.store(&mut above);
        inertia.store(&mut below);
        let quotient = |lane: usize| {
            let of = |words: &[f64]| Dd { hi: words[lane], lo: words[LANES + lane] };
            of(&above) / of(&below)
        };
        [each(|lane| quotient(lane).hi), each(|lane| quotient(lane).lo)]
    }
}

simd! {
    /// k <- k - theta m, rounded to the first of its words.
    pub(super) fn residuals<V: Eight>(theta: &[[f64; LANES]; 2], k: &mut [f64], m: &[f64]) {
        let theta = -Double::<V> { hi: V::load(&theta[0]), lo: V::load(&theta[1]) };
        for (k, m) in k.chunks_exact_mut(2 * LANES).zip(m.chunks_exact(2 * LANES)) {
            Double::load(k).sloppy_plus(theta.sloppy_times(Double::load(m))).store(k);
        }
    }
}
