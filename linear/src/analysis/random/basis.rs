//! A system restricted to some of its motions: q = B y with an exact B, whose columns are not coupled with the rest of
//! the system. In: a system, and the coordinates that are kept or columns of fractions. Out: the system of y, with the
//! same inputs and outputs. See docs/method/random.md#undamped-motions.

use crate::base::{Number, Rational};
use crate::system::{ByRate, CoordinateId, Form, Input, LinearSystem, Losses, Output};

type Row = Vec<(CoordinateId, Number)>;

/// The rows of B: the part of each coordinate in y.
pub struct Basis {
    rows: Vec<Row>,
    /// For each entry of y, the coordinate that it is named after.
    leading: Vec<usize>,
}

impl Basis {
    /// Coordinates, ascending.
    pub fn of_coordinates(n: usize, kept: &[usize]) -> Basis {
        let mut rows = vec![Vec::new(); n];
        for (place, &i) in kept.iter().enumerate() {
            rows[i].push((CoordinateId(place as u32), Number::ONE));
        }
        Basis { rows, leading: kept.to_vec() }
    }

    /// Columns of fractions, at most as many as coordinates.
    pub fn of_columns(n: usize, columns: &[Vec<Rational>]) -> Basis {
        let entries = |i: usize| {
            let all = columns.iter().enumerate().filter(|(_, column)| !column[i].is_zero());
            all.map(|(place, column)| (CoordinateId(place as u32), Number::from(column[i].clone()))).collect()
        };
        Basis { rows: (0..n).map(entries).collect(), leading: (0..columns.len()).collect() }
    }

    /// a^T B, without zeros.
    pub fn row(&self, row: &[(CoordinateId, Number)]) -> Row {
        let mut sums: Row = Vec::new();
        for (i, a) in row {
            for (j, b) in &self.rows[i.index()] {
                let product = a * b;
                match sums.iter_mut().find(|(known, _)| known == j) {
                    Some((_, sum)) => *sum = &*sum + &product,
                    None => sums.push((*j, product)),
                }
            }
        }
        sums.retain(|(_, sum)| !sum.is_zero());
        sums
    }

    pub fn output(&self, output: &Output) -> Output {
        Output { p: output.p.each_ref().map(|row| self.row(row)), ..output.clone() }
    }

    pub fn system(&self, system: &LinearSystem) -> LinearSystem {
        let input =
            |input: &Input| Input { b: input.b.each_ref().map(|row| self.row(row)), undamped: None, ..input.clone() };
        LinearSystem {
            words: system.words.clone(),
            coordinates: self.leading.iter().map(|&i| system.coordinates[i].clone()).collect(),
            m: self.form(&system.m),
            c: self.form(&system.c),
            k: self.form(&system.k),
            chain: Vec::new(),
            inputs: system.inputs.iter().map(input).collect(),
            outputs: system.outputs.iter().map(|output| self.output(output)).collect(),
            initial: Vec::new(),
            losses: system.losses.as_deref().and_then(|losses| self.losses(losses)).map(Box::new),
        }
    }

    /// `None` if no spring on these motions has a loss factor.
    fn losses(&self, losses: &Losses) -> Option<Losses> {
        let mut h = Form::new();
        for term in losses.h.terms() {
            let row = self.row(&losses.h.row(term).to_vec());
            if !row.is_empty() {
                let source = h.source(losses.h.source_of(term.source));
                h.push(source, term.nature, term.weight.clone(), row);
            }
        }
        let rows = |rows: &[Row]| rows.iter().map(|row| self.row(row)).collect();
        let is_there = !h.is_empty();
        let by_rate = losses.by_rate.iter().map(|part| ByRate { b: self.row(&part.b), ..part.clone() }).collect();
        is_there.then(|| Losses { h, b: rows(&losses.b), p: rows(&losses.p), d: losses.d.clone(), by_rate })
    }

    fn form(&self, form: &Form) -> Form {
        let mut own = Form::new();
        for term in form.terms() {
            let source = own.source(form.source_of(term.source));
            own.push(source, term.nature, term.weight.clone(), self.row(&form.row(term).to_vec()));
        }
        own
    }
}
