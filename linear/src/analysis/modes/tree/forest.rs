//! A tree of bodies joined by positive springs, prepared for elimination. In: terms. Out: nodes from the leaves to the
//! root.
//!
//! Each body but the root hangs on its parent by a spring of stiffness k with the stretch a x_child + b x_parent (a, b = 1, -1,
//! or a gear's ratios). Displacements are scaled, x = sigma x', so that all stretches are differences: from the root down,
//! sigma_child = -(b / a) sigma_parent, and k' = k (b sigma_parent)^2. Inertia may couple a body and its parent, as
//! that of a bar between them does: M = sum r_i x_i^2 - sum c_i (x_i - x_parent)^2 with r_i the row sums of M and c_i
//! the coupling of the two. A bound kappa with M >= (sum |r_i| x_i^2 + sum |c_i| (x_i - x_parent)^2) / kappa says how
//! much relative changes of these numbers change M; it is 1 if nothing is coupled.
//! See docs/method/modes.md#large-trees.

use crate::analysis::modes::terms::{Factor, Terms};
use crate::base::{Dd, up};
use crate::kernel::real::Float;
use crate::kernel::triple::{Precise, Triple};

/// A tree whose bodies are numbered so that children come before their parents, those of one body immediately before it
/// (postorder). So the contributions of children to their parents can wait on a stack.
#[derive(Clone, Debug)]
pub struct Forest {
    pub nodes: Vec<Node<Dd>>,
    /// The coordinate of each node.
    pub coordinates: Vec<u32>,
    /// sigma of each node; empty if all are one.
    pub scales: Vec<Dd>,
    /// Largest relative error of a node's numbers.
    pub uncertainty: f64,
    /// kappa
    pub coupled: f64,
    /// Whether no spring leads to the ground: then there is one rigid motion.
    pub floats: bool,
}

/// The numbers of nodes lie between the reciprocal of this and this, so that underflow changes products far less than
/// rounding does; couplings and grounds may also be zero.
pub const LARGEST: f64 = (1u128 << 100) as f64;
/// Range of the ratios of gears and levers, which are squared.
const LARGEST_RATIO: f64 = LARGEST * LARGEST * LARGEST * LARGEST;

/// Below this quotient of pivots, it or its product with a spring may have underflowed.
pub const LEAST_RATIO: f64 = 1e-250;

/// A body, and the spring to its parent.
#[derive(Clone, Copy, Debug)]
pub struct Node<T> {
    /// r
    pub mass: T,
    /// g
    pub ground: T,
    /// k; zero for the root.
    pub stiffness: T,
    /// c; zero for the root.
    pub coupling: T,
    /// The node that carries it; its own index for the root.
    pub parent: u32,
    /// Number of children.
    pub children: u32,
}

impl<T: Float> Node<T> {
    fn of(node: &Node<Dd>) -> Node<T> {
        Node {
            mass: T::of_dd(node.mass),
            ground: T::of_dd(node.ground),
            stiffness: T::of_dd(node.stiffness),
            coupling: T::of_dd(node.coupling),
            parent: node.parent,
            children: node.children,
        }
    }

    #[inline]
    pub fn is_root(&self) -> bool {
        // Only the root has no spring to a parent.
        self.stiffness.to_f64() == 0.0
    }

    /// The stiffness of the node itself at a shift: g - s r.
    #[inline]
    pub fn own(&self, shift: T) -> T {
        self.ground - shift * self.mass
    }

    /// The stiffness of its connection to the parent at a shift: k + s c.
    #[inline]
    pub fn link(&self, shift: T) -> T {
        self.stiffness + shift * self.coupling
    }
}

/// A spring between two coordinates.
#[derive(Clone, Copy)]
struct Edge {
    ends: [u32; 2],
    factors: [Dd; 2],
    stiffness: Sum,
}

/// A sum of positive numbers, and their number.
#[derive(Clone, Copy, Default)]
struct Sum {
    value: Dd,
    terms: u32,
}

