//! Modes near a shift: the block Lanczos method on (K - sigma M)^-1 M with full orthogonalisation.
//!
//! In: the factors of K - sigma M and M. Out: approximate modes, nearest first in 1/(lambda - sigma). Start vectors are
//! pseudo-random, so that no symmetry hides a mode; a block finds repeated frequencies, and if more of them repeat than
//! a block is wide, new pseudo-random vectors are added. Whether any mode is missed is decided not here but by counts
//! ([`super::elimination`]). (Ericsson and Ruhe, Math. Comp. 35 (1980) 1251; Golub and Underwood 1977.) See
//! docs/method/modes.md#sparse-parts.

use crate::analysis::modes::mesh::elimination::Factors;
use crate::analysis::modes::mesh::network::Network;
use crate::base::OrderBy;
use crate::kernel::real::Float;
use nalgebra::DMatrix;

/// Number of vectors that are multiplied at once.
pub const BLOCK: usize = 2;
/// A part of a vector below this is rounding error.
const NOTHING: f64 = 1e-10;

/// A basis that is orthonormal in M, and the operator projected onto it.
pub struct Krylov<'a> {
    factors: &'a Factors<'a>,
    m: &'a Network,
    sigma: f64,
    /// q and M q.
    basis: Vec<Vec<f64>>,
    images: Vec<Vec<f64>>,
    /// For each vector that was multiplied, q_i^T M A q_j for all i up to the last vector that resulted from it.
    projected: Vec<Vec<f64>>,
    /// Number of vectors that were multiplied.
    done: usize,
    seed: u64,
    room: Vec<f64>,
}

/// An approximate mode: its eigenvalue, its residual |A x - nu x| / |nu|, and its coordinates in the basis.
#[derive(Clone, Debug)]
pub struct Ritz {
    pub lambda: f64,
    pub residual: f64,
    coordinates: Vec<f64>,
}

#[cfg(test)]
impl Ritz {
    /// A converged value.
    pub fn of_value(lambda: f64) -> Ritz {
        Ritz { lambda, residual: 0.0, coordinates: Vec::new() }
    }
}

