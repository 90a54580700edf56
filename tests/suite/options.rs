//! Every option of every command, from the table with which the program itself reads its command line: with right and
//! with wrong values, each run ends with the expected status and one clean message, and none is a defect. An option
//! without a line in `VALUES` fails the test. See docs/cli.md#streams-and-exit-status.

use clap::{Arg, ArgAction, Command, CommandFactory};
use std::fs;
use std::process::{self, Stdio};
use tempfile::TempDir;
use vibc::cli;

const SCENE: &str = "model scene\nparam k = 10 N/m\nbody b { mass = 1 kg, moves x }\nspring s: ground -- b { k = k }\n\
                     damper d: ground -- b { c = 0.1 N*s/m }\nforce F: b along x = step(1 N, 0 s)\noutput x = b.x\n\
                     require peak(x) > 0 m\n";
/// A base with a signal, for `shock`.
const DROP: &str = "param k = 10 N/m\nbody b { mass = 1 kg, moves x }\nbase t { moves x } = step(1 m/s^2, 0 s)\n\
                    spring s: t -- b { k = k }\n";
/// A model with noise, for `--seed`.
const SHAKEN: &str = "param k = 10 N/m\nbody b { mass = 1 kg, moves x }\nspring s: ground -- b { k = k }\n\
                      damper d: ground -- b { c = 1 N*s/m }\nforce F: b along x = noise(1 N^2/Hz, 1 Hz .. 2 Hz)\n\
                      output x = b.x\n";
const RANDOM: &str =
    "param k = 10 N/m spread 3 % within 5 %\nbody b { mass = 1 kg, moves x }\nspring s: ground -- b { k = k }\n";
/// A finished part of a sweep, for `merge`.
const PART: &str = "# vibc sweep part 0/1 of 1 cases, study 0\ncase,code\n0,\n\
                    # end 50ed32d4e0357aea2e1ab323dd8e40ce6510afadfecca5a806dc6e2f27088a04\n";
const SETTINGS: &str = "k = \"12 N/m\"\n";

