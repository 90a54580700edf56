//! Section 1: assumptions, coordinates with a sentence each, and the meaning of names.

use super::document::{DIGITS, Inline, Item, Section, Writer, paragraph, words};
use super::fold;
use super::formula::{Formula, Running, Shown, as_shown};
use crate::backend::decimal::certain_number;
use crate::base::Dimension;
use crate::equations::coordinate::Coordinate;
use crate::equations::energy::{Stretch, Work};
use crate::equations::names::Label;
use crate::equations::unbalance::{self, Turns, Unbalance};
use crate::symbols::{Dependence, Sum, Symbol};

impl Writer<'_> {
    pub fn assumptions(&self) -> Section {
        let mut items = vec![paragraph(
            "Bodies are rigid, joints without friction, and the motion stays in the plane. x points right, y up; angles are positive \
             counter-clockwise. Springs and dampers follow their laws at any displacement; the linearised equations keep terms of \
             first order in the coordinates and neglect those of second order and above.",
        )];
        let moved = &self.equations.rest.moved;
        items.push(paragraph(if moved.is_empty() {
            "Coordinates are measured from rest, which is the scene as drawn."
        } else {
            "Coordinates are measured from rest, which differs from the scene as drawn by the values of section 4."
        }));
        items.extend(self.sentences());
        items.extend(self.heavy_spots());
        items.extend(self.spans());
        items.extend(self.names());
        Section { heading: "1 Assumptions and coordinates", items }
    }

    /// A sentence for each coordinate; coordinates of a `repeat` share one.
    fn sentences(&self) -> Vec<Item> {
        let both = |(index, coordinate): (usize, &Coordinate)| {
            let what = Formula::Name(Label::new(self.describe(index, coordinate), ""));
            Formula::Product(vec![self.name(coordinate.symbols[0]), what])
        };
        let rows = self.equations.motion.coordinates.iter().enumerate().map(both).collect();
        let sentence = |(formula, running): (Formula, Option<Running>)| {
            let Formula::Product(parts) = formula else { return paragraph("") };
            let mut parts = parts.into_iter();
            let (Some(name), Some(Formula::Name(Label { word, .. }))) = (parts.next(), parts.next()) else {
                return paragraph("");
            };
            let range = running.map(|Running { index, first, last }| format!(", {index} = {first}, ..., {last}"));
            let range = range.unwrap_or_default();
            Item::Paragraph(vec![Inline::Formula(name), words(format!(": {word}{range}"))])
        };
        fold::rows(rows, fold::index_letter(&self.equations.names)).into_iter().map(sentence).collect()
    }

    /// The rotation of each unbalance that has a force.
    fn heavy_spots(&self) -> Vec<Item> {
        let works = self.equations.energies.works.iter();
        let along_x = works.filter_map(|work| Some((work, work.unbalance.as_ref()?)));
        let along_x = along_x.filter(|(_, own)| own.is_along_x() && !own.force.is_zero());
        let sentence = |(work, own): (&Work, &Unbalance)| {
            let name = self.equations.inputs[work.input].trim_end_matches(".x");
            let sense = if own.clockwise { "clockwise" } else { "counter-clockwise" };
            let start = match own.along.each_ref().map(Sum::as_number) {
                [Some(x), Some(y)] if y.is_zero() => if x.signum() < 0 { "-x" } else { "+x" }.to_string(),
                _ => "+x of its component".to_string(),
            };
            let row = match &own.turns {
                Turns::Steadily(speed) => vec![
                    words(format!("{name}: an unbalance that turns {sense} with angular frequency ")),
                    Inline::Formula(self.build.sum(speed)),
                    words("; at "),
                    Inline::Formula(self.name(unbalance::time()).equal(Formula::zero())),
                    words(format!(" its heavy spot is at {start}")),
                ],
                Turns::Freely([angle, ..]) => {
                    let text = format!(": angle of the heavy spot of {name} from {start}, {sense}");
                    vec![Inline::Formula(self.name(*angle)), words(text)]
                }
            };
            Item::Paragraph(row)
        };
        along_x.map(sentence).collect()
    }

    fn describe(&self, index: usize, coordinate: &Coordinate) -> String {
        let body = &self.equations.bodies[index];
        let prescribed = if coordinate.input.is_some() { ", prescribed" } else { "" };
        match coordinate.motion {
            "x" => format!("displacement of {body} to the right{prescribed}"),
            "y" => format!("displacement of {body} upwards{prescribed}"),
            "along" => format!("displacement of {body} along its direction{prescribed}"),
            "slide" => format!("displacement of {body} along its slide"),
            _ => format!("angle of {body}, counter-clockwise{prescribed}"),
        }
    }

    /// The meaning of names: the `let`s, and the names that are introduced here.
    fn names(&self) -> Vec<Item> {
        let used = self.used_names();
        let mut items = Vec::new();
        for named in &self.equations.names.given {
            if !used.contains(&named.symbol) {
                continue;
            }
            let name = self.name(named.symbol);
            if let Some(definition) = &named.definition {
                let value = format!("= {}", certain_number(&named.value, DIGITS));
                let unit = match named.dimension {
                    Dimension::FREQUENCY => "1/s".to_string(),
                    dimension => dimension.usual_unit(),
                };
                let is_read = definition.as_number().is_some_and(|number| matches!(as_shown(&number), Shown::Whole(_)));
                let note = if is_read { unit } else { format!("{value} {unit}") };
                items.push(Item::Formula {
                    formula: name.equal(self.build.sum(definition)),
                    note: vec![words(note.trim())],
                });
            } else if named.text == "g" && self.is_made_up(named.symbol) {
                let value = Formula::Decimal(certain_number(&named.value, DIGITS));
                items.push(Item::Formula {
                    formula: name.equal(value),
                    note: vec![words("m/s^2, the gravity of the model")],
                });
            } else if let Some(source) = &named.source {
                let value = Formula::Decimal(certain_number(&named.value, DIGITS));
                items
                    .push(Item::Formula { formula: name.equal(value), note: vec![words(format!("written {source}"))] });
            }
        }
        items
    }

    fn is_made_up(&self, symbol: Symbol) -> bool {
        symbol.place() == Symbol::LAST
    }

    /// Names that occur in the energies or equations, including those in definitions.
    fn used_names(&self) -> std::collections::BTreeSet<Symbol> {
        let energies = &self.equations.energies;
        let mut used = std::collections::BTreeSet::new();
        let mut look = |sum: &Sum| {
            sum.names(&mut |symbol| {
                used.insert(symbol);
            });
        };
        look(&energies.kinetic);
        look(&energies.weights);
        for element in &energies.elements {
            [&element.coefficient, &element.free, &element.tension].into_iter().for_each(&mut look);
            let (Stretch::Plain(sum) | Stretch::Line { square: sum, .. }) = &element.stretch;
            look(sum);
        }
        for (_, Dependence::Root(form) | Dependence::Form { form, .. }) in &energies.lengths.0 {
            look(form);
        }
        for work in &energies.works {
            look(&work.displacement);
            work.unbalance.iter().for_each(|unbalance| look(&unbalance.force));
        }
        self.equations.constraints.iter().for_each(|constraint| look(&constraint.equation));
        if let Some((alpha, beta)) = &self.equations.rayleigh {
            look(alpha);
            look(beta);
        }
        // A `let` may refer to other ones.
        for named in self.equations.names.given.iter().rev() {
            if let Some(definition) = named.definition.as_ref().filter(|_| used.contains(&named.symbol)) {
                definition.names(&mut |symbol| {
                    used.insert(symbol);
                });
            }
        }
        used
    }
}
