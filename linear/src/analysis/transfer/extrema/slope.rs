//! The slope of ln |H| over omega. A zero a + i b adds (omega - b) / ((omega - b)^2 + a^2), a pole subtracts as much:
//!
//! ```text
//! g = d ln |H| / d omega = sum over zeros t / (t^2 + a^2) - sum over poles t / (t^2 + a^2),   t = omega - b
//! ```
//!
//! so an extremum of |H| is a root of g. In: zeros and poles. Out: g and its derivative at a point and over an
//! interval, with bounds. Frequencies are represented by their distance from the imaginary part of a nearby root (the
//! anchor), so that the digits of a light damping are not lost. See docs/method/transfer.md#extrema.

use super::far::Far;
use super::fraction::Factored;
use super::roots::{Place, Root};
use crate::base::{Ball, Dd, OrderBy, up};
use crate::kernel::big_float::Float;
use crate::kernel::complex::Complex;

/// A frequency from which others are measured: zero, or the imaginary part of a root.
#[derive(Clone, Debug)]
pub struct Anchor {
    /// rad/s
    place: Float,
    radius: f64,
    /// 1 / unit of the products, a power of two.
    per_unit: f64,
    pub terms: Vec<Term>,
    far: Far,
    /// Whether g is odd, so that it is zero at zero.
    pub is_odd: bool,
}

/// A zero or a pole, relative to an anchor.
#[derive(Clone, Copy, Debug)]
pub struct Term {
    /// The multiplicity, negative for a pole; of a factor beside H any number, off by at most `unsure`.
    pub weight: f64,
    unsure: f64,
    /// b minus the anchor; exactly zero for the anchor's own root.
    offset: Ball,
    /// a
    re: Ball,
    /// a in binary64, and the uncertainty of both.
    short_re: f64,
    loose: f64,
}

/// g over an interval about its midpoint.
#[derive(Clone, Copy, Debug)]
pub struct Cell {
    half: f64,
    /// g and g' at the midpoint, and bounds of their errors.
    g: f64,
    g_error: f64,
    slope: f64,
    slope_error: f64,
    /// A bound of |g''| / 2.
    curvature: f64,
}

/// Relative error of a term in binary64: a dozen rounding errors.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Every anchor, ascending; the first is zero.
pub fn anchors(factored: &Factored) -> Vec<Anchor> {
    let roots = factored.zeros.iter().chain(&factored.poles);
    let mut list: Vec<&Root> = roots.filter(|root| !root.place.is_alone()).collect();
    // Of roots with equal imaginary parts, the one on the axis becomes the anchor: distances to other roots are known
    // only to their radii.
    list.order_by(|a, b| {
        (&a.centre.im - &b.centre.im).sign().then((a.place != Place::Axis).cmp(&(b.place != Place::Axis)))
    });
    list.dedup_by(|b, a| a.centre.im == b.centre.im);
    std::iter::once(None).chain(list.into_iter().map(Some)).map(|own| Anchor::of(factored, own)).collect()
}

fn rounded_up(radius: &Float) -> f64 {
    // The conversion rounds towards zero; the result must not be too small, nor zero.
    radius.to_f64() * (1.0 + 4.0 * f64::EPSILON) + f64::MIN_POSITIVE
}

impl Anchor {
    /// The first of [`anchors`], at zero: distances are the frequencies themselves.
    pub fn zero(factored: &Factored) -> Anchor {
        Anchor::of(factored, None)
    }

    fn of(factored: &Factored, own: Option<&Root>) -> Anchor {
        let place = own.map_or(Float::zero(), |root| root.centre.im.clone());
        let radius = own.map_or(0.0, |root| rounded_up(&root.radius));
        let mut anchor =
            Anchor { place, radius, per_unit: 1.0 / factored.unit, terms: Vec::new(), far: factored.far, is_odd: true };
        for (roots, sign) in [(&factored.zeros, 1.0), (&factored.poles, -1.0)] {
            for root in roots {
                anchor.add(root, sign * root.multiplicity as f64, own.is_some_and(|own| std::ptr::eq(own, root)));
            }
        }
        anchor
    }

