//! Elementary functions of [`Number`], each with a rigorous bound: exact where the argument is one of the rational
//! numbers whose value is rational, Taylor series in ball arithmetic with a bounded remainder otherwise.

use super::rounding::up;
use super::series::{self, Series};
use super::surd::Surd;
use super::{Ball, Dd, Jet, MAX_EXACT_BITS, Number, Power, Rational, pi, two_to};

impl Number {
    /// Non-negative square root; `None` if the number is or may be negative.
    pub fn sqrt(&self) -> Option<Number> {
        if let Number::Exact(value) = self {
            if value.signum() < 0 {
                return None;
            }
            if let Some(root) = value.exact_sqrt() {
                return Some(Number::Exact(root));
            }
            if let Some((factor, root)) = Surd::root_of(value) {
                return Some(Number::with_root(Rational::ZERO, factor, root));
            }
            // A square beyond the range of binary64 may have a root within it.
            let half = value.floor_log2() / 2;
            if half.unsigned_abs() > 480 {
                let factor = Number::from(4).powi(-half)?;
                let (root, power) = ((self * &factor).to_ball().sqrt(), two_to(half));
                return Some(Number::Ball(Ball::new(root.mid.scale(power), root.rad * power).widen(f64::MIN_POSITIVE)));
            }
        }
        if let Number::Pi(power) = self {
            return pi::root(power);
        }
        if let Number::Jet(jet) = self {
            let root = jet.value.sqrt();
            return self.is_positive().then(|| jet.through(root, Ball::from(0.5) / root, Series::root));
        }
        let ball = self.to_ball();
        (ball.is_zero() || self.is_positive()).then(|| Number::Ball(ball.sqrt()))
    }

    /// An integer power; `None` for a negative power of a number that may be zero.
    pub fn powi(&self, power: i32) -> Option<Number> {
        if power < 0 && self.may_be_zero() {
            return None;
        }
        if power == 1 {
            return Some(self.clone());
        }
        if let Number::Exact(value) = self
            && let Some(raised) = value.pow(power, MAX_EXACT_BITS)
        {
            return Some(Number::Exact(raised));
        }
        if let Number::Pi(of_pi) = self
            && let Some(raised) = pi::pow(of_pi, power)
        {
            return Some(raised);
        }
        let keeps = matches!(self, Number::Surd(_) | Number::Jet(_));
        let enclosed = if keeps { self.clone() } else { Number::Ball(self.to_ball()) };
        let (mut base, mut result, mut left) = (enclosed, Number::ONE, power.unsigned_abs());
        while left > 0 {
            if left & 1 == 1 {
                result = &result * &base;
            }
            base = base.square();
            left >>= 1;
        }
        Some(if power < 0 { &Number::ONE / &result } else { result })
    }

    /// A real power of a positive number: exp(power ln self); integer powers and square roots keep what is exact.
    /// `None` if the value is not a real number.
    pub fn pow(&self, power: &Number) -> Option<Number> {
        if let Number::Exact(value) = power {
            if let Some(n) = value.to_i64().and_then(|n| i32::try_from(n).ok()) {
                return self.powi(n);
            }
            let twice = value + value;
            if let Some(n) = twice.to_i64().and_then(|n| i32::try_from(n).ok()) {
                return self.sqrt()?.powi(n);
            }
        }
        if self.is_zero() && power.is_positive() {
            return Some(Number::ZERO);
        }
        (power * &self.ln()?).exp()
    }

    /// Natural logarithm; `None` for a number that is or may be zero or negative.
    pub fn ln(&self) -> Option<Number> {
        if self.is_one() {
            return Some(Number::ZERO);
        }
        let ball = self.enclosure();
        let value = (ball.is_positive() && ball.is_finite()).then(|| ln(ball))?;
        Some(match self {
            Number::Jet(jet) => jet.through(value, Ball::ONE / ball, Series::logarithm),
            _ => Number::Ball(value),
        })
    }

