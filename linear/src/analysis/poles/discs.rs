//! Discs that certainly contain the poles. In: the terms, approximate pairs (s_j, x_j) as exact numbers, the exact
//! rigid motions. Out: an enclosure for each pair, and which pairs are certified only together.
//! docs/method/poles.md#discs derives it:
//!
//! With z = (x, v), v = s x, the symmetric linearisation L(s) = s [C M; M 0] + [K 0; 0 -M] has L(s) z_j =
//! (Q(s_j) x_j, 0) + (s - s_j) [C M; M 0] z_j. So Z^T L(s) Z = B (s - D) + R with D = diag(s_j) and
//!   B_ij = x_i^T M v_j + v_i^T M x_j + x_i^T C x_j,   R_ij = x_i^T r_j,   r_j = Q(s_j) x_j,
//! and if B is regular the poles are exactly the eigenvalues of D - T, T = B^-1 R. Symmetry makes (s_j - s_i) B_ij =
//! R_ij - R_ji, so off its diagonal B is as small as the residuals are, and so is T; hence Gershgorin's discs of D - T
//! are small. Residuals are evaluated in triple words with their radius; sums in binary64 carry an explicit bound of
//! their rounding errors.

use crate::analysis::poles::disc_columns::{Bounded, Columns, U, UP, dot_products};
use crate::analysis::poles::pencil::{Application, Pencil};
use crate::analysis::poles::refinement::Pair;
use crate::analysis::poles::residues::Proof;
use crate::analysis::poles::rigid::RigidMotions;
use crate::analysis::poles::together::least_pairs;
use crate::base::{Ball, Dd, larger};
use crate::kernel::complex::Complex;
use crate::kernel::cores::in_pieces;
use crate::kernel::dense::Matrix;
use crate::kernel::dense::product::{View, product};
use crate::kernel::triple::{Precise, Triple};

/// Bounds that one core computes in less than a millisecond.
const MOST_OF_ONE: usize = 1 << 15;

/// The certified result for one pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoleEnclosure {
    /// A rectangle that contains the pole; of infinite size if nothing is certified.
    pub s: Complex<Ball>,
    /// Discs with the same number overlap: their union contains as many poles as discs. One entry for the pair, one for
    /// its conjugate.
    pub clusters: [Option<u32>; 2],
}

/// The discs of all pairs (one of each conjugate pair, im > 0, and real ones) together with the exact rigid motions.
/// `count` is the number of poles; nothing is certified if there are fewer or more columns than poles. `also` computes
/// further results from the bounds of the proof; `None` if there is no proof.
pub fn discs<T>(
    pencil: &Pencil<Precise>,
    rigid: &RigidMotions,
    pairs: &[Pair],
    count: usize,
    also: impl FnOnce(&Proof) -> T,
) -> (Vec<PoleEnclosure>, Option<T>) {
    let applied = in_pieces(pairs, least_pairs(pencil.n), 1, |some| {
        some.iter().map(|pair| pencil.apply(pair.s, &pair.x)).collect()
    });
    let columns = Columns::of(pencil, rigid, pairs, &applied);
    let certified = (columns.list.len() == count).then(|| {
        let r = residual_products(&columns, pairs, &applied);
        let b = deviation(pencil, &columns, &r)?;
        let t = perturbation(&columns, &b, &r)?;
        let more = also(&Proof { pencil, pairs, applied: &applied, columns: &columns, b: &b, t: &t });
        Some((gershgorin(&Certificate { columns, b, t }, pairs, &applied), Some(more)))
    });
    let nothing = || pairs.iter().map(|pair| around(pair, f64::INFINITY, [Some(0); 2])).collect();
    certified.flatten().unwrap_or_else(|| (nothing(), None))
}

impl PoleEnclosure {
    pub fn is_certified(&self) -> bool {
        self.s.re.rad.is_finite()
    }
}

