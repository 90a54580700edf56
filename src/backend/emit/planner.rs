//! Turns a discrete system into the statements of one step. Similar pairs of states become loops over tables, in blocks
//! of eight and a smaller one for the rest, which compilers vectorise without changing the order of any sum; all other
//! states are written out. See docs/method/emit.md.

use super::groups::{LANES, groups};
use super::header::header;
use super::motion;
use super::names::{identifiers, model_identifier};
use super::plan::{
    Array, Expression, Factor, Field, Index, Operations, Plan, Slot, Start, Statement, Style, Table, Target,
};
use super::plan::{plus, product, remove_unused, sum, total};
use crate::analysis::discrete::{Cell, Decay, DiscreteSystem, Form, Lift, Operand, Port};

/// The plan of a discrete system.
pub fn plan(model: &str, system: &DiscreteSystem) -> Plan {
    let mut planner = Planner::new(system);
    planner.locals();
    (0..system.signals).for_each(|cell| planner.cell(cell));
    planner.add_feed_through();
    let (loops, single) = groups(&system.cells, system.signals);
    loops.iter().for_each(|group| planner.group(group));
    single.iter().for_each(|&cell| planner.cell(cell));
    planner.end();
    let state = planner.arrays();
    let events = planner.events(&state);
    let (set_state, get_state) = match system.tabled {
        true => motion::functions(system, &planner.slots, &state, &mut planner.tables),
        false => Default::default(),
    };
    let step = remove_unused(planner.step);
    Plan {
        name: model_identifier(model),
        precision: system.precision,
        style: Style::Steps,
        header: header(model, system, Operations::of(&step)),
        inputs: fields(&system.inputs),
        outputs: fields(&system.outputs),
        coordinates: fields(&system.coordinates),
        state,
        tables: planner.tables,
        events,
        step,
        tabled: system.tabled,
        set_state,
        get_state,
        observe: Vec::new(),
    }
}

fn fields(ports: &[Port]) -> Vec<Field> {
    let note = |port: &Port| match port.unit.as_str() {
        "" => port.name.clone(),
        unit => format!("{} in {unit}", port.name),
    };
    let identifiers = identifiers(ports.iter().map(|port| port.name.as_str()));
    identifiers.into_iter().zip(ports).map(|(identifier, port)| Field { identifier, note: note(port) }).collect()
}

/// Longer arrays are changed in a loop.
const LOOP: usize = 8;

struct Planner<'a> {
    system: &'a DiscreteSystem,
    inputs: Vec<String>,
    outputs: Vec<String>,
    tables: Vec<Table>,
    step: Vec<Statement>,
    /// Whether the sum of an output has been started.
    begun: Vec<bool>,
    /// Sums in lanes that are added at the end, with their outputs.
    lanes: Vec<(usize, Expression)>,
    /// The slot of each state of each cell.
    slots: Vec<Vec<Slot>>,
    groups: Vec<Array>,
    /// Initial values of single states.
    alone: Vec<f64>,
}

/// The names and factors of a pair's step.
struct Pair<'a> {
    lift: &'a Lift,
    x: Expression,
    v: Expression,
    /// v after the step.
    next: Expression,
    k: Expression,
    decay: Expression,
    p: Expression,
    input: [Vec<(Factor, Expression)>; 2],
}

