//! The largest |H| over frequencies, for ranges of parameters. In: systems over the same ranges, each with the derivatives by another
//! parameter. Out: an enclosure of the largest |H| for all values, and of its derivatives. See docs/method/studies.md#tolerances.
//!
//! |H| at any frequency is a lower bound of the largest one. Where |H| is certainly below the best of these bounds there is no largest
//! one, so that the derivatives of |H| at the frequencies that are left enclose those of the largest |H|: if all of them are positive,
//! |H| at a frequency where it is largest grows with the parameter, and the largest one is at least that.
//!
//! A peak moves with its mode. So frequencies are multiples of the omega of one mode, which depends on the parameters, in coordinates
//! of which one is this mode ([`Family::led_by`]): the derivatives are those along with the peak, where it takes much narrower ranges to
//! tell their sign, and little damping does not make them wider. Each mode has its zone of frequencies; together they are all of the band.

use super::linear::{JetMatrix, solve};
use super::together::Together;
use super::{Family, Phasor, ball_between, number};
use crate::base::{Ball, Dd, Jet, Number, up};
use std::borrow::Cow;
use std::cell::Cell;

/// The path from an input, or from the velocity (1) or acceleration (2) of a base, to an output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Way {
    pub input: usize,
    pub output: usize,
    pub rate: u8,
}

/// The largest |H| over the ranges.
#[derive(Clone, Debug)]
pub struct Largest {
    pub value: Ball,
    /// Values of |H| over ranges that it took.
    pub evaluations: usize,
    /// By the parameter of each system.
    pub slopes: Vec<Ball>,
}

/// Evaluations in one search, for one zone and for each further one.
pub const MOST_CELLS: usize = 128;
const CELLS_OF_A_ZONE: usize = 32;
/// A range of frequencies so narrow, as a share of them, is cut only if |H| changes in it by more than a little.
const NARROW: f64 = 0.15;
const LITTLE: f64 = 1.1;
/// At most so many parts are cut further for their derivatives, each into so many.
const MOST_FINE: usize = 40;
const FINE: usize = 6;
/// Beyond the fastest pole by this factor, |H| is bounded for all frequencies at once.
const BEYOND: f64 = 4.0;
/// Zones overlap by this share, so that no rounding leaves a gap.
const OVERLAP: f64 = 1e-12;

/// Frequencies as multiples of the unit of a zone, and what |H| is there.
struct Part {
    zone: usize,
    low: f64,
    high: f64,
    upper: f64,
    /// Not worth cutting: the ranges of the parameters make |H| uncertain, not that of the frequency.
    is_last: bool,
}

/// Frequencies in the unit of its families: rad/s, or multiples of the omega of the mode that leads them.
struct Zone<'f, 'a> {
    families: Cow<'f, [Family<'a>]>,
    low: f64,
    high: f64,
    /// Below this, |H| is about that of rest.
    slow: f64,
}

