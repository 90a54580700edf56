//! Some of the modes: the lowest, or those in a band, of small systems and of large ones.
//! See docs/method/modes.md#large-trees and docs/method/modes.md#sparse-parts.

use serde_json::Value;
use vibc::analysis::{Band, Request, Which};
use vibc::backend::{ReportOptions, json, report};
use vibc::base::{Dd, SourceFile, Sources};
use vibc::model::Overrides;

fn asked(model: &str, which: Which) -> (Value, String) {
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model("scene.vib", model));
    let request = Request { which, ..Request::default() };
    let outcome = vibc::analyze_as(&sources, file, &Overrides::default(), &request);
    let answer = outcome.answer.unwrap_or_else(|| panic!("{:?}", outcome.diagnostics));
    let object = json::json(&answer, &ReportOptions::default());
    (serde_json::from_str(&object).expect("JSON"), report::text(&answer, &ReportOptions::default()))
}

fn numbers(answer: &Value, list: &str, field: &str) -> Vec<f64> {
    answer[list].as_array().expect("a list").iter().map(|item| item[field].as_f64().expect("a number")).collect()
}

/// A chain whose first mass may be held, with masses and springs of many magnitudes.
fn chain(n: usize, held: bool, more: &str) -> String {
    let first = if held { "spring k[1]: ground -- m[1] { k = 977 N/m }" } else { "" };
    format!(
        "body m[1] {{ mass = 1.7 kg, moves x }}\n{first}\nrepeat i in 2..{n} {{\n\
         body m[i] {{ mass = 1.3 kg + 0.1 kg * i / {n}, moves x }}\n\
         spring k[i]: m[i-1] -- m[i] {{ k = 1e3 N/m + i * 7.3 N/m }}\n}}\n{more}\n"
    )
}

const DAMPED: &str = "damper d: ground -- m[2] { c = 3 N*s/m }";

#[test]
fn the_lowest_modes_of_a_small_scene_are_the_first_of_all() {
    let (all, _) = asked(&chain(6, true, DAMPED), Which::All);
    let (some, text) = asked(&chain(6, true, DAMPED), Which::Lowest(2));
    for (list, field, count) in [("modes", "omega", 2), ("poles", "im", 4), ("poles", "re", 4)] {
        assert_eq!(numbers(&some, list, field), numbers(&all, list, field)[..count]);
    }
    assert_eq!(some["not_computed"]["modes_above"], 4);
    assert_eq!(some["not_computed"]["poles"], 8);
    assert_eq!(all["not_computed"]["poles"], 0);
    assert!(text.contains("not computed: 4 modes above"), "{text}");
    assert!(text.contains("not computed: 8 poles of other modes"), "{text}");
}

#[test]
fn a_band_has_its_modes_and_counts_the_others() {
    let (all, _) = asked(&chain(9, false, ""), Which::All);
    let omega = numbers(&all, "modes", "omega");
    // The ends are included.
    let (some, text) = asked(&chain(9, false, ""), Which::Within(Band { from: omega[3], to: omega[5] }));
    assert_eq!(numbers(&some, "modes", "omega"), omega[3..=5]);
    assert_eq!(numbers(&some, "modes", "mode"), [4.0, 5.0, 6.0]);
    assert_eq!(some["not_computed"]["modes_below"], 3);
    assert_eq!(some["not_computed"]["modes_above"], 3);
    assert_eq!(some["rest"]["kind"], "neutral");
    assert!(text.contains("1 rigid-body mode below those listed"), "{text}");
    let gap = Band { from: omega[3] * 1.001, to: omega[4] * 0.999 };
    let (none, text) = asked(&chain(9, false, ""), Which::Within(gap));
    assert_eq!(none["modes"].as_array().map(Vec::len), Some(0));
    assert_eq!(none["not_computed"]["modes_below"], 4);
    assert!(text.contains("no undamped mode is in the band"), "{text}");
    let (rigid, _) = asked(&chain(9, false, ""), Which::Within(Band { from: 0.0, to: omega[1] }));
    assert_eq!(rigid["modes"][0]["kind"], "rigid");
    assert_eq!(rigid["modes"].as_array().map(Vec::len), Some(2));
}