impl Sum {
    fn add(&mut self, x: Dd) {
        self.value += x;
        self.terms += 1;
    }
}

impl Forest {
    /// The tree of the terms, if they form one: each spring acts on one coordinate or two, all springs are positive,
    /// those on two form a spanning tree (parallel springs count as one), and each mass acts on one coordinate or on
    /// two that a spring joins.
    pub fn of(masses: &Terms, stiffness: &Terms, n: usize) -> Option<Forest> {
        let mut known = Rounder { relative: [0.0; 2], in_range: true };
        let mut ground = vec![Sum::default(); n];
        let mut edges: Vec<Edge> = Vec::with_capacity(n);
        for t in 0..stiffness.len() {
            let (row, factors) = stiffness.row(t);
            match row {
                [i] => known.add_square(&mut ground[i.index()], stiffness.weight(t), factors.at(0))?,
                [i, j] => {
                    let [a, b] = [0, 1].map(|end| known.factor(factors.at(end)));
                    let mut sum = Sum::default();
                    sum.add(known.positive(stiffness.weight(t))?);
                    edges.push(Edge { ends: [i.0, j.0], factors: [a, b], stiffness: sum });
                }
                _ => return None,
            }
        }
        merge_parallel(&mut edges);
        let mut forest = Forest::rooted_tree(&ground, &edges, n)?;
        let mut inertia = Inertia::of(&forest);
        for t in 0..masses.len() {
            let weight = known.positive(masses.weight(t))?;
            let (row, factors) = masses.row(t);
            match row {
                [i] => {
                    let factor = known.factor(factors.at(0));
                    inertia.one(i.index(), weight * factor.square());
                }
                [i, j] => {
                    let [a, b] = [0, 1].map(|end| factors.at(end));
                    let sum = known.sum(a, b)?;
                    inertia.two([i.0, j.0], weight, [a, b].map(|factor| known.factor(factor)), sum)?;
                }
                _ => return None,
            }
        }
        let sums = ground.iter().chain(edges.iter().map(|edge| &edge.stiffness));
        let most = sums.map(|sum| sum.terms).chain(inertia.terms.iter().copied()).max().unwrap_or(0);
        forest.uncertainty = known.uncertainty(most);
        if !forest.scales.is_empty() {
            let (depth, _) = forest.depth_and_breadth();
            forest.uncertainty += 4.0 * (depth as f64 + 3.0) * (known.relative[1] + Dd::EPSILON) * up::MILLIONS;
        }
        inertia.into(&mut forest)?;
        (known.in_range && forest.is_in_range()).then_some(forest)
    }

    /// See [`LARGEST`].
    fn is_in_range(&self) -> bool {
        let within = |x: Dd| (1.0 / LARGEST..=LARGEST).contains(&x.hi.abs());
        let or_none = |x: Dd| x.is_zero() || within(x);
        let node = |node: &Node<Dd>| {
            within(node.mass) && or_none(node.ground) && or_none(node.stiffness) && or_none(node.coupling)
        };
        self.nodes.iter().all(node) && self.scales.iter().all(|scale| is_ratio(scale.hi))
    }

