//! An eigenvalue of a tree from an approximate vector, with a bound that holds.
//!
//! Kato and Temple's bounds for the inverse problem M x = mu K x: with rho = x^T M x / x^T K x between its neighbours' bounds
//! mu_above > mu_below (in mu),
//!
//!   rho - e^2 / (mu_above - rho) <= mu <= rho + e^2 / (rho - mu_below),   e = |K^-1 M x - rho x|_K / |x|_K,
//!
//! and e is bounded by the energy of any forces f that balance the inertia forces M x (Prager and Synge's hypercircle;
//! Thomson's principle): |K^-1 M x - rho x|_K^2 <= sum (f - rho k b)^2 / k, b the stretches. In a tree such forces are found
//! from the leaves; what rounding leaves unbalanced, r, adds |r|_(M^-1) / sqrt(lambda_1). In this norm errors of soft and stiff
//! directions weigh alike, so vectors of working precision suffice. What M couples along a spring, c, is a force -c b in it.
//!
//! A tree without ground is held by springs tau M to the ground, which add tau to every eigenvalue.
//! Clause: spec.md 10.10.

use crate::analysis::modes::tree::beside::Beside;
use crate::analysis::modes::tree::forest::{Forest, Node};
use crate::analysis::modes::tree::impedance::taken;
use crate::analysis::numeric::dense::Real;
use crate::analysis::numeric::pairwise::PairwiseSum;
use crate::analysis::numeric::triple::Triple;
use crate::base::Dd;
use std::array::from_fn;

/// What bounds need to know of a tree.
#[derive(Clone, Copy, Debug)]
pub struct Tree {
    /// The most children of a node.
    pub breadth: f64,
    /// kappa: see [`Forest`].
    pub coupled: f64,
    /// Relative error of an eigenvalue for that of the tree's numbers in this precision.
    data: [f64; 2],
}

impl Tree {
    pub fn of(forest: &Forest) -> Tree {
        let (_, breadth) = forest.depth_and_breadth();
        let data = [f64::ERROR, Dd::ERROR].map(|error| forest.moved_by(forest.uncertainty + 4.0 * error));
        Tree { breadth: breadth as f64, coupled: forest.coupled, data }
    }

    fn data<T: Real>(&self) -> f64 {
        self.data[usize::from(T::ERROR < f64::ERROR)]
    }
}

/// Bounds of the eigenvalues next to one, without tau; tau; and a bound below of the least eigenvalue, with tau.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    pub previous: Option<f64>,
    pub next: Option<f64>,
    pub holding: f64,
    pub least: f64,
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
const UP: f64 = 1.0 + 1e-12;

/// The eigenvalues near the Rayleigh quotients of vectors side by side, with as many frames of one tree; see the module.
pub fn enclosed<T: Real, const W: usize>(
    nodes: &[Node<T>],
    x: &[[T; W]],
    tree: &Tree,
    frames: &[Frame; W],
) -> [Enclosed; W] {
    let energies = Energies::of(nodes, x);
    let (held, inertia) = (energies.strain.total(), energies.inertia.total());
    let holding = T::of(Dd::from(frames[0].holding));
    let strain = held + inertia * holding;
    let mu = Beside(from_fn(|lane| inertia.0[lane] / strain.0[lane]));
    let residual = residual(nodes, x, mu, holding, tree);
    // Parts of M of both signs err by parts of kappa x^T M x.
    let sums = energies.strain.relative_error(T::ERROR) + energies.inertia.relative_error(T::ERROR);
    let rounding = tree.coupled * (sums + 12.0 * T::ERROR);
    from_fn(|lane| {
        let elastic = residual.elastic.0[lane];
        let error = elastic + residual.unbalanced.0[lane] / frames[lane].least.sqrt();
        near(strain.0[lane], inertia.0[lane], error, rounding, tree, &frames[lane])
    })
}

