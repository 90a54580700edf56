//! Discretisation of one block: the effect of a step on its states, in numbers of the target. See docs/method/emit.md.

use crate::analysis::discrete::Hold;
use crate::analysis::discrete::block::{Block, Direct, NOTHING, clean_product, product, sum};
use crate::analysis::discrete::hold::{Propagator, exponential, propagator};
use crate::analysis::discrete::lift::{Lift, lift};
use crate::analysis::discrete::pieces::Chain;
use crate::analysis::discrete::precision::{Precision, exp_minus_one};
use crate::analysis::discrete::turn::{Turn, turn};
use crate::base::Dd;
use crate::kernel::dense::Matrix;

/// The factor that a coefficient multiplies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Operand {
    /// An input, by its index among those given from outside.
    Input(usize),
    /// An input that is zero in the first step, because there is no earlier sample to interpolate from.
    Ramped(usize),
    /// An input minus its last value; zero in the first step.
    Slope(usize),
    /// A state of the built-in signals.
    Signal(usize),
}

/// A group of states and the effect of one step on it.
#[derive(Clone, Debug)]
pub struct Cell {
    pub name: String,
    pub form: Form,
    /// Terms that are added to each state.
    pub input: Vec<Vec<(Operand, f64)>>,
    /// Contributions of each state to the outputs, which ascend.
    pub output: Vec<Vec<(usize, f64)>>,
    /// Each state from displacements and velocities: one row for each state; empty for signals, and for many states.
    pub to: Vec<Vec<f64>>,
    /// Displacements and velocities from the states: one column for each state; empty likewise.
    pub back: Vec<Vec<f64>>,
    /// The states at t = 0.
    pub start: Vec<f64>,
}

/// The effect of one step on the states of a cell.
#[derive(Clone, Debug, PartialEq)]
pub enum Form {
    /// x <- r x + g u
    Keep(f64),
    /// x <- x + (g u - d x)
    Lose(f64),
    /// v <- v - c v - k x + g u, x <- x + p v
    Pair(Lift),
    /// w <- w + (g u + E w), E by rows; if the motion turns by more than a quarter of a period, w <- (g u + E w) - w
    Dense { turned: bool, rows: Vec<Vec<f64>> },
}

impl Cell {
    /// What a state contributes to an output.
    pub fn contribution(&self, state: usize, output: usize) -> Option<f64> {
        let row = &self.output[state];
        row.binary_search_by_key(&output, |(seen, _)| *seen).ok().map(|at| row[at].1)
    }

    pub fn size(&self) -> usize {
        self.input.len()
    }

    /// Whether all coefficients are finite.
    pub fn is_finite(&self) -> bool {
        let all = |numbers: &[f64]| numbers.iter().all(|x| x.is_finite());
        let form = match &self.form {
            Form::Keep(x) | Form::Lose(x) => x.is_finite(),
            Form::Pair(lift) => all(&[lift.decay.value(), lift.k, lift.p]),
            Form::Dense { rows, .. } => rows.iter().all(|row| all(row)),
        };
        let input = self.input.iter().flatten().all(|(_, value)| value.is_finite());
        let output = self.output.iter().flatten().all(|(_, value)| value.is_finite());
        form && input && output && self.to.iter().chain(&self.back).chain([&self.start]).all(|table| all(table))
    }
}

/// Options and signals for making cells.
pub struct Maker<'a> {
    /// Step size, s.
    pub step: Dd,
    pub hold: Hold,
    pub precision: Precision,
    /// Indices of the inputs that are given from outside.
    pub given: Vec<usize>,
    pub chains: &'a [Chain],
    /// Whether cells keep their relation to the model's coordinates.
    pub tabled: bool,
}

/// One step in the block's own coordinates, and the cell's coordinates from these.
struct Stepped {
    s: Matrix<Dd>,
    f: Matrix<Dd>,
}

/// The effects of operands, one column each.
type Columns = Vec<(Operand, Vec<Dd>)>;

/// A cell before rounding: w' = F w + the contributions of signals.
#[derive(Clone, Debug)]
pub struct ExactCell {
    pub f: Matrix<Dd>,
    /// One list for each state.
    pub input: Vec<Vec<(Operand, Dd)>>,
}

