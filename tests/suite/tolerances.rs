//! Tolerances of parameters in the language: what they mean in SI units, and each mistake as one finding at its place.

use crate::bad_loads::one;
use crate::measures::sources;
use vibc::base::SourceFile;
use vibc::model::scene::{Scene, Spread};
use vibc::model::{self, Overrides};

const AFTER: &str = "\nbody block { mass = m, moves x }\nspring s: ground -- block { k = k }\n";

fn scene(text: &str, set: Option<&str>) -> Scene {
    let (mut sources, file) = sources(&format!("{text}{AFTER}"));
    let arguments = set
        .map(|set| sources.add(SourceFile { kind: vibc::SourceKind::Arguments, ..SourceFile::model("outside", set) }));
    let tree = vibc::syntax::parse(&sources, file).tree;
    let checked = model::check(&sources, &tree, &Overrides { arguments, ..Overrides::default() });
    assert!(checked.diagnostics.is_empty(), "{text}: {:?}", checked.diagnostics);
    checked.scene.expect("a scene").scene().clone()
}

/// The range of `param k = 10 N/m` with these clauses.
fn range(clauses: &str, set: Option<&str>) -> [f64; 2] {
    let scene = scene(&format!("param m = 1 kg\nparam k = 10 N/m {clauses}"), set);
    let [tolerance] = &scene.tolerances[..] else { panic!("{clauses}") };
    assert_eq!(tolerance.parameter.name, "k");
    tolerance.within.as_ref().expect("a range").each_ref().map(|end| end.to_f64())
}

#[test]
fn a_tolerance_is_a_share_a_half_width_or_a_range() {
    assert_eq!(range("within 5 %", None), [9.5, 10.5]);
    assert_eq!(range("within 0.2 N/m", None), [9.8, 10.2]);
    assert_eq!(range("within 200 N/km", None), [9.8, 10.2]);
    assert_eq!(range("within 9 N/m .. 12 N/m", None), [9.0, 12.0]);
    assert_eq!(range("within 10 N/m..0.012 kN/m", None), [10.0, 12.0]);
    assert_eq!(range("spread 10 % within 30 %", None), [7.0, 13.0]);
    assert_eq!(range("within 5 %", Some("k = 20 N/m")), [19.0, 21.0]);
    assert_eq!(range("within (2 + 3) * 1 %", None), [9.5, 10.5]);
}

#[test]
fn a_spread_is_normal_lognormal_or_uniform() {
    let spread = |clauses: &str| {
        let scene = scene(&format!("param m = 1 kg\nparam k = 10 N/m {clauses}"), None);
        scene.tolerances[0].spread.clone()
    };
    let deviation = |clauses: &str| match spread(clauses) {
        Some(Spread::Normal { deviation }) => ("normal", deviation.to_f64()),
        Some(Spread::Lognormal { deviation }) => ("lognormal", deviation.to_f64()),
        _ => panic!("{clauses}"),
    };
    assert_eq!(deviation("spread 2.5 %"), ("normal", 0.25));
    assert_eq!(deviation("spread 0.1 N/m"), ("normal", 0.1));
    assert_eq!(deviation("spread lognormal 3 %"), ("lognormal", 0.03));
    assert!(matches!(spread("spread uniform within 3 %"), Some(Spread::Uniform)));
    assert!(spread("within 3 %").is_none());
}

#[test]
fn parameters_of_a_repeat_are_independent_and_correlations_name_them() {
    let text = "param k = 10 N/m spread 2 %\nparam m = 1 kg\nrepeat i in 1..3 {\n    param c[i] = i * 1 N*s/m spread 2 %\n    \
                damper d[i]: ground -- block { c = c[i] }\n}\ncorrelate c[3], k -0.5\ncorrelate c[1], c[2] 0.5";
    let scene = scene(text, None);
    let names: Vec<&str> = scene.tolerances.iter().map(|tolerance| tolerance.parameter.name.as_str()).collect();
    assert_eq!(names, ["k", "c[1]", "c[2]", "c[3]"]);
    let pairs: Vec<([usize; 2], f64)> =
        scene.correlations.iter().map(|one| (one.pair, one.coefficient.to_f64())).collect();
    assert_eq!(pairs, [([0, 3], -0.5), ([1, 2], 0.5)]);
}

