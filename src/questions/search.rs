//! The search for one unknown: the parameter values in a range at which a measure reaches its target. In: a function
//! that evaluates the measure, and the range. Out: every root that was found, each between two numbers at which the
//! enclosures of the measure lie on different sides; and the course of the measure elsewhere. See
//! docs/method/measures.md.

use crate::base::{Ball, Dd, Number, OrderBy, Rational, two_to};
use std::cmp::Ordering;

/// The measure minus its target, at one value.
#[derive(Clone, Debug, PartialEq)]
pub enum Difference {
    Known(Ball),
    /// Beyond all bounds: a resonance without damping.
    Infinite,
    /// Why the measure has no value.
    None(String),
}

/// One evaluation of the measure.
#[derive(Clone, Debug)]
pub struct Evaluation {
    pub at: Number,
    pub x: f64,
    pub difference: Difference,
}

/// A root between two evaluations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Root {
    pub near: Dd,
    /// Bound of the distance to the root.
    pub within: f64,
    /// `None` if the measure comes as near to its target as can be resolved, but was not found on the other side.
    pub proof: Option<Crossing>,
}

/// Proof of a root: the measure was enclosed on different sides at `near` - `within` and `near` + `within`, or is exactly
/// at its target at `near`, or a contraction encloses the root.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing(());

impl Crossing {
    /// The measure is exactly at its target there.
    pub(super) fn exact() -> Crossing {
        Crossing(())
    }
}

impl Root {
    /// A root that Krawczyk's operator encloses.
    pub(super) fn enclosed_root(near: Dd, within: f64) -> Root {
        Root { near, within, proof: Some(Crossing(())) }
    }

    /// A root that was found without a proof.
    pub fn seen_root(near: Dd, within: f64) -> Root {
        Root { near, within, proof: None }
    }
}

/// The result of a search.
#[derive(Clone, Debug, Default)]
pub struct SearchResult {
    pub roots: Vec<Root>,
    /// Places where the measure turns, as far as they were followed: it may just touch its target there.
    pub turns: Vec<Root>,
    /// The first evaluations, ascending.
    pub evaluations: Vec<Evaluation>,
    /// Places where the measure jumps over its target.
    pub jumps: Vec<f64>,
    /// Number of evaluations in total.
    pub count: usize,
}

/// Number of parts of the range that are evaluated first; as many again in geometric progression if it spans decades.
const PARTS: usize = 64;
/// If the ratio of the range's ends exceeds this, the measure is also evaluated at logarithmically spaced numbers.
const DECADES: f64 = 20.0;
/// Limit on the evaluations to follow a turning point.
const TURNING: usize = 60;
/// Limit on the evaluations to narrow a change of sign.
const NARROWING: usize = 240;
/// A measure jumps if its change between two numbers is more than this share of its change over an interval so many times as wide.
const SHARE_OF_A_JUMP: f64 = 0.7;
const WIDER: f64 = 16.0;

/// Narrows an interval at whose ends the measure is on different sides, for a measure known to cross its target once.
pub fn narrow(low: &Number, high: &Number, measure: &dyn Fn(&Number) -> Difference) -> SearchResult {
    let mut search = Search::new(low, high, measure);
    let evaluations = vec![search.evaluate(low.clone()), search.evaluate(high.clone())];
    let mut seen = SearchResult::default();
    search.interpolate(&evaluations[0], &evaluations[1], &mut seen);
    for evaluation in evaluations.iter().filter(|evaluation| sign(&evaluation.difference) == Some(Ordering::Equal)) {
        search.certify(evaluation, &mut seen);
    }
    (seen.evaluations, seen.count) = (evaluations, search.count);
    seen
}

/// Evaluates the measure over a range and narrows every root.
pub fn search(low: &Number, high: &Number, measure: &dyn Fn(&Number) -> Difference) -> SearchResult {
    let mut search = Search::new(low, high, measure);
    let evaluations: Vec<Evaluation> = grid(low, high).into_iter().map(|at| search.evaluate(at)).collect();
    let mut seen = SearchResult::default();
    for pair in evaluations.windows(2) {
        search.interpolate(&pair[0], &pair[1], &mut seen);
    }
    for evaluation in evaluations.iter().filter(|evaluation| sign(&evaluation.difference) == Some(Ordering::Equal)) {
        search.certify(evaluation, &mut seen);
    }
    for three in evaluations.windows(3) {
        search.turn([&three[0], &three[1], &three[2]], &mut seen);
    }
    seen.roots.order_by(|a, b| a.near.hi.total_cmp(&b.near.hi));
    (seen.evaluations, seen.count) = (evaluations, search.count);
    seen
}

struct Search<'a> {
    measure: &'a dyn Fn(&Number) -> Difference,
    count: usize,
    /// The size of a root at zero.
    zero: f64,
}