/// Compares the method for large trees with the method for all modes.
#[test]
fn large_trees_give_the_same_lowest_modes_and_bands() {
    for held in [true, false] {
        let model = chain(120, held, "");
        let (all, _) = asked(&model, Which::All);
        let omega = numbers(&all, "modes", "omega");
        let band = Band { from: 0.5 * (omega[6] + omega[7]), to: 0.5 * (omega[10] + omega[11]) };
        for (which, range) in [(Which::Lowest(5), 0..5), (Which::Within(band), 7..11)] {
            let (some, _) = asked(&model, which);
            assert_eq!(some["modes"][range.len() - 1]["route"], "tree");
            assert_eq!(numbers(&some, "modes", "mode")[0] as usize, range.start + 1);
            let found = numbers(&some, "modes", "omega");
            assert_eq!(found.len(), range.len());
            let bounds = numbers(&some, "modes", "omega_error_bound");
            for ((found, known), bound) in found.iter().zip(&omega[range]).zip(bounds) {
                assert!((found - known).abs() <= (bound + 3e-16) * known, "{found} {known} {bound:e}");
            }
        }
    }
}

#[test]
fn a_large_scene_gives_its_lowest_modes_unasked_and_says_so() {
    let (answer, text) = asked(&chain(500, true, ""), Which::Usual);
    assert_eq!(answer["modes"].as_array().map(Vec::len), Some(20));
    assert_eq!(answer["poles"].as_array().map(Vec::len), Some(40));
    assert_eq!(answer["not_computed"]["modes_above"], 480);
    assert_eq!(answer["rest"]["stable"], true);
    assert!(text.contains("not computed: 480 modes above (use --modes N or --band FROM..TO for others)"), "{text}");
}

#[test]
fn poles_of_large_scenes_are_followed_from_their_modes() {
    let (answer, text) = asked(&chain(500, true, DAMPED), Which::Lowest(3));
    assert_eq!(answer["modes"].as_array().map(Vec::len), Some(3));
    assert_eq!(answer["not_computed"]["poles"], 994);
    assert_eq!(answer["not_computed"]["poles_between"], true);
    assert!(text.contains("not computed: 994 poles; each of these was followed from its mode"), "{text}");
    let bounds = numbers(&answer, "poles", "error_bound");
    assert!(bounds.iter().all(|&bound| bound < 3e-16), "{bounds:?}");
    let (above, text) = asked(&chain(500, true, DAMPED), Which::Within(Band { from: 10.0, to: 12.0 }));
    assert_eq!(above["not_computed"]["poles"], 1000);
    assert!(text.contains("not computed: 1000 poles; this damping couples the modes"), "{text}");
    let (proportional, _) = asked(&chain(500, true, "damping rayleigh(0.1 /s, 1e-4 s)"), Which::Lowest(3));
    assert_eq!(proportional["not_computed"]["poles"], 994);
    let ratios = numbers(&proportional, "poles", "damping_ratio");
    let omega = numbers(&proportional, "modes", "omega");
    for (i, zeta) in ratios.iter().enumerate() {
        let expected = 0.5 * (0.1 / omega[i / 2] + 1e-4 * omega[i / 2]);
        assert!((zeta - expected).abs() <= 1e-14 * expected);
    }
}

/// With a damper too weak to matter, the damping is no longer proportional, and another method gives the same poles.
#[test]
fn followed_poles_are_those_of_the_closed_form() {
    let rayleigh = "damping rayleigh(0.1 /s, 1e-4 s)";
    for held in [true, false] {
        let (closed, _) = asked(&chain(500, held, rayleigh), Which::Lowest(6));
        let weak = format!("{rayleigh}\ndamper d: m[2] -- m[3] {{ c = 1e-24 N*s/m }}");
        let (followed, _) = asked(&chain(500, held, &weak), Which::Lowest(6));
        assert_eq!(followed["not_computed"]["poles_between"], true);
        let oscillating = |answer: &Value, field: &str| -> Vec<f64> {
            let list = answer["poles"].as_array().expect("a list").iter();
            list.filter(|pole| pole["kind"] == "oscillation")
                .map(|pole| pole[field].as_f64().expect("a number"))
                .collect()
        };
        for field in ["re", "im"] {
            let (found, expected) = (oscillating(&followed, field), oscillating(&closed, field));
            assert_eq!(found.len(), if held { 12 } else { 10 });
            for (found, expected) in found.iter().zip(&expected) {
                assert!((found - expected).abs() <= 2.3e-16 * expected.abs(), "{field}: {found} {expected}");
            }
        }
    }
}