fn around(pair: &Pair, radius: f64, clusters: [Option<u32>; 2]) -> PoleEnclosure {
    PoleEnclosure { s: Complex::new(Ball::new(pair.s.re, radius), Ball::new(pair.s.im, radius)), clusters }
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

    fn view(&self) -> View<'_> {
        View::columns(&self.data, self.n, self.n, self.n)
    }

    fn is_finite(&self) -> bool {
        self.data.iter().all(|x| x.is_finite())
    }

    fn column(&self, j: usize) -> &[f64] {
        &self.data[j * self.n..(j + 1) * self.n]
    }

    /// Bounds of the product with a vector of bounds.
    fn times(&self, x: &[f64]) -> Vec<f64> {
        let mut sum = vec![f64::MIN_POSITIVE; self.n];
        for (j, &x) in x.iter().enumerate() {
            sum.iter_mut().zip(self.column(j)).for_each(|(sum, a)| *sum += a * x);
        }
        sum.iter_mut().for_each(|sum| *sum *= UP);
        sum
    }
}

/// Bounds of |R_ij| = |x_i^T r_j|; zero for the columns of rigid motions.
fn residual_products(columns: &Columns, pairs: &[Pair], applied: &[Application<Precise>]) -> Table {
    let mut table = Table::new(columns.list.len());
    let scaled: Vec<(&Application<Precise>, Complex<f64>)> =
        applied.iter().zip(columns.factors.iter().copied()).collect();
    let forces: Vec<Vec<Bounded>> = in_pieces(&scaled, least_columns(columns.list.len()), 1, |some| {
        some.iter().map(|(applied, factor)| applied.force.iter().map(|&f| Bounded::of(f, *factor)).collect()).collect()
    });
    let products = dot_products(columns, &forces);
    for (p, applied) in applied.iter().enumerate() {
        let (at, conj) = columns.of_pair[p];
        let factor = columns.factors[p];
        for i in 0..columns.list.len() {
            let bound = match columns.rigid.get(i) {
                Some(motion) => motion.residual(pairs[p].s, applied, factor),
                None => products[(i, p)],
            };
            table.set(i, at, bound);
            table.set(columns.mirror[i], conj, bound);
        }
        // x_k^T Q(s_k) x_k as a sum of energies gives a sharper bound of the diagonal.
        let energy = Bounded::of(applied.energy, factor * factor);
        let bound = table.at(at, at).min(energy.size * (1.0 + 8.0 * U));
        table.set(at, at, bound);
        table.set(conj, conj, bound);
    }
    table
}

/// Bounds of the deviation of B from a diagonal matrix.
pub struct Deviation {
    diagonal: Vec<Bounded>,
    /// Bounds G_ij of |B_ij| / |B_ii| off the diagonal.
    off: Table,
    /// The largest row sum of G.
    pub theta: f64,
}

impl Deviation {
    /// G x, for a vector of bounds.
    pub fn times(&self, x: &[f64]) -> Vec<f64> {
        self.off.times(x)
    }
}

/// `None` if B may be singular.
fn deviation(pencil: &Pencil<Precise>, columns: &Columns, r: &Table) -> Option<Deviation> {
    let n = columns.list.len();
    let diagonal: Vec<Bounded> = columns.list.iter().map(|column| column.product(column, pencil)).collect();
    let mut off = Table::new(n);
    // Column j has j bounds: one of the first and one of the last take as long as the next two.
    let order: Vec<usize> = (0..n).map(|k| if k % 2 == 0 { k / 2 } else { n - 1 - k / 2 }).collect();
    let bounds: Vec<Vec<f64>> = in_pieces(&order, least_columns(n), 1, |some| {
        some.iter().map(|&j| (0..j).map(|i| coupling(pencil, columns, r, i, j)).collect()).collect()
    });
    for (&j, bounds) in order.iter().zip(&bounds) {
        for (i, bound) in bounds.iter().enumerate() {
            off.set(i, j, bound / diagonal[i].least() * UP);
            off.set(j, i, bound / diagonal[j].least() * UP);
        }
    }
    let theta = (0..n).map(|i| (0..n).map(|j| off.at(i, j)).sum::<f64>()).fold(0.0, f64::max) * UP;
    // A NaN proves nothing, and the maximum would skip it.
    let regular = theta < 0.5 && off.is_finite() && diagonal.iter().all(|b| b.least() > 0.0);
    regular.then_some(Deviation { diagonal, off, theta })
}

