//! The reasons why an analysis gives no answer: facts, and the diagnostics made from them.

use crate::base::{Code, Diagnostic, Span};
use crate::system::{CoordinateId, LinearSystem};

/// The reason why an analysis stopped.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum AnalysisError {
    /// There are more coordinates than the methods for general matrices take.
    TooManyCoordinates {
        count: usize,
        limit: usize,
        at: Span,
    },
    /// Some modes of a system of this many coordinates were requested, and no sparse method suits it.
    NotSparse {
        count: usize,
        limit: usize,
        at: Span,
    },
    /// Nothing holds some motions without inertia: the coordinates concerned, by name, and the place where the first is
    /// declared.
    SingularMass {
        coordinates: Vec<String>,
        at: Span,
    },
    /// Some motions without inertia are in a part with dampers whose poles are not computed exactly: the coordinates
    /// without inertia, by name, the number of coordinates of their part, and the place where the first is declared.
    MasslessPoles {
        coordinates: Vec<String>,
        count: usize,
        limit: usize,
        at: Span,
    },
    /// Each of these coordinates has inertia, or damping without inertia, but some combination of them has none.
    DependentMass {
        coordinates: Vec<String>,
        damping: bool,
        at: Span,
    },
    /// Some bodies have no mass, and their elimination would leave more than `limit` terms.
    MasslessNet {
        coordinate: String,
        limit: usize,
        at: Span,
    },
    /// A mass or a moment of inertia is negative in some motion of this coordinate.
    IndefiniteMass {
        coordinate: String,
        at: Span,
    },
    /// There are too many states for a dense matrix exponential.
    TooManyStates {
        count: usize,
        limit: usize,
        at: Span,
    },
    /// A signal needs too many pieces: the input's name.
    SignalTooLong {
        input: String,
        at: Span,
    },
    NeverRepeats {
        input: String,
        at: Span,
    },
    /// A motion at so many times has too many values.
    TooManySamples {
        times: usize,
        outputs: usize,
        limit: usize,
        at: Span,
    },
    /// A table of so many pairs of inputs and outputs has too many values: `most` pairs fit.
    TooManyPairs {
        pairs: usize,
        frequencies: usize,
        most: usize,
        at: Span,
    },
    /// A prescribed motion has an impulse: the base's name.
    ImpulseOnBase {
        input: String,
        at: Span,
    },
    /// A motion grows, or a time is long, beyond the range of binary64.
    MotionOutOfRange {
        at: Span,
    },
    /// Simulation code needs numbers outside the range of its precision.
    CodeOutOfRange {
        precision: &'static str,
        at: Span,
    },
    /// A step is so long relative to a motion or a signal that too few digits are left for its phase.
    StepTooLong {
        at: Span,
    },
    /// A number became too large or too small for binary64.
    OutOfRange {
        at: Span,
    },
    /// `damping modal` for a part whose modes are not known well enough to bound the damping that it adds.
    UncertainModes {
        at: Span,
    },
    /// Springs with a loss factor, in an analysis that does not take it.
    Loss {
        at: Span,
    },
}

impl AnalysisError {
    pub(in crate::analysis) fn singular_mass(system: &LinearSystem, coordinates: &[usize]) -> AnalysisError {
        let at = coordinates.first().map_or_else(|| place(system, 0), |&i| place(system, i));
        let coordinates = coordinates.iter().map(|&i| system.display(system.coordinates[i].name)).collect();
        AnalysisError::SingularMass { coordinates, at }
    }

    /// `damping`: of coordinates without inertia, of which some combination has no damping either.
    pub(in crate::analysis) fn dependent_mass(
        system: &LinearSystem,
        coordinates: &[usize],
        damping: bool,
    ) -> AnalysisError {
        let at = coordinates.first().map_or_else(|| place(system, 0), |&i| place(system, i));
        let coordinates = coordinates.iter().map(|&i| system.display(system.coordinates[i].name)).collect();
        AnalysisError::DependentMass { coordinates, damping, at }
    }

