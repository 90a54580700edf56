//! Eigenvalues of diag(D) - rho b v^T for many rho side by side, one in each lane, with proved bounds of their errors. In: the D_j, real
//! ones and conjugate pairs, the b_j and v_j, and a bound of the 2-norm of what the true matrix has besides. Out: for each rho all
//! eigenvalues, each from
//!
//!   F(s) = 1 + rho sum_j b_j v_j / (s - D_j),
//!
//! as its distance from an origin near it, so that no difference cancels. See docs/method/studies.md#one-weight-and-all-poles.

mod course;

use crate::base::{Ball, Dd};
use crate::kernel::complex::Complex;
use crate::kernel::simd::{MOST, Vector, simd};
use course::Course;
pub use course::{Root, Stretch};

/// The unit roundoff.
pub(super) const U: f64 = f64::EPSILON / 2.0;

/// diag(D) and what any factor between zero and an end adds to it. Conjugates follow their originals.
#[derive(Clone, Debug)]
pub struct Changed<E> {
    pub(super) equation: E,
    /// The sign of all factors.
    direction: f64,
    pub(super) stretches: Vec<Stretch>,
}

/// A matrix diag(D) - rho b v^T.
pub type RankOne = Changed<Terms>;

/// A function F whose zeros are the eigenvalues of diag(D) and what a factor adds, and the proof that one lies near a number.
pub trait Equation: Sized {
    /// The D_j.
    fn poles(&self) -> &[Complex<Dd>];
    /// What the eigenvalue that begins at a pole moves by for a small factor, over this.
    fn departure(&self, pole: usize) -> Complex<f64>;
    /// An upper bound of its size, whatever cancels.
    fn pull(&self, pole: usize) -> f64;
    /// What leads to an eigenvalue, at a distance from an origin.
    fn look(&self, from: &Differences, tau: [f64; 2], rho: f64) -> Look;
    /// A bound of the relative error of a sum over the poles.
    fn rounding(&self) -> f64;
    /// A bound of the 2-norm of what the true matrix has besides.
    fn eta<V: Vector>(&self, rho: V) -> V;
    /// An eigenvalue that moves along its course, with room for a pass over the poles.
    fn moving<V: Vector>(
        &self,
        from: &Differences,
        root: &Root,
        start: [V; 2],
        of: &Cases<V>,
        room: &mut Vec<Inverse<V>>,
    ) -> Found<V>;
    /// An eigenvalue that stays at its pole as far as can be seen. The differences are without the origin.
    fn staying<V: Vector>(
        &self,
        from: &Differences,
        root: &Root,
        of: &Cases<V>,
        room: &mut Vec<Inverse<V>>,
    ) -> Found<V>;
    /// [`on_stretch`], compiled for each kind of processor.
    fn follow(of: &Changed<Self>, stretch: &Stretch, factors: &[Factor], found: &mut [Eigenvalue]);
}

/// Near an eigenvalue.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// Newton's step.
    pub step: Complex<f64>,
    /// The derivative of the eigenvalue by the factor.
    pub slope: Complex<f64>,
    /// The square of the inverse distance from the nearest pole.
    pub nearest: f64,
}

/// 1 / (s - D_j), its square, the sum of the sizes of its parts, and the square of its size.
#[derive(Clone, Copy, Debug)]
pub struct Inverse<V> {
    pub q: [V; 2],
    pub square: [V; 2],
    pub parts: V,
    pub size: V,
}

/// The sum in F.
#[derive(Clone, Debug)]
pub struct Terms {
    poles: Vec<Complex<Dd>>,
    /// The true matrix differs by at most the first, and the second times |rho|, in the 2-norm.
    off: [f64; 2],
    /// b_j v_j, each within 4 U of its size.
    products: Vec<Complex<f64>>,
    /// Upper bounds of |b_j v_j|, |b_j|^2 and |v_j|^2.
    sizes: Vec<f64>,
    squares: [Vec<f64>; 2],
}

/// A factor of b v^T, and a bound of its relative error.
#[derive(Clone, Copy, Debug)]
pub struct Factor {
    rho: f64,
    error: f64,
}

impl Factor {
    /// No eigenvalue is proved for a factor of no usual size, or not known well.
    pub fn new(rho: f64, error: f64) -> Factor {
        let is_usual = USUAL.contains(&rho.abs()) && (0.0..1e-3).contains(&error);
        Factor { rho: if is_usual { rho } else { f64::NAN }, error }
    }
}

