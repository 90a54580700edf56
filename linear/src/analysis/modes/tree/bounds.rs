//! An eigenvalue of a tree with a proven bound, from an approximate vector.
//!
//! Kato and Temple's bounds for the inverse problem M x = mu K x: with rho = x^T M x / x^T K x between its neighbours' bounds
//! mu_above > mu_below (in mu),
//!
//!   rho - e^2 / (mu_above - rho) <= mu <= rho + e^2 / (rho - mu_below),   e = |K^-1 M x - rho x|_K / |x|_K,
//!
//! and e is bounded by the energy of any forces f that balance the inertia forces M x (Prager and Synge's hypercircle;
//! Thomson's principle): |K^-1 M x - rho x|_K^2 <= sum (f - rho k b)^2 / k, b the stretches. In a tree such forces are
//! computed from the leaves to the root; a remainder r that rounding leaves unbalanced adds |r|_(M^-1) /
//! sqrt(lambda_1). In this norm, errors in soft and in stiff directions have equal weight, so vectors of working
//! precision suffice. A coupling c of M along a spring adds a force -c b in it.
//!
//! Underflow: a node's numbers lie within 2^100 of one ([`LARGEST`](super::forest::LARGEST)), an eigenvalue within
//! 2^250, and one x is 1, so x^T M x >= 2^-120. Then the error of a product is at most 2^-800 besides its relative
//! error, and squares below the normal range change a root of a sum over at most 2^24 nodes by less than 2^-460: that
//! much is added to both roots.
//!
//! A tree without ground is held by springs tau M to the ground, which add tau to every eigenvalue.
//! See docs/method/modes.md#large-trees.

use crate::analysis::modes::mesh::close::CLOSE;
use crate::analysis::modes::tree::forest::{Forest, Node};
use crate::analysis::modes::tree::impedance::pop_sum;
use crate::analysis::modes::tree::lanes::Lanes;
use crate::base::{Dd, Power, up};
use crate::kernel::pairwise::PairwiseSum;
use crate::kernel::real::Float;
use crate::kernel::simd::each;
use crate::kernel::triple::Triple;
use std::array::from_fn;

/// Properties of a tree that the bounds need.
#[derive(Clone, Copy, Debug)]
pub struct Tree {
    /// The most children of a node.
    pub breadth: f64,
    /// kappa: see [`Forest`].
    pub coupled: f64,
    /// Relative error of an eigenvalue due to the error of the tree's numbers, in binary64 and in double-double.
    data: [f64; 2],
}

impl Tree {
    pub fn of(forest: &Forest) -> Tree {
        let (_, breadth) = forest.depth_and_breadth();
        let data = [f64::ERROR, Dd::ERROR].map(|error| forest.eigenvalue_sensitivity(forest.uncertainty + 4.0 * error));
        Tree { breadth: breadth as f64, coupled: forest.coupled, data }
    }

    fn data<T: Float>(&self) -> f64 {
        self.data[usize::from(T::ERROR < f64::ERROR)]
    }
}

/// Bounds of the neighbouring eigenvalues, without tau; tau; and a lower bound of the least eigenvalue, with tau.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    pub previous: Option<f64>,
    pub next: Option<f64>,
    pub holding: f64,
    pub least: f64,
}

impl Frame {
    /// Whether a neighbour is so close that vectors of working precision mix the two modes.
    pub fn is_close(&self, lambda: f64) -> bool {
        let near = |other: f64| (other - lambda).abs() <= CLOSE * lambda;
        self.previous.is_some_and(near) || self.next.is_some_and(near)
    }
}

/// An eigenvalue with its radius, and 1 / sqrt(x^T M x).
pub struct Enclosed {
    pub lambda: Triple,
    pub radius: f64,
    pub scale: Dd,
}

impl Enclosed {
    pub fn relative(&self) -> f64 {
        let relative = self.radius / self.lambda.hi().abs();
        if relative.is_nan() { f64::INFINITY } else { relative }
    }
}

