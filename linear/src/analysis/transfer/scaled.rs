//! Frequencies and forms near the ends of binary64: the same H, of the system in other units of time and of force. In: a
//! system and a frequency. Out: both in units in which s^2 M, s C and K are of ordinary size.
//!
//! With s = 2^t s', Q'(s') = 2^f (s'^2 2^(2t) M + s' 2^t C + K) is 2^f Q(s); B gets 2^f too, so H stays the same. Powers of
//! two cause no rounding: the numbers of the model are scaled before they are rounded. See docs/method/transfer.md.

use super::Frequency;
use crate::analysis::modes::scale::{PLAIN, exponent, power, times};
use crate::base::Number;
use crate::system::{CoordinateId, Form, LinearSystem, Term};

/// `None` if all numbers are of ordinary size.
pub fn scale(system: &LinearSystem, frequency: &Frequency) -> Option<(LinearSystem, Frequency)> {
    let time = exponent(frequency.omega.mid.hi)?;
    let forms = [&system.k, &system.c, &system.m];
    let sizes = forms.iter().zip([0, time, 2 * time]).filter_map(|(form, moved)| Some(largest(form)? + moved));
    let force = -sizes.max()?;
    if time.abs() <= PLAIN && force.abs() <= PLAIN {
        return None;
    }
    let mut moved = system.clone();
    moved.k = times(&system.k, force)?;
    moved.c = times(&system.c, time + force)?;
    moved.m = times(&system.m, 2 * time + force)?;
    for input in &mut moved.inputs {
        input.undamped = None;
        for (b, order) in input.b.iter_mut().zip(0..) {
            rows(b, order * time + force)?;
        }
    }
    for output in &mut moved.outputs {
        for (p, order) in output.p.iter_mut().zip(0..) {
            rows(p, order * time)?;
        }
        for (d, order) in output.d.iter_mut().zip(0..) {
            let factor = power(order * time)?;
            d.iter_mut().for_each(|(_, value)| *value = &*value * &factor);
        }
    }
    let factor = power(-time)?;
    let frequency = match frequency.exact() {
        Some(omega) => Frequency::radians(&(omega * &factor)),
        None => Frequency::hertz(&(&frequency.hertz * &factor)),
    };
    Some((moved, frequency))
}

fn rows(row: &mut [(CoordinateId, Number)], exponent: i32) -> Option<()> {
    let factor = power(exponent)?;
    row.iter_mut().for_each(|(_, value)| *value = &*value * &factor);
    Some(())
}

/// The exponent of the largest weight times the square of its row.
fn largest(form: &Form) -> Option<i32> {
    let of = |term: Term| {
        let widest = form.row(term).iter().map(|(_, factor)| factor.to_f64().abs()).fold(0.0, f64::max);
        Some(exponent(term.weight.to_f64())? + 2 * exponent(widest)?)
    };
    form.terms().filter_map(of).max()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::test_systems::oscillator;
    use crate::base::Rational;

    /// H of one mass as (numerator, denominator) in exact fractions, each real and imaginary.
    fn fraction(system: &LinearSystem, frequency: &Frequency) -> [[Number; 2]; 2] {
        let omega = frequency.exact().expect("exact").clone();
        let times = |[a, b]: &[Number; 2], [c, d]: &[Number; 2]| [&(a * c) - &(b * d), &(a * d) + &(b * c)];
        let plus = |[a, b]: &[Number; 2], [c, d]: &[Number; 2]| [a + c, b + d];
        let real = |x: Number| [x, Number::ZERO];
        let s = [Number::ZERO, omega];
        let sum =
            |of: [Number; 3]| of.into_iter().rev().fold(real(Number::ZERO), |sum, x| plus(&times(&sum, &s), &real(x)));
        let form = |form: &Form| {
            let of = |term: Term| form.row(term).iter().fold(term.weight.clone(), |w, (_, a)| &(&w * a) * a);
            form.terms().map(of).fold(Number::ZERO, |sum, x| &sum + &x)
        };
        let row = |row: &[(CoordinateId, Number)]| row.iter().fold(Number::ZERO, |sum, (_, x)| &sum + x);
        let below = sum([form(&system.k), form(&system.c), form(&system.m)]);
        let (b, p) = ([0, 1, 2].map(|i| row(&system.inputs[0].b[i])), [0, 1, 2].map(|i| row(&system.outputs[0].p[i])));
        let d = [0, 1, 2].map(|i| system.outputs[0].d[i].iter().fold(Number::ZERO, |sum, (_, x)| &sum + x));
        [plus(&times(&sum(p), &sum(b)), &times(&sum(d), &below)), below]
    }

    /// Numbers of all sizes: in the other units they are of ordinary size, and H is the same fraction, exactly.
    #[test]
    fn h_is_the_same_fraction_in_the_other_units() {
        let mut count = 0;
        for m in ["3e-90", "5", "7e60"] {
            for (c, k) in [("0", "2e-50"), ("1e-70", "3"), ("4e80", "1e120")] {
                for omega in ["1e-60", "3", "7e70"] {
                    let mut system = oscillator(m, c, k);
                    let at = |x: &str| vec![(CoordinateId(0), Number::from(x))];
                    system.inputs[0].b = [at("2"), at("3e-5"), at("7")];
                    system.outputs[0].p = [at("1"), at("0.3"), at("5e3")];
                    system.outputs[0].d = [(); 3].map(|()| vec![(0, Number::from("0.7"))]);
                    let frequency = Frequency::radians(&Number::from(omega));
                    let Some((moved, other)) = scale(&system, &frequency) else { continue };
                    count += 1;
                    let [[above, below], [other_above, other_below]] =
                        [fraction(&system, &frequency), fraction(&moved, &other)];
                    let times = |[a, b]: &[Number; 2], [c, d]: &[Number; 2]| [&(a * c) - &(b * d), &(a * d) + &(b * c)];
                    let off: Vec<Number> = times(&above, &other_below)
                        .iter()
                        .zip(&times(&other_above, &below))
                        .map(|(a, b)| a - b)
                        .collect();
                    assert!(
                        off.iter().all(|x| x.exact().is_some_and(Rational::is_zero)),
                        "{m} {c} {k} {omega}: {off:?}"
                    );
                    // s'^2 M, s' C and K are at most of the size of one, the largest within a few bits of it.
                    let w = other.omega.to_f64();
                    let sizes = [(&moved.k, 1.0), (&moved.c, w), (&moved.m, w * w)]
                        .map(|(form, factor)| form.terms().map(|term| term.weight.to_f64()).sum::<f64>() * factor);
                    let largest = sizes.iter().fold(0.0f64, |most, &size| most.max(size));
                    assert!(
                        (0.5..2.0f64.powi(5)).contains(&largest) && (1.0..2.0).contains(&w),
                        "{m} {c} {k} {omega}: {sizes:?}"
                    );
                }
            }
        }
        assert!(count > 20, "{count}");
        assert!(scale(&oscillator("2", "0.1", "5"), &Frequency::radians(&Number::from("3"))).is_none());
    }
}
