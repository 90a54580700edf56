//! One test binary: each module takes one part of what users were promised.

mod bounds;
mod command_line;
mod diagnostics;
mod exact;
mod examples;
mod hard_cases;
mod hard_cases_damped;
mod house;
mod language;
mod lowering;
mod models;
mod modes;
mod poles;
mod properties;
mod published;
mod readme;
mod response;
mod specification;
mod systems;
mod transfer;
