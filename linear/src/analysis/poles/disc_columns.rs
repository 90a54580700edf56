//! The columns of the pencil in which poles are certified: approximate pairs, their conjugates, and the exact rigid
//! motions, each scaled by a binary64 factor; and their products, with bounds of the rounding errors. See
//! docs/method/poles.md#discs.

use crate::analysis::poles::pencil::{Application, Pencil};
use crate::analysis::poles::refinement::Pair;
use crate::analysis::poles::rigid::RigidMotions;
use crate::base::{Ball, Dd, Power, rounding};
use crate::kernel::complex::Complex;
use crate::kernel::dense::Matrix;
use crate::kernel::dense::product::{View, error, product};
use crate::kernel::real::Real;
use crate::kernel::squares::Squares;
use crate::kernel::triple::Precise;

/// Unit roundoff of binary64.
pub const U: f64 = rounding::UNIT;
/// Covers the rounding of sums of up to 2^20 non-negative numbers.
pub const UP: f64 = 1.0 + 1.0 / (1u64 << 30) as f64;

/// A complex number in binary64 and a bound of its distance from the true one.
#[derive(Clone, Copy, Debug)]
pub struct Bounded {
    pub value: Complex<f64>,
    pub error: f64,
    /// An upper bound of the modulus of both numbers.
    pub size: f64,
}

/// One vector z = (x, v), scaled.
pub struct Column {
    x: Vec<Bounded>,
    /// Stretches of the terms of M for x and for v, and of C for x.
    mx: Vec<Bounded>,
    mv: Vec<Bounded>,
    cx: Vec<Bounded>,
}

/// An exact rigid motion N: the forces w (a . N) of the terms of M and of C, and the factor of its column.
pub struct Motion {
    inertia: Vec<Precise>,
    drag: Vec<Precise>,
    factor: Complex<f64>,
    /// v = +-t x
    pub rate: f64,
}

/// All columns; conjugates follow their originals.
pub struct Columns {
    pub list: Vec<Column>,
    /// The first columns, which span the motions of poles that are exactly zero.
    pub rigid: Vec<Motion>,
    /// Columns of pair p and of its conjugate (equal for a real pair).
    pub of_pair: Vec<(usize, usize)>,
    /// The factor that scales pair p.
    pub factors: Vec<Complex<f64>>,
    /// For each column, the column of the conjugate vector, up to a sign.
    pub mirror: Vec<usize>,
    pub centres: Vec<Complex<Ball>>,
}

impl Bounded {
    pub fn of(z: Complex<Precise>, factor: Complex<f64>) -> Bounded {
        let near = z.to_f64();
        let value = near * factor;
        let (length, scale) = (near.abs(), factor.abs());
        let radius = Complex::new(z.re.radius, z.im.radius).abs() * UP;
        let error = (radius + 8.0 * U * length) * scale * UP + f64::MIN_POSITIVE;
        Bounded { value, error, size: (value.abs() + error) * UP }
    }

    /// A lower bound of the modulus of the true number.
    pub fn least(&self) -> f64 {
        self.value.abs() * (2.0 - UP) - self.error * UP
    }

    fn conj(self) -> Bounded {
        Bounded { value: self.value.conj(), ..self }
    }
}

impl Column {
    fn of_pair(pair: &Pair, applied: &Application<Precise>, factor: Complex<f64>) -> Column {
        let s = Complex::new(Precise::of_dd(pair.s.re), Precise::of_dd(pair.s.im));
        let scaled = |stretches: &[Complex<Precise>]| stretches.iter().map(|&z| Bounded::of(z, factor)).collect();
        let entry = |i: usize| {
            let x = pair.x.entry(i);
            Bounded::of(Complex::new(Precise::of_dd(x.re), Precise::of_dd(x.im)), factor)
        };
        Column {
            mx: scaled(&applied.m_stretch),
            mv: applied.m_stretch.iter().map(|&z| Bounded::of(z * s, factor)).collect(),
            cx: scaled(&applied.c_stretch),
            x: (0..pair.x.re.len()).map(entry).collect(),
        }
    }

