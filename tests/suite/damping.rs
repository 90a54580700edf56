//! Damping of the whole system by its modes, compared with closed forms and with sums over the modes in 60 digits.

use std::process::{Command, Output};

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

/// Masses in a row, the first one on the ground or not, a force on the first one, and the last displacement.
fn row(n: usize, is_held: bool, ratio: &str) -> String {
    let wall = if is_held { "spring k0: ground -- b[1] { k = 100 N/m }\n" } else { "" };
    format!(
        "model c\nrepeat i in 1..{n} {{ body b[i] {{ mass = 1 kg, moves x }} }}\n{wall}\
         repeat i in 2..{n} {{ spring k[i]: b[i-1] -- b[i] {{ k = 100 N/m }} }}\n\
         force F: b[1] along x\noutput y = b[{n}].x\ndamping modal {ratio}\n"
    )
}

/// `damping modal` with 200 coordinates, whose modes are computed in binary64, compared with the closed form: the
/// shapes of a chain that is fixed at one end are sines. Values to 32 digits by mpmath, each as the sum of two binary64
/// numbers.
#[test]
fn damping_by_modes_keeps_its_bounds_in_a_long_chain() {
    let model = row(200, true, "0.02");
    let truth = [
        ("0.05", (0.009920601265106075, 4.587878175570445e-19), (-0.0002140583924320127, 6.788107785169823e-21)),
        ("0.5", (0.004871310605636055, 1.9826782143862072e-20), (-0.001899448557638353, 1.4040355546858745e-20)),
        ("1.5", (-8.985808471460628e-05, -2.843203932404381e-21), (-0.00022598965316194023, 6.990617015564522e-22)),
        ("3", (7.253121840713361e-13, 2.5129403726127407e-29), (1.7052317239379366e-11, -9.571221291206215e-28)),
    ];
    keeps_its_bounds(&model, &truth);
}

/// A ratio of 1e9, with poles in two heaps 18 decades apart: no pole is lost between them, and |H| has no extremum. Values as above.
#[test]
fn damping_far_beyond_critical_keeps_its_bounds_in_a_long_chain() {
    let model = row(100, true, "1e9");
    let truth = [
        ("1e-10", (6.617517239022449e-08, 3.1797743348397108e-24), (-0.0008053565688405524, -2.266663861080331e-20)),
        ("0.001", (-2.5e-21, -1.3899057532692043e-37), (-7.918640005725403e-11, 6.3685082111281065e-27)),
        ("1e9", (-1.1169962722330855e-34, 5.759861044248959e-51), (1.9857553406605084e-25, 8.178941333611512e-42)),
        ("3e10", (-4.385392945329674e-83, 0.0), (7.261912812920861e-30, -4.992023371166452e-46)),
    ];
    keeps_its_bounds(&model, &truth);
    // Where the force acts each mode has a positive share, and all are overdamped: |H| falls everywhere.
    let table = table_of(&model.replace("force F: b[1]", "force F: b[100]"));
    assert_eq!(table["pairs"][0]["complete"], true);
    assert_eq!(table["pairs"][0]["extrema"], serde_json::json!([]));
}

/// A row that nothing holds: its rigid motion is not damped, the others are. Every value has its bound, and every extremum is there.
/// Values as above; the shapes are cosines.
#[test]
fn damping_by_modes_keeps_its_bounds_where_nothing_holds() {
    let model = row(30, false, "3 %");
    let truth = [
        ("0.001", (-844.3931435275184, -3.1229723605132685e-14), (1.971133322245332e-05, 1.1177175101137264e-21)),
        ("0.165", (-0.3122662208581522, 2.570170505910926e-17), (0.9257120398022408, 2.0550171785751574e-17)),
        ("1.5", (0.006141992316090195, 9.512521783580096e-20), (0.002113967835840344, -1.2855306831310227e-19)),
        ("4", (-2.7917426562866315e-21, 1.79149021849593e-38), (6.595539593526603e-08, 5.8620020630877375e-24)),
    ];
    keeps_its_bounds(&model, &truth);
    let table = table_of(&model);
    assert_eq!(table["pairs"][0]["complete"], true);
    let rows = table["pairs"][0]["values"].as_array().expect("rows");
    assert!(rows.len() > 200 && rows.iter().all(|row| row["error_bound"].as_f64().is_some_and(|bound| bound < 1e-15)));
}

