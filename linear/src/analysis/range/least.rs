//! The least possible peak of |H| over ranges of parameters, proved. In: |H|^2 as a function of the parameters and the
//! frequency, and a place near the optimum. Out: the place, a number below which |H|^2 cannot stay anywhere in the
//! ranges, and the possible distance of another place that is equally good. See docs/method/measures.md#optima.
//!
//! At any frequency, |H| is at most its largest value. So for weights that add up to one and frequencies that may
//! depend on the parameters p, L(p) = sum w_i(p) |H(w_i(p), p)|^2 is a lower bound of the square of the peak
//! everywhere. Near the place, L is built from the peaks that are equal there, with the weights at which its gradient
//! vanishes; if its second derivatives are positive definite over a box, its least value follows. Elsewhere boxes are
//! excluded by the gains at some frequencies.

mod exclusion;
mod valley;

pub use valley::Valley;

use super::several::{Affine, Square};
use crate::base::{Ball, Dd, OrderBy};
use crate::kernel::dense::Matrix;
use crate::kernel::dense::lu::Lu;

/// |H| of one path, over parameters from -1 to 1.
pub struct Peaks {
    pub affine: Affine,
    /// The frequencies at which |H| counts, in the unit of the path; both ends are the same for a gain at one frequency.
    pub band: [f64; 2],
    /// Below this, frequencies are compared with the lower end of the band alone.
    pub lowest: f64,
    /// The only frequency, if the two ends of the band are equal.
    pub fixed: Option<Ball>,
    /// Most boxes that are examined.
    pub most: usize,
}

/// A frequency at which |H| is as large as anywhere.
#[derive(Clone, Copy, Debug)]
pub struct Top {
    pub omega: Dd,
    /// Its weight.
    pub weight: Dd,
    /// Whether its frequency depends on the parameters: |H| is stationary there.
    pub moves: bool,
}

/// A place at which the peaks cannot all be lowered.
#[derive(Clone, Debug)]
pub struct Place {
    pub at: Vec<Dd>,
    pub tops: Vec<Top>,
    /// For each parameter, -1 or 1 if it is at an end of its range, and 0 inside.
    pub ends: Vec<i8>,
}

/// Proof that no box outside a valley contains a lower peak. Made only by the search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Everywhere(());

const NEWTON: usize = 40;
/// Frequencies within this factor of the highest peak are examined more closely.
const ROUND: f64 = 1.6;
/// A peak this much lower than the highest one is not taken for equal to it.
const NEARLY: f64 = 0.03;
/// Distances from an end of its range within which a parameter is tried at the end.
const AT_AN_END: [f64; 3] = [1e-6, 1e-3, 3e-2];

impl Peaks {
    pub fn count(&self) -> usize {
        self.affine.parameters()
    }

    /// The frequencies of the local maxima of |H| at a place, without a proof, and |H|^2 there, the highest first.
    pub fn maxima(&self, at: &[f64]) -> Vec<(f64, f64)> {
        self.maxima_within(at, self.band, 128, 32)
    }

    /// The largest |H|^2 at a place, without a proof; `None` if it is not finite.
    pub fn highest(&self, at: &[f64]) -> Option<f64> {
        // Peaks beside the highest one may be hidden between the frequencies of the first pass.
        let (omega, _) = *self.maxima_within(at, self.band, 64, 1).first()?;
        let [low, high] = self.band;
        let near = [(omega / ROUND).max(low), (omega * ROUND).min(high)];
        let (_, square) = *self.maxima_within(at, near, 64, 20).first()?;
        square.is_finite().then_some(square)
    }

