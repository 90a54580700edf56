//! The order of parts in a row: a column for each part, counted from the group's support, and its height across the
//! row.

use super::ties::Graph;
use crate::model::scene::{Part, Scene};
use crate::picture::geometry::Point;
use crate::picture::glyph::values::Says;
use crate::picture::layout::parts::{GROUND, Parts, WHEEL};
use crate::picture::layout::{Outline, REACH};
use std::collections::BTreeMap;

/// Distance between neighbours across a row, px: enough for a line of names.
const BETWEEN: f64 = 30.0;
/// The gap between a name and its neighbour, px.
const SPARE: f64 = 14.0;

pub struct Families<'a> {
    scene: &'a Scene,
    parts: &'a Parts,
    /// Numbers of parts, parents before their followers.
    pub members: Vec<usize>,
    places: BTreeMap<usize, usize>,
    /// The parent of each member.
    pub parent: Vec<Option<usize>>,
    pub column: Vec<usize>,
    /// Whether other members follow it in the row.
    pub has_followers: Vec<bool>,
    /// Touches its parent in the same column: a pair of gears.
    meshed: Vec<bool>,
    across: Vec<f64>,
    half: Vec<Point>,
    halves_along: Vec<f64>,
    pub upright: bool,
    /// The widest name of each member, and of the elements that tie it to its parent, px.
    name: Vec<f64>,
    tie: Vec<f64>,
    /// Whether several elements tie it to its parent.
    is_paired: Vec<bool>,
    /// Elements in series from its parent to it.
    length: Vec<usize>,
}

