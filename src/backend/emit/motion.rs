//! The state in the model's own coordinates: statements of `set_state` and `get_state`, written out if they are few,
//! otherwise with tables. See docs/method/emit.md.

use super::plan::{Array, Expression, Factor, Index, Slot, Statement, Table, Target, plus, product, sum, total};
use crate::analysis::discrete::{DiscreteSystem, Operand};
use crate::base::OrderBy;

/// The most numbers that are written out; larger sets become tables.
const WRITTEN_OUT: usize = 1024;

/// `set_state` and `get_state`.
pub fn functions(
    system: &DiscreteSystem,
    slots: &[Vec<Slot>],
    arrays: &[Array],
    tables: &mut Vec<Table>,
) -> (Vec<Statement>, Vec<Statement>) {
    // Signals are not set: they continue unchanged.
    let places = slots.iter().enumerate().skip(system.signals);
    let states = places
        .flat_map(|(cell, slots)| slots.iter().enumerate().map(move |(i, slot)| State { system, cell, row: i, slot }));
    let motion = Motion { system, n: system.coordinates.len(), states: states.collect() };
    let numbers: usize =
        motion.states.iter().map(|state| state.to().iter().filter(|value| **value != 0.0).count()).sum();
    let (mut set, get) = if numbers > WRITTEN_OUT { motion.by_tables(arrays, tables) } else { motion.written_out() };
    if system.ramps() {
        set.push(Statement::Assign(Target::state("ramp", Index::Only), Expression::Number(0.0)));
    }
    (set, get)
}

struct State<'a> {
    system: &'a DiscreteSystem,
    cell: usize,
    row: usize,
    slot: &'a Slot,
}

impl State<'_> {
    fn to(&self) -> &[f64] {
        &self.system.cells[self.cell].to[self.row]
    }

    fn carried_back(&self) -> &[f64] {
        &self.system.cells[self.cell].back[self.row]
    }
}

struct Motion<'a> {
    system: &'a DiscreteSystem,
    n: usize,
    states: Vec<State<'a>>,
}

