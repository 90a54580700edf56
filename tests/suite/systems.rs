//! Linear systems built by hand, and the hard cases read from files with their terms.

use num_rational::BigRational;
use std::cmp::Ordering;
use vibc::base::{Ball, FileId, Name, Number, Rational, Span, Words};
use vibc::system::{Coordinate, CoordinateId, CoordinateKind, Form, Label, LinearSystem, Nature};

/// A linear system under construction: coordinates by name, terms by their rows.
pub struct Builder {
    words: Words,
    coordinates: Vec<Coordinate>,
    pub m: Form,
    pub c: Form,
    pub k: Form,
}

impl Builder {
    pub fn new(names: &[impl AsRef<str>]) -> Builder {
        let mut words = Words::new();
        let coordinates = (names.iter().enumerate())
            .map(|(i, name)| Coordinate {
                name: Label { name: Name::plain(words.intern(name.as_ref())), motion: "" },
                kind: CoordinateKind::Translation,
                span: Span::new(FileId(0), i, i + 1),
            })
            .collect();
        Builder { words, coordinates, m: Form::new(), c: Form::new(), k: Form::new() }
    }

    /// Coordinates x1 ... xn.
    pub fn numbered(n: usize) -> Builder {
        Builder::new(&(1..=n).map(|i| format!("x{i}")).collect::<Vec<_>>())
    }

    pub fn label(&mut self, name: &str) -> Label {
        Label { name: Name::plain(self.words.intern(name)), motion: "" }
    }

    pub fn kind(&mut self, at: usize, kind: CoordinateKind) {
        self.coordinates[at].kind = kind;
    }

    pub fn mass(&mut self, at: usize, mass: &Number) {
        let source = self.m.source(Label { name: self.coordinates[at].name.name, motion: "" });
        self.m.push(source, Nature::Property, mass.clone(), [(CoordinateId(at as u32), Number::ONE)]);
    }

    /// A term w a a^T of M.
    pub fn inertia(&mut self, weight: &Number, row: &[(usize, Number)]) {
        let label = self.label("m");
        let source = self.m.source(label);
        let row = row.iter().map(|(i, a)| (CoordinateId(*i as u32), a.clone()));
        self.m.push(source, Nature::Property, weight.clone(), row);
    }

    /// A term w a a^T of C.
    pub fn dashpot(&mut self, weight: &Number, row: &[(usize, Number)]) {
        let label = self.label("d");
        let source = self.c.source(label);
        let row = row.iter().map(|(i, a)| (CoordinateId(*i as u32), a.clone()));
        self.c.push(source, Nature::Property, weight.clone(), row);
    }

    /// A damper between two coordinates, or to the ground.
    pub fn damper(&mut self, from: Option<usize>, to: usize, c: &Number) {
        let label = self.label(&format!("d{}", self.c.source_count() + 1));
        let source = self.c.source(label);
        let row = [(to, Number::ONE)].into_iter().chain(from.map(|i| (i, Number::from(-1))));
        self.c.push(source, Nature::Property, c.clone(), row.map(|(i, a)| (CoordinateId(i as u32), a)));
    }

    /// A term w a a^T of M.
    pub fn coupled_mass(&mut self, mass: &Number, row: &[(usize, Number)]) {
        let source = self.m.source(Label { name: self.coordinates[0].name.name, motion: "" });
        let row = row.iter().map(|(i, a)| (CoordinateId(*i as u32), a.clone()));
        self.m.push(source, Nature::Property, mass.clone(), row);
    }

    /// A term w a a^T of K.
    pub fn stiffness(&mut self, name: &str, nature: Nature, weight: &Number, row: &[(usize, Number)]) {
        let label = self.label(name);
        let source = self.k.source(label);
        let row = row.iter().map(|(i, a)| (CoordinateId(*i as u32), a.clone()));
        self.k.push(source, nature, weight.clone(), row);
    }

    /// A spring between two coordinates, or to the ground.
    pub fn spring(&mut self, from: Option<usize>, to: usize, k: &Number) {
        let name = format!("s{}", self.k.source_count() + 1);
        let mut row = vec![(to, Number::ONE)];
        row.extend(from.map(|i| (i, Number::from(-1))));
        self.stiffness(&name, Nature::Property, k, &row);
    }

    pub fn finish(self) -> LinearSystem {
        LinearSystem {
            words: self.words,
            coordinates: self.coordinates,
            m: self.m,
            c: self.c,
            k: self.k,
            chain: Vec::new(),
            inputs: Vec::new(),
            outputs: Vec::new(),
            initial: Vec::new(),
            losses: None,
        }
    }
}

