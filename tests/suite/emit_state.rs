//! The state of emitted code in the model's own coordinates, outputs that follow the rate of an input, and adjustable
//! parameters, compared with the exact response of the same model. See docs/method/emit.md.

use super::emit::{emission, options, parameterised, silently, write};
use super::systems::number;
use std::fs;
use std::process::Command;
use tempfile::TempDir;
use vibc::analysis::discrete::{Hold, Options, Precision};
use vibc::analysis::{Signal, respond};
use vibc::backend::emit::{self, Language};
use vibc::base::{Number, SourceFile, SourceKind, Sources};
use vibc::model::Overrides;
use vibc::system::{CoordinateId, LinearSystem};

/// A base that shakes bodies through springs and dampers: it acts directly and through its rate.
const FLOOR: &str = "base floor { moves x }\nbody a { mass = 2 kg, moves x }\nbody b { mass = 1 kg, moves x }\n\
                     spring s: floor -- a { k = 300 N/m }\nspring t: a -- b { k = 200 N/m }\noutput xa = a.x\n";
/// Dampers that couple the modes, and some that do not.
const COUPLED: &str = "damper d: floor -- a { c = 4 N*s/m }\noutput f = d.force\n";
const UNCOUPLED: &str =
    "damper d: floor -- a { c = 1.5 N*s/m }\ndamper e: a -- b { c = 1 N*s/m }\noutput f = d.force\n";
/// A base that moves inertia: its acceleration enters the rates of the coordinates.
const CARRIED: &str = "gravity 9.81 m/s^2\nbase floor { moves x }\nbody rod { mass = 1 kg, shape = rod((0, 0), (0, -1 m)) }\n\
                       pivot p: floor@(0, 0) -- rod\ndamper d: floor -- rod { c = 0.4 N*m*s/rad }\noutput q = rod.angle\n";

/// More numbers than are written out: the state uses tables.
fn long(n: usize) -> String {
    let mut text = String::from(FLOOR) + UNCOUPLED;
    for i in 0..n {
        let before = if i == 0 { "b".into() } else { format!("m{}", i - 1) };
        text += &format!(
            "body m{i} {{ mass = 1.{i} kg, moves x }}\nspring s{i}: {before} -- m{i} {{ k = 200 N/m }}\n\
             damper d{i}: {before} -- m{i} {{ c = 1 N*s/m }}\n"
        );
    }
    text
}

fn linear(text: &str) -> LinearSystem {
    let mut sources = Sources::new();
    let model = sources.add(SourceFile::decode(SourceKind::Model, "model.vib", text.as_bytes().to_vec()));
    vibc::linear(&sources, model, &Overrides::default()).answer.expect("a system").1
}

/// Compiles `main.c` with the sources of the folder, runs it, and returns the printed numbers.
pub fn numbers(folder: &TempDir, main: &str, sources: &[String]) -> Vec<f64> {
    fs::write(folder.path().join("main.c"), main).expect("a file");
    let sources: Vec<&str> = sources.iter().map(String::as_str).collect();
    silently(folder, "gcc", &[&["-std=c99", "-O1", "-o", "program", "main.c"][..], &sources].concat());
    let output = Command::new(folder.path().join("program")).output().expect("it runs");
    let text = String::from_utf8(output.stdout).expect("text");
    text.split_whitespace().map(|x| x.parse().expect("a number")).collect()
}

/// Displacements, then velocities, of all coordinates at a time while a signal moves the base.
fn moved(system: &LinearSystem, signal: &Signal, time: &str) -> Vec<f64> {
    let mut system = system.clone();
    let output = system.outputs[0].clone();
    system.outputs.clear();
    for power in 0..2 {
        for i in 0..system.n() {
            let mut own = output.clone();
            own.d.iter_mut().for_each(Vec::clear);
            own.p.iter_mut().for_each(Vec::clear);
            own.p[power] = vec![(CoordinateId(i as u32), Number::ONE)];
            system.outputs.push(own);
        }
    }
    let history = respond(&system, &[vec![signal.clone()]], &[number(time)]).expect("a motion");
    history.values[0].iter().map(|x| x.to_f64()).collect()
}

