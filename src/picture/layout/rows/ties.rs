//! The connections between the parts of a scene without coordinates.

use crate::base::{Number, OrderBy};
use crate::model::scene::{Geometry, Motion, Part, Scene};
use crate::picture::geometry::Point;
use crate::picture::layout::parts::{GROUND, Parts};
use crate::picture::layout::{Outline, SIDE, TWISTED};
use std::collections::BTreeMap;

/// A graph with parts as nodes and their connections as edges.
pub struct Graph {
    /// Elements by the two parts that they tie, the smaller number first, in order of their first element.
    pub bundles: Vec<Bundle>,
    pub meshes: Vec<Mesh>,
    pub gears: Vec<Gear>,
    /// The neighbours of each part, in order of declaration.
    pub neighbours: Vec<Vec<usize>>,
    /// Parts that lie within a strand.
    is_between: Vec<bool>,
}

/// The connections between two parts, side by side.
pub struct Bundle {
    pub parts: [usize; 2],
    pub strands: Vec<Strand>,
}

/// One element, or several in series with massless bodies between them, as in a Maxwell branch.
#[derive(Clone, Debug)]
pub struct Strand {
    /// The elements, from the first part of the bundle to the second.
    pub elements: Vec<usize>,
    pub between: Vec<usize>,
}

impl Bundle {
    /// Between the axes of two strands, px.
    pub fn side(&self, scene: &Scene) -> f64 {
        let turns = |element: &usize| scene.elements[*element].law.geometry == Geometry::Torsion;
        if self.strands.iter().flat_map(|strand| &strand.elements).any(turns) { TWISTED } else { SIDE }
    }

    /// Half of the room that all strands take, px.
    pub fn half(&self, scene: &Scene) -> f64 {
        self.strands.len() as f64 * self.side(scene) / 2.0 + 3.0
    }

    /// Elements in the longest strand.
    pub fn length(&self) -> usize {
        self.strands.iter().map(|strand| strand.elements.len()).max().unwrap_or(1)
    }
}

/// A joint between two parts.
pub struct Mesh {
    pub joint: usize,
    pub parts: [usize; 2],
}

/// Two wheels that turn against each other: radii in the ratio `ratio` = first / second.
pub struct Gear {
    pub parts: [usize; 2],
    pub ratio: f64,
}

impl Graph {
    /// The graph of the free parts and the ground.
    pub fn of(scene: &Scene, parts: &Parts, free: &[bool]) -> Graph {
        let is_free = |pair: &[usize; 2]| pair.iter().all(|number| *number == GROUND || free[*number]);
        let mut graph = Graph {
            bundles: Vec::new(),
            meshes: Vec::new(),
            gears: Vec::new(),
            neighbours: vec![Vec::new(); parts.count()],
            is_between: vec![false; parts.count()],
        };
        let mut known: BTreeMap<[usize; 2], usize> = BTreeMap::new();
        for (pair, strand) in strands(scene, parts, free, &mut graph.is_between) {
            let place = *known.entry(pair).or_insert(graph.bundles.len());
            match graph.bundles.get_mut(place) {
                Some(bundle) => bundle.strands.push(strand),
                None => {
                    graph.bundles.push(Bundle { parts: pair, strands: vec![strand] });
                    graph.join(pair);
                }
            }
        }
        for (joint, of) in scene.joints.iter().enumerate() {
            let pair = [0, 1].map(|end| parts.number(of.ends[end].part));
            if !is_free(&pair) {
                continue;
            }
            graph.meshes.push(Mesh { joint, parts: pair });
            graph.join(pair);
        }
        for couple in &scene.couples {
            let numbers: Vec<usize> = couple.terms.iter().filter_map(|term| moved_part(&term.motion, parts)).collect();
            for pair in numbers.windows(2).map(|pair| [pair[0], pair[1]]).filter(is_free) {
                graph.join(pair);
            }
            if let Some(gear) = gear(&couple.terms, parts).filter(|gear| is_free(&gear.parts)) {
                graph.gears.push(gear);
            }
        }
        graph
    }

    fn join(&mut self, [a, b]: [usize; 2]) {
        if a != b && a != GROUND && b != GROUND && !self.neighbours[a].contains(&b) {
            self.neighbours[a].push(b);
            self.neighbours[b].push(a);
        }
    }

