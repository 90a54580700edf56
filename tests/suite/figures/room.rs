//! Whether labels cover anything, by plain geometry: each label's box is compared with every line, circle and other
//! label.

use vibc::picture::geometry::{Bounds, Point};
use vibc::picture::{Figure, Kind, Label, Stroke};

/// Half of a pen's width, px.
const PEN: f64 = 0.9;
/// Height of capitals and descenders together, px.
const HIGH: f64 = 12.0;

/// Descriptions of all overlaps.
pub fn crowded(figure: &Figure) -> Vec<String> {
    let boxes: Vec<(&Label, Bounds)> = figure.labels.iter().map(|label| (label, set(label))).collect();
    let mut found = Vec::new();
    for (number, (label, bounds)) in boxes.iter().enumerate() {
        if bounds.low.x < 0.0 || bounds.low.y < 0.0 || bounds.high.x > figure.width || bounds.high.y > figure.height {
            found.push(format!("{} leaves the page", label.text));
        }
        for (other, beside) in &boxes[number + 1..] {
            if bounds.overlaps(beside) {
                found.push(format!("{} over {}", label.text, other.text));
            }
        }
        for glyph in &figure.glyphs {
            // A leader ends at the edge of its own name.
            let own = glyph.kind == Kind::Leader && glyph.title == label.text;
            if !own && glyph.strokes.iter().any(|stroke| meets(stroke, &bounds.grow(PEN))) {
                found.push(format!("{} over {:?} ({})", label.text, glyph.kind, glyph.title));
            }
        }
    }
    found
}

fn set(label: &Label) -> Bounds {
    Bounds::around(label.at, Point::new(label.width() / 2.0, HIGH / 2.0))
}

fn meets(stroke: &Stroke, bounds: &Bounds) -> bool {
    match stroke {
        Stroke::Circle { centre, radius, .. } => {
            let nearest =
                Point::new(centre.x.clamp(bounds.low.x, bounds.high.x), centre.y.clamp(bounds.low.y, bounds.high.y));
            nearest.distance(*centre) < *radius
        }
        Stroke::Line { points, closed, pen } => {
            let mut pairs: Vec<(Point, Point)> = points.windows(2).map(|pair| (pair[0], pair[1])).collect();
            if let (true, Some(first), Some(last)) = (*closed, points.first(), points.last()) {
                pairs.push((*last, *first));
            }
            pairs.iter().any(|(a, b)| crosses(*a, *b, bounds)) || (pen.fills() && inside(points, bounds.centre()))
        }
    }
}

/// Whether a segment meets a rectangle, by clipping (Liang and Barsky).
fn crosses(a: Point, b: Point, bounds: &Bounds) -> bool {
    let (mut from, mut to) = (0.0f64, 1.0f64);
    for (start, step, low, high) in
        [(a.x, b.x - a.x, bounds.low.x, bounds.high.x), (a.y, b.y - a.y, bounds.low.y, bounds.high.y)]
    {
        if step == 0.0 {
            if start <= low || start >= high {
                return false;
            }
            continue;
        }
        let (enter, leave) = ((low - start) / step, (high - start) / step);
        from = from.max(enter.min(leave));
        to = to.min(enter.max(leave));
    }
    from < to
}

fn inside(points: &[Point], at: Point) -> bool {
    let mut is_inside = false;
    for (k, a) in points.iter().enumerate() {
        let b = points[(k + 1) % points.len()];
        if (a.y > at.y) != (b.y > at.y) && at.x < a.x + (at.y - a.y) / (b.y - a.y) * (b.x - a.x) {
            is_inside = !is_inside;
        }
    }
    is_inside
}

#[test]
fn the_geometry_sees_what_it_looks_for() {
    let bounds = Bounds::around(Point::new(10.0, 10.0), Point::new(5.0, 3.0));
    assert!(crosses(Point::new(0.0, 0.0), Point::new(20.0, 20.0), &bounds));
    assert!(!crosses(Point::new(0.0, 0.0), Point::new(20.0, 0.0), &bounds));
    assert!(!crosses(Point::new(0.0, 14.0), Point::new(4.0, 30.0), &bounds));
    let square = [(0.0, 0.0), (30.0, 0.0), (30.0, 30.0), (0.0, 30.0)].map(|(x, y)| Point::new(x, y));
    assert!(inside(&square, bounds.centre()) && !inside(&square, Point::new(31.0, 3.0)));
}
