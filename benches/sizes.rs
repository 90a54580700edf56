//! Large scenes: the lowest modes of chains, trees and meshes, and all modes of small ones. For each, the processor
//! time from text to system and of the modes, the largest certified bound of an omega, and its largest true error if a
//! reference is known: a closed form from tests/hardcases, or the same modes to more digits. Everything runs in one
//! process on one thread.
//!
//! `cargo bench --bench sizes -- NAME...` runs the scenes whose names contain one of the words.

use std::io::Write;
use std::time::Instant;
use vibc::analysis::{Mode, Request, Which, modes_as};
use vibc::base::source::{SourceFile, Sources};
use vibc::base::{Number, Rational};
use vibc::kernel::{dense::Matrix, symmetric};
use vibc::model::Overrides;
use vibc::system::LinearSystem;

/// A scene, the requested modes, and the tolerance.
struct Case {
    name: &'static str,
    text: fn() -> String,
    which: Which,
    tolerance: f64,
    reference: Reference,
}

enum Reference {
    None,
    /// A case of tests/hardcases and the field that contains its values.
    Hard(&'static str, &'static str),
    /// The same computation at this tolerance.
    Tighter(f64),
}

const LOWEST: Which = Which::Lowest(20);

fn cases() -> Vec<Case> {
    use Reference::{Hard, None, Tighter};
    let o23 = || Hard("o23_uniform_chain_1e5", "value_decimal");
    let o24 = || Hard("o24_membrane_200x200", "value");
    let case = |name, text, which, tolerance, reference| Case { name, text, which, tolerance, reference };
    vec![
        case("chain 1e5 (o23)", || chain(100_000), LOWEST, 1e-12, o23()),
        case("chain 1e5 (o23), 28 digits", || chain(100_000), LOWEST, 1e-28, o23()),
        case("tree 1e5", || tree(100_000), LOWEST, 1e-12, Tighter(1e-27)),
        case("tree 1e5, 28 digits", || tree(100_000), LOWEST, 1e-28, None),
        case("uneven chain 1e6", || uneven_chain(1_000_000), LOWEST, 2e-13, Tighter(1e-25)),
        case("net 150 x 150, 12 decades", || net(150), LOWEST, 1e-14, Tighter(1e-24)),
        case("membrane 200 x 200 (o24)", || membrane(200), LOWEST, 1e-12, o24()),
        case("pendulum 1000", || pendulum(1000), LOWEST, 1e-12, Tighter(1e-25)),
        case("pendulum 5000", || pendulum(5000), LOWEST, 1e-12, Tighter(1e-25)),
        case("dense 10, all", || net_of(10), Which::All, 1e-12, None),
        case("dense 30, all", || net_of(30), Which::All, 1e-12, None),
        case("dense 100, all", || net_of(100), Which::All, 1e-12, None),
        case("dense 400, all", || net_of(400), Which::All, 1e-12, None),
        case("spread 100, all", || spread(100, 4), Which::All, 1e-12, None),
        case("spread 200, all", || spread(200, 4), Which::All, 1e-12, None),
        case("spread 400, all", || spread(400, 4), Which::All, 1e-12, None),
        case("spread 1000, all", || spread(1000, 4), Which::All, 1e-12, None),
        case("spread 2000, all", || spread(2000, 4), Which::All, 1e-12, None),
        case("spread 2000, 8 decades", || spread(2000, 8), Which::All, 1e-12, None),
        case("spread 2000, 14 decades", || spread(2000, 14), Which::All, 1e-12, None),
        case("complete 300, all", || complete(300), Which::All, 1e-12, None),
    ]
}

fn main() {
    let mut out = std::io::stdout().lock();
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let heading = ["scene", "modes", "lower [s]", "modes [s]", "bound", "error", "method"];
    row(&mut out, &heading.map(String::from));
    for case in cases() {
        if words.is_empty() || words.iter().any(|word| case.name.contains(word.as_str())) {
            row(&mut out, &measured(&case));
        }
    }
    if words.is_empty() || words.iter().any(|word| "eigenvectors".contains(word.as_str())) {
        reductions(&mut out);
    }
}

