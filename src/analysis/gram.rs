//! X^T (sum w a a^T) X from the terms, in double-double, with a bound of every entry's error.
//!
//! With b_t = a_t^T X the entry is sum_t w_t b_ti b_tj. Let w = w' + dw, b = b' + db be what is true and what was computed,
//! |dw| <= v, |db| <= r. Then, by Cauchy and Schwarz with the weights |w'|,
//!
//!   |computed - true| <= gamma S_i S_j + S_i R_j + R_i S_j + R_i R_j + D_i D_j,
//!   S_i^2 = sum |w'| b'_i^2,   R_i^2 = sum |w'| r_i^2,   D_i^2 = sum v (|b'_i| + r_i)^2,
//!
//! and gamma = (3 T + 16) 2^-106 for T terms: two products of 5u^2 and T sums of 3u^2 (see [`Dd`]), u = 2^-53.
//! Clause: spec.md, "Certificates".

use super::dense::Matrix;
use super::squares::Squares;
use crate::base::{Ball, Dd};

/// Covers the roundings of sums of up to a million non-negative binary64 numbers.
pub const SLACK: f64 = 1.0 + 1e-9;

/// A symmetric matrix with error bounds that are outer products.
#[derive(Clone, Debug)]
pub struct Gram {
    pub mid: Matrix<Dd>,
    gamma: f64,
    /// S: the root of each column's absolute energy.
    size: Vec<f64>,
    /// R: the same of the errors of the stretches.
    slip: Vec<f64>,
    /// D: the same of the uncertainty of the weights.
    doubt: Vec<f64>,
    floor: f64,
}

impl Gram {
    /// The form in the basis of the columns of `x`, taken as exact numbers.
    pub fn of(squares: &Squares, x: &Matrix<Dd>) -> Gram {
        let (terms, n) = (squares.len(), x.columns());
        let stretches = Matrix::from_fn(terms, n, |t, j| squares.stretch(t, x.column(j)));
        Gram::of_stretches(&squares.weights, &stretches)
    }

    /// The same from the stretches b = a . x themselves.
    pub fn of_stretches(weights: &[Ball], stretches: &Matrix<Ball>) -> Gram {
        let (terms, n) = (weights.len(), stretches.columns());
        let b = stretches.map(|s| s.mid);
        let weighted = Matrix::from_fn(terms, n, |t, j| weights[t].mid * b[(t, j)]);
        let mut mid = Matrix::zeros(n, n);
        for j in 0..n {
            for i in 0..=j {
                let entry = super::dense::dot(weighted.column(i), b.column(j));
                mid[(i, j)] = entry;
                mid[(j, i)] = entry;
            }
        }
        let largest = stretches.column_maximum();
        Gram {
            mid,
            gamma: (3.0 * terms as f64 + 16.0) * UNIT_SQUARED,
            size: norms(stretches, |t, s| weights[t].mid.hi.abs() * s.mid.hi * s.mid.hi),
            slip: norms(stretches, |t, s| weights[t].mid.hi.abs() * s.rad * s.rad),
            doubt: norms(stretches, |t, s| weights[t].rad * s.magnitude() * s.magnitude()),
            // Products below 2^-969 lose bits of their low parts, at most a few units of 2^-1074 each.
            floor: terms as f64 * 1e-318 * (1.0 + largest),
        }
    }

    /// A bound of the error of entry (i, j).
    #[inline]
    pub fn radius(&self, i: usize, j: usize) -> f64 {
        let (s, r, d) = (&self.size, &self.slip, &self.doubt);
        SLACK * (self.gamma * s[i] * s[j] + s[i] * r[j] + r[i] * (s[j] + r[j]) + d[i] * d[j] + self.floor)
    }

    /// An upper bound of |entry (i, j)|.
    #[inline]
    pub fn magnitude(&self, i: usize, j: usize) -> f64 {
        self.mid[(i, j)].hi.abs() * SLACK + self.radius(i, j)
    }

    /// sum |w| b^2 of column i: what the column's energy would be if nothing cancelled.
    pub fn absolute_energy(&self, i: usize) -> f64 {
        self.size[i] * self.size[i]
    }

    pub fn is_finite(&self) -> bool {
        (0..self.mid.columns())
            .all(|j| self.mid.column(j).iter().all(|x| x.is_finite()) && self.radius(j, j).is_finite())
    }
}

/// u^2 = 2^-106.
const UNIT_SQUARED: f64 = Dd::EPSILON / 16.0;

fn norms(stretches: &Matrix<Ball>, square: impl Fn(usize, Ball) -> f64) -> Vec<f64> {
    (0..stretches.columns())
        .map(|j| {
            let column = stretches.column(j);
            (column.iter().enumerate().map(|(t, &s)| square(t, s)).sum::<f64>() * SLACK).sqrt() * SLACK
        })
        .collect()
}

impl Matrix<Ball> {
    /// An upper bound of the entries.
    fn column_maximum(&self) -> f64 {
        (0..self.columns()).flat_map(|j| self.column(j)).fold(0.0, |m, s| m.max(s.magnitude()))
    }
}