/// Three equal coefficients r are those of some distribution for r > -1/2, and for no other r.
#[test]
fn correlations_are_positive_definite() {
    let text = |r: &str| {
        format!(
            "param m = 1 kg spread 1 %\nparam k = 10 N/m spread 1 %\nparam c = 1 N*s/m spread 1 %\n\
             correlate m, k {r}\ncorrelate c, m {r}\n«correlate k, c {r}»\n\
             damper d: ground -- block {{ c = c }}{AFTER}"
        )
    };
    for r in ["-0.499", "-0.4999999999999999999999", "0.9999999999999999999999"] {
        let written = text(r).replace(['«', '»'], "").replace(AFTER, "");
        assert_eq!(scene(&written, None).correlations.len(), 3, "{r}");
    }
    for r in ["-0.5", "-0.501", "-1/2"] {
        one(&text(r), "vib::tolerance::correlation");
    }
}

#[test]
fn a_mistake_in_a_tolerance_is_one_finding() {
    for (line, code) in [
        ("param k = 10 N/m within «11 N/m .. 12 N/m»", "vib::tolerance::outside"),
        ("param k = 10 N/m within «8 N/m .. 9 N/m»", "vib::tolerance::outside"),
        ("param k = 10 N/m within «12 N/m .. 9 N/m»", "vib::solve::range"),
        ("param k = 10 N/m within «10 N/m .. 10 N/m»", "vib::solve::range"),
        ("param k = 10 N/m within «5 kg»", "vib::unit::mismatch"),
        ("param k = 10 N/m within «5 kg .. 6 kg»", "vib::unit::mismatch"),
        ("param k = 10 N/m within 9 N/m .. «6 kg»", "vib::unit::mismatch"),
        ("param k = 10 N/m within «0 %»", "vib::tolerance::width"),
        ("param k = 10 N/m within «-5 %»", "vib::tolerance::width"),
        ("param k = 10 N/m spread «-5 %»", "vib::tolerance::width"),
        ("param k = 10 N/m spread «0 N/m»", "vib::tolerance::width"),
        ("param k = 10 N/m spread lognormal «-3 %»", "vib::tolerance::width"),
        ("param k = 10 N/m spread lognormal «1 N/m»", "vib::unit::mismatch"),
        ("param k = -10 N/m spread lognormal «1 %»", "vib::tolerance::width"),
        ("param k = 0 N/m within «5 %»", "vib::tolerance::width"),
        ("param k = 10 N/m «spread uniform»", "vib::tolerance::width"),
        ("param z = 2 within «5 %»\nlet k = z * 1 N/m", "vib::tolerance::width"),
        ("param z = 2 spread «0.1»\nlet k = z * 1 N/m", "vib::tolerance::width"),
        ("param k = 10 N/m within 5 %\ncorrelate k, «m» 0.8", "vib::tolerance::correlation"),
        ("param k = 10 N/m within 5 %\ncorrelate k, «z» 0.8", "vib::name::unknown"),
        ("param k = 10 N/m within 5 %\ncorrelate k, «k» 0.8", "vib::tolerance::correlation"),
        (
            "param k = 10 N/m within 5 %\nparam c = 1 N/m within 5 %\nlet u = c\ncorrelate k, c «1.5»",
            "vib::tolerance::correlation",
        ),
        (
            "param k = 10 N/m within 5 %\nparam c = 1 N/m within 5 %\nlet u = c\ncorrelate k, c 0.5\n«correlate c, k 0.5»",
            "vib::tolerance::correlation",
        ),
    ] {
        one(
            &format!("param m = 1 kg\n{line}{AFTER}").replace("let u = c\n", "spring t: ground -- block { k = c }\n"),
            code,
        );
    }
}