/// One of the D_j, with its b_j and v_j.
#[derive(Clone, Copy, Debug)]
pub struct Pole {
    pub s: Complex<Dd>,
    pub b: Complex<Dd>,
    pub v: Complex<Dd>,
}

/// An eigenvalue: a number in the rectangle of the binary64 number and the bounds. A real one has `im` zero, and no bound of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eigenvalue {
    pub s: Complex<f64>,
    pub bounds: [f64; 2],
}

/// Sizes at which no product or quotient of a few numbers overflows, nor one that underflows matters.
pub(super) const USUAL: std::ops::Range<f64> = 1e-50..1e50;

impl Eigenvalue {
    /// What is enclosed. An imaginary part that is exactly zero has no bound.
    pub fn of(re: Ball, im: Ball) -> Eigenvalue {
        let rounded = [re, im].map(|x| x.to_f64());
        let bound = |x: Ball, rounded: f64| (x - Ball::from(rounded)).magnitude();
        Eigenvalue { s: Complex::new(rounded[0], rounded[1]), bounds: [bound(re, rounded[0]), bound(im, rounded[1])] }
    }

    /// Whether both bounds are at most this share of what they are bounds of.
    pub fn is_accurate(&self, share: f64) -> bool {
        self.bounds[0] <= share * self.s.re.abs() && self.bounds[1] <= share * self.s.im.abs()
    }
}

/// What is tried is a factor with a few roundings.
const ROUNDING: f64 = 16.0 * U;

impl RankOne {
    /// `poles` holds one of each conjugate pair. For the factors from zero to `end`; `None` if numbers have no usual size.
    pub fn new(poles: &[Pole], off: [f64; 2], end: f64) -> Option<RankOne> {
        let mut terms =
            Terms { poles: Vec::new(), off, products: Vec::new(), sizes: Vec::new(), squares: Default::default() };
        for pole in poles {
            terms.push(*pole);
            if !pole.s.im.is_zero() {
                terms.push(Pole { s: pole.s.conj(), b: pole.b.conj(), v: pole.v.conj() });
            }
        }
        let is_small = |x: &f64| *x < USUAL.end;
        let fits = terms.sizes.iter().chain(terms.squares.iter().flatten()).chain(&off).all(is_small)
            && poles.iter().all(|pole| USUAL.contains(&pole.s.to_f64().one_norm()));
        if fits { Changed::along(terms, end) } else { None }
    }
}

impl<E: Equation> Changed<E> {
    /// With the courses of all eigenvalues for the factors from zero to `end`; `None` if that has no usual size.
    pub(super) fn along(equation: E, end: f64) -> Option<Changed<E>> {
        if !USUAL.contains(&end.abs()) {
            return None;
        }
        let stretches = Course { equation: &equation }.stretches(end);
        Some(Changed { equation, direction: end.signum(), stretches })
    }

    /// For each factor all eigenvalues, ascending in size, of one size by their real parts and then their imaginary ones; `None` where
    /// not all are proved to be apart.
    pub fn eigenvalues(&self, factors: &[Factor]) -> Vec<Option<Vec<Eigenvalue>>> {
        let mut found = Vec::with_capacity(factors.len());
        for factors in factors.chunk_by(|a, b| self.place(a.rho) == self.place(b.rho)) {
            match self.place(factors[0].rho).and_then(|at| self.stretches.get(at)) {
                Some(stretch) => {
                    let mut list = vec![NOTHING; stretch.roots.len() * factors.len()];
                    E::follow(self, stretch, factors, &mut list);
                    found.extend(list.chunks(stretch.roots.len()).map(in_order));
                }
                None => found.extend(factors.iter().map(|_| None)),
            }
        }
        found
    }

    /// The factor, from zero on, up to which all bounds are at most this share of what they are bounds of, where that was tried.
    pub fn reach(&self, accuracy: f64) -> f64 {
        let is_accurate = |stretch: &&Stretch| {
            let found = self.eigenvalues(&[Factor::new(stretch.to, ROUNDING)]).pop().flatten();
            let is_known = |one: &Eigenvalue| one.is_accurate(accuracy);
            found.is_some_and(|list| list.iter().all(is_known))
        };
        self.stretches.iter().take_while(is_accurate).last().map_or(0.0, |stretch| stretch.to)
    }

    /// The stretch of a factor.
    fn place(&self, rho: f64) -> Option<usize> {
        let along = rho * self.direction;
        (along > 0.0).then(|| self.stretches.partition_point(|stretch| stretch.to * self.direction < along))
    }
}