    fn add(&mut self, root: &Root, weight: f64, is_own: bool) {
        let radius = if root.radius.is_zero() { 0.0 } else { rounded_up(&root.radius) };
        let on_axis = root.centre.re.is_zero() && root.place != Place::Cluster;
        let re = if on_axis { Ball::ZERO } else { root.centre.re.to_ball(radius) };
        let mut push = |im: Float| {
            let difference = &im - &self.place;
            // The anchor is defined as the true imaginary part of its own root.
            let own = is_own && !im.is_negative();
            let between = self.radius;
            let known = if root.place == Place::Real { 0.0 } else { radius };
            let offset = if own { Ball::ZERO } else { difference.to_ball(between + known) };
            let short_re = re.to_f64();
            let lost = (re.mid - Dd::from(short_re)).abs().to_f64();
            let loose = (offset.rad + re.rad + lost) * up::THOUSANDS;
            self.terms.push(Term { weight, unsure: 0.0, offset, re, short_re, loose });
        };
        push(root.centre.im.clone());
        if !root.place.is_alone() {
            push(-&root.centre.im);
        }
    }

    /// The place in the list of a root exactly at the anchor.
    pub fn root_at_anchor(&self) -> Option<usize> {
        self.terms.iter().position(Term::is_singular)
    }

    /// The anchor of a function with a further factor omega^power, which adds to the root at zero: the term at this place, if there is one.
    pub fn with_power(&self, power: Ball, at_zero: Option<usize>) -> Anchor {
        let mut anchor = self.clone();
        if power.is_zero() {
            return anchor;
        }
        match at_zero {
            Some(place) => {
                let term = &mut anchor.terms[place];
                (term.weight, term.unsure) = short(power + Ball::from(term.weight));
                if term.weight == 0.0 && term.unsure == 0.0 {
                    anchor.terms.remove(place);
                }
            }
            None => anchor.add_factor(Ball::ZERO, power),
        }
        anchor
    }

    /// The anchor of a function with a further factor |omega - root|^power; the root is not at zero.
    pub fn with_factor(&self, root: Ball, power: Ball) -> Anchor {
        let mut anchor = self.clone();
        anchor.add_factor(root, power);
        anchor.is_odd = false;
        anchor
    }

    fn add_factor(&mut self, root: Ball, power: Ball) {
        let (offset, (weight, unsure)) = (root - self.omega(Ball::ZERO), short(power));
        let loose = offset.rad * up::THOUSANDS;
        self.terms.push(Term { weight, unsure, offset, re: Ball::ZERO, short_re: 0.0, loose });
    }

    /// omega of a point, rad/s.
    pub fn omega(&self, t: Ball) -> Ball {
        let place = if self.place.is_zero() { Ball::ZERO } else { self.place.to_ball(self.radius) };
        place + t
    }

    /// omega in binary64.
    pub fn approximate(&self, t: f64) -> f64 {
        self.place.to_f64() + t
    }

    /// The distance to another anchor, with its uncertainty.
    pub fn distance_to(&self, other: &Anchor) -> Ball {
        let difference = &other.place - &self.place;
        if difference.is_zero() { Ball::ZERO } else { difference.to_ball(self.radius + other.radius) }
    }

    /// The distance of omega from the anchor, rad/s.
    pub fn distance_of(&self, omega: Ball) -> Ball {
        omega - self.omega(Ball::ZERO)
    }

    /// Like [`Self::distance_of`], for a frequency with more digits and a radius.
    pub fn exact_distance_of(&self, omega: &Float, radius: f64) -> Ball {
        (omega - &self.place).to_ball(self.radius + radius)
    }

    /// The weight of a root exactly at the anchor on the imaginary axis: |H| is zero or infinite there.
    pub fn singular(&self) -> Option<f64> {
        let own = self.terms.iter().filter(|term| term.is_singular());
        // At least so much of it is certain.
        let certain = |term: &Term| term.weight.signum() * (term.weight.abs() - term.unsure).max(0.0);
        own.map(certain).reduce(|sum, weight| sum + weight)
    }

