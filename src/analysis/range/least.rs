//! The least possible peak of |H| over ranges of parameters, proved. In: |H|^2 as a function of the parameters and the
//! frequency, and a place near the optimum. Out: the place, a number below which |H|^2 cannot stay anywhere in the
//! ranges, and the possible distance of another place that is equally good. See docs/method/measures.md#optima.
//!
//! At any frequency, |H| is at most its largest value. So for weights that add up to one and frequencies that may
//! depend on the parameters p, L(p) = sum w_i(p) |H(w_i(p), p)|^2 is a lower bound of the square of the peak
//! everywhere. Near the place, L is built from the peaks that are equal there, with the weights at which its gradient
//! vanishes; if its second derivatives are positive definite over a box, its least value follows. Elsewhere boxes are
//! excluded by the gains at some frequencies.

use super::several::{Affine, Square};
use crate::base::{Ball, Dd, up};
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

/// A box around a place in which L is convex.
#[derive(Clone, Debug)]
pub struct Valley {
    /// Half its widths.
    pub radius: Vec<f64>,
    /// The square of the peak is not below the lower end of this in the box.
    pub least: Ball,
    /// Least curvature along the free parameters, as multiples of half the widths.
    curvature: f64,
    /// The gradient of L at the place, of the free parameters.
    gradient: f64,
    /// For each parameter at an end, a lower bound of the increase of L per unit.
    rises: Vec<f64>,
    /// L at the place.
    level: Ball,
}

/// Proof that no box outside a valley contains a lower peak. Made only by the search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Everywhere(());

