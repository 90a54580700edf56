//! A tree of bodies joined by positive springs, and elimination from its leaves to its root.
//!
//! Bodies with masses m_i and springs v_i to the ground; each body but the root hangs on its parent by a spring of stiffness k
//! with the stretch a x_child + b x_parent (a, b = 1, -1, or a gear's ratios). With forces f = k stretch / omega, the motion
//! at omega is a null vector of
//!
//!   [ omega M - V/omega   -A^T    ]
//!   [ -A                  omega/k ],
//!
//! whose graph, bodies and springs in turn, is the same tree. Eliminating from the leaves,
//!
//!   D_i = omega m_i - v_i/omega - sum_children b^2/E,   E = omega/k - a^2/D.
//!
//! By Sylvester's law as many D and E are positive as there are springs (between bodies) and frequencies below omega. Every
//! rounding is a relative change of one mass, spring or factor (Demmel and Gragg, LAA 185 (1993) 203).
//! Clause: spec.md 10.10.

use crate::analysis::modes::terms::{Factor, Terms};
use crate::analysis::numeric::dense::Real;
use crate::analysis::numeric::lanes::{Lane, TINY};
use crate::analysis::numeric::triple::Precise;
use crate::base::Dd;

/// A tree, its bodies numbered so that children come before their parents, those of one body next before it (postorder).
/// So what children hand to their parents waits on a stack.
#[derive(Clone, Debug)]
pub struct Forest {
    pub nodes: Vec<Node<Dd>>,
    /// The coordinate of each node.
    pub coordinates: Vec<u32>,
    /// Largest relative error of a node's numbers.
    pub uncertainty: f64,
    /// No spring to the ground anywhere: one rigid motion.
    pub floats: bool,
    /// All factors are signs: stretches are differences or sums of displacements.
    pub plain: bool,
}

/// A body, and the spring to its parent.
#[derive(Clone, Copy, Debug)]
pub struct Node<T> {
    pub mass: T,
    pub ground: T,
    /// 1 / k
    pub flexibility: T,
    /// a and b; zero for the root.
    pub own: T,
    pub parents: T,
    /// The node it hangs on; its own index for the root.
    pub parent: u32,
    /// How many hang on it.
    pub children: u32,
}

impl<T: Real> Node<T> {
    fn of(node: &Node<Dd>) -> Node<T> {
        Node {
            mass: T::of(node.mass),
            ground: T::of(node.ground),
            flexibility: T::of(node.flexibility),
            own: T::of(node.own),
            parents: T::of(node.parents),
            parent: node.parent,
            children: node.children,
        }
    }

    #[inline]
    pub fn is_root(&self) -> bool {
        // Only the root has no spring to a parent.
        self.own.hi() == 0.0
    }
}

/// A spring between two coordinates.
#[derive(Clone, Copy)]
struct Edge {
    ends: [u32; 2],
    factors: [Dd; 2],
    stiffness: Sum,
}

