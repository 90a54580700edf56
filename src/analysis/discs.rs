//! Discs that certainly hold the poles. In: the terms, approximate pairs (s_j, x_j) as exact numbers, the exact rigid
//! motions. Out: for each pair a radius, and which discs are certified only together. Clause: spec.md 11.6 derives it:
//!
//! With z = (x, v), v = s x, the symmetric linearisation L(s) = s [C M; M 0] + [K 0; 0 -M] has L(s) z_j =
//! (Q(s_j) x_j, 0) + (s - s_j) B z_j. So Z^T L(s) Z = B (s - D) + R with D = diag(s_j) and
//!   B_ij = x_i^T M v_j + v_i^T M x_j + x_i^T C x_j,   R_ij = x_i^T r_j,   r_j = Q(s_j) x_j,
//! and if B is regular the poles are exactly the eigenvalues of D - T, T = B^-1 R. B is close to the identity and R is as
//! small as the residuals, so Gershgorin's discs of D - T are small. R is bounded from residuals in ball arithmetic; B
//! needs few digits. Binary64 sums carry an explicit bound of their rounding.

use super::complex::Complex;
use super::pencil::{Application, Pencil};
use super::pole_rigid::RigidMotions;
use super::refinement::Pair;
use super::squares::Squares;
use crate::base::{Ball, Number};

/// A bound that holds for one pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// |s - true| is at most this; infinite where nothing is certified.
    pub radius: f64,
    /// Discs with the same number overlap: as many poles as discs lie in their union. For the pair and for its conjugate.
    pub clusters: [Option<u32>; 2],
}

/// Unit roundoff of binary64.
const U: f64 = f64::EPSILON / 2.0;
/// Covers the rounding of sums of up to 2^20 non-negative numbers.
const UP: f64 = 1.0 + 1.0 / (1u64 << 30) as f64;

/// A binary64 number and how far it may be from the true one.
#[derive(Clone, Copy, Debug)]
struct Near {
    value: Complex<f64>,
    error: f64,
    /// At least the modulus of either.
    size: f64,
}

/// What B and R need of one vector z = (x, v): stretches of the terms of M and C, scaled by a factor of binary64.
struct Column {
    mx: Vec<Near>,
    mv: Vec<Near>,
    cx: Vec<Near>,
    x: Vec<Near>,
}

/// All columns, conjugates behind their originals: which pair each belongs to, and where its conjugate is.
struct Columns {
    list: Vec<Column>,
    /// Columns before this one span the motions of poles that are exactly zero.
    rigid: usize,
    /// Column of pair p, and of its conjugate (the same for a real pair).
    of_pair: Vec<(usize, usize)>,
    /// The factor that scales pair p.
    factors: Vec<Complex<f64>>,
    /// The column of the conjugate vector, up to a sign.
    mirror: Vec<usize>,
}

/// The discs of all pairs (one of each conjugate pair, im > 0, and real ones) together with the exact rigid motions.
/// `count` is the number of poles; with fewer or more columns than poles nothing is certified.
pub fn discs(pencil: &Pencil, rigid: &RigidMotions, pairs: &[Pair], count: usize) -> Vec<Disc> {
    let applied: Vec<Application> = pairs.iter().map(|pair| pencil.apply(pair.s, &pair.x)).collect();
    let columns = columns(pencil, rigid, pairs, &applied);
    let nothing = vec![Disc { radius: f64::INFINITY, clusters: [Some(0); 2] }; pairs.len()];
    if columns.list.len() != count {
        return nothing;
    }
    let deviation = deviation(pencil, &columns);
    match perturbation(&columns, &deviation, &applied, pairs) {
        Some(t) => gershgorin(&columns, &t, pairs),
        None => nothing,
    }
}

impl Near {
    fn of(z: Complex<Ball>, factor: Complex<f64>) -> Near {
        let near = z.mid().to_f64();
        let value = near * factor;
        let (length, scale) = (near.abs(), factor.abs());
        let error = (z.radius() + 8.0 * U * length) * scale * UP + f64::MIN_POSITIVE;
        Near { value, error, size: (value.abs() + error) * UP }
    }

    fn conj(self) -> Near {
        Near { value: self.value.conj(), ..self }
    }
}

impl Column {
    fn of_pair(pair: &Pair, applied: &Application, factor: Complex<f64>) -> Column {
        let s = pair.s.to_ball();
        let scaled = |stretches: &[Complex<Ball>]| stretches.iter().map(|&z| Near::of(z, factor)).collect();
        Column {
            mx: scaled(&applied.m_stretch),
            mv: applied.m_stretch.iter().map(|&z| Near::of(z * s, factor)).collect(),
            cx: scaled(&applied.c_stretch),
            x: (0..pair.x.re.len()).map(|i| Near::of(pair.x.entry(i).to_ball(), factor)).collect(),
        }
    }

