//! The course of one output between the stops: Taylor polynomials that join, each with a bound of what it leaves out, so that
//! what lies between samples is known too. In: a run, an output, a time. Out: piece after piece, to whoever asks: the largest
//! value, the mean square. Clause: spec.md, "Measures, `solve`, `require`".
//!
//! On a piece of length h with |A| h <= 1 the output is sum c A^j z0 t^j / j!, and the first term left out bounds the rest:
//! |c A^K| sup|z| h^K / K!. The state is carried in binary64 with a bound of its error, from the exact steps of the run.

use super::{Run, Stop, UP, growth, length};
use crate::analysis::error::AnalysisError;
use crate::base::{Dd, Number, Rational};
use crate::system::{LinearSystem, Signal};

/// The output on [0, 1] of a piece: sum terms[j] x^j, to within `error`.
#[derive(Clone, Debug)]
pub struct Piece {
    pub terms: [f64; TERMS],
    pub error: f64,
    /// A bound of |output| from here to the next event: nothing larger is to come before.
    pub to_come: f64,
    /// s
    pub length: f64,
}

/// Terms of the polynomial: 1/18! of what it stands for is left out.
pub const TERMS: usize = 18;
/// More pieces are not worth the wait.
const MOST_PIECES: f64 = 4e6;

/// What a course comes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Followed {
    ToTheEnd,
    /// The output has an infinite value: a blow on an acceleration, a jump on a velocity.
    Infinite,
    /// More pieces than are worth the wait.
    TooLong,
}

/// What comes after a piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Next {
    Piece,
    /// The rest of the time up to the next event cannot matter.
    Event,
}

/// Visits the pieces of an output from 0 to `until`.
pub fn follow(
    system: &LinearSystem,
    drives: &[Vec<Signal>],
    output: usize,
    until: &Number,
    visit: &mut dyn FnMut(&Piece) -> Next,
) -> Result<Followed, AnalysisError> {
    let times = [Number::ZERO, until.clone()];
    let mut run = Run::of(system, drives, &times)?;
    if feeds_through_a_jump(system, drives, output) {
        return Ok(Followed::Infinite);
    }
    let mut pieces = 0.0;
    for (time, stop) in run.stops(&times) {
        if (&time - until).is_positive() {
            break;
        }
        if (&time - &run.now).is_positive() {
            run.set_sources();
            let stretch = Stretch::of(&run, output, &time);
            pieces += stretch.count as f64;
            if pieces > MOST_PIECES {
                return Ok(Followed::TooLong);
            }
            stretch.follow(&mut run, output, visit)?;
            run.now = time;
        }
        if let Stop::Event { channel, piece } = stop {
            run.set_sources();
            let before: Vec<Dd> = run.z.clone();
            run.event(channel, piece)?;
            if is_infinite(&run, &before, output) {
                return Ok(Followed::Infinite);
            }
        }
    }
    Ok(Followed::ToTheEnd)
}

/// The time between two stops.
struct Stretch {
    h: Number,
    count: usize,
    states: Vec<usize>,
    /// c A^j h^j / j! for j = 0..=TERMS, over the states that are on, with bounds of the rows' norms and errors.
    rows: Vec<Vec<f64>>,
    norms: Vec<f64>,
    errors: Vec<f64>,
    /// A bound of |exp(A t)| for t up to h.
    growth: f64,
    /// Whether every source stands still, if not at zero.
    is_steady: bool,
    /// Whether nothing but the system itself moves: then its energy bounds what is to come.
    is_free: bool,
}

