//! A number that depends on one parameter, as a polynomial in it with a bound of what that leaves out. In: numbers of a model in which a
//! parameter is [`Jet::of_parameter_in_series`]. Out: for x = (p - p0) / reach, |x| <= 1, the number is within `rest` of
//! c0 + c1 x + ... with the same coefficients, each in its ball, for every value (Taylor models: K. Makino and M. Berz, *Taylor models and
//! other validated functional inclusion methods*, Int. J. Pure Appl. Math. 4 (2003) 379-456). See docs/method/numbers.md#series.
//!
//! [`Jet::of_parameter_in_series`]: super::Jet::of_parameter_in_series

use super::functions::sine_and_cosine_within;
use super::rounding::up;
use super::{Ball, Dd, Jet, Number};

/// The number of coefficients.
pub const ORDER: usize = 12;

/// A number over the range of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Coefficients of the powers of x.
    pub terms: [Ball; ORDER],
    /// An upper bound of the distance from the polynomial.
    pub rest: f64,
}

/// More than what underflows in the sums of a bound.
const UNDERFLOW: f64 = 1e-300;

impl Series {
    pub fn constant(value: Ball) -> Series {
        let mut terms = [Ball::ZERO; ORDER];
        terms[0] = value;
        Series { terms, rest: 0.0 }
    }

    /// The parameter, for all values within `reach` of the middle.
    pub fn of_parameter(middle: Ball, reach: f64) -> Series {
        let mut series = Series::constant(middle);
        series.terms[1] = Ball::from(reach);
        series
    }

    /// The series of a number; `None` if it depends on the parameter and has none.
    pub fn of(number: &Number) -> Option<Series> {
        match number {
            Number::Jet(jet) => jet.series().cloned(),
            constant => Some(Series::constant(constant.enclosure())),
        }
    }

    /// The number that lies along the series; its derivative is not known.
    pub fn into_number(self) -> Number {
        let value = self.terms[0].widen(self.change());
        Jet { value, slope: Ball::new(Dd::ZERO, f64::INFINITY) }.with(Some(self))
    }

    /// The number at a place of the range, |x| <= 1.
    pub fn at(&self, x: Ball) -> Ball {
        self.terms.iter().rev().fold(Ball::ZERO, |sum, term| sum * x + *term).widen(self.rest)
    }

    /// The number of coefficients up to the last one that is not zero.
    pub fn count(&self) -> usize {
        ORDER - self.terms.iter().rev().take_while(|term| term.is_zero()).count()
    }

    /// An upper bound of the change from the first coefficient.
    fn change(&self) -> f64 {
        (self.terms[1..].iter().map(Ball::magnitude).sum::<f64>() + self.rest) * up::DOZENS
    }

    /// An upper bound of the size of the polynomial.
    fn size_of_polynomial(&self) -> f64 {
        self.terms.iter().map(Ball::magnitude).sum::<f64>() * up::DOZENS
    }

    /// An upper bound of the size.
    pub fn magnitude(&self) -> f64 {
        (self.terms[0].magnitude() + self.change()) * up::FEW
    }

    pub fn is_finite(&self) -> bool {
        self.rest.is_finite() && self.terms.iter().all(Ball::is_finite)
    }

    pub fn negative(&self) -> Series {
        Series { terms: self.terms.map(|term| -term), rest: self.rest }
    }

    pub fn plus(&self, other: &Series) -> Series {
        let rest = match self.rest == 0.0 && other.rest == 0.0 {
            true => 0.0,
            false => (self.rest + other.rest) * up::FEW,
        };
        Series { terms: std::array::from_fn(|k| self.terms[k] + other.terms[k]), rest }
    }

    pub fn times(&self, other: &Series) -> Series {
        let (a, b) = (self.count(), other.count());
        let mut terms = [Ball::ZERO; ORDER];
        let mut beyond = 0.0;
        for i in 0..a {
            for j in 0..b {
                match terms.get_mut(i + j) {
                    Some(term) => *term = *term + self.terms[i] * other.terms[j],
                    None => beyond += self.terms[i].magnitude() * other.terms[j].magnitude(),
                }
            }
        }
        if a + b <= ORDER + 1 && self.rest == 0.0 && other.rest == 0.0 {
            return Series { terms, rest: 0.0 };
        }
        // (P + r) (Q + s) - P Q = P s + (Q + s) r.
        let rest = beyond + self.size_of_polynomial() * other.rest + other.magnitude() * self.rest;
        Series { terms, rest: rest * up::THOUSANDS + UNDERFLOW }
    }

