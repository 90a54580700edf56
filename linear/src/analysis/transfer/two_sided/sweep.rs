//! The loops over eight or sixteen frequencies: elimination and solutions in binary64, residuals in double-double, and the bound.
//!
//! Rounding, with u = 2^-53 and T = |k| + omega^2 |m| + omega |c| for an entry q = k + s c + s^2 m: an entry in
//! double-double is within (16 u^2 + loose) T. A row of l entries and p parts of the solution is a sum of N = 2 l p
//! real products for each part of a complex number. The sum is accumulated next to a number sigma = 4 sum T |x| that is
//! larger than all of it: the contribution of a product to it, h = fl(sigma + q x) - sigma, is a difference of
//! neighbours, so exact, and the rest q x - h, below 5 u sum T |x|, is rounded once. The rests and the low parts of q
//! stay below (5 N + 3) u sum T |x| and are rounded 2 N times: all in all a row loses at most (40 (l p)^2 + 22 l p +
//! 40) u^2 of sum T |x|, and (2 l + 6) u of it in binary64.

use super::{Lane, NOTHING, Plan, Polynomial, Sparse, TwoSided};
use crate::analysis::transfer::{Disc, Frequency};
use crate::base::{Dd, rounding, up};
use crate::kernel::complex::Complex;
use crate::kernel::lanes::{Double, Pair, two_sum};
use crate::kernel::simd::{MOST, Twice, Vector, each, simd};

/// Working space and results for one set of inputs and outputs, at as many frequencies as there are lanes.
struct Sweep<'a, V> {
    of: &'a TwoSided<'a>,
    loads: &'a [Sparse],
    readings: &'a [Sparse],
    l: Vec<Pair<V>>,
    inverse: Vec<Pair<V>>,
    work: Vec<Pair<V>>,
    entries: Entries<'a, V>,
    /// The solution: a first approximation, and its residual or the correction for that if the first one is not enough.
    x: Vec<Pair<V>>,
    rest: Vec<Pair<V>>,
    /// Q^-1 p of each output, and |p - Q z|.
    z: Vec<Vec<Pair<V>>>,
    loose: f64,
    t: Vec<V>,
    /// Results by input, then output.
    results: Vec<Result<V>>,
    /// The reading that equals a load, if any: then one solution serves both.
    same: Vec<Option<usize>>,
    tolerance: f64,
    /// The best disc so far, by lane, then input, then output.
    discs: Vec<Disc>,
}

#[derive(Clone, Copy)]
struct Result<V> {
    re: Double<V>,
    im: Double<V>,
    radius: V,
}

impl<V: Vector> Result<V> {
    #[inline(always)]
    fn lanes(&self) -> Lanes {
        let part = |x: &Double<V>| [x.hi.to_array(), x.lo.to_array()];
        Lanes { re: part(&self.re), im: part(&self.im), radius: self.radius.to_array() }
    }
}

/// A result taken apart: high and low parts, and radii.
struct Lanes {
    re: [[f64; MOST]; 2],
    im: [[f64; MOST]; 2],
    radius: [f64; MOST],
}

/// The entries of Q at the frequencies: stored if few are distinct, otherwise computed when needed.
struct Entries<'a, V> {
    plan: &'a Plan,
    kept: Vec<Entry<V>>,
}

/// k + s c + s^2 m, and T.
#[derive(Clone, Copy)]
struct Entry<V> {
    re: Double<V>,
    im: Double<V>,
    size: V,
}

/// This many entries for sixteen frequencies fit into the first-level cache.
const MOST_KEPT: usize = 24;

/// Frequencies as lanes.
#[derive(Clone, Copy)]
struct Point<V> {
    omega: Double<V>,
    square: Double<V>,
    /// Uncertainty of the entries, relative to T.
    loose: V,
}

const U: f64 = rounding::UNIT;
/// Covers the roundings of sums of positive numbers: up to a million of them.
const UP: f64 = up::MILLIONS;
/// The error below the range of binary64. Products of numbers near 1e-300 do not occur: gains are far larger, or the
/// radius bounds them.
const TINY: f64 = 1e-300;

/// The input of a sweep.
pub struct Task<'a> {
    pub of: &'a TwoSided<'a>,
    pub loads: &'a [Sparse],
    pub readings: &'a [Sparse],
    /// Relative radius of all numbers.
    pub loose: f64,
    pub frequencies: &'a [Frequency],
    /// The relative error that is sufficient.
    pub tolerance: f64,
}

