//! Small systems for the tests of the analyses.

use crate::base::{FileId, Name, Number, Span, Words};
use crate::system::{Coordinate, CoordinateId, CoordinateKind, Form, Input, Label, LinearSystem, Nature, Output};

/// A system of `n` coordinates without terms, with a force on each and its displacement as outputs.
pub fn blank(n: usize) -> LinearSystem {
    let mut words = Words::new();
    let names: Vec<Label> =
        (0..n).map(|i| Label { name: Name::plain(words.intern(&format!("x{i}"))), motion: "" }).collect();
    let at = |i: usize| vec![(CoordinateId(i as u32), Number::ONE)];
    let span = Span::new(FileId(0), 0, 0);
    let coordinates = names.iter().map(|&name| Coordinate { name, kind: CoordinateKind::Translation, span });
    let inputs =
        (0..n).map(|i| Input { name: names[i], span, unit: "N", b: [at(i), Vec::new(), Vec::new()], undamped: None });
    let outputs = (0..n).map(|i| Output {
        name: names[i],
        unit: "m".into(),
        p: [at(i), Vec::new(), Vec::new()],
        d: [Vec::new(), Vec::new(), Vec::new()],
    });
    LinearSystem {
        coordinates: coordinates.collect(),
        m: Form::new(),
        c: Form::new(),
        k: Form::new(),
        chain: Vec::new(),
        inputs: inputs.collect(),
        outputs: outputs.collect(),
        initial: Vec::new(),
        losses: None,
        words,
    }
}

/// Adds weight (x_i - x_j)^2 to a form, or weight x_i^2.
pub fn push(form: &mut Form, weight: &str, i: usize, j: Option<usize>) {
    let name = Label { name: Name::plain(Words::new().intern("")), motion: "" };
    let source = form.source(name);
    let row =
        [(CoordinateId(i as u32), Number::ONE)].into_iter().chain(j.map(|j| (CoordinateId(j as u32), -&Number::ONE)));
    form.push(source, Nature::Property, Number::from(weight), row);
}

/// m x'' + c x' + k x = f
pub fn oscillator(m: &str, c: &str, k: &str) -> LinearSystem {
    let mut system = blank(1);
    push(&mut system.m, m, 0, None);
    push(&mut system.c, c, 0, None);
    push(&mut system.k, k, 0, None);
    system
}
