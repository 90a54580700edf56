//! The operations that the second formulation needs beyond `+ - * /` of double-doubles: sine and cosine, dense
//! elimination and the symmetric eigenvalue problem. For small sizes and without cleverness: every routine is that of a
//! textbook, so that it can be checked by reading.

use vibc::base::number::Dd;

/// Sine and cosine by Taylor's series of the angle reduced to [-pi/4, pi/4]: the remainder after 26 terms is below
/// 1e-40.
pub fn sin_cos(angle: Dd) -> (Dd, Dd) {
    let quarter_turns = (angle.hi / std::f64::consts::FRAC_PI_2).round();
    let rest = angle - Dd::PI.scale(0.5) * quarter_turns;
    let square = rest * rest;
    let (mut sine, mut cosine) = (Dd::ZERO, Dd::ZERO);
    let (mut odd, mut even) = (rest, Dd::ONE);
    for i in 1..14 {
        sine += odd;
        cosine += even;
        let n = f64::from(2 * i);
        even = -(even * square) / Dd::from(n * (n - 1.0));
        odd = -(odd * square) / Dd::from(n * (n + 1.0));
    }
    match quarter_turns.rem_euclid(4.0) as u8 {
        0 => (sine, cosine),
        1 => (cosine, -sine),
        2 => (-sine, -cosine),
        _ => (-cosine, sine),
    }
}

/// A dense matrix, row by row.
#[derive(Clone, Debug)]
pub struct Matrix {
    pub rows: usize,
    pub columns: usize,
    values: Vec<Dd>,
}

impl Matrix {
    pub fn zero(rows: usize, columns: usize) -> Matrix {
        Matrix { rows, columns, values: vec![Dd::ZERO; rows * columns] }
    }

    pub fn at(&self, i: usize, j: usize) -> Dd {
        self.values[i * self.columns + j]
    }

    pub fn at_mut(&mut self, i: usize, j: usize) -> &mut Dd {
        &mut self.values[i * self.columns + j]
    }

    pub fn transposed(&self) -> Matrix {
        let mut t = Matrix::zero(self.columns, self.rows);
        for i in 0..self.rows {
            for j in 0..self.columns {
                *t.at_mut(j, i) = self.at(i, j);
            }
        }
        t
    }

    pub fn times(&self, other: &Matrix) -> Matrix {
        let mut product = Matrix::zero(self.rows, other.columns);
        for i in 0..self.rows {
            for l in 0..self.columns {
                let factor = self.at(i, l);
                if factor.is_zero() {
                    continue;
                }
                for j in 0..other.columns {
                    *product.at_mut(i, j) += factor * other.at(l, j);
                }
            }
        }
        product
    }

    /// `self^T middle self`
    pub fn congruence(&self, middle: &Matrix) -> Matrix {
        self.transposed().times(&middle.times(self))
    }

    /// Largest absolute entry.
    pub fn largest(&self) -> f64 {
        self.values.iter().map(|value| value.hi.abs()).fold(0.0, f64::max)
    }

    fn swap_rows(&mut self, a: usize, b: usize) {
        for j in 0..self.columns {
            self.values.swap(a * self.columns + j, b * self.columns + j);
        }
    }

    fn subtract_row(&mut self, from: usize, factor: Dd, row: usize) {
        for j in 0..self.columns {
            let change = factor * self.at(row, j);
            *self.at_mut(from, j) -= change;
        }
    }
}

/// X with A X = B, by elimination with row pivoting; `None` if a pivot is below 1e-20 of its row's largest entry.
pub fn solve(mut a: Matrix, mut b: Matrix) -> Option<Matrix> {
    let n = a.rows;
    assert!(a.columns == n && b.rows == n, "a square system");
    let size: Vec<f64> = (0..n).map(|i| (0..n).map(|j| a.at(i, j).hi.abs()).fold(0.0, f64::max)).collect();
    let mut order: Vec<usize> = (0..n).collect();
    for column in 0..n {
        let weight = |row: usize| a.at(row, column).hi.abs() / size[order[row]];
        let best = (column..n).max_by(|&p, &q| weight(p).total_cmp(&weight(q)))?;
        if weight(best).is_nan() || weight(best) < 1e-20 {
            return None;
        }
        a.swap_rows(column, best);
        b.swap_rows(column, best);
        order.swap(column, best);
        for row in column + 1..n {
            let factor = a.at(row, column) / a.at(column, column);
            if !factor.is_zero() {
                a.subtract_row(row, factor, column);
                b.subtract_row(row, factor, column);
            }
        }
    }
    for column in (0..n).rev() {
        for j in 0..b.columns {
            let value = b.at(column, j) / a.at(column, column);
            *b.at_mut(column, j) = value;
        }
        for row in 0..column {
            let factor = a.at(row, column);
            b.subtract_row(row, factor, column);
        }
    }
    Some(b)
}

