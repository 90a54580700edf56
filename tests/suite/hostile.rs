//! Hostile models, files, names and arguments: nothing hangs, fills the memory, controls a terminal or reveals files
//! that are no business of a model. See spec.md#limits and docs/method/response.md#signals.

use serde_json::Value;
use std::fs;
use std::io::Read;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;
use vibc::base::{SourceFile, Sources};
use vibc::model::{self, Overrides};

/// A scene whose force is a table.
fn driven(table: &str) -> String {
    format!(
        "body b {{ mass = 1 kg, moves x }}\nspring s: ground -- b {{ k = 10 N/m }}\n\
         force F: b along x = table(\"{table}\")\noutput x = b.x\n"
    )
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

fn write(folder: &Path, name: &str, text: impl AsRef<[u8]>) -> String {
    let path = folder.join(name);
    fs::write(&path, text).expect("a temporary file");
    path.to_string_lossy().into_owned()
}

/// Longer than any of these runs takes; a run that hangs is stopped and fails.
const PATIENCE: Duration = Duration::from_secs(120);

fn run(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_vibc"));
    command.args(arguments).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("the program starts");
    let mut streams = (child.stdout.take().expect("a pipe"), child.stderr.take().expect("a pipe"));
    let reader = std::thread::spawn(move || {
        let (mut stdout, mut stderr) = (Vec::new(), Vec::new());
        streams.0.read_to_end(&mut stdout).expect("it writes");
        streams.1.read_to_end(&mut stderr).expect("it writes");
        (stdout, stderr)
    });
    let start = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait().expect("it can be waited for") {
            break status;
        }
        if start.elapsed() > PATIENCE {
            child.kill().expect("it can be ended");
            panic!("{arguments:?} hangs");
        }
        std::thread::sleep(Duration::from_millis(5));
    };
    let (stdout, stderr) = reader.join().expect("both streams end");
    Output { status, stdout, stderr }
}

fn status(output: &Output) -> i32 {
    output.status.code().expect("no signal")
}

fn messages(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).expect("UTF-8")
}

/// The findings of a run, as JSON.
fn findings(output: &Output) -> Vec<Value> {
    messages(output).lines().map(|line| serde_json::from_str(line).expect("an object a line")).collect()
}

/// Whether a text has characters that move a cursor, change colours or the text direction, or are invisible.
fn steers(text: &str) -> bool {
    text.chars().any(|c| {
        c != '\n' && c.is_control()
            || matches!(c, '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{feff}')
    })
}

/// Texts that would clear the screen, end a line, change the direction of the text, or do the same by a C1 control.
const STEERING: [&str; 5] = ["x\u{1b}]0;pwned\u{7}", "a\rb", "a\u{202e}b\u{2066}", "a\u{9b}2Jb", "a\u{200b}b\u{feff}"];

#[cfg(unix)]
#[test]
fn a_table_that_is_no_plain_file_is_refused_at_once() {
    let folder = folder();
    let made = Command::new("mkfifo").arg(folder.path().join("fifo")).status().expect("`mkfifo` starts");
    assert!(made.success());
    fs::create_dir(folder.path().join("inner")).expect("a folder");
    for (table, reason) in [("fifo", "it is not a regular file"), ("inner", "it is not a regular file")] {
        let model = write(folder.path(), "m.vib", driven(table));
        let refused = run(&["check", &model]);
        assert_eq!(status(&refused), 3, "{table}");
        assert!(messages(&refused).contains(reason), "{}", messages(&refused));
    }
    // Even if every file is allowed, devices and the program's own streams are refused.
    for table in ["/dev/zero", "/dev/stdin", "/proc/self/fd/0", "/dev/null"] {
        let model = write(folder.path(), "m.vib", driven(table));
        let refused = run(&["check", &model, "--root", "/"]);
        assert_eq!(status(&refused), 3, "{table}");
        assert!(messages(&refused).contains("it is not a regular file"), "{}", messages(&refused));
    }
}

