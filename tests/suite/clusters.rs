//! The recipes in `cluster/`, run by the engines themselves on this machine. Something is killed while it works, and the result is the
//! bytes of one run.
//!
//! `cargo test` shows these tests as ignored; `.ci/run` installs what they need and runs them.

use std::ffi::OsString;
use std::fs;
use std::net::{TcpListener, TcpStream};
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Parts of a study.
const PARTS: &str = "9";

/// What is asked, and long enough for a part to take a second.
const ASKED: [&str; 5] = ["--over", "k=50N/m..150N/m:CASES", "--over", "m=1kg,2kg,0kg", "--poles"];
const CASES: &str = "600";

/// Nothing here takes longer, on a busy machine either.
const PATIENCE: Duration = Duration::from_secs(300);

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// A folder with a model, and what one run makes of it.
struct Study {
    folder: TempDir,
}

/// Ended with the test, however it ends.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        kill(&format!("-{}", self.0.id()));
        let _ = self.0.wait();
    }
}

/// Ends a process, or with a minus sign before its number the group that it leads. None may be left of it.
fn kill(process: &str) {
    signal("-KILL", process);
}

fn signal(which: &str, process: &str) {
    let _ = Command::new("kill").args([which, "--", process]).stderr(Stdio::null()).status();
}

fn until(what: &str, mut is_so: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !is_so() {
        assert!(begun.elapsed() < PATIENCE, "in vain: {what}");
        sleep(Duration::from_millis(5));
    }
}

/// A file in target/, where `.ci/run` installs Python packages, or a program of that name.
fn installed(name: &str) -> OsString {
    let path = root().join("target/cluster/bin").join(name);
    if path.exists() { path.into() } else { name.into() }
}

impl Study {
    fn new() -> Study {
        let study = Study { folder: tempfile::tempdir().expect("a temporary folder") };
        let mut model = String::from("model chain\nparam k = 100 N/m\nparam m = 1 kg\n");
        for i in 0..6 {
            let (mass, before) = match i {
                0 => ("m".to_string(), "ground".to_string()),
                _ => (format!("{i} kg"), format!("b{}", i - 1)),
            };
            model += &format!(
                "body b{i} {{ mass = {mass}, moves x }}\nspring s{i}: {before} -- b{i} {{ k = k }}\ndamper d{i}: {before} -- b{i} {{ c = {} N*s/m }}\n",
                1 + i % 3
            );
        }
        fs::write(study.at("chain.vib"), model).expect("a model");
        let mut one = study.command(env!("CARGO_BIN_EXE_vibc"));
        let one = one.arg("sweep").args(study.arguments()).args(["--format", "csv", "-o", "one.csv"]).status();
        assert!(one.expect("the program starts").success());
        study
    }

