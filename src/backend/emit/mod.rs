//! Simulation code: a discrete system as standalone source code in C99 or Rust. The plan is the same for every
//! language; a language is one file that prints it, and one line of [`Language`]. See docs/method/emit.md.

mod c;
mod equations;
mod groups;
mod header;
mod motion;
mod names;
mod parameter;
mod plan;
mod planner;
mod program;
mod reserved;
mod rust;
mod text;

pub use program::Program;

use crate::analysis::DiscreteSystem;
use crate::analysis::discrete::Precision;
use crate::analysis::discrete::equations::Equations;
use crate::analysis::discrete::parameter::Parameterised;
use crate::system::column;

/// A target language.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    C,
    Rust,
}

/// A file to be written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct File {
    pub name: String,
    pub text: String,
}

const INIT: &str = "The state at t = 0: the model's initial state.";
const RESET: &str = "Back to t = 0.";
const STEP: &str =
    "The outputs at the present sample, with the inputs of that sample; then the state advances to the next sample.";
const SET_STATE: &str = "The motion at the next sample, without the parts that the header lists as not emitted.";
const GET_STATE: &str = "The motion at the next sample if the inputs keep their last values.";
const SET_PARAMETER: &str = "The parameter from the next step on, SI; the motion continues from its present state.";
const DERIVATIVE: &str = "The derivative of the motion: velocities and accelerations.";
const OBSERVE: &str = "The outputs.";
/// The text for an empty state.
const NO_STATE: &str = "none";

/// The files of a model, in its directory, with a program if one is requested.
pub fn files(model: &str, system: &DiscreteSystem, language: Language, program: Option<&Program>) -> Vec<File> {
    let mut plan = planner::plan(model, system);
    if program.is_some() && plan.name == "main" {
        // The program's own file has this name.
        plan.name = "main_".into();
    }
    let mut files = print(&plan, language);
    let columns: Vec<String> = system.outputs.iter().map(|output| column(&output.name, &output.unit)).collect();
    files.extend(program.map(|program| program::file(&plan, &columns, program, language)));
    files
}

/// All of [`files`] as one text.
pub fn whole(model: &str, system: &DiscreteSystem, language: Language) -> String {
    text(&planner::plan(model, system), language)
}

/// The files of a model's equations.
pub fn equation_files(model: &str, system: &Equations, language: Language) -> Vec<File> {
    print(&equations::plan(model, system), language)
}

/// All of [`equation_files`] as one text.
pub fn equation_text(model: &str, system: &Equations, language: Language) -> String {
    text(&equations::plan(model, system), language)
}

/// The files of a model with an adjustable parameter; `None` if a number leaves the range of the precision.
pub fn parameter_files(
    model: &str,
    system: &Parameterised,
    step: f64,
    precision: Precision,
    language: Language,
) -> Option<Vec<File>> {
    Some(print(&parameter::plan(model, system, step, precision)?, language))
}

/// All of [`parameter_files`] as one text.
pub fn parameter_text(
    model: &str,
    system: &Parameterised,
    step: f64,
    precision: Precision,
    language: Language,
) -> Option<String> {
    Some(text(&parameter::plan(model, system, step, precision)?, language))
}

fn print(plan: &plan::Plan, language: Language) -> Vec<File> {
    match language {
        Language::C => c::files(plan),
        Language::Rust => rust::files(plan),
    }
}

fn text(plan: &plan::Plan, language: Language) -> String {
    match language {
        Language::C => c::whole(plan),
        Language::Rust => rust::whole(plan),
    }
}