#[test]
fn a_table_lies_below_the_folder_of_its_model() {
    let folder = folder();
    let models = folder.path().join("models");
    fs::create_dir_all(models.join("data")).expect("a folder");
    write(folder.path(), "beside.csv", "0,0\n1,2\n");
    write(&models, "data/push.csv", "0,0\n1,2\n");
    let simulate = |table: &str, more: &[&str]| {
        let model = write(&models, "m.vib", driven(table));
        run(&[&["simulate", "--until", "1s", "--step", "0.5s", &model], more].concat())
    };
    let absolute = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    for inside in ["data/push.csv", "./data/../data/push.csv", &absolute("models/data/push.csv")] {
        let done = simulate(inside, &[]);
        assert_eq!(status(&done), 0, "{inside}: {}", messages(&done));
    }
    for outside in ["../beside.csv", "data/../../beside.csv", &absolute("beside.csv"), "/etc/passwd"] {
        let refused = simulate(outside, &[]);
        assert_eq!(status(&refused), 3, "{outside}");
        assert!(messages(&refused).contains("it lies outside the model's folder"), "{}", messages(&refused));
    }
    let allowed = simulate("../beside.csv", &["--root", &folder.path().to_string_lossy()]);
    assert_eq!(status(&allowed), 0, "{}", messages(&allowed));
    // A link counts as its target, and another root allows only its own files.
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(folder.path().join("beside.csv"), models.join("link.csv")).expect("a link");
        assert_eq!(status(&simulate("link.csv", &[])), 3);
    }
    assert_eq!(status(&simulate("../beside.csv", &["--root", &absolute("models/data")])), 3);
}

#[test]
fn the_content_of_a_file_that_is_not_a_table_is_not_shown() {
    let folder = folder();
    for (content, line) in [
        ("root:secret:0:0:secret:/root:/bin/sh\nuser:secret\n", 1),
        ("secret,secret\nsecret,secret\n", 2),
        ("\n# secret\nsecret = secret\n", 3),
        ("1,secret\n2,3\n", 1),
        ("secret,a\u{1b}[2J\n1\n", 2),
    ] {
        write(folder.path(), "no_table", content);
        let model = write(folder.path(), "m.vib", driven("no_table"));
        for form in ["human", "short", "json"] {
            let refused = run(&["check", &model, "--message-format", form]);
            assert_eq!(status(&refused), 1, "{content}");
            assert!(!messages(&refused).contains("secret"), "{}", messages(&refused));
        }
        let found = findings(&run(&["check", &model, "--message-format", "json"]));
        assert_eq!((found.len(), found[0]["code"].as_str()), (1, Some("vib::table::row")), "{content}");
        assert_eq!(found[0]["label"], format!("its line {line} is not a time and a value"));
        assert_eq!((found[0]["file"].as_str(), found[0]["line"].as_u64()), (Some(&*model), Some(3)));
    }
}

#[test]
fn tables_have_their_own_limits() {
    let folder = folder();
    let rows: String = (0..1_000_001).map(|row| format!("{row},0\n")).collect();
    write(folder.path(), "long.csv", rows);
    let long = run(&["check", &write(folder.path(), "m.vib", driven("long.csv"))]);
    assert_eq!(status(&long), 3);
    assert!(messages(&long).contains("at most 1000000 rows in total"), "{}", messages(&long));
    let file = fs::File::create(folder.path().join("large.csv")).expect("a file");
    file.set_len((64 << 20) + 1).expect("a hole in it");
    let large = run(&["check", &write(folder.path(), "m.vib", driven("large.csv"))]);
    assert_eq!(status(&large), 3);
    assert!(messages(&large).contains("at most 64 MiB in total"), "{}", messages(&large));
}

