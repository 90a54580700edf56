//! Models in, scenes and findings out: each test uses the smallest model that shows its case.

use super::scene::Part;
use super::scene::*;
use super::*;
use crate::base::{Dimension, Number, Rational, SourceFile, SourceKind};
use crate::syntax;
use crate::system::Signal as Function;

fn checked_with(text: &str, arguments: &str, settings: &str) -> Checked {
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model("scene.vib", text));
    let mut add = |kind, name: &str, text: &str| {
        (!text.is_empty()).then(|| sources.add(SourceFile { kind, ..SourceFile::model(name, text) }))
    };
    let arguments = add(SourceKind::Arguments, "--set", arguments);
    let settings = add(SourceKind::Settings, "settings.toml", settings);
    let parsed = syntax::parse(&sources, file);
    check(&sources, &parsed.tree, &Overrides { arguments, settings, ..Overrides::default() })
}

fn check_text(text: &str) -> Checked {
    checked_with(text, "", "")
}

/// The codes of the findings, in order of place.
fn codes(checked: &Checked) -> Vec<&'static str> {
    let found = checked.diagnostics.clone().into_sorted();
    found.iter().map(|diagnostic| diagnostic.code.0).collect()
}

/// The message and the help of a finding.
fn messages(checked: &Checked) -> String {
    let shown = checked.diagnostics.clone().into_sorted();
    let line = |d: &crate::base::Diagnostic| {
        format!("{} [{}] ({})", d.message, d.primary.text, d.help.as_deref().unwrap_or_default())
    };
    shown.iter().map(line).collect::<Vec<_>>().join("\n")
}

#[test]
fn a_parameter_in_the_wrong_unit_is_one_finding_wherever_it_stands() {
    let with_springs = |count: usize| {
        let springs = (0..count).map(|i| format!("spring s{i}: ground -- b {{ k = k }}\n")).collect::<String>();
        check_text(&format!("param k = 3 N*s/m\nbody b {{ mass = 1 kg, moves x }}\n{springs}"))
    };
    let places = |count: usize| {
        let found = with_springs(count).diagnostics.into_sorted();
        assert_eq!(found.len(), 1, "{found:#?}");
        found[0].related.iter().map(|label| label.text.clone()).collect::<Vec<_>>()
    };
    assert_eq!(places(1), ["`k` is declared here"]);
    assert_eq!(places(3), ["`k` is declared here", "and here", "and here"]);
    assert_eq!(places(5)[3], "and here, and in 1 more place");
    // Another expectation of the same parameter is another finding.
    let both = "param k = 3 m\nbody b { mass = k, moves x }\nspring s: ground -- b { k = k }";
    assert_eq!(codes(&check_text(both)).len(), 2);
}

/// The scene of a model, which must have no errors.
fn scene(text: &str) -> Scene {
    scene_with(text, "", "")
}

fn scene_with(text: &str, arguments: &str, settings: &str) -> Scene {
    let checked = checked_with(text, arguments, settings);
    let messages = messages(&checked);
    checked.scene.unwrap_or_else(|| panic!("{messages}")).scene
}

/// The value of an expression as a mass in kg, after some declarations.
fn mass_after(declarations: &str, expression: &str) -> Number {
    let scene = scene(&format!("{declarations}\nbody b {{ mass = {expression}, moves x }}"));
    scene.bodies[0].mass.clone().expect("a mass")
}

fn mass(expression: &str) -> Number {
    mass_after("", expression)
}

/// The code with which an expression is refused as a mass.
fn refusal_code(expression: &str) -> &'static str {
    let found = codes(&check_text(&format!("body b {{ mass = {expression}, moves x }}")));
    assert_eq!(found.len(), 1, "{expression}: {found:?}");
    found[0]
}

/// The value of an expression as a frequency in Hz.
fn hertz(expression: &str) -> Result<Number, Vec<&'static str>> {
    let text = format!(
        "param fn = 10 Hz\nparam k = 16 N/m\nparam m = 4 kg\nlet unused = fn*k*m\nbody b {{ mass = 1 kg, moves x }}
         force F: b = harmonic(1 N, {expression})"
    );
    let checked = check_text(&text);
    let codes = codes(&checked);
    let Some(scene) = checked.scene else { return Err(codes) };
    match &scene.scene.inputs[0].signal[0] {
        Signal::Function(Function::Harmonic { frequency, .. }) => Ok(frequency.clone()),
        other => panic!("{other:?}"),
    }
}

fn exact(text: &str) -> Number {
    Number::from(text)
}

#[test]
fn the_cart_is_resolved() {
    let scene = scene(include_str!("../../examples/cart.vib"));
    assert_eq!(scene.name, "cart");
    assert_eq!(scene.bodies.len(), 2);
    let rod = &scene.bodies[1];
    assert_eq!(rod.inertia, Some(Box::new(Number::from(Rational::new(1, 6)))));
    assert_eq!(rod.centre.as_deref(), Some(&Vec3::planar(Number::ZERO, Number::from(-1))));
    assert_eq!(rod.freedom, Freedom::FromJoints);
    assert!(scene.joints[0].kind.turns && scene.joints[0].at.as_ref().is_some_and(Vec3::is_zero));
    assert_eq!(scene.elements[0].law.geometry, Geometry::Line);
    assert_eq!(scene.gravity, Vec3::planar(Number::ZERO, -&Number::from("9.81")));
    assert_eq!((scene.inputs.len(), scene.outputs.len()), (1, 2));
    assert!(scene.outputs[1].is_angle);
}

// Expressions

#[test]
fn arithmetic_on_literals_is_exact() {
    assert_eq!(mass("0.1 kg + 0.2 kg"), exact("0.3"));
    assert_eq!(mass("1 kg / 3 * 3"), Number::ONE);
    assert_eq!(mass("2^-3 * 1 kg"), exact("0.125"));
    assert_eq!(mass("-(-2 kg)"), Number::from(2));
    assert_eq!(mass("2 * 3 kg - 500 g"), exact("5.5"));
    assert_eq!(mass("sqrt(9 kg^2)"), Number::from(3));
    assert_eq!(mass("(8 kg^3)^(1/3) + 0"), mass("(8 kg^3)^(1/3)"));
    assert_eq!(mass("max(0, 1 kg, 3 kg) + min(2 t, 4 kg) + abs(-1 kg)"), Number::from(8));
    assert_eq!(mass("5 % * 100 kg"), Number::from(5));
    assert_eq!(mass("10 N * 2 m / (4 m^2/s^2)"), Number::from(5));
    assert_eq!(mass("-40 dB * 100 kg"), Number::ONE);
    assert_eq!(mass("1 lb"), exact("0.45359237"));
}

