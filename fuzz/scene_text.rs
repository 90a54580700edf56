//! Bytes to models: every byte string becomes a text that is nearly a good one, so that a fuzzer gets past the parser and
//! plays with the mechanics. A few names that are used again and again, mostly right units, now and then a number or a
//! word that is wrong on purpose.

use std::fmt::Write;

/// Choices read from bytes; the first of each list once they run out.
struct Choices<'a> {
    bytes: &'a [u8],
}

impl Choices<'_> {
    fn below(&mut self, n: usize) -> usize {
        let Some((first, rest)) = self.bytes.split_first() else { return 0 };
        self.bytes = rest;
        usize::from(*first) % n
    }

    fn of<'t>(&mut self, list: &[&'t str]) -> &'t str {
        list[self.below(list.len())]
    }

    /// One time in `n`, and never once the bytes run out.
    fn rarely(&mut self, n: usize) -> bool {
        self.below(n) == n - 1
    }
}

const NUMBERS: [&str; 24] = [
    "1",
    "2.5",
    "0.3",
    "40",
    "1e3",
    "7",
    "0",
    "-1",
    "1e-3",
    "1e6",
    "1e-9",
    "1e12",
    "1e30",
    "1e-30",
    "1e200",
    "1e-200",
    "1e308",
    "9.81",
    "123456.789",
    "-0.25",
    "3e-320",
    "1e400",
    "0.1000000000000000000000001",
    "99999999999999999999",
];

const BODIES: [&str; 6] = ["a", "b", "c", "d", "m[1]", "m[2]"];

/// A model from bytes: by the first of them a careless one, in which anything may be wrong, or a careful one, in which only
/// the mechanics may be (points that coincide, masses and stiffnesses of any size, loops, nothing that holds a body).
pub fn text_of(bytes: &[u8]) -> String {
    let mut choices = Choices { bytes };
    let mut text = String::new();
    if choices.below(4) == 0 {
        while !choices.bytes.is_empty() {
            declaration(&mut choices, &mut text);
            text.push('\n');
        }
    } else {
        careful(&mut choices, &mut text);
    }
    text
}

fn careful(c: &mut Choices, text: &mut String) {
    if c.below(3) > 0 {
        text.push_str("gravity 9.81 m/s^2\n");
    }
    // Bodies are b0, b1, ...; `turning[i]` says whether a torque on b_i means anything.
    let mut turning: Vec<bool> = Vec::new();
    let mut n = 0;
    while !c.bytes.is_empty() && n < 60 {
        n += 1;
        if turning.is_empty() || (turning.len() < 8 && c.below(3) == 0) {
            careful_body(c, text, &mut turning);
        } else {
            careful_part(c, text, &turning, n);
        }
    }
}

/// A point of a small grid: many coincide or lie in line.
fn grid(c: &mut Choices) -> String {
    let axis = ["0", "1 m", "-1 m", "2 m", "0.5 m", "1 m / 3", "sqrt(2) * 1 m"];
    format!("({}, {})", c.of(&axis), c.of(&axis))
}

/// A point that is rarely one of the grid.
fn outside(c: &mut Choices) -> String {
    if c.rarely(12) {
        return grid(c);
    }
    let axis = ["3 m", "-3 m", "2.5 m", "pi * 1 m", "-2 m"];
    format!("({}, {})", c.of(&axis), c.of(&axis))
}

fn positive(c: &mut Choices) -> &'static str {
    if c.rarely(10) {
        c.of(&["1e-9", "1e12", "1e30", "1e-30", "1e-200", "1e150", "1e-12", "1e300"])
    } else {
        c.of(&["1", "2", "0.5", "3.7", "40", "1000", "0.01"])
    }
}