impl<'a> Families<'a> {
    pub fn of(
        scene: &'a Scene,
        parts: &'a Parts,
        says: &Says,
        graph: &Graph,
        group: &[usize],
        upright: bool,
    ) -> Families<'a> {
        let mut families = Families {
            scene,
            parts,
            members: Vec::new(),
            places: BTreeMap::new(),
            parent: Vec::new(),
            column: Vec::new(),
            has_followers: Vec::new(),
            meshed: Vec::new(),
            across: Vec::new(),
            half: Vec::new(),
            halves_along: Vec::new(),
            upright,
            name: Vec::new(),
            tie: Vec::new(),
            is_paired: Vec::new(),
            length: Vec::new(),
        };
        families.grow(graph, group);
        families.read(graph, says);
        families.size(graph, upright);
        families.spread(graph);
        families
    }

    pub fn place(&self, number: usize) -> Option<usize> {
        self.places.get(&number).copied()
    }

    /// Breadth first from the bases, else from the parts on the ground, else from an end.
    fn grow(&mut self, graph: &Graph, group: &[usize]) {
        for root in self.roots(graph, group) {
            self.add(root, None, 0, false);
        }
        let mut next = 0;
        while next < self.members.len() {
            let number = self.members[next];
            for &other in &graph.neighbours[number] {
                if self.places.contains_key(&other) {
                    continue;
                }
                let meshes = self.meshes_with(graph, number, other, next);
                let mut column = self.column[next] + usize::from(!meshes);
                // A part attached to one in the same column follows it.
                let tied = |column: usize| {
                    graph.neighbours[other].iter().any(|n| self.place(*n).is_some_and(|p| self.column[p] == column))
                };
                while !meshes && tied(column) {
                    column += 1;
                }
                // If it follows several, the nearest one.
                let mut placed = graph.neighbours[other].iter().filter_map(|n| self.place(*n));
                let before = placed.find(|p| !meshes && self.column[*p] + 1 == column);
                self.add(other, Some(before.unwrap_or(next)), column, meshes);
            }
            next += 1;
        }
    }

    fn read(&mut self, graph: &Graph, says: &Says) {
        self.name = self.members.iter().map(|number| says.part_width(*number)).collect();
        self.tie = vec![0.0; self.members.len()];
        self.is_paired = vec![false; self.members.len()];
        self.length = vec![1; self.members.len()];
        for bundle in &graph.bundles {
            let elements = bundle.strands.iter().flat_map(|strand| &strand.elements);
            let widest = elements.map(|element| says.element_width(*element)).fold(0.0, f64::max);
            let [a, b] = bundle.parts.map(|number| self.place(number));
            let tied = match (a, b) {
                (Some(a), Some(b)) => Some(if self.parent[b] == Some(a) { b } else { a }),
                (a, b) => a.or(b),
            };
            if let Some(tied) = tied {
                self.tie[tied] = self.tie[tied].max(widest);
                self.is_paired[tied] |= bundle.strands.len() > 1;
                // Only between two members; walls have a distance of their own.
                if a.is_some() && b.is_some() {
                    self.length[tied] = self.length[tied].max(bundle.length());
                }
            }
        }
    }

    /// The gap between a member and the next one across, px. Names stand between them, on both sides if there are pairs
    /// of elements.
    fn gap_between(&self, member: usize, next: usize) -> f64 {
        if !self.upright {
            return BETWEEN;
        }
        let before = if self.is_paired[next] { self.tie[next] + SPARE } else { 0.0 };
        self.name[member].max(self.tie[member]) + before + 2.0 * SPARE
    }

    /// The distance along the row from a column to the one before it, px. Names of elements fit above, names of parts
    /// below.
    pub fn step(&self, column: usize) -> f64 {
        let halves = self.half_along(column - 1) + self.half_along(column);
        let widest = |column: usize, of: &[f64]| {
            let members = (0..self.members.len()).filter(|member| self.column[*member] == column);
            members.map(|member| of[member]).fold(0.0, f64::max)
        };
        let longest = (0..self.members.len()).filter(|member| self.column[*member] == column);
        let length = longest.map(|member| self.length[member]).max().unwrap_or(1) as f64;
        if self.upright {
            return halves + REACH * length;
        }
        let (before, own) = (widest(column - 1, &self.name), widest(column, &self.name));
        let tied = halves + REACH.max(widest(column, &self.tie) + SPARE) * length;
        tied.max((before + own) / 2.0 + SPARE)
    }

    /// Between two rows of a fold, px.
    pub fn row_gap(&self) -> f64 {
        let widest = self.name.iter().chain(&self.tie).fold(0.0, |widest: f64, name| widest.max(*name));
        let pairs = (0..self.tie.len()).filter(|member| self.is_paired[*member]);
        let before = pairs.map(|member| self.tie[member] + SPARE).fold(0.0, f64::max);
        if self.upright { widest + before + 2.0 * SPARE } else { 56.0 }
    }

    fn add(&mut self, number: usize, parent: Option<usize>, column: usize, meshed: bool) {
        self.places.insert(number, self.members.len());
        self.members.push(number);
        self.parent.push(parent);
        self.column.push(column);
        self.meshed.push(meshed);
        self.has_followers.push(false);
        if let (Some(parent), false) = (parent, meshed) {
            self.has_followers[parent] = true;
        }
    }

    /// A wheel has room for two others that touch it in its own column.
    fn meshes_with(&self, graph: &Graph, number: usize, other: usize, place: usize) -> bool {
        let geared = graph.gears.iter().any(|gear| gear.parts == [number, other] || gear.parts == [other, number]);
        let meshed = (0..self.members.len()).filter(|m| self.meshed[*m] && self.parent[*m] == Some(place)).count();
        let wheels = [number, other].iter().all(|n| self.parts.only_turns(self.scene, *n));
        geared && wheels && !self.meshed[place] && meshed < 2
    }

    fn roots(&self, graph: &Graph, group: &[usize]) -> Vec<usize> {
        let is_base = |number: &&usize| matches!(self.parts.part(**number), Part::Base(_));
        let grounded: Vec<usize> = {
            let tied = graph.bundles.iter().filter(|bundle| bundle.parts[0] == GROUND).map(|bundle| bundle.parts[1]);
            let jointed = graph.meshes.iter().filter(|mesh| mesh.parts.contains(&GROUND));
            let all: Vec<usize> = tied.chain(jointed.map(|mesh| mesh.parts[0].max(mesh.parts[1]))).collect();
            group.iter().copied().filter(|number| all.contains(number)).collect()
        };
        let ends: Vec<usize> = group.iter().copied().filter(|number| graph.neighbours[*number].len() <= 1).collect();
        let ties: usize = group.iter().map(|number| graph.neighbours[*number].len()).sum();
        let is_path = ties == 2 * (group.len() - 1) && group.iter().all(|n| graph.neighbours[*n].len() <= 2);
        let bases: Vec<usize> = group.iter().filter(is_base).copied().collect();
        if is_path && bases.iter().all(|base| ends.contains(base)) {
            let first = ends.iter().find(|end| bases.contains(end));
            let first = first.or_else(|| ends.iter().find(|end| grounded.contains(end))).or(ends.first());
            return vec![*first.unwrap_or(&group[0])];
        }
        if !bases.is_empty() {
            return bases;
        }
        if !grounded.is_empty() {
            // Of parts that are tied to each other, only the first one is a root.
            let mut roots: Vec<usize> = Vec::new();
            for number in grounded {
                if !roots.iter().any(|root| graph.neighbours[*root].contains(&number)) {
                    roots.push(number);
                }
            }
            return roots;
        }
        // An end of a tree, or the part with the fewest ties.
        let fewest = group.iter().min_by_key(|number| graph.neighbours[**number].len());
        vec![*fewest.unwrap_or(&group[0])]
    }

    /// Sets the half sizes in row coordinates, wide enough for elements side by side.
    fn size(&mut self, graph: &Graph, upright: bool) {
        for &number in &self.members {
            let outline = self.parts.common_outline(self.scene, number, Point::new(1.0, 0.0));
            let half = outline.half();
            let is_plate = matches!(outline, Outline::Plate { .. });
            self.half.push(if upright && !is_plate { Point::new(half.y, half.x) } else { half });
        }
        for bundle in &graph.bundles {
            let needed = bundle.half(self.scene);
            for number in bundle.parts {
                let Some(place) = self.place(number) else { continue };
                self.widen(place, needed);
            }
        }
        for gear in &graph.gears {
            let [Some(a), Some(b)] = gear.parts.map(|number| self.place(number)) else { continue };
            let ratio = gear.ratio.abs().clamp(0.4, 2.5);
            if self.meshed[b] && self.parent[b] == Some(a) {
                let radius = (self.half[a].x / ratio).max(14.0);
                self.half[b] = Point::new(radius, radius);
            } else if self.meshed[a] && self.parent[a] == Some(b) {
                let radius = (self.half[b].x * ratio).max(14.0);
                self.half[a] = Point::new(radius, radius);
            }
        }
    }

    fn widen(&mut self, place: usize, needed: f64) {
        let is_round = self.is_round(place);
        let half = &mut self.half[place];
        half.y = half.y.max(needed);
        if is_round {
            half.x = half.y;
        }
    }

    fn is_round(&self, place: usize) -> bool {
        let outline = self.parts.common_outline(self.scene, self.members[place], Point::new(1.0, 0.0));
        matches!(outline, Outline::Disk { .. } | Outline::Ring { .. } | Outline::Wheel { .. } | Outline::Dot { .. })
    }

    /// Sets the heights across the row: each part in the middle of its followers, and families beside each other.
    fn spread(&mut self, graph: &Graph) {
        let count = self.members.len();
        // Room that each family needs on both sides of its first member, and the place of each in its parent's.
        let mut room = vec![[0.0f64; 2]; count];
        let mut shift = vec![0.0f64; count];
        let mut children: Vec<Vec<usize>> = vec![Vec::new(); count];
        for (member, parent) in self.parent.iter().enumerate() {
            if let Some(parent) = parent {
                children[*parent].push(member);
            }
        }
        let width = self.bundle_widths(graph);
        for member in (0..count).rev() {
            let (meshed, followers): (Vec<usize>, Vec<usize>) =
                children[member].iter().partition(|child| self.meshed[**child]);
            let total: f64 = followers.iter().map(|child| room[*child][0] + room[*child][1]).sum::<f64>()
                + followers.windows(2).map(|pair| self.gap_between(pair[0], pair[1])).sum::<f64>();
            let mut at = -total / 2.0;
            for (number, &child) in followers.iter().enumerate() {
                shift[child] = at + room[child][0];
                let next = followers.get(number + 1);
                at += room[child][0] + room[child][1] + next.map_or(0.0, |next| self.gap_between(child, *next));
            }
            // The first and the last equally far from the middle.
            if let (Some(&first), Some(&last)) = (followers.first(), followers.last()) {
                let middle = (shift[first] + shift[last]) / 2.0;
                followers.iter().for_each(|child| shift[*child] -= middle);
                for &child in &followers {
                    self.widen(member, shift[child].abs() + width[child]);
                }
            }
            let mut own = [self.half[member].y; 2];
            for &child in &followers {
                own[0] = own[0].max(room[child][0] - shift[child]);
                own[1] = own[1].max(room[child][1] + shift[child]);
            }
            for (number, &child) in meshed.iter().enumerate() {
                let (side, sign) = if number == 0 { (0, -1.0) } else { (1, 1.0) };
                let behind = self.has_followers[child] && !followers.is_empty();
                let needed = if behind { own[side] + room[child][1 - side] + BETWEEN / 2.0 } else { 0.0 };
                let touching = self.half[member].y + self.half[child].y;
                if needed > touching {
                    let grown = needed - self.half[member].y;
                    room[child][side] += grown - self.half[child].y;
                    self.half[child] = Point::new(grown, grown);
                }
                let distance = self.half[member].y + self.half[child].y;
                shift[child] = sign * distance;
                own[side] = own[side].max(distance + room[child][side].max(self.half[child].y));
            }
            room[member] = own;
        }
        self.across = vec![0.0; count];
        let mut next = 0.0;
        for member in 0..count {
            self.across[member] = match self.parent[member] {
                Some(parent) => self.across[parent] + shift[member],
                None => {
                    let at = next + room[member][0];
                    next = at + room[member][1] + self.gap_between(member, member);
                    at
                }
            };
        }
        let columns = self.column.iter().max().map_or(0, |last| last + 1);
        self.halves_along = vec![0.0; columns];
        for member in 0..count {
            let half = &mut self.halves_along[self.column[member]];
            *half = half.max(self.half[member].x);
        }
    }

    /// Half of the room that the elements between each member and its parent take.
    fn bundle_widths(&self, graph: &Graph) -> Vec<f64> {
        let mut widths = vec![6.0f64; self.members.len()];
        for bundle in &graph.bundles {
            let [Some(a), Some(b)] = bundle.parts.map(|number| self.place(number)) else { continue };
            let child = if self.parent[b] == Some(a) { b } else { a };
            widths[child] = bundle.half(self.scene);
        }
        widths
    }

    pub fn columns(&self) -> usize {
        self.halves_along.len()
    }

    /// Half of the widest part of a column.
    pub fn half_along(&self, column: usize) -> f64 {
        self.halves_along[column]
    }

    pub fn height(&self, member: usize) -> f64 {
        self.across[member]
    }

    pub fn half_across(&self, member: usize) -> f64 {
        self.half[member].y
    }

    pub fn outline(&self, member: usize) -> Outline {
        let half = self.half[member];
        match self.parts.common_outline(self.scene, self.members[member], Point::new(1.0, 0.0)) {
            Outline::Block { .. } => Outline::Block { half },
            Outline::Box { .. } => Outline::Box { half, along: Point::new(1.0, 0.0) },
            Outline::Disk { .. } => Outline::Disk { radius: half.y.max(WHEEL) },
            Outline::Ring { .. } => Outline::Ring { radius: half.y.max(WHEEL) },
            Outline::Wheel { .. } => Outline::Wheel { radius: half.y },
            Outline::Plate { along, .. } => Outline::Plate { along, half: half.y },
            other => other,
        }
    }
}
