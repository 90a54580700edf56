//! Modes that `sweep --follow` follows, beside closed forms: veerings, crossings, what is not proved. See docs/method/studies.md#curves.

use serde_json::Value;
use std::f64::consts::PI;
use std::fs;
use std::process::{Command, Output};

/// Unit masses on springs k1 and k2, and one of kc between them.
const TWO: &str = "model two\nparam k1 = 1 N/m\nparam k2 = 1 N/m\nparam kc = 0.1 N/m\nbody a { mass = 1 kg, moves x }\n\
                   body b { mass = 1 kg, moves x }\nspring s1: ground -- a { k = k1 }\nspring s2: ground -- b { k = k2 }\n\
                   spring sc: a -- b { k = kc }\n";

/// The same without a spring between them, and another oscillator.
fn apart(k1: &str, k2: &str) -> String {
    format!(
        "model apart\nparam p = 1 N/m\nbody a {{ mass = 1 kg, moves x }}\nbody b {{ mass = 1 kg, moves x }}\n\
         spring s1: ground -- a {{ k = {k1} }}\nspring s2: ground -- b {{ k = {k2} }}\n"
    )
}

fn ran(model: &str, arguments: &[&str]) -> Output {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("m.vib"), model).expect("a file");
    let mut command = Command::new(env!("CARGO_BIN_EXE_vibc"));
    command.args(["sweep", "m.vib"]).args(arguments).current_dir(folder.path()).output().expect("the program starts")
}

