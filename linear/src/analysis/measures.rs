//! Single numbers that a model asks for or requires, by their definitions on the language page, each as a ball. In:
//! answers. Out: a value, or the reason why there is none. See docs/method/response.md.

use crate::analysis::answer::{ModeKind, Modes, Pole, PoleKind, Poles};
use crate::analysis::derived::hertz;
use crate::analysis::excitation::{Excitations, Excited};
use crate::analysis::forms::is_certain;
use crate::analysis::modes::buckling::least_load_factor;
use crate::analysis::rates::{Rate, from_rate_at_rest};
use crate::analysis::steady::steady;
use crate::analysis::transfer::extrema::{Supremum, supremum};
use crate::analysis::transfer::{Disc, Frequency, Gain, Transfer};
use crate::base::{Ball, Dd, Number};
use crate::system::{LinearSystem, Signal};

/// A measured number.
#[derive(Clone, Debug, PartialEq)]
pub enum Measurement {
    Value(Ball),
    /// An infinite value, as for a resonance without damping or a free body under a steady load.
    Infinite,
    /// The reason why there is no value.
    None(&'static str),
    /// The message of the error that stopped the analysis.
    Failed(String),
}

/// The i-th natural frequency without damping, Hz; i from 1. A rigid motion has the frequency 0.
pub fn frequency(modes: &Modes, i: usize) -> Measurement {
    match i.checked_sub(1).and_then(|i| modes.list.get(i)) {
        None => Measurement::None("there is no such mode"),
        Some(mode) if mode.kind == ModeKind::Divergence => {
            Measurement::None("this mode does not oscillate: it diverges")
        }
        Some(mode) if mode.kind == ModeKind::Undetermined => {
            Measurement::None("it is not certain whether this mode oscillates or diverges")
        }
        Some(mode) => Measurement::Value(hertz(mode.omega)),
    }
}

/// The effective mass of the i-th mode under the motion of a base, kg or kg m^2.
pub fn effective_mass(system: &LinearSystem, modes: &Modes, input: usize, i: usize) -> Measurement {
    let found = Excitations::of(system, modes).and_then(|excitations| excitations.by(input));
    let shares = match found {
        Ok(excitation) => excitation.modes,
        Err(why) => return Measurement::None(why),
    };
    const TOGETHER: &str = "modes of the same frequency have an effective mass only together";
    let Some((at, own)) = i.checked_sub(1).and_then(|at| Some((at, shares.get(at)?))) else {
        return Measurement::None("there is no such mode");
    };
    let Some(mass) = own.mass else { return Measurement::None(TOGETHER) };
    // Of modes of different parts whose frequencies are not apart, any may be the i-th: their masses have to agree.
    let square = |at: usize| modes.list.get(at).map(|mode| mode.omega_squared);
    let is_as_fast = |other: usize| square(at).zip(square(other)).is_some_and(|(a, b)| (a - b).contains_zero());
    let others = shares.iter().enumerate().filter(|(other, _)| *other != at && is_as_fast(*other));
    let apart = |other: &Excited| other.mass.map(|other| other - mass).filter(Ball::contains_zero);
    match others.map(|(_, other)| apart(other)).collect::<Option<Vec<Ball>>>() {
        Some(apart) => Measurement::Value(mass.widen(apart.iter().map(Ball::magnitude).fold(0.0, f64::max))),
        None => Measurement::None(TOGETHER),
    }
}

/// omega^2 of the i-th mode without damping, 1/s^2: negative if it diverges.
pub fn square(modes: &Modes, i: usize) -> Measurement {
    match i.checked_sub(1).and_then(|i| modes.list.get(i)) {
        Some(mode) => Measurement::Value(mode.omega_squared),
        None => Measurement::None("there is no such mode"),
    }
}

/// c^2 - 4 k m of a single coordinate: positive if its motion does not oscillate.
pub fn discriminant(system: &LinearSystem) -> Measurement {
    let [m, c, k] = [&system.m, &system.c, &system.k].map(|form| form.entries(1)[0][0].clone());
    let value = &c.square() - &(&Number::from(4) * &(&k * &m));
    Measurement::Value(value.to_ball())
}

/// ((s1 - s2) / 2)^2 of the two poles of the i-th damped motion, 1/s^2: negative if it oscillates. If its last pole is real, positive,
/// with the real pole next to that: as a motion becomes overdamped, its poles meet and part between those of others.
pub fn critical(poles: &Poles, i: usize) -> Measurement {
    let pole = match pair_of_motion(poles, i) {
        Ok((_, pole)) => pole,
        Err(why) => return Measurement::None(why),
    };
    if pole.is_complex() {
        return Measurement::Value(-pole.im.square());
    }
    let others = poles.list.iter().filter(|other| !other.is_complex() && !std::ptr::eq(*other, pole));
    match others.map(|other| -(pole.re - other.re).abs()).reduce(Ball::or_larger) {
        Some(nearest) => Measurement::Value((nearest * Ball::from(0.5)).square()),
        None => Measurement::None("its pole is real, and there is no other one"),
    }
}

/// The damping ratio of the i-th damped motion: complex pairs and pairs of real poles, ascending in |s|.
pub fn damping_ratio(poles: &Poles, i: usize) -> Measurement {
    match pair_of_motion(poles, i) {
        Ok((Some(first), pole)) if diverges(first) != diverges(pole) => {
            Measurement::None("one of its two real poles grows, so they have no common damping ratio")
        }
        Ok((_, pole)) if !is_certain_in_order(poles, pole) => Measurement::None(
            "another damped motion is as far from zero as this one, so which comes first is not certain",
        ),
        Ok((_, pole)) => {
            pole.damping_ratio.map_or(Measurement::None("a pole at zero has no damping ratio"), Measurement::Value)
        }
        Err(why) => Measurement::None(why),
    }
}

/// Whether certainly no pole with another damping ratio is just as far from zero. Two oscillators with the same
/// frequency and different dampers have poles of the same size, and rounding would choose the first one.
fn is_certain_in_order(poles: &Poles, of: &Pole) -> bool {
    let size = of.modulus();
    let ratio = |pole: &Pole| pole.damping_ratio.unwrap_or(Ball::new(Dd::ZERO, f64::INFINITY));
    let others = poles.list.iter().filter(|pole| !pole.is_lower_half());
    others
        .filter(|other| (other.modulus() - size).contains_zero())
        .all(|other| (ratio(other) - ratio(of)).contains_zero())
}

/// The last pole of the i-th damped motion, or the reason why there is none.
pub fn damped_motion(poles: &Poles, i: usize) -> Result<&Pole, &'static str> {
    pair_of_motion(poles, i).map(|(_, pole)| pole)
}

