//! Signals as solutions of linear equations: a harmonic is the state of an undamped oscillator, any other signal is
//! piecewise a polynomial, the state of a chain of integrators. Steps, ramps, pulses, harmonics and tables are exact; a
//! chirp is a sequence of Taylor polynomials with a bounded remainder. In: the model's declarations, in SI units. Out:
//! breakpoints and coefficients. Every signal is zero before t = 0. See docs/method/response.md.

use crate::base::{Ball, Number, Power};
use crate::system::{Course, Signal, Table};
use std::cmp::Ordering;

/// u(t) = sum c_k (t - at)^k / k! from `at` to the start of the next piece.
#[derive(Clone, Debug)]
pub struct Piece {
    pub at: Number,
    /// u, u', u'', ... at `at`, up to the last nonzero one; empty if the signal is off.
    pub derivatives: Vec<Number>,
    /// Whether u and u' may jump here; they do not if a smooth signal is divided into pieces.
    pub jump: bool,
}

/// A signal, prepared for computation.
#[derive(Clone, Debug)]
pub enum Source {
    /// amplitude sin(omega t + phase) from the time `at` on; sine and cosine of the phase
    Harmonic { amplitude: Ball, omega: Ball, sine: Ball, cosine: Ball, at: Number },
    /// Zero before the first piece. `error` bounds |u - piece|; the bound for each further derivative is `rise` times
    /// larger.
    Pieces { order: usize, pieces: Vec<Piece>, error: f64, rise: f64 },
    /// An impulse at one time.
    Impulse { value: Ball, at: Number },
}

/// Error: the signal needs more pieces than fit into memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooManyPieces;

/// Degree of the polynomials of a chirp.
const CHIRP_DEGREE: usize = 15;
/// Phase that one polynomial of a chirp covers, rad.
const CHIRP_PHASE: f64 = 0.25;
const MOST_PIECES: usize = 1_000_000;
/// Limit on the rows of a periodic table, all periods together: some ten seconds of work; more is probably a mistake.
const MOST_REPEATED: f64 = 200_000.0;

impl Source {
    /// A signal as a source; a chirp is cut so that `step`, if given, is a multiple of its pieces. A periodic signal is
    /// written out up to `until`, without which it has no end.
    pub fn of(signal: &Signal, step: Option<&Number>, until: Option<&Number>) -> Result<Source, TooManyPieces> {
        Ok(match signal {
            Signal::Step { value, at } => polynomial(vec![jump(at, &[value])]),
            Signal::Impulse { value, at } => Source::Impulse { value: value.to_ball(), at: at.clone() },
            Signal::Ramp { value, from, to } => ramp(value, from, to),
            Signal::Pulse { value, from, to } => polynomial(vec![jump(from, &[value]), jump(to, &[&Number::ZERO])]),
            Signal::Harmonic { value, frequency, phase, at } => harmonic(value, frequency, phase, at),
            Signal::Chirp { value, from, to, duration, at, phase } => {
                chirp(&Wave { value, from, to, duration, at, phase }, step)?
            }
            Signal::Table(rows) => match &rows.period {
                None => polynomial(table(rows)),
                Some(period) => polynomial(repeat(rows, period, until.ok_or(TooManyPieces)?)?),
            },
            Signal::Integral { of, times } => {
                (0..*times).fold(Source::of(of, step, until)?, |source, _| source.integral())
            }
            Signal::Delayed { of, by } => Source::of(of, step, until)?.delay(by),
        })
    }
}

impl Source {
    /// Number of states that the source needs.
    pub fn order(&self) -> usize {
        match self {
            Source::Harmonic { .. } => 2,
            Source::Pieces { order, .. } => *order,
            Source::Impulse { .. } => 0,
        }
    }

    /// A bound of the error of the k-th derivative of its pieces.
    pub fn approximation(&self, k: usize) -> f64 {
        match self {
            Source::Pieces { error, rise, .. } if *error > 0.0 => error * rise.power(k as i32),
            _ => 0.0,
        }
    }

    /// The times of its events.
    pub fn events(&self) -> Vec<&Number> {
        match self {
            Source::Harmonic { at, .. } => vec![at],
            Source::Pieces { pieces, .. } => pieces.iter().map(|piece| &piece.at).collect(),
            Source::Impulse { at, .. } => vec![at],
        }
    }
}