/// Numbers for random systems, the same on every machine.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Random {
        Random(seed)
    }

    /// SplitMix64.
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }

    /// A positive decimal of four digits (powers of two would make plain elimination exact), with its exponent spread
    /// over this many decades about 1.
    pub fn decimal(&mut self, decades: f64) -> Number {
        let mantissa = 1000 + self.below(9000);
        let exponent = self.below(decades as usize + 1) as i64 - decades as i64 / 2;
        number(&format!("{mantissa}e{}", exponent - 3))
    }

    /// A decimal from -1 to 1.
    pub fn signed(&mut self) -> Number {
        let size = number(&format!("{}e-4", 1 + self.below(9999)));
        if self.below(2) == 0 { size } else { -&size }
    }
}

/// A signed decimal.
pub fn number(text: &str) -> Number {
    match text.strip_prefix('-') {
        Some(digits) => -&Number::from(digits),
        None => Number::from(text),
    }
}

/// The binary number of which a case gives 40 digits: sums of binary64 numbers have few bits, so a number of 75 bits
/// that agrees in all given digits is the number itself. (Cut off at 40 digits, rows of o08 would no longer be exactly
/// dependent.)
fn binary(text: &str) -> Number {
    let cut = number(text);
    let size = cut.abs().to_f64();
    let unit = Number::from(2).powi(size.log2().floor() as i32 - 75).expect("not zero");
    let Some(steps) = (&cut / &unit).exact().map(Rational::to_big) else { return cut };
    let near = &Number::from(Rational::from(BigRational::from_integer(steps.round().to_integer()))) * &unit;
    if (&near - &cut).abs().to_f64() <= 1e-38 * size { near } else { cut }
}

/// |midpoint - truth|, computed exactly, and whether it is within the radius and `room` (the error of the truth itself).
pub fn error(ball: Ball, truth: &Number, room: f64) -> (f64, bool) {
    let part = |x: f64| Number::from(Rational::from_f64(x).expect("a finite midpoint"));
    let error = (&(&part(ball.mid.hi) + &part(ball.mid.lo)) - truth).abs();
    let bound = &part(ball.rad.min(f64::MAX)) + &part(room);
    (error.to_f64(), error.compare(&bound) != Some(Ordering::Greater))
}

/// A case of tests/hardcases.
pub struct HardCase {
    pub json: serde_json::Value,
    pub system: LinearSystem,
}

impl HardCase {
    /// The content of the case's file.
    pub fn json(name: &str) -> serde_json::Value {
        let path = format!("{}/tests/hardcases/{name}.json", env!("CARGO_MANIFEST_DIR"));
        let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"));
        serde_json::from_str(&text).expect("a case is JSON")
    }

    /// The case with its literals rounded to binary64, for which the references' `value` is given.
    pub fn load(name: &str) -> HardCase {
        let json = HardCase::json(name);
        let names: Vec<&str> = texts(&json["dofs"]).collect();
        let mut builder = Builder::new(&names);
        let terms = &json["factored"];
        push(&mut builder, &names, &terms["masses"], "m", |b| &mut b.m, Nature::Property);
        push(&mut builder, &names, &terms["dampers"], "c", |b| &mut b.c, Nature::Property);
        push(&mut builder, &names, &terms["springs"], "k", |b| &mut b.k, Nature::Property);
        push(&mut builder, &names, &terms["geometric"], "g", |b| &mut b.k, Nature::Geometric);
        HardCase { json, system: builder.finish() }
    }

    /// The reference `id`, in the binary64 reading of the literals.
    pub fn reference(&self, id: &str) -> Option<Number> {
        let list = self.json["reference"].as_array().expect("references are a list");
        list.iter().find(|entry| entry["id"] == id).map(|entry| number(entry["value"].as_str().expect("a decimal")))
    }
}

fn texts(list: &serde_json::Value) -> impl Iterator<Item = &str> {
    list.as_array().expect("a list").iter().map(|text| text.as_str().expect("a text"))
}

fn push(
    builder: &mut Builder,
    names: &[&str],
    list: &serde_json::Value,
    weight: &str,
    form: impl Fn(&mut Builder) -> &mut Form,
    nature: Nature,
) {
    for (i, term) in list.as_array().expect("terms are a list").iter().enumerate() {
        let label = builder.label(&format!("{weight}{}", i + 1));
        let row: Vec<(CoordinateId, Number)> = (term["row"].as_object().expect("a row").iter())
            .map(|(name, value)| {
                let index = names.iter().position(|n| n == name).expect("a coordinate of the case");
                (CoordinateId(index as u32), binary(value.as_str().expect("a decimal")))
            })
            .collect();
        let form = form(builder);
        let source = form.source(label);
        form.push(source, nature, binary(term[weight].as_str().expect("a decimal")), row);
    }
}

/// n equal masses in a row between n + 1 equal springs and dampers, both ends held.
pub fn chain(n: usize, m: &str, k: &str, c: &str) -> LinearSystem {
    let mut b = Builder::numbered(n);
    for i in 0..n {
        b.mass(i, &number(m));
    }
    for i in 0..=n {
        let (from, to) = (i.checked_sub(1).filter(|_| i < n), i.min(n - 1));
        b.spring(from, to, &number(k));
        b.damper(from, to, &number(c));
    }
    b.finish()
}
