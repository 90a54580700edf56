//! Error bounds for the coefficients of a determinant of polynomials. In: the entries' coefficients, each with a bound
//! of its magnitude and a radius. Out: a radius for each coefficient: Laplace's expansion over rows with the magnitudes
//! of all products, so that nothing cancels. See docs/method/transfer.md#extrema.

/// |a| <= size for the midpoint, |a - midpoint| <= radius.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sized {
    pub size: f64,
    pub radius: f64,
}

/// Covers the rounding errors of the sums, a few thousand additions of positive numbers.
const UP: f64 = 1.0 + 1e-11;

impl Sized {
    fn is_zero(self) -> bool {
        self.size == 0.0 && self.radius == 0.0
    }

    fn times(self, other: Sized) -> Sized {
        if self.is_zero() || other.is_zero() {
            // A coefficient that no entry has stays exactly zero: a polynomial in s^2 remains one.
            return Sized::default();
        }
        let radius = self.size * other.radius + self.radius * other.size + self.radius * other.radius;
        // A number that underflows must not become zero.
        let seen = |x: f64, nothing: bool| if nothing { 0.0 } else { x.max(f64::MIN_POSITIVE) };
        let exact = self.radius == 0.0 && other.radius == 0.0;
        Sized { size: seen(self.size * other.size, self.size == 0.0 || other.size == 0.0), radius: seen(radius, exact) }
    }
}

/// Radii of the coefficients of det, by power of s.
pub fn spread(rows: &[Vec<[Sized; 3]>]) -> Vec<f64> {
    let n = rows.len();
    // For the first rows and a set of as many columns: the sum of the products over all permutations.
    let mut sums: Vec<Vec<Sized>> = vec![Vec::new(); 1 << n];
    sums[0] = vec![Sized { size: 1.0, radius: 0.0 }];
    for columns in 0..sums.len() {
        let known = std::mem::take(&mut sums[columns]);
        if columns + 1 == sums.len() {
            return known.iter().map(|sum| sum.radius * UP).collect();
        }
        let row = &rows[columns.count_ones() as usize];
        for (j, entry) in row.iter().enumerate().filter(|(j, _)| columns & (1 << j) == 0) {
            let sum = &mut sums[columns | (1 << j)];
            for (power, a) in entry.iter().enumerate().filter(|(_, a)| !a.is_zero()) {
                for (k, b) in known.iter().enumerate() {
                    if sum.len() <= k + power {
                        sum.resize(k + power + 1, Sized::default());
                    }
                    let product = a.times(*b);
                    sum[k + power].size += product.size;
                    sum[k + power].radius += product.radius;
                }
            }
        }
    }
    Vec::new()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// (2 +- 0.1)(3 +- 0.2) - (1)(5) s: the error of the constant is 2 * 0.2 + 3 * 0.1 + 0.02, that of the slope is
    /// zero.
    #[test]
    fn a_determinant_of_two_rows() {
        let of = |size, radius| Sized { size, radius };
        let (zero, one) = (of(0.0, 0.0), of(1.0, 0.0));
        let rows = [
            vec![[of(2.0, 0.1), zero, zero], [zero, of(5.0, 0.0), zero]],
            vec![[one, zero, zero], [of(3.0, 0.2), zero, zero]],
        ];
        let radii = spread(&rows);
        assert!((radii[0] - 0.72).abs() < 1e-9 && radii[0] >= 0.72, "{radii:?}");
        assert_eq!(radii[1], 0.0);
    }
}