    /// Local maxima among `count` frequencies, a power of two, refined by `sections` golden sections.
    fn maxima_within(&self, at: &[f64], [low, high]: [f64; 2], count: usize, sections: usize) -> Vec<(f64, f64)> {
        let path = self.affine.at(at);
        let f = |omega: f64| path.square(omega);
        if low == high {
            return vec![(low, f(low))];
        }
        let first = low.max(self.lowest).max(high * 1e-9);
        // The root of the ratio by square roots, which are the same on every machine.
        let ratio = (0..count.ilog2()).fold(high / first, |ratio: f64, _| ratio.sqrt());
        let mut grid: Vec<f64> = std::iter::successors(Some(first), |x| Some(x * ratio)).take(count).collect();
        (grid[0], grid[count - 1]) = (low, high);
        let values: Vec<f64> = grid.iter().map(|&omega| f(omega)).collect();
        let mut list = Vec::new();
        for i in 0..count {
            let left = i == 0 || values[i - 1] < values[i];
            let right = i + 1 == count || values[i + 1] <= values[i];
            if left && right {
                let ends = [grid[i.saturating_sub(1)], grid[(i + 1).min(count - 1)]];
                list.push(highest(&f, ends, sections));
            }
        }
        list.order_by(|a, b| b.1.total_cmp(&a.1));
        list
    }

    /// Newton's method for a place at which the weighted gradients of equal peaks cancel, from one nearby. `None` if it
    /// does not converge.
    pub fn settle(&self, start: &[f64]) -> Option<Place> {
        let maxima = self.maxima(start);
        let most = self.count() + 1;
        let near = maxima.iter().take_while(|top| top.1 > (1.0 - NEARLY) * maxima[0].1).count().min(most);
        let counts = (1..=near).rev();
        let end = |x: f64, near: f64| if x <= near - 1.0 { -1 } else { i8::from(x >= 1.0 - near) };
        let all = counts.flat_map(|count| AT_AN_END.map(|near| (count, near)));
        let mut found = all.filter_map(|(count, near)| {
            let ends: Vec<i8> = start.iter().map(|x| end(*x, near)).collect();
            self.arrive(start, &ends, &maxima[..count])
        });
        found.next()
    }