    /// Exponential function; `None` beyond the range of binary64.
    pub fn exp(&self) -> Option<Number> {
        if self.vanishes() {
            return Some(Number::ONE);
        }
        let ball = self.enclosure();
        let value = (ball.magnitude() < 700.0).then(|| exp(ball))?;
        Some(match self {
            Number::Jet(jet) => jet.through(value, value, Series::exponential),
            _ => Number::Ball(value),
        })
    }

    /// Sine and cosine of an angle in radians; `None` if not even its quadrant is known.
    pub fn sin_cos(&self) -> Option<(Number, Number)> {
        if self.vanishes() {
            return Some((Number::ZERO, Number::ONE));
        }
        if let Number::Pi(pi) = self
            && let Some(fraction) = pi.fraction_of_pi()
        {
            return Some(sin_cos_of_pi(fraction));
        }
        let ball = self.enclosure();
        let (s, c) = match self {
            Number::Jet(_) if ball.rad > TURNED => match Number::Ball(Ball::exact(ball.mid)).sin_cos() {
                Some((s, c)) => {
                    let (s, c, [sine, cosine]) = (s.enclosure(), c.enclosure(), sine_and_cosine_within(ball.rad));
                    (s * cosine + c * sine, c * cosine - s * sine)
                }
                None => (Ball::ZERO.widen(1.0), Ball::ZERO.widen(1.0)),
            },
            Number::Exact(value) if ball.mid.hi.abs() > NEAR => wide::sin_cos(&value.to_big(), 0.0),
            _ if !ball.is_finite() || ball.rad > LEAST_KNOWN => return None,
            _ if ball.mid.hi.abs() > NEAR => wide::sin_cos_of_ball(ball)?,
            _ => sin_cos(ball),
        };
        if let Number::Jet(jet) = self {
            let [sine, cosine] = match jet.series().and_then(Series::sine_and_cosine) {
                Some(both) => both.map(Some),
                None => [None, None],
            };
            return Some((jet.through(s, c, |_| sine), jet.through(c, -s, |_| cosine)));
        }
        Some((Number::Ball(s), Number::Ball(c)))
    }

    /// Angle of the vector (x, y) in radians, in (-pi, pi]; `None` for the zero vector.
    pub fn atan2(y: &Number, x: &Number) -> Option<Number> {
        if y.vanishes() {
            return if x.is_positive() {
                Some(Number::ZERO)
            } else if x.is_negative() {
                Some(Number::pi())
            } else {
                None
            };
        }
        if !y.is_range()
            && !x.is_range()
            && let Some(twelfths) = twelfths_of_pi(y, x)
        {
            return Some(Number::of_pi(Rational::new(twelfths, 12)));
        }
        let (b, a) = (y.enclosure(), x.enclosure());
        let known = !(b.contains_zero() && a.contains_zero()) && b.is_finite() && a.is_finite();
        if let (Number::Jet(_), _) | (_, Number::Jet(_)) = (y, x)
            && b.contains_zero()
            && !a.is_positive()
        {
            // The angle may jump by a turn.
            return None;
        }
        let angle = known.then(|| atan2(b, a))?;
        if !matches!((y, x), (Number::Jet(_), _) | (_, Number::Jet(_))) {
            return Some(Number::Ball(angle));
        }
        let series = series::angle(y, x);
        let (y, x) = (Jet::of(y), Jet::of(x));
        let slope = (x.value * y.slope - y.value * x.slope) / (x.value.square() + y.value.square());
        Some(Jet { value: angle, slope }.with(series))
    }
}

