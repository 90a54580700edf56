//! The components that come with the program beside closed forms from textbooks: frequencies, damping, transfer values. The
//! sources are named in the files of `library/`.

use std::f64::consts::PI;
use std::fs;
use std::path::Path;
use vibc::base::{FileId, SourceFile, Sources};
use vibc::{Overrides, ReportOptions};

fn source(text: &str) -> (Sources, FileId) {
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model("scene.vib", text));
    vibc::add_used_files(&mut sources, file, Some("scene.vib".into()), |path| Err(format!("there is no `{path}`")));
    (sources, file)
}

fn report(text: &str) -> serde_json::Value {
    let (sources, file) = source(text);
    let outcome = vibc::analyze(&sources, file, &Overrides::default());
    let answer = outcome.answer.unwrap_or_else(|| panic!("{text}\n{:?}", outcome.diagnostics));
    serde_json::from_str(&vibc::report_json(&answer, &ReportOptions::default())).expect("JSON")
}

/// Angular frequencies of the modes, rad/s, in order.
fn frequencies(text: &str) -> Vec<f64> {
    let modes = report(text)["modes"].as_array().expect("modes").clone();
    modes.iter().map(|mode| 2.0 * PI * mode["frequency_hz"].as_f64().expect("a number")).collect()
}

fn matrix(text: &str, name: &str) -> Vec<Vec<f64>> {
    let rows = report(text)["matrices"][name].as_array().expect("a matrix").clone();
    let row = |row: &serde_json::Value| {
        row.as_array().expect("a row").iter().map(|x| x.as_f64().expect("a number")).collect()
    };
    rows.iter().map(row).collect()
}

fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 4e-15 * expected.abs(), "{found} is not {expected}");
}

fn all_near(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len(), "{found:?} is not {expected:?}");
    found.iter().zip(expected).for_each(|(found, expected)| near(*found, *expected));
}

/// Whether the model holds that the measure has this value, to 1e-12.
fn holds(text: &str, measure: &str, value: f64, unit: &str) {
    let (low, high) = (value * (1.0 - 1e-12), value * (1.0 + 1e-12));
    let text = format!("{text}require {low:e} {unit} < {measure} < {high:e} {unit}\n");
    let (sources, file) = source(&text);
    let outcome = vibc::check(&sources, file, &Overrides::default(), None);
    assert!(outcome.answer.is_some() && outcome.diagnostics.is_empty(), "{text}{:?}", outcome.diagnostics);
}

#[test]
fn an_oscillator_has_its_frequency_and_its_damping_ratio() {
    let text =
        "use \"std/oscillator.vib\"\nplace o = oscillator(support = ground, m = 3 kg, k = 48 N/m, c = 6 N*s/m)\n";
    near(frequencies(text)[0], 4.0);
    // zeta = 6 / (2 sqrt(3 * 48)) = 1/4.
    holds(text, "damping(1)", 0.25, "");
    holds(text, "frequency(1)", 2.0 / PI, "Hz");
    assert_eq!(matrix(text, "c"), [[6.0]]);
}

/// Den Hartog 3.3: with the absorber tuned, the response passes through two fixed points of the same height, whatever its damping:
/// sqrt(1 + 2 / mu) times the static displacement, at g^2 = (1 -+ sqrt(mu / (2 + mu))) / (1 + mu).
#[test]
fn an_absorber_is_tuned_as_den_hartog_says() {
    let (main, mass, k): (f64, f64, f64) = (10.0, 0.5, 4000.0);
    let mu: f64 = mass / main;
    let omega: f64 = (k / main).sqrt();
    let text = format!(
        "use \"std/absorber.vib\"\nbody main {{ mass = {main} kg, moves x }}\nspring s: ground -- main {{ k = {k} N/m }}\n\
         place a = absorber(main = main, m = {mass} kg, main_mass = {main} kg, f = sqrt({k} N/m / ({main} kg)) * 1 rad)\n\
         force F: main along x\noutput u = main.x\n"
    );
    // c = 2 m omega_main sqrt(3 mu / (8 (1 + mu)^3)), k = m (omega_main / (1 + mu))^2.
    let damper = matrix(&text, "c")[1][1];
    near(damper, 2.0 * mass * omega * (3.0 * mu / (8.0 * (1.0 + mu).powi(3))).sqrt());
    near(matrix(&text, "k")[1][1], mass * (omega / (1.0 + mu)).powi(2));
    let height = (1.0 + 2.0 / mu).sqrt();
    for sign in [-1.0, 1.0] {
        let g = ((1.0 + sign * (mu / (2.0 + mu)).sqrt()) / (1.0 + mu)).sqrt();
        let hertz = format!("{:.17e} Hz", g * omega / (2.0 * PI));
        holds(&text, &format!("gain(F -> u, {hertz}) * {k} N/m"), height, "");
    }
    // Near the peaks, the curve with this damping is as good as flat: they are less than 0.5 % above the fixed points. With a tenth
    // more or less damping, one of them is higher.
    let peak = |factor: f64| {
        let c = damper * factor - damper;
        let more = format!("damper more: main -- a.mass {{ c = {c:e} N*s/m, along = x }}\n");
        let low = format!("{text}{more}require peak_gain(F -> u) * {k} N/m < {:e}\n", height * 1.005);
        let (sources, file) = source(&low);
        vibc::check(&sources, file, &Overrides::default(), None).diagnostics.is_empty()
    };
    assert_eq!([0.9, 1.0, 1.1].map(peak), [false, true, false]);
}

