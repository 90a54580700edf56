//! g of a few roots, and products over them, against their closed forms: at what is least and most of all that is uncertain.

use super::*;

/// Poles at re +- i im, with a radius of uncertainty.
fn pair(re: f64, im: f64, radius: f64) -> Root {
    let centre = crate::kernel::big_float::ComplexFloat::new(Float::from(re), Float::from(im));
    Root { centre, radius: Float::from(radius), multiplicity: 1, place: Place::Pair }
}

/// The anchor at zero for a system with poles only.
fn of_poles(poles: Vec<Root>) -> Anchor {
    anchors(&Factored { lead: Ball::ONE, unit: 1.0, zeros: Vec::new(), poles, far: Far::NONE }).remove(0)
}

/// The derivative of -t / (t^2 + 1) is zero at t = 1.
#[test]
fn where_the_slope_vanishes_a_cell_is_not_monotone() {
    let anchor = of_poles(vec![pair(-1.0, 0.0, 0.0)]);
    assert!(!anchor.cell(0.9, 0.2, true).is_monotone());
    assert!(anchor.cell(0.5, 0.05, true).is_monotone());
}

/// Poles at -1 +- 2i have their peak at sqrt 3 = 1.732; poles at -1 +- 1.96i would have it at 1.686. With a radius
/// of 0.1 the sign of the slope of ln |H| at 1.7 is not known.
#[test]
fn uncertainty_of_a_root_is_in_the_sign() {
    let at = 1.7;
    let known = of_poles(vec![pair(-1.0, 2.0, 0.0)]);
    assert!(known.cell(at, 0.0, true).has_no_root() && known.sign(at) == 1);
    let blurred = of_poles(vec![pair(-1.0, 2.0, 0.1)]);
    assert!(!blurred.cell(at, 0.0, true).has_no_root());
    assert_eq!((blurred.sign(at), blurred.sign_at(Dd::from(at))), (0, 0));
    for term in &blurred.terms {
        let off = term.offset.mid.abs().to_f64() - 2.0;
        assert!(off.abs() + 0.1 <= term.offset.rad && term.re.rad >= 0.1, "{term:?}");
    }
}

fn root(re: f64, im: f64, radius: f64, multiplicity: usize, place: Place) -> Root {
    let centre = crate::kernel::big_float::ComplexFloat::new(Float::from(re), Float::from(im));
    Root { centre, radius: Float::from(radius), multiplicity, place }
}

fn of(zeros: Vec<Root>, poles: Vec<Root>, unit: f64, far: Far) -> Factored {
    Factored { lead: Ball::ONE, unit, zeros, poles, far }
}

/// t / (t^2 + a^2) with its first two derivatives.
fn term(t: f64, a: f64) -> [f64; 3] {
    let square = t * t + a * a;
    [t / square, (a * a - t * t) / (square * square), 2.0 * t * (t * t - 3.0 * a * a) / (square * square * square)]
}

