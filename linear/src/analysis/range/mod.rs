//! A system over a whole range of one parameter. In: a linear system whose numbers are enclosed with their derivatives
//! ([`Jet`]). Out: enclosures of measures, and of their derivatives, for every value of the parameter in the range.
//! They show that a measure cannot have its target value in a range, or that it is monotone there. See
//! docs/method/measures.md.

pub mod largest;
pub mod least;
pub mod linear;
pub mod several;
pub mod together;

use crate::base::{Ball, Dd, Jet, Number, larger, up};
use crate::kernel::complex::Complex;
use crate::kernel::dense::Matrix;
use crate::kernel::dense::enclosure::{self, product};
use crate::kernel::dense::lu::inverse;
use crate::system::{CoordinateId, Form, LinearSystem};
use linear::{JetMatrix, border, solve};
use nalgebra::{DMatrix, SymmetricEigen};

/// Limit of coordinates: the equations are dense, and solved in balls.
pub const MOST: usize = 30;

/// Arcs into which a quarter of a circle is cut at first.
const ARCS: usize = 4;

/// A system whose numbers are valid for every value of a parameter in a range.
#[derive(Clone, Debug)]
pub struct Family<'a> {
    system: &'a LinearSystem,
    /// Whether the derivative of some number with respect to the parameter is not known.
    lost: bool,
    m: Vec<Vec<Number>>,
    c: Vec<Vec<Number>>,
    k: Vec<Vec<Number>>,
    /// The coordinates of the system as combinations of those of M, C and K here, if these are others.
    basis: Option<Vec<Vec<Number>>>,
    /// The mode that is one of the coordinates.
    lead: Option<Lead>,
}

/// A mode that is a coordinate, and of whose omega frequencies are multiples.
#[derive(Clone, Debug)]
struct Lead {
    index: usize,
    omega: Number,
}

/// The direction in which all eigenvalues of K - sigma M move as the parameter grows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Course {
    /// No eigenvalue decreases.
    Rises,
    /// No eigenvalue increases.
    Falls,
}

/// A complex number with its derivative.
#[derive(Clone, Debug)]
pub struct Phasor {
    pub re: Number,
    pub im: Number,
}