/// A sum of positive numbers, and of how many.
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
    /// The tree that the terms are, if they are one: each mass on one coordinate, each spring on one or two, all positive, the
    /// springs on two a spanning tree (springs side by side count as one).
    pub fn of(masses: &Terms, stiffness: &Terms, n: usize) -> Option<Forest> {
        let mut known = Known::default();
        let mut mass = vec![Sum::default(); n];
        for t in 0..masses.len() {
            let ([i], [a]) = masses.row(t) else { return None };
            known.add_square(&mut mass[*i as usize], masses.weights[t], *a)?;
        }
        let mut ground = vec![Sum::default(); n];
        let mut edges: Vec<Edge> = Vec::with_capacity(n);
        for t in 0..stiffness.len() {
            match stiffness.row(t) {
                ([i], [a]) => known.add_square(&mut ground[*i as usize], stiffness.weights[t], *a)?,
                ([i, j], [a, b]) => {
                    let mut sum = Sum::default();
                    sum.add(known.positive(stiffness.weights[t])?);
                    edges.push(Edge { ends: [*i, *j], factors: [known.factor(*a), known.factor(*b)], stiffness: sum });
                }
                _ => return None,
            }
        }
        if mass.iter().any(|m| m.terms == 0) {
            return None;
        }
        merge_parallel(&mut edges);
        let sums = mass.iter().chain(&ground).chain(edges.iter().map(|edge| &edge.stiffness));
        let most = sums.map(|sum| sum.terms).max().unwrap_or(0);
        Forest::rooted(&mass, &ground, &edges, known.uncertainty(most))
    }

    fn rooted(mass: &[Sum], ground: &[Sum], edges: &[Edge], uncertainty: f64) -> Option<Forest> {
        let n = mass.len();
        if edges.len() + 1 != n {
            return None;
        }
        let (order, up) = postorder(n, edges)?;
        let mut position = vec![0u32; n];
        order.iter().enumerate().for_each(|(at, &body)| position[body as usize] = at as u32);
        let node = |&body: &u32| {
            let i = body as usize;
            let (mass, ground) = (mass[i].value, ground[i].value);
            let (flexibility, own, parents) = (Dd::ONE, Dd::ZERO, Dd::ZERO);
            let root = Node { mass, ground, flexibility, own, parents, parent: position[i], children: 0 };
            let Some(edge) = edges.get(up[i] as usize) else { return root };
            let side = usize::from(edge.ends[1] == body);
            Node {
                flexibility: edge.stiffness.value.recip(),
                own: edge.factors[side],
                parents: edge.factors[1 - side],
                parent: position[edge.ends[1 - side] as usize],
                ..root
            }
        };
        let floats = ground.iter().all(|v| v.terms == 0);
        let plain = edges.iter().flat_map(|edge| edge.factors).all(|a| a.abs() == Dd::ONE);
        let mut nodes: Vec<Node<Dd>> = order.iter().map(node).collect();
        for i in 0..n - 1 {
            let parent = nodes[i].parent as usize;
            nodes[parent].children += 1;
        }
        Some(Forest { nodes, coordinates: order, uncertainty, floats, plain })
    }

    pub fn n(&self) -> usize {
        self.nodes.len()
    }

    /// The numbers in another precision.
    pub fn nodes_in<T: Real>(&self) -> Vec<Node<T>> {
        self.nodes.iter().map(Node::of).collect()
    }

    /// The longest way from the root, in springs, and the largest number of children.
    pub fn depth_and_breadth(&self) -> (usize, usize) {
        let mut depth = vec![0u32; self.n()];
        for (i, node) in self.nodes.iter().enumerate().rev().skip(1) {
            depth[i] = depth[node.parent as usize] + 1;
        }
        let breadth = self.nodes.iter().map(|node| node.children).max().unwrap_or(0);
        (depth.into_iter().max().unwrap_or(0) as usize, breadth as usize)
    }
}

/// The sum of the last so many of a stack, taken off it.
#[inline]
pub fn taken<T: Copy>(stack: &mut Vec<T>, count: u32, zero: T, add: impl Fn(T, T) -> T) -> T {
    let mut sum = zero;
    for _ in 0..count {
        sum = add(sum, stack.pop().expect("children come before their parent"));
    }
    sum
}

/// How many frequencies are below each of eight omegas.
///
/// D E stands in the place of E, so that b^2/E = b^2 D / (D E) is one division. Where D is zero, either sign of it gives one
/// positive number of the two.
pub fn counts(nodes: &[Node<f64>], omega: [f64; 8]) -> [i64; 8] {
    let inverse = omega.map(|omega| 1.0 / omega);
    let mut negative = [0u64; 8];
    let mut handed = Handed::new([0.0; 8]);
    for node in nodes {
        let load = handed.take(node.children);
        let mut next = [0.0; 8];
        let (own, parents) = (node.own * node.own, node.parents * node.parents);
        for lane in 0..8 {
            let d = omega[lane] * node.mass - node.ground * inverse[lane] - load[lane];
            let product = d * (omega[lane] * node.flexibility) - own;
            let product = if product == 0.0 { TINY * own } else { product };
            negative[lane] += (d.to_bits() >> 63) + ((d.to_bits() ^ product.to_bits()) >> 63);
            next[lane] = parents * d / product;
        }
        handed.give(next);
    }
    // Of all D and E as many are positive as there are springs and frequencies below; the root has no E.
    negative.map(|negative| nodes.len() as i64 - negative as i64)
}

/// D of the root, which is zero at a frequency, and its derivative, at eight omegas.
pub fn root(nodes: &[Node<f64>], omega: [f64; 8]) -> ([f64; 8], [f64; 8]) {
    let inverse = omega.map(|omega| 1.0 / omega);
    let (mut d, mut slope) = ([0.0; 8], [0.0; 8]);
    let mut handed = Handed::new([0.0; 16]);
    for node in nodes {
        let load = handed.take(node.children);
        let mut next = [0.0; 16];
        let (own, parents) = (node.own * node.own, node.parents * node.parents);
        for lane in 0..8 {
            let held = node.ground * inverse[lane];
            d[lane] = omega[lane] * node.mass - held - load[lane];
            slope[lane] = node.mass + held * inverse[lane] - load[8 + lane];
            let flexibility = omega[lane] * node.flexibility;
            let reciprocal = 1.0 / (d[lane] * flexibility - own);
            let steeper = slope[lane] * flexibility + d[lane] * node.flexibility;
            next[lane] = parents * d[lane] * reciprocal;
            next[8 + lane] = parents * (slope[lane] - d[lane] * reciprocal * steeper) * reciprocal;
        }
        handed.give(next);
    }
    (d, slope)
}

