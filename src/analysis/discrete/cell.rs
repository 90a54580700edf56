//! One block made discrete: what a step does to its states, in numbers of the target. Clause: spec.md, "Simulation code".

use crate::analysis::discrete::Hold;
use crate::analysis::discrete::block::{Block, Direct, clean_product, product, sum};
use crate::analysis::discrete::hold::{Propagator, propagator};
use crate::analysis::discrete::lift::{Lift, lift};
use crate::analysis::discrete::precision::{Precision, exp_minus_one};
use crate::analysis::numeric::dense::Matrix;
use crate::base::Dd;

/// What a term multiplies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Operand {
    /// An input as given.
    Input(usize),
    /// The same, but zero in the first step, which no line leads to.
    Ramped(usize),
    /// An input less its last value, zero in the first step.
    Slope(usize),
    /// A state of the built-in signals.
    Signal(usize),
}

/// A group of states and what one step does to it.
#[derive(Clone, Debug)]
pub struct Cell {
    pub name: String,
    pub form: Form,
    /// What is added to each state.
    pub input: Vec<Vec<(Operand, f64)>>,
    /// What each state adds to the outputs.
    pub output: Vec<Vec<(usize, f64)>>,
    /// Each state from displacements and velocities: one row a state.
    pub to: Vec<Vec<f64>>,
    /// Displacements and velocities from the states: one column a state.
    pub back: Vec<Vec<f64>>,
    /// The states at t = 0.
    pub start: Vec<f64>,
}

/// What one step does to the states of a cell.
#[derive(Clone, Debug, PartialEq)]
pub enum Form {
    /// x <- r x + g u
    Keep(f64),
    /// x <- x + (g u - d x)
    Lose(f64),
    /// v <- v - c v - k x + g u, x <- x + p v
    Pair(Lift),
    /// w <- w + (g u + E w), E by rows
    Dense(Vec<Vec<f64>>),
}

impl Cell {
    pub fn size(&self) -> usize {
        self.input.len()
    }
}

/// How cells are made.
pub struct Maker {
    /// s
    pub step: Dd,
    pub hold: Hold,
    pub precision: Precision,
}

/// A cell, with what the line that inputs run along does at the sample itself.
pub struct Made {
    pub cell: Cell,
    /// In the outputs: one row an output, one column an input.
    pub seen: Matrix<Dd>,
    /// In displacements and velocities.
    pub moved: Matrix<Dd>,
    to: Matrix<Dd>,
}

/// What inputs do to the states of a block.
struct Drive {
    /// In a step, as given.
    held: Matrix<Dd>,
    /// In a step, but not in the first one.
    ramped: Matrix<Dd>,
    /// At the sample itself.
    shift: Matrix<Dd>,
}

impl Maker {
    /// A block as a cell, in the form that loses least; `None` where a number is out of range.
    pub fn cell(&self, block: &Block, start: &[Dd]) -> Option<Made> {
        let propagator = propagator(&block.a, self.step)?;
        let drive = self.drive(block, &propagator);
        let same = Matrix::identity(block.size());
        let (form, s) = match block.size() {
            1 => (self.single(block)?, same),
            2 => {
                let on = |j: usize| [drive.held[(0, j)], drive.held[(1, j)]];
                let first = (0..drive.held.columns()).map(on).find(|g| g.iter().any(|x| !x.is_zero()));
                let rate = (block.a[(0, 0)] + block.a[(1, 1)]) * self.step;
                match lift(&propagator.f, rate, first, self.precision) {
                    Some(lifted) => (Form::Pair(lifted.lift), lifted.s),
                    None => (self.dense(&propagator.f), same),
                }
            }
            _ => (self.dense(&propagator.f), same),
        };
        Some(self.finish(block, form, &s, &drive, start))
    }

    /// With inputs along a line, xi_(k+1) = F xi_k + G0 u_k + G1 u_(k+1); the state is w_k = xi_k - G1 u_k, which is known
    /// before u_k is.
    fn drive(&self, block: &Block, propagator: &Propagator) -> Drive {
        let held = product(&propagator.p1, &block.b);
        match self.hold {
            Hold::Zero => {
                let none = Matrix::zeros(block.size(), block.b.columns());
                Drive { held, ramped: none.clone(), shift: none }
            }
            Hold::First => {
                let slope = Dd::ONE / self.step;
                let shift = product(&propagator.p2, &block.b).map(|x| x * slope);
                let held = sum(&held, &shift.map(|x| -x));
                Drive { held, ramped: product(&propagator.f, &shift), shift }
            }
        }
    }

    /// Each form keeps the relative error of what is small.
    fn single(&self, block: &Block) -> Option<Form> {
        let lost = -exp_minus_one(block.a[(0, 0)] * self.step)?;
        let keep = Dd::ONE - lost;
        let kept = keep.hi.abs() < 0.5;
        Some(if kept { Form::Keep(self.precision.round(keep)) } else { Form::Lose(self.precision.round(lost)) })
    }

    fn dense(&self, f: &Matrix<Dd>) -> Form {
        let n = f.rows();
        let one = |i, j| if i == j { Dd::ONE } else { Dd::ZERO };
        Form::Dense((0..n).map(|i| (0..n).map(|j| self.precision.round(f[(i, j)] - one(i, j))).collect()).collect())
    }