#[test]
fn functions_of_angles_take_angles_and_plain_numbers() {
    let close = |text: &str, value: f64| {
        let found = mass(text).to_f64();
        assert!((found - value).abs() < 1e-14, "{text}: {found}");
    };
    close("sin(30 deg) * 2 kg", 1.0);
    close("cos(1 rev / 6) * 2 kg", 1.0);
    close("tan(45 deg) * 1 kg", 1.0);
    close("atan2(1 m, 1 m) / 45 deg * 1 kg", 1.0);
    close("(asin(1/2) + acos(1/2) + atan(1)) / pi * 1 kg", 0.75);
    close("ln(exp(2)) * 1 kg", 2.0);
    close("pi * 1 kg", std::f64::consts::PI);
}

#[test]
fn dimensions_are_checked_in_every_expression() {
    assert_eq!(refusal_code("1 kg + 1 m"), "vib::unit::mismatch");
    assert_eq!(refusal_code("1 kg + 1"), "vib::unit::mismatch");
    assert_eq!(refusal_code("sin(1 m) * 1 kg"), "vib::unit::mismatch");
    assert_eq!(refusal_code("2^(1 s) * 1 kg"), "vib::unit::mismatch");
    assert_eq!(refusal_code("atan2(1 m, 1 s) * 1 kg"), "vib::unit::mismatch");
    assert_eq!(refusal_code("max(1 kg, 1 m)"), "vib::unit::mismatch");
    assert_eq!(refusal_code("sqrt(4 kg)"), "vib::unit::mismatch");
    assert_eq!(refusal_code("1 N"), "vib::unit::mismatch");
    assert_eq!(refusal_code("3"), "vib::unit::missing");
    assert_eq!(refusal_code("3 %"), "vib::unit::mismatch");
    assert_eq!(refusal_code("(1 kg)^pi"), "vib::unit::exponent");
    assert_eq!(refusal_code("(0, 1 kg)"), "vib::value::kind");
    assert_eq!(refusal_code("(1 kg, 1 m)"), "vib::unit::mismatch");
    assert_eq!(refusal_code("1 kg * (1, 0)"), "vib::value::kind");
    assert_eq!(refusal_code("\"file\""), "vib::value::kind");
}

#[test]
fn expressions_without_a_value_are_refused() {
    assert_eq!(refusal_code("1 kg / 0"), "vib::number::division_by_zero");
    assert_eq!(refusal_code("1 kg / (0.1 + 0.2 - 0.3)"), "vib::number::division_by_zero");
    assert_eq!(refusal_code("1 kg * 0^-1"), "vib::number::division_by_zero");
    assert_eq!(refusal_code("tan(pi/2) * 1 kg"), "vib::number::division_by_zero");
    assert_eq!(refusal_code("sqrt(-1 kg^2)"), "vib::number::root_of_negative");
    assert_eq!(refusal_code("(-1)^0.5 * 1 kg"), "vib::number::root_of_negative");
    assert_eq!(refusal_code("ln(0) * 1 kg"), "vib::number::domain");
    assert_eq!(refusal_code("acos(1.5) * 1 kg"), "vib::number::domain");
    assert_eq!(refusal_code("atan2(0, 0) * 1 kg"), "vib::number::domain");
    assert_eq!(refusal_code("1e400 kg"), "vib::number::overflow");
    assert_eq!(refusal_code("1e200 kg * 1e200"), "vib::number::overflow");
    assert_eq!(refusal_code("1e-200 kg / 1e200"), "vib::number::overflow");
    assert_eq!(refusal_code("exp(1e6) * 1 kg"), "vib::number::overflow");
    assert_eq!(refusal_code("10^10^10 * 1 kg"), "vib::number::overflow");
    assert_eq!(refusal_code("-1 kg"), "vib::value::negative");
}

#[test]
fn a_bare_zero_fits_any_dimension() {
    assert_eq!(mass("0"), Number::ZERO);
    assert_eq!(mass("1 kg + 0"), Number::ONE);
    assert_eq!(mass("0 - 1 kg + 2 kg"), Number::ONE);
    let scene = scene("param L = 0\nbody b { mass = 1 kg, at = (0, L), moves x }");
    assert!(scene.bodies[0].centre.as_ref().is_some_and(|centre| centre.is_zero()));
    // But a zero with a unit has the dimension of that unit.
    assert_eq!(refusal_code("0 m"), "vib::unit::mismatch");
    assert_eq!(refusal_code("1 kg + 0 m"), "vib::unit::mismatch");
    assert_eq!(refusal_code("0 %"), "vib::unit::mismatch");
}

#[test]
fn a_frequency_is_in_cycles_or_radians_and_never_guessed() {
    assert_eq!(hertz("30 Hz"), Ok(Number::from(30)));
    assert_eq!(hertz("1 kHz"), Ok(Number::from(1000)));
    assert_eq!(hertz("3*fn/2 + 1 Hz - (-fn)"), Ok(Number::from(26)));
    assert_eq!(hertz("max(fn, 3 Hz)"), Ok(Number::from(10)));
    assert_eq!(hertz("0"), Ok(Number::ZERO));
    let turn = 2.0 * std::f64::consts::PI;
    let is = |expression: &str, value: f64| {
        let found = hertz(expression).expect("a frequency").to_f64();
        assert!((found - value).abs() < 1e-13 * value, "{expression}: {found}");
    };
    is("10 rad/s", 10.0 / turn);
    is("600 rpm", 10.0);
    is("360 deg/s", 1.0);
    is("sqrt(k/m) * 1 rad", 2.0 / turn);
    is("sqrt(k/m) * 1 rev", 2.0);
    is("1 rev / 2 s", 0.5);
    is("fn * 1 rad", 10.0 / turn);
    for both_readings in ["sqrt(k/m)", "2*pi*fn", "3 /s", "fn + 3 /s", "fn + 1 rad/s", "fn^2/fn"] {
        assert_eq!(hertz(both_readings), Err(vec!["vib::unit::frequency"]), "{both_readings}");
    }
    assert_eq!(hertz("3 s"), Err(vec!["vib::unit::mismatch"]));
}

#[test]
fn a_unit_is_glued_and_a_product_has_spaces() {
    assert_eq!(mass_after("param L = 2", "3 kg * L"), Number::from(6));
    let glued = check_text("param L = 2 m\nbody b { mass = 3 kg*L, moves x }");
    assert_eq!(codes(&glued)[0], "vib::unit::unknown");
    assert!(messages(&glued).contains("write spaces around"));
    assert!(messages(&check_text("param k = 1/s\nbody b { mass = 1 kg, moves x }")).contains("`s` is a unit"));
    assert_eq!(refusal_code("1 kg/m*s"), "vib::unit::ambiguous");
}

// Names

#[test]
fn parameters_may_be_declared_in_any_order() {
    assert_eq!(mass_after("let a = b + c\nlet b = 2*c\nparam c = 1 kg", "a"), Number::from(3));
}

