//! Springs and dampers with laws: rests, tangents, geometric stiffness and damping beside closed forms and beside the
//! derivatives of their energies, tables beside SciPy's monotone cubic, the distance between law and tangent in a motion, and
//! what is refused. See spec.md#springs-and-dampers and docs/method/rest.md#laws.

use crate::program::{code, json, ran};
use serde_json::Value;
use std::f64::consts::TAU;
use vibc::{ModalAnswer, Number, Overrides, SourceFile, Sources};

fn analyzed(model: &str) -> ModalAnswer {
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model("m.vib", model));
    let outcome = vibc::analyze(&sources, file, &Overrides::default());
    let shown = vibc::diagnostics_short(&sources, &outcome.diagnostics);
    outcome.answer.unwrap_or_else(|| panic!("{model}\n{shown}"))
}

/// omega of each mode, rad/s, once its bound is seen to be small.
fn omegas(answer: &ModalAnswer) -> Vec<f64> {
    assert!(answer.rest.is_proven());
    let of = |mode: &vibc::Mode| {
        assert!(mode.omega.rad <= 1e-13 * mode.omega.to_f64().abs(), "{:?}", mode.omega);
        mode.omega.to_f64()
    };
    answer.modes.list.iter().map(of).collect()
}

fn near(found: f64, truth: f64, share: f64) {
    assert!((found - truth).abs() <= share * truth.abs(), "{found:e}, not {truth:e}");
}

/// The root of an ascending function, by bisection.
fn root(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if f(middle) > 0.0 { high = middle } else { low = middle }
    }
    0.5 * (low + high)
}

/// m g = k1 e + k3 e^3 at e = 1 cm: 0.3 N. The tangent is k1 + 3 k3 e^2 = 70 N/m.
#[test]
fn a_stiffening_spring_rests_and_swings_by_its_tangent() {
    let answer = analyzed(
        "gravity 10 m/s^2\nbody b { mass = 30 g, moves y }\n\
         spring s: ground -- b { law = 10 N/m * stretch + 2e5 N/m^3 * stretch^3 }",
    );
    assert_eq!(answer.rest.displacement, [-&Number::from("0.01")], "an exact rest");
    let law = &answer.rest.laws[0];
    assert_eq!((&law.force, &law.slope), (&-&Number::from("0.3"), &Number::from(70)));
    near(omegas(&answer)[0], (70.0_f64 / 0.03).sqrt(), 1e-15);
}

