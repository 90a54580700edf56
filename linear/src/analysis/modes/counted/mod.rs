//! The lowest modes of a part by counts in floating point of hundreds of bits, whatever the stiffnesses: K - s M has as many negative
//! pivots as eigenvalues lie below s. In: the forms of a part, and modes of which some are not certain enough. Out: the modes with
//! enclosures between two counts. See docs/method/modes.md#counts-in-many-bits.

mod counts;

use crate::analysis::answer::Route;
use crate::analysis::modes::counted::counts::{COUNT, Counts, MOST_PRODUCTS_IN_ALL, Point};
use crate::analysis::modes::exact::{is_certain, scale};
use crate::analysis::modes::pair::{Displacements, Eigenvalue, Pair};
use crate::analysis::modes::request::{Request, Which};
use crate::kernel::big_float::Float;
use crate::kernel::sparse::wide::WideFactors;
use crate::kernel::triple::Triple;
use crate::system::Form;
use std::cmp::Ordering;

/// More of the lowest modes than this would take too long.
const MOST_MODES: usize = 60;
/// The bits of the numbers, and those that are tried where the bounds of the errors show that these are not enough.
const BITS: [u64; 3] = [256, 448, 640];
/// Enclosures have relative widths between these powers of two, as the tolerance asks.
const NARROW: [i64; 2] = [-100, -60];
/// The steps in which the range of the eigenvalues is gone through, as powers of two.
const STRIDE: usize = 24;
/// Steps of an inverse iteration before its shift is moved to the quotient, and how often that is done.
const STEPS: usize = 3;
const SHIFTS: usize = 4;
/// How far from a quotient its shift is, as a power of two.
const ASIDE: i64 = -40;
/// Between 1 and 2, and not near a number that models have: at an eigenvalue of a part of the coordinates a pivot is zero.
const UNUSUAL: f64 = 1.093_147_180_559_945_3;
/// Bits of a shift between two others.
const MIDDLE: u64 = 160;

/// The requested modes by counts where one of them is not certain to the tolerance; as they are if they are too many, or this fails.
pub fn sharpen(pairs: Vec<Pair>, k: &Form, m: &Form, n: usize, request: &Request) -> Vec<Pair> {
    let limit = request.which.limit().min(pairs.len());
    let Some(last) = pairs[..limit].iter().rposition(|pair| !is_certain(pair, request.tolerance)) else { return pairs };
    let zeros: Vec<&Pair> = pairs.iter().filter(|pair| matches!(pair.value, Eigenvalue::Zero)).collect();
    let mut left = MOST_PRODUCTS_IN_ALL;
    let found = BITS.iter().find_map(|&bits| {
        let mut counts = Counts::of(k, m, n, (bits, left))?;
        let wanted = match request.which {
            Which::Within(band) => counts.point(Float::from(band.to * band.to * (1.0 + 1e-9)))?.below,
            _ => last + 1,
        };
        if wanted > MOST_MODES || wanted > pairs.len() {
            return None;
        }
        let narrow = Float::from(request.tolerance).ceiling_log2().map_or(NARROW[0], |power| power - 5);
        let found = counts.modes(wanted, &zeros, narrow.clamp(NARROW[0], NARROW[1]));
        left = counts.left;
        found
    });
    match found {
        Some(found) if request.which == Which::All => {
            let known = found.len();
            found.into_iter().chain(pairs.into_iter().skip(known)).collect()
        }
        Some(found) => found,
        None => pairs,
    }
}

/// Eigenvalues that lie between two points, with the vector of one.
struct Span {
    from: Point,
    to: Point,
    vector: Option<Vec<Float>>,
}

