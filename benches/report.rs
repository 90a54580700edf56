//! The complete certified modal report: all modes and all poles of chains and networks of 12, 30 and 100 masses,
//! without damping, with classical damping and with dampers of all sizes; then the 20 lowest modes and poles of large
//! systems. For each, the mean processor time of the modes and of the poles, the number of poles that are not certified
//! alone, and the largest bound.
//!
//! `cargo bench --bench report -- WORD...` runs the scenes whose names contain one of the words.

#![allow(clippy::disallowed_methods)]

#[allow(dead_code)]
mod clock;

use clock::Clock;
use std::io::Write;
use vibc::analysis::{Request, Which, modal, modes, modes_as, poles};
use vibc::base::source::{SourceFile, Sources};
use vibc::model::Overrides;
use vibc::system::LinearSystem;

/// How the masses are connected.
#[derive(Clone, Copy)]
enum Shape {
    /// Each to the one before.
    Chain,
    /// Each to the two before, and to a random one among all before.
    Network,
}

/// The kind of damping.
#[derive(Clone, Copy)]
enum Damping {
    None,
    /// C = alpha M + beta K.
    Classical,
    /// A damper parallel to each spring, with constants spread over this many decades around a value.
    Dampers {
        around: f64,
        decades: u64,
    },
}

const SIZES: [usize; 3] = [12, 30, 100];
const SHAPES: [(&str, Shape); 2] = [("chain", Shape::Chain), ("network", Shape::Network)];
const DAMPINGS: [(&str, Damping); 5] = [
    ("undamped", Damping::None),
    ("classical", Damping::Classical),
    ("light", Damping::Dampers { around: 1e-4, decades: 4 }),
    ("medium", Damping::Dampers { around: 0.3, decades: 1 }),
    ("heavy", Damping::Dampers { around: 1e3, decades: 6 }),
];

fn main() {
    let mut out = std::io::stdout().lock();
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    writeln!(out, "| scene | n | modes [ms] | poles [ms] | both | not alone | bound |").expect("standard output");
    writeln!(out, "| --- | --- | --- | --- | --- | --- | --- |").expect("standard output");
    for n in SIZES {
        for (shape_name, shape) in SHAPES {
            for (damping_name, damping) in DAMPINGS {
                let name = format!("{shape_name}, {damping_name}, {n}");
                if words.is_empty() || words.iter().any(|word| name.contains(word.as_str())) {
                    let system = lowered(scene(n, shape, damping));
                    writeln!(out, "| {shape_name}, {damping_name} | {n} | {} |", measured(&system))
                        .expect("standard output");
                }
            }
        }
    }
    for (name, text) in LARGE {
        if words.is_empty() || words.iter().any(|word| name.contains(word.as_str())) {
            let system = lowered(text());
            writeln!(out, "| {name} | {} | {} |", system.n(), lowest(&system)).expect("standard output");
        }
    }
}

/// Milliseconds and bounds of a system, as a row of the table.
fn measured(system: &LinearSystem) -> String {
    let found = modes(system).expect("modes");
    let list = poles(system, &found).expect("poles").list;
    let modes = mean(|| modes(system).expect("as before").list.len());
    let poles = mean(|| poles(system, &found).expect("as before").list.len());
    let together = list.iter().filter(|pole| pole.cluster.is_some() || pole.relative_error.is_infinite()).count();
    let bound = list.iter().map(|pole| pole.relative_error).fold(0.0, f64::max);
    format!("{modes:.2} | {poles:.2} | {:.2} | {together} | {bound:.0e}", modes + poles)
}