/// Sine and cosine of a fraction of pi, reduced exactly to at most pi/4. Both are exact where they are rational
/// (multiples of pi/2, and one half at pi/6 and pi/3; there are no others: Niven, *Irrational Numbers*, corollary
/// 3.12), and equal the same root at odd multiples of pi/4.
fn sin_cos_of_pi(fraction: &Rational) -> (Number, Number) {
    let (turn, half) = (Rational::from(2), Rational::new(1, 2));
    let angle = fraction - &(&turn * &(fraction / &turn).floor());
    let quarters = (&(&turn * &angle) + &half).floor();
    let (sine, cosine) = in_the_first_eighth(&(&angle - &(&quarters * &half)));
    match quarters.to_i64() {
        Some(0 | 4) => (sine, cosine),
        Some(1) => (cosine, -&sine),
        Some(2) => (-&sine, -&cosine),
        _ => (-&cosine, sine),
    }
}

/// Sine and cosine of a fraction of pi of at most 1/4 in size.
fn in_the_first_eighth(fraction: &Rational) -> (Number, Number) {
    let half = |root: u32| Number::with_root(Rational::ZERO, Rational::new(1, 2), root);
    let signed = |size: Number| if fraction.signum() < 0 { -&size } else { size };
    match fraction.to_fraction() {
        Some((0, _)) => (Number::ZERO, Number::ONE),
        Some((1 | -1, 6)) => (signed(half(1)), half(3)),
        Some((1 | -1, 4)) => (signed(half(2)), half(2)),
        _ => {
            let (sine, cosine) = sin_cos(fraction.to_ball() * Ball::PI);
            (Number::Ball(sine), Number::Ball(cosine))
        }
    }
}

/// The direction (x, y) in twelfths of pi, in (-12, 12], if it is certainly a multiple of pi/6 or pi/4.
fn twelfths_of_pi(y: &Number, x: &Number) -> Option<i64> {
    let upwards = if y.is_positive() {
        1
    } else if y.is_negative() {
        -1
    } else {
        return None;
    };
    if x.is_zero() {
        return Some(6 * upwards);
    }
    let (x_squared, y_squared) = (x.square(), y.square());
    let is = |left: &Number, right: &Number, factor: i64| (left - &(&Number::from(factor) * right)).is_zero();
    let rise = match () {
        () if is(&x_squared, &y_squared, 1) => 3,
        () if is(&x_squared, &y_squared, 3) => 2,
        () if is(&y_squared, &x_squared, 3) => 4,
        () => return None,
    };
    Some(upwards * if x.is_positive() { rise } else { 12 - rise })
}

/// Up to this angle, multiples of pi/2 are subtracted in double-double; beyond it in integers, with as many digits of pi
/// as the angle has before its point and forty more.
const NEAR: f64 = 1e5;
/// Angles of a range that is wider than this are those in its middle, turned further: what powers of the angle multiply is wider than
/// that.
const TURNED: f64 = 1e-3;
/// Up to this angle, below a right one, the sine rises and the cosine falls.
const RISING: f64 = 1.57;
/// An angle that is off by more than this may be in any quadrant.
const LEAST_KNOWN: f64 = 1.0;

/// exp(x) = 2^k exp(r)^(2^6), r = (x - k ln 2) / 64: |r| < 0.006, thirteen terms leave less than 1e-38.
fn exp(x: Ball) -> Ball {
    let k = (x.mid.hi / std::f64::consts::LN_2).round();
    let r = (x - Ball::LN_2 * Ball::from(k)) * Ball::from(1.0 / 64.0);
    // Beyond it, the omitted terms are more than twice the first of them.
    if r.magnitude() > 7.0 {
        return Ball::new(Dd::ZERO, f64::INFINITY);
    }
    let mut term = Ball::ONE;
    let mut sum = Ball::ONE;
    for i in 1..=13 {
        term = term * r / Ball::from(f64::from(i));
        sum = sum + term;
    }
    // The remainder is below 2 |r|^14 / 14!, at most 2 x 0.0055^14 / 8.7e10; a wide argument counts with its radius.
    let mut value = sum.widen(2.0 * r.magnitude().power(14) / 8.7e10);
    for _ in 0..6 {
        value = value.square();
    }
    // Two factors, each in range, since k may be as low as -1010.
    let half = (k / 2.0).trunc();
    value * Ball::from(two_to(half as i32)) * Ball::from(two_to((k - half) as i32))
}

