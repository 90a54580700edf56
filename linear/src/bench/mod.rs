//! Speed against error: for one system, every method for its frequencies, poles, transfer function and motion, ours and
//! those of an ordinary program, each with its time, its true error and its bound. In: a system, its signals, a clock.
//! Out: a table of entries. See docs/method/bench.md.
//!
//! The true error is the error of the binary64 number that would be printed, the largest one in the answer, measured
//! against our result in double-double (which has its own bound). Times come from a clock that the caller passes in;
//! everything else is the same in each run.

mod motion;
mod ordinary;
mod spectrum;
mod transfer;

pub use motion::Problem;

use crate::analysis::{self, AnalysisError, ModeKind, Modes, Poles, Request, Signal};
use crate::system::LinearSystem;

/// The question that is answered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Question {
    Frequencies,
    Poles,
    Transfer,
    Motion,
}

impl Question {
    pub const ALL: [Question; 4] = [Question::Frequencies, Question::Poles, Question::Transfer, Question::Motion];

    /// The name in the CSV.
    pub fn name(self) -> &'static str {
        match self {
            Question::Frequencies => "frequencies",
            Question::Poles => "poles",
            Question::Transfer => "transfer",
            Question::Motion => "motion",
        }
    }
}

/// The result of one method for a question.
#[derive(Clone, Debug)]
pub struct Entry {
    pub question: Question,
    pub method: String,
    /// Whether an ordinary program uses this method.
    pub ordinary: bool,
    /// Time for the whole answer.
    pub seconds: f64,
    /// The worst relative error; `None` if the method fails.
    pub error: Option<f64>,
    /// The worst relative bound that the method itself provides.
    pub bound: Option<f64>,
    /// Whether no other method for this question is both faster and more accurate.
    pub pareto: bool,
    /// Whether this is the method that the program chooses.
    pub chosen: bool,
    /// The reason why it fails, or the work that its time does not include.
    pub note: &'static str,
}

/// All results.
#[derive(Clone, Debug)]
pub struct Bench {
    pub coordinates: usize,
    pub entries: Vec<Entry>,
    /// The motion that was computed.
    pub problem: Problem,
    /// Ratio of bound to true error of our frequencies, if both are known: the median and the largest.
    pub bound_quality: Option<(f64, f64)>,
    /// The largest relative change of a frequency if the model's literals are read as binary64.
    pub reading: Option<f64>,
    pub growth: Vec<Growth>,
}

/// A chain of this many masses: seconds and error for all frequencies, ours and those of the assembled matrices.
#[derive(Clone, Copy, Debug)]
pub struct Growth {
    pub coordinates: usize,
    pub ours: (f64, f64),
    pub ordinary: (f64, f64),
}

/// A clock, in s.
pub type Clock<'a> = dyn FnMut() -> f64 + 'a;

/// A method that may fail.
type Call<'a, T> = &'a dyn Fn() -> Option<T>;

/// Maximum number of coordinates for an ordinary program's dense matrices, which take too long beyond it.
const MOST_DENSE: usize = 300;
const GROWTH: [usize; 5] = [4, 8, 16, 32, 64];

/// All results for one system; `binary64` is the same model with its literals read as binary64, `chain` makes the
/// chains for the growth.
pub fn bench(
    system: &LinearSystem,
    binary64: Option<&LinearSystem>,
    drives: &[Vec<Signal>],
    chain: &dyn Fn(usize) -> Option<LinearSystem>,
    clock: &mut Clock,
) -> Result<Bench, AnalysisError> {
    let reference = Reference::of(system)?;
    let mut entries = spectrum::frequencies(system, &reference, clock);
    entries.extend(spectrum::poles(system, &reference, clock));
    entries.extend(transfer::transfer(system, &reference, clock));
    let (problem, motion) = motion::motion(system, drives, &reference, clock)?;
    entries.extend(motion);
    mark_pareto(&mut entries);
    let growth = GROWTH.iter().filter_map(|&n| growth(&chain(n)?, clock)).collect();
    Ok(Bench {
        coordinates: system.n(),
        problem,
        bound_quality: spectrum::bound_quality(system, &reference),
        reading: binary64.and_then(|other| spectrum::distance(&reference, other)),
        entries,
        growth,
    })
}

/// The reference that errors are measured against.
struct Reference {
    modes: Modes,
    poles: Poles,
}

impl Reference {
    fn of(system: &LinearSystem) -> Result<Reference, AnalysisError> {
        let modes = analysis::all_modes(system, &Request::default().to_digits(28))?;
        let poles = analysis::poles(system, &modes)?;
        Ok(Reference { modes, poles })
    }

    /// omega of the oscillations, rad/s, ascending.
    fn oscillations(&self) -> Vec<f64> {
        let of = |mode: &&analysis::Mode| mode.kind == ModeKind::Oscillation;
        self.modes.list.iter().filter(of).map(|mode| mode.omega.to_f64()).collect()
    }
}

/// The result of a call, and the least time of several runs.
fn time_best<T>(clock: &mut Clock, mut call: impl FnMut() -> T) -> (T, f64) {
    const ENOUGH: f64 = 0.01;
    let from = clock();
    let mut result = call();
    let (mut best, mut spent) = (clock() - from, 0.0);
    let mut calls = 1u32;
    while spent + best * f64::from(calls) < ENOUGH && calls < 1 << 16 {
        let from = clock();
        for _ in 0..calls {
            result = call();
        }
        let each = (clock() - from) / f64::from(calls);
        spent += each * f64::from(calls);
        best = best.min(each);
        calls *= 2;
    }
    (result, best)
}