    /// `part`: the coordinates of the part, some of which have no inertia.
    pub(in crate::analysis) fn massless_poles(system: &LinearSystem, part: &[u32], limit: usize) -> AnalysisError {
        let mut heavy: Vec<u32> = (system.m.terms())
            .flat_map(|term| system.m.row(term).iter().filter(|(_, a)| !a.is_zero()).map(|(i, _)| i.0))
            .collect();
        heavy.sort_unstable();
        let massless = |i: &&u32| heavy.binary_search(i).is_err();
        let found: Vec<usize> = part.iter().filter(massless).map(|i| *i as usize).collect();
        let at = place(system, found.first().or(part.first().map(|i| *i as usize).as_ref()).copied().unwrap_or(0));
        let coordinates = found.iter().map(|i| system.display(system.coordinates[*i].name)).collect();
        AnalysisError::MasslessPoles { coordinates, count: part.len(), limit, at }
    }

    pub(in crate::analysis) fn massless_net(system: &LinearSystem, coordinate: usize, limit: usize) -> AnalysisError {
        let name = system.display(system.coordinates[coordinate].name);
        AnalysisError::MasslessNet { coordinate: name, limit, at: place(system, coordinate) }
    }

    pub(in crate::analysis) fn indefinite_mass(system: &LinearSystem, coordinate: CoordinateId) -> AnalysisError {
        let coordinate = coordinate.index();
        let name = system.display(system.coordinates[coordinate].name);
        AnalysisError::IndefiniteMass { coordinate: name, at: place(system, coordinate) }
    }

    pub(in crate::analysis) fn too_many_states(system: &LinearSystem, count: usize, limit: usize) -> AnalysisError {
        AnalysisError::TooManyStates { count, limit, at: place(system, 0) }
    }

    pub(in crate::analysis) fn out_of_range(system: &LinearSystem) -> AnalysisError {
        AnalysisError::MotionOutOfRange { at: place(system, 0) }
    }

    pub(in crate::analysis) fn uncertain_modes(system: &LinearSystem, coordinate: usize) -> AnalysisError {
        AnalysisError::UncertainModes { at: place(system, coordinate) }
    }

    /// An error if springs have a loss factor.
    pub(in crate::analysis) fn refuse_losses(system: &LinearSystem) -> Result<(), AnalysisError> {
        if system.losses.is_some() { Err(AnalysisError::Loss { at: place(system, 0) }) } else { Ok(()) }
    }

    pub(in crate::analysis) fn code_out_of_range(system: &LinearSystem, precision: &'static str) -> AnalysisError {
        AnalysisError::CodeOutOfRange { precision, at: place(system, 0) }
    }

    pub(in crate::analysis) fn step_too_long(system: &LinearSystem) -> AnalysisError {
        AnalysisError::StepTooLong { at: place(system, 0) }
    }

    pub(in crate::analysis) fn never_repeats(system: &LinearSystem, input: usize) -> AnalysisError {
        AnalysisError::NeverRepeats { input: system.display(system.inputs[input].name), at: system.inputs[input].span }
    }

    pub(in crate::analysis) fn signal_too_long(system: &LinearSystem, input: usize) -> AnalysisError {
        AnalysisError::SignalTooLong { input: system.display(system.inputs[input].name), at: system.inputs[input].span }
    }

    pub(in crate::analysis) fn impulse_on_base(system: &LinearSystem, input: usize) -> AnalysisError {
        AnalysisError::ImpulseOnBase { input: system.display(system.inputs[input].name), at: system.inputs[input].span }
    }

    pub fn code(&self) -> Code {
        match self {
            AnalysisError::TooManyCoordinates { .. } | AnalysisError::NotSparse { .. } => {
                Code::limit("vib::limit::modes")
            }
            AnalysisError::SingularMass { .. } | AnalysisError::DependentMass { .. } => {
                Code::model("vib::mass::singular")
            }
            AnalysisError::MasslessPoles { .. } | AnalysisError::MasslessNet { .. } => {
                Code::limit("vib::limit::massless")
            }
            AnalysisError::IndefiniteMass { .. } => Code::model("vib::mass::indefinite"),
            AnalysisError::TooManyStates { .. } => Code::limit("vib::limit::states"),
            AnalysisError::SignalTooLong { .. } | AnalysisError::NeverRepeats { .. } => {
                Code::limit("vib::limit::signal")
            }
            AnalysisError::TooManySamples { .. } | AnalysisError::TooManyPairs { .. } => {
                Code::limit("vib::limit::values")
            }
            AnalysisError::ImpulseOnBase { .. } => Code::model("vib::signal::base_impulse"),
            AnalysisError::MotionOutOfRange { .. }
            | AnalysisError::CodeOutOfRange { .. }
            | AnalysisError::StepTooLong { .. }
            | AnalysisError::OutOfRange { .. }
            | AnalysisError::UncertainModes { .. } => Code::limit("vib::limit::range"),
            AnalysisError::Loss { .. } => Code::limit("vib::limit::loss"),
        }
    }