/// The expected exit status for a right value.
#[derive(Clone, Copy)]
enum Good {
    Done(&'static str),
    Ends(&'static str, i32),
}
use Good::{Done, Ends};

/// Values of options for which clap has no list: the command (`*` for all), the option, right values, wrong values. `@`
/// is a folder with the files that are written below.
type Values = (&'static str, &'static str, &'static [Good], &'static [&'static str]);

const TIMES: [&str; 8] = ["", "s", "0s", "-1s", "1", "1kg", "1e400s", "soon"];

const VALUES: [Values; 54] = [
    (
        "*",
        "set",
        &[Done("k=12N/m"), Done(" k = 12 N/m "), Ends("k=12kg", 1), Ends("q=1", 1), Ends("k=(", 1)],
        &["", "k", "k=", "=1", "k=1\n"],
    ),
    ("*", "settings", &[Done("@/settings.toml"), Ends("@/missing.toml", 3), Ends("@/scene.vib", 1)], &[]),
    ("*", "root", &[Done("@"), Done("@/missing"), Done("/")], &[]),
    (
        "analyze",
        "modes",
        &[Done("1"), Done("100000")],
        &["0", "-1", "100001", "1.5", "all", "", "99999999999999999999"],
    ),
    (
        "analyze",
        "band",
        &[Done("0.1Hz..1Hz"), Done("0..1rad/s"), Done("0Hz..1e300Hz")],
        &["", "..", "1Hz..", "1Hz", "2Hz..1Hz", "1Hz..1Hz", "1s..2s", "1..2", "-1Hz..-2Hz"],
    ),
    ("analyze", "digits", &[Done("1"), Done("32")], &["0", "33", "-1", "many", ""]),
    (
        "*",
        "tolerance",
        &[Done("1e-3"), Done("0.999"), Done("1e-9")],
        &["0", "1", "-1e-3", "nan", "inf", "1e-400", "1 %", ""],
    ),
    ("*", "until", &[Done("1s"), Done("0.25s"), Done("20ms"), Done("1min")], &TIMES),
    ("transfer", "from", &[Done("F"), Ends("s", 2), Ends("", 2)], &[]),
    ("transfer", "to", &[Done("x"), Ends("b.x", 2), Ends("", 2)], &[]),
    (
        "transfer",
        "range",
        &[Done("0.1Hz..10Hz"), Done("0..10rad/s"), Done("1rad/s..1Hz")],
        &["", "..", "1Hz", "1Hz..", "2Hz..1Hz", "0Hz..0Hz", "1..2", "1N..2N", "1Hz...2Hz"],
    ),
    ("transfer", "points", &[Done("1"), Done("2"), Done("7")], &["0", "-1", "1000001", "1.5", "", "few"]),
    (
        "transfer",
        "at",
        &[Done("1Hz"), Done("0"), Done("0Hz"), Done("3rad/s"), Done("60rpm")],
        &["", "1", "1s", "Hz", "x", "1Hz2"],
    ),
    ("shock", "from", &[Done("t"), Ends("b", 2), Ends("", 2)], &[]),
    (
        "shock",
        "damping",
        &[Done("5%"), Done("5 %"), Done("0.05"), Done("0"), Done("0 %"), Done("2"), Done("-0")],
        &["", "%", "-5%", "-0.1", "5%%", "5 kg", "1e400", "little"],
    ),
    // Alone it is the name of a file.
    ("shock", "percent", &[Ends("%", 3)], &[]),
    ("shock", "output", &[Done("@/out"), Done("-"), Ends("@/missing/out", 3), Ends("@/drop.vib", 2)], &[]),
    ("shock", "svg", &[Done("@/picture.svg"), Ends("@/missing/p.svg", 3), Ends("@/drop.vib", 2)], &[]),
    (
        "shock",
        "range",
        &[Done("0.1Hz..10Hz"), Done("1rad/s..1Hz"), Ends("0..10rad/s", 2)],
        &["", "..", "1Hz", "1Hz..", "2Hz..1Hz", "1Hz..1Hz", "0Hz..0Hz", "-1Hz..2Hz", "1..2", "1N..2N"],
    ),
    ("shock", "points", &[Done("1"), Done("2"), Done("7")], &["0", "-1", "100001", "1.5", "", "few"]),
    ("shock", "at", &[Done("1Hz"), Ends("0", 2), Ends("-1Hz", 2), Done("3rad/s")], &["", "1", "1s", "Hz"]),
    (
        "shock",
        "file",
        &[
            Done("@/drop.vib"),
            Ends("@/scene.vib", 2),
            Ends("@/missing.vib", 3),
            Ends("@", 3),
            Ends("@/settings.toml", 1),
            Ends("@/bytes", 1),
            Ends("-", 1),
        ],
        &[],
    ),
    (
        "sweep",
        "over",
        &[
            Done("k=5N/m..50N/m:3"),
            Done(" k = 5 N/m , 6 N/m "),
            Done("k=0,1N/m"),
            Ends("q=1,2", 1),
            Ends("b=1kg", 1),
            Ends("k=1kg,2kg", 1),
            Ends("k=2N/m..1N/m:3", 1),
            Ends("k=1N/m..1N/m:3", 1),
            Ends("k=(", 1),
        ],
        &[
            "",
            "k",
            "k=",
            "=1",
            "k=1N/m\n",
            "k=1N/m..2N/m",
            "k=1N/m..2N/m:1",
            "k=1N/m..2N/m:1e3",
            "k=1N/m,,2N/m",
            "k=..:3",
        ],
    ),
    (
        "sweep",
        "measure",
        &[Done("gain(F -> x, 3 Hz)"), Done("2 * frequency(1)"), Ends("stable", 1), Ends("k", 1), Ends("gain(", 2)],
        &["", " ", "frequency(1)\n"],
    ),
    ("sweep", "samples", &[Done("1"), Done("100")], &["0", "-1", "1000000001", "1.5", "x", ""]),
    ("sweep", "seed", &[Done("7"), Done("18446744073709551615")], &["", "-1", "1.5", "x", "18446744073709551616"]),
    ("sweep", "modes", &[Done("1"), Done("1000")], &["0", "-1", "1001", "1.5", "all", ""]),
    // The parameter is no rate of rotation.
    (
        "sweep",
        "orders",
        &[Ends("1", 2), Ends("1,2,4", 2), Ends("1000", 2)],
        &["0", "-1", "", "1.5", "x", "1,,2", "1,", "1001"],
    ),
    (
        "sweep",
        "shard",
        &[Done("0/1"), Done("3/64"), Done("9999/10000"), Ends("auto", 2), Ends("auto/4", 2)],
        &["", "/", "1", "1/", "/2", "2/2", "0/0", "-1/2", "+1/2", "0/10001", "auto/", "auto/0", "auto/-1", "some/2"],
    ),
    (
        "merge",
        "files",
        &[
            Done("@/part.csv"),
            Ends("@/missing.csv", 3),
            Ends("@", 3),
            Ends("@/scene.vib", 2),
            Ends("@/bytes", 2),
            Ends("-", 3),
            Ends("", 2),
        ],
        &[],
    ),
    ("merge", "output", &[Done("@/out"), Done("-"), Ends("@/missing/out", 3), Ends("@/part.csv", 2)], &[]),
    ("simulate", "until", &[Done("1s"), Done("500ms")], &TIMES),
    ("simulate", "step", &[Done("0.5s"), Done("2s"), Ends("1e-9s", 2)], &TIMES),
    (
        "simulate",
        "seed",
        &[Done("7"), Done("0"), Done("18446744073709551615")],
        &["", "-1", "1.5", "x", "18446744073709551616"],
    ),
    ("emit", "step", &[Done("1ms"), Done("0.5s")], &TIMES),
    ("emit", "parameter", &[Done("k"), Ends("q", 2), Ends("", 2)], &[]),
    ("emit", "until", &[Done("1s")], &TIMES),
    ("emit", "output", &[Done("@/code"), Ends("@/scene.vib", 3), Ends("@/scene.vib/inner", 3)], &[]),
    ("*", "width", &[Done("20"), Done("80"), Done("10000")], &["0", "19", "10001", "-1", "1.5", "", "wide"]),
    ("*", "output", &[Done("@/out"), Done("-"), Ends("@/missing/out", 3), Ends("@/scene.vib", 2)], &[]),
    ("*", "svg", &[Done("@/picture.svg"), Ends("@/missing/p.svg", 3), Ends("@/scene.vib", 2)], &[]),
    ("draw", "mode", &[Done("1"), Ends("2", 2), Ends("100000", 2)], &["0", "-1", "100001", "1.5", "all", ""]),
    (
        "*",
        "file",
        &[
            Done("@/scene.vib"),
            Ends("@/missing.vib", 3),
            Ends("@", 3),
            Ends("@/settings.toml", 1),
            Ends("@/bytes", 1),
            Ends("-", 1),
        ],
        &[],
    ),
    ("bench", "file", &[Ends("@/missing.vib", 3), Ends("@", 3), Ends("@/settings.toml", 1), Ends("-", 1)], &[]),
    (
        "check",
        "files",
        &[
            Done("@/scene.vib"),
            Ends("@/missing.vib", 3),
            Ends("@", 3),
            Ends("@/settings.toml", 1),
            Ends("@/bytes", 1),
            Ends("-", 1),
        ],
        &[],
    ),
    (
        "fmt",
        "files",
        &[
            Done("@/scene.vib"),
            Ends("@/missing.vib", 3),
            Ends("@", 3),
            Ends("@/settings.toml", 1),
            Ends("@/bytes", 1),
            Done("-"),
        ],
        &[],
    ),
    (
        "explain",
        "subject",
        &[
            Done("vib::unit::mismatch"),
            Done("spring"),
            Ends("vib::unit::mistmatch", 2),
            Ends("", 2),
            Done("x"),
            Ends("xyz", 2),
        ],
        &[],
    ),
    ("man", "command", &[Done("analyze"), Done("fmt"), Ends("analyse", 2), Ends("", 2)], &[]),
    // Options of no command.
    ("*", "help", &[Done("")], &[]),
    ("*", "version", &[Done("")], &[]),
    ("watch", "port", &[Done("0"), Done("65535")], &["-1", "65536", "1.5", "", "http"]),
    ("lsp", "stdio", &[Ends("", 1)], &["yes"]),
    ("emit", "program", &[Done("")], &["yes"]),
    ("fmt", "check", &[Ends("", 1)], &["yes"]),
];

/// The other arguments that a command needs, without the tested option.
fn needed(command: &str, option: &str) -> Vec<&'static str> {
    let file = "@/scene.vib";
    let mut needed = match command {
        "sweep" if matches!(option, "samples" | "seed" | "sobol") => vec!["@/random.vib"],
        "analyze" if option == "tolerances" => vec!["@/random.vib"],
        "analyze" if option == "robust" => vec!["@/robust.vib"],
        "analyze" | "transfer" | "bench" | "sweep" | "draw" | "equations" | "report" | "watch" if option != "file" => {
            vec![file]
        }
        "simulate" if option == "seed" => vec!["@/shaken.vib"],
        "simulate" if option != "file" => vec![file],
        // `%` alone would be the file.
        "shock" if !matches!(option, "file" | "percent") => vec!["@/drop.vib"],
        "emit" if option != "file" => vec![file],
        "check" | "fmt" if option != "files" => vec![file],
        "explain" if option != "subject" => vec!["vib::unit::mismatch"],
        "merge" if option != "files" => vec!["@/part.csv"],
        "completions" if option != "shell" => vec!["bash"],
        _ => Vec::new(),
    };
    let (until, step) = (["--until", "1s"], ["--step", "0.5s"]);
    match (command, option) {
        ("simulate", "until") => needed.extend(step),
        ("simulate", "step") => needed.extend(until),
        ("simulate", _) => needed.extend([until, step].concat()),
        // A built-in signal needs a table of steps.
        ("emit", "program") => needed.extend(["--target", "c", "--until", "1s", "--output", "@/code"]),
        ("emit", "until") => needed.extend(["--target", "c", "--program", "--output", "@/code"]),
        ("emit", "target") => {}
        ("emit", _) => needed.extend(["--target", "c"]),
        ("sweep", "over" | "samples") => {}
        ("sweep", "seed" | "sobol") => needed.extend(["--samples", "16"]),
        ("sweep", "shard") => needed.extend(["--over", "k=5N/m,6N/m", "--format", "csv", "--output", "@/out.csv"]),
        // Arrays are written to files alone.
        ("sweep", "format") => needed.extend(["--over", "k=5N/m,6N/m", "--output", "@/out.npz"]),
        ("sweep", "orders" | "svg") => needed.extend(["--over", "k=5N/m,6N/m", "--follow"]),
        ("sweep", _) => needed.extend(["--over", "k=5N/m,6N/m"]),
        ("shock", "range") => {}
        ("shock", "at") => {}
        ("shock", "points" | "linear") => needed.extend(["--range", "0.1Hz..10Hz"]),
        ("shock", _) => needed.extend(["--at", "1Hz"]),
        ("transfer", "points" | "linear") => needed.extend(["--range", "0.1Hz..10Hz"]),
        _ => {}
    }
    needed
}

struct Setting {
    folder: TempDir,
}

impl Setting {
    fn new() -> Setting {
        let setting = Setting { folder: tempfile::tempdir().expect("a temporary folder") };
        setting.lay_out();
        setting
    }

    /// Writes the files in their state before each run.
    fn lay_out(&self) {
        let at = |name: &str| self.folder.path().join(name);
        fs::write(at("scene.vib"), SCENE).expect("a file");
        fs::write(at("drop.vib"), DROP).expect("a file");
        fs::write(at("shaken.vib"), SHAKEN).expect("a file");
        fs::write(at("random.vib"), RANDOM).expect("a file");
        let robust = RANDOM.to_string()
            + "param q = 1 N/m\nspring t: ground -- b { k = q }\nforce F: b along x\noutput x = b.x\n\
                                           damper d: ground -- b { c = 1 N*s/m }\nminimise gain(F -> x, 0 Hz) over q in 1 N/m .. 2 N/m\n";
        fs::write(at("robust.vib"), robust).expect("a file");
        fs::write(at("part.csv"), PART).expect("a file");
        fs::write(at("settings.toml"), SETTINGS).expect("a file");
        fs::write(at("bytes"), [0xff, 0xfe, 0, 0x1b, b'\n']).expect("a file");
    }

    fn run(&self, arguments: &[String]) -> process::Output {
        self.lay_out();
        let folder = self.folder.path().to_string_lossy();
        let arguments = arguments.iter().map(|argument| argument.replace('@', &folder));
        let mut program = process::Command::new(env!("CARGO_BIN_EXE_vibc"));
        program.args(arguments).stdin(Stdio::null()).output().expect("the program starts")
    }
}

/// The fault of a run, if it did not end as expected.
fn fault(output: &process::Output, status: i32) -> Option<String> {
    let reported = String::from_utf8_lossy(&output.stderr);
    let found = output.status.code();
    if found != Some(status) {
        return Some(format!("status {found:?}, not {status}: {reported}"));
    }
    if reported.contains("panicked") || reported.contains("a defect of vibc") {
        return Some(format!("a defect: {reported}"));
    }
    if reported.chars().any(|c| c != '\n' && c.is_control()) {
        return Some(format!("characters that steer the terminal: {reported:?}"));
    }
    if status == 0 {
        return reported.contains("error").then(|| format!("an error, and status 0: {reported}"));
    }
    let is_one = reported.starts_with("error: ");
    let is_finding = reported.starts_with("error[vib::") || reported.is_empty();
    let is_clean = is_one || status != 2 && is_finding;
    (!is_clean).then(|| format!("no clean message: {reported}"))
}

fn option_as_written(arg: &Arg, value: &str) -> Vec<String> {
    match arg.get_long() {
        None => vec![value.to_string()],
        Some(long) if !takes_value(arg) && value.is_empty() => vec![format!("--{long}")],
        Some(long) => vec![format!("--{long}={value}")],
    }
}

fn takes_value(arg: &Arg) -> bool {
    matches!(arg.get_action(), ArgAction::Set | ArgAction::Append)
}

/// The line of an option: that of its command, otherwise that of all commands.
fn line(command: &str, id: &str) -> Option<&'static Values> {
    let of = |whose: &str| VALUES.iter().find(|(of, option, ..)| *of == whose && *option == id);
    of(command).or_else(|| of("*"))
}

fn name(arg: &Arg) -> String {
    arg.get_long().unwrap_or(arg.get_id().as_str()).to_string()
}

/// Right values with their exit status, and wrong values.
fn values(command: &str, arg: &Arg) -> Result<(Vec<Good>, Vec<String>), String> {
    let name = name(arg);
    if let Some((_, _, good, bad)) = line(command, &name) {
        return Ok((good.to_vec(), bad.iter().map(|value| value.to_string()).collect()));
    }
    if !takes_value(arg) {
        return Ok((vec![Done("")], vec!["yes".into()]));
    }
    let listed = arg.get_possible_values();
    if listed.is_empty() {
        return Err(format!("`{command} {name}` has no line in VALUES"));
    }
    let good = listed.iter().map(|value| Done(Box::leak(value.get_name().to_string().into_boxed_str())));
    let wrong = listed.iter().map(|value| format!("{}x", value.get_name())).chain(["".into()]);
    Ok((good.collect(), wrong.collect()))
}

fn commands() -> Vec<Command> {
    let mut program = cli::Cli::command();
    program.build();
    program.get_subcommands().filter(|command| command.get_name() != "help").cloned().collect()
}

#[test]
fn every_option_accepts_right_values_and_refuses_wrong_ones() {
    let setting = Setting::new();
    let mut faults = Vec::new();
    for command in commands() {
        let of = command.get_name();
        for arg in command.get_arguments() {
            let (good, bad) = match values(of, arg) {
                Ok(values) => values,
                Err(missing) => {
                    faults.push(missing);
                    continue;
                }
            };
            let mut tell = |value: &str, status: i32| {
                // Its runs take seconds each; `command_line` tests that they succeed.
                if of == "bench" && status == 0 && name(arg) != "help" {
                    return;
                }
                // It serves until it is stopped, whatever is wrong with the model; `pages` tests what it serves.
                if of == "watch" && status != 2 && name(arg) != "help" {
                    return;
                }
                let mut arguments = vec![of.to_string()];
                arguments.extend(option_as_written(arg, value));
                arguments.extend(needed(of, &name(arg)).into_iter().map(String::from));
                if let Some(fault) = fault(&setting.run(&arguments), status) {
                    faults.push(format!("vibc {arguments:?}: {fault}"));
                }
            };
            for good in good {
                match good {
                    // A language server whose client disconnects without `shutdown`.
                    Done(value) if of == "lsp" && name(arg) != "help" => tell(value, 1),
                    Done(value) => tell(value, 0),
                    Ends(value, status) => tell(value, status),
                }
            }
            bad.iter().for_each(|value| tell(value, 2));
        }
    }
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}

#[test]
fn every_line_belongs_to_an_option() {
    let commands = commands();
    for (of, option, ..) in &VALUES {
        let mut fits = commands.iter().filter(|command| *of == "*" || command.get_name() == *of);
        let has = |command: &Command| command.get_arguments().any(|arg| name(arg) == *option);
        assert!(*option == "version" || fits.any(has), "`{of} {option}` is no option");
    }
}

#[test]
fn options_that_exclude_each_other_are_refused_together() {
    let setting = Setting::new();
    for arguments in [
        &["analyze", "@/scene.vib", "--modes", "1", "--band", "1Hz..2Hz"][..],
        &["transfer", "@/scene.vib", "--at", "1Hz", "--points", "3"],
        &["transfer", "@/scene.vib", "--at", "1Hz", "--range", "1Hz..2Hz"],
        &["transfer", "@/scene.vib", "--at", "1Hz", "--linear"],
        &["simulate", "@/scene.vib", "--until", "1s"],
        &["simulate", "@/scene.vib", "--step", "1s"],
        &["emit", "@/scene.vib"],
        &["emit", "@/scene.vib", "--target", "c", "--program"],
        &["emit", "@/scene.vib", "--target", "c", "--program", "--until", "1s"],
        &["emit", "@/scene.vib", "--target", "c", "--until", "1s"],
        &["emit", "@/scene.vib", "--target", "c", "--parameter", "k", "--tolerance", "1e-3"],
        &["emit", "@/scene.vib", "--target", "c", "--style", "equations", "--tolerance", "1e-3"],
        &["analyze", "@/scene.vib", "--digits", "3", "--digits", "4"],
        &["analyze", "@/scene.vib", "@/scene.vib"],
        &["analyze", "@/scene.vib", "--nothing"],
        &["nothing"],
    ] {
        let arguments: Vec<String> = arguments.iter().map(|argument| argument.to_string()).collect();
        assert_eq!(fault(&setting.run(&arguments), 2), None, "{arguments:?}");
    }
}

/// What is wrong with a frequency or a time, and what to type instead.
#[test]
fn values_that_are_none_say_what_to_type() {
    let setting = Setting::new();
    for (option, value, told) in [
        ("--at", "1 1/s", "write Hz for cycles or rad/s for radians"),
        ("--at", "1 /s", "write Hz for cycles or rad/s for radians"),
        ("--at", "1 2Hz", "`2Hz` is not a unit: write a frequency such as 30Hz or 2rad/s"),
        ("--at", "-1Hz", "it must not be negative: write a frequency such as 30Hz or 2rad/s"),
        ("--at", "fast", "it does not begin with a number: write a frequency such as 30Hz or 2rad/s"),
        ("--at", "3", "it needs a unit: write a frequency such as 30Hz or 2rad/s"),
        ("--at", "3 m", "`m` is not a unit of a frequency: write a frequency such as 30Hz or 2rad/s"),
        ("--at", "1e-320Hz", "it is outside the range of binary64 in SI units"),
        ("--at", "1e308MHz", "it is outside the range of binary64 in SI units"),
        ("--at", "1e401Hz", "its number is outside the range of binary64"),
        ("--range", "-1Hz..2Hz", "it must not be negative"),
    ] {
        let arguments = ["transfer", "@/scene.vib", &format!("{option}={value}")].map(str::to_string);
        let output = setting.run(&arguments);
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && text.contains(told), "{option} {value}: {text}");
    }
}