fn row(out: &mut impl Write, cells: &[String; 7]) {
    let [name, count, lower, modes, bound, error, method] = cells;
    writeln!(out, "{name:<28}{count:>6}{lower:>11}{modes:>11}{bound:>9}{error:>9}  {method}").expect("standard output");
}

fn measured(case: &Case) -> [String; 7] {
    let clock = Clock::start();
    let system = match lowered((case.text)()) {
        Ok(system) => system,
        Err(error) => return cells(case, "", "", "", error),
    };
    let lower = clock.seconds();
    let request = |tolerance| Request { which: case.which, tolerance, ..Request::default() };
    // The mean of a few runs if one is short: the kernel's clock ticks in milliseconds.
    let (mut time, mut found) = (0.0, Err(String::new()));
    let clock = Clock::start();
    for runs in 1..=100 {
        found = modes_as(&system, &request(case.tolerance)).map_err(|error| error.code().0.to_string());
        time = clock.seconds() / f64::from(runs);
        if clock.seconds() > 0.5 {
            break;
        }
    }
    let list = match found {
        Ok(modes) => modes.list,
        Err(error) => return cells(case, &format!("{lower:.3}"), &format!("{time:.4}"), "", error),
    };
    let bound = list.iter().map(|mode| mode.omega.rad / mode.omega.mid.hi.max(1e-300)).fold(0.0, f64::max);
    let error = match case.reference {
        Reference::None => f64::NAN,
        Reference::Hard(name, field) => worst(&list, &references(name, field)),
        Reference::Tighter(tolerance) => {
            let better = modes_as(&system, &request(tolerance)).expect("as before").list;
            let values: Vec<Number> = better.iter().map(|mode| Number::Ball(mode.omega)).collect();
            worst(&list, &values)
        }
    };
    let error = if error.is_nan() { String::new() } else { format!("{error:.0e}") };
    let method = list.last().map_or("", |mode| mode.route.name()).to_string();
    [
        case.name.into(),
        list.len().to_string(),
        format!("{lower:.3}"),
        format!("{time:.4}"),
        format!("{bound:.0e}"),
        error,
        method,
    ]
}

fn cells(case: &Case, lower: &str, modes: &str, bound: &str, method: String) -> [String; 7] {
    [case.name.into(), String::new(), lower.into(), modes.into(), bound.into(), String::new(), method]
}

fn lowered(text: String) -> Result<LinearSystem, String> {
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model("scene.vib", text));
    let parsed = vibc::syntax::parse(&sources, file);
    let checked = vibc::model::check(&sources, &parsed.tree, &Overrides::default());
    let outcome = vibc::lower::lower(&checked.scene.expect("a good model"));
    let code =
        outcome.diagnostics.into_sorted().first().map_or(String::new(), |diagnostic| diagnostic.code.0.to_string());
    outcome.lowered.map(|lowered| lowered.system).ok_or(code)
}

/// The largest relative error of an omega.
fn worst(list: &[Mode], references: &[Number]) -> f64 {
    let error = |mode: &Mode, truth: &Number| {
        let part = |x: f64| Number::from(Rational::from_f64(x).expect("finite"));
        let value = &part(mode.omega.mid.hi) + &part(mode.omega.mid.lo);
        ((&value - truth).to_f64() / truth.to_f64()).abs()
    };
    list.iter().zip(references).map(|(mode, truth)| error(mode, truth)).fold(0.0, f64::max)
}

fn references(name: &str, field: &str) -> Vec<Number> {
    let path = format!("{}/tests/hardcases/{name}.json", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).expect("a hard case");
    let json: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let list = json["reference"].as_array().expect("a list");
    list.iter().map(|entry| Number::from(entry[field].as_str().expect("a decimal"))).collect()
}

// ---- scenes

