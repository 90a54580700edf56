//! Facts about a part that hold whatever the enclosures of its poles are: that its dampers feed no energy in, and that
//! its springs hold it. In: terms, modes. Out: whether a sum of squares is positive, by its weights or exactly. See
//! docs/method/poles.md#kinds-and-stability.

use crate::analysis::answer::{ModeKind, Modes};
use crate::analysis::modes::parts::Part;
use crate::base::{Number, Rational};
use crate::system::{Form, LinearSystem};

/// Larger sums with negative weights are not examined, because the elimination is exact.
const MOST_COORDINATES: usize = 24;

/// The energies that are certainly never negative.
#[derive(Clone, Copy, Debug)]
pub struct Passive {
    /// M and C are positive: no oscillation grows.
    pub damped: bool,
    /// No omega^2 is negative: with `damped`, no pole has a positive real part.
    pub held: bool,
}

impl Passive {
    /// The facts for a part with these modes.
    pub fn of(system: &LinearSystem, part: &Part, modes: &Modes) -> Passive {
        let held = modes.list.iter().all(|mode| matches!(mode.kind, ModeKind::Oscillation | ModeKind::Rigid));
        Passive {
            damped: is_damped(system, part),
            held: held && (modes.infinite == 0 || is_semidefinite(&system.k, &part.k)),
        }
    }

    /// The facts for a part without its modes: only its springs decide whether they hold it.
    pub fn of_springs(system: &LinearSystem, part: &Part) -> Passive {
        Passive { damped: is_damped(system, part), held: is_semidefinite(&system.k, &part.k) }
    }

    pub fn nothing_grows(self) -> bool {
        self.damped && self.held
    }
}

fn is_damped(system: &LinearSystem, part: &Part) -> bool {
    is_semidefinite(&system.m, &part.m) && is_semidefinite(&system.c, &part.c)
}

/// Whether a damping ratio certainly feeds in no energy.
pub fn takes_energy(ratio: &Number) -> bool {
    ratio.is_zero() || ratio.is_positive()
}

/// Whether x^T (sum w a a^T) x >= 0 for every x: all weights are positive, or exact elimination proves it.
pub fn is_semidefinite(form: &Form, terms: &[u32]) -> bool {
    let positive = |&t: &u32| form.term(t as usize).weight.is_positive();
    terms.iter().all(positive) || matrix(form, terms).is_some_and(has_no_negative_pivot)
}

/// The sum as a matrix over its own coordinates; `None` if there are too many or a number is not rational.
fn matrix(form: &Form, terms: &[u32]) -> Option<Vec<Vec<Rational>>> {
    let terms = || terms.iter().map(|&t| form.term(t as usize));
    let mut coordinates: Vec<u32> = Vec::new();
    for (coordinate, _) in terms().flat_map(|term| form.row(term)) {
        if let Err(at) = coordinates.binary_search(&coordinate.0) {
            coordinates.insert(at, coordinate.0);
            if coordinates.len() > MOST_COORDINATES {
                return None;
            }
        }
    }
    let place = |coordinate: u32| coordinates.partition_point(|&other| other < coordinate);
    let mut matrix = vec![vec![Rational::ZERO; coordinates.len()]; coordinates.len()];
    for term in terms() {
        let weight = term.weight.exact()?;
        for (i, a) in form.row(term) {
            let weighted = weight * a.exact()?;
            for (j, b) in form.row(term) {
                let entry = &mut matrix[place(i.0)][place(j.0)];
                *entry = &*entry + &(&weighted * b.exact()?);
            }
        }
    }
    Some(matrix)
}

/// Symmetric elimination with positive pivots as long as there are any; the remainder must vanish.
fn has_no_negative_pivot(mut a: Vec<Vec<Rational>>) -> bool {
    let mut left: Vec<usize> = (0..a.len()).collect();
    while let Some(at) = left.iter().position(|&i| a[i][i].signum() > 0) {
        let p = left.swap_remove(at);
        for &i in &left {
            let factor = &a[i][p] / &a[p][p];
            for &j in &left {
                a[i][j] = &a[i][j] - &(&factor * &a[p][j]);
            }
        }
    }
    left.iter().all(|&i| left.iter().all(|&j| a[i][j].is_zero()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::test_systems::push;

    fn is_positive(terms: &[(&str, usize, Option<usize>)]) -> bool {
        let mut form = Form::new();
        terms.iter().for_each(|&(weight, i, j)| push(&mut form, weight, i, j));
        // The helper's numbers have no sign: all but the first are subtracted.
        let mut signed = Form::new();
        for (index, term) in form.terms().enumerate() {
            let source = signed.source(form.source_of(term.source));
            let weight = if index == 0 { term.weight.clone() } else { -term.weight };
            signed.push(source, term.nature, weight, form.row(term).copies());
        }
        is_semidefinite(&signed, &(0..signed.terms().len() as u32).collect::<Vec<_>>())
    }

    #[test]
    fn a_sum_with_negative_weights_may_be_positive_all_the_same() {
        assert!(is_positive(&[("4", 0, None), ("3.9", 0, None)]));
        assert!(is_positive(&[("4", 0, None), ("4", 0, None)]));
        assert!(!is_positive(&[("4", 0, None), ("4.000000000000000000000000001", 0, None)]));
        assert!(!is_positive(&[("4", 0, Some(1)), ("0.001", 0, None)]));
        // (x0 - x1)² 4 - (x0 - x1)² 3
        assert!(is_positive(&[("4", 0, Some(1)), ("3", 0, Some(1))]));
        // A zero on the diagonal of a nonzero row: x0 x1 takes both signs.
        let product = vec![vec![Rational::ZERO, Rational::from(1)], vec![Rational::from(1), Rational::ZERO]];
        assert!(!has_no_negative_pivot(product));
    }

    /// c x' - x = 0 grows, though no frequency says so: a coordinate without mass is held by its springs, or is not.
    #[test]
    fn a_coordinate_without_mass_is_not_held_by_a_negative_spring() {
        use crate::analysis::modes::modes;
        use crate::analysis::modes::parts::independent;
        use crate::analysis::test_systems::blank;
        for (weight, held) in [(Number::ONE, true), (-&Number::ONE, false)] {
            let mut system = blank(1);
            push(&mut system.c, "1", 0, None);
            push(&mut system.k, "1", 0, None);
            let term = system.k.term(0);
            let mut k = Form::new();
            let source = k.source(system.k.source_of(term.source));
            k.push(source, term.nature, weight, system.k.row(term).copies());
            system.k = k;
            let part = &independent(&system)[0];
            let modes = modes(&system).expect("a mode without inertia");
            assert!(modes.infinite == 1 && modes.list.is_empty());
            assert_eq!(Passive::of(&system, part, &modes).held, held);
        }
    }
}
