//! Sweeps in parts: merged they are the bytes of one run, whatever was interrupted meanwhile; what is no whole study is refused. See
//! docs/cli.md#shards.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;

const MODEL: &str =
    "model one\nparam k = 100 N/m\nparam m = 1 kg\nbody b { mass = m, moves x }\nspring s: ground -- b { k = k }\n";
const STUDY: [&str; 8] = ["m.vib", "--over", "k=1N/m..50N/m:41", "--over", "m=1kg,2kg,0kg", "--modes", "1", "--format"];

fn folder() -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("m.vib"), MODEL).expect("a file");
    folder
}

fn command(at: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_vibc"));
    command.args(arguments).current_dir(at);
    for name in
        ["SLURM_ARRAY_TASK_ID", "SLURM_ARRAY_TASK_MIN", "SLURM_ARRAY_TASK_COUNT", "JOB_COMPLETION_INDEX", "HQ_TASK_ID"]
    {
        command.env_remove(name);
    }
    command
}

fn ran(at: &Path, arguments: &[&str]) -> Output {
    command(at, arguments).output().expect("the program starts")
}

fn swept(at: &Path, more: &[&str]) {
    let output = ran(at, &[&["sweep"], &STUDY[..], &["csv"], more].concat());
    assert!(output.status.success(), "{more:?}: {}", String::from_utf8_lossy(&output.stderr));
}

