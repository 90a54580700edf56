//! Zeros and poles of larger systems, for the cases in which the zeros are poles of a system with some motions held:
//!
//! ```text
//! p^T Q^-1 p = p_j^2 det (Z^T Q Z) / det Q                                            p^T Z = 0
//! (Q^-1)_ij = +- prod of the entries along the path from i to j  det Q_without the path / det Q
//! ```
//!
//! The first formula applies if the output sees what the input drives (Z spans the motions that it does not see), the
//! second if a single path joins the coordinates i and j, as in a chain and any other tree. In: a prepared system, an
//! input and an output. Out: zeros and poles, each in a disc with its own bound. See
//! docs/method/transfer.md#extrema-of-larger-systems.

use super::far::Far;
use super::fraction::Factored;
use super::roots::{Place, Root};
use super::slope::Anchor;
use crate::analysis::answer::{Pole, Poles};
use crate::analysis::modes::modes;
use crate::analysis::poles::poles;
use crate::analysis::transfer::{Frequency, MatrixEntry, Transfer, feed_through};
use crate::base::{Ball, Dd, Number, OrderBy, Rational, two_to, up};
use crate::kernel::big_float::{ComplexFloat, Float};
use crate::system::{CoordinateId, Form, LinearSystem};

/// The search evaluates every root from every other one: for more coordinates than this it takes longer than the
/// tables.
const MOST_COORDINATES: usize = 320;
/// A value of H from which the factor before zeros and poles is computed must be better than this.
const GOOD_FACTOR: f64 = 1e-12;

/// a0 + a1 s + a2 s^2
type Entry = [Ball; 3];

/// `poles` are those of the whole system. `None` if there is no single path between the two, or a root is not enclosed.
pub fn by_path(transfer: &Transfer, all: &Poles, input: usize, output: usize) -> Option<Factored> {
    let system = transfer.system;
    if system.n() > MOST_COORDINATES || !system.chain.is_empty() {
        return None;
    }
    if feed_through(&system.outputs[output], input).iter().any(|d| !d.is_zero()) {
        return None;
    }
    let net = Net::of(transfer);
    let of_part = |part: &[usize]| match part.len() == system.n() {
        true => roots_of(all),
        false => poles_with_held(system, part, &[]),
    };
    let (zeros, poles) = if let Some((seen, power)) = same_row(system, input, output) {
        let part = net.part(seen.iter().map(|(i, _)| *i));
        let (pivot, _) = seen.last()?;
        let left: Vec<usize> = part.iter().copied().filter(|k| k != pivot).collect();
        let mut zeros = poles_with_held(system, &left, &seen)?;
        zeros.extend((power > 0).then(|| real(Ball::ZERO, power)));
        (zeros, of_part(&part)?)
    } else {
        let (i, b) = single(&system.inputs[input].b)?;
        let (j, p) = single(&system.outputs[output].p)?;
        let part = net.part([i]);
        let path = if i == j { vec![i] } else { net.path(i, j, &part)? };
        let left: Vec<usize> = part.iter().copied().filter(|k| !path.contains(k)).collect();
        let mut zeros = poles_with_held(system, &left, &[])?;
        let along = path.windows(2).map(|ends| net.entry(ends[0], ends[1]));
        for entry in along.chain([Some(b), Some(p)]) {
            zeros.extend(roots_of_entry(entry?)?);
        }
        (zeros, of_part(&part)?)
    };
    with_factor(transfer, input, output, zeros, poles)
}

type Powers = [Vec<(CoordinateId, Number)>; 3];
type Row = Vec<(usize, Number)>;

/// The row that the output sees, if the input drives the same one, each with one power of s; and the sum of both
/// powers.
fn same_row(system: &LinearSystem, input: usize, output: usize) -> Option<(Row, usize)> {
    let (mut b, left) = only_power(&system.inputs[input].b)?;
    let (mut p, right) = only_power(&system.outputs[output].p)?;
    b.order_by_key(|(i, _)| *i);
    p.order_by_key(|(i, _)| *i);
    let (first, other) = (b.first()?.1.clone(), p.first()?.1.clone());
    let proportional = |(b, p): (&(usize, Number), &(usize, Number))| {
        let difference = &(&b.1 * &other) - &(&p.1 * &first);
        b.0 == p.0 && difference.exact().is_some_and(|_| difference.is_zero()) && !p.1.is_zero()
    };
    let distinct = p.windows(2).all(|pair| pair[0].0 < pair[1].0);
    (distinct && b.len() == p.len() && b.iter().zip(&p).all(proportional)).then_some((p, left + right))
}

