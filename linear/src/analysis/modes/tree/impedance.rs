//! Elimination of K - s M in a tree, from its leaves to its root.
//!
//! In the displacements of a [`Forest`](super::forest::Forest) every spring measures a difference, and
//!
//!   K - s M = sum (g_i - s r_i) x_i^2 + sum (k_i + s c_i) (x_i - x_parent)^2.
//!
//! The subtree of node i acts on it like a spring v_i to the ground (an impedance); in series with the spring e_i to
//! the parent it gives another one, q_i:
//!
//!   v_i = g_i - s r_i + sum_children q,   e_i = k_i + s c_i,   d_i = v_i + e_i,   q_i = e_i v_i / d_i.
//!
//! By Sylvester's law, as many d (v for the root) are negative as there are eigenvalues below s. A relative change of
//! q_i is equivalent to one of all numbers of the branch, so every rounding error is a relative change of the numbers
//! of the tree (compare Demmel and Gragg, LAA 185 (1993) 203). See docs/method/modes.md#large-trees.

use crate::analysis::modes::tree::forest::Node;
use crate::base::Dd;
use crate::kernel::real::Float;

/// Number of shifts that are counted at once.
pub const LANES: usize = 16;
/// A part of a number below its last bit.
const TINY: f64 = Dd::EPSILON * Dd::EPSILON;

/// The most nodes with several branches whose own part vanishes at a shift; see [`counts`].
const MOST_VANISHED: u32 = 3;

/// The number of eigenvalues below each of the shifts; `None` if numbers overflow or underflow.
///
/// No product is below the normal range: a node's spring is at least 2^-100 and a shift at least 1e-150 of the largest
/// spring over mass, so s r >= 2^-599, g - s r is zero or at least a last bit of that, 2^-652, and so v is zero or at
/// least 2^-705, whatever a branch adds; d is at most 2^125 at shifts below 1, and grows with them beyond. If g - s r
/// is exactly zero, v is the sum of the branches' contributions: a single one is passed on unchanged; several may
/// cancel to a last bit. That may happen three times along a path before v / d is below 2^-989.
pub fn counts(nodes: &[Node<f64>], shifts: [f64; LANES]) -> Option<[i64; LANES]> {
    let mut negative = [0i64; LANES];
    let mut handed = Handed::new();
    let mut v = [0.0; LANES];
    let mut vanished = [0u32; LANES];
    for node in nodes {
        let load = handed.take(node.children);
        if node.children > 1 && node.ground != 0.0 {
            for (vanished, shift) in vanished.iter_mut().zip(shifts) {
                *vanished += u32::from(node.ground == shift * node.mass);
            }
        }
        let mut next = [0.0; LANES];
        for lane in 0..LANES {
            v[lane] = node.ground - shifts[lane] * node.mass + load[lane];
            let e = node.stiffness + shifts[lane] * node.coupling;
            let d = away_from_zero(v[lane] + e, node.stiffness);
            negative[lane] += (d.to_bits() >> 63) as i64;
            next[lane] = e * (v[lane] / d);
        }
        handed.give(next);
    }
    // An infinity on the way would have become NaN here.
    let sound = v.iter().all(|v| !v.is_nan()) && vanished.iter().all(|&count| count <= MOST_VANISHED);
    sound.then_some(negative)
}

/// v of the root, which is zero at an eigenvalue, and its derivative, at eight shifts.
pub fn root(nodes: &[Node<f64>], shifts: [f64; 8]) -> ([f64; 8], [f64; 8]) {
    let (mut v, mut slope) = ([0.0; 8], [0.0; 8]);
    let mut handed = Handed::new();
    for node in nodes {
        let load = handed.take(node.children);
        let mut next = [0.0; 16];
        for lane in 0..8 {
            v[lane] = node.ground - shifts[lane] * node.mass + load[lane];
            slope[lane] = load[8 + lane] - node.mass;
            let e = node.stiffness + shifts[lane] * node.coupling;
            let d = away_from_zero(v[lane] + e, node.stiffness);
            let (own, parents) = (v[lane] / d, e / d);
            next[lane] = e * own;
            next[8 + lane] = parents * parents * slope[lane] + own * own * node.coupling;
        }
        handed.give(next);
    }
    (v, slope)
}

