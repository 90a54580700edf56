//! The lowest modes of large parts, by what their terms are: so far trees of bodies and springs.

use crate::analysis::answer::Route;
use crate::analysis::modes::eigen::{Displacements, Eigenvalue, Pair};
use crate::analysis::modes::forest::Forest;
use crate::analysis::modes::terms::Terms;
use crate::analysis::modes::tree;
use crate::analysis::numeric::triple::Triple;

/// The `wanted` lowest eigenpairs, rigid motions first; `None` if no sparse method suits the part.
pub fn lowest(stiffness: &Terms, masses: &Terms, n: usize, wanted: usize, tolerance: f64) -> Option<Vec<Pair>> {
    let forest = Forest::of(masses, stiffness, n)?;
    let mut pairs = Vec::with_capacity(wanted);
    if forest.floats {
        let x = tree::rigid_motion(&forest).into_iter().map(Triple::from).collect();
        pairs.push(Pair { value: Eigenvalue::Zero, x: Displacements::Precise(x), route: Route::Exact });
    }
    for mode in tree::lowest(&forest, wanted.saturating_sub(pairs.len()), tolerance)? {
        let value = Eigenvalue::Near { value: mode.lambda, radius: mode.radius, positive: true };
        pairs.push(Pair { value, x: mode.x, route: Route::Tree });
    }
    Some(pairs)
}