    /// g over [middle - half, middle + half], with or without the anchor's own singular root.
    pub fn cell(&self, middle: f64, half: f64, with_singular: bool) -> Cell {
        let mut cell = Cell { half, g: 0.0, g_error: 0.0, slope: 0.0, slope_error: 0.0, curvature: 0.0 };
        for term in self.terms.iter().filter(|term| with_singular || !term.is_singular()) {
            term.add_to(&mut cell, middle);
        }
        // The rounding errors of the sums.
        let lost = self.terms.len() as f64 * f64::EPSILON;
        cell.g_error *= 1.0 + lost;
        cell.slope_error *= 1.0 + lost;
        let [g, slope, curvature] = self.far.slopes((self.approximate(middle).abs() + half) * up::DOZENS);
        cell.g_error += g;
        cell.slope_error += slope;
        cell.curvature += curvature;
        cell
    }

    /// Largest relative change of H by the far roots.
    fn spread(&self, t: Ball) -> f64 {
        if self.far == Far::NONE { 0.0 } else { self.far.spread(self.omega(t).magnitude()) }
    }

    /// Whether the interval is so small that binary64 gains nothing by cutting it.
    pub fn is_too_fine(&self, middle: f64, half: f64) -> bool {
        let distance = |term: &Term| {
            let t = (Dd::from(middle) - term.offset.mid).to_f64();
            (t * t + term.short_re * term.short_re).sqrt()
        };
        let nearest = self.terms.iter().map(distance).fold(f64::INFINITY, f64::min);
        // Nothing can be decided within the uncertainty of a root's position.
        let blurred = self.terms.iter().any(|term| half < 0.25 * term.loose && distance(term) < 2.0 * term.loose);
        half < 1e-14 * nearest || half == 0.0 || blurred
    }

    /// g and g' at a point.
    pub fn slope(&self, t: Ball) -> (Ball, Ball) {
        let (mut g, mut slope) = (Ball::ZERO, Ball::ZERO);
        for term in &self.terms {
            let t = t - term.offset;
            let (tt, aa) = (t * t, term.re * term.re);
            let norm = tt + aa;
            let weight = Ball::from(term.weight).widen(term.unsure);
            g = g + weight * (t / norm);
            slope = slope + weight * ((aa - tt) / norm / norm);
        }
        if self.far != Far::NONE {
            let [off, of_slope, _] = self.far.slopes(self.omega(t).magnitude());
            (g, slope) = (g.widen(off), slope.widen(of_slope));
        }
        (g, slope)
    }

    /// The sign of g at a point, 0 if it cannot be decided.
    pub fn sign(&self, t: f64) -> i8 {
        let cell = self.cell(t, 0.0, true);
        if cell.g.abs() > cell.g_error * 1.001 {
            return if cell.g > 0.0 { 1 } else { -1 };
        }
        self.sign_at(Dd::from(t))
    }

    /// Like [`Self::sign`], in double-double.
    pub fn sign_at(&self, t: Dd) -> i8 {
        let (g, _) = self.slope(Ball::exact(t));
        if !g.is_finite() {
            return 0;
        }
        i8::from(g.is_positive()) - i8::from(g.is_negative())
    }

    /// H at a point.
    pub fn value(&self, lead: Ball, t: Ball) -> Complex<Ball> {
        let factor = |term: &Term| Complex::new(self.in_units(-term.re), self.in_units(t - term.offset));
        let by = |product: Complex<Ball>, term: &Term, up: bool| {
            let next = if up { product * factor(term) } else { product / factor(term) };
            if in_range(next.re.mid.hi.abs() + next.im.mid.hi.abs()) {
                next
            } else {
                Complex::new(unknown(), unknown())
            }
        };
        let value = self.product(Complex::real(lead), |z| z.re.mid.hi.abs() + z.im.mid.hi.abs(), by);
        match self.spread(t) {
            0.0 => value,
            spread => {
                let off = spread * (value.re.magnitude() + value.im.magnitude());
                Complex::new(value.re.widen(off), value.im.widen(off))
            }
        }
    }