#[cfg(unix)]
#[test]
fn no_file_name_steers_the_terminal() {
    let folder = folder();
    let scene = "body b { mass = 1 kg, moves x }\nspring s: ground -- b { k = 10 N/m }\nforce F: b = step(1 N, 0 s)\n\
                 output x = b.x\nrequire frequency(1) > 0.1 Hz\n";
    for name in STEERING {
        let model = write(folder.path(), &format!("{name}.vib"), scene);
        let model = model.as_str();
        let wrong = write(folder.path(), &format!("{name} wrong.vib"), "body b {\n");
        let missing = format!("{model}.missing/file");
        for arguments in [
            &["analyze", model][..],
            &["analyze", model, "--format", "json"],
            &["analyze", model, "--explain-model"],
            &["transfer", model, "--at", "1Hz"],
            &["transfer", model, "--at", "1Hz", "--format", "json"],
            &["simulate", model, "--until", "1s", "--step", "0.5s", "--format", "text"],
            &["simulate", model, "--until", "1s", "--step", "0.5s", "--format", "json"],
            &["emit", model, "--target", "c"],
            &["emit", model, "--target", "rust"],
            &["emit", model, "--target", "rust", "--style", "equations"],
            &["check", model],
            &["fmt", "--check", model],
            &["check", &wrong],
            &["check", &wrong, "--message-format", "json"],
            &["check", &wrong, "--message-format", "short"],
            &["check", &missing],
            &["check", &missing, "--message-format", "json"],
            &["analyze", model, "-o", model],
            &["analyze", model, "-o", &missing],
            &["emit", model, "--target", "c", "-o", &format!("{model}/x")],
            &["check", model, "--settings", &missing],
        ] {
            let done = run(arguments);
            let out = String::from_utf8(done.stdout.clone()).expect("UTF-8");
            assert!(!steers(&out), "{arguments:?}: {out:?}");
            assert!(!steers(&messages(&done)), "{arguments:?}: {:?}", messages(&done));
        }
    }
}

#[test]
fn json_escapes_what_steers_and_keeps_the_name() {
    let folder = folder();
    let name = "a\u{202e}b\u{200b}.vib";
    let wrong = write(folder.path(), name, "body b { mass = 1 kg, moves x, \u{202e} }\n");
    let done = run(&["check", &wrong, "--message-format", "json"]);
    assert!(!steers(&messages(&done)), "{:?}", messages(&done));
    assert!(findings(&done).iter().all(|finding| finding["file"] == wrong.as_str()));
}

#[cfg(unix)]
#[test]
fn no_argument_steers_the_terminal() {
    for text in STEERING {
        for arguments in [
            &[text][..],
            &["analyze", "m.vib", text],
            &["analyze", "m.vib", "--format", text],
            &["analyze", "m.vib", "--modes", text],
            &["analyze", "m.vib", "--tolerance", text],
            &["analyze", "m.vib", &format!("--{text}")],
            &["analyze", "m.vib", "--set", text],
            &["analyze", "m.vib", "--set", &format!("k=1\n{text}")],
            &["transfer", "m.vib", "--range", text],
            &["explain", text],
            &["man", text],
        ] {
            let refused = run(arguments);
            assert_eq!(status(&refused), 2, "{arguments:?}");
            assert!(
                refused.stdout.is_empty() && !steers(&messages(&refused)),
                "{arguments:?}: {:?}",
                messages(&refused)
            );
        }
    }
}

#[cfg(unix)]
#[test]
fn an_output_goes_where_a_link_leads_and_whole() {
    use std::os::unix::fs::symlink;
    let folder = folder();
    let model = write(folder.path(), "m.vib", "body b { mass = 1 kg, moves x }\nspring s: ground -- b { k = 1 N/m }\n");
    let report = String::from_utf8(run(&["analyze", &model]).stdout).expect("UTF-8");
    let at = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    // The old text survives under its other name: the new one was written to a new file, not over it.
    let (old, other) = (write(folder.path(), "old.txt", "old"), at("other.txt"));
    fs::hard_link(&old, &other).expect("another name");
    assert_eq!(status(&run(&["analyze", &model, "-o", &old])), 0);
    assert_eq!(
        (fs::read_to_string(&old).unwrap(), fs::read_to_string(&other).unwrap()),
        (report.clone(), "old".into())
    );
    // A link to a file that does not exist yet.
    symlink("new.txt", at("link.txt")).expect("a link");
    symlink("link.txt", at("second.txt")).expect("a link");
    assert_eq!(status(&run(&["analyze", &model, "-o", &at("second.txt")])), 0);
    assert!(fs::symlink_metadata(at("link.txt")).unwrap().is_symlink());
    assert!(fs::symlink_metadata(at("second.txt")).unwrap().is_symlink());
    assert_eq!(fs::read_to_string(at("new.txt")).unwrap(), report);
    symlink("round.txt", at("round.txt")).expect("a link");
    assert_eq!(status(&run(&["analyze", &model, "-o", &at("round.txt")])), 3);
    assert!(fs::symlink_metadata(at("round.txt")).unwrap().is_symlink());
    let hidden = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name());
    assert!(hidden.into_iter().all(|name| !name.to_string_lossy().starts_with('.')), "nothing temporary is left");
}