fn careful_body(c: &mut Choices, text: &mut String, turning: &mut Vec<bool>) {
    let i = turning.len();
    let (mass, inertia, at) = (positive(c), positive(c), grid(c));
    let clause =
        c.of(&["", "", "", ", moves x", ", moves y", ", moves x y", ", turns", ", free", ", moves along (1, 1)"]);
    let _ = writeln!(text, "body b{i} {{ mass = {mass} kg, inertia = {inertia} kg*m^2, at = {at}{clause} }}");
    if clause.is_empty() {
        let other = earlier(c, i);
        let joint = match c.below(6) {
            0 => format!("slide j{i}: {other} -- b{i} along {}", c.of(&["(1, 0)", "(0, 1)", "(3, 4)", "(1, -1)"])),
            1 => format!("weld j{i}: {other} -- b{i}"),
            _ => format!("pivot j{i}: {other}@{} -- b{i}", grid(c)),
        };
        text.push_str(&joint);
        text.push('\n');
    }
    turning.push(clause.is_empty() || clause.contains("turns") || clause.contains("free"));
}

/// The ground or a body before number `i`.
fn earlier(c: &mut Choices, i: usize) -> String {
    match c.below(i + 1) {
        0 => "ground".into(),
        n => format!("b{}", n - 1),
    }
}

fn careful_part(c: &mut Choices, text: &mut String, turning: &[bool], n: usize) {
    let b = c.below(turning.len());
    let other = earlier(c, b);
    let (sign, size) = (if c.rarely(8) { "-" } else { "" }, positive(c));
    let line = match c.below(16) {
        0..=3 => {
            format!("spring s{n}: {other}@{} -- b{b}@{} {{ k = {sign}{size} N/m{} }}", outside(c), grid(c), loaded(c))
        }
        4 => {
            format!("spring s{n}: {other} -- b{b} {{ k = {sign}{size} N/m, along = {} }}", c.of(&["x", "y", "(1, 2)"]))
        }
        5 if turning[b] => format!("spring s{n}: {other} -- b{b} {{ k = {sign}{size} N*m/rad }}"),
        6 if turning[b] => format!("damper s{n}: {other} -- b{b} {{ c = {size} N*m*s/rad }}"),
        7 | 8 => format!("damper s{n}: {other}@{} -- b{b}@{} {{ c = {size} N*s/m }}", outside(c), grid(c)),
        9 => format!(
            "force s{n}: b{b}@{} along {}{}",
            grid(c),
            c.of(&["x", "y", "(3, 4)"]),
            c.of(&["", " = constant(2 N)"])
        ),
        10 => format!("output s{n} = b{b}@{}.{}", grid(c), c.of(&["x", "vy", "ax"])),
        11 => format!("damper s{n}: {other} -- b{b} {{ c = {size} N*s/m, along = x }}"),
        12 if c.rarely(3) => format!("pivot s{n}: {other}@{} -- b{b}", grid(c)),
        _ => format!("spring s{n}: ground@{} -- b{b}@{} {{ k = {size} N/m{} }}", outside(c), grid(c), loaded(c)),
    };
    text.push_str(&line);
    text.push('\n');
}

fn loaded(c: &mut Choices) -> &'static str {
    c.of(&[
        "",
        "",
        ", preload = 3 N",
        ", preload = -20 N",
        ", free_length = 1 m",
        ", free_length = 0.2 m",
        ", free_length = 10 m",
    ])
}

fn declaration(c: &mut Choices, text: &mut String) {
    let n = c.below(10);
    let line = match c.below(25) {
        0..=5 => body(c),
        6..=10 => spring(c, n),
        11 | 12 => damper(c, n),
        13 | 14 => format!("pivot j{n}: {} -- {}", end(c), end(c)),
        15 => format!("slide j{n}: {} -- {} along {}", end(c), end(c), direction(c)),
        16 => format!("weld j{n}: {} -- {}", end(c), end(c)),
        17 => c.of(&["gravity 9.81 m/s^2", "gravity (1 m/s^2, -2 m/s^2)", "gravity 0", "gravity 1e9 m/s^2"]).into(),
        18 => format!("param p{} = {}", n % 3, value(c, "m")),
        19 => format!("point P{} = {}", n % 3, point(c)),
        20 => input(c, n),
        21 => format!("output y{n} = {}", motion(c)),
        22 => repeat(c),
        23 => rare(c, n),
        _ => format!(
            "base f{} {{ {} }}",
            n % 2,
            c.of(&["moves x", "moves y", "moves x y", "turns", "free", "moves x, at = (0, 1 m)"])
        ),
    };
    text.push_str(&line);
}

