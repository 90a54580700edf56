//! Code with an adjustable parameter: a dense step, and `set_parameter`, which assembles M, C and K, solves for the
//! accelerations and computes the exponential by scaling and squaring E = exp - 1, in a number of operations that does
//! not depend on the value. In: the system as a function of the parameter. Out: a plan. See docs/method/emit.md.

use super::header::of_parameter;
use super::names::{identifiers, model_identifier};
use super::plan::{
    Array, Expression as E, Factor, Field, Index, Operations, Plan, Start, Statement, Style, Table, Target, plus,
};
use super::plan::{product, remove_unused, sum, total};
use crate::analysis::discrete::parameter::{Parameterised, Polynomial};
use crate::analysis::discrete::{Port, Precision};
use crate::base::two_to;

/// Terms of the exponential's series: for a norm of at most a half, the remainder is below 1e-19.
const TERMS: usize = 15;

/// The plan of a model with an adjustable parameter; `None` if a number leaves the range of the precision.
pub fn plan(model: &str, system: &Parameterised, step: f64, precision: Precision) -> Option<Plan> {
    let written = Written::of(system, step);
    let (n, width) = (written.n, written.width());
    let outputs = system.outputs.len();
    let zeros = |count: usize| Start::Numbers(vec![0.0; count]);
    let mut x: Vec<f64> = system.start.iter().map(|s| s.0).collect();
    x.extend(system.start.iter().map(|s| s.1 / written.scale));
    let array = |name: &str, start, note: &str| Array { name: name.into(), start, note: note.into() };
    let reciprocals = (1..TERMS).rev().map(|k| 1.0 / k as f64).collect();
    let fields = |ports: &[Port]| -> Vec<Field> {
        let note = |port: &Port| {
            if port.unit.is_empty() { port.name.clone() } else { format!("{} in {}", port.name, port.unit) }
        };
        let names = identifiers(ports.iter().map(|port| port.name.as_str()));
        names.into_iter().zip(ports).map(|(identifier, port)| Field { identifier, note: note(port) }).collect()
    };
    let once = remove_unused(written.step());
    let plan = Plan {
        name: model_identifier(model),
        precision,
        style: Style::Parameter { value: system.value, statements: remove_unused(written.set_parameter()) },
        header: of_parameter(model, system, step, Operations::of(&once)),
        inputs: fields(&system.inputs),
        outputs: fields(&system.outputs),
        coordinates: fields(&system.coordinates),
        state: vec![
            array("x", Start::Numbers(x), "displacements, then scaled velocities"),
            array("e", zeros(2 * n * width), "change of x in one step, row by row over x and the inputs"),
            array("c", zeros(outputs * width), "what the outputs see, row by row over x and the inputs"),
        ],
        tables: vec![Table {
            name: "RECIPROCALS".into(),
            columns: 0,
            values: reciprocals,
            note: "1/14, 1/13, ... of the exponential's series".into(),
        }],
        events: Vec::new(),
        step: once,
        tabled: true,
        set_state: written.set_state(),
        get_state: written.get_state(),
        observe: Vec::new(),
    };
    plan.fits().then_some(plan)
}

struct Written<'a> {
    system: &'a Parameterised,
    n: usize,
    inputs: usize,
    step: f64,
    /// Unit of velocities, a power of two that balances the exponent.
    scale: f64,
    squarings: i32,
}

fn at(p: &Polynomial, x: f64) -> f64 {
    (p[2] * x + p[1]) * x + p[0]
}

fn power_of_two(x: f64) -> f64 {
    f64::from_bits(x.to_bits() & 0x7ff0_0000_0000_0000)
}

