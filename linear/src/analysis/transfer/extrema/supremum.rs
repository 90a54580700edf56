//! The largest |H| over a range of frequencies, or over all of them. In: a transfer function. Out: its supremum as an enclosure,
//! where it is proved that no extremum of |H| is missing. See docs/method/transfer.md#extrema.
//!
//! Within a range the supremum is the largest of the extrema and of the values at both ends. Where all zeros and poles are at most
//! T/K in size, each factor |i omega - z| is omega (1 +- 1/K) for omega >= T, so that for a proper H
//!
//! ```text
//! |H(i omega)| <= |H(i T)| ((1 + 1/K) / (1 - 1/K))^(zeros + poles)
//! ```

use super::{Exactly, Extrema, Extremum, FeatureKind, by_path};
use crate::analysis::answer::Poles;
use crate::analysis::transfer::{Frequency, Gain, Transfer};
use crate::base::{Ball, Dd, Number, Power, Rational};

/// The largest |H|.
#[derive(Clone, Copy, Debug)]
pub enum Supremum {
    Finite(Ball),
    /// A resonance without damping, or |H| grows with the frequency.
    Infinite,
}

/// T over the largest real or imaginary part of a zero or a pole.
const BEYOND: f64 = 1000.0;
const UNPROVED: &str = "it is not proved that the peaks which were found are all that there are";

/// Over a range in Hz, or over all frequencies; `poles` are those of the whole system. Without a proof the reason for that.
pub fn supremum(
    transfer: &Transfer,
    poles: Option<&Poles>,
    (input, output): (usize, usize),
    range: Option<(&Number, &Number)>,
) -> Result<Supremum, &'static str> {
    let found = transfer
        .zero_pole_form(input, output)
        .map(|exactly| of_zeros_and_poles(transfer, exactly, (input, output), range));
    if let Some(Ok(found)) = found {
        return Ok(found);
    }
    // Poles of the system with some motions held may prove what the coefficients of its determinant do not.
    let of_path = || Exactly::of(&by_path(transfer, poles?, input, output)?);
    match (of_path(), found) {
        (Some(exactly), _) => of_zeros_and_poles(transfer, &exactly, (input, output), range),
        (None, Some(found)) => found,
        (None, None) => Err(UNPROVED),
    }
}

fn of_zeros_and_poles(
    transfer: &Transfer,
    exactly: &Exactly,
    (input, output): (usize, usize),
    range: Option<(&Number, &Number)>,
) -> Result<Supremum, &'static str> {
    if range.is_none() && exactly.excess().ok_or(UNPROVED)? > 0 {
        return Ok(Supremum::Infinite);
    }
    let (low, high) = match range {
        Some((low, high)) => (Frequency::hertz(low), Frequency::hertz(high)),
        None => {
            let top = Rational::from_f64(BEYOND * exactly.largest().max(f64::MIN_POSITIVE)).ok_or(UNPROVED)?;
            (Frequency::radians(&Number::ZERO), Frequency::radians(&Number::from(top)))
        }
    };
    // An extremum at an end may lie on either side of it: it is looked for a little further out.
    let margin = |omega: Ball| Ball::from(omega.magnitude() * 1e-12);
    let Extrema { list, complete, .. } =
        exactly.extrema(low.omega - margin(low.omega), high.omega + margin(high.omega));
    complete.ok_or(UNPROVED)?;
    let is_within = |extremum: &Extremum| {
        let omega = extremum.frequency * Ball::PI * Ball::from(2.0);
        (omega - low.omega).is_positive() && (high.omega - omega).is_positive()
    };
    let at = |frequency: &Frequency| transfer.between(frequency, &[input], &[output])[0][0];
    let ends = [at(&low), at(&high)];
    let peaks = list.iter().filter(|extremum| extremum.kind == FeatureKind::Peak);
    let peaks = peaks.map(|extremum| (extremum.gain, is_within(extremum)));
    let mut largest = Largest::default();
    for (gain, is_within) in ends.map(|gain| (gain, true)).into_iter().chain(peaks) {
        match gain {
            Gain::Finite(disc) if is_within => largest.take(disc.gain(), 1.0),
            Gain::Finite(disc) => largest.at_most(disc.gain()),
            Gain::Infinite if is_within => return Ok(Supremum::Infinite),
            Gain::Infinite | Gain::Unknown => return Err("a frequency is too near to an undamped pole"),
        }
    }
    if range.is_none()
        && let Gain::Finite(disc) = ends[1]
    {
        // A root's size is at most the root of 2 times the larger one of its parts.
        let near = 1.5 / BEYOND;
        let spread = ((1.0 + near) / (1.0 - near)).power(exactly.roots() as i32) * (1.0 + 1e-12);
        largest.take(disc.gain(), spread);
    }
    Ok(Supremum::Finite(largest.ball()))
}

/// Between what bounds the largest of some numbers lies.
#[derive(Default)]
struct Largest {
    low: Dd,
    high: Dd,
}

impl Largest {
    /// Takes in a number, or a range from it up to a multiple of it.
    fn take(&mut self, value: Ball, spread: f64) {
        let off = Dd::from(value.rad * (1.0 + 1e-15));
        let low = value.mid - off;
        let high = if spread > 1.0 { Dd::from((value.mid + off).to_f64() * spread) } else { value.mid + off };
        self.low = if (low - self.low).hi > 0.0 { low } else { self.low };
        self.high = if (high - self.high).hi > 0.0 { high } else { self.high };
    }

    /// Takes in a number that may or may not be among them.
    fn at_most(&mut self, value: Ball) {
        let high = value.mid + Dd::from(value.rad * (1.0 + 1e-15));
        self.high = if (high - self.high).hi > 0.0 { high } else { self.high };
    }

    fn ball(&self) -> Ball {
        let middle = (self.low + self.high).scale(0.5);
        // Both are rounded by less than 1e-31 of themselves.
        let half = (self.high - middle).to_f64().max((middle - self.low).to_f64());
        Ball::new(middle, half * (1.0 + 1e-12) + middle.abs().to_f64() * 1e-31)
    }
}
