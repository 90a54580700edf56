//! Time and peak memory for turning large scenes written with `repeat` into a linear system. Targets: 2 s and 1.5 GB
//! for a chain of 1,000,000 masses and for a net of 300 x 300; 2 s for 2,000 links drawn away from their rest. Every
//! scene runs in a process of its own, so that peaks do not mix.

mod clock;

use clock::Clock;
use std::hint::black_box;
use std::io::Write;
use std::process::Command;
use vibc::base::source::{SourceFile, Sources};
use vibc::model::Overrides;

/// The name of a scene, its size, and its text.
type Scene = (&'static str, usize, fn(usize) -> String);

const SCENES: [Scene; 13] = [
    ("chain of masses", 10_000, chain),
    ("chain of masses", 100_000, chain),
    ("chain of masses", 1_000_000, chain),
    ("chain held as drawn", 100_000, held),
    ("net of masses", 300, net),
    ("links drawn aslant", 500, aslant),
    ("links drawn aslant", 2_000, aslant),
    ("springy links aslant", 2_000, springy),
    ("links hanging", 100_000, hanging),
    ("cells by repeat", 10_000, cells),
    ("cells placed", 10_000, placed),
    ("cells by repeat", 100_000, cells),
    ("cells placed", 100_000, placed),
];

fn main() {
    let mut out = std::io::stdout().lock();
    if let Ok(which) = std::env::var("VIBC_SCALE_SCENE") {
        let which: usize = which.parse().expect("a number of a scene");
        return writeln!(out, "{}", measured(&SCENES[which])).expect("standard output");
    }
    if let Ok(cells) = std::env::var("VIBC_SCALE_CELLS") {
        let cells = cells.parse().expect("a number of cells");
        return writeln!(out, "{}", paired(cells)).expect("standard output");
    }
    writeln!(out, "scenes with `repeat`, seconds of processor time and MB").expect("standard output");
    writeln!(
        out,
        "{:22}{:>9}{:>10}{:>9}{:>9}{:>9}{:>9}{:>9}",
        "scene", "size", "freedoms", "parse", "check", "lower", "sum", "peak"
    )
    .expect("standard output");
    for which in 0..SCENES.len() {
        let program = std::env::current_exe().expect("a running program has a path");
        let child = Command::new(program).env("VIBC_SCALE_SCENE", which.to_string()).output().expect("a child");
        out.write_all(&child.stdout).expect("standard output");
    }
    writeln!(
        out,
        "\na component of five parts at n places, and the same parts by `repeat`: least of {ROUNDS} runs in turn"
    )
    .expect("standard output");
    writeln!(out, "{:>9}{:>11}{:>9}{:>8}", "n", "by repeat", "placed", "ratio").expect("standard output");
    for cells in [1_000, 10_000, 100_000] {
        let program = std::env::current_exe().expect("a running program has a path");
        let child = Command::new(program).env("VIBC_SCALE_CELLS", cells.to_string()).output().expect("a child");
        out.write_all(&child.stdout).expect("standard output");
    }
}

/// Runs of each of two forms of a scene, in turn.
const ROUNDS: usize = 7;

/// Parsing, checking and lowering of cells by `repeat` and as a component at its places.
fn paired(n: usize) -> String {
    let texts = [cells(n), placed(n)];
    let mut least = [f64::INFINITY; 2];
    for _ in 0..ROUNDS {
        for (least, text) in least.iter_mut().zip(&texts) {
            let mut sources = Sources::new();
            let file = sources.add(SourceFile::model("scene.vib", text.as_str()));
            let clock = Clock::start();
            let parsed = vibc::syntax::parse(&sources, file);
            let checked = vibc::model::check(&sources, &parsed.tree, &Overrides::default());
            black_box(vibc::lower::lower(&checked.scene.expect("a good model")));
            *least = clock.seconds().min(*least);
        }
    }
    let [by_repeat, placed] = least;
    format!("{n:>9}{by_repeat:>11.4}{placed:>9.4}{:>8.2}", placed / by_repeat)
}

/// Five parts again and again.
fn cells(n: usize) -> String {
    format!(
        "param k = 10 N/m
repeat i in 1..{n} {{
  body   b[i] {{ mass = i * 1 kg, moves x }}
  body   c[i] {{ mass = 2 * i * 1 kg, moves x }}
  spring s[i]: ground -- b[i] {{ k = k }}
  spring t[i]: b[i] -- c[i] {{ k = 2 * k }}
  output u[i] = c[i].x
}}
"
    )
}

/// The same as a component at so many places.
fn placed(n: usize) -> String {
    format!(
        "component cell(m: kg, k = 10 N/m) {{
  body   b {{ mass = m, moves x }}
  body   c {{ mass = 2 * m, moves x }}
  spring s: ground -- b {{ k = k }}
  spring t: b -- c {{ k = 2 * k }}
  output u = c.x
}}
repeat i in 1..{n} {{ place p[i] = cell(m = i * 1 kg) }}
"
    )
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