    /// The sets of connected free parts, without the ground.
    pub fn groups(&self, parts: &Parts, free: &[bool]) -> Vec<Vec<usize>> {
        let mut seen: Vec<bool> = free.iter().map(|free| !free).collect();
        let mut groups = Vec::new();
        for start in 1..parts.count() {
            if seen[start] || self.is_between[start] {
                continue;
            }
            seen[start] = true;
            let mut group = vec![start];
            let mut next = 0;
            while next < group.len() {
                for &other in &self.neighbours[group[next]] {
                    if !std::mem::replace(&mut seen[other], true) {
                        group.push(other);
                    }
                }
                next += 1;
            }
            group.sort_unstable();
            groups.push(group);
        }
        groups
    }
}

/// The strands between two parts each, the smaller number first, in order of declaration.
fn strands(scene: &Scene, parts: &Parts, free: &[bool], is_between: &mut [bool]) -> Vec<([usize; 2], Strand)> {
    let ends = |element: usize| [0, 1].map(|end| parts.number(scene.elements[element].ends[end].part));
    let mut tied: Vec<Vec<usize>> = vec![Vec::new(); parts.count()];
    for element in 0..scene.elements.len() {
        ends(element).into_iter().for_each(|number| tied[number].push(element));
    }
    let mut held = vec![false; parts.count()];
    for end in scene.joints.iter().flat_map(|joint| &joint.ends) {
        held[parts.number(end.part)] = true;
    }
    for motion in
        scene.couples.iter().flat_map(|couple| &couple.terms).filter_map(|term| moved_part(&term.motion, parts))
    {
        held[motion] = true;
    }
    let far = |element: usize, number: usize| ends(element).into_iter().find(|end| *end != number).unwrap_or(number);
    let is_free = |number: usize| number == GROUND || free[number];
    let is_dot = |n: usize| matches!(parts.common_outline(scene, n, Point::new(1.0, 0.0)), Outline::Dot { .. });
    let mut list = Vec::new();
    let mut taken = vec![false; scene.elements.len()];
    for number in 1..parts.count() {
        let [first, second] = tied[number][..] else { continue };
        let (a, b) = (far(first, number), far(second, number));
        // Neighbours in series are not looked for beyond one.
        if ![number, a, b].into_iter().all(is_free) {
            continue;
        }
        if held[number] || !is_dot(number) || a == b || a == number || b == number || is_between[a] || is_between[b] {
            continue;
        }
        is_between[number] = true;
        (taken[first], taken[second]) = (true, true);
        let elements = if a < b { vec![first, second] } else { vec![second, first] };
        list.push((first.min(second), [a.min(b), a.max(b)], Strand { elements, between: vec![number] }));
    }
    for element in (0..scene.elements.len()).filter(|element| !taken[*element]) {
        let [a, b] = ends(element);
        if !is_free(a) || !is_free(b) {
            continue;
        }
        list.push((element, [a.min(b), a.max(b)], Strand { elements: vec![element], between: Vec::new() }));
    }
    list.order_by_key(|(element, ..)| *element);
    list.into_iter().map(|(_, pair, strand)| (pair, strand)).collect()
}

fn moved_part(motion: &Motion, parts: &Parts) -> Option<usize> {
    let part = match motion {
        Motion::Point { part, .. } | Motion::Turn { part, .. } => *part,
        Motion::Force { .. } | Motion::Stretch { .. } | Motion::Reaction(_) => return None,
    };
    (part != Part::Ground).then(|| parts.number(part))
}

/// Two angles that run against each other.
pub fn gear(terms: &[crate::model::scene::MotionTerm], parts: &Parts) -> Option<Gear> {
    let [first, second] = terms else { return None };
    let turns = |motion: &Motion| match motion {
        Motion::Turn { part, derivative: 0 } if *part != Part::Ground => Some(parts.number(*part)),
        _ => None,
    };
    let numbers = [turns(&first.motion)?, turns(&second.motion)?];
    // a p + b q = 0 with a and b of one sign: q = -(a / b) p.
    let (a, b): (&Number, &Number) = (&first.coefficient, &second.coefficient);
    let against = (a.is_positive() && b.is_positive()) || (a.is_negative() && b.is_negative());
    (against && numbers[0] != numbers[1]).then(|| Gear { parts: numbers, ratio: a.to_f64() / b.to_f64() })
}
