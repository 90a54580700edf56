//! The two roots of m s^2 + c s + k, m > 0, by closed forms without cancellation. In: three numbers, exact or enclosed.
//! Out: the poles with their kinds. The sign of the discriminant c^2 - 4 m k is exact if the numbers are. See
//! docs/method/poles.md#quadratics.

use crate::analysis::answer::PoleKind;
use crate::base::{Ball, Dd, Number, up};
use crate::kernel::complex::Complex;
use crate::kernel::real::Real;
use crate::kernel::triple::Precise;

/// A root and its kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Root {
    pub re: Ball,
    pub im: Ball,
    pub kind: PoleKind,
}

/// Both roots of m s^2 + c s + k.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Roots {
    /// Distinct roots, each certain by itself.
    Distinct([Root; 2]),
    /// A double root, exactly.
    Double(Root),
    /// Two roots that the digits of m, c and k do not separate.
    Unseparated([Root; 2]),
}

impl Roots {
    /// Multiplies each root by a positive number.
    pub fn times(self, rate: Ball) -> Roots {
        let scaled = |root: Root| Root { re: root.re * rate, im: root.im * rate, ..root };
        match self {
            Roots::Distinct(pair) => Roots::Distinct(pair.map(scaled)),
            Roots::Double(root) => Roots::Double(scaled(root)),
            Roots::Unseparated(pair) => Roots::Unseparated(pair.map(scaled)),
        }
    }
}

/// The roots; m is certainly positive.
pub fn roots(m: &Number, c: &Number, k: &Number) -> Roots {
    let discriminant = &c.square() - &(&Number::from(4) * &(m * k));
    if discriminant.is_zero() {
        return double(m, c);
    }
    let pair = match () {
        () if discriminant.is_negative() => complex_pair(m, c, &discriminant),
        () if discriminant.is_positive() => real_pair(m, c, k, &discriminant),
        () => return undecided_roots(m, c, &discriminant),
    };
    Roots::Distinct(sharpen(pair, [m, c, k].map(Precise::of)))
}

/// Sharpens the bounds of the roots: p(s) = m (s - s_1)(s - s_2), so any s is within |p(s)| / (m |s - s_2|) of s_1. p is
/// evaluated in triple words; the balls above collect the rounding of every step in double-double.
fn sharpen(roots: [Root; 2], [m, c, k]: [Precise; 3]) -> [Root; 2] {
    const UP: f64 = up::DOZENS;
    let bound = |own: &Root, other: &Root| {
        let s = Complex::new(Precise::of_dd(own.re.mid), Precise::of_dd(own.im.mid));
        let value = (s.scale(m) + Complex::real(c)) * s + Complex::real(k);
        let size = |x: Precise| (x.value.hi().abs() + x.radius) * UP;
        let apart = (own.re.mid - other.re.mid).hi.abs().max((own.im.mid - other.im.mid).hi.abs()) / UP;
        let least = (m.value.hi() / UP - m.radius) * (apart - (other.re.rad + other.im.rad) * UP);
        if least > 0.0 { (size(value.re) + size(value.im)) / least * UP } else { f64::INFINITY }
    };
    let narrowed = |ball: Ball, bound: f64| Ball::new(ball.mid, ball.rad.min(bound));
    let of = |own: &Root, other: &Root| {
        let bound = bound(own, other);
        Root { re: narrowed(own.re, bound), im: narrowed(own.im, bound), kind: own.kind }
    };
    [of(&roots[0], &roots[1]), of(&roots[1], &roots[0])]
}

/// The double root -c/2m.
fn double(m: &Number, c: &Number) -> Roots {
    Roots::Double(real_root((-&(c / &(m + m))).to_ball()))
}

/// The pair -c/2m -+ i sqrt(-d)/2m.
fn complex_pair(m: &Number, c: &Number, discriminant: &Number) -> [Root; 2] {
    let twice = m + m;
    let re = (-&(c / &twice)).to_ball();
    let im = (&root_of(&-discriminant) / &twice).to_ball();
    // An enclosure that contains zero leaves the sign open; it comes from dampers of both signs that may cancel.
    let kind = match re.contains_zero() {
        true if !re.is_zero() => PoleKind::Undetermined,
        false if re.mid.hi > 0.0 => PoleKind::Flutter,
        _ => PoleKind::Oscillation,
    };
    [Root { re, im: -im, kind }, Root { re, im, kind }]
}

