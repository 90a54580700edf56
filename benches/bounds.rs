//! Ten thousand random systems: whether every bound holds, how sharp the bounds are, and how many results could not be
//! certified. `cargo bench --bench bounds` prints the table of `benches/README.md`; `cargo bench --bench bounds -- 100`
//! takes 100 of each kind.

// Tests compare with the platform's functions to a few digits.
#![allow(clippy::disallowed_methods)]

#[allow(dead_code)]
#[path = "../tests/suite/exact.rs"]
mod exact;
#[allow(dead_code)]
#[path = "../tests/suite/sweeps.rs"]
mod sweeps;
#[allow(dead_code)]
#[path = "../tests/suite/systems.rs"]
mod systems;

use std::io::Write;
use sweeps::{DAMPED, Figures, Kind, UNDAMPED, check_modes, check_poles, turned};
use systems::Random;
use vibc::system::LinearSystem;

/// Number of systems of each kind: fifteen kinds, each with and without a rotation, make ten thousand.
const EACH: usize = 334;

fn main() {
    let each = std::env::args().skip(1).find_map(|word| word.parse().ok()).unwrap_or(EACH);
    let mut out = std::io::stdout().lock();
    let mut say = |line: String| writeln!(out, "{line}").expect("standard output");
    say(format!("{each} systems of each kind, seeds 1 to {}", UNDAMPED.len() + DAMPED.len()));
    say("| kind | numbers | violations | median bound/error | worst | together only | uncertified | worst bound |"
        .into());
    say("| --- | --- | --- | --- | --- | --- | --- | --- |".into());
    let mut seed = 0;
    let mut reported = Vec::new();
    for (kinds, check) in [(&UNDAMPED[..], check_modes as Check), (&DAMPED[..], check_poles)] {
        for kind in kinds {
            seed += 1;
            for turning in [false, true] {
                let mut figures = sweep(kind, check, seed, each, turning);
                let name = if turning { format!("{}, turned by 30 degrees", kind.0) } else { kind.0.to_string() };
                say(row(&name, &mut figures));
                reported.extend(figures.violations.into_iter().chain(figures.uncertified));
            }
        }
    }
    reported.into_iter().for_each(say);
}

type Check = fn(&LinearSystem, &LinearSystem, &mut Figures, &str);

fn sweep((name, system): &Kind, check: Check, seed: u64, each: usize, turning: bool) -> Figures {
    let (mut random, mut figures) = (Random::new(seed), Figures::default());
    for i in 0..each {
        let truth = system(&mut random, i);
        let what = format!("{name} {i}{}", if turning { " turned" } else { "" });
        match turning {
            true => check(&turned(&truth), &truth, &mut figures, &what),
            false => check(&truth, &truth, &mut figures, &what),
        }
    }
    figures
}

fn row(name: &str, figures: &mut Figures) -> String {
    let (median, worst) = (figures.median(), figures.ratios.last().copied().unwrap_or(1.0));
    let Figures { numbers, violations, uncertified, clustered, worst_bound, .. } = figures;
    format!(
        "| {name} | {numbers} | {} | {median:.1} | {worst:.0e} | {clustered} | {} | {worst_bound:.0e} |",
        violations.len(),
        uncertified.len()
    )
}
