//! A gain over ranges of several parameters. In: systems whose numbers are affine functions of the parameters. Out:
//! |H|^2 at a frequency with its derivatives with respect to the parameters and the frequency, enclosed over a box. See
//! docs/method/measures.md#optima.
//!
//! With H = p x + d u, Q x = b u and y = Q^-T p, where Q = K - omega^2 M + i omega C,
//!
//! ```text
//! H_a  = p_a x + y (b_a - Q_a x) + d_a,    x_a = Q^-1 (b_a - Q_a x)
//! H_ab = p_ab x + p_a x_b + p_b x_a + y (b_ab - Q_ab x - Q_a x_b - Q_b x_a) + d_ab
//! ```

use super::MOST;
use super::linear::middle_inverse;
use crate::base::number::jet::square;
use crate::base::{Ball, Dd, Jet, Number};
use crate::kernel::complex::Complex;
use crate::kernel::dense::Matrix;
use crate::kernel::dense::enclosure::{product, solve};
use crate::kernel::dense::lu::Lu;
use crate::system::{CoordinateId, LinearSystem};

/// A derivative known to this relative error counts as constant; its uncertainty is carried along.
const CONSTANT: f64 = 1e-20;

type Complexes = Complex<Ball>;

/// The path from an input to an output of a system whose numbers are affine functions of parameters between -1 and 1,
/// at frequencies in a unit of its own.
#[derive(Clone, Debug)]
pub struct Affine {
    n: usize,
    parameters: usize,
    /// rad/s
    pub unit: f64,
    /// K, C and M, row by row.
    forms: [Vec<Linear>; 3],
    b: [Vec<Linear>; 3],
    p: [Vec<Linear>; 3],
    d: [Linear; 3],
}

/// A number at the middle of all ranges, and its change with each parameter.
#[derive(Clone, Debug)]
struct Linear {
    value: Ball,
    slopes: Vec<Ball>,
}

/// A real function of the parameters and, last, the frequency, with its first and second derivatives over a box.
#[derive(Clone, Debug)]
pub struct Square {
    pub value: Ball,
    pub slope: Vec<Ball>,
    /// Empty unless asked for.
    pub bend: Vec<Vec<Ball>>,
}

impl Affine {
    /// The path from the system at the middle of all ranges and, for each parameter, the system with its derivatives,
    /// with all parameters anywhere in their ranges; the half widths of the ranges are given. `None` unless all numbers
    /// are affine.
    pub fn of(
        middle: &LinearSystem,
        moved: &[LinearSystem],
        widths: &[Dd],
        (input, output): (usize, usize),
        unit: f64,
    ) -> Option<Affine> {
        let n = middle.n();
        let names = middle.coordinate_names();
        let fits =
            |system: &LinearSystem| n > 0 && n <= MOST && !system.is_chained() && system.coordinate_names() == names;
        if !fits(middle) || !moved.iter().all(fits) {
            return None;
        }
        let numbers = |system: &LinearSystem| numbers(system, n, input, output);
        let centre = numbers(middle)?;
        let others: Option<Vec<Vec<Number>>> = moved.iter().map(numbers).collect();
        let others = others?;
        let mut list = Vec::with_capacity(centre.len());
        for (at, value) in centre.iter().enumerate() {
            let slope = |(i, width): (usize, &Dd)| {
                let slope = Jet::of(&others[i][at]).slope;
                let known = slope.is_finite() && slope.rad <= CONSTANT * slope.mid.hi.abs();
                known.then(|| slope * Ball::exact(*width))
            };
            let slopes: Option<Vec<Ball>> = widths.iter().enumerate().map(slope).collect();
            list.push(Linear { value: value.enclosure(), slopes: slopes? });
        }
        let mut list = list.into_iter();
        let mut take = |count: usize, power: usize| -> Vec<Linear> {
            let scale = (0..power).fold(Ball::ONE, |scale, _| scale * Ball::from(unit));
            let scaled = |linear: Linear| Linear {
                value: linear.value * scale,
                slopes: linear.slopes.iter().map(|slope| *slope * scale).collect(),
            };
            list.by_ref().take(count).map(scaled).collect()
        };
        let forms = [0, 1, 2].map(|power| take(n * n, power));
        let b = [0, 1, 2].map(|power| take(n, power));
        let p = [0, 1, 2].map(|power| take(n, power));
        let mut one = |power: usize| take(1, power).pop();
        let d = [one(0)?, one(1)?, one(2)?];
        Some(Affine { n, parameters: widths.len(), unit, forms, b, p, d })
    }