/// The size beside which a root near zero is known, for a range: 2^-40 of its width.
pub fn size_of_zero(low: &Number, high: &Number) -> f64 {
    (high - low).to_f64().abs() * two_to(-40)
}

impl SearchResult {
    /// Adds a root; one that was found from two sides counts once.
    pub fn add(&mut self, root: Root) {
        let same = |known: &Root| {
            let distance = (known.near - root.near).abs().to_f64();
            distance <= 4.0 * (known.within + root.within) + 1e-12 * root.near.hi.abs()
        };
        if !self.roots.iter().any(same) {
            self.roots.push(root);
        }
    }
}

impl<'a> Search<'a> {
    fn new(low: &Number, high: &Number, measure: &'a dyn Fn(&Number) -> Difference) -> Search<'a> {
        Search { measure, count: 0, zero: size_of_zero(low, high) }
    }

    fn evaluate(&mut self, at: Number) -> Evaluation {
        self.count += 1;
        let difference = (self.measure)(&at);
        Evaluation { x: at.to_f64(), at, difference }
    }

    fn evaluate_at(&mut self, x: Dd) -> Evaluation {
        self.evaluate(to_fraction(x))
    }

    /// Narrows the root between two evaluations on different sides.
    fn interpolate(&mut self, a: &Evaluation, b: &Evaluation, seen: &mut SearchResult) {
        let (Some(left), Some(right)) = (sign(&a.difference), sign(&b.difference)) else { return };
        if left == right || left == Ordering::Equal || right == Ordering::Equal {
            return;
        }
        let first = jump_size(a, b);
        let (mut a, mut b) = (a.clone(), b.clone());
        for step in 0..NARROWING {
            let Some(x) = middle(&a, &b, step) else { break };
            let c = self.evaluate_at(x);
            match sign(&c.difference) {
                // Near a pole an enclosure is so wide that it contains zero too.
                Some(Ordering::Equal) if uncertainty(&c) > first => return seen.jumps.push(c.x),
                // The measure cannot be distinguished from its target: this is as near as it can resolve.
                Some(Ordering::Equal) => {
                    a = c.clone();
                    b = c;
                    break;
                }
                Some(side) if side == left => a = c,
                Some(_) => b = c,
                // A gap in the measure: nothing is known about roots in it.
                None => return,
            }
        }
        let over = jump_size(&a, &b);
        if over > 1e-3 * first || over.is_infinite() {
            seen.jumps.push(a.x);
            return;
        }
        let near = if size(&a) <= size(&b) { a } else { b };
        self.certify(&near, seen);
    }

    /// Adds the narrowest pair of numbers around this one, on different sides, that the enclosures allow: a root, or a jump.
    fn certify(&mut self, near: &Evaluation, seen: &mut SearchResult) {
        let x = near.at.to_ball().mid;
        let size = x.hi.abs().max(self.zero);
        let mut within = (size * two_to(-100)).max(f64::MIN_POSITIVE * two_to(60));
        for _ in 0..30 {
            let [left, right] = self.sides(x, within);
            let (a, b) = (sign(&left.difference), sign(&right.difference));
            if let (Some(a), Some(b)) = (a, b)
                && a != Ordering::Equal
                && b == a.reverse()
            {
                // A continuous measure changes by a sixteenth of it, or by four tenths where it is a cube root.
                let [far_left, far_right] = self.sides(x, within * WIDER);
                if jump_size(&left, &right) > SHARE_OF_A_JUMP * jump_size(&far_left, &far_right) {
                    return seen.jumps.push(x.hi);
                }
                return seen.add(Root { near: x, within, proof: Some(Crossing(())) });
            }
            if a.is_none() || b.is_none() || within > 1e-3 * size {
                break;
            }
            within *= 16.0;
        }
        // The measure touches its target, or cannot be distinguished from it over a whole range.
        seen.add(Root::seen_root(x, within));
    }

    /// The evaluations at so much less and more.
    fn sides(&mut self, x: Dd, within: f64) -> [Evaluation; 2] {
        [x - Dd::from(within), x + Dd::from(within)].map(|x| self.evaluate_at(x))
    }

    /// Follows |difference| down to where it turns, and checks whether it reaches the other side there.
    fn turn(&mut self, evaluations: [&Evaluation; 3], seen: &mut SearchResult) {
        let [a, b, c] = evaluations;
        let signs = evaluations.map(|evaluation| sign(&evaluation.difference));
        let Some(side) = signs[1].filter(|side| *side != Ordering::Equal) else { return };
        if signs.iter().any(|sign| *sign != Some(side)) || size(b) > size(a) || size(b) > size(c) {
            return;
        }
        let (mut low, mut best, mut high) = (a.clone(), b.clone(), c.clone());
        for _ in 0..TURNING {
            // The golden section of the larger part.
            let right = high.x - best.x > best.x - low.x;
            let end = if right { &high } else { &low };
            let (best_at, end_at) = (best.at.to_ball().mid, end.at.to_ball().mid);
            let c = self.evaluate_at(best_at + (end_at - best_at) * 0.381_966_011_250_105);
            match sign(&c.difference) {
                Some(found) if found == side => {}
                Some(Ordering::Equal) => return self.certify(&c, seen),
                Some(_) => {
                    self.interpolate(&low, &c, seen);
                    self.interpolate(&c, &high, seen);
                    return;
                }
                None => return,
            }
            let better = size(&c) < size(&best);
            match (better, right) {
                (true, true) => low = std::mem::replace(&mut best, c),
                (true, false) => high = std::mem::replace(&mut best, c),
                (false, true) => high = c,
                (false, false) => low = c,
            }
            if high.x - low.x <= 1e-9 * best.x.abs() {
                break;
            }
        }
        seen.turns.push(Root::seen_root(best.at.enclosure().mid, (high.x - best.x).max(best.x - low.x)));
    }
}

/// The side on which a difference certainly lies; equal if its ball contains zero.
pub fn sign(difference: &Difference) -> Option<Ordering> {
    match difference {
        Difference::Infinite => Some(Ordering::Greater),
        Difference::None(_) => None,
        Difference::Known(ball) if !ball.is_finite() => None,
        Difference::Known(ball) if ball.is_positive() => Some(Ordering::Greater),
        Difference::Known(ball) if ball.is_negative() => Some(Ordering::Less),
        Difference::Known(_) => Some(Ordering::Equal),
    }
}

fn value(evaluation: &Evaluation) -> f64 {
    match &evaluation.difference {
        Difference::Known(ball) => ball.to_f64(),
        Difference::Infinite => f64::INFINITY,
        Difference::None(_) => f64::NAN,
    }
}

fn size(evaluation: &Evaluation) -> f64 {
    value(evaluation).abs()
}

fn uncertainty(evaluation: &Evaluation) -> f64 {
    match &evaluation.difference {
        Difference::Known(ball) => ball.rad,
        _ => f64::INFINITY,
    }
}

fn jump_size(a: &Evaluation, b: &Evaluation) -> f64 {
    (value(b) - value(a)).abs()
}

/// The next number to evaluate between two points: by the secant, every third time in the middle, and nearer to the far
/// end if one end does not move. `None` if no number lies between them.
fn middle(a: &Evaluation, b: &Evaluation, step: usize) -> Option<Dd> {
    let (left, right) = (a.at.to_ball().mid, b.at.to_ball().mid);
    let width = right - left;
    let scale = left.hi.abs().max(right.hi.abs());
    if width.to_f64() <= scale * two_to(-98) {
        return None;
    }
    let secant = || match (&a.difference, &b.difference) {
        (Difference::Known(a), Difference::Known(b)) => {
            let part = a.mid / (a.mid - b.mid);
            // A step slightly beyond the secant's point brings the other end near too.
            let beyond = if step.is_multiple_of(3) { 1e-3 } else { 0.0 };
            let toward =
                if part.to_f64() > 0.5 { part - (Dd::ONE - part).scale(1.0) * beyond } else { part * (1.0 + beyond) };
            (part.is_finite()).then_some(toward)
        }
        _ => None,
    };
    let part = if step % 3 == 2 { Dd::from(0.5) } else { secant().unwrap_or(Dd::from(0.5)) };
    let part = if part.to_f64() > 0.0 && part.to_f64() < 1.0 { part } else { Dd::from(0.5) };
    let x = left + width * part;
    // If rounding moves the number out of the interval, the number itself is taken.
    [round(x, width.to_f64()), x].into_iter().find(|x| *x > left && *x < right)
}

/// Rounds to few digits while the bracket is wide, because exact arithmetic is then fast.
fn round(x: Dd, width: f64) -> Dd {
    let relative = width / x.hi.abs();
    if relative > 1e-4 {
        Dd::from(f64::from(x.hi as f32))
    } else if relative > 1e-12 {
        Dd::from(x.hi)
    } else {
        x
    }
}

/// The double-double as a fraction.
pub fn to_fraction(x: Dd) -> Number {
    let parts = Rational::from_f64(x.hi).zip(Rational::from_f64(x.lo));
    parts.map_or(Number::Ball(Ball::exact(x)), |(hi, lo)| Number::from(&hi + &lo))
}

/// The values that are evaluated first, ascending.
fn grid(low: &Number, high: &Number) -> Vec<Number> {
    let (a, b) = (low.to_f64(), high.to_f64());
    let mut inside: Vec<f64> = (1..PARTS).map(|i| a + (b - a) * (i as f64 / PARTS as f64)).collect();
    if a > 0.0 && b > DECADES * a || b < 0.0 && a < DECADES * b {
        // The 64th root by square roots, which are the same on every machine.
        let ratio = (0..PARTS.ilog2()).fold(b / a, |ratio, _| ratio.sqrt());
        inside.extend(std::iter::successors(Some(a * ratio), |x| Some(x * ratio)).take(PARTS - 1));
    }
    inside.iter_mut().for_each(|x| *x = f64::from(*x as f32));
    inside.retain(|x| *x > a && *x < b && x.is_finite());
    inside.sort_by(f64::total_cmp);
    inside.dedup();
    let inside = inside.into_iter().filter_map(|x| Rational::from_f64(x).map(Number::from));
    std::iter::once(low.clone()).chain(inside).chain(std::iter::once(high.clone())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn search_range(low: i64, high: i64, f: impl Fn(Ball) -> Ball) -> SearchResult {
        let measure = |x: &Number| Difference::Known(f(x.to_ball()));
        search(&Number::from(low), &Number::from(high), &measure)
    }

    #[test]
    fn a_root_is_found_to_the_last_digit() {
        let seen = search_range(0, 3, |x| x * x - Ball::from(2.0));
        let [root] = seen.roots[..] else { panic!("{:?}", seen.roots) };
        assert!((root.near - Dd::from(2.0).sqrt()).abs().to_f64() <= root.within, "{root:?}");
        assert!(root.within < 1e-28, "{root:?}");
        assert!(seen.count < 120, "{}", seen.count);
    }

    #[test]
    fn every_root_is_seen() {
        let cubic = |x: Ball| (x - Ball::ONE) * (x - Ball::from(2.0)) * (x - Ball::from(7.0));
        assert_eq!(search_range(0, 10, cubic).roots.len(), 3);
        // Both roots between two of the first looks.
        let close = |x: Ball| (x - Ball::from(1.001)) * (x - Ball::from(1.002));
        assert_eq!(search_range(0, 10, close).roots.len(), 2);
    }

    #[test]
    fn a_jump_is_no_root() {
        let seen = search_range(0, 10, |x| if x.to_f64() < 3.3 { -Ball::ONE } else { Ball::ONE });
        assert!(seen.roots.is_empty());
        assert!((seen.jumps[0] - 3.3).abs() < 1e-12);
    }

    /// A measure whose enclosure reaches over the jump, as that of a settling time does where a swing just reaches the band: where it
    /// falls otherwise by much more than it jumps.
    #[test]
    fn a_jump_that_is_not_resolved_is_no_root() {
        let seen = search_range(0, 10, |x| {
            let away = (x - Ball::from(3.3)).to_f64();
            let jump = if away.abs() < 1e-14 { Ball::new(Dd::ZERO, 2.0) } else { Ball::from(away.signum()) };
            jump + (x - Ball::from(3.3)) * Ball::from(1e9)
        });
        assert!(seen.roots.is_empty() && (seen.jumps[0] - 3.3).abs() < 1e-12, "{:?} {:?}", seen.roots, seen.jumps);
    }

    #[test]
    fn a_root_of_infinite_slope_is_a_root() {
        let cube_root = |x: Ball| {
            let away = (x - Ball::ONE).to_f64();
            Ball::new(Dd::from(away.cbrt()), 1e-15 * away.abs().cbrt())
        };
        let seen = search_range(0, 10, cube_root);
        assert!(seen.jumps.is_empty() && seen.roots.len() == 1 && (seen.roots[0].near.hi - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_pole_is_no_root() {
        let seen = search_range(0, 10, |x| Ball::ONE / (x - Ball::from(3.3)));
        assert!(seen.roots.is_empty(), "{:?}", seen.roots);
    }

    #[test]
    fn no_root_is_found_where_there_is_none() {
        assert!(search_range(0, 10, |x| x * x + Ball::ONE).roots.is_empty());
    }

    /// A measure that touches its target from one side does not cross it; a crossing lies between the two numbers
    /// reported.
    #[test]
    fn a_crossing_changes_sides() {
        let touches = search_range(0, 3, |x| (x - Ball::from(1.5)) * (x - Ball::from(1.5)));
        assert!(touches.roots.iter().all(|root| root.proof.is_none()), "{:?}", touches.roots);
        // The root of x^3 = 2 is not a double-double.
        let seen = search_range(0, 3, |x| x * x * x - Ball::from(2.0));
        let [root] = seen.roots[..] else { panic!("{:?}", seen.roots) };
        let cubic = |x: Dd| (x * x * x - Dd::from(2.0)).to_f64();
        let ends = [root.near - Dd::from(root.within), root.near + Dd::from(root.within)];
        assert!(root.proof.is_some() && cubic(ends[0]) < 0.0 && cubic(ends[1]) > 0.0, "{root:?}");
    }
}
