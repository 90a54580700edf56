//! The largest value or |value| of polynomials on [0, 1], each known to within an error. In: one piece after another. Out: a
//! ball that contains the largest of them all, or zero if none is above it. See docs/method/measures.md#peak-and-rms.

use crate::base::{Ball, Dd, up};

const UP: f64 = up::THOUSANDS;
/// Twice the relative error of one operation in two words.
const UNIT: f64 = 2.0 * Dd::EPSILON;

/// An output on [0, 1] of a piece: sum terms[j] x^j, to within `error`.
pub struct Curve<'a> {
    /// The terms in binary64, for decisions.
    rough: Vec<f64>,
    /// The terms in two words, for reported values.
    fine: Option<&'a [Dd]>,
    error: f64,
    /// Whether values below zero count as such; otherwise magnitudes are compared.
    signed: bool,
    /// Rounding errors of the value, the slope and the second derivative of the rough terms, anywhere on [0, 1].
    roundings: [f64; 3],
}

impl<'a> Curve<'a> {
    pub fn rough(terms: &'a [f64], error: f64) -> Curve<'a> {
        Curve::of(terms.to_vec(), None, error)
    }

    pub fn fine(terms: &'a [Dd], error: f64) -> Curve<'a> {
        Curve::of(terms.iter().map(|x| x.to_f64()).collect(), Some(terms), error)
    }

    fn of(rough: Vec<f64>, fine: Option<&'a [Dd]>, error: f64) -> Curve<'a> {
        // Horner's scheme rounds each term twice for each of the terms above it, for each of the three values.
        let each = 6.0 * (rough.len() as f64 + 2.0) * f64::EPSILON;
        let roundings = [0, 1, 2].map(|order| derivative_bound(&rough, order) * each);
        Curve { rough, fine, error, signed: false, roundings }
    }

    /// The curve itself in place of its magnitude.
    pub fn signed_curve(self) -> Curve<'a> {
        Curve { signed: true, ..self }
    }

    fn size(&self, value: f64) -> f64 {
        if self.signed { value } else { value.abs() }
    }

    /// The compared value at a point, with an error bound.
    fn value(&self, x: Dd) -> (Dd, f64) {
        match self.fine {
            Some(terms) => {
                let value = terms.iter().rev().fold(Dd::ZERO, |sum, &term| sum * x + term);
                let value = if self.signed { value } else { value.abs() };
                (value, self.error + self.roundings[0] / f64::EPSILON * UNIT)
            }
            None => (Dd::from(self.size(evaluate(&self.rough, x.hi)[0])), self.error + self.roundings[0]),
        }
    }

    /// A bound of |slope| at a point.
    fn slope(&self, x: Dd) -> f64 {
        match self.fine {
            Some(terms) => self.fine_slope(terms, x).hi.abs() * UP + self.roundings[1] / f64::EPSILON * UNIT,
            None => evaluate(&self.rough, x.hi)[1].abs() + self.roundings[1],
        }
    }

    fn fine_slope(&self, terms: &[Dd], x: Dd) -> Dd {
        let of = |sum: Dd, (j, &term): (usize, &Dd)| sum * x + term * j as f64;
        terms.iter().enumerate().skip(1).rev().fold(Dd::ZERO, of)
    }

    /// The zero of the slope between two points at which it has different signs.
    fn level(&self, from: f64, to: f64, falls: f64) -> Dd {
        let (mut x, mut low, mut high) = (0.5 * (from + to), from, to);
        for _ in 0..NEWTON {
            let [_, slope, bend] = evaluate(&self.rough, x);
            if slope * falls > 0.0 {
                low = x
            } else {
                high = x
            }
            let next = x - slope / bend;
            let next = if next > low && next < high { next } else { 0.5 * (low + high) };
            if next == x {
                break;
            }
            x = next;
        }
        let mut level = Dd::from(x);
        let bend = evaluate(&self.rough, x)[2];
        if let Some(terms) = self.fine {
            for _ in 0..2 {
                let better = level - self.fine_slope(terms, level) / Dd::from(bend);
                if better.hi >= from && better.hi <= to {
                    level = better;
                }
            }
        }
        level
    }
}

/// An end that a curve may go beyond, as seen from zero: (curve - end) times the sign of the end.
pub struct About {
    end: Ball,
    sign: f64,
}

impl About {
    pub fn new(end: Ball) -> About {
        About { end, sign: if end.mid.hi < 0.0 { -1.0 } else { 1.0 } }
    }

    /// The curve beyond the end, with its sign.
    pub fn rough(&self, terms: &[f64], error: f64) -> Curve<'static> {
        let mut seen: Vec<f64> = terms.iter().map(|term| self.sign * term).collect();
        seen[0] -= self.sign * self.end.to_f64();
        let rounding = (terms[0].abs() + self.end.magnitude()) * f64::EPSILON;
        Curve::of(seen, None, (error + self.end.rad + rounding) * UP).signed_curve()
    }

    /// The curve in double-double.
    pub fn fine<'a>(&self, terms: &'a mut [Dd], error: f64) -> Curve<'a> {
        let rounding = (terms[0].hi.abs() + self.end.magnitude()) * UNIT;
        terms[0] -= self.end.mid;
        terms.iter_mut().for_each(|term| *term = *term * self.sign);
        Curve::fine(terms, (error + self.end.rad + rounding) * UP).signed_curve()
    }
}