/// ln(x): two Newton steps y <- y + 2 (x - e^y) / (x + e^y) from binary64, then the last correction as a ball:
/// ln x = y + 2 artanh(z), z = (x - e^y) / (x + e^y).
fn ln(x: Ball) -> Ball {
    let mut y = Dd::from(libm::log(x.mid.hi));
    for _ in 0..2 {
        let e = exp(Ball::exact(y)).mid;
        y += (x.mid - e) / (x.mid + e) * 2.0;
    }
    let e = exp(Ball::exact(y));
    let z = (x - e) / (x + e);
    let size = z.magnitude();
    if size > 0.5 {
        return Ball::new(y, f64::INFINITY);
    }
    // |2 artanh z - 2 z| <= z^3 for |z| <= 1/2.
    Ball::exact(y) + (z * Ball::from(2.0)).widen(size.power(3))
}

/// Sine and cosine of all angles of at most this size.
pub(super) fn sine_and_cosine_within(size: f64) -> [Ball; 2] {
    if size > RISING {
        return [Ball::ZERO.widen(1.0), Ball::ZERO.widen(1.0)];
    }
    let (most, least) = near_zero(Ball::from(size));
    let half = 0.5 * (Ball::ONE - least).magnitude() * up::FEW;
    [Ball::ZERO.widen(most.magnitude()), (Ball::ONE - Ball::from(half)).widen(half)]
}

/// Sine and cosine: r = x - k pi/2 with |r| <= pi/4.
fn sin_cos(x: Ball) -> (Ball, Ball) {
    let k = (x.mid.hi / std::f64::consts::FRAC_PI_2).round();
    let half_pi = Ball::PI * Ball::from(0.5);
    rotate_quarters(k.rem_euclid(4.0) as i64, near_zero(x - half_pi * Ball::from(k)))
}

/// Sine and cosine of r + quarters pi/2 from those of r.
fn rotate_quarters(quarters: i64, (sine, cosine): (Ball, Ball)) -> (Ball, Ball) {
    match quarters {
        0 => (sine, cosine),
        1 => (cosine, -sine),
        2 => (-sine, -cosine),
        _ => (-cosine, sine),
    }
}

/// Sine and cosine of a small angle by their series:
/// sin r = r sum (-r^2)^i / (2i+1)!, cos r = sum (-r^2)^i / (2i)!: sixteen terms leave less than |r|^32 / 32!.
fn near_zero(r: Ball) -> (Ball, Ball) {
    if r.magnitude() > 2.0 {
        // Too wide to say anything.
        return (Ball::new(Dd::ZERO, 1.0), Ball::new(Dd::ZERO, 1.0));
    }
    let r2 = r.square();
    let (mut sine, mut cosine) = (r, Ball::ONE);
    let (mut s_term, mut c_term) = (r, Ball::ONE);
    for i in 1..16 {
        let n = f64::from(2 * i);
        c_term = -(c_term * r2) / Ball::from(n * (n - 1.0));
        s_term = -(s_term * r2) / Ball::from(n * (n + 1.0));
        cosine = cosine + c_term;
        sine = sine + s_term;
    }
    let rest = r.magnitude().power(32) / LEFT_OUT;
    (sine.widen(rest), cosine.widen(rest))
}

/// 32!, rounded down.
const LEFT_OUT: f64 = 2.63e35;

/// Angles with many digits before the point.
mod wide {
    use super::{near_zero, rotate_quarters};
    use crate::base::number::{Ball, Dd, Rational, two_to};
    use num_bigint::BigInt;
    use num_integer::Integer;
    use num_rational::BigRational;
    use num_traits::ToPrimitive;

