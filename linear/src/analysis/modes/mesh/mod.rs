//! Some modes of a large part of any structure: meshes, levers, bodies whose inertia couples a few coordinates.
//!
//! 1. The terms become a network ([`network`]), eliminated in an order with little fill ([`elimination`]).
//! 2. Approximate modes about a shift ([`krylov`]).
//! 3. A gap above the last wanted mode, and a certified count below it: it equals the number of modes found, so none is
//!    missed.
//! 4. Each vector whose residual requires it is corrected once, x <- x - (K - sigma M)^-1 (K x - theta M x); the sum of
//!    the two binary64 vectors is kept ([`residual`]).
//! 5. Bounds. With X the k vectors found, their span's complement in M keeps eigenvalues above the gap: at its upper end s,
//!    K - s M has at most k negative eigenvalues and s M^ - K^ >= g > 0 on X, so by Sylvester's law the complement W has
//!    W >= s - b^2/g, b^2 = sum |r_j|^2, r_j = K x_j - theta_j M x_j in the norm of M^-1. For t below that, K - t M has as
//!    many negative eigenvalues as X^T (K - t M) X - D(t), |D_ij| <= |r_i| |r_j| / (s - b^2/g - t), and the certificate of
//!    small problems encloses those ([`certificate`]). Repeated frequencies are certified as groups there.
//!
//! See docs/method/modes.md#sparse-parts.

pub mod close;
pub mod elimination;
pub mod krylov;
pub mod network;
pub mod postponed;
pub mod residual;

use crate::analysis::answer::{Before, Route};
use crate::analysis::modes::certificate::{Enclosure, enclose};
use crate::analysis::modes::gram::Gram;
use crate::analysis::modes::mesh::elimination::{Factors, Pattern, Rounding};
use crate::analysis::modes::mesh::krylov::{Krylov, Ritz};
use crate::analysis::modes::mesh::network::{Network, UP};
use crate::analysis::modes::mesh::residual::{Multiplier, residual};
use crate::analysis::modes::pair::Found;
use crate::analysis::modes::pair::{Displacements, Eigenvalue, Pair};
use crate::analysis::modes::request::{Request, Which};
use crate::analysis::modes::terms::Terms;
use crate::base::{Dd, OrderBy, Power};
use crate::kernel::dense::Matrix;
use crate::kernel::triple::Triple;
use std::ops::Range;

/// Larger bases are not tried.
const MOST_VECTORS: usize = 400;
/// A residual of the operator that will hardly shrink any further.
const CONVERGED: f64 = 1e-11;
/// Maximum number of numbers in all vectors of the basis together.
const MOST_NUMBERS: usize = 200_000_000;

/// The requested eigenpairs; `None` if this method does not find them.
pub fn requested_pairs(stiffness: &Terms, masses: &Terms, n: usize, request: &Request) -> Option<Found> {
    if !(stiffness.is_finite() && masses.is_finite()) {
        return None;
    }
    Mesh::of(stiffness, masses, n)?.requested_pairs(request)
}

/// A part as networks and terms.
struct Mesh<'a> {
    stiffness: &'a Terms<'a>,
    masses: &'a Terms<'a>,
    k: Network,
    m: Network,
    pattern: Pattern,
    /// M >= diag(scale).
    scale: Vec<f64>,
    /// Rigid motions, exact.
    rigid: Vec<Vec<f64>>,
}

/// Vectors with the cut above them: a shift in a gap of the spectrum.
struct Cut {
    ritz: Vec<Ritz>,
    /// At most as many eigenvalues as there are vectors lie below this.
    above: f64,
}

/// The reason why there is no cut yet.
enum Lack {
    Steps,
    Modes,
}

