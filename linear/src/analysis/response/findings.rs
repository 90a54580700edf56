//! Warnings that accompany a motion: outputs that nothing moves, and samples whose bounds are wider than binary64. In:
//! a system, its signals, a motion. Out: facts, which become findings at the given places. See
//! docs/method/response.md#printed-samples.

use super::History;
use crate::base::{Ball, Code, Diagnostic, Number, Span};
use crate::system::{Form, LinearSystem, Signal};

/// For each output, whether a signal or an initial state reaches it: through masses, dampers and springs from
/// coordinate to coordinate, or directly. An output that nothing reaches is always zero.
pub fn moving_outputs(system: &LinearSystem, drives: &[Vec<Signal>]) -> Vec<bool> {
    let mut parts = Parts((0..system.n()).collect());
    for form in [&system.m, &system.c, &system.k] {
        parts.join_all(form);
    }
    let mut is_moved = vec![false; system.n()];
    for (i, displacement, velocity) in &system.initial {
        is_moved[parts.of(i.index())] |= !(displacement.is_zero() && velocity.is_zero());
    }
    let acts = |input: usize| drives.get(input).is_some_and(|signals| signals.iter().any(Signal::is_felt));
    for (_, input) in system.inputs.iter().enumerate().filter(|&(input, _)| acts(input)) {
        for (i, _) in input.b.iter().flatten() {
            is_moved[parts.of(i.index())] = true;
        }
    }
    let reaches = |output: &crate::system::Output| {
        output.p.iter().flatten().any(|(i, _)| is_moved[parts.of(i.index())])
            || output.d.iter().flatten().any(|(input, _)| acts(*input as usize))
    };
    system.outputs.iter().map(reaches).collect()
}

/// Coordinates that are coupled: each refers to a representative of its part.
struct Parts(Vec<usize>);

impl Parts {
    fn of(&self, mut i: usize) -> usize {
        while self.0[i] != i {
            i = self.0[i];
        }
        i
    }

    fn join_all(&mut self, form: &Form) {
        for term in form.terms() {
            let mut row = form.row(term).iter().map(|(i, _)| i.index());
            let Some(first) = row.next() else { continue };
            for other in row {
                let (a, b) = (self.of(first), self.of(other));
                self.0[a.max(b)] = a.min(b);
            }
        }
        // Every coordinate refers directly to the representative of its part, for the next form.
        for i in 0..self.0.len() {
            self.0[i] = self.of(i);
        }
    }
}

/// An output with samples that are less accurate than binary64 could represent.
#[derive(Clone, Debug)]
pub struct Unsettled {
    pub output: usize,
    /// Number of samples of which nothing is known.
    pub unknown: usize,
    /// The widest bound of the others, the first time at which it occurs, and the largest |value|.
    pub bound: f64,
    pub at: Number,
    pub largest: f64,
}

/// Limit of a bound relative to the output's largest value: the last three bits of binary64 are left to rounding.
const SETTLED: f64 = 1.0 / (1u64 << 50) as f64;

/// The statistics of an output's samples.
#[derive(Clone, Debug, Default)]
struct SampleStatistics {
    unknown: usize,
    first_unknown: Option<usize>,
    largest: f64,
    /// The widest bound and its sample.
    widest: (f64, usize),
}

impl SampleStatistics {
    fn record(&mut self, sample: usize, value: &Ball) {
        if !value.is_finite() {
            self.unknown += 1;
            self.first_unknown.get_or_insert(sample);
            return;
        }
        self.largest = self.largest.max(value.mid.hi.abs());
        if value.rad > self.widest.0 {
            self.widest = (value.rad, sample);
        }
    }
}

impl History {
    /// The outputs that are less accurate than binary64, relative to their own magnitude.
    pub fn unsettled_outputs(&self) -> Vec<Unsettled> {
        let mut outputs = vec![SampleStatistics::default(); self.values.first().map_or(0, Vec::len)];
        // Row by row, in the order of memory.
        for (sample, row) in self.values.iter().enumerate() {
            outputs.iter_mut().zip(row).for_each(|(seen, value)| seen.record(sample, value));
        }
        let unsettled = |(output, seen): (usize, SampleStatistics)| {
            let (bound, sample) = seen.widest;
            let at = self.times[seen.first_unknown.unwrap_or(sample)].clone();
            let is_reported = seen.unknown > 0 || bound > SETTLED * seen.largest;
            is_reported.then_some(Unsettled { output, unknown: seen.unknown, bound, at, largest: seen.largest })
        };
        outputs.into_iter().enumerate().filter_map(unsettled).collect()
    }
}

