//! Equations of motion as statements: the right-hand side of a first-order system, and the outputs. Stretches and
//! tensions that several forces share are computed only once. See docs/method/emit.md.

use super::header::of_equations;
use super::names::{identifiers, model_identifier};
use super::plan::{
    Expression, Factor, Field, Index, Operations, Plan, Statement, Style, Target, plus, remove_unused, total,
};
use crate::analysis::discrete::Port;
use crate::analysis::discrete::equations::Equations;

/// The plan of a model's equations.
pub fn plan(model: &str, equations: &Equations) -> Plan {
    let rates = used_powers(equations);
    let mut inputs = Vec::new();
    for (port, most) in equations.inputs.iter().zip(&rates) {
        for power in 0..=*most {
            inputs.push(Port { name: to_power(&port.name, power), unit: per_second(&port.unit, power) });
        }
    }
    let first: Vec<usize> = rates.iter().scan(0, |at, most| Some(std::mem::replace(at, *at + most + 1))).collect();
    let written = Written { equations, first };
    let outputs = equations.seen.iter().any(|[_, _, accelerations]| !accelerations.is_empty());
    let mut observe = if outputs { written.accelerations() } else { Vec::new() };
    observe.extend(written.outputs());
    let observe = remove_unused(observe);
    let mut derivative = written.accelerations();
    for i in 0..equations.coordinates.len() {
        derivative.push(Statement::Assign(Target::DisplacementRate(Index::At(i)), Expression::Velocity(Index::At(i))));
    }
    for i in 0..equations.coordinates.len() {
        derivative.push(Statement::Assign(Target::VelocityRate(Index::At(i)), Expression::local(format!("a{i}"))));
    }
    let fields = |ports: &[Port]| {
        let identifiers = identifiers(ports.iter().map(|port| port.name.as_str()));
        let note = |port: &Port| {
            if port.unit.is_empty() { port.name.clone() } else { format!("{} in {}", port.name, port.unit) }
        };
        identifiers.into_iter().zip(ports).map(|(identifier, port)| Field { identifier, note: note(port) }).collect()
    };
    Plan {
        name: model_identifier(model),
        precision: equations.precision,
        style: Style::Equations { start: equations.start.clone() },
        header: of_equations(model, equations, Operations::of(&derivative)),
        inputs: fields(&inputs),
        outputs: fields(&equations.outputs),
        coordinates: fields(&equations.coordinates),
        state: Vec::new(),
        tables: Vec::new(),
        events: Vec::new(),
        step: derivative,
        tabled: true,
        set_state: Vec::new(),
        get_state: Vec::new(),
        observe,
    }
}

/// The highest derivative of each input that has an effect.
fn used_powers(equations: &Equations) -> Vec<usize> {
    let mut most = vec![0; equations.inputs.len()];
    for rows in equations.forces.iter().chain(&equations.direct) {
        for (power, row) in rows.iter().enumerate() {
            row.iter().for_each(|(input, _)| most[*input] = most[*input].max(power));
        }
    }
    most
}

fn to_power(name: &str, power: usize) -> String {
    match power {
        0 => name.to_string(),
        1 => format!("{name}.rate"),
        _ => format!("{name}.acceleration"),
    }
}

fn per_second(unit: &str, power: usize) -> String {
    match power {
        0 => unit.to_string(),
        1 => format!("{unit}/s"),
        _ => format!("{unit}/s^2"),
    }
}

/// The most terms of a force in one expression.
const LONGEST: usize = 64;

struct Written<'a> {
    equations: &'a Equations,
    /// The index of each input's first field.
    first: Vec<usize>,
}