/// Between sqrt(9.5 / 1.2) and sqrt(10.5 / 0.9) rad/s, 0.4478 Hz and 0.5436 Hz, and each requirement over all of it; `solve` holds its
/// parameter at the value that it finds, and a spread alone is none.
#[test]
fn analyze_tells_what_holds_for_all_values() {
    let text = |more: &str| {
        format!(
            "param m = 1 kg within 0.9 kg .. 1.2 kg\nparam k = 10 N/m within 5 %\nparam q = 0 N/m spread 1 N/m\n{more}{AFTER}spring t: ground -- b2 {{ k = 1 N/m + q }}\nbody b2 {{ mass = 1000 kg, moves x }}\n"
        )
    };
    let printed = |text: &str| {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::write(folder.path().join("m.vib"), text).expect("a file");
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_vibc"));
        let output =
            command.args(["analyze", "m.vib", "--tolerances"]).current_dir(folder.path()).output().expect("it starts");
        (
            output.status.code(),
            String::from_utf8(output.stdout).expect("UTF-8"),
            String::from_utf8(output.stderr).expect("UTF-8"),
        )
    };
    let requires = "require frequency(2) > 0.447 Hz\nrequire frequency(2) < 0.543 Hz\nrequire damping(2) < 1 %\n";
    let (status, report, _) = printed(&text(requires));
    assert_eq!(status, Some(0), "{report}");
    let row = |start: &str| {
        let own = report.lines().skip_while(|line| !line.contains("for all values"));
        own.map(str::trim)
            .find(|line| line.starts_with(start))
            .unwrap_or_else(|| panic!("{start}\n{report}"))
            .to_string()
    };
    assert!(row("for all values within m = 0.9 .. 1.2 kg, k = 9.5 .. 10.5 N/m").ends_with("N/m"));
    let words: Vec<String> = row("2 ").split_whitespace().map(String::from).collect();
    let hertz = |square: f64| f64::sqrt(square) / std::f64::consts::TAU;
    for (word, truth) in [(&words[1], hertz(9.5 / 1.2)), (&words[3], hertz(10.5 / 0.9))] {
        assert!((word.parse::<f64>().expect("a number") - truth).abs() < 1e-6, "{word} {truth}");
    }
    assert!(row("frequency(2) > 0.447 Hz").ends_with("holds"));
    assert!(row("frequency(2) < 0.543 Hz").ends_with("fails at m = 0.9 kg, k = 10.5 N/m"));
    // Nothing damps.
    assert!(row("damping(2) < 1 %").ends_with("holds"));
    // k is found, and m alone has a range.
    let (_, report, _) = printed(&text("solve k in 1 N/m .. 100 N/m: frequency(2) = 1 Hz\n"));
    assert!(report.contains("for all values within m = 0.9 .. 1.2 kg\n"), "{report}");
    let (status, report, said) = printed(&text("").replace("within 5 %", "").replace("within 0.9 kg .. 1.2 kg", ""));
    assert_eq!((status, &*report), (Some(2), ""));
    assert!(said.contains("no parameter of the model has a range"), "{said}");
}

/// `--robust` needs something to optimise, and a range; the report tells the worst case and never rounds a bound inwards.
#[test]
fn analyze_tells_the_best_worst_case() {
    let folder = tempfile::tempdir().expect("a folder");
    let printed = |clause: &str, line: &str| {
        let model = folder.path().join("m.vib");
        let text = format!(
            "param k = 100 N/m {clause}\nparam m = 0.9 kg\nbody b {{ mass = m, moves x }}\nspring s: ground -- b {{ k = k }}\n\
             damper d: ground -- b {{ c = 0.5 N*s/m }}\nforce F: b along x\noutput x = b.x\n{line}\n"
        );
        std::fs::write(&model, text).expect("a file");
        let mut program = std::process::Command::new(env!("CARGO_BIN_EXE_vibc"));
        let output =
            program.args(["analyze", &model.to_string_lossy(), "--robust", "--width", "200"]).output().expect("output");
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("text");
        (output.status.code(), text(output.stdout), text(output.stderr))
    };
    let (within, line) = ("within 90 N/m .. 120 N/m", "maximise gain(F -> x, 10 rad/s) over m in 0.5 kg .. 2 kg");
    let (status, report, _) = printed(within, line);
    assert_eq!(status, Some(0));
    // 1 / |15 + 5 i| = 0.063245553...: rounded down.
    assert!(report.contains("maximised the worst case of gain(F -> x, 10 rad/s): at least 0.0632455 m/N"), "{report}");
    assert!(report.contains("for all values within k = 90 .. 120 N/m"), "{report}");
    let (status, report, said) = printed("", line);
    assert_eq!((status, &*report), (Some(2), ""));
    assert!(said.contains("no parameter of the model has a range"), "{said}");
    let (status, report, said) = printed(within, "");
    assert_eq!((status, &*report), (Some(2), ""));
    assert!(said.contains("no line `minimise` or `maximise`"), "{said}");
    // 2.2 Hz takes at most 0.471 kg with the softest spring, and 0.524 kg with the declared one.
    let (status, _, said) = printed(within, &format!("{line} while frequency(1) > 2.2 Hz"));
    assert_eq!(status, Some(1));
    assert!(said.contains("for all values within"), "{said}");
}

