//! Taylor polynomials against the sums that they approximate, and poles on the axis.

use super::*;
use crate::base::Number;

/// r / (s - p) + q / (s - p*) with p = -0.1 + i, residues of this doubt.
fn pair_of_poles(residues: [Complex<f64>; 2], doubt: f64) -> PartialFractions {
    let term = |im: f64, r: Complex<f64>| Term {
        s: Complex::new(Dd::from(-0.1), Dd::from(im)),
        r: Complex::new(Dd::from(r.re), Dd::from(r.im)),
        size: r.abs() + doubt,
        doubt,
        loose: 0.0,
        rest: [0.0; 5],
    };
    let terms = vec![term(1.0, residues[0]), term(-1.0, residues[1])];
    PartialFractions {
        lined: Lined::of(&terms),
        terms,
        polynomial: [Ball::ZERO; 4],
        at_zero: AtZero(Ball::ZERO),
        part: Part::Both,
        reach: f64::INFINITY,
        flat: [0.0; 3],
    }
}

/// 1 / (s - p) + 1 / (s - p*) with p = -0.1 + i, and Taylor polynomials that reach nearly a third of the way to a pole, p or beside
/// it p*: their terms fall by no more than that, so those after the last are far larger than any rounding.
#[test]
fn a_polynomial_is_as_near_as_it_says() {
    let sum = pair_of_poles([Complex::new(1.0, 0.0); 2], 0.0);
    let (middle, half) = (1.3, 0.1);
    // Beside the pole, within the same distance of its conjugate alone.
    for (middle, half, precise) in
        [(middle, half, false), (middle, half, true), (1.02, 0.6, false), (1.02, 0.6, true), (0.99, 0.04, true)]
    {
        let expansion = Expander::of(&sum).expansion(Dd::from(middle), half, precise).expect("clear");
        let pole = expansion.pole;
        assert_eq!(pole.is_some(), middle < 1.1, "{middle}");
        let mut most = [0.0f64; 2];
        for step in -20..=20 {
            let t = f64::from(step) / 20.0;
            let zero = Complex::<f64>::ZERO;
            let value = expansion.coefficients.iter().rev().fold(zero, |sum, &c| sum.scale(t) + c);
            let slope = (expansion.coefficients.iter().enumerate().skip(1).rev())
                .fold(zero, |sum, (k, &c)| sum.scale(t) + c.scale(k as f64));
            let omega = Dd::from(middle) + Dd::from(half * t);
            let truth = sum.at(omega);
            // (s - p) / half
            let delta = Complex::new(Dd::from(0.1), omega - Dd::ONE).scale(Dd::from(half).recip());
            let whole = truth.slope.scale(Dd::from(half));
            let truth = match pole {
                Some(_) => [delta * truth.h, delta * whole + Complex::new(-truth.h.im, truth.h.re)],
                None => [truth.h, whole],
            };
            let off = [(value, truth[0]), (slope, truth[1])]
                .map(|(a, b)| Complex::new((b.re - Dd::from(a.re)).to_f64(), (b.im - Dd::from(a.im)).to_f64()).abs());
            assert!(
                off[0] <= expansion.errors[0] && off[1] <= expansion.errors[1],
                "{t}: {off:?} {:?}",
                expansion.errors
            );
            most = [most[0].max(off[0]), most[1].max(off[1])];
        }
        assert!(
            half < 0.05 || (most[0] > 1e-3 * expansion.errors[0] && most[0] > 1e-11),
            "{most:?} {:?}",
            expansion.errors
        );
    }
    // Too far to both sides for a polynomial beside one pole.
    assert_eq!(Expander::of(&sum).expansion(Dd::from(1.3), 0.8, false).err(), Some(Obstacle::Near));
}