impl<'a> Family<'a> {
    /// `lost` means that some derivative was lost on the way to the system. `None` if there are too many coordinates.
    pub fn of(system: &'a LinearSystem, lost: bool) -> Option<Family<'a>> {
        let n = system.n();
        let few = n > 0 && n <= MOST && !system.is_chained() && system.losses.is_none();
        let [m, c, k] = [&system.m, &system.c, &system.k].map(|form| if few { form.entries(n) } else { Vec::new() });
        few.then_some(Family { system, lost, m, c, k, basis: None, lead: None })
    }

    pub fn coordinates(&self) -> usize {
        self.system.n()
    }

    /// The direction of the eigenvalues of K - sigma M, from the weights of the squares alone: if no weight of K
    /// decreases and none of M increases, no eigenvalue decreases (Weyl's monotonicity: R. Bhatia, *Matrix Analysis*, Springer 1997, corollary III.2.3).
    pub fn course(system: &LinearSystem, lost: bool) -> Option<Course> {
        if lost || system.losses.is_some() {
            return None;
        }
        let (k, m) = (weights(&system.k)?, weights(&system.m)?);
        let all = |rising: bool| {
            let way = |slope: &Ball, rising: bool| {
                slope.is_zero() || if rising { slope.is_positive() } else { slope.is_negative() }
            };
            k.iter().all(|slope| way(slope, rising)) && m.iter().all(|slope| way(slope, !rising))
        };
        match (all(true), all(false)) {
            (true, _) => Some(Course::Rises),
            (_, true) => Some(Course::Falls),
            _ => None,
        }
    }

    /// A number that is zero exactly if omega^2 is an eigenvalue of K, M.
    pub fn resonance(&self, omega_squared: &Number) -> Option<Jet> {
        let shifted = |i: usize, j: usize| &self.k[i][j] - &(omega_squared * &self.m[i][j]);
        let n = self.system.n();
        let sizes = self.sizes(omega_squared.enclosure().magnitude().sqrt());
        Some(self.known_jet(border(&JetMatrix::from_fn(n, n, shifted), &sizes, 1)?.s.entry(0, 0)))
    }

    /// The null vectors of K - omega^2 M as columns, if it has `count` of them for the omega^2 in this ball; `None` if
    /// it may have more.
    pub fn modes_at(&self, omega_squared: Ball, count: usize) -> Option<Matrix<Ball>> {
        let n = self.system.n();
        let square = Number::Ball(omega_squared);
        let shifted = |i: usize, j: usize| &self.k[i][j] - &(&square * &self.m[i][j]);
        let sizes = self.sizes(omega_squared.magnitude().sqrt());
        Some(border(&JetMatrix::from_fn(n, n, shifted), &sizes, count)?.x.value)
    }

    /// The derivative of a simple eigenvalue omega^2 of K, M that lies in a ball: x^T (K' - omega^2 M') x / x^T M x.
    pub fn eigenvalue_slope(&self, omega_squared: Ball, x: &Matrix<Ball>) -> Option<Ball> {
        let (slope, mass) = self.reduce(omega_squared, x);
        let slope = slope[(0, 0)] / mass[(0, 0)];
        (!self.lost && slope.is_finite()).then_some(slope)
    }

    /// The derivatives of eigenvalues that are equal, or not separated: those of K' - omega^2 M' and M on their
    /// vectors. Returns a ball that contains them all, and their individual values without a bound.
    pub fn cluster_slopes(&self, omega_squared: Ball, x: &Matrix<Ball>) -> Option<(Ball, Vec<f64>)> {
        let count = x.columns();
        let (slope, mass) = self.reduce(omega_squared, x);
        let still = |value: Matrix<Ball>| JetMatrix { slope: Matrix::none(value.rows(), value.columns()), value };
        let quotient = solve(&still(mass.clone()), &still(slope.clone()))?.value;
        let trace = (0..count).fold(Ball::ZERO, |sum, i| sum + quotient[(i, i)]);
        let mean = trace / Ball::from(count as f64);
        // Gershgorin: no eigenvalue is farther from the mean than the largest row sum.
        let row = |i: usize| -> f64 {
            let left = |j: usize| if i == j { quotient[(i, j)] - mean } else { quotient[(i, j)] };
            (0..count).map(|j| left(j).magnitude()).sum()
        };
        let farthest = (0..count).map(row).fold(0.0, larger) * up::THOUSANDS;
        let all = Ball::exact(mean.mid).widen(farthest + mean.rad);
        let each = each_eigenvalue(&slope, &mass)?;
        (!self.lost && all.is_finite()).then_some((all, each))
    }

    /// X^T (K' - omega^2 M') X and X^T M X
    fn reduce(&self, omega_squared: Ball, x: &Matrix<Ball>) -> (Matrix<Ball>, Matrix<Ball>) {
        let (n, count) = (self.system.n(), x.columns());
        let (mut slope, mut mass) = (Matrix::none(count, count), Matrix::none(count, count));
        for i in 0..n {
            for j in 0..n {
                let (k, m) = (Jet::of(&self.k[i][j]), Jet::of(&self.m[i][j]));
                let change = k.slope - omega_squared * m.slope;
                for a in 0..count {
                    for b in 0..count {
                        let product = x[(i, a)] * x[(j, b)];
                        slope[(a, b)] = slope[(a, b)] + change * product;
                        mass[(a, b)] = mass[(a, b)] + m.value * product;
                    }
                }
            }
        }
        (slope, mass)
    }

    /// The vector of a simple pole that lies in a rectangle; `None` if the pole may not be simple.
    pub fn motion_at(&self, s: Complex<Ball>) -> Option<Vec<Complex<Ball>>> {
        let n = self.system.n();
        // In the symmetric form, [[R, -I], [-I, -R]] acts on (x, y) like the complex product, with the sign of its
        // second half reversed. Its null vectors come in pairs: i times one is another.
        let q = |i: usize, j: usize| self.quadratic(s, i % n, j % n, |jet| jet.value);
        let entry = |i: usize, j: usize| match (i < n, j < n) {
            (true, true) => q(i, j).re,
            (false, false) => -q(i, j).re,
            _ => -q(i, j).im,
        };
        let matrix = JetMatrix::from_fn(2 * n, 2 * n, |i, j| Number::Ball(entry(i, j)));
        let sizes = self.sizes((s.re.magnitude() + s.im.magnitude()) * 0.75);
        let x = border(&matrix, &[sizes.clone(), sizes].concat(), 2)?.x.value;
        Some((0..n).map(|i| Complex::new(x[(i, 0)], x[(n + i, 0)])).collect())
    }

    /// x^H M x, x^H C x and x^H K x of the vector x of a simple pole with im s != 0, from its parts with their derivatives. As these numbers
    /// m, c, k are real, re s = -c / 2m, |s|^2 = k / m and zeta = c / (2 sqrt(k m)).
    pub fn energies(&self, re: &Jet, im: &Jet) -> Option<[Number; 3]> {
        let n = self.system.n();
        let (a, b) = (number(re.clone()), number(im.clone()));
        let two = Number::from(2);
        let (real_square, imaginary_square) = (&a.square() - &b.square(), &two * &(&a * &b));
        let real = |i: usize, j: usize| &(&(&real_square * &self.m[i][j]) + &(&a * &self.c[i][j])) + &self.k[i][j];
        let imaginary = |i: usize, j: usize| &(&imaginary_square * &self.m[i][j]) + &(&b * &self.c[i][j]);
        // The form of `motion_at`.
        let matrix = JetMatrix::from_fn(2 * n, 2 * n, |i, j| match (i < n, j < n) {
            (true, true) => real(i, j),
            (false, false) => -&real(i - n, j - n),
            _ => -&imaginary(i % n, j % n),
        });
        let sizes = self.sizes((re.value.magnitude() + im.value.magnitude()) * 0.75);
        let x = border(&matrix, &[sizes.clone(), sizes].concat(), 2)?.x;
        let x: Vec<[Number; 2]> = (0..n).map(|i| [number(x.entry(i, 0)), number(x.entry(n + i, 0))]).collect();
        let of = |form: &[Vec<Number>]| {
            let mut sum = Number::ZERO;
            for (i, [re, im]) in x.iter().enumerate() {
                sum = &sum + &(&form[i][i] * &(&re.square() + &im.square()));
                for (j, [other_re, other_im]) in x.iter().enumerate().skip(i + 1) {
                    let product = &(re * other_re) + &(im * other_im);
                    sum = &sum + &(&two * &(&form[i][j] * &product));
                }
            }
            sum
        };
        (!self.lost).then(|| [of(&self.m), of(&self.c), of(&self.k)])
    }

    /// Whether there is certainly no pole in a rectangle, for any value of the range: s^2 M + s C + K is regular, which elimination
    /// shows after the inverse of its middle has been taken to the left.
    pub fn has_no_pole_at(&self, s: Complex<Ball>) -> bool {
        let n = self.system.n();
        let q = Matrix::from_fn(n, n, |i, j| self.quadratic(s, i, j, |jet| jet.value));
        let entry = |i: usize, j: usize| match (i < n, j < n) {
            (true, true) | (false, false) => q[(i % n, j % n)].re,
            (true, false) => -q[(i, j - n)].im,
            (false, true) => q[(i - n, j)].im,
        };
        is_regular(&Matrix::from_fn(2 * n, 2 * n, entry))
    }

    /// Whether there is certainly no pole with |s| = `size`, for any value of the range, so that the number of those inside is the same
    /// for all: the circle is covered by rectangles, at most `most` of them.
    pub fn has_no_pole_of_size(&self, size: f64, most: usize) -> bool {
        // ((1 - t^2) + 2 t i) / (1 + t^2) from 1 to i; the other quarter is its image, and the lower half its conjugate.
        let along = |t: f64| [size * ((1.0 - t * t) / (1.0 + t * t)), size * (2.0 * t / (1.0 + t * t))];
        let mut open: Vec<[f64; 2]> = (0..ARCS).map(|i| [i, i + 1].map(|i| i as f64 / ARCS as f64)).collect();
        let mut looked_at = 0;
        while let Some([from, to]) = open.pop() {
            let ([right, low], [left, high]) = (along(from), along(to));
            let off = size * 8.0 * f64::EPSILON;
            let (re, im) = (ball_between(left - off, right + off), ball_between(low - off, high + off));
            if self.has_no_pole_at(Complex::new(re, im)) && self.has_no_pole_at(Complex::new(-re, im)) {
                continue;
            }
            looked_at += 1;
            let middle = 0.5 * (from + to);
            if looked_at > most || !(from < middle && middle < to) {
                return false;
            }
            open.extend([[from, middle], [middle, to]]);
        }
        true
    }

    /// Whether certainly no eigenvalue is equal to this number, for any value of the range.
    pub fn has_no_eigenvalue_at(&self, square: f64) -> bool {
        let (n, square) = (self.system.n(), Ball::from(square));
        let entry = |i: usize, j: usize| self.k[i][j].enclosure() - square * self.m[i][j].enclosure();
        is_regular(&Matrix::from_fn(n, n, entry))
    }

    /// Whether M is certainly regular for every value of the range.
    pub fn has_regular_mass(&self) -> bool {
        let n = self.system.n();
        is_regular(&Matrix::from_fn(n, n, |i, j| self.m[i][j].enclosure()))
    }

    /// Whether M and K are certainly regular for every value of the range.
    pub fn is_held(&self) -> bool {
        let n = self.system.n();
        self.has_regular_mass() && is_regular(&Matrix::from_fn(n, n, |i, j| self.k[i][j].enclosure()))
    }

    /// The effective mass of a mode under the motion of a base, as `measures::effective_mass` defines it, from the mode's omega^2 with
    /// its derivative; `None` if it may not be simple.
    pub fn effective_mass(&self, input: usize, omega_squared: &Jet) -> Option<Jet> {
        let n = self.system.n();
        let [static_part, _, inertia] = &self.system.inputs.get(input)?.b;
        let [static_part, inertia] = [static_part, inertia].map(|entries| self.column(entries));
        let matrix = |form: &[Vec<Number>]| JetMatrix::from_fn(n, n, |i, j| form[i][j].clone());
        let carried = solve(&matrix(&self.k), &JetMatrix::from_fn(n, 1, |i, _| static_part[i].clone()))?;
        let carried: Vec<Number> = (0..n).map(|i| number(carried.entry(i, 0))).collect();
        let square = number(omega_squared.clone());
        let shifted = |i: usize, j: usize| &self.k[i][j] - &(&square * &self.m[i][j]);
        let sizes = self.sizes(omega_squared.value.magnitude().sqrt());
        // Along the eigenvalue s vanishes, so that x and its derivative are those of the shape.
        let x = border(&JetMatrix::from_fn(n, n, shifted), &sizes, 1)?.x;
        let x: Vec<Number> = (0..n).map(|i| number(x.entry(i, 0))).collect();
        let times = |v: &[Number], i: usize| (0..n).fold(Number::ZERO, |sum, j| &sum + &(&self.m[i][j] * &v[j]));
        let along = |i: usize| &x[i] * &(&times(&carried, i) - &inertia[i]);
        let product = (0..n).fold(Number::ZERO, |sum, i| &sum + &along(i));
        let own = (0..n).fold(Number::ZERO, |sum, i| &sum + &(&x[i] * &times(&x, i)));
        let mass = self.jet_of(&product.square().checked_div(&own)?);
        mass.value.is_finite().then_some(mass)
    }

    /// The derivative of a simple pole that lies in a rectangle: -x^T (s^2 M' + s C' + K') x / x^T (2 s M + C) x.
    pub fn pole_slope(&self, s: Complex<Ball>, x: &[Complex<Ball>]) -> Option<Complex<Ball>> {
        let real = |ball: Ball| Complex::new(ball, Ball::ZERO);
        let (mut over, mut under) = (real(Ball::ZERO), real(Ball::ZERO));
        for (i, a) in x.iter().enumerate() {
            for (j, b) in x.iter().enumerate() {
                let product = *a * *b;
                over = over + self.quadratic(s, i, j, |jet| jet.slope) * product;
                let [m, c] = [&self.m, &self.c].map(|form| real(Jet::of(&form[i][j]).value));
                under = under + (s * m + s * m + c) * product;
            }
        }
        let size = under.re.square() + under.im.square();
        let quotient = over * Complex::new(under.re, -under.im);
        let (re, im) = (-(quotient.re / size), -(quotient.im / size));
        (!self.lost && re.is_finite() && im.is_finite()).then_some(Complex::new(re, im))
    }

    /// An entry of s^2 M + s C + K, or of its derivative.
    fn quadratic(&self, s: Complex<Ball>, i: usize, j: usize, pick: fn(&Jet) -> Ball) -> Complex<Ball> {
        let of = |form: &[Vec<Number>]| Complex::new(pick(&Jet::of(&form[i][j])), Ball::ZERO);
        s * s * of(&self.m) + s * of(&self.c) + of(&self.k)
    }

    /// The damping ratio c / (2 sqrt(k m)) of a single coordinate with positive stiffness and mass; below one it is
    /// that of its motion.
    pub fn single_ratio(&self) -> Option<Number> {
        if self.system.n() != 1 {
            return None;
        }
        let root = (&self.k[0][0] * &self.m[0][0]).sqrt()?;
        self.k[0][0].is_positive().then(|| self.c[0][0].checked_div(&(&root * &Number::from(2)))).flatten()
    }

    /// c^2 - 4 k m of a single coordinate: zero if its damping is critical.
    pub fn single_discriminant(&self) -> Option<Number> {
        let four = Number::from(4);
        (self.system.n() == 1).then(|| &self.c[0][0].square() - &(&four * &(&self.k[0][0] * &self.m[0][0])))
    }

    /// A frequency in rad/s, from one in the units of the family.
    fn omega(&self, omega: &Number) -> Number {
        self.lead.as_ref().map_or_else(|| omega.clone(), |lead| omega * &lead.omega)
    }

    /// What acts on each coordinate, from what acts on those of the system: X^T b.
    fn column(&self, entries: &[(CoordinateId, Number)]) -> Vec<Number> {
        let mut list = vec![Number::ZERO; self.system.n()];
        for (i, value) in entries {
            match &self.basis {
                None => list[i.index()] = &list[i.index()] + value,
                Some(basis) => {
                    for (own, part) in list.iter_mut().zip(&basis[i.index()]) {
                        *own = &*own + &(part * value);
                    }
                }
            }
        }
        list
    }

    /// H(i omega) from an input to an output; `None` if it may be infinite.
    pub fn response(&self, input: usize, output: usize, omega: &Number) -> Option<Phasor> {
        let n = self.system.n();
        let path = self.path(input, output, omega)?;
        let found = complex_solved(n, |i, j| self.dynamic(i, j, omega), |i| path.b[i].clone())?;
        let x: Vec<Phasor> = found.iter().map(|(re, im)| self.phasor(re, im)).collect();
        Some(path.p.iter().zip(&x).fold(path.d, |sum, (p, x)| sum.plus(&p.times(x))))
    }

    /// 1 / H(i omega): the input that makes the output 1; `None` if H may be zero. It is zero, and so finite, at
    /// resonances.
    pub fn inverse_response(&self, input: usize, output: usize, omega: &Number) -> Option<Phasor> {
        let n = self.system.n();
        let path = self.path(input, output, omega)?;
        // Q x - b u = 0, p x + d u = 1
        let entry = |i: usize, j: usize| match (i < n, j < n) {
            (true, true) => self.dynamic(i, j, omega),
            (true, false) => path.b[i].negate(),
            (false, true) => path.p[j].clone(),
            (false, false) => path.d.clone(),
        };
        let right = |i: usize| if i < n { Phasor::ZERO } else { Phasor { re: Number::ONE, im: Number::ZERO } };
        let found = complex_solved(n + 1, entry, right)?;
        let (re, im) = found.last()?;
        Some(self.phasor(re, im))
    }

    fn phasor(&self, re: &Jet, im: &Jet) -> Phasor {
        Phasor { re: number(self.known_jet(re.clone())), im: number(self.known_jet(im.clone())) }
    }

    /// An entry of K - omega^2 M + i omega C.
    fn dynamic(&self, i: usize, j: usize, omega: &Number) -> Phasor {
        let square = omega.square();
        let re = match &self.lead {
            Some(lead) if lead.index == i || lead.index == j => &(&Number::ONE - &square) * &self.m[i][j],
            _ => &self.k[i][j] - &(&square * &self.m[i][j]),
        };
        Phasor { re, im: omega * &self.c[i][j] }
    }

    /// The effect of an input, the row of an output, and the direct feed-through.
    fn path(&self, input: usize, output: usize, omega: &Number) -> Option<Path> {
        let out = self.system.outputs.get(output)?;
        let through = |power: usize| {
            let entries = out.d[power].iter().filter(|(known, _)| *known as usize == input);
            entries.fold(Number::ZERO, |sum, (_, value)| &sum + value)
        };
        let omega = &self.omega(omega);
        let d = Phasor { re: &through(0) - &(&omega.square() * &through(2)), im: omega * &through(1) };
        let at = |parts: &[Vec<(CoordinateId, Number)>; 3]| at(parts.each_ref().map(|part| self.column(part)), omega);
        Some(Path { b: at(&self.system.inputs.get(input)?.b), p: at(&out.p), d })
    }

    /// The magnitude of the diagonal terms of each row of s^2 M + s C + K.
    fn sizes(&self, s: f64) -> Vec<f64> {
        let size = |form: &[Vec<Number>], i: usize| form[i][i].enclosure().magnitude();
        let sum = |i: usize| s * s * size(&self.m, i) + s * size(&self.c, i) + size(&self.k, i);
        (0..self.system.n()).map(sum).collect()
    }

    /// The number with an unknown derivative, if derivatives were lost.
    fn known_jet(&self, jet: Jet) -> Jet {
        if self.lost { Jet { slope: Ball::new(Dd::ZERO, f64::INFINITY), ..jet } } else { jet }
    }

    /// Like `known_jet`, for a number that was computed from those of the system.
    pub fn jet_of(&self, number: &Number) -> Jet {
        self.known_jet(Jet::of(number))
    }
}

impl Phasor {
    pub const ZERO: Phasor = Phasor { re: Number::ZERO, im: Number::ZERO };