impl<'a> Krylov<'a> {
    /// A basis that starts with the `known` vectors, whose eigenvalue is zero.
    pub fn new(factors: &'a Factors<'a>, m: &'a Network, sigma: f64, known: &[Vec<f64>]) -> Option<Krylov<'a>> {
        let mut krylov = Krylov {
            factors,
            m,
            sigma,
            basis: Vec::new(),
            images: Vec::new(),
            projected: Vec::new(),
            done: 0,
            seed: 1,
            room: Vec::new(),
        };
        for vector in known {
            krylov.push(vec![vector.clone()]);
            let mut column = vec![0.0; krylov.basis.len()];
            column[krylov.basis.len() - 1] = -1.0 / sigma;
            krylov.projected.push(column);
        }
        krylov.done = krylov.basis.len();
        krylov.add_scrambled();
        krylov.basis.iter().flatten().all(|x| x.is_finite()).then_some(krylov)
    }

    pub fn len(&self) -> usize {
        self.basis.len()
    }

    /// Adds a block of pseudo-random vectors, smoothed once.
    pub fn add_scrambled(&mut self) {
        let n = self.m.n();
        let mut block: Vec<Vec<f64>> = Vec::new();
        for _ in 0..BLOCK {
            let scrambled: Vec<f64> = (0..n).map(|_| self.scrambled_number()).collect();
            let mut image = vec![0.0; n];
            self.m.apply(&scrambled, &mut image);
            block.push(image);
        }
        self.factors.solve(&mut block, &mut self.room);
        self.push(block);
    }

    /// A pseudo-random number between -1 and 1 (the generator of Steele, Lea and Flood, OOPSLA 2014).
    fn scrambled_number(&mut self) -> f64 {
        self.seed = self.seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.seed;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// Multiplies the vectors that were not multiplied yet.
    pub fn step(&mut self) {
        let from = self.done;
        let until = (from + BLOCK).min(self.basis.len());
        if from == until {
            return self.add_scrambled();
        }
        let mut block: Vec<Vec<f64>> = self.images[from..until].to_vec();
        self.factors.solve(&mut block, &mut self.room);
        self.done = until;
        let columns = self.push(block);
        self.projected.extend(columns);
    }

    /// Orthogonalises a block against the basis, twice, and appends the remainders; returns the coordinates of each
    /// vector in the enlarged basis.
    fn push(&mut self, mut block: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
        let mut coordinates = vec![vec![0.0; self.basis.len()]; block.len()];
        let sizes: Vec<f64> = block.iter().map(|x| self.length(x)).collect();
        for _ in 0..2 {
            for i in 0..self.basis.len() {
                for (x, coordinates) in block.iter_mut().zip(&mut coordinates) {
                    let part = f64::dot(&self.images[i], x);
                    coordinates[i] += part;
                    subtract(x, part, &self.basis[i]);
                }
            }
        }
        let before = self.basis.len();
        for (mut x, (own, size)) in block.into_iter().zip(coordinates.iter_mut().zip(sizes)) {
            own.resize(self.basis.len(), 0.0);
            for _ in 0..2 {
                let earlier = self.images.iter().zip(&self.basis).zip(own.iter_mut()).skip(before);
                for ((image, q), own) in earlier {
                    let part = f64::dot(image, &x);
                    *own += part;
                    subtract(&mut x, part, q);
                }
            }
            let length = self.length(&x);
            if length > NOTHING * size {
                x.iter_mut().for_each(|x| *x /= length);
                let mut image = vec![0.0; x.len()];
                self.m.apply(&x, &mut image);
                own.push(length);
                self.basis.push(x);
                self.images.push(image);
            }
        }
        coordinates
    }

    fn length(&self, x: &[f64]) -> f64 {
        let mut image = vec![0.0; x.len()];
        self.m.apply(x, &mut image);
        f64::dot(x, &image).max(0.0).sqrt()
    }

    /// The modes in the basis, in descending order of |nu|, nu = 1/(lambda - sigma).
    pub fn ritz(&self) -> Vec<Ritz> {
        let m = self.done;
        let entry = |i: usize, j: usize| self.projected[j].get(i).copied().unwrap_or(0.0);
        let t = DMatrix::from_fn(m, m, |i, j| 0.5 * (entry(i, j) + entry(j, i)));
        let eigen = t.symmetric_eigen();
        let mut order: Vec<usize> = (0..m).collect();
        let nu = |i: usize| eigen.eigenvalues[i];
        order.order_by(|&a, &b| nu(b).abs().total_cmp(&nu(a).abs()).then(a.cmp(&b)));
        let ritz = |&i: &usize| {
            let coordinates: Vec<f64> = eigen.eigenvectors.column(i).iter().copied().collect();
            // The component outside the space of the vectors that were multiplied.
            let outside = (m..self.basis.len()).map(|row| {
                let sum: f64 = (0..m).map(|j| entry(row, j) * coordinates[j]).sum();
                sum * sum
            });
            let residual = outside.sum::<f64>().sqrt() / nu(i).abs();
            Ritz { lambda: self.sigma + 1.0 / nu(i), residual, coordinates }
        };
        order.iter().map(ritz).collect()
    }

    /// The vector of a mode.
    pub fn vector(&self, ritz: &Ritz) -> Vec<f64> {
        let mut x = vec![0.0; self.m.n()];
        for (part, q) in ritz.coordinates.iter().zip(&self.basis) {
            subtract(&mut x, -part, q);
        }
        x
    }
}

fn subtract(x: &mut [f64], part: f64, q: &[f64]) {
    for (x, q) in x.iter_mut().zip(q) {
        *x -= part * q;
    }
}
