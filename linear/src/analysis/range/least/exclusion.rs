//! The proof that no box outside a valley contains a lower peak. See docs/method/measures.md#optima.

use super::{Everywhere, Peaks, Place, Top, Valley};
use crate::base::{Ball, Dd, up};

impl Peaks {
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
            if (0..=one).any(|other| is_larger_positive(&known[other], &known[one], &radius)) {
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

/// Whether the larger of two functions, given by their values at the middle of a box and their slopes over it, is
/// positive throughout: by a weighted mean.
fn is_larger_positive(a: &(Ball, Vec<Ball>), b: &(Ball, Vec<Ball>), radius: &[f64]) -> bool {
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
