//! Discs that certainly hold the poles. In: the terms, approximate pairs (s_j, x_j) as exact numbers, the exact rigid
//! motions. Out: for each pair a radius, and which discs are certified only together. Clause: spec.md 11.6 derives it:
//!
//! With z = (x, v), v = s x, the symmetric linearisation L(s) = s [C M; M 0] + [K 0; 0 -M] has L(s) z_j =
//! (Q(s_j) x_j, 0) + (s - s_j) [C M; M 0] z_j. So Z^T L(s) Z = B (s - D) + R with D = diag(s_j) and
//!   B_ij = x_i^T M v_j + v_i^T M x_j + x_i^T C x_j,   R_ij = x_i^T r_j,   r_j = Q(s_j) x_j,
//! and if B is regular the poles are exactly the eigenvalues of D - T, T = B^-1 R. Symmetry makes
//! (s_j - s_i) B_ij = R_ij - R_ji, so off its diagonal B is as small as the residuals are, T too, and Gershgorin's discs
//! of D - T are small. Residuals are balls; sums of binary64 carry an explicit bound of their rounding.

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

/// One vector z = (x, v), scaled by a factor of binary64.
struct Column {
    x: Vec<Near>,
    /// Stretches of the terms of M under x and under v, and of C under x.
    mx: Vec<Near>,
    mv: Vec<Near>,
    cx: Vec<Near>,
}

/// All columns, conjugates behind their originals: which pair each belongs to, and where its conjugate is.
struct Columns {
    list: Vec<Column>,
    /// Columns before this one span the motions of poles that are exactly zero; beside each a rate t: v = +-t x.
    rigid: Vec<f64>,
    /// Column of pair p, and of its conjugate (the same for a real pair).
    of_pair: Vec<(usize, usize)>,
    /// The factor that scales pair p.
    factors: Vec<Complex<f64>>,
    /// The column of the conjugate vector, up to a sign.
    mirror: Vec<usize>,
    centres: Vec<Complex<Ball>>,
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
    let r = residual_products(&columns, &applied, pairs);
    let perturbation = deviation(pencil, &columns, &r).and_then(|b| perturbation(&columns, &b, &r));
    perturbation.map_or(nothing, |t| gershgorin(&columns, &t))
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