    fn finish(&self, block: &Block, form: Form, s: &Matrix<Dd>, drive: &Drive, start: &[Dd]) -> Made {
        let inverse = inverse(s);
        let (mut held, mut ramped) = (product(s, &drive.held), product(s, &drive.ramped));
        if let Form::Pair(lift) = &form {
            // x follows v, so it gets only what inputs do to it beyond that.
            [&mut held, &mut ramped].into_iter().for_each(|g| beyond(g, Dd::from(lift.p)));
        }
        let (c, back) = (clean_product(&block.c, &inverse), clean_product(&block.back, &inverse));
        let to = clean_product(s, &block.to);
        let size = block.size();
        let round = |x: Dd| self.precision.round(x);
        let input = (0..size).map(|i| rounded_terms(&input_terms(&held, &ramped, i), self.precision)).collect();
        let output = (0..size).map(|j| {
            let row = (0..c.rows()).map(|i| (i, round(c[(i, j)])));
            row.filter(|(_, value)| *value != 0.0).collect()
        });
        let at_start = product(&to, &Matrix::from_fn(start.len(), 1, |i, _| start[i]));
        let cell = Cell {
            name: block.name.clone(),
            form,
            input,
            output: output.collect(),
            to: (0..size).map(|i| (0..to.columns()).map(|j| round(to[(i, j)])).collect()).collect(),
            back: (0..size).map(|j| back.column(j).iter().map(|&x| round(x)).collect()).collect(),
            start: (0..size).map(|i| round(at_start[(i, 0)])).collect(),
        };
        let seen = product(&block.c, &drive.shift);
        Made { cell, seen, moved: product(&block.back, &drive.shift), to }
    }

    /// What outputs see at once, before the blocks' lines are added.
    pub fn direct(&self, direct: &Direct) -> Vec<Vec<(Operand, Dd)>> {
        let [d0, d1, _] = &direct.outputs;
        let slope = Dd::ONE / self.step;
        let row = |i: usize| {
            let at_once = (0..d0.columns()).map(|j| (Operand::Input(j), d0[(i, j)]));
            let slopes = (0..d1.columns()).map(|j| (Operand::Slope(j), d1[(i, j)] * slope));
            let first = self.hold == Hold::First;
            at_once.chain(slopes.filter(|_| first)).collect()
        };
        (0..d0.rows()).map(row).collect()
    }

    /// Adds what outputs see of the lines.
    pub fn see_ramp(&self, direct: &mut [Vec<(Operand, Dd)>], seen: &Matrix<Dd>) {
        for (i, row) in direct.iter_mut().enumerate() {
            for j in 0..seen.columns() {
                let value = seen[(i, j)];
                match row.iter_mut().find(|(operand, _)| *operand == Operand::Ramped(j)) {
                    Some((_, sum)) => *sum += value,
                    None if !value.is_zero() => row.push((Operand::Ramped(j), value)),
                    None => {}
                }
            }
        }
    }

    /// Rows as numbers of the target, without zeros.
    pub fn offset(&self, of: &Matrix<Dd>) -> Vec<Vec<(usize, f64)>> {
        (0..of.rows()).map(|i| self.rounded(|j| of[(i, j)], of.columns())).collect()
    }

    /// What the last inputs take from the states: to E0.
    pub fn state_offset(&self, made: &Made, direct: &Direct) -> Vec<Vec<(usize, f64)>> {
        let taken = product(&made.to, &direct.state[0]);
        (0..taken.rows()).map(|i| self.rounded(|j| taken[(i, j)], taken.columns())).collect()
    }

    fn rounded(&self, of: impl Fn(usize) -> Dd, count: usize) -> Vec<(usize, f64)> {
        (0..count).map(|j| (j, self.precision.round(of(j)))).filter(|(_, value)| *value != 0.0).collect()
    }
}

/// The first row less p times the second.
fn beyond(g: &mut Matrix<Dd>, p: Dd) {
    for j in 0..g.columns() {
        let follows = p * g[(1, j)];
        let rest = g[(0, j)] - follows;
        // Coordinates were chosen to make it zero.
        let nothing = rest.hi.abs() <= 1e-20 * (g[(0, j)].hi.abs() + follows.hi.abs());
        g[(0, j)] = if nothing { Dd::ZERO } else { rest };
    }
}

fn input_terms(g: &Matrix<Dd>, ramped: &Matrix<Dd>, state: usize) -> Vec<(Operand, Dd)> {
    let held = (0..g.columns()).map(|j| (Operand::Input(j), g[(state, j)]));
    held.chain((0..ramped.columns()).map(|j| (Operand::Ramped(j), ramped[(state, j)]))).collect()
}

/// Terms as numbers of the target, without zeros.
pub fn rounded_terms(terms: &[(Operand, Dd)], precision: Precision) -> Vec<(Operand, f64)> {
    let rounded = terms.iter().map(|&(operand, value)| (operand, precision.round(value)));
    rounded.filter(|(_, value)| *value != 0.0).collect()
}

/// The inverse of a matrix of one or two rows, or of the identity.
fn inverse(s: &Matrix<Dd>) -> Matrix<Dd> {
    match s.rows() {
        2 => {
            let det = s[(0, 0)] * s[(1, 1)] - s[(0, 1)] * s[(1, 0)];
            let entry = |i: usize, j: usize| if i == j { s[(1 - i, 1 - j)] } else { -s[(i, j)] };
            Matrix::from_fn(2, 2, |i, j| entry(i, j) / det)
        }
        n => Matrix::identity(n),
    }
}
