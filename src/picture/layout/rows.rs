//! The layout of a scene without coordinates: along its motion, from its support outwards, with parallel paths side by
//! side. A row that gets too long is folded like a rope. In this file, *along* means along the row, and *across* means
//! to its right hand: down the page for a row to the right, to the right for a column upwards.

mod families;
mod folds;
mod ties;

use super::parts::{DOT, GROUND, Parts, straight};
use super::{Foot, Layout, Link, Outline, Placed, REACH, SIDE};
use crate::model::scene::Scene;
use crate::picture::geometry::{Bounds, Point};
use crate::picture::glyph::values::Says;
use families::Families;
use folds::Folds;
use ties::{Bundle, Graph, Strand};

/// Pixels that a metre of motion is drawn with in a scene without lengths; modes are drawn not to scale.
const METRE: f64 = 100.0;
/// Distance between unconnected groups of parts, px.
const APART: f64 = 44.0;

/// A scene in which no part has a place.
pub fn layout(scene: &Scene, parts: &Parts, says: &Says) -> Layout {
    let mut page = Page::new(scene, parts);
    let mut below = Below { down: 0.0, left: 0.0, right: 0.0 };
    let (level, upright): (Vec<_>, Vec<_>) =
        groups(scene, parts, says, METRE, &vec![true; parts.count()]).into_iter().partition(Block::is_level);
    for mut block in level.into_iter().chain(upright) {
        below.set(&mut block);
        page.put(block);
    }
    page.finish()
}

/// The groups of connected parts among the free ones, each laid out by itself. `metre` is the number of pixels per
/// metre.
pub fn groups(scene: &Scene, parts: &Parts, says: &Says, metre: f64, free: &[bool]) -> Vec<Block> {
    let graph = Graph::of(scene, parts, free);
    let block = |group: &Vec<usize>| {
        let upright = is_upright(scene, parts, group);
        let row = Row::of(scene, parts, says, &graph, group, upright);
        Block::of(&row, &graph, if upright { Frame::UPRIGHT } else { Frame::LEVEL }, metre)
    };
    graph.groups(parts, free).iter().map(block).collect()
}

/// The place for the next groups: horizontal ones below each other, then upright ones side by side.
#[derive(Clone, Copy, Debug)]
pub struct Below {
    pub down: f64,
    pub left: f64,
    pub right: f64,
}

impl Below {
    pub fn set(&mut self, block: &mut Block) {
        let Bounds { low, high } = block.bounds;
        if block.is_level() {
            // Supports of rows are aligned below each other.
            block.shift(Point::new(self.left, self.down - low.y));
            self.down += high.y - low.y + APART;
        } else {
            block.shift(Point::new(self.right - low.x, self.down - low.y));
            self.right += high.x - low.x + APART;
        }
    }
}

/// Whether most parts of a group move up and down.
fn is_upright(scene: &Scene, parts: &Parts, group: &[usize]) -> bool {
    let votes = group.iter().filter_map(|number| parts.translations(scene, *number).first());
    let upright = votes.map(|t| straight(&t.direction)).map(|[x, y]| if y.abs() > x.abs() { 1 } else { -1 });
    upright.sum::<i64>() > 0
}

/// The map from rows to the page.
#[derive(Clone, Copy, Debug)]
struct Frame {
    along: Point,
    across: Point,
}

impl Frame {
    const LEVEL: Frame = Frame { along: Point::new(1.0, 0.0), across: Point::new(0.0, 1.0) };
    const UPRIGHT: Frame = Frame { along: Point::new(0.0, -1.0), across: Point::new(1.0, 0.0) };

    /// In a column, names of parts stand beside it: elements leave no room above and below.
    fn names(&self) -> Vec<Point> {
        if self.along.x == 0.0 { vec![self.across, self.across.times(-1.0)] } else { Vec::new() }
    }

    fn point(&self, p: Point) -> Point {
        self.along.times(p.x).plus(self.across.times(p.y))
    }
}

/// A group of parts in row coordinates: x along, y across.
struct Row<'a> {
    scene: &'a Scene,
    parts: &'a Parts,
    /// The members in the order in which they were found.
    members: Vec<usize>,
    /// The position of each member.
    at: Vec<Point>,
    outline: Vec<Outline>,
    /// 1, or -1 in a row that runs back.
    way: Vec<f64>,
    links: Vec<(usize, Link)>,
}