/// Beside a part with a damper, a chain of 405: whoever asks for all modes has all poles. Those of the chain in closed form.
#[test]
fn all_poles_of_parts_beyond_the_limit_are_there_when_all_modes_are_asked_for() {
    let n = 405;
    let model = format!(
        "repeat i in 1..{n} {{ body m[i] {{ mass = 2 kg, moves x }} }}\nspring k[1]: ground -- m[1] {{ k = 18 N/m }}\n\
         repeat i in 2..{n} {{ spring k[i]: m[i-1] -- m[i] {{ k = 18 N/m }} }}\n\
         body a {{ mass = 1 kg, moves y }}\nbody b {{ mass = 3 kg, moves y }}\nspring s: ground -- a {{ k = 700 N/m }}\n\
         spring t: a -- b {{ k = 900 N/m }}\ndamper d: a -- b {{ c = 5 N*s/m }}\n"
    );
    let (answer, _) = asked(&model, Which::Lowest(n + 2));
    assert_eq!(answer["poles"].as_array().map(Vec::len), Some(2 * n + 4));
    let (re, im) = (numbers(&answer, "poles", "re"), numbers(&answer, "poles", "im"));
    let mut undamped: Vec<f64> =
        re.iter().zip(&im).filter(|(re, im)| **re == 0.0 && **im > 0.0).map(|(_, im)| *im).collect();
    undamped.sort_by(f64::total_cmp);
    let angle = |j: usize| (2 * j + 1) as f64 * std::f64::consts::PI / (4 * n + 2) as f64;
    let expected: Vec<f64> = (0..n).map(|j| 6.0 * angle(j).sin()).collect();
    assert_eq!(undamped.len(), n);
    for (found, expected) in undamped.iter().zip(&expected) {
        assert!((found - expected).abs() <= 1e-14 * expected, "{found} {expected}");
    }
    // -c (1/m_a + 1/m_b) is the trace of the damped part.
    let sum: f64 = re.iter().sum();
    assert!((sum + 5.0 * (1.0 + 1.0 / 3.0)).abs() < 1e-13, "{sum}");
}

/// Above 400 coordinates `damping modal` is still the ratio of each mode.
#[test]
fn damping_by_modes_of_large_scenes_is_the_ratio_itself() {
    let (light, text) = asked(&chain(500, true, "damping modal 2 %"), Which::Lowest(4));
    assert_eq!(numbers(&light, "poles", "damping_ratio"), [0.02; 8]);
    for (re, omega) in numbers(&light, "poles", "re").chunks(2).zip(numbers(&light, "modes", "omega")) {
        assert!((re[0] + 0.02 * omega).abs() <= 2e-16 * omega, "{re:?} {omega}");
    }
    assert!(text.contains("not computed: 992 poles of other modes"), "{text}");
    let (critical, _) = asked(&chain(500, true, "damping modal 100 %"), Which::Lowest(2));
    assert!(critical["poles"].as_array().expect("a list").iter().all(|pole| pole["kind"] == "overdamped"));
    // A rigid motion is not damped by it.
    let (free, _) = asked(&chain(500, false, "damping modal 2 %"), Which::Lowest(3));
    assert_eq!(free["poles"].as_array().map(Vec::len), Some(6));
    assert_eq!(free["poles"][0]["kind"], "rigid");
    assert_eq!(free["poles"][1]["kind"], "rigid");
}

