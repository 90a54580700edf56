//! Eigenvalues of many cases side by side, each with a bound of its error: the i-th numbers of all cases are neighbours, and so are
//! their bounds, so that loops over cases take them in lanes.

use crate::kernel::simd::{MOST, Vector, simd};

/// `count` numbers of each case with their bounds; NaN where nothing is known.
#[derive(Clone, Debug)]
pub struct Bounded {
    count: usize,
    cases: usize,
    numbers: Vec<f64>,
    bounds: Vec<f64>,
}

impl Bounded {
    /// Nothing is known yet.
    pub fn unknown(count: usize, cases: usize) -> Bounded {
        let all = || vec![f64::NAN; count * stride(cases)];
        Bounded { count, cases, numbers: all(), bounds: all() }
    }

    /// The number of numbers of a case.
    pub fn count(&self) -> usize {
        self.count
    }

    pub fn cases(&self) -> usize {
        self.cases
    }

    /// The i-th number of each case.
    pub fn numbers(&self, i: usize) -> &[f64] {
        &self.numbers[i * stride(self.cases)..][..self.cases]
    }

    pub fn bounds(&self, i: usize) -> &[f64] {
        &self.bounds[i * stride(self.cases)..][..self.cases]
    }

    /// The i-th number of a case, and its bound.
    pub fn pair(&self, i: usize, case: usize) -> [f64; 2] {
        let at = i * stride(self.cases) + case;
        [self.numbers[at], self.bounds[at]]
    }

    pub fn set(&mut self, i: usize, case: usize, [number, bound]: [f64; 2]) {
        let at = i * stride(self.cases) + case;
        (self.numbers[at], self.bounds[at]) = (number, bound);
    }

    /// The i-th numbers of all cases and their bounds, with room for whole vectors.
    pub fn whole_lanes(&mut self, i: usize) -> (&mut [f64], &mut [f64]) {
        let places = i * stride(self.cases)..(i + 1) * stride(self.cases);
        (&mut self.numbers[places.clone()], &mut self.bounds[places])
    }

    /// All numbers of a case, each followed by its bound.
    pub fn of_case(&self, case: usize) -> Vec<f64> {
        (0..self.count).flat_map(|i| self.pair(i, case)).collect()
    }

    /// The numbers of as many cases as the other has, from one on, are those of the other one, which has as many for each.
    pub fn copy_from(&mut self, first: usize, other: &Bounded) {
        for i in 0..self.count.min(other.count) {
            let at = i * stride(self.cases) + first;
            self.numbers[at..at + other.cases].copy_from_slice(other.numbers(i));
            self.bounds[at..at + other.cases].copy_from_slice(other.bounds(i));
        }
    }

    /// Nothing is known of these cases.
    pub fn forget(&mut self, cases: std::ops::Range<usize>) {
        for i in 0..self.count {
            let at = i * stride(self.cases);
            for list in [&mut self.numbers, &mut self.bounds] {
                list[at + cases.start..at + cases.end].fill(f64::NAN);
            }
        }
    }

    /// The roots of the i-th numbers times a factor that is known to a rounding, with their absolute bounds, where the relative ones are
    /// at most this share; NaN elsewhere. What is exactly zero stays so.
    pub fn roots(&self, i: usize, factor: f64, share: f64, (roots, errors): (&mut [f64], &mut [f64])) {
        square_roots(self.numbers(i), self.bounds(i), factor, share, roots, errors);
    }
}

/// Cases with those that fill the last vector.
fn stride(cases: usize) -> usize {
    cases.next_multiple_of(MOST)
}

/// The first numbers as a vector; where there are too few, the last ones are the first one again.
#[inline(always)]
pub fn load<V: Vector>(x: &[f64]) -> V {
    if x.len() >= V::WIDTH {
        return V::load(x);
    }
    let mut lanes = [x[0]; MOST];
    lanes[..x.len()].copy_from_slice(x);
    V::load(&lanes)
}

/// Stores as many lanes as there is room for.
#[inline(always)]
pub fn store<V: Vector>(from: V, to: &mut [f64]) {
    if to.len() >= V::WIDTH {
        return from.store(to);
    }
    to.copy_from_slice(&from.to_array()[..to.len()]);
}

simd! {
    fn square_roots<V: Vector>(squares: &[f64], bounds: &[f64], factor: f64, share: f64, roots: &mut [f64], errors: &mut [f64]) {
        let (zero, unknown) = (V::splat(0.0), V::splat(f64::NAN));
        let places = squares.chunks(V::WIDTH).zip(bounds.chunks(V::WIDTH));
        let results = roots.chunks_mut(V::WIDTH).zip(errors.chunks_mut(V::WIDTH));
        for ((square, bound), (root, error)) in places.zip(results) {
            let (x, b) = (load::<V>(square), load::<V>(bound));
            // The square root halves a small relative change; three roundings and that of the factor are added.
            let relative = V::splat(0.51) * (b / x) + V::splat(4.0 * f64::EPSILON);
            let value = x.sqrt() * V::splat(factor);
            // NaN times zero is one, and so is the root of what is negative.
            let value = relative.if_exceeds(V::splat(share), unknown, relative.mul_add(zero, value));
            let away = value * relative * V::splat(1.0 + 8.0 * f64::EPSILON);
            // NaN is no larger than zero, and stays.
            let size = x.abs() + b;
            store(size.if_exceeds(zero, value, size), root);
            store(size.if_exceeds(zero, away, size), error);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Roots of squares that are exact, wide, zero, negative or not known, in a full vector and behind it.
    #[test]
    fn roots_are_known_where_their_squares_are() {
        let list = [
            [4.0, 0.0],
            [9.0, 9e-9],
            [0.0, 0.0],
            [9.0, 0.9],
            [0.0, 1e-300],
            [-4.0, 0.0],
            [f64::NAN, 0.0],
            [2.0, f64::NAN],
        ];
        let cases = 3 * list.len() - 5;
        let mut squares = Bounded::unknown(2, cases);
        (0..cases).for_each(|case| squares.set(1, case, list[case % list.len()]));
        let (mut roots, mut errors) = (vec![0.0; cases], vec![0.0; cases]);
        squares.roots(1, 0.5, 1e-8, (&mut roots, &mut errors));
        for case in 0..cases {
            let (root, error) = (roots[case], errors[case]);
            match case % list.len() {
                0 => assert!(root == 1.0 && error < 1e-15),
                // Half of 3 times (1 + 1e-9) to the power of one half.
                1 => assert!(root == 1.5 && (0.75e-9..0.77e-9).contains(&error), "{error}"),
                2 => assert!(root == 0.0 && error == 0.0),
                _ => assert!(root.is_nan(), "{case} {root} {error}"),
            }
        }
        assert!(squares.numbers(0).iter().all(|x| x.is_nan()));
        squares.forget(1..cases);
        assert_eq!(squares.pair(1, 0), [4.0, 0.0]);
        assert!(squares.numbers(1)[1..].iter().all(|x| x.is_nan()));
    }
}
