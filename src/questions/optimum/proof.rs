//! Proofs of optima. A largest gain, or the gain at one frequency, of a system whose numbers are affine in the
//! parameters: by [`crate::analysis::range::least`]. Any measure of one parameter that `solve` can enclose: the measure
//! is better by more than a little nowhere in the range. See docs/method/measures.md#optima.

use super::search::{Search, Seen};
use super::{Lines, Outcome, setting, short};
use crate::analysis::range::least::Peaks;
use crate::analysis::range::several::Affine;
use crate::base::number::jet::Jet;
use crate::base::{Ball, Bound, Dd, Number, up};
use crate::model::scene::{Measure, Optimum, Question, Varied};
use crate::model::{CheckedScene, Setting};
use crate::questions::answer::{Best, shown_in, shown_text};
use crate::questions::cover::{Cover, Part, Rest};
use crate::questions::probe::Probe;
use crate::questions::range_enclosure::two_pi;
use crate::questions::search::to_fraction;
use crate::questions::trial::Text;
use crate::system::LinearSystem;

/// Boxes for a system of one coordinate; larger ones get fewer.
const MOST_BOXES: usize = 160_000;
/// Beyond the outermost poles by this factor, frequencies are compared with zero alone, or not at all.
const BEYOND: f64 = 30.0;
/// The share of the measure by which another value of one parameter may be better.
const LITTLE: f64 = 1e-9;
/// Parts of the range of one parameter.
const MOST_PARTS: usize = 600;