/// Laws of every function beside the same equilibrium by bisection and derivatives by hand.
#[test]
fn a_rest_and_its_tangent_hold_for_every_function() {
    type Law = (&'static str, fn(f64) -> f64, fn(f64) -> f64);
    let laws: [Law; 7] = [
        ("50 N * sinh", |e| 50.0 * (e / 0.1).sinh(), |e| 500.0 * (e / 0.1).cosh()),
        ("100 N * atan(stretch / 5 cm)", |e| 100.0 * (e / 0.05).atan(), |e| 2000.0 / (1.0 + (e / 0.05).powi(2))),
        ("100 N * tan(stretch / 1 m * 3)", |e| 100.0 * (3.0 * e).tan(), |e| 300.0 / (3.0 * e).cos().powi(2)),
        (
            "1 kN/m * stretch * sqrt(1 + (stretch / 1 cm)^2)",
            |e| 1e3 * e * (1.0 + 1e4 * e * e).sqrt(),
            |e| 1e3 * (1.0 + 2e4 * e * e) / (1.0 + 1e4 * e * e).sqrt(),
        ),
        ("1 kN/m * stretch * abs(stretch) / 1 cm", |e| 1e5 * e * e.abs(), |e| 2e5 * e.abs()),
        (
            "max(1 kN/m * stretch, 3 kN/m * stretch - 8 N)",
            |e| (1e3 * e).max(3e3 * e - 8.0),
            |e| {
                if e > 4e-3 { 3e3 } else { 1e3 }
            },
        ),
        ("-100 N * ln(1 - stretch / 10 cm)", |e| -100.0 * (1.0 - 10.0 * e).ln(), |e| 1000.0 / (1.0 - 10.0 * e)),
    ];
    for (law, force, slope) in laws {
        let law = match law {
            "50 N * sinh" => "25 N * (exp(stretch / 10 cm) - exp(-stretch / 10 cm))",
            other => other,
        };
        let answer = analyzed(&format!(
            "body b {{ mass = 2 kg, moves x }}\nspring s: ground -- b {{ law = {law} }}\nforce F: b along x = constant(20 N)"
        ));
        let e = root(|e| force(e) - 20.0, 0.0, 0.09);
        near(answer.rest.displacement[0].to_f64(), e, 1e-13);
        near(omegas(&answer)[0], (slope(e) / 2.0).sqrt(), 1e-12);
    }
}

/// A mass that hangs on a spring along its line: vertically its tangent, sideways the tension over the length.
#[test]
fn the_tension_of_a_law_stiffens_across_its_line() {
    let answer = analyzed(
        "gravity 10 m/s^2\nbody b { mass = 3 kg, at = (0, 0), moves x y }\n\
         spring s: ground@(0, 1 m) -- b { law = 100 N/m * stretch + 2 kN/m^3 * stretch^3, free_length = 0.9 m }",
    );
    let e = root(|e| 100.0 * e + 2e3 * e.powi(3) - 30.0, 0.0, 1.0);
    let along = ((100.0 + 6e3 * e * e) / 3.0).sqrt();
    let across = (30.0 / (0.9 + e) / 3.0).sqrt();
    let found = omegas(&answer);
    near(found[0], across.min(along), 1e-13);
    near(found[1], along.max(across), 1e-13);
    near(answer.rest.displacement[1].to_f64(), -(e - 0.1), 1e-12);
}

/// Second differences of the energy of a truss of two laws, computed here, at the rest that was found.
#[test]
fn stiffness_is_the_second_derivative_of_the_energy() {
    let answer = analyzed(
        "body b { mass = 1 kg, at = (0, 0), moves x y }\n\
         spring s: ground@(-1 m, 1 m) -- b { law = 40 N * (exp(stretch / 1 m) - 1), free_length = 1 m }\n\
         spring t: ground@(2 m, 1 m) -- b { law = 30 N/m * stretch + 20 N/m^3 * stretch^3, free_length = 2 m }\n\
         gravity 9.81 m/s^2",
    );
    let energy = |x: f64, y: f64| {
        let a = (x + 1.0).hypot(y - 1.0) - 1.0;
        let b = (x - 2.0).hypot(y - 1.0) - 2.0;
        40.0 * (a.exp() - a) + 15.0 * b * b + 5.0 * b.powi(4) + 9.81 * y
    };
    let [x, y] = [0, 1].map(|i| answer.rest.displacement[i].to_f64());
    // Fourth-order differences: the error is h^4 times sixth derivatives of the size 1e2, and eps V / h^2, below 1e-6.
    let h = 1e-3;
    let slope = |f: &dyn Fn(f64) -> f64| (8.0 * (f(h) - f(-h)) - f(2.0 * h) + f(-2.0 * h)) / (12.0 * h);
    assert!(slope(&|d| energy(x + d, y)).abs() < 1e-8 && slope(&|d| energy(x, y + d)).abs() < 1e-8);
    let second =
        |f: &dyn Fn(f64) -> f64| (16.0 * (f(h) + f(-h)) - f(2.0 * h) - f(-2.0 * h) - 30.0 * f(0.0)) / (12.0 * h * h);
    let (kxx, kyy) = (second(&|d| energy(x + d, y)), second(&|d| energy(x, y + d)));
    let kxy = 0.5 * (second(&|d| energy(x + d, y + d)) - kxx - kyy);
    let (mean, apart) = (0.5 * (kxx + kyy), (0.5 * (kxx - kyy)).hypot(kxy));
    let found = omegas(&answer);
    near(found[0].powi(2), mean - apart, 1e-7);
    near(found[1].powi(2), mean + apart, 1e-7);
}

#[test]
fn a_torsional_law_is_one_over_an_angle() {
    let answer = analyzed(
        "gravity 10 m/s^2\nbody r { mass = 2 kg, shape = rod((0, 0), (0.3 m, 0)) }\npivot p: ground@(0, 0) -- r\n\
         spring s: ground -- r { law = 5 N*m * sin(2 * stretch) }",
    );
    // m g L/2 cos a + 5 sin 2 a = 0
    let a = -root(|a| 5.0 * (2.0 * a).sin() - 3.0 * a.cos(), 0.0, 0.7);
    let stiffness = 10.0 * (2.0 * a).cos() - 3.0 * a.sin();
    near(answer.rest.displacement[0].to_f64(), a, 1e-13);
    near(omegas(&answer)[0], (stiffness / (2.0 * 0.09 / 3.0)).sqrt(), 1e-12);
    assert_eq!((answer.rest.laws[0].variable().1, answer.rest.laws[0].slope_unit()), ("rad", "N*m/rad"));
}

/// The same law as a coefficient, and a law: the same report.
#[test]
fn a_linear_law_is_a_coefficient() {
    let scene = |spring: &str, damper: &str| {
        json(
            &format!(
                "gravity 9.81 m/s^2\nbody b {{ mass = 1 kg, at = (0, 0), moves x y }}\nforce F: b along x\noutput x = b.x\noutput f = s.force + d.force\n\
                 spring s: ground@(0.3 m, 1 m) -- b {{ {spring}, free_length = 0.9 m }}\nspring t: ground@(-1 m, 0) -- b {{ k = 50 N/m }}\n\
                 damper d: ground@(0.3 m, 1 m) -- b {{ {damper} }}\n"
            ),
            &["transfer", "--at", "0.3 Hz", "--at", "2 Hz"],
        )
    };
    let law = scene("law = 100 N/m * stretch", "law = 3 N*s/m * rate");
    let coefficient = scene("k = 100 N/m", "c = 3 N*s/m");
    for (a, b) in law["pairs"].as_array().expect("pairs").iter().zip(coefficient["pairs"].as_array().expect("pairs")) {
        for (a, b) in a["values"].as_array().expect("values").iter().zip(b["values"].as_array().expect("values")) {
            near(a["re"].as_f64().expect("a number"), b["re"].as_f64().expect("a number"), 1e-14);
            near(a["im"].as_f64().expect("a number"), b["im"].as_f64().expect("a number"), 1e-14);
        }
    }
}

#[test]
fn a_nonlinear_damper_damps_by_its_tangent() {
    let answer = analyzed(
        "body b { mass = 2 kg, moves x }\nspring s: ground -- b { k = 50 N/m }\n\
         damper d: ground -- b { law = 4 N*s/m * rate + 7 N*s^2/m^2 * rate * abs(rate) }",
    );
    // c / (2 sqrt(k m))
    near(answer.poles.list[0].damping_ratio.expect("a ratio").to_f64(), 4.0 / (2.0 * 100_f64.sqrt()), 1e-15);
}

/// The rows beside SciPy's monotone cubic, with units in the call, in the heading and in both; and what has no units.
#[test]
fn a_table_is_a_law() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let rows = "-10,-1\n0,0\n10,1\n20,3\n40,6\n";
    let model = |law: &str, heading: &str, load: f64| {
        std::fs::write(folder.path().join("law.csv"), format!("{heading}{rows}")).expect("a file");
        let text = format!(
            "body b {{ mass = 1 kg, moves x }}\nspring s: ground -- b {{ law = {law} }}\nforce F: b along x = constant({load} N)\n"
        );
        std::fs::write(folder.path().join("m.vib"), text).expect("a file");
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_vibc"));
        command.args(["analyze", "--format", "json", "--message-format", "json"]).arg(folder.path().join("m.vib"));
        let output = command.output().expect("the program starts");
        let found: Option<Value> = serde_json::from_slice(&output.stdout).ok();
        (found, String::from_utf8_lossy(&output.stderr).to_string())
    };
    for (law, heading) in [
        ("table(\"law.csv\", 1 mm, 1 N)", ""),
        ("table(\"law.csv\")", "stretch [mm], force [N]\n"),
        ("table(\"law.csv\", 1 mm, 1 N)", "stretch [mm], force [N]\n"),
    ] {
        for (load, stretch, slope) in TABLE {
            let (found, errors) = model(law, heading, load);
            let found = found.unwrap_or_else(|| panic!("{law}: {errors}"));
            near(found["rest"]["displacement"]["b.x"].as_f64().expect("a number"), stretch, 1e-12);
            near(found["modes"][0]["frequency_hz"].as_f64().expect("a number") * TAU, slope.sqrt(), 1e-12);
        }
    }
    for (law, heading, load, wanted) in [
        ("table(\"law.csv\")", "", 2.0, "vib::law::table"),
        ("table(\"law.csv\", 1 N)", "", 2.0, "vib::law::table"),
        ("table(\"law.csv\")", "stretch, force [N]\n", 2.0, "vib::law::table"),
        ("table(\"law.csv\")", "time [s], force [N]\n", 2.0, "vib::law::table"),
        ("table(\"law.csv\", 1 mm, 1 N)", "stretch [m], force [N]\n", 2.0, "vib::table::units_differ"),
        ("table(\"law.csv\", 1 mm, 1 mm)", "", 2.0, "vib::unit::mismatch"),
        ("table(\"law.csv\", 1 s, 1 N)", "", 2.0, "vib::unit::mismatch"),
        ("table(\"law.csv\", 1 mm, 1 N)", "", 7.0, "vib::law::undefined"),
    ] {
        let (_, errors) = model(law, heading, load);
        let findings: Vec<Value> = errors.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
        assert!(findings.len() == 1 && findings[0]["code"] == wanted, "{law} {heading}: {errors}");
    }
}