fn text(at: &Path, name: &str) -> String {
    fs::read_to_string(at.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

#[test]
fn merged_parts_are_the_bytes_of_one_run() {
    let folder = folder();
    let at = folder.path();
    let printed = ran(at, &[&["sweep"], &STUDY[..], &["csv"]].concat()).stdout;
    swept(at, &["-o", "one.csv"]);
    assert_eq!(fs::read(at.join("one.csv")).expect("a file"), printed);
    // 123 cases: seven parts of unlike lengths, and more parts than cases.
    for count in [1, 7, 200] {
        let parts: Vec<String> = (0..count).map(|index| format!("part-{index}-{count}.csv")).collect();
        for (index, part) in parts.iter().enumerate() {
            swept(at, &["--shard", &format!("{index}/{count}"), "-o", part]);
        }
        let mut arguments = vec!["merge", "-o", "all.csv"];
        arguments.extend(parts.iter().rev().map(String::as_str));
        let merged = ran(at, &arguments);
        assert!(merged.status.success(), "{}", String::from_utf8_lossy(&merged.stderr));
        assert_eq!(text(at, "all.csv"), text(at, "one.csv"), "{count} parts");
    }
    assert!(!at.join("one.csv.partial").exists());
}

#[test]
fn parts_that_are_not_all_of_one_study_are_refused() {
    let folder = folder();
    let at = folder.path();
    for index in 0..4 {
        swept(at, &["--shard", &format!("{index}/4"), "-o", &format!("p{index}")]);
    }
    swept(at, &["--shard", "1/3", "-o", "third"]);
    swept(at, &["--shard", "1/4", "-o", "poles", "--poles"]);
    fs::write(at.join("m.vib"), MODEL.replace("ground -- b {", "ground -- b  {")).expect("a file");
    swept(at, &["--shard", "1/4", "-o", "other"]);
    let whole = text(at, "p1");
    fs::write(at.join("cut"), &whole[..whole.len() / 2]).expect("a file");
    let end = whole.rfind("# end").expect("a last line");
    fs::write(at.join("cut_at_line"), &whole[..end]).expect("a file");
    fs::write(at.join("digit"), format!("{}x{}", &whole[..end - 3], &whole[end - 2..])).expect("a file");
    let lines: Vec<&str> = whole.split_inclusive('\n').collect();
    fs::write(at.join("gap"), [&lines[..9], &lines[10..]].concat().concat()).expect("a file");
    fs::write(at.join("longer"), [&lines[..9], &lines[8..]].concat().concat()).expect("a file");
    for (files, status, message) in [
        (&["p0", "p2", "p3"][..], 2, "missing parts: 1/4"),
        (&["p3"], 2, "missing parts: 0/4, 1/4, 2/4"),
        (&["p0", "p1", "p2", "p3", "p1"], 2, "is part 1 like `p1`"),
        (&["p0", "third", "p2", "p3"], 2, "`third` belongs to another study"),
        (&["p0", "poles", "p2", "p3"], 2, "`poles` belongs to another study"),
        (&["p0", "other", "p2", "p3"], 2, "`other` belongs to another study"),
        (&["p0", "cut", "p2", "p3"], 2, "`cut` is cut off or damaged"),
        (&["p0", "cut_at_line", "p2", "p3"], 2, "`cut_at_line` is cut off or damaged"),
        (&["p0", "gap", "p2", "p3"], 2, "`gap` is cut off or damaged"),
        (&["p0", "digit", "p2", "p3"], 2, "`digit` is cut off or damaged"),
        (&["p0", "longer", "p2", "p3"], 2, "`longer` is cut off or damaged"),
        (&["p0", "nothing", "p2", "p3"], 3, "cannot read `nothing`"),
    ] {
        let output = ran(at, &[&["merge", "-o", "all"], files].concat());
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(status), "{files:?}: {said}");
        assert!(
            said.starts_with("error: ") && said.contains(message) && said.lines().count() == 1,
            "{files:?}: {said}"
        );
        assert!(!at.join("all").exists(), "{files:?}");
    }
    // Whatever byte of a part is another one, it is not taken; and it is computed again.
    for place in (0..whole.len()).step_by(37) {
        let mut bytes = whole.clone().into_bytes();
        bytes[place] = if bytes[place] == b'7' { b'8' } else { b'7' };
        fs::write(at.join("damaged"), &bytes).expect("a file");
        let output = ran(at, &["merge", "-o", "all", "p0", "damaged", "p2", "p3"]);
        assert!(!output.status.success() && !at.join("all").exists(), "{place}");
    }
    fs::write(at.join("m.vib"), MODEL).expect("a file");
    fs::write(at.join("damaged"), whole.replacen("1,", "1;", 1)).expect("a file");
    swept(at, &["--shard", "1/4", "-o", "damaged"]);
    assert_eq!(text(at, "damaged"), whole);
    #[cfg(unix)]
    {
        // It has no end: to open it would block.
        assert!(std::process::Command::new("mkfifo").arg(at.join("fifo")).status().expect("`mkfifo` starts").success());
        let output = ran(at, &["merge", "-o", "all", "fifo"]);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!((output.status.code(), &*said), (Some(3), "error: cannot read `fifo`: it is not a regular file\n"));
    }
}

/// The rows that are there are kept: one that was changed by hand is found again in the result. What was cut off in a row, or
/// comes from another study, is computed again.
#[test]
fn an_interrupted_run_goes_on() {
    let folder = folder();
    let at = folder.path();
    swept(at, &["-o", "one.csv"]);
    swept(at, &["--shard", "0/1", "-o", "part"]);
    let part = text(at, "part");
    let begun = part[..part.find("\n60,").expect("a row") + 9].replacen("\n7,", "\n7,kept,", 1);
    fs::write(at.join("again.csv.partial"), &begun).expect("a file");
    swept(at, &["-o", "again.csv"]);
    assert_eq!(text(at, "again.csv"), text(at, "one.csv").replacen("\n7,", "\n7,kept,", 1));
    assert!(!at.join("again.csv.partial").exists());
    let foreign = begun.replacen("study ", "study 0", 1);
    fs::write(at.join("again.csv.partial"), foreign).expect("a file");
    swept(at, &["-o", "again.csv"]);
    assert_eq!(text(at, "again.csv"), text(at, "one.csv"));
    // A finished part stays as it is; one that is not what was written is computed again.
    let written = || fs::metadata(at.join("part")).and_then(|part| part.modified()).expect("a time");
    let before = written();
    swept(at, &["--shard", "0/1", "-o", "part"]);
    assert_eq!(before, written());
    fs::write(at.join("part"), part.replacen("\n7,", "\n7,changed,", 1)).expect("a file");
    swept(at, &["--shard", "0/1", "-o", "part"]);
    assert_eq!(text(at, "part"), part);
    // A file of somebody else is not touched.
    fs::write(at.join("mine.csv.partial"), "mine").expect("a file");
    let output = ran(at, &[&["sweep"], &STUDY[..], &["csv", "-o", "mine.csv"]].concat());
    assert_eq!(output.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&output.stderr).contains("`mine.csv.partial`, but it is no progress of a sweep"));
    assert_eq!(text(at, "mine.csv.partial"), "mine");
}

