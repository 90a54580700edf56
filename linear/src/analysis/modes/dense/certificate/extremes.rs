//! Bounds of eigenvalues beside the roots of small pencils, one cause of an error at a time and as large as it is said to be.

use super::*;

/// K and M of a pencil whose approximate eigenvalues are `theta`, with what each entry of P and of E is known to, as size and slip.
struct Pencil {
    theta: [f64; 3],
    /// K less the diagonal matrix of theta, and M less one: the entries (0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2).
    k: [f64; 6],
    m: [f64; 6],
    p_slip: f64,
    e_slip: f64,
}

fn symmetric(of: &[f64; 6], i: usize, j: usize) -> f64 {
    match (i.min(j), i.max(j)) {
        (0, 0) => of[0],
        (1, 1) => of[1],
        (2, 2) => of[2],
        (0, 1) => of[3],
        (0, 2) => of[4],
        _ => of[5],
    }
}

impl Pencil {
    fn with_errors(&self, sign: f64) -> Reduced {
        let size = [1.0, 2.0, 0.5];
        Reduced {
            theta: self.theta.map(Dd::from).to_vec(),
            // As far from the truth as they are said to be.
            p: Matrix::from_fn(3, 3, |i, j| {
                symmetric(&self.k, i, j) - symmetric(&self.m, i, j) * self.theta[j] - sign * size[i] * self.p_slip
            }),
            e: Matrix::from_fn(3, 3, |i, j| symmetric(&self.m, i, j) - sign * size[i] * self.e_slip),
            size: size.to_vec(),
            p_slip: vec![self.p_slip; 3],
            e_slip: vec![self.e_slip; 3],
        }
    }

    /// The number of eigenvalues below `s`: the negative pivots of K - s M, in double-double.
    fn below(&self, s: Dd) -> usize {
        let mut a: Vec<Vec<Dd>> = (0..3)
            .map(|i| {
                let own = |j: usize| if i == j { Dd::ONE } else { Dd::ZERO };
                let entry = |j: usize| {
                    // (theta - s) is exact beside sums of it with what is small.
                    Dd::from(symmetric(&self.k, i, j)) - s * Dd::from(symmetric(&self.m, i, j))
                        + (Dd::from(self.theta[i]) - s) * own(j)
                };
                (0..3).map(entry).collect()
            })
            .collect();
        let mut count = 0;
        for i in 0..3 {
            count += usize::from(a[i][i].hi < 0.0);
            let own = a[i].clone();
            for row in a.iter_mut().skip(i + 1) {
                let factor = row[i] / own[i];
                row.iter_mut().zip(&own).for_each(|(x, &y)| *x -= factor * y);
            }
        }
        count
    }

    fn check(&self, which: &str, least: f64) {
        for sign in [1.0, -1.0] {
            let reduced = self.with_errors(sign);
            let radii = reduced.radii();
            let mut most = 0.0f64;
            for (i, &radius) in radii.iter().enumerate() {
                // Nothing is proved of values as close as their couplings that are in no group.
                if !radius.is_finite() {
                    assert!(reduced.theta[2].hi < 2.0, "{which} {i}");
                    continue;
                }
                // Below the roundings of the pivots, which decide where the radius is zero.
                let little = Dd::from(1e-27 * reduced.theta[2].hi);
                let at = |part: f64| {
                    self.below(reduced.theta[i] + Dd::from(part * radius) + if part < 0.0 { -little } else { little })
                };
                assert!(at(-1.0) <= i && at(1.0) > i, "{which} {sign} {i} {radius:e}: {} {}", at(-1.0), at(1.0));
                // How much of the bound is needed.
                let needed = (0..64).map(|k| f64::from(k) / 64.0).find(|&part| at(-part) <= i && at(part) > i);
                most = most.max(needed.unwrap_or(1.0));
            }
            assert!(most >= least || radii.contains(&f64::INFINITY), "{which} {sign}: {most}");
        }
    }
}

/// Residuals and masses on the diagonal and beside it, within a group of close values, with another mode beside them, and what
/// their entries are known to.
#[test]
fn radii_hold_the_eigenvalues_of_the_worst_pencils() {
    const OFF: f64 = 1.0 / (1u32 << 20) as f64;
    // Apart, two of them close below or above the third, all of them close, and one of them far.
    let spread = [
        [1.0, 4.0, 9.0],
        [1.0, 1.0 + OFF, 9.0],
        [1.0, 9.0, 9.0 + OFF],
        [1.0, 1.0 + OFF, 1.0 + 2.5 * OFF],
        [-2.0, 1.0, 1e4],
        [1e-3, 2e-3, 4.0],
        [1.0, 1.0, 1.0],
    ];
    for theta in spread {
        for entry in 0..6 {
            for off in [OFF, -OFF, 0.25 * OFF] {
                let one = |x: f64| std::array::from_fn(|k| if k == entry { x } else { 0.0 });
                let none = [0.0; 6];
                let which = format!("{theta:?} {entry} {off:e}");
                let close = theta[1] - theta[0] < 1e-2 && theta[2] - theta[1] < 1e-2;
                // A residual on the diagonal moves its eigenvalue by itself, one beside it those that are close.
                let least = if entry < 3 || close { 0.1 } else { 0.0 };
                Pencil { theta, k: one(off), m: none, p_slip: 0.0, e_slip: 0.0 }.check(&which, least);
                Pencil { theta, k: none, m: one(off * 1e-3), p_slip: 0.0, e_slip: 0.0 }.check(&which, 0.0);
                // Masses that are off and a stiffness that makes up for it at theta: P vanishes.
                let k = std::array::from_fn(|k| if k == entry && k < 3 { off * theta[k] } else { 0.0 });
                Pencil { theta, k, m: k.map(|x| if x == 0.0 { 0.0 } else { off }), p_slip: 0.0, e_slip: 0.0 }
                    .check(&which, 0.0);
                Pencil { theta, k: one(off), m: none, p_slip: OFF, e_slip: 0.0 }.check(&which, 0.0);
                Pencil { theta, k: none, m: none, p_slip: 0.0, e_slip: 1e-3 * OFF }.check(&which, 0.0);
            }
        }
    }
}
