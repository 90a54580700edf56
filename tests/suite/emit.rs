//! Emitted code: compiled with the strictest warnings, run, and compared with the exact response.
//! See docs/method/emit.md.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;
use vibc::analysis::Signal;
use vibc::analysis::discrete::parameter::Parameterised;
use vibc::analysis::discrete::{Hold, Options, Precision};
use vibc::backend::emit::{self, Language};
use vibc::base::{Number, SourceFile, SourceKind, Sources};
use vibc::model::Overrides;

/// Flags under which emitted C must compile without warnings.
pub const STRICT: [&str; 7] =
    ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wdouble-promotion", "-Werror"];
/// Such flags for a C++ compiler.
const STRICT_CPP: [&str; 7] = ["-x", "c++", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"];

pub fn options(step: &str) -> Options {
    Options {
        step: Number::from(step),
        hold: Hold::Zero,
        precision: Precision::Double,
        tolerance: None,
        unpruned: false,
        built_in: false,
        internal: Vec::new(),
        until: None,
    }
}

/// The discrete system that emitted code of a model computes.
pub fn emission(name: &str, text: &str, options: &Options) -> vibc::Emission {
    let mut sources = Sources::new();
    let model = sources.add(SourceFile::decode(SourceKind::Model, name, text.as_bytes().to_vec()));
    crate::examples::add_used_files(&mut sources, model);
    let outcome = vibc::discrete(&sources, model, &Overrides::default(), options);
    outcome.answer.unwrap_or_else(|| panic!("{name}: {:?}", outcome.diagnostics))
}

/// The examples that have outputs and signals of known course: name and text. Code for noise and response spectra is refused, and so is that
/// for an unbalance whose rotation is not built in.
pub fn examples() -> Vec<(String, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let mut files: Vec<_> =
        fs::read_dir(folder).expect("examples").map(|entry| entry.expect("an example").path()).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "vib"));
    files.sort();
    let text = |path: &Path| fs::read_to_string(path).expect("an example");
    let name = |path: &Path| path.file_stem().expect("a name").to_string_lossy().into_owned();
    let all = files.iter().map(|path| (name(path), text(path)));
    let is_refused =
        |text: &str| ["= noise(", "= spectrum(", "\nunbalance ", "loss = "].iter().any(|word| text.contains(word));
    let can_be_emitted = |text: &str| !is_refused(text) && text.lines().any(|line| line.starts_with("output"));
    all.filter(|(_, text)| can_be_emitted(text)).collect()
}

pub fn write(folder: &TempDir, files: &[emit::File]) {
    for file in files {
        fs::write(folder.path().join(&file.name), &file.text).expect("a temporary file");
    }
}

/// Runs a tool in a folder; it must succeed without output.
pub fn silently(folder: &TempDir, tool: &str, arguments: &[&str]) {
    let output = run(folder, tool, arguments);
    let messages = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && messages.is_empty(), "{tool} {arguments:?}: {messages}");
}

fn run(folder: &TempDir, tool: &str, arguments: &[&str]) -> Output {
    let output = Command::new(tool).args(arguments).current_dir(folder.path()).output();
    output.unwrap_or_else(|error| panic!("`{tool}` is needed by this test (README.md, \"Tests\"): {error}"))
}

/// Every example in every style, under different names: C and Rust.
fn every_style(folder: &TempDir) -> Vec<String> {
    let mut names = Vec::new();
    for (name, text) in examples() {
        let mut add = |style: &str, files: &dyn Fn(&str, Language) -> Vec<emit::File>| {
            let name = format!("{name}_{style}");
            [Language::C, Language::Rust].into_iter().for_each(|language| write(folder, &files(&name, language)));
            names.push(name);
        };
        let single = Options { precision: Precision::Single, hold: Hold::First, ..options("0.01") };
        let internal = Options { built_in: true, ..options("0.01") };
        for (style, wanted) in [("held", options("0.01")), ("single", single), ("internal", internal)] {
            let emission = emission(&name, &text, &wanted);
            add(style, &|name, language| emit::files(name, &emission.system, language, None));
        }
        let mut sources = Sources::new();
        let model = sources.add(SourceFile::decode(SourceKind::Model, &name, text.clone().into_bytes()));
        crate::examples::add_used_files(&mut sources, model);
        let (_, system) = vibc::linear(&sources, model, &Overrides::default()).answer.expect("a system");
        if let Ok(equations) = vibc::analysis::discrete::equations::equations(&system, Precision::Double) {
            add("equations", &|name, language| emit::equation_files(name, &equations, language));
        }
    }
    let system = parameterised(SPRINGS, "k").expect("a polynomial");
    for (name, precision) in [("parameter", Precision::Double), ("parameter_single", Precision::Single)] {
        for language in [Language::C, Language::Rust] {
            write(folder, &emit::parameter_files(name, &system, 0.001, precision, language).expect("in range"));
        }
        names.push(name.to_string());
    }
    names
}