    fn arrive(&self, start: &[f64], ends: &[i8], maxima: &[(f64, f64)]) -> Option<Place> {
        let free: Vec<usize> = (0..self.count()).filter(|i| ends[*i] == 0).collect();
        let (m, k) = (free.len(), maxima.len());
        if k > m + 1 {
            return None;
        }
        let [low, high] = self.band;
        let moves = |omega: f64| low < high && omega > low * (1.0 + 1e-9) && omega < high * (1.0 - 1e-9);
        let mut at: Vec<Dd> = start
            .iter()
            .zip(ends)
            .map(|(x, end)| if *end == 0 { Dd::from(*x) } else { Dd::from(f64::from(*end)) })
            .collect();
        let mut tops: Vec<Top> = maxima
            .iter()
            .map(|(omega, _)| Top { omega: Dd::from(*omega), weight: Dd::ZERO, moves: moves(*omega) })
            .collect();
        let squares = |at: &[Dd], tops: &[Top]| -> Option<Vec<Square>> {
            let point: Vec<Ball> = at.iter().map(|x| Ball::exact(*x)).collect();
            tops.iter().map(|top| self.affine.square(&point, self.omega(top), true)).collect()
        };
        let last = self.count();
        let mut level = Dd::ZERO;
        let mut small = f64::INFINITY;
        for step in 0..NEWTON {
            let found = squares(&at, &tops)?;
            if step == 0 {
                weigh(&mut tops, &found, &free)?;
                level = found[0].value.mid;
            }
            // Unknowns: free parameters, frequencies, weights, the common value.
            let size = m + 2 * k + 1;
            let mut matrix = Matrix::from_fn(size, size, |_, _| Dd::ZERO);
            let mut right = vec![Dd::ZERO; size];
            for (j, (square, top)) in found.iter().zip(&tops).enumerate() {
                for (row, &a) in free.iter().enumerate() {
                    for (column, &c) in free.iter().enumerate() {
                        matrix[(row, column)] += top.weight * square.bend[a][c].mid;
                    }
                    matrix[(row, m + j)] = if top.moves { top.weight * square.bend[a][last].mid } else { Dd::ZERO };
                    matrix[(row, m + k + j)] = square.slope[a].mid;
                    right[row] -= top.weight * square.slope[a].mid;
                    matrix[(m + j, row)] = if top.moves { square.bend[last][a].mid } else { Dd::ZERO };
                    matrix[(m + k + j, row)] = square.slope[a].mid;
                }
                matrix[(m + j, m + j)] = if top.moves { square.bend[last][last].mid } else { Dd::ONE };
                right[m + j] = if top.moves { -square.slope[last].mid } else { Dd::ZERO };
                matrix[(m + k + j, m + j)] = if top.moves { square.slope[last].mid } else { Dd::ZERO };
                matrix[(m + k + j, size - 1)] = -Dd::ONE;
                right[m + k + j] = level - square.value.mid;
                matrix[(size - 1, m + k + j)] = Dd::ONE;
            }
            right[size - 1] = Dd::ONE - tops.iter().fold(Dd::ZERO, |sum, top| sum + top.weight);
            Lu::of(matrix)?.solve(&mut right);
            if !right.iter().all(|x| x.is_finite()) {
                return None;
            }
            let largest = right[..m + k].iter().map(|x| x.hi.abs()).fold(0.0, f64::max);
            // Far steps are cut: the functions are close to their expansions nearby only.
            let part = if largest > 0.1 { Dd::from(0.1 / largest) } else { Dd::ONE };
            for (column, &a) in free.iter().enumerate() {
                at[a] += right[column] * part;
            }
            for (j, top) in tops.iter_mut().enumerate() {
                top.omega += right[m + j] * part;
                top.weight += right[m + k + j] * part;
            }
            level += right[size - 1] * part;
            if largest >= small * 0.5 && largest < 1e-22 {
                break;
            }
            small = largest;
        }
        let inside = free.iter().all(|a| at[*a].hi.abs() <= 1.0);
        let in_band = tops.iter().all(|top| !top.moves || top.omega.hi >= low && top.omega.hi <= high);
        let weights = tops.iter().all(|top| top.weight.hi > 1e-9);
        (small < 1e-18 && inside && in_band && weights).then_some(Place { at, tops, ends: ends.to_vec() })
    }

    fn omega(&self, top: &Top) -> Ball {
        self.fixed.unwrap_or(Ball::exact(top.omega))
    }
}

/// The weights that bring the sum of the gradients nearest to zero.
fn weigh(tops: &mut [Top], found: &[Square], free: &[usize]) -> Option<()> {
    let k = tops.len();
    let slope = |j: usize, a: usize| found[j].slope[a].mid;
    let mut matrix = Matrix::from_fn(k + 1, k + 1, |i, j| match (i < k, j < k) {
        (true, true) => free.iter().fold(Dd::ZERO, |sum, &a| sum + slope(i, a) * slope(j, a)),
        (false, false) => Dd::ZERO,
        _ => Dd::ONE,
    });
    let scale = (0..k).map(|j| matrix[(j, j)].hi).fold(1e-300, f64::max);
    for j in 0..k {
        matrix[(j, j)] += Dd::from(scale * 1e-12);
    }
    let mut right = vec![Dd::ZERO; k + 1];
    right[k] = Dd::ONE;
    Lu::of(matrix)?.solve(&mut right);
    tops.iter_mut().zip(&right).for_each(|(top, weight)| top.weight = *weight);
    right.iter().all(|x| x.is_finite()).then_some(())
}