/// Number of bounds in columns whose computation takes longer than starting a thread.
fn least_columns(bounds: usize) -> usize {
    MOST_OF_ONE.div_ceil(bounds.max(1))
}

/// A bound of |B_ij|, i < j: from the residuals if the poles are well separated, otherwise from the terms.
fn coupling(pencil: &Pencil<Precise>, columns: &Columns, r: &Table, i: usize, j: usize) -> f64 {
    let rigid = &columns.rigid;
    if i >= rigid.len() {
        let gap = columns.gap(i, j);
        if gap > 1e-6 * columns.size(j) {
            return (r.at(i, j) + r.at(j, i)) / gap * UP;
        }
    } else if j >= rigid.len() {
        // With K N = 0, and C N = 0 or t = 0: N^T r_j = s_j^2 N^T M x_j + s_j N^T C x_j, and R_ij = a N^T r_j.
        let size = columns.size(j);
        return r.at(i, j) * (1.0 + rigid[i].rate.abs() / size) / size * UP * UP;
    }
    columns.list[i].product(&columns.list[j], pencil).size
}

/// Bounds of T.
pub struct Perturbation {
    /// |T_ij|
    t: Table,
    /// |T_kk - R_kk / B_kk|
    own: Vec<f64>,
}

impl Perturbation {
    /// |T| x, for a vector of bounds.
    pub fn times(&self, x: &[f64]) -> Vec<f64> {
        self.t.times(x)
    }

    /// The largest sum of |T_ij| over a column.
    pub fn largest_column(&self) -> f64 {
        (0..self.t.n).map(|j| self.t.column(j).iter().sum::<f64>() * UP).fold(0.0, larger)
    }
}

/// T = B^-1 R: with B = Lambda (1 + F), |F| <= G, |(1 + F)^-1| <= 1 + G + G^2 + ...
fn perturbation(columns: &Columns, b: &Deviation, r: &Table) -> Option<Perturbation> {
    let n = r.n;
    let scaled =
        Matrix::from_fn(n, columns.of_pair.len(), |i, p| r.at(i, columns.of_pair[p].0) / b.diagonal[i].least() * UP);
    let coupled = product(b.off.view(), View::of(&scaled));
    let (mut t, mut own) = (Table::new(n), vec![0.0; n]);
    for (p, &(at, conj)) in columns.of_pair.iter().enumerate() {
        // Sums of non-negative numbers: UP covers their rounding errors, and the last summand covers underflow.
        let rest: Vec<f64> = coupled.column(p).iter().map(|sum| sum * UP + f64::MIN_POSITIVE).collect();
        // G^2 (1 - G)^-1 R is at most theta / (1 - theta) times the largest entry of G R.
        let tail = rest.iter().copied().fold(0.0, larger) * (b.theta / (1.0 - b.theta)) * UP;
        for i in 0..n {
            let bound = (scaled[(i, p)] + rest[i] + tail) * UP;
            t.set(i, at, bound);
            t.set(columns.mirror[i], conj, bound);
        }
        own[at] = (rest[at] + tail) * UP;
        own[conj] = own[at];
    }
    t.is_finite().then_some(Perturbation { t, own })
}

/// All bounds that the discs are computed from.
struct Certificate {
    columns: Columns,
    b: Deviation,
    t: Perturbation,
}

/// Radii from the columns of D - T. Disjoint discs contain one pole each, and may then be shrunk.
fn gershgorin(known: &Certificate, pairs: &[Pair], applied: &[Application<Precise>]) -> Vec<PoleEnclosure> {
    let (columns, t) = (&known.columns, &known.t.t);
    let (first, n) = (columns.rigid.len(), columns.list.len());
    let radii: Vec<f64> = (0..n).map(|k| t.column(k)[first..].iter().sum::<f64>() * UP).collect();
    let clusters = clusters(first, n, |i, k| columns.gap(i, k) <= (radii[i] + radii[k]) * UP);
    let disc = |(p, &(k, conj)): (usize, &(usize, usize))| match clusters[k] {
        None => {
            known.isolated_disc(&radii, k, &pairs[p], known.rayleigh_step(k, columns.factors[p], applied[p].energy))
        }
        cluster => {
            let radius = union_radius(&clusters, cluster, &radii, &columns.centres, k);
            around(&pairs[p], radius, [cluster, clusters[conj]])
        }
    };
    let pairs_and_columns: Vec<(usize, &(usize, usize))> = columns.of_pair.iter().enumerate().collect();
    in_pieces(&pairs_and_columns, least_columns(n), 1, |some| some.iter().map(|&one| disc(one)).collect())
}

