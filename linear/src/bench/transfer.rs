//! Methods for the transfer function: at resonances, between them, and below and above them all.

use super::ordinary::Matrices;
use super::{Clock, Entry, MOST_DENSE, Question, Reference, time_best};
use crate::analysis::{Frequency, Gain, ModalSum, Transfer};
use crate::base::{Dd, Number, Rational};
use crate::system::{Coordinate, CoordinateId, Input, LinearSystem, Output};
use nalgebra::Complex;

/// The most resonances that are used.
const MOST: usize = 12;

/// The force and the displacement of the first coordinate, and the frequencies: each resonance, the geometric means of
/// neighbours, and half and twice the ends.
pub fn transfer(system: &LinearSystem, reference: &Reference, clock: &mut Clock) -> Vec<Entry> {
    let question = Question::Transfer;
    let system = &driving_point(system);
    let omegas = frequencies(reference);
    let frequency = |&omega: &f64| Rational::from_f64(omega).map(|w| Frequency::radians(&Number::from(w)));
    let frequencies: Vec<Frequency> = omegas.iter().filter_map(frequency).collect();
    let transfer = Transfer::of(system);
    let one_by_one = || -> Vec<Gain> { frequencies.iter().map(|f| transfer.between(f, &[0], &[0])[0][0]).collect() };
    let (truth, seconds) = time_best(clock, one_by_one);
    let mut entries = vec![of_vibc("vibc, elimination", &truth, &truth, seconds).choose()];
    let (gains, seconds) = time_best(clock, || transfer.at_frequencies(&frequencies, &[0], &[0], 1e-17));
    entries.push(of_vibc("vibc, several frequencies at once", &gains, &truth, seconds));
    if let Some(sum) = ModalSum::of(system, &reference.modes) {
        let pair = sum.pair(system, 0, 0);
        let (gains, seconds) = time_best(clock, || sum.fast(&pair, &frequencies));
        entries.push(
            of_vibc("vibc, sum over modes in binary64", &gains, &truth, seconds).note("without the time for the modes"),
        );
        let (gains, seconds) =
            time_best(clock, || frequencies.iter().map(|f| sum.accurate(&pair, f)).collect::<Vec<_>>());
        entries.push(
            of_vibc("vibc, sum over modes in double-double", &gains, &truth, seconds)
                .note("without the time for the modes"),
        );
    }
    if system.n() > MOST_DENSE {
        return entries;
    }
    let matrices = Matrices::of(system);
    let (values, seconds) =
        time_best(clock, || omegas.iter().map(|&w| matrices.solve(w, 0, 0)).collect::<Option<Vec<_>>>());
    entries.push(Entry::ordinary(question, "LU of assembled M, C, K", seconds, worst(values, &truth)));
    if let Some((squares, shapes)) = matrices.modes() {
        let sum = || Some(omegas.iter().map(|&w| modal_sum(&matrices, &squares, &shapes, w)).collect::<Vec<_>>());
        let (values, seconds) = time_best(clock, sum);
        let entry =
            Entry::ordinary(question, "sum over modes, damping between them neglected", seconds, worst(values, &truth));
        entries.push(entry.note("without the time for the modes"));
    }
    entries
}

/// The system with one input and one output.
fn driving_point(system: &LinearSystem) -> LinearSystem {
    let mut system = system.clone();
    let at = || vec![(CoordinateId(0), Number::ONE)];
    let Coordinate { name, span, .. } = system.coordinates[0];
    system.inputs = vec![Input { name, span, unit: "N", b: [at(), Vec::new(), Vec::new()], undamped: None }];
    let nothing = || [Vec::new(), Vec::new(), Vec::new()];
    system.outputs = vec![Output { name, unit: "m".into(), p: [at(), Vec::new(), Vec::new()], d: nothing() }];
    system
}

fn frequencies(reference: &Reference) -> Vec<f64> {
    let resonances: Vec<f64> = reference.oscillations().into_iter().take(MOST).collect();
    let (Some(first), Some(last)) = (resonances.first(), resonances.last()) else { return vec![1.0, 10.0] };
    let between = resonances.windows(2).map(|w| (w[0] * w[1]).sqrt());
    let mut list: Vec<f64> = resonances.iter().copied().chain(between).chain([0.5 * first, 2.0 * last]).collect();
    list.sort_by(f64::total_cmp);
    list.dedup();
    list
}

fn of_vibc(method: &str, gains: &[Gain], truth: &[Gain], seconds: f64) -> Entry {
    let known = || gains.iter().zip(truth).filter_map(|(gain, truth)| Some((gain.disc()?, truth.disc()?)));
    let error = known().map(|(disc, truth)| {
        relative_error((disc.value.re.to_f64(), disc.value.im.to_f64()), truth.value.re, truth.value.im)
    });
    let bound = known().map(|(disc, _)| {
        let printed = (disc.value.re.to_f64(), disc.value.im.to_f64());
        disc.relative_error() + relative_error(printed, disc.value.re, disc.value.im)
    });
    Entry::of_vibc(Question::Transfer, method, seconds, error.fold(0.0, f64::max), bound.fold(0.0, f64::max))
}

/// Relative error of a value in the complex plane.
fn relative_error((re, im): (f64, f64), true_re: Dd, true_im: Dd) -> f64 {
    let difference = libm::hypot((Dd::from(re) - true_re).to_f64(), (Dd::from(im) - true_im).to_f64());
    let size = libm::hypot(true_re.to_f64(), true_im.to_f64());
    if difference == 0.0 { 0.0 } else { difference / size }
}

fn worst(values: Option<Vec<Complex<f64>>>, truth: &[Gain]) -> Option<f64> {
    let errors = values?.into_iter().zip(truth).filter_map(|(z, truth)| {
        let truth = truth.disc()?;
        Some(relative_error((z.re, z.im), truth.value.re, truth.value.im))
    });
    errors.map(Some).try_fold(0.0f64, |worst, error| error.filter(|e| e.is_finite()).map(|e| worst.max(e)))
}

fn modal_sum(
    matrices: &Matrices,
    squares: &nalgebra::DVector<f64>,
    shapes: &nalgebra::DMatrix<f64>,
    omega: f64,
) -> Complex<f64> {
    let term = |i: usize| {
        let shape = shapes.column(i);
        let damping = (shape.transpose() * &matrices.c * shape)[(0, 0)];
        Complex::new(shape[0] * shape[0], 0.0) / Complex::new(squares[i] - omega * omega, omega * damping)
    };
    (0..squares.len()).map(term).sum()
}