simd! {
    /// Discs by frequency, then input, then output.
    pub fn discs<V: Vector>(task: &Task) -> Vec<Disc> {
        // Narrower vectors have too few registers for two.
        if V::WIDTH == 8 && task.frequencies.len() > 8 { by_sixteen(task) } else { all::<V>(task) }
    }
}

simd! {
    /// The same, sixteen frequencies at a time, where vectors have eight lanes. Beside the loops of the other width, in one
    /// function, these take several times as long to compile.
    fn by_sixteen<V: Vector>(task: &Task) -> Vec<Disc> {
        if V::WIDTH == 8 { all::<Twice<V>>(task) } else { unreachable!("narrower vectors are not doubled") }
    }
}

#[inline(always)]
fn all<V: Vector>(task: &Task) -> Vec<Disc> {
    let mut discs = Vec::with_capacity(task.frequencies.len() * task.loads.len() * task.readings.len());
    let mut sweep = Sweep::<V>::new(task);
    for chunk in task.frequencies.chunks(V::WIDTH) {
        sweep.run(&each(|i| Lane::of(&chunk[i.min(chunk.len() - 1)])));
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
            entries: Entries { plan: &of.plan, kept: Vec::new() },
            x: zeros(),
            rest: zeros(),
            loose,
            z: readings.iter().map(|_| zeros()).collect(),
            t: vec![V::splat(0.0); readings.len()],
            results: vec![nothing; readings.len()],
            same: loads.iter().map(|load| readings.iter().position(|reading| reading == load)).collect(),
            tolerance,
            discs: vec![NOTHING; V::WIDTH * loads.len() * readings.len()],
        }
    }

    /// Computes all pairs at as many frequencies as the vector has lanes. (There are no closures here: one that is not
    /// inlined is compiled without the vector instructions.)
    #[inline(always)]
    fn run(&mut self, lanes: &[Lane; MOST]) {
        let point = Point::of(lanes, self.loose);
        let plan = &self.of.plan;
        self.entries.move_to(&point);
        factor(&self.entries, &point, &mut self.l, &mut self.inverse, &mut self.work, self.readings, &mut self.z);
        for (y, reading) in self.readings.iter().enumerate() {
            substitute_back(plan, &self.l, &self.inverse, &mut self.z[y]);
            // If the only load equals this reading, both have the same residual.
            if self.loads.len() > 1 || self.same[0] != Some(y) {
                let weights = &self.of.weights;
                self.t[y] = residual_norm(&self.entries, &point, reading, &self.z[y], weights, &mut self.work);
            }
        }
        self.discs.fill(NOTHING);
        'loads: for u in 0..self.loads.len() {
            if self.same[u].is_none() {
                let first = scatter(plan, &point, &self.loads[u], &mut self.x);
                solve(plan, first, &self.l, &self.inverse, &mut self.x);
            }
            // The residual is stored only if it is needed.
            for keep in [false, true] {
                if self.attempt::<1>(u, &point, keep) {
                    continue 'loads;
                }
            }
            // If damping proves little, a solution for the residual makes the product small.
            solve(plan, 0, &self.l, &self.inverse, &mut self.rest);
            self.attempt::<2>(u, &point, false);
        }
    }

    /// The values for an input from `PARTS` parts of the solution; returns whether they are all accurate enough. Values
    /// that already were are kept, so that no lane depends on its neighbours.
    #[inline(always)]
    fn attempt<const PARTS: usize>(&mut self, u: usize, point: &Point<V>, keep: bool) -> bool {
        let (load, weights) = (&self.loads[u], &self.of.weights);
        let first: &[Pair<V>] = self.same[u].map_or(&self.x, |y| &self.z[y]);
        let mut rest = std::mem::take(&mut self.rest);
        if PARTS == 1 {
            let x = [first; PARTS];
            pair(&self.entries, point, load, x, &self.z, weights, keep.then_some(&mut rest), &mut self.results);
        } else {
            let x = each::<_, PARTS>(|part| if part == 0 { first } else { &rest });
            pair(&self.entries, point, load, x, &self.z, weights, None, &mut self.results);
        }
        let x = &[first, &rest][..PARTS];
        if let (1, 1, Some(y)) = (PARTS, self.loads.len(), self.same[u]) {
            self.t[y] = self.results[y].re.lo;
        }
        let outputs = self.readings.len();
        let mut good = true;
        for (y, result) in self.results.iter_mut().enumerate() {
            finish_pair(result, point, &self.readings[y], x, self.t[y]);
            let discs = &mut self.discs[u * outputs + y..];
            good &= store(&result.lanes(), discs, self.loads.len() * outputs, self.tolerance);
        }
        self.rest = rest;
        good
    }
}

