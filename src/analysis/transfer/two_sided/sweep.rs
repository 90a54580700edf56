//! The loops over eight frequencies: elimination and solutions in binary64, residuals in double-double, and the bound.
//!
//! Rounding, with u = 2^-53 and T = |k| + omega^2 |m| + omega |c| for an entry q = k + s c + s^2 m: an entry in double-double
//! is within (16 u^2 + loose) T; a row of l products and sums loses at most (12 l^2 + 40 l + 40) u^2 of sum T |x| in
//! double-double (l complex products are 2 l for each part, each sum adds its lost part to `lo`, which stays below
//! (2 l + 4) u sum T |x| and is rounded 6 l times), and (2 l + 6) u of it in binary64.

use super::{Lane, NOTHING, Plan, Polynomial, Sparse, TwoSided};
use crate::analysis::numeric::complex::Complex;
use crate::analysis::transfer::lanes::{Double, MOST, Pair, Vector, two_sum};
use crate::analysis::transfer::{Disc, FAST_ABOVE, Frequency};
use crate::base::Dd;

/// Working space and results for one set of inputs and outputs.
struct Sweep<'a, V> {
    of: &'a TwoSided<'a>,
    loads: &'a [Sparse],
    readings: &'a [Sparse],
    l: Vec<Pair<V>>,
    inverse: Vec<Pair<V>>,
    work: Vec<Pair<V>>,
    /// The solution: a first approximation and, where that is not enough, what it left.
    x: [Vec<Pair<V>>; 2],
    /// Q^-1 p of each output, and |p - Q z|.
    z: Vec<Vec<Pair<V>>>,
    loose: f64,
    t: Vec<V>,
    /// By input, then output.
    results: Vec<Result<V>>,
    /// The reading that a load is the same as, if any: then one solution serves both.
    same: Vec<Option<usize>>,
    tolerance: f64,
    /// By lane, then input, then output: the best so far.
    discs: Vec<Disc>,
}

#[derive(Clone, Copy)]
struct Result<V> {
    re: Double<V>,
    im: Double<V>,
    radius: V,
}

/// Eight frequencies as lanes.
#[derive(Clone, Copy)]
struct Point<V> {
    omega: Double<V>,
    square: Double<V>,
    /// What entries are uncertain by, relative to T.
    loose: V,
}

const U: f64 = f64::EPSILON / 2.0;
/// Covers the roundings of sums of positive numbers: up to a million of them.
const UP: f64 = 1.0 + 1e-9;
/// What is lost below the range of binary64: products of numbers near 1e-300 do not happen (gains are far larger, or the
/// radius tells).
const TINY: f64 = 1e-300;

/// What a sweep starts from.
pub struct Task<'a> {
    pub of: &'a TwoSided<'a>,
    pub loads: &'a [Sparse],
    pub readings: &'a [Sparse],
    /// Relative radius of all numbers.
    pub loose: f64,
    pub frequencies: &'a [Frequency],
    /// The relative error that is good enough.
    pub tolerance: f64,
}

/// Discs by frequency, then input, then output.
pub fn discs(task: &Task) -> Vec<Disc> {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::is_x86_feature_detected as has;
        if has!("avx512f") {
            // SAFETY: the processor has these instructions.
            return unsafe { by_eight(task) };
        }
        if has!("avx2") && has!("fma") {
            // SAFETY: the processor has these instructions.
            return unsafe { by_four(task) };
        }
    }
    all::<f64>(task)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f")]