    pub fn to_diagnostic(&self) -> Diagnostic {
        let (message, help) = self.text();
        Diagnostic::error(self.code(), self.place(), message).help(help)
    }

    fn place(&self) -> Span {
        match self {
            AnalysisError::TooManyCoordinates { at, .. }
            | AnalysisError::NotSparse { at, .. }
            | AnalysisError::SingularMass { at, .. }
            | AnalysisError::DependentMass { at, .. }
            | AnalysisError::MasslessPoles { at, .. }
            | AnalysisError::MasslessNet { at, .. }
            | AnalysisError::IndefiniteMass { at, .. }
            | AnalysisError::TooManyStates { at, .. }
            | AnalysisError::SignalTooLong { at, .. }
            | AnalysisError::NeverRepeats { at, .. }
            | AnalysisError::TooManySamples { at, .. }
            | AnalysisError::TooManyPairs { at, .. }
            | AnalysisError::ImpulseOnBase { at, .. }
            | AnalysisError::MotionOutOfRange { at }
            | AnalysisError::CodeOutOfRange { at, .. }
            | AnalysisError::StepTooLong { at }
            | AnalysisError::OutOfRange { at }
            | AnalysisError::UncertainModes { at }
            | AnalysisError::Loss { at } => *at,
        }
    }

