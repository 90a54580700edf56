//! Taylor polynomials against the sums that they approximate, and poles on the axis.

use super::*;

/// 1 / (s - p) + 1 / (s - p*) with p = -0.1 + i, and a Taylor polynomial about 1.3 that reaches half way to the pole:
/// its terms fall by no more than that, so those after the last are far larger than any rounding.
#[test]
fn a_polynomial_is_as_near_as_it_says() {
    let term = |im: f64| Term {
        s: Complex::new(Dd::from(-0.1), Dd::from(im)),
        r: Complex::new(Dd::ONE, Dd::ZERO),
        size: 1.0,
        doubt: 0.0,
        loose: 0.0,
        rest: [0.0; 5],
    };
    let sum = {
        let terms = vec![term(1.0), term(-1.0)];
        PartialFractions {
            lined: Lined::of(&terms),
            on_axis: Vec::new(),
            terms,
            polynomial: [Ball::ZERO; 4],
            at_zero: AtZero(Ball::ZERO),
            part: Part::Both,
        }
    };
    let (middle, half) = (1.3, 0.15);
    for precise in [false, true] {
        let expansion = sum.expansion(Dd::from(middle), half, precise).expect("clear");
        let mut most = [0.0f64; 2];
        for step in -20..=20 {
            let t = f64::from(step) / 20.0;
            let zero = Complex::<f64>::ZERO;
            let value = expansion.coefficients.iter().rev().fold(zero, |sum, &c| sum.scale(t) + c);
            let slope = (expansion.coefficients.iter().enumerate().skip(1).rev())
                .fold(zero, |sum, (k, &c)| sum.scale(t) + c.scale(k as f64));
            let truth = sum.at(Dd::from(middle) + Dd::from(half * t));
            let off = [(value, truth.h), (slope.scale(1.0 / half), truth.slope)]
                .map(|(a, b)| Complex::new((b.re - Dd::from(a.re)).to_f64(), (b.im - Dd::from(a.im)).to_f64()).abs());
            let bounds = [expansion.errors[0], expansion.errors[1] / half];
            assert!(off[0] <= bounds[0] && off[1] <= bounds[1], "{t}: {off:?} {bounds:?}");
            most = [most[0].max(off[0]), most[1].max(off[1])];
        }
        assert!(most[0] > 1e-3 * expansion.errors[0] && most[0] > 1e-9, "{most:?} {:?}", expansion.errors);
    }
    assert!(sum.expansion(Dd::from(middle), 0.17, false).is_none());
}

/// Poles at +-i and near them; residues as small as the distance are outweighed, others outweigh.
#[test]
fn a_pole_counts_alone_only_where_it_outweighs_the_others() {
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
    let about = |sum: &PartialFractions, reach: f64| sum.singular_between(Dd::from(1.0 - reach), Dd::from(1.0 + reach));
    // The other term and its conjugate are 1 / 1 + 1 / 3: beside a distance of 0.01, 1 / 0.01 is more than that, 0.01 / 0.01 less.
    assert_eq!(about(&sum(2.0, 1.0, 0.0), 0.01), Some(Near::Infinite(Ball::new(Dd::ONE, 1e-25))));
    assert_eq!(about(&sum(2.0, 0.01, 0.0), 0.01), None);
    assert_eq!(about(&sum(2.0, 0.01, 0.0), 0.001), Some(Near::Infinite(Ball::new(Dd::ONE, 1e-25))));
    // Another pole in the range, and a residue that may be zero.
    assert_eq!(about(&sum(1.005, 1.0, 0.0), 0.01), None);
    assert_eq!(about(&sum(2.0, 0.01, 0.02), 0.001), Some(Near::Uncertain));
}