/// Two outputs of one file would leave the second; `/dev/null` takes any number.
#[cfg(unix)]
#[test]
fn a_file_is_written_once() {
    let folder = folder();
    let model = write(
        folder.path(),
        "m.vib",
        "body b { mass = 1 kg, moves x }\nspring s: ground -- b { k = 1 N/m }\nforce F: b along x = step(1 N, 0 s)\noutput x = b.x\n",
    );
    let at = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    fs::create_dir(at("sub")).expect("a folder");
    let simulate = ["simulate", "--until", "1s", "--step", "0.5s"];
    for (command, text, picture) in
        [(&["transfer"][..], at("one"), at("one")), (&simulate[..], at("one"), at("sub/../one"))]
    {
        let arguments: Vec<&str> = command.iter().copied().chain([&model, "-o", &text, "--svg", &picture]).collect();
        let output = run(&arguments);
        assert_eq!(status(&output), 2, "{arguments:?}");
        assert!(String::from_utf8_lossy(&output.stderr).contains("is to be written twice"), "{arguments:?}");
        assert!(!folder.path().join("one").exists());
    }
    let output = run(&["transfer", &model, "-o", "/dev/null", "--svg", "/dev/null"]);
    assert_eq!(status(&output), 0, "{}", String::from_utf8_lossy(&output.stderr));
    let many = run(&["simulate", &model, "--until", "1e308s", "--step", "1e-300s"]);
    assert!(String::from_utf8_lossy(&many.stderr).contains("more than 1e308 samples"));
}

/// Another run with the same process number, perhaps in another container, was killed: the files that it left neither
/// disturb nor get removed.
#[cfg(unix)]
#[test]
fn files_of_another_run_do_not_interfere() {
    let folder = folder();
    let model = write(folder.path(), "m.vib", "body b { mass = 1 kg, moves x }\nspring s: ground -- b { k = 1 N/m }\n");
    let script = ": > .r.txt.$$-0.new; : > .r.txt.$$.new; exec \"$0\" analyze \"$1\" -o r.txt";
    let mut shell = Command::new("sh");
    let done = shell.args(["-c", script, env!("CARGO_BIN_EXE_vibc"), &model]).current_dir(folder.path()).output();
    let done = done.expect("a shell");
    assert_eq!(status(&done), 0, "{}", messages(&done));
    assert!(fs::read_to_string(folder.path().join("r.txt")).unwrap().starts_with("m · 1 degree of freedom"));
    let names = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name());
    assert_eq!(names.filter(|name| name.to_string_lossy().ends_with(".new")).count(), 2);
}

fn checked(text: &str) -> Vec<vibc::base::Diagnostic> {
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model("m.vib", text));
    let parsed = vibc::syntax::parse(&sources, file);
    let mut found = model::check(&sources, &parsed.tree, &Overrides::default()).diagnostics;
    found.extend(parsed.errors);
    found.into_sorted()
}

