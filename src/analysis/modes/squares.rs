//! A form of the system as flat numbers: the weights and sparse rows of `sum w a a^T` as balls.
//!
//! All numerical computations start from these, so any uncertainty in the model (a root, a sine, the rounding of 0.1 to
//! a double-double) is in the balls and so in every bound.

use crate::base::{Ball, Dd};
use crate::system::Form;

/// The squares `w a a^T` of a form.
#[derive(Clone, Debug)]
pub struct Squares {
    pub weights: Vec<Ball>,
    starts: Vec<u32>,
    indices: Vec<u32>,
    values: Vec<Ball>,
}

impl Squares {
    pub fn of(form: &Form) -> Squares {
        let count = form.terms().len();
        let mut squares = Squares {
            weights: Vec::with_capacity(count),
            starts: Vec::with_capacity(count + 1),
            indices: Vec::with_capacity(2 * count),
            values: Vec::with_capacity(2 * count),
        };
        squares.starts.push(0);
        for term in form.terms() {
            squares.weights.push(term.weight.to_ball());
            for (coordinate, value) in form.row(term) {
                squares.indices.push(coordinate.0);
                squares.values.push(value.to_ball());
            }
            squares.starts.push(squares.indices.len() as u32);
        }
        squares
    }

    pub fn len(&self) -> usize {
        self.weights.len()
    }

    pub fn is_empty(&self) -> bool {
        self.weights.is_empty()
    }

    /// The row of term `t`: its coordinates and their factors.
    #[inline]
    pub fn row(&self, t: usize) -> (&[u32], &[Ball]) {
        let range = self.starts[t] as usize..self.starts[t + 1] as usize;
        (&self.indices[range.clone()], &self.values[range])
    }

    /// a . x of term `t`, for an exactly known x. With factors of one (a spring between two bodies) the only error is
    /// that of one sum, small relative to the stretch even if the stretch is small relative to x.
    #[inline]
    pub fn stretch(&self, t: usize, x: &[Dd]) -> Ball {
        let (indices, values) = self.row(t);
        let mut sum = Ball::ZERO;
        for (&i, &a) in indices.iter().zip(values) {
            sum = sum + product(a, x[i as usize]);
        }
        sum
    }

    /// Whether all weights are certainly positive.
    pub fn all_positive(&self) -> bool {
        self.weights.iter().all(Ball::is_positive)
    }

    pub fn is_finite(&self) -> bool {
        self.weights.iter().chain(&self.values).all(Ball::is_finite)
    }
}

#[inline]
fn product(a: Ball, x: Dd) -> Ball {
    if a == Ball::ONE {
        Ball::exact(x)
    } else if a == -Ball::ONE {
        Ball::exact(-x)
    } else {
        a * Ball::exact(x)
    }
}