fn chain(n: usize) -> String {
    format!(
        "body m[1] {{ mass = 0.01 kg, moves x }}\nspring k[1]: ground -- m[1] {{ k = 1e6 N/m }}\n\
         repeat i in 2..{n} {{\n  body m[i] {{ mass = 0.01 kg, moves x }}\n\
         spring k[i]: m[i-1] -- m[i] {{ k = 1e6 N/m }}\n}}\n"
    )
}

/// A chain in which all masses and springs differ.
fn uneven_chain(n: usize) -> String {
    format!(
        "body m[1] {{ mass = 1.3 kg, moves x }}\nspring k[1]: ground -- m[1] {{ k = 977 N/m }}\n\
         repeat i in 2..{n} {{\n  body m[i] {{ mass = 1.3 kg + 0.7 kg * i / {n}, moves x }}\n\
         spring k[i]: m[i-1] -- m[i] {{ k = 1e3 N/m + i * 7.3e-3 N/m }}\n}}\n"
    )
}

/// Decimal digits from a linear congruential generator (Knuth's MMIX).
struct Digits(u64);

impl Digits {
    fn below(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % n
    }

    /// d.ddd with a random exponent from this many decades about zero.
    fn decimal(&mut self, decades: u64) -> String {
        let exponent = if decades == 0 { 0 } else { self.below(decades + 1) as i64 - decades as i64 / 2 };
        format!("{}.{:03}e{exponent}", 1 + self.below(9), self.below(1000))
    }
}

/// A tree in which each body hangs on one of the hundred before it.
fn tree(n: usize) -> String {
    let mut digits = Digits(7);
    let mut text = String::from("body m[1] { mass = 2 kg, moves x }\nspring g: ground -- m[1] { k = 5e3 N/m }\n");
    for i in 2..=n {
        let parent = (i - 1).saturating_sub(digits.below(100) as usize).max(1);
        let (m, k) = (digits.decimal(0), digits.decimal(2));
        text += &format!(
            "body m[{i}] {{ mass = {m} kg, moves x }}\nspring k[{i}]: m[{parent}] -- m[{i}] {{ k = {k} N/m }}\n"
        );
    }
    text
}

/// A square grid of springs, stiffnesses over twelve decades, held at a corner.
fn net(side: usize) -> String {
    let mut digits = Digits(11);
    let at = |i: usize, j: usize| i * side + j + 1;
    let mut text = String::from("spring g: ground -- m[1] { k = 3.7 N/m }\n");
    for i in 0..side {
        for j in 0..side {
            text += &format!("body m[{}] {{ mass = {} kg, moves x }}\n", at(i, j), digits.decimal(0));
            for other in [(j > 0).then(|| at(i, j - 1)), (i > 0).then(|| at(i - 1, j))].into_iter().flatten() {
                let k = digits.decimal(12);
                text += &format!("spring k[{other},{0}]: m[{other}] -- m[{0}] {{ k = {k} N/m }}\n", at(i, j));
            }
        }
    }
    text
}

/// o24 of tests/hardcases.
fn membrane(side: usize) -> String {
    let at = |i: usize, j: usize| i * side + j + 1;
    let mut text = String::new();
    for i in 0..side {
        for j in 0..side {
            let node = at(i, j);
            text += &format!("body m[{node}] {{ mass = 1 kg, moves x }}\n");
            let missing = [i == 0, i + 1 == side, j == 0, j + 1 == side].iter().filter(|&&edge| edge).count();
            if missing > 0 {
                text += &format!("spring g[{node}]: ground -- m[{node}] {{ k = {} N/m }}\n", 4096 * missing);
            }
            for other in [(j > 0).then(|| at(i, j - 1)), (i > 0).then(|| at(i - 1, j))].into_iter().flatten() {
                text += &format!("spring k[{other},{node}]: m[{other}] -- m[{node}] {{ k = 4096 N/m }}\n");
            }
        }
    }
    text
}

/// Links of 0.1 m in a row, hanging.
fn pendulum(n: usize) -> String {
    format!(
        "gravity 9.81 m/s^2\nbody link[1] {{ mass = 1 kg, shape = rod((0, 0), (0, -0.1 m)) }}\n\
         pivot p[1]: ground@(0, 0) -- link[1]\nrepeat i in 2..{n} {{\n\
         body link[i] {{ mass = 1 kg, shape = rod((0, -(i - 1) * 0.1 m), (0, -i * 0.1 m)) }}\n\
         pivot p[i]: link[i-1]@(0, -(i - 1) * 0.1 m) -- link[i]\n}}\n"
    )
}