    /// The tree without inertia.
    fn rooted_tree(ground: &[Sum], edges: &[Edge], n: usize) -> Option<Forest> {
        if edges.len() + 1 != n {
            return None;
        }
        let (order, up) = postorder(n, edges)?;
        let mut position = vec![0u32; n];
        order.iter().enumerate().for_each(|(at, &body)| position[body as usize] = at as u32);
        let mut nodes: Vec<Node<Dd>> = Vec::with_capacity(n);
        let plain = edges.iter().all(|edge| edge.factors[0] == -edge.factors[1] && edge.factors[0].abs() == Dd::ONE);
        let mut scales = if plain { Vec::new() } else { vec![Dd::ONE; n] };
        for &body in &order {
            let (mass, coupling) = (Dd::ZERO, Dd::ZERO);
            let ground = ground[body as usize].value;
            let at = nodes.len() as u32;
            let root = Node { mass, ground, stiffness: Dd::ZERO, coupling, parent: at, children: 0 };
            let node = edges.get(up[body as usize] as usize).map_or(root, |edge| {
                let side = usize::from(edge.ends[1] == body);
                let parent = position[edge.ends[1 - side] as usize];
                Node { stiffness: edge.stiffness.value, parent, ..root }
            });
            nodes.push(node);
        }
        for i in (0..if plain { 0 } else { n }).rev() {
            let body = order[i];
            if let Some(edge) = edges.get(up[body as usize] as usize) {
                let side = usize::from(edge.ends[1] == body);
                let arm = edge.factors[1 - side] * scales[nodes[i].parent as usize];
                scales[i] = match edge.factors[side] {
                    own if own == -edge.factors[1 - side] => scales[nodes[i].parent as usize],
                    own if own.abs() == Dd::ONE => -arm * own.hi,
                    own => -arm / own,
                };
                nodes[i].stiffness = nodes[i].stiffness * arm.square();
            }
            nodes[i].ground = nodes[i].ground * scales[i].square();
        }
        let finite = |x: &Dd| x.is_finite() && !x.is_zero();
        if !scales.iter().all(finite) || nodes[..n - 1].iter().any(|node| !finite(&node.stiffness)) {
            return None;
        }
        for i in 0..n - 1 {
            let parent = nodes[i].parent as usize;
            nodes[parent].children += 1;
        }
        let floats = ground.iter().all(|v| v.terms == 0);
        Some(Forest { nodes, coordinates: order, scales, uncertainty: 0.0, coupled: 1.0, floats })
    }

    pub fn n(&self) -> usize {
        self.nodes.len()
    }

    /// The numbers in another precision.
    pub fn nodes_in<T: Float>(&self) -> Vec<Node<T>> {
        self.nodes.iter().map(Node::of).collect()
    }

    /// The longest path from the root, in springs, and the largest number of children.
    pub fn depth_and_breadth(&self) -> (usize, usize) {
        let mut depth = vec![0u32; self.n()];
        for (i, node) in self.nodes.iter().enumerate().rev().skip(1) {
            depth[i] = depth[node.parent as usize] + 1;
        }
        let breadth = self.nodes.iter().map(|node| node.children).max().unwrap_or(0);
        (depth.into_iter().max().unwrap_or(0) as usize, breadth as usize)
    }

    /// A bound of the relative change of an eigenvalue if all numbers change by at most the relative `change`, if it is
    /// small.
    pub fn eigenvalue_sensitivity(&self, change: f64) -> f64 {
        change * (1.0 + self.coupled) * 1.01
    }
}

/// Row sums and couplings of M while a tree is built.
struct Inertia {
    /// The node of each coordinate.
    place: Vec<u32>,
    scales: Vec<Dd>,
    parents: Vec<u32>,
    mass: Vec<Dd>,
    coupling: Vec<Dd>,
    /// Magnitudes of the sums, to which rounding errors are relative.
    magnitudes: Vec<[f64; 2]>,
    terms: Vec<u32>,
    is_coupled: bool,
}

impl Inertia {
    fn of(forest: &Forest) -> Inertia {
        let n = forest.n();
        let mut place = vec![0u32; n];
        forest.coordinates.iter().zip(0..).for_each(|(&coordinate, at)| place[coordinate as usize] = at);
        Inertia {
            place,
            scales: forest.scales.clone(),
            parents: forest.nodes.iter().map(|node| node.parent).collect(),
            mass: vec![Dd::ZERO; n],
            coupling: vec![Dd::ZERO; n],
            magnitudes: vec![[0.0; 2]; n],
            terms: vec![0; n],
            is_coupled: false,
        }
    }

    fn scale(&self, at: usize) -> Dd {
        self.scales.get(at).copied().unwrap_or(Dd::ONE)
    }