/// Load, stretch and slope: `brentq` on `PchipInterpolator([-10, 0, 10, 20, 40], [-1, 0, 1, 3, 6])`, in mm and N.
const TABLE: [(f64, f64, f64); 3] = [
    (0.5, 0.005_450_522_561_037_682, 93.371_379_114_796_23),
    (2.0, 0.015_228_487_067_187_668, 223.907_052_148_863_8),
    (5.0, 0.032_395_163_039_367_4, 145.002_384_395_848_14),
];

/// From rest under a step the undamped mass swings to 2 F / k: law and tangent differ there by k3 (2 F / k)^2 / k.
#[test]
fn a_motion_says_how_far_it_leaves_the_tangent() {
    let model = |k3: &str| {
        format!(
            "body b {{ mass = 1 kg, moves x }}\nspring s: ground -- b {{ law = 100 N/m * stretch + {k3} N/m^3 * stretch^3 }}\n\
             force F: b along x = step(1 N, 0 s)\noutput x = b.x\nrequire peak(x) < 1 m\n"
        )
    };
    for (k3, severity, share) in [("1000", "note", "0.4 %"), ("10000", "warning", "4 %"), ("-10000", "warning", "4 %")]
    {
        for arguments in [
            &["simulate", "--until", "2 s", "--step", "1 s"][..],
            &["analyze", "--until", "2 s"],
            &["check", "--until", "2 s"],
        ] {
            let output = ran(&model(k3), &[arguments, &["--message-format", "json"]].concat());
            let text = String::from_utf8_lossy(&output.stderr);
            let found: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
            assert_eq!(found.len(), 1, "{arguments:?}: {text}");
            let message = found[0]["message"].as_str().expect("a message");
            assert!(found[0]["severity"] == severity && found[0]["code"] == "vib::law::tangent", "{text}");
            assert!(message.contains("0.02 m") && message.contains(share), "{message}");
        }
    }
}