/// The eigenvalue near strain / inertia, with the error of the vector in the norm of K and the rounding of the two.
fn near<T: Real>(strain: T, inertia: T, error: f64, rounding: f64, tree: &Tree, frame: &Frame) -> Enclosed {
    let shifted = strain / inertia;
    // e^2 / mu^2, all in the norm of K; the least distance of 1 / mu to its neighbours' on either side.
    let square = (error * shifted.hi()).powi(2) / strain.hi() * UP;
    let value = shifted.hi() * (1.0 - 2.0 * rounding);
    let top = shifted.hi() * (1.0 + 2.0 * rounding);
    let below = frame.next.map_or(0.0, |next| square / (1.0 - top / (next + frame.holding)));
    let above = frame.previous.map_or(0.0, |previous| square / (value / (previous + frame.holding) - 1.0));
    let temple = if below >= 0.0 && above >= 0.0 { below.max(above) } else { f64::INFINITY };
    let lambda = shifted - T::of(Dd::from(frame.holding));
    let relative = if temple < 0.5 { temple / (1.0 - temple) + 2.0 * rounding } else { f64::INFINITY };
    let radius = (shifted.hi() * (relative + T::ERROR) + lambda.hi().abs() * tree.data::<T>()) * UP;
    Enclosed { lambda: Triple::from(lambda.to_dd()), radius, scale: inertia.to_dd().sqrt().recip() }
}

/// x^T K x and x^T M x.
struct Energies<T, const W: usize> {
    strain: PairwiseSum<Beside<T, W>>,
    inertia: PairwiseSum<Beside<T, W>>,
}

impl<T: Real, const W: usize> Energies<T, W> {
    fn of(nodes: &[Node<T>], x: &[[T; W]]) -> Energies<T, W> {
        let sum = || PairwiseSum::from_zero(Beside::all(T::ZERO));
        let mut energies = Energies { strain: sum(), inertia: sum() };
        for (node, &own) in nodes.iter().zip(x) {
            // The root's stiffness and coupling are zero.
            let (own, parent) = (Beside(own), Beside(x[node.parent as usize]));
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
    elastic: Beside<f64, W>,
    unbalanced: Beside<f64, W>,
}

/// The forces that balance M x - mu V x from the leaves to the root, and what rounding leaves unbalanced.
fn residual<T: Real, const W: usize>(
    nodes: &[Node<T>],
    x: &[[T; W]],
    mu: Beside<T, W>,
    holding: T,
    tree: &Tree,
) -> Residual<W> {
    let none = (Beside::all(T::ZERO), Beside::all(0.0));
    let mut stack: Vec<(Beside<T, W>, Beside<f64, W>)> = Vec::new();
    let sum = || PairwiseSum::from_zero(Beside::<f64, W>::all(0.0));
    let (mut unbalanced, mut complementary) = (sum(), sum());
    // A balance has a product and a sum a child, and five roundings of its own.
    let rounding = (tree.breadth + 8.0) * T::ERROR;
    for (node, &own) in nodes.iter().zip(x) {
        let own = Beside(own);
        let (load, size) = taken(&mut stack, node.children, none, |a, b| (a.0 + b.0, a.1 + b.1));
        let inertia = own * node.mass;
        let ground = mu * (own * (node.ground + holding * node.mass));
        // The force in the spring to the parent, and that of the inertia along it.
        let force = inertia - ground + load;
        let magnitude = size + inertia.sizes() + ground.sizes();
        let mut left = magnitude * rounding;
        if node.is_root() {
            left = left + force.sizes();
        }
        // M >= diag(mass) / kappa.
        unbalanced.add(left * left * (tree.coupled / node.mass.hi()));
        if node.is_root() {
            continue;
        }
        let b = own - Beside(x[node.parent as usize]);
        let stiffness = node.stiffness - holding * node.coupling;
        if stiffness.hi() < 0.5 * node.stiffness.hi() {
            let unknown = Beside::all(f64::INFINITY);
            return Residual { elastic: unknown, unbalanced: unknown };
        }
        let (elastic, inertial) = (mu * (b * stiffness), b * node.coupling);
        let slip = (force.sizes() + elastic.sizes() + inertial.sizes()) * (8.0 * T::ERROR);
        let difference = (force - inertial - elastic).sizes() + slip;
        complementary.add(difference * difference * (1.0 / stiffness.hi()));
        stack.push((force, force.sizes()));
    }
    let root = |sum: PairwiseSum<Beside<f64, W>>| Beside(sum.total().0.map(|sum| (sum * UP).sqrt() * UP));
    Residual { elastic: root(complementary), unbalanced: root(unbalanced) }
}