    /// H over an interval of frequencies, of the anchor at zero; `None` where roots are known to be far and no more.
    pub fn over(&self, lead: Ball, omega: Ball) -> Option<Over> {
        if self.far != Far::NONE || !self.place.is_zero() {
            return None;
        }
        let unit = Ball::from(self.per_unit);
        let zero = Complex::ZERO;
        let mut over = Over {
            at_zero: 0,
            above: [Complex::real(Ball::ONE), zero, zero],
            square_above: [Ball::ONE, Ball::ZERO, Ball::ZERO],
            below: Complex::real(Ball::ONE / lead),
            slopes: [zero; 2],
        };
        let two = Ball::from(2.0);
        for term in &self.terms {
            let up = term.weight > 0.0;
            if term.is_singular() {
                over.at_zero += term.weight as i32;
            }
            for _ in 0..term.weight.abs() as usize {
                if term.is_singular() {
                    let factor = |z: Complex<Ball>| z.scale(unit);
                    match up {
                        true => {
                            over.above = over.above.map(factor);
                            over.square_above = over.square_above.map(|x| x * unit * unit);
                        }
                        false => over.below = factor(over.below),
                    }
                    continue;
                }
                // i (omega - b) - a, and its modulus squared.
                let (re, im) = (self.in_units(-term.re), self.in_units(omega - term.offset));
                let factor = Complex::new(re, im);
                if up {
                    let [v, v1, v2] = over.above;
                    let turned = |z: Complex<Ball>| Complex::new(-z.im * unit, z.re * unit);
                    over.above = [v * factor, v1 * factor + turned(v), v2 * factor + turned(v1).scale(two)];
                    let size = [re.square() + im.square(), two * im * unit, two * unit * unit];
                    over.square_above = product(over.square_above, size);
                } else {
                    over.below = over.below * factor;
                    let inverse = Complex::real(unit) / factor;
                    over.slopes[0] = over.slopes[0] + Complex::new(-inverse.im, inverse.re);
                    over.slopes[1] = over.slopes[1] + inverse * inverse;
                }
            }
        }
        let sizes = [over.above[0], over.below].map(|z| z.re.mid.hi.abs() + z.im.mid.hi.abs());
        sizes.into_iter().all(in_range).then_some(over)
    }

    /// |H| times a factor at a point.
    pub fn size(&self, factor: Ball, t: Ball) -> Ball {
        let modulus = |term: &Term| {
            let t = self.in_units(t - term.offset);
            let re = self.in_units(term.re);
            if re.is_zero() { t.abs() } else { (t * t + re * re).sqrt() }
        };
        let by = |x: Ball, term: &Term, up: bool| {
            let next = if up { x * modulus(term) } else { x / modulus(term) };
            if in_range(next.mid.hi.abs()) { next } else { unknown() }
        };
        let size = self.product(factor, |x| x.mid.hi.abs(), by);
        match self.spread(t) {
            0.0 => size,
            spread => size.widen(spread * size.magnitude()),
        }
    }

    /// Approximation of |H| in binary64, to steer the search.
    pub fn near_size(&self, factor: f64, t: f64) -> f64 {
        let modulus = |term: &Term| {
            let t = (Dd::from(t) - term.offset.mid).to_f64();
            (t * t + term.short_re * term.short_re).sqrt() * self.per_unit
        };
        self.product(factor, |x| x.abs(), |x, term, up| if up { x * modulus(term) } else { x / modulus(term) })
    }

    fn in_units(&self, x: Ball) -> Ball {
        if self.per_unit == 1.0 { x } else { x * Ball::from(self.per_unit) }
    }

    /// A product over zeros (`up`) and poles in an order that keeps it near one, within the range of binary64.
    fn product<T>(&self, start: T, size: impl Fn(&T) -> f64, by: impl Fn(T, &Term, bool) -> T) -> T {
        let side = |up: bool| {
            let of_side = self.terms.iter().filter(move |term| (term.weight > 0.0) == up);
            of_side.flat_map(|term| std::iter::repeat_n(term, term.weight.abs() as usize))
        };
        let (mut zeros, mut poles, mut product) = (side(true).peekable(), side(false).peekable(), start);
        while zeros.peek().is_some() || poles.peek().is_some() {
            let up = poles.peek().is_none() || (zeros.peek().is_some() && size(&product) < 1.0);
            let Some(term) = (if up { zeros.next() } else { poles.next() }) else { break };
            product = by(product, term, up);
        }
        product
    }
}