/// Regression: each level was stored with all levels inside it, and each byte was read once for every enclosing level.
#[test]
fn nested_syntax_errors_are_stored_once() {
    let levels = 3000;
    let text = "repeat i in 1..2 {\n".repeat(levels) + &"}\n".repeat(levels);
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model("m.vib", text.as_str()));
    let parsed = vibc::syntax::parse(&sources, file);
    let kept: usize = parsed.tree.broken.iter().map(|span| span.len()).sum();
    assert!(kept <= text.len(), "{kept} bytes of {}", text.len());
    let codes: Vec<&str> = parsed.errors.iter().map(|error| error.code.0).collect();
    assert_eq!(codes, ["vib::syntax::too_deep"]);
}

/// The grammar takes them for letters, the parser does not: names that look alike would be different ones.
#[test]
fn words_have_no_letters_of_other_scripts() {
    let cases = [
        ("body bé { mass = 1 kg, moves x }", "é"),
        ("body aж1 { mass = 1 kg, moves x }", "ж1"),
        ("spring s: ground -- aéb { k = 1 N/m }", "éb"),
        ("body d { maéss = 1 kg, moves x }", "éss"),
        ("output z = d.xé", "é"),
        ("output z = sinή(1)", "\u{301}"),
        ("let a = 2 * b·c", "·"),
    ];
    for (text, found) in cases {
        let mut sources = Sources::new();
        let file = sources.add(SourceFile::model("m.vib", text));
        let parsed = vibc::syntax::parse(&sources, file);
        let errors: Vec<_> = parsed.errors.iter().collect();
        assert_eq!(errors.len(), 1, "{text}");
        assert_eq!(errors[0].code.0, "vib::syntax::unexpected", "{text}");
        assert!(sources.slice(errors[0].primary.span).starts_with(found), "{text}: {:?}", errors[0]);
        assert!(parsed.tree.decls.is_empty(), "{text}");
    }
}

#[test]
fn the_first_hundred_errors_are_reported_and_the_rest_counted() {
    let body = "body b { mass = 1 kg, moves x }\n";
    for (count, more) in
        [(100, None), (101, Some("1 more error in this model")), (5000, Some("4900 more errors in this model"))]
    {
        let springs = (0..count).map(|i| format!("spring s[{i}]: ground -- b {{ k = k{i} }}\n"));
        let found = checked(&(body.to_string() + &springs.collect::<String>()));
        assert_eq!(found.len(), 100 + usize::from(more.is_some()), "{count}");
        assert!(found[..100].iter().all(|finding| finding.code.0 == "vib::name::unknown"));
        assert_eq!(found.get(100).map(|last| last.message.as_str()), more);
    }
    // Warnings are counted separately: they hide no error.
    let unused: String = (0..300).map(|i| format!("param p{i} = 1 m\n")).collect();
    let found = checked(&(body.to_string() + &unused + "spring s: ground -- b { k = 1 N/m }\n"));
    assert_eq!((found.len(), found[100].message.as_str()), (101, "200 more warnings and notes in this model"));
}

#[test]
fn an_undeclared_name_is_reported_once() {
    let text = "body aarm { mass = 1 kg, moves x }\nspring s: ground -- arm { k = kk }\nspring t: ground -- arm { k = kk }\n\
                damper d: ground -- arm { c = 1 N*s/m }\noutput x = arm.x\noutput v = arm.vx\n";
    let found = checked(text);
    let messages: Vec<(&str, usize)> = found.iter().map(|one| (one.code.0, one.primary.span.start())).collect();
    let place = |word: &str| text.find(word).expect("it is there");
    assert_eq!(messages, [("vib::part::unknown", place("-- arm") + 3), ("vib::name::unknown", place("kk"))]);
}

