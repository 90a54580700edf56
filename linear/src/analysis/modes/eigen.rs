//! The eigenproblem K x = lambda M x of one part. In: terms. Out: all eigenvalues with certified enclosures.
//!
//! 1. Which motions are rigid is decided exactly ([`structure`]).
//! 2. Approximate modes by the cheapest method that suits the terms ([`start`]).
//! 3. Newton steps for all of them at once, with K and M from the terms in double-double ([`correction`]).
//! 4. Rayleigh quotients in triple words, and their certificate ([`certificate`]). If it is not good enough, steps 2 to
//!    4 are repeated with the next precision.
//!
//! 5. Where that fails for few coordinates, the roots of the polynomial in exact arithmetic ([`exact`]).
//!
//! See docs/method/modes.md#definition, docs/method/modes.md#rigid-body-modes and docs/method/modes.md#certificate.

use crate::analysis::answer::Route;
use crate::analysis::modes::certificate::{Enclosure, enclose};
use crate::analysis::modes::correction;
use crate::analysis::modes::dense;
use crate::analysis::modes::exact;
use crate::analysis::modes::gram::{Gram, SLACK};
use crate::analysis::modes::mass;
use crate::analysis::modes::pair::{Displacements, Eigenvalue, Pair, ascending};
use crate::analysis::modes::scale::Scale;
use crate::analysis::modes::start::{self, Inertia, Start};
use crate::analysis::modes::structure::{self, NullSpace};
use crate::analysis::modes::terms::Terms;
use crate::base::{Dd, OrderBy, larger};
use crate::kernel::dense::{Matrix, cholesky};
use crate::kernel::triple::Triple;
use crate::system::Form;

/// Up to this many coordinates all digits of double-double are computed; beyond, as many as the tolerance asks for.
const ALL_DIGITS: usize = 30;
/// From this many coordinates on, reductions of whole matrices are tried first: they are faster from some 20
/// coordinates on, and give the digits that the tolerance requires.
const MIN_DENSE: usize = ALL_DIGITS + 1;
/// Up to this many coordinates the methods of small problems take seconds.
const MAX_SLOW: usize = 400;
/// A change too small to show in triple words.
const NEGLIGIBLE: f64 = Dd::EPSILON / 256.0;
const MAX_STEPS: usize = 8;

/// The reason why there are no eigenpairs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Failure {
    /// M is not positive definite; detected at this coordinate.
    Mass(usize),
    /// Numbers overflowed to infinity.
    Range,
    /// M is too nearly singular for binary64, and too large for more digits.
    Size,
}

/// All eigenvalues of the pencil of two forms on n coordinates, ascending, to a relative tolerance if it can be
/// reached.
pub fn eigenpairs(k: &Form, m: &Form, n: usize, tolerance: f64) -> Result<Vec<Pair>, Failure> {
    let (stiffness, masses) = (Terms::of(k), Terms::of(m));
    let Some(scale) = Scale::of(&stiffness, &masses) else {
        let pairs = eigenpairs_of(k, &stiffness, &masses, n, tolerance)?;
        return Ok(exact::sharpen(pairs, k, m, tolerance));
    };
    let (k, m) = scale.forms(k, m).ok_or(Failure::Range)?;
    let pairs = eigenpairs_of(&k, &Terms::of(&k), &Terms::of(&m), n, tolerance)?;
    let pairs = exact::sharpen(pairs, &k, &m, tolerance);
    pairs.into_iter().map(|pair| scale.unscale(pair).ok_or(Failure::Range)).collect()
}

