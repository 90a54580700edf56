//! Nodes whose pivots nearly cancel, postponed to the end of an elimination.
//!
//! A pivot near zero makes couplings, and their rounding errors, as large as it is small. Such nodes stay, coupled to
//! everything that is eliminated after them, and are counted last, as a dense matrix by its eigenvectors. The modes
//! below the shift determine how many are postponed, a few for each. All numbers are rounded in one direction, as in
//! [`super::elimination`]. In: stars as they are eliminated. Out: how many pivots of the postponed nodes are negative.
//! See docs/method/modes.md#sparse-parts.

use crate::analysis::modes::mesh::network::U;
use nalgebra::DMatrix;

/// The remaining form on the postponed nodes and on those still to be eliminated.
#[derive(Debug, Default)]
pub struct Postponed {
    /// -1, 0 or 1: the direction of rounding.
    side: f64,
    nodes: Vec<Node>,
}

#[derive(Debug)]
struct Node {
    /// Position in the order of elimination, followed by the couplings to later positions.
    place: usize,
    later: Vec<f64>,
    /// Couplings to nodes that were postponed earlier.
    earlier: Vec<f64>,
    grounds: [f64; 2],
}

/// More nodes than this mean that the shift is too high for this method.
const MOST: usize = 600;

impl Node {
    #[inline]
    fn to(&self, place: usize) -> f64 {
        self.later[place - self.place - 1]
    }
}

impl Postponed {
    pub fn new(side: f64) -> Postponed {
        Postponed { side, nodes: Vec::new() }
    }

    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Sums of the positive and of the negative couplings of these nodes to the one at `place`, and their number.
    pub fn couplings(&self, place: usize) -> (f64, f64, usize) {
        let (mut adds, mut takes, mut count) = (0.0, 0.0, 0);
        for node in &self.nodes {
            let c = node.to(place);
            if c > 0.0 {
                adds += c;
            } else {
                takes -= c;
            }
            count += usize::from(c != 0.0);
        }
        (adds, takes, count)
    }

    /// Postpones the node at `place` of n; `None` if there are too many.
    pub fn add(&mut self, place: usize, n: usize, rows: &[u32], couplings: &[f64], grounds: [f64; 2]) -> Option<()> {
        let mut later = vec![0.0; n - place - 1];
        for (&row, &c) in rows.iter().zip(couplings) {
            later[row as usize - place - 1] = c;
        }
        let earlier = self.nodes.iter().map(|node| node.to(place)).collect();
        self.nodes.push(Node { place, later, earlier, grounds });
        (self.nodes.len() <= MOST).then_some(())
    }

    /// Adds the contributions of the node at `place` when it is eliminated; its numbers have the relative error
    /// `error`.
    pub fn eliminate(
        &mut self,
        place: usize,
        pivot: f64,
        rows: &[u32],
        couplings: &[f64],
        grounds: [f64; 2],
        error: f64,
    ) {
        let directed = Directed { side: self.side, error };
        for p in 0..self.nodes.len() {
            let c = self.nodes[p].to(place);
            if c == 0.0 {
                continue;
            }
            let ratio = c / pivot;
            for q in 0..p {
                let part = ratio * self.nodes[q].to(place);
                directed.add(&mut self.nodes[p].earlier[q], part);
            }
            let node = &mut self.nodes[p];
            let offset = node.place + 1;
            for (&row, &c) in rows.iter().zip(couplings) {
                directed.add(&mut node.later[row as usize - offset], ratio * c);
            }
            directed.add_grounds(&mut node.grounds, ratio, grounds);
        }
    }

