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
    let of = |term: &Term| {
        let widest = form.row(term).iter().map(|(_, factor)| factor.to_f64().abs()).fold(0.0, f64::max);
        Some(exponent(term.weight.to_f64())? + 2 * exponent(widest)?)
    };
    form.terms().iter().filter_map(of).max()
}
