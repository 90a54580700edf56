//! Damping of the whole system by its modes, compared with closed forms and with sums over the modes in 60 digits.

use std::process::Command;

/// A number as the sum of two binary64 numbers: some 32 digits.
type Wide = (f64, f64);

/// Frequencies in Hz with the real and imaginary parts of H.
fn keeps_its_bounds(model: &str, truth: &[(&str, Wide, Wide)]) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("model.vib");
    std::fs::write(&path, model).expect("a model");
    let mut command = Command::new(env!("CARGO_BIN_EXE_vibc"));
    command.arg("transfer").arg(&path).args(["--format", "json"]);
    truth.iter().for_each(|(hertz, ..)| {
        command.args(["--at", &format!("{hertz} Hz")]);
    });
    let output = command.output().expect("the program runs");
    let table: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let rows = table["pairs"][0]["values"].as_array().expect("rows");
    assert_eq!(rows.len(), truth.len(), "{table}");
    for (row, (hertz, re, im)) in rows.iter().zip(truth) {
        let number = |field: &str| row[field].as_f64().unwrap_or_else(|| panic!("{hertz} Hz: no {field}"));
        // Printed numbers are so close to the leading word that the difference is exact.
        let error = |printed: f64, truth: &Wide| (printed - truth.0) - truth.1;
        let (bound, size) = (number("error_bound"), re.0.hypot(im.0));
        let distance = error(number("re"), re).hypot(error(number("im"), im)) / size;
        // The difference itself is computed to 15 digits.
        assert!(distance <= bound * (1.0 + 1e-14), "{hertz} Hz: off by {distance:e}, bound {bound:e}");
        assert!(bound < 1e-15, "{hertz} Hz: the bound is {bound:e}");
    }
}

/// `damping modal` with 200 coordinates, whose modes are computed in binary64, compared with the closed form: the
/// shapes of a chain that is fixed at one end are sines. Values to 32 digits by mpmath, each as the sum of two binary64
/// numbers.
#[test]
fn damping_by_modes_keeps_its_bounds_in_a_long_chain() {
    let model = "model c\n\
        repeat i in 1..200 { body b[i] { mass = 1 kg, moves x } }\n\
        spring k0: ground -- b[1] { k = 100 N/m }\n\
        repeat i in 2..200 { spring k[i]: b[i-1] -- b[i] { k = 100 N/m } }\n\
        force F: b[1] along x\n\
        output y = b[200].x\n\
        damping modal 0.02\n";
    let truth = [
        ("0.05", (0.009920601265106075, 4.587878175570445e-19), (-0.0002140583924320127, 6.788107785169823e-21)),
        ("0.5", (0.004871310605636055, 1.9826782143862072e-20), (-0.001899448557638353, 1.4040355546858745e-20)),
        ("1.5", (-8.985808471460628e-05, -2.843203932404381e-21), (-0.00022598965316194023, 6.990617015564522e-22)),
        ("3", (7.253121840713361e-13, 2.5129403726127407e-29), (1.7052317239379366e-11, -9.571221291206215e-28)),
    ];
    keeps_its_bounds(model, &truth);
}

/// A body without mass between two others: the shapes are those of the springs in series.
#[test]
fn modal_damping_keeps_its_bounds_with_massless_bodies() {
    let model = "model c\n\
        body a { mass = 1 kg, moves x }\nbody b { mass = 0 kg, moves x }\nbody d { mass = 3 kg, moves x }\n\
        spring k0: ground -- a { k = 100 N/m }\nspring k1: a -- b { k = 30 N/m }\n\
        spring k2: b -- d { k = 1e9 N/m }\nforce F: a along x\noutput y = d.x\ndamping modal 0.02\n";
    keeps_its_bounds(
        model,
        &[("1.83166", (-0.0006430812817699558, -7.72706066330681e-21), (0.01510568509127682, 4.580525028103849e-19))],
    );
}

/// Critical damping of every mode: poles that are double within what is known of them. The two modes of the chain in 60
/// digits by mpmath.
#[test]
fn critical_damping_of_every_mode_keeps_its_bounds() {
    let model = "model c\nbody a { mass = 1 kg, moves x }\nbody b { mass = 3.418441235144435 kg, moves x }\n\
        spring k0: a -- b { k = 3 N/m }\nspring k1: ground -- a { k = 70 N/m }\n\
        force F: a along x\noutput y = a.x\ndamping modal 1\n";
    keeps_its_bounds(
        model,
        &[
            ("0.05", (0.014054315214668359, 1.4854718778281518e-19), (-0.001333129216422462, 1.0141673120793107e-19)),
            ("0.2", (0.01276458699733428, 3.0955897539108786e-19), (-0.004054810895449825, -9.679253794348036e-20)),
            ("2", (-0.00159365416303244, 8.68791906631395e-20), (-0.004025349601118935, -3.5757380994407575e-19)),
        ],
    );
}

/// A stiffness that may be zero: whether its mode oscillates, and so has a damping ratio, is not known.
#[test]
fn modes_that_are_not_known_get_no_damping() {
    let model = |stiffness: &str| {
        format!(
            "model c\nbody a {{ mass = 1 kg, moves x }}\nbody b {{ mass = 1 kg, moves x }}\n\
             spring k0: ground -- a {{ k = ({stiffness}) * 1 N/m }}\nspring k1: a -- b {{ k = 100 N/m }}\n\
             force F: a along x\noutput y = b.x\ndamping modal 0.02\n"
        )
    };
    let folder = tempfile::tempdir().expect("a folder");
    let run = |stiffness: &str| {
        let path = folder.path().join("model.vib");
        std::fs::write(&path, model(stiffness)).expect("a model");
        let mut command = Command::new(env!("CARGO_BIN_EXE_vibc"));
        command.arg("transfer").arg(&path).args(["--at", "0.1 Hz", "--message-format", "json"]).output().expect("runs")
    };
    // Exactly zero, but only known to thirty digits.
    let unknown = run("(sqrt(2) + sqrt(3))^2 - 5 - 2*sqrt(6)");
    let findings = String::from_utf8_lossy(&unknown.stderr);
    assert_eq!(unknown.status.code(), Some(4), "{findings}");
    assert!(findings.contains("vib::limit::range") && findings.contains("damping ratio"), "{findings}");
    assert!(unknown.stdout.is_empty());
    assert_eq!(run("(sqrt(2) + sqrt(3))^2 - 4 - 2*sqrt(6)").status.code(), Some(0));
}