impl Pair<'_> {
    /// v - c v + g u - k x; if the motion turns, with the opposite sign except for the input.
    fn next_v(&self) -> Expression {
        let turned = self.lift.turned;
        let base = match (self.lift.decay, turned) {
            (Decay::Lose(0.0), false) => self.v.clone(),
            (Decay::Lose(0.0), true) => Expression::Negative(Box::new(self.v.clone())),
            (Decay::Lose(_), false) => {
                plus(Some(self.v.clone()), Factor::LessTable(self.decay.clone()), self.v.clone())
            }
            (Decay::Lose(_), true) => {
                let lost = product(self.decay.clone(), self.v.clone());
                plus(Some(lost), Factor::Less(1.0), self.v.clone())
            }
            (Decay::Keep(_), false) => product(self.decay.clone(), self.v.clone()),
            (Decay::Keep(_), true) => Expression::Negative(Box::new(product(self.decay.clone(), self.v.clone()))),
        };
        let driven =
            self.input[1].iter().fold(base, |so_far, (factor, of)| plus(Some(so_far), factor.clone(), of.clone()));
        match (self.lift.k == 0.0, turned) {
            (true, _) => driven,
            (false, false) => plus(Some(driven), Factor::LessTable(self.k.clone()), self.x.clone()),
            (false, true) => plus(Some(driven), Factor::Table(self.k.clone()), self.x.clone()),
        }
    }

    /// x + p v, or p v - x.
    fn next_x(&self) -> Expression {
        let advance = if self.lift.p == 1.0 { self.next.clone() } else { product(self.p.clone(), self.next.clone()) };
        let moved = if self.lift.turned {
            plus(Some(advance), Factor::Less(1.0), self.x.clone())
        } else {
            sum(self.x.clone(), advance)
        };
        self.input[0].iter().fold(moved, |so_far, (factor, of)| plus(Some(so_far), factor.clone(), of.clone()))
    }
}