/// `band`: in rad/s, without an end if the second one is `None`; `sizes`: the least and the largest size of the poles in the middle, and
/// omega^2 of simple modes, ascending, in the middle and with the derivative by the parameter of each system.
pub fn largest(
    (families, together): (&[Family], Option<&Together>),
    way: Way,
    band: (Ball, Option<Ball>),
    (sizes, modes): ([f64; 2], &[(Ball, Vec<Jet>)]),
) -> Option<Largest> {
    let family = families.first()?;
    let first = (band.0.mid.hi - band.0.rad).next_down().max(0.0);
    let [slowest, fastest] = sizes;
    let last = match band.1 {
        Some(high) => (high.mid.hi + high.rad).next_up(),
        None => (BEYOND * fastest).max(2.0 * first),
    };
    if !(slowest > 0.0 && last.is_finite() && first < last) {
        return None;
    }
    let zones = zones((families, together), (first, last, band.1.is_none()), slowest, modes);
    let most = MOST_CELLS + CELLS_OF_A_ZONE * (zones.len() - 1);
    let still: Vec<Family> = zones.iter().map(|zone| zone.families[0].without_derivatives()).collect();
    let evaluations = Cell::new(0);
    let at = |zone: usize, ratio: Ball| {
        evaluations.set(evaluations.get() + 1);
        magnitude(&still[zone], way, &Number::Ball(ratio))
    };
    let upper_at = |zone: usize, ratio: Ball| {
        let upper = at(zone, ratio).map_or(f64::INFINITY, |found| found.value.magnitude());
        if upper.is_nan() { f64::INFINITY } else { upper }
    };
    let mut known = 0.0f64;
    let learn = |zone: usize, ratio: f64, known: &mut f64| {
        if let Some(found) = at(zone, Ball::from(ratio)) {
            *known = known.max((found.value.mid.hi - found.value.rad * up::FEW) * (1.0 - f64::EPSILON));
        }
    };
    // Near each mode there is a peak, which may be too narrow to be met by chance.
    for (index, zone) in zones.iter().enumerate() {
        if zone.families[0].lead.is_some() && zone.low < 1.0 && 1.0 < zone.high {
            learn(index, 1.0, &mut known);
        }
    }
    let look = |zone: usize, low: f64, high: f64, known: &mut f64| {
        learn(zone, 0.5 * (low + high), known);
        Part { zone, low, high, upper: upper_at(zone, ball_between(low, high)), is_last: false }
    };
    let mut parts = Vec::new();
    for (index, zone) in zones.iter().enumerate() {
        let (mut low, mut high) = (zone.low, if zone.low > 0.0 { 2.0 * zone.low } else { zone.slow.min(zone.high) });
        while low < zone.high {
            if parts.len() >= most {
                return None;
            }
            parts.push(look(index, low, high.min(zone.high), &mut known));
            (low, high) = (high, 2.0 * high);
        }
    }
    while parts.len() < most {
        let open = (0..parts.len()).filter(|&i| !parts[i].is_last);
        let worst = open.max_by(|&a, &b| parts[a].upper.total_cmp(&parts[b].upper).then(b.cmp(&a)));
        let Some(worst) = worst else { break };
        let Part { zone, low, high, upper, .. } = parts[worst];
        let middle = 0.5 * (low + high);
        if upper < known {
            break;
        }
        let is_even = || [low, middle, high].iter().all(|&ratio| upper <= LITTLE * upper_at(zone, Ball::from(ratio)));
        if !(low < middle && middle < high) || upper.is_finite() && high - low < NARROW * high && is_even() {
            parts[worst].is_last = true;
            continue;
        }
        let [first, second] = [look(zone, low, middle, &mut known), look(zone, middle, high, &mut known)];
        parts[worst] = first;
        parts.push(second);
    }
    let mut left: Vec<Part> = parts.into_iter().filter(|part| part.upper >= known).collect();
    let over = |left: &[Part]| {
        let mut slopes: Vec<Option<Ball>> = vec![None; families.len()];
        for part in left {
            for (family, all) in zones[part.zone].families.iter().zip(&mut slopes) {
                let slope = magnitude(family, way, &Number::Ball(ball_between(part.low, part.high)))?.slope;
                *all = Some(all.map_or(slope, |all| hull(all, slope)));
                evaluations.set(evaluations.get() + 1);
            }
        }
        slopes.into_iter().collect::<Option<Vec<Ball>>>()
    };
    let mut slopes = over(&left)?;
    let is_open = |slope: &Ball| slope.contains_zero() && !slope.is_zero();
    if left.len() <= MOST_FINE && slopes.iter().all(Ball::is_finite) && slopes.iter().any(is_open) {
        // The phase of H is better known in smaller parts, and so is the sign of what |H| changes by.
        let step = |part: &Part, i: usize| part.low + (part.high - part.low) * (i as f64 / FINE as f64);
        let smaller = |part: &Part| -> Vec<Part> {
            let ends = |i: usize| (step(part, i), if i + 1 == FINE { part.high } else { step(part, i + 1) });
            let of = |(low, high)| Part { low, high, upper: upper_at(part.zone, ball_between(low, high)), ..*part };
            (0..FINE).map(ends).map(of).filter(|part| part.upper >= known).collect()
        };
        left = left.iter().flat_map(smaller).collect();
        slopes = over(&left)?;
    }
    let upper = left.iter().map(|part| part.upper).fold(0.0, f64::max);
    // What lies beyond the last zone for any values.
    let end = zones.last().map(|zone| zone.families[0].omega(&Number::Ball(Ball::from(zone.high))).enclosure())?;
    if band.1.is_none() && tail(family, way, (end.mid.hi - end.rad).next_down())? > known {
        return None;
    }
    let middle = 0.5 * (known + upper);
    let value = Ball::from(middle).widen((upper - middle).max(middle - known) * up::FEW);
    value.is_finite().then(|| Largest { value, evaluations: evaluations.get(), slopes })
}

