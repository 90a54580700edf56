//! Exact elimination of motions without inertia: they follow the others without adding a force.
//!
//! In: M, K and independent exact null vectors of M. Out: forms M', K' on fewer coordinates, and the map back to all
//! coordinates.
//!
//! With q = q' + sum v_i s_i, where coordinate f_i of q' is fixed at zero (v_i is 1 there), M does not depend on s. The
//! condition that s moves without force is a minimum (or saddle) of the strain energy sum w_t (p_t s + r_t . q')^2 over
//! one s after the other, and by Lagrange's identity, with W = sum w_t p_t^2,
//!
//!   min_s sum_t w_t (p_t s + r_t . q')^2 = sum_(t < u) (w_t w_u / W) ((p_t r_u - p_u r_t) . q')^2:
//!
//! again a sum of squares, positive if the terms are. For springs this is the star-mesh transformation. Each step
//! creates one square for each pair of terms, so squares of proportional rows are added up whenever their number has
//! doubled; if exact squares still outnumber the entries of a symmetric matrix, Lagrange's reduction rewrites their sum
//! with at most one square for each coordinate. See docs/method/modes.md#motions-without-inertia.

use crate::base::{Dd, Number, OrderBy, Rational};
use crate::kernel::triple::{Precise, Triple};
use crate::system::{CoordinateId, Form, Nature};
use std::collections::{BTreeMap, BTreeSet};

/// Coordinates and factors.
type Row = Vec<(usize, Number)>;

/// A system with its massless motions eliminated.
pub struct Condensed {
    pub m: Form,
    pub k: Form,
    /// The remaining coordinates, ascending.
    pub kept: Vec<usize>,
    steps: Vec<Step>,
    vectors: Vec<(usize, Vec<Number>)>,
}

/// s = -sum w_t p_t (r_t . q') / W as a row; none if no term restrains s.
struct Step {
    at: usize,
    row: Option<Row>,
}

/// A square of K under elimination.
#[derive(Clone)]
struct Square {
    weight: Number,
    row: Row,
}

/// The reason why motions cannot be eliminated; each variant names a coordinate of one of them.
pub enum Stuck {
    /// The coordinate cannot be eliminated on its own.
    Undetermined(usize),
    /// Its elimination would leave more squares than [`MOST_SQUARES`].
    TooManyTerms(usize),
}

/// Maximum number of squares that a step may leave, some hundred megabytes. A node without mass between n others makes
/// n² / 2 of them.
pub const MOST_SQUARES: usize = 1_000_000;

/// Eliminates the motions `vectors`, given in reduced form: each has a one at a coordinate where the others have zero.
pub fn condense(m: &Form, k: &Form, n: usize, vectors: &[Vec<Rational>]) -> Result<Condensed, Stuck> {
    let vectors = with_own_coordinates(vectors);
    let mut is_own = vec![false; n];
    vectors.iter().for_each(|(at, _)| is_own[*at] = true);
    let kept: Vec<usize> = (0..n).filter(|i| !is_own[*i]).collect();
    let squares = k.terms().map(|term| in_new_coordinates(k, term, &vectors)).collect();
    let mut squares = merge_proportional(squares);
    let (mut steps, mut room) = (Vec::new(), 2 * squares.len());
    for (at, _) in &vectors {
        if squares.len() > room {
            squares = merge_proportional(squares);
            room = 2 * squares.len();
        }
        steps.push(eliminate(&mut squares, *at)?);
    }
    let squares = merge_proportional(squares);
    let mut places = vec![None; n];
    kept.iter().enumerate().for_each(|(place, i)| places[*i] = Some(CoordinateId(place as u32)));
    let local = |i: usize| places[i];
    let inertia = m.terms().map(|term| {
        let row = m.row(term).iter().filter_map(|(i, a)| Some((local(i.index())?, a.clone()))).collect();
        (term.weight.clone(), row)
    });
    let stiffness = squares.iter().map(|square| {
        let row = square.row.iter().filter_map(|(i, a)| Some((local(*i)?, a.clone()))).collect();
        (square.weight.clone(), row)
    });
    Ok(Condensed { m: form(m, inertia), k: form(k, stiffness), kept, steps, vectors })
}

impl Condensed {
    /// Massless motions that no term of K restrains, each over all n coordinates.
    pub fn loose_motions(&self, n: usize) -> Vec<Vec<Number>> {
        let loose = self.steps.iter().enumerate().filter(|(_, step)| step.row.is_none());
        loose.map(|(index, step)| self.loose_motion(n, index, step.at)).collect()
    }

