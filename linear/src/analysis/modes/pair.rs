//! Eigenvalues with their vectors, as every method returns them.

use crate::analysis::answer::{Before, Route};
use crate::base::Dd;
use crate::kernel::triple::Triple;
use std::cmp::Ordering;

/// An eigenvalue and its vector.
#[derive(Clone, Debug)]
pub struct Pair {
    pub value: Eigenvalue,
    /// M-normalised.
    pub x: Displacements,
    pub route: Route,
}

/// Displacements, in three words if the stretches of stiff springs need them.
#[derive(Clone, Debug)]
pub enum Displacements {
    Precise(Vec<Triple>),
    Plain(Vec<f64>),
}

impl Displacements {
    pub fn to_f64(&self) -> Vec<f64> {
        match self {
            Displacements::Precise(x) => x.iter().map(|x| x.hi()).collect(),
            Displacements::Plain(x) => x.clone(),
        }
    }

    pub fn into_f64(self) -> Vec<f64> {
        match self {
            Displacements::Precise(x) => x.iter().map(|x| x.hi()).collect(),
            Displacements::Plain(x) => x,
        }
    }

    /// The displacements in double-double, if they are known to more than binary64.
    pub fn precise(&self) -> Option<Vec<Dd>> {
        match self {
            Displacements::Precise(x) => Some(x.iter().map(|x| x.dd()).collect()),
            Displacements::Plain(_) => None,
        }
    }

    pub fn to_triple(&self) -> Vec<Triple> {
        match self {
            Displacements::Precise(x) => x.clone(),
            Displacements::Plain(x) => x.iter().map(|&x| Triple::from(x)).collect(),
        }
    }

    /// The displacements as a vector over n coordinates; the other coordinates stay at rest.
    pub fn spread(self, coordinates: &[u32], n: usize) -> Displacements {
        match self {
            Displacements::Precise(x) => Displacements::Precise(spread(x, coordinates, n, Triple::ZERO)),
            Displacements::Plain(x) => Displacements::Plain(spread(x, coordinates, n, 0.0)),
        }
    }
}

fn spread<T: Copy>(x: Vec<T>, coordinates: &[u32], n: usize, zero: T) -> Vec<T> {
    if coordinates.len() == n {
        return x;
    }
    let mut whole = vec![zero; n];
    coordinates.iter().zip(&x).for_each(|(&i, &x)| whole[i as usize] = x);
    whole
}

#[derive(Clone, Copy, Debug)]
pub enum Eigenvalue {
    /// Zero, exactly.
    Zero,
    /// Within `radius` of `value`; the radius is infinite if nothing could be certified. `positive` if the sign is
    /// known independently of the radius.
    Near { value: Triple, radius: f64, positive: bool },
}

impl Eigenvalue {
    pub fn midpoint(self) -> Triple {
        match self {
            Eigenvalue::Zero => Triple::ZERO,
            Eigenvalue::Near { value, .. } => value,
        }
    }
}

/// Compares by midpoint.
pub fn ascending(a: &Eigenvalue, b: &Eigenvalue) -> Ordering {
    (a.midpoint() - b.midpoint()).hi().partial_cmp(&0.0).unwrap_or(Ordering::Equal)
}

/// Consecutive modes: those computed, ascending, and how many come before them.
pub struct Found {
    pub pairs: Vec<Pair>,
    pub before: Before,
}