impl Piece {
    /// A piece that may begin with a jump.
    pub fn jump(at: Number, mut derivatives: Vec<Number>) -> Piece {
        while derivatives.last().is_some_and(Number::is_zero) {
            derivatives.pop();
        }
        Piece { at, derivatives, jump: true }
    }

    /// u and u' at a later time.
    pub fn values_after(&self, time: &Number) -> [Number; 2] {
        let t = time - &self.at;
        [taylor(&self.derivatives, &t), taylor(self.derivatives.get(1..).unwrap_or_default(), &t)]
    }
}

impl Piece {
    /// All derivatives at a time, from `at` on.
    pub fn at_time(&self, time: &Number) -> Vec<Ball> {
        let t = time - &self.at;
        (0..self.derivatives.len()).map(|k| taylor(&self.derivatives[k..], &t).to_ball()).collect()
    }
}

/// sum d_k t^k / k!
pub fn taylor(derivatives: &[Number], t: &Number) -> Number {
    let mut sum = Number::ZERO;
    for (k, d) in derivatives.iter().enumerate().rev() {
        let scaled = &(&sum * t) / &Number::from(k as i64 + 1);
        sum = &scaled + d;
    }
    sum
}

fn jump(at: &Number, derivatives: &[&Number]) -> Piece {
    Piece::jump(at.clone(), derivatives.iter().map(|&d| d.clone()).collect())
}

fn polynomial(pieces: Vec<Piece>) -> Source {
    pieces_from_zero(pieces, 0.0, 1.0)
}

/// Moves pieces that begin before t = 0 to t = 0.
fn pieces_from_zero(pieces: Vec<Piece>, error: f64, rise: f64) -> Source {
    let order = pieces.iter().map(|piece| piece.derivatives.len()).max().unwrap_or(0);
    let mut kept: Vec<Piece> = Vec::with_capacity(pieces.len());
    for piece in pieces {
        if !piece.at.is_negative() {
            kept.push(piece);
            continue;
        }
        let at_zero = Number::ZERO;
        let shift = &at_zero - &piece.at;
        let derivatives = (0..piece.derivatives.len()).map(|k| taylor(&piece.derivatives[k..], &shift)).collect();
        kept.clear();
        kept.push(Piece::jump(at_zero, derivatives));
    }
    Source::Pieces { order, pieces: kept, error, rise }
}

fn ramp(value: &Number, from: &Number, to: &Number) -> Source {
    match value.checked_div(&(to - from)) {
        Some(slope) => polynomial(vec![jump(from, &[&Number::ZERO, &slope]), jump(to, &[value])]),
        None => polynomial(vec![jump(from, &[value])]),
    }
}

fn harmonic(value: &Number, frequency: &Number, phase: &Number, at: &Number) -> Source {
    let omega = &(&Number::pi() * &Number::from(2)) * frequency;
    // If no digit of the phase is left, sine and cosine are unknown.
    let unknown = || (Number::Ball(Ball::from(0.0).widen(1.0)), Number::Ball(Ball::from(0.0).widen(1.0)));
    let (sine, cosine) = phase.sin_cos().unwrap_or_else(unknown);
    Source::Harmonic {
        amplitude: value.to_ball(),
        omega: omega.to_ball(),
        sine: sine.to_ball(),
        cosine: cosine.to_ball(),
        at: at.clone(),
    }
}