/// Residues of the pair of poles -0.1 +- i that are off by all of their doubt, in the direction that matters most or across it.
#[test]
fn what_residues_are_in_doubt_by_is_in_the_bounds() {
    const DOUBT: f64 = 1e-3;
    let one = Complex::new(1.0, 0.0);
    let known = pair_of_poles([one, one], DOUBT);
    let mut tightest = 0.0f64;
    // Between poles, and beside one.
    for (middle, half) in [(1.3, 0.1), (0.99, 0.04)] {
        for precise in [false, true] {
            let expansion = Expander::of(&known).expansion(Dd::from(middle), half, precise).expect("clear");
            for (changed, direction) in [0, 1].into_iter().flat_map(|i| [(1.0, 0.0), (0.0, 1.0)].map(|d| (i, d))) {
                let mut residues = [one; 2];
                residues[changed] = Complex::new(1.0 + direction.0 * DOUBT, direction.1 * DOUBT);
                let truth = pair_of_poles(residues, DOUBT);
                for step in -4..=4 {
                    let t = f64::from(step) / 4.0;
                    let value = expansion.coefficients.iter().rev().fold(Complex::ZERO, |sum, &c| sum.scale(t) + c);
                    let omega = Dd::from(middle) + Dd::from(half * t);
                    let h = truth.at(omega).h;
                    let delta = Complex::new(Dd::from(0.1), omega - Dd::ONE).scale(Dd::from(half).recip());
                    let h = if expansion.pole.is_some() { delta * h } else { h };
                    let off = Complex::new((h.re - Dd::from(value.re)).to_f64(), (h.im - Dd::from(value.im)).to_f64());
                    assert!(off.abs() <= expansion.errors[0], "{middle} {t}: {} {}", off.abs(), expansion.errors[0]);
                    tightest = tightest.max(off.abs() / expansion.errors[0]);
                }
            }
        }
    }
    assert!(tightest > 0.3, "{tightest}");
}

/// Poles at +-i and +-i other. A residue that may be zero is no pole for certain; of others P is not zero at the pole.
#[test]
fn a_pole_on_the_axis_is_one_if_its_residue_is_certain() {
    let given = |im: f64, r: f64, doubt: f64| {
        let r = Complex::new(Ball::ZERO, Ball::from(r).widen(doubt));
        let [none, more] = [Complex::<Ball>::ZERO; 2];
        Given {
            s: Complex::new(Dd::ZERO, Dd::from(im)),
            loose: 1e-25,
            products: [r, none, more, none, none],
            rest: [0.0; 5],
        }
    };
    let sum = |other: f64, r: f64, doubt: f64| {
        let list = [given(1.0, r, doubt), given(other, 1.0, 0.0)].into_iter();
        PartialFractions::of_poles(list, [Ball::ZERO; 5], [Ball::ZERO; 3], Part::Real).expect("finite")
    };
    let about = |sum: &PartialFractions, middle: f64, half: f64| {
        let found = Expander::of(sum).expansion(Dd::from(middle), half, false)?;
        Ok(found.infinite_at())
    };
    let at_one = Ball::new(Dd::ONE, 1e-25);
    for (middle, half) in [(1.0, 0.3), (1.01, 0.01), (0.9, 0.2)] {
        let found = about(&sum(2.0, 1.0, 0.0), middle, half).expect("a polynomial");
        assert_eq!(found, Some(at_one), "{middle}");
    }
    // Another pole as near, one on both sides, and a residue that may be zero.
    assert_eq!(about(&sum(1.005, 1.0, 0.0), 1.0, 0.01), Err(Obstacle::Near));
    assert_eq!(about(&sum(2.0, 0.01, 0.02), 1.0, 0.01), Err(Obstacle::Uncertain));
    // No pole is near.
    assert_eq!(about(&sum(2.0, 0.01, 0.02), 1.4, 0.1), Ok(None));
}

/// Poles on the axis or beside it, each with what it contributes: (i omega, growth, r_0, r_1).
type Pole = (f64, f64, f64, f64);

/// The sum over these poles and their conjugates: the distance to which the first one is known, the doubt of each product, and the rest.
fn sum_over(poles: &[Pole], through: [f64; 3], (loose, doubt, rest): (f64, f64, f64)) -> PartialFractions {
    let given = poles.iter().enumerate().map(|(i, &(im, re, r0, r1))| {
        let ball = |x: f64| if x == 0.0 { Complex::<Ball>::ZERO } else { Complex::real(Ball::from(x).widen(doubt)) };
        let none = Complex::<Ball>::ZERO;
        Given {
            s: Complex::new(Dd::from(re), Dd::from(im)),
            loose: if i == 0 { loose } else { 0.0 },
            products: [ball(r0), ball(r1), none, none, none],
            rest: [rest, 0.0, 0.0, 0.0, 0.0],
        }
    });
    let through = through.map(|x| Ball::from(x).widen(if x == 0.0 { 0.0 } else { doubt }));
    PartialFractions::of_poles(given, [Ball::ZERO; 5], through, Part::Both).expect("finite")
}

