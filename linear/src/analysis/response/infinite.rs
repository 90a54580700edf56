//! Whether an output is infinite at an instant, where a signal jumps or has an impulse. In: a system, signals, an output,
//! a time. Out: a verdict. See docs/method/measures.md#peak-and-rms.
//!
//! At an instant an input is u = j_0 + j_1 / s + j_2 / s^2 + ...: an impulse, a jump, a jump of the rate. The motion follows
//! in powers of s from the highest one down, as each of the equations (M s^2 + C s + K) q = B u determines the next power of
//! the coordinates that it accelerates, drags along or balances. The part of an output that remains in s^0 is an
//! impulse, the part in s its
//! derivative, and so on: if any of them is not zero, the output is infinite.

use crate::analysis::forms::{apply, dense, dot, solution_on};
use crate::analysis::response::propagator::Parts;
use crate::analysis::response::signal::{Piece, Source, chronological, order};
use crate::base::{Ball, Number, OrderBy};
use crate::system::{LinearSystem, Signal};
use std::cmp::Ordering;

/// The verdict about an output from 0 to a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    Finite,
    Infinite,
    /// Digits do not decide.
    Open,
}

/// The impulse, the jump, and the jump of the rate of an input at a time.
struct Jump {
    at: Number,
    input: usize,
    parts: [Number; 3],
}

/// Whether the output is infinite at some instant from 0 to `until`.
pub fn verdict(system: &LinearSystem, drives: &[Vec<Signal>], output: usize, until: &Number) -> Verdict {
    let mut jumps = Vec::new();
    for (input, signals) in drives.iter().enumerate().take(system.inputs.len()) {
        for (at, parts) in signals
            .iter()
            .flat_map(|signal| jumps_of(signal, until))
            .filter(|(at, _)| order(at, until) != Ordering::Greater)
        {
            jumps.push(Jump { at, input, parts });
        }
    }
    jumps.order_by(|a, b| chronological(&a.at, &b.at));
    let mut seen = Seen::new(system, output);
    let mut verdict = Verdict::Finite;
    for instant in jumps.chunk_by(|a, b| order(&a.at, &b.at) == Ordering::Equal) {
        match seen.at(instant) {
            Some(Verdict::Infinite) => return Verdict::Infinite,
            Some(Verdict::Finite) => {}
            Some(Verdict::Open) | None => verdict = Verdict::Open,
        }
    }
    verdict
}

/// Impulses, jumps and jumps of the rate of a signal up to a time, each with its own.
fn jumps_of(signal: &Signal, until: &Number) -> Vec<(Number, [Number; 3])> {
    let zero = || Number::ZERO;
    let wave = |value: &Number, omega: &Number, angle: &Number| {
        let unknown = || (Number::Ball(Ball::ZERO.widen(1.0)), Number::Ball(Ball::ZERO.widen(1.0)));
        let (sine, cosine) = angle.sin_cos().unwrap_or_else(unknown);
        [zero(), value * &sine, &(value * omega) * &cosine]
    };
    let two_pi = &Number::pi() * &Number::from(2);
    match signal {
        Signal::Impulse { value, at } => vec![(at.clone(), [value.clone(), zero(), zero()])],
        Signal::Harmonic { value, frequency, phase, at } => {
            let omega = &two_pi * frequency;
            vec![(at.clone(), wave(value, &omega, &(&(&omega * at) + phase)))]
        }
        Signal::Chirp { value, from, to, duration, at, phase } => {
            let turned = &(&(&(from + to) * duration) * &Number::pi()) + phase;
            let end = wave(&-value, &(&two_pi * to), &turned);
            vec![(at.clone(), wave(value, &(&two_pi * from), phase)), (at + duration, end)]
        }
        Signal::Integral { of, times } => {
            let integrated = |[impulse, jump, _]: [Number; 3]| [Number::ZERO, impulse, jump];
            let jumps = jumps_of(of, until).into_iter();
            jumps.map(|(at, parts)| (at, (0..*times).fold(parts, |parts, _| integrated(parts)))).collect()
        }
        Signal::Delayed { of, by } => jumps_of(of, until).into_iter().map(|(at, parts)| (&at + by, parts)).collect(),
        Signal::Step { .. } | Signal::Ramp { .. } | Signal::Pulse { .. } | Signal::Table(_) => {
            match Source::of(signal, None, Some(until)) {
                Ok(Source::Pieces { pieces, .. }) => jumps(&pieces),
                _ => Vec::new(),
            }
        }
    }
}

/// The jumps from one piece to the next.
fn jumps(pieces: &[Piece]) -> Vec<(Number, [Number; 3])> {
    let before = |i: usize, at: &Number| match i.checked_sub(1) {
        Some(last) => pieces[last].values_after(at),
        None => [Number::ZERO, Number::ZERO],
    };
    let jumps = pieces.iter().enumerate().filter(|(_, piece)| piece.jump).map(|(i, piece)| {
        let ([u, rate], [old, old_rate]) = (piece.values_after(&piece.at), before(i, &piece.at));
        (piece.at.clone(), [Number::ZERO, &u - &old, &rate - &old_rate])
    });
    jumps.filter(|(_, parts)| parts.iter().any(|part| !part.is_zero())).collect()
}