/// Zones that together are a band, rad/s, for all values: one for each mode that certainly lies inside, and what they leave at its ends.
/// In a band `is_all` that begins at rest and ends far above all poles, the last zone ends at least there in the middle of the ranges.
fn zones<'f, 'a>(
    (families, together): (&'f [Family<'a>], Option<&Together>),
    (first, last, is_all): (f64, f64, bool),
    slowest: f64,
    modes: &[(Ball, Vec<Jet>)],
) -> Vec<Zone<'f, 'a>> {
    let plain = |low: f64, high: f64| Zone { families: Cow::Borrowed(families), low, high, slow: 0.5 * slowest };
    // omega is certainly between the first two, and about the third.
    let ends = |square: &Jet| {
        let omega = number(square.clone()).sqrt()?.enclosure();
        let (least, most) = ((omega.mid.hi - omega.rad).next_down(), (omega.mid.hi + omega.rad).next_up());
        (least > 0.0 && most.is_finite()).then_some([least, most, omega.to_f64()])
    };
    let led = modes.iter().filter_map(|(middle, squares)| {
        let [least, most, omega] = ends(squares.first()?)?;
        if !(first < least && most < last) {
            return None;
        }
        Some((together?.led_families(families, squares, *middle)?, [least, most, omega]))
    });
    let led: Vec<(Vec<Family>, [f64; 3])> = led.collect();
    let mut zones = Vec::new();
    let mut from = None;
    for (i, (own, [least, most, omega])) in led.iter().enumerate() {
        // Between two modes the border is at a frequency; multiples of either reach it for all values. At the ends of the band they
        // stay inside of it, and what they leave is in rad/s.
        let low = match from {
            Some(border) => border / most * (1.0 - OVERLAP),
            None if first == 0.0 => 0.0,
            None => {
                let low = first / least * (1.0 + OVERLAP);
                zones.push(plain(first, low * most * (1.0 + OVERLAP)));
                low
            }
        };
        let (high, rest) = match led.get(i + 1) {
            Some((_, [_, _, next])) => {
                let border = (omega * next).sqrt();
                from = Some(border);
                (border / least * (1.0 + OVERLAP), None)
            }
            None if is_all => (last / omega, None),
            None => {
                let high = last / most * (1.0 - OVERLAP);
                (high, Some(plain(high * least * (1.0 - OVERLAP), last)))
            }
        };
        if low >= high {
            return vec![plain(first, last)];
        }
        let slow = 0.5 * slowest.min(*omega) / most;
        zones.push(Zone { families: Cow::Owned(own.clone()), low, high, slow });
        zones.extend(rest);
    }
    if zones.is_empty() { vec![plain(first, last)] } else { zones }
}