const NEWTON: usize = 40;
/// Frequencies within this factor of the highest peak are looked at more closely.
const ROUND: f64 = 1.6;
/// A peak this much lower than the highest one is not taken for equal to it.
const NEARLY: f64 = 0.03;
/// The change of the weights over a box, as a share of the change that would make a weight zero.
const TILTED: [f64; 5] = [0.3, 0.03, 3e-3, 3e-4, 3e-5];
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

    /// Of so many frequencies, a power of two, refined by so many golden sections.
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
        list.sort_by(|a, b| b.1.total_cmp(&a.1));
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

    /// The largest box around a place, among those whose widths are powers of two, over which L is convex.
    pub fn valley(&self, place: &Place) -> Option<Valley> {
        let scales = self.scales(place)?;
        let sizes = std::iter::successors(Some(0.5), |size| Some(0.5 * size)).take(40);
        let tries = sizes.flat_map(|size| TILTED.map(|tilted| (size, tilted)));
        let mut found = tries.filter_map(|(size, tilted)| {
            let radius: Vec<f64> = scales.iter().map(|scale| scale * size).collect();
            self.valley_within(place, &radius, tilted)
        });
        found.next()
    }

    /// The shape of the box: narrow along parameters by which the peaks change fast. At most one.
    fn scales(&self, place: &Place) -> Option<Vec<f64>> {
        let point: Vec<Ball> = place.at.iter().map(|x| Ball::exact(*x)).collect();
        let squares: Option<Vec<Square>> =
            place.tops.iter().map(|top| self.affine.square(&point, self.omega(top), true)).collect();
        let squares = squares?;
        let rate = |a: usize| {
            let of = |square: &Square| square.slope[a].to_f64().abs() + square.bend[a][a].to_f64().abs().sqrt();
            squares.iter().map(of).fold(0.0, f64::max).max(1e-9)
        };
        let rates: Vec<f64> = (0..self.count()).map(rate).collect();
        let slowest = rates.iter().copied().fold(f64::INFINITY, f64::min);
        Some(rates.iter().map(|rate| (slowest / rate).max(1e-6)).collect())
    }

    fn valley_within(&self, place: &Place, radius: &[f64], tilted: f64) -> Option<Valley> {
        let count = self.count();
        let last = count;
        let point: Vec<Ball> = place.at.iter().map(|x| Ball::exact(*x)).collect();
        let wide: Vec<Ball> = point.iter().zip(radius).map(|(x, radius)| x.widen(*radius)).collect();
        let free: Vec<usize> = (0..count).filter(|i| place.ends[*i] == 0).collect();
        let tops = &place.tops;
        let here: Option<Vec<Square>> =
            tops.iter().map(|top| self.affine.square(&point, self.omega(top), true)).collect();
        let here = here?;
        // The drift of each peak: d omega / dp = - (d2 / domega dp) / (d2 / domega2).
        let drift = |square: &Square, top: &Top| -> Vec<Ball> {
            let own = square.bend[last][last].mid;
            let of = |a: usize| if top.moves { Ball::exact(-square.bend[last][a].mid / own) } else { Ball::ZERO };
            (0..count).map(of).collect()
        };
        let drifts: Vec<Vec<Ball>> = here.iter().zip(tops).map(|(square, top)| drift(square, top)).collect();
        if drifts.iter().flatten().any(|x| !x.is_finite()) {
            return None;
        }
        let [low, high] = self.band;
        let offsets: Vec<Ball> = radius.iter().map(|radius| Ball::ZERO.widen(*radius)).collect();
        let moved = |start: Ball, slopes: &[Ball]| {
            slopes.iter().zip(&offsets).fold(start, |sum, (slope, offset)| sum + *slope * *offset)
        };
        let mut over = Vec::new();
        for (top, drift) in tops.iter().zip(&drifts) {
            let omega = moved(self.omega(top), drift);
            if top.moves && !(omega.mid.hi - omega.rad > low && omega.mid.hi + omega.rad < high) {
                return None;
            }
            over.push(self.affine.square(&wide, omega, true)?);
        }
        // For each peak followed along its drift: gradient and second derivatives with respect to the parameters.
        let along = |square: &Square, drift: &[Ball]| -> (Vec<Ball>, Vec<Vec<Ball>>) {
            let slope = (0..count).map(|a| square.slope[a] + square.slope[last] * drift[a]).collect();
            let bend = |a: usize, c: usize| {
                square.bend[a][c]
                    + square.bend[a][last] * drift[c]
                    + drift[a] * square.bend[last][c]
                    + drift[a] * square.bend[last][last] * drift[c]
            };
            (slope, (0..count).map(|a| (0..count).map(|c| bend(a, c)).collect()).collect())
        };
        let near: Vec<_> = here.iter().zip(&drifts).map(|(square, drift)| along(square, drift)).collect();
        let far: Vec<_> = over.iter().zip(&drifts).map(|(square, drift)| along(square, drift)).collect();
        let tilts = self.tilts(place, &near.iter().map(|(slope, _)| slope.clone()).collect::<Vec<_>>(), radius, tilted);
        let weight = |j: usize| moved(Ball::exact(tops[j].weight), &tilts[j]);
        let weights: Vec<Ball> = (0..tops.len()).map(weight).collect();
        if !weights.iter().all(Ball::is_positive) {
            return None;
        }
        let sum = |of: &dyn Fn(usize) -> Ball| (0..tops.len()).fold(Ball::ZERO, |sum, j| sum + of(j));
        // The weights add up to one but for rounding.
        let tilted: Vec<Ball> = (0..count).map(|a| sum(&|j| tilts[j][a])).collect();
        let whole = moved(sum(&|j| Ball::exact(tops[j].weight)), &tilted);
        let bend = |a: usize, c: usize| {
            let scale = Ball::from(radius[a]) * Ball::from(radius[c]);
            sum(&|j| weights[j] * far[j].1[a][c] + tilts[j][a] * far[j].0[c] + tilts[j][c] * far[j].0[a]) * scale
        };
        let gradient_over = |a: usize| sum(&|j| weights[j] * far[j].0[a] + tilts[j][a] * over[j].value);
        let mut rises = Vec::new();
        for a in (0..count).filter(|a| place.ends[*a] != 0) {
            let inward = gradient_over(a) * Ball::from(-f64::from(place.ends[a]));
            if !inward.is_positive() {
                return None;
            }
            rises.push(inward.mignitude());
        }
        let curvature = least_eigenvalue(&free, &bend)?;
        let gradient_here = |a: usize| {
            sum(&|j| Ball::exact(tops[j].weight) * near[j].0[a] + tilts[j][a] * here[j].value) * Ball::from(radius[a])
        };
        let gradient = free.iter().map(|&a| gradient_here(a));
        let gradient = gradient.map(|slope| slope.magnitude()).fold(0.0, |sum, x| sum + x * x).sqrt() * up::THOUSANDS;
        let level = sum(&|j| Ball::exact(tops[j].weight) * here[j].value);
        let below = if free.is_empty() { 0.0 } else { gradient * gradient / (2.0 * curvature) * up::THOUSANDS };
        let least = level.widen(below) / whole;
        Some(Valley { radius: radius.to_vec(), least, curvature, gradient, rises, level: level / whole })
    }

    /// The slopes of the weights: towards the higher peak, by this share of the change that the box allows, so that L
    /// curves where the peaks separate.
    fn tilts(&self, place: &Place, slopes: &[Vec<Ball>], radius: &[f64], tilted: f64) -> Vec<Vec<Ball>> {
        let (count, k) = (self.count(), place.tops.len());
        let mean = |a: usize| slopes.iter().fold(Dd::ZERO, |sum, slope| sum + slope[a].mid) / Dd::from(k as f64);
        let apart: Vec<Vec<Dd>> = slopes
            .iter()
            .map(|slope| {
                (0..count).map(|a| if place.ends[a] == 0 { slope[a].mid - mean(a) } else { Dd::ZERO }).collect()
            })
            .collect();
        let most = |j: usize| {
            let length: f64 = apart[j].iter().zip(radius).map(|(x, radius)| x.hi.abs() * radius).sum();
            if length == 0.0 { f64::INFINITY } else { place.tops[j].weight.hi / length }
        };
        let times = tilted * (0..k).map(most).fold(f64::INFINITY, f64::min);
        let times = if k > 1 && times.is_finite() { times } else { 0.0 };
        apart.iter().map(|row| row.iter().map(|x| Ball::exact(*x * times)).collect()).collect()
    }

    /// Whether the square of the peak is above `bar` in every part of the ranges outside the valley; otherwise the
    /// number of boxes that were not settled.
    pub fn excludes(&self, place: &Place, valley: &Valley, bar: Ball) -> Result<Everywhere, usize> {
        let count = self.count();
        let mut waiting = std::collections::VecDeque::from([vec![(-1.0, 1.0); count]]);
        let own: Vec<f64> = valley.radius.iter().map(|radius| radius * (1.0 - 1e-9)).collect();
        let mut seen = 0;
        while let Some(cell) = waiting.pop_front() {
            let inside = cell.iter().zip(&place.at).zip(&own).all(|(((low, high), at), own)| {
                (Dd::from(*low) - *at).hi >= -own && (Dd::from(*high) - *at).hi <= *own
            });
            if inside {
                continue;
            }
            if seen >= self.most {
                return Err(waiting.len() + 1);
            }
            seen += 1;
            if self.is_above(&cell, &place.tops, bar) {
                continue;
            }
            let widest = (0..count)
                .fold(0, |best, i| if cell[i].1 - cell[i].0 > cell[best].1 - cell[best].0 { i } else { best });
            let (low, high) = cell[widest];
            let cut = 0.5 * (low + high);
            if !(low < cut && cut < high) {
                return Err(waiting.len() + 1);
            }
            for part in [(low, cut), (cut, high)] {
                let mut half = cell.clone();
                half[widest] = part;
                waiting.push_back(half);
            }
        }
        Ok(Everywhere(()))
    }

    /// Whether the square of the peak is certainly above `bar` throughout a box.
    fn is_above(&self, cell: &[(f64, f64)], tops: &[Top], bar: Ball) -> bool {
        let middle: Vec<f64> = cell.iter().map(|(low, high)| 0.5 * (low + high)).collect();
        let radius: Vec<f64> = cell.iter().map(|(low, high)| 0.5 * (high - low) * up::FEW).collect();
        let point: Vec<Ball> = middle.iter().map(|x| Ball::from(*x)).collect();
        let wide: Vec<Ball> = point.iter().zip(&radius).map(|(x, radius)| x.widen(*radius)).collect();
        let mut known: Vec<(Ball, Vec<Ball>)> = Vec::new();
        for omega in self.witnesses(&middle, tops, bar.to_f64()) {
            let omega = self.fixed.unwrap_or(Ball::from(omega));
            let Some(over) = self.affine.square(&wide, omega, false) else { continue };
            if (over.value - bar).is_positive() {
                return true;
            }
            let Some(here) = self.affine.square(&point, omega, false) else { continue };
            known.push((here.value - bar, over.slope));
            let one = known.len() - 1;
            if (0..=one).any(|other| together(&known[other], &known[one], &radius)) {
                return true;
            }
        }
        false
    }

    /// Frequencies at which |H| is likely above the bar throughout a box: its highest maxima, and high points on their
    /// flanks.
    fn witnesses(&self, at: &[f64], tops: &[Top], bar: f64) -> Vec<f64> {
        let mut list = Vec::new();
        let path = self.affine.at(at);
        let nearest = tops.iter().map(|top| top.omega.to_f64()).fold(f64::INFINITY, f64::min);
        let farthest = tops.iter().map(|top| top.omega.to_f64()).fold(0.0, f64::max);
        let band = [(nearest / 4.0).max(self.band[0]), (farthest * 4.0).min(self.band[1])];
        for (omega, value) in self.maxima_within(at, band, 32, 24).into_iter().take(self.count() + 1) {
            // On the flank of a high peak |H| changes less over the box.
            if value > 4.0 * bar && self.band[0] < self.band[1] {
                for side in [0.5, -0.5] {
                    let (mut near, mut far) = (omega, (omega * (1.0 + side)).clamp(self.band[0], self.band[1]));
                    for _ in 0..12 {
                        let middle = 0.5 * (near + far);
                        if path.square(middle) > 2.5 * bar { near = middle } else { far = middle }
                    }
                    list.push(near);
                }
            }
            list.push(omega);
        }
        list
    }
}

