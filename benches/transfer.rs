//! The cost of transfer functions and of motions, compared with an ordinary program: one complex LU in binary64 for
//! each frequency, Runge-Kutta steps for a motion. `cargo bench --bench transfer`; the last results are in
//! benches/README.md.
//!
//! Times are processor times, not wall-clock times, if the system reports them: the least of several runs. What counts
//! is the ratio to the alternative in the same run. Computations at many frequencies use all cores, so they are timed
//! by the wall clock.

use nalgebra::{Complex, DMatrix, DVector};
use std::fs;
use std::hint::black_box;
use std::io::Write;
use std::time::Instant;
use vibc::analysis::{self, Frequency, ModalSum, Signal, Transfer};
use vibc::base::{FileId, Name, Number, Span, Words};
use vibc::system::{Coordinate, CoordinateId, CoordinateKind, Form, Input, Label, LinearSystem, Nature, Output};

/// n masses of 1 kg between springs of 1000 N/m and dampers of 0.3 N*s/m, one end held; a force on the first mass, the
/// displacement there.
fn chain(n: usize) -> LinearSystem {
    chain_of(n, |_| Number::ONE)
}

/// A chain like `chain`, with masses that all differ, by up to a tenth.
fn uneven(n: usize) -> LinearSystem {
    chain_of(n, |i| &Number::ONE + &(&Number::from((i * 7919 % 10_007) as i64) / &Number::from(100_070)))
}

fn chain_of(n: usize, mass: impl Fn(usize) -> Number) -> LinearSystem {
    let mut words = Words::new();
    let name = Label { name: Name::plain(words.intern("x")), motion: "" };
    let coordinate = Coordinate { name, kind: CoordinateKind::Translation, span: Span::new(FileId(0), 0, 0) };
    let (mut m, mut c, mut k) = (Form::new(), Form::new(), Form::new());
    let sources = [m.source(name), c.source(name), k.source(name)];
    let id = |i: usize| CoordinateId(i as u32);
    for i in 0..n {
        let between = |i: usize| {
            let back = i.checked_sub(1).map(|j| (id(j), Number::from(-1)));
            [(id(i), Number::ONE)].into_iter().chain(back)
        };
        m.push(sources[0], Nature::Property, mass(i), [(id(i), Number::ONE)]);
        c.push(sources[1], Nature::Property, Number::from("0.3"), between(i));
        k.push(sources[2], Nature::Property, Number::from(1000), between(i));
    }
    let at = |i: usize| vec![(id(i), Number::ONE)];
    LinearSystem {
        words,
        coordinates: vec![coordinate.clone(); n],
        m,
        c,
        k,
        chain: Vec::new(),
        inputs: vec![Input {
            name,
            span: coordinate.span,
            unit: "N",
            b: [at(0), Vec::new(), Vec::new()],
            undamped: None,
        }],
        outputs: vec![Output {
            name,
            unit: "m".into(),
            p: [at(0), Vec::new(), Vec::new()],
            d: [Vec::new(), Vec::new(), Vec::new()],
        }],
        initial: Vec::new(),
        losses: None,
    }
}

/// The work of an ordinary program for a frequency: assemble, factor, solve.
fn bare_solve(n: usize, omega: f64) -> Complex<f64> {
    let (a, b) = (Complex::new(2000.0 - omega * omega, 0.6 * omega), Complex::new(-1000.0, -0.3 * omega));
    let mut q = DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
        0 => a,
        1 => b,
        _ => Complex::new(0.0, 0.0),
    });
    q[(n - 1, n - 1)] = Complex::new(1000.0 - omega * omega, 0.3 * omega);
    let load = DVector::from_fn(n, |i, _| Complex::new(if i == 0 { 1.0 } else { 0.0 }, 0.0));
    q.lu().solve(&load).map_or(Complex::new(f64::NAN, 0.0), |x| x[n - 1])
}

fn frequency(i: usize) -> Frequency {
    Frequency::hertz(&(&Number::from(1 + i as i64) / &Number::from(1000)))
}

/// Processor seconds that this process has used so far.
fn now(start: &Instant) -> f64 {
    let reported = fs::read_to_string("/proc/self/schedstat").ok();
    let nanoseconds = reported.and_then(|text| text.split(' ').next().and_then(|ns| ns.parse::<f64>().ok()));
    nanoseconds.map_or_else(|| start.elapsed().as_secs_f64(), |ns| ns * 1e-9)
}

/// The least processor time of a call in s, from runs of at least a twentieth of a second.
fn time<T>(call: impl FnMut() -> T) -> f64 {
    least(now, call)
}

