//! The cost of a transfer function and of a motion, beside what an ordinary program does: one complex LU in binary64 for a
//! frequency, Runge and Kutta's steps for a motion. `cargo bench --bench transfer`; the last numbers are in benches/README.md.

use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::{Complex, DMatrix, DVector};
use std::hint::black_box;
use std::time::Duration;
use vibc::analysis::{self, Frequency, ModalSum, Signal, Transfer};
use vibc::base::{FileId, Name, Number, Span, Words};
use vibc::system::{Coordinate, CoordinateId, CoordinateKind, Form, Input, Label, LinearSystem, Nature, Output};

/// n masses of 1 kg between springs of 1000 N/m and dampers of 0.3 N*s/m, one end held; a force on the first mass, the
/// displacement of the last.
fn chain(n: usize) -> LinearSystem {
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
        m.push(sources[0], Nature::Property, Number::ONE, [(id(i), Number::ONE)]);
        c.push(sources[1], Nature::Property, Number::from("0.3"), between(i));
        k.push(sources[2], Nature::Property, Number::from(1000), between(i));
    }
    let at = |i: usize| vec![(id(i), Number::ONE)];
    LinearSystem {
        words,
        coordinates: vec![coordinate; n],
        m,
        c,
        k,
        inputs: vec![Input { name, unit: "N", b: [at(0), Vec::new(), Vec::new()] }],
        outputs: vec![Output {
            name,
            unit: "m".into(),
            p: [at(n - 1), Vec::new(), Vec::new()],
            d: [Vec::new(), Vec::new(), Vec::new()],
        }],
        initial: Vec::new(),
    }
}

/// What an ordinary program does for a frequency: assemble, factor, solve.
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

fn transfer(criterion: &mut Criterion) {
    for n in [5, 10, 20, 30] {
        let system = chain(n);
        let modes = analysis::modes(&system).expect("a regular system");
        let transfer = Transfer::of(&system);
        let sum = ModalSum::of(&system, &modes).expect("proportional damping");
        let pair = sum.pair(&system, 0, 0);
        let f = frequency(2345);
        let mut group = criterion.benchmark_group(format!("transfer, n = {n}"));
        group.sample_size(20).measurement_time(Duration::from_millis(500)).warm_up_time(Duration::from_millis(200));
        group.bench_function("bare solve", |b| b.iter(|| bare_solve(n, black_box(14.7))));
        group.bench_function("solution with bound", |b| b.iter(|| transfer.between(black_box(&f), &[0], &[0])));
        group.bench_function("sum, binary64", |b| b.iter(|| sum.fast(black_box(&pair), black_box(&f))));
        group.bench_function("sum, double-double", |b| b.iter(|| sum.accurate(black_box(&pair), black_box(&f))));
        group.finish();
    }
}

/// 20 coordinates under a harmonic force over 100 s at 1,001 times.
fn motion(criterion: &mut Criterion) {
    let system = chain(20);
    let times = analysis::grid(&Number::from(100), &Number::from("0.1"));
    let force = Signal::Harmonic { value: Number::ONE, frequency: Number::from("1.5"), phase: Number::ZERO };
    let drives = [vec![force]];
    let mut group = criterion.benchmark_group("motion, n = 20");
    group.sample_size(10).measurement_time(Duration::from_millis(500)).warm_up_time(Duration::from_millis(200));
    group.bench_function("1001 samples", |b| b.iter(|| analysis::respond(black_box(&system), &drives, &times)));
    group.finish();
}

criterion_group!(benches, transfer, motion);
criterion_main!(benches);