fn study(model: &str, arguments: &[&str]) -> Value {
    let output = ran(model, &[arguments, &["--follow", "--format", "json"]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

/// What is told of pairs of curves: its kind, the numbers of the curves, and the object.
fn meetings(study: &Value) -> Vec<(&str, [usize; 2], &Value)> {
    let number = |name: &Value| name.as_str()?.strip_prefix("curve_")?.parse().ok();
    let list = study["following"]["meetings"].as_array().expect("meetings");
    let told = |one: &'_ Value| [0, 1].map(|i| number(&one["curves"][i]).expect("a curve"));
    list.iter().map(|one| (one["kind"].as_str().expect("a kind"), told(one), one)).collect()
}

/// The truth lies within the bound of what is told, up to its own rounding, and the bound is small.
fn meets(told: &Value, truth: f64, accuracy: f64) {
    let [value, bound] = [0, 1].map(|i| told[i].as_f64().expect("a number"));
    let allowed = bound + 8.0 * f64::EPSILON * truth.abs();
    assert!((value - truth).abs() <= allowed, "{value} ± {bound:e}, not {truth}");
    assert!(bound <= accuracy * truth.abs(), "{value} ± {bound:e}");
}

fn open_links(study: &Value) -> usize {
    let curves = study["following"]["curves"].as_array().expect("curves");
    curves.iter().map(|curve| curve["open_links"].as_array().expect("a list").len()).sum()
}

/// The curves in Hz, case by case.
fn curve(study: &Value, number: usize) -> Vec<f64> {
    let cases = study["cases"].as_array().expect("cases");
    cases.iter().map(|case| case["values"][2 * number - 1].as_f64().expect("a frequency")).collect()
}

/// The smallest distance of the *frequencies*, kc / sqrt(k2 + kc), at k1 = k2 + kc^2 / (k2 + kc); with the weakest springs and three or
/// two points, these show nothing of it.
#[test]
fn two_masses_veer_where_their_closed_form_does() {
    for (k2, kc, points) in [(1.0, 0.1, 11), (3.0, 0.5, 50), (1.0, 1e-4, 3), (0.7, 1e-6, 2)] {
        let set =
            [format!("k2={k2}N/m"), format!("kc={kc}N/m"), format!("k1={}N/m..{}N/m:{points}", 0.5 * k2, 2.0 * k2)];
        let study = study(TWO, &["--set", &set[0], "--set", &set[1], "--over", &set[2], "--modes", "2"]);
        assert_eq!(open_links(&study), 0, "{k2} {kc}");
        let [("veering", [1, 2], told)] = meetings(&study)[..] else { panic!("{study}") };
        // Half of the digits of a place where a distance is least are lost beside those of the distance.
        meets(&told["parameter"], k2 + kc * kc / (k2 + kc), 1e-7);
        meets(&told["distance_hz"], kc / f64::sqrt(k2 + kc) / (2.0 * PI), 1e-6);
    }
}

/// One damping ratio for all modes changes no undamped mode: the same curves, links and veerings.
#[test]
fn damping_by_modes_changes_no_curve() {
    let over = ["--over", "k1=0.5N/m..1.5N/m:41"];
    let [damped, undamped] = [format!("{TWO}damping modal 3 %\n"), TWO.to_string()].map(|model| study(&model, &over));
    assert_eq!(damped["following"], undamped["following"]);
    assert!([1, 2].into_iter().all(|number| curve(&damped, number) == curve(&undamped, number)));
}

/// Falling values are the same curves from the other end.
#[test]
fn curves_are_followed_downwards_too() {
    let study = study(TWO, &["--over", "k1=2N/m,1.5N/m,1.2N/m,0.8N/m,0.5N/m"]);
    let [("veering", _, told)] = meetings(&study)[..] else { panic!("{study}") };
    meets(&told["parameter"], 1.0 + 0.01 / 1.1, 1e-7);
    assert_eq!(open_links(&study), 0);
}

/// Uncoupled oscillators cross where their stiffnesses are equal, also at one of the points, and keep their identity.
#[test]
fn uncoupled_oscillators_cross() {
    for points in [10, 11, 2] {
        let over = format!("p=0.5N/m..1.5N/m:{points}");
        let study = study(&apart("p", "1 N/m"), &["--over", &over]);
        let [("crossing", [1, 2], told)] = meetings(&study)[..] else { panic!("{study}") };
        meets(&told["parameter"], 1.0, 1e-12);
        meets(&told["frequency_hz"], 1.0 / (2.0 * PI), 1e-12);
        assert_eq!(open_links(&study), 0);
        for (i, (moved, still)) in curve(&study, 1).into_iter().zip(curve(&study, 2)).enumerate() {
            let k = 0.5 + i as f64 / f64::from(points - 1);
            assert!((moved - k.sqrt() / (2.0 * PI)).abs() < 1e-15, "{moved} {k}");
            assert!((still - 1.0 / (2.0 * PI)).abs() < 1e-15, "{still}");
        }
    }
}

/// p = p^2 / (1 N/m) + 0.2 N/m twice between two points; p + 1e-3 N/m never is p.
#[test]
fn crossings_between_two_points_are_found() {
    let first = study(&apart("p", "p * p / (1 N/m) + 0.2 N/m"), &["--over", "p=0.1N/m..1N/m:2"]);
    let [("crossing", _, low), ("crossing", _, high)] = meetings(&first)[..] else { panic!("{first}") };
    meets(&low["parameter"], (1.0 - f64::sqrt(0.2)) / 2.0, 1e-12);
    meets(&high["parameter"], (1.0 + f64::sqrt(0.2)) / 2.0, 1e-12);
    let near = study(&apart("p", "p + 1e-3 N/m"), &["--over", "p=0.1N/m..1N/m:20"]);
    assert_eq!(meetings(&near), []);
}

/// Equal oscillators cannot be told apart: nothing is claimed.
#[test]
fn equal_curves_are_not_decided() {
    let study = study(&apart("p", "p"), &["--over", "p=0.5N/m..1.5N/m:5"]);
    let [("undecided", [1, 2], _)] = meetings(&study)[..] else { panic!("{study}") };
}

/// A third oscillator that nothing couples to the other two crosses the upper of their curves, where its 1.5 is an eigenvalue of
/// [[k1 + 0.1, -0.1], [-0.1, 1.1]].
#[test]
fn a_block_crosses_the_veering_curves_of_another() {
    let model = format!("{TWO}body c {{ mass = 1 kg, moves x }}\nspring s3: ground -- c {{ k = 1.5 N/m }}\n");
    let study = study(&model, &["--over", "k1=0.5N/m..2N/m:11"]);
    let [("veering", [1, 2], near), ("crossing", [2, 3], told)] = meetings(&study)[..] else { panic!("{study}") };
    meets(&near["distance_hz"], 0.1 / f64::sqrt(1.1) / (2.0 * PI), 1e-6);
    // (k1 + 0.1 - 1.5) (1.1 - 1.5) = 0.01
    meets(&told["parameter"], 1.4 - 0.01 / 0.4, 1e-12);
    meets(&told["frequency_hz"], f64::sqrt(1.5) / (2.0 * PI), 1e-12);
    assert_eq!(study["following"]["curves"][2]["block"], 2);
}

/// Outer masses with equal springs: their motion against each other has 2 + 2 kc, which is 2 + sqrt(2) of the others at
/// kc = 1 / sqrt(2). That is a crossing, but one of a symmetry: it is neither called a crossing nor a veering, and the links of the
/// step are not proved.
#[test]
fn a_crossing_within_a_block_is_not_proved() {
    let model = "model mirror\nparam kc = 1 N/m\nbody a { mass = 1 kg, moves x }\nbody b { mass = 1 kg, moves x }\n\
                 body c { mass = 1 kg, moves x }\nspring s1: ground -- a { k = 1 N/m }\nspring s2: ground -- c { k = 1 N/m }\n\
                 spring s3: a -- b { k = 1 N/m }\nspring s4: b -- c { k = 1 N/m }\nspring s5: a -- c { k = kc }\n";
    let study = study(model, &["--over", "kc=0.5N/m..2N/m:11"]);
    let [("undecided", [2, 3], told)] = meetings(&study)[..] else { panic!("{study}") };
    meets(&told["parameter"], f64::sqrt(0.5), 1e-12);
    assert_eq!(open_links(&study), 2);
    let cases = study["cases"].as_array().expect("cases");
    let linked = |column: usize| cases.iter().map(|case| case["values"][column].clone()).collect::<Vec<Value>>();
    assert_eq!(linked(2)[..3], [Value::Null, true.into(), true.into()]);
    assert_eq!(linked(4)[..4], [Value::Null, true.into(), false.into(), true.into()]);
}

/// Two rods of the length L with a spring between them, and a block between them on two more. Against each other the rods have
/// 14.715/L + 60/L^2, and the block makes that of both together: the pair of squares with the sum 110 + a, a = 14.715/L + 10/L^2, and the
/// product 110 a - 800/L^2. One of them meets the first where 126 L^2 = 14.715 L + 60, inside a step, whose bounds are those of the pieces
/// of the line.
#[test]
fn a_crossing_along_a_length_is_not_proved() {
    let model = "model rods\nparam L = 1 m\ngravity 9.81 m/s^2\nbody c { mass = 1 kg, at = (0, -0.5 m), moves x }\n\
                 body a { mass = 3 kg, shape = rod((-0.5 m, 0), (-0.5 m, -L)) }\npivot p: ground@(-0.5 m, 0) -- a\n\
                 body b { mass = 3 kg, shape = rod((0.5 m, 0), (0.5 m, -L)) }\npivot q: ground@(0.5 m, 0) -- b\n\
                 spring s: a@(-0.5 m, -0.5 m) -- c { k = 40 N/m }\nspring t: b@(0.5 m, -0.5 m) -- c { k = 40 N/m }\n\
                 spring u: a@(-0.5 m, -0.5 m) -- b@(0.5 m, -0.5 m) { k = 100 N/m }\n\
                 spring v: ground@(-1 m, -0.5 m) -- c { k = 30 N/m }\n";
    let meeting = (14.715 + f64::sqrt(14.715 * 14.715 + 4.0 * 126.0 * 60.0)) / 252.0;
    for range in ["L=0.6m..1m:20", "L=0.55m..1.2m:40"] {
        let study = study(model, &["--over", range, "--modes", "3"]);
        let undecided: Vec<_> = meetings(&study).into_iter().filter(|(kind, ..)| *kind == "undecided").collect();
        let [(_, [2, 3], told)] = undecided[..] else { panic!("{study}") };
        meets(&told["parameter"], meeting, 1e-7);
        assert_eq!(open_links(&study), 2, "{range}");
    }
}

/// The rods of the test above with all springs at their lower ends, whose displacements have the squares g + 40 + 90 against each other, g = 14.715/L, and
/// those of 40 + g and 110 with a coupling of 3200 together with the block. One of these meets the first where g = 70 - 4900/90. Lengths
/// stand in the rows, and nine values make no line: bounds over a step are those of polynomials for it alone.
#[test]
fn a_crossing_where_rows_change_is_not_proved() {
    let model = "model rods\nparam L = 1 m\ngravity 9.81 m/s^2\nbody c { mass = 1 kg, at = (0, -L), moves x }\n\
                 body a { mass = 3 kg, shape = rod((-0.5 m, 0), (-0.5 m, -L)) }\npivot p: ground@(-0.5 m, 0) -- a\n\
                 body b { mass = 3 kg, shape = rod((0.5 m, 0), (0.5 m, -L)) }\npivot q: ground@(0.5 m, 0) -- b\n\
                 spring s: a@(-0.5 m, -L) -- c { k = 40 N/m }\nspring t: b@(0.5 m, -L) -- c { k = 40 N/m }\n\
                 spring u: a@(-0.5 m, -L) -- b@(0.5 m, -L) { k = 45 N/m }\n\
                 spring v: ground@(-1 m, -L) -- c { k = 30 N/m }\n";
    let study = study(model, &["--over", "L=0.6m..1m:9", "--modes", "3"]);
    let undecided: Vec<_> = meetings(&study).into_iter().filter(|(kind, ..)| *kind == "undecided").collect();
    let [(_, [2, 3], told)] = undecided[..] else { panic!("{study}") };
    meets(&told["parameter"], 14.715 / (70.0 - 4900.0 / 90.0), 1e-7);
    // From 0.9 to 0.95 m; the curves are near each other at the beginning of the next step, too.
    for number in [1, 2] {
        let open = &study["following"]["curves"][number]["open_links"];
        assert!(*open == serde_json::json!([7]) || *open == serde_json::json!([7, 8]), "{open}");
    }
}

/// Where a parameter moves all eigenvalues in one direction, the frequencies at both ends of a step are its bounds, and the cases are computed
/// side by side; a tolerance that these do not meet computes them one by one. Both are the closed form's, with the same links, for a
/// stiffness, a mass, and values that descend: squares of omega are the roots of x^2 - (a + b) x + a b - kc^2 / m.
#[test]
fn curves_are_the_same_side_by_side() {
    let model = "model two\nparam k = 1 N/m\nparam m = 1 kg\nbody a { mass = m, moves x }\nbody b { mass = 1 kg, moves x }\n\
                 spring s1: ground -- a { k = k }\nspring s2: ground -- b { k = 1 N/m }\nspring sc: a -- b { k = 0.1 N/m }\n";
    for (name, unit, first, last) in [("k", "N/m", 0.5, 2.0), ("m", "kg", 0.5, 2.0), ("k", "N/m", 2.0, 0.5)] {
        let over = match first < last {
            true => format!("{name}={first}{unit}..{last}{unit}:40"),
            false => format!(
                "{name}={}",
                (0..40).map(|i| format!("{}{unit}", 2.0 - 1.5 / 39.0 * f64::from(i))).collect::<Vec<_>>().join(",")
            ),
        };
        let [quick, single] = [&[][..], &["--tolerance", "1e-17"]].map(|more| {
            let study = study(model, &[&["--over", &over, "--modes", "2"], more].concat());
            assert_eq!(open_links(&study), 0, "{over}");
            study
        });
        let [one, other] = [&quick, &single].map(|study| meetings(study));
        assert_eq!(one.len(), other.len(), "{over}");
        assert!(one.iter().all(|(kind, ..)| *kind == "veering"), "{over}");
        for number in [1, 2] {
            for (i, (a, b)) in curve(&quick, number).into_iter().zip(curve(&single, number)).enumerate() {
                let at = first + (last - first) / 39.0 * i as f64;
                let (k, m) = if name == "k" { (at, 1.0) } else { (1.0, at) };
                let (p, q) = ((k + 0.1) / m, 1.1);
                let root = f64::hypot(p - q, 0.2 / f64::sqrt(m));
                let truth = f64::sqrt(0.5 * (p + q + if number == 1 { -root } else { root })) / (2.0 * PI);
                assert!((a - truth).abs() < 1e-14 && (b - truth).abs() < 1e-14, "{over} {i}: {a} {b} {truth}");
            }
        }
    }
}

/// The double pendulum of the examples, drawn away from its rest: (2 -+ sqrt 2) g / l. With a spring at its upper joint the rest moves with
/// the length, too.
#[test]
fn curves_about_a_rest_that_moves_are_linked() {
    let pendulum = std::fs::read_to_string("examples/double_pendulum.vib").expect("an example");
    let over = ["--over", "l=1m..3m:20", "--modes", "2"];
    let plain = study(&pendulum, &over);
    assert_eq!((open_links(&plain), meetings(&plain).len()), (0, 0));
    for (number, sign) in [(1, -1.0), (2, 1.0)] {
        for (i, found) in curve(&plain, number).into_iter().enumerate() {
            let l = 1.0 + 2.0 / 19.0 * i as f64;
            let truth = f64::sqrt((2.0 + sign * f64::sqrt(2.0)) * 9.81 / l) / (2.0 * PI);
            assert!((found - truth).abs() < 1e-14, "{number} {i} {found} {truth}");
        }
    }
    let held = study(&format!("{pendulum}\nspring s: ground -- upper {{ k = 5 N*m/rad }}\n"), &over);
    assert_eq!((open_links(&held), meetings(&held).len()), (0, 0));
}

/// A block between two slanted springs, which snaps through between 0.1 and 0.105 kg: its frequency jumps, so that this link is not proved,
/// though there is no other curve.
#[test]
fn a_rest_that_snaps_through_breaks_the_link() {
    let study = study(
        "model truss\nparam m = 0.12 kg\ngravity 9.81 m/s^2\nbody b { mass = m, at = (0 m, 0.3 m), moves y }\n\
         spring s: ground@(-1 m, 0 m) -- b { k = 100 N/m }\nspring t: ground@(1 m, 0 m) -- b { k = 100 N/m }\n",
        &["--over", "m=0.08kg..0.14kg:13", "--modes", "1"],
    );
    let open = &study["following"]["curves"][0]["open_links"];
    assert_eq!(*open, serde_json::json!([5]), "{}", study["following"]);
}

/// A stiffness of 1 + 100 (p - 1/2)^2 N/m comes to that of the other spring at p = 1/2 alone, between two of 16 points with the same
/// frequencies: no direction, and the curves nearly meet within the step.
#[test]
fn curves_that_turn_round_within_a_step_are_not_lost() {
    let model = TWO
        .replace("param k1 = 1 N/m", "param p = 1")
        .replace("k = k1", "k = 1 N/m + (p - 0.5)^2 * 100 N/m")
        .replace("kc = 0.1", "kc = 0.001");
    let study = study(&model, &["--over", "p=0..1:16", "--modes", "2"]);
    let inside = |(_, _, told): &(&str, [usize; 2], &Value)| {
        let at = told["parameter"][0].as_f64().expect("a number");
        let distance = told["distance_hz"][0].as_f64().unwrap_or(0.0);
        (7.0 / 15.0..8.0 / 15.0).contains(&at) && distance < 1.1e-3 / (2.0 * PI)
    };
    assert!(meetings(&study).iter().any(inside), "{study}");
    // Three masses whose second and third curves cross for kc = 1 / sqrt(2) N/m, twice in the step: no proof that they do not.
    let mirror = "model mirror\nparam p = 1\nbody a { mass = 1 kg, moves x }\nbody b { mass = 1 kg, moves x }\n\
                  body c { mass = 1 kg, moves x }\nspring s1: ground -- a { k = 1 N/m }\nspring s2: ground -- c { k = 1 N/m }\n\
                  spring s3: a -- b { k = 1 N/m }\nspring s4: b -- c { k = 1 N/m }\n\
                  spring s5: a -- c { k = 0.7 N/m + (p - 0.5)^2 * 100 N/m }\n";
    let study = self::study(mirror, &["--over", "p=0..1:16", "--modes", "3"]);
    let curves = study["following"]["curves"].as_array().expect("curves");
    let open = |curve: &Value| curve["open_links"].as_array().expect("a list").len();
    assert!(open(&curves[1]) == 1 && open(&curves[2]) == 1, "{study}");
}

/// Two coupled pendulums, one of which becomes longer (C. Pierre, Journal of Sound and Vibration 126 (1988) 485-502, with weak coupling):
/// point masses of 1 kg, 1 m and l below their pivots, and a spring of 0.1 N/m between points h = 0.5 m below these. With
/// M = diag(1, l^2) and K = diag(g + k h^2, g l + k h^2), beside the diagonal -k h^2, the loci veer. A length moves rows of both
/// matrices; every link is proved.
#[test]
fn pendulums_of_other_lengths_veer() {
    let model = "model pendulums\nparam l = 1 m\ngravity 9.81 m/s^2\n\
                 body a { mass = 1 kg, inertia = 0 kg*m^2, at = (0, -1 m) }\n\
                 body b { mass = 1 kg, inertia = 0 kg*m^2, at = (1 m, 0 - l) }\n\
                 pivot p: ground@(0, 0) -- a\npivot q: ground@(1 m, 0) -- b\n\
                 spring s: a@(0, -0.5 m) -- b@(1 m, -0.5 m) { k = 0.1 N/m }\n";
    let study = study(model, &["--over", "l=0.9m..1.1m:9"]);
    let frequencies = |l: f64| {
        let (kh, m) = (0.1 * 0.25, l * l);
        // x^2 - (a + b) x + c = 0 for K and M divided by the masses.
        let (a, b) = (9.81 + kh, (9.81 * l + kh) / m);
        let root = ((a - b).powi(2) + 4.0 * kh * kh / m).sqrt();
        [0.5 * (a + b - root), 0.5 * (a + b + root)].map(|square| square.sqrt() / (2.0 * PI))
    };
    for (i, case) in study["cases"].as_array().expect("cases").iter().enumerate() {
        for (curve, truth) in frequencies(0.9 + 0.025 * i as f64).into_iter().enumerate() {
            let told = case["values"][1 + 2 * curve].as_f64().expect("a frequency");
            assert!((told - truth).abs() < 1e-12 * truth, "{case}");
        }
    }
    // root / (omega_1 + omega_2) / 2 pi, in which nothing cancels; its least value by the golden section.
    let distance = |l: f64| {
        let (kh, m) = (0.1 * 0.25, l * l);
        let (a, b) = (9.81 + kh, (9.81 * l + kh) / m);
        ((a - b).powi(2) + 4.0 * kh * kh / m).sqrt() / frequencies(l).iter().sum::<f64>() / (4.0 * PI * PI)
    };
    let [mut low, mut high] = [0.9, 1.1];
    for _ in 0..60 {
        let [first, second] = [0.382, 0.618].map(|part| low + part * (high - low));
        if distance(first) < distance(second) { high = second } else { low = first }
    }
    let least = distance(0.5 * (low + high));
    let [("veering", [1, 2], told)] = meetings(&study)[..] else { panic!("{}", study["following"]) };
    meets(&told["distance_hz"], least, 1e-10);
    assert_eq!(open_links(&study), 0, "{}", study["following"]);
}

/// Two masses whose dampers feed energy in and take it: by Routh's criterion both poles of a pair pass the imaginary axis where
/// p c K = kc^2, K = k + kc being the diagonal of the stiffness matrix.
#[test]
fn a_flutter_begins_where_routh_has_it() {
    let model = format!(
        "{TWO}param p = 0.01 N*s/m\ndamper d1: ground -- a {{ c = -p }}\ndamper d2: ground -- b {{ c = 0.5 N*s/m }}\n"
    );
    let study = study(&model, &["--over", "p=0.001N*s/m..0.1N*s/m:10", "--poles"]);
    let onsets = study["following"]["onsets"].as_array().expect("onsets");
    let [onset] = &onsets[..] else { panic!("{onsets:?}") };
    assert_eq!((&onset["of"], &onset["proved"]), (&"poles".into(), &true.into()));
    assert_eq!(onset["growing"], serde_json::json!([0, 2]));
    meets(&onset["parameter"], 0.01 / (0.5 * 1.1), 1e-12);
}

/// det K = 0 at k1 = -k2 kc / (k2 + kc), for modes and for poles; one of two values may be the place itself.
#[test]
fn a_divergence_ends_where_the_determinant_is_zero() {
    for (over, poles) in [("k1=-1N/m..1N/m:8", false), ("k1=-1N/m..1N/m:8", true), ("k1=-0.9N/m,-0.05N/m", false)] {
        let damped = format!("{TWO}damper d: ground -- b {{ c = 0.5 N*s/m }}\n");
        let arguments = if poles { vec!["--over", over, "--poles"] } else { vec!["--over", over] };
        let study = study(&damped, &arguments);
        let onsets = study["following"]["onsets"].as_array().expect("onsets");
        let [onset] = &onsets[..] else { panic!("{onsets:?}") };
        assert_eq!(onset["growing"], serde_json::json!([1, 0]), "{onset}");
        assert_eq!(onset["proved"], true);
        meets(&onset["parameter"], -0.1 / 1.1, 1e-12);
        // The lowest curve has no frequency before.
        assert!(study["cases"][0]["values"][1].is_null());
    }
}

/// Both modes of two uncoupled masses diverge, one after the other, between two values: p < 0 and p < 1 N/m.
#[test]
fn two_onsets_between_two_values_are_two() {
    let study = study(&apart("p", "p - 1 N/m"), &["--over", "p=-1N/m,3N/m"]);
    let onsets = study["following"]["onsets"].as_array().expect("onsets");
    let growing: Vec<&Value> = onsets.iter().map(|onset| &onset["growing"]).collect();
    assert_eq!(growing, [&serde_json::json!([2, 1]), &serde_json::json!([1, 0])]);
    meets(&onsets[1]["parameter"], 1.0, 1e-12);
}

/// Springs that grow with the square of the rate, omega^2 = k/m + a Omega^2 (Southwell): the order n has that frequency at
/// Omega = sqrt(k / (m (n^2 - a))). Two such masses that nothing couples, k = 100 and 400 N/m, never meet.
#[test]
fn orders_meet_curves_at_critical_rates() {
    for (unit, per_second, square) in [("rpm", 30.0 / PI, "w * w"), ("rad/s", 1.0, "w^2")] {
        let blade = |k: &str| format!("{k} + 0.5 kg * {square}");
        let model = apart(&blade("100 N/m"), &blade("400 N/m")).replace("p = 1 N/m", "w = 60 rpm");
        let over = format!("w=0{unit}..{}{unit}:31", 40.0 * per_second);
        let study = study(&model, &["--over", &over, "--orders", "1,3"]);
        let critical = study["following"]["critical"].as_array().expect("critical rates");
        let expected = [(1, 1, 100.0), (1, 2, 400.0), (3, 1, 100.0), (3, 2, 400.0)];
        assert_eq!(critical.len(), expected.len(), "{critical:?}");
        for (told, (order, curve, k)) in critical.iter().zip(expected) {
            assert_eq!((&told["order"], &told["curve"]), (&order.into(), &format!("curve_{curve}").into()));
            let n = f64::from(order);
            let rate = f64::sqrt(k / (n * n - 0.5));
            // The parameter's own unit is rpm, whatever the values are written in.
            meets(&told["parameter"], rate * 30.0 / PI, 1e-12);
            meets(&told["frequency_hz"], n * rate / (2.0 * PI), 1e-12);
        }
        assert_eq!(open_links(&study), 0, "from a rate of zero on");
        assert!(meetings(&study).is_empty());
    }
}

/// The picture has a line for each curve and each order, and the mark of the veering in its place.
#[test]
fn the_picture_has_curves_and_marks() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("m.vib"), TWO).expect("a file");
    let mut command = Command::new(env!("CARGO_BIN_EXE_vibc"));
    let over = ["--over", "k1=0.5N/m..2N/m:21", "--follow", "--svg", "p.svg"];
    let output = command.args(["sweep", "m.vib"]).args(over).current_dir(folder.path()).output().expect("a run");
    assert!(output.status.success());
    let picture = fs::read_to_string(folder.path().join("p.svg")).expect("a picture");
    insta::assert_snapshot!(picture);
}

/// The pole in these columns of each case, and whether its link is proved.
fn locus(study: &Value, name: &str) -> Vec<(f64, f64, Value)> {
    let columns = study["columns"].as_array().expect("columns");
    let place = columns.iter().position(|column| column["name"] == format!("{name}_re")).expect("a column");
    assert_eq!(columns[place + 2]["name"], format!("{name}_linked"));
    let cases = study["cases"].as_array().expect("cases");
    let number = |case: &Value, at: usize| case["values"][at].as_f64().expect("a number");
    cases.iter().map(|case| (number(case, place), number(case, place + 1), case["values"][place + 2].clone())).collect()
}

/// Two damped masses that nothing couples: each pole is -c/2 +- i sqrt(k - c^2 / 4) of its own mass in every case, though that of the
/// moving one is below the other in |s| at first and above it in the end.
#[test]
fn poles_keep_their_identity() {
    let model = format!(
        "{}damper d1: ground -- a {{ c = 0.2 N*s/m }}\ndamper d2: ground -- b {{ c = 0.4 N*s/m }}\n",
        apart("p", "1 N/m")
    );
    // With two values the nearest pole of the next case is that of the other mass.
    for points in [10, 3, 2] {
        let study = study(&model, &["--over", &format!("p=0.5N/m..2N/m:{points}"), "--poles"]);
        assert_eq!(study["following"]["loci"].as_array().map(Vec::len), Some(4));
        for (name, c, side) in
            [("pole_1", 0.2, -1.0), ("pole_2", 0.2, 1.0), ("pole_3", 0.4, -1.0), ("pole_4", 0.4, 1.0)]
        {
            for (i, (re, im, linked)) in locus(&study, name).into_iter().enumerate() {
                let k = if c == 0.2 { 0.5 + 1.5 * i as f64 / f64::from(points - 1) } else { 1.0 };
                let truth = (-c / 2.0, side * f64::sqrt(k - c * c / 4.0));
                assert!(
                    (re - truth.0).abs() < 1e-14 && (im - truth.1).abs() < 1e-14,
                    "{name} {i}: {re} {im} {truth:?}"
                );
                assert_eq!(linked, if i == 0 { Value::Null } else { true.into() }, "{name} {i}");
            }
        }
    }
}

/// Masses on p and p + 1 N/m with steps of 1 N/m: each pole of the first arrives where one of the second began, in whose small
/// surroundings there is never more than one pole.
#[test]
fn a_pole_is_not_taken_for_one_that_arrives_in_its_place() {
    let model = format!(
        "{}damper d1: ground -- a {{ c = 0.2 N*s/m }}\ndamper d2: ground -- b {{ c = 0.2 N*s/m }}\n",
        apart("p", "p + 1 N/m")
    );
    let study = study(&model, &["--over", "p=1N/m..5N/m:5", "--poles"]);
    for (name, added, side) in
        [("pole_1", 0.0, -1.0), ("pole_2", 0.0, 1.0), ("pole_3", 1.0, -1.0), ("pole_4", 1.0, 1.0)]
    {
        for (i, (re, im, linked)) in locus(&study, name).into_iter().enumerate() {
            let truth = side * f64::sqrt(1.0 + i as f64 + added - 0.01);
            assert!((re + 0.1).abs() < 1e-14 && (im - truth).abs() < 1e-14, "{name} {i}: {re} {im} {truth}");
            assert_eq!(linked, if i == 0 { Value::Null } else { true.into() }, "{name} {i}");
        }
    }
}

/// Both poles of an oscillator meet at its critical damping, 2 N s/m, between the seventh and the eighth of 14 values: there alone
/// the link is not proved.
#[test]
fn poles_that_meet_are_not_linked() {
    let model = "model one\nparam c = 1 N*s/m\nbody b { mass = 1 kg, moves x }\nspring s: ground -- b { k = 1 N/m }\n\
                 damper d: ground -- b { c = c }\n";
    let study = study(model, &["--over", "c=0.1N*s/m..4N*s/m:14", "--poles"]);
    for name in ["pole_1", "pole_2"] {
        let open: Vec<usize> = (1..14).filter(|&i| locus(&study, name)[i].2 == false).collect();
        assert_eq!(open, [7], "{name}");
    }
    assert_eq!(study["following"]["loci"][0]["open_links"], serde_json::json!([7]));
}

#[test]
fn what_is_not_followed_is_refused_with_one_message() {
    let solved = format!("{TWO}solve kc in 0.01 N/m .. 1 N/m: frequency(1) = 0.15 Hz\n");
    let random = TWO.replace("param k1 = 1 N/m", "param k1 = 1 N/m within 5 %");
    let over = "k1=1N/m..2N/m:3";
    let cases: [(&str, &[&str], &str); 7] = [
        (TWO, &["--over", over, "--orders", "1"], "multiples of a rate of rotation"),
        (&random, &["--samples", "10"], "`--samples` are random"),
        (TWO, &["--over", over, "--over", "k2=1N/m,2N/m"], "give one `--over`"),
        (TWO, &["--over", over, "--shard", "0/2", "-o", "part", "--format", "csv"], "leave `--shard` out"),
        (TWO, &["--over", "k1=1N/m,3N/m,2N/m"], "in ascending or descending order"),
        (TWO, &["--over", "k1=1N/m..2N/m:10001"], "at most 10000 values"),
        (&solved, &["--over", over], "add `--hold-solved`"),
    ];
    for (model, arguments, message) in cases {
        let output = ran(model, &[arguments, &["--follow"]].concat());
        let text = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{text}");
        assert!(text.contains(message) && text.matches("error").count() == 1, "{text}");
        assert!(output.stdout.is_empty());
    }
}

#[test]
fn the_text_tells_links_veerings_and_crossings() {
    let model = format!("{TWO}body c {{ mass = 1 kg, moves x }}\nspring s3: ground -- c {{ k = 1.5 N/m }}\n");
    let output = ran(&model, &["--over", "k1=0.5N/m..2N/m:11", "--follow"]);
    insta::assert_snapshot!(String::from_utf8(output.stdout).expect("UTF-8"));
}