/// A force that acts only 3.3 mm from the rest, within 10 um, lies between any places that one would try; the bound has it.
#[test]
fn a_difference_between_all_places_is_found() {
    let model = "body b { mass = 1 kg, moves x }\n\
        spring s: ground -- b { law = 100 N/m * stretch + 5 N * exp(-((stretch - 3.3 mm) / 10 um)^2) }\n\
        force F: b along x = step(1 N, 0 s)\noutput x = b.x\n";
    let output = ran(model, &["simulate", "--until", "2 s", "--step", "1 s", "--message-format", "json"]);
    let text = String::from_utf8_lossy(&output.stderr);
    // 5 N beside 100 N/m over 20 mm, the bound a hundredth above it.
    assert!(text.contains("warning") && text.contains("up to about 250 %"), "{text}");
}

#[test]
fn what_is_no_law_is_one_finding() {
    let scene = |element: &str| {
        format!(
            "gravity 9.81 m/s^2\nbody b {{ mass = 1 kg, at = (0, 0), moves y }}\nspring hold: ground -- b {{ k = 1 kN/m }}\n{element}\n"
        )
    };
    for (element, wanted) in [
        ("spring s: ground -- b { law = 10 N/m * stretch, k = 3 N/m }", "vib::law::and_coefficient"),
        ("spring s: ground -- b { law = 10 N/m * stretch, preload = 3 N }", "vib::law::and_coefficient"),
        ("damper s: ground -- b { law = 10 N*s/m * rate, c = 3 N*s/m }", "vib::law::and_coefficient"),
        ("spring s: ground -- b { law = 10 N/m^2 * stretch }", "vib::unit::mismatch"),
        ("spring s: ground -- b { law = 10 N/m * stretch + 3 N/m * stretch^2 }", "vib::unit::mismatch"),
        ("spring s: ground -- b { law = 10 N/m * strech }", "vib::name::unknown"),
        ("spring s: ground -- b { law = 10 N/m * rate }", "vib::name::unknown"),
        ("spring s: ground -- b { k = 10 N/m * stretch / 1 m }", "vib::name::unknown"),
        ("param stiff = 2 * stretch\nspring s: ground -- b { k = stiff * 1 N/m }", "vib::name::unknown"),
        ("spring s: ground -- b { law = sin(stretch) * 1 N }", "vib::unit::mismatch"),
        ("spring s: ground -- b { law = (1 N, 2 N) * (stretch / 1 m) }", "vib::value::kind"),
        ("spring s: ground -- b { law = foo(stretch) }", "vib::function::unknown"),
        ("spring s: ground -- b { law = 2 m ^ (stretch / 1 m) * 1 N/m }", "vib::unit::exponent"),
        ("spring s: ground -- b { law = 10 N * sqrt(stretch / 1 m - 1) }", "vib::law::undefined"),
        ("spring s: ground -- b { law = 10 N * sqrt(1 + stretch / 1 mm) }", "vib::law::undefined"),
        ("spring s: ground -- b { law = 1 N*m / stretch }", "vib::law::undefined"),
        ("damper s: ground -- b { law = 10 N * sqrt(rate / (1 m/s)) }", "vib::law::undefined"),
        ("damper s: ground -- b { law = 10 N*s/m * abs(rate) }", "vib::law::kink"),
        ("damper s: ground -- b { law = 10 N*s/m * rate + 1 N }", "vib::law::force_at_rest"),
        ("damper s: ground -- b { law = 10 N*s^2/m^2 * rate^2 }", "vib::law::no_tangent"),
    ] {
        assert_eq!(code(&scene(element), &["check"]), wanted, "{element}");
    }
    for (law, help) in [("10 N/m * strech", "did you mean `stretch`?"), ("10 N/m * rate", "this law is over `stretch`")]
    {
        let model = scene(&format!("spring s: ground -- b {{ law = {law} }}"));
        assert_eq!(crate::program::finding(&model, &["check"])["help"], help);
    }
    let outside = scene("spring s: ground -- b { k = 10 N/m * stretch / 1 m }");
    let help = "`stretch` stands in the `law` of a spring or damper alone";
    assert_eq!(crate::program::finding(&outside, &["check"])["help"], help);
    // Unloaded, each rests where its law begins.
    for (law, wanted) in [
        ("10 N/m * stretch + 5 N/m * abs(stretch)", "vib::law::kink"),
        ("10 N/m * max(stretch, 0)", "vib::law::kink"),
        ("10 N * sqrt(stretch / 1 m)", "vib::law::undefined"),
        ("10 N/m^3 * stretch^3", "vib::law::no_tangent"),
    ] {
        let model = format!("body b {{ mass = 1 kg, moves y }}\nspring s: ground -- b {{ law = {law} }}\n");
        assert_eq!(code(&model, &["check"]), wanted, "{law}");
    }
}