/// A polynomial, or P, with two derivatives beside those of the truth, whose pole beside the interval is `pole`. Returns how much
/// of the bounds is used.
fn compare(
    known: &PartialFractions,
    truth: &PartialFractions,
    interval: (f64, f64, bool),
    pole: Complex<f64>,
) -> [f64; 3] {
    let (middle, half, precise) = interval;
    let expansion = Expander::of(known).expansion(Dd::from(middle), half, precise).expect("clear");
    let mut used = [0.0f64; 3];
    for step in -4..=4 {
        let t = f64::from(step) / 4.0;
        let mut found = [Complex::<Dd>::ZERO; 3];
        for &c in expansion.coefficients.iter().rev() {
            let t = Dd::from(t);
            found[2] = found[2].scale(t) + found[1].scale(Dd::from(2.0));
            found[1] = found[1].scale(t) + found[0];
            found[0] = found[0].scale(t) + c.into();
        }
        let omega = Dd::from(middle) + Dd::product(half, t);
        let (wide, near) = (Dd::from(half), Dd::from(1e-10));
        let local = truth.at(omega);
        // Symmetric differences of the slope are exact to 1e-20.
        let [above, below] = [omega + near, omega - near].map(|omega| truth.at(omega).slope);
        let bend = (above - below).scale(Dd::from(0.5) / near);
        let [h, h1, h2] = [local.h, local.slope.scale(wide), bend.scale(wide * wide)];
        let delta = Complex::new(-Dd::from(pole.re), omega - Dd::from(pole.im)).scale(wide.recip());
        let i = |z: Complex<Dd>| Complex::new(-z.im, z.re);
        let wanted = match expansion.pole {
            None => [h, h1, h2],
            Some(_) => [delta * h, i(h) + delta * h1, i(h1).scale(Dd::from(2.0)) + delta * h2],
        };
        for k in 0..3 {
            let off = (found[k] - wanted[k]).to_f64().abs();
            assert!(off <= expansion.errors[k], "{interval:?} {t} {k}: {off:e} {:e}", expansion.errors[k]);
            used[k] = used[k].max(off / expansion.errors[k]);
        }
    }
    used
}

/// What is known of poles, residues, of what the input passes on at once and of the rest moves a polynomial and its derivatives by no
/// more than the bounds: between poles, beside one on the axis and beside one that damping moved away.
#[test]
fn all_that_is_uncertain_is_in_a_polynomial() {
    const OFF: f64 = 2e-4;
    let axis: [Pole; 2] = [(1.0, 0.0, 0.3, 1.0), (5.0, 0.0, 1.0, 0.2)];
    let damped: [Pole; 2] = [(1.0, -0.1, 0.3, 1.0), (5.0, -0.2, 1.0, 0.2)];
    let values = |known: &PartialFractions, truth: &PartialFractions, omega: f64| {
        let [a, b] = [known, truth].map(|sum| sum.at(Dd::from(omega)));
        let off = [a.h - b.h, a.slope - b.slope].map(|z| z.to_f64().abs());
        assert!(off[0] <= a.errors[0] && off[1] <= a.errors[1], "{omega}: {off:?} {:?}", a.errors);
    };
    let mut used = [0.0f64; 3];
    let mut check = |known: &PartialFractions, truth: &PartialFractions, interval, pole| {
        let part = compare(known, truth, interval, pole);
        used = std::array::from_fn(|k| used[k].max(part[k]));
    };
    for precise in [false, true] {
        for (middle, half) in [(1.003, 0.3), (1.05, 0.3), (2.5, 0.3)] {
            let interval = (middle, half, precise);
            for (first, second) in [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (1.0, -1.0)] {
                // The first pole is not where it is said to be; one of the two products at a time.
                for (r0, r1) in [(0.3, 0.0), (0.0, 1.0)] {
                    let (mut a, b): (Pole, Pole) = ((1.0, 0.0, r0, r1), (4.0, 0.0, -7.0, 0.0));
                    let known = sum_over(&[a, b], [0.0; 3], (OFF * 1.001, 0.0, 0.0));
                    a.0 += first * OFF;
                    check(&known, &sum_over(&[a, b], [0.0; 3], (0.0, 0.0, 0.0)), interval, Complex::new(0.0, a.0));
                }
                let plain = damped.map(|(im, re, r0, _)| (im, re, r0, 0.0));
                let [mut a, mut b] = plain;
                (a.2, b.2) = (a.2 + first * OFF, b.2 + second * OFF);
                let known = sum_over(&plain, [0.0; 3], (0.0, OFF * 1.001, 0.0));
                let truth = sum_over(&[a, b], [0.0; 3], (0.0, 0.0, 0.0));
                check(&known, &truth, interval, Complex::new(-0.1, 1.0));
                values(&known, &truth, middle);
                for (poles, re) in [(axis, 0.0), (damped, -0.1)] {
                    let [mut a, mut b] = poles;
                    (a.2, b.3) = (a.2 + first * OFF, b.3 + second * OFF);
                    let through = [0.7, 0.0, 0.2];
                    let moved = [0.7 + second * OFF, 0.0, 0.2 - first * OFF];
                    check(
                        &sum_over(&poles, through, (0.0, OFF * 1.001, 0.0)),
                        &sum_over(&[a, b], moved, (0.0, 0.0, 0.0)),
                        interval,
                        Complex::new(re, 1.0),
                    );
                }
                // q / (s - p) is a change of the residue by q.
                let [mut a, mut b] = damped;
                (a.2, b.2) = (a.2 + first * OFF, b.2 + second * OFF);
                let (known, truth) =
                    (sum_over(&damped, [0.0; 3], (0.0, 0.0, OFF)), sum_over(&[a, b], [0.0; 3], (0.0, 0.0, 0.0)));
                check(&known, &truth, interval, Complex::new(-0.1, 1.0));
                values(&known, &truth, middle);
            }
        }
    }
    assert!(used.iter().all(|&used| used > 0.1), "{used:?}");
}

