//! Half-power widths of peaks, between extrema that are all known.

use super::{Located, MOST_STEPS};
use crate::analysis::transfer::partial_fractions::PartialFractions;
use crate::base::{Ball, Dd, up};
use crate::kernel::complex::Complex;

/// Number of times that the enclosure of a crossing is widened.
const DOUBLINGS: usize = 24;

/// Half-power widths, between extrema that are all known.
pub struct Widths<'a> {
    pub h: &'a PartialFractions,
    pub located: &'a [Located],
    /// rad/s
    pub open: &'a [(f64, f64)],
    pub top: f64,
}

impl Widths<'_> {
    /// The half-power width of a peak, rad/s; `None` if |H| rises again before, or the width is wider than what is known.
    pub fn of(&self, index: usize) -> Option<Ball> {
        let from = self.located[index].omega.mid;
        // |H| is monotone from the peak to the next extremum, or to where it is unknown whether there is one.
        let before = self.located[..index].iter().map(|other| other.omega.mid);
        let known = self.open.iter().filter(|open| open.0 < from.hi).map(|open| Dd::from(open.1.next_up()));
        let low = before.chain(known).fold(Dd::ZERO, |low, end| if end > low { end } else { low });
        let behind = self.located[index + 1..].iter().map(|other| other.omega.mid);
        let known = self.open.iter().filter(|open| open.1 > from.hi).map(|open| Dd::from(open.0.next_down()));
        let high = behind.chain(known).fold(Dd::from(self.top), |high, end| if end < high { end } else { high });
        if !(low < from && from < high) {
            return None;
        }
        let (left, right) = (self.crossing(index, low)?, self.crossing(index, high)?);
        Some(right - left)
    }

    /// Where |H|^2 is half of that of a peak, between it and `end`: |H| is monotone there.
    fn crossing(&self, index: usize, end: Dd) -> Option<Ball> {
        let peak = &self.located[index];
        let disc = peak.gain.disc()?;
        let (top, top_error) = square_of(disc.value, disc.radius);
        let (level, level_error) = (top.scale(0.5), 0.5 * top_error);
        let from = peak.omega.mid;
        let (low, high) = if end < from { (end, from) } else { (from, end) };
        let value = |omega: Dd| {
            let [h, slope] = self.h.near(omega);
            (h.re * h.re + h.im * h.im - level.hi, 2.0 * (h.re * slope.re + h.im * slope.im))
        };
        let changes_sign = value(end).0 < -1e-9 * level.hi;
        if !changes_sign {
            return None;
        }
        // Newton's method between the peak, where the value is positive, and the end.
        let (mut above, mut below) = (from, end);
        let reach = Dd::from((level.hi / peak.bend.abs()).sqrt());
        let mut omega = if end < from { from - reach } else { from + reach };
        let mut slope = f64::NAN;
        for _ in 0..MOST_STEPS {
            let between = if above < below { omega > above && omega < below } else { omega < above && omega > below };
            if !between {
                omega = (above + below).scale(0.5);
            }
            let at = value(omega);
            if at.0 > 0.0 {
                above = omega
            } else {
                below = omega
            }
            slope = at.1;
            let step = Dd::from(at.0 / at.1);
            omega -= step;
            if step.hi.abs() <= 1e-14 * (omega - from).hi.abs() {
                break;
            }
        }
        let sharp = |omega: Dd| {
            let local = self.h.at(omega);
            let (square, error) = square_of(local.h, local.errors[0]);
            (square - level, (error + level_error + 4.0 * Dd::EPSILON * level.hi) * up::FEW)
        };
        let (rest, error) = sharp(omega);
        let omega = omega - rest / Dd::from(slope);
        let mut reach = 2.0 * error / slope.abs() + omega.hi * 1e-31;
        let towards = if end < from { 1.0 } else { -1.0 };
        for _ in 0..DOUBLINGS {
            let [inner, outer] = [towards, -towards].map(|side| omega + Dd::from(side * reach));
            let between = [inner, outer].iter().all(|&x| x > low && x < high);
            let (inside, outside) = (sharp(inner), sharp(outer));
            if between && inside.0.hi > inside.1 && outside.0.hi < -outside.1 {
                return Some(Ball::new(omega, reach * up::THOUSANDS));
            }
            reach *= 4.0;
        }
        None
    }
}

/// |H|^2 and a bound of its error.
fn square_of(h: Complex<Dd>, error: f64) -> (Dd, f64) {
    let size = h.to_f64().abs() * up::FEW;
    let lost = (2.0 * size + error) * error + 8.0 * Dd::EPSILON * size * size;
    (h.re * h.re + h.im * h.im, lost * up::DOZENS + f64::MIN_POSITIVE)
}
