//! The buckling load factor: by how much gravity, tensions and reactions can grow before some motion loses its
//! stiffness.
//!
//! K = K_p + K_g: the stiffness that the model gives, and the geometric stiffness due to its loads. In: a linear
//! system. Out: the least alpha > 0 for which K_p + alpha K_g is singular; it is below 1 if the system has buckled
//! already.
//!
//! - K_p positive definite: -K_g x = mu K_p x, alpha = 1 / mu for the largest mu.
//! - Otherwise, if K is positive definite: K_g x = rho K x, alpha = 1 - 1 / rho for the least rho, which must be
//!   negative.
//!
//! Both are eigenproblems like that of the modes, with its bounds. See docs/method/modes.md#buckling.

use crate::analysis::modes::MAX_UNASKED;
use crate::analysis::modes::eigen::{Failure, eigenpairs};
use crate::analysis::modes::pair::{Eigenvalue, Pair};
use crate::analysis::modes::parts::{Part, choose_terms, independent_undamped};
use crate::analysis::{modes::certificate, modes::shape};
use crate::base::{Ball, Dd, Unproven};
use crate::system::{Form, LinearSystem, Nature, Term};

/// Relative accuracy that a load factor should have.
const TOLERANCE: f64 = 1e-12;

/// The load factor to buckling, and the motion that buckles.
#[derive(Clone, Debug)]
pub struct Buckling {
    pub load_factor: Ball,
    /// Displacement of each coordinate in the motion that loses its stiffness, its largest 1.
    pub shape: Vec<Unproven>,
}

/// The least load factor over all parts. `None` if no load softens anything, if the factor is not defined (some motion
/// has no stiffness at all), or if that of some part could not be certified: it might be less than all others.
pub fn buckling(system: &LinearSystem) -> Option<Buckling> {
    least_of_parts(system).ok().flatten()
}

/// The least load factor, where all parts of the system are settled; `None` if no part buckles.
pub fn least_load_factor(system: &LinearSystem) -> Result<Option<Ball>, &'static str> {
    Ok(least_of_parts(system)?.map(|found| found.load_factor))
}

fn least_of_parts(system: &LinearSystem) -> Result<Option<Buckling>, &'static str> {
    let softened = |term: &Term| term.nature == Nature::Geometric && term.weight.is_negative();
    if system.is_chained() {
        return Err("the links of this scene hang too deep for it");
    }
    if !system.k.terms().any(|term| softened(&term)) {
        return Ok(None);
    }
    let mut local = vec![0u32; system.n()];
    let mut least: Option<Buckling> = None;
    for part in independent_undamped(system) {
        part.coordinates.iter().enumerate().for_each(|(i, &c)| local[c as usize] = i as u32);
        let k = choose_terms(&system.k, &part.k, &local);
        if !k.terms().any(|term| softened(&term)) {
            continue;
        }
        if part.coordinates.len() > MAX_UNASKED {
            return Err("the scene is too large for it");
        }
        let Some(found) = of_part(system, &part, &k)? else { continue };
        least = Some(match least {
            Some(other) if begins_lower(other.load_factor, found.load_factor) => other,
            _ => found,
        });
    }
    Ok(least)
}

/// Whether the first ball begins at the lower number: it then holds the lesser of any two numbers in them.
fn begins_lower(a: Ball, b: Ball) -> bool {
    a.mid - Dd::from(a.rad) <= b.mid - Dd::from(b.rad)
}