    fn conj(&self) -> Column {
        let conj = |list: &[Bounded]| list.iter().map(|near| near.conj()).collect();
        Column { mx: conj(&self.mx), mv: conj(&self.mv), cx: conj(&self.cx), x: conj(&self.x) }
    }

    /// z = a (N, t N) of an exact rigid motion N.
    fn of_motion(pencil: &Pencil<Precise>, motion: &[Precise], a: Complex<f64>, rate: f64) -> Column {
        let scaled = |squares: &Squares<Precise>, rate: f64| -> Vec<Bounded> {
            let rate = Precise { value: rate.into(), radius: 0.0 };
            (0..squares.len()).map(|t| Bounded::of(Complex::real(squares.stretch_of(t, motion) * rate), a)).collect()
        };
        Column {
            mx: scaled(&pencil.m, 1.0),
            mv: scaled(&pencil.m, rate),
            cx: scaled(&pencil.c, 1.0),
            x: motion.iter().map(|&x| Bounded::of(Complex::real(x), a)).collect(),
        }
    }

    /// B_ij = x_i^T M v_j + v_i^T M x_j + x_i^T C x_j.
    pub fn product(&self, other: &Column, pencil: &Pencil<Precise>) -> Bounded {
        let gamma = (4 * (pencil.m.len() + pencil.c.len()) + 16) as f64 * U;
        let (mut sum, mut error) = (Complex::ZERO, f64::MIN_POSITIVE);
        let mut add = |w: &Precise, a: &Bounded, b: &Bounded| {
            let weight = w.to_f64();
            sum = sum + (a.value * b.value).scale(weight);
            let relative = a.size * b.error + a.error * b.size + gamma * a.size * b.size + f64::MIN_POSITIVE;
            error += weight.abs() * relative + w.radius * a.size * b.size;
        };
        for (t, w) in pencil.m.weights.iter().enumerate() {
            add(w, &self.mx[t], &other.mv[t]);
            add(w, &self.mv[t], &other.mx[t]);
        }
        for (t, w) in pencil.c.weights.iter().enumerate() {
            add(w, &self.cx[t], &other.cx[t]);
        }
        let error = error * UP;
        Bounded { value: sum, error, size: (sum.abs() + error) * UP }
    }
}

/// Bounds of |x_i . f_p|: a row for each column i, a column for each force p.
pub fn dot_products(columns: &Columns, forces: &[Vec<Bounded>]) -> Matrix<f64> {
    type Part = fn(&Bounded) -> f64;
    let table = |list: &[&[Bounded]], part: Part| {
        Matrix::from_fn(list.first().map_or(0, |x| x.len()), list.len(), |i, j| part(&list[j][i]))
    };
    let x: Vec<&[Bounded]> = columns.list.iter().map(|column| column.x.as_slice()).collect();
    let f: Vec<&[Bounded]> = forces.iter().map(Vec::as_slice).collect();
    let (re, im): (Part, Part) = (|near| near.value.re, |near| near.value.im);
    let (x_re, x_im, f_re, f_im) = (table(&x, re), table(&x, im), table(&f, re), table(&f, im));
    let times = |a: &Matrix<f64>, b: &Matrix<f64>| product(View::of(a).transpose(), View::of(b));
    let (rr, ii, ri, ir) = (times(&x_re, &f_re), times(&x_im, &f_im), times(&x_re, &f_im), times(&x_im, &f_re));
    // The error of each of the four sums, relative to the sum of the magnitudes.
    let gamma = 4.0 * error(x_re.rows()) + 16.0 * U;
    let x_size = table(&x, |near| near.size);
    let doubt =
        Matrix::from_fn(x_re.rows(), forces.len(), |i, p| (forces[p][i].error + gamma * forces[p][i].size) * UP);
    let from_force = times(&x_size, &doubt);
    let from_vector = times(&table(&x, |near| near.error), &table(&f, |near| near.size));
    Matrix::from_fn(x.len(), forces.len(), |i, p| {
        let sum = Complex::new(rr[(i, p)] - ii[(i, p)], ri[(i, p)] + ir[(i, p)]);
        let error = (from_force[(i, p)] + from_vector[(i, p)]) * UP + f64::MIN_POSITIVE;
        (sum.abs() + error * UP) * UP
    })
}