/// Polynomials of degree 15 that each cover a quarter of a radian at most. With phase rate w <= W on the piece of length h,
/// |d^k/dt^k| of exp(i phase) is below k! e^(1.1 W r) / r^k on a circle of radius r = 16 / W around its start (the rate grows
/// by less than a tenth on it, else the pieces are shorter), so the remainder is below 2 (e^1.1 W h / 16)^16 < 1e-20.
fn chirp(wave: &Wave, step: Option<&Number>) -> Result<Source, TooManyPieces> {
    let Wave { value, from, to, duration, at: begin, phase: own } = *wave;
    let two_pi = &Number::pi() * &Number::from(2);
    let (w0, w1) = (&two_pi * from, &two_pi * to);
    let Some(sweep) = (&w1 - &w0).checked_div(duration) else { return Ok(polynomial(Vec::new())) };
    let fastest = w0.abs().to_f64().max(w1.abs().to_f64());
    // Within 16 / W the phase may curve by sweep r^2 / 2: this is counted as a faster rate.
    let bent = fastest + (8.0 * sweep.abs().to_f64()).sqrt() * 2.0;
    let length = pieces_length(duration, step, CHIRP_PHASE / bent)?;
    let count = (duration.to_f64() / length.to_f64()).ceil() as usize;
    if count > MOST_PIECES {
        return Err(TooManyPieces);
    }
    let mut pieces: Vec<Piece> = Vec::with_capacity(count + 1);
    for i in 0..count {
        let at = &length * &Number::from(i as i64);
        let rate = &w0 + &(&sweep * &at);
        let phase = &(&(&(&w0 + &rate) * &at) / &Number::from(2)) + own;
        let derivatives = chirp_derivatives(value.to_ball(), &phase, rate.to_ball(), sweep.to_ball());
        pieces.push(Piece { at: begin + &at, derivatives, jump: i == 0 });
    }
    pieces.push(Piece { at: begin + duration, derivatives: Vec::new(), jump: true });
    let size = value.abs().to_f64();
    // Each derivative of the remainder is larger by a factor 16 / h.
    let lost = 2.0 * (3.01 * CHIRP_PHASE / 16.0).power(16) * size;
    let rise = 17.0 / length.to_f64();
    Ok(pieces_from_zero(pieces, lost, rise))
}

/// The parameters of a chirp.
struct Wave<'a> {
    value: &'a Number,
    from: &'a Number,
    to: &'a Number,
    duration: &'a Number,
    at: &'a Number,
    phase: &'a Number,
}

/// A length of at most `most` that divides the step, or the duration where no whole step fits into that: the rest of a longer
/// step has no pieces, however long it is.
fn pieces_length(duration: &Number, step: Option<&Number>, most: f64) -> Result<Number, TooManyPieces> {
    let whole = step.filter(|step| order(step, duration) == Ordering::Less).unwrap_or(duration);
    let parts = (whole.to_f64() / most).ceil().max(1.0);
    if parts < MOST_PIECES as f64 { Ok(whole / &Number::from(parts as i64)) } else { Err(TooManyPieces) }
}

/// Derivatives of value sin(phase + rate t + sweep t^2 / 2) at t = 0: with E = exp(i phase(t)), E' = i (rate + sweep t) E, so
/// E_(k+1) = i (rate E_k + k sweep E_(k-1)).
fn chirp_derivatives(value: Ball, phase: &Number, rate: Ball, sweep: Ball) -> Vec<Number> {
    let Some((sine, cosine)) = phase.sin_cos() else {
        return vec![Number::Ball(Ball::ZERO.widen(f64::INFINITY)); CHIRP_DEGREE + 1];
    };
    let mut e = vec![(cosine.to_ball(), sine.to_ball())];
    for k in 0..CHIRP_DEGREE {
        let (re, im) = e[k];
        let (mut x, mut y) = (rate * re, rate * im);
        if k > 0 {
            let factor = sweep * Ball::from(k as f64);
            (x, y) = (x + factor * e[k - 1].0, y + factor * e[k - 1].1);
        }
        e.push((-y, x));
    }
    e.into_iter().map(|(_, im)| Number::Ball(value * im)).collect()
}

/// Lines or cubics between the rows of a table.
fn table(rows: &Table) -> Vec<Piece> {
    let Table { times, values, course, .. } = rows;
    let n = times.len();
    let Some((first, last)) = values.first().zip(values.last()) else { return Vec::new() };
    let mut pieces = Vec::with_capacity(n + 1);
    pieces.push(jump(&Number::ZERO, &[first]));
    pieces.extend(between_rows(rows, &rows.steps()));
    if let Some(piece) = pieces.get_mut(1) {
        piece.jump = true;
    }
    let end: &[&Number] = if *course == Course::LinesToZero { &[] } else { &[last] };
    pieces.push(jump(&times[n - 1], end));
    pieces
}

/// The pieces of a periodic table up to a time.
fn repeat(rows: &Table, period: &Number, until: &Number) -> Result<Vec<Piece>, TooManyPieces> {
    let Some(first) = rows.times.first() else { return Ok(Vec::new()) };
    let once = between_rows(rows, &rows.steps());
    // The last period that certainly begins before t = 0.
    let start = (-&(first / period)).to_f64().floor() - 1.0;
    let count = (&(until - first) / period).to_f64().ceil() - start;
    if !(start.abs() < 1e15 && count * (once.len() as f64) < MOST_REPEATED) {
        return Err(TooManyPieces);
    }
    let mut pieces = Vec::with_capacity(once.len() * (count.max(0.0) as usize + 1));
    for k in start as i64..=(start + count) as i64 {
        let shift = period * &Number::from(k);
        pieces.extend(once.iter().map(|piece| Piece { at: &piece.at + &shift, ..piece.clone() }));
    }
    // The period that contains t = 0 comes first: the signal jumps to it there.
    let on = pieces.iter().rposition(|piece| !piece.at.is_positive()).unwrap_or(0);
    pieces.drain(..on);
    if let Some(piece) = pieces.first_mut() {
        piece.jump = true;
    }
    Ok(pieces)
}