/// `None` if the part does not buckle; an error where neither is proved.
fn of_part(system: &LinearSystem, part: &Part, k: &Form) -> Result<Option<Buckling>, &'static str> {
    const UNPROVED: &str = "it could not be proved how far the loads can grow";
    const UNDEFINED: &str = "neither the springs alone nor springs and loads together are shown to hold every motion: no load factor is computed";
    let n = part.coordinates.len();
    let given = chosen_terms(k, |term| (term.nature == Nature::Property).then_some(false));
    let softening = chosen_terms(k, |term| (term.nature == Nature::Geometric).then_some(true));
    let (load_factor, pair) = match eigenpairs(&softening, &given, n, TOLERANCE) {
        Ok(pairs) => {
            let Some(pair) = pairs.into_iter().next_back() else { return Err(UNPROVED) };
            let Some(factor) = sign_of(&pair).ok_or(UNPROVED)? else { return Ok(None) };
            (Ball::ONE / factor, pair)
        }
        Err(Failure::Range | Failure::Size) => return Err(UNPROVED),
        Err(Failure::Mass(_)) => {
            // -rho, descending: the pencil with -K_g again.
            let pairs = eigenpairs(&softening, k, n, TOLERANCE).map_err(|failure| match failure {
                Failure::Mass(_) => UNDEFINED,
                Failure::Range | Failure::Size => UNPROVED,
            })?;
            let Some(pair) = pairs.into_iter().next_back() else { return Err(UNPROVED) };
            let Some(factor) = sign_of(&pair).ok_or(UNPROVED)? else { return Ok(None) };
            (Ball::ONE + Ball::ONE / factor, pair)
        }
    };
    let whole = pair.x.spread(&part.coordinates, system.n()).to_f64();
    Ok(Some(Buckling { load_factor, shape: shape::with_largest_one(&whole) }))
}

/// The eigenvalue if it is certainly positive, nothing if it certainly is not; `None` where that is not known.
fn sign_of(pair: &Pair) -> Option<Option<Ball>> {
    let Eigenvalue::Near { value, radius, .. } = pair.value else { return Some(None) };
    let ball = certificate::ball(value, radius);
    match () {
        () if ball.is_positive() => Some(Some(ball)),
        () if ball.is_negative() => Some(None),
        () => None,
    }
}

