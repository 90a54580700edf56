//! Scales very small and very large systems near one by powers of two: the same poles exactly, in another unit of time,
//! and no word of any number falls below the range of binary64. In: a system. Out: 2^p M 4^q, 2^p C 2^q, 2^p K, whose
//! poles are 2^-q times those of the system. See docs/method/poles.md#parts-and-scaling.

use crate::analysis::answer::{Modes, Poles};
use crate::base::{Ball, Number, Rational, two_to};
use crate::system::{Form, LinearSystem};

/// Exponents beyond which products of a few numbers, or their lower words, may leave the range of binary64.
const FAR: f64 = 250.0;

/// A system scaled near one, and its unit of time.
pub struct Scaled {
    pub system: LinearSystem,
    /// Its poles times 2^rate are those of the system.
    rate: i32,
    /// Its inertia is 4^inertia times that of the system.
    inertia: i32,
}

/// The scaled system; `None` if no number is far from one.
pub fn scale(system: &LinearSystem) -> Option<Scaled> {
    let [m, c, k] = [&system.m, &system.c, &system.k].map(range);
    let is_far = |range: Option<(f64, f64)>| range.is_some_and(|(low, high)| low < -FAR || high > FAR);
    if !(is_far(m) || is_far(c) || is_far(k)) {
        return None;
    }
    let middle = |(low, high): (f64, f64)| (0.5 * (low + high)).round() as i32;
    let (m, slow) = (m.map_or(0, middle), k.map(middle));
    // M is multiplied by an even power of two, so that shapes are scaled by a power of two.
    let even = |power: i32| power / 2 * 2;
    let (power, rate) = match slow {
        Some(k) => (even(-k), (k - m) / 2),
        None => c.map(middle).map_or((even(-m), 0), |c| (even(m - 2 * c), c - m)),
    };
    let system = LinearSystem {
        m: times(&system.m, power + 2 * rate),
        c: times(&system.c, power + rate),
        k: times(&system.k, power),
        ..system.clone()
    };
    Some(Scaled { system, rate, inertia: power / 2 + rate })
}

impl Scaled {
    /// Converts the undamped modes of the system: shapes and frequencies in the scaled units.
    pub fn modes(&self, modes: &Modes) -> Modes {
        let mut modes = modes.clone();
        let (slower, lighter) = (halves(-self.rate), halves(-self.inertia));
        let times = |x: Ball, by: [f64; 2]| by.iter().fold(x, |x, &by| Ball::new(x.mid.scale(by), x.rad * by));
        for mode in &mut modes.list {
            mode.omega = times(mode.omega, slower);
            mode.omega_squared = times(times(mode.omega_squared, slower), slower);
            mode.shape.iter_mut().for_each(|x| *x = *x * lighter[0] * lighter[1]);
            // Poles are refined from binary64 shapes.
            mode.precise = None;
        }
        modes
    }

    /// The poles of the system from those of the scaled one.
    pub fn unscale(&self, mut poles: Poles) -> Poles {
        let factors = halves(self.rate);
        let back = |x: Ball| {
            let scaled = factors.iter().fold(x, |x, &by| Ball::new(x.mid.scale(by), x.rad * by));
            // A number below the range is less than the least positive one.
            if scaled.mid.hi.abs() < 1e-280 && !x.is_zero() { scaled.widen(f64::MIN_POSITIVE) } else { scaled }
        };
        for pole in &mut poles.list {
            (pole.re, pole.im) = (back(pole.re), back(pole.im));
        }
        poles
    }
}

/// 2^power as a product of two numbers within the range.
fn halves(power: i32) -> [f64; 2] {
    [two_to(power / 2), two_to(power - power / 2)]
}

/// The least and the largest log2 of w a^2.
fn range(form: &Form) -> Option<(f64, f64)> {
    let size = |x: &Number| libm::log2(x.to_f64().abs());
    let of_term = |term: crate::system::Term| {
        let largest = form.row(term).iter().map(|(_, a)| size(a)).filter(|x| x.is_finite()).reduce(f64::max)?;
        Some(size(term.weight) + 2.0 * largest).filter(|x| x.is_finite())
    };
    let sizes = form.terms().filter_map(of_term);
    sizes.map(|size| (size, size)).reduce(|(low, high), (size, _)| (low.min(size), high.max(size)))
}

/// The form times 2^power, exact except for balls.
fn times(form: &Form, power: i32) -> Form {
    let mut result = Form::new();
    let factors = halves(power);
    let scaled = |weight: &Number| match weight {
        Number::Ball(ball) => Number::Ball(factors.iter().fold(*ball, |x, &by| Ball::new(x.mid.scale(by), x.rad * by))),
        exact => {
            factors.iter().filter_map(|&by| Rational::from_f64(by)).fold(exact.clone(), |x, by| &x * &Number::from(by))
        }
    };
    for term in form.terms() {
        let source = result.source(form.source_of(term.source));
        result.push(source, term.nature, scaled(term.weight), form.row(term).copies());
    }
    result
}