    pub fn parameters(&self) -> usize {
        self.parameters
    }

    /// H and so |H| divided by this.
    pub fn over(mut self, size: f64) -> Affine {
        let scale = Ball::ONE / Ball::from(size);
        for linear in self.b.iter_mut().flatten().chain(&mut self.d) {
            linear.value = linear.value * scale;
            linear.slopes.iter_mut().for_each(|slope| *slope = *slope * scale);
        }
        self
    }

    /// The path at a place, in binary64.
    pub fn at(&self, place: &[f64]) -> Still {
        let real = |linear: &Linear| {
            linear.slopes.iter().zip(place).fold(linear.value.to_f64(), |sum, (slope, x)| sum + slope.to_f64() * x)
        };
        let list = |list: &Vec<Linear>| list.iter().map(real).collect();
        let all = |lists: &[Vec<Linear>; 3]| lists.each_ref().map(list);
        Still { n: self.n, forms: all(&self.forms), b: all(&self.b), p: all(&self.p), d: self.d.each_ref().map(real) }
    }

    /// |H|^2 over a box with its derivatives, including those of second order if `bends` is set. `None` if it may be
    /// infinite.
    pub fn square(&self, at: &[Ball], omega: Ball, bends: bool) -> Option<Square> {
        let (n, count) = (self.n, self.parameters + 1);
        let point = Point { at, omega };
        let q = Matrix::from_fn(2 * n, 2 * n, |i, j| {
            let z = point.value(self.forms.each_ref().map(|form| &form[i % n * n + j % n]));
            match (i < n, j < n) {
                (true, true) | (false, false) => z.re,
                (true, false) => -z.im,
                (false, true) => z.im,
            }
        });
        let inverse = self.inverse(&q)?;
        let by = |vector: &[Complexes]| -> Vec<Complexes> {
            (0..n).map(|i| (0..n).fold(Complex::ZERO, |sum, j| sum + inverse[i * n + j] * vector[j])).collect()
        };
        let column = |parts: &[Vec<Linear>; 3], of: &dyn Fn([&Linear; 3]) -> Complexes| -> Vec<Complexes> {
            (0..n).map(|i| of(parts.each_ref().map(|part| &part[i]))).collect()
        };
        let b = column(&self.b, &|parts| point.value(parts));
        let p = column(&self.p, &|parts| point.value(parts));
        let x = by(&b);
        let y: Vec<Complexes> =
            (0..n).map(|j| (0..n).fold(Complex::ZERO, |sum, i| sum + p[i] * inverse[i * n + j])).collect();
        let h = dot(&p, &x) + point.value(self.d.each_ref());
        // Q_a v
        let moved = |of: &dyn Fn([&Linear; 3]) -> Complexes, v: &[Complexes]| -> Vec<Complexes> {
            (0..n)
                .map(|i| {
                    (0..n).fold(Complex::ZERO, |sum, j| {
                        let entry = self.forms.each_ref().map(|form| &form[i * n + j]);
                        sum + of(entry) * v[j]
                    })
                })
                .collect()
        };
        let mut first = Vec::with_capacity(count);
        for a in 0..count {
            let of = |parts: [&Linear; 3]| point.slope(parts, a);
            let load = minus(&column(&self.b, &of), &moved(&of, &x));
            let p_a = column(&self.p, &of);
            let h_a = dot(&p_a, &x) + dot(&y, &load) + of(self.d.each_ref());
            let x_a = if bends { by(&load) } else { Vec::new() };
            first.push((h_a, x_a, p_a));
        }
        let two = Ball::from(2.0);
        let slope = first.iter().map(|(h_a, ..)| (h.conj() * *h_a).re * two).collect();
        let value = modulus_squared(h);
        if !value.is_finite() {
            return None;
        }
        if !bends {
            return Some(Square { value, slope, bend: Vec::new() });
        }
        let mut bend = vec![vec![Ball::ZERO; count]; count];
        for a in 0..count {
            for c in 0..=a {
                let of = |parts: [&Linear; 3]| point.bend(parts, a, c);
                let mut load = minus(&column(&self.b, &of), &moved(&of, &x));
                load = minus(&load, &moved(&|parts| point.slope(parts, a), &first[c].1));
                load = minus(&load, &moved(&|parts| point.slope(parts, c), &first[a].1));
                let h_ac = dot(&column(&self.p, &of), &x)
                    + dot(&first[a].2, &first[c].1)
                    + dot(&first[c].2, &first[a].1)
                    + dot(&y, &load)
                    + of(self.d.each_ref());
                let both = (first[a].0.conj() * first[c].0 + h.conj() * h_ac).re * two;
                (bend[a][c], bend[c][a]) = (both, both);
            }
        }
        Some(Square { value, slope, bend })
    }