/// The highest value between two frequencies, by golden sections.
fn highest(f: &dyn Fn(f64) -> f64, [mut low, mut high]: [f64; 2], sections: usize) -> (f64, f64) {
    const PART: f64 = 0.381_966_011_250_105;
    let (mut a, mut b) = (low + (high - low) * PART, high - (high - low) * PART);
    let (mut fa, mut fb) = (f(a), f(b));
    for _ in 0..sections {
        if fa > fb {
            (high, b, fb) = (b, a, fa);
            a = low + (high - low) * PART;
            fa = f(a);
        } else {
            (low, a, fa) = (a, b, fb);
            b = high - (high - low) * PART;
            fb = f(b);
        }
    }
    let ends = [(low, f(low)), (high, f(high))];
    ends.into_iter().fold(if fa > fb { (a, fa) } else { (b, fb) }, |best, end| if end.1 > best.1 { end } else { best })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::range::several::absorber;

    fn peaks() -> Peaks {
        Peaks { affine: absorber(), band: [0.0, 30.0], lowest: 0.03, fixed: None, most: 5000 }
    }

    /// The square of the peak on a grid over the ranges, by a fine scan.
    fn grid(peaks: &Peaks) -> Vec<([f64; 2], f64)> {
        let along = |i: usize| i as f64 / 7.5 - 1.0;
        let places = (0..16).flat_map(|i| (0..16).map(move |j| [along(i), along(j)]));
        places.map(|at| (at, peaks.maxima(&at)[0].1)).collect()
    }

    /// The bound holds at all places, and is reached at the optimum; the excluded part of the ranges has higher peaks.
    #[test]
    fn the_bound_lies_below_all_peaks() {
        let peaks = peaks();
        let place = peaks.settle(&[0.1, -0.1]).expect("an optimum");
        let valley = peaks.valley(&place).expect("a valley");
        let at: Vec<f64> = place.at.iter().map(|x| x.to_f64()).collect();
        let here = peaks.maxima(&at)[0].1;
        assert!((valley.least.to_f64() - here).abs() < 1e-12 * here, "{} {here}", valley.least.to_f64());
        assert!(grid(&peaks).iter().all(|(_, square)| *square > valley.least.to_f64()));
        // Published: 6.407920768004619, Nishihara and Asami 2002.
        assert!((valley.least.to_f64().sqrt() - 6.407920768004619).abs() < 1e-12);
        let bar = valley.least * Ball::from(1.0 + 1e-12);
        assert!(peaks.excludes(&place, &valley, bar).is_ok());
    }

    /// False statements are not proved: a bar above the peaks of some places outside the valley, and a place that is
    /// not an optimum.
    #[test]
    fn a_bar_that_is_too_high_is_not_excluded() {
        let peaks = Peaks { most: 2000, ..peaks() };
        let place = peaks.settle(&[0.1, -0.1]).expect("an optimum");
        let valley = peaks.valley(&place).expect("a valley");
        let outside = |at: &[f64; 2]| (0..2).any(|i| (at[i] - place.at[i].to_f64()).abs() > valley.radius[i]);
        let lowest =
            grid(&peaks).into_iter().filter(|(at, _)| outside(at)).map(|(_, square)| square).fold(f64::MAX, f64::min);
        assert!(peaks.excludes(&place, &valley, Ball::from(1.0001 * lowest)).is_err());
        // Around a place beside the optimum, the bound is still below the optimum wherever it is valid.
        let best = valley.least.to_f64();
        let beside = [[1e-3, 0.0], [0.0, 1e-3], [0.0, -1e-3], [1e-4, 1e-4]].map(|step| {
            let mut moved = place.clone();
            (0..2).for_each(|i| moved.at[i] += Dd::from(step[i]));
            let valley = peaks.valley(&moved)?;
            let holds = (0..2).all(|i| step[i].abs() < valley.radius[i]);
            holds.then_some((valley.least.to_f64() - valley.least.rad) / best)
        });
        assert!(beside.iter().flatten().count() > 1, "{beside:?}");
        assert!(beside.iter().flatten().all(|ratio| *ratio <= 1.0 + 1e-15), "{beside:?}");
    }
}