    /// The number of negative eigenvalues of the form on these nodes: those that cannot be distinguished from zero
    /// count as negative if rounding goes down, as positive if it goes up.
    pub fn negative(self) -> Option<usize> {
        let r = self.nodes.len();
        if r == 0 {
            return Some(0);
        }
        let own = (r + 8) as f64 * U;
        // Row by row: the couplings with the opposite sign, and the pivot of the star.
        let mut s = DMatrix::zeros(r, r);
        let mut size = vec![0.0; r];
        for (p, node) in self.nodes.iter().enumerate() {
            for (q, &c) in node.earlier.iter().enumerate() {
                (s[(p, q)], s[(q, p)]) = (-c, -c);
            }
        }
        for (p, node) in self.nodes.iter().enumerate() {
            let (mut adds, mut takes) = (node.grounds[0], node.grounds[1]);
            for q in (0..r).filter(|&q| q != p) {
                let c: f64 = -s[(p, q)];
                if c > 0.0 { adds += c } else { takes -= c }
            }
            s[(p, p)] = pivot(adds, takes, self.side, own);
            // A power of two, so that scaling does not round.
            size[p] = power_of_two(1.0 / (adds + takes).sqrt());
        }
        let scaled = DMatrix::from_fn(r, r, |i, j| size[i] * s[(i, j)] * size[j]);
        scaled.iter().all(|x| x.is_finite()).then(|| signs(&scaled, self.side))
    }
}

/// The largest power of two that is not above x.
fn power_of_two(x: f64) -> f64 {
    f64::from_bits(x.to_bits() & f64::INFINITY.to_bits())
}

/// A bound of the number of negative eigenvalues of a matrix, from above or below: with approximate eigenvectors Z, Z^T
/// S Z has as many (Sylvester), each as near to a diagonal entry as the off-diagonal part is small (Weyl); Z is regular
/// because Z^T Z is near 1.
fn signs(s: &DMatrix<f64>, side: f64) -> usize {
    let r = s.nrows();
    let z = s.clone().symmetric_eigen().eigenvectors;
    let product = s * &z;
    let t = z.tr_mul(&product);
    let gram = z.tr_mul(&z);
    // Products of r terms, twice (Higham, Accuracy and Stability, section 3.5), with |z_j| <= 1.1, which is checked
    // below.
    let largest: f64 = s.row_iter().map(|row| row.iter().map(|x| x * x).sum::<f64>()).sum::<f64>().sqrt();
    let gamma = (2 * r + 4) as f64 * U * 1.01;
    let error = gamma * largest * r as f64 * 1.3;
    let regular = (0..r).all(|i| {
        let outside: f64 = (0..r).filter(|&j| j != i).map(|j| gram[(i, j)].abs() + gamma * 1.3).sum();
        (gram[(i, i)] - 1.0).abs() + outside + gamma * 1.3 < 0.2
    });
    // |T - diag|_2 is at most its largest row sum (Weyl).
    let outside =
        |i: usize| (0..r).filter(|&j| j != i).map(|j| t[(i, j)].abs().max(t[(j, i)].abs()) + error).sum::<f64>();
    let distance = (0..r).map(|i| (outside(i) + error) * 1.01).fold(0.0, f64::max);
    match (regular, side < 0.0) {
        (true, _) => (0..r).filter(|&i| t[(i, i)] < -side * distance).count(),
        (false, true) => r,
        (false, false) => 0,
    }
}

/// The pivot of a star, rounded in one direction; its numbers have the relative error `own`.
pub fn pivot(adds: f64, takes: f64, side: f64, own: f64) -> f64 {
    let pivot = adds * (1.0 + side * own) - takes * (1.0 - side * own);
    if pivot == 0.0 { side * own * (adds + takes) } else { pivot }
}

/// Sums rounded in one direction, of parts with a relative error.
struct Directed {
    side: f64,
    error: f64,
}

impl Directed {
    #[inline]
    fn add(&self, sum: &mut f64, part: f64) {
        let next = *sum + part;
        let error = (self.error + 4.0 * U) * part.abs() + 2.0 * U * (sum.abs() + part.abs());
        *sum = next + self.side * error;
    }

    /// Adds grounds, kept as positive and negative parts; a negative ratio swaps the two.
    fn add_grounds(&self, grounds: &mut [f64; 2], ratio: f64, given: [f64; 2]) {
        let (same, other) = if ratio < 0.0 { (1, 0) } else { (0, 1) };
        self.add_side(grounds, same, ratio.abs() * given[0]);
        self.add_side(grounds, other, ratio.abs() * given[1]);
    }

    fn add_side(&self, grounds: &mut [f64; 2], which: usize, part: f64) {
        let side = if which == 0 { self.side } else { -self.side };
        let error = (self.error + 4.0 * U) * part + 2.0 * U * (grounds[which] + part);
        grounds[which] += part + side * error;
    }
}