#[test]
fn repeats_make_no_more_than_fits() {
    let one = |count: u32| format!("repeat i in 1..{count} {{ body m[i] {{ mass = 1 kg, moves x }} }}\n");
    let found = checked(&one(1_000_001));
    assert_eq!((found.len(), found[0].code.0), (1, "vib::limit::repeat"));
    assert_eq!(found[0].message, "this makes more than 1000000 bodies");
    // Two of them together exceed the limit.
    let two = one(600_000) + &one(600_000).replace("m[", "n[");
    let found: Vec<&str> = checked(&two).iter().map(|finding| finding.code.0).collect();
    assert_eq!(found, ["vib::limit::repeat"]);
    let forces = "repeat i in 1..1000001 { force F[i]: b along x }\n".to_string() + &one(2).replace("m[i]", "b");
    assert!(
        checked(&forces).iter().any(|one| one.message == "this makes more than 1000000 joints, inputs and outputs")
    );
    let many = "repeat i in 1..4000001 { param p[i] = 1 m }\n".to_string() + &one(2);
    assert_eq!(checked(&many)[0].message, "this makes more than 4000000 declarations");
}

/// Links that hang one under another: each moves with all above it, which would make n^3 products.
#[test]
fn a_transfer_function_of_deep_links_is_refused_before_it_is_summed() {
    let folder = folder();
    let links = 800;
    let text = format!(
        "gravity 9.81 m/s^2\nbody r[1] {{ mass = 1 kg, shape = rod((0, 0), (0, -1 m)) }}\npivot p[1]: ground@(0, 0) -- r[1]\n\
         repeat i in 2..{links} {{\nbody r[i] {{ mass = 1 kg, shape = rod((0, -(i-1) * 1 m), (0, -i * 1 m)) }}\n\
         pivot p[i]: r[i-1]@(0, -(i-1) * 1 m) -- r[i]\n}}\nforce F: r[1] along x\noutput x = r[{links}].x\n"
    );
    let model = write(folder.path(), "m.vib", text);
    let refused = run(&["transfer", "--points", "20", "--range", "0.1Hz..10Hz", &model, "--message-format", "json"]);
    assert_eq!(status(&refused), 4, "{}", messages(&refused));
    let found = findings(&refused);
    assert_eq!((found.len(), found[0]["code"].as_str()), (1, Some("vib::limit::depth")));
}

/// One body with this many forces and outputs.
fn of_many(forces: usize, outputs: usize) -> String {
    format!(
        "body a {{ mass = 1 kg, moves x }}\nspring s: ground -- a {{ k = 100 N/m }}\ndamper d: ground -- a {{ c = 2 N*s/m }}\n\
         repeat i in 1..{forces} {{ force F[i]: a along x }}\nrepeat i in 1..{outputs} {{ output y[i] = a.x }}\n"
    )
}

/// The message and the help of the only finding of a run, which has the code for too many values.
fn too_many_values(model: &str, arguments: &[&str]) -> [String; 2] {
    let refused = run(&[arguments, &[model, "--message-format", "json"]].concat());
    assert_eq!(status(&refused), 4, "{}", messages(&refused));
    let found = findings(&refused);
    assert_eq!((found.len(), found[0]["code"].as_str()), (1, Some("vib::limit::values")));
    ["message", "help"].map(|field| found[0][field].as_str().expect("text").to_string())
}

#[test]
fn a_transfer_table_that_would_not_fit_is_refused_with_its_size() {
    let folder = folder();
    let model = write(folder.path(), "m.vib", of_many(700, 700));
    let at_one = too_many_values(&model, &["transfer", "--at", "1Hz"]);
    assert_eq!(
        at_one,
        [
            "a table of 490000 pairs of inputs and outputs at 1 frequency is too large; the limit is 363636 pairs",
            "choose inputs by `--from` and outputs by `--to`, or ask for fewer frequencies by `--points` or `--at`",
        ]
    );
    // One pair of it is a table like any other.
    let one = run(&["transfer", "--from", "F[1]", "--to", "y[1]", "--at", "1Hz", &model]);
    assert_eq!(status(&one), 0, "{}", messages(&one));
    let small = write(folder.path(), "m.vib", of_many(20, 20));
    let grid = ["transfer", "--range", "1Hz..9Hz", "--points", "10000", "--format", "csv"];
    assert!(too_many_values(&small, &grid)[0].starts_with("a table of 400 pairs of inputs and outputs at 10000 freq"));
    // The grid of its own has more than 200 frequencies, where fewer pairs fit; a report needs the extrema alone.
    let model = write(folder.path(), "m.vib", of_many(140, 140));
    let own = too_many_values(&model, &["transfer", "--format", "csv"]);
    assert!(own[0].starts_with("a table of 19600 pairs of inputs and outputs at 2"), "{}", own[0]);
}

