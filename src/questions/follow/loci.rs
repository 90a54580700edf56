//! Poles followed along the parameter: the root locus as curves. In: the poles at each value. Out: for each pole of one
//! value its continuation at the next, and whether it is proved. See docs/method/studies.md#loci.

use super::places::{Field, binary};
use crate::analysis::range::Family;
use crate::analysis::{self, Request};
use crate::base::{Ball, Number, OrderBy};
use crate::kernel::complex::{Complex, arc};
use crate::kernel::cores;
use crate::questions::answer::Proved;
use crate::questions::followed::Locus;
use std::f64::consts::TAU;

/// Limit on the coordinates of a model whose links are proved, because each proof solves dense equations in balls.
const MOST_COORDINATES: usize = 12;
/// Limit on the halvings of a step.
const DEEPEST: u32 = 6;
/// Arcs into which a circle is divided at first, and limit on the halvings of each.
const ARCS: usize = 16;
const MOST_HALVINGS: u32 = 4;
/// Covers a few roundings in binary64.
const MARGIN: f64 = 1e-12;

/// The poles at a value of the parameter.
struct Spot {
    at: Number,
    poles: Vec<Complex<Ball>>,
}

/// For each pole the one at the next value, and whether that is proved.
type Links = Vec<(usize, bool)>;

/// The poles as curves; none if not all poles are known at each value.
pub fn loci(field: &Field, values: &[Number]) -> Vec<Locus> {
    let found = cores::in_pieces(values, 1, 1, |some| some.iter().map(|at| spot(field, at)).collect());
    let Some(spots) = found.into_iter().collect::<Option<Vec<Spot>>>() else { return Vec::new() };
    let count = spots.first().map_or(0, |spot| spot.poles.len());
    if spots.iter().any(|spot| spot.poles.len() != count) {
        return Vec::new();
    }
    let steps: Vec<&[Spot]> = spots.windows(2).collect();
    let links: Vec<Links> =
        cores::in_pieces(&steps, 1, 1, |some| some.iter().map(|ends| link(field, [&ends[0], &ends[1]], 0)).collect());
    (0..count).map(|first| locus(&spots, &links, first)).collect()
}

fn locus(spots: &[Spot], links: &[Links], first: usize) -> Locus {
    let (mut own, mut locus) = (first, Locus { points: Vec::new(), links: vec![None] });
    for (i, spot) in spots.iter().enumerate() {
        let pole = spot.poles[own];
        locus.points.push([pole.re, pole.im]);
        if let Some(links) = links.get(i) {
            let (next, is_proved) = links[own];
            locus.links.push(is_proved.then_some(Proved(())));
            own = next;
        }
    }
    locus
}

/// All poles at a value; `None` if it is not proved that the list is complete.
fn spot(field: &Field, at: &Number) -> Option<Spot> {
    let system = field.study.system(0, at.clone(), true).filter(|system| !system.is_chained())?;
    let poles = analysis::modal(&system, &Request::default()).ok()?.poles;
    let is_known = poles.is_complete() && poles.list.len() == 2 * system.n();
    let list = poles.list.iter().map(|pole| Complex::new(pole.re, pole.im));
    is_known.then(|| Spot { at: at.clone(), poles: list.collect() })
}

/// The links of a step. The step is halved if a link is not proved.
fn link(field: &Field, ends: [&Spot; 2], depth: u32) -> Links {
    let system = field.system_over([&ends[0].at, &ends[1].at], true).filter(|system| system.n() <= MOST_COORDINATES);
    let proved: Vec<Option<usize>> = match system.as_ref().and_then(|system| Family::of(system, false)) {
        Some(family) => (0..ends[0].poles.len()).map(|i| proved_end(&family, ends, i)).collect(),
        None => vec![None; ends[0].poles.len()],
    };
    let is_open = proved.iter().any(Option::is_none);
    // If the model has no single form over the step, it is halved a few times only.
    let deepest = if system.is_some() { DEEPEST } else { 2 };
    if is_open
        && depth < deepest
        && let Some(middle) = middle_spot(field, ends)
    {
        let [first, second] = [[ends[0], &middle], [&middle, ends[1]]].map(|ends| link(field, ends, depth + 1));
        return first.iter().map(|&(i, known)| (second[i].0, known && second[i].1)).collect();
    }
    nearest(ends, &proved)
}

