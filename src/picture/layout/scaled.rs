//! A scene with coordinates, to scale. A part without coordinates is placed next to the part to which it is attached.
//! Groups of connected parts without coordinates are laid out by [`rows`] and placed at the end of the element that
//! connects them, or below.

use super::links::{self, Tie};
use super::parts::{BOB, DOT, GROUND, Parts, straight};
use super::rows::{self, Below, Block};
use super::{Layout, Link, Outline, Placed, REACH, SIDE, TWISTED};
use crate::base::Number;
use crate::model::scene::{Attachment, Element, Freedom, Geometry, Part, Scene, Shape};
use crate::picture::geometry::{Bounds, Point};
use crate::picture::glyph::values::Says;
use crate::picture::{Detail, Refusal};
use std::collections::BTreeMap;

/// The longer side of a scene, px: the usual size, and the maximum if short elements need more.
const WISHED: f64 = 330.0;
const MOST: f64 = 620.0;
/// Side length per body of a scene of many bodies.
const EACH: f64 = 120.0;
/// Side length of a scene that is too large for names.
const LARGE: f64 = 1_400.0;

pub fn layout(
    scene: &Scene,
    parts: &Parts,
    known: &[Vec<[f64; 2]>],
    detail: Detail,
    says: &Says,
) -> Result<Layout, Refusal> {
    let scale = scale(scene, parts, known, detail);
    let mut drawing = Drawing { scene, parts, known, scale, detail, placed: Vec::new(), is_placed: Vec::new() };
    drawing.place_known();
    let (attached, apart) = drawing.groups(says);
    let mut own: Vec<(usize, Link)> = attached.into_iter().flat_map(|block| drawing.attach(block)).collect();
    drawing.place_others();
    own.extend(drawing.set_apart(apart));
    let ties = drawing.ties();
    drawing.widen(&ties);
    let mut links = links::links(&ties, &drawing.placed);
    own.into_iter().for_each(|(element, link)| links[element] = link);
    let joints = (0..scene.joints.len()).map(|joint| drawing.joint(joint)).collect();
    let extent = extent(known);
    let has_extent =
        extent.width() > 0.0 || extent.height() > 0.0 || scene.bodies.iter().any(|body| body.shape.is_some());
    Ok(Layout { parts: drawing.placed, links, joints, scale: has_extent.then_some(scale) })
}

fn extent(known: &[Vec<[f64; 2]>]) -> Bounds {
    known.iter().flatten().fold(Bounds::EMPTY, |bounds, [x, y]| bounds.with(Point::new(*x, *y)))
}

/// Pixels for a metre.
fn scale(scene: &Scene, parts: &Parts, known: &[Vec<[f64; 2]>], detail: Detail) -> f64 {
    let mut bounds = extent(known);
    for (index, body) in scene.bodies.iter().enumerate() {
        let half = match body.shape.as_deref() {
            Some(Shape::Disk { radius } | Shape::Ring { radius }) => Point::new(radius.to_f64(), radius.to_f64()),
            Some(Shape::Box { width, height, along }) => {
                let half = Point::new(width.to_f64() / 2.0, height.to_f64() / 2.0);
                Outline::Box { half, along: page(straight(along)) }.half()
            }
            Some(Shape::Rod { .. }) | None => continue,
        };
        let at = known[1 + index].first().map_or(Point::default(), |[x, y]| Point::new(*x, *y));
        bounds = bounds.and(Bounds::around(at, half));
    }
    let size = bounds.width().max(bounds.height());
    if size <= 0.0 || !size.is_finite() {
        return 100.0;
    }
    let many = EACH * (scene.bodies.len() as f64).sqrt();
    let (wished, most) = if detail == Detail::Full { (WISHED, MOST.max(many)) } else { (LARGE, LARGE) };
    let mut wanted = wished / size;
    // Room for the glyph of the shortest element, and for blocks at its ends.
    let length = |ends: &[Attachment; 2], room: f64| {
        let (a, b) = (ends[0].at.as_deref()?, ends[1].at.as_deref()?);
        let distance = Point::new(a.x.to_f64() - b.x.to_f64(), a.y.to_f64() - b.y.to_f64()).length();
        (distance > 0.0).then(|| room / distance)
    };
    for element in scene.elements.iter().filter(|element| element.law.geometry != Geometry::Torsion) {
        let ends = element.ends.iter().map(|end| half_of_end(scene, parts, end)).sum::<f64>();
        if let Some(needed) = length(&element.ends, REACH * 0.9 + ends) {
            wanted = wanted.max(needed);
        }
    }
    wanted.min(most / size)
}