impl Lines<'_> {
    /// The optimum with a proof, or with the exact place at least.
    pub(super) fn prove(
        &self,
        index: usize,
        settings: &[Setting],
        seen: &Seen,
        search: &mut Search,
    ) -> Option<Outcome> {
        let optimum = &self.optima[index];
        if self.solves_inside {
            return None;
        }
        let of_gain = matches!(optimum.question.measure, Measure::PeakGain { .. } | Measure::Gain { .. });
        let found = (of_gain && !optimum.highest).then(|| self.least_peak(index, settings, seen, search)).flatten();
        found.or_else(|| (optimum.varied.len() == 1).then(|| self.over_one(index, settings, seen, search)).flatten())
    }

    fn least_peak(&self, index: usize, settings: &[Setting], seen: &Seen, search: &mut Search) -> Option<Outcome> {
        let optimum = &self.optima[index];
        let text = Text { fixed: settings, ..self.text };
        let ranges = Ranges::of(optimum);
        let size = seen.value.to_f64();
        let peaks = self.peaks(index, &text, &ranges, &seen.values, size)?;
        let place = peaks.settle(&ranges.units(&seen.values))?;
        let values: Vec<Number> = (optimum.varied.iter().zip(&ranges.list).zip(place.at.iter().zip(&place.ends)))
            .map(|((varied, (middle, width)), (at, end))| match end {
                -1 => varied.low.clone(),
                1 => varied.high.clone(),
                _ => {
                    let near = *middle + *width * *at;
                    short(varied, near, near.hi.abs() * 1e-28)
                }
            })
            .collect();
        let value = search.measure(&values)?;
        if (value - seen.value).is_positive() {
            return None;
        }
        // The square of the measure at the place, in the unit of the path. A proof has to exclude only smaller values.
        let bar = (value / Ball::from(size)).square();
        let equal = place.tops.iter().map(|top| top.omega.to_f64() * peaks.affine.unit / std::f64::consts::TAU);
        let mut equal: Vec<f64> = if peaks.fixed.is_some() { Vec::new() } else { equal.collect() };
        equal.sort_by(f64::total_cmp);
        let unproved = |values: Vec<Number>| {
            let within = vec![None; values.len()];
            Outcome { values, value, within, best: Best::Seen, equal: equal.clone() }
        };
        let Some(valley) = peaks.valley(&place) else { return Some(unproved(values)) };
        let least = valley.least.sqrt() * Ball::from(size);
        let gap = value - least;
        let gap = Bound::by_proof((gap.mid.hi + gap.rad) * up::FEW);
        let reach = valley.reach(&place, Ball::exact(bar.mid + Dd::from(bar.rad * up::FEW)));
        let within = reach.iter().zip(&ranges.list).zip(place.at.iter().zip(&values));
        let within = within.map(|((reach, (middle, width)), (at, value))| {
            let off = value.to_ball() - Ball::exact(*middle) - Ball::exact(*width) * Ball::exact(*at);
            Some((reach * width.hi + off.magnitude()) * up::THOUSANDS)
        });
        let within: Vec<Option<f64>> = within.collect();
        let best = match peaks.excludes(&place, &valley, Ball::exact(bar.mid + Dd::from(bar.rad * up::FEW))) {
            Ok(everywhere) => Best::Everywhere { gap, proof: everywhere.into() },
            Err(_) => {
                let of = |(middle, width): &(Dd, Dd), at: &Dd, radius: f64, varied: &Varied| {
                    let (low, high) = (*at - Dd::from(radius), *at + Dd::from(radius));
                    let clip = |x: Dd| {
                        if x.hi < -1.0 {
                            -Dd::ONE
                        } else if x.hi > 1.0 {
                            Dd::ONE
                        } else {
                            x
                        }
                    };
                    let text = |x: Dd| {
                        let value = to_fraction(*middle + *width * clip(x));
                        shown_text(&shown_in(&value, &varied.parameter.unit, false))
                    };
                    (text(low), text(high))
                };
                let parts = ranges.list.iter().zip(&place.at).zip(valley.radius.iter().zip(&optimum.varied));
                let parts = parts.map(|((range, at), (radius, varied))| of(range, at, *radius, varied));
                Best::Near { gap, parts: parts.collect() }
            }
        };
        Some(Outcome { values, value, within, best, equal })
    }

    /// |H| over the ranges in binary64, for the search: of a gain that is to be small, without conditions.
    pub(super) fn rough_peaks(&self, index: usize, settings: &[Setting]) -> Option<RoughPeaks> {
        let optimum = &self.optima[index];
        let of_gain = matches!(optimum.question.measure, Measure::PeakGain { .. } | Measure::Gain { .. });
        if !of_gain || optimum.highest || self.solves_inside || !optimum.limits.is_empty() {
            return None;
        }
        let ranges = Ranges::of(optimum);
        let middle: Vec<Number> = ranges.list.iter().map(|(middle, _)| to_fraction(*middle)).collect();
        let peaks = self.peaks(index, &Text { fixed: settings, ..self.text }, &ranges, &middle, 1.0)?;
        Some(RoughPeaks { peaks, ranges })
    }

    /// |H|^2 over the ranges, where |H| is divided by a size; the values are a place in them.
    fn peaks(&self, index: usize, text: &Text, ranges: &Ranges, values: &[Number], size: f64) -> Option<Peaks> {
        let optimum = &self.optima[index];
        let choose = |scene: &CheckedScene| Some(scene.scene().optima.get(index)?.question.clone());
        let own = |list: Vec<Number>| -> Vec<Setting> {
            optimum.varied.iter().zip(list).map(|(varied, value)| setting(varied, value)).collect()
        };
        let (middle, probe) =
            text.system_over(&own(ranges.list.iter().map(|(middle, _)| to_fraction(*middle)).collect()), choose)?;
        let moved = |i: usize| {
            let value = |(j, (middle, width)): (usize, &(Dd, Dd))| {
                let range = Ball::exact(*middle).widen(width.hi * up::FEW);
                if i == j { Jet::of_parameter(range) } else { Number::Ball(range) }
            };
            Some(text.system_over(&own(ranges.list.iter().enumerate().map(value).collect()), choose)?.0)
        };
        let moved: Option<Vec<LinearSystem>> = (0..optimum.varied.len()).map(moved).collect();
        let (path, range, fixed) = match &probe {
            Probe::PeakGain(input, output, range) => ((*input, *output), range.clone(), None),
            Probe::Gain(input, output, at) => ((*input, *output), None, Some((at * &two_pi()).to_ball())),
            _ => return None,
        };
        let (slowest, fastest) = text.sizes_of_poles(&own(values.to_vec()))?;
        let unit = match fixed {
            Some(omega) if !omega.is_zero() => omega.to_f64(),
            _ => fastest,
        };
        let widths: Vec<Dd> = ranges.list.iter().map(|(_, width)| *width).collect();
        let affine = Affine::of(&middle, &moved?, &widths, path, unit)?;
        let in_units = |hertz: &Number, times: f64| hertz.to_f64() * std::f64::consts::TAU / unit * times;
        let band = match (&fixed, &range) {
            (Some(omega), _) => [omega.to_f64() / unit; 2],
            (None, Some([low, high])) => [in_units(low, 1.0 + 1e-14), in_units(high, 1.0 - 1e-14)],
            (None, None) => [0.0, fastest * BEYOND / unit],
        };
        if !(size > 0.0 && size.is_finite() && band[0] <= band[1]) {
            return None;
        }
        let n = middle.n();
        Some(Peaks {
            affine: affine.over(size),
            band,
            lowest: slowest / BEYOND / unit,
            fixed: fixed.map(|omega| omega / Ball::from(unit)),
            most: MOST_BOXES / (n + 2).pow(2),
        })
    }

    /// One parameter: no value in the range is better by more than a little, if the measure can be enclosed over parts
    /// of the range.
    fn over_one(&self, index: usize, settings: &[Setting], seen: &Seen, search: &mut Search) -> Option<Outcome> {
        let optimum = &self.optima[index];
        let varied = &optimum.varied[0];
        let text = Text { fixed: settings, ..self.text };
        let seen = search.finish(seen.clone());
        let step = Dd::from(seen.value.magnitude() * LITTLE);
        let (value, off) = (seen.value.mid, Dd::from(seen.value.rad));
        let bar = if optimum.highest { value + off + step } else { value - off - step };
        let bar = to_fraction(bar);
        let choose = |scene: &CheckedScene| {
            let own = scene.scene().optima.get(index)?.question.clone();
            Some(Question { value: bar.clone(), ..own })
        };
        let over = |range: Ball| {
            let enclosed = text
                .enclose_over(&[setting(varied, Jet::of_parameter(range))], choose, |asked| asked.enclose_measure());
            enclosed.unwrap_or_else(crate::questions::range_enclosure::RangeEnclosure::silent)
        };
        let side = |at: Dd| {
            let measured =
                text.measure(&[setting(varied, to_fraction(at))], |scene| choose(scene).into_iter().collect());
            match measured.ok()?.pop()? {
                crate::analysis::Measurement::Value(value) => {
                    let difference = value - bar.to_ball();
                    Some(match () {
                        () if difference.is_positive() => std::cmp::Ordering::Greater,
                        () if difference.is_negative() => std::cmp::Ordering::Less,
                        () => std::cmp::Ordering::Equal,
                    })
                }
                _ => None,
            }
        };
        let whole = Part { low: varied.low.enclosure().mid, high: varied.high.enclosure().mid };
        let covered = Cover { over: &over, side: &side, most: MOST_PARTS }.settle(vec![whole]);
        let best = match covered.rest.or_proof() {
            Rest::Empty(proof) if covered.missed.is_empty() => {
                let gap = Bound::by_proof((step.hi + 2.0 * seen.value.rad) * up::THOUSANDS);
                Best::Everywhere { gap, proof: proof.into() }
            }
            _ => Best::Seen,
        };
        Some(Outcome { within: vec![None], values: seen.values, value: seen.value, best, equal: Vec::new() })
    }
}