    /// Fractional bits of the remainder.
    const BEHIND: u64 = 120;

    pub fn sin_cos_of_ball(angle: Ball) -> Option<(Ball, Ball)> {
        let (high, low) = (Rational::from_f64(angle.mid.hi)?, Rational::from_f64(angle.mid.lo)?);
        Some(sin_cos(&(high.to_big() + low.to_big()), angle.rad))
    }

    /// Sine and cosine of an angle that is off by at most `error`.
    pub fn sin_cos(angle: &BigRational, error: f64) -> (Ball, Ball) {
        let (quarters, left) = reduce_angle(angle);
        rotate_quarters(quarters, near_zero(left.widen(error)))
    }

    /// The angle less a multiple of pi/2, and that multiple modulo 4. With x and p for 2^bits times the angle and pi, off by
    /// less than one and two, x - k p / 2 is off by less than k + 3: with |k| below 2^size, the left is known to 2^-BEHIND.
    fn reduce_angle(angle: &BigRational) -> (i64, Ball) {
        let size = (angle.numer().bits() + 4).saturating_sub(angle.denom().bits());
        let bits = BEHIND + size + 2;
        let x = (angle.numer() << bits).div_floor(angle.denom());
        let p = pi(bits);
        // The nearest multiple: floor(2 x / p + 1/2).
        let doubled: BigInt = &x * 4 + &p;
        let k = doubled.div_floor(&(&p * 2));
        let left: BigInt = &x * 2 - &k * &p;
        let quarters = k.mod_floor(&BigInt::from(4)).to_i64().unwrap_or(0);
        let scaled = left >> (bits + 1 - BEHIND);
        // Rounded down by less than one unit at 2^-BEHIND, and once more to two words of binary64.
        let high = scaled.to_f64().unwrap_or(0.0);
        let low = (&scaled - BigInt::from(high as i128)).to_f64().unwrap_or(0.0);
        let unit = two_to(-(BEHIND as i32));
        let left = Dd::new(high * unit, low * unit);
        (quarters, Ball::new(left, 3.0 * unit + left.hi.abs() * Dd::EPSILON))
    }

    /// 2^bits pi, to within two: Machin's 16 arctan(1/5) - 4 arctan(1/239), with thirty bits more inside.
    fn pi(bits: u64) -> BigInt {
        const MORE: u64 = 30;
        let one = BigInt::from(1) << (bits + MORE);
        (arctan_of_inverse(5, &one) * 16 - arctan_of_inverse(239, &one) * 4) >> MORE
    }

    /// one arctan(1/n) = sum (-1)^i one / ((2 i + 1) n^(2 i + 1)): each term is rounded by less than two units.
    fn arctan_of_inverse(n: i64, one: &BigInt) -> BigInt {
        let mut power = one / n;
        let mut sum = power.clone();
        let mut i = 1i64;
        while power.bits() > 0 {
            power /= -(n * n);
            sum += &power / (2 * i + 1);
            i += 1;
        }
        sum
    }
}

/// The angle t = atan2 in binary64, then the exact angle left over: with (u, v) = (x, y) turned back by t,
/// atan2(y, x) = t + atan(v / u), |v / u| tiny.
fn atan2(y: Ball, x: Ball) -> Ball {
    let mut t = Dd::from(libm::atan2(y.mid.hi, x.mid.hi));
    let left_over = |t: Dd| {
        let (s, c) = sin_cos(Ball::exact(t));
        (y * c - x * s) / (x * c + y * s)
    };
    t += left_over(t).mid;
    let w = left_over(t);
    let size = w.magnitude();
    if size > 0.5 {
        return Ball::new(t, f64::INFINITY);
    }
    // |atan w - w| <= |w|^3 / 3.
    Ball::exact(t) + w.widen(size.power(3))
}