#[test]
fn a_killed_run_goes_on() {
    let folder = folder();
    let at = folder.path();
    let arguments = ["sweep", "m.vib", "--over", "k=1N/m..50N/m:6000", "--modes", "1", "--format", "csv", "-o"];
    let mut running = command(at, &[&arguments[..], &["one.csv"]].concat()).spawn().expect("the program starts");
    let size = || fs::metadata(at.join("one.csv.partial")).map_or(0, |found| found.len());
    while size() < 4000 && running.try_wait().expect("a process").is_none() {
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    running.kill().expect("a process");
    running.wait().expect("a process");
    for name in ["one.csv", "another.csv"] {
        assert!(ran(at, &[&arguments[..], &[name]].concat()).status.success());
    }
    assert_eq!(text(at, "one.csv"), text(at, "another.csv"));
}

/// Ctrl-C ends a run by SIGINT, which shells tell as status 130; the rows so far are kept, and the next run goes on from there.
#[cfg(unix)]
#[test]
fn an_interrupt_keeps_what_is_done() {
    use std::os::unix::process::ExitStatusExt;
    let folder = folder();
    let at = folder.path();
    let rows = || fs::read_to_string(at.join("one.csv.partial")).map_or(0, |rows| rows.lines().count());
    // As many cases as take longer than it takes to interrupt them, in either profile of the program.
    let mut cases = 6_000;
    let over = loop {
        let over = format!("k=1N/m..50N/m:{cases}");
        let sweep = ["sweep", "m.vib", "--over", &over, "--poles", "--format", "csv", "-o", "one.csv"];
        let mut running = command(at, &sweep).spawn().expect("the program starts");
        while rows() < 40 && running.try_wait().expect("a process").is_none() {
            std::thread::sleep(std::time::Duration::from_millis(2));
        }
        let number = running.id().to_string();
        let _ = Command::new("kill").args(["-INT", &number]).stderr(std::process::Stdio::null()).status();
        let ended = running.wait().expect("a process");
        if ended.signal() == Some(2) {
            break over;
        }
        assert!(ended.success() && cases < 10_000_000, "{ended}");
        fs::remove_file(at.join("one.csv")).expect("a file");
        cases *= 4;
    };
    let sweep = ["sweep", "m.vib", "--over", &over, "--poles", "--format", "csv", "-o"];
    assert!(!at.join("one.csv").exists() && rows() >= 40);
    // Marked, so that it is seen that these rows are not computed again.
    let begun = text(at, "one.csv.partial").replacen("\n7,", "\n7,kept,", 1);
    fs::write(at.join("one.csv.partial"), begun).expect("a file");
    for name in ["one.csv", "another.csv"] {
        assert!(ran(at, &[&sweep[..], &[name]].concat()).status.success());
    }
    assert_eq!(text(at, "one.csv"), text(at, "another.csv").replacen("\n7,", "\n7,kept,", 1));
}

/// A run of more than a second tells a terminal how far it is, and removes that in the end; a pipe sees nothing of it.
#[cfg(target_os = "linux")]
#[test]
fn a_terminal_is_told_how_far_a_run_is() {
    let folder = folder();
    let at = folder.path();
    let on_terminal = |line: &str| {
        let mut script = Command::new("script");
        let output = script.args(["--quiet", "--return", "--command", line, "/dev/null"]).current_dir(at).output();
        let output = output.expect("`script` (util-linux) starts");
        let shown = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success(), "{shown}");
        shown
    };
    // As many cases as take some seconds, in either profile of the program.
    let mut cases = 500;
    let (shown, line) = loop {
        let sweep =
            format!("{} sweep m.vib --over k=1N/m..50N/m:{cases} --poles --format csv", env!("CARGO_BIN_EXE_vibc"));
        let shown = on_terminal(&format!("{sweep} -o rows.csv"));
        if shown.contains('%') {
            break (shown, sweep);
        }
        cases *= 2;
        assert!(cases < 10_000_000, "no bar: {shown}");
    };
    let bars: Vec<&str> = shown.trim_end_matches("\r\x1b[K").split('\r').filter(|bar| !bar.is_empty()).collect();
    let mut before = 0;
    for bar in &bars {
        let (drawn, told) = bar.strip_prefix('[').and_then(|bar| bar.split_once("] ")).expect("a bar");
        let (share, count) = told.split_once(" %, ").expect("a share");
        let done: usize =
            count.strip_suffix(&format!(" of {cases} cases")).expect("a count").parse().expect("a number");
        assert!(done > before && done <= cases && share == (100 * done / cases).to_string(), "{bar}");
        assert!(drawn.len() == 40 && drawn.trim_end() == "#".repeat(40 * done / cases), "{bar}");
        before = done;
    }
    assert!(!bars.is_empty() && shown.ends_with("\r\x1b[K"), "{shown:?}");
    // Rows that go to the terminal are not drawn over, and a pipe is told nothing.
    assert!(!on_terminal(&line).contains('%'));
    let piped =
        Command::new("sh").args(["-c", &format!("{line} -o other.csv")]).current_dir(at).output().expect("`sh` starts");
    assert!(piped.status.success() && piped.stdout.is_empty() && piped.stderr.is_empty());
}