/// With q = -(c + sgn(c) sqrt(d)) / 2, a sum of terms of equal sign, the roots are q/m and k/q (Press et al., 5.6).
fn real_pair(m: &Number, c: &Number, k: &Number, discriminant: &Number) -> [Root; 2] {
    let root = root_of(discriminant);
    if c.is_zero() {
        let rate = (&root / &(m + m)).to_ball();
        return [real_root(-rate), real_root(rate)];
    }
    let negative = c.is_negative();
    let sum = if negative { c - &root } else { c + &root };
    let q = -&(&sum / &Number::from(2));
    [real_root((&q / m).to_ball()), real_root((k / &q).to_ball())]
}

/// |s + c/2m| <= sqrt|d| / 2m for both, whatever the sign of d.
fn undecided_roots(m: &Number, c: &Number, discriminant: &Number) -> Roots {
    let twice = m + m;
    let re = (-&(c / &twice)).to_ball();
    let spread = Ball::new(Dd::from(discriminant.to_ball().magnitude()), 0.0).sqrt() / twice.to_ball();
    let radius = spread.magnitude();
    let re = re.widen(radius);
    let root = Root { re, im: Ball::new(Dd::ZERO, radius), kind: real_root(re).kind };
    Roots::Unseparated([root, root])
}

/// The square root of a number that is certainly positive.
fn root_of(number: &Number) -> Number {
    number.sqrt().unwrap_or_else(|| Number::Ball(number.to_ball().sqrt()))
}

/// A real root, with the kind that its sign gives.
pub fn real_root(re: Ball) -> Root {
    let kind = if re.is_zero() {
        PoleKind::Rigid
    } else if re.contains_zero() {
        PoleKind::Undetermined
    } else if re.mid.hi > 0.0 {
        PoleKind::Divergence
    } else {
        PoleKind::Overdamped
    };
    Root { re, im: Ball::ZERO, kind }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::Rational;

    fn number(text: &str) -> Number {
        let (sign, digits) = text.strip_prefix('-').map_or((1, text), |rest| (-1, rest));
        let value = Number::from(Rational::from_decimal(digits).expect("a decimal literal"));
        &Number::from(sign) * &value
    }

    fn of(m: &str, c: &str, k: &str) -> Roots {
        roots(&number(m), &number(c), &number(k))
    }

    fn is_near(ball: Ball, value: f64) -> bool {
        (ball.to_f64() - value).abs() <= 1e-15 * value.abs()
    }

    #[test]
    fn critical_damping_is_recognised_exactly() {
        let Roots::Double(a) = of("0.3", "1.2", "1.2") else { panic!("0.3 s^2 + 1.2 s + 1.2 is 0.3 (s + 2)^2") };
        assert_eq!((a.im, a.kind), (Ball::ZERO, PoleKind::Overdamped));
        assert!(is_near(a.re, -2.0));
        assert!(matches!(
            of("1", "3.999999999999999999999999999999", "4"),
            Roots::Distinct([Root { kind: PoleKind::Oscillation, .. }, _])
        ));
        assert!(matches!(
            of("1", "4.000000000000000000000000000001", "4"),
            Roots::Distinct([Root { kind: PoleKind::Overdamped, .. }, _])
        ));
    }

    #[test]
    fn a_slow_root_next_to_a_fast_one_keeps_its_digits() {
        let Roots::Distinct([fast, slow]) = of("1", "1e8", "1") else { panic!("two real roots") };
        assert!(is_near(fast.re, -1e8) && is_near(slow.re, -1e-8));
        assert!(slow.re.relative_error() < 1e-28);
    }

    #[test]
    fn negative_stiffness_diverges_and_negative_damping_flutters() {
        let Roots::Distinct([decay, growth]) = of("1", "0", "-4") else { panic!("two real roots") };
        assert_eq!((decay.kind, growth.kind), (PoleKind::Overdamped, PoleKind::Divergence));
        assert!(is_near(growth.re, 2.0));
        let Roots::Distinct([a, _]) = of("1", "-0.1", "4") else { panic!("a pair") };
        assert_eq!(a.kind, PoleKind::Flutter);
    }

    #[test]
    fn a_free_mass_behind_a_damper_has_one_pole_at_zero() {
        let Roots::Distinct([decay, rigid]) = of("2", "3", "0") else { panic!("two real roots") };
        assert!(is_near(decay.re, -1.5));
        assert_eq!((rigid.kind, rigid.re), (PoleKind::Rigid, Ball::ZERO));
    }

    #[test]
    fn a_discriminant_of_unknown_sign_leaves_the_pair_unseparated() {
        let c = Number::Ball(Ball::new(Dd::from(4.0), 1e-20));
        let Roots::Unseparated([a, _]) = roots(&Number::ONE, &c, &number("4")) else { panic!("not to be separated") };
        assert!(a.re.rad > 1e-11 && a.re.rad < 1e-9);
    }
}