/// The eigenvalues of K x = lambda M x, ascending: M = L L^T, then cyclic Jacobi rotations of L^-1 K L^-T (Golub and
/// Van Loan, *Matrix Computations*, section 8.5). `None` if M is not positive definite.
pub fn eigenvalues(k: &Matrix, m: &Matrix) -> Option<Vec<Dd>> {
    let l = cholesky(m)?;
    let half = solve(l.clone(), k.clone())?;
    let mut a = solve(l, half.transposed())?;
    for _ in 0..40 {
        if !rotate_all(&mut a) {
            let mut values: Vec<Dd> = (0..a.rows).map(|i| a.at(i, i)).collect();
            values.sort_by(|x, y| x.partial_cmp(y).expect("numbers"));
            return Some(values);
        }
    }
    None
}

fn cholesky(m: &Matrix) -> Option<Matrix> {
    let n = m.rows;
    let mut l = Matrix::zero(n, n);
    for j in 0..n {
        for i in j..n {
            let mut value = m.at(i, j);
            for p in 0..j {
                value -= l.at(i, p) * l.at(j, p);
            }
            if i == j && value.hi <= 0.0 {
                return None;
            }
            *l.at_mut(i, j) = if i == j { value.sqrt() } else { value / l.at(j, j) };
        }
    }
    Some(l)
}

/// One sweep; returns whether any rotation was worthwhile: entries below 1e-30 of the largest are rounding errors.
fn rotate_all(a: &mut Matrix) -> bool {
    let n = a.rows;
    let negligible = 1e-30 * a.largest();
    let mut rotated = false;
    for p in 0..n {
        for q in p + 1..n {
            if a.at(p, q).hi.abs() > negligible {
                rotate(a, p, q);
                rotated = true;
            }
        }
    }
    rotated
}

fn rotate(a: &mut Matrix, p: usize, q: usize) {
    let theta = (a.at(q, q) - a.at(p, p)) / (a.at(p, q) * 2.0);
    let root = (theta * theta + Dd::ONE).sqrt();
    let t = if theta.hi >= 0.0 { (theta + root).recip() } else { (theta - root).recip() };
    let c = (t * t + Dd::ONE).sqrt().recip();
    let s = t * c;
    for i in 0..a.rows {
        let (x, y) = (a.at(i, p), a.at(i, q));
        *a.at_mut(i, p) = c * x - s * y;
        *a.at_mut(i, q) = s * x + c * y;
    }
    for j in 0..a.rows {
        let (x, y) = (a.at(p, j), a.at(q, j));
        *a.at_mut(p, j) = c * x - s * y;
        *a.at_mut(q, j) = s * x + c * y;
    }
    *a.at_mut(p, q) = Dd::ZERO;
    *a.at_mut(q, p) = Dd::ZERO;
}

#[test]
fn sine_and_cosine_of_two_to_thirty_digits() {
    // Decimal expansions of sin 2 and cos 2 (in the style of OEIS A049469), split into two doubles by subtracting the
    // leading one.
    let (sine, cosine) = sin_cos(Dd::from(2.0));
    let (sine_of_one, cosine_of_one) = sin_cos(Dd::ONE);
    let doubled = sine_of_one * cosine_of_one * 2.0;
    assert!((sine - doubled).abs().to_f64() < 1e-31);
    assert!((sine * sine + cosine * cosine - Dd::ONE).abs().to_f64() < 1e-31);
    assert_eq!(sine.to_f64(), 0.909_297_426_825_681_7);
}

#[test]
fn eigenvalues_of_a_chain_of_three() {
    // Three unit masses and four unit springs: 2 - sqrt 2, 2, 2 + sqrt 2.
    let mut k = Matrix::zero(3, 3);
    let mut m = Matrix::zero(3, 3);
    for i in 0..3 {
        *k.at_mut(i, i) = Dd::from(2.0);
        *m.at_mut(i, i) = Dd::ONE;
        if i > 0 {
            *k.at_mut(i, i - 1) = Dd::from(-1.0);
            *k.at_mut(i - 1, i) = Dd::from(-1.0);
        }
    }
    let root = Dd::from(2.0).sqrt();
    let found = eigenvalues(&k, &m).expect("positive definite");
    for (value, truth) in found.into_iter().zip([Dd::from(2.0) - root, Dd::from(2.0), Dd::from(2.0) + root]) {
        assert!((value - truth).abs().to_f64() < 1e-30);
    }
}
