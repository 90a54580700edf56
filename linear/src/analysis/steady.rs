//! The steady state under harmonic signals: for each frequency the periodic motion y = |a| sin(2 pi f t + arg a), where
//! a is the sum of H(i 2 pi f) times the signals' complex amplitudes. In: a transfer function and signals. Out: one
//! complex amplitude for each frequency and output. See docs/method/response.md#steady-state.
//!
//! It is the motion that remains after damping has removed all others; without damping a motion from rest never reaches
//! it, and where something feeds energy in the others may grow.

use crate::analysis::transfer::{Disc, Frequency, Gain, Transfer};
use crate::base::{Ball, Number, up};
use crate::kernel::complex::Complex;
use crate::system::{LinearSystem, Signal};

/// The motion of one frequency.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Steady {
    /// Hz
    pub frequency: Number,
    /// |a| is the amplitude and arg a the phase relative to sin(2 pi f t), one for each requested output; infinite at
    /// an undamped pole.
    pub outputs: Vec<Gain>,
}

/// The periodic motion of all outputs at the frequencies of harmonic signals; empty without one, and beside a table that comes again,
/// which has periodic motions of its own.
pub fn steady_alone(system: &LinearSystem, drives: &[Vec<Signal>]) -> Vec<Steady> {
    let mut signals = drives.iter().flatten();
    let is_harmonic = signals.clone().any(|signal| matches!(signal, Signal::Harmonic { .. }));
    if !is_harmonic || signals.any(Signal::comes_again) {
        return Vec::new();
    }
    let outputs: Vec<usize> = (0..system.outputs.len()).collect();
    steady(&Transfer::of(system), drives, &outputs)
}

/// The steady motion at each frequency of the harmonic signals, in their order.
pub fn steady(transfer: &Transfer, drives: &[Vec<Signal>], outputs: &[usize]) -> Vec<Steady> {
    let mut list: Vec<Steady> = Vec::new();
    for (input, signals) in drives.iter().enumerate() {
        for signal in signals {
            let Signal::Harmonic { value, frequency, phase, .. } = signal else { continue };
            let gains = &transfer.between(&Frequency::hertz(frequency), &[input], outputs)[0];
            let added = gains.iter().map(|gain| scale(*gain, value, phase));
            match list.iter_mut().find(|known| known.frequency == *frequency) {
                Some(known) => known.outputs.iter_mut().zip(added).for_each(|(sum, gain)| *sum = plus(*sum, gain)),
                None => list.push(Steady { frequency: frequency.clone(), outputs: added.collect() }),
            }
        }
    }
    list
}

/// H times value exp(i phase).
fn scale(gain: Gain, value: &Number, phase: &Number) -> Gain {
    if value.is_zero() {
        return Gain::Finite(Disc { value: Complex::ZERO, radius: 0.0 });
    }
    let (Some(disc), Some((sine, cosine))) = (gain.disc(), phase.sin_cos()) else {
        return if gain == Gain::Infinite { gain } else { Gain::Unknown };
    };
    let amplitude = Complex::new(cosine.to_ball(), sine.to_ball()).scale(value.to_ball());
    let product = disc.value.to_ball() * amplitude;
    let radius = (product.radius() + disc.radius * value.to_ball().magnitude()) * up::THOUSANDS;
    Gain::Finite(Disc { value: product.mid(), radius })
}

/// Two infinite motions may cancel: their sum is unknown.
fn plus(a: Gain, b: Gain) -> Gain {
    match (a, b) {
        (Gain::Finite(a), Gain::Finite(b)) => {
            let sum: Complex<Ball> = a.value.to_ball() + b.value.to_ball();
            Gain::Finite(Disc { value: sum.mid(), radius: (sum.radius() + a.radius + b.radius) * up::THOUSANDS })
        }
        (Gain::Infinite, Gain::Finite(_)) | (Gain::Finite(_), Gain::Infinite) => Gain::Infinite,
        _ => Gain::Unknown,
    }
}
