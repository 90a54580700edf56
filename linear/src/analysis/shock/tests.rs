//! Shock spectra of soft and of uncertain oscillators: what the bounds have to hold. Closed forms of stiffer ones are in the tests of
//! the program.

use super::{Grid, Quantity, Request, ShockRow, shock};
use crate::base::{Ball, Number, Rational};
use crate::kernel::philox::philox;
use crate::system::{Course, Signal, Table};

fn number(x: f64) -> Number {
    Number::from(Rational::from_f64(x).expect("finite"))
}

fn row(values: &[Number], frequency: f64, damping: f64) -> ShockRow {
    let times = (0..values.len()).map(|i| Number::from(i as i64)).collect();
    let table = Table { times, values: values.to_vec(), course: Course::LinesToZero, period: None };
    let request = Request {
        quantity: Quantity::RelativeDisplacement,
        damping: number(damping),
        grid: Grid::At(vec![number(frequency)]),
    };
    shock(&[Signal::Table(table)], 2, &request).expect("a spectrum").rows.remove(0)
}

/// The largest and the least double integral of -a, a in lines between whole seconds: from its values where a or the first
/// integral is zero, and at the ends.
fn of_a_free_mass(values: &[f64]) -> [f64; 2] {
    let (mut z, mut v) = (0.0, 0.0);
    let mut ends = [0.0_f64, 0.0];
    for pair in values.windows(2) {
        let (a, b) = (-pair[0], -(pair[1] - pair[0]));
        let at = |t: f64| z + t * (v + t * (a / 2.0 + t * b / 6.0));
        // v + a t + b t^2 / 2 = 0
        let root = (a * a - 2.0 * b * v).sqrt();
        let first = -(a + root.copysign(a));
        for t in [1.0, first / b, 2.0 * v / first] {
            if (0.0..=1.0).contains(&t) {
                ends = [ends[0].max(at(t)), ends[1].min(at(t))];
            }
        }
        (z, v) = (at(1.0), v + a + b / 2.0);
    }
    ends
}

/// An oscillator of 1e-7 Hz hardly feels its spring in ten seconds, and its motion between events is that of the base alone: the
/// largest value often lies between two others that are nearly as large. (omega t)^2 / 12 = 3e-12 of the motion is what the spring
/// does.
#[test]
fn maxima_that_the_base_makes_within_a_step_are_seen() {
    for case in 0..300 {
        let words = [philox([case, 0, 0, 0], [5, 0]), philox([case, 1, 0, 0], [5, 0])].concat();
        let values: Vec<f64> = words.iter().map(|word| f64::from(word >> 26) / 32.0 - 1.0).collect();
        let numbers: Vec<Number> = values.iter().map(|x| number(*x)).collect();
        let found = row(&numbers, 1e-7, 0.0).primary;
        let [most, least] = of_a_free_mass(&values);
        for (found, truth) in [(found.positive, most), (found.negative, -least)] {
            let size = most.max(-least);
            let off = (found.to_f64() - truth).abs();
            assert!(off <= found.rad + 1e-11 * size && found.rad < 1e-6 * size, "{values:?}: {found:?} and {truth}");
        }
    }
}

/// A signal known to a millionth moves the oscillator by anything between the motions under the largest and the least of it: these
/// are in the enclosures, and they are at most three times wider.
#[test]
fn uncertainty_of_the_signal_is_in_the_maxima() {
    // The second one has its largest value within the first piece, before which nothing is uncertain.
    let shapes: [(&[f64], f64); 2] = [(&[0.0, 1.0, -0.5, 0.25, 0.75, 0.0], 0.3), (&[1.0, 1.0], 0.8)];
    for ((shape, frequency), scale) in shapes.into_iter().flat_map(|shape| [(shape, 1.0 - 1e-6), (shape, 1.0 + 1e-6)]) {
        let scaled = |scale: Ball| {
            let values: Vec<Number> = shape.iter().map(|x| Number::Ball(scale * Ball::from(*x))).collect();
            row(&values, frequency, 0.05)
        };
        let (wide, one) = (scaled(Ball::ONE.widen(1e-6)), scaled(Ball::from(scale)));
        for (wide, one) in [(wide.primary, one.primary), (wide.residual, one.residual)] {
            for (wide, one) in [(wide.positive, one.positive), (wide.negative, one.negative)] {
                let off = (wide - one).mid.hi.abs();
                assert!(off <= wide.rad + one.rad, "{scale}: {wide:?} and {one:?}");
            }
        }
    }
}