#[test]
fn a_cycle_names_its_members_once() {
    let checked = check_text("let a = b\nlet b = c\nlet c = b\nlet d = a\nbody e { mass = d, moves x }");
    assert_eq!(codes(&checked), ["vib::parameter::cycle"]);
    assert!(messages(&checked).contains("`b` -> `c` -> `b`"), "{}", messages(&checked));
}

#[test]
fn a_long_chain_of_parameters_needs_no_deep_stack() {
    let count = 5_000;
    let mut text: String = (0..count).map(|i| format!("let a{i} = a{} + 1\n", i + 1)).collect();
    text += &format!("let a{count} = 1\n");
    assert_eq!(mass_after(&text, "a0 * 1 kg"), Number::from(count + 1));
    let circle: String = (0..count).map(|i| format!("let a{i} = a{} + 1\n", (i + 1) % count)).collect();
    assert_eq!(codes(&check_text(&format!("{circle}body b {{ mass = 1 kg, moves x }}"))), ["vib::parameter::cycle"]);
}

#[test]
fn parts_and_values_have_separate_name_spaces() {
    let scene = scene("param k = 10 N/m\nbody b { mass = 1 kg, moves x }\nspring k: ground -- b { k = k }");
    assert_eq!(scene.words.display(scene.elements[0].name), "k");
    let twice =
        check_text("param k = 10 N/m\npoint k = (0, 0)\nbody b { mass = k, moves x }\nspring b: ground -- b { k = k }");
    let twice = codes(&twice);
    assert_eq!(twice.iter().filter(|code| **code == "vib::name::duplicate").count(), 2, "{twice:?}");
}

#[test]
fn unknown_names_are_reported_with_the_nearest_known_one() {
    let model = "param stiffness = 10 N/m\nbody block { mass = 1 kg, moves x }\n";
    let with = |line: &str| messages(&check_text(&format!("{model}{line}")));
    assert!(with("spring s: ground -- block { k = stifness }").contains("did you mean `stiffness`?"));
    assert!(with("spring s: ground -- blok { k = stiffness }").contains("did you mean `block`?"));
    assert!(with("spring s: ground -- block { k = stiffness, prelod = 1 N }").contains("did you mean `preload`?"));
    assert!(with("output o = block.agle").contains("did you mean `angle`?"));
    assert!(with("param a = sqr(2)").contains("did you mean `sqrt`?"));
    assert!(with("param a = 2 Newton").contains("did you mean `N`?"));
    assert!(with("param a = block").contains("`block` is a body"));
    assert!(with("param a = 1 m/(m/s^2)").contains("which stands without brackets"));
    assert_eq!(codes(&check_text(&format!("{model}param a = 1 m/(m + s)"))).len(), 2);
    assert!(with("param a = rod(2)").contains("shape = rod(A, B)"));
}

#[test]
fn one_mistake_gives_one_error() {
    for text in [
        "param a = 1 kg + 1 m\nlet b = a\nbody c { mass = b, moves x }\nspring s: ground -- c { k = a*b }",
        "body c { mass = 1 m, moves x }\nspring s: ground -- c { k = 1 N/m }\noutput o = c.x\nforce F: c",
        "body c { mass = 1 kg, moves x }\nspring s: ground -- d { k = 1 N/m }\noutput o = s.force",
        "body c { mass = 1 kg }\npivot p: ground@(0, 1 kg) -- c\nspring t: ground -- c { k = 1 N*m/rad }\noutput o = c.angle",
        "base f { moves z }\nbody c { mass = 1 kg, moves x }\nspring s: f -- c { k = 1 N/m }\noutput o = f.x",
        "repeat i in 1..1000 {\nbody c[i] { mass = 1 m, moves x }\n}\noutput o = c[3].x",
        "repeat i in 1..1000 {\nbody c[i] { mass = i * 1 m, moves x }\n}",
        "body s { mass = 1 kg, moves x }\nspring t: ground -- s { k = 1 N/m }\nparam a = 1 m/(m/s^2)",
        "param n = 1.5\nrepeat i in 1..n {\nbody c[i] { mass = 1 kg, moves x }\n}\nspring s: c[1] -- c[2] { k = 1 N/m }\nbody d { mass = 1 kg, moves x }",
    ] {
        assert_eq!(codes(&check_text(text)).len(), 1, "{text}: {}", messages(&check_text(text)));
    }
}

#[test]
fn names_of_declarations_that_did_not_parse_are_not_unknown() {
    let text = "body a { mass = = 1 kg, moves x }\nparam k = = 3\nspring s: ground -- a { k = k }\nbody b { mass = 1 m, moves x }";
    assert_eq!(codes(&check_text(text)), ["vib::unit::mismatch"]);
}

// `repeat`

#[test]
fn a_repetition_is_unrolled_in_order() {
    let scene = scene(
        "param n = 3
         body m[0] { mass = 1 kg, moves x }
         repeat i in 1..n {
           param k[i] = i * 10 N/m
           body m[i] { mass = 1 kg, moves x }
           spring s[i]: m[i-1] -- m[i] { k = k[i] }
         }",
    );
    let names: Vec<String> = scene.bodies.iter().map(|body| scene.words.display(body.name)).collect();
    assert_eq!(names, ["m[0]", "m[1]", "m[2]", "m[3]"]);
    let stiffness = |element: &Element| element.law.spring().expect("a spring").0.clone();
    assert_eq!(scene.elements.iter().map(stiffness).collect::<Vec<_>>(), [10, 20, 30].map(Number::from));
    assert_eq!(scene.elements[1].ends.clone().map(|end| end.part), [1, 2].map(|id| Part::Body(BodyId(id))));
}

#[test]
fn repetitions_nest_and_indices_are_calculated() {
    let scene = scene(
        "repeat i in 1..3 {
           repeat j in i..3 {
             point P[i][j] = (i * 1 m, j * 1 m)
             body m[i, j] { mass = 1 kg, at = P[i, j], moves x }
           }
         }
         output o = m[2*2 - 3][3].x",
    );
    assert_eq!(scene.bodies.len(), 6);
    assert_eq!(scene.bodies[5].centre.as_deref(), Some(&Vec3::planar(Number::from(3), Number::from(3))));
    assert!(matches!(scene.outputs[0].terms[0].motion, Motion::Point { part: Part::Body(BodyId(2)), .. }));
}

#[test]
fn each_repetition_has_its_own_kind_of_spring() {
    let scene = scene(
        "param k[1] = 1 N/m
         param k[2] = 1 N*m/rad
         repeat i in 1..2 {
           body m[i] { mass = 1 kg, inertia = 1 kg*m^2, moves x, turns }
           spring s[i]: ground -- m[i] { k = k[i] }
         }",
    );
    assert!(matches!(scene.elements[0].law.geometry, Geometry::Along(_)));
    assert_eq!(scene.elements[1].law.geometry, Geometry::Torsion);
}

