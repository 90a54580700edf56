//! The coordinates and, if small enough, the matrices.

use super::{Block, Line, Matrices, Options, Section, coordinate, enumeration, first_of, line, unit};
use crate::answers::ModalAnswer;
use crate::system::{Form, LinearSystem};

/// The matrices of larger systems are shown on demand only.
const MOST: usize = 8;
const DIGITS: usize = 5;

pub fn section(answer: &ModalAnswer, options: &Options) -> Section {
    let system = &answer.system;
    let mut blocks = vec![coordinates(system).into()];
    blocks.extend(dependent(answer).map(Block::from));
    if system.n() > 0 && (options.matrices || system.n() <= MOST) {
        let system = &system.clone().into_flat(u64::MAX).expect("as many entries as there may be");
        let entries = |form: &Form| form.entries(system.n());
        blocks.push(Line::from("M q″ + C q′ + K q = 0, in kg, m, s, rad").into());
        blocks.push(Block::Matrices(Matrices {
            list: vec![("M", entries(&system.m)), ("C", entries(&system.c)), ("K", entries(&system.k))],
            wanted: options.matrices,
            digits: DIGITS,
        }));
    }
    Section::new("Equations of motion", blocks)
}

/// `q = (block.x [m], rod.angle [rad])`; of many, only the first and the last.
fn coordinates(system: &LinearSystem) -> Line {
    const ENDS: usize = 6;
    let n = system.n();
    let name = |i: usize| {
        let of = &system.coordinates[i];
        line![coordinate(system, of), " [", unit(of.kind), "]"]
    };
    let names = match n {
        0 => return "q = (): nothing can move".into(),
        _ if n <= 2 * ENDS => enumeration((0..n).map(name)),
        _ => {
            let more = line!["... ", n - 2 * ENDS, " more"];
            enumeration((0..ENDS).map(name).chain([more]).chain((n - ENDS..n).map(name)))
        }
    };
    line!["q = (", names, ")"]
}

/// The coordinates that are determined by closed loops and couplings.
fn dependent(answer: &ModalAnswer) -> Option<Line> {
    const MOST: usize = 8;
    let names = answer.rest.dependent.iter().map(|dependent| coordinate(&answer.system, &dependent.coordinate).into());
    let names: Vec<Line> = names.collect();
    (!names.is_empty()).then(|| line!["following from q by joints and couplings: ", first_of(names, MOST)])
}