    /// The motion in which the coordinate of step `index` moves by one, those eliminated before it follow, and nothing else
    /// moves.
    fn loose_motion(&self, n: usize, index: usize, at: usize) -> Vec<Number> {
        let mut whole = vec![Number::ZERO; n];
        whole[at] = Number::ONE;
        for step in self.steps[..index].iter().rev() {
            let row = step.row.iter().flatten();
            whole[step.at] = row.fold(Number::ZERO, |sum, (i, a)| &sum + &(a * &whole[*i]));
        }
        for (at, v) in &self.vectors {
            let s = whole[*at].clone();
            for (i, v) in v.iter().enumerate().filter(|(i, _)| i != at) {
                whole[i] = &whole[i] + &(v * &s);
            }
        }
        whole
    }

    /// The component of coordinate i in q', the part of the motion x that M sees.
    pub fn seen_by_inertia(&self, i: usize, x: &[Dd]) -> Dd {
        let parts = self.vectors.iter().filter(|(_, v)| !v[i].is_zero());
        parts.fold(x[i], |sum, (at, v)| sum - v[i].to_ball().mid * x[*at])
    }

    /// The motion over all coordinates in which the remaining ones move like `x`.
    pub fn expand(&self, n: usize, x: &[Triple]) -> Vec<Triple> {
        let mut whole = vec![Triple::ZERO; n];
        for (&i, &x) in self.kept.iter().zip(x) {
            whole[i] = x;
        }
        for step in self.steps.iter().rev() {
            let parts = step.row.iter().flatten().map(|(i, a)| Precise::of(a).value * whole[*i]);
            whole[step.at] = parts.fold(Triple::ZERO, |sum, part| sum + part);
        }
        for (at, v) in &self.vectors {
            let s = whole[*at];
            for (i, v) in v.iter().enumerate().filter(|(i, v)| i != at && !v.is_zero()) {
                whole[i] = whole[i] + Precise::of(v).value * s;
            }
        }
        whole
    }
}

/// For each vector, the coordinate at which it alone is not zero.
fn with_own_coordinates(vectors: &[Vec<Rational>]) -> Vec<(usize, Vec<Number>)> {
    let alone = |i: usize, at: usize| {
        vectors[i][at].is_one() && vectors.iter().enumerate().all(|(j, other)| j == i || other[at].is_zero())
    };
    (0..vectors.len())
        .map(|i| {
            let at = (0..vectors[i].len()).rev().find(|&at| alone(i, at));
            let at = at.expect("a null space comes in reduced echelon form");
            (at, vectors[i].iter().cloned().map(Number::from).collect())
        })
        .collect()
}

/// The row a in terms of q' and s: entries at the vectors' own coordinates become a . v.
fn in_new_coordinates(k: &Form, term: crate::system::Term, vectors: &[(usize, Vec<Number>)]) -> Square {
    let row = k.row(term);
    let kept = row.iter().filter(|(i, _)| vectors.iter().all(|(at, _)| *at != i.index()));
    let mut new: Row = kept.map(|(i, a)| (i.index(), a.clone())).collect();
    for (at, v) in vectors {
        let image = row.iter().fold(Number::ZERO, |sum, (i, a)| &sum + &(a * &v[i.index()]));
        if !image.is_zero() {
            new.push((*at, image));
        }
    }
    Square { weight: term.weight.clone(), row: new }
}

/// Eliminates coordinate `at`.
fn eliminate(squares: &mut Vec<Square>, at: usize) -> Result<Step, Stuck> {
    let (touched, rest): (Vec<Square>, Vec<Square>) =
        squares.drain(..).partition(|square| square.row.iter().any(|e| e.0 == at));
    *squares = rest;
    let split: Vec<Split> = touched.into_iter().map(|square| Split::of(square, at)).collect();
    let whole = split.iter().fold(Number::ZERO, |sum, t| &sum + &(&t.weight * &t.factor.square()));
    if split.is_empty() {
        return Ok(Step { at, row: None });
    }
    let inverse = whole.recip().ok_or(Stuck::Undetermined(at))?;
    if split.len() * (split.len() - 1) / 2 + squares.len() > MOST_SQUARES {
        return Err(Stuck::TooManyTerms(at));
    }
    for (index, t) in split.iter().enumerate() {
        for u in &split[index + 1..] {
            let row = linear_combination(&t.factor, &u.rest, &-&u.factor, &t.rest);
            if !row.is_empty() {
                squares.push(Square { weight: &(&t.weight * &u.weight) * &inverse, row });
            }
        }
    }
    let row = split.iter().fold(Row::new(), |sum, t| {
        linear_combination(&Number::ONE, &sum, &-&(&(&t.weight * &t.factor) * &inverse), &t.rest)
    });
    Ok(Step { at, row: Some(row) })
}