impl Certificate {
    /// A disc that overlaps no other, around s_k - R_kk / B_kk; the part of that centre that double-double cannot hold
    /// is added to the radius.
    fn isolated_disc(&self, radii: &[f64], k: usize, pair: &Pair, step: Bounded) -> PoleEnclosure {
        let radius = (self.shrunk_radius(radii, k) + self.t.own[k] + step.error) * UP;
        let enclose = |s: Dd, step: f64| {
            let (mid, rest) = (Triple::from(s) + Triple::from(step)).split();
            Ball::new(mid, (radius + rest.abs() + mid.hi.abs() * (2.0 * Triple::ERROR)) * UP)
        };
        let s = Complex::new(enclose(pair.s.re, step.value.re), enclose(pair.s.im, step.value.im));
        PoleEnclosure { s, clusters: [None; 2] }
    }

    /// sum_{i != k} |T_ik| tau: scaling column k by tau and row k by 1 / tau is a similarity, and while disc k stays
    /// clear of the others it contains exactly its own pole. With tau = 2 max T_ki / (gap - radii) each other disc
    /// grows by less than its gap.
    fn shrunk_radius(&self, radii: &[f64], k: usize) -> f64 {
        let (t, first) = (&self.t.t, self.columns.rigid.len());
        let mut tau = 1e-290f64;
        let mut others = 0.0;
        for i in (first..t.n).filter(|&i| i != k) {
            let room = self.columns.gap(i, k) - (radii[i] + radii[k]) * UP;
            tau = tau.max(2.0 * t.at(k, i) / room);
            others += t.at(i, k);
        }
        others * tau.min(1.0) * UP
    }

    /// -R_kk / B_kk, the step of the Rayleigh quotient, with its error; `energy` is x^T Q(s) x.
    fn rayleigh_step(&self, k: usize, factor: Complex<f64>, energy: Complex<Precise>) -> Bounded {
        let (b, r) = (self.b.diagonal[k], Bounded::of(energy, factor * factor));
        let value = -(r.value * b.value.recip());
        // |factor^2| and the quotient carry a few rounding errors.
        let rounding = 32.0 * U * r.size;
        let error = (r.error + rounding + value.abs() * b.error * UP) / b.least() * UP;
        Bounded { value, error, size: (value.abs() + error) * UP }
    }
}

/// Numbers the clusters: connected discs share a number; a disc that touches no other has none.
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

/// A radius about centre k that contains every pole of the union of its cluster.
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
        .fold(0.0, larger)
}

