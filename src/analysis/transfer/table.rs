//! Tables of transfer functions: which frequencies, and what is to be seen there. In: a system, its poles, what was asked.
//! Out: rows in ascending frequency, and the peaks, antiresonances and half-power widths of each pair of input and output.
//!
//! The range and the grid come from the poles; every pole gets a star of points at distances of decades, so that a zero
//! however near to it is bracketed. An extremum of |H| is a point where Re(g / g') = 0, with g = 1/H at a peak and g = H at
//! an antiresonance; it is found by secant steps kept inside their bracket. Clause: spec.md, "Transfer".

use crate::analysis::answer::{Modes, PoleKind, Poles};
use crate::analysis::numeric::complex::Complex;
use crate::analysis::transfer::modal::{ModalPair, ModalSum};
use crate::analysis::transfer::{FAST_ABOVE, Frequency, Gain, Transfer};
use crate::base::{Number, Rational};
use crate::system::LinearSystem;

/// What a table is to hold.
#[derive(Clone, Debug, Default)]
pub struct Sweep {
    /// Hz, from below to above; from the poles where it is not given.
    pub range: Option<(Number, Number)>,
    /// Points of the grid; the default grid is refined, one that is asked for is kept as it is.
    pub points: Option<usize>,
    pub linear: bool,
    /// Frequencies asked for by themselves: then there is no grid.
    pub at: Vec<Frequency>,
    /// The relative error that is good enough; without it every value is right to the last digits of binary64.
    pub tolerance: Option<f64>,
    /// Indices of inputs and outputs.
    pub inputs: Vec<usize>,
    pub outputs: Vec<usize>,
}

/// A frequency and its values.
#[derive(Clone, Debug)]
pub struct Row {
    /// Hz
    pub frequency: Number,
    /// `[input][output]`, in the order of the sweep.
    pub gains: Vec<Vec<Gain>>,
}

#[derive(Clone, Debug)]
pub struct Table {
    pub inputs: Vec<usize>,
    pub outputs: Vec<usize>,
    pub rows: Vec<Row>,
    /// Whether the extrema were looked for: on the default grid.
    pub refined: bool,
    pub features: Vec<Feature>,
}

/// What is to be seen of one pair.
#[derive(Clone, Debug)]
pub struct Feature {
    pub kind: FeatureKind,
    /// Positions in the sweep's lists.
    pub input: usize,
    pub output: usize,
    /// Hz
    pub frequency: Number,
    pub gain: Gain,
    /// Where |H| is its maximum over sqrt 2, Hz, below and above a peak.
    pub half_power: Option<(f64, f64)>,
    /// The pole that a peak belongs to, by its place in the table of poles.
    pub pole: Option<usize>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FeatureKind {
    Peak,
    Antiresonance,
}

/// Points of the default grid between the poles' stars.
const DEFAULT_POINTS: usize = 200;
/// A star reaches from a tenth of a pole's frequency down to 1e-9 of it.
const STAR: [f64; 9] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9];
/// More poles than this get no stars: the grid alone has to do.
const MOST_STARS: usize = 200;
/// Secant steps for one extremum; each wins digits, three or four are usual.
const MOST_STEPS: usize = 40;

/// The cheapest road to each value that is good enough: a sum over modes in binary64, in double-double, the solution.
#[derive(Clone, Debug)]
pub struct Roads<'a> {
    system: &'a LinearSystem,
    transfer: Transfer<'a>,
    sum: Option<ModalSum>,
}

/// Fewer frequencies than this are computed one by one.
const WORTH_SETTING_UP: usize = 8;
/// What half a unit in the last place of binary64 allows.
const TO_THE_LAST_DIGIT: f64 = 1e-17;