    fn conj(&self) -> Column {
        let conj = |list: &[Near]| list.iter().map(|near| near.conj()).collect();
        Column { mx: conj(&self.mx), mv: conj(&self.mv), cx: conj(&self.cx), x: conj(&self.x) }
    }

    /// z = (a N, b N) of an exact rigid motion N.
    fn of_motion(pencil: &Pencil, motion: &[Number], a: Complex<f64>, b: Complex<f64>) -> Column {
        let motion: Vec<Ball> = motion.iter().map(Number::to_ball).collect();
        let scaled = |squares: &Squares, factor: Complex<f64>| -> Vec<Near> {
            (0..squares.len()).map(|t| Near::of(Complex::real(moved(squares, t, &motion)), factor)).collect()
        };
        Column {
            mx: scaled(&pencil.m, a),
            mv: scaled(&pencil.m, b),
            cx: scaled(&pencil.c, a),
            x: motion.iter().map(|&x| Near::of(Complex::real(x), a)).collect(),
        }
    }
}

/// a . x for an enclosed x.
fn moved(squares: &Squares, t: usize, x: &[Ball]) -> Ball {
    let (indices, values) = squares.row(t);
    indices.iter().zip(values).fold(Ball::ZERO, |sum, (&i, &a)| sum + a * x[i as usize])
}

fn columns(pencil: &Pencil, rigid: &RigidMotions, pairs: &[Pair], applied: &[Application]) -> Columns {
    let mut list = rigid_columns(pencil, rigid, pairs);
    let rigid = list.len();
    let factors: Vec<_> = pairs.iter().zip(applied).map(|(pair, applied)| normaliser(pencil, pair, applied)).collect();
    let (mut of_pair, mut mirror) = (Vec::with_capacity(pairs.len()), (0..rigid).collect::<Vec<usize>>());
    for ((pair, applied), &factor) in pairs.iter().zip(applied).zip(&factors) {
        let column = Column::of_pair(pair, applied, factor);
        let at = list.len();
        if pair.is_real() {
            of_pair.push((at, at));
            mirror.push(at);
            list.push(column);
        } else {
            of_pair.push((at, at + 1));
            mirror.extend([at + 1, at]);
            let conj = column.conj();
            list.extend([column, conj]);
        }
    }
    Columns { list, rigid, of_pair, factors, mirror }
}

/// 1 / sqrt(x^T (2 s M + C) x), so that B_jj is about one. Any factor is right; this one makes the bounds small.
fn normaliser(pencil: &Pencil, pair: &Pair, applied: &Application) -> Complex<f64> {
    let s = pair.s.to_f64();
    let sum = |squares: &Squares, stretches: &[Complex<Ball>]| {
        squares.weights.iter().zip(stretches).fold(Complex::ZERO, |sum, (w, t)| {
            let t = t.mid().to_f64();
            sum + (t * t).scale(w.to_f64())
        })
    };
    let b = s.scale(2.0) * sum(&pencil.m, &applied.m_stretch) + sum(&pencil.c, &applied.c_stretch);
    let root = b.sqrt();
    if root == Complex::ZERO || !root.is_finite() { Complex::real(1.0) } else { root.recip() }
}

/// A free motion N spans (N, 0) and (0, N), here as (N, tN) and i (N, -tN): B is the identity on them with a proper factor.
/// A dragged motion spans (N, 0).
fn rigid_columns(pencil: &Pencil, rigid: &RigidMotions, pairs: &[Pair]) -> Vec<Column> {
    let rate = typical_rate(pairs);
    let mut list = Vec::new();
    for motion in &rigid.free {
        let inertia = square(&pencil.m, motion).abs();
        let (a, b) = ((0.5 / inertia / rate).sqrt(), (0.5 / inertia * rate).sqrt());
        list.push(Column::of_motion(pencil, motion, Complex::real(a), Complex::real(b)));
        list.push(Column::of_motion(pencil, motion, Complex::new(0.0, a), Complex::new(0.0, -b)));
    }
    for motion in &rigid.dragged {
        let factor = Complex::real(square(&pencil.c, motion)).sqrt().recip();
        let factor = if factor.is_finite() { factor } else { Complex::real(1.0) };
        list.push(Column::of_motion(pencil, motion, factor, Complex::ZERO));
    }
    list
}