impl Terms {
    fn push(&mut self, Pole { s, b, v }: Pole) {
        let squares = [square_above(b), square_above(v)];
        self.poles.push(s);
        self.products.push((b * v).to_f64());
        self.sizes.push(squares[0].sqrt() * squares[1].sqrt() * (1.0 + 4.0 * U));
        for (list, square) in self.squares.iter_mut().zip(squares) {
            list.push(square);
        }
    }
}

/// An upper bound of the square of the size, which no underflow is beyond.
pub(super) fn square_above(z: Complex<Dd>) -> f64 {
    let (re, im) = (z.re.hi, z.im.hi);
    (re * re + im * im) * (1.0 + 16.0 * U) + LEAST
}

/// Below all squares of usual numbers.
const LEAST: f64 = 1e-250;

const NOTHING: Eigenvalue = Eigenvalue { s: Complex { re: f64::NAN, im: f64::NAN }, bounds: [f64::NAN; 2] };

/// All eigenvalues of those with conjugates left out; `None` if one is missing.
fn in_order(some: &[Eigenvalue]) -> Option<Vec<Eigenvalue>> {
    let mut list: Vec<(f64, Eigenvalue)> = Vec::with_capacity(2 * some.len());
    for one in some {
        // Where something is not proved, the real part is no number.
        if !one.s.is_finite() {
            return None;
        }
        let size = one.s.abs();
        // Eigenvalues keep their order along most of a stretch, so that few are moved.
        let mut at = list.len();
        while at > 0 && (size, one.s.re) < (list[at - 1].0, list[at - 1].1.s.re) {
            at -= 1;
        }
        list.insert(at, (size, *one));
        if one.s.im != 0.0 {
            list.insert(at, (size, Eigenvalue { s: one.s.conj(), bounds: one.bounds }));
        }
    }
    Some(list.into_iter().map(|(_, one)| one).collect())
}

/// Ascending in size, of one size by the real parts and then the imaginary ones.
pub fn sort(list: &mut [Eigenvalue]) {
    let order = |a: &Eigenvalue, b: &Eigenvalue| {
        let sizes = a.s.abs().total_cmp(&b.s.abs());
        sizes.then_with(|| a.s.re.total_cmp(&b.s.re)).then_with(|| a.s.im.total_cmp(&b.s.im))
    };
    list.sort_by(order);
}

/// origin - D_j for each j, in two words.
#[derive(Clone, Debug, Default)]
pub struct Differences {
    re: [Vec<f64>; 2],
    im: [Vec<f64>; 2],
    /// One, but zero for the pole that is the origin.
    pub others: Vec<f64>,
    /// The square of the largest difference.
    pub farthest: f64,
}

impl Differences {
    fn of(poles: &[Complex<Dd>], origin: Complex<Dd>) -> Differences {
        let mut found = Differences::default();
        for &pole in poles {
            let d = origin - pole;
            for (list, x) in [(&mut found.re, d.re), (&mut found.im, d.im)] {
                list[0].push(x.hi);
                list[1].push(x.lo);
            }
            let square = d.re.hi * d.re.hi + d.im.hi * d.im.hi;
            found.others.push(if square == 0.0 { 0.0 } else { 1.0 });
            found.farthest = found.farthest.max(square);
        }
        found
    }

    /// With the pole that is the origin so far away that its term is nothing.
    fn without_origin(mut self) -> Differences {
        for (x, other) in self.re[0].iter_mut().zip(&self.others) {
            *x = if *other == 0.0 { FAR } else { *x };
        }
        self
    }
}

/// Its square, and a product with a usual number, is no infinity.
const FAR: f64 = 1e140;

/// F and its derivative, as [real part, imaginary part].
#[derive(Clone, Copy)]
struct Value<V> {
    f: [V; 2],
    slope: [V; 2],
    /// |rho| times the sum of the sizes of the terms.
    size: V,
}

/// 1 / (origin + tau - D_j) for one j, and the square of its size.
#[inline(always)]
pub(super) fn inverse<V: Vector>(from: &Differences, j: usize, tau: [V; 2]) -> ([V; 2], V) {
    // The first sum is exact where it cancels.
    let x = (V::splat(from.re[0][j]) + tau[0]) + V::splat(from.re[1][j]);
    let y = (V::splat(from.im[0][j]) + tau[1]) + V::splat(from.im[1][j]);
    let square = V::splat(1.0) / x.mul_add(x, y * y);
    ([x * square, -(y * square)], square)
}