fn diverges(pole: &Pole) -> bool {
    pole.kind == PoleKind::Divergence
}

/// The last pole of the i-th damped motion, and the one before it if that is real.
fn pair_of_motion(poles: &Poles, i: usize) -> Result<(Option<&Pole>, &Pole), &'static str> {
    if poles.is_uncounted() || poles.followed {
        return Err("it is not proved that no other damped motion precedes it");
    }
    let mut halves = 0;
    let mut first = None;
    for pole in &poles.list {
        if pole.kind == PoleKind::Undetermined {
            return Err("it is not certain what kind of motion this is");
        }
        halves += match (pole.is_lower_half(), pole.is_complex()) {
            (true, _) => 0,
            (false, true) => 2,
            (false, false) => 1,
        };
        if halves >= 2 * i && i > 0 {
            return Ok((first.filter(|_| !pole.is_complex()), pole));
        }
        if !pole.is_lower_half() {
            first = Some(pole).filter(|pole| !pole.is_complex() && halves % 2 == 1);
        }
    }
    Err("there is no such damped motion")
}

/// The factor by which the loads at rest can grow before some motion loses its stiffness.
pub fn load_factor(system: &LinearSystem) -> Measurement {
    match least_load_factor(system) {
        Ok(Some(found)) => Measurement::Value(found),
        Ok(None) => Measurement::None("no load takes stiffness from any motion: nothing buckles"),
        Err(why) => Measurement::None(why),
    }
}

/// |H| at a frequency in Hz.
pub fn gain(transfer: &Transfer, input: usize, output: usize, frequency: &Number) -> Measurement {
    measure(at(transfer, input, output, frequency), |disc| Some(disc.gain()))
}

/// The largest |H| over all frequencies, or over a range in Hz; `poles` are those of the whole system.
pub fn peak_gain(
    transfer: &Transfer,
    poles: Option<&Poles>,
    input: usize,
    output: usize,
    range: Option<(&Number, &Number)>,
) -> Measurement {
    match supremum(transfer, poles, (input, output), range) {
        Ok(Supremum::Finite(value)) => Measurement::Value(value),
        Ok(Supremum::Infinite) => Measurement::Infinite,
        Err(why) => Measurement::None(why),
    }
}