impl Stretch {
    fn of(run: &Run, output: usize, to: &Number) -> Stretch {
        let whole = to - &run.now;
        let states = run.states_on();
        let generator = run.space.generator(&states);
        let count = (whole.to_f64() * generator.norm).ceil().clamp(1.0, 1e9) as usize;
        let h = &whole / &Number::from(Rational::new(count as i64, 1));
        let n = states.len();
        let mut row: Vec<Dd> = states.iter().map(|&i| run.outputs[(output, i)].mid).collect();
        let mut error: f64 = states.iter().map(|&i| run.outputs[(output, i)].rad).sum();
        let (mut rows, mut norms, mut errors) = (Vec::new(), Vec::new(), Vec::new());
        let step = h.to_ball();
        for j in 0..=TERMS {
            let size = length(&row);
            rows.push(row.iter().map(|x| x.to_f64()).collect());
            norms.push((size + error) * UP);
            errors.push(error * UP);
            let factor = (step.mid / Dd::from(j as f64 + 1.0)).to_f64().abs() * UP;
            let next: Vec<Dd> =
                (0..n).map(|k| dot(&row, generator.a.column(k)) * step.mid / Dd::from(j as f64 + 1.0)).collect();
            error = (error * generator.norm
                + size * (generator.error + (n as f64 + 6.0) * super::UNIT * generator.norm))
                * factor
                * UP
                + length(&next) * (step.rad / step.mid.hi.abs());
            row = next;
        }
        let growth = growth(generator.rate.max(0.0) * h.to_f64() * UP);
        let is_steady = run.channels.iter().all(|channel| channel.states_on() <= 1);
        let mechanical = run.space.mechanical;
        let is_off = states.iter().all(|&i| i < mechanical || run.z[i].is_zero());
        let is_free = is_steady && is_off && run.source_error == 0.0 && run.space.own_rate * whole.to_f64() < 0.5;
        Stretch { h, count, states, rows, norms, errors, growth, is_steady, is_free }
    }

    fn follow(&self, run: &mut Run, output: usize, visit: &mut dyn FnMut(&Piece) -> Next) -> Result<(), AnalysisError> {
        let mechanical = run.space.mechanical;
        let fed = run.fed(output);
        let start = run.now.clone();
        let step = run.step(&self.h)?;
        let columns: Vec<Vec<f64>> =
            (0..self.states.len()).map(|k| step.f.column(k).iter().map(|x| x.to_f64()).collect()).collect();
        let n = self.states.len() as f64;
        // Entries and states rounded to binary64, products and sums.
        let rounding = (n + 8.0) * f64::EPSILON;
        let mut z: Vec<f64> = run.z[..mechanical].iter().map(|x| x.to_f64()).collect();
        run.error = (run.error + size(&z) * f64::EPSILON) * UP;
        // Where the rest of the stretch cannot matter the state at its end still does.
        let mut skipped = false;
        for piece in 0..self.count {
            if !self.is_steady {
                run.set_sources();
            }
            let all: Vec<f64> = z.iter().copied().chain(run.z[mechanical..].iter().map(|x| x.to_f64())).collect();
            let on: Vec<f64> = self.states.iter().map(|&i| all[i]).collect();
            let length = size(&on);
            let error = (run.error + run.source_error) * UP;
            if !skipped {
                skipped = visit(&self.piece(&on, length, error, fed)) == Next::Event;
            }
            if skipped && self.is_free {
                return self.skip(run, &z, piece);
            }
            let mut next = vec![0.0; mechanical];
            let mut sizes = vec![0.0; mechanical];
            for (x, column) in on.iter().zip(&columns) {
                for ((sum, size), f) in next.iter_mut().zip(&mut sizes).zip(column) {
                    let product = f * x;
                    *sum += product;
                    *size += product.abs();
                }
            }
            let approximations = run.approximation_errors() * self.h.to_f64() * UP;
            run.error = (step.own * run.error
                + step.from_sources * run.source_error
                + rounding * size(&sizes)
                + (step.error + step.rounding) * (length + error)
                + approximations * self.growth)
                * UP;
            z = next;
            run.now = &start + &(&self.h * &Number::from(piece as i64 + 1));
        }
        run.z[..mechanical].iter_mut().zip(&z).for_each(|(to, &from)| *to = Dd::from(from));
        Ok(())
    }