impl<'a> Mesh<'a> {
    fn of(stiffness: &'a Terms<'a>, masses: &'a Terms<'a>, n: usize) -> Option<Mesh<'a>> {
        let (k, m) = (Network::of(stiffness, n)?, Network::of(masses, n)?);
        if m.diagonal.iter().any(|&mass| mass.is_nan() || mass <= 0.0) {
            return None;
        }
        let pattern = Pattern::of(&[&k, &m])?;
        let scale = least_inertia(&m)?;
        // Any term other than a spring between two coordinates has a ground; without such terms the part floats as a
        // whole.
        let floats = (0..n).all(|i| k.positive[i].value == 0.0 && k.negative[i].value == 0.0)
            && (0..n).all(|i| k.positive[i].error == 0.0)
            && stiffness.all_positive();
        let rigid = if floats { vec![vec![1.0; n]] } else { Vec::new() };
        Some(Mesh { stiffness, masses, k, m, pattern, scale, rigid })
    }

    fn requested_pairs(&self, request: &Request) -> Option<Found> {
        let n = self.k.n();
        let wanted = match request.which {
            Which::Within(band) => {
                let above = band.to * band.to * (1.0 + 1e-9);
                self.pattern.count(&self.k, &self.m, above, Rounding::Down)?
            }
            which => which.limit(),
        };
        if wanted == 0 {
            return Some(Found { pairs: Vec::new(), before: Before::default() });
        }
        let most = MOST_VECTORS.min(MOST_NUMBERS / n);
        if wanted + 10 > most {
            return None;
        }
        let sigma = self.shift()?;
        let factors = self.pattern.factor(&self.k, &self.m, sigma)?;
        let mut krylov = Krylov::new(&factors, &self.m, sigma, &self.rigid)?;
        let cut = self.cut(&mut krylov, wanted.min(n), most)?;
        let vectors: Vec<Vec<f64>> = cut.ritz.iter().map(|ritz| krylov.vector(ritz)).collect();
        let pairs = self.certify(&factors, &cut, vectors, request.tolerance)?;
        Some(Found { pairs, before: Before::default() })
    }

    /// A shift below all eigenvalues, near the lowest: zero, if K is positive definite.
    fn shift(&self) -> Option<f64> {
        let below = |s: f64| self.pattern.factor(&self.k, &self.m, s).is_some();
        if self.rigid.is_empty() && below(0.0) {
            return Some(0.0);
        }
        // Start far below, then come nearer until some eigenvalue is below.
        let size = |i: usize| self.k.diagonal[i].abs() / self.m.diagonal[i];
        let largest = (0..self.k.n()).map(size).fold(0.0, f64::max);
        let mut shift = -4.0 * largest;
        if !below(shift) {
            return None;
        }
        let least = if self.rigid.is_empty() { 1e-10 } else { 0.0 };
        if !self.rigid.is_empty() {
            return self.shift_of_free(largest);
        }
        while shift.abs() > least * largest && below(0.25 * shift) {
            shift *= 0.25;
        }
        Some(shift)
    }

    /// A shift for a part that floats: about as far below zero as the first frequency lies above.
    fn shift_of_free(&self, largest: f64) -> Option<f64> {
        let count = |s: f64| self.pattern.count(&self.k, &self.m, s, Rounding::Nearest);
        let (mut high, mut low) = (largest, 0.0);
        for _ in 0..60 {
            if count(high)? > 1 {
                high *= if low == 0.0 { 1e-3 } else { 0.3 };
                continue;
            }
            low = high;
            break;
        }
        (low > 0.0).then_some(-low)
    }

    /// Finds modes until the wanted ones and a gap above them have converged, and a count proves that none is missing.
    fn cut(&self, krylov: &mut Krylov, wanted: usize, most: usize) -> Option<Cut> {
        let mut next = (2 * wanted + 10).min(self.k.n());
        loop {
            let mut before = krylov.len();
            while krylov.len() < next.min(most) {
                krylov.step();
                if krylov.len() == before {
                    krylov.add_scrambled();
                    if krylov.len() == before {
                        break;
                    }
                }
                before = krylov.len();
            }
            let mut ritz = krylov.ritz();
            ritz.order_by(|a, b| a.lambda.total_cmp(&b.lambda));
            match self.cut_of(ritz, wanted) {
                Ok(cut) => return Some(cut),
                Err(_) if next >= most || next >= self.k.n() => return None,
                Err(Lack::Steps) => {}
                // Some frequency repeats more often than a block is wide.
                Err(Lack::Modes) => krylov.add_scrambled(),
            }
            next += (next / 4).max(8);
        }
    }

    /// A gap above the wanted modes, if those below it have converged and the count shows that there are no others.
    fn cut_of(&self, mut ritz: Vec<Ritz>, wanted: usize) -> Result<Cut, Lack> {
        let converged = ritz.iter().take_while(|ritz| ritz.residual <= CONVERGED).count();
        let whole = converged == self.k.n();
        if converged < wanted || (!whole && converged < wanted + 1) {
            return Err(Lack::Steps);
        }
        if whole {
            let above = ritz.last().map_or(0.0, |last| last.lambda.abs() * 4.0);
            return Ok(Cut { ritz, above });
        }
        // The relatively widest gap among the next few; a narrow one only costs digits of the bounds.
        let gap = |i: usize| (ritz[i].lambda - ritz[i - 1].lambda) / ritz[i].lambda.abs();
        let last = (wanted + LOOK_AHEAD).min(converged - 1);
        let best = (wanted..=last).fold(wanted, |best, i| if gap(i) > 1.5 * gap(best) { i } else { best });
        let (below, above) = (ritz[best - 1].lambda, ritz[best].lambda);
        // The shape of one of several close modes can be determined only if all of them are there.
        if above - below <= close::CLOSE * above.abs() && converged < wanted + FAR_AHEAD {
            return Err(Lack::Steps);
        }
        // Nearer to the upper end, as far as the rounding of the count allows.
        for part in [0.9, 0.5] {
            let s = below + part * (above - below);
            if self.pattern.count(&self.k, &self.m, s, Rounding::Down).is_some_and(|count| count <= best) {
                ritz.truncate(best);
                return Ok(Cut { ritz, above: s });
            }
        }
        Err(Lack::Modes)
    }

    /// The modes of the cut with their bounds, corrected if their residuals require it.
    fn certify(&self, factors: &Factors, cut: &Cut, vectors: Vec<Vec<f64>>, tolerance: f64) -> Option<Vec<Pair>> {
        let (k, m) = (Multiplier::of(self.stiffness, self.k.n()), Multiplier::of(self.masses, self.k.n()));
        let lambda: Vec<f64> = cut.ritz.iter().map(|ritz| ritz.lambda).collect();
        let runs = close::runs(&lambda[self.rigid.len().min(lambda.len())..]);
        let runs: Vec<Range<usize>> =
            runs.into_iter().map(|run| run.start + self.rigid.len()..run.end + self.rigid.len()).collect();
        let mut basis: Vec<Vec<Dd>> = Vec::with_capacity(vectors.len());
        let (mut norms, mut corrected) = (Vec::with_capacity(vectors.len()), false);
        for (index, (ritz, vector)) in cut.ritz.iter().zip(vectors).enumerate() {
            if let Some(rigid) = self.rigid.get(index) {
                basis.push(rigid.iter().map(|&x| Dd::from(x)).collect());
                norms.push(0.0);
                continue;
            }
            let of = |x: &[Dd], theta: Dd| residual(&k, &m, x, theta, &self.scale);
            let mut x: Vec<Dd> = vector.iter().map(|&x| Dd::from(x)).collect();
            let mut now = of(&x, Dd::from(ritz.lambda));
            // The bound is about the square of the residual over the gap.
            let mut enough = (0.1 * tolerance * (cut.above - ritz.lambda).abs() * ritz.lambda.abs()).sqrt();
            let mut corrections = MAX_CORRECTIONS;
            if runs.iter().any(|run| run.contains(&index)) {
                // Components of modes outside the run would mix the vectors within it.
                (enough, corrections) = (0.0, MAX_CORRECTIONS_OF_CLOSE);
            }
            for _ in 0..corrections {
                if now.norm <= enough {
                    break;
                }
                let theta = now.quotient;
                let mut change = vec![of(&x, theta).value];
                factors.solve(&mut change, &mut Vec::new());
                let next: Vec<Dd> = x.iter().zip(&change[0]).map(|(&x, &d)| x - Dd::from(d)).collect();
                let then = of(&next, theta);
                if then.norm.is_nan() || then.norm >= 0.5 * now.norm {
                    break;
                }
                (x, now, corrected) = (next, then, true);
            }
            norms.push(now.norm);
            basis.push(x);
        }
        for run in runs {
            let Some(apart) = close::separate_close_modes(self.stiffness, self.masses, &basis[run.clone()]) else {
                continue;
            };
            for (index, x) in run.zip(apart) {
                let theta = residual(&k, &m, &x, Dd::from(lambda[index]), &self.scale).quotient;
                norms[index] = residual(&k, &m, &x, theta, &self.scale).norm;
                basis[index] = x;
                corrected = true;
            }
        }
        self.enclose_modes(cut, basis, &norms, corrected)
    }

    /// Step 5 of the module.
    fn enclose_modes(&self, cut: &Cut, basis: Vec<Vec<Dd>>, norms: &[f64], corrected: bool) -> Option<Vec<Pair>> {
        let count = basis.len();
        let x = Matrix::from_fn(self.k.n(), count, |i, j| Triple::from(basis[j][i]));
        let (k, m) = (Gram::of(self.stiffness, &x), Gram::of(self.masses, &x));
        let top = cut.ritz.iter().map(|ritz| ritz.lambda).fold(f64::NEG_INFINITY, f64::max);
        let floor = self.complement(cut.above, &k, &m, norms);
        let gap = (floor - top) * 0.5;
        let slips = if gap > 0.0 {
            norms.iter().map(|norm| norm / gap.sqrt() * UP).collect()
        } else {
            vec![f64::INFINITY; count]
        };
        let list = enclose(&k.with_slips(slips), &m);
        // D(t) was bounded for t up to the middle of the gap.
        let holds = |e: &Enclosure| e.lambda.hi() + e.radius <= top + gap;
        let pair = |e: &Enclosure| {
            let scale = m.mid[(e.column, e.column)].sqrt().recip();
            let x = &basis[e.column];
            let x = match corrected {
                true => Displacements::Precise(x.iter().map(|&x| Triple::from(x * scale)).collect()),
                false => Displacements::Plain(x.iter().map(|x| x.hi * scale.hi).collect()),
            };
            if e.column < self.rigid.len() {
                return Pair { value: Eigenvalue::Zero, x, route: Route::Exact };
            }
            let radius = if holds(e) { e.radius } else { f64::INFINITY };
            // There is no exact argument that K is positive definite: an eigenvalue that may be zero is reported as
            // such.
            Pair { value: Eigenvalue::Near { value: e.lambda, radius, positive: false }, x, route: Route::Sparse }
        };
        Some(list.iter().map(pair).collect())
    }

    /// A lower bound of the eigenvalues in the complement of the vectors.
    fn complement(&self, s: f64, k: &Gram, m: &Gram, norms: &[f64]) -> f64 {
        let count = norms.len();
        let size = s.abs() * UP;
        let entry = |i: usize, j: usize| {
            let t = Dd::from(s) * m.mid[(i, j)] - k.mid[(i, j)];
            (
                t.hi,
                (k.radius(i, j)
                    + size * m.radius(i, j)
                    + 1e-15 * (k.mid[(i, j)].hi.abs() + size * m.mid[(i, j)].hi.abs()))
                    * UP,
            )
        };
        let (mut least, mut outside) = (f64::INFINITY, 0.0);
        for j in 0..count {
            for i in 0..count {
                let (t, error) = entry(i, j);
                if i == j {
                    least = least.min(t - error);
                } else {
                    outside += (t.abs() + error).power(2);
                }
            }
        }
        let g = least - outside.sqrt() * UP;
        let b: f64 = norms.iter().map(|norm| norm * norm).sum();
        if g > 0.0 { s - b / g * UP } else { f64::NEG_INFINITY }
    }
}

