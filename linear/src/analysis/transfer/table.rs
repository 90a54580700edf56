//! Tables of transfer functions: their frequencies and features. In: a system, its poles, a request. Out: rows in
//! ascending frequency, and the peaks, antiresonances and half-power widths of each pair of input and output.
//!
//! The range and the grid come from the poles; every pole gets a star of points at distances in decades, so that a zero
//! however close to it is bracketed. Extrema: see `extrema`. See docs/method/transfer.md.

mod later_modes;

use crate::analysis::answer::{Modes, Poles};
use crate::analysis::error::AnalysisError;
use crate::analysis::modes::modes_as;
use crate::analysis::modes::request::Request;
use crate::analysis::poles::{MAX_DAMPED, poles, poles_and_residues};
use crate::analysis::transfer::around::Surroundings;
use crate::analysis::transfer::extrema::{
    Exactly, Extrema, Extremum, MOST_ENCLOSED, bracket, by_expansion, by_path, sharpen,
};
use crate::analysis::transfer::modal::{ModalPair, ModalSum};
use crate::analysis::transfer::partial_fractions::PartialFractions;
use crate::analysis::transfer::{FAST_ABOVE, Frequency, Gain, TO_THE_LAST_DIGIT, Transfer};
use crate::base::{Number, OrderBy, Rational};
use crate::kernel::complex::Complex;
use crate::system::LinearSystem;

/// The requested content of a table.
#[derive(Clone, Debug, Default)]
pub struct Sweep {
    /// Lower and upper end, Hz; from the poles if not given.
    pub range: Option<(Number, Number)>,
    /// Number of grid points; the default grid is refined, a requested one is used unchanged.
    pub points: Option<usize>,
    pub linear: bool,
    /// Single frequencies, if requested; there is then no grid.
    pub at: Vec<Frequency>,
    /// The relative error that is sufficient; if not given, every value is correct to the last digits of binary64.
    pub tolerance: Option<f64>,
    /// Whether only the ends of the range and the extrema are needed in a table without a requested grid. If these are
    /// proved from zeros and poles, no grid is computed.
    pub features_only: bool,
    /// Indices of inputs and outputs.
    pub inputs: Vec<usize>,
    pub outputs: Vec<usize>,
}

impl Sweep {
    /// Whether the frequencies come from the poles, or extrema are looked for.
    pub fn needs_poles(&self) -> bool {
        self.at.is_empty() && (self.points.is_none() || self.range.is_none())
    }

    /// An error if a table with this many rows does not fit into memory.
    fn refuse_too_large(&self, system: &LinearSystem, rows: usize) -> Result<(), AnalysisError> {
        let pairs = self.inputs.len().saturating_mul(self.outputs.len());
        let besides = OF_A_PAIR + if self.finds_extrema() { system.n() / 2 } else { 0 };
        let most = MOST_VALUES / rows.saturating_add(besides).max(1);
        match self.inputs.first().filter(|_| pairs > most) {
            Some(&input) => {
                let at = system.inputs[input].span;
                Err(AnalysisError::TooManyPairs { pairs, frequencies: rows, most, at })
            }
            None => Ok(()),
        }
    }

    /// The rows that the table has for certain, before poles and extrema are known.
    fn least_rows(&self) -> usize {
        match self.points {
            _ if !self.at.is_empty() => self.at.len(),
            Some(points) => points,
            None => 2,
        }
    }

    /// Whether extrema are looked for: then no grid is given.
    pub fn finds_extrema(&self) -> bool {
        self.at.is_empty() && self.points.is_none()
    }
}

/// The values of a table, each 48 bytes as an enclosure and up to 500 as the text of a report: 1 to 2 GB for this many.
const MOST_VALUES: usize = 4_000_000;
/// A pair takes as much memory as this many values for what is prepared and what is said of it. Where its extrema are looked for, it
/// takes half a value more for each coordinate, of whose modes it has the residues.
const OF_A_PAIR: usize = 10;

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
    /// The extrema of each pair, `[input][output]`; `None` if a grid was requested.
    pub extrema: Option<Vec<Vec<Extrema>>>,
}