#[test]
fn an_empty_repetition_is_none_and_a_reversed_one_an_error() {
    let with = |range: &str| {
        format!("body a {{ mass = 1 kg, moves x }}\nrepeat i in {range} {{\nbody m[i] {{ mass = 1 kg, moves x }}\n}}")
    };
    assert_eq!(scene(&with("1..0")).bodies.len(), 1);
    assert_eq!(scene(&with("-1..1")).bodies.len(), 4);
    assert_eq!(codes(&check_text(&with("3..1"))), ["vib::repeat::reversed"]);
}

#[test]
fn too_many_repetitions_are_refused_before_any_work() {
    let nested = "repeat i in 1..100000 {\nrepeat j in 1..100000 {\nbody m[i][j] { mass = 1 kg, moves x }\n}\n}";
    let single = "repeat i in 1..1000000000000 {\nbody m[i] { mass = 1 kg, moves x }\n}";
    // If each repetition took any work, this test would not end.
    assert_eq!(codes(&check_text(nested)), ["vib::limit::repeat"]);
    assert_eq!(codes(&check_text(single)), ["vib::limit::repeat"]);
}

#[test]
fn an_index_out_of_range_names_those_declared() {
    let text = "repeat i in 1..3 {\nbody m[i] { mass = 1 kg, moves x }\nspring k[i]: m[i-1] -- m[i] { k = 1 N/m }\n}";
    let found = check_text(text);
    assert_eq!(codes(&found), ["vib::name::index"]);
    assert!(
        messages(&found).contains("there is no `m[0]` [i = 1] (the declared ones are `m[1..3]`)"),
        "{}",
        messages(&found)
    );
}

// Values from outside

const SETTABLE: &str = "param n = 2
    param k = 10 N/m
    param f = 10 Hz
    param w = 1 rad/s
    let q = 2*k
    point P = (0, 0)
    repeat i in 1..n {
      param m[i] = 1 kg
      body b[i] { mass = m[i], moves x }
      spring s[i]: ground@P -- b[i]@(1 m, 0) { k = q }
      force F[i]: b[i] = harmonic(1 N, f) + harmonic(1 N, w)
    }";

#[test]
fn values_from_outside_take_the_place_of_declared_ones() {
    let scene = scene_with(
        SETTABLE,
        "n = 3\nk=12kN/m\nf=120 rpm\nm[2]=2*3 kg",
        "w = \"1 Hz\"\nk = \"1 N/m\"\n\"m[1]\" = '5 g'",
    );
    assert_eq!(scene.bodies.len(), 3);
    let masses: Vec<Option<Number>> = scene.bodies.iter().map(|body| body.mass.clone()).collect();
    assert_eq!(masses, [Some(exact("0.005")), Some(Number::from(6)), Some(Number::ONE)]);
    assert_eq!(scene.elements[0].law.spring(), Some((&Number::from(24_000), &SpringRest::AsDrawn)));
    let frequency = |signal: &Signal| match signal {
        Signal::Function(Function::Harmonic { frequency, .. }) => frequency.to_f64(),
        other => panic!("{other:?}"),
    };
    let frequencies: Vec<f64> = scene.inputs[0].signal.iter().map(frequency).collect();
    assert!((frequencies[0] - 2.0).abs() < 1e-15 && (frequencies[1] - 1.0).abs() < 1e-15, "{frequencies:?}");
}

#[test]
fn values_from_outside_are_checked_like_the_model() {
    let set = |line: &str| codes(&checked_with(SETTABLE, line, ""));
    assert_eq!(set("k=3 kg"), ["vib::unit::mismatch"]);
    assert_eq!(set("k=3"), ["vib::unit::mismatch"]);
    assert_eq!(set("k=3 Nmm"), ["vib::unit::unknown"]);
    assert_eq!(set("k=2*f"), ["vib::name::unknown"]);
    assert_eq!(set("k=1 N/m/0"), ["vib::number::division_by_zero"]);
    assert_eq!(set("f=3 /s"), ["vib::unit::frequency"]);
    assert_eq!(set("k=(1 m, 2 m)"), ["vib::value::kind"]);
    assert_eq!(set("k=="), ["vib::setting::form"]);
    assert_eq!(set("k="), ["vib::setting::form"]);
    assert_eq!(set("k"), ["vib::setting::form"]);
    assert_eq!(set("k+1=3"), ["vib::setting::form"]);
    assert_eq!(set("kk=3"), ["vib::setting::unknown"]);
    assert_eq!(set("m[7]=3 kg"), ["vib::setting::unknown"]);
    assert_eq!(set("q=3 N/m"), ["vib::setting::not_a_parameter"]);
    assert_eq!(set("P=3 N/m"), ["vib::setting::not_a_parameter"]);
    assert_eq!(set("k=0"), [""; 0]);
    let toml = |text: &str| codes(&checked_with(SETTABLE, "", text));
    assert_eq!(toml("n = 3\n# nothing\nk = '2 N/m'"), [""; 0]);
    assert_eq!(toml("k = 3 N/m"), ["vib::setting::toml"]);
    assert_eq!(toml("k = [1]"), ["vib::setting::form"]);
    assert_eq!(toml("[k]\na = 1"), ["vib::setting::unknown"]);
    assert_eq!(toml("k = \"3 \\u004e/m\""), ["vib::setting::form"]);
    assert_eq!(toml("k = inf"), ["vib::name::unknown"]);
}

// Bodies

#[test]
fn shapes_give_centre_and_inertia() {
    let body = |fields: &str| {
        let scene = scene(&format!("body b {{ {fields}, free }}"));
        (scene.bodies[0].inertia.as_deref().cloned(), scene.bodies[0].centre.as_deref().cloned())
    };
    let at = Vec3::planar(Number::from(2), Number::ZERO);
    assert_eq!(body("mass = 3 kg, shape = rod((1 m, 0), (3 m, 0))"), (Some(Number::ONE), Some(at.clone())));
    assert_eq!(body("mass = 2 kg, shape = disk(3 m), at = (2 m, 0)"), (Some(Number::from(9)), Some(at.clone())));
    assert_eq!(body("mass = 2 kg, shape = ring(3 m), at = (2 m, 0)"), (Some(Number::from(18)), Some(at.clone())));
    assert_eq!(body("mass = 12 kg, shape = box(3 m, 4 m)"), (Some(Number::from(25)), None));
}

