//! The exact discrete system that emitted code runs: the states of independent blocks, the effect of one step on each,
//! the contributions of inputs, and the outputs. In: a linear system, its modes, the built-in signals, a step. Out: a
//! value that a back end only prints. Everything is computed in double-double and rounded once, to the precision of the
//! target. See docs/method/emit.md.
//!
//! # Steps
//! 1. [`modal`] or [`invariant`]: the continuous system as independent blocks
//! 2. [`reduce`]: removes blocks that no input reaches, that no output sees, or that the tolerance allows to leave out
//! 3. [`hold`], [`lift`]: one step of each block, in the form that loses fewest digits
//! 4. [`rounding`]: a bound of the effect of the target's rounding; [`comparison`]: its actual effect, if the run
//!    is known

pub mod block;
pub mod cell;
mod comparison;
pub mod equations;
mod events;
pub mod hold;
pub mod invariant;
pub mod lift;
pub mod modal;
pub mod parameter;
mod pieces;
mod poles;
pub mod precision;
pub mod reduce;
pub mod rounding;
pub mod signals;
mod turn;

pub use cell::{Cell, Form, Operand};
pub use lift::{Decay, Lift};
pub use precision::Precision;
pub use reduce::{DroppedBlock, Why};
pub use rounding::Rounding;
pub use signals::{Repeat, Signals};

use crate::analysis::answer::Modes;
use crate::analysis::discrete::block::{Direct, Split};
use crate::analysis::discrete::cell::{Maker, add_columns, rounded_terms};
use crate::analysis::discrete::comparison::Exact;
use crate::analysis::discrete::events::Fault;
use crate::analysis::discrete::turn::too_far;
use crate::analysis::error::AnalysisError;
use crate::analysis::modes::modes_as;
use crate::analysis::modes::request::Request;
use crate::analysis::poles::{pole_coordinates, poles as all_poles};
use crate::analysis::response::propagator;
use crate::base::{Bound, Dd, Number};
use crate::kernel::dense::Matrix;
use crate::system::{CoordinateKind, LinearSystem, Signal};

/// The course of an input between samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hold {
    /// It keeps its value from the sample.
    Zero,
    /// It is interpolated linearly to its next value.
    First,
}

/// Options of a discrete system.
#[derive(Clone, Debug)]
pub struct Options {
    /// Step size, s.
    pub step: Number,
    pub hold: Hold,
    pub precision: Precision,
    /// Modes that contribute less than this share of every output are left out; `None`: none are.
    pub tolerance: Option<f64>,
    /// Keep everything, even blocks that no input reaches.
    pub unpruned: bool,
    /// Whether the model's signals are built into the state.
    pub built_in: bool,
    /// Signals built into the state, for each input; inputs without any stay inputs. Empty: none are built in.
    pub internal: Vec<Vec<Signal>>,
    /// The end of the motion, s, if it is known: later events are left out.
    pub until: Option<Number>,
}

/// An input, an output or a coordinate.
#[derive(Clone, Debug, PartialEq)]
pub struct Port {
    pub name: String,
    pub unit: String,
}

/// A change of all states (in the order of the cells) at a sample.
#[derive(Clone, Debug)]
pub struct Event {
    pub tick: u64,
    /// The number that is added to each state, or to which it is set.
    pub change: Vec<f64>,
}

/// After the last event, the events from number `first` on repeat, each delayed by this many samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Again {
    pub first: usize,
    pub ticks: u64,
}

/// The discrete system.
#[derive(Clone, Debug)]
pub struct DiscreteSystem {
    pub coordinates: Vec<Port>,
    /// Units of the coordinates' velocities.
    pub rates: Vec<&'static str>,
    pub inputs: Vec<Port>,
    pub outputs: Vec<Port>,
    /// Step size, s.
    pub step: f64,
    pub hold: Hold,
    pub precision: Precision,
    pub tolerance: Option<f64>,
    pub method: &'static str,
    pub cells: Vec<Cell>,
    /// The direct feed-through to each output.
    pub direct: Vec<Vec<(Operand, f64)>>,
    /// Contributions of the last inputs and of the signals to displacements, then velocities, of all coordinates.
    pub offset: Vec<Vec<(Operand, f64)>>,
    /// Contributions of the last inputs and of the signals that are subtracted when a state is set: one row for each
    /// state that is not a signal's.
    pub taken: Vec<Vec<(Operand, f64)>>,
    /// Whether cells have their relation to the model's coordinates, so that code can set and get its state in these.
    pub tabled: bool,
    /// Number of cells, at the beginning of the list, that are those of signals.
    pub signals: usize,
    /// Changes of all states at certain samples, ascending.
    pub events: Vec<Event>,
    /// The continuation after the last event, if events repeat.
    pub repeat: Option<Again>,
    /// For each state, whether events set it instead of adding to it.
    pub set: Vec<bool>,
    /// Outputs that would follow the derivative of an input; an input that is held has none.
    pub without_slope: Vec<usize>,
    /// The elements whose nonlinear laws the code replaces by their tangents at rest.
    pub laws: Vec<String>,
    pub left: Vec<DroppedBlock>,
    /// A bound of the effect of rounding for any inputs; none if there are built-in signals too.
    pub rounding: Option<Rounding>,
    /// The effect of rounding on code without inputs, run from its start.
    pub measured: Vec<Measured>,
}

