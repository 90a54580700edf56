//! Damping of the form C = alpha M + beta K (Rayleigh), recognised exactly: each undamped mode is then an independent
//! oscillator s^2 + (alpha + beta omega^2) s + omega^2. In: the terms of an independent part. Out: alpha and beta;
//! `None` if C is not of that form or a number is not rational. See docs/method/poles.md#quadratics.

use crate::analysis::modes::parts::Part;
use crate::base::{Number, Rational};
use crate::system::{Form, LinearSystem};
use std::collections::BTreeMap;

/// The factors of C = alpha M + beta K, exact.
#[derive(Clone, Debug, PartialEq)]
pub struct Proportional {
    pub alpha: Number,
    pub beta: Number,
}

impl Proportional {
    pub const NONE: Proportional = Proportional { alpha: Number::ZERO, beta: Number::ZERO };

    /// Damping of the mode with this omega^2, per unit of modal mass.
    pub fn of_mode(&self, omega_squared: &Number) -> Number {
        &self.alpha + &(&self.beta * omega_squared)
    }
}

/// Entries (i <= j) of M, C and K.
type Entries = BTreeMap<(u32, u32), [Rational; 3]>;

/// alpha and beta, if they exist.
pub fn proportional(system: &LinearSystem, part: &Part) -> Option<Proportional> {
    let mut entries = Entries::new();
    for (which, form, terms) in [(0, &system.m, &part.m), (1, &system.c, &part.c), (2, &system.k, &part.k)] {
        accumulate(&mut entries, which, form, terms)?;
    }
    let (alpha, beta) = solve(&entries)?;
    let fits = |[m, c, k]: &[Rational; 3]| (&(&alpha * m) + &(&beta * k)) == *c;
    entries
        .values()
        .all(fits)
        .then(|| Proportional { alpha: Number::from(alpha.clone()), beta: Number::from(beta.clone()) })
}

fn accumulate(entries: &mut Entries, which: usize, form: &Form, terms: &[u32]) -> Option<()> {
    for &index in terms {
        let term = form.term(index as usize);
        let (weight, row) = (term.weight.exact()?, form.row(term));
        for (at, (i, a)) in row.iter().enumerate() {
            let weighted = weight * a.exact()?;
            for (j, b) in row.iter().skip(at) {
                let entry = entries.entry((i.0, j.0)).or_insert([Rational::ZERO; 3]);
                entry[which] = &entry[which] + &(&weighted * b.exact()?);
            }
        }
    }
    Some(())
}

/// The unique alpha and beta given by two entries with independent (m, k); if all are multiples of one, beta = 0.
fn solve(entries: &Entries) -> Option<(Rational, Rational)> {
    let [m1, c1, k1] = entries.values().find(|[m, _, _]| !m.is_zero())?;
    for [m2, c2, k2] in entries.values() {
        let determinant = &(m1 * k2) - &(m2 * k1);
        if !determinant.is_zero() {
            let alpha = &(&(c1 * k2) - &(c2 * k1)) / &determinant;
            let beta = &(&(m1 * c2) - &(m2 * c1)) / &determinant;
            return Some((alpha, beta));
        }
    }
    Some((c1 / m1, Rational::ZERO))
}