fn number(c: &mut Choices) -> &'static str {
    let rare = c.rarely(8);
    NUMBERS[c.below(if rare { NUMBERS.len() } else { 6 })]
}

/// A number with its unit, a parameter, an expression; rarely with a wrong unit.
fn value(c: &mut Choices, unit: &str) -> String {
    let number = number(c);
    match c.below(12) {
        0 => format!("2 * {number} {unit}"),
        1 => format!("{number} {unit} + 1 {unit}"),
        2 => format!("p{} * 1 {unit} / 1 m", c.below(3)),
        3 => format!("{number} {unit} * sqrt(2)"),
        4 if c.rarely(4) => format!("{number} {}", c.of(&["kg", "", "Hz", "mm", "furlong"])),
        5 => format!("{number} {unit} * cos(30 deg)"),
        _ => format!("{number} {unit}"),
    }
}

fn point(c: &mut Choices) -> String {
    match c.below(8) {
        0 => "(0, 0)".into(),
        1 => "(1 m, 0)".into(),
        2 => "(0, -1 m)".into(),
        3 => "P0".into(),
        4 => "(P1 + (0, 1 m))".into(),
        5 => "P2".into(),
        _ => format!("({}, {})", value(c, "m"), value(c, "m")),
    }
}

fn direction(c: &mut Choices) -> String {
    match c.below(6) {
        0 => "(1, 0)".into(),
        1 => "(0, 1)".into(),
        2 => "(3, 4)".into(),
        3 => "(1, 1)".into(),
        4 => "(0, 0)".into(),
        _ => format!("({}, {})", number(c), number(c)),
    }
}

fn part(c: &mut Choices) -> &'static str {
    match c.below(9) {
        0 | 1 => "ground",
        8 => c.of(&["f0", "f1", "nobody"]),
        n => BODIES[(n - 2) % BODIES.len()],
    }
}

fn end(c: &mut Choices) -> String {
    let part = part(c);
    if c.below(2) == 0 { part.into() } else { format!("{part}@{}", point(c)) }
}

fn body(c: &mut Choices) -> String {
    let name = BODIES[c.below(BODIES.len())];
    let mut fields = vec![format!("mass = {}", value(c, "kg"))];
    match c.below(8) {
        0 => fields.push(format!("at = {}", point(c))),
        1 => fields.push(format!("shape = rod({}, {})", point(c), point(c))),
        2 => fields.push(format!("at = {}, shape = disk({})", point(c), value(c, "m"))),
        3 => fields.push(format!("at = {}, shape = box({}, 1 m)", point(c), value(c, "m"))),
        4 => fields.push(format!("at = {}, inertia = {}", point(c), value(c, "kg*m^2"))),
        5 => fields.push(format!("at = {}, inertia = {} about {}", point(c), value(c, "kg*m^2"), point(c))),
        6 => fields.push(format!("inertia = {}", value(c, "kg*m^2"))),
        _ => {}
    }
    match c.below(10) {
        0 | 1 => fields.push("moves x".into()),
        2 => fields.push("moves y".into()),
        3 => fields.push("moves x y".into()),
        4 => fields.push(format!("moves along {}", direction(c))),
        5 => fields.push("turns".into()),
        6 => fields.push("free".into()),
        7 => fields.push("moves y, turns".into()),
        _ => {}
    }
    if c.rarely(16) {
        fields.push(c.of(&["mass = 1 kg", "colour = 3", "turns", "free", "at = 3 m"]).into());
    }
    format!("body {name} {{ {} }}", fields.join(", "))
}