/// Bounds of the largest |value| so far.
#[derive(Clone, Copy, Debug, Default)]
pub struct Largest {
    low: Dd,
    high: Dd,
}

impl Largest {
    /// Records the values that the curve certainly reaches; returns an upper bound of the curve if it exceeds the
    /// largest known value.
    pub fn bound_rough(&mut self, curve: &Curve) -> Option<f64> {
        let above = (derivative_bound(&curve.rough, 0) + curve.error) * UP;
        if self.reaches(above) {
            return None;
        }
        let mut own = Largest { low: self.low, high: Dd::ZERO };
        own.search(curve);
        self.low = own.low;
        let high = (own.high.hi * UP).next_up();
        (!self.reaches(high)).then_some(high)
    }

    /// Takes account of a curve in two words.
    pub fn bound_fine(&mut self, curve: &Curve) {
        self.search(curve);
    }

    /// Records that some value may be as large as this.
    pub fn at_most(&mut self, high: f64) {
        self.high = larger(self.high, Dd::from(high));
    }

    /// Records that this value is certainly reached.
    pub fn at_least(&mut self, low: f64) {
        self.low = larger(self.low, Dd::from(low));
    }

    /// Whether a value of this magnitude is certainly reached.
    pub fn reaches(&self, value: f64) -> bool {
        value < self.low.hi || value == 0.0
    }

    pub fn ball(&self) -> Ball {
        let (low, high) = (self.low, larger(self.low, self.high));
        if high.is_zero() {
            return Ball::ZERO;
        }
        let half = (high - low).hi.abs() * 0.5;
        Ball::new((low + high).scale(0.5), (half + high.hi * UNIT) * UP)
    }

    fn search(&mut self, curve: &Curve) {
        let bends = [2, 3].map(|order| derivative_bound(&curve.rough, order));
        self.search_in(curve, 0.0, 1.0, bends, 0);
    }