/// What nodes hand to their parents: the last one by itself, for in a chain its parent comes next, and the others on a stack.
struct Handed<const W: usize> {
    zero: [f64; W],
    last: Option<[f64; W]>,
    stack: Vec<[f64; W]>,
}

impl<const W: usize> Handed<W> {
    fn new(zero: [f64; W]) -> Handed<W> {
        Handed { zero, last: None, stack: Vec::new() }
    }

    /// The sum of what so many children handed on.
    #[inline]
    fn take(&mut self, children: u32) -> [f64; W] {
        if children == 0 {
            self.stack.extend(self.last.take());
            return self.zero;
        }
        let mut sum = self.last.take().unwrap_or(self.zero);
        for _ in 1..children {
            let more = self.stack.pop().unwrap_or(self.zero);
            sum.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
        }
        sum
    }

    #[inline]
    fn give(&mut self, next: [f64; W]) {
        self.last = Some(next);
    }
}

/// The null vectors at eight omegas, up to a residual at the root, where they are 1: D x = a f, E f = b x_parent, so that
/// x = a b x_parent / (D E).
pub fn shapes(nodes: &[Node<f64>], omega: [f64; 8], x: &mut Vec<[f64; 8]>) {
    let inverse = omega.map(|omega| 1.0 / omega);
    let mut handed = Handed::new([0.0; 8]);
    x.clear();
    x.extend(nodes.iter().map(|node| {
        let load = handed.take(node.children);
        let (mut next, mut ratio) = ([0.0; 8], [1.0; 8]);
        let (own, parents) = (node.own * node.own, node.parents * node.parents);
        for lane in 0..8 {
            let d = omega[lane] * node.mass - node.ground * inverse[lane] - load[lane];
            let product = d * (omega[lane] * node.flexibility) - own;
            let product = if product == 0.0 { TINY * own } else { product };
            ratio[lane] = node.own * node.parents / product;
            next[lane] = parents * d / product;
        }
        handed.give(next);
        ratio
    }));
    let root = nodes.len() - 1;
    x[root] = [1.0; 8];
    for (i, node) in nodes.iter().enumerate().rev().skip(1) {
        let parent = x[node.parent as usize];
        x[i].iter_mut().zip(parent).for_each(|(ratio, parent)| *ratio *= parent);
    }
}

/// A null vector up to its residual at one node.
pub struct Twisted<T> {
    pub x: Vec<T>,
    pub at: usize,
    pub residual: T,
}

/// The null vector at `omega`, up to the residual at the node where that is least beside the inertia, where it is 1. The root
/// may hardly move in a mode; this node does. `at` chooses it instead.
pub fn twisted<T: Real + Lane<Scalar = T>>(nodes: &[Node<T>], omega: T, at: Option<usize>) -> Twisted<T> {
    let (mut x, mut e) = (Vec::new(), Vec::new());
    let (root, inverse) = (nodes.len() - 1, T::ONE / omega);
    pivots(nodes, omega, &mut x, &mut e);
    let at = at.unwrap_or_else(|| least_residual(nodes, omega, &x, &e));
    // Nodes on the way from there to the root are eliminated the other way round.
    let mut way = vec![at];
    while let Some(&last) = way.last()
        && last != root
    {
        way.push(nodes[last].parent as usize);
    }
    let mut on_way = vec![false; nodes.len()];
    way.iter().for_each(|&i| on_way[i] = true);
    let mut load = vec![T::ZERO; nodes.len()];
    for (i, node) in nodes.iter().enumerate().take(root) {
        if !on_way[i] && on_way[node.parent as usize] {
            load[node.parent as usize] = load[node.parent as usize] + carried(node, e[i]);
        }
    }
    for pair in way.windows(2).rev() {
        let (child, parent) = (pair[0], pair[1]);
        x[parent] = pivot(&nodes[parent], omega, inverse, load[parent]);
        let node = &nodes[child];
        let flexibility = omega * node.flexibility;
        e[child] = (flexibility - node.parents * node.parents / x[parent]).away_from_zero(flexibility);
        load[child] = load[child] + node.own * node.own / e[child];
    }
    let residual = pivot(&nodes[at], omega, inverse, load[at]);
    x[at] = T::ONE;
    for pair in way.windows(2) {
        let (child, parent) = (pair[0], pair[1]);
        x[parent] = nodes[child].parents * (nodes[child].own * x[child] / e[child]) / x[parent];
    }
    for (i, node) in nodes.iter().enumerate().rev().filter(|(i, _)| !on_way[*i]) {
        x[i] = node.own * (node.parents * x[node.parent as usize] / e[i]) / x[i];
    }
    Twisted { x, at, residual }
}