/// |H| at frequencies in the unit of the family; `None` if it may be infinite.
fn magnitude(family: &Family, Way { input, output, rate }: Way, omega: &Number) -> Option<Jet> {
    let power = i32::from(rate);
    let radians = family.omega(omega);
    let direct = || family.response(input, output, omega)?.times_power(&radians, -power);
    // Near a resonance the force that makes the motion 1 is better known than the motion.
    let inverse = || {
        let size = family.inverse_response(input, output, omega)?.times_power(&radians, power)?.size()?;
        Number::ONE.checked_div(&number(size))
    };
    let direct = direct().and_then(|z| z.size()).map(|size| family.jet_of(&number(size)));
    let inverse = inverse().map(|size| family.jet_of(&size));
    match (direct, inverse) {
        (Some(a), Some(b)) => Some(Jet {
            value: common(a.value, b.value),
            slope: if a.slope.rad <= b.slope.rad { a.slope } else { b.slope },
        }),
        (one, other) => one.or(other),
    }
}

/// What two enclosures of a number that is not negative have in common.
fn common(a: Ball, b: Ball) -> Ball {
    if !(a.is_finite() && b.is_finite()) {
        return if a.is_finite() { a } else { b };
    }
    let low = |ball: Ball| (ball.mid.hi - ball.rad).next_down().next_down();
    let (low, high) = (low(a).max(low(b)).max(0.0), a.magnitude().min(b.magnitude()));
    let narrowest = if a.rad <= b.rad { a } else { b };
    if low <= high && high - low < 2.0 * narrowest.rad { ball_between(low, high) } else { narrowest }
}

const UNKNOWN: Ball = Ball { mid: Dd::ZERO, rad: f64::INFINITY };

/// A bound of |H| for all frequencies from one on, rad/s: with u = 1/omega, K - omega^2 M + i omega C = -omega^2 (M - u^2 K - i u C).
/// `None` if it grows with the frequency, or the matrix may be singular.
fn tail(family: &Family, Way { input, output, rate }: Way, from: f64) -> Option<f64> {
    let n = family.coordinates();
    let u = Number::Ball(ball_between(0.0, (1.0 / from).next_up()));
    let re = |i: usize, j: usize| &family.m[i][j] - &(&u.square() * &family.k[i][j]);
    let im = |i: usize, j: usize| -&(&u * &family.c[i][j]);
    let matrix = JetMatrix::from_fn(2 * n, 2 * n, |i, j| match (i < n, j < n) {
        (true, true) | (false, false) => re(i % n, j % n),
        (true, false) => -&im(i, j - n),
        (false, true) => im(i - n, j),
    });
    let (from_input, to_output) = (family.system.inputs.get(input)?, family.system.outputs.get(output)?);
    // u^(2 + rate - j - k) for the terms of power j and k.
    let power = |used: usize| u32::try_from(2 + usize::from(rate)).ok()?.checked_sub(u32::try_from(used).ok()?);
    let largest_u = (1.0 / from).next_up();
    let mut sum = 0.0f64;
    for (k, column) in from_input.b.iter().enumerate().filter(|(_, column)| !column.is_empty()) {
        let column = family.column(column);
        let right = |i: usize| if i < n { column[i].clone() } else { Number::ZERO };
        let found = solve(&matrix, &JetMatrix::from_fn(2 * n, 1, |i, _| right(i)))?;
        for (j, row) in to_output.p.iter().enumerate().filter(|(_, row)| !row.is_empty()) {
            let row = family.column(row);
            let along = |half: usize| {
                let part = |i: usize| &row[i] * &number(found.entry(half * n + i, 0));
                (0..n).fold(Number::ZERO, |sum, i| &sum + &part(i))
            };
            let z = Phasor { re: along(0), im: along(1) };
            let bound = z.square().enclosure().magnitude().sqrt() * up::FEW;
            let factor = (0..power(j + k)?).fold(1.0, |product, _| product * largest_u);
            sum += bound * factor * up::FEW;
        }
    }
    for (l, through) in to_output.d.iter().enumerate() {
        let own = through.iter().filter(|(known, value)| *known as usize == input && !value.is_zero());
        for (_, value) in own {
            let left = usize::from(rate).checked_sub(l)?;
            let factor = (0..left).fold(1.0, |product, _| product * largest_u);
            sum += value.enclosure().magnitude() * factor * up::FEW;
        }
    }
    let bound = sum * up::THOUSANDS;
    bound.is_finite().then_some(bound)
}