#[test]
fn emitted_code_compiles_without_a_word() {
    let folder = tempfile::tempdir().expect("a folder");
    let names = every_style(&folder);
    let sources: Vec<String> = names.iter().map(|name| format!("{name}.c")).collect();
    let sources: Vec<&str> = sources.iter().map(String::as_str).collect();
    // Some warnings of gcc come from its optimiser.
    silently(&folder, "gcc", &[&STRICT[..], &["-c", "-O1"], &sources].concat());
    silently(&folder, "g++", &[&STRICT_CPP[..], &["-fsyntax-only"], &sources].concat());
    as_a_crate(&folder, &names, "rustc");
}

#[test]
#[ignore = "needs clang, clang++ and clippy"]
fn other_compilers_give_no_warnings_either() {
    let folder = tempfile::tempdir().expect("a folder");
    let names = every_style(&folder);
    let sources: Vec<String> = names.iter().map(|name| format!("{name}.c")).collect();
    let sources: Vec<&str> = sources.iter().map(String::as_str).collect();
    for (compiler, flags) in [("clang", STRICT), ("clang++", STRICT_CPP)] {
        silently(&folder, compiler, &[&flags[..], &["-fsyntax-only"], &sources].concat());
    }
    as_a_crate(&folder, &names, "clippy-driver");
}

/// Compiles Rust code as a crate of its own, without `std`.
fn as_a_crate(folder: &TempDir, names: &[String], compiler: &str) {
    let modules: String = names.iter().map(|name| format!("pub mod {name};\n")).collect();
    let crate_text = format!("#![no_std]\n#![forbid(unsafe_code)]\n#![deny(warnings)]\n{modules}");
    fs::write(folder.path().join("lib.rs"), crate_text).expect("a temporary file");
    silently(folder, compiler, &["--edition", "2021", "--crate-type", "lib", "--emit", "metadata", "lib.rs"]);
}

#[test]
fn the_same_model_gives_the_same_bytes() {
    for (name, text) in examples() {
        let one = |_: usize| {
            let emission = emission(&name, &text, &options("0.001"));
            [Language::C, Language::Rust].map(|language| emit::whole(&emission.model, &emission.system, language))
        };
        assert_eq!(one(0), one(1), "{name}");
    }
}