#[test]
fn an_inertia_about_a_point_is_reduced_to_the_centre() {
    let inertia = |value: &str| {
        let text = format!("body b {{ mass = 3 kg, at = (0.4 m, 0.3 m), inertia = {value}, free }}");
        check_text(&text).scene.map(|scene| *scene.scene.bodies[0].inertia.clone().expect("an inertia"))
    };
    assert_eq!(inertia("0.8 kg*m^2 about (0, 0)"), Some(exact("0.05")));
    assert_eq!(inertia("0.75 kg*m^2 about (0, 0)"), Some(Number::ZERO));
    assert_eq!(inertia("0.74 kg*m^2 about (0, 0)"), None);
    assert_eq!(inertia("0.74 kg*m^2"), Some(exact("0.74")));
}

#[test]
fn degrees_of_freedom_require_mass_or_inertia() {
    let codes_of = |text: &str| codes(&check_text(text));
    assert_eq!(codes_of("body b { moves x }"), ["vib::mass::missing"]);
    assert_eq!(codes_of("body b { mass = 1 kg, free }"), ["vib::inertia::missing"]);
    assert_eq!(codes_of("body b { shape = disk(1 m), turns }"), ["vib::mass::missing"]);
    assert_eq!(codes_of("body b { mass = 1 kg }"), ["vib::body::no_freedom"]);
    assert_eq!(codes_of("body b { mass = 1 kg }\npivot p: ground@(0, 0) -- b"), ["vib::body::no_place"]);
    assert_eq!(codes_of("body b { at = (0, 0) }\npivot p: ground@(0, 0) -- b"), ["vib::mass::missing"]);
    // A joint that cannot be read is one mistake, of the syntax: the body that it holds is not said to lack one.
    let held = |line: &str| codes_of(&format!("body b {{ mass = 1 kg, shape = box(1 m, 1 m), at = (0, 0) }}\n{line}"));
    assert_eq!(held("pivot p: ground@(0, 0) -- b at (0, 0)"), [""; 0]);
    assert_eq!(held("pivvot p: ground@(0, 0) -- b"), [""; 0]);
    assert_eq!(held("spring s: ground -- b { k = 3 N/ }"), ["vib::body::no_freedom", "vib::unused::property"]);
    // A point mass on a pivot needs no inertia of its own, and a body that slides needs none at all.
    assert_eq!(codes_of("body b { mass = 1 kg, at = (0, -1 m) }\npivot p: ground@(0, 0) -- b"), [""; 0]);
    assert_eq!(codes_of("body b { mass = 1 kg }\nslide p: ground -- b along x"), [""; 0]);
}

#[test]
fn a_body_on_a_ground_pivot_may_have_its_inertia_only_there() {
    let hinged = "body b { inertia = 0.8 kg*m^2 about (0, 1 m) }\npivot p: ground@(0, 1 m) -- b\nspring t: ground -- b { k = 1 N*m/rad }";
    assert_eq!(scene(hinged).bodies[0].inertia, Some(Box::new(exact("0.8"))));
    // Gravity would pull at its centre; and about another point the mass counts.
    assert_eq!(codes(&check_text(&format!("gravity 9.81 m/s^2\n{hinged}"))), ["vib::mass::missing"]);
    assert_eq!(codes(&check_text(&hinged.replace("about (0, 1 m)", "about (0, 0)"))), ["vib::mass::missing"]);
}

#[test]
fn mass_without_a_degree_of_freedom_is_a_warning() {
    let codes_of = |text: &str| codes(&check_text(text));
    assert_eq!(codes_of("body b { mass = 1 kg, inertia = 1 kg*m^2, moves x }"), ["vib::unused::property"]);
    assert_eq!(codes_of("body b { mass = 1 kg, shape = disk(1 m), moves x }"), ["vib::unused::property"]);
    assert_eq!(codes_of("body b { mass = 1 kg, shape = rod((0, 0), (1 m, 0)), moves x }"), [""; 0]);
    assert_eq!(codes_of("body b { mass = 1 kg, inertia = 1 kg*m^2, turns }"), ["vib::unused::property"]);
    assert_eq!(codes_of("body b { mass = 1 kg, shape = disk(1 m), turns }"), [""; 0]);
    assert_eq!(
        codes_of("body b { mass = 1 kg, moves x }\nweld w: ground -- c\nbody c { mass = 1 kg }"),
        ["vib::unused::property"]
    );
    assert_eq!(codes_of("gravity 1 g0\nbody b { mass = 1 kg, moves x }"), ["vib::unused::gravity"]);
    assert_eq!(codes_of("gravity 1 g0\nbody b { mass = 1 kg, moves along (1, 1) }"), [""; 0]);
    assert_eq!(codes_of("param a = 1\nlet b = a\nbody c { mass = 1 kg, moves x }"), ["vib::unused::parameter"]);
}

#[test]
fn directions_of_motion_are_kept_as_drawn() {
    let translations = |clause: &str| match &scene(&format!("body b {{ mass = 1 kg, {clause} }}")).bodies[0].freedom {
        Freedom::OnGround { translations, .. } => {
            translations.iter().map(|t| (t.motion, t.direction.x.to_f64(), t.direction.y.to_f64())).collect::<Vec<_>>()
        }
        Freedom::FromJoints => panic!("a freedom clause"),
    };
    assert_eq!(translations("moves y x"), [("x", 1.0, 0.0), ("y", 0.0, 1.0)]);
    assert_eq!(translations("moves along (3, 4)"), [("along", 3.0, 4.0)]);
    assert_eq!(translations("moves along x"), [("x", 1.0, 0.0)]);
    assert_eq!(codes(&check_text("body b { mass = 1 kg, moves z }")), ["vib::body::freedom"]);
    assert_eq!(codes(&check_text("body b { mass = 1 kg, moves x x }")), ["vib::body::freedom"]);
}

// Joints

const TWO_RODS: &str = "body a { mass = 1 kg, shape = rod((0, 0), (0, -1 m)) }
    body b { mass = 1 kg, shape = rod((0, -1 m), (0, -2 m)) }
    pivot p: ground@(0, 0) -- a\n";

#[test]
fn the_ends_of_a_pivot_coincide() {
    let with = |line: &str| codes(&check_text(&format!("{TWO_RODS}{line}")));
    assert_eq!(with("pivot q: a@(0, -1 m) -- b"), [""; 0]);
    assert_eq!(with("pivot q: a -- b@(0, -1 m)"), [""; 0]);
    assert_eq!(with("pivot q: a@(0, -1 m) -- b@(0, -0.3 m - 0.7 m)"), [""; 0]);
    assert_eq!(with("pivot q: a@(0, -sqrt(2) * 1 m) -- b@(0, -1 m * 2^0.5)"), [""; 0]);
    assert_eq!(with("pivot q: a@(0, -1 m) -- b@(0, -1.0000000000000000001 m)"), ["vib::joint::ends_apart"]);
    assert_eq!(with("pivot q: a -- b"), ["vib::joint::ends_apart"]);
    assert_eq!(with("pivot q: ground -- b"), ["vib::joint::no_place"]);
    assert_eq!(with("pivot q: b@(0, 0) -- b@(0, 0)"), ["vib::joint::equal_ends"]);
    assert_eq!(with("weld q: a -- b"), [""; 0]);
    assert_eq!(with("weld q: a@(0, 0) -- b@(0, -1 m)"), ["vib::joint::ends_apart"]);
    assert_eq!(with("slide q: a -- b"), ["vib::joint::direction"]);
    assert_eq!(with("slide q: a -- b along (0, 0)"), ["vib::direction::zero"]);
    assert_eq!(with("slide q: a -- b along (0, 1)"), [""; 0]);
}