impl Motion {
    fn of(pencil: &Pencil<Precise>, motion: &[Precise], factor: Complex<f64>, rate: f64) -> Motion {
        let forces = |squares: &Squares<Precise>| -> Vec<Precise> {
            (0..squares.len()).map(|t| squares.weights[t] * squares.stretch_of(t, motion)).collect()
        };
        // A free motion stretches no damper, exactly.
        let drag = if rate == 0.0 { forces(&pencil.c) } else { Vec::new() };
        Motion { inertia: forces(&pencil.m), drag, factor, rate }
    }

    /// A bound of |N^T Q(s) x|, scaled. N^T K = 0, so this is s^2 N^T M x + s N^T C x without the forces of springs.
    pub fn residual(&self, s: Complex<Dd>, applied: &Application<Precise>, factor: Complex<f64>) -> f64 {
        let s = Complex::new(Precise::of_dd(s.re), Precise::of_dd(s.im));
        let sum = |forces: &[Precise], stretches: &[Complex<Precise>]| {
            forces.iter().zip(stretches).fold(Complex::ZERO, |sum, (&f, t)| sum + t.scale(f))
        };
        let force = (s * sum(&self.inertia, &applied.m_stretch) + sum(&self.drag, &applied.c_stretch)) * s;
        // The product of the factors is rounded once more.
        Bounded::of(force, factor * self.factor).size * (1.0 + 8.0 * U)
    }
}

impl Columns {
    pub fn of(
        pencil: &Pencil<Precise>,
        rigid: &RigidMotions,
        pairs: &[Pair],
        applied: &[Application<Precise>],
    ) -> Columns {
        let (list, motions) = rigid_columns(pencil, rigid, pairs);
        let mut columns = Columns {
            mirror: (0..list.len()).collect(),
            centres: vec![Complex::ZERO; list.len()],
            list,
            rigid: motions,
            of_pair: Vec::with_capacity(pairs.len()),
            factors: Vec::with_capacity(pairs.len()),
        };
        for (pair, applied) in pairs.iter().zip(applied) {
            let factor = normaliser(pencil.slope(pair.s.to_f64(), applied));
            columns.factors.push(factor);
            columns.push(pair, Column::of_pair(pair, applied, factor));
        }
        columns
    }

    fn push(&mut self, pair: &Pair, column: Column) {
        let at = self.list.len();
        let conj = if pair.is_real() { at } else { at + 1 };
        self.of_pair.push((at, conj));
        self.mirror.push(conj);
        self.centres.push(pair.s.to_ball());
        if !pair.is_real() {
            self.mirror.push(at);
            self.centres.push(pair.s.conj().to_ball());
            let mirrored = column.conj();
            self.list.extend([column, mirrored]);
        } else {
            self.list.push(column);
        }
    }

    /// A lower bound of the distance of two centres.
    pub fn gap(&self, i: usize, k: usize) -> f64 {
        let d = self.centres[i] - self.centres[k];
        Complex::new(d.re.mignitude(), d.im.mignitude()).abs() * (2.0 - UP)
    }

    /// A lower bound of |s_k|.
    pub fn size(&self, k: usize) -> f64 {
        let s = self.centres[k];
        Complex::new(s.re.mignitude(), s.im.mignitude()).abs() * (2.0 - UP)
    }
}

/// 1 / sqrt(b) for b = x^T (2 s M + C) x, so that B_jj is about one. Any factor is valid; this one makes the bounds
/// small.
fn normaliser(b: Complex<f64>) -> Complex<f64> {
    let root = b.sqrt();
    if root == Complex::ZERO || !root.is_finite() { Complex::real(1.0) } else { root.recip() }
}

