//! The time for `examples/cart.vib`: stage by stage inside the process, and as a whole process compared with one that
//! does nothing. Targets: text to modes in 50 microseconds; `vibc analyze` in 3 ms of processor time.

use std::hint::black_box;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use vibc::base::source::{SourceFile, Sources};
use vibc::model::Overrides;

const ROUNDS: usize = 2000;
const PROCESSES: u32 = 200;

fn main() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/cart.vib");
    let text = std::fs::read_to_string(&path).expect("examples/cart.vib");
    let mut out = std::io::stdout().lock();
    let mut say = |line: String| writeln!(out, "{line}").expect("standard output");

    say(format!("examples/cart.vib, medians of {ROUNDS}, microseconds"));
    let mut total = Duration::ZERO;
    for (name, time) in STAGES.iter().zip(stages(&text)) {
        if *name != "poles" {
            total += time;
        }
        say(format!("  {name:<16}{:>10.1}", microseconds(time)));
    }
    say(format!("  {:<16}{:>10.1}   (target 50)", "text to modes", microseconds(total)));

    say(format!("whole process, processor time, mean of {PROCESSES}, milliseconds"));
    let vibc = env!("CARGO_BIN_EXE_vibc");
    let path = path.to_string_lossy().into_owned();
    for (name, program, arguments) in [
        ("/bin/true", "/bin/true", vec![]),
        ("vibc analyze", vibc, vec!["analyze", &path]),
        ("vibc check", vibc, vec!["check", &path]),
    ] {
        match processor_time(program, &arguments) {
            Some(time) => say(format!(
                "  {name:<16}{:>10.2}{}",
                time * 1e3,
                if name == "vibc analyze" { "   (target 3)" } else { "" }
            )),
            None => say(format!("  {name:<16}     no /proc here")),
        }
    }
}

const STAGES: [&str; 5] = ["parse", "check", "lower", "modes", "poles"];

fn microseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e6
}

/// Median time of each stage.
fn stages(text: &str) -> [Duration; 5] {
    let mut times: [Vec<Duration>; 5] = Default::default();
    for _ in 0..ROUNDS {
        let mut sources = Sources::new();
        let file = sources.add(SourceFile::model("cart.vib", text));
        let start = Instant::now();
        let parsed = black_box(vibc::syntax::parse(&sources, file));
        let parse = Instant::now();
        let checked = black_box(vibc::model::check(&sources, &parsed.tree, &Overrides::default()));
        let check = Instant::now();
        let scene = checked.scene.expect("a good model");
        let lowered = black_box(vibc::lower::lower(&scene)).lowered.expect("a rest");
        let lower = Instant::now();
        let modes = black_box(vibc::analysis::modes(&lowered.system)).expect("modes");
        let solved = Instant::now();
        black_box(vibc::analysis::poles(&lowered.system, &modes)).expect("poles");
        let all = Instant::now();
        for (i, time) in
            [parse - start, check - parse, lower - check, solved - lower, all - solved].into_iter().enumerate()
        {
            times[i].push(time);
        }
    }
    times.map(|mut times| {
        times.sort();
        times[times.len() / 2]
    })
}

/// Mean user and system time of a child process in seconds, from the kernel's sum for all children.
fn processor_time(program: &str, arguments: &[&str]) -> Option<f64> {
    let before = children_ticks()?;
    for _ in 0..PROCESSES {
        let status = Command::new(program).args(arguments).stdout(Stdio::null()).stderr(Stdio::null()).status().ok()?;
        assert!(status.success(), "{program} {arguments:?}");
    }
    // Linux counts these in hundredths of a second, whatever the kernel's own tick is.
    Some((children_ticks()? - before) / 100.0 / f64::from(PROCESSES))
}

/// cutime + cstime of /proc/self/stat (proc(5), fields 16 and 17; the second field is in parentheses).
fn children_ticks() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    Some(fields.get(13)?.parse::<f64>().ok()? + fields.get(14)?.parse::<f64>().ok()?)
}