/// Contributions that nodes pass to their parents: the last one separately, because in a chain its parent comes next,
/// and the others on a stack.
struct Handed<const W: usize> {
    last: Option<[f64; W]>,
    stack: Vec<[f64; W]>,
}

impl<const W: usize> Handed<W> {
    fn new() -> Handed<W> {
        Handed { last: None, stack: Vec::new() }
    }

    /// The sum of the contributions of this many children.
    #[inline]
    fn take(&mut self, children: u32) -> [f64; W] {
        if children == 0 {
            self.stack.extend(self.last.take());
            return [0.0; W];
        }
        let mut sum = self.last.take().unwrap_or([0.0; W]);
        for _ in 1..children {
            let more = self.stack.pop().unwrap_or([0.0; W]);
            sum.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
        }
        sum
    }

    #[inline]
    fn give(&mut self, next: [f64; W]) {
        self.last = Some(next);
    }
}

/// Pops the last `count` values of a stack and returns their sum.
#[inline]
pub fn pop_sum<T: Copy>(stack: &mut Vec<T>, count: u32, zero: T, add: impl Fn(T, T) -> T) -> T {
    let mut sum = zero;
    for _ in 0..count {
        sum = add(sum, stack.pop().expect("children come before their parent"));
    }
    sum
}

/// The null vectors at eight shifts, up to a residual at the root, where they are 1: d_i x_i = e_i x_parent.
pub fn shapes(nodes: &[Node<f64>], shifts: [f64; 8], x: &mut Vec<[f64; 8]>) {
    let mut handed = Handed::new();
    x.clear();
    x.extend(nodes.iter().map(|node| {
        let load = handed.take(node.children);
        let (mut next, mut ratio) = ([0.0; 8], [1.0; 8]);
        for lane in 0..8 {
            let v = node.ground - shifts[lane] * node.mass + load[lane];
            let e = node.stiffness + shifts[lane] * node.coupling;
            let d = away_from_zero(v + e, node.stiffness);
            ratio[lane] = e / d;
            next[lane] = e * (v / d);
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

/// The null vector at a shift, up to the residual at the node where that is least beside the inertia, where it is 1. The root
/// may hardly move in a mode; this node does. `at` chooses it instead.
pub fn twisted_null_vector<T: Float>(nodes: &[Node<T>], shift: T, at: Option<usize>) -> Twisted<T> {
    let root = nodes.len() - 1;
    let links: Vec<T> = nodes.iter().map(|node| node.link(shift)).collect();
    let mut felt = impedances(nodes, shift, &links);
    let at = at.unwrap_or_else(|| least_residual(nodes, &felt, &links));
    // Nodes on the path from there to the root are eliminated in the reverse direction.
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
        let parent = node.parent as usize;
        if !on_way[i] && on_way[parent] {
            load[parent] = load[parent] + in_a_row(felt[i], links[i], node.stiffness).1;
        }
    }
    let mut pivots = vec![T::ONE; nodes.len()];
    for pair in way.windows(2).rev() {
        let (child, parent) = (pair[0], pair[1]);
        let v = nodes[parent].own(shift) + load[parent];
        let (d, q) = in_a_row(v, links[child], nodes[child].stiffness);
        pivots[parent] = d;
        load[child] = load[child] + q;
    }
    let residual = nodes[at].own(shift) + load[at];
    let mut x = std::mem::take(&mut felt);
    for (i, node) in nodes.iter().enumerate().filter(|(i, _)| !on_way[*i]) {
        x[i] = in_a_row(x[i], links[i], node.stiffness).0;
    }
    x[at] = T::ONE;
    for pair in way.windows(2) {
        let (child, parent) = (pair[0], pair[1]);
        x[parent] = links[child] * x[child] / pivots[parent];
    }
    for (i, node) in nodes.iter().enumerate().rev().filter(|(i, _)| !on_way[*i]) {
        x[i] = links[i] * x[node.parent as usize] / x[i];
    }
    Twisted { x, at, residual }
}

/// d and q of springs v and e in series.
#[inline]
fn in_a_row<T: Float>(v: T, e: T, stiffness: T) -> (T, T) {
    let d = v + e;
    let d = if d.to_f64() == 0.0 { T::of_dd(Dd::from(TINY)) * stiffness } else { d };
    (d, e * (v / d))
}

#[inline]
fn away_from_zero(d: f64, stiffness: f64) -> f64 {
    if d == 0.0 { TINY * stiffness } else { d }
}

/// v of each node.
fn impedances<T: Float>(nodes: &[Node<T>], shift: T, links: &[T]) -> Vec<T> {
    let mut stack = Vec::new();
    let one = |(node, &link): (&Node<T>, &T)| {
        let v = node.own(shift) + pop_sum(&mut stack, node.children, T::ZERO, |a, b| a + b);
        stack.push(in_a_row(v, link, node.stiffness).1);
        v
    };
    nodes.iter().zip(links).map(one).collect()
}

/// The node with the least v, beside its inertia, if it were the root: what is left there of a null vector that is 1 there.
fn least_residual<T: Float>(nodes: &[Node<T>], felt: &[T], links: &[T]) -> usize {
    let mut whole: Vec<f64> = felt.iter().map(|v| v.to_f64()).collect();
    for (i, node) in nodes.iter().enumerate().rev().skip(1) {
        let (link, stiffness) = (links[i].to_f64(), node.stiffness.to_f64());
        let without = whole[node.parent as usize] - in_a_row(felt[i].to_f64(), link, stiffness).1;
        whole[i] += in_a_row(without, link, stiffness).1;
    }
    let residual = |i: usize| if whole[i].is_nan() { f64::INFINITY } else { (whole[i] / nodes[i].mass.to_f64()).abs() };
    (0..nodes.len()).fold(0, |best, i| if residual(i) < residual(best) { i } else { best })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A row of nodes, the last the root: masses, springs and couplings of inertia.
    fn row(numbers: &[[f64; 3]]) -> Vec<Node<f64>> {
        let node = |(i, &[mass, stiffness, coupling]): (usize, &[f64; 3])| Node {
            mass,
            ground: if i == 0 { 5.0 } else { 0.0 },
            stiffness: if i + 1 == numbers.len() { 0.0 } else { stiffness },
            coupling: if i + 1 == numbers.len() { 0.0 } else { coupling },
            parent: (i + 1).min(numbers.len() - 1) as u32,
            children: u32::from(i > 0),
        };
        numbers.iter().enumerate().map(node).collect()
    }

    #[test]
    fn the_slope_is_the_derivative() {
        let nodes = row(&[[1.3, 7.0, 0.2], [2.1, 3.0, -0.1], [0.7, 1.0, 0.0]]);
        let (h, s) = (1e-6, 1.1);
        let (v, slope) = root(&nodes, [s; 8]);
        let (next, _) = root(&nodes, [s + h; 8]);
        assert!(((next[0] - v[0]) / h - slope[0]).abs() < 1e-4 * slope[0].abs());
    }

    #[test]
    fn null_vectors_leave_the_residual_at_their_node() {
        let nodes = row(&[[1.3, 7.0, 0.2], [2.1, 3.0, -0.1], [0.7, 1.0, 0.0]]);
        let at_root = twisted_null_vector(&nodes, 1.1, Some(2));
        assert!((at_root.residual - root(&nodes, [1.1; 8]).0[0]).abs() < 1e-14);
        for at in 0..3 {
            let Twisted { x, residual, .. } = twisted_null_vector(&nodes, 1.1, Some(at));
            let edge = |i: usize| (nodes[i].stiffness + 1.1 * nodes[i].coupling) * (x[i] - x[i + 1]);
            let own = |i: usize| (nodes[i].ground - 1.1 * nodes[i].mass) * x[i];
            let forces = [own(0) + edge(0), own(1) + edge(1) - edge(0), own(2) - edge(1)];
            for (i, force) in forces.iter().enumerate() {
                let expected = if i == at { residual } else { 0.0 };
                assert!((force - expected).abs() < 1e-13, "{forces:?}");
            }
        }
    }
}