/// The powers of s from 4 down to 0 in an output.
type Content = [Number; 5];

/// The parts of an output due to unit jumps of each input.
struct Seen<'a> {
    system: &'a LinearSystem,
    output: usize,
    parts: Parts,
    of_units: Vec<[Option<Content>; 3]>,
}

impl Seen<'_> {
    fn new(system: &LinearSystem, output: usize) -> Seen<'_> {
        let of_units = system.inputs.iter().map(|_| [const { None }; 3]).collect();
        Seen { system, output, parts: Parts::of(system), of_units }
    }

    /// The verdict about jumps whose times may be equal; `None` if an equation has no solution.
    fn at(&mut self, instant: &[Jump]) -> Option<Verdict> {
        let is_one_time = instant.windows(2).all(|pair| pair[0].at.compare(&pair[1].at) == Some(Ordering::Equal));
        if is_one_time {
            return self.of(instant);
        }
        // They may happen one after the other, or at the same time and cancel.
        for jump in instant.chunks(1) {
            if self.of(jump)? != Verdict::Finite {
                return Some(Verdict::Open);
            }
        }
        Some(Verdict::Finite)
    }

    /// The verdict about jumps at one time.
    fn of(&mut self, instant: &[Jump]) -> Option<Verdict> {
        let mut content: Content = [const { Number::ZERO }; 5];
        for (input, parts) in of_inputs(instant) {
            for (kind, part) in parts.iter().enumerate().filter(|(_, part)| !part.is_zero()) {
                if self.of_units[input][kind].is_none() {
                    self.of_units[input][kind] = Some(self.of_unit(input, kind)?);
                }
                for (sum, unit) in content.iter_mut().zip(self.of_units[input][kind].iter().flatten()) {
                    *sum = &*sum + &(part * unit);
                }
            }
        }
        Some(if content.iter().any(|sum| !sum.may_be_zero()) {
            Verdict::Infinite
        } else if content.iter().all(Number::is_zero) {
            Verdict::Finite
        } else {
            Verdict::Open
        })
    }

    /// The part of an output due to u = s^-kind of one input.
    fn of_unit(&self, input: usize, kind: usize) -> Option<Content> {
        // Index i stands for s^(2 - i).
        const POWERS: usize = 5;
        let (system, n) = (self.system, self.system.n());
        let mut force = vec![vec![Number::ZERO; n]; POWERS + 2];
        for (power, b) in system.inputs[input].b.iter().enumerate() {
            force[2 - power + kind] = dense(n, b);
        }
        let mut q = vec![vec![Number::ZERO; n]; POWERS + 2];
        let put = |q: &mut [Number], form, coordinates: &[usize], force: &[Number]| -> Option<()> {
            let solved = solution_on(form, coordinates, force)?;
            coordinates.iter().for_each(|&i| q[i] = solved[i].clone());
            Some(())
        };
        for i in 0..POWERS {
            let mut rest = less(&force[i], &apply(&system.k, &q[i]));
            put(&mut q[i], &system.k, &self.parts.following, &rest)?;
            rest = less(&force[i], &apply(&system.k, &q[i]));
            let dragged = less(&rest, &apply(&system.c, &q[i + 1]));
            put(&mut q[i + 1], &system.c, &self.parts.damped, &dragged)?;
            let left = less(&rest, &apply(&system.c, &q[i + 1]));
            put(&mut q[i + 2], &system.m, &self.parts.heavy, &left)?;
        }
        let output = &system.outputs[self.output];
        let mut content: Content = [const { Number::ZERO }; 5];
        for (index, sum) in content.iter_mut().enumerate() {
            // s^(4 - index) of p_k q is that of s^k times s^(4 - index - k).
            let felt =
                output.p.iter().enumerate().filter_map(|(k, p)| Some(dot(p, q.get((index + k).checked_sub(2)?)?)));
            let fed = output.d.iter().enumerate().filter(|(k, _)| index + k == 4 + kind);
            let own = fed.flat_map(|(_, d)| d).filter(|(of, _)| *of as usize == input).map(|(_, d)| d.clone());
            for value in felt.chain(own) {
                *sum = &*sum + &value;
            }
        }
        Some(content)
    }
}

/// The jumps of each input at one time, in the order of inputs.
fn of_inputs(instant: &[Jump]) -> Vec<(usize, [Number; 3])> {
    let mut inputs: Vec<(usize, [Number; 3])> = Vec::new();
    for jump in instant {
        match inputs.iter_mut().find(|(input, _)| *input == jump.input) {
            Some((_, parts)) => parts.iter_mut().zip(&jump.parts).for_each(|(sum, part)| *sum = &*sum + part),
            None => inputs.push((jump.input, jump.parts.clone())),
        }
    }
    inputs
}

fn less(a: &[Number], b: &[Number]) -> Vec<Number> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}