/// The angle of H at a frequency in Hz, in radians, in (-pi, pi].
pub fn phase(transfer: &Transfer, input: usize, output: usize, frequency: &Number) -> Measurement {
    measure(at(transfer, input, output, frequency), |disc| disc.angle())
}

/// The supremum of an output in the steady state under the harmonic signals: signals of one frequency add as complex
/// numbers, amplitudes of different frequencies add up.
pub fn amplitude(transfer: &Transfer, drives: &[Vec<Signal>], output: usize) -> Measurement {
    let mut sum = Ball::ZERO;
    for part in steady(transfer, drives, &[output]) {
        match part.outputs[0] {
            Gain::Finite(disc) => sum = sum + disc.gain(),
            Gain::Infinite => return Measurement::Infinite,
            Gain::Unknown => return Measurement::None("the frequency is too near to an undamped pole"),
        }
    }
    Measurement::Value(sum)
}

/// A steady load: the input, and its value.
pub type Loads = Vec<(usize, Number)>;

/// The reason for a missing final value under the signal of a base that gives its velocity or acceleration: that of a chirp,
/// and every one where settling is asked for.
pub const MOVES_BY_RATE: &str =
    "a base is moved by its velocity or acceleration: no final value is computed under such a signal";

/// The lasting part of a sum of signals: steps, the final values of ramps, the last values of tables; `None` under a
/// signal that is an integral, whose end is not computed.
pub fn lasting_value(signals: &[Signal]) -> Option<Number> {
    signals.iter().try_fold(Number::ZERO, |sum, signal| Some(&sum + &signal.final_value()?))
}

/// The final value of an output under steady loads (input, value): sum H(0) load. Loads in balance have one although
/// each of them alone has none: then they are taken as one input.
pub fn static_value(transfer: &Transfer, loads: &[(usize, Number)], output: usize) -> Measurement {
    let loads: Vec<(usize, Number)> = loads.iter().filter(|(_, load)| !load.is_zero()).cloned().collect();
    let gains: Vec<Gain> = loads.iter().map(|(input, _)| at(transfer, *input, output, &Number::ZERO)).collect();
    if loads.len() > 1 && !gains.iter().all(|gain| matches!(gain, Gain::Finite(_))) {
        let together = transfer.system().with_sum_of_inputs(&loads);
        let one = [(together.inputs.len() - 1, Number::ONE)];
        return static_value(&Transfer::of(&together), &one, output);
    }
    let mut sum = Ball::ZERO;
    for ((_, load), gain) in loads.iter().zip(gains) {
        match gain {
            Gain::Finite(disc) => {
                let value = Ball::exact(disc.value.re).widen(disc.radius);
                sum = sum + load.to_ball() * value;
            }
            Gain::Infinite => return Measurement::Infinite,
            Gain::Unknown => return Measurement::None("the system has a rigid motion, or nearly one"),
        }
    }
    Measurement::Value(sum)
}

/// The final value of an output under inputs that become c0 + c1 t + c2 t^2 / 2 in the end: what follows a base that keeps its
/// velocity or acceleration, seen relative to it, comes to rest. `ends`: (input, c).
pub fn final_value(transfer: &Transfer, ends: &[(usize, [Number; 3])], output: usize) -> Measurement {
    let (steady, moving): (Vec<_>, Vec<_>) = ends.iter().partition(|(_, [_, c1, c2])| c1.is_zero() && c2.is_zero());
    let loads: Loads = steady.into_iter().map(|(input, [value, ..])| (*input, value.clone())).collect();
    let mut sum = match static_value(transfer, &loads, output) {
        Measurement::Value(value) => value,
        other => return other,
    };
    for (input, [_, velocity, acceleration]) in &moving {
        let (derivative, rate) = if acceleration.is_zero() { (1, velocity) } else { (2, acceleration) };
        if !is_certain(rate) {
            return Measurement::None("it is not certain whether the base keeps moving");
        }
        let rate_of = Rate { input: *input, derivative, word: "" };
        let driven = match from_rate_at_rest(transfer.system(), rate_of, output) {
            Ok(driven) => driven,
            Err(why) => return Measurement::None(why),
        };
        match at(&Transfer::of(&driven), driven.inputs.len() - 1, 0, &Number::ZERO) {
            Gain::Finite(disc) => sum = sum + rate.to_ball() * Ball::exact(disc.value.re).widen(disc.radius),
            Gain::Infinite if moving.len() == 1 => return Measurement::Infinite,
            Gain::Infinite => {
                return Measurement::None("several bases keep moving: whether that cancels is not computed");
            }
            Gain::Unknown => return Measurement::None("it is not certain whether the output follows the base"),
        }
    }
    Measurement::Value(sum)
}

