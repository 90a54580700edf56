//! K - s M as a network: couplings between pairs of coordinates and grounds, in binary64 with bounds of their errors.
//!
//! Any symmetric matrix A is the form sum_(i<j) c_ij (x_i - x_j)^2 + sum v_i x_i^2 with c_ij = -A_ij and v_i its row
//! sums. For springs the c_ij and v_i are the springs themselves, whatever the ratio of their sizes; the shift stays
//! separate in v. In: the terms of K and of M. Out: couplings and grounds. See docs/method/modes.md#sparse-parts.

use crate::analysis::modes::terms::{Factor, Factors, Terms};
use crate::base::{rounding, up};
use crate::kernel::triple::{Precise, Triple};

/// Unit roundoff.
pub const U: f64 = rounding::UNIT;
/// Covers the roundings of sums of up to eight million bounds.
pub const UP: f64 = up::MILLIONS;

/// A matrix with more entries than this in all rows together does not count as sparse.
const MOST_PAIRS: usize = 20_000_000;

/// A number and a bound of its error.
#[derive(Clone, Copy, Debug, Default)]
pub struct Near {
    pub value: f64,
    pub error: f64,
}

impl Near {
    fn of(number: Precise) -> Near {
        let value = number.value.hi();
        Near { value, error: (number.radius + U * value.abs()) * UP }
    }

    fn times(self, other: Near) -> Near {
        let value = self.value * other.value;
        let spread = self.value.abs() * other.error + self.error * other.value.abs() + self.error * other.error;
        Near { value, error: (spread + U * value.abs()) * UP }
    }

    fn add(&mut self, other: Near) {
        self.value += other.value;
        self.error = (self.error + other.error + U * self.value.abs()) * UP;
    }
}

/// The couplings and grounds of a form. Positive and negative grounds are kept apart.
#[derive(Clone, Debug)]
pub struct Network {
    /// Pairs (i, j), i < j, ascending, each once, and their couplings -A_ij.
    pub pairs: Vec<(u32, u32)>,
    pub couplings: Vec<Near>,
    pub positive: Vec<Near>,
    pub negative: Vec<Near>,
    /// A_ii, not certified.
    pub diagonal: Vec<f64>,
}

impl Network {
    /// `None` if rows are so long that the matrix is not sparse.
    pub fn of(terms: &Terms, n: usize) -> Option<Network> {
        let pairs = |t: usize| terms.row(t).0.len().pow(2) / 2;
        if (0..terms.len()).map(pairs).sum::<usize>() > MOST_PAIRS {
            return None;
        }
        let mut entries: Vec<(u32, u32, Near)> = Vec::with_capacity(terms.len());
        let (mut positive, mut negative) = (vec![Near::default(); n], vec![Near::default(); n]);
        let mut diagonal = vec![0.0; n];
        for t in 0..terms.len() {
            let weight = Near::of(terms.weight(t));
            let (indices, factors) = terms.row(t);
            let sum = Near::of(sum(factors));
            for (at, (&i, a)) in indices.iter().zip(factors.iter()).enumerate() {
                let a = factor(a);
                let weighted = weight.times(a);
                diagonal[i.index()] += weighted.value * a.value;
                let ground = weighted.times(sum);
                match ground.value < 0.0 {
                    true => negative[i.index()].add(Near { value: -ground.value, ..ground }),
                    false => positive[i.index()].add(ground),
                }
                for (&j, b) in indices[at + 1..].iter().zip(factors.from(at + 1).iter()) {
                    let product = weighted.times(factor(b));
                    entries.push((i.min(j).0, i.max(j).0, Near { value: -product.value, ..product }));
                }
            }
        }
        entries.sort_by_key(|entry| (entry.0, entry.1));
        let mut network = Network { pairs: Vec::new(), couplings: Vec::new(), positive, negative, diagonal };
        for (i, j, coupling) in entries {
            match network.couplings.last_mut() {
                Some(last) if network.pairs.last() == Some(&(i, j)) => last.add(coupling),
                _ => {
                    network.pairs.push((i, j));
                    network.couplings.push(coupling);
                }
            }
        }
        Some(network)
    }

    pub fn n(&self) -> usize {
        self.diagonal.len()
    }

    /// Whether no coordinates are coupled.
    pub fn is_diagonal(&self) -> bool {
        self.pairs.is_empty()
    }

    /// A x in binary64.
    pub fn apply(&self, x: &[f64], y: &mut [f64]) {
        for ((y, x), d) in y.iter_mut().zip(x).zip(&self.diagonal) {
            *y = d * x;
        }
        for (&(i, j), c) in self.pairs.iter().zip(&self.couplings) {
            y[i as usize] -= c.value * x[j as usize];
            y[j as usize] -= c.value * x[i as usize];
        }
    }

    /// A network of grounds only.
    pub fn of_diagonal(diagonal: &[f64]) -> Network {
        let exact = |&value: &f64| Near { value, error: 0.0 };
        Network {
            pairs: Vec::new(),
            couplings: Vec::new(),
            positive: diagonal.iter().map(exact).collect(),
            negative: vec![Near::default(); diagonal.len()],
            diagonal: diagonal.to_vec(),
        }
    }
}

fn factor(factor: Factor) -> Near {
    match factor {
        Factor::Plus => Near { value: 1.0, error: 0.0 },
        Factor::Minus => Near { value: -1.0, error: 0.0 },
        Factor::Other(value) => Near::of(value),
    }
}

/// The sum of the factors of a row: exactly zero for a spring between two coordinates.
fn sum(factors: Factors) -> Precise {
    let (mut value, mut radius) = (Triple::ZERO, 0.0);
    for factor in factors.iter() {
        let part = factor.to_triple();
        if let Factor::Other(number) = factor {
            radius += number.radius;
        }
        if !value.is_zero() && !(value + part).is_zero() {
            radius += 2.0 * Triple::ERROR * value.hi().abs().max(part.hi().abs());
        }
        value = value + part;
    }
    // A sum that cancels to zero in three words is exact if there are two opposite factors; otherwise last bits may be
    // left.
    let exact = factors.len() == 2 && value.is_zero();
    let size: f64 = factors.iter().map(|factor| factor.to_f64().abs()).sum();
    let lost = if exact || factors.len() == 1 { 0.0 } else { 4.0 * Triple::ERROR * size };
    Precise { value, radius: radius + lost }
}