fn only_power(powers: &Powers) -> Option<(Row, usize)> {
    let mut used = powers.iter().enumerate().filter(|(_, list)| !list.is_empty());
    let (power, list) = used.next()?;
    used.next().is_none().then(|| (list.iter().map(|(i, value)| (i.index(), value.clone())).collect(), power))
}

/// The only coordinate of a row, and its polynomial.
fn single(powers: &Powers) -> Option<(usize, Entry)> {
    let (first, _) = powers.iter().flatten().next()?;
    let mut entry = [Ball::ZERO; 3];
    for (power, list) in powers.iter().enumerate() {
        for (i, value) in list {
            if i != first {
                return None;
            }
            entry[power] = entry[power] + value.to_ball();
        }
    }
    Some((first.index(), entry))
}

/// The coordinates that share an entry of Q.
struct Net<'a> {
    neighbours: Vec<Vec<(usize, &'a MatrixEntry)>>,
}

impl Net<'_> {
    fn of<'a>(transfer: &'a Transfer) -> Net<'a> {
        let mut neighbours = vec![Vec::new(); transfer.system.n()];
        let joins = |e: &&MatrixEntry| e.i != e.j && ![e.m, e.c, e.k].iter().all(Ball::is_zero);
        for e in transfer.entries.iter().filter(joins) {
            neighbours[e.i as usize].push((e.j as usize, e));
        }
        Net { neighbours }
    }

    /// The coordinates coupled with the given ones, directly or indirectly, ascending.
    fn part(&self, first: impl IntoIterator<Item = usize>) -> Vec<usize> {
        let mut seen = vec![false; self.neighbours.len()];
        let mut left: Vec<usize> = first.into_iter().collect();
        left.iter().for_each(|&i| seen[i] = true);
        while let Some(i) = left.pop() {
            for &(j, _) in &self.neighbours[i] {
                if !std::mem::replace(&mut seen[j], true) {
                    left.push(j);
                }
            }
        }
        (0..seen.len()).filter(|&i| seen[i]).collect()
    }

    /// The unique path in a tree; `None` in a part that is not a tree, or between different parts.
    fn path(&self, from: usize, to: usize, part: &[usize]) -> Option<Vec<usize>> {
        let ends: usize = part.iter().map(|&i| self.neighbours[i].len()).sum();
        if ends != 2 * (part.len() - 1) {
            return None;
        }
        let mut before: Vec<Option<usize>> = vec![None; self.neighbours.len()];
        let mut left = vec![from];
        while let Some(i) = left.pop() {
            let above = before[i];
            for &(j, _) in self.neighbours[i].iter().filter(|(j, _)| Some(*j) != above) {
                before[j] = Some(i);
                left.push(j);
            }
        }
        let mut path = vec![to];
        while let Some(last) = path.last().copied().filter(|&last| last != from) {
            path.push(before[last]?);
        }
        Some(path)
    }

    fn entry(&self, i: usize, j: usize) -> Option<Entry> {
        let (_, e) = self.neighbours[i].iter().find(|(other, _)| *other == j)?;
        Some([e.k, e.c, e.m])
    }
}

/// The poles of the `kept` coordinates with all others held; if `row` is given, its last coordinate moves so that the
/// row sees nothing.
fn poles_with_held(system: &LinearSystem, kept: &[usize], row: &[(usize, Number)]) -> Option<Vec<Root>> {
    if kept.is_empty() {
        return Some(Vec::new());
    }
    let place = |i: usize| kept.binary_search(&i).ok().map(|place| CoordinateId(place as u32));
    let form = |form: &Form| {
        let mut result = Form::new();
        for term in form.terms() {
            let mut entries: Vec<(CoordinateId, Number)> = Vec::new();
            let mut add = |i: usize, a: Number| {
                let Some(i) = place(i) else { return };
                match entries.iter_mut().find(|(other, _)| *other == i) {
                    Some((_, sum)) => *sum = &*sum + &a,
                    None => entries.push((i, a)),
                }
            };
            for (i, a) in form.row(term) {
                match row.split_last() {
                    Some(((pivot, last), others)) if *pivot == i.index() => {
                        others.iter().for_each(|(i, p)| add(*i, -&(&(a * p) / last)));
                    }
                    _ => add(i.index(), a.clone()),
                }
            }
            let source = result.source(form.source_of(term.source));
            result.push(source, term.nature, term.weight.clone(), entries);
        }
        result
    };
    let part = LinearSystem {
        words: system.words.clone(),
        coordinates: kept.iter().map(|&i| system.coordinates[i].clone()).collect(),
        m: form(&system.m),
        c: form(&system.c),
        k: form(&system.k),
        chain: Vec::new(),
        inputs: Vec::new(),
        outputs: Vec::new(),
        initial: Vec::new(),
        losses: None,
    };
    let modes = modes(&part).ok()?;
    roots_of(&poles(&part, &modes).ok()?)
}