/// The chain hung up, with unknown tensions at rest.
fn held(n: usize) -> String {
    format!("gravity 9.81 m/s^2\nrest as drawn\n{}", chain(n).replace("moves x", "moves y"))
}

/// n x n masses, each on the ground by a spring and connected to its neighbours.
fn net(n: usize) -> String {
    format!(
        "param n = {n}
repeat i in 1..n {{ repeat j in 1..n {{
  body   m[i,j] {{ mass = 1 kg, moves x }}
  spring g[i,j]: ground -- m[i,j] {{ k = 1 N/m }}
}} }}
repeat i in 1..n {{ repeat j in 2..n {{
  spring a[i,j]: m[i,j-1] -- m[i,j] {{ k = 100 N/m }}
  spring b[i,j]: m[j-1,i] -- m[j,i] {{ k = 100 N/m }}
}} }}
"
    )
}

/// Links of 1 m one after another along (x, -y), with these declarations at the first and between neighbours.
fn links(n: usize, [x, y]: [&str; 2], first: &str, between: &str) -> String {
    format!(
        "gravity 9.81 m/s^2
param n = {n}
body  b[1] {{ mass = 1 kg, inertia = 0.1 kg*m^2, at = ({x} m, -{y} m) }}
pivot p[1]: ground@(0, 0) -- b[1]
{first}
repeat i in 2..n {{
  body  b[i] {{ mass = 1 kg, inertia = 0.1 kg*m^2, at = (i * {x} m, -i * {y} m) }}
  pivot p[i]: b[i-1]@((i-1) * {x} m, -(i-1) * {y} m) -- b[i]
  {between}
}}
"
    )
}

fn aslant(n: usize) -> String {
    links(n, ["0.6", "0.8"], "", "")
}

fn springy(n: usize) -> String {
    let first = "spring t[1]: ground -- b[1] { k = 500 N*m/rad }";
    links(n, ["0.6", "0.8"], first, "spring t[i]: b[i-1] -- b[i] { k = 500 N*m/rad }")
}

fn hanging(n: usize) -> String {
    links(n, ["0", "1"], "", "")
}

fn measured((name, size, text): &Scene) -> String {
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model("scene.vib", text(*size)));
    let clock = Clock::start();
    let parsed = vibc::syntax::parse(&sources, file);
    let parse = clock.seconds();
    let checked = vibc::model::check(&sources, &parsed.tree, &Overrides::default());
    let check = clock.seconds();
    let outcome = vibc::lower::lower(&checked.scene.expect("a good model"));
    let lower = clock.seconds();
    let lowered = outcome.lowered.expect("a rest");
    let n = black_box(&lowered).system.n();
    let proven = if lowered.rest.is_proven() { "" } else { "  (rest not proven)" };
    let peak = peak_megabytes().map_or("?".into(), |mb| format!("{mb:.0}"));
    let (check, found) = (check - parse, lower - check);
    format!("{name:22}{size:>9}{n:>10}{parse:>9.3}{check:>9.3}{found:>9.3}{lower:>9.3}{peak:>9}{proven}")
}

/// Peak memory of this process (proc(5), `VmHWM`).
fn peak_megabytes() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<f64>().ok()? / 1024.0)
}