impl Valley {
    /// The distances from the place, along each parameter, up to which the square of the peak may be no higher than
    /// this.
    pub fn reach(&self, place: &Place, square: Ball) -> Vec<f64> {
        let gap = (square - self.least).mid.hi + (square - self.least).rad;
        let above = (square - self.level).mid.hi + (square - self.level).rad;
        let (gap, above) = (gap.max(0.0), above.max(0.0));
        let root = (self.gradient * self.gradient + 2.0 * self.curvature * above).sqrt();
        let free = (self.gradient + root) / self.curvature * up::THOUSANDS;
        let mut rises = self.rises.iter();
        let of = |(end, radius): (&i8, &f64)| match end {
            0 => radius * free.min(1.0),
            _ => (gap / rises.next().copied().unwrap_or(0.0) * up::THOUSANDS).min(*radius),
        };
        place.ends.iter().zip(&self.radius).map(of).collect()
    }
}

/// Whether the larger of two functions, given by their values at the middle of a box and their slopes over it, is
/// positive throughout: by a weighted mean.
fn together(a: &(Ball, Vec<Ball>), b: &(Ball, Vec<Ball>), radius: &[f64]) -> bool {
    let below = |part: f64| {
        let (one, other) = (Ball::from(part), Ball::from(1.0 - part));
        let slope = |(a, b): (&Ball, &Ball)| (one * *a + other * *b).magnitude();
        let value = one * a.0 + other * b.0;
        let falls: f64 = a.1.iter().zip(&b.1).map(slope).zip(radius).map(|(slope, radius)| slope * radius).sum();
        value - Ball::from(falls * up::THOUSANDS)
    };
    // The bound is a concave function of the weight, with kinks where a slope vanishes.
    let kink = |(a, b): (&Ball, &Ball)| {
        let part = b.to_f64() / (b.to_f64() - a.to_f64());
        (part > 0.0 && part < 1.0).then_some((part * 1048576.0).round() / 1048576.0)
    };
    let kinks = a.1.iter().zip(&b.1).filter_map(kink);
    [0.0, 1.0].into_iter().chain(kinks).any(|part| below(part).is_positive())
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

/// A positive lower bound of the eigenvalues of a symmetric matrix of balls: the pivots of A - s 1 are positive. `None`
/// if an eigenvalue may not be positive.
fn least_eigenvalue(free: &[usize], entry: &dyn Fn(usize, usize) -> Ball) -> Option<f64> {
    let m = free.len();
    if m == 0 {
        return Some(0.0);
    }
    let a: Vec<Vec<Ball>> = free.iter().map(|&i| free.iter().map(|&j| entry(i, j)).collect()).collect();
    let positive = |shift: f64| {
        let mut rows = a.clone();
        for (i, row) in rows.iter_mut().enumerate() {
            row[i] = row[i] - Ball::from(shift);
        }
        for step in 0..m {
            if !rows[step][step].is_positive() {
                return false;
            }
            let (above, below) = rows.split_at_mut(step + 1);
            let pivot = &above[step];
            for row in below {
                let factor = row[step] / pivot[step];
                for (entry, over) in row[step + 1..].iter_mut().zip(&pivot[step + 1..]) {
                    *entry = *entry - factor * *over;
                }
            }
        }
        true
    };
    if !positive(0.0) {
        return None;
    }
    let top = (0..m).map(|i| a[i][i].to_f64()).fold(f64::INFINITY, f64::min);
    std::iter::successors(Some(0.7 * top), |shift| Some(0.7 * shift)).take(200).find(|shift| positive(*shift))
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
