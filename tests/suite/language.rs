//! Parsing, names and units, limits.

use vibc::base::{SourceFile, Sources};
use vibc::syntax::{self, Parsed};

fn parse(text: &str) -> (Sources, Parsed) {
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model("model.vib", text));
    let parsed = syntax::parse(&sources, file);
    (sources, parsed)
}

/// Every form of the language, each on its own line or lines.
const FORMS: &str = r#"
model cart                                   // optional; else the file's name
param k = 10 N/m                             // a number, overridable
let   w = sqrt(k / m1)                       // derived
gravity 9.81 m/s^2
gravity (0, -9.81 m/s^2)
point A = (0, 0)
body block { mass = 1 kg, moves x }
body rod   { mass = 0.5 kg, shape = rod(A, (0, -2 m)) }
body wheel { mass = 2 kg, at = (0, 1 m), shape = disk(0.3 m), turns }
body arm   { mass = 3 kg, inertia = 0.8 kg*m^2 about A, at = (0.4 m, 0) }
body slug  { mass = 3 kg, moves along (1, 1) }
body all   {
    mass = 3 kg // a line each
    moves x y

    free,
}
pivot  p: block@A -- rod
slide  g: arm -- slug along (1, 0)
weld   w: block -- box
couple r: wheel.angle = -block.x / 0.3 m
spring s: ground@(-0.5 m, 0) -- block@A { k = 10 N/m, free_length = 0.5 m }
spring t: ground -- rod { k = 3 N*m/rad }
spring v: ground -- block { k = 5 N/m, along = x }
damper d: ground@(-0.5 m, 0) -- block@A { c = 5 N*s/m }
base  floor { moves y }
base  table { moves y } = harmonic(1 mm, 30 Hz)
base  plate { moves y, y = harmonic(1 mm, 30 Hz) }
force  F: block@A along x
force  H: block@A -- rod
torque T: rod
torque U: rod -- block = step(1 N*m, 0 s)
force  G: block along x = harmonic(10 N, 1.5 Hz)
force  W: block along (1, 0) = table("file.csv") + constant(3 N)
initial block { x = 16 mm, vx = 0.375 m/s }
output  theta = rod.angle
output  tip   = rod@(0, -2 m).x
output  pull  = s.force
damping modal 2 %
damping rayleigh(0.1 /s, 1e-4 s)
rest as drawn
repeat i in 2..100 {
  body   m[i] { mass = 1 kg, moves x }
  spring k[i]: m[i-1] -- m[i] { k = 100 N/m }
  repeat j in 1..i { body n[i][j] { mass = 1 kg }
    body p[i, j] { turns } }
}
repeat i in 1 .. n { body q[i] { free } }
solve fn in 5 Hz .. 29 Hz: gain(floor -> table.y, 30 Hz) = -12 dB
require frequency(1) > 2 Hz
require gain(floor -> table.y, 30 Hz) <= -10 dB
require stable
"#;

#[test]
fn every_form_of_the_language_parses() {
    let (sources, parsed) = parse(FORMS);
    let errors: Vec<_> =
        parsed.errors.iter().map(|e| format!("{} {:?}", e.message, sources.slice(e.primary.span))).collect();
    assert!(errors.is_empty(), "{errors:#?}");
    assert_eq!(parsed.tree.decls.len(), 42);
}

/// The only finding of a mistake.
fn messages(text: &str) -> Vec<String> {
    let (sources, parsed) = parse(text);
    let tell = |d: &vibc::base::Diagnostic| {
        let place = sources.positions(d.primary.span).0;
        let related: String =
            d.related.iter().map(|l| format!("; {} at {:?}", l.text, sources.slice(l.span))).collect();
        format!(
            "{}:{} {}: {}{related} ({})",
            place.line,
            place.column,
            d.code,
            d.message,
            d.help.as_deref().unwrap_or("")
        )
    };
    parsed.errors.into_sorted().iter().map(tell).collect()
}

