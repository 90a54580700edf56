//! The data behind pictures: the shapes of damped motions, and transfer functions as sums of partial fractions, which a
//! page can evaluate at any frequency; where poles are not simple, what it needs to solve the equations itself. Binary64, and without bounds: numbers that are printed come from elsewhere. In: a
//! system with its modes and poles; out: shapes, and fractions that agree with enclosed values of the transfer function.
//! See docs/method/transfer.md.
//!
//! M, C and K are symmetric, so the left null vector of Q(s) = s^2 M + s C + K at a pole is the right one, v, and at a simple
//! pole Q^-1 has the residue v v^T / (v^T Q'(s) v) (Lancaster, Lambda-matrices and vibrating systems, 1966, section 4.3).

use crate::analysis::answer::{Modes, Pole, Poles};
use crate::analysis::transfer::modal::ModalSum;
use crate::analysis::transfer::table::Table;
use crate::analysis::transfer::{Gain, feed_through};
use crate::base::Number;
use crate::kernel::complex::Complex;
use crate::kernel::dense::Matrix;
use crate::kernel::dense::lu::Lu;
use crate::system::{CoordinateId, Form, LinearSystem};

/// Systems of more coordinates have no shapes of damped motions: each takes n^3 operations.
pub const MOST_COORDINATES: usize = 120;

/// A transfer function by its equations: p(s)^T Q(s)^-1 b(s) and `feed0 + feed1 s + feed2 s^2`.
#[derive(Clone, Debug)]
pub struct Solved {
    pub input: Vec<Share>,
    pub output: Vec<Share>,
    pub feed: [f64; 3],
}

/// A coordinate in an input or an output: `weight s^power`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share {
    pub power: usize,
    pub coordinate: usize,
    pub weight: f64,
}

/// The form in which a page evaluates a transfer function.
#[derive(Clone, Debug)]
pub enum Curve {
    Fractions(Fractions),
    Solved(Solved),
}

/// The matrices in binary64, row by row.
#[derive(Clone, Debug)]
pub struct Pencil {
    n: usize,
    m: Vec<f64>,
    c: Vec<f64>,
    k: Vec<f64>,
}

/// `s^power (numerator0 + numerator1 s) / (denominator0 + denominator1 s + denominator2 s^2)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fraction {
    pub power: usize,
    pub numerator: [f64; 2],
    pub denominator: [f64; 3],
}

/// A transfer function: the sum of fractions and of `feed0 + feed1 s + feed2 s^2`.
#[derive(Clone, Debug)]
pub struct Fractions {
    pub list: Vec<Fraction>,
    pub feed: [f64; 3],
}

impl Pencil {
    /// `None` for a system that is too large.
    pub fn of(system: &LinearSystem) -> Option<Pencil> {
        let n = system.n();
        let whole = |form: &Form| {
            let mut entries = vec![0.0; n * n];
            for term in form.terms() {
                let (weight, row) = (term.weight.to_f64(), form.row(term));
                for (i, a) in row {
                    for (j, b) in row {
                        entries[i.index() * n + j.index()] += weight * a.to_f64() * b.to_f64();
                    }
                }
            }
            entries
        };
        (n <= MOST_COORDINATES).then(|| Pencil { n, m: whole(&system.m), c: whole(&system.c), k: whole(&system.k) })
    }

    /// The entries other than zero: row, column, and those of M, C and K.
    pub fn entries(&self) -> impl Iterator<Item = (usize, usize, [f64; 3])> {
        let entry = |at: usize| (at / self.n, at % self.n, [self.m[at], self.c[at], self.k[at]]);
        (0..self.n * self.n).map(entry).filter(|(.., entry)| *entry != [0.0; 3])
    }

    /// The equations between an input and an output, if they agree with the table.
    pub fn solve_equations(
        &self,
        system: &LinearSystem,
        table: &Table,
        (input, output): (usize, usize),
    ) -> Option<Solved> {
        let shares = |rows: &[Vec<(CoordinateId, Number)>]| {
            let row = |(power, row): (usize, &Vec<(CoordinateId, Number)>)| {
                row.iter()
                    .map(move |(id, weight)| Share { power, coordinate: id.index(), weight: weight.to_f64() })
                    .collect()
            };
            rows.iter().enumerate().flat_map(|own| -> Vec<Share> { row(own) }).collect()
        };
        let feed = feed_through(&system.outputs[output], input).map(|ball| ball.mid.to_f64());
        let found = Solved { input: shares(&system.inputs[input].b), output: shares(&system.outputs[output].p), feed };
        agree(table, input, output, |omega| self.value(&found, omega)).then_some(found)
    }