#[test]
fn a_value_from_outside_lies_in_the_tolerance() {
    let (mut sources, file) = sources(&format!("param m = 1 kg\nparam k = 10 N/m within 9 N/m .. 11 N/m{AFTER}"));
    let arguments = Some(
        sources.add(SourceFile { kind: vibc::SourceKind::Arguments, ..SourceFile::model("outside", "k = 12 N/m") }),
    );
    let tree = vibc::syntax::parse(&sources, file).tree;
    let checked = model::check(&sources, &tree, &Overrides { arguments, ..Overrides::default() });
    let codes: Vec<&str> = checked.diagnostics.iter().map(|found| found.code.0).collect();
    assert_eq!(codes, ["vib::tolerance::outside"]);
}

#[test]
fn a_tolerance_has_one_layout() {
    for (written, laid_out) in [
        ("param k=10N/m  within   5%\n", "param k = 10 N/m within 5 %\n"),
        ("param k = 2 N/m spread   3% within 1N/m..3 N/m\n", "param k = 2 N/m spread 3 % within 1 N/m .. 3 N/m\n"),
        ("param k=2 spread uniform  within(1) .. 3\n", "param k = 2 spread uniform within (1) .. 3\n"),
        ("param k=2 m spread  lognormal -3%\n", "param k = 2 m spread lognormal -3 %\n"),
        ("correlate k ,  m[1] - 0.8\n", "correlate k, m[1] -0.8\n"),
        ("correlate k, m[i, 1] a - 0.8\n", "correlate k, m[i, 1] a - 0.8\n"),
        ("correlate k, m -a-0.8\n", "correlate k, m -a - 0.8\n"),
    ] {
        let (sources, file) = sources(written);
        let once = vibc::format(&sources, file).answer.expect("a model");
        assert_eq!(once, laid_out);
    }
}

/// k = 4 pi^2 N/m is outside of the range; a value that an analysis tries is no mistake in the model.
#[test]
fn a_value_that_solve_finds_may_lie_outside() {
    let text =
        "param m = 1 kg\nparam k = 10 N/m within 9 N/m .. 11 N/m\nsolve k in 20 N/m .. 100 N/m: frequency(1) = 1 Hz";
    let (sources, file) = sources(&format!("{text}{AFTER}"));
    let outcome = vibc::analyze(&sources, file, &Overrides::default());
    assert!(outcome.diagnostics.is_empty(), "{:?}", outcome.diagnostics);
    assert_eq!(outcome.answer.expect("a report").solved.len(), 1);
}

/// The chain of four blocks and five springs of Z. Qiu, S. Chen and I. Elishakoff (*Bounds of eigenvalues for structures with an interval
/// description of uncertain-but-non-random parameters*, Chaos, Solitons & Fractals 7, 1996, 425), k = 1000 +- 10, 2000 +- 15, 3000 +- 20, 4000 +- 25 and
/// 5000 +- 30 N/m, m = 1 kg. With every entry of K independent, its eigenvalues range over [842.9251, 967.1082], [3337.0785, 3443.3127],
/// [7002.2828, 7126.8283] and [12560.8377, 12720.2273]: the last ones are reached by springs too, the others contain what springs reach, and
/// that is, by NumPy, what follows.
#[test]
fn eigenvalues_of_a_chain_with_interval_springs() {
    let springs = [(1000, 10), (2000, 15), (3000, 20), (4000, 25), (5000, 30)];
    let mut text = String::new();
    for (i, (k, reach)) in springs.iter().enumerate() {
        text += &format!("param k{i} = {k} N/m within {reach} N/m\n");
    }
    for i in 0..4 {
        text += &format!("body b{i} {{ mass = 1 kg, moves x }}\n");
    }
    for (i, ends) in ["ground -- b0", "b0 -- b1", "b1 -- b2", "b2 -- b3", "b3 -- ground"].iter().enumerate() {
        text += &format!("spring s{i}: {ends} {{ k = k{i} }}\n");
    }
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("m.vib"), text).expect("a file");
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_vibc"));
    let output =
        command.args(["analyze", "m.vib", "--tolerances", "--format", "json"]).current_dir(folder.path()).output();
    let found: serde_json::Value = serde_json::from_slice(&output.expect("it starts").stdout).expect("JSON");
    let square = |hertz: &serde_json::Value| (hertz.as_f64().expect("a number") * std::f64::consts::TAU).powi(2);
    let published = [(842.9251, 967.1082), (3337.0785, 3443.3127), (7002.2828, 7126.8283), (12560.8377, 12720.2273)];
    let by_springs = [
        (898.19899381, 912.12147262),
        (3364.85914406, 3414.83508056),
        (7016.10414693, 7112.81617449),
        (12560.8377152, 12720.22727233),
    ];
    for (row, (matrix, springs)) in
        found["tolerances"]["frequencies"].as_array().expect("modes").iter().zip(published.iter().zip(by_springs))
    {
        assert_eq!(row["proved"], true);
        let (low, high) = (square(&row["least_hz"]), square(&row["largest_hz"]));
        assert!((low - springs.0).abs() < 1e-6 && (high - springs.1).abs() < 1e-6, "{low} {high} {springs:?}");
        assert!(low > matrix.0 - 1e-4 && high < matrix.1 + 1e-4, "{low} {high} {matrix:?}");
    }
}