/// Two poles far away whose large residues all but cancel: the rounding of their sums is in the bounds, between poles and beside one.
#[test]
fn sums_that_cancel_are_known_to_their_rounding() {
    let poles: [Pole; 3] = [(5.0, -0.1, 3e9, 1e9), (5.000_001, -0.1, -3e9, -1e9), (1.0, -0.1, 1e-3, 0.0)];
    let sum = sum_over(&poles, [0.0; 3], (0.0, 0.0, 0.0));
    for (middle, half, precise) in [(2.1, 0.3, false), (2.3, 0.2, true), (1.02, 0.3, false), (0.97, 0.2, true)] {
        compare(&sum, &sum, (middle, half, precise), Complex::new(-0.1, 1.0));
    }
    // Intervals as wide as they may be: the terms that are left out are the largest part.
    let sum = sum_over(&[(1.0, -0.1, 1.0, 0.0)], [0.0; 3], (0.0, 0.0, 0.0));
    for interval in [(1.3, 0.1, true), (1.02, 0.6, true)] {
        let used = compare(&sum, &sum, interval, Complex::new(-0.1, 1.0));
        assert!(used.iter().all(|&used| used > 1e-4), "{interval:?} {used:?}");
    }
}

/// No polynomial beside a pole whose place is known too badly, that is on the axis beside a rest, or uncertain off the axis.
#[test]
fn a_pole_that_is_not_known_well_has_no_polynomial_beside_it() {
    let other: Pole = (9.0, -0.1, 1.0, 0.0);
    let about = |pole: Pole, known: (f64, f64, f64), middle: f64| {
        let sum = sum_over(&[pole, other], [0.0; 3], known);
        Expander::of(&sum).expansion(Dd::from(middle), 0.2, false).map(|expansion| expansion.pole.is_some())
    };
    let axis: Pole = (1.0, 0.0, 1.0, 0.0);
    assert_eq!(about(axis, (1e-4, 0.0, 0.0), 1.0), Ok(true));
    assert_eq!(about(axis, (1e-3, 0.0, 0.0), 1.0), Err(Obstacle::Near));
    assert_eq!(about(axis, (0.0, 0.0, 1e-20), 1.0), Err(Obstacle::Near));
    let real: Pole = (0.0, -0.1, 1.0, 0.0);
    assert_eq!(about(real, (0.0, 0.0, 0.0), 0.1), Ok(true));
    assert_eq!(about(real, (1e-9, 0.0, 0.0), 0.1), Err(Obstacle::Near));
}

/// A double pole at zero is in none of the terms, and as near as zero is.
#[test]
fn a_double_pole_at_zero_is_near_too() {
    let given = Given {
        s: Complex::new(Dd::ZERO, Dd::from(9.0)),
        loose: 0.0,
        products: std::array::from_fn(|k| Complex::real(Ball::from(if k == 0 { 1.0 } else { 0.0 }))),
        rest: [0.0; 5],
    };
    let mut free = [Ball::ZERO; 5];
    free[0] = Ball::ONE;
    let sum = PartialFractions::of_poles([given].into_iter(), free, [Ball::ZERO; 3], Part::Real).expect("finite");
    assert_eq!(Expander::of(&sum).expansion(Dd::from(0.5), 0.2, false).err(), Some(Obstacle::Near));
    compare(&sum, &sum, (0.7, 0.2, false), Complex::<f64>::ZERO);
}