#[inline(always)]
pub(super) fn times<V: Vector>(a: [V; 2], b: [V; 2]) -> [V; 2] {
    [a[0].mul_add(b[0], -(a[1] * b[1])), a[0].mul_add(b[1], a[1] * b[0])]
}

#[inline(always)]
fn value<V: Vector>(terms: &Terms, from: &Differences, tau: [V; 2], rho: V) -> Value<V> {
    let zero = V::splat(0.0);
    let (mut sum, mut slope, mut size) = ([zero; 2], [zero; 2], zero);
    for (j, c) in terms.products.iter().enumerate() {
        let (q, _) = inverse(from, j, tau);
        let term = times([V::splat(c.re), V::splat(c.im)], q);
        let change = times(term, q);
        sum = [sum[0] + term[0], sum[1] + term[1]];
        slope = [slope[0] - change[0], slope[1] - change[1]];
        size = V::splat(terms.sizes[j]).mul_add(q[0].abs() + q[1].abs(), size);
    }
    Value {
        f: [rho.mul_add(sum[0], V::splat(1.0)), rho * sum[1]],
        slope: [rho * slope[0], rho * slope[1]],
        size: rho.abs() * size,
    }
}

/// The sums that bounds are made of: |rho| sum |b_j v_j| / |s - D_j|^2, sum |b_j|^2 / |s - D_j|^2, sum |v_j|^2 / |s - D_j|^2, and the
/// squares of the inverse distances from the nearest of all poles and of those that are not the origin.
struct Sums<V> {
    slopes: V,
    squares: [V; 2],
    nearest: V,
    nearest_other: V,
}

#[inline(always)]
fn sums<V: Vector>(terms: &Terms, from: &Differences, tau: [V; 2], rho: V) -> Sums<V> {
    let zero = V::splat(0.0);
    let mut of = Sums { slopes: zero, squares: [zero; 2], nearest: zero, nearest_other: zero };
    for j in 0..terms.sizes.len() {
        let (_, square) = inverse(from, j, tau);
        of.slopes = V::splat(terms.sizes[j]).mul_add(square, of.slopes);
        of.squares[0] = V::splat(terms.squares[0][j]).mul_add(square, of.squares[0]);
        of.squares[1] = V::splat(terms.squares[1][j]).mul_add(square, of.squares[1]);
        // `max` takes its second operand where one is NaN, as at a pole itself.
        of.nearest = of.nearest.max(square);
        of.nearest_other = of.nearest_other.max(square * V::splat(from.others[j]));
    }
    of.slopes = of.slopes * rho.abs();
    of
}

/// f / slope
#[inline(always)]
pub(super) fn quotient<V: Vector>(f: [V; 2], slope: [V; 2]) -> [V; 2] {
    let inverse = V::splat(1.0) / slope[0].mul_add(slope[0], slope[1] * slope[1]);
    let product = times(f, [slope[0], -slope[1]]);
    [product[0] * inverse, product[1] * inverse]
}

#[inline(always)]
pub(super) fn length<V: Vector>(z: [V; 2]) -> V {
    z[0].mul_add(z[0], z[1] * z[1]).sqrt()
}

/// Newton's steps from the course of an eigenvalue: the first leaves less than 1e-9 of its distance from poles, the second nothing.
pub(super) const STEPS: usize = 2;
/// A distance from a pole that is not the origin is accurate if it is no smaller a share of the farthest one's.
pub(super) const NEAREST: f64 = 1e-12;

/// What is known of an eigenvalue: its distance from the origin, the radius of a disc about it that holds one eigenvalue, and 1 where that
/// is proved.
#[derive(Clone, Copy, Debug)]
pub struct Found<V> {
    pub tau: [V; 2],
    pub radius: V,
    pub is_proved: V,
}

/// What all eigenvalues of some cases have in common.
#[derive(Clone, Copy, Debug)]
pub struct Cases<V> {
    pub rho: V,
    /// The relative error of a sum, with that of rho.
    pub noise: V,
    /// A bound of the norm of what the matrix has besides.
    pub eta: V,
}

/// 1 in the lanes in which the first number is less than the second. No comparison with NaN holds.
#[inline(always)]
pub(super) fn holds<V: Vector>(least: V, most: V) -> V {
    most.if_exceeds(least, V::splat(1.0), V::splat(0.0))
}