fn middle_spot(field: &Field, ends: [&Spot; 2]) -> Option<Spot> {
    let [low, high] = ends.map(|spot| spot.at.to_f64());
    let middle = low + (high - low) / 2.0;
    let is_inside = middle > low.min(high) && middle < low.max(high);
    let spot = spot(field, &binary(middle).filter(|_| is_inside)?)?;
    (spot.poles.len() == ends[0].poles.len()).then_some(spot)
}

/// The pole at the end of a step that continues a pole at its beginning, with proof: a circle contains one pole at both
/// ends, and no pole lies on it for any value in the step, so the number inside does not change.
fn proved_end(family: &Family, [from, to]: [&Spot; 2], i: usize) -> Option<usize> {
    let start = from.poles[i];
    let nearest = |a: &usize, b: &usize| distance(start, to.poles[*a]).total_cmp(&distance(start, to.poles[*b]));
    let j = (0..to.poles.len()).min_by(nearest)?;
    let half = |a: Ball, b: Ball| Ball::exact(((a + b) * Ball::from(0.5)).mid);
    let centre = Complex::new(half(start.re, to.poles[j].re), half(start.im, to.poles[j].im));
    let others = |spot: &Spot, own: usize| {
        let list = spot.poles.iter().enumerate().filter(move |(at, _)| *at != own);
        list.map(|(_, pole)| *pole - centre).map(distance_bounds).fold(f64::INFINITY, |least, [low, _]| least.min(low))
    };
    let outer = others(from, i).min(others(to, j));
    let inner = [start, to.poles[j]].map(|pole| distance_bounds(pole - centre)[1]).into_iter().fold(0.0, f64::max);
    let radius = 0.5 * (inner + outer);
    let is_between = inner < radius * (1.0 - MARGIN) && radius * (1.0 + MARGIN) < outer;
    (is_between && has_no_pole_on(family, centre, radius)).then_some(j)
}

/// Whether certainly no pole lies on a circle, for any value in the step.
fn has_no_pole_on(family: &Family, centre: Complex<Ball>, radius: f64) -> bool {
    let mut left: Vec<([f64; 2], u32)> =
        (0..ARCS).map(|i| ([i, i + 1].map(|i| TAU * i as f64 / ARCS as f64), 0)).collect();
    while let Some((ends, depth)) = left.pop() {
        if family.has_no_pole_at(arc(centre, radius, ends)) {
            continue;
        }
        if depth == MOST_HALVINGS {
            return false;
        }
        let middle = 0.5 * (ends[0] + ends[1]);
        left.extend([[ends[0], middle], [middle, ends[1]]].map(|half| (half, depth + 1)));
    }
    true
}

/// Bounds of a modulus.
fn distance_bounds(z: Complex<Ball>) -> [f64; 2] {
    let least = Complex::new(z.re.mignitude(), z.im.mignitude()).abs();
    [least * (1.0 - MARGIN), z.magnitude()]
}

fn distance(a: Complex<Ball>, b: Complex<Ball>) -> f64 {
    let [x, y] = [a.re.to_f64() - b.re.to_f64(), a.im.to_f64() - b.im.to_f64()];
    x.abs().max(y.abs())
}

/// The proved links; the remaining poles are paired by distance, the nearest pair first.
fn nearest([from, to]: [&Spot; 2], proved: &[Option<usize>]) -> Links {
    let mut links: Vec<Option<(usize, bool)>> = proved.iter().map(|link| Some(((*link)?, true))).collect();
    let mut is_taken = vec![false; to.poles.len()];
    proved.iter().flatten().for_each(|&j| is_taken[j] = true);
    let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
    for i in (0..links.len()).filter(|&i| links[i].is_none()) {
        let free = (0..is_taken.len()).filter(|&j| !is_taken[j]);
        pairs.extend(free.map(|j| (distance(from.poles[i], to.poles[j]), i, j)));
    }
    pairs.order_by(|a, b| a.0.total_cmp(&b.0));
    for (_, i, j) in pairs {
        if links[i].is_none() && !is_taken[j] {
            links[i] = Some((j, false));
            is_taken[j] = true;
        }
    }
    links.into_iter().enumerate().map(|(i, link)| link.unwrap_or((i, false))).collect()
}
