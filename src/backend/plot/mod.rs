//! Plots in SVG: panels with titled axes, curves, marks, labels that do not cover anything, and a legend. In: numbers,
//! all of which are in a table with their bounds. Out: the file. See docs/draw.md.

pub mod axis;
pub mod curves;
pub mod motion;
mod panel;
pub mod shock;
pub mod transfer;

use super::draw::escape;
use super::draw::path::{Tenths, path};
use crate::picture::geometry::Point;
use crate::picture::text;
pub use axis::{Axis, Scale};
use std::fmt::Write;

/// A whole picture: panels in rows.
pub struct Plot {
    pub title: String,
    pub rows: Vec<Vec<Panel>>,
}

/// Axes and everything that is drawn between them.
pub struct Panel {
    pub heading: String,
    pub x: Axis,
    pub y: Axis,
    pub height: f64,
    pub curves: Vec<Curve>,
    pub marks: Vec<Mark>,
    /// Lines of text below, each with the sample that it explains.
    pub legend: Vec<Entry>,
}

/// A line through points, in the values of the axes; a point that is not finite interrupts it.
pub struct Curve {
    pub points: Vec<(f64, f64)>,
    pub style: Style,
}

/// A point with a label.
pub struct Mark {
    pub at: (f64, f64),
    pub shape: Shape,
    pub label: String,
    pub style: Style,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// A triangle on top of the curve.
    Peak,
    /// A triangle below the curve.
    Dip,
    Dot,
    Ring,
    /// A dot within a ring.
    Chosen,
}

pub struct Entry {
    pub style: Style,
    pub sample: Sample,
    pub text: String,
}

pub enum Sample {
    Line,
    Shape(Shape),
}

/// A combination of colour and dashes that can be distinguished in greyscale.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Style {
    Curve(usize),
    /// The line of the best methods.
    Frontier,
}

impl Style {
    /// Colours that colour-blind people can distinguish (Okabe and Ito), with a dash pattern.
    fn class(self) -> String {
        match self {
            Style::Curve(number) => format!("c{} k{}", number % COLOURS, (number / COLOURS + number) % DASHES),
            Style::Frontier => "frontier".into(),
        }
    }
}

const COLOURS: usize = 6;
const DASHES: usize = 4;
const STYLE: &str = "\
.vibc-plot{color:#1c2128;font:12px Verdana,'DejaVu Sans',sans-serif}
.vibc-plot path,.vibc-plot circle{fill:none;stroke:currentColor;stroke-width:1}
.vibc-plot text{fill:currentColor}
.vibc-plot .grid{opacity:.16}
.vibc-plot .curve{stroke-width:1.6;stroke-linejoin:round}
.vibc-plot .frontier{stroke-dasharray:4 3;opacity:.55}
.vibc-plot .leader{opacity:.5;stroke-width:.7}
.vibc-plot .full{fill:currentColor}
.vibc-plot .c0{color:#0064a8}.vibc-plot .c1{color:#b34700}.vibc-plot .c2{color:#007a5a}
.vibc-plot .c3{color:#a0408a}.vibc-plot .c4{color:#7a6200}.vibc-plot .c5{color:#4a4f57}
.vibc-plot .k1{stroke-dasharray:7 3}.vibc-plot .k2{stroke-dasharray:2 3}.vibc-plot .k3{stroke-dasharray:8 3 2 3}
@media (prefers-color-scheme:dark){.vibc-plot{color:#e3e7ed}.vibc-plot .c0{color:#5db4ff}.vibc-plot .c1{color:#ff9c59}
.vibc-plot .c2{color:#3ecfa3}.vibc-plot .c3{color:#e58fd0}.vibc-plot .c4{color:#e0c13a}.vibc-plot .c5{color:#b3bac5}}
";

/// Width of a panel with its margins, px.
pub const WIDTH: f64 = 520.0;
/// Margins. Left of the axes: tick labels and the title; right; above: the heading; below: ticks and title.
const LEFT: f64 = 74.0;
const RIGHT: f64 = 22.0;
const TOP: f64 = 30.0;
const BOTTOM: f64 = 46.0;
const LINE: f64 = 17.0;
const TITLE: f64 = 34.0;

/// The whole file.
pub fn svg(plot: &Plot) -> String {
    let columns = plot.rows.iter().map(Vec::len).max().unwrap_or(1).max(1);
    let height_of = |panel: &Panel| TOP + panel.height + BOTTOM + LINE * panel.legend.len() as f64;
    let heights: Vec<f64> = plot.rows.iter().map(|row| row.iter().map(height_of).fold(0.0, f64::max)).collect();
    let widest = plot.rows.iter().flatten().flat_map(|panel| &panel.legend);
    let legend = widest.map(|entry| LEFT + 30.0 + text::width(&entry.text) * text::SPARE).fold(0.0, f64::max);
    let column = WIDTH.max(legend + RIGHT).ceil();
    let (width, height) = (Tenths::of(column * columns as f64), Tenths::of(TITLE + heights.iter().sum::<f64>() + 8.0));
    let mut file = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"vibc-plot\" role=\"img\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" style=\"max-width:100%;height:auto\">\n<title>{0}</title>\n<style>\n{STYLE}</style>\n\
         <text x=\"14\" y=\"23\" font-size=\"15\">{0}</text>\n",
        escape(&plot.title)
    );
    let mut top = TITLE;
    for (row, height) in plot.rows.iter().zip(heights) {
        for (number, panel) in row.iter().enumerate() {
            panel::draw(&mut file, panel, Point::new(column * number as f64, top));
        }
        top += height;
    }
    file + "</svg>\n"
}

fn put(file: &mut String, arguments: std::fmt::Arguments) {
    // Writing to a string cannot fail.
    let _ = file.write_fmt(arguments);
}

fn line(file: &mut String, class: &str, points: &[Point], closed: bool) {
    put(file, format_args!("<path class=\"{class}\" d=\""));
    path(file, points, closed);
    file.push_str("\"/>\n");
}
