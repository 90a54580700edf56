//! The time for the equations of hanging chains inside a running process: from the text of the model, through check, lowering, derivation and
//! comparison, to the text of the equations. `benches/equations.py` sets it beside SymPy's.

use std::hint::black_box;
use std::io::Write;
use std::time::{Duration, Instant};
use vibc::backend::equations;
use vibc::base::source::{SourceFile, Sources};
use vibc::model::Overrides;

const MOST_LINKS: usize = 10;
/// Time that is spent on each chain.
const WHOLE: Duration = Duration::from_millis(400);

fn main() {
    let mut out = std::io::stdout().lock();
    for links in 1..=MOST_LINKS {
        let model = chain(links);
        let (start, mut times) = (Instant::now(), Vec::new());
        while times.len() < 5 || start.elapsed() < WHOLE {
            let begin = Instant::now();
            black_box(text(&model));
            times.push(begin.elapsed());
        }
        let fastest = times.into_iter().min().unwrap_or_default();
        let microseconds = fastest.as_secs_f64() * 1e6;
        writeln!(out, "{links} {microseconds:.1}").expect("standard output");
    }
}

/// A chain of point masses that hangs from the ground.
fn chain(links: usize) -> String {
    let mut model = String::from("model chain\nparam m = 1 kg\nparam L = 1 m\ngravity 9.81 m/s^2\n");
    for i in 1..=links {
        let carrier = if i == 1 { "ground".to_string() } else { format!("b{}", i - 1) };
        model += &format!("body b{i} {{ mass = m, inertia = 0 kg*m^2, at = (0, -{i} * L) }}\n");
        model += &format!("pivot p{i}: {carrier}@(0, -{} * L) -- b{i}\n", i - 1);
    }
    model
}

fn text(model: &str) -> String {
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model("chain", model));
    let answer = vibc::equations(&sources, file, &Overrides::default()).answer.expect("equations");
    equations::text(&equations::document(&answer), vibc::backend::report::WIDTH)
}