/// The terms for which `choose` returns a value, negated if that value is `true`.
fn chosen_terms(form: &Form, choose: impl Fn(&Term) -> Option<bool>) -> Form {
    let mut result = Form::new();
    for term in form.terms() {
        let Some(negated) = choose(&term) else { continue };
        let source = result.source(form.source_of(term.source));
        let weight = if negated { -term.weight } else { term.weight.clone() };
        result.push(source, term.nature, weight, form.row(term).copies());
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::test_systems::{blank, push};
    use crate::base::Number;
    use crate::system::CoordinateId;

    /// Two rods joined by a spring: the stiffnesses that the model gives, and those due to gravity, N m/rad.
    fn rods(given: [&Number; 2], gravity: [&Number; 2], joined: &str) -> LinearSystem {
        let mut system = blank(2);
        let label = system.coordinates[0].name;
        let source = system.k.source(label);
        for i in 0..2 {
            push(&mut system.m, "1", i, None);
            let at = || [(CoordinateId(i as u32), Number::ONE)];
            system.k.push(source, Nature::Property, given[i].clone(), at());
            system.k.push(source, Nature::Geometric, gravity[i].clone(), at());
        }
        push(&mut system.k, joined, 0, Some(1));
        system
    }

    /// (a + 0.1 + alpha p)(b + 0.1 + alpha q) = 0.01 has two roots.
    fn roots(a: f64, b: f64, p: f64, q: f64) -> [f64; 2] {
        let (a, b) = (a + 0.1, b + 0.1);
        let (square, middle, rest) = (p * q, a * q + b * p, a * b - 0.01);
        let root = (middle * middle - 4.0 * square * rest).sqrt();
        let mut roots = [(-middle - root) / (2.0 * square), (-middle + root) / (2.0 * square)];
        roots.sort_by(f64::total_cmp);
        roots
    }

    fn check(system: &LinearSystem, truth: f64) {
        let found = buckling(system).expect("a load factor").load_factor;
        assert!((found.mid.hi - truth).abs() <= 1e-14 * truth + found.rad, "{} {truth}", found.mid.hi);
        assert!(found.rad < 1e-12 * truth);
    }

    #[test]
    fn a_rod_on_its_tip_buckles_at_the_limit_of_its_spring() {
        let [five, two, down, up] = ["5", "2", "9.81", "0.4905"].map(Number::from);
        check(&rods([&five, &two], [&-&down, &-&up], "0.1"), roots(5.0, 2.0, -9.81, -0.4905)[0]);
    }

    /// A rod that hangs in spite of a negative spring: it would not stand without its weight, and at 4.28 times the
    /// weight the other rod falls.
    #[test]
    fn a_rod_held_by_its_loads_buckles_under_more() {
        let [one, two, hangs, stands] = ["1", "2", "9.81", "0.4905"].map(Number::from);
        let system = rods([&-&one, &two], [&hangs, &-&stands], "0.1");
        let roots = roots(-1.0, 2.0, 9.81, -0.4905);
        assert!(roots[0] < 1.0 && (roots[1] - 4.280_849).abs() < 1e-6);
        check(&system, roots[1]);
    }

    /// Neither rod stands, with or without its loads: there is no factor.
    #[test]
    fn a_buckled_system_has_no_factor() {
        let [one, two, stands] = ["1", "2", "0.4905"].map(Number::from);
        assert!(buckling(&rods([&-&one, &-&two], [&-&stands, &-&stands], "0.1")).is_none());
    }

    /// Rods side by side: the one that buckles first decides.
    #[test]
    fn of_several_parts_the_weakest_buckles() {
        let mut system = blank(2);
        let source = system.k.source(system.coordinates[0].name);
        for (i, spring) in ["2", "5"].into_iter().enumerate() {
            push(&mut system.m, "1", i, None);
            let at = || [(CoordinateId(i as u32), Number::ONE)];
            system.k.push(source, Nature::Property, Number::from(spring), at());
            system.k.push(source, Nature::Geometric, -&Number::from("9.81"), at());
        }
        check(&system, 2.0 / 9.81);
    }

    /// An eigenvalue of 2 +- 0.5 may be 2.5, and one of 0.25 +- 0.5 has no sign.
    #[test]
    fn uncertainty_of_an_eigenvalue_is_in_the_factor() {
        use crate::analysis::answer::Route;
        use crate::analysis::modes::pair::Displacements;
        let of = |value: f64| {
            let value = Eigenvalue::Near { value: value.into(), radius: 0.5, positive: false };
            sign_of(&Pair { value, x: Displacements::Plain(Vec::new()), route: Route::Exact })
        };
        assert!(of(0.25).is_none() && of(-0.25).is_none() && of(-2.0).is_some_and(|found| found.is_none()));
        let found = of(2.0).flatten().expect("positive");
        assert!(found.mid.hi + found.rad >= 2.5, "{found:?}");
    }

    /// The lesser of two numbers whose balls meet may be either: the ball that begins lower holds the lesser of all of them.
    #[test]
    fn the_lesser_of_two_uncertain_numbers_is_in_its_enclosure() {
        let ball = |x: f64, radius: f64| Ball::from(x).widen(radius);
        for (a, b) in
            [((2.0, 0.5), (5.0, 0.5)), ((2.0, 0.5), (2.25, 0.125)), ((-1.0, 2.0), (3.0, 1.5)), ((2.0, 0.0), (2.0, 0.0))]
        {
            for (a, b) in [(a, b), (b, a)] {
                let (first, second) = (ball(a.0, a.1), ball(b.0, b.1));
                let found = if begins_lower(first, second) { first } else { second };
                for (x, y) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0), (0.0, 0.5)] {
                    let least = (a.0 + x * a.1).min(b.0 + y * b.1);
                    assert!((found - Ball::from(least)).contains_zero(), "{a:?} {b:?} {least}: {found:?}");
                }
            }
        }
    }

    /// A part that may buckle first, but whose factor is not defined, leaves no least one.
    #[test]
    fn a_part_that_is_not_settled_leaves_no_factor() {
        let mut system = blank(2);
        let source = system.k.source(system.coordinates[0].name);
        for (i, spring) in ["2", "-5"].into_iter().enumerate() {
            push(&mut system.m, "1", i, None);
            let at = || [(CoordinateId(i as u32), Number::ONE)];
            let spring = match spring.strip_prefix('-') {
                Some(size) => -&Number::from(size),
                None => Number::from(spring),
            };
            system.k.push(source, Nature::Property, spring, at());
            system.k.push(source, Nature::Geometric, -&Number::from("0.5"), at());
        }
        assert!(buckling(&system).is_none() && least_load_factor(&system).is_err());
    }
}