/// |H| without a bound, by values of the parameters.
pub(super) struct RoughPeaks {
    peaks: Peaks,
    ranges: Ranges,
}

impl RoughPeaks {
    /// The largest |H|.
    pub(super) fn highest(&self, values: &[Number]) -> Option<f64> {
        Some(self.peaks.highest(&self.ranges.units(values))?.sqrt())
    }
}

/// The middle and half the width of each range.
struct Ranges {
    list: Vec<(Dd, Dd)>,
}

impl Ranges {
    fn of(optimum: &Optimum) -> Ranges {
        let one = |low: &Number, high: &Number| {
            let (low, high) = (low.to_ball(), high.to_ball());
            let (middle, width) = ((low.mid + high.mid).scale(0.5), (high.mid - low.mid).scale(0.5));
            // Wide enough for both ends.
            (middle, width + Dd::from((low.rad + high.rad + middle.hi.abs() * 1e-30) * up::THOUSANDS))
        };
        Ranges { list: optimum.varied.iter().map(|varied| one(&varied.low, &varied.high)).collect() }
    }

    /// From -1 to 1 along each range.
    fn units(&self, values: &[Number]) -> Vec<f64> {
        let unit = |(value, (middle, width)): (&Number, &(Dd, Dd))| ((value.to_ball().mid - *middle) / *width).to_f64();
        values.iter().zip(&self.list).map(unit).collect()
    }
}