impl<'a> Roads<'a> {
    pub fn of(system: &'a LinearSystem, modes: &Modes) -> Roads<'a> {
        Roads { system, transfer: Transfer::of(system), sum: ModalSum::of(system, modes) }
    }

    /// `[input][output]` at one frequency.
    fn gains(&self, pairs: &Pairs, sweep: &Sweep, frequency: &Frequency) -> Vec<Vec<Gain>> {
        let tolerance = sweep.tolerance.unwrap_or(TO_THE_LAST_DIGIT);
        let by_modes = |pair: &ModalPair| -> Option<Gain> {
            let sum = self.sum.as_ref()?;
            let good = |gain: &Gain| gain.disc().is_some_and(|disc| disc.relative_error() <= tolerance);
            let fast = (tolerance >= FAST_ABOVE).then(|| sum.fast(pair, frequency)).filter(good);
            fast.or_else(|| Some(sum.accurate(pair, frequency)).filter(good))
        };
        let summed: Option<Vec<Vec<Gain>>> = pairs.iter().map(|row| row.iter().map(by_modes).collect()).collect();
        summed
            .filter(|gains| !gains.is_empty())
            .unwrap_or_else(|| self.transfer.between(frequency, &sweep.inputs, &sweep.outputs))
    }

    /// The same at many frequencies: sums in binary64 where they are good enough, then the two-sided road, several
    /// frequencies at once; one by one what is left.
    fn rows(&self, pairs: &Pairs, sweep: &Sweep, frequencies: &[Frequency]) -> Vec<Row> {
        let tolerance = sweep.tolerance.unwrap_or(TO_THE_LAST_DIGIT);
        let good = |gain: &Gain| gain.disc().is_some_and(|disc| disc.relative_error() <= tolerance);
        let outputs = sweep.outputs.len().max(1);
        let mut rows = vec![vec![Gain::Unknown; sweep.inputs.len() * sweep.outputs.len()]; frequencies.len()];
        if let Some(sum) = self.sum.as_ref().filter(|_| tolerance >= FAST_ABOVE) {
            for (at, pair) in pairs.iter().flatten().enumerate() {
                for (row, gain) in rows.iter_mut().zip(sum.fast_many(pair, frequencies)) {
                    row[at] = gain;
                }
            }
        }
        let left: Vec<usize> = (0..rows.len()).filter(|&i| !rows[i].iter().all(good)).collect();
        if left.len() >= WORTH_SETTING_UP {
            let some: Vec<Frequency> = left.iter().map(|&i| frequencies[i].clone()).collect();
            let gains = self.transfer.side_by_side(&some, &sweep.inputs, &sweep.outputs, tolerance);
            for (&i, gains) in left.iter().zip(gains.chunks(rows[0].len().max(1))) {
                rows[i].copy_from_slice(gains);
            }
        }
        let row = |(frequency, row): (&Frequency, Vec<Gain>)| Row {
            frequency: frequency.hertz.clone(),
            gains: if row.iter().all(good) {
                row.chunks(outputs).map(<[Gain]>::to_vec).collect()
            } else {
                self.gains(pairs, sweep, frequency)
            },
        };
        frequencies.iter().zip(rows).map(row).collect()
    }

    fn pairs(&self, inputs: &[usize], outputs: &[usize]) -> Pairs {
        let Some(sum) = &self.sum else { return Vec::new() };
        let row = |&input: &usize| outputs.iter().map(|&output| sum.pair(self.system, input, output)).collect();
        inputs.iter().map(row).collect()
    }
}

/// `[input][output]`; empty where there is no sum over modes.
type Pairs = Vec<Vec<ModalPair>>;

/// Computes a table.
pub fn table(roads: &Roads, poles: &Poles, sweep: &Sweep) -> Table {
    let pairs = roads.pairs(&sweep.inputs, &sweep.outputs);
    let evaluate = |frequency: &Frequency| Row {
        frequency: frequency.hertz.clone(),
        gains: roads.gains(&pairs, sweep, frequency),
    };
    let mut rows = roads.rows(&pairs, sweep, &frequencies(poles, sweep));
    let mut features = Vec::new();
    let refined = sweep.at.is_empty() && sweep.points.is_none();
    if refined {
        for input in 0..sweep.inputs.len() {
            for output in 0..sweep.outputs.len() {
                let pair = Pair {
                    roads,
                    pairs: pairs.get(input).map_or(Vec::new(), |row| vec![vec![row[output].clone()]]),
                    sweep: Sweep {
                        inputs: vec![sweep.inputs[input]],
                        outputs: vec![sweep.outputs[output]],
                        ..sweep.clone()
                    },
                    input,
                    output,
                };
                features.extend(pair.features(&rows, poles));
            }
        }
        rows.extend(features.iter().map(|feature| evaluate(&Frequency::hertz(&feature.frequency))));
        sort(&mut rows);
    }
    Table { inputs: sweep.inputs.clone(), outputs: sweep.outputs.clone(), rows, refined, features }
}

fn sort(rows: &mut Vec<Row>) {
    rows.sort_by(|a, b| a.frequency.to_f64().total_cmp(&b.frequency.to_f64()));
    rows.dedup_by(|a, b| a.frequency == b.frequency);
}

/// The frequencies of the grid, Hz, ascending.
fn frequencies(poles: &Poles, sweep: &Sweep) -> Vec<Frequency> {
    if sweep.at.is_empty() { grid(poles, sweep).iter().map(Frequency::hertz).collect() } else { sweep.at.clone() }
}

/// Hz, ascending.
fn grid(poles: &Poles, sweep: &Sweep) -> Vec<Number> {
    let (low, high) = sweep.range.clone().unwrap_or_else(|| default_range(poles));
    let points = sweep.points.unwrap_or(DEFAULT_POINTS);
    let mut list = if sweep.linear { linear(&low, &high, points) } else { logarithmic(&low, &high, points) };
    if sweep.points.is_none() {
        let inside = |f: &f64| *f > low.to_f64() && *f < high.to_f64();
        list.extend(stars(poles).into_iter().filter(inside).filter_map(from_f64));
        list.sort_by(|a, b| a.to_f64().total_cmp(&b.to_f64()));
        list.dedup_by(|a, b| a.to_f64() == b.to_f64());
    }
    list
}

fn from_f64(x: f64) -> Option<Number> {
    Rational::from_f64(x).map(Number::from)
}

/// A quarter of the lowest to four times the highest pole's frequency, rounded outwards to 1, 2 or 5 times a power of ten.
fn default_range(poles: &Poles) -> (Number, Number) {
    let two_pi = 2.0 * std::f64::consts::PI;
    let sizes = poles.list.iter().map(|pole| pole_size(pole) / two_pi).filter(|f| *f > 0.0 && f.is_finite());
    let (low, high) = sizes.fold((f64::INFINITY, 0.0f64), |(low, high), f| (low.min(f), high.max(f)));
    if high == 0.0 { (Number::from("0.1"), Number::from(10)) } else { (round_down(low / 4.0), round_up(high * 4.0)) }
}

fn pole_size(pole: &crate::analysis::answer::Pole) -> f64 {
    Complex::new(pole.re.to_f64(), pole.im.to_f64()).abs()
}

fn round_numbers() -> impl DoubleEndedIterator<Item = Number> {
    (-300..300i32).flat_map(|exponent| {
        [1, 2, 5].map(|digit| &Number::from(digit) * &Number::from(10).powi(exponent).unwrap_or(Number::ONE))
    })
}

fn round_down(x: f64) -> Number {
    round_numbers().rev().find(|n| n.to_f64() <= x).unwrap_or(Number::ONE)
}

fn round_up(x: f64) -> Number {
    round_numbers().find(|n| n.to_f64() >= x).unwrap_or(Number::ONE)
}

fn linear(low: &Number, high: &Number, points: usize) -> Vec<Number> {
    let step = &(high - low) / &Number::from((points.max(2) - 1) as i64);
    (0..points).map(|i| low + &(&step * &Number::from(i as i64))).collect()
}

/// low (high / low)^(i / (points - 1)), as binary64 numbers; the ends are exact.
fn logarithmic(low: &Number, high: &Number, points: usize) -> Vec<Number> {
    let ends = low.ln().zip(high.ln());
    let Some((from, to)) = ends else { return linear(low, high, points) };
    let step = &(&to - &from) / &Number::from((points.max(2) - 1) as i64);
    let between = |i: usize| {
        let exponent = &from + &(&step * &Number::from(i as i64));
        exponent.exp().and_then(|f| from_f64(f.to_f64()))
    };
    let mut list = vec![low.clone()];
    list.extend((1..points.saturating_sub(1)).filter_map(between));
    if points > 1 {
        list.push(high.clone());
    }
    list
}

/// The frequencies of the poles and points around them.
fn stars(poles: &Poles) -> Vec<f64> {
    let mut list = Vec::new();
    for pole in poles.list.iter().filter(|pole| pole.im.to_f64() > 0.0).take(MOST_STARS) {
        let f = pole.im.to_f64() / (2.0 * std::f64::consts::PI);
        list.push(f);
        for distance in STAR {
            list.extend([f * (1.0 - distance), f * (1.0 + distance)]);
        }
        // Three points of each half-power width.
        let width = pole.re.to_f64().abs() / (2.0 * std::f64::consts::PI);
        list.extend([f - width, f + width, f - 0.5 * width, f + 0.5 * width].into_iter().filter(|f| *f > 0.0));
    }
    list
}

/// One input and one output.
struct Pair<'a> {
    roads: &'a Roads<'a>,
    pairs: Pairs,
    sweep: Sweep,
    input: usize,
    output: usize,
}