/// Equations of motion integrated by the Runge-Kutta method reach the exact response to the accuracy of the step.
#[test]
fn equations_are_those_of_the_model() {
    let text = "gravity 9.81 m/s^2\nbase floor { moves x }\nbody cart { mass = 2 kg, moves x }\n\
                body rod { mass = 1 kg, shape = rod((0, 0), (0, -1 m)) }\npivot p: cart@(0, 0) -- rod\n\
                body far { mass = 3 kg, moves x }\nspring s: floor -- cart { k = 300 N/m }\n\
                damper d: floor -- cart { c = 4 N*s/m }\nspring t: cart -- far { k = 200 N/m }\n\
                damper e: cart -- far { c = 1 N*s/m }\ninitial far { x = 0.1 m }\noutput q = rod.angle\n\
                output a = far.ax\noutput f = s.force\n";
    let mut sources = Sources::new();
    let model = sources.add(SourceFile::decode(SourceKind::Model, "rig.vib", text.as_bytes().to_vec()));
    let (_, system) = vibc::linear(&sources, model, &Overrides::default()).answer.expect("a system");
    let equations = vibc::analysis::discrete::equations::equations(&system, Precision::Double).expect("masses");
    let folder = tempfile::tempdir().expect("a folder");
    for language in [Language::C, Language::Rust] {
        write(&folder, &emit::equation_files("rig", &equations, language));
    }
    // u = 0.2 t on the floor, starting at rest except for `far`.
    let c = r#"#include "rig.h"
#include <stdio.h>
static rig_motion moved(const rig_motion *a, const rig_motion *b, double h) {
    rig_motion m; int i;
    for (i = 0; i < 3; i++) {
        m.displacement[i] = a->displacement[i] + h * b->displacement[i];
        m.velocity[i] = a->velocity[i] + h * b->velocity[i];
    }
    return m;
}
int main(void) {
    const double h = 0.0005; rig_motion x, k1, k2, k3, k4; rig_inputs u; rig_outputs y; int n;
    rig_init(&x); u.floor_rate = 0.2;
    for (n = 0; n < 4000; n++) {
        rig_motion at;
        u.floor = 0.2 * h * n; rig_derivative(&x, &u, &k1);
        u.floor += 0.1 * h; at = moved(&x, &k1, h / 2); rig_derivative(&at, &u, &k2);
        at = moved(&x, &k2, h / 2); rig_derivative(&at, &u, &k3);
        u.floor += 0.1 * h; at = moved(&x, &k3, h); rig_derivative(&at, &u, &k4);
        x = moved(&x, &k1, h / 6); x = moved(&x, &k2, h / 3); x = moved(&x, &k3, h / 3); x = moved(&x, &k4, h / 6);
    }
    rig_observe(&x, &u, &y);
    printf("%.17g %.17g %.17g\n", y.q, y.a, y.f);
    return 0;
}
"#;
    let rust = r#"mod rig;
use rig::{Inputs, Motion};
fn moved(a: &Motion, b: &Motion, h: f64) -> Motion {
    let mut m = *a;
    for i in 0..3 {
        m.displacement[i] = a.displacement[i] + h * b.displacement[i];
        m.velocity[i] = a.velocity[i] + h * b.velocity[i];
    }
    m
}
fn main() {
    let (h, mut x, mut u) = (0.0005, Motion::init(), Inputs { floor: 0.0, floor_rate: 0.2 });
    for n in 0..4000 {
        u.floor = 0.2 * h * f64::from(n);
        let k1 = x.derivative(&u);
        u.floor += 0.1 * h;
        let k2 = moved(&x, &k1, h / 2.0).derivative(&u);
        let k3 = moved(&x, &k2, h / 2.0).derivative(&u);
        u.floor += 0.1 * h;
        let k4 = moved(&x, &k3, h).derivative(&u);
        x = moved(&x, &k1, h / 6.0);
        x = moved(&x, &k2, h / 3.0);
        x = moved(&x, &k3, h / 3.0);
        x = moved(&x, &k4, h / 6.0);
    }
    let y = x.observe(&u);
    println!("{} {} {}", y.q, y.a, y.f);
}
"#;
    fs::write(folder.path().join("main.c"), c).expect("a file");
    fs::write(folder.path().join("main.rs"), rust).expect("a file");
    silently(&folder, "gcc", &[&STRICT[..], &["-c", "-O1", "rig.c", "-o", "rig.o"]].concat());
    silently(&folder, "gcc", &["-std=c99", "-O1", "main.c", "rig.o", "-o", "c"]);
    silently(&folder, "rustc", &["-C", "opt-level=1", "main.rs", "-o", "r"]);
    let numbers = |program: &str| -> Vec<f64> {
        let output = run(&folder, &folder.path().join(program).to_string_lossy(), &[]);
        let text = String::from_utf8(output.stdout).expect("text");
        text.split_whitespace().map(|x| x.parse().expect("a number")).collect()
    };
    let (c, r) = (numbers("c"), numbers("r"));
    let ramp = Signal::Ramp { value: Number::from(20), from: Number::ZERO, to: Number::from(100) };
    let exact = vibc::analysis::respond(&system, &[vec![ramp]], &[Number::from(2)]).expect("a motion");
    for ((c, r), exact) in c.iter().zip(&r).zip(&exact.values[0]) {
        assert_eq!(c, r);
        // The method's own error at this step: (w h)^4 for the fastest motion, 17 rad/s, over 2 s.
        assert!((c - exact.to_f64()).abs() < 1e-8, "{c} {}", exact.to_f64());
    }
}