const MISTAKES: &[&str] = &[
    "param k 10 N/m",
    "param k = ",
    "param k",
    "param",
    "param=3",
    "param 2k = 1",
    "param left-wheel = 1",
    "param länge = 1 m",
    "param k = 10  N/m",
    "param k = 10 20",
    "param k = a b",
    "param k = 2**3",
    "param k = +3",
    "param k = 3 +",
    "param k = 10 −3",
    "param k = a²",
    "param k = 3;",
    "param k = 3 # comment",
    "param k = sqrt (2)",
    "param k = m [1]",
    "param k = 1, j = 2",
    "param a = 1 m  param b = 2",
    "parm k = 3",
    "Param k = 3",
    "k = 3",
    "s: ground -- block { k = 1 N/m }",
    "hinge p: a -- b",
    "xyzzy foo",
    "point A = 0, 0",
    "point A (0, 0)",
    "spring s ground -- block { k = 1 N/m }",
    "spring s: ground block { k = 1 N/m }",
    "spring s: ground - block { k = 1 N/m }",
    "spring s: ground -> block { k = 1 N/m }",
    "spring s: ground -- { k = 1 N/m }",
    "spring s: ground@A + (0, 1) -- block { k = 1 N/m }",
    "spring s: ground -- block",
    "spring s: ground -- block k = 1 N/m",
    "spring s: ground -- block\n{ k = 1 N/m }",
    "body b\n{\n  mass = 1 kg\n  moves x\n}\nparam z = 1",
    "body b\n  mass = 1 kg\n  moves x\n}\nparam z = 1",
    "body b mass = 1 kg, moves x }",
    "body b { mass = 1 kg, moves x",
    "body b { mass = 1 kg, moves x\nparam z = 1",
    "body b { mass = (1 kg, moves x }",
    "body b { mass = 1 kg) }",
    "body b { mass 1 kg }",
    "body b { mass: 1 kg }",
    "body b { mass = 1 kg moves x }",
    "body b { mass = 1 kg; moves x }",
    "body b { mass = 1 kg, moves }",
    "body b { mass = 1 kg, , moves x }",
    "body b { shape rod(A, B) }",
    "body b { = 3 }",
    "body b { mass = 1 kg } moves x",
    "body b {\n  spring s: ground -- b { k = 1 N/m }\n}",
    "gravity",
    "gravity9.81",
    "damping 2 %",
    "damping",
    "rest",
    "rest as shown",
    "solve k = 3",
    "solve k in 1: stable = 1",
    "solve k in 1 .. 2: frequency(1)",
    "require",
    "require a = b",
    "repeat i in 1 to 3 {\n  param a[i] = 1\n}",
    "repeat i in 1..3\n{\n  param a[i] = 1\n}",
    "repeat i in 1..3\n  param a[i] = 1\n}",
    "repeat i in 1..3 {\n  param a[i] = 1",
    "repeat i in 1..3 {\n  body m[i] { moves x\n}",
    "repeet i in 1..3 {\n  param a[i] = 1\n}",
    "for i in 1..3 {\n  param a[i] = 1\n}",
    "repeat i in 1..3 { param a[i] = 1 } param b = 2",
    "force F: block along",
    "force F: block = table(\"x.csv)",
    "force F: block = table('x.csv')",
    "output y = block.",
    "output y = gain(a -> b 3)",
    "param k = (1 + 2",
    "param k = 1 + 2)",
    "}",
    "param k = \u{7}3",
    "// \u{202e}reversed",
    "param k = 3 \u{a0}+ 4",
    "param a = 1\rparam b = 2",
    "couple r: a.x",
    "pivot p: a -- b along x",
    "model my cart",
    "output x == b.x",
    "initial b x = 1",
    "param k = 3 m)",
    "param k = 3 @ 4",
    "10 N/m",
    "{ mass = 1 kg }",
    "damping rayleigh(0.05 1/s, 0.001 s)",
    "model \"my first\"",
    "force F: b along x = noise(wite 3 N^2/Hz)",
    "param m = 2 t spred 2 %",
    "param m = 2 withn 5 %",
    "param m = 2 t spread lognorml 15 %",
    "param m = 2 t spread uniform 3 %",
    "param m = 2 t within",
    "body b { mass = 1,5 kg }",
    "param k = 1,5 N/m",
    "param k = 1.000,5 N/m",
    "spring s: ground – b { k = 9 N/m }",
];

#[test]
fn one_mistake_gives_one_error_that_says_what_to_type() {
    let mut table = String::new();
    for mistake in MISTAKES {
        let messages = messages(mistake);
        table += &format!("{mistake}\n    {}\n", messages.join("\n    "));
        assert_eq!(messages.len(), 1, "{mistake}: {messages:#?}");
    }
    insta::assert_snapshot!(table);
}