impl<'a> Row<'a> {
    fn of(scene: &'a Scene, parts: &'a Parts, says: &Says, graph: &Graph, group: &[usize], upright: bool) -> Row<'a> {
        let families = Families::of(scene, parts, says, graph, group, upright);
        let folds = Folds::of(&families, upright);
        let count = families.members.len();
        let at = (0..count).map(|member| folds.at(&families, member)).collect();
        let way = (0..count).map(|member| folds.direction_of(families.column[member])).collect();
        let outline = (0..count).map(|member| families.outline(member)).collect();
        let mut row = Row { scene, parts, members: families.members.clone(), at, outline, way, links: Vec::new() };
        row.tie(graph, &families, &folds);
        row
    }

    fn bounds(&self) -> Bounds {
        let own = self.at.iter().zip(&self.outline).map(|(at, outline)| Bounds::around(*at, outline.half()));
        let feet = self.links.iter().flat_map(|(_, link)| &link.feet);
        let feet = feet.flat_map(|foot| std::iter::once(&foot.at).chain(&foot.lead));
        feet.fold(own.fold(Bounds::EMPTY, Bounds::and), |bounds, point| bounds.with(*point)).grow(14.0)
    }

    /// A metre of the scene on the page: along the row for the motion of the part.
    fn axes(&self, number: usize, along: Point, metre: f64) -> [Point; 2] {
        match self.parts.translations(self.scene, number) {
            [only] => {
                let [x, y] = straight(&only.direction);
                [along.times(x * metre), along.times(y * metre)]
            }
            _ => [Point::new(metre, 0.0), Point::new(0.0, -metre)],
        }
    }

    /// The feet of every element of the group.
    fn tie(&mut self, graph: &Graph, families: &Families, folds: &Folds) {
        let mut lanes = Lanes::new(self.bounds());
        for bundle in &graph.bundles {
            let Some(a) = families.place(bundle.parts[0]) else {
                // The ground is the first of two.
                if let (GROUND, Some(member)) = (bundle.parts[0], families.place(bundle.parts[1])) {
                    self.tie_to_ground(bundle, member, families, folds, &mut lanes);
                }
                continue;
            };
            let Some(b) = families.place(bundle.parts[1]) else { continue };
            self.tie_two(bundle, [a, b], families, folds, &mut lanes);
        }
    }

    fn tie_two(&mut self, bundle: &Bundle, [a, b]: [usize; 2], families: &Families, folds: &Folds, lanes: &mut Lanes) {
        let (near, far) = if families.parent[b] == Some(a) { (a, b) } else { (b, a) };
        let neighbours = families.parent[far] == Some(near) && families.column[near] + 1 == families.column[far];
        if !neighbours {
            return self.tie_below(bundle, [Some(a), Some(b)], lanes);
        }
        let side = bundle.side(self.scene);
        let folded = folds.row(families.column[near]) != folds.row(families.column[far]);
        for (number, strand) in bundle.strands.iter().enumerate() {
            let offset = (number as f64 - (bundle.strands.len() as f64 - 1.0) / 2.0) * side;
            let (way, lane) = (self.way[near], self.at[far].y + offset);
            let first = if folded {
                // The fold begins at the near one's own height.
                self.face(near, Point::new(way, 0.0), self.at[near].y + offset)
            } else {
                self.face(near, Point::new(way, 0.0), lane)
            };
            let second = if folded {
                let corner = first.x + way * (REACH + 12.0 + 8.0 * number as f64);
                let into = self.face(far, Point::new(way, 0.0), lane);
                let lead = vec![Point::new(corner, first.y), Point::new(corner, into.y), into];
                Foot { part: self.members[far], at: Point::new(first.x + way * REACH, first.y), lead, wall: None }
            } else {
                let into = self.face(far, Point::new(-way, 0.0), lane);
                Foot { part: self.members[far], at: into, lead: Vec::new(), wall: None }
            };
            let first = Foot { part: self.members[near], at: first, lead: Vec::new(), wall: None };
            let feet = if near == a { [first, second] } else { [second, first] };
            self.push(strand, feet, way);
        }
    }

    /// The point where a line along the row at a given height meets a member.
    fn face(&self, member: usize, outwards: Point, height: f64) -> Point {
        let from = Point::new(self.at[member].x, height);
        let inside = from.minus(self.at[member]);
        from.towards(outwards, self.outline[member].reach(inside, outwards))
    }

    fn tie_to_ground(&mut self, bundle: &Bundle, member: usize, families: &Families, folds: &Folds, lanes: &mut Lanes) {
        let way = self.way[member];
        let outwards = match () {
            () if families.parent[member].is_none() && folds.starts(families.column[member]) => -way,
            () if !families.has_followers[member] => way,
            () => return self.tie_below(bundle, [None, Some(member)], lanes),
        };
        let (side, length) = (bundle.side(self.scene), bundle.length() as f64);
        for (number, strand) in bundle.strands.iter().enumerate() {
            let offset = (number as f64 - (bundle.strands.len() as f64 - 1.0) / 2.0) * side;
            let direction = Point::new(outwards, 0.0);
            let at = self.face(member, direction, self.at[member].y + offset);
            // The walls of a column are in line.
            let half = families.half_along(families.column[member]);
            let wall = Point::new(self.at[member].x + outwards * (half + REACH * length), at.y);
            let ground = Foot { part: GROUND, at: wall, lead: Vec::new(), wall: Some(direction) };
            let own = Foot { part: self.members[member], at, lead: Vec::new(), wall: None };
            self.push(strand, [ground, own], way);
        }
    }

    /// Draws elements that pass other parts in a separate lane below the row; `None` is the ground.
    fn tie_below(&mut self, bundle: &Bundle, ends: [Option<usize>; 2], lanes: &mut Lanes) {
        for strand in &bundle.strands {
            let x = ends.map(|end| end.map(|member| self.at[member].x));
            let span = match x {
                [Some(a), Some(b)] if (a - b).abs() > REACH => [a, b],
                [Some(a), Some(_)] => [a, a + REACH + 24.0],
                [None, Some(b)] => [b - REACH - 30.0, b],
                [Some(a), None] => [a, a - REACH - 30.0],
                [None, None] => [0.0, REACH],
            };
            let lane = lanes.next(span);
            let foot = |end: usize| -> Foot {
                let inwards = if span[1 - end] > span[end] { 1.0 } else { -1.0 };
                let Some(member) = ends[end] else {
                    let wall = Some(Point::new(-inwards, 0.0));
                    return Foot { part: GROUND, at: Point::new(span[end], lane), lead: Vec::new(), wall };
                };
                let bottom = Point::new(self.at[member].x, self.at[member].y + self.outline[member].half().y);
                let corner = Point::new(span[end], lane);
                let mut lead = vec![corner];
                if (corner.x - bottom.x).abs() > 1.0 {
                    lead.push(Point::new(corner.x, self.at[member].y));
                    lead.push(Point::new(self.at[member].x, self.at[member].y));
                } else {
                    lead.push(bottom);
                }
                Foot { part: self.members[member], at: corner.towards(Point::new(inwards, 0.0), 6.0), lead, wall: None }
            };
            let feet = [foot(0), foot(1)];
            self.push(strand, feet, 1.0);
        }
    }

    /// Adds the elements of a strand between two feet, which are the ends of the strand. The elements in between are
    /// placed at equal distances.
    fn push(&mut self, strand: &Strand, feet: [Foot; 2], way: f64) {
        let count = strand.elements.len();
        let [start, end] = [feet[0].at, feet[1].at];
        for (place, number) in strand.between.iter().enumerate() {
            let at = start.plus(end.minus(start).times((place + 1) as f64 / count as f64));
            self.members.push(*number);
            self.at.push(at);
            self.outline.push(Outline::Dot { radius: DOT });
            self.way.push(way);
        }
        for (place, element) in strand.elements.iter().enumerate() {
            let foot = |side: usize| -> Foot {
                match (side, place) {
                    (0, 0) => feet[0].clone(),
                    (1, last) if last + 1 == count => feet[1].clone(),
                    _ => {
                        let at = start.plus(end.minus(start).times((place + side) as f64 / count as f64));
                        Foot { part: strand.between[place + side - 1], at, lead: Vec::new(), wall: None }
                    }
                }
            };
            let (a, b) = (foot(0), foot(1));
            // In the order of the element's own ends.
            let first = self.parts.number(self.scene.elements[*element].ends[0].part);
            let feet = if a.part == first { [a, b] } else { [b, a] };
            self.links.push((*element, Link { feet, round: None }));
        }
    }
}