/// Code of so many states that tables would fill it has the same steps without `set_state` and `get_state`: it passes the compilers
/// as strictly as any other, and its header says what is missing.
#[test]
fn code_without_tables_steps_alone() {
    let whole = emission("plant", &(String::from(FLOOR) + COUPLED), &options("0.01")).system;
    assert!(whole.tabled);
    let mut bare = whole.clone();
    bare.tabled = false;
    (bare.offset, bare.taken) = (Vec::new(), Vec::new());
    bare.cells.iter_mut().for_each(|cell| (cell.to, cell.back) = (Vec::new(), Vec::new()));
    let folder = tempfile::tempdir().expect("a folder");
    let (mut includes, mut main) = (String::new(), String::new());
    for (name, system) in [("plant", &whole), ("bare", &bare)] {
        for language in [Language::C, Language::Rust] {
            write(&folder, &emit::files(name, system, language, None));
        }
        includes += &format!("#include \"{name}.h\"\n");
        main += &format!(
            "{{ {name}_state s; {name}_outputs y; {name}_inputs u; int k; u.floor = 0.3; {name}_init(&s);\n\
             for (k = 0; k <= 80; k++) {name}_step(&s, &u, &y); printf(\"%.17g\\n\", y.xa); }}\n"
        );
        silently(
            &folder,
            "rustc",
            &["--crate-type", "lib", "--emit", "metadata", "-D", "warnings", &format!("{name}.rs")],
        );
        let strict = ["-std=c99", "-c", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"];
        silently(&folder, "gcc", &[&strict[..], &[&format!("{name}.c")]].concat());
    }
    let main = format!("{includes}#include <stdio.h>\nint main(void) {{\n{main}return 0; }}\n");
    let printed = numbers(&folder, &main, &["plant.c".into(), "bare.c".into()]);
    assert_eq!(printed[0], printed[1]);
    for (file, says) in [("bare.h", false), ("bare.rs", false), ("plant.h", true), ("plant.rs", true)] {
        let text = fs::read_to_string(folder.path().join(file)).expect("a file");
        assert_eq!(text.contains("without set_state and get_state"), !says, "{file}");
        assert_eq!(text.contains("velocity"), says, "{file}");
    }
}

/// `get_state` gives the exact motion at the next sample, and passing the result to `set_state` changes neither the
/// motion then nor the rest. This holds for a given input, held or interpolated, and for a signal that is part of the
/// state.
#[test]
fn a_state_is_read_and_set_in_the_models_coordinates() {
    let floor = |dampers: &str| String::from(FLOOR) + dampers;
    // So many coordinates whose modes are coupled that the blocks are those of poles.
    let poles = long(12) + "damper aside: floor -- m5 { c = 9 N*s/m }\n";
    let models = [
        ("coupled", floor(COUPLED)),
        ("uncoupled", floor(UNCOUPLED)),
        ("carried", CARRIED.into()),
        ("long", long(23)),
        ("poles", poles),
    ];
    let held = Signal::Step { value: number("0.3"), at: Number::ZERO };
    let shaken =
        Signal::Harmonic { value: number("0.3"), frequency: number("1.1"), phase: number("0.4"), at: Number::ZERO };
    let folder = tempfile::tempdir().expect("a folder");
    let (mut sources, mut exact) = (Vec::new(), Vec::new());
    let (mut includes, mut main) = (String::new(), String::new());
    for (name, text) in &models {
        let system = linear(text);
        let given = "u.floor = 0.3;";
        let variants = [
            ("held", Hold::Zero, &held, given),
            ("line", Hold::First, &held, given),
            ("inside", Hold::Zero, &shaken, ""),
        ];
        for (variant, hold, signal, set) in variants {
            let built_in = set.is_empty();
            let moving = "base floor { moves x } = harmonic(0.3 m, 1.1 Hz, 0.4 rad)";
            let text = if built_in { text.replace("base floor { moves x }", moving) } else { text.clone() };
            let emission = emission(name, &text, &Options { hold, built_in, unpruned: true, ..options("0.01") });
            let name = format!("{name}_{variant}");
            write(&folder, &emit::files(&name, &emission.system, Language::C, None));
            sources.push(format!("{name}.c"));
            includes += &format!("#include \"{name}.h\"\n");
            let (inputs, input) = if built_in { (String::new(), "") } else { (format!("{name}_inputs u; "), "&u, ") };
            main += &format!(
                "{{ {name}_state s; {name}_outputs y; {name}_motion m; int k; {inputs}{set} {name}_init(&s);\n\
                 for (k = 0; k <= 80; k++) {{ {name}_step(&s, {input}&y);\n\
                 if (k == 39) {{ {name}_get_state(&s, &m); show(m.displacement, {n}); show(m.velocity, {n}); {name}_set_state(&s, &m);\n\
                 {name}_get_state(&s, &m); show(m.displacement, {n}); show(m.velocity, {n}); }} }}\n\
                 {name}_get_state(&s, &m); show(m.displacement, {n}); show(m.velocity, {n}); }}\n",
                n = system.n()
            );
            let first = moved(&system, signal, "0.4");
            exact.push((name, [first.clone(), first, moved(&system, signal, "0.81")]));
        }
    }
    let main = format!(
        "{includes}#include <stdio.h>\nstatic void show(const double *x, int n) {{ int i; for (i = 0; i < n; i++) printf(\"%.17g\\n\", x[i]); }}\n\
         int main(void) {{\n{main}return 0; }}\n"
    );
    let mut found = numbers(&folder, &main, &sources).into_iter();
    for (name, times) in &exact {
        for (time, exact) in times.iter().enumerate() {
            let largest = exact.iter().fold(0.0f64, |most, x| most.max(x.abs()));
            for (i, exact) in exact.iter().enumerate() {
                let value = found.next().expect("a number for each coordinate and rate");
                assert!((value - exact).abs() <= 1e-13 * largest, "{name}, {time}, {i}: {value:e} {exact:e}");
            }
        }
    }
    assert_eq!(found.next(), None);
}

/// An output that follows the rate of an input is exact with interpolation; if inputs are held, the header says what is
/// missing.
#[test]
fn an_output_follows_the_rate_of_an_input() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut sources, mut exact, mut main) = (Vec::new(), Vec::new(), String::new());
    let mut includes = String::from("#include <stdio.h>\n");
    for (name, dampers) in [("coupled", COUPLED), ("uncoupled", UNCOUPLED)] {
        let text = String::from(FLOOR) + dampers;
        let held = emission(name, &text, &options("0.01"));
        let header = emit::whole(name, &held.system, Language::C);
        assert!(header.contains("output f depends on the rate of an input"), "{header}");
        let line = emission(name, &text, &Options { hold: Hold::First, ..options("0.01") });
        let header = emit::whole(name, &line.system, Language::C);
        assert!(!header.contains("depends on the rate"), "{header}");
        write(&folder, &emit::files(name, &line.system, Language::C, None));
        sources.push(format!("{name}.c"));
        includes += &format!("#include \"{name}.h\"\n");
        main += &format!(
            "{{ {name}_state s; {name}_inputs u; {name}_outputs y; int k; {name}_init(&s);\n\
             for (k = 0; k <= 150; k++) {{ u.floor = 0.2 * (0.01 * k); {name}_step(&s, &u, &y); }}\n\
             printf(\"%.17g %.17g\\n\", y.xa, y.f); }}\n"
        );
        let ramp = Signal::Ramp { value: number("20"), from: Number::ZERO, to: number("100") };
        exact.extend(respond(&linear(&text), &[vec![ramp]], &[number("1.5")]).expect("a motion").values.remove(0));
    }
    let found = numbers(&folder, &format!("{includes}int main(void) {{\n{main}return 0; }}\n"), &sources);
    assert_eq!(found.len(), exact.len());
    for (value, exact) in found.iter().zip(&exact) {
        // A slope is a difference of inputs of 0.3, accurate to 1e-16 of that, over a step of 0.01 s.
        assert!((value - exact.to_f64()).abs() < 1e-13, "{value:e} {:e}", exact.to_f64());
    }
}

