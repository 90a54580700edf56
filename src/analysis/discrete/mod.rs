//! The exact discrete system that emitted code runs: the states of independent blocks, what one step does to each, what
//! inputs add and what outputs see. In: a linear system, its modes, the signals built in, a step. Out: a value that a back
//! end only prints. Everything is computed in double-double and rounded once, to the precision of the target. See
//! docs/method/emit.md.
//!
//! # Steps
//! 1. [`modal`] or [`invariant`]: the continuous system as independent blocks
//! 2. [`reduce`]: what no input reaches, no output sees or the tolerance allows to leave out
//! 3. [`hold`], [`lift`]: one step of each block, in the form that loses least
//! 4. [`rounding`]: what the target's rounding can do at most; [`beside`]: what it does where the run is known

mod beside;
pub mod block;
pub mod cell;
pub mod equations;
mod events;
pub mod hold;
pub mod invariant;
pub mod lift;
pub mod modal;
pub mod parameter;
mod pieces;
pub mod precision;
pub mod reduce;
pub mod rounding;
pub mod signals;
mod turn;

pub use cell::{Cell, Form, Operand};
pub use lift::{Decay, Lift};
pub use precision::Precision;
pub use reduce::{Left, Why};
pub use rounding::Rounding;
pub use signals::Signals;

use crate::analysis::answer::Modes;
use crate::analysis::discrete::beside::Exact;
use crate::analysis::discrete::block::{Direct, Split};
use crate::analysis::discrete::cell::{Maker, add_columns, rounded_terms};
use crate::analysis::discrete::events::Fault;
use crate::analysis::discrete::turn::too_far;
use crate::analysis::error::AnalysisError;
use crate::analysis::numeric::dense::Matrix;
use crate::analysis::poles::poles;
use crate::base::{Dd, Number};
use crate::system::{CoordinateKind, LinearSystem, Signal};

/// What an input does between samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hold {
    /// It stays as it was at the sample.
    Zero,
    /// It runs along a line to its next value.
    First,
}

/// What is wanted.
#[derive(Clone, Debug)]
pub struct Options {
    /// s
    pub step: Number,
    pub hold: Hold,
    pub precision: Precision,
    /// Modes that contribute less than this share of an output are left out; `None`: none are.
    pub tolerance: Option<f64>,
    /// Everything is kept, also what no input reaches.
    pub unpruned: bool,
    /// Whether the model's signals are built into the state.
    pub built_in: bool,
    /// Signals built into the state, for each input; inputs without any stay inputs. Empty: none are built in.
    pub internal: Vec<Vec<Signal>>,
    /// The end of the motion, s, where it is known: what happens later is left out.
    pub until: Option<Number>,
}

/// An input, an output or a coordinate.
#[derive(Clone, Debug, PartialEq)]
pub struct Port {
    pub name: String,
    pub unit: String,
}

/// A change of all states, in the order of the cells, at a sample.
#[derive(Clone, Debug)]
pub struct Event {
    pub tick: u64,
    /// What is added to each state, or what it is set to.
    pub change: Vec<f64>,
}

/// The discrete system.
#[derive(Clone, Debug)]
pub struct DiscreteSystem {
    pub coordinates: Vec<Port>,
    /// Units of the coordinates' velocities.
    pub rates: Vec<&'static str>,
    pub inputs: Vec<Port>,
    pub outputs: Vec<Port>,
    /// s
    pub step: f64,
    pub hold: Hold,
    pub precision: Precision,
    pub tolerance: Option<f64>,
    pub method: &'static str,
    pub cells: Vec<Cell>,
    /// What each output sees at once.
    pub direct: Vec<Vec<(Operand, f64)>>,
    /// Displacements, then velocities, of all coordinates: what the last inputs and the signals add.
    pub offset: Vec<Vec<(Operand, f64)>>,
    /// What the last inputs and the signals take from a state that is set: one row a state that is not a signal's.
    pub taken: Vec<Vec<(Operand, f64)>>,
    /// How many of the cells, the first ones, are those of signals.
    pub signals: usize,
    /// What happens to all states at certain samples, ascending.
    pub events: Vec<Event>,
    /// For each state, whether events set it, not add to it.
    pub set: Vec<bool>,
    /// Outputs that would follow the derivative of an input, which an input that is held does not have.
    pub without_slope: Vec<usize>,
    pub left: Vec<Left>,
    pub rounding: Rounding,
    /// What rounding does to code without inputs, as it runs from its start.
    pub measured: Vec<Measured>,
}

/// A bound of the outputs' errors by rounding over so many steps, beside the largest value of each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    pub steps: u64,
    pub error: f64,
}