/// Dampers beside the damping by modes: one that couples the modes, and one on each mass, which does not. With frequencies of 1 and 2 rad/s
/// C is rational, and the shapes of the row are sines. Values as above.
#[test]
fn dampers_beside_damping_by_modes_count_too() {
    let model = "model c\nbody a { mass = 1 kg, moves x }\nbody b { mass = 1 kg, moves x }\n\
        spring s: ground -- a { k = 1 N/m }\nspring t: ground -- b { k = 1 N/m }\nspring u: a -- b { k = 1.5 N/m }\n\
        damper d: ground -- a { c = 0.3 N*s/m }\nforce F: a along x\noutput y = b.x\ndamping modal 25 %\n";
    let truth = [
        ("0.05", (0.4003804031320703, -1.0417481771709305e-17), (-0.1076438678445623, -4.9498933250922974e-18)),
        ("0.16", (-0.1514065512410028, -4.1212164674134384e-18), (-0.7131275668971814, -3.347793154984498e-17)),
        ("0.3", (-0.20488171673527253, 3.0728534208095725e-18), (0.14808461875829043, -7.804603682306182e-18)),
        ("2", (4.232823730369997e-05, 3.338505480779244e-21), (0.00013690710813257301, -3.324285525087287e-21)),
    ];
    keeps_its_bounds(model, &truth);
    let dampers = "repeat i in 1..30 { damper d[i]: ground -- b[i] { c = 0.4 N*s/m } }\n";
    let truth = [
        ("0.02", (0.01017561401982309, 5.353253823432164e-19), (-0.0027139711687205045, -5.55707970530533e-20)),
        ("0.5", (-0.006830829978833046, 1.881321449817537e-19), (0.0012476039387069435, -8.178097983557753e-20)),
        ("1.5", (0.0003035662179163118, -7.419618409281796e-21), (0.0034378579026890367, -5.3116481849142374e-21)),
        ("4", (-1.0437404908696489e-10, -3.53671278380091e-27), (3.2850384221817923e-09, 2.518214465552076e-26)),
    ];
    keeps_its_bounds(&(row(30, true, "3 %") + dampers), &truth);
}

/// The whole table of a model, with its extrema.
fn table_of(model: &str) -> serde_json::Value {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("model.vib");
    std::fs::write(&path, model).expect("a model");
    let mut command = Command::new(env!("CARGO_BIN_EXE_vibc"));
    let output = command.arg("transfer").arg(&path).args(["--format", "json"]).output().expect("the program runs");
    serde_json::from_slice(&output.stdout).expect("JSON")
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
    let output = transferred(model, omegas);
    assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
    values_of(&output)
}

/// Like [`transfer`], of a model whose damping is reported.
fn transfer_with_notes(model: &str, omegas: &[f64]) -> Vec<(f64, f64, f64)> {
    let output = transferred(model, omegas);
    let findings = String::from_utf8_lossy(&output.stderr);
    assert!(
        findings.contains("vib::damping::base") && findings.contains("are damped against the ground"),
        "{findings}"
    );
    values_of(&output)
}

fn transferred(model: &str, omegas: &[f64]) -> Output {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("model.vib");
    std::fs::write(&path, model).expect("a model");
    let mut command = Command::new(env!("CARGO_BIN_EXE_vibc"));
    command.arg("transfer").arg(&path).args(["--format", "json"]);
    omegas.iter().for_each(|omega| {
        command.args(["--at", &format!("{omega}rad/s")]);
    });
    command.output().expect("the program runs")
}

fn values_of(output: &Output) -> Vec<(f64, f64, f64)> {
    let table: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let rows = table["pairs"][0]["values"].as_array().expect("rows");
    let number = |row: &serde_json::Value, field: &str| row[field].as_f64().expect("a number");
    rows.iter().map(|row| (number(row, "re"), number(row, "im"), number(row, "error_bound"))).collect()
}