impl Counts {
    /// The lowest modes, and one more if it belongs to the last one's group; `None` if the effort is not enough.
    fn modes(&mut self, wanted: usize, zeros: &[&Pair], narrow: i64) -> Option<Vec<Pair>> {
        let mut open = self.spans(zeros.len())?;
        let mut pairs: Vec<Pair> = Vec::new();
        while let Some(span) = open.pop().filter(|_| pairs.len() < wanted) {
            if span.from.below == span.to.below {
                continue;
            }
            if span.from.below != pairs.len() {
                return None;
            }
            if span.from.shift.is_negative() && !span.to.shift.is_negative() {
                pairs.extend(zeros.iter().map(|&pair| pair.clone()));
            } else if span.is_narrow(narrow) {
                let most = wanted + 1 - pairs.len();
                self.report(span, most, &mut pairs)?;
            } else {
                self.divide(span, narrow, &mut open)?;
            }
        }
        (pairs.len() >= wanted).then_some(pairs)
    }

    /// Shifts that double in size many times over on both sides of zero, until only the given number of eigenvalues is left about it;
    /// as spans between them, the lowest one last.
    fn spans(&mut self, zeros: usize) -> Option<Vec<Span>> {
        let [k, m] = &self.matrices;
        let (is_positive, log) =
            (k.positive && m.positive, |x: usize| i64::from(x.next_power_of_two().trailing_zeros()));
        let largest = k.size + log(k.terms) + log(self.n) - self.least_mass + 1;
        let (mut low, mut high) = (Vec::new(), Vec::new());
        for power in (i64::MIN / 4..=largest).rev().step_by(STRIDE) {
            let shift = Float::from(UNUSUAL).times_power_of_two(power);
            let mirrored = match is_positive {
                true => Point { shift: -&shift, below: 0 },
                false => self.point(-&shift)?,
            };
            let point = self.point(shift)?;
            let is_last = point.below == mirrored.below + zeros;
            low.push(mirrored);
            high.push(point);
            if is_last {
                break;
            }
        }
        low.extend(high.into_iter().rev());
        let spans = low.windows(2).map(|ends| Span { from: ends[0].clone(), to: ends[1].clone(), vector: None });
        Some(spans.rev().collect())
    }

    /// Divides a span about one of its eigenvalues, or in the middle.
    fn divide(&mut self, span: Span, narrow: i64, open: &mut Vec<Span>) -> Option<()> {
        let middle = Some(span.middle()).filter(|middle| span.holds(middle))?;
        let factors = self.at(&middle)?;
        let point = Point { shift: middle, below: factors.negative_pivots() };
        let Span { from, to, .. } = &span;
        let part = |from: &Point, to: &Point, vector| Span { from: from.clone(), to: to.clone(), vector };
        match self.near(&point.shift, factors, &span, narrow) {
            Some(near) => {
                let below = part(from, &near.from, None);
                open.extend([part(&near.to, to, None), near, below]);
            }
            None => open.extend([part(&point, to, None), part(from, &point, None)]),
        }
        Some(())
    }

    /// Points on both sides of an eigenvalue inside the span, which inverse iteration finds from its middle.
    fn near(&mut self, middle: &Float, mut factors: WideFactors, span: &Span, narrow: i64) -> Option<Span> {
        let (mut shift, mut x, mut last) = (middle.clone(), self.start_vector(0), span.to.shift.clone());
        for _ in 0..SHIFTS {
            let mut quotient = last.clone();
            for _ in 0..STEPS {
                let force = self.momentum(&x);
                let y = factors.solve(&force);
                let rise = self.product(&y, &force).divided_by(&self.product(&y, &self.momentum(&y)), self.bits);
                quotient = (&shift + &rise).cut(self.bits);
                x = of_ordinary_size(y)?;
            }
            if !span.holds(&quotient) {
                return None;
            }
            let change = (&quotient - &last).abs();
            last = quotient;
            if (&change - &last.abs().times_power_of_two(narrow - 4)).is_negative() {
                let width = last.abs().times_power_of_two(narrow);
                let [from, to] = [&last - &width, &last + &width];
                if !(span.holds(&from) && span.holds(&to)) {
                    return None;
                }
                let (from, to) = (self.point(from)?, self.point(to)?);
                return (from.below < to.below).then_some(Span { from, to, vector: Some(x) });
            }
            // At the eigenvalue itself a pivot may be next to zero, and all products large.
            shift = (&last + &last.abs().times_power_of_two(ASIDE)).cut(self.bits);
            factors = self.at(&shift)?;
        }
        None
    }