impl<V: Vector> Entries<'_, V> {
    #[inline(always)]
    fn move_to(&mut self, point: &Point<V>) {
        self.kept.clear();
        if self.plan.entries.len() <= MOST_KEPT {
            self.kept.extend(self.plan.entries.iter().map(|q| point.exact(q)));
        }
    }

    #[inline(always)]
    fn exact(&self, point: &Point<V>, which: u32) -> Entry<V> {
        match self.kept.get(which as usize) {
            Some(entry) => *entry,
            None => point.exact(&self.plan.entries[which as usize]),
        }
    }

    #[inline(always)]
    fn rough(&self, point: &Point<V>, which: u32) -> Pair<V> {
        match self.kept.get(which as usize) {
            Some(entry) => Pair { re: entry.re.hi, im: entry.im.hi },
            None => point.rough(&self.plan.entries[which as usize]),
        }
    }

    /// T
    #[inline(always)]
    fn size(&self, point: &Point<V>, which: u32) -> V {
        match self.kept.get(which as usize) {
            Some(entry) => entry.size,
            None => point.size(&self.plan.entries[which as usize]),
        }
    }
}

/// Stores each lane where no disc is good enough so far, every `step` discs; returns whether all that were stored are. One
/// lane follows the other here, so this is compiled once: within the vector loops it took as long to compile as they did.
#[inline(never)]
fn store(lanes: &Lanes, discs: &mut [Disc], step: usize, tolerance: f64) -> bool {
    let mut good = true;
    for (lane, disc) in discs.iter_mut().step_by(step).enumerate() {
        if is_good(disc, tolerance) {
            continue;
        }
        let [re, im] = [lanes.re, lanes.im].map(|[hi, lo]| Dd::new(hi[lane], lo[lane]));
        let radius = lanes.radius[lane];
        let known = radius.is_finite() && re.is_finite() && im.is_finite();
        *disc = if known { Disc { value: Complex::new(re, im), radius } } else { NOTHING };
        good &= is_good(disc, tolerance);
    }
    good
}

/// Whether the relative error is below the tolerance, judged by an upper bound of |value|.
fn is_good(disc: &Disc, tolerance: f64) -> bool {
    let size = disc.value.re.hi.abs().max(disc.value.im.hi.abs());
    disc.radius <= size * (tolerance * 0.999)
}

impl<V: Vector> Point<V> {
    #[inline(always)]
    fn of(lanes: &[Lane; MOST], entries: f64) -> Point<V> {
        let of = |part: fn(&Lane) -> f64| V::load(&lanes.each_ref().map(part));
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
            re = (-self.square.hi).mul_add(V::splat(q.m.hi), re);
        }
        let im = if q.c.hi != 0.0 { self.omega.hi * V::splat(q.c.hi) } else { V::splat(0.0) };
        Pair { re, im }
    }

    /// T
    #[inline(always)]
    fn size(&self, q: &Polynomial) -> V {
        let inertia = self.square.hi.mul_add(V::splat(q.m.hi.abs()), V::splat(q.k.hi.abs()));
        self.omega.hi.mul_add(V::splat(q.c.hi.abs()), inertia)
    }

    /// The entry at this frequency in double-double, and T.
    #[inline(always)]
    fn exact(&self, q: &Polynomial) -> Entry<V> {
        let mut re = Double { hi: V::splat(q.k.hi), lo: V::splat(q.k.lo) };
        if q.m.hi != 0.0 {
            let mass = V::splat(-q.m.hi);
            let product = self.square.hi * mass;
            let error = self.square.hi.mul_add(mass, -product);
            let error = self.square.lo.mul_add(mass, self.square.hi.mul_add(V::splat(-q.m.lo), error));
            let (hi, lost) = two_sum(re.hi, product);
            re = Double { hi, lo: re.lo + (error + lost) };
        }
        let mut im = Double::zero();
        if q.c.hi != 0.0 {
            let damping = V::splat(q.c.hi);
            let hi = self.omega.hi * damping;
            let error = self.omega.hi.mul_add(damping, -hi);
            im = Double { hi, lo: self.omega.lo.mul_add(damping, self.omega.hi.mul_add(V::splat(q.c.lo), error)) };
        }
        Entry { re, im, size: self.size(q) }
    }
}