/// An eigenvalue that moves along its course.
#[inline(always)]
fn moving<V: Vector>(terms: &Terms, from: &Differences, root: &Root, start: [V; 2], of: &Cases<V>) -> Found<V> {
    let moves = V::splat(if root.is_real { 0.0 } else { 1.0 });
    let mut tau = start;
    for _ in 0..STEPS {
        let at = value(terms, from, tau, of.rho);
        let step = quotient(at.f, at.slope);
        tau = [tau[0] - step[0], tau[1] - step[1] * moves];
    }
    let at = value(terms, from, tau, of.rho);
    let sums = sums(terms, from, tau, of.rho);
    let slope = length(at.slope);
    let size = at.size.mul_add(of.noise, length(at.f) + V::splat(4.0 * U));
    let resolvent = of.rho.abs() * of.eta * (sums.squares[0] * sums.squares[1]).sqrt();
    let radius = V::splat(1.1) * resolvent.mul_add(V::splat(1.1), size) / slope;
    let is_proved = holds(of.noise * sums.slopes, slope * V::splat(0.005))
        * holds(radius * radius * sums.nearest, V::splat(8e-5))
        * holds(of.eta * of.eta * sums.nearest, V::splat(0.008))
        * holds(radius * sums.slopes * sums.nearest.sqrt(), slope * V::splat(0.009))
        * holds(sums.nearest_other * V::splat(NEAREST * NEAREST * from.farthest), V::splat(1.0));
    Found { tau, radius, is_proved }
}

/// An eigenvalue that stays at its pole as far as can be seen. The differences are without the origin.
#[inline(always)]
fn staying<V: Vector>(terms: &Terms, from: &Differences, root: &Root, of: &Cases<V>) -> Found<V> {
    let tau = [V::splat(0.0); 2];
    let at = value(terms, from, tau, of.rho);
    let sums = sums(terms, from, tau, of.rho);
    let f = length(at.f);
    let own = of.rho.abs() * V::splat(terms.sizes[root.pole]);
    let size = root.origin.to_f64().one_norm();
    let radius = own.mul_add(V::splat(8.0) / f, of.eta.mul_add(V::splat(4.0), V::splat(1e-20 * size)));
    let off = at.size.mul_add(of.noise, V::splat(4.0 * U));
    // Sums of squares on the circle, with the term of the pole inside.
    let inverse = V::splat(1.0) / (radius * radius);
    let square =
        |which: usize| V::splat(terms.squares[which][root.pole]).mul_add(inverse, sums.squares[which] * V::splat(1.03));
    let resolvent = of.rho.abs() * of.eta * square(0).sqrt() * square(1).sqrt();
    let is_proved = holds(radius * radius * sums.nearest, V::splat(8e-5))
        * holds((radius * sums.slopes).mul_add(V::splat(1.02), off), f * V::splat(0.5))
        * holds(own * V::splat(7.9), radius * f)
        * holds(resolvent, f * V::splat(0.25));
    Found { tau, radius, is_proved }
}

impl Equation for Terms {
    fn poles(&self) -> &[Complex<Dd>] {
        &self.poles
    }

    fn departure(&self, pole: usize) -> Complex<f64> {
        -self.products[pole]
    }

    fn pull(&self, pole: usize) -> f64 {
        self.products[pole].abs()
    }

    fn look(&self, from: &Differences, tau: [f64; 2], rho: f64) -> Look {
        let (Value { f, slope, .. }, nearest) = at(self, from, tau, rho);
        let [re, im] = quotient(f, slope);
        let slope = Complex::new(slope[0] * rho, slope[1] * rho).recip();
        Look { step: Complex::new(re, im), slope, nearest }
    }

    // See docs/method/studies.md#one-weight-and-all-poles for this and the numbers above.
    #[inline(always)]
    fn rounding(&self) -> f64 {
        (1.5 * self.poles.len() as f64 + 64.0) * U
    }

    #[inline(always)]
    fn eta<V: Vector>(&self, rho: V) -> V {
        V::splat(self.off[1]).mul_add(rho.abs(), V::splat(self.off[0]))
    }

    #[inline(always)]
    fn moving<V: Vector>(
        &self,
        from: &Differences,
        root: &Root,
        start: [V; 2],
        of: &Cases<V>,
        _: &mut Vec<Inverse<V>>,
    ) -> Found<V> {
        moving(self, from, root, start, of)
    }