    /// The value at s = i omega; not a number where Q(s) is singular.
    fn value(&self, of: &Solved, omega: f64) -> Complex<f64> {
        let s = Complex::new(0.0, omega);
        let power = |power: usize| (0..power).fold(Complex::new(1.0, 0.0), |product, _| product * s);
        let Some(factors) = Factors::of(self, s) else { return Complex::new(f64::NAN, f64::NAN) };
        let mut x = vec![Complex::new(0.0, 0.0); self.n];
        for share in &of.input {
            x[share.coordinate] = x[share.coordinate] + power(share.power).scale(share.weight);
        }
        factors.solve(&mut x);
        let feed = Complex::new(of.feed[0] - of.feed[2] * omega * omega, of.feed[1] * omega);
        of.output.iter().fold(feed, |sum, share| sum + power(share.power).scale(share.weight) * x[share.coordinate])
    }

    /// The shape of the motion exp(s t), scaled so that the largest displacement is 1. Found by inverse iteration; at a
    /// multiple pole it is one of many. `None` if binary64 cannot represent it.
    pub fn shape(&self, s: Complex<f64>) -> Option<Vec<Complex<f64>>> {
        const STEPS: usize = 3;
        let factors = Factors::of(self, s)?;
        // Orthogonal to no shape that comes up.
        let mut shape: Vec<Complex<f64>> = (0..self.n)
            .map(|i| Complex::new(1.0 + 0.37 * libm::sin(i as f64), 0.23 * libm::cos(1.7 * i as f64)))
            .collect();
        for _ in 0..STEPS {
            factors.solve(&mut shape);
            let largest = shape.iter().copied().reduce(|a, b| if b.one_norm() > a.one_norm() { b } else { a })?;
            if largest.one_norm() == 0.0 || !largest.one_norm().is_finite() {
                return None;
            }
            let unit = largest.recip();
            shape.iter_mut().for_each(|x| *x = *x * unit);
        }
        shape.iter().all(|x| x.one_norm().is_finite()).then_some(shape)
    }

    /// v^T Q'(s) v
    fn slope(&self, s: Complex<f64>, v: &[Complex<f64>]) -> Complex<f64> {
        let mut sum = Complex::new(0.0, 0.0);
        for i in 0..self.n {
            for j in 0..self.n {
                let (m, c) = (self.m[i * self.n + j], self.c[i * self.n + j]);
                if m != 0.0 || c != 0.0 {
                    sum = sum + v[i] * v[j] * (s.scale(2.0 * m) + Complex::new(c, 0.0));
                }
            }
        }
        sum
    }
}

/// Q(s) scaled to a diagonal near one, D Q(s) D, as its triangular factors.
struct Factors {
    lu: Lu<Complex<f64>>,
    /// D
    scale: Vec<f64>,
}

impl Factors {
    fn of(pencil: &Pencil, s: Complex<f64>) -> Option<Factors> {
        let n = pencil.n;
        let size = (s.re * s.re + s.im * s.im).sqrt();
        let scale: Option<Vec<f64>> = (0..n)
            .map(|i| {
                let at = i * n + i;
                let own = size * size * pencil.m[at].abs() + size * pencil.c[at].abs() + pencil.k[at].abs();
                (own > 0.0 && own.is_finite()).then(|| 1.0 / own.sqrt())
            })
            .collect();
        let scale = scale?;
        let square = s * s;
        let q = Matrix::from_fn(n, n, |i, j| {
            let at = i * n + j;
            let sum = square.scale(pencil.m[at]) + s.scale(pencil.c[at]) + Complex::new(pencil.k[at], 0.0);
            sum.scale(scale[i] * scale[j])
        });
        Some(Factors { lu: Lu::nearly_singular(q)?, scale })
    }

