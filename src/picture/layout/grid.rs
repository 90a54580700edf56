//! A large scene without coordinates: connected parts follow each other on a grid, with straight lines between them.

use super::parts::{GROUND, Parts};
use super::{Foot, Layout, Link, Outline, Placed};
use crate::model::scene::{Part, Scene};
use crate::picture::geometry::Point;

/// Between parts, px.
const PITCH: f64 = 26.0;

pub fn layout(scene: &Scene, parts: &Parts) -> Layout {
    let order = order(scene, parts);
    let side = (order.len() as f64).sqrt().ceil().max(1.0) as usize;
    let ground = Placed {
        at: Point::default(),
        origin: [0.0, 0.0],
        outline: Outline::Nowhere,
        arms: Vec::new(),
        axes: [Point::new(PITCH, 0.0), Point::new(0.0, -PITCH)],
        name_at: Vec::new(),
    };
    let mut placed = vec![ground; parts.count()];
    for (place, number) in order.iter().enumerate() {
        let (row, column) = (place / side, place % side);
        // Folded as a rope is.
        let column = if row % 2 == 0 { column } else { side - 1 - column };
        placed[*number].at = Point::new(column as f64 * PITCH, row as f64 * PITCH);
        placed[*number].outline = match parts.part(*number) {
            Part::Base(_) => Outline::Plate { along: Point::new(0.0, -1.0), half: 6.0 },
            Part::Ground | Part::Body(_) => Outline::Speck { half: 4.0 },
        };
    }
    let links = scene.elements.iter().map(|element| {
        let numbers = [0, 1].map(|end| parts.number(element.ends[end].part));
        let at = |end: usize| match numbers[end] {
            // A short line to the ground beside it.
            GROUND => placed[numbers[1 - end]].at.plus(Point::new(0.0, PITCH * 0.4)),
            number => placed[number].at,
        };
        let foot = |end: usize| Foot { part: numbers[end], at: at(end), lead: Vec::new(), wall: None };
        Link { feet: [foot(0), foot(1)], round: None }
    });
    let links = links.collect();
    let joints = scene.joints.iter().map(|joint| {
        let own = joint.ends.iter().map(|end| parts.number(end.part)).filter(|number| *number != GROUND);
        let points: Vec<Point> = own.map(|number| placed[number].at).collect();
        points.iter().fold(Point::default(), |sum, at| sum.towards(*at, 1.0 / points.len() as f64))
    });
    let joints = joints.collect();
    Layout { parts: placed, links, joints, scale: None }
}

/// Breadth first from the parts on bases and on the ground, in order of declaration.
fn order(scene: &Scene, parts: &Parts) -> Vec<usize> {
    let mut neighbours: Vec<Vec<u32>> = vec![Vec::new(); parts.count()];
    let elements = scene.elements.iter().map(|element| &element.ends);
    for ends in elements.chain(scene.joints.iter().map(|joint| &joint.ends)) {
        let [a, b] = [0, 1].map(|end| parts.number(ends[end].part));
        neighbours[a].push(b as u32);
        neighbours[b].push(a as u32);
    }
    let mut seen = vec![false; parts.count()];
    seen[GROUND] = true;
    let mut order = Vec::with_capacity(parts.count());
    let bases = (1 + parts.bodies..parts.count()).map(|base| base as u32);
    let starts = bases.chain(neighbours[GROUND].iter().copied()).chain(1..parts.count() as u32);
    for start in starts {
        if std::mem::replace(&mut seen[start as usize], true) {
            continue;
        }
        let mut next = order.len();
        order.push(start as usize);
        while next < order.len() {
            for &other in &neighbours[order[next]] {
                if !std::mem::replace(&mut seen[other as usize], true) {
                    order.push(other as usize);
                }
            }
            next += 1;
        }
    }
    order
}
