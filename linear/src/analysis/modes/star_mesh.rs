//! Elimination in a network of springs without subtraction.
//!
//! A network has nodes with couplings k_ij and springs v_i to the ground. Eliminating node p (star to mesh, Kron's
//! reduction, the method of Grassmann, Taksar and Heyman) with d_p = v_p + sum_j k_pj is
//!
//!   k_ij <- k_ij + k_pi k_pj / d_p,   v_i <- v_i + k_pi v_p / d_p,
//!
//! and K = L D L^T with L_ip = -k_pi / d_p. Only positive numbers are added, so every entry of L and D is correct to a
//! few units in its last place whatever the ratios of the springs; a part that is not connected to the ground ends in a
//! pivot that is exactly zero. (Alfa, Xue and Ye, Math. Comp. 71 (2002) 217.) See docs/method/modes.md#starting-modes.

use crate::analysis::modes::terms::{Factor, Terms};
use crate::kernel::dense::Matrix;
use crate::kernel::triple::Triple;

/// A network of positive springs.
#[derive(Clone, Debug)]
pub struct Network {
    /// k_ij, both triangles.
    couplings: Matrix<f64>,
    /// v_i
    ground: Vec<f64>,
}

impl Network {
    /// The network of the terms, if each row has one coordinate, or two with factors that differ only in sign.
    pub fn of(terms: &Terms, n: usize) -> Option<Network> {
        let mut network = Network { couplings: Matrix::fill_with(n, n, 0.0), ground: vec![0.0; n] };
        for t in 0..terms.len() {
            let weight = terms.weight(t).value.hi();
            let (row, factors) = terms.row(t);
            let a = factors.at(0);
            match row {
                [i] => network.ground[i.index()] += weight * a.to_f64() * a.to_f64(),
                [i, j] if weight > 0.0 && are_opposite(a, factors.at(1)) => {
                    let k = weight * a.to_f64() * a.to_f64();
                    network.couplings[(i.index(), j.index())] += k;
                    network.couplings[(j.index(), i.index())] += k;
                }
                _ => return None,
            }
        }
        network.ground.iter().all(|&v| v >= 0.0).then_some(network)
    }

    /// The columns of M^(-1/2) L D^(1/2) with nonzero pivots, in descending order of pivot relative to mass: C C^T =
    /// M^(-1/2) K M^(-1/2).
    pub fn factor(mut self, masses: &[f64]) -> Matrix<f64> {
        let n = masses.len();
        let mut left: Vec<usize> = (0..n).collect();
        let mut columns = Vec::new();
        while !left.is_empty() {
            let pivot = |i: usize| self.ground[i] + left.iter().map(|&j| self.couplings[(j, i)]).sum::<f64>();
            let pivots: Vec<f64> = left.iter().map(|&i| pivot(i)).collect();
            let rank = |at: usize| pivots[at] / masses[left[at]];
            let best = (1..left.len()).fold(0, |best, at| if rank(at) > rank(best) { at } else { best });
            let (p, d) = (left.swap_remove(best), pivots[best]);
            if d > 0.0 {
                columns.push(self.eliminate(p, d, &left, masses));
            }
        }
        Matrix::from_fn(n, columns.len(), |i, j| columns[j][i])
    }

    /// Eliminates node p and returns its column of M^(-1/2) L D^(1/2).
    fn eliminate(&mut self, p: usize, d: f64, left: &[usize], masses: &[f64]) -> Vec<f64> {
        let mut column = vec![0.0; masses.len()];
        column[p] = (d / masses[p]).sqrt();
        let neighbours: Vec<usize> = left.iter().copied().filter(|&i| self.couplings[(i, p)] > 0.0).collect();
        for &i in &neighbours {
            let ratio = self.couplings[(i, p)] / d;
            column[i] = -(ratio * d.sqrt()) / masses[i].sqrt();
            self.ground[i] += ratio * self.ground[p];
            for &j in neighbours.iter().filter(|&&j| j != i) {
                self.couplings[(j, i)] += ratio * self.couplings[(j, p)];
            }
        }
        column
    }
}

fn are_opposite(a: Factor, b: Factor) -> bool {
    let sum: Triple = a.to_triple() + b.to_triple();
    sum.is_zero()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle(ground: f64) -> Network {
        let k = |i: usize, j: usize| [[0.0, 1e8, 3.0], [1e8, 0.0, 7e-9], [3.0, 7e-9, 0.0]][i][j];
        Network { couplings: Matrix::from_fn(3, 3, k), ground: vec![ground, 0.0, 0.0] }
    }

    #[test]
    fn the_factors_multiply_to_the_matrix() {
        let masses = [1.0, 2.0, 5.0];
        let c = triangle(0.5).factor(&masses);
        let entry = |i: usize, j: usize| (0..3).map(|l| c[(i, l)] * c[(j, l)]).sum::<f64>();
        assert!((entry(0, 0) - (1e8 + 3.5)).abs() < 1e-7);
        assert!((entry(0, 1) + 1e8 / 2f64.sqrt()).abs() < 1e-7);
        assert!((entry(2, 2) - (3.0 + 7e-9) / 5.0).abs() < 1e-15);
    }

    #[test]
    fn a_floating_part_ends_in_an_exact_zero() {
        assert_eq!(triangle(0.0).factor(&[1.0; 3]).columns(), 2);
    }
}