fn spring(c: &mut Choices, n: usize) -> String {
    let torsional = c.below(4) == 0;
    let (k, force, angle) = if torsional { ("N*m/rad", "N*m", "rad") } else { ("N/m", "N", "m") };
    let mut fields = vec![format!("k = {}", value(c, k))];
    match c.below(6) {
        0 => fields.push(format!("preload = {}", value(c, force))),
        1 => fields.push(format!("free_length = {}", value(c, angle))),
        _ => {}
    }
    if c.below(3) == 0 {
        fields.push(format!("along = {}", c.of(&["x", "y", "(1, 2)", "(0, 0)", "z"])));
    }
    format!("spring s{n}: {} -- {} {{ {} }}", end(c), end(c), fields.join(", "))
}

fn damper(c: &mut Choices, n: usize) -> String {
    let unit = c.of(&["N*s/m", "N*s/m", "N*m*s/rad"]);
    let along = c.of(&["", ", along = x", ", along = y"]);
    format!("damper d{n}: {} -- {} {{ c = {}{along} }}", end(c), end(c), value(c, unit))
}

fn input(c: &mut Choices, n: usize) -> String {
    let signal =
        c.of(&["", "", " = constant(2 N)", " = harmonic(10 N, 1.5 Hz)", " = constant(1e6 N)", " = step(1 N, 0 s)"]);
    match c.below(4) {
        0 => format!("force u{n}: {} along {}{signal}", end(c), direction(c)),
        1 => format!("force u{n}: {} -- {}{signal}", end(c), end(c)),
        2 => format!("torque u{n}: {}", part(c)),
        _ => format!("force u{n}: {} along x{signal}", part(c)),
    }
}

fn motion(c: &mut Choices) -> String {
    let n = c.below(10);
    match c.below(6) {
        0 => format!("s{n}.force"),
        1 => format!("s{n}.stretch - d{n}.stretch"),
        2 => format!("{}.angle * 1 m", part(c)),
        3 => format!("{}@{}.{}", part(c), point(c), c.of(&["x", "y", "vx", "ay"])),
        4 => format!("2 * {}.x - {}.y", part(c), part(c)),
        _ => format!("{}.{}", part(c), c.of(&["x", "y", "angle", "vx", "omega", "alpha", "z", "x * a.x"])),
    }
}

fn repeat(c: &mut Choices) -> String {
    let bounds = c.of(&["1..2", "1..3", "2..1", "0..2", "1..1000000000000", "-1..1", "1..p0"]);
    let mut inner = String::new();
    let _ = match c.below(4) {
        0 => write!(inner, "body m[i] {{ mass = {}, moves x }}", value(c, "kg")),
        1 => write!(
            inner,
            "body m[i] {{ mass = i * 1 kg, at = (i * 1 m, 0) }}\npivot q[i]: m[i-1]@(i * 1 m, 1 m) -- m[i]"
        ),
        2 => write!(inner, "spring k[i]: m[i] -- m[i+1] {{ k = {} }}", value(c, "N/m")),
        _ => write!(inner, "repeat j in 1..2 {{ body n[i][j] {{ mass = 1 kg, moves y }} }}"),
    };
    format!("repeat i in {bounds} {{ {inner} }}")
}

fn rare(c: &mut Choices, n: usize) -> String {
    match c.below(12) {
        0 => format!("couple r{n}: {} = {}", motion(c), motion(c)),
        1 => "rest as drawn".into(),
        2 => format!("damping modal {} %", number(c)),
        3 => "damping rayleigh(0.1 /s, 1e-4 s)".into(),
        4 => format!("initial {} {{ x = 1 mm, vx = {} }}", part(c), value(c, "m/s")),
        5 => "solve p0 in 1 m .. 2 m: frequency(1) = 2 Hz".into(),
        6 => "require frequency(1) > 2 Hz".into(),
        7 => "require stable".into(),
        8 => format!("let q{n} = p0 / ({} - 1 m)", value(c, "m")),
        9 => "let p1 = p2\nlet p2 = p1".into(),
        10 => format!("model x{n}"),
        _ => format!("/// words\n{}", c.of(&["body", "}", "{", "spring s: a -- {", "\"", "point @"])),
    }
}
