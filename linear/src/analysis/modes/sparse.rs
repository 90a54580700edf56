//! Some modes of large parts, by a method chosen from their terms: one for trees of bodies and springs, one for any
//! other sparse part.

use crate::analysis::answer::{Before, Route};
use crate::analysis::modes::mesh;
use crate::analysis::modes::pair::{Displacements, Eigenvalue, Found, Pair};
use crate::analysis::modes::request::{Request, Which};
use crate::analysis::modes::terms::Terms;
use crate::analysis::modes::tree::{self, forest::Forest};
use crate::kernel::triple::Triple;

/// The requested eigenpairs; `None` if no sparse method suits the part.
pub fn requested_pairs(stiffness: &Terms, masses: &Terms, n: usize, request: &Request) -> Option<Found> {
    of_tree(stiffness, masses, n, request).or_else(|| mesh::requested_pairs(stiffness, masses, n, request))
}

fn of_tree(stiffness: &Terms, masses: &Terms, n: usize, request: &Request) -> Option<Found> {
    let forest = Forest::of(masses, stiffness, n)?;
    let rigid = usize::from(forest.floats);
    let (before, modes) = match request.which {
        Which::Within(band) => tree::modes_within(&forest, band, request.tolerance)?,
        which => (0, tree::lowest(&forest, which.limit().saturating_sub(rigid), request.tolerance)?),
    };
    let wants_rigid = match request.which {
        Which::Within(band) => band.from == 0.0,
        which => which.limit() > 0,
    };
    let mut pairs = Vec::with_capacity(modes.len() + 1);
    if forest.floats && wants_rigid {
        let x = tree::rigid_motion(&forest).into_iter().map(Triple::from).collect();
        pairs.push(Pair { value: Eigenvalue::Zero, x: Displacements::Precise(x), route: Route::Exact });
    }
    for mode in modes {
        let value = Eigenvalue::Near { value: mode.lambda, radius: mode.radius, positive: true };
        pairs.push(Pair { value, x: mode.x, route: Route::Tree });
    }
    let rigid = if wants_rigid { 0 } else { rigid };
    Some(Found { pairs, before: Before { rigid, oscillations: before, ..Before::default() } })
}