/// The length of an element that is hidden by a body without a shape, px.
fn half_of_end(scene: &Scene, parts: &Parts, end: &Attachment) -> f64 {
    match end.part {
        Part::Body(body) if scene.bodies[body.index()].shape.is_none() => {
            let number = parts.number(end.part);
            parts.common_outline(scene, number, Point::default()).half().x
        }
        Part::Ground | Part::Base(_) | Part::Body(_) => 0.0,
    }
}

/// A connection of a part: its element (`None` for a joint), and the end of it that is at the part.
#[derive(Clone, Copy, Debug)]
struct Tied {
    element: Option<usize>,
    number: usize,
    end: usize,
}

struct Drawing<'a> {
    scene: &'a Scene,
    parts: &'a Parts,
    known: &'a [Vec<[f64; 2]>],
    scale: f64,
    detail: Detail,
    placed: Vec<Placed>,
    is_placed: Vec<bool>,
}

/// Upwards on the page, of a direction of the scene.
fn page(direction: [f64; 2]) -> Point {
    Point::new(direction[0], -direction[1])
}

impl Drawing<'_> {
    fn map(&self, [x, y]: [f64; 2]) -> Point {
        Point::new(x * self.scale, -y * self.scale)
    }

    fn map_end(&self, end: &Attachment) -> Option<Point> {
        end.at.as_deref().map(|at| self.map([at.x.to_f64(), at.y.to_f64()]))
    }

    fn axes(&self) -> [Point; 2] {
        [Point::new(self.scale, 0.0), Point::new(0.0, -self.scale)]
    }

    /// The direction in which a part moves, on the page.
    fn motion(&self, number: usize) -> Option<Point> {
        self.parts.translations(self.scene, number).first().map(|t| page(straight(&t.direction)))
    }

    fn place_known(&mut self) {
        for number in 0..self.parts.count() {
            let along = self.motion(number).unwrap_or(Point::new(0.0, -1.0));
            let mut placed = Placed {
                at: Point::default(),
                origin: [0.0, 0.0],
                outline: self.parts.common_outline(self.scene, number, along),
                arms: Vec::new(),
                axes: self.axes(),
                name_at: Vec::new(),
            };
            let points = &self.known[number];
            self.is_placed.push(number == GROUND || !points.is_empty());
            if number != GROUND {
                if let Part::Body(body) = self.parts.part(number) {
                    self.shape(body.index(), &mut placed);
                }
                if let Some(first) = points.first() {
                    (placed.at, placed.origin) = (self.map(*first), *first);
                }
                placed.arms = self.arms(&placed, points);
            }
            self.placed.push(placed);
        }
    }

    fn shape(&self, body: usize, placed: &mut Placed) {
        /// Smaller shapes cannot be seen, px.
        const LEAST: f64 = 3.0;
        let size = |number: &Number| (number.to_f64() * self.scale).max(LEAST);
        let body = &self.scene.bodies[body];
        let is_zero = |number: Option<&Number>| number.is_none_or(Number::is_zero);
        placed.outline = match body.shape.as_deref() {
            Some(Shape::Disk { radius }) => Outline::Disk { radius: size(radius) },
            Some(Shape::Ring { radius }) => Outline::Ring { radius: size(radius) },
            Some(Shape::Box { width, height, along }) => {
                let half = Point::new(size(width) / 2.0, size(height) / 2.0);
                Outline::Box { half, along: page(straight(along)) }
            }
            Some(Shape::Rod { ends }) => {
                let half = ends[1].sub(&ends[0]);
                Outline::Rod { arm: self.map([half.x.to_f64(), half.y.to_f64()]).times(0.5) }
            }
            None if self.detail > Detail::Plain => Outline::Speck { half: 1.2 },
            None if self.detail > Detail::Full => Outline::Speck { half: 4.0 },
            // A bob on a string: a point mass that joints carry.
            None if is_zero(body.inertia.as_deref())
                && !is_zero(body.mass.as_ref())
                && body.freedom == Freedom::FromJoints =>
            {
                Outline::Dot { radius: BOB }
            }
            None if is_zero(body.inertia.as_deref()) && is_zero(body.mass.as_ref()) => Outline::Dot { radius: DOT },
            None => return,
        };
    }

    /// Points that the outline does not reach.
    fn arms(&self, placed: &Placed, points: &[[f64; 2]]) -> Vec<Point> {
        let outside = |point: &Point| match &placed.outline {
            Outline::Rod { arm } => {
                let (from, along) = (point.minus(placed.at), arm.unit().unwrap_or_default());
                from.dot(along.perpendicular()).abs() > 6.0 || from.dot(along).abs() > arm.length() + 1.0
            }
            Outline::Plate { along, half } => {
                let from = point.minus(placed.at);
                from.dot(*along).abs() > 1.0 || from.dot(along.perpendicular()).abs() > *half
            }
            outline => {
                let (from, half) = (point.minus(placed.at), outline.half());
                let round = matches!(outline, Outline::Disk { .. } | Outline::Ring { .. } | Outline::Wheel { .. });
                let beyond = from.x.abs() > half.x + 0.5 || from.y.abs() > half.y + 0.5;
                beyond || round && from.length() > half.x + 0.5
            }
        };
        points.iter().skip(1).map(|point| self.map(*point)).filter(outside).collect()
    }

    /// Places the parts that no coordinate belongs to, each beside a part that it is tied to.
    fn place_others(&mut self) {
        if self.is_placed.iter().all(|is_placed| *is_placed) {
            return;
        }
        // The connections of each part, its elements before its joints.
        let mut tied: Vec<Vec<Tied>> = vec![Vec::new(); self.parts.count()];
        let elements = self.scene.elements.iter().enumerate().map(|(index, element)| (Some(index), &element.ends));
        let joints = self.scene.joints.iter().map(|joint| (None, &joint.ends));
        for (element, ends) in elements.chain(joints) {
            let numbers = [0, 1].map(|end| self.parts.number(ends[end].part));
            for (end, other) in [(0, 1), (1, 0)] {
                tied[numbers[end]].push(Tied { element, number: numbers[other], end });
            }
        }
        let mut order: Vec<usize> = (1..self.parts.count()).filter(|number| self.is_placed[*number]).collect();
        let mut next = 0;
        while next < order.len() {
            let from = order[next];
            for tie in &tied[from] {
                if !self.is_placed[tie.number] {
                    let at = match tie.element {
                        Some(index) => self.free_place(index, tie.number, from, tie.end),
                        None => self.support_point(tie.number, from),
                    };
                    self.settle(tie.number, at);
                    order.push(tie.number);
                }
            }
            next += 1;
        }
        // The remaining parts are not connected to any part with a place, in a scene too large for rows.
        let bounds = self.occupied_bounds();
        let mut next = Point::new(bounds.low.x, bounds.high.y + REACH + 40.0);
        for number in 1..self.parts.count() {
            if !self.is_placed[number] && self.detail > Detail::Full {
                self.settle(number, next);
                next.x += REACH * 2.0;
            }
        }
    }

    /// Groups of connected parts without a place: those of several parts that are tied to a part with a place, and
    /// those that are not. A single part that is tied to others is placed beside them.
    fn groups(&self, says: &Says) -> (Vec<Block>, Vec<Block>) {
        if self.detail > Detail::Full {
            return (Vec::new(), Vec::new());
        }
        let free: Vec<bool> = self.is_placed.iter().map(|is_placed| !is_placed).collect();
        let blocks = rows::groups(self.scene, self.parts, says, self.scale, &free);
        let (attached, apart): (Vec<_>, Vec<_>) = blocks.into_iter().partition(|block| self.tie_of(block).is_some());
        (attached.into_iter().filter(|block| block.placed.len() > 1).collect(), apart)
    }

    /// The first element or joint that ties a group to a part with a place: the member's number, the end of the other.
    fn tie_of(&self, block: &Block) -> Option<(usize, &Attachment, Option<&Element>)> {
        let is_member = |number: usize| block.placed.iter().any(|(member, _)| *member == number);
        let elements = self.scene.elements.iter().map(|element| (&element.ends, Some(element)));
        let joints = self.scene.joints.iter().map(|joint| (&joint.ends, None));
        elements.chain(joints).find_map(|(ends, element)| {
            let numbers = [0, 1].map(|end| self.parts.number(ends[end].part));
            let has_place = |number: usize| number != GROUND && self.is_placed[number];
            let end = (0..2).find(|end| is_member(numbers[*end]) && has_place(numbers[1 - end]))?;
            Some((numbers[end], &ends[1 - end], element))
        })
    }

    /// Places a group so that its connection to the other parts runs in its own direction.
    fn attach(&mut self, mut block: Block) -> Vec<(usize, Link)> {
        let Some((member, end, element)) = self.tie_of(&block) else { return Vec::new() };
        let held = self.parts.number(end.part);
        let Some((_, own)) = block.placed.iter().find(|(number, _)| *number == member) else { return Vec::new() };
        let from = self.map_end(end).unwrap_or(self.placed[held].at);
        let along = element.and_then(|element| self.direction(element)).or(self.motion(member)).unwrap_or(block.along);
        // The group lies on that side of its member on which most of it does.
        let middle = block.bounds.centre().minus(own.at).dot(along);
        let first = if middle < 0.0 { along.times(-1.0) } else { along };
        let half = own.outline.half().dot(Point::new(along.x.abs(), along.y.abs()));
        let mut tries = self.tries(held, from, first, half).map(|at| at.minus(own.at));
        let is_free = |by: &Point| self.is_free(&block.bounds.shift(*by), member);
        let below = Point::new(from.x - own.at.x, self.occupied_bounds().high.y + REACH - block.bounds.low.y);
        let by = tries.find(is_free).unwrap_or(below);
        block.shift(by);
        self.put(block)
    }

    /// Places groups that are not connected to the drawing below it.
    fn set_apart(&mut self, blocks: Vec<Block>) -> Vec<(usize, Link)> {
        let taken = self.occupied_bounds();
        let mut below = Below { down: taken.high.y + REACH + 40.0, left: taken.low.x, right: taken.low.x };
        let (level, upright): (Vec<_>, Vec<_>) = blocks.into_iter().partition(Block::is_level);
        let mut links = Vec::new();
        for mut block in level.into_iter().chain(upright) {
            below.set(&mut block);
            links.extend(self.put(block));
        }
        links
    }

    fn put(&mut self, block: Block) -> Vec<(usize, Link)> {
        for (number, placed) in block.placed {
            self.placed[number] = placed;
            self.is_placed[number] = true;
        }
        block.links
    }

    fn settle(&mut self, number: usize, at: Point) {
        self.placed[number].at = at;
        self.placed[number].origin = [at.x / self.scale, -at.y / self.scale];
        self.is_placed[number] = true;
    }

    fn occupied_bounds(&self) -> Bounds {
        let placed = (1..self.parts.count()).filter(|number| self.is_placed[*number]);
        let bounds = placed.fold(Bounds::EMPTY, |bounds, number| bounds.and(self.bounds(number)));
        if bounds.is_empty() { Bounds::of(&[Point::default()]) } else { bounds }
    }

    fn bounds(&self, number: usize) -> Bounds {
        let placed = &self.placed[number];
        let own = Bounds::around(placed.at, placed.outline.half());
        placed.arms.iter().fold(own, |bounds, arm| bounds.with(*arm))
    }

    /// The position of a part on top of the part that a joint ties it to.
    fn support_point(&self, number: usize, tied: usize) -> Point {
        let apart = self.placed[number].outline.half().y + self.placed[tied].outline.half().y + 6.0;
        self.placed[tied].at.plus(Point::new(0.0, -apart))
    }

    /// Whether nothing else is drawn in a rectangle; not checked in large scenes.
    fn is_free(&self, room: &Bounds, but: usize) -> bool {
        let placed = || (1..self.parts.count()).filter(|other| *other != but && self.is_placed[*other]);
        self.detail > Detail::Full || !placed().any(|other| self.bounds(other).overlaps(room))
    }

    /// A free place for a part at the far end of an element.
    fn free_place(&self, element: usize, number: usize, tied: usize, end: usize) -> Point {
        let element = &self.scene.elements[element];
        let from = self.map_end(&element.ends[end]).unwrap_or(self.placed[tied].at);
        let along =
            self.direction(element).or(self.motion(number)).or(self.motion(tied)).unwrap_or(Point::new(1.0, 0.0));
        let is_base = matches!(self.parts.part(number), Part::Base(_));
        let first = if is_base { along.times(-1.0) } else { along };
        let outline = &self.placed[number].outline;
        let own = outline.half().dot(Point::new(along.x.abs(), along.y.abs()));
        let mut tries = self.tries(tied, from, first, own);
        let is_free = |at: &Point| self.is_free(&Bounds::around(*at, outline.half()).grow(6.0), number);
        tries.clone().find(is_free).or(tries.next()).unwrap_or(from)
    }

    /// Places at the far end of an element that starts at a point of a part: straight on, straight back, then aside.
    fn tries(&self, part: usize, from: Point, first: Point, half: f64) -> impl Iterator<Item = Point> + Clone + use<> {
        let inside = from.minus(self.placed[part].at);
        let far = [first, first.times(-1.0)].map(|way| {
            let reach = self.placed[part].outline.reach(inside, way);
            from.towards(way, reach + REACH + half)
        });
        let shifts = [0.0, 1.0, -1.0, 2.0, -2.0, 3.0, -3.0];
        shifts.into_iter().flat_map(move |shift| far.map(|at| at.towards(first.perpendicular(), shift * 70.0)))
    }

    /// The direction of an element that has one, on the page.
    fn direction(&self, element: &Element) -> Option<Point> {
        match &element.law.geometry {
            Geometry::Along(direction) => Some(page(straight(direction))),
            Geometry::Line | Geometry::Torsion | Geometry::Span(_) => None,
        }
    }

    /// Makes plates and blocks as wide as the elements that end at them side by side.
    fn widen(&mut self, ties: &[Tie]) {
        for (tie, (_, of)) in ties.iter().zip(links::places(ties)) {
            let needed = of as f64 * tie.side / 2.0 + 3.0;
            let Some(direction) = tie.at[1].minus(tie.at[0]).unit() else { continue };
            for end in 0..2 {
                let placed = &mut self.placed[tie.parts[end]];
                let centred = placed.at.distance(tie.at[end]) < 1.0;
                match &mut placed.outline {
                    Outline::Plate { half, .. } => *half = half.max(needed),
                    Outline::Block { half } if centred && direction.x.abs() > 0.9 => half.y = half.y.max(needed),
                    Outline::Block { half } if centred && direction.y.abs() > 0.9 => half.x = half.x.max(needed),
                    _ => {}
                }
            }
        }
    }

    fn ties(&self) -> Vec<Tie> {
        let pivots = self.pivots();
        self.scene.elements.iter().map(|element| self.tie(element, &pivots)).collect()
    }

    fn tie(&self, element: &Element, pivots: &BTreeMap<[usize; 2], Point>) -> Tie {
        let parts = [0, 1].map(|end| self.parts.number(element.ends[end].part));
        let side = if element.law.geometry == Geometry::Torsion { TWISTED } else { SIDE };
        let own = |end: usize| (parts[end] != GROUND).then(|| self.placed[parts[end]].at);
        let at = [0, 1].map(|end| self.map_end(&element.ends[end]).or_else(|| own(end)));
        if element.law.geometry == Geometry::Torsion
            && let Some(pivot) = pivots.get(&[parts[0].min(parts[1]), parts[0].max(parts[1])])
        {
            return Tie { parts, at: [*pivot; 2], round: true, side };
        }
        match at {
            [Some(a), Some(b)] if a.distance(b) > 2.0 => Tie { parts, at: [a, b], round: false, side },
            // Two places that are one: a glyph round it, or one beside it along the direction of the element.
            [Some(a), Some(_)] if element.law.geometry == Geometry::Torsion => {
                Tie { parts, at: [a, a], round: true, side }
            }
            [Some(a), Some(_)] => Tie { parts, at: [self.stub(element, parts[1], a), a], round: false, side },
            [None, Some(b)] => Tie { parts, at: [self.stub(element, parts[1], b), b], round: false, side },
            [Some(a), None] => Tie { parts, at: [a, self.stub(element, parts[0], a)], round: false, side },
            [None, None] => Tie { parts, at: [Point::default(); 2], round: true, side },
        }
    }

    /// The position of the ground that holds an element whose other end is at a point of a part.
    fn stub(&self, element: &Element, part: usize, at: Point) -> Point {
        let along = self.direction(element).or(self.motion(part)).unwrap_or(Point::new(1.0, 0.0));
        let way = |way: Point| {
            let inside = self.placed[part].outline.reach(at.minus(self.placed[part].at), way);
            at.towards(way, inside + REACH)
        };
        let tries = [way(along.times(-1.0)), way(along)];
        let is_free = |stub: &Point| {
            let room = Bounds::around(at.middle(*stub), Point::new(1.0, 1.0)).with(*stub).grow(6.0);
            self.is_free(&room, part)
        };
        tries.iter().copied().find(is_free).unwrap_or(tries[0])
    }

    /// The pivots of the scene by the two parts that each ties, the smaller number first.
    fn pivots(&self) -> BTreeMap<[usize; 2], Point> {
        let mut pivots = BTreeMap::new();
        for joint in &self.scene.joints {
            let [a, b] = [0, 1].map(|end| self.parts.number(joint.ends[end].part));
            if let Some(at) = &joint.at {
                pivots.entry([a.min(b), a.max(b)]).or_insert(self.map([at.x.to_f64(), at.y.to_f64()]));
            }
        }
        pivots
    }

    fn joint(&self, joint: usize) -> Point {
        let joint = &self.scene.joints[joint];
        let numbers = [0, 1].map(|end| self.parts.number(joint.ends[end].part));
        let own = |end: usize| (numbers[end] != GROUND).then(|| self.placed[numbers[end]].at);
        match &joint.at {
            Some(at) => self.map([at.x.to_f64(), at.y.to_f64()]),
            None if joint.kind.slides => own(1).or_else(|| own(0)).unwrap_or_default(),
            None => match (own(0), own(1)) {
                (Some(a), Some(b)) => a.middle(b),
                (a, b) => a.or(b).unwrap_or_default(),
            },
        }
    }
}
