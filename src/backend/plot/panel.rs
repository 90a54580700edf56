//! One panel of a plot: frame, ticks, titles, curves within the frame, marks, and labels in free places.

use super::{BOTTOM, Curve, Entry, LEFT, LINE, Mark, Panel, RIGHT, Sample, Shape, Style, TOP, WIDTH, line, put};
use crate::backend::draw::escape;
use crate::backend::draw::path::Tenths;
use crate::picture::geometry::{Bounds, Point};
use crate::picture::labels::{Placing, Wanted};
use crate::picture::occupied::Occupied;
use crate::picture::{Glyph, Kind, Pen, Ride, Stroke};

/// Distance from the middle of a line of text to its baseline, px.
const BASELINE: f64 = 4.2;
/// Labels keep this far from the frame, so that its ticks stay readable, px.
const INSIDE: f64 = 2.0;

pub fn draw(file: &mut String, panel: &Panel, at: Point) {
    let low = at.plus(Point::new(LEFT, TOP));
    let frame = Bounds { low, high: low.plus(Point::new(WIDTH - LEFT - RIGHT, panel.height)) };
    put(file, format_args!("<g class=\"panel\">\n"));
    heading(file, panel, frame);
    axes(file, panel, frame);
    let mut glyphs = vec![outline(frame)];
    for curve in &panel.curves {
        for points in pieces(panel, frame, curve) {
            line(file, &format!("curve {}", curve.style.class()), &points, false);
            glyphs.push(glyph(vec![Stroke::line(points, Pen::Normal)]));
        }
    }
    let mut wanted = Vec::new();
    for mark in &panel.marks {
        let Some(at) = place(panel, frame, mark.at) else { continue };
        let strokes = shape(mark.shape, at);
        put(file, format_args!("<g class=\"mark {}\"><title>{}</title>", colour(mark.style), escape(&mark.label)));
        write_strokes(file, &strokes);
        file.push_str("</g>\n");
        let half = Point::new(5.0, 5.0);
        let up = Point::new(0.0, if mark.shape == Shape::Dip { 1.0 } else { -1.0 });
        glyphs.push(glyph(strokes));
        wanted.push(Wanted {
            text: mark.label.clone(),
            span: None,
            at,
            half,
            best: vec![up],
            ride: Ride::Still,
            is_of_tie: false,
        });
    }
    names(file, frame, &glyphs, wanted);
    legend(file, panel, frame);
    file.push_str("</g>\n");
}

fn heading(file: &mut String, panel: &Panel, frame: Bounds) {
    let (x, y) = (Tenths::of(frame.low.x), Tenths::of(frame.low.y - 9.0));
    put(file, format_args!("<text x=\"{x}\" y=\"{y}\" font-size=\"13\">{}</text>\n", escape(&panel.heading)));
}

fn axes(file: &mut String, panel: &Panel, frame: Bounds) {
    let mut last = f64::NEG_INFINITY;
    for tick in panel.x.ticks() {
        let x = frame.low.x + tick.at * frame.width();
        line(file, "grid", &[Point::new(x, frame.low.y), Point::new(x, frame.high.y)], false);
        let half = crate::picture::text::width(&tick.label) / 2.0;
        // Labels that would touch the previous one are omitted.
        if tick.label.is_empty() || x - half < last + 4.0 {
            continue;
        }
        last = x + half;
        let (x, y) = (Tenths::of(x), Tenths::of(frame.high.y + 16.0));
        put(
            file,
            format_args!("<text class=\"tick\" x=\"{x}\" y=\"{y}\" text-anchor=\"middle\">{}</text>\n", tick.label),
        );
    }
    let mut last = f64::INFINITY;
    for tick in panel.y.ticks() {
        let y = frame.high.y - tick.at * frame.height();
        line(file, "grid", &[Point::new(frame.low.x, y), Point::new(frame.high.x, y)], false);
        if tick.label.is_empty() || y > last - 13.0 {
            continue;
        }
        last = y;
        let (x, y) = (Tenths::of(frame.low.x - 6.0), Tenths::of(y + BASELINE));
        put(file, format_args!("<text class=\"tick\" x=\"{x}\" y=\"{y}\" text-anchor=\"end\">{}</text>\n", tick.label));
    }
    let corners = [frame.low, Point::new(frame.high.x, frame.low.y), frame.high, Point::new(frame.low.x, frame.high.y)];
    line(file, "frame", &corners, true);
    let (x, y) = (Tenths::of(frame.centre().x), Tenths::of(frame.high.y + 34.0));
    put(file, format_args!("<text x=\"{x}\" y=\"{y}\" text-anchor=\"middle\">{}</text>\n", escape(&panel.x.title)));
    let (x, y) = (Tenths::of(frame.low.x - LEFT + 14.0), Tenths::of(frame.centre().y));
    put(
        file,
        format_args!(
            "<text transform=\"translate({x} {y}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
            escape(&panel.y.title)
        ),
    );
}