/// A piece from each row to the next one.
fn between_rows(rows: &Table, steps: &[Number]) -> Vec<Piece> {
    let Table { times, values, course, .. } = rows;
    let is_spline = *course == Course::Spline;
    let bends = if is_spline { rows.bends() } else { Vec::new() };
    let mut pieces = Vec::with_capacity(steps.len());
    for (i, h) in steps.iter().enumerate() {
        let next = if i + 1 < times.len() { i + 1 } else { 0 };
        let slope = &(&values[next] - &values[i]) / h;
        if !is_spline {
            pieces.push(jump(&times[i], &[&values[i], &slope]));
            continue;
        }
        let bend = &(&bends[i] + &bends[i]) + &bends[next];
        let start = &slope - &(&(h * &bend) / &Number::from(6));
        let third = &(&bends[next] - &bends[i]) / h;
        let mut piece = jump(&times[i], &[&values[i], &start, &bends[i], &third]);
        piece.jump = false;
        pieces.push(piece);
    }
    pieces
}

impl Source {
    /// The integral of a piecewise source from zero at t = 0; other sources are returned unchanged, because
    /// `lower::drives` replaces them.
    ///
    /// The remainder of a piece grows to `error` times its length until the next one starts: there it goes into the value.
    /// Within a piece of length h the remainder r of the integral has |r| <= error h, and its derivatives are the remainder's.
    fn integral(self) -> Source {
        let Source::Pieces { order, pieces, error, rise } = self else { return self };
        let mut value = Number::ZERO;
        let mut longest: f64 = 0.0;
        let mut made: Vec<Piece> = Vec::with_capacity(pieces.len());
        for (i, piece) in pieces.iter().enumerate() {
            if let Some(before) = made.last() {
                let length = (&piece.at - &before.at).to_f64();
                value = before.values_after(&piece.at)[0].clone();
                if error > 0.0 && before.derivatives.len() > 1 {
                    longest = longest.max(length);
                    value = Number::Ball(value.to_ball().widen(error * length * 1.01));
                }
            }
            let derivatives: Vec<Number> =
                std::iter::once(value.clone()).chain(piece.derivatives.iter().cloned()).collect();
            // The value is continuous; the slope is the old value, and jumps where that did.
            made.push(Piece { jump: piece.jump || i == 0, ..Piece::jump(piece.at.clone(), derivatives) });
        }
        // The k-th derivative of the new remainder is below error h rise^k for k = 0, and for all others below what the (k-1)-th
        // one of the old was, error rise^(k-1): h rise is at least 1 where pieces have a remainder.
        let (error, rise) = if error > 0.0 { (error * longest * 1.01, rise.max(1.0 / longest)) } else { (0.0, rise) };
        Source::Pieces { order: order + 1, pieces: made, error, rise }
    }

    /// The signal delayed by a time.
    fn delay(self, by: &Number) -> Source {
        match self {
            Source::Pieces { order, mut pieces, error, rise } => {
                pieces.iter_mut().for_each(|piece| piece.at = &piece.at + by);
                Source::Pieces { order, pieces, error, rise }
            }
            Source::Impulse { value, at } => Source::Impulse { value, at: &at + by },
            // `lower::drives` turns the phase of a harmonic.
            harmonic => harmonic,
        }
    }
}

/// Compares a and b; equal if it is not certain which is smaller.
pub fn order(a: &Number, b: &Number) -> Ordering {
    a.compare(b).unwrap_or(Ordering::Equal)
}