/// The example's ranges in closed form, with |H| over a grid of the whole box; its last requirement holds at the written values alone.
#[test]
fn a_series_of_machines_has_its_closed_forms() {
    let path = crate::documents::root().join("examples/machine_series.vib");
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_vibc"));
    let output = command.args(["analyze", "--tolerances", "--format", "json"]).arg(path).output().expect("it starts");
    let answer: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let found = &answer["tolerances"];
    let turn = std::f64::consts::TAU;
    let gain = |m: f64, k: f64, c: f64| {
        let w = 25.0 * turn;
        f64::hypot(k, c * w) / f64::hypot(k - m * w * w, c * w)
    };
    let along = |low: f64, high: f64| (0..=20).map(move |i| low + (high - low) * f64::from(i) / 20.0);
    let all = along(110.0, 140.0)
        .flat_map(|m| along(408e3, 552e3).flat_map(move |k| along(1.6e3, 2.4e3).map(move |c| (m, k, c))))
        .map(|(m, k, c)| gain(m, k, c));
    let [least, largest] = all.fold([f64::MAX, 0.0f64], |[low, high], x| [low.min(x), high.max(x)]);
    let rows = found["requirements"].as_array().expect("requirements");
    let near = |value: &serde_json::Value, truth: f64| {
        let value = value.as_f64().expect("a number");
        assert!((value - truth).abs() < 1e-12 * truth, "{value} {truth}");
    };
    near(&found["frequencies"][0]["least_hz"], f64::sqrt(408e3 / 140.0) / turn);
    near(&found["frequencies"][0]["largest_hz"], f64::sqrt(552e3 / 110.0) / turn);
    near(&found["damping_ratios"][0]["least"], 0.5 * 1600.0 / f64::sqrt(552e3 * 140.0));
    near(&found["damping_ratios"][0]["largest"], 0.5 * 2400.0 / f64::sqrt(408e3 * 110.0));
    near(&rows[3]["values"]["least"], least);
    near(&rows[3]["values"]["largest"], largest);
    let verdicts: Vec<&str> = rows.iter().map(|row| row["verdict"].as_str().expect("a verdict")).collect();
    assert_eq!(verdicts, ["holds", "holds", "holds", "fails"]);
    near(&rows[3]["at"]["m"], 110.0);
    assert!(found["requirements"][3]["values"]["proved"] == true && answer["requirements"][3]["holds"] == true);
}