    /// Adds the modes of a narrow span.
    fn report(&mut self, span: Span, most: usize, pairs: &mut Vec<Pair>) -> Option<()> {
        let Span { from, to, vector } = span;
        let half = |x: Float| x.times_power_of_two(-1);
        let mid = half(&from.shift + &to.shift);
        let uncertainty =
            self.matrices.iter().map(|matrix| matrix.uncertainty).sum::<f64>() / (1.0 - self.matrices[1].uncertainty);
        let relative = &Float::from(1.0).times_power_of_two(COUNT + 2) + &Float::from(uncertainty * (1.0 + 1e-9));
        let radius = &half(&to.shift - &from.shift) + &(&mid.abs() * &relative);
        let ball = mid.to_ball(radius.to_f64_above());
        let value = Eigenvalue::Near { value: Triple::from(ball.mid), radius: ball.rad, positive: ball.is_positive() };
        let count = (to.below - from.below).min(most);
        let vectors = match vector {
            Some(vector) if count == 1 => vec![vector],
            _ => self.vectors(&from.shift, count)?,
        };
        for vector in vectors {
            let norm = self.product(&vector, &self.momentum(&vector));
            pairs.push(Pair { value, x: Displacements::Precise(scale(&vector, &norm)), route: Route::Counted });
        }
        Some(())
    }

    /// Vectors of the eigenvalues next to a shift, orthogonal in M.
    fn vectors(&mut self, shift: &Float, count: usize) -> Option<Vec<Vec<Float>>> {
        let factors = self.at(shift)?;
        let mut found: Vec<Vec<Float>> = Vec::with_capacity(count);
        for index in 0..count {
            let mut x = self.start_vector(index);
            for _ in 0..STEPS {
                x = of_ordinary_size(factors.solve(&self.momentum(&x)))?;
                for other in &found {
                    let image = self.momentum(other);
                    let part = self.product(&x, &image).divided_by(&self.product(other, &image), self.bits);
                    x = x.iter().zip(other).map(|(x, other)| (x - &(&part * other)).cut(self.bits)).collect();
                }
            }
            found.push(of_ordinary_size(x)?);
        }
        Some(found)
    }
}

impl Span {
    fn holds(&self, x: &Float) -> bool {
        (x - &self.from.shift).sign() == Ordering::Greater && (&self.to.shift - x).sign() == Ordering::Greater
    }

    /// Both ends have the same sign.
    fn is_narrow(&self, narrow: i64) -> bool {
        let width = &self.to.shift - &self.from.shift;
        (&width - &self.from.shift.abs().times_power_of_two(narrow + 2)).is_negative()
    }

    /// A shift inside, in the middle of the powers of two if the ends differ much.
    fn middle(&self) -> Float {
        let powers = [&self.from, &self.to].map(|point| point.shift.ceiling_log2().unwrap_or(0));
        let (low, high) = (powers[0].min(powers[1]), powers[0].max(powers[1]));
        if high - low > 2 {
            let size = Float::from(UNUSUAL).times_power_of_two((low + high).div_euclid(2) - 1);
            return if self.from.shift.is_negative() { -&size } else { size };
        }
        let part = &(&self.to.shift - &self.from.shift) * &Float::from(UNUSUAL / 2.0);
        (&self.from.shift + &part).cut(MIDDLE)
    }
}