/// omega_j = 2 sqrt(k / m) sin((2j - 1) pi / (2 (2n + 1))).
#[test]
fn storeys_have_the_frequencies_of_a_uniform_shear_frame() {
    let n = 10;
    let mut text = "use \"std/storey.vib\"\nplace s[1] = storey(below = ground, m = 2 t, k = 50 MN/m)\n".to_string();
    text += &format!("repeat i in 2..{n} {{ place s[i] = storey(below = s[i-1].slab, m = 2 t, k = 50 MN/m) }}\n");
    let expected =
        |j: i32| 2.0 * (25_000.0_f64).sqrt() * (f64::from(2 * j - 1) * PI / f64::from(2 * (2 * n + 1))).sin();
    all_near(&frequencies(&text), &(1..=n).map(expected).collect::<Vec<f64>>());
}

/// Under a car that does not move, the wheel is on both springs; beside a car of mass M, the two roots of
/// M m w^4 - (M (k + t) + m k) w^2 + k t = 0.
#[test]
fn a_corner_of_a_car_has_the_two_frequencies_of_a_quarter_car() {
    let (car, wheel, k, tyre): (f64, f64, f64, f64) = (300.0, 40.0, 20_000.0, 180_000.0);
    let text = format!(
        "use \"std/quarter_car.vib\"\nbody car {{ mass = {car} kg, at = (1 m, 0.3 m), moves y }}\n\
         place q = quarter_car(car = car, c = 0 N*s/m) at (1 m, 0)\nforce F: car along y = step(100 N, 0 s)\n"
    );
    let (a, b, c): (f64, f64, f64) = (car * wheel, car * (k + tyre) + wheel * k, k * tyre);
    let root = (b * b - 4.0 * a * c).sqrt();
    // The smaller root by the product of both, which loses no digits.
    let high = (b + root) / (2.0 * a);
    all_near(&frequencies(&text), &[(c / (a * high)).sqrt(), high.sqrt()]);
    // The tyre carries all of the load, which pulls.
    let damped = text.replace("c = 0 N*s/m", "c = 1500 N*s/m");
    holds(&damped, "static(q.grip)", 100.0, "N");
}

/// Seen from the first shaft, the second one has J ratio^2 and k ratio^2: a chain of two discs.
#[test]
fn geared_shafts_are_a_chain_of_two_discs() {
    let (j1, j2, k1, k2, ratio): (f64, f64, f64, f64, f64) = (0.5, 0.02, 800.0, 100.0, 3.0);
    let text = format!(
        "use \"std/geared_shafts.vib\"\nplace g = geared_shafts(drive = ground, J1 = {j1} kg*m^2, J2 = {j2} kg*m^2, \
         k1 = {k1} N*m/rad, k2 = {k2} N*m/rad, ratio = {ratio})\n"
    );
    let (j2, k2) = (j2 * ratio * ratio, k2 * ratio * ratio);
    let (a, b, c) = (j1 * j2, j1 * k2 + j2 * (k1 + k2), k1 * k2);
    let high = (b + (b * b - 4.0 * a * c).sqrt()) / (2.0 * a);
    all_near(&frequencies(&text), &[(c / (a * high)).sqrt(), high.sqrt()]);
}

/// Dynamic stiffness k + 1 / (1 / (n k) + 1 / (i w c)): stiff k at rest, k (1 + n) at high frequencies.
#[test]
fn an_isolator_has_the_dynamic_stiffness_of_three_parameters() {
    let (m, k, c, n): (f64, f64, f64, f64) = (2.0, 500.0, 8.0, 3.0);
    let text = format!(
        "use \"std/isolator.vib\"\nbody b {{ mass = {m} kg, moves y }}\n\
         place i = isolator(upper = b, lower = ground, k = {k} N/m, c = {c} N*s/m)\nforce F: b along y\noutput u = b.y\n"
    );
    for hertz in [0.5, 2.5, 4.0, 30.0] {
        let w = 2.0 * PI * hertz;
        // 1 / (1/a + 1/(i b)) = a i b / (a + i b) = a b (b + i a) / (a^2 + b^2)
        let (a, b) = (n * k, w * c);
        let scale = a * b / (a * a + b * b);
        let (re, im) = (k - m * w * w + scale * b, scale * a);
        holds(&text, &format!("gain(F -> u, {hertz} Hz)"), 1.0 / re.hypot(im), "m/N");
    }
}

/// A file of the library without a test here, or without a place in the example, is noticed.
#[test]
fn every_file_of_the_library_is_tested_and_has_an_example() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let read = |path: &str| fs::read_to_string(root.join(path)).expect("a file");
    let (own, example) = (read("tests/suite/library.rs"), read("docs/components.md"));
    let entries = fs::read_dir(root.join("library")).expect("the library");
    let name = |entry: std::io::Result<fs::DirEntry>| entry.expect("a file").file_name().to_string_lossy().into_owned();
    let mut files: Vec<String> = entries.map(name).map(|name| format!("std/{name}")).collect();
    files.sort();
    assert!(!files.is_empty());
    for file in files {
        let text =
            format!("use \"{file}\"\nbody b {{ mass = 1 kg, moves x }}\nspring s: ground -- b {{ k = 1 N/m }}\n");
        let (sources, model) = source(&text);
        assert!(vibc::check(&sources, model, &Overrides::default(), None).diagnostics.is_empty(), "{file}");
        assert!(own.contains(&format!("use \\\"{file}\\\"")), "no test places {file}");
        assert!(example.contains(&format!("use \"{file}\"")), "the example places no {file}");
    }
}
