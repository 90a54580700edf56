//! Measures of the motion in time: the largest |output| between the samples too, and the root of its mean square. In: the
//! system, signals, an output, a time. Out: a ball that holds the true number. Clause: spec.md, "Measures, `solve`, `require`".

use crate::analysis::answer::{PoleKind, Poles};
use crate::analysis::error::AnalysisError;
use crate::analysis::measures::Measurement;
use crate::analysis::response::course::{Followed, Next, Piece, TERMS, follow};
use crate::base::{Ball, Dd, Number, Rational};
use crate::system::{LinearSystem, Signal};

const UP: f64 = 1.0 + 1e-12;
const TOO_LONG: Measurement =
    Measurement::None("the fastest motion has too many cycles in that time: choose a shorter one with `--until`");

/// The largest |output| from 0 to `until`.
pub fn peak(system: &LinearSystem, drives: &[Vec<Signal>], output: usize, until: &Number) -> Measurement {
    let mut largest = Largest::default();
    let followed = follow(system, drives, output, until, &mut |piece| largest.look(piece));
    measured(followed, || {
        let (low, high) = (largest.low.max(0.0), largest.high.max(0.0));
        if high == 0.0 {
            return Ball::ZERO;
        }
        Ball::new(Dd::from(0.5 * (low + high)), (0.5 * (high - low) + high * f64::EPSILON) * UP)
    })
}

/// sqrt(integral of output^2 / until) from 0 to `until`.
pub fn rms(system: &LinearSystem, drives: &[Vec<Signal>], output: usize, until: &Number) -> Measurement {
    let mut sum = Dd::ZERO;
    let mut error = 0.0;
    let followed = follow(system, drives, output, until, &mut |piece| {
        let (square, off) = mean_square(piece);
        sum += Dd::product(square, piece.length);
        error += (off + square * f64::EPSILON * 4.0) * piece.length * UP;
        Next::Piece
    });
    measured(followed, || (Ball::new(sum, error * UP) / until.to_ball()).sqrt())
}

fn measured(followed: Result<Followed, AnalysisError>, value: impl FnOnce() -> Ball) -> Measurement {
    match followed {
        Ok(Followed::ToTheEnd) => Some(value()).filter(Ball::is_finite).map_or(TOO_LONG, Measurement::Value),
        Ok(Followed::Infinite) => Measurement::Infinite,
        Ok(Followed::TooLong) => TOO_LONG,
        Err(error) => Measurement::Failed(error.to_diagnostic().message),
    }
}

/// The largest |value| so far lies between these.
#[derive(Clone, Copy, Debug, Default)]
struct Largest {
    low: f64,
    high: f64,
}

impl Largest {
    fn look(&mut self, piece: &Piece) -> Next {
        let rest: f64 = piece.terms[1..].iter().map(|term| term.abs()).sum();
        let above = (piece.terms[0].abs() + rest) * UP + piece.error;
        if above > 0.0 && above >= self.low {
            let bends = [2, 3].map(|order| derivative_bound(&piece.terms, order));
            self.search(piece, 0.0, 1.0, bends, 0);
        }
        if piece.to_come <= self.low { Next::Event } else { Next::Piece }
    }

    /// On [from, from + width] of a piece, whose second and third derivatives are bounded.
    fn search(&mut self, piece: &Piece, from: f64, width: f64, bends: [f64; 2], depth: usize) {
        let middle = from + 0.5 * width;
        let [value, slope, bend] = evaluate(&piece.terms, middle);
        let above = value.abs() + 0.5 * slope.abs() * width + bends[0] * width * width / 8.0;
        if above * UP + piece.error < self.low {
            return;
        }
        // Flatter than the piece is known: splitting tells nothing more.
        let spread = above - value.abs();
        if spread <= 0.1 * piece.error + value.abs() * f64::EPSILON {
            return self.take(value.abs(), spread + piece.error);
        }
        if depth < DEEPEST && bend.abs() <= 0.5 * bends[1] * width * UP {
            self.search(piece, from, 0.5 * width, bends, depth + 1);
            return self.search(piece, middle, 0.5 * width, bends, depth + 1);
        }
        if bend.abs() <= 0.5 * bends[1] * width * UP {
            // As flat as it gets: the whole piece is between these.
            return self.take(value.abs(), spread + piece.error);
        }
        // The second derivative keeps its sign: the largest and the least are at the ends or where the slope is zero.
        let [(left, falls), (right, rises)] = [from, from + width].map(|x| {
            let [value, slope, _] = evaluate(&piece.terms, x);
            (value, slope)
        });
        self.take(left.abs(), piece.error);
        self.take(right.abs(), piece.error);
        if falls * rises < 0.0 {
            let (mut x, mut low, mut high) = (middle, from, from + width);
            for _ in 0..NEWTON {
                let [_, slope, bend] = evaluate(&piece.terms, x);
                if slope * falls > 0.0 {
                    low = x
                } else {
                    high = x
                }
                let next = x - slope / bend;
                x = if next > low && next < high { next } else { 0.5 * (low + high) };
            }
            let [value, slope, _] = evaluate(&piece.terms, x);
            // A curve that bends one way stays below its tangents.
            self.take(value.abs(), slope.abs() * width + piece.error);
        }
    }