    /// mass x_i^2
    fn one(&mut self, i: usize, mass: Dd) {
        let at = self.place[i] as usize;
        let scale = self.scale(at);
        self.add(at, if scale == Dd::ONE { mass } else { mass * scale.square() });
    }

    fn add(&mut self, at: usize, mass: Dd) {
        self.mass[at] += mass;
        self.magnitudes[at][0] += mass.hi.abs();
        self.terms[at] += 1;
    }

    /// weight (a x_i + b x_j)^2 for two coordinates joined by a spring; `sum` is a + b, which keeps its digits if they
    /// cancel.
    fn two(&mut self, [i, j]: [u32; 2], weight: Dd, [a, b]: [Dd; 2], sum: Dd) -> Option<()> {
        let [i, j] = [i, j].map(|coordinate| self.place[coordinate as usize] as usize);
        let child = if self.parents[i] as usize == j { i } else { j };
        if self.parents[child] as usize != i + j - child {
            return None;
        }
        // Across a gear, the sum might cancel and be less accurate than its parts.
        let scale = self.scale(i);
        if scale != self.scale(j) {
            return None;
        }
        let weight = if scale == Dd::ONE { weight } else { weight * scale.square() };
        self.add(i, weight * (a * sum));
        self.add(j, weight * (b * sum));
        let coupling = weight * (a * b);
        self.coupling[child] += coupling;
        self.magnitudes[child][1] += coupling.hi.abs();
        self.is_coupled = true;
        Some(())
    }

    /// `None` if M is not positive definite by a margin.
    fn into(self, forest: &mut Forest) -> Option<()> {
        for (node, (&mass, &coupling)) in forest.nodes.iter_mut().zip(self.mass.iter().zip(&self.coupling)) {
            (node.mass, node.coupling) = (mass, coupling);
        }
        if self.mass.iter().any(|mass| mass.hi <= 0.0) {
            return None;
        }
        if self.is_coupled {
            let (depth, breadth) = forest.depth_and_breadth();
            let rounding = (depth as f64 + 1.0) * (breadth as f64 + 12.0) * f64::EPSILON;
            let holds = |&kappa: &f64| 3.0 * rounding * kappa < 1e-3 && self.exceeds(&forest.nodes, 1.0 / kappa);
            forest.coupled = 1.01 * [1.5, 3.0, 8.0, 20.0, 100.0, 1e3, 1e4].into_iter().find(holds)?;
        }
        Some(())
    }

    /// Whether M - part (sum |r_i| x_i^2 + sum |c_i| (x_i - x_parent)^2) has only positive pivots.
    fn exceeds(&self, nodes: &[Node<Dd>], part: f64) -> bool {
        let mut load = vec![0.0; nodes.len()];
        let mut positive = true;
        for (i, (node, [mass, coupling])) in nodes.iter().zip(&self.magnitudes).enumerate() {
            let v = node.mass.hi - part * mass + load[i];
            let e = -node.coupling.hi - part * coupling;
            let ratio = v / (v + e);
            positive &= v + e > 0.0 && (v == 0.0 || ratio.abs() > LEAST_RATIO);
            if !node.is_root() {
                load[node.parent as usize] += e * ratio;
            }
        }
        positive
    }
}

fn is_ratio(x: f64) -> bool {
    (1.0 / LARGEST_RATIO..=LARGEST_RATIO).contains(&x.abs())
}

/// Conversion of numbers to double-double, with the error that this causes.
struct Rounder {
    /// Largest relative errors of a weight and of a factor.
    relative: [f64; 2],
    /// Whether squares of all factors keep their low words.
    in_range: bool,
}

impl Rounder {
    fn positive(&mut self, weight: Precise) -> Option<Dd> {
        let value = self.take(weight, 0);
        (value.hi > 0.0).then_some(value)
    }

    fn factor(&mut self, factor: Factor) -> Dd {
        match factor {
            Factor::Other(value) => self.take(value, 1),
            sign => sign.to_dd(),
        }
    }