/// A free motion N spans (N, 0) and (0, N), represented here by (N, tN) and i (N, -tN): with a suitable factor, B is
/// the identity on them. A dragged motion spans (N, 0). Returns each column with its t.
fn rigid_columns(pencil: &Pencil<Precise>, rigid: &RigidMotions, pairs: &[Pair]) -> (Vec<Column>, Vec<Motion>) {
    let typical = typical_rate(pairs);
    let (mut list, mut motions) = (Vec::new(), Vec::new());
    let mut push = |motion: &[Precise], factor: Complex<f64>, rate: f64| {
        list.push(Column::of_motion(pencil, motion, factor, rate));
        motions.push(Motion::of(pencil, motion, factor, rate));
    };
    for motion in &rigid.free {
        let motion: Vec<Precise> = motion.iter().map(Precise::of).collect();
        let a = (0.5 / square(&pencil.m, &motion).abs() / typical).sqrt();
        push(&motion, Complex::real(a), typical);
        push(&motion, Complex::new(0.0, a), -typical);
    }
    for motion in &rigid.dragged {
        let motion: Vec<Precise> = motion.iter().map(Precise::of).collect();
        push(&motion, normaliser(Complex::real(square(&pencil.c, &motion))), 0.0);
    }
    (list, motions)
}

/// sum w (a . x)^2 in binary64.
fn square(squares: &Squares<Precise>, x: &[Precise]) -> f64 {
    (0..squares.len()).map(|t| squares.weights[t].to_f64() * squares.stretch_of(t, x).to_f64().power(2)).sum()
}