fn place(panel: &Panel, frame: Bounds, (x, y): (f64, f64)) -> Option<Point> {
    let y = if y == f64::INFINITY {
        1.0
    } else if y == 0.0 {
        panel.y.share(y).unwrap_or(0.0)
    } else {
        panel.y.share(y)?
    };
    let x = panel.x.share(x)?;
    (-0.001..=1.001)
        .contains(&x)
        .then(|| Point::new(frame.low.x + x * frame.width(), frame.high.y - y.clamp(0.0, 1.0) * frame.height()))
}

/// A curve within the frame, cut at the upper and lower edges.
fn pieces(panel: &Panel, frame: Bounds, curve: &Curve) -> Vec<Vec<Point>> {
    let mut pieces: Vec<Vec<Point>> = vec![Vec::new()];
    let mut before: Option<(f64, f64)> = None;
    for &(x, y) in &curve.points {
        let shares = panel.x.share(x).zip(panel.y.share(y)).filter(|(x, _)| (-0.001..=1.001).contains(x));
        if let Some([from, to]) = before.zip(shares).and_then(|(a, b)| cut(a, b)) {
            let on_page =
                |(x, y): (f64, f64)| Point::new(frame.low.x + x * frame.width(), frame.high.y - y * frame.height());
            let (from, to) = (on_page(from), on_page(to));
            let piece = pieces.last_mut().expect("there is one from the start");
            if piece.last() == Some(&from) {
                piece.push(to);
            } else {
                pieces.push(vec![from, to]);
            }
        }
        before = shares;
    }
    pieces.retain(|piece| piece.len() > 1);
    pieces
}

/// The part of a segment with heights between 0 and 1.
fn cut(a: (f64, f64), b: (f64, f64)) -> Option<[(f64, f64); 2]> {
    let at = |y: f64| (a.0 + (y - a.1) / (b.1 - a.1) * (b.0 - a.0), y);
    let end = |own: (f64, f64)| match own.1 {
        y if y > 1.0 => at(1.0),
        y if y < 0.0 => at(0.0),
        _ => own,
    };
    let outside = a.1.min(b.1) > 1.0 || a.1.max(b.1) < 0.0;
    (!outside).then(|| [end(a), end(b)])
}

fn shape(shape: Shape, at: Point) -> Vec<Stroke> {
    let triangle = |up: f64| {
        let [tip, left, right] = [(0.0, -1.5), (-4.5, -9.0), (4.5, -9.0)].map(|(x, y)| at.plus(Point::new(x, y * up)));
        vec![Stroke::area([tip, left, right], Pen::Solid)]
    };
    match shape {
        Shape::Peak => triangle(1.0),
        Shape::Dip => triangle(-1.0),
        Shape::Dot => vec![Stroke::circle(at, 4.0, Pen::Solid)],
        Shape::Ring => vec![Stroke::circle(at, 4.0, Pen::Normal)],
        Shape::Chosen => vec![Stroke::circle(at, 4.0, Pen::Solid), Stroke::circle(at, 7.5, Pen::Normal)],
    }
}