/// Covers the few roundings of a radius computed in binary64, sums in pairs.
const UP: f64 = up::THOUSANDS;
/// Powers of two of the module's text.
const LEAST_INERTIA: f64 = 1.0 / (1u128 << 120) as f64;
const LARGEST_EIGENVALUE: f64 = (1u128 << 125) as f64 * (1u128 << 125) as f64;
const UNDERFLOW: f64 = 1e-138;
const MOST_NODES: usize = 1 << 24;

/// The eigenvalues near the Rayleigh quotients of vectors side by side, with as many frames of one tree; see the module.
pub fn enclose_lanes<T: Float, const W: usize>(
    nodes: &[Node<T>],
    x: &[[T; W]],
    tree: &Tree,
    frames: &[Frame; W],
) -> [Enclosed; W] {
    let energies = Energies::of(nodes, x);
    let (held, inertia) = (energies.strain.total(), energies.inertia.total());
    let holding = T::of_dd(Dd::from(frames[0].holding));
    let strain = held + inertia * holding;
    let mu = Lanes(each(|lane| inertia.0[lane] / strain.0[lane]));
    let residual = residual(nodes, x, mu, holding, tree);
    // If parts of M have both signs, their errors are relative to kappa x^T M x.
    let sums = energies.strain.relative_error(T::ERROR) + energies.inertia.relative_error(T::ERROR);
    // One rounding more than needed covers the underflow in the two sums.
    let rounding = tree.coupled * (sums + 13.0 * T::ERROR);
    from_fn(|lane| {
        let elastic = residual.elastic.0[lane] + UNDERFLOW;
        let error = elastic + (residual.unbalanced.0[lane] + UNDERFLOW) / frames[lane].least.sqrt();
        let in_range = |value: f64| (1.0 / LARGEST_EIGENVALUE..=LARGEST_EIGENVALUE).contains(&value);
        let quotient = (strain.0[lane] / inertia.0[lane]).to_f64();
        let sound = inertia.0[lane].to_f64() >= LEAST_INERTIA && in_range(quotient) && in_range(frames[lane].least);
        let error = if sound && nodes.len() <= MOST_NODES { error } else { f64::INFINITY };
        enclose_near(strain.0[lane], inertia.0[lane], error, rounding, tree, &frames[lane])
    })
}

/// The eigenvalue near strain / inertia, with the error of the vector in the norm of K and the rounding of the two.
fn enclose_near<T: Float>(strain: T, inertia: T, error: f64, rounding: f64, tree: &Tree, frame: &Frame) -> Enclosed {
    let shifted = strain / inertia;
    // e^2 / mu^2, all in the norm of K; the least distance of 1 / mu to its neighbours' on either side.
    let square = (error * shifted.to_f64()).power(2) / strain.to_f64() * UP;
    let value = shifted.to_f64() * (1.0 - 2.0 * rounding);
    let top = shifted.to_f64() * (1.0 + 2.0 * rounding);
    let below = frame.next.map_or(0.0, |next| square / (1.0 - top / (next + frame.holding)));
    let above = frame.previous.map_or(0.0, |previous| square / (value / (previous + frame.holding) - 1.0));
    let temple = if below >= 0.0 && above >= 0.0 { below.max(above) } else { f64::INFINITY };
    let lambda = shifted - T::of_dd(Dd::from(frame.holding));
    let relative = if temple < 0.5 { temple / (1.0 - temple) + 2.0 * rounding } else { f64::INFINITY };
    let radius = (shifted.to_f64() * (relative + T::ERROR) + lambda.to_f64().abs() * tree.data::<T>()) * UP;
    Enclosed { lambda: Triple::from(lambda.to_dd()), radius, scale: inertia.to_dd().sqrt().recip() }
}