/// The lanes below a row, each with the intervals that are taken.
struct Lanes {
    first: f64,
    taken: Vec<Vec<[f64; 2]>>,
}

impl Lanes {
    fn new(bounds: Bounds) -> Lanes {
        Lanes { first: bounds.high.y + 16.0, taken: Vec::new() }
    }

    /// The first lane that is free along a span.
    fn next(&mut self, span: [f64; 2]) -> f64 {
        const ROOM: f64 = 30.0;
        let (low, high) = (span[0].min(span[1]) - ROOM, span[0].max(span[1]) + ROOM);
        let is_free = |lane: &Vec<[f64; 2]>| lane.iter().all(|[a, b]| *b <= low || high <= *a);
        let number = self.taken.iter().position(is_free).unwrap_or(self.taken.len());
        if number == self.taken.len() {
            self.taken.push(Vec::new());
        }
        self.taken[number].push([low, high]);
        self.first + number as f64 * (SIDE + 14.0)
    }
}

/// A group of connected parts in page coordinates, with the part that holds it at the origin until it is shifted.
pub struct Block {
    pub placed: Vec<(usize, Placed)>,
    pub links: Vec<(usize, Link)>,
    pub joints: Vec<(usize, Point)>,
    pub bounds: Bounds,
    /// The direction of its row.
    pub along: Point,
}