/// Regression: each pair had a row for its peak, with a value for every pair, although all pairs have it in one place.
#[test]
fn peaks_in_one_place_are_one_row() {
    let folder = folder();
    let model = write(folder.path(), "m.vib", of_many(3, 3));
    let table = run(&["transfer", "--format", "csv", &model]);
    let text = String::from_utf8(table.stdout).expect("text");
    let mut hertz: Vec<&str> = text.lines().skip(1).filter_map(|line| line.split(',').next()).collect();
    let all = hertz.len();
    hertz.dedup();
    assert_eq!(all, 9 * hertz.len());
}

#[test]
fn a_motion_that_would_not_fit_is_refused_with_its_size() {
    let folder = folder();
    let model = write(folder.path(), "m.vib", of_many(1, 2000));
    assert_eq!(
        too_many_values(&model, &["simulate", "--until", "100s", "--step", "10ms"]),
        [
            "2000 outputs at 10001 times are 20002000 values; the limit is 20000000",
            "use a longer `--step` or a shorter `--until`, or declare fewer outputs",
        ]
    );
}

/// Regression: from 16 coordinates on, a motion without outputs waited for samples that nothing made.
#[test]
fn a_motion_without_outputs_ends_with_a_message() {
    let folder = folder();
    for count in [1, 16, 40] {
        let text = format!(
            "repeat i in 1..{count} {{ body m[i] {{ mass = 1 kg, moves x }} }}\nspring s[1]: ground -- m[1] {{ k = 9 N/m }}\n\
             repeat i in 2..{count} {{ spring s[i]: m[i-1] -- m[i] {{ k = 9 N/m }} }}\nforce F: m[1] along x = step(1 N, 0 s)\n"
        );
        let model = write(
            folder.path(),
            "m.vib",
            text.replace("repeat i in 2..1 { spring s[i]: m[i-1] -- m[i] { k = 9 N/m } }", ""),
        );
        let refused = run(&["simulate", "--until", "1s", "--step", "50ms", &model]);
        assert_eq!((status(&refused), refused.stdout.len()), (2, 0), "{count}");
        assert_eq!(messages(&refused).trim(), "error: the model declares no output", "{count}");
    }
}

#[test]
fn no_force_is_reported_as_infinite() {
    let folder = folder();
    let text = "gravity 9.81 m/s^2\nrest as drawn\nbody rod { mass = 1e308 kg, shape = rod((0, 0), (1 m, 0)) }\n\
                pivot p: ground@(0, 0) -- rod\n";
    let refused = run(&["check", &write(folder.path(), "m.vib", text)]);
    assert_eq!(status(&refused), 1);
    assert!(messages(&refused).contains("`rod.angle`: more than 1.8e308 N*m"), "{}", messages(&refused));
}

/// The largest size that is accepted, and the smallest that is refused.
#[test]
fn brackets_and_numbers_have_their_documented_limits() {
    let brackets = |levels: usize| format!("param k = {}1{}\n", "(".repeat(levels), ")".repeat(levels));
    let number = |bytes: usize| format!("param k = 0.{} N/m\n", "1".repeat(bytes - 2));
    let errors = |text: &str| {
        let mut sources = Sources::new();
        let file = sources.add(SourceFile::model("m.vib", text));
        vibc::syntax::parse(&sources, file).errors.iter().map(|error| error.code.0).collect::<Vec<_>>()
    };
    assert_eq!(errors(&brackets(64)), Vec::<&str>::new());
    assert_eq!(errors(&brackets(65)), ["vib::syntax::too_deep"]);
    assert_eq!(errors(&number(1000)), Vec::<&str>::new());
    assert_eq!(errors(&number(1001)), ["vib::syntax::too_large"]);
}