    /// Q^-1, from its real form.
    fn inverse(&self, q: &Matrix<Ball>) -> Option<Vec<Complexes>> {
        let n = self.n;
        let rough = middle_inverse(q)?;
        let right = Matrix::from_fn(2 * n, n, |i, j| rough[(i, j)]);
        let found = solve(&product(&rough, q), &right).filter(Matrix::is_finite)?;
        Some((0..n * n).map(|at| Complex::new(found[(at / n, at % n)], found[(n + at / n, at % n)])).collect())
    }
}

/// A path with its parameters at one place, in binary64 and without a bound.
pub struct Still {
    n: usize,
    forms: [Vec<f64>; 3],
    b: [Vec<f64>; 3],
    p: [Vec<f64>; 3],
    d: [f64; 3],
}

impl Still {
    /// |H|^2
    pub fn square(&self, omega: f64) -> f64 {
        let n = self.n;
        // t0 + t1 s + t2 s^2
        let value = |[t0, t1, t2]: [f64; 3]| Complex::new(t0 - t2 * omega * omega, t1 * omega);
        let entry = |lists: &[Vec<f64>; 3], i: usize| value(lists.each_ref().map(|list| list[i]));
        let Some(lu) = Lu::of(Matrix::from_fn(n, n, |i, j| entry(&self.forms, i * n + j))) else {
            return f64::INFINITY;
        };
        let mut x: Vec<Complex<f64>> = (0..n).map(|i| entry(&self.b, i)).collect();
        lu.solve(&mut x);
        let h = x.iter().enumerate().fold(value(self.d), |sum, (i, x)| sum + entry(&self.p, i) * *x);
        h.re * h.re + h.im * h.im
    }
}

/// All numbers of a path, in one order.
fn numbers(system: &LinearSystem, n: usize, input: usize, output: usize) -> Option<Vec<Number>> {
    let mut list: Vec<Number> = Vec::new();
    for form in [&system.k, &system.c, &system.m] {
        list.extend(form.entries(n).into_iter().flatten());
    }
    let column = |entries: &[(CoordinateId, Number)]| {
        let mut column = vec![Number::ZERO; n];
        for (i, value) in entries {
            column[i.index()] = &column[i.index()] + value;
        }
        column
    };
    let (input_of, output_of) = (system.inputs.get(input)?, system.outputs.get(output)?);
    list.extend(input_of.b.iter().flat_map(|entries| column(entries)));
    list.extend(output_of.p.iter().flat_map(|entries| column(entries)));
    for through in &output_of.d {
        let own = through.iter().filter(|(known, _)| *known as usize == input);
        list.push(own.fold(Number::ZERO, |sum, (_, value)| &sum + value));
    }
    Some(list)
}

/// The point at which the polynomials in s = i omega are evaluated.
struct Point<'a> {
    at: &'a [Ball],
    omega: Ball,
}