/// The least wall-clock time of a call in s.
fn clock<T>(call: impl FnMut() -> T) -> f64 {
    least(|start| start.elapsed().as_secs_f64(), call)
}

fn least<T>(now: impl Fn(&Instant) -> f64, mut call: impl FnMut() -> T) -> f64 {
    let start = Instant::now();
    let mut best = f64::INFINITY;
    for _ in 0..5 {
        // Reading the clock takes time: as many calls as fit into a tenth of a second, and two readings.
        let mut calls = 1;
        let each = loop {
            let from = now(&start);
            (0..calls).for_each(|_| drop(black_box(call())));
            let spent = now(&start) - from;
            if spent > 0.05 {
                break spent / f64::from(calls);
            }
            calls *= 4;
        };
        best = best.min(each);
    }
    best
}

fn say(text: &str) {
    let _ = writeln!(std::io::stdout(), "{text}");
}

fn transfer() {
    let frequencies: Vec<Frequency> = (0..10_000).map(frequency).collect();
    say("transfer of 10,000 frequencies on a damped chain, the force's own place");
    say("     n  method                        per frequency      per second   against one LU");
    for n in [5, 10, 20, 100, 200, 2000] {
        let system = chain(n);
        let transfer = Transfer::of(&system);
        let dense = if n <= 200 { Some(time(|| bare_solve(n, black_box(14.7)))) } else { None };
        let row = |method: &str, each: f64| {
            let ratio = dense.map_or("-".into(), |dense| format!("{:.3}", each / dense));
            say(&format!("{n:6}  {method:28}  {:10.1} ns  {:12.3e}   {ratio:>14}", each * 1e9, 1.0 / each));
        };
        dense.into_iter().for_each(|dense| row("one dense LU, no bound", dense));
        let f = frequency(2345);
        row("one by one, with bound", time(|| transfer.between(black_box(&f), &[0], &[0])));
        for (method, tolerance) in [("many, to the last digit", 1e-17), ("many, to 1e-12", 1e-12)] {
            row(method, clock(|| transfer.at_frequencies(black_box(&frequencies), &[0], &[0], tolerance)) / 1e4);
        }
        if n <= 100 {
            let modes = analysis::modes(&system).expect("a regular system");
            let sum = ModalSum::of(&system, &modes).expect("proportional damping");
            let pair = sum.pair(&system, 0, 0);
            row("sum over modes, binary64", time(|| sum.fast(black_box(&pair), std::slice::from_ref(black_box(&f)))));
            row("sum over modes, many", time(|| sum.fast(black_box(&pair), black_box(&frequencies))) / 1e4);
            row("sum over modes, double-double", time(|| sum.accurate(black_box(&pair), black_box(&f))));
        }
    }
}

/// A chain that does not repeat itself, also read at its other end: no solution can be reused for another.
fn transfer_of_uneven() {
    let frequencies: Vec<Frequency> = (0..10_000).map(frequency).collect();
    say("the same for masses that are all different, at the force and at the other end");
    for n in [20, 200, 2000] {
        for at in [0, n - 1] {
            let mut system = uneven(n);
            system.outputs[0].p[0][0].0 = CoordinateId(at as u32);
            let transfer = Transfer::of(&system);
            let each = clock(|| transfer.at_frequencies(black_box(&frequencies), &[0], &[0], 1e-17)) / 1e4;
            let place = if at == 0 { "at the force" } else { "at the end" };
            say(&format!("{n:6}  many, {place:22}  {:10.1} ns  {:12.3e}", each * 1e9, 1.0 / each));
        }
    }
}

/// 20 coordinates under a harmonic force over 100 s at 1,001 times.
fn motion() {
    let system = chain(20);
    let times = analysis::grid(&Number::from(100), &Number::from("0.1"));
    let force =
        Signal::Harmonic { value: Number::ONE, frequency: Number::from("1.5"), phase: Number::ZERO, at: Number::ZERO };
    let drives = [vec![force]];
    say("motion of 20 coordinates under a harmonic force over 100 s at 1,001 times");
    let each = time(|| analysis::respond(black_box(&system), &drives, &times));
    say(&format!("  with bounds: {:.3} ms", each * 1e3));
    let modes = analysis::modes(&system).expect("a regular system");
    say(&format!("  the modes: {:.3} ms", time(|| analysis::modes(black_box(&system))) * 1e3));
    say(&format!("  made ready: {:.3} ms", time(|| ModalSum::of(black_box(&system), &modes)) * 1e3));
}

fn main() {
    transfer();
    transfer_of_uneven();
    motion();
}