/// Code_Aster's SDLD101 (guide VPCS, V2.01.101): an oscillator of 100 rad/s with a damping ratio of 5 % on a floor that moves.
/// Published are |H|^2 of the motion relative to the floor and of the absolute one at five frequencies each, by both definitions of damping;
/// one is off by 9e-5. The closed forms have them all.
#[test]
fn damping_by_modes_is_relative_to_a_moving_floor() {
    let scene = "base floor { moves x }\nbody b { mass = 100 kg, moves x }\nspring s: floor -- b { k = 1e6 N/m }\n";
    let published = [
        (5.0, 0.011976, 1.2307),
        (10.0, 0.42096, 2.7116),
        (15.0, 36.9225, 47.2154),
        (20.0, 7.1006, 2.8924),
        (25.0, 2.7953, 0.47047),
    ];
    let omegas = published.map(|(hertz, ..)| hertz * std::f64::consts::TAU);
    // Rayleigh damping has the ratio alpha / (2 w) + beta w / 2.
    for damping in ["modal 5 %", "rayleigh(10 /s, 0 s)", "rayleigh(0 /s, 1e-3 s)", "rayleigh(4 /s, 6e-4 s)"] {
        for (output, is_relative) in [("b.x - floor.x", true), ("b.x", false)] {
            let model = format!("{scene}output o = {output}\ndamping {damping}\n");
            for ((re, im, bound), ((hertz, relative, absolute), omega)) in
                transfer(&model, &omegas).into_iter().zip(published.into_iter().zip(omegas))
            {
                let (found, square) = (re * re + im * im, if is_relative { relative } else { absolute });
                assert!((found - square).abs() < 1e-4 * square, "{damping}, {hertz} Hz: {found} {square}");
                let ratio = omega / 100.0;
                let top = if is_relative { ratio.powi(4) } else { 1.0 + (0.1 * ratio).powi(2) };
                let exact = top / ((1.0 - ratio * ratio).powi(2) + (0.1 * ratio).powi(2));
                assert!((found - exact).abs() < 1e-13 * exact, "{damping}, {hertz} Hz: {found} {exact}");
                assert!(bound < 1e-14, "{bound:e}");
            }
        }
    }
}

/// Two masses between the ground and a floor: C (q' - r u') with r = (2/3, 1/3) for the masses and the strain rates of the springs, of
/// which the floor has the near end. Solved by hand in complex numbers.
#[test]
fn rayleigh_damping_is_relative_to_what_a_floor_carries_along() {
    let (m, k, alpha, beta) = (2.0, 50.0, 0.7, 0.04);
    let exact = |w: f64| {
        // (K + i w C - w^2 M) q = b, symmetric, with equal diagonal entries.
        let stiff = |k: f64, m: f64| (k - w * w * m, w * (alpha * m + beta * k));
        let (diagonal, beside) = (stiff(2.0 * k, m), stiff(-k, 0.0));
        let push = [(k, w * (beta * k + alpha * m * 2.0 / 3.0)), (0.0, w * alpha * m / 3.0)];
        let times = |a: (f64, f64), b: (f64, f64)| (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0);
        let minus = |a: (f64, f64), b: (f64, f64)| (a.0 - b.0, a.1 - b.1);
        let over = |a: (f64, f64), b: (f64, f64)| {
            let size = b.0 * b.0 + b.1 * b.1;
            let (re, im) = times(a, (b.0, -b.1));
            (re / size, im / size)
        };
        let determinant = minus(times(diagonal, diagonal), times(beside, beside));
        let one = |own, other| over(minus(times(diagonal, own), times(beside, other)), determinant);
        [one(push[0], push[1]), one(push[1], push[0])]
    };
    let scene = "body a { mass = 2 kg, moves x }\nbody b { mass = 2 kg, moves x }\nspring t: a -- b { k = 50 N/m }\n\
                 spring u: b -- ground { k = 50 N/m }\nspring s: floor -- a { k = 50 N/m }\nbase floor { moves x }\n\
                 damping rayleigh(0.7 /s, 0.04 s)\n";
    let omegas = [0.3, 4.9, 8.6, 30.0];
    for (index, output) in ["a.x", "b.x"].into_iter().enumerate() {
        for (&(re, im, bound), w) in transfer(&format!("{scene}output o = {output}\n"), &omegas).iter().zip(omegas) {
            let (x, y) = exact(w)[index];
            assert!((re - x).hypot(im - y) < 1e-14 * x.hypot(y), "{output} at {w}: {re} {im}, {x} {y}");
            assert!(bound < 1e-14, "{bound:e}");
        }
    }
}