    fn take(&mut self, value: f64, error: f64) {
        let rounding = value * f64::EPSILON * 8.0;
        self.low = self.low.max(value - (error + rounding) * UP);
        self.high = self.high.max(value + (error + rounding) * UP);
    }
}

const DEEPEST: usize = 24;
const NEWTON: usize = 60;

/// Value, slope and second derivative of the polynomial.
fn evaluate(terms: &[f64; TERMS], x: f64) -> [f64; 3] {
    let (mut value, mut slope, mut bend) = (0.0, 0.0, 0.0);
    for &term in terms.iter().rev() {
        bend = bend * x + slope;
        slope = slope * x + value;
        value = value * x + term;
    }
    [value, slope, 2.0 * bend]
}

/// A bound of a derivative's size on [0, 1].
fn derivative_bound(terms: &[f64; TERMS], order: usize) -> f64 {
    let factor = |j: usize| (0..order).map(|k| (j - k) as f64).product::<f64>();
    terms.iter().enumerate().skip(order).map(|(j, term)| factor(j) * term.abs()).sum::<f64>() * UP
}

/// The mean of the square over a piece, and a bound of its error.
fn mean_square(piece: &Piece) -> (f64, f64) {
    let (mut sum, mut sizes) = (0.0, 0.0);
    for (j, a) in piece.terms.iter().enumerate() {
        for (k, b) in piece.terms.iter().enumerate() {
            let part = a * b / (j + k + 1) as f64;
            sum += part;
            sizes += part.abs();
        }
    }
    let largest: f64 = piece.terms.iter().map(|term| term.abs()).sum();
    // The rounding of 324 products and their sum, and what the polynomial is off by.
    let rounding = sizes * f64::EPSILON * (TERMS * TERMS) as f64;
    (sum.max(0.0), rounding + 2.0 * largest * piece.error + piece.error * piece.error)
}

/// How long the motion is followed where nobody says how long: until the last signal has come and the motion since has
/// decayed to a thousandth, but at most a hundred periods of the slowest motion, and at least three of it; rounded up to two
/// digits. `None` where the motion grows, or where nothing tells a time.
pub fn usual_time(poles: &Poles, drives: &[Vec<Signal>]) -> Option<Number> {
    let mut last: f64 = 0.0;
    let mut period: f64 = 0.0;
    for signal in drives.iter().flatten() {
        let (event, cycle) = times_of(signal);
        (last, period) = (last.max(event), period.max(cycle));
    }
    let mut decay: f64 = 0.0;
    for pole in &poles.list {
        let (re, im) = (pole.re.to_f64(), pole.im.to_f64().abs());
        match pole.kind {
            PoleKind::Divergence | PoleKind::Flutter | PoleKind::Undetermined => return None,
            PoleKind::Rigid => {}
            PoleKind::Oscillation | PoleKind::Overdamped => {
                if im > 0.0 {
                    period = period.max(std::f64::consts::TAU / im);
                }
                decay = decay.max(if re < 0.0 { THOUSANDTH / -re } else { f64::INFINITY });
            }
        }
    }
    let after = if period > 0.0 { decay.min(100.0 * period).max(3.0 * period) } else { decay };
    let time = if after > 0.0 && after.is_finite() { last + after } else { 2.0 * last };
    round_up(time)
}

/// ln 1000
const THOUSANDTH: f64 = 6.907_755_278_982_137;

/// When the last thing happens, and the period of what repeats, s.
fn times_of(signal: &Signal) -> (f64, f64) {
    match signal {
        Signal::Step { at, .. } | Signal::Impulse { at, .. } => (at.to_f64(), 0.0),
        Signal::Ramp { to, .. } | Signal::Pulse { to, .. } => (to.to_f64(), 0.0),
        Signal::Harmonic { frequency, .. } if frequency.to_f64() != 0.0 => (0.0, 1.0 / frequency.to_f64().abs()),
        Signal::Harmonic { .. } => (0.0, 0.0),
        Signal::Chirp { duration, .. } => (duration.to_f64(), 0.0),
        Signal::Table { times, .. } => (times.last().map_or(0.0, Number::to_f64), 0.0),
    }
}

/// Two digits, upwards.
fn round_up(time: f64) -> Option<Number> {
    if !(time.is_finite() && time > 0.0) {
        return None;
    }
    let text = format!("{time:.1e}");
    let (digits, exponent) = text.split_once('e')?;
    let rounded = Rational::from_decimal(&text)?;
    if rounded.to_f64() >= time {
        return Some(Number::from(rounded));
    }
    let more = Rational::from_decimal(&format!("{digits}e{exponent}"))?;
    let unit = Rational::from_decimal(&format!("0.1e{exponent}"))?;
    Some(Number::from(&more + &unit))
}