impl Entry {
    fn of_vibc(question: Question, method: &str, seconds: f64, error: f64, bound: f64) -> Entry {
        let (error, bound) = (Some(error), Some(bound).filter(|bound| bound.is_finite()));
        let method = method.to_string();
        Entry { question, method, ordinary: false, seconds, error, bound, pareto: false, chosen: false, note: "" }
    }

    fn ordinary(question: Question, method: &str, seconds: f64, error: Option<f64>) -> Entry {
        let error = error.filter(|error| error.is_finite());
        let note = if error.is_some() { "" } else { "fails" };
        let method = method.to_string();
        Entry { question, method, ordinary: true, seconds, error, bound: None, pareto: false, chosen: false, note }
    }

    fn choose(self) -> Entry {
        Entry { chosen: true, ..self }
    }

    fn note(self, note: &'static str) -> Entry {
        Entry { note, ..self }
    }
}

fn mark_pareto(entries: &mut [Entry]) {
    let points: Vec<(Question, f64, Option<f64>)> = entries.iter().map(|e| (e.question, e.seconds, e.error)).collect();
    for entry in entries {
        let Some(error) = entry.error else { continue };
        entry.pareto = !points.iter().any(|&(question, seconds, other)| {
            let Some(other) = other.filter(|_| question == entry.question) else { return false };
            seconds <= entry.seconds && other <= error && (seconds < entry.seconds || other < error)
        });
    }
}

fn growth(system: &LinearSystem, clock: &mut Clock) -> Option<Growth> {
    let reference = Reference::of(system).ok()?;
    let entries = spectrum::frequencies(system, &reference, clock);
    let of = |ordinary: bool| {
        let entry = entries.iter().find(|e| e.ordinary == ordinary && e.error.is_some())?;
        Some((entry.seconds, entry.error?))
    };
    Some(Growth { coordinates: system.n(), ours: of(false)?, ordinary: of(true)? })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::test_systems::oscillator;
    use crate::base::Number;

    /// A clock that ticks once at each reading: all methods take the same time, so only the error matters.
    #[test]
    fn an_oscillator_is_solved_by_all_methods() {
        let mut ticks = 0.0;
        let mut clock = || {
            ticks += 0.01;
            ticks
        };
        let system = oscillator("1", "2", "4");
        let found = bench(&system, None, &[], &|_| None, &mut clock).expect("a small system");
        for question in Question::ALL {
            let entries: Vec<&Entry> = found.entries.iter().filter(|e| e.question == question).collect();
            assert!(entries.iter().any(|e| e.ordinary) && entries.iter().any(|e| e.chosen && !e.ordinary));
            assert!(entries.iter().any(|e| e.pareto), "{question:?}");
            for entry in entries {
                let error = entry.error.unwrap_or_else(|| panic!("{} fails", entry.method));
                assert!(entry.bound.is_none_or(|bound| error <= bound), "{}: {error:e}", entry.method);
                assert!(entry.ordinary || error < 1.2e-16, "{}: {error:e}", entry.method);
            }
        }
        assert!(!found.problem.own && found.growth.is_empty() && found.reading.is_none());
    }

    /// Errors fall with the order of each method: with four times as many steps, the error is 256 or 16 times smaller,
    /// until rounding shows.
    #[test]
    fn each_method_has_its_order() {
        let mut ticks = 0.0;
        let mut clock = || {
            ticks += 0.01;
            ticks
        };
        let reference = Reference::of(&oscillator("1", "0.1", "4")).expect("modes");
        let (_, entries) = motion::motion(&oscillator("1", "0.1", "4"), &[], &reference, &mut clock).expect("a motion");
        let error = |method: &str| {
            let found = entries.iter().find(|entry| entry.method == format!("{method} steps per period"));
            found.and_then(|entry| entry.error).expect("a method")
        };
        for (method, order) in [("Runge-Kutta 4", 256.0), ("Newmark", 16.0), ("generalised alpha", 16.0)] {
            let ratio = error(&format!("{method}, 20")) / error(&format!("{method}, 80"));
            assert!((ratio / order - 1.0).abs() < 0.25, "{method}: {ratio}");
        }
    }

    /// Signals that move nothing give errors no size: the first coordinate is released instead.
    #[test]
    fn where_nothing_moves_there_are_errors_too() {
        let system = oscillator("1", "0.1", "4");
        let reference = Reference::of(&system).expect("modes");
        let still = vec![vec![Signal::Step { value: Number::ZERO, at: Number::ZERO }]];
        let mut ticks = 0.0;
        let mut clock = || {
            ticks += 0.01;
            ticks
        };
        let (problem, entries) = motion::motion(&system, &still, &reference, &mut clock).expect("a motion");
        assert!(!problem.own && entries.len() > 4, "{problem:?}");
        assert!(entries.iter().all(|entry| entry.error.is_some_and(f64::is_finite)), "{entries:?}");
    }

    #[test]
    fn methods_on_the_pareto_front_are_not_beaten() {
        let entry = |seconds, error| Entry::ordinary(Question::Poles, "", seconds, Some(error));
        let mut entries = vec![entry(1.0, 1e-3), entry(2.0, 1e-6), entry(3.0, 1e-5), entry(4.0, 1e-9)];
        mark_pareto(&mut entries);
        assert_eq!(entries.iter().map(|e| e.pareto).collect::<Vec<_>>(), [true, true, false, true]);
    }
}