    /// A binary64 number times the series.
    pub fn times_number(&self, factor: f64) -> Series {
        let rest = if self.rest == 0.0 { 0.0 } else { self.rest * factor.abs() * up::FEW + UNDERFLOW };
        Series { terms: self.terms.map(|term| term * Ball::from(factor)), rest }
    }

    /// The number times a constant, plus another constant.
    fn times_plus(&self, factor: &Series, constant: Ball) -> Series {
        let mut found = self.times(factor);
        found.terms[0] = found.terms[0] + constant;
        found
    }

    /// A polynomial with these coefficients, and a bound of what it leaves out of a function.
    fn polynomial(&self, coefficients: &[Ball], tail: f64) -> Option<Series> {
        let (last, others) = coefficients.split_last()?;
        let mut found = Series::constant(*last);
        for coefficient in others.iter().rev() {
            found = found.times_plus(self, *coefficient);
        }
        found.rest = (found.rest + tail) * up::FEW;
        found.is_finite().then_some(found)
    }

    /// The first coefficient, and the number less it.
    fn split(&self) -> (Ball, Series) {
        let mut change = self.clone();
        change.terms[0] = Ball::ZERO;
        (self.terms[0], change)
    }

    /// The middle, the change from it and the ratio of their sizes, if that is certainly below one.
    fn around(&self) -> Option<(Ball, Series, f64)> {
        let (middle, change) = self.split();
        let ratio = change.change() / middle.mignitude() * up::FEW;
        (ratio < 1.0).then_some((middle, change, ratio))
    }

    /// 1/(a + u) = sum (-u)^k / a^(k + 1); what is left out is at most ratio^N / (|a| (1 - ratio)).
    pub fn reciprocal(&self) -> Option<Series> {
        let (middle, change, ratio) = self.around()?;
        let inverse = Ball::ONE / middle;
        let tail = geometric(ratio) * inverse.magnitude();
        change.polynomial(&ascending(inverse, |_| -inverse), tail * up::FEW)
    }

    /// sqrt(a + u) = sqrt(a) sum binomial(1/2, k) (u/a)^k, and all of these binomials are at most 1 in size.
    pub fn root(&self) -> Option<Series> {
        let (middle, change, ratio) = self.around()?;
        if !middle.is_positive() {
            return None;
        }
        let root = middle.sqrt();
        let coefficients = ascending(root, |k| Ball::from(0.5 - k) / (middle * Ball::from(k + 1.0)));
        change.polynomial(&coefficients, geometric(ratio) * root.magnitude() * up::FEW)
    }

    /// ln(a + u) = ln a - sum (-u/a)^k / k.
    pub fn logarithm(&self) -> Option<Series> {
        let (middle, change, ratio) = self.around()?;
        let inverse = -(Ball::ONE / middle);
        let mut coefficients = ascending(-Ball::ONE, |_| inverse);
        for (k, coefficient) in coefficients.iter_mut().enumerate().skip(1) {
            *coefficient = *coefficient / Ball::from(k as f64);
        }
        coefficients[0] = Number::Ball(middle).ln()?.enclosure();
        change.polynomial(&coefficients, geometric(ratio))
    }

    /// e^(a + u) = e^a sum u^k / k!; for |u| <= 1 what is left out is at most e^a 3 |u|^N / N!.
    pub fn exponential(&self) -> Option<Series> {
        let (middle, change) = self.split();
        let size = change.change();
        let value = Number::Ball(middle).exp()?.enclosure();
        let tail = 3.0 * over_factorial(size) * value.magnitude() * up::DOZENS;
        let coefficients = ascending(value, |k| Ball::ONE / Ball::from(k + 1.0));
        if size <= 1.0 { change.polynomial(&coefficients, tail) } else { None }
    }

    /// Sine and cosine; what is left out of either is at most |u|^N / N!. The angle that the polynomial leaves out turns both further.
    pub fn sine_and_cosine(&self) -> Option<[Series; 2]> {
        let (middle, mut change) = self.split();
        let left_out = std::mem::take(&mut change.rest);
        let tail = over_factorial(change.change());
        let (sine, cosine) = Number::Ball(middle).sin_cos()?;
        let (sine, cosine) = (sine.enclosure(), cosine.enclosure());
        let factors = ascending(Ball::ONE, |k| Ball::ONE / Ball::from(k + 1.0));
        let turned = |values: [Ball; 4]| {
            let coefficients: [Ball; ORDER] = std::array::from_fn(|k| values[k % 4] * factors[k]);
            change.polynomial(&coefficients, tail)
        };
        let (s, c) = (turned([sine, cosine, -sine, -cosine])?, turned([cosine, -sine, -cosine, sine])?);
        if left_out == 0.0 {
            return Some([s, c]);
        }
        let [sine, cosine] = sine_and_cosine_within(left_out).map(|ball| {
            let mut series = Series::constant(Ball::exact(ball.mid));
            series.rest = ball.rad;
            series
        });
        Some([s.times(&cosine).plus(&c.times(&sine)), c.times(&cosine).plus(&s.times(&sine).negative())])
    }