/// A pair of poles, a real zero of two, and a factor |omega - 2|^0.5, each anywhere in its disc, or of any power within its bound:
/// g and its slope in the middle of a cell, and the curvature at its ends.
#[test]
fn a_cell_holds_the_slopes_of_all_roots_in_their_discs() {
    let directions = [(0.0, 0.0), (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (0.7, 0.7), (-0.7, -0.7)];
    for unit in [1e-3, 1.0, 1e3] {
        for which in 0..5 {
            for (middle, half) in [(0.87, 0.01), (0.13, 0.02), (1.87, 0.01), (0.5, 0.1)] {
                let off = |k: usize| if which == k || which == 4 { 0.05 } else { 0.0 };
                let pole = root(-0.001 * unit, unit, off(0) * unit, 1, Place::Pair);
                let zero = root(0.001 * unit, 0.0, off(1) * unit, 2, Place::Real);
                let anchor = anchors(&of(vec![zero], vec![pole], 1.0, Far::NONE)).remove(0);
                let factor = Ball::new(Dd::from(2.0 * unit), off(2) * unit);
                let anchor = anchor.with_factor(factor, Ball::new(Dd::from(0.5), off(3)));
                let cell = anchor.cell(middle * unit, half * unit, true);
                for (dx, dy) in directions {
                    let truth = |omega: f64| {
                        let (re, im) = (-0.001 + dx * off(0), 1.0 + dy * off(0));
                        let parts = [
                            (-1.0, term(omega - im, re)),
                            (-1.0, term(omega + im, re)),
                            (2.0, term(omega, 0.001 + dx * off(1))),
                            (0.5 + dx * off(3), term(omega - 2.0 - dy * off(2), 0.0)),
                        ];
                        let sum = |k: usize| parts.iter().map(|(weight, part)| weight * part[k]).sum::<f64>();
                        let size: f64 = parts.iter().map(|(weight, part)| (weight * part[0]).abs()).sum();
                        ([sum(0) / unit, sum(1) / (unit * unit), sum(2) / (unit * unit * unit)], size / unit)
                    };
                    let ([g, slope, _], size) = truth(middle);
                    let slack = 1e-14 * size;
                    let facts = format!("{unit} {which} {middle} {dx} {dy}: {cell:?}");
                    assert!((g - cell.g).abs() <= cell.g_error * (1.0 + 1e-9) + slack, "{facts}");
                    let slack = 1e-12 * size * size;
                    assert!((slope - cell.slope).abs() <= cell.slope_error * (1.0 + 1e-9) + slack, "{facts}");
                    for end in [-half, 0.0, half] {
                        let [g, slope, bend] = truth(middle + end).0;
                        assert!(0.5 * bend.abs() <= cell.curvature * (1.0 + 1e-9), "{end} {facts}");
                        assert!(g.abs() <= cell.magnitude_bound() * (1.0 + 1e-9), "{end} {facts}");
                        assert!(!cell.has_no_root() || g * cell.g > 0.0, "{end} {facts}");
                        assert!(!cell.is_monotone() || slope * cell.slope > 0.0, "{end} {facts}");
                    }
                    let (exact, of_slope) = anchor.slope(Ball::from(middle * unit));
                    assert!((exact.to_f64() - g).abs() <= exact.rad * (1.0 + 1e-9) + 1e-14 * size, "{facts}");
                    assert!((of_slope.to_f64() - slope).abs() <= of_slope.rad * (1.0 + 1e-9) + slack, "{facts}");
                }
            }
        }
    }
}

/// Beside a pole g is large, and its rounding with it.
#[test]
fn roundings_of_a_cell_are_in_its_errors() {
    for turn in 1..64 {
        let (t, a) = (1e-6 / f64::from(turn), 1e-6 / 3.0);
        let anchor = of_poles(vec![pair(-a, 1.0, 0.0)]);
        let cell = anchor.cell(1.0 + t, 0.0, true);
        let part = |t: Dd, a: Dd| {
            let square = t * t + a * a;
            [t / square, (a * a - t * t) / square / square]
        };
        let (t, a) = (Dd::from(1.0 + t) - Dd::ONE, Dd::from(a));
        let [near, far] = [part(t, a), part(t + Dd::from(2.0), a)];
        let off = |k: usize, found: f64| (near[k] + far[k] + Dd::from(found)).abs().to_f64();
        assert!(off(0, cell.g) <= cell.g_error && cell.g_error < 1e-7, "{turn}: {cell:?}");
        assert!(off(1, cell.slope) <= cell.slope_error && cell.slope_error < 1.0, "{turn}: {cell:?}");
    }
}

/// An anchor is the true imaginary part of its root, so that the distance of another one is uncertain by what both are.
#[test]
fn distances_from_an_anchor_are_uncertain_by_both_roots() {
    let poles = vec![pair(-0.5, 1.0, 1e-3), pair(-0.25, 3.0, 1e-2)];
    let list = anchors(&of(Vec::new(), poles, 1.0, Far::NONE));
    assert_eq!(list.len(), 3);
    let is = |ball: Ball, middle: f64, radius: f64| {
        (ball.to_f64() - middle).abs() < 1e-14 && (radius..=1.001 * radius).contains(&ball.rad)
    };
    let offsets: Vec<Ball> = list[1].terms.iter().map(|term| term.offset).collect();
    assert!(offsets[0].is_zero() && is(offsets[1], -2.0, 2e-3) && is(offsets[2], 2.0, 1.1e-2), "{offsets:?}");
    assert!(is(offsets[3], -4.0, 1.1e-2), "{offsets:?}");
    assert!(is(list[1].distance_to(&list[2]), 2.0, 1.1e-2) && is(list[2].distance_to(&list[1]), -2.0, 1.1e-2));
    assert!(list[1].distance_to(&list[1]).is_zero() && is(list[1].omega(Ball::from(0.5)), 1.5, 1e-3));
    assert!(is(list[2].distance_of(Ball::from(3.5)), 0.5, 1e-2));
    assert!(is(list[2].exact_distance_of(&Float::from(3.5), 1e-3), 0.5, 1.1e-2));
}

/// A zero at rest, and omega^p: what is left of both, and how much of it is certain.
#[test]
fn a_power_adds_to_the_root_at_zero() {
    let at_rest = || root(0.0, 0.0, 0.0, 1, Place::Real);
    let with = anchors(&of(vec![at_rest()], vec![pair(-0.5, 2.0, 0.0)], 1.0, Far::NONE)).remove(0);
    let without = of_poles(vec![pair(-0.5, 2.0, 0.0)]);
    assert_eq!((with.root_at_anchor(), without.root_at_anchor()), (Some(0), None));
    assert_eq!((with.singular(), without.singular()), (Some(1.0), None));
    let alone = without.slope(Ball::from(1.5));
    for (power, unsure, certain) in
        [(2.0, 0.0, 3.0), (1.0, 0.25, 1.75), (-1.0, 1e-3, 0.0), (-3.0, 0.5, -1.5), (0.0, 0.0, 1.0)]
    {
        let ball = Ball::new(Dd::from(power), unsure);
        let own = if power == 0.0 { 0.0 } else { f64::signum(power) * (power.abs() - unsure) };
        let both = [(with.with_power(ball, Some(0)), 1.0, certain), (without.with_power(ball, None), 0.0, own)];
        for (anchor, before, certain) in both {
            assert!((anchor.singular().unwrap_or(0.0) - certain).abs() < 1e-14, "{power} {before}");
            let (g, slope) = anchor.slope(Ball::from(1.5));
            let cell = anchor.cell(1.5, 0.0, true);
            for weight in [before + power - unsure, before + power + unsure] {
                let truth = [alone.0.to_f64() + weight / 1.5, alone.1.to_f64() - weight / 2.25];
                for (found, truth) in [g, slope].into_iter().zip(truth) {
                    let off = (found.to_f64() - truth).abs();
                    assert!(off <= found.rad + 1e-15 && found.rad <= unsure + 1e-15, "{power} {before}: {found:?}");
                }
                assert!((cell.g - truth[0]).abs() <= cell.g_error + 1e-15, "{power} {before}: {cell:?}");
            }
        }
    }
    let gone = with.with_power(-Ball::ONE, Some(0));
    assert_eq!((gone.terms.len() + 1, gone.root_at_anchor()), (with.terms.len(), None));
    let twice = without.with_power(Ball::ONE, None).with_power(Ball::from(2.0), None);
    assert_eq!(twice.singular(), Some(3.0));
}

/// One root more at 100 i, the least distance of far ones: 1 / (100 - omega), and 1 - omega / 100.
#[test]
fn far_roots_are_in_slopes_and_values() {
    let of = |far: Far| anchors(&of(Vec::new(), vec![pair(-3.0, 4.0, 0.0)], 1.0, far)).remove(0);
    let (alone, with) = (of(Far::NONE), of(Far { count: 1, beyond: 100.0 }));
    let (base, cell) = (alone.cell(10.0, 5.0, true), with.cell(10.0, 5.0, true));
    for (found, base, power) in
        [(cell.g_error, base.g_error, 1), (cell.slope_error, base.slope_error, 2), (cell.curvature, base.curvature, 3)]
    {
        let [least, most] = [if power == 3 { 85.001 } else { 90.0 }, 84.99].map(|x: f64| x.powi(-power));
        assert!((least..most).contains(&(found - base)), "{power}: {cell:?} {base:?}");
    }
    let ((base, of_base), (g, slope)) = (alone.slope(Ball::from(10.0)), with.slope(Ball::from(10.0)));
    assert!((1.0 / 90.0..1.0 / 89.9).contains(&(g.rad - base.rad)));
    assert!((1.0 / 8100.0..1.0 / 8000.0).contains(&(slope.rad - of_base.rad)));
    // H = 1 / (16 + 18 i) at 3 rad/s, where a far zero takes off 3 %.
    let (h, size) = (with.value(Ball::ONE, Ball::from(3.0)), with.size(Ball::ONE, Ball::from(3.0)));
    let norm = 16.0 * 16.0 + 18.0 * 18.0;
    let truth = [16.0 / norm, -18.0 / norm, 1.0 / f64::sqrt(norm)];
    for (found, truth) in [h.re, h.im, size].into_iter().zip(truth) {
        assert!(
            (found.to_f64() - truth).abs() < 1e-15 && (0.03..0.13).contains(&(found.rad / truth.abs())),
            "{found:?}"
        );
    }
    let other = Far { count: 1, beyond: 1e-3 };
    assert!(of(other).value(Ball::ONE, Ball::from(3.0)).re.rad == f64::INFINITY);
}

/// Products over roots in units of their own, at a point and over an interval: (s + 1)^2 (s^2 + 4 s + 13) s^2 / (s^2 + s + 5) / (s + 2).
#[test]
fn products_over_roots_are_those_of_their_factors() {
    let zeros = vec![root(-1.0, 0.0, 0.0, 2, Place::Real), pair(-2.0, 3.0, 0.0), root(0.0, 0.0, 0.0, 2, Place::Real)];
    let poles = vec![pair(-0.5, f64::sqrt(4.75), 0.0), root(-2.0, 0.0, 0.0, 1, Place::Real)];
    for unit in [0.25, 1.0, 8.0] {
        let anchor = anchors(&of(zeros.clone(), poles.clone(), unit, Far::NONE)).remove(0);
        for omega in [0.5, 1.5, 4.0] {
            let s = Complex::new(0.0, omega);
            let polynomial = |list: &[f64]| {
                // With derivatives by omega: i times those by s.
                let value = |of: &[f64]| of.iter().rev().fold(Complex::ZERO, |sum, &a| sum * s + Complex::real(a));
                let slope =
                    |of: &[f64]| -> Vec<f64> { of.iter().enumerate().skip(1).map(|(k, a)| a * k as f64).collect() };
                let (first, i) = (slope(list), Complex::new(0.0, 1.0));
                [value(list), i * value(&first), -value(&slope(&first))]
            };
            // (s^2 + 2 s + 1)(s^2 + 4 s + 13) and (s^2 + s + 5)(s + 2)
            let (up, scale) = (polynomial(&[13.0, 30.0, 22.0, 6.0, 1.0]), unit.powi(-6));
            let down = polynomial(&[10.0, 7.0, 3.0, 1.0]).map(|z| z.scale(unit.powi(-3)));
            let above = up.map(|z| z.scale(scale));
            let lead = 3.0;
            let near = |found: Complex<Ball>, truth: Complex<f64>| {
                let off = Complex::new(found.re.to_f64(), found.im.to_f64()) - truth;
                off.abs() < 1e-13 * (1.0 + truth.abs()) && found.re.rad < 1e-20 * (1.0 + truth.abs())
            };
            let h = (above[0] * down[0].recip()).scale(-omega * omega * lead);
            assert!(near(anchor.value(Ball::from(lead), Ball::from(omega)), h), "{unit} {omega}");
            let size = anchor.size(Ball::from(lead), Ball::from(omega)).to_f64();
            assert!((size - h.abs()).abs() < 1e-13 * size, "{unit} {omega}");
            assert!((anchor.near_size(lead, omega) - size).abs() < 1e-13 * size, "{unit} {omega}");
            let over = anchor.over(Ball::from(lead), Ball::from(omega)).expect("the anchor at zero");
            assert_eq!(over.at_zero, 2);
            assert!((0..3).all(|k| near(over.above[k], above[k])), "{unit} {omega}: {over:?}");
            assert!(near(over.below, down[0].scale(1.0 / lead)), "{unit} {omega}: {over:?}");
            // (ln P)' = P' / P, (ln P)'' = P'' / P - (P' / P)^2
            let of_log = down[1] * down[0].recip();
            let bend = down[2] * down[0].recip() - of_log * of_log;
            assert!(near(over.slopes[0], of_log) && near(over.slopes[1], bend), "{unit} {omega}: {over:?}");
            let dot = |a: Complex<f64>, b: Complex<f64>| a.re * b.re + a.im * b.im;
            let square = [
                dot(above[0], above[0]),
                2.0 * dot(above[0], above[1]),
                2.0 * (dot(above[1], above[1]) + dot(above[0], above[2])),
            ];
            for (found, truth) in over.square_above.into_iter().zip(square) {
                assert!((found.to_f64() - truth).abs() < 1e-13 * (1.0 + truth.abs()), "{unit} {omega}: {over:?}");
            }
        }
    }
    let far = Far { count: 1, beyond: 1e6 };
    assert!(of_poles(vec![pair(-1.0, 2.0, 0.0)]).over(Ball::ONE, Ball::ONE).is_some());
    let list = anchors(&of(Vec::new(), vec![pair(-1.0, 2.0, 0.0)], 1.0, Far::NONE));
    assert!(list[1].over(Ball::ONE, Ball::ONE).is_none());
    let list = anchors(&of(Vec::new(), vec![pair(-1.0, 2.0, 0.0)], 1.0, far));
    assert!(list[0].over(Ball::ONE, Ball::ONE).is_none());
    // Beyond the range digits are lost without a trace.
    let large = of_poles(vec![root(-1e100, 0.0, 0.0, 3, Place::Real)]);
    assert!(large.value(Ball::ONE, Ball::ZERO).re.rad == f64::INFINITY);
    assert!(large.size(Ball::ONE, Ball::ZERO).rad == f64::INFINITY && large.over(Ball::ONE, Ball::ZERO).is_none());
}

/// (1 + 2 x + 3 x^2)(5 - 7 x + 11 x^2) at zero.
#[test]
fn derivatives_of_a_product_are_those_of_its_expansion() {
    let found = product([1.0, 2.0, 6.0].map(Ball::from), [5.0, -7.0, 22.0].map(Ball::from));
    assert_eq!(found.map(|x| x.to_f64()), [5.0, 3.0, 2.0 * (11.0 - 14.0 + 15.0)]);
}

/// A third in binary64, with what that leaves out.
#[test]
fn a_number_in_binary64_has_its_error() {
    let third = Ball::ONE / Ball::from(3.0);
    for radius in [0.0, 1e-3] {
        let (value, error) = short(third.widen(radius));
        let off = (third.mid - Dd::from(value)).abs().to_f64() + radius;
        assert!((off..1.001 * off).contains(&error) && off > 1e-17, "{value} {error:e}");
    }
}

/// A radius in binary64 is never less, however many bits it has.
#[test]
fn a_radius_is_rounded_upwards() {
    assert!(rounded_up(&Float::zero()) > 0.0);
    for bits in [0, 30, 52, 53, 54, 60, 120] {
        for exponent in [-1000, -40, 0, 40] {
            let radius = (&Float::from(1.0) + &Float::from(1.0).times_power_of_two(-bits)).times_power_of_two(exponent);
            let found = rounded_up(&radius);
            assert!(
                !(&Float::from(found) - &radius).is_negative()
                    && found <= radius.to_f64() * (1.0 + 1e-14) + f64::MIN_POSITIVE,
                "{bits} {exponent}"
            );
        }
    }
}

/// 1 / (omega - 2) more, seen from a pole at 3.
#[test]
fn a_factor_is_measured_from_the_anchor() {
    let anchor = anchors(&of(Vec::new(), vec![pair(-0.5, 3.0, 0.0)], 1.0, Far::NONE)).remove(1);
    let with = anchor.with_factor(Ball::from(2.0), Ball::ONE);
    for t in [0.25, -0.25] {
        let difference = with.slope(Ball::from(t)).0 - anchor.slope(Ball::from(t)).0;
        assert!((difference.to_f64() - 1.0 / (1.0 + t)).abs() < 1e-14, "{t}: {difference:?}");
    }
}

/// g = 4 at the middle of 0.5 on both sides: what takes it to zero within the interval, or may, each term by itself and all together.
#[test]
fn a_cell_has_no_root_unless_something_may_take_g_to_zero() {
    let cell = |error: f64, slope: f64, slope_error: f64, curvature: f64| Cell {
        half: 0.5,
        g: 4.0,
        g_error: error,
        slope,
        slope_error,
        curvature,
    };
    for (error, slope, slope_error, curvature) in [
        (4.0, 0.0, 0.0, 0.0),
        (0.0, 8.0, 0.0, 0.0),
        (0.0, 0.0, 8.0, 0.0),
        (0.0, 0.0, 0.0, 16.0),
        (1.0, 2.0, 2.0, 4.0),
        (0.5, 0.5, 5.0, 3.0),
        (0.125, 6.0, 0.25, 3.0),
    ] {
        for sign in [1.0, -1.0] {
            for (share, has_none) in [(0.5, true), (0.999, true), (1.001, false), (1.5, false)] {
                let [error, slope, slope_error, curvature] = [error, slope, slope_error, curvature].map(|x| x * share);
                let cell = Cell { g: 4.0 * sign, ..cell(error, sign * slope, slope_error, curvature) };
                // What is least where the slope leads downhill, less what is not known.
                let least = 4.0 - error - 0.5 * (slope + slope_error) - 0.25 * curvature;
                assert_eq!((cell.has_no_root(), least > 0.0), (has_none, has_none), "{cell:?}");
                let most = 8.0 - least;
                assert!((most..most * 1.000_001).contains(&cell.magnitude_bound()), "{cell:?}");
                let steep = 2.0 * slope.abs() > 2.0 * (slope_error + curvature);
                assert_eq!(cell.is_monotone(), steep, "{cell:?}");
            }
        }
    }
}

/// |omega - 2|^3 next to its root, which is known to a thousandth of its distance: 3 / t and -3 / t^2 at both ends.
#[test]
fn the_error_of_a_multiple_root_is_as_many_times_as_large() {
    for power in [1.0, 3.0, -5.0] {
        for (unsure, of_power) in [(1e-6, 0.0), (0.0, 1e-4), (1e-6, 1e-4)] {
            let base = of_poles(vec![pair(-1.0, 5.0, 0.0)]);
            let with = base.with_factor(Ball::new(Dd::from(2.0), unsure), Ball::new(Dd::from(power), of_power));
            let at = 2.0009765625;
            let (base, cell) = (base.cell(at, 0.0, true), with.cell(at, 0.0, true));
            for side in [1.0, -1.0] {
                let (t, power) = (at - 2.0 - side * unsure, power + side * of_power * f64::signum(power));
                let truth = [power / t, -power / (t * t)];
                let off = [(cell.g - base.g - truth[0]).abs(), (cell.slope - base.slope - truth[1]).abs()];
                let [of_g, of_slope] = [cell.g_error - base.g_error, cell.slope_error - base.slope_error];
                assert!(off[0] <= of_g && off[1] <= of_slope, "{power} {unsure} {side}: {off:?} {cell:?}");
                assert!(side < 0.0 || off[1] > 0.5 * of_slope, "{power} {unsure}: {off:?} {cell:?}");
            }
        }
    }
}
