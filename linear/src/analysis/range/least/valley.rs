//! A box around the optimum in which a weighted sum of peaks is convex. See docs/method/measures.md#optima.

use super::{Peaks, Place, Top};
use crate::analysis::range::several::Square;
use crate::base::{Ball, Dd, up};

/// The change of the weights over a box, as a share of the change that would make a weight zero.
const TILTED: [f64; 5] = [0.3, 0.03, 3e-3, 3e-4, 3e-5];

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

impl Peaks {
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