impl Written<'_> {
    fn inputs<'b>(&'b self, rows: &'b [Vec<(usize, f64)>; 3]) -> impl Iterator<Item = (f64, Expression)> + 'b {
        let of = move |power: usize| {
            rows[power].iter().map(move |(input, b)| (*b, Expression::Input(self.first[*input] + power)))
        };
        (0..3).flat_map(of)
    }

    /// Statements for the accelerations a0, a1, ...
    fn accelerations(&self) -> Vec<Statement> {
        let e = self.equations;
        let n = e.coordinates.len();
        let mut list = Vec::new();
        let mut forces: Vec<Option<Expression>> = vec![None; n];
        let mut terms = vec![0usize; n];
        let add = |force: &mut Option<Expression>, factor: f64, of: Expression| {
            *force = Some(plus(force.take(), Factor::Number(factor), of));
        };
        for (i, force) in forces.iter_mut().enumerate() {
            self.inputs(&e.forces[i]).for_each(|(factor, of)| add(force, factor, of));
            let (k, c) = e.own[i];
            if k != 0.0 {
                add(force, -k, Expression::Displacement(Index::At(i)));
            }
            if c != 0.0 {
                add(force, -c, Expression::Velocity(Index::At(i)));
            }
        }
        for (t, stretch) in e.stretches.iter().enumerate() {
            let along = |of: fn(Index) -> Expression| total(stretch.row.iter().map(|(i, a)| (*a, of(Index::At(*i)))));
            let mut tension = None;
            for (name, weight, of) in [
                (format!("stretch{t}"), stretch.k, Expression::Displacement as fn(Index) -> Expression),
                (format!("rate{t}"), stretch.c, Expression::Velocity),
            ] {
                if weight != 0.0
                    && let Some(value) = along(of)
                {
                    list.push(Statement::Let(name.clone(), value));
                    tension = Some(plus(tension, Factor::Number(weight), Expression::local(name)));
                }
            }
            if let Some(tension) = tension {
                list.push(Statement::Let(format!("tension{t}"), tension));
                for (i, a) in &stretch.row {
                    add(&mut forces[*i], -a, Expression::local(format!("tension{t}")));
                    terms[*i] += 1;
                    if terms[*i].is_multiple_of(LONGEST) {
                        // The partial sum gets a name, so that expressions have a limited length.
                        let name = format!("force{i}_{}", terms[*i] / LONGEST);
                        let so_far = forces[*i].replace(Expression::local(name.clone()));
                        list.extend(so_far.map(|so_far| Statement::Let(name, so_far)));
                    }
                }
            }
        }
        // L z = force, a = L^-T D^-1 z.
        let coupled = e.lower.iter().any(|row| !row.is_empty());
        for (i, force) in forces.into_iter().enumerate() {
            let value = e.lower[i].iter().fold(force, |so_far, (j, l)| {
                Some(plus(so_far, Factor::Number(-l), Expression::local(format!("z{j}"))))
            });
            let value = value.unwrap_or(Expression::Number(0.0));
            let (name, value) = if coupled {
                (format!("z{i}"), value)
            } else {
                (format!("a{i}"), plus(None, Factor::Number(e.inverse[i]), value))
            };
            list.push(Statement::Let(name, value));
        }
        let mut below: Vec<Vec<(usize, f64)>> = vec![Vec::new(); n];
        for (k, row) in e.lower.iter().enumerate() {
            row.iter().for_each(|(i, l)| below[*i].push((k, *l)));
        }
        for i in (0..n).rev().filter(|_| coupled) {
            let scaled = plus(None, Factor::Number(e.inverse[i]), Expression::local(format!("z{i}")));
            let value = below[i].iter().fold(scaled, |so_far, (k, l)| {
                plus(Some(so_far), Factor::Number(-l), Expression::local(format!("a{k}")))
            });
            list.push(Statement::Let(format!("a{i}"), value));
        }
        list
    }

    fn outputs(&self) -> Vec<Statement> {
        let e = self.equations;
        let motion = |power: usize, i: usize| match power {
            0 => Expression::Displacement(Index::At(i)),
            1 => Expression::Velocity(Index::At(i)),
            _ => Expression::local(format!("a{i}")),
        };
        let of = |output: usize| {
            let rows = e.seen[output].iter().enumerate();
            let seen = rows.flat_map(|(power, row)| row.iter().map(move |(i, p)| (*p, motion(power, *i))));
            let value = total(seen.chain(self.inputs(&e.direct[output]))).unwrap_or(Expression::Number(0.0));
            Statement::Assign(Target::Output(output), value)
        };
        (0..e.outputs.len()).map(of).collect()
    }
}