#[cfg(test)]
mod extremes;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::modes;
    use crate::analysis::modes::parts::Part;
    use crate::analysis::poles::companion::Basis;
    use crate::analysis::poles::refinement::refine;
    use crate::analysis::test_systems::{blank, push};

    /// A chain of four masses with one damper: four pairs, well separated.
    fn chain() -> (Pencil<Precise>, Vec<Pair>) {
        let mut system = blank(4);
        for (i, k) in ["3.1", "1.7", "2.3", "0.9"].into_iter().enumerate() {
            push(&mut system.m, "1.3", i, None);
            push(&mut system.k, k, i, i.checked_sub(1));
        }
        push(&mut system.c, "0.37", 1, None);
        let pencil = Pencil::of(&system, &Part::whole(&system), &[0, 1, 2, 3]);
        let working = pencil.to_dd();
        let basis = Basis::of(&working, &modes(&system).expect("modes"), &RigidMotions::default());
        let starts = basis.spectrum().values();
        let pairs = (0..).zip(&starts).map(|(seed, &start)| refine(&working, &basis, start, seed).expect("a pole"));
        (pencil, pairs.collect())
    }

    fn certify(pencil: &Pencil<Precise>, pairs: &[Pair], count: usize) -> Vec<PoleEnclosure> {
        discs(pencil, &RigidMotions::default(), pairs, count, |_| ()).0
    }

    /// The distance of the disc's centre from the true pole, and its radius.
    fn error(disc: &PoleEnclosure, truth: &PoleEnclosure) -> (f64, f64) {
        let d = disc.s - truth.s;
        (d.re.mid.to_f64().hypot(d.im.mid.to_f64()), disc.s.re.rad.max(disc.s.im.rad))
    }

    #[test]
    fn good_pairs_are_certified_each_by_itself() {
        let (pencil, pairs) = chain();
        let discs = certify(&pencil, &pairs, 8);
        assert_eq!(discs.len(), 4);
        assert!(discs.iter().all(|disc| disc.clusters == [None; 2] && disc.s.re.rad < 1e-28), "{discs:?}");
    }

    /// Nothing is certified if a pole is missing, if there is one too many, or if one occurs twice and another is
    /// missing.
    #[test]
    fn poles_that_are_not_counted_are_not_certified() {
        let (pencil, pairs) = chain();
        let nothing = |pairs: &[Pair], count: usize| certify(&pencil, pairs, count).iter().all(|d| !d.is_certified());
        assert!(nothing(&pairs[..3], 8), "one is missing");
        assert!(nothing(&[pairs.clone(), pairs[..1].to_vec()].concat(), 8), "one is there twice besides");
        assert!(nothing(&[&pairs[..3], &pairs[..1]].concat(), 8), "one is there twice, one is missing");
        assert!(nothing(&pairs, 10), "there are more poles than pairs");
    }

    /// Nearly equal vectors for two poles make B singular, as far as can be decided.
    #[test]
    fn vectors_that_depend_on_each_other_certify_nothing() {
        let (pencil, mut pairs) = chain();
        pairs[1].x = pairs[0].x.clone();
        assert!(certify(&pencil, &pairs, 8).iter().all(|disc| !disc.is_certified()));
    }

    /// One vector is wrong and all other pairs are exact. Then the other columns of R vanish and so does Gershgorin's
    /// radius; the remaining error is the part of B^-1 R off the diagonal of B, which is quadratic in the slip.
    #[test]
    fn a_wrong_vector_widens_its_disc_by_the_square() {
        let (pencil, pairs) = chain();
        let (truth, mut felt) = (certify(&pencil, &pairs, 8), 0);
        for at in 0..4 {
            for slip in [1e-3, 1e-5, 1e-7] {
                let mut wrong = pairs.clone();
                for i in 0..4 {
                    let size = slip * [0.7, -1.0, 0.4, 0.9][(i + at) % 4];
                    wrong[at].x.add(i, Complex::new(size, 0.6 * size));
                }
                let discs = certify(&pencil, &wrong, 8);
                let (error, radius) = error(&discs[at], &truth[at]);
                assert!(error <= radius && radius < 1e4 * slip * slip, "{at} {slip:e}: {error:e} {radius:e}");
                felt += usize::from(error > 1e-3 * slip * slip);
            }
        }
        assert!(felt >= 9, "{felt}");
    }

    /// Wrong numbers, and slightly wrong vectors: everything that is certified contains the true poles.
    #[test]
    fn wrong_pairs_have_discs_that_hold_the_truth() {
        let (pencil, pairs) = chain();
        let truth = certify(&pencil, &pairs, 8);
        for slip in [3e-2, 1e-2, 1e-4] {
            let mut wrong = pairs.clone();
            for (at, pair) in wrong.iter_mut().enumerate() {
                pair.s = pair.s + Complex::new(0.3 * slip, -slip).into();
                (0..4)
                    .for_each(|i| pair.x.add(i, Complex::new(slip * 0.3, slip * [0.2, -0.4, 0.1, 0.3][(i + at) % 4])));
            }
            for (disc, truth) in certify(&pencil, &wrong, 8).iter().zip(&truth) {
                let (error, radius) = error(disc, truth);
                assert!(error <= radius, "{slip:e}: {error:e} {radius:e}");
                assert!(slip > 1e-3 || radius < 1e-4, "{slip:e}: {radius:e}");
            }
        }
    }
}