/// x^T K x and x^T M x.
struct Energies<T, const W: usize> {
    strain: PairwiseSum<Lanes<T, W>>,
    inertia: PairwiseSum<Lanes<T, W>>,
}

impl<T: Float, const W: usize> Energies<T, W> {
    fn of(nodes: &[Node<T>], x: &[[T; W]]) -> Energies<T, W> {
        let sum = || PairwiseSum::from_zero(Lanes::all(T::ZERO));
        let mut energies = Energies { strain: sum(), inertia: sum() };
        for (node, &own) in nodes.iter().zip(x) {
            // The root's stiffness and coupling are zero.
            let (own, parent) = (Lanes(own), Lanes(x[node.parent as usize]));
            let b = own - parent;
            let (square, stretched) = (own * own, b * b);
            energies.inertia.add(square * node.mass - stretched * node.coupling);
            energies.strain.add(square * node.ground + stretched * node.stiffness);
        }
        energies
    }
}

/// Bounds of |K^-1 (M x - r) - mu x|_K and of |r|_(M^-1).
struct Residual<const W: usize> {
    elastic: Lanes<f64, W>,
    unbalanced: Lanes<f64, W>,
}

/// The forces that balance M x - mu V x from the leaves to the root, and what rounding leaves unbalanced.
fn residual<T: Float, const W: usize>(
    nodes: &[Node<T>],
    x: &[[T; W]],
    mu: Lanes<T, W>,
    holding: T,
    tree: &Tree,
) -> Residual<W> {
    let none = (Lanes::all(T::ZERO), Lanes::all(0.0));
    let mut stack: Vec<(Lanes<T, W>, Lanes<f64, W>)> = Vec::new();
    let sum = || PairwiseSum::from_zero(Lanes::<f64, W>::all(0.0));
    let (mut unbalanced, mut complementary) = (sum(), sum());
    // Each balance has a product and a sum for each child, and five roundings of its own.
    let rounding = (tree.breadth + 8.0) * T::ERROR;
    for (node, &own) in nodes.iter().zip(x) {
        let own = Lanes(own);
        let (load, size) = pop_sum(&mut stack, node.children, none, |a, b| (a.0 + b.0, a.1 + b.1));
        let inertia = own * node.mass;
        let ground = mu * (own * (node.ground + holding * node.mass));
        // The force in the spring to the parent, and that of the coupled inertia along it.
        let force = inertia - ground + load;
        let magnitude = size + inertia.sizes() + ground.sizes();
        let mut left = magnitude * rounding;
        if node.is_root() {
            left = left + force.sizes();
        }
        // M >= diag(mass) / kappa.
        unbalanced.add(left * left * (tree.coupled / node.mass.to_f64()));
        if node.is_root() {
            continue;
        }
        let b = own - Lanes(x[node.parent as usize]);
        let stiffness = node.stiffness - holding * node.coupling;
        if stiffness.to_f64() < 0.5 * node.stiffness.to_f64() {
            let unknown = Lanes::all(f64::INFINITY);
            return Residual { elastic: unknown, unbalanced: unknown };
        }
        let (elastic, inertial) = (mu * (b * stiffness), b * node.coupling);
        let slip = (force.sizes() + elastic.sizes() + inertial.sizes()) * (8.0 * T::ERROR);
        let difference = (force - inertial - elastic).sizes() + slip;
        complementary.add(difference * difference * (1.0 / stiffness.to_f64()));
        stack.push((force, force.sizes()));
    }
    let root = |sum: PairwiseSum<Lanes<f64, W>>| Lanes(sum.total().0.map(|sum| (sum * UP).sqrt() * UP));
    Residual { elastic: root(complementary), unbalanced: root(unbalanced) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chain of n unit masses, held at its first: lambda_j = 4 sin^2((2j - 1) pi / (4n + 2)), x_i = sin((2j - 1) i pi / (2n + 1)).
    fn chain(n: usize) -> Vec<Node<f64>> {
        let node = |i: usize| Node {
            mass: 1.0,
            ground: if i == 0 { 1.0 } else { 0.0 },
            stiffness: if i + 1 == n { 0.0 } else { 1.0 },
            coupling: 0.0,
            parent: (i + 1).min(n - 1) as u32,
            children: u32::from(i > 0),
        };
        (0..n).map(node).collect()
    }

    fn angle(n: usize, j: usize) -> f64 {
        (2 * j - 1) as f64 * std::f64::consts::PI / (2 * n + 1) as f64
    }

    fn truth(n: usize, j: usize) -> f64 {
        4.0 * (0.5 * angle(n, j)).sin().powi(2)
    }

    /// The j-th mode, with every second entry off by `slip`, and the last entry 1.
    fn perturbed_mode(n: usize, j: usize, slip: f64, frame: Frame) -> Enclosed {
        let last = (angle(n, j) * n as f64).sin();
        let entry = |i: usize| (angle(n, j) * (i + 1) as f64).sin() / last;
        let x: Vec<[f64; 1]> = (0..n).map(|i| [entry(i) * (1.0 + if i % 2 == 0 { slip } else { 0.0 })]).collect();
        let tree = Tree { breadth: 1.0, coupled: 1.0, data: [4.0 * f64::ERROR, 4.0 * Dd::ERROR] };
        let [found] = enclose_lanes(&chain(n), &x, &tree, &[frame]);
        found
    }

    fn frame(n: usize, j: usize) -> Frame {
        let previous = (j > 1).then(|| truth(n, j - 1) * (1.0 + 1e-6));
        Frame { previous, next: Some(truth(n, j + 1) * (1.0 - 1e-6)), holding: 0.0, least: truth(n, 1) * 0.99 }
    }

    /// The error of a quotient is the square of its vector's error, and the radius covers it.
    #[test]
    fn truth_is_enclosed_from_poor_vectors_too() {
        for slip in [0.0, 1e-7, 1e-5, 1e-3] {
            for j in 1..=3 {
                let (found, truth) = (perturbed_mode(9, j, slip, frame(9, j)), truth(9, j));
                let error = (found.lambda.hi() - truth).abs();
                assert!(error <= found.radius, "{slip:e}: {error:e} {:e}", found.radius);
                assert!(found.radius <= (1e3 * slip * slip + 1e-13) * truth, "{slip:e}: {:e}", found.radius / truth);
                assert!(slip < 1e-5 || error > 1e-3 * slip * slip * truth, "{slip:e}: {error:e}");
            }
        }
    }

    /// If a neighbour may be as close as the vector is inaccurate, nothing is reported; nor if numbers leave the range
    /// in which the bounds hold.
    #[test]
    fn without_a_gap_or_out_of_range_nothing_is_reported() {
        let here = frame(9, 2);
        let crowded = Frame { next: Some(truth(9, 2) * (1.0 + 1e-9)), ..here };
        assert_eq!(perturbed_mode(9, 2, 1e-3, crowded).relative(), f64::INFINITY);
        let close = Frame { next: Some(truth(9, 2) * (1.0 - 1e-9)), ..here };
        assert_eq!(perturbed_mode(9, 2, 1e-3, close).relative(), f64::INFINITY);
        assert_eq!(perturbed_mode(9, 2, 1e-3, Frame { least: 1e-80, ..here }).relative(), f64::INFINITY);
        let tree = Tree { breadth: 1.0, coupled: 1.0, data: [0.0; 2] };
        let small: Vec<Node<f64>> = chain(9).iter().map(|node| Node { mass: 1e-90, ..*node }).collect();
        let [found] = enclose_lanes(&small, &[[1.0]; 9], &tree, &[here]);
        assert_eq!(found.relative(), f64::INFINITY);
    }

    /// Of a vector that two modes alone make up, Temple's bound is the eigenvalue itself. With the tree held or not, from a vector of any
    /// length, beside what rounding and the tree's numbers may add: the eigenvalue is within the radius, and needs most of it.
    #[test]
    fn a_vector_of_two_modes_needs_the_whole_bound() {
        let mut least_needed = f64::INFINITY;
        for (lambda, other) in [(1.0, 3.0), (3.0, 1.0), (1.0, 1.25), (1000.0, 2.0), (0.015625, 4.0)] {
            for (holding, scale, s) in
                [(0.0, 1.0, 0.03125), (0.5, 8.0, 0.03125), (16.0, 0.25, 0.0078125), (0.0, 64.0, 0.125), (0.5, 2.0, 0.0)]
            {
                let of = |x: f64| Dd::from(x);
                let [own, beside] = [lambda, other].map(|lambda: f64| (of(lambda) + of(holding)).recip());
                let (c2, s2) = (of(1.0) - of(s * s), of(s * s));
                let inertia = (c2 * own + s2 * beside) * of(scale * scale);
                let strain = of(scale * scale);
                let error = scale * ((1.0 - s * s).sqrt() * s) * (own - beside).abs().to_f64() * (1.0 + 1e-15);
                let frame = Frame {
                    previous: (other < lambda).then_some(other),
                    next: (other > lambda).then_some(other),
                    holding,
                    least: 1e-3,
                };
                let tree = |data: f64| Tree { breadth: 1.0, coupled: 1.0, data: [data; 2] };
                let found = enclose_near(strain, inertia, error, 0.0, &tree(0.0), &frame);
                if !found.radius.is_finite() {
                    continue;
                }
                let off = (found.lambda.dd() - of(lambda)).abs().to_f64();
                assert!(off <= found.radius, "{lambda} {other} {holding} {s}: {off:e} {:e}", found.radius);
                assert!((found.scale.to_f64() * inertia.to_f64().sqrt() - 1.0).abs() < 1e-15);
                if s > 0.0 {
                    least_needed = least_needed.min(off / found.radius);
                }
                // Sums that are off by half of the quotient's rounding each, and numbers of the tree that are off.
                // Second order does not count: a ten-thousandth is left to it.
                for (rounding, data) in [(1e-7, 0.0), (0.0, if s == 0.0 { 1e-3 } else { 1e-15 })] {
                    for sides in [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]] {
                        let worse = |x: Dd, side: f64| x * of(1.0 + side * 0.4999 * rounding);
                        let (strain, inertia) = (worse(strain, sides[0]), worse(inertia, sides[1]));
                        let found = enclose_near(strain, inertia, error, rounding, &tree(data), &frame);
                        for side in [-1.0, 1.0] {
                            let off = (found.lambda.dd() - of(lambda) * (of(1.0) + of(side * data))).abs().to_f64();
                            assert!(
                                off <= found.radius,
                                "{lambda} {other} {holding} {s} {rounding}: {off:e} {:e}",
                                found.radius
                            );
                        }
                    }
                }
            }
        }
        assert!(least_needed > 0.3 && least_needed < 1.0, "{least_needed}");
    }

    /// A tree of five nodes, two of them side by side, whose root alone is held: K, and M with its couplings, by rows, of the nodes.
    fn branched_tree() -> (Vec<Node<f64>>, [[[f64; 5]; 5]; 2]) {
        let of = |mass: f64, ground: f64, stiffness: f64, coupling: f64, parent: u32, children: u32| Node {
            mass,
            ground,
            stiffness,
            coupling,
            parent,
            children,
        };
        let nodes = vec![
            of(2.0, 0.0, 7.0, 0.25, 1, 0),
            of(3.0, 0.0, 5.0, 0.5, 4, 1),
            of(1.0, 0.0, 11.0, -0.25, 3, 0),
            of(4.0, 0.0, 2.0, 0.0, 4, 1),
            of(5.0, 3.0, 0.0, 0.0, 4, 2),
        ];
        let (mut k, mut m) = ([[0.0; 5]; 5], [[0.0; 5]; 5]);
        for (i, node) in nodes.iter().enumerate() {
            k[i][i] += node.ground;
            m[i][i] += node.mass;
            let p = node.parent as usize;
            for (a, b, sign) in [(i, i, 1.0), (p, p, 1.0), (i, p, -1.0), (p, i, -1.0)] {
                k[a][b] += sign * node.stiffness;
                m[a][b] -= sign * node.coupling;
            }
        }
        (nodes, [k, m])
    }

    fn product(a: &[[f64; 5]; 5], x: [f64; 5]) -> [f64; 5] {
        a.map(|row| row.iter().zip(x).map(|(a, x)| a * x).sum())
    }

    /// By elimination without exchanges: the matrix is positive definite.
    fn solve(mut a: [[f64; 5]; 5], mut b: [f64; 5]) -> [f64; 5] {
        for i in 0..5 {
            for r in (0..5).filter(|&r| r != i) {
                let factor = a[r][i] / a[i][i];
                let own = a[i];
                a[r].iter_mut().zip(own).for_each(|(x, own)| *x -= factor * own);
                b[r] -= factor * b[i];
            }
        }
        from_fn(|i| b[i] / a[i][i])
    }

    /// Where the forces are those of the springs, which is so where nothing but the root is held and the root is in balance, the bound of
    /// K^-1 M x - mu x in the norm of K is that number itself. Elsewhere it is not below it, with what is left unbalanced at the root.
    #[test]
    fn a_residual_is_that_of_elimination() {
        let (nodes, [k, m]) = branched_tree();
        let tree = Tree { breadth: 2.0, coupled: 2.0, data: [0.0; 2] };
        let vectors = [[1.0, 2.0, -1.0, 0.5, 0.75], [-3.0, 1.0, 0.25, 2.0, 1.5], [1.0, 1.0, 1.0, 1.0, 1.0]];
        for x in vectors {
            let momentum = product(&m, x);
            let balance = momentum.iter().sum::<f64>() / (nodes[4].ground * x[4]);
            for (mu, holding) in [(balance, 0.0), (0.25, 0.0), (1.5, 0.0), (balance, 0.125), (0.5, 2.0)] {
                let held: [[f64; 5]; 5] = from_fn(|i| from_fn(|j| k[i][j] + holding * m[i][j]));
                // M - mu K, and what it moves.
                let forces = product(&held, x);
                let rest = from_fn(|i| momentum[i] - mu * forces[i]);
                let moved = solve(held, rest);
                let truth = moved.iter().zip(rest).map(|(u, f)| u * f).sum::<f64>().sqrt();
                let lanes: Vec<[f64; 2]> = x.iter().map(|&x| [x, 2.0 * x]).collect();
                let found = residual(&nodes, &lanes, Lanes([mu, mu]), holding, &tree);
                // lambda >= 1 / (trace of K^-1 M)
                let trace: f64 = (0..5).map(|j| solve(held, from_fn(|i| m[i][j]))[j]).sum();
                let bound = found.elastic.0[0] + found.unbalanced.0[0] * trace.sqrt();
                assert!(bound >= truth * (1.0 - 1e-12), "{x:?} {mu} {holding}: {bound} {truth}");
                let [one, two] = found.elastic.0;
                assert!((two - 2.0 * one).abs() <= 1e-9 * one, "{x:?} {mu} {holding}: {one} {two}");
                // What is left at the root, in the norm of the inverse of the masses over kappa.
                let left = if holding == 0.0 {
                    (momentum.iter().sum::<f64>() - mu * nodes[4].ground * x[4]).abs()
                } else {
                    f64::NAN
                };
                let unbalanced = left * (tree.coupled / nodes[4].mass).sqrt();
                assert!(
                    holding != 0.0 || (found.unbalanced.0[0] - unbalanced).abs() <= 1e-9 * (1.0 + unbalanced),
                    "{x:?} {mu}"
                );
                if (mu, holding) == (balance, 0.0) {
                    assert!(
                        (found.elastic.0[0] / truth - 1.0).abs() < 1e-11,
                        "{x:?}: {found:?} {truth}",
                        found = found.elastic.0
                    );
                }
            }
        }
        // Held so much that a coupling takes more than half of a spring.
        let found = residual(&nodes, &[[1.0]; 5], Lanes([1.0]), 8.0, &tree);
        assert_eq!((found.elastic.0, found.unbalanced.0), ([f64::INFINITY], [f64::INFINITY]));
        // What roundings leave is counted: a tree whose numbers cancel.
        let found = residual(&nodes, &[[1.0]; 5], Lanes([0.0]), 0.0, &tree);
        assert!(found.unbalanced.0[0] > 1.0);
    }

    /// Two nodes, held at the root, whose masses are coupled: both eigenvalues in closed form, from vectors that are off by much, with the
    /// tree held and not.
    #[test]
    fn eigenvalues_of_two_nodes_in_closed_form_are_enclosed() {
        let (m0, m1, c, k, g) = (2.0, 3.0, 0.5, 7.0, 5.0f64);
        let root = Node { mass: m1, ground: g, stiffness: 0.0, coupling: 0.0, parent: 1, children: 1 };
        let nodes = [Node { mass: m0, ground: 0.0, stiffness: k, coupling: c, parent: 1, children: 0 }, root];
        // det(K - lambda M), K = [k -k; -k k+g], M = [m0-c c; c m1-c]
        let (p, q, r) = ((m0 - c) * (m1 - c) - c * c, k * (m1 - c) + (k + g) * (m0 - c) + 2.0 * k * c, k * g);
        let ends = [-1.0, 1.0].map(|side: f64| (q + side * (q * q - 4.0 * p * r).sqrt()) / (2.0 * p));
        // The least eigenvalue of M over diag(m0, m1).
        let (trace, det) = ((m0 - c) / m0 + (m1 - c) / m1, p / (m0 * m1));
        let kappa = 1.0 / (0.5 * (trace - (trace * trace - 4.0 * det).sqrt()));
        let mut tightest = 0.0f64;
        for (j, lambda) in ends.into_iter().enumerate() {
            for holding in [0.0, 0.25, 2.0] {
                for slip in [0.0, 1e-5, -1e-3, 0.02] {
                    let x = [[(k + lambda * c) * (1.0 + slip)], [k - lambda * (m0 - c)]];
                    let frame = Frame {
                        previous: (j == 1).then_some(ends[0]),
                        next: (j == 0).then_some(ends[1]),
                        holding,
                        least: ends[0] + holding,
                    };
                    let tree = Tree { breadth: 1.0, coupled: kappa, data: [f64::ERROR; 2] };
                    let [found] = enclose_lanes(&nodes, &x, &tree, &[frame]);
                    let off = (found.lambda.hi() - lambda).abs();
                    assert!(off <= found.radius, "{lambda} {holding} {slip}: {off:e} {:e}", found.radius);
                    if slip.abs() > 1e-4 {
                        tightest = tightest.max(off / found.radius);
                    }
                    assert!(slip != 0.0 || found.relative() < 1e-13, "{lambda} {holding}: {:e}", found.relative());
                }
            }
        }
        assert!(tightest > 0.05, "{tightest}");
    }

    /// The same two nodes with stiffnesses in other units: what is unbalanced at the root counts by the root of the least one.
    #[test]
    fn what_is_unbalanced_counts_by_the_least_stiffness() {
        let (mut tightest, tree) = (0.0f64, Tree { breadth: 1.0, coupled: 1.0, data: [f64::ERROR; 2] });
        for exponent in [-24, -12, 0, 12, 24] {
            // K = unit [1 -1; -1 1 + g], M = 1
            let unit = 2f64.powi(exponent);
            for g in [1.0, 0.0625] {
                let node = |ground: f64, stiffness: f64, children: u32| Node {
                    mass: 1.0,
                    ground,
                    stiffness,
                    coupling: 0.0,
                    parent: 1,
                    children,
                };
                let nodes = [node(0.0, unit, 0), node(unit * g, 0.0, 1)];
                let root = (4.0 + g * g).sqrt();
                let ends = [g / (0.5 * (2.0 + g + root)), 0.5 * (2.0 + g + root)];
                for (j, lambda) in ends.into_iter().enumerate() {
                    for slip in [1e-3, -1e-3, 1e-5] {
                        let x = [[1.0], [(1.0 - lambda) * (1.0 + slip)]];
                        let frame = Frame {
                            previous: (j == 1).then_some(unit * ends[0]),
                            next: (j == 0).then_some(unit * ends[1]),
                            holding: 0.0,
                            least: unit * ends[0],
                        };
                        let [found] = enclose_lanes(&nodes, &x, &tree, &[frame]);
                        let off = (found.lambda.hi() - unit * lambda).abs();
                        assert!(off <= found.radius, "{exponent} {g} {j} {slip}: {off:e} {:e}", found.radius);
                        assert!(
                            found.relative() < 1e3 * slip * slip,
                            "{exponent} {g} {j} {slip}: {:e}",
                            found.relative()
                        );
                        tightest = tightest.max(off / found.radius);
                    }
                }
            }
        }
        assert!(tightest > 0.05, "{tightest}");
    }

    /// A node on a spring: nothing is said where x^T M x, the eigenvalue or the least one may be out of range, each by itself, and otherwise
    /// the radius has the roundings of both sums, thirteen more and kappa times all that.
    #[test]
    fn numbers_out_of_range_have_no_bound_and_others_their_roundings() {
        let enclosed = |mass: f64, ground: f64, x: f64, least: f64, coupled: f64| {
            let node = Node { mass, ground, stiffness: 0.0, coupling: 0.0, parent: 0, children: 0 };
            let frame = Frame { previous: None, next: Some(4.0 * ground / mass), holding: 0.0, least };
            let tree = Tree { breadth: 0.0, coupled, data: [0.0; 2] };
            let [found] = enclose_lanes(&[node], &[[x]], &tree, &[frame]);
            found
        };
        for coupled in [1.0, 2.0, 64.0] {
            let found = enclosed(1.0, 1.0, 1.0, 1.0, coupled);
            let of_sum = {
                let mut sum = PairwiseSum::from_zero(0.0f64);
                sum.add(1.0);
                sum.relative_error(f64::ERROR)
            };
            let least = 2.0 * coupled * (2.0 * of_sum + 13.0 * f64::ERROR);
            assert!((least..least + 1e-15).contains(&found.relative()), "{coupled}: {:e} {least:e}", found.relative());
        }
        for (mass, ground, x, least, is_sound) in [
            (1.0, 1.0, 1e-15, 1.0, true),
            (1.0, 1.0, 1e-20, 1.0, false),
            (1e-10, 1e-10, 1e-15, 1.0, false),
            (1.0, 1e-70, 1.0, 1e-70, true),
            (1.0, 1e-80, 1.0, 1.0, false),
            (1.0, 1e80, 1.0, 1.0, false),
            (1e30, 1e-50, 1.0, 1.0, false),
            (1e-30, 1e50, 1.0, 1.0, false),
            (1.0, 1.0, 1.0, 1e-8, true),
            (1.0, 1.0, 1.0, 1e-80, false),
            (1.0, 1.0, 1.0, 1e80, false),
        ] {
            let found = enclosed(mass, ground, x, least, 1.0);
            let is_known = found.relative() < f64::INFINITY;
            assert_eq!(is_known, is_sound, "{mass:e} {ground:e} {x:e} {least:e}: {:e}", found.relative());
        }
    }
}