impl Pair<'_> {
    fn gain(&self, f: f64) -> Gain {
        let Some(frequency) = from_f64(f) else { return Gain::Unknown };
        self.roads.gains(&self.pairs, &self.sweep, &Frequency::hertz(&frequency))[0][0]
    }

    /// Every bracketed extremum of |H|.
    fn features(&self, rows: &[Row], poles: &Poles) -> Vec<Feature> {
        let gains: Vec<Gain> = rows.iter().map(|row| row.gains[self.input][self.output]).collect();
        let sizes: Vec<f64> = gains.iter().map(|gain| size(*gain)).collect();
        let mut features = Vec::new();
        for i in 1..rows.len().saturating_sub(1) {
            let bracket = [i - 1, i, i + 1].map(|at| rows[at].frequency.to_f64());
            let (left, here, right) = (sizes[i - 1], sizes[i], sizes[i + 1]);
            // Between two values without a digit there is nothing but rounding.
            if !(is_told(gains[i - 1]) && is_told(gains[i + 1])) {
                continue;
            }
            if here > left && here >= right {
                features.extend(self.peak(bracket, poles));
            } else if here < left && here <= right {
                features.extend(self.antiresonance(bracket));
            }
        }
        features
    }

    fn peak(&self, bracket: [f64; 3], poles: &Poles) -> Option<Feature> {
        let pole = nearest_pole(poles, bracket);
        let undamped = pole.is_some_and(|i| poles.list[i].re.is_zero());
        let f = if let (true, Some(i)) = (undamped, pole) {
            poles.list[i].im.to_f64() / (2.0 * std::f64::consts::PI)
        } else {
            self.extremum(bracket, |h| h.recip())?
        };
        let gain = if undamped { Gain::Infinite } else { self.gain(f) };
        let half_power = if undamped { None } else { self.half_power(f, size(gain)) };
        Some(Feature { half_power, pole, ..self.feature(FeatureKind::Peak, f, gain)? })
    }

    fn antiresonance(&self, bracket: [f64; 3]) -> Option<Feature> {
        let f = self.extremum(bracket, |h| h)?;
        self.feature(FeatureKind::Antiresonance, f, self.gain(f))
    }

    fn feature(&self, kind: FeatureKind, f: f64, gain: Gain) -> Option<Feature> {
        let (input, output) = (self.input, self.output);
        Some(Feature { kind, input, output, frequency: from_f64(f)?, gain, half_power: None, pole: None })
    }

    /// The minimum of |g(H)| inside a bracket: the tangent through two points has a complex zero; its real part is next.
    fn extremum(&self, bracket: [f64; 3], g: impl Fn(Complex<f64>) -> Complex<f64>) -> Option<f64> {
        let [mut low, mut best, mut high] = bracket;
        let at = |f: f64| self.gain(f).disc().map(|disc| g(disc.value.to_f64()));
        let mut value = at(best)?;
        // The other point of the secant, close by: a tangent.
        let mut other = best + 1e-7 * (high - best);
        let mut other_value = at(other)?;
        for _ in 0..MOST_STEPS {
            let slope = (value - other_value).scale(1.0 / (best - other));
            let mut next = best - (value * slope.recip()).re;
            if !(next > low && next < high) {
                // A golden step into the larger side.
                next = if high - best > best - low {
                    best + 0.381966 * (high - best)
                } else {
                    best - 0.381966 * (best - low)
                };
            }
            if next == best || (high - low) <= 4.0 * f64::EPSILON * best {
                break;
            }
            let next_value = at(next)?;
            let better = next_value.abs() < value.abs();
            let (inner, outer) = if better { (next, best) } else { (best, next) };
            if outer < inner {
                low = outer
            } else {
                high = outer
            }
            (other, other_value) = if better { (best, value) } else { (next, next_value) };
            if better {
                let step = (next - best).abs();
                (best, value) = (next, next_value);
                if step <= 2.0 * f64::EPSILON * best {
                    break;
                }
            }
        }
        Some(best)
    }

    /// Where |H| falls to 1 / sqrt 2 of a peak, on both sides; `None` where it does not before it rises again.
    fn half_power(&self, f: f64, peak: f64) -> Option<(f64, f64)> {
        Some((self.crossing(f, peak, -1.0)?, self.crossing(f, peak, 1.0)?))
    }

    fn crossing(&self, f: f64, peak: f64, direction: f64) -> Option<f64> {
        let excess = |f: f64| {
            let h = size(self.gain(f));
            2.0 * h * h / (peak * peak) - 1.0
        };
        let (mut inside, mut step, mut last) = (f, 1e-9 * f, 1.0f64);
        let mut outside = loop {
            let next = f + direction * step;
            if next <= 0.0 || step > f {
                return None;
            }
            let here = excess(next);
            if here <= 0.0 {
                break next;
            }
            // Rising again: the shoulder of another peak.
            if here > last * 1.01 {
                return None;
            }
            (inside, last) = (next, here);
            step *= 2.0;
        };
        // Inverse quadratic in the distance near the peak; bisection is safe and each step is cheap.
        for _ in 0..50 {
            let middle = 0.5 * (inside + outside);
            if (outside - inside).abs() <= 1e-13 * f {
                break;
            }
            if excess(middle) > 0.0 { inside = middle } else { outside = middle }
        }
        Some(0.5 * (inside + outside))
    }
}

/// Whether a value has a digit, or is infinite.
fn is_told(gain: Gain) -> bool {
    gain.disc().is_none_or(|disc| disc.relative_error() <= 0.1)
}

/// |H| to compare by.
fn size(gain: Gain) -> f64 {
    match gain {
        Gain::Finite(disc) => disc.value.to_f64().abs(),
        _ => f64::INFINITY,
    }
}

/// The pole with a positive imaginary part nearest to the middle of a bracket, if it is inside.
fn nearest_pole(poles: &Poles, bracket: [f64; 3]) -> Option<usize> {
    let two_pi = 2.0 * std::f64::consts::PI;
    let distance = |i: usize| (poles.list[i].im.to_f64() / two_pi - bracket[1]).abs();
    let candidates = (0..poles.list.len()).filter(|&i| {
        let pole = &poles.list[i];
        let f = pole.im.to_f64() / two_pi;
        // A peak lies within about a half-power width of its pole.
        let width = pole.re.to_f64().abs() / two_pi;
        pole.kind == PoleKind::Oscillation && f > 0.0 && f + 2.0 * width >= bracket[0] && f - 2.0 * width <= bracket[2]
    });
    candidates.min_by(|&a, &b| distance(a).total_cmp(&distance(b)))
}