/// A square membrane of masses, held at its edges: its omega^2 are 4 k/m (sin^2 + sin^2), many of them double.
#[test]
fn a_membrane_has_its_repeated_frequencies_as_groups() {
    let (side, k) = (22, 4096.0);
    let at = |i: usize, j: usize| i * side + j + 1;
    let mut model = String::new();
    for (i, j) in (0..side * side).map(|node| (node / side, node % side)) {
        model += &format!("body m[{}] {{ mass = 1 kg, moves x }}\n", at(i, j));
        let missing = [i == 0, i + 1 == side, j == 0, j + 1 == side].iter().filter(|&&edge| edge).count();
        if missing > 0 {
            model += &format!("spring g[{}]: ground -- m[{0}] {{ k = {} N/m }}\n", at(i, j), missing * 4096);
        }
        for other in [(j > 0).then(|| at(i, j - 1)), (i > 0).then(|| at(i - 1, j))].into_iter().flatten() {
            model += &format!("spring k[{other},{}]: m[{other}] -- m[{0}] {{ k = {k} N/m }}\n", at(i, j));
        }
    }
    let sine = |i: usize| (i as f64 * std::f64::consts::PI / (2.0 * (side as f64 + 1.0))).sin().powi(2);
    let mut known: Vec<f64> =
        (1..=side).flat_map(|i| (1..=side).map(move |j| (4.0 * k * (sine(i) + sine(j))).sqrt())).collect();
    known.sort_by(f64::total_cmp);
    let (some, text) = asked(&model, Which::Lowest(11));
    let found = numbers(&some, "modes", "omega");
    assert_eq!(found.len(), 11);
    for (found, known) in found.iter().zip(&known) {
        // The closed form in binary64 has a few rounding errors.
        assert!((found - known).abs() <= 2e-15 * known, "{found} {known}");
    }
    assert!(numbers(&some, "modes", "omega_error_bound").iter().all(|bound| *bound < 1e-12));
    assert!(text.contains("modes 2 and 3: one repeated frequency"), "{text}");
    let cluster = |mode: usize| &some["modes"][mode - 1]["cluster"];
    assert!(cluster(1).is_null() && cluster(2) == cluster(3) && !cluster(2).is_null() && cluster(4).is_null());
    let (band, _) = asked(&model, Which::Within(Band { from: known[3] * 0.99, to: known[7] * 1.001 }));
    assert_eq!(numbers(&band, "modes", "mode"), [4.0, 5.0, 6.0, 7.0, 8.0]);
    assert_eq!(band["not_computed"]["modes_below"], 3);
}

/// Points of 1 kg on links of 1 m without mass, one under another, whose rows in the angles are too long to be written
/// out.
fn hanging(n: usize, more: &str) -> String {
    format!(
        "gravity 9.81 m/s^2\nbody m[1] {{ mass = 1 kg, at = (0, -1 m), inertia = 0 kg*m^2 }}\n\
         pivot p[1]: ground@(0, 0) -- m[1]\nrepeat i in 2..{n} {{\n\
         body m[i] {{ mass = 1 kg, at = (0, -i * 1 m), inertia = 0 kg*m^2 }}\n\
         pivot p[i]: m[i-1]@(0, -(i - 1) * 1 m) -- m[i]\n}}\n{more}\n"
    )
}

/// The k-th root of Laguerre's polynomial of degree n, by Newton's method on its recurrence in double-double, starting
/// from its limit, the zeros of J0.
fn laguerre_root(n: u32, k: usize) -> f64 {
    let b = (k as f64 - 0.25) * std::f64::consts::PI;
    let mut x = Dd::from((b + 1.0 / (8.0 * b)).powi(2) / (4.0 * f64::from(n) + 2.0));
    for _ in 0..8 {
        let (mut before, mut now) = (Dd::ONE, Dd::ONE - x);
        for i in 1..n {
            let i = Dd::from(f64::from(i));
            let next = ((i + i + Dd::ONE - x) * now - i * before) / (i + Dd::ONE);
            (before, now) = (now, next);
        }
        // x L_n' = n (L_n - L_(n-1))
        x = x - now * x / (Dd::from(f64::from(n)) * (now - before));
    }
    x.to_f64()
}