/// Scenes whose 20 lowest modes are requested.
type Large = (&'static str, fn() -> String);

const LARGE: [Large; 5] = [
    ("chain of 1,000, light", || scene(1000, Shape::Chain, Damping::Dampers { around: 0.01, decades: 2 })),
    ("chain of 1,000, medium", || scene(1000, Shape::Chain, Damping::Dampers { around: 10.0, decades: 2 })),
    ("chain of 100,000, light", || scene(100_000, Shape::Chain, Damping::Dampers { around: 0.01, decades: 2 })),
    ("net 60 x 60, 6 decades", || net(60, 6)),
    ("net 150 x 150, 12 decades", || net(150, 12)),
];

/// Times of the modes alone, and of modes with poles, in milliseconds.
fn lowest(system: &LinearSystem) -> String {
    let request = Request { which: Which::Lowest(20), ..Request::default() };
    let clock = Clock::start();
    modes_as(system, &request).expect("modes");
    let modes = clock.seconds() * 1e3;
    let clock = Clock::start();
    let list = modal(system, &request).expect("modes and poles").poles.list;
    let both = clock.seconds() * 1e3;
    let unproved = list.iter().filter(|pole| pole.relative_error.is_infinite()).count();
    let proved = list.iter().filter(|pole| pole.relative_error.is_finite());
    let bound = proved.map(|pole| pole.relative_error).fold(0.0, f64::max);
    format!("{modes:.0} | {:.0} | {both:.0} | {unproved} of {} | {bound:.0e}", both - modes, list.len())
}

/// The mean of as many runs as take half a second, because the kernel's clock ticks in milliseconds.
fn mean(run: impl Fn() -> usize) -> f64 {
    let (clock, mut count, mut found) = (Clock::start(), 0, 0);
    while clock.seconds() < 0.5 {
        found += run();
        count += 1;
    }
    assert!(found > 0);
    clock.seconds() * 1e3 / f64::from(count)
}

fn lowered(text: String) -> LinearSystem {
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model("scene.vib", text));
    vibc::linear(&sources, file, &Overrides::default()).answer.expect("a good model").1
}

/// Decimal digits from a linear congruential generator (Knuth's MMIX).
struct Digits(u64);

impl Digits {
    fn below(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % n
    }

    /// Three or four digits, spread over this many decades around a value.
    fn decimal(&mut self, around: f64, decades: u64) -> String {
        let exponent = if decades == 0 { 0 } else { self.below(decades + 1) as i32 - decades as i32 / 2 };
        let digits = 1.0 + self.below(9) as f64 + self.below(1000) as f64 / 1000.0;
        format!("{digits:.3}e{}", around.log10().floor() as i32 + exponent)
    }
}

fn scene(n: usize, shape: Shape, damping: Damping) -> String {
    let mut digits = Digits(3);
    let mut text = match damping {
        Damping::Classical => "damping rayleigh(0.01 /s, 1e-4 s)\n".to_string(),
        _ => String::new(),
    };
    for i in 1..=n {
        text += &format!("body m[{i}] {{ mass = {} kg, moves x }}\n", digits.decimal(1.0, 0));
        let mut others = vec![i - 1];
        if let Shape::Network = shape {
            others.extend((i > 2).then(|| i - 2));
            others.extend((i > 4).then(|| 1 + digits.below(i as u64 - 3) as usize));
        }
        for other in others {
            let (k, end) = (digits.decimal(1e3, 2), if other == 0 { "ground".into() } else { format!("m[{other}]") });
            text += &format!("spring k[{i},{other}]: {end} -- m[{i}] {{ k = {k} N/m }}\n");
            if let Damping::Dampers { around, decades } = damping {
                let c = digits.decimal(around, decades);
                text += &format!("damper c[{i},{other}]: {end} -- m[{i}] {{ c = {c} N*s/m }}\n");
            }
        }
    }
    text
}

/// A square grid of springs spread over this many decades, held at a corner, with dampers of 1e-4 to 1e-2 s times their
/// stiffness.
fn net(side: usize, decades: u64) -> String {
    let mut digits = Digits(11);
    let at = |i: usize, j: usize| i * side + j + 1;
    let mut text = String::from("spring g: ground -- m[1] { k = 3.7 N/m }\n");
    for i in 0..side {
        for j in 0..side {
            text += &format!("body m[{}] {{ mass = {} kg, moves x }}\n", at(i, j), digits.decimal(1.0, 0));
            for other in [(j > 0).then(|| at(i, j - 1)), (i > 0).then(|| at(i - 1, j))].into_iter().flatten() {
                let (k, c) = (digits.decimal(1.0, decades), digits.decimal(1e-3, 2));
                let ends = format!("m[{other}] -- m[{}]", at(i, j));
                text += &format!("spring k[{other},{}]: {ends} {{ k = {k} N/m }}\n", at(i, j));
                text += &format!("damper c[{other},{}]: {ends} {{ c = {k} * {c} N*s/m }}\n", at(i, j));
            }
        }
    }
    text
}