/// Like [`eigenpairs`], for prepared terms of `form` and of M that are of ordinary size.
pub fn eigenpairs_of(
    form: &Form,
    stiffness: &Terms,
    masses: &Terms,
    n: usize,
    tolerance: f64,
) -> Result<Vec<Pair>, Failure> {
    if n == 0 {
        return Ok(Vec::new());
    }
    if !(masses.is_finite() && stiffness.is_finite()) {
        return Err(Failure::Range);
    }
    if let Some(at) = mass::doubtful(masses, n) {
        return Err(Failure::Mass(at));
    }
    if n >= MIN_DENSE
        && let Some((pairs, within)) = dense::eigenpairs(&dense::Problem { n, form, stiffness, masses, tolerance })
        && (within || n > MAX_SLOW)
    {
        return Ok(pairs);
    }
    let matrix = mass::assemble(masses, n);
    let lower = cholesky::factor(matrix.clone(), cholesky::rounding(n)).map_err(Failure::Mass)?;
    if n > MAX_SLOW {
        return Err(Failure::Size);
    }
    let problem = Problem {
        n,
        form,
        masses,
        stiffness,
        inertia: Inertia { matrix, lower },
        rigid: structure::null_space(form, n),
        tolerance,
    };
    problem.solve().ok_or(Failure::Range)
}

/// The input from which the modes are computed.
struct Problem<'a> {
    n: usize,
    form: &'a Form,
    masses: &'a Terms<'a>,
    stiffness: &'a Terms<'a>,
    inertia: Inertia,
    rigid: NullSpace,
    tolerance: f64,
}

/// Approximate modes with the pencil in their basis and its certificate.
struct Candidate<'a> {
    start: Start,
    k: Gram<'a>,
    m: Gram<'a>,
    list: Vec<Enclosure>,
}

impl<'a> Problem<'a> {
    /// Tries one method after another until one is certified to the tolerance; otherwise returns the best result.
    /// `None` if numbers overflowed.
    fn solve(&self) -> Option<Vec<Pair>> {
        let mut best: Option<(f64, Candidate)> = None;
        for method in [Problem::first, Problem::second] {
            let candidate = self.refine(method(self));
            let worst = self.worst_bound(&candidate);
            if best.as_ref().is_none_or(|(other, _)| worst < *other) {
                best = Some((worst, candidate));
            }
            if worst <= self.tolerance {
                break;
            }
        }
        let (_, candidate) = best.filter(|(_, candidate)| candidate.is_finite())?;
        Some(self.pairs(&candidate))
    }

    /// Starts in binary64, if that finds a basis; an uncertain zero stretch may leave the basis one column short.
    fn first(&self) -> Start {
        let start = self.in_binary64();
        if start.x.columns() == self.n { start } else { self.second() }
    }

    fn in_binary64(&self) -> Start {
        if self.stiffness.all_positive() {
            return match self.all_rigid_vectors_known() {
                true => start::positive(self.stiffness, &self.inertia, &self.rigid),
                false => self.second(),
            };
        }
        let form = positive_part(self.form);
        let rigid = structure::null_space(&form, self.n);
        if rigid.dimension > rigid.vectors.len() {
            return self.second();
        }
        let positive = start::positive(&Terms::of(&form), &self.inertia, &rigid);
        start::of_both_signs(self.stiffness, positive, self.rigid.vectors.len())
    }

    /// Starts in double-double.
    fn second(&self) -> Start {
        if self.stiffness.all_positive() {
            start::positive_in_double_double(self.stiffness, &self.inertia, &self.rigid)
        } else {
            start::assemble(self.stiffness, &self.inertia, &self.rigid)
        }
    }

    fn all_rigid_vectors_known(&self) -> bool {
        self.rigid.dimension == self.rigid.vectors.len()
    }