/// omega^2 = x g / l with the roots x of Laguerre's polynomial, in the angles of the links.
#[test]
fn a_pendulum_of_many_links_has_its_lowest_modes() {
    let n = 600;
    let (some, text) = asked(&hanging(n, ""), Which::Lowest(20));
    let found = numbers(&some, "modes", "omega");
    assert_eq!(found.len(), 20);
    assert_eq!(some["modes"][0]["route"], "tree");
    for (k, (found, bound)) in found.iter().zip(numbers(&some, "modes", "omega_error_bound")).enumerate() {
        let known = (laguerre_root(n as u32, k + 1) * 9.81).sqrt();
        assert!((found - known).abs() <= (bound + 4e-16) * known, "{found} {known} {bound:e}");
        assert!(bound < 1e-12);
    }
    assert_eq!(some["not_computed"]["modes_above"], n - 20);
    assert_eq!(some["rest"]["stable"], true);
    assert!(text.contains("m[600].angle 1.0000"), "{text}");
    let band = Band { from: 0.5 * (found[4] + found[5]), to: 0.5 * (found[9] + found[10]) };
    let (banded, _) = asked(&hanging(n, ""), Which::Within(band));
    let inside = numbers(&banded, "modes", "omega");
    assert_eq!(inside.len(), 5);
    assert!(inside.iter().zip(&found[5..10]).all(|(a, b)| (a - b).abs() < 1e-13 * b));
    assert_eq!(banded["not_computed"]["modes_below"], 5);
    let (usual, _) = asked(&hanging(n, ""), Which::Usual);
    assert_eq!(numbers(&usual, "modes", "omega"), found);
}

/// Shorter rows, which are written out for all modes, get their lowest modes by the same method, with the same results.
#[test]
fn a_pendulum_of_some_links_has_the_lowest_of_all_its_modes() {
    let model = hanging(150, "spring s: m[40] -- m[41] { k = 2 kN*m/rad }");
    let (all, _) = asked(&model, Which::All);
    let (some, _) = asked(&model, Which::Lowest(5));
    assert_eq!(some["not_computed"]["modes_above"], 145);
    let known = numbers(&all, "modes", "omega");
    let bounds = numbers(&some, "modes", "omega_error_bound");
    for ((found, known), bound) in numbers(&some, "modes", "omega").iter().zip(&known).zip(bounds) {
        assert!((found - known).abs() <= (bound + 1e-12) * known && bound < 1e-12, "{found} {known} {bound:e}");
    }
}

#[test]
fn damping_of_a_long_pendulum_is_reported() {
    let (some, _) = asked(&hanging(600, "damper d: m[1] -- m[2] { c = 3 N*m*s/rad }"), Which::Lowest(3));
    assert_eq!(some["not_computed"]["poles"], 1194);
    assert!(numbers(&some, "poles", "error_bound").iter().all(|bound| *bound < 1e-12));
    // One damper among 600 links, which hardly rotate relative to each other there.
    for zeta in numbers(&some, "poles", "damping_ratio").chunks(2) {
        assert!(zeta[0] > 0.0 && zeta[0] == zeta[1] && zeta[0] < 1e-6, "{zeta:?}");
    }
    let (proportional, _) = asked(&hanging(600, "damping rayleigh(0.1 /s, 1e-4 s)"), Which::Lowest(3));
    let (ratios, omega) = (numbers(&proportional, "poles", "damping_ratio"), numbers(&proportional, "modes", "omega"));
    assert_eq!(ratios.len(), 6);
    for (i, zeta) in ratios.iter().enumerate() {
        let expected = 0.5 * (0.1 / omega[i / 2] + 1e-4 * omega[i / 2]);
        assert!((zeta - expected).abs() <= 1e-14 * expected);
    }
}