/// The geometric mean of the slowest and the fastest rate.
fn typical_rate(pairs: &[Pair]) -> f64 {
    let sizes = pairs.iter().map(|pair| pair.s.to_f64().abs());
    let (low, high) = sizes.fold((f64::INFINITY, 0.0f64), |(low, high), s| (low.min(s), high.max(s)));
    let middle = low.sqrt() * high.sqrt();
    if middle.is_finite() && middle > 0.0 { middle } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::triple::Triple;

    fn near(value: f64, error: f64) -> Bounded {
        Bounded { value: Complex::real(value), error, size: (value.abs() + error) * UP }
    }

    fn column(x: &[Bounded]) -> Column {
        Column { x: x.to_vec(), mx: x.to_vec(), mv: x.to_vec(), cx: x.to_vec() }
    }

    /// The true products may lie anywhere within the errors of the factors, and sums are rounded.
    #[test]
    fn a_product_of_columns_is_bounded() {
        let bound = |x: &[Bounded], f: &[Bounded]| {
            let columns = Columns {
                list: vec![column(x)],
                rigid: Vec::new(),
                of_pair: vec![(0, 0)],
                factors: vec![Complex::real(1.0)],
                mirror: vec![0],
                centres: vec![Complex::ZERO],
            };
            dot_products(&columns, &[f.to_vec()])[(0, 0)]
        };
        // 1e16 + 1 - 1e16, which is zero in binary64.
        let x = [near(1e8, 0.0), near(1.0, 0.0), near(-1e8, 0.0)];
        assert!(bound(&x, &[near(1e8, 0.0), near(1.0, 0.0), near(1e8, 0.0)]) >= 1.0);
        // 3 - 3, with uncertain factors.
        let x = [near(1.0, 1e-3), near(-1.0, 0.0)];
        assert!(bound(&x, &[near(3.0, 0.0), near(3.0, 1e-2)]) >= 3e-3 + 1e-2);
    }

    #[test]
    fn the_radius_of_a_weight_is_in_the_product() {
        let mut system = crate::analysis::test_systems::oscillator("1", "1", "1");
        crate::analysis::test_systems::push(&mut system.m, "1", 0, None);
        let part = crate::analysis::modes::parts::Part::whole(&system);
        let mut pencil = Pencil::of(&system, &part, &[0]);
        let x = column(&[near(2.0, 0.0), near(3.0, 0.0)]);
        let exact = x.product(&x, &pencil);
        // 2 (2² + 3²) of M and 2² of C.
        assert!((exact.value.re - 30.0).abs() <= exact.error && exact.error < 1e-12);
        pencil.m.weights[1] = Precise { value: Triple::ONE, radius: 1e-3 };
        let doubtful = x.product(&x, &pencil);
        assert!(doubtful.error >= 2.0 * 9.0 * 1e-3 && doubtful.least() <= 30.0 - 0.018);
    }

    #[test]
    fn a_number_keeps_its_radius_when_it_is_scaled() {
        let z = Complex::new(
            Precise { value: Triple::from(3.0), radius: 1e-5 },
            Precise { value: Triple::from(4.0), radius: 0.0 },
        );
        let scaled = Bounded::of(z, Complex::new(0.0, 2.0));
        assert!(scaled.error >= 2e-5 && scaled.size >= 10.0 + 2e-5 && scaled.least() <= 10.0 - 2e-5);
    }

    /// Numbers whose real and imaginary parts, factors and weights are of all sizes, and as far off as they are said to be: scaled
    /// numbers, products of columns and bounds of forces hold each of them, one that is off at a time or all of them.
    #[test]
    fn scaled_numbers_and_products_hold_those_of_the_ends() {
        let third = Triple::from(Dd::from(1.0) / Dd::from(3.0));
        let complex = |re: f64, im: f64| Complex::new(Dd::from(re), Dd::from(im));
        let turns = [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (0.6, -0.8), (-0.8, -0.6)];
        for size in [1e-3, 0.25, 7.0, 3e4] {
            for factor in [Complex::new(0.75, -1.0), Complex::new(0.0, 1e-3), Complex::new(-3e3, 1.0)] {
                for (re, im) in [(0.0, 0.0), (1e-4, 0.0), (0.0, 1e-4), (1e-4, 1e-4)] {
                    let part = |x: f64, radius: f64| Precise { value: third * Triple::from(x), radius: radius * size };
                    let z = Complex::new(part(size, re), part(-2.0 * size, im));
                    let found = Bounded::of(z, factor);
                    let f = complex(factor.re, factor.im);
                    for (a, b) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
                        let end = |x: Precise, side: f64| x.value.dd() + Dd::from(side * x.radius);
                        let truth = Complex::new(end(z.re, a), end(z.im, b)) * f;
                        let off = (truth - found.value.into()).to_f64().abs();
                        assert!(off <= found.error, "{size} {factor:?} {re} {im}: {off:e} {:e}", found.error);
                        let length = truth.to_f64().abs() * (1.0 - 1e-15);
                        assert!(length <= found.size && found.least() * (1.0 - 2e-15) <= length);
                        assert!(found.least() > 0.9 * length);
                    }
                }
            }
        }
        // Columns of two entries; the first one of each is off.
        let mut system = crate::analysis::test_systems::oscillator("1", "1", "1");
        crate::analysis::test_systems::push(&mut system.m, "1", 0, None);
        let part = crate::analysis::modes::parts::Part::whole(&system);
        let mut pencil = Pencil::of(&system, &part, &[0]);
        let of = |re: f64, im: f64, error: f64| {
            let value = Complex::new(re, im);
            Bounded { value, error, size: (value.abs() + error) * UP }
        };
        for which in 0..8 {
            let off = |k: usize, x: f64| if which == k || which == 7 { x } else { 0.0 };
            for scale in [1.0 / 64.0, 1.0, 256.0] {
                let column = |own: usize| Column {
                    x: vec![of(0.5 * scale, -2.0, off(own, 1e-3)), of(3.0, 0.25 * scale, 0.0)],
                    mx: vec![of(0.5 * scale, -2.0, off(own, 1e-3)), of(3.0, 0.25 * scale, 0.0)],
                    mv: vec![of(-1.5, 0.5 * scale, off(own + 1, 1e-3)), of(1.0, -scale, 0.0)],
                    cx: vec![of(2.0 * scale, 0.125, off(own + 2, 1e-3))],
                };
                let (a, b) = (column(0), column(3));
                pencil.m.weights[0] = Precise { value: Triple::from(0.375), radius: off(6, 1e-3) };
                pencil.c.weights[0] = Precise { value: Triple::from(-5.0), radius: off(6, 1e-2) };
                let found = a.product(&b, &pencil);
                let force = [of(1.0, scale, off(3, 1e-3)), of(-2.0 * scale, 0.5, 0.0)];
                let columns = Columns {
                    list: vec![a, b],
                    rigid: Vec::new(),
                    of_pair: vec![(0, 0), (1, 1)],
                    factors: vec![Complex::real(1.0); 2],
                    mirror: vec![0, 1],
                    centres: vec![Complex::ZERO; 2],
                };
                let dots = dot_products(&columns, &[force.to_vec()]);
                for turn in turns {
                    for other in turns {
                        for side in [-1.0, 1.0] {
                            let end = |z: &Bounded, (re, im): (f64, f64)| {
                                Complex::<Dd>::from(z.value) + complex(re * z.error, im * z.error)
                            };
                            let weight = |w: &Precise| w.value.dd() + Dd::from(side * w.radius);
                            let [a, b] = [&columns.list[0], &columns.list[1]];
                            let pair =
                                |x: &Bounded, y: &Bounded, w: &Precise| (end(x, turn) * end(y, other)).scale(weight(w));
                            let of_m = |t: usize| {
                                let w = &pencil.m.weights[t];
                                pair(&a.mx[t], &b.mv[t], w) + pair(&a.mv[t], &b.mx[t], w)
                            };
                            let truth = of_m(0) + of_m(1) + pair(&a.cx[0], &b.cx[0], &pencil.c.weights[0]);
                            let away = (truth - found.value.into()).to_f64().abs();
                            assert!(away <= found.error, "{which} {scale}: {away:e} {:e}", found.error);
                            let length = truth.to_f64().abs();
                            assert!(length <= found.size * (1.0 + 1e-15) && found.least() <= length * (1.0 + 1e-15));
                            for (k, column) in columns.list.iter().enumerate() {
                                let parts = column.x.iter().zip(&force).map(|(x, f)| end(x, turn) * end(f, other));
                                let truth = parts.fold(Complex::<Dd>::ZERO, |sum, part| sum + part).to_f64().abs();
                                assert!(truth <= dots[(k, 0)], "{which} {scale} {k}: {truth} {}", dots[(k, 0)]);
                                assert!(
                                    dots[(k, 0)] < 1.05 * truth + 0.02 * scale.max(1.0),
                                    "{which} {scale} {k}: {truth} {}",
                                    dots[(k, 0)]
                                );
                            }
                        }
                    }
                }
            }
        }
    }

    /// Distances of centres, and from zero, are less than those of all points of their balls.
    #[test]
    fn gaps_and_sizes_are_lower_bounds() {
        let ball = |x: f64, radius: f64| Ball::from(x).widen(radius);
        let centres = vec![
            Complex::new(ball(-1.0, 0.125), ball(2.0, 0.25)),
            Complex::new(ball(-4.0, 0.5), ball(-2.0, 0.0625)),
            Complex::new(ball(0.0, 0.5), ball(1.0, 0.0)),
        ];
        let (rigid, of_pair, factors) = (Vec::new(), Vec::new(), Vec::new());
        let columns = Columns { list: Vec::new(), rigid, of_pair, factors, mirror: Vec::new(), centres };
        for (i, k, nearest) in [(0, 1, (2.375f64, 3.6875f64)), (1, 0, (2.375, 3.6875)), (0, 2, (0.375, 0.75))] {
            let truth = nearest.0.hypot(nearest.1);
            assert!(columns.gap(i, k) <= truth && columns.gap(i, k) > 0.999 * truth, "{i} {k}: {}", columns.gap(i, k));
        }
        for (k, nearest) in [(0, (0.875f64, 1.75f64)), (1, (3.5, 1.9375)), (2, (0.0, 1.0))] {
            let truth = nearest.0.hypot(nearest.1);
            assert!(columns.size(k) <= truth && columns.size(k) > 0.999 * truth, "{k}: {}", columns.size(k));
        }
    }
}