/// A rest exactly on the kink of a stop, which the load of 9.81 N reaches: its place is named.
#[test]
fn a_rest_on_a_kink_is_refused_with_its_place() {
    let model = "gravity 9.81 m/s^2\nbody b { mass = 1 kg, moves y }\n\
                 spring s: ground -- b { law = 1 kN/m * stretch + 5 kN/m * min(0, stretch + 9.81 mm) }\n";
    assert_eq!(code(model, &["check"]), "vib::law::kink");
    let text = String::from_utf8_lossy(&ran(model, &["check"]).stderr).to_string();
    assert!(text.contains("at a stretch of -0.00981 m"), "{text}");
}

/// Code and realisations of noise follow the tangents, and say so.
#[test]
fn what_follows_the_tangents_says_so() {
    let model = "body b { mass = 1 kg, moves x }\nspring s: ground -- b { law = 100 N/m * stretch + 1 kN/m^3 * stretch^3 }\n\
                 damper d: ground -- b { c = 1 N*s/m }\nforce F: b along x = noise(white 1 N^2/Hz)\nforce G: b along x\noutput x = b.x\n";
    let quiet = model.replace(" = noise(white 1 N^2/Hz)", "");
    for style in [&["emit", "--target", "c"][..], &["emit", "--target", "c", "--style", "equations"]] {
        let output = ran(&quiet, &[style, &["--message-format", "json"]].concat());
        let (code, found) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
        assert!(found.contains("vib::law::tangent") && found.lines().count() == 1, "{style:?}: {found}");
        assert!(
            code.contains("its tangent at rest in place of its law") || code.contains("linearised there"),
            "{code}"
        );
    }
    let noisy =
        ran(model, &["simulate", "--until", "1 s", "--step", "0.5 s", "--seed", "1", "--message-format", "json"]);
    let found = String::from_utf8_lossy(&noisy.stderr);
    assert!(found.contains("is not known: noise acts"), "{found}");
}

