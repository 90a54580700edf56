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