/// A cell, with the quantities that depend on its coordinates.
pub struct Made {
    pub cell: Cell,
    /// The transformation from the block's states to the cell's.
    pub s: Matrix<Dd>,
    /// With linear interpolation, the direct effect of an input at the sample itself: on outputs, and on displacements
    /// and velocities.
    pub seen: Columns,
    pub moved: Columns,
    to: Matrix<Dd>,
    /// The outputs as rows over the states.
    pub c: Matrix<Dd>,
    pub exact: ExactCell,
    pub start: Vec<Dd>,
}

/// A signal's states as a cell.
pub struct MadeSignal {
    pub cell: Cell,
    pub s: Matrix<Dd>,
    inverse: Matrix<Dd>,
    /// Index of the first of its states among all signals'.
    pub first: usize,
    /// Whether events set its states: true for those of a polynomial, not for those of a harmonic.
    pub set: bool,
    pub exact: ExactCell,
    pub start: Vec<Dd>,
}

impl Maker<'_> {
    /// Makes a cell of a block, in the form that loses fewest digits; `None` if a number is out of range.
    pub fn cell(&self, block: &Block, signals: &[MadeSignal], start: &[Dd]) -> Option<Made> {
        let propagator = propagator(&block.a, self.step)?;
        let (mut drive, shift) = self.drive(block, &propagator);
        for (chain, signal) in self.chains.iter().zip(signals) {
            let effect = product(&chain.effect_on(block, Dd::ONE, self.step)?, &signal.inverse);
            drive.extend((0..chain.size()).map(|k| (Operand::Signal(signal.first + k), effect.column(k).to_vec())));
        }
        drive.retain(|(_, column)| column.iter().any(|x| !x.is_zero()));
        let same = Matrix::identity(block.size());
        let (form, s, f) = match block.size() {
            1 => (self.single(block)?, same, propagator.f),
            2 => {
                let first = drive.first().map(|(_, column)| [column[0], column[1]]);
                let turn = turn(&block.a.map(|x| x * self.step), None)?;
                let (form, s) = self.pair(&turn, first);
                (form, s, turn.whole())
            }
            _ => (self.dense(&propagator.f), same, propagator.f),
        };
        self.finish(block, form, Stepped { s, f }, &drive, &shift, start)
    }

    /// The effects of inputs in a step, and at the sample itself. With linear interpolation, xi_(k+1) = F xi_k + G0 u_k
    /// + G1 u_(k+1); the state is w_k = xi_k - G1 u_k, which is known before u_k is.
    fn drive(&self, block: &Block, propagator: &Propagator) -> (Columns, Columns) {
        let held = product(&propagator.p1, &block.b);
        let columns = |m: &Matrix<Dd>, operand: fn(usize) -> Operand| -> Columns {
            self.given.iter().enumerate().map(|(at, &j)| (operand(at), m.column(j).to_vec())).collect()
        };
        match self.hold {
            Hold::Zero => (columns(&held, Operand::Input), Columns::new()),
            Hold::First => {
                let slope = Dd::ONE / self.step;
                let shift = product(&propagator.p2, &block.b).map(|x| x * slope);
                let mut drive = columns(&sum(&held, &shift.map(|x| -x)), Operand::Input);
                drive.extend(columns(&product(&propagator.f, &shift), Operand::Ramped));
                (drive, columns(&shift, Operand::Ramped))
            }
        }
    }

    /// The form of a single state. Each form keeps the relative accuracy of small numbers.
    fn single(&self, block: &Block) -> Option<Form> {
        let lost = -exp_minus_one(block.a[(0, 0)] * self.step)?;
        let keep = Dd::ONE - lost;
        let kept = keep.hi.abs() < 0.5;
        Some(if kept { Form::Keep(self.precision.round(keep)) } else { Form::Lose(self.precision.round(lost)) })
    }

    /// The form of two states, with their coordinates: lifted, or dense if lifting would lose digits.
    fn pair(&self, turn: &Turn, drive: Option<[Dd; 2]>) -> (Form, Matrix<Dd>) {
        match lift(turn, drive, self.precision) {
            Some(lifted) => (Form::Pair(lifted.lift), lifted.s),
            None => {
                let sign = if turn.turned { -Dd::ONE } else { Dd::ONE };
                let rows = self.round(&turn.change.map(|x| sign * x));
                (Form::Dense { turned: turn.turned, rows }, Matrix::identity(2))
            }
        }
    }

    fn dense(&self, f: &Matrix<Dd>) -> Form {
        let one = |i, j| if i == j { Dd::ONE } else { Dd::ZERO };
        let change = Matrix::from_fn(f.rows(), f.rows(), |i, j| f[(i, j)] - one(i, j));
        Form::Dense { turned: false, rows: self.round(&change) }
    }

    fn round(&self, m: &Matrix<Dd>) -> Vec<Vec<f64>> {
        (0..m.rows()).map(|i| (0..m.columns()).map(|j| self.precision.round(m[(i, j)])).collect()).collect()
    }

    fn finish(
        &self,
        block: &Block,
        form: Form,
        Stepped { s, f }: Stepped,
        drive: &Columns,
        shift: &Columns,
        start: &[Dd],
    ) -> Option<Made> {
        let inverse = inverse(&s);
        let mut drive = transform(&s, drive);
        let by_state = |drive: &Columns, i: usize| {
            drive.iter().map(|(operand, column)| (*operand, column[i])).filter(|(_, g)| !g.is_zero()).collect()
        };
        let input = (0..block.size()).map(|i| by_state(&drive, i)).collect();
        if let Form::Pair(lift) = &form {
            // x follows v, so only the remaining effect of inputs is added to it.
            drive.iter_mut().for_each(|(_, column)| subtract_multiple(column, Dd::from(lift.p)));
        }
        let (c, back) = (clean_product(&block.c, &inverse), clean_product(&block.back, &inverse));
        let to = clean_product(&s, &block.to);
        let size = block.size();
        let round = |x: Dd| self.precision.round(x);
        let output = (0..size).map(|j| {
            let row = (0..c.rows()).map(|i| (i, round(c[(i, j)])));
            row.filter(|(_, value)| *value != 0.0).collect()
        });
        let most = |numbers: &[Dd]| numbers.iter().map(|x| x.hi.abs()).fold(0.0, f64::max);
        // If a motion does not start in this block, what is left here is rounding error.
        let nothing = NOTHING * most(to.data()) * most(start);
        let at_start = product(&to, &Matrix::from_fn(start.len(), 1, |i, _| start[i]));
        let at_start = at_start.map(|x| if x.hi.abs() <= nothing { Dd::ZERO } else { x });
        let driven = drive.iter().flat_map(|(_, column)| column.iter().copied());
        let kept = self.precision.keeps(driven)
            && [&to, &back, &at_start].into_iter().all(|m| self.precision.keeps(m.data().iter().copied()));
        if !kept {
            return None;
        }
        let tabled = if self.tabled { size } else { 0 };
        let cell = Cell {
            name: block.name.clone(),
            form,
            input: (0..size).map(|i| self.terms(&drive, i)).collect(),
            output: output.collect(),
            to: (0..tabled).map(|i| (0..to.columns()).map(|j| round(to[(i, j)])).collect()).collect(),
            back: (0..tabled).map(|j| back.column(j).iter().map(|&x| round(x)).collect()).collect(),
            start: (0..size).map(|i| round(at_start[(i, 0)])).collect(),
        };
        let (seen, moved) = (transform(&block.c, shift), transform(&block.back, shift));
        let f = product(&s, &product(&f, &inverse));
        let exact = ExactCell { f, input };
        let start = at_start.column(0).to_vec();
        Some(Made { cell, s, seen, moved, to, c, exact, start })
    }

    /// Makes a cell of a signal's states; `first` is their index among those of all signals.
    pub fn signal(&self, chain: &Chain, first: usize) -> Option<MadeSignal> {
        let size = chain.size();
        let (form, s, f) = match chain.angle {
            Some(angle) => {
                let turn = turn(&chain.generator, Some(angle))?;
                let (form, s) = self.pair(&turn, None);
                (form, s, turn.whole())
            }
            None => {
                let f = exponential(chain.generator.clone())?;
                (self.dense(&f), Matrix::identity(size), f)
            }
        };
        let at_start = product(&s, &Matrix::from_fn(size, 1, |i, _| chain.start[i]));
        let cell = Cell {
            name: chain.name.clone(),
            form,
            input: vec![Vec::new(); size],
            output: vec![Vec::new(); size],
            to: Vec::new(),
            back: Vec::new(),
            start: at_start.column(0).iter().map(|&x| self.precision.round(x)).collect(),
        };
        let inverse = inverse(&s);
        let f = product(&s, &product(&f, &inverse));
        let exact = ExactCell { f, input: vec![Vec::new(); size] };
        let start = at_start.column(0).to_vec();
        Some(MadeSignal { cell, s, inverse, first, set: chain.angle.is_none(), exact, start })
    }

    /// Rows over inputs, their slopes and the signals' states, from factors of u, u' and u''.
    pub fn rows(&self, factors: &[Matrix<Dd>], signals: &[MadeSignal]) -> Vec<Vec<(Operand, Dd)>> {
        let slope = Dd::ONE / self.step;
        let row = |i: usize| {
            let given = || self.given.iter().enumerate();
            let mut row: Vec<(Operand, Dd)> =
                given().map(|(at, &j)| (Operand::Input(at), factors[0][(i, j)])).collect();
            if self.hold == Hold::First {
                row.extend(given().map(|(at, &j)| (Operand::Slope(at), factors[1][(i, j)] * slope)));
            }
            for (chain, signal) in self.chains.iter().zip(signals) {
                let of = |k: usize| {
                    let powers = factors.iter().zip(&chain.rows);
                    powers.fold(Dd::ZERO, |sum, (m, row)| sum + m[(i, chain.input)] * row[k])
                };
                let own = Matrix::from_fn(1, chain.size(), |_, k| of(k));
                let own = clean_product(&own, &signal.inverse);
                row.extend((0..chain.size()).map(|k| (Operand::Signal(signal.first + k), own[(0, k)])));
            }
            row
        };
        (0..factors[0].rows()).map(row).collect()
    }

    /// The part of a cell's states that is due to inputs and signals: to (E0 u + E1 u').
    pub fn input_contributions(
        &self,
        made: &Made,
        direct: &Direct,
        signals: &[MadeSignal],
    ) -> Vec<Vec<(Operand, f64)>> {
        let factors = [&direct.state[0], &direct.state[1]].map(|e| clean_product(&made.to, e));
        let rows = self.rows(&factors, signals);
        rows.iter().map(|row| rounded_terms(row, self.precision)).collect()
    }

    /// A state's terms in numbers of the target.
    fn terms(&self, columns: &Columns, state: usize) -> Vec<(Operand, f64)> {
        let terms: Vec<(Operand, Dd)> = columns.iter().map(|(operand, column)| (*operand, column[state])).collect();
        rounded_terms(&terms, self.precision)
    }
}

