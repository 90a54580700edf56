//! Counts of the eigenvalues below a shift by factors in floating point of many bits, with a bound of what their roundings may move. In:
//! the forms K and M. Out: how many eigenvalues lie below s, and the factors of K - s M.

use crate::base::Number;
use crate::kernel::big_float::Float;
use crate::kernel::sparse::ldl::Symmetric;
use crate::kernel::sparse::wide::WideFactors;
use crate::system::Form;
use num_bigint::BigInt;

/// A factorisation of more products than this (some 0.3 us each), or more of them in all, would take too long.
const MOST_PRODUCTS: usize = 2_000_000;
pub(super) const MOST_PRODUCTS_IN_ALL: usize = 150_000_000;
/// An error of a count is at most this power of two of its shift.
pub(super) const COUNT: i64 = -112;

/// K and M with the bounds of what a count may err by.
pub(super) struct Counts {
    pub n: usize,
    pattern: Symmetric,
    pub matrices: [Matrix; 2],
    /// M is at least two to this power.
    pub least_mass: i64,
    pub bits: u64,
    /// How many more products may be taken.
    pub left: usize,
}

/// The values of the pattern, cut to some bits.
pub(super) struct Matrix {
    values: Vec<Float>,
    /// Every part of a value lies below two to this power.
    pub size: i64,
    pub terms: usize,
    /// The largest relative uncertainty of a weight.
    pub uncertainty: f64,
    pub positive: bool,
}

/// A shift, and how many eigenvalues lie below it.
#[derive(Clone)]
pub(super) struct Point {
    pub shift: Float,
    pub below: usize,
}

impl Matrix {
    fn of(form: &Form, pattern: &Symmetric, slots: &[u32], bits: u64) -> Option<Matrix> {
        let mut matrix = Matrix {
            values: vec![Float::zero(); pattern.value_count()],
            size: i64::MIN / 4,
            terms: form.terms().len(),
            uncertainty: 0.0,
            positive: true,
        };
        let mut slots = slots.iter();
        for term in form.terms() {
            let (weight, uncertainty) = float(term.weight, bits)?;
            matrix.uncertainty = matrix.uncertainty.max(uncertainty);
            matrix.positive &= term.weight.is_positive() || term.weight.is_zero();
            let row: Option<Vec<Float>> = form
                .row(term)
                .iter()
                .map(|(_, a)| Some(float(a, bits)?).filter(|(_, uncertainty)| *uncertainty == 0.0).map(|(a, _)| a))
                .collect();
            let row = row?;
            for (at, a) in row.iter().enumerate() {
                for b in &row[at..] {
                    let product = &(&weight * a) * b;
                    let value = &mut matrix.values[*slots.next()? as usize];
                    matrix.size = matrix.size.max(product.ceiling_log2().unwrap_or(matrix.size));
                    *value = (&*value + &product).cut(bits);
                }
            }
        }
        (matrix.uncertainty == 0.0 || matrix.positive).then_some(matrix)
    }
}

/// A number to some bits, and its relative uncertainty beyond them; `None` where that is not finite.
fn float(number: &Number, bits: u64) -> Option<(Float, f64)> {
    if let Some(number) = number.exact() {
        let number = number.to_big();
        let part = |x: &BigInt| Float::from(x.clone());
        return Some((part(number.numer()).divided_by(&part(number.denom()), bits).cut(bits), 0.0));
    }
    let ball = number.to_ball();
    let uncertainty = ball.relative_error() * (1.0 + 1e-9);
    (uncertainty < 1.0).then(|| (&Float::from(ball.mid.hi) + &Float::from(ball.mid.lo), uncertainty))
}