impl Motion<'_> {
    fn given_state(&self, j: usize) -> Expression {
        if j < self.n { Expression::Displacement(Index::At(j)) } else { Expression::Velocity(Index::At(j - self.n)) }
    }

    fn returned_state(&self, j: usize) -> Target {
        if j < self.n { Target::Displacement(Index::At(j)) } else { Target::Velocity(Index::At(j - self.n)) }
    }

    fn written_out(&self) -> (Vec<Statement>, Vec<Statement>) {
        let set = self.states.iter().enumerate().map(|(i, state)| {
            let row = state.to().iter().enumerate().filter(|(_, value)| **value != 0.0);
            let value = self.without_inputs(i, total(row.map(|(j, value)| (*value, self.given_state(j)))));
            let place = Target::state(&state.slot.array, Index::At(state.slot.at));
            Statement::Assign(place, value.unwrap_or(Expression::Number(0.0)))
        });
        let get = (0..2 * self.n).map(|j| {
            let terms = self.states.iter().filter(|state| state.carried_back()[j] != 0.0);
            let read = |state: &State| Expression::state(&state.slot.array, Index::At(state.slot.at));
            let value = self.with_inputs(j, total(terms.map(|state| (state.carried_back()[j], read(state)))));
            Statement::Assign(self.returned_state(j), value.unwrap_or(Expression::Number(0.0)))
        });
        (set.collect(), get.collect())
    }

    /// A state minus the contributions of the last inputs and of the signals.
    fn without_inputs(&self, state: usize, value: Option<Expression>) -> Option<Expression> {
        self.system.taken[state].iter().fold(value, |so_far, (operand, taken)| match self.current_value(*operand) {
            Some(of) => Some(plus(so_far, Factor::Number(-taken), of)),
            None => so_far,
        })
    }

    /// A displacement or velocity plus the contributions of the last inputs and of the signals.
    fn with_inputs(&self, j: usize, value: Option<Expression>) -> Option<Expression> {
        self.system.offset[j].iter().fold(value, |so_far, (operand, e)| match self.current_value(*operand) {
            Some(of) => Some(plus(so_far, Factor::Number(*e), of)),
            None => so_far,
        })
    }

    /// An operand between two steps; inputs that keep their last values have zero slope.
    fn current_value(&self, operand: Operand) -> Option<Expression> {
        let last = |input: usize| Expression::state("last", Index::At(input));
        match operand {
            Operand::Input(input) => Some(last(input)),
            Operand::Ramped(input) => Some(product(Expression::state("ramp", Index::Only), last(input))),
            Operand::Slope(_) => None,
            Operand::Signal(state) => Some(Expression::state("w", Index::At(state))),
        }
    }

    fn by_tables(&self, arrays: &[Array], tables: &mut Vec<Table>) -> (Vec<Statement>, Vec<Statement>) {
        let (mut set, mut get) = (Vec::new(), Vec::new());
        let (i, j) = (Index::Of("i"), Index::Of("j"));
        let mut sums = [Vec::new(), Vec::new()];
        for array in arrays {
            let mut states: Vec<&State> = self.states.iter().filter(|state| state.slot.array == array.name).collect();
            if states.is_empty() {
                continue;
            }
            states.order_by_key(|state| state.slot.at);
            // The states of signals, which are not set, come before them.
            let (count, first) = (states.len(), states[0].slot.at);
            let at = |index: &'static str| match first {
                0 => Index::Of(index),
                _ => Index::Text(format!("{first} + {index}")),
            };
            let upper = array.name.to_uppercase();
            let mut body = vec![Statement::Variable("sum".into(), Expression::Number(0.0))];
            for (part, letter) in ["Q", "V"].into_iter().enumerate() {
                let own = part * self.n..(part + 1) * self.n;
                let name = format!("TO_{upper}_{letter}");
                let values = states.iter().map(|state| &state.to()[own.clone()]).collect::<Vec<_>>().concat();
                if values.iter().any(|value| *value != 0.0) {
                    tables.push(Table { name: name.clone(), columns: self.n, values, note: "for set_state".into() });
                    let given =
                        if part == 0 { Expression::Displacement(j.clone()) } else { Expression::Velocity(j.clone()) };
                    let term = product(Expression::Entry(name, i.clone(), j.clone()), given);
                    body.push(add_up("j", self.n, "sum", term));
                }
                let name = format!("{letter}_{upper}");
                let columns: Vec<&[f64]> = states.iter().map(|state| &state.carried_back()[own.clone()]).collect();
                let mut values = Vec::with_capacity(self.n * count);
                (0..self.n).for_each(|row| values.extend(columns.iter().map(|column| column[row])));
                if values.iter().any(|value| *value != 0.0) {
                    tables.push(Table { name: name.clone(), columns: count, values, note: "for get_state".into() });
                    let read = Expression::state(&array.name, at("j"));
                    let term = product(Expression::Entry(name, i.clone(), j.clone()), read);
                    sums[part].push(add_up("j", count, ["q", "v"][part], term));
                }
            }
            body.push(Statement::Assign(Target::state(&array.name, at("i")), Expression::local("sum")));
            set.push(Statement::Loop("i", count, body));
        }
        for (index, state) in self.states.iter().enumerate() {
            let place = || Index::At(state.slot.at);
            let so_far = Expression::state(&state.slot.array, place());
            if !self.system.taken[index].is_empty()
                && let Some(value) = self.without_inputs(index, Some(so_far))
            {
                set.push(Statement::Assign(Target::state(&state.slot.array, place()), value));
            }
        }
        let [q, v] = sums;
        let mut body = vec![Statement::Variable("q".into(), Expression::Number(0.0))];
        body.push(Statement::Variable("v".into(), Expression::Number(0.0)));
        body.extend(q.into_iter().chain(v));
        body.push(Statement::Assign(Target::Displacement(i.clone()), Expression::local("q")));
        body.push(Statement::Assign(Target::Velocity(i), Expression::local("v")));
        get.push(Statement::Loop("i", self.n, body));
        for j in 0..2 * self.n {
            if let Some(more) = self.with_inputs(j, None) {
                get.push(Statement::Assign(self.returned_state(j), sum(self.given_state(j), more)));
            }
        }
        (set, get)
    }
}

/// sum = sum + term, over an index.
fn add_up(index: &'static str, count: usize, name: &str, term: Expression) -> Statement {
    let value = sum(Expression::local(name), term);
    Statement::Loop(index, count, vec![Statement::Assign(Target::Local(name.into()), value)])
}