impl DiscreteSystem {
    /// Number of states.
    pub fn states(&self) -> usize {
        self.cells.iter().map(Cell::size).sum()
    }

    /// Whether all of its numbers are numbers.
    fn is_finite(&self) -> bool {
        let rows = [&self.direct, &self.offset, &self.taken].into_iter().flatten().flatten().map(|(_, value)| *value);
        let changes = self.events.iter().flat_map(|event| &event.change).copied();
        rows.chain(changes).chain(self.cells.iter().flat_map(Cell::numbers)).all(f64::is_finite)
    }

    /// Whether the last inputs are part of the state.
    pub fn remembers(&self) -> bool {
        let last = |operand: &Operand| matches!(operand, Operand::Input(_) | Operand::Ramped(_));
        let kept = self.offset.iter().chain(&self.taken).flatten().any(|(operand, _)| last(operand));
        kept || self.uses(|operand| matches!(operand, Operand::Slope(_)))
    }

    /// Whether the first step differs from the others, as inputs that are interpolated have nothing before them.
    pub fn ramps(&self) -> bool {
        self.uses(|o| matches!(o, Operand::Ramped(_) | Operand::Slope(_)))
    }

    /// Whether a term of the step has such an operand.
    pub fn uses(&self, which: impl Fn(&Operand) -> bool) -> bool {
        let in_cells = self.cells.iter().flat_map(|cell| cell.input.iter().flatten());
        in_cells.chain(self.direct.iter().flatten()).any(|(operand, _)| which(operand))
    }
}

/// Beyond this the tables of the states in the model's coordinates fill files.
pub const MOST_STATES: usize = 800;