impl<'a> Written<'a> {
    fn of(system: &'a Parameterised, step: f64) -> Written<'a> {
        let n = system.coordinates.len();
        // Magnitudes over the range: K and C relative to the smallest diagonal entry of M, which bounds the
        // accelerations up to a factor n.
        let (mut stiff, mut damped) = (0.0f64, 0.0f64);
        for value in [system.range.0, system.value, system.range.1] {
            let mass = (0..n).map(|i| at(&system.m[i * n + i], value).abs()).fold(f64::INFINITY, f64::min);
            let norm = |of: &[Polynomial]| of.iter().map(|p| at(p, value).abs()).sum::<f64>() / mass;
            (stiff, damped) = (stiff.max(norm(&system.k)), damped.max(norm(&system.c)));
        }
        let scale = if stiff > 0.0 && stiff.is_finite() { power_of_two(stiff.sqrt()) } else { 1.0 };
        let norm = step * n as f64 * (2.0 * scale + 2.0 * stiff / scale + damped);
        let mut squarings = 1;
        while norm / two_to(squarings) > 0.5 && squarings < 60 {
            squarings += 1;
        }
        Written { system, n, inputs: system.inputs.len(), step, scale, squarings }
    }

    fn width(&self) -> usize {
        2 * self.n + self.inputs
    }

    /// A polynomial of the parameter; `None` if it is zero.
    fn value(p: &Polynomial) -> Option<E> {
        let value = || E::local("value");
        let powers = [None, Some(value()), Some(product(value(), value()))];
        p.iter().zip(powers).filter(|(c, _)| **c != 0.0).fold(None, |so_far, (c, power)| match power {
            Some(power) => Some(plus(so_far, Factor::Number(*c), power)),
            None => Some(E::Number(*c)),
        })
    }

    #[allow(clippy::needless_range_loop)]
    fn set_parameter(&self) -> Vec<Statement> {
        let (n, width, system) = (self.n, self.width(), self.system);
        let mut list = Vec::new();
        // M = L D L^T with L and D as locals; entries that are zero for every value are omitted.
        let mut l: Vec<Vec<bool>> = vec![vec![false; n]; n];
        for i in 0..n {
            for j in 0..=i {
                let mut rest = Self::value(&system.m[i * n + j]);
                for k in (0..j).filter(|&k| l[i][k] && l[j][k]) {
                    let term = product(
                        product(E::local(format!("l{i}_{k}")), E::local(format!("d{k}"))),
                        E::local(format!("l{j}_{k}")),
                    );
                    rest = Some(plus(rest, Factor::Less(1.0), term));
                }
                if i == j {
                    list.push(Statement::Let(format!("d{i}"), rest.unwrap_or(E::Number(0.0))));
                } else if let Some(rest) = rest {
                    l[i][j] = true;
                    let quotient = E::Quotient(Box::new(rest), Box::new(E::local(format!("d{j}"))));
                    list.push(Statement::Let(format!("l{i}_{j}"), quotient));
                }
            }
        }
        // Accelerations as rows over displacements, scaled velocities and inputs.
        let mut moves = vec![vec![false; width]; n];
        for column in 0..width {
            let entry = |i: usize| -> Option<E> {
                let (p, factor) = match column {
                    j if j < n => (&system.k[i * n + j], -1.0),
                    j if j < 2 * n => (&system.c[i * n + j - n], -self.scale),
                    j => (&system.b[i * self.inputs + j - 2 * n], 1.0),
                };
                Self::value(&p.map(|c| c * factor))
            };
            let mut known = vec![false; n];
            for i in 0..n {
                let so_far = (0..i).filter(|&j| l[i][j] && known[j]).fold(entry(i), |so_far, j| {
                    let term = product(E::local(format!("l{i}_{j}")), E::local(format!("z{j}_{column}")));
                    Some(plus(so_far, Factor::Less(1.0), term))
                });
                if let Some(value) = so_far {
                    known[i] = true;
                    list.push(Statement::Let(format!("z{i}_{column}"), value));
                }
            }
            for i in (0..n).rev() {
                let own = known[i].then(|| {
                    let (z, d) = (E::local(format!("z{i}_{column}")), E::local(format!("d{i}")));
                    E::Quotient(Box::new(z), Box::new(d))
                });
                let value = (i + 1..n).filter(|&k| l[k][i] && moves[k][column]).fold(own, |so_far, k| {
                    let term = product(E::local(format!("l{k}_{i}")), E::local(format!("a{k}_{column}")));
                    Some(plus(so_far, Factor::Less(1.0), term))
                });
                if let Some(value) = value {
                    moves[i][column] = true;
                    list.push(Statement::Let(format!("a{i}_{column}"), value));
                }
            }
        }
        list.extend(self.exponential(&moves));
        list.extend(self.outputs(&moves));
        list
    }

    /// e = exp(A h) - 1, and the contributions of inputs.
    #[allow(clippy::needless_range_loop)]
    fn exponential(&self, moves: &[Vec<bool>]) -> Vec<Statement> {
        let (n, width) = (self.n, self.width());
        let h = self.step / two_to(self.squarings);
        let entry = |name: &str, i: Index, j: Index| E::Entry(name.into(), i, j);
        let put = |name: &str, i: Index, j: Index, value: E| Statement::Assign(Target::Entry(name.into(), i, j), value);
        let (i, j, k) = (Index::Of("i"), Index::Of("j"), Index::Of("k"));
        let mut list = vec![
            Statement::Matrix("z".into(), 2 * n, width),
            Statement::Matrix("p".into(), 2 * n, width),
            Statement::Matrix("next".into(), 2 * n, width),
        ];
        for row in 0..n {
            list.push(put("z", Index::At(row), Index::At(n + row), E::Number(h * self.scale)));
            for column in (0..width).filter(|&column| moves[row][column]) {
                let value = product(E::Number(h / self.scale), E::local(format!("a{row}_{column}")));
                list.push(put("z", Index::At(n + row), Index::At(column), value));
            }
        }
        let each = |body: Vec<Statement>| Statement::Loop("i", 2 * n, vec![Statement::Loop("j", width, body)]);
        let copy = each(vec![put("p", i.clone(), j.clone(), entry("next", i.clone(), j.clone()))]);
        let multiplied = |left: &str, start: E, end: &dyn Fn(E) -> E| {
            let term = product(entry(left, i.clone(), k.clone()), entry("p", k.clone(), j.clone()));
            let add = Statement::Assign(Target::Local("sum".into()), sum(E::local("sum"), term));
            each(vec![
                Statement::Variable("sum".into(), start),
                Statement::Loop("k", 2 * n, vec![add]),
                put("next", i.clone(), j.clone(), end(E::local("sum"))),
            ])
        };
        // p = z / 15, then p = (z + z p) / 14, ... , / 1
        let first = product(entry("z", i.clone(), j.clone()), E::Number(1.0 / TERMS as f64));
        list.push(each(vec![put("p", i.clone(), j.clone(), first)]));
        let series = multiplied("z", entry("z", i.clone(), j.clone()), &|sum| {
            product(sum, E::Table("RECIPROCALS".into(), Index::Of("term")))
        });
        list.push(Statement::Loop("term", TERMS - 1, vec![series, copy.clone()]));
        // (1 + p)^2 = 1 + 2 p + p p
        let p = || entry("p", i.clone(), j.clone());
        let squared = multiplied("p", sum(p(), p()), &|sum| sum);
        list.push(Statement::Repeat(self.squarings as usize, vec![squared, copy]));
        let place = Index::Text(format!("{width} * i + j"));
        list.push(each(vec![Statement::Assign(Target::State("e".into(), place), p())]));
        list
    }

    #[allow(clippy::needless_range_loop)]
    fn outputs(&self, moves: &[Vec<bool>]) -> Vec<Statement> {
        let (n, width, system) = (self.n, self.width(), self.system);
        let mut list = Vec::new();
        for output in 0..system.outputs.len() {
            for column in 0..width {
                let own = match column {
                    j if j < n => Self::value(&system.p[0][output * n + j]),
                    j if j < 2 * n => Self::value(&system.p[1][output * n + j - n].map(|c| c * self.scale)),
                    j => Self::value(&system.d[output * self.inputs + j - 2 * n]),
                };
                let value = (0..n).filter(|&i| moves[i][column]).fold(own, |so_far, i| {
                    let a = E::local(format!("a{i}_{column}"));
                    match Self::value(&system.p[2][output * n + i]) {
                        Some(E::Number(p)) => Some(plus(so_far, Factor::Number(p), a)),
                        Some(p) => Some(plus(so_far, Factor::Table(p), a)),
                        None => so_far,
                    }
                });
                let place = Target::State("c".into(), Index::At(output * width + column));
                list.push(Statement::Assign(place, value.unwrap_or(E::Number(0.0))));
            }
        }
        list
    }

    fn step(&self) -> Vec<Statement> {
        let (n, width) = (self.n, self.width());
        let x = |index: Index| E::State("x".into(), index);
        let mut list = vec![Statement::Matrix("next".into(), 1, 2 * n)];
        let row = |array: &str, row: Index, so_far: &str| -> Vec<Statement> {
            // An entry of the row, by the index of a loop or by a column's number.
            let by = |column: &str| match &row {
                Index::At(0) => Index::Text(column.into()),
                Index::At(row) => Index::Text(format!("{} + {column}", row * width)),
                _ => Index::Text(format!("{width} * i + {column}")),
            };
            let at = |column: usize| match &row {
                Index::At(row) => Index::At(row * width + column),
                _ => by(&column.to_string()),
            };
            let add = |entry: Index, of: E| {
                let term = product(E::State(array.into(), entry), of);
                Statement::Assign(Target::Local(so_far.into()), sum(E::local(so_far), term))
            };
            let mut list = vec![
                Statement::Variable(so_far.into(), E::Number(0.0)),
                Statement::Loop("j", 2 * n, vec![add(by("j"), x(Index::Of("j")))]),
            ];
            list.extend((0..self.inputs).map(|u| add(at(2 * n + u), E::Input(u))));
            list
        };
        let outputs = 0..self.system.outputs.len();
        let name = |output: usize| format!("y{output}");
        outputs.clone().for_each(|output| list.extend(row("c", Index::At(output), &name(output))));
        let i = Index::Of("i");
        let mut body = row("e", i.clone(), "change");
        let next = |i: Index| Target::Entry("next".into(), Index::At(0), i);
        body.push(Statement::Assign(next(i.clone()), sum(x(i.clone()), E::local("change"))));
        list.push(Statement::Loop("i", 2 * n, body));
        let moved = Statement::Assign(Target::State("x".into(), i.clone()), E::Entry("next".into(), Index::At(0), i));
        list.push(Statement::Loop("i", 2 * n, vec![moved]));
        list.extend(outputs.map(|output| Statement::Assign(Target::Output(output), E::local(name(output)))));
        list
    }

    fn set_state(&self) -> Vec<Statement> {
        let one = |i: usize| {
            let x = |at: usize| Target::State("x".into(), Index::At(at));
            let velocity = total([(1.0 / self.scale, E::Velocity(Index::At(i)))]);
            [
                Statement::Assign(x(i), E::Displacement(Index::At(i))),
                Statement::Assign(x(self.n + i), velocity.unwrap_or(E::Number(0.0))),
            ]
        };
        (0..self.n).flat_map(one).collect()
    }

    fn get_state(&self) -> Vec<Statement> {
        let one = |i: usize| {
            let x = |at: usize| E::State("x".into(), Index::At(at));
            let velocity = total([(self.scale, x(self.n + i))]);
            [
                Statement::Assign(Target::Displacement(Index::At(i)), x(i)),
                Statement::Assign(Target::Velocity(Index::At(i)), velocity.unwrap_or(E::Number(0.0))),
            ]
        };
        (0..self.n).flat_map(one).collect()
    }
}