    /// Searches [from, from + width] of a piece, whose second and third derivatives are bounded.
    fn search_in(&mut self, curve: &Curve, from: f64, width: f64, bends: [f64; 2], depth: usize) {
        let middle = from + 0.5 * width;
        let [value, slope, bend] = evaluate(&curve.rough, middle);
        let [off, slope_off, bend_off] = curve.roundings;
        let spread = 0.5 * (slope.abs() + slope_off) * width + bends[0] * width * width / 8.0;
        if self.reaches(curve.size(value) + (off + spread + curve.error + value.abs() * f64::EPSILON) * UP) {
            return;
        }
        // The curve is flat to within its error: splitting gives no more information.
        if spread <= 0.1 * curve.error {
            return self.take(curve, Dd::from(middle), spread);
        }
        // The slope keeps its sign: the extrema are at the ends.
        if slope.abs() > slope_off + 0.5 * bends[0] * width * UP {
            self.take(curve, Dd::from(from), 0.0);
            return self.take(curve, Dd::from(from + width), 0.0);
        }
        // A line or a constant, as far as binary64 shows: splitting gives no more information.
        if bend.abs().max(0.5 * bends[1] * width) <= bend_off {
            let middle = Dd::from(middle);
            return self.take(curve, middle, 0.5 * curve.slope(middle) * width + bends[0] * width * width / 8.0);
        }
        if bend.abs() <= 0.5 * bends[1] * width * UP + bend_off {
            if depth < DEEPEST {
                self.search_in(curve, from, 0.5 * width, bends, depth + 1);
                return self.search_in(curve, middle, 0.5 * width, bends, depth + 1);
            }
            // The curve is nearly flat: this bounds the whole piece.
            return self.take(curve, Dd::from(middle), spread);
        }
        // The second derivative keeps its sign: the extrema are at the ends or at a zero of the slope.
        let ends = [from, from + width];
        for end in ends {
            self.take(curve, Dd::from(end), 0.0);
        }
        let [falls, rises] = ends.map(|x| evaluate(&curve.rough, x)[1]);
        let clear = falls.abs().min(rises.abs()) > slope_off;
        if clear && falls * rises > 0.0 {
            return;
        }
        let level = if falls * rises < 0.0 {
            curve.level(from, from + width, falls)
        } else if falls.abs() < rises.abs() {
            Dd::from(from)
        } else {
            Dd::from(from + width)
        };
        // A curve of one curvature stays below its tangents.
        self.take(curve, level, curve.slope(level) * width);
    }

    /// Records a value that the curve reaches, and by which `spread` it may rise nearby.
    fn take(&mut self, curve: &Curve, x: Dd, spread: f64) {
        let (value, error) = curve.value(x);
        let off = (error + value.hi.abs() * UNIT) * UP;
        self.low = larger(self.low, value - Dd::from(off));
        self.high = larger(self.high, value + Dd::from((off + spread) * UP));
    }
}

const DEEPEST: usize = 24;
const NEWTON: usize = 60;

fn larger(a: Dd, b: Dd) -> Dd {
    if (b - a).hi > 0.0 { b } else { a }
}

/// Value, slope and second derivative of the polynomial.
fn evaluate(terms: &[f64], x: f64) -> [f64; 3] {
    let (mut value, mut slope, mut bend) = (0.0, 0.0, 0.0);
    for &term in terms.iter().rev() {
        bend = bend * x + slope;
        slope = slope * x + value;
        value = value * x + term;
    }
    [value, slope, 2.0 * bend]
}