    /// x <- Q(s)^-1 x
    fn solve(&self, x: &mut [Complex<f64>]) {
        let scaled = |x: &mut [Complex<f64>]| x.iter_mut().zip(&self.scale).for_each(|(x, d)| *x = x.scale(*d));
        scaled(x);
        self.lu.solve(x);
        scaled(x);
    }
}

/// A pole's place in binary64.
pub fn place(pole: &Pole) -> Complex<f64> {
    Complex::new(pole.re.mid.to_f64(), pole.im.mid.to_f64())
}

/// The source of the fractions: modes that are independent oscillators, or simple poles with their shapes.
pub enum Parts<'a> {
    Modes(Box<ModalSum>),
    Poles(&'a Pencil, Vec<(Complex<f64>, Vec<Complex<f64>>)>),
}

impl Parts<'_> {
    /// `None` if poles that are not simple are damped, or if not all of them are known.
    pub fn of<'a>(system: &LinearSystem, modes: &Modes, poles: &Poles, pencil: &'a Pencil) -> Option<Parts<'a>> {
        if let Some(sum) = ModalSum::of(system, modes) {
            return Some(Parts::Modes(Box::new(sum)));
        }
        let is_simple = |pole: &&Pole| !pole.defective && pole.cluster.is_none();
        if poles.left_out > 0 || poles.list.len() != 2 * system.n() || !poles.list.iter().all(|pole| is_simple(&pole)) {
            return None;
        }
        let upper = poles.list.iter().filter(|pole| !pole.is_lower_half());
        let list: Option<Vec<_>> = upper.map(|pole| Some((place(pole), pencil.shape(place(pole))?))).collect();
        Some(Parts::Poles(pencil, list?))
    }

    /// The fractions of an input and an output.
    pub fn between(&self, system: &LinearSystem, input: usize, output: usize) -> Fractions {
        let (b, p) = (&system.inputs[input].b, &system.outputs[output].p);
        let mut list = Vec::new();
        for (i, p) in p.iter().enumerate().filter(|(_, p)| !p.is_empty()) {
            for (j, b) in b.iter().enumerate().filter(|(_, b)| !b.is_empty()) {
                list.extend(self.products(i + j, p, b));
            }
        }
        let feed = feed_through(&system.outputs[output], input).map(|ball| ball.mid.to_f64());
        Fractions { list, feed }
    }

    fn products(&self, power: usize, p: &[(CoordinateId, Number)], b: &[(CoordinateId, Number)]) -> Vec<Fraction> {
        match self {
            Parts::Modes(sum) => {
                let [p, b] = [p, b].map(|row| sum.participation(row));
                let of = |mode: usize| Fraction {
                    power,
                    numerator: [(p[mode] * b[mode]).mid.to_f64(), 0.0],
                    denominator: [sum.k[mode].to_f64(), sum.c[mode].to_f64(), 1.0],
                };
                (0..sum.k.len()).map(of).collect()
            }
            Parts::Poles(pencil, list) => list.iter().map(|(s, v)| of_pole(pencil, power, *s, v, p, b)).collect(),
        }
    }
}

fn of_pole(
    pencil: &Pencil,
    power: usize,
    s: Complex<f64>,
    v: &[Complex<f64>],
    p: &[(CoordinateId, Number)],
    b: &[(CoordinateId, Number)],
) -> Fraction {
    let dot = |row: &[(CoordinateId, Number)]| {
        row.iter().fold(Complex::new(0.0, 0.0), |sum, (i, value)| sum + v[i.index()].scale(value.to_f64()))
    };
    let residue = dot(p) * dot(b) * pencil.slope(s, v).recip();
    if s.im == 0.0 {
        return Fraction { power, numerator: [residue.re, 0.0], denominator: [-s.re, 1.0, 0.0] };
    }
    // r / (z - s) and its conjugate, added.
    Fraction {
        power,
        numerator: [-2.0 * (residue * s.conj()).re, 2.0 * residue.re],
        denominator: [s.re * s.re + s.im * s.im, -2.0 * s.re, 1.0],
    }
}