/// The vector times the power of two that brings its largest entry below 1; `None` for zero.
fn of_ordinary_size(x: Vec<Float>) -> Option<Vec<Float>> {
    let largest = x.iter().filter_map(Float::ceiling_log2).max()?;
    Some(x.into_iter().map(|x| x.times_power_of_two(-largest)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::test_systems::{blank, push};
    use crate::base::{Ball, Name, Number, Words};
    use crate::system::{CoordinateId, Label, LinearSystem, Nature};

    fn span(from: f64, to: f64) -> Span {
        let point = |x: f64| Point { shift: Float::from(x), below: 0 };
        Span { from: point(from), to: point(to), vector: None }
    }

    #[test]
    fn the_middle_of_a_span_is_inside() {
        for ratio in [1.0 + 1e-15, 1.5, 2.0, 3.9, 4.1, 7.9, 8.1, 15.0, 1e9] {
            for from in [1.0, 1.05, 1.99, 1e-9, 3.703_726_712_529_677e-21] {
                for span in [span(from, from * ratio), span(-from * ratio, -from)] {
                    assert!(span.holds(&span.middle()), "{from} {ratio}: {}", span.middle().to_f64());
                }
            }
        }
        assert!(!span(1.0, 1.001).is_narrow(-60) && span(1.0, 1.0 + f64::EPSILON).is_narrow(-60 + 8));
    }

    /// Counts with few bits err by no more than their bound: beside those of 400 bits, at shifts near eigenvalues, where a rounding
    /// decides.
    #[test]
    fn few_bits_miscount_within_their_bound_alone() {
        let n = 12;
        let mut system = blank(n);
        for i in 0..n {
            push(&mut system.m, "1.3", i, None);
            push(&mut system.k, ["1", "1e7", "3e-4"][i % 3], i, (i > 0).then(|| i - 1));
            push(&mut system.k, "2", i, (i > 3).then(|| i - 3));
        }
        let counts = |bits| Counts::of(&system.k, &system.m, n, (bits, 1 << 40)).expect("rational");
        let (mut few, mut many) = (counts(60), counts(400));
        let pairs = many.modes(6, &[], -90).expect("regular");
        let mut wrong = 0;
        for pair in &pairs {
            let Eigenvalue::Near { value, .. } = pair.value else { panic!("no motion is rigid") };
            for step in -40..40 {
                let shift = &Float::from(value.hi()) + &Float::from(f64::from(step) * 1e-14);
                let (factors, error) = few.factors_with_error(&shift).expect("no pivot is zero");
                let bound = Float::from(1.0).times_power_of_two(error);
                let [low, high] = [&shift - &bound, &shift + &bound].map(|s| many.point(s).expect("many bits").below);
                let found = factors.negative_pivots();
                assert!(low <= found && found <= high, "{low} {found} {high}");
                assert!(few.at(&shift).is_none(), "a count by 60 bits is not certain enough");
                wrong += usize::from(many.point(shift).expect("many bits").below != found);
            }
        }
        assert!(wrong > 0, "nothing was rounded");
    }

    /// The same of masses of 1e-12 kg, by which an error of a pivot moves an eigenvalue 1e12 times as far, and of a pivot that all but
    /// cancels, by which products grow.
    #[test]
    fn small_masses_and_pivots_are_in_the_error_of_a_count() {
        let mut light = blank(1);
        push(&mut light.m, "1e-12", 0, None);
        push(&mut light.k, "1", 0, None);
        let error = |system: &LinearSystem, bits| {
            let mut counts = Counts::of(&system.k, &system.m, system.n(), (bits, 1 << 40)).expect("rational");
            counts.factors_with_error(&Float::from(0.5)).expect("regular").1
        };
        assert!(error(&light, 256) >= 39 - 256, "{}", error(&light, 256));
        // [e -1; -1 1] with e next to zero: the second pivot is 1 - 1 / e.
        let mut cancelling = blank(2);
        for i in 0..2 {
            push(&mut cancelling.m, "1", i, None);
        }
        push(&mut cancelling.k, "1", 0, Some(1));
        weigh(&mut cancelling.k, Number::from(-1), 0);
        weigh(&mut cancelling.k, Number::from("0.5000000000000000000000000000001"), 0);
        assert!(error(&cancelling, 256) >= 100 - 256, "{}", error(&cancelling, 256));
    }

    /// No counts where M is not positive or not known to be, where a row is not rational, or where uncertain weights have both signs.
    #[test]
    fn what_no_count_can_prove_is_refused() {
        let made = |mass: Number, weight: Number, bits| {
            let mut system = blank(2);
            push(&mut system.m, "1", 0, None);
            push(&mut system.m, "1", 1, None);
            weigh(&mut system.m, mass, 1);
            push(&mut system.k, "3", 1, Some(0));
            weigh(&mut system.k, weight, 0);
            Counts::of(&system.k, &system.m, 2, (bits, 1 << 40)).is_some()
        };
        let root = Number::from("2.1").sqrt().expect("positive");
        assert!(made(Number::ONE, Number::ONE, 256) && made(Number::ONE, root.clone(), 256));
        assert!(!made(Number::from(-2), Number::ONE, 256), "M has a negative eigenvalue");
        assert!(!made(Number::ONE, Number::ONE, 8), "with 8 bits M may have one");
        assert!(!made(Number::ONE, -&root, 256), "an uncertain weight may be any part of the difference");
        let mut system = blank(1);
        push(&mut system.m, "1", 0, None);
        let source = system.k.source(Label { name: Name::plain(Words::new().intern("")), motion: "" });
        system.k.push(source, Nature::Property, Number::ONE, [(CoordinateId(0), root)]);
        assert!(Counts::of(&system.k, &system.m, 1, (256, 1 << 40)).is_none(), "a row is uncertain");
    }

    /// Adds weight x_i^2.
    fn weigh(form: &mut Form, weight: Number, i: u32) {
        let source = form.source(Label { name: Name::plain(Words::new().intern("")), motion: "" });
        form.push(source, Nature::Property, weight, [(CoordinateId(i), Number::ONE)]);
    }

    /// One mass of 1 kg on 2 N/m to 1 in 1000, whose enclosure by counts of 2 N/m alone is narrow.
    #[test]
    fn uncertainty_of_a_weight_is_in_the_enclosure() {
        let mut system = blank(1);
        push(&mut system.m, "1", 0, None);
        weigh(&mut system.k, Number::Ball(Ball::from(2.0).widen(2e-3)), 0);
        let mut counts = Counts::of(&system.k, &system.m, 1, (256, 1 << 40)).expect("known to 1e-3");
        let pairs = counts.modes(1, &[], -60).expect("a mode");
        let Eigenvalue::Near { value, radius, .. } = pairs[0].value else { panic!("no motion is rigid") };
        let off = (value.hi() - 2.0).abs();
        assert!(off + 2e-3 <= radius && radius < 3e-3, "{radius:e}");
    }

    /// One mass of 1 kg on 2 N/m, known to lie between 1.5 and 3 1/s^2 and no more.
    #[test]
    fn an_enclosure_reaches_from_count_to_count() {
        let mut system = blank(1);
        push(&mut system.m, "1", 0, None);
        push(&mut system.k, "2", 0, None);
        let mut counts = Counts::of(&system.k, &system.m, 1, (256, 1 << 40)).expect("rational");
        let [from, to] = [1.5, 3.0].map(|shift| counts.point(Float::from(shift)).expect("regular"));
        let mut pairs = Vec::new();
        counts.report(Span { from, to, vector: None }, 1, &mut pairs).expect("a mode");
        let Eigenvalue::Near { value, radius, .. } = pairs[0].value else { panic!("no motion is rigid") };
        assert!(value.hi() - radius <= 1.5 && value.hi() + radius >= 3.0, "{} {radius}", value.hi());
    }
}