/// sum w (a . x)^2 in binary64.
fn square(squares: &Squares, x: &[Number]) -> f64 {
    let x: Vec<Ball> = x.iter().map(Number::to_ball).collect();
    (0..squares.len()).map(|t| squares.weights[t].to_f64() * moved(squares, t, &x).to_f64().powi(2)).sum()
}

/// The geometric middle of the slowest and the fastest rate.
fn typical_rate(pairs: &[Pair]) -> f64 {
    let sizes = pairs.iter().map(|pair| pair.s.to_f64().abs());
    let (low, high) = sizes.fold((f64::INFINITY, 0.0f64), |(low, high), s| (low.min(s), high.max(s)));
    let middle = low.sqrt() * high.sqrt();
    if middle.is_finite() && middle > 0.0 { middle } else { 1.0 }
}

/// A square table of bounds.
struct Table {
    n: usize,
    data: Vec<f64>,
}

impl Table {
    fn new(n: usize) -> Table {
        Table { n, data: vec![0.0; n * n] }
    }

    fn at(&self, i: usize, j: usize) -> f64 {
        self.data[j * self.n + i]
    }

    fn set(&mut self, i: usize, j: usize, value: f64) {
        self.data[j * self.n + i] = value;
    }

    fn is_finite(&self) -> bool {
        self.data.iter().all(|x| x.is_finite())
    }

    fn column(&self, j: usize) -> &[f64] {
        &self.data[j * self.n..(j + 1) * self.n]
    }
}

/// Bounds of |B - I|, which is symmetric.
fn deviation(pencil: &Pencil, columns: &Columns) -> Table {
    let n = columns.list.len();
    let mut table = Table::new(n);
    for j in 0..n {
        for i in 0..=j {
            let (value, error) = product(pencil, &columns.list[i], &columns.list[j]);
            let value = if i == j { value - Complex::real(1.0) } else { value };
            let bound = (value.abs() + error) * UP;
            table.set(i, j, bound);
            table.set(j, i, bound);
        }
    }
    table
}

/// B_ij and a bound of its error.
fn product(pencil: &Pencil, a: &Column, b: &Column) -> (Complex<f64>, f64) {
    let gamma = (4 * (pencil.m.len() + pencil.c.len()) + 16) as f64 * U;
    let (mut sum, mut error) = (Complex::ZERO, f64::MIN_POSITIVE);
    let mut add = |w: &Ball, a: &Near, b: &Near| {
        let weight = w.to_f64();
        sum = sum + (a.value * b.value).scale(weight);
        error += weight.abs() * (a.size * b.error + a.error * b.size + gamma * a.size * b.size)
            + w.rad * a.size * b.size
            + weight.abs() * f64::MIN_POSITIVE;
    };
    for (t, w) in pencil.m.weights.iter().enumerate() {
        add(w, &a.mx[t], &b.mv[t]);
        add(w, &a.mv[t], &b.mx[t]);
    }
    for (t, w) in pencil.c.weights.iter().enumerate() {
        add(w, &a.cx[t], &b.cx[t]);
    }
    (sum, error * UP)
}

/// Bounds of |T| = |B^-1 R|, |B^-1| <= I + G + G^2 + ..., G >= |B - I|. `None` if B may be singular.
fn perturbation(columns: &Columns, g: &Table, applied: &[Application], pairs: &[Pair]) -> Option<Table> {
    let n = g.n;
    let theta = (0..n).map(|i| (0..n).map(|j| g.at(i, j)).sum::<f64>()).fold(0.0, f64::max) * UP;
    // What is not a number proves nothing, and the maximum above passes over it.
    if theta >= 0.5 || !g.is_finite() {
        return None;
    }
    let mut t = Table::new(n);
    for (p, pair) in pairs.iter().enumerate() {
        let (at, conj) = columns.of_pair[p];
        let r = residual_products(columns, &applied[p], at, columns.factors[p]);
        let first: Vec<f64> = (0..n).map(|i| r.iter().zip(g.column(i)).map(|(r, g)| r * g).sum::<f64>() * UP).collect();
        // The rest G (I - G)^-1 (G R) is at most theta / (1 - theta) times the largest entry of G R.
        let rest = first.iter().copied().fold(0.0, f64::max) * (theta / (1.0 - theta)) * UP;
        for i in 0..n {
            let bound = (r[i] + first[i] + rest) * UP;
            t.set(i, at, bound);
            if !pair.is_real() {
                t.set(columns.mirror[i], conj, bound);
            }
        }
    }
    t.is_finite().then_some(t)
}

