//! The load factor to buckling: by how much gravity, tensions and reactions could grow before a motion loses its stiffness.
//!
//! K = K_p + K_g: what the model gives as stiffness, and what its loads make of the geometry. In: a linear system. Out: the
//! least alpha > 0 for which K_p + alpha K_g is singular, below 1 for what has buckled already.
//!
//! - K_p positive definite: -K_g x = mu K_p x, alpha = 1 / mu for the largest mu.
//! - Else, if K is: K_g x = rho K x, alpha = 1 - 1 / rho for the least rho, which has to be negative.
//!
//! Both are eigenproblems like that of the modes, with its bounds. Clause: spec.md 10.9.

use crate::analysis::modes::MAX_UNASKED;
use crate::analysis::modes::eigen::{Eigenvalue, Failure, Pair, eigenpairs};
use crate::analysis::modes::parts::{Part, chosen, independent_undamped};
use crate::analysis::{modes::certificate, modes::shape};
use crate::base::Ball;
use crate::system::{Form, LinearSystem, Nature, Term};

/// Relative accuracy that a load factor should have.
const TOLERANCE: f64 = 1e-12;

/// How far a system is from buckling.
#[derive(Clone, Debug)]
pub struct Buckling {
    pub load_factor: Ball,
    /// Displacement of each coordinate in the motion that loses its stiffness, its largest 1.
    pub shape: Vec<f64>,
}

/// The least load factor of all parts; `None` where no load softens anything, where it is not defined (a motion without any
/// stiffness), or where it could not be certified.
pub fn buckling(system: &LinearSystem) -> Option<Buckling> {
    let softened = |term: &Term| term.nature == Nature::Geometric && term.weight.is_negative();
    if !system.k.terms().iter().any(softened) || system.is_chained() {
        return None;
    }
    let mut local = vec![0u32; system.n()];
    let mut least: Option<Buckling> = None;
    for part in independent_undamped(system) {
        part.coordinates.iter().enumerate().for_each(|(i, &c)| local[c as usize] = i as u32);
        let k = chosen(&system.k, &part.k, &local);
        if part.coordinates.len() > MAX_UNASKED || !k.terms().iter().any(softened) {
            continue;
        }
        let Some(found) = of_part(system, &part, &k) else { continue };
        if least.as_ref().is_none_or(|other| found.load_factor.mid < other.load_factor.mid) {
            least = Some(found);
        }
    }
    least
}

fn of_part(system: &LinearSystem, part: &Part, k: &Form) -> Option<Buckling> {
    let n = part.coordinates.len();
    let given = weighted(k, |term| (term.nature == Nature::Property).then_some(false));
    let softening = weighted(k, |term| (term.nature == Nature::Geometric).then_some(true));
    let (load_factor, pair) = match eigenpairs(&softening, &given, n, TOLERANCE) {
        Ok(pairs) => {
            let pair = pairs.into_iter().next_back()?;
            (Ball::ONE / positive(&pair)?, pair)
        }
        Err(Failure::Range | Failure::Size) => return None,
        Err(Failure::Mass(_)) => {
            // -rho, descending: the pencil with -K_g again.
            let pair = eigenpairs(&softening, k, n, TOLERANCE).ok()?.into_iter().next_back()?;
            (Ball::ONE + Ball::ONE / positive(&pair)?, pair)
        }
    };
    let whole = pair.x.spread(&part.coordinates, system.n()).to_f64();
    Some(Buckling { load_factor, shape: shape::with_largest_one(&whole) })
}

/// The eigenvalue if it is certainly positive.
fn positive(pair: &Pair) -> Option<Ball> {
    let Eigenvalue::Near { value, radius, .. } = pair.value else { return None };
    let ball = certificate::ball(value, radius);
    ball.is_positive().then_some(ball)
}

/// The terms that `choose` takes, negated where it says so.
fn weighted(form: &Form, choose: impl Fn(&Term) -> Option<bool>) -> Form {
    let mut result = Form::new();
    for term in form.terms() {
        let Some(negated) = choose(term) else { continue };
        let source = result.source(form.source_name(term.source));
        let weight = if negated { -&term.weight } else { term.weight.clone() };
        result.push(source, term.nature, weight, form.row(term).iter().cloned());
    }
    result
}
