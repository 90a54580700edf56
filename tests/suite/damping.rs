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

/// H at some frequencies, rad/s.
fn transfer(model: &str, omegas: &[f64]) -> Vec<(f64, f64, f64)> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("model.vib");
    std::fs::write(&path, model).expect("a model");
    let mut command = Command::new(env!("CARGO_BIN_EXE_vibc"));
    command.arg("transfer").arg(&path).args(["--format", "json"]);
    omegas.iter().for_each(|omega| {
        command.args(["--at", &format!("{omega}rad/s")]);
    });
    let output = command.output().expect("the program runs");
    assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
    let table: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let rows = table["pairs"][0]["values"].as_array().expect("rows");
    let number = |row: &serde_json::Value, field: &str| row[field].as_f64().expect("a number");
    rows.iter().map(|row| (number(row, "re"), number(row, "im"), number(row, "error_bound"))).collect()
}

/// Code_Aster's SDLD101 (guide VPCS): an oscillator of 100 rad/s with a damping ratio of 5 % on a floor that moves. Published are
/// |H|^2 of the motion relative to the floor at five frequencies, the third one off by 9e-5; the closed form has them all.
#[test]
fn damping_by_modes_is_relative_to_a_moving_floor() {
    let model = "base floor { moves x }\nbody b { mass = 100 kg, moves x }\nspring s: floor -- b { k = 1e6 N/m }\n\
                 output away = b.x - floor.x\ndamping modal 5 %\n";
    let published = [(5.0, 0.011976), (10.0, 0.42096), (15.0, 36.9225), (20.0, 7.1006), (25.0, 2.7953)];
    let omegas = published.map(|(hertz, _)| hertz * std::f64::consts::TAU);
    for ((re, im, bound), ((hertz, square), omega)) in
        transfer(model, &omegas).into_iter().zip(published.into_iter().zip(omegas))
    {
        let found = re * re + im * im;
        assert!((found - square).abs() < 1e-4 * square, "{hertz} Hz: {found} {square}");
        let ratio = omega / 100.0;
        let exact = ratio.powi(4) / ((1.0 - ratio * ratio).powi(2) + (0.1 * ratio).powi(2));
        assert!((found - exact).abs() < 1e-13 * exact, "{hertz} Hz: {found} {exact}");
        assert!(bound < 1e-15, "{bound:e}");
    }
}

/// Two equal masses between the ground and a floor, whose modes are their sum and their difference: the floor carries the nearer
/// one along by 2/3 and the other one by 1/3, so the damping is that of dashpots for both modes between the masses and these motions.
/// A node without mass in the middle of the spring to the floor changes nothing, and neither does a motion that no spring restrains.
#[test]
fn what_bases_carry_along_is_not_damped() {
    let (m, k, zeta) = (2.0, 50.0, 0.03);
    let exact = |omega: f64| {
        // Modes: (1, 1) of stiffness k, (1, -1) of 3 k; the floor pushes the first mass by k u, carried along: (2/3, 1/3) u.
        let mode = |stiffness: f64, push: f64, along: f64| {
            let (natural, z) = ((stiffness / m).sqrt(), omega);
            let c = 2.0 * zeta * m * natural;
            let (re, im) = (stiffness - m * z * z, c * z);
            let (top, turn) = (push, c * along * z);
            let size = re * re + im * im;
            ((top * re + turn * im) / size, (turn * re - top * im) / size)
        };
        let (sum, difference) = (mode(k, k, 1.0), mode(3.0 * k, k, 1.0 / 3.0));
        [
            ((sum.0 + difference.0) / 2.0, (sum.1 + difference.1) / 2.0),
            ((sum.0 - difference.0) / 2.0, (sum.1 - difference.1) / 2.0),
        ]
    };
    let rest = "body a { mass = 2 kg, moves x }\nbody b { mass = 2 kg, moves x }\nspring t: a -- b { k = 50 N/m }\n\
                spring u: b -- ground { k = 50 N/m }\nbase floor { moves x }\ndamping modal 3 %\n";
    let near = "spring s: floor -- a { k = 50 N/m }\n";
    let node =
        "body n { mass = 0 kg, moves x }\nspring s: floor -- n { k = 100 N/m }\nspring r: n -- a { k = 100 N/m }\n";
    let loose = "body c { mass = 1 kg, moves x }\nbody d { mass = 3 kg, moves x }\nspring v: c -- d { k = 7 N/m }\n";
    let omegas = [0.7, 4.9, 5.1, 8.6, 30.0];
    for scene in [format!("{rest}{near}"), format!("{rest}{node}"), format!("{rest}{near}{loose}")] {
        for (index, output) in ["a.x", "b.x"].into_iter().enumerate() {
            let found = transfer(&format!("{scene}output o = {output}\n"), &omegas);
            for (&(re, im, _), omega) in found.iter().zip(omegas) {
                let (x, y) = exact(omega)[index];
                let off = (re - x).hypot(im - y);
                assert!(off < 1e-13 * x.hypot(y), "{output} at {omega}: {re} {im}, {x} {y}");
            }
        }
    }
}