    pub fn times(&self, other: &Phasor) -> Phasor {
        let re = &(&self.re * &other.re) - &(&self.im * &other.im);
        Phasor { re, im: &(&self.re * &other.im) + &(&self.im * &other.re) }
    }

    pub fn negate(&self) -> Phasor {
        Phasor { re: -&self.re, im: -&self.im }
    }

    pub fn plus(&self, other: &Phasor) -> Phasor {
        Phasor { re: &self.re + &other.re, im: &self.im + &other.im }
    }

    /// Multiplies by size exp(i phase).
    pub fn rotate(&self, size: &Number, phase: &Number) -> Option<Phasor> {
        let (sine, cosine) = phase.sin_cos()?;
        let re = &(&self.re * &cosine) - &(&self.im * &sine);
        let im = &(&self.re * &sine) + &(&self.im * &cosine);
        Some(Phasor { re: &re * size, im: &im * size })
    }

    /// z (i omega)^power; `None` if that divides by a frequency that may be zero.
    pub fn times_power(&self, omega: &Number, power: i32) -> Option<Phasor> {
        let factor = if power < 0 { Number::ONE.checked_div(omega)? } else { omega.clone() };
        let turned = |z: Phasor| match power < 0 {
            true => Phasor { re: &z.im * &factor, im: -&(&z.re * &factor) },
            false => Phasor { re: -&(&z.im * &factor), im: &z.re * &factor },
        };
        Some((0..power.abs()).fold(self.clone(), |z, _| turned(z)))
    }