/// The bounds of a chain do not depend on its units: masses and stiffnesses of any magnitude in the range of binary64
/// (spec.md#numbers). A common factor changes no frequency.
#[test]
fn chains_of_tiny_and_huge_numbers_keep_their_bounds() {
    let n = 150;
    let of = |unit: &str, masses: &str, springs: &str| {
        let text = format!(
            "repeat i in 1..{n} {{ body m[i] {{ mass = {unit} kg * {masses}, moves x }} }}
            spring k[1]: ground -- m[1] {{ k = {unit} N/m * {springs} }}
            repeat i in 2..{n} {{ spring k[i]: m[i-1] -- m[i] {{ k = {unit} N/m * {springs} }} }}"
        );
        let mut sources = Sources::new();
        let file = sources.add(SourceFile::model("scene.vib", &text));
        let request = Request { which: Which::Lowest(3), ..Request::default() }.to_digits(25);
        let outcome = vibc::analyze_as(&sources, file, &Overrides::default(), &request);
        outcome.answer.unwrap_or_else(|| panic!("{unit}: {:?}", outcome.diagnostics)).modes.list
    };
    let plain = of("1", "1", "1");
    // 2 sin((2j - 1) pi / (4n + 2))
    for (j, mode) in (1..).zip(&plain) {
        let truth = 2.0 * (f64::from(2 * j - 1) * std::f64::consts::PI / f64::from(4 * n + 2)).sin();
        assert!((mode.omega.to_f64() - truth).abs() < 1e-15 * truth);
    }
    for unit in ["2.3e-308", "1e-306", "1e-291", "1e-150", "1e150", "1e307"] {
        for (mode, plain) in of(unit, "1", "1").iter().zip(&plain) {
            let error = (mode.omega.mid - plain.omega.mid).abs().to_f64();
            assert!(error <= mode.omega.rad + plain.omega.rad, "{unit}: {error:e} {:e}", mode.omega.rad);
            assert!(mode.omega.rad <= 1e-25 * mode.omega.to_f64(), "{unit}: {:e}", mode.omega.rad);
        }
    }
    // omega itself near the ends of its range: 1e-150 and 1e150 times as large.
    for (masses, springs, power) in [("1e150", "1e-150", -150), ("1e-150", "1e150", 150)] {
        for (mode, plain) in of("1", masses, springs).iter().zip(&plain) {
            let scale = 10f64.powi(power);
            assert!((mode.omega.to_f64() / scale - plain.omega.to_f64()).abs() < 1e-14 * plain.omega.to_f64());
            // The last bits of an omega² of 1e-304 are at 1e-324.
            let known = if power < 0 { 1e-15 } else { 1e-25 };
            assert!(mode.omega.rad <= known * mode.omega.to_f64(), "{power}: {:e}", mode.omega.rad);
        }
    }
}

/// Two oscillators that differ by 1e-14 and are coupled by 1e-14, among stiff ones: x_b / x_a = (sqrt 5 - 1) / 2 in the
/// first mode, whether one mode, two or all are requested.
#[test]
fn shapes_of_close_frequencies_are_separated() {
    let text = "body a { mass = 1 kg, moves x }
        body b { mass = 1 kg, moves x }
        spring sa: ground -- a { k = 1 N/m }
        spring sb: ground -- b { k = 1 N/m + GAP N/m }
        spring c: a -- b { k = GAP N/m }
        repeat i in 1..110 {
          body z[i] { mass = 1 kg, moves x }
          spring g[i]: ground -- z[i] { k = 1e6 N/m * (1 + 0.01*i) }
        }
        spring l: b -- z[1] { k = 1e-25 N/m }
        repeat i in 2..110 { spring t[i]: z[i-1] -- z[i] { k = 1e-25 N/m } }";
    let golden = (5f64.sqrt() - 1.0) / 2.0;
    for gap in ["1e-9", "1e-11", "1e-13", "1e-14", "1e-16"] {
        for which in [Which::Lowest(1), Which::Lowest(2), Which::Lowest(4), Which::All] {
            let (reported, _) = asked(&text.replace("GAP", gap), which);
            let shape = &reported["modes"][0]["shape"];
            let [a, b] = ["a.x", "b.x"].map(|name| shape[name].as_f64().expect("a number"));
            assert!((b / a - golden).abs() < 1e-9, "{gap} {which:?}: {}", b / a);
        }
    }
}