/// Of P = 1 + 0.5 i + 0.7 t - 0.3 i t^2 or of t, and a pole that is anywhere within its blur: H = P / delta, the weight delta^3 / i^3
/// and its sign, and the second derivative of H near a frequency.
#[test]
fn a_pole_within_its_blur_is_in_what_is_read_of_h() {
    const BLUR: f64 = 1e-4;
    let one = |re: f64, im: f64| Complex::new(re, im);
    let cases =
        [vec![one(1.0, 0.5), one(0.7, 0.0), one(0.0, -0.3)], vec![one(0.0, 0.0), one(1.0, 0.0)], vec![one(1.0, 0.0)]];
    for (c, offset) in cases.iter().flat_map(|c| [one(0.0, 0.2), one(0.05, 0.2)].map(|offset| (c, offset))) {
        let blur = if offset.re == 0.0 { BLUR } else { 0.0 };
        let expansion = Expansion::sample(c, [0.0; 3], Some((offset, blur)));
        // P, P' and P'' over delta, and their part in the derivatives of H: delta' = i.
        let h = |t: f64, moved: f64| {
            let mut p = [Complex::<f64>::ZERO; 3];
            for &c in c.iter().rev() {
                p = [p[0].scale(t) + c, p[1].scale(t) + p[0], p[2].scale(t) + p[1].scale(2.0)];
            }
            let inverse = Complex::new(offset.re, offset.im + t + moved).recip();
            let bend = p[2] * inverse - (one(0.0, 2.0) * p[1] + p[0].scale(2.0) * inverse) * inverse * inverse;
            [p[0] * inverse, bend]
        };
        for t in [0.0, -0.15, -0.199, 0.4] {
            for moved in [-blur, 0.0, blur] {
                let (value, error) = expansion.value(t);
                let off = (h(t, moved)[0] - value).abs();
                assert!(off <= error, "{offset:?} {t} {moved}: {off:e} {error:e}");
                let (weight, error) = expansion.weight(Dd::from(t));
                let distance = offset.im + t + moved;
                let square = distance * distance + offset.re * offset.re;
                let truth = if offset.re == 0.0 { distance.powi(3) } else { square * square };
                let off = (weight.to_f64() - truth).abs();
                assert!(off <= (error + 1e-15) * truth.abs().max(weight.to_f64().abs()), "{offset:?} {t}: {off:e}");
                for reach in [0.0, 0.01, 0.15] {
                    let size = h(t, moved)[0].abs() * (1.0 + 1e-12);
                    let most = expansion.most_bend(Dd::from(t), reach, size);
                    for there in [t - reach, t, t + reach] {
                        let bend = h(there, moved)[1].abs();
                        assert!(bend <= most * (1.0 + 1e-9), "{offset:?} {t} {reach}: {bend:e} {most:e}");
                    }
                }
            }
        }
        if offset.re == 0.0 {
            assert_eq!(expansion.is_weight_positive(-0.2 + 0.5 * blur, 1.0), None);
            assert_eq!(expansion.is_weight_positive(-0.2 + 2.0 * blur, 1.0), Some(true));
            assert_eq!(expansion.is_weight_positive(-1.0, -0.2 - 2.0 * blur), Some(false));
        }
    }
}