/// A gap is looked for among this many modes beyond the wanted ones.
const LOOK_AHEAD: usize = 4;
/// This many more modes are computed before a cut between two close ones is accepted.
const FAR_AHEAD: usize = 40;
const MAX_CORRECTIONS: usize = 3;
const MAX_CORRECTIONS_OF_CLOSE: usize = 8;

/// d with M >= diag(d): M itself if it is diagonal, otherwise a part of its diagonal that a count confirms.
pub(in crate::analysis) fn least_inertia(m: &Network) -> Option<Vec<f64>> {
    if m.is_diagonal() {
        let exact = |i: usize| m.positive[i].value - m.positive[i].error - m.negative[i].value - m.negative[i].error;
        return Some((0..m.n()).map(exact).collect()).filter(|scale: &Vec<f64>| scale.iter().all(|&d| d > 0.0));
    }
    let diagonal = Network::of_diagonal(&m.diagonal);
    let pattern = Pattern::of(&[m, &diagonal])?;
    let parts = [0.3, 0.1, 0.03, 1e-2, 1e-3, 1e-4, 1e-6];
    let holds = |part: f64| pattern.count(m, &diagonal, part, Rounding::Down) == Some(0);
    let part = parts.into_iter().find(|&part| holds(part))?;
    Some(m.diagonal.iter().map(|d| d * part).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::modes::eigen::eigenpairs;
    use crate::analysis::test_systems::{blank, push};
    use crate::base::Number;
    use crate::system::{CoordinateId, LinearSystem, Nature};

    /// A square grid of springs; stiffnesses have decimal mantissas over this many decades.
    fn net(side: usize, decades: i32, held: bool) -> LinearSystem {
        let mut system = blank(side * side);
        let mut seed = 3u64;
        let mut k = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let exponent = (seed >> 40) as i32 % (decades + 1) - decades / 2;
            format!("{}.{:03}e{exponent}", 1 + (seed >> 33) % 9, (seed >> 35) % 1000)
        };
        for at in 0..side * side {
            push(&mut system.m, "1.7", at, None);
            if at >= side {
                push(&mut system.k, &k(), at - side, Some(at));
            }
            if at % side > 0 {
                push(&mut system.k, &k(), at - 1, Some(at));
            }
        }
        if held {
            push(&mut system.k, "3.3", 0, None);
        }
        system
    }

    fn dense(system: &LinearSystem) -> Vec<(Triple, f64)> {
        let pairs = eigenpairs(&system.k, &system.m, system.n(), 1e-20).expect("a regular system");
        let value = |pair: &Pair| match pair.value {
            Eigenvalue::Near { value, radius, .. } => (value, radius),
            Eigenvalue::Zero => (Triple::ZERO, 0.0),
        };
        pairs.iter().map(value).collect()
    }

    #[test]
    fn the_lowest_modes_of_a_net_are_those_of_its_dense_matrix() {
        for (decades, held) in [(0, true), (12, true), (12, false)] {
            let system = net(9, decades, held);
            let (k, m) = (Terms::of(&system.k), Terms::of(&system.m));
            let request = Request { which: Which::Lowest(6), tolerance: 1e-14, ..Request::default() };
            let found = requested_pairs(&k, &m, system.n(), &request).expect("a net").pairs;
            assert!(found.len() >= 6);
            for (pair, (truth, known)) in found.iter().zip(dense(&system)) {
                let Eigenvalue::Near { value, radius, .. } = pair.value else {
                    assert!(truth.is_zero());
                    continue;
                };
                let error = (value - truth).hi().abs();
                assert!(error <= radius + known, "{error:e} {radius:e}");
                assert!(radius <= 1e-14 * value.hi(), "{:e}", radius / value.hi());
            }
        }
    }

    /// On either side of each frequency, over twelve decades of stiffness: the count rounded down is never too small,
    /// the one rounded up is never too large, and both are right.
    #[test]
    fn counts_hold_from_both_sides() {
        let system = net(9, 12, true);
        let (k, m) = (
            Network::of(&Terms::of(&system.k), 81).expect("sparse"),
            Network::of(&Terms::of(&system.m), 81).expect("sparse"),
        );
        let pattern = Pattern::of(&[&k, &m]).expect("little fill");
        let truth = dense(&system);
        for (number, pair) in truth.windows(2).enumerate().step_by(5) {
            let s = 0.5 * (pair[0].0.hi() + pair[1].0.hi());
            let counts = [Rounding::Down, Rounding::Up].map(|rounding| pattern.count(&k, &m, s, rounding));
            assert_eq!(counts, [Some(number + 1); 2], "below {s:e}");
        }
    }

    /// So close to an eigenvalue that rounding decides: 0.3 x^2 - s 0.1 x^2 is zero at s = 3 exactly, but not for the
    /// binary numbers nearest to 0.3 and 0.1.
    #[test]
    fn counts_hold_within_the_last_bits_too() {
        for (k, m, lambda) in [("0.3", "0.1", 3.0), ("0.7", "0.1", 7.0), ("2.1", "0.3", 7.0), ("1.1", "0.1", 11.0)] {
            let mut system = blank(2);
            push(&mut system.m, m, 0, None);
            push(&mut system.m, m, 1, None);
            push(&mut system.k, k, 0, None);
            // A second body that is hardly coupled to the first, so that there is a pair to eliminate.
            push(&mut system.k, "1e9", 1, None);
            push(&mut system.k, "1e-40", 0, Some(1));
            let of = |form| Network::of(&Terms::of(form), 2).expect("sparse");
            let (k, m) = (of(&system.k), of(&system.m));
            let pattern = Pattern::of(&[&k, &m]).expect("little fill");
            let mut s = lambda;
            (0..40).for_each(|_| s = f64::next_down(s));
            for step in -40..=40 {
                // The spring of 1e-40 moves the eigenvalue by far less than a last bit.
                let truth = usize::from(step > 0);
                let count = |rounding| pattern.count(&k, &m, s, rounding).expect("in range");
                assert!(count(Rounding::Down) >= truth, "{lambda}: {step}");
                assert!(count(Rounding::Up) <= truth.max(usize::from(step == 0)), "{lambda}: {step}");
                s = s.next_up();
            }
        }
    }

    /// Vectors as accurate as possible, but one fewer than there are below the gap: the count detects it.
    #[test]
    fn a_mode_that_the_vectors_miss_is_counted() {
        let system = net(9, 2, true);
        let (k, m) = (Terms::of(&system.k), Terms::of(&system.m));
        let mesh = Mesh::of(&k, &m, system.n()).expect("a net");
        let all: Vec<f64> = dense(&system).iter().map(|(value, _)| value.hi()).collect();
        let vectors = |missing: Option<usize>| {
            let kept = all.iter().enumerate().filter(|(i, _)| Some(*i) != missing).take(30);
            kept.map(|(_, lambda)| Ritz::of_value(*lambda)).collect::<Vec<_>>()
        };
        assert!(mesh.cut_of(vectors(None), 10).is_ok());
        for missing in [0, 4, 9] {
            assert!(matches!(mesh.cut_of(vectors(Some(missing)), 10), Err(Lack::Modes)), "{missing}");
        }
    }

    /// Bodies whose inertia couples neighbours, and levers: the inverse of M is not diagonal.
    #[test]
    fn coupled_inertia_and_levers_have_their_modes_too() {
        let n = 40;
        let mut system = net(1, 0, false);
        system = LinearSystem { coordinates: blank(n).coordinates, ..system };
        let one = |i: usize, a: &str| {
            let value = match a.strip_prefix('-') {
                Some(a) => -&Number::from(a),
                None => Number::from(a),
            };
            (CoordinateId(i as u32), value)
        };
        let label = system.coordinates[0].name;
        let m = system.m.source(label);
        let k = system.k.source(label);
        for i in 0..n {
            let weight = Number::from(format!("1.{i:02}").as_str());
            if i > 0 {
                system.m.push(m, Nature::Property, weight.clone(), [one(i - 1, "0.5"), one(i, "0.5")]);
                system.m.push(m, Nature::Property, weight.clone(), [one(i, "0.3")]);
                system.k.push(k, Nature::Property, weight.clone(), [one(i - 1, "-1.7"), one(i, "2.3")]);
            }
            if i > 2 {
                system.k.push(k, Nature::Property, weight, [one(i - 3, "0.4"), one(i - 1, "-1"), one(i, "0.7")]);
            }
        }
        system.k.push(k, Nature::Property, Number::from("5"), [one(0, "1")]);
        let (k, m) = (Terms::of(&system.k), Terms::of(&system.m));
        let request = Request { which: Which::Lowest(5), ..Request::default() };
        let found = requested_pairs(&k, &m, n, &request).expect("positive definite").pairs;
        for (pair, (truth, known)) in found.iter().zip(dense(&system)) {
            let Eigenvalue::Near { value, radius, .. } = pair.value else { panic!("it is held") };
            assert!((value - truth).hi().abs() <= radius + known);
            assert!(radius <= 1e-12 * value.hi(), "{radius:e}");
        }
    }

    /// Springs to the ground of either sign: the lowest modes diverge.
    #[test]
    fn diverging_motions_are_found_first() {
        let mut system = net(9, 2, true);
        let label = system.coordinates[0].name;
        let k = system.k.source(label);
        for (i, weight) in [(40, "9.1"), (44, "0.7"), (80, "2.3")] {
            let row = [(CoordinateId(i), Number::ONE)];
            system.k.push(k, Nature::Geometric, -&Number::from(weight), row);
        }
        let (k, m) = (Terms::of(&system.k), Terms::of(&system.m));
        let request = Request { which: Which::Lowest(6), ..Request::default() };
        let found = requested_pairs(&k, &m, system.n(), &request).expect("a net").pairs;
        let truth = dense(&system);
        assert!(truth[0].0.hi() < 0.0 && truth[5].0.hi() > 0.0);
        for (pair, (truth, known)) in found.iter().zip(truth) {
            let Eigenvalue::Near { value, radius, .. } = pair.value else { panic!("no motion is rigid") };
            assert!((value - truth).hi().abs() <= radius + known);
            assert!(radius <= 1e-12 * value.hi().abs(), "{radius:e}");
        }
    }

    /// An arm that occurs seven times: more copies of a frequency than a block of vectors can find by itself.
    #[test]
    fn no_copy_of_a_frequency_is_missed() {
        let (arms, length) = (7, 12);
        let mut system = blank(1 + arms * length);
        push(&mut system.m, "3", 0, None);
        push(&mut system.k, "2", 0, None);
        for arm in 0..arms {
            for i in 0..length {
                let at = 1 + arm * length + i;
                push(&mut system.m, "1.1", at, None);
                push(&mut system.k, "77", at, Some(if i == 0 { 0 } else { at - 1 }));
                if i > 1 {
                    push(&mut system.k, "13", at, Some(at - 2));
                }
            }
        }
        let (k, m) = (Terms::of(&system.k), Terms::of(&system.m));
        let request = Request { which: Which::Lowest(12), ..Request::default() };
        let found = requested_pairs(&k, &m, system.n(), &request).expect("a net").pairs;
        for (pair, (truth, known)) in found.iter().zip(dense(&system)) {
            let Eigenvalue::Near { value, radius, .. } = pair.value else { panic!("it is held") };
            assert!((value - truth).hi().abs() <= radius + known);
            assert!(radius <= 1e-12 * value.hi());
        }
    }
}