    /// |z|^2
    pub fn square(&self) -> Number {
        &self.re.square() + &self.im.square()
    }

    /// |z| with its derivative, which is unknown if z may be zero; `None` if it may be infinite.
    pub fn size(&self) -> Option<Jet> {
        let (re, im) = (Jet::of(&self.re), Jet::of(&self.im));
        // A ball of the square of a wide ball has negative numbers in it, which the sizes of both parts have not.
        let hypot = |of: fn(&Ball) -> f64| {
            let (a, b) = (of(&re.value), of(&im.value));
            (a * a + b * b).sqrt()
        };
        let (least, most) = (hypot(Ball::mignitude) * (1.0 - 1e-15), hypot(Ball::magnitude) * (1.0 + 1e-15));
        if !most.is_finite() {
            return None;
        }
        let middle = 0.5 * (least + most);
        let wide = Ball::from(middle).widen((most - middle).max(middle - least) * up::FEW);
        let narrow = self.square().sqrt().map(|size| Jet::of(&size).value).filter(|size| size.rad < wide.rad);
        let value = narrow.unwrap_or(wide);
        if least <= 0.0 {
            return Some(Jet { value, slope: Ball::new(Dd::ZERO, f64::INFINITY) });
        }
        let slope = (re.value * re.slope + im.value * im.slope) / value;
        Some(Jet { value, slope })
    }
}

fn number(jet: Jet) -> Number {
    Number::from(jet)
}

fn ball_between(low: f64, high: f64) -> Ball {
    let middle = 0.5 * (low + high);
    Ball::from(middle).widen((high - middle).max(middle - low) * up::FEW)
}

/// Whether a matrix is certainly regular: elimination shows it after the inverse of its middle has been taken to the left.
fn is_regular(a: &Matrix<Ball>) -> bool {
    let Some(inverse) = inverse(a.mid()) else { return false };
    let nearly_one = product(&inverse.map(Ball::exact), a);
    enclosure::solve(&nearly_one, &Matrix::none(a.rows(), 1)).is_some()
}

/// The path from an input to an output at a frequency.
struct Path {
    b: Vec<Phasor>,
    p: Vec<Phasor>,
    d: Phasor,
}

/// A^-1 b of complex numbers, as a real system of real and imaginary parts.
fn complex_solved(
    n: usize,
    entry: impl Fn(usize, usize) -> Phasor,
    right: impl Fn(usize) -> Phasor,
) -> Option<Vec<(Jet, Jet)>> {
    let matrix = JetMatrix::from_fn(2 * n, 2 * n, |i, j| {
        let z = entry(i % n, j % n);
        match (i < n, j < n) {
            (true, true) | (false, false) => z.re,
            (true, false) => -&z.im,
            (false, true) => z.im,
        }
    });
    let right = JetMatrix::from_fn(2 * n, 1, |i, _| if i < n { right(i).re } else { right(i - n).im });
    let found = solve(&matrix, &right)?;
    Some((0..n).map(|i| (found.entry(i, 0), found.entry(n + i, 0))).collect())
}

/// c0 + i omega c1 - omega^2 c2
fn at([c0, c1, c2]: [Vec<Number>; 3], omega: &Number) -> Vec<Phasor> {
    let square = omega.square();
    let along = |(c0, (c1, c2)): (&Number, (&Number, &Number))| Phasor { re: c0 - &(&square * c2), im: omega * c1 };
    c0.iter().zip(c1.iter().zip(&c2)).map(along).collect()
}

/// Two systems without damping between which the systems of a range lie: with every weight of K at its least and of M at its
/// largest, and the reverse. With M positive definite in the latter, the count of eigenvalues below any sigma >= 0 is at most that
/// of the former and at least that of the latter (Weyl, as above). `None` if a row changes.
pub fn outer(system: &LinearSystem) -> Option<[LinearSystem; 2]> {
    weights(&system.k).and(weights(&system.m))?;
    let end = |weight: &Number, sign: f64| match weight {
        Number::Jet(jet) => {
            let Ball { mid, rad } = jet.value;
            let end = mid + Dd::from(sign * rad);
            Number::Ball(Ball::new(end, 2.0 * Dd::EPSILON * (mid.hi.abs() + rad)))
        }
        weight => weight.clone(),
    };
    let side = |k_sign: f64| LinearSystem {
        k: system.k.clone().with_weights(|weight| end(weight, k_sign)),
        m: system.m.clone().with_weights(|weight| end(weight, -k_sign)),
        c: Form::new(),
        ..system.clone()
    };
    Some([side(-1.0), side(1.0)])
}

/// The derivatives of the weights; `None` if a row changes too.
fn weights(form: &Form) -> Option<Vec<Ball>> {
    let still = |(_, entry): (&CoordinateId, &Number)| Jet::of(entry).slope.is_zero();
    let terms = form.terms();
    terms.map(|term| form.row(term).iter().all(still).then(|| Jet::of(term.weight).slope)).collect()
}

/// The eigenvalues of a symmetric matrix relative to a positive definite one, ascending, in binary64.
fn each_eigenvalue(slope: &Matrix<Ball>, mass: &Matrix<Ball>) -> Option<Vec<f64>> {
    let count = slope.rows();
    let plain =
        |a: &Matrix<Ball>| DMatrix::from_fn(count, count, |i, j| (a[(i, j)].to_f64() + a[(j, i)].to_f64()) / 2.0);
    let root = plain(mass).cholesky()?.l();
    let inverse = root.try_inverse()?;
    let eigen = SymmetricEigen::try_new(&inverse * plain(slope) * inverse.transpose(), f64::EPSILON, 1000)?;
    let mut each: Vec<f64> = eigen.eigenvalues.iter().copied().collect();
    each.sort_by(f64::total_cmp);
    Some(each)
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::analysis::test_systems::{blank, push};
    use crate::system::Nature;

    /// A parameter over a range about a number.
    fn parameter(at: f64) -> Number {
        Jet::of_parameter(Ball::from(at).widen(1e-9))
    }

    /// Uncoupled oscillators.
    fn side_by_side(masses: &[Number], springs: &[Number]) -> LinearSystem {
        let mut system = blank(masses.len());
        let label = system.coordinates[0].name;
        for (form, weights) in [(&mut system.m, masses), (&mut system.k, springs)] {
            let source = form.source(label);
            for (i, weight) in weights.iter().enumerate() {
                form.push(source, Nature::Property, weight.clone(), [(CoordinateId(i as u32), Number::ONE)]);
            }
        }
        system
    }

    /// Poles at +- 2i and +- i sqrt p, p from 8.41 to 9.61: 2.9 to 3.1.
    #[test]
    fn a_rectangle_that_a_pole_may_reach_is_not_free_of_poles() {
        let p = Jet::of_parameter(Ball::from(9.01).widen(0.6));
        let system = side_by_side(&[Number::ONE, Number::ONE], &[Number::from(4), p]);
        let family = Family::of(&system, false).expect("a family");
        let has_none = |re: f64, im: f64, reach: f64| {
            family.has_no_pole_at(Complex::new(Ball::from(re).widen(reach), Ball::from(im).widen(reach)))
        };
        for (re, im, reach) in
            [(0.0, 2.0, 0.0), (0.05, 2.0, 0.06), (0.0, 2.95, 0.0), (0.0, -3.09, 0.0), (0.1, 3.0, 0.11)]
        {
            assert!(!has_none(re, im, reach), "{re} {im} {reach}");
        }
        for (re, im, reach) in [(0.0, 2.5, 0.1), (0.3, 2.0, 0.1), (0.3, 3.0, 0.05), (0.0, 0.0, 0.5), (-4.0, 7.0, 0.4)] {
            assert!(has_none(re, im, reach), "{re} {im} {reach}");
        }
    }

    #[test]
    fn frequencies_rise_with_a_spring_and_fall_with_a_mass() {
        let (one, p) = (Number::ONE, parameter(1.0));
        let course = |m: &Number, k: &Number, lost: bool| {
            Family::course(&side_by_side(std::slice::from_ref(m), std::slice::from_ref(k)), lost)
        };
        assert_eq!(course(&one, &p, false), Some(Course::Rises));
        assert_eq!(course(&p, &one, false), Some(Course::Falls));
        assert_eq!(course(&p, &p, false), None);
        assert_eq!(course(&one, &p, true), None, "a derivative is lost");
    }

    /// Masses of 1 to 3 kg and springs of 3 to 7 N/m: 3 / 3 and 7 / 1; and a row that changes.
    #[test]
    fn outer_systems_have_every_weight_at_an_end() {
        let over = |middle: f64, reach: f64| Jet::of_parameter(Ball::from(middle).widen(reach));
        let [low, high] = outer(&side_by_side(&[over(2.0, 1.0)], &[over(5.0, 2.0)])).expect("still rows");
        let weights = |system: &LinearSystem| [&system.k, &system.m].map(|form| form.term(0).weight.to_f64());
        for (found, truth) in [weights(&low), weights(&high)].concat().iter().zip([3.0, 3.0, 7.0, 1.0]) {
            // Radii are rounded upwards.
            assert!((found - truth).abs() < 1e-14, "{found} {truth}");
        }
        let mut moving = side_by_side(&[Number::ONE], &[Number::ONE]);
        let source = moving.k.source(moving.coordinates[0].name);
        moving.k.push(source, Nature::Property, Number::ONE, [(CoordinateId(0), over(1.0, 0.1))]);
        assert!(outer(&moving).is_none());
    }

    /// omega^2 = 1/p at p = 2 has the slope -1/4; if a derivative was lost there is none.
    #[test]
    fn the_slope_of_a_frequency_is_that_of_its_mass() {
        let system = side_by_side(&[parameter(2.0)], &[Number::ONE]);
        let slope = |lost: bool| {
            let family = Family::of(&system, lost).expect("small");
            let square = Ball::from(0.5).widen(1e-9);
            let x = family.modes_at(square, 1).expect("regular");
            family.eigenvalue_slope(square, &x)
        };
        let found = slope(false).expect("a slope");
        assert!((found.to_f64() + 0.25).abs() <= found.rad && found.rad < 1e-6, "{found:?}");
        assert_eq!(slope(true), None);
        let jet = Family::of(&system, true).expect("small").jet_of(&parameter(2.0));
        assert!(jet.slope.rad.is_infinite() && jet.value.is_finite());
    }

    /// -c/2 +- i sqrt(4 - c^2) / 2 at c = 1.2: the real part has the slope -1/2.
    #[test]
    fn the_slope_of_a_pole_needs_every_derivative() {
        let mut system = blank(1);
        push(&mut system.m, "1", 0, None);
        push(&mut system.k, "1", 0, None);
        let source = system.c.source(system.coordinates[0].name);
        system.c.push(source, Nature::Property, parameter(1.2), [(CoordinateId(0), Number::ONE)]);
        let slope = |lost: bool| {
            let family = Family::of(&system, lost).expect("small");
            let s = Complex::new(Ball::from(-0.6).widen(1e-9), Ball::from(0.8).widen(1e-9));
            let x = family.motion_at(s).expect("regular");
            family.pole_slope(s, &x)
        };
        let found = slope(false).expect("a slope").re;
        assert!((found.to_f64() + 0.5).abs() <= found.rad && found.rad < 1e-6, "{found:?}");
        assert!(slope(true).is_none());
    }

    /// Two equal frequencies, one of which moves: the reported enclosure contains both slopes, 0 and 1.
    #[test]
    fn slopes_of_a_cluster_hold_each_of_them() {
        let system = side_by_side(&[Number::ONE, Number::ONE], &[parameter(1.0), Number::ONE]);
        let family = Family::of(&system, false).expect("small");
        let square = Ball::ONE.widen(1e-9);
        let x = family.modes_at(square, 2).expect("regular");
        let (all, _) = family.cluster_slopes(square, &x).expect("slopes");
        for slope in [0.0, 1.0] {
            assert!((all.to_f64() - slope).abs() <= all.rad * (1.0 + 1e-12), "{all:?} {slope}");
        }
    }
}