    /// The angle of a direction (x, y) that does not cross the negative x axis: turned by the angle t in the middle, (u, v), it is
    /// t + arctan(v/u) as long as u > 0. For |w| < 1 the series of arctan w leaves out at most |w|^N.
    pub fn angle(y: &Series, x: &Series) -> Option<Series> {
        let [at_y, at_x] = [y, x].map(|series| Number::Ball(series.terms[0]));
        let turn = Ball::exact(Number::atan2(&at_y, &at_x)?.enclosure().mid);
        let (sine, cosine) = Number::Ball(turn).sin_cos()?;
        let [sine, cosine] = [sine, cosine].map(|number| Series::constant(number.enclosure()));
        let u = x.times(&cosine).plus(&y.times(&sine));
        let v = y.times(&cosine).plus(&x.times(&sine).negative());
        if !u.terms[0].is_positive() {
            return None;
        }
        let w = v.times(&u.reciprocal()?);
        let size = w.magnitude();
        if size > 0.5 {
            return None;
        }
        let coefficients: [Ball; ORDER] = std::array::from_fn(|k| match k % 4 {
            0 | 2 => Ball::ZERO,
            1 => Ball::ONE / Ball::from(k as f64),
            _ => -(Ball::ONE / Ball::from(k as f64)),
        });
        let mut angle = w.polynomial(&coefficients, power(size) * up::FEW)?;
        angle.terms[0] = angle.terms[0] + turn;
        Some(angle)
    }
}

/// Coefficients, each of which is the one with the index k before it times a factor.
fn ascending(first: Ball, factor: impl Fn(f64) -> Ball) -> [Ball; ORDER] {
    let mut list = [first; ORDER];
    for k in 1..ORDER {
        list[k] = list[k - 1] * factor(k as f64 - 1.0);
    }
    list
}

/// An upper bound of x^N, for 0 <= x.
fn power(x: f64) -> f64 {
    (0..ORDER).fold(1.0, |power, _| power * x) * up::DOZENS + UNDERFLOW
}

/// An upper bound of x^N / (1 - x), for 0 <= x < 1.
fn geometric(x: f64) -> f64 {
    // 1 - x is exact for x > 1/2 and rounded once below.
    power(x) / (1.0 - x) * up::FEW
}

/// An upper bound of x^N / N!.
fn over_factorial(x: f64) -> f64 {
    (1..=ORDER).fold(power(x), |left, k| left / k as f64) * up::DOZENS + UNDERFLOW
}

/// The series of a sum, if it has one.
pub(super) fn sum(a: &Number, b: &Number) -> Option<Series> {
    of_both(a, b, |a, b| Some(a.plus(&b)))
}

pub(super) fn product(a: &Number, b: &Number) -> Option<Series> {
    of_both(a, b, |a, b| Some(a.times(&b)))
}

pub(super) fn quotient(a: &Number, b: &Number) -> Option<Series> {
    of_both(a, b, |a, b| Some(a.times(&b.reciprocal()?)))
}

pub(super) fn angle(y: &Number, x: &Number) -> Option<Series> {
    of_both(y, x, |y, x| Series::angle(&y, &x))
}