    /// z = a (N, t N) of an exact rigid motion N.
    fn of_motion(pencil: &Pencil, motion: &[Number], a: Complex<f64>, rate: f64) -> Column {
        let motion: Vec<Ball> = motion.iter().map(Number::to_ball).collect();
        let scaled = |squares: &Squares, rate: f64| -> Vec<Near> {
            let rate = Ball::from(rate);
            (0..squares.len()).map(|t| Near::of(Complex::real(moved(squares, t, &motion) * rate), a)).collect()
        };
        Column {
            mx: scaled(&pencil.m, 1.0),
            mv: scaled(&pencil.m, rate),
            cx: scaled(&pencil.c, 1.0),
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
    let (list, rates) = rigid_columns(pencil, rigid, pairs);
    let factors = pairs.iter().zip(applied).map(|(pair, applied)| normaliser(pencil, pair, applied)).collect();
    let mut columns = Columns {
        mirror: (0..list.len()).collect(),
        centres: vec![Complex::ZERO; list.len()],
        list,
        rigid: rates,
        of_pair: Vec::with_capacity(pairs.len()),
        factors,
    };
    for (p, (pair, applied)) in pairs.iter().zip(applied).enumerate() {
        columns.push(pair, Column::of_pair(pair, applied, columns.factors[p]));
    }
    columns
}

impl Columns {
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
    fn gap(&self, i: usize, k: usize) -> f64 {
        let d = self.centres[i] - self.centres[k];
        Complex::new(d.re.mignitude(), d.im.mignitude()).abs() * (2.0 - UP)
    }

    /// A lower bound of |s_k|.
    fn size(&self, k: usize) -> f64 {
        let s = self.centres[k];
        Complex::new(s.re.mignitude(), s.im.mignitude()).abs() * (2.0 - UP)
    }
}

/// 1 / sqrt(x^T (2 s M + C) x), so that B_jj is about one. Any factor is right; this one makes the bounds small.
fn normaliser(pencil: &Pencil, pair: &Pair, applied: &Application) -> Complex<f64> {
    let b = pencil.slope(pair.s.to_f64(), applied);
    let root = b.sqrt();
    if root == Complex::ZERO || !root.is_finite() { Complex::real(1.0) } else { root.recip() }
}

/// A free motion N spans (N, 0) and (0, N), here as (N, tN) and i (N, -tN): B is the identity on them with a proper factor.
/// A dragged motion spans (N, 0). Beside each column its t.
fn rigid_columns(pencil: &Pencil, rigid: &RigidMotions, pairs: &[Pair]) -> (Vec<Column>, Vec<f64>) {
    let rate = typical_rate(pairs);
    let (mut list, mut rates) = (Vec::new(), Vec::new());
    for motion in &rigid.free {
        let a = (0.5 / square(&pencil.m, motion).abs() / rate).sqrt();
        list.push(Column::of_motion(pencil, motion, Complex::real(a), rate));
        list.push(Column::of_motion(pencil, motion, Complex::new(0.0, a), -rate));
        rates.extend([rate, rate]);
    }
    for motion in &rigid.dragged {
        let factor = Complex::real(square(&pencil.c, motion)).sqrt().recip();
        let factor = if factor.is_finite() { factor } else { Complex::real(1.0) };
        list.push(Column::of_motion(pencil, motion, factor, 0.0));
        rates.push(0.0);
    }
    (list, rates)
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

/// What is known of B: lower bounds of its diagonal, and bounds G_ij of |B_ij| / |B_ii| off it.
struct Deviation {
    diagonal: Vec<f64>,
    off: Table,
    /// The largest row sum of G.
    theta: f64,
}

/// `None` if B may be singular.
fn deviation(pencil: &Pencil, columns: &Columns, r: &Table) -> Option<Deviation> {
    let n = columns.list.len();
    let diagonal: Vec<f64> = (0..n)
        .map(|i| {
            let (value, error) = product(pencil, &columns.list[i], &columns.list[i]);
            value.abs() * (2.0 - UP) - error
        })
        .collect();
    let mut off = Table::new(n);
    for j in 0..n {
        for i in 0..j {
            let bound = coupling(pencil, columns, r, i, j);
            off.set(i, j, bound / diagonal[i] * UP);
            off.set(j, i, bound / diagonal[j] * UP);
        }
    }
    let theta = (0..n).map(|i| (0..n).map(|j| off.at(i, j)).sum::<f64>()).fold(0.0, f64::max) * UP;
    // What is not a number proves nothing, and the maximum passes over it.
    let regular = theta < 0.5 && off.is_finite() && diagonal.iter().all(|&d| d > 0.0);
    regular.then_some(Deviation { diagonal, off, theta })
}

/// A bound of |B_ij|, i < j: from the residuals where the poles are apart, from the terms where they are not.
fn coupling(pencil: &Pencil, columns: &Columns, r: &Table, i: usize, j: usize) -> f64 {
    let rigid = &columns.rigid;
    if i >= rigid.len() {
        let gap = columns.gap(i, j);
        if gap > 1e-6 * columns.size(j) {
            return (r.at(i, j) + r.at(j, i)) / gap * UP;
        }
    } else if j >= rigid.len() {
        // With K N = 0, and C N = 0 or t = 0: N^T r_j = s_j^2 N^T M x_j + s_j N^T C x_j, and R_ij = a N^T r_j.
        let size = columns.size(j);
        return r.at(i, j) * (1.0 + rigid[i] / size) / size * UP * UP;
    }
    let (value, error) = product(pencil, &columns.list[i], &columns.list[j]);
    (value.abs() + error) * UP
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

/// Bounds of |T| = |B^-1 R|: with B = Lambda (1 + F), |F| <= G, |(1 + F)^-1| <= 1 + G + G^2 + ...
fn perturbation(columns: &Columns, b: &Deviation, r: &Table) -> Option<Table> {
    let n = r.n;
    let mut t = Table::new(n);
    for &(at, conj) in &columns.of_pair {
        let scaled: Vec<f64> = r.column(at).iter().zip(&b.diagonal).map(|(r, d)| r / d * UP).collect();
        let first: Vec<f64> = (0..n).map(|i| (0..n).map(|j| b.off.at(i, j) * scaled[j]).sum::<f64>() * UP).collect();
        // The rest G (1 - G)^-1 (G R) is at most theta / (1 - theta) times the largest entry of G R.
        let rest = first.iter().copied().fold(0.0, f64::max) * (b.theta / (1.0 - b.theta)) * UP;
        for i in 0..n {
            let bound = (scaled[i] + first[i] + rest) * UP;
            t.set(i, at, bound);
            t.set(columns.mirror[i], conj, bound);
        }
    }
    t.is_finite().then_some(t)
}

/// Bounds of |R_ij| = |x_i^T r_j|; zero for the columns of rigid motions.
fn residual_products(columns: &Columns, applied: &[Application], pairs: &[Pair]) -> Table {
    let mut table = Table::new(columns.list.len());
    for (p, applied) in applied.iter().enumerate().take(pairs.len()) {
        let (at, conj) = columns.of_pair[p];
        let factor = columns.factors[p];
        let force: Vec<Near> = applied.force.iter().map(|&f| Near::of(f, factor)).collect();
        for (i, column) in columns.list.iter().enumerate() {
            let bound = dot(&column.x, &force);
            table.set(i, at, bound);
            table.set(columns.mirror[i], conj, bound);
        }
        // x_k^T Q(s_k) x_k as a sum of energies is the sharper bound of the diagonal.
        let energy = Near::of(applied.energy, factor * factor);
        let bound = table.at(at, at).min(energy.size * (1.0 + 8.0 * U));
        table.set(at, at, bound);
        table.set(conj, conj, bound);
    }
    table
}

/// A bound of |x . f|.
fn dot(x: &[Near], f: &[Near]) -> f64 {
    let gamma = (4 * f.len() + 16) as f64 * U;
    let (mut sum, mut error) = (Complex::ZERO, f64::MIN_POSITIVE);
    for (x, f) in x.iter().zip(f) {
        sum = sum + x.value * f.value;
        error += x.size * f.error + x.error * f.size + gamma * x.size * f.size;
    }
    (sum.abs() + error * UP) * UP
}

/// Radii from the columns of D - T. Disjoint discs hold one pole each, and may then be shrunk: scaling column k by tau and
/// row k by 1 / tau is a similarity, and while disc k stays clear of the others it still holds exactly its own.
fn gershgorin(columns: &Columns, t: &Table) -> Vec<Disc> {
    let (first, n) = (columns.rigid.len(), columns.list.len());
    let radii: Vec<f64> = (0..n).map(|k| t.column(k)[first..].iter().sum::<f64>() * UP).collect();
    let gap = |i: usize, k: usize| columns.gap(i, k);
    let clusters = clusters(first, n, |i, k| gap(i, k) <= (radii[i] + radii[k]) * UP);
    let disc = |&(k, conj): &(usize, usize)| {
        let radius = match clusters[k] {
            None => shrunk(t, &radii, first, k, &gap),
            cluster => union_radius(&clusters, cluster, &radii, &columns.centres, k),
        };
        Disc { radius, clusters: [clusters[k], clusters[conj]] }
    };
    columns.of_pair.iter().map(disc).collect()
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
