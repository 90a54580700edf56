//! The ground: a line with hatching behind it, perpendicular to the elements that end there. Elements that end side by
//! side share one line.

use super::{Sheet, Subject};
use crate::base::OrderBy;
use crate::picture::Detail;
use crate::picture::figure::{Kind, Pen, Stroke};
use crate::picture::geometry::Point;
use crate::picture::stage::Stage;
use std::collections::BTreeMap;

/// Beyond the outermost element, px.
const BEYOND: f64 = 11.0;
/// Between two strokes of the hatching, and how deep it is, px.
const PITCH: f64 = 6.0;
const DEEP: f64 = 7.0;
/// Walls closer than this are one, px.
const JOINED: f64 = 30.0;

/// A line with hatching on the side that `behind` points to.
pub fn hatched_line(a: Point, b: Point, behind: Point) -> Vec<Stroke> {
    let mut strokes = vec![Stroke::line([a, b], Pen::Normal)];
    let length = a.distance(b);
    let Some(along) = b.minus(a).unit() else { return strokes };
    let count = (length / PITCH).round().max(1.0) as usize;
    let step = length / count as f64;
    strokes.extend((0..count).map(|k| {
        let at = a.towards(along, (k as f64 + 0.9) * step);
        Stroke::line([at, at.towards(behind, DEEP).towards(along, -DEEP * 0.8)], Pen::Thin)
    }));
    strokes
}

/// Draws every place where an element ends at the ground.
pub fn walls(sheet: &mut Sheet, stage: &Stage) {
    // Grouped by direction and by the line on which they lie, in thousandths of a pixel.
    let mut walls: BTreeMap<[i64; 3], (Point, Vec<Point>)> = BTreeMap::new();
    for link in &stage.layout.links {
        if link.round.is_some() {
            continue;
        }
        for foot in &link.feet {
            let Some(behind) = foot.wall else { continue };
            let whole = |x: f64| (x * 1000.0).round() as i64;
            let key = [whole(behind.x), whole(behind.y), whole(foot.at.dot(behind)) / 1000];
            walls.entry(key).or_insert((behind, Vec::new())).1.push(foot.at);
        }
    }
    for (behind, mut feet) in walls.into_values() {
        let along = behind.perpendicular();
        feet.order_by(|a, b| a.dot(along).total_cmp(&b.dot(along)));
        for run in feet.chunk_by(|a, b| b.dot(along) - a.dot(along) < JOINED) {
            let (first, last) = (run[0], run[run.len() - 1]);
            let strokes = match sheet.detail {
                Detail::Full | Detail::Unnamed => {
                    hatched_line(first.towards(along, -BEYOND), last.towards(along, BEYOND), behind)
                }
                Detail::Plain | Detail::Bare => {
                    vec![Stroke::line([first.towards(along, -4.0), last.towards(along, 4.0)], Pen::Normal)]
                }
            };
            sheet.push(Kind::Ground, Subject { title: "ground".into(), span: None }, strokes);
        }
    }
}