/// A bound of the magnitude of a derivative on [0, 1]; order 0 is the polynomial itself.
fn derivative_bound(terms: &[f64], order: usize) -> f64 {
    let factor = |j: usize| (0..order).map(|k| (j - k) as f64).product::<f64>();
    terms.iter().enumerate().skip(order).map(|(j, term)| factor(j) * term.abs()).sum::<f64>() * UP
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1 - 2 (x - 0.3)^2 with an error of a thousandth: the largest value may be 1.001 or 0.999, and no more is known;
    /// in binary64 and in two words.
    #[test]
    fn the_error_of_a_piece_is_in_the_bound() {
        let terms = [0.82, 1.2, -2.0];
        let fine = terms.map(Dd::from);
        let mut largest = Largest::default();
        largest.bound_fine(&Curve::fine(&fine, 1e-3));
        let ball = largest.ball();
        assert!(ball.rad >= 1e-3 && ball.rad < 1.001e-3 && (ball.to_f64() - 1.0).abs() < 1e-12, "{ball:?}");
        let mut largest = Largest::default();
        let high = largest.bound_rough(&Curve::rough(&terms, 1e-3)).expect("larger than nothing");
        assert!((1.001..1.0011).contains(&high), "{high}");
        assert!((0.9989..=0.999).contains(&largest.low.to_f64()));
        // A smaller value adds no information.
        assert!(largest.bound_rough(&Curve::rough(&[0.9, 0.0, 0.05], 1e-3)).is_none());
        assert!(largest.bound_rough(&Curve::rough(&[-0.9, -0.2], 1e-3)).is_some());
    }

    /// A line ends at its largest value, and a constant has it everywhere: a drift, a plateau. Both have no bend whose sign
    /// could be found by halving.
    #[test]
    fn lines_and_constants_are_known_to_two_words() {
        for (terms, truth) in [([0.25, -1.0, 0.0], 0.75), ([0.7, 0.0, 0.0], 0.7), ([-0.7, 0.0, 0.0], 0.7)] {
            let fine = terms.map(Dd::from);
            let mut largest = Largest::default();
            largest.bound_fine(&Curve::fine(&fine, 0.0));
            let ball = largest.ball();
            assert!((ball - Ball::from(truth)).contains_zero() && ball.rad < 1e-28, "{terms:?}: {ball:?}");
        }
    }

    /// A curve with an exact maximum: 1/3 at a third, in 30 digits.
    #[test]
    fn a_top_is_known_to_two_words() {
        let third = Dd::ONE / Dd::from(3.0);
        // third - (x - third)^2
        let terms = [third - third * third, third * 2.0, -Dd::ONE];
        let mut largest = Largest::default();
        largest.bound_fine(&Curve::fine(&terms, 0.0));
        let ball = largest.ball();
        assert!((ball - Ball::ONE / Ball::from(3.0)).contains_zero() && ball.rad < 1e-28, "{ball:?}");
    }

    /// 1 - (1 - x)^4 - a (x - r)^2 is 1 less (1 - r)^4 at x = r, so close to the end at 1 that the slope there is rounding in binary64,
    /// of either sign: a (1 - r)^2 is what would be missing, more than two words need.
    #[test]
    fn a_slope_that_is_rounding_has_no_sign() {
        let a = Dd::from(1e-5);
        for step in 0..300 {
            let apart = Dd::from(1e-12 * f64::from(step));
            let r = Dd::ONE - apart;
            let four = [0.0, 4.0, -6.0, 4.0, -1.0].map(Dd::from);
            let mut terms = four;
            terms[0] -= a * r * r;
            terms[1] += a * r * 2.0;
            terms[2] -= a;
            let mut largest = Largest::default();
            largest.bound_fine(&Curve::fine(&terms, 0.0));
            let ball = largest.ball();
            assert!((ball - Ball::ONE).contains_zero() && ball.rad < 1e-18, "{step}: {ball:?}");
        }
    }

    /// x (1 - x) times (1 - 2 x)^2 has two maxima of 1/16 and a minimum between them, so its slope has one sign at both ends of
    /// many pieces that hold an extremum; and the same below zero.
    #[test]
    fn maxima_between_equal_slopes_are_seen() {
        // x - 5 x^2 + 8 x^3 - 4 x^4
        for sign in [1.0, -1.0] {
            let terms = [0.0, 1.0, -5.0, 8.0, -4.0].map(|a| a * sign);
            let fine = terms.map(Dd::from);
            let mut largest = Largest::default();
            largest.bound_fine(&Curve::fine(&fine, 0.0));
            assert!((largest.ball() - Ball::from(1.0 / 16.0)).contains_zero(), "{:?}", largest.ball());
            let mut largest = Largest::default();
            let high = largest.bound_rough(&Curve::rough(&terms, 0.0)).expect("above zero");
            assert!((1.0 / 16.0..0.0626).contains(&high), "{high}");
        }
    }
}