/// Adds columns to rows of terms.
pub fn add_columns(rows: &mut [Vec<(Operand, Dd)>], columns: &Columns) {
    for (operand, column) in columns {
        for (row, &value) in rows.iter_mut().zip(column).filter(|(_, value)| !value.is_zero()) {
            match row.iter_mut().find(|(known, _)| known == operand) {
                Some((_, sum)) => *sum += value,
                None => row.push((*operand, value)),
            }
        }
    }
}

fn transform(s: &Matrix<Dd>, columns: &Columns) -> Columns {
    let image = |column: &Vec<Dd>| {
        let column = Matrix::from_fn(column.len(), 1, |i, _| column[i]);
        clean_product(s, &column).column(0).to_vec()
    };
    columns.iter().map(|(operand, column)| (*operand, image(column))).collect()
}

/// Subtracts p times the second row from the first.
fn subtract_multiple(column: &mut [Dd], p: Dd) {
    let follows = p * column[1];
    let rest = column[0] - follows;
    // Coordinates were chosen to make this zero.
    let nothing = rest.hi.abs() <= 1e-20 * (column[0].hi.abs() + follows.hi.abs());
    column[0] = if nothing { Dd::ZERO } else { rest };
}

/// Terms in numbers of the target, without zeros.
pub fn rounded_terms(terms: &[(Operand, Dd)], precision: Precision) -> Vec<(Operand, f64)> {
    let rounded = terms.iter().map(|&(operand, value)| (operand, precision.round(value)));
    rounded.filter(|(_, value)| *value != 0.0).collect()
}

/// The inverse of a matrix of two rows, or of an identity matrix.
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