/// `None` if a pole is missing or not enclosed, or if it is open whether it is real or on the imaginary axis.
fn roots_of(poles: &Poles) -> Option<Vec<Root>> {
    if !poles.is_complete() {
        return None;
    }
    let list: Option<Vec<Option<Root>>> = poles.list.iter().map(root_of).collect();
    let list: Vec<Root> = list?.into_iter().flatten().collect();
    let count: usize = list.iter().map(|root| if root.place == Place::Real { 1 } else { 2 }).sum();
    (count == poles.list.len()).then_some(list)
}

/// `Some(None)` for the lower pole of a conjugate pair.
fn root_of(pole: &Pole) -> Option<Option<Root>> {
    let known = |x: Ball| x.is_finite() && (x.is_zero() || !x.contains_zero());
    // A centre at zero would be taken for a pole exactly on the axis.
    if !known(pole.im) || !known(pole.re) {
        return None;
    }
    let place = match (pole.re.is_zero(), pole.im.is_zero()) {
        (_, true) => Place::Real,
        (true, false) => Place::Axis,
        (false, false) => Place::Pair,
    };
    let radius = (pole.re.rad + pole.im.rad) * up::FEW;
    let root = Root {
        centre: ComplexFloat::new(wide(pole.re.mid), wide(pole.im.mid)),
        radius: Float::from(radius),
        multiplicity: 1,
        place,
    };
    Some((!pole.im.is_negative()).then_some(root))
}

fn wide(x: Dd) -> Float {
    &Float::from(x.hi) + &Float::from(x.lo)
}

fn real(s: Ball, multiplicity: usize) -> Root {
    let centre = ComplexFloat::new(wide(s.mid), Float::zero());
    Root { centre, radius: Float::from(s.rad), multiplicity, place: Place::Real }
}

/// The roots of an entry: one at zero and another one; `None` if there are more, or a coefficient may be zero.
fn roots_of_entry(entry: Entry) -> Option<Vec<Root>> {
    if entry.iter().any(|a| !a.is_finite() || (a.contains_zero() && !a.is_zero())) {
        return None;
    }
    let first = entry.iter().position(|a| !a.is_zero())?;
    let last = entry.iter().rposition(|a| !a.is_zero())?;
    let mut list = Vec::new();
    if first > 0 {
        list.push(real(Ball::ZERO, first));
    }
    match last - first {
        0 => {}
        1 => list.push(real(-(entry[first] / entry[last]), 1)),
        _ => return None,
    }
    Some(list)
}

/// The real factor before zeros and poles, from one value of H beyond all of them, where nothing cancels.
fn with_factor(
    transfer: &Transfer,
    input: usize,
    output: usize,
    zeros: Vec<Root>,
    poles: Vec<Root>,
) -> Option<Factored> {
    let size = |root: &Root| root.centre.re.to_f64().abs() + root.centre.im.to_f64().abs();
    let sizes = || zeros.iter().chain(&poles).map(size).filter(|size| *size > 0.0);
    let largest = sizes().fold(0.0, f64::max);
    // Products of hundreds of roots leave the range of binary64; those of their ratios to a typical one do not.
    let typical = sizes().map(libm::log2).sum::<f64>() / sizes().count().max(1) as f64;
    let unit = two_to(typical.round().clamp(-900.0, 900.0) as i32);
    let omega = Number::from(Rational::from_f64(1.25 * largest).filter(|_| largest > 0.0)?);
    let frequency = Frequency::radians(&omega);
    let value = transfer.between(&frequency, &[input], &[output])[0][0].disc()?;
    if value.relative_error() > GOOD_FACTOR {
        return None;
    }
    let product = Factored { lead: Ball::ONE, unit, zeros, poles, far: Far::NONE };
    let of_roots = Anchor::zero(&product).value(Ball::ONE, frequency.omega);
    if !(1e-100..=1e100).contains(&(of_roots.re.to_f64().abs() + of_roots.im.to_f64().abs())) {
        return None;
    }
    let ball = |x: Dd| Ball::new(x, value.radius);
    // Both are complex, but their quotient is real.
    let norm = of_roots.re * of_roots.re + of_roots.im * of_roots.im;
    let lead = (ball(value.value.re) * of_roots.re + ball(value.value.im) * of_roots.im) / norm;
    (lead.is_finite() && !lead.contains_zero()).then_some(Factored { lead, ..product })
}
