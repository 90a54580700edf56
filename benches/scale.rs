//! How long a chain written with `repeat` takes to become a linear system, and how much memory at the most.
//! Targets for 1,000,000 masses: 2 s and 1.5 GB. Every size runs in a process of its own, so that peaks do not mix.

mod clock;

use clock::Clock;
use std::hint::black_box;
use std::io::Write;
use std::process::Command;
use vibc::base::source::{SourceFile, Sources};
use vibc::model::Overrides;

const SIZES: [usize; 3] = [10_000, 100_000, 1_000_000];

fn main() {
    let mut out = std::io::stdout().lock();
    if let Ok(size) = std::env::var("VIBC_SCALE_SIZE") {
        let row = measured(size.parse().expect("a size"));
        return writeln!(out, "{row}").expect("standard output");
    }
    writeln!(out, "chain with `repeat`, seconds of processor time and MB").expect("standard output");
    writeln!(out, "{:>10}{:>9}{:>9}{:>9}{:>9}{:>9}", "masses", "parse", "check", "lower", "sum", "peak")
        .expect("standard output");
    for size in SIZES {
        let program = std::env::current_exe().expect("a running program has a path");
        let child = Command::new(program).env("VIBC_SCALE_SIZE", size.to_string()).output().expect("a child");
        out.write_all(&child.stdout).expect("standard output");
    }
}

fn chain(n: usize) -> String {
    format!(
        "param n = {n}
body m[1] {{ mass = 1 kg, moves x }}
spring k[1]: ground -- m[1] {{ k = 100 N/m }}
repeat i in 2..n {{
  body m[i] {{ mass = 1 kg, moves x }}
  spring k[i]: m[i-1] -- m[i] {{ k = 100 N/m }}
}}
"
    )
}

fn measured(n: usize) -> String {
    let text = chain(n);
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model("chain.vib", text));
    let clock = Clock::start();
    let parsed = vibc::syntax::parse(&sources, file);
    let parse = clock.seconds();
    let checked = vibc::model::check(&sources, &parsed.tree, &Overrides::default());
    let check = clock.seconds();
    let outcome = vibc::lower::lower(&checked.scene.expect("a good model"));
    let lower = clock.seconds();
    let lowered = outcome.lowered.expect("a rest");
    assert_eq!(black_box(&lowered).system.n(), n);
    let peak = peak_megabytes().map_or("?".into(), |mb| format!("{mb:.0}"));
    format!("{n:>10}{parse:>9.3}{:>9.3}{:>9.3}{lower:>9.3}{peak:>9}", check - parse, lower - check)
}

/// Most memory that this process has held (proc(5), `VmHWM`).
fn peak_megabytes() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<f64>().ok()? / 1024.0)
}