fn of_both(a: &Number, b: &Number, of: impl FnOnce(Series, Series) -> Option<Series>) -> Option<Series> {
    let has_one = |number: &Number| matches!(number, Number::Jet(jet) if jet.series().is_some());
    let made = || of(Series::of(a)?, Series::of(b)?);
    if has_one(a) || has_one(b) { made() } else { None }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AT: f64 = 1.5;

    type Function<'a> = &'a dyn Fn(&Number) -> Option<Number>;

    /// At places of the range, what the function is there lies as near to the polynomial as its bound says. Returns the share of the bound
    /// that is used, at the most.
    fn check(f: impl Fn(&Number) -> Option<Number>, middle: f64, reach: f64) -> f64 {
        let Some(Number::Jet(jet)) = f(&Jet::of_parameter_in_series(Ball::from(middle), reach)) else {
            panic!("a jet")
        };
        let series = jet.series().expect("a series");
        let mut used = 0.0f64;
        for x in [-1.0, -0.75, 0.0, 0.125, 0.5, 1.0] {
            let truth =
                f(&Number::Ball(Ball::from(middle) + Ball::from(x) * Ball::from(reach))).expect("a value").enclosure();
            let sum = series.terms.iter().rev().fold(Ball::ZERO, |sum, term| sum * Ball::from(x) + *term);
            let off = sum - truth;
            assert!(off.mignitude() <= series.rest, "{x}: {off:?} {:e}", series.rest);
            assert!(off.rad <= 1e-24 * truth.magnitude().max(1.0), "{off:?}");
            if off.mid.hi.abs() > 1e3 * off.rad {
                used = used.max(off.mid.hi.abs() / series.rest);
            }
        }
        used
    }

    /// Functions and their compositions, narrow ranges and wide ones, where what the polynomial leaves out shows in the third digit.
    #[test]
    fn functions_lie_within_the_rest() {
        let two = Number::from(2);
        let functions: [(&str, Function); 15] = [
            ("product", &|x| Some(&(x * x) * &(x + &two))),
            ("high power", &|x| x.powi(15)),
            ("reciprocal", &|x| x.recip()),
            ("negative power", &|x| x.powi(-3)),
            ("quotient", &|x| (x + &two).checked_div(&(x * x))),
            ("root", &|x| x.sqrt()),
            ("power", &|x| x.pow(&Number::from("1.3"))),
            ("exponential", &|x| x.exp()),
            ("logarithm", &|x| x.ln()),
            ("sine", &|x| x.sin_cos().map(|(s, _)| s)),
            ("cosine of a quotient", &|x| x.recip()?.sin_cos().map(|(_, c)| c)),
            ("angle", &|x| Number::atan2(x, &two)),
            // The arctangent alone leaves something out here.
            ("angle about zero", &|x| Number::atan2(&(x - &Number::from("1.5")), &two)),
            ("angle behind", &|x| Number::atan2(&(x - &two), &-x)),
            ("length", &|x| (&(x * x) + &Number::from("0.3")).sqrt()),
        ];
        for (name, f) in functions {
            for reach in [1.0 / 1024.0, 0.0625, 0.375] {
                let used = check(f, AT, reach);
                if reach == 0.375 && name != "product" {
                    assert!(used > 1e-8, "{name}: the bound is {:.0e} times too wide", 1.0 / used);
                }
            }
        }
        check(|x| (-x).abs().asin(), 0.5, 0.1);
        check(|x| (-x).sqrt().or_else(|| (&Number::from(3) - x).sqrt()), 1.5, 0.1);
    }

    /// A number along a series is enclosed as far as the series changes, with what it leaves out: what signs are read off.
    #[test]
    fn the_enclosure_of_a_series_holds_all_of_it() {
        let mut series = Series::of_parameter(Ball::from(AT), 0.5);
        series.rest = 0.25;
        let found = series.into_number().enclosure();
        assert!(found.magnitude() >= AT + 0.75 && found.mignitude() <= AT - 0.75, "{found:?}");
        assert!(found.rad < 0.7501);
    }

    #[test]
    fn a_polynomial_of_low_degree_leaves_out_nothing() {
        let x = Jet::of_parameter_in_series(Ball::from(AT), 0.5);
        let cube = &(&x * &x) * &(&x - &Number::from(7));
        let series = Series::of(&cube).expect("a series");
        assert_eq!(series.rest, 0.0);
        // (1.5 + x/2)^2 (x/2 - 5.5), by hand.
        for (k, truth) in [-12.375, -7.125, -0.625, 0.125].iter().enumerate() {
            assert!((series.terms[k] - Ball::from(*truth)).magnitude() < 1e-27, "{k}: {:?}", series.terms[k]);
        }
    }

    /// What has no series, or leaves the domain of the series of a function, has none; the enclosure is still there.
    #[test]
    fn where_no_series_is_known_there_is_none() {
        let x = Jet::of_parameter_in_series(Ball::from(AT), 0.5);
        let y = Jet::of_parameter(Ball::from(AT).widen(0.5));
        let none = |number: &Number| Series::of(number).is_none();
        assert!(!none(&x) && none(&y) && none(&(&x + &y)) && none(&(&x * &y)) && none(&(&y / &x)));
        assert!(!none(&Number::from(2)), "a constant is its own");
        let wide = Jet::of_parameter_in_series(Ball::from(1.0), 1.0);
        assert!(none(&(&Number::ONE / &wide)));
        let far = Jet::of_parameter_in_series(Ball::from(1.0), 1.5);
        assert!(none(&far.exp().expect("a value")));
        assert!(none(&Number::atan2(&far, &Number::ONE).expect("an angle")));
    }
}