/// A total order of times, for sorting: by their midpoints, and by the fractions themselves where these agree. [`order`] is
/// not total, since "may be equal" is not transitive.
pub fn chronological(a: &Number, b: &Number) -> Ordering {
    let (early, late) = (a.enclosure().mid, b.enclosure().mid);
    let by_digits = early.hi.total_cmp(&late.hi).then(early.lo.total_cmp(&late.lo));
    by_digits.then_with(|| a.exact().cmp(&b.exact()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(source: &Source, t: &str) -> f64 {
        let Source::Pieces { pieces, .. } = source else { panic!("pieces") };
        let t = Number::from(t);
        let piece = pieces.iter().rev().find(|piece| order(&piece.at, &t) != Ordering::Greater);
        piece.map_or(0.0, |piece| piece.values_after(&t)[0].to_f64())
    }

    /// From 1 to 5 Hz in 10 s, in a motion with this step.
    fn chirp(step: Option<&str>) -> Source {
        let chirp = Signal::Chirp {
            value: Number::from("3"),
            from: Number::from("1"),
            to: Number::from("5"),
            duration: Number::from("10"),
            at: Number::ZERO,
            phase: Number::ZERO,
        };
        Source::of(&chirp, step.map(Number::from).as_ref(), None).expect("few pieces")
    }

    #[test]
    fn a_chirp_follows_its_formula() {
        let source = chirp(None);
        for t in ["0.1", "3.3", "9.99"] {
            let x = t.parse::<f64>().expect("a number");
            let phase = 2.0 * std::f64::consts::PI * (x + 0.2 * x * x);
            assert!((value(&source, t) - 3.0 * phase.sin()).abs() < 1e-12, "{t}");
        }
        assert_eq!(value(&source, "10.5"), 0.0);
    }

    /// At the end of each piece, the remainder of the polynomial is larger than rounding and no larger than reported;
    /// likewise for its slopes.
    #[test]
    fn the_remainder_of_a_chirp_is_reported() {
        let source = chirp(None);
        let Source::Pieces { pieces, .. } = &source else { panic!("pieces") };
        let two_pi = &Number::pi() * &Number::from(2);
        let mut largest = [0.0f64; 2];
        for pair in pieces.windows(2).take(pieces.len() - 2) {
            let t = &pair[1].at;
            let phase = &two_pi * &(t + &(&Number::from("0.2") * &t.square()));
            let rate = &two_pi * &(&Number::ONE + &(&Number::from("0.4") * t));
            let (sine, cosine) = phase.sin_cos().expect("an angle");
            let truth = [&Number::from("3") * &sine, &(&Number::from("3") * &cosine) * &rate];
            for (k, (found, truth)) in pair[0].values_after(t).iter().zip(&truth).enumerate() {
                let off = (found - truth).to_ball();
                assert!(off.mid.hi.abs() <= source.approximation(k) + off.rad, "{k} at {}: {off:?}", t.to_f64());
                largest[k] = largest[k].max(off.mignitude() / source.approximation(k));
            }
        }
        // Without the remainder, the bound would be violated by far.
        assert!(largest.iter().all(|share| *share > 1e-5), "{largest:?}");
    }

    /// A step of the motion that is longer than the signal is not divided: most of it would be pieces of nothing.
    #[test]
    fn a_signal_has_no_more_pieces_for_a_long_step() {
        let pieces = |step: &str| match chirp(Some(step)) {
            Source::Pieces { pieces, .. } => pieces.len(),
            other => panic!("{other:?}"),
        };
        let own = pieces("10");
        assert_eq!(["11", "1e4", "1e9"].map(pieces), [own; 3]);
    }

    #[test]
    fn a_spline_keeps_a_line_and_its_ends() {
        let numbers = |list: &[&str]| list.iter().map(|&text| Number::from(text)).collect::<Vec<_>>();
        let line = Signal::Table(Table {
            times: numbers(&["0", "1", "3"]),
            values: numbers(&["0", "2", "6"]),
            course: Course::Spline,
            period: None,
        });
        let source = Source::of(&line, None, None).expect("three pieces");
        assert!((value(&source, "2.5") - 5.0).abs() < 1e-15);
        assert!((value(&source, "9") - 6.0).abs() < 1e-15);
    }

    #[test]
    fn a_ramp_rises_and_stays() {
        let n = |text: &str| Number::from(text);
        let ramp = Signal::Ramp { value: n("4"), from: n("1"), to: n("3") };
        let ramp = Source::of(&ramp, None, None).expect("two pieces");
        assert_eq!([value(&ramp, "0.5"), value(&ramp, "1.5"), value(&ramp, "7")], [0.0, 1.0, 4.0]);
    }
}