/// A frame on a floor: what follows is the floor's own motion, so Rayleigh damping is that of dampers beside the springs and between
/// the floor and each mass. So it is for the floor's acceleration at 0 Hz, which no damper feels.
#[test]
fn rayleigh_damping_of_a_frame_is_that_of_dampers_written_out() {
    let frame = "base floor { moves x } = harmonic(1 m/s^2, 1 Hz)\nbody a { mass = 3 kg, moves x }\nbody b { mass = 2 kg, moves x }\n\
                 spring s: floor -- a { k = 70 N/m }\nspring t: a -- b { k = 40 N/m }\n";
    let written = "damper d: floor -- a { c = 70 * 0.03 N*s/m }\ndamper e: a -- b { c = 40 * 0.03 N*s/m }\n\
                   damper f: floor -- a { c = 3 * 0.2 N*s/m }\ndamper g: floor -- b { c = 2 * 0.2 N*s/m }\n";
    let omegas = [0.5, 3.0, 6.0, 40.0];
    for output in ["b.x - floor.x", "a.x", "b.ax"] {
        let of = |damping: &str| transfer(&format!("{frame}{damping}output o = {output}\n"), &omegas);
        for (found, wanted) in of("damping rayleigh(0.2 /s, 0.03 s)\n").iter().zip(of(written)) {
            let size = wanted.0.hypot(wanted.1);
            assert!((found.0 - wanted.0).hypot(found.1 - wanted.1) <= 1e-15 * size, "{output}: {found:?} {wanted:?}");
        }
    }
    let measure = "require gain(floor.ax -> b.x - floor.x, 0 Hz) < 1 s^2\nrequire rms(b.x - floor.x) < 1 m\n";
    let values = |damping: &str| {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("model.vib");
        std::fs::write(&path, format!("{frame}{damping}{measure}")).expect("a model");
        let output = Command::new(env!("CARGO_BIN_EXE_vibc"))
            .args(["analyze", "--until", "5 s", "--format", "json"])
            .arg(&path)
            .output()
            .expect("runs");
        let report: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
        [0, 1].map(|at| report["requirements"][at]["value"].as_f64().unwrap_or_else(|| panic!("{report}")))
    };
    let (found, wanted) = (values("damping rayleigh(0.2 /s, 0.03 s)\n"), values(written));
    // 5 kg and then 2 kg hang on the springs.
    assert!((found[0] - (5.0 / 70.0 + 2.0 / 40.0)).abs() < 1e-15, "{found:?}");
    assert!((found[1] - wanted[1]).abs() < 1e-14 * wanted[1], "{found:?} {wanted:?}");
}

