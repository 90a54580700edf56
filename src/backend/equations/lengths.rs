//! Definitions of the names that depend on coordinates: lengths of lines, and distances, angles and stretches of belts.

use super::document::{Inline, Item, Writer, display, words};
use super::formula::Formula;
use crate::base::OrderBy;
use crate::equations::belts::{Belt, Turn};
use crate::symbols::{Dependence, Sum, Symbol};

impl Writer<'_> {
    /// A definition for each.
    pub fn lengths(&self) -> Vec<Item> {
        let energies = &self.equations.energies;
        let turn = |symbol: Symbol| {
            let turns = energies.belts.iter().filter_map(|belt| belt.turn.as_ref());
            turns.into_iter().find(|turn| turn.name == symbol)
        };
        let defined = |((name, dependence), apart): (&(Symbol, Dependence), &[Sum; 2])| {
            let formula = match dependence {
                Dependence::Root(_) if self.equations.names.angle_of_cosine(*name).is_some() => return None,
                Dependence::Root(square) => self.build.length(square, apart),
                Dependence::Form { form, .. } => match turn(*name) {
                    Some(turn) => self.turn(turn),
                    None => self.build.plain_sum(form),
                },
            };
            Some(display(self.name(*name).equal(formula)))
        };
        let free = energies.free_lengths.iter();
        let free = free.map(|(name, square, apart)| display(self.name(*name).equal(self.build.length(square, apart))));
        energies.lengths.0.iter().zip(&energies.spans).filter_map(defined).chain(free).collect()
    }

    /// `atan(y/(a + x)) - atan(h/a)`: the angle by which the centres of a belt have turned.
    fn turn(&self, turn: &Turn) -> Formula {
        let mut is_opposite = turn.is_opposite;
        let mut positive = |sum: &Sum| {
            let is_negative = sum.terms().iter().all(|(_, c)| c.signum() < 0);
            is_opposite ^= is_negative;
            self.build.plain_sum(&if is_negative { -sum } else { sum.clone() })
        };
        let quotient = Formula::quotient(positive(&turn.over), positive(&turn.under));
        let now = Formula::Call("atan", vec![quotient]);
        let (negative, drawn) = self.build.sign_and_factor(&turn.drawn);
        let mut terms = vec![(is_opposite, now)];
        if !turn.drawn.is_zero() {
            terms.push((negative == turn.is_opposite, drawn));
        }
        terms.order_by_key(|(negative, _)| *negative);
        Formula::sum(terms)
    }

    /// The meaning of each belt's names, in a sentence.
    pub fn spans(&self) -> Vec<Item> {
        let belts = self.equations.energies.belts.iter().filter(|belt| belt.mean.is_some() || belt.turn.is_some());
        let sentence = |belt: &Belt| {
            let parts = [
                (belt.distance, "the distance of its centres"),
                (belt.slant_name(), "the angle between its spans and the line of centres"),
                (belt.mean, "the mean stretch of its spans"),
                (belt.turn_name(), "the angle by which the line of centres has turned"),
            ];
            let mut row = vec![words(format!("{}: ", belt.name))];
            for (name, what) in parts {
                let Some(name) = name else { continue };
                let (before, is) = if row.len() == 1 { ("", " is") } else { (", ", "") };
                row.extend([words(before), Inline::Formula(self.name(name)), words(format!("{is} {what}"))]);
            }
            Item::Paragraph(row)
        };
        belts.map(sentence).collect()
    }
}
