//! Taylor polynomials against the sums that they approximate, and poles on the axis.

use super::*;

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