    fn at(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn arguments(&self) -> Vec<String> {
        ["chain.vib"].iter().chain(&ASKED).map(|word| word.replace("CASES", CASES)).collect()
    }

    /// A command in the folder, which leads a group of processes and finds this `vibc` first.
    fn command(&self, program: impl Into<OsString>) -> Command {
        let mut command = Command::new(program.into());
        let ours = Path::new(env!("CARGO_BIN_EXE_vibc")).parent().expect("a folder").as_os_str();
        let path = [ours, std::env::var_os("PATH").unwrap_or_default().as_os_str()].join(&OsString::from(":"));
        command.current_dir(self.folder.path()).env("PATH", path).process_group(0);
        command
    }

    /// Starts a command, with what it says in a file.
    fn start(&self, mut command: Command, says: &str) -> Running {
        let file = fs::File::create(self.at(says)).expect("a file");
        let (out, errors) = (file.try_clone().expect("a file"), file);
        Running(command.stdin(Stdio::null()).stdout(out).stderr(errors).spawn().expect("the engine starts"))
    }

    /// The parts that are begun and not finished, and those that are finished.
    fn parts(&self) -> (usize, usize) {
        let Ok(entries) = fs::read_dir(self.at("all.csv.parts")) else { return (0, 0) };
        let names: Vec<String> =
            entries.filter_map(|entry| Some(entry.ok()?.file_name().to_string_lossy().into_owned())).collect();
        let count = |end: &str| names.iter().filter(|name| name.ends_with(end)).count();
        (count(".csv.partial"), count(".csv"))
    }

    /// Waits until some parts are finished, and another is begun.
    fn is_at_work(&self) {
        until("some parts, and another begun", || matches!(self.parts(), (1.., 2..)));
        assert!(self.parts().1 < 9, "there is still work to lose");
    }

    /// The processes of `vibc` that work in the folder.
    fn at_work(&self) -> Vec<String> {
        let ours = fs::canonicalize(env!("CARGO_BIN_EXE_vibc")).expect("the program");
        let processes = fs::read_dir("/proc").expect("processes").filter_map(|entry| Some(entry.ok()?.path()));
        let is_ours = |process: &PathBuf| {
            fs::read_link(process.join("exe")).is_ok_and(|exe| exe == ours)
                && fs::read_link(process.join("cwd")).is_ok_and(|cwd| cwd == self.folder.path())
        };
        processes.filter(is_ours).filter_map(|path| Some(path.file_name()?.to_string_lossy().into_owned())).collect()
    }

    /// Waits for the end of a recipe: it has made the bytes of one run.
    fn is_whole(&self, mut recipe: Running, says: &str) {
        let status = recipe.0.wait().expect("a process");
        let said = fs::read_to_string(self.at(says)).unwrap_or_default();
        assert!(status.success(), "{said}");
        let read = |name: &str| fs::read(self.at(name)).unwrap_or_else(|error| panic!("{name}: {error}\n{said}"));
        assert!(read("all.csv") == read("one.csv"), "other bytes than those of one run\n{said}");
        assert_eq!(self.parts(), (0, 9));
    }

    /// One of the processes of `vibc`, once there is one.
    fn one_at_work(&self, is_meant: impl Fn(&str) -> bool) -> String {
        let mut found = None;
        until("a process of vibc", || {
            found = self.at_work().into_iter().find(|process| is_meant(process));
            found.is_some()
        });
        found.expect("a process")
    }

    fn kill_a_process_of_vibc(&self) {
        self.is_at_work();
        kill(&self.one_at_work(|_| true));
    }
}

#[test]
#[ignore = "needs GNU parallel"]
fn parallel_begins_a_killed_part_again() {
    let study = Study::new();
    let mut recipe = study.command(root().join("cluster/parallel.sh"));
    recipe.args(["all.csv", PARTS]).args(study.arguments()).env("JOBS", "2");
    let recipe = study.start(recipe, "says");
    study.kill_a_process_of_vibc();
    study.is_whole(recipe, "says");
}

#[test]
#[ignore = "needs Snakemake, in target/cluster or as `snakemake`"]
fn snakemake_begins_a_killed_part_again() {
    let study = Study::new();
    let mut recipe = study.command(installed("snakemake"));
    let words: Vec<String> = study.arguments().into_iter().skip(1).collect();
    recipe.args(["--cores", "2", "--snakefile"]).arg(root().join("cluster/Snakefile"));
    recipe.args(["--config", "out=all.csv", &format!("parts={PARTS}"), "model=chain.vib"]);
    recipe.arg(format!("study={}", words.join(" ")));
    let recipe = study.start(recipe, "says");
    study.kill_a_process_of_vibc();
    study.is_whole(recipe, "says");
    let said = fs::read_to_string(study.at("says")).expect("what Snakemake says");
    assert!(said.contains("Trying to restart job"), "{said}");
}

/// A scheduler and two workers of Dask on this machine.
struct Dask {
    _scheduler: Running,
    workers: [Running; 2],
    address: String,
}

impl Study {
    fn dask(&self) -> Dask {
        let port = TcpListener::bind("127.0.0.1:0").and_then(|bound| bound.local_addr()).expect("a port").port();
        let address = format!("tcp://127.0.0.1:{port}");
        let mut scheduler = self.command(installed("dask"));
        scheduler.args(["scheduler", "--host", "127.0.0.1", "--no-dashboard", "--port", &port.to_string()]);
        let scheduler = self.start(scheduler, "scheduler");
        until("the scheduler", || TcpStream::connect(("127.0.0.1", port)).is_ok());
        let workers = ["first", "second"].map(|name| {
            let mut worker = self.command(installed("dask"));
            worker.args(["worker", &address, "--no-nanny", "--no-dashboard", "--nthreads", "1", "--name", name]);
            self.start(worker, name)
        });
        Dask { _scheduler: scheduler, workers, address }
    }

    fn by_dask(&self, dask: &Dask) -> Running {
        let mut recipe = self.command(installed("python"));
        recipe.arg(root().join("cluster/dask_sweep.py")).args(["--scheduler", &dask.address, "all.csv", PARTS]);
        recipe.args(self.arguments());
        self.start(recipe, "says")
    }
}

/// A worker is lost with the `vibc` that it has started, as a machine is.
#[test]
#[ignore = "needs Python with the package distributed, in target/cluster or as `dask` and `python`"]
fn dask_gives_the_parts_of_a_lost_worker_to_another() {
    let study = Study::new();
    let dask = study.dask();
    let recipe = study.by_dask(&dask);
    study.is_at_work();
    kill(&format!("-{}", dask.workers[0].0.id()));
    study.is_whole(recipe, "says");
}

/// A worker is lost, and its `vibc` works on: the other one waits until the part is there.
#[test]
#[ignore = "needs Python with the package distributed, in target/cluster or as `dask` and `python`"]
fn dask_waits_for_a_part_that_is_still_being_written() {
    let study = Study::new();
    let mut dask = study.dask();
    let recipe = study.by_dask(&dask);
    study.is_at_work();
    let worker = dask.workers[0].0.id().to_string();
    // One that has only begun.
    let before = study.at_work();
    let orphan = study.one_at_work(|process| {
        let status = fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
        let of_worker = |line: &str| line.strip_prefix("PPid:").is_some_and(|parent| parent.trim() == worker);
        !before.iter().any(|other| other == process) && status.lines().any(of_worker)
    });
    kill(&worker);
    dask.workers[0].0.wait().expect("a process");
    signal("-STOP", &orphan);
    until("all other parts", || study.parts() == (1, 8));
    // Long enough for the other worker to begin with the last part, more often than an error would let it.
    sleep(Duration::from_secs(8));
    signal("-CONT", &orphan);
    study.is_whole(recipe, "says");
}

/// Two node daemons on this machine, one of which is killed with its task.
#[test]
#[ignore = "needs Slurm and MUNGE, and to be root"]
fn slurm_queues_the_part_of_a_lost_node_again() {
    let study = Study::new();
    let mut recipe = study.command(root().join("tests/clusters/slurm"));
    recipe.arg(root().join("cluster/slurm.sh")).args(["all.csv", PARTS]).args(study.arguments());
    let recipe = study.start(recipe, "says");
    study.is_whole(recipe, "says");
}