/// Number of points of the default grid, without those of the poles' stars.
const DEFAULT_POINTS: usize = 200;
/// A star reaches from a tenth of a pole's frequency down to 1e-9 of it.
const STAR: [f64; 9] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9];

/// Chooses the cheapest sufficient method for each value: a sum over modes in binary64 or in double-double, or the
/// solution.
#[derive(Clone, Debug)]
pub struct Methods<'a> {
    system: &'a LinearSystem,
    transfer: Transfer<'a>,
    sum: Option<ModalSum>,
}

/// The prepared computations for one input and one output.
#[derive(Clone, Debug)]
struct Pair<'a> {
    modal: Option<ModalPair>,
    exactly: Option<&'a Exactly>,
    fractions: Option<PartialFractions>,
}

/// Fewer frequencies than this are computed one by one.
const WORTH_SETTING_UP: usize = 8;

impl<'a> Methods<'a> {
    pub fn of(system: &'a LinearSystem, modes: &Modes) -> Methods<'a> {
        let sum = if system.losses.is_none() { ModalSum::of(system, modes) } else { None };
        Methods { system, transfer: Transfer::of(system), sum }
    }

    /// The gains at one frequency, `[input][output]`.
    fn gains(&self, pairs: &Pairs, sweep: &Sweep, frequency: &Frequency) -> Vec<Vec<Gain>> {
        let tolerance = sweep.tolerance.unwrap_or(TO_THE_LAST_DIGIT);
        let by_pair = |pair: &Pair| -> Option<Gain> {
            let good = |gain: &Gain| is_within(gain, tolerance);
            let exactly = pair.exactly.map(|method| method.gain(frequency)).filter(good);
            let by_modes = || {
                let (sum, modal) = self.sum.as_ref().zip(pair.modal.as_ref())?;
                Some(sum.accurate(modal, frequency)).filter(good)
            };
            let by_poles = || pair.fractions.as_ref().map(|sum| sum.gain(frequency)).filter(good);
            exactly.or_else(by_modes).or_else(by_poles)
        };
        let pairwise: Option<Vec<Vec<Gain>>> = pairs.iter().map(|row| row.iter().map(by_pair).collect()).collect();
        pairwise
            .filter(|gains| !gains.is_empty())
            .unwrap_or_else(|| self.transfer.between(frequency, &sweep.inputs, &sweep.outputs))
    }

    /// Rows at many frequencies: sums in binary64 if they are accurate enough, then the two-sided method for several
    /// frequencies at once; the remaining ones one by one.
    fn rows(&self, pairs: &Pairs, sweep: &Sweep, frequencies: &[Frequency]) -> Vec<Row> {
        let tolerance = sweep.tolerance.unwrap_or(TO_THE_LAST_DIGIT);
        let good = |gain: &Gain| is_within(gain, tolerance);
        let outputs = sweep.outputs.len().max(1);
        let mut rows = vec![vec![Gain::Unknown; sweep.inputs.len() * sweep.outputs.len()]; frequencies.len()];
        if let Some(sum) = self.sum.as_ref().filter(|_| tolerance >= FAST_ABOVE) {
            for (at, pair) in pairs.iter().flatten().enumerate() {
                let Some(modal) = &pair.modal else { continue };
                for (row, gain) in rows.iter_mut().zip(sum.fast(modal, frequencies)) {
                    row[at] = gain;
                }
            }
        }
        let left: Vec<usize> = (0..rows.len()).filter(|&i| !rows[i].iter().all(good)).collect();
        // Products over zeros and poles and sums over poles, if available, are fast enough.
        let at_hand = pairs.iter().flatten().all(|pair| pair.exactly.is_some() || pair.fractions.is_some());
        if left.len() >= WORTH_SETTING_UP && !at_hand && self.system.losses.is_none() {
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

    /// Zeros and poles are only computed if extrema are requested.
    fn pairs(&self, poles: &Poles, sweep: &Sweep, refined: bool) -> Pairs<'_> {
        let pair = |input: usize, output: usize| {
            let modal = self.sum.as_ref().map(|sum| sum.pair(self.system, input, output));
            let exactly = if refined { self.transfer.zero_pole_form(input, output) } else { None };
            let of_modes = || self.sum.as_ref()?.fractions(modal.as_ref()?);
            let fractions = match poles.residues.as_ref().filter(|_| refined) {
                Some(residues) => PartialFractions::of(self.system, residues, input, output),
                None if refined && exactly.is_none() => of_modes(),
                None => None,
            };
            Pair { modal, exactly, fractions }
        };
        let row = |&input: &usize| sweep.outputs.iter().map(|&output| pair(input, output)).collect();
        sweep.inputs.iter().map(row).collect()
    }
}

/// The poles that a table needs, with sums over them if exact arithmetic does not find the zeros of every pair.
pub fn poles_for_table(system: &LinearSystem, modes: &Modes) -> Result<Poles, AnalysisError> {
    if system.n() <= MOST_ENCLOSED { poles(system, modes) } else { poles_and_residues(system, modes) }
}

/// All modes of a system with more coupled coordinates than those of which all are computed in any case: where extrema are looked
/// for they take less time than the tables, up to as many coordinates as have poles. `None` if there are too many.
pub fn modes_of_many(system: &LinearSystem) -> Option<Modes> {
    let fits = system.n() <= MAX_DAMPED && system.losses.is_none();
    let request = Request::default().without_shares();
    if fits { modes_as(system, &request).ok() } else { None }
}

/// A table whose range holds few of the poles of a larger system: all of its extrema at the cost of what is in and around the range.
/// `None` where they are not proved so.
pub fn table_around(system: &LinearSystem, sweep: &Sweep) -> Result<Option<Table>, AnalysisError> {
    sweep.refuse_too_large(system, sweep.least_rows())?;
    enclose_around(system, sweep).transpose()
}

fn enclose_around(system: &LinearSystem, sweep: &Sweep) -> Option<Result<Table, AnalysisError>> {
    let suits = sweep.finds_extrema() && system.losses.is_none() && system.n() > ALL_AT_HAND;
    let (low, high) = sweep.range.as_ref().filter(|_| suits)?;
    let [low_omega, high_omega] = [low, high].map(|hertz| Frequency::hertz(hertz).omega);
    let suits = high_omega.is_finite() && !high_omega.contains_zero() && !low_omega.is_negative();
    let methods = suits.then(|| Methods::of(system, &Modes::default()))?;
    let (inputs, outputs) = (sweep.inputs.clone(), sweep.outputs.clone());
    let reach = high_omega.to_f64() * (1.0 + BEYOND);
    let surroundings = Surroundings::of(&methods.transfer, &inputs, &outputs, reach)?;
    let pair = |i: usize, o: usize| {
        let fractions = surroundings.pair(&methods.transfer, (i, inputs[i]), (o, outputs[o]))?;
        Some(Pair { modal: None, exactly: None, fractions: Some(fractions) })
    };
    let row = |i: usize| (0..outputs.len()).map(|o| pair(i, o)).collect();
    let pairs: Pairs = (0..inputs.len()).map(row).collect::<Option<_>>()?;
    let of_pair = |i: usize, o: usize| {
        let found = by_expansion(pairs[i][o].fractions.as_ref()?, low_omega, high_omega);
        let is_complete = found.is_complete();
        is_complete.then(|| sharpen(&methods.transfer, inputs[i], outputs[o], found))
    };
    let extrema: Vec<Vec<Extrema>> =
        (0..inputs.len()).map(|i| (0..outputs.len()).map(|o| of_pair(i, o)).collect()).collect::<Option<_>>()?;
    let at = match sweep.features_only {
        true => vec![low.clone(), high.clone()],
        false => grid_about((low, high), surroundings.poles().map(|s| [s.re.to_f64(), s.im.to_f64()]), sweep),
    };
    let rows = || {
        sweep.refuse_too_large(system, at.len())?;
        let at: Vec<Frequency> = at.iter().map(Frequency::hertz).collect();
        let mut rows = methods.rows(&pairs, sweep, &at);
        if !sweep.features_only {
            add_rows(&methods, &pairs, sweep, &extrema, &mut rows)?;
        }
        Ok(rows)
    };
    Some(rows().map(|rows| Table { inputs, outputs, rows, extrema: Some(extrema) }))
}

/// Up to this many coordinates, all poles take no longer than those around a range.
const ALL_AT_HAND: usize = 150;

/// How far H is known beyond the range, as a part of its end: for half-power points beside a peak at the end.
const BEYOND: f64 = 0.05;

/// Prepared pairs, `[input][output]`.
type Pairs<'a> = Vec<Vec<Pair<'a>>>;

/// Computes a table. The poles may be those of nothing where it [has no use for them](Sweep::needs_poles).
pub fn table(methods: &Methods, poles: &Poles, sweep: &Sweep) -> Result<Table, AnalysisError> {
    let system = methods.system;
    sweep.refuse_too_large(system, sweep.least_rows())?;
    let refined = sweep.finds_extrema() && methods.system.losses.is_none();
    let pairs = methods.pairs(poles, sweep, refined);
    let (inputs, outputs) = (sweep.inputs.clone(), sweep.outputs.clone());
    if !refined {
        let at = frequencies(poles, sweep);
        sweep.refuse_too_large(system, at.len())?;
        let rows = later_modes::rows(methods, &pairs, sweep, &at);
        return Ok(Table { inputs, outputs, rows, extrema: None });
    }
    let range = sweep.range.clone().unwrap_or_else(|| default_range(poles));
    let from_roots = from_roots(methods, poles, sweep, &pairs, &range);
    if sweep.features_only && from_roots.iter().flatten().all(Extrema::is_complete) {
        let ends = [&range.0, &range.1].map(Frequency::hertz);
        let rows = methods.rows(&pairs, sweep, &ends);
        return Ok(Table { inputs, outputs, rows, extrema: Some(from_roots) });
    }
    let at = frequencies(poles, sweep);
    sweep.refuse_too_large(system, at.len())?;
    let mut rows = methods.rows(&pairs, sweep, &at);
    let extrema = beside_brackets(methods, poles, sweep, &pairs, &rows, from_roots);
    add_rows(methods, &pairs, sweep, &extrema, &mut rows)?;
    Ok(Table { inputs, outputs, rows, extrema: Some(extrema) })
}

/// Adds rows at the extrema, each of which has one value for every pair.
fn add_rows(
    methods: &Methods,
    pairs: &Pairs,
    sweep: &Sweep,
    extrema: &[Vec<Extrema>],
    rows: &mut Vec<Row>,
) -> Result<(), AnalysisError> {
    // A value next to an undamped pole may need an inverse of its own: one row is enough where |H| is infinite.
    let has_row = |extremum: &Extremum| {
        let hertz = extremum.frequency.to_f64();
        let is_there = |row: &Row| (row.frequency.to_f64() - hertz).abs() <= 2.0 * f64::EPSILON * hertz;
        extremum.gain == Gain::Infinite && rows.iter().any(is_there)
    };
    let at = extrema.iter().flatten().flat_map(|extrema| &extrema.list).filter(|extremum| !has_row(extremum));
    // The binary64 number that is printed: next to a lightly damped pole |H| differs there from the value at the
    // peak itself.
    let mut hertz: Vec<f64> = at.map(|extremum| extremum.frequency.to_f64()).collect();
    // Pairs of one part have their peaks at the same frequencies, and a row has the values of all pairs.
    hertz.sort_by(f64::total_cmp);
    hertz.dedup();
    sweep.refuse_too_large(methods.system, rows.len() + hertz.len())?;
    let more = (hertz.into_iter().filter_map(from_f64))
        .map(|hertz| Row { gains: methods.gains(pairs, sweep, &Frequency::hertz(&hertz)), frequency: hertz });
    let more: Vec<Row> = more.collect();
    rows.extend(more);
    sort(rows);
    Ok(())
}

/// Whether a value is known to a relative error.
fn is_within(gain: &Gain, tolerance: f64) -> bool {
    gain.disc().is_some_and(|disc| disc.relative_error() <= tolerance)
}

/// The extrema of each pair that its zeros and poles prove, `[input][output]`; empty if these are not known.
fn from_roots(
    methods: &Methods,
    poles: &Poles,
    sweep: &Sweep,
    pairs: &Pairs,
    (low, high): &(Number, Number),
) -> Vec<Vec<Extrema>> {
    let omega = |hertz: &Number| Frequency::hertz(hertz).omega;
    let (low, high) = (omega(low), omega(high));
    let of_pair = |i: usize, o: usize| {
        let found = pairs[i][o].exactly.map(|method| method.extrema(low, high));
        if let Some(found) = found.as_ref().filter(|found| found.is_complete()) {
            let is_loose = pairs[i][o].exactly.is_some_and(Exactly::has_loose_roots);
            let sharper = || sharpen(&methods.transfer, sweep.inputs[i], sweep.outputs[o], found.clone());
            return if is_loose { sharper() } else { found.clone() };
        }
        let of_poles = pairs[i][o].fractions.as_ref().map(|sum| by_expansion(sum, low, high));
        let sharp = |extrema: &&Extrema| {
            let is_sharp = |extremum: &Extremum| match extremum.gain {
                Gain::Finite(disc) => disc.relative_error() <= TO_THE_LAST_DIGIT,
                Gain::Infinite => true,
                Gain::Unknown => false,
            };
            extrema.is_complete() && extrema.list.iter().all(is_sharp)
        };
        if let Some(found) = of_poles.as_ref().filter(sharp) {
            return found.clone();
        }
        let along_path = || {
            let factored = by_path(&methods.transfer, poles, sweep.inputs[i], sweep.outputs[o])?;
            let found = Exactly::of(&factored)?.extrema(low, high);
            found.is_complete().then_some(found)
        };
        match along_path() {
            Some(found) => sharpen(&methods.transfer, sweep.inputs[i], sweep.outputs[o], found),
            None => of_poles.or(found).unwrap_or_default(),
        }
    };
    (0..sweep.inputs.len()).map(|i| (0..sweep.outputs.len()).map(|o| of_pair(i, o)).collect()).collect()
}

/// The extrema that are proved complete; for other pairs, also those that the rows bracket.
fn beside_brackets(
    methods: &Methods,
    poles: &Poles,
    sweep: &Sweep,
    pairs: &Pairs,
    rows: &[Row],
    from_roots: Vec<Vec<Extrema>>,
) -> Vec<Vec<Extrema>> {
    let of_pair = |i: usize, o: usize, found: Extrema| {
        if found.is_complete() {
            return found;
        }
        let gains: Vec<(f64, Gain)> = rows.iter().map(|row| (row.frequency.to_f64(), row.gains[i][o])).collect();
        let by_modes = methods.sum.as_ref().zip(pairs[i][o].modal.as_ref());
        let places = (sweep.inputs[i], sweep.outputs[o]);
        let others = bracket(&methods.transfer, places, by_modes, poles, &gains, &found.open);
        if found.list.is_empty() && found.open.is_empty() { others } else { found.with(others.list) }
    };
    let row =
        |(i, row): (usize, Vec<Extrema>)| row.into_iter().enumerate().map(|(o, found)| of_pair(i, o, found)).collect();
    from_roots.into_iter().enumerate().map(row).collect()
}

fn sort(rows: &mut Vec<Row>) {
    rows.order_by(|a, b| a.frequency.to_f64().total_cmp(&b.frequency.to_f64()));
    rows.dedup_by(|a, b| a.frequency == b.frequency);
}

/// The frequencies of the grid, Hz, ascending.
fn frequencies(poles: &Poles, sweep: &Sweep) -> Vec<Frequency> {
    if sweep.at.is_empty() { grid(poles, sweep).iter().map(Frequency::hertz).collect() } else { sweep.at.clone() }
}

/// The grid in Hz, ascending.
fn grid(poles: &Poles, sweep: &Sweep) -> Vec<Number> {
    let (low, high) = sweep.range.clone().unwrap_or_else(|| default_range(poles));
    grid_about((&low, &high), poles.list.iter().map(|pole| [pole.re.to_f64(), pole.im.to_f64()]), sweep)
}

/// The grid between two ends, with points about these poles, rad/s.
fn grid_about((low, high): (&Number, &Number), poles: impl Iterator<Item = [f64; 2]>, sweep: &Sweep) -> Vec<Number> {
    let points = sweep.points.unwrap_or(DEFAULT_POINTS);
    let mut list = if sweep.linear { linear(low, high, points) } else { logarithmic(low, high, points) };
    if sweep.points.is_none() {
        let inside = |f: &f64| *f > low.to_f64() && *f < high.to_f64();
        list.extend(stars(poles).into_iter().filter(inside).filter_map(from_f64));
        list.order_by(|a, b| a.to_f64().total_cmp(&b.to_f64()));
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

/// 1, 2 and 5 times the powers of ten around x, ascending.
fn round_numbers(x: f64) -> impl DoubleEndedIterator<Item = Number> {
    let decade = libm::log10(x).floor().clamp(-300.0, 300.0) as i32;
    (decade - 1..decade + 3).flat_map(|exponent| {
        [1, 2, 5].map(|digit| &Number::from(digit) * &Number::from(10).powi(exponent).unwrap_or(Number::ONE))
    })
}

fn round_down(x: f64) -> Number {
    round_numbers(x).rev().find(|n| n.to_f64() <= x).unwrap_or(Number::ONE)
}

fn round_up(x: f64) -> Number {
    round_numbers(x).find(|n| n.to_f64() >= x).unwrap_or(Number::ONE)
}

/// Evenly spaced numbers with both ends.
pub(in crate::analysis) fn linear(low: &Number, high: &Number, points: usize) -> Vec<Number> {
    let step = &(high - low) / &Number::from((points.max(2) - 1) as i64);
    (0..points).map(|i| low + &(&step * &Number::from(i as i64))).collect()
}

/// low (high / low)^(i / (points - 1)), as binary64 numbers; the ends are exact.
pub(in crate::analysis) fn logarithmic(low: &Number, high: &Number, points: usize) -> Vec<Number> {
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
fn stars(poles: impl Iterator<Item = [f64; 2]>) -> Vec<f64> {
    let mut list = Vec::new();
    for [re, im] in poles.filter(|[_, im]| *im > 0.0) {
        let f = im / (2.0 * std::f64::consts::PI);
        list.push(f);
        for distance in STAR {
            list.extend([f * (1.0 - distance), f * (1.0 + distance)]);
        }
        // The ends of each half-power width, and points halfway to them.
        let width = re.abs() / (2.0 * std::f64::consts::PI);
        list.extend([f - width, f + width, f - 0.5 * width, f + 0.5 * width].into_iter().filter(|f| *f > 0.0));
    }
    list
}