impl Block {
    fn of(row: &Row, graph: &Graph, frame: Frame, metre: f64) -> Block {
        let placed = row.members.iter().enumerate().map(|(member, number)| {
            let along = frame.along.times(row.way[member]);
            let placed = Placed {
                at: frame.point(row.at[member]),
                origin: [0.0, 0.0],
                outline: rotate_outline(&row.outline[member], frame, along),
                arms: Vec::new(),
                axes: row.axes(*number, along, metre),
                name_at: frame.names(),
            };
            (*number, placed)
        });
        let placed: Vec<(usize, Placed)> = placed.collect();
        let foot = |foot: &Foot| Foot {
            part: foot.part,
            at: frame.point(foot.at),
            lead: foot.lead.iter().map(|point| frame.point(*point)).collect(),
            wall: foot.wall.map(|wall| frame.point(wall)),
        };
        let links = row.links.iter().map(|(element, link)| {
            let feet = [foot(&link.feet[0]), foot(&link.feet[1])];
            (*element, Link { feet, round: None })
        });
        let joints = graph.meshes.iter().filter_map(|mesh| {
            let at = |number: usize| placed.iter().find(|(own, _)| *own == number).map(|(_, placed)| placed.at);
            let middle = match mesh.parts.map(at) {
                [Some(a), Some(b)] => a.middle(b),
                [a, b] => a.or(b)?,
            };
            Some((mesh.joint, middle))
        });
        let bounds = row.bounds();
        Block {
            links: links.collect(),
            joints: joints.collect(),
            bounds: Bounds::of(&[frame.point(bounds.low), frame.point(bounds.high)]),
            along: frame.along,
            placed,
        }
    }

    pub fn is_level(&self) -> bool {
        self.along.y == 0.0
    }

    pub fn shift(&mut self, by: Point) {
        self.placed.iter_mut().for_each(|(_, placed)| placed.at = placed.at.plus(by));
        self.joints.iter_mut().for_each(|(_, at)| *at = at.plus(by));
        for foot in self.links.iter_mut().flat_map(|(_, link)| &mut link.feet) {
            foot.at = foot.at.plus(by);
            foot.lead.iter_mut().for_each(|point| *point = point.plus(by));
        }
        self.bounds = self.bounds.shift(by);
    }
}

/// The whole page, while it fills.
struct Page {
    placed: Vec<Placed>,
    links: Vec<Link>,
    joints: Vec<Point>,
}

impl Page {
    fn new(scene: &Scene, parts: &Parts) -> Page {
        let ground = Placed {
            at: Point::default(),
            origin: [0.0, 0.0],
            outline: Outline::Nowhere,
            arms: Vec::new(),
            axes: [Point::new(METRE, 0.0), Point::new(0.0, -METRE)],
            name_at: Vec::new(),
        };
        let nowhere = Foot { part: GROUND, at: Point::default(), lead: Vec::new(), wall: None };
        Page {
            placed: vec![ground; parts.count()],
            links: vec![Link { feet: [nowhere.clone(), nowhere], round: None }; scene.elements.len()],
            joints: vec![Point::default(); scene.joints.len()],
        }
    }

    fn put(&mut self, block: Block) {
        block.placed.into_iter().for_each(|(number, placed)| self.placed[number] = placed);
        block.links.into_iter().for_each(|(element, link)| self.links[element] = link);
        block.joints.into_iter().for_each(|(joint, at)| self.joints[joint] = at);
    }

    fn finish(self) -> Layout {
        Layout { parts: self.placed, links: self.links, joints: self.joints, scale: None }
    }
}

/// An outline in row coordinates on the page.
fn rotate_outline(outline: &Outline, frame: Frame, along: Point) -> Outline {
    let half = |half: &Point| {
        let v = frame.point(*half);
        Point::new(v.x.abs(), v.y.abs())
    };
    match outline {
        Outline::Block { half: h } => Outline::Block { half: half(h) },
        Outline::Box { half: h, along } => Outline::Box { half: half(h), along: *along },
        Outline::Plate { half, .. } => Outline::Plate { along, half: *half },
        other => other.clone(),
    }
}