#[test]
fn a_pivot_without_points_is_where_both_parts_are() {
    let scene = scene(
        "body a { mass = 1 kg, at = (1 m, 2 m), moves x }
         body b { mass = 1 kg, inertia = 1 kg*m^2, at = (0.5 m + 0.5 m, 2 m) }
         pivot p: a -- b",
    );
    let place = Vec3::planar(Number::ONE, Number::from(2));
    assert_eq!(scene.joints[0].at.as_ref(), Some(&place));
    assert!(scene.joints[0].ends.iter().all(|end| end.at.as_deref() == Some(&place)));
}

// Springs and dampers

#[test]
fn the_geometry_of_an_element_follows_from_its_ends() {
    let geometry = |bodies: &str, line: &str| {
        let checked = check_text(&format!("{bodies}\n{line}"));
        let codes = codes(&checked);
        checked.scene.map(|scene| scene.scene.elements[0].law.geometry.clone()).ok_or(codes)
    };
    let along = |x: i64, y: i64| Ok(Geometry::Along(Arc::new(Vec3::planar(Number::from(x), Number::from(y)))));
    let x = "body a { mass = 1 kg, moves x }\nbody b { mass = 1 kg, moves x }\nbase f { moves x }\nbase g { moves y }";
    assert_eq!(geometry(x, "spring s: a -- b { k = 1 N/m }"), along(1, 0));
    assert_eq!(geometry(x, "spring s: ground -- b { k = 1 N/m }"), along(1, 0));
    assert_eq!(geometry(x, "damper s: f -- b { c = 1 N*s/m }"), along(1, 0));
    assert_eq!(geometry(x, "spring s: g -- b { k = 1 N/m }"), Err(vec!["vib::element::direction_unknown"]));
    assert_eq!(geometry(x, "spring s: ground -- b { k = 1 N/m, along = (1, 2) }"), along(1, 2));
    assert_eq!(geometry(x, "spring s: ground@(1 m, 0) -- b@(0, 0) { k = 1 N/m }"), Ok(Geometry::Line));
    assert_eq!(geometry(x, "spring s: ground@(1 m, 0) -- b@(1 m, 0) { k = 1 N/m }"), along(1, 0));
    assert_eq!(geometry(x, "spring s: ground@(1 m, 0) -- b { k = 1 N/m }"), along(1, 0));
    let oblique = "body a { mass = 1 kg, moves along (1, 1) }\nbody b { mass = 1 kg, moves along (-2, -2) }";
    assert_eq!(geometry(oblique, "spring s: a -- b { k = 1 N/m }"), along(1, 1));
    let plane = "body a { mass = 1 kg, at = (0, 0), moves x y }";
    assert_eq!(geometry(plane, "spring s: ground@(0, 0) -- a { k = 1 N/m }"), Err(vec!["vib::element::zero_length"]));
    assert_eq!(geometry(plane, "spring s: ground -- a { k = 1 N/m }"), Err(vec!["vib::element::direction_unknown"]));
    let turning = "body a { inertia = 1 kg*m^2, turns }";
    assert_eq!(geometry(turning, "spring s: ground -- a { k = 3 N*m/rad }"), Ok(Geometry::Torsion));
    assert_eq!(geometry(turning, "damper s: ground -- a { c = 3 N*m*s/rad }"), Ok(Geometry::Torsion));
    assert_eq!(geometry(plane, "spring s: ground -- a { k = 3 N*m }"), Err(vec!["vib::element::no_end_turns"]));
}

#[test]
fn joints_pass_lines_and_turning_on() {
    let on_slides = "body a { mass = 1 kg }\nslide g: ground -- a along (0, 1)
        body b { mass = 1 kg }\nslide h: a -- b along (0, 2)\nbody c { mass = 1 kg }\nweld w: b -- c\n";
    let scene = scene(&format!("{on_slides}spring s: a -- c {{ k = 1 N/m }}"));
    assert!(matches!(&scene.elements[0].law.geometry, Geometry::Along(line) if !line.y.is_zero() && line.x.is_zero()));
    let torsional = format!("{on_slides}spring s: a -- c {{ k = 1 N*m/rad }}");
    assert_eq!(codes(&check_text(&torsional)), ["vib::element::no_end_turns"]);
    let on_a_rod = "body r { mass = 1 kg, shape = rod((0, 0), (0, -1 m)) }\npivot p: ground@(0, 0) -- r
        body s { mass = 1 kg, at = (0, -1 m), inertia = 1 kg*m^2 }\nslide g: r -- s along (0, 1)\n";
    assert_eq!(codes(&check_text(&format!("{on_a_rod}spring t: ground -- s {{ k = 1 N*m/rad }}"))), [""; 0]);
    assert_eq!(
        codes(&check_text(&format!("{on_a_rod}spring t: ground -- s {{ k = 1 N/m }}"))),
        ["vib::element::direction_unknown"]
    );
}

#[test]
fn a_spring_has_a_free_length_or_a_preload() {
    let rest = |fields: &str| {
        let text = format!(
            "body a {{ mass = 1 kg, at = (0, 0), moves x }}\nspring s: ground@(-1 m, 0) -- a {{ k = 1 N/m{fields} }}"
        );
        let checked = check_text(&text);
        let codes = codes(&checked);
        checked.scene.map(|scene| scene.scene.elements[0].law.rest.clone()).ok_or(codes)
    };
    assert_eq!(rest(""), Ok(SpringRest::AsDrawn));
    assert_eq!(rest(", free_length = 50 cm"), Ok(SpringRest::FreeLength(exact("0.5"))));
    assert_eq!(rest(", preload = -3 N"), Ok(SpringRest::Preload(Number::from(-3))));
    assert_eq!(rest(", preload = 0"), Ok(SpringRest::Preload(Number::ZERO)));
    assert_eq!(rest(", free_length = -1 m"), Err(vec!["vib::value::negative"]));
    assert_eq!(rest(", preload = 3 m"), Err(vec!["vib::unit::mismatch"]));
}

// Inputs, outputs, couplings, states