impl Point<'_> {
    fn real(&self, linear: &Linear) -> Ball {
        linear.slopes.iter().zip(self.at).fold(
            linear.value,
            |sum, (slope, x)| {
                if slope.is_zero() { sum } else { sum + *slope * *x }
            },
        )
    }

    /// t0 + t1 s + t2 s^2
    fn value(&self, [t0, t1, t2]: [&Linear; 3]) -> Complexes {
        self.polynomial([self.real(t0), self.real(t1), self.real(t2)])
    }

    fn polynomial(&self, [t0, t1, t2]: [Ball; 3]) -> Complexes {
        Complex::new(t0 - t2 * square(self.omega), t1 * self.omega)
    }

    /// The derivative by a parameter, or by the frequency.
    fn slope(&self, parts: [&Linear; 3], a: usize) -> Complexes {
        match a < self.at.len() {
            true => self.polynomial(parts.map(|linear| linear.slopes[a])),
            false => self.by_frequency([self.real(parts[1]), self.real(parts[2])]),
        }
    }

    /// i t1 - 2 omega t2
    fn by_frequency(&self, [t1, t2]: [Ball; 2]) -> Complexes {
        Complex::new(-(t2 * self.omega * Ball::from(2.0)), t1)
    }

    fn bend(&self, parts: [&Linear; 3], a: usize, c: usize) -> Complexes {
        let last = self.at.len();
        match (a == last, c == last) {
            (false, false) => Complex::ZERO,
            (true, true) => Complex::real(-(self.real(parts[2]) * Ball::from(2.0))),
            (true, false) => self.by_frequency([parts[1].slopes[c], parts[2].slopes[c]]),
            (false, true) => self.by_frequency([parts[1].slopes[a], parts[2].slopes[a]]),
        }
    }
}

fn dot(a: &[Complexes], b: &[Complexes]) -> Complexes {
    a.iter().zip(b).fold(Complex::ZERO, |sum, (a, b)| sum + *a * *b)
}

fn minus(a: &[Complexes], b: &[Complexes]) -> Vec<Complexes> {
    a.iter().zip(b).map(|(a, b)| *a - *b).collect()
}

/// |z|^2
fn modulus_squared(z: Complexes) -> Ball {
    square(z.re) + square(z.im)
}