impl<'a> Planner<'a> {
    fn new(system: &'a DiscreteSystem) -> Planner<'a> {
        Planner {
            system,
            inputs: identifiers(system.inputs.iter().map(|port| port.name.as_str())),
            outputs: identifiers(system.outputs.iter().map(|port| port.name.as_str())),
            tables: Vec::new(),
            step: Vec::new(),
            begun: vec![false; system.outputs.len()],
            lanes: Vec::new(),
            slots: vec![Vec::new(); system.cells.len()],
            groups: Vec::new(),
            alone: Vec::new(),
        }
    }

    /// Locals for inputs, and for values computed from them once a step.
    fn locals(&mut self) {
        let system = self.system;
        for (j, input) in self.inputs.iter().enumerate() {
            let ramped = system.uses(|o| *o == Operand::Ramped(j));
            let slope = system.uses(|o| *o == Operand::Slope(j));
            let used = system.uses(|o| *o == Operand::Input(j));
            if used || ramped || slope || system.remembers() {
                self.step.push(Statement::Let(format!("u_{input}"), Expression::Input(j)));
            }
            let ramp = Expression::state("ramp", Index::Only);
            if ramped {
                let value = product(ramp.clone(), self.operand(Operand::Input(j)));
                self.step.push(Statement::Let(format!("r_{input}"), value));
            }
            if slope {
                let last = Expression::state("last", Index::At(j));
                let change = plus(Some(self.operand(Operand::Input(j))), Factor::Less(1.0), last);
                self.step.push(Statement::Let(format!("d_{input}"), product(ramp, change)));
            }
        }
    }

    fn operand(&self, operand: Operand) -> Expression {
        match operand {
            Operand::Input(j) => Expression::local(format!("u_{}", self.inputs[j])),
            Operand::Ramped(j) => Expression::local(format!("r_{}", self.inputs[j])),
            Operand::Slope(j) => Expression::local(format!("d_{}", self.inputs[j])),
            // The signals' cells come first.
            Operand::Signal(i) => Expression::local(format!("w{i}")),
        }
    }

    /// The name of an operand in a comment.
    fn operand_name(&self, operand: Operand) -> String {
        let input = |j: usize| &self.system.inputs[j].name;
        match operand {
            Operand::Input(j) => input(j).clone(),
            Operand::Ramped(j) => format!("{} after the first step", input(j)),
            Operand::Slope(j) => format!("the change of {}", input(j)),
            Operand::Signal(_) => "a signal".into(),
        }
    }

    /// Adds the direct feed-through of inputs to the outputs.
    fn add_feed_through(&mut self) {
        for i in 0..self.outputs.len() {
            let terms = self.system.direct[i].iter().map(|&(operand, d)| (Factor::Number(d), self.operand(operand)));
            let terms = terms.collect();
            self.add_to_output(i, terms);
        }
    }

    /// Adds terms to an output.
    fn add_to_output(&mut self, output: usize, terms: Vec<(Factor, Expression)>) {
        let name = format!("y_{}", self.outputs[output]);
        let begun = self.begun[output];
        let so_far = begun.then(|| Expression::local(name.clone()));
        let value = terms.into_iter().fold(so_far, |so_far, (factor, of)| Some(plus(so_far, factor, of)));
        match value {
            Some(Expression::Local(same)) if begun && same == name => {}
            Some(value) if begun => self.step.push(Statement::Assign(Target::Local(name), value)),
            Some(value) => {
                self.step.push(Statement::Variable(name, value));
                self.begun[output] = true;
            }
            None => {}
        }
    }

    /// The step of a group of similar pairs, with tables.
    fn group(&mut self, members: &[usize]) {
        let system = self.system;
        let cells: Vec<&Cell> = members.iter().map(|&i| &system.cells[i]).collect();
        let (first, last) = (cells[0], cells[cells.len() - 1]);
        let note = format!("{} {} {}", first.name, if cells.len() == 2 { "and" } else { "to" }, last.name);
        let Form::Pair(lift) = &first.form else { return };
        let number = self.groups.len() / 2 + 1;
        let names = [format!("x{number}"), format!("v{number}")];
        for (offset, name) in names.iter().enumerate() {
            let start = Start::Numbers(cells.iter().map(|cell| cell.start[offset]).collect());
            self.groups.push(Array { name: name.clone(), start, note: note.clone() });
            for (at, &cell) in members.iter().enumerate() {
                self.slots[cell].push(Slot { array: name.clone(), at });
            }
        }
        let width = cells.len().min(LANES);
        let blocks = cells.len() > width;
        let at = if blocks { Index::Lane(width) } else { Index::Of("lane") };
        let mut tables = Tables { number, cells: &cells, at: at.clone(), made: Vec::new() };
        let of_lift = |of: fn(&Lift) -> f64| {
            move |cell: &Cell| match &cell.form {
                Form::Pair(lift) => of(lift),
                _ => 0.0,
            }
        };
        let unused = Expression::Number(1.0);
        let decays = !matches!(lift.decay, Decay::Lose(0.0));
        let pair = Pair {
            lift,
            x: Expression::local("x"),
            v: Expression::local("v"),
            next: Expression::local("next"),
            k: if lift.k == 0.0 {
                unused.clone()
            } else {
                tables.table("K", "restoring: k in v - c v - k x", of_lift(|lift| lift.k))
            },
            decay: if decays {
                tables.table("C", "decay: c in v - c v, or the factor of v", of_lift(|lift| lift.decay.value()))
            } else {
                unused.clone()
            },
            p: if lift.p == 1.0 { unused } else { tables.table("P", "advance: p in x + p v", of_lift(|lift| lift.p)) },
            input: [0, 1].map(|offset| {
                let factor = |at: usize, operand: Operand, g: f64, tables: &mut Tables| match g {
                    1.0 => Factor::Number(1.0),
                    _ => {
                        let name = format!("{}{at}_", ["GX", "GV"][offset]);
                        let note = format!("contribution of {} to {}", self.operand_name(operand), ["x", "v"][offset]);
                        Factor::Table(tables.table(&name, &note, move |cell| cell.input[offset][at].1))
                    }
                };
                let terms = first.input[offset].iter().enumerate();
                terms.map(|(at, &(operand, g))| (factor(at, operand, g, &mut tables), self.operand(operand))).collect()
            }),
        };
        let mut body: Vec<Statement> = (["x", "v"].into_iter().zip(&names))
            .map(|(local, name)| Statement::Let(local.into(), Expression::state(name, at.clone())))
            .collect();
        self.step.push(Statement::Note(note));
        for output in 0..self.outputs.len() {
            let mut value: Option<Expression> = None;
            for (offset, of) in [(0, "x"), (1, "v")] {
                if first.contribution(offset, output).is_some() {
                    let name = format!("{}_{}_", ["YX", "YV"][offset], output);
                    let note = format!("{}: factors of {of}", self.system.outputs[output].name);
                    let factor =
                        tables.table(&name, &note, move |cell| cell.contribution(offset, output).unwrap_or(0.0));
                    value = Some(plus(value, Factor::Table(factor), Expression::local(of)));
                }
            }
            if let Some(value) = value {
                let lane = format!("sum{number}_{}", self.outputs[output]);
                self.step.push(Statement::Lanes(lane.clone(), width));
                let value = if blocks { sum(Expression::Lane(lane.clone()), value) } else { value };
                body.push(Statement::Assign(Target::Lane(lane.clone()), value));
                self.lanes.push((output, Expression::LaneSum(lane, width)));
            }
        }
        body.push(Statement::Let("next".into(), pair.next_v()));
        body.push(Statement::Assign(Target::state(&names[0], at.clone()), pair.next_x()));
        body.push(Statement::Assign(Target::state(&names[1], at), Expression::local("next")));
        self.tables.extend(tables.made);
        self.step.push(if blocks {
            Statement::Blocks { count: cells.len(), width, body }
        } else {
            Statement::Loop("lane", width, body)
        });
    }

    /// The step of a single cell.
    fn cell(&mut self, index: usize) {
        let cell = &self.system.cells[index];
        let first = self.alone.len();
        self.alone.extend(&cell.start);
        self.slots[index] = (0..cell.size()).map(|i| Slot { array: "w".into(), at: first + i }).collect();
        self.step.push(Statement::Note(cell.name.clone()));
        let local = |i: usize| Expression::local(format!("w{}", first + i));
        for i in 0..cell.size() {
            let value = Expression::state("w", Index::At(first + i));
            self.step.push(Statement::Let(format!("w{}", first + i), value));
        }
        for output in 0..self.outputs.len() {
            let factor = |i: usize| cell.contribution(i, output);
            let terms = (0..cell.size()).filter_map(|i| Some((Factor::Number(factor(i)?), local(i)))).collect();
            self.add_to_output(output, terms);
        }
        let input = |i: usize| -> Vec<(f64, Expression)> {
            cell.input[i].iter().map(|&(operand, g)| (g, self.operand(operand))).collect()
        };
        let state = |i: usize| Target::state("w", Index::At(first + i));
        let mut next = Vec::new();
        match &cell.form {
            Form::Keep(r) => {
                let kept = (*r != 0.0).then(|| (*r, local(0)));
                let value = total(kept.into_iter().chain(input(0)));
                next.push(Statement::Assign(state(0), value.unwrap_or(Expression::Number(0.0))));
            }
            Form::Lose(d) => {
                let lost = (*d != 0.0).then(|| (-d, local(0)));
                if let Some(change) = total(input(0).into_iter().chain(lost)) {
                    next.push(Statement::Assign(state(0), sum(local(0), change)));
                }
            }
            Form::Pair(lift) => {
                let name = format!("n{}", first + 1);
                let factors = |i| input(i).into_iter().map(|(g, of)| (Factor::Number(g), of)).collect();
                let pair = Pair {
                    lift,
                    x: local(0),
                    v: local(1),
                    next: Expression::local(name.clone()),
                    k: Expression::Number(lift.k),
                    decay: Expression::Number(lift.decay.value()),
                    p: Expression::Number(lift.p),
                    input: [factors(0), factors(1)],
                };
                next.push(Statement::Let(name.clone(), pair.next_v()));
                next.push(Statement::Assign(state(0), pair.next_x()));
                next.push(Statement::Assign(state(1), Expression::local(name)));
            }
            Form::Dense { turned, rows } => {
                for (i, row) in rows.iter().enumerate() {
                    let own = row.iter().enumerate().filter(|(_, e)| **e != 0.0).map(|(j, e)| (*e, local(j)));
                    let change = total(input(i).into_iter().chain(own));
                    let value = match (change, turned) {
                        (Some(change), false) => sum(local(i), change),
                        (Some(change), true) => plus(Some(change), Factor::Less(1.0), local(i)),
                        (None, false) => continue,
                        (None, true) => Expression::Negative(Box::new(local(i))),
                    };
                    next.push(Statement::Assign(state(i), value));
                }
            }
        }
        self.step.extend(next);
    }

    /// The end of a step: sums of lanes, stored inputs, outputs.
    fn end(&mut self) {
        for (output, lanes) in std::mem::take(&mut self.lanes) {
            self.add_to_output(output, vec![(Factor::Number(1.0), lanes)]);
        }
        if self.system.remembers() {
            for (j, input) in self.inputs.iter().enumerate() {
                let value = Expression::local(format!("u_{input}"));
                self.step.push(Statement::Assign(Target::state("last", Index::At(j)), value));
            }
        }
        if self.system.ramps() {
            self.step.push(Statement::Assign(Target::state("ramp", Index::Only), Expression::Number(1.0)));
        }
        for (output, name) in self.outputs.iter().enumerate() {
            let begun = self.begun[output];
            let value = if begun { Expression::local(format!("y_{name}")) } else { Expression::Number(0.0) };
            self.step.push(Statement::Assign(Target::Output(output), value));
        }
    }

    /// Changes at certain samples, by tables over the arrays.
    fn events(&mut self, arrays: &[Array]) -> Vec<u64> {
        let events = &self.system.events;
        if events.is_empty() {
            return Vec::new();
        }
        let slots: Vec<&Slot> = self.slots.iter().flatten().collect();
        let mut body = Vec::new();
        for array in arrays {
            let Start::Numbers(numbers) = &array.start else { continue };
            let mut rows = vec![0.0; events.len() * numbers.len()];
            let mut set = vec![false; numbers.len()];
            for (state, slot) in slots.iter().enumerate().filter(|(_, slot)| slot.array == array.name) {
                set[slot.at] = self.system.set[state];
                for (row, event) in events.iter().enumerate() {
                    rows[row * numbers.len() + slot.at] = event.change[state];
                }
            }
            if rows.iter().all(|x| *x == 0.0) && !set.contains(&true) {
                continue;
            }
            let name = format!("EVENTS_{}", array.name.to_uppercase());
            let change = |at: Index, set: bool| {
                let entry = Expression::Entry(name.clone(), Index::Event, at.clone());
                let value = if set { entry } else { sum(Expression::state(&array.name, at.clone()), entry) };
                Statement::Assign(Target::state(&array.name, at), value)
            };
            let none_set = !set.contains(&true);
            if numbers.len() > LOOP && none_set {
                body.push(Statement::Loop("i", numbers.len(), vec![change(Index::Of("i"), false)]));
            } else {
                let moves = |at: usize| rows.iter().skip(at).step_by(numbers.len()).any(|x| *x != 0.0);
                let places = (0..numbers.len()).filter(|&at| set[at] || moves(at));
                body.extend(places.map(|at| change(Index::At(at), set[at])));
            }
            let note = "new states or changes of the states at each event".to_string();
            self.tables.push(Table { name, columns: numbers.len(), values: rows, note });
        }
        // After the step that ends at the event's sample, so that the state that is read there includes it.
        let outputs =
            self.step.iter().position(|statement| matches!(statement, Statement::Assign(Target::Output(_), _)));
        self.step
            .insert(outputs.unwrap_or(self.step.len()), Statement::WhenDue(events.len(), self.system.repeat, body));
        events.iter().map(|event| event.tick).collect()
    }

    fn arrays(&self) -> Vec<Array> {
        let mut arrays = self.groups.clone();
        let mut add = |name: &str, start: Start, note: &str| {
            arrays.push(Array { name: name.into(), start, note: note.into() });
        };
        if !self.alone.is_empty() {
            add("w", Start::Numbers(self.alone.clone()), "single states");
        }
        if self.system.remembers() && !self.inputs.is_empty() {
            add("last", Start::Numbers(vec![0.0; self.inputs.len()]), "the inputs of the last step");
        }
        if self.system.ramps() {
            add("ramp", Start::Number(0.0), "0 before the first step, then 1");
        }
        arrays
    }
}

/// The tables of a group.
struct Tables<'a> {
    number: usize,
    cells: &'a [&'a Cell],
    /// The index at which a loop reads them.
    at: Index,
    made: Vec<Table>,
}

impl Tables<'_> {
    fn table(&mut self, name: &str, note: &str, of: impl Fn(&Cell) -> f64) -> Expression {
        let name = format!("{name}{}", self.number);
        let values = self.cells.iter().map(|cell| of(cell)).collect();
        self.made.push(Table { name: name.clone(), columns: 0, values, note: note.into() });
        Expression::Table(name, self.at.clone())
    }
}
