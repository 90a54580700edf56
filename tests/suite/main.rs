//! One test binary: each module takes one part of what users were promised.

mod ask;
mod bounds;
mod command_line;
mod diagnostics;
mod exact;
mod examples;
mod fuzzing;
mod hard_cases;
mod hard_cases_damped;
mod house;
mod independent;
mod language;
mod language_page;
mod lowering;
mod models;
mod modes;
mod pole_bounds;
mod poles;
mod properties;
mod published;
mod readme;
mod reports;
mod response;
mod specification;
mod systems;
mod transfer;