#[test]
fn job_arrays_say_which_part_it_is() {
    let folder = folder();
    let at = folder.path();
    swept(at, &["--shard", "2/5", "-o", "given"]);
    let given = text(at, "given");
    for (shard, variables) in [
        ("auto", &[("SLURM_ARRAY_TASK_ID", "12"), ("SLURM_ARRAY_TASK_MIN", "10"), ("SLURM_ARRAY_TASK_COUNT", "5")][..]),
        ("auto/5", &[("JOB_COMPLETION_INDEX", "2")]),
        ("auto/5", &[("HQ_TASK_ID", "2"), ("SLURM_ARRAY_TASK_ID", "1")]),
    ] {
        let arguments = [&["sweep"], &STUDY[..], &["csv", "--shard", shard, "-o", "part"]].concat();
        let output = command(at, &arguments).envs(variables.iter().copied()).output().expect("the program starts");
        assert!(output.status.success(), "{variables:?}: {}", String::from_utf8_lossy(&output.stderr));
        assert_eq!(text(at, "part"), given, "{variables:?}");
        fs::remove_file(at.join("part")).expect("a file");
    }
    for (shard, variables, message) in [
        ("auto", &[][..], "is set"),
        ("auto", &[("JOB_COMPLETION_INDEX", "2")], "write `--shard auto/N`"),
        ("auto/2", &[("JOB_COMPLETION_INDEX", "2")], "parts are counted from 0 to 1"),
        ("auto/2", &[("HQ_TASK_ID", "two")], "`HQ_TASK_ID` is `two`, which is no number"),
    ] {
        let arguments = [&["sweep"], &STUDY[..], &["csv", "--shard", shard, "-o", "part"]].concat();
        let output = command(at, &arguments).envs(variables.iter().copied()).output().expect("the program starts");
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(message) && !at.join("part").exists(), "{said}");
    }
}