    /// a + b, to as many digits as a factor has; `None` if they cancel, but not exactly.
    fn sum(&mut self, a: Factor, b: Factor) -> Option<Dd> {
        let sum = a.to_triple() + b.to_triple();
        if sum.is_zero() {
            return Some(Dd::ZERO);
        }
        let radius = |factor: Factor| match factor {
            Factor::Other(value) => value.radius,
            _ => 0.0,
        };
        let size = a.to_f64().abs() + b.to_f64().abs();
        let number = Precise { value: sum, radius: radius(a) + radius(b) + 2.0 * Triple::ERROR * size };
        (number.radius < 1e-20 * sum.hi().abs()).then(|| self.take(number, 1))
    }

    fn take(&mut self, number: Precise, kind: usize) -> Dd {
        let (value, dropped) = number.value.split();
        let relative = (number.radius + dropped.abs()) / value.hi.abs() * up::MILLIONS;
        self.relative[kind] = self.relative[kind].max(relative);
        self.in_range &= kind == 0 || is_ratio(value.hi);
        value
    }

    /// sum += w a^2
    fn add_square(&mut self, sum: &mut Sum, weight: Precise, factor: Factor) -> Option<()> {
        let factor = self.factor(factor);
        sum.add(self.positive(weight)? * factor.square());
        Some(())
    }

    /// Relative error of any of the numbers, each a sum of at most `terms` terms: that of a weight, twice that of a
    /// factor, and the rounding errors of products and sums.
    fn uncertainty(&self, terms: u32) -> f64 {
        (self.relative[0] + 2.0 * self.relative[1] + f64::from(terms + 4) * Dd::EPSILON) * up::MILLIONS
    }
}

/// Springs between the same coordinates with the same factors become one.
fn merge_parallel(edges: &mut Vec<Edge>) {
    edges.sort_by_key(|edge| edge.ends);
    edges.dedup_by(|edge, kept| {
        let same = edge.ends == kept.ends && edge.factors == kept.factors;
        if same {
            kept.stiffness.add(edge.stiffness.value);
        }
        same
    });
}

/// The bodies in postorder, and for each the edge to its parent; `None` if they are not all connected.
fn postorder(n: usize, edges: &[Edge]) -> Option<(Vec<u32>, Vec<u32>)> {
    let (starts, ends) = neighbours(n, edges);
    // The last body: the low modes of a chain that is held at its beginning move most there.
    let root = n as u32 - 1;
    let (mut reversed, mut up) = (Vec::with_capacity(n), vec![u32::MAX; n]);
    let mut waiting = vec![root];
    // Each body before its children, one whole branch after the other: the reverse of postorder.
    while let Some(body) = waiting.pop() {
        reversed.push(body);
        for &e in &ends[starts[body as usize] as usize..starts[body as usize + 1] as usize] {
            let edge = &edges[e as usize];
            let other = edge.ends[usize::from(edge.ends[0] == body)];
            if other != root && up[other as usize] == u32::MAX {
                up[other as usize] = e;
                waiting.push(other);
            }
        }
    }
    reversed.reverse();
    (reversed.len() == n).then_some((reversed, up))
}

/// The edges of each body: the start of its range, and the edges.
fn neighbours(n: usize, edges: &[Edge]) -> (Vec<u32>, Vec<u32>) {
    let mut starts = vec![0u32; n + 1];
    edges.iter().flat_map(|edge| edge.ends).for_each(|body| starts[body as usize + 1] += 1);
    for i in 0..n {
        starts[i + 1] += starts[i];
    }
    let mut place = starts.clone();
    let mut list = vec![0u32; 2 * edges.len()];
    for (e, edge) in edges.iter().enumerate() {
        for body in edge.ends {
            list[place[body as usize] as usize] = e as u32;
            place[body as usize] += 1;
        }
    }
    (starts, list)
}