    #[inline(always)]
    fn staying<V: Vector>(&self, from: &Differences, root: &Root, of: &Cases<V>, _: &mut Vec<Inverse<V>>) -> Found<V> {
        staying(self, from, root, of)
    }

    fn follow(of: &RankOne, stretch: &Stretch, factors: &[Factor], found: &mut [Eigenvalue]) {
        of_one(of, stretch, factors, found);
    }
}

simd! {
    /// F with its derivative, and the square of the inverse distance from the nearest pole.
    fn at(terms: &Terms, from: &Differences, tau: [f64; 2], rho: f64) -> (Value<f64>, f64) {
        (value(terms, from, tau, rho), sums(terms, from, tau, rho).nearest)
    }
}

simd! {
    fn of_one<V: Vector>(of: &RankOne, stretch: &Stretch, factors: &[Factor], found: &mut [Eigenvalue]) {
        on_stretch::<V, Terms>(of, stretch, factors, found);
    }
}

/// All eigenvalues of factors on one stretch, a lane for each.
#[inline(always)]
pub(super) fn on_stretch<V: Vector, E: Equation>(
    of: &Changed<E>,
    stretch: &Stretch,
    factors: &[Factor],
    found: &mut [Eigenvalue],
) {
    let (equation, count) = (&of.equation, stretch.roots.len());
    let differences: Vec<Differences> = stretch.roots.iter().map(|root| root.differences(equation.poles())).collect();
    let (zero, unknown) = (V::splat(0.0), V::splat(f64::NAN));
    let rounding = V::splat(equation.rounding());
    let mut room = Vec::with_capacity(equation.poles().len());
    let mut discs: Vec<[V; 3]> = Vec::with_capacity(count);
    let mut lanes = [0.0; MOST];
    for (factors, out) in factors.chunks(V::WIDTH).zip(found.chunks_mut(count * V::WIDTH)) {
        lanes.fill(factors[0].rho);
        for (lane, factor) in lanes.iter_mut().zip(factors) {
            *lane = factor.rho;
        }
        let rho = V::load(&lanes);
        lanes.fill(factors[0].error);
        for (lane, factor) in lanes.iter_mut().zip(factors) {
            *lane = factor.error;
        }
        let cases = Cases { rho, noise: V::load(&lanes) + rounding, eta: equation.eta(rho) };
        discs.clear();
        let mut is_proved = V::splat(1.0);
        for (i, (root, from)) in stretch.roots.iter().zip(&differences).enumerate() {
            let Found { tau, radius, is_proved: is_alone } = match root.stays {
                true => equation.staying(from, root, &cases, &mut room),
                false => equation.moving(from, root, root.start(rho, stretch), &cases, &mut room),
            };
            is_proved = is_proved * is_alone;
            let part = |origin: Dd, tau: V| V::splat(origin.hi) + (V::splat(origin.lo) + tau);
            let s = [part(root.origin.re, tau[0]), part(root.origin.im, tau[1])];
            let bound =
                |s: V, tau: V| (s.abs() + tau.abs()).mul_add(V::splat(2.0 * U), radius) * V::splat(1.0 + 8.0 * U);
            let mut bounds = [bound(s[0], tau[0]), bound(s[1], tau[1])];
            match root.is_real {
                true => bounds[1] = zero,
                false => is_proved = is_proved * holds(bounds[1], s[1]),
            }
            discs.push([s[0], s[1], bounds[0].max(bounds[1])]);
            let (re, im) = (s[0].to_array(), s[1].to_array());
            let bounds = bounds.map(V::to_array);
            for (lane, row) in out.chunks_mut(count).enumerate() {
                let s = Complex { re: re[lane], im: im[lane] };
                row[i] = Eigenvalue { s, bounds: [bounds[0][lane], bounds[1][lane]] };
            }
        }
        for (i, a) in discs.iter().enumerate() {
            for b in &discs[..i] {
                let apart = [a[0] - b[0], a[1] - b[1]];
                let both = (a[2] + b[2]) * V::splat(1.0 + 1e-10);
                let square = apart[0].mul_add(apart[0], apart[1] * apart[1]);
                is_proved = square.if_exceeds(both * both, is_proved, zero);
            }
        }
        let doubt = is_proved.if_exceeds(zero, zero, unknown).to_array();
        for (lane, row) in out.chunks_mut(count).enumerate() {
            row.iter_mut().for_each(|one| one.s.re += doubt[lane]);
        }
    }
}

#[cfg(test)]
mod tests;