/// A scene, or some of its outputs, that nothing moves.
const STILL: Code = Code::model("vib::motion::still");
/// Samples that are less accurate than they could be printed.
const UNSETTLED: Code = Code::limit("vib::motion::unsettled");

/// The findings about a motion; `places` are those of the outputs.
pub fn findings(system: &LinearSystem, drives: &[Vec<Signal>], history: &History, places: &[Span]) -> Vec<Diagnostic> {
    let mut moved = moving_outputs(system, drives);
    // A realisation of noise is no signal.
    for (output, moved) in moved.iter_mut().enumerate() {
        *moved = *moved || history.values.iter().any(|row| !row[output].is_zero());
    }
    let name = |output: usize| system.display(system.outputs[output].name);
    let mut list: Vec<Diagnostic> = Vec::new();
    if let (false, Some(&first)) = (moved.contains(&true), places.first()) {
        let message = "nothing moves here: no signal and no initial state reaches an output, so every sample is zero";
        let help = "give an input a signal, such as `= step(1 N, 0 s)`, or a body an `initial` state";
        list.push(Diagnostic::warning(STILL, first, message).help(help));
        return list;
    }
    for (output, &place) in places.iter().enumerate().filter(|&(output, _)| !moved[output]) {
        let message = format!("no signal and no initial state reaches `{}`: it is zero at all times", name(output));
        let help = "drive the part of the model to which it belongs, or remove it";
        list.push(Diagnostic::warning(STILL, place, message).help(help));
    }
    let reported = history.unsettled_outputs().into_iter().map(|found| {
        let (name, place) = (name(found.output), places[found.output]);
        let at = found.at.to_f64();
        let at = if at == 0.0 || (1e-9..1e16).contains(&at) { at.to_string() } else { format!("{at:e}") };
        if found.unknown > 0 {
            let message = format!("nothing is known of {} samples of `{name}`, from {at} s on", found.unknown);
            return Diagnostic::error(UNSETTLED, place, message).help(SHORTER);
        }
        let message = if found.largest > found.bound {
            format!(
                "not every digit of `{name}` is certain: its bound at {at} s is {:.1e}, its largest value {:.1e}",
                found.bound, found.largest
            )
        } else {
            format!("no digit of `{name}` is certain: its bound is {:.1e} at {at} s", found.bound)
        };
        Diagnostic::warning(UNSETTLED, place, message)
            .help("the CSV has only certain digits; `--bounds` adds the bound of each sample")
    });
    list.extend(reported);
    list
}

const SHORTER: &str = "choose a shorter time, or stiffnesses and masses of more similar magnitude";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::response::respond;
    use crate::analysis::test_systems::{blank, push};

    /// Two uncoupled oscillators: a force on one moves only that one, a spring between them makes it move both.
    #[test]
    fn unreached_outputs_do_not_move() {
        let mut system = blank(2);
        for i in 0..2 {
            push(&mut system.m, "1", i, None);
            push(&mut system.k, "4", i, None);
        }
        let step = |value: &str| Signal::Step { value: Number::from(value), at: Number::ZERO };
        let drives = |value: &str| vec![vec![step(value)], Vec::new()];
        assert_eq!(moving_outputs(&system, &drives("1")), [true, false]);
        assert_eq!(moving_outputs(&system, &drives("0")), [false, false]);
        assert_eq!(moving_outputs(&system, &[]), [false, false]);
        let times = [Number::ZERO, Number::ONE];
        let history = respond(&system, &drives("1"), &times).expect("a motion");
        assert!(history.values.iter().all(|row| row[1].is_zero()));
        push(&mut system.k, "1", 0, Some(1));
        assert_eq!(moving_outputs(&system, &drives("1")), [true, true]);
    }

    #[test]
    fn bounds_outside_binary64_are_reported() {
        let rows = |radii: [f64; 2]| radii.iter().map(|&rad| vec![Ball::new(Ball::PI.mid, rad)]).collect();
        let times = vec![Number::ZERO, Number::ONE];
        let of = |radii: [f64; 2]| History { times: times.clone(), values: rows(radii) }.unsettled_outputs();
        assert!(of([0.0, 1e-15]).is_empty());
        assert_eq!(of([0.0, 1e-14])[0].at, Number::ONE);
        assert_eq!(of([f64::NAN, 1e-14])[0].unknown, 1);
        assert_eq!(of([1e-20, f64::INFINITY])[0].unknown, 1);
    }
}