/// A bound of the outputs' rounding errors over a number of steps, relative to the largest value of each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    pub steps: u64,
    pub error: Bound,
}

impl DiscreteSystem {
    /// Number of states.
    pub fn states(&self) -> usize {
        self.cells.iter().map(Cell::size).sum()
    }

    /// Whether all numbers are finite.
    fn is_finite(&self) -> bool {
        let rows = [&self.direct, &self.offset, &self.taken].into_iter().flatten().flatten().map(|(_, value)| *value);
        let changes = self.events.iter().flat_map(|event| &event.change).copied();
        rows.chain(changes).all(f64::is_finite) && self.cells.iter().all(Cell::is_finite)
    }

    /// Whether the last inputs are part of the state.
    pub fn remembers(&self) -> bool {
        let last = |operand: &Operand| matches!(operand, Operand::Input(_) | Operand::Ramped(_));
        let kept = self.offset.iter().chain(&self.taken).flatten().any(|(operand, _)| last(operand));
        kept || self.uses(|operand| matches!(operand, Operand::Slope(_)))
    }

    /// Whether the first step differs from the others, because interpolated inputs have no earlier sample.
    pub fn ramps(&self) -> bool {
        self.uses(|o| matches!(o, Operand::Ramped(_) | Operand::Slope(_)))
    }

    /// Whether some term of the step has such an operand.
    pub fn uses(&self, which: impl Fn(&Operand) -> bool) -> bool {
        let in_cells = self.cells.iter().flat_map(|cell| cell.input.iter().flatten());
        in_cells.chain(self.direct.iter().flatten()).any(|(operand, _)| which(operand))
    }
}

/// With more states, poles take minutes.
pub const MOST_STATES: usize = 2000;
/// With more states, the tables for the states in the model's coordinates would fill files, so the code omits them.
const MOST_TABLED: usize = 800;
/// From this many coordinates on, poles are used where modes are coupled; below, vectors of the first-order system cost less.
const FROM_POLES: usize = 12;

/// All modes of a system that is not too large for code.
pub fn all_modes(system: &LinearSystem) -> Result<Modes, AnalysisError> {
    check_size(system)?;
    modes_as(system, &Request::default().without_shares())
}

fn check_size(system: &LinearSystem) -> Result<(), AnalysisError> {
    let states = 2 * system.n();
    if states > MOST_STATES { Err(AnalysisError::too_many_states(system, states, MOST_STATES)) } else { Ok(()) }
}