fn by_eight(task: &Task) -> Vec<Disc> {
    all::<crate::analysis::transfer::lanes::x86::Eight>(task)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn by_four(task: &Task) -> Vec<Disc> {
    all::<crate::analysis::transfer::lanes::x86::Four>(task)
}

#[inline(always)]
fn all<V: Vector>(task: &Task) -> Vec<Disc> {
    let mut discs = Vec::with_capacity(task.frequencies.len() * task.loads.len() * task.readings.len());
    let mut sweep = Sweep::<V>::new(task);
    for chunk in task.frequencies.chunks(V::WIDTH) {
        sweep.run(&std::array::from_fn(|i| Lane::of(&chunk[i.min(chunk.len() - 1)])));
        discs.extend_from_slice(&sweep.discs[..chunk.len() * task.loads.len() * task.readings.len()]);
    }
    discs
}

impl<'a, V: Vector> Sweep<'a, V> {
    #[inline(always)]
    fn new(task: &Task<'a>) -> Sweep<'a, V> {
        let Task { of, loads, readings, loose, tolerance, .. } = *task;
        let n = of.plan.n;
        let zeros = || vec![Pair::zero(); n];
        let nothing = Result { re: Double::zero(), im: Double::zero(), radius: V::splat(0.0) };
        Sweep {
            of,
            loads,
            readings,
            l: vec![Pair::zero(); of.plan.below.len()],
            inverse: zeros(),
            work: zeros(),
            x: [zeros(), zeros()],
            loose,
            z: readings.iter().map(|_| zeros()).collect(),
            t: vec![V::splat(0.0); readings.len()],
            results: vec![nothing; readings.len()],
            same: loads.iter().map(|load| readings.iter().position(|reading| reading == load)).collect(),
            tolerance,
            discs: vec![NOTHING; V::WIDTH * loads.len() * readings.len()],
        }
    }

    /// All pairs at as many frequencies as the vector has lanes.
    #[inline(always)]
    fn run(&mut self, lanes: &[Lane; MOST]) {
        let point = Point::of(lanes, self.loose);
        let plan = &self.of.plan;
        factor(plan, &point, &mut self.l, &mut self.inverse, &mut self.work);
        for (y, reading) in self.readings.iter().enumerate() {
            let first = scatter(plan, &point, reading, &mut self.z[y]);
            solve(plan, first, &self.l, &self.inverse, &mut self.z[y]);
            self.t[y] = residual_norm(plan, &point, reading, &self.z[y], &self.of.weights, &mut self.work);
        }
        self.discs.fill(NOTHING);
        for u in 0..self.loads.len() {
            self.solve_load(u, &point);
            let enough = FAST_ABOVE <= self.tolerance && self.attempt(u, &point, 0);
            if !enough && !self.attempt(u, &point, 1) {
                // Where damping proves little, a solution for what the first one left makes the product small.
                solve(plan, 0, &self.l, &self.inverse, &mut self.x[1]);
                self.attempt(u, &point, 2);
            }
        }
    }

    #[inline(always)]
    fn solve_load(&mut self, u: usize, point: &Point<V>) {
        match self.same[u] {
            Some(y) => self.x[0].copy_from_slice(&self.z[y]),
            None => {
                let first = scatter(&self.of.plan, point, &self.loads[u], &mut self.x[0]);
                solve(&self.of.plan, first, &self.l, &self.inverse, &mut self.x[0]);
            }
        }
    }

    /// The values of an input from so many parts of the solution, 0 for one part and a residual in binary64; whether they
    /// are all good enough. What was good enough before is kept, so that no lane depends on its neighbours.
    #[inline(always)]
    fn attempt(&mut self, u: usize, point: &Point<V>, parts: usize) -> bool {
        let (plan, load, weights) = (&self.of.plan, &self.loads[u], &self.of.weights);
        let (x, rest) = self.x.split_at_mut(parts.max(1));
        if parts == 0 {
            rough_pair(plan, point, load, &x[0], &self.z, weights, &mut self.work, &mut self.results);
        } else {
            pair(plan, point, load, x, &self.z, weights, rest.first_mut(), &mut self.results);
        }
        let outputs = self.readings.len();
        let mut good = true;
        for (y, result) in self.results.iter_mut().enumerate() {
            finish(result, point, &self.readings[y], x, self.t[y]);
            let (re, im, radius) = (result.re, result.im, result.radius.store());
            let (re, im) = ([re.hi.store(), re.lo.store()], [im.hi.store(), im.lo.store()]);
            for lane in 0..V::WIDTH {
                let disc = &mut self.discs[(lane * self.loads.len() + u) * outputs + y];
                if is_good(disc, self.tolerance) {
                    continue;
                }
                let [re, im] = [re, im].map(|[hi, lo]| Dd::new(hi[lane], lo[lane]));
                let known = radius[lane].is_finite() && re.is_finite() && im.is_finite();
                *disc = if known { Disc { value: Complex::new(re, im), radius: radius[lane] } } else { NOTHING };
                good &= is_good(disc, self.tolerance);
            }
        }
        good
    }
}

/// Below the tolerance, seen from an upper bound of |value|.
#[inline(always)]
fn is_good(disc: &Disc, tolerance: f64) -> bool {
    let size = disc.value.re.hi.abs().max(disc.value.im.hi.abs());
    disc.radius <= size * (tolerance * 0.999)
}

impl<V: Vector> Point<V> {
    #[inline(always)]
    fn of(lanes: &[Lane; MOST], entries: f64) -> Point<V> {
        let of = |part: fn(&Lane) -> f64| V::load(&std::array::from_fn(|i| part(&lanes[i])));
        Point {
            omega: Double { hi: of(|l| l.omega.hi), lo: of(|l| l.omega.lo) },
            square: Double { hi: of(|l| l.square.hi), lo: of(|l| l.square.lo) },
            loose: (of(|l| 2.5 * l.loose) + V::splat(entries + 16.0 * U * U)) * V::splat(UP),
        }
    }

    /// k + s c + s^2 m in binary64.
    #[inline(always)]
    fn rough(&self, q: &Polynomial) -> Pair<V> {
        let mut re = V::splat(q.k.hi);
        if q.m.hi != 0.0 {
            re = (-self.square.hi).fused(V::splat(q.m.hi), re);
        }
        let im = if q.c.hi != 0.0 { self.omega.hi * V::splat(q.c.hi) } else { V::splat(0.0) };
        Pair { re, im }
    }

    /// The same in double-double, and T.
    #[inline(always)]
    fn exact(&self, q: &Polynomial) -> (Double<V>, Double<V>, V) {
        let mut re = Double { hi: V::splat(q.k.hi), lo: V::splat(q.k.lo) };
        let mut size = V::splat(q.k.hi.abs());
        if q.m.hi != 0.0 {
            let mass = V::splat(-q.m.hi);
            let product = self.square.hi * mass;
            let error = self.square.hi.fused(mass, -product);
            let error = self.square.lo.fused(mass, self.square.hi.fused(V::splat(-q.m.lo), error));
            let (hi, lost) = two_sum(re.hi, product);
            re = Double { hi, lo: re.lo + (error + lost) };
            size = size + product.abs();
        }
        let mut im = Double::zero();
        if q.c.hi != 0.0 {
            let damping = V::splat(q.c.hi);
            let hi = self.omega.hi * damping;
            let error = self.omega.hi.fused(damping, -hi);
            im = Double { hi, lo: self.omega.lo.fused(damping, self.omega.hi.fused(V::splat(q.c.lo), error)) };
            size = size + hi.abs();
        }
        (re, im, size)
    }
}

/// Q = L D L^T in the order of the plan, without pivoting.
#[inline(always)]
fn factor<V: Vector>(plan: &Plan, point: &Point<V>, l: &mut [Pair<V>], inverse: &mut [Pair<V>], work: &mut [Pair<V>]) {
    for k in 0..plan.n {
        let mut pivot = Pair::zero();
        for (row, entry) in &plan.columns[k] {
            let value = point.rough(entry);
            if *row as usize == k {
                pivot = value;
            } else {
                work[*row as usize] = value;
            }
        }
        for &(i, position) in &plan.touched[k] {
            let (i, position) = (i as usize, position as usize);
            let value = std::mem::replace(&mut work[i], Pair::zero());
            let above = plan.starts[i] as usize..position;
            for (&at, l) in plan.below[above.clone()].iter().zip(&l[above]) {
                let entry = &mut work[at as usize];
                *entry = entry.minus_product(*l, value);
            }
            let factor = value.times(inverse[i]);
            pivot = pivot.minus_product(factor, value);
            l[position] = factor;
        }
        inverse[k] = pivot.recip();
    }
}

/// A sparse right-hand side; returns its first place.
#[inline(always)]
fn scatter<V: Vector>(plan: &Plan, point: &Point<V>, right: &Sparse, x: &mut [Pair<V>]) -> usize {
    x.fill(Pair::zero());
    for (place, value) in right {
        x[*place as usize] = point.rough(value);
    }
    right.iter().map(|(place, _)| *place as usize).min().unwrap_or(plan.n)
}

/// The right-hand side, zero before `first`, becomes the solution.
#[inline(always)]
fn solve<V: Vector>(plan: &Plan, first: usize, l: &[Pair<V>], inverse: &[Pair<V>], x: &mut [Pair<V>]) {
    for j in first..plan.n {
        let value = x[j];
        for (&at, l) in plan.column(l, j) {
            let entry = &mut x[at as usize];
            *entry = entry.minus_product(*l, value);
        }
    }
    for j in (0..plan.n).rev() {
        let mut value = x[j].times(inverse[j]);
        for (&at, l) in plan.column(l, j) {
            value = value.minus_product(*l, x[at as usize]);
        }
        x[j] = value;
    }
}

/// A bound of |p - Q z|^2 in the norm of the weights, in binary64.
#[inline(always)]
fn residual_norm<V: Vector>(
    plan: &Plan,
    point: &Point<V>,
    right: &Sparse,
    z: &[Pair<V>],
    weights: &[f64],
    work: &mut [Pair<V>],
) -> V {
    for (place, value) in right {
        work[*place as usize] = point.rough(value);
    }
    let mut norm = V::splat(0.0);
    for (i, weight) in weights.iter().enumerate() {
        let bound = rough_residual(plan, point, i, z, work);
        norm = (bound * bound).fused(V::splat(*weight), norm);
    }
    norm
}

/// A bound of row i of b - Q x in binary64; b is in `work`, and is taken out of it.
#[inline(always)]
fn rough_residual<V: Vector>(plan: &Plan, point: &Point<V>, i: usize, x: &[Pair<V>], work: &mut [Pair<V>]) -> V {
    let mut rest = std::mem::replace(&mut work[i], Pair::zero());
    let mut size = rest.size();
    for (j, entry) in &plan.rows[i] {
        let (q, x) = (point.rough(entry), x[*j as usize]);
        rest = rest.minus_product(q, x);
        // T: what k - omega^2 m loses counts too.
        let inertia = V::splat(2.0 * entry.m.hi.abs()) * point.square.hi;
        size = (q.size() + inertia).fused(x.size(), size);
    }
    let lost = V::splat((2 * plan.rows[i].len() + 8) as f64 * 2.0 * U);
    size.fused(lost, rest.size())
}

#[expect(clippy::too_many_arguments, reason = "parts of one structure, borrowed apart")]
/// As `pair`, in binary64: nothing is added to p^T x, and |z|^T |b - Q x| is its error.
#[inline(always)]
fn rough_pair<V: Vector>(
    plan: &Plan,
    point: &Point<V>,
    load: &Sparse,
    x: &[Pair<V>],
    z: &[Vec<Pair<V>>],
    weights: &[f64],
    work: &mut [Pair<V>],
    results: &mut [Result<V>],
) {
    for (place, value) in load {
        work[*place as usize] = point.rough(value);
    }
    let mut norm = V::splat(0.0);
    results.fill(Result { re: Double::zero(), im: Double::zero(), radius: V::splat(0.0) });
    for i in 0..plan.n {
        let bound = rough_residual(plan, point, i, x, work);
        norm = (bound * bound).fused(V::splat(weights[i]), norm);
        for (result, z) in results.iter_mut().zip(z) {
            result.radius = z[i].size().fused(bound, result.radius);
        }
    }
    for result in results.iter_mut() {
        result.re.lo = norm;
    }
}

#[expect(clippy::too_many_arguments, reason = "parts of one structure, borrowed apart")]
/// z^T (b - Q x) for each output, its error, and |b - Q x|^2 (kept until `finish`); b - Q x itself into `rest`.
#[inline(always)]
fn pair<V: Vector>(
    plan: &Plan,
    point: &Point<V>,
    load: &Sparse,
    x: &[Vec<Pair<V>>],
    z: &[Vec<Pair<V>>],
    weights: &[f64],
    mut rest: Option<&mut Vec<Pair<V>>>,
    results: &mut [Result<V>],
) {
    let mut norm = V::splat(0.0);
    results.fill(Result { re: Double::zero(), im: Double::zero(), radius: V::splat(0.0) });
    for i in 0..plan.n {
        let (mut re, mut im, mut size) = (Double::zero(), Double::zero(), V::splat(0.0));
        for (place, value) in load {
            if *place as usize == i {
                (re, im, size) = point.exact(value);
            }
        }
        for (j, entry) in &plan.rows[i] {
            let (q_re, q_im, t) = point.exact(entry);
            for x in x {
                let x = x[*j as usize];
                re = re.plus_product(q_re, -x.re);
                im = im.plus_product(q_re, -x.im);
                if entry.c.hi != 0.0 {
                    re = re.plus_product(q_im, x.im);
                    im = im.plus_product(q_im, -x.re);
                }
                size = t.fused(x.size(), size);
            }
        }
        let left = Pair { re: re.sum(), im: im.sum() };
        if let Some(rest) = &mut rest {
            rest[i] = left;
        }
        let count = (plan.rows[i].len() * x.len()) as f64;
        let lost = V::splat((12.0 * count * count + 40.0 * count + 40.0) * U * U) + point.loose;
        let error = size * lost;
        let bound = left.size() + error;
        norm = (bound * bound).fused(V::splat(weights[i]), norm);
        // Rounding of r itself, of the product and of the sum over all rows.
        let slack = left.size().fused(V::splat((plan.n + 8) as f64 * U), error);
        for (result, z) in results.iter_mut().zip(z) {
            let z = z[i];
            let sum = Pair { re: result.re.hi, im: result.im.hi }.plus_product(z, left);
            (result.re.hi, result.im.hi) = (sum.re, sum.im);
            result.radius = z.size().fused(slack, result.radius);
        }
    }
    for result in results.iter_mut() {
        // Until `finish`: the norm in a place that is not used yet.
        result.re.lo = norm;
    }
}

/// Adds p^T x and the bound of the product of residuals.
#[inline(always)]
fn finish<V: Vector>(result: &mut Result<V>, point: &Point<V>, reading: &Sparse, x: &[Vec<Pair<V>>], t: V) {
    let (correction, norm) = (Pair { re: result.re.hi, im: result.im.hi }, result.re.lo);
    let (mut re, mut im, mut size) = (Double::zero(), Double::zero(), V::splat(0.0));
    for (place, entry) in reading {
        let (p_re, p_im, t) = point.exact(entry);
        for x in x {
            let x = x[*place as usize];
            re = re.plus_product(p_re, x.re).plus_product(p_im, -x.im);
            im = im.plus_product(p_re, x.im).plus_product(p_im, x.re);
            size = t.fused(x.size(), size);
        }
    }
    let count = (reading.len() * x.len()) as f64;
    let lost = V::splat((12.0 * count * count + 40.0 * count + 40.0) * U * U) + point.loose;
    let total = |x: Double<V>, correction: V| {
        let (hi, lost) = two_sum(x.hi, correction);
        let (hi, lo) = two_sum(hi, x.lo + lost);
        Double { hi, lo }
    };
    let second = (t * norm).sqrt().over(point.omega.hi);
    let rounding = correction.size() * V::splat(8.0 * U * U) + V::splat(TINY);
    let radius = size.fused(lost, result.radius) + second + rounding;
    result.radius = radius * V::splat(UP);
    result.re = total(re, correction.re);
    result.im = total(im, correction.im);
}