/// Sums of powers have equations (`equations_laws`); other functions and tables have none.
#[test]
fn the_equations_refuse_a_law_with_its_reason() {
    for law in [
        "10 N * sin(stretch / 1 m)",
        "10 N/m * stretch + 10 N * (stretch / 1 m)^9",
        "10 N/m * stretch * sqrt(1 + (stretch / 1 m)^2)",
    ] {
        let model = format!("body b {{ mass = 1 kg, moves y }}\nspring s: ground -- b {{ law = {law} }}\n");
        assert_eq!(code(&model, &["equations"]), "vib::equations::no_form", "{law}");
    }
}

/// Of a law whose tangent is zero at rest, the tangent says nothing: with the cubic law of one sign the mass is held, with that of
/// the other it is driven away, and neither verdict is claimed. A mass that nothing is attached to is neutral.
#[test]
fn a_law_without_a_tangent_decides_the_rest() {
    let scene = |law: &str| {
        format!("body a {{ mass = 1 kg, moves x }}\nspring s: ground -- a {{ law = {law} }}\nrequire stable\n")
    };
    for law in ["1e4 N/m^3 * stretch^3", "-1e4 N/m^3 * stretch^3"] {
        let answer = analyzed(&scene(law));
        assert_eq!(answer.stability.kind(), vibc::Stability::Undetermined, "{law}");
        assert_eq!(answer.requirements[0].holds, None, "{law}");
        let out = String::from_utf8(ran(&scene(law), &["analyze"]).stdout).unwrap();
        assert!(!out.contains("nothing restrains") && !out.contains("neutral rest"), "{out}");
        assert!(
            out.contains("a law has no tangent here: it may hold the motions without stiffness, or drive them away"),
            "{out}"
        );
        let kind: Value = serde_json::from_slice(&ran(&scene(law), &["analyze", "--format", "json"]).stdout).unwrap();
        assert_eq!(kind["rest"]["kind"], "undetermined", "{law}");
    }
    // Beside a spring the cubic law changes nothing.
    let held = scene("1e4 N/m^3 * stretch^3") + "spring t: ground -- a { k = 9 N/m }\n";
    assert_eq!(analyzed(&held).stability.kind(), vibc::Stability::Stable);
    let free = analyzed("body a { mass = 1 kg, moves x }\n");
    assert_eq!(free.stability.kind(), vibc::Stability::Neutral);
}

/// A law that never carries its load is named; below its largest force there is a rest, in closed form.
#[test]
fn a_law_too_weak_for_its_load_is_named() {
    let scene = |mass: f64, law: &str| {
        format!(
            "gravity 9.81 m/s^2\nbody a {{ mass = {mass} kg, moves y }}\nspring s: ground -- a {{ law = {law}, along = y }}\n"
        )
    };
    let sine = "100 N * sin(stretch / (10 mm) * 1 rad)";
    for (mass, law) in [(100.0, sine), (50.0, "200 N * atan(stretch / (10 mm)) / 1 rad")] {
        let found = crate::program::finding(&scene(mass, law), &["analyze"]);
        assert_eq!(found["code"], "vib::rest::not_found", "{law}");
        let message = found["message"].as_str().unwrap();
        assert!(message.contains("the law of `s`") && !message.contains("nothing holds"), "{message}");
        assert!(!found["help"].as_str().unwrap().contains("hold it with"), "{found}");
    }
    let rest = &analyzed(&scene(5.0, sine)).rest;
    near(rest.displacement[0].to_f64(), -0.01 * (5.0 * 9.81 / 100.0f64).asin(), 1e-14);
}