    /// Goes on to the end of the stretch in one step.
    fn skip(&self, run: &mut Run, z: &[f64], piece: usize) -> Result<(), AnalysisError> {
        run.z[..z.len()].iter_mut().zip(z).for_each(|(to, &from)| *to = Dd::from(from));
        let left = &self.h * &Number::from((self.count - piece) as i64);
        let end = &run.now + &left;
        run.advance(&end)
    }

    /// The polynomial from a state of this length and error; `fed` is what the sources' own errors add to the output at once.
    fn piece(&self, on: &[f64], length: f64, error: f64, fed: f64) -> Piece {
        let mut terms = [0.0; TERMS];
        let mut bound = 0.0;
        let rounding = (on.len() as f64 + 8.0) * f64::EPSILON;
        for (j, term) in terms.iter_mut().enumerate() {
            let (mut sum, mut sizes) = (0.0, 0.0);
            for (c, x) in self.rows[j].iter().zip(on) {
                sum += c * x;
                sizes += (c * x).abs();
            }
            *term = sum;
            bound += self.norms[j] * error + rounding * sizes + self.errors[j] * length;
        }
        let left_out = self.norms[TERMS] * (length + error) * self.growth;
        let to_come = if self.is_free { self.norms[0] * (length + error) * 1.7 } else { f64::INFINITY };
        Piece { terms, error: (bound + left_out + fed) * UP, to_come, length: self.h.to_f64() }
    }
}

fn dot(a: &[Dd], b: &[Dd]) -> Dd {
    a.iter().zip(b).fold(Dd::ZERO, |sum, (x, y)| sum + *x * *y)
}

fn size(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt() * UP
}

/// Whether the state jumped in a way that makes a derivative in the output infinite: y = p0 q + p1 q' + p2 q''.
fn is_infinite(run: &Run, before: &[Dd], output: usize) -> bool {
    let mechanical = run.space.mechanical;
    let change: Vec<Dd> = run.z[..mechanical].iter().zip(before).map(|(now, then)| *now - *then).collect();
    let rounding = 1e-25 * (length(&run.z[..mechanical]) + length(&before[..mechanical]));
    if length(&change) <= rounding {
        return false;
    }
    let felt = |p: usize, motion: usize| {
        let row = &run.system.outputs[output].p[p];
        let jump = row.iter().fold(Dd::ZERO, |sum, (i, factor)| {
            let rows = &run.space.rows[motion];
            let moved = (0..mechanical).fold(Dd::ZERO, |sum, k| sum + rows[(i.index(), k)].mid * change[k]);
            sum + factor.to_ball().mid * moved
        });
        let scale: f64 = row.iter().map(|(_, factor)| factor.to_f64().abs()).sum();
        jump.abs().to_f64() > 1e-20 * scale * length(&change)
    };
    felt(1, 0) || felt(2, 0) || felt(2, 1)
}

/// Whether an input that jumps enters the output by its derivative.
fn feeds_through_a_jump(system: &LinearSystem, drives: &[Vec<Signal>], output: usize) -> bool {
    let enters = |order: usize, input: usize| system.outputs[output].d[order].iter().any(|(i, _)| *i as usize == input);
    drives.iter().enumerate().any(|(input, signals)| {
        let value = signals.iter().any(jumps);
        let rate = value || signals.iter().any(|signal| !matches!(signal, Signal::Impulse { .. }));
        enters(1, input) && value || enters(2, input) && rate
    })
}

fn jumps(signal: &Signal) -> bool {
    match signal {
        Signal::Step { .. } | Signal::Pulse { .. } | Signal::Impulse { .. } => true,
        Signal::Harmonic { phase, .. } => !phase.is_zero(),
        Signal::Table { values, .. } => values.first().is_some_and(|first| !first.is_zero()),
        Signal::Ramp { .. } | Signal::Chirp { .. } => false,
    }
}