/// The discrete system of a model.
pub fn discretise(system: &LinearSystem, modes: &Modes, options: &Options) -> Result<DiscreteSystem, AnalysisError> {
    let n = system.n();
    if 2 * n > MOST_STATES {
        return Err(AnalysisError::too_many_states(system, 2 * n, MOST_STATES));
    }
    let mut split = split(system, modes)?;
    let start = start(system);
    let signals = Signals::of(&options.internal, &options.step, options.until.as_ref())
        .map_err(|long| AnalysisError::signal_too_long(system, long.input))?;
    if let Some(input) = signals.blow_on_base(system) {
        return Err(AnalysisError::blow_on_base(system, input));
    }
    let left = reduce::reduce(&mut split, &start, options);
    let signals = signals.useful(|input| split.feels(input));
    let step = options.step.to_ball().mid;
    let turning = split.blocks.iter().any(|block| block.a.rows() == 2 && too_far(&block.a.map(|x| x * step)));
    if turning || signals.chains.iter().any(|chain| chain.angle.is_some() && too_far(&chain.generator)) {
        return Err(AnalysisError::step_too_long(system));
    }
    let driven = |j: &usize| options.internal.get(*j).is_some_and(|list| !list.is_empty());
    let given: Vec<usize> = (0..system.inputs.len()).filter(|j| !driven(j)).collect();
    let maker =
        Maker { step, hold: options.hold, precision: options.precision, given: given.clone(), chains: &signals.chains };
    let out_of_range = || AnalysisError::code_out_of_range(system, options.precision.name());
    let mut first = 0;
    let mut made_signals = Vec::with_capacity(signals.chains.len());
    for chain in &signals.chains {
        made_signals.push(maker.signal(chain, first).ok_or_else(out_of_range)?);
        first += chain.size();
    }
    let mut direct = maker.rows(&split.direct.outputs, &made_signals);
    let mut offset = maker.rows(&split.direct.state, &made_signals);
    let mut made = Vec::with_capacity(split.blocks.len());
    for block in &split.blocks {
        let cell = maker.cell(block, &made_signals, &start).ok_or_else(out_of_range)?;
        add_columns(&mut direct, &cell.seen);
        add_columns(&mut offset, &cell.moved);
        made.push(cell);
    }
    let seen = |i: usize| {
        let at_once = direct[i].iter().map(|&(_, value)| value);
        at_once
            .chain(made.iter().flat_map(move |made| (0..made.c.columns()).map(|j| made.c[(i, j)]).collect::<Vec<Dd>>()))
    };
    if !(0..system.outputs.len()).all(|i| options.precision.keeps(seen(i))) {
        return Err(out_of_range());
    }
    let taken = made.iter().flat_map(|made| maker.taken(made, &split.direct, &made_signals)).collect();
    let changes = events::changes(&signals, &split.blocks, &made_signals, &made, |j| split.direct.seen(j), step);
    let changes = changes.map_err(|fault| match fault {
        Fault::TooMany { input } => AnalysisError::signal_too_long(system, input),
        Fault::OutOfRange => out_of_range(),
    })?;
    let made_start = made_signals.iter().map(|made| &made.start).chain(made.iter().map(|made| &made.start));
    let mut start: Vec<Dd> = made_start.flatten().copied().collect();
    let exact_cells = made_signals.iter().map(|made| &made.exact).chain(made.iter().map(|made| &made.exact));
    let exact_cells = exact_cells.cloned().collect();
    let bounds = signals.chains.iter().map(|chain| chain.spread()).collect::<Vec<_>>();
    let mut set: Vec<bool> = made_signals.iter().flat_map(|made| vec![made.set; made.cell.size()]).collect();
    let mut cells: Vec<Cell> = made_signals.into_iter().map(|made| made.cell).collect();
    let signal_cells = cells.len();
    cells.extend(made.into_iter().map(|made| made.cell));
    set.resize(cells.iter().map(Cell::size).sum(), false);
    let (events, exact_events) = events::after_start(changes, &set, &mut start, options.precision);
    let places = cells.iter_mut().flat_map(|cell| &mut cell.start);
    places.zip(&start).for_each(|(place, &state)| *place = options.precision.round(state));
    let rounding = rounding::rounding(&cells, &bounds, options.precision);
    let exact = Exact { cells: exact_cells, start, events: exact_events };
    let round = |row: Vec<(Operand, Dd)>| rounded_terms(&row, options.precision);
    let slopes = &split.direct.outputs[1];
    let without_slope = (0..system.outputs.len()).filter(|&i| {
        let row = |m: &Matrix<Dd>| given.iter().any(|&j| !m[(i, j)].is_zero());
        row(&split.direct.outputs[2]) || options.hold == Hold::Zero && row(slopes)
    });
    let mut discrete = DiscreteSystem {
        coordinates: coordinates(system),
        rates: system.coordinates.iter().map(|c| rate_unit(c.kind)).collect(),
        inputs: (given.iter().map(|&j| &system.inputs[j]))
            .map(|input| Port { name: system.display(input.name), unit: input.unit.to_string() })
            .collect(),
        outputs: (system.outputs.iter())
            .map(|output| Port { name: system.display(output.name), unit: output.unit.clone() })
            .collect(),
        step: options.step.to_f64(),
        hold: options.hold,
        precision: options.precision,
        tolerance: options.tolerance,
        method: split.method,
        without_slope: without_slope.collect(),
        cells,
        direct: direct.into_iter().map(round).collect(),
        offset: offset.into_iter().map(round).collect(),
        taken,
        signals: signal_cells,
        events,
        set,
        left,
        rounding,
        measured: Vec::new(),
    };
    if !discrete.is_finite() {
        return Err(out_of_range());
    }
    if discrete.inputs.is_empty() {
        let last = options.until.as_ref().map(|until| (until / &options.step).to_f64() as u64);
        discrete.measured = beside::measured(&discrete, &exact, last);
    }
    Ok(discrete)
}

fn split(system: &LinearSystem, modes: &Modes) -> Result<Split, AnalysisError> {
    match modal::split(system, modes) {
        Some(split) => Ok(split),
        None => invariant::split(system, &poles(system, modes)?),
    }
}

fn coordinates(system: &LinearSystem) -> Vec<Port> {
    let unit = |kind| match kind {
        CoordinateKind::Translation => "m",
        CoordinateKind::Rotation => "rad",
    };
    (system.coordinates.iter()).map(|c| Port { name: system.display(c.name), unit: unit(c.kind).to_string() }).collect()
}

fn rate_unit(kind: CoordinateKind) -> &'static str {
    match kind {
        CoordinateKind::Translation => "m/s",
        CoordinateKind::Rotation => "rad/s",
    }
}

/// Displacements and velocities at t = 0.
fn start(system: &LinearSystem) -> Vec<Dd> {
    let n = system.n();
    let mut start = vec![Dd::ZERO; 2 * n];
    for (i, displacement, velocity) in &system.initial {
        start[i.index()] = displacement.to_ball().mid;
        start[n + i.index()] = velocity.to_ball().mid;
    }
    start
}

/// The feed-through that the system declares.
fn direct_of(system: &LinearSystem) -> Direct {
    let mut direct = Direct::none(system.n(), system.inputs.len(), system.outputs.len());
    for (i, output) in system.outputs.iter().enumerate() {
        for (matrix, terms) in direct.outputs.iter_mut().zip(&output.d) {
            for (input, value) in terms {
                matrix[(i, *input as usize)] += value.to_ball().mid;
            }
        }
    }
    direct
}