/// Q = L D L^T in the order of the plan, without pivoting; z becomes L^-1 z in the same loop, while the next pivot
/// waits.
#[inline(always)]
fn factor<V: Vector>(
    entries: &Entries<V>,
    point: &Point<V>,
    l: &mut [Pair<V>],
    inverse: &mut [Pair<V>],
    work: &mut [Pair<V>],
    readings: &[Sparse],
    z: &mut [Vec<Pair<V>>],
) {
    let plan = entries.plan;
    for k in 0..plan.n {
        for (reading, z) in readings.iter().zip(z.iter_mut()) {
            z[k] = Pair::zero();
            for (_, value) in reading.iter().filter(|(place, _)| *place as usize == k) {
                z[k] = point.rough(value);
            }
        }
        let mut pivot = Pair::zero();
        for &(row, which) in &plan.columns[k] {
            let value = entries.rough(point, which);
            if row as usize == k {
                pivot = value;
            } else {
                work[row as usize] = value;
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
            // In this order the pivot waits for one product fewer.
            pivot = pivot.minus_product(value.times(value), inverse[i]);
            l[position] = factor;
            for z in z.iter_mut() {
                z[k] = z[k].minus_product(factor, z[i]);
            }
        }
        inverse[k] = pivot.recip();
    }
}

/// Writes a sparse right-hand side; returns its first position.
#[inline(always)]
fn scatter<V: Vector>(plan: &Plan, point: &Point<V>, right: &Sparse, x: &mut [Pair<V>]) -> usize {
    x.fill(Pair::zero());
    for (place, value) in right {
        x[*place as usize] = point.rough(value);
    }
    right.iter().map(|(place, _)| *place as usize).min().unwrap_or(plan.n)
}

/// Replaces the right-hand side, which is zero before `first`, by the solution.
#[inline(always)]
fn solve<V: Vector>(plan: &Plan, first: usize, l: &[Pair<V>], inverse: &[Pair<V>], x: &mut [Pair<V>]) {
    for j in first..plan.n {
        let value = x[j];
        for (&at, l) in plan.column(l, j) {
            let entry = &mut x[at as usize];
            *entry = entry.minus_product(*l, value);
        }
    }
    substitute_back(plan, l, inverse, x);
}

/// x becomes L^-T D^-1 x.
#[inline(always)]
fn substitute_back<V: Vector>(plan: &Plan, l: &[Pair<V>], inverse: &[Pair<V>], x: &mut [Pair<V>]) {
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
    entries: &Entries<V>,
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
    for (i, (weight, row)) in weights.iter().zip(&entries.plan.rows).enumerate() {
        let mut rest = std::mem::replace(&mut work[i], Pair::zero());
        let mut size = rest.size();
        for &(j, which) in row {
            let z = z[j as usize];
            rest = rest.minus_product(entries.rough(point, which), z);
            size = entries.size(point, which).mul_add(z.size(), size);
        }
        let lost = V::splat((2 * row.len() + 8) as f64 * 2.0 * U);
        let bound = size.mul_add(lost, rest.size());
        norm = (bound * bound).mul_add(V::splat(*weight), norm);
    }
    norm
}

/// A sum of products, accumulated next to a number that is larger than all of it.
#[derive(Clone, Copy)]
struct ShiftedSum<V> {
    sum: V,
    rest: V,
    low: V,
}

impl<V: Vector> ShiftedSum<V> {
    /// Adds x y.
    #[inline(always)]
    fn add(&mut self, x: V, y: V) {
        let next = x.mul_add(y, self.sum);
        let taken = next - self.sum;
        self.rest = self.rest + x.mul_add(y, -taken);
        self.sum = next;
    }
}

#[expect(clippy::too_many_arguments, reason = "parts of one structure, borrowed apart")]
/// z^T (b - Q x) for each output, its error, and |b - Q x|^2 (stored until `finish_pair`); b - Q x itself into `rest`.
#[inline(always)]
fn pair<V: Vector, const PARTS: usize>(
    entries: &Entries<V>,
    point: &Point<V>,
    load: &Sparse,
    x: [&[Pair<V>]; PARTS],
    z: &[Vec<Pair<V>>],
    weights: &[f64],
    mut rest: Option<&mut Vec<Pair<V>>>,
    results: &mut [Result<V>],
) {
    let plan = entries.plan;
    let mut norm = V::splat(0.0);
    results.fill(Result { re: Double::zero(), im: Double::zero(), radius: V::splat(0.0) });
    for (i, row) in plan.rows.iter().enumerate() {
        let mut size = V::splat(0.0);
        for &(j, which) in row {
            let t = entries.size(point, which);
            for x in x {
                size = t.mul_add(x[j as usize].size(), size);
            }
        }
        let right = load.iter().find(|(place, _)| *place as usize == i).map(|(_, value)| point.exact(value));
        if let Some(right) = &right {
            size = size + right.size;
        }
        let larger = size * V::splat(4.0);
        let start = ShiftedSum { sum: larger, rest: V::splat(0.0), low: V::splat(0.0) };
        let (mut re, mut im) = (start, start);
        for &(j, which) in row {
            let q = entries.exact(point, which);
            for x in x {
                let x = x[j as usize];
                re.add(q.re.hi, x.re);
                im.add(q.re.hi, x.im);
                re.low = q.re.lo.mul_add(x.re, re.low);
                im.low = q.re.lo.mul_add(x.im, im.low);
                re.add(q.im.hi, -x.im);
                im.add(q.im.hi, x.re);
                re.low = q.im.lo.mul_add(-x.im, re.low);
                im.low = q.im.lo.mul_add(x.re, im.low);
            }
        }
        if let Some(right) = &right {
            let minus = V::splat(-1.0);
            re.add(right.re.hi, minus);
            im.add(right.im.hi, minus);
            re.rest = re.rest - right.re.lo;
            im.rest = im.rest - right.im.lo;
        }
        let left =
            Pair { re: -((re.sum - larger) + (re.rest + re.low)), im: -((im.sum - larger) + (im.rest + im.low)) };
        if let Some(rest) = &mut rest {
            rest[i] = left;
        }
        let count = (row.len() * x.len()) as f64;
        let lost = V::splat((40.0 * count * count + 22.0 * count + 40.0) * U * U) + point.loose;
        let error = size * lost;
        let bound = left.size() + error;
        norm = (bound * bound).mul_add(V::splat(weights[i]), norm);
        // Rounding of r itself, of the product and of the sum over all rows.
        let slack = left.size().mul_add(V::splat((plan.n + 8) as f64 * U), error);
        for (result, z) in results.iter_mut().zip(z) {
            let z = z[i];
            let sum = Pair { re: result.re.hi, im: result.im.hi }.plus_product(z, left);
            (result.re.hi, result.im.hi) = (sum.re, sum.im);
            result.radius = z.size().mul_add(slack, result.radius);
        }
    }
    for result in results.iter_mut() {
        // The norm is kept in an unused field until `finish_pair`.
        result.re.lo = norm;
    }
}

/// Adds p^T x and the bound of the product of residuals.
#[inline(always)]
fn finish_pair<V: Vector>(result: &mut Result<V>, point: &Point<V>, reading: &Sparse, x: &[&[Pair<V>]], t: V) {
    let (correction, norm) = (Pair { re: result.re.hi, im: result.im.hi }, result.re.lo);
    let (mut re, mut im, mut size) = (Double::zero(), Double::zero(), V::splat(0.0));
    for (place, entry) in reading {
        let Entry { re: p_re, im: p_im, size: t } = point.exact(entry);
        for x in x {
            let x = x[*place as usize];
            re = re.plus_product(p_re, x.re).plus_product(p_im, -x.im);
            im = im.plus_product(p_re, x.im).plus_product(p_im, x.re);
            size = t.mul_add(x.size(), size);
        }
    }
    let count = (reading.len() * x.len()) as f64;
    let lost = V::splat((12.0 * count * count + 40.0 * count + 40.0) * U * U) + point.loose;
    let second = (t * norm).sqrt() / point.omega.hi;
    let rounding = correction.size() * V::splat(8.0 * U * U) + V::splat(TINY);
    let radius = size.mul_add(lost, result.radius) + second + rounding;
    result.radius = radius * V::splat(UP);
    result.re = sum(re, correction.re);
    result.im = sum(im, correction.im);
}

/// x + y
#[inline(always)]
fn sum<V: Vector>(x: Double<V>, y: V) -> Double<V> {
    let (hi, lost) = two_sum(x.hi, y);
    let (hi, lo) = two_sum(hi, x.lo + lost);
    Double { hi, lo }
}