    /// Newton steps until the couplings are negligible or stop shrinking, then the certificate.
    fn refine(&self, mut start: Start) -> Candidate<'a> {
        let target = if self.n <= ALL_DIGITS { NEGLIGIBLE } else { (self.tolerance * 1e-3).max(NEGLIGIBLE) };
        let (mut k, mut m) = self.pencil(&start.x);
        let mut distance = self.distance(&k, &m);
        for _ in 0..MAX_STEPS {
            if distance <= target {
                break;
            }
            let x = correction::newton_step(&start.x, &k, &m, start.estimates.as_deref());
            let (next_k, next_m) = self.pencil(&x);
            let next = self.distance(&next_k, &next_m);
            // A first step from estimates may have to put the quotients into order before they improve.
            let stuck = next.is_nan() || (next > 0.25 * distance && start.estimates.is_none());
            if stuck {
                break;
            }
            (k, m, distance) = (next_k, next_m, next);
            start = Start { x, estimates: None, ..start };
        }
        let list = enclose(&k, &m);
        Candidate { start, k, m, list }
    }

    fn pencil(&self, x: &Matrix<Triple>) -> (Gram<'a>, Gram<'a>) {
        (Gram::of(self.stiffness, x), Gram::of(self.masses, x))
    }

    fn distance(&self, k: &Gram, m: &Gram) -> f64 {
        correction::distance_from_diagonal(k, m, self.rigid.vectors.len())
    }

    /// The largest relative bound of an eigenvalue that is not known to be zero.
    fn worst_bound(&self, candidate: &Candidate) -> f64 {
        let known = self.rigid.vectors.len();
        let elastic = candidate.list.iter().filter(|e| e.column >= known);
        elastic
            .map(|e| e.radius / e.lambda.hi().abs())
            .fold(0.0, |worst, x| if x.is_nan() { f64::INFINITY } else { worst.max(x) })
    }

    /// All eigenvalues. The first columns of X are rigid motions, which are exact. If the other eigenvalues that may be
    /// zero are no more than the dimension of the null space leaves, all of them are exactly zero as well. If they are
    /// more, it is not certain which of them is the k-th: each lies in the union of all their enclosures.
    fn pairs(&self, candidate: &Candidate) -> Vec<Pair> {
        let known = self.rigid.vectors.len();
        // Only if all numbers are known is it certain that no further motion lacks stiffness.
        let positive = self.stiffness.all_positive() && self.all_rigid_vectors_known() && self.rigid.exact;
        let may_be_zero = |e: &Enclosure| e.column >= known && !positive && e.lambda.hi().abs() <= e.radius;
        let certain = candidate.list.iter().filter(|e| may_be_zero(e)).count() <= self.rigid.dimension - known;
        let union = candidate.list.iter().filter(|e| e.column < known || may_be_zero(e));
        let union = union.map(|e| (e.lambda.hi().abs() + e.radius) * SLACK).fold(0.0, larger);
        let x = correction::refine_shapes(&candidate.start.x, &candidate.k, &candidate.m);
        let pair = |e: &Enclosure| {
            let rigid = e.column < known || (certain && may_be_zero(e));
            let radius = if may_be_zero(e) { (e.lambda.hi().abs() + union) * SLACK } else { e.radius };
            let value = match rigid {
                true => Eigenvalue::Zero,
                false => Eigenvalue::Near { value: e.lambda, radius, positive },
            };
            let route = if rigid { Route::Exact } else { candidate.start.route };
            Pair { value, x: normalise(&x, &candidate.m, e.column), route }
        };
        let mut pairs: Vec<Pair> = candidate.list.iter().map(pair).collect();
        pairs.order_by(|a, b| ascending(&a.value, &b.value));
        pairs
    }
}

impl Candidate<'_> {
    fn is_finite(&self) -> bool {
        let quotients = self.list.iter().all(|e| e.lambda.is_finite());
        quotients && self.k.is_finite() && self.m.is_finite()
    }
}

fn normalise(x: &Matrix<Triple>, m: &Gram, column: usize) -> Displacements {
    let scale = Triple::from(m.mid[(column, column)].sqrt().recip());
    Displacements::Precise(x.column(column).iter().map(|&x| x * scale).collect())
}

/// The terms of positive weight.
fn positive_part(form: &Form) -> Form {
    let mut part = Form::new();
    for term in form.terms().filter(|term| term.weight.is_positive()) {
        let source = part.source(form.source_of(term.source));
        part.push(source, term.nature, term.weight.clone(), form.row(term).copies());
    }
    part
}