/// The discrete system of a model.
pub fn discretise(system: &LinearSystem, modes: &Modes, options: &Options) -> Result<DiscreteSystem, AnalysisError> {
    let n = system.n();
    AnalysisError::refuse_losses(system)?;
    check_size(system)?;
    let mut split = split(system, modes)?;
    let start = start(system);
    let signals =
        Signals::of(&options.internal, &options.step, options.until.as_ref()).map_err(|fault| match fault {
            signals::Fault::TooLong { input } => AnalysisError::signal_too_long(system, input),
            signals::Fault::NeverRepeats { input } => AnalysisError::never_repeats(system, input),
        })?;
    if let Some(input) = signals.base_with_impulse(system) {
        return Err(AnalysisError::impulse_on_base(system, input));
    }
    let left = reduce::reduce(&mut split, &start, options);
    let signals = signals.retain_effective(|input| split.has_effect(input));
    let step = options.step.to_ball().mid;
    let turning = split.blocks.iter().any(|block| block.a.rows() == 2 && too_far(&block.a.map(|x| x * step)));
    if turning || signals.chains.iter().any(|chain| chain.angle.is_some() && too_far(&chain.generator)) {
        return Err(AnalysisError::step_too_long(system));
    }
    let driven = |j: &usize| options.internal.get(*j).is_some_and(|list| !list.is_empty());
    let given: Vec<usize> = (0..system.inputs.len()).filter(|j| !driven(j)).collect();
    let tabled = 2 * n <= MOST_TABLED;
    let maker = Maker {
        step,
        hold: options.hold,
        precision: options.precision,
        given: given.clone(),
        chains: &signals.chains,
        tabled,
    };
    let out_of_range = || AnalysisError::code_out_of_range(system, options.precision.name());
    let mut first = 0;
    let mut made_signals = Vec::with_capacity(signals.chains.len());
    for chain in &signals.chains {
        made_signals.push(maker.signal(chain, first).ok_or_else(out_of_range)?);
        first += chain.size();
    }
    let mut direct = maker.rows(&split.direct.outputs, &made_signals);
    let mut offset = if tabled { maker.rows(&split.direct.state, &made_signals) } else { Vec::new() };
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
    let own = |made| maker.input_contributions(made, &split.direct, &made_signals);
    let taken = if tabled { made.iter().flat_map(own).collect() } else { Vec::new() };
    let changes = events::changes(&signals, &split.blocks, &made_signals, &made, |j| split.direct.used_orders(j), step);
    let changes = changes.map_err(|fault| match fault {
        Fault::TooMany { input } => AnalysisError::signal_too_long(system, input),
        Fault::OutOfRange => out_of_range(),
    })?;
    let made_start = made_signals.iter().map(|made| &made.start).chain(made.iter().map(|made| &made.start));
    let mut start: Vec<Dd> = made_start.flatten().copied().collect();
    let exact_cells = made_signals.iter().map(|made| &made.exact).chain(made.iter().map(|made| &made.exact));
    let exact_cells = exact_cells.cloned().collect();
    let mut set: Vec<bool> = made_signals.iter().flat_map(|made| vec![made.set; made.cell.size()]).collect();
    let mut cells: Vec<Cell> = made_signals.into_iter().map(|made| made.cell).collect();
    let signal_cells = cells.len();
    cells.extend(made.into_iter().map(|made| made.cell));
    set.resize(cells.iter().map(Cell::size).sum(), false);
    let repeat = signals.repeat;
    let changes = changes.into_iter().take_while(|(tick, _)| repeat.is_none_or(|all| *tick <= all.from + all.ticks));
    let (events, exact_events) = events::after_start(changes.collect(), &set, &mut start, options.precision);
    let repeat = repeat.and_then(|Repeat { from, ticks }| {
        let first = events.iter().position(|event| event.tick > from)?;
        Some(Again { first, ticks })
    });
    let places = cells.iter_mut().flat_map(|cell| &mut cell.start);
    places.zip(&start).for_each(|(place, &state)| *place = options.precision.round(state));
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
        laws: Vec::new(),
        cells,
        direct: direct.into_iter().map(round).collect(),
        offset: offset.into_iter().map(round).collect(),
        taken,
        tabled,
        signals: signal_cells,
        events,
        repeat,
        set,
        left,
        rounding: None,
        measured: Vec::new(),
    };
    if !discrete.is_finite() {
        return Err(out_of_range());
    }
    if discrete.inputs.is_empty() {
        let last = options.until.as_ref().map(|until| (until / &options.step).to_f64() as u64);
        discrete.measured = comparison::measure_rounding(&discrete, &exact, last);
    } else if signal_cells == 0 {
        discrete.rounding = Some(rounding::rounding(&discrete.cells, &discrete.direct, options.precision));
    }
    Ok(discrete)
}

fn split(system: &LinearSystem, modes: &Modes) -> Result<Split, AnalysisError> {
    if let Some(split) = modal::split(system, modes) {
        return Ok(split);
    }
    let by_poles = || poles::split(system, &*pole_coordinates(system, modes)?);
    match if system.n() >= FROM_POLES { by_poles() } else { None } {
        Some(split) => Ok(split),
        None if 2 * modes.list.len() > propagator::MOST_STATES => {
            Err(AnalysisError::too_many_states(system, 2 * modes.list.len(), propagator::MOST_STATES))
        }
        None => invariant::split(system, &all_poles(system, modes)?),
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

/// The direct feed-through that the system declares.
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