/// A bar of 12 kg and 2 m on one spring at its end, free to turn about it. What follows the floor has no momentum in the free motion, the
/// turn about the spring's foot: y + th = 1 and 12 y - 4 th = 0 for the middle, whose inertia is 4 kg m^2.
#[test]
fn free_motions_are_damped_against_the_ground() {
    let model = "base floor { moves y }\nbody bar { mass = 12 kg, inertia = 4 kg*m^2, at = (0, 0), moves y, turns }\n\
                 spring s: floor -- bar@(1 m, 0) { k = 48 N/m, along = y }\ndamping rayleigh(0.5 /s, 0 s)\n";
    let exact = |w: f64| {
        // (K + i w alpha M - w^2 M) q = k a + i w alpha M r, a = (1, 1), r = (1/4, 3/4), M r = (3, 3): both sides along a and M^-1 a.
        let z = (-w * w, 0.5 * w);
        let push = (48.0, 1.5 * w);
        // q = (x / 12, x / 4), where z x + 48 (x / 3) = push.
        let of = (z.0 + 16.0, z.1);
        let size = of.0 * of.0 + of.1 * of.1;
        ((push.0 * of.0 + push.1 * of.1) / size, (push.1 * of.0 - push.0 * of.1) / size)
    };
    let omegas = [0.2, 3.0, 4.1, 20.0];
    for (output, inertia) in [("bar.y", 12.0), ("bar.angle", 4.0)] {
        for (&(re, im, _), w) in
            transfer_with_notes(&format!("{model}output o = {output}\n"), &omegas).iter().zip(omegas)
        {
            let (x, y) = exact(w);
            let (x, y) = (x / inertia, y / inertia);
            assert!((re - x).hypot(im - y) < 1e-14 * x.hypot(y), "{output} at {w}: {re} {im}, {x} {y}");
        }
    }
}

/// What a weld carries beside a spring with damping by its strain rate, and a refusal where damping by masses does not say it.
#[test]
fn a_reaction_has_its_part_of_damping_by_strain_rates() {
    let scene = "base floor { moves x }\nbody a { mass = 3 kg, moves x, at = (0, 0) }\nbody c { mass = 2 kg, at = (1 m, 0) }\n\
                 weld w: a -- c@(0, 0)\nspring s: floor -- c@(1 m, 0) { k = 70 N/m, along = x }\noutput o = w.fx\n";
    let omegas = [0.5, 3.0, 40.0];
    let of = |damping: &str| transfer(&format!("{scene}{damping}\n"), &omegas);
    let wanted = of("damper d: floor -- c@(1 m, 0) { c = 2.1 N*s/m, along = x }");
    for (found, wanted) in of("damping rayleigh(0 /s, 0.03 s)").iter().zip(wanted) {
        let size = wanted.0.hypot(wanted.1);
        assert!((found.0 - wanted.0).hypot(found.1 - wanted.1) <= 1e-14 * size, "{found:?} {wanted:?}");
    }
    let refused = transferred(&format!("{scene}damping rayleigh(0.1 /s, 0 s)\n"), &omegas);
    assert!(String::from_utf8_lossy(&refused.stderr).contains("vib::reaction::damped"), "{refused:?}");
}

/// The equations in symbols have the columns of the bases too, which are compared with the numbers: a frame, whose motion is carried
/// along whatever the stiffnesses are; two supports, whose shares are quotients of them; and a bar with a free motion, which has none.
#[test]
fn equations_have_rayleigh_damping_relative_to_bases() {
    let run = |model: &str| {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("model.vib");
        std::fs::write(&path, model).expect("a model");
        let output = Command::new(env!("CARGO_BIN_EXE_vibc")).arg("equations").arg(&path).output().expect("runs");
        (
            output.status.success(),
            format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr)),
        )
    };
    let frame = "param k = 70 N/m\nparam m = 3 kg\nparam alpha = 0.2 /s\nbase floor { moves x }\nbody a { mass = m, moves x }\n\
                 body b { mass = 2 kg, moves x }\nspring s: floor -- a { k = k }\nspring t: a -- b { k = 40 N/m }\noutput x = b.x\n\
                 damping rayleigh(alpha, 0.03 s)\n";
    let (is_good, text) = run(frame);
    assert!(is_good, "{text}");
    let both = format!("{frame}param h = 5 N/m\nspring u: b -- ground {{ k = h }}\n");
    let (is_good, text) = run(&both);
    assert!(is_good, "{text}");
    let bar = "base floor { moves y }\nbody bar { mass = 12 kg, inertia = 4 kg*m^2, at = (0, 0), moves y, turns }\n\
               spring s: floor -- bar@(1 m, 0) { k = 48 N/m, along = y }\ndamping rayleigh(0.5 /s, 0 s)\n";
    let (is_good, text) = run(bar);
    assert!(!is_good && text.contains("vib::equations::no_form"), "{text}");
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