/// The node with the least pivot, beside its inertia, if it were the root: what is left there of a null vector that is 1 there.
fn least_residual<T: Real + Lane<Scalar = T>>(nodes: &[Node<T>], omega: T, d: &[T], e: &[T]) -> usize {
    let mut whole: Vec<f64> = d.iter().map(|d| d.hi()).collect();
    let omega = omega.hi();
    for (i, node) in nodes.iter().enumerate().rev().skip(1) {
        let (own, parents) = (node.own.hi() * node.own.hi(), node.parents.hi() * node.parents.hi());
        let without = whole[node.parent as usize] + parents / e[i].hi();
        let link = omega * node.flexibility.hi() - parents / without;
        whole[i] -= own / link;
    }
    let residual = |i: usize| if whole[i].is_nan() { f64::INFINITY } else { (whole[i] / nodes[i].mass.hi()).abs() };
    (0..nodes.len()).fold(0, |best, i| if residual(i) < residual(best) { i } else { best })
}

/// D of each node and E of each spring at `omega`.
fn pivots<T: Lane>(nodes: &[Node<T::Scalar>], omega: T, d: &mut Vec<T>, e: &mut Vec<T>) {
    let (zero, one) = (T::splat(T::Scalar::ZERO), T::splat(T::Scalar::ONE));
    d.resize(nodes.len(), zero);
    e.resize(nodes.len(), one);
    let (inverse, mut stack) = (one / omega, Vec::new());
    for (node, (d, e)) in nodes.iter().zip(d.iter_mut().zip(e.iter_mut())) {
        let load = taken(&mut stack, node.children, zero, |a, b| a + b);
        *d = pivot(node, omega, inverse, load);
        if !node.is_root() {
            *e = link(node, omega, *d);
            stack.push(carried(node, *e));
        }
    }
}

#[inline]
fn pivot<T: Lane>(node: &Node<T::Scalar>, omega: T, inverse: T, load: T) -> T {
    let inertia = omega * T::splat(node.mass);
    (inertia - T::splat(node.ground) * inverse - load).away_from_zero(inertia)
}

#[inline]
fn link<T: Lane>(node: &Node<T::Scalar>, omega: T, d: T) -> T {
    let flexibility = omega * T::splat(node.flexibility);
    (flexibility - T::splat(node.own * node.own) / d).away_from_zero(flexibility)
}

#[inline]
fn carried<T: Lane>(node: &Node<T::Scalar>, e: T) -> T {
    T::splat(node.parents * node.parents) / e
}

/// Numbers taken as double-doubles, and how uncertain they are then.
#[derive(Default)]
struct Known {
    /// Of a weight, and of a factor.
    relative: [f64; 2],
}

impl Known {
    fn positive(&mut self, weight: Precise) -> Option<Dd> {
        let value = self.taken(weight, 0);
        (value.hi > 0.0).then_some(value)
    }

    fn factor(&mut self, factor: Factor) -> Dd {
        match factor {
            Factor::Other(value) => self.taken(value, 1),
            sign => sign.to_dd(),
        }
    }

    fn taken(&mut self, number: Precise, kind: usize) -> Dd {
        let (value, dropped) = number.value.split();
        let relative = (number.radius + dropped.abs()) / value.hi.abs() * (1.0 + 1e-9);
        self.relative[kind] = self.relative[kind].max(relative);
        value
    }

    /// sum += w a^2
    fn add_square(&mut self, sum: &mut Sum, weight: Precise, factor: Factor) -> Option<()> {
        let factor = self.factor(factor);
        sum.add(self.positive(weight)? * factor.square());
        Some(())
    }

    /// Relative error of any of the numbers, sums of at most so many: a weight's, a factor's twice, and the roundings of
    /// products, sums and the quotient 1 / k.
    fn uncertainty(&self, terms: u32) -> f64 {
        (self.relative[0] + 2.0 * self.relative[1] + f64::from(terms + 3) * Dd::EPSILON) * (1.0 + 1e-9)
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

/// The bodies in postorder, and for each the edge to its parent; `None` if they are not all joined.
fn postorder(n: usize, edges: &[Edge]) -> Option<(Vec<u32>, Vec<u32>)> {
    let (starts, ends) = neighbours(n, edges);
    // The end of a chain, where the low modes of a chain that is held at its beginning move most.
    let root = n as u32 - 1;
    let (mut reversed, mut up) = (Vec::with_capacity(n), vec![u32::MAX; n]);
    let mut waiting = vec![root];
    // Each body before what hangs on it, one whole branch after the other: postorder, reversed.
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

/// The edges of each body: where they start, and which.
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