/// arcsine by atan2(x, sqrt(1 - x^2)); `None` outside [-1, 1].
pub(super) fn one_minus_square(x: &Number) -> Option<Number> {
    (&(&Number::ONE - x) * &(&Number::ONE + x)).sqrt()
}

impl Number {
    /// Arcsine in radians; `None` outside [-1, 1].
    pub fn asin(&self) -> Option<Number> {
        Number::atan2(self, &one_minus_square(self)?)
    }

    /// Arccosine in radians; `None` outside [-1, 1].
    pub fn acos(&self) -> Option<Number> {
        Number::atan2(&one_minus_square(self)?, self)
    }

    /// 20 log10 of an amplitude ratio, its level in decibels; `None` unless it is certainly positive.
    pub fn to_decibel(&self) -> Option<Number> {
        (&self.ln()? * &Number::from(20)).checked_div(&Number::from(10).ln()?)
    }

    /// 10^(self/20): the amplitude ratio of a level in decibels.
    pub fn from_decibel(&self) -> Option<Number> {
        let ten = Number::from(10);
        let exponent = self / &Number::from(20);
        match &exponent {
            Number::Exact(value) if value.is_integer() => ten.pow(&exponent),
            _ => (&exponent * &ten.ln()?).exp(),
        }
    }
}