/// Masses in a row with springs to the two before each, over eight decades.
fn net_of(n: usize) -> String {
    let mut digits = Digits(5);
    let mut text = String::from("spring g: ground -- m[1] { k = 3.7 N/m }\n");
    for i in 1..=n {
        text += &format!("body m[{i}] {{ mass = {} kg, moves x }}\n", digits.decimal(0));
        for back in 1..=2 {
            if i > back {
                let k = digits.decimal(8);
                text += &format!("spring k[{i},{back}]: m[{}] -- m[{i}] {{ k = {k} N/m }}\n", i - back);
            }
        }
    }
    text
}

/// Each mass on springs to five of the masses before it, anywhere.
fn spread(n: usize, decades: u64) -> String {
    let mut digits = Digits(13);
    let mut text = String::from("spring g: ground -- m[1] { k = 3.7 N/m }\n");
    for i in 1..=n {
        text += &format!("body m[{i}] {{ mass = {} kg, moves x }}\n", digits.decimal(0));
        for number in 1..=5.min(i - 1) {
            let (other, k) = (1 + digits.below(i as u64 - 1), digits.decimal(decades));
            text += &format!("spring k[{i},{number}]: m[{other}] -- m[{i}] {{ k = {k} N/m }}\n");
        }
    }
    text
}

/// Equal masses, each on an equal spring to every other: all frequencies but the first are equal.
fn complete(n: usize) -> String {
    format!(
        "body m[1] {{ mass = 2 kg, moves x }}\nspring g: ground -- m[1] {{ k = 3 N/m }}\n\
         repeat i in 2..{n} {{\n  body m[i] {{ mass = 2 kg, moves x }}\n  spring g[i]: ground -- m[i] {{ k = 3 N/m }}\n\
         repeat j in 1..i-1 {{\n    spring k[i,j]: m[j] -- m[i] {{ k = 7 N/m }}\n  }}\n}}\n"
    )
}

/// Only the eigenvectors of a pseudo-random symmetric matrix, for comparison with LAPACK: mean seconds of a few runs.
fn reductions(out: &mut impl Write) {
    for n in [12, 30, 100, 200, 400, 1000, 2000] {
        let mut digits = Digits(17);
        let mut matrix = Matrix::fill_with(n, n, 0.0);
        for j in 0..n {
            for i in 0..=j {
                let entry = digits.below(1_000_000) as f64 * 1e-6 - 0.5;
                (matrix[(i, j)], matrix[(j, i)]) = (entry, entry);
            }
        }
        // The kernel's clock ticks in milliseconds.
        let runs = (100_000_000 / (n * n * n)).max(2);
        let clock = Clock::start();
        for _ in 0..runs {
            std::hint::black_box(symmetric::eigen(matrix.clone()));
        }
        writeln!(out, "eigenvectors of a matrix of {n}: {:.6} s", clock.seconds() / runs as f64)
            .expect("standard output");
    }
}

// ---- time

/// Processor time if the kernel reports it, so that a busy machine does not matter; otherwise wall-clock time.
struct Clock {
    wall: Instant,
    processor: Option<f64>,
}

impl Clock {
    fn start() -> Clock {
        Clock { wall: Instant::now(), processor: processor_seconds() }
    }

    fn seconds(&self) -> f64 {
        let processor = self.processor.and_then(|start| Some(processor_seconds()? - start));
        processor.unwrap_or_else(|| self.wall.elapsed().as_secs_f64())
    }
}

/// Nanoseconds on a processor: the first field of /proc/self/schedstat (Documentation/scheduler/sched-stats.rst).
fn processor_seconds() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/schedstat").ok()?;
    Some(text.split_whitespace().next()?.parse::<f64>().ok()? * 1e-9)
}