/// Ranges that are only reached say why: the rest of a rod under gravity moves with its spring, and without gravity they are proved.
#[test]
fn the_report_says_why_ranges_are_not_proved() {
    let folder = tempfile::tempdir().expect("a folder");
    let printed = |text: &str| {
        std::fs::write(folder.path().join("m.vib"), text).expect("a file");
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_vibc"));
        let output =
            command.args(["analyze", "m.vib", "--tolerances", "--width", "200"]).current_dir(folder.path()).output();
        String::from_utf8(output.expect("it starts").stdout).expect("UTF-8")
    };
    let rod = "param k = 300 N/m within 5 %\nbody rod { mass = 2 kg, shape = rod((0, 0), (1 m, 0)) }\n\
               pivot p: ground@(0, 0) -- rod\nspring s: ground@(1 m, 1 m) -- rod@(1 m, 0) { k = k, along = y }\n";
    let (held, free) = (printed(&format!("gravity 9.81 m/s^2\n{rod}")), printed(rod));
    let moves =
        "ranges are about the rest that the declared rest becomes as these values move; a search may end in another";
    // The rod hangs so near to its drawing that no other rest can be found.
    assert!(!held.contains(moves) && !free.contains(moves), "{held}");
    for text in [&held, &free] {
        assert!(!text.contains("others are not excluded") && !text.contains("not proved:"), "{text}");
    }
    // A block between two slanted springs snaps through under 1 N.
    let snaps = |within: &str| {
        printed(&format!(
            "param m = 0.12 kg within {within}\ngravity 9.81 m/s^2\nbody b {{ mass = m, at = (0 m, 0.3 m), moves y }}\n\
             spring s: ground@(-1 m, 0 m) -- b {{ k = 100 N/m }}\nspring t: ground@(1 m, 0 m) -- b {{ k = 100 N/m }}\n"
        ))
    };
    let (both, below) = (snaps("0.09 kg .. 0.15 kg"), snaps("0.11 kg .. 0.15 kg"));
    let why = "what is only reached is not proved: for some of these values the model comes to rest elsewhere";
    assert!(both.contains("others are not excluded") && both.contains(why), "{both}");
    assert!(!below.contains("others are not excluded") && below.contains(moves), "{below}");
    // Measures that are never enclosed say so, each with its reason.
    let timed = printed(
        "param k = 300 N/m within 5 %\nbody b { mass = 2 kg, moves x }\nspring s: ground -- b { k = k }\n\
         damper d: ground -- b { c = 5 N*s/m }\nforce F: b along x = step(1 N, 0 s)\noutput x = b.x\n\
         require peak(x) < 1 m\nrequire settling(x, 2 %) < 9 s\nrequire overshoot(x) < 90 %\nrequire rms(x) < 1 m\n\
         require static(x) < 1 m\n",
    );
    for why in [
        "of peak(x) < 1 m is not proved: the largest of a motion in time is not enclosed over ranges",
        "of settling(x, 2 %) < 9 s is not proved: a settling time may jump from one swing to the next",
        "of overshoot(x) < 90 % is not proved: the overshoot of a motion in time is not enclosed over ranges",
        "of rms(x) < 1 m is not proved: mean squares are not enclosed over ranges",
    ] {
        assert_eq!(timed.matches(why).count(), 1, "{why} {timed}");
    }
    let lossy = printed(
        "param k = 300 N/m within 5 %\nbody b { mass = 2 kg, moves x }\nspring s: ground -- b { k = k, loss = 10 % }\n\
                         force F: b along x\noutput x = b.x\nrequire gain(F -> x, 1 Hz) < 1 m/N\n",
    );
    assert!(lossy.contains("is not proved: it has loss factors"), "{lossy}");
    let many: String = (0..31)
        .map(|i| {
            format!(
                "param k{i} = 1 N/m within 5 %\nspring s{i}: ground -- b {{ k = k{i} }}\ndamper d{i}: ground -- b {{ c = 0.01 N*s/m }}\n"
            )
        })
        .collect();
    let body =
        "body b { mass = 1 kg, moves x }\nforce F: b along x\noutput x = b.x\nrequire gain(F -> x, 1 Hz) < 1 m/N\n";
    let above = printed(&format!("{many}{body}"));
    assert!(above.contains("is not proved: more than 30 parameters have a range"), "{above}");
    // The frequency has a direction in each, whatever their number: sqrt(31 * 0.95) and sqrt(31 * 1.05) rad/s.
    assert!(above.contains("0.86370") && above.contains("0.90802"), "{above}");
    let chain = |n: usize| {
        let rows = (0..n).map(|i| {
            let before = if i == 0 { "ground".to_string() } else { format!("b{}", i - 1) };
            format!(
                "body b{i} {{ mass = 1 kg, moves x }}\nspring s{i}: {before} -- b{i} {{ k = k }}\n\
                 damper d{i}: {before} -- b{i} {{ c = 1 N*s/m }}\n"
            )
        });
        format!(
            "param k = 100 N/m within 1 %\n{}force F: b0 along x\noutput x = b0.x\nrequire gain(F -> x, 1 Hz) < 1 m/N\n",
            rows.collect::<String>()
        )
    };
    assert!(printed(&chain(31)).contains("is not proved: the model has more than 30 coordinates"));
    let modal = printed(
        "param k = 300 N/m within 5 %\ndamping modal 2 %\nbody b { mass = 2 kg, moves x }\nspring s: ground -- b { k = k }\n\
         force F: b along x\noutput x = b.x\nrequire gain(F -> x, 1 Hz) < 1 m/N\n",
    );
    assert!(modal.contains("is not proved: its damping is given by modes"), "{modal}");
}
