//! Q(s) = M s^2 + C s + K as a network with complex couplings, eliminated node by node in binary64. In: the networks of
//! the three forms, s. Out: factors for solving. They only steer: results are corrected with residuals of the terms.
//! Couplings c + k/s of springs and dampers lie in a sector, so their sums do not cancel as those of the assembled
//! matrix would (compare [`crate::analysis::modes::mesh::elimination`]); the inertia m s^2 is kept separate in the
//! grounds. See docs/method/poles.md#poles-followed-from-modes.

use crate::analysis::modes::mesh::elimination::Pattern;
use crate::analysis::modes::mesh::network::Network;
use crate::kernel::complex::Complex;

/// The networks of K, M and C over one pattern, in this order.
pub struct Networks {
    pub k: Network,
    pub m: Network,
    pub c: Network,
    pub pattern: Pattern,
}

/// L and D: -L_ip = c_pi / d_p.
pub struct Factors<'a> {
    pattern: &'a Pattern,
    couplings: Vec<Complex<f64>>,
    /// 1 / d_p
    reciprocals: Vec<Complex<f64>>,
}

const NONE: u32 = u32::MAX;

impl Networks {
    /// The factors of Q(s); `None` if a pivot vanishes or a number is not finite.
    pub fn factor(&self, s: Complex<f64>) -> Option<Factors<'_>> {
        let n = self.k.n();
        let pattern = &self.pattern;
        let forms = [(&self.k, Complex::real(1.0)), (&self.m, s * s), (&self.c, s)];
        let mut grounds = vec![Complex::ZERO; n];
        for (node, &place) in pattern.place().iter().enumerate() {
            let part =
                |(form, z): &(&Network, Complex<f64>)| z.scale(form.positive[node].value - form.negative[node].value);
            grounds[place as usize] = forms.iter().map(part).fold(Complex::ZERO, |sum, part| sum + part);
        }
        let mut couplings = vec![Complex::ZERO; pattern.entries()];
        let mut reciprocals: Vec<Complex<f64>> = Vec::with_capacity(n);
        let mut sum = vec![Complex::ZERO; n];
        // For each column the entry that is needed next, and lists of the columns needed at a row.
        let mut due: Vec<usize> = (0..n).map(|column| pattern.range(column).start).collect();
        let (mut first, mut next) = (vec![NONE; n], vec![NONE; n]);
        for column in 0..n {
            let range = pattern.range(column);
            pattern.rows(range.clone()).iter().for_each(|&row| sum[row as usize] = Complex::ZERO);
            for (which, (form, z)) in forms.iter().enumerate() {
                for &(row, index) in pattern.given_entries(which, column) {
                    sum[row as usize] = sum[row as usize] + z.scale(form.couplings[index as usize].value);
                }
            }
            let mut from = std::mem::replace(&mut first[column], NONE);
            while from != NONE {
                let j = from as usize;
                from = next[j];
                let (at, end) = (due[j], pattern.range(j).end);
                let ratio = couplings[at] * reciprocals[j];
                for (&row, &c) in pattern.rows(at + 1..end).iter().zip(&couplings[at + 1..end]) {
                    sum[row as usize] = sum[row as usize] + ratio * c;
                }
                grounds[column] = grounds[column] + ratio * grounds[j];
                due[j] += 1;
                if due[j] < end {
                    let row = pattern.rows(due[j]..due[j] + 1)[0] as usize;
                    next[j] = std::mem::replace(&mut first[row], from_index(j));
                }
            }
            let mut pivot = grounds[column];
            for at in range.clone() {
                let c = sum[pattern.rows(at..at + 1)[0] as usize];
                couplings[at] = c;
                pivot = pivot + c;
            }
            if !pivot.is_finite() || pivot == Complex::ZERO {
                return None;
            }
            reciprocals.push(pivot.recip());
            if !range.is_empty() {
                let row = pattern.rows(range.start..range.start + 1)[0] as usize;
                next[column] = std::mem::replace(&mut first[row], from_index(column));
            }
        }
        Some(Factors { pattern, couplings, reciprocals })
    }
}

fn from_index(column: usize) -> u32 {
    column as u32
}

impl Factors<'_> {
    /// Q(s)^-1 b.
    pub fn solve(&self, b: &[Complex<f64>]) -> Vec<Complex<f64>> {
        let n = b.len();
        let mut x = vec![Complex::ZERO; n];
        for (node, &place) in self.pattern.place().iter().enumerate() {
            x[place as usize] = b[node];
        }
        for column in 0..n {
            let range = self.pattern.range(column);
            let scaled = x[column] * self.reciprocals[column];
            for (&row, &c) in self.pattern.rows(range.clone()).iter().zip(&self.couplings[range]) {
                x[row as usize] = x[row as usize] + c * scaled;
            }
            x[column] = scaled;
        }
        for column in (0..n).rev() {
            let range = self.pattern.range(column);
            let mut sum = Complex::ZERO;
            for (&row, &c) in self.pattern.rows(range.clone()).iter().zip(&self.couplings[range]) {
                sum = sum + c * x[row as usize];
            }
            x[column] = x[column] + sum * self.reciprocals[column];
        }
        self.pattern.place().iter().map(|&place| x[place as usize]).collect()
    }
}
