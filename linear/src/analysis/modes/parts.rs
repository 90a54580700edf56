//! The independent parts of a system: coordinates that no term couples move independently, and each part has its own
//! modes and poles. In: a linear system. Out: the parts, each with its coordinates and the indices of its terms.
//! See docs/method/modes.md#parts and docs/method/poles.md#parts-and-scaling.

use crate::system::{CoordinateId, Form, LinearSystem};

/// Coordinates that are coupled with one another and with nothing else, ascending, and the terms on them.
#[derive(Clone, Debug, Default)]
pub struct Part {
    pub coordinates: Vec<u32>,
    pub m: Vec<u32>,
    pub c: Vec<u32>,
    pub k: Vec<u32>,
}

impl Part {
    /// The whole system as one part, whether it is coupled or not.
    pub fn whole(system: &LinearSystem) -> Part {
        let all = |form: &Form| (0..form.terms().len() as u32).collect();
        Part { coordinates: (0..system.n() as u32).collect(), m: all(&system.m), c: all(&system.c), k: all(&system.k) }
    }
}

/// The parts in the order of their first coordinates.
pub fn independent(system: &LinearSystem) -> Vec<Part> {
    let mut parts = joined_by(system.n(), &[&system.m, &system.c, &system.k]);
    let number = numbers(system.n(), &parts);
    distribute(&system.m, &number, &mut parts, |part| &mut part.m);
    distribute(&system.c, &number, &mut parts, |part| &mut part.c);
    distribute(&system.k, &number, &mut parts, |part| &mut part.k);
    parts
}

/// The independent parts of M q'' + K q = 0, which dampers do not couple.
pub fn independent_undamped(system: &LinearSystem) -> Vec<Part> {
    let mut parts = joined_by(system.n(), &[&system.m, &system.k]);
    let number = numbers(system.n(), &parts);
    distribute(&system.m, &number, &mut parts, |part| &mut part.m);
    distribute(&system.k, &number, &mut parts, |part| &mut part.k);
    parts
}

/// The coordinates of the independent parts of a system whose rows may be chained, without their terms.
pub fn independent_chained(system: &LinearSystem) -> Vec<Part> {
    let n = system.n();
    let mut joined = Joined::new(n + system.chain.len());
    [&system.m, &system.c, &system.k].into_iter().for_each(|form| joined.join_rows(form));
    for (place, row) in system.chain.iter().enumerate() {
        row.iter().for_each(|(i, _)| joined.join(n + place, i.index()));
    }
    parts_of(joined, n)
}

/// The parts that result from coupling coordinates by the terms of these forms.
pub fn joined_by(n: usize, forms: &[&Form]) -> Vec<Part> {
    let mut joined = Joined::new(n);
    forms.iter().for_each(|form| joined.join_rows(form));
    parts_of(joined, n)
}

/// The sets of the first n members; every later member belongs to one of them.
fn parts_of(joined: Joined, n: usize) -> Vec<Part> {
    let (number, count) = joined.number_sets();
    let mut parts = vec![Part::default(); count];
    for (coordinate, &part) in number[..n].iter().enumerate() {
        parts[part].coordinates.push(coordinate as u32);
    }
    parts
}

/// For each coordinate the index of its part.
fn numbers(n: usize, parts: &[Part]) -> Vec<usize> {
    let mut number = vec![0; n];
    for (index, part) in parts.iter().enumerate() {
        part.coordinates.iter().for_each(|&coordinate| number[coordinate as usize] = index);
    }
    number
}

/// A part as a separate system: without inputs and outputs, its coordinates numbered by `local`.
pub fn as_system(system: &LinearSystem, part: &Part, local: &[u32]) -> LinearSystem {
    LinearSystem {
        words: system.words.clone(),
        coordinates: part.coordinates.iter().map(|&c| system.coordinates[c as usize].clone()).collect(),
        m: choose_terms(&system.m, &part.m, local),
        c: choose_terms(&system.c, &part.c, local),
        k: choose_terms(&system.k, &part.k, local),
        chain: Vec::new(),
        inputs: Vec::new(),
        outputs: Vec::new(),
        initial: Vec::new(),
        losses: None,
    }
}

/// The parts as systems of their own, each behind its coordinates.
pub fn separate(system: &LinearSystem) -> Vec<(Vec<u32>, LinearSystem)> {
    let parts = independent(system);
    let mut local = vec![0u32; system.n()];
    for part in &parts {
        part.coordinates.iter().enumerate().for_each(|(i, &c)| local[c as usize] = i as u32);
    }
    parts.iter().map(|part| (part.coordinates.clone(), as_system(system, part, &local))).collect()
}

/// The undamped system of some coordinates alone; `None` if a term couples them with others.
pub fn undamped_block(system: &LinearSystem, coordinates: &[u32]) -> Option<LinearSystem> {
    let mut local = vec![u32::MAX; system.n()];
    for (i, &coordinate) in coordinates.iter().enumerate() {
        *local.get_mut(coordinate as usize)? = i as u32;
    }
    let mut part = Part { coordinates: coordinates.to_vec(), ..Part::default() };
    for (form, list) in [(&system.m, &mut part.m), (&system.k, &mut part.k)] {
        for (index, term) in form.terms().enumerate() {
            let inside = form.row(term).iter().filter(|(i, _)| local[i.index()] != u32::MAX).count();
            match inside {
                0 => {}
                all if all == form.row(term).len() => list.push(index as u32),
                _ => return None,
            }
        }
    }
    Some(as_system(system, &part, &local))
}

/// The chosen terms, with their coordinates numbered by `local`.
pub fn choose_terms(form: &Form, terms: &[u32], local: &[u32]) -> Form {
    let mut result = Form::new();
    for &index in terms {
        let term = form.term(index as usize);
        let source = result.source(form.source_of(term.source));
        let row = form.row(term).iter().map(|(i, a)| (CoordinateId(local[i.index()]), a.clone()));
        result.push(source, term.nature, term.weight.clone(), row);
    }
    result
}

fn distribute(form: &Form, number: &[usize], parts: &mut [Part], terms: impl Fn(&mut Part) -> &mut Vec<u32>) {
    for (index, term) in form.terms().enumerate() {
        if let Some((coordinate, _)) = form.row(term).first() {
            terms(&mut parts[number[coordinate.index()]]).push(index as u32);
        }
    }
}

/// Disjoint sets with path halving; a set's root is its least member.
struct Joined {
    above: Vec<usize>,
}

impl Joined {
    fn new(n: usize) -> Joined {
        Joined { above: (0..n).collect() }
    }

    fn root(&mut self, mut i: usize) -> usize {
        while self.above[i] != i {
            self.above[i] = self.above[self.above[i]];
            i = self.above[i];
        }
        i
    }

    fn join_rows(&mut self, form: &Form) {
        for term in form.terms() {
            for pair in form.row(term).coordinates().windows(2) {
                self.join(pair[0].index(), pair[1].index());
            }
        }
    }

    fn join(&mut self, i: usize, j: usize) {
        let (i, j) = (self.root(i), self.root(j));
        self.above[i.max(j)] = i.min(j);
    }

    /// The number of each member's set, counted in the order of first members, and the number of sets.
    fn number_sets(mut self) -> (Vec<usize>, usize) {
        let mut number = vec![0; self.above.len()];
        let mut count = 0;
        for i in 0..self.above.len() {
            let root = self.root(i);
            if root == i {
                number[i] = count;
                count += 1;
            } else {
                number[i] = number[root];
            }
        }
        (number, count)
    }
}