#[test]
fn inputs_come_in_order_with_a_base_for_each_motion() {
    let scene = scene(
        "body a { mass = 1 kg, at = (0, 0), free, inertia = 1 kg*m^2 }
         force F: a along (0, 2) = harmonic(1 N, 2 Hz, 90 deg) + step(1 N, 0 s)
         base f { moves x y, turns, at = (0, 0) }
         torque T: a -- ground
         force G: a -- ground@(1 m, 0)",
    );
    let names: Vec<String> = scene.inputs.iter().map(|input| scene.words.display(input.name)).collect();
    assert_eq!(names, ["F", "f", "f", "f", "T", "G"]);
    assert_eq!(scene.inputs[0].signal.len(), 2);
    assert!(matches!(scene.inputs[0].signal[1], Signal::Function(Function::Step { .. })));
    assert!(matches!(scene.inputs[3].kind, InputKind::Base { translation: None, .. }));
    assert!(matches!(&scene.inputs[4].kind, InputKind::Torque { ends } if ends.len() == 2));
    assert!(matches!(scene.inputs[5].kind, InputKind::ForceBetween { .. }));
}

#[test]
fn a_force_between_parts_of_one_line_pushes_them_apart() {
    let scene = scene("body a { mass = 1 kg, moves x }\nbody b { mass = 1 kg, moves x }\nforce F: a -- b\nforce G: b");
    let InputKind::Force { ends, direction } = &scene.inputs[0].kind else { panic!("a force along a line") };
    assert_eq!(*direction, Vec3::X);
    assert_eq!([ends[0].part, ends[1].part], [1, 0].map(|id| Part::Body(BodyId(id))));
    assert!(matches!(&scene.inputs[1].kind, InputKind::Force { ends, .. } if ends.len() == 1));
}

#[test]
fn signals_have_the_dimension_of_their_input() {
    let with = |line: &str| {
        codes(&check_text(&format!("body a {{ mass = 1 kg, at = (0, 0), free, inertia = 1 kg*m^2 }}\n{line}")))
    };
    for (line, expected) in [
        ("force F: a along x = impulse(1 N*s, 0 s)", None),
        ("force F: a along x = impulse(1 N, 0 s)", Some("vib::unit::mismatch")),
        ("torque T: a = ramp(1 N*m, 0 s, 1 s)", None),
        ("torque T: a = ramp(1 N, 0 s, 1 s)", Some("vib::unit::mismatch")),
        ("base f { moves x } = chirp(1 mm, 1 Hz, 2 Hz, 1 s)", None),
        ("base f { turns } = pulse(1 deg, 0 s, 1 s)", None),
        ("base f { turns } = pulse(1 m, 0 s, 1 s)", Some("vib::unit::mismatch")),
        ("force F: a along x = pulse(1 N, 1 s, 1 s)", Some("vib::signal::times")),
        ("force F: a along x = table(\"a.csv\")", None),
        ("force F: a along x = 3 N", Some("vib::signal::unknown")),
        ("force F: a along x = steps(3 N, 0 s)", Some("vib::signal::unknown")),
        ("force F: a along x = step(3 N)", Some("vib::signal::arguments")),
        ("force F: a along x = constant(3 N)", None),
    ] {
        assert_eq!(with(line), expected.into_iter().collect::<Vec<_>>(), "{line}");
    }
}

#[test]
fn outputs_are_linear_combinations_of_motions() {
    let scene = scene(
        "param r = 0.5 m
         body a { mass = 1 kg, at = (0, 0), free, inertia = 1 kg*m^2 }
         base f { moves x }
         spring s: f@(-1 m, 0) -- a { k = 1 N/m }
         output o = 2*(a.x - f.x)/4 + r * -a@(0, 1 m).angle
         output p = s.force / 1 N
         output q = a.alpha",
    );
    let coefficients: Vec<f64> = scene.outputs[0].terms.iter().map(|term| term.coefficient.to_f64()).collect();
    assert_eq!(coefficients, [0.5, -0.5, -0.5]);
    assert_eq!((scene.outputs[0].dimension, scene.outputs[0].is_angle), (Dimension::LENGTH, false));
    assert_eq!((scene.outputs[1].dimension, scene.outputs[1].is_angle), (Dimension::NONE, false));
    assert!(scene.outputs[2].is_angle);
}

#[test]
fn nonlinear_combinations_are_refused() {
    let with = |expression: &str| {
        let model =
            "body a { mass = 1 kg, at = (0, 0), moves x }\nspring s: ground -- a { k = 1 N/m }\nforce F: a along x";
        codes(&check_text(&format!("{model}\noutput o = {expression}")))
    };
    for (expression, code) in [
        ("a.x * a.x", "vib::motion::non_linear"),
        ("1 m^2 / a.x", "vib::motion::non_linear"),
        ("a.x + 1 m", "vib::motion::non_linear"),
        ("sin(a.x / 1 m)", "vib::motion::non_linear"),
        ("a.x^2", "vib::motion::non_linear"),
        ("a.x + a.vx", "vib::unit::mismatch"),
        ("a.x / 0", "vib::number::division_by_zero"),
        ("a.y", "vib::motion::impossible"),
        ("a.omega", "vib::motion::impossible"),
        ("a.velocity", "vib::motion::unknown"),
        ("s.x", "vib::motion::unknown"),
        ("F.x", "vib::part::kind"),
        ("b.x", "vib::part::unknown"),
        ("a@(0, 0)", "vib::motion::none"),
        ("3 m", "vib::motion::none"),
    ] {
        assert_eq!(with(expression), [code], "{expression}");
    }
    assert_eq!(with("a.x + 0"), [""; 0]);
}

#[test]
fn couplings_and_initial_states_are_checked() {
    let model = "body a { mass = 1 kg, moves x }\nbody w { inertia = 1 kg*m^2, turns }\nbase f { moves x }\n";
    let with = |line: &str| codes(&check_text(&format!("{model}{line}")));
    assert_eq!(with("couple r: w.angle = -a.x / 0.3 m"), [""; 0]);
    assert_eq!(with("couple r: a.x - f.x = 0"), [""; 0]);
    assert_eq!(with("couple r: w.angle = a.x"), ["vib::unit::mismatch"]);
    assert_eq!(with("couple r: a.x = 1 m"), ["vib::motion::non_linear"]);
    assert_eq!(with("couple r: a.vx = 0"), ["vib::couple::motions"]);
    assert_eq!(with("couple r: f.x = 0"), ["vib::couple::motions"]);
    assert_eq!(with("initial a { x = 16 mm, vx = 0.375 m/s }"), [""; 0]);
    assert_eq!(with("initial w { angle = 2 deg, omega = 3 rad/s }"), [""; 0]);
    assert_eq!(with("initial a { x = 16 s }"), ["vib::unit::mismatch"]);
    assert_eq!(with("initial a { y = 16 mm }"), ["vib::motion::impossible"]);
    assert_eq!(with("initial a { z = 16 mm }"), ["vib::field::unknown"]);
    assert_eq!(with("initial f { x = 16 mm }"), ["vib::part::kind"]);
    assert_eq!(with("initial a { x = 1 mm }\ninitial a { vx = 1 m/s }"), ["vib::setting::duplicate"]);
}