impl From<&str> for Number {
    /// A decimal literal of this program's own text.
    fn from(text: &str) -> Number {
        Number::Exact(Rational::from_decimal(text).expect("a literal of the program's own text"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_is(x: Option<Number>, digits: &str) {
        let x = x.expect("a value").to_ball();
        let negative = digits.starts_with('-');
        let truth = Number::from(digits.trim_start_matches('-'));
        let truth = if negative { -&truth } else { truth }.to_ball();
        let error = (x.mid - truth.mid).abs().to_f64();
        assert!(error <= x.rad + 1e-31 * truth.magnitude(), "{digits}: error {error:e}, radius {:e}", x.rad);
        // A hundred roundings of 2^-101, doubled by each of the six squarings of exp.
        assert!(x.rad <= 1e-27 * truth.magnitude(), "{digits}: radius {:e}", x.rad);
    }

    // Reference digits: OEIS A001113, A002162, A002392, A049469, A049470, A003881.
    #[test]
    fn functions_have_the_published_digits() {
        assert_is(Number::ONE.exp(), "2.71828182845904523536028747135266249775724709369995");
        assert_is(Number::from(2).ln(), "0.69314718055994530941723212145817656807550013436026");
        assert_is(Number::from(10).ln(), "2.30258509299404568401799145468436420760110148862877");
        assert_is(Number::ONE.sin_cos().map(|p| p.0), "0.84147098480789650665250232163029899962256306079837");
        assert_is(Number::ONE.sin_cos().map(|p| p.1), "0.54030230586813971740093660744297660373231042061792");
        assert_is(Number::atan2(&Number::ONE, &Number::ONE), "0.78539816339744830961566084581987572104929234984378");
        assert_is(Number::from(2).sqrt(), "1.41421356237309504880168872420969807856967187537694");
        assert_is(Number::from("0.5").acos(), "1.04719755119659774615421446109316762806572313312503");
        assert_is((-&Number::from(12)).from_decibel(), "0.25118864315095801110850320677993273941585181007824");
    }

    #[test]
    fn exact_arguments_with_exact_values_stay_exact() {
        assert_eq!(Number::from("2.25").sqrt(), Some(Number::from("1.5")));
        assert_eq!(Number::from(2).powi(-3), Some(Number::from("0.125")));
        assert_eq!((-&Number::from(40)).from_decibel(), Some(Number::from("0.01")));
        assert_eq!(Number::from(4).pow(&Number::from("1.5")), Some(Number::from(8)));
    }

    #[test]
    fn fractions_of_pi_stay_exact_and_so_do_the_rational_values_of_their_functions() {
        let degrees = |n: i64| Number::of_pi(Rational::new(n, 180));
        let half = Number::from("0.5");
        let sin_cos = |n: i64| degrees(n).sin_cos().expect("an angle");
        for (n, sine, cosine) in [(90, 1, 0), (180, 0, -1), (270, -1, 0), (-90, -1, 0), (360, 0, 1), (-180, 0, -1)] {
            assert_eq!(sin_cos(n), (Number::from(sine), Number::from(cosine)), "{n}");
        }
        for (n, sign) in [(30, 1), (150, 1), (-30, -1), (210, -1), (750, 1)] {
            assert_eq!(sin_cos(n).0, &half * &Number::from(sign), "{n}");
        }
        for (n, sign) in [(60, 1), (-60, 1), (120, -1), (240, -1), (360_000_000_060, 1)] {
            assert_eq!(sin_cos(n).1, &half * &Number::from(sign), "{n}");
        }
        assert_eq!(sin_cos(45).0, sin_cos(-45).1);
        assert_eq!(sin_cos(135).1, sin_cos(225).0);
        assert_eq!(&(&Number::pi() / &Number::from(3)) / &Number::pi(), Number::Exact(Rational::new(1, 3)));
        assert_eq!(&Number::pi() - &Number::pi(), Number::ZERO);
        assert_eq!((&Number::from(2) * &Number::pi()).compare(&degrees(360)), Some(std::cmp::Ordering::Equal));
        let (one, minus) = (Number::ONE, -&Number::ONE);
        assert_eq!(Number::atan2(&one, &Number::ZERO), Some(degrees(90)));
        assert_eq!(Number::atan2(&minus, &minus), Some(degrees(-135)));
        assert_eq!((half.asin(), one.asin(), minus.acos()), (Some(degrees(30)), Some(degrees(90)), Some(degrees(180))));
        assert_eq!((half.acos(), (-&half).acos()), (Some(degrees(60)), Some(degrees(120))));
    }

    #[test]
    fn other_fractions_of_pi_agree_with_the_series_at_their_enclosure() {
        for n in [-1000, -271, -7, 1, 29, 31, 44, 46, 59, 89, 91, 136, 200, 314, 359, 100_001] {
            let angle = Number::of_pi(Rational::new(n, 180));
            let (exactly, enclosed) = (angle.sin_cos(), Number::Ball(angle.to_ball()).sin_cos());
            let ((s, c), (t, d)) = (exactly.expect("an angle"), enclosed.expect("an angle"));
            assert!((&s - &t).may_be_zero() && (&c - &d).may_be_zero(), "{n}");
            assert!(s.to_ball().rad < 1e-27 && c.to_ball().rad < 1e-27, "{n}");
        }
    }

    #[test]
    fn functions_outside_their_real_domain_have_no_value() {
        assert_eq!((-&Number::ONE).sqrt(), None);
        assert_eq!(Number::ZERO.ln(), None);
        assert_eq!(Number::ZERO.powi(-1), None);
        assert_eq!(Number::from(2).asin(), None);
        assert_eq!(Number::from(1000).exp(), None);
    }

    /// Digits from 400-digit evaluations; the last angle is the binary64 number nearest to a multiple of pi/2.
    #[test]
    fn large_angles_keep_their_digits() {
        let power = |base: i64, n: i32| Number::from(base).powi(n).expect("a number");
        let cases = [
            (
                Number::from(1_000_000),
                "-0.34999350217129295211765248678077146906140660532872",
                "0.93675212753314478693853253507491877570809780421237",
            ),
            (
                power(10, 12),
                "-0.6112387023768894981920204153246305664962",
                "0.7914463018528902700537662141143323039868",
            ),
            (
                power(10, 22),
                "-0.8522008497671888017727058937530293682618",
                "0.5232147853951389454975944733847094921409",
            ),
            (
                Number::from("123456789012345678901234567890.5"),
                "0.7187105688964201866732262794492366956453",
                "-0.6953093686673465585249517595732048448838",
            ),
            (
                power(10, 300),
                "-0.9857504251603769966090475314298954690777",
                "-0.1682144443742450728518756644355558445331",
            ),
        ];
        for (angle, sine, cosine) in cases {
            let (s, c) = angle.sin_cos().expect("an angle");
            assert_is(Some(s), sine);
            assert_is(Some(c), cosine);
            let (s, c) = (-&angle).sin_cos().expect("an angle");
            assert_is(Some(-&s), sine);
            assert_is(Some(c), cosine);
        }
        let near = &Number::from(6_381_956_970_095_103) * &power(2, 797);
        let ball = Number::Ball(Ball::from(near.to_f64()));
        for angle in [near, ball] {
            let (s, c) = angle.sin_cos().expect("an angle");
            assert_is(Some(s), "0.9999999999999999999999999999999999998902");
            let c = c.to_ball();
            assert!((c.to_f64() + 4.687_165_924_254_627e-19).abs() < 1e-33 && c.rad < 1e-34, "{c:?}");
        }
        // A slightly uncertain argument has an enclosure at least as wide; a very uncertain one has no value.
        let wide = Number::Ball(Ball::new(Dd::from(1e12), 1e-3)).sin_cos().expect("an angle").0.to_ball();
        for end in [-1e-3, 1e-3] {
            let truth = Number::Ball(Ball::exact(Dd::new(1e12, end))).sin_cos().expect("an angle").0.to_ball();
            assert!((wide - truth).contains_zero() && wide.rad < 2e-3);
        }
        assert_eq!(Number::Ball(Ball::new(Dd::from(1e12), 1.5)).sin_cos(), None);
    }

    /// Sixteen terms at the largest argument of the series: the omitted terms are visible, and are in the radius.
    #[test]
    fn the_remainder_of_the_series_is_in_the_radius() {
        let (s, c) = near_zero(Ball::from(1.99));
        let angle = Number::from(Rational::from_f64(1.99).expect("a number"));
        let (truth_s, truth_c) = angle.sin_cos().expect("an angle");
        for (x, truth) in [(s, truth_s), (c, truth_c)] {
            let off = (x.mid - truth.to_ball().mid).abs().to_f64();
            assert!(off <= x.rad, "{off:e} {:e}", x.rad);
        }
        let off = (c.mid - angle.sin_cos().expect("an angle").1.to_ball().mid).abs().to_f64();
        assert!(off > 0.9 * c.rad, "a tenth of the radius would do: {off:e} {:e}", c.rad);
    }

    /// Truncated series over ranges as wide as those of `solve`: both ends are enclosed.
    #[test]
    fn wide_ranges_are_held_to_their_ends() {
        // exp(200), exp(600)
        for (radius, end) in [(200.0, 7.225_973_768_125_749e86), (600.0, 3.773_020_300_925_86e260)] {
            let found = exp(Ball::ZERO.widen(radius));
            assert!(found.magnitude() >= end * (1.0 - 1e-13), "exp(0 +- {radius}): {:e}", found.magnitude());
        }
        // ln(1/2) = -ln 2
        let found = ln(Ball::ONE.widen(0.5));
        assert!(found.mid.to_f64() - found.rad <= -std::f64::consts::LN_2, "{found:?}");
        // If nothing is known about the angle, the sine is still at most 1.
        let (sine, cosine) = Jet::of_parameter(Ball::ZERO.widen(2.0)).sin_cos().expect("a range");
        assert!(sine.enclosure().magnitude() >= 1.0 && cosine.enclosure().magnitude() >= 1.0);
        // The angle jumps between pi and -pi.
        assert_eq!(Number::atan2(&Jet::of_parameter(Ball::ZERO.widen(0.1)), &Number::from(-1)), None);
    }
}