const SPRINGS: &str = "param k = 300 N/m\nbody a { mass = 2 kg, moves x }\nbody b { mass = 3 kg, moves x }\n\
                       spring s: ground -- a { k = 2*k }\ndamper d: ground -- a { c = 4 N*s/m }\n\
                       spring t: a -- b { k = 200 N/m + k }\ndamper e: a -- b { c = 1 N*s/m }\nforce F: a along x\n\
                       initial b { x = 0.1 m }\noutput xa = a.x\noutput acc = b.ax\noutput f = s.force\n";

/// A model as a function of a parameter.
pub fn parameterised(text: &str, name: &str) -> Result<Parameterised, String> {
    let mut sources = Sources::new();
    let model = sources.add(SourceFile::decode(SourceKind::Model, "par.vib", text.as_bytes().to_vec()));
    vibc::over_parameter(&sources, model, &Overrides::default(), name).answer.expect("a model").1
}

/// A parameter set at run time gives the motion of the model with that value, both in C and in Rust; a parameter that
/// cannot stay adjustable is refused with the reason.
#[test]
fn a_parameter_stays_changeable() {
    let (text, read) = (SPRINGS, parameterised);
    let system = read(text, "k").expect("a polynomial");
    let folder = tempfile::tempdir().expect("a folder");
    for language in [Language::C, Language::Rust] {
        write(&folder, &emit::parameter_files("par", &system, 0.001, Precision::Double, language).expect("in range"));
    }
    let c = "#include \"par.h\"\n#include <stdio.h>\nint main(void) { par_state s; par_inputs u; par_outputs y; int k; u.F = 3.0; \
             par_init(&s); par_set_parameter(&s, 450.0); for (k = 0; k <= 2000; k++) par_step(&s, &u, &y); \
             printf(\"%.17g %.17g %.17g\\n\", y.xa, y.acc, y.f); return 0; }\n";
    let rust = "mod par;\nfn main() { let mut s = par::State::init(); s.set_parameter(450.0); let u = par::Inputs { F: 3.0 }; \
                let mut y = s.step(&u); for _ in 0..2000 { y = s.step(&u); } println!(\"{} {} {}\", y.xa, y.acc, y.f); }\n";
    fs::write(folder.path().join("main.c"), c).expect("a file");
    fs::write(folder.path().join("main.rs"), rust).expect("a file");
    silently(&folder, "gcc", &[&STRICT[..], &["-c", "-O1", "par.c", "-o", "par.o"]].concat());
    silently(&folder, "gcc", &["-std=c99", "-O1", "main.c", "par.o", "-o", "c"]);
    silently(&folder, "rustc", &["-C", "opt-level=1", "main.rs", "-o", "r"]);
    let numbers = |program: &str| -> Vec<f64> {
        let output = run(&folder, &folder.path().join(program).to_string_lossy(), &[]);
        let text = String::from_utf8(output.stdout).expect("text");
        text.split_whitespace().map(|x| x.parse().expect("a number")).collect()
    };
    let (c, r) = (numbers("c"), numbers("r"));
    let mut sources = Sources::new();
    let other = text.replace("300", "450");
    let model = sources.add(SourceFile::decode(SourceKind::Model, "par.vib", other.into_bytes()));
    let (_, exact) = vibc::linear(&sources, model, &Overrides::default()).answer.expect("a system");
    let step = Signal::Step { value: Number::from(3), at: Number::ZERO };
    let exact = vibc::analysis::respond(&exact, &[vec![step]], &[Number::from(2)]).expect("a motion");
    for ((c, r), exact) in c.iter().zip(&r).zip(&exact.values[0]) {
        assert_eq!(c, r);
        assert!((c - exact.to_f64()).abs() < 1e-12 * exact.to_f64().abs().max(1.0), "{c} {}", exact.to_f64());
    }
    assert!(read(text, "zz").is_err_and(|reason| reason.contains("the parameters are k")));
    let root = text.replace("2*k", "sqrt(k*400 N/m)");
    assert!(read(&root, "k").is_err_and(|reason| reason.contains("polynomial")));
}