// `solve`, `require`, settings

#[test]
fn measures_are_checked_in_names_and_units() {
    let model = "param k = 1 N/m\nbody a { mass = 1 kg, moves y }\nbase f { moves y }\nspring s: f -- a { k = k }
        force F: a\noutput o = a.y\n";
    let with = |line: &str| codes(&check_text(&format!("{model}{line}")));
    for line in [
        "require stable",
        "require frequency(1) > 2 Hz",
        "require 2 rad/s <= frequency(1)",
        "require damping(1) >= 5 %",
        "require gain(f -> o, 30 Hz) <= -10 dB",
        "require gain(F -> a.y - f.y, 30 Hz) < 2 mm/N",
        "require phase(f -> a.y, 60 rpm) > -90 deg",
        "require amplitude(s.force) < 3 N",
        "require peak(a.ay) < 0.003 g0",
        "require static(o) < 1 mm",
        "require rms(o) < 1 mm",
        "require frequency(1) + 1 Hz > 2 Hz",
        "require 1 Hz < frequency(1) <= 5 Hz",
        "require peak_gain(F -> o) < 2 mm/N",
        "require 2 * peak_gain(F -> o, 1 Hz .. 5 Hz) < 2 mm/N",
        "require peak(o) < rms(o) + 1 mm",
        "require rest(s.tension) < 2 N",
        "solve k in 1 N/m .. 20 N/m: frequency(1) = 2 Hz",
        "rest as drawn",
        "damping modal 2 %",
        "damping rayleigh(0.1 /s, 1e-4 s)",
        "require load_factor > 2",
        "require 3 > load_factor / 2 > 1",
    ] {
        assert_eq!(with(line), [""; 0], "{line}: {}", messages(&check_text(&format!("{model}{line}"))));
    }
    for (line, code) in [
        ("require frequency(1) > 2 m", "vib::unit::mismatch"),
        ("require frequency(1) > 2 /s", "vib::unit::frequency"),
        ("require frequency(0) > 2 Hz", "vib::measure::mode"),
        ("require frequency(1.5) > 2 Hz", "vib::index::not_whole"),
        ("require frequency(1)", "vib::require::form"),
        ("require frequency(1) + 1 m > 2 Hz", "vib::unit::mismatch"),
        ("require peak_gain(F -> o, 5 Hz .. 1 Hz) < 2 mm/N", "vib::solve::range"),
        ("require peak_gain(F -> o, 5 Hz) < 2 mm/N", "vib::value::kind"),
        ("require rest(s.force) < 2 N", "vib::motion::unknown"),
        ("require peak(s.tension) < 2 N", "vib::motion::unknown"),
        ("require rest(a.vy) < 2 m/s", "vib::measure::arguments"),
        ("require stable > 1", "vib::require::form"),
        ("require gain(F -> o, 30 Hz) < 2", "vib::unit::missing"),
        ("require gain(o, 30 Hz) < 2", "vib::measure::arguments"),
        ("require gain(a -> o, 30 Hz) < 2", "vib::measure::input"),
        ("require gain(f -> s, 30 Hz) < 2", "vib::measure::output"),
        ("require gain(f -> a.z, 30 Hz) < 2", "vib::motion::unknown"),
        ("require peek(o) < 2 mm", "vib::measure::unknown"),
        ("solve q in 1 N/m .. 2 N/m: frequency(1) = 2 Hz", "vib::name::unknown"),
        ("solve k in 1 N/m .. 2 kg: frequency(1) = 2 Hz", "vib::unit::mismatch"),
        ("solve k in 3 N/m .. 2 N/m: frequency(1) = 2 Hz", "vib::solve::range"),
        ("solve k in 1 N/m .. 2 N/m: frequency(1) = 2 kg", "vib::unit::mismatch"),
        ("damping modal 2 s", "vib::unit::mismatch"),
        ("damping rayleigh(1 /s)", "vib::function::arguments"),
        ("gravity 9.81 m/s", "vib::unit::mismatch"),
        ("gravity (0, 9.81 m)", "vib::unit::mismatch"),
    ] {
        assert_eq!(with(line), [code], "{line}: {}", messages(&check_text(&format!("{model}{line}"))));
    }
}

#[test]
fn a_base_with_several_motions_is_named_with_one() {
    let model = "body a { mass = 1 kg, at = (0, 0), moves y }\nbase f { moves x y }\nspring s: f -- a { k = 1 N/m, along = y }\n";
    let with = |line: &str| codes(&check_text(&format!("{model}{line}")));
    assert_eq!(with("require gain(f -> a.y, 1 Hz) < 2"), ["vib::measure::input"]);
    assert_eq!(with("require gain(f.y -> a.y, 1 Hz) < 2"), [""; 0]);
}

#[test]
fn a_scene_without_bodies_is_empty() {
    assert_eq!(codes(&check_text("")), ["vib::scene::empty"]);
    assert_eq!(codes(&check_text("// nothing\n")), ["vib::scene::empty"]);
    assert_eq!(codes(&check_text("gravity 9.81 m/s^2\nparam k = 3 N/m")), ["vib::scene::empty"]);
}

#[test]
fn renaming_and_reordering_do_not_change_the_scene() {
    let forwards = scene("param m = 2 kg\nbody a { mass = m, moves x }\nspring s: ground -- a { k = 4 N/m }");
    let backwards = scene("spring t: ground -- b { k = 4 N/m }\nbody b { mass = n, moves x }\nparam n = 2 kg");
    assert_eq!(forwards.bodies[0].mass, backwards.bodies[0].mass);
    assert_eq!(forwards.elements[0].law.geometry, backwards.elements[0].law.geometry);
}

/// One mistake is one finding, and the name still means something where it is used.
#[test]
fn a_place_and_a_value_of_one_name_are_reported_once() {
    let cell = "component cell(m: kg) {\nbody b { mass = m, moves x }\nspring s: ground -- b { k = 1 N/m }\n}\n";
    let both = ["place k[i] = cell(m = 1 kg)", "param k[i] = 3"];
    for [first, second] in [[0, 1], [1, 0]] {
        let declared = format!("{cell}repeat i in 1..1 {{\n{}\n{}\n}}\n", both[first], both[second]);
        assert_eq!(codes(&check_text(&declared)), ["vib::name::duplicate"], "{declared}");
        let used = format!("{declared}let w = k[1] * k[2]\noutput u = k[2].b.x\n");
        let found = codes(&check_text(&used));
        assert_eq!(found[..2], ["vib::name::duplicate", "vib::name::index"], "{used}");
    }
}