/// A frequency that is known to a hundredth, or to a tenth of the distance of the nearest pole: H at both its ends is within the bound
/// of the one, whether poles, free motions, or powers of s make it steep.
#[test]
fn gains_of_an_uncertain_frequency_hold_those_of_its_ends() {
    let none = [Ball::ZERO; 5];
    let free = |power: usize| std::array::from_fn(|k| if k == power { Ball::from(0.7) } else { Ball::ZERO });
    let through = |power: usize, x: f64| std::array::from_fn(|k| Ball::from(if k == power { x } else { 0.0 }));
    let pole = |re: f64, im: f64, r: f64, power: usize| {
        let mut products = [Complex::<Ball>::ZERO; 5];
        products[power] = Complex::real(Ball::from(r));
        Given { s: Complex::new(Dd::from(re), Dd::from(im)), loose: 0.0, products, rest: [0.0; 5] }
    };
    let alone = |of: [f64; 3]| vec![pole(of[0], of[1], of[2], 0)];
    let through_all = [Ball::ZERO; 3];
    let sums = [
        (alone([-0.1, 1.0, 0.4]), none, through_all),
        (alone([-3.0, 0.0, 0.4]), none, through_all),
        (alone([0.0, 1.0, 0.4]), none, through_all),
        (alone([-30.0, 0.0, 1e-9]), free(0), through_all),
        (alone([-30.0, 0.0, 1e-9]), free(1), through_all),
        (alone([-30.0, 0.0, 1e-9]), none, through(1, 0.3)),
        (alone([-30.0, 0.0, 1e-9]), none, through(2, 0.3)),
        (vec![pole(-30.0, 0.0, 1e-3, 4)], none, through_all),
    ];
    for (which, (poles, free, through)) in sums.into_iter().enumerate() {
        let sum = PartialFractions::of_poles(poles.into_iter(), free, through, Part::Both).expect("finite");
        let mut most = 0.0f64;
        for omega in [0.4, 0.97, 1.3, 7.0] {
            for part in [0.01, 0.1, 0.2] {
                let reach = part * sum.clearance(Dd::from(omega));
                let known = Frequency { omega: Ball::from(omega).widen(reach), ..Frequency::radians(&Number::ONE) };
                let Some(found) = sum.gain(&known).disc() else { panic!("{which} {omega} {part}") };
                for side in [-1.0, -0.5, 0.5, 1.0] {
                    let off = (sum.at(Dd::from(omega) + Dd::from(side * reach)).h - found.value).to_f64().abs();
                    assert!(off <= found.radius, "{which} {omega} {part}: {off:e} {:e}", found.radius);
                    most = most.max(off / found.radius);
                }
            }
        }
        // Powers of s and the pole that they come from are bounded by themselves, though they cancel.
        assert!(most > if which == 7 { 0.01 } else { 0.2 }, "{which}: {most}");
    }
}

/// Coefficients of powers of s, and of free motions, that are off by all that they are uncertain by, one at a time: H and its slope,
/// below and above 1 rad/s, are within what is said of them, and need most of it.
#[test]
fn values_hold_those_of_uncertain_powers() {
    const OFF: f64 = 1e-6;
    let none = Complex::<Ball>::ZERO;
    for which in 0..8 {
        let of = |off: f64, doubt: f64| {
            let ball = |k: usize, x: f64| {
                let own = if k == which { (off, doubt) } else { (0.0, 0.0) };
                if x == 0.0 && k != which { Ball::ZERO } else { Ball::from(x + own.0).widen(own.1) }
            };
            let through = [ball(0, 0.5), ball(1, -0.25), ball(2, 0.75)];
            let free = [ball(3, 1.5), ball(4, 0.125), ball(5, -2.0), ball(6, 0.5), ball(7, 3.0)];
            // What the pole adds to the powers is not in doubt.
            let products = [Complex::real(Ball::from(1e-9)), none, none, none, none];
            let pole = Given { s: Complex::new(Dd::from(-30.0), Dd::ZERO), loose: 0.0, products, rest: [0.0; 5] };
            PartialFractions::of_poles([pole].into_iter(), free, through, Part::Both).expect("finite")
        };
        let known = of(0.0, OFF);
        for side in [-1.0, 1.0] {
            let truth = of(side * OFF * (1.0 - 1e-9), 0.0);
            for omega in [0.125, 0.75, 1.5, 20.0] {
                let [a, b] = [&known, &truth].map(|sum| sum.at(Dd::from(omega)));
                let off = [a.h - b.h, a.slope - b.slope].map(|z| z.to_f64().abs());
                assert!(off[0] <= a.errors[0] && off[1] <= a.errors[1], "{which} {omega}: {off:?} {:?}", a.errors);
                assert!(off[0] > 0.2 * a.errors[0], "{which} {omega}: {off:?} {:?}", a.errors);
                // In closed form: the coefficient's own power of i omega, and its slope.
                let power = [0, 1, 2, -2, -1, 0, 1, 2][which];
                let size = OFF * f64::powi(omega, power);
                assert!((off[0] / size - 1.0).abs() < 1e-6, "{which} {omega}: {off:?}");
                let slope = size * f64::from(power).abs() / omega;
                assert!((off[1] - slope).abs() <= 1e-6 * size / omega, "{which} {omega}: {off:?} {slope:e}");
            }
        }
    }
}