/// A parameter that couples masses, with a base as input, velocities as outputs and a state that is set: the motion is
/// that of the model with this value, at both ends of the range and between, for steps as long as the period of the
/// fastest motion.
#[test]
fn a_parameter_changes_masses_and_output_rows() {
    let text = "param m = 2 kg\nbase floor { moves x }\nbody cart { mass = m, moves x }\n\
                body rod { mass = 0.3 * m + 0.5 kg, shape = rod((0, 0), (0, -1 m)) }\npivot p: cart@(0, 0) -- rod\n\
                spring s: floor -- cart { k = 300 N/m }\ndamper d: ground -- cart { c = 4 N*s/m }\n\
                spring t: ground -- rod { k = 6 N*m/rad }\ninitial cart { x = 0.1 m, vx = -0.7 m/s }\noutput v = cart.vx\n\
                output q = rod.angle\noutput f = s.force\noutput a = rod.alpha\n";
    let system = parameterised(text, "m").expect("a polynomial");
    let folder = tempfile::tempdir().expect("a folder");
    write(&folder, &emit::parameter_files("par", &system, 0.05, Precision::Double, Language::C).expect("in range"));
    let main = "#include \"par.h\"\n#include <stdio.h>\nint main(void) { const double values[3] = {0.125, 5.0, 32.0}; par_state s;\n\
                par_inputs u; par_outputs y; par_motion m; int i, k; u.floor = 0.02; for (i = 0; i < 3; i++) {\n\
                par_init(&s); par_set_parameter(&s, values[i]); for (k = 0; k <= 20; k++) { par_step(&s, &u, &y);\n\
                if (k == 10) { par_get_state(&s, &m); par_reset(&s); par_set_parameter(&s, values[i]); par_set_state(&s, &m); } }\n\
                printf(\"%.17g %.17g %.17g %.17g\\n\", y.v, y.q, y.f, y.a); } return 0; }\n";
    let found = numbers(&folder, main, &["par.c".to_string()]);
    assert_eq!(found.len(), 12);
    for (found, value) in found.chunks(4).zip(["0.125", "5", "32"]) {
        let exact = linear(&text.replace("param m = 2 kg", &format!("param m = {value} kg")));
        let step = Signal::Step { value: number("0.02"), at: Number::ZERO };
        let exact = respond(&exact, &[vec![step]], &[Number::ONE]).expect("a motion");
        for (found, exact) in found.iter().zip(&exact.values[0]) {
            let exact = exact.to_f64();
            assert!((found - exact).abs() < 1e-12 * exact.abs().max(1.0), "{value}: {found} {exact}");
        }
    }
}
