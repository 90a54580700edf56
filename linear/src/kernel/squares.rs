//! A symmetric matrix as a sum of signed squares, sum w a a^T, with sparse rows a: the flat form that numerical work starts
//! from. It holds more digits than the assembled matrix (see docs/method/system.md). Weights and factors may be of different
//! types: balls, words of two or three, signs.

use crate::base::{Ball, Dd};
use crate::kernel::real::Real;

/// Weights and sparse rows.
#[derive(Clone, Debug)]
pub struct Squares<W = Ball, A = W> {
    pub weights: Vec<W>,
    starts: Vec<u32>,
    indices: Vec<u32>,
    factors: Vec<A>,
}

impl<W, A> Squares<W, A> {
    /// Without terms, with room for some.
    pub fn with_capacity(terms: usize) -> Squares<W, A> {
        let mut starts = Vec::with_capacity(terms + 1);
        starts.push(0);
        Squares {
            weights: Vec::with_capacity(terms),
            starts,
            indices: Vec::with_capacity(2 * terms),
            factors: Vec::with_capacity(2 * terms),
        }
    }

    /// Adds w a a^T.
    pub fn push(&mut self, weight: W, row: impl IntoIterator<Item = (u32, A)>) {
        self.weights.push(weight);
        for (index, factor) in row {
            self.indices.push(index);
            self.factors.push(factor);
        }
        self.starts.push(self.indices.len() as u32);
    }

    /// The number of terms.
    #[inline]
    pub fn len(&self) -> usize {
        self.weights.len()
    }

    /// Whether there is none.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.weights.is_empty()
    }

    /// The row of term `t`: its coordinates and their factors.
    #[inline]
    pub fn row(&self, t: usize) -> (&[u32], &[A]) {
        let range = self.starts[t] as usize..self.starts[t + 1] as usize;
        (&self.indices[range.clone()], &self.factors[range])
    }

    /// The factors of all rows, one row behind the other.
    pub fn factors(&self) -> &[A] {
        &self.factors
    }

    /// The rows with mapped weights and factors.
    pub fn map<V, B>(&self, weight: impl FnMut(&W) -> V, factor: impl FnMut(&A) -> B) -> Squares<V, B> {
        Squares {
            weights: self.weights.iter().map(weight).collect(),
            starts: self.starts.clone(),
            indices: self.indices.clone(),
            factors: self.factors.iter().map(factor).collect(),
        }
    }
}

impl Squares<Ball> {
    /// (sum w a a^T) x
    pub fn image(&self, x: &[Ball]) -> Vec<Ball> {
        let mut image = vec![Ball::ZERO; x.len()];
        for t in 0..self.len() {
            let (indices, factors) = self.row(t);
            let stretch = indices.iter().zip(factors).fold(Ball::ZERO, |sum, (&i, &a)| sum + a * x[i as usize]);
            let tension = self.weights[t] * stretch;
            indices.iter().zip(factors).for_each(|(&i, &a)| image[i as usize] = image[i as usize] + a * tension);
        }
        image
    }

    /// a . x of term `t`, for an exactly known x: with factors of one (a spring between two bodies) the only error is
    /// that of one sum, small beside the stretch itself however small that is beside x.
    #[inline]
    pub fn stretch(&self, t: usize, x: &[Dd]) -> Ball {
        let (indices, factors) = self.row(t);
        let mut sum = Ball::ZERO;
        for (&i, &a) in indices.iter().zip(factors) {
            sum = sum + product(a, x[i as usize]);
        }
        sum
    }
}

impl<T: Real> Squares<T> {
    /// a . x of term `t`, in the numbers of the form.
    #[inline(always)]
    pub fn stretch_of(&self, t: usize, x: &[T]) -> T {
        let (indices, factors) = self.row(t);
        indices.iter().zip(factors).fold(T::ZERO, |sum, (&i, &a)| sum + by_factor(x[i as usize], a))
    }
}

/// x a. Most factors are 1 or -1 and round nothing.
#[inline(always)]
pub fn by_factor<T: Real>(x: T, a: T) -> T {
    if a == T::ONE {
        x
    } else if a == -T::ONE {
        -x
    } else {
        x * a
    }
}

/// a x. Most factors are 1 or -1 and round nothing.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_where_they_were_put() {
        let mut squares: Squares<f64, i8> = Squares::with_capacity(3);
        squares.push(2.0, [(4, 1), (7, -1)]);
        squares.push(3.0, []);
        squares.push(5.0, [(0, 1)]);
        assert_eq!(squares.len(), 3);
        assert_eq!(squares.row(0), (&[4, 7][..], &[1, -1][..]));
        assert_eq!(squares.row(1), (&[][..], &[][..]));
        assert_eq!(squares.map(|w| w * 2.0, |&a| f64::from(a)).row(2), (&[0][..], &[1.0][..]));
        assert_eq!(squares.map(|w| w * 2.0, |_| ()).weights, [4.0, 6.0, 10.0]);
    }

    /// A spring between coordinates that differ in the 25th digit.
    #[test]
    fn a_stretch_keeps_its_digits() {
        let mut squares: Squares<Ball> = Squares::with_capacity(1);
        squares.push(Ball::ONE, [(0, Ball::ONE), (1, -Ball::ONE)]);
        let x = [Dd::new(1.0, 1e-25), Dd::ONE];
        for stretch in [squares.stretch(0, &x), squares.stretch_of(0, &x.map(Ball::exact))] {
            assert!(stretch.mid == Dd::from(1e-25) && stretch.rad < 1e-54, "{stretch:?}");
        }
    }
}