/// H over an interval of frequencies as a product over its zeros, which may be in the interval, and one over its poles.
#[derive(Clone, Copy, Debug)]
pub struct Over {
    /// The number of zeros at zero, of poles negative; they are in no product.
    pub at_zero: i32,
    /// The product over the zeros with its first two derivatives by omega, and the same of its modulus squared.
    pub above: [Complex<Ball>; 3],
    pub square_above: [Ball; 3],
    /// The product over the poles by the factor before both, and the first two derivatives of its logarithm.
    pub below: Complex<Ball>,
    pub slopes: [Complex<Ball>; 2],
}

/// The product of two functions with their first two derivatives.
pub fn product(a: [Ball; 3], b: [Ball; 3]) -> [Ball; 3] {
    let two = Ball::from(2.0);
    [a[0] * b[0], a[0] * b[1] + a[1] * b[0], a[0] * b[2] + two * (a[1] * b[1]) + a[2] * b[0]]
}

/// Products near the ends of the range of binary64 lose digits that no radius accounts for; zero is not affected.
fn in_range(size: f64) -> bool {
    size == 0.0 || (1e-250..=1e250).contains(&size)
}

fn unknown() -> Ball {
    Ball::new(Dd::ONE, f64::INFINITY)
}

/// A number in binary64, and a bound of its error.
fn short(x: Ball) -> (f64, f64) {
    let value = x.to_f64();
    (value, (x - Ball::from(value)).magnitude())
}

impl Term {
    fn is_singular(&self) -> bool {
        self.offset.is_zero() && self.re.is_zero()
    }

    fn add_to(&self, cell: &mut Cell, middle: f64) {
        let t = (Dd::from(middle) - self.offset.mid).to_f64();
        let a = self.short_re;
        let norm = t * t + a * a;
        let inverse = 1.0 / norm;
        let distance = norm.sqrt();
        // If the root may be within the interval nothing is known; the values become infinite.
        let clear = (distance * (1.0 - ROUNDING) - self.loose).max(0.0);
        let to_interval = (t.abs() - cell.half).max(0.0);
        let least = ((to_interval * to_interval + a * a).sqrt() * (1.0 - ROUNDING) - self.loose).max(0.0);
        let size = self.weight.abs() + self.unsure;
        let reach = 1.0 / clear;
        cell.g += self.weight * t * inverse;
        cell.slope += self.weight * (a * a - t * t) * inverse * inverse;
        cell.g_error += size * (ROUNDING * reach + self.loose * reach * reach) + self.unsure * reach;
        cell.slope_error +=
            size * reach * reach * (2.0 * ROUNDING + 2.0 * self.loose * reach) + self.unsure * reach * reach;
        cell.curvature += size / (least * least * least);
    }
}

impl Cell {
    /// Whether g certainly has no root in the interval; `false` for NaN and infinities.
    pub fn has_no_root(&self) -> bool {
        let swing = self.half * (self.slope.abs() + self.slope_error) + self.half * self.half * self.curvature;
        self.g.abs() > (self.g_error + swing) * up::THOUSANDS
    }

    /// Whether g' certainly has no root in the interval.
    pub fn is_monotone(&self) -> bool {
        self.slope.abs() > (self.slope_error + 2.0 * self.half * self.curvature) * up::THOUSANDS
    }

    /// A bound of |g| over the interval.
    pub fn magnitude_bound(&self) -> f64 {
        let swing = self.half * (self.slope.abs() + self.slope_error) + self.half * self.half * self.curvature;
        (self.g.abs() + self.g_error + swing) * up::THOUSANDS
    }

    /// Whether g and g' are dominated by rounding errors, so that cutting would not help.
    pub fn is_noise(&self) -> bool {
        let swing = self.half * (self.slope.abs() + self.slope_error) + self.half * self.half * self.curvature;
        swing < self.g_error && self.half * self.curvature < self.slope_error
    }

    /// g and g' at the midpoint.
    pub fn middle(&self) -> (f64, f64) {
        (self.g, self.slope)
    }
}

#[cfg(test)]
mod tests;