/// Bounds of |x_i^T r_k| for all i.
fn residual_products(columns: &Columns, applied: &Application, k: usize, factor: Complex<f64>) -> Vec<f64> {
    let force: Vec<Near> = applied.force.iter().map(|&f| Near::of(f, factor)).collect();
    let gamma = (4 * force.len() + 16) as f64 * U;
    let mut bounds: Vec<f64> = columns
        .list
        .iter()
        .map(|column| {
            let (mut sum, mut error) = (Complex::ZERO, f64::MIN_POSITIVE);
            for (x, f) in column.x.iter().zip(&force) {
                sum = sum + x.value * f.value;
                error += x.size * f.error + x.error * f.size + gamma * x.size * f.size;
            }
            (sum.abs() + error * UP) * UP
        })
        .collect();
    // x_k^T Q(s_k) x_k as a sum of energies is the sharper bound of the diagonal.
    let energy = Near::of(applied.energy, factor * factor);
    bounds[k] = bounds[k].min(energy.size + 8.0 * U * energy.size);
    bounds
}

/// Radii from the columns of D - T. Disjoint discs hold one pole each, and may then be shrunk: scaling column k by tau and
/// row k by 1 / tau is a similarity, and while disc k stays clear of the others it still holds exactly its own.
fn gershgorin(columns: &Columns, t: &Table, pairs: &[Pair]) -> Vec<Disc> {
    let first = columns.rigid;
    let n = columns.list.len();
    let radii: Vec<f64> = (0..n).map(|k| t.column(k)[first..].iter().sum::<f64>() * UP).collect();
    let centres = centres(columns, pairs);
    // Poles at zero are exactly there, but their discs must stay clear as well: the others are no zeros.
    let gap = |i: usize, k: usize| gap(&centres[i], &centres[k]);
    let clusters = clusters(first, n, |i, k| gap(i, k) <= (radii[i] + radii[k]) * UP);
    columns
        .of_pair
        .iter()
        .map(|&(k, conj)| {
            let radius = match clusters[k] {
                None => shrunk(t, &radii, first, k, &gap),
                cluster => union_radius(&clusters, cluster, &radii, &centres, k),
            };
            Disc { radius, clusters: [clusters[k], clusters[conj]] }
        })
        .collect()
}

/// The centre of each column's disc.
fn centres(columns: &Columns, pairs: &[Pair]) -> Vec<Complex<Ball>> {
    let mut centres = vec![Complex::ZERO; columns.list.len()];
    for (pair, &(at, conj)) in pairs.iter().zip(&columns.of_pair) {
        centres[conj] = pair.s.conj().to_ball();
        centres[at] = pair.s.to_ball();
    }
    centres
}

/// A lower bound of the distance of two centres.
fn gap(a: &Complex<Ball>, b: &Complex<Ball>) -> f64 {
    let d = *a - *b;
    Complex::new(d.re.mignitude(), d.im.mignitude()).abs() * (2.0 - UP)
}

/// The radius of disc k under the best tau: with tau = 2 max T_ki / (gap - radii) each other disc grows by less than its gap.
fn shrunk(t: &Table, radii: &[f64], first: usize, k: usize, gap: &impl Fn(usize, usize) -> f64) -> f64 {
    let mut tau = 1e-290f64;
    for i in (first..t.n).filter(|&i| i != k) {
        let room = gap(i, k) - (radii[i] + radii[k]) * UP;
        tau = tau.max(2.0 * t.at(k, i) / room);
    }
    let others: f64 = (first..t.n).filter(|&i| i != k).map(|i| t.at(i, k)).sum();
    if tau < 1.0 { (t.at(k, k) + tau * others) * UP } else { radii[k] }
}

/// Connected discs share a number; a disc alone has none.
fn clusters(first: usize, n: usize, touch: impl Fn(usize, usize) -> bool) -> Vec<Option<u32>> {
    let mut number: Vec<usize> = (0..n).collect();
    for k in first..n {
        for i in first..k {
            if number[i] != number[k] && touch(i, k) {
                let (from, to) = (number[i].max(number[k]), number[i].min(number[k]));
                number.iter_mut().filter(|x| **x == from).for_each(|x| *x = to);
            }
        }
    }
    let members = |k: usize| number.iter().filter(|&&x| x == number[k]).count();
    (0..n).map(|k| (members(k) > 1).then_some(number[k] as u32)).collect()
}

/// Every pole of the union is within this of centre k.
fn union_radius(
    clusters: &[Option<u32>],
    cluster: Option<u32>,
    radii: &[f64],
    centres: &[Complex<Ball>],
    k: usize,
) -> f64 {
    (0..radii.len())
        .filter(|&i| clusters[i] == cluster)
        .map(|i| ((centres[i] - centres[k]).magnitude() + radii[i]) * UP)
        .fold(0.0, f64::max)
}