/// Adds up squares of proportional rows, as far as rows are exact; applies Lagrange's reduction if that leaves more
/// squares than a symmetric matrix has entries.
fn merge_proportional(squares: Vec<Square>) -> Vec<Square> {
    let mut of_row: BTreeMap<Vec<(usize, Rational)>, Number> = BTreeMap::new();
    let mut joined = Vec::new();
    for square in squares {
        match square.in_normal_form() {
            Some((row, weight)) => {
                let sum = of_row.entry(row).or_insert(Number::ZERO);
                *sum = &*sum + &weight;
            }
            None => joined.push(square),
        }
    }
    let in_numbers = |row: Vec<(usize, Rational)>| row.into_iter().map(|(i, a)| (i, Number::from(a))).collect();
    let of_row = of_row.into_iter().filter(|(_, weight)| !weight.is_zero());
    joined.extend(of_row.map(|(row, weight)| Square { weight, row: in_numbers(row) }));
    let coordinates: BTreeSet<usize> = joined.iter().flat_map(|square| &square.row).map(|(i, _)| *i).collect();
    let entries = coordinates.len() * (coordinates.len() + 1) / 2;
    if joined.len() <= entries { joined } else { lagrange_reduction(&joined, &coordinates).unwrap_or(joined) }
}

/// Lagrange's reduction of a sum of exact squares: one square for each pivot on the diagonal, in order. `None` if a
/// number is not exact, or if a pivot vanishes but its row does not.
fn lagrange_reduction(squares: &[Square], coordinates: &BTreeSet<usize>) -> Option<Vec<Square>> {
    let mut matrix: BTreeMap<(usize, usize), Number> = BTreeMap::new();
    for square in squares {
        square.weight.exact()?;
        for (i, a) in &square.row {
            a.exact()?;
            let weighted = &square.weight * a;
            for (j, b) in square.row.iter().filter(|(j, _)| i <= j) {
                let sum = matrix.entry((*i, *j)).or_insert(Number::ZERO);
                *sum = &*sum + &(&weighted * b);
            }
        }
    }
    let mut reduced = Vec::new();
    for &at in coordinates {
        let row: Row = matrix.range((at, 0)..=(at, usize::MAX)).map(|((_, j), a)| (*j, a.clone())).collect();
        let row: Row = row.into_iter().filter(|(_, a)| !a.is_zero()).collect();
        match row.first() {
            None => continue,
            Some((first, _)) if *first != at => return None,
            Some((_, pivot)) => {
                let inverse = pivot.recip()?;
                for (i, a) in &row[1..] {
                    let factor = a * &inverse;
                    for (j, b) in row[1..].iter().filter(|(j, _)| i <= j) {
                        let sum = matrix.entry((*i, *j)).or_insert(Number::ZERO);
                        *sum = &*sum - &(&factor * b);
                    }
                }
                let normal = row.iter().map(|(j, a)| (*j, a * &inverse)).collect();
                reduced.push(Square { weight: pivot.clone(), row: normal });
            }
        }
    }
    Some(reduced)
}

impl Square {
    /// The exact row, sorted by coordinate and scaled so that its first entry is 1, and the matching weight.
    fn in_normal_form(&self) -> Option<(Vec<(usize, Rational)>, Number)> {
        let exact = |(i, a): &(usize, Number)| Some((*i, a.exact()?.clone()));
        let mut row = self.row.iter().map(exact).collect::<Option<Vec<_>>>()?;
        row.order_by_key(|(i, _)| *i);
        let first = row.first()?.1.clone();
        let inverse = first.recip()?;
        row.iter_mut().for_each(|(_, a)| *a = &*a * &inverse);
        Some((row, &self.weight * &Number::from(first).square()))
    }
}

/// A square w (p s + r . q')^2, split into its parts.
struct Split {
    weight: Number,
    factor: Number,
    rest: Row,
}

impl Split {
    fn of(square: Square, at: usize) -> Split {
        let (own, rest): (Row, Row) = square.row.into_iter().partition(|(i, _)| *i == at);
        let factor = own.into_iter().map(|(_, a)| a).next().unwrap_or(Number::ZERO);
        Split { weight: square.weight, factor, rest }
    }
}

/// a x + b y for sparse rows, without entries that are exactly zero.
fn linear_combination(a: &Number, x: &[(usize, Number)], b: &Number, y: &[(usize, Number)]) -> Row {
    let mut sum: Row = x.iter().map(|(i, x)| (*i, a * x)).collect();
    for (i, y) in y {
        let part = b * y;
        match sum.iter_mut().find(|(j, _)| j == i) {
            Some((_, entry)) => *entry = &*entry + &part,
            None => sum.push((*i, part)),
        }
    }
    sum.retain(|(_, entry)| !entry.is_zero());
    sum
}

/// A form of unnamed terms: sources are determined from the motion over all coordinates, not from these.
fn form(like: &Form, terms: impl Iterator<Item = (Number, Vec<(CoordinateId, Number)>)>) -> Form {
    let mut form = Form::new();
    if like.source_count() > 0 {
        let source = form.source(like.source_of(0));
        terms.for_each(|(weight, row)| form.push(source, Nature::Property, weight, row));
    }
    form
}