fn at(transfer: &Transfer, input: usize, output: usize, frequency: &Number) -> Gain {
    transfer.between(&Frequency::hertz(frequency), &[input], &[output])[0][0]
}

fn measure(gain: Gain, of: impl Fn(Disc) -> Option<Ball>) -> Measurement {
    match gain {
        Gain::Finite(disc) => of(disc).map_or(Measurement::None("zero has no angle"), Measurement::Value),
        Gain::Infinite => Measurement::Infinite,
        Gain::Unknown => Measurement::None("the frequency is too near to an undamped pole"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::test_systems::{blank, oscillator, push};
    use crate::analysis::{modes, poles};

    fn value(measurement: Measurement) -> f64 {
        match measurement {
            Measurement::Value(ball) => {
                assert!(ball.relative_error() < 1e-16, "{ball:?}");
                ball.to_f64()
            }
            other => panic!("{other:?}"),
        }
    }

    /// Two masses on springs of the same frequency: with different dampers both pairs of poles are at |s| = 1 exactly, and with
    /// dampers of 0.1 and 0.2 one has 5 % and the other 10 %. A third, at |s| = 2, is certain, and so are copies.
    #[test]
    fn motions_of_the_same_size_have_no_order() {
        let ratio = |dampers: [&str; 3], i: usize| {
            let mut system = blank(3);
            for (at, (damper, stiffness)) in dampers.into_iter().zip(["1", "1", "4"]).enumerate() {
                push(&mut system.m, "1", at, None);
                push(&mut system.c, damper, at, None);
                push(&mut system.k, stiffness, at, None);
            }
            let modes = modes(&system).expect("modes");
            damping_ratio(&poles(&system, &modes).expect("poles"), i)
        };
        let different = ["0.1", "0.2", "0.4"];
        assert!([1, 2].iter().all(|i| matches!(ratio(different, *i), Measurement::None(_))));
        assert_eq!(value(ratio(different, 3)), 0.1);
        assert_eq!([1, 2].map(|i| value(ratio(["0.1", "0.1", "0.4"], i))), [0.05; 2]);
    }

    /// S10 of the published cases (VM86): k = 200, c = 6, m = 0.5, 10 N at 20 rad/s give 1/12 m. Two forces of half the
    /// size, a quarter of a period apart, give sqrt(1/2) of it.
    #[test]
    fn a_steady_amplitude() {
        let system = oscillator("0.5", "6", "200");
        let transfer = Transfer::of(&system);
        let frequency = Number::from(20).checked_div(&(&Number::pi() * &Number::from(2))).expect("not zero");
        let force = |value: i64, quarter: bool| Signal::Harmonic {
            value: Number::from(value),
            frequency: frequency.clone(),
            phase: if quarter { &Number::pi() / &Number::from(2) } else { Number::ZERO },
            at: Number::ZERO,
        };
        assert_eq!(value(amplitude(&transfer, &[vec![force(10, false)]], 0)), 1.0 / 12.0);
        let two = value(amplitude(&transfer, &[vec![force(5, false), force(5, true)]], 0));
        assert!((two - 0.5f64.sqrt() / 12.0).abs() < 1e-16);
        assert_eq!(value(static_value(&transfer, &[(0, Number::from(10))], 0)), 0.05);
    }

    #[test]
    fn frequencies_ratios_and_gains_by_definition() {
        let system = oscillator("1", "2", "4");
        let modes = modes(&system).expect("modes");
        let poles = poles(&system, &modes).expect("poles");
        assert_eq!(value(damping_ratio(&poles, 1)), 0.5);
        assert!((value(frequency(&modes, 1)) - std::f64::consts::FRAC_1_PI).abs() < 1e-16);
        assert!(matches!(frequency(&modes, 2), Measurement::None(_)));
        assert!(matches!(damping_ratio(&poles, 2), Measurement::None(_)));
        let transfer = Transfer::of(&system);
        // At its own 2 rad/s, an oscillator responds with 1 / (c omega), delayed by a quarter of a period.
        let own = Number::pi().recip().expect("not zero");
        assert!((value(gain(&transfer, 0, 0, &own)) - 0.25).abs() < 1e-16);
        assert!((value(phase(&transfer, 0, 0, &own)) + std::f64::consts::FRAC_PI_2).abs() < 1e-15);
    }
}