/// A mass of 1 kg on a spring of 1 N/m, and 50 g on it by k = 0.045 + 0.005 u N/m and c = 0.0125 + 0.004 v N*s/m; a force on the first.
#[cfg(test)]
pub(super) fn absorber() -> Affine {
    let linear = |value: f64, slopes: [f64; 2]| Linear {
        value: Ball::from(value),
        slopes: slopes.iter().map(|x| Ball::from(*x)).collect(),
    };
    let still = |value: f64| linear(value, [0.0; 2]);
    let link = |sign: f64| linear(sign * 0.045, [sign * 0.005, 0.0]);
    let oil = |sign: f64| linear(sign * 0.0125, [0.0, sign * 0.004]);
    let k = vec![linear(1.045, [0.005, 0.0]), link(-1.0), link(-1.0), link(1.0)];
    let c = vec![oil(1.0), oil(-1.0), oil(-1.0), oil(1.0)];
    let m = vec![still(1.0), still(0.0), still(0.0), still(0.05)];
    let none = || vec![still(0.0), still(0.0)];
    let first = || vec![still(1.0), still(0.0)];
    let d = [still(0.0), still(0.0), still(0.0)];
    Affine {
        n: 2,
        parameters: 2,
        unit: 1.0,
        forms: [k, c, m],
        b: [first(), none(), none()],
        p: [first(), none(), none()],
        d,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::Nature;

    fn affine(values: [f64; 2]) -> Affine {
        // Two masses: k0, k1 and c0 move.
        let linear = |value: f64, slopes: [f64; 2]| Linear {
            value: Ball::from(value),
            slopes: slopes.iter().map(|x| Ball::from(*x)).collect(),
        };
        let still = |value: f64| linear(value, [0.0; 2]);
        let k = vec![
            linear(5.0, [1.0, 0.0]),
            linear(-2.0, [-1.0, 0.0]),
            linear(-2.0, [-1.0, 0.0]),
            linear(2.0, [1.0, 0.0]),
        ];
        let c = vec![
            linear(0.5, [0.0, 0.25]),
            linear(-0.5, [0.0, -0.25]),
            linear(-0.5, [0.0, -0.25]),
            linear(0.5, [0.0, 0.25]),
        ];
        let m = vec![still(1.0), still(0.0), still(0.0), still(0.3)];
        let b = [
            vec![linear(1.0, [0.5, 0.0]), still(0.0)],
            vec![linear(0.0, [0.0, 0.2]), still(0.0)],
            vec![still(0.0), still(0.0)],
        ];
        let p = [vec![still(1.0), still(-0.5)], vec![still(0.0), still(0.1)], vec![still(0.0), still(0.0)]];
        let d = [still(values[0]), still(values[1]), still(0.0)];
        Affine { n: 2, parameters: 2, unit: 1.0, forms: [k, c, m], b, p, d }
    }

    /// A spring whose stiffness is p^2 has the derivative 2 p, which is another at each place: such a path is not affine, and no
    /// enclosure is made of one derivative. One that is known as well as numbers are is.
    #[test]
    fn a_slope_that_varies_is_not_taken_for_a_constant() {
        use crate::analysis::test_systems::{blank, push};
        let moved = |spread: f64| {
            let mut system = blank(1);
            push(&mut system.m, "1", 0, None);
            let source = system.k.source(system.coordinates[0].name);
            let p = Jet::of_parameter(Ball::from(2.0).widen(spread));
            system.k.push(source, Nature::Property, &p * &p, [(CoordinateId(0), Number::ONE)]);
            system
        };
        let path = |spread: f64| Affine::of(&moved(0.0), &[moved(spread)], &[Dd::from(0.1)], (0, 0), 1.0);
        assert!(path(0.1).is_none() && path(1e-9).is_none());
        assert!(path(0.0).is_some());
    }

    /// Derivatives at a point by central differences of the value in binary64, whose error is far below the tolerance.
    #[test]
    fn derivatives_are_those_of_differences() {
        let affine = affine([0.1, 0.05]);
        let at = [0.3, -0.2, 1.7];
        let value = |x: [f64; 3]| affine.at(&x[..2]).square(x[2]);
        let balls = [Ball::from(at[0]), Ball::from(at[1])];
        let found = affine.square(&balls, Ball::from(at[2]), true).expect("finite");
        assert!((found.value.to_f64() - value(at)).abs() < 1e-13 * value(at));
        let step = |mut x: [f64; 3], i: usize, h: f64| {
            x[i] += h;
            x
        };
        let h = 1e-3;
        for i in 0..3 {
            let seen = (value(step(at, i, h)) - value(step(at, i, -h))) / (2.0 * h);
            assert!(
                (found.slope[i].to_f64() - seen).abs() < 1e-4 * seen.abs().max(1.0),
                "{i} {seen} {:?}",
                found.slope
            );
            for j in 0..3 {
                let four = |a: f64, b: f64| value(step(step(at, i, a * h), j, b * h));
                let seen = (four(1.0, 1.0) - four(1.0, -1.0) - four(-1.0, 1.0) + four(-1.0, -1.0)) / (4.0 * h * h);
                let bend = found.bend[i][j].to_f64();
                assert!((bend - seen).abs() < 1e-3 * seen.abs().max(1.0), "{i} {j} {seen} {bend}");
            }
        }
    }

    /// The enclosures over a box contain the value and the derivatives at its corners.
    #[test]
    fn a_box_encloses_its_points() {
        let affine = affine([0.1, 0.05]);
        let wide = [Ball::from(0.3).widen(0.01), Ball::from(-0.2).widen(0.01)];
        let over = affine.square(&wide, Ball::from(1.7).widen(0.01), true).expect("finite");
        for corner in 0..8 {
            let side = |bit: usize| if corner >> bit & 1 == 1 { 0.01 } else { -0.01 };
            let at = [Ball::from(0.3 + side(0)), Ball::from(-0.2 + side(1))];
            let point = affine.square(&at, Ball::from(1.7 + side(2)), true).expect("finite");
            let holds = |wide: Ball, x: Ball| (wide.mid - x.mid).abs().to_f64() <= wide.rad;
            assert!(holds(over.value, point.value));
            assert!((0..3).all(|i| holds(over.slope[i], point.slope[i])));
            assert!((0..9).all(|i| holds(over.bend[i / 3][i % 3], point.bend[i / 3][i % 3])));
        }
    }
}