/// A ball that contains both.
fn hull(a: Ball, b: Ball) -> Ball {
    if !(a.is_finite() && b.is_finite()) {
        return UNKNOWN;
    }
    let (low, high) = ((a.mid.hi - a.rad).min(b.mid.hi - b.rad), (a.mid.hi + a.rad).max(b.mid.hi + b.rad));
    // The low parts of the middles are within a rounding of their high parts.
    ball_between(low, high).widen((low.abs() + high.abs()) * 4.0 * f64::EPSILON)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::test_systems::{blank, push};
    use crate::system::{CoordinateId, LinearSystem, Nature};

    /// Blocks of 1 kg, the first on a spring of p N/m, the others on springs of 4 and 9 N/m.
    fn blocks(p: Number) -> LinearSystem {
        let mut system = blank(3);
        (0..3).for_each(|i| push(&mut system.m, "1", i, None));
        let source = system.k.source(system.coordinates[0].name);
        system.k.push(source, Nature::Property, p, [(CoordinateId(0), Number::ONE)]);
        push(&mut system.k, "4", 1, None);
        push(&mut system.k, "9", 2, None);
        system
    }

    /// p from 0.81 to 1.21: frequencies of 0.9 to 1.1, 2 and 3 rad/s, in bands from 0 or 0.5 rad/s. What a zone covers for every p begins no
    /// later than what the one before it covers for every p ends, and no zone has a frequency outside of the band.
    #[test]
    fn zones_cover_the_band_for_all_values() {
        let over = blocks(Jet::of_parameter(Ball::from(1.01).widen(0.2)));
        let still = blocks(Number::from("1.01"));
        let together = Together::of(&[&over], &still, &[0.2]).expect("one form");
        let families = [together.family(&over, 0).expect("a family")];
        let fixed = |square: f64| {
            let jet = Jet { value: Ball::from(square), slope: Ball::ZERO };
            (jet.value, vec![jet])
        };
        let moved = Jet { value: Ball::from(1.01).widen(0.2), slope: Ball::ONE };
        let modes = [(Ball::from(1.01), vec![moved]), fixed(4.0), fixed(9.0)];
        for (first, last, is_all) in [(0.0, 12.0, true), (0.0, 5.0, false), (0.5, 5.0, false), (0.5, 2.5, false)] {
            let zones = zones((&families, Some(&together)), (first, last, is_all), 1.0, &modes);
            let led = zones.iter().filter(|zone| zone.families[0].lead.is_some()).count();
            assert_eq!(led, if last < 3.0 { 2 } else { 3 }, "{first} {last}");
            let mut covered = first;
            for (i, zone) in zones.iter().enumerate() {
                let omega = match &zone.families[0].lead {
                    None => [1.0, 1.0],
                    Some(lead) => {
                        let omega = lead.omega.to_f64();
                        [0.9f64, 1.1].map(|moved| if omega < 1.5 { moved } else { omega.round() })
                    }
                };
                let rounding = 8.0 * f64::EPSILON;
                assert!(i == 0 || zone.low * omega[1] <= covered * (1.0 + rounding), "{i} {first} {last}");
                assert!(zone.low * omega[0] >= first * (1.0 - rounding), "{i} {first} {last}");
                assert!(is_all || i + 1 < zones.len() || zone.high * omega[1] <= last * (1.0 + rounding));
                covered = zone.high * omega[0];
            }
            assert!(is_all || covered == last, "{covered} {last}");
        }
    }

    /// The acceleration of a block of 0.9 to 1.1 kg in thick oil grows up to 1 / m as the frequency does: no finite one has the largest.
    #[test]
    fn a_gain_that_is_largest_far_beyond_all_poles_is_not_cut_off() {
        let mut system = blank(1);
        let source = system.m.source(system.coordinates[0].name);
        let mass = Jet::of_parameter(Ball::from(1.0).widen(0.1));
        system.m.push(source, Nature::Property, mass, [(CoordinateId(0), Number::ONE)]);
        push(&mut system.c, "10", 0, None);
        push(&mut system.k, "1", 0, None);
        system.outputs[0].p = [Vec::new(), Vec::new(), vec![(CoordinateId(0), Number::ONE)]];
        let family = Family::of(&system, false).expect("a family");
        let way = Way { input: 0, output: 0, rate: 0 };
        let bound = tail(&family, way, 40.0).expect("a bound");
        assert!((1.0 / 0.9..1.3).contains(&bound), "{bound}");
        let found = largest((&[family], None), way, (Ball::ZERO, None), ([0.1, 10.0], &[]));
        let holds = |value: Ball, m: f64| (value.to_f64() - 1.0 / m).abs() <= value.rad * (1.0 + 1e-12);
        assert!(found.is_none_or(|found| holds(found.value, 0.9) && holds(found.value, 1.1)));
    }

    /// Far below the resonance |H| is 1 / k, for k from 0.999 to 1.001 N/m: both ends are values, and as the band has no peak the enclosure is
    /// barely wider.
    #[test]
    fn a_gain_without_a_peak_is_enclosed_tightly_from_both_sides() {
        let mut system = blank(1);
        let source = system.k.source(system.coordinates[0].name);
        let stiffness = Jet::of_parameter(Ball::from(1.0).widen(1e-3));
        system.k.push(source, Nature::Property, stiffness, [(CoordinateId(0), Number::ONE)]);
        push(&mut system.m, "1", 0, None);
        push(&mut system.c, "0.5", 0, None);
        let family = Family::of(&system, false).expect("a family");
        let way = Way { input: 0, output: 0, rate: 0 };
        let band = (Ball::from(1e-9), Some(Ball::from(2e-9)));
        let Largest { value, slopes, .. } = largest((&[family], None), way, band, ([1.0, 1.0], &[])).expect("a bound");
        let [low, high] = [value.to_f64() - value.rad, value.to_f64() + value.rad];
        let rounding = 1e-5;
        assert!((1.0 / 1.001 - rounding..=1.0 / 1.001).contains(&low), "{low}");
        assert!((1.0 / 0.999..=1.0 / 0.999 + rounding).contains(&high), "{high}");
        // -1 / k^2
        let [low, high] = [-1.0, 1.0].map(|sign| slopes[0].to_f64() + sign * slopes[0].rad);
        assert!(low <= -1.0 / (0.999 * 0.999) && (-1.0 / (1.001 * 1.001)..0.0).contains(&high), "{low} {high}");
    }

    /// 1 .. 3 and 2 .. 5 have 2 .. 3 in common, 1 .. 3 and -2 .. 3 have 1 .. 3, 1 .. 5 and 2 .. 2.5 the latter.
    #[test]
    fn what_two_enclosures_have_in_common_is_kept() {
        for (one, other, both) in [
            ([1.0, 3.0], [2.0, 5.0], [2.0, 3.0]),
            ([1.0, 3.0], [-2.0, 3.0], [1.0, 3.0]),
            ([1.0, 5.0], [2.0, 2.5], [2.0, 2.5]),
        ] {
            let ball = |[low, high]: [f64; 2]| ball_between(low, high);
            for found in [common(ball(one), ball(other)), common(ball(other), ball(one))] {
                let [low, high] = [found.to_f64() - found.rad, found.to_f64() + found.rad];
                assert!(low <= both[0] && both[1] <= high, "{low} {high} {both:?}");
                assert!(low >= both[0] - 1e-14 && high <= both[1] + 1e-14, "{low} {high} {both:?}");
            }
        }
    }
}