impl Counts {
    pub fn of(k: &Form, m: &Form, n: usize, (bits, left): (u64, usize)) -> Option<Counts> {
        let rows = |form: &Form| form.terms().map(|term| form.row(term).len().pow(2)).sum::<usize>();
        if rows(k) + rows(m) > MOST_PRODUCTS {
            return None;
        }
        let mut places = Vec::new();
        let mut add = |form: &Form| {
            for term in form.terms() {
                let row = form.row(term).coordinates();
                for (at, i) in row.iter().enumerate() {
                    places.extend(row[at..].iter().map(|j| (i.0, j.0)));
                }
            }
            places.len()
        };
        let of_mass = add(m);
        add(k);
        let pattern = Symmetric::pattern(n, &places);
        if pattern.products() > MOST_PRODUCTS {
            return None;
        }
        let (first, second) = pattern.slots().split_at(of_mass);
        let matrices = [Matrix::of(k, &pattern, second, bits)?, Matrix::of(m, &pattern, first, bits)?];
        let mut counts = Counts { n, pattern, matrices, least_mass: 0, bits, left };
        counts.least_mass = counts.least_mass()?;
        Some(counts)
    }

    /// A power of two that M is not below: half of a shift of M below which a count finds no eigenvalue.
    fn least_mass(&mut self) -> Option<i64> {
        let mass = &self.matrices[1];
        let slots: Vec<usize> = self.pattern.diagonal_slots().collect();
        let least = slots.iter().map(|&slot| mass.values[slot].ceiling_log2()).min()??;
        let size = mass.size;
        [2, 8, 32, 128]
            .into_iter()
            .map(|less| least - less)
            .find(|&power| {
                let shift = Float::from(1.0).times_power_of_two(power);
                let mut values = self.matrices[1].values.clone();
                slots.iter().for_each(|&slot| values[slot] = &values[slot] - &shift);
                let factors = self.factor(&values);
                factors.is_some_and(|f| f.negative_pivots() == 0 && self.error(f.growth.max(size)) < power)
            })
            .map(|power| power - 1)
    }

    fn factor(&mut self, values: &[Float]) -> Option<WideFactors> {
        self.left = self.left.checked_sub(self.pattern.products())?;
        self.pattern.factor_wide(values, self.bits)
    }

    /// A bound of the norm of what the factors differ from their matrix by, as a power of two, for products below that power.
    fn error(&self, size: i64) -> i64 {
        let parts = 2 * (self.matrices[0].terms + self.matrices[1].terms) + self.n + 4;
        let log = |x: usize| i64::from(x.next_power_of_two().trailing_zeros());
        size + 3 - self.bits as i64 + 2 * log(parts) + log(self.n)
    }

    /// The factors of K - s M; `None` if the count of their pivots may be wrong by more than an eigenvalue's move by 2^COUNT s.
    pub fn at(&mut self, shift: &Float) -> Option<WideFactors> {
        let size = shift.ceiling_log2()?;
        let (factors, error) = self.factors_with_error(shift)?;
        (error < size - 1 + COUNT).then_some(factors)
    }

    /// The factors of K - s M, and by how much they move an eigenvalue at most, as a power of two.
    pub fn factors_with_error(&mut self, shift: &Float) -> Option<(WideFactors, i64)> {
        let [k, m] = &self.matrices;
        let values = k.values.iter().zip(&m.values).map(|(k, m)| match m.is_zero() {
            true => k.clone(),
            false => (k - &(shift * m)).cut(self.bits),
        });
        let values: Vec<Float> = values.collect();
        let given = k.size.max(m.size + shift.ceiling_log2()?);
        let factors = self.factor(&values)?;
        let error = self.error(factors.growth.max(given)) - self.least_mass;
        Some((factors, error))
    }

    pub fn point(&mut self, shift: Float) -> Option<Point> {
        let below = self.at(&shift)?.negative_pivots();
        Some(Point { shift, below })
    }

    /// M x
    pub fn momentum(&self, x: &[Float]) -> Vec<Float> {
        self.pattern.times(&self.matrices[1].values, x, self.bits)
    }

    pub fn product(&self, x: &[Float], y: &[Float]) -> Float {
        x.iter().zip(y).fold(Float::zero(), |sum, (x, y)| (&sum + &(x * y)).cut(self.bits))
    }

    /// A vector that no symmetry makes orthogonal to a mode.
    pub fn start_vector(&self, seed: usize) -> Vec<Float> {
        let numbers = (1..=self.n as u64).map(|i| (i + ((seed as u64) << 32)).wrapping_mul(0x9e37_79b9_7f4a_7c15));
        numbers.map(|z| Float::from((z ^ z >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9) as i64 as f64)).collect()
    }
}