    fn text(&self) -> (String, &'static str) {
        match self {
            AnalysisError::TooManyCoordinates { count, limit, .. } => (
                format!("all modes of {count} coordinates are too many: the limit is {limit} coordinates"),
                "ask for some of them: `--modes 20` for the lowest, `--band 10Hz..50Hz` for a band; `damping modal` needs all",
            ),
            AnalysisError::NotSparse { count, limit, .. } => (
                format!(
                    "no sparse method suits these {count} coordinates: too many modes are asked for or lie below the \
                     band, some coordinate has no inertia of its own, or inertia joins each with most others, as in long rows of links; other methods go \
                     up to {limit}"
                ),
                "ask for fewer modes or a lower band; give every coordinate a mass; use fewer links, or bodies with freedom clauses",
            ),
            AnalysisError::SingularMass { coordinates, .. } => (
                format!(
                    "{} can move without inertia and without force, so the motion is not determined",
                    coordinates.join(", ")
                ),
                "give it a mass (an inertia if it turns), or connect it by springs to a body with mass or to the ground",
            ),
            AnalysisError::DependentMass { coordinates, damping, .. } => (
                format!(
                    "some combination of {} moves without {}, and springs place it at once: motions in time and code \
                     are not made for that",
                    name_list(coordinates),
                    if *damping { "inertia and damping" } else { "inertia" }
                ),
                "give each body in it a mass (an inertia if it turns)",
            ),
            AnalysisError::MasslessPoles { coordinates, count, limit, .. } => (
                massless_poles(coordinates, *count, *limit),
                "give what moves there a mass (an inertia if it turns), or remove it and connect its neighbours directly",
            ),
            AnalysisError::MasslessNet { coordinate, limit, .. } => (
                format!("{coordinate} moves without inertia, and its elimination would leave more than {limit} terms"),
                "give it a mass (an inertia if it turns), or connect it to fewer others",
            ),
            AnalysisError::IndefiniteMass { coordinate, .. } => (
                format!("the mass matrix is not certainly positive definite at {coordinate}"),
                "give what moves there a mass, or remove its degree of freedom; links without mass in slanted loops are the usual cause",
            ),
            AnalysisError::TooManyStates { count, limit, .. } => (
                format!("the motion in time has {count} states; the limit is {limit}"),
                "make the model smaller, or give signals to fewer inputs",
            ),
            AnalysisError::SignalTooLong { input, .. } => (
                format!("the signal of `{input}` has too many cycles to compute"),
                "shorten its duration, lower its frequencies, or ask for a shorter time",
            ),
            AnalysisError::TooManySamples { times, outputs, limit, .. } => (
                format!(
                    "{outputs} outputs at {times} times are {} values; the limit is {limit}",
                    outputs.saturating_mul(*times)
                ),
                "use a longer `--step` or a shorter `--until`, or declare fewer outputs",
            ),
            AnalysisError::TooManyPairs { pairs, frequencies, most, .. } => (
                format!(
                    "a table of {pairs} pairs of inputs and outputs at {frequencies} {} is too large; the limit is {most} {}",
                    if *frequencies == 1 { "frequency" } else { "frequencies" },
                    if *most == 1 { "pair" } else { "pairs" },
                ),
                "choose inputs by `--from` and outputs by `--to`, or ask for fewer frequencies by `--points` or `--at`",
            ),
            AnalysisError::ImpulseOnBase { input, .. } => (
                format!("`{input}` is a prescribed motion, and an impulse of it would need infinite forces"),
                "prescribe a `step` or a `pulse`, or apply the impulse as a force",
            ),
            AnalysisError::CodeOutOfRange { precision, .. } => (
                format!("the code would have numbers outside the range of {precision} precision"),
                "check the units and the step; `--precision f64` has a larger range than f32",
            ),
            AnalysisError::NeverRepeats { input, .. } => (
                format!("the signal of `{input}` comes again, but not after whole steps, so no code can repeat it"),
                "choose a step of which the period is a multiple, and a motion without drift; or leave the signal out: the code \
                 then takes this input in each step",
            ),
            AnalysisError::StepTooLong { .. } => (
                "in one step a motion or a signal turns by more than 1e9 rad".to_string(),
                "use a shorter `--step`: after so many radians too few digits of the phase are left",
            ),
            AnalysisError::MotionOutOfRange { .. } => (
                "the motion over this time leaves the range of binary64".to_string(),
                "choose a shorter time: its powers have to be in the range too, and a divergence grows by a factor e in each of its growth times",
            ),
            AnalysisError::UncertainModes { .. } => (
                "the modes are not known well enough to give each its damping ratio".to_string(),
                "write what cancels without roots and angles, choose stiffnesses and masses of more similar magnitude, or write \
                 dampers instead of `damping modal`",
            ),
            AnalysisError::Loss { .. } => (
                "a spring has a loss factor, which only harmonic motion has: k (1 + i loss) is not a law in time"
                    .to_string(),
                "ask for `vibc transfer`, `gain` or `amplitude`; or write a damper in place of `loss`",
            ),
            AnalysisError::OutOfRange { .. } => (
                "stiffnesses and masses differ too much in magnitude: a number left the range of binary64".to_string(),
                "choose values of more similar magnitude",
            ),
        }
    }
}

/// The text that names these motions, and says why the poles of their part are not computed.
/// The first names and the number of the others.
fn name_list(coordinates: &[String]) -> String {
    const MOST: usize = 6;
    match coordinates {
        all if all.len() > MOST => format!("{} and {} more", all[..MOST].join(", "), all.len() - MOST),
        all => all.join(", "),
    }
}

fn massless_poles(coordinates: &[String], count: usize, limit: usize) -> String {
    let who = match coordinates {
        [] => "some motion".to_string(),
        all => name_list(all),
    };
    let verb = if coordinates.len() > 1 { "move" } else { "moves" };
    let why = if count > limit {
        format!("this one has {count}")
    } else {
        "in this one some are not, or roots are too close to each other".to_string()
    };
    format!(
        "{who} {verb} without inertia in a part with dampers: poles of such a part are computed exactly, for at most {limit} \
         coordinates and where all numbers are rational; {why}"
    )
}

pub(in crate::analysis) fn place(system: &LinearSystem, coordinate: usize) -> Span {
    system.coordinates[coordinate].span
}