impl Fractions {
    /// The value at s = i omega.
    pub fn at(&self, omega: f64) -> Complex<f64> {
        let square = omega * omega;
        let mut sum = Complex::new(self.feed[0] - self.feed[2] * square, self.feed[1] * omega);
        for part in &self.list {
            let [n0, n1] = part.numerator;
            let [d0, d1, d2] = part.denominator;
            let below = Complex::new(d0 - d2 * square, d1 * omega);
            let mut value = Complex::new(n0, n1 * omega) * below.recip();
            for _ in 0..part.power {
                value = Complex::new(-value.im * omega, value.re * omega);
            }
            sum = sum + value;
        }
        sum
    }

    /// Whether the sums agree with the enclosed values of a table, except for differences that no plot shows.
    pub fn agree(&self, table: &Table, input: usize, output: usize) -> bool {
        agree(table, input, output, |omega| self.at(omega))
    }
}

/// Whether values agree with the enclosed ones of a table, but for what no picture shows.
fn agree(table: &Table, input: usize, output: usize, value_at: impl Fn(f64) -> Complex<f64>) -> bool {
    const RELATIVE: f64 = 1e-5;
    /// Of the largest gain: what cancels in an antiresonance.
    const ABSOLUTE: f64 = 1e-11;
    let known = || {
        table.rows.iter().filter_map(|row| match row.gains[input][output] {
            Gain::Finite(disc) => Some((row.frequency.to_f64(), disc.value.to_f64())),
            Gain::Infinite | Gain::Unknown => None,
        })
    };
    let size = |z: Complex<f64>| libm::hypot(z.re, z.im);
    let largest = known().map(|(_, value)| size(value)).fold(0.0, f64::max);
    known().all(|(hertz, value)| {
        let own = value_at(2.0 * std::f64::consts::PI * hertz);
        let apart = size(Complex::new(own.re - value.re, own.im - value.im));
        // The step to binary64 moves a frequency beside a sharp peak.
        apart <= RELATIVE * size(value) + ABSOLUTE * largest || hertz == 0.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// m = 2 kg, c = 0.4 N s/m, k = 200 N/m: s = -c/2m + i sqrt(k/m - (c/2m)^2).
    #[test]
    fn one_mass_has_its_fraction() {
        let pencil = Pencil { n: 1, m: vec![2.0], c: vec![0.4], k: vec![200.0] };
        let s = Complex::new(-0.1, (100.0f64 - 0.01).sqrt());
        let v = pencil.shape(s).expect("a shape");
        let unit = [(CoordinateId(0), Number::ONE)];
        let fraction = of_pole(&pencil, 0, s, &v, &unit, &unit);
        let value = Fractions { list: vec![fraction], feed: [0.0; 3] }.at(7.0);
        let expected = Complex::new(200.0 - 2.0 * 49.0, 0.4 * 7.0).recip();
        assert!((value.re - expected.re).hypot(value.im - expected.im) < 1e-15);
    }

    /// Two masses, two dampers without proportion: Q(s) v = 0 at each pole of the quartic.
    #[test]
    fn a_shape_is_a_null_vector() {
        let pencil = Pencil {
            n: 2,
            m: vec![1.0, 0.0, 0.0, 2.0],
            c: vec![1.0, -0.5, -0.5, 0.5],
            k: vec![300.0, -100.0, -100.0, 100.0],
        };
        // det Q(s) by Newton from the undamped poles.
        let q = |s: Complex<f64>, at: usize| {
            (s * s).scale(pencil.m[at]) + s.scale(pencil.c[at]) + Complex::new(pencil.k[at], 0.0)
        };
        let det = |s: Complex<f64>| q(s, 0) * q(s, 3) - q(s, 1) * q(s, 2);
        let mut s = Complex::new(-0.1, 5.7);
        for _ in 0..60 {
            let h = Complex::new(1e-6, 0.0);
            let slope = (det(s + h) - det(s - h)).scale(0.5e6);
            s = s - det(s) * slope.recip();
        }
        let v = pencil.shape(s).expect("a shape");
        for row in 0..2 {
            let sum = q(s, 2 * row) * v[0] + q(s, 2 * row + 1) * v[1];
            assert!(sum.one_norm() < 1e-7, "{sum:?}");
        }
        assert!(v.iter().any(|x| x.im.abs() > 1e-3), "the phases differ: {v:?}");
    }
}
