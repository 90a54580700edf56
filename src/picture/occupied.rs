//! A map of the occupied places of the page: a grid of small cells under all strokes. Labels and arrows search it for
//! free places.

use super::figure::{Glyph, Stroke};
use super::geometry::{Bounds, Point};

/// Side of a cell, px. Strokes are about half as wide.
const CELL: f64 = 3.0;
/// Cells of a side; scenes that would need more are drawn without names.
const MOST: usize = 4_000;
/// Room around the scene for names, px.
const AROUND: f64 = 400.0;

#[derive(Clone, Debug)]
pub struct Occupied {
    low: Point,
    cell: f64,
    columns: usize,
    rows: usize,
    taken: Vec<Cell>,
}

/// The content of a cell: a byte, so that an empty map is memory full of zeros.
type Cell = u8;
const FREE: Cell = 0;
const GLYPH: Cell = 1;
const NAME: Cell = 2;

impl Occupied {
    pub fn of<'a>(glyphs: impl Iterator<Item = &'a Glyph> + Clone) -> Occupied {
        let bounds = glyphs.clone().fold(Bounds::EMPTY, |bounds, glyph| bounds.and(glyph.bounds()));
        let bounds = if bounds.is_empty() { Bounds::of(&[Point::default()]) } else { bounds }.grow(AROUND);
        let cell = CELL.max(bounds.width().max(bounds.height()) / MOST as f64);
        let side = |length: f64| (length / cell).ceil() as usize + 1;
        let (columns, rows) = (side(bounds.width()), side(bounds.height()));
        let mut room = Occupied { low: bounds.low, cell, columns, rows, taken: vec![FREE; columns * rows] };
        for glyph in glyphs {
            room.take(glyph);
        }
        room
    }

    pub fn take(&mut self, glyph: &Glyph) {
        for stroke in &glyph.strokes {
            match stroke {
                Stroke::Line { points, closed, pen } => {
                    for pair in points.windows(2) {
                        self.take_segment(pair[0], pair[1]);
                    }
                    if let (true, Some(first), Some(last)) = (*closed, points.first(), points.last()) {
                        self.take_segment(*last, *first);
                    }
                    if pen.fills() {
                        self.take_inside(points);
                    }
                }
                Stroke::Circle { centre, radius, .. } => self.take_disk(*centre, *radius),
            }
        }
    }

    /// Whether a rectangle is empty and lies entirely on the page.
    pub fn is_free(&self, bounds: &Bounds) -> bool {
        let high = Point::new(self.low.x + self.cell * self.columns as f64, self.low.y + self.cell * self.rows as f64);
        if !(self.low.x <= bounds.low.x
            && self.low.y <= bounds.low.y
            && bounds.high.x < high.x
            && bounds.high.y < high.y)
        {
            return false;
        }
        let (x0, x1) = (self.column(bounds.low.x), self.column(bounds.high.x));
        let (y0, y1) = (self.row(bounds.low.y), self.row(bounds.high.y));
        let is_free =
            |y: usize| self.taken[y * self.columns + x0..=y * self.columns + x1].iter().all(|cell| *cell == FREE);
        (y0..=y1).all(is_free)
    }

    /// Marks everything outside a rectangle as occupied.
    pub fn only_within(&mut self, bounds: &Bounds) {
        let (x0, x1) = (self.column(bounds.low.x), self.column(bounds.high.x));
        let (y0, y1) = (self.row(bounds.low.y), self.row(bounds.high.y));
        for y in 0..self.rows {
            for x in 0..self.columns {
                if x <= x0 || x >= x1 || y <= y0 || y >= y1 {
                    self.taken[y * self.columns + x] = GLYPH;
                }
            }
        }
    }

    pub fn take_name(&mut self, bounds: &Bounds) {
        self.take_cells(bounds, NAME);
    }

    fn take_cells(&mut self, bounds: &Bounds, content: Cell) {
        let (x0, x1) = (self.column(bounds.low.x), self.column(bounds.high.x));
        for y in self.row(bounds.low.y)..=self.row(bounds.high.y) {
            self.taken[y * self.columns + x0..=y * self.columns + x1].fill(content);
        }
    }

    /// Whether a line from one point to another crosses no name and, if `of_glyphs` is set, no glyph. Glyphs within
    /// `skip` of its start do not count.
    pub fn is_clear(&self, from: Point, to: Point, skip: f64, of_glyphs: bool) -> bool {
        let (length, Some(direction)) = (from.distance(to), to.minus(from).unit()) else { return true };
        let steps = (length / (self.cell * 0.5)).ceil() as usize;
        (0..=steps).all(|k| {
            let way = (k as f64 * self.cell * 0.5).min(length);
            let at = from.towards(direction, way);
            match self.taken[self.row(at.y) * self.columns + self.column(at.x)] {
                FREE => true,
                GLYPH => !of_glyphs || way < skip,
                _ => false,
            }
        })
    }

    fn column(&self, x: f64) -> usize {
        (((x - self.low.x) / self.cell).max(0.0) as usize).min(self.columns - 1)
    }

    fn row(&self, y: f64) -> usize {
        (((y - self.low.y) / self.cell).max(0.0) as usize).min(self.rows - 1)
    }

    fn take_segment(&mut self, from: Point, to: Point) {
        // Most lines of a figure run along x or y.
        if from.y == to.y || from.x == to.x {
            return self.take_cells(&Bounds::of(&[from, to]), GLYPH);
        }
        let steps = (from.distance(to) / (self.cell * 0.5)).ceil().max(1.0) as usize;
        for k in 0..=steps {
            let at = from.plus(to.minus(from).times(k as f64 / steps as f64));
            let place = self.row(at.y) * self.columns + self.column(at.x);
            self.taken[place] = GLYPH;
        }
    }

    fn take_disk(&mut self, centre: Point, radius: f64) {
        for y in self.row(centre.y - radius)..=self.row(centre.y + radius) {
            let middle = self.low.y + (y as f64 + 0.5) * self.cell - centre.y;
            let rest =
                radius * radius - (middle.abs() - self.cell * 0.5).max(0.0) * (middle.abs() - self.cell * 0.5).max(0.0);
            let half = rest.max(0.0).sqrt();
            let (x0, x1) = (self.column(centre.x - half), self.column(centre.x + half));
            self.taken[y * self.columns + x0..=y * self.columns + x1].fill(GLYPH);
        }
    }

    /// The inside of a polygon, row by row.
    fn take_inside(&mut self, points: &[Point]) {
        let bounds = Bounds::of(points);
        for y in self.row(bounds.low.y)..=self.row(bounds.high.y) {
            let level = self.low.y + (y as f64 + 0.5) * self.cell;
            let mut crossings = Vec::new();
            for (k, a) in points.iter().enumerate() {
                let b = points[(k + 1) % points.len()];
                if (a.y <= level) != (b.y <= level) {
                    crossings.push(a.x + (level - a.y) / (b.y - a.y) * (b.x - a.x));
                }
            }
            crossings.sort_by(f64::total_cmp);
            for pair in crossings.chunks_exact(2) {
                let (x0, x1) = (self.column(pair[0]), self.column(pair[1]));
                self.taken[y * self.columns + x0..=y * self.columns + x1].fill(GLYPH);
            }
        }
    }
}