fn write_strokes(file: &mut String, strokes: &[Stroke]) {
    for stroke in strokes {
        match stroke {
            Stroke::Line { points, closed, pen } => {
                line(file, if *pen == Pen::Solid { "full" } else { "" }, points, *closed);
            }
            Stroke::Circle { centre, radius, pen } => {
                let class = if *pen == Pen::Solid { " class=\"full\"" } else { "" };
                let (x, y, r) = (Tenths::of(centre.x), Tenths::of(centre.y), Tenths::of(*radius));
                put(file, format_args!("<circle{class} cx=\"{x}\" cy=\"{y}\" r=\"{r}\"/>"));
            }
        }
    }
}

/// Only the colour: marks have no dashes.
fn colour(style: Style) -> String {
    style.class().split(' ').next().unwrap_or_default().to_string()
}

fn glyph(strokes: Vec<Stroke>) -> Glyph {
    Glyph { kind: Kind::Leader, title: String::new(), span: None, strokes, rides: Vec::new(), item: None, ghost: false }
}

fn outline(frame: Bounds) -> Glyph {
    let corners = [frame.low, Point::new(frame.high.x, frame.low.y), frame.high, Point::new(frame.low.x, frame.high.y)];
    glyph(vec![Stroke::Line { points: corners.to_vec(), closed: true, pen: Pen::Thin }])
}

/// Labels within the frame that do not cover anything.
fn names(file: &mut String, frame: Bounds, glyphs: &[Glyph], wanted: Vec<Wanted>) {
    let mut room = Occupied::of(glyphs.iter());
    room.only_within(&frame.grow(-INSIDE));
    let mut placing = Placing::new(&mut room);
    placing.place(wanted);
    for leader in &placing.leaders {
        for stroke in &leader.strokes {
            if let Stroke::Line { points, .. } = stroke {
                line(file, "leader", points, false);
            }
        }
    }
    for label in &placing.labels {
        let (x, y, width) = (Tenths::of(label.at.x), Tenths::of(label.at.y + BASELINE), Tenths::of(label.width()));
        put(
            file,
            format_args!(
                "<text class=\"label\" x=\"{x}\" y=\"{y}\" text-anchor=\"middle\" textLength=\"{width}\" \
                 lengthAdjust=\"spacingAndGlyphs\">{}</text>\n",
                escape(&label.text)
            ),
        );
    }
}

fn legend(file: &mut String, panel: &Panel, frame: Bounds) {
    for (number, Entry { style, sample, text }) in panel.legend.iter().enumerate() {
        let y = frame.high.y + BOTTOM + LINE * (number as f64 + 0.5) - 2.0;
        let at = Point::new(frame.low.x + 12.0, y);
        match sample {
            Sample::Line => {
                let ends = [at.minus(Point::new(12.0, 0.0)), at.plus(Point::new(12.0, 0.0))];
                line(file, &format!("curve {}", style.class()), &ends, false);
            }
            Sample::Shape(of) => {
                put(file, format_args!("<g class=\"{}\">", colour(*style)));
                write_strokes(file, &shape(*of, at));
                file.push_str("</g>\n");
            }
        }
        let (x, y) = (Tenths::of(frame.low.x + 30.0), Tenths::of(y + BASELINE));
        put(file, format_args!("<text x=\"{x}\" y=\"{y}\">{}</text>\n", escape(text)));
    }
}

/// A mark at the edge of the frame represents a value beyond it.
impl Mark {
    pub fn infinite(x: f64, label: String, style: Style) -> Mark {
        Mark { at: (x, f64::INFINITY), shape: Shape::Peak, label, style }
    }
}
